"""Numbers of things, and times, in words."""

from __future__ import annotations

from mbsym.expressions.message import Message


def counted(n: int, one: str, many: str = "") -> str:
    """``1 term``, ``4 terms``; ``many`` where the plural is another than ``one`` with an s."""
    return f"{n} {one if n == 1 else many or one + 's'}"


def duration(seconds: float) -> Message:
    """``91 µs``, ``40 s``, ``3 h``, ``2.1e+03 days``."""
    if seconds < 1e-3:
        return Message("[[count]] µs", count=f"{seconds * 1e6:.3g}")
    if seconds < 1:
        return Message("[[count]] ms", count=f"{seconds * 1e3:.3g}")
    if seconds < 120:
        return Message("[[seconds]] s", seconds=f"{seconds:.3g}")
    if seconds < 7200:
        return Message("[[count]] min", count=f"{seconds / 60:.2g}")
    if seconds < 172800:
        return Message("[[count]] h", count=f"{seconds / 3600:.2g}")
    return Message("[[count]] days", count=f"{seconds / 86400:.2g}")
