"""What people read: nothing is misread, brackets are not torn apart, what differs by its sign only is joined."""

from __future__ import annotations

import random
import re
from fractions import Fraction

import pytest
from conftest import SHIPPED, derived
from flint import arb, ctx, fmpq
from hypothesis import given
from hypothesis import strategies as st
from properties import settings
from test_angle_sums import RING, element, fourier, products, waves
from tex_reader import read

import mbsym
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.formulas import angle_sums
from mbsym.formulas import shape as shapes
from mbsym.formulas.formula import Formula
from mbsym.formulas.latex import LatexNames, latex_factor, latex_text
from mbsym.formulas.python import python_text
from mbsym.formulas.shape import present
from mbsym.formulas.tree import Angles, Product, Sum, angles_as
from mbsym.formulas.wolfram import wolfram_text
from mbsym.report.lengths import formulas

SYSTEMS = ("tethered-satellites", "gyrostat", "spatial-arm", "satellite", "double-pendulum", "orbital-gyrostat")


@pytest.fixture(autouse=True)
def _precise():
    with ctx.workprec(200):
        yield


def symbols(ring: Ring, values: dict[str, Fraction]) -> dict[str, arb]:
    """The value of each symbol as LaTeX writes it, without blanks."""
    names, found = LatexNames.of(ring), {r"\pi": arb.pi()}
    for name, value in values.items():
        stem, _, accent = name.partition("_d") if name.endswith(("_dot", "_ddot")) else (name, "", "")
        symbol = names[stem].accented("d" + accent) if accent else str(names[name])
        found[symbol.replace(" ", "")] = arb(fmpq(value.numerator, value.denominator))
    return found


def point(ring: Ring, source: random.Random) -> dict[str, Fraction]:
    return {name: Fraction(source.randint(1, 40), 16) for name in ring.names()}


def agree(ring: Ring, latex: str, polynomial: Polynomial, source: random.Random) -> bool:
    """Whether a formula as people read it has the value that it should have."""
    values = point(ring, source)
    truth = ring.evaluate(polynomial, {name: fmpq(x.numerator, x.denominator) for name, x in values.items()})
    return bool((read(latex, symbols(ring, values), arb) - truth).contains(0))


@settings(max_examples=60)
@given(seed=st.integers(0, 10**9), terms=st.integers(0, 6), choice=st.sampled_from(["products", "sums", "shorter"]))
def test_nothing_is_misread(seed, terms, choice):
    source = random.Random(seed)
    for made in (fourier(source, terms), products(source, 2 * terms)):
        with angles_as(choice):
            assert agree(RING, latex_text(RING, made, breaks=True), made, source)


@pytest.mark.parametrize("name", SYSTEMS)
def test_the_formulas_of_systems_are_not_misread(name):
    analysis, source = derived(SHIPPED / f"{name}.yaml"), random.Random(5)
    found = [formula for number in (1, 2, 3) for formula in formulas(analysis.stage(number).value)]
    short = [formula for formula in found if formula.terms <= 60]
    assert len(short) > 20
    for formula in source.sample(short, min(len(short), 40)):
        assert agree(formula.ring, formula.latex(), formula.polynomial, source), formula.latex()


def test_the_reader_reads_as_people_do():
    """The planted error: a name after a cosine belongs to its argument."""
    cosine, a = RING.generator("cosine", "q2"), RING.generator("parameter", "a")
    source = random.Random(1)
    assert agree(RING, r"a \cos q_{2}", a * cosine, source)
    assert not agree(RING, r"\cos q_{2}\, a", a * cosine, source)
    assert not agree(RING, r"\cos q_{2} \dot{q}_{1}", RING.generator("velocity", "q1") * cosine, source)


def test_what_stands_before_a_variable_is_not_misread():
    """Coefficients of characteristic polynomials: cos(q2) lambda^2 has brackets."""
    cosine, a = RING.generator("cosine", "q2"), RING.generator("parameter", "a")
    assert latex_factor(RING, a * cosine) == r"(a \cos q_{2})"
    assert latex_factor(RING, a * a) == "a^{2}"
    assert latex_factor(RING, a + cosine) == r"(\cos q_{2} + a)"
    assert (latex_factor(RING, RING.one), latex_factor(RING, -RING.one)) == ("", "-")


# --- every printer, every form ---


@pytest.mark.parametrize("choice", ["products", "sums", "shorter"])
def test_every_printer_writes_the_form_that_is_asked_for(choice: Angles):
    s1, c1 = RING.generator("sine", "q1"), RING.generator("cosine", "q1")
    s2, c2 = RING.generator("sine", "q2"), RING.generator("cosine", "q2")
    made = s1 * c2 - c1 * s2
    texts = {
        "products": (r"\sin q_{1} \cos q_{2} - \cos q_{1} \sin q_{2}", "sin(q1)*cos(q2) - cos(q1)*sin(q2)"),
        "sums": (r"\sin(q_{1} - q_{2})", "sin(q1 - q2)"),
    }
    latex, python = texts["products" if choice == "products" else "sums"]
    with angles_as(choice):
        assert (latex_text(RING, made), python_text(RING, made)) == (latex, python)
        wolfram = python.replace("sin(", "Sin[").replace("cos(", "Cos[").replace(")", "]")
        assert wolfram_text(RING, made, functions_of_time=False) == wolfram
    formula = Formula(RING, made)
    assert (formula.latex(choice), formula.text(choice)) == (latex, python)


def test_texts_for_people_have_what_is_shorter_and_those_for_programs_products():
    s1, c1 = RING.generator("sine", "q1"), RING.generator("cosine", "q1")
    s2, c2 = RING.generator("sine", "q2"), RING.generator("cosine", "q2")
    formula = Formula(RING, c1 * c2 - s1 * s2)
    assert formula.latex() == r"\cos(q_{1} + q_{2})"
    assert formula.text() == "cos(q1 + q2)"
    assert str(formula) == "cos(q1)*cos(q2) - sin(q1)*sin(q2)"
    assert formula.wolfram() == "Cos[q1[t]]*Cos[q2[t]] - Sin[q1[t]]*Sin[q2[t]]"
    single = Formula(RING, s1 * c1)
    assert single.latex() == r"\sin q_{1} \cos q_{1}"  # sin(2 q1)/2 is as long


def test_only_the_angles_that_pay_are_joined():
    """cos(q1 - q2) cos(chi)^2: the products with chi stay."""
    s1, c1 = RING.generator("sine", "q1"), RING.generator("cosine", "q1")
    s2, c2 = RING.generator("sine", "q2"), RING.generator("cosine", "q2")
    made = (c1 * c2 + s1 * s2) * RING.generator("cosine", "chi") ** 2 * RING.generator("parameter", "a")
    assert Formula(RING, made).text() == "a*cos(q1 - q2)*cos(chi)**2"


def test_a_wrong_addition_theorem_is_seen(monkeypatch):
    """The planted error of the round trip: exp(i x) with one sign wrong."""
    s1, c1 = RING.generator("sine", "q1"), RING.generator("cosine", "q1")
    s2, c2 = RING.generator("sine", "q2"), RING.generator("cosine", "q2")
    right = angle_sums._waves
    monkeypatch.setattr(
        angle_sums,
        "_waves",
        lambda *given: [part._replace(weight=-part.weight) for part in right(*given)],
    )
    angle_sums.joined.cache_clear()
    made = RING.reduce((s1 * c2 + c1 * s2) * RING.generator("parameter", "a") * 17)
    shape = present(RING, made, "sums")
    angle_sums.joined.cache_clear()
    assert waves(shape)
    assert not (element(shape) - made).is_zero()


# --- joined up to sign ---


@pytest.mark.parametrize(
    ("text", "brackets"),
    [
        ("a*(q1 - q2) - b*(q2 - q1)", 2),
        ("a*(c - b)*q1 + chi*(b - c)*a", 2),
        ("(a - b)*cosine*q1_dot + (b - a)*sine*q2_dot", 2),
        ("(a - b)**3*cosine*q1_dot + (b - a)**3*sine*q2_dot", 2),
    ],
)
def test_what_differs_by_its_sign_is_one_bracket(text, brackets):
    names = {name: RING.generator("parameter", name) for name in ("a", "b", "c")}
    names |= {name: RING.generator("coordinate", name) for name in ("q1", "q2")}
    names |= {f"{name}_dot": RING.generator("velocity", name) for name in ("q1", "q2")}
    names |= {"chi": RING.generator("prescribed", "chi")}
    names |= {kind: RING.generator(kind, "q1") for kind in ("sine", "cosine")}
    made = eval(text, {"__builtins__": {}}, names)
    shape = present(RING, made)
    assert (element(shape) - made).is_zero()
    assert len(shape.terms) == 1
    assert sum(isinstance(factor.base, Sum) for factor in shape.terms[0].over) == brackets


@pytest.mark.parametrize("name", SYSTEMS)
def test_no_sum_of_a_system_has_a_bracket_and_its_negative(name):
    analysis = derived(SHIPPED / f"{name}.yaml")
    for number in (1, 2, 3):
        for formula in formulas(analysis.stage(number).value):
            if formula.terms <= 60:
                with angles_as("products"):
                    assert not opposite(present(formula.ring, formula.polynomial)), str(formula)


def test_without_the_joining_such_brackets_are_seen(monkeypatch):
    """The planted error: signs stay in the brackets where they came to stand."""
    monkeypatch.setattr(shapes.Presenter, "_unsigned", lambda self, product: product)
    analysis = mbsym.load(SHIPPED / "spatial-arm.yaml")
    found = [formula for formula in formulas(analysis.stage(3).value) if formula.terms <= 60]
    assert any(opposite(present(formula.ring, formula.polynomial)) for formula in found)


def opposite(shape: Sum) -> bool:
    """Whether in a sum, or a sum in it, there is a bracket in one term and its negative in another."""
    for place, one in enumerate(shape.terms):
        for factor in (*one.over, *one.under):
            if isinstance(factor.base, Sum) and opposite(factor.base):
                return True
        for two in shape.terms[place + 1 :]:
            if negatives(one, two):
                return True
    return False


def negatives(one: Product, two: Product) -> bool:
    """A common bracket stands in front of what it multiplies, so its negative cannot stand beside it."""
    first = {key(factor.base) for factor in one.over if isinstance(factor.base, Sum)}
    second = [factor.base for factor in two.over if isinstance(factor.base, Sum)]
    return any(key(bracket, -1) in first for bracket in second)


def key(shape: Sum, sign: int = 1) -> frozenset:
    return frozenset(
        (
            str(sign * term.coefficient),
            frozenset((key(f.base) if isinstance(f.base, Sum) else f.base, f.exponent) for f in term.over),
            frozenset((key(f.base) if isinstance(f.base, Sum) else f.base, f.exponent) for f in term.under),
        )
        for term in shape.terms
    )


# --- line breaks ---

_PIECE = re.compile(r"\\penalty(\d+)|\\[Bb]igl(?:\\\{|[(\[])|\\[Bb]igr(?:\\\}|[)\]])|[()]")


def torn(latex: str) -> list[str]:
    """The brackets of coefficients (in which nothing moves), and all that fit a line, that may be broken in them."""
    found, opened = [], []
    for match in _PIECE.finditer(latex):
        if match[1] is not None:
            for frame in opened:
                frame[1] = min(frame[1], int(match[1]))
        elif match[0] in "(" or match[0].lower().startswith(r"\bigl"):
            opened.append([match.start(), 10_000])
        else:
            start, least = opened.pop()
            inside = latex[start : match.end()]
            plain = re.sub(r"\\penalty\d+ ?", "", inside)
            moving = re.search(r"\\sin|\\cos|\\dot", plain)
            letters = len(re.findall(r"\\[a-zA-Z]+|[a-zA-Z0-9+-]", re.sub(r"\\[Bb]ig[lr]", "", plain)))
            if (least < 5000 and not moving) or (least < 10_000 and letters <= 12):
                found.append(inside)
    assert not opened
    return found


@pytest.mark.parametrize("name", SYSTEMS)
def test_no_line_ends_inside_the_bracket_of_a_coefficient(name):
    analysis, broken = derived(SHIPPED / f"{name}.yaml"), 0
    for number in (1, 2, 3):
        for formula in formulas(analysis.stage(number).value):
            if formula.terms <= 400:
                latex = latex_text(formula.ring, formula.polynomial, breaks=True)
                broken += latex.count(r"\penalty0 ")
                assert not torn(latex), torn(latex)[0]
    assert broken  # between terms lines may end


def test_the_check_of_breaks_sees_a_torn_bracket():
    assert torn(r"x\penalty0  + (m\penalty60  + 3 m_{0}) \cos q") == [r"(m\penalty60  + 3 m_{0})"]
    assert not torn(r"x\penalty0  + (m + 3 m_{0}) \cos q")


def test_roots_stand_in_denominators():
    """The force of U = mu m/r with r^2 = x^2 + y^2 is -mu m x/r^3; an attraction through the root alone, too."""
    found = mbsym.loads(
        """
mbsym: 1
name: Kepler
parameters: {m: positive, mu: positive}
bodies:
  - {name: p, attached to: 0, connection point: [x, y, 0], mass: m, coordinates: [x, y]}
loads:
  - potential: -mu*m/sqrt(x**2 + y**2) - m*sqrt(mu)*x/mu
"""
    )
    force = found.equations.forcing[0]
    assert force.readable() == "m (1/sqrt(mu) - mu x/sqrt(x^2 + y^2)^3)"
    assert agree(force.ring, force.latex(), force.polynomial, random.Random(3))
