"""``model_jax.py``: the equations as functions of JAX, for jit, vmap and grad."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from mbsym.report.exports import python_functions

if TYPE_CHECKING:
    from mbsym.analysis import Analysis

LANGUAGE = python_functions.language("jnp", lambda function: {"atan": "arctan"}.get(function, function), tables=True)


def render(analysis: Analysis, problems: Sequence[int]) -> str:
    """The module's text."""
    return python_functions.render("exports/jax.py.j2", LANGUAGE, analysis, problems)
