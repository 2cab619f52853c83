"""All relative equilibria: the exact solver against systems solved elsewhere, mechanics against independent statics."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from itertools import permutations, product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from conftest import SHIPPED, WITH_BODIES, at_values, filed, reference
from flint import arb, fmpq
from test_spectrum import SHAFT

import mbsym
from mbsym.algebra import krawczyk
from mbsym.algebra.failures import Constrained
from mbsym.algebra.polynomial_systems import Limits, Solutions, context, solve
from mbsym.analysis import Analysis, Unavailable
from mbsym.analysis.resting import relative_equilibria
from mbsym.expressions.tree import Name
from mbsym.mechanics.charts import joints
from mbsym.mechanics.rest import given_values, missing_values
from mbsym.numerics.scenario import exact
from mbsym.problems.relative_equilibria.equilibria import CERTIFIED, EXACT, Equilibria, RelativeEquilibrium, equilibria
from mbsym.problems.stability.enclosed import enclosed_verdict
from mbsym.problems.stability.problem import parameter_values
from mbsym.report.content import Table
from mbsym.studies.equilibria import STUDY
from mbsym.studies.equilibria.listed import lines
from mbsym_cli.study import command_of


def at(source: str, **values: str | int) -> tuple[Analysis, Equilibria]:
    """A shipped system (by name) or a description (as text), and its equilibria at other values."""
    a = mbsym.loads(source) if "\n" in source else mbsym.load(SHIPPED / f"{source}.yaml")
    given = given_values(a.system, {name: Fraction(value) for name, value in values.items()})
    return a, equilibria(a.system, given)


def texts(one: RelativeEquilibrium) -> tuple[str, ...]:
    return tuple(item.text for item in one.values)


def words(found: Equilibria) -> dict[tuple[str, ...], str]:
    return {texts(one): one.verdict.word for one in found.equilibria}


# --- the solver ------------------------------------------------------------------------------------------------------


def solved(names: str, equations: list[str], nonzero: list[str] | None = None, **limits: int) -> Solutions:
    known: Mapping[str, Any] = dict(zip(names.split(), context(names.split()).gens(), strict=True))
    made = [eval(text, {"__builtins__": {}}, known) for text in equations]
    apart = [eval(text, {"__builtins__": {}}, known) for text in nonzero or []]
    found = solve(made, apart, limits=Limits(**limits) if limits else None)
    for point in found.points:
        assert all(point.residue(x) == 0 for x in made), "exactly zero in the number field"
        assert all(point.residue(x) != 0 for x in apart)
    return found


def places(found: Solutions) -> list[tuple[float, ...]]:
    return sorted(tuple(round(float(x.mid()), 9) + 0.0 for x in point.enclosures()) for point in found.points)


def test_circle_and_parabola() -> None:
    golden = (math.sqrt(5) - 1) / 2
    found = solved("x y", ["x**2 + y**2 - 1", "x**2 - y"])
    assert places(found) == [(pytest.approx(sign * math.sqrt(golden)), pytest.approx(golden)) for sign in (-1, 1)]
    assert not found.unfinished


def test_multiple_solutions_are_listed_once() -> None:
    found = solved("x y", ["x**2 + y**2 - 2", "(x*y - 1)**2"])  # a circle that touches a hyperbola, counted twice
    assert places(found) == [(-1, -1), (1, 1)]


def test_cyclic_five() -> None:
    """cyclic-5 has 70 solutions (Backelin and Froeberg), 10 of them real."""
    names = [f"x{k}" for k in range(5)]
    sums = ["+".join("*".join(names[(i + j) % 5] for j in range(k)) for i in range(5)) for k in range(1, 5)]
    found = solved(" ".join(names), [*sums, "*".join(names) + "-1"])
    assert len(found.points) == 10
    assert not found.unfinished


def test_one_solution_of_many_is_real() -> None:
    assert places(solved("x y", ["x**3 - 2", "y**3 - x"])) == [
        (pytest.approx(2 ** (1 / 3)), pytest.approx(2 ** (1 / 9)))
    ]
    assert places(solved("x y", ["x**2 + y**2"])) == [(0, 0)]
    assert not solved("x y", ["x**2 + 1", "y - x"]).points


def test_what_must_not_vanish_is_left_out() -> None:
    equations = ["x**2 + y**2 - 1", "x*y"]
    assert len(solved("x y", equations).points) == 4
    assert places(solved("x y", equations, ["x"])) == [(-1, 0), (1, 0)]


def test_families_are_not_points() -> None:
    found = solved("x y z", ["x*y", "x*z", "(y - 1)*z"])
    assert not found.points, "(0, 1, 0) and the origin lie on lines"
    assert [family.dimension for family in found.families] == [1, 1, 1]
    assert not found.unfinished


def test_a_point_beside_a_family() -> None:
    found = solved("x y z", ["x*(x - 1)", "x*y", "x*(z - 2)"])  # the plane x = 0 and the point (1, 0, 2)
    assert places(found) == [(1, 0, 2)]
    assert [family.dimension for family in found.families] == [2]


def test_a_narrow_ring_is_a_family_and_not_the_points_at_which_it_crosses_axes() -> None:
    """cos(a) cos(b) = 20/21: neither cosine can be 3/5; four of its points have a = 0, pi or b = 0, pi."""
    found = solved("s c u d", ["s**2 + c**2 - 1", "u**2 + d**2 - 1", "21*c*d - 20"])
    assert (places(found), found.unfinished) == ([], ())
    (family,) = found.families
    assert family.dimension == len(family.free) == 1


def test_a_family_without_real_points_is_not_claimed() -> None:
    found = solved("x y z", ["x**2 + y**4 + z**2 + x*y + 3"])
    assert not found.families
    assert found.unfinished


def test_limits_are_reported() -> None:
    found = solved("x y z", ["x**3*y + y*z - 3", "y**3*z - x*z + 1", "z**3*x + x*y*z - 5"], pairs=3)
    assert "S-polynomials" in found.unfinished[0]


@pytest.mark.parametrize("seed", range(4))
def test_random_conics(seed: int) -> None:
    """Against the real roots of a resultant, by numpy."""
    source = np.random.default_rng(seed)
    a, b = ([int(v) for v in source.integers(-4, 5, 6)] for _ in range(2))
    shape = "{}*x**2 + {}*x*y + {}*y**2 + {}*x + {}*y + {}"
    found = solved("x y", [shape.format(*a), shape.format(*b)])
    x = np.poly1d([1, 0])

    def of(k: list[int]) -> list[Any]:  # coefficients of y^2, y, 1 as polynomials in x
        return [np.poly1d([k[2]]), k[1] * x + k[4], k[0] * x**2 + k[3] * x + k[5]]

    (p2, p1, p0), (q2, q1, q0) = of(a), of(b)
    resultant = (p2 * q0 - p0 * q2) ** 2 - (p2 * q1 - p1 * q2) * (p1 * q0 - p0 * q1)
    roots = [r.real for r in resultant.roots if abs(r.imag) < 1e-9]
    if found.families or len({round(r, 6) for r in roots}) < len(roots):
        pytest.skip("a common factor or a double root")
    assert sorted(x for x, _ in places(found)) == pytest.approx(sorted(roots), abs=1e-6)


# --- boxes -----------------------------------------------------------------------------------------------------------


def test_bisection_finds_every_root() -> None:
    found = krawczyk.search(lambda b: [(3 * b[0]).sin()], lambda b: [[3 * (3 * b[0]).cos()]], [(-3.3, 3.4)], 500)
    middles = sorted(float(box[0].mid()) for box in found.roots)
    assert middles == pytest.approx([k * math.pi / 3 for k in range(-3, 4)], abs=1e-3)
    assert not found.open_boxes


def test_a_double_root_stays_open() -> None:
    found = krawczyk.search(lambda b: [b[0] * b[0]], lambda b: [[2 * b[0]]], [(-1.0, 1.5)], 300)
    assert not found.roots
    assert any(box[0].contains(0) for box in found.open_boxes)
    assert krawczyk.certified(lambda b: [b[0] * b[0]], lambda b: [[2 * b[0]]], [0.1]) is None
    assert krawczyk.certified(lambda b: [b[0] * b[0] + 1], lambda b: [[2 * b[0]]], [0.1]) is None


def test_verdicts_in_balls_never_claim_a_border() -> None:
    def rows(*numbers: Any) -> list[list[Any]]:
        return [[arb(numbers[0]), arb(numbers[1])], [arb(numbers[2]), arb(numbers[3])]]

    one, nothing = rows(1, 0, 0, 1), rows(0, 0, 0, 0)
    wide = arb(0, 1e-20)

    def word(k: Any, g: Any = nothing, d: Any = nothing, conservative: bool = True) -> str:
        return enclosed_verdict([one, d, g, k, nothing], conservative).word

    assert word(rows(2, 0, 0, 3)) == "stable"
    assert word(rows(2, 0, 0, 3), conservative=False) == "stable in first approximation only"
    assert word(rows(2, 0, 0, -3)) == "unstable"
    assert word(rows(-1, 0, 0, -2), rows(0, 9, -9, 0)) == "gyroscopically stabilised only"
    assert word(rows(-1, 0, 0, -2), rows(0, 1, -1, 0)) == "unstable"
    assert word(rows(2, 0, 0, 3), d=rows(1, 0, 0, 1)) == "asymptotically stable"
    assert word([[arb(2), arb(0)], [arb(0), wide]]) == "undecided"
    assert word(nothing, rows(0, 9, -9, 0)) == "undecided"


# --- pendulums, tops -------------------------------------------------------------------------------------------------


def test_double_pendulum() -> None:
    a, found = at("double-pendulum")
    assert found.complete
    assert words(found) == {
        ("0", "0"): "stable",
        ("0", "pi"): "unstable",
        ("pi", "0"): "unstable",
        ("pi", "pi"): "unstable",
    }
    assert {one.proof for one in found.equilibria} == {EXACT}
    assert a.equilibria == found


def test_spring_pendulum_exactly() -> None:
    """r = l0 +- m g / k, here 1 +- 9.81/40."""
    _, found = at("spring-pendulum")
    assert words(found) == {("0", "4981/4000"): "stable", ("pi", "3019/4000"): "unstable"}
    assert found.complete


def test_cart_position_is_arbitrary() -> None:
    _, found = at("cart-pendulum")
    assert {one.free for one in found.equilibria} == {("x",)}
    assert len(found.equilibria) == 4
    assert words(found)["0", "0"] == "unstable"
    assert words(found)["pi", "pi"].startswith("stable but for a drift")
    _, pushed = at("cart-pendulum", F=1)  # a steady force accelerates it: no equilibrium at all
    assert pushed.equilibria == ()
    assert pushed.complete


@pytest.mark.parametrize(("rate", "tilted"), [(4, True), (3, False)])
def test_conical_pendulum(rate: int, tilted: bool) -> None:
    """cos(theta) = g/(l Omega^2), if that is less than 1; on the axis the azimuth is no coordinate.

    At -theta, with the azimuth half a turn on, the bob is at the same place.
    """
    _, found = at("spherical-pendulum", Omega=rate)
    angles = sorted(one.values[0].value for one in found.equilibria)
    expected = [math.acos(9.81 / rate**2)] if tilted else []
    assert angles == pytest.approx(expected, abs=1e-12)
    assert found.complete
    assert [texts(one) for one in found.singular] == [("0",), ("pi",)]
    assert any("singular" in remark for remark in found.remarks)


SPINNING = """
mbsym: 1
name: spinning gyrostat
parameters: {{A: 5, B: 4, C: 2, h: 0}}
bodies:
  - name: body
    attached to: 0
    rotation: {{axes: [3, {second}, {third}], angles: [phi, alpha, beta]}}
    mass: 1
    inertia about: mass centre
    inertia: [A, B, C]
    gyrostatic moment: [0, 0, h]
motion: {{phi: {{value: 0, rate: 1}}, alpha: 0, beta: 0}}
"""


def spin_directions(found: Equilibria, second: int, third: int) -> list[tuple[float, ...]]:
    """What the body sees of the axis that it spins about, from the angles (of the other sequence where it says so)."""
    seen = []
    for one in found.equilibria:
        axes = (second, third)
        if one.coordinates_of:
            axes = (third, second) if third != 3 else (second, 6 - 3 - second)
        n = np.array([0.0, 0.0, 1.0])
        for axis, item in zip(axes, one.values, strict=True):
            i, j = axis % 3, (axis + 1) % 3
            c, s = math.cos(item.value), math.sin(item.value)
            n[i], n[j] = c * n[i] + s * n[j], c * n[j] - s * n[i]
        seen.append(tuple(float(round(x, 9)) + 0.0 for x in n))
    return sorted(seen)


@pytest.mark.parametrize(("second", "third"), [(1, 2), (2, 1), (1, 3), (2, 3)])
def test_a_spinning_gyrostat_in_every_sequence(second: int, third: int) -> None:
    """n x (J n + h e3) = 0 for the unit vector n of the spin at the rate 1, solved by hand.

    n = +-e3;  n2 = 0, n3 = h/(A - C);  n1 = 0, n3 = h/(B - C), where these are less than 1.  Each sequence of angles is
    singular at one of the axes, where it has solutions that are no equilibria.
    """
    source = SPINNING.format(second=second, third=third)
    for h in (Fraction(0), Fraction(1), Fraction(5, 2)):
        _, found = at(source, h=str(h))
        expected = [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)]
        for place, moment in ((0, 5), (1, 4)):
            along = float(h / (moment - 2))
            if along < 1:
                for sign in (1, -1):
                    n = [0.0, 0.0, along]
                    n[place] = sign * math.sqrt(1 - along**2)
                    expected.append((round(n[0], 9), round(n[1], 9), round(n[2], 9)))
        assert spin_directions(found, second, third) == sorted(expected), (h, second, third)
        assert found.complete
        assert not found.singular


def test_a_spin_that_may_be_turned_is_judged_as_in_problem_6() -> None:
    """Lyapunov and Malkin's theorem for the spin of a free body with a damper, by the same name in both places."""
    a, found = at("satellite-with-damper")
    verdict = a.stability.numerical
    assert verdict is not None
    upright = next(one for one in found.equilibria if texts(one) == ("0", "0", "0"))
    assert (upright.verdict.word, upright.verdict.theorem) == (verdict.word, verdict.theorem)
    assert verdict.word == "asymptotically stable but for a rotation of space"


def test_spherical_pendulum_at_rest_is_seen_in_other_angles() -> None:
    _, found = at("spherical-pendulum", Omega=0)
    assert [(texts(one), one.verdict.word) for one in found.equilibria] == [
        (("0", "0"), "stable"),
        (("pi", "0"), "unstable"),
    ]
    assert {one.coordinates_of for one in found.equilibria} == {"rod {1, 2}"}


TOP = """
mbsym: 1
name: top in Euler angles
parameters: {A: positive, C: positive, m: positive, l: positive, g: positive, Omega: positive, sigma: positive}
bodies:
  - name: top
    attached to: 0
    rotation: {axes: [3, 1, 3], angles: [psi, theta, phi]}
    mass centre: [0, 0, l]
    mass: m
    inertia about: joint
    inertia: [A, A, C]
loads:
  - uniform gravity: {acceleration: g, direction: [0, 0, -1]}
motion: {psi: {value: 0, rate: Omega}, theta: 0, phi: {value: 0, rate: sigma}}
values: {A: 3, C: 1, m: 1, l: 1, g: 10, Omega: 2, sigma: 6}
"""


def test_regular_precession_of_a_top() -> None:
    """C Omega (sigma + Omega cos theta) - A Omega^2 cos theta = m g l."""
    _, found = at(TOP)
    tilted = [one for one in found.equilibria if one.verdict.word != "undecided"]
    cosine = (10 - 1 * 2 * 6) / ((1 - 3) * 4)
    assert sorted(one.values[0].value for one in tilted) == pytest.approx([-math.acos(cosine), math.acos(cosine)])
    assert {one.verdict.word for one in tilted} == {"stable but for a drift of cyclic coordinates"}


def test_sleeping_and_hanging_top() -> None:
    """Maievskii: C^2 Omega^2 > 4 A m g l at Omega = 30 (9 > 5.886), not at 20 (4 < 5.886).

    Where it holds the top sleeps in the nonlinear system, too (Lagrange's top: energy and both momenta).
    """
    drifts = "stable but for a drift of cyclic coordinates"
    for rate, upright in ((30, drifts), (20, "unstable")):
        _, found = at("heavy-top", Omega=rate)
        assert len(found.equilibria) == 2
        assert words(found)["0", "0"] == upright
        assert words(found)["pi", "0"] == drifts


# --- what is not polynomial ------------------------------------------------------------------------------------------


def test_a_follower_force_at_the_tip_bends_no_joint() -> None:
    """k (theta2 - theta1) = 0 at the upper joint, so nothing is left for the lower one but k theta1 = 0."""
    _, found = at("ziegler")
    assert words(found) == {("0", "0"): "stable in first approximation only"}
    assert found.complete
    assert any("outside sine and cosine" in remark for remark in found.remarks)


EXPONENTIAL = """
mbsym: 1
name: pendulum in a field
parameters: {m: positive, l: positive, g: positive, k: positive}
bodies:
  - name: bob
    attached to: 0
    rotation: {axes: [3], angles: [theta]}
    mass centre: [0, -l, 0]
    mass: m
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
  - potential: k*exp(sin(theta))
values: {m: 1, l: 1, g: 2, k: 3}
"""


def test_exponentials_by_bisection() -> None:
    """-g m l sin - k exp(sin) cos = 0, roots by a fine scan."""
    _, found = at(EXPONENTIAL)
    grid = np.linspace(-math.pi, math.pi, 20_001)
    force = -2 * np.sin(grid) - 3 * np.exp(np.sin(grid)) * np.cos(grid)
    expected = grid[:-1][np.diff(np.sign(force)) != 0]
    assert sorted(one.values[0].value for one in found.equilibria) == pytest.approx(sorted(expected), abs=1e-3)
    assert {one.proof for one in found.equilibria} == {CERTIFIED}
    assert Counter(one.verdict.word for one in found.equilibria) == {"stable": 1, "unstable": 1}


ROOTS = """
mbsym: 1
name: bead between springs
parameters: {m: positive, k: positive, a: positive, l: positive}
bodies:
  - name: bead
    attached to: 0
    connection point: [x, 0, 0]
    mass: m
    coordinates: [x]
loads:
  - spring: {between: [{body: bead, point: [0, 0, 0]}, {body: 0, point: [0, a, 0]}], stiffness: k, length: l}
values: {m: 1, k: 1, a: 3, l: 5}
"""


@pytest.mark.parametrize(
    ("potential", "slope"),
    [
        ("exp(x/9) + cos(x)", lambda x: np.exp(x / 9) / 9 - np.sin(x)),
        ("sin(x) + sin(sqrt(2)*x)", lambda x: np.cos(x) + np.sqrt(2) * np.cos(np.sqrt(2) * x)),
    ],
)
def test_a_sine_beside_another_function_of_the_same_length_has_no_period(
    potential: str, slope: Callable[[np.ndarray], np.ndarray]
) -> None:
    """V'(x) = 0 has a root between any two samples of opposite signs, and there are others beyond |x| = 10."""
    body = {"name": "P", "connection point": ["x", 0, 0], "mass": 1, "coordinates": ["x"]}
    description = {"mbsym": 1, "name": "bead", "bodies": [body], "loads": [{"potential": potential}]}
    _, found = at(json.dumps(description, indent=1))
    samples = slope(np.linspace(-10, 10, 20001))
    assert len(found.equilibria) == np.count_nonzero(samples[1:] * samples[:-1] < 0) > 2
    beyond = slope(np.linspace(10.1, 16, 6001))
    assert np.any(beyond[1:] * beyond[:-1] < 0)
    assert not found.complete


def test_a_function_of_a_sine_keeps_its_period() -> None:
    """V = exp(cos x) + sin x: V' = cos x - exp(cos x) sin x changes its sign twice in a turn."""
    body = {"name": "P", "connection point": ["x", 0, 0], "mass": 1, "coordinates": ["x"]}
    loads = [{"potential": "exp(cos(x)) + sin(x)"}]
    _, found = at(json.dumps({"mbsym": 1, "name": "bead", "bodies": [body], "loads": loads}, indent=1))
    angles = np.linspace(-np.pi, np.pi, 6001)
    samples = np.cos(angles) - np.exp(np.cos(angles)) * np.sin(angles)
    assert len(found.equilibria) == np.count_nonzero(samples[1:] * samples[:-1] < 0) == 2
    assert found.complete


def test_distances_are_solved_exactly() -> None:
    """x (1 - l/sqrt(x^2 + a^2)) = 0: 0 and +-sqrt(l^2 - a^2) = +-4; if the spring is short only 0."""
    _, found = at(ROOTS)
    assert words(found) == {("0",): "unstable", ("4",): "stable", ("-4",): "stable"}
    assert found.complete
    _, short = at(ROOTS, l=2)
    assert words(short) == {("0",): "stable"}, "the root of the other sign is no length"


# --- the satellite in orbit ------------------------------------------------------------------------------------------


def turned(axis: int, x: float) -> np.ndarray:
    """C_a(x), as the documentation states the convention."""
    i, j = axis % 3, (axis + 1) % 3
    matrix = np.eye(3)
    matrix[i, i] = matrix[j, j] = math.cos(x)
    matrix[i, j], matrix[j, i] = math.sin(x), -math.sin(x)
    return matrix


def orientation(one: RelativeEquilibrium) -> np.ndarray:
    axes = (
        [int(x) for x in one.coordinates_of.partition("{")[2].rstrip("}").split(",")]
        if one.coordinates_of
        else [2, 3, 1]
    )
    first, second, third = (turned(a, item.value) for a, item in zip(axes, one.values, strict=True))
    return third @ second @ first


def expected_word(along: float, outward: float, normal: float) -> str:
    """Of the moments about the velocity, the radius and the normal: Lagrange, DeBra and Delp (Smelt's parameters)."""
    if normal > along > outward:
        return "stable"
    yaw, roll = (normal - along) / outward, (normal - outward) / along
    pitch = along > outward
    middle = 1 + 3 * roll + roll * yaw
    if pitch and roll * yaw > 0 and middle > 4 * math.sqrt(roll * yaw):
        return "gyroscopically stabilised only"
    return "unstable"


@pytest.mark.parametrize(
    ("moments", "stabilised"), [(("12", "9", "15"), 0), (("1", "0.99", "0.96"), 4), (("2", "2.5", "1"), 0)]
)
def test_rigid_satellite_has_24_equilibria(moments: tuple[str, str, str], stabilised: int) -> None:
    analysis, found = at("gravity-gradient", **dict(zip("ABC", moments, strict=True)))
    count = reference("gravity_gradient")["reference"]["equilibria"]["triaxial"]
    assert count == 24
    assert len(found.equilibria) == count
    assert found.complete
    assert not found.families
    body = np.array([float(x) for x in moments])
    seen = set()
    for one in found.equilibria:
        matrix = orientation(one)
        assert one.described == 2, "both sets of angles of each"
        seen.add(tuple(round(x) for x in matrix.flat))
        assert np.abs(matrix - np.round(matrix)).max() < 1e-12
        along, outward, normal = (float(body @ matrix[:, k] ** 2) for k in range(3))
        assert one.verdict.word == expected_word(along, outward, normal)
    signed = (
        tuple(int(s[i] * (p[i] == j)) for i in range(3) for j in range(3))
        for p in permutations(range(3))
        for s in product((1, -1), repeat=3)
    )
    assert seen == {m for m in signed if round(np.linalg.det(np.array(m).reshape(3, 3))) == 1}
    # Those at which the angles are singular stand together, and no column is there for them alone.
    own, others = (block for block in lines(analysis.system, found) if isinstance(block, Table))
    assert len(own.columns) == len(others.columns)
    assert sorted(int(row[0][0]) for row in (*own.rows, *others.rows)) == list(range(1, 25))
    assert [int(row[0][0]) for row in others.rows] == [
        number for number, one in enumerate(found.equilibria, 1) if one.coordinates_of
    ]
    verdicts = Counter(one.verdict.word for one in found.equilibria)
    assert verdicts["stable"] == 4
    assert verdicts["gyroscopically stabilised only"] == stabilised


def test_symmetric_satellite_has_families() -> None:
    """A turn about the axis of symmetry changes nothing: no isolated equilibria."""
    _, found = at("gravity-gradient", A=12, B=12, C=15)
    assert found.equilibria == ()
    assert {family.dimension for family in found.families} == {1}
    assert {family.free for family in found.families} == {("psi",), ("theta",)}


def test_spherical_satellite_rests_everywhere() -> None:
    _, found = at("gravity-gradient", A=12, B=12, C=12)
    (one,) = found.equilibria
    assert set(one.free) == {"psi", "theta", "phi"}


def test_the_other_route_agrees() -> None:
    """Lagrange's equations vanish on what statics found; a slightly different body does not rest there."""
    a, found = at("gravity-gradient")
    for one in found.equilibria:
        if one.coordinates_of:
            continue
        numbers = {
            name: arb(fmpq(value.numerator, value.denominator)) for name, value in given_values(a.system, {}).items()
        }
        balls = dict.fromkeys(a.ring.names(), arb(0)) | numbers | {"chi": arb(1.25)}
        for item in one.values:
            parts = item.text.replace("pi", "1").split("/")
            balls[item.name] = arb.pi() * fmpq(*map(int, parts)) if "pi" in item.text else arb(0)
        for force in a.equations.forcing:
            assert abs(a.ring.evaluate(force.polynomial, balls)) < arb(1e-12)
        balls["psi"] += arb(0.01)
        assert any(not a.ring.evaluate(f.polynomial, balls).contains(0) for f in a.equations.forcing)


@pytest.mark.parametrize("name", ["gravity-gradient", "double-pendulum", "dumbbell", "spring-pendulum", "ziegler"])
def test_problem_six_agrees_on_the_given_motion(name: str) -> None:
    """The description's own equilibrium is on the list, with the verdict of problem 6."""
    a = mbsym.load(SHIPPED / f"{name}.yaml")
    assert a.stability.numerical is not None
    origin = [one for one in a.equilibria.equilibria if one.values[0].text == "0" and one.values[-1].text != "pi"]
    assert a.stability.numerical.word in {one.verdict.word for one in origin if not one.coordinates_of}


def test_satellite_with_a_stabilizer_in_the_plane_of_its_orbit() -> None:
    """Two angles; all equilibria, the oblique ones as algebraic numbers, by Lagrange's equations once more."""
    whole = (SHIPPED / "satellite.yaml").read_text(encoding="utf-8")
    planar = whole.replace("axes: [2, 3, 1], angles: [psi, theta, phi]", "axes: [3], angles: [theta]")
    planar = planar.replace("axes: [3, 1, 0], angles: [delta, sigma, 0]", "axes: [3], angles: [delta]")
    planar = planar.replace("motion: {psi: 0, theta: 0, phi: 0, delta: 0, sigma: 0}", "motion: {theta: 0, delta: 0}")
    a, found = at(planar.partition("initial:")[0])
    assert found.complete
    assert len(found.equilibria) % 2 == 0, "half a turn of everything is a symmetry"
    assert words(found)["0", "0"] == a.stability.numerical.word
    assert any(not item.exact for one in found.equilibria for item in one.values)
    numbers = {k: arb(fmpq(v.numerator, v.denominator)) for k, v in given_values(a.system, {}).items()}

    def forces(theta: float, delta: float) -> list[float]:
        place = dict.fromkeys(a.ring.names(), arb(0)) | numbers | {"chi": arb(0.3)}
        place |= {"theta": arb(theta), "delta": arb(delta)}
        return [float(a.ring.evaluate(x.polynomial, place).mid()) for x in a.equations.forcing]

    for one in found.equilibria:
        place = [item.value for item in one.values]
        assert max(map(abs, forces(*place))) < 1e-11
        assert max(map(abs, forces(place[0] + 0.01, place[1]))) > 1e-5
    # Independently: Newton's method on Lagrange's equations, from the points of a grid.
    grid = np.linspace(-math.pi, math.pi, 11)
    starts = [(x, y) for x in grid for y in grid]
    seen = set()
    for x, y in starts:
        q = np.array([x, y])
        for _ in range(30):
            f = np.array(forces(*q))
            slope = np.array([(np.array(forces(*(q + h))) - f) / 1e-6 for h in 1e-6 * np.eye(2)]).T
            q = q - np.linalg.lstsq(slope, f, rcond=None)[0].clip(-0.5, 0.5)
            if np.abs(f).max() < 1e-12:
                break
        if np.abs(np.array(forces(*q))).max() < 1e-10:
            seen.add(tuple(np.round([math.cos(q[0]), math.sin(q[0]), math.cos(q[1]), math.sin(q[1])], 5) + 0.0))
    ours = {
        tuple(np.round([f(item.value) for item in one.values for f in (math.cos, math.sin)], 5) + 0.0)
        for one in found.equilibria
    }
    assert seen == ours


# --- the command -----------------------------------------------------------------------------------------------------


def run(*arguments: str) -> Any:
    return CliRunner().invoke(command_of(STUDY), [*arguments])


def test_command_prints_a_table() -> None:
    result = run(str(SHIPPED / "gravity-gradient.yaml"))
    assert result.exit_code == 0
    assert "24 relative equilibria: 4 stable; 20 unstable" in result.output
    assert "the list is complete" in result.output


def test_command_prints_json() -> None:
    result = run(str(SHIPPED / "double-pendulum.yaml"), "--set", "m2=3/2", "--json")
    data = json.loads(result.stdout)
    assert data["values"]["m2"] == "3/2"
    assert data["complete"]
    assert [one["stability"]["verdict"] for one in data["equilibria"]] == ["stable", "unstable", "unstable", "unstable"]
    assert data["equilibria"][1]["coordinates"][1] | {} == {
        "name": "theta2",
        "value": "pi",
        "exact": True,
        "number": pytest.approx(math.pi),
    }


def test_every_missing_value_is_named(tmp_path: Path) -> None:
    text = "\n".join(x for x in TOP.splitlines() if not x.startswith("values"))
    path = filed(tmp_path / "top.yaml", text)
    result = run(str(path), "--set", "A=3")
    assert result.exit_code == 2
    assert "C, m, l, g, Omega, sigma" in result.stderr
    a = mbsym.loads(text)
    assert missing_values(a.system, {"A": Fraction(3)}) == ("C", "m", "l", "g", "Omega", "sigma")
    with pytest.raises(Unavailable, match="no number for A, C"):
        a.equilibria  # noqa: B018


def test_relations_need_no_value() -> None:
    a = mbsym.load(SHIPPED / "gravity-gradient.yaml")
    numbers = {name: value for name, value in given_values(a.system, {}).items() if name != "nu"}
    assert missing_values(a.system, numbers) == ()
    assert len(equilibria(a.system, numbers).equilibria) == 24


@pytest.mark.parametrize("setting", ["m1=-1", "theta1=2", "m1", "m3=1", "m1=-sqrt(2)", "m1=theta1"])
def test_wrong_settings_are_refused(setting: str) -> None:
    result = run(str(SHIPPED / "double-pendulum.yaml"), "--set", setting)
    assert result.exit_code == 2
    assert "error" in result.stderr


def test_a_load_that_varies_with_time_is_said_to_be_why_nothing_rests() -> None:
    _, found = at(
        """
mbsym: 1
name: pushed
parameters: {m: 1, k: 2}
bodies:
  - {name: block, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}
loads:
  - spring: {coordinate: x, stiffness: k}
  - generalized force: {x: sin(3*t)}
"""
    )
    assert found.equilibria == ()
    assert found.complete
    assert found.remarks == ("the equations vary with t: a relative equilibrium has to satisfy them at all times",)


@pytest.mark.parametrize(
    "path",
    [path for path in WITH_BODIES if not path.stem.startswith("satellite") or "damper" in path.stem],  # half a minute
    ids=lambda path: path.stem,
)
def test_the_described_motion_is_listed_and_judged_as_problem_6_does(path: Path) -> None:
    """Another route to every verdict: problem 6 judges matrices by quadratisation, with symbols, at the same values."""
    a = mbsym.load(path)
    if a.system.constraints:
        try:
            found = relative_equilibria(a.system, given_values(a.system, {}))
        except Constrained:  # they tie what moves
            return
        if found.families:  # nothing acts on the linkage: it rests everywhere
            return
    else:
        found = None
    try:
        judged = a.stability.numerical
    except Unavailable:
        pytest.skip("no unperturbed motion")
    values = parameter_values(a.parameters_scene, a.equilibrium)
    assert judged is not None
    assert values is not None
    motion = {
        entry.coordinate: float(
            values[entry.value.name] if isinstance(entry.value, Name) else exact(entry.value, values)
        )
        for entry in a.system.motion
    }
    found = found or relative_equilibria(a.system, values)

    def is_described(one: RelativeEquilibrium) -> bool:
        places = [item for item in one.values if item.name not in a.system.velocities]
        apart = [(item.value - motion.get(item.name, 0.0), item.angle) for item in places]
        gaps = [math.remainder(gap, 2 * math.pi) if angle else gap for gap, angle in apart]
        return not one.coordinates_of and max(map(abs, gaps), default=0.0) < 1e-9

    listed = [one for one in (*found.equilibria, *found.singular) if is_described(one)]
    assert len(listed) == (0 if judged.explanation.startswith("The motion does not exist there") else 1)
    words = {one.verdict.word for one in listed}
    assert words <= {judged.word}


@pytest.mark.parametrize("rate", [1, 3])
def test_a_spin_at_any_rate_is_judged_as_in_problem_6(rate: int) -> None:
    """lambda^2 + omega^2 divides the determinant: at the rate 1 omega and omega^2 cannot be told apart."""
    _, found = at("satellite-with-damper", omega=rate)
    judged = at_values(SHIPPED / "satellite-with-damper.yaml", omega=rate).stability.numerical
    upright = next(one for one in found.equilibria if texts(one) == ("0", "0", "0"))
    assert (upright.verdict.word, upright.verdict.theorem) == (judged.word, judged.theorem)
    assert upright.verdict.word == "asymptotically stable but for a rotation of space"


@pytest.mark.parametrize(("b", "word"), [(3, "asymptotically stable"), (-3, "unstable")])
def test_gyroscopic_and_circulatory_forces_have_their_signs(b: int, word: str) -> None:
    """z'' + (1 + i b) z' + (1 + 2 i) z = 0 is stable iff 1 + 2 b - 4 > 0 (Bilharz)."""
    _, found = at(SHAFT.format(b=b, c=1))
    assert [one.verdict.word for one in found.equilibria] == [word]


CIRCULATORY = """
mbsym: 1
name: Circulatory
parameters: {m: 1, c: 1, k: 3, d: 1}
bodies:
  - {name: block, attached to: 0, connection point: [x, y, 0], mass: m, coordinates: [x, y]}
loads:
  - spring: {coordinate: y, stiffness: k}
  - damper: {coordinate: x, coefficient: d}
  - damper: {coordinate: y, coefficient: d}
  - generalized force: {x: c*y, y: -c*x}
motion: {x: 0, y: 0}
"""


def test_a_circulatory_force_on_a_cyclic_coordinate_holds_it() -> None:
    """s = lambda^2 + lambda, s^2 + 3 s + 1 = 0: s = (-3 +- sqrt 5)/2 < 0, so both lambda are on the left."""
    _, found = at(CIRCULATORY)
    assert [one.verdict.word for one in found.equilibria] == ["asymptotically stable"]


HALF = """
mbsym: 1
name: Half an angle
parameters: {m: 1, l: 1, k: 1}
bodies:
  - {name: rod, attached to: 0, rotation: {axes: [3], angles: [theta]}, mass centre: [l, 0, 0], mass: m}
loads:
  - potential: k*cos(theta/2)
"""


def test_half_angles_have_two_turns() -> None:
    """sin(theta/2) = 0: theta = 0 and theta = 2 pi are different; the potential is least at the second."""
    _, found = at(HALF)
    assert {one.verdict.word: one.values[0].value for one in found.equilibria} == pytest.approx(
        {"unstable": 0, "stable": 2 * math.pi}
    )


SAMPLED = """
mbsym: 1
name: Five uncoupled coordinates
parameters: {m: 1, k: 1}
bodies:
  - {name: p, attached to: 0, connection point: [x, y, z], coordinates: [x, y, z], mass: m}
  - {name: q, attached to: 0, connection point: [u, 0, 0], coordinates: [u], mass: m}
  - {name: rod, attached to: 0, rotation: {axes: [3], angles: [theta]}, mass centre: [1, 0, 0], mass: m}
loads:
  - potential: exp(x) - x + exp(y) - y + k*(z - 3)**2 + exp(u) - u + sin(theta) + exp(sin(theta))
"""


def test_a_search_from_many_points_finds_what_is_there() -> None:
    """e^x = 1 and so on, z = 3; (1 + exp(sin)) cos = 0: theta = +-pi/2, once each."""
    _, found = at(SAMPLED)
    assert not found.complete
    assert {one.verdict.word: [x.value for x in one.values] for one in found.equilibria} == {
        "stable": pytest.approx([0, 0, 3, 0, -math.pi / 2], abs=1e-9),
        "unstable": pytest.approx([0, 0, 3, 0, math.pi / 2], abs=1e-9),
    }
    assert len(found.equilibria) == 2


TWISTED = """
mbsym: 1
name: Rod in a universal joint
parameters: {m: 1, l: 1, g: 1, F: 1}
bodies:
  - {name: rod, attached to: 0, rotation: {axes: [1, 2], angles: [x, y]}, mass centre: [0, 0, -l], mass: m}
loads:
  - uniform gravity: {vector: [0, 0, -g]}
"""


@pytest.mark.parametrize(
    ("load", "free"), [("", True), ("  - torque: {body: rod, components: [0, 0, F], axes: rod}\n", False)]
)
def test_a_torque_about_a_rod_is_work_of_its_twist(load: str, free: bool) -> None:
    assert bool(joints(mbsym.loads(TWISTED + load).system, ())) is free


FOLLOWER = "  - force: {body: rod, point: [0, 0, -l], components: [F, 0, 0], axes: rod}\n"


def test_a_force_that_turns_with_a_twist_needs_it() -> None:
    """In the angles x, y: f_x = -m g l sin x cos y, f_y = -m g l cos x sin y - F l with F = m g/2.

    sin x = 0 gives sin y = -+1/2 (x = 0, pi; two y each); cos y = 0 gives cos x = -+1/2, where x turns about the rod.
    """
    system, found = at(TWISTED.replace("F: 1}", "F: 1/2}") + FOLLOWER)
    assert not joints(system.system, ())

    def degrees(listed: Sequence[RelativeEquilibrium]) -> set[tuple[int, ...]]:
        return {tuple(round(math.degrees(item.value)) for item in one.values) for one in listed}

    assert degrees(found.equilibria) == {(0, -30), (0, -150), (180, 30), (180, 150)}
    assert degrees(found.singular) == {(60, -90), (-60, -90), (120, 90), (-120, 90)}


IRRATIONAL = """
mbsym: 1
name: equilibria at pi/6
parameters: {c: positive, x0: real, k: positive}
relations: {c: k*sin(x0)}
bodies:
  - {name: p, mass: 1, connection point: [x, 0, 0], coordinates: [x]}
loads:
  - generalized force: {x: "c - k*sin(x)"}
values: {x0: pi/6, k: 2}
"""


def test_irrational_values_are_taken_exactly(tmp_path: Path) -> None:
    """k sin x = k sin x0: x0 and pi - x0, stable where cos x > 0."""
    file = filed(tmp_path / "x0.yaml", IRRATIONAL)
    for options, places in (((), ("pi/6", "5*pi/6")), (("--set", "x0=pi/4"), ("pi/4", "3*pi/4"))):
        found = json.loads(CliRunner().invoke(command_of(STUDY), [str(file), "--json", *options]).stdout)
        assert found["complete"]
        told = [(one["coordinates"][0]["value"], one["stability"]["verdict"]) for one in found["equilibria"]]
        assert told == [(places[0], "stable"), (places[1], "unstable")]
    assert found["values"] == {"x0": "pi/4", "k": "2"}
    refused = CliRunner().invoke(command_of(STUDY), [str(file), "--vary", "k=1:2"])
    assert refused.exit_code == 2
    assert "no rational number for x0" in refused.stderr


@pytest.mark.parametrize("place", ["X", "X + Y"])
def test_a_semidefinite_damper_is_judged_alike_in_other_coordinates(place: str) -> None:
    """V = y^2/2 - x/2 - cos x, friction on x alone, at x = pi/6 (a strict minimum: stable), with x = X or x = X + Y."""
    found = mbsym.loads(
        "mbsym: 1\nname: torque\nbodies:\n"
        f"  - {{name: p, attached to: 0, connection point: ['{place}', Y, 0], mass: 1, coordinates: [X, Y]}}\n"
        f"loads:\n  - potential: Y**2/2 - ({place})/2 - cos({place})\n"
        f"  - rayleigh: ({place.replace('X', 'X_dot').replace('Y', 'Y_dot')})**2/2\nmotion: {{}}\n"
    ).equilibria
    assert [str(rest.verdict.word) for rest in found.equilibria] == ["stable", "unstable"]


def test_a_rest_under_a_constraint_without_exact_values_is_listed() -> None:
    """V = e^x - x + y^2 at x = y = 0, a minimum; u = x + y^2 beside it: nothing breaks down."""
    found = mbsym.loads(
        "mbsym: 1\nname: minimum\nbodies:\n"
        "  - {name: p, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}\n"
        "  - {name: q, attached to: 0, connection point: [u, 0, 0], mass: 1, coordinates: [u]}\n"
        "loads:\n  - potential: exp(x) - x + y**2\nconstraints:\n  - relation: u = x + y**2\nmotion: {}\n"
    ).equilibria
    assert [str(rest.verdict.word) for rest in found.equilibria] == ["stable"]


@pytest.mark.parametrize("power", [1, 2])
def test_nothing_is_said_where_a_damper_is_infinite(power: int) -> None:
    """V = ((x - 1)^2 + y^2)^power with friction x'/(x - 1)^2: at the minimum there are no equations of motion."""
    found = mbsym.loads(
        "mbsym: 1\nname: pole\nbodies:\n"
        "  - {name: p, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}\n"
        f"loads:\n  - potential: ((x - 1)**2 + y**2)**{power}\n  - rayleigh: x_dot**2/(x - 1)**2/2 + y_dot**2/2\n"
        "motion: {}\n"
    ).equilibria
    assert [rest.verdict.word.open for rest in found.equilibria] == [True]


SWUNG = """mbsym: 1
name: a body that swings and is turned
parameters: {W: positive}
PRESCRIBED
bodies: [BODY]
loads: [{uniform gravity: {vector: [0, 0, -1]}}]
MOTION
values: {W: 2}
"""


@pytest.mark.parametrize(
    ("body", "prescribed", "thetas"),
    [
        # a bob: -theta and psi + pi are the same place
        ("mass: 1, rotation: {axes: [3, 1], angles: [psi, theta]}, mass centre: [0, 0, -1]", False, ["pi/3"]),
        # written as a place
        ("mass: 1, connection point: [sin(theta)*cos(psi), sin(theta)*sin(psi), -cos(theta)]", False, ["pi/3"]),
        # a box that hangs on a universal joint is turned about its own axis by half a turn; 2 cos(theta) (1 - 1/4) = 1
        (
            "mass: 1, rotation: {axes: [3, 1], angles: [psi, theta]}, mass centre: [0, 0, -1], "
            "inertia about: mass centre, inertia: [1/2, 1/3, 1/4]",
            False,
            [0.0, 0.0],
        ),
        # a bead on a hoop that is driven: at one time two places
        ("mass: 1, rotation: {axes: [3, 1], angles: [psi, theta]}, mass centre: [0, 0, -1]", True, ["pi/3", "-pi/3"]),
    ],
)
def test_one_place_is_counted_once(body: str, prescribed: bool, thetas: list[object]) -> None:
    """W^2 cos(theta) = 1, W^2 = 2, of a bob at the end of a rod of length 1."""
    moving = "motion: {theta: 0}" if prescribed else "motion: {psi: {value: 0, rate: sqrt(2)}, theta: 0}"
    names = "theta" if prescribed else "psi, theta"
    text = SWUNG.replace("BODY", f"{{name: p, {body}, coordinates: [{names}]}}").replace("MOTION", moving)
    text = text.replace("PRESCRIBED", "prescribed: {psi: {rate: sqrt(2)}}" if prescribed else "")
    found = relative_equilibria(mbsym.loads(text.replace("W: positive", "").replace("values: {W: 2}", "")).system, {})
    tilted = [x.text for one in found.equilibria for x in one.values if x.name == "theta" and x.text not in ("0", "pi")]
    assert len(tilted) == len(thetas)
    if isinstance(thetas[0], str):
        assert tilted == thetas
