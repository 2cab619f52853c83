"""What the tests of batches share: small descriptions, one that never ends, and the command in a process of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import warm
from warm import COMMAND

#: Forked processes, signals and locks as POSIX has them.
needs_posix = pytest.mark.skipif(os.name != "posix", reason="signals and limits of POSIX")

#: With these a small system takes half a second.
QUICK = ("--format", "json", "--problems", "1-3")

START = [sys.executable, "-c", COMMAND]


def pendulum(name: str = "Pendulum", length: str = "l") -> str:
    return f"""\
mbsym: 1
name: {name}
parameters: {{m: positive, l: positive, g: positive}}
bodies:
  - name: bob
    attached to: 0
    rotation: {{axes: [3], angles: [theta]}}
    mass centre: [0, -{length}, 0]
    mass: m
    inertia about: mass centre
    inertia: [0, 0, 0]
    coordinates: [theta]
loads:
  - uniform gravity: {{acceleration: g, direction: [0, -1, 0]}}
motion: {{theta: 0}}
"""


def chain(bodies: int) -> str:
    """A spatial chain; from a dozen bodies on no machine has the memory, or anybody the time, for its closed form."""
    text = "mbsym: 1\nname: Chain\nparameters: {m: positive, l: positive, g: positive, J: positive}\nbodies:\n"
    for k in range(1, bodies + 1):
        text += f"""\
  - name: b{k}
    attached to: {f"b{k - 1}" if k > 1 else 0}
    rotation: {{axes: [{k % 3 + 1}], angles: [q{k}]}}
    connection point: {"[0, 0, 0]" if k == 1 else "[l, 0, l]"}
    mass centre: [l, l, 0]
    mass: m
    inertia about: mass centre
    inertia: [J, J, 2*J]
"""
    return text + "loads:\n  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}\n"


#: No bound on terms: what takes too long takes too long.
ENDLESS = ("--terms", "1000000000000")


def folder_of(path: Path, **files: str) -> Path:
    """A folder with descriptions; ``sub__name`` is ``name`` in the folder ``sub``."""
    for name, text in files.items():
        file = path.joinpath(*name.split("__")).with_suffix(".yaml")
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
    return path


def command(*arguments: object) -> list[str]:
    return [*START, "batch", *map(str, arguments)]


def batch(*arguments: object, cwd: Path | None = None, code: int = 0) -> subprocess.CompletedProcess[str]:
    """The command, which has to end with this exit code."""
    done = warm.run(["batch", *arguments], cwd=cwd)
    assert done.returncode == code, done.stdout + done.stderr
    return done


def summary(out: Path, name: str = "summary.json") -> dict[str, Any]:
    found: dict[str, Any] = json.loads((out / name).read_text(encoding="utf-8"))
    return found


def outcomes(out: Path) -> dict[str, str]:
    """The outcome of every description, by the name of its file."""
    return {Path(one["file"]).stem: one["outcome"] for one in summary(out)["systems"]}


def cached(out: Path) -> dict[str, bool]:
    """Whether every description was up to date, by the name of its file."""
    return {Path(file).stem: one["cached"] for file, one in summary(out)["run"]["systems"].items()}


def files_of(out: Path) -> dict[str, bytes]:
    """Every file in the folders of descriptions (or of ``out``, if it is the folder of one); none has seconds in it."""
    folders = {file.parent for file in out.rglob("outcome.json")} or {out}
    return {
        file.relative_to(out).as_posix(): file.read_bytes()
        for folder in folders
        for file in sorted(folder.rglob("*"))
        if file.is_file()
    }
