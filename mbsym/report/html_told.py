"""Long equations told through named intermediates, in HTML: passages first, then the equations in their terms."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from markupsafe import Markup

from mbsym.formulas.mathml import mathml_names, mathml_pieces, mo
from mbsym.report.html_formulas import entries, math, symbol
from mbsym.report.passages import Passage, passages

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.formulas.formula import Formula

#: Equations with fewer terms are read as they are.
LONG = 150


@dataclass(frozen=True)
class ToldLines:
    """``words``, the coordinate that ends them (or nothing), and the formulas that they introduce."""

    words: str
    coordinate: Markup
    formulas: Markup


@dataclass(frozen=True)
class ToldEquations:
    """Passages in order, the lines of M and f, and the terms of all of them, and of the equations expanded."""

    passages: tuple[ToldLines, ...]
    mass_matrix: Markup
    forcing: Markup
    terms: int
    expanded: int


def told_equations(analysis: Analysis) -> ToldEquations | None:
    """The equations of problem 3 through named intermediates; None where they are short, or that is no shorter."""
    from mbsym.analysis import Unavailable

    closed = analysis.equations
    expanded = closed.mass_matrix.terms + sum(x.terms for x in closed.forcing)
    if expanded < LONG:
        return None
    try:
        found = analysis.told
    except Unavailable:
        return None
    wanted = [entry for _, entry in entries(found.mass_matrix, True)] + list(found.forcing)
    used = found.told.wanted(wanted)
    terms = sum(x.terms for x in wanted) + sum(x.formula.terms for x in used)
    if 2 * terms > expanded:
        return None
    names = mathml_names(found.told.ring)
    lines = []
    for passage in passages(found.told, analysis.system, wanted):
        coordinate = math(str(names[passage.coordinate])) if passage.coordinate else Markup("")
        lines.append(ToldLines(passage.words, coordinate, _definitions(passage)))
    mass = [(symbol("M", index), entry) for index, entry in entries(found.mass_matrix, True)]
    forces = [(symbol("f", str(k)), x) for k, x in enumerate(found.forcing, start=1)]
    return ToldEquations(tuple(lines), _each(mass), _each(forces), terms, expanded)


def _definitions(passage: Passage) -> Markup:
    """Definitions one after the other in one paragraph."""
    written = []
    for item in passage.definitions:
        name = str(mathml_names(item.formula.ring)[item.name])
        written.append(" ".join(f"<math>{piece}</math>" for piece in _equation(name, item.formula)))
    return Markup(f'<div class="formula told">{"; ".join(written)}.</div>')


def _each(items: list[tuple[Markup, Formula]]) -> Markup:
    """Equations, a line each."""
    lines = []
    for left, formula in items:
        pieces = " ".join(f"<math>{piece}</math>" for piece in _equation(str(left), formula))
        lines.append(f'<div class="formula">{pieces}</div>')
    return Markup("".join(lines))


def _equation(left: str, formula: Formula) -> list[str]:
    first, *rest = mathml_pieces(formula.ring, formula.polynomial)
    return [left + mo("=") + first, *rest]
