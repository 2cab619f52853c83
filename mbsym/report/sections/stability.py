"""Problem 6, stability: what results.json and reports show of it."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from msgspec import UNSET, UnsetType
from msgspec.structs import asdict

from mbsym.expressions.message import Message, worded
from mbsym.expressions.message import joined as sentences_of
from mbsym.expressions.tree import names
from mbsym.formulas.names import free_name
from mbsym.mechanics.variables import expressions
from mbsym.model.quantities import rate_unit
from mbsym.model.system import System
from mbsym.problems.dissipation import EnergyLaw
from mbsym.problems.stability.enclosed import RootNumbers, numbers
from mbsym.problems.stability.linear_form import CONSERVATIVE
from mbsym.problems.stability.problem import Stability, SubsystemStability
from mbsym.problems.stability.requirements import OF_FACTOR, PART, REVERSED, Place
from mbsym.problems.stability.verdict import Verdict
from mbsym.problems.stability.words import Because, Word, sentence
from mbsym.report.conditions import (
    CaseStatement,
    Shown,
    Statement,
    cases,
    factors,
    label_meanings,
    statements,
    written_again,
)
from mbsym.report.content import (
    CONDITION,
    Block,
    Cited,
    Definitions,
    Display,
    Heading,
    Inline,
    Listed,
    Math,
    Notation,
    Number,
    Polynomial,
    Readable,
    Relation,
    Said,
    Subheading,
    Symbol,
    Text,
    Unit,
    named,
    paragraph,
    say,
)
from mbsym.report.documents import parts
from mbsym.report.documents.base import Write
from mbsym.report.documents.results import stability as doc
from mbsym.report.references import keys_of, theorems_named
from mbsym.report.words.claims import concluded, decided, verdict

if TYPE_CHECKING:
    from mbsym.report.results import Results

#: A polynomial that never has the sign it should have is written out up to this length.
SHORT = 60


def data(stability: Stability, system: System, write: Write) -> doc.Stability:
    """The section of results.json."""
    taken = [*system.coordinates, *system.parameter_names, *(item.name for item in system.notation)]
    variable = free_name("lam", taken)
    return doc.Stability.from_result(
        stability,
        **verdict_data(stability.verdict),
        subsystems=[_subsystem(part, variable) for part in stability.subsystems],
        eigenvalues_at_values=[(part.coordinates, numbers(part)) for part in stability.spectra],
    )


def verdict_data(conclusion: Verdict) -> dict[str, Any]:
    """The fields of a verdict in every JSON file, for parts that have more of them."""
    return asdict(parts.Verdict.from_result(conclusion))


def _subsystem(part: SubsystemStability, variable: str) -> doc.StabilitySubsystem:
    labels = label_meanings(part.ring, part.theory.requirements)
    listed = list(statements(part.ring, part.theory.requirements, told=labels))
    shown = Shown()
    for item in listed:
        shown.show(item)
    return doc.StabilitySubsystem.from_result(
        part,
        variable=variable,
        **verdict_data(part.theory.verdict),
        conditions=[_condition_of(item) for item in listed],
        cases=[_case(case, shown) for case in cases(part)],
    )


def _statement(item: Statement) -> doc.Statement:
    """``formula`` ``relation`` 0; null for a formula that is too long to be written out."""
    formula = item.formula if item.never is None else item.never
    return doc.Statement.from_result(item, formula=formula, never=item.never is not None)


def _condition_of(item: Statement) -> doc.Condition:
    """A long one in the coefficients of the characteristic polynomial, too, with what these are."""
    in_coefficients: doc.InCoefficients | UnsetType = UNSET
    if item.in_coefficients is not None:
        letters = {str(letter): str(value) for letter, value in item.in_coefficients.letters}
        in_coefficients = doc.InCoefficients.from_result(item.in_coefficients, coefficients=letters)
    return doc.Condition.from_result(item, **asdict(_statement(item)), in_coefficients=in_coefficients)


def _case(case: CaseStatement, shown: Shown) -> doc.Case:
    """Conditions that the list already holds, or holds reversed, are named by their labels there."""

    def named(item: Statement) -> doc.Listed | doc.Statement:
        label = shown.reference(item)
        return _statement(item) if label is None else doc.Listed(listed=label.under, relation=label.relation)

    return doc.Case.from_result(
        case, all_of=[named(item) for item in case.all_of], any_of=[named(item) for item in case.any_of]
    )


# --- reports ----------------------------------------------------------------------------------------------------------


def content(results: Results) -> Iterator[Block]:
    """What reports say."""
    stability: Stability | None = results.by_problem.get(6)
    yield Heading("stability", Said("Problem 6. Stability"))
    yield from results.missing(6)
    if stability is None:
        return
    presumed = results.presumed
    for number, part in enumerate(stability.subsystems, start=1):
        yield from _told(part, number, len(stability.subsystems) > 1, results)
    if len(stability.subsystems) > 1:
        yield paragraph(
            Said(
                "Each of these verdicts is about coordinates of one subsystem while the others keep to the unperturbed "
                "motion."
            ),
            " ",
            Said("For the whole system"),
            *presumed,
            ": ",
            *verdict(stability.verdict),
            ".",
        )
    if stability.numerical is not None:
        told = {part.theory.verdict.explanation for part in stability.subsystems}
        again = told == {stability.numerical.explanation} and stability.numerical.word is not Word.UNDECIDED
        reason = "" if again else stability.numerical.explanation
        yield paragraph(
            Said("At the given values of the parameters"),
            worded(decided(stability)),
            ": ",
            *verdict(stability.numerical),
            ". " if reason else ".",
            worded(reason),
        )
        for spectrum in stability.spectra:
            roots = [part for root in numbers(spectrum) for part in (", ", *_root(root))][1:]
            unit = rate_unit(results.system)
            yield paragraph(
                say("Eigenvalues there, in the time $t$, of $[[names]]$", names=named(spectrum.coordinates)),
                ": ",
                *roots,
                *((" ", Unit(unit)) if unit else ()),
                ".",
            )
    elif lacking := _without_numbers(results):
        text = "At the given values of the parameters nothing is said of stability: without a value is $[[names]]$."
        yield paragraph(say(text, names=named(lacking)))
    theorems = [(name, keys_of(name)) for name in dict.fromkeys(theorems_named(stability))]
    cited = tuple((worded(name), keys) for name, keys in theorems if keys)
    if cited:
        yield Cited(Said("On the theorems"), cited)


def _told(part: SubsystemStability, number: int, several: bool, results: Results) -> Iterator[Block]:
    """A subsystem: its characteristic polynomial, conditions, cases and verdict."""
    theory, variable = part.theory, results.variable
    title: tuple[Inline, ...] = (Said("Subsystem"), f" {number}: ") if several else ()
    kind: Inline = worded(theory.kind)
    if theory.kind.endswith(CONSERVATIVE) and not _conserved(results):
        kind = say("in first approximation [[kind]]", kind=kind)
    yield Subheading((*title, named(part.coordinates), " (", kind, ")"))
    symbol = Symbol(results.characteristic, upper=f"({number})" if several else "")
    shown = Relation(symbol, Listed((Symbol(variable),), brackets=True))
    yield paragraph(say("The characteristic polynomial $[[symbol]]$, freed of a positive factor, is", symbol=shown))
    yield Display(Relation(symbol, "=", Polynomial(part.characteristic, variable)), f"characteristic:{number}")
    if len(theory.factors) > 1:
        text = (
            "Number of its factors: [[count]]. A label with $k$ below and $(j)$ above belongs to the power $k$ of "
            "$[[variable]]$ in factor $j$."
        )
        yield paragraph(say(text, count=str(len(theory.factors)), variable=Symbol(variable)))
        for k, (powers, multiplicity) in enumerate(factors(part), start=1):
            factor = Polynomial(tuple(powers), variable, multiplicity)
            yield Display(Relation(k, ":", factor), f"factor:{number}:{k}")
    seen, labels = _Keyed(number), label_meanings(part.ring, theory.requirements)
    needed = list(statements(part.ring, theory.requirements, True, labels))
    if theory.verdict.stable:  # this method leaves open what is decided otherwise
        needed = [replace(x, place=Place.NECESSARY) if x.place is Place.METHOD else x for x in needed]
    if needed:
        yield paragraph(Said("Conditions"), " (", worded(theory.wanted), "):")
        yield from _conditions(needed, seen)
    first = True
    for case in cases(part):
        if case.conditional:
            yield from _case_told(case, first, seen)
            first = False
    for remark in theory.remarks:
        yield paragraph(worded(remark))
    yield paragraph(Said("Verdict"), *results.presumed, ": ", *_verdict_told(theory.verdict))


def _conserved(results: Results) -> bool:
    """Whether the energy of the system is constant near the motion, in all orders, if there are further ones."""
    balance = results.analysis.optional("balance")
    if balance is None:  # other angles were judged
        return any("energy" in integral.name for integral in results.analysis.optional("integrals") or ())
    return balance.exactly_linear or balance.law is EnergyLaw.CONSERVED


def _verdict_told(conclusion: Verdict) -> tuple[Inline, ...]:
    if conclusion.word is Word.DEPENDS:
        others = [sentence(reason) for reason in conclusion.reasons if reason.code is not Because.SEE_CASES]
        said = (" ", worded(sentences_of(others))) if others else ()
        return *concluded(conclusion.word, ()), "; ", Said("see the cases."), *said
    return *verdict(conclusion), ". ", worded(conclusion.explanation)


def _without_numbers(results: Results) -> list[str]:
    """The parameters that have no value, where others have one."""
    system, motion = results.system, results.analysis.optional("equilibrium")
    known = {item.name for item in system.relations} | {name for name, _ in (() if motion is None else motion.solved)}
    lacking = [item.name for item in system.parameters if item.value is None and item.name not in known]
    used = {name for x in expressions(system) for name in names(x)} if lacking else set()
    return [name for name in lacking if name in used] if any(x.value is not None for x in system.parameters) else []


class _Keyed(Shown):
    """What was shown, each under a key of its own."""

    def __init__(self, number: int) -> None:
        super().__init__()
        self._number, self._taken = number, Counter[str]()

    def key(self, item: Statement) -> str:
        """That of the formula which shows it first; nothing where a name is enough.  Once for each item, in order."""
        if self.reference(item) is not None:
            return ""
        bare = str(item.label).replace("condition ", "")  # the key is the same in whatever letters a section is written
        word = re.sub(r"[^A-Za-z0-9]+", "-", bare).strip("-")
        self._taken[word] += 1
        count = self._taken[word]
        return f"{CONDITION}{self._number}:{word}" + (f":{count}" if count > 1 else "")


def condition_keys(part: SubsystemStability, number: int) -> Iterator[tuple[Statement, str]]:
    """The conditions of a subsystem that are shown by formulas, each with the key of its own."""
    seen, labels = _Keyed(number), label_meanings(part.ring, part.theory.requirements)
    known = list(statements(part.ring, part.theory.requirements, True, labels))
    for case in cases(part):
        if case.conditional:
            known += [*case.all_of, *case.any_of]
    for item in known:
        key = seen.key(item)
        if key and item.formula is not None:
            yield item, key
        seen.show(item)


def _case_told(case: CaseStatement, first: bool, seen: _Keyed) -> Iterator[Block]:
    word = concluded(case.word, case.theorems)
    if case.otherwise:
        yield paragraph(Said("Otherwise"), " ", *word, ":")
    else:
        opening: tuple[Inline, ...] = () if first else (Said("Otherwise"), " ")
        yield paragraph(*opening, *word, ", ", worded(case.if_), ":")
    yield from _conditions(case.all_of, seen)
    if case.all_of and case.any_of:
        yield paragraph(worded(case.and_), ":")
    yield from _conditions(case.any_of, seen)
    yield paragraph(worded(case.explanation))


def _conditions(items: Sequence[Statement], seen: _Keyed) -> Iterator[Block]:
    """Conditions; of a polynomial that was shown before only its name."""
    for item in items:
        yield from _condition_told(item, seen)
        seen.show(item)


def _condition_told(item: Statement, seen: _Keyed) -> Iterator[Block]:
    reference, key = seen.reference(item), seen.key(item)
    remark: tuple[Inline, ...] = (worded(item.remark),) if item.remark else ()
    note: tuple[Inline, ...] = (worded(item.note),) if item.note else ()
    label = label_of(item.label if reference is None else reference.label)
    named: tuple[Math | str, ...] = (label, ":") if item.named else ()
    if reference is not None:
        left: Math = label_of(reference.under)
        if isinstance(left, Text) and written_again(reference.formula):
            left = Readable(reference.formula, True)
        elif reference.under == reference.label:
            named = ()
        yield Display(Relation(*named, left, reference.relation, 0))
    elif item.formula is None:
        never = item.never is not None and item.never.terms < SHORT
        yield Display(Relation(label, *(("=", item.never) if never else ()), item.relation, 0), key, note)
    elif item.in_coefficients is not None:
        text = "written out [[terms]] terms, of degree [[degree]]; in full in results.json"
        long = say(text, terms=str(item.formula.terms), degree=str(item.formula.degree))
        yield Display(Relation(*named, item.in_coefficients.formula, item.relation, 0), key, (long, *remark))
        letters = seen.unshown(item.in_coefficients)
        if letters:
            yield Definitions(Said("with"), tuple(Relation(letter, "=", value) for letter, value in letters))
    else:
        shown = Readable(item.formula, not item.note)
        yield Display(Relation(*named, shown, item.relation, 0), key, note or remark)


def label_of(label: str) -> Math:
    """v6 as a coefficient's symbol, other labels as words."""
    gaps = label.gaps if isinstance(label, Message) else {}
    made = label.text if isinstance(label, Message) else ""
    if made == REVERSED:
        return Relation("-", label_of(gaps["label"]))
    if made == PART:
        whole, part = label_of(gaps["label"]), (", ", worded(gaps["part"]))
        return Text(*whole.parts, *part) if isinstance(whole, Text) else Relation(whole, Text(*part))
    of_factor = made == OF_FACTOR
    match = re.fullmatch(r"([av])(\d+)", gaps["label"] if of_factor else label)
    if match is None:
        return Text(worded(label))
    return Symbol(match[1], match[2], f"({gaps['number']})" if of_factor else "")


def _root(root: RootNumbers) -> tuple[Inline, ...]:
    """-0.1 +- 2.3 i, with its multiplicity."""
    real = (_number(root.real),) if root.real or not root.imaginary else ()
    imaginary = ("+-", _number(root.imaginary), Notation(r"\,\mathrm{i}")) if root.imaginary else ()
    times = () if root.multiplicity == 1 else (" ", Notation(f"({root.multiplicity}\\times)"))
    return Relation(*real, *imaginary), *times


def _number(value: float) -> Number:
    """Six digits."""
    return Number(f"{value:.6g}")
