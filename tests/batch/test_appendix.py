"""One appendix of a folder: every system that could be derived, in a document of somebody's."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

from conftest import invoked

from mbsym.report.latex.labels import labels
from tests.conftest import SHIPPED, needs_pdflatex
from tests.report.test_latex_documents import CLASSES, PREAMBLE, complaints

NAMES = ("simple-pendulum.yaml", "double-pendulum.yaml", "dumbbell.yaml")


def folder_with(tmp_path: Path) -> Path:
    folder = tmp_path / "folder"
    (folder / "inner").mkdir(parents=True)
    for name in NAMES:
        (folder / name).write_text((SHIPPED / name).read_text())
    (folder / "inner" / "again.yaml").write_text((SHIPPED / NAMES[0]).read_text())  # of the same name
    (folder / "wrong.yaml").write_text("mbsym: 1\nname: wrong\nbodies: []\n")
    return folder


@needs_pdflatex
def test_a_folder_is_joined(tmp_path: Path) -> None:
    out = tmp_path / "build"
    words = ["batch", str(folder_with(tmp_path)), "--out", str(out), "--format", "latex", "--appendix", "--quiet"]
    first = invoked(*words)
    assert first.exit_code == 2, first.output  # one description is wrong
    text = (out / "appendix.tex").read_text()
    assert len(re.findall(r"^\\section\{", text, re.MULTILINE)) == 4
    assert re.findall(r"^% Left out.*$", text, re.MULTILINE)[0].endswith("wrong.yaml")
    assert max(Counter(labels(text)).values()) == 1
    assert len({label.split(":")[1] for label in labels(text)}) == 4
    (tmp_path / "appendix.tex").write_text(text)
    body = "\\begin{document}\\appendix\\input{appendix}\\end{document}\n"
    (tmp_path / "main.tex").write_text(f"{CLASSES['two columns']}\n{PREAMBLE}{body}")
    assert complaints(tmp_path, 2) == []
    invoked(*words)  # nothing is derived again
    assert (out / "appendix.tex").read_text() == text


def test_it_needs_latex(tmp_path: Path) -> None:
    done = invoked("batch", tmp_path, "--format", "json", "--appendix", code=2)
    assert "add latex to --format" in done.output
