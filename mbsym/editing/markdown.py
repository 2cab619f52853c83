"""Texts of a description in Markdown: they show what they say, and are no picture, link, tag or emphasis."""

from __future__ import annotations

import re

_PUNCTUATION = re.compile(r"([\\`*_\[\]<>&~|!#$])")


def plain(text: str) -> str:
    r"""Text as it is; what could mean more is escaped.

    >>> plain("a*b ![x](y)")
    'a\\*b \\!\\[x\\](y)'
    """
    shown = "".join(character if character.isprintable() else " " for character in text)
    return _PUNCTUATION.sub(r"\\\1", shown)


def code(text: str) -> str:
    """A formula as code; formulas hold no backticks."""
    return f"`{text.replace('`', ' ')}`"
