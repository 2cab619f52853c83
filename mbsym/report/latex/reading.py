"""Reading LaTeX again: brackets and environments close, every command is known, no label is set twice.

``report.tex`` is a whole document.  An ``appendix.tex`` and what stands in ``fragments`` go into somebody else's: they
must not define anything, load anything, or end with a group open.
"""

from __future__ import annotations

import re
from collections.abc import Container
from itertools import takewhile

_LATEX = re.compile(
    r"""\\(?:begin|end)\s*\{[^{}]*\}|\\(?:left|right)(?![a-zA-Z])\s*(?:\\[{}|]|.)|\\verb(?P<mark>[^a-zA-Z]).*?(?P=mark)|\\[^a-zA-Z]|\\[a-zA-Z]+|%[^\n]*|\$\$?|[{}]""",
    re.DOTALL,
)

_GREEK = """alpha beta gamma delta epsilon varepsilon zeta eta theta vartheta iota kappa lambda mu nu xi pi varpi rho
    varrho sigma varsigma tau upsilon phi varphi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Upsilon Phi Psi
    Omega"""
_MATHEMATICS = """frac tfrac dfrac sqrt sum cdot times pm mp neq ne geq leq ge le to sin cos tan exp ln log arctan sinh
    cosh tanh det max min operatorname text mathrm mathit mathtt mathbf mathsf mathcal mathbb boldsymbol dot ddot hat
    bar tilde vec overline widehat widetilde prime ell hbar partial infty star ast circ dagger nabla bigl bigr Bigl Bigr
    biggl biggr colon quad qquad displaystyle dots ldots cdots leftarrow rightarrow Leftrightarrow in equiv approx sim
    lvert rvert lVert rVert cdotp"""
_WORDS = """textbf textit texttt emph textbackslash textless textgreater textbar mbox item par noindent nopagebreak
    nobreak hfill hfil hskip hbox vspace hspace smallskip medskip bigskip small scriptsize footnotesize normalsize
    raggedright raggedbottom centering clearpage ref eqref label cite section subsection subsubsection paragraph
    addcontentsline caption hline endhead multicolumn arraybackslash columnwidth textwidth verb allowbreak penalty
    begingroup endgroup binoppenalty relpenalty linepenalty lineskiplimit lineskip hangindent hangafter parfillskip
    refstepcounter theequation emergencystretch setlength itemsep par newline toprule midrule bottomrule"""
_PICTURES = "node draw includegraphics parskip"
_DOCUMENT = """documentclass usepackage IfFileExists parindent medmuskip setcounter newcommand renewcommand
    makeatletter makeatother parbox title author date maketitle contentsifneeded tableofcontents bibitem refname
    longformula LARGE
    if ifnum expandafter csname endcsname edef pages pageof newwrite tf immediate openout jobname relax else fi
    detokenize thepage ps let thispagestyle pagestyle"""

_COMMANDS = frozenset(f"{_GREEK} {_MATHEMATICS} {_WORDS} {_PICTURES}".split())
_ONLY_IN_DOCUMENTS = frozenset(_DOCUMENT.split())


def is_part(filename: str) -> bool:
    """Whether the file goes into somebody else's document."""
    return filename.startswith("fragments/") or filename.rpartition("/")[2].startswith("appendix")


def read_latex(filename: str, text: str) -> None:
    """Raises SyntaxError, with the line, where TeX or the document around would not take the text."""
    _read(text, _COMMANDS if is_part(filename) else _COMMANDS | _ONLY_IN_DOCUMENTS)
    _labels(text)


def _read(text: str, known: Container[str]) -> None:
    opened: list[tuple[int, str]] = []
    kinds: dict[str, tuple[str, str]] = {}  # a file has few different tokens
    for match in _LATEX.finditer(text):
        token = match[0]
        kind, what = kinds.get(token) or kinds.setdefault(token, _kind(token, known))
        if not kind:
            continue
        place = match.start()
        if kind == "unknown":
            raise SyntaxError(f"the command {token!r} is not known", ("", _line(text, place), 0, None))
        if kind == "opens":
            opened.append((place, what))
        elif kind == "closes":
            if not opened or opened.pop()[1] != what:
                raise SyntaxError(f"{token!r} closes nothing", ("", _line(text, place), 0, None))
        elif opened and opened[-1][1] == what:
            opened.pop()
        elif kind == "ends" or _in_mathematics(opened):
            raise SyntaxError(f"{token!r} closes nothing", ("", _line(text, place), 0, None))
        else:
            opened.append((place, token))
    if opened:
        place, what = opened[-1]
        raise SyntaxError(f"{what!r} is never closed", ("", _line(text, place), 0, None))


def _kind(token: str, known: Container[str]) -> tuple[str, str]:
    """What a token does, and to what: nothing, it ``opens`` or ``closes`` a group, ``toggles`` or ``ends`` mathematics.

    Or it is an ``unknown`` command.
    """
    short = token.replace(" ", "") if token.startswith(("\\begin", "\\end")) else token
    name = re.fullmatch(r"\\([a-zA-Z]+)", short)
    if name is not None and name[1] not in known:
        return "unknown", ""
    if short in ("{", "\\begingroup") or short.startswith("\\begin{") or re.match(r"\\left(?![a-zA-Z])", short):
        return "opens", _opener(short)
    if short in ("}", "\\endgroup") or short.startswith("\\end{") or re.match(r"\\right(?![a-zA-Z])", short):
        return "closes", _opener(short)
    if short in ("$", "$$", "\\[", "\\("):
        return "toggles", short
    return ("ends", {"\\]": "\\[", "\\)": "\\("}[short]) if short in ("\\]", "\\)") else ("", "")


def _line(text: str, place: int) -> int:
    return text.count("\n", 0, place) + 1


def _in_mathematics(opened: list[tuple[int, str]]) -> bool:
    """Whether mathematics has begun since the last brace, in which there may be text with mathematics of its own."""
    since = list(takewhile(lambda item: item[1] != "{", reversed(opened)))
    return any(item in ("$", "$$", "\\[", "\\(") for _, item in since)


def _opener(token: str) -> str:
    if token in "{}":
        return "{"
    if token.startswith(("\\left", "\\right")):
        return "\\left"
    return token.replace("\\end", "\\begin")


_LABEL = re.compile(r"\\(?:(label|ref|eqref)\{([^{}#]*)\}|longformula\[([^\]]*)\])|%[^\n]*")


def _labels(text: str) -> None:
    """Each is set once, and whatever is referred to is there."""
    found: set[str] = set()
    wanted: dict[str, int] = {}  # with the place where it is referred to first
    for match in _LABEL.finditer(text):
        name, place = match[2] or match[3], match.start()
        if name is None:
            continue
        if match[1] in ("ref", "eqref"):
            wanted.setdefault(name, place)
        elif name in found:
            raise SyntaxError(f"the label {name!r} is set a second time", ("", _line(text, place), 0, None))
        else:
            found.add(name)
    for name, place in wanted.items():
        if name not in found:
            raise SyntaxError(f"nothing has the label {name!r}", ("", _line(text, place), 0, None))
