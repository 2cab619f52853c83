"""Reports: every file is read back, run or compiled, and compared with exact results."""

from __future__ import annotations

import hashlib
import json
import os
import random
import re
import shutil
import subprocess
import sys
from fractions import Fraction
from math import comb
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import SHIPPED, compiled_latex, filed, imported, needs_pdflatex, precision
from flint import arb, fmpq
from terminal import told

import mbsym
from mbsym.algebra.signs import Condition
from mbsym.analysis import Analysis
from mbsym.expressions.message import Message
from mbsym.expressions.tree import Name, Number, Operation
from mbsym.formulas.formula import Formula
from mbsym.formulas.latex import LatexNames
from mbsym.problems.stability.requirements import OF_FACTOR, PART, REVERSED, Case, Requirement
from mbsym.problems.stability.verdict import Verdict
from mbsym.report.conditions import Shown, Statement, cases, statements
from mbsym.report.content import Math, Readable
from mbsym.report.language import Language
from mbsym.report.latex.description import expression
from mbsym.report.latex.formulas import LONGEST_CONDITION
from mbsym.report.latex.labels import Form
from mbsym.report.latex.labels import Labels as TexLabels
from mbsym.report.latex.writer import LINE, Writer, broken
from mbsym.report.sections.stability import label_of
from mbsym.report.targets import TARGETS

#: Names that are reserved in some language, or look alike in another; forces of many kinds; a comment-closing name.
NASTY = """
mbsym: 1
name: 'Names *) "and" \\ 100% {of} \\end{document} $all$ sorts_^~'
description: "Ends with a quote and a backslash: \\"\\"\\" \\\\"
parameters: {N: positive, K: positive, np: positive, q: positive, a_b: positive, ab: positive, sin1: positive, x: real,
  C: {sign: positive, meaning: 'a "stiffness" \\ 5% *)'}, omega_0: real, omega0: {sign: positive, value: 1/3}}
prescribed: {p: {rate: omega0, initial: ab/10}}
bodies:
  - name: first body
    attached to: 0
    rotation: {axes: [3, 1], angles: [phi, p]}
    connection point: [s, 0, 0]
    coordinates: [s, phi]
    mass centre: [K/3, a_b, 0]
    mass: N
    inertia about: mass centre
    inertia: [np, q, ab]
  - name: tip
    attached to: first body
    rotation: {axes: [2], angles: [lam]}
    connection point: [0, 0, K]
    mass centre: [0, 0, sin1]
    mass: x**2 + 1
loads:
  - uniform gravity: {vector: [0, -C, 0]}
  - damper: {coordinate: lam, coefficient: omega0}
  - force function: -C*s**2/2 + q*exp(-a_b*t)*cos(phi/2) - omega_0*sqrt(s**2 + 1)
motion: {s: 0, phi: 0, lam: 0}
"""
TWO_LINKS = "double-pendulum.yaml"
SYSTEMS = ["satellite.yaml", "ziegler-damped.yaml", "heavy-top.yaml", "spring-pendulum.yaml"]


def analysis_of(name: str) -> Analysis:
    return mbsym.loads(NASTY) if name == "nasty" else mbsym.load(SHIPPED / name)


def in_latex(value: Math) -> str:
    return Writer(LatexNames([]), Language(), TexLabels("x"), Form.REPORT).math(value)


def loaded(text: str, folder: Path):
    return imported(filed(folder / "model.py", text))


def state_of(analysis: Analysis, source: random.Random) -> dict[str, Fraction]:
    """Values of all names; a prescribed quantity has the value that its motion gives."""
    values = {name: Fraction(source.randint(20, 80), 64) for name in analysis.ring.names()}
    from mbsym.algebra.base import Lowering
    from mbsym.algebra.point import Rationals

    numbers = Rationals({}, {})
    lower = Lowering(numbers, {name: numbers.number(value) for name, value in values.items()})
    for item in analysis.system.prescribed:
        exact = lower(item.rate) * numbers.number(values["t"])
        exact = exact if item.initial is None else exact + lower(item.initial)
        values[item.name] = Fraction(int(exact.p), int(exact.q))
    return values


def exact(analysis: Analysis, polynomial, values) -> float:
    with precision(200):
        return float(
            analysis.ring.evaluate(polynomial, {k: arb(fmpq(v.numerator, v.denominator)) for k, v in values.items()})
        )


def close(found, expected, scale=None) -> bool:
    found, expected = np.asarray(found, float), np.asarray(expected, float)
    return bool(np.all(np.abs(found - expected) <= 1e-12 * max(1.0, np.abs(expected).max(initial=scale or 0.0))))


# --- model.py ---


@pytest.mark.parametrize("name", [*SYSTEMS, "nasty"])
def test_the_module_agrees_with_the_exact_formulas(name, tmp_path):
    analysis = analysis_of(name)
    model = loaded(TARGETS["python"].render(analysis, analysis.problems), tmp_path)
    assert (analysis.system.coordinates, analysis.system.parameter_names) == (model.COORDINATES, model.PARAMETERS)
    source = random.Random(5)
    n = len(model.COORDINATES)
    states = [state_of(analysis, source) for _ in range(3)]
    p = {key: float(states[0][key]) for key in model.PARAMETERS}
    for values in states:
        values |= {key: states[0][key] for key in model.PARAMETERS} | {"t": states[0]["t"]}
        values |= {item.name: states[0][item.name] for item in analysis.system.prescribed}
    q = np.array([[float(values[key]) for values in states] for key in model.COORDINATES])
    qd = np.array([[float(values[key]) for values in states] for key in analysis.system.velocities])
    t = float(states[0]["t"])
    mass, right = model.mass_matrix(q, p, t), model.forcing(q, qd, p, t)
    energies = model.energy(q, qd, p, t)
    rates = model.rhs(t, np.concatenate([q, qd]), p)
    for k, values in enumerate(states):
        expected = [[exact(analysis, x.polynomial, values) for x in row] for row in analysis.equations.mass_matrix]
        forces = [exact(analysis, x.polynomial, values) for x in analysis.equations.forcing]
        kinetic = exact(analysis, analysis.energy.kinetic_energy.polynomial, values)
        potential = exact(analysis, analysis.energy.force_function.polynomial, values)
        assert close(mass[..., k], expected)
        assert close(right[:, k], forces, abs(kinetic))
        assert close(energies[k], kinetic - potential, abs(kinetic) + abs(potential))
        assert close(expected @ rates[n:, k], forces, 10 * np.abs(forces).max() + abs(kinetic))
        one = model.rhs(t, np.concatenate([q[:, k], qd[:, k]]), [p[key] for key in model.PARAMETERS])
        assert close(one, rates[:, k])


def test_linear_matrices_of_the_module(tmp_path):
    analysis = analysis_of("ziegler-damped.yaml")
    model = loaded(TARGETS["python"].render(analysis, (5,)), tmp_path)
    values = state_of(analysis, random.Random(1))
    found = model.linear_matrices({key: float(values[key]) for key in model.PARAMETERS})
    for matrix, numbers in zip(analysis.linearisation.matrices, found, strict=True):
        assert close(numbers, [[exact(analysis, x.polynomial, values) for x in row] for row in matrix])
    assert not hasattr(loaded(TARGETS["python"].render(analysis, (3,)), tmp_path), "linear_matrices")


def test_the_module_complains_of_all_missing_parameters_at_once(tmp_path):
    analysis = analysis_of("nasty")
    model = loaded(TARGETS["python"].render(analysis, (3,)), tmp_path)
    assert model.DEFAULTS["N"] is None
    assert Fraction(model.DEFAULTS["omega0"]).limit_denominator(10) == Fraction(1, 3)
    with pytest.raises(ValueError, match="no value for the parameters N, np, q, a_b, ab, sin1, x, C, omega_0"):
        model.mass_matrix([0, 0, 0], {"K": 1, "omega0": 2})
    with pytest.raises(ValueError, match="expected 11 parameters"):
        model.mass_matrix([0, 0, 0], [1, 2])
    with pytest.raises(ValueError, match="expected shape"):
        model.mass_matrix([0, 0], dict.fromkeys(model.PARAMETERS, 1.0))


# --- results.json ---


def test_results_hold_what_was_asked_for():
    analysis = analysis_of("satellite.yaml")
    found = json.loads(TARGETS["json"].render(analysis, (1, 2, 3, 4, 5, 6, 7)))
    assert set(found) == {
        "format", "version", "problems", "terms", "prescribed", "motion", "initial",
        "system", "coordinates", "parameters", "kinematics", "energy", "equations", "equilibrium", "linearisation",
        "stability", "integrals", "claims", "checks", "unavailable", "relations", "assumptions",
    }  # fmt: skip
    assert found["unavailable"] == {}
    assert {claim["outcome"] for claim in found["claims"]} == {"holds exactly"}
    assert set(found["kinematics"]["bodies"][0]) == {
        "name", "rotation", "angular_velocity", "velocity_origin", "velocity_mass_centre",
    }  # fmt: skip
    assert found["energy"]["cyclic"] == ["chi"]
    assert found["equilibrium"]["satisfied"] is True
    yaw, pitch = found["linearisation"]["subsystems"]
    assert pitch["M"] == [["c", "f"], ["f", "d"]]
    assert pitch["K"] == [["3*(b - a)", "3*f"], ["3*f", "3*f"]]
    assert yaw["K"] == [["c - b", "0", "0"], ["0", "4*(c - a)", "4*f"], ["0", "4*f", "d + 3*f"]]
    pitch = found["stability"]["subsystems"][1]
    assert (pitch["variable"], pitch["characteristic_polynomial"][4]) == ("lam", "p1 - p2")
    assert ("gamma - p2", ">", "necessary") in [(x["formula"], x["relation"], x["place"]) for x in pitch["conditions"]]
    assert {check["outcome"] for check in found["checks"]} == {"exact"}
    few = json.loads(TARGETS["json"].render(analysis, (1, 4)))
    assert "energy" not in few
    assert "equilibrium" in few


def test_results_read_back_to_the_same_polynomials():
    analysis = analysis_of("ziegler-damped.yaml")
    found = json.loads(TARGETS["json"].render(analysis, (3,)))
    values = state_of(analysis, random.Random(2))
    names = {key: float(value) for key, value in values.items()} | {"sin": np.sin, "cos": np.cos}
    for text, formula in zip(found["equations"]["forcing"], analysis.equations.forcing, strict=True):
        assert close(eval(text, {}, names), exact(analysis, formula.polynomial, values))


# --- LaTeX ---


@needs_pdflatex
@pytest.mark.parametrize("name", ["satellite.yaml", "nasty"])
def test_latex_compiles_without_overfull_lines(name, tmp_path):
    analysis = analysis_of(name)
    log = compiled_latex(TARGETS["latex"].render(analysis, analysis.problems), tmp_path)
    if name != "nasty":
        assert "Overfull" not in log


def test_latex_is_balanced_and_says_its_conventions():
    analysis = analysis_of("satellite.yaml")
    text = TARGETS["latex"].render(analysis, analysis.problems)
    bare = re.sub(r"\\[{}]", "", text)
    assert bare.count("{") == bare.count("}")
    for begin in set(re.findall(r"\\begin\{(\w+)\}", text)):
        assert text.count(f"\\begin{{{begin}}}") == text.count(f"\\end{{{begin}}}")
    assert "Direction cosines are passive" in text
    assert r"q_{1}" in text
    assert r"\begin{pmatrix} c & f \\ f & d \end{pmatrix}" in text


def test_long_lines_are_broken_where_tex_reads_a_space():
    words = " ".join(f"x_{{{k}}} \\penalty0  + \\ " for k in range(5000))
    lines = broken(words).split("\n")
    assert max(map(len, lines)) <= LINE + 2
    assert all(line.strip() for line in lines)
    assert not any(line.endswith("\\") for line in lines)
    assert " ".join(lines) == words
    assert broken("% " + words) == "% " + words


def test_no_line_of_the_report_is_long():
    analysis = analysis_of("spatial-arm.yaml")
    text = TARGETS["latex"].render(analysis, (1, 2, 3, 7))
    assert max(map(len, text.split("\n"))) < 1000


EVERY_LOAD = """
mbsym: 1
name: Loads of all kinds
parameters: {m: positive, k: positive, c: positive, g: positive, L: positive, M: real, n: positive}
bodies:
  - name: sun
    attached to: 0
    connection point: [0, L, 0]
    mass: 0
  - name: cart
    attached to: sun
    connection point: [x, 0, 0]
    coordinates: [x]
    mass: m
  - name: bob
    attached to: cart
    rotation: {axes: [3], angles: [theta]}
    mass centre: [0, -L, 0]
    mass: m
loads:
  - uniform gravity: {vector: [0, -g, 0]}
  - newtonian gravity: {constant: n, centre: 0, about: sun, order: 2}
  - spring: {coordinate: x, stiffness: k + m, rest: L}
  - spring: {between: [{body: cart, point: [0, 0, 0]}, {body: 0, point: [0, 0, L]}], stiffness: k, length: L/2}
  - damper: {coordinate: theta, coefficient: c}
  - damper: {between: [{body: bob, point: [0, -L, 0]}, {body: 0, point: [0, 0, 0]}], coefficient: 2*c}
  - isotropic damper: {between: [{body: bob, point: [0, -L, 0]}, {body: 0, point: [0, 0, 0]}], coefficient: 2*c}
  - potential: -k*x**4
  - rayleigh: c*x_dot**4
  - generalized force: {x: -c*x_dot, theta: M}
  - force: {body: bob, point: [0, -L, 0], components: [k, 0, 0], axes: bob}
  - torque: {body: bob, components: [0, 0, M], axes: cart, reaction on: cart}
motion: {x: 0, theta: {value: L, rate: n}}
initial: {x: {position: 1/2, velocity: L}}
"""


def test_latex_lists_the_loads_and_the_given_motion(tmp_path):
    analysis = mbsym.loads(EVERY_LOAD)
    text = TARGETS["latex"].render(analysis, (2,))
    assert "\\allowbreak \\allowbreak" not in text
    for part in (
        r"Uniform gravity, $g = (0,\; \allowbreak -g,\; \allowbreak 0)$ in inertial axes: $U = \sum m\, g \cdot r_C$",
        r"with $\nu = n$, expanded to order 2 about the origin $O$ of \textit{sun}",
        r"Spring of $x$, stiffness $k + m$, rest at $L$: $U = -\frac{1}{2} (k + m) (x - L)^{2}$",
        r"Spring between the point $(0,\; \allowbreak 0,\; \allowbreak 0)$ of \textit{cart} and the point",
        r"natural length $\frac{L}{2}$: $U = -\frac{1}{2} k (d - \frac{L}{2})^{2}$",
        r"Damper of $\theta$, coefficient $c$: dissipation function $R = \frac{1}{2} c \dot{\theta}^{2}$",
        r"dissipation function $R = \frac{1}{2} 2 c \dot{d}^{2}$ with the distance $d$",
        r"dissipation function $R = \frac{1}{2} 2 c v^{2}$ with their relative velocity $v$",
        r"Potential: $-U = -k x^{4}$",
        r"Dissipation function: $R = c \dot{x}^{4}$",
        r"Generalised forces: $Q_{x} = -c \dot{x}$, $Q_{\theta} = M$",
        r"Force $(k,\; \allowbreak 0,\; \allowbreak 0)$ in the axes of \textit{bob}, at the point",
        r"at the point $(0,\; \allowbreak -L,\; \allowbreak 0)$ of \textit{bob}.",
        r"Torque $(0,\; \allowbreak 0,\; \allowbreak M)$ in the axes of \textit{cart}, on \textit{bob};",
        r"the opposite one on \textit{cart}.",
        r"\theta = L + n t",
        r"$x(0) = \frac{1}{2}$",
        r"$\dot{x}(0) = L$",
    ):
        assert part in text.replace("\n", " "), part
    if shutil.which("pdflatex") is not None:
        compiled_latex(text, tmp_path)


def test_long_conditions_are_shown_once():
    analysis = analysis_of("satellite.yaml")
    text = TARGETS["latex"].render(analysis, (6,)).replace("\n", " ")
    assert len(text) < 30_000
    assert re.search(r"\\longformula\[[^]]*\]\{\\text\{discriminant\} < 0\}", text)
    assert re.search(r"\\longformula\[[^]]*\]\{v_\{4\} < 0\}", text)
    assert r"\text{minor 3 of K} \colon\quad v_{0} < 0" in text
    assert "of the last" not in text
    unstable = json.loads(TARGETS["json"].render(analysis, (6,)))["stability"]["subsystems"][0]["cases"][-1]
    # v0 < 0 is that det K < 0, for which the case before stands (Kelvin-Chetaev).
    assert [item["listed"] for item in unstable["any_of"]] == ["v4", "v2", "discriminant"]
    assert {item["relation"] for item in unstable["any_of"]} == {"<"}


def test_what_was_shown_is_recognised_with_either_sign():
    ring = analysis_of("heavy-top.yaml").ring
    p = ring.context.gen(ring.index("parameter", "m")) - ring.context.gen(ring.index("parameter", "g"))
    shown = Shown()
    reverse = Message(REVERSED, label="a")
    shown.show(Statement(reverse, Formula(ring, p), ">"))
    # What is referred to is the polynomial that a stands for, -p.
    for label, stands, relation, wanted in [
        ("a", -p, ">", ">"), (reverse, p, ">=", "<="), ("b", p, ">", "<"), ("b", -p, "!=", "!="), ("b", 2 * p, "<", ">")
    ]:  # fmt: skip
        found = shown.reference(Statement(label, Formula(ring, stands), relation))
        assert found is not None
        named = "a" if label == reverse else label
        assert (found.label, found.under, found.relation, found.formula.polynomial) == (named, "a", wanted, -p)
    assert shown.reference(Statement("b", Formula(ring, p * p), ">")) is None
    assert shown.reference(Statement("b", None, ">")) is None


CART = """
mbsym: 1
name: Cart with a double pendulum
parameters: {M: positive, m1: positive, m2: positive, l1: positive, l2: positive, g: positive,
             c0: nonnegative, c1: nonnegative, c2: nonnegative, k: positive}
bodies:
  - {name: cart, attached to: 0, connection point: [x, 0, 0], mass: M, coordinates: [x]}
  - {name: rod 1, attached to: cart, rotation: {axes: [3], angles: [th1]}, mass centre: [0, -l1, 0], mass: m1}
  - name: rod 2
    attached to: rod 1
    connection point: [0, -l1, 0]
    rotation: {axes: [3], angles: [th2 - th1]}
    mass centre: [0, -l2, 0]
    mass: m2
    coordinates: [th2]
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
  - spring: {coordinate: x, stiffness: k}
  - damper: {coordinate: x, coefficient: c0}
  - rayleigh: c1*th1_dot**2/2 + c2*(th2_dot - th1_dot)**2/2
motion: {x: 0, th1: 0, th2: 0}
"""


def test_very_long_conditions_are_counted_and_are_in_the_other_files():
    analysis = mbsym.loads(CART)
    (part,) = analysis.stability.subsystems
    text = TARGETS["latex"].render(analysis, (6,)).replace("\n", " ")
    section = text.partition("{Problem 6. Stability}")[2].partition("\\section*{")[0]
    assert 5_000 < len(section) < 9_000
    found = json.loads(TARGETS["json"].render(analysis, (6,)))["stability"]
    where = {item["label"]: item["formula"] for item in found["subsystems"][0]["conditions"]}
    for label in ("Hurwitz minor 5", "Hurwitz minor 3"):
        (requirement,) = [r for r in part.theory.requirements if r.label == label]
        size = len(requirement.condition.polynomial)
        counted = re.search(
            rf"\\text{{{label}}} \\colon\\quad [^>]* > 0 \\quad\\penalty0 "
            r"\\text{\(written out (\d+) terms, of degree (\d+); ([a-z. ]+)\)}",
            text,
        )
        assert counted, label
        assert int(counted[1]) == size > LONGEST_CONDITION
        assert int(counted[2]) == requirement.condition.polynomial.total_degree()
        assert counted[3] == "in full in results.json"
        assert len(re.findall(" [+-] ", where[label])) > LONGEST_CONDITION
    # What the appendix refers to is all there: the same number at a point.
    values = state_of(analysis, random.Random(3))
    point = {key: arb(fmpq(v.numerator, v.denominator)) for key, v in values.items()}
    with precision(200):
        wanted = float(part.ring.evaluate(requirement.condition.polynomial, point))
    names = {key: float(value) for key, value in values.items()}
    assert close(eval(where["Hurwitz minor 3"].removesuffix(" > 0"), {}, names), wanted)
    assert r"a_{5} \colon\quad M" in text  # a short one is written
    assert r"Verdict: \textbf{depends on the parameters}; see the cases." in text
    assert "undecided" not in text


def test_parts_of_a_condition_have_names_of_their_own():
    """g f^2 > 0 is g > 0 and f != 0; a reference by name must say which."""
    ring = analysis_of("heavy-top.yaml").ring
    m, g = (ring.context.gen(ring.index("parameter", name)) for name in ("m", "g"))
    for label, opposite in (("a3", False), (Message(REVERSED, label="a3"), True)):
        whole = (m - g) * (m - 2 * g) ** 2
        condition = Condition("inequality", m - g, nonzero=(m - 2 * g,))
        required = Requirement(label, -whole if opposite else whole, condition)
        first, second = statements(ring, [required])
        assert (first.formula.polynomial, first.relation) == (m - g, ">")
        assert (second.formula.polynomial, second.relation) == (m - 2 * g, "!=")
        assert first.label == ("-(a3, without squares)" if opposite else "a3, without squares")
        assert second.label == "a3, squared factor"
    alone = Requirement("a3", m - g, Condition("inequality", m - g))
    assert [item.label for item in statements(ring, [alone])] == ["a3"]
    label = Message(PART, label=Message(OF_FACTOR, label="a3", number=2), part="squared factor")
    assert label == "a3 of factor 2, squared factor"
    assert in_latex(label_of(label)) == r"a_{3}^{(2)} \text{, squared factor}"


def test_a_number_stands_in_front_of_a_matrix():
    text = TARGETS["latex"].render(analysis_of("satellite.yaml"), (5,))
    assert r"3 \begin{pmatrix} b - a & f \\ f & f \end{pmatrix}" in text


# --- verdicts that depend on something ---

HOOP = """
mbsym: 1
name: Bead on a rotating hoop
parameters: {m: positive, g: positive, R: positive, Omega: positive, theta0: real}
prescribed: {psi: {rate: Omega}}
bodies:
  - name: hoop
    attached to: 0
    rotation: {axes: [2], angles: [psi]}
    mass: 0
  - name: bead
    attached to: hoop
    rotation: {axes: [3], angles: [theta]}
    coordinates: [theta]
    mass centre: [0, -R, 0]
    mass: m
loads: [uniform gravity: {vector: [0, -g, 0]}]
motion: {theta: theta0}
"""


def test_verdicts_presume_the_conditions_of_problem_4():
    analysis = mbsym.loads(HOOP)
    presumed = "provided the condition of the motion (problem 4) holds"
    assert f"Verdict, {presumed}: " in TARGETS["latex"].render(analysis, (4, 6)).replace("\n", " ")
    assert presumed in TARGETS["wolfram"].render(analysis, (6,))
    assert any(text.startswith(f"Verdict, {presumed}: ") for text in told(analysis, 6))
    assert "(problem 4) holds" not in TARGETS["latex"].render(analysis_of("heavy-top.yaml"), (4, 6))


def test_the_terminal_says_what_a_verdict_depends_on():
    lines = told(analysis_of("heavy-top.yaml"), 6)
    assert "Verdict: depends on the parameters; see the cases." in lines
    assert any(text.endswith("For the whole system: depends on the parameters.") for text in lines)
    never = mbsym.loads(HOOP.replace("theta: theta0}", "theta: 0}") + "assumptions: [R*Omega**2 > g]\n")
    assert any(re.fullmatch(r"  v0 = .*g.* > 0 \(never holds\)", text) for text in told(never, 6))


# --- no closed form ---


def test_without_closed_form_reports_give_the_reason_and_the_program(tmp_path):
    analysis = Analysis(analysis_of("satellite.yaml").system, terms=60)
    reason = analysis.stage(3).failure.reason
    texts = {name: target.render(analysis, analysis.problems) for name, target in TARGETS.items()}
    assert json.loads(texts["json"])["unavailable"]["equations"]["reason"] == reason
    assert reason in texts["latex"]
    # People are told the equations through quantities with a meaning, which need no closed form of the whole.
    assert "Angular acceleration of body 2" in texts["latex"]
    assert "f_{5} = -H_{3 ,1}" in texts["latex"]
    assert "dynamics[t_" in texts["wolfram"]
    model = loaded(texts["python"], tmp_path)
    assert model.mass_matrix(np.zeros(5), dict.fromkeys(model.PARAMETERS, 1.0)).shape == (5, 5)
    assert told(analysis, 3)[0].startswith(f"No result: {reason}")


# --- determinism ---

DIGESTS = """
import hashlib, sys
from test_reports import TARGETS, analysis_of
for name in ("satellite.yaml", "nasty"):
    analysis = analysis_of(name)
    for target in TARGETS.values():
        print(name, target.name, hashlib.sha256(target.render(analysis, analysis.problems).encode()).hexdigest())
"""


def test_reports_are_the_same_byte_for_byte():
    outputs = []
    for seed in ("0", "1"):
        environment = os.environ | {
            "PYTHONHASHSEED": seed,
            "PYTHONPATH": os.pathsep.join((str(Path(__file__).parent), str(Path(__file__).parents[1]))),
        }
        command = [sys.executable, "-c", DIGESTS]
        outputs.append(subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout)
    assert outputs[0] == outputs[1]
    assert outputs[0].count("\n") == 2 * len(TARGETS)
    analysis = analysis_of("satellite.yaml")
    digest = hashlib.sha256(TARGETS["json"].render(analysis, analysis.problems).encode()).hexdigest()
    assert f"satellite.yaml json {digest}" in outputs[0]


# --- Wolfram Language ---


@pytest.mark.parametrize("name", ["nasty", "ziegler-damped.yaml"])
def test_wolfram_reads_the_report_and_gets_the_same_numbers(name, mathics):
    from mbsym.formulas.wolfram import wolfram_names

    analysis = analysis_of(name)
    report = uncommented(TARGETS["wolfram"].render(analysis, analysis.problems))
    mathics.reset()
    mathics.evaluate(f"({report})")
    assert str(mathics.evaluate("Length[equations]")) == str(len(analysis.system.coordinates))
    assert str(mathics.evaluate("Head[equations[[1]]]")) == "System`Equal"

    # Coordinates that move uniformly, and numbers for the parameters: then everything evaluates to numbers.
    names = wolfram_names(analysis.ring)
    values = state_of(analysis, random.Random(3))
    given = [f"{names[key]} = {values[key]}" for key in analysis.system.parameter_names]
    for key in analysis.system.coordinates:
        given.append(f"{names[key]}[t_] := {values[key]} + (t - {values['t']})*{values[key + '_dot']}")
    mathics.reset()
    mathics.evaluate("; ".join([*given, f"t = {values['t']}"]))
    mathics.evaluate(f"({report})")

    def numbers(expression: str):
        text = str(mathics.evaluate(f"N[{expression}, 20]"))
        return np.array(json.loads(text.replace("{", "[").replace("}", "]")))

    def expected(formulas):
        return [exact(analysis, x.polynomial, values) for x in formulas]

    assert close(numbers("massMatrix"), [expected(row) for row in analysis.equations.mass_matrix])
    assert close(numbers("forcing"), expected(analysis.equations.forcing))
    assert close(
        numbers("{kineticEnergy, forceFunction}"),
        expected([analysis.energy.kinetic_energy, analysis.energy.force_function]),
    )
    if name != "nasty":
        assert close(numbers("linearK"), [expected(row) for row in analysis.linearisation.K])
    body = analysis.kinematics.bodies[-1]
    assert close(numbers(f'angularVelocity["{body.name}"]'), expected(body.angular_velocity))


def uncommented(text: str) -> str:
    return re.sub(r"\(\*.*?\*\)", "", text, flags=re.DOTALL).strip().rstrip(";")


def test_a_call_of_ndsolve_is_suggested_only_with_initial_conditions():
    assert "NDSolve" in TARGETS["wolfram"].render(analysis_of("heavy-top.yaml"), (3,)).split("*)", 1)[1]
    text = TARGETS["wolfram"].render(mbsym.loads(HOOP), (3,))
    assert "initialConditions = {};" in text
    assert "NDSolve" not in text


def test_cases_read_as_an_alternative():
    """A motion with K > 0 is stable and not gyroscopically stabilised "only": the second case is for the rest."""
    text = TARGETS["latex"].render(analysis_of("orbital-gyrostat.yaml"), (6,))
    order = [
        text.index(words)
        for words in (
            r"\textbf{stable} (Routh), if all of these hold:",
            r"Otherwise \textbf{gyroscopically stabilised only}, if all of these hold:",
            r"Otherwise \textbf{unstable} (Kelvin-Chetaev), if:",
        )
    ]
    assert order == sorted(order)
    assert "only} if" not in text


@pytest.mark.parametrize(
    ("numbers", "words"),
    [
        ("theta0: 0, Omega: sqrt(2)", r"decided by rigorous enclosures: \textbf{stable}"),
        (
            "theta0: 1/4, Omega: 1",
            r"At the given values of the parameters: \textbf{undecided}. The motion does not exist",
        ),
    ],
)
def test_what_is_undecided_is_not_decided_exactly(numbers, words):
    """The bead rests at the lowest point for Omega^2 < g/R; at any other angle only for one Omega."""
    text = TARGETS["latex"].render(mbsym.loads(HOOP + f"values: {{m: 1, g: 10, R: 1, {numbers}}}\n"), (6,))
    assert words in " ".join(text.split())
    assert "decided exactly" not in text
    rational = TARGETS["latex"].render(analysis_of("simple-pendulum.yaml"), (6,))
    assert r"At the given values of the parameters, decided exactly: \textbf{asymptotically stable}" in rational


def test_the_power_of_a_fraction_is_not_that_of_its_denominator():
    names = LatexNames(["a", "b"])
    ratio = Operation("/", Name("a"), Name("b"))
    assert expression(Operation("**", ratio, Number(Fraction(2))), names) == r"(\frac{a}{b})^{2}"
    assert expression(Operation("**", Number(Fraction(1, 3)), Name("a")), names) == r"(\frac{1}{3})^{a}"
    assert expression(Operation("**", Number(Fraction(1, 2)), Name("a")), names) == "0.5^{a}"


def test_every_velocity_has_an_initial_value():
    """A velocity that is left out is zero, as in simulations: in both reports."""
    analysis = analysis_of("spatial-arm.yaml")
    given = {item.coordinate for item in analysis.system.initial if item.velocity is None}
    assert given  # the system tests something
    text = TARGETS["wolfram"].render(analysis, (3,))
    (line,) = re.findall(r"^initialConditions = \{(.*)\};$", text, re.MULTILINE)
    left = [item.partition(" == ")[0] for item in line.split(", ")]
    assert left == [f"{name}{dot}[0]" for name in analysis.system.coordinates for dot in ("", "'")]
    latex = TARGETS["latex"].render(analysis, (2,))
    assert r"$s(0) = 0.4$, $\dot{s}(0) = 0$, $q_{4}(0)" in latex
    assert latex.count("(0) = ") == 2 * len(analysis.system.coordinates)


@pytest.mark.parametrize("name", ["spatial-arm.yaml", "satellite.yaml", "double-pendulum.yaml"])
def test_the_suggested_ndsolve_has_numbers_for_everything(name, mathics):
    """2 n numerical initial conditions; with them the equations hold accelerations alone, and so NDSolve can start."""
    from mbsym.formulas.wolfram import wolfram_names

    analysis = analysis_of(name)
    text = TARGETS["wolfram"].render(analysis, (3,))
    (rules,) = re.findall(r"NDSolve\[Join\[equations, initialConditions\] (.*), coordinates, \{t, 0, tEnd\}\]", text)
    mathics.reset()
    mathics.evaluate("t = 0")
    mathics.evaluate(f"({uncommented(text)})")
    n = len(analysis.system.coordinates)
    assert str(mathics.evaluate(f"starts = initialConditions {rules}; Length[starts]")) == str(2 * n)
    assert str(mathics.evaluate("Union[Map[NumericQ, Map[Last, starts]]]")) == "{System`True}"
    assert str(mathics.evaluate("Length[Union[Map[First, starts]]]")) == str(2 * n)
    names = wolfram_names(analysis.ring)
    accelerations = [f"{names[name]}''[0] -> {k}/7" for k, name in enumerate(analysis.system.coordinates, 1)]
    mathics.evaluate("at = Map[(First[#] -> Last[#])&, starts]")
    # All at once: else Mathics puts long formulas with letters in order, three times over.
    operator, _, suggested = rules.partition(" ")
    mathics.evaluate(f"filled = equations {operator} Join[{suggested}, at, {{{', '.join(accelerations)}}}]")
    # Sides that hold nothing but numbers are compared: such an equation is True or False.
    found = str(mathics.evaluate("Union[filled]"))
    assert set(found.strip("{}").split(",")) <= {"System`True", "System`False"}, found


def test_what_ndsolve_lacks_is_told():
    text = TARGETS["wolfram"].render(mbsym.loads(HOOP + "initial: {theta: 0.5}\n"), (3,))
    assert "NDSolve needs numbers for: " in text
    assert "NDSolve[" not in text


# --- not even a program ---

STRANGE = """
mbsym: 1
name: A power that no algebra has
parameters: {m: positive, l: positive}
bodies:
  - name: bob
    attached to: 0
    rotation: {axes: [3], angles: [theta]}
    mass centre: [l, 0, 0]
    mass: m**(1/3)
motion: {theta: 0}
"""


def test_without_any_code_reports_say_why(tmp_path):
    analysis = mbsym.loads(STRANGE)
    texts = {name: target.render(analysis, analysis.problems) for name, target in TARGETS.items()}
    assert "There is no code for the equations of motion: the power 1/3" in texts["python"]
    assert not hasattr(loaded(texts["python"], tmp_path), "mass_matrix")
    assert "the power 1/3" in texts["latex"]
    assert "the power 1/3" in texts["wolfram"]
    assert "the power 1/3" in json.loads(texts["json"])["unavailable"]["equations"]["reason"]


def test_an_alternative_is_one_inequality() -> None:
    """p > 0 and f != 0 together are p f^2 > 0, whatever the sign of f; where there is no other they are told as two."""
    ring = analysis_of("heavy-top.yaml").ring
    p, f, q = (ring.context.gen(ring.index("parameter", name)) for name in ("m", "g", "l"))
    required = Requirement("a", p * f**2, Condition("inequality", p, nonzero=(f,)))
    other = Requirement("b", q, Condition("inequality", q))

    def told(*any_of: Requirement) -> list[list[tuple[object, str]]]:
        theory = SimpleNamespace(cases=[Case((), any_of, Verdict("unstable"))], requirements=(), uncovered=False)
        (one,) = cases(SimpleNamespace(ring=ring, theory=theory))
        return [[(x.formula.polynomial, x.relation) for x in some] for some in (one.all_of, one.any_of)]

    assert told(required, other) == [[], [(p * f**2, ">"), (q, ">")]]
    assert told(required) == [[(p, ">"), (f, "!=")], []]
    without = Requirement("c", p, Condition("inequality", p))
    assert told(required, other, without) == [[], [(q, ">"), (p, ">")]]  # which p f^2 > 0 implies


def test_a_short_formula_of_many_terms_is_counted() -> None:
    ring = analysis_of("heavy-top.yaml").ring
    total = ring.one
    for name in ("m", "g", "l", "A"):
        total = total + ring.context.gen(ring.index("parameter", name))
    assert in_latex(Readable(Formula(ring, total**20))).startswith(rf"\text{{({comb(24, 4)} terms, of degree 20;")
    assert "degree" not in in_latex(Readable(Formula(ring, total)))
