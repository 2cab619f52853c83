"""What ``mbsym oscillations`` asks of its options, and the figures that it draws."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from mbsym_cli.console import FAILED, OK, complain, console, reason_of, status
from mbsym_cli.files import deliver
from mbsym_cli.options import Options

if TYPE_CHECKING:
    from mbsym.analysis.oscillating import Oscillating
    from mbsym.model.system import System

FORMATS = ("svg", "pdf", "png")


def symbols(system: System) -> tuple[str, ...]:
    """Names that a result may have beside the parameters."""
    from mbsym.model.oscillation_names import AMPLITUDE

    variables = (*system.coordinates, *system.velocities, *system.variables)
    return (AMPLITUDE, *(f"{name}_0" for name in variables))


def check(system: System, leading: str | None, values: Mapping[str, Fraction], asked: Options) -> None:
    if system.small is None and (not system.motion or system.speeds):
        asked.complain("FILE", "missing-key", "the description names no small parameter", "add 'small parameter: eps'")
    known = (*system.coordinates, *system.velocities, *system.variables)
    if leading and leading not in known:
        asked.complain(
            "--of", "unknown-name", f"there is no variable called {leading[:60]!r}", f"one of: {', '.join(known)}"
        )
    small = system.small
    for name, value in values.items():
        if small is None:
            break
        if name == small.name or (name in dict(small.powers) and value != 0):  # zero has no power
            asked.complain("--set", "bad-assignment", f"{name} belongs to the small parameter: it stays a symbol")


@dataclass(frozen=True)
class Drawing:
    """What figures are of, and where they go; ``language``: en, ru, es."""

    file: Path
    folder: Path
    system: System
    values: Mapping[str, Fraction]
    kinds: Sequence[str]
    language: str
    quiet: bool


def drawn(asked: Drawing, found: Oscillating) -> int:
    """Draws and writes; the exit code."""
    from mbsym.algebra.failures import Failure
    from mbsym.numerics.scenario import Incomplete
    from mbsym.report.figures.oscillation_figure import oscillation_figures
    from mbsym.report.language import Language
    from mbsym.report.words.expansion_measured import DIVIDED, NO_NUMBERS
    from mbsym.simulation.oscillation_paths import oscillation_paths

    reason = ""
    try:
        with status(asked.quiet, f"{asked.file.name}: figures"):
            paths = oscillation_paths(asked.system, found, asked.values)
            files = oscillation_figures(asked.system, paths, found.found, asked.kinds, Language(asked.language))
            deliver(asked.folder, files, "oscillations")
    except Incomplete:
        reason = NO_NUMBERS
    except ZeroDivisionError:
        reason = DIVIDED
    except OSError as error:
        reason = reason_of(error)
    except (Failure, ValueError, OverflowError) as error:
        reason = str(error)
    if reason:
        complain(asked.file, f"no figures: {reason}")
        return FAILED
    if not asked.quiet:
        console().print(f"  files in {asked.folder}: {', '.join(sorted(files))}", markup=False)
    return OK
