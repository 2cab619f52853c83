"""Textbook systems whose stability is known in closed form, at numbers that are irrational, zero or on a border.

* Restricted three bodies, the triangular points: gyroscopically stabilised for 27 mu (1 - mu) < 1, unstable beyond
  (E. J. Routh, Proc. London Math. Soc. 6 (1875); V. Szebehely, Theory of Orbits, 1967, section 5.4).  The matrices hold
  sqrt(3).
* Furuta's pendulum, hanging, with and without friction: a coefficient of 0 leaves the momentum of the arm constant.
* Foucault's pendulum in a frame that turns with the Earth: the latitude is a number under sine and cosine.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import filed
from terminal import told

import mbsym
from mbsym.analysis import Analysis
from mbsym.mechanics.rest import given_values
from mbsym.problems.relative_equilibria.equilibria import CoordinateValue, equilibria
from mbsym.problems.stability.verdict import Verdict, combine
from mbsym.problems.stability.words import Because, Reason, Word

THREE_BODIES = """
mbsym: 1
name: Restricted three bodies
parameters: {mu: {sign: positive, value: MU}}
prescribed: {chi: 1}
assumptions: [mu < 1/2]
bodies:
  - {name: frame, attached to: 0, rotation: {axes: [3], angles: [chi]}, mass: 0}
  - {name: first, attached to: frame, connection point: [-mu, 0, 0], mass: 0}
  - {name: second, attached to: frame, connection point: [1 - mu, 0, 0], mass: 0}
  - {name: craft, attached to: frame, connection point: [x, y, z], mass: 1, coordinates: [x, y, z]}
loads:
  - newtonian gravity: {constant: 1 - mu, centre: first, about: frame, order: exact}
  - newtonian gravity: {constant: mu, centre: second, about: frame, order: exact}
motion: {x: 1/2 - mu, y: sqrt(3)/2, z: 0}
"""

FURUTA = """
mbsym: 1
name: Furuta pendulum
parameters: {J0: positive, L: positive, m: positive, l: positive, J: positive, g: positive, b0: nonnegative,
  b1: nonnegative}
bodies:
  - name: arm
    attached to: 0
    rotation: {axes: [3], angles: [theta0]}
    mass: 1
    inertia about: joint
    inertia: [J0, J0, J0]
  - name: pendulum
    attached to: arm
    rotation: {axes: [1], angles: [theta1]}
    connection point: [L, 0, 0]
    mass centre: [0, 0, l]
    mass: m
    inertia about: mass centre
    inertia: [J, J, 0]
loads:
  - uniform gravity: {vector: [0, 0, -g]}
  - damper: {coordinate: theta0, coefficient: b0}
  - damper: {coordinate: theta1, coefficient: b1}
motion: {theta0: 0, theta1: REST}
values: {J0: 0.02, L: 0.3, m: 0.1, l: 0.2, J: 0.002, g: 9.81, b0: B0, b1: B1}
"""

FOUCAULT = """
mbsym: 1
name: Foucault pendulum
parameters: {m: positive, l: positive, g: positive, Omega: positive, lam: real}
prescribed: {chi: Omega}
bodies:
  - {name: site, attached to: 0, rotation: {axes: [3, 2], angles: [chi, pi/2 - lam]}, mass: 0}
  - name: bob
    attached to: site
    connection point: [x, y, l - sqrt(l**2 - x**2 - y**2)]
    mass: m
    coordinates: [x, y]
loads:
  - potential: m*g*(l - sqrt(l**2 - x**2 - y**2))
motion: {x: 0, y: 0}
values: {m: 1, l: 67, g: 9.81, Omega: OMEGA, lam: 0.8526}
"""

SPRING = """
mbsym: 1
name: Two masses on a spring
parameters: {m: positive, k: positive, l: positive}
bodies:
  - {name: A, attached to: 0, connection point: [x1, y1, 0], mass: m, coordinates: [x1, y1]}
  - {name: B, attached to: 0, connection point: [x2, y2, 0], mass: m, coordinates: [x2, y2]}
loads:
  - spring: {between: [{body: A, point: [0, 0, 0]}, {body: B, point: [0, 0, 0]}], stiffness: k, length: l}
values: {m: 1, k: 3, l: 1}
"""


def analysed(tmp_path: Path, text: str, **numbers: str) -> Analysis:
    for name, number in numbers.items():
        text = text.replace(f" {name}", f" {number}")
    path = filed(tmp_path / "system.yaml", text)
    return mbsym.load(path)


def verdict(a: Analysis) -> Verdict:
    assert a.stability.numerical is not None
    return a.stability.numerical


@pytest.mark.parametrize(
    ("mu", "word"), [("0.0121505", Word.GYROSCOPIC), ("0.0385", Word.GYROSCOPIC), ("0.0386", Word.UNSTABLE)]
)
def test_triangular_points_at_numbers(tmp_path: Path, mu: str, word: str) -> None:
    """Routh's border is mu = (1 - sqrt(23/27))/2 = 0.03852..."""
    found = verdict(analysed(tmp_path, THREE_BODIES, MU=mu))
    assert found.word == word
    assert found.theorem == ("" if word == Word.GYROSCOPIC else "Lyapunov's first method")


@pytest.mark.parametrize(
    ("damping", "rest", "word"),
    [
        (("0", "0"), "pi", Word.STABLE_BUT_CYCLIC),
        (("0", "0"), "0", Word.UNSTABLE),
        (("0.1", "0.2"), "pi", Word.ASYMPTOTIC_BUT_CYCLIC),
        (("0.1", "0.2"), "0", Word.UNSTABLE),
    ],
)
def test_furuta_pendulum_without_friction(tmp_path: Path, damping: tuple[str, str], rest: str, word: str) -> None:
    a = analysed(tmp_path, FURUTA, B0=damping[0], B1=damping[1], REST=rest)
    assert verdict(a).word == word
    listed = equilibria(a.system, given_values(a.system, {})).equilibria
    assert {one.values[-1].text: one.verdict.word for one in listed}[rest] == word


@pytest.mark.parametrize(("omega", "word"), [("7.292e-5", Word.STABLE), ("0.45", Word.UNSTABLE)])
def test_foucault_pendulum_at_a_latitude(tmp_path: Path, omega: str, word: str) -> None:
    """det K is (g/l - Omega^2 sin(lam)^2) (g/l - Omega^2) m^2: at 0.45 = Omega only the second factor is negative."""
    found = verdict(analysed(tmp_path, FOUCAULT, OMEGA=omega))
    assert found.word == word


def test_theorems_of_other_parts_do_not_carry_a_weaker_verdict() -> None:
    weak = Verdict(Word.GYROSCOPIC, (), (Reason(Because.GYROSCOPIC_ENCLOSED),))
    assert combine([weak, Verdict(Word.STABLE, ("Lagrange-Dirichlet",))]).theorem == ""
    mixed = combine([Verdict(Word.STABLE, ("Lagrange-Dirichlet",)), Verdict(Word.ASYMPTOTIC, ("Kelvin-Chetaev",))])
    assert (mixed.word, mixed.theorem) == (Word.CRITICAL, "")


def test_an_undecided_verdict_says_why(tmp_path: Path) -> None:
    a = analysed(tmp_path, THREE_BODIES.replace("sqrt(3)/2", "sqrt(3)/2 + mu"), MU="0.01")
    assert verdict(a).word == Word.UNDECIDED
    (line,) = [text for text in told(a, 6) if text.startswith("At the given values")]
    assert line.startswith("At the given values of the parameters: undecided. The motion does not exist there: ")


def test_families_are_written_without_inner_names(tmp_path: Path) -> None:
    """Two masses on a spring at its length: the root of the distance is an unknown of its own while it is solved."""
    a = analysed(tmp_path, SPRING)
    found = equilibria(a.system, given_values(a.system, {}))
    assert found.families
    written = [text for family in found.families for text in (*family.equations, *family.free)]
    assert any("sqrt(" in text for text in written)
    assert not any("#" in text for text in written)


def test_what_is_zero_but_for_rounding_is_shown_as_zero() -> None:
    from mbsym.studies.equilibria.listed import _text

    assert _text(CoordinateValue("x", "0", -1.2e-292, False, False)) == "0"
    assert _text(CoordinateValue("x", "0.123456789012", 0.123456789012, False, False)) == "0.12345679"


def test_denominators_of_unknown_sign_become_squares() -> None:
    """m x'' + 2 c x / ((k - a) (k - b)^2) = 0 is stable for c (k - a) > 0; (k - b)^2 is a square already."""
    description = """
mbsym: 1
name: particle
parameters: {m: positive, k: real, a: real, b: real, c: real}
bodies:
  - {name: particle, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}
loads:
  - potential: c*x**2/((k - a)*(k - b)**2)
motion: {x: 0}
"""
    (part,) = mbsym.loads(description).stability.subsystems
    assert str(part.factor) == "(k - a)**2*(k - b)**2"
    assert str(part.matrices[3].rows[0][0]) == "2*c*(k - a)"
    for word, k, a in ((Word.STABLE, 1, 3), (Word.UNSTABLE, 3, 1)):
        (part,) = mbsym.loads(f"{description}values: {{m: 1, b: 7, c: -1, k: {k}, a: {a}}}\n").stability.subsystems
        assert part.theory.at_point is not None
        assert part.theory.at_point.verdict.word == word
