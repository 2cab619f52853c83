"""The small interface between programs and back ends.

``Code`` is what is compiled, a ``Kernel`` what comes out.  A back end is a function from a Code to a Kernel:

=============  ===========================================  ==================================
``llvm``       machine code, float64, float32 and extended  simulation
``arrays``     NumPy source, vectorised over states         portable, readable, no compiler
``balls``      ``arb`` at any precision                     rigorous enclosures
``precise``    ``arb`` as a Python function                 reference solutions
=============  ===========================================  ==================================
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import count
from typing import Any
from weakref import WeakValueDictionary

import numpy as np

from mbsym.algebra.program import Node, Program

#: The arithmetic of a kernel, by the name that users give it.
FLOAT32, FLOAT64, EXTENDED = "float32", "float64", "extended"


@dataclass(frozen=True)
class Code:
    """Outputs of a program as a function of the named inputs, in their order; it has no other inputs."""

    program: Program
    inputs: tuple[str, ...]
    outputs: tuple[Node, ...]

    @cached_property
    def operations(self) -> int:
        return self.program.operations(self.outputs)

    @cached_property
    def in_any_units(self) -> int:
        """The operations but for products with numbers: where a unit makes a number 1, there is no such product."""
        instructions = self.program.instructions
        live = (instructions[number] for number in self.program.live(self.outputs))
        products = (x.operands for x in live if x.operation == "multiply")
        return self.operations - sum(any(instructions[k].operation == "constant" for k in x) for x in products)


#: values of shape (inputs,) or (inputs, m) -> results of shape (outputs,) or (outputs, m)
Kernel = Callable[[Any], Any]


# Numbers that compiled code reads from memory whenever it runs: one kernel serves all their values.
#
# In a program each is an input by a name of its own, which no description can have; it is no input of the kernel.


_ALL: WeakValueDictionary[str, Cells] = WeakValueDictionary()
_NUMBERS = count()


class Cells:
    """``values`` (float64) in memory, which must outlive the code that reads them; ``names`` of them in programs."""

    def __init__(self, size: int) -> None:
        self.values = np.zeros(size)
        number = next(_NUMBERS)
        self.names = tuple(f"cell {number}.{place}" for place in range(size))
        _ALL.update(dict.fromkeys(self.names, self))


def place_of(name: str) -> int | None:
    """Which of its cells a name is; None for the name of anything else."""
    cells = _ALL.get(name)
    return None if cells is None else cells.names.index(name)


def value_of(name: str) -> float:
    """What stands in a cell now.  Raises KeyError for other names."""
    cells = _ALL[name]
    return float(cells.values[cells.names.index(name)])


def address_of(name: str) -> int:
    """Where a cell is.  Raises KeyError for other names."""
    cells = _ALL[name]
    address: int = cells.values.ctypes.data
    return address + cells.names.index(name) * cells.values.itemsize
