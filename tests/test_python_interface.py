"""What somebody meets in Python: short lines, LaTeX in notebooks, arrays, types, a quick import."""

from __future__ import annotations

import html.parser
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import SHIPPED, compiled_latex, derived, needs_pdflatex

import mbsym
from mbsym.analysis import PROBLEMS

SCRIPT = """
from fractions import Fraction

import mbsym
from mbsym.formulas.formula import Formula, Matrix

analysis = mbsym.load("{file}")
energy: Formula = analysis.energy.kinetic_energy - analysis.energy.force_function
half: Formula = energy.subs({{"m": Fraction(1, 2)}}, l="2") / 2 + 1
mass: Matrix = analysis.equations.mass_matrix
word: str = analysis.stability.verdict.word
found = mbsym.equilibria(analysis)
verdicts: list[str] = list(found.table["verdict"])
complete: bool = found.complete
run = mbsym.simulate(analysis, 1, samples=11)
advice: str = mbsym.tradeoff(analysis, 1).advice
left: tuple[str, ...] = mbsym.extremes(analysis).left_out
"""


def mypy(text: str, folder: Path) -> subprocess.CompletedProcess[str]:
    (folder / "script.py").write_text(text, encoding="utf-8")
    settings = "[mypy]\nstrict = true\nfollow_imports = silent\n[mypy-flint.*,sympy.*]\nignore_missing_imports = true\n"
    (folder / "mypy.ini").write_text(settings)
    command = [sys.executable, "-m", "mypy", "--config-file", "mypy.ini", "script.py"]
    environment = os.environ | {"MYPYPATH": str(Path(mbsym.__file__).parents[1])}
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)


def test_a_script_passes_mypy_strict_and_a_misspelt_one_does_not(tmp_path: Path) -> None:
    script = SCRIPT.format(file=SHIPPED / "simple-pendulum.yaml")
    done = mypy(script + "\nwrong = analysis.equations.mass_matirx\nnumber: int = energy + 1\n", tmp_path)
    assert done.returncode == 1
    assert 'has no attribute "mass_matirx"' in done.stdout
    assert done.stdout.count("error:") == 2, done.stdout


def test_importing_is_light() -> None:
    program = "import sys, mbsym; print(*[m for m in sys.modules if m.startswith(('numpy', 'flint', 'mbsym.'))])"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


@pytest.fixture(scope="module")
def satellite() -> mbsym.analysis.Analysis:  # type: ignore[name-defined]
    return derived(SHIPPED / "satellite.yaml")


def test_everything_shows_itself_in_a_line(satellite) -> None:  # type: ignore[no-untyped-def]
    shown = [satellite, satellite.system, satellite.stability.verdict, satellite.energy.A2]
    stages = [satellite.stage(number) for number in PROBLEMS if number != 7]
    shown += [stage.value for stage in stages if stage.failure is None]
    shown += [*satellite.integrals, satellite.linearisation.subsystems[0], satellite.stability.subsystems[0]]
    for item in shown:
        assert len(repr(item)) < 600, repr(item)
        assert type(item).__name__ in repr(item)
        assert "\n" not in repr(item)
        assert " object at 0x" not in repr(item)
    assert repr(satellite.stability.verdict) == "Verdict('depends on the parameters')"


@needs_pdflatex
def test_what_notebooks_show_is_latex_that_compiles(satellite, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    nasty = mbsym.loads(
        "mbsym: 1\nname: '#1 & 50% {x}_$'\nparameters: {m: positive}\n"
        "bodies:\n  - {name: 'a_b', attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}\n"
    )
    shown = [nasty.kinematics, nasty.kinematics.bodies[0], nasty.energy]
    stages = [satellite.stage(number) for number in PROBLEMS if number != 7]
    shown += [stage.value for stage in stages if stage.failure is None]
    shown += [satellite.integrals[0], satellite.stability.subsystems[0], satellite.energy.A2[0, 0]]
    body = "\n\n".join("{\\tiny " + item._repr_latex_() + "}" for item in shown)
    text = "\\documentclass{article}\\usepackage{amsmath}\\begin{document}\n" + body + "\n\\end{document}\n"
    said = compiled_latex(text, tmp_path)
    assert "Undefined control sequence" not in said


class Balanced(html.parser.HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attrs: object) -> None:
        self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_studies_are_tables_of_arrays() -> None:
    file = SHIPPED / "simple-pendulum.yaml"
    found = mbsym.equilibria(SHIPPED / "cart-pendulum.yaml")
    assert len(found.table) == 4
    assert np.isnan(found.table["x"]).all(), "the position of the cart is arbitrary"
    assert found.complete
    study = mbsym.tradeoff(file, 1, budget=0.5, methods=["rk4", "dop853"], models=False)
    assert set(study.runs["method"]) <= {"rk4", "dop853", "RK4", "DOP853"}
    assert study.runs["error"].dtype == float
    assert (study.runs["error"][np.isfinite(study.runs["error"])] >= 0).all()
    assert study.advice
    with pytest.raises(KeyError, match="did you mean 'error'"):
        study.runs["eror"]
    with pytest.raises(ValueError, match="did you mean 'dop853'"):
        mbsym.tradeoff(file, 1, methods=["dop85"])
    with pytest.raises(ValueError, match="unknown parameter 'mm'"):
        mbsym.equilibria(file, values={"mm": 1})
    for item in (found, study, found.table, study.runs, mbsym.load(file), mbsym.load(file).stability.verdict):
        parser = Balanced()
        parser.feed(item._repr_html_())
        assert parser.open == []
        assert len(repr(item)) < 400


def test_a_notebook_shows_what_was_found() -> None:
    """The drawing, the equation, the verdict at the given values and the condition, with a style of their own."""
    told = mbsym.load(SHIPPED / "bead-on-hoop.yaml")._repr_html_()
    for part in ("Bead on a rotating hoop", "<svg", "<style>.mbsym", 'class="bad"', "Kelvin-Chetaev", "all 2 hold"):
        assert part in told
    assert "<script" not in told
    nothing = mbsym.load(SHIPPED / "bead-on-hoop.yaml", ())._repr_html_()
    assert "Kelvin" not in nothing, "what is not asked for is not derived"
