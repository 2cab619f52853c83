"""``mbsym nonlinear``: what terms of higher order decide, at values or along one parameter."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import KW_ONLY, dataclass, field, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Annotated

from mbsym.expressions.message import Message, joined, worded
from mbsym.maps.axis import Axis
from mbsym.studies.request import ExactSettings, Range
from mbsym.studies.study import Answer, Asked, Line, NotFit, Refusal, Study, Unfit, Watch, failed, line, missing

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.model.system import System
    from mbsym.problems.normal_forms.along import Along
    from mbsym.problems.normal_forms.result import NormalForms
    from mbsym.report.content import Block


@dataclass(frozen=True)
class Request:
    """List the values of a parameter at which terms of higher order of FILE decide otherwise than beside them.

    Between two of them one verdict holds.  Each is the root of a polynomial: a resonance of order 3 or 4 of two
    frequencies, a zero of Arnold's determinant D4, a border of the first approximation; with applied forces a border at
    which a pair of roots becomes imaginary (soft or hard, by Lyapunov's coefficient) or a root zero.  The theorems are
    those of problem 11 ('mbsym explain 11'), which 'mbsym run --problems 11' tells at the values of the description.

    Along a parameter every other one needs a rational number, from the description (values:) or from --set.  Without
    --vary it is told what they decide at the values, and in parameters where there are formulas.

    Exit codes: 0 listed, 1 they cannot be listed (the reason is given), 2 something is missing or wrong,
    130 interrupted.

    \b
    Examples:
      mbsym nonlinear systems/three-bodies.yaml --set mu=1/50 --json
      mbsym nonlinear systems/three-bodies.yaml --vary mu=0:1/2
      mbsym nonlinear systems/ziegler-damped.yaml --vary P=0:10 --set b2=1/5 --json
    """

    _: KW_ONLY
    values: Annotated[
        Mapping[str, Fraction], ExactSettings("NAME=VALUE", "Replace a value; repeatable.", "-s", "--set")
    ] = field(default_factory=dict)
    vary: Annotated[Axis | None, Range("NAME=LOW:HIGH", "The parameter, and its open interval.")] = None


def unfit(context: Asked, request: Request) -> Iterator[Unfit]:
    """Numbers are of parameters that follow from nothing else, and have their declared signs; along a parameter all
    others have one."""
    from mbsym.model.assumptions import has_sign

    system = context.system
    signs = {parameter.name: parameter.sign for parameter in system.parameters}
    related = {relation.name for relation in system.relations}
    for name, value in request.values.items():
        if name not in signs:
            message = Message("[[name]] is a symbol of the notation", name=name)
            yield Unfit("--set", "unknown-name", message, "set the parameters in it")
        elif name in related:
            message = Message("'[[name]]' follows from a relation", name=name)
            yield Unfit("--set", "wrong-use", message, "set the parameters in it")
        elif not has_sign(value, signs[name]):
            sign = worded(str(signs[name]))
            message = Message("[[name]] is declared [[sign]], [[value]] is not", name=name, sign=sign, value=str(value))
            yield Unfit("--set", "sign-contradiction", message)
    if request.vary is not None:
        varied = request.vary.name
        if varied in request.values:
            message = Message("'[[name]]' has an interval and a number", name=varied)
            yield Unfit("--set", "repeated-name", message, "leave one of them out")
        names = [name for name in _lacking(system, request.values) if name != varied]
        if names:
            yield missing(names, "rational number")


def _known(system: System, values: Mapping[str, Fraction]) -> Mapping[str, Fraction]:
    from mbsym.mechanics.rest import given_values, rational_values

    return rational_values(given_values(system, values))


def _lacking(system: System, values: Mapping[str, Fraction]) -> Iterator[str]:
    from mbsym.mechanics.rest import missing_values

    yield from missing_values(system, _known(system, values))


@dataclass(frozen=True)
class AtValues:
    """What problem 11 says, at numbers where there are all, in parameters where it can; ``lacking`` have none."""

    analysis: Analysis
    forms: NormalForms
    lacking: tuple[str, ...]


def derive(context: Asked, request: Request, watch: Watch) -> AtValues | Along:
    if request.vary is None:
        watch("normal forms")
        return _at_values(context.system, request.values)
    from mbsym.analysis import Analysis
    from mbsym.analysis.judge import exceptional

    axis = request.vary
    watch(f"normal forms along {axis.name}")
    numbers = {name: x for name, x in _known(context.system, request.values).items() if name != axis.name}
    return exceptional(Analysis(context.system), axis.name, (axis.low, axis.high), numbers)


def _at_values(system: System, numbers: Mapping[str, Fraction]) -> AtValues:
    """Raises NotFit where there are neither all numbers nor formulas."""
    from mbsym.analysis import Analysis
    from mbsym.expressions.tree import number

    parameters = (
        replace(parameter, value=number(numbers[parameter.name])) if parameter.name in numbers else parameter
        for parameter in system.parameters
    )
    analysis = Analysis(replace(system, parameters=tuple(parameters)))
    with analysis.strictly():
        forms = analysis.normal_forms
        solved = {name for name, _ in analysis.equilibrium.solved}
    lacking = tuple(name for name in _lacking(system, numbers) if name not in solved)
    if forms.at_values is None and lacking and forms.in_symbols is None:
        raise NotFit([missing(lacking, "rational number")])
    return AtValues(analysis, forms, lacking if forms.at_values is None else ())


def answer(context: Asked, request: Request, derived: AtValues | Along) -> Answer:
    return Answer(_of_values(context, derived) if isinstance(derived, AtValues) else _along(derived))


def _of_values(context: Asked, at_values: AtValues) -> Iterator[Line | Block]:
    from mbsym.report.content import ragged
    from mbsym.report.words.normal_form_words import sentences

    yield from map(ragged, sentences(at_values.forms))
    if at_values.lacking:
        words = " ".join(f"--set {name}=NUMBER" for name in at_values.lacking)
        text = "At numbers nothing is said: there are none for [[names]].  Give them:"
        yield line("  ", Message(text, names=", ".join(at_values.lacking)))
        yield line(f"    mbsym nonlinear {context.file} {words}", whole=True)


def _along(along: Along) -> Iterator[Line]:
    from mbsym.report.words.exceptional_values import lines

    for text in lines(along):
        yield line("  ", text)


def as_json(context: Asked, request: Request, derived: AtValues | Along) -> str:
    """Along a parameter a document of its own, at values that of problem 11 in results.json."""
    if isinstance(derived, AtValues):
        from mbsym.report.results_json import render

        return render(derived.analysis, (11,))
    from mbsym.report.words.exceptional_values import as_text

    return as_text(context.system, derived)


def refusal(error: Exception, context: Asked, request: Request) -> Refusal | None:
    from mbsym.analysis.stages import Unavailable

    if isinstance(error, Unavailable) and request.vary is None:
        why = joined(filter(None, (error.reason, error.remedy)), "; ")
        return Refusal(Message("nothing decided: [[why]]", why=why))
    return failed(error, "nothing decided" if request.vary is None else "no values listed")


STUDY = Study(
    "nonlinear", Request, derive, answer, refusal, unfit, as_json,
    json_help="Print JSON; without --vary that of problem 11.",
    constraints=True, matrices=True, held=False, out=None, timed=True, letters=True,
)  # fmt: skip
