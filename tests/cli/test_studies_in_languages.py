"""What studies print is in the language of the description, and fits its width: in Spanish."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from conftest import SHIPPED, filed, invoked

from mbsym.report.messages import messages

STUDIES = [
    ("lyapunov", "double-pendulum", "--time 40 --count 1"),
    ("orbit", "double-pendulum", "--period 2.6 --set theta1=0.3 --set theta2=0.12"),
    ("floquet", "shaken-pendulum", "--set nu=40"),
    ("inverse", "cart-pole", "--motion p=t**2/2 --motion theta=0 --time 1"),
    ("sweep", "ziegler", "--vary P=uniform(0,4) --vary k=uniform(1,2) --points 50 --format csv"),
    ("equilibria", "gravity-gradient", ""),
    ("equilibria", "bead-on-hoop", "--vary Omega=1:12 --format json"),
    ("map", "triangular-points", "--x mu=0:1/2 --format json"),
    ("groups", "double-pendulum", ""),
    ("extremes", "heavy-top", "--sequences"),
    ("simulate", "double-pendulum", "--time 1 --vary theta1=uniform(0,1) --members 5 --format csv"),
]


def said(command: str, name: str, options: str, language: str, folder: Path) -> str:
    text = (SHIPPED / f"{name}.yaml").read_text(encoding="utf-8")
    path = filed(folder / "d.yaml", re.sub(r"^name:", f"language: {language}\nname:", text, count=1, flags=re.M))
    out = ["--out", str(folder / "out")] if command != "groups" and name != "gravity-gradient" else []
    asked = [command, str(path), *options.split(), *out]
    done = invoked(*asked, env={"COLUMNS": "80"})
    assert done.exit_code in (0, 3), done.output
    assert [line for line in done.stdout.splitlines()[1:] if len(line) > 80 and str(folder) not in line] == []
    return "\n".join(done.stdout.splitlines()[1:]).replace(str(folder), "")


@pytest.mark.parametrize(("command", "name", "options"), STUDIES)
def test_spanish_is_spoken(command: str, name: str, options: str, tmp_path: Path) -> None:
    told = said(command, name, options, "es", tmp_path)
    whole = {text: other for (_, text), other in messages("es").items() if len(text) > 12 and "[[" not in text}
    english = {text for text, other in whole.items() if text not in other}
    assert not [text for text in english if text in told]
    assert "archivos en" in told or command not in ("lyapunov", "orbit")


def test_a_refusal_is_in_the_language(tmp_path: Path) -> None:
    """No periodic motion near a guess: the reason, and what stands before it."""
    text = (SHIPPED / "double-pendulum.yaml").read_text(encoding="utf-8")
    path = filed(tmp_path / "d.yaml", re.sub(r"^name:", "language: ru\nname:", text, count=1, flags=re.M))
    done = invoked("orbit", path, "--period", "2.6", "--set", "theta1=3", code=1)
    assert "периодическое движение не найдено: нет сходимости; " in done.stderr
    assert re.search(r"\d шаг", done.stderr)
