"""The scalar rows of constraints over any scalar.

    position      f(q, t)                                     of a holonomic constraint, else None
    velocity      g = J q' + j      = df/dt  where there is an f
    acceleration  dg/dt = J q'' + (J' q' + j')                at the accelerations of the scene: in one without
                                                              accelerations the part J' q' + j'
    partials      J, the derivatives of g by the velocities

Rates come from the recursion of ``seen.py``, J from the same recursion along each coordinate: closed formulas are not
differentiated (expressions of the description are, as they stand).  Vectors are seen from the last frame that carries
both bodies, and in its axes:

    coincide   r_1 - r_2
    parallel   n_1 . e_2, n_2 . e_2   with n_1, n_2 normal to e_1 and fixed in the first body
    distance   (|r_1 - r_2|^2 - L^2)/2
    rolling    V_body + omega_body x (c - r_body) - V_on - omega_on x (c - r_on)      c: the contact

The rate of the last one takes the motion of the contact into account, which is the same in both terms.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from typing import Any

from mbsym.algebra.base import Algebra, Scalar
from mbsym.algebra.remembered import remembered
from mbsym.algebra.ring import Ring
from mbsym.algebra.vectors import Vector
from mbsym.expressions.message import Message
from mbsym.expressions.place import Span
from mbsym.expressions.tree import ZERO, Expression, differentiate, names, negative, subtract
from mbsym.mechanics.constraints.seen import Moving, Rates, View, along_coordinate, along_motion, common_frame
from mbsym.mechanics.kinematics import Scene
from mbsym.model.constraints import (
    Axis,
    Coincide,
    Constraint,
    Distance,
    Parallel,
    Relation,
    Rolling,
    Velocity,
    is_holonomic,
    kind_name,
)
from mbsym.model.system import INERTIAL, Point, rational, velocity_name
from mbsym.model.system import Vector as Expressions


@dataclass(frozen=True, slots=True)
class RowName:
    """Which row this is: ``constraint`` counts from 0, ``component`` from 1 (0: the constraint has one row)."""

    constraint: int
    component: int
    kind: str
    holonomic: bool
    span: Span | None = None

    @property
    def label(self) -> Message:
        """``coincide 1, component 2``: the second row of the first constraint of the description."""
        kind, number = Message(self.kind), self.constraint + 1
        if not self.component:
            return Message("[[kind]] [[number]]", kind=kind, number=number)
        return Message("[[kind]] [[number]], component [[k]]", kind=kind, number=number, k=self.component)


@dataclass(frozen=True, slots=True)
class Row:
    """One scalar constraint; see the module."""

    name: RowName
    position: Scalar | None
    velocity: Scalar
    acceleration: Scalar
    partials: tuple[Scalar, ...]

    def is_trivial(self, algebra: Algebra) -> bool:
        """Whether it says 0 = 0 as it stands; only over the ring that is decided."""
        scalars = (self.velocity, self.acceleration, *self.partials)
        return (self.position is None or algebra.vanishes(self.position)) and all(map(algebra.vanishes, scalars))


@dataclass(frozen=True, slots=True)
class _Form:
    """f, g and dg/dt of one row."""

    position: Scalar | None
    velocity: Scalar
    acceleration: Scalar


def constraint_rows(scene: Scene, selected: Sequence[tuple[int, int]] | None = None) -> tuple[Row, ...]:
    """The rows of all constraints of a system, in the order of the description.

    ``selected`` names rows by (constraint, component), the others are left out; ``kept_rows`` finds those that say
    something.
    """
    rows = []
    for number, constraint in enumerate(scene.system.constraints):
        forms = _forms(scene, constraint, along_motion(scene))
        components = [
            k for k in range(len(forms)) if selected is None or (number, k + 1 if len(forms) > 1 else 0) in selected
        ]
        if not components:
            continue
        moved = _moved_by(scene, constraint)
        slopes = [
            _forms(scene, constraint, along_coordinate(scene, name), name) if name in moved else None
            for name in scene.system.coordinates
        ]
        labels = row_names(number, constraint)
        for k in components:
            partials = tuple(
                scene.algebra.zero if slope is None else scene.algebra.reduce(slope[k].velocity) for slope in slopes
            )
            reduce, form = scene.algebra.reduce, forms[k]
            position = None if form.position is None else reduce(form.position)
            rows.append(Row(labels[k], position, reduce(form.velocity), reduce(form.acceleration), partials))
    return tuple(rows)


def row_names(number: int, constraint: Constraint) -> tuple[RowName, ...]:
    """The names of all rows of the constraint of this number."""
    match constraint:
        case Coincide() | Rolling():
            components: Sequence[int] = (1, 2, 3)
        case Parallel():
            components = (1, 2)
        case _:
            components = (0,)
    kind, holonomic = kind_name(constraint), is_holonomic(constraint)
    return tuple(RowName(number, k, kind, holonomic, constraint.span) for k in components)


def _moved_by(scene: Scene, constraint: Constraint) -> set[str]:
    """The coordinates that may move the ends of a constraint: those in its expressions, and in the joints below it."""
    match constraint:
        case Coincide(first, second) | Distance(first, second):
            ends, own = [first.body, second.body], [*first.position, *second.position]
            if isinstance(constraint, Distance):
                own.append(constraint.length)
        case Parallel(first, second):
            ends, own = [first.body, second.body], [*first.direction, *second.direction]
        case Rolling():
            ends, own = [constraint.body, constraint.on, constraint.axes], [*constraint.contact]
        case _:
            return {*scene.system.coordinates}
    for end in ends:
        while end != INERTIAL:
            body = scene.system.body(end)
            own += [*body.connection_point, *body.rotation.angles, *(body.relative_velocity or ())]
            end = body.attached_to
    return {name for x in own for name in names(x)}


@remembered
def said_rows(scene: Scene) -> tuple[Row, ...]:
    """The rows over the ring without those that say 0 = 0 whatever the motion; found once in a scene."""
    return tuple(row for row in constraint_rows(scene) if not row.is_trivial(scene.algebra))


def joined_rows(ring: Ring, rows: Sequence[Row]) -> tuple[Row, ...]:
    """With sum c_k g_k / C in place of velocity rows  g_k = c_k g,  where  C = sum c_k^2  is a number other than 0.

    g_1 = g_2 = ... = 0 says no more than g = 0 and, unlike each of them, no less anywhere: a wheel in a plane has the
    rows -g sin(p) and g cos(p) along fixed axes.
    """
    joined: list[Row] = []
    groups: dict[Any, list[tuple[Row, Any]]] = {}
    for row in rows:
        common: Any = reduce(lambda x, y: x.gcd(y), [x for x in (row.velocity, *row.partials) if x != 0])
        alone = row.position is not None or common.is_constant()
        g = row.velocity / common
        common = common * g.leading_coefficient() if not alone else common
        key = row.name if alone else (row.name.constraint, str(g / g.leading_coefficient()))
        groups.setdefault(key, []).append((row, common))
    for members in groups.values():
        total = ring.reduce(sum((c * c for _, c in members), ring.zero))
        if len(members) == 1 or not total.is_constant():
            joined += [row for row, _ in members]
            continue
        scale = 1 / total.leading_coefficient()

        def mixed(parts: Iterable[Any], of: list[tuple[Row, Any]] = members, scale: Any = scale) -> Any:
            return ring.reduce(sum((c * x for (_, c), x in zip(of, parts, strict=True)), ring.zero) * scale)

        velocity, acceleration = (mixed(getattr(row, x) for row, _ in members) for x in ("velocity", "acceleration"))
        partials = tuple(mixed(parts) for parts in zip(*(row.partials for row, _ in members), strict=True))
        joined.append(Row(members[0][0].name, None, velocity, acceleration, partials))
    return tuple(joined)


def kept_rows(rows: Sequence[Row]) -> tuple[tuple[int, int], ...]:
    """How ``constraint_rows`` knows these rows in another algebra."""
    return tuple((row.name.constraint, row.name.component) for row in rows)


def _forms(scene: Scene, constraint: Constraint, rates: Rates, along: str | None = None) -> list[_Form]:
    """The rows of one constraint; with ``along`` the derivatives of g by the velocity of that coordinate, as g."""
    match constraint:
        case Coincide(first, second):
            return _coincide(scene, first, second, rates)
        case Parallel(first, second):
            return _parallel(scene, first, second, rates)
        case Distance(first, second, length):
            return [_distance(scene, first, second, length, rates)]
        case Relation(left, right):
            f = difference(left, right)
            return [_Form(scene.lower(f), rates.first(f), rates.second(f))]
        case Rolling():
            return _rolling(scene, constraint, rates)
        case Velocity(left, right):
            return [_velocity(scene, difference(left, right), along)]
    raise TypeError(f"not a constraint: {constraint!r}")


def difference(left: Expression, right: Expression) -> Expression:
    """left - right, short where one side is 0."""
    return negative(right) if left == ZERO else subtract(left, right)


def _pair(scene: Scene, first: Point, second: Point, rates: Rates) -> Moving:
    """r_1 - r_2 as seen from the last frame that carries both."""
    view = View(scene, common_frame(scene, (first.body, second.body)), rates)
    ends = [view.point(view.moving(x.position, x.body)) for x in (first, second)]
    return ends[0] - ends[1]


def _coincide(scene: Scene, first: Point, second: Point, rates: Rates) -> list[_Form]:
    apart = _pair(scene, first, second, rates)
    return [_Form(*x) for x in zip(apart.value, apart.first, apart.second, strict=True)]


def _distance(scene: Scene, first: Point, second: Point, length: Expression, rates: Rates) -> _Form:
    algebra, apart = scene.algebra, _pair(scene, first, second, rates)
    long, rate, second_rate = scene.lower(length), rates.first(length), rates.second(length)
    half = algebra.number(Fraction(1, 2))
    squares = apart.value.dot(apart.value) - algebra.times(long, long)
    speed = apart.value.dot(apart.first) - algebra.times(long, rate)
    bent = apart.first.dot(apart.first) + apart.value.dot(apart.second)
    bent = bent - algebra.times(rate, rate) - algebra.times(long, second_rate)
    return _Form(algebra.times(half, squares), speed, bent)


def _parallel(scene: Scene, first: Axis, second: Axis, rates: Rates) -> list[_Form]:
    algebra = scene.algebra
    view = View(scene, common_frame(scene, (first.body, second.body)), rates)
    other = view.vector(view.moving(second.direction, second.body))
    forms = []
    for normal in normals(first.direction):
        n = view.vector(view.moving(normal, first.body))
        forms.append(
            _Form(
                n.value.dot(other.value),
                n.first.dot(other.value) + n.value.dot(other.first),
                n.second.dot(other.value)
                + algebra.times(algebra.number(2), n.first.dot(other.first))
                + n.value.dot(other.second),
            )
        )
    return forms


def normals(e: Expressions) -> tuple[Expressions, Expressions]:
    """Two independent vectors normal to e: with e_i not 0,  e_i e_j - e_j e_i  for the other two axes j.

    A component that is a number other than 0 is taken for e_i, else the first one that is not written as 0.
    """
    numbers = [rational(x) for x in e]
    certain = [i for i in range(3) if numbers[i]]
    possible = [i for i in range(3) if numbers[i] is None]
    i = (certain or possible or [2])[0]
    vectors = []
    for j in ((i + 1) % 3, (i + 2) % 3):
        normal: list[Expression] = [ZERO, ZERO, ZERO]
        normal[j], normal[i] = e[i], negative(e[j])
        vectors.append((normal[0], normal[1], normal[2]))
    return vectors[0], vectors[1]


def _rolling(scene: Scene, rolling: Rolling, rates: Rates) -> list[_Form]:
    view = View(scene, common_frame(scene, (rolling.body, rolling.on, rolling.axes)), rates)
    centre = view.point(view.fixed(scene.zero(rolling.body)))
    arm = view.vector(view.moving(rolling.contact, rolling.axes))
    body = _material(centre, view.spin(rolling.body), arm, rates)
    base = view.point(view.fixed(scene.zero(rolling.on)))
    carrier = _material(base, view.spin(rolling.on), centre + arm - base, rates)
    speeds, rates_of_speeds = body[0] - carrier[0], body[1] - carrier[1]
    return [_Form(None, *x) for x in zip(speeds, rates_of_speeds, strict=True)]


def _material(origin: Moving, spin: Moving, arm: Moving, rates: Rates) -> tuple[Vector, Vector]:
    """V_O + omega x c of the material point at a contact c that moves in its body, and the rate of that."""
    speed = origin.first + spin.value.cross(arm.value)
    if not rates.bent:
        return speed, origin.second
    swung = spin.first.cross(arm.value) + spin.value.cross(arm.first)
    return speed, origin.second + swung


def _velocity(scene: Scene, g: Expression, along: str | None) -> _Form:
    if along is None:
        return _Form(None, scene.lower(g), scene.lower(scene.rate(g)))
    speed = velocity_name(along)
    slope = scene.lower(differentiate(g, speed)) if speed in names(g) else scene.algebra.zero
    return _Form(None, slope, scene.algebra.zero)
