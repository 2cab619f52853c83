"""``mbsym symmetries``: what it prints, as JSON by its schema, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import pytest
from conftest import filed, invoked

from mbsym.report.schemas import schema


def run(*words, code: int | None = None):
    return invoked("symmetries", *words, code=code)


@pytest.fixture(autouse=True)
def _at_the_root(monkeypatch, request):
    monkeypatch.chdir(request.config.rootpath)


def test_a_constant_push_has_a_potential():
    """The cart pushed by the constant F: T - U - F x is conserved, which problem 7 knows, too."""
    done = run("systems/cart-pendulum.yaml", "--json", code=0)
    data = json.loads(done.stdout)
    jsonschema.validate(data, schema("symmetries"))
    (one,) = data["symmetries"]
    assert (one["time"], one["gauge"], one["new"], one["substituted"]) == ("1", "F*x", False, "proved")
    assert data["complete"] is True


def test_the_table_says_what_is_proved():
    told = " ".join(run("systems/spherical-pendulum.yaml").stdout.split())
    assert "The field xi_psi = 1 gives an integral that is known (momentum of psi)." in told
    assert "I' = 0 by substitution of the accelerations, too (proved), of integrals: 2." in told
    assert (
        "Every other of this kind is a combination of these with constant coefficients, for almost all values" in told
    )
    none = run("systems/ziegler.yaml")
    assert (none.exit_code, "There is none of this kind, for almost all values" in none.stdout) == (0, True)
    roots = run("systems/three-bodies.yaml")  # states are not rational there
    assert roots.exit_code == 0
    assert "compared in independent functions" in " ".join(roots.stdout.split())


def test_where_others_are_not_excluded_it_is_said(tmp_path):
    """A valley that turns: sines of the time are not told apart from functions that depend on each other."""
    path = filed(
        tmp_path / "valley.yaml",
        "mbsym: 1\nname: Valley\nparameters: {m: {sign: positive}, k: {sign: positive}, n: {sign: positive}}\n"
        "bodies:\n  - {name: b, attached to: 0, connection point: [x, y, 0], mass: m, coordinates: [x, y]}\n"
        "loads:\n  - force function: -k*(x*cos(n*t) + y*sin(n*t))**2/2\n",
    )
    done = run(str(path))
    assert (done.exit_code, "That there are no others is not proved." in done.stdout) == (1, True)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("systems/rolling-disc.yaml",), "takes no constraint but relations"),
        (("systems/spherical-pendulum.yaml", "--set", "Q=1"), "there is no parameter called Q"),
        (("systems/none.yaml",), "none.yaml"),
    ],
)
def test_bad_input_is_complained_about(words, told):
    done = run(*words)
    assert (done.exit_code, done.stdout) == (2, "")
    assert told in done.stderr.replace("'", "")


def test_a_system_of_matrices_has_no_lagrangian_here():
    done = run("systems/gyroscopic-pair.yaml")
    assert (done.exit_code, done.stdout) == (1, "")
    assert "given by its matrices" in done.stderr


def simulated(*words):
    done = invoked("simulate", *words, "--time", "2", "--invariants", "--no-estimate", "-f", "csv", code=0)
    return done.stdout


def test_a_run_watches_what_is_found_at_its_numbers(tmp_path):
    """Kovalevskaya's integral at A = B = 2 C, of weight 4; none at A = 3; T - U - F x of a cart that is pushed."""
    told = simulated("systems/euler-poisson.yaml", "-o", str(tmp_path))
    assert "integral of weight 4 (proved): largest drift" in told
    rows = (tmp_path / "trajectory.csv").read_text("utf-8").splitlines()
    column = rows[0].split(",").index("polynomial_4")
    values = [float(row.split(",")[column]) for row in rows[1:]]
    assert max(values) - min(values) < 1e-7 * max(map(abs, values))
    assert "of weight 4" not in simulated("systems/euler-poisson.yaml", "--set", "A=3", "-o", str(tmp_path))
    pushed = simulated("systems/cart-pendulum.yaml", "--set", "F=3", "-o", str(tmp_path))
    assert "energy with the potential of the forces (proved): largest drift" in pushed


FALL = """mbsym: 1
name: Free fall
parameters: {m: positive, g: positive}
bodies:
  - {name: stone, attached to: 0, connection point: [x, 0, z], mass: m, coordinates: [x, z]}
loads:
  - uniform gravity: {acceleration: g, direction: [0, 0, -1]}
"""


def test_what_holds_the_time_is_not_said_to_be_absent(tmp_path: Path) -> None:
    """m z' + m g t is an integral of xi = 1 with Gamma = -m g t: of a kind that is not looked for, and told so."""
    file = filed(tmp_path / "fall.yaml", FALL)
    told = " ".join(invoked("symmetries", file).stdout.split())
    assert "both free of the time" in told
    assert "Every other of this kind is" in told
