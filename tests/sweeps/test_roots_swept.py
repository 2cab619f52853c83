"""Eigenvalues that are swept: irrational coefficients, equations of first order, against closed formulas."""

from __future__ import annotations

import json
from fractions import Fraction as F
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mbsym
from mbsym.maps.section import Axis, section
from mbsym.sweeps.roots import DampingMeasure, FrequencyMeasure, RootsMeasure

ROOT = Path(__file__).parents[2]


def measured(kind: Any, analysis: Any, points: list[list[float]], *axes: tuple[str, Any, Any], **settings: Any) -> Any:
    found = section(analysis, [Axis(n, F(a), F(b)) for n, a, b in axes], {k: F(v) for k, v in settings.items()})
    measure = kind(found, "unit")
    told = measure.at(np.array(points))
    assert list(told) == [column.name for column in measure.columns]
    return told


def test_the_triangular_points_whose_coefficients_hold_the_root_of_three() -> None:
    """lam^2 = (-1 +- sqrt(1 - 27 mu (1 - mu)))/2 (Szebehely, section 5.4), and +-i out of the plane."""
    analysis, shares = mbsym.load(ROOT / "systems/triangular-points.yaml"), [0.001, 0.01, 0.02, 0.03]
    told = measured(FrequencyMeasure, analysis, [shares], ("mu", 0, "1/2"))
    for place, mu in enumerate(shares):
        root = np.sqrt(1 - 27 * mu * (1 - mu))
        wanted = sorted([np.sqrt((1 - root) / 2), np.sqrt((1 + root) / 2), 1.0])
        assert [told[f"frequency{k}"][place] for k in (1, 2, 3)] == pytest.approx(wanted, rel=1e-12)


def test_the_bicycles_published_eigenvalues() -> None:
    """Meijaard et al. (2007), Table 2, whose head angle pi/10 has an irrational sine; beside them drifts are zero."""
    published = json.loads((ROOT / "tests/references/bicycle_whipple.json").read_text())["reference"][
        "published_table2"
    ]
    speeds = [1.0, 3.0, 5.0, 8.0]
    told = measured(RootsMeasure, mbsym.load(ROOT / "systems/bicycle.yaml"), [speeds], ("v", "1/2", 10))
    count = len(told) // 2
    for place, speed in enumerate(speeds):
        found = [complex(told[f"real{k}"][place], told[f"imaginary{k}"][place]) for k in range(1, count + 1)]
        key = str(int(speed))
        weave = complex(published["weave_re"][key], published["weave_im"][key])
        wanted = [weave, weave.conjugate(), published["capsize"][key], published["castering"][key]]
        for one in wanted:
            assert min(abs(one - x) for x in found) < 1e-9
        rest = [x for x in found if all(abs(x - one) > 1e-6 for one in wanted)]
        assert max(map(abs, rest), default=0) < 1e-5


FIRST = """
mbsym: 1
name: First order
parameters: {a: {}, b: {}}
linear system: {coordinates: [x, y, z], A: [[a, b, 0], [-b, a, 0], [0, 0, -3]]}
"""


def test_first_order_has_one_root_to_a_coordinate() -> None:
    """a +- i b and -3."""
    analysis, axes = mbsym.loads(FIRST), (("a", -9, 9), ("b", -9, 9))
    told = measured(RootsMeasure, analysis, [[2.0, -5.0], [1.0, 4.0]], *axes)
    assert len(told) == 6
    found = [[complex(told[f"real{k}"][p], told[f"imaginary{k}"][p]) for k in (1, 2, 3)] for p in (0, 1)]
    assert np.allclose(found, [[2 + 1j, 2 - 1j, -3], [-3, -5 + 4j, -5 - 4j]], rtol=0, atol=1e-12)
    decay = measured(DampingMeasure, analysis, [[2.0, -5.0], [1.0, 4.0]], *axes)["largest_real_part"]
    assert decay.tolist() == pytest.approx([2, -3])
    assert measured(FrequencyMeasure, analysis, [[2.0], [1.0]], *axes)["frequency1"].tolist() == pytest.approx([1])


def test_a_sleigh_mixes_both_orders() -> None:
    """(J + m a^2) z^3 + m a v z^2 + k b^2 z + k b v, by hand (tests/constrained/test_following.py), and 0, 0 of x.

    m = a = 1, J = 2, b = 4, k = 5.
    """
    speeds = [1.0, 3.0, 7.5]
    analysis = mbsym.load(ROOT / "tests/constrained/pulled-sleigh.yaml")
    told = measured(RootsMeasure, analysis, [speeds], ("v", "1/2", 9))
    assert len(told) == 10
    for place, v in enumerate(speeds):
        found = [complex(told[f"real{k}"][place], told[f"imaginary{k}"][place]) for k in range(1, 6)]
        wanted = [*np.roots([3, v, 80, 20 * v]), 0, 0]
        for one in wanted:
            assert min(abs(one - x) for x in found) < 1e-7
        assert sum(abs(x) < 1e-7 for x in found) == 2


def test_a_singular_matrix_of_first_order_gives_no_numbers() -> None:
    """A of x' = A x is divided by zero at a point: no number there, not even -3, and the next point is not touched."""
    analysis = mbsym.loads(FIRST.replace("[a, b, 0]", "[a/b, b, 0]").replace("-b, a", "-b, a/b"))
    told = measured(RootsMeasure, analysis, [[2.0, 2.0], [0.0, 1.0]], ("a", -9, 9), ("b", -9, 9))
    assert all(np.isnan(column[0]) for column in told.values())
    assert (told["real1"][1], abs(told["imaginary1"][1])) == pytest.approx((2, 1))
