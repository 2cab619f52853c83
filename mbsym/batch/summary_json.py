"""``summary.json``: what became of every description, for programs.

The member ``run`` has what differs from batch to batch (seconds, what was up to date, budgets); everything else is the
same bytes for the same descriptions and options.
"""

from __future__ import annotations

import json
from importlib.resources import files
from typing import Any

from mbsym.batch.outcome import FORMAT, Row, Summary
from mbsym.batch.transport import row_data
from mbsym.expressions.safe import encodable

#: The file, and the schema that it keeps to, which is a file of this package.
FILENAME, SCHEMA = "summary.json", "summary.schema.json"


def schema() -> dict[str, Any]:
    """The JSON Schema of ``summary.json``."""
    found: dict[str, Any] = json.loads(files("mbsym.batch").joinpath(SCHEMA).read_text(encoding="utf-8"))
    return found


def summary_data(summary: Summary) -> dict[str, Any]:
    """The file as nested lists and dictionaries."""
    return {
        "format": FORMAT,
        "mbsym": summary.version,
        "derivation": summary.derivation,
        "options": {
            "problems": None if summary.problems is None else list(summary.problems),
            "formats": list(summary.formats),
            "terms": summary.terms,
            "angles": summary.angles,
            "detail": summary.detail,
        },
        "shard": summary.shard,
        "exit_code": summary.exit_code,
        "totals": {
            "systems": len(summary.rows),
            "outcomes": {outcome.value: count for outcome, count in summary.totals.items()},
        },
        "systems": [_system(row) for row in summary.rows],
        "run": {
            "seconds": round(summary.seconds, 3),
            "timeout": summary.timeout,
            "memory": summary.memory,
            "cached": summary.cached,
            "systems": {row.file: {"cached": row.cached, "seconds": round(row.seconds, 3)} for row in summary.rows},
        },
    }


def summary_text(summary: Summary) -> str:
    """The file's text."""
    return encodable(json.dumps(summary_data(summary), indent=2, ensure_ascii=False)) + "\n"


def _system(row: Row) -> dict[str, Any]:
    return {"exit_code": row.exit_code} | row_data(row)
