"""What ``mbsym run`` does with one description: derives, renders, delivers, tells.

Whatever fails stays where it happened: a formula in its problem, a problem in its file, a file in the batch.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from mbsym.expressions.message import Message, joined, worded
from mbsym.expressions.safe import UNBROKEN
from mbsym.report import content
from mbsym.report.language import Language
from mbsym.report.whole_run import derive_all, lost, rendered_all
from mbsym.studies.study import Exit
from mbsym_cli.assignments import in_scale, with_settings
from mbsym_cli.beside import beside
from mbsym_cli.console import (
    asked_width,
    complain,
    defect,
    described,
    printable,
    read_description,
    reason_of,
    show,
    speaking,
    status,
    tell,
    trace,
)
from mbsym_cli.files import deliver, delivered, digest_of, obstacle
from mbsym_cli.letters import read_letters
from mbsym_cli.options import Options

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.formulas.tree import Angles
    from mbsym.model.system import System
    from mbsym.numerics.ledger.entry import Ledger
    from mbsym.numerics.ledger.work import AccuracyGoal
    from mbsym.report.brief import Brief
    from mbsym.report.content import Facts
    from mbsym.report.figures.made_figures import MadeFigure
    from mbsym.report.plain_writer import Line, Writer
    from mbsym.report.results import Results
    from mbsym.report.whole_run import Rendered

#: Columns of what is drawn where nobody says how many there are.
WIDEST = 100


@dataclass(frozen=True)
class Request:
    """What to derive, and what to write."""

    problems: tuple[int, ...]
    formats: tuple[str, ...]
    terms: int
    quiet: bool
    strict_claims: bool = False
    ledger: AccuracyGoal | bool = False  # or the accuracy that it is held against
    brief: bool = False
    width: int = 0
    angles: Angles | None = None  # None: what each kind of text usually has
    animate: float | None = None  # the time until which report.html shows the motion
    language: str = ""  # "": that of the description
    forms: tuple[str, ...] = ()  # of problem 3, beside Lagrange's
    named: bool = False  # whether the problems were named, or follow from the formats
    verbose: bool = False
    detail: str = "compact"
    settings: tuple[str, ...] = ()  # values that replace those of the description
    scale: str | None = None  # dimensionless variables that the description is put in
    letters: str | None = None  # the author's, in which formulas are written; None: where they get shorter


def report_on(path: Path, folder: Path, base: Path | None, request: Request) -> int:
    """Reads, derives, writes and reports on one file; the exit code it deserves.

    ``base`` is the folder that the reports must not leave.
    """
    say = Language(request.language).say if request.language else speaking(path)
    try:
        system = read_description(path)
        if system is None:
            return Exit.BAD_INPUT
        options = Options()
        options.say = say
        if request.settings:
            system = with_settings(path, system, request.settings, options)
        if request.scale is not None and not options.complaints:
            system = in_scale(system, request.scale, options) if system is not None else None
        letters = None if request.letters is None or system is None else read_letters(request.letters, system, options)
        if options.refused(path) or system is None:
            return Exit.BAD_INPUT
        reason = obstacle(folder, base)
        if reason:
            complain(path, Message("the reports cannot be written: [[why]]", why=reason), say)
            return Exit.FAILED
        return _derive(path, system, folder, request, letters)
    except OSError as error:
        complain(path, Message("the reports cannot be written: [[why]]", why=reason_of(error)), say)
        trace(error)
    except Exception as error:  # a defect of ours must not cost the rest of the batch
        defect(error, path)
    return Exit.FAILED


def _derive(path: Path, system: System, folder: Path, request: Request, letters: tuple[str, ...] | None) -> int:
    from mbsym.analysis import Analysis
    from mbsym.analysis.given import chosen as own_problems
    from mbsym.formulas.tree import angles_as

    started = time.perf_counter()
    problems = request.problems if request.named else own_problems(system, request.problems)
    analysis = Analysis(system, problems, request.terms)
    analysis.language = request.language
    analysis.forms, analysis.letters = request.forms, letters
    analysis.detail, analysis.animate = request.detail, request.animate
    analysis.figures = _figures(folder, system) if "latex" in request.formats else ()
    ledger = None
    with status(request.quiet) as say:

        def doing(text: str) -> None:
            say(f"{path.name}: {text}")

        early = derive_all(analysis, request.formats, doing, beside, lambda: angles_as(request.angles))
        with angles_as(request.angles):
            files = rendered_all(analysis, request.formats, doing, beside, early)
        texts = {file.filename: file.text for file in files if file.text is not None}
        if request.ledger:
            say(f"{path.name}: ledger")
            try:
                ledger = _ledger(analysis, texts, request.ledger)
            except Exception as error:  # finished reports are not lost to it
                analysis.defects.append(error)
    missing = [file.filename for file in files if file.text is None]
    written = deliver(folder, texts, "run", gone=missing)
    _show(analysis, path, written, request, time.perf_counter() - started, ledger)
    return Exit.FAILED if _complaints(analysis, path, files, request) else Exit.OK


def _figures(folder: Path, system: System) -> tuple[MadeFigure, ...]:
    """Figures that 'mbsym simulate' made of this description in the same folder, if nobody has changed them."""
    if not (folder / "simulation.json").is_file():
        return ()
    from mbsym.report.figures.made_figures import made_figures
    from mbsym.source.yaml_writer import meaning

    sums = delivered(folder, "simulate")
    unchanged = [name for name, digest in sums.items() if digest_of(folder / name) == digest]
    if "simulation.json" not in unchanged:
        return ()
    text = (folder / "simulation.json").read_text(encoding="utf-8", errors="replace")
    return made_figures(text, meaning(system), unchanged)


def _ledger(analysis: Analysis, texts: dict[str, str | bytes], goal: AccuracyGoal | bool) -> Ledger:
    """The ledger of a finished run, put into its files."""
    from mbsym.numerics.ledger.table import ledger
    from mbsym.report.runs.ledger import ledger_csv, with_ledger
    from mbsym.report.targets import TARGETS

    run_ledger = ledger(analysis, goal=None if isinstance(goal, bool) else goal)
    results = TARGETS["json"].filename
    if results in texts:
        texts[results] = with_ledger(str(texts[results]), run_ledger)
    texts["ledger.csv"] = ledger_csv(run_ledger)
    return run_ledger


def _show(
    analysis: Analysis, path: Path, written: list[Path], request: Request, seconds: float, run_ledger: Ledger | None
) -> None:
    """The run on the terminal."""
    if request.quiet:
        return

    if request.brief:
        from mbsym.report.brief import brief

        show_brief(brief(analysis, seconds), path.name, request.width)
        return
    from mbsym.formulas.tree import angles_as
    from mbsym.report.letters import in_letters, with_meanings
    from mbsym.report.plain_writer import LONGEST, Writer
    from mbsym.report.results import results
    from mbsym.report.sections.summary import finding

    names = {x.name for x in written}
    file = next((x for x in ("report.html", "report.tex", "results.json") if x in names), "")
    language = Language(analysis.language or analysis.system.language)
    with angles_as(request.angles or "shorter"):
        known = results(analysis, analysis.problems)
        width = (asked_width() or WIDEST) - 2  # documents stand further in
        writer = Writer(language, True, LONGEST, width, file, printable(path))
        lines = _documents(known, writer, request)
        with in_letters(analysis.system, analysis.letters or ()) as used:
            facts = finding(known)
            show_finding(facts, analysis.system.name, path, seconds, written, writer, lines, not request.verbose)
        show(writer.document(with_meanings((), analysis.system, used)))
    if run_ledger is not None:
        from mbsym.report.runs.ledger import ledger_blocks

        show(writer.document(ledger_blocks(run_ledger)))


def _documents(known: Results, writer: Writer, request: Request) -> Iterator[Line]:
    """What the reports say: with -v of all, else of further problems that were named."""
    from mbsym.analysis.pipeline import USUAL_PROBLEMS
    from mbsym.report.results import contents

    written = contents(known, writer.document)
    further = [x for x in known.problems if request.verbose or (request.named and x not in USUAL_PROBLEMS)]
    for key in (*further, *(("claims", "checks") if request.verbose else ())):
        for k, line in enumerate(written[key]()):
            title = line.parts if k == 0 else (("  ", ""), *line.parts)
            seconds = known.analysis.stage(key).seconds if k == 0 and isinstance(key, int) else None
            yield line._replace(parts=title if seconds is None else (*title, (f"  {seconds:.3f} s", "dim")))


def _remarks(path: Path, files: list[Rendered], request: Request, say: Callable[[str], str]) -> None:
    """What is to be told of files that were made, on standard error."""
    from mbsym.report.targets import FORMATS

    made = {file.filename for file in files if file.text is not None}
    for target in (FORMATS[name] for name in request.formats):
        words = target.remark() if target.remark is not None and target.filename in made else ""
        if words:
            complain(path, joined((target.filename, worded(words)), ": "), say)


def _complaints(analysis: Analysis, path: Path, files: list[Rendered], request: Request) -> bool:
    """What went wrong, on standard error; whether anything did."""
    defects = lost(analysis, files)
    say = Language(analysis.language or analysis.system.language).say
    for where, failure in defects:
        reason = joined((failure.reason, failure.hint), "; ") if failure.hint else failure.reason
        complain(path, joined((where, reason), ": "), say)
    _remarks(path, files, request, say)
    open_claims = [result for result in analysis.claims if not result.holds] if request.strict_claims else []
    for result in open_claims:
        parts = (
            Message("CLAIM DOES NOT HOLD"),
            *filter(None, (result.claim.place,)),
            result.title,
            worded(result.outcome),
        )
        complain(path, joined(parts, ": "), say)
    failed = [check for check in analysis.checks if check.failed]
    for check in failed:
        complain(path, joined((Message("SELF-CHECK FAILED"), worded(check.name), worded(check.detail)), ": "), say)
    for check in analysis.checks:
        if check.singular:
            complain(path, Message("the mass matrix is singular: [[detail]]", detail=worded(check.detail)), say)
    for error in {described(error): error for error in analysis.defects}.values():
        defect(error, path)
    return bool(defects or open_claims or failed or analysis.defects)


def show_finding(
    facts: Facts,
    title: str,
    path: Path,
    seconds: float,
    files: Sequence[Path],
    writer: Writer,
    further: Iterable[Line] = (),
    more: bool = False,
) -> None:
    """What was found, each with its name; ``further`` lines; where all of it is, and how ``more`` of it is told."""
    tell((title, "bold"), (f"  {printable(path)},{UNBROKEN}{seconds:.2f}{UNBROKEN}s", "dim"))
    show((*writer.document([facts]), *further))
    if files:
        page = next((x for x in files if x.name == "report.html"), files[0])
        texts = ("[[file]]", "[[file]] (files there: [[count]])")
        if more:
            texts = ("[[file]] (-v tells all of it here)", "[[file]] (files there: [[count]]; -v tells all of it here)")
        tell(writer.said(content.say(texts[len(files) > 1], file=printable(page), count=str(len(files)))), indent=2)


def show_brief(brief: Brief, name: str, width: int) -> None:
    """A run in one line; columns are as wide as they mostly are."""
    from mbsym.report.plain_writer import STYLES
    from mbsym.report.words.claims import grade

    colour = STYLES[grade(brief.worst)] if brief.worst else ""
    tell(
        (f"{printable(name):<{width}}", "bold"),
        f"  {brief.problems:<8}",
        (f"  {brief.self_check:<32}", colour),
        f"  {brief.claims:<30}",
        (f"{brief.seconds:7.2f} s", "dim"),
        (f"  {brief.missing}" if brief.missing else "", "yellow"),
    )
