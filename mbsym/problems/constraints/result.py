"""What is known of the constraints of a system, as values."""

from __future__ import annotations

from dataclasses import dataclass

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.ring import Ring
from mbsym.formulas.formula import Column, Formula, Matrix, Shown, column
from mbsym.mechanics.constraints.dependence import Dependent
from mbsym.mechanics.constraints.embedding import Embedding, Pivots, basis_vector
from mbsym.mechanics.constraints.rows import RowName


@dataclass(frozen=True)
class Integrability:
    """Whether velocity constraints are integrable.

    ``growth`` are the dimensions spanned by the fields, by them and their first brackets, and so on, the last one
    repeating; of fields on (q, t) where ``rheonomic``.  ``kept`` is the number of relations between coordinates (and t)
    that they imply besides those given, None where that is undecided.
    """

    growth: tuple[int, ...]
    kept: int | None
    constraints: int
    certainty: Certainty
    rheonomic: bool

    @property
    def word(self) -> str:
        """``holonomic``: all are derivatives of relations; ``nonholonomic``: none, and no combination; ``partly``."""
        if self.kept is None:
            return "undecided"
        if self.kept == self.constraints:
            return "holonomic"
        return "partly" if self.kept else "nonholonomic"


@dataclass(frozen=True)
class Redundant:
    """A row that follows from rows before it; ``from_rows`` names those that its J is combined of."""

    name: RowName
    from_rows: tuple[RowName, ...]
    certainty: Certainty


@dataclass(frozen=True)
class Demanded:
    """Relations between parameters without which the constraints cannot be kept as they are here, ``count`` of them.

    ``relations`` are polynomials that vanish, where such were recognised (verified numerically).  ``satisfied``:
    whether the given values do so; None where values are missing.  ``freedom``: how many velocities the constraints
    leave at the given values, in the positions that were found there; None where none was.
    """

    count: int
    relations: tuple[Formula, ...] = ()
    satisfied: bool | None = None
    freedom: int | None = None


@dataclass(frozen=True, repr=False)
class Solved(Shown):
    """q' = Y u + y0 and q'' = Y u' + a0: ``transformation`` Y (n x (n - r)), ``shift`` y0, ``acceleration_shift`` a0.

    All regular where ``regular_where`` is not zero; ``regular_everywhere`` where that is known of all configurations.
    """

    transformation: Matrix
    shift: Column
    acceleration_shift: Column
    regular_where: Formula
    regular_everywhere: bool
    embedding: Embedding

    @staticmethod
    def of(ring: Ring, embedding: Embedding, regular_everywhere: bool) -> Solved:
        """With the rows of all velocities."""
        n = len(embedding.dependent) + len(embedding.free)
        columns = [basis_vector(ring, embedding, place) for place in range(len(embedding.free))]
        shift, acceleration = [ring.zero] * n, [ring.zero] * n
        for k, x, y in zip(embedding.dependent, embedding.shift, embedding.acceleration, strict=True):
            shift[k], acceleration[k] = x, y
        return Solved(
            Matrix.of(ring, [[y[k] for y in columns] for k in range(n)]),
            column(ring, shift),
            column(ring, acceleration),
            Formula(ring, embedding.determinant),
            regular_everywhere,
            embedding,
        )


@dataclass(frozen=True, repr=False)
class Constraints(Shown):
    """Rows that say something, with f, J (m x n), j = velocity at q' = 0, gamma = J' q' + j'.

    ``independent`` are row numbers; ``velocity_rank`` their number r, ``position_rank`` h.  ``dependent_sets`` are the
    rows that follow from others, in sets that hang together, ``dependent_positions`` those of the rows on positions
    alone.  ``demanded`` are the relations between parameters that the position constraints demand.  ``rank_beside``:
    the rank at values of the parameters near those given, where it is another, else None.  ``kept_at_values``: whether
    a position that keeps all constraints was found at the given values; None where values or constraints are missing.
    ``alone`` says of every independent
    velocity constraint whether it is integrable by itself, on all configurations (None: undecided).  ``solved`` is None
    where the formulas outgrow the budget; ``pivots`` say how a program does it.  With ``in_speeds`` the
    ``coordinates``, ``dependent`` and ``free`` are names of speeds, velocity and J are in them, f is in the positions.
    """

    counted = ("jacobian", "velocity", "acceleration")

    names: tuple[RowName, ...]
    position: tuple[Formula | None, ...]
    velocity: Column
    jacobian: Matrix
    acceleration: Column
    independent: tuple[int, ...]
    redundant: tuple[Redundant, ...]
    position_rank: int
    demanded: Demanded
    coordinates: tuple[str, ...]
    dependent: tuple[str, ...]
    integrability: Integrability | None
    alone: tuple[tuple[RowName, bool | None], ...]
    exact_points: bool
    pivots: Pivots
    solved: Solved | None
    in_speeds: bool = False
    dependent_sets: tuple[Dependent, ...] = ()
    dependent_positions: tuple[Dependent, ...] = ()
    rank_beside: int | None = None
    kept_at_values: bool | None = None

    @staticmethod
    def none(ring: Ring, coordinates: tuple[str, ...], in_speeds: bool = False) -> Constraints:
        """Those of a system without any, which leave q' = u: Y = 1."""
        embedding = Embedding((), tuple(range(len(coordinates))), (), (), (), ring.one)
        return Constraints(
            names=(),
            position=(),
            velocity=(),
            jacobian=Matrix.of(ring, []),
            acceleration=(),
            independent=(),
            redundant=(),
            position_rank=0,
            demanded=Demanded(0),
            coordinates=coordinates,
            dependent=(),
            integrability=None,
            alone=(),
            exact_points=True,
            pivots=Pivots((), (), ()),
            solved=Solved.of(ring, embedding, regular_everywhere=True),
            in_speeds=in_speeds,
        )

    @property
    def velocity_rank(self) -> int:
        """r: how many velocities depend on the others."""
        return len(self.independent)

    @property
    def free(self) -> tuple[str, ...]:
        """The coordinates whose velocities are independent."""
        return tuple(name for name in self.coordinates if name not in self.dependent)
