"""The words of problem 6: what may be said of a motion."""

from __future__ import annotations

from enum import StrEnum


class Word(StrEnum):
    """A verdict in the words that reports print; ``sentences`` has shorter ones."""

    ASYMPTOTIC = "asymptotically stable"
    #: With cyclic coordinates nothing better can hold: they drift.
    ASYMPTOTIC_BUT_CYCLIC = (
        "asymptotically stable with respect to the other variables; the cyclic coordinates may drift"
    )
    #: A turned steady spin is a steady spin: it does not come back.
    ASYMPTOTIC_BUT_TURNED = "asymptotically stable up to a rotation of space"
    STABLE = "stable"
    STABLE_BUT_CYCLIC = "stable with respect to the other variables; the cyclic coordinates may drift"
    GYROSCOPIC = "gyroscopically stabilised only"
    CRITICAL = "stable in first approximation only, critical"
    #: No theorem applies.
    UNDECIDED = "undecided"
    #: It is different for different parameters: the cases say how.
    DEPENDS = "depends on the parameters"
    UNSTABLE = "unstable"

    def __repr__(self) -> str:
        return repr(self.value)
