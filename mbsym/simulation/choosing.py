"""What a request leaves open, settled before the first step: the method and the times of the samples."""

from __future__ import annotations

from mbsym.expressions.message import Message, joined
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.events.switching import rates
from mbsym.numerics.kernels.interface import FLOAT64
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.planning.choice import Choice, choose, resumed
from mbsym.numerics.planning.reduced import Reduced
from mbsym.numerics.separable import Separate, separated
from mbsym.simulation.request import TOLERANCE, Request
from mbsym.simulation.result import Chosen, PartMethod
from mbsym.simulation.sampling import sample_times


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
        method = taken.method(method)
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
