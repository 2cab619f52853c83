"""How surely a statement is known: one word for it in every result, table, file and sentence.

Of two statements together the weaker word holds:  certainty(A and B) = certainty(A) & certainty(B).  So ``&`` is
commutative, associative and idempotent, PROVED is its unit and UNDECIDED absorbs.
"""

from __future__ import annotations

from enum import StrEnum


class Certainty(StrEnum):
    """From the strongest to the weakest; the words mean different things, and none stands for another."""

    #: An identity of the exact ring, a rank that bounds, an enclosure, a theorem whose hypotheses are all shown.
    PROVED = "proved"
    #: At random states: exactly, modulo a prime, or in balls of many bits.
    VERIFIED = "verified numerically"
    #: The difference from a better run.
    MEASURED = "measured"
    #: By a scaling, or the equation of the difference.
    ESTIMATED = "estimated"
    #: Not known, for want of a theorem, of numbers or of budget.
    UNDECIDED = "undecided"

    def __repr__(self) -> str:
        return repr(self.value)

    def __and__(self, other: Certainty) -> Certainty:
        """Of two statements together: that of the weaker one."""
        return max(self, other, key=_ORDER.index)


_ORDER = tuple(Certainty)
