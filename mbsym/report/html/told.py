"""Long formulas told through named intermediates, in HTML: passages, in which definitions follow one another."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from markupsafe import Markup, escape

from mbsym.formulas.formula import Formula
from mbsym.formulas.mathml import MathNames, mathml_names, mathml_pieces, mo
from mbsym.formulas.told import Told
from mbsym.report.html.formulas import math
from mbsym.report.words.passages import Passage


def told_passages(told: Told[Any], found: Iterable[Passage], say: Callable[[str], Markup] = escape) -> Markup:
    """A phrase, then the definitions that it introduces, for every passage."""
    names = mathml_names(told.ring)
    return Markup("").join(_passage(passage, names, say) for passage in found)


def _passage(passage: Passage, names: MathNames, say: Callable[[str], Markup]) -> Markup:
    coordinate = Markup(" ") + math(str(names[passage.coordinate])) if passage.coordinate else Markup("")
    written = "; ".join(_equation(str(names[item.name]), item.formula) for item in passage.definitions)
    return Markup(f'<p>{say(passage.words)}{coordinate}:</p>\n<div class="formula told">{written}.</div>\n')


def _equation(left: str, formula: Formula) -> str:
    first, *rest = mathml_pieces(formula.ring, formula.polynomial)
    return " ".join(f"<math>{piece}</math>" for piece in [left + mo("=") + first, *rest])
