"""The truth suite, references and recommendations: against motions in closed form and equations written by hand."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from conftest import STATEMENTS
from flint import arb, arb_mat, ctx

import mbsym
from mbsym.numerics.accuracy import ErrorEstimate
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.llvm import available
from mbsym.numerics.methods.interface import Breakdown, Cause
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.scenario import scenario
from mbsym.numerics.trade import reference_search
from mbsym.numerics.trade.comparison import uneven
from mbsym.numerics.trade.reference_search import (
    COLUMNS,
    DISAGREE,
    EXPLICIT,
    EXTRAPOLATION,
    IMPLICIT,
    Extrapolation,
    Reference,
    whole_reference,
)
from mbsym.numerics.trade.tradeoff import tradeoff
from mbsym.report.runs.simulation_words import error_lines

needs_extended = pytest.mark.skipif(not available("extended"), reason="this machine has no extended arithmetic")


def case(name: str) -> Dynamics:
    return Dynamics(scenario(mbsym.load(STATEMENTS / name).system))


def true_error(found: Reference, places: Any, truth: Any) -> float:
    """The largest |x_i - truth_i| over scale_i at some of the reference's times."""
    return float(np.max(np.abs(found.states[:, places] - truth) / np.asarray(found.scale)[:, None]))


# --- motions in closed form ---


@cache
def _chain() -> tuple[Any, Any, Any]:
    """Joint k pulls with k_k x_k + c_k x_k' on its bodies: m X_k'' = F_k - F_k+1, X_k = x_1 + ... + x_k."""
    n, stiffness, friction = 6, [6, *[10**6] * 5], [mpmath.mpf(20000) / 10**7, *[20000] * 5]
    matrix = mpmath.zeros(2 * n)
    for k in range(n):
        matrix[k, n + k] = 1
        for body, sign in ((k, 1), (k - 1, -1)):
            for joint, way in ((body, -sign), (body + 1, sign)):
                if body >= 0 and joint < n:
                    matrix[n + k, joint] += way * stiffness[joint]
                    matrix[n + k, n + joint] += way * friction[joint]
    start = mpmath.matrix([1, mpmath.mpf(1) / 100, 0, mpmath.mpf(-1) / 100, 0, mpmath.mpf(2) / 100, *[0] * n])
    values, vectors = mpmath.eig(matrix)
    return values, vectors, mpmath.lu_solve(vectors, start)


def chain(t: float) -> list[float]:
    values, vectors, parts = _chain()
    modes = mpmath.matrix([part * mpmath.exp(value * mpmath.mpf(t)) for part, value in zip(parts, values, strict=True)])
    return [float(x.real) for x in vectors * modes]


@needs_extended
def test_a_stiff_chain_of_six_has_a_reference_within_its_error_of_the_closed_form() -> None:
    with mpmath.workdps(45):
        found = whole_reference(case("chain6.yaml"), 2.0, 40.0, at_most=100.0)
        places = np.unique(
            np.concatenate([np.arange(0, 200, 10), np.linspace(0, len(found.times) - 1, 40).astype(int)])
        )
        truth = np.array([chain(float(t)) for t in found.times[places]]).T
    assert found.way in (EXTRAPOLATION, EXPLICIT)
    assert true_error(found, places, truth) <= found.error + 3e-16
    assert found.error < 1e-10


@needs_extended
def test_implicit_references_are_within_their_error_of_the_closed_form(monkeypatch: pytest.MonkeyPatch) -> None:
    def too_slow(search: Any) -> Reference:
        raise Breakdown(Cause.STEP_LIMIT, "planted", 0.0, np.empty(0))

    monkeypatch.setattr(reference_search, "WAYS", ((too_slow, 0.1), (reference_search._implicit, 1.0)))
    with mpmath.workdps(45):
        found = whole_reference(case("chain6.yaml"), 2.0, 200.0)
        places = np.linspace(0, len(found.times) - 1, 40).astype(int)
        truth = np.array([chain(float(t)) for t in found.times[places]]).T
    assert found.way == IMPLICIT
    assert true_error(found, places, truth) <= found.error < 1e-6


def kepler(t: float) -> list[float]:
    """a = 1, e = 9/10 from the perihelion: E - e sin E = t."""
    e, t = mpmath.mpf(9) / 10, mpmath.mpf(t)
    anomaly = mpmath.findroot(lambda x: x - e * mpmath.sin(x) - t, t + e * mpmath.sin(t)) if t else mpmath.mpf(0)
    c, s, b = mpmath.cos(anomaly), mpmath.sin(anomaly), mpmath.sqrt(1 - e * e)
    return [float(x) for x in (c - e, b * s, -s / (1 - e * c), b * c / (1 - e * c))]


def oscillator(t: float) -> list[float]:
    return [float(mpmath.cos(t)), float(-mpmath.sin(t))]


@pytest.mark.parametrize(
    ("name", "solution", "end"),
    [("osc", oscillator, 8 * np.pi), ("kepler", kepler, 4 * np.pi)],
)
def test_what_is_recommended_reaches_its_target_over_the_whole_interval(name: str, solution: Any, end: float) -> None:
    """Whole periods: their ends show little of an error."""
    dynamics = case(f"{name}.yaml")
    truth = whole_reference(dynamics, end, 100.0)
    chosen = [METHODS[one] for one in ("rk45", "dop853")]
    found = tradeoff(dynamics, chosen, truth, 20.0)
    times = np.union1d(uneven(0.0, end, 300), [0.0, end])
    with mpmath.workdps(30):
        exact = np.array([solution(float(t)) for t in times]).T
    size = np.max(np.abs(exact), axis=1)[:, None]
    judged = 0
    for target in (1e-4, 1e-6, 1e-8, 1e-10):
        best = found.cheapest(target)
        if best is None:
            continue
        run = best.method.start(dynamics, best.setting, best.scalar)
        states = np.column_stack([run.state, run.fill(times[1:])]).astype(float)
        error = float(np.max(np.abs(states - exact) / size))
        assert error <= target * 1.001
        assert error <= 1.01 * best.error + 1e-15, "the column is the largest of the whole interval"
        assert error >= best.error / 3
        judged += 1
    assert judged >= 3


# --- equations written by hand ---

LINKS = 10


def links() -> str:
    """Ten particles, each on a rod of length 1 that makes the angle q_k with the vertical."""
    lines = ["mbsym: 1", "name: ten links", "parameters: {g: 981/100}", "bodies:"]
    for k in range(1, LINKS + 1):
        lines.append(f"  - {{name: p{k}, attached to: {f'p{k - 1}' if k > 1 else 0}, coordinates: [q{k}], mass: 1,")
        lines.append(f"     connection point: [sin(q{k}), -cos(q{k}), 0]}}")
    lines += ["loads:", "  - uniform gravity: {vector: [0, -g, 0]}", "initial:"]
    lines += [f"  q{k}: {k}/10" for k in range(1, LINKS + 1)]
    return "\n".join(lines)


def by_hand(x: list[Any]) -> list[Any]:
    """sum_j m_kj (cos(q_k - q_j) q_j'' + sin(q_k - q_j) q_j'^2) + m_kk g sin q_k = 0, m_kj = 11 - max(k, j)."""
    q, v, g = x[:LINKS], x[LINKS:], arb(981) / 100
    sin, cos = [a.sin() for a in q], [a.cos() for a in q]

    def mass(k: int, j: int) -> int:
        return LINKS - max(k, j)

    rows = [[mass(k, j) * (cos[k] * cos[j] + sin[k] * sin[j]) for j in range(LINKS)] for k in range(LINKS)]
    right = []
    for k in range(LINKS):
        spun = sum((mass(k, j) * (sin[k] * cos[j] - cos[k] * sin[j]) * v[j] ** 2 for j in range(LINKS)), arb(0))
        right.append([-spun - mass(k, k) * g * sin[k]])
    found = arb_mat(rows).solve(arb_mat(right))
    return [*v, *(found[k, 0] for k in range(LINKS))]


def extrapolated(f: Any, x: list[Any], length: Any, columns: int) -> list[Any]:
    """One step of length h: Euler's rule in n = 1, 2, 3, ... parts, extrapolated to n -> infinity, midpoints only."""
    table: list[list[list[Any]]] = []
    for j in range(columns):
        n, now = 2 * (j + 1), list(x)
        h = length / n
        before, now = now, [(a + h * s).mid() for a, s in zip(now, f(now), strict=True)]
        for _ in range(1, n):
            before, now = now, [(a + 2 * h * s).mid() for a, s in zip(before, f(now), strict=True)]
        row = [now]
        for k in range(1, j + 1):
            ratio = arb((j + 1) ** 2) / (j + 1 - k) ** 2 - 1
            row.append([(a + (a - b) / ratio).mid() for a, b in zip(row[-1], table[j - 1][k - 1], strict=True)])
        table.append(row)
    return table[-1][-1]


@needs_extended
def test_ten_links_have_a_reference_within_its_error_of_equations_written_by_hand() -> None:
    dynamics = Dynamics(scenario(mbsym.loads(links()).system))
    found = whole_reference(dynamics, 0.5, 200.0)
    with ctx.workprec(200):
        x = [arb(k) / 10 for k in range(1, LINKS + 1)] + [arb(0)] * LINKS
        for _ in range(20):
            x = extrapolated(by_hand, x, arb(1) / 40, 9)
        truth = np.array([[float(value)] for value in x])
    assert true_error(found, [-1], truth) <= found.error + 3e-16
    assert found.error < 1e-13


# --- planted lies ---


def test_a_reference_with_a_wrong_digit_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """One of the two extrapolations is wrong in the ninth digit from some step on."""
    plain = Extrapolation._extrapolated

    def wrong(self: Extrapolation, size: Any) -> Any:
        new, error = plain(self, size)
        if self.columns == COLUMNS and self.time > 1 and not hasattr(self, "done"):
            self.done = True  # type: ignore[attr-defined]
            new = [x + arb("1e-9") for x in new]
        return new, error

    monkeypatch.setattr(Extrapolation, "_extrapolated", wrong)
    assert whole_reference(case("osc.yaml"), 6.0, 100.0).error > 0.5e-9


def test_two_references_that_are_wrong_alike_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Both extrapolations make the same mistake: the explicit method between their steps does not arrive there."""
    plain = Extrapolation._slope
    monkeypatch.setattr(Extrapolation, "_slope", lambda self, t, x: [s * (1 + arb("1e-9")) for s in plain(self, t, x)])
    honest = whole_reference(case("osc.yaml"), 1.0, 100.0)
    assert honest.error > 1e-11, "the steps are short, and so is what is missed in one of them"


def test_solutions_that_do_not_agree_are_no_reference(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reference_search, "AGREE", 1e-30)
    with pytest.raises(Breakdown) as raised:
        whole_reference(case("osc.yaml"), 1.0, 100.0)
    assert raised.value.kind == DISAGREE


def test_a_scale_of_zero_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """The cart that rests by symmetry, measured by its own rounding: the two runs seem to have parted."""
    run = mbsym.simulate(STATEMENTS / "symmetric_cart.yaml", 3, estimate=True)
    assert isinstance(run.error, ErrorEstimate)
    assert run.error.parted is None
    monkeypatch.setattr("mbsym.numerics.trade.comparison.scaled", lambda own, usual, apart: np.maximum(own, 1e-300))
    planted = mbsym.simulate(STATEMENTS / "symmetric_cart.yaml", 3, estimate=True)
    assert isinstance(planted.error, ErrorEstimate)
    assert planted.error.parted is not None


# --- motions that no run follows ---


@needs_extended
def test_a_chaotic_motion_has_no_estimate_after_the_runs_have_parted() -> None:
    """The double pendulum from far above: 60 of time at a tolerance of 1e-6 are beyond any digits."""
    start = {"theta1": 3, "theta2": 2, "theta1_dot": 0, "theta2_dot": 0}
    system = Path(__file__).parents[2] / "systems" / "double-pendulum.yaml"
    run = mbsym.simulate(system, 60, values=start, tolerance=1e-6, method="rk45", estimate=True)
    assert isinstance(run.error, ErrorEstimate)
    assert run.error.parted is not None
    assert 0 < run.error.parted < 60
    assert run.error.largest > 0.1
    lines = list(error_lines(run.error))
    assert lines[0].startswith("unknown: ")
    assert "nothing is known of either" in lines[0]
    early = mbsym.simulate(system, run.error.parted / 4, values=start, tolerance=1e-6, method="rk45", estimate=True)
    assert isinstance(early.error, ErrorEstimate)
    assert early.error.parted is None
    assert early.error.largest < 0.05


@needs_extended
def test_what_two_runs_differ_by_is_no_bound_of_the_error_after_they_have_parted() -> None:
    """The pendulum on its separatrix, theta = 2 atan(sinh t): both runs turn over in the end, and stay apart.

    At t = 60 one of them stands at -pi, the better one at 3 pi: the run is nearer to the truth, pi, than to the other.
    """
    run = mbsym.simulate(STATEMENTS / "separatrix.yaml", 60, method="dop853", estimate=True)
    assert isinstance(run.error, ErrorEstimate)
    assert run.error.parted is not None
    times, states = run.trajectory.times, run.trajectory.states
    truth = np.array([2 * np.arctan(np.sinh(times)), 2 / np.cosh(times)])
    apart = np.abs(truth - (states if len(states) == 2 else np.transpose(states))).max(axis=1)
    wrong = max(float(x) / q.scale for x, q in zip(apart, run.error.quantities, strict=True))
    assert wrong < 0.9 * run.error.largest
    assert not any("at least" in str(line) for line in error_lines(run.error))
