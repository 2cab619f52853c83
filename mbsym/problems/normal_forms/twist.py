"""Equilibria of Hamiltonian systems at numbers: what the normal form of order 4 or 6 decides.

Frequencies are enclosed; whatever is said to be different from zero is so by its enclosure, whatever is said to be zero
(resonances) is so by exact arithmetic, which the caller brings along.  With H_2 = sum Omega_k I_k:

* all Omega_k of one sign: H is definite, stable (Dirichlet);
* two degrees of freedom, no resonance up to order 4, D_4 = H_4(Omega_2, -Omega_1) != 0: stable (Arnold-Moser); where
  D_4 is not told from zero, no resonance up to order 6 and D_6 != 0: stable, whether D_4 vanishes or not;
* |Omega_1| = 2 |Omega_2|: unstable if the resonant term of H_3 is not zero (Markeev);
* |Omega_1| = 3 |Omega_2|: with the resonant part h xi^k + h' eta^k of H_4, k = (1, 3), for Omega.I = 0, I = t k

      H_4 = t^2 (H_4(k) + 2 sqrt(h h' 27) cos psi)

  unstable if |H_4(k)| < 2 sqrt(27 h h'), stable if it is greater (Markeev);
* w_1 = w_2: ``equal``; w_1 = 0: ``zero_root``;
* more degrees of freedom, one resonance of third order, k.Omega = 0 with all k_j >= 0: unstable if its term is not zero
  (Markeev, Khazina);
* more degrees of freedom, no resonance up to order 4: if H_4 does not vanish in the cone Omega.I = 0, I >= 0: formally
  stable (Bruno); if det d^2 H_4/dI^2 or the determinant bordered by Omega is not zero: stable for most initial states.

Sources: V. I. Arnold, Russ. Math. Surveys 18 (1963) 85; J. Moser, Lectures on Hamiltonian Systems (1968);
A. P. Markeev, J. Appl. Math. Mech. 32 (1968) 766; G. G. Khazina, J. Appl. Math. Mech. 38 (1974); A. D. Bruno, Math.
Notes 1 (1967) 216; K. R. Meyer & D. S. Schmidt, J. Diff. Eq. 62 (1986) 222 (order 6).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from fractions import Fraction
from itertools import product
from typing import Any

from flint import acb, acb_poly, arb, arb_mat, ctx

from mbsym.algebra.failures import Failure
from mbsym.algebra.matrices import faddeev
from mbsym.algebra.truncated import Space, Truncated
from mbsym.problems.normal_forms.birkhoff import (
    NormalForm,
    absolute,
    diagonalised,
    hessian,
    matrix_of,
    normal_form,
    pairing,
)
from mbsym.problems.normal_forms.result import Judged, Outcome, Resonance, Theorem, Why, defects

#: Whether k_1 w_1 + k_2 w_2 + ... = 0 for the absolute frequencies: exactly, or None where that is not known.
Decides = Callable[[tuple[int, ...], Sequence[arb]], bool | None]
#: Whether the resonant term of a vector k is zero exactly, the frequencies Omega given with their signs.
Vanishes = Callable[[tuple[int, ...], Sequence[arb]], bool]

#: Roots are isolated to these parts of the working precision; the coefficients themselves may be enclosures.
PARTS = (Fraction(2, 3), Fraction(1, 4), Fraction(1, 10))


class NotVerified(Failure):
    """The normal form does not stand its check."""

    code = "not-verified"


def _inverse(x: acb) -> acb:
    return 1 / x


def squares(hamiltonian: Truncated) -> list[acb]:
    """lambda^2 for each pair of roots, isolated.  Raises ValueError where enclosures do not tell them apart."""
    _, coefficients = faddeev(matrix_of(hamiltonian), acb(0), acb(1))
    polynomial = acb_poly(coefficients[::2])
    for part in PARTS[:-1]:
        with suppress(ValueError):
            return _isolated(polynomial, part)
    return _isolated(polynomial, PARTS[-1])


def _isolated(polynomial: acb_poly, part: Fraction) -> list[acb]:
    roots: list[acb] = polynomial.roots(tol=arb(2) ** -int(ctx.prec * part))
    return roots


def frequencies(hamiltonian: Truncated) -> list[arb] | Judged:
    """w_k > 0, largest first, each simple; or what there is to say where the roots are none of that kind."""
    try:
        roots = squares(hamiltonian)
    except ValueError:
        more = hamiltonian.space.variables > 4
        return Judged(Outcome.UNDECIDED, Theorem.NONE, Why.EQUAL_MORE if more else Why.EQUAL_FREQUENCIES)
    if any(not z.imag.contains(0) for z in roots):
        return Judged(Outcome.UNSTABLE, Theorem.FIRST)
    # each enclosure holds one root: one that is met by the real axis is its own conjugate
    real = [z.real for z in roots]
    if any(z > 0 for z in real):
        return Judged(Outcome.UNSTABLE, Theorem.FIRST)
    if not all(z < 0 for z in real):
        return Judged(Outcome.UNDECIDED, Theorem.NONE, Why.ZERO_ROOT)
    return sorted(((-z).sqrt() for z in real), key=float, reverse=True)


def definite(hamiltonian: Truncated) -> Judged | None:
    """Stable where H_2 is definite: the minors of its matrix are positive, or those of its negative (Sylvester)."""
    matrix = [[x.real for x in row] for row in hessian(hamiltonian)]
    for sign in (1, -1):
        minors = (arb_mat([[sign * x for x in row[:k]] for row in matrix[:k]]).det() for k in range(1, len(matrix) + 1))
        if all(minor > 0 for minor in minors):
            try:
                roots = squares(hamiltonian)
            except ValueError:  # frequencies that are equal
                return Judged(Outcome.STABLE, Theorem.DEFINITE)
            known = sorted((abs(z.real).sqrt() * sign for z in roots), key=abs, reverse=True)
            return Judged(Outcome.STABLE, Theorem.DEFINITE, frequencies=tuple(known))
    return None


def signed(hamiltonian: Truncated, magnitudes: Sequence[arb]) -> list[arb]:
    """Omega_k: w_k with the sign of the energy of its oscillation, by the eigenvector: Im v.J conj(v) < 0 for it."""
    result = []
    for w in magnitudes:
        d = pairing(*diagonalised(hamiltonian, [acb(0, w)], lambda x: acb(1), absolute).columns)
        if not (d.imag > 0 or d.imag < 0):
            raise NotVerified("the sign of the energy of an oscillation is not told by its enclosure")
        result.append(w if d.imag < 0 else -w)
    return result


def judged(
    lowered: Callable[[int], Truncated], resonant: Decides, order: int = 6, vanishes: Vanishes = lambda *_: False
) -> Judged:
    """What is decided; ``lowered`` gives H to an order.  Raises NotVerified where a normal form fails its check.

    ``vanishes``: whether the term of a resonance of third order is zero exactly; False where that is not known.
    """
    quadratic = lowered(2)
    sure = definite(quadratic)
    if sure is not None:
        return sure
    magnitudes = frequencies(quadratic)
    if isinstance(magnitudes, Judged):
        return magnitudes
    omega = signed(quadratic, magnitudes)
    known: dict[str, Any] = {"frequencies": tuple(omega)}
    if all(x > 0 for x in omega) or all(x < 0 for x in omega):
        return Judged(Outcome.STABLE, Theorem.DEFINITE, **known)
    exact: list[Resonance] = []
    least_open = order + 1
    for vector in vectors(len(omega), order):
        verdict = resonant(vector, magnitudes)
        if verdict is None:
            least_open = min(least_open, sum(map(abs, vector)))
        elif verdict:
            exact.append(Resonance(vector))
    exact = [resonance for resonance in exact if resonance.order < least_open]
    known["resonances"] = tuple(exact)
    if len(omega) > 2 and exact and least_open > 3:
        grows = _together(lowered, omega, exact, known)
        if grows is not None:
            return grows
    if least_open <= 4:
        return Judged(Outcome.UNDECIDED, Theorem.NONE, Why.RESONANCE_OPEN, **known)
    if len(omega) > 2:
        return _many(lowered, omega, exact, known)
    return _two(lowered, omega, exact, least_open, order, known, vanishes)


def vectors(n: int, order: int) -> list[tuple[int, ...]]:
    """k with 2 < |k| <= order without a common divisor, one of k and -k, shortest first."""
    candidates = [
        k
        for k in product(range(-order, order + 1), repeat=n)
        if 2 < sum(map(abs, k)) <= order and next(x for x in k if x) > 0 and _primitive(k)
    ]
    return sorted(candidates, key=lambda k: (sum(map(abs, k)), k))


def _primitive(k: Sequence[int]) -> bool:
    from math import gcd

    return gcd(*k) == 1


def _formed(
    lowered: Callable[[int], Truncated], omega: Sequence[arb], exact: Sequence[Resonance], order: int
) -> NormalForm:
    """The verified normal form with lambda_k = i Omega_k."""
    whole = lowered(order)
    space = Space(2 * len(omega), order, acb(0), acb(1))
    linear = diagonalised(whole, [acb(0, w) for w in omega], _inverse, absolute)
    resonances: set[tuple[int, ...]] = set()
    for resonance in exact:
        oriented = tuple(k if w > 0 else -k for k, w in zip(resonance.vector, omega, strict=True))
        for times in range(1, order // resonance.order + 1):
            resonances |= {tuple(s * times * k for k in oriented) for s in (1, -1)}
    form = normal_form(whole, linear, _inverse, resonances, space)
    if not all(value.contains(0) for value in defects(whole, form)):
        raise NotVerified("the normal form, substituted, is not what the Hamiltonian becomes")
    return form


def _quadratic(form: NormalForm) -> dict[tuple[int, int], arb]:
    """The coefficients of I_j I_k, j <= k: P = -i I."""
    coefficients = {}
    for key, value in form.actions(2).items():
        places = [k for k, times in enumerate(key) for _ in range(times)]
        coefficients[places[0], places[1]] = (-value).real
    return coefficients


def _two(
    lowered: Callable[[int], Truncated],
    omega: Sequence[arb],
    exact: Sequence[Resonance],
    least_open: int,
    order: int,
    known: dict[str, Any],
    vanishes: Vanishes,
) -> Judged:
    by_order = {resonance.order: resonance for resonance in exact}
    form = _formed(lowered, omega, exact, 4)
    if 3 in by_order:
        size = _amplitude(form, by_order[3].vector, omega)
        if size > 0:
            return Judged(Outcome.UNSTABLE, Theorem.THIRD, **known)
        if not (_absent(form, by_order[3].vector, omega) or vanishes(by_order[3].vector, omega)):
            return Judged(Outcome.UNDECIDED, Theorem.NONE, Why.RESONANT_TERM_OPEN, **known)
    known["quadratic"] = tuple(sorted(_quadratic(form).items()))
    if 4 in by_order:
        vector = by_order[4].vector
        left = abs(_at(_quadratic(form), [arb(abs(k)) for k in vector]))
        right = 2 * _root(27 * _amplitude(form, vector, omega))
        known["sides"] = (left, right)
        if left < right:
            return Judged(Outcome.UNSTABLE, Theorem.FOURTH, **known)
        if left > right:
            return Judged(Outcome.STABLE, Theorem.FOURTH, **known)
        return Judged(Outcome.UNDECIDED, Theorem.NONE, Why.EQUALITY, **known)
    determinant = _at(_quadratic(form), [omega[1], -omega[0]])
    known["determinants"] = ((4, determinant),)
    if determinant != 0:
        return Judged(Outcome.STABLE, Theorem.ARNOLD_MOSER, **known)
    if order < 6 or least_open <= 6:
        return Judged(Outcome.UNDECIDED, Theorem.NONE, Why.DETERMINANT_OPEN, **known)
    if any(4 < resonance.order <= 6 or resonance.order == 3 for resonance in exact):
        return Judged(Outcome.UNDECIDED, Theorem.NONE, Why.RESONANCE, **known)
    sixth = _formed(lowered, omega, exact, 6).actions(3)
    total = acb(0)
    for (i, j), value in sixth.items():
        total += value * acb(0, 1) ** 3 * acb(-1) ** 3 * omega[1] ** i * (-omega[0]) ** j
    known["determinants"] += ((6, total.real),)
    if total.real != 0:
        return Judged(Outcome.STABLE, Theorem.ARNOLD_MOSER_6, **known)
    return Judged(Outcome.UNDECIDED, Theorem.NONE, Why.DETERMINANT_OPEN, **known)


def _keys(vector: Sequence[int], omega: Sequence[arb]) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """The exponents of the two resonant products, of the xi and of the eta alone, for k.Omega = 0 with k >= 0."""
    sizes = tuple(map(abs, vector))
    nothing = (0,) * len(sizes)
    return (*sizes, *nothing), (*nothing, *sizes)


def _amplitude(form: NormalForm, vector: Sequence[int], omega: Sequence[arb]) -> arb:
    """|h h'| of the resonant part h xi^k + h' eta^k."""
    first, second = (form.hamiltonian[key] for key in _keys(vector, omega))
    return abs(acb(first) * acb(second))


def _root(square: arb) -> arb:
    """The square root of what is not negative, be its enclosure so or not."""
    return square.sqrt() if square > 0 else arb(0).union(square.upper().sqrt())


def _absent(form: NormalForm, vector: Sequence[int], omega: Sequence[arb]) -> bool:
    """Whether the resonant part is exactly zero."""
    return all(key not in form.hamiltonian.coefficients for key in _keys(vector, omega))


def _at(quadratic: dict[tuple[int, int], arb], point: Sequence[arb]) -> arb:
    total = arb(0)
    for (i, j), value in quadratic.items():
        total += value * point[i] * point[j]
    return total


# --- more degrees of freedom ---


def _together(
    lowered: Callable[[int], Truncated], omega: Sequence[arb], exact: Sequence[Resonance], known: dict[str, Any]
) -> Judged | None:
    """Unstable where one resonance of third order alone holds, k.Omega = 0 with k >= 0, and its term is not zero.

    To third order H = Omega.I + c r cos psi, r = prod I_j^(k_j/2), psi = k.phi.  Then V = r sin psi has
    V' = c sum k_j^2 r^2/(2 I_j) + O(5), and J, the I_m beside and the differences I_i/k_i - I_j/k_j, have J' = O(4).
    Where W = V - N sum |J|^(3/2) > 0, for a large N, all I_j are of one size and the I_m smaller, so that W' > 0
    (Chetaev).  None where that is not the case.
    """
    third = [resonance for resonance in exact if resonance.order == 3]
    if len(third) != 1:
        return None
    signs = {k * w > 0 for k, w in zip(third[0].vector, omega, strict=True) if k}
    if len(signs) != 1:
        return None
    form = _formed(lowered, omega, third, 3)
    if _amplitude(form, third[0].vector, omega) > 0:
        return Judged(Outcome.UNSTABLE, Theorem.THIRD_OF_MORE, **known)
    return None


def _many(
    lowered: Callable[[int], Truncated], omega: Sequence[arb], exact: Sequence[Resonance], known: dict[str, Any]
) -> Judged:
    if any(resonance.order <= 4 for resonance in exact):
        return Judged(Outcome.UNDECIDED, Theorem.NONE, Why.RESONANCE, **known)
    quadratic = _quadratic(_formed(lowered, omega, exact, 4))
    known["quadratic"] = tuple(sorted(quadratic.items()))
    if _nonzero_in_cone(quadratic, omega):
        return Judged(Outcome.FORMAL, Theorem.BRUNO, **known)
    if _nondegenerate(quadratic, omega):
        return Judged(Outcome.MOST, Theorem.ARNOLD, Why.FORM_OPEN, **known)
    return Judged(Outcome.UNDECIDED, Theorem.NONE, Why.FORM_OPEN, **known)


def _matrix(quadratic: dict[tuple[int, int], arb], n: int) -> list[list[arb]]:
    return [[quadratic.get((min(i, j), max(i, j)), arb(0)) / (1 if i == j else 2) for j in range(n)] for i in range(n)]


def _nonzero_in_cone(quadratic: dict[tuple[int, int], arb], omega: Sequence[arb]) -> bool:
    """Whether H_4 != 0 for I >= 0, I != 0, Omega.I = 0, by the rays that span this cone.

    With all products r_i.A r_j of one sign it has that sign; between two rays also where (r_1.A r_2)^2 is less than the
    product of the squares.
    """
    n, matrix = len(omega), _matrix(quadratic, len(omega))
    rays = []
    for i in range(n):
        for j in range(n):
            if omega[i] > 0 and omega[j] < 0:
                rays.append([-omega[j] if k == i else omega[i] if k == j else arb(0) for k in range(n)])
    values = [
        [sum((a[i] * matrix[i][j] * b[j] for i in range(n) for j in range(n)), arb(0)) for b in rays] for a in rays
    ]
    for sign in (1, -1):
        if all(sign * value > 0 for row in values for value in row):
            return True
    if len(rays) != 2:
        return False
    (a, b), (_, c) = values
    return bool(a * c > 0 and a * c - b * b > 0)


def _nondegenerate(quadratic: dict[tuple[int, int], arb], omega: Sequence[arb]) -> bool:
    """det d^2 H_4/dI^2 != 0, or the determinant bordered by Omega."""
    matrix = _matrix(quadratic, len(omega))
    bordered = [[*row, w] for row, w in zip(matrix, omega, strict=True)] + [[*omega, arb(0)]]
    return bool(arb_mat(matrix).det() != 0 or arb_mat(bordered).det() != 0)
