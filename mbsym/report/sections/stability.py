"""Problem 6, stability: what results.json and the terminal show of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from msgspec import UNSET, UnsetType
from msgspec.structs import asdict

from mbsym.expressions.counting import counted
from mbsym.expressions.tree import names
from mbsym.formulas.names import free_name
from mbsym.mechanics.variables import expressions
from mbsym.model.system import System
from mbsym.problems.stability import Stability
from mbsym.problems.stability.problem import SubsystemStability
from mbsym.problems.stability.reasons import Because
from mbsym.problems.stability.requirements import Method
from mbsym.problems.stability.sentences import sentence, with_theorem
from mbsym.problems.stability.spectrum import RootNumbers, Spectrum, numbers
from mbsym.problems.stability.symbolic import Theory
from mbsym.problems.stability.verdict import Verdict
from mbsym.problems.stability.word import Word
from mbsym.report.conditions import CaseStatement, Shown, Statement, cases, label_meanings, provided, statements
from mbsym.report.documents import parts
from mbsym.report.documents.results import stability as doc
from mbsym.report.plain import LONGEST, Write, shortened, statement_text

if TYPE_CHECKING:
    from mbsym.analysis import Analysis

#: A theorem on a subsystem of the first approximation says nothing of its coordinates where others run away: the
#: nonlinear equations couple them.
ALONE = "(each of these while the others keep to the unperturbed motion)"

#: What the coordinates of a verdict are; it is told beside every verdict.
_OF_COORDINATES = (Because.DISPLACEMENTS, Because.OTHER_ANGLES)

#: Whether a drift of coordinates counts, which makes two words for one motion: it is told with the verdict.
_OF_DRIFTS = (Because.LINEAR_DRIFTS, Because.COASTING)

#: More eigenvalues of a subsystem are left to the files.
MOST_ROOTS = 10


def data(found: Stability, system: System, write: Write) -> doc.Stability:
    """The section of results.json."""
    taken = [*system.coordinates, *system.parameter_names, *(item.name for item in system.notation)]
    variable = free_name("lam", taken)
    return doc.Stability(
        **asdict(verdict_data(found.verdict)),
        at_values=None if found.numerical is None else verdict_data(found.numerical),
        subsystems=[_subsystem(part, variable) for part in found.subsystems],
        eigenvalues_at_values=[
            doc.Spectrum(
                coordinates=list(part.coordinates),
                roots=[
                    doc.Root(real=x.real, imaginary=x.imaginary, multiplicity=x.multiplicity) for x in numbers(part)
                ],
            )
            for part in found.spectra
        ],
    )


def verdict_data(found: Verdict) -> parts.Verdict:
    """A verdict in every JSON file: its word, its theorems and reasons as codes, the reasons in sentences beside."""
    return parts.Verdict(
        verdict=found.word,
        theorems=list(found.theorems),
        reasons=[
            parts.Reason(code=item.code.name.lower(), data=[_datum(x) for x in item.data]) for item in found.reasons
        ],
        explanation=found.explanation,
    )


def _datum(value: object) -> int | str:
    return value if isinstance(value, int) else str(value)


def _subsystem(part: SubsystemStability, variable: str) -> doc.StabilitySubsystem:
    told = label_meanings(part.ring, part.theory.requirements)
    listed = list(statements(part.ring, part.theory.requirements, told=told))
    shown = Shown()
    for item in listed:
        shown.show(item)
    return doc.StabilitySubsystem(
        coordinates=list(part.coordinates),
        variable=variable,
        characteristic_polynomial=[str(coefficient) for coefficient in part.characteristic],
        method=part.theory.method.name.lower(),
        **asdict(verdict_data(part.theory.verdict)),
        conditions=[_condition_of(item) for item in listed],
        cases=[_case(case, shown) for case in cases(part.ring, part.theory.cases, told)],
    )


def _statement(item: Statement) -> doc.Statement:
    """``formula`` ``relation`` 0; null for a formula that is too long to be written out."""
    formula = item.formula if item.never is None else item.never
    return doc.Statement(
        label=item.label,
        formula=None if formula is None else str(formula),
        relation=item.relation,
        never=item.never is not None,
    )


def _condition_of(item: Statement) -> doc.Condition:
    """A long one in the coefficients of the characteristic polynomial, too, with what these are."""
    told: doc.InCoefficients | UnsetType = UNSET
    if item.told is not None:
        letters = {str(letter): str(value) for letter, value in item.told.letters}
        told = doc.InCoefficients(formula=str(item.told.formula), coefficients=letters)
    return doc.Condition(**asdict(_statement(item)), in_coefficients=told, place=item.place.name.lower())


def _case(case: CaseStatement, shown: Shown) -> doc.Case:
    """Conditions that the list already holds, or holds reversed, are named by their labels there."""

    def named(item: Statement) -> doc.Listed | doc.Statement:
        found = shown.reference(item)
        return _statement(item) if found is None else doc.Listed(listed=found.under, relation=found.relation)

    return doc.Case(
        all_of=[named(item) for item in case.all_of],
        any_of=[named(item) for item in case.any_of],
        otherwise=case.otherwise,
        verdict=case.word,
        theorems=list(case.theorems),
    )


def lines(found: Stability, analysis: Analysis) -> Iterator[str]:
    """The lines in the terminal."""
    presumed = provided(found.presumed, bool(analysis.system.inputs))
    for part in found.subsystems:
        # Of a motion that is proved to be stable, conditions of something stronger would be misread.
        items = [] if part.theory.verdict.stable else list(statements(part.ring, part.theory.requirements))
        verdict = _verdict(part.theory.verdict)
        if part.theory.verdict.word in (Word.DEPENDS, Word.UNSTABLE_BUT_BORDERS) and items:
            verdict += f"; {_heading(part.theory, items)}:"
        yield f"{', '.join(part.coordinates)}: {verdict}"
        shown = Shown()
        for item in items:
            if item.told is None and item.formula is not None and len(statement_text(item)) <= LONGEST:
                shown.show(item)
        for item in items:
            yield f"  {_condition(item, shown)}"
        yield from _of_drifts(part.theory.verdict)
    verdicts = [x for part in found.subsystems for x in (part.theory.verdict, *(y.verdict for y in part.theory.cases))]
    for one in dict.fromkeys(reason for x in verdicts for reason in x.reasons if reason.code in _OF_COORDINATES):
        yield _clause(sentence(one))
    if len(found.subsystems) > 1:
        yield ALONE
        yield f"whole system: {_verdict(found.verdict)}"
    if presumed:
        yield f"all this {presumed}"
    if found.numerical is not None:
        why = found.numerical.explanation if found.numerical.word is Word.UNDECIDED else ""
        yield f"at the given values: {_verdict(found.numerical)}" + (f": {_clause(why)}" if why else "")
        if not any(part.theory.verdict.reasons == found.numerical.reasons for part in found.subsystems):
            yield from _of_drifts(found.numerical)
    elif lacking := _without_numbers(analysis):
        yield f"at the given values: nothing, {', '.join(lacking)} {'has' if len(lacking) == 1 else 'have'} none"
    for spectrum in found.spectra:
        yield f"eigenvalues there ({', '.join(spectrum.coordinates)}): {_roots(spectrum)}"


def _of_drifts(verdict: Verdict) -> Iterator[str]:
    return (f"  {_clause(sentence(one))}" for one in verdict.reasons if one.code in _OF_DRIFTS)


def _without_numbers(analysis: Analysis) -> list[str]:
    """The parameters that have no value, where others have one."""
    system = analysis.system
    motion = analysis.optional("equilibrium")
    known = {one.name for one in system.relations} | {name for name, _ in (() if motion is None else motion.solved)}
    lacking = [one.name for one in system.parameters if one.value is None and one.name not in known]
    used = {name for x in expressions(system) for name in names(x)} if lacking else set()
    return [name for name in lacking if name in used] if any(x.value is not None for x in system.parameters) else []


def _roots(spectrum: Spectrum) -> str:
    listed = [root_text(x) for x in numbers(spectrum)]
    more = len(listed) - MOST_ROOTS
    return ", ".join(listed[:MOST_ROOTS]) + (f" and {more} more" if more > 0 else "")


def root_text(root: RootNumbers) -> str:
    """``-0.1 +- 2.3i (twice)``."""
    real = f"{root.real:.6g}"
    text = real if not root.imaginary else f"+-{root.imaginary:.6g}i"
    if root.imaginary and root.real:
        text = f"{real} +- {root.imaginary:.6g}i"
    times = {1: "", 2: " (twice)"}.get(root.multiplicity, f" ({root.multiplicity} times)")
    return text + times


def _condition(item: Statement, shown: Shown) -> str:
    """A condition as long as it can be read; in coefficients only where each of these stands in the terminal, too."""
    if item.formula is None and item.never is None:
        return f"a condition is {item.note}"
    if item.never is not None:
        value = str(item.never)
        left = f"{item.label} = {value}" if len(value) <= LONGEST else item.label
        return f"{left} {item.relation} 0 {item.note}"
    remark = f" ({item.remark})" if item.remark else ""
    if item.told is not None and item.formula is not None and not shown.unshown(item.told):
        length = counted(item.formula.terms, "term")
        return f"{item.label}: {item.told.formula} {item.relation} 0 (written out {length}){remark}"
    return f"{item.label}: {shortened(statement_text(item), 0 if item.formula is None else item.formula.terms)}{remark}"


def _heading(theory: Theory, items: Sequence[Statement]) -> str:
    """What the listed conditions are; some may say themselves what they are needed for."""
    if theory.method is Method.EVEN and not theory.potential:
        if any(item.remark for item in items):
            return "conditions, necessary but for the case of equality where nothing else is said"
        return "necessary conditions, but for the case of equality"
    always = next((case.verdict for case in theory.cases if case.always), None)
    if always is not None and always.stable:
        return f"{_verdict(always)} in any case, asymptotically stable under these conditions"
    if theory.method is Method.HURWITZ:  # a motion may be stable without them: where friction is zero, say
        return f"conditions for {theory.wanted.replace(': ', ' (')})"
    return "conditions"


def _verdict(verdict: Verdict) -> str:
    return with_theorem(verdict.word, verdict.theorem)


def _clause(sentence: str) -> str:
    """A sentence as the end of another one; the name of a matrix keeps its capital."""
    first = sentence.split(" ")[0]
    return (sentence if len(first) == 1 and first != "A" else sentence[:1].lower() + sentence[1:]).rstrip(".")
