"""One line of the ledger: what was left out, why that is safe, and what it saved.

A measure compares what the model costs with what its counterfactual costs: the same model built without the saving,
and counted.  Nothing is guessed; what would take too long to build is said to cost "more than" what was spent.
"""

from __future__ import annotations

from dataclasses import dataclass

#: How it is known that leaving something out changes nothing (PROVED, VERIFIED), or how much it changes (ESTIMATED);
#: UNDECIDED where there are no numbers to estimate it with.
PROVED, VERIFIED, ESTIMATED, UNDECIDED = "proved", "verified numerically", "estimated", "undecided"

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
        """Whether the two differ beyond doubt: counts if they differ at all, seconds if by half and a hundredth."""
        if self.unit != SECONDS:
            return self.saved != 0
        return abs(self.saved) > max(0.01, 0.5 * min(self.without, self.taken))


@dataclass(frozen=True)
class Saving:
    """``what`` was left out; ``why`` is the justification and ``how`` its kind."""

    kind: str
    what: tuple[str, ...]
    why: str
    how: str
    measures: tuple[Measure, ...]

    @property
    def saves(self) -> bool:
        """Whether something countable was saved: seconds alone are noise."""
        return any(item.saved > 0 for item in self.measures if item.unit != SECONDS)


@dataclass(frozen=True)
class Ledger:
    """Every saving that saves something; ``unmeasured`` names kinds that there was no time left to measure."""

    savings: tuple[Saving, ...]
    unmeasured: tuple[str, ...] = ()
