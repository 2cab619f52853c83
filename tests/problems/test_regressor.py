"""Base parameters and regressor: sums by hand, numbers as published, Y beta = inverse dynamics identically."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import jsonschema
import numpy as np
import pytest
from conftest import SHIPPED, invoked

import mbsym
from mbsym.algebra.failures import Failure, Limit, NoClosedForm
from mbsym.analysis import Analysis
from mbsym.mechanics.articulation import articulation
from mbsym.mechanics.loads.kinds import base_acceleration
from mbsym.mechanics.newton_euler import Accelerations, residuals
from mbsym.mechanics.regressor import KINDS, Standard, column
from mbsym.problems import regressor as problem
from mbsym.problems.regressor import regressor
from mbsym.report.regressor_files import regressor_latex, sum_of
from mbsym.report.schemas import schema

#: Rows of modified Denavit-Hartenberg parameters, alpha (quarter turns), d, r, and R or P.
Rows = list[tuple[int, str, str, str]]

PUMA: Rows = [
    (0, "0", "0", "R"), (-1, "0", "0", "R"), (0, "a2", "d3", "R"), (-1, "a3", "d4", "R"), (1, "0", "0", "R"),
    (-1, "0", "0", "R"),
]  # fmt: skip
RX90: Rows = [
    (0, "0", "0", "R"), (1, "0", "0", "R"), (0, "D3", "0", "R"), (-1, "0", "RL4", "R"), (1, "0", "0", "R"),
    (-1, "0", "0", "R"),
]  # fmt: skip
UR5: Rows = [
    (0, "0", "d1", "R"), (1, "0", "0", "R"), (0, "a2", "0", "R"), (0, "a3", "d4", "R"), (1, "0", "d5", "R"),
    (-1, "0", "d6", "R"),
]  # fmt: skip
SCARA: Rows = [(0, "0", "0", "R"), (0, "l1", "0", "R"), (0, "l2", "0", "R"), (0, "0", "0", "P")]
ELBOW: Rows = [(0, "0", "0", "R"), (1, "0", "0", "R"), (0, "l2", "0", "R")]


def arm(rows: Rows, gravity: str = "[0, 0, -g]", rotors: bool = False) -> Analysis:
    """Links L1, L2, ... with ten parameters as they come; the mass centre has any place."""
    lengths = sorted({word for _, d, r, _ in rows for word in (d, r)} - {"0"})
    parameters = ["g", *lengths, *(f"{kind}{k}" for k in range(1, len(rows) + 1) for kind in (*KINDS[:6], "m", "I"))]
    lines = ["mbsym: 1", "name: arm", f"parameters: [{', '.join(parameters)}]", "bodies:"]
    for k, (quarter, d, r, kind) in enumerate(rows, start=1):
        s, c = (quarter, 0) if quarter else (0, 1)
        along = r if kind == "R" else f"({r} + q{k})"
        turns = [(1, f"{quarter}*pi/2")] * bool(quarter) + [(3, f"q{k}")] * (kind == "R")
        axes, angles = [str(axis) for axis, _ in turns], [angle for _, angle in turns]
        tensor = "[{0}xx{k}, {0}xy{k}, {0}xz{k}], [{0}xy{k}, {0}yy{k}, {0}yz{k}], [{0}xz{k}, {0}yz{k}, {0}zz{k}]"
        lines += [
            f"  - name: L{k}",
            f"    attached to: {f'L{k - 1}' if k > 1 else 0}",
            f"    connection point: [{d}, -({s})*{along}, ({c})*{along}]",
            f"    rotation: {{axes: [{', '.join(axes)}], angles: [{', '.join(angles)}]}}" if turns else "",
            f"    coordinates: [q{k}]",
            "    mass centre: [1, 1/2, 1/3]",
            f"    mass: m{k}",
            "    inertia about: mass centre",
            f"    inertia: {{tensor: [{tensor.format('J', k=k)}], accept: true}}",
        ]
        if rotors:
            turn = f"{{axes: [3], angles: [q{k}]}}"
            lines += [f"  - {{name: rotor {k}, attached to: 0, rotation: {turn}, mass: 0, inertia about: mass centre,"]
            lines += [f"     inertia: {{tensor: [0, 0, I{k}], accept: true}}}}"]
    lines += ["loads:", f"  - uniform gravity: {{vector: {gravity}}}"]
    return mbsym.loads("\n".join(lines), problems=())


def energies(scene: Any) -> Iterator[tuple[Standard, Any, Any]]:
    """What one unit of each parameter adds to T and to U: m V.V/2 + h.(V x w) + w.J w/2, m g.r + h.g."""
    ring, down = scene.algebra, scene.zero("0") - base_acceleration(scene)
    for name, motion in scene.motions.items():
        velocity, spin = motion.velocity_origin, motion.angular_velocity
        lever, weight = velocity.cross(spin), scene.to_axes(down, name)
        for k, kind in enumerate(KINDS[:6]):
            i, j = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))[k]
            yield Standard(name, kind), spin[i] * spin[j] / (2 if i == j else 1), ring.zero
        for k in range(3):
            yield Standard(name, KINDS[6 + k]), lever[k], weight[k]
        yield Standard(name, "m"), velocity.dot(velocity) / 2, scene.position(scene.zero(name), "0").dot(down)


def test_the_planar_arm_by_hand() -> None:
    """Both axes horizontal.  With p = q1 + q2:  2 T = (J1 + l^2 m2) q1'^2 + J2 p'^2 + 2 l q1' p' (hx2 c2 - hy2 s2),
    U = -g ((hx1 + l m2) s1 + hy1 c1 + hx2 sin p + hy2 cos p), so six sums in all: Khalil and Dombre's, example 9.1.
    """
    found = regressor(arm([(0, "0", "0", "R"), (0, "l", "0", "R")], gravity="[0, -g, 0]").scene)
    assert [sum_of(one) for one in found.base] == [
        "Jzz(L1) + l**2*m(L2)", "hx(L1) + l*m(L2)", "hy(L1)", "Jzz(L2)", "hx(L2)", "hy(L2)",
    ]  # fmt: skip
    assert len(found.without_effect) == 13
    assert not found.besides


@pytest.mark.parametrize(
    ("rows", "gravity", "rotors", "number"),
    [
        # Mayeda, Yoshida and Osuka (1990): 7 N - 4 b, b the number of joints parallel to the first one from the base
        # on, and 2 less where gravity is parallel to these; successive axes parallel or at right angles.
        (PUMA, "[0, 0, -g]", False, 36),
        (UR5, "[0, 0, -g]", False, 36),
        (PUMA, "[-g, 0, 0]", False, 38),
        ([(0, "0", "0", "R"), (0, "l1", "0", "R"), (0, "l2", "0", "R")], "[0, -g, 0]", False, 9),
        (ELBOW, "[0, 0, -g]", False, 15),
        # Khalil and Dombre (2002), chapter 9: the RX-90 has 40 with the inertias of rotors 3 to 6, those of 1 and 2
        # being parts of Jzz of their links.
        (RX90, "[0, 0, -g]", False, 36),
        (RX90, "[0, 0, -g]", True, 40),
        # Three vertical axes feel Jzz, hx, hy each but hx, hy of the first; the slide feels the last mass.
        (SCARA, "[0, 0, -g]", False, 8),
        # Mayeda's 2 less: with vertical axes hx, hy of the first link of the planar arm are without effect.
        ([(0, "0", "0", "R"), (0, "l", "0", "R")], "[0, 0, -g]", False, 4),
    ],
)
def test_their_number_is_the_published_one(rows: Rows, gravity: str, rotors: bool, number: int) -> None:
    found = regressor(arm(rows, gravity, rotors).scene)
    assert len(found.base) == number


@pytest.mark.parametrize("rows", [ELBOW, SCARA, PUMA, UR5])
def test_base_parameters_are_all_of_the_energies_identically(rows: Rows) -> None:
    """T and U of the bodies (problem 2's) are sums of the kept functions times the values of the sums, in the ring.

    As Lagrange's equations are linear in L this makes Y beta the inverse dynamics, identically.
    """
    analysis = arm(rows)
    found, ring = regressor(analysis.scene), analysis.ring
    functions = {one: (t, u) for one, t, u in energies(analysis.scene)}
    kinetic, force = analysis.energy.kinetic_energy.polynomial, analysis.energy.force_function.polynomial
    for one in found.base:
        t, u = functions[one.parameter]
        kinetic = ring.reduce(kinetic - ring.times(one.value.polynomial, t))
        force = ring.reduce(force - ring.times(one.value.polynomial, u))
    assert kinetic == 0
    assert not any(analysis.ring.depends_on(force, name) for name in analysis.system.coordinates)


@pytest.mark.parametrize("rows", [ELBOW, SCARA])
def test_the_regressor_times_base_parameters_is_the_inverse_dynamics_identically(rows: Rows) -> None:
    """Column by column over the ring, against the recursion that computes equations of motion."""
    analysis = arm(rows)
    scene, ring, found = analysis.scene, analysis.ring, regressor(analysis.scene)
    moving = Accelerations(scene)
    left = [residuals(scene)[name] for name in analysis.system.coordinates]
    for one in found.base:
        for i, y in enumerate(column(scene, moving, one.parameter)):
            left[i] = ring.reduce(left[i] - ring.times(one.value.polynomial, ring.reduce(y)))
    assert left == [0] * len(left)


@pytest.mark.parametrize("rows", [PUMA, RX90, UR5])
def test_six_joints_at_random_states(rows: Rows) -> None:
    """The generated module's Y times its base parameters, against M q'' - f of model.py: 1e-13 of the largest."""
    analysis = arm(rows)
    source = np.random.default_rng(7)
    p = {name: float(source.uniform(0.5, 2)) for name in analysis.system.parameter_names}
    model, own = generated(analysis)
    for _ in range(3):
        q, qd, qdd = source.normal(size=(3, 6))
        wanted = model.inverse_dynamics(q, qd, qdd, p)
        tau = own.regressor(q, qd, qdd, p) @ own.base_parameters(p)
        assert np.abs(tau - wanted).max() <= 1e-13 * np.abs(wanted).max()
    assert own.regressor(*source.normal(size=(3, 6, 2)), p).shape == (6, 36, 2)


def generated(analysis: Analysis) -> tuple[Any, Any]:
    """model.py and regressor.py, as modules."""
    from mbsym.report.regressor_files import regressor_module
    from mbsym.report.targets import FORMATS

    model, own = ModuleType("model"), ModuleType("regressor")
    exec(str(FORMATS["python"].render(analysis, ())), model.__dict__)  # our own generated modules
    exec(regressor_module(regressor(analysis.scene)), own.__dict__)
    return model, own


def test_a_wrong_function_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """A mass that is moved to the base with the wrong sign is in wrong sums, and these do not make the forces."""
    right = problem.regrouped

    def wrong(frames: Any) -> Any:
        found = right(frames)
        return found | {Standard("L3", "m"): {slot: -x for slot, x in found[Standard("L3", "m")].items()}}

    monkeypatch.setattr(problem, "regrouped", wrong)
    analysis = arm(ELBOW)
    _, own = generated(analysis)
    model, _ = generated(analysis)
    p = dict.fromkeys(analysis.system.parameter_names, 1.0) | {"l2": 0.7}
    q, qd, qdd = np.random.default_rng(1).normal(size=(3, 3))
    tau = own.regressor(q, qd, qdd, p) @ own.base_parameters(p)
    assert np.abs(tau - model.inverse_dynamics(q, qd, qdd, p)).max() > 1e-3


@pytest.mark.parametrize("rows", [ELBOW, RX90])
def test_what_is_too_long_for_the_ring_is_proved_in_balls(rows: Rows, monkeypatch: pytest.MonkeyPatch) -> None:
    """As if only the first two links' formulas had room: the same sums; with a bound of none of them it refuses."""
    analysis = arm(rows)
    wanted = [sum_of(one) for one in regressor(analysis.scene).base]
    right, asked = problem.Energies.of, []

    def short(self: Any, slot: tuple[int, str]) -> Any:
        asked.append(slot)
        if slot[0] > 2 and self.algebra is analysis.ring:
            raise NoClosedForm("too long", limit=Limit.TERMS)
        return right(self, slot)

    monkeypatch.setattr(problem.Energies, "of", short)
    assert [sum_of(one) for one in regressor(analysis.scene).base] == wanted
    assert asked
    monkeypatch.setattr(problem, "MOST_PROVED", 3)
    with pytest.raises(NoClosedForm, match="too long to find"):
        regressor(analysis.scene)


def test_functions_that_depend_on_each_other_are_not_proved_independent() -> None:
    """Jzz of the first link and the inertia of its rotor are one function, q1'^2/2."""
    analysis = arm(ELBOW, rotors=True)
    frames = articulation(analysis.scene)
    first = [(frames.frame_of["L1"], "Jzz"), (frames.frame_of["rotor 1"], "Jzz")]
    with pytest.raises(NoClosedForm):
        problem._independent(frames, analysis.system, first)
    problem._independent(frames, analysis.system, [first[0], (frames.frame_of["rotor 3"], "Jzz")])


def test_turned_axes_give_quotients_and_roots() -> None:
    """A second axis at the angle pi/4 to the first (K&D's general rules, (9.51)): Jyy goes to the first link's Jzz.

    For a turn about axis 3 with alpha between the axes, of the columns of Jxx + Jyy of link 2:
    w1^2 + w2^2 = sin(alpha)^2 q1'^2, so Jxx2 and Jyy2 enter as Jxx2 - Jyy2 and sin(alpha)^2 Jyy2 + Jzz1.
    """
    text = """
mbsym: 1
name: tilted
parameters: {g: positive, a: positive}
bodies:
  - {name: one, attached to: 0, rotation: {axes: [3], angles: [q1]}, mass: 1, inertia about: joint, inertia: [1, 1, 1]}
  - {name: two, attached to: one, rotation: {axes: [1, 3], angles: [ALPHA, q2]}, mass: 1, inertia about: joint,
     inertia: [1, 1, 1]}
loads: [{uniform gravity: {vector: [0, 0, -g]}}]
"""
    for alpha, square in (("pi/4", "1/2"), ("pi/3", "3/4")):
        found = regressor(mbsym.loads(text.replace("ALPHA", alpha), problems=()).scene)
        told = {one.parameter: sum_of(one) for one in found.base}
        assert told[Standard("one", "Jzz")].startswith(f"Jzz(one) + {square}*Jyy(two)")
        assert told[Standard("two", "Jxx")].startswith("Jxx(two) - Jyy(two)")
    found = regressor(mbsym.loads(text.replace("ALPHA", "a"), problems=()).scene)
    factor = dict(found.base[0].others)[Standard("two", "Jyy")]
    assert factor.to_sympy().subs({"a": 1.1}).evalf() == pytest.approx(np.sin(1.1) ** 2)


@pytest.mark.parametrize(
    ("file", "reason"),
    [
        ("shaken-pendulum.yaml", "moves as prescribed"),
        ("gravity-gradient.yaml", "base parameters"),
    ],
)
def test_what_is_refused(file: str, reason: str) -> None:
    with pytest.raises(Failure, match=reason):
        regressor(mbsym.load(SHIPPED / file, problems=()).scene)
    done = invoked("regressor", SHIPPED / file)
    assert done.exit_code in (1, 2)
    assert "Traceback" not in done.output


def test_the_command_writes_what_its_schema_says(tmp_path: Path) -> None:
    out = tmp_path / "out"
    done = invoked("regressor", SHIPPED / "double-pendulum.yaml", "--out", out, code=0)
    assert "6 of 20 parameters" in done.stdout
    data = json.loads((out / "regressor.json").read_text(encoding="utf-8"))
    jsonschema.validate(data, schema("regressor"))
    assert data["base"][0] == {
        "body": "first rod", "kind": "Jzz", "value": data["base"][0]["value"],
        "others": [{"body": "second rod", "kind": "m", "coefficient": "l1**2"}],
    }  # fmt: skip
    assert len(data["without_effect"]) == 13
    tex = (out / "regressor.tex").read_text(encoding="utf-8")
    assert r"\beta_{3} &= h_{1,y} + \left(-l_{1}\right) m_{2} \\" in tex
    own = ModuleType("regressor")
    exec((out / "regressor.py").read_text(encoding="utf-8"), own.__dict__)
    with pytest.raises(ValueError, match="no value for the parameters l1, g"):
        own.regressor([0, 0], [0, 0], [0, 0], {})
    again = mbsym.regressor(SHIPPED / "double-pendulum.yaml")
    assert [sum_of(one) for one in again.base][2] == "hy(first rod) - l1*m(second rod)"


PARALLELOGRAM = """
mbsym: 1
name: parallelogram in gravity
parameters: {l: 2, s: 1, m: 3, g: 9.81}
bodies:
  - {name: crank, attached to: 0, rotation: {axes: [3], angles: [a]}, mass centre: [s/2, 0, 0], mass: m,
     inertia about: mass centre, inertia: [0, m*s**2/12, m*s**2/12]}
  - {name: coupler, attached to: crank, connection point: [s, 0, 0], rotation: {axes: [3], angles: [b]},
     mass centre: [l/2, 0, 0], mass: m, inertia about: mass centre, inertia: [0, m*l**2/12, m*l**2/12]}
  - {name: rocker, attached to: 0, connection point: [l, 0, 0], rotation: {axes: [3], angles: [c]},
     mass centre: [s/2, 0, 0], mass: m, inertia about: mass centre, inertia: [0, m*s**2/12, m*s**2/12]}
loads: [{uniform gravity: {vector: [0, -g, 0]}}]
constraints:
  - coincide: [{body: coupler, point: [l, 0, 0]}, {body: rocker, point: [s, 0, 0]}]
dependent: [b, c]
"""


@pytest.mark.parametrize("speeds", [False, True])
def test_reactions_of_a_loop_fall_out_of_its_regressor(tmp_path: Path, speeds: bool) -> None:
    """The coupler of a parallelogram does not turn: N = (1, -1, 1), N^T Y base = 5/3 m s^2 a'' + 2 m g s cos(a)."""
    text = PARALLELOGRAM
    if speeds:
        text = text.replace("angles: [c]}", "angles: [c]}, speeds: {w: c_dot}").replace("[b, c]", "[b, w]")
    path = tmp_path / "loop.yaml"
    path.write_text(text, encoding="utf-8")
    done = invoked("regressor", path, "--out", tmp_path, code=0)
    assert "tau + J^T lambda = Y base" in done.stdout
    assert json.loads((tmp_path / "regressor.json").read_text(encoding="utf-8"))["constraints"] is True
    own = ModuleType("regressor")
    exec((tmp_path / "regressor.py").read_text(encoding="utf-8"), own.__dict__)
    m, s, g, n = 3.0, 1.0, 9.81, np.array([1.0, -1.0, 1.0])
    base = own.base_parameters({"l": 2, "s": s, "m": m, "g": g})
    for a, rate, second in np.random.default_rng(3).normal(size=(5, 3)):
        Y = own.regressor(n * a, n * rate, n * second, {"l": 2, "s": s, "m": m, "g": g})
        assert n @ Y @ base == pytest.approx(5 / 3 * m * s**2 * second + 2 * m * g * s * np.cos(a), rel=1e-12)


def test_numbers_are_told_as_they_are_typed() -> None:
    """Two links, the second at a from the first: J + a^2 m and h + a m (Khalil & Dombre), a = 0.2717 and 1/3."""
    text = """
mbsym: 1
name: arm
bodies:
  - {name: a, rotation: {axes: [3], angles: [p]}, mass centre: [0.1, 0, 0], mass: 1}
  - {name: b, attached to: a, connection point: [LENGTH, 0, 0], rotation: {axes: [3], angles: [q]},
     mass centre: [1, 0, 0], mass: 1}
loads: [{uniform gravity: {vector: [0, -9.81, 0]}}]
"""
    typed = regressor(mbsym.loads(text.replace("LENGTH", "0.2717")).scene)
    assert [sum_of(one) for one in typed.base][:2] == ["Jzz(a) + 0.07382089*m(b)", "hx(a) + 0.2717*m(b)"]
    assert "0.2717" in regressor_latex(typed)
    third = regressor(mbsym.loads(text.replace("LENGTH", "1/3")).scene)
    assert [sum_of(one) for one in third.base][:2] == ["Jzz(a) + 1/9*m(b)", "hx(a) + 1/3*m(b)"]
