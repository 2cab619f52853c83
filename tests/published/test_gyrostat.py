"""The gyrostatic moment of a body, and two bodies about a fixed point: the gyrostat in a Newtonian field (Amer, Amer &
Galal) and the problem of Clebsch, Tisserand and Brun, each against an independent derivation."""

from __future__ import annotations

import random
from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import pytest
import sympy
from conftest import SHIPPED, Exact, at_values, precision, reference, system_of, with_values
from flint import arb, fmpq, fmpq_poly
from test_self_check import Mistake, plant

import mbsym
from mbsym.algebra.base import Lowering, Scalar
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.point import Balls, Rationals
from mbsym.analysis import Analysis
from mbsym.mechanics.oracle import Oracle, State
from mbsym.mechanics.programs import accelerated
from mbsym.model.system import System
from mbsym.problems.stability.words import Word
from mbsym.source import read, to_text, to_yaml

GYROSTAT, CLEBSCH = SHIPPED / "gyrostat.yaml", SHIPPED / "clebsch.yaml"
REFERENCE = reference("gyrostat")
BRUN = reference("orbit-gyrostat-and-clebsch")["clebsch"]
TRAJECTORIES = [name for name in REFERENCE if "initial" in REFERENCE[name]]

TWO_GYROSTATS = """
mbsym: 1
name: Two gyrostats on a carriage
parameters: [A, B, C, E, m, l, h1, h2, h3, k, Omega, g]
prescribed: {chi: Omega}
bodies:
  - name: carriage
    attached to: 0
    rotation: {axes: [2], angles: [chi]}
    connection point: [x, 0, 0]
    mass: m
    coordinates: [x]
    gyrostatic moment: [0, h2, h1]
  - name: first
    attached to: carriage
    rotation: {axes: [3, 1, 3], angles: [psi, theta, phi]}
    mass: m
    mass centre: [0, l, l]
    inertia about: joint
    inertia: [[A, E, 0], [E, B, 0], [0, 0, C]]
    gyrostatic moment: [h1, h2, h3]
  - name: second
    attached to: first
    rotation: {axes: [1], angles: [beta]}
    connection point: [l, 0, 0]
    mass: m
    inertia about: mass centre
    inertia: [A, B, C]
    gyrostatic moment: [0, -h3, 2*h1]
loads:
  - uniform gravity: {vector: [0, 0, -g]}
  - spring: {coordinate: x, stiffness: k}
"""


# --- the gyrostatic moment ---


@pytest.mark.parametrize("text", [TWO_GYROSTATS, *(path.read_text(encoding="utf-8") for path in (GYROSTAT, CLEBSCH))])
def test_both_spellings_keep_it(text: str) -> None:
    system = system_of(text, "x.yaml")
    assert system_of(to_yaml(system), "x.yaml") == system
    assert system_of(to_text(system), "x.txt") == system


def test_zero_is_no_gyrostatic_moment() -> None:
    text = GYROSTAT.read_text(encoding="utf-8")
    without = text.replace("    gyrostatic moment: [lx, 0, lz]\n", "")
    zero = text.replace("gyrostatic moment: [lx, 0, lz]", "gyrostatic momentum: [0, 0, 0.0]")
    assert system_of(zero, "x.yaml").bodies == system_of(without, "x.yaml").bodies
    assert system_of(text, "x.yaml").bodies != system_of(without, "x.yaml").bodies


@pytest.mark.parametrize(
    ("moment", "code"),
    [
        ("[theta, 0, 0]", "misplaced-name"),
        ("[lx, 0]", "wrong-shape"),
        ("[ly, 0, 0]", "unknown-name"),
        ("lx", "wrong-shape"),
    ],
)
def test_a_bad_gyrostatic_moment_is_refused(moment: str, code: str) -> None:
    text = GYROSTAT.read_text(encoding="utf-8").replace("moment: [lx, 0, lz]", f"moment: {moment}")
    system, complaints = read(text, "x.yaml")
    assert system is None
    line = next(number for number, line in enumerate(text.splitlines(), 1) if "gyrostatic moment: " in line)
    errors = [item for item in complaints.errors if item.span is not None and item.span.line == line]
    assert [item.code for item in errors] == [code]


def test_the_self_check_knows_it() -> None:
    a = mbsym.loads(TWO_GYROSTATS, (1, 2, 3))
    assert {check.outcome for check in a.checks} == {"exact"}


MISTAKES = [
    Mistake(
        "the sign of the moment in the recursion",
        "mechanics.newton_euler:_inertia_wrench",
        "spin.cross(motion.gyrostatic_moment)",
        "motion.gyrostatic_moment.cross(spin)",
        "",
        ("straight-line program",),
    ),
    Mistake(
        "twice the term in the energy",
        "mechanics.energy:gyrostatic_term",
        "total + motion",
        "total + algebra.number(2) * motion",
        "",
        ("energy", "equations of motion"),
    ),
    Mistake(
        "the oracle's moment does not turn",
        "mechanics.oracle:Placement.gyrostatic_moment",
        "return self.direction(body.name, self.lower.vector(body.gyrostatic_moment))",
        "return list(self.lower.vector(body.gyrostatic_moment))",
        "",
        ("equations of motion", "straight-line program"),
    ),
]


@pytest.mark.parametrize("mistake", MISTAKES, ids=lambda mistake: mistake.what)
def test_a_mistake_about_it_is_caught(monkeypatch: pytest.MonkeyPatch, mistake: Mistake) -> None:
    plant(monkeypatch, mistake)
    a = mbsym.loads(TWO_GYROSTATS, (1, 2, 3))
    assert {check.name for check in a.checks if check.failed} >= set(mistake.caught)


ROTOR = """
mbsym: 1
name: Rotor in a body
parameters: [A, B, C, E, Jt, Ja, H, m, l, g]
bodies:
  - name: body
    attached to: 0
    rotation: {axes: [3, 1, 2], angles: [psi, theta, phi]}
    mass: m
    mass centre: [0, l, l]
    inertia about: joint
    inertia: [[A, E, 0], [E, B, 0], [0, 0, C]]
  - name: rotor
    attached to: body
    rotation: {axes: [1], angles: [sigma]}
    mass: 0
    inertia about: joint
    inertia: [Ja, Jt, Jt]
loads:
  - uniform gravity: {vector: [0, 0, -g]}
"""


def test_it_is_what_a_freely_turning_rotor_leaves_behind() -> None:
    """With the rotor's momentum Ja (p + sigma') = H the body moves as a gyrostat whose tensor lacks Ja (Routh)."""
    rotor = mbsym.loads(ROTOR)
    start, end = ROTOR.index("  - name: rotor"), ROTOR.index("loads:")
    text = ROTOR[:start].replace("[[A, E, 0], [E, B, 0], [0, 0, C]]", "[[A, E, 0], [E, B + Jt, 0], [0, 0, C + Jt]]")
    gyrostat = mbsym.loads(text + "    gyrostatic moment: [H, 0, 0]\n" + ROTOR[end:])
    for seed in range(3):
        state = random_state(rotor, seed)
        spin = body_spin(rotor.system, "body", state)[0]
        momentum = state.values["Ja"] * (spin[0] + state.values["sigma_dot"])
        here = State(state.numbers, {**state.values, "H": momentum})
        full = accelerated(rotor.system, here, rotor.programs)
        reduced = accelerated(gyrostat.system, here, gyrostat.programs)
        for name in ("psi", "theta", "phi"):
            assert full.values[f"{name}_ddot"] == reduced.values[f"{name}_ddot"]
        kept = evaluated(gyrostat, here, gyrostat.integrals[0].formula)
        whole = evaluated(rotor, here, rotor.integrals[0].formula)
        assert [item.integrals[0].kind for item in (gyrostat, rotor)] == ["generalised energy"] * 2
        assert whole - kept == momentum**2 / (2 * state.values["Ja"])


def test_the_energy_has_no_term_of_it() -> None:
    a = mbsym.load(GYROSTAT)
    energy = a.integrals[0]
    assert energy.kind == "generalised energy"
    degrees = energy.formula.polynomial.degrees()
    assert all(degrees[a.ring.index("parameter", name)] == 0 for name in ("lx", "lz"))
    assert degrees[a.ring.index("parameter", "A")] == 1
    linear = [str(x) for x in a.energy.A1]
    assert linear == ["lx*sin(theta)*sin(phi) + lz*cos(theta)", "lx*cos(phi)", "lz"]
    program = a.programs
    state = random_state(a, 1)
    value = program.program.evaluate([program.energy], state.values, state.numbers)[0]
    assert value == evaluated(a, state, energy.formula)


# --- states ---


def random_state(a: Analysis, seed: int) -> State:
    source = random.Random(seed)
    values: dict[str, Scalar] = {name: fmpq(source.randint(1, 30), source.randint(1, 20)) for name in a.ring.names()}
    values |= {"pi": fmpq(355, 113), "t": fmpq(0)}
    tangents = {name: fmpq(source.randint(1, 9), source.randint(10, 19)) for name in a.ring.angles}
    return State(Rationals(tangents, a.ring.angles), values)


def body_spin(system: System, body: str, state: State) -> tuple[list[Any], list[Any], list[Any]]:
    """omega, its rate and the third axis of space, in the axes of a body."""
    place = Oracle(system, state).moving
    axes = [[x.a for x in row] for row in place.axes[body]]
    found = [[sum(axes[k][i] * v[k] for k in range(3)) for i in range(3)] for v in place.spin(body)]
    return found[0], found[1], axes[2]


def evaluated(a: Analysis, state: State, formula: Any) -> Any:
    return Carrier(a.ring, state.numbers, state.values)(formula.polynomial)


def cross(u: Any, v: Any) -> list[Any]:
    return [u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3] for i in range(3)]


def euler_equations(v: Mapping[str, Any], spin: Any, rate: Any, vertical: Any, sign: int = 1) -> list[Any]:
    """Equations (2) of the paper; ``sign`` -1 is what the moment printed in (1) would give."""
    inertia = [v["A"], v["B"], v["C"]]
    momentum = [j * w for j, w in zip(inertia, spin, strict=True)]
    internal = [v["lx"], v["lz"] * 0, v["lz"]]
    total = [a + b for a, b in zip(momentum, internal, strict=True)]
    lever = cross([v["x0"], v["y0"], v["z0"]], vertical)
    field = cross(vertical, [j * g for j, g in zip(inertia, vertical, strict=True)])
    n = 3 * v["g"] / v["R"]
    turned = cross(spin, total)
    return [inertia[i] * rate[i] + turned[i] - v["M"] * v["g"] * lever[i] - sign * n * field[i] for i in range(3)]


# --- the gyrostat in a Newtonian field ---


def test_euler_equations_of_the_paper() -> None:
    a = mbsym.load(GYROSTAT)
    for seed in range(3):
        state = accelerated(a.system, random_state(a, seed), a.programs)
        moving = body_spin(a.system, "gyrostat", state)
        assert euler_equations(state.values, *moving) == [0, 0, 0]
        assert all(x != 0 for x in euler_equations(state.values, *moving, sign=-1))


def test_claims_of_the_paper() -> None:
    a = mbsym.load(GYROSTAT)
    found = {(item.claim.place, item.claim.of): item.outcome for item in a.claims}
    wrong = {key for key, outcome in found.items() if "differs" in outcome}
    assert wrong == {("eq. (1), third component", "phi")}
    assert {place for place, _ in found} >= {"eq. (2), all three", "eq. (3), energy", "eq. (3), area"}
    assert all("holds" in outcome for key, outcome in found.items() if key not in wrong)


def test_first_integrals_are_found() -> None:
    a = mbsym.load(GYROSTAT)
    assert [(item.kind, item.of, item.status) for item in a.integrals] == [
        ("generalised energy", "time", "proved"),
        ("cyclic momentum", "psi", "proved"),
    ]
    exact = Exact(a)
    area = exact(
        "(A*p + lx)*ga + B*q*gb + (C*r + lz)*gc",
        ga="sin(theta)*sin(phi)",
        gb="sin(theta)*cos(phi)",
        gc="cos(theta)",
        p="psi_dot*ga + theta_dot*cos(phi)",
        q="psi_dot*gb - theta_dot*sin(phi)",
        r="psi_dot*gc + phi_dot",
    )
    assert a.integrals[1].formula == area


def of_reference(name: str, system: System) -> tuple[System, dict[str, Fraction]]:
    """The system with the parameters of a reference trajectory, R = 3 g/N."""
    given = {key: Fraction(x) for key, x in REFERENCE[name]["parameters"].items()}
    values = {key: x for key, x in given.items() if key != "N"}
    values["R"] = 3 * given["g"] / given["N"]
    return with_values(system, values), values


def state_of(row: Mapping[str, str], values: Mapping[str, Fraction]) -> tuple[dict[str, arb], list[arb]]:
    """Euler's angles and their rates at a row of a reference trajectory, psi = 0."""
    p, q, r = (arb(row[key]) for key in "pqr")
    ga, gb, gc = (arb(row[key]) for key in ("gamma", "gammap", "gammapp"))
    theta, phi = arb.atan2((ga * ga + gb * gb).sqrt(), gc), arb.atan2(ga, gb)
    psi_dot = (p * ga + q * gb) / (ga * ga + gb * gb)
    theta_dot = p * phi.cos() - q * phi.sin()
    state = {name: arb(fmpq(x.numerator, x.denominator)) for name, x in values.items()}
    state |= {"psi": arb(0), "theta": theta, "phi": phi, "t": arb(0), "pi": arb.pi()}
    state |= {"psi_dot": psi_dot, "theta_dot": theta_dot, "phi_dot": r - psi_dot * gc}
    return state, [p, q, r]


@pytest.mark.parametrize("name", TRAJECTORIES)
def test_integrals_on_the_reference_trajectories(name: str) -> None:
    """Energy and area integral have the reference's values on all its rows."""
    a = mbsym.load(GYROSTAT)
    _, values = of_reference(name, a.system)
    with precision(160):
        constants = []
        for row in REFERENCE[name]["rows"]:
            state, _ = state_of(row, values)
            energy, area = (evaluated(a, State(Balls(state), state), item.formula) for item in a.integrals)
            assert abs(area - arb(row["K"])) < arb(10) ** -20
            constants.append(2 * energy - arb(row["E"]))
        # What remains is the field at the fixed point itself, the same in every row.
        assert all(abs(x - constants[0]) < arb(10) ** -18 for x in constants)


def test_the_description_starts_where_the_reference_starts() -> None:
    system = mbsym.load(GYROSTAT).system
    changed, values = of_reference("clean_E1_simple_ic", system)
    assert changed.parameters == system.parameters
    first = REFERENCE["clean_E1_simple_ic"]["rows"][0]
    with precision(160):
        state, _ = state_of(first, values)
        for item in system.initial:
            lower = Lowering(Balls({}), {"pi": arb.pi()})
            assert item.position is not None
            assert item.velocity is not None
            for given, wanted in (
                (item.position, state[item.coordinate]),
                (item.velocity, state[item.coordinate + "_dot"]),
            ):
                assert abs(lower(given) - wanted) < arb(10) ** -25


def test_no_body_has_the_numbers_of_table_1() -> None:
    """C >= M (x0^2 + y0^2) = 174 and B >= M (x0^2 + z0^2) = 150, but Table 1 has 11 and 76.2."""
    bounds = next(x for key, x in REFERENCE["table1"].items() if key.startswith("parallel"))
    assert bounds == ["30.0", "150.0", "174.0"]
    given = REFERENCE["paper_P1_spin_only"]["parameters"]
    values = {name: given[name] for name in ("A", "B", "C", "M", "g", "x0", "y0", "z0", "lx", "lz")} | {"R": "1000"}
    text = "\n".join(
        "values: {" + ", ".join(f"{k}: {v}" for k, v in values.items()) + "}" if line.startswith("values:") else line
        for line in GYROSTAT.read_text(encoding="utf-8").splitlines()
    )
    _, complaints = read(text, "x.yaml")
    found = [item for item in complaints.items if "no body has this inertia" in item.message]
    assert found
    assert "150" in found[0].message or "174" in found[0].message
    _, fine = read(GYROSTAT.read_text(encoding="utf-8"), "x.yaml")
    assert not fine.items


# --- Clebsch, Tisserand, Brun ---


PERMANENT = sympy.sympify(
    BRUN["permanent_rotation_axis3"]["charpoly*A*B"],
    {name: sympy.Symbol(name) for name in ("s", "A", "B", "C", "N", "W")},
)


def test_characteristic_polynomial_of_the_permanent_rotation() -> None:
    a = mbsym.load(CLEBSCH)
    exact = Exact(a)
    spin, tilt = a.stability.subsystems
    assert [str(x) for x in spin.characteristic] == ["0", "0", "1"]
    expected = list(reversed(sympy.Poly(PERMANENT, sympy.Symbol("s")).all_coeffs()))
    assert expected[:2] == [0, 0]
    assert len(expected) == 7
    ratios = {
        exact.ratio(ours, exact(str(theirs)))
        for ours, theirs in zip(tilt.characteristic, expected[2:], strict=True)
        if theirs != 0
    }
    assert ratios == {1}
    assert [ours.is_zero for ours in tilt.characteristic] == [theirs == 0 for theirs in expected[2:]]


def test_integrals_of_clebsch() -> None:
    a = mbsym.load(CLEBSCH)
    assert [item.kind for item in a.integrals] == ["generalised energy", "cyclic momentum"]
    found = {item.claim.place: item.outcome for item in a.claims}
    assert {"energy", "area integral", "fourth integral"} <= found.keys()
    assert all("holds" in outcome for outcome in found.values())


def test_the_fourth_integral_needs_the_newtonian_field() -> None:
    """With one more unit of stiffness about the first axis, or another coefficient, it is none."""
    text = CLEBSCH.read_text(encoding="utf-8")
    other = text.replace("loads:\n", "loads:\n  - force function: -sin(b)**2*cos(a)**2/4\n")
    coefficient = text.replace("B*C*g1**2", "C*C*g1**2")
    assert other != text != coefficient
    for changed in (other, coefficient):
        found = {item.claim.place: item.outcome for item in mbsym.loads(changed).claims}
        assert "holds" not in found["fourth integral"]
        assert "holds" in found["area integral"]


@pytest.mark.parametrize(
    ("moments", "word"),
    [((4, 5, 6), Word.STABLE_BUT_CYCLIC), ((5, 6, 4), "gyroscopically stabilised only"), ((4, 6, 5), Word.UNSTABLE)],
)
def test_verdicts_of_permanent_rotations(moments: tuple[int, int, int], word: str) -> None:
    """About the largest axis faster than sqrt(N): stable; about the middle axis: unstable.

    About the least axis the first approximation is stable by gyroscopic forces alone; that the motion is stable, as
    that of a free body is, is Arnold and Moser's theorem (w1/w2 is no resonance there, D4 is not zero).
    """
    found = at_values(CLEBSCH, **dict(zip("ABC", moments, strict=True)), W=2).stability
    first = found.before_higher_order or found.numerical
    assert first is not None
    assert first.word == word
    if found.before_higher_order is not None:
        assert found.numerical is not None
        assert (found.numerical.word, found.numerical.theorems) == (Word.STABLE_BUT_CYCLIC, ("Arnold-Moser",))
    part = found.subsystems[1]
    point = part.theory.at_point
    assert point is not None
    values = dict(zip("ABC", moments, strict=True)) | {"N": 2, "W": 2}
    expected = sympy.Poly(PERMANENT.subs(values) / sympy.Symbol("s") ** 2, sympy.Symbol("s"))
    ours = fmpq_poly(list(point.characteristic)) * (moments[0] * moments[1])
    assert [int(x) for x in ours.coeffs()] == [int(x) for x in reversed(expected.all_coeffs())]


def test_the_initial_state_of_clebsch_is_that_of_the_reference() -> None:
    a = mbsym.load(CLEBSCH)
    assert dict(zip("ABCN", BRUN["brun"]["A,B,C,N"], strict=True)) == {
        name: str(Fraction(int(x.value.value))) for name in "ABCN" for x in a.system.parameters if x.name == name
    }
    with precision(128):
        values: dict[str, Any] = {"pi": arb.pi(), "t": arb(0)}
        for p in a.system.parameters:
            assert p.value is not None
            values[p.name] = Lowering(Balls({}), {})(p.value)
        for item in a.system.initial:
            lower = Lowering(Balls({}), {"pi": arb.pi()})
            values |= {item.coordinate: lower(item.position), item.coordinate + "_dot": lower(item.velocity)}
            values[item.coordinate + "_ddot"] = arb(0)
        spin, _, vertical = body_spin(a.system, "body", State(Balls(values), values))
        for ours, theirs in zip([*spin, *vertical], BRUN["brun"]["ic"], strict=True):
            exact = Fraction(theirs)
            assert abs(ours - arb(fmpq(exact.numerator, exact.denominator))) < arb(2) ** -100
