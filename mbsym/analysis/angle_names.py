r"""How sines, cosines and rates are written where they are variables of a field: (\sin\theta), sin(theta)."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING

from mbsym.algebra.ring import Ring
from mbsym.formulas import latex, mathml, python

if TYPE_CHECKING:
    from mbsym.analysis.pipeline import Analysis


def write_in(ring: Ring, analysis: Analysis, names: Mapping[str, str]) -> tuple[tuple[str, str], ...]:
    """``names``: identifiers of the ring -> variables of the field, ``sin(theta)`` or ``sin(theta/2)``.

    The identifiers that stand for something else, with that in Python syntax; the description's own symbols are kept.
    """
    system = analysis.system
    symbols = {one.name: one.latex for one in system.symbols}
    in_tex, in_page = latex.LatexNames(list(system.coordinates), symbols), mathml.MathNames(system.coordinates)
    told: dict[str, str] = {}
    page: dict[str, mathml.Symbol] = {}
    for plain, name in names.items():
        stem = name.removesuffix("_dot")
        if name[:4] in ("sin(", "cos("):
            function = name[:3]
            angle, _, share = name[4:-1].partition("/")
            told[plain] = rf"(\{function} {in_tex[angle]}{'/' + share if share else ''})"
            part = mathml.mo("/") + mathml.mn(share) if share else ""
            inside = mathml.mi(function) + mathml.APPLY + str(in_page[angle]) + part
            page[plain] = mathml.Symbol(mathml.bracketed(inside))
        elif stem != name and stem in system.coordinates:
            told[plain] = in_tex[stem].accented("dot")
            page[plain] = in_page[stem].dotted("\u02d9")
    if told or symbols:
        latex.write_as(ring, told | symbols)
    if page:
        mathml.write_as(ring, page)
        python.write_as(ring, {x: re.sub("_dot$", "'", names[x]) for x in page})
    return tuple((plain, name) for plain, name in names.items() if plain != name)
