"""Problem 3 in Hamilton's and Routh's forms: what every kind of report shows of it, where it was asked for."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.analysis.forms import BRACKETS, requested_forms
from mbsym.formulas.formula import Formula, Matrix
from mbsym.model.momenta import denominator_names
from mbsym.model.system import System
from mbsym.problems.canonical import DENOMINATORS
from mbsym.report.documents import results as doc
from mbsym.report.documents.base import Part, Write
from mbsym.report.latex.formulas import width
from mbsym.report.lengths import formulas

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.analysis.stages import NoResult
    from mbsym.problems.canonical import Brackets, Hamilton, Routh


@dataclass(frozen=True)
class Forms:
    """The forms that were asked for; ``failures`` say of those that have no result why, by the name of the form."""

    routh: Routh | None = None
    hamilton: Hamilton | None = None
    brackets: Brackets | None = None
    failures: tuple[tuple[str, NoResult], ...] = ()

    @property
    def some(self) -> bool:
        """Whether there is anything to show."""
        return self != Forms()

    @property
    def results(self) -> list[Any]:
        """What is there; each has room of its own in a file."""
        return [form for form in (self.routh, self.hamilton, self.brackets) if form is not None]

    @property
    def routh_ring(self) -> Ring:
        """The ring of Routh's form, in which momenta are parameters."""
        assert self.routh is not None
        return self.routh.function.ring

    @property
    def hamilton_ring(self) -> Ring:
        """The ring of Hamilton's form, in which momenta change with the time."""
        assert self.hamilton is not None
        return self.hamilton.hamiltonian.ring


def forms_of(analysis: Analysis, problems: Sequence[int]) -> Forms:
    """What a report of these problems shows."""
    if 3 not in problems:
        return Forms()
    names = list(requested_forms(analysis))
    if "hamilton" in names and 7 in problems:
        names.append(BRACKETS)
    stages = {name: analysis.stage_of(name) for name in names}
    failures = [(name, stage.failure) for name, stage in stages.items() if stage.failure is not None]
    if any(name == "hamilton" for name, _ in failures):  # and then there are no brackets either
        failures = [failure for failure in failures if failure[0] != BRACKETS]
    return Forms(**{name: stage.value for name, stage in stages.items()}, failures=tuple(failures))


TITLES = {"routh": "Routh's form", "hamilton": "Hamilton's form", "brackets": "Poisson brackets of the first integrals"}


# --- results.json -----------------------------------------------------------------------------------------------------


def data(forms: Forms, write: Write, failure: Callable[[NoResult], Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """The sections of results.json, and what is unavailable."""
    parts: dict[str, type[Part]] = {"routh": doc.Routh, "hamilton": doc.Hamilton, "brackets": doc.Brackets}
    results = {name: getattr(forms, name) for name in parts}
    sections = {name: parts[name].from_result(form, write) for name, form in results.items() if form is not None}
    return sections, {name: failure(why) for name, why in forms.failures}


# Long denominators of Hamilton's and Routh's forms, written once: 1/Delta in place of 1/(a sum that no line holds).


#: Denominators estimated wider than this (in ems) have a name.
WIDEST = 10


@dataclass(frozen=True)
class Denominators:
    """``forms`` with names in place of long denominators; what these are, in Routh's form and in Hamilton's."""

    forms: Forms
    routh: tuple[tuple[Formula, Formula], ...]
    hamilton: tuple[tuple[Formula, Formula], ...]


def with_names(forms: Forms, system: System) -> Denominators:
    """The same formulas; each name and what it stands for as formulas."""
    routh, hamilton, brackets = forms.routh, forms.hamilton, forms.brackets
    first: list[tuple[Formula, Formula]] = []
    second: list[tuple[Formula, Formula]] = []
    if routh is not None:
        shorter, first = _named(forms.routh_ring, [routh], system)
        routh = shorter[0]
    if hamilton is not None:
        shorter, second = _named(forms.hamilton_ring, [hamilton, brackets], system, len(first))
        hamilton, brackets = shorter
    shortened = replace(forms, routh=routh, hamilton=hamilton, brackets=brackets)
    return Denominators(shortened, tuple(first), tuple(second))


def _named(
    ring: Ring, results: list[Any], system: System, taken: int = 0
) -> tuple[list[Any], list[tuple[Formula, Formula]]]:
    """The results with names behind the ``taken`` ones, and what these are; as they are where names do not suffice."""
    long = list(_long(ring, results))
    names = denominator_names(system, DENOMINATORS)[taken:]
    if not long or len(long) > len(names):
        return results, []
    letters = [ring.generator("parameter", name) for name in names[: len(long)]]
    try:
        inverse = {index: ring.reciprocal(letter) for index, letter in zip(long, letters, strict=True)}
    except NoClosedForm:  # the ring has no room for more
        return results, []
    definitions = [
        (Formula(ring, letter), Formula(ring, ring.generators[index].argument))
        for index, letter in zip(long, letters, strict=True)
    ]
    return [_mapped(result, lambda x: Formula(ring, ring.substitute(x, inverse))) for result in results], definitions


def _long(ring: Ring, results: list[Any]) -> Iterator[int]:
    """The reciprocals that occur and are too wide for a line."""
    used: set[int] = set()
    for formula in formulas(results):
        degrees = formula.polynomial.degrees()
        used |= {k for k, g in enumerate(ring.generators[: ring.spare]) if g.kind == "reciprocal" and degrees[k] > 0}
    for index in sorted(used):
        if width(Formula(ring, ring.generators[index].argument).latex()) > WIDEST:
            yield index


def _mapped(result: Any, change: Callable[[Polynomial], Formula]) -> Any:
    """A result with every formula changed."""
    if isinstance(result, Formula):
        return change(result.polynomial)
    if isinstance(result, Matrix):
        return Matrix(tuple(tuple(change(x.polynomial) for x in row) for row in result.rows))
    if isinstance(result, tuple):
        return tuple(_mapped(x, change) for x in result)
    if hasattr(result, "__dataclass_fields__"):
        return replace(result, **{item.name: _mapped(getattr(result, item.name), change) for item in fields(result)})
    return result
