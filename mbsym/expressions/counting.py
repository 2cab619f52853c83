"""Numbers of things in words."""

from __future__ import annotations


def counted(n: int, one: str, many: str = "") -> str:
    """``1 term``, ``4 terms``; ``many`` where the plural is another than ``one`` with an s."""
    return f"{n} {one if n == 1 else many or one + 's'}"
