"""What a request leaves open, settled before the first step: the method and the times of the samples."""

from __future__ import annotations

from mbsym.numerics.choice import choose, rates
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.reduced import Reduced
from mbsym.simulation.request import TOLERANCE, Request
from mbsym.simulation.result import Chosen
from mbsym.simulation.sampling import sample_times


def chosen_for(dynamics: Dynamics, request: Request, resting: Reduced | None) -> Chosen:
    """Everything that was not asked for; ``resting`` is taken out of the integration where that is proved."""
    taken = resting if resting is not None and resting.proved else None
    whole = dynamics if taken is None else taken.dynamics
    tolerance = request.tolerance or TOLERANCE[request.arithmetic]
    if request.method == "auto":
        choice = choose(whole, tolerance, request.time, request.arithmetic)
        method, why, measured, frequency = choice.method, choice.why, choice.measured, choice.frequency
    else:
        method, why, measured, frequency = METHODS[request.method], "as asked for", "", rates(whole)[1]
    setting = Setting(None if method.traits.fixed else tolerance, request.step, request.step_limit)
    if taken is not None:
        method = taken.method(method)
    times = sample_times(request, frequency, dynamics.system)
    return Chosen(method, why, measured, setting, times, frequency, resting)
