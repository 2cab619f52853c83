"""``mbsym oscillations``: what it prints, as JSON by its schema, and what it refuses."""

from __future__ import annotations

import json
import re
from pathlib import Path

import jsonschema
import pytest
from conftest import filed, invoked

from mbsym.report.schemas import schema

FAST = "systems/gyrostat-fast.yaml"


def run(*words, code: int | None = None):
    return invoked("oscillations", *words, code=code)


@pytest.fixture(autouse=True)
def _at_the_root(monkeypatch, request):
    monkeypatch.chdir(request.config.rootpath)


def test_the_gyrostat_as_json_and_as_text():
    done = run(FAST, "--order", "1", "--set", "lx=0", "--json", code=0)
    data = json.loads(done.stdout)
    jsonschema.validate(data, schema("oscillations"))
    assert (data["leading"], data["amplitude"]) == ("gamma1", {"kind": "free", "value": "amplitude"})
    assert data["solution"][0]["coefficients"][0]["order"] == 1  # p begins with the first order
    told = " ".join(run(FAST, "--order", "1").stdout.split())
    assert "gamma1(0) = amplitude cos(phase) gamma1(1) = " in told
    assert "Free oscillations of p, q" in told
    assert "against motions that begin in the same state: with eps halved from 0.0625 to 0.0312" in told


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("systems/euler-poisson.yaml",), "names no small parameter"),
        ((FAST, "--order", "90"), "error["),
        (("systems/satellite-with-damper-slow.yaml", "--set", "eps=1"), "belongs to the small parameter"),
        ((FAST, "--set", "Q=1"), "there is no parameter called Q"),
        ((FAST, "--of", "zeta"), "there is no variable called zeta"),
    ],
)
def test_bad_input_is_complained_about(words, told):
    done = run(*words)
    assert (done.exit_code, done.stdout) == (2, "")
    assert told in done.stderr.replace("'", "")


#: Table 1 of Amer, Amer & Galal in kg, m, s: A and B follow from its A0, delta1, delta2 and (4).
TABLE_1 = {
    "R": "1000",
    "g": "9.81",
    "M": "300",
    "A": "82.999082116765608446",
    "B": "76.199173905089047602",
    "C": "11",
    "x0": "0.7",
    "y0": "0.3",
    "z0": "0.1",
    "lx": "30",
    "lz": "30",
}


def test_numbers_that_no_body_has_and_numbers_of_what_is_small_are_put_in(tmp_path):
    """p of order 0 is r0 lx/((C - A) r0 + lz), the free frequency squared (C - A + lz/r0)(C - B + lz/r0)/(A B) r0^2,
    0.61777 r0^2 at r0 = 5 (references/gyrostat, notes 2.2 and 2.4)."""
    text = Path(FAST).read_text(encoding="utf-8").partition("# The symbols")[0]
    text = text.replace("inertia: [A, B, C]", "inertia: {tensor: [A, B, C], accept: true}").replace("200", "5")
    values = ", ".join(f"{name}: {value}" for name, value in TABLE_1.items())
    text = re.sub("^values: .*$", f"values: {{{values}}}", text, flags=re.MULTILINE)
    (tmp_path / "table-1.yaml").write_text(text.replace("atan(4/3)", "atan(999.9995)"), encoding="utf-8")
    put = [word for name, value in TABLE_1.items() for word in ("--set", f"{name}={value}")]
    done = run(str(tmp_path / "table-1.yaml"), "--order", "1", *put, code=0)
    told = " ".join(done.stdout.split())
    at = {"r_0": 5}

    def number(text: str) -> float:
        return eval(re.sub(r"(?<=[\w)]) (?=[\w(])", "*", text.replace("^", "**")), at)

    at |= {name: number(text) for name, text in re.findall(r"\b(D\d) = (.*?) (?=D\d = |Secular)", told)}
    constant = number(re.search(r"p\(0\) = (.*?) p\(1\)", told)[1])
    assert abs(constant - 5 * 30 / ((11 - float(TABLE_1["A"])) * 5 + 30)) < 1e-12
    square = number(re.search("has the square (.*?), are left out", told)[1])
    assert abs(square / 25 - 0.61777) < 5e-6


def test_what_leads_and_what_is_small_are_checked_where_they_stand(tmp_path):
    text = Path(FAST).read_text(encoding="utf-8").replace("leading: gamma1", "leading: zeta").replace("q: 1}", "qq: 1}")
    (tmp_path / "wrong.yaml").write_text(text, encoding="utf-8")
    done = run(str(tmp_path / "wrong.yaml"), code=2)
    assert "wrong.yaml:23:" in done.stderr
    assert "zeta is no variable" in done.stderr.replace("'", "")
    assert "unknown name" in done.stderr


def test_a_damped_pendulum_has_none():
    done = run("systems/simple-pendulum.yaml", code=1)
    assert "no pair of imaginary roots was found for theta, theta_dot" in " ".join(done.stderr.split())


COUPLED = """mbsym: 1
name: Two oscillators
parameters: {k: {sign: positive}, c: {sign: real}, eps: {sign: positive}}
small parameter: eps
bodies:
  - {name: mass, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
loads:
  - potential: k*(x**2 + y**2)/2 + c*(x - y)**2/2 + eps*x**4/4
"""


def test_frequencies_of_one_block_that_may_be_in_resonance_are_listed(tmp_path):
    """The squares k and k + 2 c are equal where c = 0, and as 1 to 9 where c = 4 k."""
    path = filed(tmp_path / "coupled.yaml", COUPLED)
    told = " ".join(run(str(path), "--of", "x", "--order", "1").stdout.split())
    assert "where c = 0 (harmonic 1, order 1, of x_dot, y_dot, x, y)" in told
    assert "where c - 4 k = 0 (harmonic 3, order 1, of x_dot, y_dot, x, y)" in told
    data = json.loads(run(str(path), "--of", "x", "--order", "1", "--json").stdout)
    assert {(one["harmonic"], one["vanishes"]) for one in data["resonances"]} == {(1, "c"), (3, "c - 4*k")}


DAMPED = """mbsym: 1
name: Two masses and a damper
parameters: {k: {sign: positive}, c: {sign: %s}, d: {sign: real}, eps: {sign: positive}}
small parameter: eps
bodies:
  - {name: mass, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
loads:
  - potential: k**2*(x**2 + y**2)/2 + d*(x - y)**2/2 + eps*x**4/4
  - generalized force: {x: -c*(x_dot - y_dot), y: c*(x_dot - y_dot)}
"""


def test_resonances_of_a_block_that_leads_and_has_damping_need_two_conditions(tmp_path):
    """By hand, v = x - y: v'' + 2 c v' + (k^2 + 2 d) v = -eps x^3; at i n k that is k^2 (1 - n^2) + 2 d + 2 c i n k."""
    path = filed(tmp_path / "damped.yaml", DAMPED % "real")
    done = run(str(path), "--of", "x", "--order", "1", "--json")
    data = json.loads(done.stdout)
    jsonschema.validate(data, schema("oscillations"))
    shown = {(one["harmonic"], one["vanishes"], one["vanishes_too"]) for one in data["resonances"]}
    assert shown == {(1, "d", "c"), (3, "d - 4*k**2", "c")}
    assert data["forced"] == [["x_dot", "y_dot", "x", "y"]]
    assert (data["with_root_zero"], data["roots_not_found"]) == ([], [])
    told = " ".join(run(str(path), "--of", "x", "--order", "1").stdout.split())
    assert "where d - 4 k^2 = 0 and c = 0 (harmonic 3, order 1" in told
    path.write_text(DAMPED % "positive", encoding="utf-8")
    assert "Resonance" not in run(str(path), "--of", "x", "--order", "1").stdout  # c > 0


CHAIN = """mbsym: 1
name: Masses
parameters: {k: {sign: positive}, eps: {sign: positive}}
small parameter: eps
bodies:
  - {name: mass, attached to: 0, connection point: [x, y, z], mass: 1, coordinates: [x, y, z]}
loads:
  - potential: %s
"""


def test_roots_that_are_zero_and_roots_that_are_not_found_are_no_damping(tmp_path):
    path = filed(tmp_path / "chain.yaml", CHAIN % "k**2*(x - y)**2/2 + eps*(x - y)**4/4 + z**2/2")
    data = json.loads(run(str(path), "--of", "x", "--order", "1", "--json").stdout)
    jsonschema.validate(data, schema("oscillations"))
    assert (data["with_root_zero"], data["forced"]) == ([["x_dot", "y_dot", "x", "y"]], [])
    told = " ".join(run(str(path), "--of", "x", "--order", "1").stdout.split())
    assert "x_dot, y_dot, x, y have the root zero: free displacements and drifts that belong to it are left out" in told
    # a cubic without rational roots: all three frequencies are real, none is found
    text = "x**2/2 + x*y + 3*y**2/2 + y*z + 3*z**2 + eps*x**4/4 + k*eps*x**3"
    path.write_text(CHAIN % text, encoding="utf-8")
    done = run(str(path), "--of", "x", "--order", "1", code=1)
    told = " ".join(done.stderr.split())
    assert "the frequencies of x_dot, y_dot, z_dot, x, y, z were not found as square roots" in told
    assert "no periodic solution" not in told


def test_frequencies_that_variables_share_are_told_once_with_the_option() -> None:
    """Both modes of the double pendulum move both angles: no variable's name tells them apart."""
    done = invoked("oscillations", "systems/double-pendulum.yaml")
    text = " ".join(done.output.split())
    assert "of: theta1, theta2, theta1_dot, theta2_dot (2 of them); say which of the frequencies" in text
    assert "--frequency K" in text


@pytest.mark.parametrize(
    ("integral", "told"),
    [
        ("u", "u has no rate"),
        ("p=q", "cannot be a new name"),
        ("s=zz*p", "there is no variable called zz"),
        ("s=(", "ends too early"),
    ],
)
def test_integrals_that_cannot_be_are_complained_about(integral, told):
    done = run(FAST, "--integral", integral)
    assert (done.exit_code, done.stdout) == (2, "")
    assert told in done.stderr.replace("'", "")


def test_integrals_stand_beside_the_solution():
    words = (FAST, "--order", "1", "--set", "lx=0", "--integral", "psi=(p*gamma1+q*gamma2)/(gamma1**2+gamma2**2)")
    assert "The rates that were given for psi are those of these coordinates (proved)." in run(*words).stdout
    data = json.loads(run(*words, "--json").stdout)
    jsonschema.validate(data, schema("oscillations"))
    (drift,) = data["drifts"]
    assert (drift["variable"], drift["rates"][:2], drift["rates"][2] != "0") == ("psi", ["0", "0"], True)
    assert [one["order"] for one in drift["coefficients"]] == [2]  # without lx psi begins with the second order
    other = run(FAST, "--order", "1", "--integral", "psi=p*gamma1")
    assert (other.exit_code, other.stdout) == (1, "")
    assert "its rate was not found to be this" in other.stderr


DUFFING = """mbsym: 1
name: Duffing
parameters: {{w: positive, eps: real}}
small parameter: eps
bodies:
  - {{name: p, connection point: [x, 0, 0], mass: 1, coordinates: [x]}}
loads:
  - potential: w**2*({x})**2/2 + eps*({x})**4/4
values: {{w: 1, eps: 0.1}}
initial: {{x: {start}}}
"""


def test_another_zero_of_the_coordinate_changes_nothing_but_the_centre(tmp_path):
    """With x - 2 in place of x the series has 2 more, is as good, and what it begins with is amplitude + 2."""
    told = []
    for name, x, start in (("plain", "x", "0.5"), ("shifted", "2 - x", "1.5")):
        path = filed(tmp_path / f"{name}.yaml", DUFFING.format(x=x, start=start))
        told.append(" ".join(run(str(path)).stdout.split()))
    plain, shifted = (re.findall(r"Over one period.*(?=Measured at)", text)[0] for text in told)
    assert plain == shifted
    assert "Here it is amplitude, the value of x at the phase 0" in told[0]
    assert "x(0) = amplitude cos(phase) + 2" in told[1]
    assert "at the phase 0, where x has no term sin(phase), it is amplitude + 2" in told[1]


def test_variables_of_a_motion_that_is_not_zero_are_told_to_be_deviations(tmp_path):
    path = filed(
        tmp_path / "pendulum.yaml",
        "mbsym: 1\nname: p\nbodies: [{name: b, rotation: {axes: [3], angles: [th]}, mass centre: [0, 1, 0], mass: 1}]\n"
        "loads: [{uniform gravity: {vector: [0, -1, 0]}}]\nmotion: {th: pi}\ninitial: {th: 3}\n",
    )
    assert "th: here deviations from the unperturbed motion." in run(str(path)).stdout
    path.write_text(path.read_text(encoding="utf-8").replace("[0, 1, 0]", "[0, -1, 0]").replace("pi", "0"))
    assert "deviations from" not in run(str(path)).stdout
