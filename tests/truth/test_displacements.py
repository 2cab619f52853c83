"""What must not change a verdict: the coordinates in which a symmetry of the system is told.

Two masses m on a ring of radius R, at the angles A and B, may shift along it together: L and the forces know A - B
alone.  In the angles themselves, in one of them and the difference, in any linear combinations that is the same motion.
"""

from __future__ import annotations

import pytest
from conftest import STATEMENTS

import mbsym
from mbsym.analysis import Analysis
from mbsym.problems.displacements import Displacements
from mbsym.problems.dissipation import Balance
from mbsym.problems.stability.words import Because, Word

#: Angles of the two masses in two coordinates; regular each.
COORDINATES = (("a", "b"), ("a", "a + b"), ("2*a - b", "b + a/3"), ("b - a", "b + a"))


def ring(angles: tuple[str, str], loads: str, motion: str = "{}") -> Analysis:
    """Two masses on a ring; A, B in the loads are their angles, A', B' the rates of these."""
    one, two = angles
    rates = [angle.replace("a", "a_dot").replace("b", "b_dot") for angle in angles]
    for name, value in (("A'", rates[0]), ("B'", rates[1]), ("A", one), ("B", two)):
        loads = loads.replace(name, f"({value})")
    first = [name for name in "ab" if name in one]
    second = [name for name in "ab" if name not in first]
    return mbsym.loads(f"""
mbsym: 1
name: Two masses on a ring
parameters: {{m: {{positive: true, value: 2}}, R: {{positive: true, value: 3}}, k: {{positive: true, value: 5}},
  d: {{positive: true, value: 1/7}}}}
bodies:
  - {{name: one, attached to: 0, rotation: {{axes: [3], angles: ['{one}']}}, coordinates: [{", ".join(first)}],
     mass centre: [R, 0, 0], mass: m}}
  - {{name: two, attached to: 0, rotation: {{axes: [3], angles: ['{two}']}}, coordinates: [{", ".join(second)}],
     mass centre: [R, 0, 0], mass: m}}
loads: [{loads}]
motion: {motion}
""")


#: The word, derived by hand: with s = (A + B)/2, u = A - B the equations are  2 m R^2 s'' = F_A + F_B  and
#: m R^2 u''/2 = (F_A - F_B)/2.
TRUTH = {
    # s'' = 0, u'' + 4 k u/(m R^2) ... = 0: s drifts, the energy of u has a strict minimum
    "potential: k*(A - B)**2/2": Word.STABLE_BUT_CYCLIC,
    # a damper between them: u decays, s keeps its velocity
    "potential: k*(A - B)**2/2}, {rayleigh: d*(A' - B')**2/2": Word.ASYMPTOTIC_BUT_CYCLIC,
    # friction on the ring, on one or both: one zero root, s; the others satisfy Hurwitz's conditions (a damped
    # coordinate is felt by both modes)
    "potential: k*(A - B)**2/2}, {rayleigh: d*A'**2/2": Word.ASYMPTOTIC_BUT_CYCLIC,
    "potential: k*(A - B)**2/2}, {rayleigh: d*A'**2/2 + 3*d*B'**2/2": Word.ASYMPTOTIC_BUT_CYCLIC,
    # no spring: both angles are cyclic.  The damper between them takes u' away, friction on one mass its velocity
    "rayleigh: d*(A' - B')**2/2": Word.ASYMPTOTIC_BUT_CYCLIC,
    "rayleigh: d*A'**2/2": Word.ASYMPTOTIC_BUT_CYCLIC,
    # a damper of third order between them takes energy, nothing from the momentum
    "potential: k*(A - B)**2/2}, {rayleigh: d*(A' - B')**4/4": Word.STABLE_BUT_CYCLIC,
    # ... on one of them it acts on the momentum, too; the energy has a minimum in u and all velocities all the same
    "potential: k*(A - B)**2/2}, {rayleigh: d*A'**4/4": Word.STABLE_BUT_CYCLIC,
    # ... if it puts energy in, no theorem that is tried says anything
    "potential: k*(A - B)**2/2}, {rayleigh: -d*A'**4/4": Word.UNDECIDED,
    # a maximum of the potential energy along u
    "potential: -k*(A - B)**2/2": Word.UNSTABLE,
    # a belt: R A - 2 B is what stretches
    "potential: k*(R*A - 2*B)**2/2": Word.STABLE_BUT_CYCLIC,
}


@pytest.mark.parametrize("loads", TRUTH)
@pytest.mark.parametrize("angles", COORDINATES)
def test_a_symmetry_counts_in_every_coordinates(angles: tuple[str, str], loads: str) -> None:
    found = ring(angles, f"{{{loads}}}").stability
    assert found.numerical is not None
    assert (found.verdict.word, found.numerical.word) == (TRUTH[loads], TRUTH[loads])


def test_two_masses_on_a_hoop_drift_together() -> None:
    """Opposite each other between two springs along the ring: u = pi is a minimum, both may move on together.

    The sentence says so in the coordinates of the description.
    """
    found = mbsym.load(STATEMENTS / "two-masses-on-hoop-undecided.yaml").stability
    assert found.verdict.word is Word.STABLE_BUT_CYCLIC
    assert found.verdict.theorem == "Routh"
    assert found.verdict.because(Because.DISPLACEMENTS)
    assert "(a, b) = (1, 1)" in found.verdict.explanation


def test_directions_with_parameters_in_them() -> None:
    """A belt over wheels of radii R and 2: R A = 2 B + const shifts along (A, B) = (2, R)."""
    found = ring(("a", "b"), "{potential: k*(R*A - 2*B)**2/2}").stability
    assert "(a, b) = (2, R)" in found.verdict.explanation


def test_a_direction_that_is_none_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    """A direction along which K does not vanish is not taken, whoever claims it."""

    def wrong(self: Balance, coordinates: tuple[str, ...]) -> Displacements:
        one = self.scene.ring.one
        return Displacements(tuple(coordinates), ((one, one * 2),), 1)

    monkeypatch.setattr(Balance, "displacements", wrong)
    assert ring(("a", "b"), "{potential: -k*cos(A - B)}").stability.verdict.word is Word.UNDECIDED


def test_a_cylinder_in_a_cylinder_drifts_with_constraints_and_without() -> None:
    """Outer cylinder on a plane, inner one in it, both rolling; by hand in p1 and th, or with rolling constraints.

    With c = r1 - r2, u = r1 p1', w = u - c th':  2 T = M1 u^2 + M2 w^2 near th = 0, M1 = (1 + k1) m1, M2 = (1 + k2) m2.
    Neither T nor V knows p1: M1 u + M2 w is constant, and what remains is  M1 M2 c^2 th'^2/(M1 + M2) = 2 T_R  with
    2 V = m2 g c th^2: a minimum for r1 > r2, frequency^2 = m2 g (M1 + M2)/(M1 M2 c), here 9.81 5.5/(6 0.75) = 11.99.
    """
    for name in ("rolling-cylinders-higher-order-decide", "same-by-hand-decided"):
        found = mbsym.load(STATEMENTS / f"{name}.yaml").stability
        assert found.numerical is not None
        assert (found.numerical.word, found.numerical.theorem) == (Word.STABLE_BUT_CYCLIC, "Routh")
        assert found.verdict.word is Word.DEPENDS  # on the sign of r1 - r2
        (spectrum,) = found.spectra
        sizes = sorted(abs(complex(root.ball)) ** 2 for root in spectrum.roots)
        assert sizes == pytest.approx([0, 11.99, 11.99])
