"""What problems 1 to 7 say of systems with inputs: textbooks, matrices by hand, and sentences that must be denied."""

from __future__ import annotations

import json
import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sympy
from terminal import told

import mbsym
from mbsym.analysis import Analysis
from mbsym.formulas.formula import Matrix
from mbsym.problems.checks import EXACT
from mbsym.report import results_json
from mbsym.report.code import python_module
from mbsym.report.schemas import schema
from mbsym.report.targets import TARGETS

POLE = Path(__file__).parents[2] / "systems" / "cart-pole.yaml"


def equal(found: Matrix, expected: object) -> bool:
    """Whether matrices of formulas are the same."""
    difference = found.to_sympy() - sympy.Matrix(expected)
    return bool(sympy.simplify(difference) == sympy.zeros(*difference.shape))


def symbols(*found: Matrix) -> dict[str, sympy.Symbol]:
    """The parameters of some matrices by name, with what is known of their signs."""
    return {str(x): x for matrix in found for x in matrix.to_sympy().free_symbols}


def test_nothing_is_left_uncancelled_in_the_matrices_of_the_first_order_form() -> None:
    """M of the satellite's second chain has the determinant l^2 D: what of l^2 the adjugate has, too, is cancelled."""
    found = mbsym.load(POLE.with_name("satellite-controlled.yaml")).state_space
    printed = [str(x) for matrix in (found.A, found.B) for row in matrix for x in row]
    quotients = [x.split("/(", 1) for x in printed if "/(" in x]
    assert len(quotients) >= 10
    for top, bottom in quotients:
        assert "l" not in {*top.partition("(")[0].split("*")} & {*bottom.partition("(")[0].split("*")}, (top, bottom)


def test_the_cart_with_a_pole_is_that_of_the_book() -> None:
    # Astrom & Murray, example 5.4, with mu = Mt Jt - m^2 l^2, Mt = M + m, Jt = J + m l^2 (rows 3 and 4 by hand from
    # Mt p'' - m l th'' = F - c p', Jt th'' - m l p'' = m g l th - gamma th').
    found = mbsym.load(POLE).state_space
    assert found.states == ("p", "theta", "p_dot", "theta_dot")
    x = symbols(found.A, found.B)
    total, inertia = x["M"] + x["m"], x["J"] + x["m"] * x["l"] ** 2
    mu = total * inertia - (x["m"] * x["l"]) ** 2
    m, l, g, c, gamma = (x[name] for name in ("m", "l", "g", "c", "gamma"))
    assert equal(
        found.A,
        [
            [0, 0, 1, 0],
            [0, 0, 0, 1],
            [0, m**2 * l**2 * g / mu, -c * inertia / mu, -gamma * l * m / mu],
            [0, total * m * g * l / mu, -c * l * m / mu, -gamma * total / mu],
        ],
    )
    assert equal(found.B, [[0], [0], [inertia / mu], [l * m / mu]])
    assert equal(found.C, [[1, 0, 0, 0], [0, 1, 0, 0]])
    assert found.D.is_zero


FURUTA = """mbsym: 1
name: Furuta's pendulum
parameters: {J: positive, m: positive, r: positive, l: positive, g: positive}
inputs: {tau: torque of the motor}
bodies:
  - {name: arm, attached to: 0, rotation: {axes: [3], angles: [alpha]}, mass: 0, inertia about: joint,
     inertia: [J, J, J]}
  - {name: rod, attached to: arm, rotation: {axes: [1], angles: [theta]}, connection point: [r, 0, 0],
     mass centre: [0, 0, l], mass: m}
loads:
  - uniform gravity: {vector: [0, 0, -g]}
  - torque: {body: arm, components: [0, 0, tau], axes: 0}
motion: {alpha: 0, theta: 0}
outputs: {height: l*cos(theta), work: tau*alpha_dot, sum: alpha + 2*theta_dot + 3*tau}
"""


def test_furutas_pendulum_by_hand() -> None:
    # Point mass at height l above an arm r: near the upright position x = r alpha' along the arm's motion; the rod
    # turned by theta about the arm's axis moves the mass by -l theta sideways:
    # T = J a'^2/2 + m (r a' - l th')^2/2, U = -m g l (1 - th^2/2), so
    # (J + m r^2) a'' - m r l th'' = tau, m l^2 th'' - m r l a'' - m g l th = 0; det M = J m l^2.
    analysis = mbsym.loads(FURUTA)
    linear = analysis.linearisation
    assert linear.B is not None
    assert equal(linear.B, [[1], [0]])
    found = analysis.state_space
    x = symbols(linear.M, linear.K)
    J, m, r, l, g = (x[name] for name in ("J", "m", "r", "l", "g"))
    assert equal(linear.M, [[J + m * r**2, -m * r * l], [-m * r * l, m * l**2]])
    slopes = [[0, m * g * r / J, 0, 0], [0, (J + m * r**2) * g / (J * l), 0, 0]]
    assert equal(found.A, [[0, 0, 1, 0], [0, 0, 0, 1], *slopes])
    assert equal(found.B, [[0], [0], [1 / J], [r / (J * l)]])
    # The height has no first-order part; tau*alpha_dot is of second order about tau = 0, alpha' = 0.
    assert equal(found.C, [[0, 0, 0, 0], [0, 0, 0, 0], [1, 0, 0, 2]])
    assert equal(found.D, [[0], [0], [3]])
    assert {check.outcome for check in analysis.checks} == {EXACT}


DRIVEN = """mbsym: 1
name: pendulum driven by a motor with a field of its own
parameters: {m: positive, l: positive, g: positive, b: positive, k: positive, U0: real, th0: real}
inputs: {U: voltage, w: WIND}
bodies:
  - {name: rod, attached to: 0, rotation: {axes: [3], angles: [theta]}, mass centre: [0, -l, 0], mass: m}
loads:
  - uniform gravity: {vector: [0, -g, 0]}
  - torque: {body: rod, components: [0, 0, k*U - b*theta_dot + w**2*theta_dot], axes: 0}
motion: {theta: th0, U: U0}
"""


def test_a_pendulum_with_a_motor_hangs_where_the_voltage_holds_it() -> None:
    # m l^2 th'' = -m g l sin th + k U - b th': rest at k U0 = m g l sin th0; there K = m g l cos th0, D = b and
    # B = (k, 0).
    analysis = mbsym.loads(DRIVEN)
    (condition,) = analysis.equilibrium.conditions
    assert str(condition) in ("k*U0 - m*l*g*sin(th0)", "m*l*g*sin(th0) - k*U0")
    linear = analysis.linearisation
    assert [str(x) for x in (linear.D[0, 0], linear.K[0, 0])] == ["b", "m*l*g*cos(th0)"]
    assert linear.B is not None
    assert [str(x) for x in linear.B.rows[0]] == ["k", "0"]  # w**2 is of second order at w = 0


def test_held_inputs_reach_the_matrices() -> None:
    # With w held at w0 the damping is b - w0^2 and B holds nothing of theta' = 0.
    analysis = mbsym.loads(DRIVEN.replace("th0: real}", "th0: real, w0: positive}").replace("U: U0}", "U: U0, w: w0}"))
    assert str(analysis.linearisation.D[0, 0]) in ("b - w0**2", "-w0**2 + b")
    assert {check.outcome for check in analysis.checks} <= {EXACT, "verified numerically"}


@pytest.mark.parametrize(
    ("load", "held", "stable"),
    [
        ("generalized force: {x: u - x_dot}", "0", True),  # damped while u rests
        ("generalized force: {x: u*x_dot - x_dot}", "0", True),
        ("generalized force: {x: u*x_dot - x_dot}", "2", False),  # the input takes the damping's sign
        ("generalized force: {x: u*x_dot - x_dot}", "1/2", True),
    ],
)
def test_a_verdict_is_one_for_inputs_at_their_values(load: str, held: str, stable: bool) -> None:
    text = f"""mbsym: 1
name: oscillator
parameters: {{m: positive, k: positive}}
inputs: [u]
bodies: [{{name: cart, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}}]
loads: [{{spring: {{coordinate: x, stiffness: k}}}}, {{{load}}}]
motion: {{x: 0, u: {held}}}
"""
    analysis = mbsym.loads(text)
    assert analysis.stability.verdict.stable == stable
    assert analysis.integrals == ()
    verdict = next(text for text in told(analysis, 6) if text.startswith("Verdict"))
    assert verdict.startswith("Verdict, while the inputs keep their values on the unperturbed motion: ")


BODY = """mbsym: 1
name: body with jets
parameters: {{A: positive, B: positive, m: positive}}
inputs: [u]
bodies:
  - {{name: cart, attached to: 0, connection point: [x, y, 0], mass: m, coordinates: [x, y]}}
  - {{name: wheel, attached to: cart, rotation: {{axes: [3], angles: [phi]}}, mass: 0, inertia about: joint,
     inertia: [A, A, B]}}
loads: [{load}]
motion: {{x: 0, y: 0, phi: 0}}
"""


def kept(load: str) -> set[str]:
    return {item.name for item in mbsym.loads(BODY.format(load=load)).integrals}


def test_what_an_input_may_change_is_not_conserved() -> None:
    everything = {"generalised energy", "momentum of x", "momentum of y", "momentum of phi"}
    assert everything <= kept("generalized force: {x: 0*u}")
    # A push along x: neither the energy nor the momentum of x, and the angular momentum about a point changes.
    pushed = kept("force: {body: cart, point: [0, 0, 0], components: [u, 0, 0], axes: 0}")
    assert {"momentum of y", "momentum of phi"} <= pushed
    assert not {"generalised energy", "momentum of x"} & pushed
    assert not any("angular momentum" in name for name in pushed)
    # A motor between cart and wheel, whose reaction nothing that turns feels: the cart does not turn.
    motor = kept("torque: {body: wheel, components: [0, 0, u], axes: 0}")
    assert {"momentum of x", "momentum of y"} <= motor
    assert not {"generalised energy", "momentum of phi"} & motor
    # A force without power: u (x' y - ...) perpendicular to the velocity keeps the energy for every u, by proof.
    magnetic = mbsym.loads(BODY.format(load="generalized force: {x: u*y_dot, y: -u*x_dot}"))
    (energy,) = [item for item in magnetic.integrals if item.name == "generalised energy"]
    assert energy.status == "proved"
    assert not any(item.name == "momentum of x" for item in magnetic.integrals)


def test_a_torque_with_its_reaction_keeps_the_angular_momentum() -> None:
    text = """mbsym: 1
name: two discs
parameters: {A: positive, B: positive}
inputs: [u]
bodies:
  - {name: hull, attached to: 0, rotation: {axes: [3], angles: [psi]}, mass: 0, inertia about: joint,
     inertia: [0, A, A]}
  - {name: wheel, attached to: hull, rotation: {axes: [3], angles: [phi]}, mass: 0, inertia about: joint,
     inertia: [0, B, B]}
loads: [{torque: {body: wheel, components: [0, 0, u], axes: 0REACTION}}]
motion: {psi: 0, phi: 0}
"""
    inside = mbsym.loads(text.replace("REACTION", ", reaction on: hull"))
    assert "momentum of psi" in {item.name for item in inside.integrals}
    assert [str(x) for x in inside.linearisation.B.to_sympy()] == ["0", "1"]  # type: ignore[union-attr]
    outside = mbsym.loads(text.replace("REACTION", ""))
    assert "momentum of psi" not in {item.name for item in outside.integrals}
    assert [str(x) for x in outside.linearisation.B.to_sympy()] == ["1", "1"]  # type: ignore[union-attr]


def test_first_order_form_against_the_generated_code(tmp_path: Path) -> None:
    # The second route: d rhs/dx by the chain rule along the program, and F enters rhs linearly.
    analysis = mbsym.load(POLE)
    (tmp_path / "pole_of_this_test.py").write_text(python_module.render(analysis, (1, 2, 3, 4, 5)), encoding="utf-8")
    module: dict[str, Any] = runpy.run_path(str(tmp_path / "pole_of_this_test.py"))
    zero, values = np.zeros(4), module["DEFAULTS"]

    def numbers(matrix: Matrix) -> np.ndarray:
        found = matrix.to_sympy()
        return np.array(found.subs({x: values[str(x)] for x in found.free_symbols}), dtype=float)

    whole = analysis.state_space
    assert numbers(whole.A) == pytest.approx(module["jacobian"](0.0, zero, values, [0.0]), rel=1e-12)
    pushed = module["rhs"](0.0, zero, values, [1.0]) - module["rhs"](0.0, zero, values, [0.0])
    assert numbers(whole.B)[:, 0] == pytest.approx(pushed, rel=1e-12)
    assert module["input_matrix"](values).tolist() == numbers(analysis.linearisation.B).tolist()  # type: ignore[arg-type]


def test_the_file_of_results_follows_its_schema() -> None:
    import jsonschema

    for text in (POLE.read_text(encoding="utf-8"), FURUTA, DRIVEN):
        analysis = mbsym.loads(text)
        found = json.loads(results_json.render(analysis, (1, 2, 3, 4, 5, 6, 7)))
        jsonschema.validate(found, schema("results"))
        assert [one["name"] for one in found["inputs"]] == list(analysis.system.input_names)
        assert "state_space" in found


def test_the_first_order_form_may_vary_with_time() -> None:
    timely = DRIVEN.replace("k*U", "k*U*(1 + t)").replace("U: U0", "U: 0").replace("theta: th0", "theta: 0")
    analysis: Analysis = mbsym.loads(timely)
    assert str(analysis.linearisation.B[0, 0]) in ("k*(t + 1)", "k*t + k")  # type: ignore[index]
    # theta'' = -(...) + k (1 + t) U/M: the same column, over the inertia.
    inertia, gain = analysis.linearisation.M[0, 0].polynomial, analysis.state_space.B[1, 0].polynomial
    ring = analysis.ring
    assert ring.is_zero(gain * inertia - analysis.linearisation.B[0, 0].polynomial) is True  # type: ignore[index]
    assert ring.depends_on(gain, "t")


def test_a_table_that_jumps_is_called_by_another_name_where_formulas_hold_it_without_its_jumps() -> None:
    # push is 1 + 3/2 t on [0, 1] and 0 outside: the force of the description.  The equations hold it with its ends
    # outside, less steps; whoever evaluates them with push itself for that takes the ends away twice.
    analysis = mbsym.loads("""
mbsym: 1
name: pushed
tables: {push: {points: [[0, 1], [1, 5/2]], outside: zero}}
bodies: [{name: car, attached to: 0, mass: 2, connection point: [x, 0, 0], coordinates: [x]}]
loads: [{generalized force: {x: push(t)}}]
""")
    found = results_json.results(analysis, [3])
    (table,) = found["tables"]
    assert table == {
        "name": "push", "points": [["0", "1"], ["1", "5/2"]], "between": "linear", "outside": "zero",
        "held": "push_held",
    }  # fmt: skip
    forcing, wolfram = found["equations"]["forcing"][0], analysis.equations.forcing[0].wolfram()
    symbolic = str(analysis.equations.forcing[0].to_sympy())
    names = {"push_held": lambda t: 1 + 1.5 * min(max(t, 0), 1), "sign": lambda x: (x > 0) - (x < 0)}
    for t, force in ((-1, 0), (0.5, 1.75), (2, 0)):
        assert eval(forcing, names | {"t": t}) == force
        assert eval(symbolic, names | {"t": t}) == force
    assert "table$push$held[t]" in wolfram
    assert "table$push[t]" not in wolfram
    report = TARGETS["latex"].render(analysis, [3])
    assert r"\operatorname{push\_held}(t)" in report
    assert r"In formulas \texttt{push\_held} is this table with its end values outside" in report
    notebook = TARGETS["wolfram"].render(analysis, [3])
    assert "table$push$held[x_] := Piecewise[{{(1), x < 0}, {(1) + (3/2)*(x - (0)), x <= 1}}, (5/2)];" in notebook
    assert "table$push[x_] := Piecewise[{{0, x < 0}, {(1) + (3/2)*(x - (0)), x <= 1}}, 0];" in notebook
