"""What a text says of itself: whether it is a description, and in which spelling.

Asked of every file in a folder, also of those that are not read; so this imports no reader.
"""

from __future__ import annotations

import re
from pathlib import Path

from mbsym.model.system import LANGUAGES
from mbsym.source.labels import HEADER, SECTIONS
from mbsym.source.placed import MAX_TEXT, normalised
from mbsym.source.text_lines import HEADING, label_of, lines_of, word_of

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
    found = _LANGUAGE.search(normalised(text))
    return found[1] if found and found[1] in LANGUAGES else ""


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
