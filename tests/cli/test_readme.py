"""The README and the list of commands are true: commands run and print what stands there, links lead somewhere."""

from __future__ import annotations

import re
import shlex
import subprocess
from pathlib import Path

import pytest
import warm
from pages import COMMANDS, DOCS, ROOT, Block, blocks, differs, pages

README = blocks((ROOT / "README.md").read_text(encoding="utf-8"))
LISTED = blocks((DOCS / COMMANDS).read_text(encoding="utf-8"))


def commands(of: list[Block]) -> list[str]:
    return [line for one in of if one.language == "sh" for line in one.text.splitlines() if line.startswith("mbsym ")]


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
    spelled = {"-s": "--set", "-f": "--format", "-o": "--out"}
    return tuple(spelled.get(word, word.removeprefix("systems/")) for word in shlex.split(line, comments=True))


#: What other pages of the documentation run, and hold against what stands there.
ON_PAGES = {
    said(line)
    for page in pages()
    if page != COMMANDS
    for line in commands(blocks((DOCS / page).read_text(encoding="utf-8")))
}


@pytest.mark.parametrize(
    "line",
    [line for line in commands(LISTED) if said(line) not in ON_PAGES],
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


def test_every_command_is_documented() -> None:
    from mbsym_cli.main import COMMANDS as NAMES

    assert [name for name in NAMES if not any(line.split()[1] == name for line in commands(LISTED))] == []


def test_commands_stand_in_the_groups_of_the_help() -> None:
    from mbsym_cli.main import GROUPS

    text = (DOCS / COMMANDS).read_text(encoding="utf-8").partition("## Examples\n")[2].partition("\n## ")[0]
    parts = [part.partition("\n") for part in text.split("\n### ")[1:]]
    shown = {title: list(dict.fromkeys(line.split()[1] for line in commands(blocks(part)))) for title, _, part in parts}
    assert shown == {title: list(names) for title, names in GROUPS.items()}


def test_what_the_readme_shows_below_a_command_is_printed(workplace: Path) -> None:
    printed = ""
    for block in README:
        if block.language == "text":
            assert differs(block.text, printed) == "", f"README.md:{block.line}\n{printed}"
        elif commands([block]):
            (line,) = commands([block])
            done = shell(line, workplace)
            assert done.returncode == 0, done.stderr
            printed = done.stdout
    assert printed


def test_the_make_targets_of_the_readme_are_there() -> None:
    shown = "\n".join(block.text for block in README if block.language == "sh")
    targets = set(re.findall(r"^make ([\w-]+)", shown, re.MULTILINE))
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert {"demo", "test", "test-all"} <= targets
    inline = set(re.findall(r"`make ([\w-]+)`", (ROOT / "README.md").read_text(encoding="utf-8")))
    assert all(re.search(rf"^{target}:", makefile, re.MULTILINE) for target in targets | inline)


def test_the_readme_is_short_and_its_links_lead_somewhere() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 125
    links = re.findall(r"\]\(([^)#]+)[^)]*\)", text) + re.findall(r'(?:href|src|srcset)="([^"#]+)', text)
    assert len(links) > 40
    assert [link for link in links if not (ROOT / link).exists()] == []


def test_what_the_architecture_names_is_there() -> None:
    """Paths from the root or in mbsym/, names of modules anywhere in it."""
    named = set(re.findall(r"`([\w./-]+)`", (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")))
    known = {path.name for path in (ROOT / "mbsym").rglob("*.py")}
    paths = [name for name in named if "/" in name]
    assert len(paths) > 100
    assert [name for name in paths if not (ROOT / name).exists() and not (ROOT / "mbsym" / name).exists()] == []
    assert {name for name in named if name.endswith(".py") and "/" not in name} <= known


def test_the_description_of_the_reference_holds() -> None:
    """A pendulum on a spring hangs at rest by l0 + m g/k, and its coordinates are found in their order."""
    import mbsym

    page = blocks((DOCS / "reference" / "description.md").read_text(encoding="utf-8"))
    (text,) = (block.text for block in page if block.language == "yaml")
    analysis = mbsym.loads(text)
    assert analysis.equilibrium.satisfied
    assert analysis.system.coordinates == ("r", "theta")


def test_shipped_systems_are_listed() -> None:
    listed = set(re.findall(r"`([\w-]+\.(?:yaml|txt))`", (DOCS / "systems.md").read_text(encoding="utf-8")))
    shipped = {path.name for path in (ROOT / "systems").iterdir() if path.suffix in {".yaml", ".txt"}}
    assert shipped <= listed
