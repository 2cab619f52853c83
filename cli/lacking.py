"""What has no value, said once, with how to give it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from mbsym.expressions.place import Complaint
from mbsym.source import render_option
from mbsym.studies.study import missing as unfit


def missing(file: Path, shown: Sequence[str], what: str = "value") -> str:
    """One complaint about all names without a value; a coordinate is shown as ``x (its initial position)``."""
    one = unfit(shown, what)
    return render_option(Complaint(one.code, one.message, None, one.hint), "", str(file))
