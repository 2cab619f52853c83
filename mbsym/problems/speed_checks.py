"""The self-check of equations in speeds: against d'Alembert's principle, through velocities of the placed bodies.

With E_r = (M u' - f)_r and the oracle's residual e_i of every coordinate, at the same state,

    e_i = sum_r E_r du_r/dq'_i,

du/dq' from the spins of the bodies; the kinematic equations s' = g(s, u) are compared with the rates at that state.
"""

from __future__ import annotations

from mbsym.algebra.evaluate import Carrier
from mbsym.mechanics.oracle import Oracle
from mbsym.mechanics.speed_states import slopes
from mbsym.mechanics.states import Oracles
from mbsym.model.system import velocity_name
from mbsym.problems.checks import D_ALEMBERT, STATES, Check, Pair, compare
from mbsym.problems.energy import Energy
from mbsym.problems.speeds import SpeedEquations


def check_equations(truth: Oracles, found: SpeedEquations) -> Check:
    """Kane's closed equations and the kinematic ones against d'Alembert's principle."""
    system = truth.system
    declared = {speed.name: speed for speed in system.speeds}

    def pairs(oracle: Oracle) -> list[Pair]:
        state = oracle.state
        carry = Carrier(truth.ring, state.numbers, state.values)
        errors = []
        for r, row in enumerate(found.mass_matrix):
            total = -carry(found.forcing[r].polynomial)
            for entry, rate in zip(row, found.speed_rates, strict=True):
                total = total + carry(entry.polynomial) * state.values[rate]
            errors.append(total)
        balance = [carry(a.polynomial) - carry(b.polynomial) for a, b in zip(found.needed, found.supplied, strict=True)]
        compared: list[Pair] = list(
            zip([f"equation {u} as it stands" for u in found.speeds], balance, errors, strict=True)
        )
        columns = []
        for u in found.speeds:
            if u in declared:
                columns.append(slopes(oracle, declared[u]))
            else:
                one, zero = state.numbers.one, state.numbers.zero
                columns.append([one if velocity_name(name) == u else zero for name in system.coordinates])
        for i, name in enumerate(system.coordinates):
            total = sum((e * column[i] for e, column in zip(errors, columns, strict=True)), state.numbers.zero)
            compared.append((f"equation {name}", total, oracle.residuals[name]))
        for position, derived in zip(found.positions, found.rates, strict=True):
            compared.append((f"{position}'", carry(derived.polynomial), state.values[velocity_name(position)]))
        return compared

    return compare(truth, "equations of motion", ("Kane, closed form", D_ALEMBERT), pairs, STATES)


def check_energy(truth: Oracles, energy: Energy, speeds: tuple[str, ...]) -> Check:
    """T, its parts by powers of the speeds, and U against sums over bodies in inertial axes."""

    def pairs(oracle: Oracle) -> list[Pair]:
        state = oracle.state
        carry = Carrier(truth.ring, state.numbers, state.values)
        u = [state.values[name] for name in speeds]
        half = state.numbers.reciprocal(state.numbers.number(2))
        parts = carry(energy.A0.polynomial)
        for r, first in enumerate(u):
            parts = parts + carry(energy.A1[r].polynomial) * first
            for s, second in enumerate(u):
                parts = parts + half * carry(energy.A2[r, s].polynomial) * first * second
        return [
            ("kinetic energy", carry(energy.kinetic_energy.polynomial), oracle.kinetic_energy),
            ("A2, A1, A0", parts, oracle.kinetic_energy),
            ("force function", carry(energy.force_function.polynomial), oracle.force_function),
        ]

    return compare(truth, "energy", ("recursion in body axes", "sums in inertial axes"), pairs)
