"""``mbsym expand``: what it prints, as JSON by its schema, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import pytest
from conftest import invoked

from mbsym.report.schemas import schema

SLOW = "systems/satellite-with-damper-slow.yaml"


def run(*words, code: int | None = None):
    return invoked("expand", *words, code=code)


@pytest.fixture(autouse=True)
def _at_the_root(monkeypatch, request):
    monkeypatch.chdir(request.config.rootpath)


def test_the_damper_as_json_and_as_text():
    done = run(SLOW, "--order", "3", "--json", code=0)
    data = json.loads(done.stdout)
    jsonschema.validate(data, schema("expansion"))
    assert [one["residual"] for one in data["manifold"]] == [4, 4]
    assert data["steady"]["attracts"]["outcome"] == "holds"
    assert data["steady"]["flow"]["positive"] == ["(s*omega + eta)*(s*omega + eta - omega)"]
    told = " ".join(run(SLOW, "--order", "1").stdout.split())
    assert "x(1) = (rho G + (lam - r) p)/kappa p'(0) = -lam q q'(0) = lam p" in told
    assert told.endswith("Letters used here: lam = (s - 1) r + eta G = p^2 + q^2")
    told = " ".join(run(SLOW, "--order", "1", "--in", "none").stdout.split())
    assert "x(1) = rho (p^2 + q^2)/kappa + (s - 2) p r/kappa + eta p/kappa p'(0) = " in told
    assert "Letters used here" not in told
    assert "Whether the roots of the flow on it have negative real parts is undecided" in told


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("systems/clebsch-poisson.yaml",), "clebsch-poisson.yaml: error[missing-key]: the description names no small"),
        ((SLOW, "--order", "90"), "error["),
        ((SLOW, "--set", "eps=1/10"), "belongs to the small parameter"),
        ((SLOW, "--set", "Q=1"), "there is no parameter called Q"),
    ],
)
def test_bad_input_is_complained_about(words, told):
    done = run(*words)
    assert (done.exit_code, done.stdout) == (2, "")
    assert told in done.stderr.replace("'", "")


def test_a_system_without_fast_variables(tmp_path):
    text = Path("systems/gyrostat-poisson.yaml").read_text(encoding="utf-8") + "\nsmall parameter: epsilon\n"
    (tmp_path / "slow.yaml").write_text(text, encoding="utf-8")
    done = run(str(tmp_path / "slow.yaml"), code=1)
    assert "no variable is fast" in done.stderr


def test_the_map_gives_the_range_that_the_reduced_condition_misjudges(tmp_path):
    """lambda = 1/1000, kappa = omega = 1 keep the reduced condition; divergence where eps^2 > lambda kappa/omega^3."""
    numbers = {"s": "1", "eta": "1/1000", "kappa": "1", "omega": "1", "rho": "0", "delta": "2/5", "A": "1", "b0": "1"}
    settings = [word for name, value in numbers.items() for word in ("--set", f"{name}={value}")]
    done = invoked("map", SLOW, "--x", "eps=0:1/2", *settings, "--out", tmp_path, code=0)
    told = " ".join(done.stdout.split())
    assert "at 0.0316227766 (exactly: a root of a polynomial of degree 2" in told
    assert "unstable: divergence, 1 root to the right" in told


HEAVY_DAMPING = """
mbsym: 1
name: Small mass
parameters:
  e: {sign: positive, meaning: mass}
  c: {sign: positive, meaning: damping}
  k: {sign: positive, meaning: stiffness}
small parameter: e
bodies:
  - {name: point, attached to: 0, connection point: [x, 0, 0], mass: e, coordinates: [x], speeds: {v: x_dot}}
loads:
  - potential: k*x**2/2
  - damper: {coordinate: x, coefficient: c}
motion: {x: 0}
"""


def test_a_manifold_that_repels_makes_its_steady_states_unstable(tmp_path):
    """e x'' + c x' + k x = 0: the roots are -c/e + ... and -k/c + ...; both change their signs with c."""
    (tmp_path / "damped.yaml").write_text(HEAVY_DAMPING)
    (tmp_path / "driven.yaml").write_text(HEAVY_DAMPING.replace("coefficient: c", "coefficient: -c"))
    damped, driven = (
        " ".join(run(str(tmp_path / f"{x}.yaml"), "--order", "1").stdout.split()) for x in ("damped", "driven")
    )
    assert "All roots of the flow on it have negative real parts for all sufficiently small e > 0" in damped
    assert "reduction principle" in damped
    assert "this motion is unstable" not in damped
    assert "reduction principle" not in driven
    assert "A fast root has a positive real part: this motion is unstable for all sufficiently small e > 0." in driven
    (tmp_path / "plain.yaml").write_text(HEAVY_DAMPING.replace(", speeds: {v: x_dot}", ""))
    plain = " ".join(run(str(tmp_path / "plain.yaml"), "--order", "1").stdout.split())  # without speeds it is the same
    assert plain.partition("Put into")[2] == damped.partition("Put into")[2]
