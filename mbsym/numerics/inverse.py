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

import numpy as np
import numpy.typing as npt

from mbsym.algebra.base import Lowering
from mbsym.algebra.derivative import jacobian
from mbsym.algebra.failures import Failure
from mbsym.algebra.program import Node, Program
from mbsym.expressions.tree import Expression, add, differentiate, multiply
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.newton_euler import residuals
from mbsym.mechanics.variables import ring_of
from mbsym.model.system import System, acceleration_name, velocity_name
from mbsym.numerics.kernels.arrays import kernel
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.scenario import Scenario, scenario
from mbsym.numerics.specialise import bound

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
    the size of the terms of the same equation over the whole motion, rounding apart.  ``rank`` (m) is that of B.
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
        from mbsym.numerics.inverse_constrained import inverse_constrained  # it builds on this module

        return inverse_constrained(system, motion, overrides, times)
    given = scenario(system, overrides, state=False)
    program, states, needed = _program(system, given, motion)
    inputs = [program.input(name) for name in system.input_names]
    slopes = jacobian(program, needed, inputs)
    check_linear(program, system, slopes)
    n, k = len(system.coordinates), len(inputs)
    outputs = (*states, *needed, *(x for row in slopes for x in row))
    code = Code(program, ("t", *system.input_names), outputs)
    at = np.vstack([times, np.zeros((k, len(times)))])
    found = kernel(code)(at)
    if not np.isfinite(found).all():
        first = times[~np.isfinite(found).all(axis=0)][0]
        raise ValueError(f"at t = {first:.9g} the motion, or what it needs, is infinite or no number")
    finer = np.asarray(kernel(code, "extended")(at), dtype=float)
    noise = np.abs(finer - found)[3 * n : 4 * n].max(axis=1)
    moved, right = finer[: 3 * n], finer[3 * n : 4 * n]
    columns = -finer[4 * n :].reshape(n, k, len(times))
    values, rank = _solved(columns, right)
    supplied = np.einsum("ikm,km->im", columns, values)
    size = (np.abs(right) + np.einsum("ikm,km->im", np.abs(columns), np.abs(values))).max(axis=1)
    left = np.abs(supplied - right).max(axis=1)
    open_ = (left > ROUNDING * noise) & (left > FOLDED * max(1.0, float(size.max())))
    remaining = float((left[open_] / size[open_]).max(initial=0.0))
    return InverseDynamics(
        system, system.input_names, times, values, moved[:n], moved[n : 2 * n], moved[2 * n :],
        supplied - right, remaining, rank,
    )  # fmt: skip


def _program(
    system: System, given: Scenario, motion: Mapping[str, Expression]
) -> tuple[Program, list[Node], list[Node]]:
    """A program of t and the inputs: (q, q', q''), and M q'' - f."""
    program = bound(given)
    rates = {item.name: item.rate for item in system.prescribed}
    names = [*system.parameter_names, *rates, "t", "pi"]
    lower = Lowering(program, {name: program.input(name) for name in names})
    chains = [[motion[name]] for name in system.coordinates]
    for chain in chains:
        for _ in range(2):
            chain.append(rate_of(chain[-1], rates))
    lowered = [[lower(x) for x in chain] for chain in chains]
    for name, (place, speed, acceleration) in zip(system.coordinates, lowered, strict=True):
        program.bound[name] = place
        program.bound[velocity_name(name)] = speed
        program.bound[acceleration_name(name)] = acceleration
    everything = [*names, *system.coordinates, *system.velocities, *system.input_names]
    everything += [acceleration_name(name) for name in system.coordinates]
    environment = {name: program.input(name) for name in everything}
    needed = residuals(Scene(system, program, environment, ring_of(system)))
    states = [chain[order] for order in range(3) for chain in lowered]
    return program, states, [needed[name] for name in system.coordinates]


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
        raise NotLinear(f"inputs are found where they enter linearly, and {', '.join(bent)} does not")


def _solved(columns: Array, right: Array) -> tuple[Array, npt.NDArray[np.int64]]:
    """The smallest u that minimises |B u - r| at every time, and the rank of B."""
    count = columns.shape[2]
    values, rank = np.zeros((columns.shape[1], count)), np.zeros(count, dtype=np.int64)
    for m in range(count):
        found, _, rank[m], _ = np.linalg.lstsq(columns[:, :, m], right[:, m], rcond=NOTHING)
        values[:, m] = found
    return values, rank
