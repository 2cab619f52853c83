"""``model_casadi.py`` and ``model_jax.py``: the same functions over the arrays of two libraries."""

from __future__ import annotations

import builtins
import keyword
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from mbsym.expressions.table import Tabulated
from mbsym.formulas.straight_line import Dialect, angle_name
from mbsym.report.code.functions import identifier, python_definition
from mbsym.report.code.identifiers import number
from mbsym.report.environment import rendered
from mbsym.report.exports.interface import COMMON, Language, export

if TYPE_CHECKING:
    from mbsym.analysis import Analysis

RESERVED = COMMON | {
    *keyword.kwlist, *dir(builtins), "ca", "jnp", "jax", "functions", "n",
    "NAME", "COORDINATES", "PARAMETERS", "BODIES", "INTEGRALS", "VALUES", "RELATIONS",
}  # fmt: skip


def language(module: str, called: Callable[[str], str], tables: bool = False) -> Language:
    """Python with the functions of ``module``, there ``called`` differently than here; ``tables``: it can search."""
    dialect = Dialect(
        call=lambda function, argument: (
            f"{identifier(function) if isinstance(function, Tabulated) else f'{module}.{called(function)}'}({argument})"
        ),
        number=number,
        angle=angle_name,
        tables=tables,
    )
    return Language(dialect, RESERVED, lambda name: name + "_" if name in RESERVED else name)


CASADI = language("ca", lambda function: {"abs": "fabs"}.get(function, function))
JAX = language("jnp", lambda function: {"atan": "arctan"}.get(function, function), tables=True)


def casadi(analysis: Analysis, problems: Sequence[int]) -> str:
    """``model_casadi.py``: functions of CasADi's symbols, for optimal control and estimation."""
    return _module("exports/casadi.py.j2", CASADI, analysis, problems)


def jax(analysis: Analysis, problems: Sequence[int]) -> str:
    """``model_jax.py``: functions of JAX, for jit, vmap and grad."""
    return _module("exports/jax.py.j2", JAX, analysis, problems)


def _module(template: str, spoken: Language, analysis: Analysis, problems: Sequence[int]) -> str:
    model = export(analysis, problems, spoken, further_too=True)
    lookups = [python_definition(table, "jnp", typed=False) for table in model.tables]
    return rendered(template, {"plain": plain}, model=model, lookups=lookups)


def plain(words: str) -> str:
    """Text that may stand in a docstring, a string or a comment."""
    return " ".join(words.replace("\\", "/").replace('"', "'").split())
