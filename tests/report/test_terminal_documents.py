"""What ``mbsym run -v`` prints: documents of the reports as text, in their language, on lines that are wide enough."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import terminal
from conftest import SHIPPED, derived, invoked

import mbsym
from mbsym.expressions.safe import UNBROKEN
from mbsym.formulas.names import greek
from mbsym.problems.normal_forms.result import Theorem
from mbsym.report.content import (
    Display,
    Graded,
    Notation,
    Relation,
    Rows,
    Strong,
    Symbol,
    aligned,
    column,
    exact,
    paragraph,
)
from mbsym.report.language import Language
from mbsym.report.messages import messages
from mbsym.report.plain_writer import STYLES, Writer

#: Conservative and damped, prescribed, with constraints, speeds, unit vectors, inputs, matrices, claims, refusals.
VARIED = (
    "satellite", "cart-pole", "rolling-disc", "rolling-disc-speeds", "four-bar", "chaplygin-sleigh", "ziegler-damped",
    "gyroscopic-pair", "euler-poisson", "heavy-top", "three-bodies", "shaken-pendulum", "spatial-arm",
    "spring-pendulum",
)  # fmt: skip
#: Problems that are told only where they are named.
FURTHER = {
    "cart-pole": (8,), "heavy-top": (9, 10), "spring-pendulum": (8, 9, 10, 11), "shaken-pendulum": (11, 12),
    "four-bar": (8, 9, 10, 11), "gyroscopic-pair": (8, 9, 10, 12), "ziegler-damped": (10, 11), "spatial-arm": (10,),
}  # fmt: skip
#: Notation of mathematics, and what is typed: keys, commands, files.
NOTATION = {"sin", "cos", "sqrt", "exp", "log", "atan", "det", "grad", "const", "sum", "Mbar", "fbar", "lam"}
TYPED = {"motion", "speeds", "orientation", "quaternion", "terms", "mbsym", "floquet", "explain", "description", "FILE"}
TYPED |= {
    "equilibria",
    "report",
    "html",
    "results",
    "json",
    "systems",
    "yaml",
    "gravity",
    "gradient",
    "omega1",
    "omega2",
    "omega3",
}


def own_words(analysis: mbsym.Analysis) -> set[str]:
    """What the description says itself, or declares."""
    system = analysis.system
    said = [system.name, *(body.name for body in system.bodies), *analysis.ring.names()]
    said += [one.place for one in system.claims]
    said += [one.name for one in (*system.abbreviations, *system.notation, *system.inputs, *system.outputs)]
    return {word for text in said for word in re.findall(r"[A-Za-z]+", text)}


@pytest.mark.parametrize("language", ["ru", "es"])
@pytest.mark.parametrize("name", VARIED)
def test_no_english_is_said_in_other_languages(name: str, language: str) -> None:
    """In Russian whatever is written in Latin letters is a name or notation; in Spanish no message stays as it was."""
    analysis = derived(SHIPPED / f"{name}.yaml")
    keys = (*analysis.problems, *FURTHER.get(name, ()), "claims", "checks")
    lines = [line for key in keys for line in terminal.told(analysis, key, language)]
    assert len(lines) > 20
    if language == "es":
        english = {text for _, text in messages("es") if len(text) > 30 and "[[" not in text and "{}" not in text}
        assert not [text for text in english for line in lines if text in line]
        return
    known = own_words(analysis) | NOTATION | TYPED
    strange = {
        word
        for line in lines
        for word in re.findall(r"[A-Za-z]{3,}", line)
        if word not in known and not greek(word) and word.lower() not in {x.lower() for x in known}
    }
    assert not strange


def test_a_sentence_without_translation_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: one message of problem 4 is not translated."""
    sentence = Language.sentence
    text = "satisfies the equations of motion identically."
    monkeypatch.setattr(Language, "sentence", lambda self, x, *more: x if x == text else sentence(self, x, *more))
    with pytest.raises(AssertionError, match="identically"):
        test_no_english_is_said_in_other_languages("cart-pole", "ru")


def test_every_theorem_has_a_name_in_other_languages() -> None:
    """Those of problem 11 stand beside its verdicts, and in what was found."""
    for name in ("ru", "es"):
        known = messages(name)
        assert not [one for one in Theorem if one.value and ("", one.value) not in known]


@pytest.mark.parametrize("name", ["satellite", "cart-pole", "chaplygin-sleigh"])
def test_lines_are_as_wide_as_the_terminal_and_nothing_is_cut(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At 80 columns; joined again the lines are those of a pipe, which has a statement in each."""
    words = ["run", str(SHIPPED / f"{name}.yaml"), "-v", "--format", "json", "--out", str(tmp_path)]
    whole = invoked(*words).output
    monkeypatch.setenv("COLUMNS", "80")
    folded = invoked(*words).output
    assert not [line for line in folded.splitlines() if len(line) > 80 and str(tmp_path) not in line]
    assert UNBROKEN not in folded + whole
    joined = " ".join(folded.split())
    lines = [line for line in whole.splitlines() if not re.search(r"\[| = \(", line) and not re.search(r"\d s$", line)]
    assert len(lines) > 40
    assert not [line for line in lines if " ".join(line.split()) not in joined and str(tmp_path) not in line]


def test_a_row_is_known_in_each_part_of_a_table_that_is_too_wide() -> None:
    """Columns that tell the rows apart begin each part: the first alone where it does, or where they are wide."""
    write = Writer(readable=True, width=24)

    def drawn(*rows: tuple[str, ...]) -> list[list[str]]:
        titles = ("name", "step", "error", "work", "cost")
        return [x.text.split() for x in write.block(aligned([column(title) for title in titles], rows))]

    first, second = ("rk4", "1/2", "1.0e-01", "12", "3"), ("rk4", "1/4", "2.0e-03", "24", "6")
    begins = {0: "name", 1: "rk4", 2: "rk4"}
    lines = drawn(first, second)
    assert [line[0] for line in lines] == [*begins.values()] * (len(lines) // 3)
    assert [line[1] for line in lines] == ["step", "1/2", "1/4"] * (len(lines) // 3)
    assert len(lines) > 3
    assert sorted(x for line in lines[1::3] for x in line[2:]) == sorted(first[2:])
    apart = drawn(first, ("rk5", *second[1:]))
    assert [line.count("step") for line in apart[::3]] == [1] + [0] * (len(apart) // 3 - 1)
    wide = drawn(first, (first[0], "1/4096/4096", *second[2:]))
    assert [line.count("step") for line in wide[::3]] == [1] + [0] * (len(wide) // 3 - 1)


def test_matrices_are_drawn_where_they_fit() -> None:
    write = Writer(readable=True, width=30)
    shown = Relation(Symbol("P"), "=", Rows(((exact(1), exact(20)), (exact(300), exact(4)))))
    assert [x.text for x in write.block(Display(shown))] == ["  P = [  1   20 ]", "      [ 300  4  ]"]
    narrow = Writer(readable=True, width=12)
    assert [x.text for x in narrow.block(Display(shown))] == ["  P = [(1, 20), (300, 4)]"]


@pytest.mark.parametrize(
    ("tex", "plain"),
    [
        (
            r"\frac{d}{dt} \frac{\partial R}{\partial \dot s} - \frac{\partial R}{\partial s} = Q",
            "d/dt dR/ds' - dR/ds = Q",
        ),
        (r"\bar M \dot v = \bar f", "Mbar v' = fbar"),
        (r"J = \partial (\dot\varphi, \chi)/\partial u", "J = d(phi', chi)/du"),
        (r"T = \frac12 \sum A_{ij}\, \dot q_i \dot q_j + A_0", "T = 1/2 sum A_ij q_i' q_j' + A0"),
        (r"\{F_1, F_2\}", "{F1, F2}"),
        (r"\frac{\mathrm{d}I}{\mathrm{d}t}", "dI/dt"),
        (r"\lambda^2 = -1", "lambda^2 = -1"),
    ],
)
def test_notation_is_read_by_people(tex: str, plain: str) -> None:
    assert Writer(readable=True).inline(Notation(tex)) == plain


def test_long_formulas_are_counted_with_the_file_that_has_them() -> None:
    analysis = derived(SHIPPED / "satellite.yaml")
    (line,) = [text for text in terminal.told(analysis, 2) if text.startswith("  U = ")]
    assert re.fullmatch(r"  U = \[\d+ terms: report.html\]", line)
    (line,) = [text for text in terminal.told(analysis, 3) if "definitions" in text]
    assert re.fullmatch(r"  \[\d+ definitions: report.html\]", line)


def test_verdicts_are_coloured_and_titles_stand_out() -> None:
    write = Writer(readable=True)
    (line,) = write.block(paragraph(Strong("unstable", "bad"), " (", Graded("open", "open"), ")"))
    assert [style for _, style in line.parts] == [STYLES["bad"], "", STYLES["open"], ""]
