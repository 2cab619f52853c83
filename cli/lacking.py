"""What a scenario lacks, said once, with how to give it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mbsym.numerics.scenario import Lack


def lacking(file: Path, lack: Lack) -> str:
    """What has no value, and how to give it one."""
    lines = [f"{file}: error[contradiction]: {text}" for text in lack.contradictions]
    if lack.names:
        names = [name.split(" ")[0] for name in lack.names]
        positions = [name for name, shown in zip(names, lack.names, strict=True) if " " in shown]
        lines.append(f"{file}: error[missing-value]: no value for {', '.join(lack.names)}")
        example = " ".join(f"--set {name}=1" for name in names[:3]) + (" ..." if len(names) > 3 else "")
        places = []
        if len(positions) < len(names):
            first = next(name for name in names if name not in positions)
            places.append(f"values: {{{first}: 1, ...}}")
        if positions:
            places.append(f"initial: {{{positions[0]}: 1, ...}}")
        lines.append(f"  hint: {example}, or in the file  {'  and  '.join(places)}")
    return "\n".join([*lines, f"{file}: nothing was written."])
