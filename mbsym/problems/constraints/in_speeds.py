"""Constraints in speeds u: what is known in coordinates, told in the variables.

    J u + j = 0,   J u' + gamma = 0           J = J_q Y of  q' = Y (u - s0): of the same rank
    u = V v + v0,  u' = V v' + a0             v: the independent speeds

Which rows are independent, redundant, integrable is a matter of the directions in which the system can move, whatever
they are told by: it is found once, in coordinates (``analysis``).

Source: Kane & Levinson, Dynamics: Theory and Applications (1985), sections 2.13, 4.4 (nonholonomic partial velocities).
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

from flint import ctx

from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import NOT_THERE, Constrained, NoClosedForm
from mbsym.expressions.message import Message
from mbsym.formulas.formula import Formula, Matrix, column
from mbsym.mechanics.constraints.embedding import Pivots, choose, embedded
from mbsym.mechanics.constraints.programs import ConstrainedPrograms
from mbsym.mechanics.constraints.ranks import eliminated
from mbsym.mechanics.constraints.rows import Row
from mbsym.mechanics.constraints.speed_rows import speed_rows
from mbsym.mechanics.constraints.states import PRECISION, Manifold
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import places
from mbsym.mechanics.oracle import Oracle
from mbsym.mechanics.speed_states import completed
from mbsym.mechanics.speeds import SpeedForm
from mbsym.model.system import velocity_name
from mbsym.problems.constraints.analysis import POINTS, Fault, Unsound, regular_at
from mbsym.problems.constraints.result import Constraints, Solved


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
        solved=None if embedding is None else Solved.of(ring, embedding),
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
