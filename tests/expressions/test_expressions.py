"""The expression parser: exact numbers, the grammar, printing back, bounds."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st
from properties import settings

from mbsym.expressions.parser import parse_expression
from mbsym.expressions.place import Complaints, Span
from mbsym.expressions.tree import (
    FUNCTIONS,
    SMOOTH,
    Call,
    Expression,
    Name,
    Negative,
    Number,
    Operation,
    add,
    differentiate,
    subtract,
    text,
)


def parse(written: str) -> tuple[Expression | None, Complaints]:
    complaints = Complaints()
    return parse_expression(written, complaints, lambda start, end: Span(1, start + 1, max(1, end - start))), complaints


def good(written: str) -> Expression:
    tree, complaints = parse(written)
    assert tree is not None, complaints
    assert not complaints
    return tree


@pytest.mark.parametrize(
    ("written", "value"),
    [("0.1", "1/10"), ("1e-3", "1/1000"), (".5", "1/2"), ("2.", "2"), ("12.50E+1", "125"), ("007", "7"), ("0e9", "0")],
)
def test_numbers_are_exact(written: str, value: str) -> None:
    assert good(written) == Number(Fraction(value))


@pytest.mark.parametrize(
    ("written", "grouped"),
    [
        ("-x**2", "-(x**2)"),
        ("a - b - c", "(a - b) - c"),
        ("a/b/c", "(a/b)/c"),
        ("a/b*c", "(a/b)*c"),
        ("-a*b", "(-a)*b"),
        ("a*-b", "a*(-b)"),
        ("a + b*c**2", "a + (b*(c**2))"),
        ("x**-1", "x**(-1)"),
        ("+x", "x"),
        ("-2*x^2", "(-2)*(x**2)"),
        ("x^-1", "x**(-1)"),
    ],
)
def test_precedence_is_that_of_python(written: str, grouped: str) -> None:
    assert good(written) == good(grouped)


@pytest.mark.parametrize(
    ("printed", "written"),
    [("x'^2", "x_dot**2"), ("theta1''+c*x'", "theta1_ddot + c*x_dot"), ("sin(x')", "sin(x_dot)")],
)
def test_velocities_and_powers_are_read_as_results_print_them(printed: str, written: str) -> None:
    assert good(printed) == good(written)


@pytest.mark.parametrize("strange", ["x'''", "2'", "(x)'", "sin'(x)"])
def test_a_prime_stands_behind_a_name_twice_at_most(strange: str) -> None:
    assert parse(strange)[0] is None


def test_exponents_are_folded_to_one_rational_number() -> None:
    assert good("x**(1/2)") == Operation("**", Name("x"), Number(Fraction(1, 2)))
    assert good("x**2**3") == Operation("**", Name("x"), Number(Fraction(8)))


def test_spans_cover_what_they_name() -> None:
    tree = good("a + sin(bb)*c")
    assert isinstance(tree, Operation)
    assert tree.span == Span(1, 1, 13)
    assert tree.right.span == Span(1, 5, 9)


leaves = st.one_of(
    st.sampled_from(["x", "theta_dot", "pi", "J1"]).map(Name),
    st.decimals(min_value=0, max_value=10**9, places=6).map(lambda value: Number(Fraction(value))),
)
exponents = st.fractions(min_value=-9, max_value=9, max_denominator=9).map(Number)


def _grow(inner: st.SearchStrategy[Expression]) -> st.SearchStrategy[Expression]:
    return st.one_of(
        inner.map(Negative),
        st.builds(Operation, st.sampled_from("+-*/"), inner, inner),
        st.builds(Operation, st.just("**"), inner, exponents),
        st.builds(Call, st.sampled_from([*SMOOTH, "abs", "sign", "step"]), inner),
        st.builds(Call, st.just("pulse"), inner, st.none(), st.tuples(inner, inner)),
    )


@settings(max_examples=300)
@given(st.recursive(leaves, _grow, max_leaves=12))
def test_parsing_what_was_printed_gives_the_same_tree(tree: Expression) -> None:
    parsed, complaints = parse(text(tree))
    if parsed is None:  # only for a reason: a zero divisor, or powers of powers of powers
        assert {item.code for item in complaints} <= {"division-by-zero", "too-long"}
        return
    assert {item.code for item in complaints.errors} <= {"no-number"}
    assert parsed == tree


@settings(max_examples=300)
@given(st.text(alphabet="ab1.2e+-*/()^, sincoθ\x00'_", max_size=40))
def test_any_text_gives_a_tree_or_complaints(written: str) -> None:
    tree, complaints = parse(written)
    assert (tree is None) == bool({item.code for item in complaints.errors} - {"no-number"})
    if tree is not None:
        assert parse(text(tree))[0] == tree


@pytest.mark.parametrize(
    ("written", "code"),
    [
        ("9**9**9**9", "bad-exponent"),
        ("(" * 100_000, "too-long"),
        ("(" * 10_000, "too-deep"),
        ("-" * 10_000 + "x", "too-deep"),
        ("x" + "+x" * 9_000, "too-deep"),
        ("x*(" * 6_000 + "x" + ")" * 6_000, "too-long"),
        ("1" * 5_000, "bad-number"),
        ("1e-999999999999", "bad-number"),
        ("(((((9**64)**64)**64)**64)**64)/((((9**64)**64)**64)**64)", "too-long"),
        ("sin(" * 3_000 + "x" + ")" * 3_000, "too-deep"),
        ("__import__('os')", "bad-character"),
        ("().__class__", "bad-character"),
        ("()", "bad-expression"),
        ("lambda: 0", "bad-character"),
        ("x if x else y", "bad-expression"),
        ("open(x)", "unknown-function"),
        ("x // 2", "bad-expression"),
        ("x % 2", "bad-character"),
        ("x\ty\0", "bad-character"),
    ],
)
def test_hostile_texts_are_refused_at_once(written: str, code: str) -> None:
    tree, complaints = parse(written)
    assert tree is None
    assert code in {item.code for item in complaints}


@pytest.mark.parametrize(
    ("written", "hint"),
    [
        ("cosine(x)", "did you mean 'cos'?"),
        ("Sine(x)", "did you mean 'sin'?"),
        ("coshyp(x)", "did you mean 'cosh'?"),
        ("arcsin(x)", "write atan(x/sqrt(1 - x**2)) for asin(x)"),
        ("cbrt(x)", "the functions are " + ", ".join(FUNCTIONS)),
        ("sgn(x)", "write sign"),
        ("Heaviside(x)", "write step"),
        ("pulse(x, 1)", "write pulse(x, start, end)"),
        ("pulse(x, 1, 2, 3)", "write pulse(x, start, end)"),
        ("0,5", "numbers have a decimal point: write 0.5"),
        ("1_000", "digits stand together: write 1000"),
        ("1.2.3", "a number has one decimal point"),
        ("ℓ", "names are Latin letters, digits and _: write l"),
        ("Θ", "names are Latin letters, digits and _: write Theta"),
        ("ς", "names are Latin letters, digits and _: write sigma"),
        ("é", "names are Latin letters, digits and _: write e"),
    ],
)
def test_hints_name_what_was_meant(written: str, hint: str) -> None:
    assert [item.hint for item in parse(written)[1]] == [hint]


def test_long_sums_may_be_grouped() -> None:
    group = "(" + " + ".join(["x"] * 100) + ")"
    assert good(" + ".join([group] * 10))


def test_a_shared_tree_is_differentiated_once() -> None:
    """x_0 = x, x_(k+1) = x_k x_k: 60 nodes that stand for 2^60 factors; the derivative of x^(2^60) at 1 is 2^60."""
    tree: Expression = Name("x")
    for _ in range(60):
        tree = Operation("*", tree, tree)
    known: dict[int, Fraction] = {}

    def value(node: Expression) -> Fraction:
        if id(node) not in known:
            match node:
                case Number(number):
                    known[id(node)] = number
                case Name("x"):
                    known[id(node)] = Fraction(1)
                case Operation("*", left, right):
                    known[id(node)] = value(left) * value(right)
                case Operation("+", left, right):
                    known[id(node)] = value(left) + value(right)
        return known[id(node)]

    assert value(differentiate(tree, "x")) == 2**60
    assert differentiate(tree, "y") == Number(Fraction(0))


@pytest.mark.parametrize(
    ("right", "difference", "total"),
    [
        ("-6", "a + 6", "a - 6"),
        ("-6*b", "a + 6*b", "a - 6*b"),
        ("-b/c", "a + b/c", "a - b/c"),
        ("-(b - c)", "a + b - c", "a - (b - c)"),
        ("(-b)**2", "a - (-b)**2", "a + (-b)**2"),
        ("b - 6", "a - (b - 6)", "a + b - 6"),
    ],
)
def test_what_begins_with_a_minus_is_added_and_taken_away_without_it(right: str, difference: str, total: str) -> None:
    values = {"a": Fraction(7), "b": Fraction(3), "c": Fraction(5)}
    for made, expected in ((subtract, difference), (add, total)):
        tree = made(Name("a"), good(right))
        sign = -1 if made is subtract else 1
        assert eval(text(tree), {}, values) == values["a"] + sign * eval(right, {}, values)
        assert same_signs(text(tree)) == same_signs(expected)


def same_signs(written: str) -> str:
    """A text without the brackets that a writer may set or leave out."""
    return written.replace("(", "").replace(")", "").replace(" ", "")


@pytest.mark.parametrize(
    "written",
    [
        "1/(sqrt(2)**2 - 2)",
        "1/(sqrt(5 + 2*sqrt(6)) - sqrt(2) - sqrt(3))",  # (sqrt 2 + sqrt 3)^2 = 5 + 2 sqrt 6
        "1/(cos(pi/3) - 1/2)",
        "x/(atan(1) - pi/4)",
        "(sqrt(2) - sqrt(8)/2)**-2",
        "log(0)",
        "log(cos(pi/2))",
        "log(-pi)",
        "sqrt(-1/10**50)",
        "sqrt(3 - pi)",
        "(-1)**(1/2)",
        "tan(pi/2)",
        "x*tan(-5*pi/2)",
        "exp(exp(exp(10)))",
        "step(log(0))",
    ],
)
def test_a_part_that_is_no_real_number_is_complained_of(written: str) -> None:
    _, complaints = parse(written)
    assert [item.code for item in complaints] == ["no-number"]


@pytest.mark.parametrize(
    "written",
    [
        "1/(sqrt(2)**2 - 2 + 1/10**50)",
        "log(1/10**50)",
        "sqrt(sqrt(2)**2 - 2)",
        "tan(pi/2 - 1/10**50)",
        "exp(1000)/exp(999)",
        "1/sin(exp(exp(10)))",  # e**22026 has 9,566 digits: nothing is known of its sine
        "log(x - x)",
        "sqrt(x)/(y - 1)",
        "0*log(2)",
        "pulse(1, 1, 1)",
    ],
)
def test_what_is_a_number_or_not_known_to_be_none_is_taken(written: str) -> None:
    assert not parse(written)[1]


@pytest.mark.parametrize(
    "zero", ["8**(1/2) - 2*2**(1/2)", "sqrt(8) - 2*sqrt(2)", "4**(1/2) - 2", "2 - 6/3", "sin(pi)", "0**(1/2)"]
)
def test_a_division_by_zero_is_found_however_zero_is_written(zero: str) -> None:
    """Roots that are written as powers were looked at with 53 bits, however many were asked for."""
    for written in (f"1/({zero})", f"x + sin(y)/({zero})"):
        _, complaints = parse(written)
        assert ["division by zero" in one.message for one in complaints] == [True], written
