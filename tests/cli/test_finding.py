"""What a run tells, result first: each line against a derivation by hand, and where it must be denied."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
import sympy
from conftest import SHIPPED, STATEMENTS, filed, invoked

from mbsym import load, loads
from mbsym.problems.stability.verdict import undecided
from mbsym.problems.stability.words import Because, Word
from mbsym.report.sections.summary import _part
from mbsym.report.targets import TARGETS

PENDULUM = (SHIPPED / "simple-pendulum.yaml").read_text(encoding="utf-8")


def told(tmp_path: Path, text: str, *words: str) -> list[str]:
    """The lines below the title, each whole."""
    file = filed(tmp_path / "system.yaml", text)
    command = ["run", str(file), "--format", "json", "--out", str(tmp_path / "out"), *words]
    done = invoked(*command, env={"COLUMNS": "1000"}, code=0)
    _, *lines = done.stdout.splitlines()
    return [re.sub(" {2,}", "  ", line.strip()) for line in lines]


def test_a_damped_pendulum(tmp_path: Path) -> None:
    """(m l^2 + J) theta'' = -m g l sin theta - b theta'; K = m g l > 0 and D = b > 0."""
    lines = told(tmp_path, PENDULUM)
    assert lines[:4] == [
        "Coordinates  theta",
        "Equations  (m l^2 + J) theta'' + b theta' + m l g sin(theta) = 0",
        "Motion  theta = 0 satisfies the equations of motion identically",
        "Stability  asymptotically stable (Kelvin-Chetaev)",  # at the given values, too: not told a second time
    ]
    assert lines[-2:] == ["Self-check  all exact", f"{tmp_path / 'out' / 'results.json'} (-v tells all of it here)"]


def test_the_same_upside_down_and_without_numbers(tmp_path: Path) -> None:
    """K = -m g l < 0: unstable; without values nothing is said of them."""
    text = PENDULUM.replace("direction: [0, -1, 0]", "direction: [0, 1, 0]").partition("values:")[0]
    lines = told(tmp_path, text)
    (verdict,) = [line for line in lines if line.startswith("Stability")]
    assert verdict == "Stability  unstable (Kelvin-Chetaev)"
    assert not [line for line in lines if line.startswith("At given values")]


def test_conditions_stand_beside_the_verdict_that_depends_on_them(tmp_path: Path) -> None:
    """Bead on a hoop: theta = 0 is stable where g > R Omega^2, by the sign of K = m R (g - R Omega^2).

    At R = 0.1, m = 0.1, b = 0.01, Omega = 14 (the description's values) the roots are those of
    m R^2 x^2 + b x + m R (g - R Omega^2) = 0, with a positive one.
    """
    text = (SHIPPED / "bead-on-hoop.yaml").read_text(encoding="utf-8")
    lines = told(tmp_path, text)
    at = next(k for k, line in enumerate(lines) if line.startswith("Stability"))
    assert lines[at : at + 3] == [
        "Stability  depends on the parameters",
        "asymptotically stable (Kelvin-Chetaev) if g - R Omega^2 > 0",
        "otherwise unstable (Kelvin-Chetaev) if g - R Omega^2 < 0",
    ]
    m, r, b, g, w = (
        float(re.search(rf"\b{x}: *([\d.]+)", text.partition("values:")[2])[1]) for x in ["m", "R", "b", "g", "Omega"]
    )
    root = (-b + (b * b - 4 * m * r**2 * m * r * (g - r * w * w)) ** 0.5) / (2 * m * r**2)
    assert (
        f"unstable (Kelvin-Chetaev), decided exactly; largest real part of an eigenvalue: {root:.4g}" in lines[at - 1]
    )


def test_under_constraints_equations_have_multipliers_and_the_constraints_beside_them(tmp_path: Path) -> None:
    """Chaplygin's sleigh: its knife allows no velocity across; m x_C'' = lambda sin, m y_C'' = -lambda cos by hand.

    x_C = x + a cos(theta).  Of a four-bar what is long is counted, with the command that prints it.
    """
    lines = told(tmp_path, (SHIPPED / "chaplygin-sleigh.yaml").read_text(encoding="utf-8"), "--problems", "3")
    at = next(k for k, line in enumerate(lines) if line.startswith("Equations"))
    assert lines[at : at + 4] == [
        "Equations  m (x'' - a theta'' sin(theta) - a theta'^2 cos(theta)) = lambda_1 sin(theta)",
        "m (y'' + a theta'' cos(theta) - a theta'^2 sin(theta)) = -lambda_1 cos(theta)",
        "m a y'' cos(theta) - m a x'' sin(theta) + (m a^2 + J) theta'' = 0",
        "x' sin(theta) - y' cos(theta) = 0",
    ]
    (line,) = [x for x in told(tmp_path, (SHIPPED / "four-bar.yaml").read_text(encoding="utf-8")) if "longest" in x]
    assert re.fullmatch(r"Equations  3, the longest with \d+ terms \(mbsym show \S+/system.yaml equations\)", line)
    command = line.partition("(mbsym ")[2].removesuffix(")").split()
    assert len(invoked(*command).stdout.splitlines()) > 3


def test_a_system_given_by_its_matrices_has_equations_and_inputs_have_names(tmp_path: Path) -> None:
    """M q'' + (D + G) q' + (K + N) q = B u of G = [[0, g], [-g, 0]], K = diag(-k1, -k2)."""
    lines = told(tmp_path, (SHIPPED / "gyroscopic-pair.yaml").read_text(encoding="utf-8"))
    assert lines[1:3] == ["Equations  x'' + g y' - k1 x = 0", "y'' - g x' - k2 y = 0"]
    shown = invoked("show", SHIPPED / "gyroscopic-pair.yaml", "equations")
    assert shown.stdout.splitlines() == ["x'' + g y' - k1 x = 0", "y'' - g x' - k2 y = 0"]
    (line,) = [x for x in told(tmp_path, (SHIPPED / "cart-pole.yaml").read_text(encoding="utf-8")) if "inputs:" in x]
    assert line == "Coordinates  2: p, theta; L does not contain p; inputs: F"


OPEN = """
mbsym: 1
name: Two coupled particles
parameters: {k: real}
bodies:
  - {name: p0, attached to: 0, mass: 1, connection point: [x, 0, 0], coordinates: [x]}
  - {name: p1, attached to: 0, mass: 1, connection point: [y, 1, 0], coordinates: [y]}
loads:
  - potential: "k*y**2 + x**4"
  - generalized force: {x: "k*y_dot", y: "-k*x_dot"}
motion: {x: 0, y: 0}
"""


def test_where_no_case_holds_it_is_undecided_in_all_media(tmp_path: Path) -> None:
    """x'' - k y' + 4 x^3 = 0, y'' + k x' + 2 k y = 0: lambda^2 (lambda^2 + k (k + 2)), a real root if k (k + 2) < 0.

    Elsewhere two roots are zero, and no theorem of the first approximation is about that: k = 1 is such a place.  Of
    the bead on a hoop nothing is left but the border, which is not told as a region.
    """
    lines = told(tmp_path, OPEN)
    at = lines.index("Stability  depends on the parameters")
    expected = ["unstable (Lyapunov's first method) if k (k + 2) < 0", "otherwise undecided"]
    assert lines[at + 1 : at + 3] == expected
    analysis = loads(OPEN)
    assert "Otherwise \\textbf{undecided}:" in TARGETS["latex"].render(analysis, (6,))
    assert 'Otherwise <strong class="open">undecided</strong>:' in TARGETS["html"].render(analysis, (6,))
    (part,) = json.loads(TARGETS["json"].render(analysis, (6,)))["stability"]["subsystems"]
    assert [(x["verdict"], x["otherwise"]) for x in part["cases"]] == [("unstable", False), ("undecided", True)]
    bead = load(SHIPPED / "bead-on-hoop.yaml").stability.subsystems[0]
    assert not bead.theory.uncovered


def test_what_equations_in_singular_angles_do_not_say_of_the_motion_is_told_with_them(tmp_path: Path) -> None:
    """A body spins about the vertical: gravity has no moment about the pivot if x = 0 and y = 0.

    With rotation axes 3, 1, 3 two angles turn about one line there, and the equations by themselves leave only y = 0.
    """
    lines = told(tmp_path, (STATEMENTS / "staude2.yaml").read_text(encoding="utf-8"))
    assert "Motion  psi = W t, th = phi = 0 satisfies the equations of motion if and only if y = 0, x = 0" in lines
    assert any(x.startswith("Stability  provided the conditions of the motion (problem 4) hold: ") for x in lines)


def test_short_integrals_are_told_with_their_formula(tmp_path: Path) -> None:
    """Of a heavy top the rate of spin about its axis of symmetry is constant: C (phi' + alpha' sin beta)."""
    lines = told(tmp_path, (SHIPPED / "heavy-top.yaml").read_text(encoding="utf-8"))
    assert "momentum of phi (proved): C (alpha' sin(beta) + phi') = const" in lines


FELT = """
mbsym: 1
name: Felt
parameters: {k: positive, c: positive}
bodies:
  - {name: p, attached to: 0, mass: 1, connection point: [x, y, 0], coordinates: [x, y]}
loads:
  - generalized force: {x: "-k*x**3", y: "-c*y_dot"}
motion: {x: 0, y: 0}
"""


def test_a_coordinate_on_which_a_force_depends_is_not_called_absent(tmp_path: Path) -> None:
    """x'' = -k x^3, y'' = -c y': L contains neither, but the first force depends on x."""
    assert "Coordinates  2: x, y; L does not contain y" in told(tmp_path, FELT)
    text = TARGETS["latex"].render(loads(FELT), (2, 3))
    assert "$L$ does not contain $x$, but other forces depend on it." in text
    assert "$L$ does not contain $y$: cyclic." in text


def test_a_quotient_before_a_product_is_not_read_as_a_divisor(tmp_path: Path) -> None:
    """(-v/rR) t is -v t/rR; matrices of -v keep to the width of the terminal, two columns in."""
    lines = told(
        tmp_path, FELT.replace("c: positive", "c: positive, v: real, r: positive").replace("y: 0", "y: {rate: v/r}")
    )
    assert any("y = v t/r" in line for line in lines)
    file = SHIPPED / "cart-pendulum.yaml"
    command = ["run", str(file), "-v", "--problems", "3", "--format", "json", "--out", str(tmp_path / "out")]
    done = invoked(*command, env={"COLUMNS": "80"})
    drawn = [line for line in done.stdout.splitlines() if line.endswith(" ]")]
    entries = [line for line in done.stdout.splitlines() if "M[1" in line]
    assert drawn or entries
    assert all(len(line) <= 80 for line in drawn)


def test_each_group_of_coordinates_has_its_cases_in_order(tmp_path: Path) -> None:
    """A rigid satellite (DeBra and Delp): pitch needs A > B, roll and yaw C > A, C > B for a minimum of the energy."""
    lines = told(tmp_path, (SHIPPED / "gravity-gradient.yaml").read_text(encoding="utf-8"))
    at = next(k for k, line in enumerate(lines) if line.startswith("Stability"))
    apart = "each group of coordinates while the others keep to the motion:"
    assert lines[at] == f"Stability  the whole system: depends on the parameters; {apart}"
    assert lines[at + 1] == "psi, phi: stable (Routh) if C - A > 0, C - B > 0"
    assert lines[at + 2].startswith("otherwise gyroscopically stabilised only, if ")
    assert lines[at + 3] == "otherwise unstable (Kelvin-Chetaev) if (A - C) (B - C) < 0"
    assert lines[at + 4].startswith("otherwise unstable (Lyapunov's first method) if A (2 B - C) + ")
    assert "(A - C) (B - C) < 0" not in lines[at + 4]  # where it holds the case before applies
    assert "theta: stable (Lagrange-Dirichlet) if A - B > 0" in lines
    assert "otherwise unstable (Lyapunov's first method) if A - B < 0" in lines


BALL = """
mbsym: 1
name: ball on a plane, held by a spring
parameters: {r: positive, m: positive, I: positive, k: KIND}
bodies:
  - {name: ball, attached to: 0, connection point: [x, y, r], rotation: {axes: [3, 1, 2], angles: [p, q, s]}, mass: m,
     coordinates: [x, y, p, q, s], inertia about: mass centre, inertia: [I, I, I]}
loads: [{potential: k*(x**2 + y**2)/2}]
constraints: [{rolling: {body: ball, point: [0, 0, -r], axes: 0, on: 0}}]
motion: {x: 0, y: 0, p: 0, q: 0, s: 0}
"""


@pytest.mark.parametrize(
    ("kind", "verdict", "groups"),
    [
        ("positive", "stable but for a drift of cyclic coordinates (Lagrange-Dirichlet)", ()),  # the ball may spin
        ("negative", "the whole system: unstable", ("x: unstable", "y: unstable", "p: undecided")),
    ],
)
def test_groups_of_which_less_is_known_than_of_the_whole_are_not_told(
    tmp_path: Path, kind: str, verdict: str, groups: tuple[str, ...]
) -> None:
    """m (x'^2 + y'^2)/2 + I w^2/2 + k (x^2 + y^2)/2 decides of x and y at once, not of each."""
    first, *further = [x for x in told(tmp_path, BALL.replace("KIND", kind)) if "stable" in x or "undecided" in x]
    assert first.startswith(f"Stability  {verdict}")
    assert len(further) == len(groups)
    assert all(map(str.startswith, further, groups))


def test_a_speed_that_may_be_another_one_is_no_group_to_tell_of(tmp_path: Path) -> None:
    """v' = 0 of a sleigh to first order: nothing decays in it."""
    lines = told(tmp_path, (SHIPPED / "chaplygin-sleigh.yaml").read_text(encoding="utf-8"))
    at = lines.index("Stability  depends on the parameters")
    assert lines[at + 1].startswith(
        "asymptotically stable but for a change of the steady motion (Lyapunov-Malkin) if v > 0"
    )
    assert lines[at + 2].startswith("otherwise unstable")
    assert lines[at + 3].startswith("First integrals")


def test_without_parameters_there_are_no_other_values(tmp_path: Path) -> None:
    """(y^2 + z^2)^2 has a strict minimum; of y^2 z^2, and y^3, there is none."""
    text = """
mbsym: 1
name: particle
bodies: [{name: p, mass: 1, connection point: [x, y, z], coordinates: [x, y, z]}]
loads: [{potential: POTENTIAL}]
motion: {x: 0, y: 0, z: 0}
"""
    lines = told(tmp_path, text.replace("POTENTIAL", "x**2/2 + (y**2 + z**2)**2"))
    assert [line for line in lines if "table" in line] == ["Stability  stable (Lagrange-Dirichlet)"]
    lines = told(tmp_path, text.replace("POTENTIAL", "x**2/2 + y**3 + z**4"))
    assert "Stability  stable" not in "\n".join(lines)


def test_of_many_coordinates_the_first_and_the_last_are_told(tmp_path: Path) -> None:
    bodies = [
        f"  - {{name: p{k}, attached to: 0, mass: 1, connection point: [x{k}, 0, 0], coordinates: [x{k}]}}"
        for k in range(30)
    ]
    text = "\n".join(["mbsym: 1", "name: thirty particles", "bodies:", *bodies, "motion: {x0: 0}", ""])
    lines = told(tmp_path, text, "--problems", "4")
    assert lines[:2] == [
        "Coordinates  30: x0, x1, x2, ..., x29",
        "Motion  satisfies the equations of motion identically",
    ]


def test_no_case_of_stability_stands_beside_a_verdict_of_instability(tmp_path: Path) -> None:
    """K = [[2 a, -1, b - a], [-1, b - 2, 1/2 - b - a], [b - a, 1/2 - b - a, b + 2]] is nowhere positive definite.

    With d = 1/2 - b - a: minor 3 = 2 a (b^2 - 4 - d^2) - (b + 2) - 2 d (b - a) - (b - 2) (b - a)^2; it is negative
    wherever minor 2 = 2 a (b - 2) - 1 > 0 and a > 0 (tried below): "asymptotically stable if" would be of nothing.
    """
    for a, b in [(x / 20, y / 20) for x in range(1, 200) for y in range(41, 400, 3)]:
        d = 0.5 - b - a
        minor = 2 * a * (b * b - 4 - d * d) - (b + 2) - 2 * d * (b - a) - (b - 2) * (b - a) ** 2
        assert 2 * a * (b - 2) <= 1 or minor < 0
    lines = told(tmp_path, (STATEMENTS / "complete-dissipation.yaml").read_text(encoding="utf-8"))
    at = next(k for k, line in enumerate(lines) if line.startswith("Stability"))
    assert lines[at] == "Stability  unstable but for border cases (Kelvin-Chetaev)"
    assert lines[at + 1].startswith("Self-check")


def test_what_is_undecided_in_every_case_is_so_once(tmp_path: Path) -> None:
    """Of a sphere on a turntable, held by springs without linear terms, zero roots remain in every case."""
    text = (SHIPPED / "turntable-sphere.yaml").read_text(encoding="utf-8")
    lines = told(tmp_path, text.replace("loads:\n", "loads:\n  - potential: x**4 + y**4\n"))
    assert [line for line in lines if line.startswith(("Stability", "x, y", "gamma"))] == ["Stability  undecided"]


def test_what_is_decided_case_by_case_is_not_called_undecided() -> None:
    """Conditions too long to be compared leave the verdict on the whole open (bicycle), not the cases."""
    (part,) = load(SHIPPED / "bead-on-hoop.yaml").stability.subsystems
    open_ = undecided(Because.CONDITIONS_UNWRITTEN)
    lines = list(_part(replace(part, theory=replace(part.theory, verdict=open_)), 1, ""))
    assert len(lines) == 2  # g - R Omega^2 > 0 and < 0
    assert Word.UNDECIDED.value not in repr(lines)


def test_conditions_have_no_needless_minus_and_none_that_another_implies(tmp_path: Path) -> None:
    """van der Pol at rest: x'' - mu x' + x = 0 about x = 0.  (N - W^2) (B - C) > 0 says that N is not W^2."""
    lines = told(tmp_path, (STATEMENTS / "van_der_pol_at_rest.yaml").read_text(encoding="utf-8"))
    assert "asymptotically stable (Lyapunov's first method) if mu < 0" in lines
    assert "otherwise unstable (Lyapunov's first method) if mu > 0" in lines
    lines = told(tmp_path, (SHIPPED / "clebsch.yaml").read_text(encoding="utf-8"))
    assert "a, b: stable (Routh) if (N - W^2) (B - C) > 0, (A - C) (B - C) > 0" in lines


def test_only_does_not_belong_to_if(tmp_path: Path) -> None:
    """Ziegler's column with a following force: the conditions are enough for a centre of the linear equations.

    "stable in first approximation only if" would not say so.  A pendulum in a lift has an energy: g + a > 0 is enough.
    """
    lines = told(tmp_path, (SHIPPED / "ziegler.yaml").read_text(encoding="utf-8"))
    assert any(line.startswith("stable in first approximation only, if 7 k - 2 l P > 0, ") for line in lines)
    lines = told(tmp_path, (STATEMENTS / "lift.yaml").read_text(encoding="utf-8"))
    assert "stable (Lagrange-Dirichlet) if g + a > 0" in lines


def test_a_condition_that_varies_has_to_hold_all_the_time(tmp_path: Path) -> None:
    """The rod's weight turns the wheels by m g e cos(p)/10, and p = v t/r: there is no such motion but with v = 0."""
    text = (STATEMENTS.parent / "constraints" / "coupling-rod.yaml").read_text(encoding="utf-8")
    (line,) = [x for x in told(tmp_path, text, "--problems", "1-4") if x.startswith("Motion")]
    assert line.endswith(" satisfies the equations of motion if and only if, at all times, cos(p) = 0")
    text = (SHIPPED / "orbital-gyrostat.yaml").read_text(encoding="utf-8")
    (line,) = [x for x in told(tmp_path, text, "--problems", "1-4") if x.startswith("Motion")]
    assert line.endswith(" satisfies the equations of motion if and only if h1 = 0, h3 = 0")


def test_a_name_in_a_denominator_has_no_brackets(tmp_path: Path) -> None:
    lines = told(tmp_path, (SHIPPED / "dumbbell.yaml").read_text(encoding="utf-8"), "--problems", "1-3")
    assert [line for line in lines if "/(R^3 (m1 + m2))" in line]
    assert not [line for line in lines if "(R)" in line]


def test_at_eighty_columns_text_hangs_beside_its_name_and_short_conditions_are_whole(tmp_path: Path) -> None:
    command = ["run", str(SHIPPED / "satellite.yaml"), "--format", "json", "--out", str(tmp_path / "out")]
    done = invoked(*command, env={"COLUMNS": "80"})
    first, *lines = done.stdout.splitlines()
    assert first.startswith("Satellite with a gravitational stabilizer")
    assert not [line for line in lines if len(line) > 80 and str(tmp_path) not in line]
    assert all(re.match(r"  \S| {19}\S| {21}\S| {23}\S", line) for line in lines if not line.startswith("    ("))
    assert any("discriminant > 0" in line for line in lines)
    assert any("gamma - p2 > 0" in line for line in lines)
    assert "\x1f" not in done.stdout


def test_equations_of_a_rolling_disc_are_told(tmp_path: Path) -> None:
    """m x_C'' = lambda_1, m y_C'' = lambda_2 of x_C = x + r sin(lean) sin(yaw), y_C = y - r sin(lean) cos(yaw)."""
    lines = told(tmp_path, (SHIPPED / "rolling-disc.yaml").read_text(encoding="utf-8"), "--problems", "1-3")
    at = next(k for k, line in enumerate(lines) if line.startswith("Equations"))
    for line, name, inner in zip(lines[at:], "xy", ("r*sin(lean)*sin(yaw)", "-r*sin(lean)*cos(yaw)"), strict=False):
        left, right = line.removeprefix("Equations  ").split(" = ")
        assert right == f"lambda_{'xy'.index(name) + 1}"
        t = sympy.Symbol("t")
        moving = {x: sympy.Function(x)(t) for x in ("x", "y", "yaw", "lean")}
        derivatives = {f"{x}{'d' * k}": f.diff(t, k) for x, f in moving.items() for k in (1, 2)}
        text = re.sub(r"('+)", lambda m: "d" * len(m[1]), left)
        parsed = sympy.parse_expr(re.sub(r"(?<=[\w)]) (?=[\w(])", "*", text).replace("^", "**"), moving | derivatives)
        assert (
            sympy.simplify(parsed - sympy.Symbol("m") * (moving[name] + sympy.sympify(inner, moving)).diff(t, 2)) == 0
        )
    assert lines[at + 5 : at + 7] == ["x' - r spin' cos(yaw) = 0", "y' - r spin' sin(yaw) = 0"]


def test_speeds_bring_their_kinematic_equations(tmp_path: Path) -> None:
    """Euler's and Poisson's equations, as they stand in textbooks; of a disc in its speeds they fill a page."""
    lines = told(tmp_path, (SHIPPED / "euler-poisson.yaml").read_text(encoding="utf-8"), "--problems", "1-3")
    assert "Equations  A p' + (C - B) q r + m g (y0 gamma3 - z0 gamma2) = 0" in lines
    assert "gamma1' = r gamma2 - q gamma3" in lines
    disc = told(tmp_path, (SHIPPED / "rolling-disc-speeds.yaml").read_text(encoding="utf-8"), "--problems", "1-3")
    assert [x for x in disc if x.startswith("Equations  5, the longest with ")]


def test_constraints_leave_as_much_freedom_as_they_do(tmp_path: Path) -> None:
    """A four-bar linkage has three angles and two equations of closure."""
    lines = told(tmp_path, (SHIPPED / "four-bar.yaml").read_text(encoding="utf-8"), "--problems", "1-3")
    assert lines[0] == "Coordinates  3: q1, q2, q3; constraints: 2; degrees of freedom: 1"


def test_what_does_not_hold_and_what_is_missing_are_told(tmp_path: Path) -> None:
    wrong = "claims:\n  - {claim: kinetic energy, equals: J*theta_dot**2/2, place: eq. (9)}\n"
    lines = told(tmp_path, PENDULUM.replace("motion: {theta: 0}\n", "") + wrong)
    assert "Claims  1 refuted" in lines
    assert [line for line in lines if line.startswith("eq. (9), kinetic energy: differs")]
    missing = "Stability  no result: the description gives no unperturbed motion"
    assert [line for line in lines if line.startswith(missing) and "motion: {theta: 0}" in line]
    assert not [line for line in lines if line.startswith("Motion")]


@pytest.mark.parametrize(("language", "word"), [("ru", "Уравнения"), ("es", "Ecuaciones")])
def test_it_speaks_the_language_of_the_report(tmp_path: Path, language: str, word: str) -> None:
    lines = told(tmp_path, PENDULUM, "--language", language)
    assert lines[1] == f"{word}  (m l^2 + J) theta'' + b theta' + m l g sin(theta) = 0"
    assert not [line for line in lines if "stable (" in line and language == "ru"]


def test_set_replaces_a_value(tmp_path: Path) -> None:
    """At Omega = 1, g - R Omega^2 > 0: theta = 0 of the bead on the hoop is stable, and unstable at Omega = 100."""
    text = (SHIPPED / "bead-on-hoop.yaml").read_text(encoding="utf-8")
    cases = [(["Omega=1"], "asymptotically stable"), (["Omega=2*50"], "unstable")]
    cases.append((["Omega=2*b", "b=3*m", "m=1/10"], "asymptotically stable"))  # 0.6
    for settings, word in cases:
        options = [x for one in settings for x in ("-s", one)]
        (line,) = [x for x in told(tmp_path, text, *options) if x.startswith("At given values")]
        assert line.startswith(f"At given values  {word} (Kelvin-Chetaev), decided exactly")


@pytest.mark.parametrize("command", ["run", "show"])
@pytest.mark.parametrize(
    ("setting", "code"),
    [
        ("Omega=-1", "sign-contradiction"),
        ("Om=1", "unknown-name"),
        ("theta=1", "misplaced-name"),
        ("R=x", "unknown-name"),
        ("R", "bad-assignment"),
    ],
)
def test_a_value_that_cannot_be_is_refused(tmp_path: Path, command: str, setting: str, code: str) -> None:
    out = ["--out", str(tmp_path / "out")] if command == "run" else []
    done = invoked(command, SHIPPED / "bead-on-hoop.yaml", "-s", setting, *out, code=2)
    assert f"--set: error[{code}]" in done.output
    assert not (tmp_path / "out").exists()


def test_whether_inputs_reach_everything_and_whether_a_feedback_was_found(tmp_path: Path) -> None:
    """A force on the cart controls cart and pole (every textbook); not a second oscillator that nothing joins to it."""
    text = (SHIPPED / "cart-pole.yaml").read_text(encoding="utf-8")
    start = told(tmp_path, text, "--problems", "1-8")
    control = start.index("Control  Controllability of p, theta by F: yes (proved).")
    assert start[control + 1].startswith("A feedback makes the linear equations asymptotically stable")
    gains = re.fullmatch(r"u = -k z, z = \(p, theta, p', theta'\), k = \[\((.*)\)\]", start[control + 2])
    assert gains is not None
    feedback = loads(text).stabilisation.feedback
    assert [Fraction(x) for x in gains[1].split(", ")] == [*feedback.gains[0]]
    apart = """
mbsym: 1
name: Two oscillators
parameters: {m: {sign: positive}, k: {sign: positive}}
inputs: {F: {}}
bodies:
  - {name: driven, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}
  - {name: alone, attached to: 0, connection point: [y, 0, 0], mass: m, coordinates: [y]}
loads:
  - force: {body: driven, point: [0, 0, 0], components: [F, 0, 0], axes: 0}
  - spring: {coordinate: x, stiffness: k}
  - spring: {coordinate: y, stiffness: k}
motion: {x: 0, y: 0}
values: {m: 1, k: 1}
"""
    (line,) = [x for x in told(tmp_path, apart, "--problems", "1-8", "--force") if x.startswith("Control ")]
    assert "Controllability of x, y by F: no (proved)" in line


def test_long_conditions_are_told_by_the_letters_of_the_paper(tmp_path: Path) -> None:
    """Banshchikov and Vetrov, (6): v6, v4, v2, v0, Dis > 0, of which the kinetic energy gives the first.

    A potential minimum needs alpha > 0, alpha + gamma > 0 and v0 > 0 without 4 alpha: minors of K_2, of (3), in order.
    """
    lines = told(tmp_path, (SHIPPED / "satellite.yaml").read_text(encoding="utf-8"), "--problems", "6")
    begun = "psi, phi, sigma: characteristic polynomial v6 lambda^6 + v4 lambda^4 + v2 lambda^2 + v0 (mbsym show "
    (told_before,) = [k for k, x in enumerate(lines) if x.startswith(begun) and x.endswith(" conditions)")]
    stabilised = "otherwise gyroscopically stabilised only, if v4 > 0, v2 > 0, v0 > 0, discriminant > 0"
    assert told_before < lines.index(stabilised), "letters are told before they are used"
    first = "otherwise unstable (Lyapunov's first method) if v4 < 0 or v2 < 0 or discriminant < 0"
    assert first in lines


def test_letters_are_those_of_what_zero_roots_leave(tmp_path: Path) -> None:
    """Watt's governor with friction, by hand: Lambda = lambda (a3 lambda^3 + ... + a0), and a0 is that of the rest."""
    governor = """mbsym: 1
name: governor
parameters: {m: positive, l: positive, g: positive, b: positive, J: positive, T: positive, k: positive, s: positive}
bodies:
  - {name: shaft, rotation: {axes: [2], angles: [phi]}, inertia about: joint, mass: 0, inertia: [J, J, J]}
  - {name: bob, attached to: shaft, rotation: {axes: [3], angles: [theta]}, mass centre: [0, -l, 0], mass: m}
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
  - damper: {coordinate: theta, coefficient: b}
  - generalized force: {phi: T - k*phi_dot}
motion: {theta: s, phi: {rate: T/k}}
"""
    lines = told(tmp_path, governor, "--problems", "6")
    begun = "characteristic polynomial (a3 lambda^3 + a2 lambda^2 + a1 lambda + a0) lambda"
    assert any(line.startswith(begun) for line in lines)
    assert any(line.endswith("if a0 > 0, Hurwitz minor 2 > 0") for line in lines)


def test_the_letters_of_conditions_are_explained_beside_them(tmp_path: Path) -> None:
    """Those in use, and those that they are made of; none that no condition holds; long ones where they are told."""
    text = (
        "mbsym: 1\nname: letters\nparameters: {m: positive, k: real, p: real, c: positive}\n"
        "bodies: [{name: p, mass: m, connection point: [x, 0, 0], coordinates: [x]}]\n"
        "loads: [{potential: (k - p)*x**2/2}, {damper: {coordinate: x, coefficient: c}}]\nmotion: {}\n"
    )
    assert not [x for x in told(tmp_path, text) if x.startswith("where ")]
    assert "where s = k - p" in told(tmp_path, text + "notation: {s: k - p, other: c/m}\n")
    notation = f"notation: {{s: {' + '.join(['k - p', *['m - m'] * 40])}, other: c/m}}\n"
    assert any(x.startswith("s: letters of the description (mbsym show ") for x in told(tmp_path, text + notation))


def test_what_dependent_rows_presume_stands_at_the_verdict(tmp_path: Path) -> None:
    """x = 0 and x + e z = 0 hold z where e != 0: then U = -y^2/2 alone is felt; else z'' = z grows."""
    path = filed(
        tmp_path / "a.yaml",
        "mbsym: 1\nname: rows\nparameters: {e: {value: 0, sign: real}}\n"
        "bodies: [{name: p, mass: 1, connection point: [x, y, z], coordinates: [x, y, z]}]\n"
        "loads: [{potential: y**2/2 - z**2/2}]\n"
        "constraints:\n  - relation: x = 0\n  - relation: x + e*z = 0\nmotion: {}\n",
    )
    asked = ["run", str(path), "-p", "5,6", "-v", "--format", "json", "--out", str(tmp_path / "out")]
    told = " ".join(invoked(*asked).output.split())
    assert "Stability where e != 0: stable (Lagrange-Dirichlet)" in told
    assert "Verdict, where e != 0: stable (Lagrange-Dirichlet)" in told


def test_on_a_border_it_is_told_what_decides(tmp_path: Path) -> None:
    """m x'' + 4 b x^3 = 0 is stable where b > 0; of m x'' + 3 b x^2 = 0 values would tell."""
    text = """
mbsym: 1
name: border
parameters: {m: positive, b: real}
bodies:
  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}
loads:
  - potential: b*x**4
motion: {x: 0}
"""
    lines = told(tmp_path, text)
    first = lines.index("Stability  depends on the parameters")
    assert lines[first + 1] == "stable (Lagrange-Dirichlet) if b > 0"
    assert lines[first + 2] == "otherwise unstable (converse of Lagrange-Dirichlet) if b < 0"
    lines = told(tmp_path, text.replace("x**4", "x**3"))
    first = lines.index("Stability  undecided")
    assert lines[first + 1].startswith("Terms of higher order may decide: give all parameters values")
    assert not [line for line in told(tmp_path, text.replace("b*", "m*")) if "Terms of" in line or "if b" in line]


def test_a_claim_that_differs_by_little_is_told_by_what(tmp_path: Path) -> None:
    """T = (J + m l^2) theta'^2/2: the moment of inertia forgotten; of a long difference only that there is one."""
    claim = "\nclaims:\n  - {claim: kinetic energy, equals: m*l**2*theta_dot**2/2, place: eq. (1)}\n"
    found = told(tmp_path, PENDULUM + claim, "--problems", "2")
    assert "eq. (1), kinetic energy: differs; claimed minus derived: at theta'^2: -J/2" in found
    long = claim.replace("kinetic energy", "force function").replace("theta_dot**2/2", "(cos(theta) - g)**9")
    lines = told(tmp_path, PENDULUM + long, "--problems", "2", "--force")
    assert "eq. (1), force function: differs" in lines
