"""Euler's angles of the fast gyrostat by integration, against references/gyrostat 2.2, derived without mbsym."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from conftest import SHIPPED

import mbsym
from mbsym.algebra import rationals
from mbsym.algebra.failures import NoClosedForm
from mbsym.analysis import Analysis
from mbsym.analysis.oscillating import NoRate, oscillating, with_integrals
from mbsym.expressions.place import Complaints
from mbsym.numerics.scenario import scenario
from mbsym.problems.small_parameter.oscillations import AMPLITUDE
from mbsym.simulation.oscillating import Numeric, symbol_values
from mbsym.simulation.oscillation_paths import oscillation_paths
from mbsym.source.scaling import assignments

PSI = "(p*gamma1 + q*gamma2)/(gamma1**2 + gamma2**2)"
ANGLES = {
    "psi": PSI,
    "theta": "(p*gamma2 - q*gamma1)/sqrt(gamma1**2 + gamma2**2)",
    "phi": f"r - {PSI}*gamma3",
}


def rates(**formulas):
    text = ",".join(f"{name}={rate}" for name, rate in formulas.items())
    return {one.name: one.value for one in assignments(text, Complaints())}


@pytest.fixture(scope="module")
def analysis():
    return Analysis(mbsym.load(SHIPPED / "gyrostat-fast.yaml").system, (12,))


@pytest.fixture(scope="module")
def solutions(analysis):
    """Without and with a gyrostatic moment about the axis x."""
    return {
        moment: with_integrals(
            oscillating(analysis, 1 + moment, {} if moment else {"lx": Fraction(0)}), analysis, rates(**ANGLES)
        )
        for moment in (0, 1)
    }


#: One gyrostat; the amplitude and gamma'' at rest are sine and cosine of theta_0.
NUMBERS = {"R": 5, "g": 7, "M": 2, "A": 3, "B": 4, "C": 6, "x0": 2, "y0": 3, "z0": 5, "lx": 1, "lz": 2}
SIN, COS, RATE = Fraction(3, 5), Fraction(4, 5), 11


def at(told, x):
    values = {name: Fraction(number) for name, number in NUMBERS.items()}
    values |= {AMPLITUDE: SIN, "#gamma3": COS, "#r": Fraction(RATE)}
    tower = told.oscillation.tower
    known = dict.fromkeys(tower.parameters, rationals.ball(Fraction(0)))
    return float(tower.enclosed(x, known | {n: rationals.ball(v) for n, v in values.items()}).real)


def waves(told, name, order):
    """{k: (cosine, sine)} and the rate of one order."""
    (one,) = [x for x in told.oscillation.drifts if x.variable == name]
    found = {k: tuple(at(told, x) for x in pair) for k, pair in one.waves[order].waves.items()}
    return found, at(told, one.rates[order])


def by_hand():
    n = NUMBERS
    a, b, nz = n["A"] / n["C"], n["B"] / n["C"], n["lz"] / (n["C"] * RATE)
    weight = n["M"] * n["g"] * float(COS) / (n["C"] * RATE**2)
    x, y, z = (weight * n[name] for name in ("x0", "y0", "z0"))
    k = 3 * n["g"] * float(COS) ** 2 / (n["R"] * RATE**2)
    a1, b1, big_x = (1 - b) / a, (a - 1) / b, a / (1 - b + nz)
    omega2 = (1 - b + nz) * (1 - a + nz) / (a * b)
    lam = x * (1 - b + nz) / (a * b * omega2)
    lam1 = (z * (a1 / b - 1 / a) + k * (a1 + a1 * b1) + (z / b + k * b1) * nz / a) / (1 - omega2)
    return {
        "P0": n["lx"] / (n["C"] * RATE) / (1 - a + nz),
        "lam": lam,
        "lam1": lam1,
        "X lam2": big_x * (lam1 + z / a - k * a1),
        "Xy/a": big_x * y / a,
        "tan": float(SIN / COS),
    }


def close(found, wanted):
    assert found.keys() == wanted.keys()
    for k, pair in wanted.items():
        assert found[k] == pytest.approx(pair, rel=1e-12, abs=1e-14)


def test_the_first_order_that_lx_brings(solutions):
    """theta = theta_0 - eps P0 (1 - cos T),  psi = psi_0 + eps P0 sin T/sin theta_0,  phi loses cos theta_0 of that."""
    p0, told = by_hand()["P0"], solutions[1]
    close(waves(told, "theta", 1)[0], {0: (-p0, 0), 1: (p0, 0)})
    close(waves(told, "psi", 1)[0], {1: (0, p0 / float(SIN))})
    close(waves(told, "phi", 1)[0], {1: (0, -p0 * float(COS / SIN))})
    assert waves(told, "phi", 0) == ({}, RATE)
    assert waves(told, "psi", 1)[1] == waves(told, "theta", 1)[1] == 0


def test_the_second_order_without_lx(solutions):
    """The corrected psi2 and theta2 of (43), with the signs before y0' that are printed the other way."""
    known, told = by_hand(), solutions[0]
    lam, lam1, x_lam2, y, tan = (known[name] for name in ("lam", "lam1", "X lam2", "Xy/a", "tan"))
    found, rate = waves(told, "psi", 2)
    csc = 1 / float(SIN)
    close(found, {0: (-csc * y, 0), 1: (csc * y, csc * lam), 2: (0, csc * tan / 4 * (lam1 + x_lam2))})
    assert rate == pytest.approx(RATE * csc * tan / 2 * (lam1 - x_lam2))
    turned = -tan * (lam1 + x_lam2) / 4
    close(waves(told, "theta", 2)[0], {0: (turned - lam, 0), 1: (lam, -y), 2: (-turned, 0)})


def test_the_angles_follow_the_motion(analysis, solutions):
    """At the given numbers, over one period: without the last order they are further from a simulation."""
    system, told = analysis.system, solutions[1]
    given = scenario(system, {})
    numbers = {name: Fraction(value) for name, value in given.parameters.items()}
    known = symbol_values(given, told, dict(told.oscillation.powers), Fraction(1), {})
    series = Numeric(told, numbers | known, Fraction(1))
    paths = oscillation_paths(system, told, periods=1.0)
    for one in told.oscillation.drifts:
        motion = paths.angles[one.variable][1]
        total, away = motion[0], []
        for rate, wave in zip(one.rates, one.waves, strict=True):
            total = total + float(series.value(rate)) * paths.times
            for k, pair in wave.waves.items():
                c, s = (float(series.value(x)) for x in pair)
                total = total + c * np.cos(k * series.rate * paths.times) + s * np.sin(k * series.rate * paths.times)
            away.append(np.abs(total - motion).max())
        assert away[-1] < 0.5 * away[-2], (one.variable, away)


@pytest.mark.parametrize(
    ("name", "rate"),
    [
        ("psi", "(p*gamma1 + q*gamma2)/(gamma1**2 + gamma3**2)"),
        ("theta", "(p*gamma1 - q*gamma2)/sqrt(gamma1**2 + gamma2**2)"),
        ("phi", "r"),
    ],
)
def test_a_coordinate_with_another_rate_is_refused(analysis, solutions, name, rate):
    with pytest.raises(NoRate):
        with_integrals(solutions[0], analysis, rates(**{name: rate}))


@pytest.mark.parametrize(
    ("rate", "why"),
    [("p/q", "is 0 where"), ("r/gamma1", "changes with the phase"), ("sqrt(p)", "odd power"), ("p/g", "grows")],
)
def test_what_has_no_series_is_refused(analysis, solutions, rate, why):
    with pytest.raises(NoClosedForm, match=why):
        with_integrals(solutions[0], analysis, rates(s=rate))
