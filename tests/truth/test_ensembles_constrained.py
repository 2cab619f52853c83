"""Many motions of systems with constraints and with quaternions: every member is the motion that it is without them."""

from __future__ import annotations

from math import atan, cosh, hypot, sqrt, tanh

import numpy as np
import pytest
from truth.independent.scenes import LIGHT as FREE
from truth.test_accuracy_constrained import BALL, LIGHT, SLEIGH, ball

import mbsym
from mbsym.numerics.ensembles.variation import Unvaried


def test_members_of_a_sleigh_move_as_the_closed_form_says() -> None:
    """w = (V/k)/cosh s, s = a V t/k^2 + s0, V^2 = v^2 + k^2 w0^2, k^2 = J/m + a^2, each member its own J and w0."""
    told = SLEIGH.replace("inertia: [0, 0, 0.5]", "inertia: [0, 0, J]").replace(
        "bodies:", "parameters: {J: {sign: positive, value: 0.5}}\nbodies:"
    )
    found = mbsym.ensemble(mbsym.loads(told), 3, {"J": (0.2, 0.8, 3), "theta_dot": (1.0, 2.0, 2)})
    names = (*found.members.dynamics.system.coordinates, *found.members.dynamics.system.velocities)
    assert found.count == 6
    assert not found.fates
    for member in range(6):
        inertia, w = found.members.values[:, member]
        a, v, k = 0.3, 0.5, sqrt(inertia + 0.09)
        whole = sqrt(v * v + k * k * w * w)
        begun = 0.5 * np.log((whole + v) / (whole - v))
        s = a * whole * 3 / k**2 + begun
        theta = 2 * k / a * (atan(tanh(s / 2)) - atan(tanh(begun / 2)))
        last = dict(zip(names, found.final[:, member], strict=True))
        assert last["theta"] == pytest.approx(theta, rel=1e-9)
        assert last["theta_dot"] == pytest.approx(whole / k / cosh(s), rel=1e-9)
        assert hypot(last["x_dot"], last["y_dot"]) == pytest.approx(whole * tanh(s), rel=1e-9)
        across = last["x_dot"] * np.sin(last["theta"]) - last["y_dot"] * np.cos(last["theta"])
        assert across == pytest.approx(0, abs=1e-15)
    assert found.compared.largest < 1e-8


def test_members_told_by_a_quaternion_begin_on_their_constraints() -> None:
    """The second member begins with the spin of the closed form, and rolls with it from the first moment on."""
    found = mbsym.ensemble(mbsym.loads(BALL), 2, {"p": (1.0, 3.0, 2)})
    names = (*found.members.dynamics.system.coordinates, *found.members.dynamics.system.velocities)
    assert names[2:6] == ("e0", "e1", "e2", "e3")
    last = dict(zip(names, found.final[:, 1], strict=True))
    for name, values in ball([2.0]).items():
        assert last[name] == pytest.approx(float(values[0]), abs=1e-9)
    assert found.members.starts[names.index("y_dot"), 0] == pytest.approx(-0.5, abs=1e-15)


def test_an_ensemble_is_the_same_with_and_without_constraints() -> None:
    """A coordinate and a mass vary; dependent coordinates follow in every member."""
    vary = {"a": (0.5, 1.0, 3)}
    one, other = (mbsym.ensemble(mbsym.loads(text), 2, vary) for text in (FREE, LIGHT))
    system = other.members.dynamics.system
    place = [(*system.coordinates, *system.velocities).index(name) for name in ("a", "b", "a_dot", "b_dot")]
    assert other.final[place] == pytest.approx(one.final, abs=1e-8)
    assert other.statistics.mean[:, place] == pytest.approx(one.statistics.mean, abs=1e-8)
    x = (*system.coordinates, *system.velocities).index("x")
    assert other.members.starts[x] == pytest.approx(-np.sin(other.members.values[0]), abs=1e-15)


def test_what_rests_is_no_error() -> None:
    """A speed that is zero but for rounding is measured by what the motion could do, not by its rounding."""
    text = BALL.replace("p: 3, q: 1, s: 2", "p: 0, q: 1, s: 0")
    found = mbsym.ensemble(mbsym.loads(text), 2, {"q": (1.0, 2.0, 2)})
    assert found.compared.largest < 1e-8


def test_a_member_that_cannot_be_closed_is_told() -> None:
    text = """
mbsym: 1
name: a point held by a bar to a wall
parameters: {d: {value: 1/2, sign: positive}}
bodies: [{name: p, attached to: 0, connection point: [x, d, 0], mass: 1, coordinates: [x]}, {name: o, attached to: 0,
  connection point: [0, y, 0], mass: 1, coordinates: [y]}]
constraints: [{distance: {between: [{body: p, point: [0, 0, 0]}, {body: 0, point: [0, 0, 0]}], length: 1}}]
initial: {x: 0.8, y: {position: 0, velocity: 1}}
"""
    with pytest.raises(Unvaried, match=r"no motion begins with d = 2: the constraints cannot be closed"):
        mbsym.ensemble(mbsym.loads(text), 1, {"d": (0.5, 2.0, 2)})


def test_a_sweep_of_motions_knows_constraints(tmp_path) -> None:  # type: ignore[no-untyped-def]
    """simulate:theta_dot of the sleigh at t = 2 beside the closed form."""
    from click.testing import CliRunner

    from mbsym_cli.main import main

    told = SLEIGH.replace("inertia: [0, 0, 0.5]", "inertia: [0, 0, J]").replace(
        "bodies:", "parameters: {J: {sign: positive, value: 0.5}}\nbodies:"
    )
    (tmp_path / "sleigh.yaml").write_text(told, encoding="utf-8")
    more = [
        "--vary",
        "J=0.2:0.8:3",
        "--measure",
        "simulate:theta_dot",
        "--time",
        "2",
        "-q",
        "--out",
        str(tmp_path / "o"),
    ]
    done = CliRunner().invoke(main, ["sweep", str(tmp_path / "sleigh.yaml"), *more])
    assert done.exit_code == 0, done.output
    rows = np.genfromtxt(tmp_path / "o" / "sweep.csv", delimiter=",", names=True)
    for row in np.atleast_1d(rows):
        a, v, k = 0.3, 0.5, sqrt(row["J"] + 0.09)
        whole = sqrt(v * v + k * k * 4)
        s = a * whole * 2 / k**2 + 0.5 * np.log((whole + v) / (whole - v))
        assert row["final"] == pytest.approx(whole / k / cosh(s), rel=1e-7)


@pytest.mark.parametrize(("own", "values"), [("0", (0.0, 1.0, 3)), ("1", (0.0, 1.0, 3)), ("1", (0.5, 1.0, 2))])
def test_members_of_which_other_rows_follow_from_others_are_not_moved_by_these_equations(
    own: str, values: tuple[float, float, int]
) -> None:
    """On the sphere |r| = 1 and the plane e z = 0: a sphere where e = 0, else the circle z = 0, whatever pulls along z.

    There the pendulum r'' = -g sin takes the point from (1, 0) on; z stays 0.
    """
    text = (
        f"mbsym: 1\nname: two\nparameters: {{e: {{value: {own}, sign: real}}}}\n"
        "bodies: [{name: p, mass: 1, connection point: [x, y, z], coordinates: [x, y, z]}]\n"
        "loads: [{uniform gravity: {vector: [0, -1, -1]}}]\n"
        "constraints:\n  - relation: x**2 + y**2 + z**2 = 1\n  - relation: x**2 + y**2 + z**2 + e*z = 1\n"
        "initial: {x: 1, y: 0, z: 0}\n"
    )
    if not values[0]:
        with pytest.raises(Unvaried, match="other rows of the constraints follow"):
            mbsym.ensemble(mbsym.loads(text), 1, {"e": values})
        return
    found = mbsym.ensemble(mbsym.loads(text), 1, {"e": values})
    assert found.final[2] == pytest.approx([0, 0], abs=1e-12)
    assert found.final[3] ** 2 / 2 + found.final[4] ** 2 / 2 + found.final[1] == pytest.approx([0, 0], abs=1e-9)
