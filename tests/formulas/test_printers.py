"""Printers: what they write is read back and compared with the ring; names stay different."""

from __future__ import annotations

import keyword
import random
import re
from fractions import Fraction
from functools import partial

import pytest
from flint import arb, ctx, fmpq
from hypothesis import given
from hypothesis import strategies as st
from properties import settings

from mbsym.algebra.ring import Polynomial, Ring
from mbsym.formulas import shape
from mbsym.formulas.arithmetic import to_sympy
from mbsym.formulas.formula import Formula
from mbsym.formulas.latex import LatexNames, LatexPrinter, latex_symbol, latex_text
from mbsym.formulas.names import injective
from mbsym.formulas.python import python_text
from mbsym.formulas.tree import Factor, Product, Sum
from mbsym.formulas.wolfram import WolframNames, wolfram_name, wolfram_text

PARAMETERS = ("a", "b", "J_x", "Jx", "omega0", "K")


def make_ring() -> Ring:
    """Two coordinates, a prescribed angle, and adjoined elements of every kind."""
    ring = Ring(("psi", "theta"), ("chi",), PARAMETERS, {"psi": 1, "theta": 2, "chi": 1}, positive=("a", "b"), spare=12)
    a, b, t = ring.generator("parameter", "a"), ring.generator("parameter", "b"), ring.generator("time", "t")
    theta = ring.generator("coordinate", "theta")
    ring.reciprocal(a)
    ring.reciprocal(a + b)
    ring.square_root(a + theta**2 + 1)
    ring.function("exp", -b * t)
    ring.sin_cos_of(b * t)
    return ring


RING = make_ring()
USABLE = [k for k, g in enumerate(RING.generators) if g.kind != "spare"]


def random_polynomial(source: random.Random, terms: int) -> Polynomial:
    total = RING.zero
    for _ in range(terms):
        term = RING.number(Fraction(source.randint(-6, 6), source.choice((1, 1, 2, 3, 6))))
        for index in source.sample(USABLE, source.randint(0, 4)):
            term = term * RING.context.gen(index) ** source.randint(1, 2)
        total = total + term
    return RING.reduce(total)


def point(source: random.Random) -> dict[str, Fraction]:
    return {name: Fraction(source.randint(1, 40), 16) for name in RING.names()}


class Ball:
    """Just enough of a number for ``eval`` of our own text: exact integers, rigorous functions."""

    def __init__(self, value: arb) -> None:
        self.value = value

    def __add__(self, other: Ball) -> Ball:
        return Ball(self.value + other.value)

    def __sub__(self, other: Ball) -> Ball:
        return Ball(self.value - other.value)

    def __mul__(self, other: Ball) -> Ball:
        return Ball(self.value * other.value)

    def __truediv__(self, other: Ball) -> Ball:
        return Ball(self.value / other.value)

    def __pow__(self, other: Ball) -> Ball:
        return Ball(self.value ** int(other.value.unique_fmpz()))

    def __neg__(self) -> Ball:
        return Ball(-self.value)


def evaluated(text: str, values: dict[str, Fraction]) -> arb:
    """The value of a formula in Python syntax, every literal taken exactly."""
    names = {name: Ball(arb(fmpq(x.numerator, x.denominator))) for name, x in values.items()} | {"pi": Ball(arb.pi())}
    for function in ("sin", "cos", "sqrt", "exp"):
        names[function] = lambda x, function=function: Ball(getattr(x.value, function)())  # type: ignore[assignment]
    names["Ball_"] = lambda n: Ball(arb(n))  # type: ignore[assignment]
    return eval(re.sub(r"(?<![\w.])(\d+)", r"Ball_(\1)", text), {"__builtins__": {}}, names).value


def truth(polynomial: Polynomial, values: dict[str, Fraction]) -> arb:
    return RING.evaluate(polynomial, {name: fmpq(x.numerator, x.denominator) for name, x in values.items()})


@pytest.fixture(autouse=True)
def _precise():
    with ctx.workprec(200):
        yield


@settings(max_examples=120)
@given(seed=st.integers(0, 10**9), terms=st.integers(0, 14))
def test_python_text_reads_back_to_the_same_value(seed, terms):
    source = random.Random(seed)
    polynomial, values = random_polynomial(source, terms), point(source)
    difference = evaluated(python_text(RING, polynomial), values) - truth(polynomial, values)
    assert difference.contains(0)
    assert difference.rad() < arb(2) ** -80


@pytest.mark.parametrize("limit", ["FACTOR_WHOLE", "FACTOR_COEFFICIENTS", "COLLECT"])
def test_long_polynomials_that_are_only_grouped_keep_their_value(limit, monkeypatch):
    monkeypatch.setattr(shape, limit, 0)
    source = random.Random(7)
    for _ in range(20):
        polynomial, values = random_polynomial(source, 25), point(source)
        difference = evaluated(python_text(RING, polynomial), values) - truth(polynomial, values)
        assert difference.contains(0)
        assert difference.rad() < arb(2) ** -80


def test_sympy_agrees_with_the_text():
    sympy = pytest.importorskip("sympy")
    source = random.Random(3)
    for _ in range(15):
        polynomial = random_polynomial(source, 6)
        symbols = {name: sympy.Symbol(name) for name in RING.names()}
        read = sympy.sympify(python_text(RING, polynomial), locals=symbols)
        translated = to_sympy(RING, polynomial)
        values = {symbols[name]: sympy.Rational(x.numerator, x.denominator) for name, x in point(source).items()}
        assert abs((read - translated).evalf(40, subs=values)) < 1e-30


def parameters(text_: str) -> Polynomial:
    names = {name: RING.generator("parameter", name) for name in PARAMETERS}
    return eval(text_, {}, names)


@pytest.mark.parametrize(
    ("polynomial", "text"),
    [
        ("a - a", "0"),
        ("-a", "-a"),
        ("b - a", "b - a"),
        ("a/2 + b/3 - b/3", "a/2"),
        ("3*a*(Jx - K)", "3*a*(Jx - K)"),
        ("-3*a*Jx + 3*a*K", "3*a*(K - Jx)"),
        ("a**2 + 2*a*b + b**2", "(a + b)**2"),
        ("(a + Jx)*(b + 3) - 4*K*(a + 1)", "(a + Jx)*(b + 3) - 4*K*(a + 1)"),
        ("b + a*Jx*(K + Jx) + a*K**2", "a*(Jx**2 + Jx*K + K**2) + b"),
    ],
)
def test_parameters_are_collected_and_factored(polynomial, text):
    found = parameters(polynomial)
    shown = python_text(RING, found)
    assert parameters(shown) == found
    assert shown == text


def test_motion_is_collected_before_parameters():
    speed, sine = RING.generator("velocity", "theta"), RING.generator("sine", "psi")
    a, b = RING.generator("parameter", "a"), RING.generator("parameter", "b")
    polynomial = RING.reduce((a + b) * speed**2 * sine - b * sine + a * RING.generator("acceleration", "psi"))
    assert python_text(RING, polynomial) == "a*psi_ddot + sin(psi)*((a + b)*theta_dot**2 - b)"


def test_a_sine_is_seen_again():
    cosine = RING.generator("cosine", "psi")
    assert python_text(RING, 1 - cosine**2) == "sin(psi)**2"


@settings(max_examples=80)
@given(seed=st.integers(0, 10**9), terms=st.integers(0, 14), breaks=st.booleans())
def test_latex_and_wolfram_are_balanced(seed, terms, breaks):
    polynomial = random_polynomial(random.Random(seed), terms)
    latex = latex_text(RING, polynomial, breaks)
    bare = latex.replace(r"\{", "").replace(r"\}", "")
    for opening, closing in ("{}", "()", "[]"):
        assert bare.count(opening) == bare.count(closing)
    assert latex.count(r"\{") == latex.count(r"\}")
    assert not re.search(r"[+-]\s*[+-]", latex)
    for functions_of_time in (True, False):
        wolfram = wolfram_text(RING, polynomial, functions_of_time)
        assert "_" not in wolfram
        assert "**" not in wolfram
        for opening, closing in ("()", "[]"):
            assert wolfram.count(opening) == wolfram.count(closing)


def test_nothing_follows_a_sine_that_could_be_its_argument():
    """cos(q) s (a + b) exp(-b t): the other printers bracket arguments and keep their order."""
    parameter = partial(RING.generator, "parameter")
    cosine, sine = RING.generator("cosine", "psi"), RING.generator("sine", "theta")
    theta, total = RING.generator("coordinate", "theta"), parameter("a") + parameter("b")
    for polynomial, latex in (
        (cosine * theta, r"\theta \cos \psi"),
        (sine * theta**2 * total, r"(a + b) \theta^{2} \sin\frac{\theta}{2}"),
        (cosine**2 * sine * theta, r"\theta \cos^{2} \psi \sin\frac{\theta}{2}"),
        (cosine * RING.reciprocal(parameter("a")) * theta, r"\frac{1}{a} \theta \cos \psi"),
    ):
        assert latex_text(RING, polynomial) == latex
    assert python_text(RING, cosine * theta) == "cos(psi)*theta"
    assert wolfram_text(RING, cosine * theta) == r"Cos[\[Psi][t]]*\[Theta][t]"


@settings(max_examples=80)
@given(seed=st.integers(0, 10**9), terms=st.integers(1, 14))
def test_sines_stand_last_in_every_product(seed, terms):
    latex = latex_text(RING, random_polynomial(random.Random(seed), terms))
    argument = r"(?: \\[a-z]+|\\frac\{[^}]*\}\{[^}]*\}|\([^()]*\))"
    for rest in re.findall(r"\\(?:sin|cos)(?:\^\{\d+\})?" + argument + r"(.{0,6})", latex):
        assert re.match(r"$| \\(?:sin|cos)| [+-] |[)}]|\\[bB]igr|\]", rest), latex


def test_dots_and_primes():
    polynomial = RING.generator("velocity", "theta") ** 2 * RING.generator("acceleration", "psi")
    assert latex_text(RING, polynomial) == r"\ddot{\psi} \dot{\theta}^{2}"
    assert wolfram_text(RING, polynomial) == r"\[Psi]''[t]*\[Theta]'[t]^2"
    assert wolfram_text(RING, RING.generator("sine", "theta")) == r"Sin[\[Theta][t]/2]"


def test_formulas_print_themselves():
    formula = Formula(RING, RING.generator("parameter", "omega0") ** 2)
    assert str(formula) == "omega0**2"
    assert formula.latex() == r"\omega_{0}^{2}"
    assert formula.wolfram() == r"\[Omega]0^2"


@pytest.mark.parametrize(
    ("name", "latex", "wolfram"),
    [
        ("psi", r"\psi", r"\[Psi]"),
        ("omega0", r"\omega_{0}", r"\[Omega]0"),
        ("Jx", "J_{x}", "Jx"),
        ("Jxy", "J_{xy}", "Jxy"),
        ("M2", "M_{2}", "M2"),
        ("theta1", r"\theta_{1}", r"\[Theta]1"),
        ("p_max", r"p_{\mathrm{max}}", "pmax"),
        ("mass", r"\mathit{mass}", "mass"),
        ("lam", r"\lambda", r"\[Lambda]"),
        ("Gamma", r"\Gamma", r"\[CapitalGamma]"),
        ("k_theta", r"k_{\theta}", r"k\[Theta]"),
        ("K", "K", "KPar"),
        ("N", "N", "NPar"),
        ("Re", "R_{e}", "RePar"),
        ("Tension", r"\mathit{Tension}", "TensionPar"),
    ],
)
def test_names_as_people_write_them(name, latex, wolfram):
    assert str(latex_symbol(name)) == latex
    assert wolfram_name(name) == wolfram


CLASHING = ["a_b", "ab", "A_b", "K", "N", "KPar", "theta", "Theta", "omega_0", "omega0", "J_x", "Jx", "lam", "lamda"]
NAMES = st.lists(
    st.one_of(st.sampled_from(CLASHING), st.from_regex(r"[A-Za-z](_?[A-Za-z0-9]){0,5}", fullmatch=True)),
    unique=True,
    max_size=20,
).map(lambda names: [name for name in names if name not in ("t", "pi")])


@settings(max_examples=150)
@given(names=NAMES)
def test_different_names_stay_different(names):
    latex = LatexNames(names)
    assert len({str(latex[name]) for name in names}) == len(names)
    wolfram = WolframNames(Ring((), (), names, {}))
    assert len({wolfram[name] for name in names}) == len(names)
    assert all(re.fullmatch(r"([A-Za-z0-9]|\\\[[A-Za-z]+\])+", wolfram[name]) for name in names)
    reserved = {*keyword.kwlist, "np", "q", *names[:3]}
    python = injective(names, lambda name: name + "_" if name in reserved else name, reserved)
    assert len(set(python.values())) == len(names)
    assert not set(python.values()) & reserved


def test_very_long_polynomials_are_printed():
    source = random.Random(1)
    ring = Ring([f"q{k}" for k in range(6)], (), [f"m{k}" for k in range(8)], {f"q{k}": 1 for k in range(6)})
    kinds = ["sine", "cosine"]
    exponents = {}
    while len(exponents) < 15_000:
        monomial = [0] * len(ring.generators)
        monomial[ring.index("velocity", f"q{source.randrange(6)}")] += 1
        monomial[ring.index("velocity", f"q{source.randrange(6)}")] += 1
        for k in range(6):
            monomial[ring.index(source.choice(kinds), f"q{k}")] = 1
        monomial[ring.index("parameter", f"m{source.randrange(8)}")] += 1
        monomial[ring.index("parameter", f"m{source.randrange(8)}")] += 1
        exponents[tuple(monomial)] = fmpq(source.randint(1, 5), 6)
    text = python_text(ring, ring.context.from_dict(exponents))
    assert text.count("(") == text.count(")")


def test_brackets_are_as_high_as_the_fractions_in_them() -> None:
    """The innermost bracket about a fraction is a high one, and so is every one about that; others stay as they are."""
    ring = Ring((), (), ("m", "n", "a"), {})
    m, n, a = (Factor(ring.index("parameter", name)) for name in "mna")

    def bracket(*terms: Product) -> Factor:
        return Factor(Sum(terms))

    for first, text in (
        (Product(fmpq(1), (m,), (n,)), r"m \Bigl[n \Bigl(\frac{m}{n} + a\Bigr) + a\Bigr]"),
        (Product(fmpq(1), (m,)), r"m \bigl[n (m + a) + a\bigr]"),
    ):
        inner = bracket(first, Product(fmpq(1), (a,)))
        outer = bracket(Product(fmpq(1), (n, inner)), Product(fmpq(1), (a,)))
        assert LatexPrinter(ring).sum(Sum((Product(fmpq(1), (m, outer)),))) == text
