"""``report.html``: every result in one file that reads well on a screen and on paper, and asks the network for nothing.

What was found stands first.  Formulas are MathML; long ones are folded away behind their length.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from markupsafe import Markup, escape

from mbsym import __version__
from mbsym.expressions.message import Message, worded
from mbsym.expressions.tree import text
from mbsym.formulas.mathml import MathNames, spelled_name
from mbsym.model.system import System
from mbsym.problems import NUMBERS
from mbsym.report.code.interconnection import Interconnection, Joint, Kind, Node, interconnection
from mbsym.report.content import Said
from mbsym.report.environment import templates
from mbsym.report.html.environment import fragment, page
from mbsym.report.html.writer import Writer
from mbsym.report.language import Language
from mbsym.report.lengths import COUNTED, PAPER, withheld
from mbsym.report.results import contents, results
from mbsym.source.yaml_writer import meaning

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


#: The order of the sections: as a reader wants them, as in report.tex.
ORDER = tuple(NUMBERS)


def render(analysis: Analysis, problems: Sequence[int]) -> str:
    """The file's text."""
    motion, no_motion = asked_motion(
        analysis.system, analysis.animate, Language(analysis.language or analysis.system.language)
    )
    known, values = context(analysis, problems)
    viewer = ("", "")
    if motion is not None:
        from mbsym.report.viewer.page import bundle

        viewer = bundle()
    return page("report.html.j2", known, ("report.js",), viewer, motion=motion, no_motion=no_motion, **values)


def context(
    analysis: Analysis, problems: Sequence[int], whole: bool = True, spelled: bool = False
) -> tuple[dict[str, Callable[..., Any]], dict[str, Any]]:
    """What templates about these problems may call, and what they tell.

    Not the ``whole`` is what a problem's own template needs: claims and checks, which are about all of them, are left.
    ``spelled``: formulas carry what other programs read.
    """
    system = analysis.system
    names = MathNames.of(analysis.ring)
    about = results(analysis, problems)
    counted = [about.by_problem[number] for number in COUNTED if number in about.by_problem]
    long = withheld([*counted, *about.forms.forms.results], PAPER)
    writer = Writer(names, Language(analysis.language or system.language), long, spelled)
    sections = contents(about, writer.document)
    known: dict[str, Callable[..., Any]] = {
        "tr": lambda text, **gaps: writer.said(Said(text, gaps)),
        "title": lambda number: writer.said(sections[number].title),
    }
    values = dict[str, Any](
        system=system,
        problems=[number for number in ORDER if number in problems],
        contents=sections,
        language=writer.language.name,
        claims=analysis.claims if whole else (),
        checks=analysis.checks if whole else (),
        diagram=diagram(system, writer.language) if system.bodies else "",
        version=__version__,
        digest=meaning(system),
    )
    return known, values


def title_in(analysis: Analysis, part: int | str) -> Markup:
    """The title of a problem, by its number, or a word of ours, in the language of the report."""
    language = Language(analysis.language or analysis.system.language)
    writer = Writer(MathNames.of(analysis.ring), language)
    if isinstance(part, str):
        return writer.said(Said(part))
    return writer.said(contents(results(analysis, (part,)), writer.document)[part].title)


# The motion in ``report.html``: integrated only where that was asked for, and told why there is none.


def asked_motion(system: System, time: float | None, language: Language) -> tuple[Markup | None, str]:
    """What the viewer reads of the motion from 0 to ``time``, or None and why; (None, "") where it is not asked for."""
    if time is None:
        return None, ""
    from mbsym.algebra.failures import Failure, message_of
    from mbsym.numerics.scenario import Incomplete, scenario
    from mbsym.report.viewer.page import run_data
    from mbsym.simulation import Request, simulate
    from mbsym.simulation.request import COORDINATES

    try:
        return run_data(simulate(scenario(system), Request(time, variables=COORDINATES)), language), ""
    except (Incomplete, Failure) as reason:
        return None, language.say(message_of(reason))


# The interconnection of the bodies as SVG, drawn from its layout; text of the page's own fonts and colours.


#: Pixels: the distance of neighbours, and the size of a body's box.
ACROSS, DOWN, WIDE, TALL, MARGIN = 190, 104, 150, 46, 14
#: So many letters of a name fit into a box, so many of a joint beside its line.
LETTERS, ANGLES = 20, 26
#: A page is so many boxes wide.
COLUMNS = 5
INERTIAL = Message("inertial frame")


def diagram(system: System, language: Language) -> Markup:
    """An ``<svg>`` with a title and a description for those who cannot see it."""
    graph = interconnection(system, most_columns=COLUMNS)
    beside = max((7 * len(_beside(joint)) - WIDE / 2 for joint in graph.joints), default=0)
    width = (graph.columns - 1) * ACROSS + WIDE + MARGIN + max(MARGIN, beside)
    height = (graph.rows - 1) * DOWN + TALL + 2 * MARGIN
    say = language.say
    body = "".join([*_lines(graph), *_loads(graph), *(_node(node, say(INERTIAL)) for node in graph.nodes)])
    said = say(Message("Interconnection of bodies: [[count]]", count=len(system.bodies)))
    description = "; ".join(map(say, _told(graph)))
    return Markup(
        f'<svg class="diagram" role="img" aria-labelledby="diagram-title diagram-text" width="{width:g}" '
        f'height="{height:g}" viewBox="0 0 {width:g} {height:g}"><title id="diagram-title">{escape(said)}</title>'
        f'<desc id="diagram-text">{escape(description)}</desc>{body}</svg>'
    )


def _told(graph: Interconnection) -> Iterator[Message]:
    for joint in graph.joints:
        ends = {"after": graph.nodes[joint.after].name, "before": _named(graph.nodes[joint.before])}
        yield Message("[[after]] on [[before]]: [[joint]]", joint=_joint_words(joint), **ends)
    for load in graph.interactions:
        first, second = (_named(graph.nodes[k]) for k in (load.first, load.second))
        yield Message("[[load]] between [[first]] and [[second]]", load=worded(load.kind), first=first, second=second)


def _named(node: Node) -> str | Message:
    return INERTIAL if node.kind is Kind.INERTIAL else node.name


def _joint_words(joint: Joint) -> Message:
    turns = ", ".join(f"{axis}: {_readable(text(angle))}" for axis, angle in joint.turns)
    if not turns:
        return Message("a moving connection point" if joint.slides else "a fixed joint")
    if joint.slides:
        return Message("turns [[turns]], and a moving connection point", turns=turns)
    return Message("turns [[turns]]", turns=turns)


def _place(node: Node) -> tuple[float, float]:
    """The middle of the box."""
    return MARGIN + WIDE / 2 + node.column * ACROSS, MARGIN + TALL / 2 + node.row * DOWN


def _node(node: Node, ground: str) -> str:
    x, y = _place(node)
    kind = {Kind.INERTIAL: "ground", Kind.FRAME: "frame", Kind.BODY: "body"}[node.kind]
    again = " again" if node.repeated else ""
    label = ground if node.kind is Kind.INERTIAL else f"{node.number}. {node.name}"
    box = (
        f'<rect class="{kind}{again}" x="{x - WIDE / 2:g}" y="{y - TALL / 2:g}" width="{WIDE}" height="{TALL}" rx="7"/>'
    )
    lines = [label] if len(label) <= LETTERS else _two(label)
    step = 16
    first = y - step * (len(lines) - 1) / 2
    words = "".join(
        f'<text x="{x:g}" y="{first + k * step:g}" class="middle">{escape(line)}</text>' for k, line in enumerate(lines)
    )
    return f"<g><title>{escape(ground if node.kind is Kind.INERTIAL else node.name)}</title>{box}{words}</g>"


def _two(label: str) -> list[str]:
    """Two lines, broken at a space where there is one, the rest cut."""
    at = label.rfind(" ", 0, LETTERS + 1)
    first, rest = (label[:at], label[at + 1 :]) if at > 2 else (label[:LETTERS], label[LETTERS:])
    return [first, _cut(rest, LETTERS)]


def _cut(words: str, most: int) -> str:
    return words if len(words) <= most else words[: most - 1] + "\u2026"


def _lines(graph: Interconnection) -> Iterator[str]:
    for joint in graph.joints:
        (x0, y0), (x1, y1) = _place(graph.nodes[joint.before]), _place(graph.nodes[joint.after])
        y0, y1 = y0 + TALL / 2, y1 - TALL / 2
        slides = ' class="slides"' if joint.slides else ""
        yield f'<path d="M{x0:g} {y0:g}L{x1:g} {y1:g}"{slides}/>'
        words = _beside(joint)
        if words:
            side = "end" if x1 < x0 else "start"
            x, y = x1 + (-8 if side == "end" else 8), y1 - 10
            yield f'<text x="{x:g}" y="{y:g}" class="joint {side}">{escape(words)}</text>'


def _beside(joint: Joint) -> str:
    """``3: \u03b4, 1: \u03c3; s``: turns about axes by angles, then the other coordinates."""
    turns = ", ".join(f"{axis}: {_readable(text(angle))}" for axis, angle in joint.turns)
    others = ", ".join(map(_readable, joint.others))
    return _cut("; ".join(filter(None, (turns, others))), ANGLES)


def _loads(graph: Interconnection) -> Iterator[str]:
    for load in graph.interactions:
        (x0, y0), (x1, y1) = _place(graph.nodes[load.first]), _place(graph.nodes[load.second])
        bend = -DOWN / 2 if y0 == y1 else 0
        side = -ACROSS / 3 if x0 == x1 else 0
        middle = (x0 + x1) / 2 + side, (y0 + y1) / 2 + bend
        yield f'<path class="load" d="M{x0:g} {y0:g}Q{middle[0]:g} {middle[1]:g} {x1:g} {y1:g}"/>'
        x, y = (x0 + x1) / 4 + middle[0] / 2, (y0 + y1) / 4 + middle[1] / 2
        yield f'<text class="load middle" x="{x:g}" y="{y:g}">{escape(load.kind)}</text>'


def _readable(words: str) -> str:
    """An expression with Greek letters, indices that are numbers below the line, and a proper minus."""
    return (
        re.sub(r"[A-Za-z_]\w*", lambda match: spelled_name(match[0]), words)
        .replace("-", "\u2212")
        .replace("*", "\u2009")
    )


# Parts of ``report.html`` one by one, as fragments for a page that fills while results are derived.
#
# A fragment is what the same part of the report is, word for word, and its formulas carry what other programs read
# (``html.formulas.spellings``).  Everything that comes from a description is escaped.


#: What a report shows beside problems, with the titles that it gives them.
PARTS = {
    "summary": "What was found",
    "system": "The system",
    "claims": "Claims",
    "checks": "Self-check",
    "conventions": "Conventions",
}


def title(analysis: Analysis, part: str | int) -> str:
    """As the report has it: ``Problem 6. Stability``, ``The system``."""
    return str(title_in(analysis, part if isinstance(part, int) else PARTS[part]))


def part_html(analysis: Analysis, part: str | int, problems: Sequence[int]) -> str:
    """A part, or a problem by its number, told beside the results of ``problems``.

    Raises KeyError for a part that there is not.
    """
    if isinstance(part, str) and part not in PARTS:
        raise KeyError(part)
    known, values = context(analysis, problems, part in ("summary", "claims", "checks"), spelled=True)
    return fragment("part.html.j2", known, part=part, **values)


def finding_html(analysis: Analysis) -> str:
    """What was found of all its problems, with a style of its own: a part of somebody's page that has none."""
    style = "".join((templates() / "html" / name).read_text("utf-8") for name in ("notebook.css", "pictures.css"))
    found = part_html(analysis, "summary", analysis.problems)
    return f'<div class="mbsym"><style>{style}</style><b>{escape(analysis.system.name)}</b>{found}</div>'
