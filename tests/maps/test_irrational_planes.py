"""Planes and lines with an irrational constant among the coefficients, against what is known by hand."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import cos
from pathlib import Path
from random import Random
from typing import Any

import pytest

import mbsym
from mbsym.algebra.failures import TooLargeError
from mbsym.maps import mapping
from mbsym.maps.boundaries import Origin
from mbsym.maps.boxes import box_map
from mbsym.maps.mapping import exact_map
from mbsym.maps.result import Lack, Map
from mbsym.maps.section import Axis, Unfit
from mbsym.maps.verdicts import Border
from mbsym.problems.stability.words import Word

HEAD = "mbsym: 1\nname: constants\nparameters: [x, y]\nlinear system:\n  coordinates: [s, u]\n  M: [[1, 0], [0, 1]]\n"
SPRINGS = HEAD + "  K: [[x + sqrt(2)*y, 1], [1, x]]\n"
#: The triangular libration points with G = 2 w J: lambda^4 + (4 w^2 - 3) lambda^2 + 27/4 mu (1 - mu).
TURNING = """mbsym: 1
name: triangular points
parameters: [mu, w]
linear system:
  coordinates: [s, u]
  M: [[1, 0], [0, 1]]
  G: [[0, -2*w], [2*w, 0]]
  K: [[-3/4, -3*sqrt(3)/4*(1 - 2*mu)], [-3*sqrt(3)/4*(1 - 2*mu), -9/4]]
"""


def plane(text: str, folder: Path, *axes: tuple[str, Any, Any]) -> Map:
    (folder / "system.yaml").write_text(text)
    listed = [Axis(name, Fraction(low), Fraction(high)) for name, low, high in axes]
    return exact_map(mbsym.load(folder / "system.yaml"), listed, {})


def sign_with_root(a: Fraction, b: Fraction) -> int:
    """The sign of a + b sqrt(2)."""
    if a * b >= 0:
        return (a + b > 0) - (a + b < 0)
    return ((a > 0) - (a < 0)) * ((a * a > 2 * b * b) - (a * a < 2 * b * b))


def test_a_plane_with_a_square_root(tmp_path: Path) -> None:
    """K is positive definite where x + (x + sqrt(2) y) > 0 and x (x + sqrt(2) y) > 1; its conjugate bounds nothing."""
    found = plane(SPRINGS, tmp_path, ("x", -2, 2), ("y", -2, 2))
    assert found.section.constant is not None
    assert found.section.constant.text == "sqrt(2)"
    assert found.check is not None
    assert found.check.holds
    assert found.check.enclosed == found.check.points
    random, seen = Random(5), set()
    for _ in range(200):
        x, y = (Fraction(random.randint(-199, 199), 100) for _ in range(2))
        definite = sign_with_root(2 * x, y) > 0 and sign_with_root(x * x - 1, x * y) > 0
        word = found.at(x, y).word  # type: ignore[union-attr]
        assert word is (Word.STABLE if definite else Word.UNSTABLE)
        seen.add(word)
    assert len(seen) == 2
    assert any(found.separates(one) for one in found.arcs)
    for one, arc in zip(found.arcs, found.arrangement.arcs, strict=True):
        x, y = arc.point.floats()
        own = abs(x * (x + 2**0.5 * y) - 1) < 1e-9  # else of the conjugate
        if one.judged is not None:
            assert (one.judged.border is Border.ZERO) == own
        assert not (found.separates(one) and not own)


def test_rouths_curve_in_a_plane(tmp_path: Path) -> None:
    """Imaginary roots where 4 w^2 > 3 and (4 w^2 - 3)^2 >= 27 mu (1 - mu), on the curve with a Jordan block."""
    found = plane(TURNING, tmp_path, ("mu", 0, "1/2"), ("w", "1/2", 2))
    assert found.check is not None
    assert found.check.holds
    random = Random(6)
    for _ in range(100):
        mu, w = Fraction(random.randint(1, 499), 1000), Fraction(random.randint(500, 2000), 1000)
        bound = 4 * w**2 - 3
        right = not (bound > 0 and bound**2 > 27 * mu * (1 - mu))
        word = found.at(mu, w).word  # type: ignore[union-attr]
        assert (word is Word.UNSTABLE) == right
    blocks = [one for one in found.arcs if one.judged is not None and one.judged.border is Border.JORDAN]
    assert any(found.separates(one) for one in blocks)


def test_a_square_over_the_field_is_seen(tmp_path: Path) -> None:
    """(x - sqrt(2) y)^2 is no square with rational coefficients: on its line K = diag(0, 1 - x)."""
    text = HEAD + "  K: [[(x - sqrt(2)*y)**2, 0], [0, 1 - x]]\n"
    found = plane(text, tmp_path, ("x", 0, 2), ("y", 0, 2))
    assert found.check is not None
    assert found.check.holds
    on = [
        (one.judged, arc.point.floats()[0])
        for one, arc in zip(found.arcs, found.arrangement.arcs, strict=True)
        if one.judged is not None and one.judged.border is Border.ZERO and one.judged.null == 1
    ]
    assert {judged.degree for judged, x in on if x < 1} == {0}
    assert {judged.degree for judged, x in on if x > 1} - {0} == {1}


def test_a_constant_of_a_high_degree_is_refused(tmp_path: Path) -> None:
    """cos(pi/17) has the degree 8, and a norm eight times the degree of its polynomial."""
    text = HEAD.replace("[x, y]", "{x: , y: , lam: {value: pi/17}}").replace(": ,", ": {},")
    text += "  D: [[1, 0], [0, cos(lam)]]\n  K: [[x**3 + cos(lam)*y**3, x], [x, y**3 + cos(lam)]]\n"
    with pytest.raises(TooLargeError, match="degree up to"):
        plane(text, tmp_path, ("x", 0, 2), ("y", 0, 2))


def lossy(module: Any, monkeypatch: pytest.MonkeyPatch, origins: set[Origin]) -> None:
    """Loses the boundaries that come from these conditions alone."""
    whole = module.boundaries

    def without(*arguments: Any) -> Any:
        found = whole(*arguments)
        kept = [k for k, told in enumerate(found.conditions) if any(one.origin not in origins for one in told)]
        assert len(kept) < len(found.factors)
        factors, conditions = (tuple(x[k] for k in kept) for x in (found.factors, found.conditions))
        return replace(found, factors=factors, conditions=conditions)

    monkeypatch.setattr(module, "boundaries", without)


def test_a_lost_boundary_is_found_in_a_plane(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    lossy(mapping, monkeypatch, {Origin.STIFFNESS, Origin.CONSTANT})
    found = plane(SPRINGS, tmp_path, ("x", -2, 2), ("y", -2, 2))
    assert found.check is not None
    assert not found.check.holds
    assert any(one.lack is Lack.WITHDRAWN for one in found.regions)


def on_line() -> Map:
    return exact_map(mbsym.load("systems/triangular-points.yaml"), [Axis("mu", Fraction(0), Fraction(1, 2))], {})


def test_lines_with_a_constant_are_checked_too(monkeypatch: pytest.MonkeyPatch) -> None:
    found = on_line()
    assert found.check is not None
    assert found.check.holds
    assert found.check.enclosed == found.check.points >= 96
    lossy(mapping, monkeypatch, {Origin.DISCRIMINANT})
    wrong = on_line()
    assert wrong.check is not None
    assert not wrong.check.holds


@pytest.mark.parametrize("given", ["pi/3", "1", "0"])
def test_an_angle_that_varies_has_not_the_value_of_the_description(given: str, tmp_path: Path) -> None:
    """x'' + (cos(a) + c - 3/2) x = 0 has no exact plane of a and c, whatever a is elsewhere; boxes say what is true."""
    text = HEAD.replace("[x, y]", f"{{a: {given}, c: 1}}").replace("[s, u]", "[s]").replace("[[1, 0], [0, 1]]", "[[1]]")
    (tmp_path / "system.yaml").write_text(text + "  K: [[cos(a) + c - 3/2]]\n")
    analysis = mbsym.load(tmp_path / "system.yaml")
    axes = [Axis("a", Fraction(0), Fraction(3)), Axis("c", Fraction(1, 2), Fraction(2))]
    with pytest.raises(Unfit):
        exact_map(analysis, axes, {})
    with pytest.raises(Unfit):
        exact_map(analysis, axes[1:], {"a": Fraction(1, 2)})
    proved = [cell for cell in box_map(analysis, axes, {}).cells if cell.judged is not None]
    assert {cell.judged.verdict.word for cell in proved} == {Word.STABLE, Word.UNSTABLE}
    for cell in proved:
        a, c = (float(Fraction(int(v.p), int(v.q))) for v in (cell.sample.x, cell.sample.y))
        assert (cell.judged.verdict.word is Word.STABLE) == (cos(a) + c > 3 / 2)
