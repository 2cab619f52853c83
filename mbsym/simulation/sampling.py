"""At which times a trajectory is shown."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import ceil, pi
from typing import Any, overload

import numpy as np

from mbsym.expressions.message import Message, joined
from mbsym.model.system import System
from mbsym.numerics.columns import most_rows
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.events.switching import rates
from mbsym.numerics.kernels.interface import FLOAT64
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.planning.choice import Choice, choose, resumed
from mbsym.numerics.planning.reduced import Reduced
from mbsym.numerics.separable import Separate, completing, held, separated
from mbsym.numerics.simulate import begins_in_equilibrium
from mbsym.simulation.request import TOLERANCE, Request
from mbsym.simulation.result import Chosen, PartMethod

#: Rows unless asked for otherwise (more of them where the motion is fast), and rows a period of the fastest motion.
SAMPLES, MOST_SAMPLES, SAMPLES_A_PERIOD = 2001, 20_001, 100


@dataclass(frozen=True)
class Grid:
    """The times k ``spacing`` for k = 0 .. ``count`` - 2, then ``end``; indexed and cut as an array of them is."""

    count: int
    spacing: float
    end: float

    def __len__(self) -> int:
        return self.count

    @overload
    def __getitem__(self, place: int) -> float: ...

    @overload
    def __getitem__(self, place: slice) -> Any: ...

    def __getitem__(self, place: int | slice) -> Any:
        if isinstance(place, slice):
            numbers = np.arange(*place.indices(self.count))
            return np.where(numbers == self.count - 1, self.end, numbers * self.spacing)
        number = range(self.count)[place]
        return self.end if number == self.count - 1 else number * self.spacing


def sample_times(request: Request, frequency: float, system: System) -> Any:
    """Times from 0 to the end, the end included: a hundred a period of the fastest oscillation, within bounds."""
    if request.earlier is not None:
        further = request.earlier.further(request.time, request.every, request.samples)
        return np.concatenate((request.earlier.times, further))
    if request.streams and request.rows is not None:
        rows = request.rows
        return Grid(rows, request.every or request.time / (rows - 1), request.time)
    if request.every is not None:
        times = np.arange(ceil(request.time / request.every * (1 - 1e-12)) + 1) * request.every
        times[-1] = request.time
        return times
    if request.samples is not None:
        return np.linspace(0.0, request.time, request.samples)
    samples = SAMPLES_A_PERIOD * frequency * request.time / (2 * pi)
    fitting = min(max(SAMPLES, int(min(samples, MOST_SAMPLES))), MOST_SAMPLES, most_rows(system))
    if request.step is None:
        return np.linspace(0.0, request.time, fitting)
    # A polynomial knows less than a method of fixed step: rows stand at whole numbers of steps, and at the end.
    steps = max(1, ceil(request.time / request.step * (1 - 1e-12)))
    apart = max(1, ceil(steps / (fitting - 1)))
    return np.append(np.arange(0, steps, apart) * request.step, request.time)


# What a request leaves open, settled before the first step: the method and the times of the samples.


#: Why any method does.
NOTHING_MOVES = Message("nothing moves, so nothing is integrated")


def chosen_for(dynamics: Dynamics, request: Request, resting: Reduced | None) -> Chosen:
    """Everything that was not asked for; ``resting`` is taken out of the integration where that is proved."""
    taken = resting if resting is not None and resting.proved else None
    moving = dynamics if taken is None else taken.dynamics
    tolerance = request.tolerance or TOLERANCE[request.arithmetic]
    parts = () if request.whole or request.model.linear else separated(moving)
    choices = [_choice(part.dynamics, request, tolerance) for part in parts] or [_choice(moving, request, tolerance)]
    method = choices[0].method
    fixed = method.traits.fixed
    if len(choices) > 1 and not fixed:
        method = Separate(moving, parts, [choice.method for choice in choices])
    setting = Setting(None if fixed else tolerance, request.step, request.step_limit, request.longest)
    if taken is not None:
        method = completing(taken, method)
    rested = request.earlier is None or np.all(request.earlier.states == request.earlier.states[:, :1])
    if (request.method == "auto" or may_change(request)) and rested and begins_in_equilibrium(dynamics):
        method, choices = held(dynamics, method), [replace(choices[0], why=NOTHING_MOVES, measured="")]
    frequency = max(choice.frequency for choice in choices)
    times = sample_times(request, frequency, dynamics.system)
    why = joined(dict.fromkeys(choice.why for choice in choices), "; ")
    measured = joined(dict.fromkeys(choice.measured for choice in choices if choice.measured), "; ")
    shares: tuple[PartMethod, ...] = ()
    if len(parts) > 1 and not fixed:
        pairs = zip(parts, choices, strict=True)
        shares = tuple(PartMethod(part.names, choice.method.traits.name) for part, choice in pairs)
    return Chosen(method, why, measured, setting, times, frequency, resting, shares)


def _choice(dynamics: Dynamics, request: Request, tolerance: float) -> Choice:
    """The method asked for, or the one that suits."""
    if request.method == "auto":
        return choose(dynamics, tolerance, request.time, request.arithmetic)
    decay, frequency = rates(dynamics)
    method = resumed(request.method) if may_change(request) else METHODS[request.method]
    return Choice(method, _asked(request), decay, frequency)


def may_change(request: Request) -> bool:
    """Whether the method may change along the run: where none was asked for, be it in the run that it goes on from."""
    earlier = request.earlier
    going_on = earlier is not None and earlier.change and earlier.method == request.method
    return request.arithmetic == FLOAT64 and (request.method == "auto" or going_on)


def _asked(request: Request) -> str:
    """Why a method that has a name in the request is there."""
    earlier = request.earlier
    again = earlier is not None and earlier.method == request.method
    return Message("as in the earlier run" if again else "as asked for")
