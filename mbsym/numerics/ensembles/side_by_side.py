"""Many motions of one system at once: members of an ensemble side by side in vector registers, and on all cores.

    x_k' = rhs(t, x_k, p_k),    x_k(0) = given,    k = 1 ... m

Every member takes the steps that it would take alone (``ensembles.ensemble_text``), so that it ends where a run of
its own ends, but for rounding.  Members keep what a step needs (some 20 numbers a coordinate and velocity), whatever
the number of times; states come out in blocks of times.
"""

from __future__ import annotations

import ctypes
import os
import threading
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from math import ceil, log
from typing import Any, ClassVar

import llvmlite.binding as llvm
import numpy as np

from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.ensembles.ensemble_text import (
    PAUSED,
    Clock,
    Shared,
    adaptive_text,
    fixed_text,
    library,
    rows_of,
)
from mbsym.numerics.kernels.interface import FLOAT64, Code, Kernel
from mbsym.numerics.kernels.llvm import Library, kernel
from mbsym.numerics.methods.interface import Cause, Setting, within_bound
from mbsym.numerics.methods.magnitudes import Magnitudes, Variables, first_steps, magnitudes, variables
from mbsym.numerics.methods.runge_kutta import OPERATIONS_AT_A_TIME
from mbsym.numerics.methods.tableaux import DOP853, RK4, RK45, Tableau, address, aligned

#: The methods that run side by side.
TABLEAUX = {tableau.name: tableau for tableau in (DOP853, RK45, RK4)}


@dataclass(frozen=True)
class Fate:
    """What ended a member early: its number (from 0), why, and about when."""

    member: int
    kind: str
    time: float


@cache
def lanes_here() -> int:
    """Members side by side: what one register of AVX-512 holds, or two of AVX2, which hide what one waits for."""
    return 8 if llvm.get_host_cpu_features().get("avx2") else 4


@dataclass(frozen=True)
class Compiled:
    """A method compiled for a right-hand side with inputs (t, x, p)."""

    code: Code
    tableau: Tableau
    kinds: Variables
    parameters: int
    lanes: int
    library: Library

    @property
    def size(self) -> int:
        """Numbers of a state."""
        return len(self.kinds.angles)

    @property
    def driver(self) -> Any:
        """The ctypes function; it lets other threads run."""
        pointer, whole = ctypes.c_void_p, ctypes.c_int64
        if not self.tableau.errors:
            return self.library.function("fixed", *[pointer] * 4, whole, result=whole)
        return self.library.function("adaptive", *[pointer] * 11, *[whole] * 4, result=whole)


def compiled(dynamics: Dynamics, tableau: Tableau) -> Compiled:
    """What the inputs of the rates have behind (t, x) are parameters."""
    lanes, code, size = lanes_here(), dynamics.right_hand_side, dynamics.dimension
    parameters = len(code.inputs) - 1 - size
    text = adaptive_text if tableau.errors else fixed_text
    made = library(code, text(tableau, size, parameters, lanes), lanes)
    return Compiled(code, tableau, variables(dynamics), parameters, lanes, made)


class SideBySide:
    """Members under way.  ``starts`` has shape (2n, m), ``parameters`` (p, m); times are asked for in blocks."""

    #: What is narrow is integrated one by one.
    missed: ClassVar[Mapping[int, Any]] = {}

    def __init__(
        self, made: Compiled, setting: Setting, starts: Any, parameters: Any, threads: int | None = None
    ) -> None:
        self.made, self.setting = made, setting
        self.members = starts.shape[1]
        lanes = made.lanes
        self.groups = -(-self.members // lanes)
        padded = np.minimum(np.arange(self.groups * lanes), self.members - 1)
        shape = (self.groups, made.size, lanes)
        self.x, self.carry = aligned(shape, float), aligned(shape, float)
        self.x[:] = _grouped(np.asarray(starts, float)[:, padded], lanes)
        self.p = aligned((self.groups, max(made.parameters, 1), lanes), float)
        if made.parameters:
            self.p[:] = _grouped(np.asarray(parameters, float)[:, padded], lanes)
        self.threads = max(1, min(threads or len(os.sched_getaffinity(0)), self.groups))
        self.fates: dict[int, Fate] = {}
        self.time = 0.0
        self.evaluations = 0
        self.stopped = threading.Event()
        self._driver = made.driver
        self._started = False
        if made.tableau.errors:
            self._adaptive_arrays()

    def _adaptive_arrays(self) -> None:
        made, setting = self.made, self.setting
        shape = (self.groups, made.size, made.lanes)
        self.old = aligned(shape, float)
        self.old[:] = self.x
        self.k = aligned((self.groups, rows_of(made.tableau) * made.size, made.lanes), float)
        self.clock = aligned((self.groups, len(Clock), made.lanes), float)
        self.index = aligned((self.groups, made.lanes), np.int64)
        tolerance = setting.tolerance if setting.tolerance is not None else 1e-9
        relative = max(tolerance, 4 * float(np.finfo(float).eps))
        self.shared = aligned(3, float)
        self.shared[[Shared.RELATIVE, Shared.ABSOLUTE]] = relative, tolerance
        self.shared[Shared.LONGEST] = 1e30 if setting.longest is None else setting.longest
        self.clock[:, Clock.PREVIOUS] = log(1e-4)
        starts, parameters = self._flat(self.x), self._flat(self.p)
        rhs = kernel(made.code, FLOAT64)

        def rates(times: Any, states: Any) -> Any:
            return rhs(np.vstack([times, states, parameters]))

        begin = np.zeros(starts.shape[1])
        known = self._known = self._magnitudes(rhs, begin, starts, parameters)
        self.sizes = aligned(shape, float)
        floor = known.floor(tolerance, float(np.finfo(float).eps))
        self.sizes[:] = _grouped(np.maximum(np.abs(starts), floor), made.lanes)
        steps, slopes = first_steps(rates, made.tableau.order, known, begin, starts, tolerance, relative)
        self.clock[:, Clock.STEP] = np.minimum(steps, self.shared[Shared.LONGEST]).reshape(self.groups, made.lanes)
        self.k[:, : made.size] = _grouped(slopes, made.lanes)
        self.evaluations += 2 * self.members

    def _magnitudes(self, rhs: Kernel, begin: Any, starts: Any, parameters: Any) -> Magnitudes:
        """Those of each member, whose parameters stay: as constants behind its state."""
        kinds, still = self.made.kinds, len(parameters)

        def rates(times: Any, whole: Any) -> Any:
            self.evaluations += len(times) * self.members // starts.shape[1]
            return np.vstack([rhs(np.vstack([times, whole])), np.zeros((still, len(times)))])

        angles, moving = (np.append(mask, np.zeros(still, bool)) for mask in (kinds.angles, kinds.velocities))
        constant = np.append(kinds.constant, np.ones(still, bool))
        behind = Variables(angles, moving, constant, kinds.masses)
        extended = magnitudes(rates, behind, begin, np.vstack([starts, parameters]))
        size = self.made.size
        return Magnitudes(extended.sizes[:size], extended.times, extended.natural[:size], extended.roundings[:size])

    def _flat(self, grouped: Any) -> Any:
        """(rows, members and what fills the last group)."""
        rows = grouped.shape[1] if grouped is not self.p else self.made.parameters
        return np.ascontiguousarray(grouped[:, :rows].transpose(1, 0, 2).reshape(rows, self.groups * self.made.lanes))

    @property
    def lanes(self) -> int:
        """Members in one register."""
        return self.made.lanes

    @property
    def steps(self) -> Any:
        """(accepted, rejected) of every member, so far; of fixed steps, those that were made."""
        if not self.made.tableau.errors:
            return np.full(self.members, self._fixed_steps), np.zeros(self.members)
        accepted, rejected = (
            self.clock[:, place].reshape(-1)[: self.members] for place in (Clock.STEPS, Clock.REJECTED)
        )
        return accepted, rejected

    _fixed_steps = 0

    def block(self, times: Any) -> Any:
        """States at increasing times beyond those before, shape (len(times), 2n, m); nan from where a member ended."""
        times = np.ascontiguousarray(times, float)
        out = np.full((len(times), self.made.size, self.groups * self.made.lanes), np.nan)
        (self._adaptive if self.made.tableau.errors else self._fixed)(times, out)
        self.time = float(times[-1])
        states = out[:, :, : self.members]
        self._bury(times, states)
        return states

    # --- drivers ---

    def _adaptive(self, times: Any, out: Any) -> None:
        made, rows = self.made, len(times)
        self.index[:] = 0
        width = out.shape[2]
        cost = rows_of(made.tableau) * (made.code.operations + 10) * made.lanes
        budget = max(1, min(OPERATIONS_AT_A_TIME // cost, self.setting.step_limit))

        def work(group: int) -> None:
            arrays = (self.x, self.carry, self.old, self.k, self.clock, self.index, self.p, self.sizes)
            pointers = [address(array[group]) for array in arrays]
            pointers += [address(self.shared), address(times), address(out) + 8 * group * made.lanes]
            while self._driver(*pointers, 0, rows, width, budget) == PAUSED and not self.stopped.is_set():
                clock = self.clock[group]
                over = clock[Clock.STEPS] + clock[Clock.REJECTED] >= self.setting.step_limit
                clock[Clock.DEAD, over] = 3

        self._everywhere(work)

    def _fixed(self, times: Any, out: Any) -> None:
        made = self.made
        step = self.setting.step or 0.0
        plan = []
        before = self.time
        for t in times:
            count = max(1, ceil((t - before) / step * (1 - 1e-9))) if t > before else 0
            plan.append((np.array([before, (t - before) / max(count, 1)]), count))
            before = float(t)
        self._fixed_steps += sum(count for _, count in plan)
        at_once = max(1, OPERATIONS_AT_A_TIME // (len(made.tableau.stages) * (made.code.operations + 10) * made.lanes))

        def work(group: int) -> None:
            pointers = [address(array[group]) for array in (self.x, self.carry, self.p)]
            place = slice(group * made.lanes, (group + 1) * made.lanes)
            for row, (shared, count) in enumerate(plan):
                done = 0
                while done < count:
                    if self.stopped.is_set():
                        return
                    now = min(count - done, at_once)
                    here = np.array([shared[0] + done * shared[1], shared[1]])
                    self._driver(*pointers, address(here), now)
                    done += now
                out[row, :, place] = self.x[group]

        self._everywhere(work)

    def _everywhere(self, work: Any) -> None:
        """All groups, by all threads."""
        if self.threads == 1:
            for group in range(self.groups):
                work(group)
            return
        waiting = iter(range(self.groups))
        lock = threading.Lock()

        def worker() -> None:
            for group in _taken(waiting, lock):
                if self.stopped.is_set():
                    return
                work(group)

        with ThreadPoolExecutor(self.threads) as pool:
            try:
                for future in [pool.submit(worker) for _ in range(self.threads)]:
                    future.result()
            except BaseException:
                self.stopped.set()
                raise

    # --- ends ---

    def _bury(self, times: Any, states: Any) -> None:
        """Members that are no numbers, or beyond all bounds, are ended there, and said to be."""
        lost = ~within_bound(np.swapaxes(states, 0, 1))
        ended = np.flatnonzero(lost[-1] | np.any(lost, axis=0))
        for member in ended:
            first = int(np.argmax(lost[:, member]))
            states[first:, :, member] = np.nan
            if int(member) not in self.fates:
                self.fates[int(member)] = self._fate(int(member), times, first)

    def _fate(self, member: int, times: Any, first: int) -> Fate:
        group, lane = divmod(member, self.made.lanes)
        when = float(times[first])
        if not self.made.tableau.errors:
            self.x[group, :, lane] = np.nan
            return Fate(member, Cause.BLOW_UP, when)
        clock = self.clock[group, :, lane]
        last, slopes = self.x[group, :, lane], self.k[group, : self.made.size, lane]
        kind = Cause.STEP_LIMIT if clock[Clock.DEAD] == 3 else Cause.STUCK
        if kind == Cause.STUCK and (clock[Clock.INFINITE] or self._known.outgrown(last, slopes, member)):
            kind = Cause.BLOW_UP
        if clock[Clock.DEAD]:
            when = min(when, max(float(clock[0]), 0.0))
        clock[Clock.DEAD] = max(1.0, clock[Clock.DEAD])
        return Fate(member, kind, when)


def _taken(waiting: Iterator[int], lock: threading.Lock) -> Iterator[int]:
    """The next ones, each taken once."""
    while True:
        with lock:
            index = next(waiting, None)
        if index is None:
            return
        yield index


def _grouped(rows: Any, lanes: int) -> Any:
    """(rows, m) as (m / lanes, rows, lanes)."""
    return rows.reshape(rows.shape[0], -1, lanes).transpose(1, 0, 2)
