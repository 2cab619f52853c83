"""``mbsym equilibria``: all relative equilibria of a system at numbers, each with its stability, or branches of them.

The list is told in ``listed.py``, branches over a parameter in ``branches.py``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import KW_ONLY, dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Annotated, Any, cast

from mbsym.expressions.message import Message
from mbsym.maps.axis import Axis
from mbsym.studies.request import Assignments, Number, Range, formats, language
from mbsym.studies.section import against_sign, unless_parameter
from mbsym.studies.study import Answer, Asked, Folder, Refusal, Study, Unfit, Watch, failed, missing, refused

if TYPE_CHECKING:
    from mbsym.expressions.tree import Expression
    from mbsym.maps.branches_result import Branches
    from mbsym.mechanics.rest import Value
    from mbsym.model.system import System
    from mbsym.problems.relative_equilibria.equilibria import Equilibria
    from mbsym.problems.relative_equilibria.permanent_rotations import PermanentRotations

FORMATS = ("svg", "pdf", "png", "json", "tex")

#: Said of options of files where there are none.
UNWRITTEN = ("needs-vary", "files are written of branches only", "add --vary NAME=LOW:HIGH")


@dataclass(frozen=True)
class Request:
    """List all relative equilibria of FILE: constant coordinates, steady turns as given, prescribed motions running.

    Needs a number for every parameter, from the description (values:) or from --set, taken exactly.  Where the
    equations are polynomials in sines and cosines the solution is exact; elsewhere each equilibrium is proved to exist
    in a small box.  The list says whether it is complete.  Orientations behind the singularity of the description's
    angles are found with other angles.  Each equilibrium is judged as in problem 6.  Under constraints the
    reactions are eliminated, whatever the rank of the constraints, and singular positions are told as such.  Where
    constraints tie velocities (rolling) steady motions go along the symmetries of the system, a bicycle's circles too:
    rates that the description leaves out follow and are listed (yaw_dot).  For a body about a fixed point the axes and
    rates of all permanent rotations are printed besides (Staude's cone).

    With --vary a parameter runs through an interval: how many equilibria there are between exact critical values,
    where branches fold, cross or split (named by exact derivatives), and how stable each is.  Written are branches.svg,
    branches.pdf, branches.png, branches.json and branches.tex (to \\input).

    Exit codes: 0 listed, 1 they cannot be listed (the reason is given), 2 something is missing or wrong,
    130 interrupted.

    \b
    Examples:
      mbsym equilibria systems/gravity-gradient.yaml
      mbsym equilibria systems/double-pendulum.yaml --set m2=3/2 --json
      mbsym equilibria systems/orbital-gyrostat.yaml --vary h=0:10
    """

    _: KW_ONLY
    values: Annotated[Mapping[str, Any], Assignments("NAME=VALUE", "Replace a value; repeatable.", "-s", "--set")] = (
        field(default_factory=dict)
    )
    within: Annotated[float, Number("X", "Where lengths are looked for, if not solved exactly.", most=1e6)] = 10.0
    vary: Annotated[
        Axis | None, Range("NAME=LOW:HIGH", "Branches over one parameter: counts, bifurcations, stability.")
    ] = None
    format: Annotated[tuple[str, ...], formats("With --vary, files to write.", FORMATS, usual=",".join(FORMATS))] = ()
    language: Annotated[str | None, language("With --vary, of picture and branches.tex")] = None

    @property
    def files(self) -> tuple[str, ...]:
        return self.format or FORMATS

    @property
    def varied(self) -> str:
        return "" if self.vary is None else self.vary.name


def unfit(context: Asked, request: Request) -> Iterator[Unfit]:
    from mbsym.mechanics.rest import missing_values

    system = context.system
    if "vary" not in context.typed:
        for name in ("format", "language"):
            if name in context.typed:
                yield Unfit(f"--{name}", *UNWRITTEN)
    elif request.vary is None:
        return
    else:
        yield from unless_parameter("--vary", request.varied, system)
        if request.varied in request.values:
            message = Message("'[[name]]' has an interval and a number", name=request.varied)
            yield Unfit("--set", "repeated-name", message, "leave one of them out")
        yield from against_sign("--vary", request.vary, system)
    overrides: dict[str, Value] = {}
    for name, value in _exact(request, system):
        if isinstance(value, Unfit):
            yield value
        else:
            overrides[name] = value
    yield from _contradictions(system, request, overrides)
    lacking = [name for name in missing_values(system, _numbers(system, request)) if name not in request.values]
    if lacking := [name for name in lacking if name != request.varied]:
        yield missing(lacking, "rational number" if request.vary is not None else "number")


def _exact(request: Request, system: System) -> Iterator[tuple[str, Value | Unfit]]:
    """The exact number that each setting is, or why it is none."""
    from mbsym.expressions.tree import names as names_in
    from mbsym.expressions.tree import substitute
    from mbsym.model.system import rational

    sound: dict[str, Expression] = {name: value for name, value in request.values.items() if value is not None}
    known = {item.name: item.value for item in system.parameters if item.value is not None} | sound
    for name, expression in sound.items():
        if name not in system.parameter_names:
            reason, hint = "equilibria are what is looked for", "set parameters only"
            yield name, Unfit("--set", "misplaced-name", reason, hint, name)
            continue
        whole = substitute(expression, {k: v for k, v in known.items() if k != name})
        value = rational(whole)
        if value is None and (request.vary is not None or names_in(whole)):
            reason = "an exact rational number is needed"
            hint = Message("write for example [[example]]", example=f"{name}=3/2")
            yield name, Unfit("--set", "not-rational", reason, hint, name)
        else:
            yield name, whole if value is None else value


def _contradictions(system: System, request: Request, overrides: Mapping[str, Value]) -> Iterator[Unfit]:
    """Values that contradict a sign or a relation."""
    from mbsym.numerics.scenario import Incomplete, scenario

    try:
        scenario(system, {name: request.values[name] for name in overrides}, state=False)
    except Incomplete as error:
        for contradiction in error.lack.contradictions:
            if contradiction.name in request.values:
                yield Unfit("--set", contradiction.code, contradiction.text, contradiction.hint, contradiction.name)


def _numbers(system: System, request: Request) -> Mapping[str, Value]:
    """Exact numbers of the parameters but the varied one; along one the equations are eliminated over QQ."""
    from mbsym.mechanics.rest import given_values, rational_values

    overrides = {name: value for name, value in _exact(request, system) if not isinstance(value, Unfit)}
    values: Mapping[str, Value] = given_values(system, overrides)
    if request.vary is not None:
        values = dict(rational_values(values))
    return {name: value for name, value in values.items() if name != request.varied}


@dataclass(frozen=True)
class Listed:
    """The list at numbers, and the permanent rotations about a fixed point."""

    equilibria: Equilibria
    permanent: PermanentRotations | None


def derive(context: Asked, request: Request, watch: Watch) -> Listed | Branches:
    from mbsym.analysis.resting import relative_equilibria
    from mbsym.problems.relative_equilibria.permanent_rotations import permanent_rotations
    from mbsym.studies.equilibria.branches import followed

    values = _numbers(context.system, request)
    if request.vary is not None:
        return followed(context.system, request.vary, cast("Mapping[str, Fraction]", values), watch)
    watch("relative equilibria")
    equilibria = relative_equilibria(context.system, values, request.within)
    return Listed(equilibria, permanent_rotations(context.system, values))


def answer(context: Asked, request: Request, derived: Listed | Branches) -> Answer:
    from mbsym.studies.equilibria import branches
    from mbsym.studies.equilibria.listed import lines

    if isinstance(derived, Listed):
        return Answer(lines(context.system, derived.equilibria, derived.permanent))
    return branches.answer(context.system, request, derived)


def as_json(context: Asked, request: Request, derived: Listed | Branches) -> str:
    from msgspec import UNSET

    from mbsym.expressions.tree import text
    from mbsym.model.quantities import units_by_name
    from mbsym.report.documents import equilibria as doc
    from mbsym.report.documents.base import file_of

    assert isinstance(derived, Listed)
    values = _numbers(context.system, request)
    return file_of(
        doc.Equilibria,
        context.system,
        derived.equilibria,
        units=units_by_name(context.system) or UNSET,
        values={name: x if isinstance(x, Fraction) else text(x) for name, x in values.items()},
        permanent_rotations=derived.permanent,
    )


def refusal(error: Exception, context: Asked, request: Request) -> Refusal | None:
    from mbsym.studies.equilibria.branches import Withdrawn

    if isinstance(error, Withdrawn):
        return refused("no branches", error)
    return failed(error, "no equilibria listed" if request.vary is None else "no branches")


STUDY = Study(
    "equilibria", Request, derive, answer, refusal, unfit, as_json,
    constraints=True, timed=True, writes=lambda typed: "vary" in typed,
    out=Folder(
        "With --vary, print nothing but complaints.", UNWRITTEN, "With --vary, folder.  [default: reports/NAME]",
        alone=("with-vary", "branches are written to a file", "use --format json"),
    ),
)  # fmt: skip
