"""Problem 1, kinematics: what results.json and reports show of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from mbsym.formulas.formula import Column
from mbsym.model.system import System
from mbsym.problems.kinematics import BodyKinematics, Kinematics
from mbsym.problems.telling import ToldKinematics
from mbsym.report.content import (
    Block,
    Components,
    Display,
    Folded,
    Heading,
    Matrices,
    Relation,
    Said,
    Subheading,
    Symbol,
)
from mbsym.report.documents import results as doc
from mbsym.report.documents.base import Write

if TYPE_CHECKING:
    from mbsym.report.results import Results


def data(kinematics: Kinematics, system: System, write: Write) -> doc.Kinematics:
    """The section of results.json."""
    return doc.Kinematics.from_result(kinematics, write)


def content(results: Results) -> Iterator[Block]:
    """What reports say."""
    yield Heading("kinematics", Said("Problem 1. Kinematics"))
    kinematics, compact = results.by_problem.get(1), results.compact.get(1)
    closed = {} if kinematics is None else {body.name: body for body in kinematics.bodies}
    yield from results.missing(1)
    if compact is None:
        for k, body in enumerate(closed.values(), start=1):
            yield Subheading((f"{k}. {body.name}",))
            yield _rotation(k, body, results)
            yield from _velocities(k, body)
        return
    for k, body in enumerate(closed.values(), start=1):
        yield _rotation(k, body, results)
    yield from results.intermediates(1)
    for k, (name, motion) in enumerate(compact.system.kinematics.items(), start=1):
        yield Subheading((f"{k}. {name}",))
        yield from _velocities(k, motion)
        if name in closed and _terms(closed[name]) > _terms(motion):
            yield Folded(Said("The same, written out"), tuple(_velocities(k, closed[name])))


def _rotation(k: int, body: BodyKinematics, results: Results) -> Block:
    comma = "," if k > 9 else ""
    upper = f"{results.numbers[body.attached_to]}{comma}{k}"
    return Matrices(Symbol("R", upper=upper), body.rotation, False, f"R{k}")


def _velocities(k: int, body: BodyKinematics | ToldKinematics) -> Iterator[Block]:
    joint, centre = Symbol("V", f"O{k}"), Symbol("V", f"C{k}")
    if not _named(body.angular_velocity, f"omega{k}"):
        yield Components(Symbol("omega", str(k)), body.angular_velocity, f"omega{k}")
    if not _named(body.velocity_origin, f"V{k}"):
        yield Components(joint, body.velocity_origin, f"VO{k}")
    if body.velocity_mass_centre == body.velocity_origin:
        yield Display(Relation(centre, "=", joint), f"VC{k}")
    else:
        yield Components(centre, body.velocity_mass_centre, f"VC{k}")


def _named(value: Column, letter: str) -> bool:
    """Whether each component is an intermediate quantity with its own name, which says all of it."""
    names = [f"{letter}_{i}" for i in (1, 2, 3)]
    return all(x.terms == 1 for x in value) and [str(x) for x in value] == names  # long ones are not written for it


def _terms(body: BodyKinematics | ToldKinematics) -> int:
    vectors = (body.angular_velocity, body.velocity_origin, body.velocity_mass_centre)
    return sum(x.terms for vector in vectors for x in vector)
