"""First approximations of constrained systems against published matrices and formulas derived by hand."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from flint import acb, acb_mat, arb, ctx, fmpq

import mbsym
from mbsym.analysis.pipeline import Analysis
from mbsym.formulas.formula import Matrix
from mbsym.problems.checks import EXACT, NUMERICAL
from mbsym.problems.stability.words import Word
from mbsym.source import read

HERE = Path(__file__).parent
SYSTEMS = HERE.parent.parent / "systems"


def place(name: str) -> Path:
    """A description: shipped, or of these tests."""
    return SYSTEMS / name if (SYSTEMS / name).exists() else HERE / name


REFERENCES = HERE.parent / "references"


@pytest.fixture(scope="module")
def bicycle() -> Analysis:
    return mbsym.load(SYSTEMS / "bicycle.yaml")


def described(text: str) -> Analysis:
    system, complaints = read(text)
    assert system is not None, list(complaints)
    return Analysis(system)


def numbers(analysis: Analysis, **given: Any) -> dict[str, Any]:
    """Values of all names: those of the paper's Table 1, exact decimals; pi/10."""
    parameters = json.loads((REFERENCES / "bicycle_whipple.json").read_text())["parameters"]
    values = dict.fromkeys(analysis.ring.names(), arb(0))
    for name, text in parameters.items():
        values[name] = arb.pi() / 10 if "pi" in text else arb(fmpq(*_fraction(text)))
    return values | {"pi": arb.pi()} | given


def _fraction(text: str) -> tuple[int, int]:
    whole, _, decimals = text.partition(".")
    return int(whole + decimals), 10 ** len(decimals)


def evaluated(analysis: Analysis, matrix: Matrix, values: dict[str, Any], names: list[str]) -> list[list[Any]]:
    at = [analysis.linearisation.coordinates.index(name) for name in names]
    return [[analysis.ring.evaluate(matrix[i, j].polynomial, values) for j in at] for i in at]


def velocity_matrix(analysis: Analysis, values: dict[str, Any]) -> tuple[Any, Any, Any]:
    """M, D + G, K + N of roll and steer."""
    found = analysis.linearisation
    m, d, g, k, n = (evaluated(analysis, x, values, ["roll", "steer"]) for x in found.matrices)
    both = range(2)
    return m, [[d[i][j] + g[i][j] for j in both] for i in both], [[k[i][j] + n[i][j] for j in both] for i in both]


def close(found: Any, published: str) -> bool:
    return abs(float((found - arb(published)).mid())) < 1e-13


def test_the_bicycle_has_the_published_matrices(bicycle: Analysis) -> None:
    """M, C1, K0, K2 of Meijaard et al. 2007: M q'' + v C1 q' + (g K0 + v^2 K2) q."""
    with ctx.workprec(120):
        reference = json.loads((REFERENCES / "bicycle_whipple.json").read_text())["reference"]
        gravity = arb(fmpq(981, 100))
        m, c, still = velocity_matrix(bicycle, numbers(bicycle, v=arb(1), g=arb(0)))
        _, _, held = velocity_matrix(bicycle, numbers(bicycle, v=arb(0), g=gravity))
        for i in range(2):
            for j in range(2):
                assert close(m[i][j], reference["M"][i][j])
                assert close(c[i][j], reference["C1"][i][j])
                assert close(still[i][j], reference["K2"][i][j])
                assert close(held[i][j] / gravity, reference["K0"][i][j])


@pytest.mark.parametrize("speed", range(11))
def test_the_bicycle_has_the_published_roots(bicycle: Analysis, speed: int) -> None:
    """All fourteen decimals of the coefficients' roots; Table 2, of double precision, is off by 2e-13 (6e-13 once)."""
    with ctx.workprec(120):
        reference = json.loads((REFERENCES / "bicycle_whipple.json").read_text())["reference"]
        wanted = []
        for text in reference["eigenvalues_recomputed_50_digits"][str(speed)]:
            real, _, imaginary = text.partition("±")
            wanted += [acb(real, arb(imaginary[:-1] or 0) * sign) for sign in ((1, -1) if imaginary else (1,))]
        m, c, k = velocity_matrix(bicycle, numbers(bicycle, v=arb(speed), g=arb(fmpq(981, 100))))
        mass = acb_mat(2, 2, [x for row in m for x in row])
        velocity, position = (mass.solve(acb_mat(2, 2, [x for row in rows for x in row])) for rows in (c, k))
        first = acb_mat(4, 4)
        for i in range(2):
            first[i, 2 + i] = 1
            for j in range(2):
                first[2 + i, j], first[2 + i, 2 + j] = -position[i, j], -velocity[i, j]
        found = first.eig()
        for root in wanted:
            assert min(max(abs(float((root - x).real)), abs(float((root - x).imag))) for x in found) < 5.01e-15
        for name in ("castering", "capsize", "weave_re"):
            printed = reference["published_table2"][name].get(str(speed)) if speed else None
            off = 1e-12 if (name, speed) == ("castering", 7) else 2e-13
            assert printed is None or min(abs(printed - float(x.real)) for x in found) < off


def test_the_bicycle_is_told_by_what_remains(bicycle: Analysis) -> None:
    about = bicycle.linearisation.about
    assert about is not None
    assert not about.holonomic
    assert about.speeds == ("roll", "rear", "steer")
    assert set(about.dependent_speeds) == {"x", "y", "yaw", "pitch", "front"}
    assert {"x", "y", "yaw", "rear", "front"} == set(about.idle)
    assert {name: str(rate) for name, rate in about.rates} == {"x": "v", "front": "-v/rF"}
    assert bicycle.equilibrium.satisfied


@pytest.mark.parametrize("name", ["bicycle", "disc"])
def test_multipliers_agree_exactly(name: str) -> None:
    analysis = mbsym.load(place(f"{name}.yaml"))
    for check in ("equilibrium", "perturbed motion"):
        found = analysis.check(check)
        assert found is not None
        assert found.outcome == EXACT, found


def test_the_upright_disc() -> None:
    """lean: 5 phi''/4 = (g/r) phi + (3/2) w psi', psi'' = -2 w phi' (sympy_rolling_disc.json)."""
    found = mbsym.load(HERE / "disc.yaml").linearisation
    assert found.coordinates == ("yaw", "lean", "spin")
    total = [[found.D[i, j] + found.G[i, j] for j in range(3)] for i in range(3)]
    assert str(found.M[1, 1]) == "5*m*r**2/4"
    assert str(found.M[0, 0]) == "m*r**2/4"
    assert str(total[1][0]) == "-3*m*r**2*w/2"
    assert str(total[0][1]) == "m*r**2*w/2"
    assert str(found.K[1, 1]) == "-m*r*g"
    assert all(x.is_zero for x in (found.N[0, 1], found.K[0, 0], found.K[2, 2]))


PARALLELOGRAM = """
mbsym: 1
name: Parallelogram
parameters: {m: positive, l: positive, g: positive, d: positive, k: positive}
bodies:
  - {name: left, attached to: 0, rotation: {axes: [3], angles: [a]}, mass: 0}
  - {name: coupler, attached to: left, connection point: [0, -l, 0], rotation: {axes: [3], angles: [b]}, mass: m,
     mass centre: [d/2, 0, 0], inertia about: mass centre, inertia: [0, 0, m*d**2/12]}
  - {name: right, attached to: 0, connection point: [d, 0, 0], rotation: {axes: [3], angles: [c]}, mass: 0}
loads:
  - uniform gravity: {vector: [0, -g, 0]}
  - spring: {coordinate: a, stiffness: k}
constraints:
  - coincide: [{body: coupler, point: [d, 0, 0]}, {body: right, point: [0, -l, 0]}]
dependent: [b, c]
motion: {a: 0, b: 0, c: 0}
"""


def test_a_parallelogram_swings_as_a_pendulum() -> None:
    """The coupler keeps its direction and moves on a circle: m l^2 a'' + (m g l + k) a = 0."""
    analysis = described(PARALLELOGRAM)
    found = analysis.linearisation
    assert found.coordinates == ("a",)
    assert [str(x[0, 0]) for x in (found.M, found.K)] == ["m*l**2", "m*l*g + k"]
    assert all(x.is_zero for x in (found.D[0, 0], found.G[0, 0], found.N[0, 0]))
    assert found.about.ties
    assert found.about.holonomic
    check = analysis.check("perturbed motion")
    assert check is not None
    assert check.outcome == EXACT


def test_a_motion_that_breaks_a_constraint_does_not_exist() -> None:
    analysis = described(PARALLELOGRAM.replace("motion: {a: 0, b: 0, c: 0}", "motion: {a: 0, b: 0, c: {rate: g}}"))
    assert not analysis.equilibrium.satisfied


ONE_LENGTH = """
mbsym: 1
name: Parallelogram of one length
parameters: {m: positive, l: positive, k: positive}
bodies:
  - {name: left, attached to: 0, rotation: {axes: [3], angles: [a]}, mass: m, mass centre: [l, 0, 0]}
  - {name: coupler, attached to: left, connection point: [l, 0, 0], rotation: {axes: [3], angles: [b]}, mass: m,
     mass centre: [l, 0, 0]}
  - {name: right, attached to: 0, connection point: [2*l, 0, 0], rotation: {axes: [3], angles: [c]}, mass: m,
     mass centre: [l, 0, 0]}
loads:
  - spring: {coordinate: a, stiffness: k}
constraints:
  - coincide: [{body: coupler, point: [2*l, 0, 0]}, {body: right, point: [l, 0, 0]}]
motion: {a: 0, b: 0, c: 0}
"""


def test_lengths_of_zero_close_no_loop() -> None:
    """phi is homogeneous in l: l = 0 solves it, where J = 0 and nothing can be learnt."""
    analysis = described(ONE_LENGTH)
    found = analysis.equations.constraints
    assert found is not None
    assert (found.position_rank, found.velocity_rank, found.redundant) == (2, 2, ())
    assert found.demanded.count == 0


def test_the_flat_parallelogram_is_singular() -> None:
    """There it may leave into the crossed one: J loses its rank, and no first approximation is given."""
    stage = described(ONE_LENGTH).stage(5)
    assert stage.failure is not None
    assert stage.failure.code == "singular"


def test_a_squared_constraint_is_not_called_independent_near_the_motion() -> None:
    """Of y^2 = 0 the row 2 y y' = 0 vanishes at every allowed position; only others, which break it, have rank 1."""
    text = (
        "mbsym: 1\nname: squared\nbodies: [{name: p, attached to: 0, mass: 1, connection point: [x, y, 0], "
        "coordinates: [x, y]}]\nconstraints: [{relation: y**2 = 0}]\nmotion: {}\n"
    )
    failure = described(text).stage(5).failure
    assert failure is not None
    assert "independent" not in str(failure.reason)
    assert "allowed ones or not" in str(failure.reason)


OUTSIDE = """
mbsym: 1
name: Three masses, the velocity of the first one given by the place of the second
parameters: {a: {sign: real, value: 1/2}}
bodies:
  - {name: p1, attached to: 0, connection point: [x1, 0, 0], mass: 3, coordinates: [x1]}
  - {name: p2, attached to: 0, connection point: [x2, 0, 0], mass: 1, coordinates: [x2]}
  - {name: p3, attached to: 0, connection point: [x3, 0, 0], mass: 1, coordinates: [x3]}
loads: [{generalized force: {x2: -2*x2, x3: -(a + 1)*x3}}]
constraints: [{velocity: -x1_dot = a*x2}, {velocity: 2*x3_dot = x2_dot}]
motion: {}
"""


def test_a_coordinate_outside_the_linear_equations_may_drift() -> None:
    """d'Alembert, v3 = v2/2 and x3 = x2/2 + c: (5/4) x2'' + (2 + (a + 1)/4) x2 = -(a + 1) c/2.

    With c disturbed x2 swings about a place that is not zero, and x1 = -a times its integral grows with the time.
    """
    stability = described(OUTSIDE).stability
    assert stability is not None
    (part,) = stability.subsystems
    assert part.theory.cases[0].verdict.word is Word.STABLE_BUT_CYCLIC
    assert stability.numerical is not None
    assert stability.numerical.word is Word.STABLE_BUT_CYCLIC
    inside = described(OUTSIDE.replace("a*x2", "a*x2_dot")).stability  # x1 = -a x2 + const
    assert inside is not None
    assert inside.numerical is not None
    assert inside.numerical.word.stable


WHEEL = """
mbsym: 1
name: wheels on a torsion spring
parameters: {J: positive, c: positive, Omega: real}
relations: {Omega: 0}
bodies:
  - {name: a, attached to: 0, rotation: {axes: [3], angles: [psi]}, mass: 0, inertia about: joint, inertia: [J, J, J]}
loads:
  - force function: -c*(1 - cos(psi))
motion: {psi: {value: 0, rate: Omega}}
"""
GEARED = WHEEL.replace(
    "loads:",
    "  - {name: b, attached to: 0, rotation: {axes: [3], angles: [chi]}, mass: 0, inertia about: joint,"
    " inertia: [J, J, J]}\nconstraints:\n  - velocity: chi_dot = 2*psi_dot\nloads:",
)


@pytest.mark.parametrize(("text", "inertia"), [(WHEEL, "J"), (GEARED, "5*J")], ids=["alone", "geared"])
def test_a_rate_that_a_relation_makes_zero_is_rest(text: str, inertia: str) -> None:
    """J psi'' + 4 J psi'' of the second wheel + c sin(psi) = 0, by hand."""
    analysis = mbsym.loads(text)
    assert analysis.equilibrium.satisfied
    assert (str(analysis.linearisation.M), str(analysis.linearisation.K)) == (f"[[{inertia}]]", "[[c]]")
    assert {check.outcome for check in analysis.checks} <= {EXACT, NUMERICAL}
