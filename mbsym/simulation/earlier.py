"""Where an earlier run got to, so that another one can go on from there (``mbsym simulate --continue``).

The new run begins in the last state of the earlier one, to the last bit, with a step found anew.  So the two together
are the uninterrupted run but for what a step size changes: to rounding with steps of one length (where the earlier
run ended at the end of a step), within the tolerance with steps that are chosen.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from mbsym.numerics.planning.models import Model


@dataclass(frozen=True, eq=False)
class Earlier:
    """The rows of an earlier run, from t = 0 to where it ended: times (m,) and states (2n, m).

    ``spacing`` is the distance of rows that was asked for; ``values`` are parameters and the state at t = 0 by their
    names, and the rest is how it was integrated: ``method`` is the last one, which may ``change`` on the way, ``model``
    how much of the mechanics was in the equations.
    """

    times: Any
    states: Any
    spacing: float
    values: Mapping[str, float]
    method: str
    tolerance: float | None
    step: float | None
    arithmetic: str
    change: bool = False
    model: Model = Model()

    @property
    def time(self) -> float:
        """Where it ended."""
        return float(self.times[-1])

    @property
    def state(self) -> Any:
        """The state there, in the arithmetic of the run."""
        return self.states[:, -1]

    def further(self, end: float, every: float | None, samples: int | None) -> Any:
        """Times after ``time`` up to ``end``: ``samples`` of them, one ``every`` so often, or spaced as before.

        Where the rows so far stand on multiples of the spacing, as they do unless they end between, so do these.
        """
        if samples is not None:
            return np.linspace(self.time, end, samples + 1)[1:]
        spacing = every if every is not None else self.spacing
        before = round(self.time / spacing)
        on_grid = abs(before * spacing - self.time) <= 1e-9 * spacing
        first = before if on_grid else 0
        count = int(np.ceil((end - (0.0 if on_grid else self.time)) / spacing * (1 - 1e-12))) - first
        times = np.arange(first + 1, first + max(count, 1) + 1) * spacing + (0.0 if on_grid else self.time)
        times[-1] = end
        return times
