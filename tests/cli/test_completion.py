"""Completion as bash has it: the line of the documentation is evaluated, and bash asked what Tab would offer."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest
import warm

pytestmark = pytest.mark.skipif(os.name != "posix" or shutil.which("bash") is None, reason="no bash")

ASK = """
eval "$(_MBSYM_COMPLETE=bash_source mbsym)"
COMP_WORDS=({words})
COMP_CWORD={last}
$(complete -p mbsym | sed 's/.*-F \\([^ ]*\\).*/\\1/') mbsym "" ""
printf '%s\\n' "${{COMPREPLY[@]}}"
"""


def offered(line: str, folder: Path) -> list[str]:
    """What bash offers at the end of a line."""
    commands = folder / "bin"
    if not commands.exists():
        commands.mkdir()
        warm.script(commands)
    words = line.split(" ")
    script = ASK.format(words=" ".join(f"'{word}'" for word in words), last=len(words) - 1)
    path = f"{commands}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        ["bash", "-c", script], env={**os.environ, "PATH": path}, capture_output=True, text=True, timeout=60, cwd=folder
    )
    return done.stdout.split()


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("mbsym si", ["simulate"]),
        ("mbsym simulate --anim", ["--animate"]),
        ("mbsym examples heavy", ["heavy-gyrostat", "heavy-top"]),
        ("mbsym new crane --like dumb", ["dumbbell"]),
        ("mbsym explain lo", ["loads"]),
        ("mbsym schema sum", ["summary"]),
        ("mbsym schema nonsense", []),
    ],
)
def test_bash_offers(line: str, expected: list[str], tmp_path: Path) -> None:
    assert offered(line, tmp_path) == expected
