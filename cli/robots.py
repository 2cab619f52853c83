"""What ``mbsym convert`` does with a robot's file: reads it, complains, and tells what is left out."""

from __future__ import annotations

import sys
from codecs import BOM_UTF8
from dataclasses import dataclass
from pathlib import Path

from mbsym.expressions.counting import counted
from mbsym.expressions.place import Complaints
from mbsym.source import read, render
from mbsym_cli.console import complain, diagnose, printable

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
    )
    if made is not None:
        _, doubts = read(made.yaml, f"{file.stem}.yaml")
        for doubt in doubts.sorted():  # of the description that was made: its lines are not the file's
            said = f"the description that it gives: {doubt.message}"
            (complaints.error if doubt.severity == "error" else complaints.warning)(doubt.code, said, None, doubt.hint)
    for complaint in complaints.sorted():
        diagnose(render(complaint, text, str(file)))
    errors = len(complaints.errors)
    if made is None or errors:
        complain(file, f"{counted(errors, 'error', 'errors')}; nothing was written.")
        return None
    for told in made.left_out:
        print(f"{printable(file)}: left out: {printable(told)}", file=sys.stderr)
    if made.snapped:
        several = len(made.snapped) > 1
        count = f"{counted(len(made.snapped), 'printed angle')} {'are' if several else 'is'} read as"
        parts = "parts" if several else "a part"
        first = ", ".join(map(printable, made.snapped[:SHOWN])) + (", ..." if len(made.snapped) > SHOWN else "")
        where = " (all are listed in the head of the description)" if len(made.snapped) > SHOWN else ""
        complain(file, f"{count} {parts} of pi: {first}{where}; --angles exact leaves them as they are")
    for joint in made.still:
        print(f"{printable(file)}: held still, because it moves no inertia: {printable(joint)}", file=sys.stderr)
    return made.yaml
