"""``mbsym batch``: every description in some folders, each in a process of its own; what is up to date is left.

No study: it is about many descriptions, none of which is read in this process.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mbsym.expressions.message import Message
from mbsym.expressions.safe import quoted as ascii_safe
from mbsym.studies import run
from mbsym.studies.request import fields_of
from mbsym.studies.study import Exit
from mbsym_cli.console import OutPath, speaking
from mbsym_cli.options import Options
from mbsym_cli.requests import option_of, read_fields

if TYPE_CHECKING:
    from mbsym_cli.batch.run import Request

_MEGABYTE = 2**20


@click.command("batch")
@click.argument("folders", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="FOLDER...")
@click.option("--out", "-o", default="build", show_default=True, type=OutPath(path_type=Path), help="Where results go.")
@click.option("--jobs", "-j", metavar="N", help="Processes at a time.  [default: as many as there are processors]")
@click.option(
    "--timeout", default="600", show_default=True, metavar="SECONDS", help="For one description; 0: no bound."
)
@click.option("--memory", metavar="MB", help="For one description; 0: no bound.  [default: what there is, shared out]")
@click.option("--filter", "patterns", multiple=True, metavar="GLOB", help="Only files like this; may be repeated.")
@click.option("--shard", metavar="I/N", help="Only the I-th of N parts, for job arrays.")
@click.option("--cluster", metavar="ADDRESS", help="Of a Dask scheduler, tcp://host:8786; local: starts one here.")
@click.option("--fail-fast", is_flag=True, help="Begin nothing new after a failure.")
@click.option("--changed", is_flag=True, help="Print only what was not up to date.")
@click.option("--strict-claims", is_flag=True, help="Exit code 1 unless every claim holds.")
@click.option(
    "--output-format",
    type=click.Choice(("text", "github", "sarif", "junit", "json")),
    default="text",
    show_default=True,
    help="Standard output for people, or for a program: annotations, a log, cases, an object a finding.",
)
@click.option("--appendix", is_flag=True, help="And one appendix.tex of all systems, for anyone's document.")
@click.option("--quiet", "-q", is_flag=True, help="Print only complaints.")
def command(
    folders: tuple[Path, ...],
    out: Path,
    jobs: str | None,
    timeout: str,
    memory: str | None,
    patterns: tuple[str, ...],
    shard: str | None,
    cluster: str | None,
    fail_fast: bool,
    changed: bool,
    strict_claims: bool,
    output_format: str,
    appendix: bool,
    quiet: bool,
    **texts: Any,
) -> None:
    """Derive every description in each FOLDER, and in the folders in it, and write a summary.

    Of a folder those files are taken that say they are descriptions; hidden folders, links to folders and the folder
    of results are not looked into.  Each description has a folder of its own in --out, as deep as it lies itself, and
    a process of its own: one that runs too long, wants too much memory or crashes costs its row only.

    What is up to date is not derived again: the same description (comments and layout do not matter), options and
    version of mbsym, and every file as it was written.  A batch that was stopped or killed goes on where it was.
    Results of a description that was deleted since the last batch go with it, but for files that somebody changed.

    With --appendix, OUT/appendix.tex joins the appendices of all systems: a section each, labels that differ, no
    preamble; a document needs amsmath and \\input{build/appendix}.

    OUT/summary.json has what became of everything: outcomes, verdicts, claims, self-checks, complaints with their
    places, digests of the files; index.html shows it, junit.xml and mbsym.sarif tell it to CI systems.

    Exit code, that of the worst: 0 no self-check failed (nor a claim, with --strict-claims), 1 one failed, or
    an internal error or a crash, 2 a description has errors, 4 a budget was met, 130 interrupted.

    \b
    Examples:
      mbsym batch systems/
      mbsym batch systems/ --out build --jobs 4 --timeout 60 --memory 2000
      mbsym batch systems/ --filter '*pendulum*' --format json --changed
      mbsym batch systems/ --shard 3/8
      mbsym batch systems/ --format latex --appendix
      mbsym batch systems/ --cluster tcp://10.0.0.1:8786
    """
    from mbsym.batch.transport import BatchOptions, Budget

    options = Options()
    for path in folders:
        if not path.exists():
            options.complain(str(path), "missing", "there is no such file or folder")
    values, _, _ = read_fields(out, None, run.Request, texts, options)
    width = options.whole("--jobs", jobs, 1, 1024)
    seconds = _seconds(options, timeout)
    megabytes = options.whole("--memory", memory, 0, 10**9)
    part = _part(options, shard)
    if appendix and "latex" not in values["formats"]:
        options.complain("--appendix", "conflicting-options", "it joins LaTeX files", "add latex to --format")
    if options.refused():
        sys.exit(Exit.BAD_INPUT)
    from mbsym_cli.batch.machine import processors, shared_memory
    from mbsym_cli.batch.run import Request
    from mbsym_cli.batch.run import run as whole

    width = width or processors()
    limit = shared_memory(width) if megabytes is None else megabytes * _MEGABYTE or None
    request = Request(
        folders=folders,
        out=out,
        options=BatchOptions(**values),
        budget=Budget(seconds, limit),
        jobs=width,
        patterns=patterns,
        shard=part,
        fail_fast=fail_fast,
        strict_claims=strict_claims,
        changed=changed,
        quiet=quiet,
        output_format=output_format,
        cluster=cluster,
        appendix=appendix,
    )
    sys.exit(whole(request) if cluster is None else _on_cluster(request))


#: What is derived of each description, and written, as ``mbsym run`` has it.
AS_IN_RUN = ("problems", "formats", "terms", "angles", "detail")
command.params[-5:-5] = [option_of(field) for field in fields_of(run.Request) if field.name in AS_IN_RUN]


def _on_cluster(request: Request) -> int:
    from mbsym.batch.cluster import NoCluster
    from mbsym_cli.batch.folders import found_in
    from mbsym_cli.batch.run import run as whole

    try:
        return whole(request)
    except NoCluster as error:
        files = [place.file for place in found_in(request.folders, request.out).places]
        print(f"--cluster: {speaking(*files)(error.reason)}", file=sys.stderr)
        return Exit.BAD_INPUT


def _seconds(options: Options, text: str) -> float | None:
    """A positive number of seconds; 0 is no bound."""
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0 <= value < 1e9:
        options.complain(
            "--timeout", "bad-number", Message("a number of seconds is wanted, not [[text]]", text=ascii_safe(text))
        )
    return value or None


def _part(options: Options, text: str | None) -> tuple[int, int] | None:
    """``3/8`` as the third of eight parts."""
    if text is None:
        return None
    first, slash, second = text.partition("/")
    if slash and all(number.isascii() and number.isdigit() and len(number) < 7 for number in (first, second)):
        part, parts = int(first), int(second)
        if 1 <= part <= parts:
            return part, parts
    options.complain(
        "--shard",
        "bad-shard",
        Message("a part like 3/8 is wanted, not [[text]]", text=ascii_safe(text)),
        "they count from 1",
    )
    return None
