"""Problem 12 in LaTeX: its sentences filled, its coefficients as equations."""

from __future__ import annotations

import re

from mbsym.analysis.small import SmallParameters
from mbsym.formulas.latex import LatexNames
from mbsym.model.system import System
from mbsym.report.language import Language
from mbsym.report.latex.formulas import formula
from mbsym.report.latex.words import escaped
from mbsym.report.sections.small_parameters import told
from mbsym.report.words.expansion_words import Coefficient, Medium

_RELATIONS = {"!=": "\\neq", ">=": "\\ge"}


def of_small_parameters(
    found: SmallParameters, system: System, names: LatexNames, tongue: Language
) -> list[tuple[bool, str]]:
    """(whether it is an equation, text) of each line, in the language of the report."""
    write = Medium(
        names=lambda listed: "$" + ",\\, ".join(str(names[name]) for name in listed) + "$",
        formula=lambda x: f"${formula(x)}$",
        condition=lambda x, relation: f"${formula(x)} {_RELATIONS.get(relation, relation)} 0$",
        word=lambda word: escaped(tongue.say(word)),
    )

    def left(one: Coefficient) -> str:
        symbol = names[one.variable].accented("dot") if one.rate else str(names[one.variable])
        return f"{{{symbol}}}^{{({one.order})}}"

    lines: list[tuple[bool, str]] = []
    for one in told(found, system, write):
        if isinstance(one, list):
            lines += [(True, f"{left(x)} = {formula(x.formula)}") for x in one]
        else:
            text, values = one
            lines.append((False, _told(text, values, tongue)))
    return lines


def _told(english: str, values: dict[str, object], tongue: Language) -> str:
    text = tongue.sentence(english)
    if text == english:  # other languages write their own mathematics
        text = re.sub("(1/)?epsilon", r"$\1\\epsilon$", text.replace("[[small]] > 0", "[[small]]~$> 0$"))
    for name, value in values.items():
        text = text.replace(f"[[{name}]]", str(value))
    return text
