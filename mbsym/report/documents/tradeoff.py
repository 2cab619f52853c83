"""``tradeoff.json`` of ``mbsym tradeoff``."""

from __future__ import annotations

from typing import Annotated

from msgspec import UNSET, UnsetType

from mbsym.report.documents.base import ASIDE, From, Hashed, Part

Seconds = Annotated[float, "median processor seconds of the integration on this machine", ASIDE, From("seconds")]
Trouble = Annotated[str | UnsetType, "why it has no error", From("trouble")]


class Drift(Part, frozen=True):
    """drift from constraints, in parts of the motion's size"""

    positions: Annotated[float | None, "of those on positions"]
    velocities: Annotated[float | None, "of those on velocities"]


class Setting(Part, frozen=True):
    """the setting of least time among those measured that reach the target; null where none does"""

    method: Annotated[str, "its method", From("method.traits.name")]
    arithmetic: Annotated[str, "its arithmetic", From("scalar")]
    tolerance: Annotated[float | None, "its tolerance", From("setting.tolerance")]
    step: Annotated[float | None, "its step", From("setting.step")]


class Run(Setting, frozen=True):
    """one trial: a method in an arithmetic with a tolerance or a step"""

    error: Annotated[
        float | None,
        "largest difference from the reference over quantities and times, relative to their sizes in the whole motion",
    ]
    drift: Annotated[float | None, "largest error of the energy"]
    evaluations: Annotated[int, "of the right-hand side", From("work.evaluations")]
    steps: Annotated[int, "steps", From("work.steps")]
    seconds: Seconds
    cost: Annotated[float, "counted work of all that was done for it, in seconds of a usual machine"]
    front: Annotated[bool, "whether nothing tried is as quick and more accurate", ASIDE]
    constraint_drift: Annotated[Drift | UnsetType, From("strayed")] = UNSET
    trouble: Trouble = UNSET


class Reference(Part, frozen=True):
    """the solution that errors are measured against"""

    method: Annotated[str, "how it was found"]
    error: Annotated[float, "its own error: the largest difference from a second solution"]
    seconds: Annotated[float, "seconds that finding it took", ASIDE]
    cost: Annotated[float, "its counted work, in seconds of a usual machine"]


class Order(Part, frozen=True):
    """the measured order of a method with steps of one length"""

    method: Annotated[str, "the method"]
    arithmetic: Annotated[str, "its arithmetic", From("scalar")]
    measured: Annotated[float, "log2 of the ratio of errors when the step is halved"]
    nominal: Annotated[int, "the order that the method has"]
    halvings: Annotated[int, "pairs of steps that it was found from", From("pairs")]


class Model(Part, frozen=True):
    """a simpler model, or a richer one, held against the most faithful one"""

    model: Annotated[str, "what it is"]
    neglected: Annotated[str, "what it leaves out"]
    error: Annotated[float | None, "largest difference from the most faithful one, relative to sizes"]
    operations: Annotated[int, "of one right-hand side"]
    evaluations: Annotated[int, "of the right-hand side, at a tolerance of 1e-13", From("work.evaluations")]
    seconds: Seconds
    trouble: Trouble = UNSET


class NotUsed(Part, frozen=True):
    """a method that does not apply here"""

    method: Annotated[str, "the method"]
    why: Annotated[str, "why"]


class Tradeoff(Hashed, frozen=True, kw_only=True):
    """What accuracy costs for one motion, method by method, measured against a reference solution."""

    time: Annotated[float, "from 0 to this time"]
    target: Annotated[float, "the error that is good enough"]
    budget: Annotated[float, "counted work that was allowed, in seconds of a usual machine"]
    interrupted: Annotated[bool, "whether not all runs are there"]
    reference: Reference
    smallest_judged: Annotated[float, "smaller errors are not told from that of the reference"]
    spent: Annotated[float, "counted work of all runs, in seconds of a usual machine"]
    runs: Annotated[list[Run], "the runs, method by method, from coarse to fine", From("rows")]
    orders: Annotated[list[Order], "measured orders"]
    models: Annotated[list[Model], "models; empty where they were not compared"]
    not_used: Annotated[list[NotUsed], "methods that were not tried", From("unusable")]
    recommended: Setting | None
    sentence: Annotated[str, "the recommendation, in a sentence", ASIDE]
