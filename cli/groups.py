"""``mbsym groups``: the dimensionless groups of a system, found by themselves."""

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
    from mbsym.problems.scaling import Groups


@click.command("groups")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--out", "-o", type=OutPath(path_type=Path, dir_okay=False), help="Write the description in groups here.")
@click.option("--quiet", "-q", is_flag=True, help="Print nothing but complaints.")
def command(file: Path, out: Path | None, quiet: bool) -> None:
    """Find the dimensionless groups of FILE: what of its parameters matters, whatever the units.

    Scalings of parameters, coordinates and time that leave the equations what they are form a linear space, which is
    found exactly; no units need be declared.  As many parameters as it has dimensions are set to 1, each other one
    stands for a group then.  The first approximation of problems 5 and 6 needs fewer groups; it is told in the symbols
    of the description's notation.  Groups are products of powers: sums of parameters are left to the notation.

    With --out the description is written in its groups (YAML), for 'run', 'map', 'sweep' and all others.

    Exit codes: 0 found, 1 the equations have no closed form, or the file cannot be written, 2 something is wrong.

    \b
    Examples:
      mbsym groups systems/double-pendulum.yaml
      mbsym groups systems/spring-pendulum.yaml --out spring-in-groups.yaml
    """
    system = read_description(file, unconstrained="groups")
    asked = Options()
    asked.unwritten("--out", out)
    if asked.refused(file) or system is None:
        sys.exit(BAD_INPUT)
    from mbsym.algebra.failures import Failure
    from mbsym.analysis import Analysis
    from mbsym.problems.scaling import groups

    analysis = Analysis(system)
    try:
        with status(quiet, "deriving"):
            found = groups(analysis.scene, analysis.equations) if system.linear is None else _of_linear(analysis)
    except Failure as error:
        complain(file, f"the groups cannot be found: {error}")
        sys.exit(FAILED)
    if not quiet:
        _print(file, analysis, found)
    sys.exit(OK if out is None else _written(file, out, analysis, found))


def _print(file: Path, analysis: Analysis, found: Groups) -> None:
    from rich.text import Text

    from mbsym_cli.console import console, printable

    out = console()
    out.print(Text.assemble((analysis.system.name, "bold"), (f"  {printable(file)}", "dim")))
    sections = [("first approximation", _linear(analysis))]
    if analysis.system.linear is None:
        sections.insert(0, ("equations of motion", _told(found)))
    for title, lines in sections:
        out.print(Text.assemble("  ", (title, "bold cyan")))
        for line in lines:
            out.print(Text(f"    {line}"))


def _told(found: Groups) -> Iterator[str]:
    from mbsym.analysis.in_groups import group_of, product
    from mbsym.expressions.counting import counted
    from mbsym.expressions.tree import text

    left = counted(len(found.groups), "group", "groups")
    most = "at most " if found.unused else ""
    yield f"{counted(len(found.free), 'parameter', 'parameters')}, {len(found.units)} of them set to 1: {most}{left}"
    if found.unused:
        more = counted(found.unused, "scaling more is", "scalings more are")
        yield f"{more} not used: no other parameter is declared positive, and one that may vanish cannot be set to 1"
    if found.units:
        yield ", ".join(f"{name} = 1" for name in found.units)
    for one in found.groups:
        stands = text(group_of(one.parameter, one.powers))
        yield one.parameter if stands == one.parameter else f"{one.parameter} stands for {stands}"
    if found.rate:
        yield f"time in units of {text(product((name, -power) for name, power in found.rate))}"
    for one in found.lengths:
        yield f"{one.parameter} in units of {text(product(one.powers))}"
    if found.idle:
        yield f"without effect on the motion: {', '.join(found.idle)}"


def _of_linear(analysis: Analysis) -> Groups:
    """The groups of the first approximation.  Raises Failure where there is none in closed form."""
    from mbsym.problems.scaling import linear_groups
    from mbsym.problems.stability.problem import prepared_parts

    motion = analysis.equilibrium
    parts = prepared_parts(analysis.parameters_scene, analysis.balance, analysis.judgeable, motion, analysis.signs)
    return linear_groups(analysis.parameters_scene, [(part.ring, part.system) for part in parts])


def _linear(analysis: Analysis) -> Iterator[str]:
    from mbsym.algebra.failures import Failure

    try:
        found = _of_linear(analysis)
    except Failure as error:
        yield f"none: {error.reason}"
        return
    for line in _told(found):
        if not line.startswith("without effect"):
            yield line


def _written(file: Path, out: Path, analysis: Analysis, found: Groups) -> int:
    from mbsym.analysis.in_groups import in_groups
    from mbsym.source import read, to_yaml
    from mbsym_cli.files import write_whole

    text = to_yaml(in_groups(analysis.system, found))
    system, complaints = read(text)
    if system is None:  # what the equations do not ask of a body may be asked of its numbers
        told = complaints.sorted()[0].message
        text = to_yaml(in_groups(analysis.system, found, values=False))
        system, complaints = read(text)
        if system is not None:
            complain(file, f"values are left out of {out.name}, where they belong to no bodies: {told}")
    if system is None:
        complain(file, f"it cannot be written in groups: {complaints.sorted()[0].message}")
        return FAILED
    try:
        write_whole(out, text)
    except OSError as error:
        complain(out, f"cannot be written: {error.strerror or error}")
        return FAILED
    return OK
