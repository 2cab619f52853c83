"""``mbsym run``: derives the numbered problems of each description and writes its reports."""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mbsym_cli.console import BAD_INPUT, FAILED, OK, read_description, status
from mbsym_cli.files import write_whole
from mbsym_cli.options import Options

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.model.system import System
    from mbsym.numerics.ledger.entry import Ledger

#: What a folder is searched for.


@dataclass(frozen=True)
class Request:
    """What to derive, and what to write."""

    problems: tuple[int, ...]
    formats: tuple[str, ...]
    terms: int
    quiet: bool
    strict_claims: bool = False
    ledger: bool = False
    brief: bool = False
    width: int = 0


@click.command("run")
@click.argument("files", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="FILE...")
@click.option("--problems", "-p", help="1-5 or 1,3,6.  [default: what the formats show; all of them: 1-7]")
@click.option("--format", "formats", "-f", default="all", show_default=True, help="Some of them.")
@click.option("--out", "-o", type=click.Path(path_type=Path), help="Folder of the reports.  [default: reports/NAME]")
@click.option("--terms", default="60000", show_default=True, metavar="N", help="Budget of terms of one closed formula.")
@click.option("--strict-claims", is_flag=True, help="Exit code 1 unless every claim holds.")
@click.option("--brief", "-b", is_flag=True, help="Print one line a file.")
@click.option("--ledger", is_flag=True, help="What was left out, why that is safe, and what it saved.")
@click.option("--quiet", "-q", is_flag=True, help="Print only what went wrong.")
def command(
    files: tuple[Path, ...],
    problems: str | None,
    formats: str,
    out: Path | None,
    terms: str,
    strict_claims: bool,
    brief: bool,
    ledger: bool,
    quiet: bool,
) -> None:
    """Derive the numbered problems of each FILE (or of every description in a folder) and write reports.

    Problems: 1 kinematics, 2 energy, 3 equations, 4 equilibrium, 5 linearisation, 6 stability, 7 first integrals.
    One file that fails does not stop the others; the exit code is the worst: 0 everything holds, 1 a self-check
    failed or a report could not be written, 2 a description has errors.  Claims (formulas that were printed somewhere,
    in a description's 'claims') are compared with what is derived; one that does not hold is a finding, not a failure,
    unless --strict-claims is given.

    With --ledger the run ends with what was left out of the model because this scene does not need it, and what that
    saved: each saving is measured against the same model built without it.  Also in ledger.csv and results.json.

    \b
    Examples:
      mbsym run systems/satellite.yaml
      mbsym run systems/ --problems 1-5 --format latex,json --out reports
      mbsym run systems/ --brief
      mbsym run systems/satellite.yaml --ledger
    """
    from mbsym.report.targets import TARGETS, shown_by

    asked = Options()
    paths = asked.descriptions(files)
    named = None if problems is None else asked.problems(problems)
    kinds = asked.words("--format", formats, tuple(TARGETS), "format", every="all")
    chosen = shown_by(kinds) if named is None else named
    budget = asked.whole("--terms", terms, 1, 10**12)
    if asked.complaints or budget is None:
        for path in paths:
            read_description(path)
        asked.refused()
        sys.exit(BAD_INPUT)
    width = max(len(path.name) for path in paths)
    request = Request(chosen, kinds, budget, quiet, strict_claims, ledger, brief, width)
    worst = OK
    for path, folder in zip(paths, _folders(paths, out), strict=True):
        worst = max(worst, _run_one(path, folder, request))
    sys.exit(worst)


def _folders(paths: list[Path], out: Path | None) -> list[Path]:
    """Where each file's reports go; files of one name get folders of their own."""
    base = out if out is not None else Path("reports")
    if out is not None and len(paths) == 1:
        return [out]
    taken: set[str] = set()
    folders = []
    for path in paths:
        name, count = path.stem, 1
        while name in taken:
            name = path.name if count == 1 else f"{path.name}-{count}"
            count += 1
        taken.add(name)
        folders.append(base / name)
    return folders


def _run_one(path: Path, folder: Path, request: Request) -> int:
    """Reads, derives, writes and reports on one file; the exit code it deserves."""
    system = read_description(path)
    if system is None:
        return BAD_INPUT
    try:
        return _derive(path, system, folder, request)
    except OSError as error:
        print(f"{path}: the reports cannot be written: {error}", file=sys.stderr)
    except MemoryError:
        print(f"{path}: out of memory; lower --terms, or ask for fewer --problems", file=sys.stderr)
    except Exception as error:
        # A defect of ours must not cost the rest of the batch; say what it was and go on.
        print(f"{path}: internal error, please report it: {type(error).__name__}: {error}", file=sys.stderr)
    return FAILED


def _derive(path: Path, system: System, folder: Path, request: Request) -> int:
    from mbsym.algebra.failures import NoClosedForm, SingularPoint
    from mbsym.analysis import PROBLEMS, Analysis, Unavailable
    from mbsym.report.targets import TARGETS

    started = time.perf_counter()
    analysis = Analysis(system, request.problems, request.terms)
    with status(request.quiet) as say:
        for number in analysis.problems:
            say(f"{path.name}: problem {number}, {PROBLEMS[number].title}")
            analysis.stage(number)
        if any(TARGETS[name].program for name in request.formats):
            analysis.optional("programs")
        if system.claims:
            say(f"{path.name}: claims")
            _ = analysis.claims
        say(f"{path.name}: self-check")
        failed = [check for check in analysis.checks if check.failed]
        texts, missing = {}, []
        for target in (part for name in request.formats for part in (TARGETS[name], *TARGETS[name].companions)):
            say(f"{path.name}: writing {target.filename}")
            try:
                texts[folder / target.filename] = target.render(analysis, analysis.problems)
            except (NoClosedForm, SingularPoint, Unavailable, ValueError) as error:
                long = "digits" in str(error)  # Python refuses to write numbers of thousands of digits
                reason = "a number in it has more than 4300 digits" if long else str(error)
                missing.append(f"{path}: {target.filename} cannot be written: {reason}")
        if request.ledger:
            say(f"{path.name}: ledger")
            found = _ledger(analysis, folder, texts)
    for file, text in texts.items():
        write_whole(file, text)
    for line in missing:
        print(line, file=sys.stderr)
    if request.brief and not request.quiet:
        _print_brief(analysis, path, request.width, time.perf_counter() - started)
    elif not request.quiet:
        _print_summary(analysis, path, list(texts), time.perf_counter() - started)
        if request.ledger:
            _print_ledger(found)
    open_claims = [result for result in analysis.claims if not result.holds] if request.strict_claims else []
    for result in open_claims:
        place = f"{result.claim.place}: " if result.claim.place else ""
        print(f"{path}: CLAIM DOES NOT HOLD: {place}{result.title}: {result.outcome}", file=sys.stderr)
    for check in failed:
        print(f"{path}: SELF-CHECK FAILED: {check.name}: {check.detail}", file=sys.stderr)
    return FAILED if failed or missing or open_claims else OK


def _ledger(analysis: Analysis, folder: Path, texts: dict[Path, str]) -> Ledger:
    """The ledger of a finished run, put into its files."""
    from mbsym.numerics.ledger.table import ledger
    from mbsym.report.ledger import ledger_csv, with_ledger
    from mbsym.report.targets import TARGETS

    found = ledger(analysis)
    results = folder / TARGETS["json"].filename
    if results in texts:
        texts[results] = with_ledger(texts[results], found)
    texts[folder / "ledger.csv"] = ledger_csv(found)
    return found


def _print_brief(analysis: Analysis, path: Path, width: int, seconds: float) -> None:
    from mbsym.report.brief import brief
    from mbsym_cli.show import show_brief

    show_brief(brief(analysis, seconds), path.name, width)


def _print_summary(analysis: Analysis, path: Path, files: list[Path], seconds: float) -> None:
    from mbsym.report.summary import summary
    from mbsym_cli.show import show

    show(summary(analysis, analysis.problems, files), path, seconds)


def _print_ledger(found: Ledger) -> None:
    from mbsym.report.ledger import ledger_lines
    from mbsym_cli.ledger import show_ledger

    show_ledger(ledger_lines(found), found.unmeasured)
