"""Periodic first approximations under constraints: a bob on a rod in Cartesian coordinates, its pivot shaken.

It is the shaken pendulum in its angle, whose multipliers are those of  th'' = (g - h nu^2 cos(nu t)) th/l  about the
upper position: two on what the rod allows, not four.
"""

from __future__ import annotations

import cmath

import numpy as np
import pytest
from conftest import SHIPPED
from flint import arb, arb_series
from scipy.integrate import solve_ivp

import mbsym
from mbsym.algebra.program import Program
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.orbits.floquet import ConstantCoefficients, NotPeriodic, Word, judged, series
from mbsym.numerics.scenario import scenario

TEXT = """
mbsym: 1
name: A bob on a rod whose pivot is shaken
parameters: {m: positive, l: positive, g: positive, h: positive, nu: positive}
prescribed: {phi: {rate: nu}}
bodies:
  - {name: pivot, attached to: 0, connection point: [0, h*cos(phi), 0], mass: 0}
  - {name: bob, attached to: pivot, connection point: [x, y, 0], coordinates: [x, y], mass: m}
loads: [{uniform gravity: {acceleration: g, direction: [0, -1, 0]}}]
constraints:
  - distance: {between: [{body: bob, point: [0, 0, 0]}, {body: pivot, point: [0, 0, 0]}], length: l}
motion: {x: 0, y: PLACE}
values: {m: 1, l: 1, g: 9.81, h: 0.1, nu: RATE}
initial: {x: 0, y: 1}
"""


def found(place: str, rate: float):
    system = mbsym.loads(TEXT.replace("PLACE", place).replace("RATE", str(rate))).system
    return judged(Dynamics(scenario(system)))


@pytest.mark.parametrize(("rate", "word"), [(60, Word.STABLE_FIRST_APPROXIMATION), (30, Word.UNSTABLE)])
def test_the_upper_position_is_held_by_fast_shaking(rate: int, word: Word) -> None:
    """Kapitza: held where h nu > sqrt(2 g l) about, 44.3 here."""
    told = found("l", rate)
    assert told.word is word
    assert len(told.multipliers) == 2
    assert told.names == ("x", "x_dot")

    def rates(t, y):
        return [y[1], (9.81 - 0.1 * rate**2 * np.cos(rate * t)) * y[0]]

    period = 2 * np.pi / rate
    columns = [solve_ivp(rates, (0, period), e, rtol=1e-12, atol=1e-13).y[:, -1] for e in ([1, 0], [0, 1])]
    wanted = sorted(np.linalg.eigvals(np.array(columns).T), key=lambda mu: (mu.real, mu.imag))
    middles = sorted((complex(one.ball.mid()) for one in told.multipliers), key=lambda mu: (mu.real, mu.imag))
    assert np.abs(np.array(wanted) - np.array(middles)) == pytest.approx(np.zeros(2), abs=1e-7)


def test_a_motion_off_the_rod_is_none() -> None:
    with pytest.raises(NotPeriodic):
        found("2*l", 60)


def test_velocities_that_the_motion_does_not_name_follow_from_the_constraints() -> None:
    """A disc that rolls upright and straight on: its lean obeys  5 r lean'' = 4 (g - 3 r w^2) lean  (Appell, Routh)."""
    told = judged(Dynamics(scenario(mbsym.load(SHIPPED / "rolling-disc.yaml").system)))
    r, g, w = 0.26, 9.81, 5
    wobble = cmath.exp(cmath.sqrt(4 * (g - 3 * r * w**2) / (5 * r)) * 2 * cmath.pi / w)
    middles = [complex(one.ball.mid()) for one in told.multipliers]
    off = [mu for mu in middles if abs(mu - 1) > 1e-6]
    assert sorted(mu.imag for mu in off) == pytest.approx(sorted([wobble.imag, -wobble.imag]), abs=1e-9)
    assert [mu.real for mu in off] == pytest.approx([wobble.real] * 2, abs=1e-9)


def test_a_motion_that_exists_is_not_called_none() -> None:
    """On a circle x and y follow by the constraints, and unevenly: the motion satisfies the equations nevertheless."""
    with pytest.raises(NotPeriodic, match="follows the unperturbed motion"):
        judged(Dynamics(scenario(mbsym.load(SHIPPED / "rolling-disc-in-a-circle.yaml").system)))


@pytest.mark.parametrize("name", ["rolling-disc", "rolling-disc-speeds"])
def test_what_is_the_same_at_all_times_is_told_to_be_that(name: str) -> None:
    """Sines and cosines of the spin cancel in the rates of an upright disc, in coordinates and in speeds."""
    with pytest.raises(ConstantCoefficients, match="problem 6 judges it"):
        mbsym.floquet(mbsym.load(SHIPPED / f"{name}.yaml"))


def test_moduli_and_signs_of_pivots_are_series_where_they_do_not_jump() -> None:
    """|cos t - 2| = 2 - cos t, and sign(cos t - 2) = -1; where the argument may vanish there is no number."""
    program = Program()
    x = program.sin_cos_of(program.input("t"))[1] - program.number(2)
    code = Code(program, ("t",), (program.function("abs", x), program.function("sign", x)))
    modulus, sign = series(code, arb_series([0, 1], prec=5))
    assert [float(modulus[k]) for k in range(5)] == pytest.approx([1, 0, 1 / 2, 0, -1 / 24])
    assert [float(sign[k]) for k in range(sign.length())] == [-1]
    unknown = Code(program, ("t",), (program.function("sign", program.input("t")),))
    assert not series(unknown, arb_series([arb(0, 1), 1]))[0][0].is_finite()
