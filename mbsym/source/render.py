"""A complaint as text: where, what, the line with the piece underlined, a hint."""

from __future__ import annotations

from collections.abc import Callable

from mbsym.expressions.message import Message, worded
from mbsym.expressions.place import Complaint, Span
from mbsym.expressions.safe import safe
from mbsym.source.placed import normalised

_WIDTH = 120

#: What the command line shows of file names and options.
escaped = safe

_ELLIPSIS = "..."


def _said(text: str) -> str:
    return text


def render(complaint: Complaint, text: str, filename: str, say: Callable[[str], str] = _said) -> str:
    """One complaint for a terminal or a log; ``text`` is the text of the file it is about, ``say`` its language.

    Control characters of the file are shown escaped, and of a long line only the piece around the complaint.
    """
    head = f"{complaint.severity}[{complaint.code}]: {safe(say(complaint.message))}"
    if complaint.span is None:
        parts = [f"{safe(filename)}: {head}"]
    else:
        parts = [f"{safe(filename)}:{complaint.span.line}:{complaint.span.column}: {head}"]
        parts += _underlined(complaint.span, normalised(text).split("\n"))
    if complaint.hint:
        parts.append(f"  {safe(say(Message('hint: [[hint]]', hint=worded(complaint.hint))))}")
    return "\n".join(parts)


def render_option(complaint: Complaint, text: str, option: str, say: Callable[[str], str] = _said) -> str:
    """One complaint about a value on the command line, which stands in no file; ``text`` is that line."""
    parts = [f"{safe(option)}: {complaint.severity}[{complaint.code}]: {safe(say(complaint.message))}"]
    if complaint.span is not None:
        before, piece, after = _window(normalised(text).split("\n")[0], complaint.span)
        parts += [f"  | {before}{piece}{after}".rstrip(), f"  | {' ' * len(before)}{'^' * max(1, len(piece))}"]
    if complaint.hint:
        parts.append(f"  {safe(say(Message('hint: [[hint]]', hint=worded(complaint.hint))))}")
    return "\n".join(parts)


def _underlined(span: Span, lines: list[str]) -> list[str]:
    if not 1 <= span.line <= len(lines):
        return []
    before, piece, after = _window(lines[span.line - 1], span)
    gutter = str(span.line).rjust(4)
    blank = " " * len(gutter)
    return [f"{gutter} | {before}{piece}{after}".rstrip(), f"{blank} | {' ' * len(before)}{'^' * max(1, len(piece))}"]


def _window(line: str, span: Span) -> tuple[str, str, str]:
    """The text before, under and after the underlining, escaped, cut to a bearable width."""
    start = min(span.column - 1, len(line))
    before, piece, after = (
        safe(line[:start]),
        safe(line[start : start + span.length]),
        safe(line[start + span.length :]),
    )
    if len(before) + len(piece) + len(after) <= _WIDTH:
        return before, piece, after
    if len(piece) > _WIDTH // 2:
        piece = piece[: _WIDTH // 2 - len(_ELLIPSIS)] + _ELLIPSIS
    room = (_WIDTH - len(piece)) // 2
    if len(before) > room:
        before = _ELLIPSIS + before[len(_ELLIPSIS) - room :]
    if len(after) > room:
        after = after[: room - len(_ELLIPSIS)] + _ELLIPSIS
    return before, piece, after
