"""The author's letters in results: which there are, and what those stand for that are used."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from contextlib import contextmanager

from mbsym.formulas.letters import Letters, letters_as
from mbsym.model.system import System
from mbsym.report.content import Beside, Block, Definitions, Heading, Lettered, Name, Relation, Said

#: In place of letters, for none.
NONE = "none"


def letters_of(system: System, requested: tuple[str, ...] | None = None) -> Letters:
    """Notation and abbreviations, of which ``requested`` ones are wanted; None: all where that is shorter.

    Made once for a system: what is written in them is kept with them.
    """
    known: dict[tuple[str, ...] | None, Letters] = vars(system).setdefault("_letters", {})
    if requested not in known:
        notation = tuple((symbol.name, symbol.value) for symbol in system.notation)
        known[requested] = Letters((*notation, *((item.name, item.value) for item in system.abbreviations)), requested)
    return known[requested]


@contextmanager
def in_letters(system: System, requested: tuple[str, ...] | None) -> Iterator[set[str]]:
    """Within this block formulas of the system are written so; what is yielded gathers the letters that were used."""
    with letters_as(letters_of(system, requested)) as used:
        yield used


def with_meanings(
    blocks: Iterable[Block], system: System, used: Collection[str], explained: Collection[str] = ()
) -> Iterator[Block]:
    """The blocks with what the letters in them stand for; the heading, if there is one, is the first.

    ``explained``: letters of which the blocks say it themselves.
    """

    def meanings() -> tuple[Block, ...]:
        meant = [definition for definition in letters_of(system).definitions(used) if definition[0] not in explained]
        items = tuple(Relation(Name(name), "=", value) for name, value in meant)
        names = tuple(x.name for x in system.abbreviations)
        return (Beside(names, (Definitions(Said("Letters used here"), items),)),) if items else ()

    listed = list(blocks)
    if listed and isinstance(listed[0], Heading):
        yield listed.pop(0)
    yield Lettered(tuple(listed), meanings)
