"""``--input``: what the inputs of a description are in a simulation; elsewhere they keep their constant values."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mbsym.expressions.parser import ascii_safe
from mbsym.expressions.place import Complaints, Span
from mbsym.source import render_option
from mbsym_cli.console import complain, read_description
from mbsym_cli.option_groups import group
from mbsym_cli.options import MAX_LENGTH, Options

if TYPE_CHECKING:
    from mbsym.expressions.tree import Expression
    from mbsym.model.system import System
    from mbsym.simulation import Request
    from mbsym_cli.simulation_options import Group


@dataclass(frozen=True)
class Laws:
    """As they were typed."""

    laws: tuple[str, ...]

    def added(self, request: Request, system: System | None, asked: Options) -> Request:
        """The request as it is: inputs are part of the system."""
        return request


def read_laws(laws: Group, system: System | None, asked: Options) -> dict[str, Expression]:
    """The expression of every input that is given one; what is wrong joins the complaints of ``asked``."""
    found: dict[str, Expression] = {}
    if system is None or not isinstance(laws, Laws):
        return found
    for text in (" ".join(one.splitlines()) for one in laws.laws):
        complaints = Complaints()
        _read(text, system, complaints, found)
        asked.complaints += [render_option(complaint, text, "--input") for complaint in complaints.sorted()]
    return found


input_options = group(
    "driven",
    Laws,
    click.option(
        "--input", "laws", multiple=True, metavar="NAME=LAW", help='An input of the file: "u=sin(3*t)"; repeatable.'
    ),
)


def _read(text: str, system: System, complaints: Complaints, found: dict[str, Expression]) -> None:
    from mbsym.source.laws import read_law
    from mbsym.source.scope import did_you_mean, listed

    left, equals, right = text.partition("=")
    name, blanks = left.strip(), len(left) - len(left.lstrip())
    if not equals or not name or len(text) > MAX_LENGTH:
        reason = f"{ascii_safe(text)} gives no law" if len(text) <= MAX_LENGTH else "this law is too long"
        complaints.error("bad-assignment", reason, None, "write name=law, for example u=sin(3*t)")
        return
    span = Span(1, blanks + 1, max(1, len(name)))
    if name not in system.input_names:
        hint = did_you_mean(name, system.input_names) or listed("the inputs are", system.input_names)
        hint = hint or "this description has no inputs; they are declared under 'inputs'"
        complaints.error("unknown-name", f"there is no input called {ascii_safe(name)}", span, hint)
    elif name in found:
        complaints.error("repeated-name", f"'{name}' is given twice", span)
    offset = len(left) + 1
    law = read_law(right, system, complaints, lambda start, end: Span(1, offset + start + 1, max(1, end - start)))
    if law is not None and not complaints.errors:
        found[name] = law


def read_held(file: Path, command: str) -> System | None:
    """The system of a file with its inputs at the values of the unperturbed motion, which is said."""
    from mbsym.expressions.tree import text
    from mbsym.model.driven import held

    system = read_description(file, command)
    if system is None or not system.inputs:
        return system
    values = ", ".join(f"{one.name} = {text(one.held)}" for one in system.inputs)
    complain(file, f"note: for '{command}' the inputs are constant, as on the unperturbed motion: {values}")
    return held(system)
