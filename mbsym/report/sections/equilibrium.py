"""Problem 4, equilibrium: what results.json and reports show of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from mbsym.model.system import System
from mbsym.problems.equilibrium import Equilibrium
from mbsym.report.content import Block, Display, Heading, Name, Relation, Said, named, paragraph, say
from mbsym.report.documents import results as doc
from mbsym.report.documents.base import Write
from mbsym.report.sections.system import unperturbed_motion

if TYPE_CHECKING:
    from mbsym.report.results import Results


def data(found: Equilibrium, system: System, write: Write) -> doc.Equilibrium:
    """The section of results.json."""
    solved = {name: str(value) for name, value in found.solved}
    return doc.Equilibrium.from_result(found, write, impossible=bool(found.impossible), solved=solved)


IN_COORDINATES = (
    "Problems 4 to 6 are told in generalised coordinates and velocities. Near the motion these and the state in speeds "
    "(and unit vectors) are smooth functions of each other, so that stability is the same in both."
)

SINGULAR = (
    "The coordinates are singular there: [[names]] can change so that, to first order, nothing moves. The equations in "
    "regular coordinates demand more, which follows from the first derivatives of these and is demanded here, too."
)


def exists_if(found: Equilibrium) -> Said:
    """What is said before the conditions: of those that vary along the motion, that they have to hold all the time."""
    if found.unsteady:
        return Said("satisfies the equations of motion if and only if, at all times,")
    return Said("satisfies the equations of motion if and only if")


def content(results: Results) -> Iterator[Block]:
    """What reports say."""
    yield Heading("equilibrium", Said("Problem 4. The unperturbed motion"))
    system, found = results.system, results.found.get(4)
    if system.motion or found is not None:
        yield paragraph(Said("The unperturbed motion"))
        yield Display(unperturbed_motion(system), "motion")
    yield from results.missing(4)
    if found is None:
        return
    if found.satisfied:
        yield paragraph(Said("satisfies the equations of motion identically."))
    elif found.impossible:
        yield paragraph(Said("does not satisfy the equations of motion: these can never vanish."))
        yield from map(Display, found.impossible)
    else:
        yield paragraph(exists_if(found))
        for k, condition in enumerate(found.conditions, start=1):
            yield Display(Relation(condition, "=", 0), f"equilibrium:{k}")
        if found.solved:
            yield paragraph(Said("which problems 5 and 6 use in the form"))
        for k, (name, value) in enumerate(found.solved, start=1):
            yield Display(Relation(Name(name), "=", value), f"solved:{k}")
    if found.singular:
        names = named(dict.fromkeys(name for one in found.singular for name, _ in one))
        yield paragraph(say(SINGULAR, names=names))
    if system.speeds:
        yield paragraph(Said(IN_COORDINATES))
