"""``mbsym integrals``: all polynomial first integrals up to a weighted degree.

What is said of special parameters stands in ``cases.py``, of invariant relations in ``relations.py``, of integrals
where another one has a value in ``levels.py``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import KW_ONLY, dataclass, field
from typing import TYPE_CHECKING, Annotated

from mbsym.expressions.message import Message, worded
from mbsym.maps.axis import Axis
from mbsym.studies.request import Flag, Named, Number, Numbers, Range, Whole
from mbsym.studies.section import no_number
from mbsym.studies.study import Answer, Asked, Exit, Line, NotFit, Refusal, Study, Unfit, Watch, heading, line, refused

if TYPE_CHECKING:
    from mbsym.analysis.polynomial import InvariantRelations, Setting
    from mbsym.problems.polynomial_integrals.result import Along, Cases, DarbouxAlong, PolynomialIntegrals
    from mbsym.report.content import Block

#: For ``--cases``: counted work, worth about so many seconds.
BUDGET = 60.0


@dataclass(frozen=True)
class Request:
    """Find all polynomial first integrals of FILE up to a weighted degree, or prove that there are no others.

    Variables are speeds and unit vectors where FILE declares them (keys 'speeds' and 'orientation'), otherwise rates,
    sines and cosines of angles, and lengths.  Parameters stay symbols, so
    that what is said holds for almost all their values; --set puts in exact numbers, where there may be more.
    A weighted degree counts each variable with its weight: rates, sines, cosines and lengths with 1, speeds and unit
    vectors with those under which the equations are quasi-homogeneous where there are such, otherwise 1 and 2;
    --weight gives others.  Positions that the equations do not contain are no variables, which is said.

    --vary finds every value of one parameter in an interval at which there are more, also those that hold only where
    another integral is zero; other parameters need numbers.  --cases looks for conditions on the parameters: zeros,
    equalities and a polynomial condition besides, also of gyrostats; families of parameters that the --budget leaves
    out are counted.  --relations lists polynomials f that divide their derivative, so that a motion which begins on
    f = 0 stays there: linear forms, each with the parameters at which there is such a form, and those up to the degree
    for almost all parameters; and integrals that hold only where another one is zero.  --vary and --relations together
    find the values at which there are more polynomials f.

    Exit codes: 0 found, or proved that there are none; 1 undecided, or the equations are not polynomial; 2 something is
    wrong.

    \b
    Examples:
      mbsym integrals systems/clebsch-poisson.yaml
      mbsym integrals systems/gyrostat-poisson.yaml --degree 6 --set lx=0 --set epsilon=0
      mbsym integrals systems/euler-poisson.yaml -s B=2 -s C=1 -s x0=1 -s y0=0 -s z0=0 -s m=1 -s g=1 --vary A=1:5
      mbsym integrals systems/euler-poisson.yaml --set y0=0 --cases --budget 30
      mbsym integrals systems/euler-poisson.yaml --set y0=0 --relations
      mbsym integrals systems/goryachev-chaplygin.yaml --relations
      mbsym integrals euler-poisson.yaml -d 1 -s A=6 -s C=3 -s x0=1 -s y0=0 -s z0=1 -s m=1 -s g=1 --vary B=1:5 --relations
    """  # noqa: E501 - a command is one line

    _: KW_ONLY
    degree: Annotated[int, Whole("N", "Up to this weighted degree.", "-d", most=60)] = 4
    values: Numbers = field(default_factory=dict)
    weights: Annotated[
        Mapping[str, int],
        Named("NAME=N", "Weight of a variable, or unit vector.", "-w", "--weight", most=12, example="gamma1=2"),
    ] = field(default_factory=dict)
    vary: Annotated[Axis | None, Range("NAME=LOW:HIGH", "At which values of a parameter are there more?")] = None
    cases: Annotated[bool, Flag(None, "Under which conditions on parameters are there more?")] = False
    budget: Annotated[
        float | None, Number("S", "Counted work, worth some S seconds, that --cases may take.", usual="60")
    ] = None
    relations: Annotated[bool, Flag(None, "Invariant relations f = 0, and integrals where another one is zero.")] = (
        False
    )


def unfit(context: Asked, request: Request) -> Iterator[Unfit]:
    if "vary" in context.typed and request.cases:
        message = "with --vary other parameters are numbers"
        yield Unfit("--cases", "not-together", message, "choose one of them")
    if request.vary is not None and request.vary.name in request.values:
        message = Message("'[[name]]' has an interval and a number", name=request.vary.name)
        yield Unfit("--set", "repeated-name", message, "leave one of them out")
    if "budget" in context.typed and not request.cases:
        yield Unfit("--budget", "missing-option", "--budget goes with --cases", "add --cases")


@dataclass(frozen=True)
class Found:
    """The integrals, and what was asked for besides: None where it was not."""

    there: Setting
    integrals: PolynomialIntegrals
    line: Along | None
    cases: Cases | None
    relations: InvariantRelations | None
    at: DarbouxAlong | None


def derive(context: Asked, request: Request, watch: Watch) -> Found:
    """Raises NotFit where the field has other variables or parameters than the request names."""
    from mbsym.algebra.failures import NoClosedForm
    from mbsym.analysis import Analysis
    from mbsym.analysis.polynomial import allowed, integrals_of, invariant_relations, setting
    from mbsym.problems.polynomial_integrals.homogenised import InAnyField

    watch("polynomial integrals")
    analysis = Analysis(context.system)
    there = setting(analysis, request.values, driven=True)
    if there.field.roots and (request.vary is not None or request.cases or request.relations):
        raise NoClosedForm(
            "special parameters and invariant relations are looked for in equations whose numbers are rational, and "
            "these hold [[roots]]",
            roots=", ".join(name for name, _ in there.field.roots),
            remedy="leave --vary, --cases and --relations out",
        )
    if wrong := tuple(_unfit(there, request)):
        raise NotFit(wrong)
    integrals, axis = integrals_of(there, request.degree, request.weights), request.vary
    beside = InAnyField(integrals, there.kinds, there.known)
    along = None if axis is None else beside.along(axis.low, axis.high)
    positive = [parameter.name for parameter in context.system.parameters if parameter.sign == "positive"]
    special = None
    if request.cases:
        budget = BUDGET if request.budget is None else request.budget
        special = beside.cases(positive, budget)
        special = special and allowed(analysis, there, request.values, special)
    invariant = invariant_relations(beside, positive) if request.relations else None
    at = beside.darboux_along(axis.low, axis.high) if request.relations and axis is not None else None
    return Found(there, integrals, along, special, invariant, at)


def _unfit(there: Setting, request: Request) -> Iterator[Unfit]:
    """Of ``--weight``: no such variable.  Of ``--vary``: a parameter that does not occur, or others without numbers."""
    for name in request.weights:
        if name not in there.field.variables:
            known = ", ".join(there.field.variables)
            message = Message("the field has no variable [[name]]", name=name)
            yield Unfit("--weight", "unknown-name", message, Message("there are [[names]]", names=known))
    axis = request.vary
    if axis is None:
        return
    if axis.name not in there.field.parameters:
        message = Message("the equations do not depend on [[name]]", name=axis.name)
        yield Unfit("--vary", "not-there", message, "take another parameter")
    lacking = [name for name in there.field.parameters if name != axis.name]
    if lacking:
        yield no_number(lacking)


def answer(context: Asked, request: Request, derived: Found) -> Answer:
    return Answer(_lines(derived), code=Exit.OK if derived.integrals.complete else Exit.FAILED)


def _lines(derived: Found) -> Iterator[Line | Block]:
    """The integrals, what is known of them as a whole, what was looked for, and what is there besides."""
    from mbsym.report.content import Phrase, joined, ragged, say
    from mbsym.report.sections.polynomial_integrals import listed, opening
    from mbsym.report.words.integrals_words import sentences

    there, integrals = derived.there, derived.integrals
    formulas = [there.formula(generator.polynomial) for generator in integrals.generators]
    yield from listed(integrals, formulas)
    yield from map(ragged, sentences(integrals))
    if beyond := [Phrase((worded(name), f" ({weight})")) for name, weight in _beyond(derived)]:
        text = "Integrals of problem 7 of a higher weighted degree (--degree): [[names]]."
        yield ragged(say(text, names=joined(beyond, ", ")))
    yield opening(integrals, integrals.field.variables)
    for head, texts in _sections(derived):
        yield heading(head)
        for text in texts:
            yield line("    ", text, whole=True)


def _beyond(derived: Found) -> Iterator[tuple[str, int]]:
    """Known integrals with their weighted degrees, where these are above what was looked through."""
    grading, variables = derived.integrals.grading, derived.integrals.field.variables
    for name, p in derived.there.known:
        places = [p.context().names().index(x) for x in variables]
        weight = max(grading.of([powers[k] for k in places]) for powers in p.monoms())
        if weight > derived.integrals.degree:
            yield name, weight


def _sections(derived: Found) -> Iterator[tuple[str, Iterator[str]]]:
    from mbsym.studies.integrals.relations import (
        along_lines,
        cases_lines,
        darboux_lines,
        darboux_values,
        level_lines,
        other_lines,
        relation_lines,
    )

    there, integrals, relations = derived.there, derived.integrals, derived.relations
    if derived.line is not None:
        yield Message("Special values"), along_lines(there, integrals, derived.line)
    if derived.cases is not None:
        yield Message("Special cases"), cases_lines(there, derived.cases)
    if relations is not None:
        yield Message("Integrals where another one is zero"), level_lines(there, integrals, relations.levels)
        nonzero = Message("Integrals where another one has a value that is not zero")
        yield nonzero, other_lines(there, relations.others)
        yield Message("Linear invariant relations"), relation_lines(there, relations.linear)
        yield Message("Invariant relations f = 0 with f' = K f"), darboux_lines(there, integrals, relations.darboux)
    if derived.at is not None:
        head = Message("Values of [[name]] with further f' = K f", name=derived.at.name)
        yield head, darboux_values(there, integrals, derived.at)


def as_json(context: Asked, request: Request, derived: Found) -> str:
    from mbsym.report.integrals_json import integrals_json

    further = (derived.line, derived.cases, derived.relations, derived.at)
    return integrals_json(context.system, request.values, derived.there, derived.integrals, *further)


def refusal(error: Exception, context: Asked, request: Request) -> Refusal | None:
    from mbsym.algebra.failures import Failure, Limit

    if isinstance(error, ZeroDivisionError):
        return refused("no integrals", error, Exit.BAD_INPUT)
    if not isinstance(error, Failure):
        return None
    return refused("no integrals", error, Exit.BAD_INPUT if error.limit is Limit.DEGREE else Exit.FAILED)


STUDY = Study("integrals", Request, derive, answer, refusal, unfit, as_json, constraints=True, out=None, letters=True)
