"""Rests that are judged by what is near them: a manifold of rests, or the energy of the system with fewer constraints.

At rest the velocities that constraints J q' + j = 0 leave obey  Y^T f(q, 0) = 0,  and j(q) = 0.  Where r of these
equations have independent gradients at a rest, and the others are combinations of them, the rests near by are a
manifold of dimension n - r.

Sources: J. I. Neimark, N. A. Fufaev, Dynamics of Nonholonomic Systems (1972), chapter V; I. G. Malkin, Theory of
Stability of Motion, section 34; H. Rubin, P. Ungar, Comm. Pure Appl. Math. 10 (1957) 65-87.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from itertools import chain, combinations
from math import prod
from typing import TYPE_CHECKING, Any

from flint import arb, ctx, fmpq_mat

from mbsym.algebra.characteristic import characteristic_polynomial, lienard_chipart
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.factors import irreducible_factors, occurring
from mbsym.algebra.failures import NOT_THERE, Failure, NotRational
from mbsym.algebra.kernel import kernel
from mbsym.algebra.matrices import added, determinant, faddeev
from mbsym.analysis.higher import momenta_at_rest
from mbsym.mechanics.loads.kinds import generalized_forces
from mbsym.mechanics.motion import relations, unperturbed_with
from mbsym.mechanics.variables import ring_environment
from mbsym.model.constraints import is_holonomic
from mbsym.model.substitution import beside_rest
from mbsym.problems.stability.verdict import Flaw, Verdict, concluded
from mbsym.problems.stability.words import CHETAEV, LAGRANGE, Because, Fact, Ground, Reason, Word

#: So often functions are differentiated along a field.
MOST_DERIVATIVES = 6

#: In bits, of the sign of a number that is not 0.
PRECISION = 200

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from mbsym.algebra.ring import Polynomial, Ring
    from mbsym.analysis.pipeline import Analysis
    from mbsym.model.system import System
    from mbsym.problems.displacements import Direction


def by_energy_with_fewer_constraints(
    analysis: Analysis,
    judged: Callable[[System], tuple[Analysis, Verdict]],
    values: Mapping[str, Any],
    conserved: bool,
) -> Verdict | None:
    """The verdict on a rest by its energy where constraints on velocities are left out; None where there are none.

    Rows J q' = 0 do no work: an energy that does not grow without them does not grow with them.  What may drift without
    them has to be free to do so with them, too, and not to be stopped: the energy is ``conserved``.  Constant momenta
    may have carried a minimum with gyroscopic forces, which reactions change.  ``judged`` gives the analysis of another
    system, and its verdict.
    """
    system = analysis.system
    holonomic = tuple(filter(is_holonomic, system.constraints))
    if len(holonomic) == len(system.constraints):
        return None
    there, verdict = judged(replace(system, constraints=holonomic, dependent=()))
    names = verdict.laid.get(Ground.ENERGY, (CHETAEV,))
    if CHETAEV in names:
        return None
    reasons = Reason(Because.FEWER_CONSTRAINTS), Reason(Because.DRIFT)
    if Flaw.CYCLIC not in verdict.flawed:
        return Verdict(Word.STABLE, (LAGRANGE,), reasons[:1])
    if system.prescribed or not conserved or _gyroscopic(there, values):
        return None
    if Ground.IDLE not in verdict.laid and not _drifts(analysis, there):
        return None
    return Verdict(Word.STABLE_BUT_CYCLIC, (LAGRANGE,), reasons)


def _drifts(analysis: Analysis, there: Analysis) -> bool:
    """Whether constraints J q' = 0 leave free one of the constant displacements D that change nothing without them.

    Either  J (c . D) = 0  for numbers c, wherever it is: its momentum is constant then (Noether).  Or the system may
    move evenly along D.  At the rest alone it is not enough: y' = x x' bends x up.
    """
    ring, names = there.ring, there.system.coordinates
    found = there.balance.displacements(names)
    place = unperturbed_with(there.scene, relations(there.scene))
    carry = Carrier(analysis.ring, ring, ring_environment(there.system, ring))
    rows = [[carry(x) for x in row] for row in analysis.constraints.jacobian.polynomials]
    if _moves_evenly(there, rows, (*found.directions[: found.constant], *there.balance.varying_fields), place):
        return True
    fields = found.directions
    held = [[ring.reduce(ring.dot(row, one)).to_dict() for row in rows] for one in fields]
    terms = sorted({(r, key) for one in held for r, x in enumerate(one) for key in x})
    if not fields or fmpq_mat([[one[r].get(key, 0) for r, key in terms] for one in held]).rank() == len(fields):
        return False
    at_rest = [[ring.reduce(ring.substitute(x, place)) for x in one] for one in fields]
    chosen = combinations(zip(*at_rest, strict=True), len(fields))
    return any(ring.is_zero(ring.reduce(determinant(ring, list(map(list, some))))) is False for some in chosen)


def _moves_evenly(
    there: Analysis, rows: list[list[Polynomial]], fields: Sequence[Direction], place: Mapping[int, Polynomial]
) -> bool:
    """Whether exp(e t c) q0 is a motion for every e, c a symmetry of the system without the rows J, at rest at q0.

    Without them it is one where c^T M c is stationary at q0: along c, which keeps T, the acceleration is that of the
    forces at rest less grad(c^T M c)/2.  J allows it where J c = 0 along the orbit.
    """
    ring, names = there.ring, there.system.coordinates

    def vanishes(x: Polynomial) -> bool:
        return ring.is_zero(ring.reduce(ring.substitute(x, place))) is True

    allowed = ([ring.substitute(ring.dot(row, one), place) for one in fields] for row in rows)
    for weights in kernel(ring, *allowed) if fields else ():
        along = [
            ring.reduce(ring.dot(list(weights.values()), [fields[k][i] for k in weights])) for i in range(len(names))
        ]
        inertia = ring.dot(along, [ring.dot(row, along) for row in there.equations.mass_matrix.polynomials])
        moves = any(there.signs.never_zero(ring.reduce(ring.substitute(x, place))) for x in along)
        still = moves and all(vanishes(ring.derivative(inertia, name)) for name in names)
        if still and _vanish_along(there, [ring.dot(row, along) for row in rows], along, vanishes):
            return True
    return False


def _vanish_along(
    there: Analysis,
    functions: Iterable[Polynomial],
    along: Sequence[Polynomial],
    vanishes: Callable[[Polynomial], bool],
) -> bool:
    """Whether functions of q are 0 on the orbit of a field, which begins where ``vanishes`` looks.

    So they are where they and their derivatives along the field are 0 there, up to those that are combinations of the
    ones before with constant coefficients: they obey linear equations then.
    """
    ring = there.ring
    known: list[Polynomial] = []
    latest = [x for x in map(ring.reduce, functions) if not x.is_zero()]
    for _ in range(MOST_DERIVATIVES):
        if not latest:
            return True
        if not all(map(vanishes, latest)):
            return False
        known += latest
        slopes = ([ring.derivative(x, name) for name in there.system.coordinates] for x in latest)
        latest = []
        for x in (ring.reduce(ring.dot(row, along)) for row in slopes):
            columns = [*known, *latest, x]
            last = (relation.get(len(columns) - 1) for relation in kernel(ring, columns))
            if not x.is_zero() and not any(k is not None and there.signs.never_zero(k) for k in last):
                latest.append(x)
    return False


def by_rests_near(analysis: Analysis, values: Mapping[str, Any], decaying: bool) -> Verdict | None:
    """The verdict where the rests near by are a manifold; None where the values are not rational, or it is not shown.

    ``decaying``, Lyapunov and Malkin: all roots are to the left but the zero ones, as many as it has dimensions.  Else,
    Rubin and Ungar: the energy is conserved, without gyroscopic forces, and V has a strict minimum across it, not the
    same one everywhere: what moves along it does not move along a symmetry.
    """
    system = analysis.system
    if system.prescribed or system.speeds or analysis.ring.kinked or not at_rest(analysis):
        return None
    try:
        rests = _rests(analysis, values)
        if rests is None or not rests.dimension:
            return None
        numbers = _Numbers(analysis.parameters_scene.ring)
        given = numbers.ring.given(values)
        shown = analysis.autonomous
        m, d, g, k, n = (
            [[numbers.at(x, given) for x in row] for row in part.polynomials]
            for part in (shown.M, shown.D, shown.G, shown.K, shown.N)
        )
        if decaying:
            polynomial = list(map(numbers.ring.reduce, characteristic_polynomial(m, added(d, g), added(k, n))))
            zero = next(power for power, x in enumerate(polynomial) if not numbers.vanishes(x))
            beside = len(system.coordinates) - len(m)  # coordinates of which only the velocities are dependent
            left = zero + beside == rests.dimension and numbers.to_the_left(polynomial[zero:])
            return concluded({Fact.LEFT_BUT_STEADY}) if left else None
        conserved = not system.constraints and analysis.balance.at(values).conserves
        across = all(map(numbers.vanishes, chain(*n))) and numbers.semidefinite(k, len(rests.equations))
        if conserved and across and not _gyroscopic(analysis, values) and rests.varies(_change(analysis, rests)):
            facts = {Fact.MINIMUM_ACROSS_RESTS, Fact.NOT_GYROSCOPIC, Fact.ENERGY_CONSERVED}
            return concluded(facts, Reason(Because.ALONG_RESTS, (rests.dimension,)))
    except (Failure, *NOT_THERE):
        return None
    return None


def by_one_coordinate(
    analysis: Analysis, values: Mapping[str, Any], judged: Callable[[System], Verdict]
) -> Verdict | None:
    """Instability of one coordinate while the others rest, where that is a motion: their equations hold on it.

    What nothing drives leaves evenly; it does not move along a symmetry where tr(M^-1 K) varies with it.
    """
    system, ring, equations = analysis.system, analysis.ring, analysis.equations
    names = system.coordinates
    if len(names) < 2 or system.constraints or system.prescribed or system.speeds or not at_rest(analysis):
        return None
    found = _Rests(ring, names, *_at_values(analysis, values))
    for i, name in enumerate(names):
        still = found.plane([other for other in names if other != name])
        rows = [(*equations.mass_matrix.polynomials[j], equations.forcing[j].polynomial) for j in range(len(names))]
        hold = (x for j, row in enumerate(rows) if j != i for x in (row[i], row[-1]))
        if not all(ring.is_zero(ring.reduce(ring.substitute(x, still))) is True for x in hold):
            continue
        verdict = judged(beside_rest(system, [name]))
        if Ground.IDLE in verdict.laid:
            change = ring.reduce(ring.substitute(_change(analysis, found), still))
            if ring.is_zero(change) is not False:
                continue
            verdict = concluded({Fact.POTENTIAL_CONSTANT, Fact.NOT_GYROSCOPIC, Fact.ENERGY_CONSERVED})
        if verdict.word is Word.UNSTABLE:
            return replace(verdict, reasons=(*verdict.reasons, Reason(Because.WHILE_OTHERS_REST, (name,))))
    return None


def at_rest(analysis: Analysis) -> bool:
    """Whether nothing moves on the unperturbed motion."""
    base = analysis.reduced.expansion.base
    return not base.turning and all(x.is_zero() for x in base.rates)


def _gyroscopic(analysis: Analysis, values: Mapping[str, Any]) -> bool:
    """Whether there may be forces that hang on velocities, but for those of T_2."""
    ring, names, numbers = analysis.ring, analysis.system.coordinates, dict(_at_values(analysis, values)[0])
    applied = generalized_forces(analysis.held_scene).values()
    slopes = (ring.velocity_derivative(x, name) for x in applied for name in names)
    return not all(ring.vanishes(ring.substitute(x, numbers)) for x in (*momenta_at_rest(analysis), *slopes))


@dataclass(frozen=True)
class _Numbers:
    """Numbers in a ring: rational ones, square roots, and what is made of them."""

    ring: Ring

    def at(self, x: Polynomial, place: Mapping[int, Polynomial]) -> Polynomial:
        """x where generators are these.  Raises NotRational where it hangs on a name still."""
        value = self.ring.reduce(self.ring.substitute(x, dict(place)))
        if not self._known(value):
            raise NotRational("a derivative has no exact value")
        return value

    def _known(self, x: Polynomial) -> bool:
        made_of = (self.ring.generators[k] for k in occurring([x]))
        return all(g.name == "pi" if g.argument is None else self._known(g.argument) for g in made_of)

    def vanishes(self, x: Polynomial) -> bool:
        """Raises NotRational where neither is proved."""
        zero = self.ring.is_zero(x)
        if zero is None:
            raise NotRational("a derivative has no exact value")
        return zero

    def positive(self, x: Polynomial) -> bool:
        """Whether x is proved to be greater than 0."""
        names = dict.fromkeys(self.ring.names(), arb(0)) | {"pi": arb.pi()}
        with ctx.workprec(PRECISION):
            return bool(self.ring.evaluate(self.ring.reduce(x), names) > 0)

    def to_the_left(self, polynomial: Sequence[Polynomial]) -> bool:
        """Whether all roots have Re < 0 (Lienard and Chipart); coefficients from low to high powers."""
        return all(self.positive(x) for _, x in lienard_chipart(polynomial))

    def semidefinite(self, k: Sequence[Sequence[Polynomial]], rank: int) -> bool:
        """Whether a symmetric K is positive semidefinite of this rank, by det(s + K) = s^n + e_1 s^(n-1) + ... + e_n.

        All roots are real: e_1, ..., e_rank > 0, the others are 0.
        """
        ring = self.ring
        *_, whole = faddeev([[-x for x in row] for row in k], ring.zero, ring.one)
        sums = [ring.reduce(x) for x in whole[-2::-1]]
        return all(map(self.positive, sums[:rank])) and all(map(self.vanishes, sums[rank:]))


@dataclass(frozen=True)
class _Rests:
    """The rests near one: the zeros of ``equations``, whose gradients there are independent.

    ``numbers`` and ``place`` are what parameters, and then coordinates, are at the rest, by their generators.
    """

    ring: Ring
    names: tuple[str, ...]
    numbers: Mapping[int, Polynomial]
    place: Mapping[int, Polynomial]
    equations: list[Polynomial] = field(default_factory=list)
    slopes: list[list[Polynomial]] = field(default_factory=list)

    @property
    def dimension(self) -> int:
        return len(self.names) - len(self.equations)

    def at(self, x: Polynomial) -> Polynomial:
        """x at the rest.  Raises NotRational where it is no number in square roots."""
        return _Numbers(self.ring).at(x, self.place)

    def nonzero(self, x: Polynomial) -> bool:
        """Whether x is proved to differ from 0 at the rest; if not, that it is 0.  Raises NotRational."""
        return not _Numbers(self.ring).vanishes(self.at(x))

    def independent(self, rows: Sequence[Sequence[Polynomial]]) -> tuple[int, ...] | None:
        """Columns at which rows of numbers have a determinant that is not 0; None where there are none."""
        numbers, size = _Numbers(self.ring), len(rows)
        for columns in combinations(range(len(self.names)), size):
            chosen = [[row[k] for k in columns] for row in rows]
            if not numbers.vanishes(self.ring.reduce(determinant(self.ring, chosen))):
                return columns
        return None

    def takes(self, x: Polynomial) -> bool:
        """Whether x is one of the equations now: its gradient is no combination of theirs."""
        own = [self.at(self.ring.derivative(x, name)) for name in self.names]
        if len(self.slopes) == len(self.names) or self.independent([*self.slopes, own]) is None:
            return False
        self.equations.append(x)
        self.slopes.append(own)
        return True

    def numerator(self, x: Polynomial) -> Polynomial:
        """Of x at the numbers.  Raises NotRational where the denominator vanishes at the rest."""
        top, below = self.ring.fraction(self.ring.reduce(self.ring.substitute(x, self.numbers)))
        if not all(self.nonzero(factor) for factor, _ in below):
            raise NotRational("a derivative has no exact value")
        return top

    def vanishing_part(self, x: Polynomial) -> Polynomial:
        """x without the factors that differ from 0 at the rest."""
        factors = irreducible_factors(x)[1] if x else [(x, 1)]
        return prod((factor**exponent for factor, exponent in factors if not self.nonzero(factor)), start=self.ring.one)

    def plane(self, fixed: Collection[str]) -> dict[int, Polynomial]:
        """The states at which these coordinates are what they are at the rest, and do not move."""
        ring, gens = self.ring, self.ring.context.gens()
        place = {k: x for k, x in self.place.items() if k in self.numbers or ring.dependencies(gens[k], fixed)}
        return place | {ring.index("velocity", name): ring.zero for name in fixed}

    def varies(self, x: Polynomial) -> bool:
        """Whether x, which is 0 at the rest, is proved not to be 0 at all rests near by.

        They are a plane of coordinates, or the zeros of one irreducible polynomial.
        """
        ring = self.ring
        plane = self.plane([self.names[j] for j in self.independent(self.slopes) or ()])
        if all(ring.vanishes(ring.substitute(equation, plane)) for equation in self.equations):
            return ring.is_zero(ring.reduce(ring.substitute(x, plane))) is False
        plain = {ring.generators[k].kind for k in occurring([x, *self.equations])} <= {"coordinate"}
        return plain and len(self.slopes) == 1 and divmod(x, self.equations[0])[1] != 0


def _at_values(
    analysis: Analysis, values: Mapping[str, Any]
) -> tuple[Mapping[int, Polynomial], Mapping[int, Polynomial]]:
    """What parameters, and then coordinates, are at the rest."""
    ring = analysis.ring
    numbers = ring.given(values)
    return numbers, unperturbed_with(analysis.scene, relations(analysis.scene) | numbers)


def _rests(analysis: Analysis, values: Mapping[str, Any]) -> _Rests | None:
    """The manifold of rests; None where it is not shown that there is one."""
    about = analysis.reduced.about
    if analysis.constraints.position_rank or about.following:
        return None
    if {*about.dependent_speeds} != {*analysis.constraints.dependent}:  # others need not be regular here
        there = replace(analysis.system, dependent=about.dependent_speeds)
        analysis = type(analysis)(there, (), analysis.terms, suggests=False)
    ring, system, equations = analysis.ring, analysis.system, analysis.equations
    if equations.embedded is None:
        return None
    forces = (*equations.embedded.forcing, *equations.constraints.velocity)
    numbers, place = _at_values(analysis, values)
    found = _Rests(ring, system.coordinates, numbers, place)
    parts = [found.vanishing_part(found.numerator(ring.at_rest(force.polynomial))) for force in forces]
    for x in [x for x in sorted(parts, key=len) if not found.takes(x)]:
        for equation in found.equations:
            x = divmod(x, equation)[1]
        if x != 0:
            return None
    return found


def _change(analysis: Analysis, rests: _Rests) -> Polynomial:
    """What vanishes where tr(M^-1 K) is what it is at the rest, as it is at all rests that are alike."""
    ring, numbers = rests.ring, rests.numbers
    mass = [[ring.substitute(x, numbers) for x in row] for row in analysis.equations.mass_matrix.polynomials]
    forces = [ring.substitute(ring.at_rest(x.polynomial), numbers) for x in analysis.equations.forcing]
    whole = determinant(ring, mass)
    trace = ring.zero
    for k, name in enumerate(rests.names):
        column = [ring.derivative(f, name) for f in forces]
        replaced = [[*row[:k], x, *row[k + 1 :]] for row, x in zip(mass, column, strict=True)]
        trace = ring.reduce(trace + determinant(ring, replaced))
    return rests.numerator(trace * rests.at(whole) - whole * rests.at(trace))
