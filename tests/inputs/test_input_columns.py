"""Inputs are columns of trajectory.csv: what was put in, at every row."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from conftest import filed, invoked

CART = """
mbsym: 1
name: A cart
parameters: {m: 2, k: 3}
inputs: {u: {meaning: a force}, v: {meaning: another}}
bodies:
  - {name: cart, attached to: 0, mass: m, connection point: [x, 0, 0], coordinates: [x]}
loads:
  - generalised force: {x: u + v}
initial: {x: 1}
"""


def test_inputs_are_columns(tmp_path: Path) -> None:
    """u = -k x by a law of the state, v = t; 2 x'' = -3 x + t; what is left alone is held at 0."""
    file = filed(tmp_path / "s.yaml", CART)
    words = ["simulate", str(file), "--time", "2", "--samples", "21", "-f", "csv", "--out", str(tmp_path)]
    invoked(*words, "--input", "u=-k*x", "--input", "v=t", code=0)
    rows = list(csv.DictReader((tmp_path / "trajectory.csv").open()))
    column = {name: np.array([float(row[name]) for row in rows]) for name in ("t", "x", "u", "v")}
    assert column["u"] == pytest.approx(-3 * column["x"], abs=1e-15)
    assert np.array_equal(column["v"], column["t"])
    invoked(*words, "--input", "u=1", code=0)
    rows = list(csv.DictReader((tmp_path / "trajectory.csv").open()))
    assert {row["u"] for row in rows} == {"1"}
    assert {row["v"] for row in rows} == {"0"}
