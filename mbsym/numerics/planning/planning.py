"""An accuracy becomes a plan: model, method, tolerance or step, and arithmetic, the cheapest that reach it.

The model is chosen first (``model_choice``); then settings are tried out on it over the whole time (``pilot``) against
a run of known error (``yardstick``).  Nothing is taken for granted: what is printed as an error was measured on this
scene, and doubled.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import Any

import numpy as np

from mbsym.algebra.failures import Failure
from mbsym.expressions.message import Message
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.events.switching import STABLE, rates
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT32, FLOAT64
from mbsym.numerics.kernels.llvm import available
from mbsym.numerics.methods.interface import Breakdown, Method, Setting, Unusable, Work, compiled_kernel
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.planning.choice import ALONG, Choice, choose
from mbsym.numerics.planning.kinds import Kind
from mbsym.numerics.planning.model_choice import PART, ModelChoice, Scene, Tried, model_chosen, model_settled, richest
from mbsym.numerics.planning.models import Model, described
from mbsym.numerics.planning.pilot import (
    ALIKE,
    KNOWN,
    MOST,
    Bench,
    Yardstick,
    following,
    places,
    searched,
    usual_slope,
    yardstick,
)
from mbsym.numerics.planning.plan import ENERGY, Accuracy, Alternative, Bound, Plan
from mbsym.numerics.planning.plan_items import GOAL, Settled, bounds_of, fits, items_of, shares_of, worth_of
from mbsym.numerics.planning.prices import cost
from mbsym.numerics.planning.reduced import Reduced, reduced
from mbsym.numerics.planning.sizes import scaled_by_another, usual_sizes
from mbsym.numerics.scenario import Scenario
from mbsym.numerics.separable import Part, Separate, completing, separated
from mbsym.numerics.trade.trial import Trial, trial_of

# Which methods are tried for an accuracy, in which arithmetic, and from which setting on.


#: Coarsest accuracies at which methods are worth a try: below, their steps are too many.
COARSE_ONLY = {"rk45": 1e-8, "rk4": 1e-5}

#: Numbers of 24 bits are tried for errors down to this.
SINGLE = 3e-6

#: Taylor series are compiled for fine accuracies, and for equations of moderate length.
TAYLOR_FROM, TAYLOR_LONG = 1e-8, 3_000

#: Methods that are another one in slower clothes.
DUPLICATES = ("scipy-rk45", "scipy-dop853")


#: A method in an arithmetic.
Contender = tuple[Method, str]


def contenders(
    dynamics: Dynamics, model: Model, target: float, stiff: bool, rows_are_many: bool
) -> Iterator[Contender]:
    """The most promising first.

    A step of one length ends at every row: such a method is tried where rows are many anyway.  Implicit midpoints are
    not: no scene was found where they reach an error over the whole time for less than explicit steps of high order.
    Numbers of 24 bits are not, where states are led back: rounding takes them off constraints and lengths of 1, and
    energies with them.
    """
    names = ["dop853"]
    if stiff:
        names = [name for name, method in METHODS.items() if method.traits.implicit and not method.traits.fixed]
        names += ["dop853", "rk45"]
    else:
        names += ["rk45", "taylor", *(["rk4"] if rows_are_many else [])]
    for scalar in (FLOAT64, FLOAT32):
        if scalar == FLOAT32 and not (target >= SINGLE and available(FLOAT32) and dynamics.correction is None):
            continue
        for name in names:
            method = METHODS.get(name)
            if method is None or name in DUPLICATES or scalar not in method.traits.scalars:
                continue
            if target < COARSE_ONLY.get(name, 0.0):
                continue
            taylor_pays = target <= TAYLOR_FROM and dynamics.right_hand_side.operations <= TAYLOR_LONG
            if name == "taylor" and (scalar == FLOAT32 or model.linear or not taylor_pays):
                continue
            yield method, scalar


def in_more_digits() -> Iterator[Contender]:
    """Where float64 does not do."""
    if available(EXTENDED):
        for name in ("dop853", "taylor"):
            if name in METHODS and EXTENDED in METHODS[name].traits.scalars:
                yield METHODS[name], EXTENDED


def first_setting(contender: Contender, tolerance: float, best: Trial | None, end: float, spacing: float) -> Setting:
    """Where the search begins: the tolerance that did for another, or steps as many as its evaluations pay for.

    No step is longer than the ``spacing`` of the rows.
    """
    method, scalar = contender
    if not method.traits.fixed:
        start = best.setting.tolerance if best is not None and best.setting.tolerance else tolerance
        return Setting(tolerance=min(max(start, method.traits.finest(scalar)), 1e-3))
    evaluations = best.work.evaluations if best is not None else 4_000
    return Setting(step=min(float(f"{end / max(10, evaluations / 4):.1e}"), spacing))


def alternatives(
    bench: Bench, chosen: Trial, tried: Sequence[Tried], taken: Tried, accuracy: Accuracy, goal: float
) -> tuple[Alternative, Alternative]:
    """(one digit more, one digit less), each measured as the plan was, on its model."""
    more, less = (_other(bench, chosen, tried, taken, accuracy.finest, goal, factor) for factor in (0.1, 10.0))
    return more, less


def _other(
    bench: Bench, chosen: Trial, tried: Sequence[Tried], taken: Tried, target: float, goal: float, factor: float
) -> Alternative:
    target_ratio = goal * factor
    model = _model_of(tried, factor)
    name = "" if model.model == taken.model else model.model.label
    start = following(chosen, target_ratio, usual_slope(chosen.method, chosen.setting), bench.spacing)
    if start is not None:
        _searched(bench, chosen.method, chosen.scalar, start, target_ratio, inf)
    able = [trial for trial in bench.trials if trial.error <= target_ratio]
    if not able:
        needed = chosen.scalar == FLOAT64 and EXTENDED in chosen.method.traits.scalars
        text = "[[scalar]] has no finer tolerance; extended arithmetic is needed"
        why = Message(text if needed else "[[scalar]] has no finer tolerance", scalar=chosen.scalar)
        return Alternative(target * factor, why=why, model=name)
    least = min(able, key=lambda trial: trial.cost)
    times = least.cost / chosen.cost * model.operations / max(1, taken.operations)
    return Alternative(target * factor, least.label, chosen.seconds * times, name, times=times)


def _model_of(tried: Sequence[Tried], factor: float) -> Tried:
    """The cheapest model that would be good enough; the faithful one has no error."""
    return min(
        (candidate for candidate in tried if candidate.ratio <= PART * factor),
        key=lambda candidate: candidate.operations,
    )


#: Methods whose steps end at every row are judged where there are so many rows at least.
GRID = 1_001

#: The outline of the motion, from which sizes are taken.
COARSE = 1e-6

#: Another method is looked at while trying costs less than this, or so many times the best run.
EFFORT, TIMES_BEST = 3.0, 20.0

#: Steps of the explicit method, and what the dearest run of it may cost that is to measure others on a stiff scene.
EXPLICIT, DOP853_STAGES, MOST_TO_MEASURE = "dop853", 12, 10.0

#: A plan whose bound comes out above the target is made again with a smaller goal, so many times.
REPEATS = 3


@dataclass(frozen=True)
class Pins:
    """What the user has settled: these are measured, not chosen."""

    model: Model | None = None
    method: str | None = None
    tolerance: float | None = None
    step: float | None = None
    scalar: str | None = None
    whole: bool = False
    longest: float | None = None

    @property
    def kinds(self) -> frozenset[str]:
        """The kinds of items that it settles."""
        fineness = None if self.setting is None else self.setting
        pinned = {Kind.METHOD: self.method, Kind.FINENESS: fineness, Kind.SCALAR: self.scalar, Kind.GRAVITY: self.model}
        pinned |= {Kind.LINEARITY: self.model, Kind.LEFT_OUT: self.model}
        together = (Kind.RESTING, Kind.PARTS, Kind.WELDED) if self.whole else ()
        return frozenset((*(kind for kind, value in pinned.items() if value is not None), *together))

    @property
    def setting(self) -> Setting | None:
        if self.tolerance is None and self.step is None:
            return None
        return Setting(self.tolerance, self.step)


#: Nothing is settled.
FREE = Pins()


def planned(
    scenario: Scenario,
    accuracy: Accuracy,
    times: Any,
    pins: Pins = FREE,
    watch: Callable[[str], None] = lambda text: None,
) -> Plan:
    """The plan for a run from 0 to ``times[-1]`` with rows at ``times``.

    Raises Breakdown where the motion does not come to the end, Failure where the equations have no program.
    """
    started = time.perf_counter()
    times = np.asarray(times, dtype=float)
    end = float(times[-1])
    watch("the motion in outline")
    scene, choice, remark = outlined(scenario, accuracy, times)
    model = _model(scene, pins, watch)
    resting = None if pins.whole or model.taken.model.linear else _resting(model.dynamics)
    worth, goal, too_simple = worth_of(scene, model.taken)
    room = goal / GOAL
    complete, parts = _completing(model.dynamics, resting, pins, model.taken.model.linear)
    bench = Bench(model.dynamics, scene.times, times, worth, complete, scene.scale, longest=pins.longest)
    watch("a run to measure by")
    first = _first_tolerance(scene)
    stick = bench.stick = _measured_by(bench, choice, first, goal)
    for _ in range(REPEATS):
        trial = _settled(bench, stick, model.taken.model, choice, goal, pins, watch, len(times) >= GRID)
        bounds = bounds_of(scene, accuracy, shares_of(bench, trial, stick, model))
        over = _over(bounds)
        if over <= 1 or too_simple or pins.setting is not None or trial.error > goal:
            break
        goal *= 0.7 / over
    if pins.setting is None:
        for cheaper in _cheaper(bench, trial, stick.known, room, pins):
            others = bounds_of(scene, accuracy, shares_of(bench, cheaper, stick, model))
            if _over(others) <= 1 or too_simple:
                trial, bounds = cheaper, others
                break
    worst = max(bounds, key=lambda bound: bound.total / bound.target)
    enough = fits(trial, stick.known, room) and (_over(bounds) <= 1 or bool(too_simple))
    settled = Settled(scene, model, choice, resting, parts, bench, stick, trial, pins.kinds, enough, room, worst)
    items, measured_to = items_of(settled), settled.measured_to
    more, less = None, None
    if stick.parted == inf:
        more, less = alternatives(bench, trial, model.tried, model.taken, accuracy, goal)
    return Plan(
        accuracy,
        end,
        items,
        bounds,
        model.taken.model,
        trial.method.traits.name,
        trial.setting,
        trial.scalar,
        trial.seconds,
        time.perf_counter() - started,
        more,
        less,
        tuple(text for text in (remark, too_simple) if text),
        measured_to=measured_to,
        parted=stick.parted,
    )


def _over(bounds: Sequence[Bound]) -> float:
    """The largest bound as a part of what is tolerable."""
    return max(bound.total / bound.target for bound in bounds)


def _cheaper(bench: Bench, chosen: Trial, known: float, room: float, pins: Pins) -> list[Trial]:
    """What the search passed by, aiming at less than is tolerable: good enough, and clearly cheaper than ``chosen``.

    A few, the cheapest first; where ``chosen`` is not good enough, whatever is.
    """
    least = chosen.cost / ALIKE if fits(chosen, known, room) else inf
    able = [trial for trial in bench.trials if trial.cost < least and fits(trial, known, room)]
    allowed = [trial for trial in able if pins.scalar in (None, trial.scalar)]
    return sorted(allowed, key=lambda affordable: affordable.cost)[:REPEATS]


# --- the scene ---


def outlined(scenario: Scenario, accuracy: Accuracy, times: Any) -> tuple[Scene, Choice, str]:
    """The most faithful model with a coarse run, which says what quantities are measured by."""
    model, rich, remark = richest(scenario)
    end = float(times[-1])
    choice = choose(rich, COARSE, end)
    compared = times[:: -(-len(times) // MOST)] if len(times) > MOST else times
    names = (*rich.system.coordinates, *rich.system.velocities, ENERGY)
    targets = accuracy.targets(names)
    for tolerance in (COARSE, COARSE**2):  # what ends a coarse run, as a switch that it passes, need not end the motion
        try:
            step_times = places(choice.method, rich, Setting(tolerance), end)
            grid = np.union1d(np.append(compared, end), step_times)
            run = trial_of(choice.method, rich, Setting(tolerance), grid).whole()
            break
        except Breakdown:
            if tolerance < COARSE:
                raise
    states = run.states
    stiff = [change.time for change in run.work.changes if METHODS[change.method].traits.implicit]
    if stiff:
        at = np.searchsorted(grid, stiff)
        fastest = max(rates(rich, states[:, k], float(grid[k]))[0] for k in at[:REPEATS])
        choice = replace(choice, turned=True, decay=max(choice.decay, fastest))
    kinetic = compiled_kernel(rich, "relative_energy")(np.vstack([grid, states]))[1]
    largest = float(np.max(np.abs(kinetic[np.isfinite(kinetic)]), initial=0.0))
    try:
        usual = usual_sizes(rich, grid, states, largest)
    except Failure:
        usual = np.zeros(len(states))
    scale = np.append(scaled_by_another(rich, grid, states, usual), largest or 1.0)
    return Scene(scenario, rich, model, grid, states, scale, targets, choice.method), choice, remark


def _model(scene: Scene, pins: Pins, watch: Callable[[str], None]) -> ModelChoice:
    """Chosen; or as settled by the user."""
    if pins.model is None:
        return model_chosen(scene, watch)
    order = pins.model.gravity or described(scene.scenario).gravity
    return model_settled(scene, replace(pins.model, gravity=order))


def _resting(dynamics: Dynamics) -> Reduced | None:
    reduction = reduced(dynamics)
    return reduction if reduction is not None and reduction.proved else None


def _completing(
    dynamics: Dynamics, resting: Reduced | None, pins: Pins, linear: bool
) -> tuple[Callable[[Method], Method], tuple[Part, ...]]:
    """How a method is made of one for the coordinates that move, part by part; and the parts, if there are several."""
    moving = dynamics if resting is None else resting.dynamics
    parts = () if pins.whole or linear else separated(moving)
    several = parts if len(parts) > 1 else ()

    def complete(method: Method) -> Method:
        inner = Separate(moving, several, [method] * len(several)) if several and not method.traits.fixed else method
        return inner if resting is None else completing(resting, inner)

    return complete, several


def _first_tolerance(scene: Scene) -> float:
    """About the tolerance of the run that is looked for."""
    return float(f"{min(1e-4, max(0.1 * float(np.min(scene.targets)), 1e-14)):.0e}")


def _base(choice: Choice) -> Method:
    if choice.method.traits.implicit:
        return choice.method
    return METHODS[ALONG if choice.turned else EXPLICIT]


def _measured_by(bench: Bench, choice: Choice, first: float, goal: float) -> Yardstick:
    """A run of known error; of a stiff scene one in steps that are explicit and many, where no other is good enough.

    Implicit methods compute in float64, and their tolerances end where rounding begins: an error that is theirs is
    not to be held against the others.
    """
    stick = yardstick(bench, _base(choice), first, goal)
    if not choice.stiff or stick.known <= KNOWN * goal:
        return stick
    most = int(MOST_TO_MEASURE / cost(bench.dynamics, EXPLICIT, EXTENDED, Work(evaluations=DOP853_STAGES, steps=1)))
    if not choice.turned and choice.decay * float(bench.times[-1]) / STABLE > most:
        return stick
    try:
        return min(stick, yardstick(bench, METHODS[EXPLICIT], first, goal, most), key=lambda candidate: candidate.known)
    except (Breakdown, Unusable):
        return stick


# --- the setting ---


def _settled(
    bench: Bench,
    stick: Yardstick,
    model: Model,
    choice: Choice,
    goal: float,
    pins: Pins,
    watch: Callable[[str], None],
    many: bool,
) -> Trial:
    """The cheapest setting that is good enough, else the best that there is.

    A method that costs more than what judges it without being good enough is given up; where what judges is itself
    lost before the end, one setting is tried, for none can be told to be good enough.

    Raises Breakdown, Unusable.
    """
    if pins.setting is not None:
        name = pins.method or choice.method.traits.name
        return bench.run(METHODS[name], pins.scalar or FLOAT64, pins.setting, often=True)
    best: Trial | None = None
    begun = len(bench.trials)
    stiff, lost = choice.stiff, stick.parted < inf
    for method, scalar in _allowed(bench, model, pins, stiff, many):
        spent = sum(trial.cost for trial in bench.trials[begun:])
        if best is not None and spent > max(EFFORT, TIMES_BEST * best.cost):
            break
        watch(f"{method.traits.name}, {scalar}")
        if best is None and scalar == FLOAT32:
            break  # what float64 does not reach, fewer digits will not
        limit = 0.0 if lost else stick.trial.cost if best is None else best.cost
        setting = first_setting((method, scalar), stick.start, best, float(bench.times[-1]), bench.spacing)
        trial = _searched(bench, method, scalar, setting, goal, limit)
        if trial is not None and (best is None or trial.cost < best.cost):
            best = trial
        if lost and bench.trials:
            break
    if best is None and pins.scalar is None and not lost:
        for method, scalar in in_more_digits():
            if pins.method in (None, method.traits.name):
                watch(f"{method.traits.name}, {scalar}")
                best = best or _searched(bench, method, scalar, Setting(stick.start), goal, inf)
    if best is None:
        if not bench.trials:
            raise Unusable("no method comes to the end of this motion")
        least = min(trial.error for trial in bench.trials)
        best = min((trial for trial in bench.trials if trial.error <= 2 * least), key=lambda trial: trial.cost)
    return best


def _allowed(bench: Bench, model: Model, pins: Pins, stiff: bool, many: bool) -> list[Contender]:
    if pins.method is not None:
        scalars = [pins.scalar] if pins.scalar is not None else [FLOAT64, FLOAT32]
        method = METHODS[pins.method]
        return [(method, scalar) for scalar in scalars if scalar in method.traits.scalars]
    if pins.scalar == EXTENDED:
        return list(in_more_digits())
    candidates = contenders(bench.dynamics, model, bench.finest_target, stiff, many)
    return [(method, scalar) for method, scalar in candidates if pins.scalar in (None, scalar)]


def _searched(bench: Bench, method: Method, scalar: str, setting: Setting, goal: float, limit: float) -> Trial | None:
    try:
        return searched(bench, method, scalar, setting, goal, limit)
    except (Unusable, Failure):
        return None
