"""Where a batch keeps results: a folder for each description, with ``outcome.json`` beside its files.

    results are up to date  =  same derivation, same options, same description, every file as it was written

``outcome.json`` says of which derivation, options and description the files are; the folder's manifest has the digests
of all of them.  So a file that was changed, is missing, or was written by another command costs a new derivation.
"""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

from mbsym.batch import digests
from mbsym.batch.coordinator import Place
from mbsym.batch.outcome import FORMAT, ComplaintRow, Outcome, Row
from mbsym.batch.transport import MALFORMED, BatchOptions, Finished, Task, read_row, row_data
from mbsym.expressions.message import Message
from mbsym.report.targets import FORMATS
from mbsym_cli.batch.machine import Locks
from mbsym_cli.files import deliver, delivered, digest_of, obstacle, recover

#: What became of the description whose files these are.
OUTCOME = "outcome.json"

#: As the manifest calls what a batch wrote.
COMMAND = "batch"

#: No description is larger (``mbsym.source.placed.MAX_TEXT`` characters); more of a file is not read.
_MOST_BYTES = 4 * 256 * 1024 + 1


class FolderStore:
    """The ``Store`` of a batch in the folder ``out``."""

    def __init__(self, out: Path, asked: BatchOptions, derivation: str) -> None:
        self.out, self.options = out, asked
        problems = None if asked.problems is None else list(asked.problems)
        #: What results follow from besides the description.
        self._from = {
            "format": FORMAT,
            "derivation": derivation,
            "problems": problems,
            "formats": list(asked.formats),
            "terms": asked.terms,
            "angles": asked.angles,
            "detail": asked.detail,
            # What this machine lacks for a file, as a compiler, is lacking in the file, too.
            "remarks": [remark() for name in asked.formats if (remark := FORMATS[name].remark) is not None],
        }
        self._locks = Locks(out)

    def look(self, place: Place) -> Row | Task:
        data, reason = _content(Path(place.file))
        if reason:
            complaint = ComplaintRow("error", "unreadable", reason)
            return Row(place.file, place.folder, Outcome.ERRORS, complaints=(complaint,))
        folder = self.out / place.folder
        reason = obstacle(folder, self.out)
        if reason:
            return Row(place.file, place.folder, Outcome.NOT_WRITTEN, message=reason)
        outcome = self._kept(folder)
        if outcome is None:
            return Task(place.file, place.folder, data, self.options)
        if outcome["bytes"] == digests.of_bytes(data, place.file):
            try:
                row = read_row(outcome["row"])
            except MALFORMED:
                return Task(place.file, place.folder, data, self.options)
            return replace(row, file=place.file, folder=place.folder, cached=True)
        return Task(place.file, place.folder, data, self.options, known=str(outcome["meaning"]))

    def take(self, place: Place) -> bool:
        return self._locks.take(place.folder)

    def leave(self, place: Place) -> None:
        self._locks.leave(place.folder)

    def keep(self, task: Task, finished: Finished) -> Row:
        row = finished.row
        folder = self.out / task.folder
        if finished.same:
            outcome = self._kept(folder)
            if outcome is None:  # somebody has been there since
                return replace(
                    row, outcome=Outcome.NOT_WRITTEN, message=Message("its files were changed in the meantime")
                )
            row = replace(read_row(outcome["row"]), complaints=row.complaints, cached=True, seconds=row.seconds)
            row = replace(row, file=task.file, folder=task.folder)
        elif not finished.files:
            return row
        try:
            files: dict[str, str | bytes] = dict(finished.files)
            if finished.same:
                files = {file.name: (folder / file.name).read_bytes() for file in row.files}
            deliver(folder, files | {OUTCOME: self._text(task, finished.meaning, row)}, COMMAND)
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            message = Message("the files cannot be written: [[why]]", why=reason)
            return replace(row, outcome=Outcome.NOT_WRITTEN, files=(), message=message)
        return row

    def _text(self, task: Task, meaning: str, row: Row) -> str:
        """``outcome.json``; what would not be taken for finished has no description that it is up to date with."""
        bytes_ = digests.of_bytes(task.data, task.file) if row.outcome.finished else ""
        outcome = {
            **self._from,
            "bytes": bytes_,
            "meaning": meaning if bytes_ else "",
            "row": row_data(replace(row, file="", folder="")),
        }
        return json.dumps(outcome, indent=2, ensure_ascii=False) + "\n"

    def _kept(self, folder: Path) -> dict[str, Any] | None:
        """What ``outcome.json`` says, if it is about these options and every file is as it was written."""
        recover(folder)
        written = delivered(folder, COMMAND)
        if OUTCOME not in written:
            return None
        try:
            outcome: dict[str, Any] = json.loads((folder / OUTCOME).read_bytes())
            if any(outcome[key] != value for key, value in self._from.items()) or not outcome["bytes"]:
                return None
            files = {file["name"]: file["sha256"] for file in outcome["row"]["files"]}
        except (OSError, *MALFORMED):
            return None
        if files != {name: sha for name, sha in written.items() if name != OUTCOME}:
            return None
        return outcome if all(digest_of(folder / name) == sha for name, sha in written.items()) else None


def _content(path: Path) -> tuple[bytes, str]:
    """The bytes of a file, or why it cannot be read."""
    try:
        with path.open("rb") as file:
            return file.read(_MOST_BYTES), ""
    except (OSError, ValueError) as error:
        return b"", Message("the file cannot be read: [[why]]", why=getattr(error, "strerror", None) or error)
