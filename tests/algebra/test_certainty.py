"""The law of how surely statements are known together."""

from __future__ import annotations

from itertools import product

from mbsym.algebra.certainty import Certainty


def test_together_statements_are_as_sure_as_the_weakest() -> None:
    """& is a semilattice: commutative, associative, idempotent; PROVED is its unit, UNDECIDED absorbs."""
    for a, b, c in product(Certainty, repeat=3):
        assert a & b == b & a
        assert a & (b & c) == (a & b) & c
    for a in Certainty:
        assert a & a is a
        assert a & Certainty.PROVED is a
        assert a & Certainty.UNDECIDED is Certainty.UNDECIDED


def test_nothing_that_was_only_measured_is_told_as_proved() -> None:
    assert Certainty.PROVED & Certainty.VERIFIED & Certainty.MEASURED is Certainty.MEASURED
    assert Certainty.MEASURED & Certainty.ESTIMATED is Certainty.ESTIMATED
