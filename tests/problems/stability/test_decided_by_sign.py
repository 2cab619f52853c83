"""What terms of higher order decide by the sign of a parameter: verdicts, conditions and claims, by hand.

x'' + d x'^3 + b x^3 = 0: E = x'^2/2 + b x^4/4 falls, E' = -d x'^4.  b > 0: the minimum is strict, and only rest keeps E
(Barbashin and Krasovskii).  b < 0: no minimum.  b = 0: x' decays like t^(-1/2), so x is not bounded.
"""

import pytest

import mbsym
from mbsym.report.conditions import told_cases

ONE = """
mbsym: 1
name: One coordinate
parameters: {{{parameters}}}
bodies: [{{name: p, mass: 1, connection point: [x, 0, 0], coordinates: [x]}}]
loads: [{{potential: "{potential}"}}, {{generalized force: {{x: "{force}"}}}}]
motion: {{x: 0}}
{further}
"""
ASYMPTOTIC, UNSTABLE = "asymptotically stable", "unstable"


def described(parameters, potential, force="0", further=""):
    return mbsym.loads(ONE.format(parameters=parameters, potential=potential, force=force, further=further))


def claimed(*conditions):
    lines = (f"  - {{claim: condition, that: '{that}', as: {role}}}" for that, role in conditions)
    return "\n".join(("claims:", *lines))


@pytest.mark.parametrize(
    ("parameters", "potential", "force", "cases"),
    [
        ("d: positive, b: real", "b*x**4/4", "-d*x_dot**3", {"b > 0": ASYMPTOTIC, "-b > 0": UNSTABLE}),
        ("d: positive, b: real", "b*x**4/4", "-d*x_dot", {"b > 0": ASYMPTOTIC, "-b > 0": UNSTABLE}),
        ("a: real, b: real", "(a - 2*b)*x**6", "0", {"a - 2*b > 0": "stable", "2*b - a > 0": UNSTABLE}),
        ("c: real", "x**2/2", "-c*x_dot**3", {"c > 0": ASYMPTOTIC, "-c > 0": UNSTABLE, "c = 0": "stable"}),
        ("c: real", "x**2", "-c*abs(x_dot)*x_dot", {"c > 0": ASYMPTOTIC, "-c > 0": UNSTABLE, "c = 0": "stable"}),
        ("c: nonpositive", "x**2/2", "-c*x_dot**3", {"-c > 0": UNSTABLE, "c = 0": "stable"}),
    ],
)
def test_conditions_head_the_verdict(parameters, potential, force, cases):
    stability = described(parameters, potential, force).stability
    assert stability.verdict.word == "depends on the parameters"
    (part,) = stability.subsystems
    told = {f"{case.all_of[0].formula} {case.all_of[0].relation} 0": case.word for case in told_cases(part)}
    assert {key: told.get(key) for key in cases} == cases


@pytest.mark.parametrize(
    ("force", "outcome"),
    [
        ("-x_dot**3", "does not hold"),  # at b = 0 x grows like the square root of t
        ("-x_dot", "holds exactly"),  # there x tends to a place near by
        ("-x_dot - x_dot**3", "holds exactly"),
        ("0", "does not hold"),
    ],
)
def test_what_is_cyclic_on_the_border_only(force, outcome):
    (found,) = described("b: real", "b*x**4/4", force, claimed(("b >= 0", "sufficient"))).claims
    assert found.outcome == outcome


def test_a_potential_that_vanishes_whole_on_the_border():
    """k = 0: x'' = 0."""
    claims = claimed(("k >= 0", "sufficient"), ("k > 0", "sufficient"), ("k > 0", "necessary"))
    found = described("k: real", "k*x**2/2 + k*x**4", "0", claims).claims
    assert [x.outcome for x in found] == ["does not hold", "holds exactly", "holds exactly"]


def test_claims_with_equality():
    """c = 0 is the linear oscillator: stable, too."""
    claims = claimed(
        ("c >= 0", "sufficient"),
        ("c >= 0", "necessary"),
        ("c > 0", "sufficient"),
        ("c > 0", "necessary"),
        ("c <= 0", "necessary"),
        ("c <= 0", "sufficient"),
    )
    found = described("c: real", "x**2/2", "-c*x_dot**3", claims).claims
    assert [x.outcome for x in found] == [*["holds exactly"] * 3, *["does not hold"] * 3]


@pytest.mark.parametrize(
    ("force", "word"),
    [
        ("-abs(x_dot)*x_dot", ASYMPTOTIC),
        ("-abs(3*x_dot)*x**2*x_dot", ASYMPTOTIC),
        ("abs(x_dot)*x_dot", UNSTABLE),
        ("-abs(x)*x_dot", "stable"),  # not looked into: |x| is no modulus of the velocity
    ],
)
def test_drag_of_the_square_of_the_velocity(force, word):
    assert described("c: real", "x**2/2", force).stability.verdict.word == word


PARABOLA = """
mbsym: 1
name: A bead on a parabola that turns
parameters: {g: positive, w: real, a: positive}
prescribed: {phi: {rate: w}}
bodies:
  - {name: wire, rotation: {axes: [3], angles: [phi]}, mass: 0}
  - {name: bead, attached to: wire, connection point: [x, 0, a*x**2/2], coordinates: [x], mass: 1}
loads: [{uniform gravity: {vector: [0, 0, -g]}}]
motion: {x: 0}
claims:
  - {claim: condition, that: w**2 <= a*g, as: sufficient}
  - {claim: condition, that: w**2 <= a*g, as: necessary}
  - {claim: condition, that: w**2 < a*g, as: sufficient}
"""


def test_a_bead_that_nothing_holds_leaves():
    """w^2 = a g: (1 + a^2 x^2) x'^2 is constant, whatever x is."""
    outcomes = [x.outcome for x in mbsym.loads(PARABOLA).claims]
    assert outcomes == ["does not hold", "holds exactly", "holds exactly"]


ORBIT = """
mbsym: 1
name: A circular orbit
parameters: {{m: positive, mu: positive, r0: positive, k: positive}}
bodies: [{{name: p, mass: m, connection point: [r*cos(th), r*sin(th), {z}], coordinates: [r, th{more}]}}]
loads: [{{potential: "-mu*m/(2*r**2){held}"}}]
motion: {{r: r0, th: {{rate: sqrt(mu)/r0**2}}{at}}}
values: {{m: 1, mu: 2, r0: 1, k: 1}}
"""
DRIFTS = "stable but for a drift of cyclic coordinates"


@pytest.mark.parametrize(
    ("held", "z", "word", "there"),
    [
        ("", False, UNSTABLE, UNSTABLE),  # r'' = 0 at the same momentum
        ("", True, UNSTABLE, UNSTABLE),
        (" + k*m*(r - r0)**2", False, DRIFTS, DRIFTS),
        (" + k*m*(r - r0)**4", False, "undecided", DRIFTS),
    ],
)
def test_attraction_by_the_cube_of_the_distance(held, z, word, there):
    text = ORBIT.format(held=held, z="z" if z else "0", more=", z" if z else "", at=", z: 0" if z else "")
    stability = mbsym.loads(text).stability
    assert (stability.verdict.word, stability.numerical.word) == (word, there)


def test_a_root_in_the_first_term():
    cases = described("a: positive, b: positive", "(sqrt(a) - b)*x**4").stability.subsystems[0].theory.cases
    assert [case.verdict.word for case in cases[:2]] == ["stable", UNSTABLE]


def test_what_holds_with_equality_is_told_once():
    """-E' = x'^2 (c x^2 + e x'^2): averaged a' = -(c + 3 e) a^3/8, so that c < 0 depends on both."""
    stability = described("c: real, e: positive", "x**2/2", "-c*x**2*x_dot - e*x_dot**3").stability
    (only, left) = told_cases(stability.subsystems[0])
    assert (only.all_of[0].relation, only.word, left.word) == (">=", ASYMPTOTIC, "undecided")


def test_gyroscopic_forces_do_not_hold_a_coordinate_that_nothing_else_does():
    """k = 0: y' + b x = C, and y' is C/(1 + b^2) in the mean of small motions."""
    text = """
mbsym: 1
name: Two coordinates
parameters: {k: real, b: positive}
bodies: [{name: p, mass: 1, connection point: [x, y, 0], coordinates: [x, y]}]
loads:
  - potential: k*y**2/2 + k*y**4 + x**2/2 + x**4
  - generalized force: {x: b*y_dot, y: -b*x_dot}
motion: {x: 0, y: 0}
"""
    (found,) = mbsym.loads(text + claimed(("k >= 0", "sufficient"))).claims
    assert found.outcome == "does not hold"
