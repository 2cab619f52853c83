"""Negative controls: a mistake planted in one place must make the self-check of the right result fail.

Each mistake is a piece of the source of one function, replaced; the function is then compiled again in its module.
"""

from __future__ import annotations

import dataclasses
import importlib
import inspect
import json
import sys
import textwrap
from dataclasses import dataclass
from functools import cache
from typing import Any

import pytest

import mbsym
from mbsym.analysis import Analysis
from mbsym.mechanics.loads.interface import Kind
from mbsym.mechanics.loads.kinds import KINDS

KINEMATICS, ENERGY, EQUATIONS, PROGRAM, REGULAR, EQUILIBRIUM, LINEARISATION, PERTURBED, INTEGRALS = ALL = (
    "kinematics",
    "energy",
    "equations of motion",
    "straight-line program",
    "mass matrix",
    "equilibrium",
    "linearisation",
    "perturbed motion",
    "first integrals",
)
DYNAMICS = (EQUATIONS, PROGRAM)

# --- systems in which every term counts ---

PARAMETERS = ["m1", "m2", "m3", "l", "A", "B", "C", "E", "k", "k2", "b", "b2", "g", "Omega", "F", "T", "R", "nu"]
TENSOR = [["A", "E", 0], ["E", "B", 0], [0, 0, "C"]]

#: A cart, an arm on a universal joint, a bead that slides along the arm and is turned by a motor; loads of every kind.
MACHINE = {
    "mbsym": 1,
    "name": "machine",
    "parameters": PARAMETERS,
    "prescribed": {"chi": "Omega"},
    "bodies": [
        {"name": "cart", "attached to": 0, "connection point": ["x", 0, 0], "mass": "m1", "coordinates": ["x"]},
        {
            "name": "arm",
            "attached to": "cart",
            "rotation": {"axes": [1, 2], "angles": ["p", "-q"]},
            "connection point": [0, "l", "sin(x)"],
            "mass centre": [0, 1, "l"],
            "mass": "m2",
            "inertia about": "joint",
            "inertia": TENSOR,
        },
        {
            "name": "bead",
            "attached to": "arm",
            "rotation": {"axes": [1], "angles": ["chi"]},
            "connection point": [1, 0, "r"],
            "mass centre": ["l", 2, 0],
            "mass": "m3",
            "inertia about": "mass centre",
            "inertia": TENSOR,
            "coordinates": ["r"],
        },
    ],
    "loads": [
        {"uniform gravity": {"vector": ["g", 0, "-2*g"]}},
        {"spring": {"coordinate": "r", "stiffness": "k", "rest": "l"}},
        {"damper": {"coordinate": "q", "coefficient": "b"}},
        {
            "spring": {
                "between": [{"body": 0, "point": [1, "l", 0]}, {"body": "bead", "point": [0, 0, 1]}],
                "stiffness": "k2",
                "length": 0,
            }
        },
        {
            "damper": {
                "between": [{"body": "cart", "point": [0, 1, 0]}, {"body": "bead", "point": [1, 0, 0]}],
                "coefficient": "b2",
            }
        },
        {"potential": "k*(p - q)**2/2"},
        {"rayleigh": "b*(p_dot - q_dot)**2/2"},
        {"generalized force": {"x": "F - b*x_dot*q"}},
        {"force": {"body": "bead", "point": [0, "l", 1], "components": ["F", 0, "2*F"], "axes": "bead"}},
        {"torque": {"body": "bead", "components": [0, "T", "T"], "axes": "cart", "reaction on": "arm"}},
    ],
}

#: The same without the motor on a spinning shaft, moving steadily: coordinates at rest, the shaft at the rate Omega.
SPINNING = {
    "mbsym": 1,
    "name": "spinning machine",
    "parameters": PARAMETERS,
    "bodies": [
        {
            "name": "shaft",
            "attached to": 0,
            "rotation": {"axes": [3], "angles": ["phi"]},
            "mass": 0,
            "inertia about": "joint",
            "inertia": [0, 0, "C"],
        },
        {
            "name": "arm",
            "attached to": "shaft",
            "rotation": {"axes": [1, 2], "angles": ["p", "-q"]},
            "connection point": [0, "l", 1],
            "mass centre": [0, 1, "l"],
            "mass": "m2",
            "inertia about": "joint",
            "inertia": TENSOR,
        },
        {
            "name": "bead",
            "attached to": "arm",
            "connection point": [1, "l*sin(r)", "r"],
            "mass centre": ["l", 2, 0],
            "mass": "m3",
            "coordinates": ["r"],
        },
    ],
    "loads": [
        {"uniform gravity": {"vector": [0, 0, "-g"]}},
        {"spring": {"coordinate": "r", "stiffness": "k", "rest": "l"}},
        {"damper": {"coordinate": "q", "coefficient": "b"}},
        {"force": {"body": "bead", "point": [0, "l", 1], "components": ["F", 0, "2*F"], "axes": "bead"}},
    ],
    "motion": {"phi": {"value": 0, "rate": "Omega"}, "p": "T", "q": 0, "r": 0},
    "dimensionless time": "Omega",
}

#: A body whose expansion point moves freely in the plane of its orbit, so that even its distance is a coordinate.
ORBITING = {
    "mbsym": 1,
    "name": "free orbit",
    "parameters": PARAMETERS,
    "bodies": [
        {
            "name": "orbit",
            "attached to": 0,
            "connection point": ["r*sin(u)", "r*cos(u)", 0],
            "rotation": {"axes": [3], "angles": ["-u"]},
            "mass": 0,
            "coordinates": ["r", "u"],
        },
        {
            "name": "body",
            "attached to": "orbit",
            "rotation": {"axes": [1, 2], "angles": ["p", "q"]},
            "connection point": [1, 0, "l"],
            "mass centre": [0, "l", 2],
            "mass": "m1",
            "inertia about": "joint",
            "inertia": TENSOR,
        },
    ],
    "loads": [{"newtonian gravity": {"constant": "nu", "centre": 0, "about": "orbit", "order": 2}}],
}

#: The same with the expansion point on a given circle.
CARRIED = {
    **ORBITING,
    "name": "circular orbit",
    "prescribed": {"chi": "Omega"},
    "bodies": [
        {
            "name": "orbit",
            "attached to": 0,
            "connection point": ["R*sin(chi)", "R*cos(chi)", 0],
            "rotation": {"axes": [3], "angles": ["-chi"]},
            "mass": 0,
        },
        ORBITING["bodies"][1],
    ],
}

#: A pendulum whose pivot is accelerated in a prescribed way.
LIFT = {
    "mbsym": 1,
    "name": "lift",
    "parameters": PARAMETERS,
    "prescribed": {"chi": "Omega"},
    "bodies": [
        {
            "name": "rod",
            "attached to": 0,
            "rotation": {"axes": [3], "angles": ["q"]},
            "connection point": ["chi", "k*chi**2/2", 0],
            "mass centre": [0, "-l", 0],
            "mass": "m1",
        }
    ],
    "loads": [{"uniform gravity": {"vector": [0, "-g", 0]}}],
    "motion": {"q": 0},
}

SYSTEMS = {
    "lift": (LIFT, (1, 2, 3, 4, 5)),
    "machine": (MACHINE, (1, 2, 3)),
    "spinning": (SPINNING, (1, 2, 3, 4, 5)),
    "free orbit": (ORBITING, (1, 2, 3)),
    "circular orbit": (CARRIED, (1, 2, 3)),
}


def analysed(name: str) -> Analysis:
    description, problems = SYSTEMS[name]
    return mbsym.loads(json.dumps(description, indent=1), problems)


def failing(name: str) -> set[str]:
    return {check.name for check in analysed(name).checks if check.failed}


@cache
def failing_without_a_mistake(name: str) -> set[str]:
    return failing(name)


@pytest.mark.parametrize("name", ["machine", "spinning", "circular orbit", "free orbit"])
def test_without_a_mistake_nothing_fails(name: str) -> None:
    checks = analysed(name).checks
    # Where a coordinate rests at a parameter, sines and cosines of that parameter are irrational: balls.
    allowed = {"exact", "verified numerically"} if name == "spinning" else {"exact"}
    assert {check.outcome for check in checks} <= allowed
    assert {check.outcome for check in checks if check.name != PERTURBED} == {"exact"}
    assert {check.name for check in checks} == set(ALL[:8] if name == "spinning" else ALL[:5])


@pytest.mark.parametrize("height", ["sqrt(l**2 - x**2)", "log(x - l)", "(l - x)**(3/2)"])
def test_a_root_of_limited_domain_is_no_mistake(height: str) -> None:
    bead = {"name": "bead", "attached to": 0, "connection point": ["x", height, 0], "mass": "m", "coordinates": ["x"]}
    system = {"mbsym": 1, "name": "bead on a wire", "parameters": ["l", "m"], "bodies": [bead]}
    assert not [check for check in mbsym.loads(json.dumps(system), (1, 2, 3)).checks if check.failed]


# --- planting ---


@dataclass(frozen=True)
class Mistake:
    """In ``where`` (module:function or module:Class.method below mbsym), ``right`` becomes ``wrong``."""

    what: str
    where: str
    right: str
    wrong: str
    system: str
    caught: tuple[str, ...]


def plant(monkeypatch: pytest.MonkeyPatch, mistake: Mistake) -> None:
    module_name, qualified = mistake.where.split(":")
    module = importlib.import_module(f"mbsym.{module_name}")
    *outer, name = qualified.split(".")
    owner: Any = getattr(module, outer[0]) if outer else module
    original = getattr(owner, name)
    source = textwrap.dedent(inspect.getsource(original))
    if source.count(mistake.right) != 1:
        raise LookupError(f"{mistake.where} has changed: {mistake.right} must occur in it once")
    scope = dict(vars(module))
    exec("from __future__ import annotations\n" + source.replace(mistake.right, mistake.wrong), scope)
    replacement = scope[name]
    if outer:
        monkeypatch.setattr(owner, name, replacement)
        return
    scope.update({name: replacement})
    for other in [m for key, m in sys.modules.items() if key.split(".")[0] == "mbsym"]:
        for key, value in list(vars(other).items()):
            if value is original:
                monkeypatch.setattr(other, key, replacement)
    for load, kind in KINDS.items():
        changed = {
            field.name: replacement for field in dataclasses.fields(Kind) if getattr(kind, field.name) is original
        }
        if changed:
            monkeypatch.setitem(KINDS, load, dataclasses.replace(kind, **changed))


RECURSIONS = "mechanics.kinematics:Scene._motion"
CAUGHT = [
    Mistake(
        "a sign in the cross product",
        "algebra.vectors:Vector.cross",
        "(c, -a)",
        "(c, a)",
        "machine",
        (KINEMATICS, ENERGY, *DYNAMICS),
    ),
    Mistake(
        "turns in reversed order",
        "mechanics.kinematics:Scene._turns",
        "in body.rotation.turns()",
        "in reversed(list(body.rotation.turns()))",
        "machine",
        (KINEMATICS, ENERGY, *DYNAMICS),
    ),
    Mistake(
        "active for passive rotations",
        "mechanics.frames:_turned",
        "((c, s), (x, y))",
        "((c, -s), (x, y))",
        "machine",
        (KINEMATICS, ENERGY, *DYNAMICS),
    ),
    Mistake(
        "the sign of the sine when turning forwards",
        "mechanics.frames:Turn.out",
        "self.axis, self.sine",
        "self.axis, -self.sine",
        "machine",
        (KINEMATICS, ENERGY, *DYNAMICS),
    ),
    Mistake(
        "the sign of the sine when turning back",
        "mechanics.frames:Turn.back",
        "-self.sine",
        "self.sine",
        "machine",
        DYNAMICS,
    ),
    Mistake(
        "omega_k for omega_j, as the paper prints it",
        RECURSIONS,
        "parent_spin.cross(offset)",
        "spin.in_parallel(before).cross(offset)",
        "machine",
        (KINEMATICS, ENERGY, EQUATIONS),
    ),
    Mistake(
        "the velocity of a sliding joint",
        RECURSIONS,
        "carried + relative_velocity",
        "carried",
        "machine",
        (KINEMATICS, ENERGY, EQUATIONS),
    ),
    Mistake(
        "an angle's rate taken before its turn",
        RECURSIONS,
        "turn.out(spin) + rate",
        "turn.out(spin + axis_vector(algebra, turn.axis % 3 + 1, turn.rate, turn.source))",
        "machine",
        (KINEMATICS, ENERGY, EQUATIONS),
    ),
    Mistake(
        "prescribed motions forgotten in rates",
        "mechanics.variables:time_derivative",
        "| {item.name: item.rate for item in system.prescribed}",
        "",
        "machine",
        (KINEMATICS, ENERGY, *DYNAMICS),
    ),
    Mistake(
        "the derivative of the sine",
        "expressions.tree:_derivative_of_function",
        'return Call("cos", argument)',
        'return Call("sin", argument)',
        "machine",
        (KINEMATICS, ENERGY, *DYNAMICS),
    ),
    Mistake(
        "the mixed term of the kinetic energy",
        "mechanics.energy:body_energy",
        "algebra.times(algebra.number(2), velocity.dot(swing))",
        "velocity.dot(swing)",
        "machine",
        (ENERGY, EQUATIONS),
    ),
    Mistake(
        "the wrong point of a tensor in the kinetic energy",
        "mechanics.energy:body_energy",
        "velocity = motion.velocity_origin if about_joint else motion.velocity_mass_centre",
        "velocity = motion.velocity_mass_centre",
        "machine",
        (ENERGY, EQUATIONS),
    ),
    # --- the Newton-Euler recursion ---
    Mistake(
        "the Coriolis term 2 w x r' dropped",
        "mechanics.newton_euler:Accelerations._step",
        " + spin.cross(relative_velocity) * two",
        "",
        "machine",
        (PROGRAM,),
    ),
    Mistake(
        "Coriolis without its factor",
        "mechanics.newton_euler:Accelerations._step",
        "algebra.number(2)",
        "algebra.number(1)",
        "machine",
        (PROGRAM,),
    ),
    Mistake(
        "the centripetal term dropped",
        "mechanics.newton_euler:Accelerations._step",
        " + spin.cross(spin.cross(r))",
        "",
        "spinning",
        (PROGRAM, EQUILIBRIUM),
    ),
    Mistake(
        "the cross term w x x' e of an angular acceleration",
        "mechanics.newton_euler:Accelerations._step",
        " + spin.cross(rate)",
        "",
        "machine",
        (PROGRAM,),
    ),
    Mistake(
        "the gyroscopic moment dropped",
        "mechanics.newton_euler:_inertia_wrench",
        " + spin.cross(inertia @ spin)",
        "",
        "spinning",
        (PROGRAM, EQUILIBRIUM),
    ),
    Mistake(
        "the lever of a tensor about the joint",
        "mechanics.newton_euler:_inertia_wrench",
        "origin if about_joint else at_centre",
        "at_centre",
        "machine",
        (PROGRAM,),
    ),
    Mistake(
        "the moment that a force has about the previous joint",
        "mechanics.newton_euler:Joints.projections",
        " + motion.offset.cross(carried)",
        "",
        "spinning",
        (PROGRAM, EQUILIBRIUM, LINEARISATION),
    ),
    Mistake(
        "the rate of an angle -q in a projection",
        "mechanics.newton_euler:Joints._project",
        "lower(differentiate(turn.angle, name))",
        "algebra.one",
        "machine",
        (PROGRAM,),
    ),
    Mistake(
        "the moment that a composite body's force has about the previous joint, in the mass matrix",
        "mechanics.factorisation:_Composite._climb",
        " + frame.offset.cross(force)",
        "",
        "machine",
        (PROGRAM,),
    ),
    # --- loads ---
    Mistake(
        "the sign of a spring's force function",
        "mechanics.loads.kinds:_spring_force_function",
        "Fraction(-1, 2)",
        "Fraction(1, 2)",
        "spinning",
        (EQUATIONS, EQUILIBRIUM),
    ),
    Mistake(
        "the sign of a spring's force",
        "mechanics.loads.kinds:_spring_action",
        "-pull",
        "pull",
        "spinning",
        (PROGRAM, EQUILIBRIUM),
    ),
    Mistake(
        "the sign of a damper",
        "mechanics.loads.kinds:_damper_action",
        "-scene.algebra.times",
        "scene.algebra.times",
        "machine",
        DYNAMICS,
    ),
    Mistake(
        "a spring between points that repels",
        "mechanics.loads.kinds:_point_spring_action",
        "pair.span * algebra.reduce(factor)",
        "pair.span * algebra.reduce(-factor)",
        "machine",
        (PROGRAM,),
    ),
    Mistake(
        "a dashpot between points that pushes",
        "mechanics.loads.kinds:closing",
        "speeds[1] - speeds[0]",
        "speeds[0] - speeds[1]",
        "machine",
        DYNAMICS,
    ),
    Mistake(
        "a damper between points that does not act along their line",
        "mechanics.loads.kinds:_point_damper_action",
        "pair.span * algebra.reduce(algebra.times(coefficient, rate))",
        "towards * coefficient",
        "machine",
        DYNAMICS,
    ),
    Mistake(
        "no reaction at the other end of a spring",
        "mechanics.loads.kinds:Pair.action",
        "(pull, -pull)",
        "(pull, pull)",
        "machine",
        DYNAMICS,
    ),
    Mistake(
        "the sign of a potential",
        "mechanics.loads.kinds:_force_function",
        "-value if",
        "value if",
        "machine",
        (EQUATIONS,),
    ),
    Mistake(
        "the sign of a dissipation function",
        "mechanics.loads.kinds:_rayleigh_action",
        "-scene.lower",
        "scene.lower",
        "machine",
        DYNAMICS,
    ),
    Mistake(
        "a follower force that does not follow",
        "mechanics.loads.kinds:_force_action",
        "load.axes",
        '"0"',
        "machine",
        DYNAMICS,
    ),
    Mistake(
        "a torque without its reaction",
        "mechanics.loads.kinds:_torque_action",
        "(load.reaction_on, -vector)",
        "(None, -vector)",
        "machine",
        DYNAMICS,
    ),
    Mistake(
        "the moment of a force about the connection point",
        "mechanics.loads.interface:force_at",
        "point.cross(force)",
        "force.cross(point)",
        "machine",
        DYNAMICS,
    ),
    Mistake(
        "the height of a joint in uniform gravity",
        "mechanics.loads.kinds:lifting",
        "field[parent].dot(motion.offset)",
        "algebra.zero",
        "machine",
        (EQUATIONS,),
    ),
    # --- Newtonian gravity ---
    Mistake(
        "the trace term of gravity dropped",
        "mechanics.loads.kinds:_newtonian_force_function",
        "second + algebra.times(half, trace)",
        "second",
        "free orbit",
        (EQUATIONS,),
    ),
    Mistake(
        "the trace of the mass centre's moment dropped",
        "mechanics.loads.kinds:_newtonian_force_function",
        " - algebra.times(half, c.dot(c))",
        "",
        "circular orbit",
        (EQUATIONS,),
    ),
    Mistake(
        "the linear term U_1 of gravity dropped",
        "mechanics.loads.kinds:_newtonian_force_function",
        "orbit.potential - algebra.times(orbit.weight, along)",
        "orbit.potential",
        "circular orbit",
        (EQUATIONS,),
    ),
    Mistake(
        "Theta_O for Theta_C: Steiner's term with the wrong sign",
        "mechanics.loads.orbit:central_inertia",
        "motion.inertia[i][j] - algebra",
        "motion.inertia[i][j] + algebra",
        "circular orbit",
        DYNAMICS,
    ),
    Mistake(
        "the gravity torque reversed",
        "mechanics.loads.kinds:_newtonian_action",
        "e.cross(tensor @ e)",
        "(tensor @ e).cross(e)",
        "circular orbit",
        (PROGRAM,),
    ),
    Mistake(
        "the constant pull dropped from the force of gravity",
        "mechanics.loads.kinds:_newtonian_action",
        "along - orbit.weight",
        "along",
        "circular orbit",
        (PROGRAM,),
    ),
    # --- Lagrange's equations ---
    Mistake(
        "-dT/dq omitted",
        "problems.equations:equations",
        "ring.derivative(lagrangian, name)",
        "ring.derivative(energy.force_function.polynomial, name)",
        "spinning",
        (EQUATIONS, EQUILIBRIUM, LINEARISATION),
    ),
    Mistake(
        "prescribed motions dropped from the convective derivative",
        "mechanics.variables:rate_of",
        "in system.prescribed",
        "in ()",
        "machine",
        (EQUATIONS,),
    ),
    Mistake(
        "one coordinate dropped from the convective derivative",
        "problems.equations:convective_rate",
        "in scene.system.coordinates",
        "in scene.system.coordinates[1:]",
        "machine",
        (EQUATIONS,),
    ),
    Mistake(
        "the moments dropped from the generalised forces",
        "mechanics.loads.kinds:generalized_forces",
        " + wrench.moment.dot(spin)",
        "",
        "machine",
        (EQUATIONS,),
    ),
    Mistake(
        "the derivative of a cosine in the ring",
        "algebra.ring:Ring._declare_angles",
        "c: -self._gens[s] * factor",
        "c: self._gens[s] * factor",
        "machine",
        (EQUATIONS,),
    ),
    # --- linearisation ---
    Mistake(
        "a coefficient in the cosine of a jet",
        "algebra.jet:Jets._turned",
        "x * (k + 1)",
        "x * (k + 2)",
        "spinning",
        (LINEARISATION,),
    ),
    Mistake(
        "the slope of a jet's sine",
        "algebra.jet:Jets._turned",
        "times(s, small_cosine) + times(c, small_sine)",
        "times(s, small_cosine) - times(c, small_sine)",
        "spinning",
        (LINEARISATION,),
    ),
    Mistake(
        "the gyroscopic matrix transposed in one route",
        "mechanics.expansion:projected",
        "B=_cut(scene, forms, speeds)",
        "B=tuple(zip(*_cut(scene, forms, speeds), strict=True))",
        "spinning",
        (LINEARISATION,),
    ),
    Mistake(
        "G and N exchanged in one route",
        "problems.reduction:by_projection",
        "(mass, velocity, position, gains))",
        "(mass, position, velocity, gains))",
        "spinning",
        (LINEARISATION,),
    ),
    Mistake(
        "accelerations that do not deviate",
        "mechanics.expansion:over_jets",
        "jets.deviation(2 * n + i, base.accelerations[i])",
        "Jet(base.accelerations[i])",
        "spinning",
        (LINEARISATION,),
    ),
    Mistake(
        "the acceleration of a prescribed motion",
        "mechanics.newton_euler:Accelerations._step",
        "at + second, name",
        "at, name",
        "lift",
        (LINEARISATION, PERTURBED),
    ),
    Mistake(
        "velocities that do not deviate",
        "mechanics.expansion:projected",
        "*found.velocities, ",
        "*([{}] * n), ",
        "spinning",
        (LINEARISATION,),
    ),
]


@pytest.mark.parametrize("mistake", CAUGHT, ids=lambda mistake: mistake.what)
def test_a_planted_mistake_is_caught(monkeypatch: pytest.MonkeyPatch, mistake: Mistake) -> None:
    before = failing_without_a_mistake(mistake.system)
    plant(monkeypatch, mistake)
    assert failing(mistake.system) - before >= set(mistake.caught)


# --- blind spots: mistakes that no check sees yet ---

BLIND = [
    Mistake(
        "the relative angular velocity (problem 1)",
        RECURSIONS,
        "relative = turn.out(relative) + rate",
        "relative = rate",
        "machine",
        (KINEMATICS,),
    ),
    Mistake(
        "A1 of the kinetic energy (problem 2)",
        "problems.energy:energy",
        "A1=column(ring, [ring.substitute(p, at_rest) for p in momenta])",
        "A1=column(ring, [ring.zero for p in momenta])",
        "machine",
        (ENERGY,),
    ),
    Mistake(
        "A0 of the kinetic energy (problem 2)",
        "problems.energy:energy",
        "A0=Formula(ring, ring.substitute(kinetic, at_rest))",
        "A0=Formula(ring, ring.zero)",
        "machine",
        (ENERGY,),
    ),
    Mistake(
        "a term of the force function that does not vary (problem 2)",
        "mechanics.loads.kinds:_newtonian_force_function",
        "second + algebra.times(half, trace)",
        "second",
        "circular orbit",
        (ENERGY,),
    ),
    Mistake(
        "the energy of the straight-line program",
        "mechanics.programs:programs",
        "kinetic - force -",
        "kinetic + force -",
        "machine",
        (PROGRAM,),
    ),
    Mistake(
        "symmetric and skew parts exchanged in both routes",
        "problems.linearisation:assemble",
        "symmetric(C).rows),\n        G=Matrix.of(ring, skew(C).rows)",
        "skew(C).rows),\n        G=Matrix.of(ring, symmetric(C).rows)",
        "spinning",
        (PERTURBED,),
    ),
    Mistake(
        "G and N exchanged in both routes",
        "problems.linearisation:assemble",
        "M, C, S, B = (",
        "M, S, C, B = (",
        "spinning",
        (PERTURBED,),
    ),
    Mistake(
        "the unperturbed values of the coordinates in both routes",
        "mechanics.motion:motion_values",
        "entry.coordinate: (entry.value, entry.rate)",
        "entry.coordinate: (ZERO, entry.rate)",
        "spinning",
        (PERTURBED,),
    ),
    Mistake(
        "the unit of time of a subsystem",
        "problems.linearisation:_subsystem",
        "inverse, inverse, inverse**2, inverse**2",
        "inverse, inverse, inverse, inverse",
        "spinning",
        (PERTURBED,),
    ),
]


@pytest.mark.parametrize("mistake", BLIND, ids=lambda mistake: mistake.what)
def test_a_mistake_in_a_blind_spot_is_caught(monkeypatch: pytest.MonkeyPatch, mistake: Mistake) -> None:
    before = failing_without_a_mistake(mistake.system)
    plant(monkeypatch, mistake)
    assert failing(mistake.system) - before >= set(mistake.caught)
