"""Parameters, prescribed motions and numerical values: the constants that everything else refers to."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import replace
from fractions import Fraction

from mbsym.expressions.constants import sign_of
from mbsym.expressions.message import Message, joined
from mbsym.expressions.parser import ascii_safe, decimal_comma, parse_expression
from mbsym.expressions.place import Complaints, Span
from mbsym.expressions.tree import CONSTANTS, ZERO, Expression, names
from mbsym.model.assumptions import has_sign
from mbsym.model.system import Given, Parameter, Prescribed, rational
from mbsym.model.units import Declared
from mbsym.source.keys import GIVEN, PARAMETER, PRESCRIBED, SIGN_WORDS, SIGNS
from mbsym.source.laws import GIVEN_LAW
from mbsym.source.placed import Entry, Mapping, Node, Scalar, Sequence
from mbsym.source.reading import Fields, Reading, keys_of
from mbsym.source.scope import NUMBER, Allowed, did_you_mean


def read_parameters(node: Node | None, reading: Reading) -> list[Parameter]:
    """Parameters from a mapping, or from a plain list of names (all of them real)."""
    if node is None:
        return []
    if isinstance(node, Sequence):
        return _listed(node, reading)
    parameters = []
    for entry in reading.entries(node, "'parameters'"):
        parameter = _parameter(entry, reading)
        if reading.scope.declare(parameter.name, "parameter", entry.key.span):
            parameters.append(parameter)
    return parameters


def declared_by_use(reading: Reading) -> list[Parameter]:
    """The parameters that nobody declared but expressions use, with one warning that lists them; none from here on."""
    used, reading.scope.by_use = reading.scope.by_use, None
    if not used:
        return []
    message = Message("parameters are declared by their use, all of them real: [[used]]", used=", ".join(used))
    hint = "a section 'Parameters' gives them signs, values and meanings, and slips of the pen are found"
    products = [factors for name in used if (factors := _factors(name, reading.scope.kinds))]
    if products:
        hint = joined([hint, Message("where a product is meant, write [[product]]", product=", ".join(products))], "; ")
    reading.complaints.warning("declared-by-use", message, min(used.values(), key=lambda span: span.line), hint)
    return [Parameter(name, span=span) for name, span in used.items()]


def _factors(name: str, known: Collection[str]) -> str:
    """``m*l`` for ml, where m and l are names, too; "" for other names."""
    cuts = ((name[:end], name[end:]) for end in range(1, len(name)))
    return next((f"{first}*{second}" for first, second in cuts if first in known and second in known), "")


def _listed(node: Sequence, reading: Reading) -> list[Parameter]:
    parameters = []
    for item in reading.items(node, "'parameters'"):
        scalar = reading.scalar(item, "a parameter")
        if scalar is not None and reading.scope.declare(scalar.text, "parameter", scalar.span):
            parameters.append(Parameter(scalar.text, span=scalar.span))
    return parameters


def _parameter(entry: Entry, reading: Reading) -> Parameter:
    """A sign word, a number (a rational one says its own sign), or a mapping."""
    name, span = entry.key.text, entry.key.span
    if isinstance(entry.value, Mapping):
        return _described(name, span, entry.value, reading)
    scalar = reading.scalar(entry.value, Message("the parameter [[name]]", name=ascii_safe(name)))
    if scalar is None:
        return Parameter(name, span=span)
    if scalar.text.lower() in SIGNS:
        return Parameter(name, scalar.text.lower(), span=span)
    refused = Complaints()
    value = parse_expression(scalar.text, refused, scalar.place, named=False)
    if value is not None and refused.errors:  # log(0)
        for complaint in refused:
            reading.error(complaint.code, complaint.message, complaint.span, complaint.hint)
        return Parameter(name, span=span)
    if value is None or not names(value) <= set(CONSTANTS):
        close = did_you_mean(scalar.text.lower(), SIGNS) or decimal_comma(scalar.text)
        unit = next(
            (complaint.hint for complaint in refused if complaint.hint and re.match("[-+.0-9]", scalar.text)), None
        )
        hint = close or unit or Message("write a number or one of: [[signs]]", signs=", ".join(SIGNS))
        message = Message(
            "a parameter is described by a sign word or a number, not by [[what]]", what=ascii_safe(scalar.text)
        )
        reading.error("bad-word", message, scalar.span, hint)
        return Parameter(name, span=span)
    reading.check_range(value, scalar)
    return Parameter(name, _sign_of(value), value, span=span)


def _sign_of(value: Expression | None) -> str:
    number = rational(value)
    return "real" if not number else "positive" if number > 0 else "negative"


def _described(name: str, span: Span, node: Mapping, reading: Reading) -> Parameter:
    fields = reading.fields(node, Message("the parameter [[name]]", name=ascii_safe(name)), {**PARAMETER, **SIGN_WORDS})
    errors = reading.errors
    value = fields.expression("value", NUMBER)
    if reading.errors != errors:
        value = None
    sign = _sign(fields, reading) or _sign_of(value)
    note_unit(name, fields, reading)
    parameter = Parameter(name, sign, value, fields.text("meaning"), span)
    if value is not None:
        _check_sign(parameter, fields.key_span("value"), reading)
    return parameter


def note_unit(name: str, fields: Fields, reading: Reading) -> None:
    """Remember the unit of a record for ``units``."""
    node = fields.get("unit")
    scalar = None if node is None else reading.scalar(node, Message("the unit of [[name]]", name=ascii_safe(name)))
    if scalar is not None:
        reading.units.append(Declared(name, scalar.text.strip(), scalar.span))


def _sign(fields: Fields, reading: Reading) -> str | None:
    """``sign: positive`` or ``positive: true``, once; None where nothing is said."""
    sign_node = fields.get("sign")
    sign: str | None = fields.word("sign", "a sign") or None
    for word in SIGNS:
        flag = fields.get(word)
        if flag is None:
            continue
        if sign is not None or sign_node is not None:
            reading.error("conflicting-keys", Message("a second sign: '[[word]]'", word=word), fields.key_span(word))
        elif reading.word(flag, f"'{word}'", ("true",)) is not None:
            sign = word
    return sign


def _check_sign(parameter: Parameter, span: Span, reading: Reading) -> None:
    if parameter.value is None:
        return
    value_sign = sign_of(parameter.value)
    if value_sign is not None and not has_sign(Fraction(value_sign), parameter.sign):
        reading.error(
            "sign-contradiction",
            Message("'[[name]]' is declared [[sign]], its value is not", name=parameter.name, sign=parameter.sign),
            span,
        )


def read_values(node: Node | None, parameters: list[Parameter], reading: Reading) -> list[Parameter]:
    """The parameters with the numbers of ``values`` filled in."""
    if node is None:
        return parameters
    by_name = {parameter.name: parameter for parameter in parameters}
    allowed = Allowed("the key of a value")
    for entry in reading.entries(node, "'values'"):
        errors = reading.errors
        value = reading.expression(entry.value, NUMBER)
        sound = reading.errors == errors
        known = reading.scope.check_key(entry.key.span, entry.key.text, keys_of(node), allowed)
        if not known or not sound or entry.key.text not in by_name:
            continue
        parameter = by_name[entry.key.text]
        if parameter.value is not None and parameter.value != value:
            message = Message("'[[name]]' already has another value under 'parameters'", name=parameter.name)
            reading.error("conflicting-values", message, entry.key.span)
            continue
        by_name[parameter.name] = replace(parameter, value=value)
        _check_sign(by_name[parameter.name], entry.value.span, reading)
    return list(by_name.values())


def declare_in_time(node: Node | None, kind: str, reading: Reading) -> list[Entry]:
    """The entries of ``prescribed`` or ``given`` whose names are good; what they are is read once names are known."""
    if node is None:
        return []
    entries = reading.entries(node, f"'{kind}'")
    return [entry for entry in entries if reading.scope.declare(entry.key.text, kind, entry.key.span)]


def read_prescribed(entry: Entry, reading: Reading) -> Prescribed:
    """``chi: omega0`` or ``chi: {rate: omega0, initial: 0}``; an initial value of 0 is no initial value."""
    name, allowed = entry.key.text, Allowed("the rate of a prescribed motion")
    if isinstance(entry.value, Scalar):
        return Prescribed(name, reading.expression(entry.value, allowed), span=entry.key.span)
    fields = reading.fields(entry.value, Message("the prescribed motion [[name]]", name=ascii_safe(name)), PRESCRIBED)
    rate = fields.required_expression("rate", allowed)
    note_unit(name, fields, reading)
    initial: Expression | None = fields.expression("initial", Allowed("an initial value"))
    return Prescribed(name, rate, None if initial == ZERO else initial, fields.text("meaning"), entry.key.span)


def read_given(entry: Entry, reading: Reading) -> Given:
    """``a: {of: t, value: A*sin(w*t)}`` or ``a: t``."""
    name, what = entry.key.text, Message("the function of time [[name]]", name=ascii_safe(entry.key.text))
    last = Given(name).chain[-1].rate
    for taken in names(last) & reading.scope.kinds.keys():
        message = Message("[[taken]] is what a derivative of '[[name]]' is called", taken=f"'{taken}'", name=name)
        reading.error("repeated-name", message, entry.key.span, "choose another name")
    if isinstance(entry.value, Scalar):
        reading.word(entry.value, what, ("t",))
        return Given(name, span=entry.key.span)
    fields = reading.fields(entry.value, what, GIVEN, "write {of: t}")
    fields.word("of")
    law: Expression | None = fields.expression("value", GIVEN_LAW)
    note_unit(name, fields, reading)
    return Given(name, law, fields.text("meaning"), entry.key.span)
