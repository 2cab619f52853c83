"""``model.jl``: a module for Julia that needs no package."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from mbsym.formulas.straight_line import Dialect, angle_name
from mbsym.report.code.identifiers import number
from mbsym.report.environment import rendered
from mbsym.report.exports.interface import COMMON, Language, export

if TYPE_CHECKING:
    from mbsym.analysis import Analysis

_WORDS = """
    abstract baremodule begin break catch const continue do else elseif end export false finally for function global if
    import in isa let local macro module mutable outer primitive public quote return struct true try type using var
    where while as
    abs sign
    sin cos tan sqrt exp log atan sinh cosh tanh zeros promote_type eltype typeof float pi im e NaN Inf nothing missing
    Main Base Core ans eval include vcat Float64
    NAME COORDINATES PARAMETERS BODIES INTEGRALS n
"""
RESERVED = COMMON | frozenset(_WORDS.split())


def proposed(name: str) -> str:
    """A name of Julia in ASCII; one of underscores alone cannot be read there."""
    plain = "".join(letter if letter.isascii() and (letter.isalnum() or letter == "_") else "_" for letter in name)
    plain = plain if plain.strip("_") and not plain[:1].isdigit() else "v" + plain
    return plain + "_" if plain in RESERVED else plain


LANGUAGE = Language(
    Dialect(number=number, angle=angle_name),
    RESERVED,
    proposed,
)


def render(analysis: Analysis, problems: Sequence[int]) -> str:
    """The module's text."""
    return rendered(
        "exports/model.jl.j2", {"plain": plain, "quoted": quoted}, model=export(analysis, problems, LANGUAGE)
    )


def plain(words: str) -> str:
    """Text that may stand in a comment of one line: it opens and closes no other."""
    return " ".join(words.replace("#=", "# =").replace("=#", "= #").split())


def quoted(words: str) -> str:
    """A string literal, in which nothing is interpolated."""
    escaped = " ".join(words.split())
    for character in ("\\", '"', "$"):
        escaped = escaped.replace(character, "\\" + character)
    return f'"{escaped}"'
