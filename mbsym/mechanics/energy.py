"""Kinetic energy over any scalar.

T = sum over bodies of  m/2 V_O^2 + m V_O.(omega x r_C) + 1/2 omega.Theta_O omega     (tensor about the joint)
                        m/2 V_C^2 + 1/2 omega.Theta_C omega                           (about the mass centre)
                        + h.omega                                                     (gyrostatic moment h)

The last term is linear in the velocities: T is Routh's function of the rotors inside the bodies, and T + U the
Lagrangian.  The energy that a free system keeps, T_2 - T_0 - U, does not contain it unless a body is carried by a
prescribed rotation.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from mbsym.algebra.base import S
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.matrices import determinant
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.tree import names
from mbsym.mechanics.articulation import mass_properties
from mbsym.mechanics.kinematics import BodyMotion, Scene
from mbsym.mechanics.variables import expressions, ring_environment
from mbsym.model.system import INERTIAL, System, acceleration_name, velocity_name


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


# Whether a mass matrix is regular, joint by joint: the kinetic energy of each joint's own body.
#
# M v = 0 means that no body has kinetic energy.  From the base outwards: if what carries body k rests, T_k = 0 leaves
# v = 0 for the velocities v of its joint wherever det d2 T_k / dv dv is not zero.  So M is regular where none of these
# determinants vanishes; they hold one joint's coordinates each, however long the chain.


def own_determinants(system: System, ring: Ring) -> list[Polynomial]:
    """For every joint, det d2 T_k / dv dv of its own body k over the joint's velocities v, all that carries it at rest.

    M v = 0 means that no body has kinetic energy.  From the base outwards: if what carries a body rests, T_k = 0 leaves
    v = 0 where this determinant is not zero.  So M is regular where none of them vanishes.  The coordinates of a joint
    whose own body has no such energy are taken together with those of the next body that it carries.
    Raises NoClosedForm where that never tells a coordinate, or a body's tensor is none of any distribution of mass.
    """
    done: set[str] = set()
    waiting: dict[str, list[str]] = {INERTIAL: []}
    polynomials = []
    moving = _Energies(system, ring)
    for body in system.bodies:
        inside = {x for e in expressions((body.rotation, body.connection_point)) for x in names(e)}
        open_ = [x for x in waiting[body.attached_to] if x not in done]
        own = open_ + [x for x in system.coordinates if x in inside and x not in done and x not in open_]
        waiting[body.name] = own
        if not own:
            continue
        moving.check(body.name)
        rows = moving.hessian(body.name, own)
        value = determinant(ring, rows)
        if not value.is_zero():
            polynomials.append(value)
            done.update(own)
    left = [name for name in system.coordinates if name not in done]
    if left:
        raise NoClosedForm("no body alone tells [[names]]", names=", ".join(left))
    return polynomials


#: Rows and columns of the principal minors of a 3 x 3 matrix.
_PRINCIPAL = ((0,), (1,), (2,), (0, 1), (0, 2), (1, 2), (0, 1, 2))


def central_tensor(scene: Scene, body: str) -> list[list[Polynomial]]:
    """Theta_C = Theta_O - m (c.c 1 - c c^T)."""
    algebra, motion = scene.algebra, scene.motions[body]
    rows = [list(row) for row in mass_properties(scene, body).tensor]
    c, square = motion.mass_centre, motion.mass_centre.dot(motion.mass_centre)
    for i in range(3):
        for j in range(3):
            inner = (square if i == j else algebra.zero) - algebra.times(c[i], c[j])
            rows[i][j] = algebra.reduce(rows[i][j] - algebra.times(motion.mass, inner))
    return rows


def _constant(x: Polynomial) -> Any:
    return x.leading_coefficient() if not x.is_zero() else 0


class _Energies:
    """Kinetic energies of single bodies at unit velocities."""

    def __init__(self, system: System, ring: Ring) -> None:
        self.system, self.ring = system, ring
        self.known: dict[tuple[str, ...], Scene] = {}

    def check(self, body: str) -> None:
        """T_k >= 0 is what all rests on: m >= 0, and a positive semidefinite tensor about the mass centre."""
        if () not in self.known:
            self._energy(body, ())
        scene, ring = self.known[()], self.ring
        motion = scene.motions[body]
        tensor = central_tensor(scene, body)
        minors = [ring.reduce(determinant(ring, [[tensor[i][j] for j in k] for i in k])) for k in _PRINCIPAL]
        if any(not x.is_constant() or _constant(x) < 0 for x in (ring.reduce(motion.mass), *minors)):
            raise NoClosedForm(
                "the mass and tensor of [[body]] are not those of a body at rest in its own axes", body=body
            )

    def hessian(self, body: str, moving: Sequence[str]) -> list[list[Polynomial]]:
        """d2 T_k / dv_i dv_j = T_k(e_i + e_j) - T_k(e_i) - T_k(e_j)."""
        single = {name: self._energy(body, (name,)) for name in moving}
        rows = [[2 * single[i] for _ in moving] for i in moving]
        for i, first in enumerate(moving):
            for j, second in enumerate(moving[:i]):
                both = self._energy(body, (first, second)) - single[first] - single[second]
                rows[i][j] = rows[j][i] = self.ring.reduce(both)
        return rows

    def _energy(self, body: str, moving: tuple[str, ...]) -> Polynomial:
        if moving not in self.known:
            ring, system = self.ring, self.system
            environment = ring_environment(system, ring)
            for name in system.coordinates:
                environment[velocity_name(name)] = ring.one if name in moving else ring.zero
                environment[acceleration_name(name)] = ring.zero
            self.known[moving] = Scene(system, ring, environment, ring, frozen=True)
        scene = self.known[moving]
        return self.ring.reduce(body_energy(scene, scene.motions[body]))
