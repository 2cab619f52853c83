"""What the builders of reports have before them: results of some problems, each looked up once for all media."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib import import_module
from typing import TYPE_CHECKING, Any, Generic, TypeVar, cast

from mbsym.expressions.message import worded
from mbsym.formulas.latex import LatexNames, latex_symbol
from mbsym.model.system import INERTIAL
from mbsym.report.canonical import Denominators, forms_of, with_names
from mbsym.report.compact import Compact, compact, told_formulas
from mbsym.report.conditions import provided
from mbsym.report.content import Block, Heading, Inline, Intermediates, Paragraph, Relation, Said, paragraph, say
from mbsym.report.letters import in_letters, with_meanings
from mbsym.report.sections import section_of
from mbsym.report.words.passages import passages

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.analysis.stages import NoResult
    from mbsym.model.system import System


T = TypeVar("T")

_INTERMEDIATES = (
    "Through intermediate quantities, each defined once, in the order of the recursion. Their first index is the "
    "number of a body, the numbers at the end are components, in its axes unless others are named; components that "
    "are not listed are zero, or so short that they are written where they occur. Accelerations, forces and moments "
    "are those at $\\ddot q = 0$."
)
_AGAIN = "Through the intermediate quantities above."
_BESIDES = "Through the intermediate quantities above and those that follow here."


@dataclass(frozen=True)
class Results:
    """The results of ``problems`` of one system; ``apart`` where each is to be read without those before it."""

    analysis: Analysis
    problems: tuple[int, ...]
    apart: bool = False

    @property
    def system(self) -> System:
        return self.analysis.system

    @cached_property
    def by_problem(self) -> dict[int, Any]:
        """By number, the results that there are."""
        stages = {number: self.analysis.stage(number) for number in self.problems}
        return {number: stage.value for number, stage in stages.items() if stage.failure is None}

    @cached_property
    def failures(self) -> dict[int, NoResult]:
        """By number, why there is no result."""
        stages = {number: self.analysis.stage(number) for number in self.problems}
        return {number: stage.failure for number, stage in stages.items() if stage.failure is not None}

    @cached_property
    def compact(self) -> dict[int, Compact]:
        """By number, the problems whose formulas are told through named intermediates."""
        return compact(self.analysis, {number: self.by_problem.get(number) for number in self.problems})

    @cached_property
    def forms(self) -> Denominators:
        """Routh's and Hamilton's forms, where they were asked for; their long denominators have names."""
        return with_names(forms_of(self.analysis, self.problems), self.system)

    @property
    def numbers(self) -> dict[str, int]:
        """Of the bodies by name, in the order of the description; the inertial frame has 0."""
        return {INERTIAL: 0} | {body.name: k for k, body in enumerate(self.system.bodies, start=1)}

    @cached_property
    def variable(self) -> str:
        """The letter of characteristic polynomials."""
        return self._free("lambda", "mu", "sigma", "s", "p", "z", "zeta")

    @cached_property
    def characteristic(self) -> str:
        """The letter that stands for such a polynomial."""
        return self._free("Lambda", "Delta", "Phi", "P", "Q")

    def _free(self, *letters: str) -> str:
        """The first that is the symbol of nothing declared."""
        system, names = self.system, LatexNames.of(self.analysis.ring)
        declared = [*system.coordinates, *system.parameter_names]
        declared += [*(x.name for x in system.prescribed), *(x.name for x in system.notation)]
        taken = {str(names[name]) for name in declared}
        return next((x for x in letters if str(latex_symbol(x)) not in taken), letters[0])

    @cached_property
    def presumed(self) -> tuple[Inline, ...]:
        """What the verdicts of problem 6 presume, after a comma."""
        stability = self.by_problem.get(6)
        motion = self.analysis.optional("equilibrium")
        if stability is None:
            return ()
        text, linear = provided(stability, motion, bool(self.system.inputs)), self.analysis.optional("linearisation")
        assumed = () if linear is None else linear.about.assumed
        where = say("where [[conditions]]", conditions=[Relation(x, "!=", 0) for x in assumed])
        return (*((", ", worded(text)) if text else ()), *((", ", where) if assumed else ()))

    def intermediates(self, number: int) -> Iterator[Block]:
        """The named quantities through which the formulas of a problem are told; none is defined a second time."""
        told = self.compact[number]
        before = () if self.apart else [earlier for k, earlier in self.compact.items() if k < number]
        defined = {item.name for earlier in before for passage in earlier.passages for item in passage.definitions}
        new = told.passages
        if defined:
            new = passages(told.system.told, self.system, told_formulas(told.system, number), defined)
        length = say("Written out there are [[count]] terms.", count=str(told.expanded))
        introduced = Said(_INTERMEDIATES if not defined else _BESIDES if new else _AGAIN)
        yield paragraph(introduced, *((" ", length) if told.expanded else ()))
        if new:
            yield Intermediates(told.system.told, new)

    def missing(self, number: int) -> Iterator[Block]:
        """Why a problem has no result, if it has none; of a reason that an earlier one has where it stands."""
        failure = self.failures.get(number)
        if failure is None:
            return
        first = next(k for k in sorted(self.failures) if self.failures[k] == failure)
        if first == number:
            yield no_result(failure)
        else:
            why = say("as in problem [[number]]", number=str(first))
            yield Paragraph((Said("No result"), ": ", why, "."), missing=True)


def no_result(failure: NoResult) -> Paragraph:
    """Why there is none."""
    hint = (" (", worded(failure.hint), ")") if failure.hint else ()
    return Paragraph((Said("No result"), ": ", worded(failure.reason), *hint, "."), missing=True)


#: What stands beside the problems, by the names of its modules in ``sections``.
BESIDE = ("summary", "system", "conventions", "claims", "checks")


@dataclass(frozen=True)
class Section(Generic[T]):
    """A section of a report: what is called writes it, ``title`` what its heading says."""

    build: Callable[[Results], Iterator[Block]]
    known: Results
    write: Callable[[Iterator[Block]], T]
    lettered: bool = True  # in the author's letters; claims say themselves what is one of them, and what it equals
    told: frozenset[str] = frozenset()  # letters of which the section itself says what they stand for
    asked: bool = False  # in those only that were asked for: what was found is to be read without a list of letters

    def __call__(self) -> T:
        known = self.known
        letters = known.analysis.letters if self.lettered else ()
        with in_letters(known.system, letters or () if self.asked else letters) as used:
            written: Any = self.write(with_meanings(self.build(known), known.system, used, self.told))
            return cast("T", iter(list(written)) if isinstance(written, Iterator) else written)

    @property
    def title(self) -> Said:
        """Of its heading, which every section begins with."""
        heading = next(self.build(self.known))
        assert isinstance(heading, Heading)
        return heading.title


def contents(known: Results, write: Callable[[Iterator[Block]], T]) -> dict[int | str, Section[T]]:
    """The sections: those of the problems by their numbers, others by their names."""
    from mbsym.analysis import PROBLEMS

    modules: dict[int | str, Any] = {number: section_of(PROBLEMS[number]) for number in known.problems}
    modules |= {name: import_module(f"mbsym.report.sections.{name}") for name in BESIDE}
    notation = frozenset(symbol.name for symbol in known.system.notation)
    return {
        key: Section(x.content, known, write, key != "claims", notation if key == 5 else frozenset(), key == "summary")
        for key, x in modules.items()
    }


def results(analysis: Analysis, problems: Sequence[int], apart: bool = False) -> Results:
    return Results(analysis, tuple(problems), apart)
