"""Which method to integrate with: ``choose`` looks at the system, and measures where that does not settle it.

An explicit method must take steps shorter than about ``STABLE`` / |Re lambda| for every eigenvalue lambda of the
Jacobian whose motion dies out (Hairer & Wanner, Solving Ordinary Differential Equations II, IV.2), however smooth the
solution is.  Where that bound asks for few steps, the compiled explicit method of high order is taken without further
ado; where it asks for many, a short stretch is integrated both ways and the one of less counted work is taken.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from mbsym.expressions.message import Message
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.events.switching import STABLE, STIFF, Switching, rates
from mbsym.numerics.kernels.interface import FLOAT64
from mbsym.numerics.methods.interface import Breakdown, Cause, Method, Setting, Unusable
from mbsym.numerics.methods.landing import Landing
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.planning.prices import cost

#: So many steps of a compiled explicit method are soon done: no need to look for anything better.
FEW_STEPS = 100_000

#: So many steps are taken for other reasons anyway.
OF_NO_ACCOUNT = 100

#: Steps of the trial of the explicit method, and what the trial of each implicit one may cost.
TRIAL_STEPS, TRIAL_COST = 2_000, 0.3

#: Preferred explicit methods, implicit ones to try on stiff systems, and the one that a run changes to on its way.
EXPLICIT, IMPLICIT, ALONG = ("dop853", "scipy-dop853", "rk45"), ("rodas5p", "radau", "lsoda"), "rodas5p"


@dataclass(frozen=True)
class Choice:
    """A method and why.

    ``decay`` is the fastest rate at which a motion dies out and ``frequency`` the greatest angular frequency, both from
    the Jacobian at the initial state; ``turned`` where the motion is known to become stiff on the way: ``decay`` is
    then the fastest one where it does.  ``measured`` says what trials came to, if there were any.  They count work
    (``mbsym.numerics.planning.prices``), so that neither the machine nor what else runs decides anything.
    """

    method: Method
    why: str
    decay: float
    frequency: float
    measured: str = ""
    turned: bool = False

    @property
    def stiff(self) -> bool:
        """Whether stability rules explicit steps at first or on the way."""
        return self.turned or self.method.traits.implicit


def choose(dynamics: Dynamics, tolerance: float, time_: float, scalar: str = FLOAT64) -> Choice:
    """The method for ``time_`` units of time at a tolerance, by the fastest decay and, if need be, by trials.

    That is how the run begins: it changes between this and an implicit method when the motion becomes stiff on the way.
    """
    first = _at_first(dynamics, tolerance, time_, scalar)
    if scalar != FLOAT64:
        return first
    # It is between switches of the rates that the method may change.
    return replace(first, method=resumed(first.method.traits.name))


def resumed(name: str) -> Method:
    """What goes on from where a run of ``choose`` was, by the method ``name``; any other method is just that one."""
    explicit, implicit = METHODS[EXPLICIT[0]], METHODS[ALONG]
    if METHODS[name] not in (explicit, implicit):
        return METHODS[name]
    assert isinstance(explicit, Landing)
    assert isinstance(implicit, Landing)
    return Landing(Switching(explicit.inner, implicit.inner, METHODS[name] is implicit))


def _at_first(dynamics: Dynamics, tolerance: float, time_: float, scalar: str) -> Choice:
    """The method for the stretch that begins with the initial state."""
    explicit = next(METHODS[name] for name in EXPLICIT if name in METHODS)
    decay, frequency = rates(dynamics)
    steps = decay * time_ / STABLE
    # Where the oscillations are as fast as that, they need the short steps themselves.
    if decay <= STIFF * frequency or steps <= OF_NO_ACCOUNT:
        why = Message("explicit, of high order: nothing stiff in the initial state")
        return Choice(explicit, why, decay, frequency)
    if steps <= FEW_STEPS:
        text = "explicit, of high order: motions die out at rates up to [[rate]], about [[steps]] steps"
        why = Message(text, rate=f"{decay:.3g}", steps=f"{steps:.2g}")
        return Choice(explicit, why, decay, frequency)
    if scalar != FLOAT64:
        why = Message("the implicit methods do not compute in [[scalar]]", scalar=scalar)
        return Choice(explicit, why, decay, frequency)
    setting = Setting(tolerance=tolerance)
    best, least = explicit, _predicted(dynamics, explicit, setting, time_, steps)
    first = least
    for name in IMPLICIT[: 2 if dynamics.correction is not None else None]:
        trial_cost = _trial(dynamics, METHODS[name], setting, time_) if name in METHODS else None
        if trial_cost is not None and trial_cost < least:
            best, least = METHODS[name], trial_cost
        if trial_cost is not None and METHODS[name].traits.compiled:
            break  # what is not compiled costs more, its trial, too
    if best is explicit:
        text = "motions die out at rates up to [[rate]], yet explicit steps cost less here, by counted work"
        measured = Message("about [[cost]] s by the counted work of a short trial", cost=f"{first:.2g}")
        return Choice(best, Message(text, rate=f"{decay:.3g}"), decay, frequency, measured)
    text = "stiff: motions die out at rates up to [[rate]], which would cost an explicit method [[steps]] steps"
    why = Message(text, rate=f"{decay:.3g}", steps=f"{steps:.2g}")
    text = "about [[cost]] s instead of [[other]] s, by the counted work of short trials"
    return Choice(best, why, decay, frequency, Message(text, cost=f"{least:.2g}", other=f"{first:.2g}"))


def _predicted(dynamics: Dynamics, method: Method, setting: Setting, time_: float, steps: float) -> float:
    """What so many steps cost, judged by a trial of a few."""
    run = None
    try:
        run = method.start(dynamics, replace(setting, step_limit=TRIAL_STEPS))
        run.advance(time_)
    except (Breakdown, Unusable):
        pass
    if run is None or not run.work.steps:
        return float("inf")
    spent = cost(dynamics, method.traits.name, FLOAT64, run.work)
    return spent / run.work.steps * max(steps, run.work.steps)


def _trial(dynamics: Dynamics, method: Method, setting: Setting, time_: float) -> float | None:
    """What the whole time costs, judged by as much as a short trial gets done; None where it fails."""
    try:
        run = method.start(dynamics, replace(setting, step_limit=50_000))
        reached = time_ / 4096
        while cost(dynamics, method.traits.name, FLOAT64, run.work) < TRIAL_COST:
            run.advance(reached)
            if reached >= time_:
                break
            reached = min(2 * reached, time_)
    except Unusable:
        return None
    except Breakdown as breakdown:
        if breakdown.kind != Cause.STEP_LIMIT or breakdown.time <= 0:
            return None
        reached = breakdown.time
    return cost(dynamics, method.traits.name, FLOAT64, run.work) * time_ / reached
