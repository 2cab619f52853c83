"""Places in a description file, and complaints that point at them.

A complaint is a value, never an exception: readers collect all of them and go on.  ``Complaints`` is the list that
they collect into.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from mbsym.expressions.message import GAP, Message


@dataclass(frozen=True, slots=True, order=True)
class Span:
    """A piece of one line: 1-based line and column, ``length`` characters long (at least one is underlined)."""

    line: int
    column: int
    length: int = 1


def in_line(start: int, end: int, offset: int = 0) -> Span:
    """A piece of a text of one line, by what is before it and before its end; ``offset`` characters precede both."""
    return Span(1, offset + start + 1, max(1, end - start))


@dataclass(frozen=True, slots=True)
class Complaint:
    """What is wrong, where, and what to try next.

    ``code`` is a short stable word such as ``unknown-name``; ``severity`` is ``error`` or ``warning``; a span of
    None means that the complaint concerns the file as a whole.  ``message`` and ``hint`` are messages, in English
    wherever nobody says them in the language of the description.
    """

    code: str
    message: str
    span: Span | None = None
    hint: str | None = None
    severity: str = "error"


@dataclass(slots=True)
class Complaints:
    """Collects complaints, each once; readers append and go on.

    ``error_count`` counts every error that was reported, those that are not kept included: what was read without a new
    one is sound.
    """

    items: list[Complaint] = field(default_factory=list)
    error_count: int = 0
    _known: set[Complaint] = field(default_factory=set, repr=False)

    def __post_init__(self) -> None:
        self._known = set(self.items)
        self.error_count = len(self.errors)

    def error(self, code: str, message: str, span: Span | None = None, hint: str | None = None, **gaps: object) -> None:
        """``gaps`` are those of the message and of the hint, each in both if it stands in both."""
        self._append(Complaint(code, _with(message, gaps), span, hint and _with(hint, gaps)))

    def warning(
        self, code: str, message: str, span: Span | None = None, hint: str | None = None, **gaps: object
    ) -> None:
        self._append(Complaint(code, _with(message, gaps), span, hint and _with(hint, gaps), "warning"))

    def _append(self, complaint: Complaint) -> None:
        self.error_count += complaint.severity == "error"
        if complaint not in self._known:
            self._known.add(complaint)
            self._keep(complaint)

    def _keep(self, complaint: Complaint) -> None:
        self.items.append(complaint)

    def extend(self, others: Iterable[Complaint]) -> None:
        for other in others:
            self._append(other)

    @property
    def errors(self) -> list[Complaint]:
        return [item for item in self.items if item.severity == "error"]

    def sorted(self) -> list[Complaint]:
        """In the order of the file; what has no place comes last."""
        last = Span(2**31, 1)
        return sorted(self.items, key=lambda item: (item.span or last, item.code, item.message))

    def __iter__(self) -> Iterator[Complaint]:
        return iter(self.items)

    def __bool__(self) -> bool:
        return bool(self.items)


def _with(text: str, gaps: Mapping[str, object]) -> str:
    """A text with its gaps filled, unless it is a message already, or has none."""
    own = {name: gaps[name] for name in GAP.findall(text) if name in gaps} if not isinstance(text, Message) else {}
    return Message(text, **own) if own else text
