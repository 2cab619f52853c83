"""The symbols of periodic solutions, as claims about oscillations and abbreviations may name them."""

from __future__ import annotations

from mbsym.expressions.tree import Expression, names
from mbsym.model.claims import CLAIMS
from mbsym.model.oscillation_names import oscillation_names
from mbsym.model.system import velocity_name
from mbsym.source.placed import Mapping, Node, Scalar, Sequence
from mbsym.source.reading import Reading

#: What such names are in a scope, and abbreviations that hold some.
SYMBOL, ABBREVIATION = OSCILLATION_KINDS = "oscillation", "oscillation abbreviation"
#: What inputs are in a scope, and abbreviations that hold some.
INPUT_KINDS = ("input", "input abbreviation")

#: What may oscillate.
VARIABLES = ("coordinate", "velocity", "speed", "unit vector", "quaternion")


def enter_symbols(claims: Node | None, abbreviations: Node | None, reading: Reading) -> None:
    """From here on the scope knows phase, amplitude, x_0 of every variable x, if a claim is about an oscillation."""
    if not _about_oscillations(claims):
        return
    scope = reading.scope
    own = scope.of_kind("coordinate")
    variables = [*own, *map(velocity_name, own), *scope.of_kind("unit vector", "quaternion", "speed")]
    written = abbreviations.entries if isinstance(abbreviations, Mapping) else ()
    taken = {*scope.kinds, *(entry.key.text for entry in written)}
    scope.kinds.update(dict.fromkeys(oscillation_names(variables, taken).all, SYMBOL))


def leave_symbols(reading: Reading) -> None:
    for name in reading.scope.of_kind(SYMBOL):
        del reading.scope.kinds[name]


def kind_of_abbreviation(value: Expression, reading: Reading) -> str:
    """One that holds symbols of an oscillation, or inputs, be it in another one, stands only where these may."""
    held = {reading.scope.kinds.get(name) for name in names(value)}
    if held.intersection(OSCILLATION_KINDS):
        return ABBREVIATION
    return INPUT_KINDS[1] if held.intersection(INPUT_KINDS) else "abbreviation"


def _about_oscillations(claims: Node | None) -> bool:
    for item in claims.items if isinstance(claims, Sequence) else ():
        for entry in item.entries if isinstance(item, Mapping) else ():
            if entry.key.text == "claim" and isinstance(entry.value, Scalar):
                kind = CLAIMS.get(" ".join(entry.value.text.lower().split()))
                if kind is not None and kind.oscillates:
                    return True
    return False
