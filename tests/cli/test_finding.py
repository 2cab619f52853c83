"""What a run tells, result first: each line against a derivation by hand, and where it must be denied."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner
from conftest import SHIPPED

from mbsym_cli.main import main

PENDULUM = (SHIPPED / "simple-pendulum.yaml").read_text(encoding="utf-8")


def told(tmp_path: Path, text: str, *words: str) -> list[str]:
    """The lines below the title, each whole."""
    file = tmp_path / "system.yaml"
    file.write_text(text, encoding="utf-8")
    command = ["run", str(file), "--format", "json", "--out", str(tmp_path / "out"), *words]
    done = CliRunner().invoke(main, command, env={"COLUMNS": "1000"})
    assert done.exit_code == 0, done.output
    _, *lines = done.stdout.splitlines()
    return [line.strip() for line in lines]


def test_a_damped_pendulum(tmp_path: Path) -> None:
    """(m l^2 + J) theta'' = -m g l sin theta - b theta'; K = m g l > 0 and D = b > 0."""
    lines = told(tmp_path, PENDULUM)
    assert lines[:5] == [
        "Bodies and frames: 1; degrees of freedom: 1: theta",
        "Equations of motion: (m l^2 + J) theta'' + b theta' + m l g sin(theta) = 0",
        "The unperturbed motion: satisfies the equations of motion identically",
        "Stability, theta: asymptotically stable (Kelvin-Chetaev)",
        "At the given values of the parameters, decided exactly: asymptotically stable (Kelvin-Chetaev)",
    ]
    assert lines[-2:] == [
        "Self-check: all exact",
        f"results.json in {tmp_path / 'out'}; with -v more is told here",
    ]


def test_the_same_upside_down_and_without_numbers(tmp_path: Path) -> None:
    """K = -m g l < 0: unstable; without values nothing is said of them."""
    text = PENDULUM.replace("direction: [0, -1, 0]", "direction: [0, 1, 0]").partition("values:")[0]
    lines = told(tmp_path, text)
    (verdict,) = [line for line in lines if line.startswith("Stability")]
    assert verdict.startswith("Stability, theta: unstable")
    assert not [line for line in lines if line.startswith("At the given values")]


def test_conditions_stand_beside_the_verdict_that_depends_on_them(tmp_path: Path) -> None:
    """Bead on a hoop: theta = 0 is stable where g > R Omega^2, by the sign of K = m R (g - R Omega^2)."""
    lines = told(tmp_path, (SHIPPED / "bead-on-hoop.yaml").read_text(encoding="utf-8"))
    (verdict,) = [line for line in lines if line.startswith("Stability")]
    assert verdict.startswith("Stability, theta: depends on the parameters; see problem 6 of the report; conditions")
    assert verdict.endswith("g - R Omega^2 > 0")


def test_speeds_bring_their_kinematic_equations(tmp_path: Path) -> None:
    """Euler's and Poisson's equations, as they stand in textbooks; multipliers would be missing under constraints."""
    lines = told(tmp_path, (SHIPPED / "euler-poisson.yaml").read_text(encoding="utf-8"), "--problems", "1-3")
    (equations,) = [line for line in lines if line.startswith("Equations of motion")]
    assert "A p' + (C - B) q r + m g (y0 gamma3 - z0 gamma2) = 0" in equations
    assert "gamma1' = r gamma2 - q gamma3" in equations
    disc = told(tmp_path, (SHIPPED / "rolling-disc.yaml").read_text(encoding="utf-8"), "--problems", "1-3")
    assert not [line for line in disc if line.startswith("Equations of motion")]


def test_constraints_leave_as_much_freedom_as_they_do(tmp_path: Path) -> None:
    """A four-bar linkage has three angles and two equations of closure."""
    lines = told(tmp_path, (SHIPPED / "four-bar.yaml").read_text(encoding="utf-8"), "--problems", "1-3")
    assert lines[0] == "Bodies and frames: 3; coordinates: 3: q1, q2, q3; constraints: 2; degrees of freedom: 1"


def test_what_does_not_hold_and_what_is_missing_are_told(tmp_path: Path) -> None:
    wrong = "claims:\n  - {claim: kinetic energy, equals: J*theta_dot**2/2, place: eq. (9)}\n"
    lines = told(tmp_path, PENDULUM.replace("motion: {theta: 0}\n", "") + wrong)
    assert "Claims: 0 hold, 1 do not, 0 undecided" in lines
    assert [line for line in lines if line.startswith("Claim eq. (9), kinetic energy: differs")]
    missing = "Problems 4, 5, 6: no result: the description gives no unperturbed motion"
    assert [line for line in lines if line.startswith(missing) and "motion: {theta: 0}" in line]
    assert not [line for line in lines if line.startswith("Stability")]


@pytest.mark.parametrize(("language", "word"), [("ru", "Уравнения движения"), ("es", "Ecuaciones de movimiento")])
def test_it_speaks_the_language_of_the_report(tmp_path: Path, language: str, word: str) -> None:
    lines = told(tmp_path, PENDULUM, "--language", language)
    assert lines[1] == f"{word}: (m l^2 + J) theta'' + b theta' + m l g sin(theta) = 0"
    assert not [line for line in lines if "stable (" in line and language == "ru"]
