"""Factors of polynomials with numbers of any length."""

from __future__ import annotations

from math import prod
from random import Random

import pytest
from flint import Ordering, fmpq_mpoly_ctx, fmpz_mpoly_ctx

from mbsym.algebra import factors
from mbsym.algebra.factors import irreducible_factors
from mbsym.algebra.failures import Limit, NoClosedForm

CONTEXTS = {"integers": fmpz_mpoly_ctx, "rationals": fmpq_mpoly_ctx}


@pytest.mark.parametrize("over", CONTEXTS)
@pytest.mark.parametrize("large", [7, 2**31 - 1, 2**31, 10**10 + 19, 10**40])
def test_the_product_is_factored_again(over: str, large: int) -> None:
    """Linear polynomials with coprime coefficients are irreducible, by hand."""
    x, y = CONTEXTS[over].get(["x", "y"], Ordering.lex).gens()
    parts = [large * x + y, x - y + large, large * x + (large + 1), y + 1]
    unit, powers = irreducible_factors(-6 * prod(parts) * parts[0])
    assert unit == -6
    assert {str(factor): exponent for factor, exponent in powers} == {
        str(part): 2 if part is parts[0] else 1 for part in parts
    }


def test_a_refusal_is_a_failure_with_its_limit() -> None:
    class Refusing:
        def factor(self) -> None:
            raise OverflowError("too large")

    with pytest.raises(NoClosedForm, match="OverflowError: too large") as refused:
        irreducible_factors(Refusing())
    assert refused.value.limit is Limit.FACTORS


@pytest.mark.parametrize("over", CONTEXTS)
@pytest.mark.parametrize("generators", [4, 100])
def test_the_factors_are_those_that_the_library_finds_by_itself(over: str, generators: int) -> None:
    """Factored among the generators that occur, or seen to be irreducible: the same, in the same order."""
    context = CONTEXTS[over].get([f"x{k}" for k in range(generators)], Ordering.lex)
    source, irreducible = Random(3), 0
    for _ in range(150):
        own = source.sample(context.gens(), source.randint(1, 4))
        product = context.constant(source.choice((-6, 1, 5)))
        for _ in range(source.randint(1, 3)):
            part = context.constant(source.randint(-4, 4))
            for x in own:
                part += source.randint(-3, 3) * x * source.choice(own) ** source.randint(0, 1)
            product *= part ** source.randint(1, 2)
        if over == "rationals":
            product = product / 7
        if product.is_zero():
            continue
        unit, powers = product.factor()
        assert irreducible_factors(product) == (unit, list(powers))
        irreducible += len(powers) == 1 and powers[0][1] == 1
    assert 10 < irreducible < 100


def test_what_was_asked_before_is_not_taken_for_another(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of one length and one degree in each generator, in contexts of other names and numbers; each factored once."""
    anew = []
    honest = factors._factored_anew
    monkeypatch.setattr(factors, "_KNOWN", {})
    monkeypatch.setattr(factors, "_factored_anew", lambda p, *more: anew.append(p) or honest(p, *more))
    for over in CONTEXTS.values():
        for names in (["x", "y"], ["x", "z"]):
            x, y = over.get(names, Ordering.lex).gens()
            for _ in range(2):
                for number in range(1, factors.MOST_ALIKE):
                    unit, powers = irreducible_factors(x**2 - number**2 * y**2)
                    assert unit == 1
                    assert {str(factor) for factor, _ in powers} == {str(x - number * y), str(x + number * y)}
    assert len(anew) == 4 * (factors.MOST_ALIKE - 1)
    monkeypatch.setattr(factors, "MOST_KNOWN", 3)
    for k in range(1, 9):
        irreducible_factors(x**k + y)
    assert len(factors._KNOWN) <= 4
