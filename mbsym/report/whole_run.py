"""A whole run of one system: everything that its files show is derived, the files are rendered, what is lost is listed.

Whatever fails stays where it happened: a formula in its problem, a problem in its file.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any, Protocol

from mbsym.algebra.failures import Defect, Failure, Severity
from mbsym.algebra.ring import TERM_BUDGET
from mbsym.analysis.stages import NoResult
from mbsym.expressions.message import Message, joined, worded
from mbsym.report.targets import FORMATS, Target, shown_by

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.formulas.tree import Angles
    from mbsym.model.system import System
    from mbsym.problems.checks import Check


# From an analysis to a file that can be delivered.
#
# A result that cannot be written costs its own section of one file; the others are delivered.


@dataclass(frozen=True)
class Rendered:
    """``text`` of a file (the bytes of one that is no text), or None where there is none and ``failure`` says why (no
    failure: it was not wanted).

    ``withheld`` are the problems that it cannot show, with why.
    """

    filename: str
    text: str | bytes | None
    failure: NoResult | None = None
    withheld: tuple[tuple[int, NoResult], ...] = ()


def rendered(target: Target, analysis: Analysis, problems: Sequence[int]) -> tuple[Rendered, ...]:
    """A target's files, its companions with it: all of them, or none."""
    targets = [part for part in target.companions if part.applies(analysis, problems)]
    without = tuple(Rendered(part.filename, None) for part in target.companions if part not in targets)
    files = tuple(_rendered(part, analysis, problems) for part in (target, *targets))
    failed = next((file for file in files if file.text is None), None)
    if failed is None:
        return files + without
    return tuple(Rendered(file.filename, None, file.failure or failed.failure) for file in files) + without


def _rendered(target: Target, analysis: Analysis, problems: Sequence[int]) -> Rendered:
    try:
        return Rendered(target.filename, target.render(analysis, problems))
    except Exception as error:
        whole = _no_result(error)
    withheld: dict[int, NoResult] = {}
    for number in problems:
        if number in target.shows and analysis.stage(number).failure is None:
            try:
                target.render(analysis, (number,))
            except Exception as error:
                withheld[number] = _no_result(error)
                _remember(analysis, withheld[number])
    if withheld:
        analysis.withheld = withheld
        try:
            text = target.render(analysis, problems)
            return Rendered(target.filename, text, withheld=tuple(withheld.items()))
        except Exception as error:
            whole = _no_result(error)
        finally:
            analysis.withheld = {}
    _remember(analysis, whole)
    return Rendered(target.filename, None, whole)


def _no_result(error: Exception) -> NoResult:
    """What a reader is told; the exception goes with it."""
    return NoResult.of(error if isinstance(error, Failure) else Defect.of(error))


def _remember(analysis: Analysis, failure: NoResult) -> None:
    if failure.severity is Severity.DEFECT and failure.error is not None:
        analysis.defects.append(failure.error)


#: Says what is being done.
Say = Callable[[str], None]

#: The files of a format, by its name.
Files = dict[str, tuple["Rendered", ...]]

#: What is made beside verdicts, once checks are: these files tell nothing else.
EARLY = ("python", "c")

#: What is made beside the other files: about half of the work.
APART = ("latex", "json")


class Beside(Protocol):
    """Begins work beside what is done meanwhile; yields what waits for its value (``mbsym_cli.beside``).

    Where the work is done by somebody else, only a ``sound`` value is taken from him; all else is done again here.
    """

    def __call__(
        self, work: Callable[[], Any], sound: Callable[[Any], bool]
    ) -> AbstractContextManager[Callable[[], Any]]: ...


@contextmanager
def unhelped(work: Callable[[], Any], sound: Callable[[Any], bool]) -> Iterator[Callable[[], Any]]:
    """Nobody helps: the work is done when its value is wanted."""
    yield work


def silent(_: str) -> None:
    """Nobody is watching."""


def analysis_of(
    system: System, problems: Iterable[int] | None, formats: Iterable[str], terms: int = TERM_BUDGET
) -> Analysis:
    """What is to be derived: the problems that were named, else those of the system that the formats show."""
    from mbsym.analysis import Analysis
    from mbsym.analysis.given import chosen

    return Analysis(system, chosen(system, shown_by(formats)) if problems is None else problems, terms)


def whole_run(
    analysis: Analysis, formats: Sequence[str], say: Say, beside: Beside = unhelped, angles: Angles | None = None
) -> list[Rendered]:
    """Everything derived, and the files of these formats; ``angles``: the form of those in every file."""
    from mbsym.formulas.tree import angles_as

    early = derive_all(analysis, formats, say, beside, lambda: angles_as(angles))
    with angles_as(angles):
        return rendered_all(analysis, formats, say, beside, early)


def remarks(formats: Iterable[str], files: Collection[str]) -> Iterator[str]:
    """What is to be told of files that were made here."""
    for target in (FORMATS[name] for name in formats):
        words = target.remark() if target.remark is not None and target.filename in files else ""
        if words:
            yield joined((target.filename, worded(words)), ": ")


def derive_all(
    analysis: Analysis,
    formats: Iterable[str],
    say: Say,
    beside: Beside = unhelped,
    writing: Callable[[], AbstractContextManager[None]] = nullcontext,
) -> Files:
    """Everything that the files and the terminal will show, in order; files that were made on the way, if any.

    Where somebody helps he carries out the checks and makes the files of the program ``beside`` the verdict of
    stability, which needs neither, and the telling of long formulas; what is said then waits for the checks.  Files are
    made as ``writing`` has them.
    """
    from mbsym.analysis import PROBLEMS
    from mbsym.analysis.forms import requested_forms
    from mbsym.analysis.second_routes import carried_out
    from mbsym.report.canonical import TITLES
    from mbsym.report.content import Said
    from mbsym.report.language import Language
    from mbsym.report.plain_writer import Writer
    from mbsym.report.results import contents, results

    write = Writer(Language(analysis.language or analysis.system.language))
    known = contents(results(analysis, analysis.problems), write.document)

    def derive(late: bool) -> None:
        for number in analysis.problems:
            if late == (PROBLEMS[number].attribute == "stability"):
                say(write.said(known[number].title))
                analysis.stage(number)

    helped = beside is not unhelped
    with analysis.unvouched():
        derive(late=False)
        for name in requested_forms(analysis):
            say(write.said(Said(TITLES[name])))
            analysis.optional(name)
        if any(FORMATS[name].program for name in formats):
            analysis.optional("programs")
    if helped:
        import_module("jinja2")  # which both need
    defects = len(analysis.defects)
    early = [name for name in formats if name in EARLY] if helped else []

    def work() -> tuple[list[Check], Files]:
        checks = carried_out(analysis)
        with writing():
            return checks, _made(early, analysis, silent)

    with beside(work, lambda outcome: len(analysis.defects) == defects and _whole(outcome[1])) as outcome:
        with analysis.unvouched():
            derive(late=True)
            if helped:
                _prepare(formats, analysis, writing)
        say(write.said(Said("Self-check")))
        checks, files = outcome()
    analysis.take(checks)
    if analysis.system.claims:
        say(write.said(Said("Claims")))
        _ = analysis.claims
    _ = analysis.checks
    return files


def rendered_all(
    analysis: Analysis, formats: Iterable[str], say: Say, beside: Beside = unhelped, files: Files | None = None
) -> list[Rendered]:
    """The files of some formats, those of one format all or none; ``files`` are there already.

    About half of them are made ``beside`` the others.
    """
    made = dict(files or {})
    missing = [name for name in formats if name not in made]
    apart = [name for name in missing if name in APART]
    here = [name for name in missing if name not in APART]
    with (beside if here and apart else unhelped)(lambda: _made(apart, analysis, say), _whole) as others:
        made |= _made(here, analysis, say)
        made |= others()
    return [file for name in formats for file in made[name]]


def _prepare(formats: Iterable[str], analysis: Analysis, writing: Callable[[], AbstractContextManager[None]]) -> None:
    """What the files for people will find made.  Who cannot do without it meets what goes wrong when he asks."""
    from mbsym.report.compact import compact

    if not {"latex", "html"}.isdisjoint(formats):
        with suppress(Exception), writing():
            compact(analysis, {number: analysis.stage(number).value for number in analysis.problems})


def _made(formats: Iterable[str], analysis: Analysis, say: Say) -> Files:
    made = {}
    for name in formats:
        say(f"writing {FORMATS[name].filename}")
        made[name] = rendered(FORMATS[name], analysis, analysis.problems)
    return made


def _whole(made: Files) -> bool:
    return not any(file.failure or file.withheld for files in made.values() for file in files)


def lost(analysis: Analysis, files: Iterable[Rendered]) -> list[tuple[str, NoResult]]:
    """What the program is at fault for: problems that ended in an internal error, files that cannot be written."""
    failures = [
        (Message("problem [[number]]", number=number), analysis.stage(number).failure) for number in analysis.problems
    ]
    losses: list[tuple[str, NoResult]] = [
        (where, failure) for where, failure in failures if failure is not None and failure.error is not None
    ]
    for file in files:
        if file.failure is not None:
            losses.append((Message("[[file]] cannot be written", file=file.filename), file.failure))
        text = "[[file]]: problem [[number]] cannot be written"
        losses += [(Message(text, file=file.filename, number=number), why) for number, why in file.withheld]
    return losses
