"""Parameter values that are algebraic: the field that they generate, in which the judge of rational points decides.

Values such as 2*sqrt(2), sqrt(3)/2 or cos(pi/5), all in the field of one number (``constant``), are put in exactly;
so are a few different square roots.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

from flint import fmpq, fmpz_poly

from mbsym.algebra.factors import occurring
from mbsym.algebra.failures import NOT_THERE
from mbsym.algebra.plane.elements import Element, ElementMatrix, SimpleField
from mbsym.algebra.plane.numbers import AlgebraicNumber
from mbsym.algebra.ring import ParameterRing, Polynomial, Ring
from mbsym.algebra.terms import residue
from mbsym.expressions.tree import divide, number
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import determined
from mbsym.problems.equilibrium import Equilibrium
from mbsym.problems.knowledge import definition_in_parameters
from mbsym.problems.stability.constant import Constant, constant_of, constant_of_roots

#: Rational numbers lie in every field, as in that of sqrt(2): cos(pi/3) is one.
RATIONAL = Constant(AlgebraicNumber(fmpz_poly([-2, 0, 1]), fmpq(1), fmpq(2)), {}, "1")

Fractional = tuple[Polynomial, tuple[tuple[Polynomial, int], ...]]

#: Fields of a higher degree are left alone.
MOST_DEGREE = 8


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
    notation = {item.name for item in scene.system.notation}
    symbols: dict[int, Polynomial] = {}
    for index in occurring(x for matrix in matrices for row in matrix for x in row):
        g = ring.generators[index]
        named = g.kind == "parameter" and g.name in notation
        place = ring.indices[index] if isinstance(ring, ParameterRing) else index
        symbol = definition_in_parameters(scene, g.name) if named else whole.context.gen(place)
        symbols[index] = whole.substitute(whole.substitute(symbol, dependent), values_by_index)
    places = {ring.indices[k] if isinstance(ring, ParameterRing) else k: x for k, x in symbols.items()}

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
