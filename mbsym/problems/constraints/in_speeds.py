"""Constraints and the equations without multipliers in speeds u: what is known in coordinates, told in the variables.

    J u + j = 0,   J u' + gamma = 0           J = J_q Y of  q' = Y (u - s0): of the same rank
    u = V v + v0,  u' = V v' + a0             v: the independent speeds
    V^T M V v' = V^T (f - M a0)               Kane's equations projected (Maggi); no multipliers

Which rows are independent, redundant, integrable is a matter of the directions in which the system can move, whatever
they are told by: it is found once, in coordinates (``analysis``).

Source: Kane & Levinson, Dynamics: Theory and Applications (1985), sections 2.13, 4.4 (nonholonomic partial velocities).
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from typing import Any

from flint import ctx

from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import NOT_THERE, Constrained, Failure, NoClosedForm
from mbsym.algebra.matrices import cramer, determinant
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message
from mbsym.formulas.formula import Formula, Matrix, column
from mbsym.mechanics.constraints.embedding import Embedding, Pivots, basis_vector, choose, embedded, projected
from mbsym.mechanics.constraints.programs import ConstrainedPrograms
from mbsym.mechanics.constraints.ranks import eliminated
from mbsym.mechanics.constraints.rows import Row
from mbsym.mechanics.constraints.speed_rows import speed_rows
from mbsym.mechanics.constraints.states import PRECISION, Manifold
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.oracle import Oracle
from mbsym.mechanics.speed_states import completed
from mbsym.mechanics.speeds import SpeedForm
from mbsym.model.system import velocity_name
from mbsym.problems.constraints.analysis import POINTS, Fault, Unsound, regular_at
from mbsym.problems.constraints.motion import Embedded
from mbsym.problems.constraints.result import Constraints, Solved
from mbsym.problems.energy import Energy
from mbsym.problems.in_speeds.speed_integrals import GEOMETRIC, Field, candidates, is_new, rate
from mbsym.problems.in_speeds.speeds import SpeedEquations
from mbsym.problems.integrals import ENERGY, Integral


def constraints_in_speeds(
    form: SpeedForm, scene: Scene, tied: Constraints, programs: ConstrainedPrograms
) -> Constraints:
    """The constraints ``tied`` (in coordinates) in speeds; ``programs`` are those in coordinates.

    Raises Unsound where the dependent set of the description cannot be solved for, Constrained, NoClosedForm.
    """
    ring, names = form.ring, tuple(u.name for u in form.speeds)
    rows = speed_rows(form, scene, tied.names)
    pivots = _pivots(form, rows, tied, programs)
    still = {u.index: ring.zero for u in form.speeds}
    sides = [(ring.substitute(row.velocity, still), row.acceleration) for row in rows]
    try:
        found = embedded(ring, [row.partials for row in rows], sides, pivots)
    except NoClosedForm:
        found = None
    return replace(
        tied,
        position=tuple(None if row.position is None else Formula(ring, row.position) for row in rows),
        velocity=column(ring, [row.velocity for row in rows]),
        jacobian=Matrix.of(ring, [list(row.partials) for row in rows]),
        acceleration=column(ring, [row.acceleration for row in rows]),
        coordinates=names,
        dependent=tuple(names[k] for k in pivots.columns),
        pivots=pivots,
        solved=None if found is None else _solved(ring, found),
        in_speeds=True,
    )


def embedded_in_speeds(form: SpeedForm, equations: SpeedEquations, found: Constraints) -> Embedded:
    """The equations of the independent speeds.  Raises NoClosedForm where they outgrow the budget."""
    if found.solved is None:
        raise NoClosedForm("the dependent speeds have no closed form within the budget of terms")
    ring, n = form.ring, len(found.coordinates)
    mass = [[equations.mass_matrix[i, j].polynomial for j in range(n)] for i in range(n)]
    forcing = [x.polynomial for x in equations.forcing]
    matrix, right = projected(ring, found.solved.embedding, mass, forcing)
    images = dependent_speeds(form, found, found.solved)
    right = [ring.reduce(ring.substitute(x, images)) for x in right]
    return Embedded(found.free, Matrix.of(ring, matrix), column(ring, right))


def dependent_speeds(form: SpeedForm, found: Constraints, solved: Solved) -> dict[int, Polynomial]:
    """The generators of the dependent speeds, and what they are in the independent ones."""
    ring, by_name = form.ring, {u.name: u for u in form.speeds}
    free = [ring.context.gen(by_name[name].index) for name in found.free]
    parts = zip(found.dependent, solved.embedding.matrix, solved.embedding.shift, strict=True)
    return {
        by_name[name].index: ring.reduce(sum((ring.times(x, v) for x, v in zip(row, free, strict=True)), shift))
        for name, row, shift in parts
    }


def wanted_speeds(form: SpeedForm) -> list[int]:
    """The places of the speeds that the description wants dependent: by their names, or those of coordinates."""
    named = {*form.system.dependent, *map(velocity_name, form.system.dependent)}
    return [k for k, u in enumerate(form.speeds) if u.name in named]


def _pivots(form: SpeedForm, rows: Sequence[Row], tied: Constraints, programs: ConstrainedPrograms) -> Pivots:
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
            return choose(
                form.ring, [x.partials for x in rows], tied.independent, columns, regular_at(jacobians), required
            )
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
    found: list[list[list[Any]]] = []
    for one in Manifold(form.system.without_speeds, form.ring, programs).states(4 * POINTS):
        place = one.enclosed if form.by_quaternion else one
        with suppress(*NOT_THERE):
            state = completed(Oracle(form.system, place.state))
            carry = Carrier(form.ring, state.numbers, state.values)
            found.append([[carry(x) for x in row.partials] for row in rows])
        if len(found) == POINTS:
            break
    return found


def _solved(ring: Ring, found: Embedding) -> Solved:
    """V (n x (n - r)), v0 and a0, with the rows of all speeds."""
    n = len(found.dependent) + len(found.free)
    columns = [basis_vector(ring, found, place) for place in range(len(found.free))]
    shift, acceleration = [ring.zero] * n, [ring.zero] * n
    for k, x, y in zip(found.dependent, found.shift, found.acceleration, strict=True):
        shift[k], acceleration[k] = x, y
    return Solved(
        Matrix.of(ring, [[y[k] for y in columns] for k in range(n)]),
        column(ring, shift),
        column(ring, acceleration),
        Formula(ring, found.determinant),
        found,
    )


# Problem 7 with constraints, in speeds: what  V^T M V v' = V^T (f - M a0),  u = V v + v0  keep constant.
#
# With D = det(V^T M V) an expression I(s, u, t) is an integral if
#
#     D (dI/dt at u' = 0) + grad_u I . (V adj(V^T M V) V^T (f - M a0) + D a0)  =  0
#
# identically once the dependent speeds are expressed.  Tried are those of the system without constraints
# (``speed_integrals``): the energy, the momenta of coordinates, of the whole system and of speeds.  Where multipliers
# mu are known with dI/dt = mu . (M u' - f) in the tree, constraint forces add mu . J^T lambda, and
#
#     J mu = 0    in every row on the constraints
#
# is enough, however long the equations are: mu = u - s0 of the energy, the velocities of a displacement of a momentum.


#: Equations longer than this, or with more speeds, are not tried.
MOST_TERMS, MOST_SPEEDS = 600, 4


class TiedField:
    """The vector field of a constrained system in speeds, times D."""

    def __init__(self, form: SpeedForm, tied: Constraints, solved: Solved, embedded: Embedded) -> None:
        self.form, self.tied, self.solved, self.embedded = form, tied, solved, embedded
        self.images = dependent_speeds(form, tied, solved)

    @cached_property
    def determinant(self) -> Polynomial:
        return determinant(self.form.ring, self.embedded.mass_matrix.polynomials)

    @cached_property
    def scaled(self) -> list[Polynomial]:
        """D u', by Cramer's rule."""
        ring, right = self.form.ring, [x.polynomial for x in self.embedded.forcing]
        own = cramer(ring, self.embedded.mass_matrix.polynomials, right)
        found = []
        for i, shift in enumerate(self.solved.acceleration_shift):
            row = [self.solved.transformation[i, k].polynomial for k in range(len(own))]
            found.append(ring.reduce(ring.dot(row, own) + ring.times(self.determinant, shift.polynomial)))
        return found

    def on_constraints(self, x: Polynomial) -> Polynomial:
        """x with the dependent speeds expressed."""
        return self.form.ring.reduce(self.form.ring.substitute(x, self.images))

    def keeps(self, x: Polynomial) -> bool:
        """Whether dx/dt = 0 is proved for every motion."""
        return self.form.vanishes(self.on_constraints(rate(self.form, self.determinant, self.scaled, x))) is True


def integrals(form: SpeedForm, scene: Scene, energy: Energy, equations: SpeedEquations) -> tuple[Integral, ...]:
    """All first integrals of the kinds above, each proved; of long equations those whose multipliers are known."""
    tied, embedded = equations.constraints, equations.embedded
    if tied is None:
        return ()
    field, solved = None, tied.solved
    if solved is not None and embedded is not None and embedded.terms <= MOST_TERMS:
        field = TiedField(form, tied, solved, embedded) if len(embedded.free) <= MOST_SPEEDS else None
    tree = Field(form, equations)
    found: list[Integral] = []
    known: list[Polynomial] = []
    for integral, multipliers in candidates(form, scene, energy, equations):
        x = integral.formula.polynomial
        with suppress(Failure):  # what is too long is not known to be conserved
            on = x if field is None else field.on_constraints(x)
            proved = bool(multipliers) and _without_work(form, tied, multipliers) and tree.combines(x, multipliers)
            kept = proved is True or (field is not None and field.keeps(x))
            if kept and (integral.kind == GEOMETRIC or is_new(form, on, known)):
                found.append(integral)
                if integral.kind not in (ENERGY, GEOMETRIC):
                    known.append(on)
    return tuple(found)


def _without_work(form: SpeedForm, tied: Constraints, multipliers: Sequence[Polynomial]) -> bool:
    """Whether J mu = 0 in every row where the constraints hold: by itself, or because it is J u + j."""
    ring = form.ring
    for i in range(len(tied.names)):
        g = tied.velocity[i].polynomial
        along = ring.dot([x.polynomial for x in tied.jacobian.rows[i]], multipliers)
        if not (form.vanishes(along) is True or form.vanishes(ring.reduce(along - g)) is True):
            return False
    return True
