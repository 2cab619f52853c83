"""What each numbered problem shows, one problem a file, and what reports say besides.

A problem's module is found by its attribute: ``content(results)`` is what reports and the terminal say of it,
``data(found, system, write)`` its section of results.json.  Its part of report.wl is a template of that name in
``templates/wolfram``.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mbsym.analysis import Problem


def section_of(problem: Problem[Any]) -> Any:
    """The module that shows a problem."""
    return import_module(f"{__name__}.{problem.attribute}")
