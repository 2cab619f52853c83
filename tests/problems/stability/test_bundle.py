"""Combinations of first integrals: sleeping tops, free bodies, rotors, as in the literature; and where they say no."""

from __future__ import annotations

from fractions import Fraction
from itertools import permutations

import pytest
from conftest import SHIPPED, at_values
from flint import arb, fmpq, fmpq_poly

import mbsym
from mbsym.mechanics.rest import given_values
from mbsym.problems.relative_equilibria.equilibria import equilibria
from mbsym.problems.stability.bundle import NumberField, definite_combination
from mbsym.problems.stability.problem import Stability
from mbsym.problems.stability.verdict import Verdict
from mbsym.problems.stability.words import Word

RATIONALS = NumberField(fmpq_poly([0, 1]), lambda element: arb(element[0]))
INTEGRALS = "Chetaev's combination of integrals"


def constants(*rows: list[Fraction | int]) -> list[list[fmpq_poly]]:
    return [[fmpq_poly([fmpq(Fraction(x).numerator, Fraction(x).denominator)]) for x in row] for row in rows]


def diagonal(*numbers: Fraction | int) -> list[list[fmpq_poly]]:
    n = len(numbers)
    return constants(*([numbers[i] if i == j else 0 for j in range(n)] for i in range(n)))


# --- the kernel ------------------------------------------------------------------------------------------------------


def spin_is_decided(moments: tuple[int, int, int]) -> bool:
    """A free body's spin about its third axis, by T and the square of the angular momentum as functions of omega."""
    gradients = constants([0, 0, moments[2]], [0, 0, 2 * moments[2] ** 2])
    hessians = [diagonal(*moments), diagonal(*(2 * x * x for x in moments))]
    return definite_combination(gradients, hessians, RATIONALS) is not None


def test_a_free_body_spins_stably_about_its_largest_and_smallest_axis_only() -> None:
    for moments in permutations((2, 3, 4)):
        assert spin_is_decided(moments) == (moments[2] != 3)
    assert not spin_is_decided((3, 4, 3)), "about an axis across the axis of symmetry it creeps away"
    assert spin_is_decided((3, 3, 4))
    assert spin_is_decided((4, 4, 3))


def test_a_lone_integral_has_to_be_stationary_and_definite() -> None:
    assert definite_combination(constants([0, 0]), [diagonal(2, 5)], RATIONALS) is not None
    assert definite_combination(constants([0, 0]), [diagonal(-2, -5)], RATIONALS) is not None, "a maximum is as good"
    assert definite_combination(constants([0, 0]), [diagonal(2, -5)], RATIONALS) is None
    assert definite_combination(constants([0, 0]), [diagonal(2, 0)], RATIONALS) is None, "a border"
    assert definite_combination(constants([1, 0]), [diagonal(2, 5)], RATIONALS) is None, "no equilibrium"


def test_indefinite_forms_with_a_narrow_cone_of_definite_combinations() -> None:
    """diag(1, -1) + x diag(-1, 1 + e) is positive definite for 1/(1 + e) < x < 1 only."""
    first, zero = diagonal(1, -1), constants([0, 0], [0, 0])
    for e in (Fraction(1, 10), Fraction(1, 10**6)):
        assert definite_combination(zero, [first, diagonal(-1, 1 + e)], RATIONALS) is not None
    assert definite_combination(zero, [first, diagonal(-1, 1)], RATIONALS) is None
    assert definite_combination(zero, [first, diagonal(-1, Fraction(9, 10))], RATIONALS) is not None, "the other sign"
    three = constants([0, 0, 0], [0, 0, 0], [0, 0, 0])
    forms = [diagonal(1, -1, 0), diagonal(0, 1, -1), diagonal(-1, 0, Fraction(11, 10))]
    assert definite_combination(three, forms, RATIONALS) is not None
    assert definite_combination(three, [*forms[:2], diagonal(-1, 0, 1)], RATIONALS) is None


def test_in_a_number_field_the_first_variation_vanishes_exactly() -> None:
    """dI_1 = (1, 0), dI_2 = (sqrt 2, 0): I_1 sqrt 2 - I_2 is stationary, which no enclosure could show."""
    field = NumberField(fmpq_poly([-2, 0, 1]), lambda x: arb(2).sqrt() * x[1] + x[0])
    one, zero, root = fmpq_poly([1]), fmpq_poly([0]), fmpq_poly([0, 1])
    forms = [[[zero, zero], [zero, one]], [[zero, zero], [zero, zero]]]
    assert definite_combination([[one, zero], [root, zero]], forms, field) is not None
    assert definite_combination([[one, one], [root, zero]], forms, field) is not None, "both variables are fixed"
    assert definite_combination([[one, zero]], forms[:1], field) is None


# --- sleeping tops ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("A", "C", "Omega", "sleeps"),
    [("1", "1", "5", True), ("1", "1", "2001/1000", True), ("1", "1", "1999/1000", False), ("4", "1", "3", False)],
)
def test_a_top_sleeps_above_the_border(A: str, C: str, Omega: str, sleeps: bool) -> None:
    """Maievskii: C^2 Omega^2 > 4 A m g l, with m = g = l = 1."""
    a = at_values(SHIPPED / "heavy-top.yaml", A=A, C=C, Omega=Omega, m=1, g=1, l=1)
    verdict = a.stability.numerical
    assert verdict is not None
    assert verdict.word is (Word.STABLE_BUT_CYCLIC if sleeps else Word.UNSTABLE)
    assert (verdict.theorem == INTEGRALS) is sleeps
    found = equilibria(a.system, given_values(a.system, {}))
    assert verdict in {one.verdict for one in found.equilibria}


def test_on_the_border_of_sleep_nothing_is_claimed() -> None:
    verdict = at_values(SHIPPED / "heavy-top.yaml", A=1, C=1, Omega=2, m=1, g=1, l=1).stability.numerical
    assert verdict is not None
    assert verdict.word is Word.UNDECIDED


def before(found: Stability) -> Verdict | None:
    """What energies and integrals say; terms of higher order may decide more (Arnold-Moser)."""
    return found.before_higher_order or found.numerical


def test_a_top_without_its_symmetry_is_left_open_by_integrals() -> None:
    """With a weak spring across, the momentum about the vertical is no integral: gyroscopic stabilisation, no more.

    Nor is that of a slim top's spin about its axis; in axes that turn with it, moments A, B, C, P = m g l, the tilts
    have K1 = (C - B) W^2 - P, K2 = (C - A) W^2 - P and  A B z^4 + (A K2 + B K1 + (A + B - C)^2 W^2) z^2 + K1 K2.
    """
    text = (SHIPPED / "heavy-top.yaml").read_text(encoding="utf-8")
    pulled = text.replace("loads:\n", "loads:\n  - potential: sin(beta)**2/100\n")
    verdict = before(mbsym.loads(pulled).stability)
    assert verdict is not None
    assert verdict.word is Word.GYROSCOPIC
    slim = mbsym.loads(text.replace("inertia: [A, A, C]", "inertia: [A, A*11/10, C]")).stability
    open_ = before(slim)
    assert open_ is not None
    assert open_.word is Word.GYROSCOPIC
    (tilts,) = (part for part in slim.subsystems if len(part.coordinates) == 2)
    values = {"A": 10, "C": 5, "m": 2, "g": 3, "l": 7, "Omega": 13}
    k1, k2, spin = (5 - 11) * 169 - 42, (5 - 10) * 169 - 42, (10 + 11 - 5) ** 2 * 169
    wanted = [k1 * k2, 0, 10 * k2 + 11 * k1 + spin, 0, 110]
    found = [int(str(x.subs(values))) for x in tilts.characteristic]
    assert [x * 110 for x in found] == [x * found[-1] for x in wanted]


# --- free bodies, rotors ---------------------------------------------------------------------------------------------

GYROSTAT = """
mbsym: 1
name: Spinning free gyrostat
parameters: {{A: {A}, B: {B}, C: {C}, W: {W}, h: {h}}}
bodies:
  - name: body
    rotation: {{axes: [3, 1, 2], angles: [c, a, b]}}
    mass: 1
    inertia about: mass centre
    inertia: [A, B, C]
    gyrostatic moment: [0, 0, h]
motion: {{c: {{value: 0, rate: W}}, a: 0, b: 0}}
"""


@pytest.mark.parametrize("moments", list(permutations((2, 3, 4))), ids=str)
@pytest.mark.parametrize(("rate", "rotor"), [("1", "0"), ("1", "3/2"), ("1", "-3/2"), ("-2", "3"), ("1/2", "-3")])
def test_spins_of_a_free_body_with_a_rotor(moments: tuple[int, int, int], rate: str, rotor: str) -> None:
    """A w1' = -((C - B) W + h) w2, B w2' = ((C - A) W + h) w1: stable iff the product is positive, then by integrals.

    h = 0 is Euler's top; a despun platform is stable where the rotor is fast enough, about whichever axis.
    """
    A, B, C = moments
    W, h = Fraction(rate), Fraction(rotor)
    product = ((C - B) * W + h) * ((C - A) * W + h)
    verdict = mbsym.loads(GYROSTAT.format(A=A, B=B, C=C, W=W, h=h)).stability.numerical
    assert verdict is not None
    if product > 0:
        assert verdict.word is Word.STABLE_BUT_CYCLIC
    elif product < 0:
        assert verdict.word is Word.UNSTABLE
    else:
        assert verdict.word is Word.UNDECIDED


def test_a_rotor_with_friction_is_no_conservative_system() -> None:
    """Energy decreases and the spin about the smallest axis is lost: no combination of integrals may say otherwise."""
    text = GYROSTAT.format(A=4, B=3, C=2, W=1, h=0) + (
        "\nloads:\n  - generalized force: {a: -a_dot/100, b: -b_dot/100}\n"
    )
    verdict = mbsym.loads(text).stability.numerical
    assert verdict is not None
    assert verdict.word not in (Word.STABLE, Word.STABLE_BUT_CYCLIC)


def test_no_integral_but_the_energy_decides_the_debra_delp_region() -> None:
    """A satellite there is gyroscopically stabilised; that it is stable is not known."""
    moments = {"A": Fraction(1), "B": Fraction("0.99"), "C": Fraction("0.96")}
    system = mbsym.load(SHIPPED / "gravity-gradient.yaml").system
    found = equilibria(system, given_values(system, moments))
    assert sum(one.verdict.word is Word.GYROSCOPIC for one in found.equilibria) == 4


HANGING = """
mbsym: 1
name: Spherical pendulum in a rotating frame
parameters: {{g: 10, W: {W}}}
prescribed: {{chi: {{rate: W}}}}
bodies:
  - {{name: frame, attached to: 0, rotation: {{axes: [3], angles: [chi]}}, mass: 0}}
  - name: rod
    attached to: frame
    rotation: {{axes: [1, 2], angles: [x, y]}}
    mass: 1
    mass centre: [0, 0, -1]
loads:
  - uniform gravity: {{vector: [0, 0, -g]}}
{spring}motion: {{x: 0, y: 0}}
"""


@pytest.mark.parametrize("rate", ["1", "4", "20"])
def test_hanging_is_stable_in_whatever_frame(rate: str) -> None:
    """Seen from inertial space nothing turns; with a spring that turns with the frame only the energy there is left."""
    still = mbsym.loads(HANGING.format(W=rate, spring="")).stability.numerical
    assert still is not None
    assert still.word is Word.STABLE
    whole = mbsym.loads(HANGING.format(W=rate, spring="  - potential: sin(x)**2/20\n")).stability
    turning = before(whole)
    assert turning is not None
    assert turning.word is (Word.STABLE if Fraction(rate) ** 2 < 10 else Word.GYROSCOPIC)
    assert whole.numerical is not None
    assert whole.numerical.word is Word.STABLE


DUAL_SPIN = """
mbsym: 1
name: Platform with a rotor
parameters: {{A: {A}, B: {B}, C: {C}, W: {W}, s: {s}}}
bodies:
  - name: platform
    rotation: {{axes: [3, 1, 2], angles: [c, a, b]}}
    mass: 1
    inertia about: mass centre
    inertia: [A, B, C]
  - name: rotor
    attached to: platform
    rotation: {{axes: [3], angles: [r]}}
    mass: 1
    inertia about: mass centre
    inertia: [1, 1, 1/2]
motion: {{c: {{value: 0, rate: W}}, a: 0, b: 0, r: {{value: 0, rate: s}}}}
"""


@pytest.mark.parametrize(
    ("moments", "rate", "rotor"),
    [
        ((4, 3, 2), "0", "5"),
        ((4, 3, 2), "1", "0"),
        ((4, 2, 3), "1", "-8"),
        ((4, 2, 3), "1/10", "8"),
        ((4, 2, 3), "1", "1"),
    ],
)
def test_a_platform_may_be_despun(moments: tuple[int, int, int], rate: str, rotor: str) -> None:
    """As above with A + 1, B + 1, C + 1/2 and h = s/2: a rotor as a body of its own, whose angle is cyclic."""
    A, B, C = moments
    W, s = Fraction(rate), Fraction(rotor)
    product = ((C - B - Fraction(1, 2)) * W + s / 2) * ((C - A - Fraction(1, 2)) * W + s / 2)
    text = DUAL_SPIN.format(A=A, B=B, C=C, W=W, s=s)
    verdict = mbsym.loads(text if W else text.replace("c: {value: 0, rate: W}, ", "")).stability.numerical
    assert verdict is not None
    assert verdict.word is (Word.STABLE_BUT_CYCLIC if product > 0 else Word.UNSTABLE)


def test_a_spring_to_the_outside_takes_the_angular_momentum_away() -> None:
    """The same despun platform, tied weakly to space: no integral but the energy and the rotor's momentum is left."""
    text = DUAL_SPIN.format(A=4, B=2, C=3, W=1, s=-8).replace("c: {value: 0, rate: W}, ", "")
    held = mbsym.loads(
        text + "loads:\n  - potential: -sin(a)**2/100 - sin(b)**2/100 - sin(c)**2/100\n"
    ).stability.numerical
    assert held is not None
    assert held.word is Word.UNSTABLE
    loose = before(mbsym.loads(text + "loads:\n  - potential: -sin(a)**2/100 - sin(b)**2/100\n").stability)
    assert loose is not None
    assert loose.word in (Word.GYROSCOPIC, Word.UNDECIDED)
