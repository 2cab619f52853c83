"""What the momenta of a system are called: by a name each that nothing else has."""

from __future__ import annotations

from mbsym.model.system import System


def momentum_names(system: System) -> dict[str, str]:
    """p_theta for theta, or another name where that is taken."""
    taken = {*system.coordinates, *system.parameter_names, *system.variables, *system.input_names}
    taken |= {item.name for item in system.prescribed} | {item.name for item in system.notation}
    taken |= {item.name for item in system.abbreviations} | {item.name for item in system.outputs}
    found = {}
    for name in system.coordinates:
        free = next(x for x in (f"p_{name}", *(f"p{k}_{name}" for k in range(1, 100))) if x not in taken)
        found[name] = free
        taken.add(free)
    return found
