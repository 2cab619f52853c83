"""Eigenvalues of the first approximation at numbers: the roots lambda of  det(lambda^2 M + lambda (D + G) + K + N) = 0.

They are told in physical time (1/s if the description's values are in SI units), by certified enclosures.  They are for
reading: verdicts and counts of problem 6 never rest on them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from flint import acb, ctx

from mbsym.algebra.roots import Root, enclosures
from mbsym.problems.stability.enclosed import Rows, eigenvalues

#: Working precision of enclosures, in bits.
PRECISION = 128


@dataclass(frozen=True)
class Spectrum:
    """The eigenvalues of one subsystem; sorted by real, then imaginary part."""

    coordinates: tuple[str, ...]
    roots: tuple[Root, ...]


def from_characteristic(coordinates: Sequence[str], characteristic: Sequence[Any], scale: Any) -> Spectrum:
    """From the exact polynomial (coefficients low to high) in lambda/scale, tau = scale t."""
    found = enclosures(characteristic, PRECISION)
    return Spectrum(tuple(coordinates), tuple(Root(_times(x.ball, scale), x.multiplicity) for x in found))


def from_matrices(coordinates: Sequence[str], parts: Sequence[Rows], following: Sequence[int] = ()) -> Spectrum | None:
    """From M, D, G, K, N in balls; None where M is singular or the roots cannot be enclosed.

    Roots that lie together are listed one by one.
    """
    m, d, g, k, n = parts
    size = range(len(coordinates))
    velocity, position = ([[x[i][j] + y[i][j] for j in size] for i in size] for x, y in ((d, g), (k, n)))
    try:
        with ctx.workprec(PRECISION):
            found, _ = eigenvalues(m, velocity, position, following)
    except ZeroDivisionError:
        return None
    if found is None:
        return None
    found.sort(key=lambda ball: (float(ball.real.mid()), float(ball.imag.mid())))
    return Spectrum(tuple(coordinates), tuple(Root(ball, 1) for ball in found))


def _times(ball: acb, scale: Any) -> acb:
    with ctx.workprec(PRECISION):
        return ball * scale


@dataclass(frozen=True)
class RootNumbers:
    """A root, or a pair of conjugate ones (``imaginary`` > 0), as numbers; a part that may be 0 is 0."""

    real: float
    imaginary: float
    multiplicity: int


def numbers(spectrum: Spectrum) -> tuple[RootNumbers, ...]:
    """Pairs of conjugate roots once, by their upper half."""
    found = []
    for root in spectrum.roots:
        real, imaginary = (0.0 if part.contains(0) else float(part.mid()) for part in (root.ball.real, root.ball.imag))
        if imaginary >= 0:
            found.append(RootNumbers(real, imaginary, root.multiplicity))
    return tuple(found)
