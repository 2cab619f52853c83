"""How verdicts are coloured in maps and sweeps: one look for one word, wherever it is drawn.

Blues are stable, reds unstable, sand and grey are open; no two neighbours differ in hue alone, so that the colours are
told apart by the colour-blind (Tol's palettes) and in grey.  What is no verdict is white and hatched.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from mbsym.problems.stability.word import Word


@dataclass(frozen=True)
class Look:
    """``hatch`` is one of matplotlib's patterns, or nothing."""

    colour: str
    hatch: str = ""

    @property
    def light(self) -> bool:
        """Whether dark text is read upon it."""
        red, green, blue = (int(self.colour[k : k + 2], 16) for k in (1, 3, 5))
        return 0.299 * red + 0.587 * green + 0.114 * blue > 150


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
#: Where nothing is proved, or was looked at: as the paper is.
WHITE = Look("#ffffff")

#: From few equilibria to many: told apart in grey, too.
SHADES = ("#f7fbff", "#d6e6f4", "#abd0e6", "#6aaed6", "#3787c0", "#105ba4", "#08306b")


def look_of_roots(word: str, right: int | None, real: int | None) -> Look:
    """The look of a verdict where the roots to the right are known: ``right`` of them, ``real`` of which are real."""
    if word != Word.UNSTABLE or not right or real == right or real is None:
        return look_of(word)
    return BOTH if real else FLUTTER


def look_of_degree(degree: int) -> Look:
    """The look of a degree of instability."""
    return DEGREES[min(degree, len(DEGREES) - 1)]


def look_of_count(count: int, counts: Collection[int], throughout: bool) -> Look:
    """The shade of a number of equilibria among all ``counts``, dotted where stability is the sample's."""
    at, last = sorted(counts).index(count), len(counts) - 1
    shade = SHADES[round(at * (len(SHADES) - 2) / last)] if last else SHADES[2]
    return Look(shade, "" if throughout else "....")


def look_of(word: str) -> Look:
    """The look of a verdict's word, that of ``NONE`` for anything else."""
    return LOOKS.get(word, NONE)


def colour_of(word: str) -> str:
    """The colour alone."""
    return look_of(word).colour
