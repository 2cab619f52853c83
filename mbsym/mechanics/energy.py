"""Kinetic energy over any scalar.

T = sum over bodies of  m/2 V_O^2 + m V_O.(omega x r_C) + 1/2 omega.Theta_O omega     (tensor about the joint)
                        m/2 V_C^2 + 1/2 omega.Theta_C omega                           (about the mass centre)
"""

from __future__ import annotations

from fractions import Fraction

from mbsym.algebra.base import Scalar
from mbsym.mechanics.kinematics import BodyMotion, Scene


def kinetic_energy(scene: Scene) -> Scalar:
    """T of the whole system."""
    algebra = scene.algebra
    total = algebra.zero
    for motion in scene.motions.values():
        total = total + _body_energy(scene, motion)
    return algebra.reduce(total)


def _body_energy(scene: Scene, motion: BodyMotion) -> Scalar:
    algebra = scene.algebra
    half = algebra.number(Fraction(1, 2))
    energy = algebra.zero
    about_joint = motion.body.inertia is not None and motion.body.inertia.about == "joint"
    if not algebra.vanishes(motion.mass):
        velocity = motion.velocity_origin if about_joint else motion.velocity_mass_centre
        doubled = algebra.dot(velocity, velocity)
        if about_joint:
            swing = algebra.cross(motion.angular_velocity, motion.mass_centre)
            doubled = doubled + algebra.times(algebra.number(2), algebra.dot(velocity, swing))
        energy = algebra.times(algebra.times(half, motion.mass), doubled)
    if motion.inertia is not None:
        spin = motion.angular_velocity
        energy = energy + algebra.times(half, algebra.dot(spin, algebra.apply(motion.inertia, spin)))
    return energy
