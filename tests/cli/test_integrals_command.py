"""``mbsym integrals``: what it prints, as JSON by its schema, and what it refuses."""

from __future__ import annotations

import json

import jsonschema
import pytest
from click.testing import CliRunner

from mbsym.report.schemas import schema
from mbsym_cli.main import main

CLEBSCH = "systems/clebsch-poisson.yaml"


def run(*words):
    return CliRunner().invoke(main, ["integrals", *words])


@pytest.fixture(autouse=True)
def _at_the_root(monkeypatch, request):
    monkeypatch.chdir(request.config.rootpath)


def test_clebschs_integral_is_found():
    """A fourth one of degree two (Clebsch 1871), and no other up to degree four."""
    done = run(CLEBSCH, "--json")
    assert done.exit_code == 0
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
    assert "There is none beyond those of problem 7." in generic.stdout


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ((CLEBSCH, "--degree", "50"), "monomials"),
        ((CLEBSCH, "--degree", "x"), "error["),
        ((CLEBSCH, "--set", "Q=1"), "there is no parameter called Q"),
        ((CLEBSCH, "--set", "A=0"), "vanishes at these values"),
        ((CLEBSCH, "--weight", "s=1"), "the field has no variable s"),
        ((CLEBSCH, "--weight", "gamma1"), "a variable and its weight"),
    ],
)
def test_bad_input_is_complained_about(words, told):
    done = run(*words)
    assert (done.exit_code, done.stdout) == (2, "")
    assert told in done.stderr.replace("'", "")
