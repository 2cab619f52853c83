"""Claims and the abbreviations that they are written in."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from mbsym.expressions.message import Message
from mbsym.expressions.parser import ascii_safe
from mbsym.expressions.tree import ZERO, Expression, Name, Number, Operation, names
from mbsym.model.claims import (
    BODY,
    CLAIMS,
    COORDINATE,
    EXPRESSION,
    INITIAL_STATE,
    MOST_ORDER,
    SUM,
    SUMS,
    Abbreviation,
    Claim,
    ClaimKind,
    index_names,
)
from mbsym.model.momenta import momentum_names
from mbsym.model.oscillation_names import oscillation_names
from mbsym.model.system import INERTIAL, System, rational, velocity_name
from mbsym.source.bodies import read_body_name
from mbsym.source.keys import CLAIM
from mbsym.source.placed import Mapping, Node, Scalar, Sequence
from mbsym.source.reading import Fields, Reading
from mbsym.source.scope import NUMBER, Allowed, closest, did_you_mean
from mbsym.source.settings import read_comparisons, read_in_order

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
    kinds = map(_kind, claims.items if isinstance(claims, Sequence) else ())
    return any(kind is not None and kind.oscillates for kind in kinds)


def _kind(item: Node) -> ClaimKind | None:
    """The kind that a claim says it is of, if there is one."""
    for entry in item.entries if isinstance(item, Mapping) else ():
        if entry.key.text == "claim" and isinstance(entry.value, Scalar):
            return CLAIMS.get(_KINDS.get(" ".join(entry.value.text.lower().split()), ""))
    return None


_CONSTANTS = ("parameter", "notation", "abbreviation")
#: An integral of a system with inputs holds none of them: nobody knows how they change.
_WITHOUT_INPUTS = ("coordinate", "velocity", "speed", "unit vector", "quaternion", "prescribed", "time", *_CONSTANTS)
_PLACES = (*_WITHOUT_INPUTS, *INPUT_KINDS)
_STATE = Allowed("the key of a state", ("coordinate", "velocity", "prescribed", "parameter", "time", "input"))
_DECIMAL = re.compile(r"[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]{1,3})?\Z")
#: Kinds that are about constants alone.
_CONSTANT_KINDS = (
    *("linear matrix", "subsystem matrix", "state matrix", "characteristic polynomial", "condition"),
    *("normal form determinant", "lyapunov coefficient"),
)
_KINDS = {kind.lower(): kind for kind in CLAIMS}

#: A kind that resembles a known one as much (1: equal) is read as that one, after a complaint.
_MISSPELT = 0.8


def read_abbreviations(node: Node | None, reading: Reading) -> tuple[Abbreviation, ...]:
    """Symbols in order: each may use every name of the system and the symbols above it."""
    allowed = Allowed("an abbreviation", (*_PLACES, "acceleration", *OSCILLATION_KINDS))
    reading.scope.ordered = "abbreviations are"
    declared = read_in_order(node, "'abbreviations'", allowed, reading, lambda x: kind_of_abbreviation(x, reading))
    return tuple(Abbreviation(*item) for item in declared)


def read_claims(
    node: Node | None, bodies: list[str], system: System, reading: Reading, small: bool = False
) -> tuple[Claim, ...]:
    """A list of claims; a condition that is a chain of inequalities is several.

    ``small``: the description has a small parameter, be it understood or not.
    Claims alone may name momenta, of a system in generalised velocities.
    """
    accepted: list[Claim] = []
    kinds = reading.scope.kinds
    momenta = [] if system.speeds else [name for name in momentum_names(system).values() if name not in kinds]
    kinds.update(dict.fromkeys(momenta, "momentum"))
    reading.doubles = False
    for item in () if node is None else reading.items(node, "'claims'"):
        errors = reading.errors
        claims = _claims(item, bodies, system, reading, small)
        accepted += claims if reading.errors == errors else []
    reading.doubles = True
    for name in momenta:
        del kinds[name]
    return tuple(accepted)


def _claims(item: Node, bodies: list[str], system: System, reading: Reading, small: bool) -> list[Claim]:
    hint = "write for example {claim: kinetic energy, equals: m*x_dot**2/2, place: eq. (1)}"
    kind = _kind(item)
    unfit = [key for key, there in keys_of(kind).items() if not there] if kind is not None else []
    fields = reading.fields(item, "a claim", CLAIM, hint, unfit)
    node = fields.require("claim", f"one of: {', '.join(CLAIMS)}")
    word = None if node is None else reading.word(node, "a claim", _KINDS)
    if word is None and isinstance(node, Scalar):
        # Read as it was meant, for what else may be wrong with it.
        word = closest(" ".join(node.text.lower().split()), _KINDS, _MISSPELT)
    if word is None:
        _check_names(fields, reading)
        return []
    name = _KINDS[word]
    reader = _Reader(name, CLAIMS[name], fields, bodies, system, reading, small)
    return reader.conditions() if reader.kind.inequality else [reader.single()]


def _check_names(fields: Fields, reading: Reading) -> None:
    """Of a claim of unknown kind: complain about names that no claim could hold."""
    scope = reading.scope
    variable_node = fields.get("variable")
    variable = variable_node.text if isinstance(variable_node, Scalar) and variable_node.text not in scope.kinds else ""
    if variable:
        scope.kinds[variable] = "variable"
    allowed = Allowed("a claim", (*_PLACES, "acceleration", "variable"))
    for key in ("equals", "at"):
        fields.expression(key, allowed)
    condition = fields.get("that")
    if isinstance(condition, Scalar) and condition.text.strip():
        read_comparisons(condition, reading, allowed)
    if variable:
        del scope.kinds[variable]


def keys_of(kind: ClaimKind) -> dict[str, bool]:
    """Of each key that some kinds of claim have, whether this one has it."""
    return {
        "of": bool(kind.of),
        "entry": kind.entry == 2,
        "component": kind.entry == 1,
        "at": kind.at,
        "variable": kind.variable,
        "order": kind.order,
        "that": kind.inequality,
        "as": kind.inequality,
        "equals": not kind.inequality,
        "state": kind.state,
        "tolerance": kind.state,
        "digits": kind.state,
    }


@dataclass(slots=True)
class _Reader:
    """One claim being read: its kind and keys, and what they may name."""

    word: str
    kind: ClaimKind
    fields: Fields
    bodies: list[str]
    system: System
    reading: Reading
    small: bool = False

    def single(self) -> Claim:
        kind, fields = self.kind, self.fields
        self.refuse_keys()
        variable = self.variable()
        equals, printed = self.equals(variable)
        claim = Claim(
            kind=self.word,
            equals=equals,
            entry=self.entry() if kind.entry else (),
            at=self.product() if kind.at else None,
            variable=variable,
            order=self.order(equals) if kind.order else 0,
            at_initial=self.at_initial,
            state=self.state(),
            printed=printed,
            tolerance=self.tolerance(),
            digits=self.digits(),
            place=fields.text("place"),
            span=fields.key_span("claim"),
        )
        if kind.of == EXPRESSION and kind.order:
            of = fields.required_expression("of", Allowed("what oscillates", (*VARIABLES, *_CONSTANTS)))
            claim = replace(claim, of_expression=of)
        elif kind.of == EXPRESSION:
            allowed = Allowed("the value of an expression", (*_PLACES, "acceleration"))
            claim = replace(claim, of_expression=fields.required_expression("of", allowed))
            fields.require("state", "write state: initial, or state: {coordinate: number}")
        elif kind.of:
            claim = replace(claim, of=self.of())
        return claim

    def conditions(self) -> list[Claim]:
        """``that: alpha > -1``; a chain is several conditions."""
        self.refuse_keys()
        node = self.fields.require("that", "write for example that: b > a")
        scalar = None if node is None else self.reading.scalar(node, "a condition")
        place, span = self.fields.text("place"), self.fields.key_span("claim")
        word = self.fields.word("as", "the role of a condition")
        assumptions = (
            [] if scalar is None else read_comparisons(scalar, self.reading, Allowed("a condition", _CONSTANTS))
        )
        return [
            Claim(
                self.word,
                assumption.left,
                relation=assumption.relation,
                right=assumption.right,
                role=word,
                place=place,
                span=span,
            )
            for assumption in assumptions
        ]

    def refuse_keys(self) -> None:
        """Keys that mean nothing for this kind of claim."""
        kind, needed_by_key = self.kind, keys_of(self.kind)
        self.fields.exclude(f"claim: {self.word}", [key for key, needed in needed_by_key.items() if not needed])
        if "tolerance" in self.fields.entries:
            self.fields.exclude("tolerance", ["digits"])
        if kind.state and "state" not in self.fields.entries:
            for key in ("tolerance", "digits"):
                if key in self.fields.entries:
                    hint = "add for example state: initial; formulas are compared exactly"
                    self.reading.error(
                        "missing-key", "'[[key]]' is about numbers at a state", self.fields.key_span(key), hint, key=key
                    )

    # --- what is claimed ---

    def allowed(self, variable: str) -> Allowed:
        what = Message("a claim about the [[word]]", word=self.word)
        if self.word.startswith(_CONSTANT_KINDS):
            return Allowed(what, (*_CONSTANTS, *(["variable"] if variable else [])))
        if self.kind.oscillates:
            return Allowed(what, (*_CONSTANTS, *OSCILLATION_KINDS))
        accelerations = ("acceleration",) if self.kind.accelerations else ()
        places = _WITHOUT_INPUTS if self.word == "first integral" else _PLACES
        momenta = ("momentum",) if self.kind.momenta and not self.system.speeds else ()
        return Allowed(what, (*places, *momenta, *accelerations))

    def equals(self, variable: str) -> tuple[Expression, str]:
        """The expression; and its text, where it is a decimal number about one state, digits included."""
        node = self.fields.require("equals")
        if node is None:
            return ZERO, ""
        scope = self.reading.scope
        if variable:
            scope.kinds[variable] = "variable"
        value = self.reading.expression(node, self.allowed(variable))
        if variable:
            del scope.kinds[variable]
        text = node.text.strip() if isinstance(node, Scalar) else ""
        numerical = self.kind.state and "state" in self.fields.entries
        return value, text if numerical and _DECIMAL.match(text) else ""

    def variable(self) -> str:
        """The symbol of the characteristic polynomial, a name that is not yet taken."""
        node = self.fields.require("variable", "write for example variable: p") if self.kind.variable else None
        scalar = None if node is None else self.reading.scalar(node, "'variable'")
        scope = self.reading.scope
        if scalar is None or not scope.declare(scalar.text, "variable", scalar.span):
            return ""
        del scope.kinds[scalar.text]
        return scalar.text

    def order(self, equals: Expression) -> int:
        """The power of a small parameter, of which the description has to have one."""
        small = self.system.small
        by_motion = self.kind.oscillates and self.system.motion and not self.system.speeds
        if not self.small and not by_motion:
            message = Message(
                "a claim about the [[word]] is about powers of a small parameter, and none is named", word=self.word
            )
            hint = "add for example 'small parameter: eps'"
            self.reading.error("missing-key", message, self.fields.key_span("claim"), hint)
        if small is not None and small.name in names(equals):
            equals_node = self.fields.get("equals")
            message = Message(
                "what stands before a power of the small parameter [[name]] does not hold it", name=small.name
            )
            span = None if equals_node is None else equals_node.span
            self.reading.error("misplaced-name", message, span, "give the coefficient alone")
        hint = Message("write a whole number from 0 to [[most]]", most=MOST_ORDER)
        node = self.fields.require("order", "write for example order: 1")
        return self._whole(node, "'order'", 0, MOST_ORDER, "[[what]] is no order", hint)

    def _whole(self, node: Node | None, what: str, least: int, most: int, words: str, hint: str) -> int:
        """A whole number between bounds; 0 where there is none."""
        scalar = None if node is None else self.reading.scalar(node, what)
        if scalar is None:
            return 0
        text = scalar.text.strip()
        if text.isascii() and text.isdigit() and len(text) < 5 and least <= int(text) <= most:
            return int(text)
        self.reading.error("bad-number", Message(words, what=ascii_safe(scalar.text)), scalar.span, hint)
        return 0

    def tolerance(self) -> Expression | None:
        node = self.fields.get("tolerance")
        if node is None:
            return None
        value = self.reading.expression(node, NUMBER)
        number = rational(value)
        if number is not None and number <= 0:
            self.reading.error("bad-number", "a tolerance is a positive number", node.span, "write for example 1e-9")
        return value

    def digits(self) -> int:
        words, hint = "[[what]] is no number of digits", "write a whole number from 1"
        return self._whole(self.fields.get("digits"), "'digits'", 1, 9999, words, hint)

    # --- of what ---

    def of(self) -> str:
        node = self.fields.get("of") if self.kind.variable else self.fields.require("of")
        if node is None:
            return ""
        if self.kind.of == BODY:
            name = read_body_name(node, "'of'", self.bodies, self.reading)
            if name == INERTIAL:
                self.reading.error("unknown-body", "the inertial frame 0 does not move", node.span)
            return name or ""
        scalar = self.reading.scalar(node, "'of'")
        if scalar is None:
            return ""
        words = " ".join(scalar.text.split())
        known = [*self.system.claimable, *(SUMS if self.kind.of == SUM else ())]
        if words not in known:
            hint = did_you_mean(words, known) or Message("one of: [[known]]", known=", ".join(known[:12]))
            expected = "a coordinate" if self.kind.of == COORDINATE else "a quantity or a coordinate"
            self.reading.error(
                "unknown-name",
                "[[words]] is not [[wanted]]",
                scalar.span,
                hint,
                words=ascii_safe(words),
                wanted=expected,
            )
        return words

    def entry(self) -> tuple[int, ...]:
        """Indices from 1: numbers, or names of coordinates; axes are numbered 1 to 3."""
        key = "component" if self.kind.entry == 1 else "entry"
        node = self.fields.require(key)
        if node is None:
            return ()
        names = index_names(self.kind, self.system)
        if self.kind.entry == 1:
            return (self.index(node, key, names[0]),)
        items = self.reading.items(node, f"'{key}'")
        if len(items) != 2:
            if items:
                self.reading.error("wrong-shape", "an entry is a row and a column", node.span, "write [1, 2]")
            return ()
        return (self.index(items[0], key, names[0]), self.index(items[1], key, names[1]))

    def index(self, node: Node, key: str, names: tuple[str, ...]) -> int:
        scalar = self.reading.scalar(node, f"'{key}'")
        if scalar is None:
            return 1
        text = scalar.text.strip()
        if text in names:
            return names.index(text) + 1
        size = 3 if self.kind.axes else len(names)
        if text.isascii() and text.isdigit() and len(text) < 4 and 1 <= int(text) <= size:
            return int(text)
        if not size:
            message = Message("the [[word]] has no entries: the system has no inputs, or no outputs", word=self.word)
            self.reading.error("bad-entry", message, scalar.span, "declare them under 'inputs' and 'outputs'")
            return 1
        some = "" if not names else "a coordinate, or " if names == self.system.claimable else f"{names[0]}, ..., or "
        hint = did_you_mean(text, names) or Message("[[some]]a number from 1 to [[size]]", some=some, size=size)
        message = Message(
            "[[what]] is no [[axes]]", what=ascii_safe(text), axes="axis" if self.kind.axes else "row or column"
        )
        self.reading.error("bad-entry", message, scalar.span, hint)
        return 1

    def product(self) -> Expression:
        """A product of powers of velocities (in an equation of motion: of accelerations, too)."""
        errors = self.reading.errors
        value = self.fields.required_expression("at", Allowed("a product of velocities", ("velocity", "acceleration")))
        node = self.fields.get("at")
        if node is not None and self.reading.errors == errors and not _is_product(value):
            hint = "write for example x_dot*phi_dot or phi_dot**2"
            self.reading.error("bad-entry", "a coefficient belongs to a product of velocities", node.span, hint)
        return value

    # --- where ---

    @property
    def at_initial(self) -> bool:
        node = self.fields.get("state") if self.kind.state else None
        return isinstance(node, Scalar) and node.text.strip().lower() == INITIAL_STATE

    def state(self) -> tuple[tuple[str, Expression], ...]:
        """Numbers for some names; parameters that are left out have their 'values', the others are zero."""
        node = self.fields.get("state") if self.kind.state else None
        if node is None or self.at_initial:
            return ()
        values = []
        if isinstance(node, Scalar):
            self.reading.shape_error(node, "'state'", "'initial' or a mapping", "write state: {theta: pi/6}")
            return ()
        if isinstance(node, Mapping) and not node.entries:
            hint = "write state: initial, or state: {theta: 0}"
            self.reading.error("missing-value", "this state holds no number", node.span, hint)
        for entry in self.reading.entries(node, "'state'"):
            value = self.reading.expression(entry.value, NUMBER)
            if self.reading.scope.check_name(entry.key.text, entry.key.span, _STATE):
                values.append((entry.key.text, value))
        return tuple(values)


def _is_product(value: Expression) -> bool:
    match value:
        case Name():
            return True
        case Operation("*", left, right):
            return _is_product(left) and _is_product(right)
        case Operation("**", Name(), Number(exponent)):
            return exponent.denominator == 1 and 0 < exponent < 10
    return False
