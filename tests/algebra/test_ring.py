"""The exact ring against SymPy and against ball arithmetic: normal forms, derivatives, roots, zero tests, budgets."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
import sympy
from flint import arb, ctx, fmpq
from hypothesis import given
from hypothesis import strategies as st
from properties import settings

from mbsym.algebra.base import Lowering
from mbsym.algebra.failures import NoClosedForm, SingularPoint
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.angles import LinearForm
from mbsym.expressions.parser import parse_expression
from mbsym.expressions.place import Complaints, Span
from mbsym.expressions.tree import FUNCTIONS, Call, Expression, Name, Negative, Number, Operation, names, number

PLAIN = ("x", "y", "chi", "l", "m", "w", "t", "x_dot")
some = settings(max_examples=80, derandomize=True)


def new_ring(spare: int = 40, **options: Any) -> Ring:
    """Coordinates x and y (x also under sin(x/2)), a prescribed chi, parameters l, m > 0 and w of any sign."""
    return Ring(["x", "y"], ["chi"], ["l", "m", "w"], {"x": 2, "chi": 1}, positive=["l", "m"], spare=spare, **options)


def lowering(ring: Ring) -> Lowering:
    environment = {name: ring.generator("coordinate", name) for name in "xy"}
    environment |= {name: ring.generator("parameter", name) for name in ("l", "m", "w", "pi")}
    environment |= {"chi": ring.generator("prescribed", "chi"), "t": ring.generator("time", "t")}
    environment |= {name + "_dot": ring.generator("velocity", name) for name in "xy"}
    return Lowering(ring, environment)


def parsed(text: str) -> Expression:
    complaints = Complaints()
    tree = parse_expression(text, complaints, lambda start, end: Span(1, start + 1, end - start))
    assert tree is not None, complaints.items
    return tree


def lower(ring: Ring, text: str) -> Polynomial:
    return lowering(ring)(parsed(text))


def is_zero(text: str) -> bool | None:
    ring = new_ring()
    return ring.is_zero(lower(ring, text))


def in_sympy(expression: Expression) -> Any:
    """The same expression in SymPy, by a translation of its own."""
    match expression:
        case Number(value):
            return sympy.Rational(value.numerator, value.denominator)
        case Name(name):
            return sympy.pi if name == "pi" else sympy.Symbol(name)
        case Negative(operand):
            return -in_sympy(operand)
        case Operation("+", left, right):
            return in_sympy(left) + in_sympy(right)
        case Operation("-", left, right):
            return in_sympy(left) - in_sympy(right)
        case Operation("*", left, right):
            return in_sympy(left) * in_sympy(right)
        case Operation("/", left, right):
            return in_sympy(left) / in_sympy(right)
        case Operation("**", left, right):
            return in_sympy(left) ** in_sympy(right)
        case Call(function, argument) if function in FUNCTIONS:
            return getattr(sympy, function)(in_sympy(argument))
    raise TypeError(expression)


# --- random expressions that have a value everywhere on x, y, chi, l, m, w, t in (0, 1) ---

small_fractions = st.builds(Fraction, st.integers(-3, 3), st.integers(1, 3))
leaves = st.one_of(st.sampled_from([Name(name) for name in PLAIN]), st.builds(number, small_fractions))
angles = st.sampled_from(["x", "-x", "x/2", "2*x", "3*x/2", "chi - x", "x + chi", "x + pi/2", "chi + pi", "x - pi/4"])
circular = st.builds(Call, st.sampled_from(["sin", "cos"]), angles.map(parsed))
foreign = st.builds(Call, st.sampled_from(["sin", "cos"]), st.sampled_from(["w*t", "l*x", "x*y", "x + 1"]).map(parsed))


def positive(inner: Expression) -> Expression:
    """5 + sin(inner)**2 would hide inner: inner**2 + 1 does not."""
    return Operation("+", Operation("**", inner, number(2)), number(1))


def _grow(inner: st.SearchStrategy[Expression], functions: bool) -> st.SearchStrategy[Expression]:
    grown = [
        st.builds(Operation, st.sampled_from(["+", "-", "*"]), inner, inner),
        st.builds(Operation, st.just("/"), inner, inner.map(positive)),
        st.builds(Negative, inner),
        st.builds(Operation, st.just("**"), inner, st.integers(0, 3).map(number)),
    ]
    if functions:
        grown.append(st.builds(Call, st.just("sqrt"), inner.map(positive)))
        grown.append(st.builds(Call, st.just("exp"), st.sampled_from(["x", "-x", "y*w", "x - t"]).map(parsed)))
        grown.append(st.builds(Call, st.just("atan"), st.sampled_from(["x", "y*l"]).map(parsed)))
        grown.append(st.builds(Call, st.just("log"), st.sampled_from(["1 + x**2", "l + m"]).map(parsed)))
        grown.append(st.builds(Call, st.sampled_from(["sinh", "cosh", "tanh", "tan"]), st.just(Name("x"))))
    return st.one_of(grown)


rational_expressions = st.recursive(st.one_of(leaves, circular), lambda inner: _grow(inner, False), max_leaves=6)
expressions = st.recursive(st.one_of(leaves, circular, foreign), lambda inner: _grow(inner, True), max_leaves=5)
places = st.fixed_dictionaries({name: st.integers(1, 63).map(lambda k: fmpq(k, 64)) for name in PLAIN})


def everywhere(values: dict[str, fmpq]) -> dict[str, fmpq]:
    return dict.fromkeys(("y_dot", "x_ddot", "y_ddot"), fmpq(0)) | values


def enclosure(ring: Ring, x: Polynomial, values: dict[str, fmpq]) -> arb:
    with ctx.workprec(300):
        return ring.evaluate(x, everywhere(values))


def number_in_sympy(expression: Any, values: dict[str, fmpq]) -> arb:
    """The value by SymPy to 50 digits, with its rounding error as radius."""
    at = {sympy.Symbol(name): sympy.Rational(int(v.p), int(v.q)) for name, v in values.items()}
    exact = sympy.sympify(expression).subs(at)
    value = sympy.N(exact, 50)
    return arb(str(value)) + arb(0, arb(10) ** -40 * (1 + abs(arb(str(value)))))


# --- normal forms ---


def test_sine_and_cosine_have_one_normal_form() -> None:
    ring = new_ring()
    assert lower(ring, "sin(x)**2 + cos(x)**2 - 1") == ring.zero
    assert lower(ring, "sin(chi)**4 - cos(chi)**4") == lower(ring, "1 - 2*cos(chi)**2")


@pytest.mark.parametrize(
    ("left", "right"),
    [
        ("sin(x + chi)", "sin(x)*cos(chi) + cos(x)*sin(chi)"),
        ("cos(chi - x)", "cos(x)*cos(chi) + sin(x)*sin(chi)"),
        ("cos(3*x)", "4*cos(x)**3 - 3*cos(x)"),
        ("sin(5*chi)", "16*sin(chi)**5 - 20*sin(chi)**3 + 5*sin(chi)"),
        ("sin(-x)", "-sin(x)"),
        ("2*sin(x/2)**2", "1 - cos(x)"),
        ("2*sin(x/2)*cos(x/2)", "sin(x)"),
        ("sin(3*x/2)", "sin(x)*cos(x/2) + cos(x)*sin(x/2)"),
        ("sin(x + pi/2)", "cos(x)"),
        ("cos(chi + 3*pi)", "-cos(chi)"),
        ("2*sin(chi + pi/3)", "sin(chi) + sqrt(3)*cos(chi)"),
        ("2*cos(pi/4)", "sqrt(2)"),
        ("tan(x)*cos(x)", "sin(x)"),
        ("1 + tan(x)**2", "1/cos(x)**2"),
    ],
)
def test_sums_multiples_and_halves_of_angles(left: str, right: str) -> None:
    assert is_zero(f"({left}) - ({right})") is True
    assert is_zero(f"({left}) + ({right})") is False


@some
@given(st.integers(-4, 4), st.integers(-3, 3), st.integers(-7, 7))
def test_angles_agree_with_sympy(n: int, k: int, quarter_turns: int) -> None:
    ring = new_ring()
    form = LinearForm((("chi", Fraction(k)), ("x", Fraction(n, 2))), Fraction(quarter_turns, 4))
    chi, x = sympy.symbols("chi x")
    angle = k * chi + sympy.Rational(n, 2) * x + quarter_turns * sympy.pi / 4
    at = dict.fromkeys(PLAIN, fmpq(1)) | {"chi": fmpq(3, 7), "x": fmpq(-5, 4)}
    for ours, theirs in zip(ring.sin_cos(form), (sympy.sin(angle), sympy.cos(angle)), strict=True):
        assert enclosure(ring, ours, at).overlaps(number_in_sympy(theirs, at))


@some
@given(rational_expressions, rational_expressions, rational_expressions)
def test_equal_is_identical_without_denominators(a: Expression, b: Expression, c: Expression) -> None:
    ring = new_ring()
    lowered = lowering(ring)
    x, y, z = lowered(a), lowered(b), lowered(c)
    assert ring.is_zero((x + y) * z - (x * z + y * z)) is True
    assert ring.is_zero(x * y - y * x) is True
    once = ring.reduce(x * y)
    assert ring.reduce(once) == once


# --- derivatives ---


@some
@given(expressions, st.sampled_from(["x", "y", "chi", "t"]), places)
def test_derivatives_agree_with_sympy(expression: Expression, name: str, values: dict[str, fmpq]) -> None:
    ring = new_ring()
    slope = ring.derivative(lowering(ring)(expression), name)
    theirs = sympy.diff(in_sympy(expression), sympy.Symbol(name))
    assert enclosure(ring, slope, values).overlaps(number_in_sympy(theirs, values))


@pytest.mark.parametrize(
    ("function", "slope"),
    [
        ("sin(x/2)", "cos(x/2)/2"),
        ("cos(2*x - chi)", "-2*sin(2*x - chi)"),
        ("sin(l*x)", "l*cos(l*x)"),
        ("cos(x + 1)", "-sin(x + 1)"),
        ("1/(1 + x**2)", "-2*x/(1 + x**2)**2"),
        ("sqrt(x**2 + y**2)", "x/sqrt(x**2 + y**2)"),
        ("1/sqrt(l**2 + x)", "-1/(2*(l**2 + x)*sqrt(l**2 + x))"),
        ("sqrt(1 + sqrt(1 + x))", "1/(4*sqrt(1 + x)*sqrt(1 + sqrt(1 + x)))"),
        ("exp(-x*l)", "-l*exp(-x*l)"),
        ("log(l + x**2)", "2*x/(l + x**2)"),
        ("atan(x*y)", "y/(1 + x**2*y**2)"),
        ("tan(x)", "1 + tan(x)**2"),
        ("tanh(x)", "1 - tanh(x)**2"),
        ("sinh(x)", "cosh(x)"),
        ("exp(sin(chi)*x)", "sin(chi)*exp(sin(chi)*x)"),
    ],
)
def test_derivation_is_the_textbook_table(function: str, slope: str) -> None:
    ring = new_ring()
    derived = ring.derivative(lower(ring, function), "x")
    assert ring.is_zero(derived - lower(ring, slope)) is True


def test_a_quantity_stands_still_in_the_others() -> None:
    ring = new_ring()
    formula = lower(ring, "sin(x)/(1 + x**2) + sqrt(1 + x**2)")
    assert all(ring.derivative(formula, name).is_zero() for name in ("y", "chi", "t"))
    assert ring.depends_on(formula, "x")
    assert not ring.depends_on(formula, "y")


@pytest.mark.parametrize("name", ["chi", "t"])
def test_an_angle_that_is_a_plain_name_moves_with_it(name: str) -> None:
    ring = Ring(["x"], ["chi"], [], {"t": 1, "chi": 1})
    sine, cosine = ring.sin_cos(LinearForm(((name, Fraction(1)),)))
    assert ring.derivative(sine, name) == cosine
    assert ring.depends_on(sine, name)


def test_velocities_in_roots_and_functions_are_differentiated() -> None:
    ring = new_ring()
    for function, slope in (
        ("exp(x_dot)", "exp(x_dot)"),
        ("1/(1 + x_dot**2)", "-2*x_dot/(1 + x_dot**2)**2"),
        ("sqrt(1 + x_dot**2)", "x_dot/sqrt(1 + x_dot**2)"),
        ("sin(l*x_dot)", "l*cos(l*x_dot)"),
    ):
        derived = ring.velocity_derivative(lower(ring, function), "x")
        assert ring.is_zero(derived - lower(ring, slope)) is True, function


# --- fractions ---


@pytest.mark.parametrize(
    ("identity", "near_miss"),
    [
        ("1/(x*(x + 1)) - 1/x + 1/(x + 1)", "1/(x*(x + 1)) - 1/x - 1/(x + 1)"),
        ("1/(x - y) + 1/(x + y) - 2*x/(x**2 - y**2)", "1/(x - y) + 1/(x + y) - 2*y/(x**2 - y**2)"),
        ("x/(x + l) + l/(x + l) - 1", "x/(x + l) + m/(x + l) - 1"),
        ("(x**3 - 1)/(x - 1) - x**2 - x - 1", "(x**3 - 1)/(x - 1) - x**2 - x + 1"),
        ("1/(1/x + 1/y) - x*y/(x + y)", "1/(1/x + 1/y) - (x + y)/(x*y)"),
        ("sin(x)**2/(1 - cos(x)) - 1 - cos(x)", "sin(x)**2/(1 - cos(x)) - 1 + cos(x)"),
        ("1/(1 + sqrt(2)) - sqrt(2) + 1", "1/(1 + sqrt(2)) - sqrt(2)"),
        ("1/(1 + 1/(1 + 1/x)) - (x + 1)/(2*x + 1)", "1/(1 + 1/(1 + 1/x)) - x/(2*x + 1)"),
    ],
)
def test_partial_fractions(identity: str, near_miss: str) -> None:
    assert is_zero(identity) is True
    assert is_zero(near_miss) is False


def test_a_fraction_is_reduced() -> None:
    ring = new_ring()
    numerator, denominators = ring.fraction(lower(ring, "(x**2 - l**2)/((x - l)*(x + m))"))
    assert [(d, e) for d, e in denominators] == [(lower(ring, "x + m"), 1)]
    assert numerator == lower(ring, "x + l")


@some
@given(rational_expressions)
def test_a_number_times_its_reciprocal_is_one(expression: Expression) -> None:
    ring = new_ring()
    x = lowering(ring)(expression)
    if ring.is_zero(x) is False:
        assert ring.is_zero(x * ring.reciprocal(x) - 1) is True


@some
@given(rational_expressions, rational_expressions)
def test_a_fraction_is_zero_exactly_where_sympy_says_so(a: Expression, b: Expression) -> None:
    ring = new_ring()
    lowered = lowering(ring)
    ours = ring.is_zero(lowered(a) - lowered(b))
    points = [{name: fmpq(7 * k + i + 3, 64) for i, name in enumerate(PLAIN)} for k in range(3)]
    differences = [enclosure(ring, lowered(a) - lowered(b), at) for at in points]
    assert ours is all(difference.contains(0) for difference in differences)


def test_division_by_zero_is_a_singular_point() -> None:
    ring = new_ring()
    with pytest.raises(SingularPoint):
        lower(ring, "1/(sin(x)**2 + cos(x)**2 - 1)")


# --- roots ---


@pytest.mark.parametrize(
    ("root", "value"),
    [
        ("sqrt(8)", "2*sqrt(2)"),
        ("sqrt(1/2)", "sqrt(2)/2"),
        ("sqrt(6)", "sqrt(2)*sqrt(3)"),
        ("sqrt(4*l**2*m)", "2*l*sqrt(m)"),
        ("sqrt(9*l**2)", "3*l"),
        ("sqrt((l + m)**2)", "l + m"),
        ("sqrt(l**2*(1 + x**2)**2)", "l + l*x**2"),
        ("sqrt(l**3)", "l*sqrt(l)"),
        ("1/sqrt(l)", "sqrt(l)/l"),
        ("(4*l**2)**(3/2)", "8*l**3"),
        ("sqrt(l**2*sin(chi)**2 + l**2*cos(chi)**2)", "l"),
    ],
)
def test_roots_come_out_where_signs_are_known(root: str, value: str) -> None:
    assert is_zero(f"{root} - ({value})") is True
    assert is_zero(f"{root} - 2*({value})") is False


@pytest.mark.parametrize(
    "root", ["sqrt(x**2) - x", "sqrt(w**2) - w", "sqrt((l - m)**2) - l + m", "sqrt(sin(x)**2) - sin(x)"]
)
def test_roots_of_squares_of_unknown_sign_stay(root: str) -> None:
    assert is_zero(root) is not True


def test_the_root_of_a_negative_number_is_refused() -> None:
    with pytest.raises(SingularPoint):
        lower(new_ring(), "sqrt(-2)")


ZEROS = [
    "sqrt(2)*sqrt(3) - sqrt(6)",
    "sqrt(x + 2) - sqrt(2 + x)",
    "sqrt(l)*sqrt(m) - sqrt(l*m)",
    "sqrt(1 + x**2)*sqrt(1 + y**2) - sqrt((1 + x**2)*(1 + y**2))",
    "log(l*m) - log(l) - log(m)",
    "exp(x + y) - exp(x)*exp(y)",
    "exp(2*x) - exp(x)**2",
    "sin(2*w*t) - 2*sin(w*t)*cos(w*t)",
    "sinh(x)**2 - cosh(x)**2 + 1",
    "exp(x)*exp(-x) - 1",
]
HIDDEN_ZEROS = [
    "sqrt(1/l**2) - 1/l",
    "sqrt(3 + 2*sqrt(2)) - 1 - sqrt(2)",
    "cos(2*w*t) - 2*cos(w*t)**2 + 1",
    "cos(-w*t) - cos(w*t)",
    "cos(x + 1) - cos(x)*cos(1) + sin(x)*sin(1)",
    "log(exp(x)) - x",
    "exp(log(l)) - l",
    "4*atan(1) - pi",
    "sqrt((x**2 + y**2)**2) - x**2 - y**2",
    "sqrt((1 + cos(x))**2) - 1 - cos(x)",
    "tan(atan(x)) - x",
]
NONZEROS = [
    "sqrt(2) + sqrt(3) - sqrt(5)",
    "sqrt(2)*sqrt(x**2 + 1) - sqrt(x**2 + 2)",
    "sqrt(1 + x**2) + sqrt(1 + y**2) - sqrt(2 + x**2 + y**2)",
    "exp(x + y) - exp(x) - exp(y)",
    "sin(2*w*t) - 2*sin(w*t)",
    "cos(2*w*t) + 2*cos(w*t)**2 - 1",
    "log(l*m) - log(l)*log(m)",
]


@pytest.mark.parametrize("text", [*ZEROS, *HIDDEN_ZEROS])
def test_a_zero_is_never_declared_different_from_zero(text: str) -> None:
    assert is_zero(text) is not False


@pytest.mark.parametrize("text", NONZEROS)
def test_what_is_not_zero_is_never_declared_zero(text: str) -> None:
    assert is_zero(text) is False


@some
@given(expressions, places)
def test_proved_zero_is_zero(expression: Expression, values: dict[str, fmpq]) -> None:
    ring = new_ring()
    x = lowering(ring)(expression)
    again = lowering(ring)(Operation("-", expression, Operation("*", number(Fraction(1, 3)), expression)))
    difference = x * fmpq(2, 3) - again
    assert ring.is_zero(difference) is not False
    if ring.is_zero(x) is True:
        assert enclosure(ring, x, values).contains(0)


# --- substitution and values ---


@some
@given(expressions, places)
def test_balls_enclose_the_value_by_sympy(expression: Expression, values: dict[str, fmpq]) -> None:
    ring = new_ring()
    value = enclosure(ring, lowering(ring)(expression), values)
    assert value.overlaps(number_in_sympy(in_sympy(expression), values))
    assert value.rad() < 1e-20 * (1 + abs(value))


@some
@given(expressions, st.sampled_from(["y", "l", "w", "x_dot"]), rational_expressions, places)
def test_substitution_commutes_with_evaluation(
    expression: Expression, name: str, image: Expression, values: dict[str, fmpq]
) -> None:
    ring = new_ring()
    kind = {"y": "coordinate", "x_dot": "velocity"}.get(name, "parameter")
    if name == "l":
        image = positive(image)  # roots of l**2 were taken as l
    lowered = lowering(ring)
    try:
        there = ring.substitute(lowered(expression), {ring.index(kind, name.removesuffix("_dot")): lowered(image)})
    except SingularPoint:
        return
    symbols = {sympy.Symbol(name): in_sympy(image)}
    theirs = in_sympy(expression).subs(symbols)
    assert enclosure(ring, there, values).overlaps(number_in_sympy(theirs, values))


def test_substituting_a_zero_of_the_denominator_is_a_singular_point() -> None:
    ring = new_ring()
    with pytest.raises(SingularPoint):
        ring.substitute(lower(ring, "1/(x - l)"), {ring.index("coordinate", "x"): lower(ring, "l")})


def test_names_of_an_expression_are_what_the_ring_asks_for() -> None:
    assert names(parsed("x*l + chi")) <= set(new_ring().names())


# --- budgets ---


def test_too_many_terms_have_no_closed_form() -> None:
    with pytest.raises(NoClosedForm, match="terms are beyond the budget"):
        lower(new_ring(terms=50), "(x + y + l + m + w)**6")


def test_too_many_adjoined_elements_have_no_closed_form() -> None:
    with pytest.raises(NoClosedForm, match="more than 2"):
        lower(new_ring(spare=2), "1/(x + 1) + 1/(x + 2) + 1/(x + 3)")


def test_formulas_of_many_generators_are_bounded_by_their_memory() -> None:
    """The square of a sum of 230 letters has 26,565 terms; in a ring of 1,160 generators they take 30 MB."""
    names = [f"q{k}" for k in range(230)]
    for terms, fits in ((60_000, False), (120_000, True)):
        ring = Ring(names, [], [], dict.fromkeys(names, 1), terms=terms)
        total = sum((ring.generator("coordinate", name) for name in names), ring.zero)
        if fits:
            assert len(ring.reduce(ring.times(total, total))) == 230 * 231 // 2
        else:
            with pytest.raises(NoClosedForm, match="26565 terms are beyond the budget of 2"):
                ring.reduce(ring.times(total, total))


def test_three_squares_of_long_sums_are_put_in() -> None:
    """x**2 + y**2 + z**2, 16 terms for each of x, y, z: 3 * 136 products, and not those of one in the other."""
    letters = [f"{name}{k}" for name in "abcdef" for k in range(16)]
    ring = Ring([], [], ["x", "y", "z", *letters], {}, positive=[])
    held = [ring.generator("parameter", name) for name in letters]
    sums = [sum(held[k : k + 16], ring.zero) for k in (0, 16, 32)]
    x, y, z = (ring.generator("parameter", name) for name in "xyz")
    images = dict(zip((ring.index("parameter", name) for name in "xyz"), sums, strict=True))
    others = sum(held[48:52], ring.zero)
    assert ring.substitute(x * x + y * y + z * z + others, images) == sum((one * one for one in sums), others)
