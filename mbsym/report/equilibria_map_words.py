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

_RUSSIAN = {
    STANDINGS[Standing.INCOMPLETE]: "не сосчитаны: список неполон",
    STANDINGS[Standing.FAMILIES]: "бесконечно много равновесий",
    STANDINGS[Standing.WITHDRAWN]: "отозвано: проверка не прошла",
    STANDINGS[Standing.NOT_REACHED]: "не рассмотрено",
    ORIGINS[Origin.SINGULAR]: "вырожденные равновесия: бифуркация либо ни одного вещественного",
    ORIGINS[Origin.LEAVING]: "равновесия на бесконечности или на границе либо ни одного вещественного",
    _AT_SAMPLE: "только в пробной точке",
    "equilibria": "равновесий",
    "stable": "устойчивых",
    "stable at the sample": "устойчивых в пробной точке",
    "Numbers of relative equilibria of": "Числа относительных равновесий:",
    "The curves of the map:": "Кривые карты:",
}
_SPANISH = {
    STANDINGS[Standing.INCOMPLETE]: "sin contar: la lista no es completa",
    STANDINGS[Standing.FAMILIES]: "infinitos equilibrios",
    STANDINGS[Standing.WITHDRAWN]: "retirado: la comprobación falló",
    STANDINGS[Standing.NOT_REACHED]: "no alcanzado",
    ORIGINS[Origin.SINGULAR]: "equilibrios singulares: bifurcación, o ninguno real",
    ORIGINS[Origin.LEAVING]: "equilibrios en el infinito o en un borde, o ninguno real",
    _AT_SAMPLE: "solo en la muestra",
    "equilibria": "equilibrios",
    "stable": "estables",
    "stable at the sample": "estables en la muestra",
    "Numbers of relative equilibria of": "Números de equilibrios relativos de",
    "The curves of the map:": "Las curvas del mapa:",
}

WORDS = {"ru": _RUSSIAN, "es": _SPANISH}


def say(language: Language, english: str) -> str:
    """A phrase of maps of equilibria in a language."""
    return WORDS.get(language.name, {}).get(english, english)


def cell_words(cell: Cell, language: Language = ENGLISH) -> str:
    """``24 equilibria, 4 stable``."""
    if not cell.counted:
        return say(language, STANDINGS[cell.standing])
    as_said = cell.throughout or cell.standing is Standing.SAMPLE
    stable = say(language, "stable" if as_said else "stable at the sample")
    if language.name == "en":
        told = f"{counted(cell.count, 'equilibrium', 'equilibria')}, {cell.stable} {stable}"
    else:
        told = f"{say(language, 'equilibria')}: {cell.count}; {stable}: {cell.stable}"
    return told if cell.standing is Standing.PROVED else f"{told} ({say(language, _AT_SAMPLE)})"
