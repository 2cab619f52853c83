"""Inverse dynamics: the inputs with which a given motion q(t) is a solution.

With q, q', q'' substituted, the derivatives being exact ones of the formulas, the Newton-Euler recursion gives
M q'' - f(q, q', t, u) as a straight-line program of (t, u).  Where the inputs enter linearly it is r(t) - B(t) u, and

    B u = r

is solved at every time: exactly determined, in the sense of least squares where there are more equations than inputs
(the residual r - B u then says how far the motion is from one that the inputs can give), and by the smallest |u| where
B has more columns than its rank, both in the units of the description.

Source: Featherstone, Rigid Body Dynamics Algorithms, ch. 5 (inverse dynamics by the recursion).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from mbsym.algebra.base import Lowering
from mbsym.algebra.derivative import jacobian
from mbsym.algebra.failures import Failure
from mbsym.algebra.program import Node, Program
from mbsym.algebra.ring import Ring
from mbsym.expressions.tree import Expression, add, differentiate, multiply
from mbsym.mechanics.constraints.dynamics import conditions
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.newton_euler import residuals
from mbsym.mechanics.programs import programs
from mbsym.mechanics.variables import ring_of
from mbsym.model.system import System, acceleration_name, velocity_name
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.arrays import kernel
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.scenario import Scenario, bound, scenario, substituted

Array = npt.NDArray[np.float64]

#: Singular values of B, and residuals, below this part of the largest are zero.
NOTHING = 1e-10
#: What is left of an equation is rounding up to so many times the difference between two arithmetics.
ROUNDING = 1e4
#: Constants are folded with 256 bits: sin(pi) is 1e-77 there, in both arithmetics.
FOLDED = 1e-60


class NotLinear(Failure):
    """The inputs enter other than linearly."""


@dataclass(frozen=True, eq=False)
class InverseDynamics:
    """``inputs`` (k x m) by ``names`` at ``times`` (m); the motion there as ``coordinates``, ``velocities`` (n x m).

    ``residual`` (n x m) is B u - r, what is left of each equation; ``left`` the largest of them over all times, against
    the size of the terms M q'', f and B u of the same equation over the whole motion, rounding apart.  ``rank`` (m) is
    that of B.
    """

    system: System
    names: tuple[str, ...]
    times: Array
    inputs: Array
    coordinates: Array
    velocities: Array
    accelerations: Array
    residual: Array
    left: float
    rank: npt.NDArray[np.int64]

    def __getitem__(self, name: str) -> Array:
        """The values of an input or a coordinate.  Raises KeyError."""
        if name in self.names:
            return self.inputs[self.names.index(name)]
        if name in self.system.coordinates:
            return self.coordinates[self.system.coordinates.index(name)]
        raise KeyError(name)

    @property
    def exact(self) -> bool:
        """Whether the inputs give the motion at these times, but for rounding."""
        return self.left <= NOTHING

    @property
    def unique(self) -> bool:
        """Whether no other inputs give the same, at any of the times."""
        return bool((self.rank == len(self.names)).all())


def inverse_dynamics(
    system: System, motion: Mapping[str, Expression], overrides: Mapping[str, Expression], times: Array
) -> InverseDynamics:
    """The inputs at ``times`` for q(t) = ``motion``: expressions in t, parameters and prescribed motions, of every q;
    with constraints of some from which the others follow.

    ``overrides`` replace numbers of parameters.  Raises NotLinear; ValueError where the system has no inputs, or the
    motion or an input is not finite; ``mbsym.numerics.scenario.Incomplete`` where a number is missing.
    """
    system = system.without_speeds if system.variables else system  # a motion is one of coordinates
    if not system.inputs:
        raise ValueError("the description has no inputs")
    if system.constraints:
        return inverse_constrained(system, motion, overrides, times)
    specified = scenario(system, overrides, state=False)
    program, states, needed, applied = _program(system, specified, motion)
    inputs = [program.input(name) for name in system.input_names]
    slopes = jacobian(program, needed, inputs)
    check_linear(program, system, slopes)
    n, k = len(system.coordinates), len(inputs)
    outputs = (*states, *needed, *applied, *(x for row in slopes for x in row))
    code = Code(program, ("t", *system.input_names), outputs)
    at = np.vstack([times, np.zeros((k, len(times)))])
    evaluated = kernel(code)(at)
    _demand_finite(evaluated, times, "the motion, or what it needs,")
    finer = np.asarray(kernel(code, "extended")(at), dtype=float)
    noise = np.abs(finer - evaluated)[3 * n : 4 * n].max(axis=1)
    moved, right = finer[: 3 * n], finer[3 * n : 4 * n]
    columns = -finer[5 * n :].reshape(n, k, len(times))
    values, rank = _solved(columns, right)
    supplied = np.einsum("ikm,km->im", columns, values)
    forces = finer[4 * n : 5 * n]
    terms = np.abs(right - forces) + np.abs(forces) + np.einsum("ikm,km->im", np.abs(columns), np.abs(values))
    size = terms.max(axis=1)
    left = np.abs(supplied - right).max(axis=1)
    open_ = (left > ROUNDING * noise) & (left > FOLDED * max(1.0, float(size.max())))
    remaining = float((left[open_] / size[open_]).max(initial=0.0))
    return InverseDynamics(
        system, system.input_names, times, values, moved[:n], moved[n : 2 * n], moved[2 * n :],
        supplied - right, remaining, rank,
    )  # fmt: skip


def _program(
    system: System, given: Scenario, motion: Mapping[str, Expression]
) -> tuple[Program, list[Node], list[Node], list[Node]]:
    """A program of t and the inputs: (q, q', q''), M q'' - f, and -f alone."""
    program = bound(given)
    names = [*system.parameter_names, *(item.name for item in system.prescribed), "t", "pi"]
    lowered = [_with_rates(system, program, motion[name]) for name in system.coordinates]
    for name, (place, speed, acceleration) in zip(system.coordinates, lowered, strict=True):
        program.bound[name] = place
        program.bound[velocity_name(name)] = speed
        program.bound[acceleration_name(name)] = acceleration
    moving = [*system.coordinates, *system.velocities, *map(acceleration_name, system.coordinates)]
    environment = {name: program.input(name) for name in (*names, *moving, *system.input_names)}
    states = [chain[order] for order in range(3) for chain in lowered]
    needed, applied = _with_forces(system, program, environment, ring_of(system))
    return program, states, needed, applied


def _with_rates(system: System, program: Program, place: Expression) -> tuple[Node, Node, Node]:
    """A given motion q(t), q' and q'' as nodes."""
    rates = {item.name: item.rate for item in system.prescribed}
    names = (*system.parameter_names, *rates, "t", "pi")
    lower = Lowering(program, {name: program.input(name) for name in names})
    speed = rate_of(place, rates)
    return lower(place), lower(speed), lower(rate_of(speed, rates))


def _with_forces(
    system: System, program: Program, environment: Mapping[str, Node], ring: Ring
) -> tuple[list[Node], list[Node]]:
    """M q'' - f, and the same where q'' is zero."""
    resting = {acceleration_name(name): program.number(0) for name in system.coordinates}
    both = [residuals(Scene(system, program, x, ring)) for x in (environment, {**environment, **resting})]
    needed, applied = ([nodes[name] for name in system.coordinates] for nodes in both)
    return needed, applied


def _demand_finite(values: Array, times: Array, what: str) -> None:
    """Raises ValueError with the first time at which a row holds no number."""
    finite = np.isfinite(values).all(axis=0)
    if not finite.all():
        raise ValueError(f"at t = {times[~finite][0]:.9g} {what} is infinite or no number")


def rate_of(expression: Expression, rates: Mapping[str, Expression]) -> Expression:
    """d/dt, prescribed quantities running at their rates."""
    total = differentiate(expression, "t")
    for name, rate in rates.items():
        total = add(total, multiply(differentiate(expression, name), rate))
    return total


def check_linear(program: Program, system: System, slopes: tuple[tuple[Node, ...], ...]) -> None:
    live = program.live([x for row in slopes for x in row])
    held = {str(x.payload) for x in map(program.instructions.__getitem__, live) if x.operation == "input"}
    bent = [name for name in system.input_names if name in held]
    if bent:
        text = "inputs are found where they enter linearly; these do not: [[names]]"
        raise NotLinear(text, names=", ".join(bent))


def _solved(columns: Array, right: Array) -> tuple[Array, npt.NDArray[np.int64]]:
    """The smallest u that minimises |B u - r| at every time, and the rank of B."""
    count = columns.shape[2]
    values, rank = np.zeros((columns.shape[1], count)), np.zeros(count, dtype=np.int64)
    for m in range(count):
        solution, _, rank[m], _ = np.linalg.lstsq(columns[:, :, m], right[:, m], rcond=NOTHING)
        values[:, m] = solution
    return values, rank


# Inverse dynamics with constraints: the inputs, where the motion of some coordinates is given and others follow.
#
#     f(t, q) = 0,   J q' + j = 0,   J q'' + c = 0        for the coordinates whose motion is not given, at every time
#     B u + J^T lambda = r,   r = M q'' - f(q, q', t, 0)
#
# Positions follow by Newton's method from those at the time before (at t = 0 from the initial ones), so that a loop
# stays in its assembly; velocities and accelerations are linear.  Positions that constraints in velocities alone lead
# (where a wheel rolls to) are integrated from the initial ones,  q' = -J^+ g.  Then u and lambda are solved for in the
# sense of least squares with M^-1 as weights (kinetic ones: the same in all units), lambda being left out first.


#: A row that is off by more than this, beside its terms, is not satisfied; steps of Newton's method.
OFF, STEPS = 1e-9, 50


def inverse_constrained(
    system: System, motion: Mapping[str, Expression], overrides: Mapping[str, Expression], times: Array
) -> InverseDynamics:
    """See the module; ``motion`` of some coordinates at least, from which the others follow.

    Raises NotLinear as without constraints; ValueError where the others do not follow, or the motion does not satisfy
    the constraints.
    """
    specified = scenario(system, overrides, state=False)
    rows = _Rows(system, specified)
    states = rows.followed(_Given(system, specified, motion), times)
    needed, applied, columns, masses = _equations(system, specified, states, times)
    _, _, _, partials = rows.at(times, states)
    n, k, m = len(system.coordinates), len(system.input_names), len(times)
    values, rank = np.zeros((k, m)), np.zeros(m, dtype=np.int64)
    residual, left, size = np.zeros((n, m)), 0.0, 0.0
    for place in range(m):
        lower = _root(masses[:, :, place])
        vectors = (needed, applied, columns, np.swapaxes(partials, 0, 1))
        right, forces, own, ties = (np.linalg.solve(lower, x[..., place]) for x in vectors)
        free = _beside(ties)
        scales = np.linalg.norm(own, axis=0)
        scales = np.where(scales > 0, scales, 1.0)
        values[:, place], rank[place] = _smallest(free @ (own / scales), free @ right, scales)
        rest = free.T @ (free @ (own @ values[:, place] - right))
        residual[:, place] = lower @ rest
        left = max(left, float(np.linalg.norm(rest)))
        size = max(size, *(float(np.linalg.norm(x)) for x in (right - forces, forces, own @ values[:, place])))
    remaining = left / size if size > 0 else 0.0
    return InverseDynamics(
        system, system.input_names, times, values, states[:n], states[n : 2 * n], states[2 * n :],
        residual, remaining, rank,
    )  # fmt: skip


def _root(masses: Any) -> Any:
    """L with M = L L^T; with ones where M is not positive, so that nothing is weighed."""
    try:
        return np.linalg.cholesky(masses)
    except np.linalg.LinAlgError:
        return np.eye(len(masses))


def _smallest(matrix: Any, right: Any, scales: Any) -> tuple[Any, int]:
    """The smallest u = x/scales of least |matrix x - right|, and the rank.

    Columns had length 1 before forces of constraints were taken out: what is left of one may be rounding.
    """
    left, sizes, turned = np.linalg.svd(matrix)
    rank = int(np.sum(sizes > NOTHING))
    found = (turned[:rank].T @ ((left.T @ right)[:rank] / sizes[:rank])) / scales
    alike = (turned[rank:] / scales).T  # inputs that change nothing
    return found - alike @ np.linalg.lstsq(alike, found, rcond=None)[0], rank


def _beside(ties: Any) -> Any:
    """Orthonormal rows beside the columns of J^T."""
    lengths = np.linalg.norm(ties, axis=0)
    left, sizes, _ = np.linalg.svd(ties / np.where(lengths > 0, lengths, 1.0))
    return left[:, int(np.sum(sizes > OFF)) :].T


class _Given:
    """(q, q', q'') of the coordinates whose motion is given, at any times."""

    def __init__(self, system: System, given: Scenario, motion: Mapping[str, Expression]) -> None:
        program = bound(given)
        self._kernels = {
            name: kernel(Code(program, ("t",), _with_rates(system, program, place))) for name, place in motion.items()
        }

    def __call__(self, times: Array) -> dict[str, Any]:
        """By name, shape (3, m).  Raises ValueError."""
        motions = {}
        for name, own in self._kernels.items():
            values = np.broadcast_to(own(np.array([times])), (3, len(times)))
            _demand_finite(values, times, f"the motion of {name}")
            motions[name] = values
        return motions


class _Rows:
    """f, g, the acceleration form at q'' = 0 and J of all rows."""

    def __init__(self, system: System, given: Scenario) -> None:
        self.system, self.scenario, self.n = system, given, len(system.coordinates)
        equations = conditions(system, ring_of(system))
        self.names = equations.names
        self.holonomic = sum(name.holonomic for name in self.names)
        nodes = [row.position for row in equations.rows if row.position is not None]
        nodes += [row.velocity for row in equations.rows]
        nodes += [row.acceleration for row in equations.rows]
        nodes += [slope for row in equations.rows for slope in row.partials]
        numbers = bound(given)
        inputs = ("t", *system.coordinates, *system.velocities)
        self._kernel = kernel(Code(numbers, inputs, tuple(substituted(equations.program, nodes, numbers))))
        #: What coordinates are measured by is asked of these, and the largest of what is given (3, n).
        self._measuring = Dynamics(given).constraints
        self._largest = np.zeros((3, self.n))

    def at(self, times: Any, states: Any) -> tuple[Any, Any, Any, Any]:
        """(f (h, m), g (r, m), c (r, m), J (r, n, m)) at q, q' in the first 2n rows of ``states``."""
        values = self._kernel(np.vstack([np.atleast_1d(times), states[: 2 * self.n]]))
        h, r = self.holonomic, len(self.names)
        partials = values[h + 2 * r :].reshape(r, self.n, -1)
        return values[:h], values[h : h + r], values[h + r : h + 2 * r], partials

    def followed(self, prescribed: _Given, times: Array) -> Any:
        """q, q', q'' (3n, m) with those that follow.  Raises ValueError."""
        n, names, known = self.n, self.system.coordinates, prescribed(times)
        states = np.zeros((3 * n, len(times)))
        for place, name in enumerate(names):
            if name in known:
                states[place::n] = known[name]
                self._largest[:, place] = np.max(np.abs(known[name]), axis=1)
        open_ = [place for place, name in enumerate(names) if name not in known]
        q = np.array([float(x) for x in self.scenario.positions])
        rolled = self._rolled(prescribed, times, states[:, 0:1], q, open_) if open_ else None
        for m, t in enumerate(times):
            column = states[:, m : m + 1]
            column[open_, 0] = q[open_] if rolled is None else rolled[:, m]
            self._placed(t, column, open_)
            _, g, _, partials = self.at(t, column)
            column[[n + k for k in open_], 0] = self._solved(partials[:, :, 0], g[:, 0], open_, t)
            _, _, c, partials = self.at(t, column)
            needed = c[:, 0] + partials[:, :, 0] @ column[2 * n :, 0]
            column[[2 * n + k for k in open_], 0] = self._solved(partials[:, :, 0], needed, open_, t)
            self._check(t, column)
            q = column[:n, 0]
        return states

    def _rolled(self, prescribed: _Given, times: Array, first: Any, q: Any, open_: list[int]) -> Any | None:
        """Open positions (k, m) by the velocities that the rows leave them; None where rows on positions suffice."""
        from scipy.integrate import solve_ivp

        n, names = self.n, self.system.coordinates
        start = first.copy()
        start[open_, 0] = q[open_]
        if np.linalg.matrix_rank(self.at(times[0], start)[3][: self.holonomic, open_, 0], tol=OFF) == len(open_):
            return None
        self._placed(times[0], start, open_)

        def rates(t: float, x: Any) -> Any:
            column = np.zeros((3 * n, 1))
            for name, values in prescribed(np.array([t])).items():
                column[names.index(name) :: n, 0] = values[:, 0]
            column[open_, 0] = x
            _, g, _, partials = self.at(t, column)
            return self._solved(partials[:, :, 0], g[:, 0], open_, t)

        if len(times) < 2:
            return start[open_]
        done = solve_ivp(rates, (times[0], times[-1]), start[open_, 0], "DOP853", times, rtol=1e-12, atol=1e-13)
        if not done.success:
            raise ValueError(f"at t = {done.t[-1] if done.t.size else times[0]:.9g} the motion cannot be followed")
        return done.y

    def _placed(self, t: float, column: Any, open_: list[int]) -> None:
        """Positions are led to the rows that have a position."""
        h = self.holonomic
        for _ in range(STEPS if open_ and h else 0):
            f, _, _, partials = self.at(t, column)
            step = self._solved(partials[:h, :, 0], f[:, 0], open_, t, partly=True)
            column[open_, 0] += step
            if not np.any(np.abs(step) > 1e-14 * self._sizes(column)[0][open_]):
                break

    def _sizes(self, column: Any) -> list[Any]:
        """What q, q', q'' are measured by at a time, each (n,): by what they are in the whole motion."""
        assert self._measuring is not None
        largest = np.maximum(self._largest, np.abs(column[:, 0]).reshape(3, self.n))
        sizes = [self._measuring.sizes(np.concatenate([column[: self.n, 0], x])) for x in largest]
        return [np.maximum(sizes[0][: self.n], largest[0]), sizes[1][self.n :], sizes[2][self.n :]]

    def _solved(self, partials: Any, right: Any, open_: list[int], t: float, partly: bool = False) -> Any:
        """x with J x = -right for the coordinates that are open."""
        if not open_:
            return np.zeros(0)
        if not np.isfinite(partials).all() or not np.isfinite(right).all():
            raise ValueError(f"at t = {t:.9g} the constraints have no finite value")
        solution, _, rank, _ = np.linalg.lstsq(partials[:, open_], -right, rcond=OFF)
        if rank < len(open_) and not partly:
            listed = ", ".join(self.system.coordinates[k] for k in open_)
            why = "the constraints do not determine it" if len(open_) == 1 else "the constraints do not determine all"
            raise ValueError(f"at t = {t:.9g} the motion of {listed} does not follow from what is given: {why}")
        return solution

    def _turning(self, t: float, column: Any) -> Any:
        """How large what makes up c is, each (r,): c may be what is left of it, and so rounding (a parallelogram's)."""
        n = self.n
        others = np.repeat(column[: 2 * n], n + 1, axis=1)
        others[range(n, 2 * n), range(n)] = 0.0  # without one velocity each, and with all of them
        return np.max(np.abs(self.at(np.full(n + 1, t), others)[2]), axis=1)

    def _check(self, t: float, column: Any) -> None:
        n, h = self.n, self.holonomic
        f, g, c, partials = (x[..., 0] for x in self.at(t, column))
        slopes = np.abs(partials)
        sizes = self._sizes(column)
        off = [np.abs(f) / (slopes[:h] @ sizes[0] + 1e-300), np.abs(g) / (slopes @ sizes[1] + 1e-300)]
        off.append(np.abs(c + partials @ column[2 * n :, 0]) / (slopes @ sizes[2] + self._turning(t, column) + 1e-300))
        for values, what in zip(off, ("", " (velocities)", " (accelerations)"), strict=True):
            if len(values) and not np.max(values) < OFF:
                name = self.names[int(np.argmax(np.nan_to_num(values, nan=np.inf)))]
                raise ValueError(f"at t = {t:.9g} the motion does not satisfy {name.label}{what}")


def _equations(system: System, given: Scenario, states: Any, times: Array) -> tuple[Any, Any, Any, Any]:
    """(M q'' - f at u = 0 (n, m), -f (n, m), B (n, k, m), M (n, n, m))."""
    program: Program = bound(given)
    n, k = len(system.coordinates), len(system.input_names)
    moving = [*system.coordinates, *system.velocities, *map(acceleration_name, system.coordinates)]
    names = [*system.parameter_names, *(item.name for item in system.prescribed), "t", "pi", *moving]
    environment = {name: program.input(name) for name in (*names, *system.input_names)}
    ring = ring_of(system)
    needed, applied = _with_forces(system, program, environment, ring)
    slopes = jacobian(program, needed, [program.input(name) for name in system.input_names])
    check_linear(program, system, slopes)
    tree = programs(system, ring, open_tree=True)
    masses = substituted(tree.program, [x for row in tree.mass_matrix for x in row], program)
    outputs = (*needed, *applied, *(x for row in slopes for x in row), *masses)
    code = Code(program, ("t", *moving, *system.input_names), outputs)
    values = np.asarray(kernel(code)(np.vstack([times, states, np.zeros((k, len(times)))])), dtype=float)
    _demand_finite(values, times, "what the motion needs")
    columns = -values[2 * n : 2 * n + n * k].reshape(n, k, len(times))
    return values[:n], values[n : 2 * n], columns, values[2 * n + n * k :].reshape(n, n, len(times))
