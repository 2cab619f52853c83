"""``mbsym explain``: what a problem does and the formula it uses."""

from __future__ import annotations

import sys

import click

from mbsym_cli.console import BAD_INPUT


@click.command("explain")
@click.argument("number", required=False)
def command(number: str | None) -> None:
    """Print what problem NUMBER does and the formula it uses; without NUMBER, the list of problems.

    'claims' in place of a number explains how claims are checked, and lists their kinds.

    \b
    Example:
      mbsym explain 5
    """
    from mbsym.analysis import PROBLEMS

    if number is None:
        for problem in PROBLEMS.values():
            click.echo(f"{problem.number}  {problem.title}")
        return
    if number == "claims":
        click.echo(_claims())
        return
    if not number.isdigit() or int(number) not in PROBLEMS:
        click.echo(f"there is no problem {number}; problems are numbered 1 to {len(PROBLEMS)}", err=True)
        sys.exit(BAD_INPUT)
    click.echo(PROBLEMS[int(number)].explanation)


def _claims() -> str:
    from mbsym.model.claims import CLAIMS
    from mbsym.problems import claims

    width = max(map(len, CLAIMS))
    kinds = "\n".join(f"    {kind:<{width}}  {entry.meaning}" for kind, entry in CLAIMS.items())
    return f"{str(claims.__doc__).strip()}\n\nKinds of claim:\n\n{kinds}"
