"""Maps of satellites with one and two gimballed gyroscopes against matrices by hand; what friction does to them.

The Lagrangian of small angles f (about the velocity) and y (about the radius) of a body of moments a, b, c (velocity,
normal, radius) and momentum h is that of ``test_maps_against_models.gyroscope``; bodies and gimbals add.
"""

from __future__ import annotations

from fractions import Fraction as F
from random import Random
from typing import Any

import pytest

import mbsym
from mbsym.maps.mapping import exact_map
from mbsym.maps.result import Map, Shape
from mbsym.maps.section import Axis
from mbsym.problems.stability.words import Word
from tests.maps.test_maps_against_models import Polynomial, Values, product, to_the_right, total


def determinant(rows: list[list[Polynomial]]) -> Polynomial:
    """By the first row."""
    if len(rows) == 1:
        return rows[0][0]
    terms = [
        product([F((-1) ** j)], entry, determinant([row[:j] + row[j + 1 :] for row in rows[1:]]))
        for j, entry in enumerate(rows[0])
        if any(entry)
    ]
    found = total([F(0)], *terms)
    while len(found) > 1 and not found[0]:
        found = found[1:]
    return found


def system(
    mass: list[F], gyro: dict[tuple[int, int], F], stiff: list[F], springs: list[tuple[int, int, F, F]]
) -> Polynomial:
    """det of M S^2 + (D + G) S + K: springs (i, j, k, d) between coordinates, gyro[i, j] = -gyro[j, i]."""
    n = len(mass)
    rows = [[[F(0), F(0), F(0)] for _ in range(n)] for _ in range(n)]
    for i in range(n):
        rows[i][i] = [mass[i], F(0), stiff[i]]
    for (i, j), g in gyro.items():
        rows[i][j][1] += g
        rows[j][i][1] -= g
    for i, j, k, d in springs:
        for p, q, sign in ((i, i, 1), (j, j, 1), (i, j, -1), (j, i, -1)):
            rows[p][q][1] += sign * d
            rows[p][q][2] += sign * k
    return determinant(rows)


def one(v: Values) -> Polynomial:
    """Coordinates f, u = f + beta, y."""
    A, B, C, Jx, Jy, Jz, h = (v[name] for name in ("A", "B", "C", "Jx", "Jy", "Jz", "h"))
    return system(
        [A, Jx, C + Jy],
        {(0, 2): A + C - B, (1, 2): Jx + Jy - Jz - h},
        [4 * (B - C), 4 * (Jz - Jy) + h, B + Jz - A - Jx + h],
        [(0, 1, v["k"], v["d"])],
    )


def two(v: Values) -> Polynomial:
    """Coordinates f, u = f + beta, y, w = y + gamma; the second gyroscope has Jy about the velocity.

    That gamma turns after f changes the attitude by f gamma about the normal: a total derivative in L.
    """
    A, B, C, Jx, Jy, Jz, h1, h2 = (v[name] for name in ("A", "B", "C", "Jx", "Jy", "Jz", "h1", "h2"))
    return system(
        [A + Jy, Jx, C + Jy, Jx],
        {(0, 2): A + C - B, (1, 2): Jx + Jy - Jz - h1, (0, 3): Jx + Jy - Jz - h2},
        [4 * (B - C) + 4 * (Jz - Jx) + h2, 4 * (Jz - Jy) + h1, B - A + Jz - Jx + h1, Jz - Jy + h2],
        [(0, 1, v["k1"], v["d1"]), (2, 3, v["k2"], v["d2"])],
    )


BODY = {"A": F(4), "B": F(5), "C": F(3), "Jx": F(1, 5), "Jy": F(1, 5), "Jz": F(1, 10)}


def mapped(name: str, axes: list[Axis], **settings: Any) -> Map:
    return exact_map(mbsym.load(f"systems/{name}.yaml"), axes, {k: F(v) for k, v in settings.items()})


def test_two_gyroscopes_against_the_matrices_by_hand() -> None:
    """Along the stiffness of the second gimbal, whose rotor is turned against the normal: h1 = 9/5, h2 = -1.

    Pitch, (B + 2 Jz) S^2 + 3 (A - C), is stable, as A > C.
    """
    fixed = {**BODY, "h1": F(9, 5), "h2": F(-1), "k1": F(1), "d1": F(3, 10), "d2": F(1, 5)}
    analysis = mbsym.load("systems/satellite-with-two-gyroscopes.yaml")
    found = exact_map(analysis, [Axis("k2", F(0), F(2))], {"h1": F(9, 5), "h2": F(-1)})
    random, words = Random(5), set()
    for _ in range(150):
        place = 2 * F(random.randint(1, 10_006), 10_007)
        cell = found.at(place)
        assert cell is not None
        assert cell.judged is not None
        right = to_the_right(two({**fixed, "k2": place}))
        assert (cell.judged.right, cell.word) == (right, Word.UNSTABLE if right else Word.STABLE)
        words.add(cell.word)
    assert words == {Word.UNSTABLE, Word.STABLE}


@pytest.fixture(scope="module")
def friction() -> Map:
    """A satellite whose K has two negative eigenvalues where h < 0 is large: its rotor alone holds it."""
    axes = [Axis("h", F(-20), F(0)), Axis("d", F(0), F(1))]
    return mapped("satellite-with-gyroscope", axes, A=6, B=6, C=4, k=40)


def test_friction_in_the_gimbal_ends_what_the_rotor_holds(friction: Map) -> None:
    """Kelvin-Chetaev, exactly: on d = 0 and at d = 1e-9 beside it, by roots of the matrices by hand."""
    body, random, words = {**BODY, "A": F(6), "B": F(6), "C": F(4), "k": F(40)}, Random(9), set()
    for _ in range(60):
        h = -20 * F(random.randint(1, 10_006), 10_007)
        for d in (F(0), F(1, 10**9), F(random.randint(1, 10_000), 10_007)):
            right = to_the_right(one({**body, "h": h, "d": d}))
            cell = friction.at(h, d)
            assert cell is not None
            assert cell.judged is not None
            assert cell.judged.right == right
            assert (cell.word is Word.UNSTABLE) == (right > 0)
            if d == 0:
                assert cell.shape is Shape.ARC
                words.add(cell.word)
            else:
                assert cell.word is Word.UNSTABLE
    assert words == {Word.GYROSCOPIC, Word.UNSTABLE}


def test_a_mistake_in_the_matrices_is_met(friction: Map) -> None:
    """With the gyroscopic term of the satellite's own frame, A + C - B, of the other sign, the border moves."""
    values = {**BODY, "A": F(6), "B": F(6), "C": F(4), "k": F(40), "d": F(0)}
    wrong = 0
    for step in range(1, 100):
        h = F(-20) + F(step * 2000, 10_007)
        A, B, C, Jx, Jy, Jz = (values[name] for name in ("A", "B", "C", "Jx", "Jy", "Jz"))
        mistaken = system(
            [A, Jx, C + Jy],
            {(0, 2): B - A - C, (1, 2): Jx + Jy - Jz - h},
            [4 * (B - C), 4 * (Jz - Jy) + h, B + Jz - A - Jx + h],
            [(0, 1, values["k"], values["d"])],
        )
        cell = friction.at(h, F(0))
        assert cell is not None
        assert cell.judged is not None
        wrong += cell.judged.right != to_the_right(mistaken)
    assert wrong
