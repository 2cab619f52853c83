"""The page on JSON files, from the schemas of the types."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

from in_markdown import code, escaped, table

from mbsym.batch.summary_json import schema as of_batches
from mbsym.report.schemas import names, schema
from mbsym.source import json_schema

_HEAD = """\
# JSON files

What mbsym writes as JSON for other programs has a JSON Schema (draft 2020-12); `mbsym schema WHICH` prints it. The
schema of descriptions is [description.schema.json](description.schema.json).
"""


def schemas() -> dict[str, str]:
    """File name -> text of every schema."""
    found = {"description": json_schema(), **_written()}
    return {f"{name}.schema.json": json.dumps(each, indent=2, ensure_ascii=False) for name, each in found.items()}


def _written() -> dict[str, dict[str, Any]]:
    """The schemas of what is written, by name."""
    return {**{name: schema(name) for name in names()}, "summary": of_batches()}


def page() -> str:
    """The page in Markdown."""
    parts = [_HEAD]
    for name, found in _written().items():
        parts += [f"## {name}\n", f"{escaped(found.get('description') or found.get('title', ''))}\n"]
        parts += [f"[{name}.schema.json]({name}.schema.json), from `mbsym schema {name}`.\n"]
        parts += [table(("property", "type", "meaning"), _rows(found, "", found))]
        for definition, each in found.get("$defs", {}).items():
            rows = list(_rows(each, "", found))
            if rows:
                parts += [f"### {name}: {escaped(definition)}\n", f"{escaped(each.get('description', ''))}\n"]
                parts += [table(("property", "type", "meaning"), rows)]
    return "\n".join(parts)


def _rows(node: Mapping[str, Any], path: str, root: Mapping[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Of each property in a schema its path, type and meaning; what stands in ``$defs`` has a table of its own."""
    for name, member in node.get("properties", {}).items():
        yield from _row(member, f"{path}.{name}".lstrip("."), root)
    if isinstance(node.get("additionalProperties"), Mapping):
        yield from _row(node["additionalProperties"], f"{path}.NAME".lstrip("."), root)
    if isinstance(node.get("items"), Mapping) and node["items"].get("properties"):
        yield from _rows(node["items"], f"{path}[]", root)


def _row(member: Any, path: str, root: Mapping[str, Any]) -> Iterator[tuple[str, str, str]]:
    if isinstance(member, Mapping):
        yield code(path), escaped(_type(member)), escaped(str(member.get("description", "")))
        yield from _rows(member, path, root)


def _type(member: Mapping[str, Any]) -> str:
    if "$ref" in member:
        return str(member["$ref"]).rpartition("/")[2]
    if "const" in member:
        return json.dumps(member["const"], ensure_ascii=False)
    if "enum" in member:
        return ", ".join(json.dumps(word, ensure_ascii=False) for word in member["enum"])
    for key in ("anyOf", "oneOf"):
        if key in member:
            return " or ".join(filter(None, (_type(each) for each in member[key])))
    kind = member.get("type", "")
    if kind == "array" and isinstance(member.get("items"), Mapping):
        return f"list of {_type(member['items']) or 'anything'}"
    return " or ".join(kind) if isinstance(kind, list) else str(kind)
