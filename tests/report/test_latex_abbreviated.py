"""Long radicands and denominators under letters: nothing of constrained systems stands out into the margin."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest
from conftest import SHIPPED

import mbsym
from mbsym.report.latex.report import abbreviated, render
from tests.report.readers import read_latex

LONG = " + ".join(f"x_{{{k}}} \\sin y_{{{k}}}" for k in range(20))


def test_a_long_part_is_told_once_before_it_is_used() -> None:
    text = f"\\longformula[a]{{p = \\sqrt{{{LONG}}} + 1}}\nWords.\n\\longformula{{q = \\frac{{2}}{{{LONG}}}}}\n"
    found = abbreviated(text)
    assert found.startswith("\\longformula{\\Delta_{1} = x_{0} \\sin y_{0}\\penalty60  + x_{1}")
    assert found.count("\\Delta_{1} =") == 1
    assert "\\longformula[a]{p = \\sqrt{\\Delta_{1}}\\penalty5000  + 1}" in found
    assert "\\longformula{q = \\frac{2}{\\Delta_{1}}}" in found
    # Put back what the letter stands for, and take the places for breaking away: the text is what it was.
    told = re.search(r"\\longformula\{\\Delta_\{1\} = (.*)\}\n", found)
    assert told is not None
    assert re.sub(r"\\penalty\d+ ?", "", found.replace(told[0], "").replace("\\Delta_{1}", told[1])) == text


def test_inner_parts_come_first_short_ones_stay_and_letters_are_free() -> None:
    nested = abbreviated(f"\\longformula{{p = \\sqrt{{1 + \\frac{{a}}{{{LONG}}} + {LONG}}}}}")
    assert nested.index("\\Delta_{1} = x") < nested.index("\\Delta_{2} = 1") < nested.index("p = \\sqrt{\\Delta_{2}}")
    for same in ("\\longformula{\\frac{a}{b + c} + \\sqrt{2}}", "no formula \\sqrt{" + LONG + "}"):
        assert abbreviated(same) == same
    assert "\\Xi_{1} =" in abbreviated(f"\\longformula{{\\Delta = \\sqrt{{{LONG}}}}}")


@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="no pdflatex")
def test_nothing_of_the_bicycle_stands_out_into_the_margin(tmp_path: Path) -> None:
    """There were 79 lines too wide, by up to 1381 pt."""
    text = render(mbsym.load(SHIPPED / "bicycle.yaml", (3,)), (3,))
    read_latex("report.tex", text)
    (tmp_path / "report.tex").write_text(text, encoding="utf-8")
    subprocess.run(["pdflatex", "-interaction=batchmode", "report.tex"], cwd=tmp_path, check=True, capture_output=True)
    log = (tmp_path / "report.log").read_text(encoding="utf-8", errors="replace")
    assert re.findall(r"Overfull .*", log) == []
