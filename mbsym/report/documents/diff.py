"""What ``mbsym diff --format json`` prints."""

from __future__ import annotations

from typing import Annotated, Any

from mbsym.report.documents.base import Format, Part, words


class RenamedRow(Part, frozen=True):
    """a name that was replaced throughout"""

    kind: Annotated[str, words("parameter", "coordinate", "body"), "what it is the name of"]
    before: Annotated[str, "in A"]
    after: Annotated[str, "in B"]


class ChangeRow(Part, frozen=True):
    """a change"""

    path: Annotated[list[str], "property names, names of items and numbers counted from 1, leading to the place"]
    kind: Annotated[str, words("added", "removed", "changed", "order", "formula", "undecided"), "what happened there"]
    before: Annotated[Any, "what stands in A; null where nothing does"]
    after: Annotated[Any, "what stands in B; null where nothing does"]
    difference: Annotated[str | None, "of a formula: B - A; null where it is long"]
    terms: Annotated[int, "of a formula: terms of B - A; 0 for what is no formula"]
    first: Annotated[str | None, "of a long difference: its first term"]
    points: Annotated[int, "of an undecided formula: points at which both agree"]


class SystemDiff(Part, frozen=True):
    """one system"""

    system: Annotated[str, "its name: the folder or the description"]
    same: Annotated[bool, "whether both say the same"]
    versions: Annotated[list[str], "of mbsym that wrote A and B"]
    renamed: Annotated[list[RenamedRow], "renamings, proved by exact comparison"]
    changes: Annotated[list[ChangeRow], "changes"]
    restated: Annotated[list[Annotated[list[str], "a path"]], "places of formulas that are equal and printed otherwise"]


class OnlyIn(Part, frozen=True):
    """systems that are in one of them only"""

    a: Annotated[list[str], "in A only"]
    b: Annotated[list[str], "in B only"]


class Diff(Part, frozen=True, kw_only=True):
    """What changed from A to B."""

    format: Format = 1
    systems: Annotated[list[SystemDiff], "systems that are in both"]
    only_in: OnlyIn
