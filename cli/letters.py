"""``--in lambda,G,kappa``: the author's letters in which formulas are written."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from mbsym.expressions.message import Message
from mbsym.expressions.parser import ascii_safe
from mbsym_cli.options import Options

if TYPE_CHECKING:
    from mbsym.model.system import System

_HELP = (
    "Letters of the description (notation, abbreviations) in which formulas are written, also where nothing gets "
    "shorter; parameters among them stay; none: in parameters alone (subsystems and their stability stay in the "
    "notation).  [default: those that make a formula shorter]"
)


def letters_option() -> click.Option:
    return click.Option(["--in", "letters"], metavar="LETTERS", help=_HELP)


def read_letters(text: str | None, system: System, options: Options) -> tuple[str, ...] | None:
    """The letters that were asked for, and parameters that are to stay; () for none, None where nothing was asked."""
    from mbsym.report.letters import NONE, letters_of
    from mbsym.source.scope import did_you_mean, listed

    if text is None:
        return None
    known = [name for name, _ in letters_of(system).given]
    named = list(dict.fromkeys(part.strip() for part in text.split(",") if part.strip()))
    if named == [NONE] and NONE not in known:
        return ()
    if not known:
        hint = "declare them: abbreviations: {c1: mA + mB}"
        options.complain("--in", "missing-key", "the description has no letters of its own", hint)
    elif not any(name in known for name in named):
        options.complain(
            "--in", "unknown-letter", "there is no letter of the description in it", listed("there are", known)
        )
    else:
        for name in named:
            if name not in known and name not in system.parameter_names:
                near = did_you_mean(name, known) or listed("there are", known)
                options.complain(
                    "--in", "unknown-letter", Message("there is no letter [[name]]", name=ascii_safe(name)), near
                )
    return tuple(named)
