"""The README says only what is true: its commands run, its description loads, its printed output is what is printed."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import warm
from pages import DOCS, pages
from pages import blocks as shown

import mbsym

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", README, re.DOTALL | re.MULTILINE)


def commands() -> list[str]:
    return [line for block in blocks("sh") for line in block.splitlines() if line.startswith("mbsym ")]


@pytest.fixture
def workplace(tmp_path: Path) -> Path:
    """A folder that looks like the clone, without being it."""
    (tmp_path / "systems").symlink_to(ROOT / "systems")
    return tmp_path


def shell(line: str, folder: Path) -> subprocess.CompletedProcess[str]:
    return warm.run(shlex.split(line, comments=True)[1:], cwd=folder)


#: What commands over the whole folder see: each system of it is run by tests of `mbsym run`.
FEW = (
    "satellite.yaml",
    "satellite.txt",
    "double-pendulum.yaml",
    "four-bar.yaml",
    "clebsch-poisson.yaml",
    "ziegler.yaml",
)


def said(line: str) -> tuple[str, ...]:
    """The words of a command, whichever way it spells an option and wherever its systems are."""
    spelled = {"-s": "--set", "-v": "--vary", "-f": "--format", "-o": "--out"}
    return tuple(spelled.get(word, word.removeprefix("systems/")) for word in shlex.split(line, comments=True))


#: What pages of the documentation run, and hold against what stands there.
ON_PAGES = {
    said(line)
    for page in pages()
    for block in shown((DOCS / page).read_text(encoding="utf-8"))
    if block.language == "sh"
    for line in block.text.splitlines()
    if line.startswith("mbsym ")
}


@pytest.mark.parametrize(
    "line",
    [line for line in commands() if said(line) not in ON_PAGES],
    ids=lambda line: line.partition("#")[0][:70].strip(),
)
def test_commands_run(line: str, workplace: Path) -> None:
    if line.split()[1] in ("watch", "lsp", "edit"):
        pytest.skip("never ends; tests of their own have it")
    if "systems" in line.split():
        (workplace / "systems").unlink()
        (workplace / "systems").mkdir()
        for name in FEW:
            (workplace / "systems" / name).symlink_to(ROOT / "systems" / name)
    done = shell(line, workplace)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() or "--out" in line


def test_every_command_and_make_target_is_documented() -> None:
    from mbsym_cli.main import COMMANDS

    missing = [name for name in COMMANDS if not any(line.split()[1] == name for line in commands())]
    assert not missing
    targets = re.findall(r"^make ([\w-]+)", "\n".join(blocks("sh")), re.MULTILINE)
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert {"demo", "test", "test-all"} <= set(targets)
    assert all(re.search(rf"^{target}:", makefile, re.MULTILINE) for target in targets)


def test_description_loads_and_holds() -> None:
    (text,) = blocks("yaml")
    analysis = mbsym.loads(text)
    assert analysis.equilibrium.satisfied
    assert analysis.system.coordinates == ("r", "theta")


def test_complaint_is_printed_like_that(workplace: Path) -> None:
    (text,) = blocks("yaml")
    (workplace / "pendulum.yaml").write_text(text.replace("angles: [theta]", "angles: [thetta]"), encoding="utf-8")
    done = shell("mbsym check pendulum.yaml", workplace)
    assert done.returncode == 2
    assert done.stderr == next(block for block in blocks("text") if "error[" in block)


def test_python_blocks(workplace: Path) -> None:
    """The first block's comments are what it prints; the second runs on the generated module."""
    first, second = blocks("python")
    done = subprocess.run([sys.executable, "-c", first], cwd=workplace, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == re.findall(r"# (.*)", first)
    assert shell("mbsym run systems/satellite.yaml --format python --out here", workplace).returncode == 0
    folder = workplace / "here"
    done = subprocess.run([sys.executable, "-c", second], cwd=folder, capture_output=True, text=True, check=True)
    assert len(done.stdout.replace("[", " ").replace("]", " ").split()) == 10


def test_summary_is_printed_like_that(workplace: Path) -> None:
    """Every line of the README's summary, seconds aside."""
    done = shell("mbsym run systems/satellite.yaml --out here", workplace)
    seconds = re.compile(r"[0-9.]+ s$")
    printed = {seconds.sub("", line).strip() for line in done.stdout.splitlines()}
    shown = next(block for block in blocks("text") if "self-check" in block)
    for line in shown.splitlines():
        assert line.strip() == "..." or seconds.sub("", line).strip() in printed


def test_shipped_systems_are_listed() -> None:
    listed = set(re.findall(r"`([\w-]+\.(?:yaml|txt))`", README))
    shipped = {path.name for path in (ROOT / "systems").iterdir() if path.suffix in {".yaml", ".txt"}}
    assert shipped <= listed
