"""What was chosen for a run, why, and how wrong the run is then: values; words are made elsewhere.

    error of a quantity  <=  model + integration + arithmetic,      relative to its size in the whole motion

Each share says how surely it is known: measured is the difference from a better run over the whole interval, doubled;
estimated comes of the equation of the difference, or of a scaling; proved of a theorem; None of a part of another share
that was not told apart.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import reduce
from math import inf, isfinite
from operator import and_
from typing import Any

import numpy as np

from mbsym.algebra.certainty import Certainty
from mbsym.expressions.message import Message
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.planning.models import Model

MODEL, INTEGRATION, ARITHMETIC = "model", "integration", "arithmetic"

#: The quantity besides coordinates and velocities: T2 - T0 - U, relative to the largest kinetic energy.
ENERGY = "energy"

OPERATIONS, SECONDS = "operations", "seconds"


@dataclass(frozen=True)
class Accuracy:
    """The relative errors that are tolerable: of all coordinates and velocities, and of quantities by name.

    A quantity that is not named is held to ``everything``; where that is None, to nothing.
    """

    everything: float | None = None
    named: Mapping[str, float] = field(default_factory=dict)

    def targets(self, names: Sequence[str]) -> Any:
        """The tolerable error of each quantity, inf where any is; the energy counts only where it is named."""
        rest = inf if self.everything is None else self.everything
        return np.array([self.named.get(name, inf if name == ENERGY else rest) for name in names])

    @property
    def finest(self) -> float:
        """The smallest of them."""
        return min((*self.named.values(), *([] if self.everything is None else [self.everything])), default=inf)

    def scaled(self, factor: float) -> Accuracy:
        """The same with every error multiplied."""
        rest = None if self.everything is None else self.everything * factor
        return Accuracy(rest, {name: x * factor for name, x in self.named.items()})


@dataclass(frozen=True)
class Refused:
    """What was not taken: its error, or what it costs, or a word on why it was not even tried."""

    word: str
    error: float | None = None
    cost: float | None = None
    why: str = ""


@dataclass(frozen=True)
class Item:
    """One choice: of ``kind``, about ``what``; ``chosen`` is its word, ``error`` what it adds (None: not told apart).

    Kinds are those of ``planning.kinds``.  ``cost`` is in ``unit``: operations of one right-hand side, or
    processor seconds of the run.
    """

    kind: str
    what: tuple[str, ...]
    chosen: str
    why: str
    error: float | None = None
    how: Certainty = Certainty.ESTIMATED
    cost: float | None = None
    unit: str = OPERATIONS
    refused: tuple[Refused, ...] = ()


@dataclass(frozen=True)
class Share:
    """A part of the bound; ``how`` it is known, None where another share holds it."""

    name: str
    error: float
    how: Certainty | None


@dataclass(frozen=True)
class Bound:
    """What the error of one quantity is at most, as far as the shares are known, beside what is tolerable.

    ``proved``: at every row integration and arithmetic together are at most this part of the quantity's largest value
    there, by a certificate; None where there is none.  The model's share is no matter of it.
    """

    quantity: str
    shares: tuple[Share, ...]
    target: float
    proved: float | None = None

    @property
    def total(self) -> float:
        return sum(share.error for share in self.shares)

    @property
    def integrated(self) -> float:
        """The shares that are no model's."""
        return sum(share.error for share in self.shares if share.name != MODEL)

    @property
    def reached(self) -> bool:
        return self.total <= self.target

    @property
    def how(self) -> Certainty:
        """The weakest of the ways in which its shares are known."""
        known = (share.how for share in self.shares if share.how is not None and share.error > 0)
        return reduce(and_, known, Certainty.PROVED)


@dataclass(frozen=True)
class Alternative:
    """What another accuracy would cost: the cheapest setting that was measured to reach it.

    ``times`` is the ratio of its counted work to that of the plan, and ``seconds`` those of the plan so many times.

    ``model`` is its model where that is another; ``seconds`` None: out of reach, ``why``.
    """

    target: float
    label: str = ""
    seconds: float | None = None
    model: str = ""
    why: str = ""
    times: float = 1.0


def poorly_measured(known: float, parted: float = inf) -> str:
    """What is said of a run to measure by that is ``known`` to this part of the sizes only, as others part from it."""
    if isfinite(parted):
        text = (
            "what settings were measured by is itself lost before the end: two fine runs part from t = [[time]] on; a "
            "shorter --time helps"
        )
        return Message(text, time=f"{parted:.3g}")
    if not isfinite(known):
        return Message("no run could be had to measure settings by")
    return Message("what settings were measured by is itself known to [[known]] only", known=f"{known:.1e}")


@dataclass(frozen=True)
class Plan:
    """Everything that is needed to repeat the run, and what it is worth.

    ``bounds`` has one entry for each quantity that an error was named for, else one for the worst; ``seconds`` is what
    the integration took in the pilot, ``spent`` what choosing took.  ``unshown`` says why the run's own error could not
    be estimated: its accuracy is not shown then.  ``measured_to``: how well the run is known by which settings were
    measured, a part of the sizes, where that is too little to tell whether what was taken is accurate enough; from the
    time ``parted`` on another fine run differs from that one.
    """

    accuracy: Accuracy
    time: float
    items: tuple[Item, ...]
    bounds: tuple[Bound, ...]
    model: Model
    method: str
    setting: Setting
    scalar: str
    seconds: float
    spent: float
    more: Alternative | None = None
    less: Alternative | None = None
    remarks: tuple[str, ...] = ()
    contradicted: bool = False
    unshown: str = ""
    measured_to: float | None = None
    parted: float = inf

    @property
    def unmeasured(self) -> str:
        """Why it cannot be told whether the setting is accurate enough; nothing where that can be told."""
        if self.measured_to is None or self.contradicted:
            return ""
        return poorly_measured(self.measured_to, self.parted)

    @property
    def bound(self) -> Bound:
        """The one that has least room."""
        return max(self.bounds, key=lambda candidate: candidate.total / candidate.target)

    @property
    def reached(self) -> bool:
        """Whether every quantity is within its error, and no estimate of the run's own is missing or says otherwise."""
        return not self.contradicted and not self.unshown and all(bound.reached for bound in self.bounds)
