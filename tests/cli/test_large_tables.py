"""A million rows: the table is written part by part, never held as text, and reads back exactly."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from conftest import SHIPPED
from test_simulate import summary

pytest.importorskip("resource")

PROGRAM = (
    "import resource, sys; from mbsym_cli.main import main\n"
    "try: main(sys.argv[1:])\n"
    "finally: print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, file=sys.stderr)"
)


def peak(folder: Path, rows: int) -> int:
    """Kilobytes at most."""
    words = ["simulate", str(SHIPPED / "simple-pendulum.yaml"), "--time", "10", "--samples", str(rows), "--no-estimate"]
    words += ["-f", "csv", "-q", "-o", str(folder)]
    done = subprocess.run([sys.executable, "-c", PROGRAM, *words], capture_output=True, text=True, check=True)
    return int(done.stderr.split()[-1])


@pytest.mark.skipif(sys.platform != "linux", reason="kilobytes on Linux")
def test_a_row_costs_little_memory(tmp_path: Path) -> None:
    """Five columns are 40 bytes as numbers and about 90 as text: less than 120 bytes a row, so no text is held."""
    few, many = peak(tmp_path / "few", 10_001), peak(tmp_path / "many", 1_000_001)
    assert (many - few) * 1024 / 990_000 < 120
    assert summary(tmp_path / "many")["reached"]["samples"] == 1_000_001
    with (tmp_path / "many" / "trajectory.csv").open(encoding="utf-8") as stream:
        lines = sum(1 for _ in stream)
    assert lines == 1_000_002
