"""Every numbered problem is shown everywhere: a new one needs its own files and nothing else."""

from __future__ import annotations

from importlib.resources import files

import pytest

from mbsym.analysis import PROBLEMS, Problem
from mbsym.report.sections import section_of


@pytest.mark.parametrize("problem", PROBLEMS.values(), ids=lambda problem: problem.attribute)
def test_every_problem_has_its_section_lines_and_partials(problem: Problem) -> None:  # type: ignore[type-arg]
    section = section_of(problem)
    assert callable(section.data)
    assert callable(section.lines)
    templates = files("mbsym_templates")
    assert f"Problem {problem.number}" in (templates / "latex" / f"{problem.attribute}.j2").read_text(encoding="utf-8")
    assert f"{problem.number} in found" in (templates / "wolfram" / f"{problem.attribute}.j2").read_text(
        encoding="utf-8"
    )
