"""Two tethered satellites (Fenili & Mazzariol) against an independent derivation, and the slips of the paper's eq. (3).

``references/tethered-satellites.json``: mass matrix and Euler-Lagrange residuals at sample points, trajectories
certified to 28 digits with energy and momenta, the end B at the initial state; from the geometry, by other programs.
"""

from __future__ import annotations

from fractions import Fraction

import pytest
from conftest import SHIPPED, agrees, ball, precision, reference
from flint import arb, fmpq

import mbsym
from mbsym.algebra.base import Lowering
from mbsym.algebra.certainty import Certainty
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.point import Balls, Rationals
from mbsym.analysis import Analysis
from mbsym.formulas.formula import Formula
from mbsym.mechanics.oracle import State
from mbsym.mechanics.programs import accelerated
from mbsym.problems.claims import ClaimResult, Outcome

FILE = SHIPPED / "tethered-satellites.yaml"
TEXT = FILE.read_text(encoding="utf-8")
TRUTH = reference("tethered-satellites")
#: Names of the references that differ from ours.
NAMES = {
    "mA": "m_A",
    "mB": "m_B",
    "dAC": "d_AC",
    "dEB": "d_EB",
    "dC": "d_Ccm1",
    "dD": "d_Dcm2",
    "IA": "I_A",
    "IB": "I_B",
}
NAMES["dcmAC"] = "d_cmAC"
COORDINATES = ("x_A", "y_A", "theta1", "theta2", "alpha1", "alpha2")


@pytest.fixture(scope="module")
def tether() -> Analysis:
    return mbsym.load(FILE)


@pytest.fixture(scope="module")
def apart() -> Analysis:
    """The system with d_cmAC (of rod 1) and d_AC (of the rest) told apart, as the formulas of the paper do."""
    text = TEXT.replace("  dcmAC", "  d_cmAC")
    for old, new in (
        ("  d_cmAC: d_AC # Table 1: the same\n", ""),
        ("\nbodies:", "  d_cmAC: {positive: true, value: 1}\n\nbodies:"),
        ("connection point: [d_AC, 0, 0]", "connection point: [d_cmAC, 0, 0]"),
        (
            "connection point: [L1, 0, 0]",
            "connection point: [L1 + (d_AC - d_cmAC)*cos(alpha1), -(d_AC - d_cmAC)*sin(alpha1), 0]",
        ),
    ):
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return mbsym.loads(text)


def values_of(point: dict, parameters: dict) -> dict[str, arb]:
    """Balls for everything, under our names."""
    found = {NAMES.get(name, name): ball(value) for name, value in parameters.items()}
    found |= {name: ball(point["q"][name]) for name in COORDINATES}
    found |= {f"{name}_dot": ball(point["qdot"][name]) for name in COORDINATES}
    found |= {f"{name}_ddot": ball(value) for name, value in point.get("qddot", {}).items()}
    return found | {"pi": arb.pi(), "t": arb(0)}


def at(values: dict[str, arb], formula: Formula) -> arb:
    return Carrier(formula.ring, Balls(values), values)(formula.polynomial)


@pytest.mark.parametrize("k", range(3))
def test_mass_matrix_and_equations_at_sample_points(apart: Analysis, k: int) -> None:
    point = TRUTH["sample_points"][k]
    with precision(200):
        values = values_of(point, point["parameters"])
        order = [apart.system.coordinates.index(name) for name in COORDINATES]
        assert agrees(at(values, apart.energy.kinetic_energy), point["T"], 28)
        for i, row in enumerate(order):
            residual = -at(values, apart.equations.forcing[row])
            for j, column in enumerate(order):
                entry = at(values, apart.equations.mass_matrix[row, column])
                assert agrees(entry, point["mass_matrix"][i][j], 26)
                residual += entry * values[f"{COORDINATES[j]}_ddot"]
            assert agrees(residual, point["EL_residual"][i], 24)


def test_accelerations_satisfy_the_equations_of_the_geometry_exactly(tether: Analysis) -> None:
    """T = sum m_k |r_A' + sum_i s_ki f_i' e'(f_i)|^2 / 2 + sum I_i f_i'^2 / 2 in four absolute angles, in rationals."""
    tangents = {"theta1": (2, 7), "alpha1": (-3, 5), "theta2": (5, 4), "alpha2": (1, 3)}
    numbers = Rationals({name: fmpq(*t) for name, t in tangents.items()}, tether.ring.angles)
    speeds = {"x_A": (3, 2), "y_A": (-1, 5), "theta1": (2, 3), "alpha1": (-4, 7), "theta2": (1, 2), "alpha2": (5, 3)}
    values = {f"{name}_dot": fmpq(*speed) for name, speed in speeds.items()}
    values |= {name: fmpq(1, 3) for name in COORDINATES} | {"t": fmpq(0)}
    constants = {
        "m_A": (3, 1), "m_B": (7, 2), "m1": (2, 3), "m2": (5, 4), "d_Ccm1": (4, 3), "d_AC": (1, 2), "d_EB": (3, 5),
        "d_Dcm2": (6, 5), "I_A": (1, 7), "I_B": (2, 9), "I1": (8, 3), "I2": (5, 6), "L1": (11, 4), "L2": (9, 5),
    }  # fmt: skip
    p = {name: fmpq(*value) for name, value in constants.items()}
    state = accelerated(tether.system, State(numbers, values | p), tether.programs)
    sums = {0: ("theta1",), 1: ("theta2",), 2: ("theta1", "alpha1"), 3: ("theta2", "alpha2")}

    def absolute(suffix: str) -> list[fmpq]:
        return [sum((state.values[name + suffix] for name in names), fmpq(0)) for names in sums.values()]

    sine, cosine = [], []
    for names in sums.values():
        s, c = fmpq(0), fmpq(1)
        for name in names:
            t = fmpq(*tangents[name])
            s1, c1 = 2 * t / (1 + t * t), (1 - t * t) / (1 + t * t)
            s, c = s * c1 + c * s1, c * c1 - s * s1
        sine.append(s)
        cosine.append(c)
    rate, change = absolute("_dot"), absolute("_ddot")
    zero = fmpq(0)
    masses = [p["m_A"], p["m1"], p["m2"], p["m_B"]]
    arms = [
        [zero] * 4,
        [p["d_AC"], zero, p["d_Ccm1"], zero],
        [p["d_AC"], zero, p["L1"], -p["d_Dcm2"]],
        [p["d_AC"], p["d_EB"], p["L1"], -p["L2"]],
    ]
    inertias = [p["I_A"], p["I_B"], p["I1"], p["I2"]]
    horizontal, vertical = state.values["x_A_ddot"], state.values["y_A_ddot"]
    # Accelerations of the mass centres, then d'Alembert's principle for x_A, y_A and every angle.
    x = [
        horizontal - sum((s[i] * (sine[i] * change[i] + cosine[i] * rate[i] ** 2) for i in range(4)), zero)
        for s in arms
    ]
    y = [
        vertical + sum((s[i] * (cosine[i] * change[i] - sine[i] * rate[i] ** 2) for i in range(4)), zero) for s in arms
    ]
    assert sum((m * a for m, a in zip(masses, x, strict=True)), zero) == 0
    assert sum((m * a for m, a in zip(masses, y, strict=True)), zero) == 0
    for i in range(4):
        moment = inertias[i] * change[i]
        for k in range(4):
            moment += masses[k] * arms[k][i] * (-sine[i] * x[k] + cosine[i] * y[k])
        assert moment == 0


def test_momenta_and_energy_are_found_and_keep_their_certified_values(tether: Analysis) -> None:
    found = {item.name: item for item in tether.integrals}
    assert {name: item.status for name, item in found.items()} == {
        "generalised energy": Certainty.PROVED,
        "momentum of x_A": Certainty.PROVED,
        "momentum of y_A": Certainty.PROVED,
        "angular momentum about axis 3": Certainty.PROVED,
    }
    keys = {"generalised energy": "energy", "momentum of x_A": "p_x", "momentum of y_A": "p_y"}
    keys["angular momentum about axis 3"] = "L_z"
    with precision(160):
        for run in TRUTH["trajectories"].values():
            for state in run["states"]:
                values = values_of(state, run["parameters"])
                # Inertias are 2/3 m d^2 and m L^2/12 exactly; the file rounds them to 30 digits.
                for name, key in keys.items():
                    assert agrees(at(values, found[name].formula), state[key], 26), (name, state["t"])


def test_initial_values_are_those_of_the_reference(tether: Analysis) -> None:
    start = TRUTH["trajectories"]["table1"]["states"][0]
    parameters = {item.name: item.value for item in tether.system.parameters}
    with precision(160):
        lower = Lowering(Balls({}), {"pi": arb.pi()})
        for item in tether.system.initial:
            assert agrees(lower(item.position), start["q"][item.coordinate], 28)
            assert agrees(lower(item.velocity), start["qdot"][item.coordinate], 28)
        for name, value in TRUTH["trajectories"]["table1"]["parameters"].items():
            if name != "dcmAC":
                assert agrees(lower(parameters[NAMES.get(name, name)]), value, 28)


# --- what the paper prints ---


def claims_at(analysis: Analysis, place: str) -> list[ClaimResult]:
    return [result for result in analysis.claims if result.claim.place == place]


def test_the_printed_kinetic_energy_is_refuted_and_the_slips_are_named(tether: Analysis) -> None:
    (result,) = claims_at(tether, "eq. (3)")
    assert result.outcome == Outcome.DIFFERS
    assert result.refuted
    first, second = result.parts
    # c18 theta1'(alpha1' + theta1') should be c18 theta1' alpha1': c3 holds this term already.
    assert (str(first.factor), first.same_as) == ("theta1_dot**2", "c18")
    assert str(first.difference) == "m_B*d_AC*L1*cos(alpha1)"
    # c26 lacks m2 L1 d_Dcm2 sin(alpha1) sin(theta2) cos(alpha2 - theta1).
    assert str(second.factor) == "(theta2_dot + alpha2_dot)*theta1_dot"
    (name, change), *others = second.repairs
    assert (name, others) == ("c26", [])
    assert change == second.difference
    assert len(change.polynomial) == 2
    with precision(100):
        values = {name: ball(value) for name, value in {"theta1": "0.3", "alpha1": "1.1", "theta2": "-0.7"}.items()}
        values |= {"alpha2": ball("0.4"), "m2": ball("3"), "L1": ball("5"), "d_Dcm2": ball("7")}
        lacking = 105 * values["alpha1"].sin() * values["theta2"].sin() * (values["alpha2"] - values["theta1"]).cos()
        assert (at(values, change) - lacking).contains(0)


def repaired(text: str) -> str:
    """Eq. (3) with both slips corrected."""
    for wrong, right in (
        ("c18*theta1_dot*(alpha1_dot + theta1_dot)", "c18*theta1_dot*alpha1_dot"),
        (
            "c26: m2*d_Dcm2*(L1*cos(theta1)",
            "c26: m2*d_Dcm2*(L1*sin(alpha1)*sin(theta2)*cos(alpha2 - theta1) + L1*cos(theta1)",
        ),
    ):
        assert text.count(wrong) == 1
        text = text.replace(wrong, right)
    return text


def test_with_both_slips_corrected_the_kinetic_energy_holds_exactly(tether: Analysis) -> None:
    (result,) = claims_at(mbsym.loads(repaired(TEXT)), "eq. (3)")
    assert (result.outcome, result.parts, result.refuted) == (Outcome.EXACT, (), False)


@pytest.mark.parametrize(
    ("symbol", "wrong", "right"),
    [
        ("c7", "d_Dcm2**2", "d_Dcm2"),
        ("c9", "m1*(d_cmAC*sin(theta1)", "m2*(d_cmAC*sin(theta1)"),
        ("c20", "- theta2)", "+ theta2)"),
        ("c24", " + cos(theta1)", " - cos(theta1)"),
    ],
)
def test_another_planted_slip_is_named_with_its_repair(symbol: str, wrong: str, right: str) -> None:
    text = repaired(TEXT)
    (line,) = [line for line in text.splitlines() if line.startswith(f"  {symbol}: ")]
    assert line.count(wrong) == 1
    slip = line.replace(wrong, right)
    (result,) = claims_at(mbsym.loads(text.replace(line, slip)), "eq. (3)")
    assert result.outcome == Outcome.DIFFERS
    repairs = [dict(part.repairs) for part in result.parts]
    assert all(symbol in found for found in repairs)
    assert len({name for found in repairs for name in found}) <= 2  # c20 and c26 stand before the same products
    # With the repair added the claim holds: what was found is what had been planted.
    (change,) = {str(found[symbol]) for found in repairs}
    (mended,) = claims_at(mbsym.loads(text.replace(line, f"{slip} + ({change})")), "eq. (3)")
    assert mended.outcome == Outcome.EXACT


def test_positions_and_the_first_equation_hold(tether: Analysis) -> None:
    for place in ("eq. (11)", "eq. (12)", "eq. (13)"):
        (result,) = claims_at(tether, place)
        assert result.outcome == Outcome.EXACT, place


def test_printed_numbers_hold_to_their_digits_but_for_the_velocity_of_b(tether: Analysis) -> None:
    derived, printed = TRUTH["table2_B"]["derived"], TRUTH["table2_B"]["printed"]
    places = {"Table 2, x_B": "x_B", "Table 2, y_B": "y_B", "Table 2, x_B'": "xdot_B", "Table 2, y_B'": "ydot_B"}
    for place, key in places.items():
        (result,) = claims_at(tether, place)
        assert Fraction(result.claim.printed) == Fraction(str(printed[key]))
        assert abs(Fraction(result.value) - Fraction(derived[key])) < Fraction(1, 10**9)
        assert result.outcome == (Outcome.DIFFERS if key == "xdot_B" else Outcome.DIGITS)
    assert claims_at(tether, "Table 2, x_B'")[0].digits == 0


def test_the_summary_counts_them(tether: Analysis) -> None:
    held = [result for result in tether.claims if result.holds]
    refuted = [result.claim.place for result in tether.claims if result.refuted]
    assert len(held) + len(refuted) == len(tether.claims)
    assert refuted == ["eq. (3)", *["c37", "c38", "c40", "c58", "c61", "c66"], "Table 2, x_B'"]
