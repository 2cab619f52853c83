"""Laws of mechanics that must hold for any tree of bodies whatever: nothing here knows an expected formula."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import pytest
from flint import fmpq_mat
from hypothesis import assume, given
from hypothesis import strategies as st
from properties import settings
from random_systems import (
    Description,
    analysed,
    axes,
    clone,
    coordinates,
    driving,
    motion_numbers,
    orbiting,
    resting,
    spinning,
    state,
    systems,
    vectors,
)

from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.ring import Polynomial
from mbsym.analysis import Analysis
from mbsym.mechanics.newton_euler import residuals
from mbsym.mechanics.oracle import Oracle, State
from mbsym.mechanics.states import rational_states
from mbsym.problems import checks, linearisation, perturbation, reduction, reduction_check
from mbsym.problems.checks import EXACT, NUMERICAL

law = settings(max_examples=20, derandomize=True)
some = settings(max_examples=10, derandomize=True)


def passed(analysis: Analysis, *allowed: str) -> bool:
    """All checks have an allowed outcome; shows the first that has not.

    About a motion that rests elsewhere than at zero, sines and cosines are irrational: balls are the best there is.
    """
    disturbed = {"perturbed motion": (*allowed, NUMERICAL)}
    # A random system may well have a coordinate without inertia; that this is said is tested elsewhere.
    wrong = [
        check
        for check in analysis.checks
        if check.outcome not in disturbed.get(check.name, allowed)
        and not (check.name == "mass matrix" and check.outcome == checks.SINGULAR)
    ]
    assert not wrong, wrong[0]
    return True


# --- every run verifies itself ---


@law
@given(systems())
def test_self_checks_are_exact(description: Description) -> None:
    analysis = analysed(description, (1, 2, 3))
    assert passed(analysis, EXACT)
    assert len(analysis.checks) == 5


@law
@given(orbiting())
def test_self_checks_are_exact_in_orbit(description: Description) -> None:
    assert passed(analysed(description, (1, 2, 3)), EXACT)


@some
@given(systems(most=2, most_coordinates=2, irrational=True))
def test_self_checks_hold_with_roots_and_functions(description: Description) -> None:
    assert passed(analysed(description, (1, 2, 3)), EXACT, NUMERICAL)


@some
@given(st.one_of(spinning(), resting()))
def test_expanded_and_differentiated_equations_agree(description: Description) -> None:
    analysis = analysed(description)
    assert passed(analysis, EXACT)
    impossible = "does not exist" in getattr(analysis.stage(5).failure, "reason", "")
    assert impossible or "linearisation" in [check.name for check in analysis.checks]


RELATIONS: list[dict[str, str]] = [
    {"b": "c*alpha"},
    {"Omega": "alpha - c"},
    {"Omega": "0"},
    {"b": "c - alpha", "c": "2*alpha"},
    {"k": "g/l2"},
    {"alpha": "0"},
    {"alpha": "pi/2"},
]


@law
@given(st.one_of(spinning(), resting()), st.sampled_from(RELATIONS))
def test_relations_are_used_alike_by_both_routes(description: Description, related: dict[str, str]) -> None:
    """Whether the motion is one or not: no check fails because a relation reaches one route only."""
    assert passed(analysed(description | {"relations": related}), EXACT, NUMERICAL)


@law
@given(driving())
def test_prescribed_motions_enter_both_routes_of_the_first_approximation_alike(description: Description) -> None:
    """Recursion to first order == differentiated equations == disturbed d'Alembert, however the coefficients vary."""
    analysis = analysed(description)
    assume(analysis.system.coordinates)
    expanded = reduction.by_projection(analysis.parameters_scene, analysis.reduced, None)
    closed = linearisation.by_equations(analysis.scene, analysis.equations, None)
    agreement = checks.check_linearisation(analysis.ring, expanded, closed)
    assert agreement.outcome == EXACT, agreement
    nothing = perturbation.Dependent({}, {})
    disturbed = reduction_check.check_perturbed_motion(analysis.system, analysis.ring, expanded, nothing)
    assert disturbed.outcome in (EXACT, NUMERICAL), disturbed


def pendulum(load: dict[str, Any], motion: Any = 0) -> Analysis:
    body = {"name": "rod", "attached to": 0, "rotation": {"axes": [3], "angles": ["q"]}, "mass": "m"}
    body |= {"mass centre": [1, 0, 0]}
    text = {"mbsym": 1, "name": "pendulum", "parameters": ["m", "k"], "bodies": [body], "loads": [load]}
    return analysed(text | {"motion": {"q": motion}}, range(1, 8))


@pytest.mark.parametrize("potential", ["k*q*sin(t)", "k*q**2*cos(2*t)"])
def test_a_load_that_varies_with_time_conserves_no_energy(potential: str) -> None:
    analysis = pendulum({"potential": potential})
    assert "generalised energy" not in [item.kind for item in analysis.integrals]
    assert "vary with t" in str(getattr(analysis.stage(6).failure, "reason", ""))


@pytest.mark.parametrize("force", ["-k*tanh(q_dot)", "1 - exp(k*q_dot)", "-k*atan(q_dot)"])
def test_dry_friction_smoothed_is_linearised(force: str) -> None:
    assert passed(pendulum({"generalized force": {"q": force}}), EXACT, NUMERICAL)


def test_the_sine_of_a_velocity_is_an_angle_like_any_other() -> None:
    assert passed(pendulum({"generalized force": {"q": "-k*sin(q_dot)"}}), EXACT, NUMERICAL)


def test_a_coordinate_may_rest_at_a_number() -> None:
    """M = m (a point at distance 1) and K = k, the spring's own stiffness, wherever it rests."""
    analysis = pendulum({"spring": {"coordinate": "q", "stiffness": "k", "rest": 0.5}}, motion=0.5)
    assert str(analysis.linearisation.M[0, 0]) == "m"
    assert str(analysis.linearisation.K[0, 0]) == "k"
    assert passed(analysis, EXACT, NUMERICAL)


# --- mass matrix ---


@law
@given(systems(solid=True))
def test_the_mass_matrix_is_symmetric_and_positive_definite(description: Description) -> None:
    analysis = analysed(description)
    assume(analysis.system.coordinates)
    rows = analysis.equations.mass_matrix.polynomials
    n = len(rows)
    assert all(rows[i][j] == rows[j][i] for i in range(n) for j in range(i))
    for here in rational_states(analysis.system, analysis.ring, 3):
        carry = Carrier(analysis.ring, here.numbers, here.values)
        values = [[carry(x) for x in row] for row in rows]
        minors = [fmpq_mat(k, k, [values[i][j] for i in range(k) for j in range(k)]).det() for k in range(1, n + 1)]
        assert min(minors) >= 0  # Sylvester; zero only where the axes of a joint fall together
        assume(0 not in minors)


def rate(analysis: Analysis, x: Polynomial, explicit: bool = True) -> Polynomial:
    """dx/dt, or only what the prescribed motions and t contribute to it where ``explicit``."""
    ring, scene = analysis.ring, analysis.scene
    total = ring.derivative(x, "t")
    for item in analysis.system.prescribed:
        total = total + ring.derivative(x, item.name) * scene.lower(item.rate)
    if not explicit:
        for name in analysis.system.coordinates:
            total = total + ring.derivative(x, name) * ring.generator("velocity", name)
            total = total + ring.velocity_derivative(x, name) * ring.generator("acceleration", name)
    return total


@law
@given(systems(loads=False, driven=False))
def test_the_rate_of_the_mass_matrix_less_twice_coriolis_is_skew(description: Description) -> None:
    """With C = -1/2 d f/d q', f the forcing of inertia alone (quadratic in q')."""
    analysis = analysed(description)
    ring, names = analysis.ring, analysis.system.coordinates
    mass = analysis.equations.mass_matrix.polynomials
    slopes = [[ring.velocity_derivative(f.polynomial, name) for name in names] for f in analysis.equations.forcing]
    for i in range(len(names)):
        for j in range(i + 1):
            both = slopes[i][j] + slopes[j][i]
            assert ring.is_zero(rate(analysis, mass[i][j], explicit=False) * 2 + both) is True


# --- energy and loads ---


@law
@given(systems())
def test_power_balance(description: Description) -> None:
    """d(T2 - T0 - U)/dt = sum q'_i (M q'' - f + Q)_i - the explicit rate of L, as an identity in q, q', q''."""
    analysis = analysed(description)
    ring, names = analysis.ring, analysis.system.coordinates
    lagrangian = analysis.energy.kinetic_energy.polynomial + analysis.energy.force_function.polynomial
    hamiltonian, power = -lagrangian, ring.zero
    for i, name in enumerate(names):
        speed = ring.generator("velocity", name)
        hamiltonian = hamiltonian + speed * ring.velocity_derivative(lagrangian, name)
        left_over = analysis.equations.generalized_force[i].polynomial - analysis.equations.forcing[i].polynomial
        for j, other in enumerate(names):
            entry = analysis.equations.mass_matrix[i, j].polynomial
            left_over = left_over + entry * ring.generator("acceleration", other)
        power = power + speed * left_over
    balance = rate(analysis, hamiltonian, explicit=False) - power + rate(analysis, lagrangian)
    assert ring.is_zero(balance) is True


@law
@given(st.one_of(systems(), orbiting()))
def test_forces_are_gradients_of_force_functions(description: Description) -> None:
    """Wrenches, projected on the joints, against dU/dq + Q."""
    analysis = analysed(description)
    ring = analysis.ring
    with_loads, without = residuals(analysis.scene), residuals(analysis.scene, loads=False)
    for i, name in enumerate(analysis.system.coordinates):
        slope = ring.derivative(analysis.energy.force_function.polynomial, name)
        applied = analysis.equations.generalized_force[i].polynomial
        assert ring.is_zero(without[name] - with_loads[name] - slope - applied) is True


@law
@given(st.one_of(systems(driven=False), orbiting(), spinning()))
def test_first_integrals_are_conserved(description: Description) -> None:
    """dI/dt = 0 exactly along the Taylor series of a motion that obeys the equations."""
    analysis = analysed(description, (3, 7))
    assume(analysis.system.coordinates)
    here = accelerated(analysis, state(analysis))
    moving = Oracle(analysis.system, here).moving
    carry = Carrier(analysis.ring, moving.algebra, moving.lower.environment)
    for integral in analysis.integrals:
        assert carry(integral.formula.polynomial).b == 0, integral


def accelerated(analysis: Analysis, here: State) -> State:
    """The state with the accelerations that the equations give it."""
    carry = Carrier(analysis.ring, here.numbers, here.values)
    names = analysis.system.coordinates
    n = len(names)
    mass = fmpq_mat(n, n, [carry(x) for row in analysis.equations.mass_matrix.polynomials for x in row])
    assume(mass.det() != 0)
    solved = mass.solve(fmpq_mat(n, 1, [carry(x.polynomial) for x in analysis.equations.forcing]))
    return State(here.numbers, {**here.values, **{name + "_ddot": solved[i, 0] for i, name in enumerate(names)}})


# --- what must not matter ---


@some
@given(systems(), st.randoms(use_true_random=False))
def test_names_and_order_do_not_matter(description: Description, source: Any) -> None:
    names = coordinates(description)
    new = {name: f"z{k}" for k, name in enumerate(source.sample(names, len(names)))}
    old = {z: name for name, z in new.items()}
    other = renamed(clone(description), new)
    waiting, placed = other["bodies"], []
    while waiting:  # parents first, else at random
        ready = [b for b in waiting if b["attached to"] in ["0", *(p["name"] for p in placed)]]
        placed.append(ready[source.randrange(len(ready))])
        waiting.remove(placed[-1])
    other["bodies"] = placed
    assert motion_numbers(analysed(other), lambda name: old.get(name, name)) == motion_numbers(analysed(description))


def renamed(part: Any, new: dict[str, str]) -> Any:
    """Coordinates renamed everywhere in a description."""
    if isinstance(part, dict):
        return {renamed(key, new): renamed(value, new) for key, value in part.items()}
    if isinstance(part, list):
        return [renamed(item, new) for item in part]
    if isinstance(part, str) and not part.startswith("body"):
        for name, z in new.items():
            part = part.replace(name, z)
    return part


@some
@given(systems(), vectors, axes, st.sampled_from(["alpha", "pi/2"]))
def test_a_massless_rigid_frame_changes_nothing(
    description: Description, point: list[int], axis: int, angle: str
) -> None:
    """Neither as a leaf nor in the middle of a joint."""
    frame = {
        "name": "frame",
        "connection point": point,
        "rotation": {"axes": [axis], "angles": [angle]},
        "coordinates": [],
        "mass": 0,
    }
    leaf = clone(description)
    leaf["bodies"].append({**frame, "attached to": leaf["bodies"][0]["name"]})
    middle = clone(description)
    held = middle["bodies"][-1]
    lifted = held.pop("connection point")
    rotation = held.pop("rotation", None)
    middle["bodies"].insert(-1, {**held_frame(held, lifted, rotation), "name": "frame"})
    held["attached to"] = "frame"
    held["coordinates"] = []
    expected = motion_numbers(analysed(description))
    assert motion_numbers(analysed(leaf)) == expected
    assert motion_numbers(analysed(middle)) == expected


def held_frame(held: Description, lifted: list[Any], rotation: Any) -> Description:
    """The joint of a body as a massless frame of its own; the body is then fixed to it."""
    frame: Description = {"attached to": held["attached to"], "connection point": lifted, "mass": 0}
    frame["coordinates"] = held["coordinates"]
    return frame | ({"rotation": rotation} if rotation else {})


@some
@given(st.data())
def test_inertia_may_be_about_the_joint_or_the_mass_centre(data: st.DataObject) -> None:
    about_joint = data.draw(systems(about="joint"))
    about_centre = clone(about_joint)
    for body in about_centre["bodies"]:
        if "inertia" in body:
            body["inertia about"] = "mass centre"
            body["inertia"] = central(body)
    assert motion_numbers(analysed(about_joint)) == motion_numbers(analysed(about_centre))


def central(body: Description) -> list[list[str]]:
    """Theta_C = Theta_O - m (c.c 1 - c c^T)."""
    c, mass = body["mass centre"], body["mass"]
    square = " + ".join(f"({x})**2" for x in c)
    rows = []
    for i in range(3):
        ordered = [sorted((i, j)) for j in range(3)]
        steiner = [f"{square if i == j else 0} - ({c[low]})*({c[high]})" for j, (low, high) in enumerate(ordered)]
        rows.append([f"{body['inertia'][i][j]} - {mass}*({steiner[j]})" for j in range(3)])
    return rows


@some
@given(systems(loads=False), axes, axes, vectors)
def test_turning_the_whole_system_leaves_the_energy_alone(
    description: Description, first: int, second: int, point: list[int]
) -> None:
    turned = clone(description)
    for body in turned["bodies"]:
        body["attached to"] = "base" if body["attached to"] == "0" else body["attached to"]
    base = {"name": "base", "attached to": 0, "mass": 0, "connection point": point, "coordinates": []}
    base["rotation"] = {"axes": [first, second], "angles": ["tilt", "beta"]}
    turned["bodies"].insert(0, base)
    turned["parameters"] |= {"tilt": "real", "beta": "real"}
    analysis = analysed(turned)
    energy = analysis.energy.kinetic_energy.polynomial
    degrees = energy.degrees()
    used = {g.name for g, degree in zip(analysis.ring.generators, degrees, strict=True) if degree > 0}
    assert not used & {"tilt", "beta"}
    assert motion_numbers(analysis) == motion_numbers(analysed(description))


@pytest.mark.parametrize("offset", [0, "l1"])
def test_programs_of_chains_grow_at_most_quadratically(offset: Any) -> None:
    counts = []
    for n in (4, 8, 16):
        bodies = [
            {
                "name": f"body {k}",
                "attached to": f"body {k - 1}" if k else 0,
                "rotation": {"axes": [1 + k % 3], "angles": [f"q{k}"]},
                "connection point": ["l1", offset, 0],
                "mass centre": ["l2", 1, offset],
                "mass": "m1",
                "inertia about": "mass centre",
                "inertia": [["A", "E", 0], ["E", "B", 0], [0, 0, "C"]],
            }
            for k in range(n)
        ]
        parameters = ["l1", "l2", "m1", "A", "B", "C", "E", "g"]
        loads = [{"uniform gravity": {"vector": [0, 0, "-g"]}}]
        text = {"mbsym": 1, "name": "chain", "parameters": parameters, "bodies": bodies, "loads": loads}
        found = analysed(text).programs
        counts.append(found.program.operations([*(x for row in found.mass_matrix for x in row), *found.forcing]))
    assert all(later <= 4.4 * earlier for earlier, later in pairwise(counts)), counts
