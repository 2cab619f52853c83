"""How named intermediates are told: passages, each a phrase and the definitions that it introduces, in order.

Every target for people prints the same passages.  Bodies are numbered as the report numbers them; a name is said once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from mbsym.expressions.message import Message, enumerated
from mbsym.formulas.formula import Formula
from mbsym.formulas.told import Definition, Told
from mbsym.mechanics.falling import falling_frames
from mbsym.mechanics.intermediates import Meaning, Quantity
from mbsym.model.loads import Load, NewtonianGravity
from mbsym.model.system import INERTIAL, System


@dataclass(frozen=True)
class Passage:
    """``words``, the symbol of ``coordinate`` if there is one, a colon, and the definitions."""

    words: str
    coordinate: str
    definitions: tuple[Definition[Meaning], ...]


def passages(
    definitions: Told[Meaning], system: System, formulas: Iterable[Formula], known: Iterable[str] = ()
) -> tuple[Passage, ...]:
    """What formulas need to be understood, besides the names ``known`` before.

    Definitions of one quantity of one body stand together, and by component, where none uses one that comes later.
    """
    groups: list[list[Definition[Meaning]]] = []
    home: dict[int, int] = {}
    for item in definitions.wanted(formulas, known):
        used = [home[k] for k in definitions.held_by[item.name] if k in home]
        earliest = max(used, default=0)
        place = next((k for k in range(earliest, len(groups)) if _together(groups[k][0], item)), len(groups))
        if place == len(groups):
            groups.append([])
        groups[place].append(item)
        home[definitions.index(item.name)] = place
    speaker = _Speaker(system)
    return tuple(Passage(*speaker(group[0].meaning), _by_component(definitions, group)) for group in groups)


def _together(first: Definition[Meaning], second: Definition[Meaning]) -> bool:
    a, b = first.meaning, second.meaning
    if a is None or b is None:
        return a is b
    return (a.quantity, a.body, a.coordinate, a.load) == (b.quantity, b.body, b.coordinate, b.load)


def _by_component(definitions: Told[Meaning], group: Sequence[Definition[Meaning]]) -> tuple[Definition[Meaning], ...]:
    own = {definitions.index(item.name) for item in group}
    if any(own & definitions.held_by[item.name] for item in group):
        return tuple(group)
    return tuple(sorted(group, key=lambda item: () if item.meaning is None else item.meaning.place))


#: The words of a quantity where gravity, ``[[gravity]]``, is taken off an acceleration.
_LESS_GRAVITY = {
    Quantity.CARRIED_ACCELERATION: (
        "Acceleration of the connection point of [[b]] less [[gravity]], in the axes of [[p]]"
    ),
    Quantity.ACCELERATION: "Acceleration of the connection point of [[b]] less [[gravity]]",
}


#: The same where the expansion point is the origin of the inertial frame.
_FROM_ORIGIN = {
    Quantity.OUTWARD: (
        "Unit vector from the attracting centre to the origin of the inertial frame, in the axes of [[b]]"
    ),
    Quantity.PLACE: "Radius vector from the origin of the inertial frame to the mass centre of [[b]]",
}


class _Speaker:
    """Says what an intermediate is; each body's name once."""

    def __init__(self, system: System) -> None:
        self.system = system
        self.numbers = {body.name: k for k, body in enumerate(system.bodies, 1)}
        self.carriers = {body.attached_to for body in system.bodies}
        self.named: set[str] = set()

    def __call__(self, meaning: Meaning | None) -> tuple[str, str]:
        """The phrase, and the coordinate whose symbol ends it."""
        if meaning is None:
            return Message("Abbreviations, numbered as they come"), ""
        body = self.system.body(meaning.body) if meaning.body else None
        gravity = self._gravity(meaning.body) if meaning.quantity in _LESS_GRAVITY else []
        about = self._expanded_about(meaning.load) if meaning.quantity in _FROM_ORIGIN else ""
        other = _LESS_GRAVITY if gravity else _FROM_ORIGIN if about == INERTIAL else {}
        template = other.get(meaning.quantity, meaning.quantity.words)
        makers: dict[str, Callable[[], str]] = {
            "b": lambda: self._body(meaning.body),
            "it": lambda: self._carried(meaning.body),
            "p": lambda: self._body("" if body is None else body.attached_to),
            "o": lambda: self._body(about),
            "l": lambda: str(meaning.load),
            "common": lambda: self._common(meaning.load),
            "gravity": lambda: enumerated([self._named(x) for x in gravity]),
        }
        values = {key: make() for key, make in makers.items() if f"[[{key}]]" in template}
        return Message(template, **values), meaning.coordinate

    def _body(self, name: str) -> Message:
        if name == INERTIAL or not name:
            return Message("the inertial frame")
        which = str(self.numbers[name])
        if name not in self.named:
            self.named.add(name)
            which += f" ({name})"
        return Message("body [[which]]", which=which)

    def _carried(self, name: str) -> Message:
        body = self._body(name)
        return Message("[[body]] with what it carries", body=body) if name in self.carriers else body

    def _load(self, number: int) -> Load:
        return self.system.loads[number - 1]

    def _expanded_about(self, number: int) -> str:
        load = self._load(number)
        return (load.about if isinstance(load, NewtonianGravity) else "") or INERTIAL

    def _common(self, number: int) -> Message:
        paths = [self.system.path(point.body) for point in self._load(number).points]
        shared = [a for a, b in zip(*paths, strict=False) if a == b]
        return self._body(shared[-1])

    def _gravity(self, name: str) -> list[str]:
        """Which gravity is taken off an acceleration: the uniform one (""), and that at the origins of these frames."""
        carriers = [frame for frame in falling_frames(self.system) if frame in self.system.path(name)]
        return ([""] if self.system.uniform_fields else []) + carriers

    def _named(self, frame: str) -> Message:
        if not frame:
            return Message("gravity")
        return Message("the field at the connection point of [[body]]", body=self._body(frame))
