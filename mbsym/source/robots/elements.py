"""XML as elements that know their place, read by expat; what could grow without bound is refused before it does."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from xml.parsers import expat

from mbsym.expressions.parser import ascii_safe
from mbsym.expressions.place import Complaints, Span

#: A file has at most so many characters, elements, and elements within each other.
MAX_XML, MAX_ELEMENTS, MAX_DEPTH = 8_000_000, 50_000, 200


@dataclass(slots=True)
class Element:
    """A tag with its attributes, the elements inside it, and where it begins."""

    tag: str
    attributes: dict[str, str]
    span: Span
    children: list[Element] = field(default_factory=list)

    def all(self, tag: str) -> list[Element]:
        """The direct children of a tag."""
        return [child for child in self.children if child.tag == tag]

    def first(self, tag: str) -> Element | None:
        return next(iter(self.all(tag)), None)

    def walk(self) -> Iterator[Element]:
        """This element and all inside it."""
        yield self
        for child in self.children:
            yield from child.walk()

    def get(self, name: str, default: str = "") -> str:
        return self.attributes.get(name, default).strip()


class _Stop(Exception):
    """Internal: reading was given up; the complaint has been made."""


def parsed(text: str, complaints: Complaints) -> Element | None:
    """The root element, or None with a complaint: no XML, too large, or with a document type of its own."""
    if len(text) > MAX_XML:
        complaints.error("too-large", f"the file has more than {MAX_XML} characters")
        return None
    parser = expat.ParserCreate()
    roots: list[Element] = []
    opened: list[Element] = []
    count = 0

    def place() -> Span:
        return Span(parser.CurrentLineNumber, parser.CurrentColumnNumber + 1)

    def stop(code: str, message: str) -> None:
        complaints.error(code, message, place())
        raise _Stop

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal count
        count += 1
        if count > MAX_ELEMENTS or len(opened) > MAX_DEPTH:
            stop("too-large", f"there are at most {MAX_ELEMENTS} elements, {MAX_DEPTH} within each other")
        element = Element(tag, attributes, Span(place().line, place().column, len(tag) + 1))
        (opened[-1].children if opened else roots).append(element)
        opened.append(element)

    def doctype(*_: object) -> None:
        stop("unsupported", "a document type is not read: its entities could be anything")

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: opened.pop()
    parser.StartDoctypeDeclHandler = doctype
    try:
        parser.Parse(text, True)
    except _Stop:
        return None
    except expat.ExpatError as error:
        message = f"this is no XML: {ascii_safe(expat.ErrorString(error.code)).strip(chr(39))}"
        complaints.error("syntax", message, Span(error.lineno, error.offset + 1))
        return None
    return roots[0]


def include(root: Element, beside: Callable[[str], str | None], complaints: Complaints, seen: set[str]) -> None:
    """Puts what other files hold in place of ``<include file="...">``, each file once.

    Complaints about it have the place of the <include>.  One that cannot be read stays, for whoever reads on.
    """
    children: list[Element] = []
    for child in root.children:
        file = child.get("file") if child.tag == "include" else ""
        text = beside(file) if file and file not in seen else None
        if child.tag == "include" and text is not None:
            seen.add(file)
            own = Complaints()
            found = parsed(text, own)
            for one in own.items:
                complaints.error(one.code, f"in {ascii_safe(file)}: {one.message}", child.span)
            if found is not None:
                for element in found.walk():
                    element.span = child.span
                include(found, beside, complaints, seen)
                children += found.children
            continue
        include(child, beside, complaints, seen)
        children.append(child)
    root.children = children
