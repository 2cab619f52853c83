"""A reduction as its author asks for it: steps, and from which power of a parameter on terms are left out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from mbsym.expressions.tree import Expression

INTEGRALS = "integrals"


@dataclass(frozen=True)
class Asked:
    """A step: ``names`` of variables, ``definitions`` what some of them are, ``by`` what they are eliminated: names.

    Without ``by`` it is a change of variables, and what is no variable is a letter that stands in it.
    """

    names: tuple[str, ...]
    definitions: Mapping[str, Expression]
    by: tuple[str, ...]


@dataclass(frozen=True)
class Reducing:
    """``small`` and ``known``: the remainder O(small**known); "" where all is exact."""

    steps: tuple[Asked, ...]
    small: str = ""
    known: int | None = None
