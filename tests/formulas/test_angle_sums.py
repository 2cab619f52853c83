"""Sums of angles: the same value as the products of the ring, and what papers and textbooks print."""

from __future__ import annotations

import random
from fractions import Fraction

from hypothesis import given, settings
from hypothesis import strategies as st

from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.angles import LinearForm
from mbsym.formulas.shape import Factor, Sum, Wave, present

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


@settings(max_examples=150, deadline=None)
@given(seed=st.integers(0, 10**9), terms=st.integers(0, 6), choice=st.sampled_from(["sums", "shorter"]))
def test_sums_of_angles_are_the_same_element_of_the_ring(seed, terms, choice):
    source = random.Random(seed)
    for made in (fourier(source, terms), products(source, 2 * terms)):
        assert (element(present(RING, made, choice)) - made).is_zero()
