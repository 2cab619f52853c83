"""What comes with mbsym: descriptions run and check themselves, claims end as known, the figures are there."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
import warm
from conftest import SHIPPED, derived

import mbsym
from mbsym.analysis import Analysis
from mbsym.problems import ranges
from mbsym.problems.checks import EXACT, FAILED, NUMERICAL, UNDECIDED, Check
from mbsym.report.brief import brief

ROOT = SHIPPED.parent
FILES = sorted(path for path in SHIPPED.iterdir() if path.suffix in {".yaml", ".txt"})
MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8")

#: What the sources print and is not so, by place; everything else that is claimed holds.
#: tethered-satellites: c18 and c26 of the kinetic energy, the velocity of B (references/tethered-satellites, notes).
#: gyrostat: the moment of gravity in (1) has the wrong sign of N; a projection shows it (references/gyrostat, notes).
REFUTED = {
    "tethered-satellites.yaml": {"eq. (3)", *["c37", "c38", "c40", "c58", "c61", "c66"], "Table 2, x_B'"},
    "gyrostat.yaml": {"eq. (1), third component"},
    "satellite-with-damper-slow.yaml": {"section 4, last inequality"},
    "gyrostat-fast.yaml": {
        *("(41), p of order 0", "(41), p", "(41), q", "(41), q of order 2", "(41), gamma'", "(41), gamma''"),
        *("(41), gamma'' of order 2", "(43), theta", "(43), psi1", "(43), psi2"),
    },
}

#: Problems without a result, and why: these descriptions give no unperturbed motion.
NO_MOTION = {
    "euler-poisson.yaml",
    "heavy-gyrostat.yaml",
    "kovalevskaya.yaml",
    "goryachev-chaplygin.yaml",
    "hess-appelrot.yaml",
    "kirchhoff.yaml",
    "four-bar.yaml",
    "gyrostat.yaml",
    "gyrostat-fast.yaml",
    "gyrostat-poisson.yaml",
    "rolling-sphere.yaml",
    "rolling-sphere-speeds.yaml",
    "spatial-arm.yaml",
    "stick-slip.yaml",
    "tethered-satellites.yaml",
}

#: Problem 6 has none: the first approximation is time-dependent (``mbsym floquet`` judges it).
TIME_DEPENDENT = {"shaken-pendulum.yaml"}


@pytest.fixture(scope="module", params=FILES, ids=lambda path: path.name)
def shipped(request: pytest.FixtureRequest) -> tuple[Path, Analysis]:
    analysis = derived(request.param)
    for number in analysis.problems:
        analysis.stage(number)
    return request.param, analysis


def test_it_passes_its_self_check(shipped: tuple[Path, Analysis]) -> None:
    _, analysis = shipped
    outcomes = {check.name: check.outcome for check in analysis.checks}
    if analysis.system.linear is not None:
        assert outcomes.pop("linearisation") == NUMERICAL
        assert outcomes in ({}, {"stabilisation": EXACT})
        return
    last = "constraints" if analysis.system.constraints else "straight-line program"
    assert {"kinematics", "energy", "equations of motion", last} <= outcomes.keys()
    assert set(outcomes.values()) <= {EXACT, NUMERICAL}


def test_its_problems_have_results(shipped: tuple[Path, Analysis]) -> None:
    path, analysis = shipped
    without = {number for number in analysis.problems if analysis.stage(number).failure is not None}
    if path.name in TIME_DEPENDENT:
        assert without == {6}
        assert brief(analysis, 0.0).missing == "6: time-dependent"
        return
    assert without == ({4, 5, 6} if path.name in NO_MOTION else set())
    if without:
        assert brief(analysis, 0.0).missing == "4-6: no motion"


def test_its_claims_end_as_the_references_say(shipped: tuple[Path, Analysis]) -> None:
    path, analysis = shipped
    refuted = {result.claim.place for result in analysis.claims if result.refuted}
    undecided = [result.claim.place for result in analysis.claims if not result.holds and not result.refuted]
    assert refuted == REFUTED.get(path.name, set())
    assert undecided == []


def test_a_wrong_claim_would_be_noticed() -> None:
    text = (SHIPPED / "clebsch.yaml").read_text(encoding="utf-8")
    wrong = text.replace("A*B*g3**2", "A*C*g3**2", 1)
    assert wrong != text
    assert [result.refuted for result in mbsym.loads(wrong).claims].count(True) == 1


# --- one line a file ---


def test_ranges_of_numbers() -> None:
    assert ranges([1, 2, 3, 7], "-") == "1-3, 7"
    assert ranges([6, 5, 2], "-") == "2, 5-6"
    assert ranges([], "-") == ""


def test_a_line_tells_what_is_not_exact(monkeypatch: pytest.MonkeyPatch) -> None:
    analysis = mbsym.load(SHIPPED / "simple-pendulum.yaml")
    found = brief(analysis, 1.0)
    assert (found.problems, found.missing, found.self_check, found.claims) == ("1-7", "", "all exact", "no claims")
    checks = (Check("a", "", "", EXACT), Check("b", "", "", UNDECIDED), Check("c", "", "", EXACT))
    monkeypatch.setattr(Analysis, "checks", checks)
    assert brief(analysis, 1.0).self_check == "2 exact, 1 undecided"
    monkeypatch.setattr(Analysis, "checks", (*checks, Check("mass matrix", "", "", FAILED)))
    assert brief(analysis, 1.0).self_check == "FAILED: mass matrix"


def run(*arguments: object) -> subprocess.CompletedProcess[str]:
    return warm.run(["run", *arguments], timeout=120)


def test_brief_prints_one_line_a_file_and_keeps_the_exit_codes(tmp_path: Path) -> None:
    for name in ("simple-pendulum.yaml", "gyrostat.yaml"):
        (tmp_path / name).write_text((SHIPPED / name).read_text(encoding="utf-8"), encoding="utf-8")
    (tmp_path / "figures").mkdir()
    (tmp_path / "figures" / "note.txt").write_text("no description\n", encoding="utf-8")
    done = run(tmp_path, "--brief", "--format", "json", "--out", tmp_path / "out")
    assert (done.returncode, done.stderr) == (0, "")
    gyrostat, pendulum = done.stdout.splitlines()
    assert re.fullmatch(
        r"gyrostat\.yaml +1-3, 7 +all exact +8 held, 1 refuted +\d+\.\d\d s +4-6: no motion", gyrostat.rstrip()
    )
    assert re.fullmatch(r"simple-pendulum\.yaml +1-7 +all exact +no claims +\d+\.\d\d s", pendulum.rstrip())
    (tmp_path / "wrong.yaml").write_text("mbsym: 1\n", encoding="utf-8")
    done = run(tmp_path, "--brief", "--format", "json", "--out", tmp_path / "out")
    assert done.returncode == 2
    assert len(done.stdout.splitlines()) == 2
    assert "wrong.yaml: " in done.stderr


def test_make_runs_them_all() -> None:
    assert re.search(r"^systems: \$\(READY\)\n\t\$\(BIN\)/mbsym run systems --brief$", MAKEFILE, re.MULTILINE)
    (phony,) = re.findall(r"^\.PHONY: (.*)$", MAKEFILE, re.MULTILINE)
    assert {"systems", "gallery"} <= set(phony.split())


# --- the gallery ---


def test_every_figure_of_the_gallery_is_there_small_and_drawn_by_make() -> None:
    figures = {path.stem: path for path in (ROOT / "docs" / "figures" / "systems").iterdir()}
    drawn = re.findall(r"\$\(call figure,([\w-]+),", MAKEFILE)
    mapped = re.findall(r"\$\(call map,([\w-]+),", MAKEFILE)
    assert sorted([*drawn, *(f"map-{name}" for name in mapped)]) == sorted(figures)
    assert {f"{name}.yaml" for name in drawn} <= {path.name for path in FILES}
    assert {f"{name}.yaml" for name in mapped} <= {path.name for path in FILES}
    sizes = [path.stat().st_size for path in figures.values()]
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in figures.values())
    assert max(sizes) < 60_000
    assert sum(sizes) < 600_000
