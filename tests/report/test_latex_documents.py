"""LaTeX in the hands of its consumer: pdflatex says nothing against the report, nor against its parts in documents of
others, be their columns wide or narrow."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections import Counter
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from conftest import derived, invoked

import mbsym
from mbsym.analysis import Analysis
from mbsym.report import conditions
from mbsym.report.latex.appendix import fragment, joined, render
from mbsym.report.latex.displays import display, written_out
from mbsym.report.latex.labels import labels, prefix_of, slug
from mbsym.report.targets import TARGETS
from mbsym.report.whole_run import rendered
from mbsym.source.yaml_writer import meaning
from tests.conftest import SHIPPED, TESTS, needs_pdflatex
from tests.report.readers import unreadable

SYSTEMS = ("satellite.yaml", "double-pendulum.yaml", "heavy-top.yaml")
#: Its claims are long formulas.
CLAIMING = "tethered-satellites.yaml"
CLASSES = {
    "article": r"\documentclass{article}",
    "two columns": r"\documentclass[twocolumn]{article}",
    "revtex4-2": r"\documentclass[aps,pre,twocolumn,10pt]{revtex4-2}",
}
PREAMBLE = "\\usepackage[utf8]{inputenc}\n\\usepackage[T1]{fontenc}\n\\usepackage{amsmath}\n\\usepackage{tikz}\n"


@cache
def files_of(name: str) -> dict[str, str]:
    return written(derived(SHIPPED / name))


def written(analysis: Analysis) -> dict[str, str]:
    found = rendered(TARGETS["latex"], analysis, analysis.problems)
    assert not [file.failure for file in found if file.failure]
    return {file.filename: file.text for file in found if file.text is not None}


def complaints(folder: Path, runs: int = 3) -> list[str]:
    """What pdflatex has against ``main.tex`` in a folder after so many runs; it must compile."""
    for _ in range(runs):
        command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "main.tex"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, errors="replace", timeout=120)
        assert done.returncode == 0, done.stdout[-2000:]
    log = (folder / "main.log").read_text(errors="replace")
    return [line for line in log.split("\n") if re.match(r"(Over|Under)full|!|.*Warning", line)]


def has(document_class: str) -> bool:
    """Whether TeX finds the class."""
    name = re.search(r"\{([\w-]+)\}$", document_class)[1]
    return subprocess.run(["kpsewhich", f"{name}.cls"], capture_output=True).returncode == 0


@needs_pdflatex
@pytest.mark.parametrize("name", [SYSTEMS[0], CLAIMING])
def test_the_report_compiles_without_a_word(name: str, tmp_path: Path) -> None:
    (tmp_path / "main.tex").write_text(files_of(name)["report.tex"])
    assert complaints(tmp_path) == []


@needs_pdflatex
@pytest.mark.parametrize("which", CLASSES)
def test_appendices_of_a_folder_in_documents_of_others(which: str, tmp_path: Path) -> None:
    if not has(CLASSES[which]):
        pytest.skip(f"no {which}")
    whole = joined([files_of(name)["appendix.tex"] for name in SYSTEMS])
    assert not unreadable("appendix.tex", whole)
    (tmp_path / "appendix.tex").write_text(whole)
    body = "Text of the author.\n\\section{Own}\n\\appendix\\input{appendix}\n"
    text = f"{CLASSES[which]}\n{PREAMBLE}\\begin{{document}}\n{body}\\end{{document}}\n"
    (tmp_path / "main.tex").write_text(text)
    assert complaints(tmp_path, 2) == []
    # What the author set before is as it was: no paragraph is ragged or without indentation afterwards.
    aux = (tmp_path / "main.aux").read_text()
    assert len(re.findall(r"\\newlabel\{mbsym:", aux)) == len(labels(whole))


@needs_pdflatex
def test_fragments_stand_where_they_are_put_and_change_nothing_around(tmp_path: Path) -> None:
    files = files_of("satellite.yaml")
    parts = [name for name in files if name.startswith("fragments/")]
    assert len(parts) == 12
    (tmp_path / "fragments").mkdir()
    for name in parts:
        (tmp_path / name).write_text(files[name])
    kept = r"\typeout{kept \the\parindent, \the\parskip, \the\rightskip, \the\emergencystretch, \the\binoppenalty}"
    body = "\n".join(f"\\subsection{{Part}}\\input{{{name}}}" for name in parts)
    text = f"{CLASSES['two columns']}\n{PREAMBLE}\\begin{{document}}\n{kept}\n{body}\n{kept}\n\\end{{document}}\n"
    (tmp_path / "main.tex").write_text(text)
    assert complaints(tmp_path, 2) == []
    before, after = re.findall(r"^kept .*$", (tmp_path / "main.log").read_text(errors="replace"), re.MULTILINE)
    assert before == after


def test_parts_have_no_preamble_no_macro_and_labels_of_their_own() -> None:
    for name in SYSTEMS:
        files = files_of(name)
        prefix = f"mbsym:{slug(mbsym.load(SHIPPED / name).system.name)}:"
        for part in [key for key in files if key != "report.tex"]:
            text = files[part]
            assert not re.search(r"\\((re)?newcommand|def|let|usepackage|documentclass|begin\{document)\b", text)
            assert all(label.startswith(prefix) for label in labels(text))
            assert "Needs amsmath" in text.split("\n")[2]
            assert prefix in text.split("\n")[2]
    fragments = [label for key, text in files_of(SYSTEMS[0]).items() if "/" in key for label in labels(text)]
    for texts in (fragments, labels(joined([files_of(name)["appendix.tex"] for name in (*SYSTEMS, SYSTEMS[1])]))):
        assert texts
        assert [label for label, count in Counter(texts).items() if count > 1] == []


def test_two_systems_of_one_name_have_labels_of_their_own() -> None:
    text = files_of("double-pendulum.yaml")["appendix.tex"]
    whole = joined([text, text, text])
    assert not unreadable("appendix.tex", whole)
    assert len(labels(whole)) == 3 * len(labels(text))
    assert unreadable("appendix.tex", text + text), "the planted repetition of all labels"


@pytest.mark.parametrize("name", SYSTEMS)
def test_version_and_description_are_at_the_foot(name: str) -> None:
    digest = meaning(mbsym.load(SHIPPED / name, ()).system)
    text = files_of(name)["report.tex"]
    foot = text.partition(r"\@oddfoot}")[2].partition("\n\\title")[0]
    assert digest[:12] in foot
    assert digest not in foot, "all of it stands at the end"
    assert digest in text[-400:]
    assert mbsym.__version__ in foot
    other = mbsym.loads((SHIPPED / name).read_text().replace("name: ", "name: Other ", 1), ())
    assert meaning(other.system) not in text


@needs_pdflatex
def test_the_foot_is_printed(tmp_path: Path) -> None:
    if shutil.which("pdftotext") is None:
        pytest.skip("no pdftotext")
    (tmp_path / "main.tex").write_text(files_of("double-pendulum.yaml")["report.tex"])
    complaints(tmp_path, 2)
    pages = subprocess.run(["pdftotext", "main.pdf", "-"], cwd=tmp_path, capture_output=True, text=True).stdout
    first = pages.split("\f")[0]
    digest = meaning(mbsym.load(SHIPPED / "double-pendulum.yaml", ()).system)
    assert digest[:12] in first
    assert digest in pages
    assert "What was found" in first
    assert "Contents" not in first, "of four pages"
    assert all(str(number) in page.split("\n") for number, page in enumerate(pages.split("\f")[:-1], start=1))


@needs_pdflatex
def test_a_long_report_has_a_table_of_contents(tmp_path: Path) -> None:
    """From seven pages on; it is whole when the runs end that LaTeX asks for."""
    if shutil.which("pdftotext") is None:
        pytest.skip("no pdftotext")
    (tmp_path / "main.tex").write_text(files_of("satellite.yaml")["report.tex"])
    complaints(tmp_path, 3)
    first = subprocess.run(
        ["pdftotext", "-l", "2", "main.pdf", "-"], cwd=tmp_path, capture_output=True, text=True
    ).stdout
    assert "Problem 6. Stability" in first.partition("Contents")[2]


PLANTED = {
    "an unknown command": (r"\displaystyle", r"\displaystile"),
    "a label set twice": (":eq:U}", ":eq:T}"),
    "a missing brace": (r"\par\endgroup", r"}\par\endgroup"),
    "a definition": (r"\par\endgroup", r"\def\x{1}\par\endgroup"),
    "a package": (r"\par\endgroup", r"\usepackage{breqn}\par\endgroup"),
    "an open group": (r"\par\endgroup", r"\par"),
    "a dollar": (r"$\displaystyle", r"\displaystyle"),
}


@pytest.mark.parametrize("mistake", PLANTED)
def test_planted_mistakes_are_caught(mistake: str) -> None:
    text = files_of("satellite.yaml")["appendix.tex"]
    assert not unreadable("appendix.tex", text)
    right, wrong = PLANTED[mistake]
    assert right in text
    assert unreadable("appendix.tex", text.replace(right, wrong, 1)).startswith("line "), mistake


# --- figures of simulations ---


@needs_pdflatex
def test_figures_of_a_simulation_stand_in_the_report_of_the_same_description_only(tmp_path: Path) -> None:
    path, out = tmp_path / "pendulum.yaml", tmp_path / "out"
    text = (SHIPPED / "simple-pendulum.yaml").read_text()
    path.write_text(text)
    simulate = ["simulate", str(path), "--time", "1", "--format", "pdf,csv", "--no-estimate", "--out", str(out)]
    derive = ["run", str(path), "--format", "latex", "--problems", "1-2", "--out", str(out)]

    def included() -> list[str]:
        assert invoked(*derive).exit_code == 0
        return re.findall(r"\\includegraphics\[[^]]*\]\{([^}]*)\}", (out / "report.tex").read_text())

    assert included() == []
    assert invoked(*simulate).exit_code == 0
    made = sorted(file.name for file in out.glob("*.pdf"))
    assert made
    assert sorted(included()) == made
    (out / "main.tex").write_text((out / "report.tex").read_text())
    assert complaints(out) == []
    (out / made[0]).write_bytes(b"changed by somebody")
    assert sorted(included()) == made[1:]
    path.write_text(text.replace("positive", "nonzero", 1))  # another description
    assert included() == []


def test_factors_that_labels_speak_of_are_written() -> None:
    """And their product is the characteristic polynomial, whose name is not that of a parameter."""
    analysis = mbsym.load(SHIPPED / "satellite-with-damper.yaml")
    text = TARGETS["latex"].render(analysis, (5, 6))
    part = analysis.stability.subsystems[1]
    product = [part.ring.one]
    for powers, multiplicity in conditions.factors(part):
        for _ in range(multiplicity):
            whole = [part.ring.zero] * (len(product) + len(powers) - 1)
            for i, a in enumerate(product):
                for j, b in enumerate(powers):
                    whole[i + j] = whole[i + j] + a * b.polynomial
            product = whole
    assert list(map(str, product)) == [str(x.polynomial) for x in part.characteristic]
    assert r"1 \colon\quad  \penalty0  \lambda^{2} \penalty0 + \omega^{2}" in text
    assert r"\Delta^{(2)} (\lambda)" in text


def test_the_finding_refers_to_the_conditions_by_their_numbers() -> None:
    """Bead on a hoop: the constant of m R^2 s^2 + b s + m R (g - R Omega^2) is positive where g - R Omega^2 is.

    The opposite of it, under which the motion is unstable, is no formula of its own and has no number.  Each formula
    that has one has a label; a claimed condition is set as mathematics.
    """
    text = TARGETS["latex"].render(mbsym.load(SHIPPED / "bead-on-hoop.yaml"), (3, 4, 5, 6))
    body = text.partition(r"\begin{document}")[2]
    (label,) = re.findall(r"> 0\$~\\eqref\{([^}]*)\}", body)
    assert body.count("eqref{") == 1
    shown = text.partition(f"\\longformula[{label}]")[2].partition("\n")[0]
    assert shown.replace("\\penalty0 ", "") == r"{a_{0} \colon\quad g - R \Omega^{2} > 0}"
    assert "\\longformula{" not in body
    assert r"\frac{R \Omega^{2}}{g} < 1" in body
    assert "Omega**2" not in body.partition("For example")[0]
    assert unreadable("report.tex", text.replace(rf"\longformula[{label}]", r"\longformula[other]"))


def test_a_label_is_not_cut_inside_a_word() -> None:
    """Forty letters at most, and the last word whole; a word longer than that is cut."""
    assert slug("Satellite with a gravitational stabilizer") == "satellite-with-a-gravitational"
    assert slug("Satellite with a gravitational stabilize") == "satellite-with-a-gravitational-stabilize"
    assert slug("a" * 50) == "a" * 40


def test_formulas_of_an_appendix_are_those_that_a_person_writes() -> None:
    """Short ones below each other's sign; a longer one broken between its terms; what has a long word as before."""
    short = r"\longformula[p:a]{a = b\penalty0  + c}" + "\n" + r"\longformula[p:b]{\ddot x =\penalty0 0}"
    assert written_out(short) == (
        "\\begin{align}\na &= b + c \\label{p:a} \\\\\n\\ddot x &= 0 \\label{p:b}\n\\end{align}"
    )
    assert written_out(r"\longformula[p:a]{a < b}") == "\\begin{equation}\\label{p:a}\na < b\n\\end{equation}"
    apart = written_out(f"{short[: short.index(chr(10))]}\n\nand\n\n{short[short.index(chr(10)) + 1 :]}")
    assert apart.count(r"\begin{equation}") == 2
    terms = [rf"k_{{{n}}} \sin \theta_{{{n}}} \cos \theta_{{{n}}}" for n in range(6)]
    long = r"\longformula[p:l]{" + "\\penalty0  + ".join(terms) + " = 0}"
    found = written_out(long)
    assert found.startswith("\\begin{multline}\\label{p:l}\n")
    lines = found.split("\n")[1:-1]
    assert len(lines) > 1
    assert all(line.startswith("+ ") for line in lines[1:])
    assert " ".join(line.removesuffix(" \\\\") for line in lines) == " + ".join(terms) + " = 0"
    # Inside of a fraction no line may end.
    whole = r"\longformula[p:f]{x = \frac{" + "\\penalty0  + ".join(terms) + r"}{y}}"
    assert "hangindent" in written_out(whole)


def test_words_that_do_not_fit_beside_a_formula_stand_around_it() -> None:
    """A noted condition was a paragraph of hangindents and penalties, which nobody can edit."""
    noted = (
        r"\longformula[p:c]{\text{minor 2 of K, reduced by those before} \colon\quad a\penalty0  + b > 0"
        r" \quad\penalty0 \text{(holds: the kinetic energy is positive definite, $M > 0$)}"
        r" \quad\penalty0 \text{(not needed)}}"
    )
    assert written_out(f"Conditions:\n\n{noted}\n{noted.replace('p:c', 'p:d')}").count("\\begin{equation}") == 2
    assert written_out(noted) == (
        "minor 2 of K, reduced by those before:\n\\begin{equation}\\label{p:c}\na + b > 0\n\\end{equation}\n"
        "(holds: the kinetic energy is positive definite, $M > 0$) (not needed)"
    )
    listed = (
        r"\longformula[p:e]{"
        + r",\quad \penalty0 ".join(rf"a_{k} = b_{k} c_{k}\penalty0  + d_{k}" for k in range(4))
        + "}"
    )
    rows = written_out(listed).split("\n")
    assert rows[1:3] == [r"\begin{aligned}", r"a_0 &= b_0 c_0 + d_0, \\"]
    assert written_out("is\n\n\\longformula[p:a]{a < b}").startswith("is\n\\begin{equation}")


def test_an_intermediate_quantity_is_defined_once_in_a_document_and_in_every_fragment() -> None:
    """The angular velocities of the satellite stood in problems 1, 2 and 3 of one appendix."""
    analysis = mbsym.load(SHIPPED / "satellite.yaml")
    defined = re.compile(r"displaystyle (\\(?:Omega|omega)_\{2 ,\d\}) =")
    for text in (render(analysis, (1, 2, 3)), str(TARGETS["latex"].render(analysis, (1, 2, 3)))):
        assert sorted(defined.findall(text)) == sorted(set(defined.findall(text))) != []
    alone = [set(defined.findall(fragment(analysis, (1, 2, 3), "x", "x", number))) for number in (1, 2, 3)]
    assert alone[0]
    assert alone[0] == alone[1] == alone[2]


@pytest.mark.parametrize(("label", "written"), [("Sat_2.b", "Sat_2.b"), ("my satellite:", "my-satellite"), ("", "top")])
def test_the_label_of_a_description_stands_in_every_label(label: str, written: str) -> None:
    system = replace(mbsym.load(SHIPPED / "simple-pendulum.yaml").system, name="Top", label=label)
    assert prefix_of(system) == f"mbsym:{written}:"


@pytest.mark.parametrize(
    "path",
    [
        SHIPPED / "satellite-with-damper-slow.yaml",  # a refuted condition, on the first page
        TESTS / "cases" / "hostile" / "ht.yaml",  # coordinates that move together
        SHIPPED / "orbital-gyrostat.yaml",  # which condition of problem 6 a claimed one is
    ],
    ids=lambda path: path.stem,
)
def test_no_formula_stands_as_text_among_words(path: Path) -> None:
    """``condition (Lambda + omega)*(Lambda - omega)**2 > 0`` stood on the first page as it is typed."""
    text = TARGETS["latex"].render(mbsym.load(path), (4, 5, 6, 7))
    assert isinstance(text, str)
    words = re.sub(
        r"(?s)\\begin\{(tikzpicture|gather|equation|align|multline)\*?\}.*?\\end\{\1\*?\}|\$[^$]*\$", "", text
    )
    words = words.partition("\\begin{document}")[2]
    assert "condition" in words or "move together" in words
    words = words.partition("For example at")[0]  # numbers by name
    assert not re.findall(r"[\w)]\*+[\w(]|\\_dot", re.sub(r"\\(new)?line\*?|\\section\*", "", words))


@pytest.mark.parametrize("name", ["racket-no-result-in-this-rotation-order", "bead_on_hoop", "never_hurwitz"])
def test_a_theorem_that_is_cited_is_one_that_decides(name: str) -> None:
    """Of a case that is not told, as its condition never holds, the literature was cited all the same."""
    text = str(TARGETS["latex"].render(mbsym.load(TESTS / "cases" / "statements" / f"{name}.yaml"), (4, 5, 6)))
    words, _, cited = " ".join(text.split()).partition("On the theorems: ")
    theorems = re.findall(r"([^;~]+)~", cited.partition(".")[0])
    assert theorems
    assert [x for x in map(str.strip, theorems) if f"{x})" not in words and f"{x}," not in words] == []


def test_a_short_bracket_is_not_broken_while_something_else_can_be() -> None:
    first, second = r"4 w_{0} (A - C) - J (2 w_{0} + s)", r"2 w_{0} (B - C) - J (w_{0} + 2 s)"
    shown = display(rf"v_{{0}} = 2 w_{{0}}^{{2}} \bigl[{first}\bigr] \bigl[{second}\bigr]", "v")
    assert shown.startswith(r"\begin{multline}")
    for short in ("(A - C)", "(2 w_{0} + s)", "(B - C)", "(w_{0} + 2 s)"):
        assert short in shown
    # What is one short bracket and too wide for nothing else is broken in it after all.
    names = " + ".join(f"x_{{{k}}}" for k in range(40))
    assert len(display(f"y = ({names})").split("\n")) > 3
