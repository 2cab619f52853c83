"""What errors and drifts are relative to: the size that a quantity has in the whole motion.

The largest |x_i| over samples close to each other; samples that are few may all stand where a quantity is zero.  A
quantity that rests but for rounding (the cart under two pendulums that swing against each other) has no size of its
own.  It is measured by what the scene would move it: the velocity that carries the largest kinetic energy T alone,

    v_i = sqrt(2 T / M_ii),      q_i = v_i tau,      tau the shortest ratio of a coordinate's range to its speed.

Of a system in declared variables v_i are speeds, q_i the positions of which one of them is the velocity; components of
quaternions and unit vectors have the size 1.

A small size alone is no rest: the nutation of a fast top is a millionth of what its spin could do.  What two runs agree
on is motion, what is rounding in them is another in each.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from flint import arb

from mbsym.algebra.failures import Failure
from mbsym.mechanics.variables import angle_denominators
from mbsym.model.states import described
from mbsym.model.system import System, velocity_name
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels import arrays
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.methods.interface import Method, Setting, compiled_kernel
from mbsym.numerics.methods.magnitudes import NOISE, about, variables
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.simulate import Trajectory, integrated

# What the error of each entry of a quantity is measured by, in whatever units the description has.
#
# Entries of like dimension are measured together by the largest of them, unlike ones each by itself.  Where such a
# group vanishes or nearly does, by symmetry say, its size is what the kinetic metric makes of the others:
#
#     M_ij       by sqrt(M_ii M_jj), which bounds it
#     f_i        by at least STANDS N sqrt(M_ii),     N = max |f_j|/sqrt(M_jj)
#     q''_i      by at least STANDS N/sqrt(M_ii),     N = max |q''_j| sqrt(M_jj)
#     dq''/dq    by at least STANDS N sqrt(M_jj/M_ii), N the largest of them times sqrt(M_ii/M_jj); dq''/dq' likewise,
#                N = omega^2 and omega of the same omega
#     pivots     each by itself: they have different units
#
# Every one changes with the units as the entry itself does, so digits and conditions do not change.


#: A group smaller than this part of what the others would make it has no size of its own.
STANDS = 1e-6

Kinds = tuple[str, ...]


def kinds(system: System) -> Kinds:
    """Coordinates of one kind have one dimension: angles.  Whatever is not known to be alike counts as unlike."""
    angles = angle_denominators(system)
    return tuple("angle" if name in angles else name for name in system.coordinates)


def scales(name: str, values: Sequence[Any], masses: Sequence[Any], alike: Kinds) -> list[Any]:
    """One positive scale an entry, as exact balls; 0 where nothing has a size.

    ``values`` are the true entries, ``masses`` the diagonal of M there (empty: unknown).
    """
    sizes = [abs(x.mid()) for x in values]
    n = len(alike)
    weights = [x.mid().sqrt() if x.mid() > 0 else arb(0) for x in masses] or [arb(1)] * n
    if name == "mass matrix" and masses:
        return [weights[i] * weights[j] for i in range(n) for j in range(n)]
    if name == "forcing" and len(sizes) == n:
        return _grouped(sizes, list(alike), weights)
    if name == "accelerations" and len(sizes) == n:
        return _grouped(sizes, list(alike), [_inverse(w) for w in weights])
    if name == "Jacobian" and len(sizes) == 2 * n * n:
        return _slopes(sizes, alike, weights)
    if name in ("M", "D", "G", "K", "N") and len(sizes) == n * n:
        pairs = [(i, j) for i in range(n) for j in range(n)]
        groups = [tuple(sorted((alike[i], alike[j]))) for i, j in pairs]
        return _grouped(sizes, groups, [weights[i] * weights[j] for i, j in pairs])
    return sizes


def _inverse(x: Any) -> Any:
    return 1 / x if x > 0 else arb(0)


def _grouped(sizes: Sequence[Any], groups: Sequence[Any], usual: Sequence[Any], norm: Any = None) -> list[Any]:
    """The largest of each group, but at least STANDS * norm * usual; norm = max size/usual unless it is given."""
    if norm is None:
        norm = max((s / u for s, u in zip(sizes, usual, strict=True) if u > 0), default=arb(0))
    own: dict[Any, Any] = {}
    for size, group in zip(sizes, groups, strict=True):
        own[group] = max(own.get(group, arb(0)), size)
    found = []
    for size, group, unit in zip(sizes, groups, usual, strict=True):
        least = norm * unit
        scale = own[group] if own[group] >= least * STANDS else least
        found.append(max(scale, size).mid())
    return found


def _slopes(sizes: Sequence[Any], alike: Kinds, weights: Sequence[Any]) -> list[Any]:
    n = len(alike)
    entries = [(i, j) for i in range(n) for j in range(2 * n)]
    groups = [(alike[i], alike[j % n], j >= n) for i, j in entries]
    ratios = [weights[j % n] * _inverse(weights[i]) for i, j in entries]
    rates = [
        (s / u if j >= n else (s / u).sqrt()).mid()
        for s, u, (_, j) in zip(sizes, ratios, entries, strict=True)
        if u > 0
    ]
    omega = max(rates, default=arb(0))
    usual = [u * (omega if j >= n else omega * omega) for u, (_, j) in zip(ratios, entries, strict=True)]
    return _grouped(sizes, groups, usual, arb(1))


#: Where there are fewer samples than this, sizes are taken from so many times more.
MANY, GRID = 300, 501

#: Operations that a run beside the one that was asked for may cost.
AFFORDABLE = 400_000_000

#: The tolerance at which sizes, and no more, are looked for.
COARSE = 1e-6

#: Below this part of what the scene would move it by, a quantity rests but for rounding, unless two runs differ by no
#: more than this part of it.
RESTS, AGREED = 1e-6, 0.01

#: The tolerance of the second one: nobody else's, lest it be the first one again.
ANOTHER = 3.1e-9

#: Systems with more coordinates than this are measured by the sizes of their quantities alone.
MOST_SCALED = 40


def scaled(own: Any, usual: Any, apart: Any = np.inf) -> Any:
    """What each quantity is measured by: its own size, or what the scene would move it by; 1 where there is neither.

    ``apart`` is by how much two runs differ: a quantity on which they agree moves, however little.
    """
    moves = (own >= RESTS * usual) | ((own > 0) & (apart <= AGREED * own))
    found = np.where(moves, own, usual)
    return np.where(found > 0, found, 1.0)


def scaled_by_another(dynamics: Dynamics, times: Any, states: Any, usual: Any) -> Any:
    """``scaled`` of a run's states (2n, m) at times from 0, with another run where a quantity is small."""
    states = np.asarray(states, dtype=float)
    own = np.max(np.abs(states), axis=1)
    if not np.any((own > 0) & (own < RESTS * usual)):
        return scaled(own, usual)
    places = np.unique(np.linspace(0, len(times) - 1, min(len(times), 4 * GRID)).astype(int))
    other = integrated(dynamics, METHODS["dop853"], _affordable(dynamics, ANOTHER), times[places].tolist())
    if len(other.times) < len(places):
        return scaled(own, usual)
    return scaled(own, usual, np.max(np.abs(other.states - states[:, places]), axis=1))


def usual_sizes(dynamics: Dynamics, times: Any, states: Any, kinetic: float) -> Any:
    """What the scene would move each position and each velocity by, shape (2n,); 0 where that is not known."""
    p, n = dynamics.size, dynamics.dimension - dynamics.size
    if n > MOST_SCALED or not kinetic > 0 or not np.isfinite(kinetic):
        return np.zeros(dynamics.dimension)
    chosen = np.linspace(0, len(times) - 1, min(16, len(times))).astype(int)
    states = np.asarray(states, dtype=float)
    name_of = {velocity_name(name): place for place, name in enumerate(dynamics.system.coordinates)}
    whole = dynamics.mass_matrix
    diagonal = Code(whole.program, whole.inputs, whole.outputs[:: n + 1])
    masses = np.max(np.abs(arrays.kernel(diagonal)(np.vstack([times, states])[:, chosen])), axis=1)
    with np.errstate(all="ignore"):
        speeds = np.where(masses > 0, np.sqrt(2 * kinetic / masses), 0.0)
        own = np.max(np.abs(states[p:]), axis=1)
        places = [name_of.get(name) for name in dynamics.system.velocities]
        pairs = [(place, k) for k, place in enumerate(places) if place is not None]
        spans = np.array([np.ptp(states[place]) / own[k] for place, k in pairs])
    moving = np.isfinite(spans) & np.array([own[k] > RESTS * speeds[k] for _, k in pairs], dtype=bool)
    shortest = float(np.min(spans[moving])) if np.any(moving) else 0.0
    usual = np.concatenate([np.zeros(p), speeds])
    for place, k in pairs:
        usual[place] = speeds[k] * shortest
    for body in described(dynamics.system).bodies if dynamics.in_states else ():
        for name in (name for attitude in body.orientation for name in attitude.components):
            usual[dynamics.system.coordinates.index(name)] = 1.0
    return np.where(np.isfinite(usual), usual, 0.0)


def kinetic_rounding(dynamics: Dynamics, time: float, state: Any) -> float:
    """Kinetic energy of velocities that are roundings beside those that the scene gives a state.

    Rest that rows hold is moved by what forces leave of each other, and each step is led back to the rows: energies do
    not tell how far.  0 without constraints.
    """
    if dynamics.constraints is None:
        return 0.0
    state, kinds = np.asarray(state, dtype=float), variables(dynamics)
    weights = kinds.weights(np.array([time]), state[:, None])[:, 0]
    return float(np.sum(NOISE * weights * about(dynamics, time, state).sizes[kinds.velocities, 0]) ** 2 / 2)


def sizes_of_scene(dynamics: Dynamics, times: Any, states: Any) -> Any:
    """``usual_sizes`` of a motion whose states (2n, m) lie close to each other; of rest those of the scene."""
    with np.errstate(all="ignore"):
        kinetic = compiled_kernel(dynamics, "relative_energy")(np.vstack([times, states]))[1]
    largest = float(np.max(np.abs(kinetic[np.isfinite(kinetic)]), initial=0.0))
    try:
        if largest <= kinetic_rounding(dynamics, float(times[0]), states[:, 0]):
            return about(dynamics, float(times[0]), states[:, 0]).sizes[:, 0]
        return usual_sizes(dynamics, times, states, largest)
    except Failure:
        return np.zeros(len(states))


def kinetic_between(dynamics: Dynamics, trajectory: Trajectory, completed: Callable[[Method], Method]) -> float:
    """The largest kinetic energy of the motion where the samples are too few to show it, by a coarse run; else 0."""
    if len(trajectory.times) >= MANY or len(trajectory.times) < 2:
        return 0.0
    return _seen(dynamics, float(trajectory.times[-1]), completed(METHODS["dop853"]))[2]


def _seen(dynamics: Dynamics, end: float, method: Method) -> tuple[Any, Any, float]:
    """Times, states and the largest kinetic energy of a coarse run."""
    run = integrated(dynamics, method, _affordable(dynamics, COARSE), np.linspace(0.0, end, GRID).tolist())
    kinetic = compiled_kernel(dynamics, "relative_energy")(np.vstack([run.times, run.states]))[1]
    return run.times, run.states, float(np.max(np.abs(kinetic[np.isfinite(kinetic)]), initial=0.0))


def _affordable(dynamics: Dynamics, tolerance: float) -> Setting:
    operations = max(1, dynamics.right_hand_side.operations)
    return Setting(tolerance, None, max(1_000, AFFORDABLE // (140 * operations)))
