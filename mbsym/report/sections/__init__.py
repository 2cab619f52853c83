"""What each numbered problem shows, one problem a file, and what reports say besides.

A problem's module is found by its attribute: ``content(results)`` is what reports and the terminal say of it,
``data(found, system, write)`` its section of results.json, and of problems 9 to 12 ``formulas(found, system)`` what
model.py has.  What report.wl has beside the words is a template of that name in ``templates/wolfram``, if there is one.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any

from mbsym.algebra.parts import missing
from mbsym.report.content import Block, Heading, say

if TYPE_CHECKING:
    from mbsym.analysis import Problem
    from mbsym.report.results import Results


def section_of(problem: Problem[Any]) -> Any:
    """The module that shows a problem, or what stands for it where the problem is not installed."""
    try:
        return import_module(f"{__name__}.{problem.attribute}")
    except ImportError as error:
        if not missing(error):
            raise
        return NotThere(problem.number, problem.attribute)


@dataclass(frozen=True)
class NotThere:
    """In place of the module, of a problem that is not installed: why it has no result."""

    number: int
    attribute: str

    def content(self, results: Results) -> Iterator[Block]:
        yield Heading(self.attribute, say("Problem [[number]]", number=str(self.number)))
        yield from results.missing(self.number)
