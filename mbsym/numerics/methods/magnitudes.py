"""What errors of steps are measured by: sizes of the state's components that change with the units as these do.

A step's error in x_i is held against

    tolerance (L_i + |x_i|),        L_i = max |x_i| so far, at least floor_i,

so that whatever unit a length, a mass or the time is written in, the same steps are taken, but for rounding.  The floor
is what keeps a component that rests but for rounding from ruling the steps: a small part of the size that the scene
would give it, with the rates at the state itself (``natural``).  Sizes are found where a run begins, by evaluating the
rates beside its state:

    q:   S_i = |q_i|, of angles at least 1; of others, which may be at 0 as they pass, at least 1e-4 q_i'^2/|q_i''|,
         where that is no more than 100 times what q_i passes in the shortest S_k/|q_k'|
    v:   V_j = max(|v_j|, F_j tau_j),   F_j = max |v_j'| where one coordinate is displaced by S_i/8,
         tau_j = sqrt(D_j / F_j),   D_j = min S_i/A_ij over the coordinates that v_j moves, q_i' = A_ij v_j

Of what is at 0 and rests sizes are those that the same kinetic energy gives it: D_j sqrt(M_jj) and V_j sqrt(M_jj) are
the largest of the others, and S_i = max A_ij D_j.  F_j, v_j and S_i/A_ij that have, times sqrt(M_jj), less than 1e-12
of the largest are roundings and count as 0, and so are A_ij of an angle beside those of others by the same v_j.  A
column y of derivatives of the state, in which single components may be roundings, is measured as a whole: y_i has the
size S_i max_k |y_k|/S_k, and while all of y is 0 that with y_k' times the shortest tau for y_k; of a derivative by a
parameter p the part 1e-12 of S_i/|p| is a rounding, and counts as 0.  A difference between two models is written in
parts of what can be tolerated, and its floor is 1: its rates may be roundings of forces that cancel.  What begins from
rest at 0 by a push has the times that the slopes of the rates tell there.
Where nothing tells a time or a size these are 1: all rests then, or the push is constant.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from mbsym.algebra.failures import Failure
from mbsym.expressions.message import Message
from mbsym.mechanics.variables import angle_denominators
from mbsym.model.states import described
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels import arrays
from mbsym.numerics.kernels.interface import Code, Kernel
from mbsym.numerics.methods.interface import Work, compiled_kernel, once

#: A coordinate is displaced by this part of its size.
DISPLACED = 1 / 8

#: No component counts for less than this part of the size that the scene would give it.
LEAST = 1e-4

#: The part of a size that counts where the rates at the state itself tell nothing.
SHARE = 1 / 32

#: Nor for so little that its tolerance is below so many roundings of that size; velocities change by more than theirs.
ROUNDINGS = 16.0

#: Roundings of positions as large as their sizes are, in what a step adds to velocities, such a part of theirs.
OF_POSITIONS = 1 / 4

#: Where nothing has a size the rates are differed over such a part of what is moved in a time of 1; their changes are
#: roundings below such a part of them.
NEAR, CHANGED = 1e-4, 1e-14

#: Arcs are no longer than what is passed in so many times of the fastest position.
FARTHEST = 100.0

#: What is a smaller part of the largest, weighed by masses, is a rounding.
NOISE = 1e-12

#: Where a step vanishes, values or rates beyond so many sizes mean a blow-up.
LARGEST = 1e12

#: What is said then where the rates are not told.
OUTGROWN = Message(
    "a coordinate or velocity has grown beyond [[times]] times its size at the start", times=f"{LARGEST:.0e}"
)

#: Nor for less than short floats can divide by.
SMALLEST = 1e-30

#: The mass matrix of systems with more velocities is not looked at.
MOST_WEIGHED = 40

#: States are looked about together, so many at once.
COLUMNS = 20_000

#: (times (m,), states (d, m)) -> rates (d, m).
Rates = Callable[[Any, Any], Any]


@dataclass(frozen=True)
class Variables:
    """Which of a state's components are ``angles`` (or of unit vectors), ``velocities``, constants: masks (d,).

    ``masses`` makes the kernel of the diagonal of the mass matrix.  ``columns``: places of derivatives of the first
    components of the state, in their order; ``changes``: of each 1/|p| if it is by a parameter p, else 0.
    ``differences`` are those between two models, a mask (d,).
    """

    angles: Any
    velocities: Any
    constant: Any
    masses: Callable[[], Kernel] | None = None
    columns: tuple[Any, ...] = ()
    changes: tuple[float, ...] = ()
    differences: Any = False

    @property
    def positions(self) -> Any:
        """What is none of these, as a mask."""
        apart = self.velocities | self.constant | self.differences
        apart[[place for column in self.columns for place in column]] = True
        return ~apart

    def weights(self, begin: Any, states: Any) -> Any:
        """sqrt(M_jj) of the velocities (n, m); zeros where they are not known."""
        if self.masses is not None:
            try:
                return np.sqrt(_finite(self.masses()(np.vstack([begin, states]).astype(float))))
            except Failure:
                pass
        return np.zeros((int(np.sum(self.velocities)), states.shape[1]))


def variables(dynamics: Dynamics) -> Variables:
    """Those of a Dynamics; what stands behind positions and velocities is neither."""
    n = len(dynamics.system.velocities)

    def masses() -> Kernel:
        whole = dynamics.mass_matrix
        diagonal = Code(whole.program, whole.inputs, whole.outputs[:: n + 1])
        return once(dynamics, "masses", lambda: arrays.kernel(diagonal))

    kinds = once(dynamics, "variables", lambda: _kinds(dynamics))
    return replace(kinds, masses=masses) if n <= MOST_WEIGHED else kinds


def _kinds(dynamics: Dynamics) -> Variables:
    """The same, without the masses."""
    system = dynamics.system
    names = dynamics.inputs[1 : 1 + dynamics.dimension]
    bounded = set(angle_denominators(system))
    bounded |= {name for body in described(system).bodies for vector in body.orientation for name in vector.components}
    bounded &= set(system.coordinates)
    groups = bounded, set(system.velocities), set(system.parameter_names), getattr(dynamics, "differences", ())
    angles, moving, constant, apart = (np.array([name in group for name in names], dtype=bool) for group in groups)
    columns: dict[str, list[int]] = {}
    for place, (name, joined, number) in enumerate(full_name.partition("~") for full_name in names):
        if joined and number.isdecimal() and name in names:
            columns.setdefault(number, []).append(place)
    directions, values = getattr(dynamics, "directions", ()), dynamics.scenario.parameters
    by = (abs(float(values.get(direction.parameter) or 0)) for direction in directions)
    changes = tuple(1 / value if value else 0.0 for value in by) or (0.0,) * len(columns)
    return Variables(angles, moving, constant, None, tuple(map(np.array, columns.values())), changes, apart)


@dataclass(frozen=True)
class Magnitudes:
    """``sizes`` (d, m) that a scene gives the components of m states, and ``times`` (m,) in which it moves them.

    ``natural`` are those with the rates at the states themselves, of velocities that rest with as much kinetic energy
    as the others have: a displacement may lead to where forces are much larger.  ``roundings`` (d, m): their
    part eps of the arithmetic is lost in every step, by the rounding of positions in what pushes velocities, too.
    """

    sizes: Any
    times: Any
    natural: Any
    roundings: Any

    def outgrown(self, state: Any, slopes: Any, member: int = 0) -> bool:
        """Whether a state (d,) or its rates (d,) are blown up: 10^12 of the sizes, or no numbers."""
        usual, unit = self.sizes[:, member], float(self.times[member])
        grown = np.max(np.abs(state) / usual, initial=0.0), np.max(np.abs(slopes) / usual, initial=0.0) * unit
        return not all(part < LARGEST for part in grown)

    def floor(self, tolerance: float, precision: float) -> Any:
        """The least L (d, m) for a tolerance in an arithmetic whose next number after 1 is 1 + ``precision``."""
        if not tolerance > 0:
            return np.maximum(self.natural, SMALLEST)
        return np.maximum(np.maximum(LEAST * self.natural, self.roundings * precision / tolerance), SMALLEST)


def magnitudes(rates: Rates, kinds: Variables, begin: Any, states: Any) -> Magnitudes:
    """The magnitudes of the scene about ``states`` (d, m) at the times ``begin`` (m,).  Costs up to 3 d evaluations."""
    at_once = max(1, COLUMNS // max(1, 2 * len(states)))
    parts = range(0, states.shape[1], at_once)
    with np.errstate(all="ignore"):
        blocks = [_magnitudes(rates, kinds, begin[k : k + at_once], states[:, k : k + at_once]) for k in parts]
    sizes, natural = (np.hstack([getattr(block, name) for block in blocks]) for name in ("sizes", "natural"))
    return replace(blocks[0], sizes=sizes, times=np.concatenate([block.times for block in blocks]), natural=natural)


def about(dynamics: Dynamics, time: float, state: Any) -> Magnitudes:
    """The magnitudes of the scene about one state (d,), in float64."""
    rates = counted(compiled_kernel(dynamics, "right_hand_side"), Work())
    return magnitudes(rates, variables(dynamics), np.array([float(time)]), np.asarray(state, dtype=float)[:, None])


def counted(rhs: Kernel, work: Work) -> Rates:
    """The rates by a kernel, each evaluation counted."""

    def rates(times: Any, states: Any) -> Any:
        work.evaluations += len(times)
        return rhs(np.vstack([times, states]))

    return rates


def _magnitudes(rates: Rates, kinds: Variables, begin: Any, states: Any) -> Magnitudes:
    moving, placed = (np.flatnonzero(mask) for mask in (kinds.velocities, kinds.positions))
    absolute = np.abs(states).astype(float)
    sizes = np.where(kinds.angles[:, None], np.maximum(absolute, 1.0), absolute)
    base = rates(begin, states)
    reach = (DISPLACED * sizes[placed]).astype(states.dtype)
    largest = np.max(_finite(_beside(rates, begin, states, np.tile(placed, 2), np.vstack([reach, -reach]))), axis=1)
    largest = np.maximum(largest, _finite(base))
    weights = kinds.weights(begin, states)
    rate, still = _above_noise(largest[moving], weights), states.copy()
    still[moving] = 0
    push = np.where(rate > 0, rate, 1.0)
    pushed = _beside(rates, begin, still, moving, push.astype(states.dtype))
    ways = _finite(pushed - rates(begin, still)[:, None])[placed] / push  # A_ij, shape (positions, velocities, m)
    ways = _ways_above_noise(ways, kinds.angles[placed])
    bends = np.max(ways * rate, axis=1, initial=0.0)
    arcs = _arcs(kinds, placed, sizes[placed], _finite(base)[placed], largest[placed], bends)
    sizes[placed] = _sizes_above_noise(np.maximum(sizes[placed], LEAST * arcs), ways, weights)
    absolute[moving] = _above_noise(absolute[moving], weights)
    path = np.min(_ratio(np.where(sizes > 0, sizes, np.inf)[placed][:, None], ways), axis=0, initial=np.inf)
    path = np.where(np.isfinite(path), path, 0.0)
    times = np.sqrt(_ratio(path, rate))
    speeds = np.maximum(absolute[moving], np.where(np.isfinite(times), rate * times, 0.0))
    if not (np.all(path > 0) and np.all(speeds > 0)):
        path, speeds = _weighed(path, weights), _weighed(speeds, weights)
        times = np.minimum(np.sqrt(_ratio(path, rate)), _ratio(path, speeds))
        speeds = _weighed(np.maximum(speeds, np.where(np.isfinite(times), rate * times, 0.0)), weights)
    shortest = np.min(times, axis=0, initial=np.inf)
    passing = _ratio(np.where(sizes > 0, sizes, np.inf)[placed], largest[placed])
    shortest = np.where(np.isfinite(shortest), shortest, np.min(passing, axis=0, initial=np.inf))
    known = np.isfinite(shortest) & (shortest > 0)
    if not np.all(known):
        shortest = np.where(known, shortest, _from_rest(rates, begin, states, placed, moving, ways, rate, base))
    sizes[moving] = np.where(speeds > 0, speeds, rate * shortest)
    path = np.where(path > 0, path, rate * shortest**2)
    reached = np.maximum(np.max(ways * path, axis=1, initial=0.0), largest[placed] * shortest)
    sizes[placed] = np.where(sizes[placed] > 0, sizes[placed], reached)
    sizes = np.where(np.isfinite(sizes) & (sizes > 0), sizes, 1.0)
    for column, change in zip(kinds.columns, kinds.changes, strict=True):
        own = sizes[: len(column)]
        extent, growth = (np.max(values[column] / own, axis=0) for values in (absolute, _finite(base) * shortest))
        extent = np.where(extent > NOISE * change, extent, growth)
        sizes[column] = own * np.where(extent > NOISE * change, extent, change or 1.0)
    natural = sizes.copy()
    own = np.maximum(absolute[moving], np.sqrt(_finite(base)[moving] * path))
    natural[placed] = np.maximum(sizes[placed], SHARE * arcs)
    own = np.maximum(own, _alike(own, weights))
    natural[moving] = np.minimum(sizes[moving], np.where(own > 0, own, SHARE * sizes[moving]))
    natural[np.broadcast_to(kinds.differences, len(natural))] = 1 / LEAST
    roundings = ROUNDINGS * natural
    passed = np.max(absolute[placed] / np.where(sizes[placed] > 0, sizes[placed], 1.0), axis=0, initial=0.0)
    roundings[moving] = np.maximum(natural[moving], OF_POSITIONS * passed * sizes[moving])
    return Magnitudes(sizes, shortest, natural, roundings)


def _from_rest(rates: Rates, begin: Any, states: Any, placed: Any, moving: Any, ways: Any, rate: Any, base: Any) -> Any:
    """tau (m,) where a push F begins a motion at 0:  1/tau^2 = max A_ij |dv_j'/dq_i|, or 1/tau = max |dv_j'/dv_k|.

    It is 1 where these are 0.  By differences over a small part of what F would move in a time of 1.
    """
    apart = NEAR * np.max(ways * rate, axis=1, initial=0.0), NEAR * rate
    bends = []
    for places, reach in zip((placed, moving), apart, strict=True):
        moved = _beside(rates, begin, states, places, reach.astype(states.dtype)) - base[:, None]
        change = np.abs(moved[moving]).astype(float)  # (velocities, places, m)
        change[~(change > CHANGED * _finite(base)[moving][:, None])] = 0.0
        bends.append(np.where(reach > 0, change / np.where(reach > 0, reach, 1.0), 0.0))
    stiff = np.max(bends[0] * np.swapaxes(ways, 0, 1), axis=(0, 1), initial=0.0)
    damped = np.max(bends[1], axis=(0, 1), initial=0.0)
    times = np.where(stiff > 0, 1 / np.sqrt(np.where(stiff > 0, stiff, 1.0)), 1 / np.where(damped > 0, damped, 1.0))
    return np.where(np.isfinite(times), times, 1.0)


def _arcs(kinds: Variables, placed: Any, sizes: Any, base: Any, largest: Any, bends: Any) -> Any:
    """q_i'^2/|q_i''| of the positions (n, m), 0 of angles; no longer than what the fastest position lets pass."""
    bends = np.where(kinds.angles[placed][:, None] | (bends <= 0), np.inf, bends)
    passing = _ratio(np.where(sizes > 0, sizes, np.inf), largest)
    farthest = FARTHEST * np.min(passing, axis=0, initial=np.inf)  # an arc that is longer bends by roundings alone
    return np.minimum(base**2 / bends, np.where(np.isfinite(farthest) & (base > 0), base * farthest, np.inf))


def _above_noise(values: Any, weights: Any) -> Any:
    """The values (n, m), 0 for those that are roundings: tiny beside the others when all are weighed by masses."""
    weighed = values * weights
    return np.where(weighed < NOISE * np.max(weighed, axis=0, initial=0.0), 0.0, values)


def _ways_above_noise(ways: Any, angles: Any) -> Any:
    """A_ij, 0 for those of angles and unit vectors that are roundings: tiny beside others by the same v_j."""
    largest = np.max(ways[angles], axis=0, initial=0.0)
    return np.where(angles[:, None, None] & (ways < NOISE * largest), 0.0, ways)


def _sizes_above_noise(sizes: Any, ways: Any, weights: Any) -> Any:
    """S_i, 0 for those that are roundings: of D_j sqrt(M_jj) on any way they make a tiny part of the largest."""
    paths = _ratio(sizes[:, None], ways)
    paths = np.where(np.isfinite(paths) & (paths > 0), paths, 0.0) * weights
    least = np.min(np.where(paths > 0, paths, np.inf), axis=1, initial=np.inf)
    return np.where(least < NOISE * np.max(paths, axis=(0, 1), initial=0.0), 0.0, sizes)


def _ratio(a: Any, b: Any) -> Any:
    """a/b, infinite where b is 0."""
    return np.where(b > 0, a / np.where(b > 0, b, 1.0), np.inf)


def _weighed(values: Any, weights: Any) -> Any:
    """The values, those that are 0 replaced by what the same kinetic energy makes of the largest of the others."""
    return np.where(values > 0, values, _alike(values, weights))


def _alike(values: Any, weights: Any) -> Any:
    """What the kinetic energy of the largest of the values would be in each of them; 0 where masses are not known."""
    alike = _ratio(np.max(values * weights, axis=0, initial=0.0), weights)
    return np.where(np.isfinite(alike), alike, 0.0)


def _beside(rates: Rates, begin: Any, states: Any, places: Any, changes: Any) -> Any:
    """The rates (d, k, m) at states (d, m) with one component changed: at ``places`` (k,) by ``changes`` (k, m)."""
    (d, m), k = states.shape, len(places)
    moved = np.repeat(states[:, None], k, axis=1)
    moved[places, np.arange(k)] += changes
    return rates(np.tile(begin, k), moved.reshape(d, k * m)).reshape(d, k, m) if k else np.zeros((d, 0, m))


def _finite(values: Any) -> Any:
    """|values|, 0 where one is no number."""
    absolute = np.abs(values).astype(float)
    return np.where(np.isfinite(absolute), absolute, 0.0)


def first_steps(
    rates: Rates, order: int, known: Magnitudes, begin: Any, states: Any, tolerance: float, relative: float
) -> tuple[Any, Any]:
    """The first step (m,) of a method for each of m states (d, m), and the rates there: two evaluations.

    Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I, II.4, in units of the scene's sizes and times.
    """
    scale = tolerance * known.sizes + relative * np.abs(states).astype(float)
    unit = known.times

    def size(values: Any) -> Any:
        if not len(values):
            return np.zeros(states.shape[1])
        return np.sqrt(np.mean(((values / scale).astype(float)) ** 2, axis=0))

    with np.errstate(all="ignore"):
        slopes = rates(begin, states)
        position, speed = size(states), unit * size(slopes)
        slow = (position < 1e-5) | (speed < 1e-5)
        first = unit * np.where(slow, 1e-6, np.maximum(0.01 * position / speed, 1e-100))
        moved = states + first.astype(states.dtype) * slopes
        bend = unit**2 * size(rates(begin + first.astype(begin.dtype), moved) - slopes) / first
        largest = np.maximum(speed, bend)
        second = np.where(
            largest <= 1e-15, np.maximum(1e-6 * unit, first * 1e-3), unit * (0.01 / largest) ** (1 / order)
        )
        usable = np.isfinite(speed) & np.isfinite(bend)
        steps = np.where(usable, np.minimum(100 * first, second), 1e-6 * unit)
        return np.maximum(steps, ROUNDINGS * np.finfo(begin.dtype).eps * np.abs(begin)), slopes
