"""What was found: the results of a run in a few lines."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import TYPE_CHECKING

from mbsym.model.system import System
from mbsym.problems.equilibrium import Equilibrium
from mbsym.problems.stability import Stability
from mbsym.problems.stability.word import Word
from mbsym.report.brief import self_check, worst
from mbsym.report.content import Block, Facts, Graded, Heading, Inline, Link, Said, Words, named, say
from mbsym.report.words.claims import HELD, OPEN, REFUTED, claim_line
from mbsym.report.words.verdicts import decided, grade, verdict

if TYPE_CHECKING:
    from mbsym.report.results import Results

Fact = tuple[tuple[Inline, ...], tuple[Inline, ...]]


def content(results: Results) -> Iterator[Block]:
    """What reports say."""
    yield Heading("summary", Said("What was found"))
    yield Facts(tuple(_facts(results)))


def _facts(results: Results) -> Iterator[Fact]:
    system, found = results.system, results.found
    yield _size(system)
    if 2 in found and found[2].cyclic and not system.constraints:
        yield (Said("Cyclic coordinates"),), (named(found[2].cyclic),)
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
        text = "[[held]] hold, [[refuted]] do not, [[open]] undecided"
        said = say(text, held=str(count[HELD]), refuted=str(count[REFUTED]), open=str(count[OPEN]))
        yield (Said("Claims"),), (Link(Graded(said, grade(gravest)), "claims"),)
    for number, failure in results.failures.items():
        link = Link(say("Problem [[number]]", number=str(number)), f"problem-{number}")
        yield (link,), (Said("no result"), ": ", Words(failure.reason))
    checks = results.analysis.checks
    if checks:
        yield (Said("Self-check"),), (Link(Graded(self_check(checks), grade(worst(checks))), "checks"),)


def _size(system: System) -> Fact:
    freedom = str(len(system.coordinates))
    if system.linear:
        return (Said("Degrees of freedom"),), (say("[[freedom]]; given by its matrices", freedom=freedom),)
    bodies = str(len(system.bodies))
    if system.constraints:
        text = "[[bodies]]; coordinates: [[coordinates]]; constraints: [[constraints]]"
        said = say(text, bodies=bodies, coordinates=freedom, constraints=str(len(system.constraints)))
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
    cases = ("; ", Link(Said("see the cases"), "problem-6"))
    names = named(found.subsystems[0].coordinates)
    whole = (Said("Stability of the whole system"),) if several else (Said("Stability"), ", ", names)
    depends = found.verdict.word is Word.DEPENDS
    yield (*whole, *presumed), (*verdict(found.verdict, "verdict"), *(cases if depends else ()))
    for part in found.subsystems if several else ():
        others = (", ", Said("while the others keep to the unperturbed motion"))
        yield (Said("Stability"), ", ", named(part.coordinates), *presumed), (*verdict(part.theory.verdict), *others)
    if found.numerical is not None:
        said = verdict(found.numerical, "verdict-at-values")
        yield (Said("At the given values of the parameters"), Words(decided(found))), said
