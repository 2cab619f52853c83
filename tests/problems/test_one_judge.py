"""The verdict at given values, claims tried there, problem 11 and the list of equilibria say one thing of a motion."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction

import pytest
from conftest import SHIPPED

import mbsym
from mbsym.analysis import Analysis
from mbsym.analysis.judge import Judge
from mbsym.analysis.resting import relative_equilibria
from mbsym.expressions.tree import substitute
from mbsym.maps.axis import Axis
from mbsym.maps.branches import branches
from mbsym.mechanics.rest import given_values
from mbsym.problems.stability.words import Because, Word

PLANE = """mbsym: 1
name: a particle in a plane
parameters: {{a: {{sign: real, value: {a}}}, g: {{sign: real, value: {g}}}}}
bodies:
  - {{name: p, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}}
loads:
  - potential: {potential}
  - generalized force: {{x: g*y_dot, y: -g*x_dot}}
motion: {{x: 0, y: 0}}
claims:
  - {{claim: condition, that: a >= {least}, as: sufficient}}
"""

CYCLIC = """mbsym: 1
name: the same in a plane that slides along a rail
parameters: {{g: {{sign: real, value: {g}}}}}
bodies:
  - {{name: cart, connection point: [0, 0, z], mass: 1, coordinates: [z]}}
  - {{name: p, attached to: cart, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}}
loads:
  - potential: {potential}
  - generalized force: {{x: g*y_dot, y: -g*x_dot}}
motion: {{x: 0, y: 0, z: 0}}
"""


def described(potential: str, a: str = "0", g: str = "0", least: str = "0") -> Analysis:
    return Analysis(mbsym.loads(PLANE.format(potential=potential, a=a, g=g, least=least)).system, (6, 11))


#: V along its valley, by hand: y = -x^2 gives V = -x^4/2; y = -x^2/2 in the second, V = x^4 (1 - 1/4); with
#: x'' = -y, y'' = ... in the third no valley is needed, V has the cubic term x^3 along its only kernel.
BY_HAND = [
    ("a*x**2/2 + y**2/2 + x**2*y", Word.UNSTABLE),
    ("a*x**2/2 + y**2 + x**2*y + x**4", Word.STABLE),
    ("a*x**2/2 + y**2/2 + x**3", Word.UNSTABLE),
]


@pytest.mark.parametrize(("potential", "word"), BY_HAND)
def test_a_zero_root_is_decided_by_terms_of_higher_order(potential: str, word: Word) -> None:
    """a = 0: the first approximation x'' = 0 leaves it open; energies, claims and the list have to agree with it."""
    analysis = described(potential)
    assert analysis.stability.numerical is not None
    assert analysis.stability.numerical.word is word
    (claim,) = analysis.claims
    assert (claim.outcome == "does not hold") == (word is Word.UNSTABLE)  # a >= 0 is claimed to be sufficient


def test_gyroscopic_stabilisation_is_decided_as_the_theorem_of_arnold_and_moser_does() -> None:
    """V = -x^2/2 - y^2/3 + ..., turned at the rate 3: the word of problem 6 was `gyroscopically stabilised only`."""
    analysis = described("-x**2/2 - y**2/3 + a*x**4 + x*y**2 - y**3", a="1", g="3")
    found = analysis.stability
    assert found.numerical is not None
    assert found.before_higher_order is not None
    assert (found.numerical.word, found.numerical.theorems) == (Word.STABLE, ("Arnold-Moser",))
    assert found.before_higher_order.word is Word.GYROSCOPIC
    assert analysis.normal_forms.first is Word.GYROSCOPIC
    listed = relative_equilibria(analysis.system, given_values(analysis.system, {}))
    (there,) = (one for one in listed.equilibria if all(x.value == 0 for x in one.values))
    assert there.verdict.word is Word.STABLE


def test_momenta_that_problem_11_keeps_are_not_forgotten() -> None:
    """With a cyclic coordinate nothing better than `but for a drift` holds.

    A resonance of fourth order, w1 = 3 w2, is one of these momenta alone: its theorem says nothing of others, so that
    the word stays open.  w^2 are the roots of s^2 - (g^2 - 5/6) s + 1/6; w1 w2 = 1/sqrt(6), so that at w1 = 3 w2
    w1^2 + w2^2 = 10/3 sqrt(1/6), which no rational g has: V = -x^2/2 - 9 y^2/2 has w1 w2 = 3 and w1 = 3, w2 = 1 at
    g^2 = 10 + 10 = 20, again none; V = -x^2/2 - y^2/2 + ... has w1 w2 = 1, w1^2 + w2^2 = 10/3 = g^2 - 2: g = 4/sqrt(3).
    V = -(3 x^2 + 3 y^2)/2: w1 w2 = 3 and 10 = g^2 - 6, g = 4.
    """
    system = mbsym.loads(CYCLIC.format(potential="-x**2/2 - y**2/3 + x**4 + x*y**2 - y**3", g="3")).system
    found = Analysis(system, (6,)).stability.numerical
    assert found is not None
    assert (found.word, found.theorems) == (Word.STABLE_BUT_CYCLIC, ("Arnold-Moser",))
    resonant = "-3*x**2/2 - 3*y**2/2 + x**4 + 2*y**4"
    free = described(resonant.replace("x**4", "x**4 + 0*a"), g="4").stability.numerical
    assert free is not None
    assert not free.word.open
    alone = CYCLIC.format(potential=resonant, g="4")
    for text, decided in ((alone, True), (alone.replace("[x, y, 0]", "[x, y, x**2/10]"), False)):  # z knows x, or not
        held = Analysis(mbsym.loads(text).system, (6, 11))
        assert (held.normal_forms.at_values.outcome.value, held.normal_forms.cyclic) == ("stable", ("z",))
        assert held.stability.numerical.word is (Word.STABLE_BUT_CYCLIC if decided else Word.GYROSCOPIC)


@pytest.mark.parametrize("seed", range(12))
def test_every_surface_asks_the_same_judge(seed: int) -> None:
    """Random potentials with gyroscopic forces: problem 6 at the values, the judge, problem 11 and the list agree."""
    source = random.Random(seed)
    a, g = source.choice([-2, -1, 0, 1]), source.choice([0, 1, 2, 3, 5])
    b = source.choice(["-1/3", "0", "1/2"])
    terms = [f"{source.randint(-2, 2)}*{x}" for x in ("x**3", "x**2*y", "y**3", "x**4", "x**2*y**2", "y**4")]
    analysis = described(f"a*x**2/2 + ({b})*y**2/2 + {' + '.join(terms)}".replace("+ -", "- "), str(a), str(g))
    found = analysis.stability.numerical
    assert found is not None
    values = {"a": Fraction(a), "g": Fraction(g)}
    judge = Judge(analysis)
    assert judge(values).word is found.word
    higher = analysis.normal_forms.at_values
    assert higher is not None
    said = higher.outcome.value
    if said in ("stable", "unstable", "asymptotically stable"):
        assert found.word.value.startswith(said) or found.word.stable == (said != "unstable")
        assert not found.word.open
    listed = relative_equilibria(analysis.system, given_values(analysis.system, {}))
    there = [one for one in listed.equilibria if all(x.exact and x.value == 0 for x in one.values)]
    assert all(one.verdict.word is found.word for one in there)


CURVE = """mbsym: 1
name: a bead on a curve
parameters: {{b: {{sign: real, value: {b}}}}}
bodies:
  - {{name: p, connection point: [x, {height}, 0], mass: 1, coordinates: [{coordinates}]}}
constraints: {constraints}
loads:
  - uniform gravity: {{acceleration: 9.81, direction: [0, -1, 0]}}
motion: {{x: 1}}
"""


@pytest.mark.parametrize("related", [False, True])
@pytest.mark.parametrize(
    ("shape", "everywhere", "there"),
    [
        ("exp(x)", Word.STABLE, Word.STABLE),
        ("(2 + sin(x))", Word.STABLE, Word.STABLE),
        ("exp(-b*x)", Word.STABLE, Word.STABLE),
        ("(1 - exp(x))", Word.UNSTABLE, Word.UNSTABLE),
        ("cos(b*x)", Word.UNDECIDED, Word.UNSTABLE),  # cos 2 < 0
    ],
)
def test_the_first_term_decides_though_it_is_no_algebraic_number(
    shape: str, everywhere: Word, there: Word, related: bool
) -> None:
    """y = (x - 1)^4 f(x) has its bottom at x = 1 where f(1) > 0, and falls on both sides where f(1) < 0."""
    height = f"(x - 1)**4*{shape}"
    text = CURVE.format(
        b=2,
        height="y" if related else height,
        coordinates="x, y" if related else "x",
        constraints=f"[{{relation: 'y = {height}'}}]" if related else "[]",
    )
    found = Analysis(mbsym.loads(text).system, (6,)).stability
    assert found.numerical is not None
    assert (found.verdict.word, found.numerical.word) == (everywhere, there)


@pytest.mark.parametrize(("b", "word"), [("1", Word.STABLE), ("1/10", Word.UNSTABLE)])
def test_what_vanishes_at_the_values_only_is_no_first_term(b: str, word: Word) -> None:
    """V = (x - 1)^4 at b = 1; at b = 1/10 it is (x - 1)^3 e^x."""
    shape = "((b - 1)*(x - 1)**2*exp(x) + (x - 1)**4)" if b == "1" else "((10*b - 1)*(x - 1)**2 + (x - 1)**3*exp(x))"
    text = CURVE.format(b=b, height=shape, coordinates="x", constraints="[]")
    found = Analysis(mbsym.loads(text).system, (6,)).stability
    assert found.numerical is not None
    assert found.numerical.word is word


@pytest.mark.parametrize("order", [4, 6, 10])
def test_friction_in_a_flat_well_is_one_word_for_all_values_and_at_those_given(order: int) -> None:
    """x'' + d x' + k x^(order - 1) = 0: x' = -k x^(order - 1)/d + ... on the centre manifold."""
    found = mbsym.loads(f"""mbsym: 1
name: a flat well
parameters: {{d: positive, k: positive}}
bodies: [{{name: p, connection point: [x, 0, 0], mass: 1, coordinates: [x]}}]
loads: [{{potential: k*x**{order}}}, {{rayleigh: d*x_dot**2/2}}]
motion: {{x: 0}}
values: {{d: 1, k: 2}}
""").stability
    assert found.verdict.word is Word.ASYMPTOTIC
    assert found.numerical is None or found.numerical.word is Word.ASYMPTOTIC


BESIDE = """mbsym: 1
name: a spring of an irrational stiffness beside another coordinate
parameters: {{k: {{sign: positive, value: {k}}}}}
bodies:
  - {{name: p, connection point: [{place}, y, 0], mass: 1, coordinates: [x, y]}}
loads:
  - potential: {potential}
  - rayleigh: x_dot**2/2
motion: {{x: 0, y: 0}}
"""


@pytest.mark.parametrize("k", ["sqrt(2)", "exp(1)"])
@pytest.mark.parametrize(("potential", "word"), [("y**3/3", Word.UNSTABLE), ("y**4/4", Word.STABLE)])
def test_parts_are_judged_at_irrational_values_too(k: str, potential: str, word: Word) -> None:
    """y'' = -y^2 leaves, y'' = -y^3 stays, whatever the damped spring of stiffness k beside it does."""
    text = BESIDE.format(k=k, place="x", potential=f"k*x**2/2 + {potential}")
    assert mbsym.loads(text).stability.numerical.word is word


@pytest.mark.parametrize("k", ["sqrt(2)", "exp(1)"])
def test_other_coordinates_are_judged_at_irrational_values_too(k: str) -> None:
    """x + y is a displacement that changes nothing but V = (x - y)^4: nothing breaks down where k is not rational."""
    text = BESIDE.format(k=k, place="x", potential="k*(x - y)**4").replace("x_dot**2", "(x_dot - y_dot)**2")
    verdict = mbsym.loads(text).stability.numerical
    assert verdict.word.open or verdict.word is Word.STABLE_BUT_CYCLIC


def test_irrational_places_of_parts_break_no_list_down() -> None:
    """x = log 2 beside y = 0: friction (x - 1) x'^3 against the motion (x < 1 makes it push) is of third order."""
    text = BESIDE.format(k="1", place="x", potential="y**2/2 + exp(x) - 2*x")
    text = text.replace("rayleigh: x_dot**2/2", "generalized force: {x: '(x - 1)*x_dot**3', y: 0}")
    (rest,) = mbsym.loads(text.replace("{x: 0, y: 0}", "{}")).equilibria.equilibria
    assert rest.verdict.word not in (Word.UNSTABLE, Word.ASYMPTOTIC)  # y swings on


def test_what_comes_to_another_rest_is_not_what_drifts() -> None:
    """x'' = 0 beside a trough of rests along z, which is not cyclic: a displaced z stays displaced at any momentum."""
    text = (
        "mbsym: 1\nname: beside a trough\nbodies:\n"
        "  - {name: p, connection point: [x, y, z], mass: 1, coordinates: [x, y, z]}\n"
        "loads:\n  - potential: y**2/2 + y**2*z\n  - rayleigh: (y_dot**2 + z_dot**2)/2\nmotion: {x: 0, y: 0, z: 0}\n"
    )
    assert mbsym.loads(text).stability.numerical.word is Word.STABLE_BUT_CYCLIC


@pytest.mark.parametrize("name", ["chaplygin-sleigh", "dish-sphere", "rolling-disc", "rolling-disc-in-a-circle"])
def test_a_rate_is_the_same_as_a_number_and_as_a_parameter(name: str) -> None:
    """Steady motions at other rates are a family, whoever writes the rate: zero roots of a family are explained."""
    system = mbsym.load(SHIPPED / f"{name}.yaml").system
    values = {x.name: x.value for x in system.parameters if x.value is not None}
    motion = tuple(replace(x, rate=substitute(x.rate, values)) for x in system.motion)
    assert motion != system.motion
    word = Analysis(replace(system, motion=motion)).stability.numerical.word
    assert word is Analysis(system).stability.numerical.word


FLAT = """mbsym: 1
name: a particle in a plane, wherever it rests
bodies:
  - {{name: p, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}}
loads: [{loads}]
motion: {{x: {x}, y: {y}}}
"""
FIELD = "generalized force: {x: (B)*y_dot, y: -(B)*x_dot}"
DRIFTS = Word.STABLE_BUT_CYCLIC

#: V = x^2 y^2: y = y0 + e t, x = 0 is a motion, and y is no symmetry.  (x^2 + y^2 - 1)^2: it coasts around the circle,
#: the angle is cyclic; sums of squares of x alone: y is cyclic.
FAMILIES = [
    ("potential: x**2*y**2", 2, {Word.UNSTABLE}),
    ("potential: (x**2 + y**2 - 1)**2 + x**2*y**2", 0, set()),
    ("potential: x**2*(1 + y**2)", 1, {Word.UNSTABLE}),
]


def test_a_member_of_a_family_under_constraints_is_judged_by_its_symmetry() -> None:
    """On a cylinder with a spring along it all is alike around the axis, which no coordinate is an angle about."""
    text = FLAT.replace("[x, y, 0]", "[x, y, z]").replace("[x, y]}}", "[x, y, z]}}")
    text = text.replace("motion:", "constraints: [relation: x**2 + y**2 = 1]\nmotion:").replace(
        "y: {y}", "y: {y}, z: 0"
    )
    system = mbsym.loads(text.format(loads="potential: z**2/2", x="-4/5", y="3/5")).system
    (family,) = relative_equilibria(system, {}).families
    found = Analysis(system, (6,)).stability.numerical
    assert found is not None
    assert found.word is family.verdict.word is DRIFTS


@pytest.mark.parametrize(("load", "count", "words"), FAMILIES)
def test_members_of_families_are_judged_as_the_description_would_be_there(
    load: str, count: int, words: set[Word]
) -> None:
    listed = relative_equilibria(mbsym.loads(FLAT.format(loads=load, x=0, y=0)).system, {})
    assert len(listed.families) == count
    assert {family.verdict.word for family in listed.families} == words
    for family in listed.families:
        x, y = ({value.name: value.text for value in family.sample}[name] for name in "xy")
        there = Analysis(mbsym.loads(FLAT.format(loads=load, x=x, y=y)).system, (6,)).stability.numerical
        assert there is not None
        assert there.word is family.verdict.word


@pytest.mark.parametrize(
    ("load", "x", "word"),
    [
        # x' -> 0 like t^(-1/2), and x -> infinity
        ("generalized force: {x: -x_dot**3}", "0", DRIFTS),
        # T and y' + A(x), A' = B, are constant: x keeps near wherever it rests, A is nowhere constant; y drifts
        (FIELD.replace("B", "1 + x"), "0", DRIFTS),
        (FIELD.replace("B", "1 + x"), "-1", DRIFTS),
        (FIELD.replace("B", "x**3"), "0", DRIFTS),
        # Nothing holds it where the field is that of no potential energy and knows both coordinates, or is none
        (FIELD.replace("B", "1 + x*y"), "0", Word.CRITICAL),
        (FIELD.replace("B", "x*y"), "0", Word.UNDECIDED),
    ],
)
def test_any_position_is_one_of_rest(load: str, x: str, word: Word) -> None:
    """What is said of all positions holds at each: at a zero of the field linear equations grow."""
    system = mbsym.loads(FLAT.format(loads=load, x=x, y=0)).system
    found = Analysis(system, (6,)).stability.numerical
    assert found is not None
    assert found.word is word
    (listed,) = relative_equilibria(system, {}).equilibria
    assert {"x", "y"} == {*listed.free}
    if word is DRIFTS:
        assert listed.verdict.word is word
    else:
        assert listed.verdict.word in (word, Word.UNDECIDED)
        assert listed.verdict.because(Because.ALSO_ELSEWHERE) or listed.verdict.because(Because.DIFFERS_ALONG)


def test_branches_are_judged_with_terms_of_higher_order() -> None:
    """x'' + a x + x'^3 = 0: E' = -x'^4, only x' = 0 keeps E."""
    cubic = mbsym.loads(
        "mbsym: 1\nname: c\nparameters: {a: positive}\n"
        "bodies: [{name: p, connection point: [x, 0, 0], mass: 1, coordinates: [x]}]\n"
        "loads: [{spring: {coordinate: x, stiffness: a}}, {rayleigh: x_dot**4/4}]\nmotion: {x: 0}\n"
    ).system
    found = branches(cubic, Axis("a", Fraction(1, 2), Fraction(2)), {})
    (interval,) = found.intervals
    assert [one.verdict.word for one in found.equilibria(interval)] == [Word.ASYMPTOTIC]
    assert [piece.throughout for piece in found.pieces] == [False]  # it is judged at the sample


HINGE = """mbsym: 1
name: a pendulum on a hinge that is tilted
parameters: {al: real}
bodies:
  - {name: frame, rotation: {axes: [1], angles: [al]}, mass: 0}
  - {name: p, attached to: frame, rotation: {axes: [3], angles: [q]}, mass centre: [0, -1, 0], mass: 1}
loads: [{uniform gravity: {vector: [0, -1, 0]}}POTENTIAL]
motion: {q: 0}
values: {al: VALUE}
"""


@pytest.mark.parametrize(
    ("value", "potential", "word"),
    [
        ("pi/2", "", DRIFTS),  # q'' + cos(al) sin(q) = 0, cos(pi/2) = 0: no force at all
        ("pi/2", ", {potential: q**4}", Word.STABLE),
        ("pi/2", ", {potential: -q**4}", Word.UNSTABLE),
        ("pi/3", ", {potential: -q**4}", Word.STABLE),
        ("2*pi/3", ", {potential: q**4}", Word.UNSTABLE),
    ],
)
def test_what_vanishes_at_irrational_values_is_put_in(value: str, potential: str, word: Word) -> None:
    system = mbsym.loads(HINGE.replace("VALUE", value).replace("POTENTIAL", potential)).system
    found = Analysis(system, (6,)).stability.numerical
    assert found is not None
    assert found.word is word
    listed = relative_equilibria(system, given_values(system, {}))
    assert next(x for x in listed.equilibria if x.values[:1] == () or x.values[0].value == 0).verdict.word is word


COASTS = """
mbsym: 1
name: coasts
parameters: {k: real, c: real}
bodies:
  - {name: p, mass: 1, connection point: [x, y, 0], coordinates: [x, y]}
loads:
  - potential: k*y**2/2 + x**2/2 + x**4
  - generalized force: {y: -c*y_dot**3}
motion: {x: 0, y: 0}
"""


@pytest.mark.parametrize(
    ("c", "word"), [("1", Word.STABLE_BUT_CYCLIC), ("0", Word.STABLE_BUT_CYCLIC), ("-1", Word.UNSTABLE)]
)
def test_what_is_cyclic_at_the_values_only_is_judged_as_what_is_so_always(c: str, word: Word) -> None:
    """At k = 0: y'' = -c y'^3 slows down, coasts, or runs away, beside x'' + x + 4 x^3 = 0."""
    always = COASTS.replace("k*y**2/2 + ", "").replace("k: real, ", "")
    found = [
        mbsym.loads(f"{text}values: {{{values}c: {c}}}\n").stability.numerical
        for text, values in ((COASTS, "k: 0, "), (always, ""))
    ]
    assert [None if verdict is None else verdict.word for verdict in found] == [word, word]
