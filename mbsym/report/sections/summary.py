"""What was found: the results of a run in a few lines, the verdict first."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import fields, is_dataclass
from itertools import groupby
from typing import TYPE_CHECKING, Any

from mbsym.algebra.factors import occurring, rational_ratio
from mbsym.algebra.remembered import remembered
from mbsym.expressions.message import Counted, worded
from mbsym.expressions.tree import text
from mbsym.formulas.formula import Formula
from mbsym.model.quantities import rate_unit
from mbsym.model.system import INERTIAL, System
from mbsym.problems.equilibrium import Equilibrium
from mbsym.problems.integrals import Integral
from mbsym.problems.stabilisation.result import Stabilisation
from mbsym.problems.stability.enclosed import numbers
from mbsym.problems.stability.problem import Stability, SubsystemStability
from mbsym.problems.stability.words import Because, Word, sentence
from mbsym.report.brief import claims_counted, self_check, worst
from mbsym.report.conditions import OPPOSITE, CaseStatement, Statement, as_stood, stood_by_name, told_cases
from mbsym.report.content import (
    Beside,
    Block,
    Drawing,
    Elsewhere,
    Emphasis,
    Fact,
    Facts,
    Graded,
    Heading,
    Inline,
    Link,
    Listed,
    Math,
    Name,
    Number,
    Numbered,
    Phrase,
    Power,
    Relation,
    Rows,
    Said,
    Symbol,
    Under,
    Unit,
    exact,
    joined,
    named,
    say,
    speeds,
)
from mbsym.report.letters import letters_of
from mbsym.report.sections.canonical import TITLES
from mbsym.report.sections.claims import short_difference
from mbsym.report.sections.energy import is_felt
from mbsym.report.sections.equations import are_short, is_short, short_equations, ties
from mbsym.report.sections.equilibrium import exists_if
from mbsym.report.sections.integrals import CONSTANT, title
from mbsym.report.sections.stability import condition_keys, label_of
from mbsym.report.sections.system import unperturbed_motion
from mbsym.report.words.claims import HELD, OPEN, REFUTED, claim_line, decided, grade, names_in, titles, verdict, where
from mbsym.report.words.stabilisation_words import controllability

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.problems.constraints.result import Constraints
    from mbsym.problems.equations import Equations
    from mbsym.report.results import Results

#: More conditions of a case, cases of a subsystem, coordinates of a motion are left to the problems.
MOST_CONDITIONS, MOST_CASES, MOST_COORDINATES = 4, 4, 8

#: More letters, or what they stand for in more characters, are left to problem 5.
MOST_LETTERS, LONGEST_MEANINGS = 12, 200

#: Of more coordinates the first ones and the last are told, and no motion.
MOST_NAMES = 24

#: More gains of a feedback are left to problem 8.
MOST_GAINS = 24

#: What the results of problems are called here.
TITLES_HERE = {3: "Equations", 4: "Motion", 6: "Stability", 7: "First integrals", 8: "Control"}

#: Nor is a position told by more coordinates.
MOST_DRAWN = 6

#: Conditions, each with the key of the formula that shows it.
Keys = Sequence[tuple[Statement, str]]


def content(results: Results) -> Iterator[Block]:
    """What reports say."""
    yield Heading("summary", Said("What was found"))
    yield from drawing(results.analysis)
    yield Beside(names_in(results.analysis.claims, results.system), (finding(results),))


@remembered
def drawing(analysis: Analysis) -> tuple[Drawing, ...]:
    """The system as it is drawn, if anything can be, and in which position; made once for all media."""
    return tuple(_drawing(analysis.system))


def _drawing(system: System) -> Iterator[Drawing]:
    from mbsym.picture.sketch import sketch  # what tells the finding alone has no use for it

    found = sketch(system)
    if found is None:
        return
    said = []
    if 0 < len(found.at) <= MOST_DRAWN:
        shown = tuple(Relation(Name(name), "=", Number(f"{value:.3g}")) for name, value in found.at)
        said.append(say("Drawn at [[values]].", values=shown))
    if found.frame != INERTIAL:
        said.append(say("Seen in the axes of [[frame]].", frame=Emphasis(found.frame)))
    if found.ellipsoids:
        said.append(Said("Ellipsoids: homogeneous, with the mass and the inertia of the body."))
    if found.unknown:
        said.append(say("Not to scale: no value is given for $[[names]]$.", names=named(found.unknown)))
    yield Drawing(found, tuple(said))


def finding(results: Results) -> Facts:
    """What was found, which heads every report and is all that the terminal tells."""
    return Facts(tuple(_facts(results)))


def _facts(results: Results) -> Iterator[Fact]:
    system, solutions = results.system, results.by_problem
    yield _size(system, solutions)
    if equations := tuple(_equations(solutions, system)):
        yield Fact(Said("Equations"), equations)
    if 4 in solutions:
        yield Fact(Said("Motion"), tuple(_motion(solutions[4], system)))
    if 6 in solutions:
        if solutions[6].numerical is not None and not _is_everywhere(solutions[6]):
            yield Fact(Said("At given values"), (_at_values(solutions[6], system),))
        lines = tuple(_stability(solutions[6], results))
        yield Fact(Said("Stability"), (*lines, *_meanings(lines, system)))
    if 8 in solutions and solutions[8].control:
        yield Fact(Link(Said("Control"), "stabilisation"), tuple(_control(solutions[8])))
    if 7 in solutions:
        none = (Said("none in closed form of the kinds that are looked for"),)
        yield Fact(Said("First integrals"), tuple(_integrals(solutions[7])) or none)
    if results.analysis.claims:
        yield Fact(Said("Claims"), tuple(_claims(results)))
    yield from _missing(results)
    if checks := results.analysis.checks:
        yield Fact(Said("Self-check"), (Link(Graded(self_check(checks), grade(worst(checks))), "checks"),))


def _size(system: System, solved: dict[int, Any]) -> Fact:
    """Coordinates, constraints, what is left of freedom, cyclic coordinates, inputs."""
    tied: Constraints | None = solved[3].constraints if 3 in solved else None
    said: list[Inline] = [_some(system.coordinates)]
    if len(system.coordinates) > 1:
        said.insert(0, f"{len(system.coordinates)}: ")
    if system.linear:
        title = "State variables" if system.linear.of_first_order else "Coordinates"
        return Fact(Said(title), (Phrase((*said, "; ", Said("given by its matrices"))),))
    if system.constraints:
        count = len(system.constraints) if tied is None else tied.velocity_rank
        said += ["; ", say("constraints: [[count]]", count=str(count))]
    if tied is not None and tied.names:
        freedom = len(tied.coordinates) - tied.velocity_rank
        said += ["; ", say("degrees of freedom: [[freedom]]", freedom=str(freedom))]
        if tied.demanded.satisfied is False:
            said += [" ", Said("(at values of the parameters that satisfy further relations; the given ones do not)")]
        if tied.kept_at_values is False:
            said += ["; ", Said("at the given values no regular configuration that keeps all constraints was found")]
    cyclic = [] if 2 not in solved or system.constraints else [x for x in solved[2].cyclic if not is_felt(x, solved)]
    cyclic = [name for name in cyclic if name in system.coordinates]  # the others are functions of time
    if cyclic:
        said += ["; ", Said("$L$ does not contain"), " ", _some(cyclic)]
    if system.inputs:
        said += ["; ", say("inputs: $[[names]]$", names=named(x.name for x in system.inputs))]
    return Fact(Said("Coordinates"), (Phrase(tuple(said)),))


def _some(names: Sequence[str]) -> Inline:
    return named(names) if len(names) <= MOST_NAMES else Phrase((named(names[:3]), ", ..., ", Name(names[-1])))


def _equations(solutions: dict[int, Any], system: System) -> Iterator[Inline]:
    """The equations of motion with the constraints; where they are long, how long, and where they stand."""
    if 3 in solutions:
        equations: Equations = solutions[3]
        rows, shown, number = equations.equalities(system.coordinates), short_equations(equations, system), 3
        yield from (*shown, *ties(equations)) if shown else ()
    elif system.linear is not None and 5 in solutions:
        rows, number = solutions[5].equalities, 5
        shown = tuple(Relation(x, "=", 0) for x in rows) if are_short(rows) else ()
        yield from shown
    else:
        return
    if not shown:
        terms = Counted(max(x.terms for x in rows), "term")
        size = say("[[count]], the longest with [[terms]]", count=str(len(rows)), terms=terms)
        yield Phrase((size, " (", Elsewhere("equations", number), ")"))


def _motion(equilibrium: Equilibrium, system: System) -> Iterator[Inline]:
    items = unperturbed_motion(system)
    is_short_enough = 0 < len(items.items) <= MOST_COORDINATES and len(system.coordinates) <= MOST_NAMES
    inlines: tuple[Inline, ...] = (items, " ") if is_short_enough else ()
    held = (" (", Said("'mbsym trim' looks for inputs that hold it"), ")") if system.inputs else ()
    if equilibrium.satisfied:
        yield Phrase((*inlines, Said("satisfies the equations of motion identically")))
    elif equilibrium.impossible:
        yield Phrase((*inlines, Graded(Said("does not satisfy the equations of motion"), "bad"), *held))
    elif len(equilibrium.conditions) <= MOST_CONDITIONS and all(map(is_short, equilibrium.conditions)):
        phrase = joined((Relation(condition, "=", 0) for condition in equilibrium.conditions), ", ")
        yield Phrase((*inlines, exists_if(equilibrium), " ", phrase, *held))
    else:
        text = "satisfies the equations of motion under conditions; their number: [[count]]"
        conditions = say(text, count=str(len(equilibrium.conditions)))
        yield Phrase((*inlines, conditions, " (", Elsewhere("motion", 4), ")"))


def _integrals(integrals: Sequence[Integral]) -> Iterator[Inline]:
    """The name of each, how surely it is one, and what it is where that is short, else how long it is."""
    long = [first_integral for first_integral in integrals if not is_short(first_integral.formula)]
    for integral in integrals:
        named_surely = Phrase((title(integral), " (", worded(integral.status), ")"))
        if integral not in long:
            yield Phrase((named_surely, ": ", Relation(integral.formula, "=", CONSTANT)))
            continue
        terms = Counted(integral.formula.terms, "term")
        place = (" (", Elsewhere("integrals", 7), ")") if integral is long[-1] else ()
        yield Phrase((say("[[integral]], [[terms]]", integral=named_surely, terms=terms), *place))


def _is_everywhere(stability: Stability) -> bool:
    """Whether the verdict at the given values is that for all values, and no number stands beside it."""
    alike = [stability.verdict, stability.numerical, *(part.theory.verdict for _, part in _telling(stability))]
    words = {(conclusion.word, conclusion.theorems) for conclusion in alike if conclusion is not None}
    return len(words) == 1 and stability.verdict.word.stable


def _telling(stability: Stability) -> list[tuple[int, SubsystemStability]]:
    """The groups of coordinates with their numbers, but those of which nothing is known that the whole does not say.

    Less may be known of a group than of the whole; and where all its roots are zero, nothing in it decays or grows.
    """
    parts = enumerate(stability.subsystems, start=1)
    less = stability.verdict.word.stable
    return [(k, x) for k, x in parts if not (less and x.theory.verdict.word.open) and not _glides(x)]


def _glides(part: SubsystemStability) -> bool:
    """Whether a group has no motions but steady ones, at other rates."""
    word, degree = part.theory.verdict.word, len(part.characteristic) - 1
    return word is Word.ASYMPTOTIC_BUT_STEADY and degree == part.theory.zero_power


def _at_values(stability: Stability, system: System) -> Inline:
    """The verdict at the given values; of an unstable motion how fast the fastest solution grows."""
    assert stability.numerical is not None
    said = (*verdict(stability.numerical, "verdict-at-values"), worded(decided(stability)))
    if stability.numerical.word is Word.UNDECIDED and stability.numerical.explanation:
        said = (*said, ": ", worded(stability.numerical.explanation))
    growth = max((root.real for part in stability.spectra for root in numbers(part)), default=0.0)
    if stability.numerical.word is Word.UNSTABLE and growth > 0:
        unit = rate_unit(system)
        largest = say("largest real part of an eigenvalue: [[growth]]", growth=f"{growth:.4g}")
        said = (*said, "; ", largest, *((" ", Unit(unit)) if unit else ()))
    return Phrase(said)


def _stability(stability: Stability, results: Results) -> Iterator[Inline]:
    """The verdicts for all values of the parameters: that on the whole, then those on subsystems, with their cases."""
    presumed = (*results.presumed[1:], ": ") if results.presumed else ()
    word, parts = stability.verdict.word, _telling(stability)
    alone = [x for x in parts if len(stability.subsystems) == 1 or word is Word.DEPENDS]
    if len(alone) == 1 and all(map(_glides, (x for x in stability.subsystems if x is not alone[0][1]))):
        number, part = alone[0]
        first, *further = _part(part, number, "verdict")
        yield Phrase((*presumed, first))
        yield from _coefficients(part, further, results.variable)
        yield from further
        yield from _what_would_decide(stability)
        return
    lines_by_part = [list(_part(part, k, "")) for k, part in parts]
    alike = all(part.theory.verdict.word is word for _, part in parts)
    together = alike and word is not Word.DEPENDS and all(len(lines) == 1 for lines in lines_by_part)
    whole = verdict(stability.verdict, "verdict")
    if together:
        yield Phrase((*presumed, *whole))
        yield from _what_would_decide(stability)
        return
    apart = ("; ", Said("each group of coordinates while the others keep to the motion"), ":")
    yield Phrase((*presumed, Said("the whole system"), ": ", *whole, *apart))
    yield from _what_would_decide(stability)
    for (_, part), lines in zip(parts, lines_by_part, strict=True):
        lines[:0] = _coefficients(part, lines, results.variable)
        yield Phrase((named(part.coordinates), ": ", lines[0]))
        yield from (Under((line,)) for line in lines[1:])
    reasons = (cause for part in stability.subsystems for cause in part.theory.verdict.reasons)
    # The names mean others.
    for reason in dict.fromkeys(cause for cause in reasons if cause.code is Because.OTHER_ANGLES):
        yield worded(sentence(reason))


def _what_would_decide(stability: Stability) -> Iterator[Inline]:
    """Where all parameters are on a border: that values would help."""
    for reason in stability.verdict.reasons:
        if reason.code is Because.VALUES_DECIDE:
            yield worded(sentence(reason))


def _coefficients(part: SubsystemStability, lines: Iterable[Inline], variable: str) -> Iterator[Inline]:
    """The characteristic polynomial in the letters by which conditions call its coefficients, and where these stand."""
    relations = (x for x in _within(tuple(lines)) if isinstance(x, Relation))
    letters = [x.parts[0] for x in relations if isinstance(x.parts[0], Symbol)]
    if not letters:
        return
    place = Elsewhere("conditions", 6)
    if len(part.theory.factors) > 1:
        text = "[[letters]]: coefficients of factors of the characteristic polynomial ([[place]])"
        yield say(text, letters=tuple(dict.fromkeys(letters)), place=place)
        return
    zeros = part.theory.zero_power  # conditions call the coefficients of what is left without them

    def rate(power: int) -> tuple[Math, ...]:
        return (Symbol(variable),) if power == 1 else (Power(Symbol(variable), power),) if power else ()

    powers = (k for k, x in reversed([*enumerate(part.characteristic[zeros:])]) if not x.is_zero)
    parts: list[Math | str] = [x for k in powers for x in ("+", Symbol(letters[0].letter, str(k)), *rate(k))]
    left = Relation(*parts[1:])
    polynomial = Relation(Listed((left,), brackets=True), *rate(zeros)) if zeros else left
    yield say("characteristic polynomial [[polynomial]] ([[place]])", polynomial=polynomial, place=place)


def _meanings(lines: Iterable[Inline], system: System) -> Iterator[Inline]:
    """What the author's letters in the conditions stand for; where that is long, where it is told."""
    formulas = (part for part in _within(tuple(lines)) if isinstance(part, Formula))
    names = {x.ring.generators[k].name for x in formulas for k in occurring([x.polynomial])}
    meant = letters_of(system).definitions(names)
    if len(meant) > MOST_LETTERS or sum(len(text(value)) for _, value in meant) > LONGEST_MEANINGS:
        letters = named(name for name, _ in meant)
        yield say(
            "[[letters]]: letters of the description ([[place]])", letters=letters, place=Elsewhere("conditions", 5)
        )
    elif meant:
        definitions = joined((Relation(Name(name), "=", value) for name, value in meant), ", ")
        yield say("where [[definitions]]", definitions=definitions)


def _within(part: object) -> Iterator[object]:
    """A part of a line, and all that stands in it, however deep."""
    yield part
    if isinstance(part, Said):
        yield from _within(tuple(part.gaps.values()))
    elif isinstance(part, tuple | list):
        for inner in part:
            yield from _within(inner)
    elif is_dataclass(part) and not isinstance(part, Formula):
        yield from _within(tuple(getattr(part, x.name) for x in fields(part)))


def _part(part: SubsystemStability, number: int, key: str) -> Iterator[Inline]:
    """The verdict on a subsystem, or which verdict follows where: the first case that applies is the one."""
    theory = part.theory
    known, word = told_cases(part), theory.verdict.word
    if word not in (Word.DEPENDS, Word.UNDECIDED) or key or not known:
        yield Phrase(verdict(theory.verdict, key))
    keys = list(condition_keys(part, number))
    seen: list[Stood] = []
    last: list[_Condition] = []
    for k, case in enumerate(known[:MOST_CASES]):
        every, either = _conditions(case, seen, keys)
        told_where = _where(case, every, either, last) if every or either else _counted(case)
        yield Phrase((*((Said("otherwise"), " ") if k else ()), told_where))
        last = every
    if len(known) > MOST_CASES:
        yield Link(say("further cases: [[count]]", count=str(len(known) - MOST_CASES)), "problem-6")


#: A polynomial of a condition, and as what it stands there: in full, or by its name.
Stood = tuple[Formula, Math]

#: A condition, and where it stands in problem 6.
_Condition = tuple[Relation, tuple[Numbered, ...]]


def _conditions(case: CaseStatement, seen: list[Stood], keys: Keys) -> tuple[list[_Condition], list[_Condition]]:
    """What all has to hold, and what of which something has to; nothing where there is too much to be read.

    ``seen``: polynomials that stood before, and as what.  Beside a long one coefficients are told by their letters.
    """
    statements = [*case.all_of, *case.any_of]
    if len(statements) > MOST_CONDITIONS or not all(
        condition.formula is not None and (is_short(condition.formula) or "," not in condition.bare)
        for condition in statements
    ):
        return [], []
    long = not all(statement.formula is not None and is_short(statement.formula) for statement in statements)
    either = [_condition(statement, long, seen, keys) for statement in case.any_of]
    return [_condition(statement, long, seen, keys) for statement in case.all_of], either


def _counted(case: CaseStatement) -> Inline:
    """That a case has conditions."""
    verdict = Phrase(where(case.word, case.theorems))
    if case.otherwise:
        return verdict
    count = len(case.all_of) + len(case.any_of)
    if count == 1:
        text = "[[verdict]], if one condition holds ([[place]])"
    elif not case.all_of:
        text = "[[verdict]] if one or more of [[count]] conditions hold ([[place]])"
    elif case.theorems:
        text = "[[verdict]] if all [[count]] conditions hold ([[place]])"
    else:
        text = "[[verdict]], if all [[count]] conditions hold ([[place]])"
    return say(text, verdict=verdict, count=str(count), place=Elsewhere("conditions", 6))


def _where(case: CaseStatement, every: list[_Condition], either: list[_Condition], before: list[_Condition]) -> Inline:
    """The verdict with its conditions; ``before``: those of the case in front of it."""
    verdict = Phrase(where(case.word, case.theorems))
    if len(either) > 1 and not every and [item.parts for item, _ in either] == [_reversed(item) for item, _ in before]:
        return say("[[verdict]] if one of these is negative", verdict=verdict)
    between = (", ", Said("and"), " ") if every and either else ()
    phrase = joined((Phrase((relation, *number)) for relation, number in every), ", ")
    others = joined((Phrase((relation, *number)) for relation, number in either), " ", Said("or"), " ")
    conditions = Phrase((phrase, *between, others))
    # Without a theorem behind it "gyroscopically stabilised only if" would be read as "only if".
    text = "[[verdict]] if [[conditions]]" if case.theorems else "[[verdict]], if [[conditions]]"
    return say(text, verdict=verdict, conditions=conditions)


def _condition(item: Statement, long: bool, seen: list[Stood], keys: Keys) -> _Condition:
    """The condition and its number; one that is too long to be read by its name, a coefficient beside it, too."""
    assert item.formula is not None
    name = label_of(item.bare)
    number = _numbered(item.formula, item.relation, keys)
    if (long and isinstance(name, Symbol)) or not is_short(item.formula):
        return Relation(*stood_by_name(item, name, seen), 0), number
    return Relation(*as_stood(item, seen), 0), number


def _numbered(left: Formula, sign: Math | str, keys: Keys) -> tuple[Numbered, ...]:
    """Where the condition stands in problem 6, a positive number times it, or its opposite reversed."""
    for item, key in keys:
        assert item.formula is not None
        ratio = rational_ratio(left.polynomial, item.formula.polynomial)
        if ratio is not None and sign == (item.relation if ratio > 0 else OPPOSITE.get(item.relation, item.relation)):
            return (Numbered(key),)
    return ()


def _reversed(relation: Relation) -> tuple[Math | str, ...]:
    return (relation.parts[0], "<", 0) if relation.parts[1] == ">" else ()


def _control(stabilisation: Stabilisation) -> Iterator[Inline]:
    """Whether the inputs reach everything; whether a feedback was found, or why not."""
    yield controllability(stabilisation.control[0])
    if stabilisation.feedback is None:
        yield say("No feedback is given: [[why]].", why=worded(stabilisation.no_feedback))
    else:
        whole = "A feedback makes the linear equations asymptotically stable at the given values (proved)."
        part = "A feedback makes a part of the linear equations asymptotically stable at the given values (proved)."
        yield Said(part if stabilisation.feedback.of_part else whole)
        states, gains = stabilisation.feedback.states, stabilisation.feedback.gains
        if len(states) * len(gains) <= MOST_GAINS:
            law = {"names": speeds(states), "gains": Rows(tuple(tuple(map(exact, row)) for row in gains))}
            yield Said("$u = -k z$, $z$ = ([[names]]), $k$ = [[gains]]", law)


def _claims(results: Results) -> Iterator[Inline]:
    """How many hold; each that does not."""
    lines = list(map(claim_line, results.analysis.claims))
    words = [line.word for line in lines]
    gravest = next(word for word in (REFUTED, OPEN, HELD) if word in words)
    said: Inline = say("all [[count]] hold", count=str(len(lines))) if len(lines) > 1 else Said("it holds")
    if gravest != HELD:
        said = claims_counted(words)
    yield Link(Graded(said, grade(gravest)), "claims")
    for line, claim in zip(lines, results.analysis.claims, strict=True):
        if line.word != HELD:
            place = (line.place, ", ") if line.place else ()
            said = Phrase((*place, titles([line]), ": ", Graded(Phrase(line.said), grade(line.word))))
            difference = short_difference(claim)
            yield said if difference is None else Phrase((said, "; ", Said("claimed minus derived"), ": ", difference))


def _missing(results: Results) -> Iterator[Fact]:
    """Problems and forms without a result, and why."""
    for reason, several in groupby(results.failures.items(), key=lambda entry: entry[1].reason):
        last, failure = [*several][-1]  # what the others lead to
        more = (" (", worded(failure.hint), ")") if failure.hint else ()
        title = Said(TITLES_HERE[last]) if last in TITLES_HERE else say("Problem [[number]]", number=str(last))
        no_result = Phrase((Said("no result"), ": ", worded(reason), *more))
        yield Fact(Link(title, f"problem-{last}"), (no_result,))
    for form, failure in results.forms.forms.failures:
        yield Fact(Said(TITLES[form]), (Phrase((Said("no result"), ": ", worded(failure.reason))),))
