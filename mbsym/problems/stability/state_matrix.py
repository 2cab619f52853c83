"""The matrix of  (q, v)' = A (q, v)  of a linear form in which some coordinates follow by equations of first order.

With coordinates p that have speeds v = p' and coordinates f that follow, q = (p, f),

    M v' + C_p v + K_p q = 0,        C_ff f' + C_fp v + K_f q = 0,

the rows and columns of f in M, and the columns of f in C_p, being zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

Rows = Sequence[Sequence[Any]]


def state_matrix(kind: Any, m: Rows, c: Rows, k: Rows, following: Sequence[int] = ()) -> Any:
    """A, square of size n + (n - len(following)), the coordinates first; ``kind`` is fmpq_mat or arb_mat.

    Raises ZeroDivisionError where M, without what follows, or C_ff is singular.
    """
    n = len(m)
    moving = [i for i in range(n) if i not in following]

    def block(rows: Rows, lines: Sequence[int], columns: Sequence[int]) -> Any:
        return kind(len(lines), len(columns), [rows[i][j] for i in lines for j in columns])

    whole, every = kind(n + len(moving), n + len(moving)), range(n)
    for place, i in enumerate(moving):
        whole[i, n + place] = 1
    for lines, leading, offset in ((moving, m, n), (following, c, None)):
        if not lines:
            continue
        own = block(leading, lines, lines)
        by_place, by_speed = own.solve(block(k, lines, every)), own.solve(block(c, lines, moving))
        for a, i in enumerate(lines):
            row = i if offset is None else offset + a
            for j in every:
                whole[row, j] = -by_place[a, j]
            for b in range(len(moving)):
                whole[row, n + b] = -by_speed[a, b]
    return whole
