"""C omega_3 of a symmetric body is constant in whatever order its angles turn it, and decides sleeping tops."""

from __future__ import annotations

import pytest

import mbsym
from mbsym.problems.stability.words import Word

TOP = """
mbsym: 1
name: top
parameters: {A: positive, C: positive, m: positive, g: positive, l: real, n: real}
bodies:
  - {name: top, attached to: 0, rotation: {axes: [AXES], angles: [ANGLES]}, mass: m, mass centre: [0, 0, l],
     inertia about: joint, inertia: [A, B, C], coordinates: [a, b, c]}
loads: [uniform gravity: {vector: [0, 0, -g]}]
motion: {a: 0, b: 0, c: {rate: n}}
values: {A: 3, C: 1, m: 1, g: 10, l: L, n: N}
"""
#: Orders in which a, b, c are 0, 0, n t of a spin about the axis 3.
ORDERS = [("1, 2, 3", "a, b, c"), ("2, 1, 3", "a, b, c"), ("3, 1, 2", "c, a, b"), ("3, 2, 1", "c, a, b")]


def top(order: tuple[str, str], length: str, rate: str, second: str = "A") -> str:
    text = TOP.replace("AXES", order[0]).replace("ANGLES", order[1]).replace("B,", f"{second},")
    return text.replace("L,", f"{length},").replace("N}", f"{rate}}}")


@pytest.mark.parametrize("order", ORDERS)
def test_it_is_an_integral_in_every_order_of_turning(order: tuple[str, str]) -> None:
    """omega_3 = c' + ... is dT/dc'/C where c turns last; else it is told by itself."""
    found = [x for x in mbsym.loads(top(order, "1", "11"), (7,)).integrals if x.status == "proved"]
    names = {x.name for x in found}
    assert len(found) == 3
    assert {"momentum of c"} <= names
    last = order[0].endswith("3")
    assert ("angular momentum of top about its axis 3" in names) is not last
    if not last:
        (own,) = [x for x in found if x.of == "top 3"]
        assert str(own.formula) in (
            "C*(a_dot*sin(b) + c_dot*cos(a)*cos(b))",
            "C*(c_dot*cos(a)*cos(b) - a_dot*sin(b))",
        )


def test_no_such_integral_of_a_body_that_is_not_symmetric() -> None:
    found = mbsym.loads(top(ORDERS[2], "1", "11", "7/2"), (7,)).integrals
    assert {x.kind for x in found} == {"generalised energy", "cyclic momentum"}


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize(
    # C^2 n^2 > 4 A m g l (Maievskii); hanging it is stable at any rate, though K > 0 for n^2 (A - C) < m g l only
    ("length", "rate", "wanted"),
    [("1", "11", Word.STABLE_BUT_CYCLIC), ("1", "10", Word.UNSTABLE), ("-1", "3", Word.STABLE_BUT_CYCLIC)],
)
def test_a_sleeping_top_in_every_order_of_turning(order: tuple[str, str], length: str, rate: str, wanted: Word) -> None:
    found = mbsym.loads(top(order, length, rate), (4, 5, 6)).stability.numerical
    assert found is not None
    assert found.word is wanted
