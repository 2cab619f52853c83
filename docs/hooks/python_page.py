"""The page on Python, from signatures and docstrings."""

from __future__ import annotations

import dataclasses
import inspect
import re
from collections.abc import Iterator, Sequence
from typing import Any

from in_markdown import code, escaped, fenced, table

import mbsym
from mbsym import simulation
from mbsym.analysis import PROBLEMS, Analysis
from mbsym.formulas.formula import Formula, Matrix
from mbsym.problems import energy, equations, equilibrium, integrals, kinematics, linearisation
from mbsym.problems.stability.problem import Stability
from mbsym.problems.stability.verdict import Verdict
from mbsym.studies import tables

_HEAD = """\
# Python

`import mbsym` gives the functions below; what they return follows. Only names that are listed here are meant for
others to use. [How to work in Python](../howto/python.md) shows them at work.
"""

#: The classes of results, and what of each is meant for others; other members are the machinery's own.
_RESULTS: dict[type, tuple[str, ...]] = {
    kinematics.Kinematics: ("body", "bodies"),
    kinematics.BodyKinematics: (),
    energy.Energy: ("kinetic_energy", "A2", "A1", "A0", "force_function", "cyclic"),
    equations.Equations: ("mass_matrix", "forcing", "generalized_force"),
    equilibrium.Equilibrium: ("satisfied", "residuals", "conditions", "solved", "impossible", "unsteady"),
    linearisation.Linearisation: (
        *("coordinates", "M", "D", "G", "K", "N", "subsystems", "time_scale", "route", "time_dependence"),
    ),
    linearisation.Subsystem: (),
    Stability: ("subsystems", "verdict", "numerical", "spectra"),
    Verdict: ("word", "theorem", "theorems", "explanation", "stable"),
    integrals.Integral: ("name", "kind", "of", "formula", "status"),
    Formula: ("text", "latex", "wolfram", "to_sympy", "subs", "terms", "degree", "is_zero"),
    Matrix: ("shape", "latex", "to_sympy", "is_zero", "terms"),
    simulation.Simulation: (
        *("system", "times", "coordinates", "velocities", "energy", "generalized_energy", "conservation", "error"),
        *("energy_conservation", "invariants", "method", "why", "arithmetic", "whole", "ended"),
    ),
    tables.Table: (),
    tables.TradeoffStudy: ("runs", "models", "advice", "reference_error"),
    tables.ExtremesStudy: ("digits", "verdicts", "singular", "singular_complete", "sentences", "left_out"),
    tables.EquilibriaStudy: ("table", "complete", "remarks"),
}


def page() -> str:
    """The page in Markdown."""
    parts = [_HEAD, "## Functions\n"]
    for name in mbsym.__all__:
        parts.append(_entry(f"mbsym.{name}", getattr(mbsym, name), 3))
    parts += ["## Results\n", "### `Analysis`\n", text(Analysis), *_problems()]
    for kind, offered in _RESULTS.items():
        parts += [_entry(kind.__name__, kind, 3), *_members(kind, offered)]
    return "\n".join(parts)


def _problems() -> Iterator[str]:
    """The attributes of an analysis: the numbered problems, and what stands beside them."""
    problems = [(problem.attribute, f"problem {number}, {problem.title}") for number, problem in PROBLEMS.items()]
    others = [("checks", "the self-check"), ("claims", "what became of the claims"), ("equilibria", "at the values")]
    for name, _ in others:
        getattr(Analysis, name)
    yield table(("attribute", "what it holds"), [(code(name), escaped(held)) for name, held in problems + others])


def _entry(title: str, what: Any, level: int) -> str:
    signature = "" if inspect.isclass(what) else _signature(what)
    head = f"{'#' * level} {code(title)}\n\n"
    return head + (fenced(f"{title}{signature}", "python") if signature else "") + "\n" + text(what)


def _members(kind: type, offered: Sequence[str]) -> Iterator[str]:
    """What an object of a class has to offer, all fields where nothing is chosen: types, first paragraphs."""
    fields = {field.name: field for field in dataclasses.fields(kind)} if dataclasses.is_dataclass(kind) else {}
    rows = []
    for name in offered or fields:
        if name in fields:
            rows.append((code(name), escaped(str(fields[name].type)), ""))
            continue
        member = inspect.getattr_static(kind, name)
        found = getattr(member, "fget", None) or getattr(member, "func", None) or member
        called = inspect.isfunction(member)
        shown = f"{name}({', '.join(list(inspect.signature(found).parameters)[1:])})" if called else name
        returned = str(inspect.signature(found).return_annotation)
        rows.append((code(shown), escaped(returned), _inline(_first(inspect.getdoc(found) or ""))))
    width = 3 if any(row[2] for row in rows) else 2
    yield table(("member", "type", "what it is")[:width], [row[:width] for row in rows])


def text(what: Any) -> str:
    """A docstring in Markdown: paragraphs, and its indented blocks as code."""
    parts: list[str] = []
    doc = inspect.getdoc(what) or ""
    if inspect.isclass(what) and doc.startswith(f"{what.__name__}("):
        return ""  # a dataclass without a docstring of its own
    for block in re.split(r"\n\s*\n", doc):
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
