"""The default classes of MJCF: attributes that elements of a tag have where they do not give them themselves."""

from __future__ import annotations

from mbsym.source.robots.elements import Element

_MAIN = "main"


class Defaults:
    """Classes within classes: an inner one has what the outer ones say, unless it says otherwise."""

    def __init__(self, root: Element) -> None:
        self.known: dict[str, dict[str, dict[str, str]]] = {_MAIN: {}}
        for element in root.all("default"):
            self._read(element, element.get("class") or _MAIN, {})

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
        name = element.get("class") or childclass or _MAIN
        given = self.known.get(name, {}).get(element.tag, {})
        return Element(element.tag, {**given, **element.attributes}, element.span, element.children)
