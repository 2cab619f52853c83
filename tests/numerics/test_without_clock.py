"""No output depends on elapsed time: clocks that jump ahead by 100 s between two calls change no byte of what is told.

Masked are measured seconds, which are information: a number followed by s, ms or µs in the lines of the terminal
(``MEASURED``).  Tables and JSON files of a simulation hold none, and are compared as they are.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

#: One measured duration in the lines of the terminal.
MEASURED = re.compile(r"\b[0-9][0-9.]*(?:e[-+]?\d+)? (?:s|ms|µs)\b")

#: Commands, by their words; each writes to ``out``, if it writes anything.
COMMANDS = {
    "estimate": ("simulate", "systems/double-pendulum.yaml", "--time", "5", "--out", "out"),
    "switches": ("simulate", "systems/stick-slip.yaml", "--time", "5", "--out", "out"),
    "accuracy": (
        *("simulate", "systems/simple-pendulum.yaml", "--accuracy", "1e-6", "--time", "5"),
        *("--out", "out"),
    ),
    "equilibria": ("equilibria", "systems/simple-pendulum.yaml"),
}

#: A process whose clocks jump, and then the command line.
JUMPING = """
import sys, time
from itertools import count
for name in ("perf_counter", "monotonic", "time", "process_time", "thread_time"):
    steps, real = count(), getattr(time, name)
    setattr(time, name, lambda steps=steps, real=real: real() + 100.0 * next(steps))
from mbsym_cli.process import command
sys.argv[0] = 'mbsym'
command()
"""
PLAIN = "import sys; from mbsym_cli.process import command; sys.argv[0] = 'mbsym'; command()"


def told(folder: Path, program: str, seed: str, words: tuple[str, ...]) -> dict[str, str]:
    """What a command prints, and every file that it writes."""
    folder.mkdir()
    for name in ("systems", "tests"):
        (folder / name).symlink_to(ROOT / name)
    environment = {**os.environ, "PYTHONHASHSEED": seed, "COLUMNS": "80", "NO_COLOR": "1"}
    done = subprocess.run(
        [sys.executable, "-c", program, *words],
        cwd=folder, env=environment, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    files = {
        str(path.relative_to(folder)): path.read_text("utf-8")
        for path in sorted((folder / "out").rglob("*"))
        if path.suffix in (".csv", ".json")
    }
    return {"terminal": MEASURED.sub("?", done.stdout + done.stderr), **files}


@pytest.mark.parametrize("name", COMMANDS)
def test_clocks_decide_nothing(name: str, tmp_path: Path) -> None:
    plain = told(tmp_path / "plain", PLAIN, "1", COMMANDS[name])
    jumping = told(tmp_path / "jumping", JUMPING, "2", COMMANDS[name])
    assert jumping == plain
    if name in ("estimate", "switches", "accuracy"):
        assert "about" in plain["terminal"]
        assert "not estimated" not in plain["terminal"]
