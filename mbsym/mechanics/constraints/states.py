"""Random exact states on the constraint manifold: positions, velocities and accelerations that keep all constraints.

Identities of constrained systems hold there, not everywhere.  Angles have rational sines and cosines.  Position
equations phi = 0 are solved for as many unknowns as they have independent rows: plain coordinates first, then
parameters, which are unknowns as good as any for a formula that holds for all of them (a four-bar's equations are
linear in its lengths).  One linear solution is exact where phi is linear in the unknowns, which is tried and seen;
else Newton's iteration gives a place for a ball, and Krawczyk's test proves that it holds a root.  Velocities and
accelerations follow from linear equations.

Where phi is not linear it may leave several branches, with ranks of their own (a chain of links may also be folded).
Then states are sought on the branch that the description begins on, if it says where: from there, by steps along the
constraints, and by parameters near those that it gives.  A mechanism may move at its values only (three bars of one
length): then parameters stay as they are, and ``at_values`` says so.
"""

from __future__ import annotations

import math
import random
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

from flint import arb, fmpq

from mbsym.algebra import krawczyk, rationals
from mbsym.algebra.base import Algebra, Lowering
from mbsym.algebra.derivative import jacobian
from mbsym.algebra.failures import NOT_THERE, NotRational
from mbsym.algebra.point import Balls, Rationals
from mbsym.algebra.program import Node
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.tree import Expression
from mbsym.mechanics.constraints.programs import ConstrainedPrograms
from mbsym.mechanics.constraints.ranks import Eliminated, eliminated, is_certain
from mbsym.mechanics.oracle import State
from mbsym.mechanics.states import SEED, drawn, is_allowed
from mbsym.model.admissibility import known_values
from mbsym.model.system import System, acceleration_name, velocity_name

#: Bits of enclosures, and how small a box is that a root is proved in.
PRECISION, WIDTH = 640, -200

#: Below 2 to this, pivots of a place that Newton's iteration has almost led to the constraints are those of no row.
ALMOST = -100

#: What others leave at most of a row of length 1 that may follow from them on the constraints, near these: the first
#: that leads to a place where all rows hold.
FAINT = (1e-1, 1e-3, 1e-6)

#: How far from the description's position its own branch is looked for; how far from there states are, and parameters.
NEAR, APART, CHANGED = 0.5, 0.12, 0.15

_ATTEMPTS, _TRIED, _NEWTON, _LED = 40, 8, 60, 8


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
        self.programs = found
        self.program = found.tree.program
        self._known_slopes: dict[tuple[str, ...], tuple[tuple[Node, ...], ...]] = {}

    @cached_property
    def _positions(self) -> list[Node]:
        return [node for node in self.programs.position if node is not None]

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
        draw, yielded = self._rational, 0
        for attempt in range(_ATTEMPTS * count):
            try:
                state = draw(source)
            except NotRational:
                state = None
            except NOT_THERE:
                continue
            if state is None or (draw == self._rational and not yielded and self._elsewhere(state)):
                draw = self._enclosed if self._begin is None else self._beside
                continue
            if attempt < _ATTEMPTS * count // 2 and not is_allowed(
                self.system, state.state.numbers, state.state.values
            ):
                continue  # parameters may have been solved for
            yielded += 1
            yield state
            if yielded == count:
                return

    @property
    def at_values(self) -> bool:
        """Whether parameters had to stay at their values, beside which the rank is another (``rank_beside``)."""
        return self._begin is not None and self.rank_beside is not None

    def _elsewhere(self, on_manifold: OnManifold) -> bool:
        """Whether the rank at a state is not that of the branch on which the description begins."""
        own = self._own_rank
        return own is not None and own != self._pivots(on_manifold.state.values, on_manifold.state.numbers).rank

    @cached_property
    def _own_rank(self) -> int | None:
        """The rank of J at the given parameters, on the branch on which the description begins."""
        if self._begin is None:
            return None
        try:
            return self._rank(self._followed(self._moved(self._begin, random.Random(SEED))))
        except NOT_THERE:
            return None

    @cached_property
    def rank_beside(self) -> int | None:
        """The rank of J where parameters are a little others, if it is not the one at the given values."""
        begin, source = self._begin, random.Random(SEED)
        if begin is None or not self._holds_parameters:
            return None
        others = []
        for _ in range(_TRIED):  # parameters that have to be led back may be led to those given
            with suppress(*NOT_THERE):
                others.append(self._rank(self._closed_anew(self._changed(self._moved(begin, source), source))))
        other = max(others, default=self._own_rank)
        return None if other == self._own_rank else other

    @property
    def _holds_parameters(self) -> bool:
        """Whether the rows depend on parameters at all."""
        nodes = [*self._positions, *(x for row in self.programs.jacobian for x in row)]
        names = {str(self.program.instructions[k].payload) for k in self.program.live(nodes)}
        return not names.isdisjoint(self.system.parameter_names)

    def _rank(self, values: Mapping[str, Any]) -> int:
        return self._pivots(values, Balls(dict(values))).rank

    def _pivots(self, values: Mapping[str, Any], numbers: Algebra) -> Eliminated:
        """J at a place, eliminated."""
        n = len(self.system.coordinates)
        flat = self.program.evaluate([x for row in self.programs.jacobian for x in row], values, numbers)
        return eliminated([flat[i : i + n] for i in range(0, len(flat), n)], range(n))

    @cached_property
    def _begin(self) -> dict[str, Any] | None:
        """The description's position on the constraints, or near them; None where it gives none.

        A little further on its way, if it moves: it may begin where branches meet.
        """
        system = self.system
        initial = {value.coordinate: value for value in system.initial if value.position is not None}
        motion = {entry.coordinate: entry for entry in system.motion}
        places: dict[str, Expression | None] = {name: value.position for name, value in initial.items()}
        rates: dict[str, Expression | None] = {name: value.velocity for name, value in initial.items()}
        if places.keys() < {*system.coordinates}:
            places = {**{name: entry.value for name, entry in motion.items()}, **places}
            rates = {**{name: entry.rate for name, entry in motion.items()}, **rates}
        if not self._positions or places.keys() < {*system.coordinates}:
            return None
        _, rational = self._random(random.Random(SEED))
        known = {name: fmpq(x.numerator, x.denominator) for name, x in known_values(system).items()}
        values = {name: arb(x) for name, x in (rational | known | {"t": 0}).items()} | {"pi": arb.pi()}
        lower = Lowering(Balls(dict(values)), dict(values))
        try:
            values |= {name: arb(lower(place).mid()) for name, place in places.items() if place is not None}
            begun = self._followed(values)
            way = {name: lower(rate) for name, rate in rates.items() if rate is not None}
        except NOT_THERE:
            return None
        largest = max((float(abs(x).upper()) for x in way.values()), default=0.0)
        if not largest:
            return begun
        further = {name: arb((begun[name] + x * arb(APART / largest)).mid()) for name, x in way.items()}
        timed = {"t": arb(APART / largest)}
        with suppress(*NOT_THERE):
            return self._followed(begun | further | timed)
        return begun

    def _sizes(self, place: Mapping[str, Any]) -> list[float]:
        """What distances of coordinates are measured by: an angle x by 1 + |x| without whole turns, others by the
        largest of them and by what moves rows as much as a turn by 1 does."""
        names, angles = self.system.coordinates, self.ring.angles
        values = [float(arb(place[name]).mid()) for name in names]
        largest = max((abs(x) for name, x in zip(names, values, strict=True) if name not in angles), default=0.0)
        found = [0.0] * len(names)
        for slopes in self._phi(names, place, Balls(dict(place)))[1]:
            row = [abs(float(arb(x).mid())) for x in slopes]
            turned = max((x for name, x in zip(names, row, strict=True) if name in angles), default=0.0)
            found = [max(size, turned / x if x else 0.0) for size, x in zip(found, row, strict=True)]
        return [
            1 + abs(math.remainder(x, math.tau)) if name in angles else max(largest, size) or 1.0
            for name, x, size in zip(names, values, found, strict=True)
        ]

    def _beside(self, source: random.Random) -> OnManifold:
        """A state on the branch of the description's position."""
        begin = self._begin
        assert begin is not None
        if self.at_values:
            values = self._followed(self._moved(begin, source))
        else:
            values = self._closed_anew(self._changed(self._moved(begin, source), source))
        return OnManifold(State(Balls(values), self._moving(Balls(values), values, source)), False)

    def _moved(self, begin: Mapping[str, Any], source: random.Random) -> dict[str, Any]:
        """A place a little along the constraints, and any velocities and accelerations."""
        names = self.system.coordinates
        values = dict(begin)
        for name in names:
            for suffix in (velocity_name, acceleration_name):
                values[suffix(name)] = arb(fmpq(source.randint(-40, 40) or 1, source.randint(1, 24)))
        done = self._pivots(begin, Balls(dict(begin)))
        sizes = self._sizes(begin)
        step = {k: arb(source.choice((-1, 1)) * source.randint(50, 100) * x) / 100 for k, x in enumerate(sizes)}
        free = [k for k in range(len(names)) if k not in done.columns]
        for i, column in done.pivots:
            step[column] = -sum((done.rows[i][k] * step[k] for k in free), arb(0))
        largest = max(float(abs(x).upper()) / size for x, size in zip(step.values(), sizes, strict=True))
        for k, name in enumerate(names):
            moved = values[name] + step[k] * arb(APART / max(largest, 1.0))
            values[name] = arb(moved.mid())
        return values

    def _changed(self, values: Mapping[str, Any], source: random.Random) -> dict[str, Any]:
        """The same place with other parameters, not far from those that it has."""
        changed = dict(values)
        for name in self.system.parameter_names:
            if name in changed:
                factor = 1 + CHANGED * source.choice((-1, 1)) * source.randint(20, 100) / 100
                changed[name] = arb((changed[name] * arb(factor)).mid())
        return changed

    def rank_with_parameters(self, at: OnManifold) -> int:
        """The rank of d phi / d (q, parameters) at a state: greater than that of J where parameters are tied, too."""
        if not self._positions:
            return 0
        names = [*self.system.coordinates, *self.system.parameter_names]
        return eliminated(self._phi(names, at.state.values, at.state.numbers)[1], range(len(names))).rank

    def relation(self, states: Sequence[OnManifold]) -> Polynomial | None:
        """A polynomial in the parameters that vanishes at the states, where phi = 0 demands one relation of them.

        The normal of it, sum_i y_i d phi_i/dp with y^T d phi/dq = 0, is constant at all of them for a linear relation;
        for one between products of powers it is so times the parameters.  None where it is neither.
        """
        names, parameters = self.system.coordinates, self.system.parameter_names
        normals: list[list[arb]] = []
        for enclosed in (state.enclosed for state in states):
            _, slopes = self._phi([*names, *parameters], enclosed.state.values, enclosed.state.numbers)
            done = eliminated(slopes, range(len(names)))
            pivots = {i for i, _ in done.pivots}
            left = [[arb(x) for x in row[len(names) :]] for i, row in enumerate(done.rows) if i not in pivots]
            normals.append(max(left, key=lambda row: max(float(abs(x).upper()) for x in row)))
        values = [[arb(state.enclosed.state.values[name]) for name in parameters] for state in states]
        return self._linear_relation(normals, values) or self._relation_of_powers(normals, values)

    def _linear_relation(self, normals: Sequence[Sequence[arb]], values: Sequence[Sequence[arb]]) -> Polynomial | None:
        weights = _common_ratios(normals)
        if weights is None:
            return None
        constants = [sum((arb(w) * x for w, x in zip(weights, own, strict=True)), arb(0)) for own in values]
        constant = _common_number(constants)
        if constant is None:
            return None
        bottom = math.lcm(*(int(w.q) for w in (*weights, constant)))
        whole = self.ring.number(-_whole(constant * bottom))
        for name, w in zip(self.system.parameter_names, weights, strict=True):
            whole = whole + self.ring.times(self.ring.number(_whole(w * bottom)), self._parameter(name))
        return whole

    def _parameter(self, name: str) -> Polynomial:
        return self.ring.generator("parameter", name)

    def _relation_of_powers(
        self, normals: Sequence[Sequence[arb]], values: Sequence[Sequence[arb]]
    ) -> Polynomial | None:
        pairs = zip(normals, values, strict=True)
        powers = _common_ratios([[w * x for w, x in zip(row, own, strict=True)] for row, own in pairs])
        if powers is None:
            return None
        bottom = math.lcm(*(int(w.q) for w in powers))
        whole = [_whole(w * bottom) for w in powers]
        products = []
        for own in values:
            product = arb(1)
            for w, x in zip(whole, own, strict=True):
                product *= x**w
            products.append(product)
        constant = _common_number(products)
        if constant is None:
            return None
        sides = [self.ring.one, self.ring.number(Fraction(int(constant.p), int(constant.q)))]
        for name, w in zip(self.system.parameter_names, whole, strict=True):
            for _ in range(abs(w)):
                sides[w < 0] = self.ring.times(sides[w < 0], self._parameter(name))
        return sides[0] - sides[1]

    def ranks_at_values(self) -> tuple[int, ...]:
        """The ranks of J at positions that were found at the given values of the parameters."""
        ranks = [] if self._own_rank is None else [self._own_rank]
        for values in self._roots_at_values(_TRIED):
            with suppress(*NOT_THERE):
                ranks.append(self._rank(values))
        return tuple(ranks)

    @cached_property
    def is_kept_at_values(self) -> bool:
        """Whether a position that keeps all constraints was found at the given values of the parameters."""
        return self._own_rank is not None or next(self._roots_at_values(2 * _TRIED), None) is not None

    def _roots_at_values(self, tries: int) -> Iterator[dict[str, Any]]:
        """Proved roots near random places, at the given values of the parameters."""
        known = {name: arb(fmpq(x.numerator, x.denominator)) for name, x in known_values(self.system).items()}
        source = random.Random(SEED)
        for _ in range(tries):
            with suppress(*NOT_THERE):
                yield self._root(self._drawn(source) | known, self.system.coordinates)

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
        n = len(names)
        rows = [[*row, -x] for x, row in zip(*self._phi(names, values, numbers), strict=True)]
        done = eliminated(rows, range(n))
        changed = dict(values)
        for i, column in done.pivots:
            changed[names[column]] = values[names[column]] + done.rows[i][n]
        left = self.program.evaluate(self._positions, changed, numbers)
        vanished = any(changed[name] == 0 for name in self.system.parameter_names if name in changed)
        return changed if all(x == 0 for x in left) and not vanished else None

    def _slopes(self, names: Sequence[str]) -> tuple[tuple[Node, ...], ...]:
        known = self._known_slopes.get(tuple(names))
        if known is None:
            inputs = [self.programs.environment[name] for name in names]
            known = self._known_slopes[tuple(names)] = jacobian(self.program, self._positions, inputs)
        return known

    def _phi(
        self, names: Sequence[str], place: Mapping[str, Any], numbers: Algebra
    ) -> tuple[list[Any], list[list[Any]]]:
        """phi at a place, and its slopes by the names."""
        m, n = len(self._positions), len(names)
        nodes = [*self._positions, *(x for row in self._slopes(names) for x in row)]
        entries = self.program.evaluate(nodes, place, numbers)
        return entries[:m], [entries[m + i * n : m + (i + 1) * n] for i in range(m)]

    # --- velocities and accelerations, by linear equations ---

    def _moving(self, numbers: Algebra, values: dict[str, Any], source: random.Random) -> dict[str, Any]:
        """The same place with velocities and accelerations that keep the constraints."""
        names = self.system.coordinates
        n = len(names)
        order = list(range(n))
        source.shuffle(order)  # no coordinate is dependent always
        for suffix, remainder in (
            (velocity_name, self.programs.velocity),
            (acceleration_name, self.programs.acceleration),
        ):
            flat = [x for row in self.programs.jacobian for x in row]
            entries = self.program.evaluate([*flat, *remainder], values, numbers)
            rows = [[*entries[i * n : (i + 1) * n], entries[len(flat) + i]] for i in range(len(remainder))]
            if suffix is acceleration_name:  # gamma + J q''
                for row in rows:
                    row[n] = sum((x * values[suffix(name)] for x, name in zip(row, names, strict=False)), row[n])
            done = eliminated(rows, order)
            values = dict(values)
            for i, column in done.pivots:
                values[suffix(names[column])] = values[suffix(names[column])] - done.rows[i][n]
        return values

    # --- enclosures ---

    def _drawn(self, source: random.Random) -> dict[str, Any]:
        """A random place, which need not be on the constraints."""
        _, rational = self._random(source)
        values = {name: arb(value) for name, value in rational.items()} | {"pi": arb.pi()}
        for name in self.ring.angles:
            if name in values:
                values[name] = arb(source.randint(-300, 300)) / 100
        return values

    def _enclosed(self, source: random.Random) -> OnManifold | None:
        values = self._drawn(source)
        if self._positions:
            values = self._closed_anew(values, far=True)
        return OnManifold(State(Balls(values), self._moving(Balls(values), values, source)), False)

    def _closed_anew(self, values: dict[str, Any], far: bool = False) -> dict[str, Any]:
        """A root in the coordinates, or where parameters are tied, too, in these as well."""
        try:
            return self._root(values, self.system.coordinates) if far else self._followed(values)
        except ZeroDivisionError:
            further = [x for x in self._unknowns if x not in self.system.coordinates]
            root = self._root(values, (*self.system.coordinates, *further))
            if any(not is_certain(root[name]) for name in further):
                raise
            return root

    def _followed(self, values: dict[str, Any]) -> dict[str, Any]:
        """A root in the coordinates not far from a place; where rows follow from others on it alone, by the shortest
        way.  Raises as ``_root`` does, ZeroDivisionError where it is far."""
        names = self.system.coordinates
        for faint in (None, *FAINT):
            with suppress(ZeroDivisionError):
                led, rows = (values, None) if faint is None else self._led(values, faint)
                return self._not_far(values, self._root(led, names, rows))
        raise ZeroDivisionError("no root was proved near the place")

    def _not_far(self, values: Mapping[str, Any], root: dict[str, Any]) -> dict[str, Any]:
        for name, size in zip(self.system.coordinates, self._sizes(values), strict=True):
            if not abs(float(root[name].mid()) - float(values[name].mid())) <= NEAR * size:
                raise ZeroDivisionError("on another branch, perhaps")
        return root

    def _led(self, values: dict[str, Any], faint: float) -> tuple[dict[str, Any], list[int]]:
        """A place closer to phi = 0, and the rows that are independent there.

        Off the constraints more rows are independent than on them, the farther the more: those of which the others
        leave less than ``faint`` lead nowhere, and are left out.
        """
        names, sizes = self.system.coordinates, [arb(x) for x in self._sizes(values)]
        rows: list[int] = []
        for _ in range(_LED):
            residual, table = self._phi(names, values, Balls(dict(values)))
            middles = ([arb(arb(x).mid()) for x in row] for row in table)
            slopes = [{k: x * sizes[k] for k, x in enumerate(row) if x != 0} for row in middles]
            rows, step = _shortest(slopes, [arb(arb(x).mid()) for x in residual], faint)
            values = values | {names[k]: arb((values[names[k]] - x * sizes[k]).mid()) for k, x in step.items()}
        return values, sorted(rows)

    def _root(
        self, values: dict[str, Any], names: Sequence[str], chosen: Sequence[int] | None = None
    ) -> dict[str, Any]:
        """A proved root of phi near a place, in those of the names that phi depends on most there.

        Steps are by the rows that are ``chosen``, or by all; the others must hold at the root.  Raises SingularPoint or
        NoValue as the rows do, ZeroDivisionError where no root was proved.
        """
        n = len(names)

        def at(place: Mapping[str, Any]) -> tuple[list[Any], list[list[Any]]]:
            return self._phi(names, place, Balls(dict(place)))

        taken, limit = range(len(self._positions)) if chosen is None else chosen, 0.0
        for _ in range(_NEWTON):
            residual, rows = at(values)
            table = [[*rows[i], residual[i]] for i in taken]
            done = eliminated(table, range(n), arb(2) ** ALMOST)
            worst = max(float(abs(arb(x)).upper()) for x in residual)
            limit = limit or 1e6 * max(1.0, worst)
            if not worst < limit:
                raise ZeroDivisionError("Newton's iteration leaves")
            values = dict(values)
            for i, column in done.pivots:
                values[names[column]] = arb((values[names[column]] - done.rows[i][n]).mid())
            if worst < 2.0 ** (WIDTH * 2):
                break
        unknown = [names[column] for column in done.columns]
        independent = [taken[i] for i, _ in done.pivots]
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
        root = place(image)
        residual, slopes = at(root)
        if any(is_certain(x) for x in residual):
            raise ZeroDivisionError("the other rows do not hold there")
        if not all(_is_narrow(x) for row in (residual, *slopes) for x in row):  # sin of 1e400 may be anything
            raise ZeroDivisionError("too wide to tell whether the other rows hold there")
        return root


#: A row or a way by places; mechanisms have few in a row.
Sparse = dict[int, arb]


def _shortest(rows: Sequence[Sparse], right: Sequence[arb], faint: float) -> tuple[list[int], Sparse]:
    """Rows that are independent, the most independent one next, and the shortest x with row . x = right for these.

    Rows are measured by their lengths; one of which others leave less than ``faint`` is left out.
    """
    lengths = [_length(row) for row in rows]
    left = {i: {k: x / lengths[i] for k, x in row.items()} for i, row in enumerate(rows) if is_certain(lengths[i])}
    sizes, rest = {i: arb(1) for i in left}, {i: right[i] / lengths[i] for i in left}
    independent: list[int] = []
    shortest: Sparse = {}
    while left:
        i = max(left, key=lambda k: float(sizes[k]))
        row, size, part = left.pop(i), sizes.pop(i), rest.pop(i)
        if size < faint:
            break
        independent.append(i)
        direction, part = {k: (x / size).mid() for k, x in row.items()}, (part / size).mid()
        _add(shortest, part, direction)
        for k, other in left.items():
            common = _product(other, direction)
            if common != 0:
                _add(other, -common, direction)
                rest[k], sizes[k] = (rest[k] - common * part).mid(), _length(other)
    return independent, shortest


def _add(row: Sparse, factor: arb, other: Sparse) -> None:
    for k, x in other.items():
        row[k] = (row.get(k, arb(0)) + factor * x).mid()


def _product(x: Sparse, y: Sparse) -> arb:
    return arb(sum((x[k] * y[k] for k in x.keys() & y.keys()), arb(0)).mid())


def _length(x: Sparse) -> arb:
    return arb(_product(x, x).sqrt().mid())


def _is_narrow(x: Any) -> bool:
    """Whether an enclosure is so narrow that zero in it means something."""
    return not isinstance(x, arb) or bool(x.rad() < (1 + abs(x.mid())) * arb(2) ** (WIDTH // 2))


#: Denominators of what is taken for rational where an enclosure holds it.
_SHORT = 10_000


def _rational_in(x: arb) -> fmpq | None:
    """The number with a short denominator that an enclosure holds; None where none does."""
    short = rationals.fraction(rationals.middle(x)).limit_denominator(_SHORT)
    near = arb(fmpq(short.numerator, short.denominator))
    return fmpq(short.numerator, short.denominator) if bool(abs(x - near) < arb(2) ** ALMOST) else None


def _whole(x: fmpq) -> int:
    return int(x.p) // int(x.q)


def _common_number(values: Sequence[arb]) -> fmpq | None:
    """The rational number that all are; None where they are not."""
    numbers = [_rational_in(x) for x in values]
    return numbers[0] if numbers[0] is not None and all(x == numbers[0] for x in numbers) else None


def _common_ratios(rows: Sequence[Sequence[arb]]) -> list[fmpq] | None:
    """Rational numbers to which every row is proportional; None where there are none."""
    first = max(range(len(rows[0])), key=lambda k: float(abs(rows[0][k]).upper()))
    if not all(is_certain(row[first]) for row in rows):
        return None
    ratios = [_common_number([row[k] / row[first] for row in rows]) for k in range(len(rows[0]))]
    return None if any(x is None for x in ratios) else [x for x in ratios if x is not None]
