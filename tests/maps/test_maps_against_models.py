"""Every map of the gallery against a model that owes nothing to the program.

The models are characteristic polynomials from publications, or derived by hand below, at random rational points of the
map; their roots are counted exactly by Routh's array, or by Sturm's chain in S**2 where there is no friction.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction as F
from functools import cache
from itertools import pairwise
from pathlib import Path
from random import Random
from typing import Any

import pytest

import mbsym
from mbsym.maps.mapping import exact_map
from mbsym.maps.result import Lack, Map, Shape
from mbsym.maps.section import Axis
from mbsym.problems.stability.words import Word

#: Coefficients from the highest to the lowest.
Polynomial = list[F]
BICYCLE = json.loads(Path("tests/references/bicycle_whipple.json").read_text())["reference"]


# --- counting ---------------------------------------------------------------------------------------------------------


def remainder(a: Polynomial, b: Polynomial) -> Polynomial:
    a = list(a)
    while len(a) >= len(b):
        ratio = a[0] / b[0]
        a = [x - ratio * (b[k] if k < len(b) else 0) for k, x in enumerate(a)][1:]
    while a and not a[0]:
        a = a[1:]
    return a


def changes(signs: list[F]) -> int:
    kept = [x for x in signs if x]
    return sum(a * b < 0 for a, b in pairwise(kept))


def negative_roots(p: Polynomial) -> int:
    """Sturm's theorem on (-oo, 0); p has no multiple root and p(0) is not 0."""
    chain = [p, [x * (len(p) - 1 - k) for k, x in enumerate(p[:-1])]]
    while len(chain[-1]) > 1:
        rest = remainder(chain[-2], chain[-1])
        assert rest, "a multiple root at a random point"
        chain.append([-x for x in rest])
    far = [x[0] * (-1) ** (len(x) - 1) for x in chain]
    return changes(far) - changes([x[-1] for x in chain])


def routh(p: Polynomial) -> int:
    """Roots to the right: changes of sign in the first column of Routh's array, none of which is 0."""
    upper, lower, first = p[0::2], p[1::2], []
    while upper:
        assert upper[0], "a zero in Routh's array at a random point"
        first.append(upper[0])
        if not lower:
            break
        ratio = upper[0] / lower[0]
        tail = [x - ratio * (lower[k] if k < len(lower) else 0) for k, x in enumerate(upper)][1:]
        upper, lower = lower, tail
    assert len(first) == len(p)
    return changes(first)


def to_the_right(p: Polynomial) -> int:
    """Of a polynomial in S; in S**2 each root that is not negative or is not real has one root to the right."""
    if any(p[1::2]):
        return routh(p)
    return len(p[0::2]) - 1 - negative_roots(p[0::2])


def product(*factors: Polynomial) -> Polynomial:
    whole = [F(1)]
    for one in factors:
        made = [F(0)] * (len(whole) + len(one) - 1)
        for i, a in enumerate(whole):
            for j, b in enumerate(one):
                made[i + j] += a * b
        whole = made
    return whole


def total(*terms: Polynomial) -> Polynomial:
    length = max(map(len, terms))
    padded = [[F(0)] * (length - len(x)) + x for x in terms]
    return [sum(column, F(0)) for column in zip(*padded, strict=True)]


@pytest.mark.parametrize(
    ("p", "right"),
    [([1, 6, 11, 6], 0), ([1, -6, 11, -6], 3), ([1, 3, 3, 6, 7], 2), ([1, 0, 5, 0, 4], 0), ([1, 0, -5, 0, 4], 2)],
)
def test_the_counting_itself(p: list[int], right: int) -> None:
    """(S + 1)(S + 2)(S + 3) and its mirror image; the first column 1, 3, 1, -15, 7; (S^2 +- 1)(S^2 +- 4)."""
    assert to_the_right([F(x) for x in p]) == right


# --- models -----------------------------------------------------------------------------------------------------------

Values = Mapping[str, F]


def gyrostat(A: F, B: F, C: F, h: F) -> list[Polynomial]:
    """Pitch; roll and yaw; A along the velocity, B along the normal, C along the radius (Gutnik & Sarychev).

    references/orbit-gyrostat-and-clebsch, section 3.1.
    """
    middle = h**2 + (2 * B - A - C) * h + B**2 - A * B + 2 * A * C + 2 * B * C - 3 * C**2
    return [[B, F(0), 3 * (A - C)], [A * C, F(0), middle, F(0), (B - A + h) * (4 * (B - C) + h)]]


def rigid(v: Values) -> list[Polynomial]:
    """DeBra & Delp (1961) by their ratios kR = (Iy - Iz)/Ix, kY = (Iy - Ix)/Iz: Iy = C about the normal, Iz = B."""
    x, y, z = v["A"], F(1), v["B"]
    roll, yaw = (y - z) / x, (y - x) / z
    return [[y, F(0), 3 * (x - z)], [F(1), F(0), 1 + 3 * roll + roll * yaw, F(0), 4 * roll * yaw]]


def ziegler(v: Values) -> list[Polynomial]:
    """M = [[3, 1], [1, 1]], D = [[b1 + b2, -b2], [-b2, b2]], K = [[2 - p, p - 1], [-1, 1]] (Kirillov & Verhulst)."""
    p, b1, b2 = F(9, 5), v["b1"], v["b2"]
    return [[F(2), b1 + 6 * b2, 7 - 2 * p + b1 * b2, b1 + b2, F(1)]]


def orbital_gyrostat(v: Values) -> list[Polynomial]:
    return gyrostat(v["A"], F(5), F(3), v["h"])


def damper(v: Values) -> list[Polynomial]:
    """(S^2 + L^2)(S^2 + dc S + p2) - e (S^2 + w^2)(S^2 + L w); dc = 2/5, p2 = 20, e = 1/20 (Shchepakina & Sobolev)."""
    rate, spin, e, one, zero = v["Lambda"], v["omega"], F(1, 20), F(1), F(0)
    held = product([one, zero, rate**2], [one, F(2, 5), F(20)])
    return [total(held, product([-e], [one, zero, spin**2], [one, zero, rate * spin]))]


def top(v: Values) -> list[Polynomial]:
    """Sleeping: A z'' - i C W z' - m g l z = 0 with z = alpha + i beta; A = 3/10, C = 1/10, m = 1, g = 981/100."""
    A, C, fall = F(3, 10), F(1, 10), F(981, 100) * v["l"]
    return [total(product([A, F(0), -fall], [A, F(0), -fall]), [(C * v["Omega"]) ** 2, F(0), F(0)])]


def gyroscope(v: Values) -> list[Polynomial]:
    """Satellite (A, B, C) with a gimbal about the velocity (Jx, Jy, Jz), by hand.

    A body of moments a (velocity), b (normal), c (radius) and momentum h has for small angles f about the velocity and
    y about the radius L = a (f' + y)^2/2 + c (y' - f)^2/2 + (b + h)(y' f - (f^2 + y^2)/2) - 3 (b - c) f^2/2, so
    a f'' + g y' + (4 (b - c) + h) f = 0, c y'' - g f' + (b - a + h) y = 0 with g = a + c - b - h.  The rotor has the
    angle u = f + beta in place of f; spring and friction k beta + d beta' act between f and u.
    """
    A, B, C, Jx, Jy, Jz, d = F(4), F(5), F(3), F(1, 5), F(1, 5), F(1, 10), F(3, 10)
    h, k, zero = v["h"], v["k"], F(0)
    first = [A, d, 4 * (B - C) + k]
    second = [Jx, d, 4 * (Jz - Jy) + h + k]
    third = [C + Jy, zero, B + Jz - A - Jx + h]
    joint, g1, g2 = [d, k], A + C - B, Jx + Jy - Jz - h
    inner = total(product(first, second), product([F(-1)], joint, joint))
    mixed = total([g1**2 * x for x in second], [g2**2 * x for x in first], [2 * g1 * g2 * x for x in joint])
    return [[B + Jz, zero, 3 * (A + Jx - C - Jy)], total(product(third, inner), product([F(1), zero, zero], mixed))]


def bicycle(v: Values) -> list[Polynomial]:
    """Roll and steer with the published M, C1, K0, K2 (14 digits); M q'' + v C1 q' + (g K0 + v^2 K2) q = 0."""
    speed, g = v["v"], F(981, 100)

    def entry(i: int, j: int) -> Polynomial:
        m, c, k0, k2 = (F(BICYCLE[name][i][j]) for name in ("M", "C1", "K0", "K2"))
        return [m, speed * c, g * k0 + speed**2 * k2]

    crossed = product([F(-1)], entry(0, 1), entry(1, 0))
    return [total(product(entry(0, 0), entry(1, 1)), crossed)]


def triangular(v: Values) -> list[Polynomial]:
    """S^4 + S^2 + 27/4 mu (1 - mu) in the plane, S^2 + 1 out of it (Szebehely, section 5.4)."""
    one, zero = F(1), F(0)
    return [[one, zero, one, zero, F(27, 4) * v["mu"] * (1 - v["mu"])], [one, zero, one]]


def everywhere(_: Values) -> bool:
    return True


def triangle(v: Values) -> bool:
    a, b = v["A"], v["B"]
    return a + b > 1 and b + 1 > a and 1 + a > b


def gyrostats_triangle(v: Values) -> bool:
    return 2 < v["A"] < 8


@dataclass(frozen=True)
class Case:
    """``stable``: the words that are given where no root is to the right; ``real``: where the body can be made."""

    name: str
    axes: tuple[tuple[str, str, str], ...]
    model: Callable[[Values], list[Polynomial]]
    stable: frozenset[Word]
    settings: tuple[tuple[str, str], ...] = ()
    real: Callable[[Values], bool] = everywhere
    many: int = 20_000


#: The maps of ``make gallery`` with their axes; the last two are shipped beside them.
CASES = [
    Case(
        "gravity-gradient",
        (("A", "0", "2"), ("B", "0", "2")),
        rigid,
        frozenset({Word.STABLE, Word.GYROSCOPIC}),
        (("C", "1"),),
        triangle,
    ),
    Case(
        "ziegler-damped",
        (("b1", "0", "1/5"), ("b2", "0", "1/5")),
        ziegler,
        frozenset({Word.ASYMPTOTIC}),
        (("P", "9/5"),),
    ),
    Case(
        "orbital-gyrostat",
        (("h", "-9", "9"), ("A", "2", "8")),
        orbital_gyrostat,
        frozenset({Word.STABLE, Word.GYROSCOPIC}),
        (),
        gyrostats_triangle,
    ),
    Case(
        "satellite-with-damper",
        (("omega", "0", "5"), ("Lambda", "0", "2")),
        damper,
        frozenset({Word.ASYMPTOTIC_BUT_TURNED}),
    ),
    Case("heavy-top", (("Omega", "0", "100"), ("l", "0", "1/2")), top, frozenset({Word.GYROSCOPIC})),
    Case("bicycle", (("v", "0", "10"),), bicycle, frozenset({Word.ASYMPTOTIC_BUT_STEADY})),
    Case("triangular-points", (("mu", "0", "1/2"),), triangular, frozenset({Word.STABLE})),
    Case(
        "satellite-with-gyroscope", (("h", "-2", "2"), ("k", "0", "2")), gyroscope, frozenset({Word.STABLE}), many=4_000
    ),
]
NAMES = [case.name for case in CASES]


@cache
def made(name: str) -> Map:
    case = CASES[NAMES.index(name)]
    analysis = mbsym.load(f"systems/{name}.yaml")
    axes = [Axis(axis, F(low), F(high)) for axis, low, high in case.axes]
    settings = {k: F(v) for k, v in case.settings}
    return exact_map(analysis, axes, settings)


def random_points(case: Case, number: int, seed: int) -> list[dict[str, F]]:
    """In the open box; the denominator is a prime, so that no border of small numbers is met."""
    random, prime = Random(seed), 100_003

    def inside(low: str, high: str) -> F:
        return F(low) + (F(high) - F(low)) * F(random.randint(1, prime - 1), prime)

    return [{axis: inside(low, high) for axis, low, high in case.axes} for _ in range(number)]


def disagreements(case: Case, points: list[dict[str, F]]) -> tuple[list[Any], set[Word]]:
    """Points at which the map and the model differ, and the words that were met."""
    found, wrong, seen = made(case.name), [], set()
    for point in points:
        cell = found.at(*point.values())
        assert cell is not None
        assert cell.shape in (Shape.REGION, Shape.INTERVAL)
        if not case.real(point):
            agree = cell.lack is Lack.OUTSIDE
        elif cell.judged is None or cell.word is None:
            agree = False
        else:
            right = sum(map(to_the_right, case.model(point)))
            seen.add(cell.word)
            words = {Word.UNSTABLE} if right else case.stable
            agree = cell.judged.right == right and cell.word in words
        if not agree:
            wrong.append((point, cell))
    return wrong, seen


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_maps_agree_with_exact_counts(case: Case) -> None:
    """Every word that the model allows is met, so that no comparison is empty."""
    wrong, seen = disagreements(case, random_points(case, 400, 7))
    assert not wrong
    assert seen == {Word.UNSTABLE, *case.stable}


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_maps_agree_at_many_points(case: Case) -> None:
    """Twenty thousand; fewer where one count takes more than a millisecond."""
    wrong, _ = disagreements(case, random_points(case, case.many, 11))
    assert not wrong


def test_a_wrong_sign_in_a_model_is_met() -> None:
    """The comparison is sharp: Ziegler's b1*b2 taken with the other sign moves the border, and is found out."""
    case = CASES[NAMES.index("ziegler-damped")]

    def mistaken(v: Values) -> list[Polynomial]:
        (p,) = ziegler(v)
        return [[*p[:2], p[2] - 2 * v["b1"] * v["b2"], *p[3:]]]

    wrong, _ = disagreements(
        Case(case.name, case.axes, mistaken, case.stable, case.settings), random_points(case, 400, 7)
    )
    assert wrong


def test_the_wedge_of_small_damping_is_the_published_one() -> None:
    """p = (4 b1^2 + 33 b1 b2 + 4 b2^2)/(2 (b1^2 + 7 b1 b2 + 6 b2^2)) + b1 b2/2 is the border, also where b is 1e-6."""
    found, p = made("ziegler-damped"), F(9, 5)
    for scale in (F(1, 10), F(1, 10**6)):
        for ratio in (F(1, 20), F(1, 3), F(1), F(3), F(15, 2), F(19, 2)):
            b1, b2 = scale * ratio / 10, scale / 10
            critical = (4 * b1**2 + 33 * b1 * b2 + 4 * b2**2) / (2 * (b1**2 + 7 * b1 * b2 + 6 * b2**2)) + b1 * b2 / 2
            cell = found.at(b1, b2)
            assert cell is not None
            assert cell.word is (Word.ASYMPTOTIC if p < critical else Word.UNSTABLE)
