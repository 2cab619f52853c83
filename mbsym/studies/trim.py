"""``mbsym trim``: inputs or parameters that make the described motion one of the system."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import KW_ONLY, dataclass, replace
from typing import TYPE_CHECKING, Annotated

from mbsym.expressions.message import Message
from mbsym.expressions.tree import text
from mbsym.report.content import Block, Strong, Subheading, paragraph
from mbsym.studies.described import Source, analysis_of, public
from mbsym.studies.request import Names
from mbsym.studies.study import DESCRIPTION, Answer, Asked, Exit, Refusal, Study, Unfit, Watch, failed

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.model.system import Input, System
    from mbsym.problems.trim import Trim


@dataclass(frozen=True)
class Request:
    """Find the inputs, or parameters, with which FILE's unperturbed motion (motion:) satisfies the equations.

    In symbols: the torque that holds a linkage in a posture, the preload of a suspension.  All that is asked for has to
    enter the equations linearly; constraints are taken into account.  What the motion has to satisfy whatever their
    values is told besides, and so is what is divided by.

    Exit codes: 0 found, 1 there are no such values (the reason is given), 2 something is wrong.

    \b
    Examples:
      mbsym trim systems/cart-pole.yaml
      mbsym trim systems/spring-pendulum.yaml --solve l0
    """

    _: KW_ONLY
    solve: Annotated[tuple[str, ...], Names("NAME", "An input or parameter; repeatable.  [default: all inputs]")] = ()


def unfit(context: Asked, request: Request) -> Iterator[Unfit]:
    system = context.system
    names = (*system.input_names, *system.parameter_names)
    for name in request.solve or ():
        if name not in names:
            message = Message("there is no input or parameter '[[name]]'", name=name)
            yield Unfit(
                "--solve", "unknown-name", message, Message("there are [[names]]", names=", ".join(names)), name
            )
        elif name in {item.name for item in system.relations}:
            yield Unfit("--solve", "misplaced-name", Message("'[[name]]' follows from a relation", name=name), "", name)
    if not request.solve and not system.inputs:
        message = Message("the system has no inputs")
        yield Unfit(DESCRIPTION, "no-inputs", message, "add --solve NAME of a parameter")


def _asked(source: Source, request: Request) -> Asked:
    """The system with its inputs, which are looked for."""
    from mbsym.analysis.given import refuse_matrices
    from mbsym.mechanics.variables import settled

    system = settled(analysis_of(source).system)
    refuse_matrices(system, "no posture is held")
    for reason in unfit(Asked(system), request):
        raise ValueError(reason.message)
    return Asked(system)


@public(Request, _asked)
def trim(context: Asked, request: Request, watch: Watch) -> Trim:
    """Inputs or parameters with which the described motion satisfies the equations: ``mbsym trim``.

    Raises DescriptionError, ``mbsym.algebra.failures.Failure``.
    """
    from mbsym.problems.trim import trim as found_of

    watch("deriving")
    analysis = _with_letters(context.system, request.solve)
    unknowns = request.solve or context.system.input_names
    equilibrium = analysis.equilibrium
    if equilibrium.unsteady:
        from mbsym.algebra.failures import NoClosedForm

        message = Message("the equations vary with [[names]] on this motion", names=", ".join(equilibrium.unsteady))
        raise NoClosedForm(message)
    assumed = [x.polynomial for x in analysis.reduced.about.assumed]
    residuals = [x.polynomial for x in equilibrium.residuals]
    return found_of(analysis.parameters_scene, residuals, unknowns, analysis.signs, assumed)


def _with_letters(system: System, solve: Collection[str]) -> Analysis:
    """The system whose inputs are parameters, but for those that are held and not asked for."""
    from mbsym.analysis import Analysis
    from mbsym.expressions.tree import Name
    from mbsym.model.substitution import driven
    from mbsym.model.system import Parameter

    inputs = [system_input for system_input in system.inputs if not solve or system_input.name in solve]
    laws = {system_input.name: Name(system_input.name) for system_input in inputs}
    letters = tuple(Parameter(system_input.name, meaning=system_input.meaning) for system_input in inputs)
    return Analysis(replace(driven(system, laws), parameters=(*system.parameters, *letters)), ())


def answer(context: Asked, request: Request, trimmed: Trim) -> Answer:
    held = [signal for signal in context.system.inputs if request.solve and signal.name not in request.solve]
    acting = (
        () if trimmed.impossible else [(name, x) for name, x in trimmed.solved if name in context.system.input_names]
    )
    written = ", ".join(f"{name}: {x.text()}" for name, x in acting if not x.is_zero)
    return Answer(_lines(trimmed, held, written), code=Exit.FAILED if trimmed.impossible else Exit.OK)


def _lines(trimmed: Trim, held: Sequence[Input], written: str) -> Iterator[Block]:
    if trimmed.impossible and trimmed.assumed:
        yield paragraph(Strong(Message("no values make this motion one of the system, where no divisor is 0")))
    elif trimmed.impossible:
        yield paragraph(Strong(Message("no values make this motion one of the system")))
    for name, value in trimmed.solved if not trimmed.impossible else ():
        yield paragraph(Message("[[name]] = [[value]]", name=name, value=value))
    for name in trimmed.free if not trimmed.impossible else ():
        yield paragraph(Message("[[name]]: any value", name=name))
    for title, several in (
        (Message("divided by, not to be 0"), [f"{x} != 0" for x in trimmed.assumed]),
        (Message("demanded by the declared signs"), [f"{name} = {x} {sign} 0" for name, x, sign in trimmed.signed]),
        (Message("the motion itself has to satisfy"), [f"{x} = 0" for x in trimmed.conditions]),
        (Message("held at their values on the motion"), [f"{signal.name} = {text(signal.held)}" for signal in held]),
        (Message("in the description"), [f"motion: {{..., {written}}}"] if written else []),
    ):
        if several:
            yield Subheading((title,))
        for line in several:
            yield paragraph("  ", line)


def refusal(error: Exception, context: Asked, request: Request) -> Refusal | None:
    return failed(error, "no values found")


def as_json(context: Asked, request: Request, trimmed: Trim) -> str:
    from mbsym.report.documents.base import file_of
    from mbsym.report.documents.parameters import Trim as Document

    return file_of(Document, context.system, trimmed)


STUDY = Study("trim", Request, trim.derive, answer, refusal, unfit, as_json, constraints=True, held=False, out=None)
