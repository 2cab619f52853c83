"""Equal frequencies and zero ones: Hamiltonians by hand, in canonical coordinates that are no normal ones."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import pytest
from conftest import SHIPPED
from flint import acb, arb, ctx

import mbsym
from mbsym.algebra.truncated import Space, Truncated
from mbsym.analysis.judge import exceptional
from mbsym.problems.normal_forms import equal, zero_root
from mbsym.problems.normal_forms.equal import equal_frequencies
from mbsym.problems.normal_forms.result import Judged, Outcome, Theorem, Why
from mbsym.problems.normal_forms.twist import NotVerified
from mbsym.report.words.exceptional_values import lines

HALF = acb("0.5")


def by_hand(text: str, order: int = 4, mixed: bool = False) -> Truncated:
    """A Hamiltonian in x, y, px, py and the actions i, j; ``mixed``: canonical coordinates that mix all of them.

    x = X + 2 Y, y = Y, px = PX, py = PY - 2 PX; then px = PX + 3 X, py = PY - Y^2: both canonical.
    """
    space = Space(4, order, acb(0), acb(1))
    x, y, px, py = map(space.variable, range(4))
    if mixed:
        px, py = px + x.scaled(acb(3)), py - y * y
        x, y, px, py = x + y.scaled(acb(2)), y, px, py - px.scaled(acb(2))
    i, j = (x * x + px * px).scaled(HALF), (y * y + py * py).scaled(HALF)
    names = {"x": x, "y": y, "px": px, "py": py, "i": i, "j": j, "c": lambda a, b: a.scaled(acb(b))}
    names["k"] = x * y - px * py  # 2 sqrt(I_1 I_2) cos(f_1 + f_2)
    found: Truncated = eval(text, names)
    return found


# --- equal frequencies ---

#: w = 1, delta = 1: Sokolskii's normal form.
SOKOLSKII = "x*py - y*px + c(x*x + y*y, 0.5) + c((px*px + py*py)*(px*px + py*py), {})"


@pytest.mark.parametrize("mixed", [False, True])
@pytest.mark.parametrize(("sign", "outcome"), [(2, Outcome.STABLE), (-2, Outcome.UNSTABLE)])
def test_one_eigenvector(sign: int, outcome: Outcome, mixed: bool) -> None:
    """delta A is A, whatever the canonical coordinates are."""
    with ctx.workprec(200):
        found = equal_frequencies(by_hand(SOKOLSKII.format(sign), mixed=mixed))
        assert (found.outcome, found.theorem) == (outcome, Theorem.EQUAL)
        assert found.coefficient.overlaps(arb(sign))
        assert found.coefficient.rad() < 1e-20


def test_one_eigenvector_with_cubic_terms_that_decide() -> None:
    """H_3 = y^3 adds to A; the amplitude equation has to find the same, or NotVerified is raised."""
    with ctx.workprec(200):
        plain = equal_frequencies(by_hand(SOKOLSKII.format(1)))
        bent = equal_frequencies(by_hand(SOKOLSKII.format(1) + " + py*py*py"))
    assert not plain.coefficient.overlaps(bent.coefficient)


def test_a_vanishing_coefficient_is_left_open() -> None:
    with ctx.workprec(200):
        found = equal_frequencies(by_hand(SOKOLSKII.format(0), mixed=True))
    assert (found.outcome, found.why) == (Outcome.UNDECIDED, Why.EQUAL_FREQUENCIES)


@pytest.mark.parametrize("planted", ["normal form", "amplitudes"])
def test_a_planted_mistake_of_either_route_is_caught(monkeypatch: pytest.MonkeyPatch, planted: str) -> None:
    if planted == "amplitudes":
        whole = equal.on_double_pair
        monkeypatch.setattr(equal, "on_double_pair", lambda *a: whole(*a) * 2)
    else:
        formed = equal.on_double_root

        def wrong(*a: object) -> object:
            form, e = formed(*a)
            form.hamiltonian.coefficients[2, 0, 0, 2] *= 2
            return form, e

        monkeypatch.setattr(equal, "on_double_root", wrong)
    with ctx.workprec(200), pytest.raises(NotVerified):
        equal_frequencies(by_hand(SOKOLSKII.format(1)))


def test_the_triangular_points_at_rouths_value() -> None:
    """A = 59/864: D. S. Schmidt, Versal normal form of the restricted problem of three bodies near L4 (1995)."""
    analysis = mbsym.load(SHIPPED / "three-bodies.yaml")
    found = exceptional(analysis, "mu", (Fraction(3, 100), Fraction(1, 2)), dict.fromkeys(("a", "n", "m"), Fraction(1)))
    (routh,) = found.specials
    assert (routh.judged.outcome, routh.judged.theorem) == (Outcome.STABLE, Theorem.EQUAL)
    assert routh.judged.coefficient.overlaps(arb(59) / 864)
    assert routh.judged.coefficient.rad() < 1e-20
    assert any("delta A = 0.06828703704" in line for line in lines(found))


@pytest.mark.parametrize("mixed", [False, True])
@pytest.mark.parametrize(
    ("further", "outcome"),
    [
        # on I_1 = I_2 = I: i = j = I, k = 2 I cos f
        ("k*i", Outcome.UNSTABLE),
        ("i*i", Outcome.STABLE),
        ("k*i + c(i*j, 2.01)", Outcome.STABLE),
        ("k*i - c(i*j, 2.01)", Outcome.STABLE),
        ("k*i + c(i*j, 1.99)", Outcome.UNSTABLE),
        ("k*i + c(i*j, 2)", Outcome.UNDECIDED),  # 2 (1 + cos f): a double zero
        ("k*k", Outcome.UNDECIDED),
        ("k*k + j*j", Outcome.STABLE),
        ("k*k - j*j", Outcome.UNSTABLE),
        ("i*i - j*j", Outcome.UNDECIDED),  # zero on the cone
        ("px*px*px", Outcome.STABLE),  # of x alone: -15/4 I_1^2, by Lindstedt
    ],
)
def test_two_eigenvectors(further: str, outcome: Outcome, mixed: bool) -> None:
    with ctx.workprec(200):
        found = equal_frequencies(by_hand("i - j + " + further, mixed=mixed), two_eigenvectors=True)
    assert found.outcome is outcome
    assert found.theorem is (Theorem.NONE if outcome is Outcome.UNDECIDED else Theorem.EQUAL_TWO)
    assert found.why is (Why.CONE_OPEN if outcome is Outcome.UNDECIDED else Why.NONE)


@pytest.mark.parametrize("planted", ["weights", "a term of P", "a resonance is forgotten", "averages"])
def test_a_planted_mistake_with_two_eigenvectors_is_caught(monkeypatch: pytest.MonkeyPatch, planted: str) -> None:
    """k i + 1.99 i j is unstable on the cone, k i + 2.01 i j stable: a mistake of one in a hundred decides wrongly."""
    cone, formed, mean = equal._on_the_cone, equal.normal_form, equal.averaged

    def one_term(*a: object) -> list[acb]:
        found = cone(*a)
        return [*found[:2], found[2] * acb("1.01"), *found[3:]]

    wrong: dict[str, tuple[str, Callable[..., object]]] = {
        "weights": ("_on_the_cone", lambda form, d: cone(form, [d[0], d[1] * 2])),
        "a term of P": ("_on_the_cone", one_term),
        "a resonance is forgotten": ("normal_form", lambda h, l, i, kept, s: formed(h, l, i, kept[::3], s)),
        "averages": ("averaged", lambda *a: mean(*a).scaled(acb("1.01"))),
    }
    with ctx.workprec(200):
        whole = by_hand("i - j + k*i + c(i*j, 1.99) + px*px*px", mixed=True)
        monkeypatch.setattr(equal, *wrong[planted])
        with pytest.raises(NotVerified):
            equal_frequencies(whole, two_eigenvectors=True)


def test_definite_energy_needs_no_normal_form() -> None:
    with ctx.workprec(200):
        assert equal_frequencies(by_hand("i + j + k*i"), two_eigenvectors=True).theorem is Theorem.DEFINITE


def test_equal_real_roots_are_unstable() -> None:
    with ctx.workprec(200):
        found = equal_frequencies(by_hand("x*px + y*py + x*py"))
    assert (found.outcome, found.theorem) == (Outcome.UNSTABLE, Theorem.FIRST)


# --- a zero root ---


def with_zero_root(text: str, mixed: bool = False) -> Judged:
    with ctx.workprec(200):
        whole = by_hand(text, 6, mixed)
        return zero_root.zero_root(whole, whole, zero_root.BALLS, ("x", "y", "p_x", "p_y"))


@pytest.mark.parametrize(
    ("text", "outcome", "theorem", "degree"),
    [
        # a minimum, a maximum
        ("c(px*px, 0.5) + j + x*x*x*x", Outcome.STABLE, Theorem.DEFINITE_HIGHER, 4),
        ("c(px*px, -0.5) - j - x*x*x*x", Outcome.STABLE, Theorem.DEFINITE_HIGHER, 4),
        # Sokolskii: delta a > 0 with the other oscillation of the other sign
        ("c(px*px, 0.5) - j + x*x*x*x", Outcome.STABLE, Theorem.ZERO, 4),
        ("c(px*px, -0.5) + j - x*x*x*x*x*x", Outcome.STABLE, Theorem.ZERO, 6),
        ("c(px*px, 0.5) + j - x*x*x*x", Outcome.UNSTABLE, Theorem.ZERO, 4),
        ("c(px*px, -0.5) + j + x*x*x*x", Outcome.UNSTABLE, Theorem.ZERO, 4),
        ("c(px*px, 0.5) - j + x*x*x", Outcome.UNSTABLE, Theorem.ZERO, 3),
        ("c(px*px, 0.5) - j + x*x*x*x*x", Outcome.UNSTABLE, Theorem.ZERO, 5),
        # V = x^4 + y^2/2 - 3/2 x^2 y: with y = 3/2 x^2 it is x^4 - 9/8 x^4
        ("c(px*px, 0.5) + j + x*x*x*x - c(x*x*y, 1.5)", Outcome.UNSTABLE, Theorem.ZERO, 4),
        ("c(px*px, 0.5) + j + x*x*x*x - c(x*x*y, 1.4)", Outcome.STABLE, Theorem.DEFINITE_HIGHER, 4),
        # a growing root beside
        ("c(px*px, 0.5) + y*py + x*x*x*x", Outcome.UNSTABLE, Theorem.FIRST, None),
    ],
)
def test_a_zero_root(text: str, outcome: Outcome, theorem: Theorem, degree: int | None) -> None:
    found = with_zero_root(text)
    assert (found.outcome, found.theorem, found.degree) == (outcome, theorem, degree)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("c(px*px, 0.5) - j", Why.ZERO_OPEN),
        ("c(px*px, 0.5) - j + px*x*x", Why.ZERO_OPEN),  # p x^2 and p^2/2: -x^4/2, see below; not for p x^2 + x^4/2
        ("j + x*x*x*x", Why.ZERO_TWO),
        ("c(px*px, 0.5) + c(py*py, 0.5) + x*x*x*x + y*y*y*y", Why.ZERO_TWO),
    ],
)
def test_where_nothing_is_said_of_a_zero_root(text: str, why: Why) -> None:
    if "px*x*x" in text:
        assert with_zero_root(text).outcome is Outcome.UNSTABLE
        text += " + c(x*x*x*x, 0.5)"
    found = with_zero_root(text)
    assert (found.outcome, found.why) == (Outcome.UNDECIDED, why)


@pytest.mark.parametrize("sign", [1, -1])
def test_the_frequency_beside_a_zero_root_has_the_sign_of_its_energy(sign: int) -> None:
    (w,) = with_zero_root(f"c(px*px, 0.5) + c(j, {sign}) + x*x*x*x").frequencies
    assert w.overlaps(arb(sign))


def test_canonical_coordinates_do_not_matter() -> None:
    """The mixed coordinates: with enclosures of exact zeros nothing more is decided, and nothing else."""
    found = with_zero_root("c(px*px, 0.5) - j + x*x*x", mixed=True)
    assert (found.outcome, found.theorem, found.degree) == (Outcome.UNSTABLE, Theorem.ZERO, 3)


GUIDED = """
mbsym: 1
name: a particle on a turning disc
parameters: {{n: {{sign: positive}}, k: {{}}, b: {{}}, c: {{}}}}
prescribed: {{phi: {{rate: n}}}}
bodies:
  - {{name: disc, attached to: 0, rotation: {{axes: [3], angles: [phi]}}, mass: 0}}
  - {{name: particle, attached to: disc, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}}
loads:
  - {{force function: -n**2*(x**2 + y**2)/2 - k*y**2/2 - b*x**4 - c*x**2*y}}
motion: {{x: 0, y: 0}}
values: {{n: {n}, k: {k}, b: {b}, c: {c}}}
"""


@pytest.mark.parametrize(
    ("n", "k", "b", "c", "outcome", "theorem"),
    [
        # in turning axes U = k y^2/2 + b x^4 + c x^2 y is left; beside zero the roots are s^2 = -4 n^2 - k
        (1, 1, 1, 0, Outcome.STABLE, Theorem.DEFINITE_HIGHER),
        (1, -1, -1, 0, Outcome.STABLE, Theorem.ZERO),  # on a top, held by gyroscopic forces
        (1, -1, 1, 0, Outcome.UNSTABLE, Theorem.ZERO),
        (1, 1, -1, 0, Outcome.UNSTABLE, Theorem.ZERO),
        (1, -5, -1, 0, Outcome.UNSTABLE, Theorem.FIRST),
        # y = -c x^2/k: b - c^2/(2 k)
        (1, 1, 1, 2, Outcome.UNSTABLE, Theorem.ZERO),
        (1, -1, 1, 2, Outcome.UNSTABLE, Theorem.ZERO),
        (1, -1, -1, 1, Outcome.STABLE, Theorem.ZERO),  # -1 + 1/2
        (1, -1, 0, 0, Outcome.UNDECIDED, Theorem.NONE),
        (1, 1, Fraction(1, 2), 1, Outcome.UNDECIDED, Theorem.NONE),  # (y + x^2)^2/2: a line of rest
    ],
)
def test_a_particle_on_a_turning_disc(n: int, k: int, b: Fraction, c: int, outcome: Outcome, theorem: Theorem) -> None:
    """U k y^2/2 + b x^4 + ... in turning axes: along y = -c x^2/k + ... it is (b - c^2/(2 k)) x^4."""
    found = mbsym.loads(GUIDED.format(n=n, k=k, b=b, c=c)).normal_forms.at_values
    assert (found.outcome, found.theorem) == (outcome, theorem)


def test_planted_mistakes_of_a_zero_root_are_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    leading = zero_root._leading

    def wrong(*a: object) -> tuple[int | None, object]:
        order, value = leading(*a)
        return order, value * 2

    def other(*a: object) -> tuple[int | None, object]:
        return 4, leading(*a)[1]

    planted: list[Callable[..., object]] = [wrong, other]
    for one in planted:
        monkeypatch.setattr(zero_root, "_leading", one)
        with pytest.raises(NotVerified):
            with_zero_root("c(px*px, 0.5) - j + x*x*x")


def test_a_zero_root_at_a_value_between_others() -> None:
    """The border where the spring of a particle on a turning disc vanishes: s^2 = 2 n^2, an irrational value.

    U = (s^2 - 2) x^2/2 + y^2 - x^4 in turning axes: at s = sqrt(2) the root is zero and the motion unstable.
    """
    text = """
mbsym: 1
name: a softening spring
parameters: {s: {sign: positive}}
prescribed: {phi: {rate: 1}}
bodies:
  - {name: disc, attached to: 0, rotation: {axes: [3], angles: [phi]}, mass: 0}
  - {name: particle, attached to: disc, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
loads:
  - {force function: -(x**2 + y**2)/2 - (s**2 - 2)*x**2/2 - y**2 + x**4}
motion: {x: 0, y: 0}
values: {s: 1}
"""
    found = exceptional(mbsym.loads(text), "s", (Fraction(1), Fraction(2)), {})
    (border,) = [one for one in found.specials if "product" in one.vanishing]
    assert border.exactly is None
    assert (border.judged.outcome, border.judged.theorem) == (Outcome.UNSTABLE, Theorem.ZERO)
    assert (border.judged.along, border.judged.degree) == ("x", 4)
    softened = text.replace("+ x**4", "- x**4")
    found = exceptional(mbsym.loads(softened), "s", (Fraction(1), Fraction(2)), {})
    (border,) = [one for one in found.specials if "product" in one.vanishing]
    assert border.judged.theorem is Theorem.DEFINITE_HIGHER
    assert any("times the power 4 of the deviation" in line for line in lines(found))
