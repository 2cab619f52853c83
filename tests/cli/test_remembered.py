"""What a study measured before: the same question costs nothing, any other is measured, several scenes in one table."""

from __future__ import annotations

import json
import shutil
from collections.abc import Sequence
from pathlib import Path

import pytest
from conftest import SHIPPED, filed, invoked
from flint import acb, arb, ctx

from mbsym.expressions.tree import Number
from mbsym.numerics.kernels import stored
from mbsym.numerics.scenario import scenario
from mbsym.source import load
from mbsym.studies.study import identity
from mbsym_cli.beside import Beside
from mbsym_cli.remembered import remembered

PENDULUM = SHIPPED / "simple-pendulum.yaml"
QUICK = ("--time", 1, "--budget", 1, "--methods", "rk45")


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("MBSYM_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache" / stored.MEASURED


class Asking:
    """Answers that count how often they are found."""

    def __init__(self) -> None:
        self.count = 0

    def __call__(self, question: Sequence[str], sound: bool = True, anew: bool = False) -> tuple[int, bool]:
        def measure() -> int:
            self.count += 1
            return self.count

        return remembered(question, measure, lambda found: sound, anew)


def test_an_answer_is_found_once(cache: Path) -> None:
    ask = Asking()
    assert ask(["a", "b"]) == (1, False)
    assert ask(["a", "b"]) == (1, True)
    assert ask(["ab"]) == (2, False)
    assert ask(["a", "b"], anew=True) == (3, False)
    assert ask(["a", "b"]) == (3, True)


def test_what_is_not_sound_is_not_kept(cache: Path) -> None:
    ask = Asking()
    assert ask(["a"], sound=False) == (1, False)
    assert ask(["a"]) == (2, False)


def test_what_was_spoiled_is_found_again(cache: Path) -> None:
    ask = Asking()
    ask(["a"])
    (kept,) = cache.iterdir()
    kept.write_bytes(kept.read_bytes()[:-1] + b"!")
    assert ask(["a"]) == (2, False)
    kept.unlink()
    assert ask(["a"]) == (3, False)


def test_nothing_is_kept_where_nothing_is_to_be(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MBSYM_CACHE", "")
    ask = Asking()
    assert ask(["a"]) == (1, False)
    assert ask(["a"]) == (2, False)


def test_another_source_or_another_library_is_another_question(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ask = Asking()
    ask(["a"])
    for name, other in (("derivation", lambda: "another source"), ("_surroundings", lambda: ["another library"])):
        with monkeypatch.context() as patched:
            patched.setattr(f"mbsym_cli.remembered.{name}", other)
            assert not ask(["a"])[1]
    assert ask(["a"])[1]


def test_scenarios_are_known_by_what_they_mean() -> None:
    system, _, _ = load(PENDULUM)
    other, _, _ = load(SHIPPED / "double-pendulum.yaml")
    again, _, _ = load(PENDULUM)
    assert identity(scenario(system)) == identity(scenario(again))
    (name,) = system.coordinates
    changed = [{system.parameter_names[0]: Number(7)}, {name: Number(1)}, {f"{name}_dot": Number(1)}]
    texts = {identity(scenario(system, values)) for values in ({}, *changed)}
    assert len(texts | {identity(scenario(other))}) == 5


def test_a_second_question_measures_nothing(cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Other targets, and the same rows but for where they stand; --anew measures."""
    monkeypatch.setattr(Beside, "allowed", True)
    first = invoked("tradeoff", PENDULUM, *QUICK, "-o", tmp_path / "out", code=0)
    assert "--anew" not in first.output
    table = (tmp_path / "out" / "tradeoff.csv").read_bytes()

    measured: list[object] = []

    def forbidden(*asked: object, **_: object) -> None:
        measured.append(asked)
        raise ValueError("measured again")

    with monkeypatch.context() as patched:
        patched.setattr("mbsym.numerics.trade.tradeoff.studied", forbidden)
        again = invoked("tradeoff", PENDULUM, *QUICK, "--target", "1e-5", "-o", tmp_path / "out")
        assert (again.exit_code, measured) == (0, []), again.output
        assert "measured by an earlier command, seconds too; --anew measures again" in again.output
        assert (tmp_path / "out" / "tradeoff.csv").read_bytes() == table
        for more in (("--anew",), ("--set", "l=2"), ("--time", "2"), ("--no-fidelity",)):
            before = len(measured)
            assert invoked("tradeoff", PENDULUM, *QUICK, *more, "-o", tmp_path / "out").exit_code
            assert len(measured) == before + 1, more


def test_scenes_say_what_was_measured_before(cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Beside, "allowed", True)
    told = "measured by an earlier command, seconds too; --anew measures again"
    quick = (*QUICK, "--no-fidelity")
    scenes = (PENDULUM, SHIPPED / "spring-pendulum.yaml")
    invoked("tradeoff", PENDULUM, *quick, "-o", tmp_path)
    one_of_two = invoked("tradeoff", *scenes, *quick, "-o", tmp_path)
    assert " ".join(one_of_two.output.split()).endswith(f"Simple pendulum: {told}")
    both = invoked("tradeoff", *scenes, *quick, "--target", "1e-5", "-o", tmp_path)
    assert told in both.output
    assert f": {told}" not in both.output


def test_several_scenes_are_compared_in_one_table(tmp_path: Path) -> None:
    done = invoked("tradeoff", PENDULUM, SHIPPED / "spring-pendulum.yaml", *QUICK, "-o", tmp_path, code=0)
    heads, *rows = [line.split() for line in done.output.splitlines() if line.strip()]
    assert heads[:4] == ["scene", "method", "setting", "error"]
    assert len(rows) == 2
    assert all("rk45" in row and row[-1] in ("yes", "no") for row in rows)
    for name in ("simple-pendulum", "spring-pendulum"):
        assert (tmp_path / name / "tradeoff.csv").exists()


def test_one_scene_that_has_no_solution_leaves_the_others(tmp_path: Path) -> None:
    falling = filed(
        tmp_path / "pole.yaml",
        "mbsym: 1\nname: pole\nbodies:\n"
        "  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}\n"
        "loads:\n  - generalized force: {x: 2*x**3}\ninitial: {x: {position: 1, velocity: 1}}\n",
    )
    done = invoked("tradeoff", falling, PENDULUM, "--time", 2, *QUICK[2:], "-o", tmp_path / "out", code=3)
    assert "there is no reference solution" in done.output + done.stderr
    assert "rk45" in done.output


def test_two_files_of_one_name_have_folders_of_their_own(tmp_path: Path) -> None:
    copy = filed(tmp_path / PENDULUM.name, PENDULUM.read_text(encoding="utf-8").replace("name: ", "name: Other "))
    invoked("tradeoff", PENDULUM, copy, *QUICK, "-o", tmp_path / "out", code=0)
    written = [json.loads(x.read_text(encoding="utf-8")) for x in (tmp_path / "out").glob("*/tradeoff.json")]
    assert sorted(x["system"] for x in written) == ["Other Simple pendulum", "Simple pendulum"]


@pytest.mark.parametrize("shift", [-300, 0, 40])
def test_balls_are_kept_to_the_last_bit(cache: Path, shift: int) -> None:
    """Radii of 1 to 30 bits, middles of many: a rounding would make other files of a second question."""
    with ctx.workprec(200):
        balls = [acb(arb(arb(1) / 3, arb((2**k - 1, shift))), arb(k)) for k in range(31)]
    kept, _ = remembered([str(shift)], lambda: balls, lambda found: True, False)
    known, before = remembered([str(shift)], list, lambda found: True, False)
    assert before
    for one, other in zip(kept, known, strict=True):
        for a, b in ((one.real, other.real), (one.imag, other.imag)):
            assert (a.mid(), a.rad()) == (b.mid(), b.rad())


@pytest.mark.parametrize(
    ("words", "measures"),
    [
        (("simulate", "--time", 1, "--accuracy", "1e-5", "--format", "csv"), "simulation.accurate.planned"),
        (("simulate", "--time", 1, "--accuracy", "1e-5", "--plan"), "simulation.accurate.planned"),
        (("simulate", "--time", 1, "--estimate", "--format", "csv"), "simulation.run.estimated"),
        (("extremes", "--budget", "0.05"), "numerics.extremes.extremes.extremes"),
    ],
)
def test_plans_estimates_and_extremes_are_measured_once(
    cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: tuple[object, ...], measures: str
) -> None:
    """The second question writes the same bytes; --anew, another value, or a deleted folder measures."""
    monkeypatch.setattr(Beside, "allowed", True)
    command, *options = words
    out = () if "--plan" in words else ("-o", tmp_path / "out")

    def asked(*more: object) -> tuple[int, str, dict[str, bytes]]:
        done = invoked(command, PENDULUM, *options, *out, *more)
        files = {x.name: x.read_bytes() for x in (tmp_path / "out").glob("*.csv")}
        return done.exit_code, done.output, files

    first, again = asked(), asked()
    assert (first[0], again[0], again[2]) == (0, 0, first[2])
    assert "--anew" not in first[1]
    assert "measured by an earlier command, seconds too; --anew measures again" in " ".join(again[1].split())

    def forbidden(*asked: object, **_: object) -> None:
        raise ValueError("measured again")

    with monkeypatch.context() as patched:
        patched.setattr(f"mbsym.{measures}", forbidden)
        assert asked()[0] == 0
        for more in (("--anew",), ("--set", "l=2")):
            assert asked(*more)[0] != 0, more
        shutil.rmtree(cache)
        assert asked()[0] != 0
    assert asked()[2] == first[2]
