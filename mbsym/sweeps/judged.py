"""Measure ``stability``: the verdict of problem 6 at every point.

Points fall into classes by the signs of the deciding quantities (``mbsym.sweeps.deciding``), evaluated in floats with
bounds of their rounding; the verdict of a class is found exactly at one of its points, which is a rational number as
every float is.  A point whose signs are not certain is judged exactly by itself.  So every verdict is that of the exact
judge at the number which the column holds.  Where matrices hold functions of what is varied (the cosine of an angle)
there are no such quantities, and every point is judged by itself.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from threading import Lock
from typing import Any

import numpy as np
from flint import fmpq

from mbsym.algebra import rationals
from mbsym.algebra.failures import Failure
from mbsym.algebra.plane import Point
from mbsym.analysis import Analysis, judge
from mbsym.maps.admissible import Admissibility
from mbsym.maps.axis import Axis
from mbsym.maps.mapping import MOST_ASKED, ByFirstTerm, Judge, first_term_in, kept_in, nonlinear_in
from mbsym.maps.result import Cell, Lack, Shape
from mbsym.maps.section import Section, Unfit, unmade
from mbsym.maps.verdicts import Judged
from mbsym.numerics.kernels import llvm
from mbsym.problems.stability.words import Word
from mbsym.sweeps.deciding import classes, deciding
from mbsym.sweeps.points import Column

#: What may stand in place of a verdict, before the words of verdicts.
OUTSIDE, UNDEFINED, MASSLESS = "not admissible", "not defined", "kinetic energy not positive definite"
NO_VERDICT = (OUTSIDE, UNDEFINED, MASSLESS)
NO_WORDS: Mapping[Lack | None, str] = {
    Lack.OUTSIDE: OUTSIDE,
    Lack.UNDEFINED: UNDEFINED,
    Lack.MASSLESS: MASSLESS,
    Lack.TOO_LARGE: Word.UNDECIDED.value,
}
WORDS = (*NO_VERDICT, *(word.value for word in Word))

VERDICT = Column(
    "verdict",
    "what problem 6 says there by the first approximation and the energy, exactly, at the numbers in this row taken as "
    "they stand; of points judged by themselves, where that leaves the motion open, what terms of higher order decide",
    WORDS,
    whole=True,
    title="verdict of problem 6",
)
RIGHT = Column("unstable_roots", "how many roots of the characteristic polynomial have Re > 0; -1: not counted")
EXACT = Column("singly", "1: near a border, judged by itself; 0: by the signs that it shares with other points")


class StabilityMeasure:
    """The verdict, and how many roots have Re > 0, in a section of the space of parameters.

    Raises TooLargeError where a characteristic polynomial is too long, Unfit where no point is admissible.
    """

    columns: tuple[Column, ...] = (
        VERDICT,
        Column(RIGHT.name, RIGHT.meaning, whole=True),
        Column(EXACT.name, EXACT.meaning, whole=True),
    )

    _by_first_term: ByFirstTerm | None = None

    def __init__(self, analysis: Analysis, section: Section) -> None:
        self.section = section
        #: What parameters have to keep; ``left_out`` of it could not be expressed in the axes.
        self.admissibility = kept_in(analysis, section)
        self._by_first_term = first_term_in(analysis, section, most=None)
        further = [
            *([] if self._by_first_term is None else self._by_first_term.coefficients),
            *section.undefined,
            *section.asked,
            *(demand.condition.polynomial for demand in self.admissibility.demands),
        ]
        self._deciding = deciding(section.parts, further, [axis.name for axis in section.axes], section.constant)
        self._judge = Judge(section, self.admissibility)
        self._nonlinear = nonlinear_in(analysis, section)
        self._kernel = llvm.kernels({"signs": self._deciding.code}, wide=True)["signs"]
        self._known: dict[tuple[int, ...], tuple[int, int]] = {}
        self._lock = Lock()

    @property
    def operations(self) -> int:
        """Of one point."""
        return self._deciding.code.operations

    def at(self, points: Any) -> Mapping[str, Any]:
        count = points.shape[1]
        words, right = np.zeros(count, dtype=np.int8), np.zeros(count, dtype=np.int16)
        keys, certain = self._deciding.keys(self._kernel(np.ascontiguousarray(points)))
        for key, members in classes(keys, certain):
            with self._lock:
                verdict = self._known.get(key)
            if verdict is None:
                verdict = self.judged(points[:, members[0]])
                with self._lock:
                    self._known[key] = verdict
            words[members], right[members] = verdict
        alone = np.flatnonzero(~certain)
        words[alone], right[alone] = self._singly(points[:, alone])
        return {VERDICT.name: words, RIGHT.name: right, EXACT.name: (~certain).astype(np.int8)}

    def judged(self, point: Sequence[float]) -> tuple[int, int]:
        """(place of the word in ``WORDS``, roots with Re > 0) at one point, exactly, as all say of its class."""
        return self._told(self._cell(point))

    def _singly(self, points: Any) -> Any:
        """The same of points each by itself, shape (2, m): what the nonlinear system shows there, too."""
        further, left = self._nonlinear, MOST_ASKED
        told = np.zeros((2, points.shape[1]), dtype=np.int16)
        for place, cell in enumerate(map(self._cell, points.T)):
            if left and further and isinstance(cell, Cell) and _open(cell) and further.may_add(cell):
                left -= 1
                with self._lock:
                    cell = further(cell)
            told[:, place] = self._told(cell)
        return told

    def _cell(self, point: Sequence[float]) -> Cell | str:
        """What is proved at one point; a word where there is no cell."""
        if not np.all(np.isfinite(point)):
            return UNDEFINED
        numbers = [fmpq(*float(x).as_integer_ratio()) for x in point]
        line, constant = len(numbers) == 1, self.section.constant is not None
        place: Any = numbers[0] if line else Point(*numbers) if constant else tuple(numbers)
        try:
            cell = self._judge(Shape.INTERVAL if line else Shape.REGION, 0, place)
        except Failure:  # a limit was reached: nothing is wrong with the formulas
            return Word.UNDECIDED.value
        except (ValueError, ZeroDivisionError):
            return UNDEFINED
        return cell if self._by_first_term is None else self._by_first_term(cell)

    @staticmethod
    def _told(cell: Cell | str) -> tuple[int, int]:
        if isinstance(cell, str):
            return WORDS.index(cell), -1
        if cell.judged is None:
            return WORDS.index(NO_WORDS[cell.lack]), -1
        verdict = cell.nonlinear or cell.judged.verdict
        return WORDS.index(verdict.word.value), -1 if cell.right is None else cell.right


def _open(cell: Cell) -> bool:
    return cell.judged is not None and cell.judged.verdict.word.open


class SingleVerdicts(StabilityMeasure):
    """The verdict alone, where matrices are no fractions of polynomials in the axes; roots are not counted."""

    columns = (VERDICT,)

    #: Points that are judged one by one, some milliseconds each.
    most = 20_000

    def __init__(self, analysis: Analysis, axes: Sequence[Axis], settings: Mapping[str, Fraction], why: Unfit) -> None:
        """Raises Unfit for ``why`` where an axis or a setting is a symbol of the notation."""
        if not {*settings, *(axis.name for axis in axes)} <= {*analysis.system.parameter_names}:
            raise why
        self.section, _ = unmade(analysis, axes, settings)
        self.admissibility = kept_in(analysis, self.section)
        self._judge = _Singly(analysis, self.section, self.admissibility)
        self._nonlinear, self._lock = nonlinear_in(analysis, self.section), Lock()

    def at(self, points: Any) -> Mapping[str, Any]:
        return {VERDICT.name: self._singly(points)[0].astype(np.int8)}


class _Singly(Judge):
    """Judges points by the route that problem 6 takes at the numbers of a description."""

    def __init__(self, analysis: Analysis, there: Section, kept: Admissibility) -> None:
        super().__init__(there, kept)
        self._first = judge.Judge(analysis).first_approximation
        self._known = {name: x for name, x in there.numbers.items() if name in analysis.system.parameter_names}

    def judged(self, shape: Shape, point: Any, place: Any) -> Judged:
        numbers = point if isinstance(point, tuple) else (point,)
        there = {axis.name: rationals.fraction(x) for axis, x in zip(self.section.axes, numbers, strict=True)}
        return Judged(self._first(self._known | there), None, None, None, None)
