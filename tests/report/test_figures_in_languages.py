"""Every word of every figure is said in the description's language."""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from conftest import filed, invoked
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text

from mbsym.numerics.methods.table import METHODS
from mbsym.report.figures import drawing
from mbsym.report.figures.drawing import equalities, saved
from mbsym.report.figures.figures import Curve, _page_of

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


def drawn_by(command: str, description: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Every text in the figures of a command."""
    drawn: list[str] = []

    class Watched(FigureCanvasAgg):
        def draw(self) -> None:
            super().draw()
            drawn.extend(text.get_text() for text in self.figure.findobj(Text))

    monkeypatch.setattr(drawing, "FigureCanvasAgg", Watched)
    file = filed(tmp_path / "pendulum.yaml", description)
    study, *options = command.split()
    invoked(study, file, *options, "--out", tmp_path / "out", "--quiet", code=0)
    return drawn


@pytest.mark.parametrize("command", COMMANDS)
def test_no_english_word_is_drawn(command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = drawn_by(command, DESCRIPTION, tmp_path, monkeypatch)
    assert any(re.search("[а-я]{4}", text) for text in drawn)
    plain = (NAMES.sub("", re.sub(r"\$[^$]*\$", "", text)) for text in drawn)
    assert [text for text in plain if re.search("[A-Za-z]{3}", text)] == []


def test_what_tells_curves_apart_stands_inside_of_the_picture() -> None:
    """Four values of Omega ran out of a phase plane on both sides, with twelve digits each."""
    told = [equalities({"Omega": 10 / 3 + k, "m1": Fraction(-1, 2)}) for k in range(4)]
    assert told[0] == "$\\Omega$ \u2248 3.333, $m_{1}$ = \u22120.5"
    run: Any = None  # of the motion nothing is drawn here
    assert equalities({f"k{k}": k for k in range(9)}) == ""
    drawn = [Curve(run, None, words) for words in told]
    figure = Figure(figsize=(5.4, 5), layout="constrained")
    axis = figure.subplots()
    for one in drawn:
        axis.plot([0, 1], [0, 1], label=one.label)
    (legend,) = _page_of(drawn, axis, figure).legends
    saved("x", figure, ["png"])
    box = legend.get_window_extent()
    assert 0 <= box.x0 < box.x1 <= figure.bbox.width


@pytest.mark.parametrize("command", ["simulate --time 1 --format png", "sweep --measure damping"])
def test_what_a_relation_gives_is_not_told_to_be_the_same(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """m = l^2 is 1, 1.0002 and 1.0004 where l is 1, 1.0001 and 1.0002: no number stands for all, and four digits do not
    tell curves apart."""
    related = DESCRIPTION.replace("m: {sign: positive, value: 1}", "m: positive") + "relations: {m: l**2}\n"
    drawn = drawn_by(f"{command} --vary l=1:1.0002:3", related, tmp_path, monkeypatch)
    assert any(re.search(r"\$g\$ = 9\.81", text) for text in drawn)
    assert not any(re.search(r"\$m\$ \S \d", text) for text in drawn)
    if command.startswith("simulate"):
        assert {"$l$ = 1", "$l$ = 1.0001", "$l$ = 1.0002"} <= {*drawn}
