"""Equations in speeds as polynomial vector fields, against Euler's and Poisson's equations written by hand."""

from __future__ import annotations

from dataclasses import replace

import pytest
from flint import fmpq

import mbsym
from mbsym.problems.vector_field import in_speeds


def _field(path):
    loaded = mbsym.load(path)
    return in_speeds(loaded.speed_form, loaded.equations, [x.formula.polynomial for x in loaded.integrals]), loaded


def test_clebsch_is_the_field_of_the_book():
    (field, transfer), loaded = _field("systems/clebsch-poisson.yaml")
    assert field.variables == ("p", "q", "r", "gamma1", "gamma2", "gamma3")
    N, A, B, C, p, q, r, g1, g2, g3 = map(field.generator, ("N", "A", "B", "C", *field.variables))
    by_hand = [
        (B - C) * B * C * (q * r - N * g2 * g3),
        (C - A) * C * A * (r * p - N * g3 * g1),
        (A - B) * A * B * (p * q - N * g1 * g2),
        *(A * B * C * x for x in (r * g2 - q * g3, p * g3 - r * g1, q * g1 - p * g2)),
    ]
    assert [x * A * B * C for x in field.numerators] == [x * field.denominator for x in by_hand]
    assert field.relations == (g1**2 + g2**2 + g3**2 - 1,)
    fourth = A**2 * p**2 + B**2 * q**2 + C**2 * r**2 - N * (B * C * g1**2 + C * A * g2**2 + A * B * g3**2)
    assert field.derivative(fourth) == 0
    # A sign that is wrong in one equation is seen by the integral.
    wrong = replace(field, numerators=(-field.numerators[0], *field.numerators[1:]))
    assert wrong.derivative(fourth) != 0
    for integral in loaded.integrals:
        top, bottom = transfer.fraction(integral.formula.polynomial)
        assert field.reduced(field.derivative(top)) == 0
        assert not any(bottom.degrees()[k] for k in field.places)
        assert loaded.ring.is_zero(transfer.back(transfer(transfer.back(top))) - transfer.back(top))


@pytest.mark.parametrize("name", ["gyrostat-poisson", "gravity-gradient-quaternion"])
def test_integrals_of_problem_seven_are_kept(name):
    (field, transfer), loaded = _field(f"systems/{name}.yaml")
    for integral in loaded.integrals:
        assert field.reduced(field.derivative(transfer.fraction(integral.formula.polynomial)[0])) == 0


def test_numbers_take_the_place_of_parameters():
    (field, _), _ = _field("systems/clebsch-poisson.yaml")
    there = field.at({"A": 4, "B": 5, "C": fmpq(6)})
    assert there.parameters == tuple(name for name in field.parameters if name not in "ABC")
    N, q, r, g2, g3 = map(there.generator, ("N", "q", "r", "gamma2", "gamma3"))
    assert there.numerators[0] * 4 == -there.denominator * (q * r - N * g2 * g3)
    with pytest.raises(KeyError):
        field.at({"D": 1})
    with pytest.raises(ZeroDivisionError):
        field.at({"A": 0})
