"""Problem 11 in LaTeX: its sentences filled."""

from __future__ import annotations

from collections.abc import Mapping

from mbsym.formulas.latex import LatexNames
from mbsym.problems.normal_forms import NormalForms
from mbsym.report.language import Language
from mbsym.report.latex.formulas import formula
from mbsym.report.latex.words import escaped
from mbsym.report.words.normal_form_words import Medium, sentences


def of_normal_forms(found: NormalForms, names: LatexNames, tongue: Language) -> list[str]:
    """The sentences in the language of the report."""
    write = Medium(
        names=lambda listed: "$" + ",\\, ".join(str(names[name]) for name in listed) + "$",
        formula=lambda x: f"${formula(x)}$",
        math=lambda _, tex: f"${tex}$",
        word=lambda word: escaped(tongue.say(word)),
    )
    return [_told(text, values, tongue) for text, values in sentences(found, write)]


#: How mathematics in the English sentences, which the terminal shows as they are, is written in LaTeX.
_MATHEMATICS = {
    "Omega.I = 0": r"$\Omega \cdot I = 0$",
    **{f"{letter}{order}": f"${letter}_{order}$" for letter in "DH" for order in (4, 6)},
    **{f"w{k}": f"$\\omega_{k}$" for k in (1, 2)},
}


def _told(english: str, values: Mapping[str, object], tongue: Language) -> str:
    text = tongue.sentence(english)
    if text == english:
        for plain, tex in _MATHEMATICS.items():
            text = text.replace(plain, tex)
    for name, value in values.items():
        text = text.replace(f"[[{name}]]", str(value))
    return text
