"""Straight-line programs as plain data: what a page evaluates for itself, sixty times a second.

    value k = input k                                       k < inputs
    value k = constant k - inputs                           k < inputs + constants
    value k = operation(value a[, value b])                 of step k - inputs - constants; a, b < k

Operations: + - * / neg sqrt sin cos exp log atan sinh cosh tanh abs sign, and ``table i``, the i-th of ``tables``.
Constants are the doubles nearest to the exact numbers; the order of operations is that of ``mbsym.algebra.program``.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from typing import Any

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.program import Node, Program
from mbsym.expressions.table import Curve, Tabulated

_SHORT = {"add": "+", "subtract": "-", "multiply": "*", "divide": "/", "negative": "neg"}

#: By operation, how NumPy calls it, and what it does with a number.
_TWO: Mapping[str, tuple[str, Callable[[float, float], float]]] = {
    "+": ("add", operator.add),
    "-": ("subtract", operator.sub),
    "*": ("multiply", operator.mul),
    "/": ("divide", operator.truediv),
}
_ONE: Mapping[str, tuple[str, Callable[[float], float]]] = {
    "neg": ("negative", operator.neg),
    "sqrt": ("sqrt", math.sqrt),
    "sin": ("sin", math.sin),
    "cos": ("cos", math.cos),
    "exp": ("exp", math.exp),
    "log": ("log", math.log),
    "atan": ("arctan", math.atan),
    "sinh": ("sinh", math.sinh),
    "cosh": ("cosh", math.cosh),
    "tanh": ("tanh", math.tanh),
    "abs": ("abs", abs),
    "sign": ("sign", lambda x: x if math.isnan(x) else float((x > 0) - (x < 0))),
}
_NUMBERS: dict[str, Callable[..., float]] = {}
_NUMBERS |= {name: does for name, (_, does) in _TWO.items()}
_NUMBERS |= {name: does for name, (_, does) in _ONE.items()}

#: All operations but tables: who interprets programs must know these.
OPERATIONS = (*_TWO, *_ONE)


@dataclass(frozen=True)
class PoseProgram:
    """See the module.  ``steps`` are (operation, a) or (operation, a, b)."""

    inputs: tuple[str, ...]
    constants: tuple[float, ...]
    steps: tuple[tuple[Any, ...], ...]
    tables: tuple[Curve, ...] = ()

    def evaluate(self, inputs: Mapping[str, Any]) -> list[Any]:
        """Every value, numbers or arrays of one shape; what has no value (1/0, log of -1) is inf or nan.

        Raises KeyError for an input that is not ``inputs``.
        """
        import numpy as np

        from mbsym.algebra.lookup import looked_up

        values: list[Any] = [np.asarray(inputs[name], dtype=float) for name in self.inputs]
        values += [np.float64(x) for x in self.constants]
        with np.errstate(all="ignore"):
            for operation, *operands in self.steps:
                arguments = [values[k] for k in operands]
                if operation in _NUMBERS:
                    name, _ = _TWO[operation] if operation in _TWO else _ONE[operation]
                    values.append(getattr(np, name)(*arguments))
                else:
                    values.append(looked_up(self._table(operation), *arguments))
        return values

    def at(self, inputs: Mapping[str, float]) -> list[float]:
        """Every value at one place, without NumPy; what has no value is inf or nan.

        Raises KeyError for an input that is not ``inputs``.
        """
        values = [*(float(inputs[name]) for name in self.inputs), *self.constants]
        for operation, *operands in self.steps:
            values.append(self.done(operation, [values[k] for k in operands]))
        return values

    def done(self, operation: str, arguments: Sequence[float]) -> float:
        """One step."""
        try:
            does = _NUMBERS.get(operation)
            return self._looked_up(operation, arguments[0]) if does is None else does(*arguments)
        except OverflowError:
            return math.inf
        except (ValueError, ZeroDivisionError):
            return math.nan

    @cached_property
    def depends(self) -> tuple[int, ...]:
        """On which inputs each value depends: bit i for input i."""
        bits = [1 << i for i in range(len(self.inputs))] + [0] * len(self.constants)
        for _, *operands in self.steps:
            bits.append(reduce(operator.or_, (bits[k] for k in operands)))
        return tuple(bits)

    def _table(self, operation: str) -> Curve:
        return self.tables[int(operation.removeprefix("table "))]

    def _looked_up(self, operation: str, x: float) -> float:
        from mbsym.algebra.lookup import looked_up

        return float(looked_up(self._table(operation), x))


class Varied(Sequence[float]):
    """The values of a program where some inputs are others: what depends on them is evaluated where it is asked for."""

    def __init__(self, program: PoseProgram, values: Sequence[float], given: Mapping[str, float]) -> None:
        self._program, self._values = program, values
        places = {name: k for k, name in enumerate(program.inputs)}
        self._new = {places[name]: float(value) for name, value in given.items() if name in places}
        self._changed = sum(1 << k for k in self._new)
        self._before = len(program.inputs) + len(program.constants)

    def __len__(self) -> int:
        return len(self._values)

    def __getitem__(self, place: Any) -> Any:
        depends, steps, new = self._program.depends, self._program.steps, self._new
        pending = [place]
        while pending:
            k = pending[-1]
            if k in new or not depends[k] & self._changed:
                pending.pop()
                continue
            operation, *operands = steps[k - self._before]
            unknown = [j for j in operands if j not in new and depends[j] & self._changed]
            if unknown:
                pending += unknown
            else:
                new[k] = self._program.done(operation, [new.get(j, self._values[j]) for j in operands])
        return new.get(place, self._values[place])


def flattened(program: Program, outputs: Sequence[Node], order: Sequence[str]) -> tuple[PoseProgram, dict[int, int]]:
    """The outputs as data, inputs in ``order`` (those that are needed), and which value each live instruction is.

    Raises NoClosedForm for an operation that pages do not know.
    """
    live = program.live(outputs)
    instructions = [(number, program.instructions[number]) for number in live]
    needed = {str(step.payload): number for number, step in instructions if step.operation == "input"}
    unknown = sorted(needed.keys() - set(order))
    if unknown:
        text = "the places of bodies depend on what has no value: [[names]]"
        raise NoClosedForm(text, names=", ".join(unknown))
    inputs = tuple(name for name in order if name in needed)
    value = {needed[name]: k for k, name in enumerate(inputs)}
    constants = [(number, step) for number, step in instructions if step.operation == "constant"]
    for number, _ in constants:
        value[number] = len(value)
    tables: list[Curve] = []
    steps: list[tuple[Any, ...]] = []
    for number, step in instructions:
        if step.operation in ("input", "constant"):
            continue
        name: str = step.operation
        if isinstance(name, Tabulated):
            if name.curve not in tables:
                tables.append(name.curve)
            name = f"table {tables.index(name.curve)}"
        else:
            name = _SHORT.get(name, name)
            if name not in OPERATIONS:
                raise NoClosedForm("pictures do not know the operation [[name]]", name=name)
        steps.append((name, *(value[k] for k in step.operands)))
        value[number] = len(value)
    numbers = tuple(float(step.payload) for _, step in constants)  # type: ignore[arg-type]
    return PoseProgram(inputs, numbers, tuple(steps), tuple(tables)), value
