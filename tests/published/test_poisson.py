"""Rigid bodies in p, q, r and unit vectors against published solutions, and against the same systems in angles."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import SHIPPED, reference

import mbsym
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
    analysis = mbsym.load(SHIPPED / "gyrostat-poisson.yaml")
    run = mbsym.simulate(analysis, time=0.1, tolerance=1e-12, samples=11)
    names = {"gamma1": "gamma", "gamma2": "gammap", "gamma3": "gammapp", "p": "p", "q": "q", "r": "r"}
    wanted = {ours: float(row[theirs]) for ours, theirs in names.items()}
    for variable, value in wanted.items():
        assert run[variable][-1] == pytest.approx(value, rel=1e-9)
    assert np.allclose(run["gamma1"] ** 2 + run["gamma2"] ** 2 + run["gamma3"] ** 2, 1.0, atol=1e-14)


@pytest.mark.parametrize("name", ["gyrostat", "clebsch"])
def test_they_say_the_same_as_in_angles(name: str) -> None:
    """Energies, and verdicts where there is a motion, of the two descriptions at the same numbers."""
    angles, vectors = mbsym.load(SHIPPED / f"{name}.yaml"), mbsym.load(SHIPPED / f"{name}-poisson.yaml")
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
