"""Values given on the command line: ``name=expression``, read like a description and complained about like one."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from mbsym.expressions.parser import ascii_safe, parse_expression
from mbsym.expressions.place import Complaints, Span
from mbsym.expressions.tree import CONSTANTS, Expression, Name, names, walk
from mbsym.model.system import velocity_name
from mbsym.source import render
from mbsym.source.scope import did_you_mean

if TYPE_CHECKING:
    from mbsym.model.system import System

#: An assignment on the command line has at most so many characters.
MAX_LENGTH = 2_000


def assignments(texts: Sequence[str], system: System) -> tuple[dict[str, Expression], list[str]]:
    """Expressions by name, and rendered complaints (all of them; then the expressions are not to be used).

    A name is that of a parameter, a coordinate (its initial position) or ``<coordinate>_dot`` (its initial velocity);
    an expression is made of numbers, pi and parameters.
    """
    texts = [" ".join(text.splitlines()) for text in texts]
    complaints = Complaints()
    found: dict[str, Expression] = {}
    for line, text in enumerate(texts, 1):
        name, equals, right = text.partition("=")
        offset = len(name) + 1
        blanks = len(name) - len(name.lstrip())
        name = name.strip()
        span = Span(line, blanks + 1, max(1, len(name)))
        if not equals or not name or len(text) > MAX_LENGTH:
            reason = f"{ascii_safe(text)} gives no value" if len(text) <= MAX_LENGTH else "this assignment is too long"
            complaints.error("bad-assignment", reason, Span(line, 1, len(text)), "write name=value, for example l=3/2")
            continue
        known = _check_target(name, span, system, complaints)
        if name in found:
            complaints.error("repeated-name", f"'{name}' is set twice", span)
        before = len(complaints.errors)
        place = _Places(line, offset)
        value = parse_expression(right, complaints, place)
        if value is None:
            continue
        _check_names(value, system, complaints)
        if known and len(complaints.errors) == before:
            found[name] = value
    whole = "\n".join(texts)
    return found, [render(complaint, whole, "--set") for complaint in complaints.sorted()]


def number(text: str, option: str) -> tuple[float | None, list[str]]:
    """A positive number of an option, made of numbers and pi (``2*pi``, ``1e-3``), or rendered complaints."""
    from mbsym.algebra.base import NoClosedForm, SingularPoint
    from mbsym.numerics.scenario import exact

    complaints = Complaints()
    value = None
    if len(text) > MAX_LENGTH:
        complaints.error("bad-number", "this number is too long", Span(1, 1))
    else:
        value = parse_expression(text, complaints, _Places(1, 0))
    if value is not None:
        for node in walk(value):
            if isinstance(node, Name) and node.name not in CONSTANTS and node.span is not None:
                complaints.error("unknown-name", f"a number is wanted here, not {ascii_safe(node.name)}", node.span)
    found = None
    if value is not None and not complaints.errors:
        try:
            found = float(exact(value, {}))
        except (NoClosedForm, SingularPoint) as reason:
            complaints.error("bad-number", f"it has no value: {reason}", Span(1, 1, len(text)))
        else:
            if not found > 0:
                complaints.error("bad-number", "it must be positive", Span(1, 1, len(text)))
    return found, [render(complaint, text, option) for complaint in complaints.sorted()]


class _Places:
    """Offsets in the right side to places in the assignments, one a line."""

    def __init__(self, line: int, offset: int) -> None:
        self.line, self.offset = line, offset

    def __call__(self, start: int, end: int) -> Span:
        return Span(self.line, self.offset + start + 1, max(1, end - start))


def _settable(system: System) -> list[str]:
    return [*system.parameter_names, *system.coordinates, *system.velocities]


def _check_target(name: str, span: Span, system: System, complaints: Complaints) -> bool:
    if name in _settable(system):
        return True
    for item in system.prescribed:
        if name in (item.name, velocity_name(item.name)):
            from mbsym.expressions.tree import text

            hint = f"its rate is {text(item.rate)}: set what that is made of"
            complaints.error("misplaced-name", f"'{name}' is a prescribed motion and has no value to set", span, hint)
            return False
    if name in (item.name for item in system.notation):
        complaints.error("misplaced-name", f"'{name}' is notation: it follows from the parameters", span)
        return False
    hint = did_you_mean(name, _settable(system)) or _choices(_settable(system))
    complaints.error("unknown-name", f"there is nothing called {ascii_safe(name)} to set", span, hint)
    return False


def _choices(names_: Iterable[str]) -> str:
    listed = list(names_)
    return "these have values: " + ", ".join(listed[:20]) + (", ..." if len(listed) > 20 else "")


def _check_names(value: Expression, system: System, complaints: Complaints) -> None:
    allowed = {*system.parameter_names, *CONSTANTS}
    if names(value) <= allowed:
        return
    for node in walk(value):
        if isinstance(node, Name) and node.name not in allowed and node.span is not None:
            hint = did_you_mean(node.name, system.parameter_names) or "a value is made of numbers, pi and parameters"
            complaints.error("unknown-name", f"unknown name {ascii_safe(node.name)}", node.span, hint)
