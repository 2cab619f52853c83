"""What is compiled for a scenario is compiled once, and lives as long as the scenario's dynamics."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Any, TypeVar
from weakref import WeakKeyDictionary

from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import FLOAT64, Code, Kernel
from mbsym.numerics.kernels.llvm import kernel
from mbsym.numerics.machine_code import machine_code

_KEPT: WeakKeyDictionary[Dynamics, dict[Hashable, Any]] = WeakKeyDictionary()

Made = TypeVar("Made")


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
