"""Base parameters: the smallest set of inertial parameters that an open tree's motion can tell, and their regressor.

The generalised forces are linear in the ten inertial parameters theta of each body, tau = Y(q, q', q'') theta + the
forces of other loads.  Columns of Y depend on each other: what a combination c of parameters does to T and U is

    sum_j c_j dT/dtheta_j = 0   and   sum_j c_j dU/dtheta_j = const

if and only if Y c = 0, for T is a form of second degree in q' and Lagrange's equations of L = 0 alone are empty.  So
the relations between columns are those between functions of the state, with coefficients that are constants of the
system.  What a joint does not feel is first moved towards the base, in the ring (``mechanics.regressor.regrouped``).
Between what is left relations are found by elimination, over the field of the parameters, in a part of the monomials;
then every one is verified in all of them.  Columns are taken from the base to the tips, J before h before m: the first
of those that depend on each other are kept, as in W. Khalil and E. Dombre, Modeling, Identification and Control of
Robots (2002), chapter 9.

That the kept columns are independent holds for almost all values of parameters that are symbols; exactly for numbers.

Under constraints J q' + j = 0 they are those of the tree without them: tau + J^T lambda = Y theta, and J, j hold no
inertial parameter.  On the constraints N^T tau = N^T Y theta, J N = 0, may tell fewer sums than Y does.

Sources: H. Mayeda, K. Yoshida and K. Osuka, Base parameters of manipulator dynamic models, IEEE Trans. Robotics
Automation 6 (1990) 312-321; M. Gautier and W. Khalil, Direct calculation of minimum set of inertial parameters of
serial robots, ibid. 368-373.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from random import Random
from typing import Any, TypeVar

from flint import arb, arb_mat, ctx, fmpq

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.point import Balls
from mbsym.algebra.program import Node, Program
from mbsym.algebra.quotients import Quotient
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.terms import apart
from mbsym.expressions.message import Message
from mbsym.expressions.tree import names
from mbsym.formulas.formula import Formula
from mbsym.mechanics.articulation import Articulation, articulation
from mbsym.mechanics.constraints.refusal import refuse_constraints
from mbsym.mechanics.given_matrices import refuse_matrices
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.newton_euler import Accelerations
from mbsym.mechanics.regressor import Energies, Slot, Standard, column, regrouped, values
from mbsym.mechanics.variables import expressions, program_environment
from mbsym.model.loads import UniformGravity
from mbsym.model.system import System, acceleration_name

#: Of each column so many monomials take part in the elimination at first.
_FIRST = 4

#: So many functions, some of them too long for the ring, are proved independent at most.
MOST_PROVED = 150

#: The monomials of moving quantities of one function, each with its constant coefficient; U's have a mark.
_Column = Mapping[tuple[Any, ...], Polynomial]

Key = TypeVar("Key", Standard, Slot)


@dataclass(frozen=True)
class Base:
    """kept + sum of coefficient * other: the motion tells this sum and nothing of its parts.

    ``value`` is what it is for the parameters of the description.
    """

    parameter: Standard
    others: tuple[tuple[Standard, Formula], ...]
    value: Formula


@dataclass(frozen=True)
class Regressor:
    """``columns`` of Y, one for each of ``base``, as nodes of ``program`` with the names of the system as inputs.

    ``standard`` are all parameters, ``without_effect`` those that no motion tells.  ``besides``: whether there are
    loads that tau = Y beta leaves out; ``tied``: whether constraints are, whose J^T lambda are forces besides.
    """

    system: System
    standard: tuple[Standard, ...]
    base: tuple[Base, ...]
    without_effect: tuple[Standard, ...]
    program: Program
    columns: tuple[tuple[Node, ...], ...]
    besides: bool
    tied: bool = False


def regressor(scene: Scene[Polynomial]) -> Regressor:
    """Base parameters and regressor of a system over its ring.

    Raises NoClosedForm for what moves as prescribed, gravity that is not uniform, formulas that are too long;
    Constrained, GivenByMatrices.
    """
    system, ring = scene.system, scene.ring
    _refuse(system)
    frames = articulation(scene)
    columns = _in_independent(ring, regrouped(frames), *_slots(frames, system))
    standards, dependent = _relations(ring, columns)
    values_by_standard = values(scene)
    bases = []
    for standard in standards:
        others = [(other, row[standard]) for other, row in dependent.items() if standard in row]
        added = tuple((other, Formula(ring, _polynomial(ring, x))) for other, x in others)
        value = values_by_standard[standard]
        for other, factor in added:
            value = value + ring.times(factor.polynomial, values_by_standard[other])
        bases.append(Base(standard, added, Formula(ring, ring.reduce(value))))
    without = tuple(standard for standard in columns if not columns[standard])
    besides = any(not isinstance(load, UniformGravity) for load in system.loads) or any(
        motion.gyrostatic_moment is not None for motion in scene.motions.values()
    )
    program = Program()
    moving = Scene(system, program, program_environment(system, program), ring)
    accelerations = Accelerations(moving)
    nodes = tuple(column(moving, accelerations, standard) for standard in standards)
    return Regressor(system, tuple(columns), tuple(bases), without, program, nodes, besides)


def _refuse(system: System) -> None:
    what = Message("base parameters")
    refuse_matrices(system, what)
    refuse_constraints(system, what)
    timely = {item.name for item in system.prescribed} | {"t"}
    inertial = [part for body in system.bodies for part in expressions(body)]
    fields = [load for load in system.loads if isinstance(load, UniformGravity)]
    if any(timely & names(x) for x in (*inertial, *expressions(tuple(fields)))):
        raise NoClosedForm("base parameters of a system that moves as prescribed are not looked for")
    if system.newtonian_fields:
        raise NoClosedForm("base parameters are looked for in uniform fields of gravity alone")
    if any(names(x) & {*system.coordinates} for body in system.bodies for x in _mass_properties(body)):
        raise NoClosedForm("the inertia of a body changes with the motion")


def _mass_properties(body: Any) -> list[Any]:
    properties = [body.mass, *body.mass_centre]
    return properties + [x for row in body.inertia.tensor for x in row] if body.inertia is not None else properties


class _Split:
    """A polynomial by monomials of what moves, with coefficients of what is constant."""

    def __init__(self, ring: Ring, system: System) -> None:
        self.ring = ring
        coordinates = set(system.coordinates)
        kinds = ("velocity", "acceleration", "coordinate", "prescribed", "time")
        self.moving = [
            k
            for k, g in enumerate(ring.generators)
            if g.kind in kinds or (g.kind in ("sine", "cosine") and g.name in coordinates)
        ]

    def __call__(self, kinetic: Polynomial, force: Polynomial) -> _Column:
        column: dict[tuple[Any, ...], Polynomial] = {}
        for mark, x in (("T", kinetic), ("U", force)):
            self._check(x)
            for fast, slow in apart(x, self.moving).items():
                if mark == "T" or any(fast):
                    column[mark, *((k, e) for k, e in zip(self.moving, fast, strict=True) if e)] = slow
        return column

    def _check(self, x: Polynomial) -> None:
        """Adjoined elements (roots, reciprocals) have to be constant, or monomials with them may depend on others."""
        if not x:
            return
        degrees = x.degrees()
        for k, g in enumerate(self.ring.generators[: self.ring.spare]):
            if degrees[k] > 0 and (g.argument is None or self._moves(g.argument)):
                raise NoClosedForm("a joint's place is no polynomial in coordinates, sines and cosines")

    def _moves(self, x: Polynomial) -> bool:
        degrees = x.degrees()
        spare = self.ring.generators[: self.ring.spare]
        return any(degrees[k] > 0 for k in self.moving) or any(
            degrees[k] > 0 and (g.argument is None or self._moves(g.argument)) for k, g in enumerate(spare)
        )


def _slots(
    frames: Articulation[Polynomial], system: System
) -> tuple[dict[Slot, dict[Slot, Quotient]], tuple[Slot, ...]]:
    """What parameters of frames do as combinations of what some of them do, and these; {} of one without effect.

    Functions that outgrow the ring's bounds are taken for independent of all others; that this is so, is proved by
    the rank in balls at random states.
    """
    ring = frames.scene.ring
    functions, split = Energies(frames), _Split(ring, system)
    columns: dict[Slot, _Column] = {}
    long: list[Slot] = []
    outgrown: set[int] = set()  # frames; what they carry has longer formulas yet
    for slot in sorted({slot for shares in regrouped(frames).values() for slot in shares}):
        above = slot[0]
        while above >= 0 and above not in outgrown:
            above = frames.frames[above].parent
        if above >= 0:
            long.append(slot)
            continue
        try:
            kinetic, force = functions.of(slot)
            columns[slot] = split(ring.reduce(kinetic), ring.reduce(force))
        except NoClosedForm as error:
            if error.limit is None:
                raise
            long.append(slot)
            outgrown.add(slot[0])
    ordered = {slot: columns[slot] for slot in sorted(columns)}
    independent, dependent = _relations(ring, ordered)
    independent = [*independent, *long]
    if long and len(independent) > MOST_PROVED:
        raise NoClosedForm("formulas of T are too long to find the relations between their parts")
    if long:
        _independent(frames, system, independent)
    made: dict[Slot, dict[Slot, Quotient]] = {slot: {slot: Quotient.of(ring.one)} for slot in independent}
    return made | dependent, tuple(independent)


def _in_independent(
    ring: Ring,
    shares: Mapping[Standard, Mapping[Slot, Polynomial]],
    slots: Mapping[Slot, Mapping[Slot, Quotient]],
    kept_slots: Sequence[Slot],
) -> dict[Standard, _Column]:
    """Each parameter's effect in those of the slots ``kept``, all times one common denominator."""
    common = ring.one
    for row in slots.values():
        for x in row.values():
            common = common * (x.bottom / common.gcd(x.bottom))
    columns: dict[Standard, _Column] = {}
    for standard, own in shares.items():
        total: dict[Slot, Polynomial] = {}
        for slot, factor in own.items():
            for other, x in slots[slot].items():
                total[other] = total.get(other, ring.zero) + factor * x.top * (common / x.bottom)
        reduced = {slot: ring.reduce(x) for slot, x in total.items()}
        columns[standard] = {slot: x for slot, x in reduced.items() if not ring.vanishes(x)}
    return columns


def _independent(frames: Articulation[Polynomial], system: System, slots: Sequence[Slot]) -> None:
    """Proves that no combination of the slots' functions is zero in T and constant in U: a determinant is not zero.

    Its rows are combinations of values at as many random states; parameters have random values, too.
    """
    ring, size = frames.scene.ring, len(slots)
    source = Random(20260711)

    def state(still: Mapping[str, arb]) -> dict[str, arb]:
        names_ = [*system.coordinates, *system.velocities]
        drawn: dict[str, arb] = {name: arb(fmpq(source.randint(-(10**6), 10**6), 10**6)) for name in names_}
        return {**still, **drawn, **{acceleration_name(q): arb(0) for q in system.coordinates}}

    with ctx.workprec(512 + 24 * size):
        constants = {name: arb(fmpq(source.randint(10**5, 10**6), 10**6)) for name in system.parameter_names}
        constants |= {"pi": arb.pi(), "t": arb(0)} | dict.fromkeys(system.input_names, arb(0))
        rows: list[list[arb]] = []
        at_first: list[arb] = []
        for _ in range(size + 1):
            values_ = state(constants)
            functions = Energies(articulation(Scene(system, Balls(values_), values_, ring)))
            pairs = [functions.of(slot) for slot in slots]
            at_first = at_first or [u for _, u in pairs]
            rows.append([t + 3 * (u - v) for (t, u), v in zip(pairs, at_first, strict=True)])
        matrix = arb_mat(rows[1:])
        for k in range(size):  # columns of very different lengths cost digits
            longest = max((abs(matrix[i, k]).mid() for i in range(size)), default=arb(0))
            for i in range(size):
                matrix[i, k] = matrix[i, k] / longest if longest > 0 else matrix[i, k]
        if matrix.det().contains(0):
            raise NoClosedForm("formulas of T are too long to find the relations between their parts")


def _relations(ring: Ring, columns: Mapping[Key, _Column]) -> tuple[list[Key], dict[Key, dict[Key, Quotient]]]:
    """The columns that do not depend on earlier ones, and the others as combinations of these."""
    rows = list(dict.fromkeys(key for entries in columns.values() for key in sorted(entries, key=len)[:_FIRST]))
    while True:
        standards, dependent = _eliminated(ring, columns, rows)
        missed = [
            key for name, row in dependent.items() if (key := _unequal(ring, columns, name, row, rows)) is not None
        ]
        if not missed:
            return standards, dependent
        rows += dict.fromkeys(missed)


def _eliminated(
    ring: Ring, columns: Mapping[Key, _Column], rows: Sequence[tuple[Any, ...]]
) -> tuple[list[Key], dict[Key, dict[Key, Quotient]]]:
    """Gauss and Jordan on some monomials: columns that are independent there are so, others perhaps not."""
    zero = Quotient.of(ring.zero)
    quotient = Quotient.of(ring.one)
    keys: list[Key] = []
    dependent: dict[Key, dict[Key, Quotient]] = {}
    #: Pivot: the monomial, the column that is 1 there, and what it is made of.
    pivots: list[tuple[tuple[Any, ...], dict[tuple[Any, ...], Quotient], dict[Key, Quotient]]] = []
    for name, full in columns.items():
        left = {key: Quotient.of(full[key]) for key in rows if key in full}
        made = {name: quotient}
        for key, reduced, parts in pivots:
            factor = left.get(key)
            if factor is None:
                continue
            for other, x in reduced.items():
                value = _normal(ring, left.get(other, zero) - factor * x)
                if value.is_zero:
                    left.pop(other, None)
                else:
                    left[other] = value
            for part, x in parts.items():
                made[part] = _normal(ring, made.get(part, zero) - factor * x)
        if not left:
            dependent[name] = {other: -x for other, x in made.items() if other != name and not x.is_zero}
            continue
        key = min(
            left, key=lambda monomial: (len(left[monomial].top) + len(left[monomial].bottom), rows.index(monomial))
        )
        if ring.is_zero(left[key].top) is None:
            raise NoClosedForm("whether a constant is zero cannot be decided")
        unit = left[key]
        keys.append(name)
        pivots.append(
            (
                key,
                {other: _normal(ring, x / unit) for other, x in left.items()},
                {other: _normal(ring, x / unit) for other, x in made.items()},
            )
        )
    return keys, dependent


def _normal(ring: Ring, x: Quotient) -> Quotient:
    """With constants such as sqrt(2) in normal form."""
    if not x.top or (len(x.top) == 1 and x.top.is_constant() and x.bottom.is_constant()):
        return x
    return Quotient.of(ring.reduce(x.top), ring.reduce(x.bottom))


def _unequal(
    ring: Ring, columns: Mapping[Key, _Column], name: Key, row: Mapping[Key, Quotient], known: Sequence[tuple[Any, ...]]
) -> tuple[Any, ...] | None:
    """A monomial in which a column is not this combination of others; None where it is in all of them."""
    common = ring.one
    for x in row.values():
        common = common * (x.bottom / common.gcd(x.bottom))
    factors = {other: x.top * (common / x.bottom) for other, x in row.items()}
    keys = dict.fromkeys([*columns[name], *(key for other in row for key in columns[other])])
    seen = set(known)
    for key in keys:
        if key in seen:
            continue
        total = common * columns[name].get(key, ring.zero)
        for other, factor in factors.items():
            if key in columns[other]:
                total = total - factor * columns[other][key]
        if not ring.vanishes(ring.reduce(total)):
            return key
    return None


def _polynomial(ring: Ring, x: Quotient) -> Polynomial:
    if x.bottom.is_constant():
        return x.top / x.bottom.leading_coefficient()
    return ring.ratio(x.top, x.bottom)
