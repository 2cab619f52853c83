"""Reading LaTeX again: brackets and environments close, every command is known, no label is set twice.

``report.tex`` is a whole document.  An ``appendix.tex`` and what stands in ``fragments`` go into somebody else's: they
must not define anything, load anything, or end with a group open.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from itertools import takewhile

_LATEX = re.compile(
    r"""\\(?:begin|end)\s*\{[^{}]*\}|\\(?:left|right)\s*(?:\\[{}|]|.)|\\verb(?P<mark>[^a-zA-Z]).*?(?P=mark)|\\[^a-zA-Z]|\\[a-zA-Z]+|%[^\n]*|\$\$?|[{}]""",
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
    refstepcounter theequation emergencystretch setlength itemsep par newline"""
_PICTURES = "node draw includegraphics parskip"
_DOCUMENT = """documentclass usepackage IfFileExists parindent medmuskip setcounter newcommand renewcommand
    makeatletter makeatother parbox title author date maketitle tableofcontents bibitem refname longformula
    if relax else fi detokenize thepage ps let thispagestyle pagestyle"""

_COMMANDS = frozenset(f"{_GREEK} {_MATHEMATICS} {_WORDS} {_PICTURES}".split())
_ONLY_IN_DOCUMENTS = frozenset(_DOCUMENT.split())


def is_part(filename: str) -> bool:
    """Whether the file goes into somebody else's document."""
    return filename.startswith("fragments/") or filename.rpartition("/")[2].startswith("appendix")


def read_latex(filename: str, text: str) -> None:
    """Raises SyntaxError, with the line, where TeX or the document around would not take the text."""
    _read(text, _COMMANDS if is_part(filename) else _COMMANDS | _ONLY_IN_DOCUMENTS)
    _labels(text)


def _read(text: str, known: Iterable[str]) -> None:
    opened: list[tuple[int, str]] = []
    for line, token in _tokens(text):
        name = re.fullmatch(r"\\([a-zA-Z]+)", token)
        if name is not None and name[1] not in known and not re.fullmatch(r"\\(left|right)[a-zA-Z]*", token):
            raise SyntaxError(f"the command {token!r} is not known", ("", line, 0, None))
        if token in ("{", "\\begingroup") or token.startswith(("\\begin{", "\\left")):
            if re.fullmatch(r"\\left[a-zA-Z]+", token) is None:
                opened.append((line, _opener(token)))
        elif token in ("}", "\\endgroup") or token.startswith(("\\end{", "\\right")):
            if re.fullmatch(r"\\right[a-zA-Z]+", token) is None:
                wanted = _opener(token)
                if not opened or opened[-1][1] != wanted:
                    raise SyntaxError(f"{token!r} closes nothing", ("", line, 0, None))
                opened.pop()
        elif token in ("$", "$$", "\\[", "\\(", "\\]", "\\)"):
            opening = {"\\]": "\\[", "\\)": "\\("}.get(token, token)
            if opened and opened[-1][1] == opening:
                opened.pop()
            elif token in ("\\]", "\\)") or _in_mathematics(opened):
                raise SyntaxError(f"{token!r} closes nothing", ("", line, 0, None))
            else:
                opened.append((line, token))
    if opened:
        raise SyntaxError(f"{opened[-1][1]!r} is never closed", ("", opened[-1][0], 0, None))


def _tokens(text: str) -> Iterator[tuple[int, str]]:
    line, place = 1, 0
    for match in _LATEX.finditer(text):
        line += text.count("\n", place, match.start())
        place = match.start()
        token = match[0]
        yield line, token.replace(" ", "") if token.startswith(("\\begin", "\\end")) else token


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


_LABEL = re.compile(r"\\(label|ref|eqref)\{([^{}#]*)\}|%[^\n]*")


def _labels(text: str) -> None:
    """Each is set once, and whatever is referred to is there."""
    found: dict[str, int] = {}
    wanted: dict[str, int] = {}
    for match in _LABEL.finditer(text):
        if match[1] is None:
            continue
        line = text.count("\n", 0, match.start()) + 1
        if match[1] != "label":
            wanted.setdefault(match[2], line)
        elif match[2] in found:
            raise SyntaxError(f"the label {match[2]!r} is set a second time", ("", line, 0, None))
        else:
            found[match[2]] = line
    for name, line in wanted.items():
        if name not in found:
            raise SyntaxError(f"nothing has the label {name!r}", ("", line, 0, None))
