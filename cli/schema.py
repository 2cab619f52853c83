"""``mbsym schema``: the JSON Schemas of what mbsym reads and writes."""

from __future__ import annotations

import json
import sys
from typing import Any

import click

from mbsym.source import json_schema
from mbsym.studies.study import Exit
from mbsym_cli.console import among
from mbsym_cli.options import Options

#: What is read; the others are written.
DESCRIPTION = "description"
#: What a batch writes.
SUMMARY = "summary"


@click.command("schema")
@click.argument("which", default=DESCRIPTION, shell_complete=among(lambda: _kinds()))
def command(which: str) -> None:
    """Print a JSON Schema: of the YAML description, or of a JSON file that mbsym writes.

    WHICH is description (the default; editors complete and check with it), summary (of a batch), or one of results,
    simulation, equilibria, extremes and whatever else is written as JSON.

    \b
    Examples:
      mbsym schema > mbsym.schema.json
      mbsym schema results > results.schema.json
    """
    options = Options()
    kinds = options.words("WHICH", which, _kinds(), "schema")
    if options.refused() or len(kinds) != 1:
        sys.exit(Exit.BAD_INPUT)
    click.echo(json.dumps(_schema(kinds[0]), indent=2, ensure_ascii=False))


def _kinds() -> tuple[str, ...]:
    from mbsym.report.schemas import names

    return (DESCRIPTION, *names(), SUMMARY)


def _schema(kind: str) -> dict[str, Any]:
    """What is read and what tells of a batch have their schemas where they are read and told."""
    if kind == DESCRIPTION:
        return json_schema()
    if kind == SUMMARY:
        from mbsym.batch.summary_json import schema as of_batches

        return of_batches()
    from mbsym.report.schemas import schema

    return schema(kind)
