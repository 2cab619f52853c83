"""Content in LaTeX: one method a kind of value."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import singledispatchmethod
from typing import Any

from mbsym.formulas.formula import Formula
from mbsym.formulas.latex import LatexNames, latex_matrix, latex_names, latex_symbol
from mbsym.report import content
from mbsym.report.content import Inline, Said
from mbsym.report.language import Language
from mbsym.report.latex import formulas
from mbsym.report.latex.description import breakable, expression, points, speed_form
from mbsym.report.latex.form import Form, heading, subheading
from mbsym.report.latex.formulas import Measured, measured_matrix
from mbsym.report.latex.labels import Labels
from mbsym.report.latex.told import paragraphs
from mbsym.report.latex.words import RELATIONS, escaped, prose
from mbsym.report.unit_text import bracketed

_DOTS = ("", "dot", "ddot")


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
        text = self.language.sentence(sentence.text)
        return "$".join(self._filled(piece, sentence, bool(k % 2)) for k, piece in enumerate(text.split("$")))

    def _filled(self, text: str, sentence: Said, inside: bool) -> str:
        return re.sub(r"\[\[(\w+)\]\]", lambda m: self._gap(sentence.gaps[m[1]], inside), text)

    def _gap(self, value: Inline | Sequence[Inline], inside: bool) -> str:
        if isinstance(value, Sequence) and not isinstance(value, str):
            return ", ".join(self._gap(x, inside) for x in value)
        return self.math(value) if inside and not isinstance(value, str) else self.inline(value)

    @singledispatchmethod
    def inline(self, value: Any) -> str:
        """What stands in a line; mathematics between dollars."""
        return breakable(self.math(value))

    @inline.register
    def _(self, value: str) -> str:
        return escaped(value) if value.strip() == value else re.sub(r"\S.*\S|\S", lambda m: escaped(m[0]), value)

    @inline.register
    def _(self, value: Said) -> str:
        return self.said(value)

    @inline.register
    def _(self, value: content.Words) -> str:
        said = self.language.say(value.text)
        return prose(said, latex_symbol(value.variable).stem) if value.variable else escaped(said)

    @inline.register
    def _(self, value: content.Strong) -> str:
        return f"\\textbf{{{self.inline(value.text)}}}"

    @inline.register
    def _(self, value: content.Phrase) -> str:
        return "".join(map(self.inline, value.parts))

    @inline.register
    def _(self, value: content.Emphasis) -> str:
        return f"\\textit{{{escaped(value.text)}}}"

    @inline.register
    def _(self, value: content.Verbatim) -> str:
        return f"\\texttt{{{escaped(value.text)}}}"

    @inline.register
    def _(self, value: content.Unit) -> str:
        return f"${bracketed(value.text)}$"

    @inline.register
    def _(self, value: content.Citation) -> str:
        return f"\\cite{{{value.key}}}" if self.form is Form.REPORT else escaped(value.text)

    # --- mathematics ---

    @singledispatchmethod
    def math(self, value: Any) -> str:
        """A value of mathematics, without dollars."""
        return expression(value, self.names)

    @math.register
    def _(self, value: int) -> str:
        return str(value)

    @math.register
    def _(self, value: str) -> str:
        return RELATIONS.get(value, value)

    @math.register
    def _(self, value: Formula) -> str:
        return formulas.formula(value, self.long)

    @math.register
    def _(self, value: content.Name) -> str:
        symbol = (self.names if value.ring is None else latex_names(value.ring))[value.name]
        written = symbol.accented(_DOTS[value.dots]) if value.dots else str(symbol)
        return f"{written}({value.at})" if value.at else written

    @math.register
    def _(self, value: content.Symbol) -> str:
        stem = latex_symbol(value.letter)
        written = stem.accented(_DOTS[value.dots]) if value.dots else str(stem)
        upper = f"^{{{_index(value.upper)}}}" if value.upper else ""
        return written + upper + (f"_{{{_index(value.lower)}}}" if value.lower else "")

    @math.register
    def _(self, value: content.Entry) -> str:
        whole = self.math(value.whole)
        index = value.index if isinstance(value.index, str) else self.math(value.index)
        return f"({whole})_{{{index}}}" if value.whole.lower else f"{whole}_{{{index}}}"

    @math.register
    def _(self, value: content.Notation) -> str:
        return value.tex

    @math.register
    def _(self, value: content.Number) -> str:
        return value.tex

    @math.register
    def _(self, value: content.Rows) -> str:
        return latex_matrix([list(map(self.math, row)) for row in value.rows])

    @math.register
    def _(self, value: content.Raised) -> str:
        return f"{{{self.math(value.of)}}}^{{({value.index})}}"

    @math.register
    def _(self, value: content.Listed) -> str:
        # Of equations each may stand in a line of its own.
        comma = ",\\, "
        if any(isinstance(x, content.Relation) for x in value.items):
            comma = ",\\quad \\penalty0 "
        elif value.brackets:
            comma = ",\\; \\allowbreak "
        written = comma.join(map(self.math, value.items))
        return f"({written})" if value.brackets else f"\\{{{written}\\}}" if value.braces else written

    @math.register
    def _(self, value: content.Relation) -> str:
        return " ".join(map(self.math, value.parts))

    @math.register
    def _(self, value: content.Polynomial) -> str:
        written = formulas.polynomial(value.coefficients, latex_symbol(value.variable).stem)
        return written if value.power == 1 else f"\\bigl[{written}\\bigr]^{{{value.power}}}"

    @math.register
    def _(self, value: content.SpeedForm) -> str:
        return speed_form(value.form, self.names, value.body)

    @math.register
    def _(self, value: content.Tensor) -> str:
        return formulas.tensor(value.rows, self.names, self.form.widest)

    @math.register
    def _(self, value: content.Points) -> str:
        return points(value.points, self.names)

    # --- blocks ---

    @singledispatchmethod
    def block(self, value: Any) -> str:
        """A block, with the empty lines that it needs around it."""
        raise TypeError(f"not a block: {value!r}")

    @block.register
    def _(self, value: content.Heading) -> str:
        return heading(self.labels, self.form, value.key, self.said(value.title)) + "\n"

    @block.register
    def _(self, value: content.Subheading) -> str:
        return subheading(self.form, "".join(map(self.inline, value.parts)))

    @block.register
    def _(self, value: content.Paragraph) -> str:
        written = "".join(map(self.inline, value.parts))
        return f"{{\\raggedright {written}\\par}}" if value.ragged else written + "\n"

    @block.register
    def _(self, value: content.Display) -> str:
        if isinstance(value.value, tuple):
            written = "".join(self._beside(x) for x in value.value)
        else:
            written = self.math(value.value)
        return self._display(written, value.key)

    @block.register
    def _(self, value: content.Matrices) -> str:
        if value.value.is_zero:
            return self._display(f"{self.math(value.symbol)} = 0", value.key)
        whole = formulas.matrix(value.value, self.long, self.form.widest, self.measured)
        if whole:
            label = self.labels.equation(value.key)
            return f"\\begin{{equation}}\\label{{{label}}}\n{self.math(value.symbol)} = {whole}\n\\end{{equation}}"
        return "\n".join(
            self._display(
                f"{self.math(content.Entry(value.symbol, index))} = {self.math(entry)}", f"{value.key}:{index}"
            )
            for index, entry in formulas.entries(value.value, value.symmetric)
        )

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
        title = self.said(value.title)
        if self.form is not Form.REPORT:
            return f"{title}: " + ";\n".join(", ".join(filter(None, row)) for row in rows) + ".\n"
        widths = [value.columns[k].width for k in shown]
        columns = "".join(f">{{\\raggedright\\arraybackslash}}p{{{x:g}cm}}" for x in widths)
        lines = [f"\\begin{{longtable}}{{@{{}}{columns}@{{}}}}"]
        lines += [f"\\multicolumn{{{len(shown)}}}{{@{{}}l}}{{\\textbf{{{title}}}}}\\\\"]
        lines += [" & ".join(row) + "\\\\" for row in rows]
        return "\n".join([*lines, "\\end{longtable}"])

    @block.register
    def _(self, value: content.Folded) -> str:
        return ""

    @block.register
    def _(self, value: content.Intermediates) -> str:
        return paragraphs(value.told, value.passages, lambda words: self.inline(content.Words(words))) + "\n"

    def _beside(self, value: Inline) -> str:
        """A part of a displayed line: words stand in it as text."""
        if isinstance(value, (str, Said, content.Words)):
            return f"\\text{{{self.inline(value)}}}"
        return self.math(value)

    def _display(self, written: str, key: str = "") -> str:
        label = f"[{self.labels.equation(key)}]" if key else ""
        return f"\\longformula{label}{{{written}}}"


def _component(symbol: content.Symbol, k: int) -> content.Symbol:
    return replace(symbol, lower=f"{symbol.lower},{k}")


def _index(text: str) -> str:
    """12, ij; O1 as O with index 1; commas with room behind."""
    nested = re.sub(r"([A-Z])(\d+)", r"\1_{\2}", text)
    return nested.replace(",", ",\\,")
