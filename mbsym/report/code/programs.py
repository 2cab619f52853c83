"""The equations as a program, or why there is none."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mbsym.mechanics.programs import Programs

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


def programs_of(analysis: Analysis) -> tuple[Programs | None, str]:
    """The equations as a program, or the reason why there is none."""
    from mbsym.analysis import Unavailable

    try:
        return analysis.programs, ""
    except Unavailable as missing:
        return None, missing.failure.reason
