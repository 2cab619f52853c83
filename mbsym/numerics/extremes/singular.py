"""Where the mass matrix is singular, found: det M as a polynomial of the exact ring at the scenario's numbers.

    det M(q) = 0,     and of each joint of three turns the determinant of (x1', x2', x3') -> omega, +-cos x2 or +-sin x2

Factors and their real zeros come from ``mbsym.algebra.zeros_in_boxes``.  On a set M v = 0 for some v = q', and

* if v moves nothing that the description shows (no joint, no mass centre, no body with inertia about that axis), the
  coordinates fail there: two of them do the same.  Others are regular there;
* if v moves something, but nothing that has mass, the model fails: it has a massless direction in that position, and no
  choice of coordinates helps.

Where every joint's own body tells its velocities (``mbsym.mechanics.energy``), that proves M regular, however many
joints there are; det M itself is expanded where that is not so.  Where it is too long for the ring, the joints' maps
are all that is proved; M is then looked at by balls at multiples of pi/12 of one coordinate at a time.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import arb, arb_mat, ctx, fmpq_mat

from mbsym.algebra import rationals
from mbsym.algebra.failures import Failure, NoClosedForm
from mbsym.algebra.krawczyk import pivot_rows
from mbsym.algebra.matrices import components, determinant
from mbsym.algebra.point import Balls
from mbsym.algebra.program import Node, Program
from mbsym.algebra.rationals import ball
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.zeros_in_boxes import UNDECIDED, Zero, Zeros, ZeroSet, zero_sets
from mbsym.expressions.angles import linear_form
from mbsym.expressions.message import Message
from mbsym.formulas.python import python_text
from mbsym.mechanics.energy import own_determinants
from mbsym.mechanics.kinematics import Scene, over_ring
from mbsym.mechanics.programs import programs
from mbsym.mechanics.rest import at_numbers
from mbsym.mechanics.variables import program_environment, ring_environment, ring_of
from mbsym.model.system import System, velocity_name
from mbsym.numerics.extremes.singular_positions import multiple_of_pi
from mbsym.numerics.scenario import Scenario, rounded

# Which of the two fails where M is singular, the coordinates or the model: ranks at a point, with many bits.


#: Ranks are decided at so many bits: smaller than this part of what is usual counts as zero.
BITS, NOTHING = 320, 1e-30

#: What a singular set is one of; ``BOTH`` where the coordinates fail, and the model beyond that.
CHART, MODEL, BOTH, OPEN = "coordinates", "model", "coordinates and model", "not told apart"


class Kinds:
    """Ranks of M and of what q' moves, at points with many bits."""

    def __init__(self, given: Scenario, system: System, ring: Ring, sizes: Mapping[str, Fraction]) -> None:
        self.scenario, self.system, self.sizes = given, system, sizes
        whole = programs(system, ring, open_tree=True)
        self.n = len(system.coordinates)
        self.matrix = (whole.program, [x for row in whole.mass_matrix for x in row])
        program = Program()
        environment = program_environment(system, program)
        scene = Scene(system, program, environment, ring, frozen=True)
        self.visible = (program, _moved(scene))
        with ctx.workprec(BITS):
            regular = self._point({}, 1)
            masses = self._masses(regular)
            self.usual = [masses[i, i] for i in range(self.n)]
            moved = self._motions(regular)
            self.rows = [max(abs(moved[i, j]) for j in range(self.n)) for i in range(moved.nrows())]

    def kind(self, place: Mapping[str, Any]) -> str:
        """Of a point of a singular set; the other coordinates are somewhere near where the scenario has them."""
        with ctx.workprec(BITS):
            point = self._point(place, 1)
            masses, moved = self._masses(point), self._motions(point)
            if any(not bool(x > 0) for x in self.usual):
                return OPEN
            shown = [[moved[i, j] / row for j in range(self.n)] for i, row in enumerate(self.rows) if bool(row > 0)]
            lost, hidden = self._lost(self._scaled(masses)), self._lost(shown)
        if not lost:
            return OPEN
        if hidden == lost:
            return CHART
        return BOTH if hidden else MODEL

    def singular(self, place: Mapping[str, Any]) -> bool:
        """Whether M has less than full rank at the scenario's position with the coordinates of ``place``."""
        with ctx.workprec(BITS):
            masses = self._masses(self._point(place, 0))
            return all(bool(x > 0) for x in self.usual) and self._lost(self._scaled(masses)) > 0

    def _scaled(self, masses: Any) -> list[list[Any]]:
        """M by the usual sizes of its diagonal."""
        n = range(self.n)
        return [[masses[i, j] / (self.usual[i] * self.usual[j]).sqrt() for j in n] for i in n]

    def _lost(self, rows: Sequence[Sequence[Any]]) -> int:
        """By how much the rank is less than n."""
        return self.n - len(pivot_rows([_midpoints(row) for row in rows], NOTHING))

    def _point(self, place: Mapping[str, Any], beside: int) -> dict[str, Any]:
        point: dict[str, Any] = {}
        for k, (name, value) in enumerate(zip(self.system.coordinates, self.scenario.positions, strict=True)):
            step = Fraction(beside * (7 + 3 * k), 50)
            point[name] = place.get(name, ball(value + step * self.sizes.get(name, Fraction(1))))
        for name, (start, _) in self.scenario.prescribed.items():
            point[name] = place.get(name, ball(start))
        point["t"], point["pi"] = place.get("t", arb(0)), arb.pi()
        return point

    def _masses(self, point: Mapping[str, Any]) -> Any:
        program, nodes = self.matrix
        return arb_mat(self.n, self.n, _midpoints(program.evaluate(nodes, point, Balls(point))))

    def _motions(self, point: Mapping[str, Any]) -> Any:
        """What unit velocities move: one column a coordinate."""
        program, nodes = self.visible
        columns = []
        for moving in self.system.coordinates:
            rates = {velocity_name(x): arb(1 if x == moving else 0) for x in self.system.coordinates}
            inputs = {**point, **rates}
            columns.append(_midpoints(program.evaluate(nodes, inputs, Balls(inputs))))
        return arb_mat(len(nodes), self.n, [columns[j][i] for i in range(len(nodes)) for j in range(self.n)])


def _moved(scene: Scene) -> list[Node]:
    """Velocities of joints and mass centres, and I omega of every body that has inertia."""
    nodes: list[Node] = []
    for motion in scene.motions.values():
        nodes += [*motion.velocity_origin, *motion.velocity_mass_centre]
        if motion.inertia is not None:
            nodes += [*(motion.inertia @ motion.angular_velocity)]
    return nodes


def _midpoints(balls: Sequence[Any]) -> list[Any]:
    return [x.mid() for x in balls]


#: Determinants of more coordinates are not expanded, nor ones that need more steps of polynomial arithmetic.
MOST_COORDINATES, MOST_WORK = 9, 12_000_000

#: Coordinates that are no angles are looked at up to so many times their size, where that matters.
RANGE = 10

#: Sets with a longer formula are told by a point of theirs.
SHOWN = 90


@dataclass(frozen=True)
class Value:
    """A value of a coordinate: ``label`` is exact (``pi/2``, ``0``) or has twelve digits; ``exact`` has 256 bits."""

    label: str
    exact: Fraction


@dataclass(frozen=True)
class SingularSet:
    """One part of the configurations at which M is singular.

    names       the coordinates that decide; whatever the others are
    values      of the one name; with several names empty, and ``equation`` = 0 says where
    places      points of the set, values by name (of one name, one point for every value)
    finite      with several names: the places are all there are
    kind        CHART, MODEL, BOTH, or OPEN where ranks could not be told
    joint       the body whose three turns cannot be told apart there, if that is why
    proved      that M is singular there and whether it is all of this factor; otherwise it was found by a search
    """

    names: tuple[str, ...]
    values: tuple[Value, ...]
    equation: str
    places: tuple[Mapping[str, Fraction], ...]
    finite: bool
    kind: str
    joint: str
    proved: bool


@dataclass(frozen=True)
class Singularities:
    """``complete``: proved that there are no others; ``how`` says by what, or what was searched instead.

    ``ranges`` are bounds of coordinates within which that holds, where it depends on any.
    """

    sets: tuple[SingularSet, ...]
    complete: bool
    how: str
    ranges: Mapping[str, Fraction]
    undecided: tuple[str, ...] = ()


def singularities(scenario: Scenario, ranges: Mapping[str, Fraction]) -> Singularities:
    """All that is found at the scenario's numbers; ``ranges`` bounds the coordinates that are no angles.

    Raises Failure where the system has no ring.
    """
    system = at_numbers(scenario.system, scenario.parameters)
    ring = ring_of(system)
    kinds = Kinds(scenario, system, ring, {name: bound / RANGE for name, bound in ranges.items()})
    joints = _joint_sets(system, ring, ranges)
    try:
        with ring.budget(MOST_WORK):
            own = zero_sets(ring, own_determinants(system, ring), ranges)
        if own.complete and all(any(_same(zero_set, other) for _, other in joints) for zero_set in own.sets):
            return _told(ring, own, kinds, joints, OWN, ranges)
    except Failure:
        own = None
    try:
        with ring.budget(MOST_WORK):
            zeros = _of_determinant(ring, system, ranges)
    except Failure as reason:
        if own is not None and own.complete and all(len(zero_set.names) == 1 for zero_set in own.sets):
            seen = [
                candidate
                for candidate in own.sets
                if all(kinds.singular({candidate.names[0]: zero.ball}) for zero in candidate.zeros)
            ]
            if len(seen) == len(own.sets):
                return _told(ring, own, kinds, joints, OWN, ranges, proved=False)
        return _searched(scenario, kinds, joints, str(reason))
    return _told(ring, zeros, kinds, joints, WHOLE, ranges)


#: What a list of singular sets stands on.
WHOLE = Message("the factors of det M at these numbers")
OWN = Message("the kinetic energy that every joint gives its own body while what carries it rests")


def _told(
    ring: Ring,
    zeros: Zeros,
    kinds: Kinds,
    joints: Sequence[tuple[str, ZeroSet]],
    how: str,
    ranges: Mapping[str, Fraction],
    proved: bool = True,
) -> Singularities:
    decided = [zero_set for zero_set in zeros.sets if zero_set.known != UNDECIDED]
    sets = [_described(ring, zero_set, kinds, joints, proved) for zero_set in decided]
    undecided = tuple(_text(ring, zero_set.factor) for zero_set in zeros.sets if zero_set.known == UNDECIDED)
    bounds = {name: ranges[name] for name in zeros.bounded if name in ranges}
    return Singularities(_joined(sets), zeros.complete, how, bounds, undecided)


def _of_determinant(ring: Ring, system: System, ranges: Mapping[str, Fraction]) -> Zeros:
    n = len(system.coordinates)
    if n > MOST_COORDINATES:
        raise NoClosedForm("a determinant of so many coordinates: [[count]]", count=n)
    whole = programs(system, ring, open_tree=True)
    nodes = [x for row in whole.mass_matrix for x in row]
    entries = [ring.reduce(x) for x in whole.program.evaluate(nodes, ring_environment(system, ring), ring)]
    blocks = components(n, lambda i, j: not entries[n * i + j].is_zero())
    factors = [determinant(ring, [[entries[n * i + j] for j in block] for i in block]) for block in blocks]
    if any(x.is_zero() for x in factors):
        raise NoClosedForm("det M vanishes everywhere")
    return zero_sets(ring, factors, ranges)


# --- joints ----------------------------------------------------------------------------------------------------------


def _joint_sets(system: System, ring: Ring, ranges: Mapping[str, Fraction]) -> list[tuple[str, ZeroSet]]:
    """(body, set) for every body that three turns about independent coordinates orient."""
    joint_sets = []
    scene = over_ring(system, ring, frozen=True)
    for body in system.bodies:
        turns = scene.motions[body.name].turns
        if len(turns) != 3 or turns[0].axis == turns[1].axis or turns[1].axis == turns[2].axis:
            continue
        if _independent([turn.angle for turn in turns], system.coordinates) < 3:
            continue
        volume = turns[1].sine if turns[0].axis == turns[2].axis else turns[1].cosine
        try:
            joint_sets += [(body.name, zero_set) for zero_set in zero_sets(ring, [ring.reduce(volume)], ranges).sets]
        except NoClosedForm:
            continue
    return joint_sets


def _independent(angles: Sequence[Any], coordinates: Sequence[str]) -> int:
    """The rank of d angles / d coordinates where that is constant; else 0."""
    forms = [linear_form(angle) for angle in angles]
    if any(form is None for form in forms):
        return 0
    rows = [dict(form.coefficients) for form in forms if form is not None]
    numbers = [[row.get(name, Fraction(0)) for name in coordinates] for row in rows]
    matrix = fmpq_mat(len(rows), len(coordinates), [rationals.exact(x) for row in numbers for x in row])
    return int(matrix.rank())


def _same(zero_set: ZeroSet, other: ZeroSet) -> bool:
    """Whether two sets of one name are the same, or the first holds some of the second's values."""
    if zero_set.names != other.names or len(zero_set.names) != 1:
        return False
    return all(any(_equal(a, b) for b in other.zeros) for a in zero_set.zeros)


def _equal(a: Zero, b: Zero) -> bool:
    if a.turns is not None and b.turns is not None:
        return (a.turns - b.turns) % 2 == 0
    return bool(a.ball.overlaps(b.ball))


# --- descriptions ----------------------------------------------------------------------------------------------------


def _described(
    ring: Ring, zero_set: ZeroSet, kinds: Kinds, joints: Sequence[tuple[str, ZeroSet]], proved: bool
) -> SingularSet:
    joint = next((body for body, other in joints if _same(zero_set, other)), "")
    places: tuple[Mapping[str, Fraction], ...]
    if len(zero_set.names) == 1:
        values = tuple(_value(zero) for zero in zero_set.zeros)
        places = tuple({zero_set.names[0]: value.exact} for value in values)
        first: Mapping[str, Any] = {zero_set.names[0]: zero_set.zeros[0].ball}
    else:
        values, first = (), zero_set.points[0]
        places = tuple({name: _exact(x) for name, x in point.items()} for point in zero_set.points)
    kind = CHART if joint else kinds.kind(first)
    return SingularSet(
        zero_set.names,
        values,
        _text(ring, zero_set.factor),
        places,
        zero_set.isolated,
        kind,
        joint,
        proved or bool(joint),
    )


def _exact(x: Any) -> Fraction:
    with ctx.workprec(256):
        return rounded(x.mid())


def _value(zero: Zero) -> Value:
    if zero.rational is not None:
        return Value(_number(zero.rational), zero.rational)
    exact = _exact(zero.ball)
    return Value(multiple_of_pi(zero.turns) if zero.turns is not None else f"{float(exact):.12g}", exact)


def _number(value: Fraction) -> str:
    return str(value) if value.denominator < 10_000 else f"{float(value):.12g}"


def _text(ring: Ring, factor: Polynomial) -> str:
    text = python_text(ring, factor)
    return text if len(text) <= SHOWN else f"a factor of det M of {len(factor)} terms"


def _joined(sets: Sequence[SingularSet]) -> tuple[SingularSet, ...]:
    """Sets of one coordinate and one kind are one set with several values."""
    kept_sets: dict[tuple[Any, ...], SingularSet] = {}
    for number, singular_set in enumerate(sets):
        key = (
            (singular_set.names, singular_set.kind, singular_set.joint)
            if len(singular_set.names) == 1
            else (singular_set.names, number)
        )
        before = kept_sets.get(key)
        if before is None:
            kept_sets[key] = singular_set
            continue
        new = [i for i, value in enumerate(singular_set.values) if value not in before.values]
        values = (*before.values, *(singular_set.values[i] for i in new))
        places = (*before.places, *(singular_set.places[i] for i in new))
        order = sorted(range(len(values)), key=lambda i: (abs(values[i].exact), -values[i].exact))
        kept_sets[key] = SingularSet(
            singular_set.names, tuple(values[i] for i in order), before.equation, tuple(places[i] for i in order),
            before.finite, singular_set.kind, singular_set.joint, before.proved and singular_set.proved,
        )  # fmt: skip
    return tuple(kept_sets.values())


# --- searching -------------------------------------------------------------------------------------------------------

_TWELFTHS = tuple(Fraction(k, 12) for k in range(-11, 13))


def _searched(scenario: Scenario, kinds: Kinds, joints: Sequence[tuple[str, ZeroSet]], reason: str) -> Singularities:
    """The joints' own sets, and one coordinate at a time at multiples of pi/12."""
    known = [
        SingularSet(
            zero_set.names, tuple(map(_value, zero_set.zeros)), "",
            tuple({zero_set.names[0]: _exact(z.ball)} for z in zero_set.zeros), False, CHART, body, True,
        )
        for body, zero_set in joints
        if len(zero_set.names) == 1 and zero_set.names[0] in scenario.system.coordinates
    ]  # fmt: skip
    covered = {singular_set.names[0] for singular_set in known}
    sets = []
    for name in scenario.system.coordinates:
        if name in covered:
            continue
        for turns in _TWELFTHS:
            with ctx.workprec(BITS):
                angle = arb.pi() * ball(turns)
            if kinds.singular({name: angle}):
                value = Value(multiple_of_pi(turns), _exact(angle))
                kind = kinds.kind({name: angle})
                sets.append(SingularSet((name,), (value,), "", ({name: value.exact},), False, kind, "", False))
    text = "multiples of pi/12 of one coordinate at a time; det M itself was not to be had: [[reason]]"
    how = Message(text, reason=reason)
    return Singularities(_joined([*known, *sets]), False, how, {})
