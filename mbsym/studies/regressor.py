"""``mbsym regressor``: base parameters of a tree, and the regressor that belongs to them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from mbsym.studies.described import public
from mbsym.studies.study import Answer, Asked, Folder, Refusal, Study, Watch, failed

if TYPE_CHECKING:
    from mbsym.problems.regressor import Regressor


@dataclass(frozen=True)
class Request:
    """Find the smallest set of inertial parameters that FILE's motion can tell, and their regressor.

    The generalised forces are tau = Y(q, q', q'') theta + other loads, with ten parameters of each body: mass m, first
    moment h = m c, tensor J about its connection point.  Said is which sums of them are all that enters (base
    parameters), which enter not at all, and how they are known: by identities of the exact ring.  Constraints add
    J^T lambda to tau: what is found is the regressor of the tree without them.

    Written are regressor.py (Y as a program of NumPy, and the sums' values), regressor.tex and regressor.json.  Exit
    codes: 0 done, 1 there is no answer or it was not written, 2 something is wrong.

    \b
    Example:
      mbsym regressor systems/spatial-arm.yaml
    """


@public(Request)
def regressor(context: Asked, request: Request, watch: Watch) -> Regressor:
    """Base parameters of a tree under uniform gravity, and their regressor: ``mbsym regressor``.

    Of constraints those are put in that give a coordinate by others; without the rest the tree is taken.

        >>> import mbsym
        >>> found = mbsym.regressor("systems/double-pendulum.yaml")
        >>> len(found.standard), [(one.kept.kind, one.kept.body) for one in found.base][:2]
        (20, [('Jzz', 'first'), ('hx', 'first')])

    Raises DescriptionError, ``mbsym.algebra.failures.Failure``.
    """
    from mbsym.analysis import Analysis
    from mbsym.analysis.constrained import in_free_coordinates
    from mbsym.problems.regressor import regressor as found_of

    watch("base parameters")
    system = in_free_coordinates(context.system.without_speeds)
    found = found_of(Analysis(replace(system, constraints=(), dependent=())).scene)
    return replace(found, tied=bool(system.constraints))


def answer(context: Asked, request: Request, derived: Regressor) -> Answer:
    from mbsym.report.content import facts
    from mbsym.report.regressor_files import regressor_json, regressor_latex, regressor_module, sentences

    files: dict[str, str | bytes] = {
        "regressor.py": regressor_module(derived),
        "regressor.tex": regressor_latex(derived),
        "regressor.json": regressor_json(derived),
    }
    return Answer([facts(sentences(derived))], files)


def refusal(error: Exception, context: Asked, request: Request) -> Refusal | None:
    return failed(error, "no base parameters")


STUDY = Study(
    "regressor", Request, regressor.derive, answer, refusal, constraints=True, held=False, out=Folder(json=True)
)
