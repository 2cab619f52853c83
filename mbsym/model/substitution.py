"""Expressions put in for names, everywhere in a description or a part of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass, replace
from fractions import Fraction
from typing import Any

from mbsym.expressions.tree import (
    ZERO,
    Call,
    Expression,
    Name,
    Negative,
    Number,
    Operation,
    add,
    is_number,
    multiply,
    names,
    negative,
    substitute,
    subtract,
)
from mbsym.model.inputs import Input
from mbsym.model.system import System

_EXPRESSIONS = (Number, Name, Negative, Operation, Call)
_FOLDING = {"+": add, "-": subtract, "*": multiply}

Replacing = Callable[[Expression, Mapping[str, Expression]], Expression]


def put(part: Any, images: Mapping[str, Expression], replaced: Replacing = substitute) -> Any:
    """A part of a system with names replaced in every expression; what does not change is the same object."""
    if isinstance(part, _EXPRESSIONS):
        return replaced(part, images) if names(part) & images.keys() else part
    if isinstance(part, tuple):
        return tuple(put(item, images, replaced) for item in part)
    if is_dataclass(part) and not isinstance(part, type):
        inner = {item.name: getattr(part, item.name) for item in fields(part) if item.name != "span"}
        changed = {name: new for name, old in inner.items() if (new := put(old, images, replaced)) is not old}
        return replace(part, **changed) if changed else part
    return part


def folded(expression: Expression, images: Mapping[str, Expression]) -> Expression:
    """The expression with names replaced, products with 0 and 1, sums with 0, x/1 and powers of 1 left out.

    A quotient keeps its divisor: 0/x is not 0 at x = 0.
    """
    if not names(expression) & images.keys():
        return expression
    match expression:
        case Name(name):
            return images[name]
        case Negative(operand):
            return negative(folded(operand, images))
        case Operation(operator, left, right) if operator in _FOLDING:
            return _FOLDING[operator](folded(left, images), folded(right, images))
        case Operation("/", left, right):
            below = folded(right, images)
            return folded(left, images) if is_number(below, 1) else Operation("/", folded(left, images), below)
        case Operation("**", base, exponent) if is_number(folded(base, images), 1) and not names(exponent):
            return Number(Fraction(1))
    return substitute(expression, images)


# A system with expressions in place of its inputs.


def driven(system: System, laws: Mapping[str, Expression]) -> System:
    """The system whose inputs are the given expressions, in the state, parameters and t; others keep ``held``.

    It has no inputs and no outputs.  Loads that vanish are left out: zero forces would only cast doubt on the energy.
    """
    if not system.inputs:
        return replace(system, outputs=()) if system.outputs else system
    images = {one.name: laws.get(one.name, one.held) for one in system.inputs}
    loads = (put(load, images, folded) for load in system.loads)
    kept = tuple(load for one in loads if (load := one.simplified()) is not None)
    return replace(system, loads=kept, inputs=(), outputs=())


def held(system: System) -> System:
    """The system whose inputs keep the constant values of the unperturbed motion: the one problems 4 to 6 judge."""
    return driven(system, {})


def with_held(inputs: tuple[Input, ...], values: Mapping[str, Expression]) -> tuple[Input, ...]:
    """The inputs with their constant values on the unperturbed motion, where these are given."""
    return tuple(replace(one, held=values.get(one.name, ZERO)) for one in inputs)
