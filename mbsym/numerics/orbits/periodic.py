"""Periodic motions by shooting, their monodromy matrices and Floquet multipliers.

    x(T; x0) - x0 = turns,     Newton:   [Phi(T) - 1   f(x(T))] [dx0; dT] = -(x(T) - x0 - turns)

with the exact Phi of the variational equations; of all solutions that of least length is taken, so that along a family
of periodic motions the nearest one is found.  Where the equations know the time, T is given and its column is left out;
so it is where a period is asked for.  ``turns``: angles may come back turned by whole revolutions.  A coordinate that
the equations do not know may come back ``shifted`` by anything: its equation is left out.

The multipliers are the eigenvalues of Phi(T).  Some are 1 for a reason (``Trivial``): f(x0) is an eigenvector where the
equations do not know the time, a cyclic coordinate's unit vector is one, and the gradients of energy and of cyclic
momenta are left ones where these are conserved.  Everything here is computed in floating point: nothing is proved.

Sources: Stoer & Bulirsch, Introduction to Numerical Analysis, 7.3.5; Meyer, Hall & Offin, Introduction to Hamiltonian
Dynamical Systems, 2nd ed. 2009, chapters 8 and 9.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from mbsym.expressions.message import Counted, Message
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT64
from mbsym.numerics.kernels.llvm import available
from mbsym.numerics.methods.interface import Breakdown, Setting, Unusable, compiled_kernel
from mbsym.numerics.methods.magnitudes import about
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.orbits.floquet import NotPeriodic, common_frequency
from mbsym.numerics.orbits.variational import Flow

#: Newton's steps at most, and how small what is left over must be, as part of the motion's size.
MOST_STEPS, CLOSED = 40, 1e-15

#: What rounding and a motion that is hard to follow may leave over, once so many steps bring nothing more.
NEARLY, PATIENCE = 1e-8, 3

#: A period that has become so much shorter than the guess is on its way to nothing; so many times a step is halved.
SHORTEST, HALVINGS = 0.05, 4

#: How strongly singular values are damped, as multiples of what is left over; tried one after the other.
DAMPINGS = (0.01, 0.1, 1.0, 1e-4, 0.0)

#: Where the motion's speed times its period is this part of the size of the guess's motion only, it rests.
RESTING = 1e-6

#: A motion is measured at so many times; what moves by less than this part of what moves most, in parts of the state's
#: sizes, is measured as if it moved as much; no motion is smaller than this part of the state's size.
MEASURED, BESIDE, LEAST = 64, 1e-4, 1e-9

#: The search weighs by the state's sizes, up to so many of the motion.
AS_FAR = 100.0

#: Singular values below this part of the largest are those of directions along which the orbit may be moved.
RANK = 1e-9

#: Phi is computed again with so much coarser a tolerance.
COARSER = 10.0

#: A vector is an eigenvector for 1 if Phi moves it by less, as part of |Phi| and its own length.
FIXED = 1e-7

#: The equations are the same a period later if their right-hand sides differ by less, at so many times.
REPEATED, SAMPLES = 1e-8, 25


class NotFound(Exception):
    """No periodic motion was found; the message says how far it got."""


@dataclass(frozen=True)
class Trivial:
    """Why a multiplier is 1: a reason, its vector, and by how much Phi moves it (relatively)."""

    reason: str
    moved: float


@dataclass(frozen=True)
class Orbit:
    """A periodic motion x(t + T) = x(t) + turns, which are whole revolutions or what a coordinate is shifted by.

    ``closure`` is |x(T) - x0 - turns| as part of the motion's size, by the method that found it; ``verified`` the same
    by ``verifier``, another method.  ``multipliers`` are in decreasing order of size; ``trivial`` of them are 1 for the
    ``reasons``, and ``uncertainty`` is how far the others move when Phi is computed with another tolerance a period
    later.
    """

    names: tuple[str, ...]
    state: Any
    period: float
    turns: Any
    closure: float
    verified: float
    verifier: str
    steps: int
    monodromy: Any
    multipliers: Any
    uncertainty: float
    trivial: int
    reasons: tuple[Trivial, ...]
    energy: float
    autonomous: bool
    determinant: float
    shifted: tuple[str, ...] = ()

    @property
    def others(self) -> Any:
        """The multipliers without the trivial ones: those nearest to 1 are taken away."""
        rest = sorted(self.multipliers, key=lambda mu: abs(mu - 1))[self.trivial :]
        return np.array(sorted(rest, key=lambda mu: -abs(mu)))


@dataclass(frozen=True)
class Guess:
    """Where to begin: a state, a period, angles' revolutions; whether period or energy are kept as they are.

    ``shifted``: coordinates that the equations do not know, which may come back changed by anything.
    """

    state: Any
    period: float
    turns: Mapping[str, int]
    shifted: tuple[str, ...] = ()
    keep_period: bool = False
    keep_energy: bool = False


def autonomous(dynamics: Dynamics) -> bool:
    """Whether the equations do not know the time, as their program shows."""
    code = dynamics.right_hand_side
    live = code.program.live(code.outputs)
    return all(code.program.instructions[number].payload != "t" for number in live)


def _allowed(dynamics: Dynamics, state: Any, scale: Any) -> Any:
    """An orthonormal basis, in columns, of the changes in parts of ``scale`` that constraints allow at t = 0."""
    return np.linalg.qr(dynamics.tangent(0.0, np.asarray(state, dtype=float)) / scale[:, None])[0]


def conserves_energy(dynamics: Dynamics) -> bool:
    """Whether dh/dt vanishes as a program at these numbers, and constraints, if any, do not move by themselves."""
    return dynamics.is_scleronomic and not dynamics.energy_power.outputs


def _cyclic_coordinates(dynamics: Dynamics, state: Any, sizes: Any, period: float) -> tuple[str, ...]:
    """Coordinates that the equations do not know, as their program shows or, where they cancel, the rates do."""
    code = dynamics.right_hand_side
    used = {code.program.instructions[number].payload for number in code.program.live(code.outputs)}
    names = dynamics.system.coordinates
    return tuple(name for name in names if name not in used or not _depend_on(dynamics, name, state, sizes, period))


def _depend_on(dynamics: Dynamics, name: str, state: Any, sizes: Any, period: float) -> bool:
    """Whether the rates at a state change with a coordinate alone."""
    rates, place = compiled_kernel(dynamics, "right_hand_side"), dynamics.system.coordinates.index(name)
    now = rates(np.concatenate(([0.0], state)))
    for shift in np.linspace(0.1, 2.0, SAMPLES):
        beside = np.array(state, float)
        beside[place] += shift * sizes[place]
        apart = np.abs(rates(np.concatenate(([0.0], beside))) - now)
        if not np.all(apart <= REPEATED * (sizes / period + np.abs(now))):
            return True
    return False


def periodic_orbit(
    dynamics: Dynamics, guess: Guess, tolerance: float = 1e-13, watch: Callable[[int, float], None] = lambda k, r: None
) -> Orbit:
    """The periodic motion near a guess.

    Raises NotFound where Newton's method does not converge, or converges to rest (period and state say so).
    """
    flow = Flow(dynamics, tolerance)
    known_time = not autonomous(dynamics)
    free_period = not (known_time or guess.keep_period)
    names = (*dynamics.system.coordinates, *dynamics.system.velocities)
    turns = np.array([2 * np.pi * guess.turns.get(name, 0) for name in names])
    rates, sizes = compiled_kernel(dynamics, "right_hand_side"), about(dynamics, 0.0, guess.state).sizes[:, 0]
    if known_time:
        _require_repetition(dynamics, rates, guess, sizes)
    for name in guess.shifted:
        if _depend_on(dynamics, name, guess.state, sizes, guess.period):
            raise NotFound(Message("the motion depends on [[name]], which has to come back", name=name))
    energy = _Energy(dynamics, sizes)
    shifted = np.array([name in guess.shifted for name in names])
    motion = _size_of_motion(dynamics, flow.led(np.array(guess.state, float)), guess.period, energy)
    search = _Search(flow, turns, shifted, energy, energy(guess.state) if guess.keep_energy else None, motion)
    here = search.at(np.array(guess.state, float), float(guess.period))
    if here is None:
        raise NotFound(Message("the motion of the guess breaks down before its period is over"))
    best, since = here, 0
    for count in range(MOST_STEPS):
        watch(count, here.closure)
        if here.closure < CLOSED or (best.closure < NEARLY and since >= PATIENCE):
            turns = np.where(shifted, best.end - best.state, turns)
            orbit = _orbit(dynamics, flow, best, turns, count, not known_time, rates, energy, motion)
            return replace(orbit, shifted=guess.shifted)
        forward = rates(np.concatenate(([0.0], here.state))) if free_period else None
        ahead = rates(np.concatenate(([here.period], here.end))) if free_period else None
        place = search.towards(here, search.step(here, forward, ahead))
        if place is None:
            if best.closure >= NEARLY:
                break
            since = PATIENCE  # it is as near as rounding lets it come
            continue
        here = place
        if here.period < SHORTEST * guess.period:
            raise NotFound(_vanishing(here.period, turns))
        best, since = (here, 0) if here.size < 0.5 * best.size else (best, since + 1)
    left = min(best.closure, here.closure)
    raise NotFound(
        Message(
            "no convergence: what is left over after [[steps]] is [[left]] of the motion's size",
            steps=Counted(count + 1, "step"),
            left=f"{left:.1e}",
        )
    )


def _size_of_motion(dynamics: Dynamics, state: Any, period: float, energy: _Energy) -> Any:
    """Half the range of each component over a period from a state that keeps the constraints, wherever its zero is.

    Shape (2n,).  A motion that breaks down is measured by the state's sizes alone.
    """
    scale = energy.scale(state)
    try:
        with np.errstate(all="ignore"):
            run = METHODS["dop853"].start(dynamics, Setting(1e-8), FLOAT64, initial=state)
            states = np.asarray(run.fill(np.linspace(0.0, period, MEASURED)), float)
    except (Breakdown, Unusable):
        return scale
    ranges = (np.ptp(states, axis=1) / 2 / scale).reshape(2, -1)  # coordinates, velocities
    most = np.max(ranges, axis=1, keepdims=True)
    ranges = np.where(ranges > BESIDE * most, ranges, np.where(most > 0, most, 1.0))
    return scale * np.clip(ranges, LEAST, 1.0).ravel()


def _require_repetition(dynamics: Dynamics, rates: Any, guess: Guess, sizes: Any) -> None:
    """Raises NotFound where f(t + T, x) is not f(t, x): a motion that comes back after T goes on otherwise then."""
    shift = sizes * np.cos(np.arange(1.0, 1 + len(guess.state)))
    for state in (np.asarray(guess.state, float) + size * shift for size in (0.0, 0.1, -0.3)):
        for t in np.linspace(0.0, guess.period, SAMPLES):
            now, then = (rates(np.concatenate(([at], state))) for at in (t, t + guess.period))
            apart = np.abs(then - now)  # compared in vain where one of them is no number
            if np.any(apart > REPEATED * (sizes / guess.period + np.abs(now))):
                raise NotFound(_unrepeated(dynamics, f"{guess.period:.15g}"))


def _unrepeated(dynamics: Dynamics, period: str) -> Message:
    """With what they do repeat after, where that is seen."""
    try:
        own = 2 * np.pi / float(common_frequency(dynamics.right_hand_side))
    except NotPeriodic:
        text = "the equations do not repeat after [[period]], and no period of theirs is known"
        return Message(text, period=period)
    text = (
        "the equations do not repeat after [[period]]: they do after [[own]] and its multiples, one of "
        "which the period "
        "has to be"
    )
    return Message(text, period=period, own=f"{own:.15g}")


def _vanishing(period: float, turns: Any) -> Message:
    """In no time every motion closes: a search that gets there tells of itself, not of what is near the guess."""
    text = "the search runs to ever shorter periods ([[period]]), over which any motion closes: begin nearer"
    message = Message(text, period=f"{period:.3g}")
    more = "[[told]], and say which angle comes back turned, if one does (--turns NAME=1)"
    return message if np.any(turns) else Message(more, told=message)


@dataclass(frozen=True)
class _Place:
    """A state and period of the search: where its motion ends, Phi, what is left over, its size as it is weighed and as
    part of the motion's size."""

    state: Any
    period: float
    end: Any
    phi: Any
    rest: Any
    size: float
    closure: float


class _Search:
    """Newton's method with steps that are shortened until what is left over becomes smaller."""

    def __init__(
        self, flow: Flow, turns: Any, shifted: Any, energy: _Energy, wanted: float | None, motion: Any
    ) -> None:
        self.flow, self.turns, self.shifted, self.energy, self.wanted = flow, turns, shifted, energy, wanted
        self.motion = motion

    def at(self, state: Any, period: float) -> _Place | None:
        """None where the motion breaks down."""
        state = self.flow.led(state)
        try:
            end, phi = self.flow.passage(state, 0.0, period)
        except Breakdown:
            return None
        rest = np.where(self.shifted, 0.0, end - state - self.turns)
        closure, size = (float(np.max(np.abs(rest) / by)) for by in (self.motion, self._weights(state)))
        if self.wanted is not None:
            off = self.wanted - self.energy(state)
            rest = np.append(rest, -off)
            beside = abs(off) / (self.energy.size(state) + abs(self.wanted))
            closure, size = max(closure, beside), max(size, beside)
        return _Place(state, period, end, phi, rest, size, closure)

    def _weights(self, state: Any) -> Any:
        return np.minimum(self.energy.scale(state), AS_FAR * self.motion)

    def step(self, here: _Place, forward: Any, ahead: Any) -> Callable[[float], Any]:
        """(dx0, dT), or dx0 alone, by the damping; ``forward`` is f at the start, orthogonal to dx0, ``ahead`` f at the
        end.  All in parts of the sizes that weigh here, of the period and of the energy, so that units do not count.

        Off the orbit the singular values that vanish on it are about what is left over: below that they mean nothing.
        """
        size, scale = self.flow.size, self._weights(here.state)
        allowed = scale[:, None] * _allowed(self.flow.dynamics, here.state, scale)
        matrix, units = np.where(self.shifted[:, None], 0.0, here.phi - np.eye(size)), scale
        if self.wanted is not None:
            matrix = np.vstack([matrix, self.energy.gradient(here.state)])
            units = np.append(units, self.energy.size(here.state) + abs(self.wanted))
        matrix, right = matrix @ allowed / units[:, None], -here.rest / units
        if forward is not None:
            column = np.zeros((len(matrix), 1))
            column[:size, 0] = np.where(self.shifted, 0.0, here.period * ahead / scale)
            way = (here.period * forward / scale) @ (allowed / scale[:, None])
            matrix = np.vstack([np.hstack([matrix, column]), np.append(way, 0.0)])
            right = np.append(right, 0.0)
        width = allowed.shape[1]

        def found(damping: float) -> Any:
            step = _least_squares(matrix, right, damping * here.size)
            return np.append(allowed @ step[:width], here.period * step[width:])

        return found

    def towards(self, here: _Place, step: Callable[[float], Any]) -> _Place | None:
        """The next place: the first that halves what is left over, else the best; None where nothing is better."""
        best: _Place | None = None
        for damping in DAMPINGS:
            whole, share = step(damping), 1.0
            for _ in range(HALVINGS):
                place = self._moved(here, share * whole)
                if place is not None and (best is None or place.size < best.size):
                    best = place
                if best is not None and best.size < max(0.5 * here.size, NEARLY):
                    return best
                share /= 2
        return best if best is not None and best.size < here.size else None

    def _moved(self, here: _Place, step: Any) -> _Place | None:
        size = self.flow.size
        period = here.period + float(step[size]) if len(step) > size else here.period
        if not 0.3 * here.period < period < 3 * here.period:
            return None
        return self.at(here.state + step[:size], period)


def _least_squares(matrix: Any, right: Any, damping: float) -> Any:
    """The shortest solution, damped as by Levenberg and Marquardt."""
    u, s, v = np.linalg.svd(matrix, full_matrices=False)
    significant = s > RANK * s[0]
    weights = np.where(significant, s / (s**2 + (damping * s[0]) ** 2 + np.where(significant, 0.0, 1.0)), 0.0)
    return v.T @ (weights * (u.T @ right))


class _Energy:
    """h = T2 - T0 - U, momenta and their gradients; ``sizes`` are those that the scene gives parts of the state."""

    def __init__(self, dynamics: Dynamics, sizes: Any) -> None:
        self._energies, self._slopes = (compiled_kernel(dynamics, name) for name in ("energies", "integral_slopes"))
        self.sizes = sizes

    def scale(self, state: Any) -> Any:
        """What changes of a state are measured by."""
        return self.sizes + np.abs(state)

    def size(self, state: Any) -> float:
        """By how much h changes where the state does by as much as its sizes."""
        return float(np.abs(self.gradient(state)) @ self.scale(state))

    def __call__(self, state: Any) -> float:
        return float(self._energies(np.concatenate(([0.0], state)))[1])

    def gradient(self, state: Any) -> Any:
        """dh / d (q, q'), shape (2n,)."""
        return self.slopes(state)[0]

    def slopes(self, state: Any) -> Any:
        """Those of h and of the momenta, shape (1 + n, 2n)."""
        return np.reshape(self._slopes(np.concatenate(([0.0], state))), (-1, len(state)))


def _orbit(
    dynamics: Dynamics,
    flow: Flow,
    place: _Place,
    turns: Any,
    steps: int,
    free: bool,
    rates: Any,
    energy: _Energy,
    scale: Any,
) -> Orbit:
    state, period = place.state, place.period
    path = period * rates(np.concatenate(([0.0], state))) / scale
    if free and float(np.max(np.abs(path))) < RESTING:
        raise NotFound(
            Message("Newton's method has found a state of rest: begin farther away from it, or keep the energy")
        )
    _, phi = flow.passage(state, 0.0, period)
    # From where the motion comes back to, in a time that is as far from the period as this may be.
    beside = period * (1 + place.closure) if free else period
    _, other = Flow(dynamics, COARSER * flow.tolerance).passage(place.end - turns, 0.0, beside)
    basis = _allowed(dynamics, state, scale)
    phi, other = (
        basis.T @ (matrix * scale / scale[:, None]) @ basis for matrix in (phi, other)
    )  # in parts of the sizes
    reasons, others = _trivial(dynamics, state, period, phi, path if free else None, basis, energy, scale)
    count = len(phi) - others.shape[1]
    found, again = (np.linalg.eigvals(others.T @ matrix @ others) for matrix in (phi, other))
    multipliers = _sorted(np.append(found, np.ones(count)))
    uncertainty = 2 * _distance(found, again) + float(np.finfo(float).eps * np.linalg.norm(phi))
    verified, verifier = _verified(dynamics, state, period, turns, scale)
    names = (*dynamics.system.coordinates, *dynamics.system.velocities)
    det = float(np.linalg.det(phi))
    return Orbit(
        names,
        state,
        period,
        turns,
        place.closure,
        verified,
        verifier,
        steps,
        (basis @ phi @ basis.T) * scale[:, None] / scale,
        multipliers,
        uncertainty,
        count,
        reasons,
        energy(state),
        free,
        det,
    )


def _sorted(values: Any) -> Any:
    return np.array(sorted(values, key=lambda mu: (-round(abs(mu), 9), -mu.imag)))


def _distance(a: Any, b: Any) -> float:
    """The largest distance of a multiplier from its partner, partners chosen one after the other, nearest first."""
    left = list(b)
    worst = 0.0
    for multiplier in a:
        near = min(left, key=lambda other: abs(other - multiplier))
        worst = max(worst, abs(near - multiplier))
        left.remove(near)
    return float(worst)


def _trivial(
    dynamics: Dynamics, state: Any, period: float, phi: Any, path: Any, basis: Any, energy: _Energy, scale: Any
) -> tuple[tuple[Trivial, ...], Any]:
    """The reasons for multipliers 1 that hold at this Phi, and an orthonormal basis X (columns) of what they leave.

    Phi and its vectors are told in ``basis``, of the changes that constraints allow, or all, in parts of ``scale``.
    ``path`` is what the motion passes in a period at its speed here; None where the period is not free.

    Right eigenvectors span V, left ones W.  Where W vanishes on V, Phi maps V and the kernel of W to themselves, 1 has
    at least the multiplicity dim V + dim W, and the others are the eigenvalues of X^T Phi X, X the part of that kernel
    across V: a double 1, which roundings part by their root, is no matter of them.  Else the larger of V, W counts.
    """
    n, names = dynamics.size, dynamics.system.coordinates
    right: list[Any] = []
    left: list[Any] = []
    reasons = []
    candidates: list[tuple[str, Any, bool]] = []
    cyclic = _cyclic_coordinates(dynamics, state, energy.scale(state), period)
    slopes = energy.slopes(state)
    if path is not None:
        candidates.append((Message("the motion itself: the equations do not depend on the time"), path, True))
    if path is not None and conserves_energy(dynamics):
        candidates.append((Message("the energy is conserved"), scale * slopes[0], False))
    for name in cyclic:
        unit = np.zeros(2 * n)
        unit[names.index(name)] = 1.0
        candidates.append((Message("[[name]] is cyclic", name=name), unit, True))
        text = Message("the momentum of [[name]] is conserved", name=name)
        candidates.append((text, scale * slopes[1 + names.index(name)], False))
    size = float(np.linalg.norm(phi))
    for reason, vector, is_right in candidates:
        across = float(np.linalg.norm(vector - basis @ (basis.T @ vector)))
        vector = basis.T @ vector
        length = float(np.linalg.norm(vector))
        if length <= (1e-12 if is_right else 0.0):
            continue
        if is_right and across > 1e-9 * length:  # no change that is allowed
            continue
        image = phi @ vector if is_right else vector @ phi
        moved = float(np.linalg.norm(image - vector)) / (length * size)
        if moved < FIXED:
            reasons.append(Trivial(reason, moved))
            (right if is_right else left).append(vector / length)
    width = basis.shape[1]
    ones, duals = (np.reshape(rows, (-1, width)) for rows in (right, left))
    if float(np.max(np.abs(duals @ ones.T), initial=0.0)) > 1e-6:
        ones, duals = max(ones, duals, key=lambda rows: int(np.linalg.matrix_rank(rows, tol=1e-6))), duals[:0]
    _, lengths, ways = np.linalg.svd(np.vstack([ones, duals]))
    return tuple(reasons), ways[int(np.sum(lengths > 1e-6)) :].T


def _verified(dynamics: Dynamics, state: Any, period: float, turns: Any, scale: Any) -> tuple[float, str]:
    """The closure by another method: Taylor series where heyoka is there, else rk45, in extended arithmetic if any."""
    scalar = EXTENDED if available(EXTENDED) else FLOAT64
    for name, tolerance in (("taylor", 1e-17), ("rk45", 1e-15)):
        try:
            setting = Setting(tolerance if scalar == EXTENDED else 1e-14, step_limit=2_000_000)
            run = METHODS[name].start(dynamics, setting, scalar, initial=np.array(state))
            end = np.array(run.advance(period), float)
        except (Unusable, Breakdown):
            continue
        return float(np.max(np.abs(end - state - turns) / scale)), f"{name}, {scalar}"
    return float("nan"), "no other method"
