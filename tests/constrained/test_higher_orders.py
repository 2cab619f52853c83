"""Problems 11 and 12, averages and symmetries under constraints: the same as in coordinates that keep them."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

import mbsym
from mbsym.algebra.failures import Failure
from mbsym.analysis import Analysis
from mbsym.analysis.averaged import averaging_of
from mbsym.analysis.expanding import expansion
from mbsym.analysis.judge import exceptional
from mbsym.analysis.oscillating import oscillating
from mbsym.analysis.polynomial import integrals_of, setting
from mbsym.analysis.symmetric import symmetries_of
from mbsym.model.system import System
from mbsym.problems.integrals import ENERGY
from mbsym.simulation.expanded import measured
from mbsym.simulation.oscillating import measured_orders

HEAD = "mbsym: 1\nname: test\nparameters: {m: positive, l: positive, g: positive}\n"
NUMBERS = "values: {m: 1, l: 1, g: 10}\n"
GRAVITY = "loads: [uniform gravity: {vector: [0, -g, 0]}]\n"

#: Two equal masses, one below the other: rods told by angles, and by the distances that they keep.
IN_ANGLES = f"""{HEAD}bodies:
  - {{name: a, attached to: 0, rotation: {{axes: [3], angles: [p]}}, coordinates: [p], mass: m, mass centre: [0, -l, 0],
     inertia about: mass centre, inertia: [0, 0, 0]}}
  - {{name: b, attached to: a, connection point: [0, -l, 0], rotation: {{axes: [3], angles: [q]}}, coordinates: [q],
     mass: m, mass centre: [0, -l, 0], inertia about: mass centre, inertia: [0, 0, 0]}}
{GRAVITY}motion: {{p: 0, q: 0}}
{NUMBERS}"""
BY_DISTANCES = f"""{HEAD}bodies:
  - {{name: a, connection point: [x, y, 0], coordinates: [x, y], mass: m}}
  - {{name: b, attached to: 0, connection point: [u, v, 0], coordinates: [u, v], mass: m}}
{GRAVITY}constraints:
  - distance: {{between: [{{body: a, point: [0, 0, 0]}}, {{body: 0, point: [0, 0, 0]}}], length: l}}
  - distance: {{between: [{{body: a, point: [0, 0, 0]}}, {{body: b, point: [0, 0, 0]}}], length: l}}
motion: {{x: 0, y: -l, u: 0, v: -2*l}}
{NUMBERS}"""


def test_a_normal_form_does_not_know_what_keeps_the_rods() -> None:
    told, tied = (mbsym.loads(text, (11,)).normal_forms for text in (IN_ANGLES, BY_DISTANCES))
    for name in ("trace", "product", "discriminant", "determinant"):
        assert str(getattr(told.in_symbols, name)) == str(getattr(tied.in_symbols, name)), name
    assert told.at_values.outcome is tied.at_values.outcome


#: A mass at x, y on a surface; z by a relation that gives it, and by one that does not.
SURFACE = (
    "mbsym: 1\nname: bowl\nparameters: {m: positive, g: positive, k: real, c: positive}\nbodies:\n"
    "  - {name: p, mass: m, connection point: [x, y, z], coordinates: [x, y, z]}\n"
    "loads: [uniform gravity: {vector: [0, 0, -g]}]\nmotion: {x: 0, y: 0, z: 0}\n"
    "constraints: [relation: RELATION = 0]\nvalues: {m: 1, g: 10, k: 1, c: 1/3}\n"
)
HEIGHT = "k*x**2/2 + c*y**2/2 + x**2*y"


@pytest.mark.parametrize("relation", [f"z - ({HEIGHT})", f"(1 + z)*(z - ({HEIGHT}))"])
def test_a_bowl_is_that_of_its_height(relation: str) -> None:
    plain = SURFACE.replace("[x, y, z], coordinates: [x, y, z]", f"[x, y, {HEIGHT}], coordinates: [x, y]")
    plain = plain.replace("constraints: [relation: RELATION = 0]\n", "").replace(", z: 0", "")
    described = SURFACE.replace("RELATION", relation)
    told, tied = (mbsym.loads(x, (11,)).normal_forms for x in (plain, described))
    assert str(told.in_symbols.zero) == str(tied.in_symbols.zero)
    assert str(told.in_symbols.determinant) == str(tied.in_symbols.determinant)
    numbers = {"m": Fraction(1), "g": Fraction(10), "c": Fraction(1, 3)}
    listed = [exceptional(mbsym.loads(x), "k", (Fraction(-1), Fraction(1)), numbers) for x in (plain, described)]
    for along in listed:  # at k = 0 the height is c (y + x^2/c)^2/2 - x^4/(2 c)
        assert [(x.exactly, x.judged.outcome.value) for x in along.specials] == [(0, "unstable")]


PENDULUM = f"""{HEAD}bodies: [{{name: a, connection point: [x, y, 0], coordinates: [x, y], mass: m}}]
{GRAVITY}constraints:
  - distance: {{between: [{{body: a, point: [0, 0, 0]}}, {{body: 0, point: [0, 0, 0]}}], length: l}}
dependent: [y]
motion: {{x: 0, y: -l}}
initial: {{x: 1/4, y: -1}}
{NUMBERS}"""


def test_a_pendulum_in_two_coordinates_oscillates_as_one() -> None:
    """x = l sin(theta): the rate is w (1 - theta_max^2/16), theta_max = A/l but for higher orders."""
    system = mbsym.loads(PENDULUM, (3,)).system
    wave = oscillating(Analysis(system), 2)
    assert str(wave.formula(wave.oscillation.corrections[1])) == "-amplitude**2/(16*l**2)"
    orders = measured_orders(system, wave).orders
    assert min(x for x in orders if x is not None) > 2.9  # of eps^3, against runs that the constraint keeps


def test_oscillations_of_rolling_wheels_are_those_without_them() -> None:
    """3/2 m x'' + k x + b x^3 = 0:  w^2 = 2 k/(3 m), the rate w (1 + 3 b A^2/(8 k))."""
    text = (
        "mbsym: 1\nname: wheel\nparameters: {m: positive, k: positive, r: positive, b: positive}\nbodies:\n"
        "  - {name: w, connection point: [x, 0, 0], coordinates: [x, phi], mass: m, inertia about: mass centre,\n"
        "     rotation: {axes: [3], angles: [phi]}, inertia: [0, 0, m*r**2/2]}\n"
        "loads: [potential: k*x**2/2 + b*x**4/4]\nconstraints: [relation: x + r*phi = 0]\nmotion: {x: 0, phi: 0}\n"
    )
    wave = oscillating(mbsym.loads(text, (3,)).in_free_coordinates, 2)
    assert str(wave.formula(wave.oscillation.frequency)) == "sqrt(6*m*k)/(3*m)"
    assert str(wave.formula(wave.oscillation.corrections[1])) == "3*b*amplitude**2/(8*k)"


#: A rod on a pivot that is shaken along the vertical, with a gear of moment J that turns r times as much.
SHAKEN = """mbsym: 1
name: shaken
parameters: {m: positive, l: positive, g: positive, r: positive, h: positive, nu: positive, J: positive}
prescribed: {phase: {rate: nu}}
bodies:
  - {name: pivot, connection point: [0, h*cos(phase), 0], mass: 0}
  - {name: rod, attached to: pivot, coordinates: [theta], rotation: {axes: [3], angles: [theta]}, mass: m,
     mass centre: [0, l, 0], inertia about: mass centre, inertia: [0, 0, 0]}
  - {name: gear, attached to: 0, coordinates: [psi], rotation: {axes: [3], angles: [psi]}, mass: 0,
     inertia about: mass centre, inertia: [0, 0, J]}
loads: [uniform gravity: {vector: [0, -g, 0]}]
constraints: [relation: psi = r*theta]
motion: {theta: 0, psi: 0}
"""


def test_what_is_shaken_carries_its_gears() -> None:
    """V = (m l h nu sin(theta))^2/(4 (m l^2 + J r^2)), but for a constant."""
    analysis = mbsym.loads(SHAKEN, (12,))
    found = analysis.small_parameters.averaged[0].averaged
    assert found is not None
    assert str(found.vibrational) == "-m**2*l**2*h**2*nu**2*cos(theta)**2/(4*(m*l**2 + r**2*J))"
    with pytest.raises(Failure):  # the averages of the open tree would be others
        averaging_of(analysis, "phase")


def test_symmetries_are_those_of_the_coordinates_that_are_left() -> None:
    """In the plane two masses at a and -a turn about the origin, whichever of them is told by the other."""

    def count(system: System) -> int:
        return len(symmetries_of(Analysis(system)).symmetries)

    text = (
        "mbsym: 1\nname: two\nparameters: {m: positive, k: positive}\nbodies:\n"
        "  - {name: a, connection point: [x, y, 0], coordinates: [x, y], mass: m}\n"
        "  - {name: b, attached to: 0, connection point: [u, v, 0], coordinates: [u, v], mass: m}\n"
        "loads: [potential: k*(x**2 + y**2)/2]\n"
    )
    tied = mbsym.loads(text + "constraints: [relation: u + x = 0, relation: v + y = 0]\n", (3,)).system
    plain = mbsym.loads(text.replace("[u, v, 0], coordinates: [u, v]", "[-x, -y, 0]"), (3,)).system
    assert count(tied) == count(plain) > 1


# Tied positions in the field x' = X(x) that problems 9, 10 and 12 take.

SPHERE = f"""{HEAD}bodies: [{{name: a, attached to: 0, connection point: [x, y, z], coordinates: [x, y, z], mass: m}}]
loads: [uniform gravity: {{vector: [0, 0, -g]}}]
constraints:
  - distance: {{between: [{{body: a, point: [0, 0, 0]}}, {{body: 0, point: [0, 0, 0]}}], length: l}}
dependent: [z]
"""


def test_the_field_on_a_sphere_is_that_of_the_book() -> None:
    """x'' = x (g z - v^2)/l^2, with v^2 = x'^2 + y'^2 + (x x' + y y')^2/z^2."""
    field = setting(mbsym.loads(SPHERE)).whole
    p, q, z, y, x, l, g = map(field.generator, ("x_dot", "y_dot", "z", "y", "x", "l", "g"))
    assert [str(relation) for relation in field.relations] == ["-l^2 + z^2 + y^2 + x^2"]
    force = g * z**3 - (p**2 + q**2) * z**2 - (x * p + y * q) ** 2
    for name, position in (("x_dot", x), ("y_dot", y)):
        found = field.numerators[field.variables.index(name)]
        assert field.reduced(found * l**2 * z**2 - position * force * field.denominator) == 0


@pytest.mark.parametrize("text", [SPHERE, BY_DISTANCES, SURFACE.replace("RELATION", f"z - ({HEIGHT})"), PENDULUM])
def test_the_energy_is_kept_by_the_field_on_what_is_tied(text: str) -> None:
    analysis = mbsym.loads(text, (7,))
    there = setting(analysis)
    energy = next(x.formula.polynomial for x in analysis.integrals if x.kind == ENERGY)
    top, bottom = there.transfer.fraction(energy)
    field = there.whole
    assert field.reduced(field.derivative(top) * bottom - top * field.derivative(bottom)) == 0
    broken = replace(field, numerators=(field.numerators[0] * 2, *field.numerators[1:]))
    assert field.reduced(broken.derivative(top) * bottom - top * broken.derivative(bottom)) != 0


def test_integrals_on_a_sphere_are_found_without_being_known() -> None:
    """x y' - y x' is the only one up to degree 4 that is polynomial without z'."""
    there = replace(setting(mbsym.loads(SPHERE)), known=())
    found = integrals_of(there, 4)
    (integral,) = found.generators
    assert found.tied  # a plane and another surface have one field, and the plane may keep more: that is said
    field = there.whole
    p, q, y, x = map(field.generator, ("x_dot", "y_dot", "y", "x"))
    assert (integral.polynomial - (p * y - q * x)) * (integral.polynomial + (p * y - q * x)) == 0


#: A bead without mass but for eps, in a viscous fluid: on a circle, and on a parabola.
SLOW = """mbsym: 1
name: slow
parameters: {k: positive, b: positive, eps: positive, r: positive}
bodies: [{name: a, attached to: 0, connection point: [x, y, 0], coordinates: [x, y], mass: eps}]
loads: [potential: k*x**2/2 + k*y**2, rayleigh: b*(x_dot**2 + y_dot**2)/2]
small parameter: eps
values: {k: 1, b: 1, eps: 1/20, r: 1}
"""
ON_A_CIRCLE = "distance: {between: [{body: a, point: [0, 0, 0]}, {body: 0, point: [0, 0, 0]}], length: r}"


@pytest.mark.parametrize(
    ("constraint", "start", "flow"),
    [
        (ON_A_CIRCLE, "initial: {x: 4/5, y: 3/5}", "k*x*(1 - x/r)*(x/r + 1)/b"),
        ("relation: y = x**2", "initial: {x: 1/2, y: 1/4}", "-k*x/b"),
    ],
)
def test_slow_motions_of_what_is_tied(constraint: str, start: str, flow: str) -> None:
    """-dV/ds over b (ds/dx)^2, as it is by hand; errors of eps^3 against runs that the constraint keeps."""
    text = f"{SLOW}constraints: [{constraint}]\n{start}\n"
    analysis = mbsym.loads(text, (12,)).in_free_coordinates
    slow = expansion(analysis, 2)
    assert str(slow.formula(slow.manifold.functions[0].coefficients[0])) == flow
    told = measured(analysis.system, slow)
    assert min(told.orders) > 2.8
