"""Descriptions of systems as text: reading with every complaint at once, and writing back.

Two spellings of one :class:`~mbsym.model.system.System`: YAML, and the plain text of the description editor.  Text
becomes a placed tree (one reader for each spelling), the tree becomes a system (one builder for both).  Readers and
writers are imported when they are asked for: who looks whether a file is a description needs none of them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mbsym.source.render import render, render_option  # not later: its module has the name of what is in it

if TYPE_CHECKING:
    from mbsym.source.document import load, read
    from mbsym.source.schema import json_schema
    from mbsym.source.text_lines import is_description
    from mbsym.source.text_writer import to_text
    from mbsym.source.yaml_writer import to_yaml

__all__ = ["is_description", "json_schema", "load", "read", "render", "render_option", "to_text", "to_yaml"]

_PLACES = {
    "is_description": "text_lines",
    "json_schema": "schema",
    "load": "document",
    "read": "document",
    "to_text": "text_writer",
    "to_yaml": "yaml_writer",
}


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(f"{__name__}.{_PLACES[name]}"), name)
