"""From an analysis to a file that can be delivered.

A result that cannot be written costs its own section of one file; the others are delivered.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mbsym.algebra.failures import Defect, Failure, Severity
from mbsym.analysis.stages import NoResult
from mbsym.report.targets import Target

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


@dataclass(frozen=True)
class Rendered:
    """``text`` of a file (the bytes of one that is no text), or None where there is none and ``failure`` says why (no
    failure: it was not wanted).

    ``withheld`` are the problems that it cannot show, with why.
    """

    filename: str
    text: str | bytes | None
    failure: NoResult | None = None
    withheld: tuple[tuple[int, NoResult], ...] = ()


def rendered(target: Target, analysis: Analysis, problems: Sequence[int]) -> tuple[Rendered, ...]:
    """A target's files, its companions with it: all of them, or none."""
    wanted = [part for part in target.companions if part.wanted(analysis, problems)]
    without = tuple(Rendered(part.filename, None) for part in target.companions if part not in wanted)
    files = tuple(_rendered(part, analysis, problems) for part in (target, *wanted))
    failed = next((file for file in files if file.text is None), None)
    if failed is None:
        return files + without
    return tuple(Rendered(file.filename, None, file.failure or failed.failure) for file in files) + without


def _rendered(target: Target, analysis: Analysis, problems: Sequence[int]) -> Rendered:
    try:
        return Rendered(target.filename, target.render(analysis, problems))
    except Exception as error:
        whole = _no_result(error)
    withheld: dict[int, NoResult] = {}
    for number in problems:
        if number in target.shows and analysis.stage(number).failure is None:
            try:
                target.render(analysis, (number,))
            except Exception as error:
                withheld[number] = _no_result(error)
                _remember(analysis, withheld[number])
    if withheld:
        analysis.withheld = withheld
        try:
            text = target.render(analysis, problems)
            return Rendered(target.filename, text, withheld=tuple(withheld.items()))
        except Exception as error:
            whole = _no_result(error)
        finally:
            analysis.withheld = {}
    _remember(analysis, whole)
    return Rendered(target.filename, None, whole)


def _no_result(error: Exception) -> NoResult:
    """What a reader is told; the exception goes with it."""
    return NoResult.of(error if isinstance(error, Failure) else Defect.of(error))


def _remember(analysis: Analysis, failure: NoResult) -> None:
    if failure.severity is Severity.DEFECT and failure.error is not None:
        analysis.defects.append(failure.error)
