"""The normal form of order 4 of equal frequencies by averages along the linear flow, without eigenvectors.

Where A^2 = -w^2 the flow of H_2 is  phi_t = cos(w t) + A sin(w t)/w.  With chi the antiderivative of H_3 along it that
has no mean,  d/dt chi(phi_t x) = H_3(phi_t x),  that is {H_2, chi} = -H_3,

    K_4 = mean over a period of  (H_4 + {H_3, chi}/2) o phi_t.

Along the flow a form of degree d is a trigonometric polynomial of degree d: means of eight values are exact.
"""

from __future__ import annotations

from collections.abc import Sequence

from flint import acb, arb

from mbsym.algebra.truncated import Space, Truncated, bracket
from mbsym.problems.normal_forms.birkhoff import matrix_of

#: Places on a period: more than the sum of two degrees that are told apart, 4 and 3.
PLACES = 8


def averaged(hamiltonian: Truncated, w: arb) -> Truncated:
    """K_4 in the variables of H, which is given to order 4."""
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
