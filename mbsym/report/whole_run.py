"""A whole run of one system: everything that its files show is derived, the files are rendered, what is lost is listed.

Whatever fails stays where it happened: a formula in its problem, a problem in its file.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.analysis.stages import NoResult
    from mbsym.report.rendering import Rendered

#: Says what is being done.
Say = Callable[[str], None]

#: The formats that are made beside the others: about half of the work of all of them.
APART = ("latex",)


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


def _nothing() -> None: ...


def derive_all(
    analysis: Analysis,
    formats: Iterable[str],
    say: Say,
    beside: Beside = unhelped,
    meanwhile: Callable[[], None] = _nothing,
) -> None:
    """Everything that the files and the terminal will show, in order.

    Checks are carried out ``beside`` the verdict of stability, which they do not read, and ``meanwhile``; what is said
    then waits for them.
    """
    from mbsym.analysis import PROBLEMS, second_routes
    from mbsym.report.targets import FORMATS

    def derive(late: bool) -> None:
        for number in analysis.problems:
            if late == (PROBLEMS[number].attribute == "stability"):
                say(f"problem {number}, {PROBLEMS[number].title}")
                analysis.stage(number)

    with analysis.unvouched():
        derive(late=False)
        if any(FORMATS[name].program for name in formats):
            analysis.optional("programs")
        defects = len(analysis.defects)
        with beside(lambda: second_routes.carried_out(analysis), lambda _: len(analysis.defects) == defects) as found:
            derive(late=True)
            meanwhile()
            say("self-check")
            analysis.take(found())
    if analysis.system.claims:
        say("claims")
        _ = analysis.claims
    say("self-check")
    _ = analysis.checks


def rendered_all(analysis: Analysis, formats: Iterable[str], say: Say, beside: Beside = unhelped) -> list[Rendered]:
    """The files of some formats, those of one format all or none; about half of them made ``beside`` the others."""
    from mbsym.report.rendering import rendered
    from mbsym.report.targets import FORMATS

    formats = tuple(formats)
    made: dict[str, tuple[Rendered, ...]] = {}

    def make(name: str) -> tuple[Rendered, ...]:
        say(f"writing {FORMATS[name].filename}")
        return rendered(FORMATS[name], analysis, analysis.problems)

    def whole(files: list[tuple[Rendered, ...]]) -> bool:
        return not any(file.failure or file.withheld for several in files for file in several)

    here = [name for name in formats if name not in APART]
    apart = [name for name in formats if name in APART]
    with (beside if here else unhelped)(lambda: [make(name) for name in apart], whole) as others:
        made |= {name: make(name) for name in here}
        made |= dict(zip(apart, others(), strict=True))
    return [file for name in formats for file in made[name]]


def lost(analysis: Analysis, files: Iterable[Rendered]) -> list[tuple[str, NoResult]]:
    """What the program is at fault for: problems that ended in an internal error, files that cannot be written."""
    failures = [(f"problem {number}", analysis.stage(number).failure) for number in analysis.problems]
    found = [(where, failure) for where, failure in failures if failure is not None and failure.error is not None]
    for file in files:
        if file.failure is not None:
            found.append((f"{file.filename} cannot be written", file.failure))
        found += [(f"{file.filename}: problem {number} cannot be written", why) for number, why in file.withheld]
    return found
