"""Reports in other languages: every sentence of the templates has its translation, and pdflatex sets it."""

from __future__ import annotations

import ast
import re
import subprocess
from collections.abc import Iterator
from enum import Enum
from itertools import product
from pathlib import Path

import mbsym_templates
import pytest
from conftest import filed, invoked
from markupsafe import Markup

import mbsym
from mbsym.expressions.message import Message, Said
from mbsym.model.system import LANGUAGES
from mbsym.problems.stability.words import Word
from mbsym.report.html.writer import Writer
from mbsym.report.language import Language
from mbsym.report.latex.writer import escaped
from mbsym.report.messages import messages
from mbsym.report.targets import TARGETS
from mbsym.report.whole_run import rendered
from tests.conftest import SHIPPED, needs_pdflatex
from tests.report.said import has_words
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
    path = filed(tmp_path / "pendulum.yaml", (SHIPPED / "simple-pendulum.yaml").read_text() + "\nlanguage: es\n")
    for option, word in (
        ((), "Cinemática"),
        (("--language", "ru"), "Кинематика"),
        (("--language", "en"), "Kinematics"),
    ):
        words = ["run", str(path), "--format", "latex", "--problems", "1", "--out", str(tmp_path / "out"), *option]
        assert invoked(*words).exit_code == 0
        assert word in (tmp_path / "out" / "report.tex").read_text()
        assert word in (tmp_path / "out" / "appendix.tex").read_text()
    done = invoked("run", path, "--language", "de", "--out", tmp_path / "no", code=2)
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
    both = escaped(", ".join(map(Language(name).say, theorems)))
    assert both != "Lagrange-Dirichlet, Routh"
    assert f"({both})" in " ".join(TARGETS["latex"].render(analysis, (6,)).split())


# --- whatever is refused ----------------------------------------------------------------------------------------------

#: Descriptions that refuse, each in its way, and what their claims come to.
REFUSING = (
    *("contact_energy", "kap_up_stable", "foucault2", "gov_A", "staude2", "racket-no-result-in-this-rotation-order"),
    *("solved-form-refuted", "stick-slip", "claims_foucault", "cartesian-pendulum", "coupling-rod"),
    *("internal-snakeboard-min", "symmetric_cart"),
)


def description(name: str) -> Path:
    """One of those that are shipped or tested."""
    return next(Path(__file__).parents[2].glob(f"*/**/{name}.yaml"))


def english_in(value: str | Said, known: set[str], names: set[str]) -> Iterator[str]:
    """What of a message stays English: texts without translation, and words in gaps that are no messages."""
    if isinstance(value, Said):
        if _has_words(value.text) and value.text not in known:
            yield value.text
        for gap in value.gaps.values():
            if isinstance(gap, Said | Enum):
                yield from english_in(gap, known, names)
            elif isinstance(gap, str) and re.search(r"[a-z]{3,} [a-z]{3,}", gap):
                yield from () if gap.split(" (")[-1].rstrip(")") in names else (gap,)
    elif has_words(value) and value not in known:
        yield value


@pytest.mark.parametrize("name", REFUSING)
def test_whatever_is_refused_is_said_in_the_language(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """All twelve problems in Russian and Spanish: what a report says, reasons and refusals above all."""
    asked: dict[str, list[str | Said]] = {}
    say, sentence = Language.say, Writer.said

    def heard(self: Language, english: str, context: str = "") -> str:
        asked.setdefault(self.name, []).append(english)
        return say(self, english, context)

    def written(self: Writer, value: Said) -> Markup:
        asked.setdefault(self.language.name, []).append(value)
        return sentence(self, value)

    monkeypatch.setattr(Language, "say", heard)
    monkeypatch.setattr(Writer, "said", written)
    analysis = mbsym.load(description(name))
    names = {body.name for body in analysis.system.bodies}
    for language in OTHERS:
        analysis.language = language
        TARGETS["html"].render(analysis, tuple(range(1, 13)))
        known = {english for _, english in messages(language)} | {"det K"}
        assert len(asked[language]) > 10
        assert not [x for value in asked[language] for x in english_in(value, known, names)]
        lost = next(one for one in asked[language] if isinstance(one, Message) and has_words(one.text))
        assert [*english_in(lost, known - {lost.text}, names)], "a translation that lacks is found"
