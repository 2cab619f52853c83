"""``model_casadi.py``: the equations as functions of CasADi's symbols, for optimal control and estimation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from mbsym.report.exports import python_functions

if TYPE_CHECKING:
    from mbsym.analysis import Analysis

LANGUAGE = python_functions.language("ca", lambda function: {"abs": "fabs"}.get(function, function))


def render(analysis: Analysis, problems: Sequence[int]) -> str:
    """The module's text."""
    return python_functions.render("exports/casadi.py.j2", LANGUAGE, analysis, problems)
