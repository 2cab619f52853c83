"""Measures of the eigenvalues: all of them, the decay of the slowest, the frequencies.

The roots lambda of  det(lambda^2 M + lambda (D + G) + K + N) = 0  are computed in floats (LAPACK), for all points of a
chunk at once, from matrices that come from machine code.  Nothing is proved of them; ``stability`` is what proves.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from mbsym.maps.section import Section
from mbsym.numerics.kernels import llvm
from mbsym.numerics.kernels.interface import Code
from mbsym.problems.stability.linear_form import add
from mbsym.sweeps.measure import Column
from mbsym.sweeps.polynomials import written

#: Parts of a root below this share of the largest root are rounding, of a root that may be a multiple one.
NEGLIGIBLE = 1e-7


class RootsMeasure:
    """The roots of every point, sorted by falling real part, then imaginary part: real1, imaginary1, real2, ...

    ``unit`` says in what they are counted; a point where M is singular has none (not a number).
    """

    def __init__(self, section: Section, unit: str) -> None:
        self.unit = unit
        self._sizes = tuple(part.size for part in section.parts)
        entries = [
            x
            for part in section.parts
            for matrix in (part.M, add(part.D, part.G), add(part.K, part.N))
            for row in matrix
            for x in row
        ]
        program, names, nodes = written(entries, [axis.name for axis in section.axes])
        self._kernel = llvm.kernels({"entries": Code(program, names, tuple(nodes))}, wide=True)["entries"]

    @property
    def columns(self) -> tuple[Column, ...]:
        found = []
        for number in range(1, 2 * sum(self._sizes) + 1):
            found.append(Column(f"real{number}", f"real part of eigenvalue {number}, in {self.unit}"))
            found.append(Column(f"imaginary{number}", f"imaginary part of eigenvalue {number}, in {self.unit}"))
        return tuple(found)

    def roots(self, points: Any) -> Any:
        """Shape (m, roots), sorted."""
        rows, start, found = self._kernel(np.ascontiguousarray(points)), 0, []
        for n in self._sizes:
            m, c, k = (rows[start + i * n * n : start + (i + 1) * n * n].T.reshape(-1, n, n) for i in range(3))
            start += 3 * n * n
            found.append(_eigenvalues(m, c, k))
        every = np.concatenate(found, axis=1)
        order = np.lexsort((-every.imag, -every.real), axis=1)
        return np.take_along_axis(every, order, axis=1)

    def at(self, points: Any) -> Mapping[str, Any]:
        roots = self.roots(points)
        parts = [part for column in roots.T for part in (column.real, column.imag)]
        return dict(zip((column.name for column in self.columns), parts, strict=True))


def _eigenvalues(m: Any, c: Any, k: Any) -> Any:
    """Of M x'' + C x' + K x = 0, arrays (points, n, n); not a number where M is singular or the entries are none."""
    count, n = m.shape[0], m.shape[1]
    with np.errstate(all="ignore"):
        sound = np.all(np.isfinite(m) & np.isfinite(c) & np.isfinite(k), axis=(1, 2))
        sound &= np.linalg.cond(np.where(sound[:, None, None], m, np.eye(n))) < 1 / np.finfo(float).eps
    first = np.zeros((count, 2 * n, 2 * n))
    first[:, :n, n:] = np.eye(n)
    safe = np.where(sound[:, None, None], m, np.eye(n))
    first[sound, n:, :n] = -np.linalg.solve(safe, k)[sound]
    first[sound, n:, n:] = -np.linalg.solve(safe, c)[sound]
    found = np.linalg.eigvals(first)
    found[~sound] = np.nan
    return found


class DampingMeasure:
    """The largest real part of all roots: how fast the slowest disturbance decays (negative) or the fastest grows."""

    def __init__(self, section: Section, unit: str) -> None:
        self._roots = RootsMeasure(section, unit)
        meaning = f"the largest real part of an eigenvalue, in {unit}; below 0: disturbances of first order decay"
        self.columns = (Column("largest_real_part", meaning),)

    def at(self, points: Any) -> Mapping[str, Any]:
        return {"largest_real_part": np.max(self._roots.roots(points).real, axis=1)}


class FrequencyMeasure:
    """The positive imaginary parts of the roots, from low to high; not a number where there are fewer."""

    def __init__(self, section: Section, unit: str) -> None:
        self._roots = RootsMeasure(section, unit)
        self._count = sum(part.size for part in section.parts)
        meaning = (
            f"the positive imaginary parts of the eigenvalues from low to high, in {unit}; empty where there are fewer"
        )
        self.columns = tuple(Column(f"frequency{number}", meaning) for number in range(1, self._count + 1))

    def at(self, points: Any) -> Mapping[str, Any]:
        roots = self._roots.roots(points)
        with np.errstate(invalid="ignore"):
            least = NEGLIGIBLE * np.max(np.abs(roots), axis=1, keepdims=True)
            parts = np.where(roots.imag > least, roots.imag, np.nan)
        parts = np.sort(parts, axis=1)[:, : self._count]
        return {column.name: parts[:, place] for place, column in enumerate(self.columns)}
