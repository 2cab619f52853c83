"""The second routes of constrained systems: placements in inertial axes at exact states on the constraint manifold.

What the rows are is taken from places alone: bodies are placed in inertial axes as series in time, and along each
coordinate, so that f, f' and f'' and J come from positions without the recursion of the rows.  The multipliers' force
is whatever is normal to all displacements that this J allows; so the equations hold if

    Z^T (M q'' - f) = 0,     Z: null space of that J

with d'Alembert's M q'' - f in inertial axes, at the accelerations that the equations give.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from flint import ctx

from mbsym.algebra.base import Algebra
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.matrices import dot, null_vectors
from mbsym.algebra.ring import Ring
from mbsym.expressions.message import Message
from mbsym.mechanics.constraints.oracle import OracleRow, oracle_rows
from mbsym.mechanics.constraints.programs import ConstrainedPrograms
from mbsym.mechanics.constraints.ranks import eliminated
from mbsym.mechanics.constraints.states import PRECISION, Manifold, OnManifold
from mbsym.mechanics.oracle import Oracle, State, TaylorSeries
from mbsym.model.system import System, acceleration_name
from mbsym.problems.checks import EXACT, FAILED, NUMERICAL, UNDECIDED, Check, Pair, _verdict
from mbsym.problems.constraints.motion import Embedded
from mbsym.problems.constraints.result import Constraints
from mbsym.problems.integrals import Integral

STATES = 3

#: The states at which constrained results are compared.
At = Callable[[OnManifold], list[Pair]]


def check_rows(system: System, ring: Ring, found: Constraints, programs: ConstrainedPrograms) -> Check:
    """f, g, dg/dt and J of every row, closed and as a program, against places in inertial axes, and the embedding.

    At states that keep the constraints; J (Y u + y0) + j = 0 there for any u.
    """
    n = len(found.coordinates)

    def pairs(one: OnManifold) -> list[Pair]:
        state = one.state
        truth = oracle_rows(system, state)
        carry = Carrier(ring, state.numbers, state.values)
        compared: list[Pair] = []
        zero = state.numbers.zero
        for i, name in enumerate(found.names):
            row: OracleRow = truth[name.constraint][max(name.component - 1, 0)]
            position = found.position[i]
            if row.position is not None and position is not None:
                compared.append((name.label, carry(position.polynomial), row.position))
            compared.append(
                (Message("rate of [[label]]", label=name.label), carry(found.velocity[i].polynomial), row.velocity)
            )
            speed = [state.values[acceleration_name(x)] for x in found.coordinates]
            bent = sum(
                (carry(found.jacobian[i, k].polynomial) * speed[k] for k in range(n)),
                carry(found.acceleration[i].polynomial),
            )
            compared.append((Message("second rate of [[label]]", label=name.label), bent, row.acceleration))
            for k, other in enumerate(found.coordinates):
                compared.append(
                    (
                        Message("[[label]] by [[other]]", label=name.label, other=other),
                        carry(found.jacobian[i, k].polynomial),
                        row.partials[k],
                    )
                )
            for place, free in enumerate(found.free if found.solved is not None else ()):
                assert found.solved is not None
                basis = found.solved.transformation
                work = sum((row.partials[k] * carry(basis[k, place].polynomial) for k in range(n)), zero)
                compared.append((Message("[[label]] along [[free]]", label=name.label, free=free), work, zero))
        nodes = [x for row in programs.jacobian for x in row] + [*programs.velocity, *programs.acceleration]
        values = programs.tree.program.evaluate(nodes, state.values, state.numbers)
        m = len(found.names)
        for i in range(m):
            for k in range(n):
                closed = carry(found.jacobian[i, k].polynomial)
                compared.append(
                    (Message("program of [[label]]", label=found.names[i].label), values[i * n + k], closed)
                )
            compared.append(
                (
                    Message("program of [[label]]", label=found.names[i].label),
                    values[m * n + m + i],
                    carry(found.acceleration[i].polynomial),
                )
            )
        return compared

    routes = ("recursion along the coordinates", "places in inertial axes")
    return compared_on_manifold("constraints", routes, system, ring, programs, pairs)


def check_embedded(
    system: System, ring: Ring, found: Constraints, embedded: Embedded, programs: ConstrainedPrograms
) -> Check:
    """The embedded equations against d'Alembert's principle in inertial axes, at accelerations that they give.

    The accelerations solve the closed embedded equations; with them the forces of inertia and loads, from another
    derivation, do no work along any displacement that the constraints allow.  Forces of constraints do none.
    """
    names = found.coordinates

    def pairs(one: OnManifold) -> list[Pair]:
        state = one.state
        carry = Carrier(ring, state.numbers, state.values)
        moved = accelerated(state, carry, found, embedded)
        oracle = Oracle(system, moved)
        residual = [oracle.residuals[name] for name in names]
        truth = oracle_rows(system, moved)
        rows = [truth[name.constraint][max(name.component - 1, 0)] for name in found.names]
        zero = state.numbers.zero
        compared: list[Pair] = [
            (Message("second rate of [[label]]", label=name.label), row.acceleration, zero)
            for name, row in zip(found.names, rows, strict=True)
        ]
        for place, y in enumerate(null_space([row.partials for row in rows], len(names), state.numbers)):
            work = dot(y, residual)
            compared.append((Message("work along displacement [[number]]", number=place + 1), work, zero))
        return compared

    routes = ("embedded equations, closed form", "d'Alembert's principle in inertial axes")
    return compared_on_manifold("constrained motion", routes, system, ring, programs, pairs)


def check_integrals(
    system: System, ring: Ring, found: Sequence[Integral], tied: Constraints, programs: ConstrainedPrograms
) -> Check:
    """dI/dt along the motion, by series in time, with the accelerations of the equations with multipliers."""

    def pairs(one: OnManifold) -> list[Pair]:
        state = with_multipliers(one.state, tied, programs)
        moving = Oracle(system, state)
        carry = Carrier(ring, TaylorSeries(state.numbers, moving.in_time), moving.in_time)
        return [(item.name, carry(item.formula.polynomial).b, state.numbers.zero) for item in found]

    routes = ("dI/dt along the motion with multipliers", "zero")
    return compared_on_manifold("first integrals", routes, system, ring, programs, pairs)


def with_multipliers(state: State, tied: Constraints, programs: ConstrainedPrograms) -> State:
    """The state with the accelerations of  M q'' - J^T lambda = f,  J q'' = -gamma,  J of the independent rows."""
    program, n, m = programs.tree.program, len(tied.coordinates), len(tied.independent)
    rows = [programs.jacobian[i] for i in tied.independent]
    nodes = [x for row in programs.tree.mass_matrix for x in row] + [x for row in rows for x in row]
    nodes += [*programs.tree.forcing, *(programs.acceleration[i] for i in tied.independent)]
    values = program.evaluate(nodes, state.values, state.numbers)
    mass, jacobian = values[: n * n], values[n * n : n * n + m * n]
    right, gamma = values[n * n + m * n : n * n + m * n + n], values[n * n + m * n + n :]
    zero = state.numbers.zero
    whole = [[*mass[i * n : i * n + n], *(-jacobian[k * n + i] for k in range(m)), right[i]] for i in range(n)]
    whole += [[*jacobian[k * n : k * n + n], *[zero] * m, -gamma[k]] for k in range(m)]
    done = eliminated(whole, range(n + m))
    if done.rank < n + m:
        raise ZeroDivisionError("the equations with multipliers are singular there")
    solved = {column: done.rows[row][n + m] for row, column in done.pivots}
    moved = {acceleration_name(name): solved[k] for k, name in enumerate(tied.coordinates)}
    return State(state.numbers, {**state.values, **moved})


def accelerated(state: State, carry: Any, found: Constraints, embedded: Embedded) -> State:
    """The state with q'' = Y u' + a0, u' from the embedded equations."""
    k, n, solved = len(found.free), len(found.coordinates), found.solved
    assert solved is not None
    rows = [
        [*(carry(embedded.mass_matrix[i, j].polynomial) for j in range(k)), carry(embedded.forcing[i].polynomial)]
        for i in range(k)
    ]
    done = eliminated(rows, range(k))
    if done.rank < k:
        raise ZeroDivisionError("Y^T M Y is singular there")
    speed = [state.numbers.zero] * k
    for row, column in done.pivots:
        speed[column] = done.rows[row][k]
    accelerations = {
        acceleration_name(name): sum(
            (carry(solved.transformation[i, j].polynomial) * speed[j] for j in range(k)),
            carry(solved.acceleration_shift[i].polynomial),
        )
        for i, name in zip(range(n), found.coordinates, strict=True)
    }
    return State(state.numbers, {**state.values, **accelerations})


def null_space(rows: Sequence[Sequence[Any]], n: int, numbers: Algebra) -> list[list[Any]]:
    """A basis of {y: J y = 0}, from J alone."""
    done = eliminated(rows, range(n))
    return null_vectors(numbers, {column: done.rows[row] for row, column in done.pivots}, n)


def compared_on_manifold(
    name: str,
    routes: tuple[str, str],
    system: System,
    ring: Ring,
    programs: ConstrainedPrograms,
    pairs: At,
    irrational: bool = False,
) -> Check:
    """Compares two routes at states that keep the constraints: rational ones, or certified enclosures.

    With ``irrational`` values are wanted that are not rational at rational states, either.
    """
    done, exact = 0, True
    with ctx.workprec(PRECISION):
        for found in Manifold(system, ring, programs).states(3 * STATES):
            one = found.enclosed if irrational else found
            try:
                outcome, detail = _verdict(pairs(one))
            except ZeroDivisionError:
                continue
            if outcome == FAILED:
                return Check(name, *routes, FAILED, detail, done)
            if outcome == EXACT:
                done += 1
                exact = exact and one.exact
            if done == STATES:
                break
    if done < STATES:
        return Check(
            name,
            *routes,
            UNDECIDED,
            Message("only [[done]] of [[wanted]] states on the constraints were found", done=done, wanted=STATES),
            done,
        )
    return Check(
        name, *routes, EXACT if exact else NUMERICAL, Message("[[done]] states on the constraints", done=done), done
    )
