r"""A map over three axes as LaTeX to \\input: its pages with their caption, and the equations of the curves."""

from __future__ import annotations

from mbsym.formulas.latex import LatexNames
from mbsym.maps.result import PlaneMap
from mbsym.maps.slices import Stack
from mbsym.model.system import System
from mbsym.report.language import Language
from mbsym.report.maps.slice_figure import curve_name, letters_of, page_names, panels
from mbsym.report.maps.tex import caption_of, equation, escaped, figure_lines
from mbsym.report.maps.words import condition_words, telling


def slices_tex(system: System, found: Stack, language: Language) -> str:
    """Needs graphicx; the pictures are map.pdf, map-2.pdf, ... in the same folder."""
    names = LatexNames([axis.name for axis in found.section.axes])
    across, up, axis = (names[one.name] for one in found.section.axes)
    span = rf"${found.axis.low} \le {axis} \le {found.axis.high}$"
    caption = caption_of(system, found, f"(${across}$, ${up}$), {span}", language)
    lines: list[str] = []
    for name in page_names(found):
        lines += figure_lines(f"{name}.pdf", caption)
    items = _curves(found, names, language)
    if items:
        head = language.say("The curves of the map:")
        lines += ["", r"\noindent " + head, r"\begin{itemize}", *items, r"\end{itemize}"]
    return "\n".join(lines) + "\n"


def _curves(found: Stack, names: LatexNames, language: Language) -> list[str]:
    """Each letter with its polynomial in the axes; of one that belongs to a single slice, in two of them."""
    places = {curve_name(found, plane, k): (plane, k) for _, plane in panels(found) for k in _numbers(plane)}
    items = []
    for name, letter in letters_of(found).items():
        plane, k = places[name]
        own = k >= len(found.boundaries.factors)
        polynomial = plane.boundaries.factors[k] if own else found.boundaries.factors[k]
        condition = condition_words(telling(plane.boundaries.conditions[k]), found.section, language)
        items.append(
            rf"\item[\textit{{{letter}}}] {equation(polynomial, names, language)} \quad ({escaped(condition)})"
        )
    return items


def _numbers(plane: PlaneMap) -> range:
    return range(len(plane.boundaries.factors))
