"""``mbsym average``: the effective potential of a system that is shaken fast, and how good it is."""

from __future__ import annotations

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


@click.command("average")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--phase", metavar="NAME", help="The fast prescribed quantity, where there are several.")
@click.option(
    "--small", metavar="NAME", multiple=True, help="A parameter that is small, where it is not plain; repeatable."
)
@click.option("--time", metavar="T", help="How long the motions are compared.  [default: 60 periods]")
@click.option("--out", "-o", type=OutPath(path_type=Path, dir_okay=False), help="Write the averaged description here.")
@click.option("--quiet", "-q", is_flag=True, help="Print nothing but complaints.")
def command(
    file: Path, phase: str | None, small: tuple[str, ...], time: str | None, out: Path | None, quiet: bool
) -> None:
    """Average FILE over a fast phase (prescribed, its rate a parameter): Kapitza's effective potential, exactly.

    With lengths h that the phase shakes of order eps and its rate of order 1/eps, the motion is within a distance of
    order eps of one in an effective potential, for times of order 1.  What problem 6 says of that is printed; where the
    description has numbers both motions are simulated at eps, eps/2 and eps/4, and the order of their distance is
    measured.

    With --out the averaged system is written as a description of its own (YAML), for 'run', 'map', 'simulate' and all
    others.

    Exit codes: 0 found, 1 there is no such potential (the reason is given), or the file cannot be written,
    2 something is wrong.

    \b
    Examples:
      mbsym average systems/shaken-pendulum.yaml
      mbsym average systems/shaken-pendulum.yaml --out averaged.yaml
    """
    system = read_description(file, unconstrained="average")
    asked = Options()
    span = asked.number("--time", time, most=1e9)
    name = None if system is None else _phase(system, phase, asked)
    for one in small:
        if system is not None and one not in system.parameter_names:
            asked.complain("--small", "unknown-name", f"there is no parameter called {one!r}", "")
    asked.unwritten("--out", out)
    if asked.refused(None if system is None else file) or system is None or name is None:
        sys.exit(BAD_INPUT)
    from mbsym.algebra.failures import Failure
    from mbsym.analysis import Analysis
    from mbsym.analysis.averaged import averaged_system, averaging_of

    analysis = Analysis(system)
    try:
        with status(quiet, "deriving"):
            found = averaging_of(analysis, name, small)
            broken = analysis.broken(("energy",))
    except Failure as error:
        complain(file, f"it cannot be averaged: {error}")
        sys.exit(FAILED)
    if broken is not None:
        complain(file, f"it cannot be averaged: {broken.reason}")
        sys.exit(FAILED)
    averaged = averaged_system(system, found)
    if not quiet:
        _print(file, analysis, averaged, found, span)
    sys.exit(OK if out is None else _written(out, averaged))


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


def _print(file: Path, analysis: Analysis, averaged: System, found: Averaged, span: float | None) -> None:
    from rich.text import Text

    from mbsym_cli.console import console, printable

    out = console()
    out.print(Text.assemble((analysis.system.name, "bold"), (f"  {printable(file)}", "dim")))
    for line in (*_told(found), *_verdict(averaged), *_measured(analysis.system, averaged, found, span)):
        out.print(Text(f"  {line}"))


def _told(found: Averaged) -> Iterator[str]:
    yield f"fast: {found.phase}, at the rate {found.rate}; small: {', '.join(found.small)}"
    yield f"vibrational potential: {found.vibrational}"
    yield f"effective potential:   {found.potential}"


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


def _measured(system: System, averaged: System, found: Averaged, span: float | None) -> Iterator[str]:
    from mbsym.algebra.failures import Failure
    from mbsym.numerics.scenario import Incomplete
    from mbsym.report.expansion_words import too_slow
    from mbsym.simulation.averaged import measured

    try:
        with status(False, "measuring"):
            told = measured(system, averaged, found, span)
    except Incomplete:
        yield "not measured: the description does not give all numbers and an initial state"
        return
    except Failure as error:
        yield f"not measured: {error}"
        return
    parts = ("eps", "eps/2", "eps/4")
    distances = ", ".join(f"{x:.2g} at {part}" for part, x in zip(parts, told.distances, strict=True))
    yield f"measured over {told.time:.4g}: largest distance, as a part of the averaged motion: {distances}"
    orders = ", ".join(f"{x:.2f}" for x in told.orders)
    yield f"order of the distance: {orders} (1 is expected where eps is small enough)"
    if too_slow(told.orders, told.expected):
        yield "it falls more slowly than expected: eps is too large there, the time too long, or something is wrong"


def _written(out: Path, averaged: System) -> int:
    from mbsym.source import to_yaml
    from mbsym_cli.files import write_whole

    try:
        write_whole(out, to_yaml(averaged))
    except OSError as error:
        complain(out, f"cannot be written: {error.strerror or error}")
        return FAILED
    return OK
