"""Self-check: every run compares its results with an independent route, exactly where numbers can be exact.

* The closed equations (Lagrange, in the ring) and the straight-line program (Newton-Euler, in body axes) are each
  compared with d'Alembert's principle in inertial axes (``mbsym.mechanics.oracle``) at rational states.
* Problem 1's rotations and velocities are compared with the same placement of the bodies.
* Linearised equations are compared with the quadratised Lagrangian, as polynomials.

``exact`` means equality of rational numbers (or polynomials) without tolerance; ``verified numerically`` means
overlapping balls of at least 200 bits, where roots or exponentials make exact numbers impossible.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from flint import arb, ctx

from mbsym.algebra.base import NotRational, Scalar, SingularPoint
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.ring import Ring
from mbsym.formulas.formula import Formula
from mbsym.mechanics.oracle import Oracle, Placement, State
from mbsym.mechanics.programs import Programs
from mbsym.mechanics.states import ball_states, rational_states
from mbsym.model.system import System, acceleration_name
from mbsym.problems.energy import Energy
from mbsym.problems.equations import Equations
from mbsym.problems.kinematics import Kinematics
from mbsym.problems.linearisation import Linearisation

EXACT, NUMERICAL, UNDECIDED, FAILED = "exact", "verified numerically", "undecided", "FAILED"

#: How many states; each is enough to catch a slip with probability close to one.
STATES = 3
#: Working precision of the balls, in bits.
PRECISION = 256


@dataclass(frozen=True)
class Check:
    """``first`` and ``second`` name the routes; ``outcome`` is exact, verified numerically, undecided or FAILED."""

    name: str
    first: str
    second: str
    outcome: str
    detail: str = ""

    @property
    def failed(self) -> bool:
        return self.outcome == FAILED


#: Computes, at a state, pairs of values that must be equal, each with a label for the complaint.
Pairs = Callable[[State], list[tuple[str, Scalar, Scalar]]]


def compare(system: System, ring: Ring, name: str, routes: tuple[str, str], pairs: Pairs) -> Check:
    """Compares two routes at rational states, or with balls where the values are irrational."""
    try:
        outcome, detail = _compare(rational_states(system, ring, 4 * STATES), pairs)
        return Check(name, *routes, outcome, detail)
    except NotRational:
        pass
    keep, ctx.prec = ctx.prec, PRECISION
    try:
        outcome, detail = _compare(ball_states(system, ring, 4 * STATES), pairs)
    finally:
        ctx.prec = keep
    return Check(name, *routes, NUMERICAL if outcome == EXACT else outcome, detail)


def _compare(states: Any, pairs: Pairs) -> tuple[str, str]:
    done = 0
    for state in states:
        try:
            found = pairs(state)
        except SingularPoint:
            continue
        for label, first, second in found:
            if not _agree(first, second):
                return FAILED, f"{label} differs: {_short(first)} against {_short(second)}"
        done += 1
        if done == STATES:
            return EXACT, f"{done} states"
    return UNDECIDED, "no state without a singularity was found"


def _agree(first: Scalar, second: Scalar) -> bool:
    if isinstance(first, arb) or isinstance(second, arb):
        difference = first - second
        return bool(difference.is_finite() and difference.contains(0) and difference.rad() < arb(2) ** -60)
    return bool(first == second)


def _short(x: Scalar) -> str:
    text = str(x)
    return text if len(text) <= 60 else text[:57] + "..."


D_ALEMBERT = "d'Alembert's principle in inertial axes"


def check_equations(system: System, ring: Ring, equations: Equations) -> Check:
    """Lagrange's closed equations against d'Alembert's principle."""
    names = system.coordinates

    def pairs(state: State) -> list[tuple[str, Scalar, Scalar]]:
        carry = Carrier(ring, state.numbers, state.values)
        truth = Oracle(system, state).residuals()
        found = []
        for i, name in enumerate(names):
            total = -carry(equations.forcing[i].polynomial)
            for j, other in enumerate(names):
                entry = carry(equations.mass_matrix[i, j].polynomial)
                total = total + entry * state.values[acceleration_name(other)]
            found.append((f"equation {name}", total, truth[name]))
        return found

    return compare(system, ring, "equations of motion", ("Lagrange, closed form", D_ALEMBERT), pairs)


def check_program(system: System, ring: Ring, programs: Programs) -> Check:
    """The straight-line program against d'Alembert's principle."""
    names = system.coordinates

    def pairs(state: State) -> list[tuple[str, Scalar, Scalar]]:
        nodes = [node for row in programs.mass_matrix for node in row] + list(programs.forcing)
        values = programs.program.evaluate(nodes, state.values, state.numbers)
        truth = Oracle(system, state).residuals()
        n = len(names)
        found = []
        for i, name in enumerate(names):
            total = -values[n * n + i]
            for j, other in enumerate(names):
                total = total + values[i * n + j] * state.values[acceleration_name(other)]
            found.append((f"equation {name}", total, truth[name]))
        return found

    return compare(system, ring, "straight-line program", ("Newton-Euler recursion in body axes", D_ALEMBERT), pairs)


def check_kinematics(system: System, ring: Ring, kinematics: Kinematics) -> Check:
    """Direction cosines, angular velocities and velocities against the placement of the bodies in inertial axes."""

    def pairs(state: State) -> list[tuple[str, Scalar, Scalar]]:
        carry = Carrier(ring, state.numbers, state.values)
        place = Oracle(system, state).moving
        found: list[tuple[str, Scalar, Scalar]] = []
        for body in system.bodies:
            own = kinematics.body(body.name)
            axes = [[x.a for x in row] for row in place.axes[body.name]]
            parent = [[x.a for x in row] for row in place.axes[body.attached_to]]
            for i in range(3):
                for j in range(3):
                    cosine = sum((axes[k][i] * parent[k][j] for k in range(3)), state.numbers.zero)
                    found.append((f"R of {body.name}", carry(own.rotation[i, j].polynomial), cosine))
            spin = place.spin(body.name)[0]
            origin = [x.b for x in place.origin[body.name]]
            centre = [x.b for x in place.mass_centre(body)]
            for label, ours, world in (
                ("angular velocity", own.angular_velocity, spin),
                ("velocity of the origin", own.velocity_origin, origin),
                ("velocity of the mass centre", own.velocity_mass_centre, centre),
            ):
                for i in range(3):
                    truth = sum((axes[k][i] * world[k] for k in range(3)), state.numbers.zero)
                    found.append((f"{label} of {body.name}", carry(ours[i].polynomial), truth))
        return found

    return compare(system, ring, "kinematics", ("recursion in body axes", "placement in inertial axes"), pairs)


def check_energy(system: System, ring: Ring, energy: Energy) -> Check:
    """T against the sum over bodies in inertial axes."""

    def pairs(state: State) -> list[tuple[str, Scalar, Scalar]]:
        carry = Carrier(ring, state.numbers, state.values)
        truth = _energy_in_inertial_axes(system, Oracle(system, state).moving, state)
        return [("kinetic energy", carry(energy.kinetic_energy.polynomial), truth)]

    return compare(system, ring, "kinetic energy", ("recursion in body axes", "sum in inertial axes"), pairs)


def _energy_in_inertial_axes(system: System, place: Placement, state: State) -> Scalar:
    """(1/2) sum of m V_C^2 + omega . A Theta_C A^T omega."""
    twice = state.numbers.zero
    for body in system.bodies:
        mass = place.lower(body.mass).a
        for x in place.mass_centre(body):
            twice = twice + mass * x.b * x.b
        tensor = place.inertia(body)
        if tensor is not None:
            spin = place.spin(body.name)[0]
            for i in range(3):
                for j in range(3):
                    twice = twice + spin[i] * tensor[i][j].a * spin[j]
    return twice * state.numbers.reciprocal(state.numbers.number(2))


def check_linearisation(ring: Ring, first: Linearisation, second: Linearisation) -> Check:
    """All five matrices by both routes, as polynomials."""
    wrong = [
        name
        for name, a, b in zip("MDGKN", first.matrices, second.matrices, strict=True)
        if not (_all_zero(ring, a.polynomials, b.polynomials))
    ]
    outcome = FAILED if wrong else EXACT
    detail = f"differs in {', '.join(wrong)}" if wrong else "identical polynomials"
    return Check("linearisation", first.route, second.route, outcome, detail)


def check_residuals(ring: Ring, first: Sequence[Formula], second: Sequence[Formula]) -> Check:
    """The motion substituted into the nonlinear equations, and into the recursion."""
    rows = ([x.polynomial for x in first], [x.polynomial for x in second])
    same = _all_zero(ring, [rows[0]], [rows[1]])
    return Check(
        "equilibrium",
        "motion substituted into the closed equations",
        "Newton-Euler recursion on the motion",
        EXACT if same else FAILED,
        "identical polynomials" if same else "the residuals differ",
    )


def _all_zero(ring: Ring, a: Sequence[Sequence[Any]], b: Sequence[Sequence[Any]]) -> bool:
    return all(
        ring.is_zero(x - y) is True for row, other in zip(a, b, strict=True) for x, y in zip(row, other, strict=True)
    )
