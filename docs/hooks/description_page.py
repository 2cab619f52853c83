"""The page on descriptions, from the tables that the reader itself goes by."""

from __future__ import annotations

from collections.abc import Mapping

from in_markdown import code, escaped, fenced, table

from mbsym.source import keys, topics
from mbsym.source.grammar import Key

_HEAD = """\
# Description

What may stand in a description. This page is made of the tables that the reader itself goes by; `mbsym explain
description`, `loads`, `expressions` and `claims` print the same. The [tutorial](../tutorial.md) builds a description
step by step.

Descriptions are YAML, or the plain text of the description editor; `mbsym convert` goes both ways. Nothing in a
description is executed.
"""

_PARTS = (
    ("The whole", keys.SYSTEM, ""),
    (
        "A parameter",
        keys.PARAMETER,
        "`parameters: {m: positive}` is the short form of a sign word, `{m: 2}` of a value.",
    ),
    ("A prescribed quantity", keys.PRESCRIBED, ""),
    ("A body", keys.BODY, ""),
    ("Its rotation", keys.ROTATION, ""),
    ("Its inertia, where identified values are to be taken as given", keys.INERTIA, ""),
    ("Its shapes, for drawing", keys.SHAPE, "Each shape has one of the kinds as its key."),
    ("The motion of a coordinate", keys.MOTION, ""),
    ("The initial state of a coordinate", keys.INITIAL, ""),
)


def page() -> str:
    """The page in Markdown."""
    parts = [
        _HEAD,
        *(_section(*part) for part in _PARTS),
        "## Loads\n",
        "A list; each load is `- kind: {key: value, ...}`, or `- kind: expression`.\n",
    ]
    for name, kind in keys.LOADS.items():
        parts += [f"### {name}\n", f"{escaped(kind.meaning)}.\n", _keys(kind.keys) if kind.keys else ""]
    parts += ["### Points\n", "For `between`.\n", _keys(keys.POINT)]
    parts += ["## Formulas\n", fenced(topics.expressions()), "## Claims\n", _claims()]
    return "\n".join(parts)


def _section(title: str, members: Mapping[str, Key], remark: str) -> str:
    return f"## {title}\n\n{remark}\n\n{_keys(members)}"


def _keys(members: Mapping[str, Key]) -> str:
    return table(("key", "meaning"), [(code(name), escaped(key.meaning)) for name, key in members.items()])


def _claims() -> str:
    head = "Formulas that somebody printed, to be checked: [how to](../howto/claims.md)."
    return f"{head}\n\n{fenced(topics.claim_kinds())}"
