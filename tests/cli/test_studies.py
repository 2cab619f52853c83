"""``mbsym orbit``, ``floquet``, ``lyapunov``: all options of each in one run with their effects; what is wrong."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest
from conftest import SHIPPED, invoked

from mbsym_cli import study
from mbsym_cli.files import prevented
from mbsym_cli.options import Options


def record(path: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return found


def numbers(value: object) -> Iterable[float]:
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list):
        for one in value:
            yield from numbers(one)
    elif isinstance(value, float):
        yield value


SPHERICAL = SHIPPED / "spherical-pendulum.yaml"


def test_all_options_of_orbit_together(tmp_path: Path) -> None:
    """A conical pendulum turns with psi'^2 = g/(l cos theta): the period that is kept is another motion's."""
    common = ("orbit", SPHERICAL, "--period", "1.57", "--turns", "psi=1", "--set", "psi_dot=4", "--set", "theta=0.9")
    invoked(*common, "--out", tmp_path / "usual", code=0)
    kept = invoked(*common, "--keep", "period", "--quiet", "--out", tmp_path / "kept")
    assert (kept.exit_code, kept.stdout) == (0, ""), kept.output
    assert {path.name for path in (tmp_path / "kept").iterdir()} >= {"orbit.csv", "orbit.json"}
    assert record(tmp_path / "kept" / "orbit.json")["period"] == 1.57
    assert record(tmp_path / "usual" / "orbit.json")["period"] != 1.57
    without = invoked(*common[:4], *common[6:], "--keep", "period", "--out", tmp_path / "without")
    assert without.output != kept.output


def test_all_options_of_floquet_together(tmp_path: Path) -> None:
    """Shaken faster than nu = sqrt(2 g l)/h the pendulum stands upright, slower it falls (Kapitza 1951)."""
    shaken = SHIPPED / "shaken-pendulum.yaml"
    words = {}
    for nu in (30, 60):
        done = invoked("floquet", shaken, "--set", f"nu={nu}", "--quiet", "--out", tmp_path / str(nu))
        assert (done.exit_code, done.stdout) == (0, ""), done.output
        words[nu] = json.dumps(record(tmp_path / str(nu) / "floquet.json"))
    assert "unstable" in words[30]
    assert "unstable" not in words[60]


def test_all_options_of_lyapunov_together(tmp_path: Path) -> None:
    common = ("lyapunov", SHIPPED / "double-pendulum.yaml", "--time", 5, "--quiet")
    how = ("--count", 2, "--every", "1/20", "--tolerance", "1e-6")
    done = invoked(*common, *how, "--set", "theta1=1/2", "--out", tmp_path)
    assert (done.exit_code, done.stdout) == (0, ""), done.output
    rows = (tmp_path / "lyapunov.csv").read_text(encoding="utf-8").splitlines()
    assert len(rows) - 1 == 100
    assert len(rows[0].split(",")) == 3
    invoked(*common, *how, "--out", tmp_path / "other", code=0)
    assert rows[-1] != (tmp_path / "other" / "lyapunov.csv").read_text(encoding="utf-8").splitlines()[-1]


@pytest.mark.parametrize(
    ("arguments", "complaints"),
    [
        (("orbit", "--keep", "momentum", "--turns", "phi=1.5"), ["--period", "--keep", "--turns"]),
        (("lyapunov", "--count", "0", "--every", "-1", "--tolerance", "1"), ["--time", "--count", "--every", "--tol"]),
        (("floquet", "--set", "zeta=1"), ["--set"]),
        (("lyapunov", "--time", "5", "--every", "1/2"), ["--every"]),  # fewer intervals than there are: not passed over
    ],
)
def test_all_that_is_wrong_is_said_and_nothing_written(
    arguments: tuple[str, ...], complaints: list[str], tmp_path: Path
) -> None:
    done = invoked(arguments[0], SPHERICAL, *arguments[1:], "--out", tmp_path / "out", code=2)
    for option in complaints:
        assert f"\n{option}" in f"\n{done.stderr}"
    assert not (tmp_path / "out").exists()


def test_what_prevents_a_study(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert prevented(tmp_path / "f", tmp_path / "out", True, Options()) == 0
    assert prevented(tmp_path / "f", tmp_path / "out", False, Options()) == 2
    (tmp_path / "file").write_text("")
    assert prevented(tmp_path / "f", tmp_path / "file" / "out", True, Options()) == 1
    assert "cannot be written" in capsys.readouterr().err
    with pytest.raises(SystemExit) as left:
        study.leave(Path("f"), lambda: (_ for _ in ()).throw(KeyboardInterrupt))
    assert left.value.code == 130


@pytest.mark.parametrize("name", ["=", "R=1", "a\nb", " "])
def test_names_that_look_like_settings_are_unknown_ones(name: str) -> None:
    result = invoked("trim", SHIPPED / "cart-pole.yaml", "--solve", name, code=2)
    assert "error[unknown-name]" in result.output
