"""Labels of equations and sections, ``mbsym:NAME:eq:M``, one each, with the name of the system in it.

And where a text is to stand, with what follows from that: its width, its headings.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Collection
from enum import StrEnum

from mbsym.model.system import System
from mbsym.report.latex.formulas import NARROW, WIDEST

_LONGEST = 40


def slug(name: str) -> str:
    """A system's name in labels: small letters, digits and hyphens; a hash where nothing of it can stand there.

    A long one ends with a whole word.
    """
    plain = re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")
    if len(plain) > _LONGEST:
        plain = plain[: plain.rfind("-", 0, _LONGEST + 1)] if "-" in plain[: _LONGEST + 1] else plain[:_LONGEST]
    return plain or "system-" + hashlib.sha256(name.encode()).hexdigest()[:8]


def prefix_of(system: System) -> str:
    """What every label of a system begins with: its own label as it is but for what no label takes, else its name."""
    own = re.sub(r"[^A-Za-z0-9._+-]+", "-", system.label).strip("-")
    return f"mbsym:{own or slug(system.name)}:"


class Labels:
    """Hands out labels with one prefix, none of them twice."""

    def __init__(self, prefix: str) -> None:
        self.prefix = prefix
        self._taken: set[str] = set()
        self._within, self._count = "", 0

    def equation(self, key: str) -> str:
        return self._free(self.of(key))

    def of(self, key: str) -> str:
        """The label of the equation that has this key first."""
        return f"{self.prefix}eq:{key}"

    def begin(self, section: str) -> None:
        """Equations without a key are counted from here."""
        self._within, self._count = section, 0

    def next(self) -> str:
        """The label of an equation without a key."""
        self._count += 1
        return self.equation(f"{self._within}:{self._count}" if self._within else str(self._count))

    def section(self, key: str) -> str:
        return self._free(f"{self.prefix}sec:{key}" if key else f"{self.prefix}sec")

    def _free(self, label: str) -> str:
        free_label, count = label, 2
        while free_label in self._taken:
            free_label, count = f"{label}:{count}", count + 1
        self._taken.add(free_label)
        return free_label


_LABEL = re.compile(r"\\(label|ref|eqref|pageref)\{([^{}]*)\}")


def labels(text: str) -> list[str]:
    """Every label that a text sets, in order."""
    return [match[2] for match in _LABEL.finditer(text) if match[1] == "label"]


def with_prefix(text: str, old: str, new: str) -> str:
    """The text with labels, and references to them, that begin with ``new`` instead of ``old``."""
    return _LABEL.sub(
        lambda m: f"\\{m[1]}{{{new + m[2].removeprefix(old) if m[2].startswith(old) else m[2]}}}", text
    ).replace(f"every label begins with {old}", f"every label begins with {new}")


def free_prefix(prefix: str, taken: Collection[str]) -> str:
    """The prefix, or one like it that is not taken."""
    free, count = prefix, 2
    while free in taken:
        free, count = f"{prefix.rstrip(':')}-{count}:", count + 1
    return free


# Where a LaTeX text is to stand, and what follows from that: its width, its headings, what surrounds it.


class Form(StrEnum):
    """Where a text is to stand: by itself on a wide page, or as a whole or in pieces in somebody's narrow column."""

    REPORT = "report"
    APPENDIX = "appendix"
    FRAGMENT = "fragment"

    @property
    def widest(self) -> float:
        """The widest matrix, in ems."""
        return WIDEST if self is Form.REPORT else NARROW

    @property
    def picture(self) -> float:
        """The widest picture, in cm."""
        return 15.0 if self is Form.REPORT else 7.6


def heading(labels: Labels, form: Form, key: str, title: str) -> str:
    """The heading of a section; a fragment has none."""
    match form:
        case Form.REPORT:
            return f"\\section*{{{title}}}\\addcontentsline{{toc}}{{subsection}}{{{title}}}"
        case Form.APPENDIX:
            kind = "subsection" if key else "section"
            return f"\\{kind}{{{title}}}\\label{{{labels.section(key)}}}"
    return ""


def subheading(form: Form, title: str) -> str:
    """The heading of a part of a section."""
    if form is Form.REPORT:
        return f"\\subsection*{{{title}}}"
    return f"\\par\\medskip\\noindent\\textbf{{{title}}}\\par\\nopagebreak"


def set_apart(text: str) -> str:
    """What stands in anyone's document: paragraphs without indentation, and everything is as it was afterwards."""
    head = "".join(f"{line}\n" for line in text.split("\n") if line.startswith("%"))
    body = "\n".join(line for line in text.split("\n") if not line.startswith("%"))
    looks = r"\raggedright\raggedbottom\emergencystretch=3em \parskip=2pt plus 3pt"
    return f"{head}\\begingroup{looks}\n{body.strip()}\n\\par\\endgroup\n"
