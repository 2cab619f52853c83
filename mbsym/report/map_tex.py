r"""A map as LaTeX to \input: the picture with its caption, and the equations of its curves."""

from __future__ import annotations

from typing import Any

from mbsym.formulas.latex import LatexNames
from mbsym.maps.result import Of, PlaneMap
from mbsym.model.system import System
from mbsym.report.language import Language
from mbsym.report.map_figure import lettered
from mbsym.report.map_language import say
from mbsym.report.map_words import condition_words, telling

#: Longer polynomials are told by their degrees and number of terms.
MOST_TERMS = 14

_ESCAPED = {
    "_": r"\_",
    "#": r"\#",
    "%": r"\%",
    "&": r"\&",
    "$": r"\$",
    "{": r"\{",
    "}": r"\}",
    "\\": r"\textbackslash{}",
}
_ESCAPED |= {"<": r"\textless{}", ">": r"\textgreater{}", "^": r"\textasciicircum{}", "~": r"\textasciitilde{}"}


def map_tex(system: System, found: PlaneMap, language: Language) -> str:
    """Needs graphicx; the picture is map.pdf in the same folder."""
    names = LatexNames([axis.name for axis in found.section.axes])
    x, y = (f"${names[axis.name]}$" for axis in found.section.axes)
    fixed = LatexNames(list(found.section.told))
    values = ", ".join(f"${fixed[name]} = {_rational(value)}$" for name, value in found.section.told.items())
    what = "Degree of instability of" if found.of is Of.SIGNATURE else "Stability of"
    caption = f"{say(language, what)} {_text(system.name)}: ({x}, {y})" + (f"; {values}" if values else "") + "."
    lines = [
        "% needs \\usepackage{graphicx}; written by mbsym map",
        r"\begin{figure}",
        r"\centering",
        r"\includegraphics[width=\columnwidth]{map.pdf}",
        rf"\caption{{{caption}}}",
        r"\end{figure}",
    ]
    told = lettered(found)
    if told:
        lines += ["", r"\noindent " + say(language, "The curves of the map:"), r"\begin{itemize}"]
        for k, letter in told.items():
            condition = condition_words(telling(found.boundaries.conditions[k]), found.section, language)
            polynomial = _polynomial(found.boundaries.factors[k], names, language)
            lines.append(rf"\item[\textit{{{letter}}}] {polynomial} \quad ({_text(condition)})")
        lines.append(r"\end{itemize}")
    return "\n".join(lines) + "\n"


def _polynomial(p: Any, names: LatexNames, language: Language) -> str:
    if len(p) > MOST_TERMS:
        symbols = [names[name] for name in p.context().names()]
        degrees = ", ".join(f"{d} ({say(language, 'in')} ${s}$)" for s, d in zip(symbols, p.degrees(), strict=True))
        return f"{say(language, 'degrees')} {degrees}, {say(language, 'terms')}: {len(p)}, map.json"
    terms: list[str] = []
    for exponents, coefficient in p.terms():
        powers = "".join(
            f"{names[name]}" + (f"^{{{int(e)}}}" if e > 1 else "") + " "
            for name, e in zip(p.context().names(), exponents, strict=True)
            if e
        ).strip()
        size = abs(coefficient)
        number = "" if size == 1 and powers else _rational(size)
        sign = "-" if coefficient < 0 else "+" if terms else ""
        terms.append(f"{sign} {number} {powers}".strip())
    return f"${' '.join(terms)} = 0$"


def _rational(value: Any) -> str:
    text = str(value)
    top, slash, bottom = text.removeprefix("-").partition("/")
    sign = "-" if text.startswith("-") else ""
    return f"{sign}\\tfrac{{{top}}}{{{bottom}}}" if slash else text


def _text(plain: str) -> str:
    return "".join(_ESCAPED.get(c, c) for c in plain)
