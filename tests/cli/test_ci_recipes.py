"""The recipes that people copy: their commands are run, their files are read by what reads them."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import tomllib
from pathlib import Path
from typing import Any

import pytest
import warm
import yaml

ROOT = Path(__file__).parents[2]
RECIPES = ROOT / "docs" / "ci"


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """Somebody's project: two descriptions, a file that is none, and mbsym on the path."""
    systems = tmp_path / "systems"
    systems.mkdir()
    for name in ("simple-pendulum", "ziegler"):
        shutil.copy(ROOT / "systems" / f"{name}.yaml", systems)
    (systems / "notes.yaml").write_text("just: notes\n", encoding="utf-8")
    commands = tmp_path / "bin"
    commands.mkdir()
    warm.script(commands)
    return tmp_path


def shell(command: str, project: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {"PATH": f"{project / 'bin'}{os.pathsep}{os.environ['PATH']}"} | variables
    return subprocess.run(
        ["/bin/sh", "-c", command],
        cwd=project,
        env=environment,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


def recipe(name: str) -> Any:
    return yaml.safe_load((RECIPES / name).read_text(encoding="utf-8"))


def own_steps(steps: list[dict[str, Any]]) -> list[str]:
    return [step["run"] for step in steps if step.get("run", "").startswith("mbsym ")]


@pytest.mark.skipif(os.name != "posix", reason="a shell")
def test_the_github_workflow_runs(project: Path) -> None:
    workflow = recipe("github-actions.yml")
    (job,) = workflow["jobs"].values()
    assert workflow[True] == ["push", "pull_request"]  # YAML reads on: as true
    steps = job["steps"]
    assert all(("uses" in step) != ("run" in step) for step in steps)
    assert all(re.fullmatch(r"[\w-]+/[\w/-]+@v\d+", step["uses"]) for step in steps if "uses" in step)
    assert shell("mbsym run systems --out reports --quiet", project).returncode == 0
    commands = own_steps(steps)
    assert len(commands) == 3
    for command in commands:
        done = shell(command, project)
        assert done.returncode == 0, done.stdout + done.stderr
    for step in steps:
        for key in ("sarif_file", "path"):
            assert (project / step.get("with", {}).get(key, ".")).exists()
    # What is committed is no longer that of the description: the workflow fails.
    file = project / "systems" / "ziegler.yaml"
    file.write_text(re.sub(r"(\bmass: )m\b", r"\g<1>2*m", file.read_text(encoding="utf-8"), count=1), encoding="utf-8")
    assert shell(commands[-1], project).returncode == 1
    file.write_text("mbsym: 1\nname: x\nbodies: 3\n", encoding="utf-8")
    done = shell(commands[0], project)
    assert done.returncode == 2
    assert done.stdout.startswith("::error file=systems/ziegler.yaml,line=3,")


@pytest.mark.skipif(os.name != "posix", reason="a shell")
def test_the_gitlab_job_runs_and_leaves_what_it_names(project: Path) -> None:
    (job,) = recipe("gitlab-ci.yml").values()
    for command in job["script"]:
        assert shell(command, project).returncode == 0
    assert (project / job["artifacts"]["reports"]["junit"]).exists()
    assert all((project / path).exists() for path in job["artifacts"]["paths"])


@pytest.mark.skipif(os.name != "posix", reason="a shell")
@pytest.mark.parametrize("file", ["docs/ci/pre-commit-config.yaml", ".pre-commit-hooks.yaml"])
def test_the_hook_stops_a_mistake(file: str, project: Path) -> None:
    found = yaml.safe_load((ROOT / file).read_text(encoding="utf-8"))
    hook = found[0] if isinstance(found, list) else found["repos"][0]["hooks"][0]
    assert re.search(hook["files"], "systems/ziegler.yaml")
    assert not re.search(hook["files"], "systems/ziegler.py")
    command = hook["entry"].split()[0]
    assert command in tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["scripts"]
    assert shell(f"{hook['entry']} systems/ziegler.yaml", project).returncode == 0
    assert shell(f"{hook['entry']} systems/notes.yaml", project).returncode == 0  # no description: not ours to judge
    (project / "systems" / "ziegler.yaml").write_text("mbsym: 1\n", encoding="utf-8")
    assert shell(f"{hook['entry']} systems/ziegler.yaml", project).returncode == 2


def test_the_image_holds_every_package() -> None:
    """What the Dockerfile copies is what pyproject.toml installs."""
    copied = re.findall(r"^COPY (.+) \S+$", (RECIPES / "Dockerfile").read_text(encoding="utf-8"), re.MULTILINE)
    names = " ".join(copied).split()
    assert all((ROOT / name).exists() for name in names)
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    folders = project["tool"]["setuptools"]["package-dir"]
    roots = {name.split(".")[0] for name in project["tool"]["setuptools"]["packages"]}
    packages = {folders.get(name, name) for name in roots}
    assert packages | {"pyproject.toml", project["project"]["readme"]} <= set(names)


@pytest.mark.skipif(os.name != "posix", reason="a shell")
def test_the_job_array_derives_each_system_once(project: Path) -> None:
    script = RECIPES / "job-array.sh"
    for part in ("1", "2"):
        done = shell(str(script), project, SLURM_ARRAY_TASK_ID=part, SLURM_ARRAY_TASK_COUNT="2")
        assert done.returncode == 0, done.stderr
    assert {path.parent.name for path in (project / "build").glob("*/results.json")} == {"simple-pendulum", "ziegler"}
    assert {path.name for path in (project / "build").glob("summary*")} == {
        "summary-1-of-2.json",
        "summary-2-of-2.json",
    }
