"""Applied forces with a generalized potential: magnetic ones against a turning frame, and forces that have none."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
import sympy

import mbsym
from mbsym.algebra.failures import Failure
from mbsym.analysis.higher import ignorable
from mbsym.analysis.judge import exceptional
from mbsym.problems.normal_forms import expansion as generalized_potential
from mbsym.problems.normal_forms.result import NormalForms, Outcome, Theorem
from mbsym.report.words.exceptional_values import lines

POINT = """
mbsym: 1
name: a particle
parameters: {B: positive, c: positive}
PRESCRIBED
bodies:
  - {name: p, attached to: 0, connection point: [x, y, z], mass: 1, coordinates: [x, y, z]}
loads:
  - potential: POTENTIAL
  - generalized force: {FORCES}
motion: {x: 0, y: 0, z: 0}
values: {B: 2, c: 1}
"""
#: x'' = 2 W y' + W^2 x - dV/dx: at W = B/2 the particle sees the field B, over V - W^2 (x^2 + y^2)/2.
TURNING = """
mbsym: 1
name: a particle on a turntable
parameters: {B: positive}
prescribed: {psi: {rate: B/2}}
bodies:
  - name: table
    attached to: 0
    rotation: {axes: [3], angles: [psi]}
    mass: 0
    inertia about: joint
    inertia: [0, 0, 0]
  - {name: p, attached to: table, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
loads: [{potential: V}]
motion: {x: 0, y: 0}
values: {B: 2}
"""
SADDLE = "x**2/4 - y**2/8 + x**2*y + y**4"
MAGNETIC = "x: B*y_dot, y: -B*x_dot"


def point(forces: str, potential: str = "c*(x**2 + y**2 + z**2)", prescribed: str = "") -> str:
    return POINT.replace("FORCES", forces).replace("POTENTIAL", potential).replace("PRESCRIBED", prescribed)


def hamiltonian(text: str) -> bool:
    return ignorable(mbsym.loads(text))[0]


def of(text: str) -> NormalForms:
    found: NormalForms = mbsym.loads(text, (6, 11)).normal_forms
    return found


def test_a_magnetic_field_does_what_a_turntable_does() -> None:
    turning = of(TURNING.replace("V", SADDLE))
    field = of(point(MAGNETIC, f"{SADDLE} - B**2*(x**2 + y**2)/8"))
    assert field.taken_in
    assert not turning.taken_in
    assert field.cyclic == ("z",)
    assert turning.at_values is not None
    assert field.at_values is not None
    assert field.at_values.theorem is turning.at_values.theorem is Theorem.ARNOLD_MOSER
    ((order, ours),), ((_, theirs),) = field.at_values.determinants, turning.at_values.determinants
    assert order == 4
    assert ours.overlaps(theirs)
    assert abs(float(theirs)) > 0.1


def test_values_of_a_field_are_those_of_the_turntable() -> None:
    interval = (Fraction(0), Fraction(4))
    field = mbsym.loads(point(MAGNETIC, f"{SADDLE} - B**2*(x**2 + y**2)/8"))
    turning = mbsym.loads(TURNING.replace("V", SADDLE))
    ours, theirs = (list(lines(exceptional(one, "B", interval, {}))) for one in (field, turning))
    assert ours[0] == "without the cyclic coordinates z, their momenta unperturbed"
    assert ours[1:] == theirs
    assert len(theirs) > 8


@pytest.mark.parametrize(
    "forces",
    [
        "x: -B*x_dot",
        "x: B*y, y: -B*x",
        "x: x_dot*y_dot, y: -x_dot**2",  # does no work, and is no form linear in velocities
        "x: B*z*y_dot, y: -B*z*x_dot",  # a field whose divergence is not zero
        "x: B*y_dot, y: -B*x_dot, z: x**5*y",  # up to fifth order there is a potential
        "x: B*y_dot*cos(t), y: -B*x_dot*cos(t)",
    ],
)
def test_forces_without_a_generalized_potential(forces: str) -> None:
    assert not hamiltonian(point(forces))


def test_a_field_that_goes_with_a_prescribed_angle_is_none() -> None:
    text = "x: B*y_dot*cos(s), y: -B*x_dot*cos(s)"
    assert not hamiltonian(point(text, prescribed="prescribed: {s: {rate: c}}"))


X = sympy.symbols("x y z")
V = sympy.symbols("x_dot y_dot z_dot")


def forces_of(vector: tuple[Any, ...], scalar: Any) -> str:
    """Lorentz's force of a vector potential A and a potential: Q_i = sum_j (dA_j/dx_i - dA_i/dx_j) v_j - dU/dx_i."""
    lorentz = [
        sum((a.diff(x) - own.diff(y)) * v for a, y, v in zip(vector, X, V, strict=True))
        for own, x in zip(vector, X, strict=True)
    ]
    return ", ".join(f'{x}: "{sympy.expand(q - scalar.diff(x))}"' for x, q in zip(X, lorentz, strict=True))


@pytest.mark.parametrize(
    ("vector", "scalar"),
    [
        ("(y*z, x*z**2, x*y - y**3)", "x**2*y - z**3*x"),
        ("(sin(y), x**2*cos(z), x*y*z)", "cos(x*y) + z**2"),
        ("(-y*(1 + z), x, 0*x)", "0*x"),
    ],
)
def test_every_vector_potential_is_taken_in(vector: str, scalar: str) -> None:
    """The expansion's own check finds the forces again; a term more in one of them is denied."""
    forces = forces_of(sympy.sympify(vector), sympy.sympify(scalar))
    found = mbsym.loads(point(forces), (6, 11))
    assert ignorable(found)[0]
    assert found.normal_forms.taken_in
    assert not hamiltonian(point(forces.replace('x: "', 'x: "x*z*y_dot + ', 1)))


def test_a_gradient_given_as_a_force_is_a_potential() -> None:
    """Q = -dV/dx of a quartic minimum: stable, as with the potential itself."""
    given = of(point('x: "-4*x**3"', "y**2 + 2*z**2"))
    itself = of(point('x: "0*x"', "x**4 + y**2 + 2*z**2"))
    for one in (given, itself):
        assert one.conservative
        assert one.at_values is not None
        assert one.at_values.outcome is Outcome.STABLE
    assert (given.taken_in, itself.taken_in) == (True, False)


def test_a_wrong_potential_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(generalized_potential, "Fraction", lambda over, under: Fraction(over, under + 1))
    with pytest.raises(Failure, match="does not give them back"):
        of(point(MAGNETIC))
