"""``mbsym show``: formulas by their names, as people write them and as programs read them."""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path

import pytest
import sympy
from click.testing import Result
from conftest import SHIPPED, derived, filed, invoked

import mbsym
from mbsym.expressions.safe import UNBROKEN
from mbsym.report.formulas_by_name import LANGUAGES, NAMES, accelerations, lines
from mbsym_cli.console import HANGING, between_terms, wrapped


def show(name: str, *words: str, code: int | None = None) -> Result:
    return invoked("show", SHIPPED / f"{name}.yaml", *words, code=code)


@pytest.mark.parametrize(
    ("name", "words", "expected"),
    [
        # J + m l^2 about the joint, by Steiner; the weight's moment; the damper.
        ("simple-pendulum", (), "(m l^2 + J) theta'' + b theta' + m l g sin(theta) = 0\n"),
        ("simple-pendulum", ("T", "U"), "T = (m l^2 + J) theta'^2/2\nU = m l g cos(theta)\n"),
        ("simple-pendulum", ("accelerations",), "theta'' = -(b theta' + m l g sin(theta))/(m l^2 + J)\n"),
        ("simple-pendulum", ("K", "--latex"), "K = m l g\n"),
        ("simple-pendulum", ("D", "--python"), "D = [[b]]\n"),
        ("simple-pendulum", ("D", "--wolfram"), "DPar = {{b}}\n"),  # D is a function there
        (
            "simple-pendulum",
            ("equations", "--latex"),
            "(m l^{2} + J) \\ddot{\\theta} + b \\dot{\\theta} + m l g \\sin \\theta = 0\n",
        ),
        # x^2 + y^2 = l^2, differentiated and halved.
        ("cartesian-pendulum", ("constraints",), "# constraint 1 (distance)\nx' x + y' y = 0\n"),
    ],
)
def test_formulas_are_those_of_the_book(name: str, words: tuple[str, ...], expected: str) -> None:
    result = show(name, *words)
    assert (result.exit_code, result.stdout) == (0, expected)


def test_a_robot_is_m_coriolis_and_gravity() -> None:
    """Two point masses on rods, theta2 between them: M, c and g of textbooks; M is too wide for its rows."""
    lines = show("double-pendulum", "M", "coriolis", "gravity").stdout.splitlines()
    assert lines == [
        "M[1,1] = 2 m2 l1 l2 cos(theta2) + m2 (l1^2 + l2^2) + m1 l1^2",
        "M[1,2] = M[2,1] = m2 l2 (l1 cos(theta2) + l2)",
        "M[2,2] = m2 l2^2",
        "coriolis[1] = -m2 l1 l2 sin(theta2) (2 theta1' + theta2') theta2'",
        "coriolis[2] = m2 l1 l2 theta1'^2 sin(theta2)",
        "gravity[1] = g (l1 (m1 + m2) sin(theta1) + m2 l2 sin(theta1 + theta2))",
        "gravity[2] = m2 l2 g sin(theta1 + theta2)",
    ]
    # Euler's equations have these products of rates, and the moment of the weight: g = r x m g gamma, gamma upwards.
    assert show("euler-poisson", "coriolis").stdout == "coriolis = ((C - B) q r, (A - C) p r, (B - A) p q)\n"
    assert show("euler-poisson", "gravity").stdout.splitlines() == [
        "gravity[1] = m g (y0 gamma3 - z0 gamma2)",
        "gravity[2] = m g (z0 gamma1 - x0 gamma3)",
        "gravity[3] = m g (x0 gamma2 - y0 gamma1)",
    ]


@pytest.mark.parametrize("name", ["double-pendulum", "heavy-top", "spherical-pendulum"])
def test_inertia_coriolis_and_gravity_are_all_of_a_system_of_weights(name: str) -> None:
    """M q'' + c + g = 0."""
    analysis = derived(SHIPPED / f"{name}.yaml")
    one = {x: next(iter(lines(analysis, x))).value for x in ("M", "coriolis", "gravity")}
    rates = [sympy.Symbol(f"{x}_ddot") for x in analysis.system.coordinates]
    for row, c, g, line in zip(one["M"], one["coriolis"], one["gravity"], lines(analysis, "equations"), strict=False):
        total = sum(x.to_sympy() * rate for x, rate in zip(row, rates, strict=True)) + c.to_sympy() + g.to_sympy()
        assert sympy.simplify(total - line.value.to_sympy()) == 0


def test_a_terminal_cuts_no_number_and_no_word() -> None:
    """It breaks formulas in front of signs, outside of brackets where something is near."""
    formula = "(m1 + m2 + m3) x'' + c1 x' - (c1x m1 sin(yaw) + (p2y m2 - p3y m3) cos(yaw)) yaw'' = lambda1"
    told = wrapped(between_terms(formula), 60, HANGING).replace(UNBROKEN, " ")
    assert told.splitlines() == [
        "(m1 + m2 + m3) x'' + c1 x'",
        "  - (c1x m1 sin(yaw) + (p2y m2 - p3y m3) cos(yaw)) yaw''",
        "  = lambda1",
    ]


def test_mistakes_are_told_at_once() -> None:
    """Two languages, of which the last one was taken; names beside steps that cannot be read; a value of nothing."""
    done = show("simple-pendulum", "T", "--latex", "--wolfram", "--reduce", "(", "--set", "theta=1")
    assert (done.exit_code, done.stdout) == (2, "")
    for option in ("--latex: error[conflicting-options]", "--reduce: error[not-both]", "--set: error[misplaced-name]"):
        assert option in done.stderr
    assert "4 errors; nothing was written." in done.stderr


def test_under_constraints_the_right_side_has_the_multipliers() -> None:
    """m x'' = lambda x, m y'' + m g = lambda y: the tension of a rod of length l along (x, y)."""
    lines = show("cartesian-pendulum").stdout.splitlines()
    assert lines[:2] == ["m x'' = x lambda1", "m (y'' + g) = y lambda1"]


def test_equalities_vanish_along_motions_and_feel_what_is_none() -> None:
    """At q'' = M^-1 f, solved by numbers here, and nowhere else."""
    analysis = derived(SHIPPED / "cart-pole.yaml")
    found, names = analysis.equations, analysis.system.coordinates
    values = {x: Fraction(k + 2, 7) for k, x in enumerate(analysis.system.parameter_names)}
    values |= {"p": Fraction(1, 3), "theta": Fraction(0), "p_dot": Fraction(2, 5), "theta_dot": Fraction(3, 4), "F": 1}
    at: dict[str, Fraction | int] = dict(values)
    (a, b), (_, d) = [[_number(x, at) for x in row] for row in found.mass_matrix]
    f, g = (_number(x, at) for x in found.forcing)
    bottom = a * d - b * b
    moving = {"p_ddot": (d * f - b * g) / bottom, "theta_ddot": (a * g - b * f) / bottom}
    assert [_number(x, at | moving) for x in found.equalities(names)] == [0, 0]
    assert [_number(x, at) for x in accelerations(analysis)] == list(moving.values())
    other = moving | {"p_ddot": moving["p_ddot"] + 1}
    assert any(_number(x, at | other) for x in found.equalities(names))


def _number(formula: object, at: dict[str, Fraction | int]) -> Fraction:
    from mbsym.formulas.formula import Formula

    assert isinstance(formula, Formula)
    value = formula.subs(at)
    return Fraction(str(value))


@pytest.mark.parametrize("language", LANGUAGES)
def test_everything_is_written_in_every_language(language: str) -> None:
    words = [] if language == "text" else [f"--{language}"]
    result = show("simple-pendulum", *(name for name in NAMES if name not in ("B", "constraints")), "pendulum", *words)
    assert result.exit_code == 0, result.output
    if language == "python":  # comments, or what Python reads
        for line in result.stdout.splitlines():
            compile(line, "shown", "exec")


def test_help_names_everything_that_may_be_asked_for() -> None:
    text = invoked("show", "--help").output
    assert all(f" {name} " in text.replace("\n", " ") for name in NAMES)


def test_unknown_names_and_missing_results(tmp_path: Path) -> None:
    result = show("simple-pendulum", "equatons", code=2)
    assert "did you mean 'equations'?" in result.stderr
    result = show("simple-pendulum", "B", "T", code=1)
    assert "B: the system has no inputs" in result.stderr
    assert result.stdout.startswith("T = ")
    assert show("simple-pendulum", "constraints").exit_code == 1


def test_the_linear_model_by_its_book_name() -> None:
    """x' = A x: theta'' = -(m l g theta + b theta')/(m l^2 + J); of a pole on a cart B, C and D, too."""
    told = show("simple-pendulum", "A", code=0).stdout.splitlines()
    assert told[0] == "# x' = A x of x = (theta, theta_dot)"
    rows = [line.partition("[")[2].split() for line in told[1:]]
    assert [" ".join(row) for row in rows] == ["0 1 ]", "-m l g/(m l^2 + J) -b/(m l^2 + J) ]"]
    pole = [line for line in show("cart-pole", "A", "--python", code=0).stdout.splitlines() if line[0] != "#"]
    assert [line.partition(" = ")[0] for line in pole] == ["A", "B", "C", "D"]
    assert pole[2:] == ["C = [[1, 0, 0, 0], [0, 1, 0, 0]]", "D = [[0], [0]]"]
    # A disc rolls upright with lean'' = (4 g/(5 r) - 12 w^2/5) lean: stable where w^2 > g/(3 r) (Neimark & Fufaev).
    disc = next(lines(derived(SHIPPED / "rolling-disc-speeds.yaml"), "A"))
    at = {"g": 7, "r": 3, "w": Fraction(5, 2)}
    lean, yaw = 6, 5
    falls, turns, follows = (_number(disc.value[place], at) for place in ((lean, 3), (lean, yaw), (yaw, lean)))
    assert falls + turns * follows == Fraction(4 * 7, 15) - Fraction(12, 5) * Fraction(25, 4)


@pytest.mark.parametrize(
    ("words", "names"),
    [("mass-matrix", "M, M0"), ("stiffness", "K"), ("Lagrangian", "L"), ("linearise", "A"), ("state_space", "A")],
)
def test_what_goes_by_another_name_is_found_by_what_it_is(words: str, names: str) -> None:
    assert f"by its name here: {names}\n" in show("simple-pendulum", words, code=2).stderr
    told = invoked(words, "x.yaml", code=2).output
    assert f"'mbsym show FILE {names.replace(',', '')}' prints it" in told
    assert "nonlinear" not in told


def test_python_has_them_too() -> None:
    pendulum = mbsym.load(SHIPPED / "simple-pendulum.yaml")
    (equation,) = pendulum.equations.equalities(pendulum.system.coordinates)
    assert equation.readable() == "(m l^2 + J) theta'' + b theta' + m l g sin(theta)"


def test_letters_are_those_of_the_description_on_both_sides(tmp_path: Path) -> None:
    text = (SHIPPED / "simple-pendulum.yaml").read_text(encoding="utf-8")
    path = filed(tmp_path / "pendulum.yaml", text + "latex: {theta: '\\vartheta'}\n")
    done = invoked("show", path, "accelerations", "--latex")
    assert done.stdout.startswith("\\ddot{\\vartheta} = "), done.output
    assert "\\theta" not in done.stdout


def test_words_and_roots_may_be_pasted(tmp_path: Path) -> None:
    """lambda^2 + 2 z lambda + 1 = 0 with z = 1e-9: small numbers, words with signs that TeX reads."""
    path = filed(
        tmp_path / "slow.yaml",
        "mbsym: 1\nname: slow\nparameters: {z: positive}\n"
        "linear system: {coordinates: [x], M: [[1]], D: [[2*z]], K: [[1]]}\nvalues: {z: 1e-9}\n",
    )
    shown = {
        language: invoked("show", path, "eigenvalues", "conditions", f"--{language}").stdout
        for language in ("latex", "wolfram", "python")
    }
    assert "-1 \\cdot 10^{-9} + 1\\,\\mathrm{i}" in shown["latex"]
    assert "{-1*^-9 + 1*I, -1*^-9 - 1*I}" in shown["wolfram"]
    assert eval(shown["python"].splitlines()[1]) == (-1e-9 + 1j, -1e-9 - 1j)
    for line in shown["latex"].splitlines():
        assert line.startswith("%") or "\\text" not in line


def test_conditions_are_the_cases_that_run_tells() -> None:
    """Gutnik & Sarychev: B - A + h > 0 and 4 (B - C) + h > 0 suffice; what else is told by name stands below."""
    told = show("orbital-gyrostat", "conditions", code=0).stdout.splitlines()
    assert told[:4] == ["# provided that", "h1 = 0", "# provided that", "h3 = 0"]
    at = told.index("stable (Routh), if all of these hold:")
    assert told[at - 1] == "# psi, phi"
    assert told[at + 1 : at + 6] == [
        "B - A + h > 0", "4 B - 4 C + h > 0",
        "otherwise gyroscopically stabilised only, if all of these hold:", "v2 > 0", "v0 > 0",
    ]  # fmt: skip
    assert "otherwise unstable (Kelvin-Chetaev), if:" in told
    assert told[told.index("# v0 of psi, phi") + 1] == "(B - A + h) (4 B - 4 C + h) > 0"
    # Pitch: a condition and its opposite, and no list of what roots need.
    assert told[-4:] == [
        "stable (Lagrange-Dirichlet), if:", "A - C > 0",
        "otherwise unstable (Lyapunov's first method), if:", "A - C < 0",
    ]  # fmt: skip
    # Where nothing suffices nothing is said to.
    assert not [
        line for line in show("ziegler", "conditions", code=0).stdout.splitlines() if line.startswith("stable (")
    ]


def test_a_condition_up_to_a_positive_factor_is_told_once(tmp_path: Path) -> None:
    """A gyrostat in orbit, its rotor along the normal: det K < 0 and v0 < 0 are one condition, v0 = 4 det K.

    K22 = w0 (J (w0 + 2 s) - 2 w0 (B - C))/2, K33 = w0 (J (2 w0 + s) - 4 w0 (A - C)), which nothing couples (Roberson).
    """
    text = """
mbsym: 1
name: gyrostat
parameters: {A: positive, B: positive, C: positive, J: positive, w0: positive, s: real, nu: positive, R: positive}
bodies:
  - {name: orbit, attached to: 0, rotation: {axes: [3], angles: [w0*t]},
     connection point: [R*cos(w0*t), R*sin(w0*t), 0], mass: 0}
  - {name: satellite, attached to: orbit, rotation: {axes: [3, 1, 2], angles: [alpha, beta, gamma]}, mass: 1,
     inertia: [A, B, C], inertia about: mass centre}
  - {name: rotor, attached to: satellite, rotation: {axes: [3], angles: [s*t]}, mass: 0, inertia: [J/2, J/2, J],
     inertia about: mass centre}
loads: [newtonian gravity: {constant: nu, centre: 0, about: orbit}]
relations: {nu: w0^2*R^3}
motion: {alpha: 0, beta: 0, gamma: 0}
"""
    told = invoked("show", filed(tmp_path / "gyrostat.yaml", text), "conditions").stdout.splitlines()
    at = told.index("otherwise unstable (Kelvin-Chetaev), if:")
    assert told[at + 1 : at + 6] == [
        "v0 < 0", "otherwise unstable (Lyapunov's first method), if at least one of these holds:", "v2 < 0",
        "discriminant < 0", "# v2 of beta, gamma",
    ]  # fmt: skip
    v0 = told[told.index("# v0 of beta, gamma") + 1]
    assert v0 == "2 w0^2 (4 w0 (A - C) - J (2 w0 + s)) (2 w0 (B - C) - J (w0 + 2 s)) > 0"


def test_conditions_of_what_holds_for_all_parameters_are_its_verdict(tmp_path: Path) -> None:
    """A Hurwitz minor that is positive is no condition, nor one of a motion that is unstable whatever it is.

    m x'' + c x' + k x = 0 with c, k > 0, and with -k in place of k.
    """
    text = (
        "mbsym: 1\nname: springs\nparameters: {c: positive, k: positive}\n"
        "linear system: {coordinates: [x, y], D: [[c, 0], [0, c]], K: [[STIFFNESS, k], [k, 2*k]]}\n"
    )
    for stiffness, verdict in (("2*k", "asymptotically stable"), ("-2*k", "unstable")):
        path = filed(tmp_path / "springs.yaml", text.replace("STIFFNESS", stiffness))
        assert invoked("show", path, "conditions").stdout == f"# x, y\n{verdict} (Kelvin-Chetaev)\n"


def test_beside_a_the_letters_of_inputs_and_outputs_are_those_of_the_state_space(tmp_path: Path) -> None:
    """x'' + d x' + k x = u: x' = A x + B u has B = (0, 1); nothing is called by one name twice."""
    told = show("cart-pole", "A", "B", "C", "D", "K", "--python", code=0).stdout
    assert re.findall(r"^(\w+) = ", told, re.MULTILINE) == ["A", "B", "C", "D", "K"]
    assert eval(re.search(r"^D = (.*)", told, re.MULTILINE)[1]) == [[0], [0]]
    # Without inputs D is that of damping.
    assert show("simple-pendulum", "A", "D", code=0).stdout.endswith("D = b\n")
    start = "mbsym: 1\nname: given\nparameters: {d: positive, k: positive}\ninputs: {u: {}}\nlinear system: "
    given = filed(tmp_path / "given.yaml", start + "{coordinates: [x], D: [[d]], K: [[k]], B: [[1]]}\n")
    told = invoked("show", given, "A", "B", "--python").stdout.splitlines()
    assert told[1::2] == ["A = [[0, 1], [-k, -d]]", "B = [[0], [1]]"]
    first = filed(tmp_path / "first.yaml", start + "{coordinates: [x, v], A: [[0, 1], [-k, -d]], B: [[0], [1]]}\n")
    assert invoked("show", first, "A", "B", "--python").stdout.splitlines()[1::2] == told[1::2]
    assert "(x, v)" in invoked("show", first, "A").stdout


def test_determinants_are_those_that_a_paper_prints() -> None:
    """Banshchikov & Vetrov, before (5): rows freed of positive factors, in alpha, gamma, p1, p2."""
    told = show("satellite", "determinants").stdout
    entries = [
        [re.sub(r"\s+", "", cell) for cell in re.split(r" {3,}", line.split("|")[1].strip())]
        for line in told.splitlines()
        if "|" in line
    ]
    assert entries == [
        ["lambda^2+alpha", "(alpha-1)lambda", "0"],
        ["(alpha-1)(gamma-1)lambda", "(alphagamma+1)lambda^2+4(alpha+gamma)", "p2(alpha+1)(lambda^2+4)"],
        ["0", "lambda^2+4", "p1lambda^2+p1+3"],
        ["lambda^2+3gamma", "p2(lambda^2+3)"],
        ["lambda^2+3", "p1lambda^2+3"],
    ]


@pytest.mark.parametrize(
    "name", ["satellite", "ziegler-damped", "heavy-top", "satellite-with-damper-slow", "gyroscopic-pair"]
)
def test_determinants_have_the_roots_of_the_characteristic_polynomials(name: str) -> None:
    """Both as Python reads them, at a rational point: the ratio is one positive number at three values of lambda."""
    names = derived(SHIPPED / f"{name}.yaml").system
    at = {
        x: Fraction(2 * k + 3, 11)
        for k, x in enumerate((*names.parameter_names, *(one.name for one in names.notation)))
    }
    polynomials = [
        eval(line, {}, at) for line in show(name, "characteristic", "--python").stdout.splitlines() if line[0] != "#"
    ]
    determinants = [
        line.split(" = ")[1] for line in show(name, "determinants", "--python").stdout.splitlines() if line[0] != "#"
    ]
    assert len(polynomials) == len(determinants)
    for polynomial, text in zip(polynomials, determinants, strict=True):
        ratios = set()
        for value in (Fraction(1, 2), Fraction(3), Fraction(-7, 5)):
            whole = sum(c * value**k for k, c in enumerate(polynomial))
            ratios.add(Fraction(eval(text, {"det": _det}, at | {"lam": value})) / whole)
        assert len(ratios) == 1
        assert ratios.pop() != 0


def _det(rows: list[list[Fraction]]) -> Fraction:
    """By the first column."""
    if not rows:
        return Fraction(1)
    return sum(
        (
            (-1) ** i * row[0] * _det([other[1:] for j, other in enumerate(rows) if j != i])
            for i, row in enumerate(rows)
        ),
        Fraction(0),
    )


def test_an_equation_begins_with_its_accelerations() -> None:
    """m l^2 + J, and the rest, of the pendulum; of speeds their rates; the sum is what 'equations' says."""
    assert show("simple-pendulum", "theta").stdout.splitlines()[1::2] == [
        "(m l^2 + J) theta''",
        "b theta' + m l g sin(theta)",
    ]
    first, rest = show("satellite-with-damper-slow", "q").stdout.splitlines()[1::2]
    # x0' and the particle's own acceleration: M of the third row of Euler's equations.
    assert first == "A (eps x^2 + 2 eps rho x + 1) q' - A eps y'"
    assert "'" not in rest
    # Rows in the order of bodies: where one has coordinates alone, its equation goes by these.
    cart = "{name: cart, connection point: [x, 0, 0], coordinates: [x], mass: m}"
    body = "{name: body, attached to: cart, rotation: {axes: [3], angles: [a]}, mass: 0, inertia about: joint, "
    body += "inertia: [J/2, J/2, J], speeds: {w: omega3}}"
    text = f"mbsym: 1\nname: Two\nparameters: {{m: positive, J: positive, k: real}}\nbodies: [{cart}, {body}]\n"
    mixed = mbsym.loads(f"{text}loads: [{{generalized force: {{x: k}}}}]\n")
    assert [str(line.value) for line in lines(mixed, "x")] == ["m*x_ddot", "-k"]
    assert [str(line.value) for line in lines(mixed, "w")] == ["J*w_dot", "0"]
    tied = show("cartesian-pendulum", "x").stdout.splitlines()
    assert tied[1] == "m x''"
    assert tied[2].endswith("but for the forces of constraints")


@pytest.mark.parametrize("name", ["double-pendulum", "tethered-satellites", "gyrostat", "satellite-with-damper-slow"])
def test_kinetic_energies_of_bodies_add_up(name: str) -> None:
    from mbsym.report.formulas_by_name import lines

    analysis = derived(SHIPPED / f"{name}.yaml")
    parts = [x for body in analysis.system.bodies for x in lines(analysis, body.name) if x.name == "T"]
    assert sum((part.value for part in parts[1:]), parts[0].value) == analysis.energy.kinetic_energy


def test_a_body_has_its_place_and_a_frame_no_energy(tmp_path: Path) -> None:
    """The end of an arm of length a, turned by q about the third axis, is at (a cos q, a sin q, 0): without mass."""
    file = tmp_path / "arm.yaml"
    link = "{name: link, attached to: 0, rotation: {axes: [3], angles: [q]}, mass: m, mass centre: [a, 0, 0]}"
    tip = "{name: tip, attached to: link, connection point: [a, 0, 0], mass: 0}"
    file.write_text(f"mbsym: 1\nname: Arm\nparameters: {{m: positive, a: positive}}\nbodies: [{link}, {tip}]\n")
    told = invoked("show", file, "tip").stdout
    assert "r_O = (a cos(q), a sin(q), 0)" in told.splitlines()
    assert "V_O = (0, a q', 0)" in told.splitlines()
    assert "T =" not in told
    assert "V_C" not in told  # it is the same


def test_equations_that_fill_screens_are_printed_where_they_are_asked_for() -> None:
    """Those of the satellite take several screens, as its paper says; their length and the names to ask by are told."""
    told = show("satellite", code=0)
    assert len(told.stdout) < 500
    assert " sigma\n" in told.stdout
    assert len(show("satellite", "sigma").stdout) > 2000
