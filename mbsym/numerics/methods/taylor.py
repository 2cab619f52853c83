"""Taylor series of high order by heyoka (Biscani & Izzo, MNRAS 504 (2021) 2614): an extra, imported only on use.

Every instruction of the straight-line program becomes one heyoka expression, shared like the instruction; heyoka
derives the recurrences of the Taylor coefficients from them and compiles them. The order follows from the tolerance
(about -ln(tol)/2 + 1), the step from the decay of the coefficients; times between steps come from the series itself.

heyoka's tolerance bounds the remainder of each step, relative to the largest component of the state if that exceeds 1.
So it integrates y_i = x_i/s_i, where s_i is the size that x_i has about where a run begins (``magnitudes``): the unit
of a length or of the time changes nothing.  The s_i are powers of 2, so that no digit is lost.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from mbsym.expressions.message import Message
from mbsym.numerics.dynamics import Dynamics, Frozen
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT32, FLOAT64, Code, place_of
from mbsym.numerics.kernels.llvm import SCALARS
from mbsym.numerics.methods.interface import (
    Breakdown,
    Cause,
    Setting,
    Traits,
    Unusable,
    Work,
    compiled_kernel,
    once,
)
from mbsym.numerics.methods.led import lead, nearly_singular
from mbsym.numerics.methods.magnitudes import OUTGROWN, counted, magnitudes, variables
from mbsym.numerics.methods.stepping import Stepping
from mbsym.numerics.methods.tableaux import exact_number, initial_state

#: Beyond so many operations heyoka is told to compile loops instead of straight code, which is slower to run.
STRAIGHT = 100

#: No step is longer, relative to the time.
FAR = 100.0

#: heyoka's own loop is left after so many steps, so that Ctrl-C works.
STEPS_AT_A_TIME = 2_000

#: As many rows, and as many series, are looked at together at most.
ROWS_AT_A_TIME, SERIES_AT_A_TIME = 2_000, 1024

#: For fewer steps heyoka's own loop is not begun.
FEW = 8


def _heyoka() -> Any:
    try:
        import heyoka
    except ImportError:
        raise Unusable("the Taylor method needs heyoka: pip install heyoka (or mbsym[taylor])") from None
    return heyoka


def expressions(code: Code, heyoka: Any, dtype: Any, scales: Mapping[str, Any] | None = None) -> list[Any]:
    """The outputs as heyoka expressions; the input ``t`` is heyoka's time, one with a scale that times its variable."""
    program = code.program
    values: dict[int, Any] = {}
    for number in program.live(code.outputs):
        instruction = program.instructions[number]
        operands = [values[operand] for operand in instruction.operands]
        match instruction.operation, operands:
            case "constant", _:
                assert isinstance(instruction.payload, Fraction)
                expression = heyoka.expression(exact_number(instruction.payload, dtype))
            case "input", _:
                name = str(instruction.payload)
                cell = None if name in code.inputs else place_of(name)
                expression = (
                    heyoka.time if name == "t" else heyoka.expression(name) if cell is None else heyoka.par[cell]
                )
                expression = scales[name] * expression if scales is not None and name in scales else expression
            case "negative", [a]:
                expression = -a
            case "add", [a, b]:
                expression = a + b
            case "subtract", [a, b]:
                expression = a - b
            case "multiply", [a, b]:
                expression = a * b
            case "divide", [a, b]:
                expression = a / b
            case "sign", [a]:  # runs are cut where a changes its sign
                zero, one = (heyoka.expression(exact_number(Fraction(value), dtype)) for value in (0, 1))
                expression = heyoka.select(heyoka.gt(a, zero), one, heyoka.select(heyoka.lt(a, zero), -one, zero))
            case "abs", [a]:
                zero = heyoka.expression(exact_number(Fraction(0), dtype))
                expression = heyoka.select(heyoka.lt(a, zero), -a, a)
            case function, [a]:
                known: Callable[[Any], Any] | None = getattr(heyoka, function, None)
                if known is None:
                    raise Unusable(Message("heyoka has no function [[function]]", function=function))
                expression = known(a)
        values[number] = expression
    return [values[node.number] for node in code.outputs]


def _integrator(dynamics: Dynamics, tolerance: float, scalar: str) -> Any:
    heyoka = _heyoka()
    dtype = SCALARS[scalar].dtype
    code = dynamics.right_hand_side

    def make() -> Any:
        cells = _cells(dynamics)
        scales = {name: heyoka.par[cells + place] for place, name in enumerate(code.inputs[1:])}
        right = expressions(code, heyoka, dtype, scales)
        equations = [(heyoka.expression(name), rate / scales[name]) for name, rate in zip(scales, right, strict=True)]
        kind = float if scalar == FLOAT64 else dtype
        try:
            return heyoka.taylor_adaptive(
                equations,
                initial_state(dynamics, dtype),
                time=kind(0),
                tol=kind(tolerance),
                compact_mode=code.operations > STRAIGHT,
                high_accuracy=True,
                fp_type=kind,
            )
        except TypeError as missing:
            text = "this heyoka has no [[scalar]] arithmetic ([[why]])"
            raise Unusable(Message(text, scalar=scalar, why=missing)) from None

    return copy.deepcopy(once(dynamics, ("taylor", tolerance, scalar), make))


def _cells(dynamics: Dynamics) -> int:
    """How many of heyoka's parameters are cells; the scales stand behind them."""
    return len(dynamics.cells.values) if isinstance(dynamics, Frozen) else 0


@dataclass(frozen=True)
class Series:
    """sum_k c_k (t - start)^k, ``coefficients`` of shape (2n, order + 1); at ``reached`` it is ``arrived``."""

    start: Any
    reached: Any
    arrived: Any
    coefficients: Any

    def __call__(self, times: Any) -> Any:
        """The states (2n, m) at m times."""
        at = np.asarray(times)
        total = _sum(self.coefficients[None], at - self.start, np.zeros(len(at), int))
        return np.where(at == self.reached, self.arrived[:, None], total).astype(self.coefficients.dtype, copy=False)


def _sum(coefficients: Any, shares: Any, steps: Any) -> Any:
    """The sums (2n, m) of series (steps, 2n, order + 1) at m times, ``shares`` after the beginning of their step."""
    total = np.zeros((len(shares), coefficients.shape[1]), np.result_type(coefficients, shares))
    for column in np.ascontiguousarray(coefficients.transpose(2, 0, 1))[::-1]:
        total *= shares[:, None]
        total += column.take(steps, axis=0)
    return total.T


class TaylorRun(Stepping):
    """Steps of a ``taylor_adaptive``."""

    def __init__(self, dynamics: Dynamics, setting: Setting, scalar: str, initial: Any, at: float) -> None:
        smallest = float(np.finfo(SCALARS[scalar].dtype).eps)
        tolerance = setting.tolerance if setting.tolerance is not None else 1e-9
        self._heyoka = _heyoka()
        self._taylor = _integrator(dynamics, min(max(tolerance, smallest), 1e-2), scalar)
        outcomes = self._heyoka.taylor_outcome
        self._success, self._pauses = outcomes.success, (outcomes.success, outcomes.step_limit, outcomes.time_limit)
        self._bounded = outcomes.time_limit
        self._least = smallest
        self._dtype = SCALARS[scalar].dtype
        self._limit = setting.step_limit
        self._led = lead(dynamics, scalar)
        self._cells = dynamics.cells if isinstance(dynamics, Frozen) else None
        self.order: int = self._taylor.order
        self.work = Work()
        state = initial_state(dynamics, self._dtype) if initial is None else np.array(initial, self._dtype)
        self._rates = counted(compiled_kernel(dynamics, "right_hand_side"), self.work)
        self._kinds = variables(dynamics)
        self.restart(at, state)

    def restart(self, time: float, state: Any) -> None:
        """Go on from another state.

        heyoka begins at the nearest of its own floats.  The run is at ``time`` all the same: where it is the next part
        of one that ended there, rows may lie in between.
        """
        self._taylor.time = self._dtype(time)
        state = np.array(state, self._dtype)
        begin, states = np.array([float(time)]), state[:, None].astype(float)
        known = magnitudes(self._rates, self._kinds, begin, states)
        self._known, self._unit = known, float(known.times[0])  # of the time, where that is 0
        self._scales = self._dtype(2) ** np.ceil(np.log2(known.natural[:, 0])).astype(self._dtype)
        self._taylor.state[:] = state / self._scales
        cells = np.zeros(0) if self._cells is None else self._cells.values
        self._taylor.pars[:] = np.concatenate([cells, self._scales])[: len(self._taylor.pars)]
        self._start: Any = None
        self._until: float | None = None
        self.time, self.state = time, state

    @property
    def reached(self) -> Any:
        """Where heyoka is; a short float as a long one, which it is exactly: sums with others shall not be rounded.

        Where a step was to end at a time whose nearest short float that is, this time itself.
        """
        end = self._taylor.time
        if self._until is not None and self._dtype(self._until) == end:
            return self._until
        return float(end) if isinstance(end, np.float32) else end

    @property
    def end(self) -> Any:
        """Its state."""
        return self._taylor.state * self._scales

    def curve(self) -> Callable[[Any], Any]:
        """The series of the last step."""
        arrived = self.end
        if self._start is None:
            return Series(self.reached, self.reached, arrived, arrived[:, None])
        return Series(self._start, self.reached, arrived, self._taylor.tc * self._scales[:, None])

    def far(self, until: float) -> None:
        """Steps until ``until`` is reached or passed; the last one keeps its series."""
        taylor = self._taylor
        if taylor.time < until and self._start is None:
            self.one()
        if taylor.time < until and self._led is None:
            self._far(until)
        while taylor.time < until:
            self.one()

    def _far(self, until: float) -> None:
        """Most of a long way in heyoka's own loop, which is quicker than ours but shortens its last step."""
        taylor, work, last = self._taylor, self.work, float(self._taylor.last_h)
        goal = until - 2 * last
        while last > 0 and goal - taylor.time > FEW * last:
            if work.steps >= self._limit:
                raise work.too_many(taylor.time, self.end)
            now, before = taylor.time, np.array(taylor.state)
            at_once = min(STEPS_AT_A_TIME, self._limit - work.steps)
            outcome, shortest, _, made, *_ = taylor.propagate_until(self._dtype(goal), max_steps=at_once)
            if outcome not in self._pauses or not shortest > self._least * max(self._unit, abs(now)):
                taylor.time = now  # once more step by step, to see where it goes wrong
                taylor.state[:] = before
                return
            work.steps += int(made)
            work.evaluations += self.order * int(made)

    def first(self, at: Any) -> Any:
        """Where times lie close together, those of many steps, which heyoka's own loop makes as ``one`` does."""
        taylor, work, at = self._taylor, self.work, at[:ROWS_AT_A_TIME]
        last = 0.0 if self._start is None else self.reached - self._start
        room = min(SERIES_AT_A_TIME, self._limit - work.steps)
        gaps = np.diff(at, prepend=self.reached)
        if not gaps[0] > 0 or np.max(gaps) > 2 * last or np.sum(gaps) < FEW * last or room < FEW or self._led:
            return super().first(at)
        now, before, found = taylor.dtime, np.array(taylor.state), taylor.tc
        ends, series = [self.reached], np.empty((room, *found.shape), self._dtype)

        def kept(_: Any) -> bool:
            series[len(ends) - 1] = found
            ends.append(taylor.time)
            return ends[-1] < at[-1] and len(ends) <= room

        goal = self._dtype(ends[0] + FAR * (self._unit + abs(ends[0])))
        outcome, shortest, *_ = taylor.propagate_until(goal, callback=kept, write_tc=True)
        least = self._least * max(self._unit, abs(ends[-1]))
        if outcome != self._heyoka.taylor_outcome.cb_stop or not shortest > least:
            taylor.dtime, taylor.state[:] = now, before  # once more step by step, to see where it goes wrong
            return super().first(at)
        work.steps += len(ends) - 1
        work.evaluations += self.order * (len(ends) - 1)
        self._start, self._until = ends[-2], None
        at, begun = at[: np.searchsorted(at, ends[-1])], np.array(ends)
        steps = np.searchsorted(begun, at, side="right") - 1
        return _sum(series[: len(ends) - 1], at - begun[steps], steps) * self._scales[:, None]

    def one(self, until: float | None = None) -> None:
        """One step that keeps its series."""
        taylor, work = self._taylor, self.work
        if work.steps >= self._limit:
            raise work.too_many(taylor.time, self.end)
        now, before = taylor.time, self.end
        if self._led is not None and self._led.near(now, before):
            raise nearly_singular(now, before)
        at_rest = FAR * (self._unit + abs(now))  # no bound
        room = self._dtype(at_rest) if until is None else self._dtype(until) - now
        outcome, step = taylor.step(room, write_tc=True)
        work.steps += 1
        work.evaluations += self.order
        self._until = None
        if outcome == self._bounded and until is not None:
            taylor.time, self._until = self._dtype(until), until
        else:
            self._judge(outcome not in (self._success, self._bounded), step, now, before)
        self._start = now
        if self._led is not None:
            taylor.state[:] = self._led(taylor.time, self.end) / self._scales

    def _judge(self, failed: bool, step: Any, now: Any, before: Any) -> None:
        if failed:
            raise Breakdown(Cause.BLOW_UP, "a Taylor coefficient is no longer finite", now, before)
        if step > self._least * max(self._unit, abs(now)):
            return
        if self._known.outgrown(self.end, 0.0):
            raise Breakdown(Cause.BLOW_UP, OUTGROWN, now, before)
        raise Breakdown(Cause.STUCK, Message("step [[step]]", step=f"{float(step):.2g}"), now, before)


class Taylor:
    """``taylor``: evaluations count the Taylor coefficients, each about as dear as one right-hand side or two."""

    traits = Traits(
        name="taylor",
        title=Message("Taylor series of high order (heyoka)"),
        order=None,
        fixed=False,
        scalars=(FLOAT64, FLOAT32, EXTENDED),
        extra="heyoka",
    )

    def start(
        self, dynamics: Dynamics, setting: Setting, scalar: str = FLOAT64, initial: Any = None, at: float = 0.0
    ) -> TaylorRun:
        """A run.  Raises Unusable where heyoka is not installed or lacks the arithmetic or a function."""
        return TaylorRun(dynamics, setting, scalar, initial, at)


METHODS = (Taylor(),)
