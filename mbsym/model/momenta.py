"""What the momenta of a system are called: by a name each that nothing else has."""

from __future__ import annotations

from mbsym.model.system import System


def denominator_names(system: System, count: int) -> tuple[str, ...]:
    """Delta_1, Delta_2, ... or others that nothing has, momenta included."""
    taken = {*system.coordinates, *system.parameter_names, *system.variables, *system.input_names}
    taken |= {item.name for item in system.prescribed} | {item.name for item in system.notation}
    taken |= {*momentum_names(system).values()}
    stem = next(x for x in ("Delta", *(f"Delta{k}" for k in range(1, 100))) if not any(y.startswith(x) for y in taken))
    return tuple(f"{stem}_{k + 1}" for k in range(count))


def momentum_names(system: System) -> dict[str, str]:
    """p_theta for theta, a coordinate or a declared speed, or another name where that is taken."""
    taken = {*system.coordinates, *system.parameter_names, *system.variables, *system.input_names}
    taken |= {item.name for item in system.prescribed} | {item.name for item in system.notation}
    taken |= {item.name for item in system.abbreviations} | {item.name for item in system.outputs}
    momenta = {}
    for name in (*system.coordinates, *(speed.name for speed in system.speeds)):
        free = next(x for x in (f"p_{name}", *(f"p{k}_{name}" for k in range(1, 100))) if x not in taken)
        momenta[name] = free
        taken.add(free)
    return momenta
