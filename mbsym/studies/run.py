"""``mbsym run``: derives the numbered problems of a description and writes its reports.

Whatever fails stays where it happened: a formula in its problem, a problem in its file, a file among others.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field
from pathlib import PurePath
from typing import TYPE_CHECKING, Annotated, Any, Literal

from mbsym.expressions.message import Message, joined, worded
from mbsym.expressions.safe import safe
from mbsym.report.targets import ANGLES, DETAILS, FORMATS, TARGETS
from mbsym.studies.described import Source, public
from mbsym.studies.described import analysis_of as analysis_from
from mbsym.studies.request import (
    LEAST_ERROR,
    MOST_ERROR,
    Flag,
    Number,
    Problems,
    Scale,
    Substitutions,
    Tongue,
    Value,
    Whole,
    Word,
    Words,
    language,
)
from mbsym.studies.study import Among, Answer, Asked, Exit, Folder, Line, Needed, Refusal, Study, Watch

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.numerics.ledger.entry import Ledger
    from mbsym.report.figures.made_figures import MadeFigure
    from mbsym.report.plain_writer import Line as Written
    from mbsym.report.plain_writer import Writer
    from mbsym.report.results import Results
    from mbsym.report.whole_run import Rendered

#: Columns of what is drawn where nobody says how many there are.
WIDEST = 100


def _forms() -> tuple[str, ...]:
    from mbsym.analysis.forms import FORMS

    return ("lagrange", *FORMS)


@dataclass(frozen=True)
class Request:
    """What is derived, and which files are made of it.  A problem that is not named is derived where they show it."""

    _: KW_ONLY
    problems: Annotated[
        tuple[int, ...] | None, Problems("LIST", "1-5 or 1,3,6.", "-p", usual="what the formats show of 1-7")
    ] = None
    formats: Annotated[
        tuple[str, ...],
        Words(
            "LIST", "Some of them; exports only where named.", "-f", "--format", "all", choices=tuple(FORMATS),
            what="format", every="all", all_of=tuple(TARGETS),
        ),
    ] = tuple(TARGETS)  # fmt: skip
    values: Annotated[
        Mapping[str, Value], Substitutions("NAME=VALUE", "Replace a value; repeatable.", "-s", "--set")
    ] = field(default_factory=dict)
    scale: Annotated[str | None, Scale("LIST", "In dimensionless variables, as 'mbsym convert' has them.")] = None
    detail: Annotated[str, Word("WORD", "Long formulas: compact, or full.", choices=DETAILS, what="detail")] = "compact"
    terms: Annotated[int, Whole("N", "Budget of terms of one closed formula.", most=10**12)] = 60_000
    angles: Annotated[
        Literal["products", "sums", "shorter"] | None,
        Word(
            "FORM", "products, sums or shorter: sin and cos of sums of angles in every file.",
            usual="the shorter form of each formula for people, products for programs", choices=ANGLES, what="form",
        ),
    ] = None  # fmt: skip
    forms: Annotated[
        tuple[str, ...],
        Words(
            "FORMS", "Of problem 3, beside Lagrange's: routh, hamilton.", name="--form", choices=_forms, what="form"
        ),
    ] = ()  # fmt: skip
    animate: Annotated[float | None, Number("T", "The motion from 0 to T in report.html, in three dimensions.")] = None
    language: Annotated[
        str | None,
        language("Of the reports", "the description's, or en", Tongue),
    ] = None
    ledger: Annotated[bool, Flag(None, "What was left out, why that is safe, and what it saved.")] = False
    accuracy: Annotated[
        float | None,
        Number(
            "X", "Hold what the ledger's equations leave out against this relative error of the motion (1e-6).",
            least=LEAST_ERROR, most=MOST_ERROR,
        ),
    ] = None  # fmt: skip
    until: Annotated[float | None, Number("T", "The end of that motion, from 0 (20, 2*pi).")] = None


@dataclass(frozen=True)
class Command(Request):
    """Derive the numbered problems of each FILE (or of every description in a folder) and write reports.

    For folders in folders, several at a time and only what changed, there is 'mbsym batch'.

    Problems: 1 kinematics, 2 energy, 3 equations, 4 equilibrium, 5 linearisation, 6 stability, 7 first integrals,
    8 stabilisation (where it is named, and of systems that are given by their matrices), and where they are named
    9 polynomial integrals, 10 steady motions and invariant manifolds, 11 terms of higher order, 12 small parameters.
    One file that fails does not stop the others; the exit code is the worst: 0 no self-check failed, 1 one failed
    or a report could not be written, 2 a description has errors.  Claims (formulas that were printed somewhere,
    in a description's 'claims') are compared with what is derived; one that does not hold is a finding, not a failure,
    unless --strict-claims is given.

    Formats: latex, wolfram, python, c, html, json are all of them; the exports casadi, jax, octave (MATLAB too), julia,
    modelica, fmu2 and fmu3 are made where they are named.

    Reports for people tell long formulas through quantities that have a meaning (angular velocities, composite
    inertias, forces and moments of the bodies), each defined once; --detail full writes them out.

    With --form routh problem 3 is told without the cyclic coordinates besides (Routh's function, reduced potential),
    with --form hamilton in momenta (Hamilton's function, canonical equations, Poisson brackets of first integrals), in
    every file but model.c and the exports.

    With --ledger the run ends with what was left out of the model because this scene does not need it, and what that
    saved: each saving is measured against the same model built without it.  Also in ledger.csv and results.json.
    With --accuracy X --until T what the equations leave out (orders of gravity, negligible masses) is held against the
    motion, as 'mbsym simulate --accuracy' does; what changes it too much is told to be needed.

    With --language ru or es reports in LaTeX and HTML, and what the terminal tells of results, are in Russian or
    Spanish; generated code and JSON stay English.

    With --angles sums formulas have cos(q1 - q2) in all files, where that is shorter part by part; with --angles
    products they have products of sines and cosines of single angles.

    With --animate T the equations are integrated from the description's initial state and values (as 'mbsym simulate'
    does), and report.html shows the moving bodies with time controls; where a number is missing it says which.

    With --set NAME=VALUE a parameter has another value than in the description: for the verdict at given values,
    eigenvalues, parameters that code begins with.

    With --scale x=L*x1,t=tau/omega0,... everything is derived of the description in these variables, which 'mbsym
    convert --scale' writes.

    \b
    Examples:
      mbsym run systems/satellite.yaml
      mbsym run systems/bead-on-hoop.yaml --set Omega=5
      mbsym run systems/satellite.yaml --animate 20
      mbsym run systems/ --problems 1-5 --format latex,json --out reports
      mbsym run systems/cart-pole.yaml --problems 5,6,8
      mbsym run systems/three-bodies.yaml --problems 6,11
      mbsym run systems/ --brief
      mbsym run systems/satellite.yaml --detail full
      mbsym run systems/spherical-pendulum.yaml --form routh,hamilton
      mbsym run systems/satellite.yaml --ledger
      mbsym run systems/satellite.yaml --ledger --accuracy 1e-6 --until 20
      mbsym run systems/satellite.yaml --format latex --language ru
      mbsym run systems/double-pendulum.yaml --format all,fmu2,casadi
      mbsym run systems/tethered-satellites.yaml --angles sums
    """

    _: KW_ONLY
    strict_claims: Annotated[bool, Flag(None, "Exit code 1 unless every claim holds.")] = False
    brief: Annotated[bool, Flag(None, "Print one line a file.", "-b")] = False
    verbose: Annotated[bool, Flag(None, "Print what the reports say of problems, claims and checks.", "-v")] = False


@dataclass(frozen=True)
class Run:
    """What was derived, and the files that were made of it; ``text`` None of one that was not made."""

    analysis: Analysis
    rendered: Sequence[Rendered]
    ledger: Ledger | None = None

    @property
    def files(self) -> dict[str, str | bytes]:
        """The contents of the files, by their names."""
        texts = {file.filename: file.text for file in self.rendered if file.text is not None}
        if self.ledger is not None:
            from mbsym.report.runs.ledger import ledger_csv, with_ledger

            if (name := TARGETS["json"].filename) in texts:
                texts[name] = with_ledger(str(texts[name]), self.ledger)
            texts["ledger.csv"] = ledger_csv(self.ledger)
        return texts


def _asked_of(source: Source, request: Request) -> Asked:
    """The system with the values and in the variables of the request.  Raises ValueError where these cannot be read."""
    from mbsym.model.system import with_values
    from mbsym.simulation.request import read_values

    system = analysis_from(source).system
    system = with_values(system, read_values(system, request.values)) if request.values else system
    if request.scale is not None:
        from mbsym.expressions.place import Complaints
        from mbsym.source.scaling import read_scaling
        from mbsym.studies.groups import in_scale

        scaling = read_scaling(request.scale, system, complaints := Complaints())
        if scaling is None:
            raise ValueError("; ".join(complaint.message for complaint in complaints.sorted()))
        system = in_scale(system, scaling)
    return Asked(system)


@public(Request, _asked_of)
def run(context: Asked, request: Request, watch: Watch) -> Run:
    """The analysis of a description and the files that reports and code of it have: ``mbsym run``.

    Nothing is written.  Raises DescriptionError, ValueError.
    """
    from mbsym.report.whole_run import analysis_of, unhelped, whole_run

    analysis = analysis_of(context.system, request.problems, request.formats, request.terms)
    analysis.language, analysis.letters = request.language or "", context.letters
    analysis.forms = tuple(name for name in _forms() if name in request.forms and name != "lagrange")
    analysis.detail, analysis.animate = request.detail, request.animate
    analysis.figures = _figures(context) if "latex" in request.formats else ()
    rendered = whole_run(analysis, request.formats, watch, context.beside or unhelped, request.angles)
    if not request.ledger:
        return Run(analysis, rendered)
    from mbsym.numerics.ledger.table import ledger
    from mbsym.numerics.ledger.work import AccuracyGoal

    watch("ledger")
    goal = AccuracyGoal(request.accuracy, request.until) if request.accuracy and request.until else None
    try:
        return Run(analysis, rendered, ledger(analysis, goal=goal))
    except Exception as error:  # finished reports are not lost to it
        analysis.defects.append(error)
        return Run(analysis, rendered)


def _figures(context: Asked) -> tuple[MadeFigure, ...]:
    """Figures that 'mbsym simulate' made of this description in the same folder, if nobody has changed them."""
    unchanged = context.unchanged("simulate")
    if "simulation.json" not in unchanged:
        return ()
    from mbsym.report.figures.made_figures import made_figures
    from mbsym.source.yaml_writer import meaning

    text = (context.folder / "simulation.json").read_text(encoding="utf-8", errors="replace")
    return made_figures(text, meaning(context.system), unchanged)


def answer(context: Asked, request: Command, result: Run) -> Answer:
    complaints, sound = _complaints(request, result)
    gone = [file.filename for file in result.rendered if file.text is None]
    analysis, files, code = result.analysis, result.files, Exit.OK if sound else Exit.FAILED
    how: dict[str, Any] = {"gone": gone, "complaints": complaints, "code": code, "defects": analysis.defects}
    if context.screen.quiet or request.brief:
        return Answer(() if context.screen.quiet else (_brief(context, analysis),), files, bare=True, **how)
    return Answer(tuple(_lines(context, request, result, files)), files, listed=False, **how)


def _lines(context: Asked, request: Command, result: Run, files: Mapping[str, Any]) -> Iterator[Written]:
    """What was found, each with its name; further documents; where all of it is, and how more of it is told."""
    from mbsym.formulas.tree import angles_as
    from mbsym.report.content import Paragraph, say
    from mbsym.report.language import Language
    from mbsym.report.letters import in_letters, with_meanings
    from mbsym.report.plain_writer import LONGEST, Writer
    from mbsym.report.results import results
    from mbsym.report.sections.summary import finding

    analysis = result.analysis
    page = next((name for name in ("report.html", "report.tex", "results.json") if name in files), "")
    width = (context.screen.width or WIDEST) - 2  # documents stand further in
    writer = Writer(Language(context.language), True, LONGEST, width, page, context.file)
    with angles_as(request.angles or "shorter"):
        known = results(analysis, analysis.problems)
        with in_letters(analysis.system, analysis.letters or ()) as used:
            yield from writer.document([finding(known)])
        yield from _documents(known, writer, request)
        yield from writer.document(with_meanings((), analysis.system, used))
    if result.ledger is not None:
        from mbsym.report.runs.ledger import ledger_blocks

        yield from writer.document(ledger_blocks(result.ledger))
    if files:
        texts = ("[[file]]", "[[file]] (files there: [[count]])")
        if not request.verbose:
            texts = ("[[file]] (-v tells all of it here)", "[[file]] (files there: [[count]]; -v tells all of it here)")
        place = safe(str(context.folder / (page if page == "report.html" else next(iter(files)))))
        told = say(texts[len(files) > 1], file=place, count=str(len(files)))
        yield from writer.document([Paragraph((told,))])


def _documents(known: Results, writer: Writer, request: Command) -> Iterator[Written]:
    """What the reports say: with -v of all, else of further problems that were named."""
    from mbsym.analysis.pipeline import USUAL_PROBLEMS
    from mbsym.report.results import contents

    written = contents(known, writer.document)
    further = [
        x for x in known.problems if request.verbose or (request.problems is not None and x not in USUAL_PROBLEMS)
    ]
    for key in (*further, *(("claims", "checks") if request.verbose else ())):
        for k, line in enumerate(written[key]()):
            title = line.parts if k == 0 else (("  ", ""), *line.parts)
            seconds = known.analysis.stage(key).seconds if k == 0 and isinstance(key, int) else None
            yield line._replace(parts=title if seconds is None else (*title, (f"  {seconds:.3f} s", "dim")))


def _brief(context: Asked, analysis: Analysis) -> Line:
    """A run in one line; columns are as wide as they mostly are."""
    from mbsym.report.brief import brief
    from mbsym.report.plain_writer import STYLES
    from mbsym.report.words.claims import grade

    told, width = brief(analysis, context.screen.seconds()), max(map(len, context.screen.names), default=0)
    return Line(
        (
            (f"{PurePath(context.file).name:<{width}}", "bold"),
            f"  {told.problems:<8}",
            (f"  {told.self_check:<32}", STYLES[grade(told.worst)] if told.worst else ""),
            f"  {told.claims:<30}",
            (f"{told.seconds:7.2f} s", "dim"),
            (f"  {told.missing}" if told.missing else "", "yellow"),
        )
    )


def _complaints(request: Command, result: Run) -> tuple[list[str], bool]:
    """What went wrong, and what is to be told of files; whether nothing did."""
    from mbsym.report.whole_run import lost, remarks

    analysis = result.analysis
    losses = [
        joined((where, joined(filter(None, (why.reason, why.hint)), "; ")), ": ")
        for where, why in lost(analysis, result.rendered)
    ]
    open_claims = [claim for claim in analysis.claims if not claim.holds] if request.strict_claims else []
    wrong: list[str] = []
    for claim in open_claims:
        parts = filter(None, (Message("CLAIM DOES NOT HOLD"), claim.claim.place, claim.title, worded(claim.outcome)))
        wrong.append(joined(parts, ": "))
    for check in (check for check in analysis.checks if check.failed):
        wrong.append(joined((Message("SELF-CHECK FAILED"), worded(check.name), worded(check.detail)), ": "))
    singular = [
        Message("the mass matrix is singular: [[detail]]", detail=worded(check.detail))
        for check in analysis.checks
        if check.singular
    ]
    told = [*losses, *remarks(request.formats, result.files), *wrong, *singular]
    return told, not (losses or wrong or analysis.defects)


def refusal(error: Exception, context: Asked, request: Request) -> Refusal | None:
    return None


_IN_PAGE = Among(
    "--animate",
    "--format",
    "html",
    "the motion is shown in report.html",
    "add html to --format, or use 'mbsym simulate --animate'",
)
_BOTH = "an accuracy is one of a motion from 0 to a time: give both"
PAIRS: list[Among | Needed] = [
    _IN_PAGE,
    Among("--json", "--format", "json", "it prints results.json", "add json to --format"),
    Needed("--accuracy", "--until", _BOTH),
    Needed("--until", "--accuracy", _BOTH),
    Needed("--accuracy", "--ledger", "only the ledger is held against it: add --ledger"),
]

STUDY = Study(
    "run", Command, run.derive, answer, refusal, constraints=True, matrices=True, held=False, free=True, timed=True,
    letters=True, out=Folder(json=True), pairs=PAIRS, several=True,
)  # fmt: skip
