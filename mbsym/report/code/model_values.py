"""The numbers of a description as generated code holds them: parameters, relations between them, the initial state."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

from mbsym.algebra.failures import Failure
from mbsym.expressions.tree import ZERO, Expression, names
from mbsym.model.quantities import marked
from mbsym.model.system import System
from mbsym.numerics.scenario import exact
from mbsym.report.code.functions import Functions
from mbsym.report.numbers import number


@dataclass(frozen=True)
class Value:
    """A parameter: ``local`` its name in the language, ``text`` its value there, empty where it has none.

    ``needs`` are the parameters that a relation makes it of, in the order of the description.
    """

    name: str
    local: str
    text: str
    meaning: str
    needs: tuple[str, ...] = ()
    unit: str = ""

    @property
    def told(self) -> str:
        """What it means, and its unit."""
        return marked(self.meaning, self.unit).strip()


def parameters_of(system: System, writer: Functions) -> list[Value]:
    """A relation gives a value unless it goes round in a circle; else the description's number does."""
    related = {item.name: item.value for item in system.relations}
    related |= {p.name: p.value for p in system.parameters if p.name not in related and p.value and _made(p.value)}
    found = []
    for item in system.parameters:
        written, needs = "", set[str]()
        if item.name in related and not _circular(item.name, related):
            with suppress(Failure):  # a power that no program has: then its number has to do
                written, needs = writer.expression(related[item.name]), names(related[item.name])
        if not written and item.value is not None and not _made(item.value):
            written = number(exact(item.value, {}))
        unit = system.units.of(item.name) or ""
        used = tuple(name for name in system.parameter_names if name in needs)
        found.append(Value(item.name, writer.names[item.name], written, " ".join(item.meaning.split()), used, unit))
    return found


def _made(value: Expression) -> bool:
    """Whether it is made of other parameters."""
    return bool(names(value) - {"pi"})


def _circular(name: str, related: dict[str, Expression]) -> bool:
    seen: set[str] = set()
    pending = [name]
    while pending:
        for other in names(related.get(pending.pop(), ZERO)) - seen:
            if other == name:
                return True
            seen.add(other)
            pending.append(other)
    return False


def ordered(parameters: Sequence[Value]) -> tuple[Value, ...]:
    """Those without a relation first, then relations, each after what it needs."""
    done = [item for item in parameters if not item.needs]
    left = [item for item in parameters if item.needs]
    while left:
        known = {item.name for item in done}
        ready = [item for item in left if known.issuperset(item.needs)]
        done += ready
        left = [item for item in left if item not in ready]
        assert ready
    return tuple(done)


def initial_values(system: System, writer: Functions) -> list[tuple[str, str]]:
    """(name, value) of q and q'; velocities that are not given are zero, as in simulations."""
    given = {item.coordinate: item for item in system.begun}
    placed: list[tuple[str, str]] = []
    moving: list[tuple[str, str]] = []
    for name, rate in zip(system.coordinates, system.velocities, strict=True):
        entry = given.get(name)
        position = entry.position if entry is not None else None
        velocity = entry.velocity if entry is not None else None
        placed.append((name, "" if position is None else _value(writer, position)))
        moving.append((rate, _value(writer, ZERO if velocity is None else velocity)))
    return placed + moving


def _value(writer: Functions, value: Expression) -> str:
    return writer.expression(value) if _made(value) else number(exact(value, {}))


def starting(system: System, parameters: Sequence[Value]) -> list[tuple[int, str]]:
    """The parameters of which initial values are made: place, and name in the language."""
    values = [x for item in system.begun for x in (item.position, item.velocity) if x is not None]
    used = {name for value in values for name in names(value)}
    return [(place, item.local) for place, item in enumerate(parameters) if item.name in used]
