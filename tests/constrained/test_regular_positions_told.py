"""What is said of regular positions at which a fixed choice of rows or of pivots would fail: by hand, in any unit."""

from __future__ import annotations

import cmath
from fractions import Fraction
from pathlib import Path
from random import Random

import numpy as np
import pytest
from conftest import invoked, system_of

import mbsym
from mbsym.analysis.pipeline import Analysis
from mbsym.analysis.resting import relative_equilibria
from mbsym.analysis.soundness import complain
from mbsym.numerics.closing import closed
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.scenario import scenario
from mbsym.problems.stability.words import Word
from mbsym.simulation import Request, simulate
from mbsym.source import read
from tests.constrained.test_flow_on_the_manifold import apart, numbers
from tests.random_systems import coupled


def analysed(text: str) -> Analysis:
    system = system_of(text)
    return Analysis(system)


def points(size: Fraction, rough: Fraction = Fraction(0)) -> str:
    """Cranks of one length with the coupler's middle on a third one, as masses at distances: 6 rows of rank 5.

    |AB| = 2 s, |AC| = |CB| = s hold C in the middle, where the three rows are dependent.
    """
    places = {"A": (Fraction(3, 5), 0), "B": (Fraction(3, 5), 2), "C": (Fraction(3, 5), 1)}
    bodies = [
        f"{{name: {name}, attached to: 0, connection point: [x{name}, y{name}, 0], coordinates: [x{name}, y{name}], "
        "mass: 1}"
        for name in places
    ]
    pairs = [("0", "A", 0, 1), ("0", "B", 2, 1), ("A", "B", 0, 2), ("0", "C", 1, 1), ("A", "C", 0, 1), ("C", "B", 0, 1)]
    rows = [
        f"distance: {{between: [{{body: {a}, point: [{at * size}, 0, 0]}}, {{body: {b}, point: [0, 0, 0]}}], "
        f"length: {length * size}}}"
        for a, b, at, length in pairs
    ]
    start = [f"x{name}: {(x + at + rough) * size}, y{name}: {-size * 4 / 5}" for name, (x, at) in places.items()]
    rest = [f"x{name}: {at * size}, y{name}: {-size}" for name, (_, at) in places.items()]
    lines = ["mbsym: 1", "name: points", "bodies:", *(f"  - {x}" for x in bodies)]
    lines += ["loads: [{uniform gravity: {vector: [0, -10, 0]}}]", "constraints:", *(f"  - {x}" for x in rows)]
    return "\n".join([*lines, f"motion: {{{', '.join(rest)}}}", f"initial: {{{', '.join(start)}}}", ""])


@pytest.mark.parametrize("size", [Fraction(1, 1000), Fraction(1), Fraction(10_000)])
@pytest.mark.parametrize("rough", [Fraction(0), Fraction(3, 100)])
def test_rows_that_follow_on_the_constraints_alone(size: Fraction, rough: Fraction) -> None:
    """Off the constraints all six are independent, and Newton's steps by all of them lead to other branches."""
    analysis = analysed(points(size, rough))
    assert analysis.constraints.velocity_rank == 5
    roots = np.linalg.eigvals(numbers(analysis.state_space.A.polynomials))
    w = cmath.sqrt(10 / size)
    assert apart(roots, [1j * w, -1j * w]) < 1e-9


@pytest.mark.parametrize("start", ["initial", "motion"])
def test_both_rests_of_such_points_are_listed(start: str) -> None:
    """Hanging and upright, whatever branch the rest of the points' positions lie on; one of the two starts is given."""
    text = "\n".join(x for x in points(Fraction(1)).split("\n") if ":" in x and not x.startswith(start))
    system = system_of(text)
    found = relative_equilibria(system, {})
    assert {x.values[1].value: x.verdict.word for x in found.equilibria} == {-1.0: Word.STABLE, 1.0: Word.UNSTABLE}


CASTOR = """\
mbsym: 1
name: castor
bodies:
  - {name: car, attached to: 0, connection point: [x, y, 0], rotation: {axes: [3], angles: [th]}, mass: 2,
     mass centre: [1/4, 0, 0], inertia about: mass centre, inertia: [1, 1, 1], coordinates: [x, y, th]}
  - {name: castor, attached to: car, connection point: [1, 0, 0], rotation: {axes: [3], angles: [ps]}, mass: 0}
  - {name: wheel, attached to: castor, connection point: [-1/5, 0, 0], rotation: {axes: [2], angles: [p]}, mass: 0}
constraints:
  - velocity: x_dot*sin(th) - y_dot*cos(th) = 0
  - rolling: {body: wheel, point: [0, 0, -1/10], axes: castor, on: ground}
motion: {%s, th: %s, p: {rate: 10}}
"""


@pytest.mark.parametrize(("way", "yaw"), [("x: {rate: 1}", "0"), ("y: {rate: 1}", "pi/2"), ("x: {rate: -1}", "pi")])
def test_a_castor_has_its_roots_at_any_yaw(way: str, yaw: str) -> None:
    """-v/d of the castor, -m a v/(J + m a^2) of the car, also where the solved velocities are singular: no failure."""
    analysis = analysed(CASTOR % (way, yaw))
    roots = np.linalg.eigvals(numbers(analysis.state_space.A.polynomials))
    assert apart(roots, [-5, -4 / 9]) < 1e-9
    assert analysis.equations.embedded is not None
    assert analysis.stability.verdict.word is not Word.UNSTABLE


def test_pins_in_line_with_a_rod_are_no_singular_position() -> None:
    """Rods on the other side hold the wheels there: nothing of them is stopped at second order, to roundings."""
    for form in ("distance", "relation"):
        for angle in (Fraction(0), Fraction(355, 113)):
            dynamics = Dynamics(closed(scenario(analysed(coupled(Random("coupled 1"), form, angle)).system)).scenario)
            assert dynamics.constraints is not None
            assert not dynamics.constraints.more_is_held
    run = simulate(scenario(analysed(coupled(Random("coupled 1"), "relation", Fraction(0))).system), Request(time=1.0))
    assert run.trajectory.whole
    assert not run.trajectory.work.singular


SQUARE = """\
mbsym: 1
name: square
bodies: [{name: p, attached to: 0, connection point: [x, y, 0], coordinates: [x, y], mass: 1}]
constraints:
  - relation: %s = 0
initial: {x: 1, y: 1}
"""


@pytest.mark.parametrize(("relation", "wrong"), [("(x - y)**2", True), ("x - y", False), ("(x - y)*(x + y)", False)])
def test_a_square_ties_nothing(relation: str, wrong: bool) -> None:
    system, complaints = read(SQUARE % relation)
    assert system is not None
    complain(system, complaints)
    assert [one.code for one in complaints] == ["square-constraint"] * wrong


def test_a_row_that_is_flat_beside_one_that_holds_it_is_none() -> None:
    """A hinge u held at a point: cos u = 1 is flat, sin u = 0 holds it; what hangs there has w^2 = g/(l + J/l)."""
    text = """\
mbsym: 1
name: lock
bodies:
  - {name: b, attached to: 0, rotation: {axes: [1], angles: [u]}, mass: 1,
     inertia about: mass centre, inertia: [1, 1, 1]}
  - {name: c, attached to: b, rotation: {axes: [3], angles: [w]}, mass: 1, mass centre: [1, 0, 0],
     inertia about: mass centre, inertia: [1, 1, 1]}
loads: [{uniform gravity: {vector: [0, -8, 0]}}]
constraints:
  - coincide: [{body: b, point: [0, 1, 0]}, {body: 0, point: [0, 1, 0]}]
motion: {u: 0, w: -pi/2}
"""
    system, complaints = read(text)
    assert system is not None
    complain(system, complaints)
    assert not list(complaints)
    roots = np.linalg.eigvals(numbers(Analysis(system).state_space.A.polynomials))
    assert apart(roots, [2j, -2j]) < 1e-9


SCALES = """\
mbsym: 1
name: scales
bodies:
  - {name: u, attached to: 0, rotation: {axes: [3], angles: [a]}, mass: 1,
     inertia about: mass centre, inertia: [1, 1, 1]}
  - {name: d, attached to: 0, connection point: [0, -1, 0], rotation: {axes: [3], angles: [b]}, mass: 1,
     inertia about: mass centre, inertia: [1, 1, 1]}
  - {name: l, attached to: u, connection point: [-2, 0, 0], rotation: {axes: [3], angles: [c]}, mass: 1,
     mass centre: [-3, 0, 0], inertia about: mass centre, inertia: [1, 1, 1]}
  - {name: r, attached to: u, connection point: [2, 0, 0], rotation: {axes: [3], angles: [e]}, mass: 1,
     mass centre: [1, 0, 0], inertia about: mass centre, inertia: [1, 1, 1]}
loads: [{uniform gravity: {vector: [0, -9.81, 0]}}]
constraints:
  - coincide: [{body: l, point: [0, -1, 0]}, {body: d, point: [-2, 0, 0]}]
  - coincide: [{body: r, point: [0, -1, 0]}, {body: d, point: [2, 0, 0]}]
initial: {a: 0.2, b: 0.2, c: -0.2, e: -0.2}
"""


def test_rest_that_rows_hold_is_no_coarse_run(tmp_path: Path) -> None:
    """Roberval's balance rests at any angle, whatever the arms of equal weights; what moves it are roundings."""
    (tmp_path / "scales.yaml").write_text(SCALES)
    done = invoked("simulate", tmp_path / "scales.yaml", "--time", "1", "--out", tmp_path / "o", code=0)
    assert "warning" not in done.output
    assert "motion  none: the initial state is an equilibrium" in done.output
    assert "by roundings" in done.output or "no coordinate changes in this run, either" in done.output
    assert "energy  conserved (proved); largest drift" in done.output
    run = simulate(scenario(mbsym.loads(SCALES, (3,)).system), Request(time=1.0))
    assert run.conservation.change < 1e-12


@pytest.mark.parametrize(
    ("relation", "everywhere"), [("sqrt(3)*x + y*(1 + x**2)", True), ("x + y**3", True), ("x*y - 1", False)]
)
def test_what_never_vanishes_is_no_condition(relation: str, everywhere: bool) -> None:
    """1 + x^2 and 1, by which y' and x' are solved for; x y = 1 is solved for where x is not 0."""
    solved = analysed(SQUARE % relation).constraints.solved
    assert solved is not None
    assert solved.regular_everywhere == everywhere


def test_products_of_numbers_are_multiplied_out(tmp_path: Path) -> None:
    """``2*1000`` was written as ``2 1000``."""
    text = SQUARE % "x - 2*1000*y" + "motion: {x: 2*1000, y: 1}\n"
    (tmp_path / "one.yaml").write_text(text.replace("initial: {x: 1, y: 1}\n", ""))
    done = invoked("run", tmp_path / "one.yaml", "--out", tmp_path / "o", "-p", "1-4")
    assert "x = 2000" in done.output
    assert "2 1000" not in done.output
