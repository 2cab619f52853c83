"""The first-order form of problem 5 as reports show it: for systems with inputs or outputs alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mbsym.algebra.failures import Failure, message_of

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.problems.linearisation import Linearisation


def first_order(analysis: Analysis, linear: Linearisation | None) -> dict[str, Any]:
    """``first_order``: A, B, C, D, or None; ``no_first_order``: why there are none although there might be."""
    if linear is None or not (analysis.system.inputs or analysis.system.outputs):
        return {"first_order": None, "no_first_order": ""}
    try:
        return {"first_order": analysis.state_space, "no_first_order": ""}
    except Failure as reason:
        return {"first_order": None, "no_first_order": message_of(reason)}
