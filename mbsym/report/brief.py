"""A whole run in one line: problems done, self-check, claims, seconds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING

from mbsym.expressions.message import worded
from mbsym.problems import ranges
from mbsym.problems.checks import EXACT, FAILED, NUMERICAL, SINGULAR, UNDECIDED, Check
from mbsym.report.content import Inline, Phrase, Said, joined
from mbsym.report.language import Language
from mbsym.report.plain_writer import Writer
from mbsym.report.words.claims import HELD, OPEN, REFUTED, claim_line

if TYPE_CHECKING:
    from mbsym.analysis import Analysis

NONE = Said("none")


@dataclass(frozen=True)
class Brief:
    """``problems``: ``1-7``, or ``1-3, 7`` with ``missing`` ``4-6: no motion``; the others are words and numbers.

    ``worst`` is the worst outcome of a check; "" where there are none.
    """

    problems: str
    missing: str
    self_check: str
    worst: str
    claims: str
    seconds: float


def brief(analysis: Analysis, seconds: float) -> Brief:
    """One line on everything that was asked for, in the language of the description or of the reports."""
    write = Writer(Language(analysis.language or analysis.system.language))
    stages = {number: analysis.stage(number) for number in analysis.problems}
    failures = [(number, stage.failure.short) for number, stage in stages.items() if stage.failure is not None]
    return Brief(
        problems=ranges((n for n, stage in stages.items() if stage.failure is None), "-") or write.said(NONE),
        missing="; ".join(
            f"{ranges((n for n, _ in group), '-')}: {write.inline(worded(reason))}"
            for reason, group in groupby(failures, key=lambda item: item[1])
        ),
        self_check=write.inline(self_check(analysis.checks)),
        worst=worst(analysis.checks),
        claims=write.inline(claims_counted([claim_line(result).word for result in analysis.claims])),
        seconds=seconds,
    )


def self_check(checks: Sequence[Check]) -> Inline:
    """``all exact``, or how many are not; what failed by name."""
    outcomes = [check.outcome for check in checks]
    if not outcomes:
        return Said("nothing to check")
    if FAILED in outcomes:
        failed = joined((worded(check.name) for check in checks if check.failed), ", ")
        return Phrase((worded(FAILED), ": ", failed))
    if set(outcomes) == {EXACT}:
        return Said("all exact")
    words = [word for word in (EXACT, NUMERICAL, UNDECIDED, SINGULAR) if word in outcomes]
    return joined((Phrase((f"{outcomes.count(word)} ", worded(word))) for word in words), ", ")


def worst(checks: Sequence[Check]) -> str:
    """The worst outcome; "" where there are no checks."""
    outcomes = {check.outcome for check in checks}
    return next((word for word in (FAILED, SINGULAR, UNDECIDED, NUMERICAL, EXACT) if word in outcomes), "")


def claims_counted(words: Sequence[str]) -> Inline:
    """``2 held, 1 refuted``."""
    counts = [Phrase((f"{words.count(word)} ", worded(word))) for word in (HELD, REFUTED, OPEN) if word in words]
    return joined(counts, ", ") if counts else Said("no claims")
