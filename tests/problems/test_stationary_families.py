"""Problem 10 of small systems that are solved by hand: which motions are listed, what is said of their stability."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace

import mbsym
from mbsym.analysis import Analysis
from mbsym.problems.invariant_sets.result import Definiteness, Gap, Kind
from mbsym.report.messages import messages
from mbsym.report.plain_writer import Writer
from mbsym.report.sections import invariant_sets as section
from mbsym.report.words import invariant_words

PLANE = """
mbsym: 1
name: point in the plane
bodies:
  - {{name: P, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}}
{rest}
"""
BODY = """
mbsym: 1
name: free body
parameters: {{A: positive, B: positive, C: positive}}
bodies:
  - name: body
    attached to: 0
    rotation: {{axes: [3, 1, 3], angles: [psi, theta, phi]}}
    mass: 0
    inertia about: joint
    inertia: {{tensor: {inertia}, accept: true}}
    speeds: {{p: omega1, q: omega2, r: omega3}}
    {orientation}
{loads}
"""


def is_translated(english):
    return all(("", english) in messages(language) for language in ("ru", "es"))


def _sets(text):
    return Analysis(mbsym.loads(text).system, problems=(10,)).invariant_sets


def _holds(relations, **numbers):
    signs = {">": lambda x: x > 0, ">=": lambda x: x >= 0, "!=": lambda x: x != 0}
    return all(signs[one.relation](Fraction(str(one.formula.subs(numbers)))) for one in relations)


def test_roots_that_are_rational_are_roots_of_the_first_approximation():
    """V = (x^2 + y^2)/2 + x^2 y + y^3/3 has saddles at x = +-1/2, y = -1/2 and a maximum at x = 0, y = -1.

    V'' = [1 + 2 y, 2 x; 2 x, 1 + 2 y]:  [0, +-1; +-1, 0]  with  lambda^2 = 1, -1,  and  -1  with  lambda^2 = 1  twice.
    """
    (family,) = _sets(PLANE.format(rest="loads:\n  - potential: (x**2 + y**2)/2 + x**2*y + y**3/3")).families
    places = {tuple(str(x) for name, x in one.solved if name in "xy"): one for one in family.sets}
    for place in (("1/2", "-1/2"), ("-1/2", "-1/2"), ("0", "-1")):
        first = places[place].first
        assert first.unstable
        assert first.complete
        assert {tuple(map(str, factor)) for factor in first.factors} == (
            {("-1", "1")} if place == ("0", "-1") else {("-1", "1"), ("1", "1")}
        )
    assert places["0", "0"].variation.outcome is Definiteness.STABLE


def test_a_free_body_turns_about_each_of_its_three_axes():
    """A p' = (B - C) q r: about each axis, stable where its moment is the largest or the smallest (Euler, Routh).

    Energy and |M|^2 - 2 A T hold no p: the rotation about the first axis is stationary for the second one alone.
    """
    found = _sets(BODY.format(inertia="[A, B, C]", orientation="", loads=""))
    assert found.complete
    axes = {one.free: one for family in found.families for one in family.sets if len(one.free) == 1}
    assert set(axes) == {("p",), ("q",), ("r",)}
    for A, B, C in ((1, 2, 3), (2, 3, 1), (3, 1, 2), (3, 2, 1)):
        for (name,), one in axes.items():
            own = {"p": A, "q": B, "r": C}[name]
            sides = [side for side in (one.variation.positive, one.variation.negative) if side is not None]
            assert any(_holds(side, A=A, B=B, C=C, **{name: 1}) for side in sides) == (own != 2)
            assert _holds(one.first.necessary, A=A, B=B, C=C, **{name: 1}) == (own != 2)


def test_both_normal_modes_are_manifolds():
    """x'' = -x, y'' = -4 y: the planes x = x' = 0 and y = y' = 0 are invariant, and K is definite across each."""
    found = _sets(PLANE.format(rest="loads:\n  - potential: (x**2 + 4*y**2)/2"))
    planes = [one for family in found.families for one in family.sets if one.kind is Kind.MANIFOLD]
    assert {tuple(name for name, _ in one.solved) for one in planes} == {("x_dot", "x"), ("y_dot", "y")}
    assert all(one.variation.outcome is Definiteness.STABLE for one in planes)


def test_no_gap_is_suspected_where_the_energy_alone_is_definite():
    """An isotropic oscillator's rest: K = T + V is positive, so that no point may be told where nothing suffices."""
    found = _sets(PLANE.format(rest="parameters: {k: positive}\nloads:\n  - potential: k*(x**2 + y**2)/2"))
    rest = found.families[0].sets[0]
    assert rest.kind is Kind.STEADY
    assert rest.gap is not Gap.FOUND
    assert rest.variation.outcome is Definiteness.STABLE
    assert rest.variation.chosen == ()


def test_what_has_no_real_points_is_no_set():
    """grad of (y' x - x' y) + lambda (x' y' + k x y) vanishes off the rest where 1 + k lambda^2 = 0: nowhere.

    In skew coordinates, so that the second integral is none of the energies of x and of y.
    """
    loads = "parameters: {k: positive}\nloads:\n  - potential: k*((x + y)**2 + y**2)/2"
    found = _sets(PLANE.replace("[x, y, 0]", "[x + y, y, 0]").format(rest=loads))
    (family,) = [one for one in found.families if len(one.integrals) == 2]
    (rest,) = family.sets
    assert rest.kind is Kind.STEADY


def test_rates_that_say_nothing_are_not_told():
    """On x = x' = 0 of V = (x^2 + 4 y^2)/2 the motion is y'' = -4 y, and not  y' = y'  besides."""
    found = _sets(PLANE.format(rest="loads:\n  - potential: (x**2 + 4*y**2)/2"))
    known = SimpleNamespace(by_problem={10: found}, missing=lambda number: ())
    text = " ".join(line.text for line in Writer(readable=True).document(section.content(known)))
    assert "On it: y'' = -4 y." in text
    assert "y' = y'" not in text


def test_multipliers_near_zero_are_tried():
    """A body with A, B, C = 3, 2, 4 under 3 gamma1^2/2 + gamma2^2 + 2 gamma3^2, turning about the third axis.

    K is definite where  r^2 (1 - 16 s^2) - 2 s - 1 > 0  for some s > -1/2; the largest value, at s = -1/(16 r^2), is
    r^2 + 1/(16 r^2) - 1,  positive where  16 r^4 - 16 r^2 + 1 > 0:  with 8 r^2 > 7 that is the necessary condition.
    """
    loads = "loads:\n  - potential: (3*gamma1**2 + 2*gamma2**2 + 4*gamma3**2)/2"
    found = _sets(BODY.format(inertia="[3, 2, 4]", orientation="orientation: {gamma: 3}", loads=loads))
    one = next(x for x in found.families[0].sets if x.kind is Kind.STEADY and x.free == ("r", "gamma3"))
    for r, holds in ((Fraction(97, 100), True), (Fraction(24, 25), False)):  # the border is r^2 = (2 + sqrt(3))/4
        assert _holds(one.first.necessary, r=r) == holds
        tried = [-1 / (16 * r * r), 0]
        assert any(_holds(one.variation.positive, r=r, lambda2=s, gamma3=1) for s in tried) == holds
    assert one.gap is Gap.NONE_FOUND


def test_a_rest_is_not_left_out_of_what_suffices():
    """A body with A = B turns about its axis: K'' = A on p, q at every rate, none among them too."""
    found = _sets(BODY.format(inertia="[A, A, C]", orientation="", loads="").replace("B: positive, ", ""))
    one = next(x for x in found.families[0].sets if x.free == ("r",))
    assert one.variation.outcome is Definiteness.STABLE


def test_a_family_without_stationary_points_is_told():
    """x' of a falling point is kept, and its gradient is nowhere zero."""
    found = _sets(PLANE.format(rest="loads:\n  - potential: 3*y"))
    known = SimpleNamespace(by_problem={10: found}, missing=lambda number: ())
    text = " ".join(line.text for line in Writer(readable=True).document(section.content(known)))
    assert "K = V0: It has no stationary points for almost all parameters (proved)." in text


def test_roots_that_are_not_listed_are_counted():
    """(lambda^2 - 1)(lambda^3 - lambda + 1), say: "roots of lambda^2 - 1" alone would deny the other three."""
    found = _sets(PLANE.format(rest="loads:\n  - potential: (y**2 - x**2)/2"))
    one = replace(found.families[0].sets[0].first, left=3)
    said = {one.text: one.gaps for one in invariant_words._first(one)}
    (listed,) = [text for text in said if text.startswith("First approximation")]
    assert "among the others" in listed
    (left,) = [text for text in said if text.startswith("Roots of factors that are not even")]
    assert said[left] == {"n": "3"}
    assert is_translated(listed)
    assert is_translated(left)


def test_integrals_that_are_functions_of_others_are_named():
    """2 T = x'^2 + y'^2 of a free point is a function of its momenta: y' is in no family, and every x', y' is steady.

    What claims repeat, with a factor and a constant, is none of these.
    """
    claims = '  - {claim: first integral, equals: "3*x_dot**2 + 3*y_dot**2 + 1", place: "(1)"}'
    found = _sets(PLANE.format(rest="claims:\n" + claims))
    assert [name for name, _ in found.integrals] == ["generalised energy", "momentum of x"]
    assert found.left_out == ("momentum of y",)
    text = "Left out of the families, as functions of these (verified at a random state): [[names]]."
    assert text in {one.text for one in invariant_words.opening(found)}
    assert is_translated(text)


def test_roots_of_the_geometry_are_told():
    """Of (p, q, r, gamma) at a rest of a heavy body two roots vanish: the norm's, and that of turns about gamma."""
    loads = "loads:\n  - potential: 3*gamma3"
    found = _sets(BODY.format(inertia="[4, 3, 2]", orientation="orientation: {gamma: 3}", loads=loads))
    said = {one.text: one.gaps for one in invariant_words.opening(found)}
    text = "Of the zero roots of a first approximation so many belong to these relations, and to no motion: [[n]]."
    assert said[text] == {"n": "1"}
    assert is_translated(text)


def test_precessions_that_are_unstable_are_not_called_stable():
    """A body with A = B = 3, C = 2 under (3 (gamma1^2 + gamma2^2) + 2 gamma3^2)/2, its axis across gamma, turns slowly.

    w = Omega gamma, r = Omega f(Omega) gamma3: the precessions of one Omega are a set over which lambda2 varies, and
    for one gamma3 = u the effective potential  (b - C r u)^2/(2 A (1 - u^2)) + (C - A) u^2/2  has at u = 0, r = 0 the
    second derivative  A Omega^2 + C - A,  negative for Omega^2 < 1/3: a motion near it turns away from gamma3 = 0 with
    r = 0, and so from that set.
    """
    loads = "loads:\n  - potential: (3*gamma1**2 + 3*gamma2**2 + 2*gamma3**2)/2"
    found = _sets(BODY.format(inertia="[3, 3, 2]", orientation="orientation: {gamma: 3}", loads=loads))
    slow = {"lambda1": Fraction(-1, 4), "gamma1": 1, "gamma2": 0, "gamma3": 0}
    held = [
        one
        for family in found.families
        for one in family.sets
        if one.kind is Kind.MANIFOLD
        and {"p", "q", "r"} == {name for name, _ in one.solved}
        and [Fraction(str(x.subs(slow))) for _, x in one.solved] == [Fraction(1, 4), 0, 0]
    ]
    assert held
    for one in held:
        assert one.variation.outcome is Definiteness.VARYING
        text = "Its stability was not looked at: multipliers vary over it."
        said = [x.text for x in invariant_words.of_set(one, 1, None)]
        assert text in said
        assert not any(x.startswith(("Stable", "Sufficient")) for x in said)
        assert is_translated(text)


def test_of_a_set_it_is_said_that_stability_is_its_own():
    found = _sets(PLANE.format(rest="loads:\n  - potential: (x**2 + 4*y**2)/2"))
    plane = next(one for one in found.families[0].sets if one.kind is Kind.MANIFOLD)
    relation = found.families[0].sets[0].variation.positive
    conditional = replace(plane.variation, outcome=Definiteness.CONDITIONAL, positive=relation, chosen=("lambda1",))
    said = [x.text for x in invariant_words.of_set(replace(plane, variation=conditional), 1, None)]
    (text,) = [x for x in said if x.startswith("Sufficient")]
    assert "as a set" in text
    assert is_translated(text)


def test_a_saddle_off_its_axis_is_unstable_without_a_condition():
    """V = (x^2 + 4 y^2)/2 + x^2 y: y = -1/2, x^2 = 2; V_xx = 0, V_xy = 2 x: one square of a root is positive."""
    (family,) = _sets(PLANE.format(rest="loads:\n  - potential: (x**2 + 4*y**2)/2 + x**2*y")).families
    (saddle,) = [one for one in family.sets if one.relations]
    assert saddle.first.unstable
    assert saddle.first.necessary == ()
    assert all(str(factor[-1]) == "1" for factor in saddle.first.factors)
