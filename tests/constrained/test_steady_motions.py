"""Verdicts on motions of constrained systems against what is known of them; each is tried where it must be denied."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import analysed, system_of

import mbsym
from mbsym.analysis.pipeline import Analysis
from mbsym.problems.dissipation import EnergyLaw
from mbsym.problems.stability.words import Because, Word

HERE = Path(__file__).parent
SYSTEMS = HERE.parent.parent / "systems"


def place(name: str) -> Path:
    """A description: shipped, or of these tests."""
    return SYSTEMS / name if (SYSTEMS / name).exists() else HERE / name


def changed(name: str, *changes: tuple[str, str]) -> Analysis:
    text = (place(name)).read_text(encoding="utf-8")
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return analysed(text)


#: Weave 4.292382536341..., capsize 6.024262015388... (Meijaard et al. 2007; tests/references/bicycle_whipple.json).
SPEEDS = [
    ("4", Word.UNSTABLE),
    ("4.292382536341", Word.UNSTABLE),
    ("4.292382536342", Word.ASYMPTOTIC_BUT_STEADY),
    ("6.024262015388", Word.ASYMPTOTIC_BUT_STEADY),
    ("6.024262015389", Word.UNSTABLE),
    ("10", Word.UNSTABLE),
]


@pytest.mark.parametrize(("speed", "word"), SPEEDS)
def test_the_bicycle_is_stable_between_weave_and_capsize(speed: str, word: Word) -> None:
    found = changed(
        "bicycle.yaml", ("v: {sign: positive, value: 5,", f"v: {{sign: positive, value: {speed},")
    ).stability
    assert found.numerical is not None
    assert found.numerical.word is word
    theorem = "Lyapunov-Malkin" if word is Word.ASYMPTOTIC_BUT_STEADY else "Lyapunov's first method"
    assert found.numerical.theorem == theorem


def test_the_bicycle_has_its_conditions_in_symbols() -> None:
    """A polynomial of degree 4 in lambda; of the Hurwitz determinant there is the form in its coefficients."""
    roll_and_steer, speed = mbsym.load(SYSTEMS / "bicycle.yaml").stability.subsystems
    assert roll_and_steer.coordinates == ("roll", "steer")
    assert len(roll_and_steer.characteristic) == 5
    assert max(x.terms for x in roll_and_steer.characteristic) < 300
    assert {"a0", "a1", "a3"} <= {label for label, _, _ in roll_and_steer.conditions}
    assert speed.coordinates == ("rear",)


def test_a_sleigh_is_stable_forwards_and_unstable_backwards() -> None:
    """(J + m a^2) omega' = -m a v omega (Neimark & Fufaev, chapter II): v > 0 it is."""
    found = mbsym.load(HERE / "sleigh.yaml").stability
    assert found.verdict.word is Word.DEPENDS
    conditions = [(str(x), relation) for part in found.subsystems for _, x, relation in part.conditions]
    assert conditions == [("v", ">")]
    assert found.numerical is not None
    assert (found.numerical.word, found.numerical.theorem) == (Word.ASYMPTOTIC_BUT_STEADY, "Lyapunov-Malkin")
    backwards = changed("sleigh.yaml", ("value: 3", "value: -3")).stability.numerical
    assert backwards is not None
    assert backwards.word is Word.UNSTABLE


@pytest.mark.parametrize(
    ("speed", "word"), [("3", Word.ASYMPTOTIC_BUT_STEADY), ("-3", Word.UNSTABLE), ("0", Word.STABLE_BUT_CYCLIC)]
)
def test_a_family_is_found_where_the_speed_is_a_number(speed: str, word: Word) -> None:
    """Other speeds are steady, whoever says so; at rest T stays small, and all places are alike: it may drift."""
    found = changed(
        "sleigh.yaml",
        ("x: {rate: v}", f"x: {{rate: {speed}}}"),
        ("  v: {sign: real, value: 3, meaning: speed along the edge}\n", ""),
    )
    verdict = found.stability.verdict
    assert verdict.word is word
    assert not verdict.because(Because.MORE_ZERO_ROOTS)


def test_a_sleigh_on_a_slope_says_nothing_of_a_heading_that_matters() -> None:
    """A force along x: the heading is felt in terms of higher order at least, and there is no family of motions."""
    force = "loads:\n  - force: {body: sleigh, point: [a, 0, 0], components: [F, 0, 0], axes: 0}\nconstraints:"
    found = changed("sleigh.yaml", ("constraints:", force), ("parameters:", "parameters:\n  F: {sign: real, value: 1}"))
    assert not found.equilibrium.satisfied


def test_the_upright_disc_rolls_above_its_critical_spin() -> None:
    """w^2 > g/(3 r) (Neimark & Fufaev, chapter V); a zero root is that of turning discs."""
    found = mbsym.load(HERE / "disc.yaml").stability
    conditions = [(str(x), relation) for part in found.subsystems for _, x, relation in part.conditions]
    assert conditions == [("3*r*w**2 - g", ">")]
    assert found.verdict.word is Word.DEPENDS
    fast = changed(
        "disc.yaml",
        ("w: real", "w: {sign: real, value: 10}"),
        ("m: positive, r: positive, g: positive", "m: 1, r: 1, g: 10"),
    )
    slow = changed(
        "disc.yaml",
        ("w: real", "w: {sign: real, value: 1}"),
        ("m: positive, r: positive, g: positive", "m: 1, r: 1, g: 10"),
    )
    assert fast.stability.numerical is not None
    assert fast.stability.numerical.word is Word.STABLE_BUT_CYCLIC
    shipped = mbsym.load(SYSTEMS / "rolling-disc.yaml").stability.numerical  # 3 r w^2 = 19.5 > g
    assert shipped is not None
    assert shipped.word is Word.STABLE_BUT_CYCLIC
    assert slow.stability.numerical is not None
    assert slow.stability.numerical.word is Word.UNSTABLE


LINKS = """
mbsym: 1
name: Parallelogram
parameters: {{m: positive, l: positive, g: positive, d: positive}}
bodies:
  - {{name: left, attached to: 0, rotation: {{axes: [3], angles: [a]}}, mass: 0}}
  - {{name: coupler, attached to: left, connection point: [0, {end}, 0], rotation: {{axes: [3], angles: [b]}}, mass: m,
     mass centre: [d/2, 0, 0], inertia about: mass centre, inertia: [0, 0, m*d**2/12]}}
  - {{name: right, attached to: 0, connection point: [d, 0, 0], rotation: {{axes: [3], angles: [c]}}, mass: 0}}
loads:
  - uniform gravity: {{vector: [0, -g, 0]}}
constraints:
  - coincide: [{{body: coupler, point: [d, 0, 0]}}, {{body: right, point: [{x}, {end}, 0]}}]
dependent: [b, c]
motion: {{a: 0, b: 0, c: 0}}
"""


def test_theorems_on_energy_hold_where_constraints_are_holonomic() -> None:
    hanging = analysed(LINKS.format(end="-l", x="0")).stability.verdict
    assert (hanging.word, hanging.theorem) == (Word.STABLE, "Lagrange-Dirichlet")
    standing = analysed(LINKS.format(end="l", x="0")).stability.verdict
    assert standing.word is Word.UNSTABLE


TIED = """
mbsym: 1
name: Two pendulums, tied
parameters: {{m: positive, l: positive, g: positive}}
bodies:
  - {{name: first, attached to: 0, rotation: {{axes: [3], angles: [a]}}, mass: m, mass centre: [0, -l, 0]}}
  - {{name: second, attached to: 0, rotation: {{axes: [3], angles: [c]}}, mass: m, mass centre: [0, -l, 0]}}
loads:
  - uniform gravity: {{vector: [0, -g, 0]}}
constraints:
  - {tie}
motion: {{a: 0, c: 0}}
"""


@pytest.mark.parametrize(
    ("tie", "law"),
    [
        ("relation: c = 2*a", EnergyLaw.CONSERVED),
        ("relation: c = a*(2 + sin(t))", EnergyLaw.UNKNOWN),
        ("velocity: c_dot = 2*a_dot", EnergyLaw.CONSERVED),
        ("velocity: c_dot = 2*a_dot + a", EnergyLaw.UNKNOWN),
    ],
)
def test_constraints_that_move_take_power(tie: str, law: EnergyLaw) -> None:
    """With J q' + j = 0 and j != 0 constraint forces do work: nothing is claimed about the energy."""
    assert analysed(TIED.format(tie=tie)).balance.law is law


def test_a_constraint_that_grows_with_time_is_not_judged() -> None:
    """b = exp(t) a^3: of third order at any time, and not small at all times alike."""
    tied = TIED.format(tie="relation: c = 2*a + a**3*exp(t)")
    stage = analysed(tied).stage(6)
    assert stage.failure is not None
    assert "not known to be small at all times alike" in stage.failure.reason


def test_a_speed_that_forces_determine_makes_no_family() -> None:
    """Drive and drag along the blade, F = c v: other speeds are no motions, and no zero root asks for them."""
    drive = (
        "loads:\n"
        "  - force: {body: sleigh, point: [0, 0, 0], components: [F, 0, 0], axes: sleigh}\n"
        "  - rayleigh: c*(x_dot**2 + y_dot**2)/2\n"
        "constraints:"
    )
    found = changed("sleigh.yaml", ("constraints:", drive), ("parameters:", "parameters:\n  F: 6\n  c: 2"))
    assert [str(x) for x in found.equilibrium.conditions] != []
    assert all(part.theory.zero_power == 1 for part in found.stability.subsystems)  # of x and of the heading
    numerical = found.stability.numerical
    assert numerical is not None
    assert numerical.word is Word.ASYMPTOTIC_BUT_STEADY  # the force turns with the heading


@pytest.mark.parametrize(("p", "word"), [("1", Word.STABLE), ("0", Word.UNDECIDED)])
def test_what_was_divided_by_must_not_vanish_at_the_values(p: str, word: Word) -> None:
    """p c = q a gives c = q a/p, but a = 0 and c free where p = 0."""
    text = TIED.format(tie="relation: p*c = q*a").replace(
        "{m: positive, l: positive, g: positive}",
        f"{{m: 1, l: 1, g: 10, p: {{sign: real, value: {p}}}, q: {{sign: real, value: 1}}}}",
    )
    found = analysed(text)
    about = found.linearisation.about
    assert about is not None
    assert [str(x) for x in about.assumed] == ["p"]
    assert found.stability.numerical is not None
    assert found.stability.numerical.word is word


@pytest.mark.parametrize(("rate", "outcome"), [("s", "verified numerically"), ("s**2 - s", "undecided")])
def test_a_motion_that_keeps_its_constraints_only_under_a_condition_fails_no_check(rate: str, outcome: str) -> None:
    """A sphere at the lowest place of its dish whose spin w is inclined by b: the contact slips unless w sin b = 0.

    At the given values w = 1 or 2, b = 1/3 there is no such motion.  w = s = 0 is where the two routes are compared; a
    condition that is linear in no parameter is solved for none, and random parameters are no place for that.
    """
    text = (SYSTEMS / "dish-sphere.yaml").read_text(encoding="utf-8")
    text = text.replace("value: 1, meaning: spin", "value: 2, meaning: spin")
    text = text.replace("alpha: 0, beta: 0, gamma: {rate: s}", f"alpha: 0, beta: 1/3, gamma: {{rate: {rate}}}")
    system = system_of(text, "dish.yaml")
    analysis = Analysis(system)
    outcomes = {one.name: one.outcome for one in analysis.checks}
    assert "FAILED" not in outcomes.values()
    assert outcomes["perturbed motion"] == outcome
    assert analysis.stability.numerical.word is Word.UNDECIDED


TRICYCLE = """
mbsym: 1
name: tricycle with a trailer, its fork free to turn
parameters: {L: {value: 1, sign: positive}, d: {value: 2, sign: positive}, J: {value: 1, sign: positive}, V: SPEED}
bodies:
  - {name: frame, attached to: 0, connection point: [x, y, 0], rotation: {axes: [3], angles: [th]}, mass: 3,
     mass centre: [L/2, 0, 0], inertia about: mass centre, inertia: [J, J, J], coordinates: [x, y, th]}
  - {name: fork, attached to: frame, connection point: [L, 0, 0], rotation: {axes: [3], angles: [de]}, mass: 1,
     inertia about: joint, inertia: [1, 1, 1]}
  - {name: trailer, attached to: frame, rotation: {axes: [3], angles: [ps]}, mass: 2, mass centre: [-d, 0, 0],
     inertia about: mass centre, inertia: [1, 1, 1]}
loads: [{generalised force: {de: FORCE}}]
constraints:
  - velocity: y_dot*cos(th) - x_dot*sin(th) = 0
  - velocity: y_dot*cos(th + de) - x_dot*sin(th + de) + L*th_dot*cos(de) = 0
  - velocity: y_dot*cos(th + ps) - x_dot*sin(th + ps) - d*(th_dot + ps_dot) = 0
motion: {x: {rate: V}, y: 0, th: 0, de: 0, ps: 0}
"""


@pytest.mark.parametrize(
    ("speed", "force", "word"),
    [
        # L th' = v tan(de), th'' + de'' = 0: with w = th' + de' constant, de tends to L w/V and the car to a circle.
        ("{value: 1, sign: positive}", "0", Word.ASYMPTOTIC_BUT_STEADY),
        ("{value: -1, sign: negative}", "0", Word.UNSTABLE),
        ("{value: 1, sign: real}", "0", Word.ASYMPTOTIC_BUT_STEADY),
        ("{value: -1, sign: real}", "0", Word.UNSTABLE),
        (
            "{value: 0, sign: real}",
            "0",
            Word.UNDECIDED,
        ),  # where it stands the fork may turn, and steers what begins to move
        # Circles near by are no motions: th'' + de'' = -de^2 leaves de < 0, -de^3 brings it back.
        ("{value: 1, sign: positive}", "-de**2", Word.UNDECIDED),
        ("{value: 1, sign: positive}", "-de**3", Word.UNDECIDED),
    ],
)
def test_circles_near_a_straight_course_are_found(speed: str, force: str, word: Word) -> None:
    found = analysed(TRICYCLE.replace("SPEED", speed).replace("FORCE", force)).stability
    assert found.numerical is not None
    assert (found.verdict.word, found.numerical.word) == (Word.DEPENDS if "real" in speed else word, word)
    if word is Word.UNDECIDED:
        assert found.numerical.because(Because.MORE_ZERO_ROOTS)


DRIVEN = """
mbsym: 1
name: two wheels, driven and held back
parameters: {m: positive, J: positive, a: positive, c: positive, e: positive, F: positive, k: positive}
bodies:
  - {name: robot, attached to: 0, connection point: [x, y, 0], rotation: {axes: [3], angles: [th]}, mass: m,
     mass centre: [a, 0, 0], inertia about: mass centre, inertia: [J, J, J], coordinates: [x, y, th]}
loads: [{generalised force: {x: F*cos(th) - c*x_dot, y: ACROSS, th: -e*th_dot}}]
constraints: [{velocity: y_dot*cos(th) - x_dot*sin(th) = 0}]
motion: {x: {rate: F/c}, y: 0, th: 0}
"""


@pytest.mark.parametrize(
    ("across", "word"),
    [
        # Thrust and drag turn with the robot: m v' = F - c v + m a w^2, (J + m a^2) w' = -(e + m a v) w.
        ("F*sin(th) - c*y_dot", Word.ASYMPTOTIC_BUT_STEADY),
        # These do not, and act in the second order: m v' = F + k sin(th)^2 - c v, F - c v - k v sin(th)^2 ...
        ("(F + k)*sin(th) - c*y_dot", Word.UNDECIDED),
        ("F*sin(th) - (c + k)*y_dot", Word.UNDECIDED),
    ],
)
def test_a_course_may_be_turned_where_the_forces_turn_with_it(across: str, word: Word) -> None:
    assert analysed(DRIVEN.replace("ACROSS", across)).stability.verdict.word is word


RACER = """
mbsym: 1
name: roller racer
parameters: {a: positive, b: positive, m: positive, J: positive, I: positive, V: positive}
bodies:
  - {name: rear, attached to: 0, connection point: [x, y, 0], rotation: {axes: [3], angles: [th]}, mass: m,
     inertia about: mass centre, inertia: [J, J, J], coordinates: [x, y, th]}
  - {name: front, attached to: rear, connection point: [a, 0, 0], rotation: {axes: [3], angles: [ph]}, mass: 0,
     inertia about: joint, inertia: [I, I, I]}
loads: [{generalised force: {ph: FORCE}}]
constraints:
  - velocity: y_dot*cos(th) - x_dot*sin(th) = 0
  - velocity: y_dot*cos(th + ph) - x_dot*sin(th + ph) + (a*cos(ph) + b)*th_dot + b*ph_dot = 0
motion: {x: {rate: V}, y: 0, th: 0, ph: 0}
"""


@pytest.mark.parametrize(
    ("force", "words"),
    [
        # On every circle the hinge rests and nothing but the rear axle is accelerated: a family of two dimensions.
        # About a straight course the roots are 0 (twice) and  -a V (a I - b J)/((a + b)^2 J + a^2 I) up to the sign.
        ("0", [Word.ASYMPTOTIC_BUT_STEADY, Word.UNSTABLE]),
        # A hinge that a force of the second order moves rests on no circle but at ph = 0.
        ("ph**2", [Word.UNDECIDED, Word.UNSTABLE]),
    ],
)
def test_circles_of_a_roller_racer_are_steady(force: str, words: list[Word]) -> None:
    found = analysed(RACER.replace("FORCE", force)).stability
    (hinge,) = [part for part in found.subsystems if "ph" in part.coordinates]
    assert [case.verdict.word for case in hinge.theory.cases] == words
    assert {str(x) for _, x, _ in hinge.conditions} <= {"a*I - b*J", "b*J - a*I"}


HOOP = """
mbsym: 1
name: bead on a hoop that turns
parameters: {m: positive, R: positive, g: positive, w: positive, b: nonnegative}
prescribed: {phi: {rate: w}}
bodies:
  - {name: hoop, attached to: 0, rotation: {axes: [3], angles: [phi]}, mass: 0}
  - {name: bead, attached to: hoop, BEAD, mass: m}
loads:
  - uniform gravity: {vector: [0, 0, -g]}
  - generalised force: {FORCE}
"""
BY_ANGLE = ("connection point: [R*sin(th), 0, -R*cos(th)], coordinates: [th]", "motion: {th: 0}\n")
BY_RELATION = (
    "connection point: [x, 0, z], coordinates: [x, z]",
    "constraints: [{relation: x**2 + z**2 = R**2}]\ndependent: [z]\nmotion: {x: 0, z: -R}\n",
)


@pytest.mark.parametrize(
    ("of_angle", "of_place", "values", "word"),
    [
        # V = m R^2 (w^2 cos(th)^2/2 - g/R cos(th)): at g = R w^2 it begins with + m g R th^4/8.
        ("th: -b*R**2*th_dot", "x: -b*x_dot, z: -b*z_dot", "g: 4, w: 2, b: 5", Word.ASYMPTOTIC),
        ("th: -b*R**2*th_dot", "x: -b*x_dot, z: -b*z_dot", "g: 4, w: 2, b: 0", Word.STABLE),
        ("th: -b*R**2*th_dot", "x: -b*x_dot, z: -b*z_dot", "g: 4, w: 3, b: 5", Word.UNSTABLE),
        # A force that knows how far the hoop has turned is none of a turning frame.
        ("th: sin(phi)*th**5", "x: sin(phi)*x**5", "g: 4, w: 2, b: 0", Word.UNDECIDED),
    ],
)
def test_rest_in_a_turning_frame_is_judged_alike_by_a_relation(
    of_angle: str, of_place: str, values: str, word: Word
) -> None:
    for (bead, rest), force in ((BY_ANGLE, of_angle), (BY_RELATION, of_place)):
        text = HOOP.replace("BEAD", bead).replace("FORCE", force) + rest + f"values: {{m: 1, R: 1, {values}}}\n"
        numerical = analysed(text).stability.numerical
        assert numerical is not None
        assert numerical.word is word
