"""Birkhoff's normal form: the restricted problem against Deprit & Deprit-Bartholome (1967), and planted mistakes."""

from __future__ import annotations

from dataclasses import replace

import pytest
from conftest import SHIPPED, parsed
from flint import acb, fmpq

import mbsym
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.tower import Element, Tower
from mbsym.algebra.truncated import Space, Truncated
from mbsym.problems.normal_forms.birkhoff import NormalForm, diagonalised, normal_form
from mbsym.problems.normal_forms.expansion import Numbers, expansion
from mbsym.problems.normal_forms.result import defects


def _exactly(order: int, mu: fmpq | None) -> tuple[Tower, Truncated, NormalForm]:
    """The triangular point at a rational mu, or in mu."""
    analysis = mbsym.load(SHIPPED / "three-bodies.yaml")
    found = expansion(analysis.parameters_scene, analysis.system, analysis.equilibrium, order, ())
    tower = Tower(("mu",))
    values = {"mu": tower.parameter("mu") if mu is None else tower.element(mu), **dict.fromkeys("anm", tower.one)}
    carry = Carrier(found.scene.ring, tower, values)
    numbers = Numbers(found, carry, tower.reciprocal, tower.zero, tower.one)
    whole = numbers.hamiltonian()
    product = numbers.carry(found.scene.lower(parsed("27*mu*(1 - mu)/4")))
    difference = tower.square_root(tower.one - product * 4)  # w1^2 - w2^2, with w1^2 + w2^2 = 1
    roots = [tower.square_root((-tower.one + s * difference) / 2) for s in (-1, 1)]
    linear = diagonalised(whole, roots, tower.reciprocal, lambda d: float(not d.is_zero()))
    return tower, whole, normal_form(whole, linear, tower.reciprocal)


def _determinant(found: NormalForm) -> Element:
    """D_4 = H_4 at P = (lambda_2, -lambda_1), the same as at the actions (Omega_2, -Omega_1)."""
    one, other = found.linear.roots
    at = found.actions(2)
    return at[2, 0] * other * other - at[1, 1] * one * other + at[0, 2] * one * one


def test_the_determinant_of_the_triangular_points_in_mu() -> None:
    """36 - 541 w1^2 w2^2 + 644 w1^4 w2^4 over (4 w1^2 w2^2 - 1)(25 w1^2 w2^2 - 4), up to a number."""
    tower, _, found = _exactly(4, None)
    mu = tower.parameter("mu")
    p = mu * (tower.one - mu) * 27 / 4
    published = (p * p * 644 - p * 541 + 36) / ((p * 4 - 1) * (p * 25 - 4))
    assert _determinant(found) == published / 16


def test_the_normal_form_is_that_of_deprit() -> None:
    """H_4 = (A I1^2 + 2 B I1 I2 + C I2^2)/2,  A = w2^2 (81 - 696 w1^2 + 124 w1^4) / (72 (1 - 2 w1^2)^2 (1 - 5 w1^2)).

    C is A with w1 and w2 exchanged.  P_k = -+i I_k, so that the coefficient of P_k^2 is -A/2 or -C/2.
    """
    tower, _, found = _exactly(4, None)
    squares = [-(root * root) for root in found.linear.roots]
    for index, (first, second) in enumerate((squares, squares[::-1])):
        top = second * (first * first * 124 - first * 696 + 81)
        half = tower.one - first * 2
        published = top / (half * half * (tower.one - first * 5) * 72)
        key = (2, 0) if index == 0 else (0, 2)
        assert found.actions(2)[key] == -published / 2


@pytest.mark.parametrize("order", [3, 4])
def test_the_transformation_is_canonical_and_gives_the_normal_form(order: int) -> None:
    _, whole, found = _exactly(order, fmpq(1, 50))
    assert all(value.is_zero() for value in defects(whole, found))


def test_a_planted_mistake_is_found() -> None:
    """A coefficient of the normal form, one of a generator, and one of an eigenvector."""
    tower, whole, found = _exactly(4, fmpq(1, 50))
    space = found.hamiltonian.space
    wrong = replace(found, hamiltonian=found.hamiltonian + Truncated(space, {(2, 0, 2, 0): tower.one}))
    assert any(not value.is_zero() for value in defects(whole, wrong))
    bent = found.generators[0] + Truncated(space, {(3, 0, 0, 0): tower.one})
    wrong = replace(found, generators=(bent, *found.generators[1:]))
    assert any(not value.is_zero() for value in defects(whole, wrong))
    first, *others = found.linear.columns
    columns = ((first[0] * 2, *first[1:]), *others)
    wrong = replace(found, linear=replace(found.linear, columns=columns))
    assert any(not value.is_zero() for value in defects(whole, wrong))


def test_a_resonant_term_stays() -> None:
    """H = (x1^2 + p1^2) - (x2^2 + p2^2)/2 + x1 x2^2: frequencies 2 and -1, the term I1^(1/2) I2 cannot be removed."""
    space = Space(4, 3, acb(0), acb(1))
    x1, x2, p1, p2 = map(space.variable, range(4))
    whole = x1 * x1 + p1 * p1 - (x2 * x2 + p2 * p2).scaled(acb("0.5")) + x1 * x2 * x2
    linear = diagonalised(whole, [acb(0, 2), acb(0, -1)], lambda x: 1 / x, lambda d: float(abs(d).mid()))
    kept = normal_form(whole, linear, lambda x: 1 / x, {(1, 2), (-1, -2)}).hamiltonian.part(3)
    assert set(kept.coefficients) <= {(1, 2, 0, 0), (0, 0, 1, 2)}
    assert all(not value.contains(0) for value in kept.coefficients.values())
