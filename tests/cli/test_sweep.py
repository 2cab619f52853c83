"""``mbsym sweep``: tables that hold what they say, chunks that are kept and joined, complaints all at once."""

from __future__ import annotations

import csv
import json
from math import cos, sin, sqrt
from pathlib import Path

import jsonschema
import pytest
from click.testing import Result
from conftest import SHIPPED, filed, invoked

from mbsym.report.schemas import schema

PLANE = ["--vary", "alpha=-0.9:0.9:40", "--vary", "gamma=-0.9:0.9:30", "-s", "p1=2/5", "-s", "p2=1/5"]


def sweep(name: str, folder: Path, *options: str, code: int | None = None) -> Result:
    return invoked("sweep", SHIPPED / f"{name}.yaml", "-o", folder, *options, code=code)


def rows(folder: Path) -> list[dict[str, str]]:
    with (folder / "sweep.csv").open() as stream:
        return list(csv.DictReader(stream))


def told(folder: Path) -> dict:  # type: ignore[type-arg]
    found = json.loads((folder / "sweep.json").read_text())
    jsonschema.validate(found, schema("sweep"))
    return found  # type: ignore[no-any-return]


@pytest.fixture(scope="module")
def plane(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("plane")
    done = sweep("satellite", folder, *PLANE, code=0)
    assert "unstable" in done.output
    return folder


def test_the_satellites_plane_keeps_the_papers_conditions(plane: Path) -> None:
    """Stable by Lagrange's theorem (K > 0) needs alpha > 0 and gamma > p2, two of the paper's conditions (5)."""
    found = rows(plane)
    assert len(found) == 1200
    stable = [row for row in found if row["verdict"] == "stable"]
    assert stable
    assert all(float(row["alpha"]) > 0 and float(row["gamma"]) > 0.2 and row["unstable_roots"] == "0" for row in stable)
    assert all(int(row["unstable_roots"]) > 0 for row in found if row["verdict"] == "unstable")
    content = told(plane)
    assert sum(one["count"] for one in content["shares"]) == content["points"] == 1200
    assert content["stable"]["count"] == len(stable)
    assert content["stable"]["interval"] is None  # a grid is no random sample
    assert (plane / "sweep.png").stat().st_size > 1000


def test_shards_and_what_was_interrupted_give_the_same_bytes(plane: Path, tmp_path: Path, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    monkeypatch.setattr("mbsym.sweeps.sweep.chunks.__defaults__", (100,))
    for number in (2, 1):
        sweep("satellite", tmp_path, *PLANE, "--shard", f"{number}/2", "--jobs", "1", code=0)
        assert not (tmp_path / "sweep.csv").exists()
    kept = sorted((tmp_path / "chunks").iterdir())
    assert len(kept) == 12
    kept[3].write_bytes(kept[3].read_bytes()[:-20])  # a disk that lost something
    before = kept[0].stat().st_mtime_ns
    assert sweep("satellite", tmp_path, *PLANE).exit_code == 0
    assert (tmp_path / "sweep.csv").read_bytes() == (plane / "sweep.csv").read_bytes()
    assert kept[0].stat().st_mtime_ns == before  # and nothing else was measured again


def test_another_request_reads_no_chunks_of_this_one(tmp_path: Path) -> None:
    small = ["--vary", "alpha=-0.9:0.9:5", "--vary", "gamma=-0.9:0.9:5", "-s", "p1=2/5", "--format", "csv", "-s"]
    assert sweep("satellite", tmp_path, *small, "p2=1/5").exit_code == 0
    first = rows(tmp_path)
    assert sweep("satellite", tmp_path, *small, "p2=4/5").exit_code == 0
    assert rows(tmp_path) != first
    assert len(list((tmp_path / "chunks").iterdir())) == 2


def test_frequencies_are_those_of_the_closed_formulas(tmp_path: Path) -> None:
    """A spring pendulum: sqrt(k/m) along the spring, sqrt(g/(l0 + m g/k)) across."""
    sweep(
        "spring-pendulum",
        tmp_path,
        "--vary",
        "m=1 +- 20%",
        "--vary",
        "k=+-10%",
        "--points",
        "50",
        "--measure",
        "frequency",
        code=0,
    )
    for row in rows(tmp_path):
        m, k = float(row["m"]), float(row["k"])
        wanted = sorted([sqrt(k / m), sqrt(9.81 / (1 + m * 9.81 / k))])
        assert [float(row["frequency1"]), float(row["frequency2"])] == pytest.approx(wanted, rel=1e-9)
        assert (0.8 <= m <= 1.2, 36 <= k <= 44) == (True, True)


def test_a_formula_of_parameters_and_symbols(tmp_path: Path) -> None:
    sweep("satellite", tmp_path, "--vary", "Jx=2:3:5", "--measure", "alpha + 2*Jx", "--format", "csv", code=0)
    for row in rows(tmp_path):  # alpha = (c - b)/a = (Jz - Jx)/Jy
        jx = float(row["Jx"])
        assert float(row["value"]) == pytest.approx((2.3 - jx) / 1.2 + 2 * jx, rel=1e-12)


def test_motions_are_simulated(tmp_path: Path) -> None:
    """Small swings of a pendulum: the angle is theta0 cos(w t) but for theta0^2/16 of its frequency."""
    options = ["--vary", "theta=1/1000:2/1000:3", "--measure", "simulate:theta", "--time", "3", "--format", "csv"]
    sweep("spring-pendulum", tmp_path, *options, "-s", "l0=1", code=0)
    for row in rows(tmp_path):
        assert abs(float(row["least"])) <= 1.1 * float(row["theta"])
        assert float(row["least"]) < float(row["final"]) <= float(row["greatest"])


def test_the_probability_that_is_told_covers_the_true_one(tmp_path: Path) -> None:
    """Ziegler's undamped pendulum flutters above P = (7/2 - sqrt 2) k/l: of P uniform on (0, 4) 52.1447 % are below."""
    sweep(
        "ziegler",
        tmp_path,
        "--vary",
        "P=uniform(0, 4)",
        "--points",
        "20000",
        "--format",
        "csv,png",
        "-s",
        "k=1",
        code=0,
    )
    shares = {one["word"]: one for one in told(tmp_path)["shares"]}
    unstable = shares["unstable"]["interval"]
    assert unstable["low"] < 1 - (3.5 - sqrt(2)) / 4 < unstable["high"]


def test_parquet_holds_the_same(plane: Path, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    assert sweep("satellite", tmp_path, *PLANE, "--format", "parquet").exit_code == 0
    found = parquet.read_table(tmp_path / "sweep.parquet").to_pylist()
    wanted = rows(plane)
    assert [row["verdict"] for row in found] == [row["verdict"] for row in wanted]
    assert [row["alpha"] for row in found] == [float(row["alpha"]) for row in wanted]


def test_every_complaint_comes_at_once_and_nothing_is_written(tmp_path: Path) -> None:
    folder = tmp_path / "none"
    options = [
        "--vary",
        "q=1:2:3",
        "--vary",
        "m=2:1",
        "-s",
        "k=sqrt(2)",
        "--measure",
        "frequencie",
        "--shard",
        "4/3",
        "--time",
        "2",
    ]
    done = sweep("spring-pendulum", folder, *options, "--format", "cvs", "--points", "1", code=2)
    for code in ("unknown-name", "bad-variation", "bad-number", "unknown-format", "conflicting-options"):
        assert f"[{code}]" in done.stderr, code
    assert "did you mean 'frequency'?" in done.stderr
    assert "4" in done.stderr
    assert not folder.exists()


def test_what_a_relation_gives_does_not_vary(tmp_path: Path) -> None:
    done = sweep("satellite", tmp_path / "none", "--vary", "nu=1:2:3", "--vary", "alpha=0:1:3", code=2)
    assert "nu = omega0**2*R**3" in done.stderr


def test_systems_given_by_matrices_and_constrained_ones(tmp_path: Path) -> None:
    """Routh: the triangular points are stable in the first approximation below mu = 1/2 - sqrt(69)/18 = 0.0385209."""
    sweep("triangular-points", tmp_path / "points", "--vary", "mu=0.01:0.06:51", "--format", "csv", code=0)
    for row in rows(tmp_path / "points"):
        assert (row["verdict"] == "unstable") == (float(row["mu"]) > 0.5 - sqrt(69) / 18)
    sweep("bicycle", tmp_path / "bicycle", "--vary", "v=4:6.5:26", "--format", "csv", code=0)
    there = {float(row["v"]): row["unstable_roots"] for row in rows(tmp_path / "bicycle")}
    # Meijaard et al. 2007: weave at 4.292 m/s, capsize at 6.024 m/s
    assert all((count == "0") == (4.292 < v < 6.024) for v, count in there.items())


def test_motions_of_matrices_are_refused_by_name(tmp_path: Path) -> None:
    done = sweep(
        "triangular-points",
        tmp_path / "x",
        "--vary",
        "mu=0.01:0.06:5",
        "--measure",
        "simulate:x",
        "--time",
        "1",
        code=2,
    )
    assert "given by its matrices" in done.stderr


def test_ctrl_c_keeps_finished_chunks_and_the_same_command_goes_on(
    plane: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Interrupted after the fourth of 12 chunks: exit code 130, what is kept is told, no table; then the same bytes."""
    from mbsym.sweeps import sweep as module

    monkeypatch.setattr("mbsym.sweeps.sweep.chunks.__defaults__", (100,))
    whole = module.measured

    def interrupted(*arguments):  # type: ignore[no-untyped-def]
        for number, chunk in enumerate(whole(*arguments), start=1):
            yield chunk
            if number == 4:
                raise KeyboardInterrupt

    monkeypatch.setattr(module, "measured", interrupted)
    done = sweep("satellite", tmp_path, *PLANE, "--jobs", "1", code=130)
    assert "interrupted; 4 of 12 chunks are kept: the same command goes on from there" in done.stderr
    assert not (tmp_path / "sweep.csv").exists()
    kept = sorted((tmp_path / "chunks").iterdir())
    assert len(kept) >= 4
    before = [one.stat().st_mtime_ns for one in kept]
    monkeypatch.setattr(module, "measured", whole)
    assert sweep("satellite", tmp_path, *PLANE).exit_code == 0
    assert (tmp_path / "sweep.csv").read_bytes() == (plane / "sweep.csv").read_bytes()
    assert [one.stat().st_mtime_ns for one in kept] == before


FREE = """
mbsym: 1
name: A free body of revolution
parameters: {A: {value: 1}, C: {value: 2}}
bodies:
  - {name: body, attached to: 0, mass: 1, rotation: {axes: [1, 2, 3], angles: [f, g, h]},
     inertia about: joint, inertia: [A, A, C], speeds: {p: omega1, q: omega2, r: omega3},
     orientation: {e: quaternion}}
initial: {e0: 1, e1: 0, e2: 0, e3: 0, p: 0, q: 1/2, r: 1}
"""


def test_motions_are_measured_in_speeds_and_quaternions(tmp_path: Path) -> None:
    """p' = (A - C) q r/A, q' = (C - A) r p/A (Euler): p = -sin((C - A) t/A)/2; without p and q, e0 = cos(t/2)."""
    path = tmp_path / "free.yaml"
    path.write_text(FREE, encoding="utf-8")
    options = ["sweep", str(path), "--time", "2", "--format", "csv", "--vary", "A=1:2:3"]
    invoked(*options, "-o", str(tmp_path / "p"), "--measure", "simulate:p", code=0)
    wanted = [-sin((2 - a) / a * 2) / 2 for a in (1, 1.5, 2)]
    assert [float(row["final"]) for row in rows(tmp_path / "p")] == pytest.approx(wanted, abs=1e-7)
    path.write_text(FREE.replace("q: 1/2", "q: 0"), encoding="utf-8")
    invoked(*options, "-o", str(tmp_path / "e"), "--measure", "simulate:e0", code=0)
    assert [float(row["final"]) for row in rows(tmp_path / "e")] == pytest.approx([cos(1)] * 3, abs=1e-7)
    invoked(*options, "--measure", "simulate:e7", code=2)


def test_along_one_parameter_it_is_told_where_the_verdict_changes(tmp_path: Path) -> None:
    """x'' + k x = 0: unstable where k < 0, stable where k > 0; the points are -1, -1/3, 1/3, 1."""
    text = "mbsym: 1\nname: Oscillator\nparameters: {k: real}\nlinear system: {coordinates: [x], M: [[1]], K: [[k]]}\n"
    path = filed(tmp_path / "oscillator.yaml", text)
    out = ("--format", "csv", "--out", tmp_path)
    done = invoked("sweep", path, "--vary", "k=-1:1:4", *out, code=0)
    assert "  k = -0.333333 .. 0.333333  unstable, then stable\n  points                     4\n" in done.stdout
    assert "2 of 4 (50%)" in done.stdout
    done = invoked("sweep", path, "--vary", "k=1/2:1:4", *out, code=0)
    assert "then" not in done.stdout
