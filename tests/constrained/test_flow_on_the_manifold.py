"""The first approximation of random constrained systems is that of their flow on what the constraints allow.

The flow x' = F(x), x = (q, q'), is that of the kernels (held against d'Alembert's principle with all rows elsewhere).
On the rows R(x) = (f, J q' + j) = 0 it is differentiated by central differences, and read in the states s that problem
5 names, which are coordinates of the manifold there:

    T spans the null space of dR/dx, T_s = 1:        A = (dF/dx T)_s.

No root may be dropped or doubled: all of A is compared where the constraints are not proved to be integrable, and else,
where the first approximation is that on a leaf, the roots that are not zero.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import combinations
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from mbsym.analysis import approximation
from mbsym.analysis.pipeline import Analysis
from mbsym.analysis.soundness import complain
from mbsym.analysis.stages import Unavailable
from mbsym.model.system import System
from mbsym.numerics.closing import closed
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels import arrays
from mbsym.numerics.scenario import scenario
from mbsym.problems.stability.words import Word
from mbsym.source import read

STEP = 2e-4
CASES = Path(__file__).parents[1] / "cases" / "constraints"

# --- descriptions ---


def trailers(source: Random, dependent: bool) -> str:
    """A car on a plane and what it draws or pushes: knife edges under some, springs and dampers at some hinges."""
    n, speed = source.randint(1, 3), source.choice([1, -1, 2, -2])
    names, loads, rows = ["x", "y", "th"], [], []
    centre = source.choice(["1/2", "-1/3", "0"])
    bodies = [
        "{name: car, attached to: 0, connection point: [x, y, 0], rotation: {axes: [3], angles: [th]}, mass: 2, "
        f"mass centre: [{centre}, 0, 0], inertia about: mass centre, inertia: [1, 1, 1], coordinates: [x, y, th]}}"
    ]
    if source.random() < 0.8:
        rows.append("x_dot*sin(th) - y_dot*cos(th) = 0")
    heading, rate, before, arms = "th", "th_dot", "car", []
    for k in range(1, n + 1):
        p, arm, edge = f"p{k}", source.choice(["0", "1/2", "1"]), source.choice(["1", "-1", "3/4", "-1/2", "2"])
        knife = source.random() < 0.75
        mass = (
            "mass: 0"
            if knife and source.random() < 0.4
            else f"mass: 1, mass centre: [{source.choice(['-1/2', '1/4', '0'])}, 0, 0], inertia about: mass centre, "
            "inertia: [1/10, 1/10, 1/5]"
        )
        names.append(p)
        bodies.append(
            f"{{name: b{k}, attached to: {before}, connection point: [-({arm}), 0, 0], "
            f"rotation: {{axes: [3], angles: [{p}]}}, {mass}}}"
        )
        arms.append((arm, heading, rate))
        heading, rate, before = f"{heading} + {p}", f"{rate} + {p}_dot", f"b{k}"
        if knife:  # no velocity across the trailer, at -edge along it
            carried = "".join(f" - ({a})*({w})*cos({heading} - ({h}))" for a, h, w in arms)
            rows.append(f"-x_dot*sin({heading}) + y_dot*cos({heading}){carried} - ({edge})*({rate}) = 0")
        if source.random() < 0.5:
            loads.append(f"force function: -{source.choice(['1', '3'])}*{p}**2/2")
        if source.random() < 0.4:
            loads.append(f"rayleigh: {p}_dot**2/6")
        if source.random() < 0.3:
            loads.append(f"generalized force: {{{p}: 2*{source.choice(names[3:])} - th_dot/2}}")
    rows = rows or ["x_dot*sin(th) - y_dot*cos(th) = 0"]
    chosen = source.sample(names, len(rows)) if dependent else []
    start = f"x: {{position: 0, velocity: {speed}}}, " + ", ".join(f"{name}: 0" for name in names[1:])
    return _text(bodies, loads, [f"velocity: {row}" for row in rows], chosen, f"x: {{rate: {speed}}}", start)


def masses(source: Random, dependent: bool) -> str | None:
    """Masses on lines under random rows and forces, about rest or about z = v t; forces of the rows on the motion.

    Rows vanish at x = 0, where their slopes are known: a force -J^T lambda there, lambda any, is what they carry.
    """
    n, cyclic = source.randint(2, 4), source.random() < 0.6
    own = [f"x{i}" for i in range(1, n + 1)]
    names = [*own, "z"] if cyclic else own

    def some(share: float) -> Fraction:
        value = source.choice(["1", "-1", "2", "-2", "1/2", "-3/2", "1/3"])
        return Fraction(value) if source.random() < share else Fraction(0)

    def form(share: float, names: list[str] = own) -> str:
        return " + ".join(f"({x})*{name}" for name in names if (x := some(share))) or "0"

    positions = source.randint(0, 1 if n < 3 else 2)
    count = max(1, min(n - 1, positions + source.randint(0, 2)))
    rows: list[str] = []
    slopes: list[list[Fraction]] = []
    for k in range(count):
        slope = [some(0.7) for _ in own]
        if not any(slope):
            return None
        slopes.append([*slope, *([Fraction(0)] if cyclic else [])])
        if k < positions:
            square = " + ".join(f"({form(0.3)})*{name}" for name in own)
            rows.append(f"relation: {' + '.join(f'({x})*sin({q})' for x, q in zip(slope, own))} + {square} = 0")  # noqa: B905
        else:
            terms = [f"(({x}) + {form(0.3)})*{name}_dot" for x, name in zip(slope, own, strict=True)]
            rows.append(f"velocity: {' + '.join([*terms, *([f'({form(0.5)})*z_dot'] if cyclic else [])])} = 0")
    chosen = source.sample(names, count) if dependent else []
    if source.random() < 0.3:  # said twice, in another way
        kind, row = rows[0].removesuffix(" = 0").split(": ", 1)
        rows.append(f"{kind}: (2 + x1)*({row}) = 0")
    weights = [some(0.5) for _ in slopes]
    forces = []
    for i, name in enumerate(names):
        carried = -sum(weight * slope[i] for weight, slope in zip(weights, slopes, strict=True))
        forces.append(f"{name}: ({carried}) + {form(0.35)} + {form(0.25, [f'{q}_dot' for q in own])}")
    place = "attached to: 0, connection point: [{0}, 0, 0], coordinates: [{0}]"
    bodies = [f"{{name: b{q}, {place.format(q)}, mass: {source.choice([1, 2])}}}" for q in names]
    speed = source.choice(["1", "-2", "1/2"])
    start = ", ".join([f"{q}: 0" for q in own] + ([f"z: {{position: 0, velocity: {speed}}}"] if cyclic else []))
    motion = f"z: {{rate: {speed}}}" if cyclic else "x1: 0"
    return _text(bodies, [f"generalized force: {{{', '.join(forces)}}}"], rows, chosen, motion, start)


def _text(bodies: list[str], loads: list[str], rows: list[str], dependent: list[str], motion: str, start: str) -> str:
    lines = ["mbsym: 1", "name: random", "bodies:", *(f"  - {body}" for body in bodies)]
    lines += ["loads:", *(f"  - {load}" for load in loads)] if loads else []
    lines += ["constraints:", *(f"  - {row}" for row in rows)]
    lines += [f"dependent: [{', '.join(dependent)}]"] if dependent else []
    return "\n".join([*lines, f"motion: {{{motion}}}", f"initial: {{{start}}}", ""])


# --- the flow ---


def differences(f: Any, x: Any) -> Any:
    columns = []
    for d in np.eye(len(x)):
        one, two = ((f(x + h * d) - f(x - h * d)) / (2 * h) for h in (STEP, 2 * STEP))
        columns.append((4 * one - two) / 3)
    return np.array(columns).T


def flow(system: System) -> tuple[Any, Any, Any]:
    """(dF/dx, T, F) at the initial state, which is on the motion."""
    dynamics = Dynamics(closed(scenario(system)).scenario)
    constraints = dynamics.constraints
    assert constraints is not None
    rates = arrays.kernel(dynamics.right_hand_side)
    state = np.array([float(x) for x in dynamics.scenario.state])

    def rows(x: Any) -> Any:
        values = constraints.at(0.0, x)
        return np.concatenate([values.positions, values.velocities])

    sizes, basis = np.linalg.svd(differences(rows, state))[1:]
    field = lambda x: rates(np.concatenate([[0.0], x]))  # noqa: E731
    return differences(field, state), basis[int(np.sum(sizes > 1e-7 * sizes[0])) :].T, field(state)


def numbers(rows: Any) -> Any:
    return np.array([[float(Fraction(str(x))) for x in row] for row in rows], dtype=float)


def apart(found: Any, wanted: Any) -> float:
    """How far the roots that are not zero are apart."""
    one, other = ([x for x in roots if abs(x) > 1e-3] for roots in (found, wanted))
    if len(one) != len(other):
        return float("inf")
    worst = 0.0
    for x in one:
        nearest = min(other, key=lambda y, x=x: abs(x - y))
        other.remove(nearest)
        worst = max(worst, abs(x - nearest) / (1 + abs(x)))
    return worst


def analysed(text: str) -> Analysis | None:
    """None where the dependent set that was drawn cannot be solved for, or the rows lose their rank on the motion."""
    system, complaints = read(text)
    assert system is not None, list(complaints)
    complain(system, complaints)
    if complaints.errors:
        assert all(one.code in ("dependent-set", "no-freedom") for one in complaints), list(complaints)
        return None
    return Analysis(system)


def compared(analysis: Analysis) -> float:
    """How far problem 5 is from the flow."""
    slopes, basis, rates = flow(analysis.system)
    names = [*analysis.system.coordinates, *analysis.system.velocities]
    assert rates[len(names) // 2 :] == pytest.approx(0, abs=1e-9)  # a steady motion, as problem 4 says
    assert analysis.equilibrium.satisfied
    space = analysis.state_space
    found = numbers(space.A.polynomials)
    roots = np.linalg.eigvals(basis.T @ slopes @ basis)
    verdict = analysis.stability.numerical or analysis.stability.verdict
    if max(x.real for x in roots) > 1e-3:
        assert verdict.word is Word.UNSTABLE
    elif min((abs(x) for x in roots), default=1.0) > 1e-3 and max(x.real for x in roots) < -1e-3:
        assert verdict.word.asymptotic
    if analysis.reduced.about.leaf:
        return apart(np.linalg.eigvals(found), roots)
    at = [names.index(name) for name in space.states]
    assert basis.shape[1] == len(at)
    basis = basis @ np.linalg.inv(basis[at])
    return float(np.max(np.abs((slopes @ basis)[at] - found)) / (1 + np.max(np.abs(found))))


@pytest.mark.parametrize("dependent", [False, True])
@pytest.mark.parametrize("kind", [trailers, masses])
def test_linearised_flows(kind: Any, dependent: bool) -> None:
    tried = 0
    for seed in range(8):
        text = kind(Random(f"{kind.__name__} {seed}"), dependent)
        analysis = analysed(text) if text else None
        if analysis is not None:
            tried += 1
            # Beside rows that follow from others accelerations off the manifold depend on the choice: O(STEP).
            assert compared(analysis) < 1e-4, text
    assert tried >= 4


@pytest.mark.parametrize(("kind", "seed"), [(trailers, 1), (trailers, 4), (masses, 1), (masses, 3)])
def test_every_choice_of_dependent_coordinates(kind: Any, seed: int) -> None:
    """The same roots for each; a choice is refused only where the constraints cannot be solved for it."""
    text = kind(Random(f"{kind.__name__} {seed}"), False)
    plain = analysed(text)
    assert plain is not None
    constraints = Dynamics(closed(scenario(plain.system)).scenario).constraints
    assert constraints is not None
    jacobians = [constraints.at(0.0, place).partials for place in constraints.near]
    names, rank = plain.system.coordinates, plain.constraints.velocity_rank
    slopes, basis, _ = flow(plain.system)
    roots = np.linalg.eigvals(basis.T @ slopes @ basis)
    solved = 0
    for chosen in combinations(range(len(names)), rank):
        best = max(np.linalg.svd(jacobian[:, chosen])[1][rank - 1] for jacobian in jacobians)
        own = text.replace("motion:", f"dependent: [{', '.join(names[k] for k in chosen)}]\nmotion:")
        analysis = analysed(own)
        assert (analysis is None) == (best < 1e-6), own
        if analysis is not None:
            assert apart(np.linalg.eigvals(numbers(analysis.state_space.A.polynomials)), roots) < 1e-4, own
            solved += 1
    assert solved >= 2


def test_roots_in_speeds() -> None:
    """x' = A x has all roots that are not zero, those of light trailers, too, if the car has declared speeds."""
    place, tried = "coordinates: [x, y, th]}", 0
    for seed in range(6):
        text = trailers(Random(f"trailers {seed}"), False)
        own = text.replace(place, place[:-1] + ", speeds: {w: omega3, u: x_dot*cos(th) + y_dot*sin(th)}}")
        plain, told = analysed(text), analysed(own)
        if plain is None or told is None:
            continue
        slopes, basis, _ = flow(plain.system)
        for form in (told.first_order, told.state_space):  # in speeds, and in coordinates and their velocities
            found = np.linalg.eigvals(numbers(form.A.polynomials))
            assert apart(found, np.linalg.eigvals(basis.T @ slopes @ basis)) < 1e-4, own
        tried += 1
    assert tried >= 4


@pytest.mark.parametrize("dependent", [False, True])
def test_first_approximations_along_motions_that_are_given_in_time(dependent: bool) -> None:
    """x' = A(t) x along x = a(t), straight ahead but ever faster, is the flow beside it, a = v (t + t^2/4).

    Of what is pulled by u = M a'' the flow over a time is differentiated by central differences.
    """
    tried = 0
    for seed in range(8):
        text = trailers(Random(f"trailers {seed}"), dependent)
        speed = float(text.split("motion: {x: {rate: ")[1].split("}")[0])
        mass = 2 + text.count("mass: 1,")
        pulled = "loads:\n  - generalized force: {x: PULL}\n"
        text = (
            text.replace("loads:\n", pulled)
            if "loads:" in text
            else text.replace("constraints:", pulled + "constraints:")
        )
        given = text.replace("bodies:", "given: {a: {of: t}}\ninputs: {u: pull}\nbodies:", 1).replace("PULL", "u")
        given = given.replace(f"motion: {{x: {{rate: {speed:.0f}}}}}", f"motion: {{x: a, u: {mass}*a_ddot}}")
        analysis = analysed(given)
        plain = analysed(text.replace("PULL", str(Fraction(speed) / 2 * mass)))
        if analysis is None or plain is None:
            continue
        assert analysis.equilibrium.satisfied
        space = analysis.state_space
        dynamics = Dynamics(closed(scenario(plain.system)).scenario)
        rates, state = arrays.kernel(dynamics.right_hand_side), np.array([float(x) for x in dynamics.scenario.state])
        names = [*plain.system.coordinates, *plain.system.velocities]
        at = [names.index(name) for name in space.states]
        assert dynamics.constraints is not None
        basis = dynamics.constraints.tangent(0.0, state)
        if basis.shape[1] != len(at) or analysis.reduced.about.leaf:
            continue
        basis = basis @ np.linalg.inv(basis[at])

        def moved(x: Any, field: Any = rates) -> Any:
            return solve_ivp(lambda t, y: field(np.r_[t, y]), (0, 0.7), x, "DOP853", rtol=1e-11, atol=1e-12).y[:, -1]

        flow = np.array([(moved(state + STEP * x) - moved(state - STEP * x))[at] / (2 * STEP) for x in basis.T]).T
        rows = [[compile(str(x), "A", "eval") for x in row] for row in space.A]

        def linear(growth: float, rows: Any = rows, speed: float = speed) -> Any:
            def field(t: float, z: Any) -> Any:
                at_time = {"a_dot": speed * (1 + growth * t / 2), "a_ddot": speed * growth / 2}
                return (
                    np.array([[eval(x, at_time) for x in row] for row in rows], dtype=float) @ z.reshape(len(rows), -1)
                ).ravel()

            one = np.eye(len(rows)).ravel()
            return solve_ivp(field, (0, 0.7), one, "DOP853", rtol=1e-10, atol=1e-12).y[:, -1].reshape(len(rows), -1)

        assert linear(1.0) == pytest.approx(flow, abs=1e-5 * (1 + np.max(np.abs(flow)))), given
        assert np.max(np.abs(linear(0.0) - flow)) > 1e-3  # at a constant speed
        tried += 1
    assert tried >= 3


def test_a_light_trailer_has_its_root_in_speeds() -> None:
    """p' = -v p/d - ... : pushed (d < 0) it folds, with the root -v/d, whatever the car does."""
    text = (CASES / "light-push.yaml").read_text(encoding="utf-8")
    text = text.replace("coordinates: [x, y, th]}", "coordinates: [x, y, th], speeds: {w: omega3}}")
    found = Analysis(read(text)[0]).first_order  # type: ignore[arg-type]
    k = found.names.index("ps")
    assert str(found.A[k, k]) == "-v/d"


def test_inputs_and_outputs_of_a_segway() -> None:
    """Motors u1, u2 between body and wheels.  By hand, with wheels of mass w and radius r at d on both sides, half a
    turn's inertia w r^2/2, a body of mass M, height l and inertia J about the axle's direction, p the mean of the
    wheels' angles and s half their difference (yaw = -r s/d), at rest:

        (3 w + M) r^2 p'' + M r l tilt'' = u1 + u2,      M r l p'' + (J + M l^2) tilt'' = -(u1 + u2).
    """
    text = (CASES / "segway.yaml").read_text(encoding="utf-8")
    text = text.replace("dependent:", "outputs: {turn: yaw_dot, shifted: y + 2*tilt}\ndependent:")
    space = Analysis(read(text)[0]).state_space  # type: ignore[arg-type]
    assert space.states == ("x", "y", "yaw", "tilt", "pl", "pr", "tilt_dot", "pl_dot", "pr_dot")
    values = {"mb": 10, "mw": 1, "r": Fraction(1, 5), "d": Fraction(3, 10), "l": Fraction(7, 10), "v": 1, "g": 9.81}

    def at(matrix: Any) -> Any:
        rows = [[eval(str(x), {name: float(y) for name, y in values.items()}) for x in row] for row in matrix]
        return np.array(rows, dtype=float)

    w, big, r, length, inertia = 1.0, 10.0, 0.2, 0.7, 0.4
    mass = np.array([[(3 * w + big) * r**2, big * r * length], [big * r * length, inertia + big * length**2]])
    mean, tilt = np.linalg.solve(mass, [1.0, -1.0])
    gains = at(space.B)
    assert gains[6] == pytest.approx([tilt, tilt])
    assert gains[7] + gains[8] == pytest.approx([2 * mean, 2 * mean])
    fall = np.linalg.solve(mass, [0.0, big * 9.81 * length])
    assert at(space.A)[6:, 3] == pytest.approx([fall[1], fall[0], fall[0]])
    assert at(space.A)[:3, 6:] == pytest.approx(np.array([[0, r / 2, r / 2], [0, 0, 0], [0, -1 / 3, 1 / 3]]))
    assert at(space.A)[1, 2] == pytest.approx(1)  # y' = v yaw
    turn, shifted = at(space.C)
    assert turn == pytest.approx([0] * 7 + [-1 / 3, 1 / 3])
    assert shifted == pytest.approx([0, 1, 0, 2, 0, 0, 0, 0, 0])
    assert not at(space.D).any()


def test_a_dropped_coordinate_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the change of Y with the position (Y_x^T r_0) forces of the rows have no stiffness."""
    whole = approximation.projected

    def without(scene: Any, found: Any) -> Any:
        return whole(scene, replace(found, slopes=tuple(tuple({} for _ in line) for line in found.slopes)))

    monkeypatch.setattr(approximation, "projected", without)
    texts = [masses(Random(f"masses {seed}"), False) for seed in range(6)]
    failed = 0
    for text in texts:
        analysis = analysed(text) if text else None
        try:
            failed += analysis is not None and compared(analysis) > 1e-4
        except Unavailable:  # withdrawn by the self-check
            failed += 1
    assert failed
