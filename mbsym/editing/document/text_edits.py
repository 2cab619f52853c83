"""Primitives as edits of editor text."""

from __future__ import annotations

from mbsym.editing.document.pieces import Edit
from mbsym.editing.document.primitives import Primitive
from mbsym.editing.document.written import Data, Refused, Written


def text_edits(found: Written, primitive: Primitive, before: Data, after: Data) -> list[Edit]:
    raise Refused("not-so", "editor text is not changed here yet", "change it in the text, or convert it to YAML")
