"""``mbsym floquet``: stability of a motion whose first approximation is periodic in time."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass, field
from typing import TYPE_CHECKING

from mbsym.studies.described import public
from mbsym.studies.request import Stateless
from mbsym.studies.study import Answer, Asked, Folder, Refusal, Study, Watch, no_program, refused

if TYPE_CHECKING:
    from mbsym.numerics.orbits.floquet import Judged


@dataclass(frozen=True)
class Request:
    """Judge the stability of FILE's unperturbed motion where its first approximation is periodic in time.

    Problem 6 is about constant coefficients; this is for periodic ones (a pendulum whose pivot shakes, Mathieu's
    equation).  The period is read from the equations, the monodromy matrix is enclosed in balls with proved remainders,
    and what its multipliers prove is said: unstable, asymptotically stable, stable (of linear equations), stable in the
    first approximation only, or undecided.

    Written is floquet.json.  Exit codes: 0 judged (undecided, too), 1 there is nothing to judge or it was not written,
    2 something is missing or wrong, 130 interrupted.

    \b
    Example:
      mbsym floquet systems/shaken-pendulum.yaml --set nu=50
    """

    _: KW_ONLY
    values: Stateless = field(default_factory=dict)


@public(Request)
def floquet(context: Asked, request: Request, watch: Watch) -> Judged:
    """What the multipliers of a time-periodic first approximation prove: ``mbsym floquet``.

        >>> import mbsym
        >>> mbsym.floquet("systems/shaken-pendulum.yaml", values={"nu": 40}).word.value
        'unstable'

    Raises DescriptionError, ValueError, ``mbsym.numerics.orbits.floquet.NotPeriodic``.
    """
    from mbsym.numerics.dynamics import Dynamics
    from mbsym.numerics.orbits.floquet import judged

    watch("enclosing the monodromy matrix")
    return judged(Dynamics(context.motion), steady=False)


def answer(context: Asked, request: Request, judged: Judged) -> Answer:
    from mbsym.report.content import facts
    from mbsym.report.runs.orbit_files import floquet_json, floquet_sentences

    return Answer([facts(floquet_sentences(judged))], {"floquet.json": floquet_json(context.system, judged)})


def refusal(error: Exception, context: Asked, request: Request) -> Refusal | None:
    from mbsym.analysis.approximation import judgeable_with_zeros
    from mbsym.numerics.orbits.floquet import ConstantCoefficients, NotPeriodic

    vanishing = [name for name, value in context.motion.parameters.items() if value == 0]
    if isinstance(error, ConstantCoefficients) and (zeros := judgeable_with_zeros(context.system, vanishing)):
        text = (
            "its coefficients are constant at these values: with 'relations: {[[zeros]]}' in place of these values "
            "problem 6 judges it (mbsym run)"
        )
        error = NotPeriodic(text, zeros=", ".join(f"{name}: 0" for name in zeros))
    if isinstance(error, NotPeriodic):
        return refused("there is no periodic first approximation to judge", error)
    return no_program(error, context, request)


STUDY = Study("floquet", Request, floquet.derive, answer, refusal, constraints=True, out=Folder(json=True))
