"""The linear equations at the extremes: matrices, eigenvalues, and verdicts on both sides of a border of stability.

Verdicts come from exact arithmetic (problem 6 at exact parameter values): they are right or "undecided".  Beside them
stands what float64 eigenvalues would say,

    unstable if max Re lambda > 1e-10 max |lambda|, asymptotically stable if < -1e-10 max |lambda|, else no growth seen,

which near a border, where eigenvalues coincide and are known to half the digits only, is often wrong.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf
from typing import Any

import numpy as np
from flint import acb, ctx, fmpq_mat

from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import NOT_THERE
from mbsym.algebra.point import Rationals
from mbsym.algebra.program import Program
from mbsym.algebra.rationals import ball
from mbsym.algebra.roots import enclosures
from mbsym.algebra.stable import stabilised
from mbsym.analysis import Analysis, Unavailable
from mbsym.expressions.tree import Expression
from mbsym.numerics.kernels.interface import FLOAT32, FLOAT64, Code
from mbsym.numerics.kernels.llvm import kernels
from mbsym.numerics.kernels.precise import precise
from mbsym.numerics.planning.sizes import kinds, scales
from mbsym.numerics.probes import Ladder, Probe, free_parameters, scaled
from mbsym.numerics.scenario import Incomplete, Scenario, changed
from mbsym.numerics.trade.digits import FULL, PRECISIONS, Digits, compared, digits_of, tight
from mbsym.problems.stability.problem import ExactVerdicts
from mbsym.problems.stability.verdict import Verdict
from mbsym.problems.stability.words import Word

BORDER = "border of stability"

#: Borders are sought between these powers of 2 times the given value, and approached to these distances.
POWERS = range(-10, 11)
#: Times this: at round numbers a verdict may be that of a single point, at which roots coincide.
OFF = Fraction(998, 997)
APPROACH = tuple(10.0**-k for k in range(2, 15, 2))

#: How far beside a value it is seen whether a border runs through it, or things are otherwise there alone.
BESIDE = Fraction(1, 10**15)

#: Eigenvalues nearer to the imaginary axis than this part of the largest are taken to lie on it.
ON_THE_AXIS = 1e-10

#: Parameters are moved by this part of themselves, to see how eigenvalues follow.
NUDGE = Fraction(1, 2**60)

NO_GROWTH = "no growth seen"


@dataclass(frozen=True)
class Judged:
    """``exact`` is the verdict; ``floats`` what eigenvalues in float32 and float64 say."""

    exact: Verdict
    floats: Mapping[str, str]

    def wrong(self, scalar: str) -> bool:
        """Whether the floats contradict an exact verdict that was reached."""
        said = self.floats[scalar]
        if self.exact.word in (Word.UNDECIDED, Word.DEPENDS):
            return False
        if self.exact.word == Word.UNSTABLE:
            return said != Word.UNSTABLE
        return said == Word.UNSTABLE or (said == Word.ASYMPTOTIC and not self.exact.word.asymptotic)


class LinearModel:
    """The matrices M, D, G, K, N of one analysis as programs of the parameters, and exact verdicts.

    Raises Unavailable where there is no first approximation, or one whose self-check fails.
    """

    def __init__(self, analysis: Analysis) -> None:
        with analysis.strictly():  # matrices whose self-check fails are no ground for anything
            linear, motion = analysis.judgeable, analysis.equilibrium
        scene = analysis.parameters_scene
        self.verdict_of = ExactVerdicts(scene, analysis.balance, linear, motion, analysis.signs)
        self.ring, self.linear = scene.ring, linear
        self.size = len(linear.coordinates)
        named = dict(zip(analysis.system.coordinates, kinds(analysis.system), strict=True))
        self.alike = tuple(named[name] for name in linear.coordinates)
        self.names = (*analysis.system.parameter_names, "pi")
        program = Program()
        carry = Carrier(scene.ring, program, {name: program.input(name) for name in self.names})
        self.codes: dict[str, Code] = {}
        for name, matrix in zip("MDGKN", linear.matrices, strict=True):
            nodes = [carry(x) for row in matrix.polynomials for x in row]
            self.codes[name] = Code(program, self.names, tuple(stabilised(program, nodes)))
        self.operations = sum(code.operations for code in self.codes.values())
        self._truth = {name: precise(code, PRECISIONS[-1]) for name, code in self.codes.items()}
        self._kernels = {scalar: kernels(self.codes, scalar) for scalar in (FLOAT32, FLOAT64)}
        self.shown = [name for name, m in zip("MDGKN", linear.matrices, strict=True) if any(x for x in _entries(m))]

    # --- digits ---

    def digits(self, scenario: Scenario) -> dict[str, Digits]:
        """Of every matrix that is not zero, by its letter, and of the ``eigenvalues``."""
        inputs = self._floats(scenario)
        found = {}
        masses = self._exact("M", scenario)[0][:: self.size + 1]
        for name in self.shown:
            exact, bits = self._exact(name, scenario)
            sizes = scales(name, exact, masses, self.alike)
            pairs = {s: compared(self._values(name, s, inputs), exact, full, sizes) for s, full in FULL.items()}
            correct, worst = ({s: pair[i] for s, pair in pairs.items()} for i in (0, 1))
            norm = max((abs(float(x.mid())) for x in exact), default=0.0)
            condition = self._condition(name, scenario, sizes)
            found[name] = Digits(correct, worst, correct[FLOAT64], condition, bits, norm)
        eigenvalues = self._eigenvalue_digits(scenario)
        if eigenvalues is not None:
            found["eigenvalues"] = eigenvalues
        return found

    def _values(self, name: str, scalar: str, inputs: Any) -> Any:
        with np.errstate(all="ignore"):
            return np.asarray(self._kernels[scalar][name](inputs), dtype=float)

    def _floats(self, scenario: Scenario) -> Any:
        return np.array([float(scenario.parameters.get(name, Fraction(0))) for name in self.names[:-1]] + [np.pi])

    def _exact(self, name: str, scenario: Scenario) -> tuple[list[Any], int]:
        for bits in PRECISIONS:
            with ctx.workprec(bits):
                balls = self._truth[name](self._balls(scenario))
                if tight(balls):
                    return balls, bits
        return balls, 0

    def _balls(self, scenario: Scenario) -> list[Any]:
        return [*(ball(scenario.parameters[name]) for name in self.names[:-1]), acb.pi().real]

    def _condition(self, name: str, scenario: Scenario, sizes: Sequence[Any]) -> float:
        with ctx.workprec(512):
            inputs = self._balls(scenario)
            base = self._truth[name](inputs)
            sums = [0.0] * len(base)
            for place in range(len(inputs) - 1):
                moved = list(inputs)
                moved[place] = inputs[place] * (1 + acb(2).real ** -200)
                values = self._truth[name](moved)
                sums = [
                    s + abs(float(((a - b) * acb(2).real ** 200).mid()))
                    for s, a, b in zip(sums, values, base, strict=True)
                ]
            parts = [s / float(size) if size > 0 else inf for s, size in zip(sums, sizes, strict=True) if s]
        return max(parts, default=1.0)

    def eigenvalues(self, scenario: Scenario, scalar: str) -> Any:
        """Of the first-order system, in floating point throughout; None where M is singular to it."""
        n, kind = self.size, np.float32 if scalar == FLOAT32 else np.float64
        inputs = self._floats(scenario)
        m, d, g, k, c = (self._values(x, scalar, inputs).astype(kind).reshape(n, n) for x in "MDGKN")
        first = self._first_order(m, d + g, k + c, kind)
        with np.errstate(all="ignore"):
            if first is None or not np.all(np.isfinite(first)):
                return None
            return np.linalg.eigvals(first)

    def _first_order(self, m: Any, velocity: Any, position: Any, kind: Any) -> Any:
        n = self.size
        first = np.zeros((2 * n, 2 * n), kind)
        first[:n, n:] = np.eye(n)
        try:
            with np.errstate(all="ignore"):
                first[n:, :n], first[n:, n:] = -np.linalg.solve(m, position), -np.linalg.solve(m, velocity)
        except np.linalg.LinAlgError:
            return None
        return first

    def exact_eigenvalues(self, scenario: Scenario) -> list[Any] | None:
        """Certified balls with multiplicity; None where a value is irrational or M singular."""
        try:
            m, d, g, k, c = (self._rational(matrix, scenario) for matrix in self.linear.matrices)
            inverse = m.inv()
        except NOT_THERE:
            return None
        n = self.size
        position, velocity = inverse * (k + c), inverse * (d + g)
        first = fmpq_mat(2 * n, 2 * n)
        for i in range(n):
            first[i, n + i] = 1
            for j in range(n):
                first[n + i, j], first[n + i, n + j] = -position[i, j], -velocity[i, j]
        roots = enclosures(first.charpoly().coeffs(), bits=256)
        return [root.ball for root in roots for _ in range(root.multiplicity)]

    def _rational(self, matrix: Any, scenario: Scenario) -> Any:
        numbers = Rationals({}, {})
        carry = Carrier(self.ring, numbers, {name: numbers.number(x) for name, x in scenario.parameters.items()})
        return fmpq_mat(self.size, self.size, [carry(x) for row in matrix.polynomials for x in row])

    def _eigenvalue_digits(self, scenario: Scenario) -> Digits | None:
        exact = self.exact_eigenvalues(scenario)
        if exact is None:
            return None
        correct = {}
        size = max(abs(x).mid() for x in exact)
        for scalar, full in FULL.items():
            values = self.eigenvalues(scenario, scalar)
            correct[scalar] = 0.0 if values is None else _matched(values, exact, size, full)
        condition = self._eigenvalue_condition(scenario, exact, size)
        return Digits(correct, correct, correct[FLOAT64], condition, 256, float(size))

    def _eigenvalue_condition(self, scenario: Scenario, exact: Sequence[Any], size: Any) -> float:
        """max_i sum_j |d lambda_i/dp_j p_j| / max |lambda|, over the parameters: no unit and no formula enters.

        By differences in many bits; where eigenvalues coincide it is of the order of one over the square root of the
        difference, which is what no formula could avoid.
        """
        largest = float(size)
        if not largest > 0:
            return inf
        sums = [0.0] * len(exact)
        for name, value in scenario.parameters.items():
            if not value:
                continue
            moved = self.exact_eigenvalues(changed(scenario, **{name: value * (1 + NUDGE)}))
            if moved is None:
                return inf
            left = list(moved)
            for i, root in enumerate(exact):
                nearest = min(range(len(left)), key=lambda j: float(abs(left[j] - root).mid()))
                sums[i] += float(abs(left.pop(nearest) - root).upper()) / float(NUDGE)
        return max(sums) / largest

    # --- verdicts ---

    def judged(self, scenario: Scenario) -> Judged:
        """The exact verdict, and what floats say."""
        floats: dict[str, str] = {}
        for scalar in FULL:
            values = self.eigenvalues(scenario, scalar)
            if values is None:
                floats[scalar] = Word.UNDECIDED
                continue
            size, growth = np.max(np.abs(values)), np.max(values.real)
            limit = ON_THE_AXIS * size
            floats[scalar] = Word.UNSTABLE if growth > limit else Word.ASYMPTOTIC if growth < -limit else NO_GROWTH
        return Judged(self.verdict_of(scenario.parameters), floats)

    def borders(self, scenario: Scenario, overrides: dict[str, Expression]) -> Iterator[Ladder]:
        """For every free parameter the nearest value where the verdict changes, approached from both sides."""
        for name in free_parameters(scenario):
            inside = self._bracket(scenario, overrides, name)
            if inside is None:
                continue
            low, high = inside
            border = (low + high) / 2
            value = float(scenario.parameters[name] * border)
            for side, sign in (("from below", -1), ("from above", 1)):
                probes = []
                for size in APPROACH:
                    there = scaled(scenario, overrides, name, border * (1 + sign * Fraction(f"{size:e}")))
                    probes.append(Probe(size, there, there.state))
                yield Ladder(BORDER, f"{name} -> {value:.6g} {side}", tuple(probes))

    def _bracket(
        self, scenario: Scenario, overrides: dict[str, Expression], name: str
    ) -> tuple[Fraction, Fraction] | None:
        """Two factors 1e-20 apart with different verdicts, both of them decided; the nearest to 1."""

        def word(factor: Fraction) -> str:
            try:
                return self.verdict_of(scaled(scenario, overrides, name, factor).parameters).word
            except (Incomplete, ValueError, ZeroDivisionError):
                return Word.UNDECIDED

        places = {k: OFF * Fraction(2) ** k for k in POWERS}
        words = {k: word(place) for k, place in places.items()}
        for k in sorted(POWERS[:-1], key=lambda k: abs(k + 0.5)):
            below, above = words[k], words[k + 1]
            if below != above and Word.UNDECIDED not in (below, above):
                low, high = places[k], places[k + 1]
                while high - low > low / 10**20:
                    middle = (low + high) / 2
                    verdict = word(middle)
                    wide = high - low > 4 * BESIDE * middle
                    side = word(middle * (1 + BESIDE)) if wide or verdict == Word.UNDECIDED else verdict
                    if side != verdict:
                        if word(middle * (1 - BESIDE)) != side:
                            return middle, middle  # on the border
                        verdict = side  # a point inside at which roots coincide, and things are otherwise there alone
                    if verdict not in (below, above):
                        return middle, middle
                    low, high = (middle, high) if verdict == below else (low, middle)
                return low, high
        return None


def _entries(matrix: Any) -> list[bool]:
    return [not x.is_zero() for row in matrix.polynomials for x in row]


def _matched(values: Any, exact: list[Any], size: Any, full: float) -> float:
    """Digits of the worst eigenvalue after pairing each exact one with its nearest, relative to the largest."""
    left = [acb(complex(x).real, complex(x).imag) for x in values]
    largest = abs(acb(0))
    for root in exact:
        nearest = min(range(len(left)), key=lambda i: float(abs(left[i] - root).mid()))
        largest = max(largest, abs(left.pop(nearest) - root).upper())
    return full if size == 0 else digits_of(largest / size, full)


__all__ = ["BORDER", "Judged", "LinearModel", "Unavailable"]
