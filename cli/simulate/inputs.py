"""``--input``: what the inputs of a description are in a simulation; elsewhere they keep their constant values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import click

from mbsym_cli.formulas import LAWS, read_formula
from mbsym_cli.options import Options, group

if TYPE_CHECKING:
    from mbsym.expressions.tree import Expression
    from mbsym.model.system import System
    from mbsym.simulation import Request
    from mbsym_cli.simulate.options import Group


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
    for text in laws.laws:
        read_formula(text, system, LAWS, found, asked)
    return found


input_options = group(
    "driven",
    Laws,
    click.option(
        "--input", "laws", multiple=True, metavar="NAME=LAW", help='An input of the file: "u=sin(3*t)"; repeatable.'
    ),
)
