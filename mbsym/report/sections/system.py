"""The system as it is described: what reports say before the problems."""

from __future__ import annotations

from collections.abc import Iterator

from mbsym.expressions.message import worded
from mbsym.expressions.tree import ZERO, Expression
from mbsym.model.admissibility import body_violation, known_values
from mbsym.model.speeds import UnitVector
from mbsym.model.system import INERTIAL, Body, System
from mbsym.report.code.functions import moving
from mbsym.report.content import (
    Block,
    Citation,
    Heading,
    Inline,
    Itemised,
    Listed,
    Name,
    Notation,
    Paragraph,
    Points,
    Relation,
    Said,
    SpeedForm,
    Strong,
    Subheading,
    Symbol,
    Table,
    TableColumn,
    Tensor,
    Unit,
    Verbatim,
    named,
    paragraph,
    say,
)
from mbsym.report.results import Results
from mbsym.report.words.description import constraint, load, separated, vector

#: A table of more points is shown by its first and last ones.
MOST_LISTED = 100

_OUTSIDE = {
    "zero": "zero outside",
    "hold": "its end values outside",
    "extrapolate": "outside as its end pieces go on",
    "error": "undefined outside",
}
_HELD = (
    "In formulas [[held]] is this table with its end values outside; terms with the sign function take them away there"
)


def content(results: Results) -> Iterator[Block]:
    """What reports say."""
    system = results.system
    yield Heading("system", Said("The system"))
    if system.source:
        yield paragraph(Said("Source"), ": ", Citation("source", system.source.removesuffix(".")), ".")
    yield from _variables(system)
    if system.linear:
        yield from _linear(system)
    else:
        accepted = accepted_inertias(system)
        yield Subheading((Said("Bodies"),))
        for number, body in enumerate(system.bodies, start=1):
            yield Paragraph(tuple(_body(body, number, accepted)))
        yield Subheading((Said("Loads"),))
        if system.loads:
            yield Itemised(tuple(map(load, system.loads)), numbered=True)
        else:
            yield paragraph(Said("No loads."))
    if system.constraints:
        yield Subheading((Said("Constraints"),))
        yield Itemised(tuple((paragraph(constraint(x)),) for x in system.constraints), numbered=True)
    yield from _values(system)


def _unit(system: System, name: str) -> tuple[Inline, ...]:
    unit = system.units.of(name) if system.units else None
    return (" ", Unit(unit)) if unit else ()


def _variables(system: System) -> Iterator[Block]:
    if system.coordinates:
        names: list[Inline] = [Relation(Symbol("q"), "=", Listed(named(system.coordinates).items, brackets=True))]
        if system.units:
            names = []
            for k, name in enumerate(system.coordinates):
                names += [*([", "] if k else []), Name(name), *_unit(system, name)]
        yield paragraph(Said("Generalised coordinates"), ": ", *names, ".")
    for item in system.of_constant_rate:
        law = Relation(Name(item.name), "=", moving(item.initial, item.rate))
        yield paragraph(Said("Prescribed"), ": ", law, *_unit(system, item.name), *_meaning(item.meaning), ".")
    for function in system.given:
        told = Name(function.name) if function.law is None else Relation(Name(function.name), "=", function.law)
        yield paragraph(
            Said("Function of time, a symbol as its derivatives are"),
            ": ", told, *_unit(system, function.name), *_meaning(function.meaning), ".",
        )  # fmt: skip
    if system.inputs:
        parts: list[Inline] = []
        for k, signal in enumerate(system.inputs):
            parts += [*(["; "] if k else []), Name(signal.name), *_unit(system, signal.name), *_meaning(signal.meaning)]
        yield paragraph(Said("Inputs, functions of time that are chosen later"), ": ", *parts, ".")
    if system.outputs:
        outputs = tuple(Relation(Name(output.name), "=", output.value) for output in system.outputs)
        yield paragraph(Said("Outputs"), ": ", Listed(outputs), ".")
    for table in system.tables:
        between = "a natural cubic spline" if table.between == "cubic" else "straight lines"
        points = str(len(table.points))
        yield paragraph(
            Said("Table"), " ", Verbatim(table.name), *_unit(system, table.name),
            ", ", Said(between), ", ", Said(_OUTSIDE[table.outside]),
            *((", ", say("[[count]] points", count=points)) if len(table.points) > MOST_LISTED else ()),
            *((", ", Said("from the file"), " ", Verbatim(table.source.file)) if table.source else ()),
            ": ", Points(table.points), *((". ", say(_HELD, held=Verbatim(table.held))) if table.jumps else ()), ".",
        )  # fmt: skip
    if system.parameters:
        columns = (TableColumn(Said("name"), 0), TableColumn(Said("value"), 4.4), TableColumn(Said("sign"), 3.0))
        rows = []
        for own in system.parameters:
            value = Name(own.name) if own.value is None else Relation(Name(own.name), "=", own.value)
            shown = (value, *_unit(system, own.name))
            rows.append(((Verbatim(own.name),), shown, (worded(own.sign),), (own.meaning,)))
        yield Table(Said("Parameters"), (*columns, TableColumn(Said("meaning"), 7.4)), tuple(rows))


def _meaning(text: str) -> tuple[Inline, ...]:
    return (", ", text) if text else ()


def _linear(system: System) -> Iterator[Block]:
    assert system.linear is not None
    text = (
        "The system is given by the matrices of its linear equations $M \\ddot q + (D + G)\\, \\dot q + (K + N)\\, q = "
        "[[right]]$; what is said of stability is about these equations, which are exactly linear."
    )
    yield paragraph(say(text, right=Notation("B u") if system.inputs else 0))
    for item in system.linear.matrices:
        if item.source:
            text = "The matrix $[[matrix]]$ is read from the file"
            yield paragraph(say(text, matrix=Notation(item.key)), " ", Verbatim(item.source.file), ".")


def _body(body: Body, number: int, accepted: dict[str, str]) -> Iterator[Inline]:
    yield Strong(f"{number}. {body.name}")
    yield " "
    on = body.attached_to
    yield Said("on the inertial frame") if on == INERTIAL else say("on body [[body]]", body=on)
    yield ": "
    if body.rotation.axes:
        axes = Notation("\\{" + ",\\, ".join(map(str, body.rotation.axes)) + "\\}")
        angles = Listed(tuple(body.rotation.angles), braces=True)
        yield say("rotation $[[axes]]$ by $[[angles]]$", axes=axes, angles=angles)
    else:
        yield Said("no rotation")
    yield from ("; ", Said("connection point"), " ", vector(body.connection_point))
    yield from ("; ", Said("mass centre"), " ", vector(body.mass_centre), "; ", Said("mass"), " ", body.mass)
    if body.inertia is not None:
        about = {"mass centre": Said("inertia about the mass centre"), "joint": Said("inertia about the joint")}[
            body.inertia.about
        ]
        yield from ("; ", about, " ", Tensor(body.inertia.tensor))
        if body.name in accepted:
            yield from (", ", Said("accepted as given (identified values)"))
            if accepted[body.name]:
                yield from (" ", Said("although no body has it"), ": ", accepted[body.name])
    if body.gyrostatic_moment:
        text = (
            "gyrostatic moment $h = [[h]]$, the constant angular momentum of rotors inside it: $T$ contains "
            "$h \\cdot \\omega$, as Routh's function of the rotors"
        )
        yield from ("; ", say(text, h=vector(body.gyrostatic_moment)))
    if body.speeds:
        forms = tuple(Relation(Name(x.name), "=", SpeedForm(x.form, number)) for x in body.speeds)
        yield from ("; ", Said("speeds"), " ", Listed(forms))
    if body.orientation and body.orientation[0].word == "quaternion":
        text = (
            "orientation told by the quaternion $([[names]]) = (\\cos\\frac{\\phi}{2},\\, n \\sin\\frac{\\phi}{2})$ of "
            "norm 1, scalar part first: its axes are those of the frame that it hangs on turned by $\\phi$ about $n$; "
            "$v = e \\circ v_b \\circ e^*$ brings components in body axes to that frame"
        )
        yield from ("; ", say(text, names=named(body.orientation[0].components)))
    elif body.orientation:
        text = "told by unit vectors, in its axes, along the axes of the frame that it hangs on"
        yield from ("; ", Said(text), ": ")
        vectors: list[Inline] = []
        for k, unit_vector in enumerate(body.orientation):
            assert isinstance(unit_vector, UnitVector)
            along = Listed(tuple(map(Name, unit_vector.components)), brackets=True)
            vectors += [*([", "] if k else []), along, " (", Said("axis"), f" {unit_vector.axis})"]
        yield from vectors
    yield "."


def unperturbed_motion(system: System) -> Listed:
    """The motion about which problems 4 to 6 are, and the values at which inputs are held.

    What is not named is 0, but for what constraints make of it.
    """
    moves = {x.coordinate: moving(x.value, x.rate) for x in system.motion}
    alike: dict[Expression, list[str]] = {}
    for name in moves if system.constraints else system.coordinates:
        alike.setdefault(moves.get(name, ZERO), []).append(name)
    items = [Relation(*(part for name in names for part in (Name(name), "=")), value) for value, names in alike.items()]
    held = [Relation(Name(x.name), "=", x.held) for x in system.inputs]
    return Listed((*items, *held))


def _values(system: System) -> Iterator[Block]:
    if system.relations:
        relations = Listed(tuple(Relation(Name(x.name), "=", x.value) for x in system.relations))
        used = () if system.linear else (" ", Said("(used from problem 4 on)"))
        yield paragraph(Said("Relations"), ": ", relations, *used, ".")
    if system.assumptions:
        assumed = Listed(tuple(Relation(x.left, x.relation, x.right) for x in system.assumptions))
        yield paragraph(Said("Assumptions"), ": ", assumed, ".")
    if system.limits:
        parts: list[Inline] = []
        for k, limit in enumerate(system.limits):
            name = limit.coordinate
            between = Relation(limit.lower, "<=", Name(name), "<=", limit.upper)
            parts += [*([", "] if k else []), between, *_unit(system, name)]
        yield paragraph(Said("Limits of the coordinates, which no force keeps"), ": ", *parts, ".")
    if system.motion:
        yield paragraph(Said("Unperturbed motion"), ": ", unperturbed_motion(system), ".")
    initial: list[Inline] = []
    for item in system.initial:
        if item.position is not None:
            initial.append(Relation(Name(item.coordinate, at="0"), "=", item.position))
        if item.velocity is not None or not system.start:
            initial.append(Relation(Name(item.coordinate, 1, at="0"), "=", item.velocity or ZERO))
    if initial:
        yield paragraph(Said("Initial values"), ": ", *separated(initial), ".")
    if system.start:
        declared = [Relation(Name(x.coordinate, at="0"), "=", x.position or ZERO) for x in system.start]
        text = "Initial values of declared variables, from which velocities that are not given follow"
        yield paragraph(Said(text), ": ", *separated(declared), ".")


# Inertias that are taken as given although no body has them: said wherever a report lists the bodies.


def accepted_inertias(system: System) -> dict[str, str]:
    """For each body whose inertia is accepted, the inequality that it breaks, as far as the given numbers tell."""
    values = known_values(system)
    accepted = [body for body in system.bodies if body.inertia is not None and body.inertia.accepted]
    return {body.name: body_violation(body, values) or "" for body in accepted}
