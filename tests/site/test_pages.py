"""The documentation says only what is true: every block of every page is executed, and prints what stands there.

Of a page, in a folder of its own and in order: a block with a title is that file (``... (continued)`` and ``~/...``:
added to it); ``sh`` is run by a shell, line by line; ``python`` by Python; ``text`` after either is what it printed, on
both streams.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest
import warm
from pages import COMMANDS, DOCS, Block, blocks, differs, pages

CONTINUED = " (continued)"
#: Lines that a test cannot run, and why.
NOT_RUN = {
    "mbsym watch": "never ends; test_first_hour.py has it",
    "pip install": "the network",
    "mbsym batch systems --out build --cluster tcp": "a scheduler; test_cluster.py starts one",
    "sbatch": "a cluster; test_ci_recipes.py runs the script",
    "docker ": "Docker; test_ci_recipes.py reads the file",
    "mbsym lsp": "waits for an editor",
    "make ": "of the clone",
    "git ": "the network",
}
#: What lines need beside mbsym, to be found on the path or among the packages; without it they are passed over.
NEEDED = {"pdflatex": "pdflatex", "gcc": "gcc", "octave-cli": "octave-cli", "python with_casadi.py": "casadi"}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A reader's folder, and mbsym on the path."""
    commands = tmp_path / "bin"
    commands.mkdir()
    warm.script(commands)
    (commands / "python").write_text(f'#!/bin/sh\nexec "{sys.executable}" "$@"\n')
    (commands / "python").chmod(0o755)
    (tmp_path / "here").mkdir()
    return tmp_path / "here"


def run(words: list[str], folder: Path) -> tuple[str, int]:
    path = f"{folder.parent / 'bin'}{os.pathsep}{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path, "COLUMNS": "120", "MPLBACKEND": "agg"}
    if (folder / ".bashrc").exists():
        environment["HOME"] = str(folder)
    done = subprocess.run(
        words, cwd=folder, env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=120
    )
    return done.stdout, done.returncode


def shell(block: Block, folder: Path) -> tuple[str, int]:
    """What the lines of a block print, up to one that fails, and its code; none is run that a test cannot run."""
    lines = [line for line in block.text.splitlines() if not line.startswith(tuple(NOT_RUN))]
    for start, tool in NEEDED.items():
        if shutil.which(tool) is None and find_spec(tool) is None:
            lines = [line for line in lines if not line.startswith(start)]
    return run(["bash", "-ec", "\n".join(lines)], folder)


@pytest.mark.skipif(os.name != "posix", reason="a shell")
@pytest.mark.parametrize("page", [page for page in pages() if page != COMMANDS])
def test_every_block_of_a_page_is_true(page: str, folder: Path) -> None:
    printed: str | None = None
    code = 0
    for block in blocks((DOCS / page).read_text(encoding="utf-8")):
        place = f"docs/{page}:{block.line}"
        if block.language == "text":
            assert printed is not None, f"{place}: printed by nothing"
            line = differs(block.text, printed)
            assert not line, f"{place}: not printed: {line}\n\n{printed}"
            # A complaint is shown on purpose; what fails without a word of it is not.
            assert code == 0 or "error[" in block.text or ": B - A" in block.text, (
                f"{place}: exit code {code}\n{printed}"
            )
            printed, code = None, 0
            continue
        assert code == 0, f"{place}: before it, exit code {code}\n{printed}"
        printed = None
        if block.title:
            name = block.title.removesuffix(CONTINUED).removeprefix("~/")
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            with (folder / name).open("a" if block.title != name else "w", encoding="utf-8") as file:
                file.write(block.text)
        elif block.language == "sh":
            printed, code = shell(block, folder)
        elif block.language == "python":
            printed, code = run([sys.executable, "-c", block.text], folder)
        else:
            pytest.fail(f"{place}: {block.language or 'a block'} without a title")
    assert code == 0, f"docs/{page}: the last block ends with {code}\n{printed}"


def test_what_is_not_printed_is_found() -> None:
    """The comparison itself: planted slips."""
    printed = "a\nb 1.20 s\nc\n"
    assert differs("a\nb 0.70 s\nc\n", printed) == ""
    assert differs("a\n...\nc\n", printed) == ""
    assert differs("a\nb ...\nc\n", printed) == ""
    assert differs("a\nx ...\nc\n", printed) == "x ..."
    assert differs("...\nb 3 s\n...\n", printed) == ""
    assert differs("a\nc\n", printed) == "c"
    assert differs("...\nc\nb 1.2 s\n", printed) == "b 1.2 s"
    assert differs("a\nx\n...\n", printed) == "x"
    assert differs("a\n", printed) != ""


def test_blocks_are_found_where_they_stand() -> None:
    text = 'x\n\n```yaml title="a.yaml"\nb: 1\n```\n\n1. y\n\n    ```sh\n    mbsym\n    ```\n'
    first, second = blocks(text)
    assert (first.language, first.title, first.text, first.line) == ("yaml", "a.yaml", "b: 1\n", 3)
    assert (second.language, second.text) == ("sh", "mbsym\n")
