"""A state of rest, as enclosures and, where it is algebraic, exactly in its number field."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import permutations
from typing import Any

from flint import arb, ctx, fmpq, fmpq_poly, fmpz

from mbsym.algebra import rationals
from mbsym.algebra.factors import occurring
from mbsym.algebra.failures import NOT_THERE, Failure, NotRational
from mbsym.algebra.polynomial_systems import (
    AlgebraicPoint,
    context,
    inverse_modulo,
    minimal_polynomial,
)
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.roots import by_square_root
from mbsym.algebra.terms import residue
from mbsym.expressions.angles import LinearForm, linear_form
from mbsym.expressions.tree import Call, Expression, multiply, number, substitute
from mbsym.formulas.python import python_text
from mbsym.mechanics.motion import motion_values
from mbsym.mechanics.rest import Rest
from mbsym.mechanics.symmetry import odd_in
from mbsym.model.system import System

#: Working precision of enclosures, in bits.
PRECISION = 200


def exact_rates(rest: Rest) -> dict[int, Any]:
    """The rates of a steady motion, by the index of their velocity, where they are rational numbers."""
    rates = {k: rate for k, rate in rest.rates.items() if rate.is_constant()}
    return {k: fmpq_poly([rate.leading_coefficient() if rate else 0]) for k, rate in rates.items()}


def angle_of(s: Any, c: Any, scale: int = 1) -> Any:
    """A ball around ``scale`` times the angle of a sine and a cosine, which is in (-pi, pi]."""
    with ctx.workprec(PRECISION):
        if c < 0 and s.contains(0):  # atan2 is cut here
            return (arb.pi() - (s / -c).atan()) * scale
        return arb.atan2(s, c) * scale


class Place:
    """Where the matrices are evaluated: values of coordinates as balls, and exactly where they are algebraic.

    ``enclosure``: a ball around an element of the number field QQ[t]/modulus; not needed where that is QQ.
    """

    def __init__(
        self,
        found: Rest,
        balls: Mapping[str, Any],
        exact: Mapping[int, Any],
        modulus: Any,
        enclosure: Callable[[Any, int], Any] | None = None,
    ) -> None:
        self.rest = found
        self.ring = found.ring
        self.modulus = modulus
        self._enclosure = enclosure
        self._exact = dict(exact)
        self.balls = dict.fromkeys(found.ring.names(), arb(0)) | dict(balls)

    def elsewhere(self, free: Sequence[str], t: fmpq) -> Place:
        """The same with other values of ``free`` coordinates: t, or 2 atan(t) for an angle."""
        ring = self.ring
        balls = dict(self.balls)
        exact = {k: value for k, value in self._exact.items() if ring.generators[k].argument is None}
        for name in free:
            if name not in ring.angles:
                balls[name], exact[ring.index("coordinate", name)] = arb(t), fmpq_poly([t])
                continue
            with ctx.workprec(PRECISION):
                balls[name] = 2 * arb(t).atan() * ring.angles[name]
            exact.pop(ring.index("coordinate", name), None)
            exact[ring.index("sine", name)] = fmpq_poly([2 * t / (1 + t * t)])
            exact[ring.index("cosine", name)] = fmpq_poly([(1 - t * t) / (1 + t * t)])
        return Place(self.rest, balls, exact, self.modulus, self._enclosure)

    def reflected(self, length: str, angle: str) -> Place:
        """The same place of all bodies at -r, theta + pi (``mechanics.reflections``)."""
        ring = self.ring
        exact = {k: value for k, value in self._exact.items() if ring.generators[k].argument is None}
        balls = dict(self.balls)
        for kind, name in (*odd_in(ring, length), ("sine", angle), ("cosine", angle)):
            if exact.get(ring.index(kind, name)) is not None:
                exact[ring.index(kind, name)] = -exact[ring.index(kind, name)]
        exact.pop(ring.index("coordinate", angle), None)
        with ctx.workprec(PRECISION):
            turn = arb.pi() if balls[angle] <= 0 else -arb.pi()
            balls[length], balls[angle] = -balls[length], balls[angle] + turn
        return Place(self.rest, balls, exact, self.modulus, self._enclosure)

    def enclose(self, element: Any) -> Any:
        """A ball around an element of the number field.  Raises NotRational where its root is not known."""
        if element.degree() <= 0:
            return arb(element[0])
        if self._enclosure is None:
            raise NotRational("an element of a number field without its root")
        return self._enclosure(element, PRECISION)

    def ball(self, x: Polynomial) -> Any:
        """An enclosure; exactly 0 where the value is proved to vanish."""
        residue = self.residue(x)
        if residue is not None and residue.degree() <= 0:
            return arb(residue[0])
        with ctx.workprec(PRECISION):
            return self.ring.evaluate(x, self.balls)

    def residue(self, x: Polynomial) -> Any:
        """The value in the number field, or None where it is not known to lie there."""
        if x.is_zero():
            return fmpq_poly([0])
        if self.modulus is None:
            return fmpq_poly([x.leading_coefficient()]) if x.is_constant() else None
        generators = {k: self._generator(k) for k in occurring([x])}
        return None if None in generators.values() else residue(x, generators, self.modulus)

    def exactly(self, name: str) -> Expression | None:
        """A coordinate in square roots of rationals, an angle as 2 atan(sin/(1 + cos)); None where it is neither."""
        if self.modulus is None:
            return None
        if name not in self.ring.angles:
            return self._in_square_roots(self.residue(self.ring.generator("coordinate", name)))
        s, c = (self.residue(self.ring.generator(kind, name)) for kind in ("sine", "cosine"))
        if s is None or c is None or c == fmpq_poly([-1]):
            return None
        tangent = self._in_square_roots(s * inverse_modulo(c + 1, self.modulus) % self.modulus)
        return None if tangent is None else multiply(number(2 * self.ring.angles[name]), Call("atan", tangent))

    def _in_square_roots(self, element: Any) -> Expression | None:
        if element is None:
            return None
        return by_square_root(minimal_polynomial(element, self.modulus), self.enclose(element))

    def _generator(self, index: int) -> Any:
        if index not in self._exact:
            g = self.ring.generators[index]
            value = None
            if g.kind == "reciprocal":
                inner = self.residue(g.argument)
                value = None if inner is None or inner == 0 else inverse_modulo(inner, self.modulus)
            elif g.kind == "root" and (inner := self.residue(g.argument)) is not None and inner.degree() == 0:
                root = rationals.square_root(inner[0])
                value = None if root is None else fmpq_poly([root])
            self._exact[index] = value
        return self._exact[index]


# Conditions of rest as integer polynomials in unknowns: sines, cosines, roots, reciprocals, plain coordinates.


def _turned_back(of: Sequence[Any], sign: int) -> tuple[Any, Any]:
    """Sine and cosine of B - sign a, of those of B and a."""
    s, c, sine, cosine = of
    return s * cosine - sign * c * sine, c * cosine + sign * s * sine


class Unknowns:
    """Which generators of the ring are unknowns, and the way into integer polynomials in them.

    ``by_angle``: cosine and sine of an angle side by side, multipliers behind, in which a basis is found sooner.
    """

    def __init__(self, ring: Ring, equations: Sequence[Polynomial], by_angle: bool = False) -> None:
        self.ring = ring
        used = set(occurring(equations))
        pending = list(used)
        while pending:
            g = ring.generators[pending.pop()]
            more: set[int] = set()
            if g.argument is not None:
                more = set(occurring([g.argument]))
            elif g.kind in ("sine", "cosine"):
                more = {ring.index("sine", g.name), ring.index("cosine", g.name)}
            pending += more - used
            used |= more
        self.indices = sorted(used, key=self._by_angle) if by_angle else sorted(used)
        letters = {"sine": "sin", "cosine": "cos"}
        self.names = []
        for k in self.indices:
            g = ring.generators[k]
            name = f"{g.name}/{g.denominator}" if g.denominator != 1 else g.name
            if g.argument is not None:
                written = python_text(ring, ring.context.gen(k))
                self.names.append(written if g.kind == "root" else f"({written})")
            else:
                self.names.append(f"{letters[g.kind]}({name})" if g.kind in letters else name)
        self.context = context([f"x{k}" for k in range(len(self.indices))])

    def _by_angle(self, k: int) -> tuple[bool, int, int]:
        g = self.ring.generators[k]
        angle = g.argument is None and g.kind in ("sine", "cosine")
        return g.kind == "prescribed", self.ring.index("cosine", g.name) if angle else k, int(g.kind == "sine")

    def holds(self, x: Polynomial) -> bool:
        return all(k in self.indices for k in occurring([x]))

    def polynomial(self, x: Polynomial) -> Any:
        """x times a positive integer."""
        common = math.lcm(*(int(c.q) for c in x.coeffs()))
        terms = {tuple(m[k] for k in self.indices): fmpz(int((c * common).p)) for m, c in x.terms()}
        return self.context.from_dict(terms)

    def back(self, x: Any) -> Polynomial:
        """An integer polynomial in the unknowns, in the ring."""
        terms = {}
        for monomial, coefficient in x.terms():
            exponents = [0] * len(self.ring.generators)
            for k, e in zip(self.indices, monomial, strict=True):
                exponents[k] = int(e)
            terms[tuple(exponents)] = fmpq(coefficient)
        return self.ring.context.from_dict(terms)

    def relations(self) -> list[Any]:
        """s^2 + c^2 = 1 of every angle, root^2 = radicand, x * reciprocal = 1."""
        ring, found = self.ring, []
        for k in self.indices:
            g = ring.generators[k]
            generator = ring.context.gen(k)
            if g.kind == "sine":
                found.append(generator**2 + ring.generator("cosine", g.name) ** 2 - 1)
            elif g.kind == "root":
                found.append(generator**2 - g.argument)
            elif g.kind == "reciprocal":
                found.append(generator * g.argument - 1)
        return [self.polynomial(x) for x in found]

    def is_relation(self, x: Any) -> bool:
        return any(x == y or x == -y for y in self.relations())

    def bounded(self) -> list[int]:
        return [i for i, k in enumerate(self.indices) if self.ring.generators[k].kind in ("sine", "cosine")]

    def in_sums_of_angles(self, equations: Sequence[Any]) -> tuple[list[Any], list[tuple[int, ...]]]:
        """The equations with b + a or b - a in place of angles b, where that makes them shorter: links' own directions.

        And what was changed: the places of the sine and cosine of b and of a, and the sign of a.  A sine or cosine of b
        stands then for that of the sum.
        """
        ring, places = self.ring, {k: i for i, k in enumerate(self.indices)}
        angles = [ring.generators[k] for k in self.indices if ring.generators[k].kind == "sine"]
        pairs = [
            (*(places[ring.index(kind, g.name)] for g in (b, a) for kind in ("sine", "cosine")), sign)
            for b, a in permutations([g for g in angles if g.argument is None], 2)
            if ring.angles[a.name] == ring.angles[b.name]
            for sign in (1, -1)
        ]
        gens, current = self.context.gens(), list(equations)
        changes: list[tuple[int, ...]] = []
        while pairs:
            tried = []
            for change in pairs:
                circle = gens[change[2]] ** 2 + gens[change[3]] ** 2 - 1
                images = list(gens)
                images[change[0]], images[change[1]] = _turned_back([gens[k] for k in change[:4]], change[4])
                tried.append([x if x == circle else divmod(x.compose(*images), circle)[1] for x in current])
            sizes = [sum(map(len, x)) for x in tried]
            best = min(range(len(pairs)), key=sizes.__getitem__)
            if sizes[best] >= sum(map(len, current)):
                break
            current = tried[best]
            changes.append(pairs[best])
        return current, changes

    @staticmethod
    def of_angles(point: AlgebraicPoint, changes: Sequence[tuple[int, ...]]) -> AlgebraicPoint:
        """A solution of those equations as one of the equations before."""
        values = list(point.values)
        for *places, sign in reversed(changes):
            turned = _turned_back([values[k] for k in places], sign)
            for k, value in zip(places, turned, strict=False):
                values[k] = value % point.modulus
        return replace(point, values=tuple(values))

    def roots_agree(self, point: AlgebraicPoint) -> bool:
        """Whether every square root is not negative, and every logarithm real."""
        for i, k in enumerate(self.indices):
            is_root = self.ring.generators[k].kind == "root" and point.values[i] != 0
            if is_root and point.enclosure(point.values[i], PRECISION) < 0:
                return False
        logarithms = (g.argument for g in self.ring.generators if g.kind == "function" and g.name == "log")
        real = (point.residue(self.polynomial(x)) for x in logarithms if x is not None and self.holds(x))
        return not any(point.enclosure(x, PRECISION) < 0 for x in real)

    def text(self, x: Any) -> str:
        """A polynomial as a reader writes it."""
        parts = []
        for monomial, coefficient in x.terms():
            factors = [name if e == 1 else f"{name}**{e}" for name, e in zip(self.names, monomial, strict=True) if e]
            number = int(coefficient)
            if not factors or abs(number) != 1:
                factors.insert(0, str(abs(number)))
            parts.append(("-" if number < 0 else "+", "*".join(factors)))
        first, *others = parts
        return ("-" if first[0] == "-" else "") + first[1] + "".join(f" {sign} {term}" for sign, term in others)


def at_zero(ring: Ring, names: Iterable[str]) -> dict[int, Any]:
    """Coordinates at 0, with their sines and cosines, by their generators."""
    exact: dict[int, Any] = {}
    for name in names:
        exact[ring.index("coordinate", name)] = fmpq_poly([0])
        if name in ring.angles:
            exact |= {ring.index("sine", name): fmpq_poly([0]), ring.index("cosine", name): fmpq_poly([1])}
    return exact


def ball_at(ring: Ring, name: str, exact: Mapping[int, Any], point: AlgebraicPoint) -> arb:
    """A coordinate that is known exactly, or whose sine and cosine are.  Raises KeyError where neither is."""
    if ring.has("sine", name) and ring.index("sine", name) in exact:
        s, c = (point.enclosure(exact[ring.index(kind, name)], PRECISION) for kind in ("sine", "cosine"))
        return angle_of(s, c, ring.angles[name])
    return point.enclosure(exact[ring.index("coordinate", name)], PRECISION)


# Places that may be equilibria without being isolated roots: zero, and where the springs in coordinates are at rest.
#
# A root at which the Jacobian is singular has no box that proves it.  There the coordinates are known exactly, rational
# numbers and rational multiples of pi, so the equations can be put to the test in the ring.


#: A root of higher multiplicity is not told apart from others.
MOST_MULTIPLE = 8


@dataclass(frozen=True)
class Candidate:
    """``forms``: coordinates as rational numbers plus multiples of pi; ``images``: their generators as constants."""

    ring: Ring
    forms: Mapping[str, LinearForm]
    images: Mapping[int, Polynomial]

    def vanishes(self, x: Polynomial) -> bool:
        """Whether x is proved to be zero there."""
        try:
            return bool(self.ring.substitute(x, dict(self.images)).is_zero())
        except NOT_THERE:
            return False

    def place(self, at_rest: Rest, rates: Mapping[int, Any]) -> Place:
        """With all other coordinates at 0."""
        ring, balls = self.ring, {}
        exact = at_zero(ring, [name for name in at_rest.constant if name not in self.forms])
        for k, value in self.images.items():
            if value.is_constant():
                exact[k] = fmpq_poly([value.leading_coefficient() if value else 0])
        with ctx.workprec(PRECISION):
            for name, form in self.forms.items():
                turns, rest = (rationals.exact(x) for x in (form.turns, form.constant))
                balls[name] = arb(rest) + arb.pi() * turns
        return Place(at_rest, balls, exact | dict(rates), fmpq_poly([0, 1]))


def candidates(rest: Rest, names: Sequence[str], equations: Sequence[Polynomial]) -> Iterator[Candidate]:
    """Those at which all equations vanish: ``names`` at zero, and at the rests of their springs."""
    rests: dict[str, list[LinearForm]] = {name: [LinearForm()] for name in names}
    for load in rest.system.loads:
        name, value = load.rest_position or ("", None)
        form = None if value is None else linear_form(value)
        if form is not None and not form.coefficients:
            rests.get(name, []).append(form)
    longest = max(map(len, rests.values()), default=0)
    tried = []
    for k in range(longest):
        forms = {name: each[min(k, len(each) - 1)] for name, each in rests.items()}
        if forms in tried:
            continue
        tried.append(forms)
        candidate = candidate_at(rest, forms)
        if all(candidate.vanishes(x) for x in equations):
            yield candidate


def described_place(system: System, there: Rest, values: Mapping[str, Any]) -> dict[str, LinearForm] | None:
    """The constant coordinates on the unperturbed motion; None where one is no number and no multiple of pi."""
    numbers = {name: number(x) for name, x in values.items() if isinstance(x, Fraction)}
    forms = {}
    for name, (value, _) in motion_values(system).items():
        if name in there.constant:
            form = linear_form(substitute(value, numbers))
            if form is None or form.coefficients:
                return None
            forms[name] = form
    return forms


def candidate_at(rest: Rest, forms: Mapping[str, LinearForm]) -> Candidate:
    """The place with these coordinates."""
    return Candidate(rest.ring, forms, _images(rest.ring, forms))


def _images(ring: Ring, forms: Mapping[str, LinearForm]) -> dict[int, Polynomial]:
    """Generators as constants; sines and cosines that are not made of square roots are left as they are."""
    images: dict[int, Polynomial] = {}
    for name, form in forms.items():
        value = ring.number(form.constant)
        if form.turns:
            value = value + ring.times(ring.number(form.turns), ring.generator("parameter", "pi"))
        images[ring.index("coordinate", name)] = value
        if name in ring.angles and not form.constant:
            try:
                sine, cosine = ring.sin_cos(LinearForm(turns=form.turns / ring.angles[name]))
            except Failure:
                continue
            images |= {ring.index("sine", name): sine, ring.index("cosine", name): cosine}
    return images


def only_root(ring: Ring, equation: Polynomial, name: str, candidate: Candidate, interval: Any) -> bool:
    """Whether ``candidate`` is proved to be the only root of one equation f(x) = 0 in an interval around it.

    With f = f' = ... = 0 up to the order m - 1 there,  f(x) = f^(m)(y) (x - a)^m / m!  for some y between x and a.
    """
    slope = equation
    for _ in range(MOST_MULTIPLE):
        if not candidate.vanishes(slope):
            break
        slope = ring.derivative(slope, name)
    else:
        return False
    at = dict.fromkeys(ring.names(), arb(0)) | {name: interval}
    with ctx.workprec(PRECISION):
        return not bool(ring.evaluate(slope, at).contains(0))
