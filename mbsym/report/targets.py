"""One frozen ``Target`` per kind of file.

A target says which problems it shows and whether it is made from the straight-line program: unless the user names
problems, a run derives those that its formats show (``shown_by``), and nothing else.
"""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mbsym.problems import TITLES

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


#: How much a report for people writes out: ``compact`` tells long formulas through named intermediates.
DETAILS = COMPACT, FULL = "compact", "full"
#: How formulas may have their angles; where none is asked for, texts for people have the shorter form of each formula,
#: and those for programs products, one canonical form.
ANGLES = ("products", "sums", "shorter")


def always(analysis: Analysis, problems: Sequence[int]) -> bool:
    return True


@dataclass(frozen=True)
class Target:
    """``needs``: the problems whose results the file can hold (None: all); of these it shows those asked for.

    ``program``: it is made from the straight-line program, which is checked then.  ``companions`` are written beside
    it, as a header is, where they are ``applies``: a part of a report is not, without what it would tell.  ``remark``:
    what is to be told of a file that was made here, or "".
    """

    name: str
    filename: str
    needs: tuple[int, ...] | None
    title: str
    text: Callable[[Analysis, Sequence[int]], str | bytes]
    companions: tuple[Target, ...] = ()
    program: bool = False
    remark: Callable[[], str] | None = None
    applies: Callable[[Analysis, Sequence[int]], bool] = always

    @property
    def shows(self) -> tuple[int, ...]:
        """The problems whose results the file can hold."""
        from mbsym.analysis import ALL_PROBLEMS

        return ALL_PROBLEMS if self.needs is None else self.needs

    def render(self, analysis: Analysis, problems: Sequence[int]) -> str | bytes:
        """The file's whole text: the same bytes for the same description, whenever and wherever it is made.

        Of an FMU the bytes; these may depend on the compiler that is there.
        """
        return self.text(analysis, tuple(number for number in sorted(set(problems)) if number in self.shows))


# The writers are imported when they are used: each brings its own share of Jinja templates and printers.


def _latex(analysis: Analysis, problems: Sequence[int]) -> str:
    from mbsym.report.latex.report import render

    return render(analysis, problems)


def _appendix(analysis: Analysis, problems: Sequence[int]) -> str:
    from mbsym.report.latex.appendix import render

    return render(analysis, problems)


def _fragment(name: str, number: int | None, title: str) -> Target:
    """``fragments/NAME.tex``: of a problem, or of what is told besides."""

    def text(analysis: Analysis, problems: Sequence[int]) -> str:
        from mbsym.report.latex.appendix import fragment

        return fragment(analysis, problems, name, title, number)

    def wanted(analysis: Analysis, problems: Sequence[int]) -> bool:
        if name in ("claims", "checks"):
            return bool(getattr(analysis, name))
        if name == "diagram":
            return bool(analysis.system.bodies)
        return number is None or number in problems

    return Target(name, f"fragments/{name}.tex", None, f"a part of the appendix: {title}", text, applies=wanted)


def _wolfram(analysis: Analysis, problems: Sequence[int]) -> str:
    from mbsym.report.wolfram_report import render

    return render(analysis, problems)


def _python(analysis: Analysis, problems: Sequence[int]) -> str:
    from mbsym.report.code.python_module import render

    return render(analysis, problems)


def _c(analysis: Analysis, problems: Sequence[int]) -> str:
    from mbsym.report.code.c_source import render

    return render(analysis, problems)


def _c_header(analysis: Analysis, problems: Sequence[int]) -> str:
    from mbsym.report.code.c_source import header

    return header(analysis, problems)


def _html(analysis: Analysis, problems: Sequence[int]) -> str:
    from mbsym.report.html.report import render

    return render(analysis, problems)


def _json(analysis: Analysis, problems: Sequence[int]) -> str:
    from mbsym.report.results_json import render

    return render(analysis, problems)


_IN_DOCUMENTS = (
    Target("appendix", "appendix.tex", None, "an appendix for anyone's document", _appendix),
    _fragment("system", None, "the system"),
    _fragment("diagram", None, "interconnection of the bodies"),
    _fragment("conventions", None, "conventions"),
    *(_fragment(name, number, title) for number, (name, title) in enumerate(TITLES.items(), start=1)),
    _fragment("claims", None, "claims"),
    _fragment("checks", None, "self-check"),
)
_HEADER = Target("header", "model.h", (), "declarations of the C source", _c_header)

TARGETS = {
    target.name: target
    for target in (
        Target(
            "latex", "report.tex", None, "a report for pdflatex, with appendix.tex and fragments", _latex, _IN_DOCUMENTS
        ),
        Target("wolfram", "report.wl", None, "definitions in the Wolfram Language", _wolfram),
        Target(
            "python",
            "model.py",
            (5, 7, 9, 10, 11, 12),
            "a numpy module of the equations, from the straight-line program",
            _python,
            program=True,
        ),
        Target("c", "model.c", (), "C99 source of the equations, with model.h", _c, (_HEADER,), program=True),
        Target("html", "report.html", None, "a page for browsers, in one file", _html),
        Target("json", "results.json", None, "every result as text in Python syntax", _json),
    )
}


def _exported(language: str) -> Callable[[Analysis, Sequence[int]], str]:
    def text(analysis: Analysis, problems: Sequence[int]) -> str:
        from mbsym.report.exports.languages import render

        return render(language, analysis, problems)

    return text


def _modelica(analysis: Analysis, problems: Sequence[int]) -> str:
    from mbsym.report.exports.modelica import render

    return render(analysis, problems)


def _fmu(version: int) -> Callable[[Analysis, Sequence[int]], bytes]:
    def content(analysis: Analysis, problems: Sequence[int]) -> bytes:
        from mbsym.report.exports.fmu import render

        return render(analysis, problems, version)

    return content


def _fmu_remark() -> str:
    from mbsym.report.exports.fmu import remark

    return remark()


#: What other programs read: made only where it is named.
EXPORTS = {
    target.name: target
    for target in (
        Target("casadi", "model_casadi.py", (7,), "functions for CasADi", _exported("casadi"), program=True),
        Target("jax", "model_jax.py", (7,), "functions for JAX", _exported("jax"), program=True),
        Target("octave", "model.m", (7,), "functions for MATLAB and Octave", _exported("octave"), program=True),
        Target("julia", "model.jl", (7,), "a module for Julia", _exported("julia"), program=True),
        Target("modelica", "model.mo", (7,), "a model in Modelica", _modelica, program=True),
        Target("fmu2", "model-fmi2.fmu", (), "an FMU for model exchange, FMI 2.0", _fmu(2), (), True, _fmu_remark),
        Target("fmu3", "model-fmi3.fmu", (), "an FMU for model exchange, FMI 3.0", _fmu(3), (), True, _fmu_remark),
    )
}

#: Everything that ``--format`` can name; ``all`` means TARGETS.
FORMATS: Mapping[str, Target] = ChainMap(EXPORTS, TARGETS)


def shown_by(formats: Iterable[str]) -> tuple[int, ...]:
    """The problems that the files of some formats can show, without those that are derived only where named."""
    from mbsym.analysis import USUAL_PROBLEMS

    shown = {number for name in formats for number in FORMATS[name].shows}
    return tuple(number for number in USUAL_PROBLEMS if number in shown)
