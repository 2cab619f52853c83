"""Problem 8 in LaTeX: its sentences filled, and matrices of rational numbers."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from mbsym.formulas.formula import Formula
from mbsym.formulas.latex import LatexNames
from mbsym.problems.stabilisation import Stabilisation
from mbsym.report.language import Language
from mbsym.report.latex.formulas import formula, polynomial
from mbsym.report.latex.words import escaped
from mbsym.report.lengths import length
from mbsym.report.words.stabilisation_words import Medium, sentences

_RELATIONS = {"!=": "\\neq"}


def of_stabilisation(found: Stabilisation, names: LatexNames, tongue: Language) -> list[str]:
    """The sentences in the language of the report."""

    def counted(x: Formula) -> str:
        said = length(x)
        return f"\\text{{({tongue.sentence(said.text, **said.gaps)})}}"

    write = Medium(
        names=lambda listed: "$" + ",\\, ".join(str(names[name]) for name in listed) + "$",
        condition=lambda x, relation: f"${formula(x)} {_RELATIONS.get(relation, relation)} 0$",
        formula=lambda x: f"${formula(x)}$",
        polynomial=lambda factor: f"${polynomial(factor, chr(92) + 'lambda', counted)}$",
        square=lambda x: f"$\\lambda^2 = -({formula(x)})$",
        word=lambda word: escaped(tongue.say(word)),
    )
    return [tongue.sentence(text, **values) for text, values in sentences(found, write)]


def rational(x: Fraction) -> str:
    """A number that was rounded in decimals as a decimal, another one as a fraction."""
    text = f"{float(x):.15g}"
    if "e" not in text and Fraction(text) == x:
        return text
    return str(x.numerator) if x.denominator == 1 else f"\\tfrac{{{x.numerator}}}{{{x.denominator}}}"


def rational_matrix(rows: Sequence[Sequence[Fraction]]) -> str:
    lines = " \\\\ ".join(" & ".join(map(rational, row)) for row in rows)
    return f"\\begin{{pmatrix}} {lines} \\end{{pmatrix}}"


def rational_row(row: Sequence[Fraction]) -> str:
    return ",\\ \\allowbreak ".join(map(rational, row))
