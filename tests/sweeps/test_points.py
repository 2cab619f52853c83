"""The points of a sweep are the same however they are cut, and those that are asked for."""

from __future__ import annotations

import numpy as np
import pytest

from mbsym.numerics.ensembles.variation import Draw, Grid, Points, complaints
from mbsym.sweeps.statistics import interval
from mbsym.sweeps.sweep import chunks, shard

GRID = Points((Grid("a", 0.0, 1.0, 5), Grid("b", -1.0, 1.0, 3)))
DRAWS = (Draw("a", "uniform", 0.0, 2.0), Draw("b", "normal", 1.0, 0.1))


@pytest.mark.parametrize("points", [GRID, Points(DRAWS, 15, 7), Points(DRAWS, 15, 7, "sobol")], ids=str)
def test_parts_make_the_whole(points: Points) -> None:
    whole = points.part(0, 15)
    parts = [points.part(k, min(k + 4, 15)) for k in range(0, 15, 4)]
    assert np.array_equal(whole, np.concatenate(parts, axis=1))


def test_the_last_name_of_a_grid_varies_fastest() -> None:
    assert GRID.count == 15
    assert GRID.part(0, 4).tolist() == [[0.0, 0.0, 0.0, 0.25], [-1.0, 0.0, 1.0, -1.0]]


def test_draws_have_their_distributions() -> None:
    a, b = Points(DRAWS, 200_000, 3).part(0, 200_000)
    assert (a.min() >= 0, a.max() <= 2) == (True, True)
    assert abs(a.mean() - 1) < 0.01
    assert abs(b.mean() - 1) < 0.002
    assert abs(b.std() - 0.1) < 0.002


def test_shards_divide_the_chunks() -> None:
    every = chunks(1_000, 64)
    assert [chunk.stop for chunk in every][-1] == 1_000
    shares = [shard(every, number, 3) for number in (1, 2, 3)]
    assert sorted(chunk.number for share in shares for chunk in share) == list(range(len(every)))


def test_everything_that_is_wrong_is_said() -> None:
    wrong = [Grid("a", 1.0, 1.0, 5), Draw("a", "normal", 0.0, -1.0), Draw("c", "uniform", 2.0, 1.0)]
    told = [text for _, text, _ in complaints(wrong, None, ["a", "b"])]
    assert [text.split(" ")[0] for text in told] == ["the", "a", "the", "there", "the", "a"]


def test_the_interval_is_that_of_clopper_and_pearson() -> None:
    """Their tables (Biometrika 26 (1934) 404): 0 of 10 at 95 %: 0 to 0.3085; 5 of 10: 0.187 to 0.813."""
    assert interval(0, 10) == pytest.approx((0.0, 0.30850), abs=1e-5)
    assert interval(5, 10) == pytest.approx((0.18709, 0.81291), abs=1e-5)
    assert interval(10, 10) == pytest.approx((0.69150, 1.0), abs=1e-5)
