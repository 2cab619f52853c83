"""Measure of a motion: a formula in coordinates and velocities, at the end of a simulation and its extremes.

Members are integrated side by side (dop853, tolerance 1e-9), each with its own parameters and initial state; extremes
are those at ``ROWS`` equally spaced times.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mbsym.algebra.base import Lowering
from mbsym.expressions.message import Message
from mbsym.expressions.tree import Expression
from mbsym.numerics.closing import begun
from mbsym.numerics.ensembles.ensemble import beginning
from mbsym.numerics.ensembles.parametrised import Parametrised, released
from mbsym.numerics.ensembles.variation import members
from mbsym.numerics.kernels import arrays
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.scenario import Names, Scenario
from mbsym.sweeps.points import Column

METHOD, TOLERANCE = "dop853", 1e-9
ROWS = 201
#: States are taken in blocks of about so many numbers.
BLOCK = 2_000_000
#: A member that takes more steps than this ends early.
MOST_STEPS = 1_000_000


class SimulatedMeasure:
    """``formula`` along the motions from 0 to ``time``; not a number for motions that end early.

    ``overrides`` are those of which the scenario was made.  Raises Failure where there is no program for the equations.
    """

    def __init__(
        self,
        scenario: Scenario,
        overrides: Mapping[str, Expression],
        names: Sequence[str],
        formula: Expression,
        text: str,
        time: float,
    ) -> None:
        self.names = tuple(names)
        free = [name for name in names if name in scenario.system.parameter_names]
        self._dynamics = Parametrised(begun(scenario, declared=False).scenario, free, overrides)
        self._times = np.linspace(0.0, time, ROWS)
        fresh = released(scenario, free)
        node = Lowering(fresh, Names(fresh))(formula)
        self._formula = arrays.kernel(Code(fresh, self._dynamics.inputs, (node,)))
        self.columns = (
            Column(
                "final",
                f"{text} at t = {time:.12g}; not a number where the motion ended early",
                title=Message("[[formula]] at t = [[time]]", formula=text, time=f"{time:.12g}"),
            ),
            Column("least", f"the least {text} at {ROWS} equally spaced times"),
            Column("greatest", f"the greatest {text} at {ROWS} equally spaced times"),
        )

    def at(self, points: Any) -> Mapping[str, Any]:
        ensemble = members(self._dynamics, self.names, points)
        setting = Setting(TOLERANCE, None, MOST_STEPS, None)
        run = beginning(ensemble, METHOD, 1)(setting, slice(None))
        final = self._value(0.0, ensemble.starts, ensemble.parameters)
        least, greatest = final.copy(), final.copy()
        rows = max(1, BLOCK // max(1, ensemble.starts.size))
        for first in range(1, ROWS, rows):
            times = self._times[first : first + rows]
            for t, states in zip(times, run.block(times), strict=True):
                final = self._value(float(t), states, ensemble.parameters)
                least, greatest = np.minimum(least, final), np.maximum(greatest, final)  # nan stays
        return {"final": final, "least": least, "greatest": greatest}

    def _value(self, t: float, states: Any, parameters: Any) -> Any:
        times = np.full((1, states.shape[1]), t)
        return self._formula(np.vstack([times, states, parameters]))[0]
