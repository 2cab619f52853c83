"""Periodic motions, multipliers and Lyapunov exponents against closed forms, published orbits, and planted mistakes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import SHIPPED, filed, invoked, reference
from jsonschema import Draft202012Validator
from scipy.special import ellipk

import mbsym
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.orbits import lyapunov, variational
from mbsym.numerics.orbits.lyapunov import Parting, exponents
from mbsym.numerics.orbits.periodic import Guess, NotFound, Orbit, periodic_orbit
from mbsym.numerics.scenario import scenario
from mbsym.report.runs.orbit_files import lyapunov_sentences as sentences
from mbsym.report.runs.orbit_files import sentences as orbit_sentences
from mbsym.report.schemas import schema
from mbsym.simulation import read_values
from mbsym.simulation.motions import find_orbit

PENDULUM = """
mbsym: 1
name: Pendulum
bodies:
  - name: rod
    attached to: 0
    rotation: {axes: [3], angles: [theta]}
    mass centre: [0, -1, 0]
    mass: 1
loads:
  - uniform gravity: {vector: [0, -1, 0]}
initial: {theta: 1}
"""

#: Rotating axes; primaries at (-mu, 0) and (1 - mu, 0).
THREE_BODIES = """
mbsym: 1
name: Restricted three-body problem
parameters: {mu: positive}
bodies:
  - {name: p, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
loads:
  - generalized force:
      x: 2*y_dot + x - (1 - mu)*(x + mu)/sqrt((x + mu)**2 + y**2)**3 - mu*(x - 1 + mu)/sqrt((x - 1 + mu)**2 + y**2)**3
      y: -2*x_dot + y - (1 - mu)*y/sqrt((x + mu)**2 + y**2)**3 - mu*y/sqrt((x - 1 + mu)**2 + y**2)**3
values: {mu: 0.012277471}
initial: {x: {position: 0.994, velocity: 0}, y: {position: 0, velocity: -2.001585106379}}
"""

HENON_HEILES = """
mbsym: 1
name: Henon and Heiles
bodies:
  - {name: p, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
loads:
  - generalized force: {x: -x - 2*x*y, y: -y - x**2 + y**2}
initial: {x: {position: 0, velocity: 0.42081}, y: {position: -0.25, velocity: 0}}
"""

KEPLER = """
mbsym: 1
name: Kepler
bodies:
  - {name: p, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
loads:
  - generalized force: {x: -x/sqrt(x**2 + y**2)**3, y: -y/sqrt(x**2 + y**2)**3}
initial: {x: {position: 1, velocity: 0}, y: {position: 0, velocity: 1.1}}
"""


def dynamics(text: str, **values: Any) -> Dynamics:
    system = mbsym.loads(text).system if "\n" in text else mbsym.load(SHIPPED / f"{text}.yaml").system
    return Dynamics(scenario(system, read_values(system, values)))


def orbit(text: str, period: float, turns: dict[str, int] | None = None, keep: str = "auto", **values: Any) -> Orbit:
    return find_orbit(dynamics(text, **values).scenario, period, keep, turns).orbit


def test_the_period_of_a_pendulum() -> None:
    """T = 4 K(sin(a/2)), from the energy of the guess, which is not that of a turning point."""
    found = orbit(PENDULUM, 6.5, theta=0.7, theta_dot=0.8)
    energy = 0.8**2 / 2 - np.cos(0.7)
    modulus = np.sqrt((1 + energy) / 2)
    assert found.period == pytest.approx(4 * ellipk(modulus**2), abs=1e-10)
    assert found.closure < 1e-11
    assert found.verified < 1e-10
    assert found.trivial == 2
    assert np.max(np.abs(found.multipliers - 1)) < 1e-4  # a double eigenvalue of a Jordan block: half the digits
    assert found.determinant == pytest.approx(1, abs=1e-10)


@pytest.mark.parametrize(("guess", "repeats"), [(6.5, 1), (13.4, 2), (20.0, 3)])
def test_a_multiple_of_the_period_is_told_to_be_one(guess: float, repeats: int) -> None:
    """The period is 4 K(sin(1/2)) = 6.70 where the pendulum is let go at 1."""
    found = find_orbit(dynamics(PENDULUM).scenario, guess)
    assert found.repeats == repeats
    assert found.orbit.period == pytest.approx(repeats * 4 * ellipk(np.sin(0.5) ** 2), abs=1e-9)
    (told,) = (str(text) for title, text in orbit_sentences(found) if title == "period")
    assert ("it repeats after 6.69997" in told) == (repeats > 1)


def test_a_conical_pendulum_closes_up_to_a_revolution() -> None:
    """cos theta0 = g/(l Omega^2); theta oscillates about it with Omega sqrt(1 + 3 cos^2 theta0) (Whittaker)."""
    found = orbit("spherical-pendulum", 1.57, {"psi": 1}, psi_dot=4, theta=0.9, keep="period")
    cosine = 9.81 / (2 * np.pi / 1.57) ** 2
    assert np.cos(found.state[found.names.index("theta")]) == pytest.approx(cosine, abs=1e-9)
    angle = 2 * np.pi * np.sqrt(1 + 3 * cosine**2)
    near = min(abs(mu - np.exp(1j * angle)) for mu in found.multipliers)
    assert near < 1e-6
    assert {one.reason for one in found.reasons} >= {"psi is cyclic", "the energy is conserved"}


def test_a_coordinate_that_cancels_is_cyclic() -> None:
    """Kepler's motion with x = r cos f, y = r sin f: of energy, momentum, time and angle each gives a multiplier 1."""
    found = orbit(
        "mbsym: 1\nname: polar\nbodies: [{name: p, mass: 1, connection point: [r*cos(f), r*sin(f), 0], "
        "coordinates: [r, f]}]\nloads: [potential: -1/r]\ninitial: {r: 1, f: {position: 0, velocity: 1.1}}\n",
        7,
        {"f": 1},
    )
    assert found.trivial == 4
    assert {one.reason for one in found.reasons} >= {"f is cyclic", "the momentum of f is conserved"}


def test_the_orbit_of_arenstorf() -> None:
    """The reference of cr3bp: period and velocity to nine digits."""
    published = reference("cr3bp")["parameters"]["arenstorf"]
    found = orbit(THREE_BODIES, float(published["period"]), keep="nothing")
    assert found.period == pytest.approx(float(published["period"]), abs=1e-8)
    assert found.state[3] == pytest.approx(float(published["yd0"]), abs=1e-8)
    sizes = np.abs(found.multipliers)
    assert sizes[0] * sizes[-1] == pytest.approx(1, rel=1e-5)  # symplectic: they come in pairs mu, 1/mu
    assert sizes[0] > 100


def test_kepler_has_no_multiplier_but_one() -> None:
    """The period of the orbit that was found is 2 pi a^(3/2) with its own a."""
    found = orbit(KEPLER, 8.5)
    x, y, u, v = found.state
    semiaxis = 1 / (2 / np.hypot(x, y) - u**2 - v**2)
    assert found.period == pytest.approx(2 * np.pi * semiaxis**1.5, abs=1e-9)
    assert np.max(np.abs(found.multipliers - 1)) < 1e-3
    with pytest.raises(NotFound, match="not known to be conserved"):
        orbit(KEPLER, 8.5, keep="energy")  # a generalised force has no energy here


def test_rest_and_nothing_are_not_called_periodic() -> None:
    rest = dynamics("ziegler-damped")
    with pytest.raises(NotFound, match=r"rest|no convergence|shorter periods"):
        periodic_orbit(rest, Guess(np.array([float(x) for x in rest.scenario.state]), 2.0, {}))


def test_a_transposed_jacobian_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    """Newton's method may still converge; the multipliers are no longer 1 for their reasons."""
    applied = variational._applied
    monkeypatch.setattr(variational, "_applied", lambda p, m, v: applied(p, tuple(zip(*m, strict=True)), v))
    swept = lambda p, o, i, d: variational._applied(p, variational.jacobian(p, o, i), d)  # noqa: E731
    monkeypatch.setattr(variational, "directional", swept)
    try:
        found = orbit(PENDULUM, 6.5, theta=0.7, theta_dot=0.8)
    except NotFound:
        return
    assert found.trivial < 2


# --- Lyapunov exponents ---


def test_what_the_directions_need_to_turn_is_in_the_uncertainty() -> None:
    """Rest on top of x'' = x: the exponents are 1 and -1; a mean over t = 20 misses them by log|cos|/20 of a start."""
    text = PENDULUM.replace("[0, -1, 0]\n    mass", "[0, 1, 0]\n    mass").replace("{theta: 1}", "{theta: 0}")
    found = exponents(dynamics(text), 20, 0.1)
    off = np.abs(found.values - [1, -1])
    assert np.all(off > 1e-7)
    assert np.all(off <= 1.5 * found.uncertainty + 1e-9)


def test_a_damped_oscillator_has_the_real_parts_of_its_roots() -> None:
    """x'' + 0.4 x' + x = 0: both exponents are -0.2; their sum is the divergence -0.4."""
    text = KEPLER.split("loads:")[0] + "loads:\n  - generalized force: {x: -x - 0.4*x_dot, y: 2*y - y_dot}\n"
    found = exponents(dynamics(text + "initial: {x: 1, y: 0}\n"), 400, 1.0)
    # y'' + y' - 2 y = 0: roots 1 and -2
    assert np.max(np.abs(found.values - [1, -0.2, -0.2, -2])) < 2e-2
    assert found.divergence == pytest.approx(-1.4, abs=1e-12)
    assert found.sum_error < 1e-9
    assert found.parting is Parting.POSITIVE


def test_henon_and_heiles_at_an_eighth() -> None:
    """E = 1/8, x = 0, y = -0.25, py = 0, a chaotic orbit: near 0.045 (Benettin, Galgani & Strelcyn 1976).

    Over 4000 the last bits of the arithmetic decide between 0.045 and 0.061.
    """
    found = exponents(dynamics(HENON_HEILES), 16_000, 2.0)
    assert 0.03 < found.values[0] < 0.06
    assert found.parting is Parting.POSITIVE
    assert abs(found.values[0] + found.values[3]) < 2e-3  # pairs of opposite sign
    assert found.sum_error < 1e-9


@pytest.mark.parametrize("text", [PENDULUM, KEPLER])
def test_integrable_motion_is_not_called_chaotic(text: str) -> None:
    found = exponents(dynamics(text), 400, 1.0)
    assert found.parting is Parting.NOT_TOLD_FROM_ZERO
    assert abs(found.values[0]) < 0.04
    assert found.falling


def test_an_exponent_that_is_known_is_within_its_uncertainty() -> None:
    """x'' = 2 x - x'/5: the larger exponent is a root; only the directions' first turns keep the mean from it."""
    text = PENDULUM.replace(
        "  - uniform gravity: {vector: [0, -1, 0]}", "  - generalized force: {theta: 2*theta - theta_dot/5}"
    ).replace("theta: 1", "theta: 0")
    found = exponents(dynamics(text), 200, 0.5)
    assert abs(found.values[0] - (-0.2 + np.sqrt(0.04 + 8)) / 2) <= found.uncertainty[0] < 0.01


@pytest.mark.parametrize("time", [100, 200, 400])
def test_zero_is_within_the_uncertainty_of_a_regular_motion(time: float) -> None:
    """A pendulum's frequency hangs on its swing: neighbours part like t, and the exponent falls as log(t)/t to 0."""
    found = exponents(dynamics(PENDULUM), time, 0.5)
    assert found.falling
    assert (abs(found.values) <= found.uncertainty).all()


def test_the_largest_exponent_stands_first() -> None:
    """Over a short time the columns are not yet along what grows most: their own order is not that of the exponents."""
    found = exponents(Dynamics(scenario(mbsym.load(SHIPPED / "double-pendulum.yaml", ()).system)), 20, 1.0)
    assert (np.diff(found.values) <= 0).all()
    assert (found.history[-1] == found.values).all()


@pytest.mark.parametrize("swing", [0.0, 1.0])
def test_intervals_of_exponents_hold_them_as_often_as_they_say(swing: float) -> None:
    """Growth of mean 0.1 by chance, with what swings along an orbit and leaves nothing in a mean: 95 in 100 hold 0.1,
    and half their width is about 1.96 deviations of the mean.  By blocks it was 1.6 and 2.1 times that."""
    source, size, width = np.random.default_rng(3), 800, []
    for _ in range(400):
        along = (
            swing * np.sin(2.1 * np.arange(size + 1) + source.uniform(0, 7)) + source.normal(size=size + 1) * swing / 3
        )
        rates = 0.1 + 0.3 * source.normal(size=(size, 1)) + np.diff(along)[:, None]
        doubt = lyapunov._uncertainty(rates, np.arange(1.0, size + 1), 1e-10)
        width.append((abs(float(np.mean(rates)) - 0.1), float(doubt[0])))
    off, half = np.array(width).T
    assert 0.92 <= np.mean(off <= half) <= 0.99
    assert np.mean(half) < 1.5 * 1.96 * 0.3 / np.sqrt(size)


def test_the_exponent_of_duffings_oscillator_is_within_narrow_intervals() -> None:
    """x'' = x - x^3 - x'/5 + 0.3 cos t: 0.1575, its deviation 0.32/sqrt(T) (400 motions over 600, by RK4 by hand)."""
    text = PENDULUM.split("bodies:")[0] + (
        "prescribed: {phi: {rate: 1}}\nbodies:\n"
        "  - {name: b, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}\n"
        "loads:\n  - generalized force: {x: x - x**3 - x_dot/5 + 0.3*cos(phi)}\ninitial: {x: 0}\n"
    )
    found = [exponents(dynamics(text, x=x, x_dot=v), 150, 0.5, 1) for x, v in ((0.3, 0.1), (-0.6, 0.2))]
    assert any(abs(one.values[0] - 0.1575) <= one.uncertainty[0] for one in found)
    assert np.mean([one.uncertainty[0] for one in found]) < 2 * 1.96 * 0.32 / np.sqrt(150)


def test_what_telling_an_exponent_from_zero_takes_stands_beside_it() -> None:
    """-0.037 +- 0.018 is below zero by its 95 %, and was called "not told from zero" without a word of what that takes.

    x'' + x'/10 + 2 x = 0 spirals in: both exponents are -1/20, beside log(200)/200 = 0.0265; three times that is 0.079.
    """
    text = PENDULUM.replace(
        "  - uniform gravity: {vector: [0, -1, 0]}", "  - generalized force: {theta: -2*theta - theta_dot/10}"
    )
    found = exponents(dynamics(text), 200, 1.0)
    assert found.values[0] + found.uncertainty[0] < 0
    assert found.parting is Parting.NOT_TOLD_FROM_ZERO
    assert dict(sentences(found))["motion"].startswith(
        "the largest exponent is not distinguishable from zero, which takes three times its uncertainty and three "
        "times log(T)/T = 0.026"
    )


def test_lost_growth_is_caught_by_the_divergence(monkeypatch: pytest.MonkeyPatch) -> None:
    """Directions that are made orthogonal without keeping what they grew by."""
    real = np.linalg.qr

    class Forgetful:
        def __getattr__(self, name: str) -> Any:
            return getattr(np.linalg, name)

        def qr(self, matrix: Any) -> Any:
            q, r = real(matrix)
            return q, r * (1 + 1e-3)

    class Arrays:
        linalg = Forgetful()

        def __getattr__(self, name: str) -> Any:
            return getattr(np, name)

    monkeypatch.setattr(lyapunov, "np", Arrays())
    assert exponents(dynamics(KEPLER), 100, 1.0).sum_error > 1e-4


# --- commands ---


def test_the_commands(tmp_path: Path) -> None:
    path = filed(tmp_path / "pendulum.yaml", PENDULUM)
    done = invoked("orbit", path, "--period", "6.5", "--out", tmp_path / "out", code=0)
    content = json.loads((tmp_path / "out" / "orbit.json").read_text())
    Draft202012Validator(schema("orbit")).validate(content)
    assert content["period"] == pytest.approx(4 * ellipk(np.sin(0.5) ** 2), abs=1e-10)
    assert "stable" not in done.output.replace("stability", "")
    done = invoked("lyapunov", path, "--time", "50", "--out", tmp_path / "out", code=0)
    Draft202012Validator(schema("lyapunov")).validate(json.loads((tmp_path / "out" / "lyapunov.json").read_text()))
    assert "chaotic" in done.output
    done = invoked("orbit", path, "--turns", "psi=1", "--keep", "all", code=2)
    for part in ("--period", "no coordinate 'psi'", "unknown-choice"):
        assert part in done.output


def test_a_search_that_runs_to_no_period_says_nothing_of_the_motion() -> None:
    """In polar coordinates f gains a whole revolution, and a central force with a speed of f has no rest anywhere.

    From r = 1, v = 6/5 the orbit has the semiaxis 1/(2 - v^2) = 25/14 and the period 2 pi a^(3/2) = 14.99: the guess is
    as good as exact.  "Near the guess there is rest only" was told of it; what its hint says finds it.
    """
    polar = """
mbsym: 1
name: Kepler in polar coordinates
bodies:
  - {name: p, attached to: 0, connection point: [r*cos(f), r*sin(f), 0], mass: 1, coordinates: [r, f]}
loads: [force function: 1/r]
initial: {r: 1, f: {position: 0, velocity: 6/5}}
"""
    with pytest.raises(NotFound, match=r"shorter periods .*--turns NAME=1") as refused:
        orbit(polar, 15)
    assert "rest" not in str(refused.value)
    assert orbit(polar, 15, turns={"f": 1}).period == pytest.approx(2 * np.pi * (25 / 14) ** 1.5, rel=1e-6)


def pushed(force: str, start: str = "1") -> str:
    text = PENDULUM.replace("  - uniform gravity: {vector: [0, -1, 0]}", f"  - generalized force: {{theta: {force}}}")
    return text.replace("initial: {theta: 1}", f"initial: {{theta: {start}}}")


@pytest.mark.parametrize(
    ("force", "linear", "planar"),
    [
        ("theta", True, True),
        ("-(1 - 2*cos(2*t))*theta", True, False),
        ("theta - theta**3", False, True),
        ("(1 - theta**2)*theta_dot - theta", False, True),
        ("theta - theta**3 - theta_dot/5 + cos(t)/3", False, False),
    ],
)
def test_motions_that_cannot_be_chaotic_are_not_likened_to_chaotic_ones(force: str, linear: bool, planar: bool) -> None:
    """Not those of linear equations, nor of two variables without the time (Poincare and Bendixson)."""
    found = exponents(dynamics(pushed(force)), 60, 1.0)
    told = str(dict(sentences(found))["motion"])
    assert (found.linear, found.planar) == (linear, planar)
    assert ("none is chaotic" in told or "none of their motions is chaotic" in told or "together" in told) or not (
        linear or planar
    )
    assert not ((linear or planar) and ("as chaotic ones do" in told or "undecided" in told))


def test_a_rest_is_not_likened_to_a_chaotic_motion() -> None:
    """x'' = x - x^3 at x = 0: neighbouring motions leave it like e^t."""
    found = exponents(dynamics(pushed("theta - theta**3", "0")), 60, 1.0)
    assert found.values[0] == pytest.approx(1, abs=1e-2)
    assert dict(sentences(found))["motion"].startswith("the motion is a rest")


DRIVEN = """
mbsym: 1
name: Driven
prescribed: {phi: {rate: 1.2}}
bodies: [{name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}]
loads: [{generalized force: {x: -x - 0.2*x_dot + 0.3*FORCE}}]
initial: {x: {position: 0.5, velocity: 0}}
"""


def test_a_period_that_is_none_of_the_equations_is_refused() -> None:
    # x'' + 0.2 x' + x = 0.3 cos 1.2 t: some x returns after any T, but repeats then only if the force does.  The one
    # periodic motion has the period 2 pi/1.2 and the amplitude 0.3/sqrt((1 - 1.44)^2 + 0.24^2).
    driven = DRIVEN.replace("FORCE", "cos(phi)")
    period = 2 * np.pi / 1.2
    for wrong in (5.2, period / 2, 5.2359):
        with pytest.raises(NotFound, match=r"do not repeat after .* they do after 5\.2359877559829[89]"):
            orbit(driven, wrong)
    for right in (period, 2 * period):
        x, rate = orbit(driven, right).state
        assert np.hypot(x, rate / 1.2) == pytest.approx(0.3 / np.hypot(1 - 1.44, 0.24), rel=1e-9)
    with pytest.raises(NotFound, match="no period of theirs is known"):
        orbit(DRIVEN.replace("FORCE", "exp(-t) + 0*phi"), 5)


QUARTIC = """
mbsym: 1
name: two oscillators, one drawn by the other
bodies:
  - {name: p, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
parameters: {k: positive}
loads:
  - potential: x**2/2 + k*x**4/4 + 2*y**2 + k*x**2*y**2
"""


@pytest.mark.parametrize(("size", "unit"), [("10**-12", 1e-12), ("10**-9", 1e-9), ("1", 1.0), ("10**6", 1e6)])
def test_an_orbit_does_not_depend_on_the_unit_of_length(size: str, unit: float) -> None:
    """x'' = -x - x^3 along y = 0, in units in which its amplitude is ``size``; its period by the energy integral.

    T = 4 K(m)/w, w^2 = 1 + A^2, m = A^2/(2 w^2) (Byrd & Friedman, 1971); A by x and x' where the search ends.
    """
    text = f"{QUARTIC}values: {{k: 1/({size})**2}}\ninitial: {{x: {size}, y: {size}/50}}\n"
    found = mbsym.orbit(mbsym.loads(text), 4.9)
    found = getattr(found, "orbit", found)
    x, y, v, _ = found.state / unit
    assert abs(y) < 1e-12
    square = np.sqrt(1 + 4 * (v**2 / 2 + x**2 / 2 + x**4 / 4)) - 1  # A^2
    w = np.sqrt(1 + square)
    assert found.period == pytest.approx(4 * ellipk(square / (2 * w**2)) / w, rel=1e-11)
    assert found.trivial == 2
    assert found.verified < 1e-10


@pytest.mark.parametrize("keep", ["auto", "nothing"])
def test_an_orbit_does_not_depend_on_the_origin(keep: str) -> None:
    """The same about x = 10^6: a swing of a tenth is neither rest nor closed after what is no period of it."""
    text = QUARTIC.replace("x**", "(x - c)**") + "values: {k: 1, c: 10**6}\ninitial: {x: 1000000.1, y: 0}\n"
    text = text.replace("{k: positive}", "{k: positive, c: positive}")
    found = mbsym.orbit(mbsym.loads(text), 6.2, keep=keep)
    found = getattr(found, "orbit", found)
    x, v = found.state[0] - 1e6, found.state[2]
    square = np.sqrt(1 + 4 * (v**2 / 2 + x**2 / 2 + x**4 / 4)) - 1  # A^2
    w = np.sqrt(1 + square)
    assert square > 1e-4
    assert found.period == pytest.approx(4 * ellipk(square / (2 * w**2)) / w, rel=1e-7)


@pytest.mark.parametrize("stiffness", [2.0, -1.0, -4.0, 30.0])
def test_multipliers_are_told_to_their_own_error(stiffness: float) -> None:
    """x'' = -x - x^3 from x = 1 has the period T = 4 K(1/4) / sqrt(2); y'' = -c y beside it exp(+-i sqrt(c) T).

    The period of x hangs on its energy: 1 is a double multiplier with one eigenvector, and what roundings make of it
    says nothing of the others.
    """
    text = f"""
mbsym: 1
name: Duffing beside a spring
bodies:
  - {{name: a, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}}
  - {{name: b, attached to: 0, connection point: [0, y, 0], mass: 1, coordinates: [y]}}
loads: [{{potential: x**2/2 + x**4/4 + ({stiffness})*y**2/2}}]
initial: {{x: 1, y: 0}}
"""
    period = 4 * ellipk(0.25) / np.sqrt(2)
    orbit = mbsym.orbit(mbsym.loads(text), 1.001 * period).orbit
    assert orbit.period == pytest.approx(period, rel=1e-14)
    assert np.sum(orbit.multipliers == 1) == orbit.trivial == 2
    exact = np.exp(1j * np.sqrt(complex(stiffness)) * period * np.array([1, -1]))
    error = max(np.min(np.abs(orbit.others - mu)) for mu in exact)
    assert error <= orbit.uncertainty < 1e-13 * max(100.0, 10 * np.max(np.abs(exact)))
