"""Named intermediates in LaTeX: a passage is a paragraph that TeX may break between and inside its formulas.

Everything expands to plain LaTeX with amsmath: a section is put into other people's documents.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from mbsym.formulas.formula import Formula
from mbsym.formulas.latex import LatexNames, latex_names, latex_text
from mbsym.formulas.told import Told
from mbsym.report.words.passages import Passage

#: How paragraphs of formulas are set: TeX breaks lines only where the formulas say so, before plus and minus.
OPENING = "{\\raggedright\\binoppenalty=10000 \\relpenalty=10000 \\linepenalty=200 \\lineskiplimit=1pt \\lineskip=4pt\n"
PARAGRAPH, CLOSING = "\\hangindent=1.2em \\hangafter=1 \\noindent ", "\\par\n"


def paragraphs(told: Told[Any], found: Iterable[Passage], escaped: Callable[[str], str]) -> str:
    """Every passage as a paragraph, in one group."""
    names = latex_names(told.ring)
    return OPENING + "".join(PARAGRAPH + _sentence(x, names, escaped) + CLOSING for x in found) + "}"


def _sentence(passage: Passage, names: LatexNames, escaped: Callable[[str], str]) -> str:
    coordinate = f" ${names[passage.coordinate]}$" if passage.coordinate else ""
    formulas = [equation(str(names[item.name]), item.formula) for item in passage.definitions]
    return f"{escaped(passage.words)}{coordinate}: " + ";\\quad ".join(formulas) + "."


def equation(symbol: str, formula: Formula) -> str:
    """``$symbol = formula$``, which may be broken."""
    return f"$\\displaystyle {symbol} = {latex_text(formula.ring, formula.polynomial, breaks=True)}$"


def packed(entries: Iterable[tuple[str, Formula]], symbol: str, key: str) -> str:
    """Entries of a matrix, by their indices, side by side in one paragraph with one number, which ``key`` labels."""
    written = ";\\quad ".join(equation(f"{symbol}_{{{index}}}", entry) for index, entry in entries)
    number = f"\\refstepcounter{{equation}}\\label{{{key}}}%\n"
    return f"{OPENING}{PARAGRAPH}{number}{written}.\\quad\\hfill\\hbox{{(\\theequation)}}{CLOSING}}}"
