"""Signs of polynomials: what must be proved, what must stay unknown, and that no answer is ever wrong."""

from __future__ import annotations

from fractions import Fraction
from random import Random
from typing import Any

import pytest
from flint import Ordering, fmpq, fmpq_mpoly_ctx
from hypothesis import given
from hypothesis import strategies as st
from properties import settings

from mbsym.algebra import signs as module
from mbsym.algebra.signs import (
    ATTEMPTS,
    RELATIONS,
    SHARES,
    SIGN_SETS,
    WITNESSES,
    Condition,
    ContradictionError,
    Signs,
    conditions,
)

CONTEXT = fmpq_mpoly_ctx.get(["x", "y", "z"], Ordering.degrevlex)
x, y, z = CONTEXT.gens()
ONE = CONTEXT.constant(1)


def signs(words: str, *assumptions: tuple[Any, str]) -> Signs:
    return Signs(CONTEXT, tuple(words.split()), assumptions)


@pytest.mark.parametrize(
    ("words", "assumptions", "polynomial", "expected"),
    [
        ("positive positive real", (), x * y + x**2, "positive"),
        ("positive negative real", (), x * y, "negative"),
        # Sylvester's pair from below: x z > y^2 and z > 0
        ("real real positive", ((x * z - y**2, ">"),), x, "positive"),
        ("real real negative", ((x * z - y**2, ">"),), x, "negative"),
        ("real real positive", ((x * z - y**2, ">="),), x, "nonnegative"),
        ("real real real", ((x * z - y**2, ">"), (z, ">")), x, "positive"),
        ("real real real", ((1 - z**2, ">"), (1 + z, ">=")), 1 - z, "positive"),
        ("positive real real", ((x - x * z**2, ">"), (1 - z, ">="), (1 + z, ">=")), 1 + z, "positive"),
        # (x + y + z)^2/2 + (x^2 + y^2 + z^2)/2, and sums of three squares: one discriminant within the other
        ("real real real", (), x**2 + y**2 + z**2 + x * y + y * z + z * x, "nonnegative"),
        ("real real real", (), (x - y) ** 2 + (y - z) ** 2 + z**2, "nonnegative"),
        ("real real real", (), x**2 + y**2 + z**2 + x * y + y * z + 1, "positive"),
        ("real real real", (), -(x**2) - y**2 - z**2 - x * y - y * z - 1, "negative"),
        # What is assumed of a generator alone holds in every term.
        ("nonnegative real real", ((x, "!="),), x**2 + y**2, "positive"),
        ("real real real", ((-x, ">"),), x * y**2 - 1, "negative"),
        ("nonpositive real real", ((2 * x, "!="),), x**3 - y**2, "negative"),
        ("positive nonnegative real", (), x * y, "nonnegative"),
        ("positive real real", (), x * y, "unknown"),
        ("nonzero real real", (), x, "nonzero"),
        ("nonzero real real", (), x**2, "positive"),
        ("real real real", (), x**2, "nonnegative"),
        ("real real real", (), x**2 + 1, "positive"),
        ("real real real", (), x**2 - x * y + y**2, "nonnegative"),
        ("real real real", (), x**2 - x + 1, "positive"),
        ("real real real", (), -(x**2) + x - 1, "negative"),
        ("real real real", (), x * 0, "zero"),
        ("real real real", (), ONE * -3, "negative"),
        ("positive positive positive", ((x + y - z, ">"),), 2 * x + 2 * y - 2 * z, "positive"),
        ("positive positive positive", ((x + y - z, ">"),), z - x - y, "negative"),
        ("positive positive positive", ((x + y - z, ">"),), 3 * x + y - z, "positive"),
        ("positive positive positive", ((x - y, ">"), (y - z, ">=")), x - z, "positive"),
        ("positive positive positive", ((x - y, ">"),), x**2 - y**2, "positive"),
        ("positive positive positive", ((x - y, ">"),), x * z - y * z, "positive"),
        ("real real real", ((x * y, ">"),), x * y * 5, "positive"),
        ("real real real", ((x - y, "!="),), (x - y) ** 2, "positive"),
        ("real real real", ((x - y, "!="),), x - y, "nonzero"),
        ("real real real", ((1 - x, ">"), (1 + x, ">")), 1 - x**2, "positive"),
        ("real real real", ((1 - x, ">"), (1 + x, ">"), (y, ">"), (1 - y, ">")), 1 + x * y, "positive"),
        ("positive real real", ((1 - x, ">="),), 1 - x, "nonnegative"),
        ("positive real real", ((1 - x, ">="),), 1 - x**3, "nonnegative"),
        ("positive real real", ((1 - x, ">="),), 2 - x**3, "positive"),
        ("positive real real", ((1 - x, ">="),), x**2 - x, "nonpositive"),
        ("real real real", ((x - 2, ">"),), x**2 - 4, "positive"),
        ("real real real", ((x - 2, ">="),), x**2 - 3 * x + 2, "nonnegative"),
        ("real real real", ((-2 - x, ">"),), x + 1, "negative"),
        ("positive positive real", ((2 * x - 2 * x * y, ">"),), 1 - y, "positive"),
        ("positive positive real", ((x * (1 - y), ">"),), 2 - y, "positive"),
    ],
)
def test_proved(words: str, assumptions: tuple[tuple[Any, str], ...], polynomial: Any, expected: str) -> None:
    assert signs(words, *assumptions).sign(polynomial) == expected


@pytest.mark.parametrize(
    ("words", "assumptions", "polynomial"),
    [
        ("positive positive real", (), x - y),
        ("real real real", ((x - y, ">"),), x + y),
        ("positive real real", ((1 - x, ">="),), 1 - 2 * x),
        ("positive positive positive", ((x + y - z, ">"),), x - z),
        ("real real real", (), x**2 - 3 * x * y + y**2),
    ],
)
def test_unknown_stays_unknown(words: str, assumptions: tuple[tuple[Any, str], ...], polynomial: Any) -> None:
    assert signs(words, *assumptions).sign(polynomial) == "unknown"


def test_bad_knowledge_is_refused() -> None:
    with pytest.raises(ValueError, match="sign words"):
        Signs(CONTEXT, ("real",))
    with pytest.raises(ValueError, match="no such sign"):
        signs("real real plus")
    with pytest.raises(ValueError, match="no such relation"):
        signs("real real real", (x, "<"))
    with pytest.raises(ContradictionError):
        signs("real real real", (ONE * -1, ">")).sign(x - y)
    with pytest.raises(ContradictionError):
        signs("real real real", (x - 2, ">"), (1 - x, ">")).sign(x - y)


def test_a_sum_of_squares_is_positive_where_the_other_factors_are() -> None:
    """Regular precession, c = cos, p = C (n + w c): K ~ (1 - c^2) ((p - 2 x c)^2 + x^2 (1 - c^2)), x = A w > 0."""
    known = signs("positive real real", (1 - z, ">="), (1 + z, ">="))
    found = known.condition((1 - z**2) * ((y - 2 * x * z) ** 2 + x**2 * (1 - z**2)))
    assert found.kind == "nonzero"
    assert sorted(map(str, found.nonzero)) == sorted(map(str, (z - 1, z + 1)))
    vanishing = known.condition((1 - z**2) * ((y - 2 * x * z) ** 2 + x**2 * (2 - z) * (1 - z) * (z + 2) * (z - y) ** 2))
    assert len(vanishing.nonzero) > 2 or vanishing.kind == "inequality"  # zero at y = z = 0, where the others are not


def test_condition_drops_what_is_known() -> None:
    known = signs("positive real real", (1 - y, ">"))
    assert known.condition(x * (2 - y)).kind == "always"
    assert known.condition(-x).kind == "never"
    assert known.condition(-(y**2)).kind == "never"
    assert known.condition(x * 0).kind == "never"
    assert known.condition(y**2 * x) == Condition("nonzero", ONE, (), (y,))
    assert known.condition(fmpq(3, 4) * x**3 * (z - y)) == Condition("inequality", z - y, (z - y,))
    assert known.condition(-2 * x * (z - y)) == Condition("inequality", y - z, (y - z,))
    assert known.condition((z - y) * y**2 * (1 - y)) == Condition("inequality", z - y, (z - y,), (y,))
    product = known.condition(-6 * y * z**3)
    assert (product.kind, product.polynomial, product.nonzero) == ("inequality", -y * z, ())
    assert sorted(map(str, product.factors)) == ["-z", "y"] or sorted(map(str, product.factors)) == ["-y", "z"]
    assert known.nonzero_condition(x * y**2) == Condition("nonzero", ONE, (), (y,))
    assert known.nonzero_condition(x).kind == "always"
    assert known.nonzero_condition(x * 0).kind == "never"


def test_list_of_conditions() -> None:
    known = signs("positive real real")
    required = [known.condition(p) for p in (x, y, 2 * x * y, y * z, z, x**2 * z**2, y - z)]
    assert [c.polynomial for c in conditions(required)] == [y, z, y - z]
    assert conditions([known.condition(y), known.condition(-x)])[0].kind == "never"
    assert conditions([]) == ()


integers = st.integers(-3, 3)
polynomials = st.dictionaries(st.tuples(*[st.integers(0, 2)] * 3), integers, min_size=1, max_size=5).map(
    CONTEXT.from_dict
)
words = st.sampled_from(["positive", "nonnegative", "negative", "nonpositive", "nonzero", "real"])
assumption = st.tuples(
    st.tuples(integers, integers, integers, integers).map(lambda c: c[0] * x + c[1] * y + c[2] * z + c[3]),
    st.sampled_from(sorted(RELATIONS)),
)
grid = [Fraction(n, 2) for n in range(-6, 7)]


@settings(max_examples=120)
@given(st.tuples(words, words, words), st.lists(assumption, max_size=3), polynomials, polynomials, st.randoms())
def test_never_wrong(three: tuple[str, ...], given_: list[tuple[Any, str]], p: Any, q: Any, random: Any) -> None:
    """Every sampled point that satisfies the assumptions has one of the claimed signs and agrees with condition()."""
    known = Signs(CONTEXT, three, tuple(given_))
    product = p * q
    try:
        claimed = SIGN_SETS.get(known.sign(product), SIGN_SETS["real"])
        condition = known.condition(product)
    except ContradictionError:
        claimed, condition = frozenset(), known._decided(False)
    for _ in range(60):
        point = [fmpq(c.numerator, c.denominator) for c in random.choices(grid, k=3)]
        possible = all(_sign(v) in SIGN_SETS[word] for v, word in zip(point, three, strict=True))
        if possible and all(_sign(a(*point)) in RELATIONS[relation] for a, relation in given_):
            value = product(*point)
            assert _sign(value) in claimed
            reduced = condition.polynomial(*point) > 0 and all(f(*point) != 0 for f in condition.nonzero)
            assert reduced == (value > 0)


@settings(max_examples=150)
@given(st.tuples(words, words, words), st.lists(assumption, max_size=4))
def test_witnesses_keep_every_assumption(three: tuple[str, ...], given_: list[tuple[Any, str]]) -> None:
    """Points between bounds need not be put into these bounds: the same points as if they were put into all."""
    known = Signs(CONTEXT, three, tuple(given_))
    random, slow = Random(1), []
    bounds = [known._bounds(k) for k in range(3)]
    for _ in range(ATTEMPTS):
        point = tuple(module._between(lower, upper, random.choice(SHARES)) for lower, upper in bounds)
        if all(_sign(a(*point)) in RELATIONS[relation] for a, relation in given_):
            slow.append(point)
    assert known.witnesses == tuple(slow[:WITNESSES])


WIDE = fmpq_mpoly_ctx.get([f"w{k}" for k in range(30)], Ordering.lex)
knowledge = st.tuples(st.tuples(words, words, words), st.lists(assumption, max_size=2))


@settings(max_examples=100)
@given(st.lists(st.tuples(knowledge, polynomials), min_size=2, max_size=6))
def test_what_is_shared_is_what_would_be_found_alone(questions: list[tuple[Any, Any]]) -> None:
    """Whoever asks in a wide context gets the answer that they would get if nobody had asked before."""
    places = [WIDE.gen(k) for k in (3, 8, 21)]

    def answer(three: tuple[str, ...], given_: list[tuple[Any, str]], p: Any) -> str:
        spread = ["real"] * 30
        for k, word in zip((3, 8, 21), three, strict=True):
            spread[k] = word
        wide = tuple((a.compose(*places, ctx=WIDE), relation) for a, relation in given_)
        try:
            return Signs(WIDE, tuple(spread), wide).sign(p.compose(*places, ctx=WIDE))
        except ContradictionError:
            return "contradiction"

    together = [answer(*known, p) for known, p in questions]
    for (known, p), found in zip(questions, together, strict=True):
        module._SHARED.clear()
        assert answer(*known, p) == found


def _sign(value: Any) -> int:
    return (value > 0) - (value < 0)
