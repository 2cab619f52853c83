"""A whole run of one system: everything that its files show is derived, the files are rendered, what is lost is listed.

Whatever fails stays where it happened: a formula in its problem, a problem in its file.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.analysis.stages import NoResult
    from mbsym.report.rendering import Rendered

#: Says what is being done.
Say = Callable[[str], None]


def derive_all(analysis: Analysis, formats: Iterable[str], say: Say) -> None:
    """Everything that the files and the terminal will show, in order."""
    from mbsym.analysis import PROBLEMS
    from mbsym.report.targets import FORMATS

    for number in analysis.problems:
        say(f"problem {number}, {PROBLEMS[number].title}")
        analysis.stage(number)
    if any(FORMATS[name].program for name in formats):
        analysis.optional("programs")
    if analysis.system.claims:
        say("claims")
        _ = analysis.claims
    say("self-check")
    _ = analysis.checks


def rendered_all(analysis: Analysis, formats: Iterable[str], say: Say) -> Iterator[Rendered]:
    """The files of some formats, those of one format all or none."""
    from mbsym.report.rendering import rendered
    from mbsym.report.targets import FORMATS

    for name in formats:
        say(f"writing {FORMATS[name].filename}")
        yield from rendered(FORMATS[name], analysis, analysis.problems)


def lost(analysis: Analysis, files: Iterable[Rendered]) -> list[tuple[str, NoResult]]:
    """What the program is at fault for: problems that ended in an internal error, files that cannot be written."""
    failures = [(f"problem {number}", analysis.stage(number).failure) for number in analysis.problems]
    found = [(where, failure) for where, failure in failures if failure is not None and failure.error is not None]
    for file in files:
        if file.failure is not None:
            found.append((f"{file.filename} cannot be written", file.failure))
        found += [(f"{file.filename}: problem {number} cannot be written", why) for number, why in file.withheld]
    return found
