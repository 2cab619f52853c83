"""A failure stays where it happened: planted ones, in each place where one could be."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, NoReturn

import pytest
from click.testing import Result
from conftest import invoked

import mbsym
from mbsym.algebra.failures import Limit, NoClosedForm
from mbsym.analysis import PROBLEMS
from mbsym.formulas.formula import Formula
from mbsym.report import targets
from mbsym.report.sections import section_of
from mbsym_cli.files import MANIFEST
from tests.report.readers import unreadable

ROOT = Path(__file__).parents[2]
PENDULUM = ROOT / "systems" / "simple-pendulum.yaml"
HOSTILE = ROOT / "tests" / "cases" / "hostile"
FILES = {
    "report.tex",
    "appendix.tex",
    "fragments",
    "report.html",
    "report.wl",
    "model.py",
    "model.c",
    "model.h",
    "results.json",
}


def run(*words: object, code: int | None = None) -> Result:
    return invoked("run", *words, code=code)


def broken(*_: object, **__: object) -> NoReturn:
    raise OverflowError("planted")


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


PLACES = {
    1: "kinematics.kinematics",
    2: "energy.energy",
    3: "equations.equations",
    4: "equilibrium.equilibrium",
    6: "stability.problem.stability",
    7: "integrals.integrals",
}


@pytest.mark.parametrize("number", PLACES)
def test_in_a_problem(number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """All files are delivered, what does not need the problem is in them, and the terminal says what is lost."""
    monkeypatch.setattr(f"mbsym.problems.{PLACES[number]}", broken)
    done = run(PENDULUM, "-o", tmp_path, code=1)
    assert f"problem {number}: internal error: OverflowError: planted" in done.stderr
    assert "internal error, please report it: OverflowError: planted" in done.stderr
    assert "Traceback" not in done.output
    assert names(tmp_path) == FILES | {MANIFEST}
    results = json.loads((tmp_path / "results.json").read_text())
    lost = results["unavailable"]
    found = lost[PLACES[number].split(".")[0]]
    assert (found["code"], found["severity"]) == ("internal-error", "defect")
    assert found["reason"] == "internal error: OverflowError: planted"
    independent = {"kinematics", "energy"} - set(PLACES[number].split("."))
    assert independent <= set(results) or number == 2
    for path in tmp_path.rglob("*.*"):
        assert not unreadable(path.relative_to(tmp_path).as_posix(), path.read_text())


def test_the_traceback_is_there_for_who_wants_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mbsym.problems.integrals.integrals", broken)
    done = run(PENDULUM, "-o", tmp_path, "--debug", code=1)
    assert "in broken" in done.stderr
    assert done.stderr.count("Traceback") == 1


def test_from_python_the_cause_is_not_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mbsym.problems.energy.energy", broken)
    with pytest.raises(mbsym.algebra.failures.Failure) as lost:
        _ = mbsym.load(PENDULUM).equations
    causes, error = [], lost.value.__cause__
    while error is not None:
        causes.append(type(error))
        error = error.__cause__
    assert OverflowError in causes


def test_in_the_self_check(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mbsym.problems.checks.check_energy", broken)
    run(PENDULUM, "-o", tmp_path, code=1)
    checks = {item["name"]: item["outcome"] for item in json.loads((tmp_path / "results.json").read_text())["checks"]}
    assert checks.pop("energy") == "undecided"
    assert set(checks.values()) == {"exact"}
    assert len(checks) > 5


def test_in_what_the_checks_share(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mbsym.analysis.pipeline.oracles", broken)
    run(PENDULUM, "-o", tmp_path, code=1)
    assert names(tmp_path) == FILES | {MANIFEST}
    checks = {item["name"]: item["outcome"] for item in json.loads((tmp_path / "results.json").read_text())["checks"]}
    assert {checks["kinematics"], checks["energy"], checks["equations of motion"]} == {"undecided"}
    assert checks["perturbed motion"] == "exact"


def test_in_a_claim(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    honest, count = mbsym_claims(), 0

    def examine(*arguments: Any) -> Any:
        nonlocal count
        count += 1
        return broken() if count == 1 else honest(*arguments)

    monkeypatch.setattr("mbsym.problems.claims.examine", examine)
    run(ROOT / "systems" / "orbital-gyrostat.yaml", "-o", tmp_path, "-f", "json", code=1)
    outcomes = [item["outcome"] for item in json.loads((tmp_path / "results.json").read_text())["claims"]]
    assert outcomes[0] == "undecided"
    assert outcomes[1:] == ["holds exactly"] * 5


def mbsym_claims() -> Callable[..., Any]:
    from mbsym.problems import claims

    return claims.examine


def test_in_a_section_of_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(section_of(PROBLEMS[5]), "data", broken)
    done = run(PENDULUM, "-o", tmp_path, code=1)
    assert "results.json: problem 5 cannot be written: internal error: OverflowError: planted" in done.stderr
    results = json.loads((tmp_path / "results.json").read_text())
    assert list(results["unavailable"]) == ["linearisation"]
    assert results["unavailable"]["linearisation"]["reason"] == "internal error: OverflowError: planted"
    assert {"kinematics", "energy", "equations", "equilibrium", "stability", "integrals"} <= set(results)
    assert names(tmp_path) == FILES | {MANIFEST}


def planted_target(monkeypatch: pytest.MonkeyPatch, name: str, text: Callable[..., str]) -> None:
    own = targets.TARGETS if name in targets.TARGETS else targets.EXPORTS  # FORMATS is a view of both
    monkeypatch.setitem(own, name, replace(own[name], text=text))


@pytest.mark.parametrize(
    ("name", "lost"),
    [("latex", {"report.tex", "appendix.tex", "fragments"}), ("c", {"model.c", "model.h"}), ("json", {"results.json"})],
)
def test_in_a_whole_file(name: str, lost: set[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No older one is left in its place, nor one half of a pair."""
    assert run(PENDULUM, "-o", tmp_path).exit_code == 0
    planted_target(monkeypatch, name, broken)
    done = run(PENDULUM, "-o", tmp_path, code=1)
    assert f"{targets.FORMATS[name].filename} cannot be written: internal error: OverflowError: planted" in done.stderr
    assert names(tmp_path) == (FILES | {MANIFEST}) - lost


def test_in_one_file_of_a_batch(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from mbsym.report import whole_run

    honest = whole_run.derive_all

    def derive(analysis: Any, *others: Any) -> None:
        if analysis.system.name == "first":
            broken()
        honest(analysis, *others)

    monkeypatch.setattr(whole_run, "derive_all", derive)
    for name in ("first", "second"):
        (tmp_path / f"{name}.yaml").write_text(PENDULUM.read_text().replace("Simple pendulum", name))
    run(tmp_path, "-o", tmp_path / "out", "-f", "json", "-p", "1", code=1)
    assert names(tmp_path / "out") == {"second"}


def test_too_little_memory_is_no_mistake_of_ours(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def exhausted(*_: object) -> NoReturn:
        raise MemoryError

    monkeypatch.setattr("mbsym.problems.integrals.integrals", exhausted)
    done = run(PENDULUM, "-o", tmp_path, code=1)
    assert "problem 7: out of memory; lower --terms, or ask for fewer --problems" in done.stderr
    assert "please report" not in done.stderr
    assert names(tmp_path) == FILES | {MANIFEST}


@pytest.mark.parametrize("name", ["dumb", "zig"])
def test_masses_of_ten_digits(name: str, tmp_path: Path) -> None:
    done = run(HOSTILE / f"{name}.yaml", "-o", tmp_path)
    assert (done.exit_code, done.stderr) == (0, "")
    assert names(tmp_path) == FILES | {MANIFEST}


@pytest.mark.parametrize(
    ("value", "wanted"),
    [("(pi+1)**3", 71.0398678443), ("(2*pi/86164)**2", 5.31749408e-9), ("sqrt(2)*sqrt(2) + atan(1)", 2.7853981634)],
)
def test_values_with_repeated_parts(value: str, wanted: float, tmp_path: Path) -> None:
    """The module imports, and its table holds the numbers of a pocket calculator."""
    text = (HOSTILE / "def.yaml").read_text().replace("(pi+1)**3", value)
    (tmp_path / "def.yaml").write_text(text)
    run(tmp_path / "def.yaml", "-o", tmp_path / "out", code=0)
    module: dict[str, Any] = {}
    exec(compile((tmp_path / "out" / "model.py").read_text(), "model.py", "exec"), module)
    assert module["DEFAULTS"]["m"] == pytest.approx(wanted, rel=1e-9)


def test_a_number_of_thousands_of_digits_is_a_failure_with_its_limit() -> None:
    ring = mbsym.load(PENDULUM).ring
    for number in (10**4299, -(10**4299), 1):
        assert str(Formula(ring, ring.number(number))) == str(number)
    for write in (Formula.__str__, Formula.latex, Formula.wolfram):
        with pytest.raises(NoClosedForm, match="4300 digits") as lost:
            write(Formula(ring, ring.number(10**5000)))
        assert lost.value.limit is Limit.DIGITS


def simulate(*words: object, code: int | None = None) -> Result:
    arguments = ["simulate", str(PENDULUM), "-s", "theta=1", "-t", "1", "--no-estimate", *map(str, words)]
    return invoked(*arguments, code=code)


@pytest.mark.parametrize(("error", "code"), [(KeyboardInterrupt, 130), (OverflowError("planted"), 1)])
def test_in_the_drawing(
    error: BaseException | type[BaseException], code: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The table of a simulation does not depend on its pictures."""

    def stopped(*_: object) -> NoReturn:
        raise error

    monkeypatch.setattr("mbsym.studies.simulate.files._pictures", stopped)
    done = simulate("-o", tmp_path)
    assert done.exit_code == code, done.output
    assert names(tmp_path) == {"trajectory.csv", "simulation.json", MANIFEST}


def test_in_the_ledger(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mbsym.numerics.ledger.table.ledger", broken)
    done = run(PENDULUM, "-o", tmp_path, "--ledger", code=1)
    assert "internal error, please report it: OverflowError: planted" in done.stderr
    assert names(tmp_path) == FILES | {MANIFEST}


@pytest.mark.parametrize("command", ["check", "run"])
def test_in_the_reading_of_one_file(command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from mbsym.source import document

    honest = document.load
    monkeypatch.setattr(document, "load", lambda path: broken() if path.name == "first.yaml" else honest(path))
    for name in ("first", "second"):
        (tmp_path / f"{name}.yaml").write_text(PENDULUM.read_text())
    further = ["-o", tmp_path / "out", "-f", "json", "-p", "1"] if command == "run" else []
    done = invoked(command, tmp_path, *further, code=1)
    assert "first.yaml: internal error, please report it: OverflowError: planted" in done.stderr
    assert "Simple pendulum" in done.stdout


def test_what_a_simulation_can_do_without(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The integrals are lost, the trajectory is not, and the exit code says that something is."""
    monkeypatch.setattr("mbsym.problems.integrals.integrals", broken)
    done = simulate("-o", tmp_path, "--invariants", "-f", "csv", code=1)
    assert done.stderr.count("internal error, please report it: OverflowError: planted") == 1
    assert names(tmp_path) == {"trajectory.csv", "simulation.json", MANIFEST}


def test_in_python_the_log_has_the_traceback(caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mbsym.problems.integrals.integrals", broken)
    stage = mbsym.load(PENDULUM).stage(7)
    assert stage.failure is not None
    assert stage.failure.code == "internal-error"
    (record,) = caplog.records
    assert record.name == "mbsym"
    assert record.exc_info is not None
    assert isinstance(record.exc_info[1], OverflowError)


def test_a_denominator_beyond_the_budget_costs_no_report(tmp_path: Path) -> None:
    """Seven stars, one distance of 21 not like the others: term by term the force function is short."""
    text = (ROOT / "tests" / "systems" / "pleiades.yaml").read_text()
    changed = text.replace("(x1 - x5)**2 + (y1 - y5)**2", "(x1 - x5)**2 + (1/3 - y5)**2")
    assert changed != text
    (tmp_path / "stars.yaml").write_text(changed)
    done = run(tmp_path / "stars.yaml", "-o", tmp_path / "out")
    assert (done.exit_code, done.stderr) == (0, "")
    assert names(tmp_path / "out") == FILES | {MANIFEST}
    force = json.loads((tmp_path / "out" / "results.json").read_text())["energy"]["force_function"]
    assert force.count("sqrt(") == 21
