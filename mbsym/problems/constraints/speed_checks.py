"""The second routes of constraints in speeds: places in inertial axes, and multipliers in coordinates.

At states that keep the constraints the values of speeds, unit vectors and their rates are read off the placed bodies
(``speed_states``).  There the rows in speeds must be those of the places, J du/dq' that of the coordinates; and the
accelerations of the equations with multipliers in coordinates, told in speeds, must satisfy the embedded equations.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.matrices import dot
from mbsym.expressions.message import Message
from mbsym.mechanics.constraints.oracle import oracle_rows
from mbsym.mechanics.constraints.programs import ConstrainedPrograms
from mbsym.mechanics.constraints.states import OnManifold
from mbsym.mechanics.oracle import Oracle
from mbsym.mechanics.speed_states import completed, slopes
from mbsym.mechanics.speeds import SpeedForm
from mbsym.model.system import velocity_name
from mbsym.problems.checks import Check, Pair
from mbsym.problems.constraints.checks import compared_on_manifold, null_space, with_multipliers
from mbsym.problems.constraints.motion import Embedded
from mbsym.problems.constraints.result import Constraints
from mbsym.problems.integrals import Integral


def check_rows(form: SpeedForm, found: Constraints, programs: ConstrainedPrograms) -> Check:
    """f, g, dg/dt of every row, J du/dq', and J V = 0."""
    system, rates = form.system, [u.rate_name for u in form.speeds]

    def pairs(one: OnManifold) -> list[Pair]:
        oracle = Oracle(system, one.state)
        state = completed(oracle)
        truth = oracle_rows(system, one.state)
        carry = Carrier(form.ring, state.numbers, state.values)
        columns, zero = _columns(form, oracle), state.numbers.zero
        compared: list[Pair] = []
        for i, name in enumerate(found.names):
            row, position = truth[name.constraint][max(name.component - 1, 0)], found.position[i]
            if row.position is not None and position is not None:
                compared.append((name.label, carry(position.polynomial), row.position))
            compared.append(
                (Message("rate of [[label]]", label=name.label), carry(found.velocity[i].polynomial), row.velocity)
            )
            own = [carry(x) for x in found.jacobian.polynomials[i]]
            bent = sum((x * state.values[rate] for x, rate in zip(own, rates, strict=True)), zero)
            second = bent + carry(found.acceleration[i].polynomial)
            compared.append((Message("second rate of [[label]]", label=name.label), second, row.acceleration))
            for k, other in enumerate(system.coordinates):
                slope = sum((x * column[k] for x, column in zip(own, columns, strict=True)), zero)
                compared.append(
                    (Message("[[label]] by [[other]]", label=name.label, other=other), slope, row.partials[k])
                )
            for place, free in enumerate(found.free if found.solved is not None else ()):
                assert found.solved is not None
                basis = [carry(x[place]) for x in found.solved.transformation.polynomials]
                work = dot(own, basis)
                compared.append((Message("[[label]] along [[free]]", label=name.label, free=free), work, zero))
        return compared

    routes = ("speeds of the bodies", "places in inertial axes")
    return compared_on_manifold(
        "constraints", routes, system.without_speeds, form.ring, programs, pairs, bool(form.by_quaternion)
    )


def check_embedded(
    form: SpeedForm, found: Constraints, embedded: Embedded, tied: Constraints, programs: ConstrainedPrograms
) -> Check:
    """V^T M V v' = V^T (f - M a0) and u' = V v' + a0 at the accelerations of the equations with multipliers.

    These, in turn, leave d'Alembert's forces in inertial axes without work along what the constraints allow.
    """
    system, by_name = form.system, {u.name: u for u in form.speeds}

    def pairs(one: OnManifold) -> list[Pair]:
        moving = with_multipliers(one.state, tied, programs)
        oracle = Oracle(system, moving)
        state = completed(oracle)
        carry, zero = Carrier(form.ring, state.numbers, state.values), state.numbers.zero
        own = [state.values[by_name[name].rate_name] for name in found.free]
        compared: list[Pair] = []
        for name, row, force in zip(found.free, embedded.mass_matrix.polynomials, embedded.forcing, strict=True):
            left = sum((carry(x) * rate for x, rate in zip(row, own, strict=True)), zero)
            compared.append((Message("equation of [[name]]", name=name), left, carry(force.polynomial)))
        assert found.solved is not None
        for u, row, shift in zip(
            form.speeds, found.solved.transformation.polynomials, found.solved.acceleration_shift, strict=True
        ):
            right = sum((carry(x) * rate for x, rate in zip(row, own, strict=True)), carry(shift.polynomial))
            compared.append((f"{u.name}'", state.values[u.rate_name], right))
        truth = oracle_rows(system, moving)
        rows = [truth[name.constraint][max(name.component - 1, 0)].partials for name in found.names]
        residual = [oracle.residuals[name] for name in system.coordinates]
        for place, y in enumerate(null_space(rows, len(system.coordinates), state.numbers)):
            work = dot(y, residual)
            compared.append((Message("work along displacement [[number]]", number=place + 1), work, zero))
        return compared

    routes = ("embedded equations in speeds", "d'Alembert's principle in inertial axes, with multipliers")
    return compared_on_manifold(
        "constrained motion", routes, system.without_speeds, form.ring, programs, pairs, bool(form.by_quaternion)
    )


def check_integrals(
    form: SpeedForm, found: Sequence[Integral], tied: Constraints, programs: ConstrainedPrograms
) -> Check:
    """dI/dt with the rates of all variables at the accelerations of the equations with multipliers."""
    rates = [form.rate(item.formula.polynomial) for item in found]

    def pairs(one: OnManifold) -> list[Pair]:
        state = completed(Oracle(form.system, with_multipliers(one.state, tied, programs)))
        carry = Carrier(form.ring, state.numbers, state.values)
        return [(item.name, carry(x), state.numbers.zero) for item, x in zip(found, rates, strict=True)]

    routes = ("dI/dt along the motion with multipliers", "zero")
    return compared_on_manifold(
        "first integrals", routes, form.system.without_speeds, form.ring, programs, pairs, bool(form.by_quaternion)
    )


def _columns(form: SpeedForm, oracle: Oracle) -> list[list[Any]]:
    """du_r/dq'_i, from the spins of the placed bodies."""
    declared = {speed.name: speed for speed in form.system.speeds}
    one, zero = oracle.numbers.one, oracle.numbers.zero
    return [
        slopes(oracle, declared[u.name])
        if u.name in declared
        else [one if velocity_name(name) == u.name else zero for name in form.system.coordinates]
        for u in form.speeds
    ]
