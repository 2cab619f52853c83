"""Problem 6, the kernel: stability of M q'' + (D + G) q' + (K + N) q = 0, in symbols and at exact parameter values.

M, D, K symmetric, G, N skew.  The roots of det(lambda^2 M + lambda (D + G) + K + N) decide as far as the first
approximation goes; the theorems below go further.  Nothing is claimed on a border.

* D = N = 0 (the determinant is even): roots in mu = lambda^2 real, negative and simple, by the signs of the
  coefficients and the discriminant (from degree 4 on all subdiscriminants).  **Necessary** for stability.
* K > 0 besides: stable, by Lagrange-Dirichlet (G = 0) or Routh (G != 0), if the nonlinear system has its energy
  integral.  Without K > 0 the motion is **gyroscopically stabilised only**: any complete dissipation destroys it
  (Kelvin-Chetaev), and the nonlinear system is not decided.  det K < 0: unstable (Kelvin-Chetaev).
* D > 0, N = 0: asymptotically stable if K > 0, unstable if K is not and det K != 0 (Kelvin-Chetaev).
* Otherwise all Re lambda < 0 by Lienard-Chipart: asymptotically stable; one Re lambda > 0: unstable, both by
  Lyapunov's first method.
* A steady spin in a space without preferred directions: turned in space it is a spin again, which puts the roots
  +- i omega into the determinant, whatever the system.  With all other roots to the left it is asymptotically stable
  in every variable that does not change when everything is turned (Lyapunov-Malkin: the critical roots are those of a
  family of steady motions).
* Cyclic coordinates on which no damping acts have constant momenta: they are ignored after Routh.

M is taken to be positive definite, as a mass matrix is.  Rows may be scaled, by one positive factor per row through
all five matrices: neither the roots nor the signs of leading minors change.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from typing import Any

from flint import fmpq, fmpq_mat, fmpq_poly

from mbsym.algebra.characteristic import (
    Coefficients,
    Matrix,
    Polynomial,
    characteristic_polynomial,
    determinant,
    factor_in_lambda,
    is_semisimple,
    leading_minors,
    lienard_chipart,
    primitive,
    resultant,
    subdiscriminants,
)
from mbsym.algebra.factors import irreducible_factors
from mbsym.algebra.failures import TooLargeError
from mbsym.algebra.roots import RootCount, count_roots, rational
from mbsym.algebra.signs import MOST_TERMS, Condition, Signs, conditions

Numbers = Any  # a flint.fmpq_mat

ASYMPTOTIC = "asymptotically stable"
STABLE = "stable"
GYROSCOPIC = "gyroscopically stabilised only"
CRITICAL = "stable in first approximation only, critical"
UNSTABLE = "unstable"
UNDECIDED = "undecided"
#: With cyclic coordinates nothing better can hold: they drift.
STABLE_BUT_CYCLIC = "stable with respect to the other variables; the cyclic coordinates drift"
ASYMPTOTIC_BUT_CYCLIC = "asymptotically stable with respect to the other variables; the cyclic coordinates drift"
#: A turned steady spin is a steady spin: it does not come back.
ASYMPTOTIC_BUT_TURNED = "asymptotically stable up to a rotation of space"

LAGRANGE = "Lagrange-Dirichlet"
ROUTH = "Routh"
KELVIN_CHETAEV = "Kelvin-Chetaev"
LYAPUNOV = "Lyapunov's first method"
MALKIN = "Lyapunov-Malkin"

#: Why nothing is claimed where the coordinates themselves are singular, or a part has no mass.
MASS_SINGULAR = "The mass matrix is singular."

EVEN_METHOD = "all roots in lambda^2 real, negative and simple: coefficients and discriminants"
HURWITZ_METHOD = "all roots to the left of the imaginary axis: Lienard-Chipart"
NO_METHOD = "none"
UNWRITTEN = "not written out"


@dataclass(frozen=True)
class LinearSystem:
    """One subsystem: n x n matrices M, D, G, K, N of polynomials in the parameters.

    ``conservative``: the (generalised) energy of the nonlinear system does not grow near the motion, in all orders.
    ``cyclic``: indices of coordinates that do not occur in the nonlinear equations (only their velocities do); their
    rows and columns in K and N must vanish.  ``driven``: those of them whose momenta are not constant although D and N
    have no entries, because forces of higher order act on them.  ``turned``: (p, q) of the factor p lambda^2 + q, q/p
    the squared rate of a steady spin that may be turned in space; () where there is none.  ``ValueError`` for wrong
    shapes and for a pattern of zeros that no (row-scaled) symmetric or skew matrix has.
    """

    M: Matrix
    D: Matrix
    G: Matrix
    K: Matrix
    N: Matrix
    conservative: bool = False
    cyclic: tuple[int, ...] = ()
    turned: tuple[Polynomial, ...] = ()
    driven: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        n = len(self.M)
        for name, matrix in zip("MDGKN", self.matrices, strict=True):
            if n == 0 or len(matrix) != n or any(len(row) != n for row in matrix):
                raise ValueError(f"{name} is not a {n} x {n} matrix")
            for i in range(n):
                if name in "GN" and matrix[i][i] != 0:
                    raise ValueError(f"{name} is not skew: element {i + 1}, {i + 1} is not 0")
                if any((matrix[i][j] == 0) != (matrix[j][i] == 0) for j in range(i)):
                    raise ValueError(f"{name} is not {'skew' if name in 'GN' else 'symmetric'}")
        for i in self.cyclic:
            if any(matrix[i][j] != 0 for matrix in (self.K, self.N) for j in range(n)):
                raise ValueError(f"coordinate {i + 1} is not cyclic: it occurs in K or N")

    @property
    def matrices(self) -> tuple[Matrix, Matrix, Matrix, Matrix, Matrix]:
        return self.M, self.D, self.G, self.K, self.N

    @property
    def size(self) -> int:
        return len(self.M)


@dataclass(frozen=True)
class Verdict:
    """One of the words above, the theorem it rests on (empty when none does), and what it means here."""

    word: str
    theorem: str = ""
    explanation: str = ""


@dataclass(frozen=True)
class Requirement:
    """``polynomial`` ``relation`` 0, as it arises (``label``: v4, discriminant, ...) and reduced by what is known.

    ``by_mass``: it holds because the kinetic energy is positive definite.
    """

    label: str
    polynomial: Polynomial
    condition: Condition
    relation: str = ">"
    by_mass: bool = False

    @property
    def always(self) -> bool:
        return self.by_mass or self.condition.kind == "always"

    @property
    def never(self) -> bool:
        return not self.by_mass and self.condition.kind == "never"


@dataclass(frozen=True)
class Case:
    """If all of ``all_of`` and, unless it is empty, at least one of ``any_of`` hold, then ``verdict``.

    Cases are read in order, like an if-elif chain: a later one presumes that the earlier ones do not apply.
    A case that requires nothing is a mistake (``ValueError``): an empty choice must not count as fulfilled.
    """

    all_of: tuple[Requirement, ...]
    any_of: tuple[Requirement, ...]
    verdict: Verdict

    def __post_init__(self) -> None:
        if not self.all_of and not self.any_of:
            raise ValueError("a case needs a requirement")

    @property
    def always(self) -> bool:
        return all(r.always for r in self.all_of) and (not self.any_of or any(r.always for r in self.any_of))

    @property
    def never(self) -> bool:
        return any(r.never for r in self.all_of) or (bool(self.any_of) and all(r.never for r in self.any_of))


@dataclass(frozen=True)
class Definiteness:
    """Sylvester: a symmetric matrix is positive definite iff all leading ``minors`` are > 0.

    ``word``: positive definite, not positive definite, undecided.
    """

    word: str
    requirements: tuple[Requirement, ...]

    @property
    def minors(self) -> tuple[Polynomial, ...]:
        return tuple(r.polynomial for r in self.requirements)


@dataclass(frozen=True)
class Factor:
    """An irreducible factor of the characteristic polynomial: coefficients from low to high, and multiplicity."""

    coefficients: Coefficients
    multiplicity: int


@dataclass(frozen=True)
class PointVerdict:
    """The exact result at rational parameter values.  ``roots`` is None where M is singular."""

    verdict: Verdict
    characteristic: tuple[Any, ...]
    roots: RootCount | None


@dataclass(frozen=True)
class Stability:
    """Everything about one subsystem.

    characteristic = removed * lambda^zero_power * polynomial, ``removed`` known to be positive (both polynomials are
    empty when they were too large to be written out).  ``factors`` of ``polynomial`` are in ``variable``: lambda^2
    where only even powers occur, else lambda.
    """

    kind: str
    characteristic: Coefficients
    removed: Polynomial
    zero_power: int
    polynomial: Coefficients
    variable: str
    factors: tuple[Factor, ...]
    method: str
    requirements: tuple[Requirement, ...]
    mass: Definiteness
    stiffness: Definiteness
    dissipation: Definiteness | None
    cases: tuple[Case, ...]
    verdict: Verdict
    remarks: tuple[str, ...] = ()
    at_point: PointVerdict | None = None
    reduced: Stability | None = None  # with cyclic coordinates ignored after Routh
    turned: bool = False  # the roots of a turned steady spin are left out of the requirements

    @property
    def conditions(self) -> tuple[Condition, ...]:
        """What remains of ``requirements``, each once."""
        return conditions(r.condition for r in self.requirements)


# -- in symbols ---------------------------------------------------------------------------------------------------


def analyse(system: LinearSystem, signs: Signs, point: Mapping[int, Fraction] | None = None) -> Stability:
    """Characteristic polynomial, conditions, cases and verdict; with ``point`` also the exact verdict there.

    Without proof by ``signs`` the verdict is ``undecided`` and ``cases`` say what it depends on.  Formulas beyond the
    budget are left out, with a remark; then nothing is claimed in symbols.
    """
    try:
        found = _analyse(system, signs)
    except TooLargeError as error:
        found = _left_out(system, signs, str(error))
    return found if point is None else replace(found, at_point=verdict_at(system, point))


def _left_out(system: LinearSystem, signs: Signs, reason: str) -> Stability:
    nothing = Definiteness(UNDECIDED, ())
    return Stability(
        kind=kind_of(system),
        characteristic=(),
        removed=signs.context.constant(1),
        zero_power=0,
        polynomial=(),
        variable="lambda",
        factors=(),
        method=NO_METHOD,
        requirements=(),
        mass=nothing,
        stiffness=nothing,
        dissipation=None if _is_zero(system.D) else nothing,
        cases=(),
        verdict=Verdict(UNDECIDED, "", f"No closed form within the budget: {reason}."),
        remarks=(f"The characteristic polynomial is not written out: {reason}; at a point the verdict is exact.",),
    )


def _analyse(system: LinearSystem, signs: Signs) -> Stability:
    written = characteristic_polynomial(system.M, _add(system.D, system.G), _add(system.K, system.N))
    raw = tuple(signs.normalised(c) for c in written)
    mass = definiteness(system.M, signs, "M")
    # A mass matrix is positive definite, so its minors may be used to judge everything else.
    # Long ones would cost the search for combinations more than they can give.
    minors = [r.polynomial for r in mass.requirements]
    known = signs.assuming((p, ">") for p in minors if not p.is_constant() and len(p) <= MOST_TERMS)
    start = Stability(
        kind=kind_of(system),
        characteristic=raw,
        removed=raw[-1] * 0 + 1,
        zero_power=0,
        polynomial=raw,
        variable="lambda",
        factors=(),
        method=NO_METHOD,
        requirements=(),
        mass=mass,
        stiffness=definiteness(system.K, known, "K"),
        dissipation=None if _is_zero(system.D) else definiteness(system.D, known, "D"),
        cases=(),
        verdict=Verdict(UNDECIDED, "", "The mass matrix is singular, so the order of the equations is lower."),
    )
    if raw[-1] == 0:
        return start
    zero_power = next(i for i, c in enumerate(raw) if c != 0)
    polynomial, removed = _without_known_factor(raw[zero_power:], known)
    even = all(c == 0 for c in polynomial[1::2])
    factors = _factors(polynomial[::2] if even else polynomial)
    turned = None if even else _turned_factor(system, factors)
    requirements, remarks = _requirements(system, factors, even, signs, known, turned)
    if mass.word != "positive definite":
        remarks.append("M is taken to be positive definite, as the matrix of a kinetic energy is.")
    if zero_power:
        remarks.append(f"lambda^{zero_power} splits off: {zero_power} zero roots.")
    found = replace(
        start,
        removed=removed,
        zero_power=zero_power,
        polynomial=polynomial,
        variable="lambda^2" if even else "lambda",
        factors=factors,
        method=EVEN_METHOD if even else HURWITZ_METHOD,
        requirements=requirements,
        remarks=tuple(remarks),
        turned=turned is not None,
    )
    if zero_power:
        cases, reduced = _cases_with_zero_roots(system, found, known)
    else:
        cases, reduced = _cases(system, found, known), None
    return replace(found, cases=cases, reduced=reduced, verdict=_first_certain(cases))


def kind_of(system: LinearSystem) -> str:
    """Words for the acting forces: conservative, gyroscopic conservative, dissipative, circulatory, ..."""
    damped, gyroscopic = not _is_zero(system.D), not _is_zero(system.G)
    words = ["gyroscopic"] if gyroscopic else []
    if damped:
        words.append("dissipative")
    if not _is_zero(system.N):
        words.append("circulatory")
    elif not damped:
        words.append("conservative")
    return " ".join(words)


def definiteness(matrix: Matrix, signs: Signs, name: str) -> Definiteness:
    """Sylvester's criterion, each leading minor reduced by ``signs`` and by the minors before it being positive."""
    requirements: list[Requirement] = []
    for i, minor in enumerate(leading_minors(matrix), start=1):
        condition = signs.condition(minor)
        requirements.append(Requirement(f"minor {i} of {name}", minor, condition))
        if condition.kind == "inequality" and len(condition.polynomial) <= MOST_TERMS:
            signs = signs.assuming([(condition.polynomial, ">"), *((p, "!=") for p in condition.nonzero)])
    if all(r.always for r in requirements):
        word = "positive definite"
    elif any(r.never for r in requirements):
        word = "not positive definite"
    else:
        word = UNDECIDED
    return Definiteness(word, tuple(requirements))


def combine(verdicts: Iterable[Verdict]) -> Verdict:
    """The verdict for a system that splits into subsystems: no better than its worst part.

    Unlike parts whose union no single theorem covers (one stable, one asymptotically) are ``critical``.
    """
    parts = tuple(verdicts)
    if not parts:
        raise ValueError("no subsystem, no verdict")
    for word in (UNSTABLE, UNDECIDED, CRITICAL):
        found = [v for v in parts if v.word == word]
        if found:
            return found[0]
    moving = tuple(v for v in parts if v != _coasting())
    if moving and len(moving) < len(parts) and {v.word for v in moving} <= _ASYMPTOTIC:
        return _beside_constant_momenta(combine(moving))
    words = {v.word for v in parts}
    theorems = ", ".join(sorted({v.theorem for v in parts if v.theorem}))
    if len(words) == 1:
        return replace(parts[0], theorem=theorems)
    dissipating = words & {ASYMPTOTIC, ASYMPTOTIC_BUT_CYCLIC}
    if words <= {ASYMPTOTIC, ASYMPTOTIC_BUT_CYCLIC}:
        return Verdict(ASYMPTOTIC_BUT_CYCLIC, theorems, "A part of the coordinates is cyclic.")
    if not dissipating and GYROSCOPIC in words:
        return next(v for v in parts if v.word == GYROSCOPIC)  # the theorems of the other parts do not carry it
    if not dissipating:
        return Verdict(STABLE_BUT_CYCLIC, theorems, "A part of the coordinates is cyclic.")
    return Verdict(CRITICAL, "", "Some parts are asymptotically stable, others not; no theorem covers both.")


_ASYMPTOTIC = {ASYMPTOTIC, ASYMPTOTIC_BUT_CYCLIC, ASYMPTOTIC_BUT_TURNED}


def _beside_constant_momenta(verdict: Verdict) -> Verdict:
    """The rest is asymptotically stable, and stays so for momenta that differ a little."""
    word = ASYMPTOTIC_BUT_CYCLIC if verdict.word == ASYMPTOTIC else verdict.word
    why = " The momenta of cyclic coordinates are constant, so their velocities stay near theirs."
    return replace(verdict, word=word, explanation=verdict.explanation + why)


def _turned_factor(system: LinearSystem, factors: tuple[Factor, ...]) -> int | None:
    """The position of the simple factor that a turned steady spin explains."""
    if not system.turned:
        return None
    top, bottom = system.turned
    for i, factor in enumerate(factors):
        p = factor.coefficients
        if len(p) == 3 and p[1] == 0 and p[0] * top == p[2] * bottom and factor.multiplicity == 1:
            return i
    return None


def _requirements(
    system: LinearSystem, factors: tuple[Factor, ...], even: bool, signs: Signs, known: Signs, turned: int | None
) -> tuple[tuple[Requirement, ...], list[str]]:
    """The conditions on the factors of the characteristic polynomial, and remarks on what they leave open.

    Nothing is required of the factor number ``turned``.
    """
    requirements: list[Requirement] = []
    remarks: list[str] = []
    for index, factor in enumerate(factors, start=1):
        suffix = f" of factor {index}" if len(factors) > 1 else ""
        if index - 1 == turned:
            remarks.append(f"Factor {index} belongs to the steady spins about other directions of space.")
            continue
        p = factor.coefficients
        lead, word = p[-1], known.sign(p[-1])
        if word == "negative":
            p = tuple(-c for c in p)
        alone = len(factors) == 1 and factor.multiplicity == 1
        if alone:
            # det M > 0 is the leading coefficient, up to a positive factor.
            requirements.append(Requirement(_power_name(even, len(p) - 1), p[-1], signs.condition(p[-1]), by_mass=True))
        elif word not in ("positive", "negative"):
            p = tuple(lead * c for c in p)
        try:
            wanted = _even_wanted(p) if even else lienard_chipart(p)[1:]
        except TooLargeError as error:
            remarks.append(f"The conditions{suffix} are not written out ({error}); at a point they are exact.")
            requirements.append(_unwritten(p[0]))
            continue
        reduced = [Requirement(label + suffix, value, known.condition(value)) for label, value in wanted]
        requirements += reduced if even else _without_implied(_spared(reduced, len(p) - 1))
    if even and not _is_potential(system):
        requirements += _simple(system, factors, known, remarks)
    elif even and sum(len(f.coefficients) - 1 for f in factors) > 1:
        remarks.append(
            "In a conservative system without gyroscopic forces the roots in lambda^2 are real and semisimple: "
            "K > 0 is necessary and sufficient, a vanishing discriminant (equal frequencies) does no harm."
        )
    return tuple(requirements), remarks


def _spared(wanted: list[Requirement], degree: int) -> list[Requirement]:
    """Lienard-Chipart needs, besides a_0 and the minors, only every second coefficient: the simpler half is kept.

    ``wanted`` begins with a_(n-1), ..., a_0; for even n the first of them is the minor Delta_1 and stays.
    """
    if degree < 3 or any(r.never for r in wanted):
        return wanted
    first = 1 if degree % 2 == 0 else 0
    numbered = list(zip(range(degree - 1 - first, 0, -1), wanted[first:], strict=False))
    halves = [[r for k, r in numbered if k % 2 == odd] for odd in (0, 1)]
    weight = [sum(len(r.condition.polynomial) for r in half if not r.always) for half in halves]
    left_out = halves[0] if weight[0] > weight[1] else halves[1]
    return [r for r in wanted if not any(r is other for other in left_out)]


def _without_implied(wanted: list[Requirement]) -> list[Requirement]:
    """f != 0 goes without saying where a product with f is required to be positive."""
    strict = [f for r in wanted for f in r.condition.factors]
    found = []
    for r in wanted:
        left = tuple(f for f in r.condition.nonzero if not any(f in (g, -g) for g in strict))
        if r.condition.kind == "nonzero" and not left:
            r = replace(r, condition=Condition("always", r.condition.polynomial))
        elif left != r.condition.nonzero:
            r = replace(r, condition=replace(r.condition, nonzero=left))
        found.append(r)
    return found


def _power_name(even: bool, i: int) -> str:
    return f"v{2 * i}" if even else f"a{i}"


def _even_wanted(p: Coefficients) -> list[tuple[str, Polynomial]]:
    n = len(p) - 1
    wanted = [(f"v{2 * i}", p[i]) for i in range(n - 1, -1, -1)]
    if n >= 2:
        table = subdiscriminants(p)
        # Up to degree 3 the discriminant alone makes the roots real.
        first = 2 if n >= 4 else n
        wanted += [(f"subdiscriminant {k}" if k < n else "discriminant", table[k - 1]) for k in range(first, n + 1)]
    return wanted


def _simple(system: LinearSystem, factors: tuple[Factor, ...], known: Signs, remarks: list[str]) -> list[Requirement]:
    """No common roots of different factors; a factor that occurs several times must be semisimple."""
    requirements = []
    for i, left in enumerate(factors):
        try:
            for j in range(i + 1, len(factors)):
                value = resultant(left.coefficients, factors[j].coefficients)
                requirements.append(_differs(f"resultant of factors {i + 1} and {j + 1}", value, known))
            if left.multiplicity > 1:
                simple = _is_semisimple(system, left)
                if not simple:
                    never = left.coefficients[0] * 0
                    requirements.append(_differs(f"multiplicity of factor {i + 1}", never, known))
                how = "simple elementary divisors" if simple else "Jordan blocks: its roots are never semisimple"
                remarks.append(f"Factor {i + 1} occurs {left.multiplicity} times, with {how}.")
        except TooLargeError as error:
            requirements.append(_unwritten(left.coefficients[0]))
            remarks.append(f"Whether roots of factor {i + 1} coincide with others is left open: {error}.")
    return requirements


def _is_semisimple(system: LinearSystem, factor: Factor) -> bool:
    in_lambda = tuple(c for v in factor.coefficients for c in (v, v * 0))[:-1]
    c, k = _add(system.D, system.G), _add(system.K, system.N)
    return is_semisimple(system.M, c, k, in_lambda, factor.multiplicity)


def _unwritten(p: Polynomial) -> Requirement:
    """Neither provable nor refutable, so that no verdict can rest on what was left out."""
    return Requirement(UNWRITTEN, p, Condition("unwritten", p * 0 + 1))


def _cases(system: LinearSystem, found: Stability, known: Signs) -> tuple[Case, ...]:
    stiff, wanted = found.stiffness.requirements, found.requirements
    unstable = _unstable(wanted, known)
    if not _is_zero(system.N) or found.dissipation is not None:
        if found.variable == "lambda^2":
            why = "All roots are imaginary and simple; the forces are not potential."
            return Case(wanted, (), _critical(why)), *unstable
        if found.dissipation is None:
            odd = tuple(_differs(f"a{i}", c, known) for i, c in enumerate(found.polynomial) if i % 2 and c != 0)
            why = "Without dissipation the roots sum to zero, but they are not symmetric: some lie to the right."
            return (Case((), odd, Verdict(UNSTABLE, LYAPUNOV, why)),)
        if not _is_zero(system.N) or found.dissipation.word != "positive definite":
            return Case(wanted, (), _turned(_asymptotic()) if found.turned else _asymptotic()), *unstable
    negative = _reversed(stiff, known)
    if found.dissipation is not None:
        nonsingular = _differs("det K", stiff[-1].polynomial, known)
        complete = Verdict(ASYMPTOTIC, KELVIN_CHETAEV, "K > 0 and complete dissipation.")
        destroyed = Verdict(UNSTABLE, KELVIN_CHETAEV, "Complete dissipation, and K is not positive definite.")
        return Case(stiff, (), complete), Case((nonsingular,), negative, destroyed)
    if _is_potential(system):
        why = "K is not positive semidefinite: a real positive root lambda."
        return Case(stiff, (), _conservative(system)), Case((), negative, Verdict(UNSTABLE, LYAPUNOV, why))
    odd_degree = "det K < 0: an odd degree of instability, which gyroscopic forces cannot remove."
    return (
        Case(stiff, (), _conservative(system)),
        Case(wanted, (), _gyroscopic()),
        Case((), negative[-1:], Verdict(UNSTABLE, KELVIN_CHETAEV, odd_degree)),
        *unstable,
    )


def _cases_with_zero_roots(
    system: LinearSystem, found: Stability, known: Signs
) -> tuple[tuple[Case, ...], Stability | None]:
    """Cyclic coordinates: ignore them (Routh) or strike their roots; other zero roots are a border."""
    unstable = _unstable(found.requirements, known)
    if not system.cyclic:
        return unstable, None
    if _only_momenta(system):
        by_mass = tuple(replace(r, by_mass=True) for r in found.mass.requirements)
        return (Case(by_mass, (), _coasting()),), None
    if _momenta_are_constant(system):
        reduced = analyse(ignoring_cyclic(system), known)
        return tuple(replace(c, verdict=drifting(c.verdict)) for c in reduced.cases), reduced
    if found.zero_power == len(system.cyclic) and found.variable == "lambda":
        return (Case(found.requirements, (), drifting(_asymptotic())), *unstable), None
    return unstable, None


def _only_momenta(system: LinearSystem) -> bool:
    """Whether all coordinates are cyclic and nothing acts on them: M q'' = 0."""
    idle = all(_is_zero(matrix) for matrix in (system.D, system.G, system.K, system.N))
    return system.conservative and idle and not system.driven and len(system.cyclic) == system.size


def _coasting() -> Verdict:
    why = "All coordinates of this part are cyclic: their momenta are constant, so their velocities stay near theirs."
    return Verdict(STABLE_BUT_CYCLIC, "", why)


def ignoring_cyclic(system: LinearSystem) -> LinearSystem:
    """Routh's reduction, D and N without cyclic rows: cyclic velocities expressed by their constant momenta.

    With c the cyclic and r the other coordinates, M_cc q_c' + M_cr q_r' + G_cr q_r = const gives::

        M_R = M_rr - M_rc W M_cr,   G_R = G_rr - M_rc W G_cr - G_rc W M_cr,   K_R = K_rr - G_rc W G_cr,   W = M_cc^-1

    and D_R = D_rr, N_R = N_rr; everything here times det M_cc > 0.  K_R is the second derivative of the effective
    potential.
    """
    if not _momenta_are_constant(system):
        raise ValueError("Routh's reduction needs cyclic coordinates without D and N and no G between them, and others")
    cyclic = system.cyclic
    rest = [i for i in range(system.size) if i not in cyclic]
    block = [[system.M[i][j] for j in cyclic] for i in cyclic]
    scale, inverse = determinant(block), _adjugate(block)

    def schur(main: Matrix, *pairs: tuple[Matrix, Matrix]) -> Matrix:
        return tuple(
            tuple(
                scale * main[i][j]
                - sum(
                    (
                        left[i][c] * inverse[a][b] * right[d][j]
                        for left, right in pairs
                        for a, c in enumerate(cyclic)
                        for b, d in enumerate(cyclic)
                    ),
                    start=scale * 0,
                )
                for j in rest
            )
            for i in rest
        )

    m, g = system.M, system.G
    return LinearSystem(
        schur(m, (m, m)),
        schur(system.D),
        schur(g, (m, g), (g, m)),
        schur(system.K, (g, g)),
        schur(system.N),
        system.conservative,
        turned=system.turned,
    )


def _momenta_are_constant(system: LinearSystem) -> bool:
    between = any(system.G[i][j] != 0 for i in system.cyclic for j in system.cyclic)
    acted_on = any(x != 0 for matrix in (system.D, system.N) for i in system.cyclic for x in matrix[i])
    return not acted_on and not between and not system.driven and 0 < len(system.cyclic) < system.size


def _first_certain(cases: Sequence[Case]) -> Verdict:
    """The first case proved to hold while all before it are refuted."""
    for case in cases:
        if case.always:
            return case.verdict
        if not case.never:
            return Verdict(UNDECIDED, "", "It depends on the parameters; see the cases.")
    return Verdict(UNDECIDED, "", "On a border: no theorem of the first approximation decides.")


def _unstable(requirements: Sequence[Requirement], known: Signs) -> tuple[Case, ...]:
    """One case at most: some necessary inequality is reversed, so that there is a root with positive real part."""
    against = _reversed(requirements, known)
    return (Case((), against, Verdict(UNSTABLE, LYAPUNOV, "A root with positive real part.")),) if against else ()


def _reversed(requirements: Sequence[Requirement], known: Signs) -> tuple[Requirement, ...]:
    """p < 0 for every p > 0.  By continuity none of them occurs while all roots have Re <= 0 (or mu <= 0)."""
    return tuple(
        Requirement(f"-({r.label})", -r.polynomial, known.condition(-r.polynomial))
        for r in requirements
        if r.relation == ">" and not r.by_mass and r.label != UNWRITTEN
    )


def _differs(label: str, p: Polynomial, known: Signs) -> Requirement:
    return Requirement(label, p, known.nonzero_condition(p), "!=")


def _without_known_factor(p: Coefficients, known: Signs) -> tuple[Coefficients, Polynomial]:
    """p = removed * q, with ``removed`` > 0 proved; common factors of unknown sign stay in q."""
    q, common = primitive(p)
    unit, powers = irreducible_factors(common)
    removed, kept = common * 0 + abs(unit), common * 0 + (1 if unit > 0 else -1)
    for factor, multiplicity in powers:
        power = factor**multiplicity
        word = known.sign(power)
        if word == "positive":
            removed *= power
        elif word == "negative":
            removed *= -power
            kept = -kept
        else:
            kept *= power
    return tuple(c * kept for c in q), removed


def _factors(p: Coefficients) -> tuple[Factor, ...]:
    """Irreducible factors; what is free of lambda and not a number stays with a single simple factor."""
    found = factor_in_lambda(p)[1]
    if len(found) == 1 and found[0][1] == 1:
        return (Factor(p, 1),)
    return tuple(Factor(coefficients, multiplicity) for coefficients, multiplicity in found)


def _asymptotic() -> Verdict:
    return Verdict(ASYMPTOTIC, LYAPUNOV, "All roots have negative real parts.")


def _turned(verdict: Verdict) -> Verdict:
    return replace(
        verdict,
        word=ASYMPTOTIC_BUT_TURNED,
        theorem=MALKIN,
        explanation=(
            "All roots have negative real parts but those of the steady spins about other directions of space: a "
            "disturbed motion tends to a steady spin about an axis near by, and every variable that does not change "
            "when everything is turned in space tends to its value there."
        ),
    )


def _critical(explanation: str) -> Verdict:
    return Verdict(CRITICAL, "", explanation + " Terms of higher order decide.")


def _conservative(system: LinearSystem) -> Verdict:
    theorem = LAGRANGE if _is_zero(system.G) else ROUTH
    if not system.conservative:
        return _critical("K > 0, but no energy integral of the nonlinear system is known.")
    return Verdict(STABLE, theorem, "K > 0: the (changed) potential energy has a strict minimum.")


def _gyroscopic() -> Verdict:
    return Verdict(
        GYROSCOPIC,
        "",
        "The necessary conditions hold, but K is not positive definite: the first approximation is stable by "
        "gyroscopic forces alone, complete dissipation would make it unstable (Kelvin-Chetaev), and the nonlinear "
        "system is open.",
    )


def drifting(verdict: Verdict) -> Verdict:
    words = {STABLE: STABLE_BUT_CYCLIC, ASYMPTOTIC: ASYMPTOTIC_BUT_CYCLIC}
    return replace(
        verdict,
        word=words.get(verdict.word, verdict.word),
        # A minimum of the effective potential at constant cyclic momenta is Routh's theorem.
        theorem=ROUTH if verdict.theorem == LAGRANGE else verdict.theorem,
        explanation=(
            f"{verdict.explanation} This is about the other coordinates and all velocities; a perturbation of the "
            "cyclic velocities makes the cyclic coordinates drift away."
        ),
    )


# -- at rational values -------------------------------------------------------------------------------------------


def verdict_at(system: LinearSystem, point: Mapping[int, Fraction]) -> PointVerdict:
    """The exact verdict at rational parameter values {index of the generator: value}.

    Half-planes are counted exactly; whether multiple imaginary roots are semisimple is read off the minimal
    polynomial.  Raises ValueError when a parameter that occurs has no value, or when M, D or K is not symmetric (up
    to positive factors of the rows).
    """
    m, d, g, k, n = (_evaluate(matrix, point) for matrix in system.matrices)
    if m.det() == 0:
        return PointVerdict(Verdict(UNDECIDED, "", MASS_SINGULAR), (), None)
    a = _first_order(m, d + g, k + n)
    characteristic = tuple(a.charpoly().coeffs())
    roots = count_roots(characteristic)
    if not system.cyclic or roots.right:
        verdict = _judge(m, d, g, k, n, system.conservative)
        if system.turned and not roots.right and not (_no(d) and _no(n)):
            verdict = _judge_turned(a, [_number(x, point) for x in system.turned], verdict)
        return PointVerdict(verdict, characteristic, roots)
    if roots.left + len(system.cyclic) == 2 * system.size:
        return PointVerdict(drifting(_asymptotic()), characteristic, roots)
    there = _with_numbers(system, (m, d, g, k, n))  # a damper of coefficient 0 changes no momentum
    if _only_momenta(there):
        return PointVerdict(_coasting(), characteristic, roots)
    if _momenta_are_constant(there):
        reduced = verdict_at(ignoring_cyclic(there), point)
        return PointVerdict(drifting(reduced.verdict), characteristic, roots)
    why = "Cyclic coordinates give zero roots, and no theorem decides about the rest."
    return PointVerdict(Verdict(UNDECIDED, "", why), characteristic, roots)


def _with_numbers(system: LinearSystem, numbers: Sequence[Numbers]) -> LinearSystem:
    """The system with ``numbers`` for its matrices M, D, G, K, N."""
    context, size = system.M[0][0].context(), range(system.size)
    m, d, g, k, n = (tuple(tuple(context.constant(matrix[i, j]) for j in size) for i in size) for matrix in numbers)
    return replace(system, M=m, D=d, G=g, K=k, N=n)


def _judge(m: Numbers, d: Numbers, g: Numbers, k: Numbers, n: Numbers, conservative: bool) -> Verdict:
    a = _first_order(m, d + g, k + n)
    roots = count_roots(a.charpoly().coeffs())
    massive, stiff, damped = is_positive(m), is_positive(k), is_positive(d)
    for matrix in (m, d, k):
        inertia(matrix)  # raises where it is not symmetric
    potential, undamped, gyroscopic = _no(n), _no(d), not _no(g)
    if roots.right:
        why = f"{roots.right} root{'s' if roots.right > 1 else ''} with positive real part."
        if massive and potential and damped and k.det() != 0:
            return Verdict(UNSTABLE, KELVIN_CHETAEV, why + " Complete dissipation, and K is not positive definite.")
        if massive and potential and undamped and gyroscopic and k.det() < 0:
            return Verdict(UNSTABLE, KELVIN_CHETAEV, why + " det K < 0: an odd degree of instability.")
        return Verdict(UNSTABLE, LYAPUNOV, why)
    if roots.left == roots.degree:
        if massive and potential and damped and stiff:
            return Verdict(ASYMPTOTIC, KELVIN_CHETAEV, "K > 0 and complete dissipation.")
        return _asymptotic()
    if massive and undamped and potential and stiff:
        if not conservative:
            return _critical("K > 0, but no energy integral of the nonlinear system is known.")
        why = "K > 0: the (changed) potential energy has a strict minimum."
        return Verdict(STABLE, ROUTH if gyroscopic else LAGRANGE, why)
    blocks = count_roots(a.minpoly().coeffs())
    if max(blocks.imaginary_multiplicity, blocks.zero) > 1:
        why = "A multiple root on the imaginary axis is not semisimple: the linear equations have growing solutions, "
        return Verdict(UNDECIDED, "", why + "the nonlinear system is not decided by them.")
    if roots.zero:
        return Verdict(UNDECIDED, "", "A zero root: terms of higher order decide.")
    if massive and undamped and potential:
        verdict = _gyroscopic()
        if roots.imaginary_multiplicity > 1:
            why = " Frequencies coincide (semisimple): a border of the region of gyroscopic stabilisation may be here."
            return replace(verdict, explanation=verdict.explanation + why)
        return verdict
    return _critical("No root has a positive real part, but some are imaginary.")


def _judge_turned(a: Numbers, turned: Sequence[Any], whole: Verdict) -> Verdict:
    """The roots that remain without those of p lambda^2 + q, (p, q) = ``turned``, decide; none has Re > 0."""
    top, bottom = turned
    polynomial, remainder = divmod(a.charpoly(), fmpq_poly([bottom, 0, top]))
    if remainder != 0:
        return whole
    roots = count_roots(polynomial.coeffs())
    if roots.left == roots.degree:
        return _turned(_asymptotic())
    if roots.zero or roots.imaginary_multiplicity > 1:
        return Verdict(UNDECIDED, "", "Besides the turned steady spins there are zero or multiple imaginary roots.")
    why = "No root has a positive real part, but some are imaginary besides those of the turned steady spins."
    return _critical(why)


def inertia(matrix: Numbers) -> tuple[int, int, int]:
    """(positive, zero, negative) eigenvalues of a symmetric rational matrix, by Descartes' rule, which is exact here.

    Rows may be scaled by positive factors.  Raises ValueError if the eigenvalues are not all real.
    """
    cs = matrix.charpoly().coeffs()
    zero = next(i for i, c in enumerate(cs) if c != 0)
    positive = _changes_of_sign(cs)
    negative = _changes_of_sign([-c if i % 2 else c for i, c in enumerate(cs)])
    if positive + zero + negative != matrix.nrows():
        raise ValueError("a matrix that should be symmetric is not")
    return positive, zero, negative


def _changes_of_sign(numbers: Sequence[Any]) -> int:
    signs = [c > 0 for c in numbers if c != 0]
    return sum(a != b for a, b in pairwise(signs))


def _evaluate(matrix: Matrix, point: Mapping[int, Fraction]) -> Numbers:
    n = len(matrix)
    return fmpq_mat(n, n, [_number(entry, point) for row in matrix for entry in row])


def _number(entry: Polynomial, point: Mapping[int, Fraction]) -> Any:
    context = entry.context()
    missing = [i for i, degree in enumerate(entry.degrees()) if degree > 0 and i not in point]
    if missing:
        raise ValueError(f"no value for {', '.join(context.names()[i] for i in missing)}")
    return fmpq(entry(*(rational(point.get(i, 0)) for i in range(context.nvars()))))


def _first_order(m: Numbers, c: Numbers, k: Numbers) -> Numbers:
    """The matrix of (q, q')' = A (q, q')."""
    n = m.nrows()
    inverse = m.inv()
    position, velocity = inverse * k, inverse * c
    a = fmpq_mat(2 * n, 2 * n)
    for i in range(n):
        a[i, n + i] = 1
        for j in range(n):
            a[n + i, j] = -position[i, j]
            a[n + i, n + j] = -velocity[i, j]
    return a


def is_positive(matrix: Numbers) -> bool:
    """Whether a symmetric rational matrix is positive definite: all leading minors are positive."""
    n, rows = matrix.nrows(), matrix.tolist()
    return all(fmpq_mat(s, s, [x for row in rows[:s] for x in row[:s]]).det() > 0 for s in range(1, n + 1))


def _no(matrix: Numbers) -> bool:
    return all(x == 0 for x in matrix.entries())


def _add(left: Matrix, right: Matrix) -> Matrix:
    return tuple(tuple(a + b for a, b in zip(*rows, strict=True)) for rows in zip(left, right, strict=True))


def _is_zero(matrix: Matrix) -> bool:
    return all(entry == 0 for row in matrix for entry in row)


def _is_potential(system: LinearSystem) -> bool:
    return all(_is_zero(matrix) for matrix in (system.D, system.G, system.N))


def _adjugate(block: Matrix) -> Matrix:
    n = len(block)
    one = block[0][0] * 0 + 1

    def cofactor(i: int, j: int) -> Polynomial:
        rows = [[x for col, x in enumerate(row) if col != i] for at, row in enumerate(block) if at != j]
        value = determinant(rows) if rows else one
        return -value if (i + j) % 2 else value

    return tuple(tuple(cofactor(i, j) for j in range(n)) for i in range(n))
