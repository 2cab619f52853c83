"""Velocity constraints that are integrable: on the leaf of the motion the theorems of holonomic systems hold.

A bead on x y = const, given by its rate, between two springs and two dampers: with y = a^2/x the kinetic energy at
x = a is m x'^2, the dissipation c x'^2, the potential (k/2) (x^2 + a^4/x^2), and its second derivative there 4 k.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import pytest
from conftest import analysed

from mbsym.algebra.certainty import Certainty
from mbsym.analysis import approximation
from mbsym.analysis.pipeline import Analysis
from mbsym.problems.checks import EXACT, FAILED, NUMERICAL
from mbsym.problems.constraints import analysis, integrability
from mbsym.problems.stability.words import Because, Word
from mbsym.report.plain_writer import Writer
from mbsym.report.words.constraint_words import reduction_sentences

BEAD = """
mbsym: 1
name: Bead on a hyperbola
parameters:
  m: {sign: positive, value: 1}
  k: {sign: real, value: K}
  a: {sign: positive, value: A}
  c: {sign: nonnegative, value: C}
bodies:
  - {name: bead, attached to: 0, connection point: [x, y, 0], coordinates: [x, y], mass: m}
loads:
  - spring: {coordinate: x, stiffness: k}
  - spring: {coordinate: y, stiffness: k}
  - damper: {coordinate: x, coefficient: c}
  - damper: {coordinate: y, coefficient: c}
constraints:
  - GIVEN
motion: {x: a, y: a}
"""
BY_RATE, BY_PLACE = "velocity: y*x_dot + x*y_dot = 0", "relation: x*y = a**2"


def bead(k: str = "3", a: str = "2", c: str = "0", given: str = BY_RATE) -> Analysis:
    text = BEAD.replace("value: K", f"value: {k}").replace("value: A", f"value: {a}").replace("value: C", f"value: {c}")
    return analysed(text.replace("GIVEN", given))


def test_the_matrices_are_those_of_the_leaf() -> None:
    for given in (BY_RATE, BY_PLACE):
        found = bead(given=given).linearisation
        assert [str(x) for x in found.matrices] == ["[[2*m]]", "[[2*c]]", "[[0]]", "[[4*k]]", "[[0]]"]
        assert found.about.ties
        assert found.about.holonomic
        assert found.about.leaf == (given is BY_RATE)


@pytest.mark.parametrize("a", ["2", "sqrt(2)"])
@pytest.mark.parametrize(
    ("k", "c", "word", "theorem"),
    [
        ("3", "0", Word.STABLE, "Lagrange-Dirichlet"),
        ("3", "1", Word.ASYMPTOTIC_BUT_STEADY, "Kelvin-Chetaev, Lyapunov-Malkin"),  # another x y stays another one
        ("-3", "1", Word.UNSTABLE, "Kelvin-Chetaev"),
        ("-3", "0", Word.UNSTABLE, "Kelvin-Chetaev"),
    ],
)
def test_theorems_on_energy_hold_on_the_leaf(a: str, k: str, c: str, word: Word, theorem: str) -> None:
    verdict = bead(k, a, c).stability.numerical
    assert verdict is not None
    assert (verdict.word, verdict.theorem) == (word, theorem)
    held = bead(k, a, c, BY_PLACE).stability.numerical
    assert held is not None
    assert held.word is (Word.ASYMPTOTIC if word is Word.ASYMPTOTIC_BUT_STEADY else word)


def test_it_is_said_in_symbols_too() -> None:
    """c > 0 declared, and k > 0: K > 0, D > 0."""
    text = BEAD.replace("k: {sign: real, value: K}", "k: positive").replace(
        "a: {sign: positive, value: A}", "a: positive"
    )
    text = text.replace("c: {sign: nonnegative, value: C}", "c: positive").replace("GIVEN", BY_RATE)
    verdict = analysed(text).stability.verdict
    assert (verdict.word, verdict.theorem) == (Word.ASYMPTOTIC_BUT_STEADY, "Kelvin-Chetaev, Lyapunov-Malkin")
    assert verdict.because(Because.OTHER_LEAF)


def test_a_part_that_decays_beside_one_that_does_not_is_stable() -> None:
    """One energy does not grow, and has its minimum on every leaf near by."""
    text = BEAD.replace("GIVEN", BY_RATE + "\n  - velocity: v*u_dot + u*v_dot = 0")
    text = text.replace("value: K", "value: 3").replace("value: A", "value: 2").replace("value: C", "value: 1")
    other = "  - {name: other, attached to: 0, connection point: [u, v, 0], coordinates: [u, v], mass: m}\n"
    springs = "  - spring: {coordinate: u, stiffness: k}\n  - spring: {coordinate: v, stiffness: k}"
    text = text.replace("loads:", other + "loads:\n" + springs)
    verdict = analysed(text.replace("y: a}", "y: a, u: a, v: a}")).stability.numerical
    assert verdict is not None
    assert (verdict.word, verdict.theorem) == (Word.STABLE, "Lagrange-Dirichlet")


def test_the_report_says_that_it_is_about_the_leaf() -> None:
    about = bead().linearisation.about
    assert about is not None
    told = " ".join(map(Writer().said, reduction_sentences(about)))
    assert "integrable (Frobenius; proved): they keep relations between the coordinates, 1 in number" in told
    assert "the first approximation is that of disturbances that keep the values of these" in told
    assert "D, G, K and N are taken as no more" not in told


def test_multipliers_agree() -> None:
    checks = {check.name: check.outcome for check in bead().checks}
    assert {checks["perturbed motion"], checks["equilibrium"]} <= {EXACT, NUMERICAL}
    assert FAILED not in checks.values()


def test_a_stiffness_that_forgets_the_leaf_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """C of the independent coordinates in place of C Y_0."""
    original = approximation.on_leaf

    def wrong(scene: Any, found: Any, equations: Any) -> Any:
        there, own = original(scene, found, equations)
        short = tuple(row[: len(own.A)] for row in equations.C)
        return there, dataclasses.replace(own, C=short)

    monkeypatch.setattr(approximation, "on_leaf", wrong)
    check = bead().check("perturbed motion")
    assert check is not None
    assert check.outcome == FAILED


# --- where it must not be said ---


def test_what_is_not_proved_is_no_leaf(monkeypatch: pytest.MonkeyPatch) -> None:
    def unproved(*arguments: Any) -> Any:
        return dataclasses.replace(integrability.integrability(*arguments), certainty=Certainty.VERIFIED)

    monkeypatch.setattr(analysis, "integrability", unproved)
    found = bead()
    known = found.constraints.integrability
    assert known is not None
    assert (known.word, known.certainty.value) == ("holonomic", "verified numerically")
    about = found.linearisation.about
    assert about is not None
    assert (about.leaf, about.holonomic) == (0, False)
    verdict = found.stability.numerical
    assert verdict is not None
    assert verdict.word not in (Word.STABLE, Word.ASYMPTOTIC)


def test_what_is_not_integrable_has_no_leaf() -> None:
    """y x' + x y' = x z': omega ^ d omega = -y dx ^ dy ^ dz or so, not 0."""
    text = BEAD.replace(
        "connection point: [x, y, 0], coordinates: [x, y]", "connection point: [x, y, z], coordinates: [x, y, z]"
    )
    text = text.replace("constraints:", "  - spring: {coordinate: z, stiffness: k}\nconstraints:")
    text = text.replace("GIVEN", "velocity: y*x_dot + x*y_dot = x*z_dot").replace("y: a}", "y: 0, z: 0}")
    text = text.replace("value: K", "value: 3").replace("value: A", "value: 2").replace("value: C", "value: 0")
    found = analysed(text)
    known = found.constraints.integrability
    assert known is not None
    assert known.word == "nonholonomic"
    about = found.reduced.about
    assert (about.leaf, about.holonomic) == (0, False)


def test_with_time_there_is_no_leaf() -> None:
    found = bead(given="velocity: y*x_dot + x*y_dot = 0*t + 0*a").constraints.integrability
    assert found is not None
    moving = analysed(
        BEAD.replace("GIVEN", "velocity: y*x_dot + x*y_dot = a*m")
        .replace("value: K", "value: 3")
        .replace("value: A", "value: 2")
        .replace("value: C", "value: 0")
    )
    known = moving.constraints.integrability
    assert known is not None
    assert known.rheonomic
    assert moving.optional("reduced") is None or moving.reduced.about.leaf == 0


WHEEL = """
mbsym: 1
name: Wheel with a pendulum
parameters: {m: positive, r: positive, J: positive, l: positive, g: positive, c: positive}
bodies:
  - {name: cart, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: m}
  - {name: wheel, attached to: cart, rotation: {axes: [3], angles: [phi]}, mass: 0, inertia about: joint,
     inertia: [0, 0, J]}
  - {name: bob, attached to: cart, rotation: {axes: [3], angles: [theta]}, mass: m, mass centre: [0, -l, 0]}
loads:
  - uniform gravity: {vector: [0, -g, 0]}
  - damper: {coordinate: theta, coefficient: c}
constraints:
  - velocity: x_dot + r*phi_dot = 0
motion: {x: {rate: v}, phi: {rate: -v/r}, theta: 0}
"""


@pytest.mark.parametrize(
    "described_as",
    [
        WHEEL,
        WHEEL + "dependent: [x]\n",
        WHEEL + "dependent: [phi]\n",
        # by hand: phi = -x/r, no constraint
        WHEEL.replace("angles: [phi]", "angles: [-x/r]")
        .replace("constraints:\n  - velocity: x_dot + r*phi_dot = 0\n", "")
        .replace("phi: {rate: -v/r}, ", ""),
    ],
)
def test_a_wheel_that_runs_on_is_judged_alike_in_every_description(described_as: str) -> None:
    """The wheel may be anywhere and run at any speed: (2 m + J/r^2) x' + m l cos(theta) theta' is constant.

    Without x the pendulum has  m l (l - m l/(2 m + J/r^2)) theta'' + c theta' + m g l theta = 0  near theta = 0: it
    comes to rest, and the wheel drifts.
    """
    found = analysed(described_as.replace("c: positive}", "c: positive, v: real}"))
    assert found.stability.verdict.word is Word.ASYMPTOTIC_BUT_CYCLIC
    (part,) = found.stability.subsystems
    coefficients = part.characteristic
    assert [x.is_zero for x in coefficients] == [True, True, False, False, False]  # lambda^2 (. lambda^2 + . + .)


def test_a_wheel_that_stands_is_judged_without_a_family_in_the_description() -> None:
    found = analysed(WHEEL.replace("x: {rate: v}, phi: {rate: -v/r}, ", ""))
    assert found.stability.verdict.word is Word.ASYMPTOTIC_BUT_CYCLIC


ROLLS = """
mbsym: 1
name: Wheel on a level road
parameters: {m: {sign: positive, value: 2}, R: {sign: positive, value: 1/5}, J: {sign: positive, value: 1/20}, OTHER}
bodies:
  - {name: wheel, attached to: 0, coordinates: [x, phi], connection point: [x, R, 0],
     rotation: {axes: [3], angles: [phi]}, mass: m, inertia about: mass centre, inertia: [0, 0, J]}
loads:
  - uniform gravity: {acceleration: 9.81, direction: [0, -1, 0]}
  - damper: {coordinate: x, coefficient: c}
constraints:
  - rolling: {body: wheel, point: [0, -R, 0], axes: 0, on: ground}
"""


@pytest.mark.parametrize("motion", ["{x: 0, phi: 0}", "{x: {rate: -R*w}, phi: {rate: w}}"])
def test_a_wheel_that_nothing_holds_does_not_come_to_rest(motion: str) -> None:
    # (m + J/R^2) x'' = 0: a disturbed velocity stays what it is, for ever.
    free = ROLLS.replace("  - damper: {coordinate: x, coefficient: c}\n", "")
    free = free.replace("OTHER", "w: {sign: real, value: 3}")
    stability = analysed(free + f"motion: {motion}\n").stability
    assert stability.numerical is not None
    assert stability.verdict.word is stability.numerical.word
    assert not stability.verdict.word.asymptotic
    if "rate" not in motion:
        assert stability.verdict.word is Word.STABLE_BUT_CYCLIC


PUSHED = """
mbsym: 1
name: Pushed by what the relation is
parameters: {m: {sign: positive, value: 2}, R: {sign: positive, value: 1}, k: {sign: SIGN, value: 1}}
bodies:
  - {name: a, attached to: 0, coordinates: [x, y], connection point: [x, y, 0], mass: m}
constraints:
  - velocity: x_dot + R*y_dot = 0
loads:
  - generalized force: {x: k*(x + R*y)}
motion: {x: 0, y: 0}
"""


@pytest.mark.parametrize("sign", ["real", "positive"])
def test_a_force_by_the_value_of_the_relation_lets_no_velocity_stay_near(sign: str) -> None:
    # x + R y = c is kept: m (1 + 1/R^2) x'' = k c, so x' = k c t/(m (1 + 1/R^2)) grows without bound from rest, however
    # small c is.  With c = 0 nothing acts.
    stability = analysed(PUSHED.replace("SIGN", sign)).stability
    assert not stability.verdict.word.stable
    assert stability.numerical is not None
    assert not stability.numerical.word.stable


def test_a_wheel_with_a_damper_comes_to_rest() -> None:
    # (m + J/R^2) x'' + c x' = 0 with c > 0: the velocity decays, the place where it stops is another.
    damped = ROLLS.replace("OTHER", "c: {sign: positive, value: 1}")
    stability = analysed(damped + "motion: {x: 0, phi: 0}\n").stability
    assert stability.verdict.word is Word.ASYMPTOTIC_BUT_CYCLIC


@pytest.mark.parametrize(
    ("potential", "word"),
    [("k*(x + y)**4", Word.STABLE), ("k*x**4", Word.STABLE), ("k*x**4 + k*y**3", Word.UNSTABLE)],
)
@pytest.mark.parametrize("values", ["", "values: {m: 1, k: 1, d: 1}"])
def test_what_decays_by_terms_of_higher_order_decays_on_its_leaf_alone(potential: str, word: Word, values: str) -> None:
    # y = x + c is kept: of V = k (x + y)^4 the particle comes to rest at x = -c/2, never to come back to x = y = 0.
    text = f"""
mbsym: 1
name: Slides along a line that a disturbance changes
parameters: {{m: positive, k: positive, d: positive}}
bodies:
  - {{name: p, attached to: 0, coordinates: [x, y], connection point: [x, y, 0], mass: m}}
constraints:
  - velocity: y_dot = x_dot
loads:
  - potential: {potential}
  - damper: {{coordinate: x, coefficient: d}}
motion: {{x: 0, y: 0}}
{values}
"""
    stability = analysed(text).stability
    assert stability.verdict.word is word
    assert stability.numerical is None or stability.numerical.word is word
    assert "problem 11" not in stability.verdict.explanation  # it does not take constraints


@pytest.mark.parametrize("given", ["velocity: 5*z_dot = 3*x_dot + 4*y_dot", "relation: 5*z = 3*x + 4*y - 5"])
@pytest.mark.parametrize(("sign", "words"), [("-", {Word.STABLE, Word.ASYMPTOTIC}), ("+", {Word.UNSTABLE})])
@pytest.mark.parametrize("friction", ["", "  - rayleigh: (x_dot**2 + y_dot**2)/2"])
def test_a_turn_that_leads_off_the_leaf_is_no_symmetry(given: str, sign: str, words: set[Word], friction: str) -> None:
    # V = (x^2 + y^2 - 1)^2 - s z^2 is the same after a turn in the plane, which z = (3 x + 4 y - 5)/5 does not allow.
    # On the circle z = cos(a) - 1 = -a^2/2, a from the motion, so V = -s a^4/4 along what K leaves open.
    text = f"""
mbsym: 1
name: Valley round an axis, tilted
bodies:
  - {{name: p, attached to: 0, coordinates: [x, y, z], connection point: [x, y, z], mass: 1}}
constraints:
  - {given}
loads:
  - force function: -(x**2 + y**2 - 1)**2 {sign} z**2/9
{friction}
motion: {{x: 3/5, y: 4/5, z: 0}}
"""
    verdict = analysed(text).stability.numerical
    assert verdict is not None
    assert verdict.word in words
