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


def data(equilibrium: Equilibrium, system: System, write: Write) -> doc.Equilibrium:
    """The section of results.json."""
    solved = {name: str(value) for name, value in equilibrium.solved}
    return doc.Equilibrium.from_result(equilibrium, write, impossible=bool(equilibrium.impossible), solved=solved)


IN_COORDINATES = (
    "Problems 4 to 6 are told in generalised coordinates and velocities. Near the motion these and the state in speeds "
    "(and unit vectors) are smooth functions of each other, so that stability is the same in both."
)

SINGULAR = (
    "The coordinates are singular there: [[names]] can change so that, to first order, nothing moves. The equations in "
    "regular coordinates demand more, which follows from the first derivatives of these and is demanded here, too."
)


def exists_if(equilibrium: Equilibrium) -> Said:
    """What is said before the conditions: of those that vary along the motion, that they have to hold all the time."""
    if equilibrium.unsteady:
        return Said("satisfies the equations of motion if and only if, at all times,")
    return Said("satisfies the equations of motion if and only if")


def content(results: Results) -> Iterator[Block]:
    """What reports say."""
    yield Heading("equilibrium", Said("Problem 4. The unperturbed motion"))
    system, equilibrium = results.system, results.by_problem.get(4)
    if system.motion or equilibrium is not None:
        yield paragraph(Said("The unperturbed motion"))
        yield Display(unperturbed_motion(system), "motion")
    yield from results.missing(4)
    if equilibrium is None:
        return
    if equilibrium.satisfied:
        yield paragraph(Said("satisfies the equations of motion identically."))
    elif equilibrium.impossible:
        yield paragraph(Said("does not satisfy the equations of motion: these can never vanish."))
        yield from map(Display, equilibrium.impossible)
    else:
        yield paragraph(exists_if(equilibrium))
        for k, condition in enumerate(equilibrium.conditions, start=1):
            yield Display(Relation(condition, "=", 0), f"equilibrium:{k}")
        if equilibrium.solved:
            yield paragraph(Said("which problems 5 and 6 use in the form"))
        for k, (name, value) in enumerate(equilibrium.solved, start=1):
            yield Display(Relation(Name(name), "=", value), f"solved:{k}")
    if equilibrium.singular:
        names = named(dict.fromkeys(name for displacement in equilibrium.singular for name, _ in displacement))
        yield paragraph(say(SINGULAR, names=names))
    if system.speeds:
        yield paragraph(Said(IN_COORDINATES))
