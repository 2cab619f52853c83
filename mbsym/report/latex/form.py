"""Where a LaTeX text is to stand, and what follows from that: its width, its headings, what surrounds it."""

from __future__ import annotations

from enum import StrEnum

from mbsym.report.latex.formulas import NARROW, WIDEST
from mbsym.report.latex.labels import Labels


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
