"""Noether: symmetries that coordinates hide, each beside a system that has none; fields and integrals by hand."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from conftest import SHIPPED

import mbsym
from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import Constrained
from mbsym.algebra.kernel import independent
from mbsym.analysis import symmetric
from mbsym.analysis.pipeline import Analysis
from mbsym.analysis.symmetric import symmetries_of
from mbsym.problems.polynomial_integrals.result import FUNCTION
from mbsym.problems.symmetries.search import DEPENDENT, blocks

TOP = """
mbsym: 1
name: Lagrange's top in axes turned about the second one
parameters: {A: {sign: positive}, C: {sign: positive}, m: {sign: positive}, g: {sign: positive}, d: {sign: positive},
  b: {sign: real}}
bodies:
  - name: body
    attached to: 0
    rotation: {axes: [3, 1, 3], angles: [psi, theta, phi]}
    mass centre: [d*S, 0, d*K]
    mass: m
    inertia about: joint
    inertia: [[A*K**2 + C*S**2, 0, (C - A)*S*K], [0, A, 0], [(C - A)*S*K, 0, A*S**2 + C*K**2]]
    speeds: {p: omega1, q: omega2, r: omega3}
    orientation: {gamma: 3}
loads:
  - uniform gravity: {acceleration: g, direction: [0, 0, -1]}
"""
#: The axis of symmetry is (3, 0, 4)/5 = S e1 + K e3:  I = A (1 - n n^T) + C n n^T.
ODD = TOP.replace("S", "(3/5)").replace("K", "(4/5)")

TWO = """
mbsym: 1
name: Two bodies on lines that cross
parameters: {m1: {sign: positive}, m2: {sign: positive}, k: {sign: positive}, n: {sign: positive}}
bodies:
  - {name: one, attached to: 0, connection point: [x, 0, 0], mass: m1, coordinates: [x]}
  - {name: two, attached to: 0, connection point: [0, y, 1], mass: m2, coordinates: [y]}
loads:
"""


def found(text, **values):
    return symmetries_of(Analysis(mbsym.loads(text).system), {name: Fraction(x) for name, x in values.items()})


def told(result):
    return list(map(in_words, result.new))


def in_words(one):
    return {name: str(xi) for name, xi in one.directions}, str(one.gauge), str(one.integral)


def test_lagranges_top_in_odd_axes():
    """r of the axes of symmetry: C (3 p + 4 r)/5."""
    result = found(ODD)
    assert told(result) == [({"p": "3/4", "r": "1"}, "0", "C*(3*p + 4*r)/4")]
    assert [one.substituted for one in result.symmetries] == [Certainty.PROVED] * 3
    assert (result.complete, result.in_speeds, result.symbols) == (True, True, True)


def test_without_symmetry_it_is_denied():
    """A + C about the second axis in place of A."""
    result = found(ODD.replace("[0, A, 0]", "[0, A + C, 0]"))
    assert (result.new, result.complete) == ((), True)
    assert [one.name for one in result.symmetries] == ["angular momentum about axis 3", "generalised energy"]


def test_an_axis_at_an_angle_that_is_a_parameter():
    """sin(b) and cos(b) count as constants: to leave them out would prove that there is no axis."""
    result = found(TOP.replace("S", "sin(b)").replace("K", "cos(b)"))
    (one,) = result.new
    ring = one.integral.ring
    field = {name: xi.polynomial for name, xi in one.directions}
    sine, cosine = ring.generator("sine", "b"), ring.generator("cosine", "b")
    assert field.keys() == {"p", "r"}
    assert ring.is_zero(ring.times(field["p"], cosine) - ring.times(field["r"], sine))
    assert result.complete


def test_numbers_and_relations_are_put_in():
    top = (SHIPPED / "euler-poisson.yaml").read_text("utf-8").split("claims:")[0]
    assert told(found(top, A=2, B=2, x0=0, y0=0)) == [({"r": "1"}, "0", "C*r")]
    assert found(top, A=2, B=2, x0=0, y0=1).new == ()
    related = top.replace("values:", "relations: {B: A, x0: 0*z0, y0: 0*z0}\nvalues:").replace("B: 2, ", "")
    related = related.replace("x0: 0.5, y0: 0, z0: 0", "z0: 1/2")
    assert told(found(related)) == [({"r": "1"}, "0", "C*r")]


def test_two_oscillators_of_one_frequency():
    """m1 m2 (x y' - y x'): a rotation of a plane in which no body moves.  Problem 7 looks at bodies' momenta only."""
    result = found(TWO + "  - force function: -k*(m1*x**2 + m2*y**2)/2\n")
    assert told(result) == [({"x": "-m2*y", "y": "m1*x"}, "0", "m1*m2*(y_dot*x - x_dot*y)")]
    assert result.complete
    other = found(TWO + "  - force function: -k*(m1*x**2 + n*m2*y**2)/2\n")
    assert ([one.name for one in other.symmetries], other.complete) == (["generalised energy"], True)
    assert len(found(TWO + "  - force function: -k*(m1*x**2 + n*m2*y**2)/2\n", n=1).new) == 1


def test_a_cyclic_coordinate_in_others():
    """U = U(x - n y): the shift x -> x + n e, y -> y + e; with m1 n x' + m2 y' conserved."""
    result = found(TWO + "  - force function: -k*(x - n*y)**4\n")
    assert told(result) == [({"x": "n", "y": "1"}, "0", "m1*n*x_dot + m2*y_dot")]


def test_forces_without_a_force_function_take_part():
    """m1 x'' = n y', m2 y'' = -n x': a charge in a field, known.  m1 x'' = -n x': a body in a viscous fluid."""
    result = found(TWO + "  - generalized force: {x: n*y_dot, y: -n*x_dot}\n")
    momenta = [({"x": "1"}, "n*y", "m1*x_dot - n*y"), ({"y": "1"}, "-n*x", "m2*y_dot + n*x")]
    assert list(map(in_words, result.symmetries[:2])) == momenta
    assert [one.name for one in result.symmetries[:2]] == [
        f"momentum of {name} with the share of gyroscopic forces" for name in "xy"
    ]
    assert told(result) == []
    *_, rotation = result.symmetries
    assert rotation.name == "function of the integrals of problem 7"
    assert rotation.certainty is Certainty.VERIFIED
    damped = found(TWO + "  - damper: {coordinate: x, coefficient: n}\n  - spring: {coordinate: y, stiffness: k}\n")
    # m1 x' + n x, and (m1 x' + n x)^2/2 + m1 (m2 y'^2 + k y^2)/2, by that and the energy of the other body
    assert told(damped) == []
    assert in_words(damped.symmetries[0]) == ({"x": "1"}, "-n*x", "m1*x_dot + n*x")
    names = ["momentum of x with the impulse of forces", "function of the integrals of problem 7"]
    assert [one.name for one in damped.symmetries] == names


def test_a_helix():
    """A valley that turns at the rate n: neither energy nor momentum is conserved, but H - n (m1 (x y' - y x'))."""
    text = TWO.replace("mass: m2", "mass: m1").replace("m2: {sign: positive}, ", "")
    result = found(text + "  - force function: -k*(x*cos(n*t) + y*sin(n*t))**2/2\n")
    (one,) = result.symmetries
    ring = one.integral.ring
    assert {name: str(xi) for name, xi in one.directions} in ({"x": "n*y", "y": "-n*x"}, {"x": "-n*y", "y": "n*x"})
    x, y = (ring.generator("coordinate", name) for name in ("x", "y"))
    u, v = (ring.generator("velocity", name) for name in ("x", "y"))
    area = ring.generator("parameter", "m1") * ring.generator("parameter", "n") * (x * v - y * u)
    sign = 1 if str(one.time) == "1" else -1
    assert ring.velocity_derivative(one.integral.polynomial * sign + area, "x") == ring.generator("parameter", "m1") * u
    assert not result.complete  # states in which sines of t are rational are not tried: nothing is proved of others


def test_what_depends_on_problem_7_is_called_so():
    """A free particle on a plane: x y' - y x' is a function of its two momenta only with the place; it is new there."""
    text = TWO.replace("mass: m2", "mass: m1").replace("m2: {sign: positive}, ", "")
    result = found(text.replace("loads:", ""))
    names = {one.name for one in result.symmetries}
    assert names >= {"momentum of x", "momentum of y"}
    assert all(one.name in (FUNCTION, DEPENDENT) or one.certainty is Certainty.PROVED for one in result.symmetries)


def test_norms_are_no_symmetries():
    result = symmetries_of(Analysis(mbsym.load(SHIPPED / "gravity-gradient-quaternion.yaml").system))
    assert [one.name for one in result.symmetries] == ["generalised energy"]
    assert result.complete


def test_a_mistake_in_the_equations_is_found_by_the_second_route(monkeypatch):
    """The torque about the third axis left out: q of the condition would be conserved, dI/dt is not zero."""
    text = ODD.replace("[0, A, 0]", "[0, A + C, 0]")

    def wrong(*derived):
        right = blocks(*derived)
        return replace(right, rates=(*right.rates[:2], right.ring.zero))

    monkeypatch.setattr(symmetric, "blocks", wrong)
    result = found(text)
    assert {name for one in result.symmetries for name, _ in one.directions} & {"r"} == set()
    assert not result.complete


def test_constraints_are_refused():
    with pytest.raises(Constrained):
        symmetries_of(Analysis(mbsym.load(SHIPPED / "rolling-disc.yaml").system))


def test_roots_are_told_apart_by_their_radicands():
    """sqrt(m1 x^2 + m2 y^2) beside sqrt(x^2 + y^2): two roots whose product is none; sqrt(x^2) would be |x|."""
    one = found(TWO + "  - force function: -k*sqrt(m1*x**2 + m2*y**2)\n")
    assert (one.complete, one.compared) == (True, True)
    assert [str(x.integral) for x in one.symmetries if not x.name] == ["m1*m2*(y_dot*x - x_dot*y)"]
    two = found(TWO + "  - force function: -k*sqrt(m1*x**2 + m2*y**2) - n*sqrt(x**2 + y**2)\n")
    assert ([x.name for x in two.symmetries], two.complete) == (["generalised energy"], True)
    ring = Analysis(mbsym.loads(TWO.replace("loads:", "")).system).ring
    x, y = (ring.generator("coordinate", name) for name in "xy")
    square = (x + y) ** 2 + 1
    roots = [ring.square_root(square), ring.square_root(square * (x * x + 1)), ring.square_root(x * x + 1)]
    assert independent(ring, roots[:2])
    assert not independent(ring, [ring.context.gen(0), *roots])  # the second may be the product of the others


TODA = (
    TWO
    + """  - potential: "POTENTIAL"
"""
)


@pytest.mark.parametrize(
    ("potential", "moved"),
    [
        ("exp(k*(x - y))", {"x": "1", "y": "1"}),  # both go together
        ("exp(k*x + n*y) + exp(-k*x - n*y)", {"x": "-n", "y": "k"}),
        ("exp(x - y) + exp(2*y - 2*x) + (x - y)**4", {"x": "1", "y": "1"}),
        ("exp(x - y) + exp(y)", None),
        ("exp(k*x) + exp(k*y) + exp(-k*x - k*y)", None),  # the product of all three is 1
    ],
)
def test_what_exponentials_leave(potential, moved):
    """The momentum along what no exponent changes with; with two exponents none.  All of it proved, by ranks."""
    result = found(TODA.replace("POTENTIAL", potential))
    assert result.complete
    assert not result.compared
    energy, *others = result.symmetries
    assert (energy.time.is_zero, energy.certainty) == (False, Certainty.PROVED)
    assert [{name: str(xi) for name, xi in one.directions} for one in others] == ([moved] if moved else [])
    assert all(one.is_new for one in others)


def test_roots_of_cosines_are_independent_but_of_half_angles():
    """1 - cos x = 2 sin(x/2)^2 is a square; 3 - cos x is none, nor are two of such with each other."""
    ring = mbsym.loads(TODA.replace("POTENTIAL", "cos(x) + cos(y)")).ring
    x, y = (ring.generator("cosine", name) for name in "xy")
    roots = [ring.square_root(one) for one in (3 - x, 3 - y, (3 - x) * (3 - y), 1 - x)]
    assert independent(ring, roots[:2])
    assert not independent(ring, roots[:3])
    assert not independent(ring, roots[3:])
    assert not independent(ring, [ring.square_root(3 - ring.generator("sine", "x"))])  # undecided, and told so
