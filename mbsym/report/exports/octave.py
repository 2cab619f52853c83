"""``model.m``: one function file for MATLAB and Octave, whose result holds the equations as function handles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from mbsym.formulas.straight_line import Dialect, angle_name
from mbsym.report.code.identifiers import number
from mbsym.report.environment import rendered
from mbsym.report.exports.interface import COMMON, Language, export

if TYPE_CHECKING:
    from mbsym.analysis import Analysis

#: MATLAB cuts names after 63 characters, and then takes different ones for the same.
LONGEST_NAME = 50

_WORDS = """
    break case catch classdef continue else elseif end for function global if otherwise parfor persistent return spmd
    switch try while do until unwind_protect unwind_protect_cleanup end_try_catch end_unwind_protect endfor endfunction
    endif endswitch endwhile endclassdef endenumeration endevents endmethods endproperties endparfor end_unwind
    enumeration events methods properties arguments import __FILE__ __LINE__
    abs sign
    sin cos tan sqrt exp log atan sinh cosh tanh zeros struct isfield fieldnames strjoin error numel any all ismember
    isnan NaN nan Inf inf pi eps e i j I J ans eval feval nargin nargout varargin varargout true false
    model functions s k
"""
RESERVED = COMMON | frozenset(_WORDS.split())


def proposed(name: str) -> str:
    """A name of MATLAB: letters, digits, underscores, a letter in front."""
    plain = "".join(letter if letter.isascii() and (letter.isalnum() or letter == "_") else "_" for letter in name)
    plain = plain if plain[:1].isalpha() else "v" + plain
    return (plain + "_" if plain in RESERVED else plain)[:LONGEST_NAME]


LANGUAGE = Language(
    Dialect(number=number, angle=angle_name),
    RESERVED,
    proposed,
)


def render(analysis: Analysis, problems: Sequence[int]) -> str:
    """The file's text."""
    return rendered(
        "exports/model.m.j2", {"plain": plain, "quoted": quoted}, model=export(analysis, problems, LANGUAGE)
    )


def plain(words: str) -> str:
    """Text that may stand in a comment."""
    return " ".join(words.replace("...", ". . .").replace("%{", "% {").replace("%}", "% }").split())


def quoted(words: str) -> str:
    """A string in single quotes, in which nothing is special but the quote itself."""
    return "'" + " ".join(words.split()).replace("'", "''") + "'"
