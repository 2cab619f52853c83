"""Arithmetic of formulas; SymPy, which knows nothing of our ring, computes the same."""

from __future__ import annotations

import copy
import pickle
from fractions import Fraction
from typing import Any

import pytest
import sympy
from conftest import SHIPPED

import mbsym
from mbsym.algebra.failures import SingularPoint
from mbsym.formulas.formula import Formula
from mbsym.report.conditions import statements

PENDULUM = mbsym.load(SHIPPED / "simple-pendulum.yaml")
TOP = mbsym.load(SHIPPED / "heavy-top.yaml")
T, U = PENDULUM.energy.kinetic_energy, PENDULUM.energy.force_function

OPERATIONS = [
    lambda t, u: t + u,
    lambda t, u: t - u,
    lambda t, u: 3 * t * u - 2,
    lambda t, u: 1 - t / (u + 2),
    lambda t, u: u / 3 - t**2,
    lambda t, u: (2 + t) ** -2 * u,
    lambda t, u: -u + +t,
    lambda t, u: 2 / (1 + t * t),
]


def same(formula: Formula, expected: Any) -> bool:
    return bool(sympy.simplify(sympy.sympify(formula) - expected) == 0)


@pytest.mark.parametrize("operation", OPERATIONS)
def test_it_is_that_of_sympy(operation: Any) -> None:
    found = operation(T, U)
    assert isinstance(found, Formula)
    assert same(found, operation(T.to_sympy(), U.to_sympy()))
    assert not same(found + 1, operation(T.to_sympy(), U.to_sympy()))


def test_fractions_and_half_powers_are_exact() -> None:
    assert same(Fraction(1, 3) * U, U.to_sympy() / 3)
    root = (PENDULUM.equations.mass_matrix[0, 0] + 1) ** Fraction(1, 2)
    assert same(root, sympy.sqrt(PENDULUM.equations.mass_matrix[0, 0].to_sympy() + 1))
    assert root**2 - 1 == PENDULUM.equations.mass_matrix[0, 0]
    assert (U - U).is_zero
    assert U - U == 0
    assert U * 2 / 2 == U


@pytest.mark.parametrize(
    "values",
    [
        {"m": 2, "l": Fraction(1, 2)},
        {"theta": "pi/6"},
        {"theta": "2*theta + pi/4", "m": "m + J"},
        {"theta": "0", "theta_dot": "g*l"},
        {"m": "l", "l": "m"},
    ],
)
def test_names_are_replaced_all_at_once(values: dict[str, Any]) -> None:
    found = (T + U * 3).subs(values)
    symbols = {name: sympy.Symbol(name) for name in ("m", "l", "J", "g", "theta", "theta_dot")}
    given = {symbols[name]: sympy.sympify(str(value), locals=symbols) for name, value in values.items()}
    expected = (T + U * 3).to_sympy().subs(given, simultaneous=True)
    assert same(found, expected)


def test_a_formula_replaces_a_name() -> None:
    assert same(U.subs(m=T), U.to_sympy().subs(sympy.Symbol("m"), T.to_sympy()))
    assert same(U.subs(theta=PENDULUM.equations.mass_matrix[0, 0] * 0), U.to_sympy().subs(sympy.Symbol("theta"), 0))


def test_a_condition_of_stability_joins_the_other_formulas_of_its_system() -> None:
    part = TOP.stability.subsystems[0]
    coefficient = next(statements(part.ring, part.theory.requirements)).formula
    assert coefficient is not None
    assert coefficient.ring is not TOP.ring
    total = coefficient + TOP.linearisation.K[0, 0]
    assert same(total, coefficient.to_sympy() + TOP.linearisation.K[0, 0].to_sympy())


def test_mistakes_are_told_with_a_guess() -> None:
    with pytest.raises(ValueError, match="unknown name 'thetta': did you mean 'theta'"):
        T.subs(thetta=1)
    with pytest.raises(ValueError, match="unknown name 'lenght'"):
        T.subs(l="lenght")
    with pytest.raises(ValueError, match="ends too early"):
        T.subs(m="sin(")
    with pytest.raises(ValueError, match="different systems"):
        T + TOP.energy.kinetic_energy
    with pytest.raises(TypeError, match="Fraction"):
        T + 0.5
    with pytest.raises(TypeError, match="exact"):
        T.subs(m=0.1)
    with pytest.raises(TypeError):
        T + "m"  # type: ignore[operator]
    with pytest.raises(SingularPoint):
        T / 0
    with pytest.raises(SingularPoint):
        (1 / T).subs(theta_dot=0)
    with pytest.raises(ValueError, match="whole or a half"):
        T ** Fraction(1, 3)
    with pytest.raises(AttributeError, match="did you mean 'mass_matrix'"):
        _ = PENDULUM.equations.mass_matirx  # type: ignore[attr-defined]
    with pytest.raises(AttributeError, match="did you mean 'energy'"):
        _ = PENDULUM.enrgy  # type: ignore[attr-defined]


def test_results_are_still_copied_and_have_no_surprising_attributes() -> None:
    assert copy.copy(PENDULUM.energy).cyclic == PENDULUM.energy.cyclic
    assert pickle.loads(pickle.dumps(PENDULUM.system)) == PENDULUM.system
    assert not hasattr(T, "_ipython_canary_method_should_not_exist_")
    assert not hasattr(PENDULUM.energy, "_repr_html_")
