"""What problem 11 says of descriptions and of normal forms made by hand; and where it has to say nothing."""

from __future__ import annotations

from dataclasses import replace

import pytest
from conftest import SHIPPED
from flint import acb, arb, ctx, fmpq, fmpq_poly

import mbsym
from mbsym.algebra.tower import Tower
from mbsym.algebra.truncated import Space, Truncated
from mbsym.analysis.stages import Unavailable
from mbsym.problems.normal_forms.exact import Resonant
from mbsym.problems.normal_forms.result import Focus, Judged, Outcome, Theorem, Why
from mbsym.problems.normal_forms.twist import judged, vectors
from mbsym.report.words.normal_form_words import sentences

ONE_COORDINATE = """
mbsym: 1
name: one coordinate
parameters: {{w: {{sign: positive}}}}
bodies:
  - {{name: slider, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}}
loads:
  - {{potential: {potential}}}
  - {{generalized force: {{x: {force}}}}}
motion: {{x: 0}}
values: {{w: 2}}
"""


def one_coordinate(force: str, potential: str = "w**2*x**2/2") -> mbsym.Analysis:
    return mbsym.loads(ONE_COORDINATE.format(force=force, potential=potential))


# --- Hamiltonians by hand: H = Omega_1 I_1 + Omega_2 I_2 + ..., I = (x^2 + p^2)/2 ---


def judged_by_hand(omega: tuple[int, int], further: str) -> tuple[Outcome, Theorem]:
    """``further``: terms in x, y, px, py, i, j (the actions)."""

    def lowered(order: int) -> Truncated:
        space = Space(4, order, acb(0), acb(1))
        x, y, px, py = map(space.variable, range(4))
        half = acb("0.5")
        i, j = (x * x + px * px).scaled(half), (y * y + py * py).scaled(half)
        names = {"x": x, "y": y, "px": px, "py": py, "i": i, "j": j, "c": lambda a, b: a.scaled(acb(b))}
        return i.scaled(acb(omega[0])) + j.scaled(acb(omega[1])) + eval(further, names)

    def resonant(vector: tuple[int, ...], found: object) -> bool:
        return sum(k * abs(w) for k, w in zip(vector, sorted(omega, key=abs, reverse=True), strict=True)) == 0

    with ctx.workprec(200):
        found = judged(lowered, resonant)
    return found.outcome, found.theorem


@pytest.mark.parametrize(
    ("omega", "further", "outcome", "theorem"),
    [
        ((1, 3), "i*i", Outcome.STABLE, Theorem.DEFINITE),
        # H_4(Omega_2, -Omega_1) = (7, 5): a 49 + b 35 + c 25
        ((5, -7), "i*i", Outcome.STABLE, Theorem.ARNOLD_MOSER),
        ((5, -7), "c(i*i, 25) - c(j*j, 49)", Outcome.UNDECIDED, Theorem.NONE),
        ((5, -7), "c(i*i, 25) - c(j*j, 49) + i*i*i", Outcome.STABLE, Theorem.ARNOLD_MOSER_6),
        # the cubic term x y^2 of frequencies 2 and -1 is resonant, x^3 is not
        ((2, -1), "x*y*y", Outcome.UNSTABLE, Theorem.THIRD),
        ((2, -1), "i*i", Outcome.STABLE, Theorem.ARNOLD_MOSER),
        # x y^3: with x = sqrt(2 I_1) cos a, y = sqrt(2 I_2) cos b its resonant part is sqrt(I_1 I_2^3)/2 cos(a + 3 b):
        # on I = t (1, 3) it is t^2 sqrt(27)/2 = 2.598 t^2 cos psi against A t^2 of A I_1^2
        ((3, -1), "x*y*y*y + c(i*i, 2.59)", Outcome.UNSTABLE, Theorem.FOURTH),
        ((3, -1), "x*y*y*y + c(i*i, 2.61)", Outcome.STABLE, Theorem.FOURTH),
        ((3, -1), "x*y*y*y + c(i*i, -2.61)", Outcome.STABLE, Theorem.FOURTH),
    ],
)
def test_theorems_of_two_frequencies(omega: tuple[int, int], further: str, outcome: Outcome, theorem: Theorem) -> None:
    assert judged_by_hand(omega, further) == (outcome, theorem)


@pytest.mark.parametrize(
    ("omega", "further", "outcome", "theorem"),
    [
        # no resonance up to order 4; the cone of actions 7 I - 11 J + 19 K = 0 is spanned by (11, 7, 0) and (0, 19, 11)
        ((7, -11, 19), "i*i + j*j + k*k", Outcome.FORMAL, Theorem.BRUNO),
        (
            (7, -11, 19),
            "i*i - j*j + k*k",
            Outcome.MOST,
            Theorem.ARNOLD,
        ),  # zero in the cone: 121 - 49 > 0, 121 - 361 < 0
        ((7, -11, 19), "i*i - i*i", Outcome.UNDECIDED, Theorem.NONE),
        ((1, -2, 5), "i*i + j*j + k*k", Outcome.UNDECIDED, Theorem.NONE),  # 2 w1 = w2
        ((1, 2, 5), "i*i", Outcome.STABLE, Theorem.DEFINITE),
    ],
)
def test_three_frequencies(omega: tuple[int, int, int], further: str, outcome: Outcome, theorem: Theorem) -> None:
    def lowered(order: int) -> Truncated:
        space = Space(6, order, acb(0), acb(1))
        x = list(map(space.variable, range(6)))
        i, j, k = ((x[n] * x[n] + x[3 + n] * x[3 + n]).scaled(acb("0.5")) for n in range(3))
        whole = eval(further, {"i": i, "j": j, "k": k})
        for action, frequency in zip((i, j, k), omega, strict=True):
            whole = whole + action.scaled(acb(frequency))
        return whole

    def resonant(vector: tuple[int, ...], found: object) -> bool:
        return sum(k * w for k, w in zip(vector, sorted(map(abs, omega), reverse=True), strict=True)) == 0

    with ctx.workprec(200):
        found = judged(lowered, resonant)
    assert (found.outcome, found.theorem) == (outcome, theorem)


def test_vectors_are_primitive_and_told_once() -> None:
    assert set(vectors(2, 3)) == {(1, 2), (2, 1), (1, -2), (2, -1)}


# --- descriptions ---


def test_triangular_points() -> None:
    analysis = mbsym.load(SHIPPED / "three-bodies.yaml")
    found = analysis.normal_forms
    assert (found.at_values.outcome, found.at_values.theorem) == (Outcome.STABLE, Theorem.ARNOLD_MOSER)
    assert found.first.value == "gyroscopically stabilised only"
    check = analysis.check("normal forms")
    assert check is not None
    assert not check.failed


def test_a_wrong_formula_is_found() -> None:
    analysis = mbsym.load(SHIPPED / "three-bodies.yaml")
    with analysis.unvouched():
        found = analysis.normal_forms
    wrong = replace(found, in_symbols=replace(found.in_symbols, determinant=found.in_symbols.trace))
    analysis._stages["normal_forms"] = replace(analysis._stages["normal_forms"], value=wrong)
    check = analysis.check("normal forms")
    assert check is not None
    assert check.failed
    with pytest.raises(Unavailable, match="normal forms"):
        analysis.normal_forms  # noqa: B018


def test_the_sleeping_top_by_arnold_and_moser() -> None:
    """Omega_1 = (C W + sqrt(C^2 W^2 - 4 A m g l))/(2 A), Omega_2 = (C W - sqrt(...))/(2 A), the latter's energy < 0.

    With symmetry nothing resonates: cubic terms vanish, and H_4 is a function of the actions.
    """
    found = mbsym.load(SHIPPED / "heavy-top.yaml").normal_forms
    assert found.cyclic == ("phi",)
    assert found.at_values.theorem is Theorem.ARNOLD_MOSER
    one, other = found.at_values.frequencies
    assert one > 0
    assert other < 0


TABLE = """
mbsym: 1
name: particle on a turning table
parameters: {m: positive, a: real}
prescribed: {psi: 3/2}
bodies:
  - {name: table, attached to: 0, rotation: {axes: [3], angles: [psi]}, mass: 0}
  - {name: particle, attached to: table, connection point: [x, y, 0], coordinates: [x, y], mass: m}
loads:
  - potential: a*(x**2 + y**2)/2 + HIGHER
motion: {x: 0, y: 0}
values: {m: 1, a: 1/4}
"""


@pytest.mark.parametrize(
    ("higher", "outcome", "theorem", "told"),
    [
        # z'' + 3 i z' - 2 z = 0 has z = A e^(-i t) + B e^(-2 i t): x^3 holds z^2 conj(z), and that A^2 conj(B).
        ("x**3", Outcome.UNSTABLE, Theorem.THIRD, "resonant term of third order is not zero"),
        # Re z^3 holds no such term; that it cancels is seen exactly.
        ("x**3 - 3*x*y**2", Outcome.STABLE, Theorem.ARNOLD_MOSER, "leave are exactly zero"),
        ("x**3 - (3 + 1/10**40)*x*y**2", Outcome.UNSTABLE, Theorem.THIRD, "resonant term of third order is not zero"),
        ("(x**2 + y**2)**2", Outcome.STABLE, Theorem.ARNOLD_MOSER, "leave are exactly zero"),
    ],
)
def test_two_to_one_with_its_term_and_without(higher: str, outcome: Outcome, theorem: Theorem, told: str) -> None:
    found = mbsym.loads(TABLE.replace("HIGHER", higher), (11,)).normal_forms
    assert (found.at_values.outcome, found.at_values.theorem) == (outcome, theorem)
    assert [one.order for one in found.at_values.resonances] == [3]
    said = " ".join(one.text for one in sentences(found))
    assert told in said
    assert "No resonance" not in said


@pytest.mark.parametrize(
    ("further", "outcome", "theorem"),
    [
        ("0", Outcome.STABLE, Theorem.ARNOLD_MOSER),
        ("x**3/10**30", Outcome.UNSTABLE, Theorem.THIRD),
        ("-x**3/10**30", Outcome.UNSTABLE, Theorem.THIRD),
    ],
)
def test_two_to_one_with_irrational_frequencies(further: str, outcome: Outcome, theorem: Theorem) -> None:
    """U = -x^2/5 - 4 y^2/5 + a x^3 + x y^2 on a table that turns at 1: squares 8/5 and 2/5, energies + and -.

    By hand: (W^2 - k1) x = -2 i W y, so that y = i e x with e = (W^2 - k1)/(2 W), k1 = -2/5; the term of z1 z2^2 in U
    is 3 a - e2^2 - 2 e1 e2 for W1 = -2 W2, and e2^2 = 2/5, e1 e2 = -1/2: it is zero where a = -1/5.
    """
    potential = f"(x**2 + y**2)/2 - x**2/5 - 4*y**2/5 - x**3/5 + x*y**2 + {further}"
    text = TABLE.replace("psi: 3/2", "psi: 1").replace("a*(x**2 + y**2)/2 + HIGHER", potential)
    found = mbsym.loads(text, (11,)).normal_forms.at_values
    assert (found.outcome, found.theorem) == (outcome, theorem)


def three(*squares: int, cubic: str) -> Judged:
    """Frequencies with the squares and the signs of ``squares``."""
    polynomial = fmpq_poly([1])
    for square in squares:
        polynomial *= fmpq_poly([abs(square), 1])
    with ctx.workprec(200):
        return of_three([acb(abs(x)).sqrt() * (1 if x > 0 else -1) for x in squares], polynomial, cubic)


def of_three(omega: list[acb], polynomial: fmpq_poly, cubic: str) -> Judged:
    """H = sum W_k (x_k^2 + p_k^2)/2 + cubic terms; ``polynomial`` has the roots -W_k^2."""
    space = Space(6, 4, acb(0), acb(1))
    variables = [space.variable(k) for k in range(6)]
    whole = space.nothing
    for w, x, p in zip(omega, variables[:3], variables[3:], strict=True):
        whole = whole + (x * x + p * p).scaled(w / 2)
    names = {f"{letter}{k + 1}": variables[k + shift] for letter, shift in (("x", 0), ("p", 3)) for k in range(3)}
    whole = whole + eval(cubic, names)
    tower = Tower()
    return judged(lambda _: whole, Resonant(tower, [tower.element(fmpq(c)) for c in polynomial.coeffs()]))


@pytest.mark.parametrize(
    ("squares", "cubic", "outcome", "theorem"),
    [
        # 5 - 2 - 3 = 0 with energies that let all three grow: dI1 = dI2 = dI3
        ((25, -4, -9), "x1*x2*x3", Outcome.UNSTABLE, Theorem.THIRD_OF_MORE),
        ((-25, 4, 9), "x1*x2*x3", Outcome.UNSTABLE, Theorem.THIRD_OF_MORE),
        # what one gains the others lose: Omega.I alone bounds nothing, and nothing is said
        ((25, -4, 9), "x1*x2*x3", Outcome.UNDECIDED, Theorem.NONE),
        ((25, -4, -9), "x1*x1*x3", Outcome.UNDECIDED, Theorem.NONE),  # no resonant term
        # 2 : 1 beside a third frequency
        ((4, -1, 7), "x1*x2*x2 + x3*x3*x3", Outcome.UNSTABLE, Theorem.THIRD_OF_MORE),
        ((4, 1, -7), "x1*x2*x2", Outcome.UNDECIDED, Theorem.NONE),
        # two resonances of third order: 3 = 1 + 2 and 2 = 1 + 1
        ((9, -1, -4), "x1*x2*x3", Outcome.UNDECIDED, Theorem.NONE),
        ((4, 1, 7), "x1*x2*x2", Outcome.STABLE, Theorem.DEFINITE),
    ],
)
def test_one_resonance_of_third_order_of_three_frequencies(
    squares: tuple[int, ...], cubic: str, outcome: Outcome, theorem: Theorem
) -> None:
    found = three(*squares, cubic=cubic)
    assert (found.outcome, found.theorem) == (outcome, theorem)
    assert found.why is (Why.RESONANCE if outcome is Outcome.UNDECIDED else Why.NONE)


@pytest.mark.parametrize(
    ("last", "outcome", "theorem", "why"),
    [
        (-1, Outcome.UNSTABLE, Theorem.THIRD_OF_MORE, Why.NONE),
        (-2, Outcome.UNDECIDED, Theorem.NONE, Why.RESONANCE_OPEN),
    ],
)
def test_a_sum_of_irrational_frequencies(last: int, outcome: Outcome, theorem: Theorem, why: Why) -> None:
    """2 cos(pi/9), 2 cos(2 pi/9), 2 cos(4 pi/9) are the sizes of the roots of t^3 - 3 t + 1, whose sum is zero.

    By t^2 (t^2 - 3)^2 = 1 their squares are the roots of z^3 - 6 z^2 + 9 z - 1.  With a wrong coefficient it is not
    affirmed that the first is the sum of the others, and enclosures alone do not say it.
    """
    with ctx.workprec(200):
        one, two, four = (acb(2 * (arb(k) / 9).cos_pi()) for k in (1, 2, 4))
        found = of_three([one, -two, -four], fmpq_poly([1, 9 + (last + 1), 6, 1]), "x1*x2*x3")
    assert (found.outcome, found.theorem, found.why) == (outcome, theorem, why)


def test_equal_frequencies_of_three_are_refused_by_name() -> None:
    found = three(4, -4, 7, cubic="x1*x2*x2")
    assert (found.outcome, found.why) == (Outcome.UNDECIDED, Why.EQUAL_MORE)


@pytest.mark.parametrize(
    ("force", "coefficient"), [("-x_dot**3", "-3*w**2/8"), ("x_dot**3", "3*w**2/8"), ("-x**2*x_dot", "-1/8")]
)
def test_guckenheimer_and_holmes_from_descriptions(force: str, coefficient: str) -> None:
    """(3.4.11): x'' + x'^3 + w^2 x, the other sign, x'' + x^2 x' + w^2 x."""
    analysis = one_coordinate(force)
    found = analysis.normal_forms
    assert isinstance(found.in_symbols, Focus)
    assert str(found.in_symbols.coefficient) == coefficient
    soft = coefficient.startswith("-")
    assert found.at_values.outcome is (Outcome.ASYMPTOTIC if soft else Outcome.UNSTABLE)
    assert str(found.at_values.coefficient) == {"-3*w**2/8": "-3/2", "3*w**2/8": "3/2", "-1/8": "-1/8"}[coefficient]


def test_duffing_terms_count_beside_van_der_pol() -> None:
    """x'' + w^2 x + x^2 + x x' = 0:  a = 1/(8 w^2), by hand from (3.4.11).

    With X = x, Y = -x'/w:  X' = -w Y, Y' = w X + g, g = (X^2 - w X Y)/w;  a = -g_XY (g_XX + g_YY)/(16 w), in which
    g_XY = -1, g_XX = 2/w, g_YY = 0.
    """
    found = one_coordinate("-x**2 - x*x_dot").normal_forms
    assert str(found.at_values.coefficient) == "1/32"


@pytest.mark.parametrize(
    ("force", "potential", "why"),
    [
        ("x_dot**7", "w**2*x**2/2", Why.COEFFICIENT_OPEN),  # unstable, and terms up to fifth order do not see it
        ("-x_dot**7", "w**2*x**2/2", Why.COEFFICIENT_OPEN),
        ("0", "x**8", Why.ZERO_OPEN),  # x is not cyclic although terms up to sixth order do not hold it
        ("-x_dot**3", "x**4", Why.TWO_ZERO_ROOTS),
    ],
)
def test_what_higher_terms_than_these_decide_is_undecided(force: str, potential: str, why: Why) -> None:
    found = one_coordinate(force, potential).normal_forms
    assert (found.at_values.outcome, found.at_values.why) == (Outcome.UNDECIDED, why)
    assert found.cyclic == ()


@pytest.mark.parametrize(
    ("force", "potential", "outcome"),
    [
        ("-x_dot", "x**4", Outcome.ASYMPTOTIC),
        ("-x_dot", "-x**4", Outcome.UNSTABLE),
        ("-x_dot", "x**3", Outcome.UNSTABLE),
        ("-x_dot", "x**2", Outcome.ASYMPTOTIC),
        ("x_dot", "x**2", Outcome.UNSTABLE),
    ],
)
def test_one_zero_root(force: str, potential: str, outcome: Outcome) -> None:
    """x'' + x' + V'(x) = 0: on the centre manifold x' = -V'(x) + ..."""
    assert one_coordinate(force, potential).normal_forms.at_values.outcome is outcome


def test_constraints_and_given_matrices_are_refused() -> None:
    for name in ("rolling-disc", "triangular-points"):
        with pytest.raises(Unavailable):
            mbsym.load(SHIPPED / f"{name}.yaml").normal_forms  # noqa: B018


def test_more_degrees_of_freedom_are_never_said_to_be_stable_where_energy_is_not_definite() -> None:
    """DeBra-Delp: a satellite that gyroscopic forces hold up, three frequencies of different signs."""
    text = (SHIPPED / "gravity-gradient.yaml").read_text(encoding="utf-8")
    found = mbsym.loads(text).normal_forms
    assert found.at_values.theorem is Theorem.DEFINITE


def test_enclosures_decide_nothing_by_their_middle() -> None:
    """Frequencies as wide balls: a ratio that may be 2 is no resonance and no absence of one."""

    def lowered(order: int) -> Truncated:
        space = Space(4, order, acb(0), acb(1))
        x, y, px, py = map(space.variable, range(4))
        wide = acb(arb(2, "1e-60")) / 2
        return (x * x + px * px).scaled(wide) - (y * y + py * py).scaled(acb("0.5")) + x * y * y

    with ctx.workprec(200):
        found = judged(lowered, lambda k, w: None if (k[0] * w[0] + k[1] * w[1]).contains(0) else False)
    assert (found.outcome, found.why) == (Outcome.UNDECIDED, Why.RESONANCE_OPEN)
