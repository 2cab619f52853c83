"""The code that is compiled for rates and pivots: the plain one, or one with sensitive operations in pairs."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from mbsym.numerics.compensation import compensated_code
from mbsym.numerics.kernels.interface import FLOAT64, Code
from mbsym.numerics.scenario import Scenario

#: The codes that are looked at, and which of n coordinates' outputs count.
COMPENSATED = ("right_hand_side", "pivots")


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
