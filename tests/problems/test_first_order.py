"""x' = A x in speeds and unit vectors: by hand, and against the matrices of the generalised coordinates."""

import pytest
from test_speeds import GYROSTAT, POISSON, SPEEDS, expected, load

from mbsym.analysis import Unavailable
from mbsym.formulas.formula import Matrix
from mbsym.problems.checks import EXACT, FAILED

CHECK = "first approximation in speeds"


def top(told, motion):
    """Lagrange's top without a gyrostatic moment, axes 1, 2, 3."""
    text = GYROSTAT.format(told=told).replace("axes: [3, 1, 3]", "axes: [1, 2, 3]")
    text = text.replace("[x0, y0, z0]", "[0, 0, z0]").replace("inertia: [A, B, C]", "inertia: [A, A, C]")
    text = text.replace("    gyrostatic moment: [l1, l2, l3]\n", "").replace(
        "m: positive,", "m: positive, w: positive,"
    )
    return text + f"motion: {motion}\n"


def test_the_sleeping_top_by_hand(tmp_path):
    """p = q = 0, r = w, gamma = (0, 0, 1): gamma1' = w gamma2 - q, gamma2' = p - w gamma1,

    A p' = (A - C) w q + m g z0 gamma2,  A q' = (C - A) w p - m g z0 gamma1,  gamma3' = r' = 0 to first order.
    """
    found = load(tmp_path, top(POISSON, "{phi: {rate: w}}"))
    state = found.first_order
    assert state.names == ("gamma1", "gamma2", "gamma3", "p", "q", "r")
    assert list(state.values) == expected(found, ["0", "0", "1", "0", "0", "w"])
    rows = [
        ["0", "w", "0", "0", "-1", "0"],
        ["-w", "0", "0", "1", "0", "0"],
        ["0"] * 6,
        ["0", "m*g*z0/A", "0", "0", "(A - C)*w/A", "0"],
        ["-m*g*z0/A", "0", "0", "(C - A)*w/A", "0", "0"],
        ["0"] * 6,
    ]
    wanted = Matrix(tuple(tuple(expected(found, row)) for row in rows))
    assert wanted == state.A
    assert state.relations == 1
    assert found.check(CHECK).outcome == EXACT


def test_what_is_not_steady_has_none(tmp_path):
    """With the last angle among the positions the same motion turns."""
    found = load(tmp_path, top(SPEEDS, "{phi: {rate: w}}"))
    with pytest.raises(Unavailable, match="vary with phi"):
        found.first_order  # noqa: B018
    assert found.stage(6).failure is None


def test_at_rest_with_angles(tmp_path):
    found = load(tmp_path, top(SPEEDS, "{psi: 0}"))
    assert found.first_order.names[-3:] == ("p", "q", "r")
    assert found.check(CHECK).outcome == EXACT


def test_a_motion_that_does_not_exist_has_none(tmp_path):
    found = load(tmp_path, top(POISSON, "{psi: {value: pi/2}}").replace("z0: real", "z0: positive"))
    with pytest.raises(Unavailable):
        found.first_order  # noqa: B018


def test_a_planted_mistake_is_found(tmp_path, monkeypatch):
    from mbsym.mechanics.speeds import SpeedForm

    old = SpeedForm.rates.func
    wrong = property(lambda self: {name: -x if name == "gamma2" else x for name, x in old(self).items()})
    found = load(tmp_path, top(POISSON, "{phi: {rate: w}}"))
    monkeypatch.setattr(SpeedForm, "rates", wrong)
    assert found.first_order is not None
    assert found.check(CHECK).outcome == FAILED
