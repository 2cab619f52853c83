"""Whatever a person reads is in the language of the description: in a language of marks, nothing is outside of them.

Every message is ⟦its English⟧, what stands in its gaps outside.  What is left outside has to be a name, a number, a
formula, a file or what is typed.  For programs (JSON, SARIF, CSV, code, schemas), in ``--help`` and ``explain``, and of
what is no description, everything is English.
"""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
from conftest import SHIPPED, invoked
from outputs import documented

from mbsym.expressions.message import Counted, Said, pieces
from mbsym.report.language import Language
from mbsym.source import read, render

#: Letters of ours and functions in formulas, methods and arithmetics, and their like.
NAMES = {"sin", "cos", "sqrt", "exp", "log", "tanh", "det", "sum", "const", "dot", "lambda", "Lambda", "omega", "Gamma",
         "tau", "beta", "Mbar", "fbar", "Omega", "float", "extended", "dop", "rodas", "midpoint", "taylor", "radau",
         "SciPy", "heyoka", "lsoda", "bdf", "phi", "hat", "text", "FILE", "run",
         "Jxx", "Jxy", "Jxz", "Jyy", "Jyz", "Jzz", "rad"}  # fmt: skip
#: Not of words: quoted lines, codes, commands to be pasted, options, files, assignments.
NO_WORDS = r"^ *\d* \|.*|(?:error|warning)\[[a-z-]+\]|mbsym [a-z\[].*|--[a-z-]+|[\w./*-]+\.\w{1,7}\b|\b\w+/[\w./-]*"
#: They print a file, or codes and labels of one, or are about no description.
OF_FILES = ("diff", "convert", "schema", "explain", "examples", "new", "lsp", "edit", "watch")
FOR_PROGRAMS = {"--json", "--output-format", "--help", "-h", "--latex", "--python", "--wolfram", "--version"}

COMMANDS = [
    "check in",
    "check in/bad.yaml",
    "batch in --format json",
    "diff in/good.yaml moved.yaml",
    "diff more in/good.yaml",
    "diff in/good.yaml in/good.yaml",
    "simulate in/good.yaml --time 1 --continue moved.yaml",
    "simulate in/good.yaml",
    "simulate in/good.yaml 5",
    "run in/good.yaml --quite",
    "run in/good.yaml --format",
    "run in/good.yaml --quiet=3",
    "run --language ru",
    "rnu in/good.yaml",
    "convert in/good.yaml --to pdf",
    "convert in/good.yaml --floating",
    "convert in/good.yaml --out in/good.yaml",
    "show in/good.yaml equations conditions characteristic eigenvalues integrals theta",
    "regressor in/good.yaml",
    "lyapunov double-pendulum --time 40 --count 1",
    "orbit double-pendulum --period 2.6 --set theta1=0.3 --set theta2=0.12",
    "orbit double-pendulum --period 2.6 --set theta1=3",
    "floquet shaken-pendulum --set nu=40",
    "inverse cart-pole --motion p=t**2/2 --motion theta=0 --time 1",
    "sweep ziegler --vary P=uniform(0,4) --vary k=uniform(1,2) --points 50 --format csv",
    "equilibria gravity-gradient",
    "equilibria bead-on-hoop --vary Omega=1:12 --format json",
    "map triangular-points --x mu=0:1/2 --format json",
    "groups double-pendulum",
    "nonlinear three-bodies --vary mu=0:1/2",
    "extremes heavy-top --sequences",
    "integrals hess-appelrot --relations",
    "integrals euler-poisson -d 1 -s A=6 -s C=3 -s x0=1 -s y0=0 -s z0=1 -s m=1 -s g=1 --vary B=1:5 --relations",
    "simulate double-pendulum --time 5 -v --format csv",
    "simulate double-pendulum --time 2 --no-estimate -v --method rk4 --step 0.03 --every 0.1 --format csv",
    "simulate satellite --time 5 --accuracy 1e-6 --plan",
    "simulate double-pendulum --time 1 --certify --method rk4 --step 0.01 --format csv",
    "simulate double-pendulum --time 5 --event 'theta1 = 0' --stop 'theta2 > 1' --format csv",
    "simulate double-pendulum --time 1 --vary theta1=uniform(0,1) --members 5 --format csv",
    "simulate four-bar --time 2 -v --format csv",
    "simulate cart-pole --time 2 -v --format csv",
    "simulate double-pendulum --time 50 --step-limit 20",
    "run satellite --ledger --problems 1-3 --format json",
    "run four-bar -v --format json",
]


def marked(text: str) -> str:
    """Notation is left alone; what a gap holds is outside of the marks."""
    parts = (x if inside else re.sub(r"\[\[\w+\]\]", r"⟧\g<0>⟦", x) for inside, x in pieces(text))
    return f"⟦{'$'.join(_with_empty(parts, text))}⟧"


def _with_empty(parts: object, text: str) -> list[str]:
    """The parts between the dollars, with those that ``pieces`` leaves out."""
    found = iter(parts)  # type: ignore[call-overload]
    return [next(found) if part else "" for part in text.split("$")]


@pytest.fixture
def marks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Languages other than English say marks, where they have a translation."""
    plain, of = Language.sentence, Language.text_of

    def sentence(self: Language, english: str, context: str = "") -> str:
        translated = self.name == "en" or (context, english) in self._messages or ("", english) in self._messages
        return marked(english) if translated and self.name != "en" else plain(self, english, context)

    def text_of(self: Language, said: Said, context: str = "") -> str:
        counted = isinstance(said, Counted) and said.one in self._forms
        return f"[[number]] ⟦{said.one}⟧" if counted else of(self, said, context)  # type: ignore[attr-defined]

    monkeypatch.setattr(Language, "sentence", sentence)
    monkeypatch.setattr(Language, "text_of", text_of)


def outside(text: str, known: str) -> list[tuple[str, str]]:
    """(word, line) of the words that nobody translated and that are not ``known``."""
    while (less := re.sub(r"⟦[^⟦⟧]*⟧", "\0", text)) != text:
        text = less
    names = {x.lower() for x in re.findall(r"[A-Za-z]+", known)} | {x.lower() for x in NAMES}
    lines = [(line, re.sub(NO_WORDS, "", line)) for line in text.splitlines()]
    return [(x, line) for line, bare in lines for x in re.findall(r"[A-Za-z]{3,}", bare) if x.lower() not in names]


def in_russian(text: str) -> str:
    return re.sub(r"^mbsym: 1.*\n", r"\g<0>language: ru\n", text, count=1, flags=re.MULTILINE)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, marks: None) -> Path:
    """Shipped systems in Russian; a sound description, a wrong one, others."""
    monkeypatch.chdir(tmp_path)
    for path in SHIPPED.glob("*.yaml"):
        _write(tmp_path / "systems" / path.name, in_russian(path.read_text(encoding="utf-8")))
    good = (tmp_path / "systems" / "simple-pendulum.yaml").read_text(encoding="utf-8")
    _write(tmp_path / "in" / "good.yaml", good)
    _write(tmp_path / "in" / "bad.yaml", good.replace("mass: m", "mas: m"))
    _write(tmp_path / "moved.yaml", good.replace("[0, -l, 0]", "[0, -2*l, 0]"))
    for name in ("crane", "good"):
        _write(tmp_path / "more" / f"{name}.yaml", good)
    return tmp_path


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(exist_ok=True)
    path.write_text(text, encoding="utf-8")


def untranslated(words: list[str], folder: Path) -> list[tuple[str, str]]:
    """What a command says outside of the marks, on both streams."""
    done = invoked(*words, prog_name="mbsym")
    assert done.exception is None or isinstance(done.exception, SystemExit), done.exception
    read_here = {"good.yaml", "bad.yaml"} | {Path(word).name for word in words}
    described = [x.read_text(encoding="utf-8") for x in folder.rglob("*.yaml") if x.name in read_here]
    return outside(done.output.replace(str(folder), ""), " ".join([*words, *described, "good bad moved crane"]))


@pytest.mark.parametrize("line", COMMANDS)
def test_a_command_speaks_the_language(line: str, folder: Path) -> None:
    name, *words = shlex.split(line)
    words = [f"systems/{x}.yaml" if (folder / "systems" / f"{x}.yaml").exists() else x for x in words]
    assert not untranslated([name, *words], folder)


#: Those of the documentation that read a system that comes with mbsym, and are for people.
DOCUMENTED = [
    shlex.join(words)
    for words in documented()
    if words[0] not in OF_FILES
    and not FOR_PROGRAMS & set(words)
    and any(re.fullmatch(r"systems/[\w-]+\.yaml", word) and (SHIPPED.parent / word).exists() for word in words)
]


@pytest.mark.parametrize("line", DOCUMENTED)
def test_a_documented_command_speaks_the_language(line: str, folder: Path) -> None:
    assert not untranslated(shlex.split(line), folder)


def test_the_page_of_a_batch_speaks_the_language(folder: Path) -> None:
    invoked("batch", "in", "--format", "json")
    page = (folder / "build" / "index.html").read_text(encoding="utf-8")
    body = re.sub(r"<[^>]*>", "\n", page.partition("</head>")[2])
    assert body.count("⟦") > 15
    assert not outside(body, "mbsym batch key mas mass " + (folder / "in" / "good.yaml").read_text(encoding="utf-8"))
    assert '<html lang="ru">' in page


def test_complaints_about_wrong_descriptions_speak_the_language(marks: None) -> None:
    """All of tests/invalid, with hints; what a YAML reader says of its own is quoted."""
    say, left = Language("ru").say, []
    for path in sorted((Path(__file__).parents[1] / "invalid").iterdir()):
        text = path.read_text(encoding="utf-8", errors="replace")
        for complaint in read(text, path.name)[1]:
            found = outside(render(complaint, text, path.name, say), text)
            left += [x for x in found if complaint.code != "syntax"]
    assert not left


def test_what_is_not_translated_is_found(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: one message stays English, and one that is counted."""
    sentence = Language.sentence
    english = "[[standing]]; largest drift [[measured]]"
    monkeypatch.setattr(Language, "sentence", lambda self, x, *a: x if x == english else sentence(self, x, *a))
    words = ["simulate", "systems/double-pendulum.yaml", "--time", "5", "--format", "csv"]
    assert {word for word, _ in untranslated(words, folder)} == {"largest", "drift"}


def test_marks_leave_gaps_outside() -> None:
    assert marked("a [[x]] of $y [[z]]$") == "⟦a ⟧[[x]]⟦ of $y [[z]]$⟧"
    assert outside("⟦a ⟧left⟦ over⟧ word", "left") == [("word", "\0left\0 word")]
