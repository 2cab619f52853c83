"""``mbsym orbit``: a periodic motion near a guess, with its Floquet multipliers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import KW_ONLY, dataclass, field
from typing import TYPE_CHECKING, Annotated

from mbsym.expressions.message import Message
from mbsym.studies.closing import closed_motion, not_closed
from mbsym.studies.described import public
from mbsym.studies.request import Named, Names, Number, Values, Word
from mbsym.studies.study import Answer, Asked, Folder, Refusal, Study, Unfit, Watch, no_program, refused

if TYPE_CHECKING:
    from mbsym.simulation.motions import PeriodicMotion

#: What may be kept while the orbit is sought.
KEPT = ("auto", "energy", "period", "nothing")

#: What is said without a period.
ABSENT = (Message("the period to begin with is not said"), Message("for example --period 2"))


@dataclass(frozen=True)
class Request:
    """Find a periodic motion of FILE near its initial state and near the period T, by shooting.

    Newton's method with the exact derivative of the flow.  The initial state (initial:, --set) is the guess.  --keep
    says what stays as the guess has it: its energy, the period, or nothing; auto keeps the energy where it is conserved
    and the period where the equations know the time (T must then be a period of theirs).

    Told are the state, the period, how well the motion closes by the method that found it and by another one, and the
    Floquet multipliers with those that are 1 for a reason.  With constraints states are led to them, and multipliers
    are those of changes that they allow.  Numbers, no proofs.  Written are orbit.csv (one period) and orbit.json.

    What rolls in a circle does not come back by whole revolutions of its spin, on which nothing depends: --shifted.

    Exit codes: 0 found, 1 not found or not written, 2 something is missing or wrong, 130 interrupted.

    \b
    Examples:
      mbsym orbit systems/double-pendulum.yaml --period 2.6 --set theta1=0.3 --set theta2=0.12
      mbsym orbit systems/spherical-pendulum.yaml --period 1.57 --turns psi=1 --set psi_dot=4 --set theta=0.9
    """

    period: Annotated[float, Number("T", "The period, about (2.6, 2*pi).", "-T", absent=ABSENT)]
    _: KW_ONLY
    values: Values = field(default_factory=dict)
    keep: Annotated[str, Word(f"[{'|'.join(KEPT)}]", "", choices=KEPT)] = "auto"
    turns: Annotated[
        Mapping[str, int],
        Named("NAME=N", "This angle comes back turned by N revolutions.", least=-1000, most=1000, example="psi=1"),
    ] = field(default_factory=dict)
    shifted: Annotated[
        tuple[str, ...],
        Names("NAME", "This coordinate, on which nothing depends, comes back changed by anything; repeatable."),
    ] = ()


def unfit(context: Asked, request: Request) -> Iterator[Unfit]:
    system = context.system
    for option, names in (("--turns", request.turns), ("--shifted", request.shifted)):
        for name in names:
            if name not in system.coordinates:
                message = Message("there is no coordinate [[name]]", name=repr(name))
                yield Unfit(
                    option, "unknown-name", message, Message("there are [[names]]", names=", ".join(system.coordinates))
                )


@public(Request)
def orbit(context: Asked, request: Request, watch: Watch) -> PeriodicMotion:
    """A periodic motion near the initial state and near ``period``: ``mbsym orbit``.

        >>> import mbsym
        >>> found = mbsym.orbit("systems/double-pendulum.yaml", 2.6, values={"theta1": 0.3, "theta2": 0.12})
        >>> found.orbit.multipliers.shape, found.states.shape
        ((4,), (4, 421))

    Raises DescriptionError, ValueError, ``mbsym.numerics.orbits.periodic.NotFound``.
    """
    from mbsym.simulation.motions import find_orbit

    def at(step: int, size: float) -> None:
        watch(f"step {step}, {size:.1e} left over")

    watch("compiling")
    return find_orbit(
        closed_motion(context.motion)[0], request.period, request.keep, request.turns, at, request.shifted
    )


def answer(context: Asked, request: Request, motion: PeriodicMotion) -> Answer:
    from mbsym.report.content import facts
    from mbsym.report.runs.orbit_files import orbit_csv, orbit_json, sentences

    return Answer(
        [facts(sentences(motion))],
        {"orbit.csv": orbit_csv(motion), "orbit.json": orbit_json(motion)},
        closed_motion(context.motion)[1],
    )


def refusal(error: Exception, context: Asked, request: Request) -> Refusal | None:
    from mbsym.numerics.orbits.periodic import NotFound

    if isinstance(error, NotFound):
        return refused("no periodic motion was found", error)
    return not_closed(error, context.system) or no_program(error, context, request)


STUDY = Study("orbit", Request, orbit.derive, answer, refusal, unfit, constraints=True, out=Folder(json=True))
