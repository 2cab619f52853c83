"""Gradients by the adjoint equations: one number at the end by all parameters and all initial values at once.

    G(x(T), p),    lambda' = -J^T lambda,    lambda(T) = dG/dx,
    dG/dp = (dG/dp)(T) + int_0^T lambda^T df/dp dt + lambda(0)^T dx(0)/dp,    dG/dx(0) = lambda(0)

The right-hand sides J^T lambda and lambda^T df/dp are one reverse sweep over the program of lambda^T f, whatever the
number of parameters.  They are integrated backwards between checkpoints, where the state is taken up again from the
forward run; how far a state that was followed backwards is from the next checkpoint is measured and told.

Source: Cao, Li, Petzold & Serban, SIAM J. Sci. Comput. 24 (2003) 1076.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

from mbsym.algebra.base import Lowering
from mbsym.algebra.derivative import gradient
from mbsym.expressions.tree import Expression
from mbsym.mechanics.constraints.refusal import refuse_constraints
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.ensembles.parametrised import Parametrised
from mbsym.numerics.kernels import arrays
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.orbits.variational import extended, require_smooth, start_column
from mbsym.numerics.scenario import Scenario
from mbsym.numerics.specialise import Names, bound, substituted

#: Pieces into which the time is cut.
CHECKPOINTS = 32


@dataclass(frozen=True)
class Gradient:
    """G at the end and its derivatives by name; ``mismatch`` is the largest distance of a state followed backwards from
    the checkpoint that it should meet, as part of the state's size."""

    value: float
    by: Mapping[str, float]
    mismatch: float


class Adjoint(Dynamics):
    """(x, lambda, g)' in the time s = T - t:  x' = -f,  lambda' = J^T lambda,  g' = lambda^T df/dp."""

    def __init__(self, base: Parametrised, time: Fraction) -> None:
        self.base, self.end = base, time
        self.count = len(base.free) + len(base.free) % 2  # states come in pairs
        n = 2 * base.size
        super().__init__(extended(base.scenario, [Fraction(0)] * (n + self.count)), base.ring)
        self.states = (*self.system.coordinates, *self.system.velocities)
        multipliers = tuple(f"{name}~adjoint" for name in self.states)
        sums = tuple(f"sum~{k}" for k in range(self.count))
        self.inputs = ("t", *self.states, *multipliers, *sums)
        self.size = base.size * 2 + self.count // 2

    @cached_property
    def right_hand_side(self) -> Code:
        """One reverse sweep over lambda^T f."""
        rhs = self.base.right_hand_side
        program = rhs.program
        product = program.zero
        for name, output in zip(self.states, rhs.outputs, strict=True):
            product = product + program.product(program.input(f"{name}~adjoint"), output)
        inputs = [program.input(name) for name in (*self.states, *self.base.free)]
        slopes = gradient(program, product, inputs)
        nodes = [*(-output for output in rhs.outputs), *slopes]
        nodes += [program.zero] * (self.count - len(self.base.free))
        fresh = bound(self.scenario)
        fresh.bound["t"] = fresh.difference(fresh.number(self.end), fresh.input("t"))
        return Code(fresh, self.inputs, tuple(substituted(program, nodes, fresh)))


def gradient_at_end(
    scenario: Scenario,
    functional: Expression,
    names: Sequence[str],
    time: float,
    overrides: Mapping[str, Expression] | None = None,
    tolerance: float = 1e-11,
) -> Gradient:
    """d G/d name by parameters and initial values; G is an expression in coordinates, velocities and parameters.

    Raises Breakdown where the motion ends early, Failure where there is no program.
    """
    refuse_constraints(scenario.system, "gradients")
    system = scenario.system
    states = (*system.coordinates, *system.velocities)
    free = [name for name in names if name not in states]
    base = Parametrised(scenario, free, overrides)
    require_smooth(base)
    n = len(states)
    forward = METHODS["dop853"].start(Dynamics(scenario), Setting(tolerance))
    times = np.linspace(0.0, time, CHECKPOINTS + 1)
    motion = np.array(forward.fill(times))
    value, slopes = _functional(base, functional, motion[:, -1])
    adjoint = Adjoint(base, Fraction(time))
    state = np.concatenate([motion[:, -1], slopes[:n], np.zeros(adjoint.count)])
    run = METHODS["dop853"].start(adjoint, Setting(tolerance), initial=state, at=0.0)
    mismatch = 0.0
    for place in range(CHECKPOINTS, 0, -1):
        state[:n] = motion[:, place]
        run.restart(float(time - times[place]), state)
        state = np.array(run.advance(float(time - times[place - 1])))
        apart = np.abs(state[:n] - motion[:, place - 1]) / (1 + np.abs(motion[:, place - 1]))
        mismatch = max(mismatch, float(np.max(apart)))
    multipliers, sums = state[n : 2 * n], state[2 * n :]
    by = {}
    for name in names:
        if name in states:
            by[name] = float(multipliers[states.index(name)])
        else:
            place = free.index(name)
            start = np.array([float(x) for x in start_column(base, name)])
            by[name] = float(slopes[n + place] + sums[place] + multipliers @ start)
    return Gradient(value, by, mismatch)


def _functional(base: Parametrised, functional: Expression, end: Any) -> tuple[float, Any]:
    """G and its derivatives by (x, p) at the end."""
    program = base.right_hand_side.program
    output = Lowering(program, Names(program))(functional)
    names = (*base.system.coordinates, *base.system.velocities, *base.free)
    slopes = gradient(program, output, [program.input(name) for name in names])
    values = np.concatenate([end, [float(base.scenario.parameters[name]) for name in base.free]])
    found = arrays.kernel(Code(program, names, (output, *slopes)))(values)
    return float(found[0]), found[1:]
