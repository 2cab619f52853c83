"""Systems with published or closed-form answers (``references/``): what is derived equals them exactly.

The answers are read from the reference files as they stand ("2 g sin(alpha)/3"); only where a file gives a rule in
words is it transcribed.  Not here: the Cartesian pendulum of ``sympy_symbolic_small`` (a constraint with a multiplier),
rolling disc and hoop of ``mgk_exact`` (nonholonomic), and the branched and massless-body cases of ``rbdl_open_trees``,
for which that file has no numbers.
"""

# ruff: noqa: SIM300
# (M, G, K, ... are results with the names they have in mechanics, no constants.)

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np
import pytest
from conftest import OWN, SHIPPED, Exact, agrees, at_values, derived, parsed, precision, reference, total
from flint import fmpq, fmpq_mat
from plain_vectors import add, apply, cross

import mbsym
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.point import Rationals
from mbsym.analysis import Analysis
from mbsym.expressions.tree import ZERO
from mbsym.formulas.formula import Formula, Matrix
from mbsym.model.system import MotionEntry
from mbsym.problems.integrals import total_rate

FUNCTIONS = ("sin", "cos", "sqrt")


def prose(text: str) -> str:
    """A formula as people type it, with all its signs of multiplication: 2 g sin q1 q2'^2 -> 2*g*sin(q1)*q2_dot**2."""
    text = re.sub(r"\b(sin|cos)\^2 (\w+)", r"(\1(\2))^2", text)
    text = re.sub(r"\b(sin|cos) (\w+)", r"\1(\2)", text)
    text = text.replace("''", "_ddot").replace("'", "_dot")
    text = re.sub(r"\b(q\d)(d{1,2})\b", lambda found: f"{found[1]}_{'d' * (len(found[2]) - 1)}dot", text)
    result, left = "", ""
    for token in re.findall(r"[A-Za-z]\w*|\d+(?:\.\d+)?|\S", text):
        factor = re.fullmatch(r"\w+", token) or token == "("
        if factor and (left == ")" or (re.fullmatch(r"\w+", left) and left not in FUNCTIONS)):
            result += "*"
        result += "**" if token == "^" else token
        left = token
    return result


def left_side(equation: str) -> str:
    left, right = equation.split("=")
    assert right.strip() == "0"
    return prose(left)


def right_side(equation: str) -> str:
    return prose(equation.split("=")[1])


def put(formula: Formula, **values: Formula | int) -> Formula:
    """The formula with other values of names: parameters, coordinates outside sines, q_dot, q_ddot."""
    ring = formula.ring
    images = {}
    for name, value in values.items():
        kind = "parameter" if ring.has("parameter", name) else "coordinate"
        for suffix, other in (("_dot", "velocity"), ("_ddot", "acceleration")):
            if name.endswith(suffix):
                kind, name = other, name.removesuffix(suffix)
        images[ring.index(kind, name)] = value.polynomial if isinstance(value, Formula) else ring.number(value)
    return Formula(ring, ring.substitute(formula.polynomial, images))


def residuals(a: Analysis) -> list[Formula]:
    """M q'' - f."""
    return list(a.equations.equalities(a.system.coordinates))


def linear_equation(a: Analysis, name: str) -> Formula:
    """One row of M x'' + (D + G) x' + (K + N) x, in physical time and declared parameters."""
    linear, ring = a.linearisation, a.ring
    row, sum_ = linear.coordinates.index(name), ring.zero
    for column, other in enumerate(linear.coordinates):
        m, d, g, k, n = (matrix[row, column].polynomial for matrix in linear.matrices)
        sum_ = sum_ + m * ring.generator("acceleration", other) + (d + g) * ring.generator("velocity", other)
        sum_ = sum_ + (k + n) * ring.generator("coordinate", other)
    return Formula(ring, ring.reduce(sum_))


def matrix(exact: Exact, rows: Sequence[Sequence[str]], factor: str = "1", **meanings: str) -> Matrix:
    return Matrix(tuple(tuple(exact(f"({prose(x)})*{factor}", **meanings) for x in row) for row in rows))


def part(a: Analysis, *names: str) -> Any:
    return next(item for item in a.stability.subsystems if item.coordinates == names)


def word(a: Analysis, *names: str) -> str:
    """The verdict at the numerical values, for a subsystem or for the whole."""
    verdict = part(a, *names).theory.at_point.verdict if names else a.stability.numerical
    return str(verdict.word)


def proportional(exact: Exact, ours: Formula, theirs: Formula) -> bool:
    """Equal up to a positive number."""
    return (exact.ratio(ours, theirs) or 0) > 0


def test_reading_of_prose() -> None:
    assert prose("-l0 (m1+m2) u1^2 sin q1 + F") == "-l0*(m1+m2)*u1**2*sin(q1)+F"
    assert prose("(1+3kR+kR kY)s^2") == "(1+3*kR+kR*kY)*s**2"
    assert prose("g(mA LA) sin^2 qB cos qB qA'") == "g*(mA*LA)*(sin(qB))**2*cos(qB)*qA_dot"
    assert prose("l sin q1 cos q2 q2d^2 + 2 q1dd") == "l*sin(q1)*cos(q2)*q2_dot**2+2*q1_ddot"


# --- sympy_symbolic_small ---

SMALL = {
    item["name"].split(",")[0].split(" (")[0]: item for item in reference("sympy_symbolic_small")["reference"]["items"]
}


def test_disc_on_incline() -> None:
    a = mbsym.load(OWN / "disc-on-incline.yaml")
    acceleration = Exact(a)(right_side(SMALL["disc on incline with y=R theta"]["answer"]))
    (equation,) = residuals(a)
    assert put(equation, y_ddot=acceleration).is_zero
    assert not put(equation, y_ddot=0).is_zero


def test_double_pendulum_in_absolute_angles() -> None:
    a = mbsym.load(OWN / "double-pendulum-absolute.yaml")
    exact = Exact(a)
    for ours, text in zip(residuals(a), SMALL["double pendulum"]["answer"], strict=True):
        assert ours == exact(prose(text))


def test_two_link_pendulum_on_a_cart() -> None:
    a = derived(SHIPPED / "cart-pendulum.yaml")
    exact, item = Exact(a), SMALL["two-link pendulum on cart"]
    for i, row in enumerate(item["mass_matrix"]):
        for j, text in enumerate(row):
            expected = item["mass_matrix"][j][i] if text == "." else text
            assert a.equations.mass_matrix[i, j] == exact(prose(expected))
    for ours, text in zip(a.equations.forcing, item["forcing"], strict=True):
        assert ours == exact(prose(text), u1="q1_dot", u2="q2_dot")


def test_chain_of_masses_springs_and_dampers() -> None:
    a = mbsym.load(OWN / "mass-spring-damper-chain.yaml")
    exact, item = Exact(a), SMALL["chain of 3 mass-spring-dampers"]
    assert a.equations.mass_matrix == matrix(exact, item["mass_matrix"])
    (rule,) = item["forcing"]
    for i, ours in enumerate(a.equations.forcing):
        text = rule.replace("_i", str(i)).replace(f"v{i}", f"x{i}'")
        assert ours == exact(prose(text))


# --- spong_two_link ---

SPONG = reference("spong_two_link")["reference"]


@pytest.fixture(scope="module")
def spong() -> Analysis:
    return mbsym.load(OWN / "spong-two-link.yaml")


def test_two_link_arm_mass_matrix(spong: Analysis) -> None:
    expected = [[SPONG["d11"], SPONG["d12"]], [SPONG["d12"], SPONG["d22"]]]
    assert spong.equations.mass_matrix == matrix(Exact(spong), expected)


def test_two_link_arm_christoffel_terms(spong: Analysis) -> None:
    exact, h = Exact(spong), f"({prose(SPONG['h'])})"
    assert len(SPONG["velocity_terms"]) == 3
    for velocities, text in SPONG["velocity_terms"].items():
        first, second = map(int, re.findall(r"\d", velocities))
        for ours, expected in zip(spong.equations.forcing, text.strip("()").split(","), strict=True):
            terms = put(ours, q1_dot=first, q2_dot=second, g=0)
            assert terms == exact(prose(f"-({expected})"), h=h)
    quadratic = (f"-{h}*(2*q1_dot*q2_dot + q2_dot**2)", f"{h}*q1_dot**2")
    assert tuple(put(x, g=0) for x in spong.equations.forcing) == tuple(map(exact, quadratic))


def test_two_link_arm_gravity(spong: Analysis) -> None:
    half_tangent = {"0": fmpq(0), "pi/2": fmpq(1), "-pi/2": fmpq(-1)}
    for place, expected in SPONG["gravity_over_g"].items():
        angles = dict(zip(("q1", "q2"), (half_tangent[x] for x in place.strip("()").split(",")), strict=True))
        values = dict.fromkeys(spong.ring.names(), fmpq(0)) | {"g": fmpq(1)}
        carry = Carrier(spong.ring, Rationals(angles, {"q1": 1, "q2": 1}), values)
        assert [-carry(x.polynomial) for x in spong.equations.forcing] == [
            fmpq(int(Fraction(x).numerator), int(Fraction(x).denominator)) for x in expected
        ]


# --- rbdl_open_trees ---

RBDL = reference("rbdl_open_trees")["reference"]
Joint = tuple[int, str, str, str]  # axis, connection point, mass centre, inertia
UNIT = "[1, 1, 1]"
FIRST: Joint = (3, "[0, 0, 0]", "[1, 0, 0]", UNIT)
NEXT: Joint = (3, "[1, 0, 0]", "[1, 0, 0]", UNIT)
TREES: dict[str, list[Joint]] = {
    "single": [FIRST],
    "single_b": [(3, "[0, 0, 0]", "[1.5, 1, 1]", "[1, 2, 3]")],
    "double": [FIRST, NEXT],
    "triple": [FIRST, NEXT, NEXT],
    "double3D": [FIRST, (2, "[1, 0, 0]", "[0, 1, 0]", UNIT)],
}


def tree(joints: Sequence[Joint]) -> Analysis:
    lines = ["mbsym: 1", "name: chain", "loads:", "  - uniform gravity: {vector: [0, -9.81, 0]}", "bodies:"]
    for i, (axis, at, centre, inertia) in enumerate(joints, start=1):
        lines.append(f"  - {{name: b{i}, attached to: {f'b{i - 1}' if i > 1 else 0}, mass: 1,")
        lines.append(f"    rotation: {{axes: [{axis}], angles: [q{i}]}}, connection point: {at},")
        lines.append(f"    mass centre: {centre}, inertia about: mass centre, inertia: {inertia}}}")
    return mbsym.loads("\n".join(lines))


def accelerations(m: Sequence[Sequence[fmpq]], f: Sequence[fmpq]) -> list[Fraction]:
    found = fmpq_mat([list(row) for row in m]).solve(fmpq_mat([[x] for x in f]))
    return [Fraction(int(found[i, 0].p), int(found[i, 0].q)) for i in range(len(f))]


@pytest.mark.parametrize("name", TREES)
def test_accelerations_of_open_trees_at_rest(name: str) -> None:
    """Exactly from the closed equations, and the same from the straight-line program."""
    a = tree(TREES[name])
    algebra = Rationals(dict.fromkeys(a.system.coordinates, fmpq(0)), dict.fromkeys(a.system.coordinates, 1))
    zeros = dict.fromkeys([*a.ring.names(), "pi"], fmpq(0))
    carry = Carrier(a.ring, algebra, zeros)
    closed = [[carry(x) for x in row] for row in a.equations.mass_matrix.polynomials]
    ours = accelerations(closed, [carry(x.polynomial) for x in a.equations.forcing])
    for value, text in zip(ours, RBDL[name], strict=True):
        digits = len(text.partition(".")[2])
        assert abs(value - Fraction(text)) <= (Fraction(1, 10**14) if digits > 12 else 0)
    n, code = len(ours), a.programs
    outputs = [x for row in code.mass_matrix for x in row] + list(code.forcing)
    values = code.program.evaluate(outputs, zeros, algebra)
    assert accelerations([values[i * n : i * n + n] for i in range(n)], values[n * n :]) == ours


@pytest.fixture(scope="module")
def floating() -> Analysis:
    return mbsym.load(OWN / "floating-body.yaml")


def moving_point(a: Analysis, point: Sequence[str]) -> tuple[list[Formula], list[Formula], list[Formula]]:
    """Position, velocity and acceleration in inertial axes, from the results of problem 1."""
    ring, exact, body = a.ring, Exact(a), a.kinematics.body("body")
    fixed = tuple(exact(x).polynomial for x in point)
    back = tuple(zip(*body.rotation.polynomials, strict=True))
    spin = tuple(x.polynomial for x in body.angular_velocity)
    origin = tuple(x.polynomial for x in body.velocity_origin)
    velocity = apply(ring, back, add(origin, cross(ring, spin, fixed)))
    place = tuple(exact(name).polynomial for name in ("q1", "q2", "q3"))
    position = add(place, apply(ring, back, fixed))
    acceleration = [total_rate(a.scene, x) for x in velocity]
    return tuple([Formula(ring, ring.reduce(x)) for x in v] for v in (position, velocity, acceleration))


STATE = ("0.1", "1.1", "1.2", "1.3", "1.5", "1.7")


def all_agree(a: Analysis, formulas: Sequence[Formula], texts: Sequence[str], accelerating: bool = False) -> bool:
    values = {"t": fmpq(0)}
    for i, text in enumerate(STATE, start=1):
        x = Fraction(text)
        given = fmpq(x.numerator, x.denominator)
        values |= {f"q{i}": given, f"q{i}_dot": given, f"q{i}_ddot": given if accelerating else fmpq(0)}
    with precision(200):
        return all(
            agrees(a.ring.evaluate(x.polynomial, values), text, 13) for x, text in zip(formulas, texts, strict=True)
        )


def test_kinematics_of_points_of_a_floating_body(floating: Analysis) -> None:
    _, velocity, _ = moving_point(floating, ("1", "0", "0"))
    assert all_agree(floating, velocity, RBDL["point_velocity_at_1_0_0"])
    position, velocity, acceleration = moving_point(floating, ("-1.9", "-1.8", "0"))
    expected = RBDL["point_m1p9_m1p8_0"]
    assert all_agree(floating, position, expected["position"])
    assert all_agree(floating, velocity, expected["velocity"])
    assert all_agree(floating, acceleration, expected["acc_qdd0"])
    assert all_agree(floating, acceleration, expected["acc_qdd_eq_q"], accelerating=True)


def test_velocity_of_a_point_is_the_rate_of_its_position(floating: Analysis) -> None:
    position, velocity, _ = moving_point(floating, ("-1.9", "-1.8", "0"))
    for x, v in zip(position, velocity, strict=True):
        assert Formula(floating.ring, total_rate(floating.scene, x.polynomial)) == v


# --- kane_babyboot ---


def test_babyboot() -> None:
    a = mbsym.load(OWN / "babyboot.yaml")
    exact = Exact(a)
    equations = reference("kane_babyboot")["reference"]["equations"]
    known = {text.split("''")[0] + "_ddot": exact(right_side(text)) for text in equations}
    assert set(known) == {"qA_ddot", "qB_ddot"}
    for equation in residuals(a):
        assert put(equation, **known) == 0
        assert put(equation, qA_ddot=0, qB_ddot=0) != 0


# --- gravity_gradient ---

ORBIT = reference("gravity_gradient")["reference"]


@pytest.fixture(scope="module")
def nadir() -> Analysis:
    return mbsym.load(OWN / "gravity-gradient-nadir.yaml")


def of_row(equation: str) -> str:
    """The coordinate whose second derivative an equation has."""
    return re.search(r"(\w+)''", equation)[1]


def test_linear_equations_of_a_satellite(nadir: Analysis) -> None:
    exact = Exact(nadir)
    assert {of_row(text) for text in ORBIT["linear"]} == set(nadir.system.coordinates)
    for text in ORBIT["linear"]:
        assert put(linear_equation(nadir, of_row(text)), n=1) == exact(left_side(text))


def test_linear_equations_of_the_shipped_satellite() -> None:
    """Its second axis points outward, so B is the moment about the nadir, C that about the normal, and yaw is -psi."""
    a = derived(SHIPPED / "gravity-gradient.yaml")
    exact = Exact(a)
    meanings = {"Ix": "A", "Iy": "C", "Iz": "B"} | {f"psi{s}": f"-psi{s}" for s in ("", "_dot", "_ddot")}
    for text in ORBIT["linear"]:
        name = of_row(text)
        sign = "-" if name == "psi" else ""
        assert put(linear_equation(a, name), omega0=1) == exact(f"{sign}({left_side(text)})", **meanings)


def test_satellite_in_the_parameters_of_smelt(nadir: Analysis) -> None:
    exact = Exact(nadir)
    ours = [exact.same(x) for x in part(nadir, "psi", "phi").characteristic]
    assert len(ours) == 5
    assert ours[1].is_zero
    assert ours[3].is_zero
    for s in range(3):  # an even polynomial of degree 4 is known from three values
        value = total(Formula(nadir.ring, x.polynomial * s**power) for power, x in enumerate(ours))
        assert value == Formula(
            nadir.ring, exact(left_side(ORBIT["characteristic"]), s=str(s)).polynomial * ours[4].polynomial
        )
    assert ours[4] == 1


def test_characteristic_polynomial_of_the_shipped_satellite() -> None:
    a = derived(SHIPPED / "gravity-gradient.yaml")
    exact = Exact(a)
    smelt = {"Ix": "A", "Iy": "C", "Iz": "B", "kR": "(Iy-Iz)/Ix", "kY": "(Iy-Ix)/Iz"}
    assert ORBIT["smelt"] == f"kR={smelt['kR']}, kY={smelt['kY']}"
    ours = [exact.same(x) for x in part(a, "psi", "phi").characteristic]
    for s in range(3):
        value = total(Formula(a.ring, x.polynomial * s**power) for power, x in enumerate(ours))
        expected = exact(f"A*B*({left_side(ORBIT['characteristic'])})", **smelt, s=str(s))
        assert value == expected


def test_conditions_for_a_satellite(nadir: Analysis) -> None:
    exact = Exact(nadir)
    pitch, first, second = ORBIT["conditions"]
    assert pitch.startswith("pitch: kR>kY")
    (condition,) = part(nadir, "theta").conditions
    assert proportional(exact, condition[1], exact("kR - kY"))
    ours = {label: formula for label, formula, relation in part(nadir, "psi", "phi").conditions if relation == ">"}
    assert len(ours) == 3
    assert proportional(exact, ours["v0"], exact(prose(first.removesuffix(">0"))))
    left, right = (prose(side) for side in second.split(">"))
    assert proportional(exact, ours["v2"], exact(left))
    assert proportional(exact, ours["discriminant"], exact(f"({left})**2 - ({right})**2"))


@pytest.mark.parametrize("sample", ORBIT["sample"], ids=range(len(ORBIT["sample"])))
@pytest.mark.parametrize("shipped", [False, True], ids=["nadir", "shipped"])
def test_verdicts_on_satellites(sample: Mapping[str, Any], shipped: bool) -> None:
    x, y, z = (Fraction(str(value)) for value in sample["I"])
    if shipped:
        a = at_values(SHIPPED / "gravity-gradient.yaml", A=x, B=z, C=y)
    else:
        a = at_values(OWN / "gravity-gradient-nadir.yaml", Ix=x, Iy=y, Iz=z)
    if not sample["stable"]:
        assert word(a) == "unstable"
    elif y > x > z:  # Lagrange's region: the potential has a minimum
        assert word(a) == "stable"
    else:  # DeBra and Delp's: gyroscopic forces stabilise, which damping destroys
        assert word(a) == "gyroscopically stabilised only"
        assert word(a, "psi", "phi") == "gyroscopically stabilised only"


def test_pitch_frequency_and_dumbbell(nadir: Analysis) -> None:
    exact, linear = Exact(nadir), nadir.linearisation
    pitch, roll, yaw = (linear.coordinates.index(name) for name in ("theta", "phi", "psi"))
    frequency = prose(ORBIT["pitch_frequency"])
    squared = Formula(nadir.ring, linear.M[pitch, pitch].polynomial * exact(f"({frequency})**2").polynomial)
    assert linear.K[pitch, pitch] == squared

    def of_dumbbell(formula: Formula) -> Formula:
        return put(formula, Iz=0, Iy=exact("Ix"))

    for i, text in ((pitch, ORBIT["dumbbell"]["pitch"]), (roll, ORBIT["dumbbell"]["roll"])):
        m, k = of_dumbbell(linear.M[i, i]), of_dumbbell(linear.K[i, i])
        assert k == Formula(nadir.ring, m.polynomial * exact(f"({prose(text)})**2").polynomial)
    assert of_dumbbell(linear.G[roll, yaw]).is_zero
    assert of_dumbbell(linear.M[yaw, yaw]).is_zero


def test_equilibria_of_a_triaxial_satellite(nadir: Analysis) -> None:
    """Of the 24, the 16 that 3-2-1 angles reach without singularity; the four minima are among them."""
    assert ORBIT["equilibria"] == {"triaxial": 24, "linearly stable classes": "4 orientations are minima of U"}
    minima = 0
    for psi, phi in product(range(4), repeat=2):
        motion = (
            MotionEntry("psi", parsed(f"{psi}*pi/2"), ZERO),
            MotionEntry("theta", ZERO, ZERO),
            MotionEntry("phi", parsed(f"{phi}*pi/2"), ZERO),
        )
        a = Analysis(replace(nadir.system, motion=motion))
        assert a.equilibrium.satisfied
        minima += word(a) == "stable"
    assert minima == 4


# --- ziegler ---

ZIEGLER = reference("ziegler")["reference"]


def test_ziegler_matrices() -> None:
    a = derived(SHIPPED / "ziegler-damped.yaml")
    exact, linear = Exact(a), a.linearisation
    assert linear.M == matrix(exact, [[str(x) for x in row] for row in ZIEGLER["M"]], "m*l**2")
    assert linear.D == matrix(exact, ZIEGLER["D"])
    assert linear.G.is_zero
    stiffness = [
        [Formula(a.ring, linear.K[i, j].polynomial + linear.N[i, j].polynomial) for j in range(2)] for i in range(2)
    ]
    assert Matrix(tuple(map(tuple, stiffness))) == matrix(exact, ZIEGLER["K"], "k", p="P*l/k")
    assert not linear.N.is_zero


def test_ziegler_undamped_flutter_bounds() -> None:
    a = derived(SHIPPED / "ziegler.yaml")
    exact, found = Exact(a), part(a, "theta1", "theta2")
    text = ZIEGLER["undamped"].split(":")[0]
    ours = [exact.same(x) for x in found.characteristic]
    for s in range(3):  # in units of sqrt(k/m)/l
        value = total(
            Formula(a.ring, x.polynomial * exact(f"(k/(m*l**2))**{power // 2}").polynomial * s**power)
            for power, x in enumerate(ours)
            if power % 2 == 0
        )
        assert value == exact(f"k**2*({prose(text)})", p="P*l/k", s=str(s))
    (discriminant,) = (exact.same(x) for label, x, _ in found.conditions if label == "discriminant")
    for bound in ("7/2 - sqrt(2)", "7/2 + sqrt(2)"):
        assert bound.replace(" ", "").replace("(2)", "2") in ZIEGLER["undamped"]
        assert put(discriminant, P=exact(f"({bound})*k/l")).is_zero
    assert not put(discriminant, P=0).is_zero


@pytest.mark.parametrize(
    ("p", "unstable"),
    [
        ("1.9", False),
        ("2.0857864376", False),
        ("2.08578643762690", False),
        ("2.08578643762691", True),
        ("2.0857864377", True),
        ("3.5", True),
        ("4.9142135623", True),
        ("6", True),
    ],
)
def test_ziegler_undamped_verdicts(p: str, unstable: bool) -> None:
    a = at_values(SHIPPED / "ziegler.yaml", m=1, l=1, k=1, P=p)
    assert (word(a) == "unstable") is unstable
    assert word(a) not in ("stable", "asymptotically stable")  # a circulatory system has no energy integral


def test_ziegler_critical_load_with_damping() -> None:
    """The open condition that is linear in P vanishes exactly at the published p_cr, and holds below it."""
    a = derived(SHIPPED / "ziegler-damped.yaml")
    exact, found = Exact(a), part(a, "theta1", "theta2")
    critical = right_side(ZIEGLER["damped"])
    units = {"b1": "(c1/(sqrt(k*m)*l))", "b2": "(c2/(sqrt(k*m)*l))"}
    text = critical
    for name, value in units.items():
        text = re.sub(rf"\b{name}\b", value, text)
    load = exact(f"({text})*k/l", c1="b1", c2="b2")
    (minor,) = (exact.same(x) for label, x, _ in found.conditions if label.startswith("Hurwitz"))
    assert put(minor, P=load) == 0
    assert minor.polynomial.degrees()[a.ring.index("parameter", "P")] == 1
    slope = Formula(a.ring, -minor.polynomial.derivative(a.ring.index("parameter", "P")))
    assert a.signs.sign(slope.polynomial) == "positive"
    equal = exact(f"({right_side(ZIEGLER['equal_damping'].split('->')[0])})", b="b1")
    assert put(exact(critical), b2=exact("b1")) == equal


@pytest.mark.parametrize("b", ["0.00000001", "0.01", "0.5", "2"])
def test_ziegler_damped_verdicts(b: str) -> None:
    """b = 1e-8 must give 41/28, not the undamped 2.086; on the border the first approximation calls nothing stable.

    What is said there is said by the amplitude on the centre manifold, r' = a r^3 with a < 0: a soft border.
    """
    border = Fraction(41, 28) + Fraction(b) ** 2 / 2
    for p, expected in (
        (border - Fraction(1, 10**20), "asymptotically stable"),
        (border + Fraction(1, 10**20), "unstable"),
    ):
        assert word(at_values(SHIPPED / "ziegler-damped.yaml", m=1, l=1, k=1, b1=b, b2=b, P=p)) == expected
    on_border = at_values(SHIPPED / "ziegler-damped.yaml", m=1, l=1, k=1, b1=b, b2=b, P=border).stability
    first = on_border.before_higher_order or on_border.numerical
    assert first is not None
    assert first.word in ("undecided", "stable in first approximation only")
    assert on_border.numerical is not None
    assert on_border.numerical.theorem in ("", "Lyapunov, Pliss: centre manifold")


def test_ziegler_paradox() -> None:
    for p in ("1.4642858", "2", "2.08"):
        a = at_values(SHIPPED / "ziegler-damped.yaml", m=1, l=1, k=1, b1="1e-8", b2="1e-8", P=p)
        assert word(a) == "unstable"
    a = at_values(SHIPPED / "ziegler-damped.yaml", m=1, l=1, k=1, b1="1e-8", b2="1e-8", P="1.4642857")
    assert word(a) == "asymptotically stable"


# --- spring_pendulum ---

SPRING = reference("spring_pendulum")


def test_spring_pendulum_energies() -> None:
    a = derived(SHIPPED / "spring-pendulum.yaml")
    exact = Exact(a)
    assert a.energy.kinetic_energy == exact(prose(SPRING["parameters"]["T"]), th_dot="theta_dot")
    potential = exact(f"-({prose(SPRING['parameters']['V'])})", th="theta")
    difference = a.energy.force_function.polynomial - potential.polynomial
    assert not any(a.ring.depends_on(difference, name) for name in ("theta", "r"))


@pytest.mark.parametrize(
    "path", [SHIPPED / "spring-pendulum.yaml", OWN / "spring-pendulum-free.yaml"], ids=["given", "free"]
)
def test_spring_pendulum_frequencies(path: Any) -> None:
    """With r0 free the condition of existence is found and used in the matrices."""
    a = mbsym.load(path)
    exact, linear = Exact(a), a.linearisation
    r0 = right_side(SPRING["reference"]["equilibrium"])
    of_spring, of_swing = (prose(text) for text in SPRING["reference"]["frequencies"])
    for name, frequency in (("r", of_spring), ("theta", of_swing)):
        i = linear.coordinates.index(name)
        m, k = linear.M[i, i], linear.K[i, i]
        assert k == Formula(a.ring, m.polynomial * exact(f"({frequency})**2", r0=r0).polynomial)
        assert word(a, name) == "stable" if path.parent == SHIPPED else part(a, name).theory.verdict.word == "stable"
    assert linear.M[0, 1].is_zero
    assert linear.K[0, 1].is_zero


def test_spring_pendulum_condition_of_existence() -> None:
    assert derived(SHIPPED / "spring-pendulum.yaml").equilibrium.satisfied
    a = mbsym.load(OWN / "spring-pendulum-free.yaml")
    exact, found = Exact(a), a.equilibrium
    r0 = exact(right_side(SPRING["reference"]["equilibrium"]))
    assert not found.satisfied
    (condition,) = found.conditions
    assert put(condition, r0=r0) == 0
    assert condition.polynomial.degrees()[a.ring.index("parameter", "r0")] == 1
    ((name, value),) = found.solved
    assert name == "r0"
    assert value == r0
    free = a.ring.index("parameter", "r0")
    assert all(x.polynomial.degrees()[free] <= 0 for m in a.linearisation.matrices for row in m for x in row)


def test_spring_pendulum_resonance() -> None:
    """Two to one iff k = 4 m g/r0, i.e. k l0 = 3 m g."""
    a = derived(SHIPPED / "spring-pendulum.yaml")
    exact, linear = Exact(a), a.linearisation
    i, j = linear.coordinates.index("r"), linear.coordinates.index("theta")
    detuning = Formula(
        a.ring,
        linear.K[i, i].polynomial * linear.M[j, j].polynomial
        - 4 * linear.K[j, j].polynomial * linear.M[i, i].polynomial,
    )
    assert put(detuning, l0=exact("3*m*g/k")) == 0
    assert detuning == exact("m*(l0 + m*g/k)*(k*l0 - 3*m*g)")


# --- mgk_exact ---

MGK = reference("mgk_exact")["reference"]


def test_sleeping_top_condition() -> None:
    a = derived(SHIPPED / "heavy-top.yaml")
    exact = Exact(a)
    left, right = (prose(side) for side in MGK["sleeping_top"].split(">"))
    printed = exact(f"C**2*(({left}) - ({right}))", omega3="Omega")
    ours = {label: exact.same(x) for label, x, _ in part(a, "alpha", "beta").conditions}
    assert proportional(exact, ours.pop("discriminant"), printed)
    assert not ours  # v2 is greater by a positive term: it goes without saying


GYROSCOPIC = {"gyroscopically stabilised only"}


@pytest.mark.parametrize(
    ("spin", "expected"),
    [
        ("0.999999999", {"unstable"}),
        ("1", {"undecided", "unstable"}),
        ("1.000000001", GYROSCOPIC),
    ],
)
def test_sleeping_top_on_both_sides_of_the_threshold(spin: str, expected: set[str]) -> None:
    """A = m = g = l = 1, C = 2: the threshold is Omega = 1; there the double roots are not semisimple.

    Above it the first approximation is stable by gyroscopic forces, and the top itself by its three integrals.
    """
    a = at_values(SHIPPED / "heavy-top.yaml", A=1, C=2, m=1, g=1, l=1, Omega=spin)
    assert word(a, "alpha", "beta") in expected
    assert word(a).startswith("stable but for a drift") == (expected == GYROSCOPIC)
    assert not word(a).startswith("asymptotically stable")
    if expected == {"unstable"}:
        assert word(a) == "unstable"


def test_sleeping_top_as_a_whole() -> None:
    """The spin is cyclic and uncoupled in the first approximation; it must not hide the verdict on the axis."""
    a = at_values(SHIPPED / "heavy-top.yaml", A=1, C=2, m=1, g=1, l=1, Omega="1.1")
    assert word(a, "alpha", "beta") == "gyroscopically stabilised only"
    assert word(a) == "stable but for a drift of cyclic coordinates"
    assert a.stability.numerical is not None
    assert a.stability.numerical.theorem == "Chetaev's combination of integrals"


@pytest.mark.parametrize("moments", [(1, 2, "2.5"), ("2.5", 2, 1)])
def test_rotation_about_the_intermediate_axis(moments: tuple[Any, Any, Any]) -> None:
    a = at_values(OWN / "rotation-about-principal-axis.yaml", **dict(zip(("I1", "I2", "I3"), moments, strict=True)))
    exact = Exact(a)
    rate = re.search(r"growth rate (.*)", MGK["intermediate_axis"])[1]
    squared = exact(f"({prose(rate)})**2", omega="Omega").polynomial
    ours = [exact.same(x).polynomial for x in part(a, "u", "v").characteristic]
    assert all(x.is_zero() for x in ours[1::2])
    assert Formula(a.ring, sum((x * squared**n for n, x in enumerate(ours[::2])), a.ring.zero)) == 0
    assert word(a, "u", "v") == "unstable"
    assert word(a) == "unstable"


@pytest.mark.parametrize("moments", [(1, "2.5", 2), (2, 1, "2.5")])
def test_rotation_about_the_extreme_axes_is_not_called_unstable(moments: tuple[Any, Any, Any]) -> None:
    a = at_values(OWN / "rotation-about-principal-axis.yaml", **dict(zip(("I1", "I2", "I3"), moments, strict=True)))
    assert part(a, "u", "v").theory.at_point.roots.right == 0
    assert word(a) == "stable but for a drift of cyclic coordinates"


@pytest.mark.parametrize(
    ("g", "d", "expected"),
    [
        ("2.999999999", 0, {"unstable"}),
        ("3", 0, {"undecided", "unstable"}),
        ("3.000000001", 0, {"stable"}),
        ("10", "0.001", {"unstable"}),
    ],
)
def test_gyroscopic_stabilisation_and_its_loss(g: str, d: Any, expected: set[str]) -> None:
    """k1 = 1, k2 = 4: the threshold sqrt(k1) + sqrt(k2) is 3; complete damping makes it unstable."""
    a = at_values(OWN / "gyroscopic-pair.yaml", g=g, k1=1, k2=4, d=d)
    assert word(a) in expected
    if d:
        printed = float(re.search(r"max Re = (\S+)", MGK["kelvin_tait_chetaev"])[1])
        coefficients = [float(x) for x in part(a, "x", "y").theory.at_point.characteristic]
        assert max(np.roots(coefficients[::-1]).real) == pytest.approx(printed, rel=1e-6)


def test_conditions_are_never_constants() -> None:
    a = mbsym.load(OWN / "gyroscopic-pair.yaml")
    assert not any(formula.polynomial.is_constant() for _, formula, _ in part(a, "x", "y").conditions)


def test_rotating_shaft() -> None:
    a = mbsym.load(OWN / "rotating-shaft.yaml")
    exact = Exact(a)
    left, right = MGK["rotating_shaft"].split("stable iff")[1].split("<")
    (condition,) = part(a, "x", "y").conditions
    assert proportional(exact, condition[1], exact(f"di*(({prose(right)}) - ({prose(left)}))"))
    for speed, expected in (("7.99", "asymptotically stable"), ("8", "stable"), ("8.01", "unstable")):
        assert word(at_values(OWN / "rotating-shaft.yaml", w0=2, de="0.3", di="0.1", Omega=speed)) == expected
