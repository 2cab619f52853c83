"""``mbsym simulate --certify``: its option, and what is told of the enclosure."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import click

from mbsym_cli.options import group

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.simulation import Request
    from mbsym_cli.options import Options

#: Asked for without a number; the narrowest and the widest that can be asked for.
USUAL, NARROWEST, WIDEST = "1e-10", 1e-100, 1e-3


#: What a proof may cost where no seconds are given: counted work, worth about so many seconds.
WORK = 600.0


@dataclass(frozen=True)
class Certifying:
    """The width as it was typed, None where nothing is to be proved; and how many seconds that may take, if given."""

    width: str | None
    certify_seconds: str | None

    def added(self, request: Request, system: System | None, asked: Options) -> Request:
        """The request with what this group asks for."""
        width = asked.number("--certify", self.width, NARROWEST, WIDEST)
        seconds = asked.number("--certify-seconds", self.certify_seconds, 1e-3, 1e9)
        if seconds is None:
            return replace(request, certify=width, certify_limit=WORK)
        return replace(request, certify=width, certify_seconds=seconds)


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
    click.option(
        "--certify-seconds",
        metavar="S",
        help="How long the proof may take; ends early where a tenth of it shows that ten times as much would not do.  "
        f"[default: counted work, worth about {WORK:g} s]",
    ),
)
