"""Verdicts and outcomes as reports say them."""

from __future__ import annotations

from collections.abc import Sequence

from mbsym.expressions.message import worded
from mbsym.problems.checks import EXACT, FAILED, NUMERICAL
from mbsym.problems.stability import Stability
from mbsym.problems.stability.verdict import Verdict
from mbsym.problems.stability.word import Word
from mbsym.report.content import Inline, Strong
from mbsym.report.words.claims import HELD, REFUTED

_GOOD = {*(word for word in Word if word.stable), EXACT, NUMERICAL, HELD}
_BAD = {Word.UNSTABLE, Word.UNSTABLE_BUT_BORDERS, FAILED, REFUTED}


def grade(word: str) -> str:
    """good, bad or open: how a verdict or an outcome is coloured; the word itself says it."""
    return "good" if word in _GOOD else "bad" if word in _BAD else "open"


def concluded(word: Word, theorems: Sequence[str], key: str = "") -> tuple[Inline, ...]:
    """``stable (Routh)``."""
    return Strong(worded(word), grade(word), key), *_by(theorems)


def where(word: Word, theorems: Sequence[str]) -> tuple[Inline, ...]:
    """The same of what holds under conditions: it is neither good nor bad."""
    return worded(word), *_by(theorems)


def _by(theorems: Sequence[str]) -> tuple[Inline, ...]:
    names = [part for name in theorems for part in (", ", worded(name))][1:]
    return (" (", *names, ")") if names else ()


def verdict(found: Verdict, key: str = "") -> tuple[Inline, ...]:
    """Its word, with its theorems."""
    return concluded(found.word, found.theorems, key)


def decided(found: Stability) -> str:
    """How the verdict at given values was found, if it is one: irrational values have enclosures."""
    if found.numerical is None or found.numerical.word == Word.UNDECIDED:
        return ""
    enclosed = any(part.theory.at_point is None for part in found.subsystems)
    return ", decided by rigorous enclosures" if enclosed else ", decided exactly"
