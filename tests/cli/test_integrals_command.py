"""``mbsym integrals``: what it prints, as JSON by its schema, and what it refuses."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import jsonschema
import pytest
import sympy
from conftest import filed, invoked

import mbsym
from mbsym.analysis.polynomial import integrals_of, setting
from mbsym.problems.polynomial_integrals.homogenised import InAnyField
from mbsym.report.schemas import schema
from mbsym.studies.integrals.relations import darboux_values

CLEBSCH, TOP = "systems/clebsch-poisson.yaml", "systems/euler-poisson.yaml"


def run(*words, code: int | None = None):
    return invoked("integrals", *words, code=code)


@pytest.fixture(autouse=True)
def _at_the_root(monkeypatch, request):
    monkeypatch.chdir(request.config.rootpath)


def test_clebschs_integral_is_found():
    """A fourth one of degree two (Clebsch 1871), and no other up to degree four."""
    done = run(CLEBSCH, "--json", code=0)
    data = json.loads(done.stdout)
    jsonschema.validate(data, schema("integrals"))
    assert [one["weight"] for one in data["integrals"]] == [2, 2, 2, 2]
    assert [one["new"] for one in data["integrals"]] == [False, False, False, True]
    assert (data["complete"], data["independent"]) == (True, 4)
    # Homogeneous of degree two and a polynomial in four such: C(k + 3, 3) of degree 2 k.
    assert [one["at_most"] for one in data["counts"]] == [0, 4, 0, 10]


def test_the_table_says_what_is_proved():
    done = run(CLEBSCH, "--degree", "2")
    assert "further integral" in done.stdout
    assert "up to 2 is a polynomial in these, for almost all values of the parameters (proved)" in " ".join(
        done.stdout.split()
    )
    generic = run("systems/gyrostat-poisson.yaml", "--degree", "3")
    none = "Up to weighted degree 3 there is none beyond those of problem 7"
    assert f"{none}, for almost all values of the parameters." in " ".join(generic.stdout.split())
    names = mbsym.load("systems/gyrostat-poisson.yaml").system.parameters
    at = run(
        "systems/gyrostat-poisson.yaml", "--degree", "3", *(f"--set={x.name}={k + 2}" for k, x in enumerate(names))
    )
    assert "there is none beyond those of problem 7." in " ".join(at.stdout.split())  # at numbers: at these


def test_what_is_known_beyond_the_degree_is_told():
    """Of two links T has theta1'^2 cos(theta2), degree 3, where theta2 is the angle between them."""
    done = run("systems/double-pendulum.yaml", "--degree", "2", code=0)
    lines = [line.strip() for line in done.stdout.splitlines()]
    assert "Integrals of problem 7 of a higher weighted degree (--degree): generalised energy (3)." in lines
    assert lines.index(next(x for x in lines if x.startswith("There is none"))) == 1
    assert lines[-1].startswith("Looked for are polynomials up to weighted degree 2")
    assert "higher weighted degree" not in run("systems/double-pendulum.yaml", code=0).stdout


NUMBERS = [f"--set={one}" for one in ("B=2", "C=1", "x0=1", "y0=0", "z0=0", "m=1", "g=1")]


def test_kovalevskayas_value_is_found():
    """A = B = 2 C (Acta Math. 12, 1889)."""
    done = run(TOP, *NUMBERS, "--vary", "A=1:5", "--json", code=0)
    data = json.loads(done.stdout)
    jsonschema.validate(data, schema("integrals"))
    assert [one["value"] for one in data["along"]["values"]] == ["2"]
    assert data["along"]["no_others"] is True
    told = run(TOP, *NUMBERS, "--vary", "A=1:5").stdout
    assert "A = 2" in told
    assert "At all other values of A from 1 to 5" in told


def test_cases_are_conditions():
    """The mass centre on the third axis: Euler without weight, Lagrange with A = B, the body with equal moments."""
    done = run(TOP, "--set", "x0=0", "--set", "y0=0", "--degree", "2", "--cases", "--json")
    data = json.loads(done.stdout)
    jsonschema.validate(data, schema("integrals"))
    told = [[w["weight"] for w in one["integrals"]] for one in data["cases"]["cases"]]
    assert [2] in told
    assert [1] in told
    fewer = [f"--set={one}" for one in ("x0=0", "y0=0", "C=1", "m=1", "g=1")]
    text = run(TOP, *fewer, "--degree", "2", "--cases").stdout
    assert "that there are no other cases is not" in text
    assert "A = B" in text


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ((CLEBSCH, "--degree", "50"), "monomials"),
        ((CLEBSCH, "--degree", "x"), "error["),
        ((CLEBSCH, "--set", "Q=1"), "there is no parameter called Q"),
        ((CLEBSCH, "--set", "A=0"), "vanishes at these values"),
        ((TOP, "--vary", "A=1:5"), "no number for B"),
        ((TOP, *NUMBERS, "--vary", "B=1:5"), "has an interval and a number"),
        ((TOP, *NUMBERS, "--vary", "A=1:5", "--cases"), "choose one of them"),
        ((CLEBSCH, "--weight", "s=1"), "the field has no variable s"),
        ((CLEBSCH, "--weight", "gamma1"), "is no NAME=N"),
    ],
)
def test_bad_input_is_complained_about(words, told):
    done = run(*words)
    assert (done.exit_code, done.stdout) == (2, "")
    assert told in done.stderr.replace("'", "")


def test_hess_relation_is_told_with_its_condition():
    done = run(TOP, "--set", "y0=0", "--degree", "1", "--relations", "--json")
    data = json.loads(done.stdout)
    jsonschema.validate(data, schema("integrals"))
    assert "A*x0*p + C*z0*r" in [one["formula"] for one in data["relations"]["relations"]]
    told = run(TOP, *NUMBERS, "--set", "A=5", "--degree", "1", "--relations").stdout
    assert "there are none (proved)" in told
    assert data["darboux"]["polynomials"] == []  # for almost all parameters there is none
    text = run(TOP, "--set", "y0=0", "--degree", "1", "--relations").stdout
    assert "A*x0*p + C*z0*r = 0" in text
    assert "is undecided" in text


def test_invariant_relations_and_levels_are_told_with_what_is_proved():
    data = json.loads(run("systems/hess-appelrot.yaml", "--degree", "2", "--relations", "--json").stdout)
    jsonschema.validate(data, schema("integrals"))
    higher = json.loads(run("systems/hess-appelrot.yaml", "--relations", "--json").stdout)
    jsonschema.validate(higher, schema("integrals"))
    assert "verified numerically" in [one["known"] for one in higher["other_levels"]]  # by ranks at a random point
    assert [one["formula"] for one in data["darboux"]["polynomials"]] == ["A*x0*p + C*z0*r"]
    assert (data["darboux"]["complete"], data["darboux"]["not_found"]) == (True, [])
    text = " ".join(run("systems/goryachev-chaplygin.yaml", "--relations").stdout.split())
    assert "is zero, one of weight 3: C*(p**2 + q**2)*r - x0*m*g*p*gamma3" in text
    assert "There is none of weight up to 4 with K not zero" in text
    angles = " ".join(run("systems/spherical-pendulum.yaml", "--degree", "2", "--relations").stdout.split())
    assert "Whether there are others is undecided: a K of that weight may hold products" in angles
    assert "where the integral of weight 4" not in angles  # the energy is beyond the degree
    several = " ".join(run("systems/double-pendulum.yaml", "--degree", "2", "--relations").stdout.split())
    assert "not looked for: several unit vectors or angles are related" in several
    assert "Whether there are others is undecided: relations between variables, of several unit vectors" in several
    rotor = " ".join(run("systems/heavy-gyrostat.yaml", "--degree", "2", "--relations").stdout.split())
    assert "weights are p, q, r" not in rotor  # the same as those of the integrals
    assert "there is none beyond those that hold everywhere of weight up to 2, for almost all values of the" in rotor
    assert "parameters (proved; unit vectors of any length)" in rotor


def test_clebschs_condition_for_kirchhoffs_equations_is_found():
    """One integral more of degree two where A (k2 - k3) + B (k3 - k1) + C (k1 - k2) = 0 (Clebsch 1870)."""
    data = json.loads(run("systems/kirchhoff.yaml", "--degree", "2", "--cases", "--json").stdout)
    assert all(one["complete"] for one in data["cases"]["cases"])
    told = [one["vanishing"] for one in data["cases"]["cases"] if len(one["vanishing"]) == 1]
    assert told == [["A*(k2 - k3) + B*(k3 - k1) + C*(k1 - k2)"]]
    line = ("A=1", "B=2", "C=3", "k1=1", "k2=2")
    words = [word for one in line for word in ("-s", one)]
    text = run("systems/kirchhoff.yaml", *words, "--vary", "k3=1/2:5").stdout
    assert "k3 = 3\n" in text
    assert "At all other values of k3" in text


HENON_HEILES = "systems/henon-heiles.yaml"


def _same(told: str, printed: str) -> bool:
    """But for a factor."""
    names = sympy.symbols("A B a b x y x_dot y_dot")
    one, other = (
        sympy.Poly(sympy.sympify(text), *names).clear_denoms(convert=True)[1].primitive()[1] for text in (told, printed)
    )
    return one in (other, -other)


def test_the_integrable_cases_of_henon_and_heiles_are_found():
    """Chang, Tabor & Weiss (1982): A = B with b = -a, and b = -6 a, with the integrals of the literature."""
    data = json.loads(run(HENON_HEILES, "--cases", "--json").stdout)
    found = {frozenset(one["vanishing"]): one["integrals"] for one in data["cases"]["cases"]}
    assert {key for key in found if "a" not in key} == {frozenset({"B - A", "a + b"}), frozenset({"6*a + b"})}
    (third,) = found[frozenset({"B - A", "a + b"})]
    assert _same(third["formula"], "x_dot*y_dot + A*x*y + a*(x**3/3 + x*y**2)")
    (fourth,) = found[frozenset({"6*a + b"})]
    printed = "4*a*x_dot*(x*y_dot - y*x_dot) + (4*A - B)*(x_dot**2 + A*x**2) + a**2*(x**4 + 4*x**2*y**2) + 4*A*a*x**2*y"
    assert _same(fourth["formula"], printed)


def test_the_third_case_of_henon_and_heiles_is_found_along_a_line():
    """B = 16 A, b = -16 a: an integral of fourth degree in the velocities; no other b but -6 a has one."""
    line = ("-s", "m=1", "-s", "A=1", "-s", "B=16", "-s", "a=1", "--degree", "6", "--vary", "b=-20:0", "--json")
    data = json.loads(run(HENON_HEILES, *line).stdout)
    found = {one["value"]: one["integrals"] for one in data["along"]["values"]}
    assert set(found) == {"-6", "-16"}
    (sixth,) = found["-16"]
    printed = "3*x_dot**4 + 6*(1 + 2*y)*x**2*x_dot**2 - 4*x**3*x_dot*y_dot - 4*x**4*(y + y**2) + 3*x**4 - 2*x**6/3"
    assert _same(sixth["formula"], printed)
    assert data["along"]["no_others"] is True


def test_systems_in_angles_have_rates_sines_and_cosines():
    """The spherical pendulum: its energy, and the momentum of psi, sin(theta)^2 psi_dot."""
    data = json.loads(run("systems/spherical-pendulum.yaml", "--json").stdout)
    assert data["weights"] == dict.fromkeys(("psi_dot", "theta_dot", "sin(theta)", "cos(theta)"), 1)
    assert [(one["weight"], one["name"]) for one in data["integrals"]] == [
        (3, "momentum of psi"),
        (4, "generalised energy"),
    ]
    assert data["complete"] is True


def test_inputs_are_held_as_on_the_unperturbed_motion(tmp_path):
    """A cart that nothing pushes keeps its momentum and its energy."""
    text = Path("systems/cart-pole.yaml").read_text(encoding="utf-8")
    file = tmp_path / "cart-pole.yaml"
    file.write_text("".join(x for x in text.splitlines(True) if "damper" not in x), encoding="utf-8")
    driven = run(str(file), "--json")
    assert "the inputs are constant, as on the unperturbed motion: F = 0" in driven.stderr
    names = {one["name"] for one in json.loads(driven.stdout)["integrals"]}
    assert names == {"momentum of p", "generalised energy"}


def test_a_root_of_what_is_known_is_one_more():
    """Clebsch's body with A = C keeps q, of which only the square is a combination of what there is in general."""
    numbers = [f"--set={one}" for one in ("B=2", "C=1", "N=1", "R=1", "M=1")]
    data = json.loads(run(CLEBSCH, *numbers, "--degree", "2", "--vary", "A=1/2:5", "--json").stdout)
    told = {one["value"]: [x["formula"] for x in one["integrals"]] for one in data["along"]["values"]}
    assert told == {"1": ["q"], "2": ["r"]}
    assert (data["along"]["undecided_at"], data["along"]["no_others"]) == ([], True)


def test_the_norm_of_a_quaternion_is_not_denied():
    """Problem 7 lists it: up to degree four there is none but that, Jacobi's being of degree four in e."""
    text = " ".join(run("systems/gravity-gradient-quaternion.yaml", "--degree", "3").stdout.split())
    none = "as lengths of unit vectors are, there is none up to weighted degree 3"
    assert f"But for relations that every state keeps, {none}" in text


def test_a_quaternion_may_be_varied():
    """Two equal moments of inertia keep a speed, in a circular orbit too; the third pair is not met."""
    numbers = [f"--set={one}" for one in ("m=1", "R=1", "B=2", "C=3", "omega0=1")]
    done = run("systems/gravity-gradient-quaternion.yaml", *numbers, "--vary", "A=1:4", "--degree", "3", "--json")
    data = json.loads(done.stdout)
    jsonschema.validate(data, schema("integrals"))
    told = {one["value"]: [x["formula"] for x in one["integrals"]] for one in data["along"]["values"]}
    assert (told, data["along"]["no_others"]) == ({"2": ["r"], "3": ["q"]}, True)
    assert data["along"]["weights"]["e0"] == 1


def test_values_with_further_invariant_relations_are_told():
    """6 (B - 3) = 3 (6 - B): Hess and Appelrot's top at B = 4, and at no other value."""
    words = (TOP, *(f"-s{one}" for one in ("A=6", "C=3", "x0=1", "y0=0", "z0=1", "m=1", "g=1")), "-d1", "--relations")
    data = json.loads(run(*words, "--vary", "B=1:5", "--json").stdout)
    jsonschema.validate(data, schema("integrals"))
    told = data["darboux_along"]
    assert [(one["value"], [f["formula"] for f in one["polynomials"]]) for one in told["values"]] == [
        ("4", ["2*p + r"])
    ]
    assert told["no_other_rational"] is True
    text = " ".join(run(*words, "--vary", "B=1:5").stdout.split())
    assert "B = 4 weight 1: 2*p + r = 0 K = q/3 At all other values of B from 1 to 5 with numerator" in text
    pendulum = mbsym.load("systems/spherical-pendulum.yaml")
    there = setting(pendulum, {one.name: Fraction(1) for one in pendulum.system.parameters[1:]})
    found = integrals_of(there, 1)
    told = list(
        darboux_values(
            there, found, InAnyField(found, there.kinds, there.known).darboux_along(Fraction(1), Fraction(2))
        )
    )
    assert told == ["not looked for: a K of that weight may hold products of variables, which is not looked at"]


def test_values_of_integrals_are_told_with_what_holds_there(tmp_path):
    """A force (y' - 2) z'^2 along x and y' constant: where y' is 2, x' is constant."""
    path = filed(
        tmp_path / "planted.yaml",
        "mbsym: 1\nname: planted\nparameters: {c: {sign: positive}}\n"
        "bodies:\n  - {name: carriage, attached to: 0, connection point: [x, y, z], mass: 1, coordinates: [x, y, z]}\n"
        "loads:\n  - generalized force: {x: (y_dot - c)*z_dot**2, y: 0, z: x_dot*y_dot + z_dot}\n",
    )
    data = json.loads(run(str(path), "-d2", "-sc=2", "--relations", "--json").stdout)
    jsonschema.validate(data, schema("integrals"))
    (told,) = data["other_levels"]
    assert [(one["value"], [f["formula"] for f in one["integrals"]]) for one in told["values"]] == [("2", ["x_dot"])]
    assert (told["complete"], told["at_any_value"], told["known"]) == (True, False, "proved")
    text = " ".join(run(str(path), "-d2", "-sc=2", "--relations").stdout.split())
    assert "where the integral of weight 1 (momentum of y) is 2, one of weight 1: x_dot where" in text
    symbols = " ".join(run(str(path), "-d2", "--relations").stdout.split())
    assert "has single values, other than zero, there may be others: put in numbers with --set" in symbols
    top = " ".join(run("systems/goryachev-chaplygin.yaml", "--relations").stdout.split())
    assert "where the integral of weight 3 (angular momentum about axis 3) is not zero there is none beyond" in top
