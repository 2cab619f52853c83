"""A pendulum in a lift or a train: a frame of constant acceleration has an energy, and Lagrange-Dirichlet holds there.

With the pivot at x = a t^2/2, z = b t^2/2 and the bob at (-l sin th, -l cos th) from it (a turn about y takes z to x),

    m l^2 th'' + m l ((g + b) sin th - a cos th) = 0,      I = m l^2 th'^2/2 - m l ((g + b) cos th + a sin th):

the weight is turned and has the size sqrt((g + b)^2 + a^2); at rest along it I has a proper minimum.  Where the
acceleration varies the time stays in the equations.
"""

from __future__ import annotations

from contextlib import suppress

import pytest

import mbsym
from mbsym.analysis import Analysis, Unavailable
from mbsym.problems.stability.verdict import Word

TEXT = """
mbsym: 1
name: A pendulum in a frame that is accelerated
parameters: {m: positive, l: positive, g: positive, a: real, b: positive, c: positive}
bodies:
  - {name: frame, attached to: 0, connection point: PIVOT, mass: 0}
  - {name: bob, attached to: frame, rotation: {axes: [2], angles: [th]}, mass centre: [0, 0, -l], mass: m}
loads:
  - uniform gravity: {vector: [0, 0, -g]}
motion: {th: REST}
"""


def told(pivot: str, rest: str = "0", load: str = "") -> Analysis:
    return mbsym.loads(
        TEXT.replace("PIVOT", pivot).replace("REST", rest).replace("motion:", f"{load}motion:"), (4, 6, 7)
    )


@pytest.mark.parametrize(
    ("pivot", "rest", "energy"),
    [
        ("[0, 0, b*t**2/2]", "0", "m*l**2*th_dot**2/2 - m*l*(g + b)*cos(th)"),
        ("[a*t**2/2, 0, 0]", "atan(a/g)", "m*l**2*th_dot**2/2 - m*l*(g*cos(th) + a*sin(th))"),
        ("[0, 0, 3*t + b*t**2/2]", "0", "m*l**2*th_dot**2/2 - m*l*(g + b)*cos(th)"),
    ],
)
def test_there_is_an_energy_where_the_acceleration_is_constant(pivot: str, rest: str, energy: str) -> None:
    found = told(pivot, rest)
    (integral,) = found.integrals
    text = TEXT.replace("PIVOT", pivot).replace("REST", rest)
    (claimed,) = mbsym.loads(text + f"claims:\n  - {{claim: first integral, equals: {energy}}}\n", (3,)).claims
    assert claimed.holds
    assert integral.status == "proved"
    assert found.stability.verdict.word is Word.STABLE


@pytest.mark.parametrize("pivot", ["[0, 0, b*t**3/6]", "[0, 0, sin(b*t)]", "[a*t**3, 0, b*t**2/2]"])
def test_there_is_none_where_it_varies(pivot: str) -> None:
    found = told(pivot)
    assert found.integrals == ()
    with suppress(Unavailable):  # where the motion given is none, or its first approximation varies with the time
        assert found.stability.verdict.word is not Word.STABLE


def test_a_damper_in_a_lift_makes_rest_asymptotically_stable() -> None:
    found = told("[0, 0, b*t**2/2]", load="  - damper: {coordinate: th, coefficient: c}\n")
    assert found.integrals == ()
    assert found.stability.verdict.word.asymptotic


def conical(pivot: str) -> Analysis:
    text = TEXT.replace("{axes: [2], angles: [th]}", "{axes: [3, 2], angles: [ps, th]}")
    return mbsym.loads(
        text.replace("PIVOT", pivot).replace("{th: REST}", "{th: pi/3, ps: {rate: sqrt(2*(g + b)/l)}}"), (4, 6, 7)
    )


def test_a_conical_pendulum_in_a_lift_is_stable_after_routh() -> None:
    """th = pi/3, ps'^2 = 2 (g + b)/l: the weight is m (g + b), and with p = m l^2 ps' sin(th)^2 constant

        W = p^2/(2 m l^2 sin(th)^2) - m l (g + b) cos(th),     W'' = 7 m l (g + b)/2 > 0 there (w^2 = (g + b)(7/2)/l):

    as in a building.  "No energy integral of the nonlinear system is known" was said beside that integral, proved.
    """
    found = conical("[0, 0, b*t**2/2]")
    assert {integral.status for integral in found.integrals} == {"proved"}
    assert len(found.integrals) == 2
    assert found.stability.verdict.word is Word.STABLE_BUT_CYCLIC
