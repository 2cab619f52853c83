"""``mbsym simulate --certify``: its option, and what is told of the enclosure."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import click

from mbsym_cli.option_groups import group

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.simulation import Request
    from mbsym_cli.options import Options

#: Asked for without a number; the narrowest and the widest that can be asked for.
USUAL, NARROWEST, WIDEST = "1e-10", 1e-100, 1e-3


@dataclass(frozen=True)
class Certifying:
    """The width as it was typed; None where nothing is to be proved."""

    width: str | None

    def added(self, request: Request, system: System | None, asked: Options) -> Request:
        """The request with what this group asks for."""
        return replace(request, certify=asked.number("--certify", self.width, NARROWEST, WIDEST))


certify_options = group(
    "certifying",
    Certifying,
    click.option(
        "--certify",
        "width",
        is_flag=False,
        flag_value=USUAL,
        metavar="[WIDTH]",
        help="Prove where the exact solution is, to this part of each size, and how far the run is from it.  "
        f"[default: {USUAL}]",
    ),
)
