"""``mbsym convert``: YAML to the editor's plain text and back; robots to YAML.

No study: what it reads may be a robot, and what it writes is a description, no result of one.
"""

from __future__ import annotations

import sys
from codecs import BOM_UTF8
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import click

from mbsym.expressions.message import Message
from mbsym.expressions.place import Complaints
from mbsym.source import read, render, to_text, to_yaml
from mbsym.studies.study import Exit
from mbsym_cli.assignments import in_scale
from mbsym_cli.console import OutPath, complain, counted, diagnose, printable, read_description, speaking
from mbsym_cli.files import write_whole
from mbsym_cli.options import Options


@click.command("convert")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--to", "spelling", type=click.Choice(["yaml", "text"]), help="Default: the other spelling.")
@click.option("--floating", is_flag=True, help="Of a robot: its first link moves freely, by six coordinates.")
@click.option("--symbols", is_flag=True, help="Of a robot: masses, lengths, moments are parameters with values.")
@click.option("--no-damping", is_flag=True, help="Of a robot: without dampers and springs of joints.")
@click.option("--no-inputs", is_flag=True, help="Of a robot: without inputs, torques or forces, in joints.")
@click.option("--joint-names", is_flag=True, help="Of a robot: coordinates are called as the joints, not q1, q2.")
@click.option(
    "--angles",
    type=click.Choice(["snap", "exact"]),
    help="Of a robot: 1.5708 is pi/2 (snap, the default; it is told), or stays the number that it is (exact).",
)
@click.option("--scale", metavar="LIST", help="In dimensionless variables: x=L*x1,t=tau/omega0,k=m*omega0**2*kappa.")
@click.option("-o", "--out", type=OutPath(path_type=Path, dir_okay=False), help="Default: standard output.")
def command(
    file: Path,
    spelling: str | None,
    floating: bool,
    symbols: bool,
    no_damping: bool,
    no_inputs: bool,
    joint_names: bool,
    angles: str | None,
    scale: str | None,
    out: Path | None,
) -> None:
    """Convert a description between YAML and the editor's plain text, or make one of a robot's URDF or MJCF.

    Between the two spellings comments are not kept; everything that has a meaning is.  Of a robot, what rigid bodies
    have no place for (contacts, sensors, ...) is left out, and listed, on the terminal and in every report; a link
    that hangs on two joints is an error.  In joints that an actuator drives, and in every joint of a URDF, which does
    not tell, the torque or force is an input, tau_NAME; joints that mimic others follow them exactly.  Links and named
    sites without mass are frames: massless bodies.

    With --scale the description is written in dimensionless variables of yours.  Left of = stands a name of FILE, right
    of it what is put in: of a coordinate, a speed or the time t a factor times its new name; of a parameter anything.
    Other new names are parameters.  New variables are pure numbers; so is a new parameter that stands once only, at a
    parameter.  Names of units (those of factors first, then the first positive ones) become 1, and what has
    a dimension still is measured in them.  The equations of both are compared exactly before anything is written.
    Names in factors are taken to be positive.  Claims, abbreviations, limits and units of measurement are left out.
    'mbsym groups' proposes such a list.

    \b
    Examples:
      mbsym convert systems/satellite.yaml --out satellite.txt
      mbsym convert robot.urdf --symbols --out robot.yaml
      mbsym convert systems/simple-pendulum.yaml --to yaml --scale "t=tau/w,J=j*m*l**2,g=l*(1+j)*w**2,b=m*l**2*w*d"
    """
    command_options = Options()
    command_options.say = speaking(file)
    if out is not None and _same(out, file):
        command_options.complain(
            "--out",
            "same-file",
            Message("[[file]] would replace what it is made of", file=printable(out)),
            "comments would be lost",
        )
    else:
        command_options.unwritten("--out", out)
    if command_options.refused(file):
        sys.exit(Exit.BAD_INPUT)
    robot = robot_text(file)
    if robot is not None:
        written = described(
            file, robot, Choices(floating, symbols, not no_damping, angles == "exact", not no_inputs, joint_names)
        )
        system = None if written is None else read(written, f"{file.stem}.yaml")[0]
    else:
        if floating or symbols or no_damping or no_inputs or joint_names or angles:
            options = "--floating, --symbols, --no-damping, --no-inputs, --joint-names, --angles"
            complain(file, Message("is no URDF or MJCF: [[options]] mean nothing here", options=options))
            sys.exit(Exit.BAD_INPUT)
        written, system = None, read_description(file)
    if system is not None and scale is not None:
        written, system = None, in_scale(system, scale, command_options)
        if command_options.refused(file):
            sys.exit(Exit.BAD_INPUT)
    if system is None:
        sys.exit(Exit.BAD_INPUT)
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
        complain(out, Message("cannot be written: [[why]]", why=error.strerror), speaking(file))
        sys.exit(Exit.FAILED)


def _same(first: Path, other: Path) -> bool:
    with suppress(OSError, ValueError):
        return first.samefile(other)
    return False


# What ``mbsym convert`` does with a robot's file: reads it, complains, and tells what is left out.


#: Of a file so many bytes are read to see what it is, and at all.
_LOOK, _MOST = 20_000, 40_000_000
#: Of angles that are read as parts of pi so many are told one by one; all of them stand in the description.
SHOWN = 3


@dataclass(frozen=True)
class Choices:
    """How a robot is described."""

    floating: bool
    symbols: bool
    damping: bool
    exact_angles: bool
    inputs: bool
    joint_names: bool


def robot_text(file: Path) -> str | None:
    """The text of a URDF or MJCF file; None of everything else, and of what cannot be read."""
    try:
        with file.open("rb") as stream:
            head = stream.read(_LOOK)
            if not head.removeprefix(BOM_UTF8).lstrip().startswith(b"<"):
                return None
            from mbsym.source.robots import is_robot  # descriptions are no XML

            if not is_robot(head.decode("utf-8", "replace")):
                return None
            data = head + stream.read(_MOST)
    except OSError:
        return None
    return data.decode("utf-8", "replace")


def _beside(file: Path, name: str) -> str | None:
    """The text of a file in the folder of another one, or in a folder in that; None where there is none."""
    folder, other = file.parent.resolve(), (file.parent / name).resolve()
    if not other.is_relative_to(folder):
        return None
    try:
        with other.open("rb") as stream:
            return stream.read(_MOST).decode("utf-8", "replace")
    except (OSError, ValueError):
        return None


def described(file: Path, text: str, choices: Choices) -> str | None:
    """The description in YAML, after saying what it leaves out; None after printing every complaint."""
    from mbsym.source.robots import convert

    complaints = Complaints()
    made = convert(
        text,
        complaints,
        choices.floating,
        choices.symbols,
        choices.damping,
        choices.exact_angles,
        choices.inputs,
        lambda name: _beside(file, name),
        choices.joint_names,
    )
    if made is not None:
        _, doubts = read(made.yaml, f"{file.stem}.yaml")
        ways: dict[str, str] = {}
        if not choices.floating:
            ways["no-coordinates"] = Message("--floating: its first link moves freely")
        if choices.symbols:
            ways["too-large"] = Message("without --symbols its numbers stand in the description")
        for doubt in doubts.sorted():  # of the description that was made: its lines are not the file's
            said = Message("the description that it gives: [[what]]", what=doubt.message)
            (complaints.error if doubt.severity == "error" else complaints.warning)(
                doubt.code, said, None, ways.get(doubt.code, doubt.hint)
            )
    for complaint in complaints.sorted():
        diagnose(render(complaint, text, str(file)))
    errors = len(complaints.errors)
    if made is None or errors:
        complain(file, counted(errors))
        return None
    for omitted in made.left_out:
        complain(file, Message("left out: [[what]]", what=printable(omitted)))
    if made.snapped:
        angles = ", ".join(map(printable, made.snapped[:SHOWN])) + (", ..." if len(made.snapped) > SHOWN else "")
        text = "angles read as parts of pi ([[count]]): [[angles]]; --angles exact leaves them as they are"
        if len(made.snapped) > SHOWN:
            text = (
                "angles read as parts of pi ([[count]]): [[angles]] (all are listed in the head of the description); "
                "--angles exact leaves them as they are"
            )
        complain(file, Message(text, count=len(made.snapped), angles=angles))
    for joint in made.still:
        complain(file, Message("held still, because it moves no inertia: [[joint]]", joint=printable(joint)))
    return made.yaml
