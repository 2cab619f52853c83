"""Content in HTML: one method a kind of value; mathematics is MathML."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import singledispatchmethod
from itertools import pairwise
from typing import Any, cast

from markupsafe import Markup, escape

from mbsym.expressions.message import GAP, Message, Said, pieces
from mbsym.formulas.formula import Formula
from mbsym.formulas.mathml import (
    MathNames,
    bracketed,
    letter,
    mathml_pieces,
    mi,
    mn,
    mo,
    mtext,
    notation,
    power,
    table,
)
from mbsym.formulas.mathml import row as bracketed_row
from mbsym.formulas.names import greek
from mbsym.formulas.straight_line import Dialect, short_listing
from mbsym.formulas.told import Told
from mbsym.picture.sketch import Dot, Mark, Place, Sketch
from mbsym.report import content
from mbsym.report.content import CONDITION, Inline, Math, say
from mbsym.report.html import formulas
from mbsym.report.html.description import expression, point_of_table, speed_form
from mbsym.report.html.formulas import RELATIONS, math
from mbsym.report.language import Language
from mbsym.report.latex.description import shown_points
from mbsym.report.lengths import PAPER_PROGRAM, length, not_printed, program_not_printed
from mbsym.report.plain_writer import Writer as PlainWriter
from mbsym.report.unit_text import labelled
from mbsym.report.words.passages import Passage

#: A formula in the text of no more letters and numbers stands in one line.
UNBROKEN = 10
#: So many values side by side stand in one line.
SIDE_BY_SIDE = 4
_DOTS = ("", "\u02d9", "\u00a8")
_PLAIN = PlainWriter()
_DIALECT = Dialect()
_SCRIPT = {"A": "\U0001d49c", "B": "\u212c", "C": "\U0001d49e", "D": "\U0001d49f"}
_SEPARATOR = '<mo separator="true">,</mo>'
_COMMA = f'{_SEPARATOR}<mspace width="0.3em"/>'


def _with_comma(written: Markup) -> Markup:
    """What stands before others in a list; no line begins with the comma behind a formula."""
    alone = written.startswith("<math") and written.count("<math") == 1
    return Markup('<span class="together">{},</span>' if alone else "{},").format(written)


@dataclass(frozen=True)
class Writer:
    """``names`` of the system; formulas among the ``long`` ones, by their identity, are counted.

    ``spelled``: formulas carry what other programs read.
    """

    names: MathNames
    language: Language
    long: frozenset[int] = frozenset()
    spelled: bool = False

    def document(self, blocks: Iterable[content.Block]) -> Markup:
        """The blocks one after the other; headings of sections are those of the page."""
        return Markup("\n").join(map(self.block, blocks))

    # --- text ---

    def said(self, sentence: Said) -> Markup:
        """A sentence in the language of the report, with its gaps filled."""
        return Markup("").join(
            self._notation(piece, sentence) if inside else self._plain(piece, sentence)
            for inside, piece in pieces(self.language.text_of(sentence))
        )

    def _plain(self, text: str, sentence: Said) -> Markup:
        parts = enumerate(GAP.split(text))
        return Markup("").join(self._gap(sentence.gaps[part]) if k % 2 else escape(part) for k, part in parts)

    def _gap(self, value: Inline | Sequence[Inline]) -> Markup:
        if isinstance(value, Sequence) and not isinstance(value, str):
            items = list(map(self._gap, value))
            return Markup(" ").join((*map(_with_comma, items[:-1]), *items[-1:]))
        return self.inline(value)

    def _notation(self, text: str, sentence: Said) -> Markup:
        """Notation with values in it: each stands in it as a letter first, which it then replaces."""
        gaps = GAP.findall(text)
        for k, gap in enumerate(gaps):
            text = text.replace(f"[[{gap}]]", chr(_FIRST + k), 1)
        written = notation(text)
        for k, gap in enumerate(gaps):
            value = sentence.gaps[gap]
            shown = mtext(self.inline(value).unescape()) if isinstance(value, str) else self.math(value)
            written = written.replace(mi(chr(_FIRST + k)), shown)
        return formulas.math(written)

    def inline(self, value: Any) -> Markup:
        """What stands in a line."""
        match value:
            case Said() | Message():
                return self.said(value)
            case content.Under():
                return Markup('<span class="under">{}</span>').format(self._joined(value.parts))
            case str():
                return escape(self.language.say(value) if isinstance(value, StrEnum) else value)
            case content.Strong():
                key = Markup(' id="{}"').format(value.key) if value.key else ""
                grade = Markup(' class="{}"').format(value.grade) if value.grade else ""
                return Markup("<strong{}{}>{}</strong>").format(key, grade, self.inline(value.text))
            case content.Graded():
                return Markup('<span class="{}">{}</span>').format(value.grade, self.inline(value.text))
            case content.Link():
                return Markup('<a href="#{}">{}</a>').format(value.to, self.inline(value.text))
            case content.Numbered():
                return Markup('<a class="there" href="#{}">\u00a0\u2193</a>').format(_anchor(value.key))
            case content.Phrase():
                *parts, last = value.parts or ("",)
                if not isinstance(last, content.Numbered):
                    return self._joined(value.parts)
                before, tag, piece = self._joined(parts).rpartition("<math>")  # no line ends in front of the link
                together = Markup('<span class="together">{}{}</span>').format(Markup(tag + piece), self.inline(last))
                return Markup(before) + together
            case content.Relation():
                # In one piece where it is short; a line ends between the pieces of a long one.
                if sum(formulas.extent(x) for x in value.parts if isinstance(x, Formula)) <= UNBROKEN:
                    return formulas.math(self.math(value))
                return Markup(" ").join(map(formulas.math, self._relation_pieces(value.parts)))
            case content.Listed():
                # In one piece where it is short, or in brackets; a line ends behind the commas of a long one.
                if value.braces or value.brackets or len(value.items) <= SIDE_BY_SIDE:
                    return formulas.math(self.math(value))
                *others, end = map(self.math, value.items)
                return Markup(" ").join(map(formulas.math, (*(item + _SEPARATOR for item in others), end)))
            case content.Elsewhere():
                return self.inline(value.link)
            case content.Emphasis():
                return Markup("<i>{}</i>").format(value.text)
            case content.Verbatim():
                return Markup("<code>{}</code>").format(value.text)
            case content.Unit():
                return escape(labelled("", value.text).strip())
            case content.Citation():
                return escape(value.text)
        return formulas.math(self.math(value))

    # --- mathematics ---

    def math(self, value: Any) -> str:
        """A value of mathematics as elements of MathML."""
        match value:
            case int():
                return mn(value)
            case str():
                return mo(RELATIONS.get(value, value))
            case Formula() if self._is_withheld(value):
                return self._not_printed(value)
            case Formula():
                return str(formulas.inline(value, self.spelled))
            case content.Name():
                symbol = (self.names if value.ring is None else MathNames.of(value.ring))[value.name]
                written = str(symbol.dotted(_DOTS[value.dots]) if value.dots else symbol)
                return written + bracketed(mn(value.at)) if value.at else written
            case content.Symbol():
                letter = _SCRIPT[value.letter] if value.look == "script" else value.letter
                above = "\u00af" if value.look == "bar" else _DOTS[value.dots]
                return str(formulas.symbol(letter, value.lower, value.upper, above))
            case content.Entry():
                whole = value.whole
                if isinstance(value.index, content.Name):
                    return f"<msub>{self.math(whole)}{self.math(value.index)}</msub>"
                if whole.lower:
                    return str(formulas.indexed(bracketed(self.math(whole)), value.index))
                return self.math(replace(whole, lower=value.index))
            case content.Notation() | content.Number():
                return notation(value.tex)
            case content.Rows():
                return table([list(map(self.math, row)) for row in value.rows])
            case content.Raised():
                return power(self.math(value.of), bracketed(mn(value.index)))
            case content.Power():
                return power(self.math(value.base), mn(value.exponent))
            case content.Text():
                return mtext(self._joined(value.parts).unescape())
            case content.Readable():
                if formulas.is_readable(value.value):
                    return self.math(value.value)
                return self._length(value.value, value.kept)
            case content.Listed():
                items = [self.math(x) for x in value.items]
                if value.braces:
                    return bracketed(_COMMA.join(items), "{}")
                return bracketed_row(items) if value.brackets else _COMMA.join(items)
            case content.Relation():
                return "".join(map(self.math, value.told))
            case content.Polynomial():
                written = "".join(self._pieces(value))
                return written if value.power == 1 else power(bracketed(written, "[]"), mn(value.power))
            case content.SpeedForm():
                return str(speed_form(value.form, self.names, value.body))
            case content.Tensor():
                return table([[self.math(x) for x in line] for line in value.rows])
            case content.Points():
                text = [point_of_table(x, y, self.names) for x, y in shown_points(value.points)]
                half = len(text) // 2
                return _COMMA.join(
                    text if len(text) == len(value.points) else [*text[:half], mo("\u2026"), *text[half:]]
                )
        return str(expression(value, self.names))

    # --- blocks ---

    @singledispatchmethod
    def block(self, value: Any) -> Markup:
        """A block."""
        raise TypeError(f"not a block: {value!r}")

    @block.register
    def _(self, value: content.Heading) -> Markup:
        return Markup("")

    @block.register
    def _(self, value: content.Subheading) -> Markup:
        return Markup("<h3>{}</h3>").format(self._joined(value.parts))

    @block.register
    def _(self, value: content.Paragraph) -> Markup:
        return Markup('<p class="open">{}</p>' if value.missing else "<p>{}</p>").format(self._joined(value.parts))

    @block.register
    def _(self, value: content.Display) -> Markup:
        notes = (Markup('\n<p class="note soft">({})</p>').format(self.inline(note)) for note in value.notes)
        shown = Markup("").join((self._displayed(value.value), *notes))
        if not value.key.startswith(CONDITION):
            return shown
        return Markup('<div id="{}">{}</div>').format(_anchor(value.key), shown)

    def _displayed(self, shown: Math | tuple[Inline, ...]) -> Markup:
        match shown:
            case Formula():
                return self._line("", shown)
            case content.Polynomial():
                return formulas.whole(self._pieces(shown))
            case content.Relation() as relation:
                return self._relation(relation.told)
            case content.Listed(items, False) if items:
                *first, last = map(self.math, items)
                return formulas.whole([*(item + _COMMA for item in first), last])
            case tuple():
                return formulas.text_line(*map(self._beside, shown))
        return formulas.text_line(self.math(shown))

    def _relation(self, parts: Sequence[Math | str]) -> Markup:
        """A line that breaks in the long formulas that it holds; one value on the left may be folded away."""
        parts = [x.value if isinstance(x, content.Readable) and formulas.is_readable(x.value) else x for x in parts]
        match parts:
            case [*before, content.Polynomial(power=1) as last]:
                first, *rest = self._pieces(last)
                return formulas.whole(["".join(map(self.math, before)) + first, *rest])
        places = [k for k, x in enumerate(parts) if isinstance(x, Formula)]
        value = parts[places[-1]] if places else None
        if isinstance(value, Formula) and (len(places) == 1 or formulas.extent(value) > formulas.FOLDED):
            *before, sign = parts[: places[-1]] or ("",)
            right = "".join(map(self.math, parts[places[-1] + 1 :]))
            if isinstance(sign, str):
                return self._line("".join(map(self.math, before)), value, right, sign)
        return formulas.whole(self._relation_pieces(parts))

    def _relation_pieces(self, parts: Sequence[Math | str]) -> list[str]:
        """Between these a line may end: those of each formula, with what stands beside."""
        pieces = [""]
        for before, part in pairwise(("", *parts)):
            if isinstance(part, str) and part in "+-=" and not isinstance(before, str):
                pieces.append(mo(RELATIONS.get(part, part), True))
                continue
            whole = not isinstance(part, Formula) or self._is_withheld(part)
            first, *rest = [self.math(part)] if whole else formulas.pieces(cast("Formula", part))
            pieces[-1] += first
            pieces += rest
        return pieces

    def _line(self, left: str, value: Formula, right: str = "", sign: str = "=") -> Markup:
        if self._is_withheld(value):
            return formulas.text_line(left, mo(sign) if left else "", self._not_printed(value), right)
        size = self.said(say("[[count]] terms", count=str(value.terms)))
        return formulas.line(left, value, right, sign, size, self.spelled)

    def _is_withheld(self, value: Formula) -> bool:
        return value.terms > formulas.LONGEST or id(value) in self.long

    def _not_printed(self, value: Formula) -> str:
        return mtext(f"({self.said(not_printed(value)).unescape()})")

    def _beside(self, value: Inline) -> str:
        """A part of a displayed line: words stand in it as text."""
        if isinstance(value, (str, Said)):
            return mtext(self.inline(value).unescape())
        return self.math(value)

    @block.register
    def _(self, value: content.Definitions) -> Markup:
        lines = (self._relation(item.parts) for item in value.items)
        return Markup("\n").join((Markup("<p>{}:</p>").format(self.said(value.words)), *lines))

    @block.register
    def _(self, value: content.Matrices) -> Markup:
        left = self.math(value.symbol)
        if value.value.is_zero:
            return formulas.text_line(left, mo("="), mn(0))
        whole = "" if value.packed else formulas.matrix(value.value, self.long, self.spelled)
        if whole:
            return formulas.text_line(left, mo("="), whole)
        return Markup("\n").join(
            self._line(self.math(content.Entry(value.symbol, index)), entry) for index, entry in value.entries()
        )

    @block.register
    def _(self, value: content.SideBySide) -> Markup:
        return self.document(value.matrices)

    @block.register
    def _(self, value: content.Components) -> Markup:
        left = self.math(value.symbol)
        if formulas.zero(value.value):
            return formulas.text_line(left, mo("="), mn(0))
        whole = formulas.components(value.value, self.long, self.spelled)
        if whole:
            return formulas.text_line(left, mo("="), whole)
        return Markup("\n").join(
            self._line(self.math(replace(value.symbol, lower=f"{value.symbol.lower},{k}")), entry)
            for k, entry in enumerate(value.value, start=1)
        )

    @block.register
    def _(self, value: content.Itemised) -> Markup:
        kind = "ol" if value.numbered else "ul"
        items = Markup("\n").join(Markup("<li>{}</li>").format(self.document(item)) for item in value.items)
        return Markup(f"<{kind}>\n{items}\n</{kind}>")

    @block.register
    def _(self, value: content.Table) -> Markup:
        head = Markup("").join(Markup('<th scope="col">{}</th>').format(self.inline(x.title)) for x in value.columns)
        rows = Markup("\n").join(
            Markup("<tr>{}</tr>").format(
                Markup("").join(Markup("<td>{}</td>").format(self._joined(cell)) for cell in row)
            )
            for row in value.rows
        )
        title = "" if value.title is None else Markup("<h3>{}</h3>\n").format(self.said(value.title))
        return Markup(
            '{}<div class="scroll"><table>\n<thead><tr>{}</tr></thead>\n<tbody>\n{}\n</tbody></table></div>'
        ).format(title, head, rows)

    @block.register
    def _(self, value: content.Facts) -> Markup:
        items = (
            Markup("<dt>{}</dt>\n{}").format(
                self.inline(fact.name),
                Markup("").join(Markup("<dd>{}</dd>\n").format(self.inline(line)) for line in fact.lines),
            )
            for fact in value.items
        )
        return Markup("<dl>\n{}</dl>").format(Markup("").join(items))

    @block.register
    def _(self, value: content.Cited) -> Markup:
        return Markup("")

    @block.register
    def _(self, value: content.Beside) -> Markup:
        return replace(self, names=self.names.beside(value.names)).document(value.blocks)

    @block.register
    def _(self, value: content.Lettered) -> Markup:
        written = self.document(value.blocks)
        return Markup("\n").join(filter(None, (self.document(value.meanings()), written)))

    @block.register
    def _(self, value: content.Drawing) -> Markup:
        said = Markup(" ").join(map(self.said, value.caption))
        drawn = svg(value.drawn, self.said(Said("Drawing of the system")), self.inline)
        caption = Markup("\n<figcaption>{}</figcaption>").format(said) if said else ""
        return Markup('<figure class="drawing">\n{}{}\n</figure>').format(drawn, caption)

    @block.register
    def _(self, value: content.Folded) -> Markup:
        return Markup("<details><summary>{}</summary>\n{}\n</details>").format(
            self.said(value.title), self.document(value.blocks)
        )

    @block.register
    def _(self, value: content.Intermediates) -> Markup:
        return told_passages(value.told, value.passages, self.inline)

    @block.register
    def _(self, value: content.Steps) -> Markup:
        same = {name: name for name in value.names} | {"pi": "pi"}
        nodes = [node for _, node in value.results]
        body = short_listing(value.program, nodes, same, _DIALECT, PAPER_PROGRAM)
        if body is None:
            return Markup("<p>{}</p>").format(self.said(program_not_printed(value.program, nodes)))
        called = [(_PLAIN.inline(symbol), text) for (symbol, _), text in zip(value.results, body.results, strict=True)]
        lines = "\n".join(f"{left} = {right}" for left, right in [*body.assignments, *called])
        return Markup("<details><summary>{}</summary>\n<pre>{}</pre></details>").format(self.said(value.title), lines)

    def _joined(self, parts: Iterable[Inline]) -> Markup:
        return Markup("").join(map(self.inline, parts))

    def _length(self, value: Formula, in_full: bool = True) -> str:
        return mtext(f"({self.said(length(value, in_full)).unescape()})")

    def _pieces(self, value: content.Polynomial) -> list[str]:
        variable = letter(value.variable) if greek(value.variable) else value.variable
        return formulas.polynomial_pieces(value.coefficients, variable, self._length)


#: Letters for private use, which stand for values in notation.
_FIRST = 0xE000


def _anchor(key: str) -> str:
    return f"formula-{key.replace(':', '-')}"


def told_passages(listing: Told[Any], passages: Iterable[Passage], say: Callable[[str], Markup] = escape) -> Markup:
    """A phrase, then the definitions that it introduces, for every passage."""
    names = MathNames.of(listing.ring)
    return Markup("").join(_passage(passage, names, say) for passage in passages)


def _passage(passage: Passage, names: MathNames, say: Callable[[str], Markup]) -> Markup:
    coordinate = Markup(" ") + math(str(names[passage.coordinate])) if passage.coordinate else Markup("")
    written = "; ".join(_equation(str(names[item.name]), item.formula) for item in passage.definitions)
    return Markup(f'<p>{say(passage.words)}{coordinate}:</p>\n<div class="formula told">{written}.</div>\n')


def _equation(left: str, formula: Formula) -> str:
    first, *rest = mathml_pieces(formula.ring, formula.polynomial)
    return " ".join(f"<math>{piece}</math>" for piece in [left + mo("=") + first, *rest])


# The drawing of a system as SVG, in the colours of the page; letters are MathML.


#: Pixels of a centimetre, and around everything.
SCALE, MARGIN = 46, 6

#: The room of a letter; it is in its middle.
WIDE, TALL = 120, 26


def svg(sketch: Sketch, title: Markup, letter: Callable[[Any], Markup]) -> Markup:
    """An ``<svg>``; ``letter`` writes what stands beside the lines."""

    def on(place: Place) -> Place:
        x, y = place
        return SCALE * (x - sketch.low[0]) + MARGIN, SCALE * (sketch.high[1] - y) + MARGIN

    wide, tall = (SCALE * (b - a) + 2 * MARGIN for a, b in zip(sketch.low, sketch.high, strict=True))
    drawn = Markup("\n").join(_mark(mark, on) for mark in sketch.marks)
    letters = Markup("\n").join(
        Markup(
            '<foreignObject x="{:.0f}" y="{:.0f}" width="{}" height="{}">'
            '<div xmlns="http://www.w3.org/1999/xhtml" class="letter">{}</div></foreignObject>'
        ).format(on(label.place)[0] - WIDE / 2, on(label.place)[1] - TALL / 2, WIDE, TALL, letter(label.text))
        for label in sketch.letters
    )
    return Markup(
        '<svg class="drawing" role="img" aria-label="{}" width="{:.0f}" height="{:.0f}" '
        'viewBox="0 0 {:.0f} {:.0f}">\n'
        '<defs><marker id="tip" viewBox="0 0 8 6" markerWidth="8" markerHeight="6" refX="7.5" refY="3" '
        'markerUnits="userSpaceOnUse" orient="auto-start-reverse">'
        '<path class="tip" d="M0 0L8 3L0 6Z"/></marker></defs>\n'
        "{}\n{}\n</svg>"
    ).format(title, wide, tall, wide, tall, drawn, letters)


def _mark(mark: Mark, on: Callable[[Place], Place]) -> Markup:
    if isinstance(mark, Dot):
        x, y = on(mark.place)
        kind = "joint" if mark.open else "centre"
        return Markup('<circle class="{}" cx="{:.1f}" cy="{:.1f}" r="{:.1f}"/>').format(kind, x, y, SCALE * mark.radius)
    points = [on(place) for place in mark.points]
    path = _curve(points, mark.closed) if mark.smooth else "L".join(f"{x:.1f} {y:.1f}" for x, y in points)
    kind = mark.ink.value + (" tint" if mark.tinted else "")
    tips = Markup(' marker-end="url(#tip)"' if mark.arrow else "") + Markup(
        ' marker-start="url(#tip)"' if mark.both else ""
    )
    return Markup('<path class="{}" d="M{}{}"{}/>').format(kind, path, "Z" if mark.closed else "", tips)


def _curve(points: Sequence[Place], closed: bool) -> str:
    """A smooth curve through the points: between two of them its handles are a sixth of the chord around each."""
    ring = [points[-1], *points, points[0], points[1]] if closed else [points[0], *points, points[-1]]
    written = "{:.1f} {:.1f}".format(*points[0])
    for k, (first, second) in enumerate(pairwise(ring[1:-1])):
        before, after = ring[k], ring[k + 3]
        handles = (
            (first[0] + (second[0] - before[0]) / 6, first[1] + (second[1] - before[1]) / 6),
            (second[0] - (after[0] - first[0]) / 6, second[1] - (after[1] - first[1]) / 6),
            second,
        )
        written += "C" + " ".join(f"{x:.1f} {y:.1f}" for x, y in handles)
    return written
