"""Slow manifolds against an independent derivation of that of the satellite with a damper, and cases done by hand."""

from __future__ import annotations

from fractions import Fraction
from random import Random

import numpy as np
import pytest
from conftest import SHIPPED, reference
from flint import Ordering, fmpq, fmpq_mpoly_ctx
from scipy.integrate import solve_ivp

import mbsym
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.algebra.quotients import Quotient, Series
from mbsym.analysis.expanding import expansion
from mbsym.problems.small_parameter import slow
from mbsym.problems.small_parameter.checks import residual_orders
from mbsym.problems.small_parameter.result import Outcome, scaled
from mbsym.problems.small_parameter.slow import steady_states
from mbsym.report.words.expansion_words import sentences

REFERENCE = reference("satellite-with-damper-slow")


@pytest.fixture(scope="module")
def damper():
    return mbsym.load(SHIPPED / "satellite-with-damper-slow.yaml")


@pytest.fixture(scope="module")
def third(damper):
    return expansion(damper, 3)


def made(variables, numerators, parameters=("eps",), denominator=None):
    """A field from functions of its generators."""
    context = fmpq_mpoly_ctx.get([*parameters, *variables], Ordering.lex)
    gens = dict(zip((*parameters, *variables), context.gens(), strict=True))
    below = context.constant(1) if denominator is None else denominator(**gens)
    return PolynomialField(
        context, tuple(parameters), tuple(variables), tuple(f(**gens) + 0 * below for f in numerators), below
    )


def value(c, at):
    return c.top(*at) / c.bottom(*at)


def test_every_coefficient_through_the_third_order(third):
    """x, omega1', omega2', omega' at random rational states."""
    manifold, random = third.manifold, Random(5)
    names = manifold.field.field.context.names()
    told = REFERENCE["slow_manifold"]
    series = dict(zip((*manifold.fast, *manifold.slow), (*manifold.functions, *manifold.flow), strict=True))
    pairs = (("x", "f (x = sum eps^n f_n)"), ("p", "omega1dot"), ("q", "omega2dot"), ("r", "omegadot"))
    for _ in range(3):
        numbers = {name: Fraction(random.randint(2, 30), random.randint(2, 30)) for name in names}
        at = [fmpq(x.numerator, x.denominator) for x in numbers.values()]
        known = numbers | {"omega": numbers["r"], "omega1": numbers["p"], "omega2": numbers["q"]}
        known["lambda_"] = (known["s"] - 1) * known["omega"] + known["eta"]
        for name, key in pairs:
            for order, text in told[key].items():
                expected = eval(text.replace("lambda", "lambda_"), {}, known)
                found = value(series[name].coefficient(int(order)), at)
                assert (int(found.p), int(found.q)) == (expected.numerator, expected.denominator), (name, order)


def test_what_is_left_is_of_the_next_order(third):
    assert third.manifold.fast == ("y", "x")
    assert third.manifold.residuals == (4, 4)


def test_a_wrong_coefficient_is_seen(third):
    """The check is told an x whose third coefficient has one sign changed."""
    manifold = third.manifold
    x = manifold.functions[1]
    wrong = Series(x.context, {**x.coefficients, 3: -x.coefficients[3]})
    assert residual_orders(manifold.field, manifold.fast, (manifold.functions[0], wrong)) == (3, 3)


def test_the_condition_of_stability_has_the_factor_that_the_print_lost(damper, third):
    """-delta lambda (lambda + omega) (lambda - omega)^2 < 0, with lambda = (s - 1) omega + eta."""
    outcome, conditions = third.fast
    assert (outcome, conditions) == (Outcome.HOLDS, ())
    outcome, conditions = third.slow
    assert outcome is Outcome.CONDITIONAL
    ring = damper.ring
    s, eta, omega = (ring.generator("parameter", name) for name in ("s", "eta", "omega"))
    turning = (s - 1) * omega + eta
    product = turning * (turning + omega)
    assert [one.polynomial for one in conditions if one.kind == "inequality"] == [product]
    assert {abs_of(p) for one in conditions for p in one.nonzero} <= {abs_of(turning - omega), abs_of(turning)}
    assert third.manifold.steady.zeros == 1
    refuted = [one.claim.place for one in damper.claims if one.refuted]
    assert refuted == ["section 4, last inequality"]


def abs_of(p):
    return str(p if p.leading_coefficient() > 0 else -p)


def test_the_error_of_the_reduced_roots_is_of_the_fourth_order(third):
    """Against 36 digits of the exact root at eps = 1/20, kappa = 1, delta = 2/5, s = 3/5, eta = omega = 1."""
    told = REFERENCE["reduced_eigenvalues_at_eps_1_20"]
    exact = complex(told["exact"].replace(" i", "j").replace(" ", ""))
    slow_part = third.manifold.steady.slow.polynomial
    names = third.manifold.field.field.context.names()
    numbers = {"kappa": 1, "delta": fmpq(2, 5), "s": fmpq(3, 5), "eta": 1, "omega": 1}
    at = [fmpq(numbers.get(name, 1)) for name in names]

    def errors(most, sign=1):
        def number(c, k):
            v = value(c, at)
            return float(int(v.p) / int(v.q)) * 0.05**k

        # The print has the other sign of the correction of order 3 in the stiffness.
        return abs(
            max(
                np.roots(
                    [
                        sum(
                            number(c, k) * (sign if (place, k) == (2, 3) else 1)
                            for k, c in one.coefficients.items()
                            if k <= most
                        )
                        for place, one in enumerate(slow_part)
                    ]
                ),
                key=lambda root: root.imag,
            )
            - exact
        )

    assert errors(2) == pytest.approx(told["error_order_2"], rel=2e-2)
    assert errors(3) == pytest.approx(told["error_order_3"], rel=2e-1)
    assert errors(3, -1) == pytest.approx(told["error_printed_sign"], rel=2e-2)


def test_for_finite_values_the_reduced_condition_misjudges():
    """Set V: lambda = 1/1000 and kappa = omega = 1 keep the reduced condition; divergence for eps^2 > lambda."""
    damper = mbsym.load(SHIPPED / "satellite-with-damper-slow.yaml")
    condition = next(one for one in damper.claims if one.claim.place == "no divergence")
    assert condition.holds
    numbers = {"s": Fraction(1), "eta": Fraction(1, 1000), "kappa": Fraction(1), "omega": Fraction(1)}
    found = expansion(damper, 3, numbers | {"rho": Fraction(0), "delta": Fraction(2, 5)})
    assert found.slow == (Outcome.HOLDS, ())


def test_a_linear_case_by_hand():
    """eps z' = -z + a s, s' = -s: z = a s/(1 - eps) on the manifold, so all coefficients are a s."""
    field = made(
        ("s", "z"), (lambda eps, a, s, z: -s * eps, lambda eps, a, s, z: a * s - z), ("eps", "a"), lambda eps, **_: eps
    )
    there = scaled(field, "eps", {})
    assert there.scales == (0, 1)
    fast = slow.fast_variables(there)
    assert fast == ("z",)
    functions = slow.manifold(there, fast, 4)
    _, a, s, _ = field.context.gens()
    assert {k: c.top for k, c in functions[0].coefficients.items()} == dict.fromkeys(range(5), a * s)
    assert residual_orders(there, fast, functions) == (5,)
    flow = slow.flow(there, fast, functions, 4)
    zero = Quotient.of(field.context.constant(0))
    steady = steady_states(there, flow, {"z": functions[0]}, {"s": zero, "z": zero}, 4)
    assert [one.lowest for one in (*steady.fast.minors, *steady.slow.minors)] == [-1, 0]
    assert steady.fast.minors[0].coefficients[-1].top == 1
    wrong = {"s": flow["s"] + flow["s"]}
    with pytest.raises(NoClosedForm, match="expansion is wrong"):
        steady_states(there, wrong, {"z": functions[0]}, {"s": zero, "z": zero}, 4)


def test_powers_say_the_same_as_a_parameter():
    """P eps and Q/eps in place of P and Q: z' = -Q z + s, s' = -P s, fast for large Q; z = s (1/Q + P/Q^2 + ...)."""
    field = made(("s", "z"), (lambda P, Q, s, z: -P * s, lambda P, Q, s, z: s - Q * z), ("P", "Q"))
    there = scaled(field, "mu", {"Q": -1})
    functions = slow.manifold(there, slow.fast_variables(there), 3)
    P, Q, s, _ = field.context.gens()
    found = functions[0].coefficients
    assert [found[k] for k in (1, 2, 3)] == [Quotient.of(s * P**n, Q ** (n + 1)) for n in range(3)]
    assert residual_orders(there, ("z",), functions) == (4,)


def test_a_matrix_that_depends_on_the_state():
    """eps z' = 1 - (1 + s) z, s' = 1: (1 + s) h_n = -h_(n-1)', so that h_n = (2n - 1)!!/(1 + s)^(2n + 1)."""
    field = made(
        ("s", "z"), (lambda eps, s, z: eps, lambda eps, s, z: 1 - (1 + s) * z), denominator=lambda eps, **_: eps
    )
    there = scaled(field, "eps", {})
    assert slow.fast_variables(there) == ("z",)
    functions = slow.manifold(there, ("z",), 3)
    _, s, _ = field.context.gens()
    found = functions[0].coefficients
    assert found == {n: Quotient.of(0 * s + c, (1 + s) ** (2 * n + 1)) for n, c in enumerate((1, 1, 3, 15))}
    assert residual_orders(there, ("z",), functions) == (4,)
    assert slow.divisors(there, ("z",), functions) == (-1 - s,)


def test_michaelis_and_menten():
    """eps c' = s - (s + k) c, s' = -s + (s + k - l) c: c = s/(s + k) + eps k l s/(s + k)^4 + ...

    From h_0' s'_0 = -(s + k) h_1 with s'_0 = -l s/(s + k).
    """
    field = made(
        ("s", "c"),
        (lambda eps, k, l, s, c: eps * ((s + k - l) * c - s), lambda eps, k, l, s, c: s - (s + k) * c),
        ("eps", "k", "l"),
        lambda eps, **_: eps,
    )
    there = scaled(field, "eps", {})
    functions = slow.manifold(there, slow.fast_variables(there), 2)
    _, k, l, s, _ = field.context.gens()
    found = functions[0].coefficients
    assert (found[0], found[1]) == (Quotient.of(s, s + k), Quotient.of(k * l * s, (s + k) ** 4))
    assert residual_orders(there, ("c",), functions) == (3,)


def test_a_lowest_order_that_is_solved_by_elimination():
    """eps x' = s - x, eps y' = x^2 - y, s' = -s: x = s/(1 - eps), y = s^2/((1 - eps)^2 (1 - 2 eps))."""
    field = made(
        ("s", "x", "y"),
        (lambda eps, s, x, y: -s * eps, lambda eps, s, x, y: s - x, lambda eps, s, x, y: x**2 - y),
        denominator=lambda eps, **_: eps,
    )
    there = scaled(field, "eps", {})
    functions = slow.manifold(there, slow.fast_variables(there), 2)
    _, s, _, _ = field.context.gens()
    assert {k: c.top for k, c in functions[1].coefficients.items()} == {0: s**2, 1: 4 * s**2, 2: 11 * s**2}
    assert residual_orders(there, ("x", "y"), functions) == (3, 3)


@pytest.mark.parametrize(
    ("rows", "reason"),
    [
        ((lambda eps, s, z: eps * z, lambda eps, s, z: -s), "no variable is fast"),
        ((lambda eps, s, z: -s * eps, lambda eps, s, z: 1 * s), "does not determine fast variables"),
        ((lambda eps, s, z: -s * eps, lambda eps, s, z: s - z**3), "does not determine fast variables"),
        ((lambda eps, s, z: -s * eps, lambda eps, s, z: (s - z) ** 2), "does not determine fast variables"),
    ],
)
def test_where_there_is_none_it_is_said(rows, reason):
    below = None if "no variable" in reason else (lambda eps, **_: eps)
    there = scaled(made(("s", "z"), rows, denominator=below), "eps", {})
    with pytest.raises(NoClosedForm, match=reason):
        slow.fast_variables(there)


def test_repelling_and_undecided_manifolds(damper, third):
    """eps z' = z - s repels; the flow of the damper has no friction up to order 2."""
    field = made(("s", "z"), (lambda eps, s, z: -s * eps, lambda eps, s, z: z - s), denominator=lambda eps, **_: eps)
    there = scaled(field, "eps", {})
    functions = slow.manifold(there, ("z",), 2)
    zero = Quotient.of(field.context.constant(0))
    flow = slow.flow(there, ("z",), functions, 2)
    steady = steady_states(there, flow, {"z": functions[0]}, {"s": zero, "z": zero}, 2)
    assert steady.fast.minors[0].coefficients[-1].top == -1
    second = expansion(damper, 2)
    assert second.slow[0] is Outcome.UNDECIDED  # friction comes in with the third order
    assert not second.manifold.steady.slow.decided


@pytest.mark.parametrize(
    ("rows", "free"),
    [
        # s steady whatever it is, z on the manifold with it: 1 zero root, a line of steady states
        ((lambda eps, s, u, z: 0 * s, lambda eps, s, u, z: -eps * u, lambda eps, s, u, z: u * s - z), ("s",)),
        # two zero roots, and a plane of steady states that is bent: z = u s
        ((lambda eps, s, u, z: 0 * s, lambda eps, s, u, z: 0 * s, lambda eps, s, u, z: u * s - z), ()),
        ((lambda eps, s, u, z: eps * z * s, lambda eps, s, u, z: eps * z * u, lambda eps, s, u, z: -z), ("s", "u")),
        # a Jordan block: s grows as u t
        ((lambda eps, s, u, z: eps * u, lambda eps, s, u, z: 0 * s, lambda eps, s, u, z: -z), ()),
        # a root that is zero in first approximation only
        ((lambda eps, s, u, z: -eps * s**3, lambda eps, s, u, z: -eps * u, lambda eps, s, u, z: -z), ()),
        # two lines that cross: not a plane
        ((lambda eps, s, u, z: eps * s * u, lambda eps, s, u, z: eps * s * u, lambda eps, s, u, z: -z), ()),
    ],
)
def test_a_set_of_steady_states_has_as_many_dimensions_as_roots_are_zero(rows, free):
    """eps z' = ..., about s = u = z = 0."""
    field = made(("s", "u", "z"), rows, denominator=lambda eps, **_: eps)
    there = scaled(field, "eps", {})
    functions = slow.manifold(there, ("z",), 2)
    zero = Quotient.of(field.context.constant(0))
    flow = slow.flow(there, ("z",), functions, 2)
    at = dict.fromkeys(("s", "u", "z"), zero)
    assert steady_states(there, flow, {"z": functions[0]}, at, 2).free == free


def test_the_words_of_rumyantsev(third):
    """Section 3 of the paper: steady with any rate of spin; stabilizable where all roots but one are to the left."""
    assert third.manifold.steady.free == ("r",)
    assert third.stabilizable[0] is Outcome.CONDITIONAL
    (stabilizable,) = (one for one in sentences(third) if "and stabilizable" in one.text)
    assert {x.name for x in stabilizable.gaps["others"]} == {"p", "q", "x", "y"}
    told = [one.text for one in sentences(changed("delta: {sign: positive", "delta: {sign: negative"))]
    assert any("It is not stable with respect to" in text for text in told)
    assert not any("stabilizable" in text for text in told)
    without = changed("  - damper: {coordinate: x, coefficient: eps*delta*A}\n", "")
    assert without.stabilizable[0] is Outcome.UNDECIDED


def changed(old, new):
    text = (SHIPPED / "satellite-with-damper-slow.yaml").read_text(encoding="utf-8")
    assert old in text
    return expansion(mbsym.loads(text.replace(old, new).replace("delta: 0.4, ", "")), 3)


def test_where_the_friction_is_negative_none_or_unknown():
    """The fast roots are -delta/2 + O(eps) +- i sqrt(kappa/eps)."""
    assert changed("delta: {sign: positive", "delta: {sign: negative").fast == (Outcome.FAILS, ())
    unknown = changed("delta: {sign: positive", "delta: {sign: real").fast
    assert (unknown[0], [one.kind for one in unknown[1]]) == (Outcome.CONDITIONAL, ["inequality"])
    without = changed("  - damper: {coordinate: x, coefficient: eps*delta*A}\n", "")
    assert (without.fast, without.slow) == ((Outcome.UNDECIDED, ()), (Outcome.UNDECIDED, ()))
    inclined = changed("  a: 0\n", "  a: 1\n")
    assert (inclined.manifold.steady, inclined.fast[0]) == (None, Outcome.UNDECIDED)
    assert "motion" in inclined.missing


def test_the_error_of_the_flow_against_a_run_of_all_equations(third):
    """Largest errors of omega1, omega2, omega on [0, 10] from (3/10, 1/5, 1): orders 3 and 4 (3.01, 4.01 there)."""
    manifold = third.manifold
    field = manifold.field.field
    names = field.context.names()
    numbers = {"kappa": 1.0, "delta": 0.4, "s": 0.6, "rho": 0.25, "eta": 1.0, "omega": 1.0}

    def compiled(p):
        terms = (
            "*".join([repr(int(c.p) / int(c.q)), *(f"{n}**{e}" for n, e in zip(names, m, strict=True) if e)])
            for m, c in p.to_dict().items()
        )
        return "(" + ("+".join(terms) or "0.0") + ")"

    def function(texts, arguments):
        return eval(f"lambda {', '.join(arguments)}: [{', '.join(texts)}]", dict(numbers))

    def series(one, most):
        kept = (k for k in one.coefficients if k <= most)
        return "+".join(
            f"eps**{k}*{compiled(one.coefficients[k].top)}/{compiled(one.coefficients[k].bottom)}" for k in kept
        )

    below = compiled(field.denominator)
    whole = function([f"{compiled(p)}/{below}" for p in field.numerators], ("eps", *field.variables))
    start = dict(zip(manifold.slow, (0.3, 0.2, 1.0), strict=True))
    times = np.linspace(0, 10, 41)
    errors = {2: [], 3: []}

    def run(f, eps, first):
        done = solve_ivp(lambda _, x: f(eps, *x), (0, 10), first, "DOP853", times, rtol=1e-12, atol=1e-14)
        assert done.success
        return done.y

    for eps in (1 / 20, 1 / 40, 1 / 80):
        onto = function([series(one, 3) for one in manifold.functions], ("eps", *manifold.slow))
        all_of = start | dict(zip(manifold.fast, onto(eps, *start.values()), strict=True))
        truth = run(whole, eps, [all_of[name] for name in field.variables])
        places = [field.variables.index(name) for name in manifold.slow]
        for order, kept in errors.items():
            flow = function([series(one, order) for one in manifold.flow], ("eps", *manifold.slow))
            kept.append(abs(run(flow, eps, list(start.values())) - truth[places]).max())
    slopes = {order: np.log2(kept[1] / kept[2]) for order, kept in errors.items()}
    assert slopes[2] == pytest.approx(3, abs=0.1)
    assert slopes[3] == pytest.approx(4, abs=0.1)
