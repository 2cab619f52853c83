"""Names: which are declared, which words may be names at all, and which names a place allows."""

from __future__ import annotations

import keyword
import re
from collections.abc import Iterable
from dataclasses import dataclass, field

from mbsym.expressions.message import Message, joined, worded
from mbsym.expressions.parser import DEGREES, ascii_safe, in_latin
from mbsym.expressions.place import Complaints, Span
from mbsym.expressions.rates import ACCELERATION_ENDING, VELOCITY_ENDING, is_rate, without_velocity
from mbsym.expressions.table import Table
from mbsym.expressions.tree import (
    CONSTANTS,
    FUNCTIONS,
    JUMPS,
    KINKED,
    MOST_WRITTEN_OUT,
    Call,
    Expression,
    Name,
    sticks,
    walk,
)
from mbsym.model.system import acceleration_name, velocity_name

MAX_NAME = 64

#: Names that resemble each other as much (1: equal) are taken for slips.
_SLIP = 0.8

_IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]*\Z")

_KINDS = {
    "parameter": "a parameter",
    "prescribed": "a prescribed motion",
    "given": "a function of time",
    "given rate": "the derivative of a function of time",
    "given acceleration": "the second derivative of a function of time",
    "coordinate": "a coordinate",
    "velocity": "a velocity",
    "time": "the time",
    "notation": "a notation",
    "acceleration": "an acceleration",
    "abbreviation": "an abbreviation",
    "variable": "a variable",
    "table": "a table",
    "input": "an input",
    "output": "an output",
    "speed": "a speed",
    "unit vector": "a component of a unit vector",
    "quaternion": "a component of a quaternion",
    "momentum": "a momentum",
    "oscillation": "a symbol of an oscillation",
    "input abbreviation": "an abbreviation that holds an input",
    "oscillation abbreviation": "an abbreviation that holds symbols of an oscillation",
}
_PLURALS = {
    "parameter": "parameters",
    "prescribed": "prescribed motions",
    "given": "functions of time",
    "given rate": "their derivatives",
    "given acceleration": "second derivatives of these",
    "coordinate": "coordinates",
    "velocity": "velocities",
    "time": "t",
    "notation": "notation",
    "acceleration": "accelerations",
    "abbreviation": "abbreviations",
    "variable": "the variable",
    "table": "tables",
    "input": "inputs",
    "output": "outputs",
    "speed": "speeds",
    "unit vector": "components of unit vectors",
    "quaternion": "components of quaternions",
    "momentum": "momenta",
    "oscillation": "symbols of an oscillation",
    "input abbreviation": "abbreviations that hold them",
    "oscillation abbreviation": "abbreviations of them",
}
#: Kinds of names that are told where the description has some.
_RARE = (
    *("given", "given rate", "given acceleration"),
    "speed",
    "input",
    "input abbreviation",
    "unit vector",
    "quaternion",
    "momentum",
    "oscillation",
    "oscillation abbreviation",
)


_IN_TIME = (
    ("prescribed", "given"),
    ("velocity", "given rate"),
    ("input", "given acceleration"),
    ("acceleration", "given acceleration"),
)


@dataclass(frozen=True, slots=True)
class Allowed:
    """What may stand in one sort of place: ``what`` names the place in messages.

    Unless ``given`` is false, where a prescribed motion may stand a free function of time may, where a velocity its
    derivative, where an input the second one.
    ``kinked`` are the functions with a kink or a jump that may stand there: a force may jump, a potential may not, for
    its derivative is the force; the place of a body may not even have a kink, for its acceleration counts.
    """

    what: str
    named: tuple[str, ...] = ("parameter",)
    kinked: tuple[str, ...] = ()
    given: bool = True

    @property
    def kinds(self) -> tuple[str, ...]:
        """The kinds that are ``named``, and those of functions of time."""
        in_time = (other for kind, other in _IN_TIME if self.given and kind in self.named)
        return tuple(dict.fromkeys((*self.named, *in_time)))


NUMBER = Allowed("a numerical value", (), KINKED)
ANGLE = Allowed("a rotation angle", ("coordinate", "prescribed", "parameter", "time"))
RADIUS = Allowed("a connection point", ("coordinate", "prescribed", "parameter", "time"))
VELOCITY = Allowed("a relative velocity", ("coordinate", "velocity", "prescribed", "parameter", "time"))
POTENTIAL = Allowed(
    "a force function or potential", ("coordinate", "unit vector", "prescribed", "parameter", "time"), ("abs",)
)
DISSIPATION = Allowed(
    "a dissipation function", ("coordinate", "velocity", "speed", "prescribed", "parameter", "time"), ("abs",)
)
FORCE = Allowed(
    "a force", ("coordinate", "velocity", "speed", "unit vector", "prescribed", "parameter", "time", "input"), KINKED
)
ASSUMPTION = Allowed("an assumption", ("parameter", "notation"))


@dataclass(slots=True)
class Scope:
    """All declared names with their kinds; complains about clashes and about unknown or misplaced names.

    ``later`` holds the names of notation (or abbreviations, as ``ordered`` says) that are still to come, ``assumed``
    undeclared names that were complained about and are since taken for whatever their place allows, ``beside`` the keys
    that stand beside the one that is looked at.  While ``by_use`` is a dictionary, an unknown name in a place that
    parameters may take is a parameter by its use; it is kept there with its first place.  ``motionless``: there are
    bodies and no coordinates, which is an error of its own.  ``tables`` are called like functions.
    """

    complaints: Complaints
    kinds: dict[str, str] = field(default_factory=dict)
    later: set[str] = field(default_factory=set)
    ordered: str = "notation is"
    assumed: set[str] = field(default_factory=set)
    beside: set[str] = field(default_factory=set)
    by_use: dict[str, Span] | None = None
    motionless: bool = False
    tables: dict[str, Table] = field(default_factory=dict)

    def declare(self, name: str, kind: str, span: Span) -> bool:
        """Enter a name; False (with a complaint) if it is no name, or taken."""
        if not self.is_name(name, span):
            if name and not is_rate(name):
                self.kinds.setdefault(name, kind)  # one complaint about it is enough
                self.assumed.add(name)
            return False
        if name in self.kinds:
            taken = _KINDS[self.kinds[name]]
            self.complaints.error(
                "repeated-name", "[[name]] is already declared as [[taken]]", span, name=ascii_safe(name), taken=taken
            )
            return False
        self.kinds[name] = kind
        return True

    def is_name(self, name: str, span: Span) -> bool:
        reason = why_no_name(name)
        if reason is not None:
            self.complaints.error(
                "bad-name",
                Message("[[name]] cannot be a name: [[reason]]", name=ascii_safe(name), reason=reason[0]),
                span,
                reason[1],
            )
        return reason is None

    def holds_no_name(self, text: str) -> bool:
        """Whether a formula has something for a name that was declared, complained about, and cannot be read."""
        unread = [name for name in self.assumed if not name.isidentifier()]
        return any(re.search(rf"(?<![\w.]){re.escape(name)}(?!\w)", text) for name in unread)

    def of_kind(self, *kinds: str) -> list[str]:
        return [name for name, kind in self.kinds.items() if kind in kinds]

    def kind_of(self, name: str) -> str | None:
        if name == "t":
            return "time"
        if name in self.kinds:
            return self.kinds[name]
        if dots := len(name) - len(name.rstrip("'")):  # theta', as formulas have it
            name = name[:-dots] + ("", VELOCITY_ENDING, ACCELERATION_ENDING)[min(dots, 2)]
        for suffix, kind in ((VELOCITY_ENDING, "velocity"), (ACCELERATION_ENDING, "acceleration")):
            base = self.kinds.get(name.removesuffix(suffix)) if name.endswith(suffix) else None
            if base == "coordinate":
                return kind
            if base == "given":
                return "given rate" if kind == "velocity" else "given acceleration"
        if self.kinds.get(without_velocity(name)) in ("speed", "unit vector", "quaternion"):
            return "acceleration"  # what the equations give
        return None

    def check(self, expression: Expression, allowed: Allowed) -> None:
        """Complain about every name in an expression that its place does not allow."""
        for node in walk(expression):
            if isinstance(node, Call) and _kinked_as(node) not in ("", *allowed.kinked):
                self._refuse_kinked(node, allowed)
            if allowed is DISSIPATION and isinstance(node, Call) and sticks(node):
                self._bound_points(node)
            if isinstance(node, Name) and node.name not in CONSTANTS and node.span is not None:
                self.check_name(node.name, node.span, allowed)

    def _refuse_kinked(self, node: Call, allowed: Allowed) -> None:
        """A function with a kink or a jump where its derivatives would be wanted."""
        hint = "forces and torques may jump: 'generalized force', 'force', 'torque'"
        if allowed.kinked:
            message = Message(
                "[[function]] jumps, and the derivative of [[what]] is a force",
                function=node.function,
                what=worded(allowed.what),
            )
        else:
            kind = "jump" if _kinked_as(node) in JUMPS else "kink"
            message = Message(
                "[[what]] may not hold [[function]], which has a [[kind]]",
                what=worded(allowed.what),
                function=node.function,
                kind=kind,
            )
            if node.table is not None:
                hint = "smooth are tables with between: cubic, outside: extrapolate or error"
        self.complaints.error("not-smooth", message, node.span, hint)

    def _bound_points(self, node: Call) -> None:
        """Friction that may hold at each knot has a switch for each."""
        assert node.table is not None
        count = len(node.table.points)
        if count > MOST_WRITTEN_OUT:
            message = Message(
                "a dissipation function with kinks in velocities has at most [[most]] points, not [[count]]",
                most=MOST_WRITTEN_OUT,
                count=count,
            )
            self.complaints.error("too-large", message, node.span, "give the force itself: 'generalized force'")

    def check_key(self, key: Span, name: str, keys: Iterable[str], allowed: Allowed) -> bool:
        """The same for a key beside others, none of which is what it was meant to be."""
        self.beside = set(keys)
        try:
            return self.check_name(name, key, allowed)
        finally:
            self.beside = set()

    def check_name(self, name: str, span: Span, allowed: Allowed) -> bool:
        if name in self.assumed or without_velocity(name) in self.assumed:
            return True
        kind = self.kind_of(name)
        if kind == "acceleration" and kind not in allowed.kinds:
            kind = None
        if kind is None and self._is_parameter_by_use(name, span, allowed):
            return True
        if kind is None and self.motionless and allowed.kinds == ("coordinate",):
            return False  # that nothing moves is said, or why the joints could not be read
        if kind is None:
            message = Message("unknown name [[name]]", name=ascii_safe(name))
            self.complaints.error("unknown-name", message, span, self._unknown_hint(name, allowed))
        elif kind not in allowed.kinds:
            told = {*self.kinds.values()} | {other for _, other in _IN_TIME if self.of_kind("given")}
            kinds = [
                allowed_kind for allowed_kind in allowed.kinds if allowed_kind not in _RARE or allowed_kind in told
            ]
            held = _enumerated([_PLURALS[allowed_kind] for allowed_kind in kinds]) or "numbers"
            message = Message(
                "'[[name]]' is [[kinds]], and [[what]] holds only [[held]]",
                name=name,
                kinds=worded(_KINDS[kind]),
                what=worded(allowed.what),
                held=held,
            )
            self.complaints.error("misplaced-name", message, span, _misplaced_hint(name, kind, allowed))
        else:
            return True
        return False

    def _is_parameter_by_use(self, name: str, span: Span, allowed: Allowed) -> bool:
        """Whether an unknown name declares itself; one that looks like a slip for a coordinate's does not."""
        if self.by_use is None or "parameter" not in allowed.kinds or name in self.later or why_no_name(name):
            return False
        if slip_of(name, self.of_kind("coordinate", "prescribed")) is not None:
            return False
        self.kinds[name] = "parameter"
        self.by_use[name] = span
        return True

    def _unknown_hint(self, name: str, allowed: Allowed) -> str | None:
        if name in self.later:
            return Message("[[names]] read in order: move its definition up", names=self.ordered)
        if name.endswith(ACCELERATION_ENDING) and "acceleration" not in allowed.kinds:
            none = "this claim holds none" if "abbreviation" in allowed.kinds else "they stand in no description"
            return Message("accelerations are what the equations are solved for; [[why]]", why=none)
        known = [other for other, kind in self.kinds.items() if kind in allowed.kinds and other not in self.beside]
        if "velocity" in allowed.kinds:
            known += [velocity_name(coordinate) for coordinate in self.of_kind("coordinate", "given")]
        if "acceleration" in allowed.kinds:
            known += [acceleration_name(coordinate) for coordinate in self.of_kind("coordinate", "given")]
        if self.kinds.get(without_velocity(name)) == "input":
            return "an input is any function of time: what depends on its rate is no load of this system"
        if allowed.kinds == ("coordinate",) and any(sign in name for sign in "+-"):
            return "one coordinate is wanted; on q2 - q1 acts a 'potential', or a dissipation function 'rayleigh'"
        close = did_you_mean(name, filter(_IDENTIFIER.match, known))
        if close is not None:
            return close
        if self.kinds.get(without_velocity(name)) == "prescribed":
            return "a prescribed motion has a constant rate: write the rate"
        reason = why_no_name(name) if allowed.kinds else None
        if reason is not None:
            return joined([Message("it cannot be a name: [[why]]", why=reason[0]), *filter(None, reason[1:])], "; ")
        if name.lower() in DEGREES:
            return "angles are in radians: write pi/180 for a degree"
        if not allowed.kinds:
            return "a number is wanted here"
        if allowed.kinds == ("coordinate",):
            return listed("the coordinates are", self.of_kind("coordinate"))
        if name == "e" and "parameter" in allowed.kinds:
            return "declare it under 'parameters'; Euler's number is exp(1)"
        if "abbreviation" in allowed.kinds:
            return "declare it under 'abbreviations' or 'parameters'"
        return "declare it under 'parameters'" if "parameter" in allowed.kinds else None


def _kinked_as(node: Call) -> str:
    """The function with a kink or a jump that a call is of, for a table one as smooth; "" where it is smooth."""
    if node.table is not None:
        return "" if node.table.smooth else "step" if node.table.jumps else "abs"
    return node.function if node.function in KINKED else ""


def listed(what: str, words: Iterable[str], most: int = 20) -> str | None:
    """``what: a, b, c``, cut where there are too many; None where there are none."""
    known = list(words)
    more = [*known[:most], *(["..."] if len(known) > most else [])]
    return joined([worded(what), ", ".join(more)], ": ") if known else None


def _enumerated(words: list[str]) -> str:
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


#: By what is said of the place: what to write where a function of time, or a derivative of one, stands in a wrong one.
_FUNCTION_HINTS = {
    "the law of a function of time": "write its law in its place",
    "the key of a motion": "what it is stands under 'given': its value",
    "an initial value": "write the number that it is at t = 0",
    "an unperturbed motion": "a function of time stands in 'value', without a 'rate' beside it",
    "a mass centre": "what moves in a body is a body of its own, with that connection point",
    "a connection point": "declare a function of its own for it",
    "a rotation angle": "declare a function of its own for it",
}


def _misplaced_hint(name: str, kind: str, allowed: Allowed) -> str | None:
    if kind == "time" and allowed.what == "the rate of a prescribed motion":
        return "the rate alone, without t: psi: w where psi is w*t"
    if kind == "time" and allowed.what == "an unperturbed motion":
        return "what turns steadily has a rate: psi: {rate: w} where psi is w*t"
    if kind == "time" and "prescribed" in allowed.kinds:
        return "declare what changes with time under 'prescribed'"
    if kind == "velocity" and allowed.what == "the key of an initial value":
        name = without_velocity(name.replace("'", VELOCITY_ENDING))
        return Message("position and velocity stand together: write [[name]]: {position: 0, velocity: 1}", name=name)
    if kind == "table":
        return "a table is called with its argument, as in torque(t)"
    if kind == "input" and allowed.what in ("a connection point", "a rotation angle"):
        entry = f"{name}: {{of: t}}"
        return Message("a function of time that joints hold stands under 'given': [[entry]]", entry=entry)
    if kind == "input":
        return "inputs stand in forces: 'generalized force', 'force', 'torque', and in outputs"
    if kind in ("velocity", "given rate") and allowed is POTENTIAL:
        return "a force that depends on velocities belongs under 'generalized force', 'damper' or 'rayleigh'"
    if kind.startswith("given") and (hint := _FUNCTION_HINTS.get(allowed.what)) is not None:
        return hint
    if kind in ("coordinate", "prescribed", "given") and allowed.what == "a direction":
        return "a force whose direction turns with a body is a 'force' with components in the 'axes' of that body"
    return None


def closest(word: str, known: Iterable[str], cutoff: float = 0.6) -> str | None:
    """The known word that a word resembles (1: is equal to) more than ``cutoff``, if there is one."""
    from difflib import get_close_matches

    candidates = list(known)[:200]
    same = [candidate for candidate in candidates if candidate.lower() == word.lower()]
    close = same or get_close_matches(word[:MAX_NAME], candidates, n=1, cutoff=cutoff)
    return close[0] if close else None


def did_you_mean(word: str, known: Iterable[str]) -> str | None:
    """The hint for a word that resembles a known one."""
    close = closest(word, known)
    return None if close is None else Message("did you mean '[[other]]'?", other=close)


def slip_of(name: str, known: Iterable[str]) -> str | None:
    """The known name that a name looks like a slip of the pen for; ``theta1`` and ``thetaB`` are none of ``theta2``."""
    from difflib import SequenceMatcher

    best: tuple[float, str] | None = None
    for candidate in list(known)[:100]:
        short, long = sorted((name, candidate), key=len)
        if not short:
            continue
        if short.rstrip("0123456789") == long.rstrip("0123456789") or short[:-1] == long[:-1]:
            continue
        if long.startswith(short) and set(long[len(short) :]) != {short[-1]}:
            continue
        matcher = SequenceMatcher(None, name, candidate)
        bar = best[0] if best is not None else _SLIP
        if matcher.real_quick_ratio() >= bar and matcher.quick_ratio() >= bar and matcher.ratio() >= bar:
            best = matcher.ratio(), candidate
    return best and best[1]


def why_no_name(name: str) -> tuple[str, str | None] | None:
    """Why a word cannot be the name of a parameter or coordinate (with a hint), or None if it can."""
    if not name.strip():
        return "it is empty", "write one letter or more"
    if not _IDENTIFIER.match(name):
        latin = in_latin(name[:MAX_NAME])
        hint = Message("write [[latin]]", latin=latin) if latin != name and _IDENTIFIER.match(latin) else None
        return "names are Latin letters, digits and _, and begin with a letter", hint
    if len(name) > MAX_NAME:
        return Message("names have at most [[most]] characters", most=MAX_NAME), None
    if name in FUNCTIONS:
        return "it is a function", None
    if name in CONSTANTS:
        return "it is a number", None
    if name == "t":
        return "it is the time", None
    if name in ("true", "false", "null"):
        return "it is a word of YAML, and no text", Message("write [[name]]1", name=name)
    if keyword.iskeyword(name):
        hint = Message("write lam or lambda1") if name == "lambda" else Message("write [[name]]1", name=name)
        return "it is a reserved word of Python, in which results are written", hint
    if is_rate(name):
        return "the ending _dot is kept for velocities", None
    if "__" in name or name.endswith("_"):
        return "underscores stand single and inside a name", None
    return None
