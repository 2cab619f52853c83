"""Options and settings of the commands: every complaint at once, in one style, before anything is computed or written.

--option: error[code]: what is wrong
  | the value
  |     ^^^^^
  hint: what to write instead
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result
from conftest import SHIPPED, filed, invoked

from mbsym.expressions.parser import names_apart, parse_expression
from mbsym.expressions.place import Complaints, Span
from mbsym_cli.main import main
from mbsym_cli.options import Options

DOUBLE = SHIPPED / "double-pendulum.yaml"  # conservative: m1, m2, l1, l2, g positive; theta1, theta2
DAMPED = """
mbsym: 1
name: Damped oscillator
parameters: {m: positive, k: positive, c: nonnegative, e: real}
bodies:
  - {name: cart, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}
loads:
  - spring: {coordinate: x, stiffness: k}
  - damper: {coordinate: x, coefficient: c}
relations: {e: k/m}
values: {m: 1, k: 4, c: 1/10}
initial: {x: 1}
"""
KEPLER = """
mbsym: 1
name: Kepler problem
parameters: {m: positive, mu: positive}
bodies:
  - {name: planet, attached to: 0, connection point: [r*cos(phi), r*sin(phi), 0], mass: m, coordinates: [r, phi]}
loads:
  - potential: -mu*m/r
values: {m: 1, mu: 1}
initial: {r: 1, phi: 0}
"""


def described(folder: Path, text: str) -> Path:
    return filed(folder / "system.yaml", text)


def heads(done: Result) -> list[str]:
    """The first lines of all complaints about options; what else is printed must be their rest, or the count."""
    found = []
    for line in done.stderr.splitlines():
        if re.match(r"--[a-z-]+: error\[[a-z-]+\]: ", line):
            found.append(line)
        else:
            assert re.match(r"  \| |  hint: |.*\d errors?; nothing was written\.$", line), line
    return found


def codes(done: Result) -> list[tuple[str, str]]:
    return [re.findall(r"--[a-z-]+(?=:)|(?<=error\[)[a-z-]+", line)[:2] for line in heads(done)]  # type: ignore[misc]


SETTINGS = ("--set", "theta1=pi", "--set", "m1=-1", "--set", "zz=2", "--set", "l1=cs(q)", "--set", "g=30deg")


@pytest.mark.parametrize(
    "words",
    [("simulate", "--time", 1), ("tradeoff", "--time", 1), ("extremes",), ("equilibria",)],
    ids=lambda words: words[0],
)
def test_settings_are_complained_about_in_one_round_and_in_the_same_words(words: Any, tmp_path: Path) -> None:
    out = () if words[0] == "equilibria" else ("--out", tmp_path / "out")
    settings = [word for word in SETTINGS if words[0] != "equilibria" or word != "theta1=pi"]
    if words[0] == "equilibria":
        settings = settings[1:]
    done = invoked(words[0], DOUBLE, *words[1:], *settings, *out, code=2)
    assert heads(done) == [
        "--set: error[unknown-name]: there is nothing called 'zz' to set",
        "--set: error[unknown-function]: unknown function 'cs'",
        "--set: error[unknown-name]: unknown name 'q'",
        "--set: error[bad-expression]: an operator is missing before 'deg'",
        "--set: error[sign-contradiction]: m1 = -1, but it is declared positive",
    ]
    assert "  | m1=-1\n  | ^^^^^\n" in done.stderr
    assert "  | l1=cs(q)\n  |       ^\n" in done.stderr
    assert "angles are in radians: write 30*pi/180 or pi/6" in done.stderr
    assert done.stderr.endswith("double-pendulum.yaml: 5 errors; nothing was written.\n")
    assert not (tmp_path / "out").exists()


def test_a_value_that_was_refused_is_not_missing_as_well(tmp_path: Path) -> None:
    path = described(tmp_path, DAMPED.replace("values: {m: 1, k: 4, c: 1/10}", "values: {m: 1}"))
    done = invoked("simulate", path, "--time", 1, "--set", "k=3 N", "--out", tmp_path / "out", code=2)
    assert "no value for c\n" in done.stderr
    assert "2 errors" in done.stderr


def test_an_input_is_not_set_but_given(tmp_path: Path) -> None:
    driven = DAMPED.replace("loads:", "inputs: {F: a force}\nloads:\n  - generalized force: {x: F}")
    done = invoked("simulate", described(tmp_path, driven), "--time", 1, "--set", "F=0")
    assert heads(done) == ["--set: error[misplaced-name]: 'F' is an input and has no value to set"]
    assert "--input F=..." in done.stderr


def test_a_relation_that_is_broken_by_a_setting_is_said_of_the_setting(tmp_path: Path) -> None:
    path = described(tmp_path, DAMPED)
    done = invoked("simulate", path, "--time", 1, "--set", "e=5", "--set", "c=-1", "--out", tmp_path / "out")
    assert heads(done) == [
        "--set: error[conflicting-values]: e = 5 contradicts its relation, which gives 4",
        "--set: error[sign-contradiction]: c = -1, but it is declared nonnegative",
    ]
    fine = invoked(
        "simulate", path, "--time", 1, "--set", "e=4", "--set", "c=0", "-f", "csv", "--out", tmp_path / "out"
    )
    assert fine.exit_code == 0, fine.output


def test_all_options_of_simulate_at_once(tmp_path: Path) -> None:
    words = ["--time", "20s", "--method", "rk5", "--set", "Q=3", "--set", "theta1=30deg", "--tolerance", "-1"]
    words += ["--format", "jpg", "--samples", "0", "--step-limit", "x", "--arithmetic", "float16"]
    done = invoked("simulate", DOUBLE, *words, "--out", tmp_path / "out", code=2)
    assert sorted(map(tuple, codes(done))) == [
        ("--arithmetic", "unknown-arithmetic"),
        ("--format", "unknown-format"),
        ("--method", "unknown-method"),
        ("--samples", "bad-number"),
        ("--set", "bad-expression"),
        ("--set", "unknown-name"),
        ("--step-limit", "bad-number"),
        ("--time", "bad-expression"),
        ("--tolerance", "bad-number"),
    ]
    assert "did you mean 'rk45'?" in done.stderr
    assert "no units beside numbers: write numbers only" in done.stderr
    assert done.stderr.endswith("9 errors; nothing was written.\n")
    assert not (tmp_path / "out").exists()


def test_the_description_is_read_even_if_the_options_are_wrong(tmp_path: Path) -> None:
    path = described(tmp_path, DAMPED.replace("mass: m", "mass: mm"))
    for words in (("simulate", "--method", "rk5"), ("tradeoff", "--methods", "rk5"), ("run", "--problems", "99")):
        done = invoked(words[0], path, *words[1:], "--out", tmp_path / "out", code=2)
        assert "error[unknown-name]: unknown name 'mm'" in done.stderr
        assert f"{words[1]}: error[unknown-" in done.stderr
        assert ("--time: error[missing-option]" in done.stderr) == (words[0] != "run")
        assert "options: " in done.stderr


@pytest.mark.parametrize(
    ("text", "words", "code", "said"),
    [
        ("", ["--method", "rk4"], ("--method", "missing-option"), "--step 0.0002, a 10000th of the time"),
        ("", ["--method", "rk4", "--tolerance", "1e-6"], ("--tolerance", "conflicting-options"), "give a --step"),
        ("", ["--step", "1"], ("--step", "conflicting-options"), "rk4"),
        ("", ["--method", "dop853", "--step", "1"], ("--step", "conflicting-options"), "leave --step out"),
        ("", ["--step", "1", "--tolerance", "1e-6"], ("--step", "conflicting-options"), "exclude each other"),
        ("", ["--samples", "3", "--every", "1"], ("--every", "conflicting-options"), "exclude each other"),
        ("", ["--method", "rk4", "--step", "3"], ("--step", "bad-number"), "longer than the whole time"),
        ("", ["--method", "radau", "--arithmetic", "float32"], ("--arithmetic", "conflicting-options"), "these do: "),
        (DAMPED, ["--method", "midpoint", "--step", "1"], ("--method", "unsuitable-method"), "coordinate damper"),
    ],
)  # fmt: skip
def test_methods_that_do_not_fit_are_refused_before_compiling(
    text: str, words: list[str], code: tuple[str, str], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def compiled(*_: object) -> None:
        raise AssertionError("too late")

    monkeypatch.setattr("mbsym.numerics.dynamics.Dynamics", compiled)
    path = described(tmp_path, text) if text else DOUBLE
    done = invoked("simulate", path, "--time", 2, *words, "--out", tmp_path / "out", code=2)
    assert [tuple(one) for one in codes(done)] == [code]
    assert said in done.stderr
    assert "nothing was written" in done.stderr


def test_a_method_of_fixed_step_runs_with_its_step(tmp_path: Path) -> None:
    done = invoked("simulate", DOUBLE, "--time", 1, "--method", "RK4", "--step", "0.01", "-f", "csv", "-o", tmp_path)
    assert done.exit_code == 0, done.output


def test_each_mistake_of_tradeoff_is_said_once(tmp_path: Path) -> None:
    words = ["--time", "1", "--methods", "foo,rk5,rk4", "--target", "-1", "--budget", "0", "--out", tmp_path / "out"]
    done = invoked("tradeoff", DOUBLE, *words, code=2)
    assert heads(done) == [
        "--target: error[bad-number]: it must be positive",
        "--methods: error[unknown-method]: there is no method 'foo'",
        "--methods: error[unknown-method]: there is no method 'rk5'",
        "--budget: error[bad-number]: it must be positive",
    ]
    assert "hint: choose between 1e-15 and 0.1" in done.stderr
    assert "did you mean 'rk45'?" in done.stderr


def test_all_options_of_run_at_once(tmp_path: Path) -> None:
    done = invoked("run", DOUBLE, "--problems", "99,5-3", "--format", "pdf", "--terms", "-1", "--out", tmp_path / "out")
    assert done.exit_code == 2
    assert heads(done) == [
        "--problems: error[unknown-problem]: there is no problem 99",
        "--problems: error[bad-range]: the range 5-3 is empty",
        "--format: error[unknown-format]: there is no format 'pdf'",
        "--terms: error[bad-number]: -1 is out of bounds: at least 1",
    ]
    assert "hint: a range goes upwards: write 3-5" in done.stderr
    assert "hint: problems are numbered 1 to 12" in done.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("text", "found", "wrong"),
    [
        ("1-5", (1, 2, 3, 4, 5), []),
        (" 6 , 1 - 2,2", (1, 2, 6), []),
        ("5-3", (), ["bad-range"]),
        ("0", (), ["unknown-problem"]),
        ("2,6-99", (2,), ["unknown-problem"]),
        ("1-999999999", (), ["unknown-problem"]),
        ("1-99999999999999999999", (), ["bad-number"]),
        ("", (), ["bad-number"]),
        ("1,", (1,), ["bad-number"]),
        ("-", (), ["bad-number"]),
        ("\u00b2,x", (), ["bad-number", "bad-number"]),
    ],
)
def test_problem_numbers(text: str, found: tuple[int, ...], wrong: list[str]) -> None:
    asked = Options()
    assert asked.problems(text) == found
    assert [complaint.split("[")[1].split("]")[0] for complaint in asked.complaints] == wrong


def test_equilibria_wants_exact_numbers_and_no_state(tmp_path: Path) -> None:
    done = invoked("equilibria", DOUBLE, "--set", "m1=sqrt(2)", "--set", "theta1=1", "--within", "1e9", code=2)
    assert [tuple(one) for one in codes(done)] == [("--set", "misplaced-name"), ("--within", "bad-number")]
    varied = invoked("equilibria", DOUBLE, "--vary", "m2=1:2", "--set", "m1=sqrt(2)", "--out", tmp_path / "out")
    assert [tuple(one) for one in codes(varied)] == [("--set", "not-rational")]
    assert invoked("equilibria", DOUBLE, "--set", "m1=3/2", "--within", "2*pi").exit_code == 0


def test_a_fall_to_the_centre_is_no_matter_of_angles_alone(tmp_path: Path) -> None:
    path = described(tmp_path, KEPLER)
    done = invoked("simulate", path, "--time", 3, "-f", "csv", "--no-estimate", "--out", tmp_path / "out", code=3)
    assert "error[singular-mass-matrix]" in done.stderr
    assert "a distance has shrunk to zero (a collision, a fall to the centre)" in done.stderr


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("a*b + sin(c)", ["a", "b", "c"]),
        ("a*(b + 3 kg) + d", ["a", "b", "d"]),
        ("some words + b", ["some", "b"]),
        ("a + \u03b8_dot*b'", ["a", "b_dot"]),
        ("a + b'''", ["a"]),
        ("f(a) + sqrt + pi", ["a", "pi"]),
        ("a +* b", ["a", "b"]),
        ("", []),
    ],
)
def test_names_of_what_is_no_expression(text: str, found: list[str]) -> None:
    assert [one.name for one in names_apart(text, lambda start, end: Span(1, start + 1, end - start), [])] == found


@pytest.mark.parametrize("text", ["x+" * 9_999, "(" * 20_000, "\u00e9a+" * 500, "a b " * 5_000, "a" * 20_001])
def test_long_nonsense_ends(text: str) -> None:
    complaints = Complaints()

    def place(start: int, end: int) -> Span:
        return Span(1, start + 1, end - start)

    assert parse_expression(text, complaints, place) is None
    assert len(names_apart(text, place, complaints.items[:200])) <= 10_000


def test_long_values_and_control_characters_are_shown_safely() -> None:
    asked = Options()
    assert asked.number("--time", "1" + "+1" * 5_000) is None
    assert asked.number("--time", "1\x1b[2J") is None
    assert asked.word("--method", "rk\x1b4" + "x" * 5_000, ("rk4",), "method") is None
    assert asked.whole("--samples", "9" * 5_000, 1, 5) is None
    assert len(asked.complaints) == 5  # two characters of the escape sequence
    assert all(len(line) < 250 and "\x1b" not in line for text in asked.complaints for line in text.splitlines())


@pytest.mark.parametrize("command", ["run", "simulate", "tradeoff", "extremes", "convert"])
def test_an_empty_path_is_not_the_current_folder(command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    done = invoked(command, DOUBLE, "--out", "", code=2)
    assert "it is empty" in done.stderr
    assert not list(tmp_path.iterdir())


#: Commands with one place for a number or a formula, {}.
PLACES = [
    "simulate {pendulum} -t 1 -s l={}",
    "simulate {pendulum} -t 1 -s theta={}",
    "simulate {pendulum} -t {}",
    "simulate {pendulum} -t 1 --accuracy {}",
    "map {ziegler} --x P={}:4",
    "map {ziegler} --x P=0:4 -s k={}",
    "sweep {ziegler} --vary P={}:4:5",
    "sweep {ziegler} --vary P=0:4:5 --measure {}",
    "inverse {cart-pole} --motion p={} --motion theta=0 -t 1",
    "equilibria {pendulum} -s g={}",
    "orbit {pendulum} --period {}",
    "extremes {pendulum} -s l={}",
    "view {pendulum} -s l={}",
    "nonlinear {three-bodies} -s mu={}",
    "integrals {heavy-top} -s A={}",
    "run {pendulum} --animate {}",
]


@pytest.mark.parametrize("place", PLACES)
def test_numbers_that_are_none_are_refused_wherever_they_are_typed(place: str, tmp_path: Path) -> None:
    """sqrt(-1), log(0), tan(pi/2) and 1/(2 - 2) are no numbers, and exp(1000) = 2e434 is none that a double holds."""
    files = {"pendulum": "simple-pendulum"}
    words = re.sub(r"{([\w-]+)}", lambda name: str(SHIPPED / f"{files.get(name[1], name[1])}.yaml"), place).split()
    for number in ("sqrt(-1)", "log(0)", "exp(1000)", "tan(pi/2)", "1/(sqrt(2)**2-2)"):
        done = CliRunner().invoke(main, [word.replace("{}", number) for word in words])
        assert done.exit_code == 2, (number, done.output)
        assert done.stderr.startswith("--"), done.stderr
        assert not done.stdout
