"""What became of the claims, in words and by what they differ: for the terminal, results.json and the appendix."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import groupby

from mbsym.expressions.tree import text
from mbsym.formulas.formula import Formula
from mbsym.problems.claims import DIFFERS, FACTOR, SCALED, UNDECIDED, ClaimResult, Part
from mbsym.problems.claims.counterexample import Counterexample

#: Differences longer than this are counted, not printed.
LONGEST_DIFFERENCE = 400

HELD, REFUTED, OPEN = "held", "refuted", "undecided"


@dataclass(frozen=True)
class ClaimLine:
    """One claim: its place, what it is about, the outcome in a few words, and the lines that say by what it differs."""

    place: str
    title: str
    outcome: str
    word: str
    lines: tuple[str, ...] = ()


def claim_line(result: ClaimResult) -> ClaimLine:
    """The outcome in words; ``word`` is held, refuted or undecided."""
    word = HELD if result.holds else REFUTED if result.refuted else OPEN
    outcome = result.outcome + (f" {result.where}" if result.where else "")
    if result.factor is not None and result.outcome == SCALED:
        outcome = f"differs by the factor {_long(result.factor)}"
    elif result.factor is not None and result.outcome == FACTOR:
        outcome += f": claimed = {_long(result.factor)} times derived"
    elif result.factor is not None:
        outcome += f" (compared with {_long(result.factor)} times derived)"
    if result.value:
        claimed = result.claim.printed or text(result.claim.equals)
        outcome += f" ({result.value})" if result.holds else f": claimed {claimed}, derived {result.value}"
    if result.digits is not None and result.digits != result.printed_digits:
        outcome += f", {result.digits} of {result.printed_digits} digits right"
    if result.outcome == UNDECIDED or (result.remark and (not result.parts or result.outcome == DIFFERS)):
        outcome += f"{', ' if result.outcome == FACTOR else ': '}{result.remark}" if result.remark else ""
    return ClaimLine(result.claim.place, result.title, outcome, word, tuple(_differences(result)))


def together(lines: Iterable[ClaimLine]) -> Iterator[list[ClaimLine]]:
    """Neighbours from one place that hold in the same way, and by themselves those that are to be told one by one."""
    for _, group in groupby(lines, lambda line: (line.word == HELD and line.place, line.outcome, line.lines)):
        found = list(group)
        if found[0].word == HELD and found[0].place:
            yield found
        else:
            yield from ([line] for line in found)


def titles(lines: Iterable[ClaimLine]) -> str:
    """What several claims are about: ``mass matrix [theta, theta], [theta, delta]; angular velocity of A [1]``."""
    stems: dict[str, list[str]] = {}
    for line in lines:
        stem, bracket, index = line.title.partition(" [")
        stems.setdefault(stem, []).extend([bracket.strip() + index] if bracket else [])
    return "; ".join(f"{stem} {', '.join(indices)}".strip() for stem, indices in stems.items())


def _differences(result: ClaimResult) -> Iterator[str]:
    for part in result.parts:
        yield f"{part_name(result, part)}{left_side(result)} = {_difference(part)}"
        for name, change in part.repairs:
            words, formula = repair(part, change)
            yield f"  right with {'this' if formula is None else _long(formula)} {words} {name}"
    if not result.parts and result.difference is not None:
        yield f"{left_side(result)} = {_long(result.difference)}"
    if result.counterexample is not None:
        yield counterexample(result.counterexample)


def counterexample(found: Counterexample) -> str:
    """``for example at A = 1, C = 3: C - (7*A) = -4, the motion is stable (Routh)``."""
    at = ", ".join(f"{name} = {value}" for name, value in found.at)
    shows = ", ".join(f"{what} {'is' if what == 'the motion' else '='} {value}" for what, value in found.shows)
    return f"for example at {at}: {shows}"


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
    written = str(value)
    return written if len(written) <= LONGEST_DIFFERENCE else f"({value.terms} terms; see the reports)"
