"""What a sweep says on the whole: shares of verdicts, ranges of numbers, what they depend on.

Of points drawn at random the share of a verdict estimates its probability, with Clopper and Pearson's interval

    P(X >= k | low) = (1 - level)/2,      P(X <= k | high) = (1 - level)/2,      X binomial(n, .),

which holds at least with the confidence that is told, for any k and n.  For Sobol's points it is no random sample: no
interval is given.  How much a quantity depends on a parameter is told by

* the distance of Kolmogorov and Smirnov between that parameter's values among the stable points and among the others
  (Hornberger and Spear 1981: 0, it makes no difference; 1, it alone decides), for verdicts;
* the rank correlation of Spearman, for numbers.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mbsym.problems.stability.words import Word
from mbsym.sweeps.judged import NO_VERDICT, VERDICT, WORDS
from mbsym.sweeps.points import Column

LEVEL = 0.95
#: Dependence is told from so many points at most.
MOST_COMPARED = 200_000


@dataclass(frozen=True)
class Share:
    """``count`` of ``total`` points; ``interval`` of the probability at ``LEVEL``, where points are random."""

    word: str
    count: int
    total: int
    interval: tuple[float, float] | None


@dataclass(frozen=True)
class Range:
    """Least, mean and greatest number of a column, with what was left out because it is no number."""

    column: str
    least: float
    mean: float
    greatest: float
    missing: int


@dataclass
class Totals:
    """Collected chunk by chunk."""

    columns: Sequence[Column]
    names: Sequence[str]
    points: int = 0
    words: Any = field(default_factory=lambda: np.zeros(len(WORDS), dtype=np.int64))
    sums: dict[str, list[float]] = field(default_factory=dict)
    chunks: list[tuple[Any, Any]] = field(default_factory=list)
    singly: int = 0
    #: Along one parameter: (value, word's number) of a point, and of the next, where they differ.
    changes: list[tuple[tuple[float, int], tuple[float, int]]] = field(default_factory=list)
    last: tuple[float, int] | None = None

    def add(self, points: Any, columns: Mapping[str, Any]) -> None:
        """One chunk's points (names, m) and columns."""
        self.points += points.shape[1]
        for column in self.columns:
            values = columns[column.name]
            if column.words:
                self.words += np.bincount(values, minlength=len(WORDS))
                if len(points) == 1:
                    self._follow(points[0], values)
            elif column.name == "singly":
                self.singly += int(np.sum(values))
            elif not column.whole:
                sound = values[np.isfinite(values)]
                accumulator = self.sums.setdefault(column.name, [np.inf, 0.0, -np.inf, 0, 0])
                accumulator[3] += len(sound)
                accumulator[4] += len(values) - len(sound)
                if len(sound):
                    accumulator[0], accumulator[2] = (
                        min(accumulator[0], float(sound.min())),
                        max(accumulator[2], float(sound.max())),
                    )
                    accumulator[1] += float(sound.sum())
        if sum(part[0].shape[1] for part in self.chunks) < MOST_COMPARED:
            self.chunks.append((points, columns[self.columns[0].name]))

    def _follow(self, places: Any, words: Any) -> None:
        """Where one word follows another."""
        for k in np.flatnonzero(np.diff(words, prepend=words[0] if self.last is None else self.last[1])):
            before = self.last if k == 0 else (float(places[k - 1]), int(words[k - 1]))
            assert before is not None
            self.changes.append((before, (float(places[k]), int(words[k]))))
        self.last = float(places[-1]), int(words[-1])

    def shares(self, random: bool) -> tuple[Share, ...]:
        """Of every word that occurs, most frequent first."""
        word_shares = [
            Share(word, int(count), self.points, interval(int(count), self.points) if random else None)
            for word, count in zip(WORDS, self.words, strict=True)
            if count
        ]
        return tuple(sorted(word_shares, key=lambda share: -share.count))

    def stable(self, random: bool) -> Share:
        """The points whose motion is proved to be stable."""
        count = int(sum(count for word, count in zip(WORDS, self.words, strict=True) if word in _STABLE))
        return Share("stable", count, self.points, interval(count, self.points) if random else None)

    def ranges(self) -> tuple[Range, ...]:
        return tuple(
            Range(name, least, total / count if count else np.nan, greatest, int(missing))
            for name, (least, total, greatest, count, missing) in self.sums.items()
        )

    def dependence(self) -> tuple[tuple[str, float], ...]:
        """(parameter, how much the first column depends on it), as the module's head says; strongest first."""
        if not self.chunks or not self.columns:
            return ()
        points = np.concatenate([part for part, _ in self.chunks], axis=1)
        values = np.concatenate([part for _, part in self.chunks])
        if self.columns[0].words:
            there = np.isin(values, [WORDS.index(word) for word in _STABLE])
            judged = values >= len(NO_VERDICT)
            strengths = [_smirnov(row[judged & there], row[judged & ~there]) for row in points]
        else:
            sound = np.isfinite(values)
            strengths = [_spearman(row[sound], values[sound]) for row in points]
        pairs = [(name, value) for name, value in zip(self.names, strengths, strict=True) if np.isfinite(value)]
        return tuple(sorted(pairs, key=lambda pair: -abs(pair[1])))


_STABLE = frozenset(word.value for word in Word if word.stable)
assert VERDICT.words == WORDS


def interval(count: int, total: int, level: float = LEVEL) -> tuple[float, float]:
    """Clopper and Pearson's interval for a probability, from ``count`` of ``total``."""
    from scipy.stats import beta

    rest = (1 - level) / 2
    low = 0.0 if count == 0 else float(beta.ppf(rest, count, total - count + 1))
    high = 1.0 if count == total else float(beta.ppf(1 - rest, count + 1, total - count))
    return low, high


def _smirnov(first: Any, second: Any) -> float:
    if not len(first) or not len(second):
        return float("nan")
    from scipy.stats import ks_2samp

    return float(ks_2samp(first, second, method="asymp").statistic)


def _spearman(first: Any, second: Any) -> float:
    if len(first) < 3 or np.all(first == first[0]) or np.all(second == second[0]):
        return float("nan")
    from scipy.stats import spearmanr

    return float(spearmanr(first, second).statistic)


def total(columns: Sequence[Column], names: Sequence[str], parts: Iterable[tuple[Any, Mapping[str, Any]]]) -> Totals:
    """All chunks together."""
    totals = Totals(columns, names)
    for points, measured in parts:
        totals.add(points, measured)
    return totals
