"""What generated code is made of: M, f and accelerations; of a constrained system its rows, multipliers, the way back.

    M q'' = f + J^T lambda,     J q'' = -gamma,     phi(q, t) = 0,     J q' + j = 0

Rows are all that say something, those on positions first; some may follow from others.  Accelerations and multipliers
are there twice: as a straight-line program that differentiates exactly (``mbsym.mechanics.constraints.dynamics``, by
factors of M and of J M^-1 J^T), and as M, f, J and gamma for languages that solve with pivots.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING

from mbsym.algebra.failures import Failure
from mbsym.algebra.program import Node, Program
from mbsym.algebra.remembered import remembered
from mbsym.analysis.stages import Unavailable
from mbsym.mechanics.constraints.dependence import counted_anew
from mbsym.mechanics.constraints.dynamics import Chosen, ConstrainedDynamics, Kept, constrained_dynamics
from mbsym.mechanics.constraints.programs import ConstrainedPrograms
from mbsym.model.system import System
from mbsym.report.code.functions import Function, Functions

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


@dataclass(frozen=True)
class Tied:
    """``rows`` are numbers of rows of ``code``, those on positions first, ``positions`` of them.

    ``rank`` of them are independent, ``position_rank`` of those on positions.  ``dynamics`` has its rows in the same
    order; None for the reason ``no_dynamics``.  ``chosen`` is what it is made of.
    """

    code: ConstrainedPrograms
    rows: tuple[int, ...]
    positions: int
    rank: int
    position_rank: int
    chosen: Chosen
    dynamics: ConstrainedDynamics | None = None
    no_dynamics: str = ""

    @property
    def labels(self) -> tuple[str, ...]:
        """What the rows are called."""
        return tuple(self.code.names[i].label for i in self.rows)

    @property
    def kept(self) -> tuple[tuple[int, int], ...]:
        """(constraint, component) of the rows."""
        return self.chosen.rows

    @property
    def phi(self) -> list[Node]:
        """Of the constraints on positions."""
        return [node for i in self.rows if (node := self.code.position[i]) is not None]

    @property
    def velocity(self) -> list[Node]:
        """J q' + j."""
        return [self.code.velocity[i] for i in self.rows]

    @property
    def gamma(self) -> list[Node]:
        """J' q' + j'."""
        return [self.code.acceleration[i] for i in self.rows]

    @property
    def jacobian(self) -> list[tuple[Node, ...]]:
        """J."""
        return [self.code.jacobian[i] for i in self.rows]


@remembered  # several files are written of one analysis, from the same programs
def tied_of(analysis: Analysis) -> Tied | str:
    """The rows and the equations with them; or the reason why there are none."""
    try:
        return _tied(analysis)
    except Unavailable as missing:
        return missing.failure.reason
    except Failure as reason:
        return str(reason)


def _tied(analysis: Analysis) -> Tied:
    constraints, code = analysis.constraints, analysis.tied_programs
    order = sorted(range(len(code.names)), key=lambda i: code.position[i] is None)
    rows, sets = counted_anew(
        order, constraints.independent, constraints.dependent_sets, constraints.dependent_positions
    )
    positions = sum(code.position[i] is not None for i in rows)
    single = any(not code.names[rows[k]].component for one in sets[0] for k in one.rows)
    usual = _usual(analysis.system) if single else {}
    kept = tuple((code.names[i].constraint, code.names[i].component) for i in rows)
    chosen = Chosen(kept, sets[0], sets[1], usual)
    tied = Tied(code, tuple(rows), positions, constraints.velocity_rank, constraints.position_rank, chosen)
    try:
        return replace(tied, dynamics=constrained_dynamics(analysis.system, analysis.ring, chosen))
    except Failure as reason:
        return replace(tied, no_dynamics=str(reason))


def _usual(system: System) -> Mapping[Kept, Fraction]:
    """What single rows are measured by at the values of the description; nothing where these are not known."""
    from mbsym.numerics.dynamics import Dynamics  # few systems have constraints
    from mbsym.numerics.scenario import Incomplete, scenario

    try:
        constraints = Dynamics(scenario(system)).constraints
        return {} if constraints is None else constraints.usual
    except (Failure, Incomplete):
        return {}


@dataclass(frozen=True)
class TiedCode:
    """Functions of the rows: phi (of those on positions), J q' + j, J and gamma.

    ``rows`` are their labels, ``positions`` how many of them, the first ones, are on positions; ``rank`` and
    ``position_rank`` how many are independent, of all and of those; ``places`` the entries
    of J that need not be zero; ``given`` see ``given_of``, ``stays`` names what it flags.  ``measures``: by what the
    square of each row is measured, of the ``squares`` of all.
    """

    rows: tuple[str, ...]
    measures: tuple[str, ...]
    positions: int
    rank: int
    position_rank: int
    phi: Function
    velocity: Function
    jacobian: Function
    gamma: Function
    places: tuple[tuple[int, int], ...]
    given: tuple[int, ...]
    stays: tuple[str, ...]


def given_of(system: System) -> tuple[int, ...]:
    """For q, then q': 1 where the initial state stays as the description gives it, if the constraints can be kept so.

    Coordinates stay that it does not call dependent, if it calls any so; velocities that it gives, if it does not give
    all.
    """
    stated = {item.coordinate for item in system.initial if item.velocity is not None}
    positions = [bool(system.dependent) and name not in system.dependent for name in system.coordinates]
    velocities = [name in stated and len(stated) < len(system.coordinates) for name in system.coordinates]
    return tuple(map(int, (*positions, *velocities)))


def tied_code(analysis: Analysis, writer: Functions) -> TiedCode | None:
    """The functions; None where there are none."""
    tied = tied_of(analysis)
    if isinstance(tied, str):
        return None
    program, jacobian = tied.code.tree.program, tied.jacobian
    places = entries(program, jacobian)
    system = analysis.system
    fixed = given_of(system)
    return TiedCode(
        tied.labels,
        _measures(tied),
        tied.positions,
        tied.rank,
        tied.position_rank,
        writer.function(program, tied.phi),
        writer.function(program, tied.velocity),
        writer.function(program, [jacobian[k][j] for k, j in places]),
        writer.function(program, tied.gamma),
        places,
        fixed,
        tuple(name for name, stays in zip((*system.coordinates, *system.velocities), fixed, strict=True) if stays),
    )


def _measures(tied: Tied) -> tuple[str, ...]:
    """``measures`` of dependence in the syntax of Python and C."""
    names, usual = [tied.code.names[i] for i in tied.rows], tied.chosen.usual
    kinds = [" + ".join(f"squares[{k}]" for k, x in enumerate(names) if x.kind == name.kind) for name in names]
    return tuple(
        f"squares[{i}] + {float(usual[key])!r}" if (key := (name.constraint, name.component)) in usual else kinds[i]
        for i, name in enumerate(names)
    )


def entries(program: Program, matrix: Sequence[Sequence[Node]]) -> tuple[tuple[int, int], ...]:
    """The places of a matrix that need not be zero."""
    return tuple((k, j) for k, row in enumerate(matrix) for j, node in enumerate(row) if not program.vanishes(node))
