"""``mbsym schema``: the JSON Schema of the YAML spelling."""

from __future__ import annotations

import json

import click

from mbsym.source import json_schema


@click.command("schema")
def command() -> None:
    """Print a JSON Schema of descriptions, so that editors complete and check the YAML.

    \b
    Example:
      mbsym schema > mbsym.schema.json
    """
    click.echo(json.dumps(json_schema(), indent=2))
