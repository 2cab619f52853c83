"""What mbsym did not write is not replaced without --force, by no command that writes files."""

from __future__ import annotations

import ast
import shutil
from pathlib import Path

import click
import pytest
from conftest import SHIPPED, filed, invoked

import mbsym_cli
from mbsym_cli.main import COMMANDS, main

#: Command, its words without --out, and one of the files that it writes into the folder.
FOLDERS = [
    ("run", "simple-pendulum", ["-f", "json"], "results.json"),
    ("simulate", "simple-pendulum", ["-t", "0.1", "-f", "csv", "--no-estimate"], "trajectory.csv"),
    ("floquet", "shaken-pendulum", [], "floquet.json"),
    ("inverse", "cart-pole", ["--motion", "p=t**2/2", "--motion", "theta=0", "-t", "1"], "inputs.csv"),
    ("lyapunov", "simple-pendulum", ["--time", "2"], "lyapunov.csv"),
    ("map", "ziegler", ["--x", "P=0:4"], "map.json"),
    ("sweep", "ziegler", ["--vary", "P=0:4:5"], "sweep.json"),
    ("equilibria", "simple-pendulum", ["--vary", "l=1:2"], "branches.json"),
    (
        *("orbit", "spherical-pendulum"),
        ["--period", "1.57", "--turns", "psi=1", "-s", "psi_dot=4", "-s", "theta=0.9"],
        "orbit.json",
    ),
    ("oscillations", "spring-pendulum", ["--of", "theta", "--format", "svg"], "*.svg"),
    ("regressor", "spatial-arm", [], "regressor.json"),
    ("tradeoff", "simple-pendulum", ["--time", "0.1", "--budget", "1"], "tradeoff.csv"),
    ("extremes", "simple-pendulum", ["--budget", "1"], "extremes.csv"),
]

#: Commands that write one file, or copies, and their words.
FILES = [
    ("view", ["{simple-pendulum}", "--out", "{there}"]),
    ("groups", ["{simple-pendulum}", "--out", "{there}"]),
    ("average", ["{shaken-pendulum}", "--out", "{there}"]),
    ("convert", ["{simple-pendulum}", "--out", "{there}"]),
    ("new", ["{there}", "--like", "pendulum"]),
    ("examples", ["simple-pendulum", "--out", "{folder}"]),
]


@pytest.mark.parametrize(("command", "system", "words", "name"), FOLDERS)
def test_a_file_of_somebody_else_stays(command: str, system: str, words: list[str], name: str, tmp_path: Path) -> None:
    out = tmp_path / "out"
    asked = [command, SHIPPED / f"{system}.yaml", *words, "-o", out]
    if "*" in name:
        assert invoked(*asked).exit_code == 0
        name = next(out.glob(name)).name
        shutil.rmtree(out)
    out.mkdir()
    (out / name).write_text("mine")
    done = invoked(*asked, code=1)
    assert f"{name}: it is there already and mbsym did not write it; --force replaces it" in " ".join(
        done.stderr.split()
    )
    assert [path.name for path in out.iterdir() if path.name != "chunks"] == [name]
    assert (out / name).read_text() == "mine"


def test_by_force_it_is_replaced_and_from_then_on_it_is_ours(tmp_path: Path) -> None:
    asked = ["run", SHIPPED / "simple-pendulum.yaml", "-f", "json", "-o", tmp_path]
    (tmp_path / "results.json").write_text("mine")
    assert invoked(*asked, "--force").exit_code == 0
    assert (tmp_path / "results.json").read_text() != "mine"
    assert invoked(*asked).exit_code == 0
    (tmp_path / "report.tex").write_text("mine")
    assert invoked(*asked).exit_code == 0  # it is not in the way
    assert invoked(*asked[:2], "-f", "latex", "-o", tmp_path).exit_code == 1
    (tmp_path / ".mbsym.json").unlink()
    assert invoked(*asked).exit_code == 0  # what holds the same already loses nothing


def test_a_batch_keeps_to_it_too(tmp_path: Path) -> None:
    work, out = tmp_path / "work", tmp_path / "out"
    work.mkdir()
    out.mkdir()
    shutil.copy(SHIPPED / "simple-pendulum.yaml", work)
    (out / "summary.json").write_text("mine")
    done = invoked("batch", work, "-o", out, "-f", "json", "-j", "1", code=1)
    assert "--force replaces it" in done.stderr
    assert (out / "summary.json").read_text() == "mine"
    (out / "summary.json").unlink()
    assert invoked("batch", work, "-o", out, "-f", "json", "-j", "1").exit_code == 0
    assert invoked("batch", work, "-o", out, "-f", "json", "-j", "1").exit_code == 0


@pytest.mark.parametrize(("command", "words"), FILES)
def test_a_single_file_is_not_replaced(
    command: str, words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    there = filed(tmp_path / "simple-pendulum.yaml", "mine")
    given = {path.stem: path for path in SHIPPED.glob("*.yaml")}
    full = [word.format_map({**given, "there": there.name, "folder": tmp_path}) for word in words]
    done = invoked(command, *full, code=2)
    assert "is there already" in done.stderr
    assert "--force" in done.stderr
    assert there.read_text() == "mine"
    assert invoked(command, *full, "--force").exit_code == 0
    assert there.read_text() != "mine"


def test_a_page_at_its_usual_place_is_ours(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    page = tmp_path / "reports" / "simple-pendulum" / "view.html"
    page.parent.mkdir(parents=True)
    page.write_text("mine")
    asked = ["view", SHIPPED / "simple-pendulum.yaml", "-q"]
    assert invoked(*asked).exit_code == 1
    assert page.read_text() == "mine"
    page.unlink()
    assert invoked(*asked).exit_code == 0
    assert invoked(*asked).exit_code == 0


def test_every_command_that_writes_is_here() -> None:
    """``watch`` writes as ``run`` does, by the same function."""
    context = click.Context(main)
    tried = {getattr(one, "values", one)[0] for one in [*FOLDERS, *FILES]} | {"batch", "watch"}
    for name in COMMANDS:
        command = main.get_command(context, name)
        assert command is not None
        options = {one.name for one in command.params}
        assert ("force" in options) == (name in tried), name
        assert "out" not in options or name in tried


def test_there_is_no_other_way_to_write() -> None:
    """Single files go through ``Options.unwritten``, sets through ``deliver``; chunks of sweeps are their own."""
    for path in Path(mbsym_cli.__file__).parent.rglob("*.py"):
        calls = {
            getattr(node.func, "attr", getattr(node.func, "id", ""))
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
            if isinstance(node, ast.Call)
        }
        if "write_whole" in calls and "/".join(path.parts[-2:]) != "cli/files.py":
            assert "unwritten" in calls, path.stem
        assert not calls & {"write_text", "write_bytes"}, path.stem
