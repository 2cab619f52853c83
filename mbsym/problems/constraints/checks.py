"""The second routes of constrained systems: placements in inertial axes at exact states on the constraint manifold.

What the rows are is taken from places alone: bodies are placed in inertial axes as series in time, and along each
coordinate, so that f, f' and f'' and J come from positions without the recursion of the rows.  Values of speeds, unit
vectors and their rates are read off the placed bodies (``speed_states``).  The multipliers' force
is whatever is normal to all displacements that this J allows; so the equations hold if

    Z^T (M q'' - f) = 0,     Z: null space of that J

with d'Alembert's M q'' - f in inertial axes, at the accelerations of the equations with multipliers, which the embedded
equations must have, too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from flint import ctx

from mbsym.algebra.base import Algebra
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.matrices import dot, null_vectors
from mbsym.expressions.message import Message
from mbsym.mechanics.constraints.oracle import oracle_rows
from mbsym.mechanics.constraints.programs import ConstrainedPrograms
from mbsym.mechanics.constraints.ranks import eliminated
from mbsym.mechanics.constraints.states import PRECISION, Manifold, OnManifold
from mbsym.mechanics.oracle import Oracle, State
from mbsym.mechanics.programs import accelerated
from mbsym.mechanics.speed_states import all_slopes, completed, in_time
from mbsym.mechanics.speeds import SpeedForm
from mbsym.model.system import acceleration_name
from mbsym.problems.checks import EXACT, FAILED, NUMERICAL, UNDECIDED, Check, Pair, _verdict
from mbsym.problems.constraints.motion import Embedded
from mbsym.problems.constraints.result import Constraints
from mbsym.problems.integrals import Integral

STATES = 3

#: The states at which constrained results are compared.
At = Callable[[OnManifold], list[Pair]]


def check_rows(form: SpeedForm, constraints: Constraints, programs: ConstrainedPrograms) -> Check:
    """f, g, dg/dt and J of every row, closed and as a program in coordinates, against places in inertial axes; J Y = 0.

    At states that keep the constraints; in speeds of their own J du/dq' is that of the coordinates.
    """
    system, rates, n = form.system, [u.rate_name for u in form.speeds], len(form.system.coordinates)
    nodes = [*(x for row in programs.jacobian for x in row), *programs.acceleration]

    def pairs(on_manifold: OnManifold) -> list[Pair]:
        oracle = Oracle(system, on_manifold.state)
        state = completed(oracle)
        truth = oracle_rows(system, on_manifold.state)
        carry = Carrier(form.ring, state.numbers, state.values)
        columns, zero = all_slopes(oracle, [u.name for u in form.speeds]), state.numbers.zero
        second = [state.values[acceleration_name(name)] for name in system.coordinates]
        values = programs.tree.program.evaluate(nodes, on_manifold.state.values, on_manifold.state.numbers)
        compared: list[Pair] = []
        for i, name in enumerate(constraints.names):
            row, position = truth[name.constraint][max(name.component - 1, 0)], constraints.position[i]
            if row.position is not None and position is not None:
                compared.append((name.label, carry(position.polynomial), row.position))
            own = [carry(x) for x in constraints.jacobian.polynomials[i]]
            slopes = [sum((x * y[k] for x, y in zip(own, columns, strict=True)), zero) for k in range(n)]
            bent = sum((x * state.values[rate] for x, rate in zip(own, rates, strict=True)), zero)
            coded = values[i * n : (i + 1) * n]
            turned = sum((x * y for x, y in zip(coded, second, strict=True)), zero)
            label, in_code = name.label, Message("program of [[label]]", label=name.label)
            compared += [
                (Message("rate of [[label]]", label=label), carry(constraints.velocity[i].polynomial), row.velocity),
                (
                    Message("second rate of [[label]]", label=label),
                    bent + carry(constraints.acceleration[i].polynomial),
                    row.acceleration,
                ),
                *(
                    (Message("[[label]] by [[other]]", label=label, other=other), x, y)
                    for other, x, y in zip(system.coordinates, slopes, row.partials, strict=True)
                ),
                *((in_code, x, y) for x, y in zip(coded, row.partials, strict=True)),
                (in_code, turned + values[len(constraints.names) * n + i], row.acceleration),
            ]
            for place, free in enumerate(constraints.free if constraints.solved is not None else ()):
                assert constraints.solved is not None
                work = dot(own, [carry(x[place]) for x in constraints.solved.transformation.polynomials])
                compared.append((Message("[[label]] along [[free]]", label=label, free=free), work, zero))
        return compared

    routes = ("speeds of the bodies" if system.speeds else "recursion along the coordinates", "places in inertial axes")
    return compared_on_manifold("constraints", routes, form, programs, pairs)


def check_embedded(
    form: SpeedForm, constraints: Constraints, embedded: Embedded, programs: ConstrainedPrograms
) -> Check:
    """Y^T M Y v' = Y^T (f - M a0) and u' = Y v' + a0 at the accelerations of the equations with multipliers.

    With these the forces of inertia and loads, from another derivation, d'Alembert's in inertial axes, do no work along
    any displacement that the constraints allow.  Forces of constraints do none.
    """
    system = form.system

    def pairs(on_manifold: OnManifold) -> list[Pair]:
        state = moving(form, on_manifold, constraints, programs)
        oracle = Oracle(system, state)
        carry, zero = Carrier(form.ring, state.numbers, state.values), state.numbers.zero
        assert constraints.solved is not None
        own = [state.values[form.speeds[k].rate_name] for k in constraints.solved.embedding.free]
        truth = oracle_rows(system, state)
        rows = [truth[name.constraint][max(name.component - 1, 0)] for name in constraints.names]
        compared: list[Pair] = [
            (Message("second rate of [[label]]", label=name.label), row.acceleration, zero)
            for name, row in zip(constraints.names, rows, strict=True)
        ]
        for name, row, force in zip(constraints.free, embedded.mass_matrix.polynomials, embedded.forcing, strict=True):
            left = sum((carry(x) * rate for x, rate in zip(row, own, strict=True)), zero)
            compared.append((Message("equation of [[name]]", name=name), left, carry(force.polynomial)))
        for u, row, shift in zip(
            form.speeds,
            constraints.solved.transformation.polynomials,
            constraints.solved.acceleration_shift,
            strict=True,
        ):
            right = sum((carry(x) * rate for x, rate in zip(row, own, strict=True)), carry(shift.polynomial))
            compared.append((f"{u.name}'", state.values[u.rate_name], right))
        residual = [oracle.residuals[name] for name in system.coordinates]
        for place, y in enumerate(null_space([x.partials for x in rows], len(residual), state.numbers)):
            work = dot(y, residual)
            compared.append((Message("work along displacement [[number]]", number=place + 1), work, zero))
        return compared

    routes = ("embedded equations, closed form", "d'Alembert's principle in inertial axes")
    if system.speeds:
        routes = ("embedded equations in speeds", "d'Alembert's principle in inertial axes, with multipliers")
    return compared_on_manifold("constrained motion", routes, form, programs, pairs)


def check_integrals(
    form: SpeedForm, integrals: Sequence[Integral], tied: Constraints, programs: ConstrainedPrograms
) -> Check:
    """dI/dt along the motion, by series in time, with the accelerations of the equations with multipliers."""

    def pairs(on_manifold: OnManifold) -> list[Pair]:
        carry = in_time(form.ring, Oracle(form.system, moving(form, on_manifold, tied, programs)))
        return [(item.name, carry(item.formula.polynomial).b, on_manifold.state.numbers.zero) for item in integrals]

    return compared_on_manifold(
        "first integrals", ("dI/dt along the motion with multipliers", "zero"), form, programs, pairs
    )


def moving(form: SpeedForm, on_manifold: OnManifold, tied: Constraints, programs: ConstrainedPrograms) -> State:
    """The state with the accelerations of  M q'' - J^T lambda = f,  J q'' = -gamma,  J of the independent rows.

    In enclosures where quaternions are no rational numbers; values of all variables are told, read off placed bodies.
    """
    state = (on_manifold.enclosed if form.by_quaternion else on_manifold).state
    rows = [programs.jacobian[i] for i in tied.independent]
    needed = [programs.acceleration[i] for i in tied.independent]
    return completed(Oracle(form.system, accelerated(form.system, state, programs.tree, rows, needed)))


def null_space(rows: Sequence[Sequence[Any]], n: int, numbers: Algebra) -> list[list[Any]]:
    """A basis of {y: J y = 0}, from J alone."""
    done = eliminated(rows, range(n))
    return null_vectors(numbers, {column: done.rows[row] for row, column in done.pivots}, n)


def compared_on_manifold(
    name: str, routes: tuple[str, str], form: SpeedForm, programs: ConstrainedPrograms, pairs: At
) -> Check:
    """Compares two routes at states that keep the constraints: rational ones, or certified enclosures.

    Enclosures, too, where quaternions are wanted, which are not rational at rational states.
    """
    done, exact = 0, True
    with ctx.workprec(PRECISION):
        for state in Manifold(form.system.without_speeds, form.ring, programs).states(3 * STATES):
            on_manifold = state.enclosed if form.by_quaternion else state
            try:
                outcome, detail = _verdict(pairs(on_manifold))
            except ZeroDivisionError:
                continue
            if outcome == FAILED:
                return Check(name, *routes, FAILED, detail, done)
            if outcome == EXACT:
                done += 1
                exact = exact and on_manifold.exact
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
