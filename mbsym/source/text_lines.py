"""Lines of the editor's plain text: without comments, cut into label and value, labels in one spelling."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from itertools import islice
from pathlib import Path

from mbsym.expressions.parser import in_latin
from mbsym.expressions.place import Span
from mbsym.model.system import LANGUAGES
from mbsym.source.labels import FREE, HEADER, SECTIONS, SPELLINGS
from mbsym.source.placed import MAX_TEXT, Scalar, normalised

#: What begins a numbered block.
HEADING = re.compile(r"(body|load|claim|constraint) description\s*\(\s*([0-9]{1,6})\s*\)\s*\Z", re.IGNORECASE)


def lines_of(text: str) -> Iterator[Scalar]:
    """Lines that say something, without comments and surrounding blanks, each in its place."""
    for number, line in enumerate(text.split("\n"), start=1):
        whole = Scalar(line, Span(number, 1, max(1, len(line))))
        content = whole.part(0, _comment_start(line))
        if content.text:
            yield _in_latin(content)


#: Signs as they are printed: minus, three of products, two powers.
_SIGNS = {"\u2212": "-", "\u00d7": "*", "\u00b7": "*", "\u22c5": "*", "\u00b2": "**2", "\u00b3": "**3"}

#: Those, lowered digits, and Greek letters (those of mathematical alphabets, too) with the lowered digits behind them.
PRINTED = re.compile(
    f"[{''.join(_SIGNS)}]|[\u2080-\u2089]+|[\u0370-\u03ff\u1f00-\u1fff\U0001d6a8-\U0001d7cb][\u2080-\u2089]*"
)


def _in_latin(line: Scalar) -> Scalar:
    """Greek letters, lowered digits, printed signs as descriptions have them, outside of quotes and meanings: psi, -.

    Each letter of a name stands where the Greek one does.
    """
    label, _ = label_of(line)
    if PRINTED.search(line.text) is None or (label is not None and word_of(label.text) in FREE):
        return line
    text, columns, end = "", list[int](), 0
    for match in re.finditer(rf'"(?:[^"\\]|\\.)*"|meaning.*|{PRINTED.pattern}', line.text):
        named = (_SIGNS.get(match[0]) or in_latin(match[0])) if PRINTED.match(match[0]) else ""
        name = named if named.isalnum() or match[0] in _SIGNS else match[0]  # some letters have none
        text += line.text[end : match.start()] + name
        columns += range(end, match.start())
        one_by_one = len(name) == len(match[0])
        columns += range(match.start(), match.end()) if one_by_one else [match.start()] * len(name)
        end = match.end()
    columns += range(end, len(line.text) + 1)
    places = tuple(line.span.column + k for k in columns)
    return Scalar(text + line.text[end:], line.span, columns=places)


def _comment_start(line: str) -> int:
    """Where the comment begins: at a ``#`` outside of quotes."""
    quoted, escaped = False, False
    for position, character in enumerate(line):
        if escaped:
            escaped = False
        elif character == "\\" and quoted:
            escaped = True
        elif character == '"':
            quoted = not quoted
        elif character == "#" and not quoted:
            return position
    return len(line)


def label_of(line: Scalar) -> tuple[Scalar | None, Scalar]:
    """``label: value`` cut at its first colon or equals sign; no label where there is neither."""
    match = re.search(r"[:=]", line.text)
    if match is None:
        return None, line
    return line.part(0, match.start()), line.part(match.end(), len(line.text))


def spoken(line: Scalar, known: Collection[str]) -> tuple[Scalar, str, Scalar] | None:
    """A line that begins with a label, whether a colon follows or nothing does, as in a form: with the longest."""
    most = max(len(label.split()) for label in (*known, *SPELLINGS))
    words = re.finditer(r"\S+", line.text)
    for end in reversed([match.end() for match in islice(words, most + 1)]):  # a colon may stand alone
        word = word_of(line.text[:end].rstrip(":= \t"))
        if word in known:
            return line.part(0, end), word, line.part(end, len(line.text))
    return None


def label_in(part: Scalar) -> tuple[Scalar | None, Scalar]:
    """``key = value`` within a record; what stands in quotes has no key, whatever it holds."""
    return (None, part) if part.text.startswith('"') or "=" not in part.text else label_of(part)


def word_of(text: str) -> str:
    word = " ".join(text.lower().split())
    return SPELLINGS.get(word, word)


def key_of(label: Scalar, key: str) -> Scalar:
    """A key in place of the label that stands for it."""
    return Scalar(key, label.span, literal=False)


# What a text says of itself: whether it is a description, and in which spelling.
#
# Asked of every file in a folder, also of those that are not read; so this imports no reader.


#: Lines that can only be YAML (or JSON): keys that are no labels of the editor.
_MARKS = re.compile(r"""^[ \t{]*["']?(?:mbsym|bodies|linear system|loads)["']?[ \t]*:""", re.MULTILINE)
_FIRST = re.compile(r"""(?:[ \t]*(?:\#.*|---.*|%.*)?\n)*([ \t]*)(.?)""")
_LANGUAGE = re.compile(r"""^["']?[Ll]anguage["']?[ \t]*:[ \t]*["']?(\w+)""", re.MULTILINE)
_KEY = r"""["']?mbsym["']?[ \t]*:"""


def is_description(path: Path) -> bool:
    """Whether a file says of itself that it is a description: by the key ``mbsym``, or the labels of the editor.

    A list of bodies that are ``attached to`` others says so, too: it is not passed over for a misspelt first line.
    What is no plain file, as a pipe or a link to nothing, is none; what may not be read could be one.
    """
    try:
        if not path.is_file():
            return False
        with path.open("rb") as file:
            data = file.read(4 * MAX_TEXT)
    except PermissionError:
        return True
    except (OSError, ValueError):
        return False
    return b"\0" not in data and says_so(data.decode("utf-8", "replace"))


def language_of(text: str) -> str:
    """What a description, sound or not, says of the language of its reports; "" where it says nothing that is one."""
    match = _LANGUAGE.search(normalised(text))
    return match[1] if match and match[1] in LANGUAGES else ""


def says_so(text: str) -> bool:
    """Whether a text says of itself that it is a description."""
    text = normalised(text)
    return has_key(text) or has_bodies(text) or has_text_marks(text)


def is_text(text: str, filename: str) -> bool:
    """Whether it is the editor's, by the look of the text or by the ending of the name."""
    editor, other = has_text_marks(text), has_yaml_marks(text)
    if editor != other:
        return editor
    ending = filename.lower().rpartition(".")[2]
    return ending == "txt" or (ending not in ("yaml", "yml", "json") and looks_like_text(text))


def has_yaml_marks(text: str) -> bool:
    """Whether some line can only be YAML."""
    return bool(_MARKS.search(text))


def has_key(text: str) -> bool:
    """Whether ``mbsym`` is a key of the outermost mapping, as far as a look at the lines can tell."""
    first = _FIRST.match(text)
    assert first is not None  # it matches nothing, too
    before = r"[{,\s]" if first[2] == "{" else f"^{first[1]}"
    return bool(re.search(before + _KEY, text, re.MULTILINE))


def has_bodies(text: str) -> bool:
    """Whether bodies attached to each other stand there, as in a description whose first line was lost or misspelt."""
    return bool(re.search(r"^bodies\s*:", text, re.MULTILINE) and re.search(r"\battached to\s*:", text))


def has_text_marks(text: str) -> bool:
    """Whether some line can only be the editor's: its first label, or the heading of a body or a load."""
    labels = ((line, label_of(line)[0]) for line in lines_of(text))
    return any(
        HEADING.match(line.text) or (label is not None and word_of(label.text) == "mechanical system")
        for line, label in labels
    )


def looks_like_text(text: str) -> bool:
    """Whether the first line that says something is a label of the editor."""
    for line in lines_of(text):
        label = label_of(line)[0]
        word = word_of(label.text if label else line.text)
        return word in HEADER or word in SECTIONS or bool(HEADING.match(line.text))
    return False
