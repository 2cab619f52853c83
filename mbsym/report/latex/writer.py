"""Content in LaTeX: one method a kind of value."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from fractions import Fraction
from functools import singledispatchmethod
from itertools import groupby
from typing import Any

from mbsym.expressions.message import GAP, Message, Said, pieces
from mbsym.expressions.tree import Expression
from mbsym.formulas.formula import Formula
from mbsym.formulas.latex import LatexNames, latex_matrix, latex_symbol, latex_text
from mbsym.formulas.straight_line import Dialect, short_listing
from mbsym.formulas.told import Told
from mbsym.model.system import System
from mbsym.picture.sketch import Dot, Mark, Sketch
from mbsym.report import content
from mbsym.report.content import Inline
from mbsym.report.language import Language
from mbsym.report.latex import formulas
from mbsym.report.latex.description import breakable, call, expression, points, speed_form
from mbsym.report.latex.displays import loosened
from mbsym.report.latex.formulas import Measured, measured_matrix
from mbsym.report.latex.labels import Form, Labels, heading, subheading
from mbsym.report.lengths import PAPER_PROGRAM, length, not_printed, program_not_printed
from mbsym.report.unit_text import bracketed
from mbsym.report.words.passages import Passage

#: A centimetre of a drawing on paper.
DRAWN = 0.85

_DOTS = ("", "dot", "ddot")
_LOOKS = {"bar": "bar", "script": "mathcal"}


def _exact(value: Fraction) -> str:
    return str(value) if value.denominator == 1 else f"\\tfrac{{{value.numerator}}}{{{value.denominator}}}"


_DIALECT = Dialect(call=call, local=lambda count: f"s_{{{count}}}", number=_exact, times=r"\,")


@dataclass(frozen=True)
class Writer:
    """``names`` of the system; formulas among the ``long`` ones, by their identity, are counted."""

    names: LatexNames
    language: Language
    labels: Labels
    form: Form
    long: frozenset[int] = frozenset()
    measured: Measured = measured_matrix

    def document(self, blocks: Iterable[content.Block]) -> str:
        """The blocks one after the other."""
        return "\n".join(map(self.block, blocks))

    # --- text ---

    def said(self, sentence: Said) -> str:
        """A sentence in the language of the report, with its gaps filled."""
        parts = pieces(self.language.text_of(sentence))
        return "".join(f"${self._filled(x, sentence, True)}$" if k else self._filled(x, sentence) for k, x in parts)

    def _filled(self, text: str, sentence: Said, inside: bool = False) -> str:
        parts = enumerate(GAP.split(text))
        return "".join(self._gap(sentence.gaps[x], inside) if k % 2 else x if inside else _spaced(x) for k, x in parts)

    def _gap(self, value: Inline | Sequence[Inline], inside: bool) -> str:
        if isinstance(value, Sequence) and not isinstance(value, str):
            return ", ".join(self._gap(x, inside) for x in value)
        return self.math(value) if inside and not isinstance(value, str) else self.inline(value)

    def inline(self, value: Any) -> str:
        """What stands in a line; mathematics between dollars."""
        match value:
            case Said() | Message():
                return self.said(value)
            case content.Under():
                return f"\\hspace*{{1em}}{self.inline(content.Phrase(value.parts))}"
            case str():
                return _spaced(self.language.say(value) if isinstance(value, StrEnum) else value)
            case content.Numbered():
                return f"~\\eqref{{{self.labels.of(value.key)}}}"
            case content.Phrase():
                return self._joined(value.parts)
            case content.Strong():
                return f"\\textbf{{{self.inline(value.text)}}}"
            case content.Graded():
                return self.inline(content.Strong(value.text) if value.grade == "bad" else value.text)
            case content.Link():
                return self.inline(value.text)
            case content.Elsewhere():
                return self.inline(value.link)
            case content.Emphasis():
                return f"\\textit{{{escaped(value.text)}}}"
            case content.Verbatim():
                return f"\\texttt{{{escaped(value.text)}}}"
            case content.Unit():
                return f"${bracketed(value.text)}$"
            case content.Citation():
                return f"\\cite{{{value.key}}}" if self.form is Form.REPORT else escaped(value.text)
        return breakable(self.math(value))

    # --- mathematics ---

    def math(self, value: Any) -> str:
        """A value of mathematics, without dollars."""
        match value:
            case int():
                return str(value)
            case str():
                return "\\penalty0 +" if value == "+" else RELATIONS.get(value, value)
            case Formula():
                if value.terms > formulas.LONGEST or id(value) in self.long:
                    return f"\\text{{({self.said(not_printed(value))})}}"
                return formulas.formula(value)
            case content.Name():
                symbol = (self.names if value.ring is None else LatexNames.of(value.ring))[value.name]
                written = symbol.accented(_DOTS[value.dots]) if value.dots else str(symbol)
                return f"{written}({value.at})" if value.at else written
            case content.Symbol():
                stem = latex_symbol(value.letter)
                accent = _DOTS[value.dots] or _LOOKS.get(value.look, "")
                written = stem.accented(accent) if accent else str(stem)
                lower = f"_{{{_index(value.lower)}}}" if value.lower else ""
                return written + lower + (f"^{{{_index(value.upper)}}}" if value.upper else "")
            case content.Entry():
                whole = self.math(value.whole)
                index = value.index if isinstance(value.index, str) else self.math(value.index)
                return f"({whole})_{{{index}}}" if value.whole.lower else f"{whole}_{{{index}}}"
            case content.Notation() | content.Number():
                return value.tex
            case content.Rows():
                return latex_matrix([list(map(self.math, row)) for row in value.rows])
            case content.Raised():
                return f"{{{self.math(value.of)}}}^{{({value.index})}}"
            case content.Power():
                return f"{self.math(value.base)}^{{{value.exponent}}}"
            case content.Text():
                return f"\\text{{{self._joined(value.parts)}}}"
            case content.Readable():
                if formulas.is_readable(value.value):
                    return self.math(value.value)
                return self._length(value.value, value.kept)
            case content.Listed():
                # Of equations each may stand in a line of its own.
                comma = ",\\, "
                if any(isinstance(x, content.Relation) for x in value.items):
                    comma = ",\\quad \\penalty0 "
                elif value.brackets:
                    comma = ",\\; \\allowbreak "
                written = comma.join(map(self.math, value.items))
                return f"({written})" if value.brackets else f"\\{{{written}\\}}" if value.braces else written
            case content.Relation():
                written = " ".join(map(self.math, value.told))
                return f"-{written[2:]}" if written.startswith("- ") else written
            case content.Polynomial():
                written = formulas.polynomial(value.coefficients, latex_symbol(value.variable).stem, self._length)
                return written if value.power == 1 else f"\\bigl[{written}\\bigr]^{{{value.power}}}"
            case content.SpeedForm():
                return speed_form(value.form, self.names, value.body)
            case content.Tensor():
                return formulas.tensor(value.rows, self.names, self.form.widest)
            case content.Points():
                return points(value.points, self.names)
        return expression(value, self.names)

    # --- blocks ---

    @singledispatchmethod
    def block(self, value: Any) -> str:
        """A block, with the empty lines that it needs around it."""
        raise TypeError(f"not a block: {value!r}")

    @block.register
    def _(self, value: content.Heading) -> str:
        self.labels.begin(value.key)
        return heading(self.labels, self.form, value.key, self.said(value.title)) + "\n"

    @block.register
    def _(self, value: content.Subheading) -> str:
        return subheading(self.form, self._joined(value.parts))

    @block.register
    def _(self, value: content.Paragraph) -> str:
        written = self._joined(value.parts)
        return f"{{\\raggedright {written}\\par}}" if value.ragged else written + "\n"

    @block.register
    def _(self, value: content.Display) -> str:
        if isinstance(value.value, tuple):
            written = "".join(self._beside(x) for x in value.value)
        else:
            written = self.math(value.value)
        if isinstance(value.value, Expression):  # as it was printed, without places where it may be broken
            written = loosened(written)
        notes = "".join(f" \\quad\\penalty0 \\text{{({self.inline(note)})}}" for note in value.notes)
        return self._display(written + notes, value.key)

    @block.register
    def _(self, value: content.Definitions) -> str:
        written = "; ".join(f"$\\displaystyle {loosened(self.math(item))}$" for item in value.items)
        return f"{OPENING}{PARAGRAPH}{self.said(value.words)}: {written}.{CLOSING}}}\n"

    @block.register
    def _(self, value: content.Matrices) -> str:
        if value.value.is_zero:
            return self._display(f"{self.math(value.symbol)} = 0", value.key)
        if value.packed:
            entries = value.entries()
            return packed(entries, self.math(value.symbol), self.labels.equation(value.key))
        whole = formulas.matrix(value.value, self.long, self.form.widest, self.measured)
        if whole:
            label = self.labels.equation(value.key)
            return f"\\begin{{equation}}\\label{{{label}}}\n{self.math(value.symbol)} = {whole}\n\\end{{equation}}"
        return "\n".join(
            self._display(
                f"{self.math(content.Entry(value.symbol, index))} = {self.math(entry)}", f"{value.key}:{index}"
            )
            for index, entry in value.entries()
        )

    @block.register
    def _(self, value: content.SideBySide) -> str:
        lines: list[str] = []
        others: list[str] = []
        room = 0.0
        for matrix in value.matrices:
            whole = (
                ""
                if matrix.value.is_zero
                else formulas.matrix(matrix.value, self.long, self.form.widest, self.measured)
            )
            if not whole:
                others.append(self.block(matrix))
                continue
            needed = self.measured(matrix.value)[1] + 6  # the width of the name and what is around it
            shown = f"{self.math(matrix.symbol)} = {whole}"
            if needed <= room:
                lines[-1] += f",\\quad {shown}"
            else:
                lines.append(shown)
                room = self.form.widest
            room -= needed
        labels = [self.labels.equation(f"{value.key}:matrices:{k}") for k in range(1, len(lines) + 1)]
        together = [
            f"\\begin{{equation}}\\label{{{label}}}\n{line}\n\\end{{equation}}"
            for label, line in zip(labels, lines, strict=True)
        ]
        return "\n".join([*together, *others])

    @block.register
    def _(self, value: content.Components) -> str:
        symbol = self.math(value.symbol)
        if all(x.is_zero for x in value.value):
            return self._display(f"{symbol} = 0", value.key)
        row = formulas.row(value.value, self.long, self.form.widest)
        if row:
            return self._display(f"{symbol} = ({row})", value.key)
        return "\n".join(
            self._display(f"{self.math(_component(value.symbol, k))} = {self.math(entry)}", f"{value.key}:{k}")
            for k, entry in enumerate(value.value, start=1)
        )

    @block.register
    def _(self, value: content.Itemised) -> str:
        items = [self.document(item).strip() for item in value.items]
        if value.numbered:
            return "\n\n".join(f"{{\\raggedright {k}. {text}\\par}}" for k, text in enumerate(items, start=1)) + "\n"
        listed = "\n".join(f"\\item {text}" for text in items)
        return f"\\begin{{itemize}}\\setlength{{\\itemsep}}{{1pt}}\n{listed}\n\\end{{itemize}}"

    @block.register
    def _(self, value: content.Table) -> str:
        shown = [k for k, column in enumerate(value.columns) if column.width]
        rows = [["".join(map(self.inline, row[k])) for k in shown] for row in value.rows]
        title = "" if value.title is None else self.said(value.title)
        if self.form is not Form.REPORT and not title:
            return "\n".join(", ".join(filter(None, row[:-1])) + f": {row[-1]}.\n" for row in rows)
        if self.form is not Form.REPORT:
            return f"{title}: " + ";\n".join(", ".join(filter(None, row)) for row in rows) + ".\n"
        widths = [value.columns[k].width for k in shown]
        columns = "".join(f">{{\\raggedright\\arraybackslash}}p{{{x:g}cm}}" for x in widths)
        lines = [f"\\begin{{longtable}}{{@{{}}{columns}@{{}}}}"]
        if title:
            lines += [f"\\multicolumn{{{len(shown)}}}{{@{{}}l}}{{\\textbf{{{title}}}}}\\\\\\midrule"]
        else:
            lines += [
                "\\toprule",
                " & ".join(self.inline(value.columns[k].title) for k in shown) + r"\\\midrule\endhead",
            ]
        lines += [" & ".join(row) + "\\\\" for row in rows]
        return "\n".join([*lines, "\\bottomrule", "\\end{longtable}"])

    @block.register
    def _(self, value: content.Facts) -> str:
        items = ""
        for fact in value.items:
            lines = ";\\newline ".join(map(self.inline, fact.lines)).replace(":;", ":")
            items += f"\\item {self.inline(fact.name)}: {lines.removesuffix('.')}.\n"
        return f"\\begin{{itemize}}\\setlength{{\\itemsep}}{{1pt}}\n{items}\\end{{itemize}}\n"

    @block.register
    def _(self, value: content.Cited) -> str:
        if self.form is not Form.REPORT:
            return ""
        written = "; ".join(f"{self.inline(words)}~\\cite{{{','.join(keys)}}}" for words, keys in value.items)
        return f"{self.said(value.words)}: {written}.\n"

    @block.register
    def _(self, value: content.Beside) -> str:
        return replace(self, names=self.names.beside(value.names)).document(value.blocks)

    @block.register
    def _(self, value: content.Lettered) -> str:
        written = self.document(value.blocks)
        return "\n".join(filter(None, (self.document(value.meanings()), written)))

    @block.register
    def _(self, value: content.Drawing) -> str:
        said = " ".join(map(self.said, value.caption))
        caption = f"\\par\\smallskip\n{{\\small {said}\\par}}\n" if said else ""
        return f"\\begin{{center}}\n{tikz(value.drawn, self.math, DRAWN)}\n{caption}\\end{{center}}\n"

    @block.register
    def _(self, value: content.Folded) -> str:
        return ""

    @block.register
    def _(self, value: content.Intermediates) -> str:
        return paragraphs(value.told, value.passages, self.inline) + "\n"

    @block.register
    def _(self, value: content.Steps) -> str:
        names = {name: self.math(item) for name, item in value.names.items()} | {"pi": r"\pi"}
        nodes = [node for _, node in value.results]
        body = short_listing(value.program, nodes, names, _DIALECT, PAPER_PROGRAM)
        if body is None:
            return self._display(f"\\text{{({self.said(program_not_printed(value.program, nodes))})}}")
        called = [(self.math(symbol), text) for (symbol, _), text in zip(value.results, body.results, strict=True)]
        return "\n".join(self._display(f"{left} = {right}") for left, right in [*body.assignments, *called])

    def _joined(self, parts: Iterable[Inline]) -> str:
        return "".join(map(self.inline, parts))

    def _length(self, value: Formula, in_full: bool = True) -> str:
        return f"\\text{{({self.said(length(value, in_full))})}}"

    def _beside(self, value: Inline) -> str:
        """A part of a displayed line: words stand in it as text."""
        if isinstance(value, (str, Said)):
            return f"\\text{{{self.inline(value)}}}"
        return self.math(value)

    def _display(self, written: str, key: str = "") -> str:
        label = self.labels.equation(key) if key else self.labels.next()
        return f"\\longformula[{label}]{{{written}}}"


def _spaced(words: str) -> str:
    """Plain text with the spaces around it."""
    return re.sub(r"\S(?:.*\S)?", lambda m: escaped(m[0]), words, flags=re.DOTALL)


def _component(symbol: content.Symbol, k: int) -> content.Symbol:
    return replace(symbol, lower=f"{symbol.lower},{k}")


def _index(text: str) -> str:
    """12, ij; O1 as O with index 1; commas with room behind."""
    nested = re.sub(r"([A-Z])(\d+)", r"\1_{\2}", text)
    return nested.replace(",", ",\\,")


#: How paragraphs of formulas are set: TeX breaks lines only where the formulas say so, before plus and minus.
OPENING = "{\\raggedright\\binoppenalty=10000 \\relpenalty=10000 \\linepenalty=200 \\lineskiplimit=1pt \\lineskip=4pt\n"
PARAGRAPH, CLOSING = "\\hangindent=1.2em \\hangafter=1 \\noindent ", "\\par\n"


def paragraphs(listing: Told[Any], passages: Iterable[Passage], escaped: Callable[[str], str]) -> str:
    """Every passage as a paragraph, in one group."""
    names = LatexNames.of(listing.ring)
    return OPENING + "".join(PARAGRAPH + _sentence(x, names, escaped) + CLOSING for x in passages) + "}"


def _sentence(passage: Passage, names: LatexNames, escaped: Callable[[str], str]) -> str:
    coordinate = f" ${names[passage.coordinate]}$" if passage.coordinate else ""
    formulas = [equation(str(names[item.name]), item.formula) for item in passage.definitions]
    return f"{escaped(passage.words)}{coordinate}: " + ";\\quad ".join(formulas) + "."


def equation(symbol: str, formula: Formula) -> str:
    """``$symbol = formula$``, which may be broken."""
    return f"$\\displaystyle {symbol} = {latex_text(formula.ring, formula.polynomial, breaks=True)}$"


def packed(entries: Iterable[tuple[str, Formula]], symbol: str, key: str) -> str:
    """Entries of a matrix, by their indices, side by side in one paragraph with one number, which ``key`` labels."""
    written = ";\\quad ".join(equation(f"{symbol}_{{{index}}}", entry) for index, entry in entries)
    number = f"\\refstepcounter{{equation}}\\label{{{key}}}%\n"
    return f"{OPENING}{PARAGRAPH}{number}{written}.\\quad\\hfill\\hbox{{(\\theequation)}}{CLOSING}}}"


# The drawing of a system as a TikZ picture, which a person can go on drawing in.


_STYLES = {
    "body": "line width=1.5pt",
    "solid": "line width=0.6pt",
    "guide": "line width=0.9pt",
    "thin": "line width=0.35pt",
    "hidden": "line width=0.35pt, dashed",
    "tint": "fill=black!8, fill opacity=0.8",
}


def tikz(sketch: Sketch, letter: Callable[[Any], str], scale: float) -> str:
    """A ``tikzpicture``; ``letter`` writes what stands beside the lines, without dollars."""
    drawn = [_command(how, list(marks)) for how, marks in groupby(sketch.marks, _how)]
    used = {word for how, _ in groupby(sketch.marks, _how) for word in how}
    styles = "".join(f",\n  {name}/.style={{{style}}}" for name, style in _STYLES.items() if name in used)
    lines = [
        f"\\begin{{tikzpicture}}[>=latex, line join=round, scale={scale:g}{styles}]",
        *drawn,
        *_letters(sketch, letter),
        "\\end{tikzpicture}",
    ]
    return "\n".join(lines)


def _place(place: tuple[float, float]) -> str:
    return f"({_number(place[0])},{_number(place[1])})"


def _number(value: float) -> str:
    return f"{value:.2f}".rstrip("0").rstrip(".") if abs(value) >= 0.005 else "0"


def _how(mark: Mark) -> tuple[str, ...]:
    """The options of the command that draws it."""
    if isinstance(mark, Dot):
        return (f"fill={'white' if mark.open else 'black'}",)
    tips = ["<->"] if mark.both else ["->"] if mark.arrow else []
    return (mark.ink.value, *(["tint"] if mark.tinted else []), *tips)


def _command(how: Sequence[str], marks: Sequence[Mark]) -> str:
    """Marks that are drawn alike, and follow each other, by one command; its comment says what they are."""
    of = " ".join(", ".join(dict.fromkeys(mark.of for mark in marks)).split())
    return f"% {of}\n\\draw[{', '.join(how)}] {' '.join(map(_drawn, marks))};"


def _drawn(mark: Mark) -> str:
    if isinstance(mark, Dot):
        return f"{_place(mark.place)} circle ({mark.radius:g})"
    if mark.smooth:
        cycle = " cycle" if mark.closed else ""
        return f"plot[smooth{cycle}] coordinates {{{' '.join(map(_place, mark.points))}}}"
    return " -- ".join(map(_place, mark.points)) + (" -- cycle" if mark.closed else "")


def _letters(sketch: Sketch, letter: Callable[[Any], str]) -> Iterator[str]:
    """All of one size by one path."""
    if sketch.letters:
        nodes = "\n  ".join(f"{_place(label.place)} node {{${letter(label.text)}$}}" for label in sketch.letters)
        yield f"\\draw[every node/.style={{inner sep=1pt, font=\\small}}] {nodes};"


# Words in LaTeX: plain text escaped, sentences, lines that are not too long.


#: Longer lines of the file are broken: TeX reads whole lines into a buffer.
LINE = 400
RELATIONS = {"!=": r"\neq", ">=": r"\geq", "<=": r"\leq", "+-": r"\pm", ":": r"\colon\quad"}

_SPECIAL = {
    "\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "$": r"\$", "&": r"\&", "#": r"\#", "%": r"\%", "_": r"\_",
    "^": r"\^{}", "~": r"\~{}", "<": r"\textless{}", ">": r"\textgreater{}", "|": r"\textbar{}", '"': "''",
}  # fmt: skip


def escaped(words: str) -> str:
    """Plain text; characters that plain pdflatex cannot set become question marks."""
    plain = "".join(map(spelled, " ".join(words.split())))
    return plain.replace("--", "-{}-").replace("\u2014", "---").replace("\u2013", "--")


def spelled(character: str) -> str:
    """A character of plain text, which inputenc has to know for Latin or Cyrillic letters."""
    known = character < "\u0100" or "\u0410" <= character <= "\u044f" or character in "\u0401\u0451\u2013\u2014"
    return _SPECIAL.get(character, character if known else "?")


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


def spared(text: str) -> str:
    """One empty line where there are several."""
    return re.sub(r"\n{3,}", "\n\n", text)


def is_cyrillic(system: System, word: str) -> bool:
    """Whether the report, whose language has that word, or what the description says has Cyrillic letters."""
    texts = [word, system.name, system.description, system.source, *(item.meaning for item in system.parameters)]
    texts += [item.meaning for item in system.prescribed] + [body.name for body in system.bodies]
    texts += [claim.place for claim in system.claims]
    return any("\u0400" <= c <= "\u045f" for text in texts for c in text)
