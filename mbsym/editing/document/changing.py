"""Operations as edits of the text, each checked: the text after it says what it said before, with that change."""

from __future__ import annotations

import json
from collections.abc import Mapping as Map
from collections.abc import Sequence as Items
from dataclasses import fields, is_dataclass
from pathlib import Path as Folder
from typing import Any

from mbsym.editing.document.meaning import Edit, Pieces, applied
from mbsym.editing.document.operations import Meant, meant
from mbsym.editing.document.primitives import Remove, applied_to
from mbsym.editing.document.text_edits import text_edits
from mbsym.editing.document.view import complaint_view
from mbsym.editing.document.written import Data, Path, Refused, Written, data_of, original_offsets, written
from mbsym.editing.document.yaml_edits import emptied, yaml_edits
from mbsym.expressions.place import Complaint, Span
from mbsym.expressions.tree import Name
from mbsym.source.placed import MAX_TEXT, Mapping, normalised

Json = dict[str, Any]

#: So many operations are done at once.
MOST_OPERATIONS = 200


def changes(text: str, name: str, operations: Items[Map[str, Any]], folder: Folder | None = None) -> Json:
    """The edits of a text that operations mean, or why they are not done.

    ``{"edits": [{"from", "to", "insert"}], "select": path, "taken": [path], "left": [path]}`` with offsets in ``text``,
    the edits in order and none overlapping another; ``taken`` is what was taken out because it named what is gone, or
    copied with a branch, ``left`` what names such a branch and was not copied, by their paths in the text as it was.
    Otherwise ``{"complaints": [...]}``, and nothing is meant to be done: where one operation of
    several cannot be done, none is.

    An edit that would say anything else than the operation is refused (``not-so``).
    """
    document = written(text, name, False, folder)
    try:
        if len(operations) > MOST_OPERATIONS:
            raise Refused("too-large", f"at most {MOST_OPERATIONS} operations are done at once")
        if not isinstance(document.tree, Mapping) or any(flaw.code in _NOT_CHANGED for flaw in document.complaints):
            document = written(text, name, folder=folder)
            if not any(flaw.severity == "error" for flaw in document.complaints):
                raise Refused("wrong-shape", "a description is a mapping of keys to values")
            first = [flaw for flaw in document.complaints if flaw.code in _NOT_CHANGED] or document.complaints.errors
            return {"complaints": [complaint_view(document, flaw) for flaw in first]}
        pieces = Pieces(document.text)
        select: Path = ()
        taken: list[Path] = []
        left: list[Path] = []
        for operation in operations:
            if not isinstance(operation, Map):
                raise Refused("bad-operation", "an operation is a mapping with the key 'op'")
            understood = operation.get("op") in _UNDERSTANDING
            if understood and document.system is None:
                document = written(document.text, name, folder=folder)
            done = meant(document, operation)
            document = _done(document, done, pieces)
            select, taken = done.select, [*taken, *done.taken]
            left += done.left
        if applied(normalised(text), pieces.edits()) != document.text:
            raise Refused("not-so", "these operations do not go together", "do them one after another")
    except Refused as refused:
        complaint = Complaint(refused.code, refused.message, Span(1, 1), refused.hint)
        return {"complaints": [complaint_view(document, complaint) | {"from": 0, "to": 0}]}
    ends = "\r\n" if "\r\n" in text else "\r" if "\r" in text and "\n" not in text else "\n"
    offsets = original_offsets(text)
    edits = [
        {
            "from": edit.start if offsets is None else offsets[edit.start],
            "to": edit.end if offsets is None else offsets[edit.end],
            "insert": edit.insert.replace("\n", ends),
        }
        for edit in pieces.edits()
    ]
    paths = {"taken": [list(path) for path in taken], "left": [list(path) for path in left]}
    return {"edits": edits, "select": list(select), **paths}


#: What a text may not hold for operations to be done: a change of one place would be one of others.
_NOT_CHANGED = ("alias", "tag", "several-documents")

#: Operations that ask what the system is, not only what is written.
_UNDERSTANDING = ("rename", "rename body", "duplicate branch", "delete branch")


def _done(document: Written, done: Meant, pieces: Pieces) -> Written:
    """The text after one operation, checked."""
    if done.edits is not None:
        after = data_of(document.tree) if document.tree is not None else ""
        for primitive in done.primitives:
            after = applied_to(after, primitive)
        return _checked(document, done.edits, after, done, pieces)
    for primitive in done.primitives:
        assert document.tree is not None
        exact = emptied(document, primitive.path) if isinstance(primitive, Remove) else primitive
        before = data_of(document.tree)
        after = applied_to(before, exact)
        edits = text_edits(document, exact, before, after) if document.editor else yaml_edits(document, exact)
        document = _checked(document, edits, after, done, pieces)
    return document


def _checked(document: Written, edits: list[Edit], data: Data, done: Meant, pieces: Pieces) -> Written:
    """The text after edits.  Refused where it says anything else than what is wanted."""
    text = applied(document.text, edits)
    if len(text) > MAX_TEXT:
        raise Refused("too-large", f"a description has at most {MAX_TEXT} characters")
    renaming = done.edits is not None
    after = written(text, document.name, renaming and document.system is not None, document.folder)
    said = None if after.tree is None else data_of(after.tree)
    if said is None or after.editor != document.editor or not _same(said, data, document.editor):
        raise Refused("not-so", "this cannot be written here without saying something else", "change it in the text")
    if renaming and document.system is not None and not corresponds(document.system, after.system, done):
        raise Refused("not-so", "with this name the description would be another one", "take another name")
    pieces.edit(edits)
    return after


def _same(said: Data, data: Data, editor: bool) -> bool:
    """Equal, the order of keys counted; in editor text that of sections and of the lines of a block is nothing."""
    return json.dumps(_sorted(said, 0) if editor else said) == json.dumps(_sorted(data, 0) if editor else data)


def _sorted(data: Data, depth: int) -> Data:
    """Sections, and what stands in lists, in the order of the alphabet; the entries of sections as they are."""
    if not isinstance(data, dict):
        return [_in_block(entry) for entry in data] if isinstance(data, list) else data
    ordered = {key: _sorted(data[key], depth + 1) for key in (sorted(data) if depth == 0 else data)}
    for body in ordered.get("bodies", ()) if depth == 0 else ():
        if isinstance(body, dict) and body.get("inertia about", "joint") == "joint":  # goes without saying
            body.pop("inertia about", None)
    return ordered


def _in_block(data: Data) -> Data:
    if isinstance(data, list):
        return [_in_block(entry) for entry in data]
    return {key: _in_block(data[key]) for key in sorted(data)} if isinstance(data, dict) else data


def corresponds(old: Any, new: Any, done: Meant) -> bool:
    """Whether a system is another one with names put in place of others: in formulas all of them, in texts some."""
    if isinstance(old, Name) and isinstance(new, Name):
        return new.name == _renamed(old.name, done.names)
    if isinstance(old, str) and isinstance(new, str):
        return new in (old, _renamed(old, done.names), done.bodies.get(old, old)) or _reworded(old, new, done)
    if type(old) is not type(new):
        return False
    if isinstance(old, tuple | list):
        return len(old) == len(new) and all(corresponds(a, b, done) for a, b in zip(old, new, strict=True))
    if is_dataclass(old):
        pairs = (
            (getattr(old, field.name), getattr(new, field.name)) for field in fields(old) if "span" not in field.name
        )
        return all(corresponds(a, b, done) for a, b in pairs)
    return bool(old == new)


def _renamed(name: str, names: Map[str, str]) -> str:
    for ending in ("", "_dot", "_ddot", "_dddot"):  # the last one of functions of time alone
        stem = name.removesuffix(ending) if ending else name
        if stem in names and name == stem + ending:
            return names[stem] + ending
    return name


def _reworded(old: str, new: str, done: Meant) -> bool:
    """A formula that is kept as text, with the names put in."""
    from mbsym.editing.document.words import pattern

    if not done.names:
        return any(body in old for body in done.bodies) and old.replace(*next(iter(done.bodies.items()))) == new
    return pattern(list(done.names)).sub(lambda match: done.names[match[1]], old) == new
