"""``mbsym check``: validates descriptions without deriving anything.

No study: complaints are what it finds, of many files, where a study has nothing to say once there is one.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

import mbsym
from mbsym.expressions.message import Message
from mbsym.report.language import Language
from mbsym.source import is_description, load
from mbsym.studies.study import Exit
from mbsym_cli.console import asked_width, defect, printable, read_description, speaking, wrapped
from mbsym_cli.options import Options

if TYPE_CHECKING:
    from mbsym.model.system import System

#: How complaints are written: for people, or for a program that reads them on standard output.
OUTPUT_FORMATS = ("text", "github", "sarif", "json")

#: Of more wrong descriptions only how many there are stands in the last line.
MOST_NAMED = 5


@click.command("check")
@click.argument("files", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="FILE...")
@click.option(
    "--output-format",
    type=click.Choice(OUTPUT_FORMATS),
    default="text",
    show_default=True,
    help="github: annotations of a workflow; sarif: a log for code scanning; json: an object a line.",
)
@click.option("--skip-others", is_flag=True, help="Pass over files that do not say they are descriptions.")
def command(files: tuple[Path, ...], output_format: str, skip_others: bool) -> None:
    """Validate descriptions, those in folders too, without deriving anything.

    Prints every complaint with its place; the exit code is 2 if there is an error.

    \b
    Examples:
      mbsym check systems/*.yaml
      mbsym check systems --output-format sarif > mbsym.sarif
      mbsym check --skip-others docker-compose.yaml systems/top.yaml
    """
    if skip_others:
        files = tuple(file for file in files if file.is_dir() or not os.access(file, os.R_OK) or is_description(file))
    if not files:
        sys.exit(Exit.OK if output_format == "text" else _for_programs((), output_format))
    options = Options()
    paths = options.descriptions(files)
    if options.refused():
        sys.exit(Exit.BAD_INPUT)
    if output_format != "text":
        sys.exit(_for_programs(paths, output_format))
    codes = dict.fromkeys(paths, Exit.OK)
    for path in paths:
        try:
            codes[path] = _check(path)
        except Exception as error:  # a defect of ours must not cost the rest of the batch
            defect(error, path)
            codes[path] = Exit.FAILED
    wrong = [printable(path) for path, code in codes.items() if code != Exit.OK]
    if wrong and len(paths) > 1:
        named, more = ", ".join(wrong[:MOST_NAMED]), len(wrong) - MOST_NAMED
        if more > 0:
            named = Message("[[names]] and [[more]] more", names=named, more=more)
        text = "[[count]] descriptions: [[good]] ok, not ok: [[wrong]]"
        told = Message(text, count=len(paths), good=len(paths) - len(wrong), wrong=named)
        print(wrapped(speaking(*paths)(told), asked_width()))
    sys.exit(max(codes.values()))


def _for_programs(paths: Sequence[Path], output_format: str) -> int:
    """All complaints about all files on standard output, in a format that programs read."""
    from mbsym.report.words.findings import Finding, findings_of, github_annotations, json_lines, sarif

    findings: list[Finding] = []
    worst = Exit.OK
    for path in paths:
        try:
            _, complaints, _ = load(path)
        except Exception as error:
            defect(error, path)
            worst = max(worst, Exit.FAILED)
            continue
        findings += findings_of(printable(path.as_posix()), complaints.sorted())
        worst = max(worst, Exit.BAD_INPUT if complaints.errors else Exit.OK)
    written = {
        "github": github_annotations,
        "sarif": lambda all_findings: sarif(all_findings, mbsym.__version__),
        "json": json_lines,
    }
    sys.stdout.write(written[output_format](findings))
    return worst


def _check(path: Path) -> Exit:
    system = read_description(path, writes=False)
    if system is None:
        return Exit.BAD_INPUT
    sound = Message("ok: [[name]]; [[size]]", name=system.name, size=_size(system))
    print(wrapped(f"{printable(path)}: {Language(system.language).say(sound)}", asked_width()))
    return Exit.OK


def _size(system: System) -> str:
    """What it consists of, in its language."""
    say, count = Language(system.language).say, len(system.coordinates)
    names = ", ".join(system.coordinates)
    if system.linear is not None and system.linear.of_first_order:
        title = Message("state variables: [[names]]", names=names)
    elif count == 1:
        title = Message("coordinates: [[names]]", names=names)
    else:
        title = Message("coordinates ([[count]]): [[names]]", count=count, names=names)
    sentences = [say(title)]
    if system.linear is not None:
        keys = ", ".join(matrix.key for matrix in system.linear.matrices)
        return "; ".join([*sentences, f"{say('given by its matrices')}: {keys}"])
    if system.constraints:  # how many of the coordinates are free is another question
        sentences.append(say(Message("constraints: [[count]]", count=len(system.constraints))))
    return "; ".join([*sentences, say(Message("bodies and frames: [[count]]", count=len(system.bodies)))])
