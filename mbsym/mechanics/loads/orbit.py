"""Where the bodies in a Newtonian field are: from the attracting centre to a frame O1 that carries them, and on.

The radius vector of a mass centre is r = p + c, with p = R e from the centre to O1 and c from O1 to the mass centre.
A field is expanded in c/R and in the extent of the bodies over R; the exact field needs only r.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Generic

from mbsym.algebra.base import S
from mbsym.algebra.vectors import Tensor, Vector, tensor_of
from mbsym.expressions.tree import names
from mbsym.mechanics.kinematics import BodyMotion, Scene, over_ring
from mbsym.mechanics.loads.interface import Action, Wrench
from mbsym.mechanics.variables import expressions
from mbsym.model.loads import NewtonianGravity
from mbsym.model.system import INERTIAL


class Orbit(Generic[S]):
    """Distance R of the expansion point O1 from the centre, unit vector e, and each body's mass centre c from O1.

    first, square, cube: nu/R, nu/R^2, nu/R^3.  ``potential`` and ``weight`` are the first two as they act at O1: zero
    where the frame falls.
    """

    def __init__(self, load: NewtonianGravity, scene: Scene[S]) -> None:
        algebra, ring = scene.algebra, scene.ring
        # The distance is simplified in the ring, where sin^2 + cos^2 = 1, and then carried into the algebra at hand.
        radius = outward(load, scene)
        distance = ring.square_root(radius.dot(radius))
        self.inverse = scene.carry(ring.reciprocal(distance))
        inverse = ring.reciprocal(distance)
        a, b, c = (ring.dot((inverse,), (x,)) for x in radius)
        self.scene = scene
        self.about = load.about
        self.centre = load.centre
        self.unit = scene.carried(Vector(ring, (a, b, c), load.about))
        self.constant = scene.lower(load.constant)
        self.cube = algebra.times(self.constant, algebra.power(self.inverse, 3))
        self.square = algebra.times(self.constant, algebra.power(self.inverse, 2))
        self.first = algebra.times(self.constant, self.inverse)
        # What acts alike on all masses counts as part of a falling frame's own acceleration.
        self.falling = load.about in scene.falling
        self.potential = algebra.zero if self.falling else self.first
        self.weight = algebra.zero if self.falling else self.square

    def bodies(self) -> list[tuple[BodyMotion[S], Vector[S], Vector[S]]]:
        """(motion, e, c) of every body carried by the frame O1, in the body's axes."""
        return _carried(self.scene, self.about, self.centre, self.unit)


def radius_vectors(load: NewtonianGravity, scene: Scene[S]) -> list[tuple[BodyMotion[S], Vector[S]]]:
    """(motion, r) of every body carried by the frame ``about``: r from the centre to its mass centre, in its axes."""
    start = scene.carried(outward(load, scene))
    return [(motion, p + c) for motion, p, c in _carried(scene, load.about, load.centre, start)]


def outward(load: NewtonianGravity, scene: Scene[S]) -> Vector[S]:
    """p from the centre to the origin of ``about``, over the ring, in the axes of ``about``."""
    ring = scene.ring
    closed = scene if scene.algebra is ring else over_ring(scene.system, ring)
    frame = scene.common_ancestor(load.about, load.centre)
    p = closed.position(closed.zero(load.about), frame)
    if frame != load.centre:
        p = p - closed.position(closed.zero(load.centre), frame)
    return closed.to_axes(p, load.about)


def _carried(
    scene: Scene[S], about: str, centre: str, direction: Vector[S]
) -> list[tuple[BodyMotion[S], Vector[S], Vector[S]]]:
    """(motion, direction, c) of every body with mass or inertia that ``about`` carries, both in the body's axes.

    The centre does not attract itself.
    """
    algebra = scene.algebra
    turned: dict[str, Vector[S]] = {about: direction}
    origin: dict[str, Vector[S]] = {about: scene.zero(about)}
    bodies = []
    for name, motion in scene.motions.items():
        parent = motion.body.attached_to
        if name != about:
            if parent not in turned:
                continue
            turned[name] = scene.to_axes(turned[parent], name)
            origin[name] = scene.to_axes(origin[parent] + motion.offset, name)
        massless = algebra.vanishes(motion.mass) and motion.inertia is None
        if not massless and name != centre:
            bodies.append((motion, turned[name], origin[name] + motion.mass_centre))
    return bodies


def central_inertia(scene: Scene[S], motion: BodyMotion[S]) -> Tensor[S] | None:
    """Theta_C = Theta_O - m (c.c 1 - c c^T) for a tensor given about the joint."""
    if motion.inertia is None or motion.body.inertia is None:
        return None
    if motion.body.inertia.about == "mass centre":
        return motion.inertia
    algebra = scene.algebra
    c = motion.mass_centre
    square = c.dot(c)
    rows = []
    for i in range(3):
        row = []
        for j in range(3):
            steiner = (square if i == j else algebra.zero) - algebra.times(c[i], c[j])
            row.append(algebra.reduce(motion.inertia[i][j] - algebra.times(motion.mass, steiner)))
        rows.append(row)
    return tensor_of(algebra, rows, c.frame)


def trace(tensor: Tensor[S]) -> S:
    return tensor[0][0] + tensor[1][1] + tensor[2][2]


def _moves(scene: Scene[S], frame: str) -> bool:
    """Whether a frame depends on coordinates; a fixed or prescribed one feels no generalised force."""
    coordinates = set(scene.system.coordinates)
    path = [scene.system.body(name) for name in scene.system.path(frame) if name != INERTIAL]
    return any(coordinates & names(x) for body in path for x in expressions((body.rotation, body.connection_point)))


def completed(
    load: NewtonianGravity,
    scene: Scene[S],
    wrenches: Sequence[Wrench[S]],
    at_origin: Callable[[], Wrench[S]] | None = None,
) -> Action[S]:
    """The action on the bodies, with what acts on O1 (``at_origin``) and on the centre where these move.

    U changes neither when centre, O1 and bodies are all shifted, nor when all are turned about the centre.  So a centre
    that is a body itself feels minus the sum of all other forces, at its origin, and nothing else.
    """
    all_wrenches = list(wrenches)
    centre_moves = _moves(scene, load.centre)
    if at_origin is not None and (centre_moves or _moves(scene, load.about)):
        all_wrenches.append(at_origin())
    if centre_moves:
        total = scene.zero(load.centre)
        for wrench in all_wrenches:
            total = total + scene.to_axes(wrench.force, load.centre)
        all_wrenches.append(Wrench(load.centre, -total, scene.zero(load.centre)))
    return Action(tuple(wrench for wrench in all_wrenches if wrench.body != INERTIAL))
