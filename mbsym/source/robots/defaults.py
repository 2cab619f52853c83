"""The default classes of MJCF: attributes that elements of a tag have where they do not give them themselves."""

from __future__ import annotations

from mbsym.expressions.parser import ascii_safe
from mbsym.source.robots.elements import Element
from mbsym.source.robots.orientation import TURNING
from mbsym.source.robots.reader import Reader

_MAIN = "main"


class Defaults:
    """Classes within classes: an inner one has what the outer ones say, unless it says otherwise.

    The outermost class is that of everything without a class, whatever it is called; several such sections are one.
    """

    def __init__(self, root: Element, reader: Reader) -> None:
        self.reader = reader
        self.known: dict[str, dict[str, dict[str, str]]] = {_MAIN: {}}
        for element in root.all("default"):
            self._read(element, _MAIN, self.known[_MAIN])
            if name := element.get("class"):
                self.known[name] = self.known[_MAIN]

    def _read(self, element: Element, name: str, above: dict[str, dict[str, str]]) -> None:
        own = {tag: dict(attributes) for tag, attributes in above.items()}
        for child in element.children:
            if child.tag != "default":
                own[child.tag] = {**own.get(child.tag, {}), **child.attributes}
        self.known[name] = own
        for child in element.all("default"):
            self._read(child, child.get("class"), own)

    def of(self, element: Element, childclass: str) -> Element:
        """The element with what its class, or that of the bodies around it, says beside its own attributes."""
        name = self.checked(element, "class") or childclass or _MAIN
        given = self.known.get(name, {}).get(element.tag, {})
        if any(key in element.attributes for key in TURNING):  # one way to turn stands for all others
            given = {key: value for key, value in given.items() if key not in TURNING}
        return Element(element.tag, {**given, **element.attributes}, element.span, element.children)

    def checked(self, element: Element, attribute: str) -> str:
        """The class that an attribute names, "" for none; complains about one that there is not."""
        name = element.get(attribute)
        if name and name not in self.known:
            self.reader.error("unknown-name", f"there is no default class {ascii_safe(name)}", element)
        return name
