"""Sets of parameters: what is said of their emptiness, by hand and against points of a grid."""

from __future__ import annotations

import random
from fractions import Fraction
from itertools import product

import pytest
from flint import fmpq, fmpq_mpoly_ctx

from mbsym.algebra.semialgebraic import EVERYTHING, NOTHING, Atom, Emptiness, ParameterSet, atom, where
from mbsym.algebra.signs import Signs

CONTEXT = fmpq_mpoly_ctx.get(["a", "b", "c"])
A, B, C = CONTEXT.gens()
REAL = Signs(CONTEXT, ("real",) * 3)
POSITIVE = Signs(CONTEXT, ("positive", "nonnegative", "real"), ((1 - A, ">"),))


@pytest.mark.parametrize(
    ("conditions", "signs", "known"),
    [
        ([(A, ">"), (A, "<")], REAL, Emptiness.EMPTY),
        ([(A, ">="), (A, "<=")], REAL, Emptiness.INHABITED),  # a = 0
        ([(A, ">="), (A, "<="), (A, "!=")], REAL, Emptiness.EMPTY),
        ([(A * A - 2, "="), (A - 1, ">"), (A * 2 - 3, "<")], REAL, Emptiness.INHABITED),  # sqrt(2)
        ([(A * A - 2, "="), (A * 2 - 3, ">")], REAL, Emptiness.EMPTY),
        ([(A * A + B * B - 1, "<"), (A + B - 2, ">")], REAL, Emptiness.EMPTY),  # the line is sqrt(2) away
        ([(A * A + B * B - 1, "<"), (5 * A + 5 * B - 7, ">")], REAL, Emptiness.INHABITED),  # 7/5 < sqrt(2)
        ([(A * B * C - 1, "="), (A, "<"), (B, ">"), (C, ">")], REAL, Emptiness.EMPTY),
        ([(A * B - 1, "="), (A, "<")], REAL, Emptiness.INHABITED),
        ([(A - 1, ">")], POSITIVE, Emptiness.EMPTY),  # assumed: a < 1
        ([(B, "<=")], POSITIVE, Emptiness.INHABITED),  # b = 0 is allowed
        ([(B, "<")], POSITIVE, Emptiness.EMPTY),
        ([(A * A * A - B, ">"), (B - A, ">"), (A, ">"), (1 - A, ">")], REAL, Emptiness.EMPTY),  # a^3 < a there
    ],
)
def test_emptiness_by_hand(conditions: list[tuple[object, str]], signs: Signs, known: Emptiness) -> None:
    there = where(*(atom(p, relation) for p, relation in conditions))
    found, point = there.witness(signs)
    assert found is known
    assert there.is_empty(signs) is (known is Emptiness.EMPTY)
    if point is not None and all(isinstance(x, fmpq) for x in point.values()):
        assert there.holds([point.get(k, fmpq(1)) for k in range(3)])


def test_sets_and_their_complements() -> None:
    disc = where(atom(1 - A * A - B * B, ">"))
    band = where(atom(A, ">"), atom(1 - A, ">="))
    for one in (disc, band, disc | band, disc & band):
        assert (one & one.complement()).is_empty(REAL)
        assert (one | one.complement()).complement().is_empty(REAL)
    assert NOTHING.is_empty(REAL)
    assert not EVERYTHING.is_empty(REAL)
    # A border has no inner points: a >= 0 and a <= 0 has none, though it is not empty.
    line = where(atom(A, ">="), atom(-A, ">="))
    assert not line.is_empty(REAL)
    assert line.inner().is_empty(REAL)


def test_an_empty_set_holds_at_no_point_of_a_grid() -> None:
    source, grid = random.Random(26), [fmpq(k, 2) for k in range(-4, 5)]
    made = [A, B, A - B, A + B, A * B, A * A - B, A * A + B * B - 1, A * B - 1, A - 1, (A - B) ** 2]
    known = {Emptiness.EMPTY: 0, Emptiness.INHABITED: 0, Emptiness.OPEN: 0}
    for _ in range(150):
        pieces = [
            [(source.choice((-1, 1)) * source.choice(made), source.choice((">", ">=", ">", "!=", "=")))
             for _ in range(source.randint(1, 4))]
            for _ in range(source.randint(1, 2))
        ]  # fmt: skip
        there: ParameterSet = NOTHING
        for piece in pieces:
            there = there | where(*(atom(p, relation) for p, relation in piece))
        found, point = there.witness(REAL)
        known[found] += 1
        inside = [at for at in product(grid, grid) if there.holds((*at, fmpq(0)))]
        if found is Emptiness.EMPTY:
            assert not inside, (pieces, inside[0])
        if point is not None and all(isinstance(x, (fmpq, Fraction)) for x in point.values()):
            assert there.holds([point.get(k, fmpq(1)) for k in range(3)]), pieces
    assert known[Emptiness.EMPTY] > 15
    assert known[Emptiness.INHABITED] > 60


def test_a_long_polynomial_is_never_written_however_often_sets_are_joined() -> None:
    """Of a million terms, which took the conditions of a bicycle minutes."""

    class Long:
        def __len__(self) -> int:
            return 1_000_000

        def monomial(self, k: int) -> tuple[int, ...]:
            assert k == 0
            return (3, 1)

        def __str__(self) -> str:
            raise AssertionError

    there = ParameterSet(((Atom(Long(), ">"),),))  # type: ignore[arg-type]
    assert ((there & there) | (there & there & there)) == there
