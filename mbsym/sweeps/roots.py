"""Measures of the eigenvalues: all of them, the decay of the slowest, the frequencies.

The roots lambda of  det(lambda^2 M + lambda (D + G) + K + N) = 0  are computed in floats (LAPACK), for all points of a
chunk at once, from matrices that come from machine code.  Coordinates whose equations are of first order have one root
each.  An irrational number among the coefficients is put in as a float.  Nothing is proved; ``stability`` proves.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mbsym.algebra.base import Lowering
from mbsym.algebra.matrices import added
from mbsym.algebra.program import Program
from mbsym.expressions.message import Message
from mbsym.expressions.tree import Expression
from mbsym.maps.section import Section
from mbsym.mechanics.speeds import SpeedForm
from mbsym.mechanics.variables import ring_of
from mbsym.numerics.closing import begun
from mbsym.numerics.ensembles.ensemble import beginning
from mbsym.numerics.ensembles.parametrised import Parametrised, released
from mbsym.numerics.ensembles.variation import members
from mbsym.numerics.kernels import arrays, llvm
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.scenario import Names, Scenario, substituted
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


# Measure of a motion: a formula in coordinates and velocities, at the end of a simulation and its extremes.
#
# Members are integrated side by side (dop853, tolerance 1e-9), each with its own parameters and initial state; extremes
# are those at ``ROWS`` equally spaced times.


METHOD, TOLERANCE = "dop853", 1e-9
ROWS = 201
#: States are taken in blocks of about so many numbers.
BLOCK = 2_000_000
#: A member that takes more steps than this ends early.
MOST_STEPS = 1_000_000


class SimulatedMeasure:
    """``formula`` along the motions from 0 to ``time``; not a number for motions that end early.

    ``overrides`` are those of which the scenario was made.  Raises Failure where there is no program for the equations.
    """

    def __init__(
        self,
        scenario: Scenario,
        overrides: Mapping[str, Expression],
        names: Sequence[str],
        formula: Expression,
        text: str,
        time: float,
    ) -> None:
        self.names = tuple(names)
        free = [name for name in names if name in scenario.system.parameter_names]
        self._dynamics = Parametrised(begun(scenario, declared=False).scenario, free, overrides)
        self._times = np.linspace(0.0, time, ROWS)
        fresh = released(scenario, free)
        if scenario.system.speeds:  # and unit vectors, quaternions: of the motion in coordinates
            form, program = SpeedForm(scenario.system, ring_of(scenario.system)), Program()
            told = [x.name for x in (*form.positions, *form.speeds)]
            made = substituted(program, form.state_in_coordinates(program), fresh)
            own = scenario.system.coordinates
            fresh.bound |= {name: x for name, x in zip(told, made, strict=True) if name not in own}
        node = Lowering(fresh, Names(fresh))(formula)
        self._formula = arrays.kernel(Code(fresh, self._dynamics.inputs, (node,)))
        self.columns = (
            Column(
                "final",
                f"{text} at t = {time:.12g}; not a number where the motion ended early",
                title=Message("[[formula]] at t = [[time]]", formula=text, time=f"{time:.12g}"),
            ),
            Column("least", f"the least {text} at {ROWS} equally spaced times"),
            Column("greatest", f"the greatest {text} at {ROWS} equally spaced times"),
        )

    def at(self, points: Any) -> Mapping[str, Any]:
        ensemble = members(self._dynamics, self.names, points)
        setting = Setting(TOLERANCE, None, MOST_STEPS, None)
        run = beginning(ensemble, METHOD, 1)(setting, slice(None))
        final = self._value(0.0, ensemble.starts, ensemble.parameters)
        least, greatest = final.copy(), final.copy()
        rows = max(1, BLOCK // max(1, ensemble.starts.size))
        for first in range(1, ROWS, rows):
            times = self._times[first : first + rows]
            for t, states in zip(times, run.block(times), strict=True):
                final = self._value(float(t), states, ensemble.parameters)
                least, greatest = np.minimum(least, final), np.maximum(greatest, final)  # nan stays
        return {"final": final, "least": least, "greatest": greatest}

    def _value(self, t: float, states: Any, parameters: Any) -> Any:
        times = np.full((1, states.shape[1]), t)
        return self._formula(np.vstack([times, states, parameters]))[0]
