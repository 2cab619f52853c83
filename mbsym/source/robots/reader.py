"""What the readers of both formats do with attributes: demand numbers, complain with the place of the element."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from decimal import Context, Decimal, InvalidOperation
from fractions import Fraction
from xml.parsers import expat

from mbsym.expressions.message import counted
from mbsym.expressions.parser import MAX_DIGITS, ascii_safe
from mbsym.expressions.place import Complaints, Span
from mbsym.model.admissibility import principal_minors
from mbsym.source.scope import closest


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
        value = element.get(attribute)
        if not value:
            self.error("missing-key", f"<{element.tag}> has no attribute '{attribute}'", element)
        return value

    def number(self, element: Element, attribute: str, default: str | None = "0") -> str:
        """One number as it is printed; ``default`` None: it must be there."""
        return self.numbers(element, attribute, 1, default)[0]

    def three(self, element: Element | None, attribute: str, default: str | None = "0 0 0", raw: bool = False) -> Texts:
        """Three numbers; ``default`` None: they must be there."""
        if element is None:
            return NOWHERE if default in (None, "0 0 0") else _three(default)
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
            required = counted(count, "number", "numbers")
            self.error(
                "wrong-shape", f"'{attribute}' of <{element.tag}> has {len(parts)} parts, not {required}", element
            )
        else:
            bad = [part for part in parts if decimal(part) is None]
            if not bad:
                return tuple(parts if raw else map(number, parts))
            self.error("bad-number", f"{ascii_safe(bad[0])} in '{attribute}' is no number", element)
        return ("0",) * count

    def angle(self, text: str) -> str:
        """An angle in radians as it is printed, or the part of pi that it rounds."""
        plain = number(text)
        radians = plain if self.exact else angle(text)
        if radians != plain:
            self.parts_of_pi[text.strip()] = radians
        return radians

    def snapped(self) -> tuple[str, ...]:
        """``1.5708 as pi/2``, in the order of the file."""
        return tuple(f"{text} as {words}" for text, words in self.parts_of_pi.items())

    def names(self, elements: Iterator[Element], what: str) -> set[str]:
        """The names of elements that have one; complains about each that stands twice."""
        names: set[str] = set()
        for element in elements:
            name = element.get("name")
            if name and name in names:
                self.error("repeated-name", f"a second {what} called {ascii_safe(name)}", element)
            names.add(name)
        return names - {""}

    def leave_out(self, what: str) -> None:
        """Notes something that a description of rigid bodies in a tree has no place for."""
        self.omitted[what] += 1

    def left_out(self) -> tuple[str, ...]:
        """``mimic joint (3)``, in alphabetical order."""
        return tuple(f"{what} ({count})" if count > 1 else what for what, count in sorted(self.omitted.items()))


def _three(text: str) -> Texts:
    first, second, third = text.split()
    return first, second, third


# What may stand in a file: a misspelt attribute, or a second element where one holds, must not go by in silence.


@dataclass(frozen=True)
class Spelling:
    """What a format knows, as far as it is read here.

    ``attributes`` of elements by their tag, or by ``section/tag`` where sections mean different things by one tag;
    ``elements`` inside an element, and those of them that stand there ``once``.
    """

    attributes: Mapping[str, frozenset[str]]
    elements: Mapping[str, frozenset[str]]
    once: Mapping[str, frozenset[str]]


def words_of(lists: Mapping[str, str]) -> dict[str, frozenset[str]]:
    """Lists of words, each written as one text."""
    return {tag: frozenset(words.split()) for tag, words in lists.items()}


#: So much has a slip of the pen in common with what was meant (``mas``, ``dampng``, ``diagInertia``).
_ALIKE = 0.75


def check_spelling(elements: Iterator[tuple[str, Element]], spelling: Spelling, reader: Reader) -> None:
    """Complains about what looks like a slip of the pen, at its element; what looks like nothing known is left out.

    The latter may be of a later version.  What is read in other elements only is an error where it would be lost.
    ``elements`` are those that are read, each with the name of its section.
    """
    read = spelling.attributes.keys() | spelling.elements.keys()
    for section, element in elements:
        tag = element.tag
        known = spelling.attributes.get(f"{section}/{tag}", spelling.attributes.get(tag, frozenset()))
        for name in element.attributes if known else ():
            if name not in known and ":" not in name:
                _tell(f"attribute {ascii_safe(name)} of <{tag}>", name, known, element, reader)
        inside = spelling.elements.get(tag, frozenset())
        for child in element.children if tag in read else ():
            places = [f"<{place}>" for place, known in spelling.elements.items() if child.tag in known]
            if child.tag in read and places and child.tag not in inside:
                what = f"<{child.tag}> stands in <{tag}>, where it is not read"
                reader.error("misplaced-key", what, child, f"it belongs into {' or '.join(places)}")
            elif inside and child.tag not in inside and ":" not in child.tag:
                what = f"element <{ascii_safe(child.tag).strip(chr(39))}> in <{tag}>"
                _tell(what, child.tag, inside, child, reader)
        for child_tag in sorted(spelling.once.get(tag, frozenset())):
            for child in element.all(child_tag)[1:]:
                reader.error("repeated-key", f"a second <{child_tag}> in <{tag}>", child)


def _of_more_words(long: str, short: str) -> bool:
    """``gear_velocity`` is no slip of the pen for ``velocity``."""
    return set(long.split("_")) > set(short.split("_"))


def _tell(what: str, word: str, known: frozenset[str], element: Element, reader: Reader) -> None:
    meant = closest(word, sorted(known), _ALIKE)
    if meant is None or _of_more_words(word, meant) or _of_more_words(meant, word):
        reader.leave_out(f"unknown {what}")
    else:
        reader.error("unknown-key", f"unknown {what}", element, f"did you mean '{meant}'?")


# Numbers as they are printed in a file: exact decimals, and angles that are rounded parts of pi.


Texts = tuple[str, str, str]
NOWHERE: Texts = ("0", "0", "0")

#: What is left out where a mass comes without moments.
NO_TENSOR = "inertia that is not given (the link is a point mass)"

#: Angles printed with fewer digits are not taken for a rounded part of pi: 0.5 is no pi/6.
FEWEST_DIGITS = 4

#: A printed number beyond this power of ten is refused; what is below the last digit of a description is rounded.
_LARGEST_POWER = MAX_DIGITS - 1
_SMALLEST, _EXACTLY = Decimal(1).scaleb(-MAX_DIGITS), Context(prec=2 * MAX_DIGITS + 1)

#: What is longer than this many characters as a plain decimal is written with an exponent.
_PLAIN_POWER = 6


#: As XML Schema and C print one; Python would read ``1_0`` and digits of other scripts, too.
_PRINTED = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\Z", re.ASCII)


def decimal(text: str) -> Decimal | None:
    """The number that a text is, or None: infinities and monsters are none."""
    if not _PRINTED.match(text.strip()):
        return None
    try:
        value = Decimal(text.strip())
    except InvalidOperation:
        return None
    if not value.is_finite() or len(value.as_tuple().digits) > MAX_DIGITS:
        return None
    return value if value == 0 or value.adjusted() <= _LARGEST_POWER else None


def number(text: str) -> str:
    """The number as it is printed, in a form that descriptions accept; zero is 0."""
    value = Decimal(text)
    if int(value.as_tuple().exponent) < -MAX_DIGITS:
        value = value.quantize(_SMALLEST, context=_EXACTLY)
    if value == 0:
        return "0"
    return f"{value.normalize():f}" if abs(value.adjusted()) < _PLAIN_POWER else str(value.normalize())


def angle(text: str) -> str:
    """A multiple of pi/4 or pi/6, if ``text`` is one rounded to the digits that are printed; else the number.

    >>> angle("1.5708"), angle("-0.52359877559"), angle("0.5")
    ('pi/2', '-pi/6', '0.5')
    """
    value = Decimal(text)
    _, digits, exponent = value.as_tuple()
    assert isinstance(exponent, int)
    if len(digits) >= FEWEST_DIGITS:
        for part in (4, 6):
            turns = Fraction(round(float(value) / math.pi * part), part)
            if turns and abs(float(value) - float(turns) * math.pi) <= max(0.5 * 10.0**exponent, 1e-15):
                return multiple_of_pi(turns)
    return number(text)


def multiple_of_pi(turns: Fraction) -> str:
    """``-3*pi/4``."""
    up = {1: "pi", -1: "-pi"}.get(turns.numerator, f"{turns.numerator}*pi")
    return up if turns.denominator == 1 else f"{up}/{turns.denominator}"


def degrees(text: str) -> str:
    """An angle in degrees, exactly, in radians: a fraction of pi.

    >>> degrees("90"), degrees("-22.5"), degrees("0")
    ('pi/2', '-pi/8', '0')
    """
    turns = Fraction(Decimal(text)) / 180
    return multiple_of_pi(turns) if turns else "0"


def opposite(text: str) -> str:
    """The number of the other sign."""
    return text[1:] if text.startswith("-") else text if text == "0" else "-" + text


def is_zero(values: Texts) -> bool:
    """Whether three printed numbers are zero."""
    return all(Decimal(value) == 0 for value in values)


def numbers(values: Texts) -> Texts:
    first, second, third = map(number, values)
    return first, second, third


def is_of_a_body(xx: Fraction, xy: Fraction, xz: Fraction, yy: Fraction, yz: Fraction, zz: Fraction) -> bool:
    """Whether the second moments tr(J)/2 1 - J are positive semidefinite."""
    half = (xx + yy + zz) / 2
    return is_nonnegative(half - xx, -xy, -xz, half - yy, -yz, half - zz)


def is_nonnegative(xx: Fraction, xy: Fraction, xz: Fraction, yy: Fraction, yz: Fraction, zz: Fraction) -> bool:
    """Whether a symmetric matrix is positive semidefinite: all its principal minors are nonnegative."""
    return all(minor >= 0 for minor in principal_minors(((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))))


# XML as elements that know their place, read by expat; what could grow without bound is refused before it does.


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
            included = parsed(text, own)
            for item in own.items:
                complaints.error(item.code, f"in {ascii_safe(file)}: {item.message}", child.span)
            if included is not None:
                for element in included.walk():
                    element.span = child.span
                include(included, beside, complaints, seen)
                children += included.children
            continue
        include(child, beside, complaints, seen)
        children.append(child)
    root.children = children
