"""Reading a whole description: which spelling it is, and what happens when it cannot be read."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from mbsym.expressions.message import Message
from mbsym.expressions.place import Complaint, Complaints, Span
from mbsym.model.system import System
from mbsym.source.builder import build
from mbsym.source.placed import MAX_TEXT, Node, TooManyComplaints, check_characters, normalised
from mbsym.source.text_lines import is_text
from mbsym.source.text_reader import read_text
from mbsym.source.yaml_reader import Extent, read_yaml

#: What cannot be read at all: whatever else is complained of at its place follows from that.
_UNREAD = ("tag", "control-character")

#: So many complaints are shown, in all and of one kind; when so many were met, reading stops.
MAX_COMPLAINTS = 200
MAX_OF_A_KIND = 40
MAX_MET = 500


class _BoundedComplaints(Complaints):
    """Keeps the first complaints of each kind and counts the others; stops where everything is wrong."""

    def __init__(self) -> None:
        super().__init__()
        self.kept: Counter[tuple[str, str]] = Counter()
        self.more: Counter[tuple[str, str]] = Counter()
        self.unread: set[tuple[int, int]] = set()

    def _keep(self, complaint: Complaint) -> None:
        place = (0, 0) if complaint.span is None else (complaint.span.line, complaint.span.column)
        if complaint.code in _UNREAD:
            self.unread.add(place)
        elif place in self.unread:
            return
        kind = complaint.severity, complaint.code
        if self.kept[kind] < MAX_OF_A_KIND:
            self.kept[kind] += 1
            super()._keep(complaint)
        else:
            self.more[kind] += 1
        if len(self.items) >= MAX_COMPLAINTS or self.more.total() + len(self.items) >= MAX_MET:
            raise TooManyComplaints

    def rest(self, stopped: bool) -> Iterator[Complaint]:
        """A complaint about the file for each kind that was cut off, and for what was not read any more."""
        for (severity, code), count in sorted(self.more.items()):
            yield Complaint(
                "too-many",
                Message("and [[count]] more of the kind [[code]]", count=count, code=code),
                severity=severity,
            )
        if stopped and len(self.items) + self.more.total() >= MAX_COMPLAINTS:
            yield Complaint(
                "too-many",
                Message("with [[items]] complaints reading was given up", items=len(self.items) + self.more.total()),
            )


def read(text: str, filename: str = "<string>", folder: Path | None = None) -> tuple[System | None, Complaints]:
    """The system that a text describes, or None, with all complaints; warnings may stand beside a system.

    The text itself tells its spelling; where it does not, a name ending in ``.txt`` means editor text.  Files that it
    names are looked for in ``folder``.
    """
    read_result = read_placed(text, filename, folder)
    return read_result.system, read_result.complaints


@dataclass(frozen=True, slots=True)
class ReadResult:
    """What reading gives: ``tree`` is what the text says before it is understood, ``editor`` whether in editor text."""

    system: System | None
    complaints: Complaints
    tree: Node | None
    editor: bool


def read_placed(
    text: str,
    filename: str = "<string>",
    folder: Path | None = None,
    extents: dict[int, Extent] | None = None,
    understand: bool = True,
) -> ReadResult:
    """The same with the placed tree, and where each node of a YAML text stands.

    ``understand`` False: the tree alone.
    """
    text = normalised(text)
    complaints = _BoundedComplaints()
    system, node, editor, stopped = None, None, False, False
    try:
        if check_characters(text, complaints) and not _is_xml(text, complaints):
            editor = is_text(text, filename)
            node = read_text(text, complaints) if editor else read_yaml(text, complaints, extents)
            if node is not None and understand:
                system = build(node, complaints, editor=editor, folder=folder)
    except TooManyComplaints:
        system, stopped = None, True
    return ReadResult(system, Complaints([*complaints.sorted(), *complaints.rest(stopped)]), node, editor)


def _is_xml(text: str, complaints: Complaints) -> bool:
    """Whether a text is a robot's file, which is complained about: nothing of it can be read as a description."""
    before = text[: len(text) - len(text.lstrip())]
    if not text[len(before) :].startswith("<"):
        return False
    span = Span(before.count("\n") + 1, len(before) - (before.rfind("\n") + 1) + 1)
    hint = "a robot's file (URDF, MJCF) is made into one by 'mbsym convert FILE --symbols --out robot.yaml'"
    complaints.error("xml", "this is XML, not a description", span, hint)
    return True


def placed_tree(text: str, filename: str = "<string>") -> tuple[Node | None, bool]:
    """What a description says, before anything of it is understood: its tree of keys and values, or None.

    And whether it is in the spelling of the editor, in which some things go without saying.
    """
    text = normalised(text)
    complaints = _BoundedComplaints()
    with suppress(TooManyComplaints):
        if check_characters(text, complaints):
            return _placed_tree(text, filename, complaints)
    return None, False


def _placed_tree(text: str, filename: str, complaints: Complaints) -> tuple[Node | None, bool]:
    editor = is_text(text, filename)
    return (read_text if editor else read_yaml)(text, complaints), editor


def load(path: str | Path) -> tuple[System | None, Complaints, str]:
    """Read a file: the system or None, the complaints, and the text that they point into."""
    data, complaint = file_bytes(Path(path))
    return (
        (None, Complaints([complaint]), "") if complaint is not None else load_bytes(data, str(path), Path(path).parent)
    )


def load_bytes(data: bytes, filename: str, folder: Path | None = None) -> tuple[System | None, Complaints, str]:
    """What ``load`` gives of a file with this content; without its ``folder`` it can name no other files."""
    text, complaint = _decoded(data)
    if complaint is not None:
        return None, Complaints([complaint]), text
    system, complaints = read(text, filename, folder)
    return system, complaints, text


def file_bytes(path: Path) -> tuple[bytes, Complaint | None]:
    """The content of a file (no more of it than shows that it is too large), or why it cannot be read."""
    try:
        with path.open("rb") as file:
            return file.read(4 * MAX_TEXT + 1), None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        hint = Message("a value is set by  --set [[value]]", value=path.name) if "=" in path.name else None
        return b"", Complaint("unreadable", Message("the file cannot be read: [[reason]]", reason=reason), hint=hint)


def _decoded(data: bytes) -> tuple[str, Complaint | None]:
    if len(data) > 4 * MAX_TEXT:
        return "", Complaint("too-large", Message("a description has at most [[most]] characters", most=MAX_TEXT))
    if b"\0" in data:
        message = "this is a binary file, or a text in UTF-16: the character U+0000 stands here"
        place = _place(data, data.index(b"\0"))
        return data.decode("utf-8", "replace"), Complaint("unreadable", message, place, "save it as UTF-8")
    try:
        return data.decode("utf-8"), None
    except UnicodeDecodeError as error:
        message = Message("the file is not UTF-8 text (byte [[start]])", start=error.start)
        place = _place(data, error.start)
        return data.decode("utf-8", "replace"), Complaint("not-utf8", message, place, "save it as UTF-8")


def _place(data: bytes, start: int) -> Span:
    """Line and column of a byte, in characters as far as it is UTF-8."""
    line_start = data.rfind(b"\n", 0, start) + 1
    return Span(data.count(b"\n", 0, start) + 1, len(data[line_start:start].decode("utf-8", "replace")) + 1)
