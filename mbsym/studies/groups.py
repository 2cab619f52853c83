"""``mbsym groups``: the dimensionless groups of a system, found by themselves."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mbsym.expressions.message import Counted, Message
from mbsym.expressions.safe import UNBROKEN
from mbsym.report.content import Block, Subheading, paragraph
from mbsym.studies.study import Answer, Asked, Document, Refusal, Single, Study, Watch, failed

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.model.scaling import Scaling
    from mbsym.model.system import System
    from mbsym.problems.scaling import Groups


@dataclass(frozen=True)
class Request:
    """Find the dimensionless groups of FILE: what of its parameters matters, whatever the units.

    Scalings of parameters, coordinates and time that leave the equations what they are form a linear space, which is
    found exactly; no units need be declared.  As many parameters as it has dimensions are set to 1, each other one
    stands for a group then.  The first approximation of problems 5 and 6 needs fewer groups; it is told in the symbols
    of the description's notation.  Groups are products of powers: sums of parameters are left to the notation.

    With --out the description is written in its groups (YAML), for 'run', 'map', 'sweep' and all others.

    Exit codes: 0 found, 1 the equations have no closed form, or the file cannot be written, 2 something is wrong.

    \b
    Examples:
      mbsym groups systems/double-pendulum.yaml
      mbsym groups systems/spring-pendulum.yaml --out spring-in-groups.yaml
    """


@dataclass(frozen=True)
class Found:
    """The groups of the equations of motion, or of the matrices where those are given."""

    analysis: Analysis
    groups: Groups


def derive(context: Asked, request: Request, watch: Watch) -> Found:
    from mbsym.analysis import Analysis
    from mbsym.problems.scaling import groups

    watch("deriving")
    analysis = Analysis(context.system)
    if context.system.linear is not None:
        return Found(analysis, _of_linear(analysis))
    return Found(analysis, groups(analysis.scene, analysis.equations))


def answer(context: Asked, request: Request, derived: Found) -> Answer:
    return Answer(_lines(derived))


def _lines(derived: Found) -> Iterator[Block]:
    sections = [(Message("first approximation"), _linear(derived.analysis))]
    if derived.analysis.system.linear is None:
        sections.insert(0, (Message("equations of motion"), _motion(derived)))
    for title, lines in sections:
        yield Subheading((title,))
        for text in lines:
            yield paragraph("  ", text)


def _motion(derived: Found) -> Iterator[str]:
    from mbsym.analysis.scaled import proposed
    from mbsym.expressions.place import Complaints
    from mbsym.source.scaling import read_scaling

    yield from _said(derived.groups)
    system = derived.analysis.system
    dimensions = read_scaling("", system, Complaints())
    scale = "" if dimensions is None else proposed(system, dimensions, derived.groups.units)
    if scale:
        option = f'--scale{UNBROKEN}"{scale}"'  # in one line, so that it can be pasted
        yield Message("in dimensionless variables (mbsym run, show, convert): [[option]]", option=option)


def _said(grouping: Groups, effects: bool = True) -> Iterator[str]:
    """``effects``: those of parameters on the motion are all known, so that what has none is told."""
    from mbsym.analysis.in_groups import group_of, product
    from mbsym.expressions.tree import text

    sentence = "[[parameters]], [[units]] of them set to 1: [[groups]]"
    if grouping.unused:
        sentence = "[[parameters]], [[units]] of them set to 1: at most [[groups]]"
    parameters, groups = Counted(len(grouping.free), "parameter"), Counted(len(grouping.groups), "group")
    yield Message(sentence, parameters=parameters, units=len(grouping.units), groups=groups)
    if grouping.unused:
        sentence = (
            "[[scalings]] not used: no other parameter is declared positive, and one that may vanish cannot be set to 1"
        )
        yield Message(sentence, scalings=Counted(grouping.unused, "scaling more is", "scalings more are"))
    if grouping.units:
        yield ", ".join(f"{name} = 1" for name in grouping.units)
    for group in grouping.groups:
        stands = text(group_of(group.parameter, group.powers))
        sentence = Message("[[name]] stands for [[group]]", name=group.parameter, group=stands)
        yield group.parameter if stands == group.parameter else sentence
    if grouping.rate:
        unit = text(product((name, -power) for name, power in grouping.rate))
        yield Message("time in units of [[unit]]", unit=unit)
    for length in grouping.lengths:
        yield Message("[[name]] in units of [[unit]]", name=length.parameter, unit=text(product(length.powers)))
    if grouping.idle and effects:
        yield Message("without effect on the motion: [[names]]", names=", ".join(grouping.idle))


def _of_linear(analysis: Analysis) -> Groups:
    """The groups of the first approximation.  Raises Failure where there is none in closed form."""
    from mbsym.problems.scaling import linear_groups
    from mbsym.problems.stability.problem import prepared_parts

    motion = analysis.equilibrium
    parts = prepared_parts(analysis.parameters_scene, analysis.balance, analysis.judgeable, motion, analysis.signs)
    return linear_groups(analysis.parameters_scene, [(part.ring, part.system) for part in parts])


def _linear(analysis: Analysis) -> Iterator[str]:
    from mbsym.algebra.failures import Failure

    try:
        groups = _of_linear(analysis)
    except Failure as error:
        yield Message("none: [[reason]]", reason=error.reason)
        return
    yield from _said(groups, effects=False)


def in_scale(system: System, scaling: Scaling) -> System:
    """The description in the variables of a scaling, as it is read from its text, which has to be sound.

    Raises NoDescription, or what deriving the equations raises.
    """
    from mbsym.analysis.scaled import NoDescription, in_variables
    from mbsym.source import read, to_yaml

    scaled, complaints = read(to_yaml(in_variables(system, scaling)))
    if scaled is None:
        raise NoDescription(complaints.sorted()[0].message)
    return scaled


def document(context: Asked, request: Request, derived: Found) -> Document:
    """The description in its groups."""
    from mbsym.analysis.in_groups import in_groups
    from mbsym.source import read, to_yaml

    text = to_yaml(in_groups(context.system, derived.groups))
    system, complaints = read(text)
    if system is not None:
        return Document(text)
    # What the equations do not ask of a body may be asked of its numbers.
    why = complaints.sorted()[0].message
    text = to_yaml(in_groups(context.system, derived.groups, values=False))
    system, complaints = read(text)
    if system is None:
        return Document(None, (Message("it cannot be written in groups: [[why]]", why=complaints.sorted()[0].message),))
    note = "values are left out of what is written, where they belong to no bodies: [[why]]"
    return Document(text, (Message(note, why=why),))


def refusal(error: Exception, context: Asked, request: Request) -> Refusal | None:
    return failed(error, "the groups cannot be found")


def as_json(context: Asked, request: Request, derived: Found) -> str:
    from mbsym.report.documents.base import file_of
    from mbsym.report.documents.parameters import Groups as Document

    return file_of(Document, context.system, derived.groups)


STUDY = Study(
    "groups", Request, derive, answer, refusal, json=as_json,
    matrices=True, constraints=True, held=False, out=Single("Write the description in groups here."), document=document,
)  # fmt: skip
