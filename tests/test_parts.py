"""An installation without the parts that it may lack: what else there is works, and a part that is missing is named."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import mbsym
from mbsym.algebra.parts import PARTS, installed, missing
from mbsym.serving.worker import perform

ROOT = Path(mbsym.__file__).parents[1]

#: Each command in the same process: its exit code on standard output, behind what it printed.
PROGRAM = """
import sys
from mbsym_cli.main import main
for line in sys.stdin.read().splitlines():
    try:
        main.main(line.split(), standalone_mode=False)
        code = 0
    except SystemExit as ended:
        code = ended.code or 0
    sys.stderr.flush()
    print(f"<{code}: {line}>", flush=True)
"""


def commands(place: Path, *lines: str) -> str:
    """What they print, standard error with it."""
    environment = os.environ | {"PYTHONPATH": str(place), "COLUMNS": "200"}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        input="\n".join(lines),
        cwd=place,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=True,
    )
    return done.stdout


@pytest.fixture(scope="module")
def core(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy without them, compiled files and all."""
    place = tmp_path_factory.mktemp("core")
    left_out = {ROOT / part.replace(".", "/") for part in PARTS}
    left_out |= {path.with_suffix(".py") for path in left_out}
    for name, called in (("mbsym", "mbsym"), ("cli", "mbsym_cli"), ("templates", "mbsym_templates")):
        shutil.copytree(
            ROOT / name,
            place / called,
            ignore=lambda folder, names: [x for x in names if Path(folder) / x in left_out],
        )
    for system in ("double-pendulum", "clebsch-poisson"):
        shutil.copy(ROOT / "systems" / f"{system}.yaml", place)
    return place


def test_each_part_is_there() -> None:
    assert all(map(installed, PARTS))


def test_another_module_that_is_not_found_is_a_mistake() -> None:
    assert missing(ModuleNotFoundError(name="mbsym.maps.line")) == "mbsym.maps"
    assert missing(ModuleNotFoundError(name="mbsym.mapping")) == ""
    assert missing(ImportError("cannot import name", name="mbsym.maps")) == ""
    assert missing(ModuleNotFoundError(name="numpy")) == ""


def test_the_editor_names_what_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    """None in ``sys.modules`` is how an import fails of what is not there."""
    text = (ROOT / "systems" / "double-pendulum.yaml").read_text()
    task = {"kind": "map", "text": text, "name": "x.yaml", "x": {"name": "m1", "low": "1", "high": "2"}}
    monkeypatch.setitem(sys.modules, "mbsym.maps.mapping", None)
    assert [*perform(task)] == [{"kind": "failed", "words": "mbsym.maps is not installed"}]


def test_everything_else_works_without_them(core: Path) -> None:
    lines = (
        "check double-pendulum.yaml",
        "show double-pendulum.yaml L",
        "run double-pendulum.yaml --out all",
        "simulate double-pendulum.yaml --time 0.1 --out run",
        "equilibria double-pendulum.yaml",
        "convert double-pendulum.yaml",
        "explain 6",
        "schema results",
        "--help",
    )
    said = commands(core, *lines)
    assert [line for line in lines if f"<0: {line}>" not in said] == []
    assert "not installed" not in said
    assert "please report it" not in said
    made = {path.name for path in (core / "all").iterdir()}
    assert made >= {"report.tex", "report.html", "report.wl", "model.py", "model.c", "results.json"}


def test_what_is_missing_is_named(core: Path) -> None:
    """A problem has no result, with the reason, beside those that have one; a command ends with a sentence."""
    said = commands(
        core,
        "run clebsch-poisson.yaml -p 2,9-12 --out further",
        "run double-pendulum.yaml -p 3 -f julia --out exported",
        "map double-pendulum.yaml --x m1=1:2 --y m2=1:2",
        "symmetries clebsch-poisson.yaml",
        "explain 11",
    )
    run, _, _ = said.partition("<0: run clebsch-poisson.yaml")
    for part in ("symmetries", "normal_forms", "small_parameter"):
        assert f"no result: mbsym.problems.{part} is not installed" in run
    written = (core / "further" / "report.tex").read_text()
    assert "Problem 9" in written
    assert "is not installed" in written
    assert "model.jl cannot be written: mbsym.report.exports is not installed" in said
    for line in ("map", "symmetries", "explain 11"):
        assert f"is not installed\n<1: {line}" in said
    assert "please report it" not in said
