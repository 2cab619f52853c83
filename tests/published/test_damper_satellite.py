"""The satellite with a damper (Shchepakina & Sobolev) against an independent derivation, and what it needed: steady
spins that may be turned in space, cyclic coordinates beside dissipation, and the choice of the rotation sequence."""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import sympy
from conftest import SHIPPED, Exact, parsed, reference, with_values
from flint import arb, fmpq, fmpq_mat, fmpq_mpoly_ctx, fmpq_poly

import mbsym
from mbsym.algebra.base import Lowering, Scalar
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.point import Rationals
from mbsym.algebra.roots import count_roots
from mbsym.algebra.signs import Signs
from mbsym.analysis import Analysis
from mbsym.analysis.stages import Unavailable
from mbsym.mechanics.oracle import Oracle, State
from mbsym.mechanics.programs import accelerated
from mbsym.mechanics.symmetry import free_spin
from mbsym.model.system import System
from mbsym.problems.stability.exact import verdict_at
from mbsym.problems.stability.linear_form import LinearSystem
from mbsym.problems.stability.problem import parameter_values
from mbsym.problems.stability.routh import ignoring_cyclic
from mbsym.problems.stability.symbolic import analyse
from mbsym.problems.stability.verdict import Verdict, combine
from mbsym.problems.stability.words import Because, Word
from mbsym.source import to_yaml

FREE, DRIVEN = SHIPPED / "satellite-with-damper.yaml", SHIPPED / "satellite-with-damper-driven.yaml"
REFERENCE = reference("satellite-with-damper")
SETS = REFERENCE["sets"]
BOTH = pytest.mark.parametrize("path", [FREE, DRIVEN], ids=["free rotor", "driven rotor"])

#: The steady spin linearised in the angles c, a, b and x = z/b0; S is the variable, everything in units of A and b0.
MATRIX = """[[s*S**2, 0, 0, 0], [0, S**2 + Lambda*omega, (Lambda - omega)*S, 0],
    [0, -(Lambda - omega)*S, S**2 + Lambda*omega, -e*(S**2 + omega**2)],
    [0, 0, -e*(S**2 + omega**2), e*(S**2 + dc*S + p2)]]"""
P = REFERENCE["charpoly"]["P"].split(",")[0].replace("lambda", "Lambda").replace("delta_c", "dc")


def with_order(path: Any, axes: str, angles: str) -> Analysis:
    text = path.read_text(encoding="utf-8")
    assert text.count("axes: [3, 1, 2], angles: [c, a, b]") == 1
    return mbsym.loads(text.replace("axes: [3, 1, 2], angles: [c, a, b]", f"axes: {axes}, angles: {angles}"))


NAMES = {name: sympy.Symbol(name) for name in ("S", "Lambda", "s", "omega", "e", "dc", "p2")}


def determinant(a: Analysis) -> Any:
    """det(S^2 M + S (D + G) + K + N) of the whole system in plain symbols."""
    variable = sympy.Symbol("S")
    m, d, g, k, n = (sympy.Matrix(matrix.to_sympy()) for matrix in a.linearisation.matrices)
    whole = m * variable**2 + (d + g) * variable + k + n
    return sympy.expand(whole.subs({x: sympy.Symbol(x.name) for x in whole.free_symbols}).det())


# --- states ---


def some_state(a: Analysis, seed: int, given: Mapping[str, fmpq] | None = None) -> State:
    """Random rational parameters that obey the relations, and a random rational state."""
    source = random.Random(seed)
    values: dict[str, Scalar] = {
        name: fmpq(source.randint(1, 30), source.randint(1, 20)) for name in a.ring.names() if name != "pi"
    }
    values |= {"pi": fmpq(355, 113), "t": fmpq(0)} | dict(given or {})
    tangents = {name: fmpq(source.randint(1, 9), source.randint(10, 19)) for name in a.ring.angles}
    numbers = Rationals(tangents, a.ring.angles)
    for item in a.system.relations:
        values[item.name] = Lowering(numbers, dict(values))(item.value)
    return State(numbers, values)


def carrier_spin(a: Analysis, state: State) -> tuple[list[Any], list[Any]]:
    """omega and its rate in the axes of the carrier."""
    place = Oracle(a.system, state).moving
    axes = [[x.a for x in row] for row in place.axes["carrier"]]
    spin, rate = place.spin("carrier")
    return [[sum(axes[k][i] * v[k] for k in range(3)) for i in range(3)] for v in (spin, rate)]  # type: ignore[return-value]


def reduced_variables(a: Analysis, state: State) -> dict[str, Any]:
    """The variables and parameters of the reference in a moving state of ours."""
    v = state.values
    spin, rate = carrier_spin(a, state)
    turning = v["sigma_dot"] + spin[2] if "sigma" in a.system.coordinates else v["Omega"]
    return {
        "omega1": spin[0], "omega2": spin[1], "omega": spin[2],
        "omega1d": rate[0], "omega2d": rate[1], "omegad": rate[2],
        "x": v["z"] / v["b0"], "y": v["z_dot"] / v["b0"], "yd": v["z_ddot"] / v["b0"],
        "e": v["e"], "s": v["s"], "rho": v["rho"], "p2": v["p2"], "delta_c": v["dc"],
        "eta": v["Ja"] * turning / v["A"],
    }  # fmt: skip


def value(text: str, values: Mapping[str, Any]) -> Any:
    return Lowering(Rationals({}, {}), dict(values))(parsed(text))


# --- equations ---


@BOTH
def test_equations_of_motion_are_those_of_the_reference(path: Any) -> None:
    a = mbsym.load(path)
    for seed in range(3):
        moving = accelerated(a.system, some_state(a, seed), a.programs)
        variables = reduced_variables(a, moving)
        for text in REFERENCE["equations"]["residuals_equal_zero"]:
            assert value(text, variables) == 0
        wrong = variables | {"omega2": -variables["omega2"]}
        assert any(value(text, wrong) != 0 for text in REFERENCE["equations"]["residuals_equal_zero"])


def test_the_reduced_mass_takes_the_place_of_the_free_carrier() -> None:
    """With X, Y, Z of the carrier, its mass and that of the rotor the angles and z accelerate in the same way."""
    a = mbsym.load(FREE)
    text = to_yaml(a.system).replace("mass: mu", "mass: m")
    text = text.replace("  - name: carrier\n", "  - name: carrier\n    connection point: [X, Y, Z]\n")
    text = text.replace("    mass: 0\n", "    mass: M1\n", 1).replace("    mass: 0\n", "    mass: M2\n", 1)
    text = text.replace("parameters:\n", "parameters:\n  m: positive\n  M1: positive\n  M2: positive\n")
    text = text.replace("\n  - name: rotor", "    coordinates: [X, Y, Z, c, a, b]\n\n  - name: rotor")
    free = mbsym.loads(text)
    assert free.system.coordinates == ("X", "Y", "Z", "c", "a", "b", "sigma", "z")
    for seed in range(2):
        here = some_state(a, seed)
        masses = {"m": fmpq(3, 2), "M1": fmpq(7), "M2": fmpq(5, 3)}
        mu = masses["m"] * (masses["M1"] + masses["M2"]) / (masses["m"] + masses["M1"] + masses["M2"])
        values = dict(here.values) | {"e": mu * here.values["b0"] ** 2 / here.values["A"]}
        for item in a.system.relations:
            values[item.name] = Lowering(here.numbers, dict(values))(item.value)
        assert values["mu"] == mu
        small = accelerated(a.system, State(here.numbers, values), a.programs)
        carried = {f"{name}{dot}": fmpq(3, 7) for name in "XYZ" for dot in ("", "_dot", "_ddot")}
        large = accelerated(free.system, State(here.numbers, values | masses | carried), free.programs)
        for name in a.system.coordinates:
            assert small.values[f"{name}_ddot"] == large.values[f"{name}_ddot"]


def test_the_driven_rotor_is_a_gyrostatic_moment() -> None:
    driven = mbsym.load(DRIVEN)
    text = to_yaml(driven.system)
    start, end = text.index("  - name: rotor"), text.index("  - name: particle")
    text = text[:start] + text[end:]
    text = text.replace("prescribed:\n", "# prescribed:\n").replace("  sigma: {rate", "#  sigma: {rate")
    inertia = "inertia: [[I1, 0, mu*b0*d], [0, I2, 0], [mu*b0*d, 0, I3]]"
    assert inertia in text
    rotor = "inertia: [[I1 + Jt, 0, mu*b0*d], [0, I2 + Jt, 0], [mu*b0*d, 0, I3 + Ja]]"
    gyrostat = mbsym.loads(text.replace(inertia, f"{rotor}\n    gyrostatic moment: [0, 0, Ja*Omega]"))
    assert gyrostat.system.body("carrier").gyrostatic_moment is not None
    exact = Exact(driven)
    for ours, theirs in zip(gyrostat.equations.forcing, driven.equations.forcing, strict=True):
        assert exact(str(ours)) == theirs
    for row, other in zip(gyrostat.equations.mass_matrix, driven.equations.mass_matrix, strict=True):
        assert all(exact(str(ours)) == theirs for ours, theirs in zip(row, other, strict=True))
    assert determinant(gyrostat) == determinant(driven)


@BOTH
def test_momenta_are_found(path: Any) -> None:
    a = mbsym.load(path)
    found = {item.name: item for item in a.integrals}
    expected = {"momentum of c", "angular momentum about axis 1", "angular momentum about axis 2"}
    assert expected <= found.keys()
    assert "generalised energy" not in {item.kind for item in a.integrals}  # the damper takes it
    state = some_state(a, 5)
    carry = Carrier(a.ring, state.numbers, state.values)
    square = sum(carry(found[name].formula.polynomial) ** 2 for name in expected)
    variables = reduced_variables(a, state)
    ours = state.values["A"] ** 2 * sum(value(text, variables) ** 2 for text in REFERENCE["H2"]["H"])
    assert square == ours


# --- linearisation ---


def expected_determinant() -> Any:
    s, variable, omega, e = (NAMES[name] for name in ("s", "S", "omega", "e"))
    product = e * s * variable**2 * (variable**2 + omega**2) * sympy.sympify(P, NAMES)
    assert sympy.expand(sympy.Matrix(sympy.sympify(MATRIX, NAMES)).det() - product) == 0  # the reference with itself
    return product


@pytest.mark.parametrize(("axes", "angles"), [("[3, 1, 2]", "[c, a, b]"), ("[3, 2, 1]", "[c, b, a]")])
def test_the_determinant_factors(axes: str, angles: str) -> None:
    found = determinant(with_order(DRIVEN, axes, angles))
    scale = sympy.Symbol("A") ** 4 / sympy.Symbol("b0") ** 2
    assert sympy.expand(found - sympy.expand(scale * expected_determinant())) == 0


def test_the_free_rotor_adds_its_own_two_zero_roots() -> None:
    scale = sympy.Symbol("A") ** 4 / sympy.Symbol("b0") ** 2 * sympy.Symbol("Ja") * sympy.Symbol("S") ** 2
    assert sympy.expand(determinant(mbsym.load(FREE)) - sympy.expand(scale * expected_determinant())) == 0


def test_the_linear_matrix_is_that_of_the_reference() -> None:
    a = mbsym.load(DRIVEN)
    expected = sympy.Matrix(sympy.sympify(MATRIX, NAMES))
    variable = NAMES["S"]
    m, d, g, k, n = (sympy.Matrix(matrix.to_sympy()) for matrix in a.linearisation.matrices)
    whole = m * variable**2 + (d + g) * variable + k + n
    whole = whole.subs({x: sympy.Symbol(x.name) for x in whole.free_symbols})
    length = sympy.diag(1, 1, 1, sympy.Symbol("b0"))
    assert (length * whole * length / sympy.Symbol("A") - expected).applyfunc(sympy.expand).is_zero_matrix


def no_constants(a: Analysis) -> Any:
    """Why the coefficients of the first approximation are not constant."""
    with pytest.raises(Unavailable) as refused:
        a.autonomous  # noqa: B018
    return refused.value.failure


@pytest.mark.parametrize(
    ("axes", "angles"), [("[1, 2, 3]", "[a, b, c]"), ("[2, 1, 3]", "[b, a, c]"), ("[1, 3, 2]", "[a, c, b]")]
)
def test_another_order_is_time_periodic_and_a_better_one_is_suggested(axes: str, angles: str) -> None:
    """The matrices are periodic in these angles; the verdict on the same spin is that in the better ones."""
    a = with_order(FREE, axes, angles)
    failure = no_constants(a)
    assert "vary with c" in failure.reason
    hint = failure.hint
    better = "axes: [3, 1, 2], angles: [c, a, b]" if axes != "[2, 1, 3]" else "axes: [3, 2, 1], angles: [c, b, a]"
    assert better in hint
    assert "'carrier'" in hint
    followed = with_order(FREE, *better.removeprefix("axes: ").split(", angles: "))
    assert not followed.linearisation.varying
    assert (a.stability.verdict.word, a.stability.verdict.theorem) == (
        followed.stability.verdict.word,
        followed.stability.verdict.theorem,
    )
    assert a.stability.verdict.because(Because.OTHER_ANGLES)
    assert not followed.stability.verdict.because(Because.OTHER_ANGLES)


def test_no_order_is_suggested_where_none_helps() -> None:
    text = FREE.read_text(encoding="utf-8").replace(
        "axes: [3, 1, 2], angles: [c, a, b]", "axes: [1, 2, 3], angles: [a, b, c]"
    )
    known = mbsym.loads(text.replace("loads:\n", "loads:\n  - force function: k*z**2*cos(c)\n"))
    assert (
        "rotation" not in no_constants(known).hint
    )  # a load knows the angle: in another order it would be another load


# --- stability ---


def part(a: Analysis) -> Any:
    return next(item for item in a.stability.subsystems if "z" in item.coordinates)


@BOTH
def test_the_hurwitz_condition_is_that_of_the_reference(path: Any) -> None:
    a = mbsym.load(path)
    exact, found = Exact(a), part(a)
    minor = next(r.polynomial for r in found.theory.requirements if r.label.startswith("Hurwitz minor 3"))
    printed = REFERENCE["hurwitz_D3"].replace("lambda", "Lambda").replace("delta_c", "dc")
    assert exact.ratio(found._formula(minor), exact(printed)) == 1
    assert exact.ratio(found._formula(minor), exact("e*dc**2*Lambda*(Lambda + omega)*(Lambda - omega)**2")) == 1
    quartic = next(factor.coefficients for factor in found.theory.factors if len(factor.coefficients) == 5)
    printed = [text.replace("lambda", "Lambda").replace("delta_c", "dc") for text in REFERENCE["coefficients_a0_to_a4"]]
    ratios = {exact.ratio(found._formula(x), exact(y)) for x, y in zip(reversed(quartic), printed, strict=True)}
    assert ratios in ({1}, {-1})


@BOTH
def test_conditions_are_those_of_the_reference(path: Any) -> None:
    """Asymptotically stable iff lambda (lambda + omega) > 0, lambda != omega, lambda (lambda p2 - e omega^3) > 0."""
    a = mbsym.load(path)
    exact = Exact(a)
    wanted = {
        (str(exact("Lambda*(p2*Lambda - omega**3*e)")), ">"),
        (str(exact("Lambda*(omega + Lambda)")), ">"),
        (str(exact("omega - Lambda")), "!="),
    }
    assert {(str(formula), relation) for _, formula, relation in part(a).conditions} == wanted
    first = part(a).theory.cases[0]
    assert (first.verdict.word, first.verdict.theorem) == (Word.ASYMPTOTIC_BUT_TURNED, "Lyapunov-Malkin")


VERDICTS = {
    "S_stable": Word.ASYMPTOTIC_BUT_TURNED,
    "S2_strong_stable": Word.ASYMPTOTIC_BUT_TURNED,
    "U_unstable": Word.UNSTABLE,
    "U2_strong_unstable": Word.UNSTABLE,
    "V_divergence": Word.UNSTABLE,
    # The damper does not feel one mode, but K > 0 and D >= 0: stable by Routh's theorem with dissipation (see below).
    "D_degenerate_lambda_eq_omega": Word.STABLE_BUT_CYCLIC,
}


def at_set(path: Any, name: str) -> Analysis:
    given = SETS[name]
    values = {key: Fraction(given["parameters"][key]) for key in ("s", "rho", "e")}
    values |= {"p2": Fraction(given["p2=kappa/e"]), "dc": Fraction(given["delta_c"])}
    values |= {"omega": Fraction(given["omega0"]), "Lambda": Fraction(given["lambda"])}
    system = mbsym.load(path).system
    dependent = {item.name for item in system.relations}
    kept = tuple(p for p in system.parameters if p.name not in dependent)
    assert {p.name for p in kept} >= values.keys()
    open_ = tuple(replace(p, value=None) if p.name in dependent else p for p in system.parameters)
    return Analysis(with_values(replace(system, parameters=open_), values))


@BOTH
@pytest.mark.parametrize("name", SETS)
def test_the_six_sets_get_the_right_verdicts(path: Any, name: str) -> None:
    a = at_set(path, name)
    assert set(SETS) == set(VERDICTS)
    assert a.stability.numerical is not None
    assert a.stability.numerical.word == VERDICTS[name]
    assert (VERDICTS[name] == Word.ASYMPTOTIC_BUT_TURNED) == SETS[name]["RH_stable_exact"]


@BOTH
def test_the_degenerate_set_has_a_minimum_of_energy(path: Any) -> None:
    """What the theorem needs, by the eigenvalues of K and D: K > 0, D >= 0, N = 0; roots on the axis beside +- i."""
    a = at_set(path, "D_degenerate_lambda_eq_omega")
    point = part(a).theory.at_point
    assert point is not None
    assert point.verdict.word == Word.STABLE
    assert a.stability.numerical is not None
    assert a.stability.numerical.theorem == "Routh"
    values = parameter_values(a.parameters_scene, a.equilibrium)
    found = part(a)
    at = {name: arb(fmpq(x.numerator, x.denominator)) for name, x in values.items()}
    numbers = dict.fromkeys(a.ring.names(), arb(0)) | at
    k, d, n = (
        np.array([[float(a.ring.evaluate(x, numbers).mid()) for x in row] for row in found.matrices[i].polynomials])
        for i in (3, 1, 4)
    )
    assert min(np.linalg.eigvalsh(k)) > 0.01
    assert min(np.linalg.eigvalsh(d)) > -1e-12
    assert max(np.linalg.eigvalsh(d)) > 0.01
    assert not n.any()


@BOTH
@pytest.mark.parametrize("name", SETS)
def test_characteristic_polynomials_of_the_six_sets(path: Any, name: str) -> None:
    point = part(at_set(path, name)).theory.at_point
    rate = Fraction(SETS[name]["omega0"]) ** 2
    quotient, rest = divmod(
        fmpq_poly(list(point.characteristic)), fmpq_poly([fmpq(rate.numerator, rate.denominator), 0, 1])
    )
    assert rest == 0
    expected = [Fraction(x) for x in SETS[name]["charpoly_a0..a4"]]
    assert [Fraction(int(c.p), int(c.q)) for c in reversed(quotient.coeffs())] == [x / expected[0] for x in expected]


def test_verdicts_of_the_shipped_descriptions() -> None:
    """They carry the numbers of set S, and physical and reduced parameters agree."""
    for path in (FREE, DRIVEN):
        a = mbsym.load(path)
        values = {p.name: p.value for p in a.system.parameters}
        assert None not in values.values()
        numbers = Rationals({}, {})
        exact = {name: Lowering(numbers, {})(x) for name, x in values.items() if x is not None}
        for item in a.system.relations:
            assert Lowering(numbers, exact)(item.value) == exact[item.name]
        assert a.stability.numerical is not None
        assert a.stability.numerical.word == Word.ASYMPTOTIC_BUT_TURNED
        assert not any(check.failed for check in a.checks)


# --- when a spin is free ---


def spun(change: Mapping[str, str]) -> System:
    text = FREE.read_text(encoding="utf-8")
    for old, new in change.items():
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return mbsym.loads(text).system


def test_the_free_spin_is_recognised() -> None:
    found = free_spin(mbsym.load(FREE).system)
    assert found is not None
    assert (found.coordinate, found.tilts) == ("c", ("a", "b"))
    inner = {
        "loads:\n": "loads:\n  - torque: {body: rotor, components: [0, 0, k], axes: carrier, reaction on: carrier}\n"
    }
    assert free_spin(spun(inner)) is not None


@pytest.mark.parametrize(
    "load",
    [
        "uniform gravity: {acceleration: k, direction: [0, 0, -1]}",
        "force function: k*a**2",
        "rayleigh: cd*(a_dot - z_dot)**2/2",
        "generalized force: {b: -k}",
        "damper: {coordinate: a, coefficient: cd}",
        "spring: {between: [{body: particle, point: [0, 0, 0]}, {body: 0, point: [1, 0, 0]}], stiffness: k, length: 0}",
        "force: {body: particle, point: [0, 0, 0], components: [k, 0, 0], axes: 0}",
        "torque: {body: carrier, components: [0, 0, k], axes: 0}",
    ],
)
def test_a_load_that_knows_space_binds_the_spin(load: str) -> None:
    assert free_spin(spun({"loads:\n": f"loads:\n  - {load}\n"})) is None


def test_a_second_body_on_the_ground_binds_the_spin() -> None:
    other = "  - {name: post, attached to: 0, mass: mu, connection point: [0, 0, w], coordinates: [w]}\n"
    assert free_spin(spun({"\nloads:\n": f"\n{other}\nloads:\n"})) is None


# --- the kernel ---

CONTEXT = fmpq_mpoly_ctx.get(["x"], "degrevlex")
PLAIN = Signs(CONTEXT, ("positive",))


def matrix(rows: Any) -> Any:
    return tuple(tuple(CONTEXT.constant(fmpq(x) if isinstance(x, int) else x) for x in row) for row in rows)


def linear(m: Any, d: Any, g: Any, k: Any, n: Any, **more: Any) -> LinearSystem:
    return LinearSystem(*(matrix(x) for x in (m, d, g, k, n)), **more)


def test_roots_of_turned_spins_are_struck_only_where_they_are() -> None:
    """x1, x2: plane oscillator that must not be judged; x3 damped; the rate of the spin is 2."""
    zero = [[0] * 3] * 3
    m = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    d = [[0, 0, 0], [0, 1, 0], [0, 0, 1]]
    k = [[4, 0, 0], [0, 1, 0], [0, 0, 1]]
    one, four = CONTEXT.constant(1), CONTEXT.constant(4)
    plain = linear(m, d, zero, k, zero)
    struck = linear(m, d, zero, k, zero, turned=(one, four))
    other = linear(m, d, zero, k, zero, turned=(one, one * 9))
    assert analyse(plain, PLAIN).verdict.word != Word.ASYMPTOTIC_BUT_TURNED
    assert verdict_at(plain, {}).verdict.word == Word.CRITICAL
    assert analyse(struck, PLAIN).verdict.word == Word.ASYMPTOTIC_BUT_TURNED
    assert verdict_at(struck, {}).verdict.word == Word.ASYMPTOTIC_BUT_TURNED
    assert verdict_at(other, {}).verdict.word == Word.CRITICAL
    twice = linear(
        m, [[0, 0, 0], [0, 0, 0], [0, 0, 1]], zero, [[4, 0, 0], [0, 4, 0], [0, 0, 1]], zero, turned=(one, four)
    )
    assert verdict_at(twice, {}).verdict.word == Word.CRITICAL  # only one pair belongs to the spin
    assert analyse(twice, PLAIN).verdict.word != Word.ASYMPTOTIC_BUT_TURNED


def test_constant_momenta_do_not_spoil_asymptotic_stability() -> None:
    nothing = [[0]]
    idle = linear([[1]], nothing, nothing, nothing, nothing, conservative=True, cyclic=(0,))
    damped = linear([[1]], [[1]], nothing, [[1]], nothing, conservative=True)
    free, settled = (verdict_at(system, {}).verdict for system in (idle, damped))
    assert (free.word, settled.word) == (Word.STABLE_BUT_CYCLIC, Word.ASYMPTOTIC)
    assert combine([free, settled]).word == Word.ASYMPTOTIC_BUT_CYCLIC
    assert combine([free, Verdict(Word.ASYMPTOTIC_BUT_TURNED)]).word == Word.ASYMPTOTIC_BUT_TURNED
    assert combine([free, Verdict(Word.UNSTABLE), settled]).word == Word.UNSTABLE
    undamped = linear([[1]], nothing, nothing, [[1]], nothing, conservative=True)
    assert combine([verdict_at(undamped, {}).verdict, settled]).word == Word.CRITICAL  # as before


def test_cyclic_coordinates_are_ignored_beside_dissipation() -> None:
    """det of the whole = lambda^2k det(M_cc)^(1 - r) det(reduced) for k cyclic and r other coordinates."""
    source = random.Random(3)
    n, cyclic = 5, (1, 3)

    def square(skew: bool, bare: bool) -> list[list[int]]:
        rows = [[0] * n for _ in range(n)]
        for i in range(n):
            for j in range(i):
                if not (bare and (i in cyclic or j in cyclic)) and not (skew and i in cyclic and j in cyclic):
                    rows[i][j] = source.randint(-3, 3)
                    rows[j][i] = -rows[i][j] if skew else rows[i][j]
            if not skew and not (bare and i in cyclic):
                rows[i][i] = source.randint(9, 14)
        return rows

    m, d, g = square(False, False), square(False, True), square(True, False)
    k, circulatory = square(False, True), square(True, True)
    whole = linear(m, d, g, k, circulatory, conservative=False, cyclic=cyclic)
    reduced = ignoring_cyclic(whole)
    block = fmpq_mat(2, 2, [m[i][j] for i in cyclic for j in cyclic]).det()
    for point in (fmpq(1, 3), fmpq(-2), fmpq(5, 7)):
        values = []
        for system in (whole, reduced):
            parts = [
                [[fmpq(x.coefficient(0)) if x != 0 else fmpq(0) for x in row] for row in y] for y in system.matrices
            ]
            size = system.size
            entries = [
                point**2 * parts[0][i][j] + point * (parts[1][i][j] + parts[2][i][j]) + parts[3][i][j] + parts[4][i][j]
                for i in range(size)
                for j in range(size)
            ]
            values.append(fmpq_mat(size, size, entries).det())
        assert values[0] * block ** (reduced.size - 1) == point**4 * values[1]


INCLINED = """
mbsym: 1
name: Body with a damper in an inclined tube
parameters: [C, k, cd]
bodies:
  - name: carrier
    attached to: 0
    rotation: {axes: [3, 1, 2], angles: [c, a, b]}
    mass: 0
    inertia about: joint
    inertia: [[10, 0, 1/2], [0, 11, 0], [1/2, 0, C]]
  - {name: particle, attached to: carrier, connection point: [1 + z, 0, 1/2 + z], mass: 1, coordinates: [z]}
loads:
  - spring: {coordinate: z, stiffness: k, rest: -1/k}
  - damper: {coordinate: z, coefficient: cd}
motion: {c: {value: 0, rate: 1}, a: 0, b: 0, z: 0}
"""


@pytest.mark.parametrize(("moment", "word"), [(15, Word.ASYMPTOTIC_BUT_TURNED), (5, Word.UNSTABLE)])
def test_a_spin_that_the_damper_is_coupled_to_is_judged_after_routh(moment: int, word: str) -> None:
    """Energy is dissipated at constant momentum: only the spin about the axis of the largest moment is stable."""
    a = mbsym.loads(INCLINED + f"values: {{C: {moment}, k: 40, cd: 0.4}}\n")
    assert a.equilibrium.satisfied
    (whole,) = a.stability.subsystems
    assert whole.coordinates == ("c", "a", "b", "z")
    assert a.stability.numerical is not None
    assert a.stability.numerical.word == word
    point = whole.theory.at_point
    assert point is not None
    roots = count_roots(point.characteristic)
    assert roots == point.roots
    assert (roots.zero, roots.imaginary) == (2, 2)  # c and its momentum; the direction of the axis
    assert (roots.right > 0) == (word == Word.UNSTABLE)


def test_trajectory_rows_start_where_the_descriptions_start() -> None:
    rows = REFERENCE["trajectories"]["S_stable"]["rows"]
    times = [row["t"] for row in rows]
    assert all(first < second for first, second in pairwise(times))
    initial = REFERENCE["trajectories"]["S_stable"]["initial"]
    system = mbsym.load(FREE).system
    given = {item.coordinate: item for item in system.initial}
    assert (initial["omega"], initial["omega1"]) == ("1", "1/10")
    assert given["c"].velocity == parsed(initial["omega"])
    assert given["a"].velocity == parsed("0.1")
    assert all(given[name].position == parsed("0") for name in system.coordinates)


@BOTH
def test_claims_about_stability_hold(path: Any) -> None:
    text = path.read_text(encoding="utf-8")
    found = {item.claim.place: item.outcome for item in mbsym.loads(text).claims}
    assert found.keys() == {"inclination and particle", "Hurwitz", "no divergence"}
    assert all("holds" in outcome for outcome in found.values())
    lost = text.replace("that: e*dc**2*Lambda*(Lambda + omega)", "that: e*dc**2*(Lambda + omega)")
    assert lost != text
    assert "holds" not in {item.claim.place: item.outcome for item in mbsym.loads(lost).claims}["Hurwitz"]
