"""What was found: the results of a run in a few lines."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from itertools import groupby
from typing import TYPE_CHECKING

from mbsym.model.system import System
from mbsym.problems.equilibrium import Equilibrium
from mbsym.problems.stability import Stability, SubsystemStability
from mbsym.problems.stability.word import Word
from mbsym.report.brief import self_check, worst
from mbsym.report.conditions import statements
from mbsym.report.content import (
    Block,
    Facts,
    Graded,
    Heading,
    Inline,
    Link,
    Name,
    Phrase,
    Relation,
    Said,
    Words,
    joined,
    named,
    say,
)
from mbsym.report.sections.canonical import TITLES
from mbsym.report.sections.equations import is_short, short_equations
from mbsym.report.words.claims import HELD, OPEN, REFUTED, claim_line, titles
from mbsym.report.words.verdicts import decided, grade, verdict

if TYPE_CHECKING:
    from mbsym.problems.constraints import Constraints
    from mbsym.report.results import Results

Fact = tuple[tuple[Inline, ...], tuple[Inline, ...]]


def content(results: Results) -> Iterator[Block]:
    """What reports say."""
    yield Heading("summary", Said("What was found"))
    yield finding(results)


def finding(results: Results) -> Facts:
    """What was found, which heads every report and is all that the terminal tells."""
    return Facts(tuple(_facts(results)))


def _facts(results: Results) -> Iterator[Fact]:
    system, found = results.system, results.found
    yield _size(system, found[3].constraints if 3 in found else None)
    if 2 in found and found[2].cyclic and not system.constraints:
        yield (Said("$L$ does not contain"),), (named(found[2].cyclic),)
    if 3 in found and (equations := short_equations(found[3], system)):
        written = [Relation(one, "=", 0) for one in equations]
        written += [Relation(Name(x, 1), "=", rate) for x, rate in getattr(found[3], "kinematic", ())]
        yield (Said("Equations of motion"),), (joined(written, ";  "),)
    if 4 in found:
        yield (Said("The unperturbed motion"),), _motion(found[4])
    if 6 in found:
        yield from _stability(found[6], results)
    if 7 in found:
        integrals = [part for one in found[7] for part in ("; ", Words(one.name), " (", Words(one.status), ")")]
        none = Said("none in closed form of the kinds that are looked for")
        yield (Said("First integrals"),), tuple(integrals[1:]) or (none,)
    claims = results.analysis.claims
    if claims:
        count = Counter(claim_line(one).word for one in claims)
        gravest = next(word for word in (REFUTED, OPEN, HELD) if count[word])
        said = say("all [[count]] hold", count=str(len(claims))) if len(claims) > 1 else Said("it holds")
        if gravest != HELD:
            text = "[[held]] hold, [[refuted]] do not, [[open]] undecided"
            said = say(text, held=str(count[HELD]), refuted=str(count[REFUTED]), open=str(count[OPEN]))
        yield (Said("Claims"),), (Link(Graded(said, grade(gravest)), "claims"),)
        for line in map(claim_line, claims):
            if line.word != HELD:
                place = (line.place, ", ") if line.place else ()
                about = (Said("Claim"), " ", *place, titles([line]))
                yield about, (Graded(Phrase(line.said), grade(line.word)),)
    for reason, several in groupby(results.failures.items(), key=lambda one: one[1].reason):
        numbers = [number for number, _ in several]
        named_ones = ", ".join(map(str, numbers))
        title = (
            say("Problem [[number]]", number=named_ones)
            if len(numbers) == 1
            else say("Problems [[numbers]]", numbers=named_ones)
        )
        hint = results.failures[numbers[0]].hint
        more = (" (", Words(hint), ")") if hint else ()
        yield (Link(title, f"problem-{numbers[0]}"),), (Said("no result"), ": ", Words(reason), *more)
    for form, failure in results.forms.forms.failures:
        yield (Said(TITLES[form]),), (Said("no result"), ": ", Words(failure.reason))
    checks = results.analysis.checks
    if checks:
        yield (Said("Self-check"),), (Link(Graded(self_check(checks), grade(worst(checks))), "checks"),)


def _size(system: System, tied: Constraints | None) -> Fact:
    freedom = Phrase((str(len(system.coordinates)), ": ", named(system.coordinates)))
    if system.linear:
        title = "State variables" if system.linear.of_first_order else "Degrees of freedom"
        return (Said(title),), (freedom, "; ", Said("given by its matrices"))
    bodies = str(len(system.bodies))
    if system.constraints:
        text = "[[bodies]]; coordinates: [[coordinates]]; constraints: [[constraints]]"
        said = say(
            text,
            bodies=bodies,
            coordinates=freedom,
            constraints=str(len(system.constraints) if tied is None else tied.velocity_rank),
        )
        if tied is not None:
            left = len(tied.coordinates) - tied.velocity_rank
            return (Said("Bodies and frames"),), (said, "; ", say("degrees of freedom: [[freedom]]", freedom=str(left)))
    else:
        said = say("[[bodies]]; degrees of freedom: [[freedom]]", bodies=bodies, freedom=freedom)
    return (Said("Bodies and frames"),), (said,)


def _motion(found: Equilibrium) -> tuple[Inline, ...]:
    if found.satisfied:
        return (Said("satisfies the equations of motion identically"),)
    if found.impossible:
        return (Graded(Said("does not satisfy the equations of motion"), "bad"),)
    text = "satisfies the equations of motion under conditions; their number: [[count]]"
    return (Link(say(text, count=str(len(found.conditions))), "problem-4"),)


def _stability(found: Stability, results: Results) -> Iterator[Fact]:
    """The verdicts: that on the whole first."""
    several, presumed = len(found.subsystems) > 1, results.presumed
    cases = ("; ", Link(Said("see problem 6 of the report"), "problem-6"))
    names = named(found.subsystems[0].coordinates)
    whole = (Said("Stability of the whole system"),) if several else (Said("Stability"), ", ", names)
    depends = found.verdict.word is Word.DEPENDS
    yield (
        (*whole, *presumed),
        (
            *verdict(found.verdict, "verdict"),
            *(cases if depends else ()),
            *(() if several else _conditions(found.subsystems[0], results.variable)),
        ),
    )
    for part in found.subsystems if several else ():
        others = (", ", Said("while the others keep to the unperturbed motion"))
        said = (*verdict(part.theory.verdict), *others, *_conditions(part, results.variable))
        yield (Said("Stability"), ", ", named(part.coordinates), *presumed), said
    if found.numerical is not None:
        said = verdict(found.numerical, "verdict-at-values")
        if found.numerical.word is Word.UNDECIDED and found.numerical.explanation:
            said = (*said, ": ", Words(found.numerical.explanation))
        yield (Said("At the given values of the parameters"), Words(decided(found))), said


def _conditions(part: SubsystemStability, variable: str) -> Iterator[Inline]:
    """The conditions that a verdict depends on, where they are short, else their number."""
    if part.theory.verdict.word not in (Word.DEPENDS, Word.UNSTABLE_BUT_BORDERS):
        return
    items = list(statements(part.ring, part.theory.requirements))
    if not items or any(one.never is not None for one in items):
        return
    yield from ("; ", say("conditions ([[wanted]])", wanted=Words(part.theory.wanted, variable)), ": ")
    if all(one.formula is not None and is_short(one.formula) for one in items):
        shown: list[Inline] = []
        for one in items:
            assert one.formula is not None
            remark = (" (", Words(one.remark, variable), ")") if one.remark else ()
            shown.append(Phrase((Relation(one.formula, one.relation, 0), *remark)))
        yield joined([one for k, one in enumerate(shown) if one not in shown[:k]], ", ")
    else:
        yield Link(say("[[count]] in number", count=str(len(items))), "problem-6")
