"""What a setting on a model is worth: the shares of its error, and the bounds that they add up to."""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np

from mbsym.algebra.certainty import Certainty
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT32, FLOAT64
from mbsym.numerics.kernels.llvm import available
from mbsym.numerics.methods.interface import Breakdown, Unusable
from mbsym.numerics.planning.model_choice import ModelChoice, Scene, Tried
from mbsym.numerics.planning.pilot import Bench, Trial
from mbsym.numerics.planning.plan import (
    ARITHMETIC,
    ENERGY,
    INTEGRATION,
    MODEL,
    Accuracy,
    Bound,
    Share,
)
from mbsym.numerics.trade.yardstick import Yardstick

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
    asked = np.isfinite(scene.targets)
    beyond = asked & ~(errors < 0.9 * scene.targets)
    if not np.any(beyond):
        room = 1 - float(np.max(errors[asked] / scene.targets[asked], initial=0.0))
        return scene.targets, GOAL * room, ""
    known = np.where(np.isfinite(errors), errors, 1.0)
    worth = np.where(beyond, np.maximum(scene.targets, 0.1 * known), scene.targets)
    worst = float(np.max(known[beyond]))
    text = f"this model is {worst:.1e} wrong, however it is integrated: nothing finer than that is worth its time"
    return worth, GOAL, text


def fits(one: Trial, known: float, room: float) -> bool:
    """Whether the error of a trial, doubled, is within ``room``; with ``known``, that of what it was measured by."""
    return DOUBLED * (one.ratio - known) + known <= room


def shares_of(bench: Bench, found: Trial, stick: Yardstick, model: ModelChoice) -> Shares:
    """(name, errors (2n + 1,), how) of model, integration, arithmetic."""
    how = Certainty.PROVED if not np.any(model.taken.errors) else model.taken.how
    asked = np.isfinite(bench.targets)
    known = np.where(asked, stick.known * np.where(asked, bench.targets, 1.0), 0.0)
    measured = DOUBLED * found.errors + known
    arithmetic, way = np.zeros_like(measured), None  # a part of the integration's share
    other = {FLOAT64: EXTENDED, FLOAT32: FLOAT64}.get(found.scalar)
    cheap = found.cost < CHEAP and other is not None
    if cheap and other in found.method.traits.scalars and available(str(other)):
        try:
            twin = bench.run(found.method, str(other), found.setting)
            _, apart = bench.compared(_again(bench, found), twin.states)
            arithmetic, way = np.minimum(DOUBLED * apart, measured), Certainty.MEASURED
            measured = np.maximum(measured - arithmetic, DOUBLED * twin.errors)
        except (Breakdown, Unusable):
            pass
    return (
        (MODEL, RAISED * model.taken.errors, how),
        (INTEGRATION, measured, Certainty.MEASURED if isfinite(stick.known) else Certainty.ESTIMATED),
        (ARITHMETIC, arithmetic, way),
    )


def _again(bench: Bench, found: Trial) -> Any:
    """The quantities of a setting that was tried: runs are repeatable."""
    if found.states is not None:
        return found.states
    return bench.run(found.method, found.scalar, found.setting).states


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
