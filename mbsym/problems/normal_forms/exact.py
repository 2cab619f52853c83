"""What normal forms need exactly: resonances at rational parameters, and formulas in parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from math import gcd, lcm
from typing import Any

from flint import arb, fmpq, fmpq_poly

from mbsym.algebra import rationals
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.factors import occurring
from mbsym.algebra.failures import Failure, NoClosedForm, NoValue, message_of
from mbsym.algebra.matrices import dot, faddeev
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.tower import Element, Tower, angle_in
from mbsym.problems.normal_forms.expansion import Expansion, Numbers


def over_tower(found: Expansion, tower: Tower, values: Mapping[str, Fraction]) -> Numbers:
    """The expansion with ``values`` put in; what has none is a parameter of the tower."""
    environment: dict[str, Any] = {name: tower.number(value) for name, value in values.items()}
    environment |= {name: tower.parameter(name) for name in tower.parameters}
    carry = Carrier(found.scene.ring, tower, environment)
    return Numbers(found, carry, tower.reciprocal, tower.zero, tower.one)


def occurring_parameters(found: Expansion) -> list[str]:
    """The parameters in the coefficients, within what is adjoined as well."""
    ring = found.scene.ring
    parts = [*found.lagrangian, *(part for one in found.forces for part in one)]
    pending = [x for part in parts for x in part.values()]
    seen: set[int] = set()
    while pending:
        fresh = set(occurring([pending.pop()])) - seen
        seen |= fresh
        pending += [argument for k in fresh if (argument := ring.generators[k].argument) is not None]
    held = [ring.generators[k] for k in sorted(seen) if ring.generators[k].argument is None]
    plain = {g.name for g in held if g.kind == "parameter"}
    names = [parameter.name for parameter in found.scene.system.parameters]
    angles = {g.name: g.denominator for g in held if g.kind in ("sine", "cosine") and g.name in names}
    cosines = [f"cos({name if share == 1 else f'{name}/{share}'})" for name, share in angles.items()]
    return [*(name for name in names if name in plain), *cosines]


def letter(ring: Ring, name: str) -> Polynomial:
    """A parameter of a tower in the ring, a sine or cosine of one, too."""
    inside = angle_in(name)
    if inside is None:
        return ring.generator("parameter", name)
    return ring.generator({"cos": "cosine", "sin": "sine"}[inside[0]], inside[1])


class Resonant:
    """Whether k.w = 0 for the frequencies w of z = -w^2, q(z) = 0: by enclosures where it is not, exactly where it is.

    ``coefficients`` of q, low to high and monic, are exact; None where they are not known so: then no resonance is ever
    affirmed.
    """

    def __init__(self, tower: Tower | None, coefficients: Sequence[Element] | None) -> None:
        self.tower, self.coefficients = tower, coefficients
        self._squares = None if coefficients is None else rational_squares(tower, coefficients)

    @property
    def zero(self) -> bool:
        """Whether a root is zero exactly."""
        return self.coefficients is not None and self.coefficients[0].is_zero()

    @property
    def equal(self) -> bool:
        """Whether there are two frequencies that are equal exactly."""
        if self.coefficients is None or self.tower is None or len(self.coefficients) != 3:
            return False
        constant, trace = self.coefficients[:2]
        return (trace * trace - constant * 4).is_zero()

    def __call__(self, vector: tuple[int, ...], frequencies: Sequence[arb]) -> bool | None:
        total = sum((k * w for k, w in zip(vector, frequencies, strict=True)), arb(0))
        if total != 0:
            return False
        if self.coefficients is None or self.tower is None:
            return None
        if len(frequencies) == 2:
            return True if resonance(self.tower, self.coefficients, vector).is_zero() else None
        if len(frequencies) == 3 and all(abs(k) == 1 for k in vector):
            return True if sum_of_others(self.coefficients).is_zero() else None
        return self._by_square_roots(vector, frequencies)

    def _by_square_roots(self, vector: tuple[int, ...], frequencies: Sequence[arb]) -> bool | None:
        """Square roots of different square-free numbers are independent over the rationals."""
        if self._squares is None:
            return None
        totals: dict[int, fmpq] = {}
        for k, w in zip(vector, frequencies, strict=True):
            square = next((x for x in self._squares if (w * w).contains(x)), None)
            if square is None:
                return None
            number, factor = square.p * square.q, fmpq(1, square.q)
            free = 1
            for prime, exponent in number.factor():
                factor *= fmpq(prime) ** (exponent // 2)
                free *= int(prime) ** (exponent % 2)
            totals[free] = totals.get(free, fmpq(0)) + k * factor
        return not any(totals.values())


def rational_squares(tower: Tower | None, coefficients: Sequence[Element]) -> list[fmpq] | None:
    """w^2 for all roots, if all of them are rational numbers."""
    assert tower is not None
    numbers = [x for one in coefficients if (x := tower.rational(one)) is not None]
    if len(numbers) < len(coefficients):
        return None
    _, factors = fmpq_poly(numbers).factor()
    if any(factor.degree() != 1 for factor, _ in factors):
        return None
    return [factor[0] / factor[1] for factor, _ in factors]


def resonance(tower: Tower, coefficients: Sequence[Element], vector: Sequence[int]) -> Element:
    """c_0 (k_1^2 + k_2^2)^2 - (k_1 k_2 c_1)^2: zero where w1 : w2 or w2 : w1 is |k_1| : |k_2|.

    c_1 = w1^2 + w2^2 and c_0 = w1^2 w2^2.
    """
    a, b = (int(k) ** 2 for k in vector)
    return coefficients[0] * ((a + b) ** 2) - coefficients[1] * coefficients[1] * (a * b)


def sum_of_others(coefficients: Sequence[Element]) -> Element:
    """(w1 + w2 + w3)(-w1 + w2 + w3)(w1 - w2 + w3)(w1 + w2 - w3) = 4 e_2 - e_1^2 with e_1, e_2 of the squares."""
    _, e2, e1 = coefficients[:3]
    return e2 * 4 - e1 * e1


def even_part(matrix: Sequence[Sequence[Any]], zero: Any, one: Any) -> list[Any]:
    """q(z) of det(lambda - A) = q(lambda^2), low to high: that of a Hamiltonian system."""
    return faddeev(matrix, zero, one)[1][::2]


def two_eigenvectors(matrix: Sequence[Sequence[Element]], trace: Element) -> list[Element]:
    """The entries of A^2 + w^2, 2 w^2 = ``trace``: zero where each of two equal roots has two eigenvectors."""
    half, columns = trace / 2, list(zip(*matrix, strict=True))
    square = [[dot(row, column) for column in columns] for row in matrix]
    return [x + half if i == j else x for i, row in enumerate(square) for j, x in enumerate(row)]


def in_ring(tower: Tower, ring: Ring, x: Element) -> Polynomial:
    """The element as a formula of the ring.  Raises NoClosedForm where that outgrows its budget."""

    def carried(polynomial: Any) -> Polynomial:
        total = ring.zero
        for monomial, coefficient in polynomial.terms():
            term = ring.number(rationals.fraction(coefficient))
            for index, exponent in enumerate(monomial):
                if exponent:
                    term = ring.times(term, generator(index) ** int(exponent))
            total = total + term
        return ring.reduce(total)

    def generator(index: int) -> Polynomial:
        kind = tower.kind(index)
        return letter(ring, kind) if isinstance(kind, str) else ring.square_root(carried(kind))

    return ring.reduce(ring.times(carried(x.top), ring.reciprocal(carried(x.bottom))))


def common_factor(tower: Tower, even: Sequence[Element], odd: Sequence[Element]) -> list[Element]:
    """The greatest common divisor of two polynomials over the tower, low to high, monic; [1] where there is none.

    Raises SingularPoint where a leading coefficient is a divisor of zero.
    """
    a, b = trimmed(even), trimmed(odd)
    while b:
        lead = tower.reciprocal(b[-1])
        rest = list(a)
        while len(rest) >= len(b):
            factor, shift = rest[-1] * lead, len(rest) - len(b)
            rest = [x - factor * b[k - shift] if k >= shift else x for k, x in enumerate(rest)][:-1]
        a, b = b, trimmed(rest)
    lead = tower.reciprocal(a[-1])
    return [x * lead for x in a]


def trimmed(polynomial: Sequence[Element]) -> list[Element]:
    """Without leading zeros."""
    found = list(polynomial)
    while found and found[-1].is_zero():
        found.pop()
    return found


def known(compute: Any) -> tuple[Any, str]:
    """A value, or why there is none."""
    try:
        return compute(), ""
    except ZeroDivisionError:
        return None, "a divisor vanishes for all parameters"
    except NoValue as reason:
        if reason.args[0] != "pi":
            return None, message_of(reason)
        return None, "pi in the coefficients: only square roots are exact here"
    except (Failure, NoClosedForm) as reason:
        return None, message_of(reason)


def primitive(tower: Tower, x: Element) -> Element:
    """The numerator, with whole coefficients that have no common divisor; repeated factors once."""
    if x.is_zero():
        return x
    _, factors = x.top.factor()
    product = tower.one.top
    for factor, _ in factors:
        product = product * factor
    common, denominator = 0, 1
    for coefficient in product.coeffs():
        common = gcd(common, int(coefficient.p))
        denominator = lcm(denominator, int(coefficient.q))
    return tower.element(Element(tower, tower.reduced(product * fmpq(denominator, common)), tower.one.bottom))
