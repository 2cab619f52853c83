"""``--ledger`` of ``mbsym run``, and the accuracy that it is held against."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import click

from mbsym_cli.option_groups import group
from mbsym_cli.options import Options
from mbsym_cli.simulate.choice import COARSEST, FINEST

if TYPE_CHECKING:
    from mbsym.numerics.ledger.work import Wanted


@dataclass(frozen=True)
class Asked:
    """As typed."""

    ledger: bool
    accuracy: str | None
    until: str | None

    def read(self, asked: Options) -> Wanted | bool:
        """Whether there is a ledger, and the accuracy that it is held against, if any; complaints join ``asked``."""
        if self.accuracy is None and self.until is None:
            return self.ledger
        for name, value in (("--accuracy", self.accuracy), ("--until", self.until)):
            if value is None:
                asked.complain(name, "missing-option", "an accuracy is one of a motion from 0 to a time: give both")
        if not self.ledger:
            asked.complain("--accuracy", "conflicting-options", "only the ledger is held against it", "add --ledger")
        accuracy = asked.number("--accuracy", self.accuracy, FINEST, COARSEST)
        until = asked.number("--until", self.until)
        if accuracy is None or until is None:
            return self.ledger
        from mbsym.numerics.ledger.work import Wanted

        return Wanted(accuracy, until)


ledger_options = group(
    "ledger",
    Asked,
    click.option("--ledger", is_flag=True, help="What was left out, why that is safe, and what it saved."),
    click.option(
        "--accuracy",
        metavar="X",
        help="Hold what the ledger's equations leave out against this relative error of the motion (1e-6).",
    ),
    click.option("--until", metavar="T", help="The end of that motion, from 0 (20, 2*pi)."),
)
