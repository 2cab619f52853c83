"""The verdicts of problem 6 in few words: the same few in every table and summary, where the long ones do not fit.

JSON and the appendix keep the long words, which say what is meant.
"""

from __future__ import annotations

from mbsym.problems.stability.theory import (
    ASYMPTOTIC,
    ASYMPTOTIC_BUT_CYCLIC,
    ASYMPTOTIC_BUT_TURNED,
    CRITICAL,
    STABLE,
    STABLE_BUT_CYCLIC,
)

#: Long and short; what is not listed is short enough.
SHORT = {
    STABLE_BUT_CYCLIC: f"{STABLE} (cyclic drift)",
    ASYMPTOTIC_BUT_CYCLIC: f"{ASYMPTOTIC} (cyclic drift)",
    ASYMPTOTIC_BUT_TURNED: f"{ASYMPTOTIC} (up to rotation)",
    CRITICAL: "critical (first approximation)",
}

#: What is said of a subsystem whose stability is settled case by case: "undecided" means that no theorem applies.
DEPENDS = "depends on the parameters"


def short_verdict(words: str) -> str:
    """The short form of a verdict, and of every verdict in a sentence."""
    for long in sorted(SHORT, key=len, reverse=True):  # one is a part of another
        words = words.replace(long, SHORT[long])
    return words
