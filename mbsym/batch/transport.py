"""Tasks and what becomes of them as JSON: what goes through a pipe, and rows as they are kept in files."""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import Any

from msgspec import convert, structs

from mbsym.batch.outcome import CheckRow, ClaimRow, ComplaintRow, FileRow, Outcome, ProblemRow, Row
from mbsym.expressions.message import Counted, Message
from mbsym.report.documents.base import plain

#: What a reader of foreign data has to expect.
MALFORMED = (ValueError, TypeError, KeyError, AttributeError, RecursionError)


def task_text(task: Task) -> str:
    return json.dumps(asdict(task) | {"data": base64.b64encode(task.data).decode()})


def read_task(text: str) -> Task:
    found = json.loads(text)
    asked = found["asked"]
    problems = None if asked["problems"] is None else tuple(asked["problems"])
    return Task(
        found["file"],
        found["folder"],
        base64.b64decode(found["data"]),
        BatchOptions(tuple(asked["formats"]), problems, asked["terms"], asked["angles"], asked["detail"]),
        found["known"],
    )


def finished_text(finished: Finished) -> str:
    said = [one for row in finished.row.complaints for one in (row.message, row.hint) if isinstance(one, Message)]
    return json.dumps(
        {
            "sentences": {message: _sentence_data(message) for message in said},
            "row": row_data(finished.row),
            "files": {name: _content_data(content) for name, content in finished.files.items()},
            "meaning": finished.meaning,
            "same": finished.same,
        }
    )


def read_finished(text: str | bytes) -> Finished:
    """Raises one of MALFORMED where it is something else."""
    found = json.loads(text)
    files = {str(name): _read_content(content) for name, content in found["files"].items()}
    row, said = read_row(found["row"]), {str(one): _read_sentence(data) for one, data in found["sentences"].items()}
    complaints = tuple(
        structs.replace(one, message=said.get(one.message, one.message), hint=one.hint and said.get(one.hint, one.hint))
        for one in row.complaints
    )
    return Finished(replace(row, complaints=complaints), files, str(found["meaning"]), bool(found["same"]))


def _sentence_data(said: object) -> Any:
    """A message with its gaps, so that it can be said in another language where it arrives."""
    if isinstance(said, Counted):
        return {"number": said.number, "one": said.one, "form": str(said.gaps["form"])}
    if isinstance(said, Message):
        return {"text": said.text, "gaps": {name: _sentence_data(gap) for name, gap in said.gaps.items()}}
    return str(said)


def _read_sentence(found: Any) -> str:
    if isinstance(found, str):
        return found
    if "number" in found:
        return Counted(int(found["number"]), str(found["one"]), str(found["form"]))
    return Message(str(found["text"]), **{name: _read_sentence(gap) for name, gap in found["gaps"].items()})


def _content_data(content: str | bytes) -> str | dict[str, str]:
    return content if isinstance(content, str) else {"base64": base64.b64encode(content).decode()}


def _read_content(found: Any) -> str | bytes:
    return base64.b64decode(found["base64"], validate=True) if isinstance(found, dict) else str(found)


def row_data(row: Row) -> dict[str, Any]:
    """A row without what differs from batch to batch: its seconds, and whether it was up to date."""
    found: dict[str, Any] = plain(row)
    del found["seconds"], found["cached"]
    return found


def read_row(found: Mapping[str, Any]) -> Row:
    """The row of ``row_data``.  Raises one of MALFORMED where it is something else."""
    return Row(
        file=str(found["file"]),
        folder=str(found["folder"]),
        outcome=Outcome(found["outcome"]),
        name=str(found["name"]),
        problems=convert(found["problems"], tuple[ProblemRow, ...]),
        claims=convert(found["claims"], tuple[ClaimRow, ...]),
        checks=convert(found["checks"], tuple[CheckRow, ...]),
        complaints=convert(found["complaints"], tuple[ComplaintRow, ...]),
        files=convert(found["files"], tuple[FileRow, ...]),
        message=str(found["message"]),
        notes=tuple(map(str, found["notes"])),
    )


# What is to be done with one description, what it may cost, and what comes back: plain data that travels.


@dataclass(frozen=True)
class BatchOptions:
    """What is asked of every description of a batch.

    ``problems`` None: those that the formats show.  ``angles`` is ``products``, ``sums``, ``shorter``, or None: what
    each kind of text usually has.  ``detail`` is ``compact`` or ``full``.
    """

    formats: tuple[str, ...]
    problems: tuple[int, ...] | None = None
    terms: int = 60_000
    angles: str | None = None
    detail: str = "compact"


@dataclass(frozen=True)
class Task:
    """One description: its name for complaints, its bytes as they were read once, its folder in the batch's.

    ``known`` is the digest of the description (``digests.meaning``) whose results are there already, or "": where this
    one means the same, nothing is derived.
    """

    file: str
    folder: str
    data: bytes
    asked: BatchOptions
    known: str = ""


@dataclass(frozen=True)
class Budget:
    """What one description may cost: ``seconds`` on the wall, ``memory`` in bytes; None: no bound."""

    seconds: float | None = None
    memory: int | None = None


@dataclass(frozen=True)
class Finished:
    """What became of a task: its row, and the files by their names.

    ``meaning`` is the digest of the description after normalisation, "" where it has none.  ``same`` says that it is
    the ``known`` one, so that the row holds nothing but the complaints.
    """

    row: Row
    files: Mapping[str, str | bytes] = field(default_factory=dict)
    meaning: str = ""
    same: bool = False
