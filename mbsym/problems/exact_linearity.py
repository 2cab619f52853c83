"""Whether the equations of motion are their own first approximation, in all orders.

M q'' = f(q, q', t) is exactly linear in q where M is constant and f is a polynomial of first degree in q and q', with
constant coefficients but for a part that depends on the time alone.  Deviations from any motion then obey
M x'' + C x' + S x = 0 with the same M, C, S at every time.  Proved in the ring, where every formula has one form: what
is seen in coordinates q is seen in all coordinates that depend on them by a constant matrix, q = q_0 + S y.

Constraints whose velocity rows are such polynomials, too, leave exactly linear equations of what is independent.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType

from mbsym.algebra.factors import occurring
from mbsym.algebra.failures import Failure
from mbsym.algebra.ring import Polynomial
from mbsym.algebra.terms import apart
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.kinds import generalized_forces
from mbsym.mechanics.motion import relations
from mbsym.problems.energy import Energy
from mbsym.problems.equations import convective_rate

#: The formulas of parameters that have to vanish; None where no parameters make the equations linear.
Excess = tuple[Polynomial, ...] | None


def excess(
    scene: Scene,
    energy: Energy,
    velocity_rows: Sequence[Polynomial] = (),
    known: Mapping[int, Polynomial] = MappingProxyType({}),
) -> Excess:
    """What keeps the equations from being linear; () where they are (scene over the ring, with its bodies).

    ``velocity_rows`` of constraints: J q' + j.  ``known``: values of generators near the motion (signs of velocities).
    """
    try:
        entries = [x for row in energy.A2.polynomials for x in row]
        mass_excess = _excess(scene, entries, 0, known)
        if mass_excess is None:
            return None
        further = _excess(scene, velocity_rows, 1, known)
        if further is None:
            return None
        forces = _excess(scene, _forcing(scene, energy), 1, known)
        return None if forces is None else (*mass_excess, *further, *forces)
    except Failure:
        return None


def _forcing(scene: Scene, energy: Energy) -> Iterable[Polynomial]:
    """f row by row, so that the first one that is not linear ends the search."""
    ring = scene.ring
    kinetic = energy.kinetic_energy.polynomial
    lagrangian = kinetic + energy.force_function.polynomial
    applied = generalized_forces(scene)
    for name in scene.system.coordinates:
        momentum = ring.velocity_derivative(kinetic, name)
        slope = ring.derivative(lagrangian, name)
        yield ring.reduce(slope + applied[name] - convective_rate(scene, ring, momentum))


def _excess(scene: Scene, formulas: Iterable[Polynomial], most: int, known: Mapping[int, Polynomial]) -> Excess:
    """The coefficients of what is of a higher degree than ``most``, or varies with the time."""
    ring, system = scene.ring, scene.system
    moving = (*system.coordinates, *system.velocities)
    running = (*(item.name for item in system.prescribed), "t")
    images = relations(scene) | dict(known)
    direct = {ring.index(kind, name) for kind in ("coordinate", "velocity") for name in system.coordinates}
    polynomials: list[Polynomial] = []
    for formula in formulas:
        x = ring.substitute(formula, images)
        others = [(k, ring.context.gen(k)) for k in occurring([x]) if k not in direct]
        curved = {k for k, g in others if ring.dependencies(g, moving)}
        late = {k for k, g in others if ring.dependencies(g, running)}
        varying = tuple(direct | curved | late)
        for key, part in apart(x, varying).items():
            held = [k for k, exponent in zip(varying, key, strict=True) if exponent]
            degree = sum(exponent for k, exponent in zip(varying, key, strict=True) if k in direct)
            runs = not late.isdisjoint(held)
            if degree <= most and curved.isdisjoint(held) and not (runs and (degree or not most)):
                continue
            if part.is_constant():
                return None
            polynomials.append(part)
    return tuple(polynomials)
