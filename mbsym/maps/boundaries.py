"""The boundary polynomials of a section: where a verdict of problem 6 may change, labelled by the condition.

On an open connected set of parameters where none of them vanishes the verdict is one and the same, because all that it
is read off is constant there:

* the inertia (numbers of positive, zero, negative eigenvalues) of M, K and D: the lowest coefficient of
  det(s - matrix) that is not identically zero does not vanish, so the rank does not change;
* the numbers of roots to the left of the imaginary axis, on it and to the right: Lambda(lambda) is factored over
  QQ(axes); a factor f that is no polynomial in lambda^2 has no pair lambda, -lambda unless its last but one Hurwitz
  minor vanishes (Orlando), one h(lambda^2) has its real roots in mu apart unless its discriminant vanishes; zero roots
  and roots at infinity show in the first and the last coefficient;
* how many of the roots to the right are real: real ones meet where the discriminant of a factor vanishes;
* whether D, G and N vanish, as a whole or in the rows of cyclic coordinates;
* what Routh's reduction gives, by the same polynomials of the reduced matrices.

Common roots of two factors h(lambda^2) make no difference on open sets, but on curves: their resultant is among the
boundaries, so that the verdict on it is looked at.  With complete dissipation in the whole section (with its edges) and
N = 0 no root crosses the axis but at zero, and there are as many to the right as K has negative eigenvalues
(Kelvin-Chetaev): Hurwitz's minors bound nothing, and without G those to the right are real, so that where roots meet
does not matter.  Without D, G and N all roots in lambda^2 are real and semisimple whether they coincide or not, and
discriminants and resultants are left out.  Subdiscriminants are not needed besides.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from mbsym.algebra import rationals
from mbsym.algebra.characteristic import (
    Coefficients,
    Matrix,
    Polynomial,
    characteristic_polynomial,
    determinant,
    discriminant,
    factor_in_lambda,
    hurwitz_minors,
    leading_minors,
    resultant,
)
from mbsym.algebra.factors import irreducible_factors
from mbsym.algebra.failures import TooLargeError
from mbsym.algebra.matrices import added
from mbsym.algebra.signs import Signs
from mbsym.expressions.message import Told, worded
from mbsym.maps.section import Section
from mbsym.problems.stability.constant import Constant
from mbsym.problems.stability.linear_form import LinearSystem, is_potential, is_zero
from mbsym.problems.stability.routh import ignoring_cyclic, momenta_are_constant


class Origin(Told):
    """The condition from which a boundary polynomial comes."""

    MASS = "det M", "det M = 0"
    CONSTANT = "constant term", "zero root: constant term"
    LEADING = "leading coefficient"
    HURWITZ = "Hurwitz minor", "imaginary roots: Hurwitz minor"
    MEETING = "discriminant in lambda", "real roots meet: discriminant"
    DISCRIMINANT = "discriminant", "double root: discriminant"
    RESULTANT = "resultant", "common root: resultant"
    STIFFNESS = "det K", "det K = 0"
    DAMPING = "det D", "det D = 0"
    UNDAMPED = "D = 0", "no damping: D = 0"
    NOT_GYROSCOPIC = "G = 0", "no gyroscopic forces: G = 0"
    POTENTIAL = "N = 0", "no circulatory forces: N = 0"
    CYCLIC = "rows of cyclic coordinates", "cyclic coordinates set free"
    ENERGY = "sign in the energy law", "sign that the energy depends on"
    #: Where K vanishes in the whole section: of the first term of V that does not.
    HIGHER_ORDER = "term of higher order", "first term of the potential energy"
    ASSUMPTION = "assumption"
    SIGN = "declared sign"
    INERTIA = "triangle inequality"
    UNDEFINED = "division", "division by zero"
    #: Of numbers of equilibria.
    SINGULAR = "singular equilibria", "singular equilibria: bifurcation, or none that is real"
    LEAVING = "at infinity or at a border", "equilibria at infinity or at a border, or none that is real"


OF_EQUILIBRIA = (Origin.SINGULAR, Origin.LEAVING)


@dataclass(frozen=True)
class Condition:
    """``polynomial`` = 0 is where the condition of that origin is an equality.

    ``part`` is the subsystem's number (None: of the whole); ``about`` says more: which factor, assumption or body;
    ``reduced``: after Routh's reduction.
    """

    origin: Origin
    polynomial: Polynomial
    part: int | None = None
    about: str = ""
    reduced: bool = False


@dataclass(frozen=True)
class Boundaries:
    """``factors``: irreducible over QQ, each once; ``conditions[i]`` those in which ``factors[i]`` stands.

    ``vanishing`` are conditions that are equalities everywhere in the section.
    """

    factors: tuple[Polynomial, ...]
    conditions: tuple[tuple[Condition, ...], ...]
    vanishing: tuple[Condition, ...]


def boundaries(
    section: Section, further: Sequence[Condition] = (), known: Sequence[tuple[Polynomial, str]] = ()
) -> Boundaries:
    """All boundary polynomials of a section, those of ``further`` conditions (admissibility) included.

    ``known``: (polynomial, relation to 0) of what holds wherever a verdict is given.
    Raises TooLargeError where a determinant is beyond its budget.
    """
    conditions = list(further)
    conditions += [Condition(Origin.UNDEFINED, x) for x in section.undefined]
    for number, part in enumerate(section.parts):
        conditions += conditions_of(part, number, section=section, known=known)
    if section.constant is not None:
        conditions = [replace(x, polynomial=norm_of_factors(section, x.polynomial)) for x in conditions]
    return factored(conditions)


def factored(boundary_conditions: Sequence[Condition]) -> Boundaries:
    """The irreducible factors of conditions, each once, with those in which it stands."""
    factors: list[Polynomial] = []
    places: dict[str, int] = {}
    conditions: list[list[Condition]] = []
    vanishing: list[Condition] = []
    for condition in boundary_conditions:
        if condition.polynomial == 0:
            vanishing.append(condition)
            continue
        for factor, _ in irreducible_factors(condition.polynomial)[1]:
            key = str(factor if factor.leading_coefficient() > 0 else -factor)
            if key not in places:
                places[key] = len(factors)
                factors.append(factor)
                conditions.append([])
            listed = conditions[places[key]]
            if not any(x.origin is condition.origin and x.part == condition.part for x in listed):
                listed.append(condition)
    return Boundaries(tuple(factors), tuple(map(tuple, conditions)), tuple(vanishing))


def norm_of_factors(section: Section, p: Polynomial) -> Polynomial:
    """A polynomial in the axes that vanishes wherever p does, from the norms of its factors, each once."""
    p = section.reduced(p)
    if p == 0 or section.constant is None:
        return p
    total = p.context().constant(1)
    for factor, _ in irreducible_factors(p)[1]:
        total *= section.norm(factor)
    return total


def conditions_of(
    system: LinearSystem,
    part: int,
    reduced: bool = False,
    section: Section | None = None,
    known: Sequence[tuple[Polynomial, str]] = (),
) -> Iterator[Condition]:
    """The boundary polynomials of one subsystem of a ``section``; ``known`` as in ``boundaries``."""
    constant = None if section is None else section.constant

    def told(origin: Origin, polynomial: Polynomial, about: str = "") -> Condition:
        return Condition(origin, polynomial, part, about, reduced)

    if system.kinetic:  # of x' = A x it is empty
        yield told(Origin.MASS, determinant(system.kinetic))
    if not is_zero(system.K):
        for coefficient in deciding_zeros(_coefficients(system.K, constant), constant):
            yield told(Origin.STIFFNESS, coefficient)
    if not is_zero(system.D):
        for coefficient in deciding_zeros(_coefficients(system.D, constant), constant):
            yield told(Origin.DAMPING, coefficient)
    origins = (Origin.UNDAMPED, Origin.NOT_GYROSCOPIC, Origin.POTENTIAL)
    for origin, matrix in zip(origins, (system.D, system.G, system.N), strict=True):
        if not is_zero(matrix):
            yield told(origin, _common([x for row in matrix for x in row], section))
    left_out = () if section is None else _needless(system, section, known)
    if constant is None:
        yield from _of_roots(system, part, reduced, left_out)
    else:
        yield from _of_roots_over(system, part, reduced, constant)
    if not system.cyclic or reduced:
        return
    acting = [x for matrix in (system.D, system.N) for i in system.cyclic for x in matrix[i]]
    acting += [system.G[i][j] for i in system.cyclic for j in system.cyclic]
    if any(x != 0 for x in acting):
        yield told(Origin.CYCLIC, _common(acting, section))
    if momenta_are_constant(system):
        yield from conditions_of(ignoring_cyclic(system), part, True, section, known)


def _needless(system: LinearSystem, section: Section, known: Sequence[tuple[Polynomial, str]]) -> tuple[Origin, ...]:
    """What bounds nothing because N = 0 and D > 0 wherever a verdict is given, which Sylvester's minors show.

    The section with its edges: what is only nonnegative vanishes on one.
    """
    if section.constant is not None or system.nonholonomic is not None or not is_zero(system.N) or is_zero(system.D):
        return ()
    context, assumptions = section.context, []
    for axis, x in zip(section.axes, section.context.gens(), strict=True):
        low, high = (context.constant(rationals.exact(end)) for end in (axis.low, axis.high))
        assumptions += [(x - low, ">="), (high - x, ">=")]
    signs = Signs(context, ("real",) * context.nvars(), (*assumptions, *known))
    if any(signs.sign(minor) != "positive" for minor in leading_minors(system.D)):
        return ()
    return (Origin.HURWITZ, Origin.MEETING) if is_zero(system.G) else (Origin.HURWITZ,)


def _of_roots(system: LinearSystem, part: int, reduced: bool, left_out: Sequence[Origin] = ()) -> Iterator[Condition]:
    """Where roots may cross the imaginary axis, or meet on it, but for origins ``left_out``."""

    def told(origin: Origin, polynomial: Polynomial, about: str) -> Condition:
        return Condition(origin, polynomial, part, about, reduced)

    raw = characteristic_polynomial(system.M, added(system.D, system.G), added(system.K, system.N))
    zeros = next((i for i, c in enumerate(raw) if c != 0), len(raw))
    if zeros == len(raw):
        return
    rest, factors = factor_in_lambda(raw[zeros:])
    if not rest.is_constant():
        yield told(Origin.LEADING, rest, "content")
    potential = is_potential(system)
    even: list[Coefficients] = []
    for number, (p, _) in enumerate(factors, start=1):
        about = f"factor {number}" if len(factors) > 1 else ""
        for coefficient in deciding_zeros(p):
            yield told(Origin.CONSTANT, coefficient, about)
        yield told(Origin.LEADING, p[-1], about)
        if len(p) <= 2:
            continue
        if any(c != 0 for c in p[1::2]):
            if Origin.HURWITZ not in left_out:
                yield told(Origin.HURWITZ, hurwitz_minors(p)[len(p) - 3], about)
            if Origin.MEETING not in left_out:
                yield told(Origin.MEETING, discriminant(p), about)
            continue
        h = p[::2]
        if not potential:
            even += [h]
            if len(h) > 2:
                yield told(Origin.DISCRIMINANT, discriminant(h), about)
    for i, left in enumerate(even):
        for right in even[i + 1 :]:
            yield told(Origin.RESULTANT, resultant(left, right), "")


def _of_roots_over(system: LinearSystem, part: int, reduced: bool, constant: Constant) -> Iterator[Condition]:
    """The same over a field of algebraic numbers, without factors.

    Raises TooLargeError where the polynomial has a multiple factor, or one with roots lambda and -lambda beside others:
    its minor or discriminant vanishes identically, and bounds nothing.
    """

    def told(origin: Origin, polynomial: Polynomial) -> Condition:
        value = constant.reduced(polynomial)
        if value == 0:
            text = "this vanishes identically, with irrational numbers: [[what]]"
            raise TooLargeError(text, what=worded(origin.value))
        return Condition(origin, value, part, "", reduced)

    raw = characteristic_polynomial(system.M, added(system.D, system.G), added(system.K, system.N))
    p = tuple(map(constant.reduced, raw))
    zeros = next((i for i, c in enumerate(p) if c != 0), len(p))
    p = p[zeros:]
    while p and p[-1] == 0:
        p = p[:-1]
    if len(p) < 2:
        return
    for coefficient in deciding_zeros(p, constant):
        yield told(Origin.CONSTANT, coefficient)
    yield told(Origin.LEADING, p[-1])
    if any(c != 0 for c in p[1::2]):
        if len(p) > 2:
            yield told(Origin.HURWITZ, hurwitz_minors(p)[len(p) - 3])
            yield told(Origin.MEETING, discriminant(p))
    elif len(p) > 3 and not is_potential(system):
        yield told(Origin.DISCRIMINANT, discriminant(p[::2]))


def deciding_zeros(coefficients: Sequence[Polynomial], constant: Constant | None = None) -> Iterator[Polynomial]:
    """The lowest coefficient that is not identically zero, and so many further ones as a factor divides it more often.

    On a curve f = 0 where f divides the lowest coefficient once one root is zero, and another one only where the curve
    is singular.  Where f^e divides it up to e roots are zero all along, and how many of the others are on which side
    changes where a coefficient behind vanishes: on the curve, not beside it.
    """
    nonzero = [x for x in coefficients if x != 0]
    if not nonzero:
        return
    yield nonzero[0]
    # Over the field of a constant factors may be multiple, too.
    lowest = nonzero[0] if constant is None else constant.norm(nonzero[0])
    most = max((int(exponent) for _, exponent in irreducible_factors(lowest)[1]), default=1)
    if most > 1:
        yield from nonzero[1 : 1 + most]


def _coefficients(matrix: Matrix, constant: Constant | None = None) -> Coefficients:
    """Those of det(s + matrix), from low to high powers: sums of principal minors."""
    n, zero = len(matrix), matrix[0][0] * 0
    unit = [[zero + (1 if i == j else 0) for j in range(n)] for i in range(n)]
    nothing = [[zero] * n for _ in range(n)]
    coefficients = characteristic_polynomial(nothing, unit, matrix)
    return tuple(coefficients) if constant is None else tuple(map(constant.reduced, coefficients))


def _common(entries: Sequence[Polynomial], section: Section | None) -> Polynomial:
    """The greatest common divisor: where it vanishes all entries do, but for single points.

    With a constant it is that of the norms, which vanishes there and perhaps elsewhere: x - sqrt(2) and x^2 - 2 have no
    common factor with rational coefficients.
    """
    polynomial = entries[0] * 0
    for x in entries:
        polynomial = polynomial.gcd(x if section is None else section.norm(section.reduced(x)))
    return polynomial
