"""How verdicts are coloured in maps and sweeps: one look for one word, wherever it is drawn.

Blues are stable, reds unstable, sand and grey are open; no two neighbours differ in hue alone, so that the colours are
told apart by the colour-blind (Tol's palettes) and in grey.  What is no verdict is white and hatched.
"""

from __future__ import annotations

from dataclasses import dataclass

from mbsym.problems.stability.word import Word


@dataclass(frozen=True)
class Look:
    """``hatch`` is one of matplotlib's patterns, or nothing."""

    colour: str
    hatch: str = ""


#: By the word of the verdict.
LOOKS: dict[str, Look] = {
    Word.ASYMPTOTIC: Look("#225588"),
    Word.ASYMPTOTIC_BUT_TURNED: Look("#225588", "."),
    Word.ASYMPTOTIC_BUT_CYCLIC: Look("#225588", "-"),
    Word.ASYMPTOTIC_BUT_STEADY: Look("#225588", "|"),
    Word.STABLE: Look("#4f93c9"),
    Word.STABLE_BUT_CYCLIC: Look("#4f93c9", "-"),
    Word.GYROSCOPIC: Look("#b5ddf0"),
    Word.CRITICAL: Look("#e8d99a"),
    Word.UNDECIDED: Look("#c4c4c4"),
    Word.DEPENDS: Look("#c4c4c4", "x"),
    Word.UNSTABLE: Look("#cc6677"),
}

#: Where no verdict is given: outside what was assumed, or where formulas divide by zero.
NONE = Look("#ffffff", "///")


def look_of(word: str) -> Look:
    """The look of a verdict's word, that of ``NONE`` for anything else."""
    return LOOKS.get(word, NONE)


def colour_of(word: str) -> str:
    """The colour alone."""
    return look_of(word).colour
