"""Dimensionless variables: what a variable, the time and parameters are in terms of new ones."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction

from mbsym.expressions.tree import (
    CONSTANTS,
    ONE,
    Expression,
    Name,
    Negative,
    Operation,
    divide,
    multiply,
    names,
    negative,
    walk,
)

#: Exponents of base units, and of the dimensions of names that follow from no place.
Weights = Mapping[str, Fraction]


@dataclass(frozen=True)
class Scaled:
    """The variable ``name`` is ``factor`` times ``new``."""

    name: str
    new: str
    factor: Expression


@dataclass(frozen=True)
class Scaling:
    """``variables`` with ``time``, and ``parameters`` with what is put in for them, in names that are left.

    ``new`` are the parameters that come in, ``units`` those among the factors' names, in their order.  ``weights`` are
    dimensions, of every name that is left and of the old variables.
    """

    variables: tuple[Scaled, ...]
    time: Scaled | None
    parameters: tuple[tuple[str, Expression], ...]
    new: tuple[str, ...]
    weights: Mapping[str, Weights] = field(compare=False)

    @property
    def images(self) -> dict[str, Expression]:
        return dict(self.parameters)

    @property
    def units(self) -> tuple[str, ...]:
        factors = [scaled.factor for scaled in (self.time, *self.variables) if scaled is not None]
        occurring = (node.name for factor in factors for node in walk(factor) if isinstance(node, Name))
        return tuple(dict.fromkeys(name for name in occurring if name not in CONSTANTS))


def factor_of(value: Expression, name: str) -> Expression | None:
    """c where the expression is c times a name that c does not hold."""
    match value:
        case Name(own) if own == name:
            return ONE
        case Negative(operand):
            inner = factor_of(operand, name)
            return None if inner is None else negative(inner)
        case Operation("*", left, right) if (name in names(left)) != (name in names(right)):
            held, other = (left, right) if name in names(left) else (right, left)
            inner = factor_of(held, name)
            return None if inner is None else multiply(inner, other)
        case Operation("/", left, right) if name not in names(right):
            inner = factor_of(left, name)
            return None if inner is None else divide(inner, right)
    return None


# A reduction as its author asks for it: steps, and from which power of a parameter on terms are left out.


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
