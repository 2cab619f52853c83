"""What became of the claims, in words and by what they differ: for the terminal, results.json and the appendix."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

from mbsym.expressions.message import worded
from mbsym.formulas.formula import Formula
from mbsym.model.system import System
from mbsym.problems.checks import EXACT, FAILED, NUMERICAL
from mbsym.problems.claims import ClaimResult, Outcome, Part
from mbsym.problems.claims.counterexample import THE_MOTION, Counterexample
from mbsym.problems.claims.result import ENTRY
from mbsym.problems.stability.problem import Stability
from mbsym.problems.stability.verdict import Verdict
from mbsym.problems.stability.words import Word
from mbsym.report.content import Inline, Name, Number, Phrase, Relation, Said, Strong, joined, say
from mbsym.report.plain_writer import Writer

#: Differences longer than this are counted, not printed.
LONGEST_DIFFERENCE = 400

HELD, REFUTED, OPEN = "held", "refuted", "undecided"


@dataclass(frozen=True)
class ClaimLine:
    """One claim: its place, what it is about, the outcome in a few words, and the lines that say by what it differs.

    ``said`` is the outcome as reports say it, ``about`` the title with its formulas as mathematics.
    """

    place: str
    title: str
    outcome: str
    word: str
    lines: tuple[str, ...] = ()
    said: tuple[Inline, ...] = ()
    about: Said = Said("")


def claim_line(result: ClaimResult) -> ClaimLine:
    """The outcome in words; ``word`` is held, refuted or undecided."""
    word = HELD if result.holds else REFUTED if result.refuted else OPEN
    said = tuple(_outcome(result))
    outcome = "".join(map(Writer().inline, said))
    claim = result.claim
    about: Said = worded(result.title)
    if claim.right is not None:
        about = say(about.text, **{**about.gaps, "that": Relation(claim.equals, claim.relation, claim.right)})
    return ClaimLine(claim.place, result.title, outcome, word, tuple(_differences(result)), said, about)


def _outcome(result: ClaimResult) -> Iterator[Inline]:
    factor = None if result.factor is None else _shown(result.factor)
    if factor is not None and result.outcome == Outcome.SCALED:
        yield say("differs by the factor [[factor]]", factor=factor)
    else:
        yield worded(result.outcome)
        yield from (" ", worded(result.where)) if result.where else ()
        if factor is not None and result.outcome == Outcome.FACTOR:
            yield from (": ", say("claimed = [[factor]] times derived", factor=factor))
        elif factor is not None:
            yield from (" (", say("compared with [[factor]] times derived", factor=factor), ")")
    if result.value and result.holds:
        yield f" ({result.value})"
    elif result.value:
        claimed = result.claim.printed or result.claim.equals
        yield from (": ", say("claimed [[claimed]], derived [[value]]", claimed=claimed, value=result.value))
    if result.digits is not None and result.digits != result.printed_digits:
        right, printed = str(result.digits), str(result.printed_digits)
        yield from (", ", say("[[right]] of [[printed]] digits right", right=right, printed=printed))
    if result.remark and (result.outcome in (Outcome.UNDECIDED, Outcome.DIFFERS) or not result.parts):
        yield ", " if result.outcome == Outcome.FACTOR else ": "
        yield remarks(result)


def remarks(result: ClaimResult) -> Inline:
    """What else there is to say, sentence by sentence."""
    return worded(result.remark)


def together(lines: Iterable[ClaimLine]) -> Iterator[list[ClaimLine]]:
    """Neighbours from one place that hold in the same way, and by themselves those that are to be told one by one."""
    for _, group in groupby(lines, lambda line: (line.word == HELD and line.place, line.outcome, line.lines)):
        claim_lines = list(group)
        if claim_lines[0].word == HELD and claim_lines[0].place:
            yield claim_lines
        else:
            yield from ([line] for line in claim_lines)


def names_in(claims: Iterable[ClaimResult], system: System) -> tuple[str, ...]:
    """What formulas of claims hold besides the names of the system."""
    variables = [claim.claim.variable for claim in claims if claim.claim.variable]
    return (*(item.name for item in system.abbreviations), *variables)


def titles(lines: Iterable[ClaimLine]) -> Inline:
    """What several claims are about: ``mass matrix [theta, theta], [theta, delta]; angular velocity of A [1]``."""
    entries: dict[str, list[Inline]] = {}
    stems: dict[str, Inline] = {}
    for line in lines:
        is_entry = line.about.text == ENTRY
        stem: Said = line.about.gaps["title"] if is_entry else line.about
        key = str(stem) if is_entry else line.title
        stems[key] = stem
        entries.setdefault(key, []).extend([Phrase(("[", line.about.gaps["entry"], "]"))] if is_entry else ())
    listed = {key: (Phrase((" ", joined(indices, ", "))),) if indices else () for key, indices in entries.items()}
    return joined((Phrase((stem, *listed[key])) for key, stem in stems.items()), "; ")


def _differences(result: ClaimResult) -> Iterator[str]:
    for part in result.parts:
        yield f"{part_name(result, part)}{left_side(result)} = {_difference(part)}"
        for name, change in part.repairs:
            words, formula = repair(part, change)
            yield f"  right with {'this' if formula is None else _long(formula)} {words} {name}"
    if not result.parts and result.difference is not None:
        yield f"{left_side(result)} = {_long(result.difference)}"
    if result.counterexample is not None:
        yield Writer().said(counterexample(result.counterexample, "for example at [[at]]: [[shows]]"))


def counterexample(example: Counterexample, text: str = "For example at [[at]]: [[shows]].") -> Said:
    """``For example at A = 1, C = 3: C - (7*A) = -4, the motion is stable (Routh).``"""
    at = [Relation(Name(name), "=", Number(value)) for name, value in example.at]
    shows: list[Inline] = [
        Relation(difference, "=", Number(value))
        for difference, (_, value) in zip(example.differences, example.shows, strict=False)
    ]
    shows += [
        say("the motion is [[verdict]]", verdict=worded(value)) if what == THE_MOTION else f"{what} = {value}"
        for what, value in example.shows[len(shows) :]
    ]
    return say(text, at=at, shows=shows)


def left_side(result: ClaimResult) -> str:
    """What ``difference`` is."""
    if result.claim.kind == "first integral":
        return "dI/dt on the equations of motion"
    return "claimed - derived" if result.factor is None else "claimed - factor*derived"


def repair(part: Part, change: Formula) -> tuple[str, Formula | None]:
    """``added to`` or ``taken from`` an abbreviation, and what; None where it is the difference of the part itself."""
    if change == part.difference:
        return "added to", None
    if (change.polynomial + part.difference.polynomial).is_zero():
        return "taken from", None
    return "added to", change


def part_name(result: ClaimResult, part: Part) -> str:
    """Which products of velocities, or which power, a part of a difference belongs to."""
    if part.power is not None:
        return f"at {result.claim.variable}**{part.power}: " if part.power else "without the variable: "
    return "" if part.factor == 1 else f"at {part.factor}: "


def _difference(part: Part) -> str:
    return _long(part.difference) + (f" = {part.same_as}" if part.same_as else "")


def _long(value: Formula) -> str:
    return Writer().inline(_shown(value))


def _shown(value: Formula) -> Formula | Said:
    """A formula in a line of text, or its length."""
    short = len(str(value)) <= LONGEST_DIFFERENCE
    return value if short else say("([[count]] terms; see the reports)", count=str(value.terms))


# Verdicts and outcomes as reports say them.


_GOOD = {*(word for word in Word if word.stable), EXACT, NUMERICAL, HELD}
_BAD = {Word.UNSTABLE, Word.UNSTABLE_BUT_BORDERS, FAILED, REFUTED}


def grade(word: str) -> str:
    """good, bad or open: how a verdict or an outcome is coloured; the word itself says it."""
    return "good" if word in _GOOD else "bad" if word in _BAD else "open"


def concluded(word: Word, theorems: Sequence[str], key: str = "") -> tuple[Inline, ...]:
    """``stable (Routh)``."""
    return Strong(worded(word), grade(word), key), *_by(theorems)


def where(word: Word, theorems: Sequence[str]) -> tuple[Inline, ...]:
    """The same of what holds under conditions: it is neither good nor bad."""
    return worded(word), *_by(theorems)


def _by(theorems: Sequence[str]) -> tuple[Inline, ...]:
    names = [part for name in theorems for part in (", ", worded(name))][1:]
    return (" (", *names, ")") if names else ()


def verdict(conclusion: Verdict, key: str = "") -> tuple[Inline, ...]:
    """Its word, with its theorems."""
    return concluded(conclusion.word, conclusion.theorems, key)


def decided(stability: Stability) -> str:
    """How the verdict at given values was found, if it is one: irrational values have enclosures."""
    if stability.numerical is None or stability.numerical.word == Word.UNDECIDED:
        return ""
    return ", decided by rigorous enclosures" if stability.enclosed else ", decided exactly"
