"""Sums of angles: the same value as the products of the ring, and what papers and textbooks print."""

from __future__ import annotations

import random
from fractions import Fraction

from hypothesis import given
from hypothesis import strategies as st
from properties import settings

from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.angles import LinearForm
from mbsym.formulas.python import python_text
from mbsym.formulas.shape import present
from mbsym.formulas.tree import Factor, Sum, Wave, angles_as

NAMES = ("q1", "q2", "q3")
#: sin(q3/2) makes the angle of q3 a half.
RING = Ring(NAMES, ("chi",), ("a", "b", "c"), {"q1": 1, "q2": 1, "q3": 2, "chi": 1, "c": 1}, spare=6)
ANGLES = tuple(RING.angles)


def element(shape: Sum, ring: Ring = RING) -> Polynomial:
    """A shape back in the ring, by the ring's own addition theorems: not by the Fourier sums that made it."""
    total = ring.zero
    for term in shape.terms:
        assert not term.under
        product = ring.context.constant(term.coefficient)
        for factor in term.over:
            product = ring.reduce(product * base(factor, ring) ** factor.exponent)
        total = total + product
    return ring.reduce(total)


def base(factor: Factor, ring: Ring) -> Polynomial:
    match factor.base:
        case Wave(kind, angle):
            form = LinearForm()
            for name, n in angle:
                form = form + LinearForm(((name, n),))
            return ring.sin_cos(form)[0 if kind == "sine" else 1]
        case Sum():
            return element(factor.base, ring)
        case index:
            return ring.context.gen(index)


def waves(shape: Sum) -> list[Wave]:
    """Every wave of a shape, those in brackets too."""
    found = []
    for term in shape.terms:
        for factor in (*term.over, *term.under):
            if isinstance(factor.base, Wave):
                found.append(factor.base)
            elif isinstance(factor.base, Sum):
                found += waves(factor.base)
    return found


def fourier(source: random.Random, terms: int) -> Polynomial:
    """A random polynomial of waves with weights in the parameters and velocities."""
    total = RING.zero
    others = [RING.generator("parameter", "a"), RING.generator("parameter", "b"), RING.generator("velocity", "q1")]
    for _ in range(terms):
        form = LinearForm()
        for name in source.sample(ANGLES, source.randint(1, 4)):
            n = Fraction(source.choice((-2, -1, -1, 1, 1, 2)), RING.angles[name])
            form = form + LinearForm(((name, n),))
        weight = Fraction(source.randint(-4, 4), source.choice((1, 2, 3)))
        term = RING.sin_cos(form)[source.randint(0, 1)] * RING.number(weight)
        for other in source.sample(others, source.randint(0, 2)):
            term = term * other
        total = total + term
    return RING.reduce(total)


def products(source: random.Random, terms: int) -> Polynomial:
    """A random polynomial in sines and cosines of single angles."""
    total = RING.zero
    for _ in range(terms):
        term = RING.number(source.randint(-3, 3))
        for name in source.sample(ANGLES, source.randint(0, 3)):
            term = term * RING.generator(source.choice(("sine", "cosine")), name) ** source.randint(1, 3)
        for name in source.sample(("a", "b"), source.randint(0, 1)):
            term = term * RING.generator("parameter", name)
        total = total + term
    return RING.reduce(total)


@settings(max_examples=150)
@given(seed=st.integers(0, 10**9), terms=st.integers(0, 6), choice=st.sampled_from(["sums", "shorter"]))
def test_sums_of_angles_are_the_same_element_of_the_ring(seed, terms, choice):
    source = random.Random(seed)
    for made in (fourier(source, terms), products(source, 2 * terms)):
        assert (element(present(RING, made, choice)) - made).is_zero()


def test_constant_turns_stay_exact_beside_sums_of_angles():
    """cos(q1 + q2 + pi/6) = sqrt(3)/2 cos(q1 + q2) - 1/2 sin(q1 + q2)."""
    form = LinearForm((("q1", Fraction(1)), ("q2", Fraction(1))), turns=Fraction(1, 6))
    made = RING.sin_cos(form)[1] * RING.generator("parameter", "a")
    shape = present(RING, made, "sums")
    assert (element(shape) - made).is_zero()
    assert {wave.kind for wave in waves(shape)} == {"sine", "cosine"}
    with angles_as("sums"):
        text = python_text(RING, made)
    assert "cos(q1 + q2)" in text
    assert "sin(q1 + q2)" in text


def test_many_angles_and_high_powers_are_left_alone_or_exact():
    """Seven angles in one product, cos^12: no waves without end, and the same element."""
    ring = Ring([f"x{k}" for k in range(8)], (), ("a",), {f"x{k}": 1 for k in range(8)}, spare=2)
    form = LinearForm(tuple((f"x{k}", Fraction(1)) for k in range(7)))
    total = ring.sin_cos(form)[0] * ring.generator("parameter", "a")
    power = ring.reduce(ring.generator("cosine", "x7") ** 12 - ring.generator("cosine", "x7") ** 2 * 3)
    for made in (total, power, total + power):
        assert (element(present(ring, made, "sums"), ring) - made).is_zero()
        assert (element(present(ring, made, "shorter"), ring) - made).is_zero()


def test_the_same_formula_has_the_same_text_whatever_was_written_before():
    """Waves are placed by their angles, not by when they were met."""
    texts = []
    for order in ((0, 1, 2, 3), (3, 1, 0, 2)):
        ring = Ring(NAMES, ("chi",), ("a", "b", "c"), {"q1": 1, "q2": 1, "q3": 2, "chi": 1}, spare=2)
        forms = [
            LinearForm((("q1", Fraction(1)), ("q2", Fraction(1)))),
            LinearForm((("q1", Fraction(1)), ("q2", Fraction(-1)))),
            LinearForm((("chi", Fraction(-1)), ("q2", Fraction(1)))),
            LinearForm((("chi", Fraction(1)), ("q1", Fraction(2)), ("q3", Fraction(1, 2)))),
        ]
        made = ring.zero
        for k, form in enumerate(forms):
            made = made + ring.sin_cos(form)[k % 2] * ring.generator("parameter", "abca"[k])
        with angles_as("sums"):
            for k in order:  # first singly, in different orders
                python_text(ring, ring.reduce(ring.sin_cos(forms[k])[k % 2] * ring.generator("velocity", "q1")))
            texts.append(python_text(ring, ring.reduce(made)))
    assert texts[0] == texts[1]
    for wave in ("sin(q1 + q2)", "cos(q1 - q2)", "sin(q2 - chi)", "cos(2*q1 + q3/2 + chi)"):
        assert wave in texts[0]
