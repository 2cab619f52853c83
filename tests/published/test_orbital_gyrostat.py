"""The gyrostat satellite in a circular orbit against an independent derivation."""

from __future__ import annotations

import random
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import pytest
import sympy
from conftest import SHIPPED, Exact, at_values, precision, reference
from flint import arb, fmpq, fmpq_poly

import mbsym
from mbsym.algebra.base import Lowering, Scalar
from mbsym.algebra.point import Balls, Rationals
from mbsym.analysis import Analysis
from mbsym.mechanics.oracle import Oracle, State
from mbsym.mechanics.programs import accelerated
from mbsym.problems.relative_equilibria.equilibria import equilibria
from mbsym.problems.stability.words import Word

FILE = SHIPPED / "orbital-gyrostat.yaml"
REFERENCE = reference("orbit-gyrostat-and-clebsch")["gyrostat_orbit"]
SYMBOLS = {name: sympy.Symbol(name) for name in ("s", "A", "B", "C", "h")}
PITCH, COUPLED = (sympy.sympify(text, SYMBOLS) for text, _ in REFERENCE["charpoly_9x9_factors"][1:])


@pytest.fixture(scope="module")
def a() -> Analysis:
    return mbsym.load(FILE)


# --- the equations ---


def vectors(a: Analysis, state: State) -> tuple[list[Any], list[Any], list[Any], list[Any]]:
    """omega, its rate, the radial unit vector e and the normal n of the orbit, in the reference's axes of A, B, C.

    The third axis of the description is minus the reference's second.
    """
    place = Oracle(a.system, state).moving
    axes = [[x.a for x in row] for row in place.axes["satellite"]]
    frame = [[x.a for x in row] for row in place.axes["orbital frame"]]
    spin, rate = place.spin("satellite")
    outward = [row[1] for row in frame]
    normal = [-row[2] for row in frame]
    found = []
    for v in (spin, rate, outward, normal):
        own = [sum(axes[k][i] * v[k] for k in range(3)) for i in range(3)]
        found.append([own[0], -own[2], own[1]])
    return found[0], found[1], found[2], found[3]


def cross(u: Sequence[Any], v: Sequence[Any]) -> list[Any]:
    return [u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3] for i in range(3)]


def dot(u: Sequence[Any], v: Sequence[Any]) -> Any:
    return sum(x * y for x, y in zip(u, v, strict=True))


def test_equations_are_those_of_the_reference(a: Analysis) -> None:
    """I w' = -w x (I w + h) + 3 w0^2 e x I e, at random exact states."""
    for seed in range(3):
        source = random.Random(seed)
        values: dict[str, Scalar] = {x: fmpq(source.randint(1, 30), source.randint(1, 20)) for x in a.ring.names()}
        values |= {"pi": fmpq(355, 113), "t": fmpq(0)}
        values["nu"] = values["omega0"] ** 2 * values["R"] ** 3
        tangents = {name: fmpq(source.randint(1, 9), source.randint(10, 19)) for name in a.ring.angles}
        state = accelerated(a.system, State(Rationals(tangents, a.ring.angles), values), a.programs)
        spin, rate, outward, _ = vectors(a, state)
        inertia = [values[name] for name in "ABC"]
        internal = [values[name] for name in ("h1", "h2", "h3")]
        momentum = [j * w + h for j, w, h in zip(inertia, spin, internal, strict=True)]
        field = cross(outward, [j * e for j, e in zip(inertia, outward, strict=True)])
        turned = cross(spin, momentum)
        for i in range(3):
            assert inertia[i] * rate[i] == -turned[i] + 3 * values["omega0"] ** 2 * field[i]
        assert cross(spin, internal) != [0, 0, 0]


def test_equilibrium_needs_the_rotor_along_the_normal(a: Analysis) -> None:
    """t.I.n + h.t = 0 and 4 e.I.n + h.e = 0 with aligned axes."""
    assert {str(x) for x in a.equilibrium.conditions} == {"h1", "h3"}
    assert {name: str(value) for name, value in a.equilibrium.solved} == {"h1": "0", "h3": "0"}
    assert not a.equilibrium.unsteady


def test_the_energy_integral_is_jacobis(a: Analysis) -> None:
    assert [item.kind for item in a.integrals] == ["generalised energy"]
    outcomes = {item.claim.place: item.outcome for item in a.claims}
    assert "holds" in outcomes["Jacobi's integral"]


def test_jacobis_integral_at_the_initial_state_of_the_reference(a: Analysis) -> None:
    trajectory = REFERENCE["trajectory"]
    wanted = [Fraction(x) for x in trajectory["ic (p,q,r,e,n)"]]
    with precision(160):
        values: dict[str, Any] = {"pi": arb.pi(), "t": arb(0), "chi": arb(0)}
        for p in a.system.parameters:
            assert p.value is not None
            values[p.name] = Lowering(Balls({}), {})(p.value)
        for item in a.system.initial:
            lower = Lowering(Balls({}), {"pi": arb.pi()})
            values |= {item.coordinate: lower(item.position), item.coordinate + "_dot": lower(item.velocity)}
            values[item.coordinate + "_ddot"] = arb(0)
        spin, _, outward, normal = vectors(a, State(Balls(values), values))
        for ours, theirs in zip([*spin, *outward, *normal], wanted, strict=True):
            assert abs(ours - arb(fmpq(theirs.numerator, theirs.denominator))) < arb(2) ** -130
        inertia = [arb(x) for x in trajectory["I"]]
        internal = [arb(fmpq(Fraction(x).numerator, Fraction(x).denominator)) for x in trajectory["h"]]
        momentum = [j * w for j, w in zip(inertia, spin, strict=True)]
        jacobi = dot(spin, momentum) / 2 - dot(normal, [x + h for x, h in zip(momentum, internal, strict=True)])
        jacobi += 3 * sum(j * e * e for j, e in zip(inertia, outward, strict=True)) / 2
        assert abs(jacobi - arb(trajectory["rows"][0]["Jacobi"])) < arb(10) ** -28


# --- stability ---


def test_characteristic_polynomials(a: Analysis) -> None:
    exact = Exact(a)
    parts = {item.coordinates: item for item in a.stability.subsystems}
    for coordinates, printed in ((("theta",), PITCH), (("psi", "phi"), COUPLED)):
        expected = reversed(sympy.Poly(printed, SYMBOLS["s"]).all_coeffs())
        for ours, theirs in zip(parts[coordinates].characteristic, expected, strict=True):
            assert ours.is_zero if theirs == 0 else exact.ratio(ours, exact(str(theirs))) == 1


def test_conditions_that_are_sufficient(a: Analysis) -> None:
    """A - C > 0, B - A + h > 0, 4 (B - C) + h > 0, and nothing else, make it stable."""
    exact = Exact(a)
    printed = {str(exact(text.removesuffix(">0"))) for text in REFERENCE["aligned_equilibrium"]["sufficient_Lyapunov"]}
    found = set()
    for part in a.stability.subsystems:
        case = part.theory.cases[0]
        assert case.verdict.word == Word.STABLE
        assert not case.any_of
        for wanted in case.all_of:
            assert wanted.condition.kind == "inequality"
            found.add(str(exact.same(part._formula(wanted.condition.polynomial))))
    assert found == printed
    shown = {str(formula) for part in a.stability.subsystems for _, formula, _ in (*part.conditions, *part.sufficient)}
    assert printed <= shown
    outcomes = [item.outcome for item in a.claims if item.claim.kind == "condition"]
    assert len(outcomes) == 3
    assert all("holds" in outcome for outcome in outcomes)


def test_a_condition_of_the_wrong_sign_is_not_confirmed() -> None:
    text = FILE.read_text(encoding="utf-8")
    wrong = mbsym.loads(text.replace("that: B - A + h > 0", "that: B - A - h > 0"))
    outcomes = [item.outcome for item in wrong.claims if item.claim.kind == "condition"]
    assert sum("holds" in outcome for outcome in outcomes) == 2


VERDICTS = {
    "stable": Word.STABLE,
    "h=0 classical B>A>C": Word.STABLE,
    "unstable pitch": Word.UNSTABLE,
    "stabilised by rotor (B<A, B<C)": Word.STABLE,
    "static yaw instability": Word.UNSTABLE,
}


@pytest.mark.parametrize("example", REFERENCE["numeric_examples"], ids=lambda example: example["name"])
def test_examples_of_the_reference(example: dict[str, Any]) -> None:
    moments = [Fraction(x) for x in example["A,B,C,h"]]
    values = dict(zip(("A", "B", "C", "h"), moments, strict=True))
    a = at_values(FILE, **values, h2=values["h"])
    assert a.stability.numerical is not None
    assert a.stability.numerical.word == VERDICTS[example["name"]]
    assert (a.stability.numerical.word == Word.STABLE) == all(example["sufficient"])
    whole = fmpq_poly([1])
    for part in a.stability.subsystems:
        point = part.theory.at_point
        assert point is not None
        whole *= fmpq_poly(list(point.characteristic))
    numbers = {name: sympy.Rational(x.numerator, x.denominator) for name, x in values.items()}
    expected = sympy.Poly((PITCH * COUPLED / (SYMBOLS["B"] * SYMBOLS["A"] * SYMBOLS["C"])).subs(numbers), SYMBOLS["s"])
    assert [Fraction(str(x)) for x in reversed(expected.all_coeffs())] == [Fraction(str(x)) for x in whole.coeffs()]
    with precision(160):
        for real, imaginary in example["eigenvalues"]:
            root = complex_ball(real, imaginary)
            assert abs(horner(whole, root)) < arb(10) ** -26


def complex_ball(real: str, imaginary: str) -> Any:
    from flint import acb

    return acb(arb(real), arb(imaginary))


def horner(p: fmpq_poly, x: Any) -> Any:
    total = x * 0
    for c in reversed(p.coeffs()):
        total = total * x + arb(c)
    return total


@pytest.mark.parametrize(("moments", "word"), [((9, 7, 8), Word.GYROSCOPIC), ((30, 21, 29), Word.UNSTABLE)])
def test_gyroscopic_stabilisation_is_no_stability(moments: tuple[int, int, int], word: str) -> None:
    """In the region of DeBra and Delp (B < C < A) the roots may be imaginary without K > 0."""
    values = dict(zip("ABC", moments, strict=True)) | {"h": 0}
    a = at_values(FILE, **values, h2=0)
    assert a.stability.numerical is not None
    assert a.stability.numerical.word == word
    roots = sympy.Poly(COUPLED.subs(values), SYMBOLS["s"]).nroots()
    assert all(abs(sympy.re(x)) < 1e-12 for x in roots) == (word == Word.GYROSCOPIC)


@pytest.mark.parametrize(
    "count", [x for x in REFERENCE["equilibria_counts_multistart"] if x["hbar"][0] == x["hbar"][2] == 0]
)
def test_the_number_of_equilibria_with_the_rotor_along_a_principal_axis(count: dict[str, Any]) -> None:
    """24 for a slow rotor and 8 for a fast one (found by many searches in the reference, exactly here)."""
    h = Fraction(str(count["hbar"][1]))
    a = mbsym.load(FILE)
    values = {p.name: Fraction(str(Lowering(Rationals({}, {}), {})(p.value))) for p in a.system.parameters if p.value}
    values |= dict(zip("ABC", map(Fraction, count["I"]), strict=True)) | {"h": h, "h2": h}
    found = equilibria(a.system, values)
    assert found.complete
    assert len(found.equilibria) == count["isolated_equilibria_found"]
    assert not found.families
