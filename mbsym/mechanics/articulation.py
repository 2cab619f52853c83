"""A system as a chain of elementary frames: what the lean recursions walk along.

A body with turns about x1, x2, x3 becomes three frames, each displaced from its parent and turned about one of its own
axes at most; the last one bears the body.  Vectors turn about a coordinate axis with 6 operations and symmetric tensors
with 16, so nothing is gained by forming a rotation matrix.

Mass properties (m, first moment h = m c, tensor J about the frame's origin) are moved towards the base as far as no
motion can tell: a joint that turns about the axis a feels neither m nor h_a, for the parts of

    T = m/2 V_O^2 + V_O.(omega x h) + 1/2 omega.J omega

that hold them do not depend on the turn, and one that slides does not feel J (the regrouping of inertial parameters of
Khalil & Kleinfinger, IEEE J. Robotics Automation 3 (1987) 517-526; the part of it that only adds).  What is moved is
made of parameters alone and costs nothing at run time.  A body that is welded to another moves to it with all that it
has, and its frame stays behind without mass, for points and loads on it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Generic

from mbsym.algebra.base import Algebra, S
from mbsym.algebra.vectors import Tensor, Vector, axis_vector, symmetric_tensor, tensor_of, zero_tensor, zero_vector
from mbsym.expressions.tree import Expression, differentiate, names
from mbsym.mechanics.frames import Turn
from mbsym.mechanics.kinematics import Scene
from mbsym.model.system import INERTIAL, Body
from mbsym.model.welded import still_names, welded


@dataclass(frozen=True, slots=True)
class MassProperties(Generic[S]):
    """Mass, first moment m c and the symmetric tensor about the frame's origin, in the frame's axes."""

    mass: S
    first_moment: Vector[S]
    tensor: Tensor[S]


@dataclass(frozen=True, slots=True)
class Frame(Generic[S]):
    """One elementary frame; ``parent`` is -1 for the inertial frame, vectors are in the parent's axes.

    offset, offset_rate, offset_acceleration: r, r' and r'' of the frame's origin at q'' = 0.  The partial derivatives
    are those of the angle and of r with respect to each coordinate that they contain.  ``fixed_turn`` and
    ``fixed_offset`` say that nothing occurs in them that moves; ``together`` that one coordinate drives several
    elementary joints of the body, or several coordinates one turn, so that they cannot be taken one by one.
    """

    body: str
    parent: int
    turn: Turn[S] | None
    offset: Vector[S]
    offset_rate: Vector[S]
    offset_acceleration: Vector[S]
    angle_derivatives: Mapping[str, S]
    offset_derivatives: Mapping[str, Vector[S]]
    fixed_turn: bool
    fixed_offset: bool
    together: bool

    @property
    def name(self) -> str:
        """What vectors in its axes are marked with; the name of the body for the last of its frames."""
        return self.body if self.turn is None else self.turn.frame

    def out(self, v: Vector[S]) -> Vector[S]:
        """A vector from the parent's axes to the frame's."""
        return v.in_parallel(self.body) if self.turn is None else self.turn.out(v)

    def back(self, v: Vector[S]) -> Vector[S]:
        """A vector from the frame's axes to the parent's."""
        return v.in_parallel(self.offset.frame) if self.turn is None else self.turn.back(v)


@dataclass(frozen=True)
class Articulation(Generic[S]):
    """``frames`` parents first; ``frame_of`` maps a body to its own frame, ``masses`` holds each frame's properties.

    ``scene`` is the system at q'' = 0 (its accelerations' environment holds zeros).
    """

    scene: Scene[S]
    frames: tuple[Frame[S], ...]
    frame_of: Mapping[str, int]
    masses: tuple[MassProperties[S], ...]

    @property
    def algebra(self) -> Algebra[S]:
        return self.scene.algebra

    @property
    def coordinates(self) -> tuple[str, ...]:
        return self.scene.system.coordinates


def articulation(scene: Scene[S], apart: bool = False) -> Articulation[S]:
    """The elementary frames of a scene whose accelerations are zero, with regrouped mass properties.

    With ``apart`` the bodies that are welded to others keep their mass properties for themselves.
    """
    builder = _Builder(scene)
    for body in scene.system.bodies:
        builder.add(body)
    properties = [mass_properties(scene, name) for name in scene.motions]
    own = dict(zip(builder.frame_of.values(), properties, strict=True))
    welded_frames = frozenset(builder.frame_of[name] for name in welded(scene.system)) if apart else frozenset[int]()
    masses = _regrouped(scene.algebra, builder.frames, own, welded_frames)
    return Articulation(scene, tuple(builder.frames), builder.frame_of, masses)


class _Builder(Generic[S]):
    def __init__(self, scene: Scene[S]) -> None:
        self.scene = scene
        self.frames: list[Frame[S]] = []
        self.frame_of: dict[str, int] = {}
        self.still = still_names(scene.system)
        self.coordinates = set(scene.system.coordinates)

    def add(self, body: Body) -> None:
        scene, motion, before = self.scene, self.scene.motions[body.name], body.attached_to
        parent = -1 if before == INERTIAL else self.frame_of[before]
        point = body.connection_point
        first = [scene.rate(x) for x in point]
        present = set[str]().union(*(names(x) for x in point))
        steered = [name for name in scene.system.coordinates if name in present] if present & self.coordinates else []
        slopes = [self._derivatives(turn.angle) for turn in motion.turns]
        driven = Counter(name for names_ in (*slopes, steered) for name in names_)
        together = any(count > 1 for count in driven.values()) or any(len(slope) > 1 for slope in slopes)
        frame = Frame(
            body=body.name,
            parent=parent,
            turn=None,
            offset=motion.offset,
            offset_rate=scene.vector(first, before),
            offset_acceleration=scene.vector([scene.rate(x) for x in first], before),
            angle_derivatives={},
            offset_derivatives={
                name: scene.vector([differentiate(x, name) for x in point], before) for name in steered
            },
            fixed_turn=True,
            fixed_offset=present <= self.still,
            together=together,
        )
        if not motion.turns:
            self.frames.append(frame)
        for number, turn in enumerate(motion.turns):
            fixed = names(turn.angle) <= self.still
            if number == 0:
                moved = (
                    frame.offset,
                    frame.offset_rate,
                    frame.offset_acceleration,
                    frame.offset_derivatives,
                    frame.fixed_offset,
                )
            else:
                parent, zero = len(self.frames) - 1, scene.zero(turn.source)
                moved = (zero, zero, zero, {}, True)
            offset, offset_rate, offset_acceleration, derivatives, still = moved
            self.frames.append(
                Frame(
                    body.name,
                    parent,
                    turn,
                    offset,
                    offset_rate,
                    offset_acceleration,
                    slopes[number],
                    derivatives,
                    fixed,
                    still,
                    together,
                )
            )
        self.frame_of[body.name] = len(self.frames) - 1

    def _derivatives(self, angle: Expression) -> dict[str, S]:
        coordinates = sorted(names(angle) & self.coordinates)
        return {name: self.scene.lower(differentiate(angle, name)) for name in coordinates}


# --- mass properties ---


def mass_properties(scene: Scene[S], name: str) -> MassProperties[S]:
    """A body's mass properties about its connection point."""
    algebra, motion = scene.algebra, scene.motions[name]
    tensor = zero_tensor(algebra, name) if motion.inertia is None else motion.inertia
    moment = motion.mass_centre * motion.mass
    own = MassProperties(motion.mass, moment, tensor)
    if motion.body.inertia is not None and motion.body.inertia.about == "joint":
        return own
    # About the mass centre, the first moment vanishes: moving by c adds m (c.c 1 - c c^T).
    central = MassProperties(motion.mass, scene.zero(name), tensor)
    return MassProperties(motion.mass, moment, shifted(algebra, central, motion.mass_centre).tensor)


def total(a: MassProperties[S], b: MassProperties[S]) -> MassProperties[S]:
    """Two bodies on one frame."""
    tensor = a.tensor + b.tensor
    return MassProperties(a.mass + b.mass, a.first_moment + b.first_moment, tensor)


def nothing(algebra: Algebra[S], frame: str) -> MassProperties[S]:
    return MassProperties(algebra.zero, zero_vector(algebra, frame), zero_tensor(algebra, frame))


def shifted(algebra: Algebra[S], x: MassProperties[S], r: Vector[S]) -> MassProperties[S]:
    """The same body about a point from which its old origin is seen at r, in the same axes.

    With g = 2 h + m r:  J + r.g 1 - (r g^T + g r^T)/2,  that is J11 + r2 g2 + r3 g3, J12 - r1 h2 - r2 (h1 + m r1), ...
    """
    if r.vanishes():
        return x
    m, h = x.mass, x.first_moment
    own = r * m
    moved = h + own
    twice = h + moved
    along = [algebra.times(a, b) for a, b in zip(r, twice, strict=True)]
    rows = [list(row) for row in x.tensor]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        rows[i][i] = rows[i][i] + (along[j] + along[k])
        mixed = algebra.dot((r[i], r[j]), (h[j], moved[i]))
        low, high = min(i, j), max(i, j)
        rows[low][high] = rows[high][low] = rows[low][high] - mixed
    return MassProperties(m, moved, symmetric_tensor(algebra, rows, h.frame))


def turned_back(algebra: Algebra[S], x: MassProperties[S], frame: Frame[S]) -> MassProperties[S]:
    """The same body in the axes before the turn of a frame."""
    moment = frame.back(x.first_moment)
    if frame.turn is None:
        return MassProperties(x.mass, moment, x.tensor.in_parallel(moment.frame))
    return MassProperties(x.mass, moment, turned_symmetric(algebra, frame.turn, x.tensor))


def turned_symmetric(algebra: Algebra[S], turn: Turn[S], matrix: Tensor[S]) -> Tensor[S]:
    """C^T S C for a symmetric S, with C = C_a(x), in at most 16 operations.

    In the plane of the turn, with the entries p, q, s (q off the diagonal) and  u = sin (p - s) + 2 cos q:
    p - u sin,  cos u - q,  s + u sin.
    """
    a = turn.axis - 1
    i, j = (a + 1) % 3, (a + 2) % 3
    sine, cosine, times = turn.sine, turn.cosine, algebra.times
    rows = [list(row) for row in matrix]
    p, q, s = matrix[i][i], matrix[i][j], matrix[j][j]
    u = algebra.dot((sine, cosine), (p - s, q + q))
    across = times(sine, u)
    rows[i][i], rows[j][j] = p - across, s + across
    rows[i][j] = rows[j][i] = times(cosine, u) - q
    column = [algebra.zero] * 3
    column[i], column[j] = matrix[i][a], matrix[j][a]
    swung = turn.back(Vector(algebra, (column[0], column[1], column[2]), turn.frame))
    for k in (i, j):
        rows[k][a] = rows[a][k] = swung[k]
    return tensor_of(algebra, rows, turn.source)


def _regrouped(
    algebra: Algebra[S],
    frames: list[Frame[S]],
    properties: Mapping[int, MassProperties[S]],
    welded_frames: frozenset[int],
) -> tuple[MassProperties[S], ...]:
    """Mass properties frame by frame after moving to the parents what the joints do not feel;
    ``welded_frames`` move nothing."""
    masses = [properties.get(number) or nothing(algebra, frame.name) for number, frame in enumerate(frames)]
    for number in reversed(range(len(frames))):
        if number in welded_frames:
            continue
        frame, own = frames[number], masses[number]
        stays, leaves = split(algebra, frame, own)
        masses[number] = stays
        if frame.parent >= 0:
            leaves = turned_back(algebra, leaves, frame)
            if frame.fixed_offset:  # else it is a pure tensor, or nothing at all
                leaves = shifted(algebra, leaves, frame.offset)
            masses[frame.parent] = total(masses[frame.parent], leaves)
    return tuple(masses)


def split(algebra: Algebra[S], frame: Frame[S], own: MassProperties[S]) -> tuple[MassProperties[S], MassProperties[S]]:
    """What stays on a frame, and what may move to its parent; their sum is ``own``."""
    none = nothing(algebra, frame.name)
    if frame.together:  # the joint is solved as a whole, with all that it moves on the last of its frames
        return own, none
    if frame.fixed_turn and frame.fixed_offset:
        return none, own
    if frame.fixed_turn:
        stays = MassProperties(own.mass, own.first_moment, none.tensor)
        return stays, MassProperties(algebra.zero, none.first_moment, own.tensor)
    if not frame.fixed_offset:
        return own, none
    assert frame.turn is not None
    axis, across = frame.turn.axis, list(own.first_moment)
    along = axis_vector(algebra, axis, across[axis - 1], frame.name)
    across[axis - 1] = algebra.zero
    stays = MassProperties(algebra.zero, Vector(algebra, (across[0], across[1], across[2]), frame.name), own.tensor)
    return stays, MassProperties(own.mass, along, none.tensor)
