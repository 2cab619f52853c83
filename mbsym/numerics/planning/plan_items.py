"""The items of a plan: what was chosen of each kind, what was refused, and why."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import inf, isfinite
from typing import Any

import numpy as np

from mbsym.algebra.certainty import Certainty
from mbsym.expressions.message import Message, joined
from mbsym.model.loads import GRAVITY_ORDERS
from mbsym.model.welded import lumped
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT32, FLOAT64
from mbsym.numerics.kernels.llvm import available
from mbsym.numerics.methods.interface import Breakdown, Unusable
from mbsym.numerics.planning.choice import Choice
from mbsym.numerics.planning.kinds import Kind
from mbsym.numerics.planning.model_choice import PART, ModelChoice, Scene, Tried
from mbsym.numerics.planning.models import Model, described, parted
from mbsym.numerics.planning.pilot import ALIKE, WASTEFUL, Bench, Yardstick
from mbsym.numerics.planning.plan import (
    ARITHMETIC,
    ENERGY,
    INTEGRATION,
    MODEL,
    SECONDS,
    Accuracy,
    Bound,
    Item,
    Refused,
    Share,
)
from mbsym.numerics.planning.reduced import Reduced
from mbsym.numerics.separable import Part
from mbsym.numerics.trade.trial import Trial

# What a setting on a model is worth: the shares of its error, and the bounds that they add up to.


#: What is measured is doubled, what is estimated of a model and confirmed is raised by a quarter.
DOUBLED, RAISED = 2.0, 1.25

#: The part of what the model leaves that the measured error may take, before it is doubled.
GOAL = 0.8 / DOUBLED

#: The other arithmetic is tried where the run costs less (``mbsym.numerics.planning.prices``).
CHEAP = 5.0


#: (name, errors (2n + 1,), how surely they are known; None: a part of another share), in the order in which they add.
Shares = tuple[tuple[str, Any, Certainty | None], ...]


def worth_of(scene: Scene, taken: Tried) -> tuple[Any, float, str]:
    """What the integration may be wrong by, (2n + 1,), the part of it to be aimed at, and a remark.

    No tolerance is finer than what the model is worth: where its error is beyond the target, a tenth of that error is
    fine enough.
    """
    errors = RAISED * taken.errors
    targeted = np.isfinite(scene.targets)
    beyond = targeted & ~(errors < 0.9 * scene.targets)
    if not np.any(beyond):
        room = 1 - float(np.max(errors[targeted] / scene.targets[targeted], initial=0.0))
        return scene.targets, GOAL * room, ""
    known = np.where(np.isfinite(errors), errors, 1.0)
    worth = np.where(beyond, np.maximum(scene.targets, 0.1 * known), scene.targets)
    worst = float(np.max(known[beyond]))
    text = f"this model is {worst:.1e} wrong, however it is integrated: nothing finer than that is worth its time"
    return worth, GOAL, text


def fits(trial: Trial, known: float, room: float) -> bool:
    """Whether the error of a trial, doubled, is within ``room``; with ``known``, that of what it was measured by."""
    return DOUBLED * (trial.error - known) + known <= room


def shares_of(bench: Bench, trial: Trial, stick: Yardstick, model: ModelChoice) -> Shares:
    """(name, errors (2n + 1,), how) of model, integration, arithmetic."""
    how = Certainty.PROVED if not np.any(model.taken.errors) else model.taken.how
    targeted = np.isfinite(bench.targets)
    known = np.where(targeted, stick.known * np.where(targeted, bench.targets, 1.0), 0.0)
    measured = DOUBLED * trial.errors + known
    arithmetic, way = np.zeros_like(measured), None  # a part of the integration's share
    other = {FLOAT64: EXTENDED, FLOAT32: FLOAT64}.get(trial.scalar)
    cheap = trial.cost < CHEAP and other is not None and isfinite(stick.known)
    if cheap and other in trial.method.traits.scalars and available(str(other)):
        try:
            twin = bench.run(trial.method, str(other), trial.setting)
            _, apart = bench.compared(_again(bench, trial), twin.states)
            # Where stability rules the steps of two runs, these go their own ways, and so do their errors: runs that
            # differ by about what either of them errs by tell nothing of rounding.
            if not np.any(targeted & (apart > twin.errors / 2) & (twin.errors > trial.errors / 2)):
                # What was measured has both in it, and they may cancel: it is shared out as each alone counts.
                both = apart + twin.errors
                counted = (both > 0) & np.isfinite(both)
                arithmetic = measured * np.divide(apart, both, out=np.zeros_like(both), where=counted)
                measured, way = measured - arithmetic, Certainty.MEASURED
        except (Breakdown, Unusable):
            pass
    return (
        (MODEL, RAISED * model.taken.errors, how),
        (INTEGRATION, measured, Certainty.MEASURED if isfinite(stick.known) else Certainty.ESTIMATED),
        (ARITHMETIC, arithmetic, way),
    )


def _again(bench: Bench, trial: Trial) -> Any:
    """The quantities of a setting that was tried: runs are repeatable."""
    if trial.states is not None:
        return trial.states
    return bench.run(trial.method, trial.scalar, trial.setting).states


def bounds_of(scene: Scene, accuracy: Accuracy, shares: Shares) -> tuple[Bound, ...]:
    """A bound for every quantity that was named, and for the worst of the others."""
    names = (*scene.rich.system.coordinates, *scene.rich.system.velocities, ENERGY)
    total = sum(errors for _, errors, _ in shares)
    bounds: list[tuple[float, Bound]] = []
    others: list[tuple[float, Bound]] = []
    for place, name in enumerate(names):
        target = float(scene.targets[place])
        if not isfinite(target):
            continue
        bound = Bound(name, tuple(Share(kind, float(x[place]), how) for kind, x, how in shares), target)
        (bounds if name in accuracy.named else others).append((float(total[place]) / target, bound))
    worst = [max(others, key=lambda item: item[0])[1]] if others else []
    return (*worst, *(bound for _, bound in bounds))


#: Trials that differ from what they are measured by by less than so many times its own error are not told from it.
APART = 3.0

#: Arithmetic by its digits.
DIGITS = (FLOAT32, FLOAT64, EXTENDED)


@dataclass(frozen=True)
class Settled:
    """Everything that was found out; ``pinned`` names the kinds that the user settled.

    ``enough``: the error that was measured, doubled, is within ``room``, the part of what is tolerable that the model
    leaves, and so is every bound, of which ``bound`` is the one with least room.
    """

    scene: Scene
    model: ModelChoice
    choice: Choice
    resting: Reduced | None
    parts: tuple[Part, ...]
    bench: Bench
    stick: Yardstick
    trial: Trial
    pinned: frozenset[str]
    enough: bool
    room: float
    bound: Bound

    @property
    def measured_to(self) -> float | None:
        """How well the run is known that measured, where that is all by which the best trial differs from it."""
        known = self.stick.known
        least = min((trial.error - known for trial in self.bench.trials), default=inf)
        return None if self.enough or least > APART * known else known * self.bench.finest_target

    @property
    def fitting(self) -> list[Trial]:
        """Whatever was tried and whose measured error, doubled, is small enough."""
        return [trial for trial in self.bench.trials if fits(trial, self.stick.known, self.room)]


def items_of(settled: Settled) -> tuple[Item, ...]:
    """In the order of the choices."""
    return (*_models(settled), *_resting(settled), *_parts(settled), *_welded(settled), *_settings(settled))


def _models(settled: Settled) -> Iterator[Item]:
    scene, model = settled.scene, settled.model
    taken = model.taken
    described_model = described(scene.scenario)
    why = Message("as asked for") if Kind.GRAVITY in settled.pinned else _why_model(model)
    if described_model.gravity is not None:
        refused = tuple(
            _refused(settled, candidate) for candidate in model.tried if _other_order(candidate.model, taken.model)
        )
        richer = taken.model.gravity is not None and GRAVITY_ORDERS.index(taken.model.gravity) > GRAVITY_ORDERS.index(
            described_model.gravity
        )
        if richer:
            why = Message("[[why]]; richer than described (order [[order]])", why=why, order=described_model.gravity)
        alone = not (taken.model.linear or taken.model.without)
        error = _worst(settled, taken) if alone else None
        yield Item(Kind.GRAVITY, (), str(taken.model.gravity), why, error, taken.how, taken.operations, refused=refused)
    lines = [candidate for candidate in model.tried if candidate.model.linear]
    if lines or taken.model.linear:
        chosen = Message("linear" if taken.model.linear else "nonlinear")
        refused = tuple(_refused(settled, line) for line in lines if line.model != taken.model)
        error = _worst(settled, taken) if taken.model.linear else None
        why = Message("as asked for") if Kind.LINEARITY in settled.pinned else _why_model(model)
        yield Item(Kind.LINEARITY, (), chosen, why, error, taken.how, taken.operations, refused=refused)
    if taken.model.without:
        why = Message("as asked for" if Kind.LEFT_OUT in settled.pinned else "this motion does not feel them")
        bodies, others = parted(scene.scenario, taken.model)
        left = ", ".join(taken.model.without)
        if bodies:
            gone = Message("without [[names]]", names=left)
            yield Item(Kind.MASSES, bodies, gone, why, _worst(settled, taken), taken.how, taken.operations)
        if others:
            error = None if bodies else _worst(settled, taken)  # that of all together stands with the bodies
            yield Item(Kind.LEFT_OUT, others, ", ".join(others), why, error, taken.how, taken.operations)


def _why_model(model: ModelChoice) -> str:
    if model.taken.model == model.faithful:
        return Message("nothing simpler is good enough" if len(model.tried) > 1 else "nothing simpler is known")
    able = [
        candidate.operations
        for candidate in model.tried
        if candidate.ratio <= PART and candidate.how is not Certainty.UNDECIDED
    ]
    fewest = model.taken.operations <= min(able, default=0)
    return Message(
        "good enough, with the fewest operations of those tried" if fewest else "good enough, with fewer operations"
    )


def _other_order(model: Model, taken: Model) -> bool:
    return model.gravity != taken.gravity and not model.linear and not model.without


def _refused(settled: Settled, candidate: Tried) -> Refused:
    word = "linear" if candidate.model.linear else candidate.model.label
    return Refused(word, _told(settled, candidate), candidate.operations, candidate.why)


def _resting(settled: Settled) -> Iterator[Item]:
    reduced = settled.resting
    if reduced is not None:
        before, after = reduced.operations
        why = Message("[[after]] operations a right-hand side instead of [[before]]", after=after, before=before)
        yield Item(Kind.RESTING, reduced.names, Message("not integrated"), why, 0.0, Certainty.PROVED, after)


def _parts(settled: Settled) -> Iterator[Item]:
    if settled.parts and not settled.trial.method.traits.fixed:
        names = tuple(" ".join(part.names) for part in settled.parts)
        why = Message("nothing links them in these equations")
        yield Item(Kind.PARTS, names, Message("each by itself"), why, 0.0, Certainty.PROVED)


def _welded(settled: Settled) -> Iterator[Item]:
    carriers = lumped(settled.scene.scenario.system)
    if carriers and Kind.WELDED not in settled.pinned and not settled.model.taken.model.linear:
        carried = Message("one with [[bodies]]", bodies=", ".join(dict.fromkeys(carriers.values())))
        why = Message("no coordinate moves them against it")
        yield Item(Kind.WELDED, tuple(carriers), carried, why, 0.0, Certainty.PROVED)


def _settings(settled: Settled) -> Iterator[Item]:
    trial, pinned = settled.trial, settled.pinned
    name = trial.method.traits.name
    others = _cheapest_others(settled)
    chosen = _why_method(settled, bool(others)) if settled.enough else _closest(settled)
    why = Message("as asked for") if Kind.METHOD in pinned else chosen
    if Kind.FINENESS in pinned:
        why = _fitting(trial)
    if settled.choice.stiff and Kind.METHOD not in pinned:
        why = joined(
            [why, Message("motions die out at rates up to [[rate]]", rate=f"{settled.choice.decay:.3g}")], "; "
        )
    yield Item(
        Kind.METHOD, (trial.method.traits.title,), name, why, None, Certainty.MEASURED, trial.seconds, SECONDS, others
    )
    why = Message("as asked for") if Kind.FINENESS in pinned else _why_fineness(settled)
    word = Message("tolerance [[tolerance]]", tolerance=f"{trial.fineness:g}")
    if trial.setting.step is not None:
        word = Message("step [[step]]", step=f"{trial.fineness:g}")
    yield Item(Kind.FINENESS, (), word, why, None, Certainty.MEASURED, trial.seconds, SECONDS)
    refused = tuple(_other_scalars(settled))
    why = Message("as asked for") if Kind.SCALAR in pinned else _why_scalar(settled)
    yield Item(Kind.SCALAR, (), trial.scalar, why, None, Certainty.MEASURED, trial.seconds, SECONDS, refused)
    yield Item(Kind.KERNEL, (), "scalar", Message("one motion: nothing to lay side by side"), 0.0, Certainty.PROVED)


def _why_method(settled: Settled, others: bool) -> str:
    """What is called the cheapest is that by counted work, and is so."""
    enough = Message("its measured error, doubled, is small enough")
    if not others:
        return Message("[[enough]]; no other method came to the end here", enough=enough)
    least = min((trial.cost for trial in settled.fitting), default=0.0)
    if settled.trial.cost > ALIKE * least:
        return enough
    text = "by counted work [[cheapest]] whose measured error, doubled, is small enough"
    return Message(text, cheapest=_cheapest(settled.trial, least))


def _cheapest(trial: Trial, least: float) -> str:
    return Message("the cheapest tried here" if trial.cost <= least else "within a tenth of the cheapest tried here")


def _closest(settled: Settled) -> str:
    """Of a plan that is not accurate enough."""
    trial, none = settled.trial, _none(settled)
    least = min((other.error for other in settled.bench.trials), default=inf)
    near = min((other.cost for other in settled.bench.trials if other.error <= 2 * least), default=0.0)
    if least == inf or trial.error > 2 * least or trial.cost > ALIKE * near:
        return none
    text = "[[none]]: by counted work [[cheapest]] within twice the least error"
    return Message(text, none=none, cheapest=_cheapest(trial, near))


def _none(settled: Settled) -> str:
    """No setting was accurate enough, or none could be told to be."""
    if settled.measured_to is None:
        return Message("none tried is accurate enough")
    return Message("none can be told to be enough")  # why is told above


def _why_fineness(settled: Settled) -> str:
    if not settled.enough:
        return _none(settled)
    trial = settled.trial
    same = [other for other in settled.fitting if (other.method, other.scalar) == (trial.method, trial.scalar)]
    coarser = [other.cost for other in same if other.fineness > trial.fineness]
    if not coarser:
        return Message("the coarsest tried that is good enough")
    return Message(
        "good enough, and cheaper by counted work than what is coarser" if trial.cost < min(coarser) else "good enough"
    )


def _fitting(trial: Trial) -> str:
    if trial.error > 1:
        return Message("as asked for, too coarse for this accuracy")
    return Message("as asked for, finer than this accuracy needs" if trial.error < WASTEFUL else "as asked for")


def _why_scalar(settled: Settled) -> str:
    """By what was measured: the share of rounding, what fewer digits reached, and what more digits cost."""
    trial, fitting = settled.trial, settled.fitting
    usual = min((other.cost for other in fitting if other.scalar == FLOAT64), default=None)
    if trial.scalar == EXTENDED and usual is None:
        return Message("in float64 every error that was measured, doubled, is too large")
    if not settled.enough:
        return _none(settled)
    cheaper = usual is not None and trial.cost < usual
    less = Message("it costs less by counted work") if cheaper and trial.scalar != FLOAT64 else ""
    rounding = _rounding(settled.bound) if trial.scalar != EXTENDED else ""
    if rounding and less:
        return Message("[[one]], and [[other]]", one=rounding, other=less)
    return rounding or less or Message("good enough")


def _rounding(bound: Bound) -> str:
    """Nothing where it was not told apart."""
    arithmetic = next(share for share in bound.shares if share.name == ARITHMETIC)
    if arithmetic.how is None:
        return ""
    if arithmetic.error <= bound.integrated - arithmetic.error:
        return Message("its rounding stays below the error of the method")
    return Message("its rounding is most of the error, and small enough")


def _cheapest_others(settled: Settled) -> tuple[Refused, ...]:
    """The best of every other method: what it cost where it was good enough, else how wrong it was."""
    own = settled.trial.method.traits.name
    others = [trial for trial in settled.bench.trials if trial.scalar == FLOAT64 and trial.method.traits.name != own]
    return tuple(_best(settled, others, lambda trial: trial.method.traits.name, lambda trial: trial.label))


def _best(
    settled: Settled, trials: Sequence[Trial], kind: Callable[[Trial], str], label: Callable[[Trial], str]
) -> Iterator[Refused]:
    """The best trial of each kind, in the order in which the kinds were tried."""
    for name in dict.fromkeys(map(kind, trials)):
        trial = min((one for one in trials if kind(one) == name), key=_rank)
        yield Refused(label(trial), _told(settled, trial), _priced(settled, trial))


def _priced(settled: Settled, trial: Trial) -> float:
    """Seconds of a trial: those of what was taken, as many times as its counted work is more."""
    return settled.trial.seconds * trial.cost / settled.trial.cost


def _rank(trial: Trial) -> tuple[bool, float]:
    return (trial.error > 1, trial.cost if trial.error <= 1 else trial.error)


def _worst(settled: Settled, candidate: Trial | Tried) -> float:
    """The error of that quantity which is farthest from what was asked of it; of others nothing was asked.

    With one target for every coordinate and velocity it is the largest of their errors.
    """
    targets = settled.bench.targets
    targeted = np.flatnonzero(np.isfinite(targets))
    return float(candidate.errors[targeted[np.argmax(candidate.errors[targeted] / targets[targeted])]])


def _told(settled: Settled, candidate: Trial | Tried) -> float | None:
    worst = _worst(settled, candidate)
    return worst if isfinite(worst) else None


def _other_scalars(settled: Settled) -> Iterator[Refused]:
    """The best in arithmetic of fewer digits."""
    fewer = DIGITS[: DIGITS.index(settled.trial.scalar)]
    trials = [trial for trial in settled.bench.trials if trial.scalar in fewer]
    return _best(settled, trials, lambda trial: trial.scalar, lambda trial: trial.scalar)
