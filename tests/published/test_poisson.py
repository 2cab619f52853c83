"""Rigid bodies in p, q, r and unit vectors against published solutions, and against the same systems in angles."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import SHIPPED, derived, reference

import mbsym
from mbsym.expressions.parser import parse_expression
from mbsym.expressions.place import Complaints, Span
from mbsym.formulas.formula import Formula
from mbsym.problems.checks import EXACT

FREE = """
mbsym: 1
name: Free rigid body
parameters: {{I1: positive, I2: positive, I3: positive}}
values: {{I1: {I1}, I2: {I2}, I3: {I3}}}
bodies:
  - name: body
    attached to: 0
    rotation: {{axes: [1, 2, 3], angles: [a, b, c]}}
    mass: 0
    inertia about: joint
    inertia: {{tensor: [I1, I2, I3], accept: true}}
    speeds: {{w1: omega1, w2: omega2, w3: omega3}}
    orientation: direction cosines
initial: {{a: {{position: 0, velocity: {w1}}}, b: {{position: 0, velocity: {w2}}}, c: {{position: 0, velocity: {w3}}}}}
"""


def test_a_free_rigid_body_against_jacobis_functions() -> None:
    """Hairer, Norsett and Wanner's: y1' = -2 y2 y3, y2' = 1.25 y1 y3, y3' = -0.5 y1 y2 from (1, 0, 0.9)."""
    exact = reference("free_rigid_body")["reference"]["hnw"]
    analysis = mbsym.loads(FREE.format(I1="1/2", I2=2, I3=3, w1=1, w2=0, w3="9/10"))
    assert [str(x) for x in analysis.equations.needed] == [
        "I1*w1_dot + (I3 - I2)*w2*w3", "I2*w2_dot + (I1 - I3)*w1*w3", "I3*w3_dot + (I2 - I1)*w1*w2",
    ]  # fmt: skip
    run = mbsym.simulate(analysis, time=1.0, tolerance=1e-13)
    for name, value in zip(("w1", "w2", "w3"), exact["t1"], strict=True):
        assert run[name][-1] == pytest.approx(float(value), abs=1e-11)


def test_the_gyrostat_of_the_paper_against_thirty_digits() -> None:
    row = next(x for x in reference("gyrostat")["clean_E1_simple_ic"]["rows"] if x["t"] == "1/10")
    analysis = derived(SHIPPED / "gyrostat-poisson.yaml")
    run = mbsym.simulate(analysis, time=0.1, tolerance=1e-12, samples=11)
    names = {"gamma1": "gamma", "gamma2": "gammap", "gamma3": "gammapp", "p": "p", "q": "q", "r": "r"}
    wanted = {ours: float(row[theirs]) for ours, theirs in names.items()}
    for variable, value in wanted.items():
        assert run[variable][-1] == pytest.approx(value, rel=1e-9)
    assert np.allclose(run["gamma1"] ** 2 + run["gamma2"] ** 2 + run["gamma3"] ** 2, 1.0, atol=1e-14)


@pytest.mark.parametrize("name", ["gyrostat", "clebsch"])
def test_they_say_the_same_as_in_angles(name: str) -> None:
    """Energies, and verdicts where there is a motion, of the two descriptions at the same numbers."""
    angles, vectors = derived(SHIPPED / f"{name}.yaml"), derived(SHIPPED / f"{name}-poisson.yaml")
    runs = [mbsym.simulate(one, time=0.01, samples=5) for one in (angles, vectors)]
    assert np.allclose(runs[0].energy, runs[1].energy, rtol=1e-12)
    if angles.system.motion:
        assert str(angles.stability.numerical) == str(vectors.stability.numerical)
        assert [x.name for x in vectors.integrals] == [
            "generalised energy", "angular momentum about axis 3", "length of gamma",
        ]  # fmt: skip
    assert vectors.claims
    assert all(claim.holds for claim in vectors.claims)
    assert vectors.check("equations of motion").outcome == EXACT


def test_without_an_orientation_of_its_own_the_trajectory_holds_speeds_alone() -> None:
    text = FREE.format(I1=2, I2=2, I3=3, w1=1, w2=0, w3=1).replace("    orientation: direction cosines\n", "")
    run = mbsym.simulate(mbsym.loads(text), time=0.5, samples=3)
    assert sorted(run.speeds) == ["w1", "w2", "w3"]
    assert np.allclose(run["w3"], 1.0)
    with pytest.raises(KeyError):
        run["gamma1"]


PANES = """
mbsym: 1
name: Two particles between rotating panes
parameters: {m1: positive, m2: positive, L: positive, g: positive, omega: positive}
prescribed: {chi: {rate: omega}}
bodies:
  - {name: panes, attached to: 0, rotation: {axes: [2], angles: [chi]}, mass: 0}
  - name: first
    attached to: panes
    rotation: {axes: [3], angles: [q3]}
    connection point: [q1, q2, 0]
    coordinates: [q1, q2, q3]
    mass: m1
    speeds: {u1: q1_dot*cos(q3) + q2_dot*sin(q3), u2: q2_dot*cos(q3) - q1_dot*sin(q3)}
  - {name: second, attached to: first, mass: m2, mass centre: [L, 0, 0]}
loads:
  - uniform gravity: {vector: [0, -g, 0]}
"""


def test_kane_and_levinsons_particles_between_rotating_panes() -> None:
    """Dynamics: Theory and Applications (1985), exercise 11.1: u1', u2', u3' as the book answers."""
    (exercise,) = [x for x in reference("kane_levinson_expressions")["reference"]["items"] if x["ex"] == "11.1"]
    analysis = mbsym.loads(PANES)
    equations = analysis.equations
    assert equations.speeds == ("u1", "u2", "q3_dot")
    book = []
    for answer in exercise["answer"]:
        text = answer.partition("=")[2].replace("^", "**").replace("sin q3", "sin(q3)").replace("cos q3", "cos(q3)")
        for old, new in (
            ("omega**2 q1 cos(q3)", "omega**2*q1*cos(q3)"), ("omega**2 q1 sin(q3)", "omega**2*q1*sin(q3)"),
            ("omega**2 cos**2 q3", "omega**2*cos(q3)**2"), ("omega**2 sin(q3) cos(q3)", "omega**2*sin(q3)*cos(q3)"),
            ("g sin", "g*sin"), ("g cos", "g*cos"), ("u2 u3", "u2*u3"), ("u3 u1", "u3*u1"), (") L m2/", ")*L*m2/"),
        ):  # fmt: skip
            text = text.replace(old, new)
        tree = parse_expression(text.replace("u3", "q3_dot"), Complaints(), lambda _start, _end: Span(1, 1))
        assert tree is not None, text
        book.append(Formula(analysis.ring, analysis.parameters_scene.lower(tree)))
    for row, force in zip(equations.mass_matrix, equations.forcing, strict=True):
        assert sum((entry * rate for entry, rate in zip(row, book, strict=True)), 0 * force) == force
    assert analysis.check("equations of motion").outcome == EXACT
