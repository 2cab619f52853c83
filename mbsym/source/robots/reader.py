"""What the readers of both formats do with attributes: demand numbers, complain with the place of the element."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

from mbsym.expressions.counting import counted
from mbsym.expressions.parser import ascii_safe
from mbsym.expressions.place import Complaints
from mbsym.source.robots.elements import Element
from mbsym.source.robots.numbers import NOWHERE, Texts, angle, decimal, number


@dataclass
class Reader:
    """Collects complaints, what is left out, by kind, and the printed angles that are read as parts of pi.

    With ``exact`` these stay the numbers that are printed.
    """

    complaints: Complaints
    exact: bool = False
    omitted: Counter[str] = field(default_factory=Counter)
    parts_of_pi: dict[str, str] = field(default_factory=dict)

    def error(self, code: str, message: str, element: Element, hint: str | None = None) -> None:
        self.complaints.error(code, message, element.span, hint)

    def name(self, element: Element, attribute: str = "name") -> str:
        """A required name."""
        found = element.get(attribute)
        if not found:
            self.error("missing-key", f"<{element.tag}> has no attribute '{attribute}'", element)
        return found

    def number(self, element: Element, attribute: str, default: str | None = "0") -> str:
        """One number as it is printed; ``default`` None: it must be there."""
        return self.numbers(element, attribute, 1, default)[0]

    def three(self, element: Element | None, attribute: str, default: str = "0 0 0", raw: bool = False) -> Texts:
        """Three numbers."""
        if element is None:
            return NOWHERE if default == "0 0 0" else _three(default)
        first, second, third = self.numbers(element, attribute, 3, default, raw)
        return first, second, third

    def numbers(
        self, element: Element, attribute: str, count: int, default: str | None = None, raw: bool = False
    ) -> tuple[str, ...]:
        """So many numbers as descriptions write them (``raw``: as they are printed); zeros after a complaint."""
        text = element.get(attribute)
        if not text and default is not None:
            return tuple(default.split())
        parts = text.split()
        if not text:
            self.error("missing-key", f"<{element.tag}> has no attribute '{attribute}'", element)
        elif len(parts) != count:
            wanted = counted(count, "number", "numbers")
            self.error("wrong-shape", f"'{attribute}' of <{element.tag}> has {len(parts)} parts, not {wanted}", element)
        else:
            bad = [part for part in parts if decimal(part) is None]
            if not bad:
                return tuple(parts if raw else map(number, parts))
            self.error("bad-number", f"{ascii_safe(bad[0])} in '{attribute}' is no number", element)
        return ("0",) * count

    def angle(self, text: str) -> str:
        """An angle in radians as it is printed, or the part of pi that it rounds."""
        plain = number(text)
        found = plain if self.exact else angle(text)
        if found != plain:
            self.parts_of_pi[text.strip()] = found
        return found

    def snapped(self) -> tuple[str, ...]:
        """``1.5708 as pi/2``, in the order of the file."""
        return tuple(f"{text} as {words}" for text, words in self.parts_of_pi.items())

    def leave_out(self, what: str) -> None:
        """Notes something that a description of rigid bodies in a tree has no place for."""
        self.omitted[what] += 1

    def left_out(self) -> tuple[str, ...]:
        """``mimic joint (3)``, in alphabetical order."""
        return tuple(f"{what} ({count})" if count > 1 else what for what, count in sorted(self.omitted.items()))


def _three(text: str) -> Texts:
    first, second, third = text.split()
    return first, second, third
