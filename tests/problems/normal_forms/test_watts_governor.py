"""Watt's governor with its engine: a coordinate on which nothing depends, though a torque drives it, is left out.

    x'' = psi'^2 sin x cos x - sin x - eps x',   psi'' = alpha (cos x - beta),   cos x0 = beta, psi'0 = beta^(-1/2)

det(lambda - A) = lambda^3 + eps lambda^2 + (1 - beta^2)/beta lambda + 2 alpha sqrt(beta) (1 - beta^2), so that the
border is eps = 2 alpha beta^(3/2) (I. A. Vyshnegradskii, 1876) and there w^2 = (1 - beta^2)/beta.  On it Lyapunov's
first coefficient is, with the eigenvector whose first component has the modulus 1,

    l1 = -alpha beta^(3/2) (1 - beta^2) G / (2 (1 - beta^2 + alpha^2 beta^4) (1 - beta^2 + 4 alpha^2 beta^4)),
    G = 3 + (alpha^2 - 5) beta^2 + alpha^4 beta^6

(J. Sotomayor, L. F. Mello and D. de C. Braga, Bifurcation analysis of the Watt governor system, Comput. Appl. Math. 26
(2007) 19-44, theorem 3.2); x = 2 |z|, so that r' = l1/4 r^3 for the amplitude r of x.
"""

from __future__ import annotations

from fractions import Fraction

import pytest

import mbsym
from mbsym.analysis.higher import judge
from mbsym.problems.normal_forms.result import Outcome, Theorem

WATT = """
mbsym: 1
name: Watt's governor with its engine
parameters: {alpha: positive, beta: positive, eps: positive}
assumptions: [beta < 1]
bodies:
  - {name: arms, attached to: 0, rotation: {axes: [1, 0, 0], angles: [x, 0, 0]}, mass: 0, inertia about: joint,
     inertia: [1, 0, 0]}
  - {name: wheel, attached to: 0, rotation: {axes: [3, 0, 0], angles: [psi, 0, 0]}, mass: 0, inertia about: joint,
     inertia: [0, 0, 1]}
loads:
  - generalized force: {x: psi_dot**2*sin(x)*cos(x) - sin(x) - eps*x_dot, psi: alpha*(cos(x) - beta)}
motion: {x: atan(sqrt(1 - beta**2)/beta), psi: {rate: 1/sqrt(beta)}}
"""


@pytest.fixture(scope="module")
def at():
    return judge(mbsym.loads(WATT))


@pytest.mark.parametrize(
    ("alpha", "root"),
    [(Fraction(1), Fraction(4, 5)), (Fraction(1, 2), Fraction(3, 5)), (Fraction(3, 10), Fraction(19, 20))],
)
def test_lyapunovs_coefficient_on_vyshnegradskiis_border(at, alpha, root):
    beta = root**2
    found = at({"alpha": alpha, "beta": beta, "eps": 2 * alpha * root**3})
    G = 3 + (alpha**2 - 5) * beta**2 + alpha**4 * beta**6
    below = (1 - beta**2 + alpha**2 * beta**4) * (1 - beta**2 + 4 * alpha**2 * beta**4)
    l1 = -alpha * root**3 * (1 - beta**2) * G / (2 * below)
    assert found.theorem is Theorem.REDUCTION
    assert float(found.coefficient) == pytest.approx(float(l1 / 4), rel=1e-12)
    assert float(found.frequencies[0]) == pytest.approx(float((1 - beta**2) / beta) ** 0.5, rel=1e-12)
    # Soft where G > 0, hard where the engine is weak and the balls fly low: 0.3 and 0.9025.
    assert found.outcome is (Outcome.ASYMPTOTIC if G > 0 else Outcome.UNSTABLE)
    assert (G > 0) is (root < Fraction(9, 10))


def test_beside_the_border_the_first_approximation_decides(at):
    for eps, outcome in ((Fraction(103, 100), Outcome.ASYMPTOTIC), (Fraction(102, 100), Outcome.UNSTABLE)):  # 1.024
        found = at({"alpha": Fraction(1), "beta": Fraction(16, 25), "eps": eps})
        assert (found.outcome, found.theorem) == (outcome, Theorem.FIRST)


def test_it_is_told_what_is_left_out():
    analysis = mbsym.loads(WATT + "values: {alpha: 1, beta: 16/25, eps: 128/125}\n")
    assert (analysis.normal_forms.cyclic, analysis.normal_forms.at_values.outcome) == (("psi",), Outcome.ASYMPTOTIC)
