"""Curves of a periodic solution and of the motion beside it: angles by direction cosines, rates by differences."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from conftest import SHIPPED, filed, invoked

import mbsym
from mbsym.algebra.failures import NoClosedForm
from mbsym.analysis import Analysis
from mbsym.analysis.oscillating import oscillating
from mbsym.report.figures.oscillation_figure import oscillation_figures
from mbsym.report.language import Language
from mbsym.simulation.oscillation_paths import oscillation_paths

DUFFING = """mbsym: 1
name: Duffing
parameters: {eps: {sign: positive}}
small parameter: eps
bodies:
  - {name: mass, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - potential: 2*x**2 + eps*x**4/4
"""
NUMBERS = "values: {eps: 1/5}\ninitial: {x: {position: 1/2, velocity: 0}}\n"


@pytest.fixture(scope="module")
def gyrostat():
    system = mbsym.load(SHIPPED / "gyrostat-fast.yaml").system
    told = oscillating(Analysis(system, (12,)), 2)
    return system, told, oscillation_paths(system, told, periods=0.5)


def test_the_gyrostats_angles_are_those_of_its_vertical(gyrostat):
    """gamma = (sin theta sin phi, sin theta cos phi, cos theta), and psi' sin^2 theta = p gamma1 + q gamma2."""
    found = gyrostat[2]
    psi, theta, phi = (found.angles[name][1] for name in ("psi", "theta", "phi"))
    gamma = [found.motion[f"gamma{k}"][0] for k in (1, 2, 3)]
    seen = np.sin(theta) * np.sin(phi), np.sin(theta) * np.cos(phi), np.cos(theta)
    for one, angles in zip(gamma, seen, strict=True):
        assert np.abs(one - angles).max() < 2e-4  # gamma of the series at t = 0 has the length 1 to order eps^3
    known = (found.motion["p"][0] * gamma[0] + found.motion["q"][0] * gamma[1]) / np.sin(theta) ** 2
    assert np.abs(known - np.gradient(psi, found.times))[1:-1].max() < 2e-3 * np.abs(known).max()


def test_rates_are_slopes_and_both_curves_are_near(gyrostat):
    found = gyrostat[2]
    for name in found.names:
        for x, rate in (found.series[name], found.motion[name]):
            assert np.abs(np.gradient(x, found.times) - rate)[1:-1].max() < 1e-3 * np.ptp(rate)
        # How fast the distance falls with eps is measured elsewhere; here they are curves of one motion.
        assert np.abs(found.series[name][0] - found.motion[name][0]).max() < 0.1 * np.ptp(found.motion[name][0])


def test_a_planted_error_parts_the_curves(gyrostat):
    """gamma3 without its first order, about which it swings."""
    system, told, right = gyrostat
    place, series = told.oscillation.names.index("gamma3"), list(told.oscillation.series)
    series[place] = (series[place][0], series[place][1].scaled(told.oscillation.tower.zero), series[place][2])
    wrong = replace(told, oscillation=replace(told.oscillation, series=tuple(series)))
    found = oscillation_paths(system, wrong, periods=0.5)
    away = [np.abs(x.series["gamma3"][0] - x.motion["gamma3"][0]).max() for x in (right, found)]
    assert away[1] > 100 * away[0]


def test_in_coordinates_with_numbers_put_in():
    system = mbsym.loads(DUFFING + NUMBERS).system
    for amplitude in (Fraction(1, 2), Fraction(1)):
        values = {"amplitude": amplitude}
        found = oscillation_paths(system, oscillating(Analysis(system, (12,)), 2, values), values, 1.0)
        assert found.motion["x"][0][0] == pytest.approx(float(amplitude))
        assert np.abs(found.series["x"] - found.motion["x"]).max() < 1e-4
        assert found.angles == {}


def test_without_an_amplitude_nothing_is_drawn():
    system = mbsym.loads(DUFFING + NUMBERS.replace("1/2", "0")).system
    with pytest.raises(NoClosedForm, match="begins at the centre"):
        oscillation_paths(system, oscillating(Analysis(system, (12,)), 1))


def test_titles_and_legends_follow_the_language():
    system = mbsym.loads(DUFFING + NUMBERS).system
    told = oscillating(Analysis(system, (12,)), 1)
    paths = oscillation_paths(system, told, periods=0.5)
    drawn = oscillation_figures(system, paths, told.oscillation, ["svg"], Language("es"))[
        "oscillation-planes.svg"
    ].decode()
    assert "movimiento (simulaci" in drawn
    assert "motion" not in drawn


def test_the_command_draws(tmp_path):
    file = filed(tmp_path / "duffing.yaml", DUFFING + NUMBERS)
    words = ["oscillations", str(file), "--order", "1", "--format", "svg", "--out", str(tmp_path / "out")]
    assert invoked(*words).exit_code == 0
    assert {x.name for x in (tmp_path / "out").glob("*.svg")} == {"oscillation.svg", "oscillation-planes.svg"}
    words[-1] = str(tmp_path / "ru")
    assert invoked(*words, "--language", "ru").exit_code == 0
    english, russian = ((tmp_path / one / "oscillation.svg").read_bytes() for one in ("out", "ru"))
    assert english != russian
    done = invoked(*words, "--language", "xx")
    assert (done.exit_code, "language" in done.stderr) == (2, True)
    file.write_text(DUFFING, encoding="utf-8")
    done = invoked(*words, code=1)
    assert "no figures: the description does not give all numbers" in " ".join(done.stderr.split())
    done = invoked("oscillations", file, "--out", tmp_path, code=2)
    assert "nothing is written without --format" in " ".join(done.stderr.split())
