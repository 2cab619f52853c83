"""Measures of the eigenvalues: all of them, the decay of the slowest, the frequencies.

The roots lambda of  det(lambda^2 M + lambda (D + G) + K + N) = 0  are computed in floats (LAPACK), for all points of a
chunk at once, from matrices that come from machine code.  Coordinates whose equations are of first order have one root
each.  An irrational number among the coefficients is put in as a float.  Nothing is proved; ``stability`` proves.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mbsym.algebra.matrices import added
from mbsym.expressions.message import Message
from mbsym.maps.section import Section
from mbsym.numerics.kernels import llvm
from mbsym.numerics.kernels.interface import Code
from mbsym.sweeps.formula import written
from mbsym.sweeps.points import Column

#: Parts of a root below this share of the largest root are rounding, of a root that may be a multiple one.
NEGLIGIBLE = 1e-7
#: What stands for a root that is not known: neither part is a number.
NONE = complex(np.nan, np.nan)


class RootsMeasure:
    """The roots of every point, sorted by falling real part, then imaginary part: real1, imaginary1, real2, ...

    ``unit`` says in what they are counted; a point where M is singular has none (not a number).
    """

    def __init__(self, section: Section, unit: str) -> None:
        self.unit = unit
        self._parts = tuple((part.size, part.following) for part in section.parts)
        #: How many roots there are.
        self.count = sum(2 * n - len(following) for n, following in self._parts)
        entries = [
            x
            for part in section.parts
            for matrix in (part.M, added(part.D, part.G), added(part.K, part.N))
            for row in matrix
            for x in row
        ]
        known = [] if section.constant is None else [float(section.constant.number)]
        self._known = np.array(known).reshape(-1, 1)
        program, names, nodes = written(entries, section.context.names())
        self._kernel = llvm.kernels({"entries": Code(program, names, tuple(nodes))}, wide=True)["entries"]

    @property
    def columns(self) -> tuple[Column, ...]:
        eigenvalue_columns = []
        for number in range(1, self.count + 1):
            title = Message("real part of eigenvalue [[number]]", number=number)
            eigenvalue_columns.append(
                Column(f"real{number}", f"real part of eigenvalue {number}, in {self.unit}", title=title)
            )
            eigenvalue_columns.append(
                Column(f"imaginary{number}", f"imaginary part of eigenvalue {number}, in {self.unit}")
            )
        return tuple(eigenvalue_columns)

    def roots(self, points: Any) -> Any:
        """Shape (m, roots), sorted."""
        known = np.repeat(self._known, points.shape[1], axis=1)
        rows, start, spectra = self._kernel(np.concatenate([points, known])), 0, []
        for n, following in self._parts:
            m, c, k = (rows[start + i * n * n : start + (i + 1) * n * n].T.reshape(-1, n, n) for i in range(3))
            start += 3 * n * n
            spectra.append(_eigenvalues(m, c, k, following))
        every = np.concatenate(spectra, axis=1)
        every[np.isnan(every).any(axis=1)] = NONE  # the roots of some parts alone would be taken for all
        order = np.lexsort((-every.imag, -every.real), axis=1)
        return np.take_along_axis(every, order, axis=1)

    def at(self, points: Any) -> Mapping[str, Any]:
        roots = self.roots(points)
        parts = [part for column in roots.T for part in (column.real, column.imag)]
        return dict(zip((column.name for column in self.columns), parts, strict=True))


def _eigenvalues(m: Any, c: Any, k: Any, following: Sequence[int]) -> Any:
    """Of M x'' + C x' + K x = 0, arrays (points, n, n); not a number where M is singular or the entries are none.

    The rows of ``following`` are of first order, there C takes M's place: ``mbsym.problems.stability.linear_form``.
    """
    count, n = m.shape[0], m.shape[1]
    moving = [i for i in range(n) if i not in following]
    first = np.zeros((count, n + len(moving), n + len(moving)))
    first[:, moving, n + np.arange(len(moving))] = 1
    sound = np.ones(count, dtype=bool)
    for lines, leading, target in (
        (moving, m, n + np.arange(len(moving))),
        (list(following), c, np.array(following, dtype=int)),
    ):
        if not lines:
            continue
        own, by_place, by_speed = leading[:, lines][:, :, lines], k[:, lines], c[:, lines][:, :, moving]
        with np.errstate(all="ignore"):
            good = np.all(np.isfinite(own), axis=(1, 2)) & np.all(np.isfinite(by_place), axis=(1, 2))
            good &= np.all(np.isfinite(by_speed), axis=(1, 2))
            safe = np.where(good[:, None, None], own, np.eye(len(lines)))
            good &= np.linalg.cond(safe) < 1 / np.finfo(float).eps
        sound &= good
        right = np.where(good[:, None, None], np.concatenate([by_place, by_speed], axis=2), 0)
        solved = np.linalg.solve(np.where(good[:, None, None], own, np.eye(len(lines))), right)
        first[:, target] = -solved
    eigenvalues = np.linalg.eigvals(first).astype(complex)
    eigenvalues[~sound] = NONE
    return eigenvalues


class DampingMeasure:
    """The largest real part of all roots: how fast the slowest disturbance decays (negative) or the fastest grows."""

    def __init__(self, section: Section, unit: str) -> None:
        self._roots = RootsMeasure(section, unit)
        meaning = f"the largest real part of an eigenvalue, in {unit}; below 0: disturbances of first order decay"
        self.columns = (Column("largest_real_part", meaning, title="largest real part of an eigenvalue"),)

    def at(self, points: Any) -> Mapping[str, Any]:
        return {"largest_real_part": np.max(self._roots.roots(points).real, axis=1) + 0.0}  # no -0


class FrequencyMeasure:
    """The positive imaginary parts of the roots, from low to high; not a number where there are fewer."""

    def __init__(self, section: Section, unit: str) -> None:
        self._roots = RootsMeasure(section, unit)
        self._count = self._roots.count // 2
        meaning = (
            f"the positive imaginary parts of the eigenvalues from low to high, in {unit}; empty where there are fewer"
        )
        self.columns = tuple(
            Column(f"frequency{number}", meaning, title=Message("frequency [[number]]", number=number))
            for number in range(1, self._count + 1)
        )

    def at(self, points: Any) -> Mapping[str, Any]:
        roots = self._roots.roots(points)
        with np.errstate(invalid="ignore"):
            least = NEGLIGIBLE * np.max(np.abs(roots), axis=1, keepdims=True)
            parts = np.where(roots.imag > least, roots.imag, np.nan)
        parts = np.sort(parts, axis=1)[:, : self._count]
        return {column.name: parts[:, place] for place, column in enumerate(self.columns)}
