"""Problem 4 where coordinates are singular on the motion: what is demanded there, by hand and in other coordinates."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest
from conftest import filed, invoked

import mbsym
from mbsym.algebra.ring import Polynomial
from mbsym.analysis import Analysis, approximation
from mbsym.analysis.stages import Unavailable
from mbsym.problems.checks import Check
from mbsym.problems.equilibrium import Displacement

TOP = """mbsym: 1
name: top
parameters: {{A: {{positive: true}}, B: {{positive: true}}, C: {{positive: true}}, D: {{real: true}}, E: {{real: true}},
  m: {{positive: true}}, l: {{positive: true}}, g: {{positive: true}}, h: {{real: true}}, k: {{real: true}}}}
bodies:
{bodies}
loads: [{{uniform gravity: {{vector: [{gravity}]}}}}]
motion: {{{motion}}}
"""
HEAVY = "mass centre: [0, 0, l], mass: m, inertia about: joint, inertia: [[A, 0, D], [0, B, E], [D, E, C]]"
LIGHT = "mass centre: [0, 0, l], mass: m, inertia about: joint, inertia: [A, B, C]"


def turned(axes: str, rest: str) -> str:
    return f"  - {{name: top, attached to: 0, rotation: {{axes: {axes}, angles: [psi, theta, phi]}}, {rest}}}"


def framed(rest: str) -> str:
    """The same turns by frames without mass."""
    frame = "  - {{name: {}, attached to: {}, rotation: {{axes: [{}], angles: [{}]}}, mass: 0}}"
    last = f"  - {{name: top, attached to: two, rotation: {{axes: [3], angles: [phi]}}, {rest}}}"
    return "\n".join([frame.format("one", 0, 3, "psi"), frame.format("two", "one", 1, "theta"), last])


POINT = (
    '  - {name: ball, attached to: 0, connection point: ["l*sin(theta)*cos(phi)", "l*sin(theta)*sin(phi)",'
    ' "l*cos(theta)"], coordinates: [theta, phi], mass: m}'
)


def found(folder: Path, bodies: str, gravity: str, motion: str) -> Analysis:
    path = filed(folder / "top.yaml", TOP.format(bodies=bodies, gravity=gravity, motion=motion))
    return mbsym.load(path, (3, 4))


def told(one: Analysis) -> Check:
    check = one.check("equilibrium")
    assert check is not None
    return check


def demanded(one: Analysis) -> set[str]:
    return {str(x).lstrip("-") for x in one.equilibrium.conditions}


@pytest.mark.parametrize("bodies", [turned("[3, 1, 3]", LIGHT), framed(LIGHT)], ids=["angles", "frames"])
@pytest.mark.parametrize("theta", ["0", "pi"])
def test_a_top_stands_upright_only_under_vertical_loads_in_any_angles(bodies: str, theta: str, tmp_path: Path) -> None:
    singular = found(tmp_path, bodies, "h, k, -g", f"theta: {theta}")
    regular = found(tmp_path, turned("[3, 1, 2]", LIGHT), "h, k, -g", f"theta: {theta}")
    assert demanded(singular) == demanded(regular) == {"h", "k"}
    assert dict(singular.equilibrium.solved).keys() == {"h", "k"}
    (displacement,) = singular.equilibrium.singular
    assert {name for name, _ in displacement} == {"psi", "phi"}
    assert not regular.equilibrium.singular


def test_under_its_weight_alone_it_does(tmp_path: Path) -> None:
    one = found(tmp_path, turned("[3, 1, 3]", LIGHT), "0, 0, -g", "theta: 0")
    assert one.equilibrium.satisfied
    assert told(one).outcome == "exact"


def test_a_body_turns_steadily_about_principal_axes_only(tmp_path: Path) -> None:
    """Euler's equations: J w' + w x J w = 0 with w = (0, 0, 2) leaves 4 (-J23, J13, 0), which has to vanish."""
    one = found(tmp_path, turned("[3, 1, 3]", HEAVY), "0, 0, 0", "psi: {rate: 2}")
    assert not one.equilibrium.satisfied
    assert dict(one.equilibrium.solved).keys() == {"D", "E"}


def test_a_point_in_spherical_coordinates_rests_at_the_pole_under_no_load_across(tmp_path: Path) -> None:
    one = found(tmp_path, POINT, "h, k, -g", "theta: 0")
    assert dict(one.equilibrium.solved).keys() == {"h", "k"}
    assert one.equilibrium.singular == ((("phi", 1),),)


def test_a_motion_that_is_proposed_is_one(tmp_path: Path) -> None:
    """Where none is given, rest at zero is; under a load across the upright top has none."""
    for gravity, proposed in (("0, 0, -g", True), ("g, 0, -g", False)):
        path = tmp_path / "top.yaml"
        text = TOP.format(bodies=turned("[3, 1, 3]", LIGHT), gravity=gravity, motion="")
        path.write_text(text.replace("motion: {}\n", ""))
        with pytest.raises(Unavailable) as refused:
            assert mbsym.load(path, (4,)).equilibrium
        assert ("add for example" in str(refused.value.args)) == proposed, refused.value.args


@pytest.mark.parametrize(
    "load", ["spring: {coordinate: psi, stiffness: m*g*l}", "potential: m*g*l*psi**2/2", "potential: m*g*l*psi*theta"]
)
def test_loads_on_angles_themselves_are_in_balance_where_they_vanish(load: str, tmp_path: Path) -> None:
    """A spring on an angle is the same load when it is written as its potential."""
    path = tmp_path / "top.yaml"
    text = TOP.format(bodies=turned("[3, 1, 3]", LIGHT), gravity="0, 0, -g", motion="theta: 0")
    path.write_text(text.replace("loads: [", f"loads: [{{{load}}}, "))
    assert mbsym.load(path, (3, 4)).equilibrium.satisfied


def test_the_summary_tells_whose_angles_are_judged(tmp_path: Path) -> None:
    """theta and phi lean in the angles 3, 1, 2; in those of the description phi turns about the vertical and drifts."""
    found(tmp_path, turned("[3, 1, 3]", LIGHT), "0, 0, -g", "theta: 0")
    done = invoked("run", tmp_path / "top.yaml", "--out", tmp_path / "out", code=0)
    assert "phi: unstable" in done.output
    assert "about axes 3, 1, 2 by psi, theta, phi" in " ".join(done.output.split())


def test_what_is_left_out_is_found_by_the_second_route(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def nothing(analysis: Analysis, singular: Sequence[Displacement]) -> list[Polynomial]:
        return [analysis.ring.zero] * 3 * len(singular)

    monkeypatch.setattr(approximation, "beside", nothing)
    assert told(found(tmp_path, turned("[3, 1, 3]", LIGHT), "h, k, -g", "theta: 0")).failed
