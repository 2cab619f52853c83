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
from typing import Any

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


#: values of shape (inputs,) or (inputs, m) -> results of shape (outputs,) or (outputs, m)
Kernel = Callable[[Any], Any]
