"""Initial states made consistent with constraints: the closest one to what was given, and how far each value moved.

    minimise (q - q0)^T M (q - q0)       subject to  f(q, 0) = 0                M of the given position
    minimise (q' - q0')^T M (q' - q0')   subject to  J q' + j = 0               M of the position found

The first by Newton's method on the constraints (each step the shortest) and then along them (Gauss-Newton), the second
is linear.  Values that are fixed stay.  Dependent rows do no harm: least squares.  What was found in float64 is refined
to ``PRECISION`` bits, residuals being computed in that many, so that every arithmetic begins on the constraints.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, TypeVar

import numpy as np
from flint import arb, ctx

from mbsym.algebra import rationals
from mbsym.algebra.failures import Constrained, Failure
from mbsym.expressions.message import Message, joined
from mbsym.mechanics.constraints.rows import RowName
from mbsym.model.states import InStates
from mbsym.numerics.constrained import Constraints
from mbsym.numerics.kernels.precise import precise
from mbsym.numerics.scenario import PRECISION, Scenario, rounded
from mbsym.numerics.states import dynamics_of, scenario_in_states, scenario_in_velocities

#: Steps of Newton's method and of the descent to the least gap, of the way along the constraints, of the refinement.
STEPS, ALONG, REFINED = 200, 60, 40

#: The least part of a step of Newton's method that is tried.
LEAST_PART = 1 / 64

#: So many ways aside of the start are tried where no whole step of Newton's method leads to the constraints.
MOST_BESIDE = 8

#: A gap of a row is closed below this part of the row's slope times the coordinates' sizes.
CLOSED = 1e-11

#: A value that was led here is nought.
NOUGHT = 1e-30

#: Below this part of its size a value has not moved but for roundings.
MOVED = 1e-12

#: Singular values of J M^-1/2 below this part of the largest count as zero.
RANK = 1e-9


@dataclass(frozen=True)
class Move:
    """A value of the initial state that was changed, by ``part`` of its size in the scene."""

    name: str
    given: float
    found: float
    part: float


@dataclass(frozen=True)
class Closed:
    """``scenario`` begins on its constraints; ``moves`` are the values that had to be changed beyond roundings.

    ``closest`` says whether the position is the closest one, or only one near it; ``fixed`` are the values that stayed,
    ``left_out`` the velocities that the description does not give; ``follow``: these follow from those that it gives,
    in the columns of the velocities left out J has their number as rank.
    """

    scenario: Scenario
    moves: tuple[Move, ...] = ()
    closest: bool = True
    fixed: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()
    follow: bool = True

    @property
    def given_stays(self) -> bool:
        """Whether only values were changed that were left out."""
        return all(move.name in self.left_out for move in self.moves)


@dataclass(frozen=True)
class Gap:
    """What is left of a row: |f| of its constraint for positions, |g| for velocities, at the closest state."""

    row: RowName
    size: float
    velocity: bool = False


class NotClosed(Failure):
    """No state near the given one satisfies the constraints: ``state`` (2n,) is the closest found, with ``gaps``.

    ``singular``: it does in float64, and no more digits of it are found since the constraints lose their rank there.
    """

    code = "not-closed"

    def __init__(self, state: Any, gaps: Sequence[Gap], fixed: Sequence[str], singular: bool = False) -> None:
        worst = max(gaps, key=lambda gap: gap.size)
        if singular:
            text = (
                "the constraints are satisfied only to roundings: near what is given they seem to lose their rank (gap "
                "[[gap]] in [[row]])"
            )
        elif worst.velocity:
            text = (
                "the constraints cannot be closed at these values: no velocities satisfy them near what is given (gap "
                "[[gap]] in [[row]])"
            )
        else:
            text = (
                "the constraints cannot be closed at these values: no position satisfies them near what is given (gap "
                "[[gap]] in [[row]])"
            )
        held = [Message("fixed: [[names]]", names=", ".join(fixed))] if fixed else []
        super().__init__(joined([Message(text, gap=f"{worst.size:.6g}", row=worst.row.label), *held], "; "))
        self.state, self.gaps, self.fixed, self.singular = state, tuple(gaps), tuple(fixed), singular


class NothingMoves(Constrained):
    """The constraints leave no velocity free at the state that they allow, and nothing is driven."""

    code = "no-freedom"

    def __init__(self, found: Scenario) -> None:
        place = zip(found.system.coordinates, map(float, found.positions), strict=True)
        shown = ", ".join(f"{name} = {x if abs(x) > NOUGHT else 0:.9g}" for name, x in place)
        text = "the constraints leave no freedom at these values: nothing can move from [[state]], which satisfies them"
        remedy = Message("check lengths and angles: a mechanism that closes on itself may move at special values only")
        super().__init__(Message(text, state=shown), remedy=remedy)


def moving(closure: Closed) -> Closed:
    """What was closed.  Raises NothingMoves where its constraints hold it."""
    constraints = _constraints(closure.scenario)
    if constraints is None or constraints.freedom or not constraints.steady:
        return closure
    state = np.array([float(x) for x in closure.scenario.state])
    if len(constraints.independent(0.0, state)) == constraints.size:  # else it may move from a singular position
        raise NothingMoves(closure.scenario)
    return closure


def begun(scenario: Scenario, fixed: Collection[str] = (), declared: bool = True) -> Closed:
    """The scenario in the variables of its run, on its constraints.

    ``declared``: those that a description with speeds declares; else coordinates and their velocities.  Raises
    NotClosed, Failure.
    """
    closure = closed(fitted(scenario, declared), fixed)
    return replace(closure, scenario=shown(closure.scenario, declared))


def fitted(scenario: Scenario, declared: bool) -> Scenario:
    """The scenario in the variables in which it is fitted to constraints: what is given in declared ones, in these."""
    if not scenario.system.speeds or isinstance(scenario.system, InStates):
        return scenario
    in_angles = not any(body.orientation for body in scenario.system.bodies)
    if scenario.declared and (declared or in_angles):
        return scenario_in_states(scenario)
    return scenario if declared else replace(scenario, system=scenario.system.without_speeds)


def shown(scenario: Scenario, declared: bool) -> Scenario:
    """In the variables of the run."""
    if isinstance(scenario.system, InStates):
        return scenario if declared else scenario_in_velocities(scenario)
    return scenario_in_states(scenario) if declared and scenario.system.speeds else scenario


def closed(scenario: Scenario, fixed: Collection[str] = ()) -> Closed:
    """The scenario with the closest initial state that its constraints allow; itself where there are none.

    ``fixed`` names coordinates and velocities whose values must stay.  Where the coordinates that the description calls
    dependent, and the velocities that were left out, can be fitted by themselves, what was given stays as well.  Raises
    NotClosed.
    """
    if not scenario.system.constraints:
        return Closed(scenario)
    constraints = _constraints(scenario)
    assert constraints is not None
    system, p = scenario.system, constraints.places
    names = (*system.coordinates, *system.velocities)
    held = tuple(name for name in names if name in fixed)
    exact = _Exact(constraints)
    if exact.satisfied(scenario.state):
        return Closed(scenario, fixed=held)
    start = np.array([float(x) for x in scenario.state])
    stated = {
        *(name for name in system.coordinates if system.dependent and name not in system.dependent),
        *(name for name in system.velocities if scenario.unstated and name not in scenario.unstated),
    }
    searches = [_Search(constraints, names, held)]
    if stated:
        searches.insert(0, _Search(constraints, names, tuple(name for name in names if name in stated or name in held)))
    position, closest = _first(searches, lambda search: search.position(start))
    there = np.concatenate([position, start[p:]])
    state = _first(searches, lambda search: search.velocity(there))
    refined = _first(searches, lambda search: exact.refined(scenario.state, state, search))
    moved = {name for name, old, new in zip(names, scenario.state, refined, strict=True) if old != new}
    typed = {name: value for name, value in scenario.typed.items() if name not in moved}
    new = replace(scenario, positions=tuple(refined[:p]), velocities=tuple(refined[p:]), typed=typed)
    follow = searches[0].determined(np.array([float(x) for x in refined]))
    return Closed(new, moves(scenario, new, constraints), closest, held, scenario.unstated, follow)


def moves(given: Scenario, taken: Scenario, constraints: Constraints | None = None) -> tuple[Move, ...]:
    """What an initial state was changed by, but for roundings."""
    constraints = _constraints(taken) if constraints is None else constraints
    assert constraints is not None
    names = (*given.system.coordinates, *given.system.velocities)
    sizes = constraints.sizes([float(x) for x in taken.state]).tolist()
    return tuple(
        Move(name, float(old), float(new), float(abs(old - new)) / size)
        for name, old, new, size in zip(names, given.state, taken.state, sizes, strict=True)
        if abs(old - new) > MOVED * size
    )


def _constraints(scenario: Scenario) -> Constraints | None:
    """Those of a scenario in its variables."""
    return dynamics_of(scenario).constraints


T = TypeVar("T")


def _first(searches: Sequence[_Search], find: Callable[[_Search], T]) -> T:
    """What the first of them finds; raises what the last one raises."""
    for search in searches[:-1]:
        try:
            return find(search)
        except NotClosed:
            continue
    return find(searches[-1])


class _Search:
    """The way to the constraints in float64, with some values free."""

    def __init__(self, constraints: Constraints, names: Sequence[str], fixed: tuple[str, ...]) -> None:
        self.constraints, self.fixed = constraints, fixed
        self.n, self.p, self.h = constraints.size, constraints.places, constraints.holonomic
        own = (None if place is None else names[place] for place in constraints.own_places)
        #: By ways that a position can go, and by velocities.
        self.free = np.array([name not in fixed for name in own]), np.array([x not in fixed for x in names[self.p :]])

    def rows(self, state: Any, velocity: bool) -> tuple[Any, Any, Any]:
        """(f or g, A = J W, W): W (n, free) takes lengths measured by M to the free values."""
        values = self.constraints.at(0.0, state)
        free = self.free[velocity]
        weights = np.zeros((self.n, int(np.sum(free))))
        whole = self.constraints.weights(0.0, state)
        masses = np.linalg.inv(whole @ whole.T)[np.ix_(free, free)]
        if masses.size:
            weights[free] = np.linalg.inv(np.linalg.cholesky((masses + masses.T) / 2)).T
        rows = values.velocities if velocity else values.positions
        return rows, values.partials[: len(rows)] @ weights, weights

    def determined(self, state: Any) -> bool:
        """Whether the velocities that are free follow from the others at this state."""
        _, columns, _ = self.rows(state, True)
        return bool(np.linalg.matrix_rank(columns, rtol=RANK) == columns.shape[1])

    def position(self, start: Any) -> tuple[Any, bool]:
        """A position on the constraints, and whether it is the closest one to ``start``.  Raises NotClosed."""
        if not self.h:
            return start[: self.p].copy(), True
        feasible, straight = self._descended(start)
        better, closest = self._along(feasible, start)
        if straight:
            return better[: self.p], closest
        # A mechanism closes in several ways; the one that was found may be folded up far away from another.
        sizes = self.constraints.extents(start)
        far = np.linalg.norm(self.constraints.towards(0.0, start, better) / sizes)
        free = np.where(self.free[False], sizes, 0.0) / 2
        ways = np.vstack([free, np.diag(free)[self.free[False]][:MOST_BESIDE]])
        for way in (*ways, *-ways):
            try:
                beside, _ = self._descended(self.constraints.displaced(0.0, start, way))
            except NotClosed:
                continue
            other, stationary = self._along(beside, start)
            distance = np.linalg.norm(self.constraints.towards(0.0, start, other) / sizes)
            if distance < (1 - 1e-6) * far:
                better, closest, far = other, stationary, distance
        return better[: self.p], closest

    def _descended(self, start: Any) -> tuple[Any, bool]:
        """Newton's method with steps that shorten the gap, damped (Levenberg-Marquardt) where it cannot be closed.

        A part t of a step y is taken after which f + t J y is left but for t |J y|/4: a longer one would lead far away,
        where the constraints are other ones.  Beside the position: whether whole steps led there.
        """
        iterate, damping, straight = start.copy(), 0.0, True
        f, rows, weights = self.rows(iterate, False)
        for _ in range(STEPS):
            if self._small(f, rows, iterate) and damping == 0.0:
                break
            step, part, gap = _shortest(rows, -f, damping), 1.0, np.linalg.norm(f)
            change = rows @ step
            while True:
                moved = self.constraints.displaced(0.0, iterate, weights @ (part * step))
                new, new_rows, new_weights = self.rows(moved, False)
                linear = bool(np.linalg.norm(new - f - part * change) <= part * np.linalg.norm(change) / 4)
                if linear or part < LEAST_PART:
                    break
                part, straight = part / 2, False
            if np.all(np.isfinite(new)) and np.linalg.norm(new) < gap and linear:
                iterate, f, rows, weights = moved, new, new_rows, new_weights
                damping = 0.0 if damping < 1e-6 else damping / 10
            elif self._small(f, rows, iterate):
                break
            else:
                damping = max(1e-4, 10 * damping)
                if damping > 1e12:
                    break
        if not self._small(f, rows, iterate):
            gaps = [Gap(name, abs(float(x))) for name, x in zip(self.constraints.names, f, strict=False)]
            raise NotClosed(iterate, gaps, [x for x in self.fixed if x in self.constraints.inputs[1 : self.p + 1]])
        return iterate, straight

    def _along(self, iterate: Any, start: Any) -> tuple[Any, bool]:
        """From a position on the constraints to the closest one to ``start``, as long as that leads closer."""
        for _ in range(ALONG):
            _, rows, weights = self.rows(iterate, False)
            back = self._lengths(weights, iterate, start)
            tangent = back - _shortest(rows, rows @ back)
            if np.linalg.norm(tangent) <= 1e-9 * (np.linalg.norm(back) + 1e-30) or not np.any(back):
                return self._settled(iterate, iterate), True
            part = 1.0
            while True:
                moved = self.constraints.displaced(0.0, iterate, weights @ (part * tangent))
                closer = self._settled(moved, iterate) if np.all(np.isfinite(moved)) else iterate
                if np.linalg.norm(self._lengths(weights, closer, start)) < np.linalg.norm(back):
                    break
                part /= 2
                if part < LEAST_PART:  # what is left of the way shortens it by less than roundings
                    return iterate, bool(np.linalg.norm(tangent) <= 1e-6 * np.linalg.norm(back))
            iterate = closer
        return iterate, False

    def _lengths(self, weights: Any, state: Any, start: Any) -> Any:
        """The way from a state back to ``start``, in lengths measured by M."""
        return np.linalg.lstsq(weights, self.constraints.towards(0.0, state, start), rcond=None)[0]

    def _settled(self, state: Any, otherwise: Any) -> Any:
        """A few steps of Newton's method; ``otherwise`` where they do not end on the constraints."""
        iterate = state.copy()
        for _ in range(6):
            f, rows, weights = self.rows(iterate, False)
            iterate = self.constraints.displaced(0.0, iterate, weights @ _shortest(rows, -f))
        f, rows, _ = self.rows(iterate, False)
        return iterate if self._small(f, rows, iterate) else otherwise

    def _small(self, f: Any, rows: Any, state: Any) -> bool:
        partials = np.abs(self.constraints.at(0.0, state).gradients)
        slopes = self.constraints.slopes(partials, self.constraints.sizes(state)[: self.p])
        return bool(np.all(np.abs(f) <= CLOSED * slopes))

    def velocity(self, state: Any) -> Any:
        """The state with the closest velocities that satisfy J q' + j = 0.  Raises NotClosed."""
        corrected = state.copy()
        for _ in range(3):
            g, rows, weights = self.rows(corrected, True)
            corrected[self.p :] += weights @ _shortest(rows, -g)
        g, _, _ = self.rows(corrected, True)
        partials = np.abs(self.constraints.at(0.0, corrected).partials)
        slopes = self.constraints.slopes(partials, self.constraints.sizes(corrected)[self.p :])
        if not np.all(np.abs(g) <= CLOSED * slopes):
            gaps = [Gap(name, abs(float(x)), True) for name, x in zip(self.constraints.names, g, strict=True)]
            raise NotClosed(corrected, gaps, self.fixed)
        return corrected


def _shortest(rows: Any, right: Any, damping: float = 0.0) -> Any:
    """The shortest y with rows y = right in least squares; damped: the least |rows y - right|^2 + damping s^2 |y|^2."""
    if not rows.size:
        return np.zeros(rows.shape[1])
    left, sizes, turned = np.linalg.svd(rows, full_matrices=False)
    known = sizes > RANK * sizes[0]
    inverse = np.where(known, sizes / np.where(known, sizes**2 + damping * sizes[0] ** 2, 1.0), 0.0)
    solution: Any = turned.T @ (inverse * (left.T @ right))
    return solution


class _Exact:
    """Residuals in many bits."""

    def __init__(self, constraints: Constraints) -> None:
        self._constraints = constraints
        self._bits = PRECISION + 64
        self._rows: Callable[[Sequence[arb]], list[arb]] = precise(constraints.code, self._bits)
        flow = constraints.flow
        self._restoring = None if flow is None else precise(flow.restoring, self._bits)

    def residuals(self, state: Sequence[Fraction]) -> list[arb]:
        """f and g."""
        h, r = self._constraints.holonomic, len(self._constraints)
        with ctx.workprec(self._bits):
            point = [arb(0), *(rationals.ball(x) for x in state)]
            return [x.mid() for x in self._rows(point)[: h + r]]

    def satisfied(self, state: Sequence[Fraction]) -> bool:
        """Whether the state is on the constraints as far as its bits tell."""
        values = self._constraints.at(0.0, [float(x) for x in state])
        p, slopes_of = self._constraints.places, self._constraints.slopes
        sizes = self._constraints.sizes([float(x) for x in state])
        slopes = np.concatenate(
            [slopes_of(np.abs(values.gradients), sizes[:p]), slopes_of(np.abs(values.partials), sizes[p:])]
        )
        with ctx.workprec(self._bits):
            least = arb(2) ** (32 - PRECISION)
            return all(abs(x) <= least * float(s) for x, s in zip(self.residuals(state), slopes, strict=True))

    def refined(self, initial: Sequence[Fraction], state: Any, search: _Search) -> tuple[Fraction, ...]:
        """The state with as many bits as numbers have; values that did not move keep what was given."""
        found = [Fraction(x) for x in state.tolist()]
        found = [old if float(old) == float(new) else new for old, new in zip(initial, found, strict=True)]
        h, p = self._constraints.holonomic, self._constraints.places
        for _ in range(REFINED):
            if self.satisfied(found):
                break
            rest = self.residuals(found)
            point = np.array([float(x) for x in found])
            for velocity, part in ((False, rest[:h]), (True, rest[h:])):
                _, rows, weights = search.rows(point, velocity)
                largest = max((abs(x) for x in part), default=arb(0))
                if not part or not largest > 0:
                    continue
                # Residuals are beyond the range of roundings: they are scaled before they become floats.
                right = np.array([-float(x / largest) for x in part])
                scale = rounded(largest)
                way = weights @ _shortest(rows, right)
                change = way if velocity else self._constraints.turned(0.0, point, way)
                for k, x in enumerate(change):
                    found[k + p * velocity] += scale * Fraction(float(x))
            found = [_short(x) for x in found]
            if self._restoring is not None:  # Newton's step, in as many bits
                with ctx.workprec(self._bits):
                    balls = [arb(0), *(rationals.ball(x) for x in found)]
                    moves = [rounded(x.mid()) for x in self._restoring(balls)]
                found[:p] = [_short(x + move) for x, move in zip(found, moves, strict=False)]
        if not self.satisfied(found):
            left = zip(self._constraints.names, self.residuals(found), strict=False)
            gaps = [Gap(name, abs(float(x))) for name, x in left]
            raise NotClosed(np.array([float(x) for x in found]), gaps, search.fixed, singular=True)
        return tuple(found)


def _short(value: Fraction) -> Fraction:
    """Rounded to ``PRECISION`` bits."""
    with ctx.workprec(PRECISION):
        return rounded(rationals.ball(value))
