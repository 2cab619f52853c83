"""Gradients by the adjoint equations against the variational equations, which run the other way in time."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import SHIPPED

import mbsym
from mbsym.expressions.parser import parse_expression
from mbsym.expressions.place import Complaints, Span
from mbsym.expressions.tree import Expression
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.orbits import variational as adjoint
from mbsym.numerics.orbits.variational import gradient_at_end, sensitive, split
from mbsym.numerics.scenario import scenario
from mbsym.numerics.simulate import integrated

NAMES = ("m1", "m2", "l1", "l2", "g", "theta1", "theta2_dot")


def expression(text: str) -> Expression:
    found = parse_expression(text, Complaints(), lambda start, end: Span(1, 1, 1))
    assert found is not None
    return found


def by_columns(name: str, names: tuple[str, ...], time: float) -> np.ndarray:
    given = scenario(mbsym.load(SHIPPED / f"{name}.yaml").system)
    run = integrated(sensitive(given, names), METHODS["dop853"], Setting(1e-12), [0.0, time])
    return np.array(split(run.states[:, -1], len(given.state))[1])


def test_both_ways_give_one_gradient() -> None:
    given = scenario(mbsym.load(SHIPPED / "double-pendulum.yaml").system)
    found = gradient_at_end(given, expression("l1*theta2"), NAMES, 3.0)
    columns = by_columns("double-pendulum", NAMES, 3.0)
    expected = columns[:, 1] + np.array([0, 0, found.value, 0, 0, 0, 0])  # l1 = 1 is in G itself, too
    assert np.max(np.abs(np.array(list(found.by.values())) - expected)) < 1e-8 * np.max(np.abs(expected))
    assert found.mismatch < 1e-9


def test_prescribed_motions_and_relations() -> None:
    given = scenario(mbsym.load(SHIPPED / "satellite-with-damper-driven.yaml").system)
    names = ("Lambda", "omega", "a_dot")
    found = gradient_at_end(given, expression("z"), names, 2.0)
    expected = by_columns("satellite-with-damper-driven", names, 2.0)[:, 3]
    assert np.max(np.abs(np.array(list(found.by.values())) - expected)) < 1e-8 * np.max(np.abs(expected))


def test_a_shifted_time_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    class Shifted(adjoint.Adjoint):
        def __init__(self, base: adjoint.Parametrised, time: adjoint.Fraction) -> None:
            super().__init__(base, time + adjoint.Fraction(1, 100))

    given = scenario(mbsym.load(SHIPPED / "shaken-pendulum.yaml").system)
    names = ("nu", "h", "theta")
    expected = by_columns("shaken-pendulum", names, 1.0)[:, 0]
    right = gradient_at_end(given, expression("theta"), names, 1.0)
    assert np.max(np.abs(np.array(list(right.by.values())) - expected)) < 1e-8 * np.max(np.abs(expected))
    monkeypatch.setattr(adjoint, "Adjoint", Shifted)
    assert gradient_at_end(given, expression("theta"), names, 1.0).mismatch > 1e-6


def test_a_lost_parameter_term_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    swept = adjoint.gradient
    lost = lambda program, output, inputs: (*swept(program, output, inputs)[:4], *[program.zero] * (len(inputs) - 4))  # noqa: E731
    monkeypatch.setattr(adjoint, "gradient", lost)
    with pytest.raises(AssertionError):
        test_both_ways_give_one_gradient()
