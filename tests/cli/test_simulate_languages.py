"""What ``simulate`` tells in Spanish, and in which order; test_nothing_stays_english.py has the other scenes."""

from __future__ import annotations

import re
from pathlib import Path

from conftest import SHIPPED, filed, invoked

PENDULUM = "double-pendulum"


def told(name: str, options: str, language: str, folder: Path, command: str = "simulate") -> list[str]:
    """Lines on both streams, without the names of files and commands to be pasted."""
    text = (SHIPPED / f"{name}.yaml").read_text(encoding="utf-8")
    text = re.sub(r"^name:", f"language: {language}\nname:", text, count=1, flags=re.M)
    file = filed(folder / "scene.yaml", text)
    words = [x.strip('"') for x in re.findall(r'"[^"]*"|\S+', options)]
    kind = "csv" if command == "simulate" else "json"
    done = invoked(command, file, *words, "--format", kind, "--out", folder / "out")
    assert done.exit_code in (0, 3), done.output
    lines = [*done.stdout.splitlines(), *done.stderr.splitlines()]
    return [x.replace(str(folder), "") for x in lines if not x.startswith("mbsym simulate ")]


def test_a_run_in_spanish_says_no_english_sentence(tmp_path: Path) -> None:
    lines = " ".join(told(PENDULUM, "--time 5 -v", "es", tmp_path))
    for part in ("energía", "se conserva (demostrado)", "deriva máxima", "compilado", "explícito", "pasos: "):
        assert part in lines
    assert not re.search(r"\b(the|of|with|and|steps|proved)\b", lines)


def test_what_was_integrated_stands_before_how(tmp_path: Path) -> None:
    """Its error and what it keeps; with -v the method, its setting and work behind them."""
    short, long = (told(PENDULUM, f"--time 5 {more}", "en", tmp_path) for more in ("", "-v"))
    titles = [[line.split()[0] for line in lines] for lines in (short, long)]
    assert titles[0] == ["Double", "time", "error", "energy", "files"]
    assert titles[1] == ["Double", "time", "error", "energy", "method", "setting", "work", "files"]
