"""One description, in the process that calls: read, derived, rendered; nothing is written.

``work`` is a pure function of its task.  It ends with a row whatever the description is; what ends the process itself
(an abort, a signal, no end at all) is met by ``isolation``.
"""

from __future__ import annotations

import hashlib
from dataclasses import replace
from typing import TYPE_CHECKING, cast

from msgspec import structs

from mbsym.batch.outcome import CheckRow, ClaimRow, ComplaintRow, FileRow, Outcome, ProblemRow, Row
from mbsym.batch.transport import Finished, Task
from mbsym.expressions.message import Message, joined

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mbsym.analysis import Analysis
    from mbsym.analysis.stages import NoResult
    from mbsym.expressions.place import Complaint
    from mbsym.formulas.tree import Angles
    from mbsym.model.system import System


def work(task: Task) -> Finished:
    """What becomes of a description.  Raises nothing but MemoryError and what is our own mistake."""
    from mbsym.source.document import load_bytes

    system, complaints, text = load_bytes(task.data, task.file)
    if system is not None and (system.constraints or system.linear):
        from mbsym.analysis.soundness import complain as complain_of

        complain_of(system, complaints)
        system = None if complaints.errors else system
    rows = tuple(map(complaint_row, complaints.sorted()))
    if system is None:
        return Finished(Row(task.file, task.folder, Outcome.ERRORS, complaints=rows))
    from mbsym.batch import digests

    meaning = digests.of_meaning(text, task.file)
    if meaning and meaning == task.known:
        row = Row(task.file, task.folder, Outcome.DERIVED, name=system.name, complaints=rows)
        return Finished(row, meaning=meaning, same=True)
    row, files = _derived(task, system)
    return Finished(replace(row, complaints=rows), files, meaning)


def complaint_row(complaint: Complaint) -> ComplaintRow:
    """A complaint of :mod:`mbsym.source` as a row: in English, with what it takes to say it otherwise."""
    span = complaint.span
    row = ComplaintRow(complaint.severity, complaint.code, complaint.message, hint=complaint.hint)
    return row if span is None else structs.replace(row, line=span.line, column=span.column, length=span.length)


def _derived(task: Task, system: System) -> tuple[Row, dict[str, str | bytes]]:
    from mbsym.report.whole_run import analysis_of, lost, remarks, silent, whole_run

    options = task.options
    analysis = analysis_of(system, options.problems, options.formats, options.terms)
    analysis.detail = options.detail
    rendered = whole_run(analysis, options.formats, silent, angles=cast("Angles | None", options.angles))
    files = {file.filename: file.text for file in rendered if file.text is not None}
    defects = lost(analysis, rendered)
    outcome = _outcome(analysis, defects)
    row = Row(
        task.file,
        task.folder,
        outcome,
        name=system.name,
        problems=tuple(_problem_row(analysis, number) for number in analysis.problems),
        claims=tuple(_claim_rows(analysis)),
        checks=tuple(
            CheckRow(check.name, check.first, check.second, check.outcome, check.detail) for check in analysis.checks
        ),
        files=tuple(FileRow(name, _digest(content)) for name, content in sorted(files.items())),
        message=Message("there was not enough memory for a part of it") if outcome is Outcome.MEMORY else "",
        notes=tuple(dict.fromkeys((*_losses(analysis, defects), *remarks(options.formats, files)))),
    )
    return row, files


def _digest(content: str | bytes) -> str:
    return hashlib.sha256(content.encode() if isinstance(content, str) else content).hexdigest()


def _outcome(analysis: Analysis, defects: Iterable[tuple[str, NoResult]]) -> Outcome:
    """The worst that can be said: memory that ran out, a defect, a failed check."""
    from mbsym.algebra.failures import Limit, Severity

    missing = [failure for _, failure in defects]
    if any(failure.severity is Severity.DEFECT and failure.limit is Limit.MEMORY for failure in missing):
        return Outcome.MEMORY
    if any(isinstance(error, MemoryError) for error in analysis.defects):
        return Outcome.MEMORY
    if any(check.failed for check in analysis.checks):
        return Outcome.SELF_CHECK
    if missing or analysis.defects:
        return Outcome.INCOMPLETE
    return Outcome.DERIVED


def _problem_row(analysis: Analysis, number: int) -> ProblemRow:
    from mbsym.algebra.failures import Severity
    from mbsym.analysis import PROBLEMS
    from mbsym.problems.stability.problem import Stability

    problem, stage = PROBLEMS[number], analysis.stage(number)
    row = ProblemRow(number, problem.attribute, problem.title, "derived")
    if stage.failure is not None:
        why = stage.failure
        return structs.replace(
            row,
            status="none",
            code=why.code,
            reason=why.reason,
            hint=why.hint or None,
            defect=why.severity is Severity.DEFECT,
        )
    if isinstance(stage.value, Stability):
        there = stage.value.numerical
        return structs.replace(
            row, verdict=stage.value.verdict.word.value, verdict_at_values=None if there is None else there.word.value
        )
    return row


def _claim_rows(analysis: Analysis) -> Iterable[ClaimRow]:
    from mbsym.report.words.claims import claim_line

    for result in analysis.claims:
        line = claim_line(result)
        yield ClaimRow(line.place, line.title, line.word, line.outcome, line.lines)


def _losses(analysis: Analysis, defects: Iterable[tuple[str, NoResult]]) -> Iterable[str]:
    """What the program is at fault for."""
    yield from (joined((where, why.reason), ": ") for where, why in defects)
    for error in analysis.defects:
        yield Message("internal error: [[error]]", error=f"{type(error).__name__}: {error}".removesuffix(": "))
