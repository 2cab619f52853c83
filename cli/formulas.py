"""Formulas given on the command line: ``--input u=sin(3*t)``, ``--motion theta=t**2``, complained about with places."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from mbsym.expressions.message import Message, worded
from mbsym.expressions.parser import ascii_safe, parse_expression
from mbsym.expressions.place import Complaints, Span, in_line
from mbsym.studies.request import Formula, Quantity
from mbsym_cli.options import MAX_LENGTH, Options

if TYPE_CHECKING:
    from mbsym.expressions.tree import Expression
    from mbsym.model.system import System


@dataclass(frozen=True)
class Kind:
    """What a formula is of: ``of`` the system's ``kind`` of names, ``word`` what it is called."""

    option: str
    kind: str
    word: str
    example: str
    there: str
    none: str


LAWS = Kind(
    "--input", "input", "law", "u=sin(3*t)", "laws are for",
    "this description has no inputs; they are declared under 'inputs'",
)  # fmt: skip
MOTIONS = Kind("--motion", "coordinate", "motion", "theta=sin(t)", "the coordinates are", "")


def read_formula(text: str, system: System, what: Kind, formulas: dict[str, Expression], options: Options) -> None:
    """Puts a sound formula into ``formulas``; whatever is wrong with it joins the complaints of ``asked``."""
    text, complaints = " ".join(text.splitlines()), Complaints()
    _read(text, system, what, complaints, formulas)
    options.add(what.option, text, *complaints.sorted())


def _read(text: str, system: System, what: Kind, complaints: Complaints, formulas: dict[str, Expression]) -> None:
    from mbsym.source.laws import LAW, of_laws, of_motions, read_law
    from mbsym.source.scope import did_you_mean, listed

    left, equals, right = text.partition("=")
    name, blanks = left.strip(), len(left) - len(left.lstrip())
    known = (of_laws if what is LAWS else of_motions)(system)
    if not equals or not name or len(text) > MAX_LENGTH:
        reason = Message("this [[what]] is too long", what=worded(what.word))
        if len(text) <= MAX_LENGTH:
            reason = Message("[[text]] gives no [[what]]", text=ascii_safe(text), what=worded(what.word))
        hint = Message("write name=[[what]], for example [[example]]", what=worded(what.word), example=what.example)
        complaints.error("bad-assignment", reason, None, hint)
        return
    span = Span(1, blanks + 1, max(1, len(name)))
    if name not in known:
        near = did_you_mean(name, known) or listed(what.there, known) or what.none
        words = "there is no [[kind]] called [[name]]"
        complaints.error("unknown-name", Message(words, kind=worded(what.kind), name=ascii_safe(name)), span, near)
    elif name in formulas:
        complaints.error("repeated-name", Message("[[name]] is given twice", name=f"'{name}'"), span)
    place = partial(in_line, offset=len(left) + 1)
    law = read_law(right, system, complaints, place, known.get(name, LAW))
    if law is not None and not complaints.errors:
        formulas[name] = law


def read_quantity(option: str, text: str, kind: Formula, system: System | None, options: Options) -> Quantity:
    """A word of ``kind``, or a formula; one that cannot be read is left out, and joins the complaints."""
    from mbsym.expressions.constants import out_of_range
    from mbsym.expressions.tree import CONSTANTS, Name, walk
    from mbsym.source.scope import did_you_mean

    if text in kind.words:
        return Quantity(text)
    known = () if system is None else kind.names(system, text)
    formula, wrong = " ".join(text.removeprefix(kind.prefix).split()), Complaints()
    anything = Message("[[words]], or a formula", words=", ".join(kind.words))
    if not formula or len(formula) > MAX_LENGTH:
        options.complain(option, "bad-formula", Message("nothing is said after [[option]]", option=option), anything)
        return Quantity(text)
    value = parse_expression(formula, wrong)
    for node in walk(value) if value is not None and system is not None else ():
        if isinstance(node, Name) and node.name not in {*known, *CONSTANTS} and node.span is not None:
            hint = did_you_mean(node.name, [*known, *kind.words]) or anything
            wrong.error("unknown-name", Message("unknown name [[name]]", name=ascii_safe(node.name)), node.span, hint)
    if value is not None and (why := out_of_range(value)):
        span = Span(1, 1, max(1, len(formula)))
        wrong.error("no-number", Message("nothing can be computed with this number: [[why]]", why=why), span)
    options.add(option, formula, *wrong.sorted())
    return Quantity(text, None if wrong.errors else value)
