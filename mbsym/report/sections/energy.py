"""Problem 2, energy: what results.json and reports show of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from msgspec import UNSET

from mbsym.model.system import System
from mbsym.problems.energy import Energy
from mbsym.report.content import (
    Block,
    Display,
    Folded,
    Heading,
    Matrices,
    Name,
    Notation,
    Relation,
    Said,
    Symbol,
    named,
    paragraph,
    say,
)
from mbsym.report.documents import results as doc
from mbsym.report.documents.base import Write

if TYPE_CHECKING:
    from mbsym.report.results import Results


def data(energy: Energy, system: System, write: Write) -> doc.Energy:
    """The section of results.json."""
    return doc.Energy.from_result(energy, write, speeds=energy.speeds if system.speeds else UNSET)


def content(results: Results) -> Iterator[Block]:
    """What reports say."""
    yield Heading("energy", Said("Problem 2. Kinetic energy and force function"))
    system, energy, compact = results.system, results.by_problem.get(2), results.compact.get(2)
    yield from results.missing(2)
    closed: tuple[Block, ...] = () if energy is None else tuple(_closed(energy, results))
    if compact is not None:
        yield paragraph(
            Said(
                "$T = \\frac12 \\sum A_{ij}\\, \\dot q_i \\dot q_j + \\sum A_i\\, \\dot q_i + A_0$ "
                "is written as a whole."
            )
        )
        yield from results.intermediates(2)
        yield Display(Relation(Symbol("T"), "=", compact.system.kinetic_energy), "T")
        yield Display(Relation(Symbol("U"), "=", compact.system.force_function), "U")
        if closed:
            yield Folded(Said("The same, written out"), closed)
    else:
        yield from closed
    cyclic, prescribed = ((), ()) if energy is None else _absent(energy, system)
    felt = [] if system.constraints else [name for name in cyclic if is_felt(name, results.by_problem)]
    if felt:
        text = "$L$ does not contain $[[names]]$, but other forces depend on it."
        yield from (paragraph(say(text, names=Name(name))) for name in felt)
    if cyclic := [name for name in cyclic if name not in felt]:
        text = (
            "$L$ does not contain $[[names]]$; whether a momentum is kept depends on the constraints."
            if system.constraints
            else "$L$ does not contain $[[names]]$: cyclic."
        )
        yield paragraph(say(text, names=named(cyclic)))
    if prescribed:
        yield paragraph(say("$L$ does not contain $[[names]]$, which is prescribed.", names=named(prescribed)))


_SUM = r"T = \frac12 \sum A_{ij}\, \dot q_i \dot q_j + \sum A_i\, \dot q_i + A_0"
_SUM_OF_SPEEDS = r"T = \frac12 \sum A_{ij}\, u_i u_j + \sum A_i\, u_i + A_0"


def _closed(energy: Energy, results: Results) -> Iterator[Block]:
    """T by powers of the velocities, and U."""
    yield Display(Relation(Symbol("T"), "=", energy.kinetic_energy), "T")
    known = 3 in results.by_problem
    yield paragraph(
        Notation(_SUM_OF_SPEEDS if results.system.speeds else _SUM),
        " ",
        Said("with $A_{ij} = M_{ij}$ of problem 3" if known else "with $A_{ij} = M_{ij}$ and"),
        ":",
    )
    if not known:
        yield Matrices(Symbol("A"), energy.A2, True, "A")
    if all(x.is_zero for x in energy.A1):
        yield Display(Relation(Symbol("A", "i"), "=", 0), "A:linear")
    else:
        for k, entry in enumerate(energy.A1, start=1):
            yield Display(Relation(Symbol("A", str(k)), "=", entry), f"A:linear:{k}")
    yield Display(Relation(Symbol("A", "0"), "=", energy.A0), "A:zero")
    yield Display(Relation(Symbol("U"), "=", energy.force_function), "U")


def is_felt(name: str, solutions: Mapping[int, Any]) -> bool:
    """Whether forces that U does not hold depend on a coordinate, as far as problem 3 was derived."""
    forces = getattr(solutions.get(3), "generalized_force", ())
    return any(force.ring.dependencies(force.polynomial, (name,)) for force in forces)


def _absent(energy: Energy, system: System) -> tuple[list[str], list[str]]:
    """What L does not contain: coordinates, and prescribed quantities, which have no momentum."""
    cyclic = [name for name in energy.cyclic if name in system.coordinates]
    return cyclic, [name for name in energy.cyclic if name not in cyclic]
