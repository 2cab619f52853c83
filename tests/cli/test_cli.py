"""The command line: exit codes, what is written and what is not, batches, problem selection, explanations."""

from __future__ import annotations

import doctest
import json
import os
import re
from importlib import import_module
from pathlib import Path

import pytest
from click import Context
from click.testing import CliRunner, Result

from mbsym import load, loads
from mbsym.algebra.certainty import Certainty
from mbsym.analysis import PROBLEMS, Analysis, Derived
from mbsym.expressions.tree import FUNCTIONS
from mbsym.maps.branches_events import Event
from mbsym.model.claims import CLAIMS
from mbsym.problems.stability.words import MEANINGS, Word
from mbsym.report.maps.frame import LOOKS
from mbsym.source.keys import BODY, CONSTRAINTS, LOADS, SYSTEM
from mbsym.source.labels import BODY as LABELS
from mbsym.source.topics import EXAMPLES
from mbsym_cli import files
from mbsym_cli.explain import TOPICS, _as_known, explanations, known_words
from mbsym_cli.main import COMMANDS, SCREEN, main

ROOT = Path(__file__).parents[2]
SYSTEMS = ROOT / "systems"
PENDULUM = SYSTEMS / "simple-pendulum.yaml"
PROBLEM_NAMES = {problem.attribute for problem in PROBLEMS.values()}


def mbsym(*words: object) -> Result:
    return CliRunner().invoke(main, [str(word) for word in words], catch_exceptions=False)


def test_run_writes_all_reports(tmp_path: Path) -> None:
    done = mbsym("run", PENDULUM, "--verbose", "--out", tmp_path / "out")
    assert done.exit_code == 0, done.output
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names == {
        "report.tex",
        "appendix.tex",
        "fragments",
        "report.wl",
        "model.py",
        "model.c",
        "model.h",
        "report.html",
        "results.json",
        files.MANIFEST,
    }
    assert "Self-check" in done.stdout
    assert "exact" in done.stdout


def test_format_and_problems_choose(tmp_path: Path) -> None:
    done = mbsym("run", PENDULUM, "--out", tmp_path, "--format", "json", "--problems", "1-2,4")
    assert done.exit_code == 0
    assert {path.name for path in tmp_path.iterdir()} == {"results.json", files.MANIFEST}
    results = json.loads((tmp_path / "results.json").read_text())
    assert {"kinematics", "energy", "equilibrium", "checks"} <= set(results)
    assert not {"equations", "linearisation", "stability", "integrals"} & set(results)


@pytest.mark.parametrize(
    ("kinds", "derived"),
    [
        ("c", set()),
        ("python", {"linearisation", "integrals", "energy", "equations"}),
        ("c,python", {"linearisation", "integrals", "energy", "equations"}),
        ("modelica", {"integrals", "energy", "equations"}),
        ("json", set(PROBLEM_NAMES)),
    ],
)
def test_only_what_the_formats_show_is_derived(
    kinds: str, derived: set[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[str] = []
    original = Derived.__get__

    def watched(self: Derived, pipeline: Analysis, owner: type) -> object:  # type: ignore[type-arg]
        made.append(self.name)
        return original(self, pipeline, owner)

    monkeypatch.setattr(Derived, "__get__", watched)
    done = mbsym("run", SYSTEMS / "double-pendulum.yaml", "--format", kinds, "--out", tmp_path, "-v")
    assert done.exit_code == 0, done.output
    closed = {"kinematics", "energy", "equations", "stability", "integrals", "linearisation"}
    assert closed & set(made) == closed & derived
    assert "straight-line program | " in done.stdout or kinds == "json"


@pytest.mark.parametrize(
    ("option", "value", "hint"),
    [
        ("--problems", "99", "1 to 12"),
        ("--problems", "x", "1-5"),
        ("--problems", "5-1", "problem"),
        ("--format", "word", "latex"),
    ],
)
def test_wrong_choices_are_explained(option: str, value: str, hint: str, tmp_path: Path) -> None:
    done = mbsym("run", PENDULUM, option, value, "--out", tmp_path / "out")
    assert done.exit_code == 2
    assert hint in done.output
    assert not (tmp_path / "out").exists()


def test_bad_input_writes_nothing_and_does_not_stop_the_others(tmp_path: Path) -> None:
    bad = tmp_path / "bad.yaml"
    bad.write_text(PENDULUM.read_text().replace("mass: m", "mass: mm"))
    done = mbsym("run", bad, PENDULUM, tmp_path / "missing.yaml", "--out", tmp_path / "out", "-f", "json", "-p", "1")
    assert done.exit_code == 2
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["simple-pendulum"]
    assert "bad.yaml:" in done.stderr
    assert "missing.yaml" in done.stderr
    assert "Traceback" not in done.output


def test_a_folder_stands_for_its_descriptions(tmp_path: Path) -> None:
    folder = tmp_path / "several"
    folder.mkdir()
    for name in ("a.yaml", "b.yaml"):
        (folder / name).write_text(PENDULUM.read_text())
    (folder / "notes.md").write_text("not a description")
    (folder / "a.txt").write_text(mbsym("convert", PENDULUM).stdout)
    done = mbsym("run", folder, "--out", tmp_path / "out", "-f", "json", "-p", "1")
    assert done.exit_code == 0, done.output
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"a", "a.txt", "b"}


def test_a_file_that_is_named_twice_is_run_once(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text(PENDULUM.read_text())
    done = mbsym("run", tmp_path / "a.yaml", tmp_path, "--out", tmp_path / "out", "-f", "json", "-p", "1", "-v")
    assert done.exit_code == 0, done.output
    assert done.stdout.count("Problem 1. Kinematics") == 1
    assert mbsym("check", tmp_path).stdout.count(": ok: ") == 1


def test_a_misspelt_command_is_guessed() -> None:
    done = mbsym("simulat", PENDULUM)
    assert done.exit_code == 2
    assert "did you mean 'simulate'?" in done.stderr


@pytest.mark.parametrize(
    ("command", "word", "meant"),
    [
        ("simulate", "10", "--time 10"),
        ("simulate", "m=3", "--set m=3"),
        ("convert", "other.txt", "--out other.txt"),
        ("run", "m=3", "--set m=3"),
    ],
)
def test_a_word_too_much_is_told_with_the_option_that_it_lacks(command: str, word: str, meant: str) -> None:
    done = mbsym(command, PENDULUM, word, "--quiet") if command == "run" else mbsym(command, PENDULUM, word)
    assert done.exit_code == 2
    assert meant in done.stderr


def test_a_description_is_not_converted_into_itself(tmp_path: Path) -> None:
    own = tmp_path / "own.yaml"
    own.write_text("# a comment\n" + PENDULUM.read_text())
    done = mbsym("convert", own, "--to", "yaml", "--out", own)
    assert done.exit_code == 2
    assert "error[same-file]" in done.stderr
    assert own.read_text().startswith("# a comment")


def test_a_mistake_of_ours_is_called_one(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object, **__: object) -> None:
        raise RuntimeError("planted")

    monkeypatch.setattr("mbsym_cli.check.read_description", broken)
    done = mbsym("check", PENDULUM)
    assert done.exit_code == 1
    assert "internal error, please report it: RuntimeError: planted" in done.stderr


def test_a_folder_without_descriptions_is_an_error(tmp_path: Path) -> None:
    done = mbsym("run", tmp_path)
    assert done.exit_code == 2
    assert "no descriptions" in done.stderr


def test_failed_self_check_is_exit_code_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A planted mistake in the kinetic energy: reports are still written, and say so."""
    from mbsym.algebra.ring import Ring
    from mbsym.problems import energy

    honest = energy.kinetic_energy
    monkeypatch.setattr(energy, "kinetic_energy", lambda scene: honest(scene) * Ring.number(scene.ring, 2))
    done = mbsym("run", PENDULUM, "--out", tmp_path, "-f", "json")
    assert done.exit_code == 1
    assert "SELF-CHECK FAILED" in done.stderr
    outcomes = {check["outcome"] for check in json.loads((tmp_path / "results.json").read_text())["checks"]}
    assert "FAILED" in outcomes


def test_a_coordinate_without_inertia_is_named(tmp_path: Path) -> None:
    text = PENDULUM.read_text().replace("mass centre: [0, -l, 0]", "mass centre: [0, 0, 0]")
    text = text.replace("inertia: [J, 0, J]", "inertia: [J, J, 0]")
    (tmp_path / "idle.yaml").write_text(text)
    done = mbsym("run", tmp_path / "idle.yaml", "--out", tmp_path / "out", "-f", "json", "-p", "1-3")
    assert done.exit_code == 0  # no route of mbsym's is wrong
    assert "SELF-CHECK" not in done.stderr
    assert "the mass matrix is singular: theta carries no inertia: no equation determines its" in done.stderr
    checks = json.loads((tmp_path / "out" / "results.json").read_text())["checks"]
    assert {check["outcome"] for check in checks if check["name"] == "mass matrix"} == {"singular"}


def test_output_folder_that_cannot_be_made(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    done = mbsym("run", PENDULUM, "--out", tmp_path / "file" / "out", "-f", "json", "-p", "1")
    assert done.exit_code == 1
    assert "cannot be written" in done.stderr


def test_writing_is_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target = tmp_path / "report.tex"
    target.write_text("old")

    def refuse(*_: object) -> None:
        raise OSError("disk full")

    monkeypatch.setattr(os, "replace", refuse)
    with pytest.raises(OSError, match="disk full"):
        files.write_whole(target, "new")
    assert target.read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["report.tex"]


def test_a_result_that_cannot_be_had_is_said_not_raised(tmp_path: Path) -> None:
    """No unperturbed motion, and a budget too small for closed formulas: the rest still comes out."""
    text = re.sub(
        r"^motion:.*?(?=^\w|\Z)", "", (SYSTEMS / "spatial-arm.yaml").read_text(), flags=re.DOTALL | re.MULTILINE
    )
    arm = tmp_path / "arm.yaml"
    arm.write_text(text)
    done = mbsym("run", arm, "--out", tmp_path / "out", "--terms", 200, "-v")
    assert done.exit_code == 0, done.output
    assert "no unperturbed motion" in done.stdout
    assert "budget" in done.stdout
    assert "inertial axes | exact: 3 states" in done.stdout
    unavailable = json.loads((tmp_path / "out" / "results.json").read_text())["unavailable"]
    assert {"energy", "equations", "equilibrium", "stability"} <= set(unavailable)


def test_check_says_what_it_read() -> None:
    done = mbsym("check", SYSTEMS / "satellite.yaml", SYSTEMS / "satellite.txt")
    assert done.exit_code == 0
    assert done.stdout.count("; coordinates (5): psi, theta, phi, delta, sigma; bodies and frames: 4") == 2


def test_convert_there_and_back(tmp_path: Path) -> None:
    assert mbsym("convert", SYSTEMS / "satellite.yaml", "--out", tmp_path / "s.txt").exit_code == 0
    assert mbsym("convert", tmp_path / "s.txt", "--out", tmp_path / "s.yaml").exit_code == 0
    again = mbsym("convert", tmp_path / "s.yaml", "--to", "text")
    assert again.stdout == (tmp_path / "s.txt").read_text()


def test_schema_is_json() -> None:
    assert json.loads(mbsym("schema").stdout)["type"] == "object"


@pytest.mark.parametrize("number", PROBLEMS)
def test_explain(number: int) -> None:
    done = mbsym("explain", number)
    assert done.exit_code == 0
    assert f"Problem {number}" in done.stdout
    assert "Source:" in done.stdout


def test_explain_lists_and_refuses() -> None:
    assert mbsym("explain").stdout.count("\n") == len(PROBLEMS) + len(TOPICS)
    assert mbsym("explain", "99").exit_code == 2
    assert "did you mean claims" in mbsym("explain", "clams").stderr


def test_explain_knows_every_command_verdict_theorem_and_key() -> None:
    """Each says something of its own."""
    for word in known_words():
        assert all(text.strip() for text in explanations(word)), word
        assert explanations(word), word
    assert {*COMMANDS, *Word, *BODY, *LOADS, *CONSTRAINTS, *CLAIMS} <= set(known_words())
    assert "D > 0" in mbsym("explain", "kelvin-chetaev").stdout
    assert "Usage: mbsym floquet" in mbsym("explain", "floquet").stdout
    assert mbsym("explain", "gyroscopically", "stabilised", "only").exit_code == 0
    assert "did you mean inertia about?" in mbsym("explain", "inertia abut").stderr
    assert mbsym("explain", "STABLE").stdout == mbsym("explain", "stable").stdout != ""
    assert mbsym("explain", "problem", "6").stdout == mbsym("explain", "6").stdout != ""
    assert "did you mean Arnold-Moser" in mbsym("explain", "moser").stderr


def test_a_theorem_is_explained_with_its_weakest_hypotheses() -> None:
    """Lagrange and Dirichlet's holds with D >= 0, of which D = 0 is an instance; Malkin's alone is about a family."""
    told = explanations("Lagrange-Dirichlet")
    assert sum("K > 0" in text for text in told) == 1
    assert not any("D = 0" in text for text in told)
    assert all("family" in text for text in explanations("Lyapunov-Malkin"))
    assert not any("family" in text for text in explanations("Kelvin-Chetaev"))


def test_every_verdict_has_a_meaning_and_a_look() -> None:
    """A word without a look would be drawn as no verdict."""
    assert set(MEANINGS) == set(Word) == set(LOOKS) & set(Word)


@pytest.mark.parametrize("name", ["satellite", "ziegler-damped", "bead-on-hoop", "ziegler"])
def test_explain_knows_what_conditions_are_called(name: str) -> None:
    """Letters of coefficients and of quantities apart, which are told beside the conditions."""
    parts = load(SYSTEMS / f"{name}.yaml").stability.subsystems
    labels = [str(requirement.label) for part in parts for requirement in part.theory.requirements]
    called = {re.sub(r" (of|[0-9]+).*", "", label) for label in labels}
    assert {word for word in called if not re.fullmatch(r"[a-z][0-9]*", word)} <= set(known_words())


def test_explain_knows_what_reports_say() -> None:
    """How surely a thing is known, what happens to branches, and words as they stand: plural, numbered, capital."""
    for word in (
        *Certainty,
        *(event.told for event in {*Event} - {Event.REGULAR}),
        "First integrals",
        "minor 2 of K",
        "lambda_2",
        "Eigenvalues",
        "linearisation",
    ):
        assert explanations(word) or explanations(_as_known(word)) or word.startswith(("degenerate", "infinitely")), (
            word
        )
    assert explanations(_as_known("minor 2 of K")) == explanations("minor")
    assert not explanations(_as_known("thing 2 of K"))


@pytest.mark.parametrize("topic", TOPICS)
def test_topics_name_everything_that_is_read(topic: str) -> None:
    labels = [label.capitalize() for label in LABELS]
    known = {"description": {**SYSTEM, **BODY}, "loads": LOADS, "constraints": CONSTRAINTS, "plain text": labels}
    wanted = {**known, "expressions": FUNCTIONS, "abbreviations": ["abbreviations:", "--in"], "claims": CLAIMS}[topic]
    done = mbsym("explain", topic)
    assert done.exit_code == 0
    assert not [word for word in wanted if word not in done.stdout]


def test_the_examples_of_claims_are_read() -> None:
    """A rod on a slide; what is claimed need not be true, but is a claim."""
    text = """
mbsym: 1
name: rod on a slide
parameters: [m, l, k, g]
abbreviations: {c1: m}
bodies:
  - {name: slide, attached to: 0, connection point: [x, 0, 0], mass: 0, coordinates: [x]}
  - {name: rod, attached to: slide, rotation: {axes: [3], angles: [phi]}, mass centre: [l, 0, 0], mass: m}
initial: {x: 0, phi: 1}
"""
    examples = "\n".join(line.removeprefix("    ") for line in EXAMPLES.splitlines())
    assert len(loads(text + examples).system.claims) == EXAMPLES.count("claim: ")


@pytest.mark.parametrize("name", COMMANDS)
def test_every_help_has_an_example(name: str) -> None:
    done = mbsym(name, "--help")
    assert done.exit_code == 0
    assert f"mbsym {name}" in done.stdout.split("Example")[1]


@pytest.mark.parametrize("name", COMMANDS)
def test_every_help_fills_a_screen_at_most_and_explain_has_the_rest(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    assert mbsym(name, "--help").stdout.count("\n") <= SCREEN
    whole = mbsym("explain", name).stdout
    options = [word for option in main.get_command(Context(main), name).params for word in option.opts]
    for text in (whole, mbsym(name, "--help-all").stdout):
        assert all(option in text for option in options if option.startswith("--"))


@pytest.mark.parametrize("number", PROBLEMS)
def test_the_explanations_are_doctests(number: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    failed, tried = doctest.testmod(import_module(f"mbsym.problems.{PROBLEMS[number].module}"))
    assert (failed, tried > 1) == (0, True)


@pytest.mark.parametrize(
    "path", sorted(path for path in SYSTEMS.iterdir() if path.suffix in {".yaml", ".txt"}), ids=lambda path: path.name
)
def test_every_shipped_system_runs_and_checks_itself(path: Path, tmp_path: Path) -> None:
    assert path.read_text().startswith("#"), "the first comment says what the system shows"
    done = mbsym("run", path, "--out", tmp_path)
    assert done.exit_code == 0, done.output
    results = json.loads((tmp_path / "results.json").read_text())
    assert {check["outcome"] for check in results["checks"]} <= {"exact", "verified numerically"}


@pytest.mark.parametrize(
    ("command", "instead"),
    [("average", "simulate"), ("symmetries", "run --problems 7")],
)
def test_commands_that_know_no_constraints_say_which_they_are(command: str, instead: str) -> None:
    """And what works: a four-bar has no coordinates that keep it, a hint that asks for them alone is of no use."""
    done = mbsym(command, SYSTEMS / "four-bar.yaml")
    assert done.exit_code == 2
    told = " ".join(done.stderr.split())
    assert f"'mbsym {command}' takes no constraint but relations that give a coordinate" in told
    assert instead in told
    assert "a closed loop has none as a rule" in told
