"""Which methods are tried for an accuracy, in which arithmetic, and from which setting on."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT32, FLOAT64
from mbsym.numerics.kernels.llvm import available
from mbsym.numerics.methods.interface import Method, Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.planning.models import Model
from mbsym.numerics.planning.pilot import Trial, finest

#: Coarsest accuracies at which methods are worth a try: below, their steps are too many.
COARSE_ONLY = {"rk45": 1e-8, "rk4": 1e-5}

#: Numbers of 24 bits are tried for errors down to this.
SINGLE = 3e-6

#: Taylor series are compiled for fine accuracies, and for equations of moderate length.
TAYLOR_FROM, TAYLOR_LONG = 1e-8, 3_000

#: Methods that are another one in slower clothes.
DUPLICATES = ("scipy-rk45", "scipy-dop853")


@dataclass(frozen=True)
class Contender:
    """A method in an arithmetic."""

    method: Method
    scalar: str


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
        names.append("dop853")
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
            yield Contender(method, scalar)


def in_more_digits() -> Iterator[Contender]:
    """Where float64 does not do."""
    if available(EXTENDED):
        for name in ("dop853", "taylor"):
            if name in METHODS and EXTENDED in METHODS[name].traits.scalars:
                yield Contender(METHODS[name], EXTENDED)


def first_setting(contender: Contender, tolerance: float, best: Trial | None, end: float, spacing: float) -> Setting:
    """Where the search begins: the tolerance that did for another, or steps as many as its evaluations pay for.

    No step is longer than the ``spacing`` of the rows.
    """
    traits = contender.method.traits
    if not traits.fixed:
        found = best.setting.tolerance if best is not None and best.setting.tolerance else tolerance
        return Setting(tolerance=min(max(found, finest(contender.method, contender.scalar)), 1e-3))
    evaluations = best.work.evaluations if best is not None else 4_000
    return Setting(step=min(float(f"{end / max(10, evaluations / 4):.1e}"), spacing))
