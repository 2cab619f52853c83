"""Problem 8 at rational numbers: Kalman's rank, feedback found in floating point and proved, bundles of energies.

    z' = A z + B u,    z = (x, x'),    A = [ 0, 1; -M^-1 S, -M^-1 C ],    B = [ 0; M^-1 B ]

Everything but the search is exact.  Sources: R. E. Kalman (1960); W. F. Arnold & A. J. Laub, Proc. IEEE 72 (1984) (LQR
by Schur vectors, in SciPy).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import arb, fmpq, fmpq_mat, fmpq_mpoly_ctx, fmpq_poly

from mbsym.algebra.rationals import fraction, rounded
from mbsym.algebra.roots import count_roots
from mbsym.expressions.message import Message
from mbsym.problems.stabilisation.result import Feedback
from mbsym.problems.stability.bundle import definite_combination_of
from mbsym.problems.stability.exact import is_positive, verdict_at
from mbsym.problems.stability.linear_form import LinearSystem
from mbsym.problems.stability.state_matrix import state_matrix
from mbsym.problems.stability.verdict import Verdict

#: Significant digits to which gains and Lyapunov functions are rounded, until the proof succeeds.
DIGITS = (2, 3, 4, 6, 9, 12)

Numbers = Any  # a flint.fmpq_mat


@dataclass(frozen=True)
class AtValues:
    """M, C, S (n x n) and B (n x m; None without inputs), rational; M is not singular."""

    mass: Numbers
    rates: Numbers
    places: Numbers
    inputs: Numbers | None

    @property
    def size(self) -> int:
        return int(self.mass.nrows())

    @property
    def state(self) -> Numbers:
        """A, 2n x 2n."""
        return state_matrix(fmpq_mat, self.mass.tolist(), self.rates.tolist(), self.places.tolist())

    def gain(self, inputs: Numbers) -> Numbers:
        """[ 0; M^-1 B ]."""
        n, m = self.size, inputs.ncols()
        solved = self.mass.inv() * inputs
        return fmpq_mat(2 * n, m, [fmpq(0)] * (n * m) + solved.entries())

    def only(self, at: Sequence[int]) -> AtValues:
        """The block of some coordinates."""

        def block(matrix: Numbers) -> Numbers:
            return fmpq_mat(len(at), len(at), [matrix[i, j] for i in at for j in at])

        inputs = self.inputs
        if inputs is not None:
            inputs = fmpq_mat(len(at), inputs.ncols(), [inputs[i, j] for i in at for j in range(inputs.ncols())])
        return AtValues(block(self.mass), block(self.rates), block(self.places), inputs)


def kalman_rank(a: Numbers, b: Numbers) -> int:
    """rank [ B, A B, A^2 B, ... ]."""
    columns, step = b.tolist(), b
    for _ in range(a.nrows() - 1):
        step = a * step
        columns = [row + more for row, more in zip(columns, step.tolist(), strict=True)]
    return int(fmpq_mat(len(columns), len(columns[0]), [x for row in columns for x in row]).rank())


def is_controllable(there: AtValues) -> bool:
    assert there.inputs is not None
    return kalman_rank(there.state, there.gain(there.inputs)) == 2 * there.size


def unreached(a: Numbers, b: Numbers) -> Any:
    """The characteristic polynomial of what inputs do not reach: that of A on the quotient by the reachable space.

    Its roots are the lambda at which Hautus' matrix loses rank.
    """
    n, columns, step = a.nrows(), [], b
    for _ in range(n):
        columns += [list(column) for column in step.transpose().tolist()]
        step = a * step
    basis = _independent(columns)
    rank = len(basis)
    if rank == n:
        return fmpq_poly([1])
    for k in range(n):
        basis = _independent([*basis, [fmpq(int(i == k)) for i in range(n)]])
    change = fmpq_mat(n, n, [basis[j][i] for i in range(n) for j in range(n)])
    moved = change.inv() * a * change
    rest = fmpq_mat(n - rank, n - rank, [moved[i, j] for i in range(rank, n) for j in range(rank, n)])
    return rest.charpoly()


def _independent(vectors: Sequence[Sequence[Any]]) -> list[list[Any]]:
    """Those vectors that do not depend on the ones before."""
    kept: list[list[Any]] = []
    for vector in vectors:
        rows = [*kept, list(vector)]
        if fmpq_mat(len(rows), len(vector), [x for row in rows for x in row]).rank() == len(rows):
            kept = rows
    return kept


def is_stabilisable(there: AtValues) -> bool:
    """Whether what the inputs do not reach decays by itself."""
    assert there.inputs is not None
    left = unreached(there.state, there.gain(there.inputs))
    roots = count_roots(left.coeffs())
    return bool(roots.left == roots.degree)


# --- feedback ---


def feedback(there: AtValues) -> Feedback | str:
    """A feedback with its proof, or why none was found.

    The weights of the LQR are unit matrices.
    """
    import numpy as np
    from scipy.linalg import LinAlgError, solve_continuous_are

    assert there.inputs is not None
    if not is_stabilisable(there):
        return "a motion that does not decay is out of reach of the inputs (proved)"
    a, b = there.state, there.gain(there.inputs)
    n, m = a.nrows(), b.ncols()
    first, second = (np.array([[_float(x) for x in row] for row in matrix.tolist()]) for matrix in (a, b))
    try:
        riccati = solve_continuous_are(first, second, np.eye(n), np.eye(m))
        wanted = second.T @ riccati
    except (LinAlgError, ValueError) as error:
        return Message("the Riccati equation was not solved: [[why]]", why=error)
    if not np.isfinite(wanted).all():
        return "the Riccati equation was not solved in floating point"
    for digits in DIGITS:
        gains = fmpq_mat(m, n, [rounded(float(x), digits) for x in wanted.flatten()])
        closed = a - b * gains
        characteristic = closed.charpoly().coeffs()
        roots = count_roots(characteristic)
        if roots.left != roots.degree:
            continue
        verdict = _judged(there, gains)
        if not verdict.word.asymptotic:
            return "the two judges of the closed loop disagree"
        return Feedback(_rows(gains), tuple(fraction(x) for x in characteristic), verdict, lyapunov_function(closed))
    return "no rounded feedback was proved to work"


def _judged(there: AtValues, gains: Numbers) -> Verdict:
    """The verdict of problem 6 on  M x'' + (C + B k_v) x' + (S + B k_x) x = 0,  gains = (k_x, k_v)."""
    n, m = there.size, gains.nrows()
    assert there.inputs is not None
    split = [fmpq_mat(m, n, [gains[i, k * n + j] for i in range(m) for j in range(n)]) for k in (0, 1)]
    rates, places = there.rates + there.inputs * split[1], there.places + there.inputs * split[0]
    context = fmpq_mpoly_ctx.get(["x"], "lex")

    def part(matrix: Numbers, sign: int) -> Any:
        half = (matrix + matrix.transpose() * fmpq(sign)) * fmpq(1, 2)
        return tuple(tuple(context.constant(x) for x in row) for row in half.tolist())

    mass = tuple(tuple(context.constant(x) for x in row) for row in there.mass.tolist())
    closed = LinearSystem(mass, part(rates, 1), part(rates, -1), part(places, 1), part(places, -1))
    return verdict_at(closed, {}).verdict


def lyapunov_function(a: Numbers) -> tuple[tuple[Fraction, ...], ...] | None:
    """A rational P with P > 0 and P A + A^T P < 0, both proved by leading minors; None where none was found."""
    import numpy as np
    from scipy.linalg import solve_continuous_lyapunov

    n = a.nrows()
    floats = np.array([[_float(x) for x in row] for row in a.tolist()])
    found = solve_continuous_lyapunov(floats.T, -np.eye(n))
    if not np.isfinite(found).all():
        return None
    for digits in DIGITS:
        rows = [[rounded(float(found[min(i, j), max(i, j)]), digits) for j in range(n)] for i in range(n)]
        candidate = fmpq_mat(n, n, [x for row in rows for x in row])
        if proves_decay(candidate, a):
            return _rows(candidate)
    return None


def proves_decay(p: Numbers, a: Numbers) -> bool:
    """Whether P > 0 and P A + A^T P < 0."""
    rate = p * a + a.transpose() * p
    return bool(p == p.transpose()) and is_positive(p) and is_positive(-rate)


# --- bundles of energies ---


def energy_bundle(there: AtValues) -> tuple[Fraction, ...] | None:
    """Weights w with sum w_k E_k > 0, E_k(z) = H(A^k z), H = x'.M x'/2 + x.S x/2; exact, or None.

    With C skew and S symmetric H is an integral, and with z the derivative A z solves the same equations, so that every
    E_k is an integral.
    """
    n, a = there.size, there.state
    zero = [[fmpq(0)] * n for _ in range(n)]
    upper = [row + blank for row, blank in zip(there.places.tolist(), zero, strict=True)]
    lower = [blank + row for row, blank in zip(there.mass.tolist(), zero, strict=True)]
    energy = fmpq_mat(2 * n, 2 * n, [x / 2 for row in [*upper, *lower] for x in row])
    forms, power = [], fmpq_mat(2 * n, 2 * n, [fmpq(int(i == j)) for i in range(2 * n) for j in range(2 * n)])
    for _ in range(n):
        forms.append(power.transpose() * energy * power)
        power = a * power
    weights = definite_combination_of([[[arb(x) for x in row] for row in form.tolist()] for form in forms])
    if weights is None:
        return None
    total = forms[0] * weights[0]
    for form, weight in zip(forms[1:], weights[1:], strict=True):
        total += form * weight
    if not is_positive(total) or total * a + a.transpose() * total != total * 0:
        return None
    return tuple(fraction(w) for w in weights)


def _float(x: Any) -> float:
    return float(fraction(x))


def _rows(matrix: Numbers) -> tuple[tuple[Fraction, ...], ...]:
    return tuple(tuple(fraction(x) for x in row) for row in matrix.tolist())
