"""Problem 8 at rational numbers: Kalman's rank, feedback found in floating point and proved, bundles of energies.

    z' = A z + B u,    z = (x, x'),    A = [ 0, 1; -M^-1 S, -M^-1 C ],    B = [ 0; M^-1 B ]

Of coordinates that follow by equations of first order (their rows of M are zero, as under constraints in velocities) z
has no x', and their rows of B are C_ff^-1 B_f.

Everything but the search is exact.  At irrational values matrices are enclosed in balls: a rank is proved where it is
full, and a feedback that is found at rational values near them by a Lyapunov function that is one in all of the balls.

Sources: R. E. Kalman (1960); W. F. Arnold & A. J. Laub, Proc. IEEE 72 (1984) (LQR
by Schur vectors, in SciPy).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import arb, arb_mat, fmpq, fmpq_mat, fmpq_mpoly_ctx, fmpq_poly

from mbsym.algebra.rationals import fraction, middle, rounded
from mbsym.algebra.roots import count_roots
from mbsym.expressions.message import Message
from mbsym.problems.stabilisation.result import Feedback
from mbsym.problems.stability.bundle import definite_combination_of
from mbsym.problems.stability.exact import is_positive, verdict_at
from mbsym.problems.stability.linear_form import LinearSystem, NonholonomicForm, state_matrix
from mbsym.problems.stability.verdict import Verdict

#: Significant digits to which gains and Lyapunov functions are rounded, until the proof succeeds.
DIGITS = (2, 3, 4, 6, 9, 12)

#: A gain that is smaller, beside the largest one, is a rounding of zero.
NOISE = 1e-11

Numbers = Any  # a flint.fmpq_mat


@dataclass(frozen=True)
class AtValues:
    """M, C, S (n x n) and B (n x m; None without inputs), rational or enclosed; z' is determined by z."""

    mass: Numbers
    rates: Numbers
    places: Numbers
    inputs: Numbers | None

    @property
    def size(self) -> int:
        return int(self.mass.nrows())

    @property
    def state(self) -> Numbers:
        """A, 2n x 2n, less by one for each coordinate that follows.  Raises ZeroDivisionError where z' is open."""
        return state_matrix(self.kind, self.mass.tolist(), self.rates.tolist(), self.places.tolist(), self.following)

    @property
    def kind(self) -> Any:
        """fmpq_mat or arb_mat."""
        return type(self.mass)

    @property
    def enclosed(self) -> bool:
        """Whether the matrices are balls."""
        return bool(self.kind is arb_mat)

    @property
    def middle(self) -> AtValues:
        """Rational matrices in the middle of the balls."""

        def of(matrix: Numbers) -> Numbers:
            return fmpq_mat(matrix.nrows(), matrix.ncols(), [middle(x) for x in matrix.entries()])

        inputs = None if self.inputs is None else of(self.inputs)
        return AtValues(of(self.mass), of(self.rates), of(self.places), inputs)

    @property
    def following(self) -> tuple[int, ...]:
        """The coordinates whose rows of M are zero."""
        return tuple(i for i, row in enumerate(self.mass.tolist()) if all(x == 0 for x in row))

    @property
    def moving(self) -> list[int]:
        """The others, whose velocities are in z."""
        return [i for i in range(self.size) if i not in self.following]

    def gain(self, inputs: Numbers) -> Numbers:
        """[ 0; M^-1 B ]."""
        kind = self.kind
        rows = [[kind(1, 1)[0, 0]] * inputs.ncols() for _ in range(self.size + len(self.moving))]
        for lines, leading, places in (
            (self.moving, self.mass, range(self.size, len(rows))),
            (self.following, self.rates, self.following),
        ):
            if lines:
                block = kind(len(lines), len(lines), [leading[i, j] for i in lines for j in lines])
                right = kind(len(lines), inputs.ncols(), [x for i in lines for x in inputs.tolist()[i]])
                for place, row in zip(places, block.solve(right).tolist(), strict=True):
                    rows[place] = row
        return kind(len(rows), inputs.ncols(), [x for row in rows for x in row])

    def only(self, at: Sequence[int]) -> AtValues:
        """The block of some coordinates."""

        def block(matrix: Numbers) -> Numbers:
            return self.kind(len(at), len(at), [matrix[i, j] for i in at for j in at])

        inputs = self.inputs
        if inputs is not None:
            inputs = self.kind(len(at), inputs.ncols(), [inputs[i, j] for i in at for j in range(inputs.ncols())])
        return AtValues(block(self.mass), block(self.rates), block(self.places), inputs)


def kalman_rows(a: Numbers, b: Numbers) -> list[list[Any]]:
    """[ B, A B, A^2 B, ... ]."""
    columns, step = b.tolist(), b
    for _ in range(a.nrows() - 1):
        step = a * step
        columns = [row + more for row, more in zip(columns, step.tolist(), strict=True)]
    return [list(row) for row in columns]


def kalman_rank(a: Numbers, b: Numbers) -> int:
    """The rank of that."""
    rows = kalman_rows(a, b)
    return int(fmpq_mat(len(rows), len(rows[0]), [x for row in rows for x in row]).rank())


def is_controllable(there: AtValues) -> bool | None:
    """Exactly; in balls True where that is certain, else None."""
    assert there.inputs is not None
    a = there.state
    if not there.enclosed:
        return kalman_rank(a, there.gain(there.inputs)) == a.nrows()
    near = there.middle
    assert near.inputs is not None
    rows = kalman_rows(near.state, near.gain(near.inputs))
    chosen = fmpq_mat(len(rows), len(rows[0]), [x for row in rows for x in row]).rref()[0].tolist()
    pivots = [next(j for j, x in enumerate(row) if x != 0) for row in chosen if any(x != 0 for x in row)]
    if len(pivots) < len(rows):
        return None
    enclosed = kalman_rows(a, there.gain(there.inputs))
    block = arb_mat(len(rows), len(rows), [row[j] for row in enclosed for j in pivots])
    return None if block.det().contains(0) else True


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
    independent: list[list[Any]] = []
    for vector in vectors:
        rows = [*independent, list(vector)]
        if fmpq_mat(len(rows), len(vector), [x for row in rows for x in row]).rank() == len(rows):
            independent = rows
    return independent


def is_stabilisable(there: AtValues) -> bool | None:
    """Whether what the inputs do not reach decays by itself; None of balls where that is not known."""
    assert there.inputs is not None
    if there.enclosed:
        return is_controllable(there)
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

    at_values, there = there, there.middle if there.enclosed else there
    assert there.inputs is not None
    if not is_stabilisable(there):
        if at_values.enclosed:
            return "near the given values, which are irrational, a motion that does not decay is out of reach"
        return "a motion that does not decay is out of reach of the inputs (proved)"
    a, b = there.state, there.gain(there.inputs)
    n, m = a.nrows(), b.ncols()
    first, second = (np.array([[_float(x) for x in row] for row in matrix.tolist()]) for matrix in (a, b))
    try:
        riccati = solve_continuous_are(first, second, np.eye(n), np.eye(m))
        optimal_gains = second.T @ riccati
    except (LinAlgError, ValueError) as error:
        return Message("the Riccati equation was not solved: [[why]]", why=error)
    if not np.isfinite(optimal_gains).all():
        return "the Riccati equation was not solved in floating point"
    noise = np.abs(optimal_gains) < NOISE * np.max(np.abs(optimal_gains))
    for digits in DIGITS:
        gains = fmpq_mat(m, n, [rounded(float(x), digits) for x in np.where(noise, 0.0, optimal_gains).flatten()])
        closed = a - b * gains
        characteristic = closed.charpoly().coeffs()
        roots = count_roots(characteristic)
        if roots.left != roots.degree:
            continue
        verdict = _judged(there, gains)
        if not verdict.word.asymptotic:
            return "the two judges of the closed loop disagree"
        function = lyapunov_function(closed)
        if at_values.enclosed and (function is None or not _proves_enclosed(at_values, gains, function)):
            continue
        coefficients = () if at_values.enclosed else tuple(fraction(x) for x in characteristic)
        return Feedback((), "", _rows(gains), coefficients, verdict, function)
    return "no rounded feedback was proved to work"


def _proves_enclosed(there: AtValues, gains: Numbers, function: Sequence[Sequence[Fraction]]) -> bool:
    """Whether P A + A^T P < 0 for every A in the balls of the closed loop."""
    assert there.inputs is not None
    n = len(function)
    p = arb_mat(n, n, [arb(fmpq(x.numerator, x.denominator)) for row in function for x in row])
    closed = there.state - there.gain(there.inputs) * arb_mat(gains)
    rate = p * closed
    rows = (-(rate + rate.transpose())).tolist()
    for k in range(n):  # pivots of the elimination, each certainly positive
        if not rows[k][k] > 0:
            return False
        for i in range(k + 1, n):
            factor = rows[i][k] / rows[k][k]
            rows[i] = [x - factor * y for x, y in zip(rows[i], rows[k], strict=True)]
    return True


def _of_all(there: AtValues, gains: Numbers) -> Numbers:
    """Gains of (x, x'), with 0 for velocities that are not in z."""
    columns = {k: k for k in range(there.size)} | {there.size + i: there.size + k for k, i in enumerate(there.moving)}
    places = range(2 * there.size)
    rows = [[row[columns[k]] if k in columns else fmpq(0) for k in places] for row in gains.tolist()]
    return fmpq_mat(len(rows), len(places), [x for row in rows for x in row])


def _judged(there: AtValues, whole: Numbers) -> Verdict:
    """The verdict of problem 6 on  M x'' + (C + B k_v) x' + (S + B k_x) x = 0,  the gains being k_x and k_v."""
    gains = _of_all(there, whole)
    n, m = there.size, gains.nrows()
    assert there.inputs is not None
    split = [fmpq_mat(m, n, [gains[i, k * n + j] for i in range(m) for j in range(n)]) for k in (0, 1)]
    rates, places = there.rates + there.inputs * split[1], there.places + there.inputs * split[0]
    context = fmpq_mpoly_ctx.get(["x"], "lex")

    def part(matrix: Numbers, sign: int) -> Any:
        half = (matrix + matrix.transpose() * fmpq(sign)) * fmpq(1, 2)
        return tuple(tuple(context.constant(x) for x in row) for row in half.tolist())

    mass = tuple(tuple(context.constant(x) for x in row) for row in there.mass.tolist())
    form = NonholonomicForm(following=there.following) if there.following else None
    closed = LinearSystem(mass, part(rates, 1), part(rates, -1), part(places, 1), part(places, -1), nonholonomic=form)
    return verdict_at(closed, {}).verdict


def lyapunov_function(a: Numbers) -> tuple[tuple[Fraction, ...], ...] | None:
    """A rational P with P > 0 and P A + A^T P < 0, both proved by leading minors; None where none was found."""
    import numpy as np
    from scipy.linalg import solve_continuous_lyapunov

    n = a.nrows()
    floats = np.array([[_float(x) for x in row] for row in a.tolist()])
    solution = solve_continuous_lyapunov(floats.T, -np.eye(n))
    if not np.isfinite(solution).all():
        return None
    for digits in DIGITS:
        rows = [[rounded(float(solution[min(i, j), max(i, j)]), digits) for j in range(n)] for i in range(n)]
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
