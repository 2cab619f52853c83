"""Problem 11 along one parameter, the others at numbers: all exceptional values, exactly, and what holds between them.

Exceptional are the roots of polynomials in the parameter: of Hamiltonian systems of two frequencies those of the
product and the discriminant of w_1^2, w_2^2 (borders of the first approximation), of the resonances 1:2 and 1:3 and of
D_4; with applied forces those of the last two Hurwitz determinants, where a root of the characteristic polynomial is
zero or a pair imaginary.  Between two of them nothing that the theorems ask for changes its sign, so that a verdict at
one point there holds for all.  At each of them the verdict is that of the enclosed value, with what vanishes there
known exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import combinations, pairwise
from typing import Any

from flint import acb, acb_poly, arb, ctx, fmpq_poly

from mbsym.algebra.failures import Failure
from mbsym.algebra.matrices import determinant_by_traces, faddeev, hurwitz
from mbsym.algebra.rationals import fraction
from mbsym.algebra.terms import univariate
from mbsym.algebra.tower import MOST_ROOTS, Element, Tower
from mbsym.algebra.truncated import Truncated
from mbsym.formulas.formula import Shown
from mbsym.mechanics.expansion import OnManifold
from mbsym.mechanics.kinematics import Scene
from mbsym.problems.equilibrium import Equilibrium
from mbsym.problems.normal_forms.birkhoff import absolute
from mbsym.problems.normal_forms.birkhoff import matrix_of as matrix_of_hamiltonian
from mbsym.problems.normal_forms.dissipative import judged_field, state_field
from mbsym.problems.normal_forms.equal import equal_frequencies
from mbsym.problems.normal_forms.exact import even_part, matrix_of, on_pair, on_zero, over_tower, two_eigenvectors
from mbsym.problems.normal_forms.expansion import Expansion, SingularMass, expansion, taken_in
from mbsym.problems.normal_forms.problem import ORDER, PRECISION, at_numbers, at_zero_root, enclosed, twist
from mbsym.problems.normal_forms.result import Judged, Outcome, Theorem, Why
from mbsym.problems.stability.verdict import Verdict


class NotAlong(Failure):
    """There is no list of exceptional values."""

    code = "not-along"


@dataclass(frozen=True, repr=False)
class Special(Shown):
    """A value of the parameter: a root of the irreducible ``polynomial`` (low to high), enclosed; ``exactly`` if it is
    rational.  ``vanishing`` names what is zero there; ``verdict``: of problem 6, where terms of higher order leave it
    open and it does not."""

    enclosure: Any
    exactly: Fraction | None
    polynomial: tuple[int, ...]
    vanishing: tuple[str, ...]
    judged: Judged
    verdict: Verdict | None = None


@dataclass(frozen=True, repr=False)
class Between(Shown):
    """What holds between neighbouring exceptional values, by one rational ``sample``."""

    sample: Fraction
    judged: Judged


@dataclass(frozen=True, repr=False)
class Along(Shown):
    """``specials`` in order, ``between`` one more than these: below the first, ..., above the last."""

    name: str
    low: Fraction
    high: Fraction
    hamiltonian: bool
    coordinates: tuple[str, ...]
    cyclic: tuple[str, ...]
    specials: tuple[Special, ...]
    between: tuple[Between, ...]


def along(
    scene: Scene,
    whole: Any,
    equilibrium: Equilibrium,
    name: str,
    interval: tuple[Fraction, Fraction],
    values: Mapping[str, Fraction],
    conservative: bool,
    cyclic: Collection[str],
    manifold: Callable[[int], OnManifold] | None = None,
) -> Along:
    """All exceptional values of ``name`` in an open interval; ``values`` are the numbers of the other parameters.

    With ``manifold`` in the coordinates that constraints leave.

    Raises NotAlong where the system is of another kind, NotExpanded, NoClosedForm.
    """

    @cache
    def to(order: int) -> Expansion:
        expanded = expansion(scene, whole, equilibrium, order, cyclic, manifold)
        return taken_in(expanded) if conservative else expanded

    with ctx.workprec(PRECISION):
        fourth_order = to(4)
        tower, elements = (_of_two_frequencies if conservative else _of_roots)(fourth_order, name, values)
        roots = _roots([_norm(tower, x) for x in elements.values()], interval)
        _refuse_singular(tower, elements, [factor for _, factor in roots], interval, name)

        def two_eigenvectors_at(value: Any) -> bool:
            """Where the discriminant vanishes: whether A^2 + w^2 does, exactly."""
            factor = next(factor for root, factor in roots if root is value)
            matrix = matrix_of_hamiltonian(over_tower(fourth_order, tower, rational).hamiltonian())
            entries = two_eigenvectors(matrix, even_part(matrix, tower.zero, tower.one)[1])
            return all(x.is_zero() or _vanishes(tower, x, name, factor, value) for x in entries)

        rational = {key: value for key, value in values.items() if key != name}

        def judge(value: Any, zero: Sequence[str]) -> Judged:
            there = {**values, name: value}
            if not conservative:
                exact = isinstance(value, Fraction)
                return judged_field(to, there) if exact else judged_on_border(fourth_order, there, zero)
            if "product" in zero and not isinstance(value, Fraction):
                return at_zero_root(to(ORDER), there)
            if "discriminant" in zero and not isinstance(value, Fraction):
                return equal_frequencies(enclosed(to(4), there).hamiltonian(), two_eigenvectors_at(value))
            decides = None if isinstance(value, Fraction) else _decides(tower, elements, value, zero)
            return at_numbers(to, there, decides)

        specials = []
        for enclosure, factor in roots:
            zero = tuple(key for key, x in elements.items() if _vanishes(tower, x, name, factor, enclosure))
            if zero:
                exactly = fraction(-factor[0] / factor[1]) if factor.degree() == 1 else None
                judged = judge(enclosure if exactly is None else exactly, zero)
                coefficients = tuple(int(x) for x in (factor * factor.denom()).coeffs())
                specials.append(Special(enclosure, exactly, coefficients, zero, judged))
        ends = [
            interval[0],
            *(special.enclosure if special.exactly is None else special.exactly for special in specials),
            interval[1],
        ]
        between = [Between(sample, judge(sample, ())) for sample in (_between(a, b) for a, b in pairwise(ends))]
        relevant = [k for k, special in enumerate(specials) if _matters(special, between[k], between[k + 1])]
    return Along(
        name=name,
        low=interval[0],
        high=interval[1],
        hamiltonian=conservative,
        coordinates=tuple(
            coordinate for i, coordinate in enumerate(fourth_order.coordinates) if i not in fourth_order.cyclic
        ),
        cyclic=tuple(fourth_order.coordinates[i] for i in fourth_order.cyclic),
        specials=tuple(specials[k] for k in relevant),
        between=(*(between[k] for k in relevant), between[-1]),
    )


def _matters(special: Special, below: Between, above: Between) -> bool:
    """Whether something else is said than on both sides: where the first approximation decides D4 = 0 is nothing."""
    said = {(section.judged.outcome, section.judged.theorem) for section in (special, below, above)}
    return len(said) > 1


def _of_two_frequencies(
    expanded: Expansion, name: str, values: Mapping[str, Fraction]
) -> tuple[Tower, dict[str, Element]]:
    """What may vanish: trace, product and discriminant of the squares of the frequencies, resonances, D4."""
    count = len(expanded.coordinates) - len(expanded.cyclic)
    if count != 2:
        besides = " without its cyclic coordinates" if expanded.cyclic else ""
        raise NotAlong(
            "of systems whose energy is conserved exceptional values are listed where there are two "
            "frequencies; this one has [[count]][[besides]]",
            count=count,
            besides=besides,
        )
    try:
        _, tower, named = twist(expanded, values)
    except SingularMass:
        raise
    except ZeroDivisionError:
        raise NotAlong(
            "for all values of [[name]] a frequency is zero, two are equal, or one is two or three times another",
            name=name,
        ) from None
    if name not in tower.parameters:
        raise NotAlong("the expansion does not depend on [[name]]", name=name)
    for key, x in named.items():
        if x.is_zero() and key == "determinant":
            raise NotAlong(
                "for all values of [[name]] Arnold's determinant D4 vanishes: the energy has no terms of fourth order "
                "that decide",
                name=name,
            )
        if x.is_zero():
            raise NotAlong("for all values of [[name]] this vanishes: [[key]]", name=name, key=key)
    return tower, named


def _of_roots(expanded: Expansion, name: str, values: Mapping[str, Fraction]) -> tuple[Tower, dict[str, Element]]:
    """The last two Hurwitz determinants, but for the factor that the last one has of the one before."""
    tower = Tower([name])
    field, _ = state_field(over_tower(expanded, tower, {k: v for k, v in values.items() if k != name}))
    coefficients = faddeev(matrix_of(field), tower.zero, tower.one)[1][::-1]
    m = len(coefficients) - 1
    if coefficients[m].is_zero():
        raise NotAlong("for all values of [[name]] a root is zero", name=name)
    last = determinant_by_traces(hurwitz(coefficients, tower.zero, m - 1), tower.zero, tower.one)
    if last.is_zero():
        raise NotAlong("for all values of [[name]] there are roots whose sum is zero", name=name)
    return tower, {"root": coefficients[m], "pair": last}


# --- exceptional values ---


def _norm(tower: Tower, x: Element) -> fmpq_poly:
    """The product of the conjugates of the numerator: a polynomial in the one parameter."""
    norm = x
    for k in reversed(range(len(tower.squares))):
        if norm.top.degrees()[MOST_ROOTS - 1 - k] > 0:
            norm = norm * tower.conjugate(norm, k)
    return univariate(norm.top, MOST_ROOTS)


def _refuse_singular(
    tower: Tower,
    elements: Mapping[str, Element],
    known: Sequence[fmpq_poly],
    interval: tuple[Fraction, Fraction],
    name: str,
) -> None:
    """Raises NotAlong where a denominator, or what stands under a root, vanishes within the interval elsewhere.

    Beyond such a value other verdicts may hold, or none: they are not told from those before it by what is listed.
    """
    polynomials = [_norm(tower, Element(tower, x.bottom, tower.one.top)) for x in elements.values()]
    rational = [x for x in tower.squares if not any(degree > 0 for degree in x.degrees()[:MOST_ROOTS])]
    polynomials += [_norm(tower, Element(tower, x, tower.one.top)) for x in rational]
    for root, factor in _roots([x for x in polynomials if x.degree() > 0], interval):
        if factor not in known:
            at = root.str(8, radius=False)
            raise NotAlong(
                "the expansion is singular at [[name]] = [[at]]: choose an interval without this value",
                name=name,
                at=at,
            )


def _roots(polynomials: Sequence[fmpq_poly], interval: tuple[Fraction, Fraction]) -> list[tuple[arb, fmpq_poly]]:
    """The real roots of all of them within the interval, in order, each with its irreducible polynomial."""
    factors: dict[tuple[Any, ...], fmpq_poly] = {}
    for whole in polynomials:
        for factor, _ in whole.factor()[1]:
            monic = factor / factor[factor.degree()]
            factors[tuple(map(str, monic.coeffs()))] = factor
    low, high = (arb(end.numerator) / end.denominator for end in interval)
    roots = []
    for factor in factors.values():
        for root in acb_poly(factor).roots(tol=arb(2) ** (-(ctx.prec * 2 // 3))):
            if root.imag.contains(0) and root.real > low and root.real < high:
                roots.append((root.real, factor))
    return sorted(roots, key=lambda pair: float(pair[0]))


def _vanishes(tower: Tower, x: Element, name: str, factor: fmpq_poly, enclosure: arb) -> bool:
    """Whether x is zero at the root: exactly, by its norm, and by enclosures of its conjugates."""
    if _norm(tower, x) % factor != 0:
        return False
    if all(x.top.degrees()[MOST_ROOTS - 1 - k] <= 0 for k in range(len(tower.squares))):
        return True
    return bool(tower.enclosed(x, {name: enclosure}).contains(0))


def _between(low: Any, high: Any) -> Fraction:
    """A rational number of few digits between two numbers or enclosures."""
    a, b = (_bound(low, upper=True), _bound(high, upper=False))
    return ((a + b) / 2).limit_denominator(int(8 / (b - a)) + 1)


def _bound(x: Any, upper: bool) -> Fraction:
    if isinstance(x, Fraction):
        return x
    mantissa, exponent = (x.upper() if upper else x.lower()).mid().man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


def _decides(
    tower: Tower, elements: Mapping[str, Element], value: arb, zero: Sequence[str]
) -> Callable[[tuple[int, ...], Sequence[arb]], bool | None]:
    """Resonances at an algebraic value: those that vanish there exactly."""
    known = {tuple(sorted(map(int, key.split(":")))) for key in zero if ":" in key}

    def decides(vector: tuple[int, ...], frequencies: Sequence[arb]) -> bool | None:
        total = sum((k * w for k, w in zip(vector, frequencies, strict=True)), arb(0))
        if total != 0:
            return False
        return True if tuple(sorted(map(abs, vector))) in known else None

    return decides


# Systems with applied forces at an enclosed value at which a Hurwitz determinant is zero, exactly.
#
# There two roots have the sum zero (Orlando), or one is zero.  Where enclosures leave only one pair of roots for
# that, it is imaginary if it is one of conjugates; the others are looked at by their enclosures.


def judged_on_border(expanded: Expansion, values: Mapping[str, Any], zero: Sequence[str]) -> Judged:
    """``zero``: ``root`` where a root is zero exactly, ``pair`` where the Hurwitz determinant before the last is."""
    from mbsym.problems.normal_forms.problem import enclosed

    return judged_enclosed(*state_field(enclosed(expanded, values)), zero)


def judged_enclosed(field: Sequence[Truncated], positions: Sequence[str], zero: Sequence[str]) -> Judged:
    """The same of a field with enclosed coefficients; ``positions`` are the coordinates among its first variables."""
    coefficients = faddeev(matrix_of(field), acb(0), acb(1))[1]
    if "root" in zero:
        return _zero(field, coefficients[1:]) if "pair" not in zero else _open(Why.MIXED_ROOTS)
    try:
        roots = _isolated(coefficients)
    except ValueError:
        return _open(Why.EQUAL_FREQUENCIES)
    opposite = [(i, j) for i, j in combinations(range(len(roots)), 2) if (roots[i] + roots[j]).contains(0)]
    if len(opposite) != 1:
        return _open(Why.MORE_PAIRS)
    i, j = opposite[0]
    if any(root.real > 0 for k, root in enumerate(roots) if k not in (i, j)):
        return Judged(Outcome.UNSTABLE, Theorem.FIRST)
    if not roots[i].imag.contains(0):
        if not roots[j].overlaps(roots[i].conjugate()):
            return _open(Why.MIXED_ROOTS)
    elif roots[i].real > 0 or roots[j].real > 0:
        return Judged(Outcome.UNSTABLE, Theorem.FIRST)
    else:
        return _open(Why.ZERO_ROOT)
    if not all(root.real < 0 for k, root in enumerate(roots) if k not in (i, j)):
        return _open(Why.MIXED_ROOTS)
    w = abs(roots[i].imag)
    reduced = on_pair(field, acb(0, w), lambda x: 1 / x, absolute)
    place = next((k for k in range(len(positions)) if reduced.lengths[k].real > 0), None)
    if place is None:
        return _open(Why.COEFFICIENT_OPEN)
    a = (reduced.cubic / (4 * reduced.lengths[place])).real
    if not (a < 0 or a > 0):
        return Judged(Outcome.UNDECIDED, Theorem.NONE, Why.COEFFICIENT_OPEN, frequencies=(w,))
    outcome = Outcome.ASYMPTOTIC if a < 0 else Outcome.UNSTABLE
    return Judged(outcome, Theorem.REDUCTION, frequencies=(w,), coefficient=a, amplitude_of=positions[place])


def _zero(field: Sequence[Truncated], others: Sequence[acb]) -> Judged:
    """One root is zero; ``others`` are the coefficients of the polynomial of the rest."""
    try:
        roots = _isolated(others)
    except ValueError:
        return _open(Why.ZERO_ROOT)
    if any(root.real > 0 for root in roots):
        return Judged(Outcome.UNSTABLE, Theorem.FIRST)
    if not all(root.real < 0 for root in roots):
        return _open(Why.ZERO_ROOT)
    reduced = on_zero(field, lambda x: 1 / x, absolute)
    if reduced.quadratic.real != 0:
        return Judged(Outcome.UNSTABLE, Theorem.REDUCTION, coefficient=reduced.quadratic.real)
    a = reduced.cubic.real
    if not reduced.quadratic.is_zero() or not (a < 0 or a > 0):
        return _open(Why.COEFFICIENT_OPEN)
    return Judged(Outcome.ASYMPTOTIC if a < 0 else Outcome.UNSTABLE, Theorem.REDUCTION, coefficient=a)


def _isolated(coefficients: Sequence[acb]) -> list[acb]:
    """Roots, each alone in its enclosure.  Raises ValueError."""
    roots: list[acb] = acb_poly(coefficients).roots(tol=arb(2) ** (-(ctx.prec // 2)))
    return roots


def _open(why: Why) -> Judged:
    return Judged(Outcome.UNDECIDED, Theorem.NONE, why)
