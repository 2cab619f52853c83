"""Free functions of time, ``given: {a: {of: t}}``: equations by hand, laws put in, and what is said of energies."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping

import numpy as np
import pytest
import sympy
from conftest import Exact

import mbsym
from mbsym.algebra.failures import NoLaw
from mbsym.analysis import Analysis
from mbsym.source import read, to_text, to_yaml

GRAVITY = "loads: [{uniform gravity: {vector: [0, -g, 0]}}]\n"
ROD = "mass centre: [0, -l, 0], mass: m, rotation: {axes: [3], angles: [phi]}"

#: Name -> (parameters with values, functions of time with laws, the rest, initial state).
SYSTEMS: dict[str, tuple[Mapping[str, str], Mapping[str, str], str]] = {
    "moving pivot": (
        {"m": "2", "l": "1/2", "g": "9.81"},
        {"x": "sin(3*t)/5", "y": "t**2/7 - cos(t)/9"},
        f"bodies:\n  - {{name: rod, attached to: 0, connection point: [x, y, 0], {ROD}}}\n{GRAVITY}"
        "initial: {phi: {position: 0.3, velocity: 0}}\n",
    ),
    "varying length": (
        {"m": "2", "g": "9.81"},
        {"l": "1 + sin(2*t)/3"},
        "bodies:\n  - {name: line, attached to: 0, mass: 0, rotation: {axes: [3], angles: [phi]}}\n"
        f"  - {{name: bob, attached to: line, connection point: [0, -l, 0], mass: m}}\n{GRAVITY}"
        "initial: {phi: {position: 0.3, velocity: 0}}\n",
    ),
    "bead on a turning wire": (
        {"m": "2"},
        {"psi": "t + t**2/4"},
        "bodies:\n  - {name: wire, attached to: 0, mass: 0, rotation: {axes: [3], angles: [psi]}}\n"
        "  - {name: bead, attached to: wire, connection point: [r, 0, 0], coordinates: [r], mass: m}\n"
        "initial: {r: {position: 0.3, velocity: 0.1}}\n",
    ),
    "moving mass": (
        {"m": "2", "J": "3"},
        {"s": "1 + sin(t)/2"},
        "bodies:\n  - {name: hull, attached to: 0, mass: 0, inertia about: joint, inertia: [0, 0, J], "
        "rotation: {axes: [3], angles: [phi]}}\n"
        "  - {name: load, attached to: hull, connection point: [s, 0, 0], mass: m}\n"
        "initial: {phi: {position: 0, velocity: 1}}\n",
    ),
    "pendulum of Foucault": (
        {"m": "2", "k": "5"},
        {"psi": "sin(t)/2"},
        "bodies:\n  - {name: table, attached to: 0, mass: 0, rotation: {axes: [3], angles: [psi]}}\n"
        "  - {name: bob, attached to: table, connection point: [x, y, 0], coordinates: [x, y], mass: m}\n"
        "loads: [{potential: k*(x**2 + y**2)/2}]\n"
        "initial: {x: {position: 0.3, velocity: 0}, y: {position: 0, velocity: 0.2}}\n",
    ),
    "driven slider": (
        {"m": "2", "r": "1/2", "b": "1", "J": "1/10"},
        {"a": "5/4 + sin(2*t)/10"},
        "bodies:\n  - {name: crank, attached to: 0, mass: 0, inertia about: joint, inertia: [0, 0, J], "
        "rotation: {axes: [3], angles: [theta]}}\n"
        "  - {name: rod, attached to: crank, connection point: [r, 0, 0], mass centre: [b/2, 0, 0], mass: m, "
        "rotation: {axes: [3], angles: [phi]}}\n"
        "constraints: [{coincide: [{body: rod, point: [b, 0, 0]}, {body: 0, point: [0, 0, 0]}]}]\n",
    ),
    "sled": (
        {"m": "2", "J": "3", "g": "9.81", "k": "1"},
        {"h": "sin(t)", "w": "t/5"},
        "bodies:\n  - {name: sled, attached to: 0, connection point: [x, y, h], coordinates: [x, y, theta], mass: m, "
        "inertia about: joint, inertia: [0, 0, J], rotation: {axes: [3], angles: [theta]}}\n"
        "loads: [{uniform gravity: {vector: [0, 0, -g]}}, {force: {body: sled, point: [0, 0, 0], "
        "components: [k*w - k*w_dot, 0, 0], axes: 0}}]\n"
        "constraints: [{velocity: y_dot*cos(theta) - x_dot*sin(theta) = w_dot/10}]\n"
        "initial: {x: {position: 0, velocity: 1}, y: {position: 0, velocity: 1/50}, "
        "theta: {position: 0, velocity: 1}}\n",
    ),
    "speeds on a moving table": (
        {"m": "2", "J": "3", "k": "1"},
        {"a": "sin(2*t)/3"},
        "bodies:\n  - {name: disc, attached to: 0, connection point: [x + a, y, 0], coordinates: [x, y, theta], "
        "mass: m, inertia about: joint, inertia: [0, 0, J], rotation: {axes: [3], angles: [theta]}, "
        "speeds: {u: (x_dot + a_dot)*cos(theta) + y_dot*sin(theta), v: y_dot*cos(theta) - (x_dot + a_dot)*sin(theta), "
        "p: theta_dot}}\n"
        "loads: [{torque: {body: disc, components: [0, 0, -k*p], axes: 0}}, {potential: k*x**2/2}]\n"
        "initial: {x: 1/10, y: 0, theta: 0, u: 1, v: 0, p: 1/2}\n",
    ),
    "top on a moving pivot": (
        {"m": "2", "A": "3", "C": "1", "l": "1/2", "g": "9.81"},
        {"z": "cos(3*t)/5"},
        "bodies:\n  - {name: top, attached to: 0, connection point: [0, 0, z], mass centre: [0, 0, l], mass: m, "
        "inertia about: joint, inertia: [A, A, C], rotation: {axes: [3, 1, 3], angles: [psi, theta, phi]}, "
        "speeds: {p: omega1, q: omega2, r: omega3}, orientation: {e: quaternion}}\n"
        "loads: [{uniform gravity: {vector: [0, 0, -g]}}]\n"
        "initial: {psi: 0, theta: 1/3, phi: 0, p: 0, q: 1/10, r: 4}\n",
    ),
    "spring with a free rest": (
        {"m": "2", "k": "5", "c": "1/10"},
        {"b": "sin(2*t)"},
        "bodies:\n  - {name: car, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: m}\n"
        "loads: [{spring: {between: [{body: car, point: [0, 0, 0]}, {body: 0, point: [3, 1, 0]}], stiffness: k, "
        "length: 1}}, {rayleigh: c*(x_dot - b_dot)**2/2}, {potential: k*(x - b)**2/2}]\n"
        "initial: {x: {position: 0.3, velocity: 0}}\n",
    ),
}  # fmt: skip


def described(name: str, given: Mapping[str, str] | None = None, more: str = "", put: bool = False) -> str:
    """The description; ``given`` are laws, none where it is empty; ``put``: the laws stand in the functions' places."""
    parameters, laws, rest = SYSTEMS[name]
    head = f"mbsym: 1\nname: {name}\nparameters: {{{', '.join(f'{x}: {value}' for x, value in parameters.items())}}}\n"
    if put:
        for function, law in laws.items():
            t = sympy.Symbol("t")
            rate = str(sympy.diff(sympy.sympify(law, {"t": t}, rational=True), t))
            rest = re.sub(rf"\b{function}_dot\b", f"({rate})", rest)
            rest = re.sub(rf"(?<!\w){function}(?=[],*) /+]|$)", f"({law})", rest)
        return head + rest + more
    known = laws if given is None else given
    entries = (f"{x}: {{of: t{f', value: {known[x]}' if x in known else ''}}}" for x in laws)
    return f"{head}given: {{{', '.join(entries)}}}\n{rest}{more}"


def free(name: str, more: str = "", problems: tuple[int, ...] = (1, 2, 3, 4, 5, 6, 7)) -> Analysis:
    """The system, its functions of time without laws."""
    return mbsym.loads(described(name, {}, more), problems)


def sound(analysis: Analysis) -> None:
    for number in analysis.problems:
        analysis.stage(number)
    assert len(analysis.checks) > 3
    assert not [check for check in analysis.checks if check.failed]


BY_HAND = {
    "moving pivot": {"phi": "m*l*(l*phi_ddot + x_ddot*cos(phi) + (y_ddot + g)*sin(phi))"},
    "varying length": {"phi": "m*l**2*phi_ddot + 2*m*l*l_dot*phi_dot + m*g*l*sin(phi)"},
    "bead on a turning wire": {"r": "m*(r_ddot - r*psi_dot**2)"},
    "moving mass": {"phi": "(J + m*s**2)*phi_ddot + 2*m*s*s_dot*phi_dot"},
    "pendulum of Foucault": {
        "x": "m*(x_ddot - 2*psi_dot*y_dot - psi_ddot*y - psi_dot**2*x) + k*x",
        "y": "m*(y_ddot + 2*psi_dot*x_dot + psi_ddot*x - psi_dot**2*y) + k*y",
    },
    "spring with a free rest": {
        "x": "m*x_ddot + c*(x_dot - b_dot) + k*(x - b) - k*(3 - x)*(1 - 1/sqrt((3 - x)**2 + 1))"
    },
}


@pytest.mark.parametrize("name", BY_HAND)
def test_equations_by_hand(name: str) -> None:
    analysis = free(name, "motion: {}\n")
    exact, names = Exact(analysis), analysis.system.coordinates
    for row, coordinate in enumerate(names):
        assert analysis.equations.equality(row, names) == exact(BY_HAND[name][coordinate]), coordinate
    sound(analysis)


@pytest.mark.parametrize("name", [name for name in SYSTEMS if name not in BY_HAND])
def test_both_routes_agree(name: str) -> None:
    sound(free(name))


def test_of_what_is_given_the_energy_is_no_integral_and_a_momentum_may_be_one() -> None:
    """Of the moving mass (J + m s^2) phi' stays, h and T - U do not; a wire that turns by itself leaves nothing.

    A sled that is pushed in its centre turns evenly: J theta'' = 0, as its blade acts there, too.
    """
    moving = free("moving mass")
    assert [item.kind for item in moving.integrals] == ["cyclic momentum"]
    assert moving.integrals[0].formula == Exact(moving)("(J + m*s**2)*phi_dot")
    turning = free("pendulum of Foucault", problems=(1, 2, 3, 7))  # seen from the table, a central force in space
    assert [item.formula for item in turning.integrals] == [
        Exact(turning)("m*(x*y_dot - y*x_dot + psi_dot*(x**2 + y**2))")
    ]
    sled = free("sled", problems=(1, 2, 3, 7))
    assert [item.formula for item in sled.integrals] == [Exact(sled)("J*theta_dot")]
    for name in ("moving pivot", "varying length", "bead on a turning wire"):
        assert free(name, problems=(1, 2, 3, 7)).integrals == (), name
    steady = mbsym.loads(described("bead on a turning wire", put=True).replace("t + t**2/4", "t"), (7,))
    assert [item.kind for item in steady.integrals] == ["generalised energy"]


def test_motions_that_functions_of_time_lead() -> None:
    """A pivot that moves upright: K = m l (g + y'').  A rod that is led along a: the torque is what its equation asks
    for, and x' = A(t) x + B v with A21 = -g cos(a)/l."""
    analysis = free("varying length", "motion: {phi: 0}\n")
    exact, linear = Exact(analysis), analysis.linearisation
    assert linear.M[0, 0] == exact("m*l**2")
    assert linear.D[0, 0] == exact("2*m*l*l_dot")
    assert linear.K[0, 0] == exact("m*g*l")
    assert analysis.equilibrium.satisfied
    failure = analysis.stage(6).failure
    assert failure is not None
    assert "vary with l " in failure.reason
    lifted = mbsym.loads(described("moving pivot", {}, "motion: {phi: 0}\n").replace("[x, y, 0]", "[0, y + 0*x, 0]"))
    assert lifted.linearisation.K[0, 0] == Exact(lifted)("m*l*(g + y_ddot)")
    pushed = free("moving pivot", "motion: {phi: 0}\n")
    assert not pushed.equilibrium.satisfied
    assert pushed.stage(5).failure is not None
    led = mbsym.loads(
        "mbsym: 1\nname: led\nparameters: {m: positive, l: positive, g: positive, b: real}\ngiven: {a: t}\n"
        f"inputs: {{u: torque}}\nbodies:\n  - {{name: rod, attached to: 0, {ROD}}}\n"
        f"{GRAVITY[:-2]}, {{torque: {{body: rod, components: [0, 0, u - b*phi_dot], axes: 0}}}}]\n"
        "motion: {phi: a, u: m*l**2*a_ddot + b*a_dot + m*g*l*sin(a)}\noutputs: {y: l*sin(phi)}\n"
    )
    exact = Exact(led)
    assert led.equilibrium.satisfied
    assert led.state_space.A[1, 0] == exact("-g*cos(a)/l")
    assert led.state_space.A[1, 1] == exact("-b/(m*l**2)")
    assert led.state_space.B[1, 0] == exact("1/(m*l**2)")
    assert led.state_space.C[0, 0] == exact("l*cos(a)")
    sound(led)
    wrong = mbsym.loads(to_yaml(led.system).replace("b*a_dot", "2*b*a_dot"), (4,))
    assert not wrong.equilibrium.satisfied


def test_a_constraint_leads_as_a_joint_does() -> None:
    """y = a by a relation, theta = 0: m l^2 th'' + m l (g + a'') th = 0, as where a stands in the joint."""
    analysis = mbsym.loads(
        "mbsym: 1\nname: lift\nparameters: {m: positive, l: positive, g: positive}\ngiven: {a: t}\n"
        f"bodies:\n  - {{name: rod, attached to: 0, connection point: [0, y, 0], coordinates: [y, phi], {ROD}}}\n"
        f"{GRAVITY}constraints: [{{relation: y = a}}]\nmotion: {{phi: 0, y: a}}\n"
    )
    linear, exact = analysis.linearisation, Exact(analysis)
    assert linear.coordinates == ("phi",)
    assert linear.M[0, 0] == exact("m*l**2")
    assert linear.K[0, 0] == exact("m*l*(g + a_ddot)")
    sound(analysis)


NUMBERS = {
    "t": 0.7,
    "phi": 0.4,
    "phi_dot": 1.1,
    "r": 0.6,
    "r_dot": -0.3,
    "x": 0.2,
    "x_dot": 0.5,
    "y": -0.3,
    "y_dot": 0.9,
}


@pytest.mark.parametrize("name", [name for name in BY_HAND if name != "moving pivot"])
def test_symbols_at_a_law_are_the_formula_with_the_law(name: str) -> None:
    """M and f with a, a', a'' at a(t0), a'(t0), a''(t0) against those of the description that holds the law itself."""
    parameters, laws, _ = SYSTEMS[name]
    symbolic, formula = free(name), mbsym.loads(described(name, put=True))
    t = sympy.Symbol("t")
    values = NUMBERS | {x: float(sympy.Rational(value)) for x, value in parameters.items()}
    for function, law in laws.items():
        course = sympy.sympify(law, {"t": t}, rational=True)
        for order, ending in enumerate(("", "_dot", "_ddot")):
            values[function + ending] = float(sympy.diff(course, t, order).subs(t, NUMBERS["t"]))

    def at(x: mbsym.analysis.Formula) -> float:  # type: ignore[name-defined]
        expression = x.to_sympy()
        return float(expression.subs({s: values[str(s)] for s in expression.free_symbols}))

    n = range(len(symbolic.system.coordinates))
    for one, other in zip(
        [symbolic.equations.forcing[i] for i in n] + [symbolic.equations.mass_matrix[i, j] for i in n for j in n],
        [formula.equations.forcing[i] for i in n] + [formula.equations.mass_matrix[i, j] for i in n for j in n],
        strict=True,
    ):
        assert at(one) == pytest.approx(at(other), rel=1e-11, abs=1e-11)


@pytest.mark.parametrize("name", [name for name in SYSTEMS if name != "driven slider"])
def test_runs_with_a_law_are_those_of_the_formula(name: str) -> None:
    """By the law of the description, by one for this run, and by the formula in the function's place."""
    by_formula = mbsym.simulate(mbsym.loads(described(name, put=True), ()), 1)
    told = mbsym.simulate(mbsym.loads(described(name), ()), 1)
    asked = mbsym.simulate(mbsym.loads(described(name, {}), ()), 1, inputs=dict(SYSTEMS[name][1]))
    for run in (told, asked):
        assert np.allclose(run.coordinates, by_formula.coordinates, rtol=0, atol=1e-9)


def test_a_loop_with_a_driven_slider_keeps_its_length() -> None:
    """Crank r, rod b to the point (a, 0): a^2 - 2 a r cos(theta) + r^2 = b^2 at all times, by the law of cosines."""
    text = described("driven slider").replace("{body: 0, point: [0, 0, 0]}", "{body: post, point: [0, 0, 0]}")
    text = text.replace(
        "constraints", "  - {name: post, attached to: 0, connection point: [a, 0, 0], mass: 0}\nconstraints"
    )
    text += "initial: {theta: {position: 0.9, velocity: 0}, phi: {position: -1.5, velocity: 0}}\n"
    run = mbsym.simulate(mbsym.loads(text, ()), 1)
    a = 1.25 + np.sin(2 * run.times) / 10
    theta = run.coordinates[0]
    assert abs(a**2 - a * np.cos(theta) + 0.25 - 1).max() < 1e-6
    assert np.ptp(theta) > 0.05


def test_what_has_no_law_is_complained_about_where_numbers_are_wanted() -> None:
    analysis = free("moving pivot")
    with pytest.raises(mbsym.numerics.scenario.Incomplete, match="function of time x has no law"):  # type: ignore[attr-defined]
        mbsym.simulate(analysis, 1, inputs={"y": "t"})
    for study in (mbsym.equilibria, mbsym.floquet):
        with pytest.raises(NoLaw, match="function of time x has no law"):
            study(analysis)
    with pytest.raises(ValueError, match="'x' is a function of time, and the law of a function of time holds only"):
        mbsym.simulate(analysis, 1, inputs={"x": "t", "y": "x"})
    with pytest.raises(ValueError, match="kink"):
        mbsym.simulate(analysis, 1, inputs={"x": "abs(t)", "y": "t"})


@pytest.mark.parametrize("name", SYSTEMS)
def test_both_spellings_keep_it(name: str) -> None:
    text = described(name)
    system, _ = read(text, "x")
    assert system is not None
    assert read(to_yaml(system), "y")[0] == system == read(to_text(system), "t")[0]


def test_reports_write_derivatives_as_such() -> None:
    from mbsym.report import results_json, wolfram_report
    from mbsym.report.latex import report as latex

    analysis = mbsym.loads(described("moving pivot", {"x": "sin(3*t)/5"}, "motion: {phi: 0}\n"))
    written = wolfram_report.render(analysis, (1, 2, 3))
    assert "y''[t]" in written
    assert "x[t_] := Sin[3*t]/5" in written
    assert "_dot" not in latex.render(analysis, (1, 2, 3, 4, 5))
    found = json.loads(results_json.render(analysis, (1, 2, 3)))
    assert [one["name"] for one in found["given"]] == ["x", "y"]
    assert found["prescribed"] == {}


def test_the_editor_renames_it_with_its_derivatives() -> None:
    from mbsym.editing.document import changes

    text = described("spring with a free rest")
    answer = changes(text, "x.yaml", [{"op": "rename", "kind": "parameter", "name": "b", "to": "rest"}])
    assert [one["insert"] for one in answer["edits"]] == ["rest"] * 3  # its key, b_dot, b
    assert text[answer["edits"][1]["from"] :].startswith("b_dot")


def test_generated_code_takes_it_behind_the_parameters_or_has_its_law() -> None:
    """By hand: l phi'' = -x'' cos(phi) - (y'' + g) sin(phi)."""
    from mbsym.report.code import c_source, python_module

    scope: dict[str, object] = {"__name__": "model"}
    analysis = mbsym.loads(described("moving pivot", {"x": "sin(3*t)/5"}), (1, 2, 3))
    exec(python_module.render(analysis, (1, 2, 3)), scope)
    assert scope["PARAMETERS"] == ("m", "l", "g", "y", "y_dot", "y_ddot")
    values = {"m": 2.0, "l": 0.5, "g": 9.81, "y": 0.4, "y_dot": 0.3, "y_ddot": 0.6}
    t, phi = 0.7, 0.3
    found = scope["rhs"](t, np.array([phi, 0.9]), values)  # type: ignore[operator]
    by_hand = (9 * np.sin(3 * t) / 5 * np.cos(phi) - (0.6 + 9.81) * np.sin(phi)) / 0.5
    assert found == pytest.approx([0.9, by_hand], rel=1e-12)
    assert "double y_ddot;" in c_source.header(analysis, (1, 2, 3))


def test_an_fmu_and_modelica_have_it_as_inputs() -> None:
    from mbsym.report.exports import fmu, modelica

    analysis = mbsym.loads(described("varying length", {}), ())
    for version in (2, 3):
        text = str(fmu.sources(analysis, version)["modelDescription.xml"])
        for name in ("l", "l_dot", "l_ddot"):
            assert re.search(rf'name="{name}"[^>]*causality="input"', text), (version, name)
    assert "input Real l_ddot" in modelica.render(analysis, ())


def test_a_periodic_law_has_the_multipliers_of_the_formula() -> None:
    laws = {"x": "t*0", "y": "cos(40*t)/30"}
    texts = [described("moving pivot", laws, "motion: {phi: 0}\n")]
    texts.append(re.sub(r"given: .*\n", "", texts[0]).replace("[x, y, 0]", "[0, cos(40*t)/30, 0]"))
    one, other = (mbsym.floquet(mbsym.loads(text, ())) for text in texts)
    assert float(one.period) == pytest.approx(float(other.period), rel=1e-12)
    first, second = (np.sort_complex([complex(x.ball) for x in found.multipliers]) for found in (one, other))
    assert np.allclose(first, second, rtol=1e-9)


def test_units_of_it_its_derivatives_and_its_law() -> None:
    text = (
        "mbsym: 1\nname: lift\nunits: {phi: rad}\nparameters: {m: {unit: kg}, l: {unit: m}, g: {unit: m/s^2}, "
        "k: {unit: kg/s}, h: {unit: m}, w: {unit: rad/s}}\ngiven: {y: {unit: m, value: h*sin(w*t)}}\nbodies:\n"
        f"  - {{name: rod, attached to: 0, connection point: [0, y, 0], {ROD}}}\n{GRAVITY[:-2]}, "
        "{generalized force: {phi: k*l*y_dot}}, {generalized force: {phi: m*l*y_ddot}}]\n"
    )
    assert read(text, "x")[0] is not None
    for right, wrong in (("k*l*y_dot", "k*l*y"), ("m*l*y_ddot", "m*l*y_dot"), ("h*sin", "w*sin")):
        system, complaints = read(text.replace(right, wrong), "x")
        assert system is None
        assert [one.code for one in complaints.errors] == ["dimension"], wrong
