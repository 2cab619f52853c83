"""What is to be done with one description, what it may cost, and what comes back; rows as they are kept in files."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from msgspec import Struct, convert

from mbsym.batch.outcome import CheckRow, ClaimRow, ComplaintRow, FileRow, Outcome, ProblemRow, Row
from mbsym.expressions.message import Counted, Message
from mbsym.report.documents.base import plain

#: What a reader of foreign data has to expect.
MALFORMED = (ValueError, TypeError, KeyError, AttributeError, RecursionError)


def _messages(value: object) -> Iterator[Message]:
    """Those that stand anywhere in a row."""
    if isinstance(value, Message):
        yield value
    elif isinstance(value, tuple):
        for part in value:
            yield from _messages(part)
    elif isinstance(value, Row | Struct):
        for name in value.__annotations__:
            yield from _messages(getattr(value, name))


def _with_messages(data: Any, messages: Mapping[str, str]) -> Any:
    """The data of a row with messages in place of their English."""
    if isinstance(data, dict):
        return {name: _with_messages(part, messages) for name, part in data.items()}
    if isinstance(data, list):
        return [_with_messages(part, messages) for part in data]
    return messages.get(data, data) if isinstance(data, str) else data


def _sentence_data(said: object) -> Any:
    """A message with its gaps, so that it can be said in another language where it arrives."""
    if isinstance(said, Counted):
        return {"number": said.number, "one": said.one, "form": str(said.gaps["form"])}
    if isinstance(said, Message):
        return {"text": said.text, "gaps": {name: _sentence_data(gap) for name, gap in said.gaps.items()}}
    return str(said)


def _read_sentence(sentence: Any) -> str:
    if isinstance(sentence, str):
        return sentence
    if "number" in sentence:
        return Counted(int(sentence["number"]), str(sentence["one"]), str(sentence["form"]))
    return Message(str(sentence["text"]), **{name: _read_sentence(gap) for name, gap in sentence["gaps"].items()})


def row_data(row: Row) -> dict[str, Any]:
    """A row without what differs from batch to batch: its seconds, and whether it was up to date."""
    data: dict[str, Any] = plain(row)
    del data["seconds"], data["cached"]
    data["sentences"] = {message: _sentence_data(message) for message in _messages(row)}
    return data


def read_row(data: Mapping[str, Any]) -> Row:
    """The row of ``row_data``.  Raises one of MALFORMED where it is something else."""
    messages = {str(english): _read_sentence(part) for english, part in data["sentences"].items()}
    values = _with_messages({name: part for name, part in data.items() if name != "sentences"}, messages)
    return Row(
        file=str(values["file"]),
        folder=str(values["folder"]),
        outcome=Outcome(values["outcome"]),
        name=str(values["name"]),
        problems=convert(values["problems"], tuple[ProblemRow, ...]),
        claims=convert(values["claims"], tuple[ClaimRow, ...]),
        checks=convert(values["checks"], tuple[CheckRow, ...]),
        complaints=convert(values["complaints"], tuple[ComplaintRow, ...]),
        files=convert(values["files"], tuple[FileRow, ...]),
        message=convert(values["message"], str),
        notes=convert(values["notes"], tuple[str, ...]),
    )


# Plain data that travels, pickled: both ends have the same version.


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
    options: BatchOptions
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
