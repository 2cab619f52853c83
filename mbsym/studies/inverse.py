"""``mbsym inverse``: the inputs that a given motion needs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import KW_ONLY, dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from mbsym.expressions.message import Message
from mbsym.studies.described import analysis_of
from mbsym.studies.request import Formulas, Stateless, Whole, duration
from mbsym.studies.study import Answer, Asked, Exit, Refusal, Study, Unfit, Watch, no_program, refused

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.numerics.inverse import InverseDynamics


@dataclass(frozen=True)
class Request:
    """Find the inputs of FILE with which its coordinates move as given.

    A motion is a formula in t and the parameters for every coordinate; its derivatives are exact.  With constraints it
    is enough to give that of some from which the others follow, near the initial position; where wheels roll to is
    integrated from there.  The equations are solved for the inputs, which must enter linearly, at every time: where
    there are more equations than inputs in the sense of least squares, and what is left of the equations is told; where
    there are fewer, the smallest inputs are taken, and that is told.

    Written are inputs.csv (t, inputs, coordinates, velocities, accelerations, what is left of each equation) and
    inputs.svg, inputs.png.  Exit codes: 0 done, 1 there are none or it was not written, 2 something is missing or
    wrong, 3 no inputs give this motion (the best ones are written), 130 interrupted.

    \b
    Example:
      mbsym inverse systems/cart-pole.yaml --motion "p=t**2/2" --motion "theta=0" --time 2
    """

    motion: Annotated[
        Mapping[str, Any], Formulas("NAME=FORMULA", "Of a coordinate, in t; constraints may give others.")
    ]
    time: Annotated[float, duration("From 0 to T.")]
    _: KW_ONLY
    samples: Annotated[int, Whole("N", "Rows.", least=2)] = 1001
    values: Stateless = field(default_factory=dict)


def unfit(context: Asked, request: Request) -> Iterator[Unfit]:
    """Coordinates without a motion; with constraints some may follow from the others, which is seen at every time."""
    system = context.system
    for name in system.coordinates if not (system.constraints and request.motion) else ():
        if name not in request.motion:
            hint = Message("for example [[example]]", example=f'--motion "{name}=0"')
            yield Unfit("--motion", "missing-option", Message("no motion is given for [[name]]", name=name), hint)


def derive(context: Asked, request: Request, watch: Watch) -> InverseDynamics:
    import numpy as np

    from mbsym.numerics.inverse import inverse_dynamics as found_for
    from mbsym.simulation import read_values

    watch("solving for the inputs")
    values, times = read_values(context.system, request.values), np.linspace(0.0, request.time, request.samples)
    return found_for(context.system, request.motion, values, times)


def answer(context: Asked, request: Request, dynamics: InverseDynamics) -> Answer:
    from mbsym.report.content import facts
    from mbsym.report.runs.inverse_files import inputs_csv, inputs_figure, sentences

    files: dict[str, str | bytes] = {"inputs.csv": inputs_csv(dynamics)}
    files |= inputs_figure(dynamics, ("svg", "png"))
    return Answer([facts(sentences(dynamics))], files, code=Exit.OK if dynamics.exact else Exit.BROKEN_DOWN)


def refusal(error: Exception, context: Asked, request: Request) -> Refusal | None:
    from mbsym.numerics.inverse import NotLinear

    if isinstance(error, (NotLinear, ValueError)):
        return refused("there are no inputs to be found", error)
    return no_program(error, context, request)


def as_json(context: Asked, request: Request, dynamics: InverseDynamics) -> str:
    from mbsym.report.documents.base import file_of
    from mbsym.report.documents.parameters import Inverse

    inputs = zip(dynamics.names, dynamics.inputs, strict=True)
    return file_of(Inverse, context.system, dynamics, inputs=inputs)


STUDY = Study("inverse", Request, derive, answer, refusal, unfit, as_json, constraints=True, held=False)


def inverse_dynamics(
    source: str | Path | Analysis,
    motion: Mapping[str, Fraction | float | str],
    times: Iterable[float],
    *,
    values: Mapping[str, Fraction | float | str] | None = None,
) -> InverseDynamics:
    """The inputs of a description with which its coordinates move as given: ``mbsym inverse``.

        >>> import mbsym
        >>> found = mbsym.inverse_dynamics("systems/cart-pole.yaml", {"p": "t", "theta": "pi"}, [0, 1, 2])
        >>> found.exact, [round(float(x), 12) for x in found["F"]]  # at a constant speed the friction c p' remains
        (True, [0.1, 0.1, 0.1])

    ``motion`` gives every coordinate as a smooth formula in t, parameters and prescribed motions; with constraints some
    of them, from which they give the others, near the initial position.  The equations are
    solved for the inputs at every time: in the sense of least squares where there are more of them (``exact`` and
    ``left`` say what remains), by the smallest inputs where these are not ``unique``.

    Raises DescriptionError; ValueError for arguments that cannot be met; ``mbsym.numerics.inverse.NotLinear`` where an
    input enters other than linearly; ``mbsym.numerics.scenario.Incomplete``.
    """
    import numpy as np

    from mbsym.mechanics.variables import settled
    from mbsym.numerics.inverse import inverse_dynamics as found_for
    from mbsym.simulation import read_values
    from mbsym.source.laws import read_motions

    system = settled(analysis_of(source).system)
    moments = np.asarray(list(times), dtype=float)
    return found_for(system, read_motions(system, motion), read_values(system, values or {}), moments)
