"""Integrals in two unit vectors of one body: Jacobi's of a satellite, Bogoyavlensky's of bodies in two fields.

O. I. Bogoyavlensky, Euler equations on finite-dimensional Lie algebras arising in physical problems, Commun. Math.
Phys. 95 (1984): a body with A = B = 2 C in two uniform fields has an integral of degree four in p, q, r. That with
potentials of Clebsch's kind in two fields has a further one of degree two is derived by hand below.
"""

from __future__ import annotations

from fractions import Fraction

from conftest import SHIPPED
from flint import Ordering, fmpq_mpoly_ctx

import mbsym
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.analysis import polynomial
from mbsym.problems.polynomial_integrals.gradings import grading
from mbsym.problems.polynomial_integrals.search import polynomial_integrals
from mbsym.report.words.integrals_words import sentences

BODY = """mbsym: 1
name: Body in two fields
parameters: {A: {sign: positive}, B: {sign: positive}, C: {sign: positive}, k: {sign: positive}, n: {sign: positive}}
bodies:
  - name: body
    attached to: 0
    rotation: {axes: [3, 1, 3], angles: [psi, theta, phi]}
    mass: 0
    inertia about: joint
    inertia: {tensor: [A, B, C], accept: true}
    speeds: {p: omega1, q: omega2, r: omega3}
    orientation: {beta: 2, gamma: 3}
loads:
  - potential: POTENTIAL
"""
CLEBSCH = "(k*(A*gamma1**2 + B*gamma2**2 + C*gamma3**2) + n*(A*beta1**2 + B*beta2**2 + C*beta3**2))/2"


def found_in(text, numbers, degree):
    there = polynomial.setting(mbsym.loads(text), {name: Fraction(x) for name, x in numbers.items()})
    return there, polynomial.integrals_of(there, degree)


def test_jacobis_integral_of_a_satellite_is_no_further_one():
    """b along the radius, c against the normal: that of problem 7, with a third vector's length, and no other."""
    text = (SHIPPED / "gravity-gradient-quaternion.yaml").read_text(encoding="utf-8").split("# b is the outward")[0]
    there, found = found_in(text.replace("{e: quaternion}", "{b: 2, c: 3}"), {}, 3)
    assert there.field.variables == ("p", "q", "r", "b1", "b2", "b3", "c1", "c2", "c3")
    names = ["length of b", "product of b and c", "length of c", "generalised energy"]
    assert [one.name.split(",")[0] for one in found.generators] == names
    assert found.complete
    assert found.grading.frames
    told = [one.text for one in sentences(found)]
    assert "Lengths of unit vectors and products of two of them are the same in every motion: 1 and 0." in told


def test_clebschs_potential_in_two_fields():
    """A^2 p^2 + ... - sum of k (B C gamma1^2 + ...): by hand, as for one field, since that is linear in k."""
    numbers = {"A": 2, "B": 3, "C": 4, "k": 1, "n": 3}
    there, found = found_in(BODY.replace("POTENTIAL", CLEBSCH), numbers, 4)
    assert [one.weight for one in found.new] == [2, 4]
    assert (found.complete, found.independent) == (True, 6)
    p, q, r, b1, b2, b3, g1, g2, g3 = there.field.context.gens()
    by_hand = 4 * p**2 + 9 * q**2 + 16 * r**2
    for weight, x, y, z in ((1, g1, g2, g3), (3, b1, b2, b3)):
        by_hand -= weight * (12 * x**2 + 8 * y**2 + 6 * z**2)
    assert there.field.derivative(by_hand) == 0
    assert there.field.derivative(by_hand + p**2) != 0
    # Along a trajectory in floating point: Runge's and Kutta's steps with what was found of degree four.
    (f,) = [one.polynomial for one in found.new if one.weight == 4]
    x = [0.3, -0.2, 0.5, 0.0, 0.6, 0.8, 1.0, 0.0, 0.0]
    before, after = _value(f, x), _value(f, _moved(there.field, x, 400, 5e-3))
    assert abs(after - before) < 1e-8 * max(1.0, abs(before))


def _value(f, x):
    total = 0.0
    for m, c in f.to_dict().items():
        term = int(c.p) / int(c.q)
        for a, power in zip(x, m, strict=True):
            term *= a ** int(power)
        total += term
    return total


def _moved(field, x, steps, h):
    def slope(at):
        bottom = _value(field.denominator, at)
        return [_value(p, at) / bottom for p in field.numerators]

    def shifted(k, by):
        return [a + by * b for a, b in zip(x, k, strict=True)]

    for _ in range(steps):
        a = slope(x)
        b = slope(shifted(a, h / 2))
        c = slope(shifted(b, h / 2))
        d = slope(shifted(c, h))
        x = [y + h / 6 * (i + 2 * j + 2 * k + n) for y, i, j, k, n in zip(x, a, b, c, d, strict=True)]
    return x


def test_kovalevskayas_top_in_two_fields():
    """p^2 - q^2 - ..., 2 p q - ...: the sum of two squares, found but for lengths and products; elsewhere none."""
    text = BODY.replace("POTENTIAL", "k*gamma1 + n*beta2")
    _, found = found_in(text, {"A": 2, "B": 2, "C": 1, "k": 1, "n": 3}, 4)
    assert [one.weight for one in found.new] == [4]
    assert found.complete
    _, other = found_in(text, {"A": 3, "B": 2, "C": 1, "k": 1, "n": 3}, 4)
    assert (other.new, other.complete) == ((), True)


def test_what_holds_for_perpendicular_vectors_alone_is_not_denied():
    """x' = (b, c) keeps x where b and c are perpendicular; for other vectors it does not, and it is not found."""
    context = fmpq_mpoly_ctx.get(["x", "b1", "b2", "b3", "c1", "c2", "c3"], Ordering.lex)
    x, *vectors = context.gens()
    b, c = vectors[:3], vectors[3:]
    product = sum((u * v for u, v in zip(b, c, strict=True)), 0 * x)
    norms = [sum((u * u for u in one), 0 * x) - 1 for one in (b, c)]
    kinds = (("x",), ("b1", "b2", "b3"), ("c1", "c2", "c3"))
    zero = 0 * x
    field = PolynomialField(
        context,
        (),
        tuple(context.names()),
        (product, *([zero] * 6)),
        context.constant(1),
        (norms[0], product, norms[1]),
    )
    found = polynomial_integrals(field, grading(field, kinds), 1)
    assert found.grading.frames
    assert "x" not in [str(one.polynomial) for one in found.generators]
    assert not found.complete
    # With a sum that no unit vectors make zero there is none, and that is proved.
    other = PolynomialField(
        context,
        (),
        tuple(context.names()),
        (b[0] * c[0] + 2 * b[1] * c[1], *([zero] * 6)),
        context.constant(1),
        (norms[0], product, norms[1]),
    )
    assert polynomial_integrals(other, grading(other, kinds), 1).complete
