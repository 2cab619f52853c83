"""Problem 11 on a scene: which theorem is asked, at numbers and in symbols."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from fractions import Fraction
from functools import cache, partial
from math import factorial, prod
from typing import Any

from flint import acb, arb, ctx, fmpq_poly

from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import NoClosedForm, NoValue
from mbsym.algebra.point import Balls, Rationals
from mbsym.algebra.ring import Polynomial
from mbsym.algebra.tower import Element, Tower
from mbsym.algebra.truncated import Truncated
from mbsym.formulas.formula import Formula
from mbsym.mechanics.expansion import OnManifold
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.rest import rational_values
from mbsym.problems.equilibrium import Equilibrium
from mbsym.problems.normal_forms.birkhoff import diagonalised, is_zero_exactly, matrix_of, normal_form
from mbsym.problems.normal_forms.dissipative import focus, judged_field
from mbsym.problems.normal_forms.equal import equal_frequencies
from mbsym.problems.normal_forms.exact import (
    Resonant,
    even_part,
    exact_values,
    in_ring,
    known,
    occurring_parameters,
    over_tower,
    primitive,
    resonance,
    two_eigenvectors,
)
from mbsym.problems.normal_forms.expansion import (
    Expansion,
    Numbers,
    SingularMass,
    expansion,
    has_forces,
    potential,
    taken_in,
)
from mbsym.problems.normal_forms.result import InSymbols, Judged, NormalForms, Outcome, Theorem, Why
from mbsym.problems.normal_forms.twist import judged
from mbsym.problems.normal_forms.zero_root import BALLS, Scalars, zero_root
from mbsym.problems.stability.bundle import MOST_ORDER, NumberField, by_potential
from mbsym.problems.stability.verdict import Verdict

#: Working precision of enclosures, in bits.
PRECISION = 320
#: Resonances are looked for to this order, and Birkhoff's form goes so far where it has to.
ORDER = 6


class Expanded:
    """The expansions of the system ``whole`` to any order, each made once, and what they decide; ``scene``: the ring's.

    ``conservative``: applied forces are zero or have a generalized potential, which is taken in; ``cyclic`` coordinates
    are in neither.  With ``manifold`` in the coordinates that constraints leave.
    """

    def __init__(
        self,
        scene: Scene,
        whole: Any,
        equilibrium: Equilibrium | None,
        conservative: bool = False,
        cyclic: Collection[str] = (),
        manifold: Callable[[int], OnManifold] | None = None,
    ) -> None:
        self.ring, self.conservative = scene.ring, conservative
        self.plain = cache(lambda order: expansion(scene, whole, equilibrium, order, cyclic, manifold))
        self.to = cache(lambda order: taken_in(self.plain(order)) if conservative else self.plain(order))

    def at(self, values: Mapping[str, Any]) -> Judged:
        """What is decided at values of all parameters.  Raises as ``normal_forms`` does."""
        with ctx.workprec(PRECISION):
            return at_numbers(self.to, values, None) if self.conservative else _judged_field(self.to, values)

    def by_energy(
        self, conserved: bool, values: Mapping[str, Fraction], damping: Sequence[Sequence[Polynomial]] = ()
    ) -> Verdict | None:
        """What a minimum of V of higher order says at rational values.

        None where it says nothing.  The energy does not grow; ``conserved``: it does not fall, either; ``damping``: D.
        """
        size = len(self.plain(2).coordinates)
        numbers = Rationals({}, {})
        carry = Carrier(self.ring, numbers, {name: numbers.number(value) for name, value in values.items()})
        field = NumberField(fmpq_poly([0, 1]), lambda x: arb(x[0]))

        def derivative(*places: int) -> Any:
            order = len(places)
            parts = potential(self.plain(order if order <= 4 else MOST_ORDER))
            if parts is None:
                return None
            repeated = prod(factorial(k) for k in Counter(places).values())
            return fmpq_poly([carry(parts.get(tuple(sorted(places)), self.ring.zero)) * repeated])

        with ctx.workprec(PRECISION):
            flat = (key for part in self.plain(4).lagrangian for key in part)
            gyroscopic = has_forces(self.plain(4)) or any(sum(k >= size for k in key) == 1 < len(key) for key in flat)
            return by_potential(
                size, derivative, field, conserved, True, gyroscopic, [[arb(carry(x)) for x in row] for row in damping]
            )

    def first_terms(self, sign: Callable[[Polynomial], str]) -> Iterator[tuple[int, Polynomial]]:
        """Orders and coefficients of the terms of V(x) of the one coordinate, in order: those ``sign`` calls not zero.

        None of several coordinates.
        """
        for least, most in ((2, 4), (5, MOST_ORDER)):
            expanded = self.plain(most)
            parts = potential(expanded)
            if parts is None or len(expanded.coordinates) != 1:
                return
            for order in range(least, most + 1):
                value = parts.get((0,) * order)
                if value is not None and self.ring.is_zero(value) is not True and sign(value) != "zero":
                    yield order, value

    def normal_forms(self, values: Mapping[str, Any] | None) -> NormalForms:
        """What terms of higher order decide of the motion, at numbers and in symbols.

        ``values`` of all parameters, rational or enclosed; None where not all are known.  Raises NotExpanded,
        NoClosedForm.
        """
        fourth_order = self.to(4)
        coordinates = tuple(name for i, name in enumerate(fourth_order.coordinates) if i not in fourth_order.cyclic)
        with ctx.workprec(PRECISION):
            at_values = None if values is None else self.at(values)
            symbols: Any = partial(_in_symbols if self.conservative else focus, fourth_order)
            in_symbols, why = known(symbols)
        return NormalForms(
            coordinates=coordinates,
            cyclic=tuple(fourth_order.coordinates[i] for i in fourth_order.cyclic),
            conservative=self.conservative,
            order=ORDER,
            at_values=at_values,
            in_symbols=in_symbols,
            no_symbols=why,
            taken_in=self.conservative and has_forces(self.plain(4)),
        )


def _judged_field(to: Callable[[int], Expansion], values: Mapping[str, Any]) -> Judged:
    """With applied forces, at numbers: undecided where coefficients are no exact numbers (sines, exponentials)."""
    try:
        return judged_field(to, values)
    except SingularMass:
        return Judged(Outcome.UNDECIDED, Theorem.NONE, Why.SINGULAR_MASS)
    except (NoClosedForm, NoValue):  # the tower has square roots of numbers, but no pi
        return Judged(Outcome.UNDECIDED, Theorem.NONE, Why.IRRATIONAL)


def at_numbers(to: Callable[[int], Expansion], values: Mapping[str, Any], resonant: Any) -> Judged:
    """A conservative system at numbers; ``resonant`` decides k.w = 0 where the values are not rational."""
    try:
        return _conservative(to, values, resonant)
    except SingularMass:
        return Judged(Outcome.UNDECIDED, Theorem.NONE, Why.SINGULAR_MASS)


def _conservative(to: Callable[[int], Expansion], values: Mapping[str, Any], resonant: Any) -> Judged:

    def lowered(order: int) -> Truncated:
        return enclosed(to(order), values).hamiltonian()

    if resonant is not None:
        return judged(lowered, resonant, ORDER)
    resonant = _exactly(to(4), values)
    if resonant.zero:
        return _with_zero_root(to(ORDER), values)
    if resonant.equal:
        return equal_frequencies(lowered(4), _two_eigenvectors(to(4), values))

    def vanishes(vector: tuple[int, ...], omega: Sequence[arb]) -> bool:
        return is_zero_exactly(to(4), values, vector, omega)

    return judged(lowered, resonant, ORDER, vanishes)


def _two_eigenvectors(expanded: Expansion, values: Mapping[str, Any]) -> bool:
    tower, exact = exact_values(expanded, values) or (Tower(), {})
    matrix = matrix_of(over_tower(expanded, tower, exact).hamiltonian())
    trace = even_part(matrix, tower.zero, tower.one)[1]
    return all(x.is_zero() for x in two_eigenvectors(matrix, trace))


def _with_zero_root(expanded: Expansion, values: Mapping[str, Any]) -> Judged:
    """A root is zero exactly, at exact values."""
    tower, exact = exact_values(expanded, values) or (Tower(), {})
    numbers = over_tower(expanded, tower, exact)
    balls = enclosed(expanded, values).hamiltonian()

    def ball_of(x: Element) -> arb:
        return tower.enclosed(x, {}).real

    scalars = Scalars(
        inverse=tower.reciprocal,
        is_zero=lambda x: bool(x.is_zero()),
        differs=lambda x: not ball_of(x).contains(0),
        enclosed=ball_of,
    )
    return zero_root(numbers.hamiltonian(), balls, scalars, variables(expanded))


def at_zero_root(expanded: Expansion, values: Mapping[str, Any]) -> Judged:
    """The same at enclosed values at which a root is zero exactly: what else vanishes has to do so term by term."""
    balls = enclosed(expanded, values).hamiltonian()
    return zero_root(balls, balls, BALLS, variables(expanded))


def variables(expanded: Expansion) -> tuple[str, ...]:
    """The coordinates without the cyclic ones, and their momenta as ``p_name``."""
    names = [name for i, name in enumerate(expanded.coordinates) if i not in expanded.cyclic]
    return (*names, *(f"p_{name}" for name in names))


def enclosed(expanded: Expansion, values: Mapping[str, Any]) -> Numbers:
    """The expansion over enclosures."""
    balls = {"pi": arb.pi()} | {name: ball(value) for name, value in values.items()}
    carry = Carrier(expanded.scene.ring, Balls(balls), balls)
    return Numbers(expanded, lambda x: acb(carry(x)), lambda x: 1 / x, acb(0), acb(1))


def ball(value: Any) -> arb:
    """A number or an enclosure as an enclosure."""
    return value if isinstance(value, arb) else arb(value.numerator) / value.denominator


def _exactly(expanded: Expansion, values: Mapping[str, Any]) -> Resonant:
    """Exact resonances, where values and coefficients hold nothing but square roots."""
    numbers = exact_values(expanded, values)
    if numbers is None:
        return Resonant(None, None)
    tower, exact = numbers

    def coefficients() -> list[Element]:
        quadratic = over_tower(expanded, tower, exact).hamiltonian()
        return even_part(matrix_of(quadratic), tower.zero, tower.one)

    q, _ = known(coefficients)
    return Resonant(None, None) if q is None else Resonant(tower, q)


def _in_symbols(expanded: Expansion) -> InSymbols | None:
    """Of two degrees of freedom; None of others.  Raises Failure where formulas outgrow their budgets."""
    if len(expanded.coordinates) - len(expanded.cyclic) != 2:
        return None
    return twist(expanded, {})[0]


def twist(expanded: Expansion, values: Mapping[str, Any]) -> tuple[InSymbols, Tower, dict[str, Element]]:
    """D_4 and what it stands on, with ``values`` put in; the same as elements of the tower."""
    ring = expanded.scene.ring
    tower = Tower([name for name in occurring_parameters(expanded) if name not in values])
    hamiltonian = over_tower(expanded, tower, rational_values(values)).hamiltonian()
    constant, trace = even_part(matrix_of(hamiltonian), tower.zero, tower.one)[:2]
    discriminant = trace * trace - constant * 4
    difference = tower.square_root(discriminant)
    roots = [tower.square_root((difference * sign - trace) / 2) for sign in (-1, 1)]
    linear = diagonalised(hamiltonian, roots, tower.reciprocal, lambda d: float(not d.is_zero()))
    at = normal_form(hamiltonian, linear, tower.reciprocal).actions(2)
    element, other = roots
    zero = tower.zero
    determinant = at.get((2, 0), zero) * other * other - at.get((1, 1), zero) * element * other
    determinant = determinant + at.get((0, 2), zero) * element * element
    named = {"trace": trace, "product": constant, "discriminant": discriminant, "determinant": determinant}
    resonances = {vector: resonance(tower, (constant, trace), vector) for vector in ((1, 2), (1, 3))}
    formulas = {name: Formula(ring, in_ring(tower, ring, x)) for name, x in named.items()}
    formulas["zero"] = Formula(ring, in_ring(tower, ring, primitive(tower, determinant)))
    result = InSymbols(
        trace=formulas["trace"],
        product=formulas["product"],
        discriminant=formulas["discriminant"],
        determinant=formulas["determinant"],
        zero=formulas["zero"],
        resonances=tuple((k, Formula(ring, in_ring(tower, ring, x))) for k, x in resonances.items()),
    )
    return result, tower, named | {f"{a}:{b}": x for (a, b), x in resonances.items()}
