"""Reactions in joints: by hand, against released joints for every kind of constraint, planted mistakes, bad names."""

from __future__ import annotations

from dataclasses import replace

import pytest
from kinds_of_constraints import BODIES, KINDS
from random_systems import numbers

import mbsym
from mbsym.analysis.constrained import programs_of
from mbsym.analysis.pipeline import Analysis
from mbsym.formulas.formula import column
from mbsym.problems.checks import EXACT, FAILED, NUMERICAL
from mbsym.problems.reactions import check_reactions
from mbsym.report.targets import TARGETS

PENDULUM = """
mbsym: 1
name: Pendulum with a rotor
parameters: {m: positive, l: positive, g: positive, J: positive, b: positive, k: positive}
bodies:
  - {name: rod, attached to: 0, rotation: {axes: [3], angles: [q]}, mass centre: [0, -l, 0], mass: m,
     inertia about: mass centre, inertia: [J, J, J]}
loads:
  - uniform gravity: {vector: [0, -g, 0]}
  - damper: {coordinate: q, coefficient: b}
  - torque: {body: rod, components: [0, 0, k], axes: 0}
reactions: [rod]
"""


def checked(analysis: Analysis) -> str:
    check = analysis.check("reactions")
    assert check is not None
    return check.outcome


def test_a_pendulum_by_hand() -> None:
    """In the axes of the rod (1 along the motion, 2 towards the pivot):  m a less the weight.

    R_1 = m l q'' + m g sin q,  R_2 = m l q'^2 + m g cos q,  L_3 = (J + m l^2) q'' + m g l sin q - k = -b q' on the
    motion: the joint's own damper is all that turns it.
    """
    analysis = mbsym.loads(PENDULUM, (1, 2, 3))
    (found,) = analysis.reactions
    ring = analysis.ring
    m, length, g, moment, k = (ring.generator("parameter", name) for name in ("m", "l", "g", "J", "k"))
    s, c = ring.generator("sine", "q"), ring.generator("cosine", "q")
    rate, bent = ring.generator("velocity", "q"), ring.generator("acceleration", "q")
    force = [m * (length * bent + g * s), m * (length * rate**2 + g * c), ring.zero]
    turning = [ring.zero, ring.zero, (moment + m * length**2) * bent + m * g * length * s - k]
    for mine, theirs in zip((*found.force, *found.moment), (*force, *turning), strict=True):
        assert ring.is_zero(mine.polynomial - theirs) is True
    assert checked(analysis) == EXACT


def with_constraint(kind: str) -> Analysis:
    return mbsym.loads(f"{BODIES}  - {KINDS[kind]}\nreactions: [tilt, wheel, arm]\n", (1, 2, 3))


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_constraint_against_released_joints(kind: str) -> None:
    assert checked(with_constraint(kind)) in (EXACT, NUMERICAL)


@pytest.mark.parametrize("kind", ["coincide", "rolling on a body"])
def test_planted_mistakes_are_found(kind: str) -> None:
    analysis = with_constraint(kind)
    found, tied, programs = analysis.reactions, analysis.constraints, programs_of(analysis)
    first = found[1]
    zero = column(analysis.ring, [analysis.ring.zero] * 3)
    (force, moment), *others = first.per_multiplier
    forgotten = replace(first, per_multiplier=((zero, moment), *others))
    assert check_reactions(analysis.oracles, [forgotten], tied, programs).outcome == FAILED
    turned = replace(first, per_multiplier=((force, column(analysis.ring, [-x.polynomial for x in moment])), *others))
    assert check_reactions(analysis.oracles, [turned], tied, programs).outcome == FAILED
    lost = replace(first, moment=zero)
    assert check_reactions(analysis.oracles, [lost], tied, programs).outcome == FAILED


def test_a_joint_that_is_none_is_complained_about() -> None:
    with pytest.raises(mbsym.DescriptionError, match="there is no body 'hinge'"):
        mbsym.loads(PENDULUM.replace("reactions: [rod]", "reactions: [hinge]"))


@pytest.mark.parametrize("drive", ["torque: {body: rod, components: [0, 0, k], axes: 0}", "generalized force: {q: k}"])
def test_what_is_said_to_be_in_a_reaction_is(drive: str) -> None:
    """On the motion  J_O q'' = -b q' - m g l sin q + k,  and L = J_O q'' + m g l sin q - (torques on the body).

    L is -b q' beside a torque on the body, and k - b q' where k is given by the coordinate.
    """
    text = PENDULUM.replace("torque: {body: rod, components: [0, 0, k], axes: 0}", drive)
    analysis = mbsym.loads(text, (1, 2, 3))
    (found,) = analysis.reactions
    holds_torque = bool(found.moment[2].polynomial.degrees()[analysis.ring.index("parameter", "k")])
    assert holds_torque == drive.startswith("torque")  # L = J_O q'' + m g l sin q - k, of which J_O q'' has + k
    told = " ".join(str(TARGETS["html"].render(analysis, (3,))).split())
    assert "given by coordinates" in told
    assert "forces and torques on bodies act besides" in told


def test_a_system_in_speeds_has_them_in_coordinates() -> None:
    """What a joint transmits does not depend on the variables: w = q' with the same pendulum."""
    analysis = mbsym.loads(PENDULUM.replace("mass: m,", "mass: m, speeds: {w: omega3},"), (1, 2, 3))
    plain = mbsym.loads(PENDULUM, (1, 2, 3))
    (mine,), (theirs,) = analysis.reactions, plain.reactions
    assert [str(x) for x in (*mine.force, *mine.moment)] == [
        "m*l*q_ddot + m*g*sin(q)", "m*l*q_dot**2 + m*g*cos(q)", "0", "0", "0", "(m*l**2 + J)*q_ddot + m*l*g*sin(q) - k"
    ]  # fmt: skip
    assert numbers(analysis, [*mine.force, *mine.moment]) == numbers(plain, [*theirs.force, *theirs.moment])
    assert checked(analysis) == EXACT
    told = " ".join(str(TARGETS["html"].render(analysis, (3,))).split())
    assert "They are told in generalised coordinates" in told
