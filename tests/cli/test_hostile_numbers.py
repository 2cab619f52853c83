"""Hostile claims, numbers and options: refused with a place, undecided with a reason, or done; never a crash."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from threading import Timer

import pytest
from conftest import SHIPPED, invoked

import mbsym
from mbsym.analysis import Analysis
from mbsym.problems.claims import ClaimResult, Outcome
from mbsym.report.code import c_source
from mbsym_cli.files import alone, obstacle

PENDULUM = """
mbsym: 1
name: Pendulum
parameters: {m: positive, l: positive, J: positive, g: positive}
bodies:
  - name: bob
    attached to: 0
    rotation: {axes: [3], angles: [theta]}
    mass centre: [0, -l, 0]
    mass: m
    inertia about: mass centre
    inertia: [J, J, J]
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
motion: {theta: 0}
values: {m: 1, l: 2, J: 0.5, g: 9.81}
initial: {theta: {position: pi/6, velocity: 1.5}}
"""

#: theta'' = 0: every function of theta' is a first integral.
ROTOR = """
mbsym: 1
name: Rotor
parameters: {J: positive}
bodies:
  - name: disc
    attached to: 0
    rotation: {axes: [3], angles: [theta]}
    mass: 0
    inertia about: mass centre
    inertia: [J, J, J]
motion: {theta: 0}
"""


def judged(*claims: str, text: str = PENDULUM) -> tuple[ClaimResult, ...]:
    return mbsym.loads(text + "claims:\n" + "".join(f"  - {{{claim}}}\n" for claim in claims)).claims


# --- numbers at a state -----------------------------------------------------------------------------------------------

#: 1e-40 - sin(1e-40) = 1e-120/6 (1 - 1e-80/20 ...): 256 bits hold none of its digits.
CANCELS = "claim: value, of: (theta - sin(theta))*10**60*10**60, state: {theta: 1e-40}"


@pytest.mark.parametrize(
    ("equals", "outcome"),
    [
        ("0.16667", Outcome.DIGITS),
        ("0.16668", Outcome.DIFFERS),
        ("0.5", Outcome.DIFFERS),
        ("5", Outcome.DIFFERS),
        ("1/7", Outcome.DIFFERS),
    ],
)
def test_digits_that_cancel_are_computed_in_more_bits(equals: str, outcome: str) -> None:
    (result,) = judged(f"{CANCELS}, equals: {equals}")
    assert result.outcome == outcome
    assert result.value == "0.166666666667"


#: sqrt(2) to 100 digits (OEIS A002193).
ROOT = "1.414213562373095048801688724209698078569671875376948073176679737990732478462107038850387534327641572"


@pytest.mark.parametrize(("place", "outcome"), [(92, Outcome.DIGITS), (90, Outcome.DIFFERS)])
def test_more_digits_than_256_bits_hold(place: int, outcome: str) -> None:
    """sqrt(2)*10**45 with 92 digits; the planted error is in the 90th."""
    digits = ROOT.replace(".", "")[:91]
    if outcome == Outcome.DIFFERS:
        digits = digits[: place - 1] + str((int(digits[place - 1]) + 5) % 10) + digits[place:]
    (result,) = judged(f'claim: value, of: sqrt(2)*10**45, state: {{theta: 1}}, equals: "{digits[:46]}.{digits[46:]}"')
    assert result.outcome == outcome


def test_numbers_that_have_no_value_are_undecided() -> None:
    found = judged(
        "claim: value, of: sin(exp(exp(theta))), state: {theta: 10}, equals: 1.0",
        "claim: value, of: exp(exp(exp(theta))), state: {theta: 1000}, equals: 1.0",
        "claim: value, of: 1/theta_dot, state: {theta: 0}, equals: 1.0",
        "claim: kinetic energy, state: {theta: 0}, equals: 1/theta_dot",
        "claim: value, of: theta_ddot, state: {m: 0, J: 0}, equals: 1.0",
    )
    assert [result.outcome for result in found] == [Outcome.UNDECIDED] * 5
    assert "cancel" in found[0].remark
    assert "finite" in found[3].remark
    assert "singular" in found[4].remark


def test_a_half_in_the_last_place_and_zero_are_decided() -> None:
    """0.125 lies on the border of 0.12; a value that is zero but for rounding is what was claimed."""
    found = judged(
        "claim: value, of: theta/8, state: {theta: 1}, equals: 0.12",
        "claim: value, of: sin(theta)**2 + cos(theta)**2 - 1, state: {theta: 1}, equals: 0*theta",
        "claim: value, of: sin(theta)**2 + cos(theta)**2 - 1, state: {theta: 1}, equals: 1/10**40",
    )
    assert [result.outcome for result in found] == [Outcome.DIGITS, Outcome.NUMERICAL, Outcome.DIFFERS]


# --- formulas ---------------------------------------------------------------------------------------------------------


def test_first_integrals_that_are_no_polynomials_in_velocities() -> None:
    held = ("1/theta_dot", "sqrt(1 + theta_dot**2)", "exp(theta_dot)", "theta - t*theta_dot")
    wrong = ("1/theta_dot + theta", "sqrt(1 + t*theta_dot**2)", "3")
    found = judged(*(f"claim: first integral, equals: {one}" for one in held + wrong), text=ROTOR)
    assert all(result.holds for result in found[: len(held)])
    assert all(result.refuted for result in found[len(held) :])


def test_an_angle_that_no_ring_holds_spoils_no_other_claim() -> None:
    found = judged(
        "claim: kinetic energy, equals: (J + m*l**2)*theta_dot**2/2",
        "claim: kinetic energy, equals: sin(theta/1000)",
        "claim: equation of motion, of: theta, equals: sin(theta_ddot)",
        'claim: characteristic polynomial, variable: p, equals: "p**2*sin(p)"',
        "claim: force function, equals: m*g*l*cos(theta)",
    )
    assert [result.outcome for result in found] == [
        Outcome.EXACT,
        Outcome.UNDECIDED,
        Outcome.DIFFERS,
        Outcome.UNDECIDED,
        Outcome.EXACT,
    ]


@pytest.mark.parametrize(
    ("claim", "what"),
    [
        ("claim: coefficient, of: kinetic energy, equals: 1, at: 0", "at: "),
        ("claim: value, of: theta, equals: 1, state: {}", "state: "),
    ],
)
def test_claims_about_nothing_are_refused_with_their_place(claim: str, what: str) -> None:
    line, column = len(PENDULUM.splitlines()) + 2, len("  - {") + claim.index(what) + len(what) + 1
    with pytest.raises(mbsym.DescriptionError, match=f":{line}:{column}: error"):
        judged(claim)


# --- C ----------------------------------------------------------------------------------------------------------------


def test_macros_of_mathematical_headers_are_no_variables(tmp_path: Path) -> None:
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler")
    names = ("MODEL_H", "math_errhandling", "MATH_ERRNO", "MATH_ERREXCEPT", "double", "I", "out", "x", "s0", "main")
    text = PENDULUM.replace("g: positive}", f"g: positive, {', '.join(f'{name}: positive' for name in names)}}}")
    text = text.replace("mass: m", f"mass: m + {' + '.join(names)}").replace("theta", "FP_FAST_FMA")
    analysis: Analysis = mbsym.loads(text)
    (tmp_path / "model.c").write_text(c_source.render(analysis, analysis.problems))
    (tmp_path / "model.h").write_text(c_source.header(analysis, analysis.problems))
    command = [compiler, "-Wall", "-Wextra", "-Werror", "-pedantic", "-std=c99", "-c", "model.c"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


# --- commands ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("command", ["simulate", "tradeoff", "extremes"])
def test_a_folder_that_cannot_be_is_said_before_anything_is_computed(command: str, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    arguments = [command, str(SHIPPED / "simple-pendulum.yaml"), "--set", "theta=1"]
    arguments += [] if command == "extremes" else ["--time", "1"]
    for folder in (tmp_path / "file" / "inside", tmp_path / ("a" * 300)):
        done = invoked(*arguments, "-o", folder, code=1)
        assert "cannot be written" in done.stderr
    assert not obstacle(tmp_path / "new" / "folder")


@pytest.mark.skipif(os.name != "posix", reason="locks")
def test_two_runs_into_one_folder_do_not_mix_their_files(tmp_path: Path) -> None:
    script = (
        "import sys; from pathlib import Path; from mbsym_cli.files import alone, write_whole\n"
        "with alone(Path('.')): print('in', flush=True); sys.stdin.read(); write_whole(Path('a'), 'first')\n"
    )
    first = subprocess.Popen(
        [sys.executable, "-c", script], cwd=tmp_path, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert first.stdout is not None
    assert first.stdout.readline() == "in\n"
    Timer(0.3, lambda: first.stdin and first.stdin.close()).start()
    with alone(tmp_path):  # waits for the other one
        assert (tmp_path / "a").read_text() == "first"
    assert first.wait(timeout=30) == 0
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


@pytest.mark.skipif(os.name != "posix", reason="signals")
@pytest.mark.parametrize("command", ["run", "equilibria", "check", "simulate"])
def test_interrupting_any_command_gives_130(command: str, tmp_path: Path) -> None:
    """The signal comes while the description is read."""
    script = (
        "import os, signal, sys, mbsym.source as source\n"
        "def load(path): os.kill(os.getpid(), signal.SIGINT)\n"
        "source.load = load\n"
        "from mbsym_cli.main import main\n"
        "main(sys.argv[1:])\n"
    )
    arguments = [command, str(SHIPPED / "simple-pendulum.yaml"), *(["-t", "1"] if command == "simulate" else [])]
    done = subprocess.run(
        [sys.executable, "-c", script, *arguments],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
        restore_signals=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    assert done.returncode == 130, done.stderr
    assert "Traceback" not in done.stderr
    assert not list(tmp_path.iterdir())
