"""What holds where a condition of exactly linear equations is an equality: proved in symbols, and held against points.

By hand, of x'' + g y' + a x = 0, y'' - g x' + b y = 0 (a particle in a magnetic field g, potential (a x^2 + b y^2)/2):

* a = b = 0: zero roots twice, +- i g.  The kernel of A has two dimensions where g != 0: bounded.  g = 0: x'' = y'' = 0,
  Jordan blocks: unstable.
* a = b: mu^2 + (2 a + g^2) mu + a^2 = 0, discriminant g^2 (g^2 + 4 a).  a = 0 != g: stable, as above.
  g^2 + 4 a = 0: mu = -g^2/4 twice, the pencil has rank 1 there (its entry g lambda is not zero): Jordan
  blocks, unstable.  g = 0 < a: two equal oscillators, stable.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import pytest
from conftest import at_values, filed
from terminal import told

import mbsym
from mbsym.problems.stability.requirements import Place
from mbsym.problems.stability.words import Word
from mbsym.report.conditions import statements

FIELD = """
mbsym: 1
name: field
parameters: {{g: {sign}, a: real, b: real}}
linear system: {{coordinates: [x, y], G: [[0, g], [-g, 0]], K: [[{a}, 0], [0, {b}]]}}
claims:
{claims}
"""


def places(**numbers: str) -> dict[str, Place]:
    text = FIELD.format(claims="  []", **numbers).replace("claims:\n  []", "")
    (part,) = mbsym.loads(text).stability.subsystems
    return {str(x.formula): x.place for x in statements(part.ring, part.theory.requirements)}


def test_places_say_what_equality_does() -> None:
    assert places(sign="real", a="0", b="0") == {"g": Place.STRICTLY}
    assert places(sign="positive", a="a", b="a") == {
        "a": Place.EQUALITY,
        "g**2 + 4*a": Place.STRICTLY,  # it says that g^2 + 2 a > 0
    }
    # g = 0: a > 0 is needed for the rest.  g^2 + 2 a = 0 has a = 0 = g, too, where x'' = y'' = 0 grows.
    found = places(sign="real", a="a", b="a")
    assert found["a"] is found["g"] is Place.EQUALITY
    assert found["g**2 + 4*a"] is Place.STRICTLY
    # a b = 0 holds a = 0 != b, a Jordan block, and a = 0 = b, which is stable: nothing is said of all.
    assert places(sign="positive", a="a", b="b")["a*b"] is Place.NECESSARY


#: Of a = b: (claim, role, sign of g, outcome, what the remark or the counterexample says)
CLAIMS = (
    ("a != 0", "necessary", "positive", "does not hold", ""),
    ("a >= 0", "sufficient", "positive", "holds exactly", "the motion is stable (theory of linear equations)"),
    ("a >= 0", "sufficient", "real", "does not hold", ""),  # a = 0 = g
    ("g**2 + 4*a > 0", "necessary", "positive", "holds exactly", "without it the motion is unstable"),
    ("g**2 + 4*a > 0", "necessary", "real", "holds exactly", "without it the motion is unstable"),
    # Where 2 a = -g^2 the motion is unstable, but it is where -g^2 < 4 a < 0, too: no equality.
    ("(2*a - g)*(g + a) != 0", "necessary", "positive", "does not hold", ""),
)


@pytest.mark.parametrize(("that", "role", "sign", "outcome", "told"), CLAIMS)
def test_claims_are_decided_with_equality(that: str, role: str, sign: str, outcome: str, told: str) -> None:
    line = f'  - {{claim: condition, that: "{that}", as: {role}}}'
    (found,) = mbsym.loads(FIELD.format(sign=sign, a="a", b="a", claims=line)).claims
    assert found.outcome == outcome
    assert told in found.remark


def test_without_potential_the_field_is_necessary() -> None:
    line = '  - {claim: condition, that: "g != 0", as: necessary}'
    (found,) = mbsym.loads(FIELD.format(sign="real", a="0", b="0", claims=line)).claims
    assert (found.outcome, found.remark.endswith("without it the motion is unstable")) == ("holds exactly", True)


POINTS = [(Fraction(g), Fraction(a)) for g in ("-2", "-1", "0", "1", "2") for a in ("-1", "-1/2", "-1/4", "0", "1")]


def test_the_judge_agrees_at_points_of_every_border(tmp_path) -> None:
    """Every place of a = b, against the exact verdict at points on its border."""
    text = FIELD.format(claims="  []", sign="real", a="a", b="a").replace("claims:\n  []", "")
    path = filed(tmp_path / "field.yaml", text)
    (part,) = mbsym.load(path).stability.subsystems
    listed = list(statements(part.ring, part.theory.requirements))
    seen = set()
    for g, a in POINTS:
        gaps = [eval(str(x.formula), {"__builtins__": {}}, {"g": g, "a": a}) for x in listed]
        stable = at_values(path, g=str(g), a=str(a), b="0").stability.numerical.stable
        for x, gap in zip(listed, gaps, strict=True):
            others = all(
                y != 0 if z.relation == "!=" else y > 0 for z, y in zip(listed, gaps, strict=True) if z is not x
            )
            if gap == 0 and x.place is Place.STRICTLY:
                assert not stable, (x, g, a)
            if gap == 0 and others and x.place in (Place.BESIDE, Place.EQUALITY):
                assert stable is (x.place is Place.EQUALITY), (x, g, a)
                seen.add(x.place)
    assert Place.EQUALITY in seen


#: Friction d, stiffness k, circulation n: z'' + d z' + (k - i n) z = 0 with z = x + i y has z = exp(i w t) where
#: k = w^2 and d w = n: k d^2 = n^2, the other root to the left of it; one oscillator has d = 0 < k, or k = 0 < d.
DECAYING = {
    "{coordinates: [x, y], D: [[d, 0], [0, d]], K: [[k, 0], [0, k]], N: [[0, n], [-n, 0]]}": {"k*d**2 - n**2"},
    "{coordinates: [x], D: [[d]], K: [[k + 0*n]]}": {"d", "k"},
    "{coordinates: [x, y], D: [[d, 0], [0, 0]], K: [[k, -n], [-n, k]]}": set(),
    "{coordinates: [x, y], D: [[d, 0], [0, d]], G: [[0, n], [-n, 0]], K: [[k, 0], [0, k]]}": set(),
}


@pytest.mark.parametrize("linear", DECAYING)
@pytest.mark.parametrize("signs", ["d: positive, k: positive, n: positive", "d: real, k: real, n: positive"])
def test_borders_of_what_decays(linear: str, signs: str, tmp_path) -> None:
    """What is told of equality, against the exact verdict at points of every border."""
    text = f"mbsym: 1\nname: decaying\nparameters: {{{signs}}}\nlinear system: {linear}\n"
    path = filed(tmp_path / "decaying.yaml", text)
    (part,) = mbsym.load(path).stability.subsystems
    listed = [x for x in statements(part.ring, part.theory.requirements) if x.formula is not None]
    merely = {str(x.formula) for x in listed if x.place is Place.MERELY}
    assert merely >= {x for x in DECAYING[linear] if x in {str(one.formula) for one in listed}}
    for d, k, n in product(*[[Fraction(x) for x in ("-1", "0", "1", "2")]] * 3):
        if n <= 0 or ("real" not in signs and min(d, k) <= 0):
            continue
        gaps = [eval(str(x.formula), {"__builtins__": {}}, {"d": d, "k": k, "n": n}) for x in listed]
        word = at_values(path, d=str(d), k=str(k), n=str(n)).stability.numerical.word
        for i, (x, gap) in enumerate(zip(listed, gaps, strict=True)):
            others = all(
                y != 0 if z.relation == "!=" else y > 0 for z, y in zip(listed, gaps, strict=True) if z is not x
            )
            if gap == 0 and (x.place is Place.STRICTLY or (others and x.place is Place.BESIDE)):
                assert word is Word.UNSTABLE, (i, d, k, n)
            if gap == 0 and others and x.place is Place.MERELY:
                assert word.stable, (i, d, k, n)
                assert word is not Word.ASYMPTOTIC, (i, d, k, n)
            if gap == 0 and others and x.place is Place.EQUALITY:
                assert word.stable, (i, d, k, n)


BODY = """
mbsym: 1
name: body
parameters: {g: real}
bodies:
  - {name: p, attached to: 0, mass: 1, connection point: [x, y, 0], coordinates: [x, y]}
loads:
  - generalized force: {x: -g*y_dot, y: g*x_dot}
motion: {x: 0, y: 0}
claims:
  - {claim: condition, that: g != 0}
"""


def test_a_condition_that_is_not_listed_is_named_as_what_it_is() -> None:
    """The free particle is stable but for a drift whatever g is: what the method needs leaves nothing open."""
    a = mbsym.loads(BODY)
    assert "  v0: g != 0" in told(a, 6)
    (found,) = a.claims
    assert found.remark.startswith("it is the condition v0 of x, y (g != 0)")
    line = '  - {claim: condition, that: "g != 0"}'
    (found,) = mbsym.loads(FIELD.format(sign="real", a="0", b="0", claims=line)).claims
    assert found.remark == "it is the condition v0 of x, y"  # listed there
