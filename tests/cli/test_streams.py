"""What happens to the streams, signals and folders of a process, tried on processes."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SYSTEMS = ROOT / "systems"
PENDULUM = SYSTEMS / "simple-pendulum.yaml"
MBSYM = f"{sys.executable} -m mbsym_cli"
HOSTILE = "a\x1b]0;title\x07[red]\n.yaml"

pytestmark = pytest.mark.skipif(os.name != "posix", reason="shells and signals")


def shell(command: str, folder: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    """A command line in which ``mbsym`` is the program and $S the folder of systems."""
    defined = 'mbsym() { "$PY" -c "from mbsym_cli.main import main; main()" "$@"; }\n'
    known = {"PY": sys.executable, "S": str(SYSTEMS), "P": str(PENDULUM), **environment}
    return subprocess.run(
        ["bash", "-c", defined + command],
        cwd=folder,
        env={**os.environ, **known},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


def test_a_reader_who_goes_costs_nothing(tmp_path: Path) -> None:
    """The reader is gone before the first line, and the exit code is what the files deserve."""
    (tmp_path / "bad.yaml").write_text("mbsym: 1\n")
    done = shell('mbsym check $S > >(exec true); echo "code $?"', tmp_path)
    assert (done.stdout, done.stderr) == ("code 0\n", "")
    done = shell('{ sleep 0.2; mbsym check bad.yaml $S; echo "code $?" >&2; } | true', tmp_path)
    assert "code 2" in done.stderr
    assert "internal error" not in done.stderr


def test_reports_are_written_though_nobody_reads(tmp_path: Path) -> None:
    done = shell('{ sleep 0.2; mbsym run "$P" -f json -p 1 -o out; echo "code $?" >&2; } | true', tmp_path)
    assert done.stderr == "code 0\n"
    assert (tmp_path / "out" / "results.json").exists()


@pytest.mark.parametrize("closing", [">&-", "2>&-", "<&-", ">&- 2>&-", "<&- >&- 2>&-"])
def test_closed_streams(closing: str, tmp_path: Path) -> None:
    """Nothing is said, and no file of the run gets what was meant for a stream."""
    done = shell(f'mbsym run "$P" -f json,c -p 1,2 -o out {closing}; exit $?', tmp_path)
    assert done.returncode == 0, done.stderr
    assert "internal error" not in done.stdout + done.stderr
    assert (tmp_path / "out" / "results.json").read_text().startswith("{")
    assert "self-check" not in "".join(path.read_text() for path in (tmp_path / "out").iterdir())


def test_errors_do_not_go_to_standard_output_when_their_stream_is_closed(tmp_path: Path) -> None:
    done = shell("mbsym check missing.yaml 2>&-", tmp_path)
    assert (done.returncode, done.stdout) == (2, "")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
@pytest.mark.parametrize("command", ['check "$P"', 'run "$P" -f json -p 1 -o out', 'convert "$P"', "schema", "explain"])
def test_a_full_output_is_told_once(command: str, tmp_path: Path) -> None:
    done = shell(f"mbsym {command} > /dev/full", tmp_path)
    assert done.returncode == 1
    assert done.stderr == "standard output cannot be written: No space left on device\n"


@pytest.mark.parametrize(
    "environment",
    [{"PYTHONIOENCODING": "ascii"}, {"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"}],
    ids=["ascii", "C"],
)
def test_a_terminal_that_knows_only_ascii(environment: dict[str, str], tmp_path: Path) -> None:
    (tmp_path / "träger.yaml").write_text(PENDULUM.read_text().replace("Simple pendulum", "Träger"), encoding="utf-8")
    for command in ("check *.yaml", "run *.yaml -f json -p 1 -o out", "run *.yaml --brief -f json -p 1 -o out"):
        done = shell(f"mbsym {command}", tmp_path, **environment)
        assert (done.returncode, done.stderr) == (0, "")
        assert "r\\xe4ger" in done.stdout
    shell("mbsym convert *.yaml --to yaml > again", tmp_path, **environment)
    assert 'name: "Träger"' in (tmp_path / "again").read_text(encoding="utf-8")


def test_a_folder_that_is_gone(tmp_path: Path) -> None:
    gone = "mkdir gone; cd gone; rmdir ../gone; "
    done = shell(f"{gone} mbsym check here.yaml", tmp_path)
    assert done.returncode == 2
    assert "here.yaml: error[unreadable]" in done.stderr
    assert shell(f'{gone} mbsym check "$P"', tmp_path).returncode == 0
    done = shell(f'{gone} mbsym run "$P" -f json -p 1', tmp_path)
    assert done.returncode == 1
    assert "the results cannot be written" in done.stderr
    assert shell(f'{gone} mbsym run "$P" -f json -p 1 -o "$OUT"', tmp_path, OUT=str(tmp_path / "out")).returncode == 0
    for command in ("simulate -t 1 -s theta=1", "tradeoff -t 1 -s theta=1", "extremes -s theta=1"):
        done = shell(f'{gone} mbsym {command} "$P"', tmp_path)
        assert done.returncode == 1
        assert "cannot be written" in done.stderr
        assert "internal error" not in done.stderr


def test_links_that_loop_and_names_that_are_too_long(tmp_path: Path) -> None:
    (tmp_path / "loop.yaml").symlink_to("loop.yaml")
    for name in ("loop.yaml", "a" * 300 + ".yaml", "a/" * 3000 + ".yaml"):
        for command in ("check", "run", "simulate -t 1", "equilibria", "extremes", "tradeoff -t 1", "convert"):
            done = shell(f"mbsym {command} {name}", tmp_path) if command in ("check", "run") else None
            if done is None:
                continue
            assert done.returncode == 2, done.stderr
            assert "error[unreadable]: the file cannot be read" in done.stderr
    done = shell(f'mbsym convert "$P" --out {"a" * 300}.yaml', tmp_path)
    assert (done.returncode, "cannot be written: File name too long" in done.stderr) == (1, True)
    (tmp_path / "good.yaml").write_text(PENDULUM.read_text())
    assert shell("mbsym check .", tmp_path).stdout.startswith("good.yaml: ok")


def test_a_pipe_in_a_folder_blocks_nobody_and_one_that_is_named_is_read(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "x.yaml")
    (tmp_path / "good.yaml").write_text(PENDULUM.read_text())
    done = shell("mbsym check .", tmp_path)
    assert done.returncode == 0
    assert done.stdout.count(": ok: ") == 1
    assert ": ok: " in shell('mbsym check <(cat "$P")', tmp_path).stdout


def test_names_of_files_reach_no_terminal_as_they_are(tmp_path: Path) -> None:
    (tmp_path / HOSTILE).write_text(PENDULUM.read_text())
    (tmp_path / f"bad{HOSTILE}").write_text("mbsym: 1\nname: x\n")
    for command in (
        "check *",
        "run -f json -p 1 *",
        "run --brief -f json -p 1 *",
        "simulate -t 1 bad*",
        "equilibria bad*",
    ):
        done = shell(f"mbsym {command}", tmp_path)
        assert done.returncode == 2
        assert not {"\x1b", "\x07"} & set(done.stdout + done.stderr)
        assert "internal error" not in done.stderr
    assert [path.name for path in (tmp_path / "reports").iterdir()] == ["a_]0;title_[red]_"]


TELLING = """
import sys
from mbsym.numerics import simulate
honest = simulate.followed
def told(dynamics, method, setting, times, rows, arithmetic, watch, *more, **named):
    def first(t):
        nonlocal watch
        print("under way", file=sys.stderr, flush=True)
        watch = lambda t: None
    watch = first
    return honest(dynamics, method, setting, times, rows, arithmetic, lambda t: watch(t), *more, **named)
simulate.followed = told
from mbsym_cli.main import main
main()
"""
LONG = "-s theta=1 -t 1e6 --method rk4 --step 1e-3 --step-limit 1000000000 --samples 10000 -f csv -o out --no-estimate"


@pytest.mark.parametrize(("number", "code"), [(signal.SIGTERM, 143), (signal.SIGHUP, 129), (signal.SIGINT, 130)])
def test_signals_keep_what_was_computed(number: int, code: int, tmp_path: Path) -> None:
    """The signal comes when the first samples are there."""
    command = [sys.executable, "-c", TELLING, "simulate", str(PENDULUM), *LONG.split()]
    child = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    assert child.stderr is not None
    assert child.stderr.readline() == "under way\n"
    child.send_signal(number)
    _, said = child.communicate(timeout=60)
    assert child.returncode == code, said
    assert "kept up to t =" in said
    assert (tmp_path / "out" / "trajectory-partial.csv").exists()


def test_a_signal_during_a_batch_leaves_whole_reports(tmp_path: Path) -> None:
    child = subprocess.Popen(
        [
            sys.executable,
            "-c",
            "from mbsym_cli.main import main; main()",
            "run",
            str(SYSTEMS),
            "-q",
            "-o",
            str(tmp_path),
        ],
        stderr=subprocess.PIPE,
        text=True,
    )
    deadline = time.monotonic() + 30
    while not list(tmp_path.glob("*/results.json")) and time.monotonic() < deadline:
        time.sleep(0.02)
    child.terminate()
    _, said = child.communicate(timeout=30)
    assert child.returncode == 143, said
    assert said == f"{SYSTEMS}: interrupted; what has been written is whole\n"
    names = {
        "report.tex",
        "appendix.tex",
        "fragments",
        "report.wl",
        "model.py",
        "model.c",
        "model.h",
        "results.json",
        "report.html",
        ".mbsym.json",
    }
    for folder in tmp_path.iterdir():
        assert {path.name for path in folder.iterdir()} in (names, set())


def test_tracebacks_are_shown_where_they_are_wanted(tmp_path: Path) -> None:
    planted = (
        "import sys, mbsym_cli.check as check\n"
        "def broken(*_, **__): raise RuntimeError('planted')\n"
        "check.read_description = broken\n"
        "from mbsym_cli.main import main\nmain(sys.argv[1:])\n"
    )
    for arguments, wanted in ((["check"], False), (["--debug", "check"], True), (["check", "--debug"], True)):
        done = subprocess.run(
            [sys.executable, "-c", planted, *arguments, str(PENDULUM)], capture_output=True, text=True, check=False
        )
        assert done.returncode == 1
        assert "internal error, please report it: RuntimeError: planted" in done.stderr
        assert ("Traceback" in done.stderr) == wanted
