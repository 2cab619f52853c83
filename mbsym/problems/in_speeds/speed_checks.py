"""The self-check of equations in speeds: against d'Alembert's principle, through velocities of the placed bodies.

With E_r = (M u' - f)_r and the oracle's residual e_i of every coordinate, at the same state,

    e_i = sum_r E_r du_r/dq'_i,

du/dq' from the spins of the bodies; the kinematic equations s' = g(s, u) are compared with the rates at that state.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from mbsym.algebra.evaluate import Carrier
from mbsym.expressions.message import Message
from mbsym.mechanics.oracle import Oracle
from mbsym.mechanics.speed_programs import speed_program
from mbsym.mechanics.speed_states import all_slopes
from mbsym.mechanics.speeds import SpeedForm
from mbsym.mechanics.states import Oracles
from mbsym.model.system import velocity_name
from mbsym.problems.checks import D_ALEMBERT, STATES, Check, Pair, compare
from mbsym.problems.in_speeds.speeds import SpeedEquations


def check_equations(truth: Oracles, found: SpeedEquations) -> Check:
    """Kane's closed equations and the kinematic ones against d'Alembert's principle."""

    def pairs(oracle: Oracle) -> list[Pair]:
        state = oracle.state
        carry = Carrier(truth.ring, state.numbers, state.values)
        mass = [[carry(entry.polynomial) for entry in row] for row in found.mass_matrix]
        errors = _errors(oracle, found.speed_rates, mass, [carry(x.polynomial) for x in found.forcing])
        balance = [carry(a.polynomial) - carry(b.polynomial) for a, b in zip(found.needed, found.supplied, strict=True)]
        names = [Message("equation [[name]] as it stands", name=u) for u in found.speeds]
        rates = [carry(x.polynomial) for x in found.rates]
        compared: list[Pair] = list(zip(names, balance, errors, strict=True))
        return compared + _against(oracle, found.speeds, found.positions, errors, rates)

    return compare(truth, "equations of motion", ("Kane, closed form", D_ALEMBERT), pairs, STATES)


def check_program(truth: Oracles, form: SpeedForm) -> Check:
    """The straight-line program in speeds against d'Alembert's principle."""
    code = speed_program(form)
    n = len(form.speeds)
    nodes = [*(x for row in code.mass_matrix for x in row), *code.forcing, *code.rates]
    speeds = [u.name for u in form.speeds]

    def pairs(oracle: Oracle) -> list[Pair]:
        values = code.program.evaluate(nodes, oracle.state.values, oracle.state.numbers)
        mass = [values[r * n : (r + 1) * n] for r in range(n)]
        forcing, rates = values[n * n : n * n + n], values[n * n + n :]
        errors = _errors(oracle, [u.rate_name for u in form.speeds], mass, forcing)
        return _against(oracle, speeds, [x.name for x in form.positions], errors, rates)

    return compare(truth, "straight-line program", ("Kane in body axes, straight-line", D_ALEMBERT), pairs, STATES)


def _errors(oracle: Oracle, rates: Sequence[str], mass: Sequence[Sequence[Any]], forcing: Sequence[Any]) -> list[Any]:
    """(M u' - f)_r at the state."""
    errors = []
    for row, force in zip(mass, forcing, strict=True):
        total = -force
        for entry, rate in zip(row, rates, strict=True):
            total = total + entry * oracle.state.values[rate]
        errors.append(total)
    return errors


def _against(
    oracle: Oracle, speeds: Sequence[str], positions: Sequence[str], errors: Sequence[Any], rates: Sequence[Any]
) -> list[Pair]:
    """e_i against sum_r E_r du_r/dq'_i, and s' against the rates at the state."""
    state, system = oracle.state, oracle.system
    columns, zero = all_slopes(oracle, speeds), state.numbers.zero
    compared: list[Pair] = []
    for i, name in enumerate(system.coordinates):
        total = sum((e * column[i] for e, column in zip(errors, columns, strict=True)), zero)
        compared.append((Message("equation [[name]]", name=name), total, oracle.residuals[name]))
    for position, rate in zip(positions, rates, strict=True):
        compared.append((f"{position}'", rate, state.values[velocity_name(position)]))
    return compared
