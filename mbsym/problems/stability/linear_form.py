"""The linear form  M x'' + (D + G) x' + (K + N) x = 0  of one subsystem, as polynomials in the parameters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from mbsym.algebra.characteristic import Matrix, Polynomial
from mbsym.algebra.failures import TooLargeError
from mbsym.algebra.matrices import Operators, dot, null_space_of_polynomials
from mbsym.problems.displacements import Basis
from mbsym.problems.stability.words import Fact


@dataclass(frozen=True)
class NonholonomicForm:
    """What is known of one subsystem of a nonholonomic system.

    ``idle`` are indices of coordinates that do not occur in the nonlinear equations, their columns in K + N vanish;
    ``family``: in so many dimensions the steady motions of the subsystem lie near the given one.  ``drifts``: the whole
    system has coordinates that drop out; ``open_names`` are those not shown to drop out in all orders, ``outside``:
    some of them are in no subsystem, as their velocities are dependent, and hang on places.  ``following`` are
    indices of coordinates whose rows are of first order, those of M zero.  ``pairs``: where the velocities follow
    one position along every motion, w' = q' A(q, w) and q'' = F(q, q'^2, w), how many pairs of roots that leaves to
    the subsystem besides zero roots: 1 in that of q, 0 in others; None where the equations are not so.
    """

    idle: tuple[int, ...] = ()
    family: int = 0
    drifts: bool = False
    open_names: tuple[str, ...] = ()
    outside: bool = False
    following: tuple[int, ...] = ()
    pairs: int | None = None

    def zeros(self, power: int) -> int:
        """How many roots are zero, of ``power`` of the determinant, besides those of idle coordinates."""
        return power - len(self.idle)


@dataclass(frozen=True)
class LinearSystem:
    """One subsystem: n x n matrices M, D, G, K, N of polynomials in the parameters.

    ``conservative``: the (generalised) energy **of the nonlinear system** does not grow near the motion, in all orders:
    D does not tell that.  ``of_one``: what else is shown of it where there is one coordinate.
    ``cyclic``: indices of coordinates that do not occur in the nonlinear equations (only their velocities do); their
    rows and columns in K and N must vanish.  ``driven``: those of them whose momenta are not constant although D and N
    have no entries, because forces of higher order act on them.  ``turned``: (p, q) of the factor p lambda^2 + q, q/p
    the squared rate of a steady spin that may be turned in space; () where there is none.  ``ValueError`` for wrong
    shapes and for a pattern of zeros that no (row-scaled) symmetric or skew matrix has.  ``names`` of the coordinates
    are for sentences.  ``nonholonomic``: the five matrices are no more than the split of two, and say nothing about
    energy.  ``leaf``: they are those of disturbances that keep so many relations, which others change.  ``basis``:
    the coordinates are not those of the description but combinations of them.

    ``exact``: the equations of motion are these linear ones, without terms of higher order.  ``shifts`` are then the
    directions along which everything may be shifted, for all parameters alike: rows v with (K + N) v = 0; a drift along
    them is told apart, as that of cyclic coordinates is.  ``free``: that is so, too, along those of some parameters
    along which no velocities act on others, (K + N) v = 0 and G v = 0, as coordinates that are cyclic there.
    """

    M: Matrix
    D: Matrix
    G: Matrix
    K: Matrix
    N: Matrix
    conservative: bool = False
    cyclic: tuple[int, ...] = ()
    turned: tuple[Polynomial, ...] = ()
    driven: tuple[int, ...] = ()
    names: tuple[str, ...] = ()
    nonholonomic: NonholonomicForm | None = None
    leaf: int = 0
    basis: Basis | None = None
    exact: bool = False
    shifts: Matrix = ()
    free: bool = False
    of_one: frozenset[Fact] = frozenset()

    def __post_init__(self) -> None:
        n = len(self.M)
        for name, matrix in zip("MDGKN", self.matrices, strict=True):
            if n == 0 or len(matrix) != n or any(len(row) != n for row in matrix):
                raise ValueError(f"{name} is not a {n} x {n} matrix")
            for i in range(n):
                if name in "GN" and matrix[i][i] != 0:
                    raise ValueError(f"{name} is not skew: element {i + 1}, {i + 1} is not 0")
                if any((matrix[i][j] == 0) != (matrix[j][i] == 0) for j in range(i)):
                    raise ValueError(f"{name} is not {'skew' if name in 'GN' else 'symmetric'}")
        for i in self.cyclic:
            if any(matrix[i][j] != 0 for matrix in (self.K, self.N) for j in range(n)):
                raise ValueError(f"coordinate {i + 1} is not cyclic: it occurs in K or N")

    @property
    def matrices(self) -> tuple[Matrix, Matrix, Matrix, Matrix, Matrix]:
        return self.M, self.D, self.G, self.K, self.N

    @property
    def following(self) -> tuple[int, ...]:
        """Indices of coordinates whose equations are of first order."""
        return () if self.nonholonomic is None else self.nonholonomic.following

    @property
    def kinetic(self) -> Matrix:
        """M without the zero rows and columns of what follows."""
        moving = [i for i in range(self.size) if i not in self.following]
        return tuple(tuple(self.M[i][j] for j in moving) for i in moving)

    @property
    def facts(self) -> frozenset[Fact]:
        """What the pattern of zeros shows, and what is presumed: M > 0, as the matrix of a kinetic energy."""
        exactness = {Fact.EXACTLY_LINEAR} if self.exact else set()
        if self.nonholonomic is not None:
            return frozenset({Fact.MASS_POSITIVE, *exactness})
        zero = [
            fact
            for matrix, fact in ((self.D, Fact.UNDAMPED), (self.G, Fact.NOT_GYROSCOPIC), (self.N, Fact.POTENTIAL))
            if is_zero(matrix)
        ]
        known = [Fact.ENERGY_NEVER_GROWS] if self.conservative else []
        return frozenset({Fact.MASS_POSITIVE, *zero, *known, *exactness, *self.of_one})

    def name(self, i: int) -> str:
        return self.names[i] if self.names else f"coordinate {i + 1}"

    @property
    def size(self) -> int:
        return len(self.M)

    @property
    def of_first_order(self) -> bool:
        """Whether all rows are of first order, x' = A x."""
        return self.nonholonomic is not None and len(self.nonholonomic.following) == self.size


#: Matrices with longer entries on the way are not asked for their null directions.
_MOST_TERMS = 200


class _Normal(Operators[Polynomial]):
    """Polynomials with the normal form that is known of their generators."""

    def __init__(self, zero: Polynomial, one: Polynomial, normal: Callable[[Polynomial], Polynomial]) -> None:
        super().__init__(zero, one)
        self._normal = normal

    def reduce(self, x: Polynomial) -> Polynomial:
        return self._normal(x)


def null_rows(matrix: Matrix, normal: Callable[[Polynomial], Polynomial]) -> Matrix:
    """Rows v with matrix v = 0, a basis for all but exceptional parameters; () also where it would be long.

    ``normal`` gives the normal form of a polynomial, zero where it vanishes.
    """
    zero = matrix[0][0] * 0
    try:
        basis = null_space_of_polynomials(_Normal(zero, zero + 1, normal), matrix, len(matrix), most=_MOST_TERMS)
    except TooLargeError:
        return ()
    if any(len(x) > _MOST_TERMS for v in basis for x in v):
        return ()
    if any(normal(dot(row, v)) != 0 for row in matrix for v in basis):
        return ()
    return tuple(map(tuple, basis))


#: The kind of a system with no other forces than those of K.
CONSERVATIVE = "conservative"


def kind_of(system: LinearSystem) -> str:
    """Words for the acting forces: conservative, gyroscopic conservative, dissipative, circulatory, ..."""
    if system.nonholonomic is not None:
        return "of first order" if system.of_first_order else "constrained in velocities"
    damped, gyroscopic = not is_zero(system.D), not is_zero(system.G)
    words = ["gyroscopic"] if gyroscopic else []
    if damped:
        words.append("dissipative")
    if not is_zero(system.N):
        words.append("circulatory")
    elif not damped:
        words.append(CONSERVATIVE)
    return " ".join(words)


def is_zero(matrix: Matrix) -> bool:
    return all(entry == 0 for row in matrix for entry in row)


def is_potential(system: LinearSystem) -> bool:
    return all(is_zero(matrix) for matrix in (system.D, system.G, system.N))


# The matrix of  (q, v)' = A (q, v)  of a linear form in which some coordinates follow by equations of first order.
#
# With coordinates p that have speeds v = p' and coordinates f that follow, q = (p, f),
#
#     M v' + C_p v + K_p q = 0,        C_ff f' + C_fp v + K_f q = 0,
#
# the rows and columns of f in M, and the columns of f in C_p, being zero.


Rows = Sequence[Sequence[Any]]


def state_matrix(kind: Any, m: Rows, c: Rows, k: Rows, following: Sequence[int] = ()) -> Any:
    """A, square of size n + (n - len(following)), the coordinates first; ``kind`` is fmpq_mat or arb_mat.

    Raises ZeroDivisionError where M, without what follows, or C_ff is singular.
    """
    n = len(m)
    moving = [i for i in range(n) if i not in following]

    def block(rows: Rows, lines: Sequence[int], columns: Sequence[int]) -> Any:
        return kind(len(lines), len(columns), [rows[i][j] for i in lines for j in columns])

    whole, every = kind(n + len(moving), n + len(moving)), range(n)
    for place, i in enumerate(moving):
        whole[i, n + place] = 1
    for lines, leading, offset in ((moving, m, n), (following, c, None)):
        if not lines:
            continue
        own = block(leading, lines, lines)
        by_place, by_speed = own.solve(block(k, lines, every)), own.solve(block(c, lines, moving))
        for a, i in enumerate(lines):
            row = i if offset is None else offset + a
            for j in every:
                whole[row, j] = -by_place[a, j]
            for b in range(len(moving)):
                whole[row, n + b] = -by_speed[a, b]
    return whole
