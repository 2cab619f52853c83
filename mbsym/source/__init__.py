"""Descriptions of systems as text: reading with every complaint at once, and writing back.

Two spellings of one :class:`~mbsym.model.system.System`: YAML, and the plain text of the description editor.  Text
becomes a placed tree (one reader for each spelling), the tree becomes a system (one builder for both).
"""

from mbsym.source.document import is_description, load, read
from mbsym.source.render import render, render_option
from mbsym.source.schema import json_schema
from mbsym.source.text_writer import to_text
from mbsym.source.yaml_writer import to_yaml

__all__ = ["is_description", "json_schema", "load", "read", "render", "render_option", "to_text", "to_yaml"]
