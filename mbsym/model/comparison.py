"""Comparisons of numbers with zero, as assumptions state them and as the declared signs of parameters mean them."""

from __future__ import annotations

from typing import Any

#: The relation to zero that a sign word declares; "real" declares none.
RELATION_OF_SIGN = {"positive": ">", "nonnegative": ">=", "negative": "<", "nonpositive": "<=", "nonzero": "!="}


def holds(gap: Any, relation: str) -> bool:
    """Whether ``gap relation 0``; of a ball, whether this is certain."""
    return bool({"<": gap < 0, "<=": gap <= 0, ">": gap > 0, ">=": gap >= 0, "!=": gap != 0}[relation])


def has_sign(value: Any, sign: str) -> bool:
    """Whether a number has a declared sign; of a ball, whether this is certain."""
    return sign not in RELATION_OF_SIGN or holds(value, RELATION_OF_SIGN[sign])
