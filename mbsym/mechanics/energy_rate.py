"""How fast the generalised energy changes: the power of what is not conservative, and of what is prescribed.

    h = q'.dL/dq' - L = T_2 - T_0 - U,      dh/dt = sum_i q'_i Q_i - dL/dt (explicit)

with Q_i the generalised forces of the loads without a force function, and dL/dt through t itself and through the
prescribed quantities, sum over x of rate_x dL/dx.  No accelerations enter: it is an identity of Lagrange's equations,
so where both terms vanish the energy is conserved, wherever the motion goes.

Source: Banshchikov & Vetrov (first integrals); Whittaker, Analytical Dynamics, section 41.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from mbsym.algebra.derivative import gradient
from mbsym.algebra.program import Node, Program
from mbsym.algebra.ring import Ring
from mbsym.expressions.rates import velocity_name
from mbsym.mechanics.energy import kinetic_energy
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.kinds import actions, force_function
from mbsym.mechanics.programs import scene_without_accelerations
from mbsym.model.system import System


@dataclass(frozen=True)
class EnergyRate:
    """dh/dt is the sum of ``terms``, nodes of ``program``, whose inputs bear the declared names."""

    program: Program
    terms: tuple[Node, ...]


def energy_rate(system: System, ring: Ring) -> EnergyRate:
    """dh/dt as straight-line code; without terms where it is zero at sight."""
    program = Program()
    scene = scene_without_accelerations(system, ring, program)
    terms = [*_explicit(scene, program), *_applied(scene, program)]
    return EnergyRate(program, tuple(term for term in terms if not program.vanishes(term)))


def _explicit(scene: Scene, program: Program) -> Iterator[Node]:
    """-dL/dt and -rate_x dL/dx, one term each."""
    lagrangian = kinetic_energy(scene) + force_function(scene)
    present = {program.instructions[number].payload for number in program.live([lagrangian])}
    rates = {"t": program.one} | {item.name: scene.lower(item.rate) for item in scene.system.prescribed}
    driven = [name for name in rates if name in present]
    slopes = gradient(program, lagrangian, [program.input(name) for name in driven])
    for name, slope in zip(driven, slopes, strict=True):
        yield -program.product(rates[name], slope)


def _applied(scene: Scene, program: Program) -> Iterator[Node]:
    """q'_i Q_i load by load: of a wrench F.(V_O - V_O at rest) + M.(omega - omega at rest)."""
    speeds = [program.input(name) for name in scene.system.velocities]
    for action in actions(scene, potential=False):
        for name, force in action.generalized.items():
            yield program.product(scene.environment[velocity_name(name)], force)
        for wrench in action.wrenches:
            motion = scene.motions[wrench.body]
            moving = (*motion.velocity_origin, *motion.angular_velocity)
            for force, component in zip((*wrench.force, *wrench.moment), moving, strict=True):
                if program.vanishes(force):
                    continue
                slopes = gradient(program, component, speeds)
                for slope, speed in zip(slopes, speeds, strict=True):
                    yield program.product(force, program.product(slope, speed))
