"""``mbsym run``: derives the numbered problems of each description and writes its reports."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, cast

import click

from mbsym.studies.simulate import LEAST_ERROR, MOST_ERROR
from mbsym.studies.study import Exit
from mbsym_cli.console import OutPath, read_description
from mbsym_cli.files import REPORTS, safe_name
from mbsym_cli.letters import with_letters
from mbsym_cli.options import Options
from mbsym_cli.reports import Request, report_on

if TYPE_CHECKING:
    from mbsym.formulas.tree import Angles
    from mbsym.numerics.ledger.work import AccuracyGoal


@click.command("run")
@click.argument("files", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="FILE...")
@click.option("--problems", "-p", help="1-5 or 1,3,6.  [default: what the formats show of 1-7]")
@click.option(
    "--format", "formats", "-f", default="all", show_default=True, help="Some of them; exports only where named."
)
@click.option("--out", "-o", type=OutPath(path_type=Path), help="Folder of the reports.  [default: reports/NAME]")
@click.option("--set", "-s", "settings", multiple=True, metavar="NAME=VALUE", help="Replace a value; repeatable.")
@click.option("--scale", metavar="LIST", help="In dimensionless variables, as 'mbsym convert' has them.")
@click.option("--detail", default="compact", show_default=True, metavar="WORD", help="Long formulas: compact, or full.")
@click.option("--terms", default="60000", show_default=True, metavar="N", help="Budget of terms of one closed formula.")
@click.option(
    "--angles",
    metavar="FORM",
    help="products, sums or shorter: sin and cos of sums of angles in every file.  [default: the shorter form of each "
    "formula for people, products for programs]",
)
@with_letters
@click.option(
    "--form", "forms", default="lagrange", metavar="FORMS", help="Of problem 3, beside Lagrange's: routh, hamilton."
)
@click.option("--animate", metavar="T", help="The motion from 0 to T in report.html, in three dimensions.")
@click.option(
    "--language", metavar="LANGUAGE", help="Of the reports: en, ru or es.  [default: the description's, or en]"
)
@click.option("--strict-claims", is_flag=True, help="Exit code 1 unless every claim holds.")
@click.option("--brief", "-b", is_flag=True, help="Print one line a file.")
@click.option("--ledger", is_flag=True, help="What was left out, why that is safe, and what it saved.")
@click.option(
    "--accuracy",
    metavar="X",
    help="Hold what the ledger's equations leave out against this relative error of the motion (1e-6).",
)
@click.option("--until", metavar="T", help="The end of that motion, from 0 (20, 2*pi).")
@click.option("--verbose", "-v", is_flag=True, help="Print what the reports say of problems, claims and checks.")
@click.option("--quiet", "-q", is_flag=True, help="Print only what went wrong.")
def command(
    files: tuple[Path, ...],
    problems: str | None,
    formats: str,
    out: Path | None,
    settings: tuple[str, ...],
    scale: str | None,
    detail: str,
    terms: str,
    angles: str | None,
    letters: str | None,
    forms: str,
    animate: str | None,
    language: str | None,
    strict_claims: bool,
    brief: bool,
    ledger: bool,
    accuracy: str | None,
    until: str | None,
    verbose: bool,
    quiet: bool,
) -> None:
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
    from mbsym.analysis.forms import FORMS
    from mbsym.model.system import LANGUAGES
    from mbsym.report.targets import ANGLES, DETAILS, FORMATS, TARGETS, shown_by

    options = Options()
    paths = options.descriptions(files)
    chosen = None if problems is None else options.problems(problems)
    kinds = options.words("--format", formats, tuple(FORMATS), "format", every="all", of_them=tuple(TARGETS))
    form = None if angles is None else cast("Angles | None", options.word("--angles", angles, ANGLES, "form"))
    shown = options.words("--form", forms, ("lagrange", *FORMS), "form")
    detail_word = options.word("--detail", detail, DETAILS, "detail")
    tongue = "" if language is None else options.word("--language", language, LANGUAGES, "language") or ""
    budget = options.whole("--terms", terms, 1, 10**12)
    shown_until = options.number("--animate", animate)
    goal = _ledger(ledger, accuracy, until, options)
    if animate is not None and "html" not in kinds:
        hint = "add html to --format, or use 'mbsym simulate --animate'"
        options.complain("--animate", "conflicting-options", "the motion is shown in report.html", hint)
    if options.complaints or budget is None:
        for path in paths:
            read_description(path)
        options.refused()
        sys.exit(Exit.BAD_INPUT)
    width = max(len(path.name) for path in paths)
    request = Request(
        shown_by(kinds) if chosen is None else chosen,
        kinds,
        budget,
        quiet,
        strict_claims,
        goal,
        brief,
        width,
        form,
        shown_until,
        tongue,
        tuple(name for name in FORMS if name in shown),
        chosen is not None,
        verbose,
        detail_word or detail,
        settings,
        scale,
        letters,
    )
    worst = Exit.OK
    base = None if out is not None and len(paths) == 1 else out or REPORTS
    for path, folder in zip(paths, _folders(paths, out, base), strict=True):
        worst = max(worst, report_on(path, folder, base, request))
    sys.exit(worst)


def _folders(paths: list[Path], out: Path | None, base: Path | None) -> list[Path]:
    """Where each file's reports go: ``out`` itself, or folders of their own in ``base``."""
    if base is None:
        return [out or REPORTS]
    taken: set[str] = set()
    folders = []
    for path in paths:
        name, count = safe_name(path.stem), 1
        while name.casefold() in taken:  # some file systems tell no capitals
            name = safe_name(path.name if count == 1 else f"{path.name}-{count}")
            count += 1
        taken.add(name.casefold())
        folders.append(base / name)
    return folders


def _ledger(ledger: bool, accuracy: str | None, until: str | None, options: Options) -> AccuracyGoal | bool:
    """Whether there is a ledger, and the accuracy that it is held against, if any; complaints join ``asked``."""
    if accuracy is None and until is None:
        return ledger
    for name, value in (("--accuracy", accuracy), ("--until", until)):
        if value is None:
            options.complain(name, "missing-option", "an accuracy is one of a motion from 0 to a time: give both")
    if not ledger:
        options.complain("--accuracy", "conflicting-options", "only the ledger is held against it", "add --ledger")
    error, time = options.number("--accuracy", accuracy, LEAST_ERROR, MOST_ERROR), options.number("--until", until)
    if error is None or time is None:
        return ledger
    from mbsym.numerics.ledger.work import AccuracyGoal

    return AccuracyGoal(error, time)
