"""Claims about normal forms: D_4 of two degrees of freedom, and the first Lyapunov coefficient of one pair of roots.

Of D_4 only counts where it vanishes, of the coefficient only its sign: publications multiply them by what never does,
or is positive.  Equal formulas agree; so do multiples by numbers, powers of parameters and what is not zero where
problem 11 has the formula (frequencies, their difference, resonances).  With every other factor f = claimed/derived the
claim is refuted by two points in one piece of the parameters at which f has different signs (of the coefficient: one
point at which f < 0), else it is undecided.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from typing import Any

from flint import fmpq, fmpq_poly

from mbsym.algebra import rationals
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.rationals import middle
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message
from mbsym.formulas.formula import Formula
from mbsym.model.claims import Claim
from mbsym.model.system import System, rational
from mbsym.problems.claims.comparison import over_common_denominator
from mbsym.problems.claims.result import ClaimResult, Derived, Outcome, in_parameters, on_relations
from mbsym.problems.claims.symbols import Symbols
from mbsym.problems.normal_forms.result import Focus, InSymbols

#: The kinds of claim that this is about.
DETERMINANT, COEFFICIENT = "normal form determinant", "lyapunov coefficient"

_ANOTHER = "it is the derived one times what was not seen to vanish, nor not to: perhaps another normalisation"
_MEETS = {">": lambda x: x > 0, ">=": lambda x: x >= 0, "!=": lambda x: x != 0}


def examined(derived: Derived, claim: Claim, about: str) -> ClaimResult:
    """One claim of these kinds.  Raises NoClosedForm where problem 11 has no such formula."""
    ring, forms = derived.ring, derived.normal_forms
    symbolic = forms.in_symbols
    if isinstance(symbolic, InSymbols) and claim.kind == DETERMINANT:
        truth, positive = symbolic.determinant, [symbolic.trace, symbolic.product, symbolic.discriminant]
        nonzero = [*positive, *(formula for _, formula in symbolic.resonances)]
    elif isinstance(symbolic, Focus) and claim.kind == COEFFICIENT:
        truth, positive = symbolic.coefficient, [symbolic.square]
        nonzero = positive
    else:
        raise NoClosedForm(
            "no [[kind]] in parameters: [[why]]",
            kind=Message(claim.kind),
            why=forms.no_symbols or "problem 11 has another case",
        )
    claimed = in_parameters(derived, Symbols.of(derived).polynomial(derived.parameters_scene, claim))
    claimed, known = on_relations(derived, claim, claimed), on_relations(derived, claim, truth.polynomial)
    result = ClaimResult(claim, about, Outcome.EXACT, truth)
    difference = ring.reduce(claimed - known)
    if ring.is_zero(difference):
        return result
    result = replace(result, difference=Formula(ring, difference))
    if ring.is_zero(claimed) or ring.is_zero(known):
        return replace(result, outcome=Outcome.DIFFERS)
    quotient = _Quotient.of(ring, claimed, known)
    left = quotient.without([ring.fraction(formula.polynomial)[0] for formula in nonzero])
    sign = derived.signs.sign(quotient.product)
    agrees = left.is_monomial and derived.signs.never_zero(left.product)
    if agrees and (claim.kind == DETERMINANT or sign == "positive"):
        return replace(result, outcome=Outcome.FACTOR, factor=quotient.formula, difference=None)
    if claim.kind == COEFFICIENT and sign == "negative":
        return replace(result, outcome=Outcome.DIFFERS, remark="its sign is the opposite one")
    remark = _contrary(derived, claim, left if claim.kind == DETERMINANT else quotient, positive)
    return replace(result, outcome=Outcome.DIFFERS if remark else Outcome.UNDECIDED, remark=remark or _ANOTHER)


def _contrary(derived: Derived, claim: Claim, quotient: _Quotient, positive: Sequence[Formula]) -> str:
    """Where claimed/derived has the sign that it must not have; "" where no such place was found."""
    before: tuple[str, fmpq] | None = None
    for value in _values(derived, quotient, [derived.ring.fraction(formula.polynomial) for formula in positive]):
        if claim.kind == COEFFICIENT and value is not None and value[1] < 0:
            return Message("at [[here]] its sign is the opposite one", here=value[0])
        if claim.kind == DETERMINANT and value is not None and before is not None and value[1] * before[1] < 0:
            # Nothing but a zero of the quotient, or of its denominator, is between them.
            signs = [Message("positive"), Message("negative")]
            if value[1] >= 0:
                signs.reverse()
            return Message(
                "claimed/derived is [[first]] at [[there]], [[second]] at [[here]]",
                first=signs[0],
                there=before[0],
                second=signs[1],
                here=value[0],
            )
        before = value
    return ""


@dataclass(frozen=True)
class _Quotient:
    """top/bottom in lowest terms."""

    ring: Ring
    top: Polynomial
    bottom: Polynomial

    @staticmethod
    def of(ring: Ring, x: Polynomial, y: Polynomial) -> _Quotient:
        return _Quotient(ring, *ring.lowest_terms(*over_common_denominator(ring, x, y)))

    @property
    def product(self) -> Polynomial:
        """It has the sign of the quotient."""
        return self.ring.reduce(self.ring.times(self.top, self.bottom))

    @property
    def formula(self) -> Formula:
        return Formula(self.ring, self.ring.ratio(self.top, self.bottom))

    @property
    def is_monomial(self) -> bool:
        return len(self.top) == 1 and len(self.bottom) == 1

    def without(self, nonzero: Sequence[Polynomial]) -> _Quotient:
        """Divided by everything that it shares with polynomials that vanish nowhere."""
        parts = []
        for part in (self.top, self.bottom):
            for other in nonzero:
                while not (common := self.ring.common_factor(part, other)).is_constant():
                    shorter = self.ring.quotient(part, common)
                    if shorter is None:
                        break
                    part = shorter
            parts.append(part)
        return _Quotient(self.ring, parts[0], parts[1])


def _values(
    derived: Derived, quotient: _Quotient, positive: Sequence[tuple[Polynomial, Any]]
) -> Iterator[tuple[str, fmpq] | None]:
    """Signs of the quotient in the intervals between the zeros of everything, along each parameter upwards.

    None where a condition does not hold, or ends: what stands side by side is in one piece of the region.  The other
    parameters have the values of the description, or are 1.
    """
    ring, system = derived.ring, derived.system
    product = quotient.product
    conditions = [(p, relation) for p, relation in derived.signs.assumptions]
    conditions += [(_times(ring, fraction), ">") for fraction in positive]
    values = _start(system)
    for name in values:
        others = {other: x for other, x in values.items() if other != name}
        if product.degrees()[ring.index("parameter", name)] <= 0:
            continue
        along = [_along(ring, p, name, others) for p in (product, *(p for p, _ in conditions))]
        if any(polynomial is None for polynomial in along):
            continue
        whole, *tests = (polynomial for polynomial in along if polynomial is not None)
        sign = next((parameter.sign for parameter in system.parameters if parameter.name == name), "real")
        tests.append(fmpq_poly([0, -1 if sign in ("negative", "nonpositive") else 1] if sign != "real" else [1]))
        ends = [*(relation for _, relation in conditions), "!=" if sign == "nonzero" else ">"]
        yield None
        shared = any(test.gcd(whole).degree() > 0 for test in tests)
        for x in _between([whole, *tests]):
            holds = all(_MEETS[relation](p(x)) for p, relation in zip(tests, ends, strict=True))
            yield (f"{name} = {x}", whole(x)) if holds else None
            if shared:
                yield None


def _start(system: System) -> dict[str, fmpq]:
    """A value for every parameter: its own if that is rational, else the sign's."""
    values = {}
    for parameter in system.parameters:
        value = None if parameter.value is None else rational(parameter.value)
        plain = Fraction(-1 if parameter.sign in ("negative", "nonpositive") else 1)
        value = plain if value is None else value
        values[parameter.name] = rationals.exact(value)
    return values


def _times(ring: Ring, fraction: tuple[Polynomial, Any]) -> Polynomial:
    """A polynomial with the sign of a fraction."""
    top, factors = fraction
    for factor, exponent in factors:
        if exponent % 2:
            top = ring.times(top, factor)
    return top


def _along(ring: Ring, p: Polynomial, name: str, others: Mapping[str, fmpq]) -> fmpq_poly | None:
    """A polynomial in one parameter; None where it holds anything but parameters."""
    place = ring.index("parameter", name)
    known = {ring.index("parameter", other): x for other, x in others.items()}
    coefficients: dict[int, fmpq] = {}
    for monomial, c in p.terms():
        term = fmpq(c)
        for k, exponent in enumerate(monomial):
            if exponent and k != place:
                if k not in known:
                    return None
                term *= known[k] ** int(exponent)
        coefficients[int(monomial[place])] = coefficients.get(int(monomial[place]), fmpq(0)) + term
    return fmpq_poly([coefficients.get(k, fmpq(0)) for k in range(max(coefficients, default=0) + 1)])


def _between(polynomials: Sequence[fmpq_poly]) -> Iterator[fmpq]:
    """A rational number in each interval between neighbouring real zeros, and beyond the outermost."""
    whole = fmpq_poly([1])
    for polynomial in polynomials:
        if polynomial.degree() > 0:
            whole *= polynomial
    roots: list[Any] = [pair for factor, _ in whole.factor()[1] for pair in factor.numer().complex_roots()]
    zeros = sorted(middle(root.real) for root, _ in roots if root.imag == 0)
    if not zeros:
        yield fmpq(0)
        return
    yield zeros[0] - 1
    for low, high in pairwise(zeros):
        if low < high:
            yield _simple(low, high)
    yield zeros[-1] + 1


def _simple(low: fmpq, high: fmpq) -> fmpq:
    """A number of few digits between two different ones."""
    middle = (low + high) / 2
    digits = fmpq(1)
    while True:
        rounded = fmpq((middle * digits + fmpq(1, 2)).floor()) / digits
        if low < rounded < high:
            return rounded
        digits *= 10
