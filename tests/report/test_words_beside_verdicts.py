"""Words that stand beside a verdict and say what it is about: headings, what is new, why there is nothing.

Derived by hand.  Jeffcott's rotor has no zero root (k > 0); Chaplygin's sleigh has them, as its speed is free.  Of a
Penning trap, z'' + i wc z' - wz^2 z/2 = 0, equality in wc > wz is no border case: there the motion is unstable.  Of a
wheel that drags on a free shaft, B (a'' + b'') = -c b', so that B (a' + b') + c b is constant.  A mass dragged at speed
v by a spring through a resisting medium stays behind by c v/k: it cannot move where the spring has no tension.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner
from terminal import told

import mbsym
from mbsym.algebra.failures import Failure
from mbsym_cli.main import main

SYSTEMS = Path(__file__).parents[2] / "systems"
STATEMENTS = Path(__file__).parents[1] / "cases" / "statements"

SLEIGH = """
mbsym: 1
name: sleigh
parameters: {m: positive, J: positive, a: real, u: real}
bodies:
  - name: sleigh
    connection point: [x, y, 0]
    rotation: {axes: [3], angles: [f]}
    mass centre: [a, 0, 0]
    mass: m
    inertia about: mass centre
    inertia: [J, J, J]
    coordinates: [x, y, f]
constraints:
  - velocity: -x_dot*sin(f) + y_dot*cos(f) = 0
motion: {x: {value: 0, rate: u}, y: 0, f: 0}
"""
DRAGGED = """
mbsym: 1
name: dragged
parameters: {m: positive, k: positive, c: positive, v: positive}
prescribed: {s: v}
bodies:
  - {name: b, mass: m, connection point: [x, 0, 0], coordinates: [x]}
loads:
  - potential: k*(x - s)**2/2
  - rayleigh: c*x_dot**2/2
motion: {x: {value: 0, rate: v}}
"""
WHEEL = """
mbsym: 1
name: wheel
parameters: {A: positive, B: positive, c: positive}
bodies:
  - {name: shaft, rotation: {axes: [3], angles: [a]}, mass: 0, inertia about: joint, inertia: [A, A, A]}
  - name: wheel
    attached to: shaft
    rotation: {axes: [3], angles: [b]}
    mass: 0
    inertia about: joint
    inertia: [B, B, B]
loads:
  - damper: {coordinate: b, coefficient: c}
motion: {}
"""
PENNING = """
mbsym: 1
name: Penning trap
parameters: {wc: positive, wz: positive}
bodies:
  - {name: ion, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
loads:
  - potential: -wz**2*(x**2 + y**2)/4
  - generalized force: {x: wc*y_dot, y: -wc*x_dot}
motion: {}
"""


def headings(analysis: mbsym.Analysis) -> list[str]:
    return [line for line in told(analysis, 6) if line.startswith("Conditions (")]


def test_zero_roots_are_spoken_of_where_there_are_any() -> None:
    (rotor,) = headings(mbsym.load(STATEMENTS / "jeffcott.yaml"))
    assert "zero" not in rotor
    assert "all roots to the left" in rotor
    (sleigh,) = headings(mbsym.loads(SLEIGH))
    assert "all roots but the zero ones" in sleigh


def test_a_heading_does_not_call_necessary_what_its_line_does_not() -> None:
    analysis = mbsym.loads(PENNING)
    (heading,) = headings(analysis)
    assert any("(necessary: with equality" in line for line in told(analysis, 6))
    assert "necessary" not in heading


def test_what_problem_7_lists_is_not_told_to_be_no_function_of_it() -> None:
    analysis = mbsym.loads(WHEEL)
    lines = " ".join(told(analysis, 9))
    assert "B (a' + b') + c b = const" in lines
    assert "a further integral, no function of those known without it (proved)" in lines
    assert "no function of those of problem 7" not in lines


@pytest.mark.parametrize("stage", ["stabilisation", "normal_forms"])
def test_of_a_motion_that_cannot_be_nothing_else_is_said(stage: str) -> None:
    with pytest.raises(Failure, match="the given motion does not exist: -c\\*v = 0 is impossible"):
        getattr(mbsym.loads(DRAGGED), stage)


FREE = """
mbsym: 1
name: free
parameters: {m: positive, k: positive}
bodies:
  - {name: p, mass: m, connection point: [x, 0, 0], coordinates: [x]}
  - {name: q, attached to: p, mass: m, connection point: [z, 0, 0], coordinates: [z]}
loads:
  - potential: k*z**2/2
motion: {x: {value: 0, rate: 1}}
values: {m: 1, k: 1}
"""
HOOP = """
mbsym: 1
name: hoop
parameters: {l: positive, g: positive, w: positive}
prescribed: {psi: w}
bodies:
  - {name: hoop, rotation: {axes: [3], angles: [psi]}, mass: 0}
  - {name: bead, attached to: hoop, connection point: [l*sin(th), 0, -l*cos(th)], mass: 1, coordinates: [th]}
loads:
  - uniform gravity: {vector: [0, 0, -g]}
motion: {th: 0}
"""


@pytest.mark.parametrize(
    ("text", "command", "told", "untold"),
    [
        (FREE, "equilibria", "x moves at the rate 1", "turns"),  # a length
        (HOOP, "average", "psi occurs in no equation of motion", "moves nothing"),  # the hoop turns with it
    ],
)
def test_what_moves_is_said_to_move(tmp_path: Path, text: str, command: str, told: str, untold: str) -> None:
    (tmp_path / "file.yaml").write_text(text, encoding="utf-8")
    result = CliRunner().invoke(main, [command, str(tmp_path / "file.yaml")])
    assert told in result.output + result.stderr
    assert untold not in result.output + result.stderr


@pytest.mark.parametrize(
    ("command", "reason"),
    [
        (["map", "--x", "l=1:2"], "no map: the first approximation is time-dependent"),
        (["nonlinear", "--vary", "l=1:2"], "no values listed: the first approximation is time-dependent"),
        (["sweep", "-v", "l=1:2:3"], "for these equations: the first approximation is time-dependent"),
    ],
)
def test_no_name_of_a_stage_stands_before_a_reason(tmp_path: Path, command: list[str], reason: str) -> None:
    """ "judgeable: the first approximation ..." was told of a shaken pendulum."""
    name, *options = command
    out = [] if name == "nonlinear" else ["--out", str(tmp_path)]
    done = CliRunner().invoke(main, [name, str(SYSTEMS / "shaken-pendulum.yaml"), *options, *out])
    assert reason in " ".join(done.output.split())


def test_a_pendulum_is_not_called_free_of_applied_forces(tmp_path: Path) -> None:
    """Gravity is an applied force: "of systems without applied forces ... this one has 1" was told of a pendulum."""
    path = tmp_path / "pendulum.yaml"
    path.write_text("""
mbsym: 1
name: Pendulum
parameters: {l: positive, g: positive}
bodies: [{name: bob, attached to: 0, rotation: {axes: [3], angles: [x]}, mass centre: [0, -l, 0], mass: 1}]
loads: [uniform gravity: {acceleration: g, direction: [0, -1, 0]}]
motion: {x: 0}
values: {l: 1, g: 9}
""")
    done = CliRunner().invoke(main, ["nonlinear", str(path), "--vary", "l=1:2"])
    assert "no values listed: of systems whose energy is conserved" in " ".join(done.output.split())
