"""What a text means, as JSON values for the page: pure functions of the text, places in units of UTF-16."""

from __future__ import annotations

import hashlib
import json
import re
from bisect import bisect_right
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from mbsym.editing import explanation, place, suggestions
from mbsym.editing.document import look
from mbsym.editing.document.view import content, math, moved, told
from mbsym.expressions.place import Complaint, Complaints, Span
from mbsym.source import read, to_text, to_yaml
from mbsym.source.starter import NewBody, starter
from mbsym.source.text_lines import is_text, says_so

if TYPE_CHECKING:
    from mbsym.model.system import System

#: A word that is completed, up to the place where one types.
_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*\Z")
_FILE = re.compile(r"\bfile\b", re.IGNORECASE)

#: Longer formulas are not shown as they are typed.
MOST_FORMULA = 5_000


def spelling(text: str, name: str) -> str:
    return "text" if is_text(text, name) else "yaml"


def empty(name: str, stem: str) -> str:
    """The description that a new file begins with."""
    called = _called(stem)
    if name.lower().endswith(".txt"):
        return f"Mechanical system: {called}\n"
    return f"mbsym: 1\nname: {called}\nbodies: []\n"


def _called(stem: str) -> str:
    return re.sub(r"[^A-Za-z0-9 ._-]", " ", stem).strip() or "mechanism"


def one_body(stem: str, joint: str) -> str:
    """The description of one body on a joint of ``starter.JOINTS``."""
    try:
        return starter(_called(stem).capitalize(), [NewBody("body", None, joint)])
    except ValueError as error:
        raise Wrong(str(error)) from error


def pasted(text: str) -> str:
    """A description as it is; a robot (URDF, MJCF) as the description that it becomes, with symbols."""
    if not text.lstrip().startswith("<"):
        if not says_so(text):
            raise Wrong("it begins neither with  mbsym: 1  or  Mechanical system: NAME  nor with  <")
        return text
    from mbsym.source.robots import convert

    complaints = Complaints()
    made = convert(text, complaints, symbols=True)
    if made is None:
        raise Wrong("; ".join(complaint.message for complaint in complaints.sorted()))
    return str(made.yaml)


def understood(text: str, name: str, folder: Path | None) -> tuple[System | None, list[Complaint]]:
    """The system, or None, and everything that is wrong with the text, in its order."""
    if not says_so(text):
        return None, [Complaint("no-description", "a description begins with  mbsym: 1  or  Mechanical system: NAME")]
    system, complaints = read(text, name, folder)
    return system, list(complaints.sorted())


def view(text: str, name: str, folder: Path | None) -> dict[str, Any]:
    """The View of the seam: bodies, ties, the tree as written, complaints; ``content`` is that of ``content_of``."""
    places = Offsets(text)
    shown: dict[str, Any] = places.in_units(look(text, name))
    shown["content"] = content_of(shown)
    if not says_so(text) or _FILE.search(text):  # what a file beside the description holds is part of what it means
        shown["complaints"] = complaints_json(understood(text, name, folder)[1], places)
    return shown


def content_of(shown: Mapping[str, Any]) -> str | None:
    """Another one whenever the text says something else; the same where only comments, blanks and line ends differ.

    SHA-256 of the keys and values as spelled, in their order.  None where the text cannot be read as a whole: what is
    left out of the tree then could say anything.
    """
    if shown["tree"] is None or any(complaint["severity"] == "error" for complaint in shown["complaints"]):
        return None
    digest = hashlib.sha256(str(shown["format"]).encode())
    waiting = [shown["tree"]]
    while waiting:
        node = waiting.pop()
        item = [node["kind"], node["path"], node.get("source")]
        digest.update(json.dumps(item, ensure_ascii=True).encode() + b"\n")
        waiting += node.get("children", ())
    return digest.hexdigest()


def changed(text: str, name: str, operations: list[Any], folder: Path | None) -> dict[str, Any]:
    """What text edits operations mean, or why they mean none."""
    from mbsym.editing.document import changes

    edits: dict[str, Any] = Offsets(text).in_units(changes(text, name, operations, folder))
    return edits


def complaints_json(complaints: list[Complaint], places: Offsets) -> list[dict[str, Any]]:
    """Complaints of the seam."""
    spans = [complaint.span or Span(1, 1, 0) for complaint in complaints]
    return [
        told(complaint, *places.of_span(span), span.line, span.column)
        for complaint, span in zip(complaints, spans, strict=True)
    ]


def completed(text: str, offset: int, system: System | None) -> dict[str, Any]:
    """What may stand at a place, and from where on it replaces what is typed."""
    places = Offsets(text)
    before = text[: places.characters(offset)]
    start = before.rfind("\n") + 1
    word = _WORD.search(before)
    proposals = suggestions(text, before.count("\n"), len(before) - start, system)
    items = [
        {
            "label": suggestion.label,
            "kind": suggestion.kind,
            "detail": suggestion.kind,
            "insert": suggestion.insert or suggestion.label,
            "documentation": suggestion.meaning,
        }
        for suggestion in proposals
    ]
    return {"from": places.units(word.start() if word else len(before)), "items": items}


def word_at(text: str, offset: int) -> tuple[int, int, int, int]:
    """Line and column (from 0, in characters) of a place, and the word around it in units."""
    places = Offsets(text)
    at = places.characters(offset)
    line, begin = text.count("\n", 0, at), text.rfind("\n", 0, at) + 1
    _, start, end = place.word_at(text[begin:].partition("\n")[0], at - begin)
    return line, at - begin, places.units(begin + start), places.units(begin + end)


def hovered(text: str, offset: int) -> dict[str, Any] | None:
    """What a word means as far as the reader's tables tell; nothing is derived for it."""
    line, column, start, end = word_at(text, offset)
    markdown = explanation(text, line, column)
    return None if markdown is None else {"from": start, "to": end, "markdown": markdown}


def converted(text: str, name: str, to: str, folder: Path | None) -> dict[str, Any]:
    """The description in the other spelling, or the complaints for which there is none."""
    system, complaints = understood(text, name, folder)
    if system is None or any(complaint.severity == "error" for complaint in complaints):
        return {"complaints": complaints_json(complaints, Offsets(text))}
    return {"text": to_text(system) if to == "text" else to_yaml(system)}


def typed_formula(source: str) -> dict[str, Any]:
    """MathML of a formula as it is typed, or what is wrong with it."""
    from mbsym.expressions.parser import parse_expression

    wrong = Complaints()
    if len(source) > MOST_FORMULA:
        wrong.error("too-long", f"a formula that is shown has at most {MOST_FORMULA} characters")
        tree = None
    else:
        tree = parse_expression(" ".join(source.split()), wrong)
    if tree is None or wrong.errors:
        listed = complaints_json(wrong.sorted(), Offsets(source))
        return {"complaint": listed[0] if listed else None}
    return {"mathml": math(content(tree))}


class Offsets:
    """Of one text.  Characters beyond the basic plane are two units each; a place amid the two is that of the first."""

    def __init__(self, text: str) -> None:
        self.text = text
        self._wide = [] if text.isascii() else [place for place, x in enumerate(text) if ord(x) > 0xFFFF]
        self._wide_units = [place + k for k, place in enumerate(self._wide)]
        self._lines: list[int] | None = None

    def units(self, characters: int) -> int:
        """How many units come before a place in characters."""
        inside = min(max(characters, 0), len(self.text))
        return inside + bisect_right(self._wide, inside - 1)

    def characters(self, units: int) -> int:
        """The inverse of ``units``."""
        before = bisect_right(self._wide_units, units - 1)
        if before and self._wide_units[before - 1] == units - 1:  # amid a pair
            units -= 1
            before -= 1
        return min(max(units - before, 0), len(self.text))

    def line_start(self, line: int) -> int:
        """In characters; lines count from 1 and end at ``\\n``.  What is behind the last is the end."""
        if self._lines is None:
            self._lines = [0, *(place + 1 for place, x in enumerate(self.text) if x == "\n")]
        return self._lines[line - 1] if 0 < line <= len(self._lines) else len(self.text)

    def of_span(self, span: Span) -> tuple[int, int]:
        """From and to, in units."""
        start = self.line_start(span.line) + span.column - 1
        return self.units(start), self.units(start + span.length)

    def in_units(self, value: Any) -> Any:
        """A JSON value whose places are in characters, with units."""
        return moved(value, self.units) if self._wide else value


# What a request holds, taken out of JSON that anybody may have written.


T = TypeVar("T")


class Wrong(Exception):
    """A request that is not of the form that was agreed upon; with words."""


def text_of(body: Mapping[str, Any], name: str = "text") -> str:
    """Raises Wrong where it is no text, here and below."""
    text = body.get(name)
    if not isinstance(text, str):
        raise Wrong(f"{name} is a text")
    return text


def flag(body: Mapping[str, Any], name: str) -> bool:
    """False where it is left out."""
    value = body.get(name, False)
    if not isinstance(value, bool):
        raise Wrong(f"{name} is true or false")
    return value


def whole(body: Mapping[str, Any], name: str) -> int:
    """A number from 0 on."""
    number = body.get(name)
    if type(number) is not int or number < 0:
        raise Wrong(f"{name} is a whole number from 0 on")
    return number


def listed(body: Mapping[str, Any], name: str, kind: type[T]) -> list[T]:
    """Of at most a thousand of a kind."""
    values = body.get(name)
    if not isinstance(values, list) or len(values) > 1000 or any(type(x) is not kind for x in values):
        raise Wrong(f"{name} is a list")
    return values


def mapping(body: Mapping[str, Any], name: str) -> dict[str, str]:
    """Names with short texts; numbers become texts.  Empty where it is left out."""
    entries = body.get(name)
    if entries is None:
        return {}
    kinds = (str, int, float)
    if not isinstance(entries, dict) or len(entries) > 1000 or any(type(x) not in kinds for x in entries.values()):
        raise Wrong(f"{name} has names with numbers")
    return {key: str(value)[:200] for key, value in entries.items()}
