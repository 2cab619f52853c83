"""The end of the page on descriptions, from the tables that the reader itself goes by."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from in_markdown import code, escaped, fenced, table

from mbsym.source import keys, topics
from mbsym.source.grammar import Key, Kind, Record

_HEAD = """\
## Every key

What follows is made of the table that the reader itself goes by; `mbsym explain description`, `loads`, `constraints`,
`expressions` and `claims` print the same.
"""

_REMARKS = {
    "A parameter": "`parameters: {m: positive}` is the short form of a sign word, `{m: 2}` of a value.",
}


def tail() -> str:
    """It in Markdown."""
    parts = [_HEAD, *map(_section, topics.records(keys.DESCRIPTION))]
    loads = "A list; each load is `- kind: {key: value, ...}`, or `- kind: expression`.\n"
    parts += ["## Loads\n", loads, *_kinds(keys.LOADS)]
    constraints = "A list; each is `- kind: {key: value, ...}`, or `- kind: equation`, or two ends.\n"
    parts += ["## Constraints\n", constraints, *_kinds(keys.CONSTRAINTS)]
    parts += ["## Formulas\n", fenced(topics.expressions()), "## Claims\n", _claims()]
    return "\n".join(parts)


def _section(record: Record) -> str:
    return f"## {record.title}\n\n{_REMARKS.get(record.title, '')}\n\n{_keys(topics.keys_of(record))}"


def _kinds(kinds: Mapping[str, Kind]) -> Iterator[str]:
    for name, kind in kinds.items():
        yield f"### {name}\n\n{escaped(kind.meaning)}.\n\n" + (_keys(kind.keys) if kind.keys else "")
    for end in topics.ends(kinds):
        yield f"### {end.title}\n\n{_keys(end.keys)}"


def _keys(members: Mapping[str, Key]) -> str:
    return table(("key", "meaning"), [(code(name), escaped(key.meaning)) for name, key in members.items()])


def _claims() -> str:
    head = "Formulas that somebody printed, to be checked: [how to](../howto/claims.md)."
    return f"{head}\n\n{fenced(topics.claim_kinds())}"
