"""``mbsym batch --appendix``: the appendices of a folder's systems as one file."""

from __future__ import annotations

import hashlib
from pathlib import Path

from mbsym.batch.outcome import Row, Summary
from mbsym_cli.files import deliver

FILENAME = "appendix.tex"

#: Whose files those about a whole batch are, in the manifest of its folder.
SUMMARY = "batch summary"


def write_appendix(out: Path, name: str, summary: Summary) -> None:
    """Joins the appendices of those descriptions that have one, in the order of the summary, into ``out/name``.

    Labels differ from system to system; what has none, as a description with errors, is named at the head.  Raises
    OSError where the file cannot be written.
    """
    from mbsym.report.latex.appendix import joined

    texts = [(row.file, _text(out, row)) for row in summary.rows]
    without = [file for file, text in texts if not text]
    head = [f"% Appendices of {len(texts) - len(without)} systems, joined by mbsym {summary.version}."]
    head += [f"% Left out, without an appendix: {_plain(file)}" for file in without]
    whole = "\n".join(head) + "\n\n" + joined([text for _, text in texts if text])
    deliver(out, {name: whole}, SUMMARY, gone=())


def _text(out: Path, row: Row) -> str:
    """A system's appendix, as it was written for this row; "" where it is not there."""
    digest = next((file.sha256 for file in row.files if file.name == FILENAME), "")
    try:
        data = (out / row.folder / FILENAME).read_bytes() if digest else b""
    except OSError:
        return ""
    return data.decode() if hashlib.sha256(data).hexdigest() == digest else ""


def _plain(words: str) -> str:
    """A path in a comment of TeX."""
    return "".join(c if c.isascii() and c.isprintable() else "?" for c in words)
