"""``mbsym integrals --cases``: parameters of any sign that are equal, and cases that a description excludes."""

from __future__ import annotations

import pytest
from conftest import filed, invoked

PLANE = """
mbsym: 1
name: point in the plane
parameters: {{{parameters}}}
bodies:
  - {{name: P, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}}
loads:
  - potential: {potential}
"""


def _cases(tmp_path, text, *options):
    path = filed(tmp_path / "point.yaml", text)
    done = invoked("integrals", path, "--cases", *options, code=0)
    lines = [line.rstrip() for line in done.output.split("Special cases")[1].splitlines()]
    return [
        line.strip() for line in lines if line.startswith("    ") and not line.startswith("     ") and " = " in line
    ]


def test_coupled_quartic_oscillators(tmp_path):
    """V = a x^4 + b x^2 y^2 + c y^4 of degree 4 has a second integral where b = 0 (separable), and for a = c where

    b = 2 a, V = a (x^2 + y^2)^2, with the angular momentum, and b = 6 a, separable in x + y and x - y.
    """
    text = PLANE.format(parameters="a: real, b: real, c: real", potential="a*x**4 + b*x**2*y**2 + c*y**4")
    found = _cases(tmp_path, text)
    assert {"b = 0", "a = c, 2*a = b", "a = c, 6*a = b"} <= set(found)


@pytest.mark.parametrize(
    ("parameters", "expected"),
    [
        ("a: negative, b: negative", {"a = b", "a = 4*b", "4*a = b", "a = 9*b", "9*a = b"}),
        ("a: negative, b: positive", set()),
        ("a: nonzero, b: positive", {"a = b", "a = 4*b", "4*a = b", "a = 9*b", "9*a = b"}),
    ],
)
def test_cases_that_signs_exclude_are_not_told(tmp_path, parameters, expected):
    """V = (a x^2 + b y^2)/2 has more integrals up to degree 4 where a, b are as 1, 4 or 9, or where one is zero."""
    assert set(_cases(tmp_path, PLANE.format(parameters=parameters, potential="(a*x**2 + b*y**2)/2"))) == expected


def test_cases_that_assumptions_exclude_are_not_told(tmp_path):
    """With a > 2 b of the cases a = b, 4 b, 9 b, b/4, b/9 two are left; with b = 1 the assumption still counts."""
    text = PLANE.format(parameters="a: positive, b: positive", potential="(a*x**2 + b*y**2)/2")
    text += "assumptions:\n  - a > 2*b\n"
    assert set(_cases(tmp_path, text)) == {"a = 4*b", "a = 9*b"}
    assert set(_cases(tmp_path, text, "--set", "b=1")) == {"a = 4", "a = 9"}
