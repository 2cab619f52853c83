"""mbsym: exact symbolic mechanics of multibody systems from a text description.

    >>> import mbsym
    >>> pendulum = mbsym.load("systems/simple-pendulum.yaml")
    >>> pendulum.energy.cyclic
    ()

``load`` reads a description (YAML or the editor's text) and returns an ``Analysis`` whose attributes ``kinematics``,
``energy``, ``equations``, ``equilibrium``, ``linearisation``, ``stability``, ``integrals``, ``claims`` and ``checks``
are derived when they are first asked for.  Matrices print as LaTeX in a notebook and convert with ``.to_sympy()``.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mbsym.analysis import Analysis

__version__ = "0.1.0"
__all__ = ["DescriptionError", "load", "loads"]


class DescriptionError(ValueError):
    """A description with complaints; the message holds all of them, each with file, line and column."""


def load(path: str | Path, problems: Iterable[int] = (1, 2, 3, 4, 5, 6, 7)) -> Analysis:
    """The analysis of a description file.  Raises DescriptionError with every complaint, OSError never."""
    from mbsym.source import load as read_file

    system, complaints, text = read_file(Path(path))
    return _analysis(system, complaints, text, str(path), problems)


def loads(text: str, problems: Iterable[int] = (1, 2, 3, 4, 5, 6, 7)) -> Analysis:
    """The analysis of a description given as text."""
    from mbsym.source import read

    system, complaints = read(text)
    return _analysis(system, complaints, text, "<string>", problems)


def _analysis(system, complaints, text, name, problems) -> Analysis:  # type: ignore[no-untyped-def]
    from mbsym.analysis import Analysis
    from mbsym.source import render

    if system is None:
        raise DescriptionError("\n".join(render(item, text, name) for item in complaints.sorted()))
    return Analysis(system, problems)
