"""x' = A x in speeds and unit vectors: by hand, and against the matrices of the generalised coordinates."""

import pytest
from conftest import TESTS
from test_speeds import GYROSTAT, POISSON, SPEEDS, expected, load

import mbsym
from mbsym.analysis import Unavailable
from mbsym.formulas.formula import Matrix
from mbsym.problems.checks import EXACT, FAILED, WHERE_IT_EXISTS, Check

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


CONDITIONED = TESTS / "cases" / "hostile" / "selfcheck-clebsch-poisson.yaml"


def test_a_motion_that_exists_under_a_condition_is_checked_where_it_exists():
    """Clebsch's body turns about gamma = (-sin 2, 0, cos 2) with p = -W sin 2, r = W cos 2; Euler's equation of q,

        B q' + (A - C) r p = (A - C) N gamma3 gamma1,      leaves      (A - C) (N - W^2) sin 2 cos 2 = 0.

    A T = T' + T A_q says that the chain rule holds along a solution, so it holds modulo that condition and not beyond:
    A itself is right, and so is the second route; what was wrong is that they were compared where there is no motion.
    """
    found = mbsym.load(CONDITIONED)
    assert [str(x) for x in found.equilibrium.conditions] == ["(N - W**2)*(A - C)"]
    check = found.first_order and found.check(CHECK)
    assert (check.outcome, check.detail) == (EXACT, WHERE_IT_EXISTS)
    q = found.first_order.names.index("q")
    row = found.first_order.A.rows[q]
    assert [row[0], row[2]] == expected(found, ["(C - A)*N*cos(2)/B*(-1)", "(C - A)*N*(-1)*(-sin(2))/B"])


def test_a_planted_mistake_is_found_where_a_motion_exists_under_a_condition(monkeypatch):
    from mbsym.mechanics.speeds import SpeedForm

    old = SpeedForm.rates.func
    wrong = property(lambda self: {name: -x if name == "gamma2" else x for name, x in old(self).items()})
    found = mbsym.load(CONDITIONED)
    monkeypatch.setattr(SpeedForm, "rates", wrong)
    assert found.first_order is not None
    check = found.check(CHECK)
    assert check.outcome == FAILED
    assert check.detail.startswith("the row of gamma2 by ")


def test_a_failure_always_says_something():
    assert Check("some check", "one", "other", FAILED).detail == "the two routes differ"


BALL = """
mbsym: 1
name: Ball on a spring
parameters: {m: positive, r: positive, J: positive, c: positive}
bodies:
  - {name: centre, attached to: 0, connection point: [x, y, r], coordinates: [x, y], mass: m}
  - name: ball
    attached to: centre
    rotation: {axes: [3, 1, 2], angles: [psi, theta, phi]}
    mass: 0
    inertia about: joint
    inertia: [J, J, J]
    speeds: {p: omega1, q: omega2, s: omega3}
    orientation: {e: quaternion}
loads:
  - spring: {coordinate: x, stiffness: c}
constraints:
  - rolling: {body: ball, point: [0, 0, -r], axes: centre, on: ground}
dependent: [x, y]
motion: {x: 0, y: 0, psi: 0, theta: 0, phi: 0}
"""


def test_a_quaternion_beside_constraints() -> None:
    """A ball rolls on a plane, a spring on its centre: x' = r q, (m r^2 + J) q' = -r c x, 2 e' = omega at e = 1."""
    analysis = mbsym.loads(BALL, (3, 5))
    found = analysis.first_order
    assert found.names == ("x", "e0", "e1", "e2", "e3", "p", "q", "s")
    entries = {(a, b): str(found.A[i, j]) for i, a in enumerate(found.names) for j, b in enumerate(found.names)}
    turned = {("e1", "p"): "1/2", ("e2", "q"): "1/2", ("e3", "s"): "1/2"}
    rolling = {("x", "q"): "r", ("q", "x"): "-r*c/(m*r**2 + J)"}
    assert {place: entry for place, entry in entries.items() if entry != "0"} == turned | rolling
    assert (found.relations, found.norms) == (1, 1)
    check = analysis.check("first approximation in speeds")
    assert check is not None
    assert check.outcome == "exact"
