"""Very many rows go to a file as they come: the same bytes, the same words, and the memory of few rows."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import SHIPPED, invoked

from mbsym.numerics import streamed
from mbsym.simulation.sampling import Grid


@pytest.mark.parametrize(
    ("grid", "same"),
    [
        (Grid(1001, 10 / 1000, 10.0), np.linspace(0, 10, 1001)),
        (Grid(30_000, 0.7 / 29_999, 0.7), np.linspace(0, 0.7, 30_000)),
        (Grid(5, 0.3, 1.0), np.array([0, 0.3, 0.6, 3 * 0.3, 1.0])),
    ],
)
def test_a_grid_is_the_array_that_it_stands_for(grid: Grid, same: Any) -> None:
    assert len(grid) == len(same)
    assert np.array_equal(grid[:], same)
    assert np.array_equal(grid[2:4], same[2:4])
    assert [grid[0], grid[1], grid[-1]] == [same[0], same[1], same[-1]]


def both_ways(folder: Path, monkeypatch: pytest.MonkeyPatch, words: list[str]) -> tuple[Any, Any]:
    """(exit code, output, files) of a command whose rows go to a file, and of the one that holds them all."""
    import mbsym.simulation.request as request

    found = []
    for name, most in (("streamed", 500), ("held", 10**9)):
        monkeypatch.setattr(request, "SHOWN", most)
        out = folder / name
        done = invoked("simulate", *words, "-o", out)
        files = {path.name: path.read_bytes() for path in out.iterdir() if path.suffix in (".csv", ".json")}
        del files[".mbsym.json"]
        found.append((done.exit_code, files))
    return found[0], found[1]


@pytest.mark.parametrize(
    "words",
    [
        ["simple-pendulum", "--time", "10", "--samples", "20000"],
        ["double-pendulum", "--time", "5", "--every", "0.0004", "--invariants"],
        ["heavy-top", "--time", "2", "--samples", "9000", "--invariants", "-f", "csv,bodies-csv"],
        ["double-pendulum", "--time", "5", "--samples", "9000", "--event", "theta1 = 0", "--stop", "theta2 > 2"],
        ["satellite", "--time", "3", "--samples", "9000", "--method", "rk4", "--step", "0.01"],
        ["stick-slip", "--time", "5", "--samples", "9000"],
        ["simple-pendulum", "--time", "10", "--samples", "9000", "--arithmetic", "extended"],
        ["double-pendulum", "--time", "10", "--samples", "9000", "--step-limit", "50"],
    ],
    ids=lambda words: " ".join(words[:1] + words[3:]),
)
def test_bytes_and_words_are_those_of_the_run_that_holds_its_rows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: list[str]
) -> None:

    formats = [] if "-f" in words else ["-f", "csv"]
    (code, streamed), (same, held) = both_ways(
        tmp_path, monkeypatch, [str(SHIPPED / f"{words[0]}.yaml"), *words[1:], *formats]
    )
    assert code == same
    assert code in (0, 3)
    assert streamed.keys() == held.keys()
    tables = [name for name in held if name.endswith(".csv")]
    assert tables
    for name in tables:
        assert streamed[name] == held[name], name
    assert json.loads(streamed["simulation.json"]) == json.loads(held["simulation.json"])


def test_a_row_that_is_lost_is_noticed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The comparison above can fail: with a block's last row left out the tables differ."""
    right = streamed.Stored.blocks

    def lossy(self: streamed.Stored) -> Any:
        for start, rows in right(self):
            yield start, rows[:, :-1] if start else rows

    monkeypatch.setattr(streamed.Stored, "blocks", lossy)
    words = [str(SHIPPED / "simple-pendulum.yaml"), "--time", "10", "--samples", "20000", "-f", "csv"]
    (_, parted), (_, held) = both_ways(tmp_path, monkeypatch, words)
    assert parted["trajectory.csv"] != held["trajectory.csv"]


def test_nothing_is_left_where_there_is_no_room(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(self: streamed.Stored, block: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(streamed.Stored, "append", full)
    words = ["simulate", str(SHIPPED / "simple-pendulum.yaml"), "--time", "10", "--samples", "30000", "-f", "csv"]
    done = invoked(*words, "-o", tmp_path / "out", code=1)
    assert "cannot be written" in done.output
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("more", "option"),
    [(["--certify", "1e-8"], "--certify"), (["--vary", "theta=normal(1, 0.01)", "--members", "3"], "--vary")],
)
def test_what_needs_all_rows_at_once_says_so(tmp_path: Path, more: list[str], option: str) -> None:
    words = ["simulate", str(SHIPPED / "simple-pendulum.yaml"), "--time", "10", "--samples", "5000000", *more]
    done = invoked(*words, "-o", tmp_path / "out", code=2)
    assert "held in memory" in done.output
    assert option in done.output
    assert not list(tmp_path.iterdir())


PROGRAM = (
    "import resource, sys; from mbsym_cli.main import main\n"
    "try: main(sys.argv[1:])\n"
    "finally: print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, file=sys.stderr)"
)


@pytest.mark.skipif(sys.platform != "linux", reason="kilobytes on Linux")
def test_ten_times_the_rows_take_no_more_memory(tmp_path: Path) -> None:
    """300,000 rows of five columns more would be 12 MB as numbers."""
    peaks = []
    for rows in (30_001, 330_001):
        words = ["simulate", str(SHIPPED / "simple-pendulum.yaml"), "--time", "10", "--samples", str(rows)]
        words += ["--no-estimate", "-f", "csv", "-q", "-o", str(tmp_path / str(rows))]
        done = subprocess.run([sys.executable, "-c", PROGRAM, *words], capture_output=True, text=True, check=True)
        peaks.append(int(done.stderr.split()[-1]))
    assert peaks[1] - peaks[0] < 5_000
