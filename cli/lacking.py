"""What has no value, said once, with how to give it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from mbsym.expressions.safe import safe as escaped


def missing(file: Path, shown: Sequence[str], what: str = "value") -> str:
    """One complaint about all names without a value; a coordinate is shown as ``x (its initial position)``."""
    names = [name.split(" ")[0] for name in shown]
    positions = [name for name, one in zip(names, shown, strict=True) if " " in one]
    example = " ".join(f"--set {name}=1" for name in names[:3]) + (" ..." if len(names) > 3 else "")
    places = []
    if len(positions) < len(names):
        first = next(name for name in names if name not in positions)
        places.append(f"values: {{{first}: 1, ...}}")
    if positions:
        places.append(f"initial: {{{positions[0]}: 1, ...}}")
    return (
        f"{escaped(str(file))}: error[missing-value]: no {what} for {', '.join(shown)}\n"
        f"  hint: {example}, or in the file  {'  and  '.join(places)}"
    )
