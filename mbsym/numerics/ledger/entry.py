"""One line of the ledger: what was left out, why that is safe, and what it saved.

A measure compares what the model costs with what its counterfactual costs: the same model built without the saving,
and counted.  Nothing is guessed; what would take too long to build is said to cost "more than" what was spent.
"""

from __future__ import annotations

from dataclasses import dataclass

from mbsym.algebra.certainty import Certainty

#: What follows: the scene does not need it; it does; or nobody knows until an accuracy is asked for.
NOT_NEEDED, NEEDED, OPEN = "not needed", "needed", "open"

TERMS, OPERATIONS, SECONDS, COUNT = "terms", "operations", "seconds", "count"


@dataclass(frozen=True)
class Measure:
    """What something costs without the saving and with it.

    ``quantity`` says of what; ``unit`` is terms, operations, seconds or count.  With ``at_least`` the counterfactual is
    unfinished and costs more than ``without``.
    """

    quantity: str
    unit: str
    without: float
    taken: float
    at_least: bool = False

    @property
    def saved(self) -> float:
        return self.without - self.taken

    @property
    def clear(self) -> bool:
        """Whether the two differ beyond doubt: counts if they differ at all, seconds if twofold and by a tenth."""
        if self.unit != SECONDS:
            return self.saved != 0
        return abs(self.saved) > max(0.1, min(self.without, self.taken))


@dataclass(frozen=True)
class Saving:
    """``what`` was left out; ``why`` is the justification.

    ``how`` it is known that this changes nothing (proved, verified), or how much it changes (measured by a run without
    it, else estimated); undecided where there are no numbers to estimate it with.

    ``error`` is what that changes of the motion, relative to its size, and ``tolerable`` what it may change; both are
    None where it changes nothing, or where nobody asked for an accuracy.
    """

    kind: str
    what: tuple[str, ...]
    why: str
    how: Certainty
    measures: tuple[Measure, ...]
    error: float | None = None
    tolerable: float | None = None

    @property
    def standing(self) -> str:
        """NOT_NEEDED where leaving it out changes nothing, or no more than is tolerable; NEEDED where more; else OPEN.

        Without an error to hold against an accuracy, an estimate of what is dropped decides nothing.
        """
        if self.error is not None and self.tolerable is not None:
            return NOT_NEEDED if self.error <= self.tolerable else NEEDED
        return NOT_NEEDED if self.how in (Certainty.PROVED, Certainty.VERIFIED) else OPEN

    @property
    def saves(self) -> bool:
        """Whether something countable was saved: seconds alone are noise."""
        return any(item.saved > 0 for item in self.measures if item.unit != SECONDS)


@dataclass(frozen=True)
class Ledger:
    """Every saving that saves something; ``unmeasured`` names kinds that the budget was too small to measure."""

    savings: tuple[Saving, ...]
    unmeasured: tuple[str, ...] = ()
