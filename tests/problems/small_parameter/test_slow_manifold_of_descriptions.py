"""Slow manifolds of descriptions: relations between parameters, signs, what is divided by, assumptions in eps."""

from __future__ import annotations

import pytest
from terminal import told as lines

import mbsym
from mbsym.algebra.failures import NoClosedForm
from mbsym.analysis.expanding import expansion
from mbsym.problems.small_parameter.result import Outcome
from mbsym.report.content import Name, Raised
from mbsym.report.words.expansion_words import coefficients
from mbsym.simulation.expanded import measured

#: eps x'' + c x' + k (x - y) = 0, y' is a speed, y'' = -a y - k (y - x): a light body on a spring, with friction.
LIGHT = """
mbsym: 1
name: A light body on a heavy one
parameters: {{m: positive, M: positive, c: {c}, k: {k}, a: positive, b: positive}}
{relations}
small parameter: {small}
bodies:
  - {{name: heavy, attached to: 0, coordinates: [y], connection point: [y, 0, 0], mass: M, speeds: {{v: y_dot}}}}
  - {{name: light, attached to: 0, coordinates: [x], connection point: [x, 0, 0], mass: m, speeds: {{u: x_dot}}}}
loads:
  - force function: -k*(x - y)**2/2 - a*y**2/2
  - damper: {{coordinate: x, coefficient: c}}
motion: {{x: 0, y: 0}}
{more}
"""


def light(small="m", relations="", c="positive", k="positive", more=""):
    return mbsym.loads(LIGHT.format(small=small, relations=relations, c=c, k=k, more=more))


def told(one, found):
    return {n: str(found.formula(c)) for n, c in one.coefficients.items()}


def test_a_light_body_by_hand():
    """m u' = -c u - k (x - y) with m -> 0: u = -(k/c)(x - y) + O(m), the body creeps; x stays slow."""
    found = expansion(light(), 1)
    assert found.manifold.fast == ("u",)
    assert told(found.manifold.functions[0], found)[0] in ("k*(y - x)/c", "-k*(x - y)/c")
    # u_1 = -(1/c) du_0/dt = (k/c^2)(u_0 - v)
    assert found.fast == (Outcome.HOLDS, ())
    assert found.provided == ()
    assert found.manifold.residuals == (2,)


def test_what_is_divided_by_is_told_where_it_may_be_zero():
    found = expansion(light(c="nonnegative"), 1)
    assert [str(x) for x in found.provided] == ["c"]
    assert found.fast[0] is Outcome.CONDITIONAL


def test_relations_are_put_in_before_powers_are_counted():
    """k = b c: the same system as with b c in the place of k."""
    found = expansion(light(relations="relations: {k: b*c}"), 1)
    assert told(found.manifold.functions[0], found)[0] in ("b*(y - x)", "-b*(x - y)")


def test_a_parameter_that_follows_a_scaled_one_is_scaled_with_it():
    """M = b m: both are light; at m = 0 y = k x/(k + a) and c x' = -k (x - y)."""
    found = expansion(light(relations="relations: {M: b*m}"), 1)
    first = {name: told(one, found)[0] for name, one in zip(found.manifold.fast, found.manifold.functions, strict=True)}
    assert first == {"u": "-k*a*x/(c*(k + a))", "v": "-k**2*a*x/(c*(k + a)**2)", "y": "k*x/(k + a)"}


@pytest.mark.parametrize("small", ["m", "{mu: {powers: {m: 1}}}"])
def test_a_relation_that_ties_the_small_parameter_is_refused_by_name(small):
    with pytest.raises(NoClosedForm, match="m is given by a relation"):
        expansion(light(small, relations="relations: {m: b*M}"), 1)


def test_assumptions_in_the_small_parameter_decide_nothing():
    """c > 3 m says nothing of c as m tends to zero, however large m is said to be."""
    found = expansion(light(c="real", more="assumptions: [c > 3*m]"), 1)
    assert found.fast[0] is Outcome.CONDITIONAL
    assert expansion(light(c="real", more="assumptions: [c > 3*k]"), 1).fast == (Outcome.HOLDS, ())


CREEPING = """
mbsym: 1
name: A light body in a fluid
parameters: {m: positive, c: positive, b: positive, k: positive}
small parameter: SMALL
bodies:
  - {name: light, attached to: 0, coordinates: [x], connection point: [x, 0, 0], mass: m, speeds: {u: x_dot}}
loads:
  - force function: -k*x**2/2
  - generalized force: {x: FORCE}
motion: {x: 0}
"""


@pytest.mark.parametrize(("small", "force"), [("m", "-c*x_dot - b*x_dot**3"), ("{m: {fast: [u, x]}}", "-c*x_dot")])
def test_a_variable_whose_root_stays_bounded_is_not_called_fast(small, force):
    """m s^2 + c s + k = 0: s = -c/m + ... and s = -k/c + ..., so that x creeps: x = u = 0 is no slow manifold.

    There is one all the same, u = -k x/c + ... of u alone, and nothing denies it.
    """
    with pytest.raises(NoClosedForm, match=r"^not all of .* are fast.*one stays bounded as m tends to 0"):
        expansion(mbsym.loads(CREEPING.replace("SMALL", small).replace("FORCE", force)), 2)


def test_two_roots_that_both_grow_are_fast():
    """m s^2 + k = 0: s = +-i sqrt(k/m), both grow; u = x = 0 is all that is slow."""
    found = expansion(mbsym.loads(CREEPING.replace("SMALL", "m").replace("FORCE", "-b*x_dot**3")), 2)
    assert found.manifold.fast == ("u", "x")
    assert found.fast[0] is Outcome.UNDECIDED


HONEY = """
mbsym: 1
name: a light particle in honey
parameters: {eps: positive, k: positive}
small parameter: eps
bodies:
  - {name: one, attached to: 0, connection point: [x, 0, 0], mass: eps, coordinates: [x]}
loads:
  - generalized force: {x: -x_dot - k*x - x**3}
motion: {x: 0}
values: {eps: 1/100, k: 1}
initial: {x: 1}
"""


def test_equations_in_coordinates_are_expanded():
    """eps x'' = -x' - g, g = k x + x^3: x' = -g - eps g' g - ..., by hand eps d(-g)/dt = eps g' g = -h_1."""
    analysis = mbsym.loads(HONEY)
    found = expansion(analysis, 2)
    assert (found.manifold.fast, tuple(found.manifold.slow)) == (("x_dot",), ("x",))
    ring = analysis.ring
    x, k = ring.generator("coordinate", "x"), ring.generator("parameter", "k")
    g, slope = k * x + x**3, k + 3 * x**2
    h = [found.formula(found.manifold.functions[0].coefficients[n]).polynomial for n in (0, 1)]
    assert h == [-g, -slope * g]
    assert found.fast[0] is found.slow[0] is Outcome.HOLDS
    assert [one.equation.parts[0] for one in coefficients(found)] == [Raised(Name("x", 1), n) for n in (0, 1, 2)]
    by_run = measured(analysis.system, found)  # against the whole equations at eps, eps/2, eps/4
    assert all(abs(order - 3) < 0.2 for order in by_run.orders)


def test_what_stands_under_a_sine_is_refused():
    joint = "rotation: {axes: [3, 0, 0], angles: [x, 0, 0]}, mass: 0, inertia about: joint, inertia: [0, 0, eps]"
    text = HONEY.replace("connection point: [x, 0, 0], mass: eps", joint).replace("x**3", "sin(x)")
    with pytest.raises(NoClosedForm, match=r"sin\(x\), cos\(x\) are variables"):
        expansion(mbsym.loads(text), 1)


def test_that_a_rate_is_itself_is_not_told():
    """eps = 0: x' = 0; y'' = -y - x is told, and no  y' = y'."""
    text = """
mbsym: 1
name: a point with a strong damper along x
parameters: {eps: positive}
small parameter: eps
bodies:
  - {name: a, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: 0}
  - {name: b, attached to: a, connection point: [0, y, 0], coordinates: [y], mass: 1}
loads:
  - potential: (x + y)**2/2
  - generalized force: {x: -x_dot/eps}
"""
    said = lines(mbsym.loads(text), 12)
    assert any(line.endswith("y''(0) = -x - y") for line in said), said
    assert not any("y'(0)" in line for line in said)


DISC = """
mbsym: 1
name: A turning disc with a light body in a slot
parameters: {J: positive, m: positive, c: positive, k: positive, w: real}
small parameter: m
bodies:
  - {name: disc, attached to: 0, rotation: {axes: [3], angles: [phi]}, mass: 0, inertia about: joint,
     inertia: [1, 1, J], speeds: {r: omega3}}
  - {name: light, attached to: disc, coordinates: [x], connection point: [x, 0, 0], mass: m, speeds: {u: x_dot}}
loads:
  - spring: {coordinate: x, stiffness: k}
  - damper: {coordinate: x, coefficient: c}
motion: {phi: {rate: w}, x: 0}
"""


def test_nothing_that_cancels_is_left():
    """m (u' - r^2 x) = -c u - k x, r' = O(m): u_1 = (r^2 x - u_0')/c with u_0 = -k x/c, u_0' = k^2 x/c^2."""
    found = expansion(mbsym.loads(DISC), 1)
    assert told(found.manifold.functions[0], found)[1] in ("r**2*x/c - k**2*x/c**3", "-k**2*x/c**3 + r**2*x/c")


@pytest.mark.parametrize(
    ("sign", "outcome"),
    [("c: positive", Outcome.HOLDS), ("c: negative", Outcome.FAILS), ("c: real", Outcome.CONDITIONAL)],
)
def test_a_disc_turns_at_any_rate_while_the_body_in_its_slot_is_damped(sign, outcome):
    """It tends to x = 0, and the disc to a rate near by; where friction drives the body it does not."""
    found = expansion(mbsym.loads(DISC.replace("c: positive", sign)), 1)
    assert (found.manifold.steady.free, found.stabilizable[0]) == (("r",), outcome)
