"""Members of an ensemble one after the other, where steps have to end at switches and be short beside narrow loads.

Side by side all members take the steps of their error estimates alone, which may pass over a push without a sign of it.
The same holds of states that have to be led back: to constraints, to quaternions of length 1.  Here each is a run of
its own (``mbsym.numerics.methods.landing``, ``led``), with the parameters behind its state,

    x = (q, q', p),    x' = (rhs(t, q, q', p), 0),

so that one compiled code does for all of them.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

from mbsym.algebra.program import Node
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.ensembles.parametrised import Parametrised
from mbsym.numerics.ensembles.side_by_side import Fate
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.methods.interface import BLOW_UP, LARGEST, Breakdown, Run, Setting
from mbsym.numerics.methods.passed import Narrow, met_by
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.orbits.variational import extended
from mbsym.numerics.specialise import Specialised


class WithParameters(Dynamics):
    """A scenario whose free parameters are constant components of the state."""

    def __init__(self, base: Parametrised) -> None:
        values = [Fraction(base.scenario.parameters[name]) for name in base.free]
        super().__init__(extended(base.scenario, values), base.ring)
        self.base = base
        self.inputs = base.inputs
        self.__dict__["constraints"] = base.constraints

    @property
    def dimension(self) -> int:
        """Of (q, q', p)."""
        return len(self.inputs) - 1

    @cached_property
    def _specialised(self) -> Specialised:
        return self.base._specialised

    @cached_property
    def right_hand_side(self) -> Code:
        """(t, q, q', p) -> (q', q'', 0)."""
        rates = self.base.right_hand_side
        return Code(rates.program, self.inputs, (*rates.outputs, *self._still))

    @property
    def _still(self) -> list[Node]:
        return [self._specialised.zero] * len(self.base.free)

    @cached_property
    def correction(self) -> Code | None:
        """Of the state; parameters stay."""
        found = self.base.correction
        if found is None:
            return None
        *moved, nearness = found.outputs
        return Code(found.program, self.inputs, (*moved, *self._still, nearness))

    @cached_property
    def pivots(self) -> Code:
        """(t, q, q', p) -> those of the matrices."""
        return self.base.pivots


class OneByOne:
    """Members under way, as ``SideBySide`` has them: ``starts`` (2n, m), ``parameters`` (p, m)."""

    threads, lanes = 1, 1

    def __init__(self, whole: WithParameters, method: str, setting: Setting, starts: Any, parameters: Any) -> None:
        self._dynamics, self._method, self._setting = whole, method, setting
        self._size, self.members = starts.shape
        self._states = np.vstack([starts, parameters]).astype(float)
        self._runs: list[Run | None] = [None] * self.members
        self._bound = LARGEST * np.maximum(1.0, np.max(np.abs(starts), axis=0, initial=0.0))
        self.fates: dict[int, Fate] = {}

    @property
    def steps(self) -> Any:
        """(accepted, rejected) of every member, so far."""
        work = [None if run is None else run.work for run in self._runs]
        accepted = [0 if one is None else one.steps for one in work]
        return np.array(accepted, float), np.array([0 if one is None else one.rejected for one in work], float)

    @property
    def missed(self) -> dict[int, Narrow]:
        """By member the first narrow feature that a step of it passed."""
        found = {}
        for member, run in enumerate(self._runs):
            passed = met_by(run)
            narrow = [] if passed is None else [one for one in passed.narrow if not one.followed]
            if narrow:
                found[member] = narrow[0]
        return found

    def block(self, times: Any) -> Any:
        """States at increasing times beyond those before, shape (len(times), 2n, m); nan from where a member ended."""
        times = np.ascontiguousarray(times, float)
        out = np.full((len(times), self._size, self.members), np.nan)
        for member in range(self.members):
            if member not in self.fates:
                rows = self._rows(member, times)
                out[: rows.shape[1], :, member] = rows[: self._size].T
        return out

    def _rows(self, member: int, times: Any) -> Any:
        """The states of one member, up to where it ends."""
        try:
            run = self._runs[member]
            if run is None:
                run = METHODS[self._method].start(self._dynamics, self._setting, initial=self._states[:, member])
                self._runs[member] = run
            with np.errstate(all="ignore"):
                rows = run.fill(times)
        except Breakdown as ended:
            self.fates[member] = Fate(member, ended.kind, float(ended.time))
            rows = np.empty((len(self._states), 0)) if ended.filled is None else ended.filled
        with np.errstate(invalid="ignore"):
            fine = np.all(np.abs(rows[: self._size]) < self._bound[member], axis=0)
        if np.all(fine):
            return rows
        first = int(np.argmin(fine))
        self.fates[member] = Fate(member, BLOW_UP, float(times[first]))
        return rows[:, :first]
