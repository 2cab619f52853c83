"""Constraints, in coordinates and speeds: rows over the ring, ranks at exact points, pivots, integrability."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from flint import ctx, fmpq_mat

from mbsym.algebra import rationals
from mbsym.algebra.certainty import Certainty
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import NOT_THERE, Constrained, Failure, NoClosedForm
from mbsym.algebra.matrices import reduced_rows
from mbsym.algebra.point import Rationals
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message, joined
from mbsym.formulas.formula import Formula, Matrix, column
from mbsym.mechanics.constraints.dependence import Dependent, dependent_sets
from mbsym.mechanics.constraints.embedding import Embedding, Pivots, basis_vector, choose, embedded
from mbsym.mechanics.constraints.programs import ConstrainedPrograms, constrained_programs
from mbsym.mechanics.constraints.ranks import Eliminated, eliminated, is_certain
from mbsym.mechanics.constraints.rows import Row, RowName, kept_rows, said_rows
from mbsym.mechanics.constraints.speed_rows import speed_rows
from mbsym.mechanics.constraints.states import PRECISION, Manifold, OnManifold
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import places
from mbsym.mechanics.oracle import Oracle
from mbsym.mechanics.speed_states import completed
from mbsym.mechanics.speeds import SpeedForm
from mbsym.model.admissibility import known_values
from mbsym.model.constraints import Rolling, is_holonomic, kind_name
from mbsym.model.system import System, velocity_name
from mbsym.problems.constraints.integrability import Field, by_program, integrability, is_exact_by_itself, undecided
from mbsym.problems.constraints.result import Constraints, Demanded, Integrability, Redundant, Solved
from mbsym.problems.knowledge import signs

#: At so many points ranks are taken.
POINTS = 3


def constraints(scene: Scene) -> Constraints:
    """Everything that is known of the constraints (scene over the ring).

    Raises Unsound where they contradict one another, tie what nothing moves, or where the dependent set of the
    description cannot be solved for; Constrained where no configuration that keeps them was found; NoClosedForm as the
    ring does.
    """
    with ctx.workprec(PRECISION):
        return _Analysis(scene).result()


def faults(scene: Scene) -> tuple[Fault, ...]:
    """The faults alone: what is said of a description before anything is derived from it."""
    try:
        with ctx.workprec(PRECISION):
            _Analysis(scene).look_for_faults()
    except Unsound as reason:
        return reason.faults
    except Failure:  # nothing is known to be wrong
        return ()
    return ()


@dataclass(frozen=True)
class Fault:
    """Why constraints cannot be meant: the rows that it is about (none: the dependent set), and what to do."""

    code: str
    message: str
    rows: tuple[RowName, ...] = ()
    hint: str = ""


def _told(fault: Fault) -> Message:
    message = Message(fault.message) if not isinstance(fault.message, Message) else fault.message
    if not fault.rows:
        return message
    return Message("[[message]] ([[rows]])", message=message, rows=joined((row.label for row in fault.rows), ", "))


class Unsound(Constrained):
    """Constraints that cannot be meant, with every fault that was found."""

    def __init__(self, faults: Sequence[Fault]) -> None:
        super().__init__(joined(map(_told, faults), "; "), remedy=faults[0].hint)
        self.faults = tuple(faults)


class _Points:
    """Numbers at points of the manifold: J and j of the rows, and any formula of the ring."""

    def __init__(self, ring: Ring, found: ConstrainedPrograms, states: Sequence[OnManifold]) -> None:
        self.ring = ring
        self.programs = found
        self.states = states
        self.carriers = [Carrier(ring, state.state.numbers, state.state.values) for state in states]

    @property
    def exact(self) -> bool:
        return all(state.exact for state in self.states)

    def jacobians(self) -> list[list[list[Any]]]:
        nodes = [x for row in self.programs.jacobian for x in row]
        n = len(self.programs.jacobian[0]) if self.programs.jacobian else 0
        matrices = []
        for state in self.states:
            values = self.programs.tree.program.evaluate(nodes, state.state.values, state.state.numbers)
            matrices.append([values[i : i + n] for i in range(0, len(values), n)])
        return matrices

    def at(self, places: Sequence[int]) -> _Points:
        """Some of them."""
        return _Points(self.ring, self.programs, [self.states[k] for k in places])

    @cached_property
    def _jacobians(self) -> list[list[list[Any]]]:
        return self.jacobians()

    def combined(self, independent: Sequence[int], i: int) -> list[int]:
        """Of which independent rows of J a dependent one is a combination, at any of the points."""
        m, held = len(independent), set[int]()
        for jacobian in self._jacobians:
            table = [[*(jacobian[k][c] for k in independent), jacobian[i][c]] for c in range(len(jacobian[i]))]
            done = eliminated(table, range(m))
            held |= {independent[column] for row, column in done.pivots if is_certain(done.rows[row][m])}
        return [k for k in independent if k in held]

    def values(self, polynomials: Sequence[Polynomial]) -> list[list[Any]]:
        """Each formula at each point."""
        return [[carrier(x) for x in polynomials] for carrier in self.carriers]

    def rank(self, fields: Sequence[Field]) -> tuple[int, bool]:
        """The rank of fields, the greatest at the points; proved to be no greater only where it is full."""
        best = 0
        if not fields:  # all that moves is moved
            return 0, True
        for carrier in self.carriers:
            try:
                rows = [[carrier(x) for x in field] for field in fields]
            except ZeroDivisionError:  # the dependent velocities are singular just there
                continue
            best = max(best, eliminated(rows, range(len(rows[0]))).rank)
        return best, best == len(fields)


class _Analysis:
    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.ring: Ring = scene.ring
        self.system = scene.system
        self.rows = said_rows(scene)
        idle = _idle(self.system, self.rows, self.ring)
        if idle:
            raise Unsound(idle)
        self.n = len(self.system.coordinates)
        self.programs = constrained_programs(self.system, self.ring, kept_rows(self.rows))
        self.manifold = Manifold(self.system, self.ring, self.programs)

    def look_for_faults(self) -> None:
        """Raises Unsound with those there are: how rows are solved matters where the description says it."""
        points, independent = self.independent_rows()
        if self.system.dependent:
            self._chosen(independent, points)

    def independent_rows(self) -> tuple[_Points, list[int]]:
        """Points of the manifold, and rows that are independent there."""
        impossible = contradiction(self.ring, self.rows)
        if impossible:
            message = "these constraints contradict one another: no configuration keeps them all"
            raise Unsound([Fault("contradictory-constraints", message, impossible)])
        points = _Points(self.ring, self.programs, list(self.manifold.states(POINTS)))
        if not points.states:
            raise Constrained("no regular configuration that keeps all constraints was found")
        ranked = [self._ranked(jacobian) for jacobian in points.jacobians()]
        rank = max(elimination.rank for elimination in ranked)
        # Where it is lower a point is singular, or on another branch.
        points = points.at([k for k, elimination in enumerate(ranked) if elimination.rank == rank])
        self._check_slopes(points)
        # A row that vanishes at a point by chance is not left out for a later one.
        generic = min((x for x in ranked if x.rank == rank), key=lambda x: sorted(i for i, _ in x.pivots))
        independent = sorted(i for i, _ in (self._on_the_motion(points, rank) or generic).pivots)
        self._check_velocities(points, independent)
        self._check_freedom(independent)
        return points, independent

    def _on_the_motion(self, points: _Points, rank: int) -> Eliminated | None:
        """Rows that are independent on the motion, where as many are as elsewhere: it may be where others are not."""
        for place in places(self.scene):
            with suppress(*NOT_THERE, Failure):
                one = points.at([0])
                held = [self.ring.substitute(row.position, place) for row in self.rows if row.position is not None]
                if any(map(is_certain, one.values(held)[0])):  # where equilibria are looked for it is no position
                    continue
                flat = [self.ring.substitute(x, place) for row in self.rows for x in row.partials]
                there = one.values(flat)[0]
                ranked = self._ranked([there[i : i + self.n] for i in range(0, len(there), self.n)])
                if ranked.rank == rank:
                    return ranked
        return None

    def _check_slopes(self, points: _Points) -> None:
        """Raises Unsound where a row ties no velocity wherever it holds, as a square does, and motions leave it."""
        evaluate = self.programs.tree.program.evaluate
        bent = [evaluate(self.programs.acceleration, x.state.values, x.state.numbers) for x in points.states]
        jacobians = points.jacobians()
        loose = [
            row.name
            for i, row in enumerate(self.rows)
            if not any(is_certain(x) for jacobian in jacobians for x in jacobian[i])
            and any(is_certain(rates[i]) for rates in bent)
        ]
        if loose:
            message = "wherever this constraint holds it ties no velocity, as a square does"
            hint = "write what is squared: x = y for (x - y)**2 = 0"
            raise Unsound([Fault("square-constraint", message, (name,), hint) for name in loose])

    def _check_freedom(self, independent: Sequence[int]) -> None:
        """Raises Unsound where nothing can move, and nothing is moved either."""
        if len(independent) < self.n or any(self.ring.at_rest(row.velocity) for row in self.rows):
            return
        message = "the constraints leave no freedom: nothing can move"
        hint = "leave one of them out"
        if any(isinstance(constraint, Rolling) for constraint in self.system.constraints):
            hint = "leave one of them out; the contact of 'rolling' wants 'axes' that do not spin with the wheel"
        raise Unsound([Fault("no-freedom", message, tuple(self.rows[i].name for i in independent), hint)])

    def _chosen(self, independent: list[int], points: _Points) -> Pivots:
        """How the rows are solved."""
        jacobian = [row.partials for row in self.rows]
        columns, required = self._columns(len(independent))
        try:
            return choose(self.ring, jacobian, independent, columns, regular_at(points.jacobians()), required)
        except Constrained as reason:
            if not self.system.dependent:
                raise
            names = ", ".join(self.system.dependent)
            message = Message("the constraints cannot be solved for the velocities of [[names]]", names=names)
            raise Unsound([Fault("dependent-set", message, hint=self._dependent_hint(independent))]) from reason

    def _dependent_hint(self, independent: list[int]) -> str:
        """A set that can be solved for."""
        block = eliminated(
            [_Points(self.ring, self.programs, list(self.manifold.states(1))).jacobians()[0][i] for i in independent],
            range(self.n - 1, -1, -1),
        )
        names = ", ".join(self.system.coordinates[k] for k in sorted(block.columns))
        return Message("for example dependent: [[[names]]]", names=names)

    def result(self) -> Constraints:
        points, independent = self.independent_rows()
        pivots = self._chosen(independent, points)
        jacobian = [row.partials for row in self.rows]
        shifts = [self.ring.at_rest(row.velocity) for row in self.rows]
        at_rest = {self.ring.index("acceleration", name): self.ring.zero for name in self.system.coordinates}
        gammas = [self.ring.substitute(row.acceleration, at_rest) for row in self.rows]
        sides = list(zip(shifts, gammas, strict=True))
        embedding = self._embedding(jacobian, sides, pivots)
        holonomic = sum(self.rows[i].name.holonomic for i in independent)
        names, m = self.system.coordinates, range(len(self.rows))
        return Constraints(
            names=tuple(row.name for row in self.rows),
            position=tuple(None if row.position is None else Formula(self.ring, row.position) for row in self.rows),
            velocity=column(self.ring, [row.velocity for row in self.rows]),
            jacobian=Matrix.of(self.ring, [list(row) for row in jacobian]),
            acceleration=column(self.ring, gammas),
            independent=tuple(independent),
            redundant=tuple(
                self._redundant(i, independent, sides, embedding, points) for i in m if i not in independent
            ),
            position_rank=holonomic,
            demanded=self._demanded(points, holonomic, len(independent)),
            coordinates=names,
            dependent=tuple(names[k] for k in pivots.columns),
            integrability=self._integrability(
                embedding, pivots, shifts, holonomic, len(independent) - holonomic, points
            ),
            alone=tuple(
                (self.rows[i].name, is_exact_by_itself(self.scene, jacobian[i], shifts[i]))
                for i in independent
                if not self.rows[i].name.holonomic
            ),
            exact_points=points.exact,
            pivots=pivots,
            solved=_solved(self.scene, embedding),
            dependent_sets=self._dependent_sets(independent, m, points),
            dependent_positions=self._dependent_sets(
                [i for i in independent if self.rows[i].name.holonomic],
                [i for i in m if self.rows[i].name.holonomic],
                points,
            ),
            rank_beside=self.manifold.rank_beside if self.manifold.at_values else None,
            kept_at_values=self._is_kept_at_values(holonomic),
        )

    @staticmethod
    def _dependent_sets(independent: Sequence[int], rows: Sequence[int], points: _Points) -> tuple[Dependent, ...]:
        relations = [{i, *points.combined(independent, i)} for i in rows if i not in independent]
        return dependent_sets(relations, independent)

    def _embedding(
        self, jacobian: Sequence[Sequence[Polynomial]], sides: Sequence[tuple[Polynomial, Polynomial]], pivots: Pivots
    ) -> Embedding | None:
        """The dependent velocities in closed form; None where they outgrow the budget."""
        try:
            return embedded(self.ring, jacobian, sides, pivots)
        except NoClosedForm:
            return None

    def _integrability(
        self,
        embedding: Embedding | None,
        pivots: Pivots,
        shifts: Sequence[Polynomial],
        holonomic: int,
        imposed: int,
        points: _Points,
    ) -> Integrability | None:
        if imposed <= 0:
            return None
        rheonomic = self._is_rheonomic(shifts)
        if embedding is not None:
            with suppress(Failure):
                return integrability(self.scene, embedding, rheonomic, holonomic, points.rank)
        if not rheonomic:
            with suppress(Failure, ZeroDivisionError):
                states = [state.state for state in points.states]
                known = by_program(self.system.coordinates, self.programs, pivots, holonomic, states)
                if known is not None:
                    return known
        return undecided(imposed, rheonomic)

    def _ranked(self, jacobian: list[list[Any]]) -> Eliminated:
        """Independent rows: holonomic ones count before velocity constraints, each kind in the order of the file."""
        order = sorted(range(len(jacobian)), key=lambda i: not self.rows[i].name.holonomic)
        done = eliminated([jacobian[i] for i in order], range(self.n))
        pivots = tuple((order[i], column) for i, column in done.pivots)
        return Eliminated(tuple(sorted(pivots)), done.rows, done.exact)

    def _columns(self, rank: int) -> tuple[list[int], list[int]]:
        """All coordinates, those preferred as dependent ones last, and those that the description wants dependent."""
        names, dependent = self.system.coordinates, self.system.dependent
        if len(dependent) > rank:
            gaps = {"all": len(names), "count": len(dependent)}
            message = Message("1 of [[all]] velocities depends on the others, and 'dependent' names [[count]]", **gaps)
            if rank != 1:
                message = Message(
                    "[[rank]] of [[all]] velocities depend on the others, and 'dependent' names [[count]]",
                    rank=rank,
                    **gaps,
                )
            raise Unsound([Fault("dependent-set", message, hint="leave 'dependent' out to have them found")])
        plain = [k for k, name in enumerate(names) if name not in self.ring.angles]
        columns = [k for k in range(len(names)) if k not in plain] + plain
        return columns, [names.index(name) for name in dependent]

    def _check_velocities(self, points: _Points, independent: Sequence[int]) -> None:
        """J q' + j = 0 must have a solution: at a point of the manifold what is left of a dependent row is zero."""
        for state in points.states:
            left = self.programs.tree.program.evaluate(self.programs.velocity, state.state.values, state.state.numbers)
            wrong = tuple(self.rows[i].name for i, x in enumerate(left) if is_certain(x))
            if wrong:
                message = "this contradicts the other constraints: no velocities keep them all"
                raise Unsound([Fault("contradictory-constraints", message, (row,)) for row in wrong])

    def _is_rheonomic(self, shifts: Sequence[Polynomial]) -> bool:
        """Whether time takes part: a shift, or t or something prescribed in J."""
        timely = ("t", *(item.name for item in self.system.prescribed))
        held = [x for row in self.rows for x in row.partials]
        return any(not self.ring.vanishes(x) for x in shifts) or any(
            self.ring.depends_on(x, name) for x in held for name in timely
        )

    def _redundant(
        self,
        i: int,
        independent: Sequence[int],
        sides: Sequence[tuple[Polynomial, Polynomial]],
        embedding: Embedding | None,
        points: _Points,
    ) -> Redundant:
        """What a row follows from, and how that is known: J (Y u + y0) + j = 0 in the ring, or at the points only."""
        proved = embedding is not None and self._follows(self.rows[i].partials, sides[i][0], embedding)
        return Redundant(
            self.rows[i].name,
            tuple(self.rows[k].name for k in points.combined(independent, i)),
            Certainty.PROVED if proved else Certainty.VERIFIED,
        )

    def _follows(self, row: Sequence[Polynomial], side: Polynomial, embedding: Embedding) -> bool:
        ring = self.ring
        try:
            left = [ring.dot(row, basis_vector(ring, embedding, place)) for place in range(len(embedding.free))]
            moved = (ring.times(row[k], x) for k, x in zip(embedding.dependent, embedding.shift, strict=True))
            left.append(ring.reduce(sum(moved, side)))
            return all(ring.is_zero(x) is True for x in left)
        except NoClosedForm:
            return False

    def _is_kept_at_values(self, position_rank: int) -> bool | None:
        if not position_rank or known_values(self.system).keys() < {*self.system.parameter_names}:
            return None
        return self.manifold.is_kept_at_values

    def _demanded(self, points: _Points, position_rank: int, rank: int) -> Demanded:
        """Relations between parameters that phi = 0 demands: what its rank gains by the parameters, and which."""
        manifold = self.manifold
        count = manifold.rank_with_parameters(points.states[0]) - position_rank
        if not count or manifold.at_values:  # at other values of the parameters the constraints are kept, too
            return Demanded(0)
        relation = manifold.relation(points.states) if count == 1 else None
        relations = () if relation is None else (Formula(self.ring, relation),)
        known = known_values(self.system)
        if known.keys() < {*self.system.parameter_names}:
            return Demanded(count, relations)
        ranks = manifold.ranks_at_values()
        satisfied = rank in ranks
        if relation is not None:
            numbers = Rationals({}, {})
            values = {name: rationals.exact(x) for name, x in known.items()}
            satisfied = Carrier(self.ring, numbers, values)(relation) == 0
        freedom = self.n - min(ranks) if ranks else None
        return Demanded(count, relations, satisfied, freedom)


def _solved(scene: Scene, embedding: Embedding | None) -> Solved | None:
    """None where the dependent velocities have no closed form within the budget."""
    if embedding is None:
        return None
    return Solved.of(scene.ring, embedding, signs(scene).never_zero(embedding.determinant))


def regular_at(jacobians: Sequence[Sequence[Sequence[Any]]]) -> Any:
    """Whether a square block is regular at one of the points."""

    def regular(rows: Sequence[int], columns: Sequence[int]) -> bool:
        return any(
            eliminated([[jacobian[i][k] for k in columns] for i in rows], range(len(columns))).rank == len(rows)
            for jacobian in jacobians
        )

    return regular


def _idle(system: System, rows: Sequence[Row], ring: Ring) -> list[Fault]:
    """Constraints whose rows hold no velocity: their ends are on one rigid piece, or planar motion keeps them apart."""
    faults = []
    for number, constraint in enumerate(system.constraints):
        own = [row for row in rows if row.name.constraint == number]
        fixed = tuple(row.name for row in own if all(map(ring.vanishes, row.partials)))
        name = RowName(number, 0, kind_name(constraint), is_holonomic(constraint), constraint.span)
        if len(fixed) == len(own):
            message = "no coordinate moves what this constraint ties: it is one rigid piece, or nothing is tied"
            hint = "tie bodies that move against each other" if own else "leave it out: it holds wherever they are"
            faults.append(Fault("rigid-constraint", message, (name,), hint))
        elif fixed:
            listed = ", ".join(str(row.component) for row in fixed)
            message = Message(
                "no coordinate changes component [[components]] of this constraint, and it is not zero",
                components=listed,
            )
            faults.append(Fault("rigid-constraint", message, (name,)))
    return faults


def contradiction(ring: Ring, rows: Sequence[Row]) -> tuple[RowName, ...]:
    """The rows of which a combination with rational coefficients says 1 = 0; none where there is no such."""
    held = [row for row in rows if row.position is not None]
    dicts = [row.position.to_dict() for row in held if row.position is not None]
    monomials = sorted({monomial for coefficients in dicts for monomial in coefficients}, reverse=True)
    if not monomials or any(monomials[-1]):  # the constant comes last
        return ()
    width, m = len(monomials), len(held)
    entries = [
        [*(coefficients.get(monomial, 0) for monomial in monomials), *(int(i == k) for k in range(m))]
        for i, coefficients in enumerate(dicts)
    ]
    for row in reduced_rows(fmpq_mat(m, width + m, [x for line in entries for x in line])).values():
        if not any(row[: width - 1]) and row[width - 1] != 0:
            return tuple(held[k].name for k in range(m) if row[width + k] != 0)
    return ()


# Constraints in speeds u: what is known in coordinates, told in the variables.
#
#     J u + j = 0,   J u' + gamma = 0           J = J_q Y of  q' = Y (u - s0): of the same rank
#     u = V v + v0,  u' = V v' + a0             v: the independent speeds
#
# Which rows are independent, redundant, integrable is a matter of the directions in which the system can move, whatever
# they are told by: it is found once, in coordinates (``analysis``).
#
# Source: Kane & Levinson, Dynamics: Theory and Applications (1985), sections 2.13, 4.4 (nonholonomic partial
# velocities).


def constraints_in_speeds(
    form: SpeedForm, scene: Scene, tied: Constraints, programs: ConstrainedPrograms
) -> Constraints:
    """The constraints ``tied`` (in coordinates) in speeds; ``programs`` are those in coordinates.

    Raises Unsound where the dependent set of the description cannot be solved for, Constrained, NoClosedForm.
    """
    ring, names = form.ring, tuple(u.name for u in form.speeds)
    rows = speed_rows(form, scene, tied.names)
    pivots = _pivots(form, scene, rows, tied, programs)
    still = {u.index: ring.zero for u in form.speeds}
    sides = [(ring.substitute(row.velocity, still), row.acceleration) for row in rows]
    try:
        embedding = embedded(ring, [row.partials for row in rows], sides, pivots)
    except NoClosedForm:
        embedding = None
    return replace(
        tied,
        position=tuple(None if row.position is None else Formula(ring, row.position) for row in rows),
        velocity=column(ring, [row.velocity for row in rows]),
        jacobian=Matrix.of(ring, [list(row.partials) for row in rows]),
        acceleration=column(ring, [row.acceleration for row in rows]),
        coordinates=names,
        dependent=tuple(names[k] for k in pivots.columns),
        pivots=pivots,
        solved=_solved(scene, embedding),
        in_speeds=True,
    )


def wanted_speeds(form: SpeedForm) -> list[int]:
    """The places of the speeds that the description wants dependent: by their names, or those of coordinates."""
    named = {*form.system.dependent, *map(velocity_name, form.system.dependent)}
    return [k for k, u in enumerate(form.speeds) if u.name in named]


def _pivots(
    form: SpeedForm, scene: Scene, rows: Sequence[Row], tied: Constraints, programs: ConstrainedPrograms
) -> Pivots:
    """Which speeds depend on the others; kept velocities of plain coordinates rather than declared speeds."""
    required, rank = wanted_speeds(form), tied.velocity_rank
    if len(required) > rank:
        gaps = {"all": len(form.speeds), "count": len(required)}
        message = Message("1 of [[all]] speeds depends on the others, and 'dependent' names [[count]]", **gaps)
        if rank != 1:
            message = Message(
                "[[rank]] of [[all]] speeds depend on the others, and 'dependent' names [[count]]", rank=rank, **gaps
            )
        raise Unsound([Fault("dependent-set", message, hint="leave 'dependent' out to have them found")])
    declared = {speed.name for speed in form.system.speeds}
    names = [u.name for u in form.speeds]
    turning = {velocity_name(name) for name in form.ring.angles}
    columns = sorted(range(len(names)), key=lambda k: (names[k] not in declared, names[k] not in turning))
    with ctx.workprec(PRECISION):
        jacobians = _at_points(form, rows, programs)
        try:
            partials, regular = [x.partials for x in rows], regular_at(jacobians)
            return choose(form.ring, partials, tied.independent, columns, regular, required, places(scene))
        except Constrained as reason:
            if not required or not jacobians:
                raise
            listed = ", ".join(names[k] for k in required)
            message = Message("the constraints cannot be solved for the speeds [[names]]", names=listed)
            block = eliminated([jacobians[0][i] for i in tied.independent], columns[::-1])
            known = ", ".join(names[k].removesuffix("_dot") for k in sorted(block.columns))
            hint = Message("for example dependent: [[[names]]]", names=known)
            raise Unsound([Fault("dependent-set", message, hint=hint)]) from reason


def _at_points(form: SpeedForm, rows: Sequence[Row], programs: ConstrainedPrograms) -> list[list[list[Any]]]:
    """J in numbers at points of the manifold, those left out at which speeds do not determine velocities."""
    at_points: list[list[list[Any]]] = []
    for on_manifold in Manifold(form.system.without_speeds, form.ring, programs).states(4 * POINTS):
        place = on_manifold.enclosed if form.by_quaternion else on_manifold
        with suppress(*NOT_THERE):
            state = completed(Oracle(form.system, place.state))
            carry = Carrier(form.ring, state.numbers, state.values)
            at_points.append([[carry(x) for x in row.partials] for row in rows])
        if len(at_points) == POINTS:
            break
    return at_points
