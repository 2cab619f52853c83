"""The verdict of problem 6 at a point of a section."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from flint import fmpq, fmpq_mat

from mbsym.algebra import rationals
from mbsym.algebra.roots import count_real_roots
from mbsym.maps.section import Section
from mbsym.problems.stability.exact import inertia
from mbsym.problems.stability.exact import verdict_at as exact_verdict
from mbsym.problems.stability.linear_form import LinearSystem
from mbsym.problems.stability.verdict import Verdict, combine


class Border(StrEnum):
    """What is special about the roots at a point of a curve."""

    ZERO = "zero root"
    IMAGINARY = "imaginary pair"
    SEMISIMPLE = "coincidence, semisimple"
    JORDAN = "coincidence, Jordan block"
    MASS = "mass matrix singular"


@dataclass(frozen=True)
class Judged:
    """``verdict``: of the whole system.  Roots and eigenvalues are counted with multiplicity, over all subsystems.

    ``right``: roots with a positive real part; ``real_right`` of them are real (divergence, the others: flutter).
    ``degree``: negative eigenvalues of K (Poincare's degree of instability), ``null``: its zero ones.  Counts are None
    where M is singular or they are not decided.  ``border``: on curves and corners.
    """

    verdict: Verdict
    right: int | None
    real_right: int | None
    degree: int | None
    null: int | None
    border: Border | None = None


def verdict_at(section: Section, point: Sequence[Any]) -> Judged:
    """The exact verdict at a rational point, coordinates in the order of the axes."""
    values = {k: rationals.fraction(x) for k, x in enumerate(point)}
    parts, one_energy = section.judged([(x > 0) - (x < 0) for x in point])
    found = [exact_verdict(part, values) for part in parts]
    verdict = combine((one.verdict for one in found), one_energy)
    signature = [inertia(stiffness_at(part, point)) for part in parts]
    degree, null = sum(one[2] for one in signature), sum(one[1] for one in signature)
    right: int | None = 0
    real: int | None = 0
    for one in found:
        if one.roots is None or right is None or real is None:
            right = real = None
            break
        right += one.roots.right
        real += count_real_roots(one.characteristic)[2] if one.roots.right else 0
    return Judged(verdict, right, real, degree, null)


def stiffness_at(part: LinearSystem, point: Sequence[Any]) -> Any:
    """K at a rational point."""
    return matrix_at(part.K, point)


def matrix_at(matrix: Any, point: Sequence[Any]) -> Any:
    """A matrix of polynomials in the axes at a rational point, as a ``flint.fmpq_mat``."""
    n = len(matrix)
    return fmpq_mat(n, n, [fmpq(x(*point)) for row in matrix for x in row])
