"""Content: every kind of value is written by every medium; a message without its gap or its translation is found."""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator
from functools import singledispatchmethod
from inspect import getsource
from textwrap import dedent
from typing import get_args

import pytest
from conftest import SHIPPED, derived

import mbsym
from mbsym.algebra.program import Program
from mbsym.expressions import tree
from mbsym.expressions.message import Message, worded
from mbsym.formulas.formula import Column, Formula, Matrix
from mbsym.formulas.latex import LatexNames
from mbsym.formulas.mathml import MathNames
from mbsym.problems.stability.words import Word
from mbsym.report import content, plain_writer
from mbsym.report.content import Name, Notation, Relation, Said, Strong, Symbol, paragraph, say
from mbsym.report.html import writer as html
from mbsym.report.language import Language
from mbsym.report.latex import writer as latex
from mbsym.report.latex.labels import Form, Labels
from mbsym.report.sections.equations import short_equations


@pytest.fixture(scope="module")
def analysis() -> mbsym.Analysis:
    return derived(SHIPPED / "simple-pendulum.yaml")


#: What stands in descriptions alone, which the terminal does not repeat.
ON_PAPER_AND_SCREENS = (content.SpeedForm, content.Tensor, content.Points)


def in_latex(analysis: mbsym.Analysis, language: str = "", form: Form = Form.REPORT) -> latex.Writer:
    return latex.Writer(LatexNames.of(analysis.ring), Language(language), Labels("mbsym:pendulum:"), form)


def in_html(analysis: mbsym.Analysis, language: str = "") -> html.Writer:
    return html.Writer(MathNames.of(analysis.ring), Language(language))


def kinds(union: object) -> Iterator[type]:
    for one in get_args(union):
        yield from kinds(one) if get_args(one) else [one]


def told_apart(medium: type, method: str) -> tuple[type, ...]:
    """The kinds that a writer's method knows: those registered with it, or the cases of its ``match``."""
    written = vars(medium)[method]
    if isinstance(written, singledispatchmethod):
        return tuple(kind for kind in written.dispatcher.registry if kind is not object)
    patterns = [x for x in ast.walk(ast.parse(dedent(getsource(written)))) if isinstance(x, ast.MatchClass)]
    return tuple(eval(ast.unparse(x.cls), vars(sys.modules[medium.__module__])) for x in patterns)


@pytest.mark.parametrize("union", ["Math", "Inline", "Block"])
def test_every_kind_is_written_by_every_medium(analysis: mbsym.Analysis, union: str) -> None:
    """A kind that a medium does not know would be taken for an expression, or raise in somebody's report."""
    expressions = set(kinds(tree.Expression))
    for one in kinds(getattr(content, union)):
        if one in expressions:  # what is left: printers of expressions raise TypeError for what is none
            continue
        for medium in (latex.Writer, html.Writer):
            mathematics = one in set(kinds(content.Math))
            method = "block" if union == "Block" else "math" if mathematics else "inline"
            assert issubclass(one, told_apart(medium, method)), (medium, one)
        if union != "Block" and one not in ON_PAPER_AND_SCREENS:
            assert issubclass(one, told_apart(plain_writer.Writer, "inline")), one


def test_notation_and_gaps_are_the_same_in_all_media(analysis: mbsym.Analysis) -> None:
    energy = analysis.energy.kinetic_energy
    said = say("$L$ does not contain $[[names]]$: cyclic.", names=content.named(["theta"]))
    assert in_latex(analysis).said(said) == r"$L$ does not contain $\theta$: cyclic."
    assert in_html(analysis).said(said) == ("<math><mi>L</mi></math> does not contain <math><mi>θ</mi></math>: cyclic.")
    assert plain_writer.Writer().said(said) == "L does not contain theta: cyclic."
    outside = say("with [[value]] and [[words]]", value=Relation(Symbol("T"), "=", energy), words=worded("stable"))
    assert in_latex(analysis).said(outside).startswith("with $T = ")
    assert "<math><mi>T</mi><mo>=</mo>" in in_html(analysis).said(outside)
    assert plain_writer.Writer().said(outside) == f"with T = {energy} and stable"


def test_a_reason_is_a_sentence_with_typed_gaps(analysis: mbsym.Analysis) -> None:
    """A reason with notation and a formula is set as mathematics in every medium; its English is plain text."""
    mass = Formula(analysis.ring, analysis.ring.generator("parameter", "m") ** 2)
    reason = Message(
        "$K > 0$ and $D \\geq 0$, as [[value]] and $[[value]]^3$ are: 50 % [[word]]", value=mass, word=Word.STABLE
    )
    assert reason == "K > 0 and D >= 0, as m**2 and m**2^3 are: 50 % stable"
    assert isinstance(reason, Said)
    assert in_latex(analysis).inline(reason) == r"$K > 0$ and $D \geq 0$, as $m^{2}$ and $m^{2}^3$ are: 50 \% stable"
    assert "<mi>K</mi><mo>&gt;</mo><mn>0</mn>" in in_html(analysis).inline(reason)
    assert "as <math><msup><mi>m</mi>" in in_html(analysis).inline(reason)
    assert plain_writer.Writer().inline(reason).startswith("K > 0 and D >= 0, as m**2")
    other = Message("[[word]]", word=Word.STABLE)
    for medium in (in_latex, in_html):
        assert medium(analysis, "es").inline(other) == medium(analysis, "es").inline(Word.STABLE) == "estable"


def test_what_a_description_says_is_escaped(analysis: mbsym.Analysis) -> None:
    words = paragraph(Strong("<b> & 100 % _"), " ", content.Emphasis("</p>"), say("[[x]]", x="$\\input{y}$ <i>"))
    assert "&lt;b&gt; &amp; 100 % _" in in_html(analysis).block(words)
    assert not re.search(r"</p>.", in_html(analysis).block(words))
    assert "<i> " not in in_html(analysis).block(words).replace("<i>&lt;", "")
    assert r"\input" not in in_latex(analysis).block(words)


def test_a_gap_that_nothing_fills_is_an_error(analysis: mbsym.Analysis) -> None:
    for write in (in_latex(analysis).said, in_html(analysis).said, plain_writer.Writer().said):
        with pytest.raises(KeyError):
            write(Said("No result: [[why]]."))


def test_a_label_is_given_once(analysis: mbsym.Analysis) -> None:
    write = in_latex(analysis)
    text = write.document([content.Display(Symbol("T"), "T"), content.Display(Symbol("U"), "T")])
    labels = re.findall(r"\\longformula\[(.*?)\]", text)
    assert len(labels) == len(set(labels)) == 2


@pytest.mark.parametrize("language", ["ru", "es"])
def test_all_media_speak_the_language(analysis: mbsym.Analysis, language: str) -> None:
    said = Said("Generalised coordinates")
    other = Language(language).sentence(said.text)
    assert other != said.text
    assert in_latex(analysis, language).said(said) == in_html(analysis, language).said(said) == other
    assert plain_writer.Writer(Language(language)).said(said) == other


def test_vectors_and_matrices_are_whole_where_they_fit_and_zero_where_they_are(analysis: mbsym.Analysis) -> None:
    ring = analysis.ring
    energy = analysis.energy.kinetic_energy
    nothing = Formula(ring, ring.zero)
    two = [[energy.polynomial, ring.zero]]
    for value, whole in ((Matrix.of(ring, [[ring.zero]]), "= 0"), (Matrix.of(ring, two), "pmatrix")):
        assert whole in in_latex(analysis).block(content.Matrices(Symbol("M"), value, True, "M"))
    vector: Column = (energy, nothing, nothing)
    text = in_latex(analysis).block(content.Components(Symbol("V", "O1"), vector, "V"))
    assert text.startswith("\\longformula[mbsym:pendulum:eq:V]{V_{O_{1}} = (")
    assert "<msub>" in in_html(analysis).block(content.Components(Symbol("V", "O1"), vector, "V"))


def test_a_table_is_a_table_on_wide_pages_and_a_sentence_in_narrow_columns(analysis: mbsym.Analysis) -> None:
    columns = (content.TableColumn(Said("name"), 0), content.TableColumn(Said("value"), 3.0))
    table = content.Table(Said("Parameters"), columns, (((content.Verbatim("m"),), (Name("m"),)),))
    assert "\\begin{longtable}" in in_latex(analysis).block(table)
    assert in_latex(analysis, form=Form.APPENDIX).block(table) == "Parameters: $m$.\n"
    assert "<td><code>m</code></td><td><math><mi>m</mi></math></td>" in in_html(analysis).block(table)


def test_screens_unfold_and_paper_is_without(analysis: mbsym.Analysis) -> None:
    folded = content.Folded(Said("The same, written out"), (paragraph("aside"),))
    assert "<details>" in in_html(analysis).block(folded)
    assert not in_latex(analysis).block(folded)


def test_notation_knows_no_breaks_on_screens() -> None:
    assert "penalty" not in html.notation(r"U = \sum \Bigl[ a \penalty0 - b \Bigr]")
    assert Notation(r"\dot x").tex == r"\dot x"


def test_matrices_stand_side_by_side_where_they_fit(analysis: mbsym.Analysis) -> None:
    """Two of one symbol share a line of paper, the empty one has its own; a packed one is written entry by entry."""
    ring = analysis.ring
    m, nothing = Matrix.of(ring, [[ring.generator("parameter", "m")]]), Matrix.of(ring, [[ring.zero]])
    three = tuple(
        content.Matrices(Symbol(letter, "1"), value, True, letter)
        for letter, value in (("M", m), ("D", nothing), ("K", m))
    )
    written = in_latex(analysis).block(content.SideBySide(three, "part"))
    assert r"M_{1} = m,\quad K_{1} = m" in written, "an entry alone stands without brackets"
    assert "mtable" not in in_html(analysis).block(three[0])
    assert [line.text for line in plain_writer.Writer().block(three[0])] == ["  M1 = m"]
    assert written.count("\\label{mbsym:pendulum:eq:part:matrices:1}") == 1
    assert "\\longformula[mbsym:pendulum:eq:D]{D_{1} = 0}" in written
    assert in_html(analysis).block(content.SideBySide(three, "part")).count('class="formula"') == 3
    packed = content.Matrices(Symbol("M"), m, True, "M", packed=True)
    assert "M_{11} = m" in in_latex(analysis).block(packed)
    assert "table" not in in_html(analysis).block(packed)


def test_notes_bars_and_script_letters(analysis: mbsym.Analysis) -> None:
    line = content.Display(Relation(Symbol("M", look="bar"), "=", 0), "", (worded("stable"),))
    assert in_latex(analysis).block(line) == (
        r"\longformula[mbsym:pendulum:eq:1]{\bar{M} = 0 \quad\penalty0 \text{(stable)}}"  # every number has a label
    )
    assert "\u00af" in in_html(analysis).block(line)
    assert in_html(analysis).block(line).endswith('<p class="note soft">(stable)</p>')
    assert in_latex(analysis).math(Symbol("A", look="script")) == r"\mathcal{A}"
    assert in_html(analysis).math(Symbol("A", look="script")) == "<mi>\U0001d49c</mi>"
    above = in_html(analysis).math(Symbol("R", "2", "(1)"))  # what the first multiplier adds, not R_21
    assert above == ("<msubsup><mi>R</mi><mrow><mn>2</mn></mrow><mrow><mo>(</mo><mn>1</mn><mo>)</mo></mrow></msubsup>")
    assert plain_writer.Writer().inline(content.joined(("a", "b", "c"), "; ")) == "a; b; c"


def test_a_program_is_a_listing_in_names_of_its_medium() -> None:
    """Of (theta + theta)^2: what occurs twice has a number; in the listing of a screen names are as declared."""
    program = Program()
    angle = program.input("theta_dot")
    double = angle + angle
    steps = content.Steps(
        program, ((Symbol("M", "11"), double * double),), {"theta_dot": Name("theta", 1)}, Said("The program")
    )
    analysis = derived(SHIPPED / "simple-pendulum.yaml")
    assert "s_{1} = \\dot{\\theta} + \\dot{\\theta}" in in_latex(analysis).block(steps)
    assert "M_{11} = s_{1}\\,s_{1}" in in_latex(analysis).block(steps)
    assert "<pre>s1 = theta_dot + theta_dot\nM11 = s1*s1</pre>" in in_html(analysis).block(steps)
    assert "<summary>Программа</summary>" in in_html(analysis, "ru").block(steps)


def test_facts_links_and_grades(analysis: mbsym.Analysis) -> None:
    """A list of what was found; a bad one stands out on paper, a good one on screens alone; links are for screens."""
    held, lost = (content.Link(content.Graded(Said("Claims"), x), "claims") for x in ("good", "bad"))
    facts = content.Facts((content.Fact(Said("Motion"), (Name("theta"), held)), content.Fact(Said("Claims"), (lost,))))
    written = in_latex(analysis).block(facts)
    assert "\\item Motion: $\\theta$;\\newline Claims.\n\\item Claims: \\textbf{Claims}.\n" in written
    page = in_html(analysis).block(facts)
    assert "</dd>\n<dd>" in page
    assert '<dt>Claims</dt>\n<dd><a href="#claims"><span class="bad">Claims</span></a></dd>' in page
    assert '<strong id="verdict" class="good">' in in_html(analysis).inline(Strong("s", "good", "verdict"))


def test_a_table_without_a_title_has_headings_and_falls_into_paragraphs(analysis: mbsym.Analysis) -> None:
    columns = tuple(content.TableColumn(Said(x), 3.0) for x in ("place", "claim", "outcome"))
    table = content.Table(None, columns, (((), ("a_b",), (worded("differs"), ": ", "2")), (("p",), ("c",), ("d",))))
    head = "place & claim & outcome\\\\\\midrule\\endhead"
    assert f"{head}\n & a\\_b & differs: 2\\\\\n" in in_latex(analysis).block(table)
    assert in_latex(analysis, form=Form.APPENDIX).block(table) == "a\\_b: differs: 2.\n\np, c: d.\n"
    assert "<h3>" not in in_html(analysis).block(table)
    assert '<th scope="col">place</th>' in in_html(analysis).block(table)


def test_definitions_names_beside_and_literature(analysis: mbsym.Analysis) -> None:
    """A publication's letter is told apart from a name that looks like it; \\cite is for whole documents."""
    letter = content.Definitions(Said("with"), (Relation(Name("theta_"), "=", 1), Relation(Name("c1"), "=", 2)))
    beside = content.Beside(("theta_", "c1"), (letter,))
    written = in_latex(analysis).block(beside)
    assert r"with: $\displaystyle \mathtt{theta\_} = 1$; $\displaystyle c_{1} = 2$." in written
    assert "verbatim" in in_html(analysis).block(beside)
    cited = content.Cited(Said("On the theorems"), ((worded("Routh"), ("routh", "lyapunov")),))
    assert in_latex(analysis).block(cited) == "On the theorems: Routh~\\cite{routh,lyapunov}.\n"
    assert not in_latex(analysis, form=Form.APPENDIX).block(cited)
    at = Relation(content.Text(Said("at"), " "), content.Power(Name("theta"), 2), ":", 1)
    assert in_latex(analysis).math(at) == r"\text{at } \theta^{2} \colon\quad 1"
    assert plain_writer.Writer().inline(at) == "at theta**2: 1"
    assert in_latex(analysis).math(Relation("-", Symbol("v", "4", "(2)"))) == "-v_{4}^{(2)}"


def test_brackets_after_a_letter_are_a_call_of_names_and_a_product_of_formulas(analysis: mbsym.Analysis) -> None:
    """f(lambda) and lambda_1 (a + b): written alike, the product would be read as a function of a + b."""
    writer = plain_writer.Writer(Language(""), True)
    variable, factor = Symbol("lambda"), analysis.equations.forcing[0]
    assert writer.inline(Relation(Symbol("f"), content.Listed((variable,), brackets=True))) == "f(lambda)"
    product = writer.inline(Relation(Symbol("lambda", "1"), content.Listed((factor,), brackets=True)))
    assert product.replace(plain_writer.UNBROKEN, " ").startswith("lambda_1 (")


@pytest.mark.parametrize(
    ("slope", "told"),
    [("(5*cos(p) - 3)/10", "1/10 lambda_1 (5 cos(p) - 3)"), ("-7*cos(p)/10", "-7/10 lambda_1 cos(p)")],
)
def test_a_sum_beside_a_multiplier_stands_in_brackets(slope: str, told: str) -> None:
    """J^T lambda of x' + (5 c - 3)/10 p' = 0 by hand; "1/10 lambda_1 5 cos(p) - 3" was written."""
    found = mbsym.loads(
        f"""
mbsym: 1
name: Two coordinates
bodies:
  - {{name: A, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: 1}}
  - {{name: B, attached to: 0, rotation: {{axes: [3], angles: [p]}}, mass: 1, mass centre: [1, 0, 0]}}
constraints: [velocity: x_dot + ({slope})*p_dot = 0]
""",
        (3,),
    )
    _, turning = short_equations(found.equations, found.system)
    text = plain_writer.Writer(Language(""), True).inline(turning).replace(plain_writer.UNBROKEN, " ")
    assert text == f"p'' = {told}"
