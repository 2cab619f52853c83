"""What only the finished parts can show."""

from __future__ import annotations

from mbsym.model.system import System
from mbsym.source.bodies import Draft
from mbsym.source.reading import Reading


def check_body(system: System, draft: Draft, reading: Reading) -> None:
    """..."""


def check_system(system: System, reading: Reading) -> None:
    """..."""
