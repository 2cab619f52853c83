"""Reports in other languages: every sentence of the templates has its translation, and pdflatex sets it."""

from __future__ import annotations

import ast
import contextlib
import re
import subprocess
from pathlib import Path

import mbsym_templates
import pytest
from click.testing import CliRunner

import mbsym
from mbsym.problems.stability import theorems
from mbsym.problems.stability.reasons import Because, Reason
from mbsym.problems.stability.sentences import sentence
from mbsym.problems.stability.word import Word
from mbsym.report.compact import compact
from mbsym.report.language import LANGUAGES, Language
from mbsym.report.rendering import rendered
from mbsym.report.targets import TARGETS
from mbsym_cli.main import main
from tests.conftest import SHIPPED, needs_pdflatex
from tests.report.test_latex_documents import CLASSES, PREAMBLE, complaints

OTHERS = [name for name in LANGUAGES if name != "en"]
BABEL = {"ru": "babel-russian/russianb.ldf", "es": "babel-spanish/spanish.ldf"}


def sentences() -> set[str]:
    """What templates and builders of content hand over to be translated, if it stands there as a whole."""
    folder = Path(mbsym_templates.__path__[0])
    found = set()
    for path in [*(folder / "latex").glob("*.j2"), *folder.glob("*.tex.j2")]:
        for match in re.finditer(r'\btr\(("(?:[^"\\]|\\.)*")[,)]', path.read_text()):
            found.add(ast.literal_eval(match[1]))
    for path in (Path(mbsym.__file__).parent / "report").rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        for node in ast.walk(ast.parse(text)) if "from mbsym.report.content import" in text else ():
            if isinstance(node, ast.Call) and ast.unparse(node.func) in ("Said", "say") and node.args:
                found |= _literals(node.args[0])
            elif isinstance(node, ast.Assign) and "[[" in ast.unparse(node.value):
                found |= _literals(node.value)
    return found


def _literals(node: ast.expr) -> set[str]:
    """A string, or one of two."""
    if isinstance(node, ast.IfExp):
        return _literals(node.body) | _literals(node.orelse)
    return {node.value} if isinstance(node, ast.Constant) and isinstance(node.value, str) else set()


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


def explained() -> set[str]:
    """What explains verdicts, one sentence for each code, and what is said of these systems."""
    found = set()
    for code in Because:
        words = [("1", Word.STABLE, Word.UNSTABLE)] if code is Because.DIFFERS_ALONG else [(), (1,), (3,), ("1", "2")]
        for data in words:
            with contextlib.suppress(TypeError, IndexError):
                found.add(sentence(Reason(code, data)))
    for name in ("satellite", "heavy-top", "satellite-with-damper", "spatial-arm", "ziegler-damped"):
        analysis = mbsym.load(SHIPPED / f"{name}.yaml")
        parts = analysis.stability.subsystems if analysis.system.motion else ()
        for part in parts:
            found |= {*part.theory.remarks, *(x.verdict.explanation for x in part.theory.cases)}
            found |= {x.label for x in (*part.theory.requirements, *part.theory.stiffness.requirements)}
        found |= {x.name for x in analysis.integrals}
        for check in analysis.checks:
            found |= {check.name, check.first, check.second, check.outcome, check.detail}
        for told in compact(analysis, {1: analysis.kinematics, 2: analysis.energy, 3: analysis.equations}).values():
            found |= {x.words for x in told.passages}
    return {x for x in found if not re.fullmatch(r"[av]\d+( of factor \d+)?|\w{0,2}", x)}


def test_what_results_say_is_said_in_russian_and_spanish() -> None:
    """No word of the English stays but names and symbols."""
    russian, spanish = Language("ru"), Language("es")
    asked = explained()
    assert len(asked) > 120
    for english in asked:
        said = re.sub(r"\([a-z ]+\)|lambda|det|phi|psi|theta|delta|sigma|alpha|beta|eta", "", russian.say(english))
        assert not re.search(r"[a-z]{3,}", said), (english, said)
        said = spanish.say(english)
        assert said != english or said == "regular"
        assert not re.search(r"\b(the|of|is|are|with|roots?|in|and|body)\b", said), (english, said)


def test_what_has_no_gap_goes_before_what_has_one() -> None:
    russian = Language("ru")
    assert russian.say("A root with positive real part.") == "Есть корень с положительной вещественной частью."
    assert russian.say("2 roots with positive real part. Terms of higher order decide.") == (
        "Корней с положительной вещественной частью: 2. Вопрос решают члены более высокого порядка."
    )
    assert russian.say("Nobody knows this. Terms of higher order decide.").startswith("Nobody knows this. Вопрос")
    assert Language().say("A root with positive real part.") == "A root with positive real part."
    assert Language("es").say("Angular velocity of body 2 (rod) relative to body 1") == (
        "Velocidad angular del cuerpo 2 (rod) respecto al cuerpo 1"
    )


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
