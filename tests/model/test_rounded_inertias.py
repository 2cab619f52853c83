"""Inertias printed in decimals, those of identified models, and what is said of them."""

from __future__ import annotations

import json
import math
import random
from fractions import Fraction

import pytest
from conftest import system_of

import mbsym
from mbsym.model.admissibility import (
    ROUNDING,
    NumberTensor,
    body_violation,
    has_negative_energy,
    inertia_violation,
    principal_values,
)
from mbsym.report.targets import TARGETS
from mbsym.source import read
from mbsym.source.text_writer import to_text
from mbsym.source.yaml_writer import to_yaml

LINK = """
mbsym: 1
name: One link
bodies:
  - name: link
    attached to: 0
    rotation: {{axes: [3, 1], angles: [q, {twist}]}}
    mass centre: [-0.0203, -0.0141, 0.07]
    mass: 4.8
    inertia about: mass centre
    inertia: {inertia}
"""

#: Link 3 of the PUMA 560 (P. I. Corke and B. Armstrong-Helouvry, ICRA 1994): 0.086 > 0.066 + 0.0125.
PUMA_3 = "[0.066, 0.086, 0.0125]"


def turned(moments: tuple[float, float, float], source: random.Random, digits: int) -> NumberTensor:
    """R diag R^T for a random rotation R, its entries rounded to significant digits."""
    w, x, y, z = (source.gauss(0, 1) for _ in range(4))
    n = math.sqrt(w * w + x * x + y * y + z * z)
    w, x, y, z = w / n, x / n, y / n, z / n
    r = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]

    def entry(i: int, j: int) -> Fraction:
        return Fraction(f"{sum(r[i][k] * moments[k] * r[j][k] for k in range(3)):.{digits - 1}e}")

    rows = [tuple(entry(min(i, j), max(i, j)) for j in range(3)) for i in range(3)]
    return rows[0], rows[1], rows[2]  # type: ignore[return-value]


@pytest.mark.parametrize("digits", [8, 10, 16])
def test_thin_rods_and_plates_may_be_rounded(digits: int) -> None:
    source, refused = random.Random(digits), 0
    for _ in range(100):
        a, b = source.uniform(0.01, 3), source.uniform(0.01, 3)
        tensor = turned(source.choice([(0.0, a, a), (a, b, a + b)]), source, digits)
        refused += inertia_violation(tensor) is not None
        assert inertia_violation(tensor, ROUNDING) is None
    assert refused > 10  # without the tolerance many of them are no bodies


def test_more_than_rounding_is_seen_in_any_axes():
    source = random.Random(3)
    for _ in range(100):
        a, b = source.uniform(0.1, 3), source.uniform(0.1, 3)
        tensor = turned((a, b, (a + b) * 1.0001), source, 16)
        assert inertia_violation(tensor, ROUNDING) is not None
        assert [float(x) for x in principal_values(tensor)] == pytest.approx(sorted([a, b, (a + b) * 1.0001])[::-1])


def test_published_values_can_be_accepted_and_the_reports_say_so(tmp_path):
    _, complaints = read(LINK.format(inertia=PUMA_3, twist="0"))
    (refused,) = complaints.errors
    assert refused.code == "bad-inertia"
    assert "0.086 > 0.066 + 0.0125" in refused.message
    hint = f"{{tensor: {PUMA_3}, accept: true}}"
    assert hint in (refused.hint or "")
    text = LINK.format(inertia=hint, twist="0")
    system, complaints = read(text)
    assert system is not None
    assert not complaints.items
    for write in (to_yaml, to_text):
        assert read(write(system))[0] == system
    analysis = mbsym.loads(text)
    latex = " ".join(TARGETS["latex"].render(analysis, (1, 2)).split())
    assert "accepted as given (identified values) although no body has it" in latex
    found = json.loads(TARGETS["json"].render(analysis, (2,)))
    (accepted,) = found["accepted_inertias"]
    assert accepted["body"] == "link"
    assert "0.086 > 0.066 + 0.0125" in accepted["violation"]
    # T = (m (c1^2 + c2^2) + 0.0125) q'^2 / 2
    wanted = (Fraction("4.8") * (Fraction("0.0203") ** 2 + Fraction("0.0141") ** 2) + Fraction("0.0125")) / 2
    assert Fraction(str(analysis.energy.kinetic_energy).replace("*q_dot**2", "").replace("q_dot**2", "1")) == wanted


FIXED = """
mbsym: 1
name: About a point
bodies:
  - name: support
    rotation: {{axes: [1], angles: [1/2]}}
    connection point: [0, 0, {height}]
    mass: 0
  - name: body
    attached to: support
    rotation: {{axes: [3, 1, 3], angles: [a, b, c]}}
    mass: 300
    mass centre: [0.7, 0.3, 0.1]
    inertia about: joint
    inertia: {inertia}
"""


def test_about_a_fixed_point_the_tensor_there_is_all_that_an_energy_needs():
    """Table 1 of Amer, Amer & Galal: C = 11 < M (x0^2 + y0^2) = 174.  T = w.J_O w/2 stays positive; of a body whose
    joint moves it would not."""
    found = {}
    for height, inertia in (
        ("2", "{tensor: [83, 76, 11], accept: true}"),
        ("2", "[83, 76, 11]"),
        ("z", "{tensor: [83, 76, 11], accept: true}"),
        ("2", "{tensor: [83, 76, -1], accept: true}"),
    ):
        system, _ = read(FIXED.format(height=height, inertia=inertia) + ("" if height == "2" else "coordinates: [z]"))
        found[height, inertia] = system is not None
    assert list(found.values()) == [True, False, False, False]


def test_nothing_is_said_of_bodies_that_are_real():
    analysis = mbsym.loads(LINK.format(inertia="[1, 1, 1]", twist="0"))
    assert "accepted" not in TARGETS["latex"].render(analysis, (1,))
    assert "accepted_inertias" not in json.loads(TARGETS["json"].render(analysis, (1,)))


def test_no_acceptance_makes_a_kinetic_energy_negative():
    for inertia in ("[1, 1, -0.1]", "[[1, 2, 0], [2, 1, 0], [0, 0, 1]]"):
        system, complaints = read(LINK.format(inertia=f"{{tensor: {inertia}, accept: true}}", twist="0"))
        assert system is None
        assert complaints.errors[0].code == "bad-inertia"
    accepted = system_of(LINK.format(inertia=f"{{tensor: {PUMA_3}, accept: true}}", twist="0"))
    assert body_violation(accepted.bodies[0], {}) is not None
    assert not has_negative_energy(accepted.bodies[0], {})


@pytest.mark.parametrize(
    ("inertia", "twist", "enough"),
    [
        ("[0, 0, 0.35]", "0", True),
        ("[0, 0.35, 0]", "-pi/2", True),  # link 1 of the PUMA 560: it turns about its own axis 2
        ("[0, 0.35, 0]", "-1.5707963267948966", True),
        ("[0, 0, 0.35]", "-pi/2", False),
        ("[0, 0.35, 0]", "-pi/3", False),
        ("[0, 0.35, 0]", "-1.57", False),
    ],
)
def test_a_single_moment_is_enough_about_the_only_axis_of_turning(inertia: str, twist: str, enough: bool) -> None:
    system, complaints = read(LINK.format(inertia=inertia, twist=twist))
    assert system is not None
    assert ("single-moment" in [one.code for one in complaints.items]) is not enough
