"""What a run found, as plain data for the terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mbsym.formulas.formula import Matrix
from mbsym.problems.checks import Check
from mbsym.problems.energy import Energy
from mbsym.problems.equations import Equations
from mbsym.problems.equilibrium import Equilibrium
from mbsym.problems.integrals import Integral
from mbsym.problems.kinematics import Kinematics
from mbsym.problems.linearisation import Linearisation
from mbsym.problems.stability import Stability
from mbsym.problems.stability.requirements import Method
from mbsym.problems.stability.sentences import short, with_theorem
from mbsym.problems.stability.spectrum import RootNumbers, Spectrum, numbers
from mbsym.problems.stability.symbolic import Theory
from mbsym.problems.stability.verdict import Verdict
from mbsym.problems.stability.word import Word
from mbsym.report.claims import ClaimLine, claim_line
from mbsym.report.conditions import Statement, provided, statements
from mbsym.report.results_json import statement_text

if TYPE_CHECKING:
    from mbsym.analysis import Analysis

#: Conditions longer than this are counted, not printed.
LONGEST = 100

#: More eigenvalues of a subsystem are left to the files.
MOST_ROOTS = 10


@dataclass(frozen=True)
class Line:
    """One problem: what was derived, in a few lines; where nothing was (not ``available``) they say why."""

    number: int
    title: str
    lines: tuple[str, ...]
    seconds: float
    available: bool


@dataclass(frozen=True)
class Summary:
    system: str
    coordinates: tuple[str, ...]
    problems: tuple[Line, ...]
    checks: tuple[Check, ...]
    files: tuple[Path, ...]
    claims: tuple[ClaimLine, ...] = ()


def summary(analysis: Analysis, problems: Sequence[int], files: Iterable[Path]) -> Summary:
    """Derived problems with sizes and seconds, the self-check, and where the files are."""
    return Summary(
        system=analysis.system.name,
        coordinates=analysis.system.coordinates,
        problems=tuple(_line(analysis, number) for number in problems),
        checks=analysis.checks,
        files=tuple(files),
        claims=tuple(map(claim_line, analysis.claims)),
    )


def _line(analysis: Analysis, number: int) -> Line:
    from mbsym.analysis import PROBLEMS

    stage = analysis.stage(number)
    title = PROBLEMS[number].title
    if stage.failure is not None:
        lines = [f"no result: {stage.failure.reason}", *([stage.failure.hint] if stage.failure.hint else [])]
        return Line(number, title, tuple(lines), stage.seconds, False)
    if number == 6:
        described = _stability(stage.value, provided(len(analysis.equilibrium.conditions)))
    else:
        described = _DESCRIPTIONS[number](stage.value)
    return Line(number, title, tuple(described), stage.seconds, True)


def _kinematics(found: Kinematics) -> Iterator[str]:
    yield counted(len(found.bodies), "body", "bodies")


def _energy(found: Energy) -> Iterator[str]:
    kinetic, force = found.kinetic_energy.terms, found.force_function.terms
    yield f"T: {counted(kinetic, 'term')}, U: {counted(force, 'term')}"
    if found.cyclic:
        yield f"cyclic: {', '.join(found.cyclic)}"


def _equations(found: Equations) -> Iterator[str]:
    n = len(found.forcing)
    terms = sum(x.terms for x in found.forcing)
    size = counted(found.mass_matrix.terms, "term")
    yield f"{counted(n, 'equation')}; mass matrix {size}, right-hand sides {counted(terms, 'term')}"


def _equilibrium(found: Equilibrium) -> Iterator[str]:
    if found.satisfied:
        yield "the unperturbed motion satisfies the equations identically"
    elif found.impossible:
        yield "the unperturbed motion cannot satisfy the equations"
    for condition in found.conditions:
        yield shortened(f"{condition} = 0", condition.terms)


def _linearisation(found: Linearisation) -> Iterator[str]:
    present = [name for name in "MDGKN" if not _is_zero(getattr(found, name))]
    yield f"matrices that are not zero: {', '.join(present)}"
    if len(found.subsystems) > 1:
        yield "subsystems: " + "; ".join(", ".join(part.coordinates) for part in found.subsystems)


def _is_zero(matrix: Matrix) -> bool:
    return matrix.is_zero


def _stability(found: Stability, presumed: str) -> Iterator[str]:
    for part in found.subsystems:
        # Of a motion that is proved to be stable, conditions of something stronger would be misread.
        items = [] if part.theory.verdict.stable else list(statements(part.ring, part.theory.requirements))
        verdict = _verdict(part.theory.verdict)
        if part.theory.verdict.word is Word.DEPENDS and items:
            verdict += f"; {_heading(part.theory)}:"
        yield f"{', '.join(part.coordinates)}: {verdict}"
        for item in items:
            yield f"  {_condition(item)}"
    if len(found.subsystems) > 1:
        yield f"whole system: {_verdict(found.verdict)}"
    if presumed:
        yield f"all this {presumed}"
    if found.numerical is not None:
        why = found.numerical.explanation if found.numerical.word is Word.UNDECIDED else ""
        yield f"at the given values: {_verdict(found.numerical)}" + (f": {_clause(why)}" if why else "")
    for spectrum in found.spectra:
        yield f"eigenvalues there ({', '.join(spectrum.coordinates)}): {_roots(spectrum)}"


def _heading(theory: Theory) -> str:
    """What the listed conditions are."""
    if theory.method is Method.EVEN and not theory.potential:
        return "necessary conditions, but for the case of equality"
    always = next((case.verdict for case in theory.cases if case.always), None)
    if always is not None and always.stable:
        return f"{_verdict(always)} in any case, asymptotically stable under these conditions"
    return "conditions"


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


def _condition(item: Statement) -> str:
    if item.formula is None and item.never is None:
        return f"a condition is {item.note}"
    if item.never is not None:
        value = str(item.never)
        left = f"{item.label} = {value}" if len(value) <= LONGEST else item.label
        return f"{left} {item.relation} 0 {item.note}"
    remark = f" ({item.remark})" if item.remark else ""
    return f"{item.label}: {shortened(statement_text(item), 0 if item.formula is None else item.formula.terms)}{remark}"


def _verdict(verdict: Verdict) -> str:
    return with_theorem(short(verdict.word), verdict.theorem)


def _clause(sentence: str) -> str:
    """A sentence as the end of another one; the name of a matrix keeps its capital."""
    first = sentence.split(" ")[0]
    return (sentence if len(first) == 1 and first != "A" else sentence[:1].lower() + sentence[1:]).rstrip(".")


def _integrals(found: tuple[Integral, ...]) -> Iterator[str]:
    for item in found:
        yield f"{item.name}: {item.status}"
    if not found:
        yield "none of the kinds that are looked for"


_DESCRIPTIONS: dict[int, Callable[[Any], Iterator[str]]] = {
    1: _kinematics,
    2: _energy,
    3: _equations,
    4: _equilibrium,
    5: _linearisation,
    7: _integrals,
}


def counted(n: int, one: str, many: str = "") -> str:
    return f"{n} {one if n == 1 else many or one + 's'}"


def shortened(text: str, terms: int) -> str:
    """The text, or how long it is."""
    return text if len(text) <= LONGEST else f"({counted(terms, 'term')}; see the reports)"
