"""The page on Python, from signatures and docstrings."""

from __future__ import annotations

import dataclasses
import inspect
import re
from collections.abc import Iterator
from typing import Any

from in_markdown import code, escaped, fenced

import mbsym
from mbsym import simulation, studies
from mbsym.analysis import Analysis
from mbsym.formulas.formula import Formula, Matrix
from mbsym.problems import energy, equations, equilibrium, integrals, kinematics, linearisation
from mbsym.problems.stability.problem import Stability
from mbsym.problems.stability.verdict import Verdict

_HEAD = """\
# Python

`import mbsym` gives the functions below; what they return follows. Only names that are listed here are meant for
others to use. [How to work in Python](../howto/python.md) shows them at work.
"""

_RESULTS = (
    Analysis,
    kinematics.Kinematics,
    energy.Energy,
    equations.Equations,
    equilibrium.Equilibrium,
    linearisation.Linearisation,
    Stability,
    Verdict,
    integrals.Integral,
    Formula,
    Matrix,
    simulation.Simulation,
    studies.TradeoffStudy,
    studies.ExtremesStudy,
    studies.EquilibriaStudy,
)


def page() -> str:
    """The page in Markdown."""
    parts = [_HEAD, "## Functions\n"]
    for name in mbsym.__all__:
        parts.append(_entry(f"mbsym.{name}", getattr(mbsym, name), 3))
    parts.append("## Results\n")
    for kind in _RESULTS:
        parts += [_entry(kind.__name__, kind, 3), *_members(kind)]
    return "\n".join(parts)


def _entry(title: str, what: Any, level: int) -> str:
    signature = "" if inspect.isclass(what) else _signature(what)
    head = f"{'#' * level} {code(title)}\n\n"
    return head + (fenced(f"{title}{signature}", "python") if signature else "") + "\n" + text(what)


def _members(kind: type) -> Iterator[str]:
    """What an object of a class has to offer: properties and methods of its own, with their docstrings."""
    fields = {field.name for field in dataclasses.fields(kind)} if dataclasses.is_dataclass(kind) else set()
    for name, member in _public(kind):
        if name in fields:
            continue
        found = member.fget if isinstance(member, property) else member
        doc = inspect.getdoc(found) or ""
        call = f"({', '.join(list(inspect.signature(found).parameters)[1:])})" if inspect.isfunction(member) else ""
        yield f"* {code(f'{name}{call}')}" + (f": {_inline(_first(doc))}" if doc else "") + "\n"
    shown = [field for field in dataclasses.fields(kind) if not field.name.startswith("_")] if fields else []
    if shown:
        listed = ", ".join(f"{code(field.name)} ({code(str(field.type))})" for field in shown)
        yield f"\nFields: {listed}.\n"


def _public(kind: type) -> Iterator[tuple[str, Any]]:
    seen: set[str] = set()
    for owner in kind.__mro__:
        if not owner.__module__.startswith("mbsym"):
            continue
        for name, member in vars(owner).items():
            offered = isinstance(member, property) or inspect.isfunction(member)
            if offered and not name.startswith("_") and name not in seen:
                seen.add(name)
                yield name, member


def text(what: Any) -> str:
    """A docstring in Markdown: paragraphs, and its indented blocks as code."""
    parts = []
    for block in re.split(r"\n\s*\n", inspect.getdoc(what) or ""):
        lines = block.split("\n")
        if all(line.startswith("    ") for line in lines):
            parts.append(fenced(inspect.cleandoc(block), "pycon" if ">>>" in block else "text"))
        else:
            parts.append(_inline(" ".join(lines)))
    return "\n\n".join(parts) + "\n"


def _first(doc: str) -> str:
    return " ".join(doc.split("\n\n")[0].split())


def _inline(prose: str) -> str:
    """Prose with its ``code`` as code."""
    pieces = re.split(r"(?::\w+:)?``?(.+?)``?", prose)
    return "".join(code(piece) if index % 2 else escaped(piece) for index, piece in enumerate(pieces))


def _signature(what: Any) -> str:
    """The parameters of a function, a line each, and what it returns."""
    found = inspect.signature(what)
    lines, named = [], False
    for parameter in found.parameters.values():
        if parameter.kind is inspect.Parameter.KEYWORD_ONLY and not named:
            lines.append("*")
            named = True
        lines.append(str(parameter))
    inside = "".join(f"    {line},\n" for line in lines)
    return f"(\n{inside}) -> {found.return_annotation}".replace("'", "")
