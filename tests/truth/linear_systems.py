"""Random linear systems whose stability is known because they were built from blocks that can be solved by hand.

In coordinates y a system consists of blocks; with y = T x, T rational and regular, the coordinates x of the description
couple them.  Each block is solved by its characteristic roots in closed form:

* oscillator   y'' + d y' + k y = 0
* gyroscopic   z'' - i g z' + k z = 0,  z = y1 + i y2:   lambda = i (g +- sqrt(g^2 + 4 k)) / 2
* circulatory  z'' + d z' + (k + i n) z = 0:             all roots to the left iff d > 0 and k d^2 > n^2
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from scipy.linalg import expm
from truth.statements import Known

#: From the worst to the best: what a whole is, is the worst that a part is.
NATURES = ("unstable", "stable", "asymptotic")


@dataclass(frozen=True)
class Block:
    """``nature``, and damping D, gyroscopic G, stiffness K, circulatory N of y'' + (D + G) y' + (K + N) y = 0."""

    nature: str
    D: tuple[tuple[Fraction, ...], ...]
    G: tuple[tuple[Fraction, ...], ...]
    K: tuple[tuple[Fraction, ...], ...]
    N: tuple[tuple[Fraction, ...], ...]

    @property
    def size(self) -> int:
        return len(self.D)


def _diagonal(value: Fraction, n: int) -> tuple[tuple[Fraction, ...], ...]:
    return tuple(tuple(value if i == j else Fraction(0) for j in range(n)) for i in range(n))


def _turning(value: Fraction) -> tuple[tuple[Fraction, ...], ...]:
    return ((Fraction(0), -value), (value, Fraction(0)))


def oscillator(d: Fraction, k: Fraction) -> Block:
    """Roots of lambda^2 + d lambda + k."""
    if d < 0 or k < 0 or (d == 0 and k == 0):
        nature = "unstable"  # a root to the right, or y = c t
    elif d > 0 and k > 0:
        nature = "asymptotic"
    else:
        nature = "stable"  # an undamped oscillation, or a displacement that stays
    zero = _diagonal(Fraction(0), 1)
    return Block(nature, _diagonal(d, 1), zero, _diagonal(k, 1), zero)


def gyroscopic(g: Fraction, k: Fraction) -> Block:
    """Two different imaginary roots iff g^2 + 4 k > 0; equal ones make a Jordan block and y grows."""
    nature = "stable" if g * g + 4 * k > 0 else "unstable"
    zero = _diagonal(Fraction(0), 2)
    # y1'' + g y2' + k y1 = 0, y2'' - g y1' + k y2 = 0
    return Block(nature, zero, _turning(-g), _diagonal(k, 2), zero)


def circulatory(d: Fraction, k: Fraction, n: Fraction) -> Block:
    """z'' + d z' + (k + i n) z = 0; on the border k d^2 = n^2 > 0 one root pair is imaginary and simple."""
    if d > 0 and k * d * d >= n * n:
        nature = "asymptotic" if k * d * d > n * n else "stable"
    else:
        nature = "unstable"
    zero = _diagonal(Fraction(0), 2)
    return Block(nature, _diagonal(d, 2), zero, _diagonal(k, 2), _turning(n))


def whole(blocks: Sequence[Block]) -> str:
    """The nature of independent blocks side by side: that of the worst."""
    return min((block.nature for block in blocks), key=NATURES.index)


def random_system(seed: int) -> Known:
    """A description of some blocks: side by side where the seed is odd, else in coordinates that mix them."""
    source = random.Random(seed)
    small = [Fraction(x) for x in (0, 0, 1, 1, 2, Fraction(1, 2), Fraction(3, 2), -1)]
    blocks: list[Block] = []
    while sum(block.size for block in blocks) < source.choice((1, 2, 3)):
        d, k, n = source.choice(small), source.choice([*small, Fraction(1), Fraction(4)]), source.choice(small[2:])
        kind = source.choice(("oscillator", "oscillator", "oscillator", "gyroscopic", "circulatory"))
        if kind == "oscillator":
            block = oscillator(d, k)
            blocks += [block] * source.choice((1, 1, 1, 2))  # equal roots must be judged, too
        elif kind == "gyroscopic":
            blocks.append(gyroscopic(source.choice((Fraction(1), Fraction(2), Fraction(5, 2))), source.choice(small)))
        else:
            blocks.append(circulatory(source.choice((Fraction(1), Fraction(2), d)), k, n))
    return described(f"random linear system {seed}", blocks, source, mixed=seed % 2 == 0)


def described(name: str, blocks: Sequence[Block], source: random.Random, mixed: bool) -> Known:
    """The description in coordinates x with y = T x."""
    size = sum(block.size for block in blocks)
    matrices = {letter: _assembled([getattr(block, letter) for block in blocks], size) for letter in "DGKN"}
    T = _regular(source, size)
    if not mixed:
        T = [[Fraction(int(i == j)) for j in range(size)] for i in range(size)]
    y = [" + ".join(f"({T[i][j]})*x{j}" for j in range(size)) for i in range(size)]
    rate = [" + ".join(f"({T[i][j]})*x{j}_dot" for j in range(size)) for i in range(size)]
    first = [next(i for i in range(size) if T[i][j]) for j in range(size)]  # the first point that x_j moves
    bodies = [
        f'  - name: point {i}\n    attached to: 0\n    connection point: ["{y[i]}", 0, 0]\n    mass: 1\n'
        + (f"    coordinates: [{', '.join(f'x{j}' for j in range(size) if first[j] == i)}]\n" if i in first else "")
        for i in range(size)
    ]
    loads = []
    if any(any(row) for row in matrices["K"]):
        loads.append(f'  - potential: "{_form(matrices["K"], y)}"\n')
    if any(any(row) for row in matrices["D"]):
        loads.append(f'  - rayleigh: "{_form(matrices["D"], rate)}"\n')
    forces = [
        " + ".join(f"({-matrices[m][i][j]})*({v[j]})" for m, v in (("G", rate), ("N", y)) for j in range(size)
                   if matrices[m][i][j])
        for i in range(size)
    ]  # fmt: skip
    if any(forces):
        shares = [
            " + ".join(f"({T[i][k]})*({forces[i]})" for i in range(size) if forces[i] and T[i][k]) for k in range(size)
        ]
        loads.append("  - generalized force: {" + ", ".join(f'x{k}: "{s}"' for k, s in enumerate(shares) if s) + "}\n")
    text = "mbsym: 1\nname: linear\nbodies:\n" + "".join(bodies)
    text += ("loads:\n" + "".join(loads)) if loads else ""
    text += "motion: {" + ", ".join(f"x{j}: 0" for j in range(size)) + "}\n"
    return Known(name, text, _named(blocks), decided=False, motion=_solution(matrices, T))


def _named(blocks: Sequence[Block]) -> str:
    """How the nature is written among the statements: a coordinate on which nothing acts at all may be cyclic."""
    idle = [b for b in blocks if b.size == 1 and b.K[0][0] == 0 and b.D[0][0] >= 0]
    others = [b for b in blocks if b not in idle]
    rest = whole(others) if others else "asymptotic" if any(b.D[0][0] for b in idle) else "stable"
    if idle and rest != "unstable":
        if any(b.D[0][0] == 0 for b in idle):
            return "drifts" if rest == "stable" else "asymptotic, drifts"
        return "stable, displaced" if rest == "stable" else "asymptotic, displaced"
    nature = whole(blocks)
    turning = any(b.G[0][-1] != 0 and b.K[0][0] <= 0 for b in blocks if b.size == 2)
    return "stable, gyroscopic" if nature == "stable" and turning else nature


def _assembled(parts: Sequence[tuple[tuple[Fraction, ...], ...]], size: int) -> list[list[Fraction]]:
    rows = [[Fraction(0)] * size for _ in range(size)]
    at = 0
    for part in parts:
        for i, row in enumerate(part):
            for j, value in enumerate(row):
                rows[at + i][at + j] = value
        at += len(part)
    return rows


def _regular(source: random.Random, n: int) -> list[list[Fraction]]:
    """Lower times upper triangular, with ones on the diagonals: determinant 1."""
    low = [[Fraction(int(i == j)) if j >= i else Fraction(source.randint(-1, 1)) for j in range(n)] for i in range(n)]
    high = [[Fraction(int(i == j)) if j <= i else Fraction(source.randint(-1, 1), 2) for j in range(n)]
            for i in range(n)]  # fmt: skip
    return [[sum((low[i][k] * high[k][j] for k in range(n)), Fraction(0)) for j in range(n)] for i in range(n)]


def _form(matrix: list[list[Fraction]], of: Sequence[str]) -> str:
    """1/2 sum a_ij v_i v_j."""
    n = range(len(of))
    return " + ".join(f"({matrix[i][j] / 2})*({of[i]})*({of[j]})" for i in n for j in n if matrix[i][j])


def _solution(matrices: dict[str, list[list[Fraction]]], T: list[list[Fraction]]):  # type: ignore[no-untyped-def]
    n = len(T)
    floats = {letter: np.array([[float(x) for x in row] for row in rows]) for letter, rows in matrices.items()}
    turn = np.array([[float(x) for x in row] for row in T])
    field = np.block([[np.zeros((n, n)), np.eye(n)], [-(floats["K"] + floats["N"]), -(floats["D"] + floats["G"])]])
    mixed = np.block([[turn, np.zeros((n, n))], [np.zeros((n, n)), turn]])
    unmixed = np.linalg.inv(mixed)

    def motion(time: float, start: np.ndarray) -> np.ndarray:
        found: np.ndarray = unmixed @ expm(field * time) @ mixed @ start
        return found

    return motion
