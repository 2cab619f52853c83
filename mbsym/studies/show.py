"""``mbsym show``: one formula to the screen, or into another program."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field
from typing import TYPE_CHECKING, Annotated, Any

from mbsym.expressions.message import Message, joined
from mbsym.expressions.safe import UNBROKEN, safe
from mbsym.model.scaling import Reducing, Scaling
from mbsym.report.language import Language
from mbsym.studies.request import Flag, Names, Parsed, Substitutions, Whole
from mbsym.studies.study import Answer, Apart, Asked, Exit, NotFit, Refusal, Study, Unfit, Watch

if TYPE_CHECKING:
    from mbsym.algebra.failures import Failure
    from mbsym.analysis import Analysis
    from mbsym.analysis.reducing import Reduced
    from mbsym.analysis.scaled import Formulas
    from mbsym.expressions.place import Complaints
    from mbsym.model.system import System
    from mbsym.report.formulas_by_name import Line

#: Equations of more characters, some screens, are printed only where they are asked for.
MOST_UNASKED = 8000

SCALE = "Dimensionless variables: x=L*x1,t=tau/omega0,k=m*omega0**2*kappa."
REDUCE = "Equations in fewer variables: r=1 by integrals; q by p; O(eps**3)."


def _scaling(text: str, system: System, complaints: Complaints) -> Scaling | None:
    from mbsym.source.scaling import read_scaling

    return read_scaling(text, system, complaints)


def _reducing(text: str, system: System, complaints: Complaints) -> Reducing | None:
    from mbsym.source.scaling import read_reduction

    return read_reduction(text, complaints)


@dataclass(frozen=True)
class Request:
    """Print formulas of FILE by their NAMEs: its equations of motion, or what is asked for.

    \b
    equations       M q'' - f = 0              T U L         energies
    accelerations   solved for q''             M f           of M q'' = f
    coriolis        c of M q'' + c + g = tau   gravity       g, of weights alone
    motion          does it satisfy them       constraints   in velocities
    M0 D G K N B    first approximation       A               x' = A x
    characteristic  polynomials                determinants  and what they come from
    conditions      of stability               integrals     first integrals
    eigenvalues     at the given values

    The name of a body or frame prints its place, its kinematics and its part of T, that of a coordinate (a speed) its
    equation, terms with accelerations first.  Equations that fill screens are printed where they are asked for by name.
    Without --latex, --wolfram or --python formulas are written as people write them: theta'' is the second derivative,
    a space multiplies.  Exit codes: 0 printed, 1 there is no such result, 2 something is wrong.

    --reduce prints the equations in fewer variables, step by step, each step checked in the original equations:

    \b
    r=1,h=1 by integrals   first integrals solved for r and h, which are 1 at first (exactly: without a value and O())
    q,s by p,h             the equations of p and h solved for q and s: equations of second order are left
    p=p1+eps*a,a=x/(1-b)   a change of variables, and letters that stand in it
    O(eps**3)              series in eps, without terms of this power

    \b
    Examples:
      mbsym show systems/spherical-pendulum.yaml --reduce "psi_dot by integrals"
      mbsym show systems/simple-pendulum.yaml
      mbsym show systems/double-pendulum.yaml T U equations
      mbsym show systems/satellite.yaml conditions --latex
      mbsym show systems/satellite.yaml determinants theta
      mbsym show systems/spring-pendulum.yaml --scale "r=l0*x,t=tau/omega0,k=m*omega0**2,g=l0*omega0**2*nu"
    """

    names: Annotated[tuple[str, ...], Names("[NAME]...", "", positional=True)] = ()
    _: KW_ONLY
    latex: Annotated[bool, Flag(None, "Write LaTeX.")] = False
    wolfram: Annotated[bool, Flag(None, "Write Wolfram Language.")] = False
    python: Annotated[bool, Flag(None, "Write Python, with the names of the description.")] = False
    values: Annotated[Mapping[str, Any], Substitutions("NAME=VALUE", "Replace a value; repeatable.", "-s", "--set")] = (
        field(default_factory=dict)
    )
    scale: Annotated[Scaling | None, Parsed("LIST", SCALE, read=_scaling)] = None
    reduce: Annotated[Reducing | None, Parsed("STEPS", REDUCE, read=_reducing)] = None
    terms: Annotated[int, Whole("N", "Longest formula that is derived.", most=10**12)] = 1_000_000

    @property
    def language(self) -> str:
        """In which formulas are written; "text" is for people."""
        return next((name for name in ("latex", "wolfram", "python") if getattr(self, name)), "text")


class Underived(Exception):
    """What an option asks for cannot be derived."""

    def __init__(self, option: str, failure: Failure) -> None:
        super().__init__(option)
        self.option, self.failure = option, failure


@dataclass(frozen=True)
class Shown:
    """The text, and what of it could not be derived, by name."""

    text: str
    failures: tuple[tuple[str, Failure], ...] = ()


@dataclass(frozen=True)
class _Source:
    """What formulas are taken from; ``given``: whose letters those are in that no description can hold."""

    given: System
    analysis: Analysis
    formulas: Formulas | None = None
    reduction: Reduced | None = None

    @property
    def system(self) -> System:
        if self.reduction is not None:
            return self.reduction.system
        return self.given if self.formulas is not None else self.analysis.system

    def lines(self, name: str) -> list[Line]:
        """Raises Failure."""
        from mbsym.report.formulas_by_name import carried_lines, lines, reduced_lines

        if self.reduction is not None:
            return list(reduced_lines(self.reduction))
        return list(lines(self.analysis, name) if self.formulas is None else carried_lines(self.formulas, name))


def unfit(context: Asked, request: Request) -> Iterator[Unfit]:
    if "reduce" in context.typed and request.names:
        yield Unfit("--reduce", "not-both", "the reduction prints what it finds, and no NAMEs", "leave them out")


def derive(context: Asked, request: Request, watch: Watch) -> Shown:
    """Raises Underived, NotFit for names that there are not."""
    from mbsym.algebra.failures import Failure
    from mbsym.report.formulas_by_name import beside_state_space, given_names, known_names, remarked, written
    from mbsym.report.letters import in_letters, letters_of
    from mbsym.report.plain_writer import Writer

    source, language, say = _source(context, request, watch), request.language, Language(context.system.language).say
    usual = ("equations",) if source.system.linear is None else ("M0", "D", "G", "K", "N")
    asked = beside_state_space(request.names, source.system)
    if not {*asked} <= {*given_names(source.analysis)}:
        known = known_names(source.analysis)
        unknown = [name for name in asked if name not in known]
        if unknown:
            raise NotFit([_unknown(name, known) for name in unknown])
    # Other programs know no letters, unless somebody asks for them.
    letters = () if context.letters is None and language in ("python", "wolfram") else context.letters
    texts: list[str] = []
    failures: list[tuple[str, Failure]] = []
    with in_letters(source.system, letters) as used:
        for name in asked or usual:
            watch(f"deriving {name}")
            try:
                lines = source.lines(name)
                formulas = [written(line, language, say) for line in lines]
            except Failure as error:
                failures.append((name, error))
                continue
            length = sum(map(len, formulas))
            unasked = not request.names and source.reduction is None and language == "text" and name == "equations"
            if unasked and length > MOST_UNASKED:
                many = "equations: [[count]], of [[length]] characters together; one of them, or all:"
                command = f"  mbsym show {context.file}"
                last = known_names(source.analysis)[-1]
                texts = [say(Message(many, count=len(lines), length=length)), f"{command} {last}"]
                return Shown(_joined([*texts, f"{command} {name}"]))
            for line, formula in zip(lines, formulas, strict=True):
                texts += [remarked(safe(say(line.remark)), language)] if line.remark else []
                texts.append(formula)
    if used:
        texts.append(remarked(say("where"), language))
        definitions = letters_of(source.system).definitions(used)
        writer = Writer(readable=language == "text")
        inline = (f"{name} = {writer.inline(value)}".replace(UNBROKEN, " ") for name, value in definitions)
        texts += [remarked(definition, language) for definition in inline]
    return Shown(_joined(texts), tuple(failures))


def _joined(lines: Sequence[str]) -> str:
    return "".join(f"{line}\n" for line in lines)


def _source(context: Asked, request: Request, watch: Watch) -> _Source:
    """The system as it is, in other variables, or reduced."""
    from mbsym.algebra.failures import Failure
    from mbsym.analysis import Analysis
    from mbsym.analysis.scaled import Formulas, NoDescription
    from mbsym.studies.groups import in_scale

    system, formulas = context.system, None
    if request.scale is not None:
        watch("scaling")
        try:
            system = in_scale(system, request.scale)
        except NoDescription:
            formulas = Formulas(system, request.scale, request.terms)
        except Failure as error:
            raise Underived("--scale", error) from error
    analysis = Analysis(system, terms=request.terms) if formulas is None else formulas.analysis
    if request.reduce is None:
        return _Source(system, analysis, formulas)
    from mbsym.analysis.reducing import reduced

    watch("reducing")
    try:
        return _Source(system, analysis, formulas, reduced(analysis, request.reduce, formulas, system.claims))
    except Failure as error:
        raise Underived("--reduce", error) from error


def _unknown(name: str, known: Sequence[str]) -> Unfit:
    from difflib import get_close_matches

    from mbsym.report.formulas_by_name import named_by

    near, meant = get_close_matches(name, known, 1), named_by(name)
    hint = Message("there are [[names]]", names=", ".join(known))
    if meant:
        hint = Message("by its name here: [[names]]", names=", ".join(meant))
    elif near:
        hint = Message("did you mean '[[other]]'?", other=near[0])
    return Unfit("NAME", "unknown-name", Message("nothing is called '[[name]]' here", name=name), hint)


def answer(context: Asked, request: Request, shown: Shown) -> Answer:
    from mbsym.algebra.failures import message_of

    complaints = [joined((name, message_of(error)), ": ") for name, error in shown.failures]
    code = Exit.FAILED if complaints else Exit.OK
    return Answer(text=shown.text, breaks=request.language == "text", complaints=complaints, code=code)


def refusal(error: Exception, context: Asked, request: Request) -> Refusal | None:
    from mbsym.algebra.failures import message_of

    if isinstance(error, Underived):
        return Refusal(joined((error.option, message_of(error.failure)), ": "))
    return None


#: Formulas are written in one language.
PAIRS = [
    Apart(one, other, "they exclude each other")
    for one, other in (("--latex", "--wolfram"), ("--latex", "--python"), ("--wolfram", "--python"))
]

STUDY = Study(
    "show", Request, derive, answer, refusal, unfit, constraints=True, matrices=True, held=False, free=True, out=None,
    letters=True, pairs=PAIRS,
)  # fmt: skip
