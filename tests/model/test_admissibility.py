"""Which masses and inertias a real body can have, on what publications print.

Data: the gyrostat's Table 1 (Amer, Amer and Galal; the references' notes 2.4: "B >= M(x0^2+z0^2) = 150 and
C >= M(x0^2+y0^2) = 174 vs 76 and 11: no such body exists") and the references' physically realisable set E1 (2.5).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

import pytest
from conftest import parsed
from hypothesis import given
from hypothesis import strategies as st

from mbsym.expressions.tree import Expression
from mbsym.model.admissibility import inertia_violation, offset_violation, symbolic_violation

Row = tuple[Fraction, Fraction, Fraction]


def diagonal(*moments: str) -> tuple[Row, Row, Row]:
    a, b, c = map(Fraction, moments)
    zero = Fraction(0)
    return (a, zero, zero), (zero, b, zero), (zero, zero, c)


def vector(*components: str) -> Row:
    x, y, z = map(Fraction, components)
    return x, y, z


def test_the_gyrostat_of_table_1_does_not_exist() -> None:
    tensor, centre = diagonal("82.99908", "76.19917", "11"), vector("0.7", "0.3", "0.1")
    assert inertia_violation(tensor) is None  # the triangle inequality alone does not show it: 6.8 <= 11
    found = offset_violation(tensor, Fraction(300), centre)
    assert found is not None
    assert "about axis 2 is negative: 76.19917 < m (c1^2 + c3^2) = 150" in found
    found = offset_violation(diagonal("83", "151", "11"), Fraction(300), centre)
    assert found is not None
    assert "about axis 3 is negative: 11 < m (c1^2 + c2^2) = 174" in found


def test_the_references_realisable_gyrostat_exists() -> None:
    assert offset_violation(diagonal("1/50", "21/1000", "3/100"), Fraction(1), vector("1/50", "3/100", "3/50")) is None


def test_a_rods_moment_carries_its_centre_from_m_c_squared_on() -> None:
    """[I, 0, I] with the mass 3 and the centre at distance 1/2: I >= 3/4."""
    for moment, possible in (("3/4", True), ("1", True), ("749/1000", False)):
        found = offset_violation(diagonal(moment, "0", moment), Fraction(3), vector("0", "1/2", "0"))
        assert (found is None) == possible


small = st.fractions(min_value=-3, max_value=3, max_denominator=4)
points = st.lists(st.tuples(st.fractions(min_value=0, max_value=3, max_denominator=3), small, small, small), min_size=1)


@given(points)
def test_every_cloud_of_masses_is_possible(cloud: Sequence[tuple[Fraction, Fraction, Fraction, Fraction]]) -> None:
    mass = sum((m for m, *_ in cloud), Fraction(0))
    if not mass:
        return
    centre = [sum((p[0] * p[i] for p in cloud), Fraction(0)) / mass for i in (1, 2, 3)]

    def entry(i: int, j: int) -> Fraction:
        total = Fraction(0)
        for m, *x in cloud:
            total += m * (sum((a * a for a in x), Fraction(0)) * (i == j) - x[i] * x[j])
        return total

    rows = [(entry(i, 0), entry(i, 1), entry(i, 2)) for i in range(3)]
    tensor = (rows[0], rows[1], rows[2])
    assert inertia_violation(tensor) is None
    assert offset_violation(tensor, mass, (centre[0], centre[1], centre[2])) is None


def triple(*sources: str) -> tuple[Expression, Expression, Expression]:
    a, b, c = map(parsed, sources)
    return a, b, c


SIGNS: Mapping[str, str] = {"m": "positive", "l": "positive", "h": "nonnegative", "J": "positive", "K": "real"}


@pytest.mark.parametrize(
    ("moments", "centre", "wrong"),
    [
        (("m*l**2/5", "0", "m*l**2/5"), ("0", "l/2", "0"), "m*l**2/5 < m (c2^2 + c3^2)"),
        (("m*l**2/4", "0", "m*l**2/4"), ("0", "l/2", "0"), None),
        (("m*l**2/3", "0", "m*l**2/3"), ("0", "-l/2", "0"), None),
        (("m*l**2/3", "0", "m*l**2/3"), ("0", "l", "0"), "m*l**2/3 < m (c2^2 + c3^2)"),
        (("J", "J", "2*J"), ("0", "0", "0"), None),
        (("J", "J", "2*J + m*l**2"), ("0", "0", "0"), "2*J + m*l**2 > J + J"),
        (("J", "h", "J + h"), ("0", "0", "0"), None),
        (("J", "h", "J + 2*h"), ("0", "0", "0"), None),  # h may be zero
        (("J", "J", "J"), ("K", "0", "0"), None),
        (("m*l*l*(1/3 + 1/2)/l**0", "m*l**3/(2*l)", "m*l**2/4"), ("0", "0", "0"), "m*l*l"),
        (("J", "J", "sqrt(3)*J"), ("0", "0", "0"), None),
    ],
)
def test_what_the_signs_alone_decide(moments: Sequence[str], centre: Sequence[str], wrong: str | None) -> None:
    zero = parsed("0")
    entries = triple(*moments)
    rows = [tuple(entries[i] if i == j else zero for j in range(3)) for i in range(3)]
    tensor = (triple_of(rows[0]), triple_of(rows[1]), triple_of(rows[2]))
    found = symbolic_violation(tensor, parsed("m"), triple(*centre), True, SIGNS)
    if wrong is None:
        assert found is None
    else:
        assert found is not None
        assert wrong in found


def triple_of(row: Sequence[Expression]) -> tuple[Expression, Expression, Expression]:
    return row[0], row[1], row[2]
