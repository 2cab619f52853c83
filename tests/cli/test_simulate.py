"""``mbsym simulate``: what is written, what is said, what goes wrong and what is kept then."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from io import BytesIO
from math import isclose, log, pi, sqrt
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from click.testing import CliRunner, Result
from conftest import SHIPPED, STIFF, WITH_BODIES, imported, parsed
from matplotlib.figure import Figure
from PIL import Image

import mbsym as library
from mbsym.numerics.between import accelerations, between
from mbsym.numerics.columns import columns
from mbsym.numerics.conservation import Standing, energy_standing, visited
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.events.switching import rates
from mbsym.numerics.methods.interface import Cause, Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.planning.choice import choose
from mbsym.numerics.scenario import Incomplete, scenario
from mbsym.numerics.simulate import least_pivot, simulate
from mbsym.report.figures.drawing import thinned
from mbsym.report.figures.figures import CORNER, Curve, _curve, figures
from mbsym.report.runs.trajectory_csv import trajectory_parts
from mbsym.source import load
from mbsym_cli import files
from mbsym_cli.files import MANIFEST
from mbsym_cli.main import main

DOUBLE = SHIPPED / "double-pendulum.yaml"
SPHERICAL = SHIPPED / "spherical-pendulum.yaml"

PARTICLE = """
mbsym: 1
name: Particle
parameters: {m: positive, k: real}
bodies:
  - name: particle
    attached to: 0
    connection point: [x, 0, 0]
    mass: m
    coordinates: [x]
loads:
"""

#: x' = sqrt(2) x**2 from x = 1: at t = 1/sqrt(2) there is no x any more.
BLOWING_UP = PARTICLE + "  - potential: -x**4\nvalues: {m: 1, k: 0}\ninitial: {x: {position: 1, velocity: sqrt(2)}}\n"

#: The place s = x**3 falls from 1 and passes zero at t = sqrt(2), where M = 9 m x**4 vanishes.
CUBE = """
mbsym: 1
name: Particle measured by a cube root
parameters: {m: 1, g: 1}
bodies:
  - {name: particle, attached to: 0, connection point: [x**3, 0, 0], mass: m, coordinates: [x]}
loads:
  - force function: -g*m*x**3
initial: {x: 1}
"""


def mbsym(*words: object) -> Result:
    return CliRunner().invoke(main, ["simulate", *(str(word) for word in words)], catch_exceptions=False)


def described(folder: Path, text: str) -> Path:
    path = folder / "system.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def dynamics_of(path: Path, **values: object) -> Dynamics:
    system, complaints, _ = load(path)
    assert system is not None, [item.message for item in complaints.items]
    return Dynamics(scenario(system, {name: parsed(str(value)) for name, value in values.items()}))


def table(path: Path) -> dict[str, Any]:
    """The columns of a table, read without any options."""
    with path.open(encoding="utf-8", newline="") as stream:
        names, *rows = csv.reader(stream)
    return dict(zip(names, np.array(rows, dtype=float).T, strict=True))


def summary(folder: Path) -> dict[str, Any]:
    return json.loads((folder / "simulation.json").read_text(encoding="utf-8"))


def written(folder: Path) -> set[str]:
    """The names in a folder but for the manifest."""
    return {path.name for path in folder.iterdir()} - {MANIFEST}


# --- what is written ---

FIGURES = ("histories", "phase-planes", "drift", "motion", "mass-centres")


def test_help_names_every_method() -> None:
    text = " ".join(CliRunner().invoke(main, ["explain", "simulate"]).output.split()).partition("Options:")[0]
    assert not [name for name in METHODS if not any(f" {name}{sign}" in text for sign in " ,;")]


def test_table_figures_and_summary(tmp_path: Path) -> None:
    done = mbsym(DOUBLE, "--time", 3, "--samples", 301, "--out", tmp_path)
    assert done.exit_code == 0, done.output
    names = {f"{stem}.png" for stem in FIGURES}
    assert written(tmp_path) == {"trajectory.csv", "simulation.json", *names}
    found = table(tmp_path / "trajectory.csv")
    assert list(found) == [
        "t", "theta1", "theta2", "theta1_dot", "theta2_dot", "energy", "relative_drift",
    ]  # fmt: skip
    assert len(found["t"]) == 301
    assert (found["t"][0], found["t"][-1]) == (0.0, 3.0)
    assert (found["theta1"][0], found["theta2"][0], found["theta1_dot"][0]) == (1.0, 0.5, 0.0)
    assert np.max(np.abs(found["relative_drift"])) < 1e-9
    # The energy is the one of two point masses on rods of length 1.
    a, b = found["theta1"], found["theta1"] + found["theta2"]
    va, vb = found["theta1_dot"], found["theta1_dot"] + found["theta2_dot"]
    energy = va**2 + vb**2 / 2 + va * vb * np.cos(a - b) - 9.81 * (2 * np.cos(a) + np.cos(b))
    assert np.max(np.abs(energy - found["energy"])) < 1e-12 * 30
    content = summary(tmp_path)
    assert content["status"] == "whole"
    assert content["parameters"]["g"] == 9.81
    assert content["initial"]["theta1"] == 1
    assert (content["energy"]["conserved"], content["energy"]["how"]) == (True, "proved")
    assert set(content["files"]) == {"trajectory.csv", *names}
    assert content["estimated_error"]["final"] < 1e-6
    assert "conserved" in done.stdout
    assert content["method"]["name"] == "dop853"


def test_the_numbers_read_back_exactly() -> None:
    dynamics = dynamics_of(SPHERICAL)
    found = simulate(dynamics, METHODS["dop853"], Setting(tolerance=1e-8), np.linspace(0, 1, 7))
    rows = [line.split(",") for line in "".join(trajectory_parts(found, {"double": 2 * found.times})).splitlines()]
    assert rows[0] == [*columns(dynamics.system), "double"]
    back = np.array(rows[1:], dtype=float).T
    assert np.array_equal(back[1:5], found.states)
    assert np.array_equal(back[0], found.times)
    assert np.array_equal(back[-1], 2 * found.times)


def test_equal_simulations_write_equal_bytes(tmp_path: Path) -> None:
    for name in ("a", "b"):
        done = mbsym(
            SHIPPED / "simple-pendulum.yaml", "--time", 2, "--samples", 50, "-f", "csv,svg", "-o", tmp_path / name
        )
        assert done.exit_code == 0, done.output
    assert written(tmp_path / "a") == {*(f"{stem}.svg" for stem in FIGURES), "simulation.json", "trajectory.csv"}
    for name in written(tmp_path / "a"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes(), name


def test_values_can_be_replaced(tmp_path: Path) -> None:
    """With g = 4 pi**2 and l = 1/4 a small swing of a point mass lasts half a second."""
    words = ["g=4*pi**2", "l1=1/4", "m2=1e-12", "l2=1e-6", "theta1=1e-6", "theta2=0"]
    settings = [part for word in words for part in ("--set", word)]
    done = mbsym(DOUBLE, "--time", "1/2", "--samples", 5, *settings, "-f", "csv", "-o", tmp_path)
    assert done.exit_code == 0, done.output
    found = table(tmp_path / "trajectory.csv")["theta1"]
    assert np.max(np.abs(found - 1e-6 * np.array([1, 0, -1, 0, 1]))) < 1e-11


def test_relations_follow_what_is_replaced() -> None:
    system, _, _ = load(SHIPPED / "satellite.yaml")
    assert system is not None
    found = scenario(system, {"R": parsed("100")})
    assert found.parameters["nu"] == Fraction(250_000)
    with pytest.raises(Incomplete) as refused:
        scenario(system, {"nu": parsed("31251")})
    assert "contradicts its relation" in str(refused.value)


def test_every_gives_equal_intervals_and_the_end(tmp_path: Path) -> None:
    done = mbsym(SPHERICAL, "--time", 1, "--every", 0.3, "-f", "csv", "-o", tmp_path)
    assert done.exit_code == 0, done.output
    assert np.allclose(table(tmp_path / "trajectory.csv")["t"], [0, 0.3, 0.6, 0.9, 1], rtol=0, atol=1e-15)


def test_first_integrals_become_columns(tmp_path: Path) -> None:
    done = mbsym(SPHERICAL, "--time", 5, "--samples", 100, "--invariants", "-f", "csv", "-o", tmp_path)
    assert done.exit_code == 0, done.output
    found = table(tmp_path / "trajectory.csv")
    momentum = np.sin(found["theta"]) ** 2 * found["psi_dot"]  # m l**2 = 1
    assert np.allclose(found["momentum_psi"], momentum, rtol=1e-13)
    assert np.ptp(found["momentum_psi"]) < 1e-8
    assert "momentum of psi (proved)" in done.stdout


@pytest.mark.parametrize("path", WITH_BODIES, ids=lambda path: path.stem)
def test_every_shipped_system_runs_as_it_is(path: Path, tmp_path: Path) -> None:
    done = mbsym(path, "--time", "1/2", "--samples", 3, "-f", "csv", "-o", tmp_path, "--tolerance", "1e-8")
    assert done.exit_code == 0, done.output
    assert all(np.all(np.isfinite(column)) for column in table(tmp_path / "trajectory.csv").values())
    assert summary(tmp_path)["energy"]["conserved"] in (True, False)


# --- figures ---


def chain(n: int) -> str:
    rods = "".join(
        f"  - {{name: rod{i}, attached to: {f'rod{i - 1}' if i else 0}, rotation: {{axes: [3], angles: [q{i}]}}, "
        f"connection point: [0, {'-l' if i else 0}, 0], mass centre: [0, -l, 0], mass: m}}\n"
        for i in range(n)
    )
    start = ", ".join(f"q{i}: 0.1" for i in range(n))
    return (
        f"mbsym: 1\nname: Chain\nparameters: {{m: 1, l: 0.1, g: 9.81}}\nbodies:\n{rods}"
        f"loads:\n  - uniform gravity: {{vector: [0, -g, 0]}}\ninitial: {{{start}}}\n"
    )


def test_many_coordinates_are_spread_over_pages(tmp_path: Path) -> None:
    dynamics = dynamics_of(described(tmp_path, chain(6)))
    found = simulate(dynamics, METHODS["dop853"], Setting(tolerance=1e-6), np.linspace(0, 0.2, 20))
    images = figures(found, ["svg"])
    assert set(images) == {"histories.svg", "histories-2.svg", "phase-planes.svg", "drift.svg"}
    for image in images.values():
        assert ElementTree.fromstring(image).tag.endswith("svg")
        assert b"<dc:date>" not in image


def test_pages_are_filled_evenly(tmp_path: Path) -> None:
    from mbsym.report.figures.figures import _pages

    system = dynamics_of(described(tmp_path, chain(2))).system

    names = [f"q{i}" for i in range(11)]
    pages = list(_pages("histories", names, 5, system))
    assert [title for _, _, title in pages] == [f"Chain, page {number} of 3" for number in (1, 2, 3)]
    assert [file for file, _, _ in pages] == ["histories", "histories-2", "histories-3"]
    assert [name for _, part, _ in pages for name in part] == names
    assert {len(part) for _, part, _ in pages} == {3, 4}


def test_a_winding_angle_is_drawn_modulo_a_turn() -> None:
    """The top spins thirty times a second: its plane is crossed by gaps, not by lines from pi to -pi."""
    from mbsym.report.figures.figures import _wrapped

    q = np.linspace(-1, 20, 200)
    wrapped, speeds = _wrapped(q, np.ones(200))
    shown = wrapped[np.isfinite(wrapped)]
    assert np.all((shown >= -pi) & (shown < pi))
    assert np.allclose(np.sin(shown), np.sin(q))
    assert np.count_nonzero(~np.isfinite(wrapped)) == 3
    assert len(speeds) == len(wrapped)
    assert np.nanmax(np.abs(np.diff(wrapped))) < 0.2


def test_thinning_keeps_the_extremes() -> None:
    from mbsym.report.figures.drawing import thinned

    times = np.linspace(0, 1, 100_000)
    values = np.sin(40_000 * times)
    values[12_345] = 7.0
    shown_times, shown = thinned(times, values)
    assert len(shown) < 5_000
    assert shown.max() == 7.0
    assert shown.min() < -0.999
    assert np.all(np.diff(shown_times) > 0)


def test_between_samples_the_curve_is_exact_to_degree_five() -> None:
    """q = t^5 - 2 t^3 + t: a quintic is its own Hermite interpolant, whatever the intervals."""
    q = np.polynomial.Polynomial([0.25, 1, 0, -2, 0, 1])
    times = np.array([0.0, 0.3, 0.6, 1.0, 1.1])
    states, rates = np.array([q(times), q.deriv()(times)]), q.deriv(2)(times)[None]
    finer, found = between(times, states, rates, [2, 5, 3, 1])
    assert len(finer) == 12
    assert np.allclose(finer[:3], [0, 0.15, 0.3])
    assert np.allclose(found, [q(finer), q.deriv()(finer)], rtol=0, atol=1e-14)
    assert np.array_equal(found[:, [0, 2, 7, 10, 11]], states)
    # Negative control: with accelerations that are wrong it is not.
    assert not np.allclose(
        between(times, states, 1.1 * rates, [2, 5, 3, 1])[1], [q(finer), q.deriv()(finer)], atol=1e-4
    )


def test_what_cannot_be_rounded_is_joined_by_straight_lines() -> None:
    times = np.array([0.0, 1.0, 2.0, 3.0])
    states = np.array([[0.0, 1.0, 3.0, 4.0], [1.0, 1.0, 1.0, 1.0]])  # from 1 to 3 at speed 1 in time 1: no smooth curve
    _, found = between(times, states, np.array([[0.0, 0.0, 0.0, np.nan]]), [4, 4, 4])
    assert np.allclose(found[0], [0, 0.25, 0.5, 0.75, 1, 1.5, 2, 2.5, 3, 3.25, 3.5, 3.75, 4], rtol=0, atol=1e-14)
    assert np.allclose(found[1], 1)


def test_phase_planes_have_no_corners() -> None:
    """An ellipse of 20 samples: 18 degrees at each of them, drawn with turns of a few degrees, and on the ellipse."""
    times = np.linspace(0, 2 * pi, 21)
    dynamics = dynamics_of(DOUBLE)
    found = simulate(dynamics, METHODS["dop853"], Setting(tolerance=1e-6), times[:2])
    found = replace(found, times=times, states=np.array([np.cos(times), 0 * times, -np.sin(times), 0 * times]))
    q, v = _curve(Curve(found, np.array([-np.cos(times), 0 * times])), 0)
    assert np.max(np.abs(np.hypot(q, v) - 1)) < 1e-5
    steps = np.unwrap(np.arctan2(np.diff(v), np.diff(q)))
    assert np.max(np.abs(np.diff(steps))) < 2 * CORNER
    plain = np.unwrap(np.arctan2(*np.diff(_curve(Curve(found), 0))[::-1]))
    assert np.max(np.abs(np.diff(plain))) > 4 * CORNER


def test_accelerations_are_those_of_the_equations() -> None:
    """A pendulum has (J + m l^2) theta'' = -m g l sin(theta) - b theta'; m = 1, l = 0.5, J = 0.1, b = 0.05."""
    dynamics = dynamics_of(SHIPPED / "simple-pendulum.yaml")
    states = np.array([[0.3, -1.2], [0.5, 0.1]])
    wanted = (-9.81 * 0.5 * np.sin(states[0]) - 0.05 * states[1]) / 0.35
    assert np.allclose(accelerations(dynamics, [0.0, 1.0], states), [wanted], rtol=1e-14, atol=0)


def test_labels_are_within_the_page(tmp_path: Path) -> None:
    """Also where the room for labels is measured once; the page's own fonts and style end with it."""
    from mbsym.report.figures.drawing import fontManager, saved, styled
    from mbsym.report.figures.figures import _drift, _histories, _planes

    installed = fontManager.ttflist
    dynamics = dynamics_of(described(tmp_path, chain(2)))
    found = simulate(dynamics, METHODS["dop853"], Setting(tolerance=1e-6), np.linspace(0, 3, 50))
    with styled():
        pages = [*_histories([Curve(found)], ""), *_planes([Curve(found)], ""), ("drift", _drift(found, "", True))]
        for stem, figure in pages:
            saved(stem, figure, ["png"])
            width, height = figure.bbox.size
            for axes in figure.axes:
                assert "get_tightbbox" not in vars(axes)
                label = axes.yaxis.label.get_window_extent()
                assert 0 <= label.x0 < label.x1 <= axes.bbox.x0, stem
                assert 0 <= label.y0 < label.y1 <= height
                below = axes.xaxis.label.get_window_extent()
                assert below.y0 >= 0
                assert below.x1 <= width
    assert fontManager.ttflist is installed


def test_numbers_along_axes_are_plain_text() -> None:
    from mbsym.report.figures.drawing import _Numbers, _Powers, saved, styled

    assert [_Powers()(x) for x in (1e-3, 1.0, 1e12)] == ["10⁻³", "10⁰", "10¹²"]
    with styled():
        figure = Figure(figsize=(3, 2), layout="constrained")
        axis = figure.subplots()
        axis.plot([0, 2e-5], [1e6, 3e6])
        images = saved("plain", figure, ["svg", "png"])
        assert isinstance(axis.xaxis.get_major_formatter(), _Numbers)
        labels = [label.get_text() for label in axis.get_xticklabels()]
        assert "0.5" in labels
        assert not any("$" in label for label in labels)
        assert axis.xaxis.get_offset_text().get_text().startswith("$")
    with Image.open(BytesIO(images["plain.png"])) as image:
        assert image.size == (450, 300)
    assert ElementTree.fromstring(images["plain.svg"]).get("width") == "216pt"


# --- what is missing or wrong ---


def test_everything_that_is_missing_is_listed_at_once(tmp_path: Path) -> None:
    text = DOUBLE.read_text(encoding="utf-8")
    bare = described(tmp_path, text[: text.index("values:")])
    done = mbsym(bare, "--time", 1, "--out", tmp_path / "out")
    assert done.exit_code == 2
    for name in ("m1", "m2", "l1", "l2", "g", "theta1", "theta2"):
        assert name in done.stderr
    assert "--set m1=" in done.stderr
    assert "values:" in done.stderr
    assert "initial:" in done.stderr
    assert not (tmp_path / "out").exists()
    given = [part for name in ("m1", "m2", "l1", "l2", "g") for part in ("--set", f"{name}=1")]
    done = mbsym(
        bare, "--time", 1, *given, "--set", "theta1=1", "--set", "theta2=0", "-f", "csv", "-o", tmp_path / "out"
    )
    assert done.exit_code == 0, done.output


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--time", "nan"], ["--time", "nan"]),
        (["--time", "-1"], ["positive"]),
        (["--time", "0"], ["positive"]),
        (["--time", "1e400"], ["digits"]),
        (["--time", "theta1"], ["number is wanted"]),
        (["--time", "1", "--samples", "0"], ["at least 2"]),
        (["--time", "1", "--samples", "1000000000"], ["too many", "at most"]),
        (["--time", "1", "--every", "1e-40"], ["too many"]),
        (["--time", "1", "--every", "1/2", "--samples", "3"], ["exclude"]),
        (["--time", "1", "--tolerance", "1e-40"], ["between"]),
        (["--time", "1", "--step", "0.1"], ["rk4"]),
        (["--time", "1", "--method", "rk4"], ["--step"]),
        (["--time", "1", "--method", "dop835"], ["did you mean 'dop853'"]),
        (["--time", "1", "--method", "dop853", "--step", "0.1"], ["--tolerance"]),
        (["--time", "1", "--method", "radau", "--arithmetic", "extended"], ["dop853"]),
        (["--time", "1", "--format", "eps"], ["csv, svg, png"]),
        (["--time", "1", "--set", "x"], ["name=value"]),
        (["--time", "1", "--set", 'm1=__import__("os")'], ["__import__"]),
        (["--time", "1", "--set", "tetha1=1", "--set", "m1=q"], ["did you mean 'theta1'", "unknown name 'q'"]),
        (["--time", "1", "--set", "m1=2*", "--set", "l1=1/0", "--time", "x"], ["ends too early", "division", "'x'"]),
        (["--time", "1", "--set", "m1=1", "--set", "m1=2"], ["twice"]),
        (["--time", "1", "--set", "m1=-1", "--set", "l1=0"], ["m1 = -1", "l1 = 0", "declared positive"]),
        (["--time", "1", "--set", "m1=exp(1e50)"], ["range"]),
        (["--time", "1", "--set", "m1=(1e59)**64"], ["range"]),
        (["--time", "1", "--set", "m1=log(-1)"], ["no real number"]),
        (["--time", "1", "--set", "m1=l1", "--set", "l1=m1"], ["no value for m1, l1"]),
    ],
)  # fmt: skip
def test_wrong_input_is_explained(words: Sequence[str], said: Sequence[str], tmp_path: Path) -> None:
    done = mbsym(DOUBLE, *words, "--out", tmp_path / "out")
    assert done.exit_code == 2, done.output
    for text in said:
        assert text in done.output
    assert "Traceback" not in done.output
    assert not (tmp_path / "out").exists()


def test_a_folder_that_cannot_be_written_is_found_before_computing(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    done = mbsym(DOUBLE, "--time", "1e50", "--out", tmp_path / "file" / "out")
    assert done.exit_code == 1
    assert "no folder" in done.stderr


# --- what goes wrong on the way ---


@pytest.mark.parametrize("method", [["dop853"], ["lsoda"], ["rk4", "--step", "1e-3"]], ids=lambda words: words[0])
def test_a_blow_up_keeps_what_there_was(method: list[str], tmp_path: Path) -> None:
    path = described(tmp_path, BLOWING_UP)
    kinds = "csv,svg" if method == ["dop853"] else "csv"
    done = mbsym(path, "--time", 5, "--every", 0.01, "--method", *method, "-f", kinds, "-o", tmp_path / "out")
    assert done.exit_code == 3, done.output
    assert "blow-up at t = 0.70" in done.stderr
    assert "x = " in done.stderr
    assert "x_dot = " in done.stderr
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert "trajectory-partial.csv" in names
    assert ("histories-partial.svg" in names) == ("svg" in kinds)
    assert "trajectory.csv" not in names
    found = table(tmp_path / "out" / "trajectory-partial.csv")
    assert found["t"][-1] == pytest.approx(0.70)
    early = found["t"] < 0.6
    assert np.allclose(found["x"][early], 1 / (1 - sqrt(2) * found["t"][early]), rtol=1e-7)
    content = summary(tmp_path / "out")
    assert (content["status"], content["ended"]["kind"]) == ("partial", "blow-up")
    assert isclose(content["ended"]["time"], 1 / sqrt(2), abs_tol=0.01)


#: One turn of a planet a = 4.5e12 m away about the sun takes 2 pi sqrt(a^3/mu), on a circle at the speed sqrt(mu/a).
NEPTUNE = """
mbsym: 1
name: Planet in metres
parameters: {m: positive, mu: positive}
bodies:
  - {name: planet, attached to: 0, connection point: [x, y, 0], mass: m, coordinates: [x, y]}
loads:
  - potential: -mu*m/sqrt(x**2 + y**2)
values: {m: 1, mu: 1.327e20}
initial: {x: 4.5e12, y: {position: 0, velocity: sqrt(1.327e20/4.5e12)}}
"""


def test_a_planet_in_metres_is_no_blow_up(tmp_path: Path) -> None:
    turn = 2 * pi * sqrt(4.5e12**3 / 1.327e20)
    done = mbsym(described(tmp_path, NEPTUNE), "--time", repr(turn), "-f", "csv", "-o", tmp_path / "out")
    assert done.exit_code == 0, done.output
    found = table(tmp_path / "out" / "trajectory.csv")
    assert (found["x"][-1] / 4.5e12, found["y"][-1] / 4.5e12) == pytest.approx((1, 0), abs=1e-7)
    assert np.hypot(found["x"], found["y"]) / 4.5e12 == pytest.approx(1, abs=1e-7)


def test_a_constant_too_large_for_float32_is_said_to_be_that(tmp_path: Path) -> None:
    """1e26 kg times mu is about 1e46; single precision ends at 3.4e38."""
    path = described(tmp_path, NEPTUNE.replace("m: 1,", "m: 1e26,"))
    done = mbsym(path, "--time", "1e8", "--arithmetic", "float32", "-f", "csv", "-o", tmp_path / "out")
    assert done.exit_code != 0
    assert "beyond the range of float32" in done.stderr


def test_exponential_growth_is_not_said_to_end_in_finite_time(tmp_path: Path) -> None:
    """x'' = 100 x from x = 1, x' = 10 is exp(10 t), finite at all times; its velocity is 1e150 at 14.9 ln(10)."""
    text = PARTICLE + "  - potential: -50*x**2\nvalues: {m: 1, k: 0}\ninitial: {x: {position: 1, velocity: 10}}\n"
    asked = (described(tmp_path, text), "--every", 0.05, "-f", "csv", "-o", tmp_path / "out")
    done = mbsym(*asked, "--time", 30)
    assert done.exit_code == 0, done.output
    found = table(tmp_path / "out" / "trajectory.csv")
    assert np.allclose(found["x"], np.exp(10 * found["t"]), rtol=1e-8)
    done = mbsym(*asked, "--time", 40)
    assert done.exit_code == 3
    assert "a coordinate or velocity is beyond 1e+150" in done.stderr
    assert "every bound" not in done.output
    assert "in finite time or exponentially" in done.stderr
    assert 14.9 * log(10) <= summary(tmp_path / "out")["ended"]["time"] < 14.9 * log(10) + 0.05


#: A wall a thousandth wide and twice as high as the energy, far from where the motion starts.
WALL = (
    PARTICLE
    + """\
  - potential: exp(-1000000*(x - 10)**2)
values: {m: 1, k: 0}
initial: {x: {position: 0, velocity: 1}}
"""
)


def test_a_narrow_wall_is_met_or_told(tmp_path: Path) -> None:
    """The wall at 10, a thousandth wide, throws it back; long steps of one length go over it, and say so."""
    path = described(tmp_path, WALL)
    done = mbsym(path, "--time", 20, "-f", "csv", "-o", tmp_path / "out")
    assert "warning" not in done.stdout
    assert "conserved (proved)" in done.stdout
    assert abs(table(tmp_path / "out" / "trajectory.csv")["x"][-1]) < 0.01
    over = mbsym(path, "--time", 20, "-f", "csv", "--method", "rk4", "--step", "0.02", "-o", tmp_path / "out")
    assert "warning" in over.stdout
    near = ("--time", 4, "--set", "x=8", "-f", "csv")  # what it does out there is not of interest to short steps
    fine = mbsym(path, *near, "--method", "rk4", "--step", "2e-4", "-o", tmp_path / "out")
    assert abs(table(tmp_path / "out" / "trajectory.csv")["x"][-1] - 8) < 0.01, fine.stdout


def test_marked_results_replace_whole_ones_and_are_replaced(tmp_path: Path) -> None:
    """A table beside ``simulation.json`` always belongs to it."""
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "notes.csv").write_text("mine")
    path = described(tmp_path, BLOWING_UP)
    for end, name in (("1/2", "trajectory.csv"), ("1", "trajectory-partial.csv"), ("1/2", "trajectory.csv")):
        mbsym(path, "--time", end, "-f", "csv", "-o", tmp_path / "out")
        assert written(tmp_path / "out") == {name, "simulation.json", "notes.csv"}


def test_the_pole_is_a_singular_mass_matrix(tmp_path: Path) -> None:
    done = mbsym(SPHERICAL, "--time", 1, "--set", "theta=0", "-o", tmp_path)
    assert done.exit_code == 3, done.output
    assert "singular mass matrix at t = 0" in done.stderr
    assert "theta = 0" in done.stderr
    assert written(tmp_path) == {"trajectory-partial.csv", "simulation.json"}
    assert len(table(tmp_path / "trajectory-partial.csv")["t"]) == 1


def test_a_rounded_pole_is_one_too() -> None:
    """sin(pi) in doubles is 1e-16, not zero."""
    found = simulate(dynamics_of(SPHERICAL, theta="pi"), METHODS["dop853"], Setting(tolerance=1e-8), [0, 1])
    assert found.breakdown is not None
    assert found.breakdown.kind == Cause.SINGULAR


def test_a_coordinate_that_loses_its_meaning_on_the_way(tmp_path: Path) -> None:
    done = mbsym(described(tmp_path, CUBE), "--time", 3, "--every", "0.01", "-f", "csv", "-o", tmp_path / "out")
    assert done.exit_code == 3, done.output
    assert "singular mass matrix at t = 1.414213" in done.stderr
    found = table(tmp_path / "out" / "trajectory-partial.csv")
    assert found["t"][-1] == pytest.approx(1.41)
    assert np.max(np.abs(found["x"] ** 3 - (1 - found["t"] ** 2 / 2))) < 1e-8


def test_a_near_singularity_is_mentioned() -> None:
    dynamics = dynamics_of(SPHERICAL, psi_dot="1e-6")
    times = [0.0, *np.linspace(0.5, 0.55, 5_001)]  # a quarter of the swing
    found = simulate(dynamics, METHODS["dop853"], Setting(tolerance=1e-9), times)
    assert found.whole
    ratio, at = least_pivot(dynamics, found)
    assert ratio < 1e-8
    assert abs(found.states[1, np.searchsorted(found.times, at)]) < 1e-3
    assert least_pivot(dynamics_of(DOUBLE), found)[0] > 0


@pytest.mark.parametrize("rows", [2, 2001])
@pytest.mark.parametrize("aside", ["1e-6", "1/2"])
def test_a_near_singularity_is_seen_between_rows(rows: int, aside: str, tmp_path: Path) -> None:
    """A spherical pendulum passes by its pole after a quarter of a swing, where M loses rank, or wide of it."""
    asked = ("--time", "0.8", "--samples", rows, "--set", f"psi_dot={aside}", "-f", "csv", "-o", tmp_path)
    done = mbsym(SPHERICAL, *asked)
    assert done.exit_code == 0, done.output
    assert ("nearly singular" in done.output) == (aside == "1e-6")


def test_a_step_limit_keeps_what_there_was(tmp_path: Path) -> None:
    done = mbsym(DOUBLE, "--time", 60, "--step-limit", 200, "-f", "csv", "-o", tmp_path)
    assert done.exit_code == 3
    assert "step limit at t = " in done.stderr
    assert "--step-limit" in done.stderr
    assert 1 < table(tmp_path / "trajectory-partial.csv")["t"][-1] < 60


def test_an_initial_state_out_of_bounds(tmp_path: Path) -> None:
    done = mbsym(DOUBLE, "--time", 1, "--set", "theta1=1e50", "-f", "csv", "-o", tmp_path)
    assert done.exit_code == 3
    assert "beyond" in done.stderr


@pytest.mark.skipif(os.name == "nt", reason="signals are another matter there")
def test_an_interrupt_keeps_what_there_was(tmp_path: Path) -> None:
    """A simulation of years is stopped once the first rows are there."""
    program = (
        "import sys, mbsym.numerics.simulate as s\n"
        "run = s.followed\n"
        "def announced(dynamics, method, setting, times, rows, scalar, watch, *more, **named):\n"
        "    told = []\n"
        "    def seen(t):\n"
        "        if not told:\n"
        "            print('begun', flush=True)\n"
        "        told.append(t)\n"
        "        watch(t)\n"
        "    return run(dynamics, method, setting, times, rows, scalar, seen, *more, **named)\n"
        "s.followed = announced\n"
        "from mbsym_cli.main import main\n"
        "main(sys.argv[1:])\n"
    )
    words = ["simulate", str(DOUBLE), "--time", "1e6", "--every", "1", "-f", "csv", "-o", str(tmp_path)]
    process = subprocess.Popen(
        [sys.executable, "-c", program, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "begun\n"
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130, said
    assert "interrupted" in said
    assert "Traceback" not in said
    found = table(tmp_path / "trajectory-partial.csv")
    assert 1 < len(found["t"]) < 1e6
    assert summary(tmp_path)["ended"]["kind"] == "interrupted"
    assert summary(tmp_path)["reached"]["samples"] == len(found["t"])


def test_a_failed_write_leaves_no_half_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(files.os, "fsync", full)
    done = mbsym(DOUBLE, "--time", 1, "-f", "csv", "-o", tmp_path)
    assert done.exit_code == 1
    assert "No space left" in done.stderr
    assert list(tmp_path.iterdir()) == []


# --- energy, choice of the method ---


def known(path: Path, **values: object) -> Standing:
    """What is known of the energy, before anything moves."""
    dynamics = dynamics_of(path, **values)
    start = np.array([float(x) for x in dynamics.scenario.state])
    return energy_standing(dynamics, visited(np.zeros(1), start[:, None], np.zeros(1)))[0]


def test_energy_is_known_to_be_conserved_or_not(tmp_path: Path) -> None:
    assert known(SHIPPED / "satellite.yaml") is Standing.PROVED
    assert known(SHIPPED / "simple-pendulum.yaml") is Standing.CHANGING
    assert known(SHIPPED / "ziegler.yaml") is Standing.CHANGING
    # A weak damper is one: nothing is rounded away.
    assert known(SHIPPED / "simple-pendulum.yaml", b="1e-20") is Standing.CHANGING
    driven = PARTICLE + "  - force function: k*x*sin(t)\nvalues: {m: 1, k: 1}\ninitial: {x: 1}\n"
    assert known(described(tmp_path, driven)) is Standing.CHANGING
    assert known(described(tmp_path, driven), k=0) is Standing.PROVED


def test_the_jacobian_gives_rates_and_frequencies(tmp_path: Path) -> None:
    decay, frequency = rates(dynamics_of(described(tmp_path, STIFF)))
    assert decay == pytest.approx(1e6, rel=1e-6)
    assert frequency == pytest.approx(1, rel=1e-6)


def test_auto_takes_an_explicit_method_where_nothing_is_stiff() -> None:
    chosen = choose(dynamics_of(DOUBLE), 1e-10, 60)
    assert chosen.method.traits.name == "dop853"
    assert "nothing stiff" in chosen.why


def test_auto_takes_an_implicit_method_for_a_stiff_system(tmp_path: Path) -> None:
    """x creeps as exp(-1e-6 t) once its velocity has settled; the other particle swings as cos t."""
    path = described(tmp_path, STIFF)
    done = mbsym(path, "--time", 100, "--every", 20, "-f", "csv", "-o", tmp_path / "out")
    assert done.exit_code == 0, done.output
    content = summary(tmp_path / "out")
    # Nothing links the two, so only the stiff one pays.
    methods = {part["coordinates"][0]: part["method"] for part in content["parts"]}
    assert methods["x"] in ("rodas5p", "lsoda", "radau", "bdf")
    assert methods["y"] == "dop853"
    assert content["method"]["name"] == "parts"
    assert "stiff" in content["method"]["why"]
    assert content["work"]["steps"] < 100_000
    found = table(tmp_path / "out" / "trajectory.csv")
    assert np.max(np.abs(found["x"] - np.exp(-1e-6 * found["t"]))) < 1e-7
    assert np.max(np.abs(found["y"] - np.cos(found["t"]))) < 1e-6


@pytest.mark.parametrize(("method", "step", "order"), [("rk4", "0.05", 4), ("midpoint", "0.01", 2)])
def test_a_fixed_step_is_the_step_that_is_taken(method: str, step: str, order: int, tmp_path: Path) -> None:
    """Rows never shorten it, and its error, against a quarter of it, falls with its order."""
    errors = []
    for part in (1, 2):
        length = float(step) / part
        words = ("--time", 2, "--method", method, "--step", length, "--format", "csv", "--out", tmp_path)
        done = mbsym(SHIPPED / "double-pendulum.yaml", *words)
        assert done.exit_code == 0, done.output
        assert "shortened" not in done.output
        assert summary(tmp_path)["work"]["steps"] == round(2 / length)
        rows = np.diff(table(tmp_path / "trajectory.csv")["t"]) / length
        assert np.allclose(rows, np.round(rows), atol=1e-6)
        errors.append(summary(tmp_path)["estimated_error"]["final"])
    assert errors[1] > 0
    assert 0.6 * 2**order < errors[0] / errors[1] < 1.6 * 2**order


def test_rows_between_fixed_steps_cost_no_steps(tmp_path: Path) -> None:
    """A step stays what it is asked for, however close the rows; where rows lie between, it is said."""
    words = ("--time", 1, "--method", "rk4", "--format", "csv", "-v")
    steps, ends = set(), []
    for k, rows in enumerate((("--every", "0.01"), ("--samples", "101"), ("--every", "0.05"), ("--samples", "11"))):
        done = mbsym(SHIPPED / "double-pendulum.yaml", *words, *rows, "--step", "0.05", "--out", tmp_path / str(k))
        assert done.exit_code == 0, done.output
        assert ("rows between the ends of steps by the polynomial" in done.stdout) == (k < 2)
        steps.add(summary(tmp_path / str(k))["work"]["steps"])
        ends.append(table(tmp_path / str(k) / "trajectory.csv"))
    assert steps == {20}
    for name in ("theta1", "theta2_dot"):
        assert len({one[name][-1] for one in ends}) == 1
        assert np.allclose(ends[0][name][::5], ends[2][name], rtol=0, atol=1e-14)
    done = mbsym(SHIPPED / "double-pendulum.yaml", *words, "--every", "0.1", "--step", "0.03", "--out", tmp_path)
    assert "step 0.03, float64 rows between the ends of steps" in " ".join(done.stdout.split())


def test_the_state_at_a_step_limit_is_kept(tmp_path: Path) -> None:
    """Between rows that are far apart: without it nothing would be left but the start."""
    words = ("--time", 1e6, "--samples", 3, "--step-limit", 500, "--format", "csv", "--out", tmp_path)
    done = mbsym(SHIPPED / "double-pendulum.yaml", *words)
    assert done.exit_code == 3
    found = table(tmp_path / "trajectory-partial.csv")
    assert len(found["t"]) == 2
    last = float(found["t"][-1])
    assert last > 1
    again = ("--time", last, "--samples", 2, "--format", "csv", "--no-estimate", "--out", tmp_path / "whole")
    assert mbsym(SHIPPED / "double-pendulum.yaml", *again).exit_code == 0
    whole = table(tmp_path / "whole" / "trajectory.csv")
    assert found["energy"][-1] == pytest.approx(whole["energy"][-1], rel=1e-6)


def test_velocities_are_joined_by_straight_lines_too() -> None:
    times = np.array([0.0, 1.0, 2.0])
    states = np.array([[0.0, 9.0, 10.0], [1.0, 3.0, 2.0]])  # 9 in time 1 at speeds 1 to 3: no smooth curve
    _, found = between(times, states, np.zeros((1, 3)), [4, 2])
    assert np.allclose(found[0], [0, 2.25, 4.5, 6.75, 9, 9.5, 10], rtol=0, atol=1e-14)
    assert np.allclose(found[1], [1, 1.5, 2, 2.5, 3, 2.5, 2], rtol=0, atol=1e-14)


def test_thinning_keeps_both_ends() -> None:
    times = np.linspace(0, 1, 100_000)
    shown, _ = thinned(times, np.sin(40_000 * times))
    assert (shown[0], shown[-1]) == (0, 1)


# --- what is somebody else's ---


def test_files_that_it_did_not_write_survive(tmp_path: Path) -> None:
    """Names like its own, and its own names with other contents: only what it wrote itself goes."""
    (tmp_path / "trajectory-x.csv").write_text("mine")
    (tmp_path / "histories-7.png").write_text("mine")
    assert mbsym(DOUBLE, "--time", 1, "--samples", 9, "-f", "csv,svg", "-o", tmp_path).exit_code == 0
    (tmp_path / "drift.svg").write_text("redrawn by hand")
    assert mbsym(DOUBLE, "--time", 1, "--samples", 9, "-f", "csv", "-o", tmp_path).exit_code == 0
    kept = {"trajectory-x.csv": "mine", "histories-7.png": "mine", "drift.svg": "redrawn by hand"}
    assert {name: (tmp_path / name).read_text() for name in kept} == kept
    assert written(tmp_path) == {"trajectory.csv", "simulation.json", *kept}


def test_pages_are_let_go_once_they_are_drawn(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Fifty pages of a chain of a hundred at once are a gigabyte."""
    from mbsym.report.figures import figures as drawn

    seen: list[Figure] = []
    most = 0

    def saved(stem: str, figure: Figure, formats: Sequence[str]) -> dict[str, bytes]:
        nonlocal most
        seen.append(figure)
        most = max(most, sum(bool(page.axes) for page in seen))
        return {f"{stem}.svg": b""}

    monkeypatch.setattr(drawn, "saved", saved)
    dynamics = dynamics_of(described(tmp_path, chain(12)))
    found = simulate(dynamics, METHODS["dop853"], Setting(tolerance=1e-6), np.linspace(0, 0.1, 5))
    assert len(figures(found, ["svg"])) == 6
    assert most == 1


def test_two_energies_are_two_columns(tmp_path: Path) -> None:
    """In an orbit T - U and T2 - T0 - U are different numbers; the drift is that of the one that is conserved."""
    path = SHIPPED / "satellite.yaml"
    assert mbsym(path, "--time", 1, "--samples", 5, "-f", "csv", "-o", tmp_path).exit_code == 0
    found, content = table(tmp_path / "trajectory.csv"), summary(tmp_path)
    run = library.simulate(path, 1, samples=5)
    assert np.array_equal(found["energy"], run.energy)
    assert np.array_equal(found["generalized_energy"], run.generalized_energy)
    assert np.ptp(found["energy"]) > 1e-3
    assert CliRunner().invoke(main, ["run", str(path), "-f", "python", "-o", str(tmp_path / "run")]).exit_code == 0
    model = imported(tmp_path / "run" / "model.py")
    for k, t in enumerate(run.times):
        state = run.coordinates[:, k], run.velocities[:, k], model.DEFAULTS, t
        assert model.energy(*state) == pytest.approx(found["energy"][k], rel=1e-12)
        assert model.generalized_energy(*state) == pytest.approx(found["generalized_energy"][k], rel=1e-12)
    assert np.max(np.abs(found["relative_drift"])) < 1e-9
    assert (content["energy"]["is"], content["energy"]["conserved"]) == ("T - U", False)
    generalized = content["generalized_energy"]
    assert (generalized["is"], generalized["conserved"], generalized["how"]) == ("T2 - T0 - U", True, "proved")


def test_bodies_and_the_moving_system_are_written_when_asked_for(tmp_path):
    """--bodies and --animate add to the formats; without them nothing new is written."""
    command = ["simulate", str(SHIPPED / "simple-pendulum.yaml"), "--time", "1", "--samples", "21", "--no-estimate"]
    plain = CliRunner().invoke(main, [*command, "--format", "csv", "--out", str(tmp_path / "plain")])
    assert plain.exit_code == 0
    assert {path.name for path in (tmp_path / "plain").iterdir()} == {
        "trajectory.csv",
        "simulation.json",
        ".mbsym.json",
    }
    more = [*command, "--format", "csv", "--bodies", "--animate", "--out", str(tmp_path / "more")]
    assert CliRunner().invoke(main, more).exit_code == 0
    written = {path.name for path in (tmp_path / "more").iterdir()}
    assert {"trajectory.csv", "bodies.csv", "animation.html", "animation.gif"} < written
    listed = json.loads((tmp_path / "more" / "simulation.json").read_text(encoding="utf-8"))["files"]
    assert {"bodies.csv", "animation.html", "animation.gif"} < set(listed)
    header, first, *_ = (tmp_path / "more" / "bodies.csv").read_text(encoding="utf-8").splitlines()
    assert header.split(",")[1] == "pendulum.position_1"
    assert len(first.split(",")) == len(header.split(","))
