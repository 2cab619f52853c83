"""What a run found, as plain data for the terminal."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from mbsym.model.system import System
from mbsym.problems.checks import Check
from mbsym.report.sections import section_of
from mbsym.report.words.claims import ClaimLine, claim_line

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


@dataclass(frozen=True)
class Line:
    """One problem: what was derived, in a few lines; where nothing was (not ``available``) they say why."""

    number: int
    title: str
    lines: tuple[str, ...]
    seconds: float
    available: bool


@dataclass(frozen=True)
class Summary:
    system: str
    coordinates: tuple[str, ...]
    problems: tuple[Line, ...]
    checks: tuple[Check, ...]
    files: tuple[Path, ...]
    claims: tuple[ClaimLine, ...] = ()


def summary(analysis: Analysis, problems: Sequence[int], files: Iterable[Path]) -> Summary:
    """Derived problems with sizes and seconds, the self-check, and where the files are."""
    return Summary(
        system=analysis.system.name,
        coordinates=analysis.system.coordinates,
        problems=tuple(_line(analysis, number) for number in problems),
        checks=analysis.checks,
        files=tuple(files),
        claims=tuple(map(claim_line, analysis.claims)),
    )


def title_of(system: System, number: int) -> str:
    """What a problem derives for this system: which equations problem 3 holds is said."""
    from mbsym.analysis import PROBLEMS

    if PROBLEMS[number].attribute == "equations" and system.speeds:
        return "nonlinear Kane's equations" + (" with multipliers" if system.constraints else "")
    if PROBLEMS[number].attribute == "equations" and system.constraints:
        return "nonlinear Lagrange equations with multipliers"
    return PROBLEMS[number].title


def _line(analysis: Analysis, number: int) -> Line:
    from mbsym.analysis import PROBLEMS

    stage = analysis.stage(number)
    title = title_of(analysis.system, number)
    if stage.failure is not None:
        lines = [f"no result: {stage.failure.reason}", *([stage.failure.hint] if stage.failure.hint else [])]
        return Line(number, title, tuple(lines), stage.seconds, False)
    described = section_of(PROBLEMS[number]).lines(stage.value, analysis)
    return Line(number, title, tuple(described), stage.seconds, True)
