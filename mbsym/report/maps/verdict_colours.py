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
    Word.UNSTABLE_BUT_BORDERS: Look("#cc6677", "x"),
}

#: Of unstable motions whose roots to the right are counted: pairs alone, real roots beside pairs.
FLUTTER, BOTH = Look("#882255"), Look("#cc6677", "xxxx")
#: By Poincare's degree of instability, from 0 on; the last for what is beyond.
DEGREES = (Look("#4f93c9"), Look("#ddcc77"), Look("#cc6677"), Look("#882255"), Look("#44222f"))

#: Where no verdict is given: outside what was assumed, or where formulas divide by zero.
NONE = Look("#ffffff", "///")


def look_of_roots(word: str, right: int | None, real: int | None) -> Look:
    """The look of a verdict where the roots to the right are known: ``right`` of them, ``real`` of which are real."""
    if word != Word.UNSTABLE or not right or real == right or real is None:
        return look_of(word)
    return BOTH if real else FLUTTER


def look_of_degree(degree: int) -> Look:
    """The look of a degree of instability."""
    return DEGREES[min(degree, len(DEGREES) - 1)]


def look_of(word: str) -> Look:
    """The look of a verdict's word, that of ``NONE`` for anything else."""
    return LOOKS.get(word, NONE)


def colour_of(word: str) -> str:
    """The colour alone."""
    return look_of(word).colour
