"""``mbsym average``: the effective potential of a system that is shaken fast, and how good it is."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mbsym_cli.console import BAD_INPUT, FAILED, OK, OutPath, complain, read_description, status
from mbsym_cli.options import Options

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.model.system import System
    from mbsym.problems.averaging import Averaged
    from mbsym.simulation.averaged import Measured


@click.command("average")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--phase", metavar="NAME", help="The fast prescribed quantity, where there are several.")
@click.option("--small", metavar="NAME", multiple=True, help="The same as --order NAME=1; repeatable.")
@click.option(
    "--order",
    "orders",
    metavar="NAME=POWER",
    multiple=True,
    help="Of which power of eps an amplitude of the phase is, as -1 for a force that is as large as the rate; where it "
    "is not plain; all amplitudes have to be named then; repeatable.",
)
@click.option("--time", metavar="T", help="How long the motions are compared.  [default: 60 periods]")
@click.option("--out", "-o", type=OutPath(path_type=Path, dir_okay=False), help="Write the averaged description here.")
@click.option("--quiet", "-q", is_flag=True, help="Print nothing but complaints.")
def command(
    file: Path,
    phase: str | None,
    small: tuple[str, ...],
    orders: tuple[str, ...],
    time: str | None,
    out: Path | None,
    quiet: bool,
) -> None:
    """Average FILE over a fast phase (prescribed, its rate a parameter): Kapitza's effective potential, exactly.

    With the rate of order 1/eps, lengths h that the phase shakes of order eps (--order h=1) and forces of zero mean of
    order 1/eps (--order v=-1), the motion is within a distance of order eps of one in an effective potential, for times
    of order 1.  The orders are printed with the result: it holds for them only.  What problem 6 says of that is
    printed; where the description has numbers both motions are simulated at eps, eps/2 and eps/4, and the order of
    their distance is measured: where that contradicts the result, it is withdrawn.

    With --out the averaged system is written as a description of its own (YAML), for 'run', 'map', 'simulate' and all
    others.

    Exit codes: 0 found, 1 there is no such potential or it is withdrawn (the reason is given), or the file cannot be
    written,
    2 something is wrong.

    \b
    Examples:
      mbsym average systems/shaken-pendulum.yaml
      mbsym average systems/shaken-pendulum.yaml --order h=1 --out averaged.yaml
    """
    system = read_description(file, unconstrained="average")
    asked = Options()
    span = asked.number("--time", time, most=1e9)
    name = None if system is None else _phase(system, phase, asked)
    powers = _powers(small, orders, system, asked)
    asked.unwritten("--out", out)
    if asked.refused(None if system is None else file) or system is None or name is None:
        sys.exit(BAD_INPUT)
    from mbsym.algebra.failures import Failure
    from mbsym.analysis import Analysis
    from mbsym.analysis.averaged import averaged_system, averaging_of
    from mbsym.report.words.expansion_measured import average_or_why, contradicts

    analysis = Analysis(system)
    try:
        with status(quiet, "deriving"):
            found = averaging_of(analysis, name, powers)
            broken = analysis.broken(("energy",))
    except Failure as error:
        complain(file, f"it cannot be averaged: {error}{f' ({error.remedy})' if error.remedy else ''}")
        sys.exit(FAILED)
    if broken is not None:
        complain(file, f"it cannot be averaged: {broken.reason}")
        sys.exit(FAILED)
    averaged = averaged_system(system, found)
    with status(quiet, "measuring"):
        told = average_or_why(system, averaged, found, span)
    if contradicts(told):
        distances = "; ".join(_measured(told))
        complain(file, f"the result is withdrawn ({found.scaling}): {distances}")
        sys.exit(FAILED)
    if not quiet:
        _print(file, analysis, averaged, found, told)
    sys.exit(OK if out is None else _written(out, averaged))


def _powers(small: tuple[str, ...], orders: tuple[str, ...], system: System | None, asked: Options) -> dict[str, int]:
    """The powers of eps that are named."""
    powers = {}
    for option, text in (*(("--small", f"{one}=1") for one in small), *(("--order", one) for one in orders)):
        name, _, power = (part.strip() for part in text.partition("="))
        if not re.fullmatch(r"[+-]?[0-9]", power):
            asked.complain(option, "bad-value", f"{text!r} is no NAME=POWER with a whole power", "as in  v=-1")
        elif system is not None and name not in system.parameter_names:
            asked.complain(option, "unknown-name", f"there is no parameter called {name!r}", "")
        else:
            powers[name] = int(power)
    return powers


def _phase(system: System, phase: str | None, asked: Options) -> str | None:
    from mbsym.analysis.averaged import fast_phases

    known = fast_phases(system)
    if phase is None and len(known) == 1:
        return known[0]
    listed = ", ".join(known) or "none"
    if phase is None:
        hint = "name one of them" if known else "prescribed: {phi: {rate: nu}}, nu a parameter"
        message = f"prescribed quantities whose rate is a parameter: {listed}"
        asked.complain("--phase", "no-phase", message, hint)
    elif phase not in known:
        asked.complain(
            "--phase", "unknown-name", f"{phase!r} is no prescribed quantity whose rate is a parameter", listed
        )
    return phase if phase in known else None


def _print(file: Path, analysis: Analysis, averaged: System, found: Averaged, told: Measured | str) -> None:
    from rich.text import Text

    from mbsym_cli.console import console, printable

    out = console()
    out.print(Text.assemble((analysis.system.name, "bold"), (f"  {printable(file)}", "dim")))
    for line in (*_told(found), *_verdict(averaged), *_measured(told)):
        out.print(Text(f"  {line}"))


def _told(found: Averaged) -> Iterator[str]:
    yield f"fast: {found.phase}; {found.scaling}"
    yield f"vibrational potential: {found.vibrational}"
    yield f"effective potential:   {found.potential}"
    if found.beside:
        yield f"beside it act the forces on {', '.join(found.beside)} that have no force function here, as they did"


def _verdict(averaged: System) -> Iterator[str]:
    from mbsym.analysis import Analysis
    from mbsym.report.sections.stability import lines

    about = Analysis(averaged, (6,))
    stage = about.stage(6)
    if stage.failure is not None:
        hint = f" ({stage.failure.hint})" if stage.failure.hint else ""
        yield f"stability of the averaged motion: no result: {stage.failure.reason}{hint}"
        return
    yield "stability of the averaged motion, not of the motion itself (problem 6):"
    yield from (f"  {line}" for line in lines(stage.value, about))


def _measured(told: Measured | str) -> Iterator[str]:
    if isinstance(told, str):
        yield f"not measured: {told}"
        return
    parts = ("eps", "eps/2", "eps/4")
    distances = ", ".join(f"{x:.2g} at {part}" for part, x in zip(parts, told.distances, strict=True))
    yield f"measured over {told.time:.4g}: largest distance, as a part of the averaged motion: {distances}"
    orders = ", ".join(f"{x:.2f}" for x in told.orders)
    yield f"order of the distance: {orders} (1 is expected where eps is small enough)"


def _written(out: Path, averaged: System) -> int:
    from mbsym.source import to_yaml
    from mbsym_cli.files import write_whole

    try:
        write_whole(out, to_yaml(averaged))
    except OSError as error:
        complain(out, f"cannot be written: {error.strerror or error}")
        return FAILED
    return OK
