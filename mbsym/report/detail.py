"""How much a report for people writes out: ``compact`` tells long formulas through named intermediates."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

COMPACT, FULL = "compact", "full"
DETAILS = (COMPACT, FULL)

_DETAIL: ContextVar[str] = ContextVar("detail", default=COMPACT)


def detail() -> str:
    """What is asked for here."""
    return _DETAIL.get()


@contextmanager
def detailed(wanted: str) -> Iterator[None]:
    """Within this block reports are written with so much detail."""
    token = _DETAIL.set(wanted)
    try:
        yield
    finally:
        _DETAIL.reset(token)
