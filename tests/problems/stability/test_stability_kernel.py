"""The stability kernel against published conditions, thresholds and hard cases.

Expected values are from Banshchikov & Vetrov (satellite with a gravitational stabilizer), DeBra & Delp (gravity
gradient), Kirillov & Verhulst (Ziegler's pendulum), Merkin and Chetaev (gyroscopic systems), Wilkinson, and Routh
arrays in textbooks; nothing is copied from our own output.
"""

from __future__ import annotations

import random
from fractions import Fraction as F
from itertools import product
from typing import Any

import numpy as np
import pytest
import sympy
from flint import Ordering, fmpq, fmpq_mpoly_ctx, fmpq_poly, fmpz_mat
from hypothesis import assume, given
from hypothesis import strategies as st
from properties import settings

import mbsym
from mbsym.algebra import characteristic
from mbsym.algebra.characteristic import (
    characteristic_polynomial,
    determinant,
    discriminant,
    factor_in_lambda,
    hurwitz_minors,
    leading_minors,
    lienard_chipart,
    primitive,
    resultant,
    subdiscriminants,
)
from mbsym.algebra.failures import TooLargeError
from mbsym.algebra.roots import RootCount, count_real_roots, count_roots, enclosures, rational, univariate
from mbsym.algebra.signs import Signs
from mbsym.problems.stability import symbolic as theory
from mbsym.problems.stability.exact import RationalPoint, evaluated, inertia, verdict_at
from mbsym.problems.stability.linear_form import LinearSystem, kind_of
from mbsym.problems.stability.problem import _even
from mbsym.problems.stability.requirements import Case, Requirement, definiteness
from mbsym.problems.stability.symbolic import Theory, _implies, _spared, _without_implied, analyse
from mbsym.problems.stability.verdict import Verdict, combine, depends
from mbsym.problems.stability.words import Word

Matrix = Any


def ring(names: str) -> tuple[Any, list[Any]]:
    context = fmpq_mpoly_ctx.get(names.split(), Ordering.degrevlex)
    return context, list(context.gens())


def matrix(context: Any, rows: Any) -> Matrix:
    """Numbers become constants of the ring."""
    return tuple(tuple(context.constant(rational(e)) if isinstance(e, (int, F)) else e for e in row) for row in rows)


def linear(context: Any, conservative: bool = False, cyclic: tuple[int, ...] = (), **matrices: Any) -> LinearSystem:
    n = len(matrices["M"])
    zero = [[0] * n for _ in range(n)]
    m, d, g, k, s = (matrix(context, matrices.get(name, zero)) for name in "MDGKN")
    return LinearSystem(m, d, g, k, s, conservative, cyclic)


def signs(context: Any, words: str = "", *assumptions: Any) -> Signs:
    n = context.nvars()
    return Signs(context, tuple(words.split()) or ("real",) * n, tuple((p, ">") for p in assumptions))


def requirement(found: Theory, label: str) -> Any:
    (wanted,) = [r.polynomial for r in found.requirements if r.label == label]
    return wanted


# -- satellite with a gravitational stabilizer ------------------------------------------------------------------------

SATELLITE, (ALPHA, GAMMA, P1, P2) = ring("alpha gamma p1 p2")
V6 = (1 + GAMMA * ALPHA) * P1 - (ALPHA + 1) * P2
V4 = 3 * (1 + ALPHA * GAMMA) + (ALPHA + 1) * (P1 * (ALPHA + 3 * GAMMA + 2) - (ALPHA + 8) * P2)
V2 = (
    (1 + 3 * GAMMA + ALPHA * (ALPHA + 2 * GAMMA + 3)) * (3 + P1)
    + 4 * ALPHA * P1 * (GAMMA + ALPHA)
    - 8 * P2 * (ALPHA + 1) * (ALPHA + 2)
)
V0 = 4 * ALPHA * ((ALPHA + GAMMA) * (3 + P1) - 4 * (ALPHA + 1) * P2)
DIS = V4**2 * V2**2 - 4 * V2**3 * V6 - 4 * V4**3 * V0 + 18 * V6 * V4 * V2 * V0 - 27 * V0**2 * V6**2
PITCH_LAST = P1**2 * GAMMA**2 + (4 * P2 * (1 - P1) - 2 * P1) * GAMMA + (1 - 4 * P2 * (1 - P1))

PITCH = linear(SATELLITE, True, M=[[1, P2], [1, P1]], K=[[3 * GAMMA, 3 * P2], [3, 3]])
YAW_ROLL = linear(
    SATELLITE,
    True,
    M=[[1, 0, 0], [0, 1 + GAMMA * ALPHA, P2 * (ALPHA + 1)], [0, 1, P1]],
    G=[[0, ALPHA - 1, 0], [(ALPHA - 1) * (GAMMA - 1), 0, 0], [0, 0, 0]],
    K=[[ALPHA, 0, 0], [0, 4 * (ALPHA + GAMMA), 4 * P2 * (ALPHA + 1)], [0, 4, 3 + P1]],
)
#: -1 < alpha < 1, 0 < gamma < 1, 0 < p1 <= 1, 0 < p2 < 1
RANGES = Signs(
    SATELLITE,
    ("real", "positive", "positive", "positive"),
    ((1 - ALPHA, ">"), (1 + ALPHA, ">"), (1 - GAMMA, ">"), (1 - P1, ">="), (1 - P2, ">")),
)


def test_satellite_pitch_conditions_are_eq_5() -> None:
    found = analyse(PITCH, RANGES)
    assert found.kind == "conservative"
    assert found.characteristic[::2] == (9 * (GAMMA - P2), 3 * (1 + GAMMA * P1 - 2 * P2), P1 - P2)
    assert [r.label for r in found.requirements] == ["v4", "v2", "v0", "discriminant"]
    assert [c.polynomial for c in found.conditions] == [P1 - P2, 1 + GAMMA * P1 - 2 * P2, GAMMA - P2, PITCH_LAST]
    assert requirement(found, "discriminant") == 9 * PITCH_LAST
    # Lagrange: for a potential system K > 0 alone decides.
    (stable, unstable), k = found.cases, found.stiffness
    assert [r.condition.polynomial for r in k.requirements if not r.always] == [GAMMA - P2]
    assert (stable.verdict.word, stable.verdict.theorem) == ("stable", "Lagrange-Dirichlet")
    assert unstable.verdict.word == "unstable"
    assert found.verdict.word is Word.DEPENDS
    assert analyse(PITCH, RANGES.assuming([(GAMMA - P2, ">")])).verdict.word == "stable"
    assert analyse(PITCH, RANGES.assuming([(P2 - GAMMA, ">")])).verdict.word == "unstable"


def test_satellite_yaw_and_roll_conditions_are_eq_6() -> None:
    found = analyse(YAW_ROLL, RANGES)
    assert found.kind == "gyroscopic conservative"
    assert found.method == "all squares of roots real, negative and simple: coefficients and discriminants"
    assert found.characteristic == (V0, V0 * 0, V2, V0 * 0, V4, V0 * 0, V6)
    assert [r.label for r in found.requirements] == ["v6", "v4", "v2", "v0", "discriminant"]
    assert [r.polynomial for r in found.requirements] == [V6, V4, V2, V0, DIS]
    assert len(requirement(found, "discriminant")) == 376
    # The first condition holds "by virtue of the positive definiteness of the kinetic energy matrix".
    assert [r.by_mass for r in found.requirements] == [True, False, False, False, False]
    words = [case.verdict.word for case in found.cases]
    assert words == ["stable", "gyroscopically stabilised only", "unstable", "unstable"]
    assert [case.verdict.theorem for case in found.cases] == [
        "Routh",
        "",
        "Kelvin-Chetaev",
        "Lyapunov's first method",
    ]


POINTS = [
    (
        "2.090 1.951 2.150 0.383 0.513 2.494 0.372",
        "0.246568790407280481877139531314 1.74165317873636029311102822044 "
        "2.70786514713655558885955909117 0.0522055771891351863940562990903",
        "2.64423001183860838776060493155 0.0444997890604679793645211794013",
        ["-4.77099493966579702093804380411", "-2.27304025330590935375869513579", "-0.0195237264661941504864891763047"],
        ("stable", "Routh"),
    ),
    (
        "2.352 1.722 2.966 0.348 0.347 1.776 0.465",
        "0.457803696521985275094990204049 3.93050240923803326606873705784 "
        "8.40498664643350770630923311130 2.29615172127774291143110079628",
        "41.6055296251336385665288602018 0.176973718067618417204721244838",
        ["-5.30020562817221685558404260855", "-2.96634534080093382718311347840", "-0.319011880559841904103374407544"],
        ("stable", "Routh"),
    ),
    (
        "2.719 1.429 2.534 0.334 0.398 1.082 0.308",
        "0.504864114526015714211553705745 3.77561418106930619679410971281 "
        "6.02052137825567484109013190284 -0.622145365937170152288960468328",
        "78.7728263124034720967360812352 0.181118387061921784016182517830",
        ["-5.08630486386322050717242567772", "-2.48949166436532202604866023961", "0.0973204939118901827055410430621"],
        ("unstable", "Kelvin-Chetaev"),
    ),
]


def abcdf(parameters: str) -> tuple[F, ...]:
    jx, jy, jz, m, m0, l, r = map(F, parameters.split())
    b = jx + m * r * (l + r) + m * l**2 / 3 + m0 * (l + r) ** 2
    d = (m / 3 + m0) * l**2
    return jy, b, b + jz - jx, d, (m / 2 + m0) * r * l + d


@pytest.mark.parametrize(("parameters", "v", "discriminants", "roots", "verdict"), POINTS)
def test_satellite_at_points(
    parameters: str, v: str, discriminants: str, roots: list[str], verdict: tuple[str, str]
) -> None:
    a, b, c, d, f = abcdf(parameters)
    values = ((c - b) / a, (b - a) / c, d / f, f / c)
    point = dict(enumerate(values))
    exact = [rational(value) for value in values]
    dis, last = discriminants.split()
    for polynomial, digits in [*zip((V6, V4, V2, V0), v.split(), strict=True), (DIS, dis), (PITCH_LAST, last)]:
        assert abs(float(polynomial(*exact) / rational(F(digits)) - 1)) < 1e-27

    found = verdict_at(YAW_ROLL, point)
    assert (found.verdict.word, found.verdict.theorem) == verdict
    mu = sorted(float(root.ball.real.mid()) for root in enclosures(found.characteristic[::2]))
    assert mu == pytest.approx([float(x) for x in roots], rel=1e-14)
    pitch = verdict_at(PITCH, point).verdict
    assert (pitch.word, pitch.theorem) == ("stable", "Lagrange-Dirichlet")

    # The same in a, b, c, d, f, with symmetric M and K and a skew G.
    unscaled = linear(
        SATELLITE,
        True,
        M=[[a, 0, 0], [0, b, f], [0, f, d]],
        G=[[0, c - b - a, 0], [a + b - c, 0, 0], [0, 0, 0]],
        K=[[c - b, 0, 0], [0, 4 * (c - a), 4 * f], [0, 4 * f, 3 * f + d]],
    )
    assert verdict_at(unscaled, {}) == found
    raw = analyse(unscaled, RANGES).characteristic
    factor = rational(a * c * f / (1 + values[0]))
    assert [p.leading_coefficient() for p in raw[::2]] == [factor * p(*exact) for p in (V0, V2, V4, V6)]


# -- gravity gradient -------------------------------------------------------------------------------------------------

GRADIENT, (IX, IY, IZ) = ring("Ix Iy Iz")


def gradient_yaw_roll() -> LinearSystem:
    """roll phi, yaw psi of a rigid satellite in a circular orbit (DeBra & Delp)."""
    return linear(
        GRADIENT,
        True,
        M=[[IX, 0], [0, IZ]],
        G=[[0, IY - IX - IZ], [IX - IY + IZ, 0]],
        K=[[4 * (IY - IZ), 0], [0, IY - IX]],
    )


def test_gravity_gradient_conditions() -> None:
    known = signs(GRADIENT, "positive positive positive", IX + IY - IZ, IY + IZ - IX, IZ + IX - IY)
    pitch = analyse(linear(GRADIENT, True, M=[[IY]], K=[[3 * (IX - IZ)]]), known)
    assert [c.polynomial for c in pitch.conditions] == [IX - IZ]
    assert [case.verdict.word for case in pitch.cases] == ["stable", "unstable"]

    found = analyse(gradient_yaw_roll(), known)
    # kR = (Iy - Iz)/Ix, kY = (Iy - Ix)/Iz: s^4 + (1 + 3 kR + kR kY) s^2 + 4 kR kY, times Ix Iz
    middle = IX * IZ + 3 * (IY - IZ) * IZ + (IY - IZ) * (IY - IX)
    last = 4 * (IY - IZ) * (IY - IX)
    assert requirement(found, "v4") == IX * IZ
    assert requirement(found, "v2") == middle
    assert requirement(found, "v0") == last
    assert requirement(found, "discriminant") == middle**2 - 4 * IX * IZ * last
    assert found.requirements[0].always
    # Lagrange region Iy > Ix > Iz
    lagrange = known.assuming([(IY - IX, ">"), (IX - IZ, ">")])
    proved = analyse(gradient_yaw_roll(), lagrange)
    assert (proved.verdict.word, proved.verdict.theorem) == ("stable", "Routh")
    between = known.assuming([(IY - IX, ">"), (IZ - IY, ">")])
    odd = analyse(gradient_yaw_roll(), between).verdict
    assert (odd.word, odd.theorem, odd) == ("unstable", "Kelvin-Chetaev", found.cases[2].verdict)


@pytest.mark.parametrize(
    ("inertia_", "word"),
    [
        ("1.2 1.5 0.9", "stable"),  # Lagrange region
        ("1.5 1.2 0.9", "unstable"),  # kR kY < 0
        ("1 0.65 0.9", "unstable"),  # 1 + 3 kR + kR kY < 4 sqrt(kR kY)
        ("1 0.12 0.95", "unstable"),  # 1 + 3 kR < 0
        ("1 0.96 0.99", "gyroscopically stabilised only"),  # DeBra-Delp region
    ],
)
def test_gravity_gradient_samples(inertia_: str, word: str) -> None:
    point = dict(enumerate(map(F, inertia_.split())))
    found = verdict_at(gradient_yaw_roll(), point).verdict
    pitch = verdict_at(linear(GRADIENT, True, M=[[IY]], K=[[3 * (IX - IZ)]]), point).verdict
    assert found.word == word
    assert pitch.word == "stable"
    assert combine([pitch, found]).word == word


# -- Ziegler's pendulum -----------------------------------------------------------------------------------------------

ZIEGLER, (P, B1, B2) = ring("p b1 b2")


def ziegler(damped: bool) -> LinearSystem:
    """M = [[3, 1], [1, 1]], K + N = [[2 - p, p - 1], [-1, 1]], D = [[b1 + b2, -b2], [-b2, b2]]."""
    half = P / 2
    return linear(
        ZIEGLER,
        M=[[3, 1], [1, 1]],
        K=[[2 - P, half - 1], [half - 1, 1]],
        N=[[0, half], [-half, 0]],
        D=[[B1 + B2, -B2], [-B2, B2]] if damped else [[0, 0], [0, 0]],
    )


def test_ziegler_undamped() -> None:
    system = ziegler(damped=False)
    found = analyse(system, signs(ZIEGLER))
    assert found.kind == "circulatory"
    assert found.characteristic[::2] == (P * 0 + 1, 7 - 2 * P, P * 0 + 2)
    assert [c.polynomial for c in found.conditions] == [7 - 2 * P, 4 * P**2 - 28 * P + 41]
    assert [case.verdict.word for case in found.cases] == [Word.CRITICAL, "unstable"]
    for p, word in [("2.0857864376", Word.CRITICAL), ("2.0857864377", "unstable"), ("5", "unstable")]:
        assert verdict_at(system, {0: F(p)}).verdict.word == word


def test_ziegler_damped() -> None:
    system = ziegler(damped=True)
    found = analyse(system, signs(ZIEGLER, "real positive positive"))
    assert found.kind == "dissipative circulatory"
    # p_cr = (4 b1^2 + 33 b1 b2 + 4 b2^2)/(2 (b1^2 + 7 b1 b2 + 6 b2^2)) + b1 b2/2
    under = B1**2 + 7 * B1 * B2 + 6 * B2**2
    below = 4 * B1**2 + 33 * B1 * B2 + 4 * B2**2 + B1 * B2 * under - 2 * P * under
    assert found.requirements[-1].label == "Hurwitz minor 3"
    assert found.requirements[-1].condition.polynomial == below
    for b in (F(1, 2), F(1, 10**8)):
        critical = F(41, 28) + b**2 / 2
        at = {name: verdict_at(system, {0: p, 1: b, 2: b}) for name, p in [
            ("below", critical - F(1, 10**20)), ("on", critical), ("above", critical + F(1, 10**20)),
        ]}  # fmt: skip
        assert at["below"].verdict.word == "asymptotically stable"
        assert at["above"].verdict.word == "unstable"
        assert at["on"].verdict.word == Word.CRITICAL
        assert at["on"].roots == RootCount(right=0, imaginary=2, left=2, zero=0, imaginary_multiplicity=1)


# -- gyroscopic, dissipative, circulatory: exact thresholds -----------------------------------------------------------

TWO, (S1, S2, SPEED, DAMPING) = ring("s1 s2 g d")


def gyroscopic_pair(damped: bool = False) -> LinearSystem:
    """x'' + g y' - s1^2 x = 0, y'' - g x' - s2^2 y = 0, with d on the diagonal of D."""
    return linear(
        TWO,
        True,
        M=[[1, 0], [0, 1]],
        G=[[0, SPEED], [-SPEED, 0]],
        K=[[-(S1**2), 0], [0, -(S2**2)]],
        D=[[DAMPING, 0], [0, DAMPING]] if damped else [[0, 0], [0, 0]],
    )


def test_gyroscopic_stabilisation_threshold() -> None:
    found = analyse(gyroscopic_pair(), signs(TWO, "positive positive positive real"))
    last = found.requirements[-1]
    assert last.label == "discriminant"
    product = (SPEED - S1 - S2) * (SPEED + S1 - S2) * (SPEED - S1 + S2)
    assert last.condition.polynomial == product
    assert found.stiffness.word == "not positive definite"
    assert found.verdict.word is Word.DEPENDS
    fast = signs(TWO, "positive positive positive real", SPEED - S1 - S2)
    assert analyse(gyroscopic_pair(), fast).verdict.word == "gyroscopically stabilised only"

    words = {
        g: verdict_at(gyroscopic_pair(), {0: F(1), 1: F(2), 2: F(g)}).verdict.word for g in ("2.999", "3", "3.001")
    }
    assert words == {"2.999": "unstable", "3": "undecided", "3.001": "gyroscopically stabilised only"}


def test_complete_dissipation_destroys_gyroscopic_stability() -> None:
    point = {0: F(1), 1: F(2), 2: F(10), 3: F(1, 1000)}
    assert verdict_at(gyroscopic_pair(), point).verdict.word == "gyroscopically stabilised only"
    found = verdict_at(gyroscopic_pair(damped=True), point)
    assert (found.verdict.word, found.verdict.theorem) == ("unstable", "Kelvin-Chetaev")
    largest = max(float(root.ball.real.mid()) for root in enclosures(found.characteristic))
    assert largest == pytest.approx(2.678295e-5, rel=1e-6)
    symbolic = analyse(gyroscopic_pair(damped=True), signs(TWO, "positive positive positive positive"))
    assert (symbolic.verdict.word, symbolic.verdict.theorem) == ("unstable", "Kelvin-Chetaev")


def test_kelvin_chetaev_positive() -> None:
    context, (k, d, g) = ring("k d g")
    system = linear(context, True, M=[[1, 0], [0, 1]], D=[[d, 0], [0, d]], G=[[0, g], [-g, 0]], K=[[k, 0], [0, 2 * k]])
    found = analyse(system, signs(context, "positive positive real"))
    assert found.kind == "gyroscopic dissipative"
    assert (found.verdict.word, found.verdict.theorem) == ("asymptotically stable", "Kelvin-Chetaev")


def test_rotating_shaft() -> None:
    """Internal damping di, external de: stable if and only if Omega < w0 (1 + de/di)."""
    context, (w0, di, de, omega) = ring("w0 di de Omega")
    d, k, n = di + de, w0**2, di * omega
    system = linear(context, M=[[1, 0], [0, 1]], D=[[d, 0], [0, d]], K=[[k, 0], [0, k]], N=[[0, n], [-n, 0]])
    known = signs(context, "positive positive positive positive")
    found = analyse(system, known)
    assert found.kind == "dissipative circulatory"
    assert [c.polynomial for c in found.conditions] == [w0 * (di + de) - di * omega]
    assert analyse(system, known.assuming([(w0 * d - n, ">")])).verdict.word == "asymptotically stable"
    assert analyse(system, known.assuming([(n - w0 * d, ">")])).verdict.word == "unstable"
    at = {0: F(2), 1: F(1), 2: F(3), 3: F(8)}
    assert verdict_at(system, at).verdict.word == Word.CRITICAL
    assert verdict_at(system, at | {3: F(799, 100)}).verdict.word == "asymptotically stable"
    assert verdict_at(system, at | {3: F(801, 100)}).verdict.word == "unstable"


def test_sleeping_top() -> None:
    """omega3^2 > 4 A m g l/C^2."""
    context, (a, c, omega, w) = ring("A C omega3 mgl")
    system = linear(
        context, True, M=[[a, 0], [0, a]], G=[[0, c * omega], [-c * omega, 0]], K=[[-w, 0], [0, -w]]
    )  # fmt: skip
    known = signs(context, "positive positive positive positive")
    found = analyse(system, known)
    assert found.conditions[-1].polynomial == c**2 * omega**2 - 4 * a * w
    fast = known.assuming([(c**2 * omega**2 - 4 * a * w, ">")])
    assert analyse(system, fast).verdict.word == "gyroscopically stabilised only"
    words = [verdict_at(system, {0: F(1), 1: F(1), 2: F(o), 3: F(1)}).verdict.word for o in ("1.99", "2", "2.01")]
    assert words == ["unstable", "undecided", "gyroscopically stabilised only"]


def test_intermediate_axis() -> None:
    """Euler's equations about axis 2: growth rate omega sqrt((I2 - I1)(I3 - I2)/(I1 I3))."""
    context, (i1, i2, i3, w) = ring("I1 I2 I3 w")
    # I1 a' = (I2 - I3) w c, I3 c' = (I1 - I2) w a, differentiated once: two first-order variables as coordinates.
    system = linear(
        context, M=[[1, 0], [0, 1]], D=[[0, 0], [0, 0]], K=[[-1, 0], [0, -1]], G=[[0, 0], [0, 0]]
    )  # fmt: skip
    assert verdict_at(system, {}).verdict.word == "unstable"
    pencil = [[i1, i2 * 0], [i2 * 0, i3]], [[i1 * 0, (i3 - i2) * w], [(i2 - i1) * w, i1 * 0]]
    zero = [[i1 * 0] * 2 for _ in range(2)]
    coefficients = characteristic_polynomial(zero, *pencil)
    assert coefficients[:3] == (-(i2 - i1) * (i3 - i2) * w**2, i1 * 0, i1 * i3)


# -- borders, cyclic coordinates, several factors ---------------------------------------------------------------------

NONE, (X,) = ring("x")


def at_once(**parts: Any) -> tuple[str, str]:
    """(symbolic word, numeric word) of a purely numeric system."""
    system = linear(NONE, **parts)
    return analyse(system, signs(NONE)).verdict.word, verdict_at(system, {}).verdict.word


def test_equal_frequencies_do_no_harm_to_a_potential_system() -> None:
    assert at_once(conservative=True, M=[[1, 0], [0, 1]], K=[[1, 0], [0, 1]]) == ("stable", "stable")
    assert at_once(M=[[1, 0], [0, 1]], K=[[1, 0], [0, 1]]) == (Word.CRITICAL, Word.CRITICAL)


def test_double_imaginary_pair_with_jordan_block() -> None:
    """s^4 + 2 s^2 + 1 with K + N = [[1, 1], [0, 1]]."""
    half = F(1, 2)
    parts: dict[str, Any] = {"M": [[1, 0], [0, 1]], "K": [[1, half], [half, 1]], "N": [[0, half], [-half, 0]]}
    system = linear(NONE, **parts)
    found = verdict_at(system, {})
    assert found.characteristic == (1, 0, 2, 0, 1)
    assert found.roots == RootCount(right=0, imaginary=4, left=0, zero=0, imaginary_multiplicity=2)
    assert found.verdict.word == "undecided"
    assert "not semisimple" in found.verdict.explanation
    symbolic = analyse(system, signs(NONE))
    assert symbolic.verdict.word == "undecided"
    assert all(case.never for case in symbolic.cases)
    assert any("Jordan blocks" in remark for remark in symbolic.remarks)


def test_identical_gyroscopic_blocks_are_semisimple() -> None:
    g, k = 10, -1
    gyroscopic = [[0, g, 0, 0], [-g, 0, 0, 0], [0, 0, 0, g], [0, 0, -g, 0]]
    parts: dict[str, Any] = {
        "M": np.eye(4, dtype=int).tolist(),
        "G": gyroscopic,
        "K": (k * np.eye(4, dtype=int)).tolist(),
    }
    assert at_once(**parts) == ("gyroscopically stabilised only", "gyroscopically stabilised only")
    found = analyse(linear(NONE, **parts), signs(NONE))
    assert any("simple elementary divisors" in remark for remark in found.remarks)


def test_from_degree_four_on_the_discriminant_is_not_enough() -> None:
    """mu^4 + 2 mu^3 + 5 mu^2 + 3 mu + 3: positive coefficients, positive discriminant, and two complex pairs."""
    companion = [[0, 0, 0, 3], [-1, 0, 0, 3], [0, -1, 0, 5], [0, 0, -1, 2]]
    # The negative of a companion matrix, so that det(mu + A) is the polynomial.
    a = np.array(companion)
    half = [[F(int(x), 2) for x in row] for row in (a + a.T)], [[F(int(x), 2) for x in row] for row in (a - a.T)]
    system = linear(NONE, M=np.eye(4, dtype=int).tolist(), K=half[0], N=half[1])
    found = analyse(system, signs(NONE))
    assert [number(c) for c in found.polynomial[::2]] == [3, 3, 5, 2, 1]
    assert len(found.factors) == 1
    assert number(requirement(found, "discriminant")) > 0
    assert [r.label for r in found.requirements][-3:] == ["subdiscriminant 2", "subdiscriminant 3", "discriminant"]
    assert found.verdict.word == verdict_at(system, {}).verdict.word == "unstable"


def test_zero_stiffness_is_a_border() -> None:
    assert at_once(conservative=True, M=[[1]], K=[[0]]) == ("undecided", "undecided")
    simple = "stable in first approximation only"  # roots 0 and -1
    assert at_once(conservative=True, M=[[1]], K=[[0]], D=[[1]]) == (simple, simple)
    assert at_once(conservative=True, M=[[1, 0], [0, 1]], K=[[1, -1], [-1, 1]]) == ("undecided", "undecided")


def test_indefinite_damping_without_trace_is_not_asymptotic() -> None:
    """D = diag(d, -d): the determinant is even, so the roots lie symmetrically and nothing can be asymptotic."""
    d = F(1, 2)
    words = at_once(M=[[1, 0], [0, 1]], D=[[d, 0], [0, -d]], K=[[1, 0], [0, 1]])
    assert words[1] == "unstable"
    assert words[0] in ("unstable", "undecided")


def test_conditions_that_exclude_each_other_leave_nothing_to_depend_on() -> None:
    """R = c x'y': x + y is damped by c, x - y driven by it, so that s^2 - c s + k = 0 has its roots to the right."""
    context, (c, k) = ring("c k")
    damped = linear(context, M=[[1, 0], [0, 1]], D=[[0, c], [c, 0]], K=[[k, 0], [0, k]])
    found = analyse(damped, signs(context, "positive positive"))
    wanted = requirement(found, "v2"), requirement(found, "discriminant")
    assert [p for p in wanted if p == 2 * k - c**2]
    assert (found.verdict.word, found.verdict.theorem) == (Word.UNSTABLE, "Lyapunov's first method")
    # Damping c and -c, coupled by a spring e: for small c the roots stay imaginary, for large ones they do not.
    context, (c, k, e) = ring("c k e")
    stiff = [[k + e, -e], [-e, k + e]]
    balanced = linear(context, M=[[1, 0], [0, 1]], D=[[c, 0], [0, -c]], K=stiff)
    assert analyse(balanced, signs(context, "positive positive positive")).verdict.word == Word.DEPENDS
    at = linear(NONE, M=[[1, 0], [0, 1]], D=[[F(1, 10), 0], [0, F(-1, 10)]], K=[[2, -1], [-1, 2]])
    assert verdict_at(at, {}).verdict.word == Word.CRITICAL


def test_a_trace_and_its_opposite_are_never_positive_together() -> None:
    """K = diag(-k, -2 k), damping c and d, gyroscopic b: a_3 = c + d and a_1 = -k (2 c + d); their sum is -c at k = 1.

    So one of the roots is to the right, whatever b and d are; at c = 1/10, d = -1/15, b = 5 by numbers, too.
    """
    context, (b, c, d, k) = ring("b c d k")
    parts: dict[str, Any] = {"D": [[c, 0], [0, d]], "G": [[0, -b], [b, 0]], "K": [[-k, 0], [0, -2 * k]]}
    known = signs(context, "positive positive real positive")
    assert analyse(linear(context, M=[[1, 0], [0, 1]], **parts), known).verdict.word == Word.UNSTABLE
    rows = np.block([[np.zeros((2, 2)), np.eye(2)], [np.diag([1.0, 2.0]), -np.array([[0.1, -5], [5, -1 / 15]])]])
    assert max(np.linalg.eigvals(rows).real) > 0.001
    opposite = parts | {"K": [[k, 0], [0, 2 * k]]}  # a_1 = k (2 c + d): for d > 0 every root is to the left
    assert analyse(linear(context, M=[[1, 0], [0, 1]], **opposite), known).verdict.word == Word.DEPENDS


def test_incomplete_but_pervasive_damping() -> None:
    parts: dict[str, Any] = {"M": [[1, 0], [0, 1]], "D": [[1, 0], [0, 0]], "K": [[2, -1], [-1, 2]]}
    assert at_once(**parts) == ("asymptotically stable", "asymptotically stable")
    assert verdict_at(linear(NONE, **parts), {}).verdict.theorem == "Lyapunov's first method"
    # Damping that does not reach the second oscillator leaves an imaginary pair.
    assert at_once(M=[[1, 0], [0, 1]], D=[[1, 0], [0, 0]], K=[[2, 0], [0, 2]])[1] == Word.CRITICAL


def test_singular_mass_matrix() -> None:
    assert at_once(M=[[1, 0], [0, 0]], K=[[1, 0], [0, 1]]) == ("undecided", "undecided")


def test_conical_pendulum_drifts_in_azimuth() -> None:
    """theta about theta0 and cyclic phi; the frequency of theta at constant momentum is Omega sqrt(1 + 3 cos^2)."""
    context, (s, c, omega) = ring("s c Omega")
    g = 2 * s * c * omega
    parts: dict[str, Any] = {"M": [[1, 0], [0, s**2]], "G": [[0, -g], [g, 0]], "K": [[omega**2 * s**2, 0], [0, 0]]}
    known = signs(context, "positive positive positive")
    found = analyse(linear(context, True, (1,), **parts), known)
    assert found.zero_power == 2
    assert found.reduced is not None
    frequency = found.reduced.stiffness.minors[0], found.reduced.mass.minors[0]
    assert frequency[0] == frequency[1] * omega**2 * (s**2 + 4 * c**2)
    assert found.verdict.word == Word.STABLE_BUT_CYCLIC
    assert found.verdict.theorem == "Routh"
    at = {0: F(3, 5), 1: F(4, 5), 2: F(1)}
    assert verdict_at(linear(context, True, (1,), **parts), at).verdict.word == Word.STABLE_BUT_CYCLIC
    # Without knowing that phi is cyclic in the nonlinear equations too, nothing may be claimed.
    assert analyse(linear(context, True, **parts), known).verdict.word == "undecided"
    assert verdict_at(linear(context, True, **parts), at).verdict.word == "undecided"


def test_clohessy_wiltshire_has_a_double_zero() -> None:
    parts: dict[str, Any] = {"M": [[1, 0], [0, 1]], "G": [[0, -2], [2, 0]], "K": [[-3, 0], [0, 0]]}
    assert verdict_at(linear(NONE, True, **parts), {}).roots == RootCount(0, 2, 0, 2, 1)
    assert at_once(conservative=True, **parts) == ("undecided", "undecided")
    assert at_once(conservative=True, cyclic=(1,), **parts) == (Word.STABLE_BUT_CYCLIC,) * 2


def test_damped_rotor_keeps_its_angle() -> None:
    assert at_once(cyclic=(0,), M=[[1]], D=[[1]], K=[[0]]) == (Word.ASYMPTOTIC_BUT_CYCLIC,) * 2
    assert at_once(cyclic=(0,), M=[[1]], D=[[-1]], K=[[0]]) == ("unstable", "unstable")
    assert at_once(cyclic=(0,), M=[[1]], K=[[0]]) == ("undecided", "undecided")


def test_factors_without_known_signs() -> None:
    """Two decoupled oscillators in one subsystem: conditions per factor, and no common roots for G != 0."""
    context, (k1, k2, g) = ring("k1 k2 g")
    system = linear(
        context,
        True,
        M=[[1, 0, 0], [0, 1, 0], [0, 0, 1]],
        G=[[0, g, 0], [-g, 0, 0], [0, 0, 0]],
        K=[[k1, 0, 0], [0, k1, 0], [0, 0, k2]],
    )
    found = analyse(system, signs(context))
    assert len(found.factors) == 2
    labels = [r.label for r in found.requirements]
    assert "v0 of factor 1" in labels
    assert "resultant of factors 1 and 2" in labels
    polynomials = [c.polynomial for c in found.conditions]
    assert k2 in polynomials


def test_unknown_factor_is_not_removed() -> None:
    context, (a, b) = ring("a b")
    raw = [[a * b]], [[b * 0]], [[b * b]]
    found = analyse(LinearSystem(raw[0], raw[1], raw[1], raw[2], raw[1]), signs(context, "real real"))
    assert found.removed == 1
    assert found.polynomial == (b * b, b * 0, a * b)
    found = analyse(LinearSystem(raw[0], raw[1], raw[1], raw[2], raw[1]), signs(context, "negative negative"))
    assert found.removed * found.polynomial[0] == b * b
    assert signs(context, "negative negative").sign(found.removed) == "positive"


def test_analysis_beyond_the_budget(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(theory, "characteristic_polynomial", lambda *_: determinant([[ALPHA]], budget=0))
    found = analyse(YAW_ROLL, RANGES, dict(enumerate([F(1, 10), F(1, 2), F(3, 4), F(1, 4)])))
    assert found.verdict.word == "undecided"
    assert "not written out" in found.remarks[0]
    assert found.at_point is not None
    assert found.at_point.verdict.word == "stable"


def test_too_large_is_said_and_never_a_verdict(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(_: Any) -> Any:
        raise TooLargeError("too many terms")

    monkeypatch.setattr(theory, "subdiscriminants", refuse)
    found = analyse(YAW_ROLL, RANGES)
    assert any("not written out" in remark for remark in found.remarks)
    assert found.verdict.word == "undecided"
    with pytest.raises(TooLargeError):
        determinant([[ALPHA + i + GAMMA * j for j in range(3)] for i in range(3)], budget=5)


def test_bad_matrices_are_refused() -> None:
    with pytest.raises(ValueError, match="not a 2 x 2"):
        linear(NONE, M=[[1, 0], [0, 1]], K=[[1]])
    with pytest.raises(ValueError, match="not symmetric"):
        linear(NONE, M=[[1, 0], [1, 1]])
    with pytest.raises(ValueError, match="not skew"):
        linear(NONE, M=[[1]], G=[[1]])
    with pytest.raises(ValueError, match="not cyclic"):
        linear(NONE, M=[[1]], K=[[1]], cyclic=(0,))
    with pytest.raises(ValueError, match="should be symmetric"):
        verdict_at(linear(NONE, M=[[1, 0], [0, 1]], K=[[0, 1], [-1, 0]]), {})
    with pytest.raises(ValueError, match="no value for p"):
        verdict_at(ziegler(damped=False), {})
    with pytest.raises(ValueError, match="no subsystem"):
        combine([])


def test_combine_takes_the_worst() -> None:
    words = [Word.STABLE, Word.GYROSCOPIC, Word.CRITICAL, Word.UNDECIDED, Word.UNSTABLE]
    for i, word in enumerate(words):
        for better in words[: i + 1]:
            assert combine([Verdict(better), Verdict(word)]).word == word
    assert combine([Verdict(Word.ASYMPTOTIC), Verdict(Word.STABLE)]).word == Word.CRITICAL
    assert combine([Verdict(Word.ASYMPTOTIC)] * 2).word == Word.ASYMPTOTIC
    assert combine([Verdict(Word.STABLE), Verdict(Word.STABLE_BUT_CYCLIC)]).word == Word.STABLE_BUT_CYCLIC
    assert combine([Verdict(Word.STABLE, ("Routh",)), Verdict(Word.STABLE, ("Lagrange-Dirichlet",))]).theorem == (
        "Lagrange-Dirichlet, Routh"
    )


# -- roots ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("high_to_low", "right", "imaginary"),
    [
        ([1, 2, 8, 12, 20, 16, 16], 0, 4),  # row of zeros: -1 +- i, +- i sqrt 2, +- 2i
        ([1, 3, 2, 6, 6, 9], 2, 0),  # zero in the first column
        ([1, 1, 2, 2, 3, 5], 2, 0),
        ([1, 1, 3, 3, 3, 2, 1], 2, 2),
        ([1, 2, 24, 48, -25, -50], 1, 2),  # -2, -1, 1, +- 5i
        ([1, 0, 2, 0, 1], 0, 4),  # +- i twice
        ([1, 1, 1, 1], 0, 2),
    ],
)
def test_singular_routh_tables(high_to_low: list[int], right: int, imaginary: int) -> None:
    found = count_roots(high_to_low[::-1])
    assert (found.right, found.imaginary, found.degree) == (right, imaginary, len(high_to_low) - 1)
    # Negative control: the neighbour with a slightly larger constant is told apart wherever imaginary roots are.
    if imaginary:
        shifted = [high_to_low[-1] + F(1, 10**30), *high_to_low[-2::-1]]
        assert count_roots(shifted) != found


def test_wilkinson() -> None:
    """(x - 1)...(x - 20) - 2^-23 x^19: ten real roots, five complex pairs."""
    p = fmpq_poly([1])
    for k in range(1, 21):
        p *= fmpq_poly([-k, 1])
    assert count_real_roots(p.coeffs()) == (0, 0, 20)
    p -= fmpq_poly([0] * 19 + [fmpq(1, 2**23)])
    assert count_real_roots(p.coeffs()) == (0, 0, 10)
    assert count_roots(p.coeffs()).right == 20
    balls = [root.ball for root in enclosures(p.coeffs(), bits=120)]
    real = [ball.real.str(22, radius=False) for ball in balls if ball.imag == 0]
    assert real == [
        "1.000000000000000000000", "2.000000000000000009762", "2.999999999999805232976", "4.000000000261023189142",
        "4.999999927551537909560", "6.000006943952295707203", "6.999697233936013948676", "8.007267603450376854893",
        "8.917250248517070494296", "20.84690810148225691493",
    ]  # fmt: skip
    imaginary = sorted(ball.imag.str(18, radius=False) for ball in balls if ball.imag > 0)
    assert imaginary == sorted(
        ["0.643500903863603576", "1.65232972816093228", "2.51883006963027229", "2.81262489427003927",
         "1.94033034666447954"]
    )  # fmt: skip


def test_frank_matrix() -> None:
    n = 12
    frank = fmpz_mat(n, n, [n - max(i, j) if j >= i - 1 else 0 for i in range(n) for j in range(n)])
    roots = enclosures(frank.charpoly().coeffs(), bits=100)
    values = [float(root.ball.real.mid()) for root in roots]
    assert values[0] == pytest.approx(0.0310280606440100151, rel=1e-14)
    assert values[-1] == pytest.approx(32.2288915015721607, rel=1e-14)
    assert count_real_roots(frank.charpoly().coeffs()) == (0, 0, 12)


def test_only_exact_numbers() -> None:
    for bad in (0.5, True):
        with pytest.raises(TypeError, match="exact rational"):
            count_roots([1, bad])
    with pytest.raises(ValueError, match="zero polynomial"):
        count_roots([0, 0])
    assert count_roots([5]) == RootCount(0, 0, 0, 0, 0)


rationals = st.fractions(min_value=-4, max_value=4, max_denominator=4)
real_factors = rationals.map(lambda r: ([-r, F(1)], r))
pair_factors = st.tuples(rationals, st.fractions(min_value=F(1, 4), max_value=4, max_denominator=4)).map(
    lambda ab: ([ab[0] ** 2 + ab[1] ** 2, -2 * ab[0], F(1)], ab[0])
)
factors = st.lists(st.tuples(st.one_of(real_factors, pair_factors), st.integers(1, 3)), min_size=1, max_size=5)


@settings(max_examples=150)
@given(factors, rationals.filter(bool))
def test_counts_from_known_roots(parts: list[Any], scale: F) -> None:
    p = fmpq_poly([rational(scale)])
    expected = {"right": 0, "imaginary": 0, "left": 0, "zero": 0}
    on_axis: dict[F, int] = {}
    for (coefficients, real_part), multiplicity in parts:
        p *= univariate(coefficients) ** multiplicity
        degree = (len(coefficients) - 1) * multiplicity
        if real_part:
            expected["right" if real_part > 0 else "left"] += degree
        elif len(coefficients) == 2:
            expected["zero"] += degree
        else:
            expected["imaginary"] += degree
            on_axis[coefficients[0]] = on_axis.get(coefficients[0], 0) + multiplicity
    found = count_roots(p.coeffs())
    assert found == RootCount(**expected, imaginary_multiplicity=max(on_axis.values(), default=0))


small = st.lists(st.integers(-4, 6), min_size=2, max_size=7).filter(lambda cs: cs[-1] > 0)


def constants(numbers: list[int]) -> tuple[Any, ...]:
    return tuple(NONE.constant(n) for n in numbers)


def number(p: Any) -> Any:
    return p(0)


@settings(max_examples=200)
@given(small)
def test_hurwitz_and_lienard_chipart_agree_with_the_count(numbers: list[int]) -> None:
    stable = count_roots(numbers).left == len(numbers) - 1
    assert all(number(p) > 0 for p in hurwitz_minors(constants(numbers))) == stable
    assert all(number(p) > 0 for _, p in lienard_chipart(constants(numbers))) == stable


@settings(max_examples=200)
@given(st.one_of(small, st.lists(st.integers(-3, 3), min_size=1, max_size=5).map(lambda r: from_roots(r))))
def test_subdiscriminants_agree_with_the_count(numbers: list[int]) -> None:
    negative, zero, positive = count_real_roots(numbers)
    degree = len(numbers) - 1
    square_free = univariate(numbers).gcd(univariate(numbers).derivative()).degree() <= 0
    table = subdiscriminants(constants(numbers))
    assert len(table) == degree
    assert table[0] == degree
    assert all(number(d) > 0 for d in table) == (square_free and negative + zero + positive == degree)
    assert number(table[-1]) == fmpq(univariate(numbers).discriminant() if degree > 1 else 1)


def from_roots(roots: list[int]) -> list[int]:
    p = fmpq_poly([1])
    for root in roots:
        p *= fmpq_poly([-root, 1])
    return [int(c.p) for c in p.coeffs()]


# -- characteristic polynomials against SymPy -------------------------------------------------------------------------


def test_determinants_against_sympy() -> None:
    context, gens = ring("a b c d")
    a, b, c, d = gens
    m = [[a, b, 0], [b, c, d], [0, d, a + 1]]
    damping = [[0, c, d], [-c, a, 0], [-d, 0, 0]]
    k = [[c, d, a], [d, a - b, 0], [a, 0, b**2]]
    found = characteristic_polynomial(*(matrix(context, part) for part in (m, damping, k)))
    lam = sympy.Symbol("lambda")

    def to_sympy(rows: Any) -> sympy.Matrix:
        return sympy.Matrix([[sympy.sympify(str(e).replace("^", "**")) for e in row] for row in rows])

    expected = (lam**2 * to_sympy(m) + lam * to_sympy(damping) + to_sympy(k)).det(method="berkowitz")
    total = sum(sympy.sympify(str(p).replace("^", "**")) * lam**i for i, p in enumerate(found))
    assert sympy.expand(total - expected) == 0

    p = (a, b, c, d, a + b)
    x = sympy.Symbol("x")
    in_sympy = sympy.Poly(sum(sympy.sympify(str(v)) * x**i for i, v in enumerate(p)), x)
    difference = sympy.sympify(str(discriminant(p)).replace("^", "**")) - sympy.discriminant(in_sympy)
    assert sympy.expand(difference) == 0


def test_determinant_of_eight_by_eight() -> None:
    context, gens = ring(" ".join(f"k{i}" for i in range(9)))
    n = 8
    rows = [[0] * n for _ in range(n)]
    for i in range(n):
        rows[i][i] = gens[i] + gens[i + 1]
        if i:
            rows[i][i - 1] = rows[i - 1][i] = -gens[i]
    # A chain of springs: det = sum over i of the product of all the others (spanning trees).
    expected = context.constant(0)
    for i in range(n + 1):
        term = context.constant(1)
        for j in range(n + 1):
            term *= gens[j] if i != j else 1
        expected += term
    chain = matrix(context, rows)
    assert leading_minors(chain)[-1] == expected
    unit = matrix(context, np.eye(n, dtype=int).tolist())
    assert characteristic_polynomial(unit, matrix(context, [[0] * n] * n), chain)[0] == expected


def test_parts_of_a_polynomial() -> None:
    _, (a, b) = ring("a b")
    part, removed = primitive((6 * a * b, a * fmpq(9, 2), a * 0))
    assert part == (4 * b, b * 0 + 3, b * 0)
    assert removed == a * fmpq(3, 2)
    with pytest.raises(ValueError, match="zero"):
        primitive((a * 0,))
    # a (lambda + b)^2 (lambda^2 + 1)
    p = (a * b**2, 2 * a * b, a + a * b**2, 2 * a * b, a)
    rest, found = factor_in_lambda(p)
    assert rest == a
    assert found == [((b, b * 0 + 1), 2), ((b * 0 + 1, b * 0, b * 0 + 1), 1)]
    assert resultant((-a, a * 0 + 1), (-b, b * 0 + 1)) in (a - b, b - a)
    with pytest.raises(ValueError, match="degree 1"):
        subdiscriminants((a,))
    with pytest.raises(ValueError, match="square"):
        leading_minors([])


def test_lambda_may_be_a_parameter_name() -> None:
    _, (lam,) = ring("lambda")
    one, zero = lam * 0 + 1, lam * 0
    assert characteristic_polynomial([[one]], [[zero]], [[lam]]) == (lam, zero, one)
    assert characteristic._Variable(lam.context()).name == "lambda_"


# -- verdicts of random systems ---------------------------------------------------------------------------------------

entries = st.integers(-3, 3)


def square(n: int) -> st.SearchStrategy[list[list[int]]]:
    return st.lists(st.lists(entries, min_size=n, max_size=n), min_size=n, max_size=n)


@st.composite
def systems(draw: Any) -> dict[str, Any]:
    n = draw(st.integers(1, 3))
    parts = {name: np.array(draw(square(n))) for name in "MDGKN"}
    m = parts["M"] @ parts["M"].T + np.eye(n, dtype=int)
    on = draw(st.sampled_from(["", "G", "D", "DG", "N", "DN", "DGN", "GN"]))
    result = {
        "M": m,
        "K": parts["K"] + parts["K"].T,
        "G": 3 * (parts["G"] - parts["G"].T),
        "N": parts["N"] - parts["N"].T,
        "D": parts["D"] @ parts["D"].T,
    }
    return {name: value.tolist() for name, value in result.items() if name in "MK" or name in on}


@settings(max_examples=120)
@given(systems())
def test_symbols_numbers_and_floats_agree(parts: dict[str, Any]) -> None:
    """The case analysis never contradicts the exact count; the exact count never contradicts clear float roots."""
    system = linear(NONE, True, **parts)
    exact = verdict_at(system, {})
    symbolic = analyse(system, signs(NONE)).verdict
    assert symbolic.word in (exact.verdict.word, "undecided")
    assert exact.roots is not None
    n = system.size
    m, d, g, k, s = (np.array(parts.get(name, np.zeros((n, n)))) for name in "MDGKN")
    a = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(m, k + s), -np.linalg.solve(m, d + g)]])
    largest = np.linalg.eigvals(a).real.max()
    assume(abs(largest) > 1e-3)
    assert (exact.verdict.word == "unstable") == (largest > 0)
    assert (exact.verdict.word == "asymptotically stable") == (largest < 0)


def holds(r: Requirement, point: list[Any]) -> bool:
    """The requirement as it arose; what was left of it after reduction must say the same."""
    value = r.polynomial(*point)
    raw = value != 0 if r.relation == "!=" else value > 0
    reduced = r.condition.polynomial(*point) > 0 and all(f(*point) != 0 for f in r.condition.nonzero)
    assert r.by_mass or reduced == raw
    return raw


def read_off(found: Theory, point: list[Any]) -> str:
    """The cases as an if-elif chain at given values."""
    for case in found.cases:
        if all(holds(r, point) for r in case.all_of) and (not case.any_of or any(holds(r, point) for r in case.any_of)):
            return case.verdict.word
    return "undecided"


PAIR, (K1, K2, G1, N1, D1, D2) = ring("k1 k2 g n d1 d2")


def pair(parts: str) -> LinearSystem:
    """Two degrees of freedom with the forces named in ``parts``."""
    every: dict[str, Any] = {
        "D": [[D1, 0], [0, D2]],
        "G": [[0, G1], [-G1, 0]],
        "K": [[K1, 1], [1, K2]],
        "N": [[0, N1], [-N1, 0]],
    }
    return linear(PAIR, True, M=[[2, 1], [1, 1]], **{name: every[name] for name in parts})


FAMILIES = {
    "pitch": (PITCH, RANGES, 2),
    "yaw and roll": (YAW_ROLL, RANGES, 2),
    "gradient": (gradient_yaw_roll(), signs(GRADIENT, "positive positive positive"), 3),
    "ziegler": (ziegler(damped=False), signs(ZIEGLER), 2),
    "damped ziegler": (ziegler(damped=True), signs(ZIEGLER, "real positive positive"), 2),
    "gyroscopic": (gyroscopic_pair(), signs(TWO, "positive positive real real"), 2),
    "damped gyroscopic": (gyroscopic_pair(damped=True), signs(TWO, "real real real positive"), 1),
    "dissipative": (pair("DGK"), signs(PAIR, "real real real real positive positive"), 2),
    "any damping": (pair("DGK"), signs(PAIR), 2),
    "everything": (pair("DGKN"), signs(PAIR), 2),
    "without damping": (pair("GKN"), signs(PAIR), 1),
}


@pytest.mark.parametrize("name", sorted(FAMILIES))
def test_cases_are_true_at_random_points(name: str) -> None:
    """What the symbolic cases say at random parameter values is what the exact count of roots says there."""
    system, known, different = FAMILIES[name]
    found = analyse(system, known)
    random = np.random.default_rng(7)
    top = 12 if known.context is SATELLITE else 40
    seen = set()
    for _ in range(300):
        values = [F(int(n), 12) for n in random.integers(-top, top, known.context.nvars())]
        values = [abs(value) if word == "positive" else value for value, word in zip(values, known.words, strict=True)]
        point = [rational(value) for value in values]
        inside = all(values[i] or word == "real" for i, word in enumerate(known.words))
        inside = inside and all(p(*point) > 0 for p, _ in known.assumptions)
        if not inside or any(p(*point) <= 0 for p in found.mass.minors):
            continue
        exact = verdict_at(system, dict(enumerate(values))).verdict.word
        symbolic = read_off(found, point)
        assert symbolic in (exact, "undecided")
        border = any(r.polynomial(*point) == 0 for r in found.requirements)
        assert symbolic == exact or border
        seen.add(exact)
    assert len(seen) >= different


# -- requirements that take each other for granted --------------------------------------------------------------------

ONE, (X,) = ring("x")
POINTS = [rational(F(k, 3)) for k in range(-14, 15)]


def left_of_it_holds(wanted: Requirement, x: Any) -> bool:
    """The reduced condition at a point."""
    condition = wanted.condition
    if condition.kind in ("always", "never"):
        return condition.kind == "always"
    strict = condition.kind != "inequality" or condition.polynomial(x) > 0
    return bool(strict and all(p(x) != 0 for p in condition.nonzero))


@settings(max_examples=150)
@given(st.lists(st.tuples(st.integers(-4, 6), st.integers(-3, 3)), min_size=3, max_size=6))
def test_half_of_the_coefficients_decides_as_well(pairs: list[tuple[int, int]]) -> None:
    """Lienard-Chipart with every second coefficient left out, against the count of roots at points."""
    coefficients = (*(a + b * X for a, b in pairs), X * 0 + 1)
    known = signs(ONE)
    wanted = [Requirement(label, p, known.condition(p)) for label, p in lienard_chipart(coefficients)[1:]]
    kept = _without_implied(_spared(wanted, len(pairs)), known)
    for x in POINTS:
        stable = count_roots([fmpq(p(x)) for p in coefficients]).left == len(pairs)
        assert all(left_of_it_holds(r, x) for r in kept) == stable


def test_a_coefficient_is_spared() -> None:
    wanted = [
        Requirement(label, p, signs(ONE).condition(p))
        for label, p in lienard_chipart((X**2 + X, 1 + X, X**3 + X + 3, 2 * X + 1, X * 0 + 1))[1:]
    ]
    assert [r.label for r in wanted] == ["a3", "a2", "a1", "a0", "Hurwitz minor 3"]
    assert [r.label for r in _spared(wanted, 4)] == ["a3", "a1", "a0", "Hurwitz minor 3"]


@settings(max_examples=100)
@given(st.lists(st.tuples(st.integers(-3, 5), st.integers(-2, 2)), min_size=6, max_size=6))
def test_minors_may_presume_those_before_them(pairs: list[tuple[int, int]]) -> None:
    a, b, c, d, e, f = (p + q * X for p, q in pairs)
    rows = matrix(ONE, [[a, b, c], [b, d, e], [c, e, f]])
    found = definiteness(rows, signs(ONE), "K")
    for x in POINTS:
        values = [[fmpq(entry(x)) for entry in row] for row in rows]
        minors = [determinant([[ONE.constant(y) for y in row[:k]] for row in values[:k]])(0) for k in (1, 2, 3)]
        assert all(left_of_it_holds(r, x) for r in found.requirements) == all(m > 0 for m in minors)


def test_a_diagonal_matrix_shows_its_entries() -> None:
    context, (p, q) = ring("p q")
    rows = matrix(context, [[p, p * 0], [q * 0, p + q]])
    found = definiteness(rows, signs(context), "K")
    assert [r.condition.polynomial for r in found.requirements] == [p, p + q]
    assert [r.polynomial for r in found.requirements] == [p, p * (p + q)]


@settings(max_examples=60)
@given(st.integers(1, 4).flatmap(square))
def test_inertia(rows: list[list[int]]) -> None:
    symmetric = np.array(rows) + np.array(rows).T
    values = np.linalg.eigvalsh(symmetric)
    found = inertia(evaluated(matrix(NONE, symmetric.tolist()), RationalPoint({})))
    assert found == ((values > 1e-9).sum(), (abs(values) <= 1e-9).sum(), (values < -1e-9).sum())


def test_kinds() -> None:
    one, skew = [[1, 0], [0, 1]], [[0, 1], [-1, 0]]
    assert kind_of(linear(NONE, M=one)) == "conservative"
    assert kind_of(linear(NONE, M=one, G=skew)) == "gyroscopic conservative"
    assert kind_of(linear(NONE, M=one, D=one)) == "dissipative"
    assert kind_of(linear(NONE, M=one, N=skew)) == "circulatory"
    assert kind_of(linear(NONE, M=one, D=one, G=skew, N=skew)) == "gyroscopic dissipative circulatory"


BLOCK = "bodies:\n  - {name: a, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: m}\n"


def test_what_is_left_of_denominators_is_a_square() -> None:
    a = mbsym.loads(f"mbsym: 1\nname: x\nparameters: {{m: positive, a: real, b: real}}\n{BLOCK}")
    ring = a.ring
    m, p, q = (ring.generator("parameter", name) for name in ("m", "a", "b"))
    for powers, expected in (
        ([(p, 1)], p**2),
        ([(p, 3), (q, 2)], p**4 * q**2),
        ([(p, 1), (p, 1)], p**2),  # met twice: a square already
        ([(p, 1), (q, 1), (p, 2)], p**4 * q**2),
        ([(m, 1), (p, 1)], m * p**2),
    ):
        factor = ring.one
        for bottom, exponent in powers:
            factor = factor * bottom**exponent
        assert _even(ring, a.signs, factor, powers) == expected


def test_what_the_other_conditions_show_is_not_required_beside_them() -> None:
    """(s^2 + c s - k)^2 + B^2 s^2, c >= 0: c != 0 makes B^2 + c^2 positive, which Hurwitz' minor asks for."""
    context, (b, c, k) = ring("B c k")
    system = LinearSystem(
        M=((b * 0 + 1, b * 0), (b * 0, b * 0 + 1)), D=((c, b * 0), (b * 0, c)), G=((b * 0, -b), (b, b * 0)),
        K=((-k, b * 0), (b * 0, -k)), N=((b * 0,) * 2,) * 2,
    )  # fmt: skip
    case = analyse(system, signs(context, "real nonnegative real")).cases[0]
    left = {(str(r.condition.polynomial), tuple(map(str, r.condition.nonzero))) for r in case.all_of if not r.always}
    assert {f for _, nonzero in left for f in nonzero} == {"c"}
    assert {p for p, _ in left} == {"1", "-k"}


# -- conditions that imply others -------------------------------------------------------------------------------------


def test_of_the_conditions_of_a_minimum_those_of_the_paper_are_left() -> None:
    """gamma > p2 > 0 says gamma > 0; (alpha + gamma) (3 + p1) > 4 p2 (1 + alpha) > 0 says alpha + gamma > 0."""
    pitch, yaw_roll = analyse(PITCH, RANGES), analyse(YAW_ROLL, RANGES)
    (stable, unstable) = pitch.cases
    assert [r.polynomial / 9 for r in stable.all_of if not r.always] == [GAMMA - P2]
    assert [r.polynomial / 9 for r in unstable.any_of if not r.never] == [P2 - GAMMA]
    first = [r.condition.polynomial for r in yaw_roll.cases[0].all_of if not r.always]
    assert first[0] == ALPHA
    assert len(first) == 2
    assert first[1].degrees()[2] == 1  # p1 is in the one that is left
    assert not [r for r in yaw_roll.requirements if r.always and r.label == "v0"]  # the list of the paper is whole


def test_what_is_said_to_be_implied_is() -> None:
    """At random points of the declared signs; planted below: a ratio whose sign nobody knows proves nothing."""
    source = random.Random(28)
    context, names = ring("a b c")
    said = 0
    for _ in range(2000):
        words = source.choice(["positive positive real", "positive nonnegative positive", "real real positive"])
        known = signs(context, words)
        weak = sum((source.randint(-1, 2) * x for x in names), context.constant(source.randint(-1, 1)))
        strong = source.choice([weak, weak * (names[0] + 1), sum((source.randint(-1, 2) * x for x in names), names[0])])
        strong = strong - source.choice(names) * source.choice(names) * source.randint(-1, 2)
        one, other = (Requirement("r", p, known.condition(p)) for p in (strong, weak))
        if not _implies(one, other, known):
            continue
        said += 1
        for _ in range(40):
            point = [F(source.randint(-9, 9), source.randint(1, 5)) for _ in names]
            point = [x if word == "real" else abs(x) + 1 for x, word in zip(point, known.words, strict=True)]
            values = [fmpq(x.numerator, x.denominator) for x in point]
            assert strong(*values) <= 0 or weak(*values) > 0, (strong, weak, point)
    assert said > 20
    a, b, _ = names
    known = signs(context, "real positive positive")
    assert not _implies(*(Requirement("r", p, known.condition(p)) for p in (a * (b - 2) - 1, b - 2)), known)


@settings(60)
@given(st.data())
def test_cases_without_what_is_implied_hold_where_they_held(data: st.DataObject) -> None:
    """At all points of a grid that has zeros: conditions that all have to hold, and alternatives, with their f != 0."""
    context, names = ring("a b c")
    known = signs(
        context, data.draw(st.sampled_from(["real positive real", "nonnegative positive real", "real real real"]))
    )
    small = st.integers(-2, 2)

    def required() -> Requirement:
        weights = [data.draw(small) for _ in range(4)]
        p = sum((w * x * x for w, x in zip(weights, names, strict=False)), context.constant(weights[3]))
        p *= data.draw(st.sampled_from(names)) ** data.draw(st.sampled_from([0, 2]))
        return Requirement("r", p, known.condition(p))

    case = Case(*(tuple(required() for _ in range(3)) for _ in range(2)), depends())
    left = theory._without_implications(case, known)
    allowed = {
        "positive": (F(1, 3), F(1), F(2)),
        "nonnegative": (F(0), F(1), F(2)),
        "real": (F(-2), F(-1, 2), F(0), F(1)),
    }
    for point in product(*(allowed[word] for word in known.words)):
        values = [fmpq(x.numerator, x.denominator) for x in point]

        def holds(r: Requirement, values: list[fmpq] = values) -> bool:
            c = r.condition
            true = {"always": True, "nonzero": True, "never": False}.get(c.kind)
            return (c.polynomial(*values) > 0 if true is None else true) and all(f(*values) != 0 for f in c.nonzero)

        assert all(map(holds, left.all_of)) == all(r.polynomial(*values) > 0 for r in case.all_of)
        assert any(map(holds, left.any_of)) == any(r.polynomial(*values) > 0 for r in case.any_of)
