"""Reports in other languages: every sentence of the templates has its translation, and pdflatex sets it."""

from __future__ import annotations

import ast
import contextlib
import re
import subprocess
from itertools import product
from pathlib import Path

import mbsym_templates
import pytest
from click.testing import CliRunner

import mbsym
from mbsym.problems.claims.remarks import Remark, Said, text
from mbsym.problems.stability import theorems
from mbsym.problems.stability.reasons import Because, Reason
from mbsym.problems.stability.sentences import sentence
from mbsym.problems.stability.word import Word
from mbsym.report.compact import compact
from mbsym.report.language import LANGUAGES, Language
from mbsym.report.messages import messages
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
                found |= {x for x in _literals(node.value) if re.match(r"[A-Z$[].*[.:]$", x)}  # no part of one
    return set(filter(_has_words, found))


def _has_words(text: str) -> bool:
    """Not of formulas alone, which are the same in every language."""
    return re.search(r"[A-Za-z]{2}", re.sub(r"\$[^$]*\$|\[\[\w+\]\]", "", text)) is not None


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


# --- claims, and what has no result -----------------------------------------------------------------------------------

CLAIMED = """
mbsym: 1
name: bead
parameters: {m: positive, g: positive, R: positive, w: positive}
prescribed: {p: {rate: w}}
bodies:
  - {name: hoop, attached to: 0, rotation: {axes: [2], angles: [p]}, mass: 0}
  - name: bead
    attached to: hoop
    rotation: {axes: [3], angles: [a]}
    coordinates: [a]
    mass centre: [0, -R, 0]
    mass: m
loads: [uniform gravity: {vector: [0, -g, 0]}]
MOTION
claims:
  - {claim: condition, that: g > R*w**2}
  - {claim: condition, that: g > 2*R*w**2}
  - {claim: first integral, equals: m*R*a_dot}
  - {claim: first integral, equals: m*R*a}
  - {claim: force function, equals: 2*m*g*R*cos(a)}
"""


def _texts(path: Path) -> set[str]:
    """What a module of claims may say: remarks, and the reasons of what it raises, with {} for names and numbers."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        said: list[ast.expr] = []
        if isinstance(node, ast.Call) and ast.unparse(node.func) in ("NoClosedForm", "NotRational"):
            said = node.args[:1]
        elif (isinstance(node, ast.keyword) and node.arg == "remark") or (
            isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "remark"
        ):
            said = [node.value]
        for one in said:
            if isinstance(one, ast.JoinedStr):
                parts = [x.value if isinstance(x, ast.Constant) else "{}" for x in one.values]
                found.add("".join(map(str, parts)))
            else:
                found |= _literals(one)
    # Of these two the gap is one of few words, and they are listed with it.
    return found - {"", "it is a constant{}, whatever the motion", "{} is not finite"}


@pytest.mark.parametrize("name", OTHERS)
def test_whatever_is_said_of_claims_is_translated(name: str) -> None:
    """Remarks of conditions by their codes, for one condition and for several; others as they stand in the modules."""
    known = {english for _, english in messages(name)}
    sentences = {text(Remark(code, data)) for code in Said for data in DATA if _takes(code, data)}
    assert len(sentences) > len(Said)
    assert sentences <= known, sentences - known
    folder = Path(mbsym.__file__).parent / "problems" / "claims"
    others = set().union(*map(_texts, folder.glob("*.py")))
    assert len(others) > 40
    # What these two raise is caught: another way is tried then.
    caught = set().union(*(_texts(folder / f"{x}.py") for x in ("by_integrals", "counterexample")))
    assert others - caught <= known, others - caught - known


DATA = ((1, "", ""), (2, "", ""), ("x", ""), ("", ""), ("stable", True), ("stable", False))


def _takes(code: Said, data: tuple[object, ...]) -> bool:
    try:
        return bool(text(Remark(code, data)))
    except TypeError:
        return False


@pytest.mark.parametrize("name", OTHERS)
def test_claims_and_reasons_of_missing_results_speak_the_language(name: str) -> None:
    """Of a bead on a turning hoop: a necessary condition, three refuted claims; without a motion three problems lack.

    (g - R w^2 > 0 is v0 of problem 6; m R a' is no integral; m R a contains no velocity; U = m g R cos a.)
    """
    english = [
        "without it",
        "it is the condition",
        "it is not necessary",
        "contains no velocity",
        "differs by the factor",
        "For example at",
        "condition g",
        "first integral",
        "force function",
        "no unperturbed motion",
        "does not hold",
        "the motion is",
    ]
    for motion, target in product(("motion: {a: 0}", ""), ("latex", "html")):
        description = CLAIMED.replace("MOTION", motion)
        plain = mbsym.loads(description)
        whole = " ".join(TARGETS[target].render(plain, plain.problems).split())
        assert sum(x in whole for x in english) >= 7, [x for x in english if x not in whole]
        analysis = mbsym.loads(description + f"language: {name}\n")
        written = " ".join(TARGETS[target].render(analysis, analysis.problems).split())
        assert not [x for x in english if x in written], target
        if not motion:
            reason = Language(name).say("the description gives no unperturbed motion")
            assert written.count(reason) >= 6  # in the summary, and where the results would stand


@pytest.mark.parametrize("name", OTHERS)
def test_two_theorems_are_translated_each(name: str) -> None:
    """Lagrange-Dirichlet of one subsystem, Routh of another: the whole rests on both."""
    analysis = mbsym.load(SHIPPED / "gravity-gradient.yaml")
    assert analysis.stability.numerical is not None
    theorems = analysis.stability.numerical.theorems
    assert theorems == ("Lagrange-Dirichlet", "Routh")
    analysis.language = name
    both = ", ".join(map(Language(name).say, theorems))
    assert both != "Lagrange-Dirichlet, Routh"
    assert f"({both})" in " ".join(TARGETS["latex"].render(analysis, (6,)).split())
