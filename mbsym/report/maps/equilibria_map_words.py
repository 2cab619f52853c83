"""The words of maps of equilibria."""

from __future__ import annotations

from mbsym.expressions.counting import counted
from mbsym.maps.equilibria_map import Cell, Origin, Standing
from mbsym.report.language import Language

ENGLISH = Language()

STANDINGS = {
    Standing.INCOMPLETE: "not counted: the list is not complete",
    Standing.FAMILIES: "infinitely many equilibria",
    Standing.WITHDRAWN: "withdrawn: the check failed",
    Standing.NOT_REACHED: "not reached",
}
ORIGINS = {
    Origin.SINGULAR: "singular equilibria: bifurcation, or none that is real",
    Origin.LEAVING: "equilibria at infinity or at a border, or none that is real",
}
_AT_SAMPLE = "at the sample only"


def cell_words(cell: Cell, language: Language = ENGLISH) -> str:
    """``24 equilibria, 4 stable``."""
    if not cell.counted:
        return language.say(STANDINGS[cell.standing])
    as_said = cell.throughout or cell.standing is Standing.SAMPLE
    stable = language.say("stable" if as_said else "stable at the sample", "number of equilibria")
    if language.name == "en":
        told = f"{counted(cell.count, 'equilibrium', 'equilibria')}, {cell.stable} {stable}"
        told += f", {cell.undecided} undecided" if cell.undecided else ""
    else:
        told = f"{language.say('equilibria')}: {cell.count}; {stable}: {cell.stable}"
        told += f"; {language.say('undecided')}: {cell.undecided}" if cell.undecided else ""
    return told if cell.standing is Standing.PROVED else f"{told} ({language.say(_AT_SAMPLE)})"
