"""Is a system the same in every direction of space, and is its unperturbed motion a steady spin?

If everything hangs on one body whose three angles alone say how the whole stands in space, and no load knows them, the
equations of motion do not change when the whole is turned about the fixed point.  A steady spin at the rate omega about
the first axis of that body, turned in space, is then a motion again; in angles that turn with the spin it moves with
the frequency omega, so that lambda^2 + omega^2 divides the characteristic determinant of the first approximation.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import combinations

from mbsym.algebra.failures import NOT_THERE
from mbsym.algebra.matrices import adjugate, components, determinant
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.vectors import axis_vector
from mbsym.expressions.angles import angle_name
from mbsym.expressions.tree import ZERO, Expression, names
from mbsym.mechanics.motion import motion_values
from mbsym.mechanics.rest import Rest
from mbsym.mechanics.variables import expressions
from mbsym.model.loads import (
    Load,
)
from mbsym.model.system import INERTIAL, Body, System, velocity_name


@dataclass(frozen=True)
class Spin:
    """The steady spin of the angle ``coordinate`` at ``rate``; ``tilts`` are the two angles that follow it."""

    coordinate: str
    tilts: tuple[str, str]
    rate: Expression


def free_spin(system: System, still: bool = False) -> Spin | None:
    """The spin of a system that is the same in every direction of space, or None where there is none.

    With ``still`` one of rate 0, too: a despun platform that carries rotors stands in any direction.
    """
    roots = [body for body in system.bodies if body.attached_to == INERTIAL]
    angles = _attitude(roots[0]) if len(roots) == 1 else None
    if angles is None or not _same_in_every_direction(system, roots[0], angles):
        return None
    motion = motion_values(system)
    first, second, third = angles
    if (motion[first][1] == ZERO and not still) or any(motion[name][1] != ZERO for name in (second, third)):
        return None
    return Spin(first, (second, third), motion[first][1])


def is_free_about_the_origin(system: System) -> bool:
    """Whether the whole may be turned about the inertial origin in any way: its angular momentum there is constant.

    (Noether: three rotations that leave L unchanged, and no load without a force function has a moment from outside.)
    """
    roots = [body for body in system.bodies if body.attached_to == INERTIAL]
    angles = _attitude(roots[0]) if len(roots) == 1 else None
    if angles is None or any(x != ZERO for x in roots[0].connection_point):
        return False
    return roots[0].relative_velocity is None and _same_in_every_direction(system, roots[0], angles)


def _attitude(body: Body) -> tuple[str, str, str] | None:
    """The three coordinates that turn a body in space, if its joint is made of them."""
    axes = body.rotation.axes
    coordinates = [angle_name(angle) for angle in body.rotation.angles]
    turns_freely = len(axes) == 3 and axes[0] != axes[1] != axes[2]
    if (
        not turns_freely
        or None in coordinates
        or len(set(coordinates)) != 3
        or not {*coordinates} <= {*body.coordinates}
    ):
        return None
    return (str(coordinates[0]), str(coordinates[1]), str(coordinates[2]))


def _same_in_every_direction(system: System, root: Body, angles: Sequence[str]) -> bool:
    """Whether the attitude of the root occurs in its rotation alone and no load prefers a direction or a place."""
    hidden = {*angles, *map(velocity_name, angles)}
    moving = {*system.coordinates, *(item.name for item in system.prescribed), "t"}
    place = [root.connection_point, root.relative_velocity]
    others = [body for body in system.bodies if body is not root]
    if any(moving & names(x) for x in expressions(tuple(x for x in place if x is not None))):
        return False
    if any(hidden & names(x) for part in (*others, *system.loads) for x in expressions(part)):
        return False
    return all(_is_internal(load, hidden) for load in system.loads)


def _is_internal(load: Load, hidden: set[str]) -> bool:
    """Whether it knows no direction in space, and none of the hidden names."""
    return load.bodies is not None and INERTIAL not in load.bodies and not hidden & {*load.coordinates}


# Polar coordinates: the same places of all bodies at r, theta and at -r, theta + pi.
#
# A length r along a direction that an angle theta turns is a polar coordinate: theta moves nothing at r = 0, where M(q)
# is singular, and the states with r < 0 lie beyond that singularity.  With the reflection
#
#     s:  r -> -r,  theta -> theta + pi,  r' -> -r'
#
# they are states with r > 0 described a second time if s leaves the equations of motion as they are
# (f_r -> -f_r, f_i -> f_i).  Where it does not, as with the spring law k (r - l0), bodies at the same places would feel
# other forces: a description with r < 0 is not the system that is meant.


@dataclass(frozen=True)
class Reflection:
    """``length`` and ``angle`` are polar coordinates, or two spherical angles, of which the first may be negated.

    ``same_forces``: the equations of motion do not change.
    """

    length: str
    angle: str
    same_forces: bool


def reflections(rest: Rest) -> tuple[Reflection, ...]:
    """The pairs of polar coordinates of a system, proved in the ring; a length that belongs to two angles once.

    So are pairs of angles where nothing changes at -theta, psi + pi.
    """
    ring, names = rest.ring, rest.system.coordinates
    angles = [x for x in names if ring.angles.get(x) == 1]
    made = []
    for length in rest.constant:
        if length in ring.angles and length not in angles:
            continue
        for angle in angles:
            try:
                if angle != length and _moves_nothing(rest, length, angle) and _same_places(rest, length, angle):
                    found = Reflection(length, angle, _same_forces(rest, length, angle))
                    if found.same_forces or length not in angles:
                        made.append(found)
                        break
            except NOT_THERE:
                continue
    return tuple(made)


def odd_in(ring: Ring, length: str) -> list[tuple[str, str]]:
    """The generators, by kind and name, that change their sign with a length, or with an angle in its place."""
    return [(kind, length) for kind in ("coordinate", "velocity", "sine") if ring.has(kind, length)]


def reflected(rest: Rest, x: Polynomial, length: str, angle: str) -> Polynomial:
    """x at -r, theta + pi, -r'."""
    ring = rest.ring
    places = (*odd_in(ring, length), ("sine", angle), ("cosine", angle))
    return ring.substitute(x, {ring.index(*place): -ring.generator(*place) for place in places})


def _moves_nothing(rest: Rest, length: str, angle: str) -> bool:
    """Whether the row of ``angle`` in the mass matrix vanishes where the length does, and not everywhere."""
    ring = rest.ring
    row = rest.mass_matrix()[rest.system.coordinates.index(angle)]
    zero = {ring.index(*place): ring.zero for place in odd_in(ring, length)}
    if length in ring.angles:
        zero[ring.index("cosine", length)] = ring.one
    return all(ring.substitute(x, dict(zero)).is_zero() for x in row) and any(not x.is_zero() for x in row)


def _same_places(rest: Rest, length: str, angle: str) -> bool:
    """Whether no mass centre moves in the reflection, and no body that has an inertia turns."""
    ring, scene = rest.ring, rest.scene
    for body in rest.system.bodies:
        motion = scene.motions[body.name]
        if motion.mass == 0 and motion.inertia is None:
            continue
        seen = list(scene.position(motion.mass_centre, INERTIAL))
        if motion.inertia is not None:
            axes = [axis_vector(ring, k, ring.one, body.name) for k in (1, 2)]
            seen += [x for axis in axes for x in scene.to_axes(axis, INERTIAL)]
        if any(ring.is_zero(reflected(rest, x, length, angle) - x) is not True for x in seen):
            return False
    return True


def _same_forces(rest: Rest, length: str, angle: str) -> bool:
    signs = {length: -1}
    ring = rest.ring
    return all(
        ring.is_zero(reflected(rest, f, length, angle) - signs.get(name, 1) * f) is True
        for name, f in zip(rest.system.coordinates, rest.forcing, strict=True)
    )


#: Kinetic energies of more coordinates, or of more terms, are not asked for their curvature.
MOST_CURVED, MOST_CURVED_TERMS = 6, 200


def constantly_curved(
    ring: Ring,
    metric: Sequence[Sequence[Polynomial]],
    derivative: Callable[[Polynomial, int], Polynomial],
    vanishes: Callable[[Polynomial], bool] | None = None,
) -> bool:
    """Whether T = g_ij q'_i q'_j/2 is the same at every position, as of a plane, a sphere, or one beside the other:

        R_ijkl = c (g_ik g_jl - g_il g_jk),    c constant,    in each part of T that knows no coordinates of others,

    R_ijkl of the derivatives of g and of the Christoffel symbols [ij, k].  Then displacements that change no equation
    lead to every position near by.  One coordinate is always such (it is a function of the length of its path).
    ``derivative(x, i)``: by coordinate i, whatever the formulas hold; ``vanishes``: on the positions that are possible.
    """
    zero, size = vanishes or ring.vanishes, range(len(metric))
    if len(size) == 1:
        return True
    if len(size) > MOST_CURVED or sum(len(x) for row in metric for x in row) > MOST_CURVED_TERMS:
        return False
    slopes = [[[derivative(x, i) for x in row] for row in metric] for i in size]

    def coupled(i: int, j: int) -> bool:
        return not all(map(zero, (metric[i][j], *slopes[i][j], *slopes[j][i])))

    parts = components(len(metric), coupled)
    if len(parts) > 1:
        return all(
            constantly_curved(
                ring,
                [[metric[i][j] for j in part] for i in part],
                lambda x, i, part=part: derivative(x, part[i]),  # type: ignore[misc]
                vanishes,
            )
            for part in parts
        )
    bends = [[[[derivative(x, i) for x in row] for row in slope] for slope in slopes] for i in size]
    symbols = [[[(slopes[i][j][k] + slopes[j][i][k] - slopes[k][i][j]) / 2 for k in size] for j in size] for i in size]
    whole = determinant(ring, metric)
    inverse = adjugate(metric, partial(determinant, ring))  # times det g

    def curvature(i: int, j: int, k: int, l: int) -> Polynomial:
        """R_ijkl det g."""
        second = bends[j][k][i][l] + bends[i][l][j][k] - bends[i][k][j][l] - bends[j][l][i][k]
        total = ring.times(whole, second / 2)
        for m in size:
            for n in size:
                square = ring.times(symbols[j][k][m], symbols[i][l][n]) - ring.times(symbols[j][l][m], symbols[i][k][n])
                total = total + ring.times(inverse[m][n], square)
        return ring.reduce(total)

    def area(i: int, j: int, k: int, l: int) -> Polynomial:
        return ring.reduce(ring.times(metric[i][k], metric[j][l]) - ring.times(metric[i][l], metric[j][k]))

    def same(a: Polynomial, b: Polynomial, c: Polynomial, d: Polynomial) -> bool:
        """Whether a/b = c/d."""
        return zero(ring.reduce(ring.times(a, d) - ring.times(c, b)))

    top, bottom = curvature(0, 1, 0, 1), area(0, 1, 0, 1)
    pairs = list(combinations(size, 2))
    if not all(same(curvature(*one, *other), area(*one, *other), top, bottom) for one in pairs for other in pairs):
        return False
    scale = ring.times(whole, bottom)  # c = top/scale
    return all(same(derivative(top, i), derivative(scale, i), top, scale) for i in size)
