"""Problem 3 with constraints: the equations with multipliers, and those without.

    M q'' = f + J^T lambda,    J q'' + gamma = 0           with multipliers, J of the independent rows
    Y^T M Y u' = Y^T (f - M a0),   q' = Y u + y0           embedded (Maggi's equations)

with q'' = Y u' + a0.  M and f are those of the open tree.  In the embedded equations the dependent velocities are
expressed by the independent ones; the dependent coordinates stay, and phi(q, t) = 0 goes with them.  In speeds of their
own it is the same with these for q', and with Kane's equations of the tree.

Sources: G. A. Maggi, Principii di stereodinamica (1901); Neimark & Fufaev, chapter 3.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from typing import Any

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.signs import Signs
from mbsym.expressions.rates import velocity_name
from mbsym.formulas.formula import Matrix, column
from mbsym.mechanics.constraints.embedding import projected
from mbsym.mechanics.expansion import echelon
from mbsym.mechanics.speeds import SpeedForm
from mbsym.problems.constraints.result import Constraints, Solved
from mbsym.problems.equations import Embedded, Equations

#: A coordinate h, and the W with which its shift, and q' -> q' + W q', is a symmetry: entries that are not 0.
Turned = tuple[str, Mapping[tuple[str, str], Any]]


def embedded_equations(form: SpeedForm, equations: Equations, constraints: Constraints) -> Embedded:
    """The equations without multipliers, of the equations of the tree.  Raises NoClosedForm beyond the budget."""
    if constraints.solved is None:
        raise NoClosedForm("the dependent velocities have no closed form within the budget of terms")
    ring, forcing = form.ring, [x.polynomial for x in equations.forcing]
    matrix, right = projected(ring, constraints.solved.embedding, equations.mass_matrix.polynomials, forcing)
    images = dependent_velocities(form, constraints.solved)
    right = [ring.reduce(ring.substitute(x, images)) for x in right]
    return Embedded(constraints.free, Matrix.of(ring, matrix), column(ring, right))


def oscillating_position(ring: Ring, embedded: Embedded, coordinates: Sequence[str]) -> str:
    """The one position q with  M(q) (q', w)' = f(q, q', w)  where a reversal of q' alone reverses the time; "" if none.

    M has no entry between q and w, the equation of q is even in q', and those of w are q' times functions of q and w:

        w' = q' A(q, w),    q'' = F(q, q'^2, w).

    So w is a function of q along every motion, w = w(q; c), with as many constants c as there are velocities w: bodies
    of revolution that roll on a plane (Chaplygin 1897, Appell and Korteweg 1899), where no integral has a closed form.
    """
    moving = felt_coordinates(ring, embedded, coordinates)
    if moving is None or len(moving) != 1 or len(embedded.free) == 1:
        return ""
    matrix, forcing = embedded.mass_matrix.polynomials, [x.polynomial for x in embedded.forcing]
    place = embedded.free.index(moving[0])
    reversed_rate = {ring.index("velocity", moving[0]): -ring.generator("velocity", moving[0])}
    for i, force in enumerate(forcing):
        parity = ring.one if i == place else -ring.one
        if not ring.reduce(ring.substitute(force, reversed_rate) - parity * force).is_zero():
            return ""
        if i != place and not (matrix[i][place].is_zero() and _is_linear(ring, force, velocity_name(moving[0]))):
            return ""
    return moving[0]


def steady_motions(
    ring: Ring,
    embedded: Embedded,
    coordinates: Sequence[str],
    idle: Sequence[str],
    at: Mapping[int, Polynomial],
    signs: Signs,
    images: Mapping[int, Polynomial],
    turned: Turned | None = None,
) -> int | None:
    """The dimension of the manifold of steady motions near one, ``idle`` coordinates not counted; None if not shown.

    Steady are positions q that rest and velocities w with f(q, 0, w) = 0; of positions whose velocities are dependent
    (``images`` by independent ones) these have to vanish.  A heading h is not counted whose shift is a symmetry with a
    linear map W of velocities (``turned``): motions are steady, too, that are turned at a constant rate, w' = h' W q',

        f(q, 0, w) - M h' W q' = 0            at one h.

    Rows that vanish, or vanish where others do that are linear in a velocity, say nothing; there is a manifold where
    the rows that are left are as many as their rank ``at`` the motion (implicit functions), by pivots that are shown
    not to vanish.
    """
    heading, turns = turned or ("", {})
    felt = _felt(ring, embedded, coordinates)
    if felt is None:
        return None
    felt = tuple(name for name in felt if name != heading)
    following = [name for name in felt if name not in embedded.free]
    resting = {ring.index("velocity", name): ring.zero for name in felt if name in embedded.free}
    if any(not ring.reduce(at[index]).is_zero() for index in resting):
        return None
    slice_ = {k: x for k, x in at.items() if heading and ring.depends_on(ring.context.gen(k), heading)}

    def there(x: Polynomial) -> Polynomial:
        return ring.reduce(ring.substitute(ring.substitute(ring.substitute(x, dict(images)), resting), slice_))

    def velocity(name: str) -> Polynomial:
        return there(ring.generator("velocity", name))

    turning = [
        ring.reduce(velocity(heading) * sum((velocity(j) * x for (i, j), x in turns.items() if i == name), ring.zero))
        if heading
        else ring.zero
        for name in embedded.free
    ]
    rows = [
        ring.reduce(there(x.polynomial) - ring.dot([there(y) for y in row], turning))
        for x, row in zip(embedded.forcing, embedded.mass_matrix.polynomials, strict=True)
    ]
    rows += map(velocity, following)
    if any(ring.dependencies(x, [name for name in coordinates if name not in felt]) for x in rows):
        return None
    gliding = [name for name in embedded.free if name not in felt]
    variables = (*felt, *map(velocity_name, gliding))
    dimension = len(gliding) + len({*felt} - {*idle})
    while rows := [row for row in rows if not row.is_zero()]:
        slopes: list[Mapping[Hashable, Polynomial]] = [
            {k: ring.substitute(ring.derivative(row, name), at) for k, name in enumerate(variables)} for row in rows
        ]
        rank = echelon(ring, signs, slopes, range(len(variables)))
        if len(rank.pivots) == len(rows) and not rank.assumed:
            return dimension - len(rows)
        left = _eliminated(ring, rows, gliding, at, signs)
        if left is None:
            return None
        rows, dimension = left, dimension - 1
    return dimension


def _eliminated(
    ring: Ring, rows: Sequence[Polynomial], coordinates: Sequence[str], at: Mapping[int, Polynomial], signs: Signs
) -> list[Polynomial] | None:
    """The other rows with the velocity w of a coordinate put in, by a row a w + b = 0, a != 0; None without one."""
    for i, row in enumerate(rows):
        for coordinate in coordinates:
            name = velocity_name(coordinate)
            factor = ring.derivative(row, name)
            if not _is_linear(ring, row, name) or not signs.never_zero(ring.substitute(factor, at)):
                continue
            nothing = {ring.index("velocity", coordinate): ring.zero}
            rest = ring.substitute(row, nothing)
            others = []
            for other in (*rows[:i], *rows[i + 1 :]):
                powers, slope, count = [], other, 1  # of w in the other row: its coefficients
                while not slope.is_zero():
                    powers.append(ring.substitute(slope, nothing))
                    slope = ring.reduce(ring.derivative(slope, name)) / count
                    count += 1
                total = ring.zero
                for k, coefficient in enumerate(powers):
                    total = total + coefficient * (-rest) ** k * factor ** (len(powers) - 1 - k)
                others.append(ring.reduce(total))
            return others
    return None


def felt_coordinates(ring: Ring, embedded: Embedded, coordinates: Sequence[str]) -> tuple[str, ...] | None:
    """The coordinates that the equations depend on.

    None where these are not analytic, or know other velocities or the time: sin(chi) of a prescribed angle is a sine.
    None, too, where the velocity of one is dependent.
    """
    felt = _felt(ring, embedded, coordinates)
    return felt if felt is not None and {*felt} <= {*embedded.free} else None


def _felt(ring: Ring, embedded: Embedded, coordinates: Sequence[str]) -> tuple[str, ...] | None:
    entries = [*(x for row in embedded.mass_matrix.polynomials for x in row), *(x.polynomial for x in embedded.forcing)]
    held = [ring.generators[k] for k in ring.held(entries)]
    if any(g.kinked or (g.kind == "velocity" and g.name not in embedded.free) for g in held):
        return None
    running = [g.name for g in ring.generators if g.kind in ("prescribed", "time")]
    if any(ring.dependencies(x, running) for x in entries):
        return None
    return tuple(name for name in coordinates if any(ring.depends_on(x, name) for x in entries))


def _is_linear(ring: Ring, p: Polynomial, name: str) -> bool:
    return bool(ring.reduce(ring.derivative(ring.derivative(p, name), name)).is_zero())


def dependent_velocities(form: SpeedForm, solved: Solved) -> dict[int, Polynomial]:
    """The generators of the dependent speeds or velocities, and what they are: S u + s."""
    ring, embedding = form.ring, solved.embedding
    free = [ring.context.gen(form.speeds[k].index) for k in embedding.free]
    return {
        form.speeds[k].index: ring.reduce(sum((ring.times(x, u) for x, u in zip(row, free, strict=True)), shift))
        for k, row, shift in zip(embedding.dependent, embedding.matrix, embedding.shift, strict=True)
    }
