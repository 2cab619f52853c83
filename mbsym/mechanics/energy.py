"""Kinetic energy over any scalar.

T = sum over bodies of  m/2 V_O^2 + m V_O.(omega x r_C) + 1/2 omega.Theta_O omega     (tensor about the joint)
                        m/2 V_C^2 + 1/2 omega.Theta_C omega                           (about the mass centre)
                        + h.omega                                                     (gyrostatic moment h)

The last term is linear in the velocities: T is Routh's function of the rotors inside the bodies, and T + U the
Lagrangian.  The energy that a free system keeps, T_2 - T_0 - U, does not contain it unless a body is carried by a
prescribed rotation.
"""

from __future__ import annotations

from fractions import Fraction

from mbsym.algebra.base import S
from mbsym.mechanics.kinematics import BodyMotion, Scene


def kinetic_energy(scene: Scene[S]) -> S:
    """T of the whole system, the gyrostatic term included."""
    algebra = scene.algebra
    total = gyrostatic_term(scene)
    for motion in scene.motions.values():
        total = total + body_energy(scene, motion)
    return algebra.reduce(total)


def gyrostatic_term(scene: Scene[S]) -> S:
    """sum of h.omega."""
    algebra = scene.algebra
    total = algebra.zero
    for motion in scene.motions.values():
        if motion.gyrostatic_moment is not None:
            total = total + motion.gyrostatic_moment.dot(motion.angular_velocity)
    return algebra.reduce(total)


def body_energy(scene: Scene[S], motion: BodyMotion[S]) -> S:
    """The kinetic energy of one body, without what a gyrostatic moment adds to T."""
    algebra = scene.algebra
    half = algebra.number(Fraction(1, 2))
    energy = algebra.zero
    about_joint = motion.body.inertia is not None and motion.body.inertia.about == "joint"
    if not algebra.vanishes(motion.mass):
        velocity = motion.velocity_origin if about_joint else motion.velocity_mass_centre
        doubled = velocity.dot(velocity)
        if about_joint:
            swing = motion.angular_velocity.cross(motion.mass_centre)
            doubled = doubled + algebra.times(algebra.number(2), velocity.dot(swing))
        energy = algebra.times(algebra.times(half, motion.mass), doubled)
    if motion.inertia is not None:
        spin = motion.angular_velocity
        energy = energy + algebra.times(half, spin.dot(motion.inertia @ spin))
    return energy
