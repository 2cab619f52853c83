"""LaTeX files from templates, and ``report.tex``, which stands alone."""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar
from weakref import WeakKeyDictionary

from mbsym import __version__
from mbsym.formulas.latex import LatexNames
from mbsym.formulas.letters import letters
from mbsym.formulas.tree import angles_or
from mbsym.model.system import System
from mbsym.report.code.interconnection import Interconnection, Joint, Kind, Node, interconnection
from mbsym.report.content import Said, Verbatim
from mbsym.report.environment import rendered
from mbsym.report.language import Language
from mbsym.report.latex.description import expression
from mbsym.report.latex.displays import closing_brace, long_formulas, loosened, written_out
from mbsym.report.latex.formulas import measured_matrix, width
from mbsym.report.latex.labels import Form, Labels, heading, prefix_of, set_apart
from mbsym.report.latex.writer import Writer, broken, escaped, is_cyrillic, spared
from mbsym.report.lengths import COUNTED, PAPER, PAPER_FORMS, withheld
from mbsym.report.references import references
from mbsym.report.results import contents, results
from mbsym.source.yaml_writer import meaning

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


def render(analysis: Analysis, problems: Sequence[int]) -> str:
    """The text of ``report.tex``."""
    return filled("report.tex.j2", analysis, problems, Form.REPORT, figures=analysis.figures)


def filled(template: str, analysis: Analysis, problems: Sequence[int], form: Form, **more: Any) -> str:
    """A template with the results of some problems; ``more`` are values besides."""
    filters, values = shown(analysis, problems, form)
    text = rendered(template, filters, **values, **more)
    if analysis.system.constraints:
        head, begins, rest = text.rpartition("\\begin{document}")  # an appendix has none
        text = head + begins + abbreviated(rest)
    text = text if form is Form.REPORT else written_out(set_apart(text))
    return "\n".join(map(broken, spared(text).split("\n")))


# Long radicands, denominators and numerators under letters of their own: nothing in them can be broken by TeX.


#: In ems: half a line of a page.
WIDEST = 20.0
LETTERS = ("\\Delta", "\\Xi", "\\Upsilon", "\\Pi", "\\Sigma", "\\Theta")

_HEAD = re.compile(r"\\(sqrt|frac)\{")
_BRACKET = re.compile(r"[()\[\]{}]|(?<=[^ {(\[]) (?=[+-] )")
#: Brackets of more letters may be broken.
LONG_BRACKET = 120


def abbreviated(text: str) -> str:
    r"""The text with long parts of its ``\longformula`` told before they are used."""
    letter = next((x for x in LETTERS if not re.search(re.escape(x) + r"(?![A-Za-z])", text)), None)
    if letter is None:
        return text
    parts = _Parts(letter)
    pieces, last = [], 0
    for start, label, formula, end in long_formulas(text):
        shortened = parts.told(formula)
        if shortened != formula:
            named = f"[{label}]" if label else ""
            pieces += [text[last:start], *parts.taken(), f"\\longformula{named}{{{loosened(shortened)}}}"]
            last = end
    return "".join([*pieces, text[last:]])


class _Parts:
    """Letters by what they stand for, in the order in which they were needed."""

    def __init__(self, letter: str) -> None:
        self._letter = letter
        self._letters: dict[str, str] = {}
        self._new: list[tuple[str, str]] = []

    def taken(self) -> list[str]:
        """The formulas that tell what is new since the last call."""
        definitions = [f"\\longformula{{{letter} = {_breakable(part)}}}\n" for letter, part in self._new]
        self._new = []
        return definitions

    def told(self, formula: str) -> str:
        """The formula with its long radicands, numerators and denominators as letters, inner ones first."""
        pieces, place = [], 0
        while (match := _HEAD.search(formula, place)) is not None:
            end = closing_brace(formula, match.end() - 1)
            inner = [self.told(formula[match.end() : end])]
            if match[1] == "frac":
                start = end + 1
                end = closing_brace(formula, start)
                inner.append(self.told(formula[start + 1 : end]))
            pieces += [formula[place : match.start()], f"\\{match[1]}"]
            pieces += [f"{{{self._letter_of(part) if width(part) > WIDEST else part}}}" for part in inner]
            place = end + 1
        return "".join([*pieces, formula[place:]])

    def _letter_of(self, part: str) -> str:
        if part not in self._letters:
            self._letters[part] = f"{self._letter}_{{{len(self._letters) + 1}}}"
            self._new.append((self._letters[part], part))
        return self._letters[part]


def _breakable(part: str) -> str:
    """With places at which a line may end: at signs, and within brackets only where these are long."""
    pieces, place, opened = [], 0, []
    ends = {match.start(): _partner(part, match.start()) for match in _BRACKET.finditer(part) if match[0] in "([{"}
    for match in _BRACKET.finditer(part):
        if match[0] in "([{":
            opened.append(ends[match.start()] - match.start())
        elif match[0] in ")]}":
            if opened:
                opened.pop()
        elif all(length > LONG_BRACKET for length in opened):
            pieces += [part[place : match.start()], f"\\penalty{120 if opened else 60} "]
            place = match.start()
    return "".join([*pieces, part[place:]])


def _partner(text: str, start: int) -> int:
    """Where a bracket closes, or the text ends."""
    depth = 0
    for match in _BRACKET.finditer(text, start):
        depth += 1 if match[0] in "([{" else -1 if match[0] in ")]}" else 0
        if depth == 0:
            return match.start()
    return len(text)


# What LaTeX files show: the filters and the values of their templates.


T = TypeVar("T")
Filters = dict[str, Callable[..., Any]]


class Printed:
    """Texts by what they are made of, which is kept with them, so that its identity stays its own."""

    def __init__(self) -> None:
        self._made: dict[tuple[Any, ...], tuple[Any, Any]] = {}

    def __call__(self, function: Callable[..., T], value: Any, *more: Hashable) -> T:
        """``function(value, *more)``, called once as long as formulas are to be printed the same way."""
        key = function, id(value), angles_or("shorter"), letters(), *more
        if key not in self._made:
            self._made[key] = value, function(value, *more)
        printed: T = self._made[key][1]
        return printed


_PRINTED: WeakKeyDictionary[Analysis, Printed] = WeakKeyDictionary()


def shown(analysis: Analysis, problems: Sequence[int], form: Form) -> tuple[Filters, dict[str, Any]]:
    """The filters and the values for the results of some problems."""
    system, once = analysis.system, _PRINTED.setdefault(analysis, Printed())
    names = LatexNames.of(analysis.ring)
    tongue = Language(analysis.language or system.language)
    labels = Labels(prefix_of(system))
    known = results(analysis, problems, apart=form is Form.FRAGMENT)
    long = withheld([known.by_problem[number] for number in COUNTED if number in known.by_problem], PAPER)
    long |= withheld(known.forms.forms.results, PAPER_FORMS)
    cited = references(known.by_problem.get(6), escaped(system.source)) if form is not Form.FRAGMENT else ()
    writer = Writer(names, tongue, labels, form, long, lambda value: once(measured_matrix, value))
    values = {
        "tr": lambda text, **gaps: writer.said(Said(text, gaps)),
        "verbatim": Verbatim,
        # No filter: Jinja computes filters of constants when it compiles a template, and keeps what it compiled.
        "heading": lambda key, title: heading(labels, form, key, title),
        "wide": form is Form.REPORT,
        "prefix": labels.prefix,
        "version": __version__,
        "digest": once(meaning, system),
        "babel": tongue.babel,
        "references": cited,
        "system": system,
        "contents": contents(known, writer.document),
        "problems": problems,
        "diagram": lambda: diagram(system, names, escaped, tongue.say("inertial frame"), form.picture),
        "cyrillic": is_cyrillic(system, tongue.say("Stability")),
    }
    return {"tex": escaped}, values


# The interconnection of the bodies as a TikZ picture.


#: In centimetres: the distance of neighbours at most, and what a box with a name, or a label at a line, needs.
MOST_ACROSS, MOST_DOWN, NAMED, LABELLED = 5.2, 1.7, 2.3, 3.4
#: The longest word, and the longest name, that a box holds.
LONGEST_WORD, LONGEST_NAME = 12, 24

#: Bodies that a picture of this height (in cm) may show are told by number.
HEIGHT = 17.0

_STYLES = {
    Kind.INERTIAL: "draw=none, fill=black!12",
    Kind.FRAME: "draw, dashed, rounded corners=2pt",
    Kind.BODY: "draw, rounded corners=2pt",
}


@dataclass(frozen=True)
class _Scale:
    across: float
    down: float

    @property
    def named(self) -> bool:
        return self.across >= NAMED and self.down >= 1.0

    @property
    def labelled(self) -> bool:
        return self.across >= LABELLED and self.down >= 1.1


def diagram(
    system: System, names: LatexNames, escaped: Callable[[str], str], inertial: str, width: float = 15.0
) -> str:
    """A ``tikzpicture`` of at most ``width`` cm; ``inertial`` is what the inertial frame is called."""
    graph = interconnection(system)
    scale = _Scale(min(MOST_ACROSS, width / max(1.0, graph.columns)), min(MOST_DOWN, HEIGHT / max(1, graph.rows)))
    size = r"\small" if scale.named else r"\scriptsize"
    lines = [
        f"\\begin{{tikzpicture}}[x={scale.across:.2f}cm, y=-{scale.down:.2f}cm, font={size}]",
        *(_node(k, node, scale, escaped, inertial) for k, node in enumerate(graph.nodes)),
        *(_joint(joint, graph, scale, names) for joint in graph.joints),
        *_interactions(graph),
        "\\end{tikzpicture}",
    ]
    return "\n".join(lines)


def _node(k: int, node: Node, scale: _Scale, escaped: Callable[[str], str], inertial: str) -> str:
    name = inertial if node.kind is Kind.INERTIAL else escaped(node.name)
    fits = len(name) <= LONGEST_NAME and max(map(len, name.split()), default=0) <= LONGEST_WORD
    text = f"{node.number}. {name}" if scale.named and fits else str(node.number)
    style = _STYLES[node.kind] + (", densely dotted, draw" if node.repeated else "")
    room = f", align=center, text width={min(scale.across, 3.4) - 0.5:.2f}cm" if scale.named and fits else ""
    inner = "3pt" if scale.named else "2pt"
    return f"\\node[{style}, inner sep={inner}{room}] (n{k}) at ({node.column:g}, {node.row}) {{{text}}};"


def _joint(joint: Joint, graph: Interconnection, scale: _Scale, names: LatexNames) -> str:
    label = ""
    if scale.labelled:
        turns = [f"{axis}\\colon {expression(angle, names)}" for axis, angle in joint.turns]
        shifts = [str(names[name]) for name in joint.others]
        written = ",\\; ".join([*turns, *shifts])
        if written and len(turns) + len(shifts) <= 4:
            upright = graph.nodes[joint.before].column == graph.nodes[joint.after].column
            place = "right" if upright else "fill=white, inner sep=1pt"
            label = f" node[midway, {place}, font=\\scriptsize] {{${written}$}}"
    style = "double, double distance=1.2pt" if joint.slides else "-"
    return f"\\draw[{style}] (n{joint.before}) --{label} (n{joint.after});"


def _interactions(graph: Interconnection) -> list[str]:
    pairs = dict.fromkeys((min(i.first, i.second), max(i.first, i.second)) for i in graph.interactions)
    return [f"\\draw[dotted, thick] (n{first}) to[bend left=25] (n{second});" for first, second in pairs]
