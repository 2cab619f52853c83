"""Units: the paper passes with its units, every slip of dimension is found, nothing changes without them."""

from __future__ import annotations

import random
import re
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import pytest
from conftest import system_of

from mbsym.model.units import ENERGY, LENGTH, MASS, TIME, Units, times, written
from mbsym.source import read, to_text, to_yaml
from mbsym.source.units.reading import COMMON, Unit, unit
from mbsym.source.units.system import Form, Inference

ROOT = Path(__file__).parents[2]

#: The units of the paper's symbols, from what they are.
SATELLITE = """
units:
  R: m
  omega0: 1/s
  nu: m^3/s^2
  M2: kg
  m: kg
  m0: kg
  l: m
  r: m
  Jx: kg*m^2
  Jy: kg*m^2
  Jz: N*m*s^2
  psi: rad
"""


def codes(text: str) -> list[str]:
    _, complaints = read(text, "x.yaml")
    return [one.code for one in complaints.items]


def with_units() -> str:
    return (ROOT / "systems" / "satellite.yaml").read_text(encoding="utf-8") + SATELLITE


def test_the_satellite_of_the_paper_is_consistent_and_its_notation_gets_its_dimensions() -> None:
    system, complaints = read(with_units(), "x.yaml")
    assert system is not None, [one.message for one in complaints]
    assert not complaints.items
    units = system.units
    # What the paper says: a, b, c, d, f are moments of inertia, alpha, gamma, p1, p2 are numbers.
    assert {name: units.of(name) for name in "abcdf"} == dict.fromkeys("abcdf", "kg*m^2")
    assert {units.of(name) for name in ("alpha", "gamma", "p1", "p2")} == {""}
    assert {units.of(name) for name in ("theta", "phi", "delta", "sigma", "chi")} == {""}
    assert units.rate_of("psi") == "rad/s"
    assert units.of("Jz") == "N*m*s^2"


def products(text: str) -> list[tuple[int, int]]:
    """Where in the formulas of loads, relations, notation and inertias a symbol with a dimension could be lost."""
    return [match.span() for match in re.finditer(r"\b(?:m|m0|l|r|R|omega0|M2|J[xyz])\b(?:\*\*[23])?\*", text)]


def test_a_lost_factor_is_found() -> None:
    """Every product of the satellite's notation and relations loses a symbol in turn: each is a slip of dimension."""
    text = with_units()
    start, end = text.index("\nnotation:"), text.index("\nassumptions:")
    places = [(a, b) for a, b in products(text) if start < a < end]
    assert len(places) >= 7
    for a, b in places:
        assert "dimension" in codes(text[:a] + text[b:]), text[a - 20 : b + 20]


def test_without_units_nothing_changes_and_nothing_is_loaded() -> None:
    text = (ROOT / "systems" / "satellite.yaml").read_text(encoding="utf-8")
    plain = system_of(text, "x.yaml")
    assert plain.units == Units()
    assert not plain.units
    assert "unit" not in to_yaml(plain)
    assert codes(text.replace("a: Jy", "a: Jy*l")) == []
    script = "import sys, mbsym; mbsym.load(sys.argv[1]); assert 'pint' not in sys.modules"
    subprocess.run([sys.executable, "-c", script, str(ROOT / "systems" / "satellite.yaml")], check=True)


@pytest.mark.parametrize("write", [to_yaml, to_text])
def test_units_survive_both_spellings(write: object) -> None:
    system = system_of(with_units(), "x.yaml")
    assert callable(write)
    again, complaints = read(write(system), "x.txt" if write is to_text else "x.yaml")
    assert again == system, [one.message for one in complaints]
    assert again is not None
    assert [one.text for one in again.units.declared] == [one.text for one in system.units.declared]


@pytest.mark.parametrize(
    ("text", "factor", "dimension"),
    [
        ("kg*m^2", 1, {"kg": 1, "m": 2}),
        ("N*m/rad", 1, {"kg": 1, "m": 2, "s": -2}),
        ("km/h", Fraction(1000, 3600), {"m": 1, "s": -1}),
        ("g", Fraction(1, 1000), {"kg": 1}),
        ("1/s", 1, {"s": -1}),
        ("1", 1, {}),
        ("kg m", 1, {"kg": 1, "m": 1}),
    ],
)
def test_units_are_those_of_physics(text: str, factor: Fraction, dimension: dict[str, int]) -> None:
    found = unit(text)
    assert isinstance(found, Unit)
    assert float(found.factor) == pytest.approx(float(factor))
    assert dict(found.dimension) == dimension


@pytest.mark.parametrize(
    "text",
    [
        '__import__("os")', "kg**99999999", "2*kg", "kg+m", "Nm", "", "k" * 100, "kg*", "(" * 50,
        "9**9**9**9", "m^9^9^9^9", "m*1e99999999", "10**9**9*m", "((((((in/ft)^20)^20)^20)^20)^20)", "m**(1/0)",
    ],
)  # fmt: skip
def test_what_is_no_unit_is_refused_at_once(text: str) -> None:
    assert isinstance(unit(text), str)


@pytest.mark.parametrize(
    ("text", "meant"),
    [("Nm/rad", "N*m/rad"), ("Nms/rad", "N*m*s/rad"), ("kg m2", "kg m^2"), ("m/s2", "m/s^2"), ("ms^-2", "m/s^2")],
)
def test_what_engineers_write_is_answered_with_what_they_mean(text: str, meant: str) -> None:
    _, complaints = read(with_units().replace("R: m", f"R: {text}"), "x.yaml")
    (one,) = [one for one in complaints.items if one.code == "bad-unit"]
    assert one.hint == f"did you mean '{meant}'?"


def test_slips_of_dimension_are_told_with_all_other_complaints() -> None:
    text = with_units().replace("a: Jy", "a: Jy*l", 1).replace("nu: omega0**2*R**3", "nu: omega0**2*R**2")
    text = text.replace("R*sin(chi), R*cos(chi)", "R*sin(chi), q*cos(chi)", 1)
    _, complaints = read(text, "x.yaml")
    assert "unknown-name" in {one.code for one in complaints.items}
    told = [one.message for one in complaints.items if one.code == "dimension"]
    assert any(one.startswith("'omega0**2*R**2' is m^2/s^2") for one in told), told
    assert any("'b' is kg*m^2" in one for one in told), told


def damped_wheel(polynomial: str) -> list[str]:
    """Complaints about a claimed characteristic polynomial of J x'' + b x' + k x = 0."""
    return codes(f"""mbsym: 1
name: wheel
parameters: {{J: positive, b: positive, k: positive}}
units: {{J: kg*m^2, b: N*m*s, k: N*m}}
bodies:
  - {{name: wheel, rotation: {{axes: [3], angles: [x]}}, mass: 0, inertia about: joint, inertia: [J, J, J]}}
loads:
  - spring: {{coordinate: x, stiffness: k}}
  - damper: {{coordinate: x, coefficient: b}}
motion: {{}}
claims:
  - {{claim: characteristic polynomial, variable: S, equals: "{polynomial}"}}
""")


def test_the_variable_of_a_characteristic_polynomial_is_a_rate() -> None:
    assert damped_wheel("J*S**2 + b*S + k") == []
    assert damped_wheel("S**2 + b/J*S + k/J") == []
    for slip in ("J*S**2 + b*S**2 + k", "S**2 + b*S + k/J", "J*S + b*S + k"):
        assert damped_wheel(slip) == ["dimension"]


def test_the_acceleration_of_a_speed_is_its_first_derivative() -> None:
    """Euler's  p' = (J2 - J3) q r / J1  is 1/s^2; without r it is 1/s, alone among the claims or not."""

    def complaints(*claimed: str) -> list[str]:
        claims = "".join(f'  - {{claim: acceleration, of: p, equals: "{one}"}}\n' for one in claimed)
        _, found = read(
            f"""mbsym: 1
name: a body that turns freely
units: {{J1: kg*m^2, J2: kg*m^2, J3: kg*m^2}}
parameters: {{J1: positive, J2: positive, J3: positive}}
bodies:
  - name: body
    rotation: {{axes: [3, 1, 3], angles: [psi, th, phi]}}
    mass: 0
    inertia about: joint
    inertia: [J1, J2, J3]
    orientation: {{gamma: 3}}
    speeds: {{p: omega1, q: omega2, r: omega3}}
claims:
{claims}""",
            "x.yaml",
        )
        return [one.message for one in found.items]

    assert complaints("(J2 - J3)*q*r/J1") == []
    wrong = "'p_dot' is 1/s^2, '(J2 - J3)*q/J1' is 1/s: they cannot be equal"
    assert complaints("(J2 - J3)*q/J1") == [wrong]
    assert complaints("(J2 - J3)*q*r/J1", "(J2 - J3)*q/J1") == [wrong]


def test_other_systems_of_units_are_told_in_their_own_names() -> None:
    text = """mbsym: 1
name: small
parameters:
  m: {sign: positive, unit: g}
  k: {sign: positive, unit: g*mm^2/ms^2}
  l: {sign: positive, unit: mm}
  b: positive
bodies:
  - {name: bob, attached to: 0, rotation: {axes: [3], angles: [phi]}, mass centre: [l, 0, 0], mass: m}
loads:
  - spring: {coordinate: phi, stiffness: k}
  - damper: {coordinate: phi, coefficient: b}
"""
    system = system_of(text, "x.yaml")
    assert system.units.of("b") == "g*mm^2/ms"
    assert system.units.rate_of("phi") == "1/ms"
    assert system.units.text(ENERGY) == "g*mm^2/ms^2"


def test_what_does_not_follow_has_no_unit() -> None:
    text = """mbsym: 1
name: half
parameters: {m: {sign: positive, unit: kg}, k: positive}
bodies:
  - {name: bob, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}
loads:
  - spring: {coordinate: x, stiffness: k}
"""
    system = system_of(text, "x.yaml")
    assert system.units.of("k") is None  # it is kg/s^2, but nobody said what the time is measured in
    assert system.units.of("m") == "kg"


def test_inference_against_random_dimensions() -> None:
    """Random true dimensions: every true equation is taken, what follows is true, every false one is refused."""
    source = random.Random(7)
    bases = (MASS, LENGTH, TIME)
    for _ in range(40):
        truth = {}
        for name in "abcdef":
            powers = [Fraction(source.randint(-3, 3), source.choice((1, 2))) for _ in bases]
            made = ()
            for base, power in zip(bases, powers, strict=True):
                made = times(made, base, power)
            truth[name] = made
        inference = Inference({"a": Form(truth["a"]), "b": Form(truth["b"])})
        for _ in range(8):
            chosen = source.sample("abcdef", 3)
            left = Form((), tuple(sorted((name, Fraction(source.choice((-2, -1, 1, 2)))) for name in chosen)))
            value = ()
            for name, power in left.unknown:
                value = times(value, truth[name], power)
            assert inference.equate(left, Form(value))
            assert not inference.equate(left, Form(times(value, LENGTH)))
        for name in "abcdef":
            assert inference.dimension(name) in (None, truth[name])


def test_how_dimensions_are_written() -> None:
    assert written(ENERGY) == "kg*m^2/s^2"
    assert written(times((), TIME, -1)) == "1/s"
    assert written(times(times(times((), MASS), LENGTH, -1), TIME, -2)) == "kg/(m*s^2)"
    assert written(times((), LENGTH, Fraction(1, 2))) == "m^(1/2)"


@pytest.mark.parametrize("name", COMMON)
def test_common_units_are_those_of_pint(name: str) -> None:
    """The table in front of pint, by pint's own conversion to kg, m, s."""
    import pint

    registry = pint.UnitRegistry(cache_folder=None)
    size, dimension = COMMON[name]
    wanted = " * ".join(["1", *(f"{base}**({exponent})" for base, exponent in dimension)])
    assert (1.0 * registry.Unit(name)).to(wanted.removeprefix("1 * ") if dimension else "").magnitude == float(size)


def test_common_units_do_not_load_pint() -> None:
    script = "import sys; from mbsym.source import read; assert read(sys.argv[1])[0]; assert 'pint' not in sys.modules"
    subprocess.run([sys.executable, "-c", script, with_units()], check=True)
