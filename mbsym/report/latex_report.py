"""What the LaTeX files show: the values and filters of their templates, and ``report.tex``, which stands alone."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from enum import StrEnum
from fractions import Fraction
from math import gcd
from typing import TYPE_CHECKING, Any

from flint import fmpq

from mbsym import __version__
from mbsym.expressions.tree import ZERO
from mbsym.formulas.formula import Column, Formula, Matrix
from mbsym.formulas.latex import LatexNames, latex_factor, latex_matrix, latex_names, latex_text
from mbsym.formulas.names import free_name
from mbsym.formulas.straight_line import Dialect, listing
from mbsym.model.quantities import rate_unit, unit_of
from mbsym.model.system import System, Tensor
from mbsym.problems.integrals import ENERGY
from mbsym.problems.linearisation import Subsystem
from mbsym.problems.stability import Stability
from mbsym.problems.stability.spectrum import Spectrum, numbers
from mbsym.problems.stability.word import Word
from mbsym.report.claims import claim_line, counterexample, repair, titles, together
from mbsym.report.compact import compact
from mbsym.report.conditions import Reference, Shown, cases, factors, provided, statements
from mbsym.report.environment import rendered
from mbsym.report.functions import moving
from mbsym.report.inertias import accepted_inertias
from mbsym.report.language import Language
from mbsym.report.latex_description import call, expression, load_in_words
from mbsym.report.latex_diagram import diagram
from mbsym.report.latex_displays import written_out
from mbsym.report.latex_labels import Labels, prefix_of
from mbsym.report.latex_references import keys_of, references, theorems_named
from mbsym.report.latex_told import packed, paragraphs
from mbsym.report.lengths import COUNTED, PAPER, PAPER_PROGRAM, not_printed, program_not_printed, withheld
from mbsym.report.programs import programs_of
from mbsym.report.unit_text import bracketed
from mbsym.source.meaning import meaning

if TYPE_CHECKING:
    from mbsym.analysis import Analysis

#: Matrices estimated wider than this (in ems) are written entry by entry.
WIDEST = 40
#: The same in a column of a two-column document, 229 pt in article, with an equation number beside it.
NARROW = 17
#: Longer lines of the file are broken: TeX reads whole lines into a buffer.
LINE = 400
#: Longer formulas are left to the machine-readable files: nobody reads them, and TeX's memory is finite.
LONGEST = 6000
#: Conditions with more terms than this are counted instead of written: what they say, they say in results.json.
LONGEST_CONDITION = 150


def _exact(value: Fraction) -> str:
    return str(value) if value.denominator == 1 else f"\\tfrac{{{value.numerator}}}{{{value.denominator}}}"


DIALECT = Dialect(call=call, local=lambda count: f"s_{{{count}}}", number=_exact, times=r"\,")


def render(analysis: Analysis, problems: Sequence[int]) -> str:
    """The text of ``report.tex``."""
    return filled("report.tex.j2", analysis, problems, Form.REPORT, figures=analysis.figures)


class Form(StrEnum):
    """Where a text is to stand: by itself on a wide page, or as a whole or in pieces in somebody's narrow column."""

    REPORT = "report"
    APPENDIX = "appendix"
    FRAGMENT = "fragment"

    @property
    def widest(self) -> float:
        """The widest matrix, in ems."""
        return WIDEST if self is Form.REPORT else NARROW

    @property
    def picture(self) -> float:
        """The widest picture, in cm."""
        return 15.0 if self is Form.REPORT else 7.6


def filled(template: str, analysis: Analysis, problems: Sequence[int], form: Form, **more: Any) -> str:
    """A template with the results of some problems; ``more`` are values besides."""
    from mbsym.analysis import PROBLEMS

    system = analysis.system
    names = latex_names(analysis.ring)
    printed = claimed_names(analysis)
    tongue = Language(analysis.language or system.language)
    labels = Labels(prefix_of(system.name))
    stages = {number: analysis.stage(number) for number in problems}
    found = {number: stage.value for number, stage in stages.items() if stage.failure is None}
    long = withheld([found[number] for number in COUNTED if number in found], PAPER)
    taken = {str(names[name]) for name in [*system.coordinates, *system.parameter_names]}
    taken |= {str(names[item.name]) for item in system.prescribed} | {str(names[item.name]) for item in system.notation}
    verdicts = found.get(6)
    cited = references(verdicts, escaped(system.source)) if form is not Form.FRAGMENT else ()
    text = rendered(
        template,
        {
            "tex": escaped,
            "say": tongue.say,
            "theorem": lambda name: escaped(tongue.say(name)),
            "name": lambda name: str(names[name]),
            "dotted": lambda name: names[name].accented("dot"),
            "math": lambda value: formula(value, long),
            "expression": lambda value: expression(value, names),
            "unit": lambda name, space="": bracketed(unit_of(system, name), space),
            "matrix": lambda value: matrix(value, long, form.widest),
            "tensor": lambda value: tensor(value, names, form.widest),
            "row": lambda values: row(values, long, form.widest),
            "entries": entries,
            "sum": polynomial,
            "condition": condition,
            "eigenvalues": eigenvalues,
            "label": lambda words: label(words, tongue.say),
            "refer": lambda reference: refer(reference, tongue.say),
            "load": lambda value: displayed(load_in_words(value, names, escaped, tongue)),
            "index": index,
            "displays": lambda part, k: displays(part, k, form.widest),
            "prose": prose,
            "claim_line": claim_line,
            "counterexample": lambda found: counterexample(found).replace("for", "For", 1),
            "together": together,
            "titles": titles,
            "printed": lambda value: expression(value, printed),
            "printed_name": lambda name: str(printed[name]),
            "same": lambda words: same(words, printed),
            "paragraphs": lambda item: paragraphs(
                item.system.told, item.passages, lambda words: escaped(tongue.say(words))
            ),
            "packed": lambda value, symbol, key: packed(entries(value, True), symbol, key),
            "zero": lambda values: all(x.is_zero for x in values),
        },
        tr=tongue.sentence,
        # No filter: Jinja computes filters of constants when it compiles a template, and keeps what it compiled.
        eq=labels.equation,
        heading=lambda key, title: _heading(labels, form, key, title),
        subheading=lambda title: _subheading(form, title),
        wide=form is Form.REPORT,
        summarised=form is Form.REPORT,
        prefix=labels.prefix,
        version=__version__,
        digest=meaning(system),
        babel=tongue.babel,
        references=cited,
        literature=_literature(verdicts, tongue) if form is Form.REPORT else [],
        system=system,
        accepted=accepted_inertias(system),
        numbers={"0": 0} | {body.name: k for k, body in enumerate(system.bodies, start=1)},
        moving=moving,
        found=found,
        told=compact(analysis, {number: found.get(number) for number in problems}),
        parts=[f"latex/{PROBLEMS[number].attribute}.j2" for number in problems],
        problems=problems,
        failures={number: stage.failure for number, stage in stages.items() if stage.failure is not None},
        code=_code(analysis, names) if 3 in stages and 3 not in found else None,
        statements=statements,
        cases=cases,
        Shown=Shown,
        rate=bracketed(rate_unit(system), "\\;\\penalty0 "),
        relations=_RELATIONS,
        variable="\\lambda" if "\\lambda" not in taken else free_name("\\hat{\\lambda}", taken),
        characteristic="\\Lambda" if "\\Lambda" not in taken else free_name("\\hat{\\Lambda}", taken),
        factors=factors,
        provided=provided(len(analysis.equilibrium.conditions)) if verdicts is not None else "",
        DEPENDS=Word.DEPENDS,
        ENERGY=ENERGY,
        decided=decided,
        claims=analysis.claims,
        outcomes=Counter(claim_line(result).word for result in analysis.claims),
        repair=repair,
        checks=analysis.checks,
        diagram=lambda: diagram(system, names, escaped, tongue.sentence("inertial frame"), form.picture),
        cyrillic=tongue.name == "ru" or _is_cyrillic(system),
        **more,
    )
    text = text if form is Form.REPORT else written_out(_set_apart(text))
    return "\n".join(map(broken, _spared(text).split("\n")))


def displayed(words: str) -> str:
    """Formulas of a sentence that stand by themselves, as the others do."""
    return re.sub(r"\\\[ (.*?) \\\]", lambda m: f"\\longformula{{{m[1]}}}", words)


def _heading(labels: Labels, form: Form, key: str, title: str) -> str:
    match form:
        case Form.REPORT:
            return f"\\section*{{{title}}}\\addcontentsline{{toc}}{{subsection}}{{{title}}}"
        case Form.APPENDIX:
            kind = "subsection" if key else "section"
            return f"\\{kind}{{{title}}}\\label{{{labels.section(key)}}}"
    return ""


def _subheading(form: Form, title: str) -> str:
    if form is Form.REPORT:
        return f"\\subsection*{{{title}}}"
    return f"\\par\\medskip\\noindent\\textbf{{{title}}}\\par\\nopagebreak"


def _literature(found: Stability | None, tongue: Language) -> list[tuple[str, str]]:
    """(name, keys) of each theorem that problem 6 names."""
    named = [] if found is None else dict.fromkeys(theorems_named(found))
    return [(escaped(tongue.say(name)), ",".join(keys_of(name))) for name in named if keys_of(name)]


def _set_apart(text: str) -> str:
    """What stands in anyone's document: paragraphs without indentation, and everything is as it was afterwards."""
    head = "".join(f"{line}\n" for line in text.split("\n") if line.startswith("%"))
    body = "\n".join(line for line in text.split("\n") if not line.startswith("%"))
    looks = r"\raggedright\raggedbottom\emergencystretch=3em \parskip=2pt plus 3pt"
    return f"{head}\\begingroup{looks}\n{body.strip()}\n\\par\\endgroup\n"


def _spared(text: str) -> str:
    """One empty line where there are several."""
    return re.sub(r"\n{3,}", "\n\n", text)


def _is_cyrillic(system: System) -> bool:
    texts = [system.name, system.description, system.source, *(item.meaning for item in system.parameters)]
    texts += [item.meaning for item in system.prescribed] + [body.name for body in system.bodies]
    texts += [claim.place for claim in system.claims]
    return any("\u0400" <= c <= "\u045f" for text in texts for c in text)


def decided(found: Stability) -> str:
    """How the verdict at given values was found, if it is one: irrational values have enclosures."""
    if found.numerical is None or found.numerical.word == Word.UNDECIDED:
        return ""
    enclosed = any(part.theory.at_point is None for part in found.subsystems)
    return ", decided by rigorous enclosures" if enclosed else ", decided exactly"


_RELATIONS = {"!=": r"\neq", ">=": r"\geq", "<=": r"\leq"}

# --- text ---

_SPECIAL = {
    "\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "$": r"\$", "&": r"\&", "#": r"\#", "%": r"\%", "_": r"\_",
    "^": r"\^{}", "~": r"\~{}", "<": r"\textless{}", ">": r"\textgreater{}", "|": r"\textbar{}", '"': "''",
}  # fmt: skip


def escaped(words: str) -> str:
    """Plain text; characters that plain pdflatex cannot set become question marks."""
    plain = "".join(_SPECIAL.get(c, c if _can_be_set(c) else "?") for c in " ".join(words.split()))
    return plain.replace("--", "-{}-")


def _can_be_set(character: str) -> bool:
    """Whether inputenc knows it for Latin or Cyrillic letters."""
    return character < "\u0100" or "\u0410" <= character <= "\u044f" or character in "\u0401\u0451"


def broken(line: str) -> str:
    """A line of the file as several, where it is long: to TeX the end of a line is a space."""
    if len(line) <= LINE or line.startswith("%"):
        return line
    pieces: list[str] = []
    size = LINE + 1
    for word in line.split(" "):
        # A backslash before a space belongs to it, and no line may be empty: that would end the paragraph.
        if size + len(word) > LINE and word.strip() and not (pieces and pieces[-1].endswith("\\")):
            pieces.append(word)
            size = len(word)
        elif pieces:
            pieces[-1] += " " + word
            size += 1 + len(word)
    return "\n".join(pieces)


def refer(reference: Reference, say: Callable[[str], str] = str) -> str:
    """``v_4 < 0`` for a polynomial that was shown before."""
    under = f"{label(reference.label, say)} \\colon\\quad " if reference.under != reference.label else ""
    relation = _RELATIONS.get(reference.relation, reference.relation)
    return f"{under}{label(reference.under, say)} {relation} 0"


def prose(words: str) -> str:
    """Words of the stability kernel, with lambda as a symbol."""
    power = r"\blambda(\\\^\{\}(\d+))?"
    return re.sub(power, lambda m: rf"$\lambda^{{{m[2]}}}$" if m[1] else r"$\lambda$", escaped(words))


def label(words: str, say: Callable[[str], str] = str) -> str:
    """v6 as a coefficient's symbol, other labels as text, which ``say`` may put into another language."""
    opposite = re.fullmatch(r"-\((.*)\)", words)
    if opposite is not None:
        return "-" + label(opposite[1], say)
    bare, comma, part = words.partition(", ")
    match = re.fullmatch(r"([av])(\d+)( of factor (\d+))?", bare)
    if match is not None and comma:
        return label(bare) + f"\\text{{, {escaped(say(part))}}}"
    if match is None:
        return f"\\text{{{escaped(say(bare) + (f', {say(part)}' if comma else ''))}}}"
    raised = f"^{{({match[4]})}}" if match[4] else ""
    return f"{match[1]}_{{{match[2]}}}{raised}"


# --- formulas ---


def formula(value: Formula, long: frozenset[int] = frozenset()) -> str:
    """A formula that may be broken; one that is too long for paper, or is among the ``long`` ones, is only counted."""
    if value.terms > LONGEST or id(value) in long:
        return f"\\text{{({not_printed(value)})}}"
    return latex_text(value.ring, value.polynomial, breaks=True)


def condition(value: Formula, in_json: bool = True) -> str:
    """A polynomial of problem 6; a long one is only counted, and ``in_json`` tells where it is."""
    return counted(value, in_json) or formula(value)


def counted(value: Formula, in_json: bool = True) -> str:
    """How long a polynomial is that nobody would read; "" for any other."""
    if value.terms <= LONGEST and len(re.findall(r" [+-] ", formula(value))) < LONGEST_CONDITION:
        return ""
    degree = max(map(sum, value.polynomial.monoms()))
    where = "; in full in results.json" if in_json else ""
    return f"\\text{{({value.terms} terms, of degree {degree}{where})}}"


def width(latex: str) -> float:
    """A rough estimate in ems."""
    letters = re.sub(r"\\(frac|left|right|bigl|bigr|Bigl|Bigr|dot|ddot|mathrm|mathit|penalty\d+)", "", latex)
    functions = len(re.findall(r"\\(sin|cos|exp|ln)", letters))
    symbols = re.sub(r"\\[A-Za-z]+|[A-Za-z0-9]", "x", letters)
    return 0.55 * symbols.count("x") + functions + 1.3 * len(re.findall(r" [+-] ", symbols))


def matrix(value: Matrix, long: frozenset[int] = frozenset(), widest: float = WIDEST) -> str:
    """A pmatrix, or nothing if that would be too wide or holds one of the ``long`` formulas."""
    return "" if any(id(x) in long for row in value for x in row) else _matrix(value, widest)[0]


def _matrix(value: Matrix, widest: float) -> tuple[str, float]:
    """The pmatrix and its width."""
    if any(x.terms > 60 for row in value for x in row):
        return "", 0.0
    number = _common_number(value)
    if number > 1:
        value = Matrix.of(value[0, 0].ring, [[x * fmpq(1, number) for x in row] for row in value.polynomials])
    rows = [[x.latex() for x in row] for row in value]
    wide = sum(max(map(width, column)) + 1.2 for column in zip(*rows, strict=True))
    text = latex_matrix(rows) if number == 1 else f"{number} {latex_matrix(rows)}"
    return (text, wide) if wide <= widest else ("", wide)


def _common_number(value: Matrix) -> int:
    """The whole number that stands in front of a matrix of several entries: 3 (b - a, f; f, f)."""
    entries = [x.polynomial for row in value for x in row if not x.is_zero]
    if len(entries) < 2:
        return 1
    coefficients = [c for x in entries for c in x.coeffs()]
    whole = all(c.q == 1 for c in coefficients)
    return gcd(*(int(c.p) for c in coefficients)) if whole else 1


def tensor(value: Tensor, names: LatexNames, widest: float) -> str:
    """A tensor of inertia; a wide one row by row."""
    if all(value[i][j] == ZERO for i in range(3) for j in range(3) if i != j):
        return "\\operatorname{diag}(" + ",\\; ".join(expression(value[k][k], names) for k in range(3)) + ")"
    rows = [[expression(x, names) for x in one] for one in value]
    if sum(max(map(width, column)) + 1.2 for column in zip(*rows, strict=True)) <= widest:
        return latex_matrix(rows)
    return "(" + ";\\; \\penalty0 ".join(",\\; ".join(one) for one in rows) + ")"


def displays(part: Subsystem, k: object, widest: float = WIDEST) -> list[str]:
    """The matrices of a subsystem that are not zero and not too wide, side by side where they fit."""
    lines: list[str] = []
    room = 0.0
    for name in "MDGKN":
        value: Matrix = getattr(part, name)
        text, wide = ("", 0.0) if value.is_zero else _matrix(value, widest)
        if not text:
            continue
        needed = wide + 6
        shown = f"{name}{index(k)} = {text}"
        if needed <= room:
            lines[-1] += f",\\quad {shown}"
        else:
            lines.append(shown)
            room = widest
        room -= needed
    return lines


def index(k: object) -> str:
    return f"_{{{k}}}" if k else ""


def row(values: Column, long: frozenset[int] = frozenset(), widest: float = WIDEST) -> str:
    """Components side by side, or nothing if that would be too wide or holds one of the ``long`` formulas."""
    if any(id(x) in long for x in values):
        return ""
    written = [x.latex() if x.terms <= 30 else "" for x in values]
    fits = all(written) and sum(map(width, written)) <= widest
    return ",\\; ".join(written) if fits else ""


def entries(value: Matrix, symmetric: bool = False) -> list[tuple[str, Formula]]:
    """(index, entry) of what is not zero; of a symmetric matrix the upper half."""
    n = len(value.rows)
    comma = "," if n > 9 else ""
    return [
        (f"{i + 1}{comma}{j + 1}", entry)
        for i, row in enumerate(value)
        for j, entry in enumerate(row)
        if not entry.is_zero and (j >= i or not symmetric)
    ]


def polynomial(coefficients: Sequence[Formula], variable: str) -> str:
    """sum of coefficient*variable^k, highest power first."""
    written: list[str] = []
    for power, coefficient in reversed(list(enumerate(coefficients))):
        if coefficient.is_zero:
            continue
        raised = "" if power == 0 else f" {variable}" if power == 1 else f" {variable}^{{{power}}}"
        if length := counted(coefficient):
            written.append(" \\penalty0 " + ("+ " if written else "") + length + raised)
            continue
        if raised:
            text = latex_factor(coefficient.ring, coefficient.polynomial, breaks=True)
        else:
            text = formula(coefficient)
        written.append(" \\penalty0 " + ("" if text.startswith("-") or not written else "+ ") + text + raised)
    return "".join(written) or "0"


def eigenvalues(spectrum: Spectrum) -> str:
    """``-0.1 \\pm 2.3\\,\\mathrm{i}``, separated by commas; six digits."""
    written = []
    for root in numbers(spectrum):
        real, imaginary = (scientific(x) for x in (root.real, root.imaginary))
        text = real if not root.imaginary else f"{real if root.real else ''}\\pm {imaginary}\\,\\mathrm{{i}}"
        written.append(text if root.multiplicity == 1 else f"{text}\\ ({root.multiplicity}\\times)")
    return ",\\; \\penalty0 ".join(written)


def scientific(value: float) -> str:
    digits, _, exponent = f"{value:.6g}".partition("e")
    return f"{digits}\\cdot 10^{{{int(exponent)}}}" if exponent else digits


def claimed_names(analysis: Analysis) -> LatexNames:
    """The names of the system, and those of a publication's abbreviations besides."""
    kinds = ("coordinate", "prescribed", "parameter")
    own = ["t", *(g.name for g in analysis.ring.generators if g.kind in kinds)]
    variables = [claim.variable for claim in analysis.system.claims if claim.variable]
    given = {one.name: one.latex for one in analysis.system.symbols}
    return LatexNames([*own, *(item.name for item in analysis.system.abbreviations), *variables], given)


def same(words: str, names: LatexNames) -> str:
    """``-2*c18``: a number and an abbreviation."""
    number, star, name = words.rpartition("*")
    sign = "-" if not star and name.startswith("-") else ""
    bare = str(names[name.removeprefix("-")])
    return f"{number}\\, {bare}" if star else sign + bare


def _code(analysis: Analysis, names: LatexNames) -> Any:
    """Mass matrix and forcing as a straight-line program; None if there is none."""
    system, (programs, _) = analysis.system, programs_of(analysis)
    if programs is None:
        return None
    symbols = {name: str(names[name]) for name in programs.environment if name != "pi"} | {"pi": r"\pi"}
    for name in system.coordinates:
        symbols[name + "_dot"] = names[name].accented("dot")
        symbols[name + "_ddot"] = names[name].accented("ddot")
    n = len(system.coordinates)
    upper = [(i, j) for i in range(n) for j in range(i, n)]
    nodes = [programs.mass_matrix[i][j] for i, j in upper]
    body = listing(programs.program, [*nodes, *programs.forcing], symbols, DIALECT)
    if len(body.assignments) > PAPER_PROGRAM:
        return [f"\\text{{({program_not_printed(len(body.assignments))})}}"]
    comma = "," if n > 9 else ""
    lines = [f"{name} = {text}" for name, text in body.assignments]
    lines += [f"M_{{{i + 1}{comma}{j + 1}}} = {text}" for (i, j), text in zip(upper, body.results, strict=False)]
    lines += [f"f_{{{i + 1}}} = {text}" for i, text in enumerate(_tail(body.results, len(upper)))]
    return lines


def _tail(items: Iterable[str], start: int) -> list[str]:
    return list(items)[start:]
