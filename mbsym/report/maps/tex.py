r"""A map as LaTeX to \input: the pictures with their caption, and the equations of what bounds its cells."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from flint import fmpq

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.plane.line import Line
from mbsym.formulas.latex import LatexNames
from mbsym.maps.boxes import BoxMap
from mbsym.maps.branches_result import Branches
from mbsym.maps.mapping import float_of
from mbsym.maps.result import Lack, Map, Of
from mbsym.maps.slices import Stack
from mbsym.model.system import System
from mbsym.report.language import Language
from mbsym.report.latex.labels import prefix_of
from mbsym.report.latex.writer import spelled
from mbsym.report.maps.figure import lettered, mark_name, marks, page_names, panels
from mbsym.report.maps.words import INTERRUPTED, border_words, critical_words, percent, rational_text, stem

#: Longer polynomials are told by their degrees and number of terms.
MOST_TERMS = 14

_HEADS = {
    Of.STABILITY: "Stability of",
    Of.SIGNATURE: "Degree of instability of",
    Of.EQUILIBRIA: "Numbers of relative equilibria of",
}


def map_tex(system: System, chart: Map, language: Language) -> str:
    """Needs graphicx; the pictures are map.pdf, map-2.pdf, ... (see ``stem``) in the same folder."""
    if isinstance(chart, Branches):
        return _branches(system, chart, language)
    names = LatexNames([axis.name for axis in chart.axes])
    caption = caption_of(system, _HEADS[chart.of], chart.values, language, _plane(chart, names))
    if isinstance(chart, BoxMap):
        caption += f" {language.say('Every coloured box is proved as a whole')}"
        if any(region.lack is Lack.UNPROVED for region in chart.regions):
            caption += f"; {language.say('white: nothing is proved')} ({escaped(language.say(percent(chart)))})"
        caption += "."
    if chart.interrupted:
        caption += f" {language.say(INTERRUPTED)}."
    command = "map --of equilibria" if chart.of is Of.EQUILIBRIA else "map"
    lines = [line for name in page_names(chart) for line in figure_lines(system, name, caption, command)]
    points = isinstance(chart.ground, Line) and not isinstance(chart, Stack)
    head = "The points of the map:" if points else "The curves of the map:"
    return "\n".join([*lines, *listed(language.say(head), _marks(chart, names, language))]) + "\n"


def _branches(system: System, branches: Branches, language: Language) -> str:
    """The diagram, the numbers of equilibria, the critical values."""
    name = LatexNames([branches.axes[0].name])[branches.axes[0].name]
    caption = caption_of(system, "Relative equilibria of", branches.values, language)
    if branches.interrupted:
        caption += f" {language.say(INTERRUPTED)}."
    numbers = []
    for cell, last in branches.spans():
        low, high, counted = number_tex(branches.ends(cell)[0]), number_tex(branches.ends(last)[1]), cell.counted
        assert counted is not None
        doubt = "" if cell.certainty is Certainty.PROVED else f" ({language.say('not proved to be constant')})"
        stable = f"{language.say('of them stable')} {counted.stable}"
        stable += f", {language.say('undecided')} {counted.undecided}" if counted.undecided else ""
        numbers.append(rf"\item ${low} < {name} < {high}$: {counted.count}, {stable}{doubt}")
    items = [(cell, words) for cell in branches.criticals if (words := language.say(critical_words(branches, cell)))]
    critical = [rf"\item ${name} = {number_tex(cell.sample)}$: {escaped(words)}" for cell, words in items]
    lines = figure_lines(system, "branches", caption, "equilibria --vary")
    lines += listed(language.say("Numbers of equilibria:"), numbers)
    return "\n".join([*lines, *listed(language.say("Critical values:"), critical)]) + "\n"


def number_tex(x: Any) -> str:
    """A rational number, a square root, or digits that end in dots."""
    if isinstance(x, fmpq):
        return rational_text(x)
    c = x.polynomial.coeffs()
    if len(c) == 3 and c[1] == 0 and c[2] == 1:
        return ("-" if float(x) < 0 else "") + rf"\sqrt{{{-c[0]}}}"
    return f"{float(x):.8g}" + r"\ldots"


def _plane(chart: Map, names: LatexNames) -> str:
    """What is shown: its axes."""
    across = ", ".join(f"${names[axis.name]}$" for axis in chart.axes[:2])
    if not isinstance(chart, Stack):
        return f"({across})" if len(chart.axes) > 1 else across
    return rf"({across}), ${chart.axis.low} \le {names[chart.axis.name]} \le {chart.axis.high}$"


def caption_of(system: System, head: str, values: Mapping[str, Any], language: Language, plane: str = "") -> str:
    """What is shown, over which axes, and what has a number; fractions with a stroke need no package."""
    fixed = LatexNames(list(values))
    assignments = ", ".join(f"${fixed[name]} = {rational_text(value)}$" for name, value in values.items())
    return (
        f"{language.say(head)} {escaped(system.name)}"
        + (f": {plane}" if plane else "")
        + (f"; {assignments}." if assignments else ".")
    )


def figure_lines(system: System, name: str, caption: str, command: str) -> list[str]:
    """A figure with a picture of the same folder, and a label like those of the system's equations."""
    return [
        rf"% Written by mbsym {command}.  Needs \usepackage{{graphicx}}; from another folder \graphicspath, too.",
        r"\begin{figure}",
        r"\centering",
        rf"\includegraphics[width=\columnwidth]{{{name}.pdf}}",
        rf"\caption{{{caption}}}\label{{{prefix_of(system)}fig:{name}}}",
        r"\end{figure}",
    ]


def listed(head: str, items: Iterable[str]) -> list[str]:
    """A list under its head; nothing of none."""
    lines = list(items)
    return ["", r"\noindent " + head, r"\begin{itemize}", *lines, r"\end{itemize}"] if lines else []


def _marks(chart: Map, names: LatexNames, language: Language) -> Iterator[str]:
    """Each letter of the picture with its polynomial in the axes, or its number; of one slice, in two of them."""
    places = {mark_name(chart, plane, k): (plane, k) for _, plane in reversed(panels(chart)) for k in marks(plane)}
    file = f"{stem(chart)}.json"
    for name, letter in lettered(chart).items():
        plane, k = places[name]
        words = _with_formulas(language.say(border_words(plane, k, _in_dollars)))
        if isinstance(plane.ground, Line):
            equality = f"${names[plane.axes[0].name]} = {float_of(plane.corners[k].sample):.10g}$"
        else:
            own = k >= len(chart.boundaries.factors)
            equality = equation((plane if own else chart).boundaries.factors[k], names, language, file)
        yield rf"\item[\textit{{{letter}}}] {equality} \quad ({words})"


def _in_dollars(name: str) -> str:
    return f"${LatexNames([name])[name]}$"


def _with_formulas(words: str) -> str:
    """Words as LaTeX; what stands between dollars is LaTeX already."""
    return "$".join(part if k % 2 else escaped(part) for k, part in enumerate(words.split("$")))


def equation(p: Any, names: LatexNames, language: Language, file: str) -> str:
    """p = 0, or how long it is, and in which file it stands."""
    if len(p) > MOST_TERMS:
        symbols = [names[name] for name in p.context().names()]
        degrees = ", ".join(f"{d} ({language.say('in')} ${s}$)" for s, d in zip(symbols, p.degrees(), strict=True))
        return f"{language.say('degrees')} {degrees}, {language.say('terms')}: {len(p)}, {file}"
    terms: list[str] = []
    for exponents, coefficient in p.terms():
        powers = "".join(
            f"{names[name]}" + (f"^{{{int(e)}}}" if e > 1 else "") + " "
            for name, e in zip(p.context().names(), exponents, strict=True)
            if e
        ).strip()
        size = abs(coefficient)
        number = "" if size == 1 and powers else str(size)
        sign = "-" if coefficient < 0 else "+" if terms else ""
        terms.append(f"{sign} {number} {powers}".strip())
    return f"${' '.join(terms)} = 0$"


def escaped(plain: str) -> str:
    """As LaTeX."""
    return "".join(map(spelled, plain))
