"""``mbsym schema``: the JSON Schemas of what mbsym reads and writes."""

from __future__ import annotations

import json
import sys

import click

from mbsym.source import json_schema
from mbsym_cli.console import BAD_INPUT
from mbsym_cli.options import Options

#: What is read; the others are written.
DESCRIPTION = "description"


@click.command("schema")
@click.argument("which", default=DESCRIPTION)
def command(which: str) -> None:
    """Print a JSON Schema: of the YAML description, or of a JSON file that mbsym writes.

    WHICH is description (the default; editors complete and check with it), or one of results, simulation, equilibria,
    extremes and whatever else is written as JSON.

    \b
    Examples:
      mbsym schema > mbsym.schema.json
      mbsym schema results > results.schema.json
    """
    from mbsym.report.schemas import names, schema

    asked = Options()
    kinds = asked.words("WHICH", which, (DESCRIPTION, *names()), "schema")
    if asked.refused() or len(kinds) != 1:
        sys.exit(BAD_INPUT)
    found = json_schema() if kinds[0] == DESCRIPTION else schema(kinds[0])
    click.echo(json.dumps(found, indent=2, ensure_ascii=False))
