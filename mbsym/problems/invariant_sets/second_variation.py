"""The second variation of K on the level of its integrals (Routh, Lyapunov), and the first approximation beside it.

At a steady motion x_0 with  grad K(x_0) = 0,  K = V_0 + sum lambda_k V_k,  the motion is stable if

    delta^2 K = dx . K''(x_0) dx    is definite on    {dx: grad V_j(x_0) . dx = 0 for all j},

for then  +-(K - K_0) + c sum (V_j - V_j0)^2  is a Lyapunov function for c large enough.  With G = (grad V_j), pivot
columns p of G with det G_p = d != 0, and r the others,

    dx = T y,    T = [-adj(G_p) G_r; d 1],    d^2 > 0,    S = T^t K'' T,

so the leading minors of S decide (Sylvester).  On a manifold, for fixed multipliers, K is constant, and y the
deviations of the variables that were solved for: S = d^2 K/dy^2.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mbsym.algebra.characteristic import (
    BUDGET,
    adjugate,
    determinant,
    factor_in_lambda,
    leading_minors,
    subdiscriminants,
)
from mbsym.algebra.failures import Failure
from mbsym.algebra.matrices import Operators, ScalarMatrix, dot
from mbsym.algebra.ring import Polynomial
from mbsym.algebra.signs import Condition, ContradictionError, Signs
from mbsym.problems.invariant_sets.branches import Place, evaluate, rank
from mbsym.problems.invariant_sets.result import Definiteness, FirstApproximation, Relation, SecondVariation

Rows = list[list[Polynomial]]

#: Conditions of more terms than this are left out.
MOST_TERMS = 600


def on_level(place: Place, family: Polynomial) -> SecondVariation:
    """Of a steady motion: definiteness on the common tangent space of all integrals and relations."""
    arena = place.arena
    integrals = (*arena.integrals, *arena.relations, *arena.beside)
    gradients = [_cleared(place, [[place.fraction(p.derivative(g)) for g in arena.variables]])[0][0] for p in integrals]
    hessian, scale = _hessian(place, family, arena.variables)
    rows, pivots = _independent(place, gradients)
    if rows is None:
        return SecondVariation(Definiteness.LEFT_OUT, 0)
    others = [j for j in range(len(arena.variables)) if j not in pivots]
    if not others:
        return SecondVariation(Definiteness.STABLE, 0, (), ())
    block = [[row[j] for j in pivots] for row in rows]
    try:
        divisor = place.shortened(determinant(block, BUDGET)) if block else arena.ring.one
        tangent = _tangent(place, rows, block, pivots, others, divisor)
        operators = Operators(arena.ring.zero, arena.ring.one)
        t, second = ScalarMatrix(operators, tangent), ScalarMatrix(operators, hessian)
        form = [[place.shortened(x) for x in row] for row in t.T @ (second @ t)]
    except Failure:
        return SecondVariation(Definiteness.LEFT_OUT, len(others))
    return _definite(place, form, scale)


def across(place: Place, family: Polynomial) -> SecondVariation:
    """Of an invariant manifold: definiteness in the variables that were solved for."""
    solved = [g for g in place.arena.variables if g in place.solved]
    hessian, scale = _hessian(place, family, solved)
    return _definite(place, hessian, scale)


def _hessian(place: Place, family: Polynomial, variables: Sequence[int]) -> tuple[Rows, Polynomial]:
    """K'' times ``scale`` on the branch, without denominators."""
    return _cleared(place, [[place.fraction(family.derivative(a).derivative(b)) for b in variables] for a in variables])


def _cleared(place: Place, parts: list[list[tuple[Polynomial, Polynomial]]]) -> tuple[Rows, Polynomial]:
    """Fractions times one common denominator, and that."""
    scale = place.arena.ring.one
    for row in parts:
        for _, bottom in row:
            scale = scale * (bottom / bottom.gcd(scale))
    return [[place.shortened(top * (scale / bottom)) for top, bottom in row] for row in parts], scale


def _independent(place: Place, gradients: Rows) -> tuple[Rows | None, list[int]]:
    """Rows that are independent at a generic point, and columns in which their block is regular there."""
    point = place.point
    if point is None:
        return None, []
    numbers = [[evaluate(x, point) for x in row] for row in gradients]
    # Short rows first, then those of low degree: what is divided by is a minor of the rows.
    order = sorted(
        range(len(gradients)), key=lambda i: (sum(map(len, gradients[i])), sum(x.total_degree() for x in gradients[i]))
    )
    independent: list[int] = []
    for i in order:
        if rank([*(numbers[k] for k in independent), numbers[i]]) > len(independent):
            independent.append(i)
    columns: list[int] = []
    short = sorted(
        range(len(gradients[0])), key=lambda j: sum(len(gradients[i][j]) for i in independent if gradients[i][j] != 0)
    )
    for j in short:
        if rank([[numbers[i][k] for k in (*columns, j)] for i in independent]) > len(columns):
            columns.append(j)
    return [gradients[i] for i in independent], sorted(columns)


def _tangent(
    place: Place, rows: Rows, block: Rows, pivots: Sequence[int], others: Sequence[int], divisor: Polynomial
) -> Rows:
    """T, one row for each variable."""
    size = len(pivots) + len(others)
    zero = place.arena.ring.zero
    tangent = [[zero] * len(others) for _ in range(size)]
    adjoint = adjugate(block) if block else []
    for b, j in enumerate(others):
        tangent[j][b] = divisor
        for a, i in enumerate(pivots):
            total = zero
            for k, row in enumerate(rows):
                total -= adjoint[a][k] * row[j]
            tangent[i][b] = place.shortened(total)
    return tangent


def _definite(place: Place, form: Rows, scale: Polynomial) -> SecondVariation:
    """Both signs of the form divided by ``scale``.  What tangents were divided by is a squared factor of each minor."""
    arena, size = place.arena, len(form)
    try:
        minors = [place.or_zero(place.shortened(x)) for x in leading_minors(form, BUDGET)]
    except Failure:
        return SecondVariation(Definiteness.LEFT_OUT, size)
    if any(len(x) > MOST_TERMS for x in minors):
        return SecondVariation(Definiteness.LEFT_OUT, size)
    if any(x == 0 for x in minors):  # no definite form has such a minor, be the form degenerate or not
        return SecondVariation(Definiteness.DEGENERATE if minors[-1] == 0 else Definiteness.NEVER, size)
    scaled_minors = [place.shortened(x * scale ** ((k + 1) % 2)) for k, x in enumerate(minors)]
    chosen = {
        g
        for x in scaled_minors
        for g, degree in enumerate(x.degrees())
        if degree > 0 and g in place.free_multipliers and not place.fixes(g)
    }
    positive, negative = _both(place, scaled_minors)
    divided = (*(s.denominator for s in place.branch.solved), *place.branch.nonzero)
    if () not in (positive, negative) and not any(p.degrees()[g] > 0 for p in divided for g in chosen):
        # Without those multipliers K may be definite already.
        gens = arena.ring.context.gens()
        images = [arena.ring.zero if g in chosen else x for g, x in enumerate(gens)]
        alone = _both(place, [x.compose(*images, ctx=arena.ring.context) for x in scaled_minors])
        if chosen and () in alone:
            (positive, negative), chosen = alone, set()
    if () in (positive, negative):
        outcome = Definiteness.STABLE
    elif positive is None and negative is None:
        outcome = Definiteness.NEVER
    else:
        outcome = Definiteness.CONDITIONAL
    return SecondVariation(outcome, size, positive, negative, tuple(arena.name(g) for g in sorted(chosen)))


def _both(
    place: Place, polynomials: Sequence[Polynomial]
) -> tuple[tuple[Relation, ...] | None, tuple[Relation, ...] | None]:
    """Conditions for a form with these minors to be positive definite, and negative definite."""
    return _sufficient(place, polynomials), _sufficient(place, [x * (-1) ** (k + 1) for k, x in enumerate(polynomials)])


def _sufficient(place: Place, polynomials: Sequence[Polynomial]) -> tuple[Relation, ...] | None:
    """Conditions for all of them to be positive, each reduced by those before it; None where that is impossible."""
    arena = place.arena
    known, sufficient = arena.signs, []
    try:
        for p in polynomials:
            condition = _condition(place, known, p)
            if condition.kind == "never":
                return None
            facts: list[tuple[Polynomial, str]] = (
                [(condition.polynomial, ">")] if condition.kind == "inequality" else []
            )
            facts += [(f, "!=") for f in condition.nonzero if not place.never_zero(f)]
            known = known.assuming(facts)
            sufficient += facts
        if sufficient and any(_excluded(place, known, p) for p in place.branch.remaining):
            return None
    except ContradictionError:
        return None
    return tuple(Relation(arena.formula(p), relation) for p, relation in sufficient)


def _condition(place: Place, known: Signs, p: Polynomial) -> Condition:
    """For p > 0 on the branch: decided where it is so in all cases of the branch."""
    cases = [known.condition(images(p)) for images in place.cases]
    decided = {condition.kind for condition in cases} in ({"always"}, {"never"})
    return cases[0] if decided or len(cases) == 1 else known.condition(p)


def _excluded(place: Place, known: Signs, p: Polynomial) -> bool:
    """Whether p = 0 has no solutions: what holds an unknown in it, and what does not, are of one sign."""
    if known.never_zero(p):
        return True
    gens = p.context().gens()
    for g in (*place.arena.multipliers, *place.arena.variables):
        if p.degrees()[g] > 0:
            rest = p.compose(*(x * 0 if k == g else x for k, x in enumerate(gens)), ctx=p.context())
            signs = {known.sign(rest), known.sign(p - rest)}
            if signs <= {"positive", "nonnegative"} or signs <= {"negative", "nonpositive"}:
                return "positive" in signs or "negative" in signs
    return False


def first_approximation(place: Place) -> FirstApproximation | None:
    """The characteristic polynomial of x' = J x at a steady motion; None where it is beyond the budget."""
    arena = place.arena
    parts = [[place.fraction(p.derivative(g)) for g in arena.variables] for p in arena.numerators]
    below = place.fraction(arena.denominator)
    scale = arena.ring.one
    for row in parts:
        for _, bottom in row:
            scale = scale * (bottom / bottom.gcd(scale))
    # J = rows * below[1]/(below[0] scale); roots are those of the pencil  lambda b - a.
    a = [[place.shortened(top * (scale / bottom) * below[1]) for top, bottom in row] for row in parts]
    b = place.shortened(below[0] * scale)
    coefficients = _characteristic(place, a)
    if coefficients is None:
        return None
    whole = [place.or_zero(place.shortened(c * b**k)) for k, c in enumerate(coefficients)]
    zeros = next(k for k, c in enumerate(whole) if c != 0)
    rest = whole[zeros:]
    if any(len(c) > MOST_TERMS for c in rest):
        return None
    factors = []
    necessary: list[Relation] = []
    complete, unstable, left = True, False, 0
    for even, uneven in _even_factors(rest):
        if uneven:  # left to problem 6, but for signs that no roots on the left give
            complete, left = False, left + len(uneven) - 1
            unstable |= any(arena.signs.sign(place.shortened(c * uneven[-1])) == "negative" for c in uneven)
            continue
        if arena.signs.sign(even[-1]) == "negative":
            even = [-c for c in even]
        factors.append(tuple(arena.formula(c) for c in even))
        if len(even) < 2:
            continue
        lead = even[-1]
        required = [place.shortened(c * lead) for c in even[:-1]]
        if len(even) > 2:
            required += [place.shortened(x) for x in subdiscriminants(even)[1:]]
        for p in map(place.or_zero, required):
            sign = place.sign(p)
            unstable |= sign == "negative"
            if p == 0 or sign in ("positive", "nonnegative", "zero", "negative"):
                continue
            condition = arena.signs.condition(p)
            if any(place.vanishes(f) for f in condition.nonzero):
                continue  # p is zero on the branch
            if sign == "nonpositive":  # it has to vanish: one of these factors does
                product = arena.ring.one
                for f in arena.signs.nonzero_condition(p).nonzero:
                    product = product if place.never_zero(f) else product * f
                unstable |= bool(product.is_constant())
                necessary.append(Relation(arena.formula(product), "="))
            elif condition.kind == "inequality":
                unless = tuple(arena.formula(f) for f in condition.nonzero if not place.never_zero(f))
                necessary.append(Relation(arena.formula(condition.polynomial), ">=", unless))
            else:
                complete = False
    return FirstApproximation(zeros, tuple(factors), () if unstable else tuple(necessary), unstable, complete, left)


def _even_factors(rest: list[Polynomial]) -> Iterator[tuple[list[Polynomial], list[Polynomial]]]:
    """Irreducible factors: coefficients in lambda^2 of those that are even, () and those in lambda of others.

    A polynomial that is even is factored in lambda^2, or lambda^2 - 1 would be two factors that are not.
    """
    if not any(c != 0 for c in rest[1::2]):
        yield from ((list(factor), []) for factor, _ in factor_in_lambda(rest[::2])[1])
        return
    for factor, _ in factor_in_lambda(rest)[1]:
        even = not any(c != 0 for c in factor[1::2])
        yield (list(factor[::2]), []) if even else ([], list(factor))


def _characteristic(place: Place, a: Rows) -> list[Polynomial] | None:
    """det(lambda 1 - a), from low to high, by Berkowitz's method without divisions."""
    ring, n = place.arena.ring, len(a)
    polynomial = [ring.one]  # from the leading coefficient on
    for r in range(n):
        row, column = [a[r][j] for j in range(r)], [a[i][r] for i in range(r)]
        tails = [ring.one, -a[r][r]]
        vector = column
        for _ in range(r):
            tails.append(-place.shortened(dot(row, vector)))
            vector = [place.shortened(dot(a[i][:r], vector)) for i in range(r)]
            if any(len(x) > 4 * MOST_TERMS for x in vector):
                return None
        polynomial = [
            place.shortened(sum((tails[i - j] * polynomial[j] for j in range(min(i, r) + 1)), ring.zero))
            for i in range(r + 2)
        ]
    return polynomial[::-1]
