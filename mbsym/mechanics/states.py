"""Random exact states, the same on every run, at which two routes are compared without tolerance."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

from flint import arb, fmpq

from mbsym.algebra import rationals
from mbsym.algebra.base import Algebra, Lowering
from mbsym.algebra.failures import NOT_THERE
from mbsym.algebra.point import Balls, BallsAtRationals, Rationals
from mbsym.algebra.ring import Ring
from mbsym.mechanics.oracle import Oracle, State
from mbsym.mechanics.variables import has_linear_angles
from mbsym.model.assumptions import has_sign, holds
from mbsym.model.speeds import Quaternion
from mbsym.model.system import System, rational

if TYPE_CHECKING:
    from mbsym.mechanics.programs import Programs
    from mbsym.mechanics.speed_programs import SpeedProgram

#: Any fixed number will do; a fixed one makes reports reproducible byte for byte.
SEED = 1788
#: So many draws look for numbers that keep the assumptions.
ATTEMPTS = 100
#: Then so many multiples of the numbers that the description gives.
MULTIPLES = 5


#: Of numbers so fine one state tells more than several of coarse ones: a polynomial of total degree d that is not zero
#: vanishes at a share of at most d/(8 FINE) of them.
FINE = 1 << 40


def drawn(system: System, ring: Ring, source: random.Random, fine: int = 1) -> dict[str, fmpq]:
    """Between 1/24 and 40, quotients of multiples of 1/``fine``, of declared sign and as the assumptions have it.

    Where no such numbers are met multiples of those that the description gives are taken, or these, and others as they
    come.
    """
    values, declared = _met(system, ring, source, fine)
    return values | {name: x for name, x in declared.items() if x is not None}


def are_met(system: System, ring: Ring) -> bool:
    """Whether random numbers keep the assumptions: else what vanishes at all states need not vanish elsewhere."""
    return not _met(system, ring, random.Random(SEED))[1]


def _met(
    system: System, ring: Ring, source: random.Random, fine: int = 1
) -> tuple[dict[str, fmpq], dict[str, fmpq | None]]:
    """Random numbers, and the description's own where no others that keep the assumptions were met."""
    declared_values = {symbol.name: rational(symbol.value) for symbol in system.parameters}
    declared = {name: None if x is None else rationals.exact(x) for name, x in declared_values.items()}
    for attempt in range(ATTEMPTS + MULTIPLES):
        values = {name: fmpq(source.randint(fine, 40 * fine), source.randint(fine, 24 * fine)) for name in ring.names()}
        for parameter in system.parameters:
            flipped = parameter.sign in ("negative", "nonpositive")
            if flipped or (attempt and parameter.sign in ("real", "nonzero") and source.randrange(2)):
                values[parameter.name] = -values[parameter.name]
        if attempt >= ATTEMPTS:  # what is true of quotients alone, as a = b, leaves no other numbers
            factor = fmpq(source.randint(fine, 40 * fine), source.randint(fine, 24 * fine))
            values |= {name: x * factor for name, x in declared.items() if x is not None}
        if not system.assumptions or is_allowed(system, Rationals({}, {}), values):
            return values, {}
    return values, declared


def is_allowed(system: System, numbers: Algebra[Any], values: Mapping[str, Any]) -> bool:
    """Whether declared signs and assumptions are kept; the relations between parameters are no matter here."""
    if not all(
        has_sign(values[parameter.name], parameter.sign) for parameter in system.parameters if parameter.name in values
    ):
        return False
    if not system.assumptions:
        return True
    try:
        values = dict(values)
        for symbol in system.notation:
            values[symbol.name] = Lowering(numbers, values)(symbol.value)
        lower = Lowering(numbers, values)
        return all(
            holds(lower(assumption.left) - lower(assumption.right), assumption.relation)
            for assumption in system.assumptions
        )
    except NOT_THERE:
        return True


def rational_states(system: System, ring: Ring, count: int) -> Iterator[State]:
    """States whose sines and cosines are rational; a plain coordinate is an independent number there."""
    source = random.Random(SEED)
    for _ in range(count):
        values = drawn(system, ring, source) | {"pi": fmpq(355, 113)}
        yield State(Rationals(_tangents(system, ring, source), ring.angles), values)


def _tangents(system: System, ring: Ring, source: random.Random, fine: int = 1) -> dict[str, fmpq]:
    """Tangents of half angles; with quaternions sines and cosines of half angles are rational, too."""
    tangents = {
        name: fmpq(source.randint(-9 * fine, 9 * fine) or fine, source.randint(fine, 9 * fine)) for name in ring.angles
    }
    if not any(isinstance(vector, Quaternion) for body in system.bodies for vector in body.orientation):
        return tangents
    quarters = {name: x / 10 for name, x in tangents.items()}  # no quarter turn of 45 degrees
    return {name: 2 * x / (1 - x * x) for name, x in quarters.items()}


def ball_states(system: System, ring: Ring, count: int, fine: int = 1) -> Iterator[State]:
    """States in which irrational functions have rigorous enclosures."""
    source = random.Random(SEED)
    for _ in range(count):
        values = {name: arb(value) for name, value in drawn(system, ring, source, fine).items()} | {"pi": arb.pi()}
        yield State(Balls(values), values)


def enclosed_states(system: System, ring: Ring, count: int, fine: int = 1) -> Iterator[State]:
    """States for identities of the ring whose values are irrational.

    Where every angle is a linear form, all but roots and functions is rational there, which makes long polynomials
    cheap; q, sin q and cos q are then independent, as they are in rational states.  ``fine``: the numbers are quotients
    of multiples of 1/fine.
    """
    if not has_linear_angles(system):
        yield from ball_states(system, ring, count, fine)
        return
    source = random.Random(SEED)
    for _ in range(count):
        exact = drawn(system, ring, source, fine)
        numbers = BallsAtRationals(_tangents(system, ring, source, fine), ring.angles, exact)
        yield State(numbers, {**numbers.values, "pi": arb.pi()})


class Oracles:
    """Oracles at the states of the self-check, shared by all checks: each placement is made once."""

    def __init__(self, system: System, ring: Ring, count: int) -> None:
        self.system = system
        self.ring = ring
        self.count = count
        self._masses: dict[Oracle, tuple[Programs | SpeedProgram, list[Any]]] = {}

    def masses(self, oracle: Oracle, programs: Programs | SpeedProgram) -> list[Any]:
        """The entries of M there, row by row, as the program has them: where they are rational they are found once."""
        known, values = self._masses.get(oracle, (None, []))
        if known is not programs:
            nodes = [node for row in programs.mass_matrix for node in row]
            values = programs.program.evaluate(nodes, oracle.state.values, oracle.state.numbers)
            if not any(isinstance(value, arb) for value in values):  # these are as wide as the working precision has it
                self._masses[oracle] = programs, values
        return values

    @cached_property
    def rational(self) -> tuple[Oracle, ...]:
        return tuple(self._oracle(state) for state in rational_states(self.system, self.ring, self.count))

    @cached_property
    def balls(self) -> tuple[Oracle, ...]:
        """To be used at one working precision only: values are remembered."""
        return tuple(self._oracle(state) for state in enclosed_states(self.system, self.ring, self.count))

    def _oracle(self, state: State) -> Oracle:
        """With speeds and unit vectors as the placement of the bodies gives them."""
        oracle = Oracle(self.system, state)
        if not self.system.speeds:
            return oracle
        from mbsym.mechanics.speed_states import completed  # few systems have speeds of their own

        return Oracle(self.system, completed(oracle))
