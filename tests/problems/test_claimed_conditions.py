"""Claimed conditions against regions of stability that are known by hand: a claim that holds is true everywhere.

Three families whose stability is elementary, with random polynomials of the parameters in them:

* M = 1, potential energy (p x^2 + 2 q x y + r y^2)/2:  stable where p > 0 and p r - q^2 > 0, unstable where p, r or
  p r - q^2 is negative, and growing like t where K >= 0 is singular;
* x'' + d x' + k x = 0:  asymptotically stable where d > 0 and k > 0, unstable where one of them is negative, stable
  without damping where k > 0 and without a spring where d > 0, growing like t where both are 0;
* a particle on a turntable, x'' - 2 w y' + (p - w^2) x = 0, y'' + 2 w x' + (r - w^2) y = 0: with K1 = p - w^2,
  K2 = r - w^2 and B = K1 + K2 + 4 w^2 the roots of mu^2 + B mu + K1 K2 are negative and simple where B, K1 K2 and
  B^2 - 4 K1 K2 are positive; a minimum where K1 and K2 are.  Double roots have one eigenvector, but for K1 = K2 = 0.

All three are exactly linear, so that this is stability itself.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from pathlib import Path

import pytest
from conftest import STATEMENTS

import mbsym
from mbsym.problems.claims import ClaimResult, Outcome
from mbsym.report.words.claims import claim_line

STABLE, UNSTABLE, GROWS = "stable", "unstable", "growing like t"
NEUTRAL = "stable, not asymptotically"
RELATIONS: dict[str, Callable[[Fraction], bool]] = {
    ">": lambda x: x > 0,
    "<": lambda x: x < 0,
    ">=": lambda x: x >= 0,
    "<=": lambda x: x <= 0,
    "!=": lambda x: x != 0,
}


@dataclass(frozen=True)
class Family:
    """``loads`` with the texts of three polynomials in {0}, {1}, {2}; ``truth`` of their values and those of w."""

    text: str
    conditions: tuple[str, ...]
    truth: Callable[[Fraction, Fraction, Fraction, Fraction], str]


def potential(p: Fraction, q: Fraction, r: Fraction, _: Fraction) -> str:
    minor = p * r - q * q
    return STABLE if p > 0 and minor > 0 else UNSTABLE if p < 0 or r < 0 or minor < 0 else GROWS


def damped(d: Fraction, k: Fraction, _: Fraction, __: Fraction) -> str:
    if min(d, k) == 0 < max(d, k):
        return NEUTRAL
    return STABLE if d > 0 and k > 0 else UNSTABLE if d < 0 or k < 0 else GROWS


def turntable(p: Fraction, _: Fraction, r: Fraction, w: Fraction) -> str:
    first, second = p - w * w, r - w * w
    middle, last = first + second + 4 * w * w, first * second
    if first > 0 and second > 0:
        return STABLE
    gaps = (middle, last, middle * middle - 4 * last)
    if first == second == 0:
        return NEUTRAL
    return NEUTRAL if min(gaps) > 0 else UNSTABLE if min(gaps) < 0 else GROWS


HEAD = "mbsym: 1\nname: family\nparameters: {{a: {3}, b: {3}, w: positive}}\n"
PARTICLE = "bodies:\n  - {{name: u, connection point: [x, y, 0], coordinates: [x, y], mass: 1}}\n"
FAMILIES = {
    "potential": Family(
        HEAD + PARTICLE + "loads:\n  - potential: ({0})*x**2/2 + ({1})*x*y + ({2})*y**2/2\nmotion: {{x: 0, y: 0}}\n",
        ("({0})", "({2})", "(({0})*({2}) - ({1})**2)"),
        potential,
    ),
    "damped": Family(
        HEAD
        + "bodies:\n  - {{name: u, connection point: [x, 0, 0], coordinates: [x], mass: 1}}\n"
        + "loads:\n  - generalized force: {{x: -({0})*x_dot - ({1})*x}}\nmotion: {{x: 0}}\n",
        ("({0})", "({1})", "({0})*({1})"),
        damped,
    ),
    "turntable": Family(
        HEAD
        + "prescribed: {{chi: w}}\n"
        + "bodies:\n  - {{name: table, rotation: {{axes: [3], angles: [chi]}}, mass: 0}}\n"
        + "  - {{name: u, attached to: table, connection point: [x, y, 0], coordinates: [x, y], mass: 1}}\n"
        + "loads:\n  - potential: ({0})*x**2/2 + ({2})*y**2/2\nmotion: {{x: 0, y: 0}}\n",
        (
            "({0} - w**2)",
            "({2} - w**2)",
            "({0} - w**2)*({2} - w**2)",
            "({0} + {2} + 2*w**2)",
            "(({0} + {2} + 2*w**2)**2 - 4*({0} - w**2)*({2} - w**2))",
        ),
        turntable,
    ),
}


def polynomial(source: random.Random) -> str:
    return source.choice(
        (
            "a", "b", "a - b", "a + b", "b - a", "(a - b)**2", "a*b", "2*a - b", "a**2 - b", "a - 1", "b**2 - a*b",
        )
    )  # fmt: skip


def claimed(source: random.Random, conditions: tuple[str, ...]) -> str:
    """A condition of the family, or something made of several, with a factor that matters or does not."""
    one, other = source.choice(conditions), source.choice(conditions)
    factor = source.choice(("", "", "", "2*", "-3*", "w*", "-w*", "a*", "(a - b)*", "(a - b)**2*"))
    whole = source.choice(
        (one, one, one, f"{one}**2", f"{one}**3", f"{one}*{other}", f"({one} + {other})", f"({one} - 1)")
    )
    return factor + whole


def value(text: str, point: dict[str, Fraction]) -> Fraction:
    """The tests' own arithmetic: Python's, on exact fractions."""
    return Fraction(eval(text, {"__builtins__": {}}, dict(point)))


def samples(sign: str) -> list[dict[str, Fraction]]:
    numbers = [Fraction(k, 2) for k in range(-4, 5)] + [Fraction(1, 3), Fraction(7), Fraction(-7)]
    if sign == "positive":
        numbers = [x for x in numbers if x > 0]
    return [
        {"a": a, "b": b, "w": w} for a, b in product(numbers, numbers) for w in map(Fraction, ("1/3", "1/2", "1", "2"))
    ]


@dataclass(frozen=True)
class Judged:
    """A claim as the test wrote it, and what became of it; ``place`` holds the texts that count together with it."""

    text: str
    relation: str
    role: str
    place: tuple[tuple[str, str], ...]
    result: ClaimResult


def judged(
    source: random.Random, family: Family
) -> tuple[list[Judged], str, Callable[[dict[str, Fraction]], str], tuple[str, ...]]:
    """A random system with random claims and right ones; the sign of its parameters, its truth, its true conditions."""
    texts = [polynomial(source) for _ in range(3)]
    sign = source.choice(("real", "positive"))
    known = tuple(one.format(*(f"({x})" for x in texts)) for one in family.conditions)
    written = []
    for k in range(7):
        role = source.choice(("", "necessary", "sufficient", "sufficient"))
        place = "together" if role == "sufficient" and k % 2 else f"p{k}"
        written.append((claimed(source, known), source.choice((*RELATIONS, ">", ">")), role, place))
    written += [(one, ">", "sufficient", "all") for one in known[:3]]
    written += [(one, ">", "necessary", "right") for one in known[-2:]]
    lines = "".join(
        f'  - {{claim: condition, that: "{one} {relation} 0"{f", as: {role}" if role else ""}, place: {place}}}\n'
        for one, relation, role, place in written
    )
    analysis = mbsym.loads(family.text.format(*texts, sign) + "claims:\n" + lines)
    found = []
    for (one, relation, role, place), result in zip(written, analysis.claims, strict=True):
        with_it = tuple((t, r) for t, r, o, p in written if (o, p) == (role, place))
        found.append(Judged(one, relation, role, with_it, result))

    def truth(point: dict[str, Fraction]) -> str:
        return family.truth(*(value(text, point) for text in texts), point["w"])

    return found, sign, truth, known


def contradiction(
    one: Judged, points: list[dict[str, Fraction]], truth: Callable[[dict[str, Fraction]], str], known: tuple[str, ...]
) -> str:
    """Where what was said of a claim is false; "" where nothing is."""

    def holds(point: dict[str, Fraction]) -> bool:
        return all(RELATIONS[relation](value(text, point)) for text, relation in one.place)

    def alone(point: dict[str, Fraction]) -> bool:
        return RELATIONS[one.relation](value(one.text, point))

    result = one.result
    if result.holds and one.role == "sufficient":
        return next((f"not sufficient at {p}" for p in points if holds(p) and truth(p) not in (STABLE, NEUTRAL)), "")
    if result.holds:
        if not one.role and any(same(one, other, points) for other in known):
            return ""
        if "without it the motion is unstable" in result.remark:
            return next(
                (f"not unstable at {p}" for p in points if not alone(p) and truth(p) not in (UNSTABLE, GROWS)), ""
            )
        stable: tuple[str, ...] = (STABLE,)
        if result.outcome == Outcome.EXACT and "asymptotic" not in result.remark:
            stable += (NEUTRAL,)
        wrong = (p for p in points if not alone(p) and truth(p) in stable)
        return next((f"not necessary at {p}" for p in wrong), "")
    if result.refuted and result.counterexample is not None:
        point = {name: Fraction(number) for name, number in result.counterexample.at}
        expected = (UNSTABLE, GROWS) if one.role == "sufficient" else (STABLE, NEUTRAL)
        contradicted = holds(point) if one.role == "sufficient" else not alone(point)
        return "" if contradicted and truth(point) in expected else f"no counterexample: {point}"
    if result.refuted:
        return next((f"it holds at {p}" for p in points if alone(p)), "")
    return ""


def same(one: Judged, other: str, points: list[dict[str, Fraction]]) -> bool:
    """Whether the claim and a true condition, with its relation, are the same off the border."""
    test = RELATIONS[one.relation]
    signs = [(value(one.text, p), value(other, p)) for p in points]
    return all(test(x) == (y > 0) for x, y in signs if x != 0 and y != 0)


@pytest.mark.parametrize("kind", FAMILIES)
def test_what_is_said_of_a_condition_is_true_everywhere(kind: str) -> None:
    source, words = random.Random(kind), []
    points = {sign: samples(sign) for sign in ("real", "positive")}
    for _ in range(10):
        found, sign, truth, known = judged(source, FAMILIES[kind])
        for one in found:
            wrong = contradiction(one, points[sign], truth, known)
            assert not wrong, (one.text, one.relation, one.role, claim_line(one.result), wrong)
            words.append((one.role, one.result.outcome))
    for role in ("", "necessary", "sufficient"):  # the test tests something
        assert words.count((role, Outcome.FAILS)) > 0, role
        assert sum(words.count((role, outcome)) for outcome in (Outcome.EXACT, Outcome.BORDERS)) > 3, role
    assert sum(outcome == Outcome.FAILS for _, outcome in words) > 15


# --- what was confirmed and is false ---


def outcomes(name: str) -> dict[tuple[str, str], ClaimResult]:
    analysis = mbsym.load(STATEMENTS / f"{name}.yaml")
    return {(result.title.removeprefix("condition "), result.claim.role): result for result in analysis.claims}


def test_a_condition_that_something_differs_from_zero_has_no_direction() -> None:
    """K = (a - b)^2: stable for a > b and for b > a; at a = b the solution is q0 + q1 t."""
    found = outcomes("claims_min")
    assert [found[key].outcome for key in (("a > b", "necessary"), ("b > a", "necessary"), ("a > b", ""))] == [
        Outcome.FAILS
    ] * 3
    assert found["a != b", "necessary"].outcome == Outcome.EXACT
    for key in (("a > b", "necessary"), ("b > a", "necessary")):
        at = {name: Fraction(number) for name, number in found[key].counterexample.at}
        assert at["a"] != at["b"]
        assert not value(key[0], at)


def test_foucault_needs_no_slow_turning() -> None:
    """The lowest position is stable in space, however fast the ground turns."""
    found = outcomes("claims_foucault")
    assert found["l*wz**2 < g", "necessary"].outcome == Outcome.FAILS
    assert found["l*wz**2 > g", "necessary"].outcome == Outcome.FAILS
    assert found["2*l*wz**2 < g", "necessary"].outcome == Outcome.FAILS
    # In the rotating frame K < 0 beyond it; energy and momentum together prove it, as the motion is stable everywhere.
    assert found["l*wz**2 > g", "sufficient"].outcome == Outcome.EXACT
    assert "Chetaev" in found["l*wz**2 > g", "sufficient"].remark
    # Without a role it is one of the conditions of problem 6: K > 0, Routh's theorem.
    assert found["l*wz**2 < g", ""].outcome == Outcome.EXACT
    assert "sufficient" in found["l*wz**2 < g", ""].remark


def test_a_spin_with_a_damper_needs_the_greatest_moment() -> None:
    """C > A is necessary (major-axis rule); C > 2 A is no body's, and C < 2 A is every body's but the lamina's."""
    found = outcomes("claims_spin")
    assert found["C > 2*A", "necessary"].outcome == Outcome.FAILS
    assert found["C < A", "necessary"].outcome == Outcome.FAILS
    # Its border is open: that it is necessary for exponential stability says nothing of it.
    assert found["C > A", "necessary"].outcome == Outcome.BORDERS
    assert "exponential stability" in found["C > A", "necessary"].remark
    assert "triangle inequalities" in found["C < 2*A", "necessary"].remark


def test_a_lamina_spins_stably_about_its_normal() -> None:
    """A + B = C is a lamina, stable as every body about its axis of greatest moment; so is an axis of least moment."""
    found = outcomes("s_euler_lamina")
    for that in ("A + B - C != 0", "A + B - C > 0", "C > A"):
        result = found[that, "necessary"]
        assert result.outcome == Outcome.FAILS, that
        at = {name: Fraction(number) for name, number in result.counterexample.at}
        assert (at["A"] - at["C"]) * (at["B"] - at["C"]) > 0
        assert at["A"] + at["B"] >= at["C"]
    middle = found["(A - C)*(B - C) > 0", "necessary"]
    assert (middle.outcome, middle.holds) == (Outcome.BORDERS, True)


def test_coinciding_frequencies_are_not_excluded() -> None:
    """W1 = -W2: the two tops are mirror images, their frequencies coincide, and the motion stays bounded."""
    (result,) = outcomes("cg_claims").values()
    assert result.outcome == Outcome.FAILS
    assert result.counterexample is not None


# --- one measure at borders ---


def test_at_a_border_where_the_motion_is_stable_a_strict_condition_is_not_called_exact() -> None:
    """x'' = -a x - x^3 is stable at a = 0 (a strict minimum of x^4/4), the bead at g = R w^2 like it: V = m R^2 w^2
    (1 - cos th)^2/2.  Without forces on velocities or with them, the same words."""
    for name, strict, weak, word in (
        ("strict_border", "a > 0", "a >= 0", "stable"),
        ("necessary-at-border", "g > R*w**2", "g >= R*w**2", "stable"),
        ("soft", "mu < 0", "mu <= 0", "asymptotically stable"),  # E' = -x^2 x'^2 at mu = 0 vanishes along no orbit
    ):
        found = outcomes(name)
        assert found[strict, "necessary"].outcome == Outcome.BORDERS, name
        assert "with equality, too, the motion may be stable" in found[strict, "necessary"].remark
        assert found[strict, "necessary"].counterexample.at_equality
        assert found[weak, "necessary"].outcome == Outcome.EXACT, name
        assert found[weak, "sufficient"].outcome == Outcome.EXACT, name  # of all parameters of the border
        assert f"with it the motion is {word} (" in found[weak, "sufficient"].remark
    assert outcomes("strict_border")["a != 0", "necessary"].outcome == Outcome.FAILS


OF_THE_BORDER = """
name: at a border
mbsym: 1
parameters: {k: real, c: {sign: C_SIGN, value: 1}}
bodies: [{name: p, mass: 1, connection point: [x, y, 0], coordinates: [x, y]}]
loads: [{potential: (k - 1)*x**2/2 + c*x**4 + y**2 + x**2*y**3}]
motion: {}
values: {k: 1}
claims:
  - {claim: condition, that: k >= 1, as: sufficient}
  - {claim: condition, that: k > 1, as: necessary}
"""


@pytest.mark.parametrize(
    ("sign", "potential", "sufficient", "necessary"),
    [
        # With k = 1: c x^4 + ..., of which the sign is known of all c > 0, of no others.
        ("positive", "c*x**4", Outcome.EXACT, Outcome.BORDERS),
        ("positive", "-c*x**4", Outcome.FAILS, Outcome.EXACT),
        ("real", "c*x**4", Outcome.FAILS, Outcome.BORDERS),
        ("positive", "c*x**4 + y**2 + x**2*y**3", Outcome.UNDECIDED, Outcome.BORDERS),
    ],
)
def test_a_border_is_judged_for_all_parameters_on_it(
    tmp_path: Path, sign: str, potential: str, sufficient: str, necessary: str
) -> None:
    """V = (k - 1) x^2/2 + c x^4 is stable at k = 1 for c > 0, V = (k - 1) x^2/2 - c x^4 is not."""
    text = OF_THE_BORDER.replace("C_SIGN", sign).replace("c*x**4 + y**2 + x**2*y**3", potential)
    if "y" not in potential:
        text = text.replace("[x, y, 0], coordinates: [x, y]", "[x, 0, 0], coordinates: [x]")
    (tmp_path / "border.yaml").write_text(text, encoding="utf-8")
    found = mbsym.load(tmp_path / "border.yaml").claims
    assert [result.outcome for result in found] == [sufficient, necessary]
    if sufficient == Outcome.UNDECIDED:
        assert "at the given values: there the motion is stable (" in found[0].remark


def test_no_root_to_the_left_does_not_mean_no_asymptotic_stability() -> None:
    """x'' - mu x' + x^2 x' + x = 0 at mu = 0: asymptotically stable by LaSalle's principle."""
    analysis = mbsym.load(STATEMENTS / "soft.yaml")
    assert analysis.normal_forms.at_values.outcome == "asymptotically stable"
    remark = analysis.claims[0].remark
    assert "necessary for exponential stability (all roots to the left)" in remark
    assert "asymptotic stability" not in remark


def test_what_the_given_values_refute_is_refuted_by_them() -> None:
    """k = w^2 = 1: the isotropic oscillator in turning axes keeps angular momentum; stable whatever w is."""
    found = outcomes("foucault2")
    assert found["w**2 != k", "necessary"].outcome == Outcome.FAILS
    assert dict(found["w**2 != k", "necessary"].counterexample.at) == {"k": "1", "w": "1"}
    assert found["w**2 != k", ""].outcome == Outcome.EXACT


def test_systems_by_A_are_tried() -> None:
    """Vyshnegradsky: p''' + b p'' + a p' + c d p = 0 is stable iff a b > c d."""
    found = outcomes("gov_A")
    assert {result.outcome for result in found.values()} == {Outcome.FAILS}
    for (_, role), result in found.items():
        a, b, c, d = (Fraction(x) for _, x in result.counterexample.at)
        assert (a * b > c * d) is (role == "necessary")
    text = (STATEMENTS / "gov_A.yaml").read_text(encoding="utf-8").partition("claims:")[0]
    right = "".join(f"  - {{claim: condition, that: a*b > c*d, as: {role}}}\n" for role in ("necessary", "sufficient"))
    necessary, sufficient = mbsym.loads(text + "claims:\n" + right).claims
    assert (necessary.holds, sufficient.outcome) == (True, Outcome.EXACT)


def test_where_nothing_is_stable_a_necessary_condition_says_nothing() -> None:
    """V = a (x^2 - y^2)/2: for a != 0 a saddle (Earnshaw), for a = 0 nothing acts and the particle drifts."""
    analysis = mbsym.load(STATEMENTS / "earnshaw.yaml")
    assert analysis.stability.verdict.word == "unstable but for border cases"
    for result in analysis.claims:
        if result.claim.role == "necessary":
            assert (result.outcome, result.holds) == (Outcome.UNDECIDED, False), result.title
            assert "border cases are left open" in result.remark


def test_where_borders_alone_are_stable_they_refute_and_nothing_else_is_told_of_them() -> None:
    """D = diag(a, -a) has trace 0: a root has a positive real part but for a = 0, where K > 0, that is b^2 < 3, makes
    these linear equations stable."""
    found = outcomes("never_hurwitz")
    assert mbsym.load(STATEMENTS / "never_hurwitz.yaml").stability.verdict.word == "unstable but for border cases"
    for condition in ("a > 0", "b > 1", "b**2 > 3"):
        assert found[condition, "necessary"].outcome == Outcome.FAILS, condition
        at = dict(found[condition, "necessary"].counterexample.at)
        assert at["a"] == "0"
        assert Fraction(at["b"]) ** 2 < 3
    # True, as K is then indefinite or singular, but not shown: nothing is said of what makes the motion stable.
    assert found["b**2 < 3", "necessary"].outcome == Outcome.UNDECIDED
    assert "border cases are left open" in found["b**2 < 3", "necessary"].remark


# --- parts and wholes ---


def test_a_whole_that_is_stable_in_every_case_does_not_depend() -> None:
    """Undamped parts with K > 0 beside one that friction damps where g != 0 (a != 0): one energy, which never grows."""
    for name, theorem in (("two_parts", "Lagrange-Dirichlet, Routh"), ("whole_dep", "Lagrange-Dirichlet")):
        found = mbsym.load(STATEMENTS / f"{name}.yaml").stability
        assert (found.verdict.word, found.verdict.theorem) == ("stable", theorem)
        assert found.numerical.word == "stable"
    claims = outcomes("whole_dep")
    for that in ("a > 0", "a >= 0", "g > 0"):
        assert claims[that, "sufficient"].outcome == Outcome.EXACT
        assert "Lagrange-Dirichlet" in claims[that, "sufficient"].remark
    assert claims["a > 0", "necessary"].outcome == claims["g > 0", "necessary"].outcome == Outcome.FAILS


def test_conditions_that_exclude_each_other_leave_nothing_stable() -> None:
    """K = diag(a - 1, -a): one of them is negative for every a."""
    text = (STATEMENTS / "earnshaw.yaml").read_text(encoding="utf-8").partition("claims:")[0]
    text = text.replace("a*(x**2 - y**2)/2", "(a - 1)*x**2/2 - a*y**2/2")
    found = mbsym.loads(text).stability
    assert [part.theory.verdict.word for part in found.subsystems] == ["depends on the parameters"] * 2
    assert found.verdict.word == "unstable"
    assert mbsym.loads(text.replace("- a*y", "+ a*y")).stability.verdict.word == "depends on the parameters"


def test_equal_frequencies_of_a_potential_system_do_no_harm() -> None:
    """d = 0 is the round bowl; K > 0 iff k^2 > 5 d^2."""
    analysis = mbsym.load(STATEMENTS / "bowl.yaml")
    (part,) = analysis.stability.subsystems
    places = {r.label: r.place.name for r in part.theory.requirements if not r.always}
    assert places == {"v0": "NECESSARY", "discriminant": "HARMLESS"}
    assert analysis.stability.numerical.word == "stable"


def test_of_equality_no_more_is_said_than_points_show() -> None:
    """x'' = a x + b x^3 at a = 0: stable where b < 0, unstable where b > 0.  x'' = 0 at a = 0 of x' = y, y' = -a x
    grows, which the same run tells beside what is open in general."""
    cubic = """
mbsym: 1
name: A force of one coordinate
parameters: {a: real, b: real}
bodies:
  - {name: p, mass: 1, connection point: [x, 0, 0], coordinates: [x]}
loads:
  - generalized force: {x: a*x + b*x**3}
motion: {}
values: {a: 0, b: -1}
claims:
  - {claim: condition, that: "a < 0", as: necessary}
  - {claim: condition, that: "a <= 0", as: sufficient}
"""
    strict, weak = mbsym.loads(cubic).claims
    assert (strict.outcome, weak.outcome) == (Outcome.BORDERS, Outcome.FAILS)
    assert "with equality, too, the motion may be stable" in strict.remark
    given = """
mbsym: 1
name: Oscillator by A
parameters: {a: real}
linear system: {coordinates: [x, y], A: [[0, 1], [-a, 0]]}
claims:
  - {claim: condition, that: "a > 0", as: necessary}
  - {claim: condition, that: "a >= 0", as: sufficient}
"""
    strict, weak = mbsym.loads(given).claims
    assert weak.outcome == Outcome.FAILS
    assert "nothing is proved" not in strict.remark or "nothing is proved in general" in strict.remark


def test_of_what_is_stable_always_any_condition_is_sufficient() -> None:
    """A free body that turns about its axis of greatest moment; in these angles, of which other ones are judged, no
    parameters could be tried."""
    (found,) = mbsym.loads(
        """
mbsym: 1
name: free body
parameters: {A: positive, B: positive, C: positive, n: positive}
assumptions: [A < B, B < C, C < A + B]
bodies:
  - name: body
    mass: 1
    rotation: {axes: [1, 2, 3], angles: [a, b, c]}
    inertia about: mass centre
    inertia: [A, B, C]
motion: {c: {value: 0, rate: n}}
claims:
  - {claim: condition, that: n > 1, as: sufficient}
"""
    ).claims
    assert found.outcome == Outcome.EXACT


CART = """mbsym: 1
name: a cart with friction, and a pendulum
parameters: {g: real, d: nonnegative}
bodies:
  - {name: cart, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: 1}
  - {name: bob, attached to: cart, rotation: {axes: [3], angles: [th]}, mass centre: [0, -1, 0], mass: 1}
loads:
  - uniform gravity: {vector: [0, -g, 0]}
  - damper: {coordinate: x, coefficient: d}
motion: {}
values: {g: 1, d: 1}
claims:
  - {claim: condition, that: g > 0, as: sufficient}
"""


def test_what_is_stable_by_one_theorem_or_another_is_stable() -> None:
    """With friction all roots but a zero one are to the left, without it Routh's theorem holds: g > 0 suffices."""
    (claim,) = mbsym.loads(CART).claims
    assert claim.outcome == Outcome.EXACT


SPIN = """
mbsym: 1
name: free body that spins about an axis of inertia
parameters: {A: positive, B: positive, C: positive, W: positive}
bodies:
  - {name: body, attached to: 0, rotation: {axes: AXES, angles: ANGLES}, mass: 1, inertia about: mass centre,
     inertia: [A, B, C]}
motion: {a: 0, b: 0, f: {rate: W}}
claims:
  - {claim: condition, that: (C - A)*(C - B) > 0, as: necessary}
  - {claim: condition, that: (C - A)*(C - B) >= 0, as: necessary}
  - {claim: condition, that: (C - A)*(C - B) > 0, as: sufficient}
  - {claim: condition, that: C > A, as: necessary}
"""


@pytest.mark.parametrize(("axes", "angles"), [("[3, 1, 2]", "[f, a, b]"), ("[1, 2, 3]", "[a, b, f]")])
def test_conditions_of_a_spin_are_tried_in_angles_in_which_it_is_steady(axes: str, angles: str) -> None:
    """About the largest or smallest axis it is stable, about the middle one unstable; with C = A its axis drifts."""
    found = mbsym.loads(SPIN.replace("AXES", axes).replace("ANGLES", angles), (6,)).claims
    necessary, with_equality, sufficient, wrong = [str(x.outcome) for x in found]
    assert (necessary, wrong) == ("holds but for border cases", "does not hold")
    assert with_equality == sufficient == "holds exactly"
