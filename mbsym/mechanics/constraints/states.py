"""Random exact states on the constraint manifold: positions, velocities and accelerations that keep all constraints.

Identities of constrained systems hold there, not everywhere.  Angles have rational sines and cosines.  Position
equations phi = 0 are solved for as many unknowns as they have independent rows: plain coordinates first, then
parameters, which are unknowns as good as any for a formula that holds for all of them (a four-bar's equations are
linear in its lengths).  One linear solution is exact where phi is linear in the unknowns, which is tried and seen;
else Newton's iteration gives a place for a ball, and Krawczyk's test proves that it holds a root.  Velocities and
accelerations follow from linear equations.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from flint import arb, fmpq

from mbsym.algebra import krawczyk
from mbsym.algebra.base import Algebra
from mbsym.algebra.derivative import jacobian
from mbsym.algebra.failures import NOT_THERE, NotRational
from mbsym.algebra.point import Balls, Rationals
from mbsym.algebra.program import Node
from mbsym.algebra.ring import Ring
from mbsym.mechanics.constraints.programs import ConstrainedPrograms
from mbsym.mechanics.constraints.ranks import eliminated, is_certain
from mbsym.mechanics.oracle import State
from mbsym.mechanics.states import SEED, drawn, is_allowed
from mbsym.model.system import System, acceleration_name, velocity_name

#: Bits of enclosures, and how small a box is that a root is proved in.
PRECISION, WIDTH = 640, -200

_ATTEMPTS, _NEWTON = 40, 60


@dataclass(frozen=True)
class OnManifold:
    """A state that keeps all constraints; ``exact`` with rational numbers, else certified enclosures."""

    state: State
    exact: bool

    @property
    def enclosed(self) -> OnManifold:
        """The same state in enclosures, for what has no rational value there; its angles by their sines and cosines."""
        numbers = self.state.numbers
        if not isinstance(numbers, Rationals):
            return self
        values = {name: arb(x) for name, x in self.state.values.items()} | {"pi": arb.pi()}
        for name, (sine, cosine) in numbers.basic.items():
            values[name] = arb(numbers.denominators[name]) * arb.atan2(arb(sine), arb(cosine))
        return OnManifold(State(Balls(values), values), False)


class Manifold:
    """The constraint manifold of a system, and states on it."""

    def __init__(self, system: System, ring: Ring, found: ConstrainedPrograms) -> None:
        self.system = system
        self.ring = ring
        self.found = found
        self.program = found.tree.program

    @cached_property
    def _positions(self) -> list[Node]:
        return [node for node in self.found.position if node is not None]

    @cached_property
    def _unknowns(self) -> list[str]:
        """Names that phi may be solved for at rational angles: plain coordinates, then parameters."""
        plain = [name for name in self.system.coordinates if name not in self.ring.angles]
        return plain + [name for name in self.system.parameter_names if name not in self.ring.angles]

    def states(self, count: int) -> Iterator[OnManifold]:
        """``count`` states, or fewer where none are found: rational ones if possible, else certified enclosures.

        To be used at a working precision of ``PRECISION`` where they are enclosures.
        """
        source = random.Random(SEED)
        rational, found = True, 0
        for attempt in range(_ATTEMPTS * count):
            try:
                one = self._rational(source) if rational else self._enclosed(source)
            except NotRational:
                rational = False
                continue
            except NOT_THERE:
                continue
            if one is None:
                rational = False
                continue
            if attempt < _ATTEMPTS * count // 2 and not is_allowed(self.system, one.state.numbers, one.state.values):
                continue  # parameters may have been solved for
            found += 1
            yield one
            if found == count:
                return

    def rank_with_parameters(self, at: OnManifold) -> int:
        """The rank of d phi / d (q, parameters) at a state: greater than that of J where parameters are tied, too."""
        if not self._positions:
            return 0
        names = [*self.system.coordinates, *self.system.parameter_names]
        slopes = self._slopes(names)
        flat = self.program.evaluate([x for row in slopes for x in row], at.state.values, at.state.numbers)
        n = len(names)
        return eliminated([flat[i : i + n] for i in range(0, len(flat), n)], range(n)).rank

    # --- rational numbers ---

    def _rational(self, source: random.Random) -> OnManifold | None:
        """A state in rational numbers; None where phi is not linear in what it could be solved for."""
        numbers, values = self._random(source)
        if self._positions:
            solved = self._linear(numbers, values)
            if solved is None:
                return None
            values = solved
        return OnManifold(State(numbers, self._moving(numbers, values, source)), True)

    def _random(self, source: random.Random) -> tuple[Rationals, dict[str, Any]]:
        values: dict[str, Any] = {
            name: fmpq(source.randint(-40, 40) or 1, source.randint(1, 24)) for name in self.ring.names()
        }
        known = drawn(self.system, self.ring, source)
        values |= {name: known[name] for name in (*self.system.parameter_names, "t") if name in values}
        tangents = {name: fmpq(source.randint(-9, 9) or 1, source.randint(1, 9)) for name in self.ring.angles}
        return Rationals(tangents, self.ring.angles), values | {"pi": fmpq(355, 113)}

    def _linear(self, numbers: Algebra, values: dict[str, Any]) -> dict[str, Any] | None:
        """phi = 0 solved as if it were linear; None if it was not, or only by parameters that vanish.

        Where all lengths are multiples of one, phi is homogeneous in it: lengths of 0 close any loop, and say nothing.
        """
        names = self._unknowns
        slopes = self._slopes(names)
        nodes = [*self._positions, *(x for row in slopes for x in row)]
        found = self.program.evaluate(nodes, values, numbers)
        m, n = len(self._positions), len(names)
        rows = [[*found[m + i * n : m + (i + 1) * n], -found[i]] for i in range(m)]
        done = eliminated(rows, range(n))
        changed = dict(values)
        for i, column in done.pivots:
            changed[names[column]] = values[names[column]] + done.rows[i][n]
        left = self.program.evaluate(self._positions, changed, numbers)
        vanished = any(changed[name] == 0 for name in self.system.parameter_names if name in changed)
        return changed if all(x == 0 for x in left) and not vanished else None

    def _slopes(self, names: Sequence[str]) -> tuple[tuple[Node, ...], ...]:
        inputs = [self.found.environment[name] for name in names]
        return jacobian(self.program, self._positions, inputs)

    # --- velocities and accelerations, by linear equations ---

    def _moving(self, numbers: Algebra, values: dict[str, Any], source: random.Random) -> dict[str, Any]:
        """The same place with velocities and accelerations that keep the constraints."""
        names = self.system.coordinates
        n = len(names)
        order = list(range(n))
        source.shuffle(order)  # no coordinate is dependent always
        for suffix, remainder in ((velocity_name, self.found.velocity), (acceleration_name, self.found.acceleration)):
            flat = [x for row in self.found.jacobian for x in row]
            found = self.program.evaluate([*flat, *remainder], values, numbers)
            rows = [[*found[i * n : (i + 1) * n], found[len(flat) + i]] for i in range(len(remainder))]
            if suffix is acceleration_name:  # gamma + J q''
                for row in rows:
                    row[n] = sum((x * values[suffix(name)] for x, name in zip(row, names, strict=False)), row[n])
            done = eliminated(rows, order)
            values = dict(values)
            for i, column in done.pivots:
                values[suffix(names[column])] = values[suffix(names[column])] - done.rows[i][n]
        return values

    # --- enclosures ---

    def _enclosed(self, source: random.Random) -> OnManifold | None:
        _, rational = self._random(source)
        values = {name: arb(value) for name, value in rational.items()} | {"pi": arb.pi()}
        for name in self.ring.angles:
            if name in values:
                values[name] = arb(source.randint(-300, 300)) / 100
        if self._positions:
            try:
                values = self._root(values, self.system.coordinates)
            except ZeroDivisionError:  # parameters may be tied, too
                further = [x for x in self._unknowns if x not in self.system.coordinates]
                values = self._root(values, (*self.system.coordinates, *further))
                if any(not is_certain(values[name]) for name in further):
                    raise
        return OnManifold(State(Balls(values), self._moving(Balls(values), values, source)), False)

    def _root(self, values: dict[str, Any], names: Sequence[str]) -> dict[str, Any]:
        """A proved root of phi near a place, in those of the names that phi depends on most there.

        Raises SingularPoint or NoValue as the rows do, ZeroDivisionError where no root was proved.
        """
        slopes = self._slopes(names)
        flat = [x for row in slopes for x in row]
        m, n = len(self._positions), len(names)

        def at(place: Mapping[str, Any]) -> tuple[list[Any], list[list[Any]]]:
            found = self.program.evaluate([*self._positions, *flat], place, Balls(dict(place)))
            return found[:m], [found[m + i * n : m + (i + 1) * n] for i in range(m)]

        for _ in range(_NEWTON):
            residual, rows = at(values)
            done = eliminated([[*row, r] for row, r in zip(rows, residual, strict=True)], range(n))
            worst = max(float(abs(arb(x)).upper()) for x in residual)
            if not worst < 1e6:
                raise ZeroDivisionError("Newton's iteration leaves")
            values = dict(values)
            for i, column in done.pivots:
                values[names[column]] = arb((values[names[column]] - done.rows[i][n]).mid())
            if worst < 2.0 ** (WIDTH * 2):
                break
        unknown = [names[column] for column in done.columns]
        independent = [i for i, _ in done.pivots]
        return self._proved(values, unknown, independent, at, [names.index(name) for name in unknown])

    def _proved(
        self, values: dict[str, Any], unknown: list[str], rows: list[int], at: Any, columns: list[int]
    ) -> dict[str, Any]:
        width = arb(0, arb(2) ** WIDTH)
        box = tuple(values[name] + width for name in unknown)

        def place(x: Sequence[Any]) -> dict[str, Any]:
            return {**values, **dict(zip(unknown, x, strict=True))}

        def residuals(x: Sequence[Any]) -> list[Any]:
            residual, _ = at(place(x))
            return [residual[i] for i in rows]

        def jacobian(x: Sequence[Any]) -> list[list[Any]]:
            _, slopes = at(place(x))
            return [[slopes[i][k] for k in columns] for i in rows]

        image = krawczyk.step(residuals, jacobian, box)
        if image is None or not all(outer.contains_interior(inner) for outer, inner in zip(box, image, strict=True)):
            raise ZeroDivisionError("no root was proved")
        found = place(image)
        residual, slopes = at(found)
        if any(is_certain(x) for x in residual):
            raise ZeroDivisionError("the other rows do not hold there")
        if not all(_is_narrow(x) for row in (residual, *slopes) for x in row):  # sin of 1e400 may be anything
            raise ZeroDivisionError("too wide to tell whether the other rows hold there")
        return found


def _is_narrow(x: Any) -> bool:
    """Whether an enclosure is so narrow that zero in it means something."""
    return not isinstance(x, arb) or bool(x.rad() < (1 + abs(x.mid())) * arb(2) ** (WIDTH // 2))
