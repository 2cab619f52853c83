"""``mbsym oscillations``: periodic solutions in powers of a small parameter, by Lindstedt and Poincare."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import KW_ONLY, dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Annotated

from mbsym.expressions.message import Message
from mbsym.studies.expand import stays_a_symbol
from mbsym.studies.request import ExactSettings, Text, Whole, formats, language
from mbsym.studies.study import DESCRIPTION, Answer, Asked, Exit, Folder, Refusal, Study, Unfit, Watch, failed, refused

if TYPE_CHECKING:
    from mbsym.analysis.oscillating import Oscillating
    from mbsym.expressions.place import Complaints
    from mbsym.model.system import System
    from mbsym.report.content import Paragraph
    from mbsym.simulation.oscillating import MeasuredOrders
    from mbsym.source.scaling import Item

FORMATS = ("svg", "pdf", "png")

_ROOTED = (
    "The rates that were given for [[names]] are those of these coordinates with one sign of their square roots "
    "(proved); here roots of squares of the amplitude are the amplitude."
)

#: Said of options of figures where there are none.
UNWRITTEN = ("wrong-use", "nothing is written without --format", "add --format png")


def symbols(system: System) -> tuple[str, ...]:
    """Names that a result may have beside the parameters."""
    from mbsym.model.oscillation_names import AMPLITUDE

    variables = (*system.coordinates, *system.velocities, *system.variables)
    return (AMPLITUDE, *(f"{name}_0" for name in variables), *(f"{AMPLITUDE}_{name}" for name in variables))


@dataclass(frozen=True)
class Request:
    """Find periodic motions of FILE near those of its linear part, in powers of a small parameter, exactly.

    The method of Poincare and Lindstedt: frequencies are corrected so that no secular terms remain; where that is
    possible for some amplitudes only, or not at all, that is told.  --of names the variable that leads; of several, as
    in --of p,gamma1, each leads a frequency of its own, and the motion has as many phases.  FILE names the small
    parameter ('small parameter: eps', or powers of it in parameters and variables); without it, the deviations from the
    unperturbed motion are small, of order eps.  Coefficients hold the parameters, the amplitude and the values that
    stay constant without eps; resonances that were divided by are listed, and what is left out.

    With --integral formulas in variables are integrated over the time, too: angles that the equations do not need, from
    their rates.  Under the name of a coordinate its rate is checked.

    With --scale they are written in variables of yours, as 'mbsym convert --scale' has them, with powers of the small
    parameter before them; symbols of the solution, such as r_0, may stand in factors.

    The series are put into the equations exactly.  Where FILE has numbers, their error is measured against runs at
    parts of eps.  Figures show the series and a simulation from the same state over three periods: oscillation (over
    time), oscillation-planes (each variable and its rate), and oscillation-angles where FILE has speeds.

    Exit codes: 0 found and checked; 1 there is no such solution, or none was found within the budget; 2 something is
    wrong.

    \b
    Examples:
      mbsym oscillations systems/spring-pendulum.yaml --of theta
      mbsym oscillations systems/double-pendulum.yaml --of theta1 --frequency 2
      mbsym oscillations systems/spring-pendulum.yaml --of theta,x
      mbsym oscillations systems/gyrostat-fast.yaml --order 2
      mbsym oscillations systems/gyrostat-fast.yaml --set lx=0 --json
      mbsym oscillations systems/gyrostat-fast.yaml --order 1 --scale "p=r_0*p1,q=r_0*q1,A=a*C,B=b*C,lx=y1*C*r_0"
      mbsym oscillations systems/gyrostat-fast.yaml --order 1 --integral "psi=(p*gamma1+q*gamma2)/(gamma1**2+gamma2**2)"
      mbsym oscillations systems/gyrostat-fast.yaml --format png --out figures
    """

    _: KW_ONLY
    order: Annotated[int, Whole("N", "Up to this power.", "-n", most=8)] = 2
    of: Annotated[str | None, Text("NAMES", "The variable whose oscillation leads, or several: p,gamma1.")] = None
    frequency: Annotated[int, Whole("K", "Of several that it shares with others, the K-th.", most=99, shown=False)] = 1
    values: Annotated[
        Mapping[str, Fraction], ExactSettings("NAME=VALUE", "Put in a number; repeatable.", "-s", "--set", more=symbols)
    ] = field(default_factory=dict)
    scale: Annotated[str | None, Text("LIST", "Dimensionless variables and parameters: p=r_0*p1,t=tau/r_0,A=a*C.")] = (
        None
    )
    integral: Annotated[str | None, Text("LIST", "Integrals over the time, by their rates: psi=q*gamma1,s=x*y.")] = None
    format: Annotated[tuple[str, ...], formats("Draw figures: svg, pdf, png.", FORMATS)] = ()
    language: Annotated[str | None, language("Of figures")] = None


def _leading(request: Request) -> tuple[str, ...]:
    return tuple(map(str.strip, (request.of or "").split(","))) if request.of else ()


def unfit(context: Asked, request: Request) -> Iterator[Unfit]:
    system = context.system
    small = system.small
    if small is None and (not system.motion or system.speeds):
        hint = "add 'small parameter: eps'"
        yield Unfit(DESCRIPTION, "missing-key", "the description names no small parameter", hint)
    known = (*system.coordinates, *system.velocities, *system.variables)
    for leading in (name for name in _leading(request) if name not in known):
        message = Message("there is no variable called [[name]]", name=repr(leading[:60]))
        yield Unfit("--of", "unknown-name", message, Message("there are [[names]]", names=", ".join(known)))
    for name in request.values:
        if small is not None and (name == small.name or name in {*dict(small.powers)} - {*system.parameter_names}):
            yield stays_a_symbol(name)
    if request.scale is not None:
        yield from _unscaled(request.scale, system)
    if request.integral is not None:
        yield from _no_rates(request.integral, system)
    if "language" in context.typed and "format" not in context.typed:
        yield Unfit("--language", *UNWRITTEN)


def _unscaled(text: str, system: System) -> Iterator[Unfit]:
    """What is wrong with a scaling."""
    from mbsym.expressions.place import Complaints
    from mbsym.source.scaling import read_scaling

    complaints = Complaints()
    scaling = read_scaling(text, system, complaints)
    for complaint in complaints.sorted():
        yield Unfit("--scale", complaint.code, complaint.message, complaint.hint)
    if scaling is not None and system.small is not None and system.small.name in scaling.new:
        hint = "the series are in its powers, which stand before what is scaled"
        yield Unfit(
            "--scale", "misplaced-name", Message("[[name]] is the small parameter", name=system.small.name), hint
        )


def _rates(text: str, complaints: Complaints) -> dict[str, Item]:
    """Formulas by the names of their integrals."""
    from mbsym.source.scaling import assignments

    return {assignment.name: assignment for assignment in assignments(text, complaints)}


def _no_rates(text: str, system: System) -> Iterator[Unfit]:
    """What is wrong with integrals that are asked for."""
    from mbsym.expressions.parser import ascii_safe
    from mbsym.expressions.place import Complaints
    from mbsym.expressions.tree import names
    from mbsym.source.scope import did_you_mean, listed, why_no_name

    complaints = Complaints()
    rates = _rates(text, complaints)
    for complaint in complaints.sorted():
        yield Unfit("--integral", complaint.code, complaint.message, complaint.hint)
    variables = (*system.coordinates, *system.velocities, *system.variables)
    known = (*variables, *system.parameter_names)
    for name, item in rates.items():
        if item.bare:
            hint = Message("for example [[example]]", example="s=x*y")
            yield Unfit("--integral", "no-rate", Message("[[name]] has no rate", name=ascii_safe(name)), hint)
            continue
        reason = None if name in system.coordinates else why_no_name(name)
        if reason is None and name in {*known, *symbols(system)} - {*system.coordinates}:
            reason = "the description has it", "what is put in holds parameters and new names"
        if reason is not None:
            message = Message("[[name]] cannot be a new name: [[reason]]", name=ascii_safe(name), reason=reason[0])
            yield Unfit("--integral", "bad-name", message, reason[1])
        for other in sorted(names(item.value) - {*known}):
            message = Message("there is no variable called [[name]]", name=repr(other[:60]))
            yield Unfit("--integral", "unknown-name", message, did_you_mean(other, known) or listed("there are", known))


@dataclass(frozen=True)
class Found:
    """The solution, and the order of its error; why that was not measured where it was not.

    ``oscillating``: the solution in variables that were asked for, if any were.
    """

    solution: Oscillating
    measured: MeasuredOrders | str
    oscillating: Oscillating


def derive(context: Asked, request: Request, watch: Watch) -> Found:
    from mbsym.analysis import Analysis
    from mbsym.analysis.oscillating import in_variables, oscillating, with_integrals
    from mbsym.expressions.place import Complaints
    from mbsym.report.words.expansion_measured import orders_or_why
    from mbsym.source.scaling import read_scaling

    watch("oscillations")
    analysis = Analysis(context.system).in_free_coordinates
    solution = oscillating(analysis, request.order, request.values, _leading(request), request.frequency)
    watch("measuring")
    measured = orders_or_why(analysis.system, solution, request.values)
    if request.integral is not None:
        rates = {name: item.value for name, item in _rates(request.integral, Complaints()).items()}
        solution = with_integrals(solution, analysis, rates)
    if request.scale is None:
        return Found(solution, measured, solution)
    scaling = read_scaling(request.scale, context.system, Complaints())
    assert scaling is not None  # ``unfit`` has seen it
    return Found(solution, measured, in_variables(solution, context.system, scaling))


def answer(context: Asked, request: Request, derived: Found) -> Answer:
    from mbsym.report.sections.small_parameters import of_wave

    files, reason = _figures(context.system, request, derived.solution) if request.format else ({}, "")
    complaints = (f"no figures: {reason}",) if reason else ()
    lines = [*of_wave(derived.oscillating, derived.measured), *_checked(context.system, request)]
    return Answer(lines, files, complaints, Exit.FAILED if reason else Exit.OK)


def _checked(system: System, request: Request) -> Iterator[Paragraph]:
    """What is known of the rates of coordinates."""
    from mbsym.expressions.place import Complaints
    from mbsym.expressions.tree import Call, walk
    from mbsym.report.content import named, ragged, say

    plain: list[str] = []
    rooted: list[str] = []
    for name, item in _rates(request.integral or "", Complaints()).items():
        if name in system.coordinates:
            roots = any(isinstance(x, Call) and x.function == "sqrt" for x in walk(item.value))
            (rooted if roots else plain).append(name)
    if plain:
        yield ragged(
            say("The rates that were given for [[names]] are those of these coordinates (proved).", names=named(plain))
        )
    if rooted:
        yield ragged(say(_ROOTED, names=named(rooted)))


def _figures(system: System, request: Request, solution: Oscillating) -> tuple[dict[str, str | bytes], str]:
    """Files by their names, or why there are none."""
    from mbsym.algebra.failures import Failure
    from mbsym.numerics.scenario import Incomplete
    from mbsym.report.figures.oscillation_figure import oscillation_figures
    from mbsym.report.language import Language
    from mbsym.report.words.expansion_measured import DIVIDED, NO_NUMBERS
    from mbsym.simulation.oscillation_paths import oscillation_paths

    try:
        paths = oscillation_paths(system, solution, request.values)
        drawn = oscillation_figures(
            system, paths, solution.oscillation, request.format, Language(request.language or system.language)
        )
    except Incomplete:
        return {}, NO_NUMBERS
    except ZeroDivisionError:
        return {}, DIVIDED
    except (Failure, ValueError, OverflowError) as error:
        return {}, str(error)
    return dict(sorted(drawn.items())), ""


def as_json(context: Asked, request: Request, derived: Found) -> str:
    from mbsym.report.oscillation_json import oscillations_json

    return oscillations_json(context.system, request.values, derived.oscillating, derived.measured)


def refusal(error: Exception, context: Asked, request: Request) -> Refusal | None:
    if isinstance(error, ZeroDivisionError):
        return refused("no periodic solution", error, Exit.BAD_INPUT)
    return failed(error, "no expansion")


STUDY = Study(
    "oscillations", Request, derive, answer, refusal, unfit, as_json, "Print JSON instead of text.",
    constraints=True, held=False, out=Folder(quiet=None, unwritten=UNWRITTEN), writes=lambda typed: "format" in typed,
    letters=True,
)  # fmt: skip
