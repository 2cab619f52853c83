"""The symbols in which periodic solutions of problem 12 are told: phase, amplitude, and values at the phase 0."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from mbsym.model.system import System

#: What they are called, unless a description has the name for something else.
PHASE, AMPLITUDE = "phase", "amplitude"


@dataclass(frozen=True)
class OscillationNames:
    """``phases``, ``amplitudes``: of the only one, or of each that a variable leads.

    ``starts``: x_0 by the name of x, its value at the phase 0 where x is constant without the small parameter.
    """

    phases: tuple[str, ...]
    amplitudes: tuple[str, ...]
    starts: Mapping[str, str]

    @property
    def all(self) -> tuple[str, ...]:
        return (*self.phases, *self.amplitudes, *self.starts.values())


def oscillation_names(variables: Iterable[str], taken: Iterable[str], leading: Sequence[str] = ()) -> OscillationNames:
    """Names for the symbols of a solution in ``variables``; one that is ``taken`` gets an underscore more.

    Of several variables that are ``leading``: ``phase_x``, ``amplitude_x``.
    """
    variables = tuple(variables)
    known = {*taken, *variables}

    def free(name: str) -> str:
        while name in known:
            name += "_"
        known.add(name)
        return name

    plain = {name: "".join(x if x.isalnum() else "_" for x in name).strip("_") for name in variables}
    endings = [f"_{plain[name]}" for name in leading] if len(leading) > 1 else [""]
    phases, amplitudes = (tuple(free(f"{word}{ending}") for ending in endings) for word in (PHASE, AMPLITUDE))
    return OscillationNames(phases, amplitudes, {name: free(f"{word}_0") for name, word in plain.items()})


def oscillating_variables(system: System) -> tuple[str, ...]:
    """What may oscillate: coordinates, velocities, declared variables."""
    return (*system.coordinates, *system.velocities, *system.variables)


def names_in(system: System) -> set[str]:
    """Every name that stands for something in the description."""
    records = (system.prescribed, system.notation, system.abbreviations, system.inputs, system.outputs, system.tables)
    return {
        *oscillating_variables(system),
        *system.parameter_names,
        *(entry.name for some in records for entry in some),
    }
