"""Reports in other languages: every sentence of the templates has its translation, and pdflatex sets it."""

from __future__ import annotations

import ast
import re
import subprocess
from pathlib import Path

import mbsym_templates
import pytest
from click.testing import CliRunner

import mbsym
from mbsym.problems.stability import theorems
from mbsym.problems.stability.word import Word
from mbsym.report import latex_description
from mbsym.report.language import LANGUAGES, Language
from mbsym.report.rendering import rendered
from mbsym.report.targets import TARGETS
from mbsym_cli.main import main
from tests.conftest import SHIPPED, needs_pdflatex
from tests.report.test_latex_documents import CLASSES, PREAMBLE, complaints

OTHERS = [name for name in LANGUAGES if name != "en"]
BABEL = {"ru": "babel-russian/russianb.ldf", "es": "babel-spanish/spanish.ldf"}


def sentences() -> set[str]:
    """What the templates and the words of loads hand over to be translated, if it stands there as a whole."""
    folder = Path(mbsym_templates.__path__[0])
    found = set()
    for path in [*(folder / "latex").glob("*.j2"), *folder.glob("*.tex.j2")]:
        for match in re.finditer(r'\btr\(("(?:[^"\\]|\\.)*")[,)]', path.read_text()):
            found.add(ast.literal_eval(match[1]))
    for node in ast.walk(ast.parse(Path(latex_description.__file__).read_text())):
        if isinstance(node, ast.Call) and ast.unparse(node.func) in ("tr", "self.tr"):
            found |= {x.value for x in node.args if isinstance(x, ast.Constant)}
    return found


@pytest.mark.parametrize("name", OTHERS)
def test_every_sentence_is_there_with_its_gaps(name: str) -> None:
    language = Language(name)
    asked = sentences()
    assert len(asked) > 90
    for english in asked:
        other = language.sentence(english)
        assert other != english, english
        assert sorted(re.findall(r"\[\[\w+\]\]", other)) == sorted(re.findall(r"\[\[\w+\]\]", english))
        assert other.count("{") == other.count("}")
        assert other.count("$") % 2 == 0
    names = [value for key, value in vars(theorems).items() if key.isupper() and isinstance(value, str)]
    assert len(names) > 5
    for word in (*Word, *names):
        assert language.say(word) != word, word
    assert len({language.say(word) for word in Word}) == len(Word), "two verdicts are two"


@needs_pdflatex
@pytest.mark.parametrize("name", OTHERS)
def test_it_compiles(name: str, tmp_path: Path) -> None:
    if subprocess.run(["kpsewhich", Path(BABEL[name]).name], capture_output=True).returncode:
        pytest.skip(f"no babel for {name}")
    analysis = mbsym.load(SHIPPED / "satellite-with-damper.yaml")
    analysis.language = name
    files = {file.filename: file.text for file in rendered(TARGETS["latex"], analysis, analysis.problems)}
    (tmp_path / "main.tex").write_text(files["report.tex"])
    assert complaints(tmp_path) == []
    (tmp_path / "appendix.tex").write_text(files["appendix.tex"])
    preamble = PREAMBLE.replace("[T1]", "[T1,T2A]") if name == "ru" else PREAMBLE
    (tmp_path / "main.tex").write_text(
        f"{CLASSES['two columns']}\n{preamble}\\begin{{document}}\\input{{appendix}}\\end{{document}}\n"
    )
    assert complaints(tmp_path, 2) == []


def test_the_option_goes_before_the_description(tmp_path: Path) -> None:
    path = tmp_path / "pendulum.yaml"
    path.write_text((SHIPPED / "simple-pendulum.yaml").read_text() + "\nlanguage: es\n")
    for option, word in (
        ((), "Cinemática"),
        (("--language", "ru"), "Кинематика"),
        (("--language", "en"), "Kinematics"),
    ):
        words = ["run", str(path), "--format", "latex", "--problems", "1", "--out", str(tmp_path / "out"), *option]
        assert CliRunner().invoke(main, words).exit_code == 0
        assert word in (tmp_path / "out" / "report.tex").read_text()
        assert word in (tmp_path / "out" / "appendix.tex").read_text()
    done = CliRunner().invoke(main, ["run", str(path), "--language", "de", "--out", str(tmp_path / "no")])
    assert done.exit_code == 2
    assert "en, ru" in done.output
