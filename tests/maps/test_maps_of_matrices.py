"""Maps of systems given by their matrices, against references/benchmarks/mgk_exact and hard_polynomials."""

from __future__ import annotations

import json
from fractions import Fraction as F
from itertools import product
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from flint import fmpq, fmpq_poly

import mbsym
from mbsym.maps.boundaries import Origin
from mbsym.maps.mapping import exact_map
from mbsym.maps.result import Map
from mbsym.maps.section import Axis
from mbsym.maps.verdicts import Border
from mbsym.problems.stability.words import Word

HARD = json.loads(Path("tests/references/hard_polynomials.json").read_text())["reference"]["routh"]


def described(system: str, parameters: str) -> Any:
    return mbsym.loads(f"mbsym: 1\nname: Given\nparameters: {parameters}\nlinear system: {system}\n")


def plane(analysis: Any, x: tuple[str, Any, Any], y: tuple[str, Any, Any], **settings: Any) -> Map:
    axes = [Axis(name, F(low), F(high)) for name, low, high in (x, y)]
    return exact_map(analysis, axes, {name: F(value) for name, value in settings.items()})


def at(found: Map, *values: Any) -> Any:
    cell = found.at(*map(F, values))
    assert cell is not None
    return cell


def test_gyroscopic_stabilisation_begins_at_the_sum_of_the_roots() -> None:
    """mgk_exact: g > sqrt(k1) + sqrt(k2); at equality a double pair with Jordan blocks: k2 = s^2, k1 = 1, g = 1 + s."""
    found = plane(mbsym.load("systems/gyroscopic-pair.yaml"), ("g", 0, 6), ("k2", 0, 9), k1=1)
    beside = F(1, 10**12)
    for root in (F(1, 3), F(1), F(7, 5), F(2)):
        g, k2 = 1 + root, root**2
        assert at(found, g + beside, k2).word is Word.STABLE
        below = at(found, g - beside, k2)
        assert (below.word, below.judged.right, below.judged.real_right) == (Word.UNSTABLE, 2, 0)
        border = at(found, g, k2)
        assert border.shape == "arc"
        assert (border.word, border.judged.border) == (Word.UNSTABLE, Border.JORDAN)


def test_any_damping_ends_it() -> None:
    """mgk_exact, Kelvin-Tait-Chetaev: k = (1, 4), g = 10: a pair to the right at every d > 0, none at d = 0."""
    text = "{coordinates: [x, y], D: [[d, 0], [0, d]], G: [[0, g], [-g, 0]], K: [[-1, 0], [0, -4]]}"
    found = plane(described(text, "{d: {sign: nonnegative}, g: {}}"), ("d", 0, 1), ("g", 0, 12))
    assert at(found, 0, 10).word is Word.STABLE
    for damping in (F(1, 10**9), F(1, 1000), F(1, 2)):
        judged = at(found, damping, 10)
        assert (judged.word, judged.judged.right, judged.judged.real_right) == (Word.UNSTABLE, 2, 0)
    assert Word.ASYMPTOTIC not in {one.word for one in found.cells}


def test_complete_dissipation_leaves_the_borders_of_k_alone() -> None:
    """Kelvin-Chetaev: with D > 0 and N = 0 as many roots are to the right as K has negative eigenvalues, here counted
    by NumPy, and without G they are real.  A resultant of degree 672 was in the way of exact regions."""
    found = plane(mbsym.load("tests/cases/statements/complete-dissipation.yaml"), ("a", 0, 2), ("b", -3, 3))
    assert {one.origin for told in found.boundaries.conditions for one in told} <= {
        *(Origin.CONSTANT, Origin.DAMPING, Origin.STIFFNESS, Origin.UNDAMPED, Origin.SIGN)
    }
    source = Random(26)
    for _ in range(30):
        a, b = F(source.randint(1, 1999), 1000), F(source.randint(-2999, 2999), 1000)
        rows = [[2 * a, -1, -a + b], [-1, b - 2, -a - b + F(1, 2)], [-a + b, -a - b + F(1, 2), b + 2]]
        negative = int((np.linalg.eigvalsh(np.array(rows, dtype=float)) < 0).sum())
        judged = at(found, a, b).judged
        assert (judged.right, judged.real_right) == (negative, negative)
        assert judged.verdict.word is (Word.UNSTABLE if negative else Word.ASYMPTOTIC)


@pytest.mark.parametrize(
    ("sign", "low", "hurwitz"),
    [("positive", 0, False), ("real", 1, False), ("positive", -1, False), ("nonnegative", 0, True), ("real", 0, True)],
)
def test_minors_of_hurwitz_stay_where_the_dissipation_may_vanish(sign: str, low: int, hurwitz: bool) -> None:
    """D = diag(a, 2 a) > 0 for a > 0; on the edge a = 0 the gyroscopic system has borders of its own."""
    text = "{coordinates: [x, y], D: [[a, 0], [0, 2*a]], G: [[0, 3], [-3, 0]], K: [[b, 0], [0, -1]]}"
    found = plane(described(text, f"{{a: {{sign: {sign}}}, b: {{}}}}"), ("a", low, 2), ("b", -2, 2))
    assert (Origin.HURWITZ in {one.origin for told in found.boundaries.conditions for one in told}) is hurwitz


def test_the_rotating_shaft() -> None:
    """mgk_exact: internal damping i, external e: stable iff W < w0 (1 + e/i).

    x'' + (i + e) x' + w0^2 x + i W y = 0, y'' + (i + e) y' + w0^2 y - i W x = 0, with w0 = 1, i = 1/2; at the border
    +-i w0, by hand: S^2 + (i + e) S + w0^2 - j i W = 0 has S = j w0 where (i + e) w0 = i W.
    """
    text = "{coordinates: [x, y], D: [[1/2 + e, 0], [0, 1/2 + e]], K: [[1, 0], [0, 1]], N: [[0, W/2], [-W/2, 0]]}"
    found = plane(described(text, "{e: {sign: nonnegative}, W: {sign: nonnegative}}"), ("e", 0, 1), ("W", 0, 4))
    for external in (F(0), F(1, 7), F(1, 2), F(9, 10)):
        critical, beside = 1 + 2 * external, F(1, 10**12)
        assert at(found, external, critical - beside).word is Word.ASYMPTOTIC
        assert at(found, external, critical).judged.border is Border.IMAGINARY
        over = at(found, external, critical + beside)
        assert (over.word, over.judged.right) == (Word.UNSTABLE, 2)


def companion(coefficients: list[int], shift: str) -> str:
    """A with the characteristic polynomial p(S - shift), shift on its diagonal; the leading coefficient is 1."""
    n = len(coefficients) - 1
    rows = [[shift if i == j else "1" if j == i + 1 else "0" for j in range(n)] for i in range(n)]
    for j in range(n):
        rows[-1][j] = f"{-coefficients[n - j]}" if j < n - 1 else f"{-coefficients[1]} + {shift}"
    return "[" + ", ".join("[" + ", ".join(row) + "]" for row in rows) + "]"


def counted(coefficients: list[int], shift: F) -> int:
    """Roots of p to the right of -shift, from balls about the roots of p, each with its multiplicity."""
    p = fmpq_poly([fmpq(c) for c in reversed(coefficients)])
    found = 0
    for root, multiplicity in p.numer().complex_roots():
        place = root.real + fmpq(shift.numerator, shift.denominator)
        assert not place.contains(0)
        found += multiplicity * (place > 0)
    return found


@pytest.mark.parametrize("case", HARD, ids=lambda case: "-".join(map(str, case["coeffs"])))
def test_hard_polynomials_beside_their_borders(case: dict[str, Any]) -> None:
    """hard_polynomials: the counts at shift 0, and those of roots found in balls at points to both sides of it."""
    coefficients = case["coeffs"]
    names = ", ".join(f"x{k}" for k in range(len(coefficients) - 1))
    text = f"{{coordinates: [{names}], A: {companion(coefficients, 'shift')}}}"
    found = exact_map(described(text, "{shift: {}}"), [Axis("shift", F(-3), F(3))], {})
    assert found.check is None or found.check.holds
    middle = at(found, 0)
    assert middle.judged.right == case["rhp"]
    blocks = coefficients == [1, 0, 2, 0, 1]  # a companion matrix has one eigenvector to each eigenvalue
    assert (middle.word is Word.UNSTABLE) == (case["rhp"] > 0 or blocks)
    assert not middle.word.asymptotic or not case["imag"]
    if blocks:  # (S^2 + 1)^2
        assert middle.judged.border is Border.JORDAN
    for size, sign in product((F(1, 997), F(97, 1009), F(2999, 1013)), (1, -1)):
        beside = at(found, sign * size)
        right = counted(coefficients, sign * size)
        assert beside.judged.right == right
        assert (beside.word is Word.UNSTABLE) == (right > 0)
