"""Dual spin: a despun platform with a damper, a rotor, and the rule of Landon and Iorillo.

A platform (moments A, A, C) at rest carries a rotor (Ar, Ar, Cr) that spins at the rate W about its axis 3; with
At = A + Ar the transverse angular velocity nutates at  Cr W/At  as seen from the platform, at  Cr W/At - W  from the
rotor.  A small damper takes energy at given angular momentum (Landon, Stewart 1964; Iorillo 1965): in the platform it
attracts, whatever the shape; in the rotor alone it attracts for Cr > At and repels for Cr < At.  As the platform
stands in any direction of space, two roots of the tilts are zero; the others decay, or one pair grows.
"""

from __future__ import annotations

import pytest

import mbsym
from mbsym.analysis import Analysis
from mbsym.problems.stability.words import Because, Word

#: A, C, Ar, Cr.
PROLATE, OBLATE = (10, 6, 2, 4), (2, 1, 8, 14)

DAMPER = "- {name: damper, attached to: BASE, connection point: [b, 0, z], coordinates: [z], mass: m}"


def dual_spin(damped: str, shape: tuple[int, int, int, int], angular: str = "") -> Analysis:
    """The root of the tree is the body that has the damper: in its axes the motion is steady."""
    platform, rotor = "[A, A, C]", "[Ar, Ar, Cr]"
    first, second = (platform, rotor) if damped == "platform" else (rotor, platform)
    motion = "{rho: {rate: W}}" if damped == "platform" else "{psi: {rate: W}, rho: {rate: -W}}"
    numbers = ", ".join(
        f"{k}: {{positive: true, value: {x}}}" for k, x in zip(("A", "C", "Ar", "Cr"), shape, strict=True)
    )
    return mbsym.loads(f"""
mbsym: 1
name: Dual spin
parameters: {{{numbers}, W: {{positive: true, value: 5}}, m: {{positive: true, value: 1/10}},
  k: {{positive: true, value: 3}}, d: {{positive: true, value: 1/2}}, b: {{positive: true, value: 1}}}}
bodies:
  - {{name: first, attached to: 0, rotation: {{axes: [3, 1, 2], angles: [psi, th, ph]}}, mass: 0,
     inertia about: joint, inertia: {first}}}
  - {{name: second, attached to: first, rotation: {{axes: [3], angles: [rho]}}, mass: 0,
     inertia about: joint, inertia: {second}}}
  {DAMPER.replace("BASE", "first")}
loads:
  - potential: k*z**2/2
  - damper: {{coordinate: z, coefficient: d}}{angular}
motion: {motion}
""")


@pytest.mark.parametrize("shape", [PROLATE, OBLATE])
def test_a_damper_in_the_despun_platform_attracts(shape: tuple[int, int, int, int]) -> None:
    found = dual_spin("platform", shape).stability
    assert found.numerical is not None
    assert found.numerical.word is Word.ASYMPTOTIC_BUT_TURNED
    assert found.numerical.because(Because.TURNED_DECAYS)


@pytest.mark.parametrize(("shape", "word"), [(PROLATE, Word.UNSTABLE), (OBLATE, Word.ASYMPTOTIC_BUT_TURNED)])
def test_a_damper_in_the_rotor_repels_from_a_small_moment(shape: tuple[int, int, int, int], word: Word) -> None:
    found = dual_spin("rotor", shape).stability
    assert found.numerical is not None
    assert found.numerical.word is word


def test_a_load_that_knows_space_takes_the_directions_away() -> None:
    """A spring on a tilt of the platform: no turned platform stands, and nothing is said of a rotation of space."""
    found = dual_spin("platform", OBLATE, "\n  - spring: {coordinate: th, stiffness: k}").stability
    assert found.numerical is not None
    assert found.numerical.word is not Word.ASYMPTOTIC_BUT_TURNED
