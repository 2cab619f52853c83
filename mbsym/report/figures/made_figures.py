"""Figures of a simulation that stands beside a report, where it is one of the same description."""

from __future__ import annotations

import json
from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

#: What pdflatex takes, the better first.
_KINDS = ("pdf", "png")


@dataclass(frozen=True)
class MadeFigure:
    """``filename`` beside the report; ``until`` and ``method`` say what was simulated, ``whole`` whether to its end."""

    filename: str
    until: str
    method: str
    whole: bool


def made_figures(simulation: str, description: str, present: Collection[str]) -> tuple[MadeFigure, ...]:
    """The figures that a ``simulation.json`` names and that are ``present``, each in one kind.

    Nothing where the text is none of a simulation, or not of the description with this hash: a figure of another
    system, or of this one before it was changed, would be a false statement.
    """
    try:
        record: dict[str, Any] = json.loads(simulation)
        if record["description_sha256"] != description:
            return ()
        until, method = f"{float(record['reached']['time']):.6g}", str(record["method"]["title"])
        whole, names = record["status"] == "whole", [str(name) for name in record["files"]]
    except (ValueError, KeyError, TypeError):
        return ()
    stems = dict.fromkeys(name.rpartition(".")[0] for name in names if name.rpartition(".")[2] in _KINDS)
    chosen = [next((f"{stem}.{kind}" for kind in _KINDS if f"{stem}.{kind}" in present), "") for stem in stems]
    plain = (name for name in chosen if name in names and name.replace("-", "").replace(".", "").isalnum())
    return tuple(MadeFigure(name, until, method, whole) for name in plain)
