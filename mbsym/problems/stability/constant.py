"""One algebraic number among the coefficients of a section: sqrt(3), or the sine and cosine of pi/10.

It is carried as one more generator c of the context, with c's minimal polynomial m.  Whether p(x, c) vanishes
identically is decided by its remainder modulo m; where it vanishes, its norm  res_c(p, m)  does, a polynomial with
rational coefficients.  So norms take the place of boundary polynomials: they have more zeros, at which nothing changes,
but none of theirs is lost.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import lcm
from typing import Any

from flint import Ordering, fmpq, fmpq_mat, fmpq_mpoly_ctx, fmpq_poly, fmpz_poly

from mbsym.algebra.factors import occurring
from mbsym.algebra.failures import NOT_THERE, TooLargeError
from mbsym.algebra.plane.elements import Element, ElementMatrix, SimpleField
from mbsym.algebra.plane.fields import Extension, Over, Point
from mbsym.algebra.plane.numbers import AlgebraicNumber, primitive, roots_between, sign
from mbsym.algebra.plane.numbers import number as as_number
from mbsym.algebra.ring import ParameterRing, Polynomial, Ring
from mbsym.algebra.terms import residue
from mbsym.expressions.angles import linear_form
from mbsym.expressions.tree import divide, number
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import determined
from mbsym.model.system import System
from mbsym.problems.equilibrium import Equilibrium
from mbsym.problems.knowledge import definition_in_parameters

#: Of cos(pi/D), D is at most this.
MOST_PARTS = 60
#: Of the discriminant of a norm in two variables.
MOST_IN_A_PLANE = 600
#: Roots of larger numbers are not taken, nor the field of more of them.
MOST_DIGITS, MOST_ROOTS = 40, 3


@dataclass(frozen=True)
class Constant:
    """``images``: generators of a ring as polynomials in the ``number``; ``text`` says what it is."""

    number: AlgebraicNumber
    images: Mapping[int, Any]
    text: str

    def reduced(self, p: Polynomial) -> Polynomial:
        """p modulo the minimal polynomial of its last generator: 0 exactly where p vanishes at the number."""
        return divmod(p, self._modulus(p.context()))[1] if p != 0 else p

    def norm(self, p: Polynomial) -> Polynomial:
        """The product of p over all conjugates of the number: rational coefficients, zero wherever p is.

        Raises TooLargeError where nothing could be done with it in a plane.
        """
        context = p.context()
        if p == 0 or p.degrees()[-1] == 0:
            return p
        *axes, _ = (int(degree) for degree in p.degrees())
        if len(axes) == 2:
            worst = 2 * axes[0] * axes[1] * int(self.number.polynomial.degree()) ** 2
            if worst > MOST_IN_A_PLANE:
                raise TooLargeError(
                    "a resultant of degree up to [[worst]], more than [[most]]", worst=worst, most=MOST_IN_A_PLANE
                )
        return self._modulus(context).resultant(p, context.names()[-1])

    def sign(self, p: Polynomial) -> int:
        """The sign of a polynomial in which the axes do not occur."""
        over = self.polynomial_at(p, [fmpq(0)] * (p.context().nvars() - 1))
        return self.number.sign(over) if over.degree() > 0 else sign(over[0])

    def polynomial_at(self, p: Polynomial, point: Sequence[Any]) -> Any:
        """p(point, .) modulo the minimal polynomial: with the axes put in, a polynomial in the number."""
        total = fmpq_poly([0])
        for powers, value in p.to_dict().items():
            for x, power in zip(point, powers, strict=False):
                value *= x ** int(power)
            total += fmpq_poly([0] * int(powers[-1]) + [value])
        return total % self.number.modulus

    def _modulus(self, context: Any) -> Polynomial:
        c = context.gen(context.nvars() - 1)
        total = context.constant(0)
        for power, coefficient in enumerate(self.number.polynomial.coeffs()):
            total += c**power * fmpq(coefficient)
        return total

    def beside(self, x: Any) -> Point:
        """The point (x, number), x rational or algebraic."""
        if isinstance(x, fmpq):
            return Point(x, AlgebraicNumber(self.number.polynomial, self.number.low, self.number.high))
        over = [fmpq_poly([fmpq(c)]) for c in self.number.modulus.coeffs()]
        lead = fmpq_poly([1 / over[-1][0]])
        monic = [entry * lead for entry in over]
        return Point(x, Over(Extension(x), monic, self.number.low, self.number.high))


def constant_of(system: System, ring: Ring, indices: Sequence[int]) -> Constant | None:
    """The number through which all these generators are rational; None where there is none of the kinds above."""
    if not indices:
        return None
    generators = {k: ring.generators[k] for k in indices}
    if all(g.kind == "root" for g in generators.values()):
        return _root({k: g.argument for k, g in generators.items()})
    if all(g.kind in ("sine", "cosine") and g.argument is None for g in generators.values()):
        values = {item.name: item.value for item in system.parameters if item.value is not None}
        turns: dict[int, Fraction] = {}
        for k, g in generators.items():
            form = linear_form(values[g.name]) if g.name in values else None
            if form is None or form.coefficients or form.constant:
                return None
            turns[k] = form.turns / g.denominator
        return _angles(turns, {k: g.kind for k, g in generators.items()})
    return None


def _root(arguments: Mapping[int, Polynomial]) -> Constant | None:
    """sqrt(n) where all arguments are rational multiples of n by squares."""
    images: dict[int, Any] = {}
    base = 0
    for k, argument in arguments.items():
        if not argument.is_constant() or argument == 0:
            return None
        value = fmpq(argument.leading_coefficient())
        whole = int(value.p) * int(value.q)
        if whole <= 0 or len(str(whole)) > MOST_DIGITS:
            return None
        base = base or whole
        ratio = fmpq(whole * base)  # sqrt(whole) = sqrt(whole base)/base sqrt(base)
        root = int(ratio.p.isqrt())
        if root * root != ratio.p:
            return None
        images[k] = fmpq_poly([0, fmpq(root, base) / value.q])
    p = fmpz_poly([-base, 0, 1])
    roots = roots_between(p, fmpq(0), fmpq(base + 1))
    made = as_number(roots[0])
    return Constant(made, images, f"sqrt({base})") if isinstance(made, AlgebraicNumber) else None


def constant_of_roots(ring: Ring, indices: Sequence[int]) -> Constant | None:
    """Some square roots of positive numbers, as polynomials in their sum; None where they are of other kinds.

    The field has the products of different roots for a basis, if these are independent: then the powers of the sum are
    another one.
    """
    arguments = [ring.generators[k].argument for k in indices if ring.generators[k].kind == "root"]
    if len(arguments) < len(indices) or len(indices) > MOST_ROOTS:
        return None
    squares = [fmpq(x.leading_coefficient()) for x in arguments if x is not None and x.is_constant() and x != 0]
    if len(squares) < len(indices) or any(x <= 0 for x in squares):
        return None
    size = 1 << len(squares)

    def times_sum(vector: Sequence[Any]) -> list[Any]:
        multiplied = [fmpq(0)] * size
        for place, x in enumerate(vector):
            for k, square in enumerate(squares):
                multiplied[place ^ (1 << k)] += x * square if place & (1 << k) else x
        return multiplied

    powers = [[fmpq(int(place == 0)) for place in range(size)]]
    for _ in range(size):
        powers.append(times_sum(powers[-1]))
    basis = fmpq_mat(size, size, [x for vector in powers[:size] for x in vector]).transpose()
    if basis.det() == 0:
        return None
    unit_vectors = [[fmpq(int(place == 1 << k)) for place in range(size)] for k in range(len(squares))]
    solutions = [basis.solve(fmpq_mat(size, 1, vector)).entries() for vector in (*unit_vectors, powers[size])]
    minimal = primitive(fmpq_poly([-x for x in solutions.pop()] + [fmpq(1)]))
    made = as_number(roots_between(minimal, fmpq(0), sum((x + 1 for x in squares), fmpq(1)))[-1])
    if not isinstance(made, AlgebraicNumber) or int(made.polynomial.degree()) < size:
        return None
    images = {k: fmpq_poly(list(x)) for k, x in zip(indices, solutions, strict=True)}
    return Constant(made, images, " + ".join(f"sqrt({x})" for x in squares))


def _angles(turns: Mapping[int, Fraction], kinds: Mapping[int, str]) -> Constant | None:
    """Through 2 cos(pi/D): cos(pi k/D) = T_k(cos(pi/D)), sin(pi t) = cos(pi (1/2 - t))."""
    parts = lcm(*(x.denominator for value in turns.values() for x in (value, Fraction(1, 2) - value)))
    if parts > MOST_PARTS:
        return None
    p = fmpz_poly.cos_minpoly(2 * parts)
    roots = roots_between(p, fmpq(-3), fmpq(3))
    made = as_number(roots[-1])  # the largest of 2 cos(pi k/D) is that of k = 1
    if not isinstance(made, AlgebraicNumber):
        return None
    images = {}
    for k, value in turns.items():
        angle = value if kinds[k] == "cosine" else Fraction(1, 2) - value
        images[k] = fmpq_poly(fmpz_poly.chebyshev_t(abs(int(angle * parts))))(fmpq_poly([0, fmpq(1, 2)]))
    return Constant(made, images, f"2*cos(pi/{parts})")


def context_of(names: Sequence[str], constant: Constant | None) -> Any:
    """The context of the axes, with a last generator for the constant if there is one."""
    extra = "constant"
    while extra in names:
        extra += "_"
    return fmpq_mpoly_ctx.get((*names, *((extra,) if constant is not None else ())), Ordering.lex)


# Parameter values that are algebraic: the field that they generate, in which the judge of rational points decides.
#
# Values such as 2*sqrt(2), sqrt(3)/2 or cos(pi/5), all in the field of one number (``constant``), are put in exactly;
# so are a few different square roots.


#: Rational numbers lie in every field, as in that of sqrt(2): cos(pi/3) is one.
RATIONAL = Constant(AlgebraicNumber(fmpz_poly([-2, 0, 1]), fmpq(1), fmpq(2)), {}, "1")

Fractional = tuple[Polynomial, tuple[tuple[Polynomial, int], ...]]

#: Fields of a higher degree are left alone.
MOST_DEGREE = 8


def in_declared(scene: Scene, ring: Ring, index: int) -> tuple[int, Polynomial]:
    """Where a generator of a ring of parameters stands in the whole ring, and what it is in declared ones."""
    g = ring.generators[index]
    named = g.kind == "parameter" and any(g.name == item.name for item in scene.system.notation)
    place = ring.indices[index] if isinstance(ring, ParameterRing) else index
    return place, definition_in_parameters(scene, g.name) if named else scene.ring.context.gen(place)


class AlgebraicPoint:
    """``put`` makes of a polynomial a fraction (numerator, ((factor, exponent), ...)) in generators with ``images``.

    The images are polynomials in the number of ``constant``.
    """

    matrix = ElementMatrix

    def __init__(self, constant: Constant, put: Callable[[Polynomial], Fractional]) -> None:
        self._field, self._images, self._put = SimpleField(constant.number), constant.images, put

    def settled(self, p: Polynomial) -> Polynomial:
        """p, or 0 where it vanishes at the point."""
        return p if p == 0 or self.value(p) else p * 0

    def value(self, p: Polynomial) -> Element:
        """p at the point."""
        top, bottom = self._put(p)
        quotient = residue(top, self._images, self._field.modulus)
        for factor, exponent in bottom:
            inverse = self._field.inverse(residue(factor, self._images, self._field.modulus))
            for _ in range(exponent):
                quotient = self._field.times(quotient, inverse)
        return Element(self._field, quotient)


def algebraic_point(
    scene: Scene, ring: Ring, matrices: Any, values: Mapping[str, Any], equilibrium: Equilibrium
) -> AlgebraicPoint | None:
    """The point at which the generators that occur in matrices have their values; None where it is of no such kind.

    ``values``: rational ones; of others the description's expressions are taken, relations and solved conditions.
    """
    try:
        return _point(scene, ring, matrices, values, equilibrium)
    except NOT_THERE:
        return None


def _point(
    scene: Scene, ring: Ring, matrices: Any, values: Mapping[str, Any], equilibrium: Equilibrium
) -> AlgebraicPoint | None:
    whole: Ring = scene.ring
    values_by_index: dict[int, Polynomial] = {}
    for parameter in scene.system.parameters:
        value = values.get(parameter.name)
        expression = number(value) if isinstance(value, Fraction) else parameter.value
        if expression is None:
            continue
        values_by_index[whole.index("parameter", parameter.name)] = scene.lower(expression)
        if parameter.name in whole.angles:
            sine, cosine = scene.lower.angle(divide(expression, number(whole.angles[parameter.name])))
            values_by_index |= {
                whole.index("sine", parameter.name): sine,
                whole.index("cosine", parameter.name): cosine,
            }
    dependent = determined(scene, [(name, x.polynomial) for name, x in equilibrium.solved if name not in values])
    places: dict[int, Polynomial] = {}
    for index in occurring(x for matrix in matrices for row in matrix for x in row):
        place, symbol = in_declared(scene, ring, index)
        places[place] = whole.substitute(whole.substitute(symbol, dependent), values_by_index)

    def put(p: Polynomial) -> Fractional:
        lifted = ring.lift(p) if isinstance(ring, ParameterRing) else p
        top, bottom = whole.fraction(whole.reduce(whole.substitute(lifted, places)))
        return top, tuple(bottom)

    fractions = [put(x) for matrix in matrices for row in matrix for x in row]
    parts = [x for top, bottom in fractions for x in (top, *(factor for factor, _ in bottom))]
    used = sorted(set(occurring(parts)))
    constant = constant_of(scene.system, whole, used) or constant_of_roots(whole, used) if used else RATIONAL
    if constant is None or constant.number.polynomial.degree() > MOST_DEGREE:
        return None
    return AlgebraicPoint(constant, put)
