"""A system with expressions in place of its inputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from mbsym.expressions.tree import ZERO, Expression
from mbsym.model.inputs import Input
from mbsym.model.substitution import folded, put
from mbsym.model.system import System


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
