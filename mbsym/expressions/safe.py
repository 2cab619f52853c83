"""Text of strangers, made safe to show: on a terminal, in a message, in a comment of a generated file.

Descriptions and file names may hold anything: escape sequences that move a cursor or set a window's title, marks that
reverse the direction of reading, characters of no width, halves of characters.  Python's ``isprintable`` is the line:
what it refuses (the categories control, format, surrogate, private use, unassigned, separators but the blank) is
written as an escape.
"""

from __future__ import annotations

#: A space at which no line ends, in what the terminal is told; it is printed as an ordinary one.
UNBROKEN = "\x1f"


def safe(text: str) -> str:
    """The text with every character that is not printable written as an escape, tabs and line ends as a blank."""
    text = text.translate(_BLANKS)
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text)


def quoted(text: str, most: int = 60) -> str:
    """A piece of a file for a message: safe, shortened, in quotes that do not occur in it."""
    short = text if len(text) <= most else text[: most - 3] + "..."
    mark = '"' if "'" in short else "'"
    return mark + "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in short) + mark


def hides(character: str) -> bool:
    """Whether a character may not stand in a description: YAML refuses it, breaks lines at it, or it hides what a line
    says (direction overrides, escapes).
    """
    if character.isprintable() or character in "\t\xa0\u3000":
        return False
    return character.isascii() or not character.isspace() or character in "\x85\u2028\u2029"


def encodable(json_text: str) -> str:
    """A text of JSON that UTF-8 can hold: halves of characters, as names of files have them that are no UTF-8, are
    written as JSON's escapes, so that whoever reads it has the same names.
    """
    if json_text.isascii():
        return json_text
    return "".join(f"\\u{ord(c):04x}" if "\ud800" <= c <= "\udfff" else c for c in json_text)


_BLANKS = {ord("\t"): " ", ord("\n"): " ", ord("\r"): " "}
