"""Problem 1: kinematics.

For every body B_k attached to B_j, in the axes of body k:

    R^jk = C_a3(x3) C_a2(x2) C_a1(x1)           direction cosines, v^k = R^jk v^j
    omega^j_k                                   relative angular velocity
    omega_k = R^jk omega_j + omega^j_k          absolute angular velocity
    V_Ok = R^jk (V_Oj + omega_j x r^j_Ok + V^j_Ok)
    V_Ck = V_Ok + omega_k x r^k_Ck

Source: Banshchikov & Vetrov, Problem 1 (which prints omega_k x r^j_Ok; r^j_Ok is fixed in body j, so it is omega_j).

Example:

    >>> import mbsym
    >>> pendulum = mbsym.load("systems/simple-pendulum.yaml")
    >>> pendulum.kinematics.body("pendulum").velocity_mass_centre
    (Formula(l*theta_dot), Formula(0), Formula(0))
"""

from __future__ import annotations

from dataclasses import dataclass

from mbsym.formulas.formula import Column, Matrix, Shown, column
from mbsym.mechanics.frames import direction_cosines
from mbsym.mechanics.kinematics import BodyMotion, Scene


@dataclass(frozen=True, repr=False)
class BodyKinematics(Shown):
    """One body's kinematics; vectors have three components in the body's own axes."""

    counted = ("rotation", "angular_velocity", "velocity_origin", "velocity_mass_centre")

    name: str
    attached_to: str
    rotation: Matrix
    relative_angular_velocity: Column
    angular_velocity: Column
    velocity_origin: Column
    velocity_mass_centre: Column


@dataclass(frozen=True, repr=False)
class Kinematics(Shown):
    counted = ("bodies",)

    bodies: tuple[BodyKinematics, ...]

    def body(self, name: str) -> BodyKinematics:
        """Those of the body of that name.  Raises KeyError where there is none."""
        for body in self.bodies:
            if body.name == name:
                return body
        raise KeyError(name)


def kinematics(scene: Scene) -> Kinematics:
    """Direction cosines, angular velocities and velocities of every body, as closed formulas (scene over the ring)."""
    return Kinematics(tuple(_body(scene, motion) for motion in scene.motions.values()))


def _body(scene: Scene, motion: BodyMotion) -> BodyKinematics:
    ring = scene.ring
    rotation = direction_cosines(ring, motion.turns, motion.body.attached_to, motion.body.name)
    return BodyKinematics(
        name=motion.body.name,
        attached_to=motion.body.attached_to,
        rotation=Matrix.of(ring, rotation.rows),
        relative_angular_velocity=column(ring, motion.relative_angular_velocity.components),
        angular_velocity=column(ring, motion.angular_velocity.components),
        velocity_origin=column(ring, motion.velocity_origin.components),
        velocity_mass_centre=column(ring, motion.velocity_mass_centre.components),
    )
