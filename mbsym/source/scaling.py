"""Dimensionless variables, and reductions, as an author chooses them: ``x=L*x1,t=tau/omega0,k=m*omega0**2*kappa``.

Left of each sign of equality stands a name of the description, right of it what is put in for it: a variable is a
factor times its new name, which comes last where several would do; a parameter is any expression.  Names that the
description does not have are new.  New variables, and new parameters that stand only once and at a parameter, are pure
numbers: what has another dimension than its name is complained about, whether units are declared or not, for most
places of a description demand one.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial

from mbsym.expressions.message import Message
from mbsym.expressions.parser import ascii_safe, parse_expression
from mbsym.expressions.place import Complaints, Span, in_line
from mbsym.expressions.rates import ENDINGS, velocity_name
from mbsym.expressions.tree import CONSTANTS, ONE, Expression, Name, names, substitute, walk
from mbsym.model.scaling import Asked, Reducing, Scaled, Scaling, Weights, factor_of
from mbsym.model.system import System
from mbsym.source.scope import did_you_mean, listed, why_no_name
from mbsym.source.units.system import Dimensions, Form, dimensions_of


@dataclass(frozen=True)
class Item:
    """``name=value`` as it was written, with the place of the name; ``bare`` where no value stands there."""

    name: str
    span: Span
    value: Expression
    bare: bool = False


def read_scaling(text: str, system: System, complaints: Complaints) -> Scaling | None:
    """What an author writes, checked; None after a complaint."""
    items = list(_items(text, system, complaints))
    if complaints.errors:
        return None
    known = {*system.parameter_names, *CONSTANTS}
    moving = (*system.coordinates, *system.variables)
    # A variable may keep its name.
    own = {assignment.name for assignment in items if assignment.name in moving}
    seen = [node.name for assignment in items for node in walk(assignment.value) if isinstance(node, Name)]
    fresh = [name for name in dict.fromkeys(seen) if name not in known]
    taken = _taken(system)
    for item in items:
        for node in walk(item.value):
            if isinstance(node, Name) and node.name in fresh and node.span is not None:
                if node.name == item.name and item.name in own:
                    continue
                reason = why_no_name(node.name)
                if node.name in taken and node.name != "t":
                    reason = "the description has it", "what is put in holds parameters and new names"
                if reason is not None:
                    message = Message(
                        "[[name]] cannot be a new name: [[reason]]", name=ascii_safe(node.name), reason=reason[0]
                    )
                    complaints.error("bad-name", message, node.span, reason[1])
    if complaints.errors:
        return None
    variables: list[Scaled] = []
    time: Scaled | None = None
    for item in items:
        if item.name != "t" and item.name not in moving:
            continue
        there = [node.name for node in walk(item.value) if isinstance(node, Name) and node.name in fresh]
        linear = [
            name for name in dict.fromkeys(there) if seen.count(name) == 1 and factor_of(item.value, name) is not None
        ]
        if not linear:
            message = Message("[[name]] is to be a factor times a new name that stands nowhere else", name=item.name)
            example = "t=tau/omega0" if item.name == "t" else f"{item.name}=L*{item.name}1"
            complaints.error("bad-scale", message, item.span, Message("for example [[example]]", example=example))
            continue
        scaled = Scaled(item.name, linear[-1], factor_of(item.value, linear[-1]) or ONE)
        if item.name == "t":
            time = scaled
        else:
            variables.append(scaled)
    images = _resolved(
        {assignment.name: assignment.value for assignment in items if assignment.name in system.parameter_names},
        items,
        complaints,
    )
    if complaints.errors:
        return None
    named = {scaled.new for scaled in (*variables, *([time] if time else []))}
    variables = [replace(variable, factor=substitute(variable.factor, images)) for variable in variables]
    time = None if time is None else replace(time, factor=substitute(time.factor, images))
    new = tuple(name for name in fresh if name not in named)
    scaling = Scaling(tuple(variables), time, tuple(images.items()), new, {})
    dimensions = _dimensions(system, items, scaling, named, complaints)
    if complaints.errors:
        return None
    left = [name for name in system.parameter_names if name not in images]
    driven = (*(prescribed.name for prescribed in system.prescribed), *system.input_names)
    weights = {name: _weights(dimensions, name) for name in (*left, *new, *moving, *driven)}
    return Scaling(scaling.variables, scaling.time, scaling.parameters, scaling.new, weights)


def _items(text: str, system: System, complaints: Complaints) -> Iterator[Item]:
    """The assignments, their names looked up and each given once."""
    done: set[str] = set()
    for assignment in assignments(text, complaints):
        if assignment.bare:
            message = Message("[[text]] says of no name what it is", text=ascii_safe(assignment.name) or "nothing")
            complaints.error(
                "bad-assignment", message, assignment.span, "write name=expression, for example x=L*x1,t=tau/omega0"
            )
        elif assignment.name in done:
            complaints.error(
                "repeated-name", Message("'[[name]]' is given twice", name=assignment.name), assignment.span
            )
        elif _known(assignment.name, assignment.span, system, complaints):
            done.add(assignment.name)
            yield assignment


def assignments(text: str, complaints: Complaints, start: int = 0) -> Iterator[Item]:
    """``name=expression`` between commas; what has no such form is bare."""
    depth, first = 0, 0
    for k, letter in enumerate(text + ",") if text.strip() else ():
        depth += (letter in "([") - (letter in ")]")
        if letter != "," or (depth > 0 and k < len(text)):
            continue
        piece, offset, first = text[first:k], start + first, k + 1
        left, equals, right = piece.partition("=")
        name, blanks = left.strip(), len(left) - len(left.lstrip())
        span = Span(1, offset + blanks + 1, max(1, len(name)))
        if name.endswith("'"):  # as results print it
            name = velocity_name(name[:-1])
        if not equals or not name or not right.strip():
            yield Item(piece.strip() if equals else name, span, ONE, bare=True)
            continue
        value = parse_expression(right, complaints, partial(in_line, offset=offset + len(left) + 1))
        if value is not None:
            yield Item(name, span, value)


def _known(name: str, span: Span, system: System, complaints: Complaints) -> bool:
    moving = (*system.coordinates, *system.variables)
    there = ("t", *moving, *system.parameter_names)
    if name not in there:
        hint = did_you_mean(name, there) or listed("there are", there)
        complaints.error("unknown-name", "there is nothing called [[name]] to scale", span, hint, name=ascii_safe(name))
        return False
    if name in {relation.name for relation in system.relations}:
        message = Message("'[[name]]' follows from a relation", name=name)
        complaints.error("misplaced-name", message, span, "say what the names are that it is made of")
        return False
    return True


def _taken(system: System) -> set[str]:
    """Names that no new one may be."""
    moving = (*system.coordinates, *system.variables)
    own = {name + end for name in moving for end in ("", *ENDINGS.values())}
    own |= {named.name for part in (system.prescribed, system.notation, system.inputs, system.tables) for named in part}
    return own


def _resolved(images: dict[str, Expression], items: list[Item], complaints: Complaints) -> dict[str, Expression]:
    """What is put in, without names for which something is put in."""
    for _ in images:
        images = {name: substitute(value, images) for name, value in images.items()}
    for assignment in items:
        if assignment.name in images and names(images[assignment.name]) & images.keys():
            message = Message("'[[name]]' is made of itself", name=assignment.name)
            complaints.error(
                "circular", message, assignment.span, "one of these names is to be left, or a new one to come in"
            )
    return images


def _dimensions(
    system: System, items: list[Item], scaling: Scaling, named: set[str], complaints: Complaints
) -> Dimensions:
    """The dimensions of all names; complains where an expression has another one than what it is put in for."""
    hint = "new variables are pure numbers, and so are new parameters that stand in one place only, at a parameter"
    factors = {
        name for assignment in items if assignment.name not in scaling.images for name in names(assignment.value)
    }
    often = {name for name in scaling.new if sum(name in names(assignment.value) for assignment in items) > 1}
    numbers = {*named, *(name for name in scaling.new if name not in factors | often)}

    def complain(message: str, span: Span | None, own: str | None) -> None:
        complaints.error("dimension", message, span, own or hint)

    dimensions = dimensions_of(system, complain, {name: Form() for name in numbers})
    for item in sorted(items, key=lambda assignment: assignment.name in scaling.images):
        form = dimensions.name_form(item.name)
        dimensions.expect(item.value, form, f"'{item.name}'")
    return dimensions


def _weights(dimensions: Dimensions, name: str) -> Weights:
    form = dimensions.inference.reduced(dimensions.name_form(name))
    return {**dict(form.known), **{f"[{other}]": power for other, power in form.unknown}}


# A reduction as an author asks for it: ``r1=1,h3=1 by integrals; q1,h2 by p1,h1; p1=p2+eps*lam; O(eps**3)``.
#
# Between semicolons stand steps: variables that are eliminated ``by`` integrals, with what they are at first, or by the
# equations of other variables; a change of variables, and letters for what stands in it; last, if anything is to be
# sorted by powers of a parameter, from which one on it is left out.


_REMAINDER = re.compile(r"\s*O\(\s*(\w+)\s*(?:(?:\*\*|\^)\s*(\d+)\s*)?\)\s*")


def read_reduction(text: str, complaints: Complaints) -> Reducing | None:
    """The steps; None after a complaint.  Names are looked up where the equations are known."""
    steps: list[Asked] = []
    small, known = "", None
    start = 0
    for piece in text.split(";"):
        left, by, right = piece.partition(" by ")
        remainder = _REMAINDER.fullmatch(piece)
        if remainder is not None:
            small, known = remainder[1], int(remainder[2] or 1)
        elif piece.strip():
            items = list(assignments(left, complaints, start))
            of = list(assignments(right, complaints, start + len(left) + len(by)))
            for misplaced in [x for x in items if x.bare and not by] + [x for x in of if not x.bare]:
                message = Message("[[text]] is no step of a reduction", text=ascii_safe(misplaced.name) or "nothing")
                hint = "for example 'r=1 by integrals', 'q by p', 'p=p1+eps*a', and 'O(eps**3)' as the last one"
                complaints.error("bad-step", message, misplaced.span, hint)
            expressions = {item.name: item.value for item in items if not item.bare}
            steps.append(
                Asked(tuple(item.name for item in items), expressions, tuple(assignment.name for assignment in of))
            )
        start += len(piece) + 1
    return None if complaints.errors else Reducing(tuple(steps), small, known)
