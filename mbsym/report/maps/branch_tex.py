r"""Branches of equilibria as LaTeX to \input: the diagram, the numbers of equilibria, the critical values."""

from __future__ import annotations

from typing import Any

from flint import fmpq

from mbsym.algebra.plane.numbers import enclosure
from mbsym.formulas.latex import LatexNames
from mbsym.maps.branches_result import Branches
from mbsym.model.system import System
from mbsym.report.language import Language
from mbsym.report.maps.branch_words import critical_words
from mbsym.report.maps.tex import escaped

#: Longer minimal polynomials are told by their degree.
MOST_DEGREE = 6


def branch_tex(system: System, found: Branches, language: Language) -> str:
    """Needs graphicx; the picture is branches.pdf in the same folder."""
    name = LatexNames([found.axis.name])[found.axis.name]
    fixed = LatexNames(list(found.given))
    values = ", ".join(f"${fixed[key]} = {value}$" for key, value in found.given.items())
    caption = f"{language.say('Relative equilibria of')} {escaped(system.name)}" + (f"; {values}" if values else "")
    lines = [
        "% needs \\usepackage{graphicx}; written by mbsym equilibria --vary",
        r"\begin{figure}",
        r"\centering",
        r"\includegraphics[width=\columnwidth]{branches.pdf}",
        rf"\caption{{{caption}.}}",
        r"\end{figure}",
        "",
        r"\noindent " + language.say("Numbers of equilibria:"),
        r"\begin{itemize}",
    ]
    for one, last in found.spans():
        low, high = number_tex(one.low), number_tex(last.high)
        doubt = "" if one.constant else f" ({language.say('not proved to be constant')})"
        stable = f"{language.say('of them stable')} {one.stable}"
        stable += f", {language.say('undecided')} {one.undecided}" if one.undecided else ""
        lines.append(rf"\item ${low} < {name} < {high}$: {len(one.equilibria)}, {stable}{doubt}")
    lines.append(r"\end{itemize}")
    told = [(one, words) for one in found.criticals if (words := critical_words(found, one, language))]
    if told:
        lines += ["", r"\noindent " + language.say("Critical values:"), r"\begin{itemize}"]
        lines += [rf"\item ${name} = {number_tex(one.number)}$: {escaped(words)}" for one, words in told]
        lines.append(r"\end{itemize}")
    return "\n".join(lines) + "\n"


def number_tex(x: Any) -> str:
    """A rational number, a square root, or digits that end in dots."""
    if isinstance(x, fmpq):
        return str(x)
    c = x.polynomial.coeffs()
    if len(c) == 3 and c[1] == 0 and c[2] == 1:
        return ("-" if float(x) < 0 else "") + rf"\sqrt{{{-c[0]}}}"
    return f"{float(enclosure(x).mid()):.8g}" + r"\ldots"
