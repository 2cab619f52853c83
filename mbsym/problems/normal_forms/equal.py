"""Two degrees of freedom with equal frequencies, w_1 = w_2 = w exactly, H_2 not definite.

* One eigenvector for each root (the linear part grows).  The normal form, in real canonical coordinates

      H = w (x_1 y_2 - x_2 y_1) + delta (x_1^2 + x_2^2)/2 + A (y_1^2 + y_2^2)^2 + ...,      delta = +-1

  is stable for delta A > 0 and unstable for delta A < 0 (Sokolskii; the proof of stability: Kovalev & Chudnenko).
  At Routh's ratio of masses of the restricted problem of three bodies A = 59/864 (Schmidt).

* Two eigenvectors: H_2 = w (I_1 - I_2).  With the phase f = f_1 + f_2, which H_2 leaves, the normal form of order 4 is

      H_4(I, I, f) = I^2 P(f),      P(f) = sum p_m e^(i m f), m = -2 ... 2

  on H_2 = 0.  No zero of P: stable; a simple one: unstable; else not decided at this order (Sokolskii; Cabral & Meyer).

What decides is enclosed; the normal forms are checked by substitution, delta A besides by the amplitude equation on the
plane of the roots (``centre.on_double_pair``), which uses no Hamiltonian, and P by averages along the linear flow
(``averaged``), which use no eigenvectors.

Sources: A. G. Sokolskii, J. Appl. Math. Mech. 38 (1974) 741; A. M. Kovalev & A. N. Chudnenko, Dokl. AN UkrSSR A (1977)
1011; D. S. Schmidt, in Hamiltonian Dynamical Systems, IMA 63 (1995) 331; H. E. Cabral & K. R. Meyer, Nonlinearity 12
(1999) 1351.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from flint import acb, arb

from mbsym.algebra.matrices import dot, faddeev
from mbsym.algebra.truncated import Space, Truncated, bracket
from mbsym.problems.normal_forms.birkhoff import Linear, NormalForm, matrix_of, normal_form, pairing
from mbsym.problems.normal_forms.exact import on_double_pair
from mbsym.problems.normal_forms.result import Judged, Outcome, Theorem, Why, defects
from mbsym.problems.normal_forms.twist import NotVerified, definite
from mbsym.problems.normal_forms.zero_root import conjugate, on_double_root

#: Arcs of 2 pi/2^MOST_HALVINGS are not halved again.
MOST_HALVINGS = 40
#: More arcs than these are not looked at.
MOST_ARCS = 4000
#: Where the first arc begins: not at an angle at which zeros are likely.
OFFSET = arb("0.1234")


#: Places on a period: more than the sum of two degrees that are told apart, 4 and 3.
PLACES = 8


def equal_frequencies(hamiltonian: Truncated, two_eigenvectors: bool | None = None) -> Judged:
    """What is decided; H is needed to order 4.

    ``two_eigenvectors``: whether A^2 + w^2 = 0, exactly; None where only enclosures of A are known.  Raises NotVerified
    where a normal form does not stand its check.
    """
    sure = definite(hamiltonian)
    if sure is not None:
        return sure
    square = faddeev(matrix_of(hamiltonian), acb(0), acb(1))[1][2].real / 2
    if square < 0:
        return Judged(Outcome.UNSTABLE, Theorem.FIRST)
    if not square > 0:
        return Judged(Outcome.UNDECIDED, Theorem.NONE, Why.ZERO_TWO)
    w = square.sqrt()
    if two_eigenvectors:
        return _of_two_eigenvectors(hamiltonian, w)
    return _of_one_eigenvector(hamiltonian, w)


def _open(w: arb) -> Judged:
    return Judged(Outcome.UNDECIDED, Theorem.NONE, Why.EQUAL_FREQUENCIES, frequencies=(w, -w))


# --- one eigenvector ---


def _of_one_eigenvector(hamiltonian: Truncated, w: arb) -> Judged:
    form, e = on_double_root(hamiltonian, acb(0, w))
    value = (form.hamiltonian[2, 0, 0, 2] * e).real
    if not value.is_finite() or not (e.real > 0 or e.real < 0):
        return _open(w)
    _verify(hamiltonian, form)
    column = form.linear.columns[0]
    length = sum((x * x.conjugate() for x in column), acb(0)).real
    if not _by_amplitudes(hamiltonian, w).overlaps(-2 * value / length):
        raise NotVerified("the normal form and the amplitude equation differ")
    # A = h/4 of the term h xi_1^2 eta_2^2: xi_1 = (y_1 + i y_2)/sqrt(2 |e|), eta_2 = -e xi_1*
    product = abs(form.hamiltonian[2, 0, 0, 2].real) / 4
    if value > 0:
        return Judged(Outcome.STABLE, Theorem.EQUAL, frequencies=(w, -w), coefficient=product)
    if value < 0:
        return Judged(Outcome.UNSTABLE, Theorem.EQUAL, frequencies=(w, -w), coefficient=-product)
    return _open(w)


def _by_amplitudes(hamiltonian: Truncated, w: arb) -> arb:
    """c of r'' = c r^3 + ..., r^2 the sum of the squares of the amplitudes of all variables."""
    rows = [hamiltonian.derivative(2 + i) for i in range(2)] + [-hamiltonian.derivative(i) for i in range(2)]
    space = Space(4, 3, acb(0), acb(1))
    field = [Truncated(space, row.coefficients) for row in rows]
    by_amplitudes: arb = on_double_pair(field, acb(0, w), lambda x: 1 / x, lambda x: float(abs(x).mid())).real
    return by_amplitudes


def _verify(hamiltonian: Truncated, form: NormalForm) -> None:
    if not all(value.contains(0) for value in defects(hamiltonian, form)):
        raise NotVerified("the normal form, substituted, is not what the Hamiltonian becomes")


# --- two eigenvectors ---


def _of_two_eigenvectors(hamiltonian: Truncated, w: arb) -> Judged:
    columns = _eigenvectors(hamiltonian, w)
    if columns is None:
        return _open(w)
    first, second = columns
    # [v, v*] = -i |d| of both: H_2 = w (I_1 - I_2) with I = |d| xi xi*
    weights = [abs(pairing(v, conjugate(v)).imag) for v in (first, second)]
    conjugates = [tuple(x / pairing(v, conjugate(v)) for x in conjugate(v)) for v in (first, second)]
    linear = Linear((acb(0, w), acb(0, -w)), (tuple(first), tuple(second), *conjugates))
    resonances = [(k, k) for k in (-2, -1, 1, 2)]
    form = normal_form(hamiltonian, linear, lambda x: 1 / x, resonances, Space(4, 4, acb(0), acb(1)))
    _verify(hamiltonian, form)
    known: dict[str, Any] = {"frequencies": (w, -w)}
    series = _on_the_cone(form, weights)
    _verify_on_the_cone(hamiltonian, form, weights, series)
    outcome = _by_zeros(series)
    if outcome is Outcome.UNDECIDED:
        return Judged(outcome, Theorem.NONE, Why.CONE_OPEN, **known)
    return Judged(outcome, Theorem.EQUAL_TWO, **known)


def _verify_on_the_cone(
    hamiltonian: Truncated, form: NormalForm, weights: Sequence[arb], series: Sequence[acb]
) -> None:
    """P(f) against the averages along the linear flow, at as many points of H_2 = 0 as it has coefficients."""
    mean = averaged(hamiltonian, abs(form.linear.roots[0].imag))
    for k in range(len(series)):
        f = OFFSET + k
        xi = [acb(0, f).exp() / weights[0].sqrt(), 1 / acb(weights[1]).sqrt()]
        eta = [acb(0, -1) * d * x.conjugate() for d, x in zip(weights, xi, strict=True)]
        rows = zip(*form.linear.columns, strict=True)
        point = [dot(row, (*xi, *eta)) for row in rows]
        real = all(x.imag.contains(0) for x in point)
        on_cone = at_point(hamiltonian.part(2), point).contains(0)
        value, other = _at(series, f), at_point(mean, point).real
        if not (real and on_cone and value.is_finite() and other.is_finite() and value.overlaps(other)):
            raise NotVerified("the normal form on the cone and the averages along the linear flow differ")


def _eigenvectors(hamiltonian: Truncated, w: arb) -> tuple[list[acb], list[acb]] | None:
    """v_1 for i w, v_2 for -i w with [v, v*] = -i |d| of both and [v_1, v_2] = 0; None where that is not proved.

    The eigenvectors of i w are the columns of A + i w.
    """
    matrix, m = matrix_of(hamiltonian), 4
    plane = [[matrix[i][j] + (acb(0, w) if i == j else 0) for i in range(m)] for j in range(m)]
    tried = [*plane]
    for i in range(m):
        for j in range(i):
            tried += [[x + f * y for x, y in zip(plane[i], plane[j], strict=True)] for f in (acb(1), acb(0, 1))]
    first = next((v for v in tried if pairing(v, conjugate(v)).imag < 0), None)
    if first is None:
        return None
    own = pairing(first, conjugate(first))
    for v in tried:
        factor = pairing(v, conjugate(first)) / own
        rest = [x - factor * y for x, y in zip(v, first, strict=True)]
        if pairing(rest, conjugate(rest)).imag > 0:
            return first, conjugate(rest)
    return None


def _on_the_cone(form: NormalForm, weights: Sequence[arb]) -> list[acb]:
    """p_m, m = -2 ... 2: H_4 where I_1 = I_2 = 1; xi_k = e^(i f_k)/sqrt|d_k|, eta_k = -i |d_k| xi_k*."""
    coefficients = [acb(0)] * 5
    for (a, b, c, d), value in form.hamiltonian.part(4).coefficients.items():
        scale = weights[0].sqrt() ** (c - a) * weights[1].sqrt() ** (d - b)
        coefficients[2 + a - c] += value * scale * acb(0, -1) ** (c + d)
    return coefficients


def _by_zeros(series: Sequence[acb]) -> Outcome:
    """Stable where P, real for real f, has no zero; unstable where it has a simple one.

    Arcs are halved until P, or P', is not zero on them: a change of its sign is a simple zero where P' has none.
    """
    slopes = [p * acb(0, m) for m, p in enumerate(series, start=-2)]
    if all(p.contains(0) for p in series):
        return Outcome.UNDECIDED
    sure, seen, pending = True, 0, [(k, 5) for k in range(2**5)]
    while pending:
        k, halvings = pending.pop()
        step = arb.pi() / 2 ** (halvings - 1)
        low, high = step * k + OFFSET, step * (k + 1) + OFFSET
        arc = low.union(high)
        middle = (low + high) / 2
        if _at(series, middle) + _at(slopes, arc) * (arc - middle) != 0:
            continue
        if _at(slopes, arc) != 0:
            ends = _at(series, low) * _at(series, high)
            if ends < 0:
                return Outcome.UNSTABLE
            if ends > 0:
                continue
        seen += 1
        if seen == MOST_ARCS:
            return Outcome.UNDECIDED
        if halvings == MOST_HALVINGS:
            sure = False
            continue
        pending += [(2 * k, halvings + 1), (2 * k + 1, halvings + 1)]
    return Outcome.STABLE if sure else Outcome.UNDECIDED


def _at(series: Sequence[acb], f: arb) -> arb:
    total = acb(0)
    for m, p in enumerate(series, start=-2):
        total += p * acb(0, f * m).exp()
    return total.real


def averaged(hamiltonian: Truncated, w: arb) -> Truncated:
    """K_4 in the variables of H, which is given to order 4: by averages along the linear flow, without eigenvectors.

    Where A^2 = -w^2 the flow of H_2 is  phi_t = cos(w t) + A sin(w t)/w.  With chi the antiderivative of H_3 along it
    that has no mean,  d/dt chi(phi_t x) = H_3(phi_t x),  that is {H_2, chi} = -H_3,

        K_4 = mean over a period of  (H_4 + {H_3, chi}/2) o phi_t.

    Along the flow a form of degree d is a trigonometric polynomial of degree d: means of eight values are exact.
    """
    space = Space(hamiltonian.space.variables, 4, acb(0), acb(1))
    h = Truncated(space, hamiltonian.coefficients)
    matrix = matrix_of(h)
    turned = []
    for k in range(PLACES):
        c, s = (arb(2 * k) / PLACES).cos_pi(), (arb(2 * k) / PLACES).sin_pi()
        rows = [[acb(c * int(i == j)) + x * acb(s / w) for j, x in enumerate(row)] for i, row in enumerate(matrix)]
        turned.append((k, [space.linear(row) for row in rows]))
    chi, mean = space.nothing, space.nothing
    third = h.part(3)
    for k, images in turned:
        weight = sum(((arb(2 * k * m) / PLACES).sin_pi() / m for m in (1, 3)), arb(0))
        chi = chi + third.composed(images).scaled(acb(-2 * weight / (w * PLACES)))
    fourth = h.part(4) + bracket(third, chi).scaled(acb("0.5"))
    for _, images in turned:
        mean = mean + fourth.composed(images).scaled(acb(1) / PLACES)
    return mean


def at_point(p: Truncated, point: Sequence[acb]) -> acb:
    """The value of a polynomial."""
    total = acb(0)
    for key, value in p.coefficients.items():
        for x, exponent in zip(point, key, strict=True):
            value = value * x**exponent
        total += value
    return total
