"""Every word of every figure is said in the description's language."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from click.testing import CliRunner
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text

from mbsym.numerics.methods.table import METHODS
from mbsym.report.figures import drawing
from mbsym_cli.main import main

DESCRIPTION = """
mbsym: 1
name: Двойной маятник
language: ru
parameters:
  m: {sign: positive, value: 1}
  l: {sign: positive, value: 1}
  g: {sign: positive, value: 9.81}
bodies:
  - {name: первый, attached to: 0, rotation: {axes: [3], angles: [x]}, mass centre: [0, -l, 0], mass: m,
     inertia about: mass centre, inertia: [m*l**2, m*l**2, m*l**2/10]}
  - {name: второй, attached to: первый, connection point: [0, -l, 0], rotation: {axes: [1], angles: [y]},
     mass centre: [0, -l, 0], mass: m}
loads: [{uniform gravity: {vector: [0, -g, 0]}}]
motion: {x: 0, y: 0}
initial: {x: 1, y: 1/2}
"""

#: Names are no words: of methods, of arithmetic, of matrices.
NAMES = re.compile("|".join(sorted(map(re.escape, METHODS), key=len, reverse=True)) + "|float32|float64")

COMMANDS = (
    "simulate --time 2 --format png --no-estimate",
    "simulate --time 2 --format png --vary l=1:2:5",
    "simulate --time 9 --format png --no-estimate --section y=0",
    "simulate --time 2 --format png --vary l=uniform(1,2) --members 20",
    "tradeoff --time 1 --methods rk4,dop853",
    "extremes",
    "sweep --vary l=1:2:9 --vary g=1:2:9 --measure stability",
    "sweep --vary l=1:2:9 --measure damping",
    "map --x l=-1:2 --format png",
    "map --x l=1:2 --y g=-1:1 --format png",
    "equilibria --vary g=1:2 --format png",
)


@pytest.mark.parametrize("command", COMMANDS)
def test_no_english_word_is_drawn(command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[str] = []

    class Watched(FigureCanvasAgg):
        def draw(self) -> None:
            super().draw()
            drawn.extend(text.get_text() for text in self.figure.findobj(Text))

    monkeypatch.setattr(drawing, "FigureCanvasAgg", Watched)
    file = tmp_path / "pendulum.yaml"
    file.write_text(DESCRIPTION, encoding="utf-8")
    study, *options = command.split()
    done = CliRunner().invoke(main, [study, str(file), *options, "--out", str(tmp_path / "out"), "--quiet"])
    assert done.exit_code == 0, done.output
    assert any(re.search("[а-я]{4}", text) for text in drawn)
    plain = (NAMES.sub("", re.sub(r"\$[^$]*\$", "", text)) for text in drawn)
    assert [text for text in plain if re.search("[A-Za-z]{3}", text)] == []
