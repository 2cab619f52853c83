"""The satellite with a gravitational stabilizer against Banshchikov & Vetrov and an independent derivation.

The formulas below are transcribed from the paper (its numbers in brackets) or come from ``references/``; they are read
into the exact ring of the system, and equal means that the difference is proved zero.  Where the paper errs, the test
shows what would follow from the misprint.
"""

# ruff: noqa: SIM300
# (M, G, K, A0, ... are results with the names they have in the paper, no constants.)

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from conftest import SHIPPED, Exact, agrees, at_values, ball, derived, parsed, precision, reference, total
from flint import fmpq
from mpmath import mp
from plain_vectors import add, apply, cross

import mbsym
from mbsym.algebra.characteristic import characteristic_polynomial
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.point import Rationals
from mbsym.analysis import Analysis
from mbsym.expressions.tree import ZERO
from mbsym.formulas.formula import Formula, Matrix
from mbsym.model.loads import ForceFunction
from mbsym.model.system import System
from mbsym.problems.knowledge import definition_in_parameters

POINTS = reference("satellite-points")
LINEAR = reference("satellite-linear")
ORDER = ("psi", "theta", "phi", "delta", "sigma")


def dotted(text: str) -> str:
    """The references write psi_d for the derivative of psi."""
    return re.sub(rf"\b({'|'.join(ORDER)})_d\b", r"\1_dot", text)


SYMBOLIC = {
    name: [[dotted(x) for x in row] for row in value]
    if isinstance(value, list) and isinstance(value[0], list)
    else [dotted(x) for x in value]
    if isinstance(value, list)
    else dotted(value)
    for name, value in LINEAR["symbolic_sympy"].items()
}

# Formula (3) and the notations after it, (4); then sections 4 and 5.
FIRST = {
    "a": "Jy",
    "b": "Jx + m*r*(l + r) + m*l**2/3 + m0*(l + r)**2",
    "c": "b + Jz - Jx",
    "d": "(m/3 + m0)*l**2",
    "f": "(m/2 + m0)*r*l + d",
}
SECOND = {"alpha": "(c - b)/a", "gamma": "(b - a)/c", "p1": "d/f", "p2": "f/c"}
PITCH, YAW_ROLL = ("theta", "delta"), ("psi", "phi", "sigma")
PRINTED = {
    PITCH: {
        "M": [["c", "f"], ["f", "d"]],
        "G": [["0", "0"], ["0", "0"]],
        "K": [["3*(b - a)", "3*f"], ["3*f", "3*f"]],
    },
    YAW_ROLL: {
        "M": [["a", "0", "0"], ["0", "b", "f"], ["0", "f", "d"]],
        "G": [["0", "c - b - a", "0"], ["a + b - c", "0", "0"], ["0", "0", "0"]],
        "K": [["c - b", "0", "0"], ["0", "4*(c - a)", "4*f"], ["0", "4*f", "3*f + d"]],
    },
}
LAMBDA1 = {4: "p1 - p2", 2: "3*(1 + gamma*p1 - 2*p2)", 0: "9*(gamma - p2)"}
V = {
    "v6": "(1 + gamma*alpha)*p1 - (alpha + 1)*p2",
    "v4": "3*(1 + alpha*gamma) + (alpha + 1)*(p1*(alpha + 3*gamma + 2) - (alpha + 8)*p2)",
    "v2": "(1 + 3*gamma + alpha*(alpha + 2*gamma + 3))*(3 + p1) + 4*alpha*p1*(gamma + alpha)"
    " - 8*p2*(alpha + 1)*(alpha + 2)",
    "v0": "4*alpha*((alpha + gamma)*(3 + p1) - 4*(alpha + 1)*p2)",
}
CONDITIONS = {
    PITCH: [
        "p1 - p2",
        "1 + gamma*p1 - 2*p2",
        "gamma - p2",
        "p1**2*gamma**2 + (4*p2*(1 - p1) - 2*p1)*gamma + (1 - 4*p2*(1 - p1))",
    ],
    YAW_ROLL: [
        *V.values(),
        "v4**2*v2**2 - 4*v2**3*v6 - 4*v4**3*v0 + 18*v6*v4*v2*v0 - 27*v0**2*v6**2",
    ],
}


@pytest.fixture(scope="module")
def a() -> Analysis:
    return derived(SHIPPED / "satellite.yaml")


@pytest.fixture(scope="module")
def exact(a: Analysis) -> Exact:
    return Exact(a)


def as_printed(exact: Exact, rows: list[list[str]], **meanings: str) -> Matrix:
    return Matrix(tuple(tuple(exact(x, **meanings) for x in row) for row in rows))


def whole(name: str, factor: str) -> list[list[str]]:
    """A 5 x 5 matrix in physical time from the two blocks of formula (3)."""
    rows = [["0"] * 5 for _ in ORDER]
    for names, matrices in PRINTED.items():
        for i, row in zip(names, matrices[name], strict=True):
            for j, x in zip(names, row, strict=True):
                rows[ORDER.index(i)][ORDER.index(j)] = f"({x})*{factor}"
    return rows


# --- the description ---


def test_editor_text_and_yaml_are_one_system() -> None:
    assert mbsym.load(SHIPPED / "satellite.txt").system == mbsym.load(SHIPPED / "satellite.yaml").system


def test_coordinates_are_those_of_the_paper(a: Analysis) -> None:
    assert a.system.coordinates == ORDER
    assert len(a.system.bodies) == 4


# --- problem 1 ---


def test_direction_cosines(a: Analysis, exact: Exact) -> None:
    assert a.kinematics.body("satellite").rotation == as_printed(exact, SYMBOLIC["R12"])
    assert a.kinematics.body("rod").rotation == as_printed(exact, SYMBOLIC["R23"])


def test_direction_cosines_as_the_paper_prints_them(a: Analysis, exact: Exact) -> None:
    printed = [
        ["cos(theta)*cos(psi)", "sin(theta)", "-cos(theta)*sin(psi)"],
        [
            "sin(phi)*sin(psi) - cos(phi)*cos(psi)*sin(theta)",
            "cos(theta)*cos(phi)",
            "cos(psi)*sin(phi) + cos(phi)*sin(theta)*sin(psi)",
        ],
        [
            "cos(psi)*sin(theta)*sin(phi) + cos(phi)*sin(psi)",
            "-cos(theta)*sin(phi)",
            "cos(phi)*cos(psi) - sin(theta)*sin(phi)*sin(psi)",
        ],
    ]
    ours = a.kinematics.body("satellite").rotation
    assert ours == as_printed(exact, printed)
    transposed = Matrix(tuple(zip(*ours.rows, strict=True)))
    assert transposed != as_printed(exact, printed)


def test_angular_velocities(a: Analysis, exact: Exact) -> None:
    satellite, rod = a.kinematics.body("satellite"), a.kinematics.body("rod")
    assert satellite.angular_velocity == tuple(exact(x) for x in SYMBOLIC["omega2"])
    printed = (
        "phi_dot + psi_dot*sin(theta) + omega0*cos(theta)*sin(psi)",
        "theta_dot*sin(phi) + psi_dot*cos(theta)*cos(phi) - omega0*(sin(phi)*cos(psi) + sin(theta)*cos(phi)*sin(psi))",
        "theta_dot*cos(phi) - psi_dot*cos(theta)*sin(phi) + omega0*(sin(theta)*sin(phi)*sin(psi) - cos(phi)*cos(psi))",
    )
    assert satellite.angular_velocity == tuple(exact(x) for x in printed)
    of_satellite = dict(zip(("omega_x", "omega_y", "omega_z"), SYMBOLIC["omega2"], strict=True))
    assert rod.angular_velocity == tuple(exact(x, **of_satellite) for x in SYMBOLIC["omega3"])


def first_approximation_of_mass(a: Analysis, spin_of_joint: Callable[[Any, Any], Any]) -> dict[tuple[str, str], Any]:
    """M1 of rod and point mass at the equilibrium, with V_O3 = R23 (V_O2 + spin x r_O3)."""
    ring = a.ring
    satellite, rod = (a.kinematics.body(name) for name in ("satellite", "rod"))
    turn = rod.rotation.polynomials
    omega2 = tuple(x.polynomial for x in satellite.angular_velocity)
    omega3 = tuple(x.polynomial for x in rod.angular_velocity)
    lower = Exact(a)
    r, l, m, m0 = (lower(name).polynomial for name in ("r", "l", "m", "m0"))
    back = tuple(zip(*turn, strict=True))
    spin = spin_of_joint(omega2, apply(ring, back, omega3))
    origin = tuple(x.polynomial for x in satellite.velocity_origin)
    joint = apply(ring, turn, add(origin, cross(ring, spin, (ring.zero, r, ring.zero))))
    up = (ring.zero, l, ring.zero)
    tip = add(joint, cross(ring, omega3, up))
    doubled = m * (ring.dot(joint, joint) + ring.dot(joint, cross(ring, omega3, up)))
    doubled = doubled + m * l**2 * ring.number(Fraction(1, 3)) * (omega3[0] ** 2 + omega3[2] ** 2)
    doubled = ring.reduce(doubled + m0 * ring.dot(tip, tip))
    rest = {ring.index("sine", name): ring.zero for name in ORDER}
    rest |= {ring.index("cosine", name): ring.one for name in ORDER}
    found = {}
    for i in PITCH:
        for j in PITCH:
            second = ring.velocity_derivative(ring.velocity_derivative(doubled, i), j)
            found[i, j] = Formula(ring, ring.substitute(second, rest) * ring.number(Fraction(1, 2)))
    return found


def test_erratum_1_velocity_of_a_joint_takes_the_spin_of_the_body_before_it(a: Analysis, exact: Exact) -> None:
    """Problem 1 prints omega_k in V_Ok = V_Oj + omega_k x r; the paper's own M1 needs omega_j."""
    mu = {"mu0": "m + m0", "mu1": "(m/2 + m0)*l"}
    right = first_approximation_of_mass(a, lambda before, own: before)
    assert right["theta", "delta"] == exact("f", **FIRST)
    assert right["delta", "delta"] == exact("d", **FIRST)
    wrong = first_approximation_of_mass(a, lambda before, own: own)
    assert wrong["theta", "delta"] == exact("f + (mu1*r + mu0*r**2)", **FIRST, **mu)
    assert wrong["delta", "delta"] == exact("d + 2*mu1*r + mu0*r**2", **FIRST, **mu)


# --- problem 2 ---


def test_kinetic_energy(a: Analysis, exact: Exact) -> None:
    assert a.energy.kinetic_energy == exact(SYMBOLIC["T_full"])


def test_force_function(a: Analysis, exact: Exact) -> None:
    assert a.energy.force_function == total(exact(SYMBOLIC[name]) for name in ("U_0", "U_1", "U_2"))


def test_force_function_in_the_compact_form_of_the_notes(a: Analysis, exact: Exact) -> None:
    u_e = "(sin(theta)*(-sin(delta)*cos(sigma)) + cos(theta)*cos(phi)*cos(delta)*cos(sigma)"
    u_e += " - cos(theta)*sin(phi)*sin(sigma))"
    meanings = {
        "mu0": "m + m0",
        "mu1": "(m/2 + m0)*l",
        "mu2": "(m/3 + m0)*l**2",
        "ex": "sin(theta)",
        "ey": "cos(theta)*cos(phi)",
        "ez": "-cos(theta)*sin(phi)",
        "eu": u_e,
        "uy": "cos(delta)*cos(sigma)",
    }
    second = (
        "nu/R**3*((Jx + Jy + Jz)/2 - 3*(Jx*ex**2 + Jy*ey**2 + Jz*ez**2)/2 + mu0*r**2*(3*ey**2 - 1)/2"
        " + mu1*r*(3*ey*eu - uy) + mu2*(3*eu**2 - 1)/2)"
    )
    assert exact(SYMBOLIC["U_2"]) == exact(second, **meanings)
    first = exact("nu*(M2 + m + m0)/R - nu/R**2*(mu0*r*ey + mu1*eu)", **meanings)
    assert a.energy.force_function == total((first, exact(second, **meanings)))


def test_mass_matrix(a: Analysis, exact: Exact) -> None:
    expected = as_printed(exact, POINTS["mass_matrix_sympy"])
    assert expected.shape == (5, 5)
    assert a.energy.A2 == expected
    assert a.equations.mass_matrix == expected


def test_linear_and_constant_part_of_the_kinetic_energy(a: Analysis, exact: Exact) -> None:
    """From the reference's T: T(q' = 0) and half the odd part at unit velocities."""
    still = {f"{name}_dot": "0" for name in ORDER}
    assert a.energy.A0 == exact(SYMBOLIC["T_full"], **still)
    for name, ours in zip(ORDER, a.energy.A1, strict=True):
        forward = exact(SYMBOLIC["T_full"], **still | {f"{name}_dot": "1"})
        backward = exact(SYMBOLIC["T_full"], **still | {f"{name}_dot": "-1"})
        odd = Formula(a.ring, (forward.polynomial - backward.polynomial) * a.ring.number(Fraction(1, 2)))
        assert ours == odd


def test_chi_is_cyclic_and_nothing_else(a: Analysis) -> None:
    assert a.energy.cyclic == ("chi",)


# --- values at random states ---


@pytest.fixture(scope="module")
def relative(a: Analysis) -> Analysis:
    """T_rel + U_2: the orbit point stands still."""
    return Analysis(variant(a.system, False, "U_2"))


def variant(system: System, moving: bool, *force_functions: str) -> System:
    """The system with other gravity; without ``moving`` the origin of the orbital frame stands still."""
    texts = [SYMBOLIC.get(text, text) for text in force_functions]
    bodies = system.bodies
    if not moving:
        still = replace(bodies[0], connection_point=(ZERO, ZERO, ZERO), relative_velocity=None)
        bodies = (still, *bodies[1:])
    return replace(system, bodies=bodies, loads=tuple(ForceFunction(parsed(text)) for text in texts))


def state(point: dict[str, Any], nu: Fraction | None = None) -> dict[str, fmpq]:
    given = {name: Fraction(x) for name, x in point["parameters"].items() if name != "nu"}
    assert point["parameters"]["nu"] == "omega0**2*R**3"
    given["nu"] = given["omega0"] ** 2 * given["R"] ** 3 if nu is None else nu
    given |= {"chi": Fraction(7, 3), "t": Fraction(1, 7)}
    for suffix, name in (("", "q"), ("_dot", "qdot"), ("_ddot", "qddot")):
        given |= {q + suffix: Fraction(x) for q, x in point[name].items()}
    given |= dict.fromkeys((*FIRST, *SECOND), Fraction(0))
    return {name: fmpq(x.numerator, x.denominator) for name, x in given.items()}


def residuals(a: Analysis) -> list[Formula]:
    return list(a.equations.equalities(a.system.coordinates))


def is_at(a: Analysis, formula: Formula, values: dict[str, fmpq], text: str, digits: int = 28) -> bool:
    with precision(300):
        return agrees(a.ring.evaluate(formula.polynomial, values), text, digits)


@pytest.mark.parametrize("point", POINTS["points"], ids=range(len(POINTS["points"])))
def test_values_of_energies_and_matrices(a: Analysis, relative: Analysis, exact: Exact, point: dict[str, Any]) -> None:
    values = state(point)
    assert is_at(a, a.energy.kinetic_energy, values, point["T_full"])
    assert is_at(relative, relative.energy.kinetic_energy, values, point["T_rel"])
    assert is_at(a, a.energy.force_function, values, point["U_total"])
    assert is_at(relative, relative.energy.force_function, values, point["U_2_quadratic"])
    lagrangian = total((a.energy.kinetic_energy, a.energy.force_function))
    assert is_at(a, lagrangian, values, point["L_full"])
    for system, kind in ((a, "full"), (relative, "rel")):
        assert is_at(system, system.energy.A0, values, point[f"A_0_{kind}"])
        for ours, text in zip(system.energy.A1, point[f"A_i_{kind}"], strict=True):
            assert is_at(system, ours, values, text)
        for row, texts in zip(system.equations.mass_matrix, point["mass_matrix"], strict=True):
            for ours, text in zip(row, texts, strict=True):
                assert is_at(system, ours, values, text)


@pytest.mark.parametrize("point", POINTS["points"], ids=range(len(POINTS["points"])))
def test_values_of_the_equations(a: Analysis, relative: Analysis, point: dict[str, Any]) -> None:
    values = state(point)
    for ours, text in zip(residuals(a), point["EL_residual_full"], strict=True):
        assert is_at(a, ours, values, text)
    for ours, text in zip(residuals(relative), point["EL_residual_rel_L=T_rel+U_2"], strict=True):
        assert is_at(relative, ours, values, text)


def test_equations_with_nu_independent_of_omega0(a: Analysis) -> None:
    """The reference's L, differentiated numerically along q(t) = q + q' t + q'' t^2/2 with 400 digits."""
    point = POINTS["points"][3]
    values = state(point, nu=Fraction(12345, 7))
    code = compile("+".join(SYMBOLIC[name] for name in ("T_full", "U_0", "U_1", "U_2")), "L", "eval")
    with mp.workdps(400):
        numbers = {name: mp.mpf(int(x.p)) / int(x.q) for name, x in values.items()}
        step = mp.mpf(10) ** -60

        def lagrangian(t: Any, name: str = "", shift: Any = 0) -> Any:
            at = dict(numbers, sin=mp.sin, cos=mp.cos)
            for q in ORDER:
                position, velocity, acceleration = (numbers[q + s] for s in ("", "_dot", "_ddot"))
                at[q] = position + velocity * t + acceleration * t**2 / 2
                at[q + "_dot"] = velocity + acceleration * t
            if name:
                at[name] += shift
            return eval(code, {"__builtins__": {}}, at)

        def slope(t: Any, name: str) -> Any:
            return (lagrangian(t, name, step) - lagrangian(t, name, -step)) / (2 * step)

        for q, ours in zip(ORDER, residuals(a), strict=True):
            momentum_rate = (slope(step, q + "_dot") - slope(-step, q + "_dot")) / (2 * step)
            expected = mp.nstr(momentum_rate - slope(0, q), 50)
            assert is_at(a, ours, values, expected, 40)


# --- problem 3 ---

# Figure 5, with the two closing brackets that are missing there: before delta'' and after phi''.
FIGURE_5 = {
    "delta": "1/6*(l*(-l*cos(delta)*sin(2*sigma)*sin(phi)*(m + 3*m0)"
    " + cos(sigma)*cos(phi)*(3*r*cos(delta)*(m + 2*m0) + 2*l*cos(sigma)*(m + 3*m0))))",
    "theta": "1/6*(2*m*((3*r**2 + l*cos(sigma)*(3*r*cos(delta) + l*cos(sigma)))*cos(phi)**2"
    " - l*(3*r + 2*l*cos(delta)*cos(sigma))*cos(phi)*sin(sigma)*sin(phi)"
    " + l**2*(sin(delta)**2 + cos(delta)**2*sin(sigma)**2)*sin(phi)**2)"
    " + 3*cos(phi)**2*(2*Jz + (l**2 + 2*r**2 + 4*l*r*cos(delta)*cos(sigma) + l**2*cos(2*sigma))*m0)"
    " + 6*sin(phi)*(sin(phi)*Jy + l*(-2*(r + l*cos(delta)*cos(sigma))*cos(phi)*sin(sigma)"
    " + l*(sin(delta)**2 + cos(delta)**2*sin(sigma)**2)*sin(phi))*m0))",
    "sigma": "1/6*l*sin(delta)*(-3*r*cos(phi)*sin(sigma)*(m + 2*m0) + 2*l*sin(phi)*(m + 3*m0))",
    "phi": "1/6*l*sin(delta)*(l*m*cos(phi)*sin(2*sigma)"
    " + m*cos(sigma)*(3*r + 2*l*cos(delta)*cos(sigma))*sin(phi)"
    " + 3*(l*cos(phi)*sin(2*sigma) + 2*cos(sigma)*(r + l*cos(delta)*cos(sigma))*sin(phi))*m0)",
    "psi": "-1/24*(4*l*m*(3*r*cos(delta)**2*cos(theta)*cos(2*phi)*sin(sigma)"
    " + 3*r*cos(theta)*cos(2*phi)*sin(delta)**2*sin(sigma)"
    " + l*cos(delta)*cos(theta)*cos(2*phi)*sin(2*sigma) - l*cos(phi)*sin(delta)*sin(theta)*sin(2*sigma)"
    " - cos(sigma)*(3*r + 2*l*cos(delta)*cos(sigma))*sin(delta)*sin(theta)*sin(phi))"
    " + m*cos(theta)*(-l**2 + 12*r**2 + 12*l*r*cos(delta)*cos(sigma)"
    " + l**2*(cos(2*delta) + (3 + cos(2*delta))*cos(2*sigma)))*sin(2*phi)"
    " + 12*cos(theta)*sin(2*phi)*(-Jy + Jz)"
    " - 6*(-2*l**2*cos(delta)*(cos(theta)*cos(2*phi)*sin(2*sigma)"
    " - 2*cos(sigma)**2*sin(delta)*sin(theta)*sin(phi))"
    " + 4*cos(delta)**2*cos(theta)*(l*cos(phi)*sin(sigma) + r*sin(phi))*(-r*cos(phi) + l*sin(sigma)*sin(phi))"
    " + 4*l*sin(delta)*(-r*cos(theta)*cos(2*phi)*sin(delta)*sin(sigma)"
    " + cos(sigma)*sin(theta)*(l*cos(phi)*sin(sigma) + r*sin(phi)))"
    " + cos(theta)*((-l**2 + r**2)*cos(2*delta) - r*(r + 4*l*cos(delta)*cos(sigma)) - l**2*cos(2*sigma))"
    "*sin(2*phi))*m0)",
}


@pytest.mark.parametrize("name", ORDER)
def test_accelerations_in_the_equation_of_theta_as_in_figure_5(a: Analysis, exact: Exact, name: str) -> None:
    ours = a.equations.mass_matrix[ORDER.index("theta"), ORDER.index(name)]
    assert ours == exact(FIGURE_5[name])


# --- problem 4 ---


def test_equilibrium_exists_identically(a: Analysis) -> None:
    assert a.equilibrium.satisfied
    assert a.equilibrium.conditions == ()
    assert all(x.is_zero for x in a.equilibrium.residuals)


def test_equilibrium_exists_for_nu_independent_of_omega0(a: Analysis) -> None:
    free = Analysis(replace(a.system, relations=()))
    assert free.equilibrium.satisfied
    assert all(x.is_zero for x in free.equilibrium.residuals)


# --- problem 5 ---


def test_linear_equations_in_the_notation_of_the_paper(a: Analysis, exact: Exact) -> None:
    """Formula (3) with a, b, c, d, f as symbols; what is printed reads back as the same."""
    assert {part.coordinates for part in a.linearisation.subsystems} == {PITCH, YAW_ROLL}
    for part in a.linearisation.subsystems:
        printed = PRINTED[part.coordinates]
        for name in "MGK":
            ours = getattr(part, name)
            assert ours == as_printed(exact, printed[name])
            assert as_printed(exact, [[str(x) for x in row] for row in ours]) == ours
        assert part.D.is_zero
        assert part.N.is_zero


def test_linear_equations_in_declared_parameters(a: Analysis, exact: Exact) -> None:
    linear = a.linearisation
    assert linear.coordinates == ORDER
    assert linear.M == as_printed(exact, whole("M", "1"), **FIRST)
    assert linear.G == as_printed(exact, whole("G", "omega0"), **FIRST)
    assert linear.K == as_printed(exact, whole("K", "omega0**2"), **FIRST)
    assert linear.D.is_zero
    assert linear.N.is_zero
    assert linear.time_scale == exact("omega0")
    assert exact("c - b - a", **FIRST) == exact("Jz - Jx - Jy")


# The notes, 1.3: what K becomes with wrong gravity, in units of omega0^2 (mu0 = m + m0, mu1 = (m/2 + m0) l).
MU = {"mu0": "m + m0", "mu1": "(m/2 + m0)*l", "mu2": "(m/3 + m0)*l**2"}
TRACE = "-nu/R**3*((Jx + Jy + Jz)/2 + (m + m0)*r**2 + (m + 2*m0)*l*r*cos(delta)*cos(sigma) + (m/3 + m0)*l**2)"
DROPPED = {
    ("theta", "theta"): "R*(mu0*r + mu1)",
    ("theta", "delta"): "R*mu1",
    ("delta", "delta"): "R*mu1",
    ("phi", "phi"): "R*(mu0*r + mu1)",
    ("phi", "sigma"): "R*mu1",
    ("sigma", "sigma"): "R*mu1",
}
NO_TRACE = dict.fromkeys([("delta", "delta"), ("sigma", "sigma")], "-(m + 2*m0)*l*r")
VARIANTS = {
    "T_full + U_0 + U_1 + U_2": (True, ("U_0", "U_1", "U_2"), {}),
    "T_rel + U_2": (False, ("U_2",), {}),
    "T_full + U_0 + U_2": (True, ("U_0", "U_2"), DROPPED),
    "T_rel + U_1 + U_2": (False, ("U_1", "U_2"), {place: f"-({x})" for place, x in DROPPED.items()}),
    "T_full + U_0 + U_1 + U_2, no trace": (True, ("U_0", "U_1", "U_2", TRACE), NO_TRACE),
    "T_rel + U_2, no trace": (False, ("U_2", TRACE), NO_TRACE),
}


@pytest.mark.parametrize("name", VARIANTS)
def test_only_the_stiffness_tells_right_gravity_from_wrong(a: Analysis, name: str) -> None:
    """Every variant has the equilibrium and the printed M and G; K differs by exactly what the notes say."""
    moving, force_functions, differences = VARIANTS[name]
    other = Analysis(variant(a.system, moving, *force_functions))
    exact = Exact(other)
    assert other.equilibrium.satisfied
    assert other.linearisation.M == as_printed(exact, whole("M", "1"), **FIRST)
    assert other.linearisation.G == as_printed(exact, whole("G", "omega0"), **FIRST)
    right = whole("K", "omega0**2")
    assert (other.linearisation.K == as_printed(exact, right, **FIRST)) is not bool(differences)
    for (i, j), text in differences.items():
        for row, column in {(i, j), (j, i)}:
            right[ORDER.index(row)][ORDER.index(column)] += f" + omega0**2*({text})"
    assert other.linearisation.K == as_printed(exact, right, **FIRST, **MU)


def test_the_missing_trace_is_twice_f_minus_d(exact: Exact) -> None:
    assert exact("(m + 2*m0)*l*r") == exact("2*(f - d)", **FIRST)


def test_central_tensors_alone_are_wrong_in_all_entries_of_the_rod(a: Analysis) -> None:
    """Gravity as -3/2 e.Theta_C e of each body: the rod's and the point mass's own places do not count."""
    e_u = "(-sin(delta)*cos(sigma)*sin(theta) + cos(delta)*cos(sigma)*cos(theta)*cos(phi)"
    e_u += " - sin(sigma)*cos(theta)*sin(phi))"
    own = "-3*nu/(2*R**3)*(Jx*sin(theta)**2 + Jy*cos(theta)**2*cos(phi)**2 + Jz*cos(theta)**2*sin(phi)**2"
    own += f" + m*l**2/12*(1 - {e_u}**2))"
    other = Analysis(variant(a.system, False, own))
    exact = Exact(other)
    assert other.equilibrium.satisfied
    assert other.linearisation.M == as_printed(exact, whole("M", "1"), **FIRST)
    assert other.linearisation.G == as_printed(exact, whole("G", "omega0"), **FIRST)
    right, wrong = as_printed(exact, whole("K", "omega0**2"), **FIRST), other.linearisation.K
    of_rod = {(i, j) for names in (PITCH, ("phi", "sigma")) for i in names for j in names}
    for i, first in enumerate(ORDER):
        for j, second in enumerate(ORDER):
            assert (right[i, j] == wrong[i, j]) is ((first, second) not in of_rod)


# --- section 5 ---


def part(a: Analysis, names: tuple[str, ...]) -> Any:
    return next(item for item in a.stability.subsystems if item.coordinates == names)


def test_characteristic_polynomials_in_the_notation_of_the_paper(a: Analysis, exact: Exact) -> None:
    yaw_roll = {6: V["v6"], 4: V["v4"], 2: V["v2"], 0: V["v0"]}
    for names, printed in ((PITCH, LAMBDA1), (YAW_ROLL, yaw_roll)):
        ours = part(a, names).characteristic
        assert len(ours) == 2 * len(names) + 1
        leading = exact.ratio(ours[-1], exact(printed[2 * len(names)]))
        assert leading is not None
        assert leading > 0
        for power, coefficient in enumerate(ours):
            expected = exact(printed.get(power, "0")).polynomial
            assert exact.same(coefficient) == Formula(a.ring, expected * a.ring.number(leading))


@pytest.mark.parametrize(
    ("names", "printed", "factor"),
    [
        (PITCH, LAMBDA1, "c*f"),
        (YAW_ROLL, {int(name[1]): text for name, text in V.items()}, "a*c*f/(1 + alpha)"),
    ],
    ids=["pitch", "yaw-roll"],
)
def test_determinants_in_declared_parameters(a: Analysis, exact: Exact, names: Any, printed: Any, factor: str) -> None:
    """det(lambda^2 M + lambda G + K) = factor * Lambda, and erratum 4: v6 and v0 are det M2, det K2 up to it only."""
    linear, places = a.linearisation, [ORDER.index(name) for name in names]
    m, g, k = ([[x[i, j].polynomial for j in places] for i in places] for x in (linear.M, linear.G, linear.K))
    ours = characteristic_polynomial(m, g, k)
    degree = 2 * len(names)
    for power, coefficient in enumerate(ours):
        text = f"({factor})*({printed.get(power, '0')})*omega0**{degree - power}"
        assert Formula(a.ring, coefficient) == exact(text, **FIRST, **SECOND)
    if names == YAW_ROLL:
        assert Formula(a.ring, ours[-1]) != exact(V["v6"], **FIRST, **SECOND)
        assert Formula(a.ring, ours[0]) != exact(f"({V['v0']})*omega0**6", **FIRST, **SECOND)


def test_relations_of_the_dimensionless_parameters(exact: Exact) -> None:
    meanings = FIRST | SECOND
    assert exact("a/c", **meanings) == exact("(1 - gamma)/(1 + alpha)", **meanings)
    assert exact("b/c", **meanings) == exact("(1 + alpha*gamma)/(1 + alpha)", **meanings)
    assert exact("(c - a)/c", **meanings) == exact("(alpha + gamma)/(1 + alpha)", **meanings)
    assert exact("alpha", **meanings) == exact("(Jz - Jx)/Jy")


@pytest.mark.parametrize("names", [PITCH, YAW_ROLL], ids=["(5)", "(6)"])
def test_conditions_of_stability(a: Analysis, exact: Exact, names: tuple[str, ...]) -> None:
    """All of (5) and (6) up to positive numbers; the first holds because the kinetic energy is positive."""
    printed = [exact(text, **V) for text in CONDITIONS[names]]
    requirements = part(a, names).theory.requirements
    raw = [Formula(part(a, names).ring, r.polynomial) for r in requirements]
    reduced = [formula for _, formula, _ in part(a, names).conditions]
    assert {relation for _, _, relation in part(a, names).conditions} == {">"}
    assert len(reduced) == len(printed) - 1
    for number, expected in enumerate(printed):
        assert any((exact.ratio(x, expected) or 0) > 0 for x in (reduced if number else raw)), CONDITIONS[names][number]
    first = [r for r, x in zip(requirements, raw, strict=True) if (exact.ratio(x, printed[0]) or 0) > 0]
    assert first
    assert all(r.always for r in first)


def rational_point(a: Analysis, parameters: dict[str, str]) -> dict[str, fmpq]:
    """Exact values of parameters and of the user's symbols."""
    numbers = Rationals({}, {})
    values = {name: numbers.number(Fraction(x)) for name, x in parameters.items()}
    carry = Carrier(a.ring, numbers, values)
    symbols = (*FIRST, *SECOND)
    return values | {name: carry(definition_in_parameters(a.parameters_scene, name)) for name in symbols}


@pytest.mark.parametrize("point", LINEAR["points"], ids=range(len(LINEAR["points"])))
def test_values_of_the_linear_data(a: Analysis, exact: Exact, point: dict[str, Any]) -> None:
    values = rational_point(a, point["parameters"])
    values |= dict.fromkeys([name for name in a.ring.names() if name not in values], fmpq(0))
    with precision(300):
        for name, text in {**point["abcdf"], **{name: point[name] for name in SECOND}}.items():
            assert agrees(ball(Fraction(int(values[name].p), int(values[name].q))), text, 28)
        for power, coefficient in zip((0, 2, 4, 6), part(a, YAW_ROLL).characteristic[::2], strict=True):
            assert is_at(a, exact.same(coefficient), values, point["v"][f"v{power}"], 27)
    assert is_at(a, exact(CONDITIONS[YAW_ROLL][-1], **V), values, point["Dis"], 27)
    assert is_at(a, exact(CONDITIONS[PITCH][-1]), values, point["disc5"], 27)


@pytest.mark.parametrize("point", LINEAR["points"], ids=range(len(LINEAR["points"])))
def test_conditions_at_the_points_of_the_reference(a: Analysis, exact: Exact, point: dict[str, Any]) -> None:
    values = rational_point(a, point["parameters"])
    values |= dict.fromkeys([name for name in a.ring.names() if name not in values], fmpq(0))
    for names, pattern in ((PITCH, point["cond5"]), (YAW_ROLL, point["cond6"])):
        assert pattern[0] is True
        reduced = [formula for _, formula, _ in part(a, names).conditions]
        for text, holds in zip(CONDITIONS[names][1:], pattern[1:], strict=True):
            ours = next(x for x in reduced if exact.ratio(x, exact(text, **V)) is not None)
            value = a.ring.evaluate(exact.same(ours).polynomial, values)
            assert bool(value > 0) is holds
            assert bool(value < 0) is not holds


@pytest.mark.parametrize("point", LINEAR["points"], ids=range(len(LINEAR["points"])))
def test_verdicts_at_the_points_of_the_reference(point: dict[str, Any]) -> None:
    numerical = at_values(SHIPPED / "satellite.yaml", **point["parameters"])
    for names, key, pattern in ((PITCH, "lambda2_pitch", "cond5"), (YAW_ROLL, "lambda2_yawroll", "cond6")):
        found = part(numerical, names).theory.at_point
        holds = all(point[pattern])
        assert (found.verdict.word == "unstable") is not holds
        assert (found.roots.right == 0) is holds
        roots = [text.removesuffix(" + i*0.0") for text in point[key]]
        assert sum(Fraction(x) > 0 for x in roots) == found.roots.right
        assert 2 * sum(Fraction(x) < 0 for x in roots) == found.roots.imaginary
        even = [Fraction(int(x.p), int(x.q)) for x in found.characteristic[::2]]
        for text in roots:  # one Newton step from the printed root is smaller than its last digits
            mu = Fraction(text)
            value = sum(x * mu**n for n, x in enumerate(even))
            slope = sum(n * x * mu ** (n - 1) for n, x in enumerate(even) if n)
            assert abs(value / slope) < Fraction(1, 10**27) * abs(mu)
    expected_unstable = not all(point["cond5"] + point["cond6"])
    assert (numerical.stability.numerical.word == "unstable") is expected_unstable


def test_symbolic_verdict_is_open_but_never_stable_by_the_conditions_alone(a: Analysis) -> None:
    """(5) and (6) are necessary conditions of stability, so for symbolic parameters nothing is claimed."""
    assert a.stability.verdict.word == "depends on the parameters"
    for item in a.stability.subsystems:
        assert item.theory.cases


# --- the run verifies itself ---


def test_self_checks_pass(a: Analysis) -> None:
    assert len(a.checks) >= 5
    assert {check.outcome for check in a.checks} <= {"exact", "verified numerically"}
