"""What is installed, and what ``make clean`` takes away."""

from __future__ import annotations

import ast
import importlib
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


def test_the_package_says_that_it_is_typed() -> None:
    packaged = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["package-data"]
    assert "py.typed" in packaged["mbsym"]
    assert (ROOT / "mbsym" / "py.typed").exists()


def test_every_package_is_listed() -> None:
    listed = set(tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["packages"])
    inits = [path for folder in ("mbsym", "cli") for path in (ROOT / folder).rglob("__init__.py")]
    found = {".".join(path.parent.relative_to(ROOT).parts) for path in inits}
    found = {name.replace("cli", "mbsym_cli", 1) if name.split(".")[0] == "cli" else name for name in found}
    assert found | {"mbsym_systems", "mbsym_templates"} == listed


@pytest.mark.skipif(shutil.which("make") is None, reason="no make")
def test_cleaning_keeps_what_belongs_to_the_user(tmp_path: Path) -> None:
    shutil.copy(ROOT / "Makefile", tmp_path)
    own = {"reports/satellite/report.tex", "cli/own.py", "notes.txt"}
    for name in (*own, ".venv/bin/x", "build/x", "mbsym.egg-info/x", "cli/__pycache__/x"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("x")
    subprocess.run(["make", "clean"], cwd=tmp_path, check=True, capture_output=True)
    left = {str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if path.is_file()}
    assert left == {"Makefile"} | own


@pytest.mark.parametrize("path", sorted(Path(__file__).parent.glob("bench/*.py")), ids=lambda path: path.stem)
def test_benches_import_what_there_is(path: Path) -> None:
    """They run seldom: what moves in mbsym is missed there long after."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] == "mbsym":
            module = importlib.import_module(node.module or "")
            missing = [name.name for name in node.names if not hasattr(module, name.name)]
            for name in missing:  # a module of a package
                importlib.import_module(f"{node.module}.{name}")


@pytest.mark.parametrize("name", ["loops_bench", "maps_bench", "partition_bench"])
def test_benches_find_the_tests_that_they_use(name: str) -> None:
    """Alone, as they are run: without what pytest puts on the path."""
    path = Path(__file__).parent / "bench" / f"{name}.py"
    code = f"import runpy; runpy.run_path({str(path)!r}, run_name='bench')"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
