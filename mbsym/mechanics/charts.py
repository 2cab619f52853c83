"""Where rotation angles are singular, and other angles that are regular there.

Three turns {a1, a2, a3} cannot tell orientations apart where the third axis of turning falls on the first:
cos x2 = 0 for three different axes, sin x2 = 0 for {a, b, a}.  There body axis a3 lies along the previous body's axis
a1.  The sequence {a2, a1, a3}, respectively {b, c, a}, is singular elsewhere, so the two together cover every
orientation: the first where it is regular, the second only where body axis a3 lies along axis a1.

Where the first angle runs at a constant rate (a spin about an axis fixed in the previous body), it has to stay the
first: {a1, a3, a2}, respectively {a1, a2, c}, is regular there, and what the body sees of axis a1 is the configuration.
The same holds for a first angle that the equations do not know (cyclic: the whole may be turned about axis a1), and a
cyclic third angle is like one that runs: only the direction of its axis is a configuration.

Two turns {a1, a2} of a body without twist (a thin rod, a point mass: nothing depends on a turn about a body axis g) are
the same with the third turn left out; only the direction of g matters then.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from itertools import pairwise, product
from typing import Any

from mbsym.algebra.failures import Failure
from mbsym.algebra.ring import Polynomial
from mbsym.algebra.vectors import axis_vector, zero_vector
from mbsym.expressions.angles import LinearForm, linear_form
from mbsym.expressions.tree import Name, names
from mbsym.mechanics.frames import back, direction_cosines, forward
from mbsym.mechanics.rest import Rest, rest
from mbsym.mechanics.variables import expressions
from mbsym.model.system import Body, Rotation, System, velocity_name

#: No more joints than this are described in two ways: every one doubles the number of charts.
MOST_JOINTS = 4


@dataclass(frozen=True)
class Joint:
    """A joint whose angles can be replaced: ``axes`` a1, a2, a3; ``angles`` the two or three coordinates.

    The turns are through ``signs`` times the coordinates, plus constants.
    ``last_free``: only the direction of body axis a3 matters (no third turn, one at a constant rate, a cyclic one).
    ``first_free``: only the direction of axis a1 in the body matters (a first turn at a constant rate, a cyclic one).
    ``keeps_first``: the angles that replace these begin with the same turn.
    ``described``: the axes are those of the description.
    """

    body: str
    axes: tuple[int, int, int]
    angles: tuple[str, ...]
    signs: tuple[int, ...]
    first_free: bool
    last_free: bool
    keeps_first: bool
    described: bool = True

    @property
    def proper(self) -> bool:
        """Three turns about different axes (the other kind repeats the first)."""
        return self.axes[0] != self.axes[2]

    @property
    def other_axes(self) -> tuple[int, int, int]:
        first, second, third = self.axes
        if self.keeps_first:
            return (first, third, second) if self.proper else (first, second, 6 - first - second)
        if self.proper:
            return second, first, third
        return second, 6 - first - second, third


@dataclass(frozen=True)
class Chart:
    """One description of the configurations: the system with some joints' angles replaced.

    Only configurations with ``nonzero`` != 0 and ``restrictions`` = 0 are to be looked for in it, so that the charts of
    a system have no configuration in common.
    """

    rest: Rest
    joints: tuple[Joint, ...]
    replaced: tuple[bool, ...]
    nonzero: tuple[Polynomial, ...]
    restrictions: tuple[Polynomial, ...]

    @property
    def label(self) -> str:
        """``satellite {3, 2, 1}`` for each joint with other axes than the description's."""
        parts = []
        for joint, other in zip(self.joints, self.replaced, strict=True):
            if other or not joint.described:
                axes = (joint.other_axes if other else joint.axes)[: len(joint.angles)]
                parts.append(f"{joint.body} {{{', '.join(map(str, axes))}}}")
        return ", ".join(parts)


def joints(system: System, turning: Sequence[str], cyclic: Sequence[str] = ()) -> tuple[Joint, ...]:
    """The joints whose angles occur nowhere else, so that they may be replaced by others.

    ``turning`` are the coordinates that run at a constant rate, ``cyclic`` those that the equations do not know.
    """
    replaceable = []
    for body in system.bodies:
        turns = list(body.rotation.turns())
        forms = [linear_form(angle) for _, angle in turns]
        read = [x for x in map(_coordinate, forms) if x is not None and x[0] in system.coordinates]
        angles, signs = tuple(name for name, _ in read), tuple(sign for _, sign in read)
        axes = [axis for axis, _ in turns]
        distinct = len(set(angles)) == len(turns) and all(a != b for a, b in pairwise(axes))
        if len(turns) not in (2, 3) or not distinct:
            continue
        steady = [name in turning for name in angles]
        # A first turn that runs has to stay the first; then no third one can stay the third.
        if steady[1] or (steady[0] and steady != [True, False, False]) or _used_elsewhere(system, body, angles):
            continue
        free = steady[0] or angles[0] in cyclic
        if len(turns) == 3:
            last = steady[2] or angles[2] in cyclic
            keeps_first = steady[0] or (free and not last)
            replaceable.append(Joint(body.name, (axes[0], axes[1], axes[2]), angles, signs, free, last, keeps_first))
            continue
        for third in (6 - axes[0] - axes[1], axes[0]):
            if _has_no_twist(system, body, third):
                replaceable.append(Joint(body.name, (axes[0], axes[1], third), angles, signs, free, True, False))
                break
    return tuple(replaceable[:MOST_JOINTS])


def _coordinate(form: LinearForm | None) -> tuple[str, int] | None:
    """(name, sign) of an angle +-x + k pi."""
    if form is None or form.constant or len(form.coefficients) != 1 or abs(form.coefficients[0][1]) != 1:
        return None
    name, sign = form.coefficients[0]
    return name, int(sign)


def cyclic_angles(equations: Rest) -> tuple[str, ...]:
    """The constant coordinates that occur neither in f(q, q', t) nor in M(q), nor in constraints: any value will do."""
    ring = equations.ring
    known = [*equations.forcing, *equations.kept, *(x for row in equations.rows for x in row.partials)]
    open_ = [x for x in equations.constant if not any(ring.depends_on(f, x) for f in known)]
    if not open_:
        return ()
    mass = [x for row in equations.mass_matrix() for x in row]
    return tuple(name for name in open_ if not any(ring.depends_on(x, name) for x in mass))


def _used_elsewhere(system: System, body: Body, angles: Sequence[str]) -> bool:
    """Whether an angle or its velocity is named anywhere but in the rotation of its body."""
    watched = {*angles, *map(velocity_name, angles)}
    others = [replace(x, rotation=Rotation()) if x is body else x for x in system.bodies]
    parts = (tuple(others), system.loads, system.prescribed, system.constraints)
    in_formulas = any(names(x) & watched for x in expressions(parts))
    return in_formulas or any(word in watched for word in _words((system.loads, system.constraints)))


def _words(part: Any) -> list[str]:
    """The texts that a part of a system holds, names of coordinates among them."""
    if isinstance(part, str):
        return [part]
    if isinstance(part, tuple):
        return [word for item in part for word in _words(item)]
    if is_dataclass(part) and not isinstance(part, (type, Name)):
        return [w for item in fields(part) if item.name != "span" for w in _words(getattr(part, item.name))]
    return []


def _has_no_twist(system: System, body: Body, axis: int) -> bool:
    """Whether a further turn of the body about one of its axes changes neither T nor any force: proved in the ring."""
    extra = "twist"
    while extra in system.coordinates or any(extra in names(x) for x in expressions(system)):
        extra += "_"
    rotation = Rotation((*body.rotation.axes, axis), (*body.rotation.angles, Name(extra)))
    turned = replace(body, rotation=rotation, coordinates=(*body.coordinates, extra))
    wider = replace(system, bodies=tuple(turned if x is body else x for x in system.bodies))
    try:
        equations = rest(wider)
        place = wider.coordinates.index(extra)
        # A force fixed in the body does no work in the twist, but it turns with it.
        known = [*equations.forcing, *equations.kept, *(x for row in equations.rows for x in row.partials)]
        if not equations.forcing[place].is_zero() or any(equations.ring.dependencies(f, (extra,)) for f in known):
            return False
        if any(not row.partials[place].is_zero() for row in equations.rows):
            return False
        row = equations.mass_matrix()[place]
    except Failure:
        return False
    return all(x.is_zero() for x in row)


def charts(first: Rest, described_by: System | None = None) -> tuple[Chart, ...]:
    """Charts that together cover every configuration once (but for what cannot be replaced).

    ``described_by``: the description, where the system has other axes of turning than that.
    """
    described = {body.name: body.rotation.axes for body in (described_by or first.system).bodies}
    first = _with_cyclic_first_angles(first)
    replaceable = tuple(
        replace(joint, described=described[joint.body][: len(joint.angles)] == joint.axes[: len(joint.angles)])
        for joint in joints(first.system, first.turning, cyclic_angles(first))
    )
    atlas = []
    for choice in product((False, True), repeat=len(replaceable)):
        current = rest(_with_other_angles(first.system, replaceable, choice)) if any(choice) else first
        nonzero: list[Polynomial] = []
        restrictions: list[Polynomial] = []
        for joint, other in zip(replaceable, choice, strict=True):
            if other:
                seen = rows(current, joint)
                across = [k for k in (0, 1, 2) if k != (joint.axes[2] if joint.keeps_first else joint.axes[0]) - 1]
                first_axis, last_axis = joint.axes[0] - 1, joint.axes[2] - 1
                restrictions += [seen[k][first_axis] if joint.keeps_first else seen[last_axis][k] for k in across]
            else:
                # What vanishes where the angles are singular: cos x2 for three different axes, else sin x2.
                turn = current.scene.motions[joint.body].turns[1]
                nonzero.append(turn.cosine if joint.proper else turn.sine)
        atlas.append(Chart(current, replaceable, choice, tuple(nonzero), tuple(restrictions)))
    return tuple(atlas)


def _with_cyclic_first_angles(first: Rest) -> Rest:
    """The same with other sequences of resting angles, where their first angle is then cyclic.

    A body that may be turned about an axis of the previous one has steady motions one by one only up to that turn.
    """
    for joint in joints(first.system, first.turning, cyclic_angles(first)):
        if joint.first_free or {*joint.angles} & {*first.turning}:
            continue
        last = joint.axes[2]
        for axis in (x for x in (1, 2, 3) if x != joint.axes[0]):
            second = next(x for x in (1, 2, 3) if x not in (axis, last))
            try:
                other = rest(_with_axes(first.system, {joint.body: (axis, second, last)[: len(joint.angles)]}))
            except Failure:
                continue
            if joint.angles[0] in cyclic_angles(other):
                first = other
                break
    return first


def with_cyclic_last_angles(first: Rest) -> tuple[Rest, tuple[tuple[str, int], ...]]:
    """The same with sequences of three angles whose last one is cyclic, where a body has an axis of symmetry.

    Also (body, axis) of each body whose sequence was changed: a turn of it about that axis changes neither f nor M.
    What is a family of rests in other angles is then a rest with any last angle.
    """
    changed: list[tuple[str, int]] = []
    for joint in joints(first.system, first.turning, cyclic_angles(first)):
        if len(joint.angles) != 3 or joint.last_free or {*joint.angles} & {*first.turning}:
            continue
        for last in (1, 2, 3):
            second = next(x for x in (1, 2, 3) if x not in (joint.axes[0], last))
            axes = (joint.axes[0], second, last)
            if axes == joint.axes:
                continue
            try:
                other = rest(_with_axes(first.system, {joint.body: axes}))
            except Failure:
                continue
            if joint.angles[2] in cyclic_angles(other):
                first = other
                changed.append((joint.body, last))
                break
    return first, tuple(changed)


def _with_other_angles(system: System, replaceable: Sequence[Joint], choice: Sequence[bool]) -> System:
    chosen = [joint for joint, other in zip(replaceable, choice, strict=True) if other]
    return _with_axes(system, {joint.body: joint.other_axes[: len(joint.angles)] for joint in chosen})


def _with_axes(system: System, changed: Mapping[str, tuple[int, ...]]) -> System:
    """The system with other axes of turning for some bodies, and the same angles."""
    bodies = (
        replace(x, rotation=Rotation(changed[x.name], tuple(angle for _, angle in x.rotation.turns())))
        if x.name in changed
        else x
        for x in system.bodies
    )
    return replace(system, bodies=tuple(bodies))


def rows(equations: Rest, joint: Joint) -> tuple[tuple[Polynomial, ...], ...]:
    """The body's axes in components of the previous body: the rows of R."""
    motion = equations.scene.motions[joint.body]
    return direction_cosines(equations.ring, motion.turns, motion.body.attached_to, joint.body).rows


def features(equations: Rest, joint: Joint) -> tuple[Polynomial, ...]:
    """Direction cosines that tell the joint's steady configurations apart, whatever the angles."""
    seen = rows(equations, joint)
    selected = [seen[joint.axes[2] - 1]] if joint.last_free else list(seen)
    return tuple(x for row in selected for x in (row[joint.axes[0] - 1 : joint.axes[0]] if joint.first_free else row))


def moments(equations: Rest, joint: Joint) -> tuple[Polynomial, ...]:
    """The components of ``moment_components`` that there are, in the axes of the body and in those of the previous one.

    They vanish with f where the angles are regular: they say nothing that f does not say, only more shortly.
    """
    return tuple(x for part in moment_components(equations, joint) for x in part if x is not None)


def moment_components(equations: Rest, joint: Joint) -> tuple[tuple[Polynomial | None, ...], ...]:
    """The moment that three angles stand for: in the axes of the body, and in those of the previous one.

    With the unit vectors w_i of the turns,  f_i = w_i . tau,  so
    tau = [f1 (w2 x w3) + f2 (w3 x w1) + f3 (w1 x w2)] / w1.(w2 x w3),
    and f and tau vanish together where the angles are regular.  A component for which the division does not come out is
    None.  In axes that turn with a free angle the components would contain it: there are none in those.
    """
    ring, motion = equations.ring, equations.scene.motions[joint.body]
    turns, before = motion.turns, motion.body.attached_to
    if len(joint.angles) != 3 or len(turns) != 3:
        return (), ()
    lengths = [ring.number(sign) for sign in joint.signs]
    after = [axis_vector(ring, x.axis, length, x.frame) for x, length in zip(turns, lengths, strict=True)]
    ahead = [v.in_parallel(turn.source) for v, turn in zip(after, turns, strict=True)]
    f = [equations.at_rest[equations.system.coordinates.index(name)] for name in joint.angles]
    parts: list[tuple[Polynomial | None, ...]] = []
    for free, w in (
        (joint.last_free, [forward(turns[k + 1 :], axis, joint.body) for k, axis in enumerate(after)]),
        (joint.first_free, [back(turns[:k], axis, before) for k, axis in enumerate(ahead)]),
    ):
        if free:
            parts.append(())
            continue
        total = zero_vector(ring, w[0].frame)
        for k in range(3):
            total = total + w[(k + 1) % 3].cross(w[(k + 2) % 3]) * f[k]
        volume = w[0].dot(w[1].cross(w[2]))
        square = ring.reduce(volume * volume)
        parts.append(tuple(ring.quotient(ring.reduce(ring.times(x, volume)), square) for x in total))
    return tuple(parts)
