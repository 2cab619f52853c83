"""Coordinates that are felt although their velocities are dependent: x_f' = S eta + T x beside the equations of speeds.

A sleigh of speed v whose blade does not slip, y' = v phi to first order, and which a spring at b ahead of the blade
pulls to the line y = 0 with -k (y + b phi).  About the blade

    (J + m a^2) phi'' + m a v phi' + k b (y + b phi) = 0,        y' - v phi = 0,

so that (J + m a^2) z^3 + m a v z^2 + k b^2 z + k b v = 0, and Hurwitz demands  m a v k b^2 > (J + m a^2) k b v,  which
is m a (b - a) > J.
"""

from __future__ import annotations

import dataclasses
from fractions import Fraction
from pathlib import Path
from random import Random

import pytest
from conftest import analysed
from flint import arb, ctx

from mbsym.analysis import approximation
from mbsym.analysis.pipeline import Analysis
from mbsym.maps.mapping import exact_map
from mbsym.maps.section import Axis
from mbsym.problems.checks import EXACT, FAILED
from mbsym.problems.stability.linear_form import NonholonomicForm
from mbsym.problems.stability.nonholonomic import enclosed
from mbsym.problems.stability.words import Word

TEXT = (Path(__file__).parent / "pulled-sleigh.yaml").read_text(encoding="utf-8")


def described(text: str = TEXT) -> Analysis:
    return analysed(text)


@pytest.fixture(scope="module")
def sleigh() -> Analysis:
    return described()


def test_the_matrices_are_those_found_by_hand(sleigh: Analysis) -> None:
    found = sleigh.linearisation
    assert found.coordinates == ("x", "phi", "y")
    assert found.about.ties
    assert (found.about.idle, found.about.following) == (("x",), ("y",))
    velocity = [[found.D[i, j].polynomial + found.G[i, j].polynomial for j in range(3)] for i in range(3)]
    position = [[found.K[i, j].polynomial + found.N[i, j].polynomial for j in range(3)] for i in range(3)]
    p = {name: sleigh.ring.generator("parameter", name) for name in "mJabkv"}
    zero, one = sleigh.ring.zero, sleigh.ring.one
    inertia = p["J"] + p["m"] * p["a"] ** 2
    assert found.M.polynomials == ((p["m"], zero, zero), (zero, inertia, zero), (zero, zero, zero))
    assert velocity == [[zero] * 3, [zero, p["m"] * p["a"] * p["v"], zero], [zero, zero, one]]
    assert position == [[zero] * 3, [zero, p["k"] * p["b"] ** 2, p["k"] * p["b"]], [zero, -p["v"], zero]]


def test_the_condition_is_the_one_of_hurwitz(sleigh: Analysis) -> None:
    _, part = sleigh.stability.subsystems
    assert part.coordinates == ("phi", "y")
    assert [str(x) for x in part.characteristic] == ["b*k*v", "b**2*k", "m*a*v", "m*a**2 + J"]
    assert [(str(x), relation) for _, x, relation in part.conditions] == [("m*a*(b - a) - J", ">")]
    assert sleigh.stability.verdict.word is Word.DEPENDS


@pytest.mark.parametrize(
    ("b", "word"),
    [
        ("4", Word.ASYMPTOTIC_BUT_STEADY),
        ("sqrt(13)", Word.ASYMPTOTIC_BUT_STEADY),
        ("sqrt(8)", Word.UNSTABLE),
        ("2", Word.UNSTABLE),
        ("3", Word.CRITICAL),
    ],
)
def test_the_verdict_changes_where_the_condition_does(b: str, word: Word) -> None:
    """J = 2, m = a = 1: the border is b = 3, with a pair of imaginary roots.  Irrational b are judged by enclosures."""
    found = described(TEXT.replace("b: {sign: positive, value: 4}", f"b: {{sign: positive, value: {b}}}")).stability
    assert found.numerical is not None
    assert found.numerical.word is word
    assert [len(part.roots) for part in found.spectra] in ([1, 3], [2, 3])


def test_a_speed_that_is_given_as_a_number_is_of_the_same_family() -> None:
    """The motion is that of v = 3: at that value the same is said; of all values of the parameters nothing more."""
    text = TEXT.replace("{rate: v}", "{rate: 3}")
    text = text.replace("  v: {sign: positive, value: 3, meaning: speed along the edge}\n", "")
    assert described(text).stability.verdict.word is not Word.ASYMPTOTIC_BUT_STEADY
    numerical = described(text).stability.numerical
    assert numerical is not None
    assert numerical.word is Word.ASYMPTOTIC_BUT_STEADY


def test_multipliers_agree_exactly(sleigh: Analysis) -> None:
    checks = {check.name: check.outcome for check in sleigh.checks}
    assert checks["perturbed motion"] == checks["equilibrium"] == checks["constrained motion"] == EXACT


@pytest.mark.parametrize("part", ["S", "T"])
def test_a_wrong_row_of_what_follows_is_found(part: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """y' = v phi without the term, or with one too many: the check sees it and the verdict falls."""
    made = approximation.reduced

    def planted(analysis: Analysis) -> object:
        found = made(analysis)
        one = found.equations.A[0][0].context().constant(1)
        rows = [[x + one for x in row] for row in getattr(found.equations, part)]
        return dataclasses.replace(found, equations=dataclasses.replace(found.equations, **{part: rows}))

    analysis = described()
    analysis.__dict__["reduced"] = planted(analysis)
    outcome = {check.name: check.outcome for check in analysis.checks}
    assert outcome["perturbed motion"] == FAILED


def test_a_map_has_the_region_of_hurwitz(sleigh: Analysis) -> None:
    """b > a + 2/a in the plane of a and b at m = 1, J = 2: judged at random points against the condition by hand."""
    axes = [Axis("b", Fraction(1), Fraction(6)), Axis("a", Fraction(1, 5), Fraction(3))]
    found, source, seen = exact_map(described(), axes, {}), Random(4), set()
    for _ in range(12):
        b, a = Fraction(source.randint(101, 599), 100), Fraction(source.randint(21, 299), 100)
        stable = b > a + 2 / a
        seen.add(stable)
        word = found.at(b, a).judged.verdict.word
        assert word is (Word.ASYMPTOTIC_BUT_STEADY if stable else Word.UNSTABLE)
    assert seen == {True, False}


@pytest.mark.parametrize(
    ("stiffness", "even", "word"),
    [
        (("2", "3"), True, Word.CRITICAL),
        (("2", "3"), False, Word.UNDECIDED),  # nobody knows that the odd coefficients are zero
        (("2", "2"), True, Word.UNDECIDED),  # a double pair may have a block
        (("2", "-3"), True, Word.UNSTABLE),
    ],
)
def test_imaginary_pairs_at_irrational_values(stiffness: tuple[str, str], even: bool, word: Word) -> None:
    """x'' + sqrt(a) x = 0, y'' + sqrt(b) y = 0, or - sqrt(-b): enclosed, and even in lambda where that is known."""
    with ctx.workprec(128):
        a, b = (arb(x).sqrt() if not x.startswith("-") else -arb(x[1:]).sqrt() for x in stiffness)
        zero, one = arb(0), arb(1)
        nothing = [[zero, zero], [zero, zero]]
        matrices = [[[one, zero], [zero, one]], nothing, nothing, [[a, zero], [zero, b]], nothing]
        assert enclosed(NonholonomicForm(), matrices, 0, 128, even).word is word


TRAILER = """
mbsym: 1
name: Cart with a trailer that does not slip
parameters: {m: {positive: true, value: 1}, l: {positive: true, value: 2}, v: {value: SPEED}}
bodies:
  - {name: cart, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: m}
  - {name: trailer, attached to: cart, rotation: {axes: [3], angles: [psi]}, mass: MASS, mass centre: [-l, 0, 0]}
constraints:
  - velocity: l*psi_dot = -x_dot*sin(psi)
motion: {x: {rate: v}, psi: 0}
"""


@pytest.mark.parametrize("mass", ["0", "m/7"])
@pytest.mark.parametrize("dependent", ["", "dependent: [psi]", "dependent: [x]"])
@pytest.mark.parametrize(("speed", "word"), [("1", Word.ASYMPTOTIC_BUT_STEADY), ("-1", Word.UNSTABLE)])
def test_the_angle_of_a_trailer_has_its_root(speed: str, word: Word, dependent: str, mass: str) -> None:
    """No equation of the cart feels the trailer to first order, but l psi' = -v psi: pulled it follows, else it folds.

    The cart runs at any speed from any place: two zero roots, a family of one dimension besides x.
    """
    found = described(TRAILER.replace("SPEED", speed).replace("MASS", mass) + dependent + "\n").stability
    assert found.numerical is not None
    assert found.numerical.word is word
    told = {part.coordinates: [str(x) for x in part.characteristic] for part in found.subsystems}
    assert told == {("x",): ["0", "0", "1"], ("psi",): ["v", "l"]}


TURNTABLE = (Path(__file__).parents[2] / "systems" / "turntable-sphere.yaml").read_text(encoding="utf-8")


@pytest.mark.parametrize("dependent", ["[alpha, beta]", "[x, y]", "[x, alpha]", "[y, gamma]"])
def test_no_choice_of_dependent_velocities_loses_a_root(dependent: str) -> None:
    """Routh's sphere on a turntable: its centre goes round at the rate J Omega/(J + m r^2), wherever it is.

    In angles that turn with it the sphere, spinning at the rate s, turns about the others with the frequency s; place
    and spin add zero roots: lambda^4 (lambda^2 + s^2) (lambda^2 + (J Omega/(J + m r^2))^2).
    """
    found = described(TURNTABLE.replace("dependent: [alpha, beta]", f"dependent: {dependent}")).stability
    assert sum(len(part.characteristic) - 1 for part in found.subsystems) == 8
    (part,) = (part for part in found.subsystems if part.coordinates != ("gamma",))
    values = {"m": 1, "r": Fraction(1, 10), "J": Fraction(1, 250), "Omega": 2, "s": 3}
    numbers = [Fraction(str(x.subs(values))) for x in part.characteristic]
    rate = Fraction(4, 7)  # J/(J + m r^2) Omega = 2/7 Omega
    scaled = [x / numbers[-1] for x in numbers]
    assert scaled == [0, 0, 9 * rate**2, 0, 9 + rate**2, 0, 1]
