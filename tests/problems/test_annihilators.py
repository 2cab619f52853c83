"""W B = 0 with W of full rank n - r: by hand where B is thin among many coordinates."""

from __future__ import annotations

from flint import Ordering, fmpq_mpoly_ctx

from mbsym.algebra.signs import Signs
from mbsym.problems.stabilisation import hautus

CONTEXT = fmpq_mpoly_ctx.get(("d", "e"), Ordering.lex)
KNOWN = Signs(CONTEXT, ("positive", "positive"), ())


def test_one_damper_among_thirty(monkeypatch) -> None:  # type: ignore[no-untyped-def]
    """D = diag(0, d, 0, ...): beta = d and W the other 29 rows d e_k; few determinants, none of them large."""
    d, zero, seen = CONTEXT.gen(0), CONTEXT.constant(0), []
    real = hautus.determinant

    def counted(rows):  # type: ignore[no-untyped-def]
        seen.append(len(rows))
        return real(rows)

    monkeypatch.setattr(hautus, "determinant", counted)
    rows = [[d if i == j == 1 else zero for j in range(30)] for i in range(30)]
    beta, spare = hautus.annihilator(rows, KNOWN, 30)
    assert beta == d
    assert spare == [[d if j == k else zero for j in range(30)] for k in range(30) if k != 1]
    assert max(seen) == 1
    assert len(seen) <= 30


def test_a_damper_between_two_coordinates_beside_others() -> None:
    """[[0, 0, 0], [0, d, -d], [0, -d, d]] has rank 1: W holds e_1 and e_2 + e_3, times beta."""
    d, zero = CONTEXT.gen(0), CONTEXT.constant(0)
    rows = [[zero, zero, zero], [zero, d, -d], [zero, -d, d]]
    beta, spare = hautus.annihilator(rows, KNOWN, 3)
    assert beta in (d, -d)
    assert spare == [[beta, zero, zero], [zero, beta, beta]]
    for line in spare:
        assert all(sum((line[i] * rows[i][j] for i in range(3)), zero) == 0 for j in range(3))


def test_no_input_at_all() -> None:
    zero, one = CONTEXT.constant(0), CONTEXT.constant(1)
    beta, spare = hautus.annihilator([[zero], [zero]], KNOWN, 2)
    assert (beta, spare) == (1, [[one, zero], [zero, one]])
