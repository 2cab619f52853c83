"""Descriptions of systems as text: reading with every complaint at once, and writing back.

Two spellings of one :class:`~mbsym.model.system.System`: YAML, and the plain text of the description editor.  Text
becomes a placed tree (one reader for each spelling), the tree becomes a system (one builder for both).
"""

from mbsym.source.document import load, read
from mbsym.source.render import render

__all__ = ["load", "read", "render"]
