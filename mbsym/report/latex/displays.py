r"""From what the templates write to what stands in anyone's document: no macro, nothing wider than a narrow column.

The templates write ``\longformula[label]{...}``.  ``report.tex`` defines it; in an appendix and in fragments, which
define nothing, it is written out here: as an ``equation``, several short ones after each other as one ``align``, a
longer one as a ``multline`` whose lines end between terms, several equations as rows of one; words that do not fit
stand in front of it and behind it.  What does not fit so, a long bracket, is a paragraph of inline mathematics with a
number, which TeX breaks at the places that the formula allows.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import pairwise

from mbsym.report.latex.formulas import NARROW, width

#: So many equations are one ``align``.
MOST_ROWS = 6

#: The widest line in a narrow column, in ems: signs and brackets are counted here, which ``width`` does not.
LINE = NARROW + 2

_OPENING = r"{\par\raggedright\binoppenalty=10000 \relpenalty=10000 \lineskiplimit=1pt \lineskip=2pt"
_NUMBER = (
    r"\nobreak\hfill\penalty50\hskip1em\hbox{}\nobreak\hfill\hbox{(\theequation)}"
    r"\parfillskip=0pt\par}"
)

#: Words in a formula that are longer than this may be broken: they stand outside of it.
_SHORT_WORDS = 12


def written_out(text: str) -> str:
    r"""The text with every ``\longformula`` as plain LaTeX; its other mathematics may be broken after commas."""
    pieces: list[str] = []
    short: list[tuple[str, str]] = []
    last = 0
    for start, label, formula, end in long_formulas(text):
        between = text[last:start]
        if between.strip() or "\n\n" in between:
            pieces += [*_together(short), _loosened(between)]
            short = []
        elif pieces and not short:
            pieces.append("\n")
        lines = _lines(formula)
        if lines is not None and len(lines) == 1:
            if not _fits([*short, (lines[0], label)]):
                pieces += [*_together(short), "\n"]
                short = []
            short.append((lines[0], label))
        else:
            pieces += [*_together(short), "\n" if short else "", display(formula, label)]
            short = []
        last = end
    written = "".join([*pieces, *_together(short), _loosened(text[last:])])
    return _AFTER_WORDS.sub("\n", written)


#: An empty line in front of a display would begin a paragraph, and leave a line of it empty.
_AFTER_WORDS = re.compile(r"\n{2,}(?=\\begin\{(?:equation|align|multline)\})")


def _together(short: Sequence[tuple[str, str]]) -> Iterator[str]:
    """Equations that follow each other, below each other's first sign of relation."""
    if len(short) == 1:
        yield _environment("equation", short[0][0], short[0][1])
    elif short:
        rows = []
        for formula, label in short:
            left, right = _sides(formula)
            named = f" \\label{{{label}}}" if label else ""
            rows.append(f"{left} &{right}{named}")
        yield "\\begin{align}\n" + " \\\\\n".join(rows) + "\n\\end{align}"


def _fits(short: Sequence[tuple[str, str]]) -> bool:
    """Whether they may be one ``align``, which pages do not break."""
    sides = [_sides(formula) for formula, _ in short]
    return len(short) <= MOST_ROWS and sum(max(map(_width, side)) for side in zip(*sides, strict=True)) <= NARROW


def _sides(formula: str) -> tuple[str, str]:
    """What stands in front of the first sign of relation outside of braces, and the rest; all of it where none is."""
    depth = 0
    for match in _RELATION.finditer(formula):
        if match[0] in "{}":
            depth += 1 if match[0] == "{" else -1
        elif depth == 0 and not match[0].startswith("\\{") and not match[0].startswith("\\}"):
            return formula[: match.start()].rstrip(), formula[match.start() :].lstrip()
    return "", formula


_RELATION = re.compile(r"\\[{}]|[{}]|(?<= )(?:[=<>]|\\(?:geq|leq|neq|colon)\b)")


def _environment(kind: str, body: str, label: str) -> str:
    named = f"\\label{{{label}}}" if label else ""
    return f"\\begin{{{kind}}}{named}\n{body}\n\\end{{{kind}}}"


@lru_cache(maxsize=2)  # whoever learns that there are several asks again for them
def _lines(formula: str) -> tuple[str, ...] | None:
    """The lines that it takes in a narrow column, broken where TeX may break it; None where some would be too wide."""
    parts, penalties = _parts(formula)
    rows: list[str] = []
    for line in _broken(parts, penalties):
        if rows and _width(f"{rows[-1]} {line}") <= LINE:
            rows[-1] += f" {line}"
        else:
            rows.append(line)
    whole = all(_width(row) <= LINE and row.count("\\left") == row.count("\\right") for row in rows)
    return tuple(rows) if rows and whole else None


def _parts(formula: str) -> tuple[list[str], list[int]]:
    """What stands between the places where TeX may break it, and the penalties of these."""
    parts, penalties, place, depth = [], [], 0, 0
    for match in _BREAK.finditer(formula):
        if match[0] in "{}":
            depth += 1 if match[0] == "{" else -1
        elif depth == 0 and match[1] is not None:
            parts.append(_plain(formula[place : match.start()]))
            penalties.append(int(match[1]))
            place = match.end()
    return [*parts, _plain(formula[place:])], penalties


_BREAK = re.compile(r"\\[{}]|[{}]|\\penalty(\d+) ")


def _equalities(formula: str) -> list[str] | None:
    """Several equations as rows, a line each; None where it is one, or a line would be too wide."""
    rows = [""]
    for part in _parts(formula)[0]:
        rows[-1] = f"{rows[-1]} {part}".strip()
        if part.endswith(_NEXT):
            rows[-1] = rows[-1].removesuffix(_NEXT) + ","
            rows.append("")
    return rows if len(rows) > 1 and all(_width(row) <= LINE for row in rows) else None


#: What stands between equations that are listed.
_NEXT = ",\\quad"


def _broken(parts: Sequence[str], penalties: Sequence[int]) -> list[str]:
    """What is too wide is broken at the least of its penalties, then piece by piece."""
    whole = " ".join(filter(None, parts))
    if not penalties or _width(whole) <= LINE:
        return [whole] if whole else []
    least = min(penalties)
    places = [k + 1 for k, penalty in enumerate(penalties) if penalty == least]
    lines = []
    for start, end in pairwise([0, *places, len(parts)]):
        lines += _broken(parts[start:end], penalties[start : end - 1])
    return lines


def _plain(formula: str) -> str:
    """Without the places where TeX may break it."""
    return _SPACES.sub(" ", _BREAKS.sub(" ", formula)).strip()


_BREAKS = re.compile(r"\\penalty\d+ ?|\\allowbreak ?")
_SPACES = re.compile(r"(?<=[^\\]) {2,}")
_FRACTION = re.compile(r"\\frac\{((?:[^{}]|\{[^{}]*\})*)\}\{((?:[^{}]|\{[^{}]*\})*)\}")


def _width(formula: str) -> float:
    """In ems, roughly: letters as for matrices, and signs and brackets besides."""
    while (fraction := _FRACTION.search(formula)) is not None:  # as wide as the wider of its two parts
        formula = formula[: fraction.start()] + max(fraction[1], fraction[2], key=width) + formula[fraction.end() :]
    brackets = sum(map(formula.count, "(),[]"))
    return width(formula) + 1.3 * len(_SIGN.findall(formula)) + 0.4 * brackets


_SIGN = re.compile(r"[=<>]|\\(?:geq|leq|neq|colon|quad)\b")


def display(formula: str, label: str = "") -> str:
    """One numbered formula in lines that end between its terms, else as a paragraph; long words stand around it."""
    if (lines := _lines(formula)) is not None and len(lines) == 1:
        return _environment("equation", lines[0], label)
    before, formula, after = _between_words(formula)
    if (rows := _equalities(formula)) is not None:
        body = " \\\\\n".join(" &".join(_sides(row)) for row in rows)
        shown = _environment("equation", f"\\begin{{aligned}}\n{body}\n\\end{{aligned}}", label)
    elif (lines := _lines(formula) or _lines(loosened(formula))) is not None:
        shown = _environment("equation" if len(lines) == 1 else "multline", " \\\\\n".join(lines), label)
    else:
        named = f"\\label{{{label}}}" if label else ""
        shown = (
            f"{_OPENING}\n\\hangindent=2em \\hangafter=1 \\noindent\\refstepcounter{{equation}}{named}%\n"
            f"$\\displaystyle {_words_outside(loosened(formula))}$%\n{_NUMBER}"
        )
    return "\n".join(filter(None, (before, shown, after)))


def _between_words(formula: str) -> tuple[str, str, str]:
    r"""What stands in front of a formula, ``\text{...} \colon``, the formula, and the ``\text{(...)}`` behind it."""
    before, after = "", ""
    if formula.startswith(_WORDS):
        end = closing_brace(formula, len(_WORDS) - 1)
        if colon := _COLON.match(formula, end + 1):
            before, formula = f"{formula[len(_WORDS) : end]}:", formula[colon.end() :]
    while formula.endswith(")}") and (note := formula.rfind(_NOTE)) >= 0:
        end = closing_brace(formula, note + len(_NOTE) - 2)
        if end != len(formula) - 1:
            break
        after = f"{formula[note + len(_NOTE) - 1 : end]} {after}".strip()
        formula = formula[:note].rstrip()
    return before, formula, after


_WORDS = "\\text{"
_COLON = re.compile(r"\s*\\colon\\quad(?:\s|\\penalty\d+ )*")
_NOTE = "\\quad\\penalty0 \\text{("


def long_formulas(text: str) -> Iterator[tuple[int, str, str, int]]:
    """(start, label, formula, end) of each."""
    place = 0
    while (start := text.find("\\longformula", place)) >= 0:
        place = start + len("\\longformula")
        label = ""
        if text[place] == "[":
            closing = text.index("]", place)
            label, place = text[place + 1 : closing], closing + 1
        end = closing_brace(text, place)
        yield start, label, text[place + 1 : end], end + 1
        place = end + 1


def closing_brace(text: str, start: int) -> int:
    """Where the brace that opens at ``start`` closes.  Raises ValueError where it does not."""
    depth = 0
    for match in _BRACE.finditer(text, start):
        if match[0] in "{}":
            depth += 1 if match[0] == "{" else -1
            if depth == 0:
                return match.start()
    raise ValueError("a brace is never closed")


_BRACE = re.compile(r"\\.|[{}]", re.DOTALL)

#: Where a narrow column may break a formula if nothing better is left: at signs in brackets, between factors, at signs
#: in brackets that are no wider than ``SHORT``.
_PLACES = re.compile(r"\\[{}]|[{}()\[\]]|(?<=[^ ]) (?=[+-] )|(?<=[^ ]) (?=\\(?:sin|cos|exp|ln)\b|\\[bB]igl|\()")
_PENALTY = re.compile(r"\\penalty[0-9]+ ?\Z")
_AT_SIGNS, _BEFORE_BRACKETS, _BEFORE_FUNCTIONS, _IN_SHORT = 5000, 9000, 9200, 9500
#: In ems, and in characters of TeX.
SHORT, MOST_SHORT = 10.0, 200


def loosened(formula: str) -> str:
    """The formula with places at which it is broken rather than standing out into the margin."""
    pieces, place, depth, short = [], 0, 0, [False]
    for match in _PLACES.finditer(formula):
        if match[0] in "{}":
            depth += 1 if match[0] == "{" else -1
        elif match[0] in "([":
            short.append(_is_short(formula[match.end() : match.end() + MOST_SHORT]))
        elif match[0] in ")]":
            short = short[:-1] or [False]
        elif match[0] == " " and depth == 0 and not _PENALTY.search(formula, max(0, match.start() - 16), match.end()):
            sign, bracket = formula[match.end()] in "+-", formula.startswith(("(", "\\b", "\\B"), match.end())
            at_sign = _IN_SHORT if short[-1] else _AT_SIGNS
            penalty = at_sign if sign else _BEFORE_BRACKETS if bracket else _BEFORE_FUNCTIONS
            pieces += [formula[place : match.start()], f"\\penalty{penalty} "]
            place = match.start() + (0 if sign else 1)
    return "".join([*pieces, formula[place:]])


def _is_short(rest: str) -> bool:
    """Whether the bracket that is open in front of this closes soon."""
    depth = 1
    for match in re.finditer(r"[()\[\]]", rest):
        depth += 1 if match[0] in "([" else -1
        if depth == 0:
            return _width(rest[: match.start()]) <= SHORT
    return False


def _words_outside(formula: str) -> str:
    r"""Long ``\text{...}`` between the mathematics instead of in it, so that lines may end there."""
    pieces, place, depth = [], 0, 0
    for match in re.finditer(r"\\text\{|\\[{}]|[{}]", formula):
        if match.start() < place:
            continue
        if match[0] == "\\text{" and depth == 0:
            end = closing_brace(formula, match.end() - 1)
            words = formula[match.end() : end]
            if len(words) > _SHORT_WORDS:
                pieces += [formula[place : match.start()], f"$ {words} $\\displaystyle "]
                place = end + 1
                continue
        if match[0] in ("{", "\\text{"):
            depth += 1
        elif match[0] == "}":
            depth -= 1
    return "".join([*pieces, formula[place:]])


def _loosened(text: str) -> str:
    """Inline lists of formulas may be broken after their commas."""
    return re.sub(r",(\\[;,]) (?!\\allowbreak)", r",\1\\allowbreak ", text)
