"""The Newtonian field of orders 2, 3, 4 and with exact distances.

Expectations: Newton's law summed over point masses in this file, the closed stiffness of a point mass on a
weightless arm (derived in the docstring of ``stiffness_of_point_mass``), the notes on the satellite with a stabilizer
("exact or any order > 2: K differs by a relative O(l/R), M and G unchanged"), and planted mistakes.
"""

from __future__ import annotations

import copy
import json
from collections.abc import Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from flint import arb, ctx, fmpq
from test_self_check import CARRIED, ORBITING, PROGRAM, SYSTEMS, Mistake, failing, failing_without_a_mistake, plant

import mbsym
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.point import Balls, Rationals
from mbsym.algebra.ring import Ring
from mbsym.analysis import Analysis
from mbsym.formulas.latex import LatexNames
from mbsym.problems import checks
from mbsym.report.language import Language
from mbsym.report.latex.labels import Form, Labels
from mbsym.report.latex.writer import Writer
from mbsym.report.words.description import load
from mbsym.source import read, to_text, to_yaml

ORDERS = [2, 3, 4, "exact"]
HIGHER = [3, 4, "exact"]
SATELLITE = (Path(__file__).parents[2] / "systems" / "satellite.yaml").read_text(encoding="utf-8")
RIGID = (Path(__file__).parents[2] / "systems" / "gravity-gradient.yaml").read_text(encoding="utf-8")
Description = dict[str, Any]


def with_order(text: str, order: int | str) -> str:
    assert text.count("order: 2") == 1
    return text.replace("order: 2", f"order: {order}")


def ordered(description: Description, order: int | str, **data: Any) -> Description:
    changed = copy.deepcopy(description)
    changed["loads"][0]["newtonian gravity"] |= {"order": order} | data
    return changed


def analysed(description: Description, problems: Sequence[int] = (1, 2, 3)) -> Analysis:
    return mbsym.loads(json.dumps(description), problems)


def balls(analysis: Analysis, values: Mapping[str, Any], formulas: Sequence[Any]) -> list[arb]:
    """Formulas at ball values; what is not named is zero."""
    known = {name: arb(0) for name in analysis.ring.names()} | {k: arb(fmpq(v)) for k, v in values.items()}
    known["pi"] = arb.pi()
    carry = Carrier(analysis.ring, Balls(known), known)
    return [carry(formula.polynomial) for formula in formulas]


# --- three independent routes agree ---

#: The centre is a body that moves itself, and the bodies react on it.
PLANET = copy.deepcopy(ORBITING)
PLANET["bodies"].insert(
    0,
    {
        "name": "planet",
        "attached to": 0,
        "connection point": ["x", 0, 0],
        "rotation": {"axes": [1], "angles": ["w"]},
        "mass": "m2",
        "inertia about": "joint",
        "inertia": [2, 3, 4],
        "coordinates": ["x", "w"],
    },
)
PLANET["loads"][0]["newtonian gravity"]["centre"] = "planet"
#: The same with the orbit carried by the planet.
MOON = copy.deepcopy(PLANET)
MOON["bodies"][1]["attached to"] = "planet"
#: A body about a fixed point away from the centre.
FIXED = copy.deepcopy(CARRIED)
FIXED["bodies"][0] = {"name": "orbit", "attached to": 0, "connection point": [0, "R", 0], "mass": 0}
del FIXED["prescribed"]

PLACES = {"free": ORBITING, "circular": CARRIED, "planet": PLANET, "moon": MOON, "fixed": FIXED}


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("place", PLACES)
def test_lagrange_newton_euler_and_dalembert_agree(place: str, order: int | str) -> None:
    found = {check.name: check.outcome for check in analysed(ordered(PLACES[place], order)).checks}
    irrational = order == "exact" or place == "planet"  # the distance is a root
    gravity = "verified numerically" if irrational else "exact"
    assert found == {
        "kinematics": "exact",
        "energy": gravity,
        "equations of motion": gravity,
        "straight-line program": gravity,
        "mass matrix": "exact",
    }


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("text", [SATELLITE, RIGID], ids=["stabilizer", "rigid"])
def test_every_check_of_the_satellites_passes(text: str, order: int | str) -> None:
    a = mbsym.loads(with_order(text, order))
    allowed = {"exact", "verified numerically"} if order == "exact" else {"exact"}
    assert {check.outcome for check in a.checks} <= allowed
    assert {"equilibrium", "linearisation", "perturbed motion", "first integrals"} <= {x.name for x in a.checks}
    # On the unperturbed motion every distance is rational, so both routes meet exactly at every order.
    assert {x.outcome for x in a.checks if x.name in ("equilibrium", "linearisation", "perturbed motion")} == {"exact"}
    assert all(x.is_zero for x in a.equilibrium.residuals)


# --- Newton's law for point masses ---


def particle(name: str, coordinates: Sequence[str], mass: str) -> Description:
    return {
        "name": name,
        "attached to": 0,
        "connection point": list(coordinates),
        "mass": mass,
        "coordinates": list(coordinates),
    }


def test_exact_is_newtons_law_for_a_particle() -> None:
    field = {"newtonian gravity": {"constant": "nu", "centre": 0, "about": 0, "order": "exact"}}
    bodies = [particle("particle", ("x", "y", "z"), "m")]
    system = {"mbsym": 1, "name": "Kepler", "parameters": ["nu", "m"], "bodies": bodies, "loads": [field]}
    a = analysed(system)
    assert not [check for check in a.checks if check.failed]
    place = {"x": 2, "y": 3, "z": 6}  # at the distance 7
    values = {name: fmpq(place.get(name, 0)) for name in a.ring.names()} | {"nu": fmpq(5), "m": fmpq(3, 2)}
    carry = Carrier(a.ring, Rationals({}, {}), values)
    assert carry(a.energy.force_function.polynomial) == fmpq(15, 14)
    assert [carry(f.polynomial) for f in a.equations.forcing] == [fmpq(-15, 2) * fmpq(x, 343) for x in (2, 3, 6)]


def test_exact_is_the_problem_of_two_bodies_where_the_centre_is_a_body() -> None:
    field = {"newtonian gravity": {"constant": "nu", "centre": "sun", "about": 0, "order": "exact"}}
    bodies = [particle("sun", ("X", "Y", "Z"), "M"), particle("earth", ("x", "y", "z"), "m")]
    system = {"mbsym": 1, "name": "two bodies", "parameters": ["nu", "m", "M"], "bodies": bodies, "loads": [field]}
    a = analysed(system)
    assert {check.outcome for check in a.checks} <= {"exact", "verified numerically"}
    place = dict(zip("XYZxyz", (1, 1, 1, 3, 4, 7), strict=True))
    values = {name: fmpq(place.get(name, 0)) for name in a.ring.names()} | {"nu": fmpq(5), "m": fmpq(2), "M": fmpq(9)}
    carry = Carrier(a.ring, Rationals({}, {}), values)
    pull = [fmpq(10 * x, 343) for x in (2, 3, 6)]
    assert [carry(f.polynomial) for f in a.equations.forcing] == [*pull, *(-x for x in pull)]


#: A rigid body of three point masses on a circular orbit, its mass centre off the orbit, in general position.
MASSES = [(fmpq(2), (1, 0, 2)), (fmpq(1), (-1, 3, 0)), (fmpq(3), (0, 1, -1))]
ANGLES = {"psi": fmpq(3, 10), "theta": fmpq(-2, 5), "phi": fmpq(7, 10)}


def cluster(order: int | str) -> Description:
    """Each mass a body of its own: here the exact field has no omitted moments."""
    bodies: list[Description] = [
        {"name": "orbit", "attached to": 0, "connection point": [0, "R", 0], "mass": 0},
        {
            "name": "hull",
            "attached to": "orbit",
            "rotation": {"axes": [2, 3, 1], "angles": list(ANGLES)},
            "mass": 0,
            "inertia about": "joint",
            "inertia": [1, 1, 1],
        },
    ]
    for number, (mass, place) in enumerate(MASSES):
        point = [f"{x}*s" for x in place]
        bodies.append({"name": f"p{number}", "attached to": "hull", "connection point": point, "mass": str(mass)})
    field = {"newtonian gravity": {"constant": 1, "centre": 0, "about": "orbit", "order": order}}
    return {"mbsym": 1, "name": "cluster", "parameters": ["R", "s"], "bodies": bodies, "loads": [field]}


def rotated(v: Sequence[arb], axis: int, angle: arb) -> list[arb]:
    """Components after an active turn about a coordinate axis."""
    i, j = axis % 3, (axis + 1) % 3  # axis 3: x and y; axis 1: y and z; axis 2: z and x
    found, s, c = list(v), angle.sin(), angle.cos()
    found[i], found[j] = c * v[i] - s * v[j], s * v[i] + c * v[j]
    return found


def summed(masses: Sequence[tuple[Any, Sequence[Any]]], size: fmpq, angles: Mapping[str, Any]) -> arb:
    """sum of m/|r| with R = 1, by Newton."""
    total = arb(0)
    for mass, place in masses:
        v = [arb(fmpq(x)) * arb(size) for x in place]
        for name, axis in (("phi", 1), ("theta", 3), ("psi", 2)):
            v = rotated(v, axis, arb(angles[name]))
        v[1] += 1
        total += arb(mass) / sum((x * x for x in v), arb(0)).sqrt()
    return total


def slopes(masses: Sequence[tuple[Any, Sequence[Any]]], size: fmpq) -> list[arb]:
    """The derivatives of ``summed`` with respect to the angles: central differences with a step far below the error."""
    h, found = arb(2) ** -300, []
    for name in ANGLES:
        up, down = ({k: arb(v) + sign * h * (k == name) for k, v in ANGLES.items()} for sign in (1, -1))
        found.append((summed(masses, size, up) - summed(masses, size, down)) / (2 * h))
    return found


def order_of(errors: Sequence[arb]) -> Fraction:
    """log2 of the quotient of the errors at two sizes, one twice the other; it must be nearly whole."""
    quotient = float((errors[0] / errors[1]).log() / arb(2).log())
    assert abs(quotient - round(quotient)) < 0.1
    return Fraction(round(quotient))


@pytest.mark.parametrize("order", ORDERS)
def test_the_error_decreases_with_the_order(order: int | str) -> None:
    """U and its generalised forces of order N err by (size/R)^(N + 1) against Newton's law; exactly 0 for exact."""
    a = analysed(cluster(order))
    with ctx.workprec(1200):
        energies, forces = [], []
        for size in (fmpq(1, 1000), fmpq(1, 2000)):
            values = ANGLES | {"R": fmpq(1), "s": size}
            found = balls(a, values, [a.energy.force_function, *a.equations.forcing])
            energies.append(abs(found[0] - summed(MASSES, size, ANGLES)))
            wanted = slopes(MASSES, size)
            forces.append([abs(x - y) for x, y in zip(found[1:], wanted, strict=True)])
        if order == "exact":
            assert all(error < arb(2) ** -500 for error in energies)
            assert all(error < arb(2) ** -500 for pair in forces for error in pair)
        else:
            assert order_of(energies) == int(order) + 1
            about_the_radius, *others = zip(*forces, strict=True)  # turning about the radius changes nothing
            assert all(error < arb(2) ** -500 for error in about_the_radius)
            assert {order_of(pair) for pair in others} == {int(order) + 1}


def body_of(masses: Sequence[tuple[Any, Sequence[int]]], order: int | str) -> Description:
    """The cluster as one body with mass centre and inertia."""
    total = sum((m for m, _ in masses), fmpq(0))
    centre = [sum((m * p[i] for m, p in masses), fmpq(0)) / total for i in range(3)]
    inertia = [
        [sum((m * (sum(x * x for x in p) * (i == j) - p[i] * p[j]) for m, p in masses), fmpq(0)) for j in range(3)]
        for i in range(3)
    ]
    description = cluster(order)
    description["bodies"] = description["bodies"][:2]
    description["bodies"][1] |= {
        "mass": str(total),
        "mass centre": [f"{x}*s" for x in centre],
        "inertia": [[f"{x}*s**2" for x in row] for row in inertia],
    }
    return description


@pytest.mark.parametrize(("order", "expected"), [(2, 3), (3, 4), (4, 5), ("exact", 5)])
def test_an_extended_body_whose_third_central_moments_vanish(order: int | str, expected: int) -> None:
    """Symmetric about its centre, the body is given by its second moments up to the third order.

    Against its own masses the fourth central moments are missing from the fourth degree on; against the exact field of
    the same moments order 4 errs in the fifth degree.
    """
    # pairs of equal masses on both sides of the centre (1, 2, -1)
    masses = [
        (fmpq(m), tuple(a + sign * b for a, b in zip((1, 2, -1), offset, strict=True)))
        for m, offset in ((1, (1, 0, 2)), (2, (0, 3, 1)), (1, (2, 1, 0)))
        for sign in (1, -1)
    ]
    a, exact = analysed(body_of(masses, order)), analysed(body_of(masses, "exact"))
    with ctx.workprec(600):
        against_masses, against_exact = [], []
        for size in (fmpq(1, 1000), fmpq(1, 2000)):
            values = ANGLES | {"R": fmpq(1), "s": size}
            value = balls(a, values, [a.energy.force_function])[0]
            against_masses.append(abs(value - summed(masses, size, ANGLES)))
            against_exact.append(abs(value - balls(exact, values, [exact.energy.force_function])[0]))
        assert order_of(against_masses) == min(expected, 4)
        if order != "exact":
            assert order_of(against_exact) == expected


# --- the satellite with a stabilizer ---

NUMBERS = {"R": 50, "omega0": 2, "nu": 500000, "M2": 10, "m0": 3, "l": 2, "r": 1, "Jx": 7, "Jy": 5, "Jz": 6}


def linear(order: int | str, **values: Any) -> dict[str, list[list[fmpq]]]:
    a = mbsym.loads(with_order(SATELLITE, order), (5,))
    known = {name: fmpq(0) for name in a.ring.names()} | {k: fmpq(v) for k, v in (NUMBERS | values).items()}
    carry = Carrier(a.ring, Rationals({}, a.ring.angles), known)
    found = zip("MDGKN", a.linearisation.matrices, strict=True)
    return {name: [[carry(x) for x in row] for row in matrix.polynomials] for name, matrix in found}


def stiffness_of_point_mass(order: int | str) -> dict[str, fmpq]:
    """K of a point mass m0 on a weightless rod, worked out by hand.

    At the distance |r| from the centre the mass has (centrifugal) + (gravity) = w^2 S/2 - w^2 n^2/2 + w^2 R^3 S^(-1/2)
    with S = |r|^2 and n its height over the plane of the orbit.  S is stationary at rest, with

        S_(theta theta) = -2 R (r + l),  S_(theta delta) = -2 R l,  S_(delta delta) = S_(sigma sigma) = -2 l (R + r).

    So K = -m0 w^2 S''/2 (1 - R^3/|r|^3) (+ m0 w^2 l^2 for sigma, from n = l sigma), |r| = R + r + l =: R (1 + h).
    The expansion is 1 - (1 + h)^-3 = 3 h - 6 h^2 + 10 h^3 - ...; order N keeps the powers of 1/R in K up to N - 2.
    """
    R, w, m0, l, r = (fmpq(NUMBERS[x]) for x in ("R", "omega0", "m0", "l", "r"))
    h = (r + l) / R
    if order == "exact":
        over_r = plain = 1 - 1 / (1 + h) ** 3
    else:
        series = [3 * h, -6 * h**2, 10 * h**3]
        over_r = sum(series[: int(order) - 1], fmpq(0))  # multiplied by R, which takes one power of 1/R away
        plain = sum(series[: int(order) - 2], fmpq(0))
    swing = m0 * w**2 * l * (R * over_r + r * plain)
    return {
        "theta theta": m0 * w**2 * R * (r + l) * over_r,
        "theta delta": m0 * w**2 * R * l * over_r,
        "delta delta": swing,
        "sigma sigma": swing + m0 * w**2 * l**2,
    }


@pytest.mark.parametrize("order", ORDERS)
def test_the_stiffness_of_a_point_mass_on_a_weightless_rod(order: int | str) -> None:
    K, expected = linear(order, m=0)["K"], stiffness_of_point_mass(order)
    psi, theta, phi, delta, sigma = range(5)
    hull = 3 * fmpq(4) * (7 - 5)  # 3 w^2 (Jx - Jy) of the satellite itself
    assert K[theta][theta] == expected["theta theta"] + hull
    assert K[theta][delta] == K[delta][theta] == expected["theta delta"]
    assert K[delta][delta] == expected["delta delta"]
    assert K[sigma][sigma] == expected["sigma sigma"]
    assert K[theta][phi] == K[psi][delta] == 0


@pytest.mark.parametrize("order", HIGHER)
def test_only_the_stiffness_depends_on_the_order(order: int | str) -> None:
    """The notes, 1.3: M and G are the paper's at every order, and K differs by a relative O(l/R)."""
    paper, found = linear(2, m=1), linear(order, m=1)
    assert all(found[name] == paper[name] for name in "MDGN")
    assert found["K"] != paper["K"]
    far, farther = (
        [
            (x - y) * radius
            for row, other in zip(linear(order, m=1, R=radius)["K"], paper["K"], strict=True)
            for x, y in zip(row, other, strict=True)
        ]
        for radius in (10**6, 10**9)
    )
    for x, y in zip(far, farther, strict=True):  # (K - K_2) R tends to a limit, zero only where K_2 itself is zero
        assert (x == y == 0) or abs(x / y - 1) < fmpq(1, 10**4)
    assert any(far)


def test_orders_agree_for_a_body_whose_mass_centre_is_on_the_orbit() -> None:
    """c = 0: MacCullagh's formula stops at the second degree."""
    found = {str(mbsym.loads(with_order(RIGID, order), (5,)).linearisation.K) for order in ORDERS}
    assert len(found) == 1


def test_a_sign_that_is_not_known_keeps_the_result_honest() -> None:
    """Where r may be negative, sqrt((R + r + l)^2) is not R + r + l: nothing fails, and nothing is made up."""
    a = mbsym.loads(with_order(SATELLITE, "exact").replace("r: {sign: nonnegative", "r: {sign: real"), (1, 2, 3, 4, 5))
    assert {check.outcome for check in a.checks} <= {"exact", "verified numerically"}
    assert "sqrt" in str(a.linearisation.K)


def test_equality_behind_roots_is_numerical_or_wrong_never_exact() -> None:
    ring = Ring([], [], ["a", "b"], {}, positive=["b"], nonnegative=[])
    a, b = ring.generator("parameter", "a"), ring.generator("parameter", "b")
    root = ring.square_root((a + b) * (a + b))
    assert checks._vanishing(ring, root - a - b) == "verified numerically"
    assert checks._vanishing(ring, root + a + b) == "FAILED"
    assert checks._vanishing(ring, ring.square_root(-b) - ring.square_root(-b)) == "exact"
    hidden = ring.square_root(-((a + b) * (a + b)))  # nowhere real
    assert checks._vanishing(ring, hidden - a) == "undecided"


def test_a_nonnegative_parameter_comes_out_of_a_root() -> None:
    ring = Ring([], [], ["a", "b", "c"], {}, positive=["b"], nonnegative=["a"])
    a, b, c = (ring.generator("parameter", name) for name in "abc")
    assert ring.square_root((a + b) * (a + b)) == a + b
    assert not ring.is_positive(a)
    assert not ring.is_positive(b + c)
    assert ring.square_root((b + c) * (b + c)) != b + c


# --- planted mistakes ---

MORE = "mechanics.loads.newtonian_orders"
PLANTED = [
    (
        3,
        MORE + ":gegenbauer",
        "Fraction(2 * k + exponent - 2, k)",
        "Fraction(2 * k + exponent, k)",
        "equations of motion",
    ),
    (4, MORE + ":gegenbauer", "-ahead - behind", "-ahead + behind", "equations of motion"),
    (3, MORE + ":order_force_function", "(-1) ** degree", "1", "equations of motion"),
    (3, MORE + ":_spread", "(-3, ec, one)", "(3, ec, one)", "equations of motion"),
    (3, MORE + ":_spread", "(15 * half, x, ee)", "(9 * half, x, ee)", "equations of motion"),
    (4, MORE + ":_spread", "(15, x, ec)", "(12, x, ec)", "equations of motion"),
    (4, MORE + ":_spread", "(-3 * half, cc, one)", "(3 * half, cc, one)", "equations of motion"),
    (4, MORE + ":_spread", "(half, pair, t)", "(-half, pair, t)", "equations of motion"),
    (3, MORE + ":gegenbauer", "algebra.number(-exponent)", "algebra.number(exponent)", PROGRAM),
    (4, MORE + ":gegenbauer", "Fraction(k + exponent - 2, k)", "Fraction(k + exponent - 1, k)", PROGRAM),
    (4, MORE + ":_Expansion.torque", "self.fifth[k - 2]", "self.fifth[k - 1]", PROGRAM),
    (3, MORE + ":_Expansion.torque", "algebra.number(3)", "algebra.number(2)", PROGRAM),
    (4, MORE + ":_Expansion.force", "Fraction(15, 2)", "Fraction(15, 4)", PROGRAM),
    (3, MORE + ":order_action", "else 0, order):", "else 0, order - 1):", PROGRAM),
    (4, MORE + ":order_action", "left * factors[order + 1]", "left * factors[order]", PROGRAM),
    ("exact", MORE + ":_exact_force_function", "Fraction(1, 2)", "Fraction(1, 3)", "equations of motion"),
    ("exact", MORE + ":_exact_action", "algebra.number(5)", "algebra.number(3)", PROGRAM),
    ("exact", MORE + ":_exact_action", "r.cross(turned)", "turned.cross(r)", PROGRAM),
]


@pytest.mark.parametrize(("order", "where", "right", "wrong", "caught"), PLANTED)
def test_a_planted_mistake_is_caught(
    monkeypatch: pytest.MonkeyPatch, order: int | str, where: str, right: str, wrong: str, caught: str
) -> None:
    name = f"free orbit, order {order}"
    monkeypatch.setitem(SYSTEMS, name, (ordered(ORBITING, order), (1, 2, 3)))
    assert not failing_without_a_mistake(name)
    plant(monkeypatch, Mistake("", where, right, wrong, name, (caught,)))
    assert caught in failing(name)


def test_a_missing_reaction_on_the_centre_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(SYSTEMS, "moon", (ordered(MOON, 3), (1, 2, 3)))
    where = "mechanics.loads.orbit:completed"
    plant(monkeypatch, Mistake("", where, "    if centre_moves:\n", "    if False:\n", "moon", (PROGRAM,)))
    assert PROGRAM in failing("moon")


# --- descriptions ---


@pytest.mark.parametrize("order", ORDERS)
def test_both_spellings_keep_the_order(order: int | str) -> None:
    system, complaints = read(with_order(SATELLITE, order), "x.yaml")
    assert system is not None
    assert not complaints
    assert system.loads[0].order == order  # type: ignore[union-attr]
    for text, name in ((to_yaml(system), "x.yaml"), (to_text(system), "x.txt")):
        assert read(text, name)[0] == system
        assert str(order) in text


@pytest.mark.parametrize("value", ["0", "1", "5", "2.5", "foo", "99999", "-2", "2.0", "[2]", "exakt", "''", "9" * 500])
def test_other_orders_are_refused(value: str) -> None:
    text = with_order(SATELLITE, value)
    system, complaints = read(text, "x.yaml")
    assert system is None
    (complaint,) = complaints
    assert complaint.severity == "error"
    line = 1 + text[: text.index("newtonian gravity")].count("\n")
    assert complaint.span is not None
    assert complaint.span.line == line
    assert len(complaint.message) < 200
    assert "'order'" in complaint.message
    if value not in ("[2]", "''"):
        guess = {"exakt": "exact", "-2": "2"}.get(value)
        assert complaint.hint == ("one of: 2, 3, 4, exact" if guess is None else f"did you mean '{guess}'?")


def test_only_the_exact_field_may_have_the_centre_as_its_frame() -> None:
    text = with_order(SATELLITE, "exact").replace("about: orbital frame", "about: 0")
    assert read(text, "x.yaml")[0] is not None
    refused, complaints = read(text.replace("order: exact", "order: 4"), "x.yaml")
    assert refused is None
    assert next(iter(complaints)).hint == "only with order: exact the field is not expanded"


def test_the_schema_knows_the_orders() -> None:
    jsonschema, yaml = pytest.importorskip("jsonschema"), pytest.importorskip("yaml")
    validator = jsonschema.Draft202012Validator(mbsym.source.json_schema())
    for order in ORDERS:
        validator.validate(yaml.safe_load(with_order(SATELLITE, order)))
    assert not validator.is_valid(yaml.safe_load(with_order(SATELLITE, 5)))
    assert not validator.is_valid(yaml.safe_load(with_order(SATELLITE, "foo")))


@pytest.mark.parametrize(
    ("order", "there", "absent"),
    [(2, "\\frac{\\nu}{R^3}", "R^4"), (3, "\\frac{\\nu}{R^4}", "R^5"), (4, "35 x^4", "|r|"), ("exact", "|r|", "R^3")],
)
def test_the_report_states_the_field(order: int | str, there: str, absent: str) -> None:
    a = mbsym.loads(with_order(SATELLITE, order), (1,))
    writer = Writer(LatexNames(a.ring.names()), Language("en"), Labels(""), Form.REPORT)
    text = writer.document(load(a.system.loads[0]))
    assert there in text
    assert absent not in text
