"""What is compiled for a scenario is compiled once, and lives as long as the scenario's dynamics."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import replace
from typing import Any, TypeVar
from weakref import WeakKeyDictionary

from mbsym.numerics.compensation import compensated_code
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import FLOAT64, Code, Kernel
from mbsym.numerics.kernels.llvm import kernel
from mbsym.numerics.scenario import Scenario

#: The codes that are looked at, and which of n coordinates' outputs count.
COMPENSATED = ("right_hand_side", "pivots")


Made = TypeVar("Made")


_KEPT: WeakKeyDictionary[Dynamics, dict[Hashable, Any]] = WeakKeyDictionary()


def machine_code(dynamics: Any, name: str, scalar: str = FLOAT64) -> Code:
    """One of the codes of a Dynamics as the kernels of a scalar take it.

    In float64 what a scene makes sensitive (ratios of masses) is compensated where that is measured to keep digits
    (``mbsym.numerics.compensation``); other arithmetics, other codes, and dynamics without a scenario take the code as
    it is.
    """
    code: Code = getattr(dynamics, name)
    given = getattr(dynamics, "scenario", None)
    if scalar != FLOAT64 or name not in COMPENSATED or not isinstance(given, Scenario):
        return code
    judged = range(len(code.outputs) // 2 if name == "right_hand_side" else 0, len(code.outputs))
    instructions = [code.program.instructions[number] for number in code.program.live(code.outputs)]
    read = {str(one.payload) for one in instructions if one.operation == "input"} - set(code.inputs)
    found = compensated_code(given, replace(code, inputs=(*code.inputs, *sorted(read))), judged)
    return code if found is None else replace(found.code, inputs=code.inputs)


def once(dynamics: Dynamics, key: Hashable, make: Callable[[], Made]) -> Made:
    """``make()``, or what it made before for the same dynamics and key; it must not hold on to the dynamics."""
    kept = _KEPT.setdefault(dynamics, {})
    if key not in kept:
        kept[key] = make()
    found: Made = kept[key]
    return found


def code_of(dynamics: Dynamics, name: str, scalar: str = FLOAT64) -> Code:
    """A code of a Dynamics as it is compiled, with sensitive operations in pairs; made once."""
    return once(dynamics, ("machine code", name, scalar), lambda: machine_code(dynamics, name, scalar))


def compiled_kernel(dynamics: Dynamics, name: str, scalar: str = FLOAT64) -> Kernel:
    """The kernel of one of the codes of a Dynamics (``right_hand_side``, ``jacobian``, ...)."""

    def make() -> Kernel:
        return kernel(code_of(dynamics, name, scalar), scalar)

    return once(dynamics, ("kernel", name, scalar), make)
