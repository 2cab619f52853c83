"""Functions of (t, x, p) for Julia, MATLAB and Octave, CasADi and JAX: one row a language, the rest is its template."""

from __future__ import annotations

import builtins
import keyword
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mbsym.expressions.table import Tabulated
from mbsym.formulas.straight_line import Dialect, angle_name
from mbsym.report.code.functions import identifier, python_definition
from mbsym.report.code.identifiers import number, spelled
from mbsym.report.code.python_module import plain as plain_in_python
from mbsym.report.environment import rendered
from mbsym.report.exports.interface import COMMON, Language, export

if TYPE_CHECKING:
    from mbsym.analysis import Analysis

#: MATLAB cuts names after 63 characters, and then takes different ones for the same.
LONGEST_NAME = 50

_OF_JULIA = """
    abstract baremodule begin break catch const continue do else elseif end export false finally for function global if
    import in isa let local macro module mutable outer primitive public quote return struct true try type using var
    where while as
    abs sign
    sin cos tan sqrt exp log atan sinh cosh tanh zeros promote_type eltype typeof float pi im e NaN Inf nothing missing
    Main Base Core ans eval include vcat Float64
    NAME COORDINATES PARAMETERS BODIES INTEGRALS n
"""
_OF_OCTAVE = """
    break case catch classdef continue else elseif end for function global if otherwise parfor persistent return spmd
    switch try while do until unwind_protect unwind_protect_cleanup end_try_catch end_unwind_protect endfor endfunction
    endif endswitch endwhile endclassdef endenumeration endevents endmethods endproperties endparfor end_unwind
    enumeration events methods properties arguments import __FILE__ __LINE__
    abs sign
    sin cos tan sqrt exp log atan sinh cosh tanh zeros struct isfield fieldnames strjoin error numel any all ismember
    isnan NaN nan Inf inf pi eps e i j I J ans eval feval nargin nargout varargin varargout true false
    model functions s k
"""
RESERVED = {
    "julia": COMMON | frozenset(_OF_JULIA.split()),
    "octave": COMMON | frozenset(_OF_OCTAVE.split()),
    "python": COMMON | {
        *keyword.kwlist, *dir(builtins), "ca", "jnp", "jax", "functions", "n",
        "NAME", "COORDINATES", "PARAMETERS", "BODIES", "INTEGRALS", "VALUES", "RELATIONS",
    },
}  # fmt: skip


@dataclass(frozen=True)
class Row:
    """``template`` says how functions and arrays look.

    ``plain`` makes of words what may stand in a comment (in Python in a docstring, too), ``quoted`` a string literal.
    ``further``: it has functions with another argument, and those of single frames.
    """

    template: str
    language: Language
    plain: Callable[[str], str]
    quoted: Callable[[str], str] = repr
    further: bool = False


def _of_python(template: str, module: str, renamed: dict[str, str], tables: bool) -> Row:
    """Functions over the arrays of ``module``, which calls some functions differently; ``tables``: it can search."""

    def call(function: str, argument: str) -> str:
        own = identifier(function) if isinstance(function, Tabulated) else f"{module}.{renamed.get(function, function)}"
        return f"{own}({argument})"

    reserved = RESERVED["python"]
    dialect = Dialect(call=call, number=number, angle=angle_name, tables=tables)
    language = Language(dialect, reserved, lambda name: name + "_" if name in reserved else name)
    return Row(template, language, plain_in_python, further=True)


def _in_one_line(words: str, *openings: str) -> str:
    """Text in which nothing opens or closes another comment: its characters stand apart."""
    for opening in openings:
        words = words.replace(opening, " ".join(opening))
    return " ".join(words.split())


def _quoted(words: str, quote: str, escaped: Sequence[tuple[str, str]]) -> str:
    text = " ".join(words.split())
    for character, instead in escaped:
        text = text.replace(character, instead)
    return f"{quote}{text}{quote}"


LANGUAGES = {
    "julia": Row(
        "exports/model.jl.j2",
        Language(
            Dialect(number=number, angle=angle_name),
            RESERVED["julia"],
            # A name of underscores alone cannot be read there.
            lambda name: spelled(name, RESERVED["julia"], lambda plain: not plain.strip("_")),
        ),
        lambda words: _in_one_line(words, "#=", "=#"),
        # Nothing is interpolated.
        lambda words: _quoted(words, '"', [(x, "\\" + x) for x in ("\\", '"', "$")]),
    ),
    "octave": Row(
        "exports/model.m.j2",
        Language(
            Dialect(number=number, angle=angle_name),
            RESERVED["octave"],
            lambda name: spelled(name, RESERVED["octave"], lambda plain: not plain[:1].isalpha())[:LONGEST_NAME],
        ),
        lambda words: _in_one_line(words, "...", "%{", "%}"),
        lambda words: _quoted(words, "'", [("'", "''")]),
    ),
    "casadi": _of_python("exports/casadi.py.j2", "ca", {"abs": "fabs"}, tables=False),
    "jax": _of_python("exports/jax.py.j2", "jnp", {"atan": "arctan"}, tables=True),
}


def render(language: str, analysis: Analysis, problems: Sequence[int]) -> str:
    """The file's text."""
    row = LANGUAGES[language]
    model = export(analysis, problems, row.language, further_too=row.further)
    lookups = [python_definition(table, "jnp", typed=False) for table in model.tables]
    return rendered(row.template, {"plain": row.plain, "quoted": row.quoted}, model=model, lookups=lookups)
