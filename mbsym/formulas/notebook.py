"""How results show themselves: a short line in a console, LaTeX in a notebook."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import Any

from mbsym.algebra.ring import Ring
from mbsym.expressions.guessing import GuessesNames
from mbsym.formulas.formula import Formula, Matrix

#: Formulas of more terms than this are counted in a notebook.
LONGEST = 60


class Shown(GuessesNames):
    """A frozen dataclass (declared with ``repr=False``) of formulas, matrices and words."""

    __slots__ = ()

    def __repr__(self) -> str:
        parts = (f"{name}: {_short(value)}" for name, value in _parts(self))
        return f"{type(self).__name__}({', '.join(parts)})"

    def _repr_latex_(self) -> str:
        lines = [f"\\text{{{_tex(name.replace('_', ' '))}}} &= {_latex(value)}" for name, value in _parts(self)]
        return "$\\displaystyle \\begin{aligned} " + " \\\\ ".join(lines) + " \\end{aligned}$"


def _parts(found: Any) -> list[tuple[str, Any]]:
    every = ((field.name, getattr(found, field.name)) for field in fields(found))
    return [(name, value) for name, value in every if not isinstance(value, Ring)]


def _short(value: Any) -> str:
    if isinstance(value, Formula):
        return str(value) if value.terms <= 4 else f"{value.terms} terms"
    if isinstance(value, Matrix):
        return "x".join(map(str, value.shape))
    if isinstance(value, (tuple, list)):
        return f"({', '.join(map(_short, value))})" if _is_short(value) else f"{len(value)} entries"
    if isinstance(value, str):
        return str(value)
    written = repr(value)
    return type(value).__name__ if is_dataclass(value) and len(written) > 80 else written


def _is_short(value: Any) -> bool:
    return len(value) <= 6 and not any(is_dataclass(item) and not isinstance(item, Formula) for item in value)


def _latex(value: Any) -> str:
    if isinstance(value, Formula):
        return value.latex() if value.terms <= LONGEST else f"\\text{{({value.terms} terms)}}"
    if isinstance(value, Matrix):
        rows = " \\\\ ".join(" & ".join(_latex(x) for x in row) for row in value)
        return f"\\begin{{pmatrix}} {rows} \\end{{pmatrix}}"
    if isinstance(value, (tuple, list)) and value and all(isinstance(x, Formula) for x in value):
        return _column(value)
    return f"\\text{{{_tex(_short(value))}}}"


def _column(values: Any) -> str:
    body = " \\\\ ".join(map(_latex, values))
    return f"\\begin{{pmatrix}} {body} \\end{{pmatrix}}"


_ESCAPES = {
    "\\": "\\textbackslash{}", "{": "\\{", "}": "\\}", "$": "\\$", "&": "\\&", "#": "\\#", "%": "\\%", "_": "\\_",
    "^": "\\textasciicircum{}", "~": "\\textasciitilde{}",
}  # fmt: skip


def _tex(text: str) -> str:
    return "".join(_ESCAPES.get(character, character) for character in text)
