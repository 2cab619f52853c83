"""What normal forms need exactly: resonances at rational parameters, and formulas in parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache, reduce
from itertools import chain, combinations, count, product
from math import gcd, lcm, prod
from typing import Any

from flint import Ordering, arb, arb_poly, fmpq, fmpq_mpoly_ctx, fmpq_poly

from mbsym.algebra import rationals
from mbsym.algebra.base import Lowering
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import Failure, NoClosedForm, NoValue, SingularPoint, message_of
from mbsym.algebra.matrices import adjugate_at, adjugate_slope_at, determinant_by_traces, dot, faddeev, inverted
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.terms import evaluated
from mbsym.algebra.tower import PI, Element, Tower, angle_in
from mbsym.algebra.truncated import Coefficients, Space, Truncated
from mbsym.expressions.tree import Expression, divide, number
from mbsym.mechanics.kinematics import Scene
from mbsym.problems.normal_forms.expansion import Expansion, Numbers


def exact_values(expansion: Expansion, values: Mapping[str, Any]) -> tuple[Tower, dict[str, Element]] | None:
    """Values in a tower: rational ones, and those that the description writes with pi and square roots of numbers.

    Sines and cosines of them, under such names as ``cos(a/2)``, where these are roots of numbers.  pi is a parameter of
    the tower: as it is transcendental (Lindemann), a formula in it and in algebraic numbers is zero as a formula only.

    None where there are others, or roots that are not independent (sqrt(2) beside sqrt(8)): what is zero would not be
    told then.
    """
    scene, tower = expansion.scene, Tower((PI,))
    written = {parameter.name: parameter.value for parameter in scene.system.parameters}
    exact: dict[str, Element] = {}
    for name, value in values.items():
        expression = number(value) if isinstance(value, Fraction) else written.get(name)
        if expression is None:
            return None
        try:
            exact[name] = Lowering(tower, {PI: tower.parameter(PI)})(expression)
            exact |= _angle(scene, tower, name, expression)
        except (Failure, ZeroDivisionError):
            return None
        if isinstance(value, Fraction):
            continue
        if not tower.enclosed(exact[name], {}).real.overlaps(value):
            return None  # it is another number than that of the description
    squares = [tower.rational(tower.made(x, tower.one.bottom)) for x in tower.squares]
    for some in chain.from_iterable(combinations(squares, k) for k in range(1, len(squares) + 1)):
        whole = fmpq(1)
        for x in some:
            whole = fmpq(0) if x is None else whole * x
        if whole <= 0 or rationals.square_root(whole) is not None:
            return None
    return tower, exact


def _angle(scene: Scene, tower: Tower, name: str, expression: Expression) -> dict[str, Element]:
    """The sine and the cosine that formulas have of a parameter, where they are roots of numbers at this value."""
    ring = scene.ring
    share = ring.angles.get(name)
    if share is None:
        return {}
    letters = (f"{of}({name if share == 1 else f'{name}/{share}'})" for of in ("sin", "cos"))
    try:
        numbers = scene.lower.angle(divide(expression, number(share)))
        return {letter: Carrier(ring, tower, {})(x) for letter, x in zip(letters, numbers, strict=True)}
    except (Failure, NoValue):  # as of 1
        return {}


def over_tower(expansion: Expansion, tower: Tower, values: Mapping[str, Any]) -> Numbers:
    """The expansion with ``values`` put in; what has none is a parameter of the tower."""
    environment: dict[str, Any] = {name: tower.element(value) for name, value in values.items()}
    environment |= {name: tower.parameter(name) for name in tower.parameters}
    ring = expansion.scene.ring
    tower.is_positive = lambda x: ring.is_positive(in_ring(tower, ring, x))
    angles = {key: angle for key in environment if (angle := angle_in(key)) is not None and key not in tower.parameters}
    indices = {key: ring.index({"cos": "cosine", "sin": "sine"}[of], name) for key, (of, name, _) in angles.items()}
    carry = Carrier(ring, tower, environment, {index: environment[key] for key, index in indices.items()})
    return Numbers(expansion, carry, tower.reciprocal, tower.zero, tower.one)


def occurring_parameters(expansion: Expansion) -> list[str]:
    """The parameters in the coefficients, within what is adjoined as well."""
    ring = expansion.scene.ring
    parts = [*expansion.lagrangian, *(part for force in expansion.forces for part in force)]
    within = ring.held(x for part in parts for x in part.values())
    held = [ring.generators[k] for k in sorted(within) if ring.generators[k].argument is None]
    plain = {g.name for g in held if g.kind == "parameter"}
    names = [parameter.name for parameter in expansion.scene.system.parameters]
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
        self._roots = None if coefficients is None or tower is None else _signed_roots(tower, coefficients)

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
        return self._by_counting(vector, frequencies)

    def _by_counting(self, vector: tuple[int, ...], frequencies: Sequence[arb]) -> bool | None:
        """Sums  k_1 w_1 + ... over all roots and signs: where as many vanish as enclosures cannot tell from zero."""
        if self._roots is None:
            return None
        factors = [factor for factor, _ in self._roots.factor()[1]]
        own = {sign * j: _only(factors, sign * w) for j, w in enumerate(frequencies, 1) for sign in (1, -1)}
        chosen = [(k, own[j]) for j, k in enumerate(vector, 1) if k]
        degrees = prod(0 if factor is None else factor.degree() for _, factor in chosen)
        if not 0 < degrees <= MOST_SUMMED:
            return None
        *others, last = (factor(fmpq_poly([0, fmpq(1, k)])) for k, factor in chosen if factor is not None)
        whole = reduce(composed_sum, others)
        shared = whole.gcd(last(fmpq_poly([0, -1]))).factor()[1]
        vanishing = sum(f.degree() * _power(f, whole) * _power(f, last(fmpq_poly([0, -1]))) for f, _ in shared)
        places = [[j for j, x in own.items() if x is factor] for _, factor in chosen]
        if any(len(some) < factor.degree() for some, (_, factor) in zip(places, chosen, strict=True) if factor):
            return None
        roots = [
            [k * (1 if j > 0 else -1) * frequencies[abs(j) - 1] for j in some]
            for some, (k, _) in zip(places, chosen, strict=True)
        ]
        near = sum(bool(sum(some, arb(0)).contains(0)) for some in product(*roots))
        return True if vanishing == near else None


#: Sums of roots that are formed for one resonance.
MOST_SUMMED = 256


def _only(factors: Sequence[fmpq_poly], root: arb) -> fmpq_poly | None:
    """The only one of the factors that may vanish at the enclosed root."""
    vanishing = [factor for factor in factors if arb_poly(factor)(root).contains(0)]
    return vanishing[0] if len(vanishing) == 1 else None


def _power(factor: fmpq_poly, whole: fmpq_poly) -> int:
    """How often the factor divides."""
    return next(n for n in count() if whole % factor ** (n + 1) != 0)


def _signed_roots(tower: Tower, coefficients: Sequence[Element]) -> fmpq_poly | None:
    """The polynomial with the roots +-w, z = -w^2 the roots of q; None where its coefficients are not rational."""
    numbers = [x for coefficient in coefficients if (x := tower.rational(coefficient)) is not None]
    if len(numbers) < len(coefficients):
        return None
    return fmpq_poly([y for k, x in enumerate(numbers) for y in (x * (-1) ** k, fmpq(0))][:-1])


@lru_cache(16)
def _composed_sum(p: tuple[fmpq, ...], q: tuple[fmpq, ...]) -> fmpq_poly:
    context = fmpq_mpoly_ctx.get(["x", "y"], Ordering.lex)
    x, y = context.gens()
    first, second = (
        sum((c * z**k for k, c in enumerate(coefficients)), context.constant(0))
        for coefficients, z in ((p, y), (q, x - y))
    )
    terms = first.resultant(second, "y").to_dict()
    resultant = [fmpq(0)] * (1 + max(int(m[0]) for m in terms))
    for monomial, c in terms.items():
        resultant[int(monomial[0])] = c
    return fmpq_poly(resultant)


def composed_sum(p: fmpq_poly, q: fmpq_poly) -> fmpq_poly:
    """The polynomial whose roots are the sums of a root of p and one of q: Res_y(p(y), q(x - y))."""
    return _composed_sum(tuple(p.coeffs()), tuple(q.coeffs()))


def rational_squares(tower: Tower | None, coefficients: Sequence[Element]) -> list[fmpq] | None:
    """w^2 for all roots, if all of them are rational numbers."""
    assert tower is not None
    numbers = [x for coefficient in coefficients if (x := tower.rational(coefficient)) is not None]
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
        return ring.reduce(evaluated(polynomial, lambda k, e: generator(k) ** e, ring.context.constant, ring.times))

    def generator(index: int) -> Polynomial:
        kind = tower.kind(index)
        return letter(ring, kind) if isinstance(kind, str) else ring.square_root(carried(kind))

    return ring.ratio(carried(x.top), carried(x.bottom))


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
    elements = list(polynomial)
    while elements and elements[-1].is_zero():
        elements.pop()
    return elements


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


# Critical cases with dissipation: the motion on the centre manifold, over any scalars.
#
# For x' = A x + f(x), f of second order, with one pair +-i w of imaginary roots (lambda = i w), A q = lambda q,
# p A = lambda p, p q = 1, the centre manifold is
#
#     x = q z + q* z* + h20 z^2/2 + h11 z z* + h02 z*^2/2 + ...
#     (2 lambda - A) h20/2 = f_2's coefficient of z^2,      -A h11 = that of z z*,      z' = lambda z + c z^2 z* + ...
#
# with c = p.(coefficient of z^2 z* in f).  With r = 2 |q_j z|, the amplitude of x_j in first approximation,
#
#     r' = a r^3 + ...,      a = Re c / (4 q_j q_j*)
#
# which is a of r' = d r + a r^3 (Guckenheimer & Holmes (3.4.11)) where a parameter moves the roots by d.  a < 0: soft
# (asymptotically stable where all other roots are to the left), a > 0: hard (unstable).  With one root zero instead
#
#     u' = a2 u^2 + a3 u^3 + ...,      x = q u + h u^2 + ...
#
# a2 != 0: unstable; a2 = 0: asymptotically stable for a3 < 0, unstable for a3 > 0.
#
# Sources: A. M. Lyapunov, The General Problem of the Stability of Motion (1892), sections 28-41; V. A. Pliss (1964); J.
# Guckenheimer & P. Holmes, Nonlinear Oscillations (1983), sections 3.2 and 3.4; Yu. A. Kuznetsov, Elements of Applied
# Bifurcation Theory, section 5.4.


@dataclass(frozen=True)
class Reduced:
    """``cubic`` is c (of a zero root a3), ``quadratic`` a2 (0 for a pair); ``lengths`` are q_j q_j* (q_j) by state.

    ``quintic`` is c' of z' = lambda z + c z^2 z* + c' z^3 z*^2 of a pair, where the field goes so far.
    """

    quadratic: Any
    cubic: Any
    lengths: tuple[Any, ...]
    quintic: Any = None


def matrix_of(field: Sequence[Truncated]) -> list[list[Any]]:
    """A of x' = A x + ..."""
    m = len(field)
    return [[row[tuple(int(k == j) for k in range(m))] for j in range(m)] for row in field]


def on_pair(
    field: Sequence[Truncated], root: Any, inverse: Callable[[Any], Any], size: Callable[[Any], float]
) -> Reduced:
    """The pair ``root``, -root, simple.

    Raises what ``inverse`` raises where the root is not simple, or 0 or a multiple of root is one.
    """
    source = field[0].space
    zero, one = source.zero, source.one
    matrix = matrix_of(field)
    q, p, column = _eigenvectors(matrix, root, zero, one, inverse, size)
    whole = adjugate_at(matrix, -root, zero, one)
    conjugate = [row[column] for row in whole]
    row = max(whole, key=lambda row: size(row[column]))
    dual = [x * inverse(dot(row, conjugate)) for x in row] if source.order > 3 else []
    lower, last = _on_centre(field, root, (q, conjugate), (p, dual), inverse)
    coefficients = [*lower, dot(p, last)]
    return Reduced(zero, coefficients[0], tuple(a * b for a, b in zip(q, conjugate, strict=True)), *coefficients[1:])


def _on_centre(
    field: Sequence[Truncated],
    root: Any,
    vectors: tuple[Sequence[Any], Sequence[Any]],
    duals: tuple[Sequence[Any], Sequence[Any]],
    inverse: Callable[[Any], Any],
) -> tuple[list[Any], list[Any]]:
    """c_1, c_2, ... below the order 2 n + 1 of the field (3, or 5), and the right side N of z^(n + 1) z*^n.

    By  x = H(z, z*) = q z + q* z* + sum h_jk z^j z*^k  and  DH (z', z*') = A H + N(H):

        ((j - k) lambda - A) h_jk = N_jk - sum_l (c_l (j - l) + c_l* (k - l)) h_(j-l)(k-l),

    where for j = k + 1 a multiple of q makes the right side one of those with p h = 0, c_k, and so for its conjugate.
    """
    source = field[0].space
    m, zero, one, most = len(field), source.zero, source.one, source.order // 2
    matrix, space = matrix_of(field), Space(2, 2 * most + 1, zero, one)
    state = [space.linear((a, b)) for a, b in zip(*vectors, strict=True)]
    rates: dict[int, list[Any]] = {}
    for order in range(2, 2 * most + 2):
        forced = [row.beyond(1).composed(state) for row in field]
        added: list[Coefficients] = [{} for _ in field]
        for j in range(max(0, order - most), min(order, most + 1) + 1):  # others do not reach z^(n + 1) z*^n
            k = order - j
            right = [x[j, k] for x in forced]
            for back, (c, other) in rates.items():
                if min(j, k) >= back and order - 2 * back > 1:
                    factor = c * (j - back) + other * (k - back)
                    right = [x - factor * h[j - back, k - back] for x, h in zip(right, state, strict=True)]
            if k == most and j > most:
                return [rates[n][0] for n in sorted(rates)], right
            moved = [[(root * (j - k) if r == s else zero) - matrix[r][s] for s in range(m)] for r in range(m)]
            for which, (own, left, ahead) in enumerate(zip(vectors, duals, (j - k, k - j), strict=True)):
                if ahead == 1:
                    share = dot(left, right)
                    right = [x - share * y for x, y in zip(right, own, strict=True)]
                    moved = [[moved[r][s] + own[r] * left[s] for s in range(m)] for r in range(m)]
                    rates.setdefault(min(j, k), [zero, zero])[which] = share
            for row, x in zip(added, _applied(inverted(moved, inverse, zero, one), right), strict=True):
                row[j, k] = x
        state = [x + Truncated(space, extra) for x, extra in zip(state, added, strict=True)]
    raise AssertionError("the last order ends it")


def on_double_pair(
    field: Sequence[Truncated], root: Any, inverse: Callable[[Any], Any], size: Callable[[Any], float]
) -> Any:
    """c of z_1' = lambda z_1 + z_2, z_2' = lambda z_2 + c z_1^2 z_1* + ... for a double ``root`` lambda with one
    eigenvector q: (A - lambda) q_1 = q, p A = lambda p, p q_1 = 1.  |z_1| then obeys r'' = c r^3 + ...

    q and q_1 are a column of adj(s - A) and of its derivative at s = lambda.  Raises what ``inverse`` raises
    where there are two eigenvectors.
    """
    source = field[0].space
    m, zero, one = len(field), source.zero, source.one
    matrix = matrix_of(field)
    whole, places = adjugate_at(matrix, root, zero, one), range(m)
    i, j = max(((i, j) for i in places for j in places), key=lambda at: size(whole[at[0]][at[1]]))
    q, p = [row[j] for row in whole], whole[i]
    conjugate = [row[j] for row in adjugate_at(matrix, -root, zero, one)]
    generalised = [row[j] for row in adjugate_slope_at(matrix, root, zero, one)]
    factor = inverse(dot(p, generalised))
    _, third = _on_centre(field, root, (q, conjugate), ((), ()), inverse)
    return dot(p, third) * factor * inverse(dot(q, conjugate))


def on_zero(field: Sequence[Truncated], inverse: Callable[[Any], Any], size: Callable[[Any], float]) -> Reduced:
    """One simple zero root.  Raises what ``inverse`` raises where it is not simple."""
    source = field[0].space
    m, zero, one = len(field), source.zero, source.one
    matrix = matrix_of(field)
    q, p, _ = _eigenvectors(matrix, zero, zero, one, inverse, size)
    space = Space(1, 3, zero, one)
    line = [space.linear((q[i],)) for i in range(m)]
    second = [row.beyond(1).composed(line)[2,] for row in field]
    quadratic = dot(p, second)
    # (q p - A) h = second - quadratic q: regular, and p h = 0
    moved = [[q[i] * p[j] - matrix[i][j] for j in range(m)] for i in range(m)]
    right = [x - quadratic * y for x, y in zip(second, q, strict=True)]
    h = _applied(inverted(moved, inverse, zero, one), right)
    bent = [row + Truncated(space, {(2,): x}) for row, x in zip(line, h, strict=True)]
    third = [row.beyond(1).composed(bent)[3,] for row in field]
    return Reduced(quadratic, dot(p, third), tuple(q))


def _eigenvectors(
    matrix: Sequence[Sequence[Any]],
    root: Any,
    zero: Any,
    one: Any,
    inverse: Callable[[Any], Any],
    size: Callable[[Any], float],
) -> tuple[list[Any], list[Any], int]:
    """q and p with p q = 1: a column and a row of adj(root - A), those whose common entry is largest; which column.

    adj(root - A) is q p times a number, for a simple root.
    """
    whole, places = adjugate_at(matrix, root, zero, one), range(len(matrix))
    i, j = max(((i, j) for i in places for j in places), key=lambda at: size(whole[at[0]][at[1]]))
    q, p = [row[j] for row in whole], whole[i]
    factor = inverse(dot(p, q))
    return q, [x * factor for x in p], j


def _applied(matrix: Sequence[Sequence[Any]], vector: Sequence[Any]) -> list[Any]:
    return [dot(row, vector) for row in matrix]


# The first Lyapunov coefficient on a curve of parameters on which one pair of roots is imaginary, as a formula.
#
# det(lambda - A) = E(lambda^2) + lambda O(lambda^2).  Where E and O have one common root -w^2, and no more,
#
#     resultant(E, O) = 0,      their first subresultant  S1 mu + S0  has that root:  w^2 = S0/S1,   S1 != 0
#
# which is a fraction of polynomials in the parameters; a of r' = a r^3 then is one on that curve, too (``centre``).  As
# long as S1, det A, and top and bottom of a do not vanish on a piece of the curve, a has one sign there and no root
# crosses the imaginary axis.
#
# Source: L. Orlando (Gantmacher, The Theory of Matrices, chapter XV); Yu. A. Kuznetsov, Elements of Applied Bifurcation
# Theory, section 5.4.


@dataclass(frozen=True)
class OnCurve:
    """``resultant``, ``slope`` S1, ``constant`` det(-A), ``coefficient`` a: fractions in the tower's parameters.

    ``coefficient`` holds where ``resultant`` is zero and the others are not; r is the amplitude of ``amplitude_of``.
    """

    resultant: Element
    slope: Element
    constant: Element
    coefficient: Element
    amplitude_of: str


def on_curve(
    tower: Tower, field: Sequence[Truncated], positions: Sequence[str], size: Callable[[Element], float]
) -> OnCurve:
    """``size``: how large an element is at a point of the curve, so that nothing is divided by that vanishes there.

    Raises SingularPoint where a divisor vanishes all along, NoClosedForm where formulas outgrow their budget.
    """
    coefficients = faddeev(matrix_of(field), tower.zero, tower.one)[1]
    even, odd = trimmed(coefficients[::2]), trimmed(coefficients[1::2])
    resultant = subresultant(tower, even, odd, 0)[0]
    constant, slope = _linear(tower, even, odd)
    root = tower.square_root(-constant / slope)
    reduced = on_pair(field, root, tower.reciprocal, size)
    j = max(range(len(positions)), key=lambda k: size(reduced.lengths[k]))
    real = (reduced.cubic + tower.conjugate(reduced.cubic, tower.places(root.top)[0])) / 2
    return OnCurve(resultant, slope, coefficients[0], real / (reduced.lengths[j] * 4), positions[j])


def _linear(tower: Tower, even: Sequence[Element], odd: Sequence[Element]) -> list[Element]:
    """S0, S1.  Raises SingularPoint where a common root is never alone: one is a constant, the other not linear."""
    degrees = len(even) - 1, len(odd) - 1
    if degrees == (1, 0):
        return list(even)  # the constant vanishes on the curve
    if min(degrees) < 1:
        raise SingularPoint("the even and the odd part of the polynomial have no common root that is alone")
    if min(degrees) == 1:
        return list(odd if degrees[1] == 1 else even)
    return subresultant(tower, even, odd, 1)


def subresultant(tower: Tower, p: Sequence[Element], q: Sequence[Element], j: int) -> list[Element]:
    """The j-th subresultant of two polynomials (low to high), j + 1 coefficients: of degree j where gcd has degree j.

    Determinants of the rows x^(n-j-1) p ... p, x^(m-j-1) q ... q: the last column is that of the power x^i.  j is 0,
    or less than both degrees.
    """
    m, n = len(p) - 1, len(q) - 1
    rows = [_shifted(tower, p, k, m + n - j) for k in reversed(range(n - j))]
    rows += [_shifted(tower, q, k, m + n - j) for k in reversed(range(m - j))]
    size = m + n - 2 * j
    elements = []
    for i in range(j + 1):
        columns = [*(m + n - j - 1 - k for k in range(size - 1)), i]
        table = [[row[c] for c in columns] for row in rows]
        elements.append(determinant_by_traces(table, tower.zero, tower.one))
    return elements


def _shifted(tower: Tower, p: Sequence[Element], by: int, length: int) -> list[Element]:
    row = [tower.zero] * by + list(p)
    return row + [tower.zero] * (length - len(row))
