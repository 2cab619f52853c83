"""Problem 2: kinetic energy and force function.

    T(q, q') = 1/2 sum A_ij(q) q'_i q'_j + sum A_i(q) q'_i + A_0(q),      L = T + U

with U the force function (U = -potential energy) of all loads that have one.  A gyrostatic moment h of a body (constant
angular momentum of rotors inside it) adds h.omega to T, which is then Routh's function of the rotors: the energy that
problem 7 finds, T_2 - T_0 - U, contains no term that is linear in the velocities.  A coordinate, or a prescribed angle,
is cyclic if L does not contain it (its velocity may occur).

Source: Banshchikov & Vetrov, eq. (1).

Example:

    >>> import mbsym
    >>> pendulum = mbsym.load("systems/simple-pendulum.yaml")
    >>> print(pendulum.energy.A2, pendulum.energy.force_function)
    [[m*l**2 + J]] m*l*g*cos(theta)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mbsym.algebra.ring import Polynomial, Ring
from mbsym.formulas.formula import Column, Formula, Matrix, Shown, column
from mbsym.mechanics.energy import kinetic_energy
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.kinds import force_function

if TYPE_CHECKING:
    from mbsym.mechanics.speeds import SpeedForm


@dataclass(frozen=True, repr=False)
class Energy(Shown):
    """``A2`` is n x n and symmetric, ``A1`` has n entries; ``cyclic`` lists coordinates and prescribed quantities.

    ``speeds``: what A2 and A1 belong to, velocities or speeds of their own.
    """

    counted = ("kinetic_energy", "force_function")

    kinetic_energy: Formula
    A2: Matrix
    A1: Column
    A0: Formula
    force_function: Formula
    cyclic: tuple[str, ...]
    speeds: tuple[str, ...]


def energy(scene: Scene, form: SpeedForm | None = None) -> Energy:
    """T, split by powers of the velocities (of the speeds of ``form``: A2 and A1 in their order), and U.

    The scene is over the ring.  No speed is said to be cyclic: L need not contain a quasi-coordinate, there is none.

    Raises NoClosedForm when T outgrows the budget of terms.
    """
    ring, names = scene.ring, scene.system.velocities
    kinetic, potential = kinetic_energy(scene), force_function(scene)
    at_rest = {ring.index("velocity", name): ring.zero for name in scene.system.coordinates}
    if form is not None:
        kinetic, potential = form.shortened(kinetic), form.shortened(potential)
        names, at_rest = tuple(u.name for u in form.speeds), {u.index: ring.zero for u in form.speeds}
    momenta = [ring.derivative(kinetic, name) for name in names]
    return Energy(
        kinetic_energy=Formula(ring, kinetic),
        A2=Matrix.of(ring, [[ring.derivative(p, name) for name in names] for p in momenta]),
        A1=column(ring, [ring.substitute(p, at_rest) for p in momenta]),
        A0=Formula(ring, ring.substitute(kinetic, at_rest)),
        force_function=Formula(ring, potential),
        cyclic=_cyclic(scene, ring, kinetic, potential) if form is None else (),
        speeds=names,
    )


def _cyclic(scene: Scene, ring: Ring, kinetic: Polynomial, potential: Polynomial) -> tuple[str, ...]:
    names = [*scene.system.coordinates, *(item.name for item in scene.system.of_constant_rate)]
    lagrangian = ring.reduce(kinetic + potential)
    return tuple(name for name in names if not ring.depends_on(lagrangian, name))
