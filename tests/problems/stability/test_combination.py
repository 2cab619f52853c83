"""The law by which verdicts of subsystems combine: as an algebra, and against counted eigenvalues of whole systems.

Eigenvalues of the whole are counted by a route of the test's own: isolated roots of the characteristic polynomial,
those on the imaginary axis by the common divisor of the real and the imaginary part of p(i w), Jordan blocks by ranks.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import chain, combinations, product
from typing import Any

import pytest
from conftest import STATEMENTS
from flint import fmpq, fmpq_mat, fmpq_mpoly_ctx, fmpq_poly
from hypothesis import assume, event, example, given
from hypothesis import strategies as st
from properties import settings

import mbsym
from mbsym.problems.stability.exact import verdict_at
from mbsym.problems.stability.linear_form import LinearSystem
from mbsym.problems.stability.verdict import LAW, PLAIN, Flaw, Verdict, coasting, combine, row_of
from mbsym.problems.stability.words import Ground, Word

# --- the algebra -----------------------------------------------------------------------------------------------------


def sets_of(members: Any) -> list[frozenset[Any]]:
    every = list(members)
    return [frozenset(x) for x in chain.from_iterable(combinations(every, k) for k in range(len(every) + 1))]


def verdict_of(grounds: frozenset[Ground], flaws: frozenset[Flaw], theorem: str) -> Verdict:
    """The only verdict with these grounds, each laid by a theorem of this name."""
    row = row_of(grounds, flaws)
    theorems = (theorem,) if row.ground is not None or row.word is Word.UNSTABLE else ()
    return Verdict(row.word, theorems, (), tuple((ground, (theorem,)) for ground in grounds), flaws)


def essence(verdict: Verdict) -> tuple[Any, ...]:
    return verdict.word, frozenset(verdict.laid), verdict.flawed


verdicts = st.builds(
    verdict_of, st.sampled_from(sets_of(Ground)), st.sampled_from(sets_of(Flaw)), st.sampled_from(["R", "S", "T"])
)

#: What is stronger than what, written from what the words mean: (stronger, weaker).
STRONGER = [
    ("ASYMPTOTIC", "ASYMPTOTIC_BUT_CYCLIC"), ("ASYMPTOTIC", "ASYMPTOTIC_BUT_TURNED"), ("ASYMPTOTIC", "STABLE"),
    ("ASYMPTOTIC_BUT_CYCLIC", "ASYMPTOTIC_BUT_TURNED"), ("ASYMPTOTIC_BUT_CYCLIC", "STABLE_BUT_CYCLIC"),
    ("STABLE", "STABLE_BUT_CYCLIC"), ("STABLE_BUT_CYCLIC", "GYROSCOPIC"), ("GYROSCOPIC", "CRITICAL"),
    ("ASYMPTOTIC_BUT_TURNED", "CRITICAL"), ("CRITICAL", "UNDECIDED"), ("UNDECIDED", "DEPENDS"),
    ("DEPENDS", "UNSTABLE_BUT_BORDERS"), ("UNSTABLE_BUT_BORDERS", "UNSTABLE"), ("ASYMPTOTIC", "ASYMPTOTIC_BUT_STEADY"),
    # where cyclic coordinates drift, momenta that differ stay different: the motion tends to another steady one, too
    ("ASYMPTOTIC_BUT_STEADY", "ASYMPTOTIC_BUT_CYCLIC"),
]  # fmt: skip


def at_most(word: Word) -> set[Word]:
    """The word and all weaker ones."""
    found = {word}
    while more := {Word[weak] for strong, weak in STRONGER if Word[strong] in found} - found:
        found |= more
    return found


def test_the_table_covers_everything() -> None:
    every = [verdict_of(g, f, "T") for g, f in product(sets_of(Ground), sets_of(Flaw))]
    assert len(every) == 2 ** (len(Ground) + len(Flaw))
    assert {verdict.word for verdict in every} == {*Word}
    assert {row.word for row in LAW} == {*Word}
    for word, (grounds, flaws) in PLAIN.items():
        assert row_of(grounds, flaws).word is word


def test_a_verdict_is_what_its_grounds_say() -> None:
    with pytest.raises(ValueError, match="not the grounds of 'stable'"):
        Verdict(Word.STABLE, flaws=frozenset({Flaw.UNSTABLE}))
    with pytest.raises(ValueError, match="not the grounds of 'asymptotically stable'"):
        Verdict(Word.ASYMPTOTIC, grounds=())


@pytest.mark.parametrize("one_energy", [True, False])
@given(first=verdicts, second=verdicts, third=verdicts)
@settings(max_examples=400)
def test_combination_is_a_semilattice(one_energy: bool, first: Verdict, second: Verdict, third: Verdict) -> None:
    def both(*parts: Verdict) -> Verdict:
        return combine(parts, one_energy)

    assert both(first, second) == both(second, first)
    left, right = both(both(first, second), third), both(first, both(second, third))
    assert essence(left) == essence(right) == essence(both(first, second, third))
    assert left.theorems == right.theorems
    assert essence(both(first, first)) == essence(both(first, first, first))
    if one_energy:
        assert essence(both(first, first)) == essence(first)
    whole = both(first, second, third)
    for part in (first, second, third):  # no further ground, every flaw
        assert {*whole.laid} <= {*part.laid}
        assert whole.flawed >= part.flawed


@pytest.mark.parametrize("one_energy", [True, False])
def test_no_word_is_stronger_than_a_part(one_energy: bool) -> None:
    """All pairs of words; coasting, which says nothing that could be lost, changes no other word but by drift."""
    for first, second in product(Word, repeat=2):
        found = combine([Verdict(first), Verdict(second)], one_energy).word
        assert found in at_most(first) & at_most(second), (first, second, found)
    for word in Word:
        found = combine([coasting(), Verdict(word)], one_energy).word
        assert found in at_most(word)
        assert found not in (Word.ASYMPTOTIC, Word.STABLE)


def test_asymptotic_beside_merely_stable() -> None:
    """The whole is asymptotically stable only if all parts are, stable only if one energy covers them."""
    decaying = [Word.ASYMPTOTIC, Word.ASYMPTOTIC_BUT_CYCLIC, Word.ASYMPTOTIC_BUT_TURNED]
    lasting = [Word.STABLE, Word.STABLE_BUT_CYCLIC, Word.GYROSCOPIC]
    for one_energy, first, second in product([True, False], decaying, lasting):
        assert combine([Verdict(first), Verdict(second)], one_energy).word is Word.CRITICAL
    for first, second in product(decaying, repeat=2):
        assert combine([Verdict(first), Verdict(second)]).word is max(first, second, key=decaying.index)


# --- whole systems ---------------------------------------------------------------------------------------------------

CONSTANTS = fmpq_mpoly_ctx.get(["unused"])


@dataclass(frozen=True)
class Block:
    """Matrices of numbers; ``cyclic`` coordinates are those of zero rows in K and N."""

    M: list[list[int]]
    D: list[list[int]]
    G: list[list[int]]
    K: list[list[int]]
    N: list[list[int]]
    cyclic: tuple[int, ...] = ()

    @property
    def loses_energy(self) -> bool:
        """x'.D x' >= 0 for all x' and no circulation: of this linear system the energy does not grow."""
        d = self.D
        minors = [d[i][i] for i in range(len(d))] + ([d[0][0] * d[1][1] - d[0][1] ** 2] if len(d) > 1 else [])
        return all(x >= 0 for x in minors) and not any(map(any, self.N))

    def system(self, conservative: bool) -> LinearSystem:
        made = [tuple(tuple(CONSTANTS.constant(x) for x in row) for row in m) for m in self.matrices]
        return LinearSystem(made[0], made[1], made[2], made[3], made[4], conservative, self.cyclic)

    @property
    def matrices(self) -> tuple[list[list[int]], ...]:
        return self.M, self.D, self.G, self.K, self.N


small = st.integers(-2, 2)


@st.composite
def blocks(draw: Any) -> Block:
    n = draw(st.integers(1, 2))
    if n == 1:
        k, d = draw(st.integers(-1, 3)), draw(st.sampled_from([0, 0, 1, 2, -1]))
        cyclic = (0,) if k == 0 and draw(st.booleans()) else ()
        return Block([[draw(st.integers(1, 2))]], [[d]], [[0]], [[k]], [[0]], cyclic)
    k1, k2, k3 = draw(st.integers(-2, 4)), draw(small), draw(st.integers(-2, 4))
    g = draw(st.sampled_from([0, 0, 1, 3, 4]))
    n_ = draw(st.sampled_from([0, 0, 0, 1]))
    damping = draw(st.sampled_from([(0, 0, 0), (0, 0, 0), (1, 0, 0), (1, 0, 1), (1, -1, 1), (1, 0, -1), (2, 1, 1)]))
    d1, d2, d3 = damping
    cyclic: tuple[int, ...] = ()
    if draw(st.integers(0, 4)) == 0:
        k2 = k3 = n_ = 0
        cyclic = (1,)
    return Block(
        [[1, 0], [0, 1]], [[d1, d2], [d2, d3]], [[0, g], [-g, 0]], [[k1, k2], [k2, k3]], [[0, n_], [-n_, 0]], cyclic
    )


def whole(parts: list[Block]) -> Block:
    """The block-diagonal system."""
    size = sum(len(part.M) for part in parts)
    made = [[[0] * size for _ in range(size)] for _ in range(5)]
    cyclic, at = [], 0
    for part in parts:
        for target, source in zip(made, part.matrices, strict=True):
            for i, row in enumerate(source):
                target[at + i][at : at + len(row)] = row
        cyclic += [at + i for i in part.cyclic]
        at += len(part.M)
    return Block(made[0], made[1], made[2], made[3], made[4], tuple(cyclic))


@dataclass(frozen=True)
class Counted:
    """Roots to the right, to the left, on the axis but not zero, zero; whether those on the axis are semisimple."""

    right: int
    left: int
    axis: int
    zero: int
    semisimple: bool


def first_order(block: Block) -> fmpq_mat:
    n = len(block.M)
    inverse = fmpq_mat(n, n, [x for row in block.M for x in row]).inv()
    k, d = (
        inverse * fmpq_mat(n, n, [a + b for rows in zip(x, y, strict=True) for a, b in zip(*rows, strict=True)])
        for x, y in ((block.K, block.N), (block.D, block.G))
    )
    return fmpq_mat(
        [
            *([fmpq(int(j == n + i)) for j in range(2 * n)] for i in range(n)),
            *([-k[i, j] for j in range(n)] + [-d[i, j] for j in range(n)] for i in range(n)),
        ]
    )


def counted(block: Block) -> Counted:
    a = first_order(block)
    p = a.charpoly()
    zero = next(i for i, c in enumerate(p.coeffs()) if c != 0)
    p = fmpq_poly(p.coeffs()[zero:])
    # p(i w) = even(-w^2) + i w odd(-w^2): its real and imaginary part as polynomials in w.
    cs = p.coeffs()
    real = fmpq_poly([c * (-1) ** (i // 2) if i % 2 == 0 else 0 for i, c in enumerate(cs)])
    imaginary = fmpq_poly([c * (-1) ** (i // 2) if i % 2 else 0 for i, c in enumerate(cs)])
    common = real if imaginary == 0 else real.gcd(imaginary)
    axis = sum(m for root, m in common.numer().complex_roots() if root.imag == 0)
    right = sum(m for root, m in p.numer().complex_roots() if root.real > 0)
    left = sum(m for root, m in p.numer().complex_roots() if root.real < 0)
    assert right + left + axis == p.degree(), "the precision of the isolated roots does not suffice"
    semisimple = True
    for factor, multiplicity in p.factor()[1]:
        f = factor.coeffs()
        on_axis = all(c == 0 for c in f[1::2]) and any(
            root.real < 0 and root.imag == 0 for root, _ in fmpq_poly(f[::2]).numer().complex_roots()
        )
        if on_axis and multiplicity > 1:
            value = fmpq_mat(a.nrows(), a.ncols())
            for c in reversed(f):
                value = value * a
                for i in range(a.nrows()):
                    value[i, i] += c
            semisimple = semisimple and value.rref()[1] == a.nrows() - factor.degree() * multiplicity
    return Counted(right, left, axis, zero, semisimple)


DECAYING = (Word.ASYMPTOTIC, Word.ASYMPTOTIC_BUT_CYCLIC)
BOUNDED = (Word.STABLE, Word.STABLE_BUT_CYCLIC, Word.GYROSCOPIC, Word.CRITICAL)


@given(parts=st.lists(blocks(), min_size=1, max_size=3), known=st.booleans())
@settings(max_examples=300)
def test_combined_verdicts_against_counted_roots(parts: list[Block], known: bool) -> None:
    together = whole(parts)
    energy = known and all(part.loses_energy for part in parts)
    found = combine((verdict_at(part.system(energy), {}).verdict for part in parts), energy)
    roots = counted(together)
    event(found.word)
    assert (found.word is Word.UNSTABLE) == (roots.right > 0)
    assert found.word not in (Word.DEPENDS, Word.ASYMPTOTIC_BUT_TURNED)
    if found.word in DECAYING:
        assert roots.axis == 0
    if found.word is Word.ASYMPTOTIC:
        assert roots.zero == 0
    if not together.cyclic:
        assert (found.word is Word.ASYMPTOTIC) == (roots.left == 2 * len(together.M))
    if found.word in BOUNDED:
        assert roots.semisimple
        assert roots.zero == 0 or together.cyclic or found.word is Word.CRITICAL  # without blocks: as a simple pair
    if found.word in (Word.STABLE, Word.STABLE_BUT_CYCLIC):
        assert energy


#: K > 0 of which no energy is known, beside a part that gyroscopic forces stabilise.
LASTING = Block([[1]], [[0]], [[0]], [[1]], [[0]])
GYRO = Block([[1, 0], [0, 1]], [[0, 0], [0, 0]], [[0, 3], [-3, 0]], [[-1, 0], [0, -1]], [[0, 0], [0, 0]])


@example(parts=[LASTING, GYRO], known=False)
@given(parts=st.lists(blocks(), min_size=2, max_size=3), known=st.booleans())
@settings(max_examples=300)
def test_parts_and_whole_are_judged_alike(parts: list[Block], known: bool) -> None:
    """A block-diagonal system judged at once, without knowing that it splits."""
    assume(not any(part.cyclic for part in parts))
    energy = known and all(part.loses_energy for part in parts)
    found = combine((verdict_at(part.system(energy), {}).verdict for part in parts), energy)
    at_once = verdict_at(whole(parts).system(energy), {}).verdict
    event(found.word)
    assert found.word is at_once.word
    if found.word in (Word.ASYMPTOTIC, Word.STABLE):
        assert found.theorem


def test_a_planted_lie_is_caught() -> None:
    """The counts tell the truth where the law would be broken by a word."""
    damped, lasting = Block([[1]], [[1]], [[0]], [[1]], [[0]]), Block([[1]], [[0]], [[0]], [[2]], [[0]])
    roots = counted(whole([damped, lasting]))
    assert (roots.left, roots.axis, roots.right, roots.zero, roots.semisimple) == (2, 2, 0, 0, True)
    assert combine([Verdict(Word.ASYMPTOTIC), Verdict(Word.STABLE)]).word is Word.CRITICAL
    assert counted(whole([lasting, lasting])) == Counted(0, 0, 4, 0, True)
    double = Block([[1, 0], [0, 1]], [[0, 0], [0, 0]], [[0, 2], [-2, 0]], [[-1, 0], [0, -1]], [[0, 0], [0, 0]])
    assert counted(double) == Counted(0, 0, 4, 0, False)  # (lambda^2 + 1)^2 with one Jordan block for each root


# --- descriptions ----------------------------------------------------------------------------------------------------


def test_a_nutation_damper_beside_an_undamped_mass() -> None:
    found = mbsym.load(STATEMENTS / "damper-beside-undamped-mass.yaml").stability
    assert [part.theory.at_point.verdict.word for part in found.subsystems if part.theory.at_point] == [
        Word.STABLE_BUT_CYCLIC,
        Word.ASYMPTOTIC_BUT_TURNED,
        Word.STABLE,
    ]
    assert found.numerical is not None
    assert (found.numerical.word, found.numerical.theorem) == (Word.CRITICAL, "")


MASSES = """
mbsym: 1
name: Two masses, one of them damped
parameters: {{m: positive, k1: positive, k2: positive, b: positive}}
bodies:
  - {{name: one, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}}
  - {{name: two, attached to: 0, connection point: [0, y, 0], mass: m, coordinates: [y]}}
loads:
  - spring: {{coordinate: x, stiffness: k1}}
  - spring: {{coordinate: y, stiffness: k2}}
  - damper: {{coordinate: y, coefficient: b}}
{more}
motion: {{x: 0, y: 0}}
values: {{m: 1, k1: 2, k2: 3, b: 1}}
"""


def test_one_energy_covers_a_damped_and_an_undamped_mass() -> None:
    """E = (m x'^2 + m y'^2 + k1 x^2 + k2 y^2)/2, dE/dt = -b y'^2."""
    found = mbsym.loads(MASSES.format(more="")).stability
    assert found.numerical is not None
    for verdict in (found.verdict, found.numerical):
        assert (verdict.word, verdict.theorem) == ("stable", "Lagrange-Dirichlet")
    assert [part.theory.verdict.word for part in found.subsystems] == ["stable", "asymptotically stable"]


def test_without_a_known_energy_nothing_covers_both() -> None:
    """The force x_dot^3 drives what friction would brake: dE/dt = x_dot^4 - b y_dot^2."""
    found = mbsym.loads(MASSES.format(more="  - generalized force: {x: x_dot**3}"))
    assert found.stability.verdict.word is Word.CRITICAL


def test_asymptotic_at_given_momenta_only() -> None:
    """A damped pendulum that turns: theta'' + theta' - phi' + 2 theta = 0 and phi' + theta = p, which stays as it is.

    With another p, theta tends to another value: the sentence may not say that all velocities come back.
    """
    given = Block([[1, 0], [0, 1]], [[1, 0], [0, 0]], [[0, -1], [1, 0]], [[2, 0], [0, 0]], [[0, 0], [0, 0]], (1,))
    found = verdict_at(given.system(True), {}).verdict
    assert (found.word, found.theorem) == (Word.ASYMPTOTIC_BUT_CYCLIC, "Kelvin-Chetaev")
    assert "at the given momenta" in found.explanation
    assert "all velocities" not in found.explanation
    braked = Block([[1]], [[1]], [[0]], [[0]], [[0]], (0,))  # phi'' + phi' = 0: this velocity does come back
    assert "all velocities" in verdict_at(braked.system(True), {}).verdict.explanation


def test_what_is_said_of_k_and_d_of_a_part_is_not_said_of_the_whole() -> None:
    """Two pendulums that stand upright: of each det K = -m g l < 0, of both together det K > 0.  A damped one upright
    beside one without damping that hangs: there is no complete dissipation."""
    upright = """
mbsym: 1
name: upright
parameters: {m: positive, l: positive, g: positive}
bodies:
  - {name: a, rotation: {axes: [3], angles: [q]}, mass centre: [0, l, 0], mass: m}
  - {name: b, attached to: 0, rotation: {axes: [3], angles: [r]}, mass centre: [0, l, 0], mass: m}
loads:
  - uniform gravity: {vector: [0, -g, 0]}
motion: {}
values: {m: 1, l: 1, g: 1}
"""
    both = mbsym.loads(upright).stability
    assert "det K < 0" in both.subsystems[0].theory.at_point.verdict.explanation
    assert both.numerical is not None
    assert "det K" not in both.numerical.explanation
    damped = mbsym.loads(
        upright.replace("motion: {}", "  - damper: {coordinate: q, coefficient: 1}\nmotion: {r: pi}")
    ).stability
    assert "Complete dissipation" in damped.subsystems[0].theory.at_point.verdict.explanation
    assert damped.numerical is not None
    assert "Complete dissipation" not in damped.numerical.explanation


_TWO_ON_A_LINE = """
mbsym: 1
name: two on a line
parameters: {k: positive, m: positive}
bodies:
  - {name: a, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}
  - {name: b, attached to: 0, connection point: [y, 0, 0], mass: m, coordinates: [y]}
loads:
  - potential: LOAD
motion: {}
values: {k: 1, m: 1}
"""


@pytest.mark.parametrize(
    ("load", "unsaid"),
    [
        ("k*(x - y)**2/2 + k*(x - y)**4", "K > 0: "),  # K = k [[1, -1], [-1, 1]]
        (
            "k*(x - y)**2/2 + k*(x - y)**4\n  - rayleigh: (x_dot - y_dot)**2/2",
            "K > 0 and complete",
        ),  # D = [[1, -1], [-1, 1]]
    ],
)
def test_k_is_not_called_positive_where_a_displacement_changes_nothing(load: str, unsaid: str) -> None:
    """V and R are constant along (1, 1): det K = det D = 0, and V has a strict minimum but for that displacement."""
    found = mbsym.loads(_TWO_ON_A_LINE.replace("LOAD", load)).stability
    for verdict in (found.verdict, found.numerical):
        assert verdict is not None
        said = verdict.explanation.replace("$", "")
        assert "Without the cyclic coordinates K > 0" in said
        assert not any(sentence.startswith(unsaid) for sentence in said.split(". "))
