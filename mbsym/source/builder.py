"""The placed tree to a System: the one builder behind both spellings.

Names first (parameters, prescribed motions, coordinates), then everything that uses them, then what only the whole
can show (:mod:`mbsym.source.checks`).
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from mbsym.expressions.message import Message, worded
from mbsym.expressions.parser import ascii_safe
from mbsym.expressions.place import Complaints
from mbsym.expressions.tree import Expression
from mbsym.model.admissibility import known_values
from mbsym.model.constraints import Constraint
from mbsym.model.inputs import Input, Output
from mbsym.model.substitution import in_coordinates, with_held
from mbsym.model.system import INERTIAL, Body, MotionEntry, System
from mbsym.source.bodies import draft_bodies, read_body, read_body_name
from mbsym.source.checks import check_body, check_system, in_formulas
from mbsym.source.claims import enter_symbols, leave_symbols, read_abbreviations, read_claims
from mbsym.source.constants import (
    declare_in_time,
    declared_by_use,
    note_unit,
    read_given,
    read_parameters,
    read_prescribed,
    read_values,
)
from mbsym.source.keys import INPUT, SYSTEM, VERSION
from mbsym.source.linear import declare_linear, read_linear
from mbsym.source.loads import read_constraints, read_loads
from mbsym.source.placed import Entry, Node, Scalar, Sequence
from mbsym.source.reading import Fields, Reading
from mbsym.source.scope import Allowed, Scope
from mbsym.source.settings import (
    DECLARED,
    of_coordinates,
    read_assumptions,
    read_initial,
    read_limits,
    read_motion,
    read_notation,
    read_relations,
    read_small,
)
from mbsym.source.speeds import check_speeds, constraint_in_coordinates, declare_speeds, read_speeds
from mbsym.source.symbols import read_symbols
from mbsym.source.tables import read_tables


def build(node: Node, complaints: Complaints, editor: bool = False, folder: Path | None = None) -> System | None:
    """The system that a placed tree describes, or None if anything in it is wrong.

    ``folder`` is where the description is.  ``editor``: it is in the plain text of the editor, which has labels for
    keys; where no parameters are declared at all, the names in the bodies, loads and relations are parameters.
    """
    reading = Reading(complaints, Scope(complaints), folder=folder, labelled=editor)
    fields = reading.fields(node, "a description", SYSTEM)
    if editor and fields.get("parameters") is None:
        reading.scope.by_use = {}
    _check_version(fields, reading)
    fields.require("name")
    if "linear system" not in fields.entries:
        fields.require("bodies")
    tables = read_tables(fields.get("tables"), reading)
    parameters = read_parameters(fields.get("parameters"), reading)
    prescribed_entries = declare_in_time(fields.get("prescribed"), "prescribed", reading)
    given_entries = declare_in_time(fields.get("given"), "given", reading)
    inputs = read_inputs(fields.get("inputs"), reading)
    before = complaints.error_count
    drafts = draft_bodies(fields.get("bodies"), reading)
    drafted = complaints.error_count == before
    linear = declare_linear(fields.get("linear system"), fields, reading)
    for draft in drafts:
        declare_speeds(draft, reading)
    prescribed = tuple(read_prescribed(entry, reading) for entry in prescribed_entries)
    given = tuple(read_given(entry, reading) for entry in given_entries)
    parameters = read_values(fields.get("values"), parameters, reading)
    relations = read_relations(fields.get("relations"), reading)
    bodies, sound = [], []
    for draft in drafts:
        before = complaints.error_count
        bodies.append(read_body(draft, drafts, reading))
        sound.append(draft.whole and complaints.error_count == before)
    reading.scope.motionless = bool(drafts) and linear is None and not reading.scope.of_kind("coordinate", *DECLARED)
    speeds = [read_speeds(draft, drafts, reading) for draft in drafts]
    bodies = [
        replace(body, speeds=own, orientation=draft.orientation)
        for body, own, draft in zip(bodies, speeds, drafts, strict=True)
    ]
    loads = read_loads(fields.get("loads"), [body.name for body in bodies], reading)
    constraints, dependent = _constraints(fields, bodies, reading)
    matrices = None if linear is None else read_linear(*linear, len(inputs), reading)
    parameters += declared_by_use(reading)
    notation = read_notation(fields.get("notation"), reading)
    outputs = read_outputs(fields.get("outputs"), reading)
    motion = read_motion(fields.get("motion"), reading)
    initial, start = read_initial(fields.get("initial"), reading)
    enter_symbols(fields.get("claims"), fields.get("abbreviations"), reading)
    system = System(
        name=fields.text("name"),
        parameters=tuple(parameters),
        bodies=tuple(bodies),
        description=fields.text("description"),
        prescribed=(*prescribed, *(item for function in given for item in function.chain)),
        given=given,
        tables=tables,
        inputs=with_held(inputs, held_values(motion, reading)),
        outputs=outputs,
        loads=loads,
        relations=relations,
        assumptions=read_assumptions(fields.get("assumptions"), reading),
        motion=of_coordinates(motion, reading),
        notation=notation,
        time_scale=fields.expression("dimensionless time", Allowed("the rate of dimensionless time")),
        initial=initial,
        start=start,
        abbreviations=read_abbreviations(fields.get("abbreviations"), reading),
        limits=read_limits(fields.get("limits"), reading),
        source=fields.text("source"),
        label=fields.text("label"),
        symbols=read_symbols(fields.get("latex"), reading),
        language=fields.word("language"),
        order=_coordinates(fields, "order", "an order of coordinates", reading),
        constraints=constraints,
        dependent=dependent,
        reactions=_reactions(fields, [body.name for body in bodies], reading),
        linear=matrices,
        dependent_span=fields.key_span("dependent") if "dependent" in fields.entries else None,
    )
    if any(body.speeds or body.orientation for body in bodies):
        tied = tuple(constraint_in_coordinates(constraint, system) for constraint in constraints)
        system = replace(system, loads=tuple(in_coordinates(load, system) for load in loads), constraints=tied)
    small = read_small(fields.get("small parameter"), reading, in_formulas(system))
    system = replace(system, small=small)
    names = [body.name for body in bodies]
    claims = read_claims(fields.get("claims"), names, system, reading, fields.get("small parameter") is not None)
    leave_symbols(reading)
    system = replace(system, claims=claims)
    values = known_values(system)
    for draft, good in zip(drafts, sound, strict=True):
        if good:
            check_body(system, draft, values, reading)
    if all(sound):
        check_speeds(system, drafts, reading)
    if drafts and drafted and all(sound) and not system.coordinates:
        hint = "a coordinate is an undeclared name used as an angle, or is listed in a body: 'coordinates: [x]'"
        reading.error("no-coordinates", "nothing moves: there are no coordinates", fields.key_span("bodies"), hint)
    check_system(system, reading)
    system = _with_units(system, fields, reading)
    return None if complaints.error_count else system


def _constraints(
    fields: Fields, bodies: list[Body], reading: Reading
) -> tuple[tuple[Constraint, ...], tuple[str, ...]]:
    """The constraints and the dependent coordinates; few descriptions have any."""
    node, dependent = fields.get("constraints"), fields.get("dependent")
    if node is None and dependent is None:
        return (), ()
    constraints = read_constraints(node, [x.name for x in bodies], reading)
    if "speed" in reading.scope.kinds.values():
        named = _coordinates(fields, "dependent", "a dependent coordinate or speed", reading, ("coordinate", "speed"))
    else:
        named = _coordinates(fields, "dependent", "a dependent coordinate", reading)
    if dependent is not None and (node is None or (isinstance(node, Sequence) and not node.items)):
        message = "nothing depends on anything: there are no 'constraints'"
        reading.error("idle-constraint", message, fields.key_span("dependent"), "leave 'dependent' out")
    return constraints, named


def _reactions(fields: Fields, bodies: list[str], reading: Reading) -> tuple[str, ...]:
    node = fields.get("reactions")
    reactions: list[str] = []
    for item in () if node is None else reading.items(node, "'reactions'"):
        name = read_body_name(item, "a joint", bodies, reading)
        if name is None:
            continue
        if name == INERTIAL:
            message = "the inertial frame 0 has no joint"
            reading.error("unknown-body", message, item.span, "name the body that the joint moves")
        elif name in reactions:
            reading.error("repeated-key", Message("[[name]] is given twice", name=ascii_safe(name)), item.span)
        else:
            reactions.append(name)
    return tuple(reactions)


def _coordinates(
    fields: Fields, key: str, what: str, reading: Reading, kinds: tuple[str, ...] = ("coordinate",)
) -> tuple[str, ...]:
    """A list of coordinates, or of names of other ``kinds``, none twice."""
    node, allowed = fields.get(key), Allowed(what, kinds)
    coordinates: list[str] = []
    for item in () if node is None else reading.items(node, f"'{key}'"):
        scalar = reading.scalar(item, "a coordinate")
        if scalar is None or not reading.scope.check_name(scalar.text, scalar.span, allowed):
            continue
        if scalar.text in coordinates:
            reading.error("repeated-key", Message("[[what]] is given twice", what=ascii_safe(scalar.text)), scalar.span)
        coordinates.append(scalar.text)
    return tuple(coordinates)


def _with_units(system: System, fields: Fields, reading: Reading) -> System:
    """The system with its units; where there are any, every expression was checked for its dimension.

    What could not be read is zero, which goes with every dimension: it hides no slip, and makes none.
    """
    if not reading.units and fields.get("units") is None:
        return system
    if system.linear is not None:
        message = "units of given matrices are not checked yet"
        reading.error("conflicting-keys", message, system.linear.span, "leave 'units' and 'unit' out")
        return system
    from mbsym.source.units import checked_units, read_units  # pint takes its time, and few descriptions need it

    declared = read_units(fields.get("units"), reading.units, reading)
    return replace(system, units=checked_units(system, declared, reading))


def _check_version(fields: Fields, reading: Reading) -> None:
    node = fields.require("mbsym", "begin the file with 'mbsym: 1'")
    scalar = None if node is None else reading.scalar(node, "'mbsym'")
    if scalar is not None and scalar.text != VERSION:
        message = Message(
            "this is version [[what]] of the format, and only [[known]] is known",
            what=ascii_safe(scalar.text),
            known=VERSION,
        )
        reading.error("bad-version", message, scalar.span)


# Inputs and outputs: names that forces hold and whose values are chosen later, and what is measured.


#: A system has at most so many inputs, and so many outputs: each is a column of B, or a row of C.
MAX_INPUTS = 200

OUTPUT = Allowed("an output", ("coordinate", "velocity", "prescribed", "parameter", "input"))


def read_inputs(node: Node | None, reading: Reading) -> tuple[Input, ...]:
    """``u1: {meaning: torque of the wheel, unit: N*m}`` or ``u1: torque of the wheel``, or a list of names."""
    if node is None:
        return ()
    if isinstance(node, Sequence):
        inputs = [
            system_input
            for item in reading.items(node, "'inputs'")
            if (system_input := _listed(item, reading)) is not None
        ]
    else:
        inputs = [
            system_input
            for entry in reading.entries(node, "'inputs'")
            if (system_input := _input(entry, reading)) is not None
        ]
    _bound(len(inputs), "inputs", node, reading)
    return tuple(inputs)


def _listed(item: Node, reading: Reading) -> Input | None:
    scalar = reading.scalar(item, "an input")
    if scalar is None or not reading.scope.declare(scalar.text, "input", scalar.span):
        return None
    return Input(scalar.text, span=scalar.span)


def _input(entry: Entry, reading: Reading) -> Input | None:
    name, meaning = entry.key.text, ""
    declared = reading.scope.declare(name, "input", entry.key.span)
    if isinstance(entry.value, Scalar):
        if entry.value.text.strip():
            meaning = reading.free_text(
                entry.value, Message("the meaning of the input [[name]]", name=ascii_safe(name))
            )
    else:
        fields = reading.fields(entry.value, Message("the input [[name]]", name=ascii_safe(name)), INPUT)
        note_unit(name, fields, reading)
        meaning = fields.text("meaning")
    return Input(name, meaning, span=entry.key.span) if declared else None


def read_outputs(node: Node | None, reading: Reading) -> tuple[Output, ...]:
    """``y1: theta``: expressions in coordinates, velocities, parameters, prescribed motions and inputs."""
    outputs = []
    for entry in () if node is None else reading.entries(node, "'outputs'"):
        errors = reading.errors
        value = reading.expression(entry.value, OUTPUT)
        declared = reading.scope.declare(entry.key.text, "output", entry.key.span)
        if declared and reading.errors == errors:
            outputs.append(Output(entry.key.text, value, entry.key.span))
    if node is not None:
        _bound(len(outputs), "outputs", node, reading)
    return tuple(outputs)


def _bound(count: int, what: str, node: Node, reading: Reading) -> None:
    if count > MAX_INPUTS:
        reading.error(
            "too-large",
            "a system has at most [[most]] [[what]], not [[count]]",
            node.span,
            most=MAX_INPUTS,
            what=worded(what),
            count=count,
        )


def held_values(motion: tuple[MotionEntry, ...], reading: Reading) -> dict[str, Expression]:
    """What ``motion`` says of inputs; complains about one that is to change there."""
    return {entry.coordinate: entry.value for entry in motion if reading.scope.kinds.get(entry.coordinate) == "input"}
