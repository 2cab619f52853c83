"""One request, many ends: options, help, complaints and Python's arguments follow from a study's fields; one runner.

A planted study has every kind of outcome; what each gives is written down here by hand.
"""

from __future__ import annotations

import inspect
from dataclasses import KW_ONLY, dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import click
import pytest
from click.testing import CliRunner, Result
from conftest import SHIPPED, filed, invoked

import mbsym
from mbsym.expressions.place import Span
from mbsym.studies.lyapunov import Request as LyapunovRequest
from mbsym.studies.request import Flag, Kind, Number, Values, Whole, Word, duration, fields_of, wrong
from mbsym.studies.study import (
    Among,
    Answer,
    Apart,
    Asked,
    Document,
    Exit,
    Folder,
    Needed,
    NotFit,
    Refusal,
    Single,
    Study,
    Unfit,
    Watch,
    line,
)
from mbsym_cli.main import COMMANDS, main
from mbsym_cli.study import command_of

PENDULUM = SHIPPED / "simple-pendulum.yaml"
STUDIES = {name: listed.module for name, listed in COMMANDS.items() if listed.module.startswith("mbsym.studies.")}


@dataclass(frozen=True)
class Request:
    """Plant FILE."""

    time: Annotated[float, duration("So long.")]
    _: KW_ONLY
    values: Values = field(default_factory=dict)
    rows: Annotated[int, Whole("N", "So many.", "-n", least=2, most=9)] = 3
    size: Annotated[float | None, Number("X", "So large.", least=0.5, most=4, usual="as it is")] = None
    shape: Annotated[str, Word("WORD", "How.", choices=("round", "flat"), what="shape")] = "round"
    loud: Annotated[bool, Flag(None, "Aloud.")] = False


def planted(outcome: Any = None, **more: Any) -> Study[Request, float]:
    """It finds the length of the pendulum times the time; ``outcome`` is raised, or becomes the answer."""

    def derive(asked: Asked, request: Request, watch: Watch) -> float:
        if isinstance(outcome, BaseException):
            raise outcome
        return float(asked.motion.parameters["l"]) * request.time

    def answer(asked: Asked, request: Request, found: float) -> Answer:
        usual = Answer((line(f"  found {found:g}"), line("  kept", always=True)), {"found.txt": f"{found:g}\n"})
        return outcome if isinstance(outcome, Answer) else usual

    def unfit(asked: Asked, request: Request) -> Any:
        if request.rows == 5:
            yield Unfit("--rows", "five", "five are no rows", "take four")

    def refusal(error: Exception, asked: Asked, request: Request) -> Refusal | None:
        return (
            Refusal("there is none", Exit.BROKEN_DOWN, ("  look elsewhere",)) if isinstance(error, KeyError) else None
        )

    return Study("planted", Request, derive, answer, refusal, unfit, **more)


def run(study: Study[Any, Any], *words: object) -> Result:
    return CliRunner().invoke(command_of(study), [str(PENDULUM), *map(str, words)], standalone_mode=False)


def test_options_and_help_follow_from_the_fields() -> None:
    options = {one.name: one for one in command_of(planted()).params if isinstance(one, click.Option)}
    assert {name: sorted(one.opts) for name, one in options.items()} == {
        "time": ["--time", "-t"],
        "values": ["--set", "-s"],
        "rows": ["--rows", "-n"],
        "size": ["--size"],
        "shape": ["--shape"],
        "loud": ["--loud"],
        "out": ["--out", "-o"],
        "quiet": ["--quiet", "-q"],
    }
    told = CliRunner().invoke(command_of(planted()), ["--help"]).output
    for words in ("Plant FILE.", "So long.  [required]", "[default: 3]", "[default: as it is]", "[default: round]"):
        assert words in told


def test_what_is_out_of_bounds_is_said_of_options_and_of_arguments() -> None:
    """The same bounds: 1 row is too few, 5 is too large, there is no square; each said once, by its own name."""
    done = run(planted(), "--rows", 1, "--size", 5, "--shape", "square")
    assert done.exit_code == 2
    assert [text.split(": ")[0] for text in done.stderr.splitlines() if "error[" in text] == [
        "--time",
        "--rows",
        "--size",
        "--shape",
    ]
    assert list(wrong(Request(1.0, rows=1, size=5.0, shape="square"))) == [
        "rows must be 2 at least, not 1",
        "size must be between 0.5 and 4, not 5.0",
        "there is no shape square: choose from round, flat",
    ]
    assert list(wrong(Request(1.0))) == []


def test_what_does_not_go_together_is_said_with_the_rest(tmp_path: Path) -> None:
    done = run(planted(), "--time", 1, "--rows", 5, "--size", 5, "--out", tmp_path / "out")
    assert "--rows: error[five]: five are no rows\n  hint: take four" in done.stderr
    assert "2 errors; nothing was written." in done.stderr
    assert not (tmp_path / "out").exists()


def test_pairs_of_options_are_told_with_the_rest_even_of_a_description_that_cannot_be_read(tmp_path: Path) -> None:
    """One has its value, one is about another; of what was left out, and of what a default says, nothing is told."""
    pairs = [Apart("--shape flat", "--loud", "flat is never loud"), Needed("--rows", "--size", "for example --size 1")]
    study = planted(pairs=pairs)
    done = run(study, "--time", 1, "--shape", "Flat", "--loud", "--rows", 4)
    assert done.exit_code == 2
    assert "--rows: error[missing-option]: --rows goes with --size\n  hint: for example --size 1\n" in done.stderr
    assert (
        "--shape: error[conflicting-options]: --shape flat does not go with --loud: flat is never loud" in done.stderr
    )
    assert run(study, "--time", 1, "--loud", "--out", tmp_path / "loud").exit_code == 0
    assert run(study, "--time", 1, "--shape", "flat", "--rows", 4, "--size", 1, "--out", tmp_path).exit_code == 0
    wrong = filed(tmp_path / "wrong.yaml", "mbsym: 1\n")
    done = CliRunner().invoke(command_of(study), [str(wrong), "--rows", "4"], standalone_mode=False)
    assert "--rows goes with --size" in done.stderr


def test_a_place_in_a_text_is_shown() -> None:
    unread = Unfit("--shape", "late", "no such edge", None, "", "round or so", Span(1, 7, 2))
    done = run(planted(NotFit([unread])), "--time", 1)
    assert done.stderr.splitlines()[:3] == [
        "--shape: error[late]: no such edge",
        "  | round or so",
        "  |       ^^",
    ]


def test_what_stops_the_last_files_leaves_the_others_written(tmp_path: Path) -> None:
    """And is told as what it is: something has been written."""
    stopped = Answer((line("  told"),), {"first.txt": "1\n"}, stopped=KeyboardInterrupt())
    done = run(planted(stopped), "--time", 1, "--out", tmp_path)
    assert (done.exit_code, done.stdout, (tmp_path / "first.txt").read_text()) == (130, "", "1\n")
    assert done.stderr == f"{PENDULUM}: interrupted; what has been written is whole\n"


def test_json_is_that_of_the_file_however_it_was_made(tmp_path: Path) -> None:
    """Parts are made once, while they are written."""
    made = Answer((), {"found.json": (part for part in ("{", "}\n"))})
    done = run(planted(made, out=Folder(json=True)), "--time", 1, "--json", "--out", tmp_path)
    assert (done.stdout, (tmp_path / "found.json").read_text()) == ("{}\n", "{}\n")


def test_files_lines_and_quiet(tmp_path: Path) -> None:
    done = run(planted(), "--time", 2, "--set", "l=3", "--out", tmp_path)
    assert (done.exit_code, (tmp_path / "found.txt").read_text()) == (0, "6\n")
    assert done.stdout.splitlines()[1:] == ["  found 6", "  kept", f"  files in {tmp_path}: found.txt"]
    assert run(planted(), "--time", 2, "--quiet", "--out", tmp_path).stdout == "  kept\n"


@pytest.mark.parametrize(
    ("outcome", "code", "told"),
    [
        (KeyError("x"), 3, ["there is none", "  look elsewhere"]),
        (KeyboardInterrupt(), 130, ["interrupted; nothing was written"]),
        (PermissionError("no"), 1, ["the results cannot be written: no"]),
        (Answer((), {}, ("late",), Exit.INTERRUPTED), 130, ["late"]),
    ],
)
def test_what_ends_a_study_is_told(outcome: Any, code: int, told: list[str], tmp_path: Path) -> None:
    done = run(planted(outcome), "--time", 1, "--out", tmp_path)
    assert done.exit_code == code
    assert [text.removeprefix(f"{PENDULUM}: ") for text in done.stderr.splitlines()] == told
    assert list(tmp_path.iterdir()) == []


def test_what_does_not_fit_what_was_derived_is_wrong_input() -> None:
    done = run(planted(NotFit([Unfit("--size", "late", "there is no room")])), "--time", 1)
    assert (done.exit_code, done.stdout) == (2, "")
    assert done.stderr.startswith("--size: error[late]: there is no room\n")


def test_what_nobody_foresaw_is_a_defect() -> None:
    assert isinstance(run(planted(ZeroDivisionError("ours")), "--time", 1).exception, ZeroDivisionError)


@pytest.mark.parametrize(("text", "code"), [("whole\n", 0), (None, 1)])
def test_a_single_file(text: str | None, code: int, tmp_path: Path) -> None:
    study = planted(out=Single("Here."), document=lambda asked, request, found: Document(text, ("mind",)))
    answered = Answer((line("  told"),))
    done = run(Study(**{**vars(study), "answer": lambda *_: answered}), "--time", 1, "--out", tmp_path / "one")
    assert (done.exit_code, done.stderr) == (code, f"{PENDULUM}: mind\n")
    assert (tmp_path / "one").exists() == (text is not None)


def test_json_takes_the_place_of_lines(tmp_path: Path) -> None:
    done = run(planted(json=lambda asked, request, found: "{}\n"), "--time", 1, "--json", "--out", tmp_path)
    assert (done.exit_code, done.stdout) == (0, "{}\n")


def test_several_descriptions_each_in_a_folder_of_its_own(tmp_path: Path) -> None:
    """Of one name, too; a folder stands for those in it; what is wrong whatever the description is, is told once."""
    for name in ("first", "second"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "same.yaml").write_text(PENDULUM.read_text(encoding="utf-8"), encoding="utf-8")
    command = command_of(planted(several=True))
    words = [str(tmp_path / "first"), str(tmp_path / "second"), "--out", str(tmp_path / "out")]
    done = CliRunner().invoke(command, [*words, "--time", "2", "--set", "l=3"], standalone_mode=False)
    assert done.exit_code == 0, done.output
    assert {x.relative_to(tmp_path / "out").as_posix() for x in (tmp_path / "out").rglob("found.txt")} == {
        "same/found.txt",
        "same.yaml/found.txt",
    }
    done = CliRunner().invoke(command, [*words, str(tmp_path / "lost.yaml"), "--rows", "1"], standalone_mode=False)
    assert done.exit_code == 2
    assert done.stderr.count("--time: error") == done.stderr.count("--rows: error") == 1
    assert "lost.yaml: error[unreadable]" in done.stderr
    assert "options: 2 errors; nothing was written." in done.stderr


def test_what_goes_wrong_with_one_of_several_costs_that_one(tmp_path: Path) -> None:
    """And what was contained meanwhile is told of each, once; nothing stands around lines that are to stand alone."""
    for name in ("first", "second"):
        (tmp_path / f"{name}.yaml").write_text(PENDULUM.read_text(encoding="utf-8"), encoding="utf-8")
    twice = [ZeroDivisionError("ours"), ZeroDivisionError("ours")]
    study = planted(Answer((line("alone"),), {"found.txt": "1"}, code=Exit.FAILED, bare=True, defects=twice))

    def derive(asked: Asked, request: Request, watch: Watch) -> float:
        if "first" in asked.file:
            raise ValueError("lost")
        return 0.0

    command = command_of(Study(**{**vars(study), "derive": derive, "several": True}))
    words = [str(tmp_path), "--time", "1", "--set", "l=3", "--out", str(tmp_path / "out")]
    done = CliRunner().invoke(command, words, standalone_mode=False)
    assert (done.exit_code, done.stdout) == (1, "alone\n")
    assert [text.partition("yaml: ")[2] for text in done.stderr.splitlines()] == [
        "internal error, please report it: ValueError: lost",
        "internal error, please report it: ZeroDivisionError: ours",
    ]


def test_an_option_that_needs_a_word_of_a_list() -> None:
    """It is there where the list was left out, or has all; else that is said."""
    study = planted(pairs=[Among("--loud", "--shape", "flat", "only what is flat is loud", "take flat")])
    done = run(study, "--time", 1, "--loud", "--shape", "round")
    assert "--loud: error[conflicting-options]: only what is flat is loud\n  hint: take flat\n" in done.stderr
    for words in (("--loud",), ("--loud", "--shape", "flat"), ("--shape", "round")):
        assert "only what is flat" not in run(study, "--time", 1, *words).stderr


def test_a_run_in_python_gives_the_files_of_the_command(tmp_path: Path) -> None:
    command = ["run", str(PENDULUM), "--set", "l=3", "--format", "latex,json", "--out", str(tmp_path)]
    assert invoked(*command).exit_code == 0
    files = mbsym.run(PENDULUM, formats=("latex", "json"), values={"l": 3}).files
    assert {"report.tex", "results.json", "fragments/stability.tex"} <= set(files)
    assert all((tmp_path / name).read_text(encoding="utf-8") == text for name, text in files.items())
    printed = invoked(*command, "--json").stdout
    assert printed == files["results.json"]
    with pytest.raises(ValueError, match="there is no problem 99"):
        mbsym.run(PENDULUM, problems=(1, 99))


@pytest.mark.parametrize("name", STUDIES)
def test_every_field_of_every_study_is_an_option(name: str) -> None:
    """And no field lacks a kind: its option would be nowhere."""
    study = import_module(STUDIES[name]).STUDY
    assert study.name == name
    command = main.get_command(click.Context(main), name)
    assert command is not None
    options = [one.name for one in command.params if one.name != "file"]
    kinds = [one.name for one in fields_of(study.request)]
    assert options[: len(kinds)] == kinds == list(inspect.signature(study.request).parameters)
    assert all(isinstance(one.kind, Kind) for one in fields_of(study.request))


@pytest.mark.parametrize(
    ("function", "request_type"),
    [(name, import_module(f"mbsym.studies.{name}").Request) for name in ("lyapunov", "orbit", "floquet")],
)
def test_arguments_of_python_are_the_fields(function: str, request_type: type) -> None:
    taken = list(inspect.signature(getattr(mbsym, function)).parameters)
    assert taken == ["source", *(one.name for one in fields_of(request_type))]


def test_python_takes_a_request_or_its_fields() -> None:
    """Both are one computation; what is out of bounds is refused before anything is computed."""
    first = mbsym.lyapunov(PENDULUM, 5.0, count=1, values={"theta": "1/2"})
    second = mbsym.lyapunov(PENDULUM, LyapunovRequest(5.0, count=1, values={"theta": 0.5}))
    assert (first.values == second.values).all()
    with pytest.raises(ValueError, match="tolerance must be between 1e-14"):
        mbsym.lyapunov(PENDULUM, 5.0, tolerance=1.0)
    with pytest.raises(TypeError):
        mbsym.lyapunov(PENDULUM, 5.0, no_such=1)  # type: ignore[call-arg]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("map gravity-gradient --x A=0:2 --z D=2:1", ["--z", "--z", "--z"]),
        ("map gravity-gradient --x A=0:2 --y B=2:0 --locate nothing.csv", ["--y"]),
        ("oscillations spring-pendulum --of theta --format gif --language ru --out out", ["--format"]),
        ("equilibria orbital-gyrostat --vary q=1:2 --format json --out out --quiet", ["--vary"]),
        ("integrals euler-poisson --vary A=2:1 --cases", ["--vary", "--cases"]),
        ("integrals euler-poisson --budget x", ["--budget", "--budget"]),
        ("inverse cart-pole --motion p=t --motion theta=q --time 1", ["--motion"]),
    ],
)
def test_an_option_that_cannot_be_read_was_given(words: str, said: list[str]) -> None:
    """It is complained of itself; nothing is said as if it had been left out, and what it does not go with is said."""
    command, name, *options = words.split()
    done = invoked(command, SHIPPED / f"{name}.yaml", *options, code=2)
    assert [text.split(": ")[0] for text in done.stderr.splitlines() if "error[" in text] == said, done.stderr


@pytest.mark.parametrize("name", STUDIES)
def test_options_that_a_long_help_leaves_out_are_there(name: str) -> None:
    study = import_module(STUDIES[name]).STUDY
    assert {*study.rare} <= {listed.name for listed in fields_of(study.request)}
