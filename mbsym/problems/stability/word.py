"""The words of problem 6: what may be said of a motion."""

from __future__ import annotations

from enum import StrEnum


class Word(StrEnum):
    """A verdict in the words that every output prints, tables and JSON included, in the order of lists."""

    ASYMPTOTIC = "asymptotically stable"
    #: A turned steady spin is a steady spin: it does not come back.
    ASYMPTOTIC_BUT_TURNED = "asymptotically stable but for a rotation of space"
    #: With cyclic coordinates nothing better can hold: they drift.
    ASYMPTOTIC_BUT_CYCLIC = "asymptotically stable but for a drift of cyclic coordinates"
    #: Steady motions of a family are near one another: what is disturbed may end in another one.
    ASYMPTOTIC_BUT_STEADY = "asymptotically stable but for a change of the steady motion"
    STABLE = "stable"
    STABLE_BUT_CYCLIC = "stable but for a drift of cyclic coordinates"
    GYROSCOPIC = "gyroscopically stabilised only"
    CRITICAL = "stable in first approximation only"
    #: No theorem applies.
    UNDECIDED = "undecided"
    #: It is different for different parameters: the cases say how.
    DEPENDS = "depends on the parameters"
    UNSTABLE = "unstable"
    #: Of no point: for all parameters but those at which some condition is an equality, which have no inner point.
    UNSTABLE_BUT_BORDERS = "unstable but for border cases"

    def __repr__(self) -> str:
        return repr(self.value)

    @property
    def asymptotic(self) -> bool:
        """Whether it says that disturbed motions come back, be it but for drift, rotation, another speed."""
        return self in (
            Word.ASYMPTOTIC,
            Word.ASYMPTOTIC_BUT_TURNED,
            Word.ASYMPTOTIC_BUT_CYCLIC,
            Word.ASYMPTOTIC_BUT_STEADY,
        )

    @property
    def stable(self) -> bool:
        """Whether it says that the motion itself is stable, be it asymptotically, or but for drift or rotation."""
        return self.asymptotic or self in (Word.STABLE, Word.STABLE_BUT_CYCLIC)

    @property
    def open(self) -> bool:
        """Whether it leaves the nonlinear system open, at one place."""
        return self in (Word.GYROSCOPIC, Word.CRITICAL, Word.UNDECIDED)
