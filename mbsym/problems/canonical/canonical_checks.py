"""Second routes for Hamilton's and Routh's forms: d'Alembert's principle in inertial axes, at random exact states.

Hamilton, at a state (q, q', q''):  p is what the differences of T in inertial axes give, p_i = (T(q' + e_i) -
T(q' - e_i))/2, and

    H(q, p, t) = p.q' - T - U,      dH/dp = q',      dp/dt - (-dH/dq + Q) = residual of d'Alembert's principle,

with dp/dt = d(dL/dq')/dt along the state.  Routh: beta is such a p of the ignored coordinates c, and

    R = T + U - beta.c',      M_R s'' - f_R = E_s - M_sc M_cc^-1 E_c      (E: the residuals),

where M_sc and M_cc are differences of residuals.  The right-hand side is what is left of E_s on the level of beta.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

from flint import arb, arb_mat, fmpq_mat

from mbsym.algebra.base import Scalar
from mbsym.algebra.evaluate import Carrier
from mbsym.expressions.message import Message, joined, worded
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.oracle import Oracle, State
from mbsym.mechanics.states import Oracles
from mbsym.mechanics.variables import ring_environment
from mbsym.model.system import acceleration_name, velocity_name
from mbsym.problems.canonical.canonical import Brackets, Hamilton, Routh, rate_along
from mbsym.problems.checks import D_ALEMBERT, FAILED, HOW_EQUAL, Check, Pair, compare, extent, how_equal
from mbsym.problems.integrals import total_rate

CANONICAL, ROUTH, BRACKETS = "canonical equations", "Routh's equations", "Poisson brackets"


def check_hamilton(truth: Oracles, found: Hamilton) -> Check:
    """p, H, dH/dp and -dH/dq + Q against sums over bodies in inertial axes."""
    system, ring, names = truth.system, found.hamiltonian.ring, truth.system.coordinates
    scene = Scene(system, ring, ring_environment(system, ring), ring, bodies=False)
    along = [total_rate(scene, x.polynomial) for x in found.momenta_in_velocities]
    rows = zip(found.velocities, found.rates, found.momenta_in_velocities, strict=True)
    lengths = {name: sum(x.terms for x in row) for name, row in zip(names, rows, strict=True)}
    chosen = extent(lengths, "equations", fixed=found.hamiltonian.terms)

    def pairs(oracle: Oracle) -> list[Pair]:
        state = oracle.state
        p = momenta_at(oracle, names)
        known = Carrier(ring, state.numbers, state.values)
        carry = Carrier(ring, state.numbers, _without(state, names) | dict(zip(found.momenta, p, strict=True)))
        legendre = -(oracle.kinetic_energy + oracle.force_function)
        for momentum, name in zip(p, names, strict=True):
            legendre = legendre + momentum * state.values[velocity_name(name)]
        compared: list[Pair] = [("H", carry(found.hamiltonian.polynomial), legendre)]
        for i, name in enumerate(names):
            if name in chosen.chosen:
                rate = known(along[i]) - carry(found.rates[i].polynomial)
                velocity = state.values[velocity_name(name)]
                compared += [
                    (
                        Message("[[momentum]]", momentum=found.momenta[i]),
                        known(found.momenta_in_velocities[i].polynomial),
                        p[i],
                    ),
                    (
                        Message("dH/d[[momentum]]", momentum=found.momenta[i]),
                        carry(found.velocities[i].polynomial),
                        velocity,
                    ),
                    (
                        Message("the rate of [[momentum]]", momentum=found.momenta[i]),
                        rate,
                        oracle.residuals[name],
                    ),
                ]
        return compared

    routes = ("Hamilton, closed form", D_ALEMBERT)
    return compare(truth, CANONICAL, routes, pairs, chosen.states, chosen.remark)


def check_routh(truth: Oracles, found: Routh) -> Check:
    """R, c' and M_R s'' = f_R against sums over bodies in inertial axes, on the level of the momenta."""
    ring = found.function.ring
    rows = zip(found.coordinates, found.mass_matrix, found.forcing, strict=True)
    lengths = {name: sum(x.terms for x in (*row, f)) for name, row, f in rows}
    fixed = found.function.terms + sum(x.terms for x in (*found.ignored_rates, *found.linear, found.reduced_potential))
    chosen = extent(lengths, "equations", fixed)

    def pairs(oracle: Oracle) -> list[Pair]:
        state = oracle.state
        beta = momenta_at(oracle, found.ignored)
        values = _without(state, found.ignored) | dict(zip(found.momenta, beta, strict=True))
        carry = Carrier(ring, state.numbers, values)
        function = oracle.kinetic_energy + oracle.force_function
        compared: list[Pair] = []
        for name, momentum, rate in zip(found.ignored, beta, found.ignored_rates, strict=True):
            velocity = state.values[velocity_name(name)]
            function = function - momentum * velocity
            compared.append((Message("the velocity of [[name]]", name=name), carry(rate.polynomial), velocity))
        compared.append(("R", carry(found.function.polynomial), function))
        compared.append((Message("the parts of R"), _by_parts(found, carry, state), function))
        needed = _on_the_level(oracle, found)
        for i, name in enumerate(found.coordinates):
            if name in chosen.chosen:
                total = -carry(found.forcing[i].polynomial)
                for j, other in enumerate(found.coordinates):
                    entry = carry(found.mass_matrix[i, j].polynomial)
                    total = total + entry * state.values[acceleration_name(other)]
                compared.append((Message("equation [[name]]", name=name), total, needed[name]))
        return compared

    routes = ("Routh, closed form", D_ALEMBERT)
    return compare(truth, ROUTH, routes, pairs, chosen.states, chosen.remark)


def check_brackets(found: Brackets, canonical: Hamilton, scene: Scene) -> Check:
    """dF/dt along the canonical equations is zero, for every first integral F that problem 7 found."""
    ring = canonical.hamiltonian.ring
    rates = [rate_along(canonical, scene, x.polynomial) for x in found.formulas]
    outcomes = [how_equal(ring, [[rate]], [[ring.zero]]) for rate in rates]
    wrong = [name for name, outcome in zip(found.names, outcomes, strict=True) if outcome == FAILED]
    outcome = max(outcomes, key=tuple(HOW_EQUAL).index) if not wrong else FAILED
    detail = (
        Message("not kept by the canonical equations: [[wrong]]", wrong=joined(map(worded, wrong), ", "))
        if wrong
        else HOW_EQUAL[outcome]
    )
    routes = ("rates of first integrals along the canonical equations", "zero, as problem 7 found them")
    return Check(BRACKETS, *routes, outcome, detail)


def momenta_at(oracle: Oracle, names: Sequence[str]) -> list[Scalar]:
    """dT/dq' of some coordinates, by differences of T, which is quadratic in q'."""
    half = oracle.state.numbers.number(Fraction(1, 2))
    scalars = []
    for name in names:
        there, back = (_moved(oracle, velocity_name(name), step).kinetic_energy for step in (1, -1))
        scalars.append((there - back) * half)
    return scalars


def _moved(oracle: Oracle, name: str, step: int) -> Oracle:
    """The oracle of the same state with one number changed."""
    state = oracle.state
    values: Mapping[str, Scalar] = {**state.values, name: state.values[name] + state.numbers.number(step)}
    return Oracle(oracle.system, State(state.numbers, values))


def _without(state: State, names: Sequence[str]) -> dict[str, Scalar]:
    """The state with other numbers for these velocities, on which a formula in momenta must not depend."""
    other = {velocity_name(name): state.numbers.number(2 * k + 3) for k, name in enumerate(names)}
    return {**state.values, **other}


def _by_parts(found: Routh, carry: Carrier, state: State) -> Scalar:
    """1/2 s'.M_R s' + b.s' - W."""
    half = state.numbers.number(Fraction(1, 2))
    speeds = [state.values[velocity_name(name)] for name in found.coordinates]
    total = -carry(found.reduced_potential.polynomial)
    for i, speed in enumerate(speeds):
        total = total + carry(found.linear[i].polynomial) * speed
        for j, other in enumerate(speeds):
            total = total + half * carry(found.mass_matrix[i, j].polynomial) * speed * other
    return total


def _on_the_level(oracle: Oracle, found: Routh) -> dict[str, Scalar]:
    """E_s - M_sc M_cc^-1 E_c by name of s.  Raises ZeroDivisionError where M_cc is singular."""
    residuals = oracle.residuals
    columns = [_moved(oracle, acceleration_name(name), 1).residuals for name in found.ignored]
    own = [[column[name] - residuals[name] for column in columns] for name in found.ignored]
    matrix: Any = arb_mat if any(isinstance(x, arb) for row in own for x in row) else fmpq_mat
    n = len(found.ignored)
    right = matrix(n, 1, [residuals[name] for name in found.ignored])
    solved = matrix(n, n, [x for row in own for x in row]).solve(right)
    left = {}
    for name in found.coordinates:
        taken = oracle.state.numbers.zero
        for k, column in enumerate(columns):
            taken = taken + (column[name] - residuals[name]) * solved[k, 0]
        left[name] = residuals[name] - taken
    return left
