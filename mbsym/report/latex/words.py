"""Words in LaTeX: plain text escaped, sentences, lines that are not too long."""

from __future__ import annotations

import re

from mbsym.model.system import System

#: Longer lines of the file are broken: TeX reads whole lines into a buffer.
LINE = 400
RELATIONS = {"!=": r"\neq", ">=": r"\geq", "<=": r"\leq", "+-": r"\pm", ":": r"\colon\quad"}

_SPECIAL = {
    "\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "$": r"\$", "&": r"\&", "#": r"\#", "%": r"\%", "_": r"\_",
    "^": r"\^{}", "~": r"\~{}", "<": r"\textless{}", ">": r"\textgreater{}", "|": r"\textbar{}", '"': "''",
}  # fmt: skip


def escaped(words: str) -> str:
    """Plain text; characters that plain pdflatex cannot set become question marks."""
    plain = "".join(_SPECIAL.get(c, c if _can_be_set(c) else "?") for c in " ".join(words.split()))
    return plain.replace("--", "-{}-").replace("\u2014", "---").replace("\u2013", "--")


def _can_be_set(character: str) -> bool:
    """Whether inputenc knows it for Latin or Cyrillic letters."""
    return character < "\u0100" or "\u0410" <= character <= "\u044f" or character in "\u0401\u0451\u2013\u2014"


def broken(line: str) -> str:
    """A line of the file as several, where it is long: to TeX the end of a line is a space."""
    if len(line) <= LINE or line.startswith("%"):
        return line
    pieces: list[str] = []
    size = LINE + 1
    for word in line.split(" "):
        # A backslash before a space belongs to it, and no line may be empty: that would end the paragraph.
        if size + len(word) > LINE and word.strip() and not (pieces and pieces[-1].endswith("\\")):
            pieces.append(word)
            size = len(word)
        elif pieces:
            pieces[-1] += " " + word
            size += 1 + len(word)
    return "\n".join(pieces)


def spared(text: str) -> str:
    """One empty line where there are several."""
    return re.sub(r"\n{3,}", "\n\n", text)


def is_cyrillic(system: System) -> bool:
    texts = [system.name, system.description, system.source, *(item.meaning for item in system.parameters)]
    texts += [item.meaning for item in system.prescribed] + [body.name for body in system.bodies]
    texts += [claim.place for claim in system.claims]
    return any("\u0400" <= c <= "\u045f" for text in texts for c in text)
