"""``mbsym convert``: YAML to the editor's plain text and back."""

from __future__ import annotations

import sys
from contextlib import suppress
from pathlib import Path

import click

from mbsym.source import read, to_text, to_yaml
from mbsym_cli.console import BAD_INPUT, FAILED, OutPath, complain, printable, read_description
from mbsym_cli.files import write_whole
from mbsym_cli.options import Options
from mbsym_cli.robots import Choices, described, robot_text


@click.command("convert")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--to", "spelling", type=click.Choice(["yaml", "text"]), help="Default: the other spelling.")
@click.option("--floating", is_flag=True, help="Of a robot: its first link moves freely, by six coordinates.")
@click.option("--symbols", is_flag=True, help="Of a robot: masses, lengths, moments are parameters with values.")
@click.option("--no-damping", is_flag=True, help="Of a robot: without dampers and springs of joints.")
@click.option("--no-inputs", is_flag=True, help="Of a robot: without inputs, torques or forces, in joints.")
@click.option(
    "--angles",
    type=click.Choice(["snap", "exact"]),
    help="Of a robot: 1.5708 is pi/2 (snap, the default; it is told), or stays the number that it is (exact).",
)
@click.option("--out", type=OutPath(path_type=Path, dir_okay=False), help="Default: standard output.")
def command(
    file: Path,
    spelling: str | None,
    floating: bool,
    symbols: bool,
    no_damping: bool,
    no_inputs: bool,
    angles: str | None,
    out: Path | None,
) -> None:
    """Convert a description between YAML and the editor's plain text, or make one of a robot's URDF or MJCF.

    Between the two spellings comments are not kept; everything that has a meaning is.  Of a robot, what rigid bodies
    have no place for (contacts, sensors, ...) is left out, and listed, on the terminal and in every report; a link
    that hangs on two joints is an error.  In joints that an actuator drives, and in every joint of a URDF, which does
    not tell, the torque or force is an input, tau_NAME; joints that mimic others follow them exactly.  Links and named
    sites without mass are frames: massless bodies.

    \b
    Examples:
      mbsym convert systems/satellite.yaml --out satellite.txt
      mbsym convert robot.urdf --symbols --out robot.yaml
    """
    asked = Options()
    if out is not None and _same(out, file):
        asked.complain(
            "--out", "same-file", f"{printable(out)} would replace what it is made of", "comments would be lost"
        )
    else:
        asked.unwritten("--out", out)
    if asked.refused(file):
        sys.exit(BAD_INPUT)
    robot = robot_text(file)
    if robot is not None:
        written = described(file, robot, Choices(floating, symbols, not no_damping, angles == "exact", not no_inputs))
        system = None if written is None else read(written, f"{file.stem}.yaml")[0]
    else:
        if floating or symbols or no_damping or no_inputs or angles:
            options = "--floating, --symbols, --no-damping, --no-inputs and --angles"
            complain(file, f"is no URDF or MJCF: {options} mean nothing here")
            sys.exit(BAD_INPUT)
        written, system = None, read_description(file)
    if system is None:
        sys.exit(BAD_INPUT)
    if spelling is None:
        other = ".yaml" if file.suffix == ".txt" or robot is not None else ".txt"
        spelling = "text" if (out.suffix if out is not None else other) == ".txt" else "yaml"
    text = to_text(system) if spelling == "text" else written or to_yaml(system)
    if out is None:
        click.echo(text.encode(), nl=False)  # a description is UTF-8, whatever the terminal is
        return
    try:
        write_whole(out, text)
    except OSError as error:
        complain(out, f"cannot be written: {error.strerror}")
        sys.exit(FAILED)


def _same(one: Path, other: Path) -> bool:
    with suppress(OSError, ValueError):
        return one.samefile(other)
    return False
