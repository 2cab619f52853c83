"""``mbsym inverse``: the inputs that a given motion needs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from mbsym_cli.assignments import assignments, contradictions
from mbsym_cli.console import BAD_INPUT, BROKEN_DOWN, FAILED, OK, OutPath, read_description
from mbsym_cli.files import deliver, folder_for
from mbsym_cli.formulas import MOTIONS, read_formula
from mbsym_cli.lacking import missing
from mbsym_cli.options import Options
from mbsym_cli.study import attempted, leave, prevented
from mbsym_cli.telling import told

if TYPE_CHECKING:
    from mbsym.expressions.tree import Expression


@click.command("inverse")
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "--motion",
    "motions",
    multiple=True,
    metavar="NAME=FORMULA",
    help="Of a coordinate, in t; constraints may give others.",
)
@click.option("--time", "-t", "end", metavar="T", help="From 0 to T.  [required]")
@click.option("--samples", default="1001", show_default=True, metavar="N", help="Rows.")
@click.option("--set", "-s", "settings", multiple=True, metavar="NAME=VALUE", help="Replace a value; repeatable.")
@click.option("--out", "-o", type=OutPath(path_type=Path, file_okay=False), help="Folder.  [default: reports/NAME]")
@click.option("--quiet", "-q", is_flag=True, help="Print only what went wrong.")
def command(
    file: Path,
    motions: tuple[str, ...],
    end: str | None,
    samples: str,
    settings: tuple[str, ...],
    out: Path | None,
    quiet: bool,
) -> None:
    """Find the inputs of FILE with which its coordinates move as given.

    A motion is a formula in t and the parameters for every coordinate; its derivatives are exact.  With constraints it
    is enough to give that of some from which the others follow, near the initial position.  The equations are
    solved for the inputs, which must enter linearly, at every time: where there are more equations than inputs in the
    sense of least squares, and what is left of the equations is told; where there are fewer, the smallest inputs are
    taken, and that is told.

    Written are inputs.csv (t, inputs, coordinates, velocities, accelerations, what is left of each equation) and
    inputs.svg, inputs.png.  Exit codes: 0 done, 1 there are none or it was not written, 2 something is missing or
    wrong, 3 no inputs give this motion (the best ones are written), 130 interrupted.

    \b
    Example:
      mbsym inverse systems/cart-pole.yaml --motion "p=t**2/2" --motion "theta=0" --time 2
    """
    leave(file, lambda: _command(file, folder_for(file, out), motions, (end, samples), settings, quiet))


def _command(
    file: Path,
    folder: Path,
    motions: tuple[str, ...],
    texts: tuple[str | None, str],
    settings: tuple[str, ...],
    quiet: bool,
) -> int:
    """Reads everything, complains about everything, then solves."""
    from mbsym.numerics.inverse import InverseDynamics, NotLinear, inverse_dynamics
    from mbsym.numerics.scenario import Incomplete, scenario
    from mbsym.report.runs.inverse_files import inputs_csv, inputs_figure, sentences

    system, asked = read_description(file, moving="inverse"), Options()
    moved: dict[str, Expression] = {}
    time, count = asked.time(texts[0]), asked.whole("--samples", texts[1], 2, 10**6)
    overrides: dict[str, Expression] = {}
    if system is not None:
        for text in motions:
            read_formula(text, system, MOTIONS, moved, asked)
        # With constraints some may follow from the others; whether they do is seen at every time.
        for name in system.coordinates if not (system.constraints and motions) else ():
            if not any(text.partition("=")[0].strip() == name for text in motions):
                hint = f'for example --motion "{name}=0"'
                asked.complain("--motion", "missing-option", f"no motion is given for {name}", hint)
        assigned = assignments(settings, system, asked)
        overrides = dict(assigned.values)
        try:
            scenario(system, overrides, state=False)
        except Incomplete as error:
            contradictions(file, error.lack, assigned, asked)
            if error.lack.names:
                asked.complaints.append(missing(file, error.lack.names))
    code = prevented(file, folder, system is not None, asked)
    if code or system is None or time is None or count is None:
        return code or BAD_INPUT
    import numpy as np

    def work() -> InverseDynamics:
        found = inverse_dynamics(system, moved, overrides, np.linspace(0.0, time, count))
        deliver(folder, {"inputs.csv": inputs_csv(found)} | inputs_figure(found, ("svg", "png")), "inverse")
        return found

    why = "there are no inputs to be found"
    found = attempted(file, work, {NotLinear: why, ValueError: why})
    if found is None:
        return FAILED
    if not quiet:
        told(file, system.name, sentences(found), folder, ("inputs.csv", "inputs.svg", "inputs.png"))
    return OK if found.exact else BROKEN_DOWN
