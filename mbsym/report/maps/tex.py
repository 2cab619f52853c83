r"""A map as LaTeX to \input: the picture with its caption, and the equations of its curves."""

from __future__ import annotations

from typing import Any

from mbsym.formulas.latex import LatexNames
from mbsym.maps.boxes import BoxMap
from mbsym.maps.result import LineMap, Of, PlaneMap
from mbsym.maps.slices import Stack
from mbsym.model.system import System
from mbsym.report.language import Language
from mbsym.report.maps.figure import lettered
from mbsym.report.maps.line_figure import changes
from mbsym.report.maps.words import INTERRUPTED, arcs_of, condition_words, onset_words, telling

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


def map_tex(system: System, found: PlaneMap | LineMap, language: Language) -> str:
    """Needs graphicx; the picture is map.pdf in the same folder."""
    names = LatexNames([axis.name for axis in found.section.axes])
    axes = ", ".join(f"${names[axis.name]}$" for axis in found.section.axes)
    plane = f"({axes})" if len(found.section.axes) > 1 else axes
    lines = figure_lines("map.pdf", caption_of(system, found, plane, language))
    items = _zeros(found, names, language) if isinstance(found, LineMap) else _curves(found, names, language)
    if items:
        head = "The points of the map:" if isinstance(found, LineMap) else "The curves of the map:"
        lines += ["", r"\noindent " + language.say(head), r"\begin{itemize}", *items, r"\end{itemize}"]
    return "\n".join(lines) + "\n"


def caption_of(system: System, found: PlaneMap | LineMap | Stack | BoxMap, plane: str, language: Language) -> str:
    """What is shown, over which axes, and what has a number."""
    fixed = LatexNames(list(found.section.told))
    values = ", ".join(f"${fixed[name]} = {_rational(value)}$" for name, value in found.section.told.items())
    what = "Degree of instability of" if found.of is Of.SIGNATURE else "Stability of"
    told = f"{language.say(what)} {escaped(system.name)}: {plane}" + (f"; {values}" if values else "") + "."
    return told + f" {language.say(INTERRUPTED)}." if found.interrupted else told


def figure_lines(file: str, caption: str) -> list[str]:
    """A figure with a picture of the same folder."""
    return [
        "% needs \\usepackage{graphicx}; written by mbsym map",
        r"\begin{figure}",
        r"\centering",
        rf"\includegraphics[width=\columnwidth]{{{file}}}",
        rf"\caption{{{caption}}}",
        r"\end{figure}",
    ]


def _curves(found: PlaneMap, names: LatexNames, language: Language) -> list[str]:
    items = []
    for k, letter in lettered(found).items():
        condition = condition_words(telling(found.boundaries.conditions[k]), found.section, language)
        condition += onset_words(arcs_of(found, k), language)
        polynomial = equation(found.boundaries.factors[k], names, language)
        items.append(rf"\item[\textit{{{letter}}}] {polynomial} \quad ({escaped(condition)})")
    return items


def _zeros(found: LineMap, names: LatexNames, language: Language) -> list[str]:
    name = names[found.section.axes[0].name]
    return [
        rf"\item[\textit{{{letter}}}] ${name} = {x:.10g}$ \quad ({escaped(words)})"
        for letter, x, words in changes(found, language)
    ]


def equation(p: Any, names: LatexNames, language: Language) -> str:
    """p = 0, or how long it is."""
    if len(p) > MOST_TERMS:
        symbols = [names[name] for name in p.context().names()]
        degrees = ", ".join(f"{d} ({language.say('in')} ${s}$)" for s, d in zip(symbols, p.degrees(), strict=True))
        return f"{language.say('degrees')} {degrees}, {language.say('terms')}: {len(p)}, map.json"
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
    """As in running text: fractions with a stroke need no package."""
    return str(value)


def escaped(plain: str) -> str:
    """As LaTeX."""
    return "".join(_ESCAPED.get(c, c) for c in plain)
