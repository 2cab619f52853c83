"""Sentences with gaps, as every medium fills them."""

from __future__ import annotations

#: One sentence, ``[[name]]`` for what is filled in, and what stands in its gaps.
Said = tuple[str, dict[str, object]]


def filled(said: Said) -> str:
    """A sentence with its gaps filled, in English."""
    text, values = said
    for name, value in values.items():
        text = text.replace(f"[[{name}]]", str(value))
    return text
