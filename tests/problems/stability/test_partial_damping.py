"""Energy with partial damping: K > 0, D >= 0 and an energy that does not grow.

What stays undamped are modes v with K v = w^2 M v and D v = 0 (G = 0), by hand below.
"""

from __future__ import annotations

import json
from typing import Any

import pytest
from flint import fmpq_mpoly_ctx
from terminal import told

import mbsym
from mbsym.algebra.signs import Signs
from mbsym.problems.stability.exact import verdict_at
from mbsym.problems.stability.linear_form import LinearSystem
from mbsym.problems.stability.symbolic import analyse
from mbsym.problems.stability.verdict import concluded
from mbsym.problems.stability.words import Because, Fact, Ground, Word, applying
from mbsym.report.targets import TARGETS

NONE = fmpq_mpoly_ctx.get(["unused"])


def system(conservative: bool = True, **given: Any) -> LinearSystem:
    n = len(given["K"])
    zero = [[0] * n for _ in range(n)]
    unit = [[int(i == j) for j in range(n)] for i in range(n)]
    parts = [given.get(name, unit if name == "M" else zero) for name in "MDGKN"]
    made = [tuple(tuple(NONE.constant(x) for x in row) for row in rows) for rows in parts]
    return LinearSystem(made[0], made[1], made[2], made[3], made[4], conservative, names=tuple("xyz"[:n]))


def words(made: LinearSystem) -> tuple[str, str]:
    symbolic = analyse(made, Signs(NONE, ("real",), ())).verdict.word
    return symbolic.name, verdict_at(made, {}).verdict.word.name


CHAIN = [[5, -3, 0], [-3, 8, -3], [0, -3, 5]]  # k (x^2 + y^2 + z^2)/2 + c ((x-y)^2 + (y-z)^2)/2, k = 2, c = 3


def test_a_damped_node_leaves_a_mode_undamped() -> None:
    """(1, 0, -1) has w^2 = 5 and a node at y, where the dashpot is; at x, it reaches every mode."""
    at_node = system(K=CHAIN, D=[[0, 0, 0], [0, 1, 0], [0, 0, 0]])
    found = verdict_at(at_node, {}).verdict
    assert (found.word, found.theorem) == (Word.STABLE, "Lagrange-Dirichlet")
    assert found.explanation.endswith("In first approximation motions of x, z stay undamped.")
    assert words(at_node) == ("STABLE", "STABLE")
    beside = system(K=CHAIN, D=[[1, 0, 0], [0, 0, 0], [0, 0, 0]])
    assert words(beside) == ("ASYMPTOTIC", "ASYMPTOTIC")


def test_a_dashpot_between_two_equal_oscillators_damps_their_difference() -> None:
    """D = [[1, -1], [-1, 1]] is singular, not 0: x + y swings for ever."""
    found = verdict_at(system(K=[[2, 0], [0, 2]], D=[[1, -1], [-1, 1]]), {}).verdict
    assert (found.word, found.theorem) == (Word.STABLE, "Lagrange-Dirichlet")
    assert found.reasons[-1].data == ("x, y",)
    assert words(system(K=[[2, 0], [0, 2]], D=[[1, -1], [-1, 1]])) == ("STABLE", "STABLE")
    assert words(system(K=[[2, 0], [0, 3]], D=[[1, -1], [-1, 1]]))[1] == "ASYMPTOTIC"


def test_gyroscopic_forces_beside_an_undamped_mode_are_rouths() -> None:
    made = system(
        K=[[1, 0, 0], [0, 2, 0], [0, 0, 3]], G=[[0, 1, 0], [-1, 0, 0], [0, 0, 0]], D=[[0] * 3, [0] * 3, [0, 0, 1]]
    )
    found = verdict_at(made, {}).verdict
    assert (found.word, found.theorem) == (Word.STABLE, "Routh")
    assert found.reasons[-1].data == ("x, y",)


@pytest.mark.parametrize(
    ("given", "word"),
    [
        # no energy of the nonlinear system is known
        ({"K": [[2, 0], [0, 2]], "D": [[1, 0], [0, 0]], "conservative": False}, "CRITICAL"),
        # circulation: s^4 + s^3 + 5 s^2 + 2 s + 7 and s^4 + s^3 + 4 s^2 + 2 s + 5, (a3 a2 - a1) a1 < a3^2 a0 in both
        ({"K": [[2, 0], [0, 3]], "N": [[0, 1], [-1, 0]], "D": [[0, 0], [0, 1]]}, "UNSTABLE"),
        ({"K": [[2, 0], [0, 2]], "N": [[0, 1], [-1, 0]], "D": [[0, 0], [0, 1]]}, "UNSTABLE"),
        # negative damping of one mode
        ({"K": [[2, 0], [0, 2]], "D": [[1, 0], [0, -1]]}, "UNSTABLE"),
        # K = -1 twice held up by G = 3, beside a damped oscillator: K is not positive
        (
            {
                "K": [[-1, 0, 0], [0, -1, 0], [0, 0, 1]],
                "G": [[0, 3, 0], [-3, 0, 0], [0, 0, 0]],
                "D": [[0] * 3, [0] * 3, [0, 0, 1]],
            },
            "CRITICAL",
        ),
        # K >= 0 only
        ({"K": [[2, 0], [0, 0]], "D": [[1, 0], [0, 0]]}, "UNDECIDED"),
    ],
)
def test_where_it_must_be_denied(given: dict[str, Any], word: str) -> None:
    assert verdict_at(system(**given), {}).verdict.word.name == word
    assert analyse(system(**given), Signs(NONE, ("real",), ())).verdict.word.name in (word, "UNDECIDED")


def test_a_theorem_needs_all_its_hypotheses() -> None:
    """Take any of them away from what is shown for Lagrange-Dirichlet with damping: no energy is laid."""
    shown = {
        Fact.MASS_POSITIVE,
        Fact.STIFFNESS_POSITIVE,
        Fact.POTENTIAL,
        Fact.NOT_GYROSCOPIC,
        Fact.DAMPING_SEMIDEFINITE,
        Fact.ENERGY_NEVER_GROWS,
    }
    assert concluded(shown).theorem == "Lagrange-Dirichlet"
    assert applying(shown - {Fact.NOT_GYROSCOPIC})[Ground.ENERGY].name == "Routh"
    for fact in shown - {Fact.NOT_GYROSCOPIC}:
        assert applying(shown - {fact}) == {}
        assert concluded(shown - {fact}).because(Because.BORDER)
    # D = 0 says nothing about the nonlinear system: x'' + x = x'^3.
    assert applying({*shown, Fact.UNDAMPED} - {Fact.ENERGY_NEVER_GROWS}) == {}


RING = """
mbsym: 1
name: Three masses, the middle one damped
parameters: {m: positive, k: positive, c: positive, b: positive}
bodies:
  - {name: one, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}
  - {name: two, attached to: 0, connection point: [0, y, 0], mass: m, coordinates: [y]}
  - {name: three, attached to: 0, connection point: [0, 0, z], mass: m, coordinates: [z]}
loads:
  - potential: k*(x**2 + y**2 + z**2)/2 + c*((x-y)**2 + (y-z)**2)/2
  - LOAD
motion: {x: 0, y: 0, z: 0}
values: {m: 1, k: 2, c: VALUE, b: 1}
"""


@pytest.mark.parametrize("value", ["3", "sqrt(2)"])
def test_from_a_description(value: str) -> None:
    """Exactly, and by enclosures at irrational values; in symbols, too."""
    a = mbsym.loads(RING.replace("LOAD", "damper: {coordinate: y, coefficient: b}").replace("VALUE", value))
    assert a.stability.numerical is not None
    for verdict in (a.stability.verdict, a.stability.numerical):
        assert (verdict.word, verdict.theorem) == ("stable", "Lagrange-Dirichlet")
    assert any(text.startswith("Verdict: stable (Lagrange-Dirichlet). ") for text in told(a, 6))


def test_damping_of_unknown_or_wrong_sign_is_no_energy() -> None:
    """R = b y'^4/4 takes energy; R = -b y'^4/4 feeds it: then K > 0 and D = 0 prove nothing."""

    def verdict(load: str) -> str:
        return mbsym.loads(RING.replace("LOAD", load).replace("VALUE", "3")).stability.verdict.word

    assert verdict("rayleigh: b*y_dot**4/4") == "stable"
    assert verdict("rayleigh: -b*y_dot**4/4") == "stable in first approximation only"
    assert verdict("rayleigh: b*(y_dot**2/2 - y_dot**4/4)") == "stable"  # near the motion it takes energy
    assert verdict("rayleigh: b*(y_dot**2/2 - x_dot**4/4)") != "stable"  # but not from x


SERIES = """
mbsym: 1
name: Three masses in a row, the middle one damped
parameters: {m1: positive, m2: positive, m3: positive, k1: positive, k2: positive, k3: positive, b: positive}
bodies:
  - {name: one, attached to: 0, connection point: [x, 0, 0], mass: m1, coordinates: [x]}
  - {name: two, attached to: 0, connection point: [0, y, 0], mass: m2, coordinates: [y]}
  - {name: three, attached to: 0, connection point: [0, 0, z], mass: m3, coordinates: [z]}
loads:
  - potential: k1*x**2/2 + k2*(x-y)**2/2 + k3*(y-z)**2/2
  - damper: {coordinate: y, coefficient: b}
motion: {x: 0, y: 0, z: 0}
"""


def test_asymptotic_or_merely_stable_depends_but_stable_it_is() -> None:
    """With y at rest x and z swing at (k1 + k2)/m1 and k3/m3: only if these are equal does a mode have a node at y."""
    a = mbsym.loads(SERIES)
    lines = told(a, 6)
    place = next(k for k, text in enumerate(lines) if text.startswith("asymptotically stable ("))
    assert lines[place].endswith(", if:")
    assert lines[place + 1] == "  Hurwitz minor 5: m3 (k1 + k2) - m1 k3 != 0"
    assert "Otherwise stable (Lagrange-Dirichlet):" in lines[place + 2 :]
    text = TARGETS["latex"].render(a, (6,))
    assert "Otherwise \\textbf{stable} (Lagrange-Dirichlet):\n\n$K > 0$" in text
    cases = json.loads(TARGETS["json"].render(a, (6,)))["stability"]["subsystems"][0]["cases"]
    assert [(case["verdict"], bool(case["all_of"])) for case in cases] == [
        ("asymptotically stable", True),
        ("stable", False),
    ]


FREE = """
mbsym: 1
name: a point that friction holds back, and that nothing else acts on
bodies:
  - {name: p, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
loads:
  - rayleigh: RAYLEIGH
motion: {x: 0, y: 0}
"""


@pytest.mark.parametrize(
    ("rayleigh", "momenta"), [("y_dot**2/2", True), ("(x_dot**2 + y_dot**2)/2", False)], ids=["one way", "both ways"]
)
def test_zero_roots_of_cyclic_coordinates_are_not_called_negative(rayleigh: str, momenta: bool) -> None:
    """x'' = 0 or x'' = -x', y'' = -y': the roots are 0 and -1; where nothing brakes x, its velocity stays disturbed."""
    verdict = mbsym.loads(FREE.replace("RAYLEIGH", rayleigh)).stability.verdict
    assert "All roots have negative" not in verdict.explanation
    assert "All roots but the zero ones" in verdict.explanation
    assert ("all velocities" in verdict.explanation) is not momenta
    assert ("momenta that differ a little stay different" in verdict.explanation) is momenta
