"""Spheres on a turntable and in a rotating dish, the snakeboard, and a disc that rolls in a circle.

Every expectation is of the textbook named in the description, or derived by hand here; none is our own output.
"""

from __future__ import annotations

import random

import numpy as np
import pytest
from conftest import SHIPPED, analysed, derived, text_of
from flint import arb

import mbsym
from mbsym.algebra.ring import Polynomial
from mbsym.analysis.pipeline import Analysis
from mbsym.problems.checks import EXACT, FAILED, NUMERICAL
from mbsym.problems.stability.words import Because, Word
from tests.published.test_constrained_systems import AtState


def shipped(name: str) -> Analysis:
    return derived(SHIPPED / f"{name}.yaml")


def changed(name: str, *changes: tuple[str, str]) -> Analysis:
    return analysed(text_of(name, *changes))


def parameters(analysis: Analysis) -> dict[str, Polynomial]:
    return {name: analysis.ring.generator("parameter", name) for name in analysis.system.parameter_names}


def proportional(analysis: Analysis, rows: list[list[Polynomial]], wanted: list[list[Polynomial]]) -> bool:
    """Whether two matrices agree up to one common factor."""
    ring = analysis.ring
    flat, other = [x for row in rows for x in row], [x for row in wanted for x in row]
    k = next(i for i, x in enumerate(other) if not x.is_zero())
    return all(
        ring.is_zero(ring.reduce(ring.times(a, other[k]) - ring.times(flat[k], b))) is True
        for a, b in zip(flat, other, strict=True)
    )


def pencil(analysis: Analysis, names: tuple[str, ...]) -> list[list[Polynomial]]:
    """The rows of M, of D + G and of K + N, beside one another."""
    found, ring = analysis.linearisation, analysis.ring
    at = [found.coordinates.index(name) for name in names]
    m, d, g, k, n = (matrix.polynomials for matrix in found.matrices)
    return [
        [*(m[i][j] for j in at), *(ring.reduce(d[i][j] + g[i][j]) for j in at), *(k[i][j] + n[i][j] for j in at)]
        for i in at
    ]


# --- the sphere on a turntable ---


def test_the_centre_runs_on_a_circle_at_two_sevenths_of_the_rate_of_the_table() -> None:
    """Routh; Neimark & Fufaev: V' = 2/7 Omega k x V of a homogeneous sphere, wherever it is and however it turns."""
    source = random.Random(7)
    for _ in range(2):
        state = {key: source.uniform(-1, 1) for key in ("x", "y", "alpha", "beta", "gamma")}
        state |= {f"{key}_dot": source.uniform(-1, 1) for key in ("x", "y", "gamma")}
        at = AtState("turntable-sphere", state | {"chi": source.uniform(-1, 1), "J": 0.4 * 0.1**2})
        rate = 2 / 7 * at.values["Omega"]
        x2, y2 = at.accelerations[:2]
        assert [x2, y2] == pytest.approx([-rate * state["y_dot"], rate * state["x_dot"]], abs=1e-12)
        assert at.with_multipliers[:2] == pytest.approx([x2, y2], abs=1e-12)


def test_first_approximation_on_the_turntable() -> None:
    """(J + m r^2) x'' + J Omega y' = 0,  (J + m r^2) y'' - J Omega x' = 0, whatever the spin."""
    found = shipped("turntable-sphere")
    p, zero = parameters(found), found.ring.zero
    moment, turned = p["J"] + p["m"] * p["r"] ** 2, p["J"] * p["Omega"]
    wanted = [[moment, zero, zero, turned, zero, zero], [zero, moment, -turned, zero, zero, zero]]
    assert proportional(found, pencil(found, ("x", "y")), wanted)


def test_other_independent_velocities_have_the_same_roots() -> None:
    """Where x' and y' are dependent, the tilts of the sphere are independent and felt, alpha' + s beta = const.

    The roots are 0, +-i Omega J/(J + m r^2), and those of an axis in the body that turns with it, +-i s.
    """
    found = changed("turntable-sphere", ("dependent: [alpha, beta]", "dependent: [x, y]"))
    roots = [root for part in found.stability.spectra for root in part.roots]
    rate = 2 * 0.004 / (0.004 + 0.01)
    assert sorted(abs(float(x.ball.imag.mid())) for x in roots if not x.ball.contains(0)) == pytest.approx(
        [rate, rate, 1, 1]
    )
    assert {check.outcome for check in found.checks} <= {EXACT, NUMERICAL}


def test_the_moment_about_the_contact_is_kept_on_the_turntable() -> None:
    """m r k x V + J omega: all forces act there, and the contact moves as the centre does; the energy is not kept.

    With them V - 2/7 Omega k x R = const for a homogeneous sphere: circles, and a family of steady motions.
    """
    found = shipped("turntable-sphere")
    source = random.Random(5)
    n = {name: source.uniform(0.5, 1) for name in found.ring.names()}
    sines = {f"{f}_{x}": getattr(np, f)(n[x]) for x in ("alpha", "beta", "gamma") for f in ("sin", "cos")}
    a, b, c = (n[f"{x}_dot"] for x in ("alpha", "beta", "gamma"))
    spin = [
        a + c * sines["sin_beta"],
        b * sines["cos_alpha"] - c * sines["sin_alpha"] * sines["cos_beta"],
        b * sines["sin_alpha"] + c * sines["cos_alpha"] * sines["cos_beta"],
    ]
    carried = [-n["m"] * n["r"] * n["y_dot"], n["m"] * n["r"] * n["x_dot"], 0]
    wanted = [n["J"] * w + x for w, x in zip(spin, carried, strict=True)]
    balls = {name: arb(value) for name, value in n.items()}
    kept = [float(found.ring.evaluate(x.formula.polynomial, balls).mid()) for x in found.integrals]
    assert sorted(kept) == pytest.approx(sorted(wanted))
    assert {str(x.status) for x in found.integrals} == {"proved"}
    numerical = found.stability.numerical
    assert numerical is not None
    assert numerical.word is Word.CRITICAL
    assert not numerical.because(Because.MORE_ZERO_ROOTS)


def test_the_table_turned_the_other_way_is_seen() -> None:
    """A planted sign: the constraint with -Omega is another system."""
    found = changed("turntable-sphere", ("chi: {rate: Omega}", "chi: {rate: -Omega}"))
    p, zero = parameters(found), found.ring.zero
    moment, turned = p["J"] + p["m"] * p["r"] ** 2, p["J"] * p["Omega"]
    wanted = [[moment, zero, zero, turned, zero, zero], [zero, moment, -turned, zero, zero, zero]]
    assert not proportional(found, pencil(found, ("x", "y")), wanted)


# --- the sphere in a dish ---


def test_first_approximation_in_the_dish() -> None:
    """n = (xi, eta, -1) from the dish's centre, V = l n', V + omega x r n = Omega k x (l + r) n, J omega' = r n x F:

        (J + m r^2) xi''  + m g r^2/l xi  + J ((l + r) Omega - r s)/l eta' = 0,
        (J + m r^2) eta'' + m g r^2/l eta - J ((l + r) Omega - r s)/l xi'  = 0.

    For l -> oo these are the equations on the turntable.
    """
    found = shipped("dish-sphere")
    p, zero = parameters(found), found.ring.zero
    moment = p["l"] * (p["J"] + p["m"] * p["r"] ** 2)
    weight = p["m"] * p["g"] * p["r"] ** 2
    turned = p["J"] * ((p["l"] + p["r"]) * p["Omega"] - p["r"] * p["s"])
    wanted = [[moment, zero, zero, turned, weight, zero], [zero, moment, -turned, zero, zero, weight]]
    assert proportional(found, pencil(found, ("x", "y")), wanted)
    assert found.equilibrium.satisfied


@pytest.mark.parametrize("tilt", ["1/3", "b0"])
def test_a_tilted_sphere_does_not_spin_at_the_lowest_place(tilt: str) -> None:
    """alpha = 0, beta = b, gamma' = s: omega = s (sin b, 0, cos b), r omega_x is a slip at the contact: s sin b = 0.

    The dish turns beneath its centre.  The first approximation is compared where the motion exists.
    """
    named = ("  s: {sign: real, value: 1,", "  b0: {sign: real, value: 1/3}\n  s: {sign: real, value: 1,")
    found = changed("dish-sphere", ("beta: 0, gamma: {rate: s}", f"beta: {tilt}, gamma: {{rate: s}}"), named)
    (condition,) = found.equilibrium.conditions
    # sin(1/3) is not zero, so that s is; of sin(b0) that is not known.
    assert [name for name, _ in found.equilibrium.solved] == (["s"] if tilt == "1/3" else [])
    assert condition.polynomial.degrees()[found.ring.index("parameter", "s")] == 1
    check = found.check("perturbed motion")
    assert check is not None
    assert check.outcome == NUMERICAL
    verdict = found.stability.numerical
    assert verdict is not None
    assert verdict.word is Word.UNDECIDED
    assert verdict.because(Because.MOTION_NOT_THERE)


def test_nothing_is_claimed_of_the_dish_that_roots_on_the_axis_do_not_show() -> None:
    """All roots are imaginary and simple, +-i s of the sphere's attitude among them, but two zeros of its spin."""
    found = shipped("dish-sphere").stability
    assert found.numerical is not None
    assert found.numerical.word is Word.CRITICAL
    assert not found.numerical.theorem
    on_top = changed("dish-sphere", ("z: -l", "z: l"), ("Omega: {sign: real, value: 3,", "Omega: {value: 0,")).stability
    assert on_top.numerical is not None
    assert on_top.numerical.word is Word.UNSTABLE  # slowly spinning on the top of a dome


# --- the snakeboard ---


def test_the_snakeboard_has_its_momentum_equation() -> None:
    """p' = 2 J0 cos^2(phi) phi' psi' - tan(phi) phi' p where J + J0 + 2 J1 = m l^2 (Lewis et al.; Bloch, 1.10).

    p = dL/dq' . xi with xi = (-2 l cos^2(phi) cos(theta), -2 l cos^2(phi) sin(theta), sin(2 phi)) in (x, y, theta).
    """
    m, l, rotor, truck = 2.0, 0.5, 0.1, 0.05
    board = m * l**2 - rotor - 2 * truck
    source = random.Random(3)
    for _ in range(3):
        theta, phi = source.uniform(-1, 1), source.uniform(0.3, 1)
        given = {"theta": theta, "phi": phi, "m": m, "l": l, "J": board, "J0": rotor, "J1": truck}
        at = AtState("snakeboard", given | {f"{key}_dot": source.uniform(-1, 1) for key in ("theta", "psi", "phi")})
        assert at.found.free == ("theta", "psi", "phi")
        speed = dict(zip(at.found.coordinates, at.velocities, strict=True))
        rate = dict(zip(at.found.coordinates, at.accelerations, strict=True))
        s, c, w = np.sin(theta), np.cos(theta), speed["phi"]
        along, sideways = -2 * l * np.cos(phi) ** 2, np.sin(2 * phi)
        along_rate, sideways_rate = 2 * l * np.sin(2 * phi) * w, 2 * np.cos(2 * phi) * w
        moment = m * l**2 * speed["theta"] + rotor * speed["psi"]
        p = m * along * (speed["x"] * c + speed["y"] * s) + moment * sideways
        p_rate = m * along_rate * (speed["x"] * c + speed["y"] * s) + moment * sideways_rate
        p_rate += m * along * (rate["x"] * c + rate["y"] * s + (-speed["x"] * s + speed["y"] * c) * speed["theta"])
        p_rate += (m * l**2 * rate["theta"] + rotor * rate["psi"]) * sideways
        wanted = 2 * rotor * np.cos(phi) ** 2 * w * speed["psi"] - np.tan(phi) * w * p
        assert p_rate == pytest.approx(wanted, abs=1e-12)
        assert at.with_multipliers == pytest.approx(at.accelerations, abs=1e-11)


def test_the_snakeboard_is_nonholonomic_and_keeps_its_energy() -> None:
    """The growth (3, 4, 5) of its distribution, and the momenta of rotor and trucks, on which no constraint acts."""
    found = shipped("snakeboard")
    tied = found.constraints.integrability
    assert tied is not None
    assert (tied.word, tied.growth) == ("nonholonomic", (3, 4, 5))
    names = {x.name for x in found.integrals}
    assert {"generalised energy", "momentum of psi", "momentum of phi"} <= names


def test_a_sign_of_a_truck_is_seen() -> None:
    """Both trucks with the lever of the rear one: that is one constraint twice where they stand straight."""
    wrong = ("y_dot*cos(theta - phi) + l*theta_dot*cos(phi)", "y_dot*cos(theta - phi) - l*theta_dot*cos(phi)")
    found = changed("snakeboard", wrong)
    with pytest.raises(mbsym.analysis.Unavailable, match="smaller rank on this motion"):
        _ = found.linearisation


# --- the disc in a circle ---


@pytest.mark.parametrize(("lean", "rate"), [(0.4, 3.0), (-0.2, 1.0), (0.9, 5.0)])
def test_the_disc_in_a_circle_has_the_known_steady_motion_and_roots(lean: float, rate: float) -> None:
    """In the axes of the leaning frame, p = lean', q = spin' + yaw' sin(lean), s = yaw' cos(lean), m = 1:

        5/4 p' = 3/2 s q - 1/4 s^2 tan(lean) + g/r sin(lean),    3/2 q' = -s p,    s' = s p tan(lean) - 2 p q

    (Neimark & Fufaev, chapter III).  Steady where the first right side is zero; near it dq/dlean = -2/3 s and
    ds/dlean = s tan(lean) - 2 q, so that  5 lean'' + (12 w^2 + 14 w W sin + 5 W^2 - 4 g cos/r) lean = 0.
    """
    found = shipped("rolling-disc-in-a-circle")
    assert found.equilibrium.satisfied
    g, r = 9.81, 0.5
    spin = -5 * rate * np.sin(lean) / 6 - 2 * g * np.sin(lean) / (3 * r * rate * np.cos(lean))
    q, s = spin + rate * np.sin(lean), rate * np.cos(lean)
    assert 1.5 * s * q - s**2 * np.tan(lean) / 4 + g / r * np.sin(lean) == pytest.approx(0, abs=1e-12)
    ring = found.ring
    numbers = dict.fromkeys(ring.names(), arb(0))
    numbers |= {"m": arb(1), "r": arb(r), "g": arb(g), "L": arb(lean), "W": arb(rate), "w": arb(spin)}
    (part,) = found.stability.subsystems
    *low, four, five, six = [float(ring.evaluate(x.polynomial, numbers).mid()) for x in part.characteristic]
    stiffness = 12 * spin**2 + 14 * spin * rate * np.sin(lean) + 5 * rate**2 - 4 * g * np.cos(lean) / r
    assert [*low, five] == [0, 0, 0, 0, 0]
    assert four / six == pytest.approx(stiffness / 5, rel=1e-12)


def test_a_disc_that_spins_too_slowly_falls_and_another_spin_is_no_motion() -> None:
    """At lean 1/20, W = 2 it spins at -0.4106 and 12 w^2 + 14 w W sin + 5 W^2 - 4 g cos/r = -56.9."""
    slow = changed("rolling-disc-in-a-circle", ("value: pi/6", "value: 1/20"))
    assert slow.stability.numerical is not None
    assert slow.stability.numerical.word is Word.UNSTABLE
    wrong = changed("rolling-disc-in-a-circle", ("w: -5*W*sin(L)/6 -", "w: -5*W*sin(L)/6 +"))
    assert not wrong.equilibrium.satisfied
    assert FAILED not in {check.outcome for check in wrong.checks}
