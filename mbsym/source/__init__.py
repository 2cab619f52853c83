"""Descriptions of systems as text: reading with every complaint at once, and writing back.

Two spellings of one :class:`~mbsym.model.system.System`: YAML, and the plain text of the description editor.  Text
becomes a placed tree (one reader for each spelling), the tree becomes a system (one builder for both).  What writes is
imported when it is asked for.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mbsym.source.document import is_description, load, read
from mbsym.source.render import render, render_option

if TYPE_CHECKING:
    from mbsym.source.schema import json_schema
    from mbsym.source.text_writer import to_text
    from mbsym.source.yaml_writer import to_yaml

__all__ = ["is_description", "json_schema", "load", "read", "render", "render_option", "to_text", "to_yaml"]

_WRITERS = {"json_schema": "schema", "to_text": "text_writer", "to_yaml": "yaml_writer"}


def __getattr__(name: str) -> Any:
    if name not in _WRITERS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(f"{__name__}.{_WRITERS[name]}"), name)
