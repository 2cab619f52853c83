"""No output depends on elapsed time: clocks that jump ahead by 100 s at every look change no byte of what is told.

Masked are measured seconds, which are information: in the lines of the terminal a number followed by s, ms or µs
(``MEASURED``), in files what ``MEASURED_IN`` names.  All else is compared as it is.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]

#: One measured duration in the lines of the terminal; lines are compared without the blanks that fill columns.
MEASURED = re.compile(r"\b[0-9][0-9.]*(?:e[-+]?\d+)? ?(?:s|ms|µs)\b")

#: Commands, each in a folder of its own.
COMMANDS: dict[str, str] = {
    "estimate": "simulate systems/double-pendulum.yaml --time 5 --format csv --out out",
    "switches": "simulate systems/stick-slip.yaml --time 5 --format csv --out out",
    "constraints": "simulate systems/four-bar.yaml --time 2 --format csv --out out",
    "accuracy": "simulate systems/simple-pendulum.yaml --accuracy 1e-6 --time 5 --format csv --out out",
    "plan": "simulate systems/satellite.yaml --accuracy 1e-6 --time 5 --plan",
    "equilibria": "equilibria systems/simple-pendulum.yaml",
}

#: Runs all of them in one process, whose clocks are those of the first argument; prints what each came to.
PROGRAM = """
import json, sys, time
if sys.argv[1] == "jumping":
    from itertools import count
    for name in ("perf_counter", "monotonic", "time", "process_time", "thread_time"):
        steps, real = count(), getattr(time, name)
        setattr(time, name, lambda steps=steps, real=real: real() + 100.0 * next(steps))
import os
from pathlib import Path
from click.testing import CliRunner
from mbsym_cli.main import main
told = {}
for name, words in json.loads(sys.argv[2]).items():
    Path(name).mkdir()
    Path(name, "systems").symlink_to(Path(sys.argv[3], "systems"))
    os.chdir(name)
    done = CliRunner().invoke(main, words.split())
    told[name] = {"code": done.exit_code, "terminal": done.output}
    os.chdir("..")
print(json.dumps(told))
"""


def started(folder: Path, clocks: str, seed: str) -> subprocess.Popen[str]:
    folder.mkdir()
    environment = {**os.environ, "PYTHONHASHSEED": seed, "COLUMNS": "80", "NO_COLOR": "1"}
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM, clocks, json.dumps(COMMANDS), str(ROOT)],
        cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def ended(folder: Path, process: subprocess.Popen[str]) -> dict[str, dict[str, str]]:
    """What every command prints, and all files that it writes."""
    out, errors = process.communicate(timeout=300)
    assert process.returncode == 0, errors
    told: dict[str, dict[str, str]] = json.loads(out.splitlines()[-1])
    for name, one in told.items():
        assert one["code"] == 0, one["terminal"]
        told[name] = {"terminal": MEASURED.sub("?", one["terminal"])}
        told[name] |= {
            str(path.relative_to(folder)): path.read_text("utf-8")
            for path in sorted((folder / name / "out").rglob("*"))
            if path.is_file()
        }
    return told


def test_clocks_decide_nothing(tmp_path: Path) -> None:
    plain, jumping = tmp_path / "plain", tmp_path / "jumping"
    runs = [(plain, started(plain, "plain", "1")), (jumping, started(jumping, "jumping", "2"))]
    told = [ended(folder, process) for folder, process in runs]
    for name in COMMANDS:
        assert told[0][name] == told[1][name], name
    for name in ("estimate", "switches", "accuracy"):
        assert "about" in told[0][name]["terminal"]
        assert "not estimated" not in told[0][name]["terminal"]
