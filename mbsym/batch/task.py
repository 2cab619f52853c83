"""What is to be done with one description, what it may cost, and what comes back: plain data that travels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from mbsym.batch.outcome import Row


@dataclass(frozen=True)
class Asked:
    """What is asked of every description of a batch.

    ``problems`` None: those that the formats show.  ``angles`` is ``products``, ``sums``, ``shorter``, or None: what
    each kind of text usually has.  ``detail`` is ``compact`` or ``full``.
    """

    formats: tuple[str, ...]
    problems: tuple[int, ...] | None = None
    terms: int = 60_000
    angles: str | None = None
    detail: str = "compact"


@dataclass(frozen=True)
class Task:
    """One description: its name for complaints, its bytes as they were read once, its folder in the batch's.

    ``known`` is the digest of the description (``digests.meaning``) whose results are there already, or "": where this
    one means the same, nothing is derived.
    """

    file: str
    folder: str
    data: bytes
    asked: Asked
    known: str = ""


@dataclass(frozen=True)
class Budget:
    """What one description may cost: ``seconds`` on the wall, ``memory`` in bytes; None: no bound."""

    seconds: float | None = None
    memory: int | None = None


@dataclass(frozen=True)
class Finished:
    """What became of a task: its row, and the files by their names.

    ``meaning`` is the digest of the description after normalisation, "" where it has none.  ``same`` says that it is
    the ``known`` one, so that the row holds nothing but the complaints.
    """

    row: Row
    files: Mapping[str, str | bytes] = field(default_factory=dict)
    meaning: str = ""
    same: bool = False
