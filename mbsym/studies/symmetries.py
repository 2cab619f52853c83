"""``mbsym symmetries``: hidden cyclic coordinates and rotations, and their integrals."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass, field
from typing import TYPE_CHECKING

from mbsym.expressions.message import Message
from mbsym.studies.request import Numbers
from mbsym.studies.study import Answer, Asked, Exit, Refusal, Study, Watch, failed, refused

if TYPE_CHECKING:
    from mbsym.problems.symmetries.search import Symmetries


@dataclass(frozen=True)
class Request:
    """Find the symmetries of FILE that its coordinates hide, and their first integrals (Noether).

    Looked for are all fields of degree one in the positions, with a shift of time, that leave the Lagrangian unchanged
    but for the time derivative of a polynomial of degree two in the positions, fields and polynomial free of the time:
    directions are generalised coordinates, or the speeds that FILE declares (then a
    body turning about an axis in itself is one).  Forces without a force function take part.  Parameters stay symbols,
    so that what is said holds for almost all their values; --set puts in exact numbers, where there may be more.

    Each integral is told apart from those of problem 7; dI/dt is formed by substitution once more.

    Exit codes: 0 all of this kind were found, proved; 1 not proved that these are all; 2 something is wrong.

    \b
    Examples:
      mbsym symmetries systems/spherical-pendulum.yaml
      mbsym symmetries systems/euler-poisson.yaml --set A=2 --set B=2 --set x0=0 --set y0=0
      mbsym symmetries systems/cart-pendulum.yaml --json
    """

    _: KW_ONLY
    values: Numbers = field(default_factory=dict)


def derive(context: Asked, request: Request, watch: Watch) -> Symmetries:
    from mbsym.analysis import Analysis
    from mbsym.analysis.symmetric import symmetries_of

    watch("symmetries")
    return symmetries_of(Analysis(context.system), request.values)


def answer(context: Asked, request: Request, symmetries: Symmetries) -> Answer:
    from mbsym.report.sections.polynomial_integrals import of_symmetries

    return Answer(of_symmetries(symmetries), code=Exit.OK if symmetries.complete else Exit.FAILED)


def as_json(context: Asked, request: Request, symmetries: Symmetries) -> str:
    from mbsym.report.documents import integrals as doc
    from mbsym.report.documents.base import file_of

    return file_of(doc.Symmetries, context.system, symmetries, values=request.values)


def refusal(error: Exception, context: Asked, request: Request) -> Refusal | None:
    from mbsym.algebra.failures import SingularPoint

    if isinstance(error, SingularPoint):
        return refused("no symmetries", error, Exit.BAD_INPUT)
    return failed(error, "no symmetries")


#: Under constraints.
INSTEAD = Message(
    "under constraints a symmetry has an integral where they allow its displacements (Noether): "
    "'mbsym run --problems 7' tells such momenta, and what else is kept"
)

STUDY = Study(
    "symmetries", Request, derive, answer, refusal, json=as_json, instead=INSTEAD, matrices=True, held=False, out=None,
    letters=True,
)  # fmt: skip
