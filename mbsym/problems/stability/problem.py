"""Problem 6 on a scene: every subsystem of problem 5 is judged, in symbols and at the given values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, partial
from typing import Any

from flint import arb, arb_mat, ctx, fmpq

from mbsym.algebra import rationals
from mbsym.algebra.base import Lowering
from mbsym.algebra.characteristic import Matrix as Polynomials
from mbsym.algebra.elimination import Elimination, eliminate
from mbsym.algebra.evaluate import Carrier, at_rationals
from mbsym.algebra.factors import occurring
from mbsym.algebra.failures import NOT_THERE, Failure
from mbsym.algebra.matrices import added
from mbsym.algebra.point import Balls, Rationals
from mbsym.algebra.ring import ParameterRing, Polynomial, Ring
from mbsym.algebra.signs import MOST_TERMS, Signs
from mbsym.expressions.message import Message
from mbsym.expressions.tree import names
from mbsym.formulas.formula import Column, Formula, Matrix, Shown
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import dependent, relations, turning
from mbsym.mechanics.symmetry import Spin, free_spin
from mbsym.mechanics.variables import expressions
from mbsym.model.system import rational
from mbsym.problems.displacements import Basis, Displacements
from mbsym.problems.displacements import basis as basis_of
from mbsym.problems.dissipation import Balance, EnergyLaw
from mbsym.problems.equilibrium import Equilibrium
from mbsym.problems.linearisation import Linearisation, Reduction, Subsystem, first_symbols
from mbsym.problems.stability import nonholonomic
from mbsym.problems.stability.constant import algebraic_point, in_declared
from mbsym.problems.stability.enclosed import Spectrum, enclosed_verdict_with_cyclic, from_characteristic, from_matrices
from mbsym.problems.stability.exact import on_the_motion, verdict_at, verdict_over
from mbsym.problems.stability.linear_form import LinearSystem, NonholonomicForm, null_rows
from mbsym.problems.stability.requirements import Case, Cell, Lift, Requirement, cells_of, everywhere, joined
from mbsym.problems.stability.symbolic import Theory, analyse, with_given_cases
from mbsym.problems.stability.verdict import Verdict, combine, exactly, undecided
from mbsym.problems.stability.words import Because, Fact, Reason, Word, named

#: Working precision where numbers are irrational, in bits.
PRECISION = 256


@dataclass(frozen=True, repr=False)
class SubsystemStability(Shown):
    """``matrices`` M, D, G, K, N are those of the subsystem times the positive ``factor``, as they were judged.

    ``theory`` holds the characteristic polynomial, conditions, cases and verdict, as polynomials of ``ring`` (that of
    the parameters, where nothing else occurs); the power of lambda is the position in a list of coefficients.
    ``system`` with what is ``known`` is what was judged.
    """

    counted = ("characteristic",)

    coordinates: tuple[str, ...]
    matrices: tuple[Matrix, Matrix, Matrix, Matrix, Matrix]
    factor: Formula
    ring: Ring
    theory: Theory
    system: LinearSystem | None = None
    known: Signs | None = None

    @property
    def characteristic(self) -> tuple[Formula, ...]:
        """Coefficients of the primitive polynomial, from low to high powers of lambda, in the system's ring."""
        zero = (self.ring.zero,) * self.theory.zero_power
        return tuple(self._formula(x) for x in (*zero, *self.theory.polynomial))

    @property
    def conditions(self) -> tuple[tuple[str, Formula, str], ...]:
        """(label, polynomial, relation to 0) of every condition that is not known to hold, in the system's ring.

        Known-positive factors are dropped; one that cannot hold is given as it arose.
        """
        return tuple(self._open(self.theory.requirements))

    @property
    def unreduced(self) -> tuple[tuple[str, Formula, str], ...]:
        """The open conditions as they arise: whole coefficients, minors and discriminants."""
        requirements = [r for r in self.theory.requirements if not r.always and not r.unwritten]
        return tuple((r.label, self._formula(r.polynomial), r.relation) for r in requirements)

    @property
    def sufficient(self) -> tuple[tuple[str, Formula, str], ...]:
        """The same for the conditions that together are sufficient for a stability other than the weakest.

        They are those of the case with a theorem, such as K > 0; empty where the conditions above are all there is.
        """
        certain = [case for case in self.theory.cases if case.verdict.theorem and not case.any_of and not case.never]
        return tuple(
            (
                Message(
                    "[[label]] (sufficient: [[word]], [[theorem]])",
                    label=label,
                    word=case.verdict.word,
                    theorem=named(case.verdict.theorems),
                ),
                formula,
                relation,
            )
            for case in certain[:1]
            if case.all_of is not self.theory.requirements
            for label, formula, relation in self._open(case.all_of)
        )

    @property
    def guaranteed(self) -> tuple[tuple[str, Formula, str], ...]:
        """The same for the conditions that hold because the kinetic energy is positive definite."""
        requirements = [item for item in self.theory.requirements if item.by_mass]
        return tuple((item.label, self._formula(item.polynomial), item.relation) for item in requirements)

    def _open(self, requirements: Sequence[Requirement]) -> Iterator[tuple[str, Formula, str]]:
        for requirement in requirements:
            condition = requirement.condition
            if requirement.always or requirement.unwritten:
                continue
            if condition.kind == "inequality":
                yield requirement.label, self._formula(condition.polynomial), requirement.relation
            elif condition.kind != "nonzero":
                yield requirement.label, self._formula(requirement.polynomial), requirement.relation
            for x in condition.nonzero:
                yield requirement.label, self._formula(x), "!="

    def _formula(self, x: Polynomial) -> Formula:
        return Formula(self.factor.ring, self.in_whole(x))

    def in_whole(self, x: Polynomial) -> Polynomial:
        """A polynomial of ``ring`` in the system's ring."""
        return self.ring.lift(x) if isinstance(self.ring, ParameterRing) else self.factor.ring.reduce(x)

    def cells(self, lift: Lift) -> tuple[Cell, ...]:
        """Its cases as sets of parameters in another ring: one where the verdict does not depend on them."""
        decided = self.theory.verdict.word is not Word.DEPENDS
        found = None if decided else cells_of([case for case in self.theory.cases if not case.never], lift)
        return everywhere(self.theory.verdict) if found is None else found


@dataclass(frozen=True, repr=False)
class Stability(Shown):
    """``verdict`` for the whole system; ``numerical`` the verdict at the description's parameter values, if any.

    ``spectra`` are the eigenvalues there, subsystem by subsystem, where the motion exists.  ``presumed``: what has
    to be zero for the motion to exist; all this presumes it.  ``before_higher_order``: the verdict there that was open,
    where terms of higher order decide it.  ``enclosed``: there enclosures decide, no exact numbers.
    """

    counted = ("subsystems",)

    subsystems: tuple[SubsystemStability, ...]
    verdict: Verdict
    numerical: Verdict | None
    spectra: tuple[Spectrum, ...] = ()
    presumed: Column = ()
    before_higher_order: Verdict | None = None
    enclosed: bool = False


def because(found: Stability, code: Because, *data: object) -> Stability:
    """The same with a reason more in every verdict."""
    reason = Reason(code, data)

    def more(verdict: Verdict) -> Verdict:
        return replace(
            verdict, reasons=tuple(sorted((*verdict.reasons, reason), key=lambda explanation: explanation.rank))
        )

    parts = tuple(
        replace(part, theory=replace(part.theory, verdict=more(part.theory.verdict))) for part in found.subsystems
    )
    numerical = None if found.numerical is None else more(found.numerical)
    return replace(found, subsystems=parts, verdict=more(found.verdict), numerical=numerical)


def with_verdict(found: Stability, verdict: Verdict) -> Stability:
    """The same with another verdict for all parameters, of its one subsystem, too."""
    parts = tuple(replace(part, theory=replace(part.theory, verdict=verdict)) for part in found.subsystems)
    return replace(found, subsystems=parts if len(parts) == 1 else found.subsystems, verdict=verdict)


def with_cases(found: Stability, ring: Ring, signs: Signs, cases: Sequence[Case]) -> Stability:
    """The same with cases for the one subsystem whose verdict is open; their polynomials are of the system's ring."""
    (part,) = found.subsystems
    system = part.system
    if system is None or system.basis is not None:
        return found
    whole = [[[part.in_whole(x) for x in row] for row in matrix] for matrix in system.matrices]
    small, known = in_parameters(ring, [*whole, [[x for case in cases for x in case.polynomials]]], signs)

    def rows(matrix: Polynomials) -> Polynomials:
        return tuple(tuple(carried(part.in_whole(x)) for x in row) for row in matrix)

    def carried(x: Polynomial) -> Polynomial:
        return small.project(x) if isinstance(small, ParameterRing) else x

    m, d, g, stiff, n = map(rows, system.matrices)
    turned, shifts = tuple(rows((system.turned,))[0]), rows(system.shifts)
    there = replace(system, M=m, D=d, G=g, K=stiff, N=n, turned=turned, shifts=shifts)
    theory = with_given_cases(analyse(there, known), [case.carried(carried) for case in cases], known)
    theory = replace(theory, at_point=part.theory.at_point)
    part = replace(part, ring=small, theory=theory, system=there, known=known)
    return replace(found, subsystems=(part,), verdict=theory.verdict)


def stability(
    scene: Scene, balance: Balance, linear: Linearisation, equilibrium: Equilibrium, signs: Signs
) -> Stability:
    """Judges every subsystem.

    ``balance`` knows what the loads without a force function do to the energy and to cyclic momenta in all orders.
    """
    values = parameter_values(scene, equilibrium)
    prepared = prepared_parts(scene, balance, linear, equilibrium, signs)
    judged = tuple(_judge(scene, part, values, balance) for part in prepared)
    numerical = _motion_at(scene, equilibrium, values) or _solved_at(scene, linear, values)
    spectra: tuple[Spectrum, ...] = ()
    enclosed = False
    if numerical is None and values is not None:
        spectra = tuple(x for part in judged if (x := _spectrum(scene, linear, part, values)) is not None)
        there = [
            _at_irrational(scene, linear, part, values, balance, subsystem.theory, equilibrium)
            if subsystem.theory.at_point is None
            else (subsystem.theory.at_point.verdict, False)
            for part, subsystem in zip(prepared, judged, strict=True)
        ]
        enclosed = any(by_enclosures for _, by_enclosures in there)
        numerical = combine((point_verdict for point_verdict, _ in there), balance.at(values).law.bounded)
    verdict = combine((part.theory.verdict for part in judged), balance.law.bounded)
    if verdict.word is Word.DEPENDS and len(judged) > 1:
        verdict = _whole(scene.ring, judged, signs, balance.law.bounded)
    return Stability(judged, verdict, numerical, spectra, tuple(equilibrium.conditions), enclosed=enclosed)


def _whole(ring: Ring, parts: Sequence[SubsystemStability], signs: Signs, one_energy: bool) -> Verdict:
    """The verdict on parts some of which depend on the parameters: their cases are intersected."""
    minors = [(part, r.polynomial) for part in parts for r in part.theory.mass.requirements]
    every = [part.in_whole(x) for part in parts for case in part.theory.cases for x in case.polynomials]
    every += [part.in_whole(x) for part, x in minors]
    small, known = in_parameters(ring, [[every]], signs)

    def lifted(part: SubsystemStability, x: Polynomial) -> Polynomial:
        whole = part.in_whole(x)
        return small.project(whole) if isinstance(small, ParameterRing) else whole

    masses = (lifted(part, x) for part, x in minors if len(x) <= MOST_TERMS)
    known = known.assuming((x, ">") for x in masses if not x.is_constant())
    cells = [part.cells(partial(lifted, part)) for part in parts]
    return joined(cells, known, one_energy)


def _spectrum(
    scene: Scene, linear: Linearisation, part: SubsystemStability, values: Mapping[str, Fraction]
) -> Spectrum | None:
    """The eigenvalues of a subsystem in physical time."""
    point = part.theory.at_point
    if point is not None and point.roots is not None:
        scale = scene.ring.one if linear.time_scale is None else linear.time_scale.polynomial
        return from_characteristic(part.coordinates, point.characteristic, _balls(scene, [[scale]], values)[0][0])
    if point is not None:
        return None
    model = scene.system.linear
    first_order = {*(part.coordinates if model is not None and model.of_first_order else linear.about.following)}
    following = [i for i, name in enumerate(part.coordinates) if name in first_order]
    return from_matrices(part.coordinates, matrices_at(scene, linear, part.coordinates, values), following)


def matrices_at(
    scene: Scene,
    linear: Linearisation,
    coordinates: Sequence[str],
    values: Mapping[str, Fraction],
    basis: Basis | None = None,
) -> list[list[list[Any]]]:
    """The blocks of M, D, G, K, N that belong to some coordinates, or to a basis, as enclosures at parameter values.

    What vanishes identically is exactly 0.
    """
    return [_balls(scene, block, values) for block in blocks_of(scene, linear, coordinates, basis)]


def blocks_of(
    scene: Scene, linear: Linearisation, coordinates: Sequence[str], basis: Basis | None = None
) -> list[list[list[Polynomial]]]:
    """The blocks of M, D, G, K, N that belong to some coordinates, or to a basis."""
    at = [linear.coordinates.index(name) for name in coordinates]
    blocks = [[[matrix.polynomials[i][j] for j in at] for i in at] for matrix in linear.matrices]
    return blocks if basis is None else [basis.congruent(scene.ring, block) for block in blocks]


def _balls(scene: Scene, rows: Sequence[Sequence[Polynomial]], values: Mapping[str, Fraction]) -> list[list[Any]]:
    """Formulas in the parameters as enclosures."""
    numbers = ring_numbers(scene.ring, values)
    with ctx.workprec(PRECISION):
        return [[scene.ring.evaluate(x, numbers) for x in row] for row in rows]


def _at_irrational(
    scene: Scene,
    linear: Linearisation,
    part: Prepared,
    values: Mapping[str, Fraction],
    balance: Balance,
    theory: Theory,
    equilibrium: Equilibrium,
) -> tuple[Verdict, bool]:
    """The verdict on a subsystem at values where its matrices hold irrational numbers (sqrt(3), a sine).

    By enclosures (True); where these leave it open and the numbers are in one field of a low degree, exactly (False).
    """
    verdict = _by_enclosures(scene, linear, part, values, balance, theory)
    if not verdict.word.open or verdict.coordinates_singular:
        return verdict, True
    at = algebraic_point(scene, part.ring, (*part.system.matrices, [part.system.turned]), values, equilibrium)
    if at is None:
        return verdict, True
    try:
        exact = verdict_over(part.at(balance.at(values)), at).verdict
    except Failure:
        return verdict, True
    return exact, False


def _by_enclosures(
    scene: Scene,
    linear: Linearisation,
    part: Prepared,
    values: Mapping[str, Fraction],
    balance: Balance,
    theory: Theory,
) -> Verdict:
    there = balance.at(values)
    system = part.at(there)
    cyclic = () if system.driven else part.system.cyclic
    matrices = matrices_at(scene, linear, part.coordinates, values, part.system.basis)
    if part.system.nonholonomic is not None:
        even = theory.variable == "lambda^2"
        form, power, exact = part.system.nonholonomic, theory.zero_power, there.exactly_linear
        verdict = nonholonomic.enclosed(form, matrices, power, PRECISION, even, exact)
        verdict = exactly(verdict) if exact else verdict
    else:
        verdict = enclosed_verdict_with_cyclic(matrices, there.law.bounded, cyclic, PRECISION, there.exactly_linear)
    return on_the_motion(system, verdict, theory.zero_power)


def _judge(scene: Scene, made: Prepared, values: Mapping[str, Fraction] | None, balance: Balance) -> SubsystemStability:
    point = None if values is None else _point(scene, made.ring, made.system.matrices, values)
    theory = analyse(made.system, made.known)
    if values is not None and point is not None:
        theory = replace(theory, at_point=verdict_at(made.at(balance.at(values)), point))
    return SubsystemStability(made.coordinates, made.matrices, made.factor, made.ring, theory, made.system, made.known)


@dataclass(frozen=True)
class Prepared:
    """A subsystem ready to be judged: matrices times ``factor``, and as polynomials of ``ring`` in ``system``.

    ``drifts``: a drift along directions on which nothing depends is told apart, as that of cyclic coordinates is.
    """

    coordinates: tuple[str, ...]
    matrices: tuple[Matrix, Matrix, Matrix, Matrix, Matrix]
    factor: Formula
    ring: Ring
    known: Signs
    system: LinearSystem
    drifts: bool = True

    @cached_property
    def _shifts(self) -> Polynomials:
        rows = added(self.system.K, self.system.N)
        return null_rows(rows, self.known.normalised) if self.drifts else ()

    def exactly(self, exact: bool) -> LinearSystem:
        """The system, as one without terms of higher order if ``exact``."""
        return replace(self.system, exact=exact, shifts=self._shifts if exact else (), free=self.drifts)

    @cached_property
    def theory(self) -> Theory:
        """What is known in symbols: the power of lambda that the determinant has for a factor, and its parity."""
        return analyse(self.system, self.known)

    def at(self, there: Balance) -> LinearSystem:
        """The system with what is known of energy and momenta at parameter values."""
        driven = self.system.driven
        if self.system.basis is None:
            driven = tuple(i for i in self.system.cyclic if self.coordinates[i] in there.driven)
        return replace(
            self.exactly(there.exactly_linear),
            conservative=there.law.bounded,
            of_one=of_one_energy(there),
            driven=driven,
        )


def of_one_energy(balance: Balance) -> frozenset[Fact]:
    """What the energy of a system of one coordinate does near a rest; nothing of others, or where it is not known."""
    scene = balance.scene
    if len(scene.system.coordinates) != 1 or scene.system.constraints or scene.system.speeds or turning(scene):
        return frozenset()
    if balance.law.bounded:
        shown = {Fact.ONE_COORDINATE, Fact.ENERGY_NEVER_GROWS}
    elif balance.law is EnergyLaw.GROWS:
        shown = {Fact.ONE_COORDINATE, Fact.ENERGY_NEVER_FALLS}
    else:
        return frozenset()
    return frozenset(shown | ({Fact.ENERGY_VARIES} if balance.varies else set()))


def prepared_parts(
    scene: Scene, balance: Balance, linear: Linearisation, equilibrium: Equilibrium, signs: Signs
) -> tuple[Prepared, ...]:
    """Every subsystem, ready to be judged."""
    elimination = elimination_of(scene)
    spin = None if scene.system.constraints else free_spin(scene.system, still=True)
    about = linear.about
    prepared = tuple(
        _prepared(
            scene,
            part,
            elimination,
            signs,
            balance,
            _turned(scene, part, spin, equilibrium),
            equilibrium,
            about.holonomic,
        )
        for part in linear.subsystems
    )
    if scene.system.linear is not None and scene.system.linear.of_first_order:
        # x' = A x: judged by its roots alone, as nonholonomic systems are.
        return tuple(
            replace(
                part,
                system=replace(
                    part.system, cyclic=(), nonholonomic=NonholonomicForm(following=tuple(range(part.system.size)))
                ),
            )
            for part in prepared
        )
    if about.holonomic:
        return tuple(replace(part, system=replace(part.system, leaf=about.leaf)) for part in prepared)
    from mbsym.problems.constrained_balance import ConstrainedBalance  # most systems have no constraints

    free = equilibrium.satisfied
    inside = {name for part in prepared for name in part.coordinates}
    uneven = isinstance(balance, ConstrainedBalance) and balance.uneven
    outside = uneven and not inside.issuperset(about.idle)
    steady = [_steady_directions(part, about.idle) for part in prepared]
    known = free and isinstance(balance, ConstrainedBalance) and sum(steady) == balance.steady
    if isinstance(balance, ConstrainedBalance) and (uneven or balance.oscillating not in inside):
        balance = replace(balance, oscillating="")  # what drops out of the first approximation is no centre
    forms = (
        _form(part, balance, about, signs, free, outside, at_least=directions if known else 0)
        for part, directions in zip(prepared, steady, strict=True)
    )
    return tuple(
        replace(part, system=replace(part.system, cyclic=(), nonholonomic=form))
        for part, form in zip(prepared, forms, strict=True)
    )


def _form(
    part: Prepared, balance: Balance, about: Reduction, signs: Signs, free: bool, outside: bool, at_least: int
) -> NonholonomicForm:
    """What is known of a subsystem of a nonholonomic system besides its matrices.

    ``free``: the motion exists for all parameters, so that those which stand in it alone make a family of motions; its
    dimension is ``at_least`` that.
    """
    from mbsym.problems.constrained_balance import ConstrainedBalance
    from mbsym.problems.reduction import dimension

    assert isinstance(balance, ConstrainedBalance)
    at = [about.about.index(name) for name in part.coordinates]
    idle = tuple(i for i, name in enumerate(part.coordinates) if name in about.idle)
    family = max(at_least, dimension(about, at, signs) if free else 0)
    oscillating = balance.oscillating
    return NonholonomicForm(
        idle=idle,
        family=family,
        drifts=bool(about.idle),
        open_names=() if balance.closed else about.idle,
        outside=outside,
        following=tuple(i for i, name in enumerate(part.coordinates) if name in about.following),
        pairs=int(oscillating in part.coordinates) if oscillating else None,
    )


def _steady_directions(part: Prepared, idle: Sequence[str]) -> int:
    """The dimension of the null space of the steady part, (K + N) x + (D + G) v = 0, in places x and idle rates v."""
    turned = {i for i, name in enumerate(part.coordinates) if name in idle}
    places, rates = added(part.system.K, part.system.N), added(part.system.D, part.system.G)
    rows = [
        tuple(moving if j in turned else resting for j, (resting, moving) in enumerate(zip(*pair, strict=True)))
        for pair in zip(places, rates, strict=True)
    ]
    return len(null_rows(tuple(rows), part.known.normalised))


def _prepared(
    scene: Scene,
    part: Subsystem,
    elimination: Elimination,
    signs: Signs,
    balance: Balance,
    turned: Sequence[Polynomial],
    equilibrium: Equilibrium,
    lagrangian: bool,
) -> Prepared:
    matrices, factor = _polynomial(scene, part, elimination, signs)
    rows = [[list(row) for row in matrix.polynomials] for matrix in matrices]
    cyclic = tuple(
        i
        for i, name in enumerate(part.coordinates)
        if name in balance.ignorable and all(x.is_zero() for matrix in (rows[3], rows[4]) for x in matrix[i])
    )
    driven = tuple(i for i in cyclic if part.coordinates[i] in balance.driven)
    names, basis = part.coordinates, None
    turns = bool(turned) and not all(
        x.is_zero() for matrix in (part.D, part.N) for row in matrix.polynomials for x in row
    )
    hidden = _displaced(scene, part, balance, signs, cyclic, equilibrium, turns) if lagrangian else None
    if hidden is not None:
        displacements, basis = hidden
        inner = basis.through(scene.ring, elimination)
        changed = [inner.congruent(scene.ring, matrix) for matrix in rows]
        count = len(displacements.directions)
        if all(x.is_zero() for matrix in changed[3:] for row in matrix[:count] for x in row):
            rows, cyclic, driven, names = changed, tuple(range(count)), displacements.driven, basis.names
        else:
            basis = None
    turned = [elimination(x) for x in turned]
    ring, known = in_parameters(scene.ring, [*rows, [turned]], signs)
    if isinstance(ring, ParameterRing):
        rows = [[[ring.project(x) for x in row] for row in matrix] for matrix in rows]
        turned = [ring.project(x) for x in turned]
    mass, damping, gyroscopic, stiffness, circulatory = (tuple(map(tuple, matrix)) for matrix in rows)
    bounded = balance.law.bounded
    system = LinearSystem(
        mass, damping, gyroscopic, stiffness, circulatory, bounded, cyclic, tuple(turned), driven, names, basis=basis
    )
    system = replace(system, of_one=of_one_energy(balance))
    made = Prepared(part.coordinates, matrices, factor, ring, known, system, scene.system.linear is None)
    return replace(made, system=made.exactly(balance.exactly_linear))


def _displaced(
    scene: Scene,
    part: Subsystem,
    balance: Balance,
    signs: Signs,
    cyclic: Sequence[int],
    equilibrium: Equilibrium,
    turned: bool,
) -> tuple[Displacements, Basis] | None:
    """Displacements that change no equation, and coordinates made of them; None where cyclic coordinates are all.

    They are looked for where K + N is singular besides the cyclic coordinates, or forces act on several of these; those
    that vary with the position where the others do not explain all zero roots, nor does a damped spin, ``turned``.
    """
    others = [i for i in range(len(part.coordinates)) if i not in cyclic]
    stiff = [[part.K.polynomials[i][j] + part.N.polynomials[i][j] for j in others] for i in others]
    acting = [(part.D, part.N)[k].polynomials[i] for i in cyclic for k in (0, 1)]
    free = sum(all(x.is_zero() for x in (*d, *n)) for d, n in zip(acting[::2], acting[1::2], strict=True))
    whole = len(cyclic) < 2 or free == len(cyclic)
    if scene.system.linear is not None or (whole and _somewhere_regular(scene, stiff)):
        return None
    images = equilibrium.determined(scene)
    every = [
        [x + y for x, y in zip(*rows, strict=True)] for rows in zip(part.K.polynomials, part.N.polynomials, strict=True)
    ]
    best: tuple[Displacements, Basis] | None = None
    most = (len(cyclic), free)
    for looked_for in (balance.displacements, *(() if turned else (balance.symmetries,))):
        displacements = looked_for(part.coordinates)
        chosen = (
            basis_of(scene.ring, displacements, signs)
            if (len(displacements.directions), displacements.constant) > most
            else None
        )
        if chosen is None:
            continue
        best = displacements, chosen.through(scene.ring, lambda x: scene.ring.substitute(x, images))
        most, count = (len(displacements.directions), displacements.constant), len(displacements.directions)
        left = [row[count:] for row in best[1].congruent(scene.ring, every)[count:]]
        if _somewhere_regular(scene, left):
            break
    return best


def _somewhere_regular(scene: Scene, rows: Sequence[Sequence[Polynomial]]) -> bool:
    """Whether a matrix is shown to be regular for some parameters: at numbers of no meaning."""
    numbers = {name: arb(fmpq(101 + 37 * k, 89 + 14 * k)) for k, name in enumerate(scene.ring.names())}
    with ctx.workprec(PRECISION):
        try:
            entries = [scene.ring.evaluate(x, numbers) for row in rows for x in row]
            determinant = arb_mat(len(rows), len(rows), entries).det()
        except Failure:
            return False
        return bool(determinant.is_finite() and not determinant.contains(0))


class ExactVerdicts:
    """The verdict at any exact parameter values; what does not depend on them is made once."""

    def __init__(
        self, scene: Scene, balance: Balance, linear: Linearisation, equilibrium: Equilibrium, signs: Signs
    ) -> None:
        self.scene, self.equilibrium, self.linear = scene, equilibrium, linear
        self.balance = balance
        self._parts = prepared_parts(scene, balance, linear, equilibrium, signs)

    def __call__(self, values: Mapping[str, Fraction]) -> Verdict:
        """Right, or "undecided" with the reason."""
        numbers = Rationals({}, {})
        carry = Carrier(self.scene.ring, numbers, {name: numbers.number(value) for name, value in values.items()})
        for name, formula in self.equilibrium.solved:
            try:
                fits = bool(carry(formula.polynomial) == numbers.number(values[name]))
            except Failure:
                fits = False
            if not fits:
                return undecided(Because.NOT_THE_VALUE, name)
        elsewhere = _motion_at(self.scene, self.equilibrium, values) or _solved_at(self.scene, self.linear, values)
        if elsewhere is not None:
            return elsewhere
        there, verdicts = self.balance.at(values), []
        for part in self._parts:
            point = _point(self.scene, part.ring, part.system.matrices, values)
            if point is None:  # a number there is irrational
                verdict, _ = _at_irrational(
                    self.scene, self.linear, part, values, self.balance, part.theory, self.equilibrium
                )
                verdicts.append(verdict)
            else:
                verdicts.append(verdict_at(part.at(there), point).verdict)
        return combine(verdicts, there.law.bounded)


def _turned(
    scene: Scene, part: Subsystem, spin: Spin | None, equilibrium: Equilibrium
) -> tuple[Polynomial, Polynomial] | tuple[()]:
    """(p, q): p lambda^2 + q divides the determinant of the part that holds the tilts of a free steady spin."""
    if spin is None or not {*spin.tilts} <= {*part.coordinates}:
        return ()
    ring = scene.ring
    images = equilibrium.determined(scene)
    rate = ring.substitute(scene.lower(spin.rate), images)
    scale = scene.system.time_scale
    unit = ring.one if scale is None else ring.substitute(scene.lower(scale), images)
    ratio = ring.reduce(rate * ring.reciprocal(unit))
    top, bottom = ring.fraction(ring.reduce(ratio * ratio))
    below = ring.one
    for factor, exponent in bottom:
        below = ring.times(below, factor**exponent)
    return below, top


def in_parameters(ring: Ring, rows: Sequence[Sequence[Sequence[Polynomial]]], signs: Signs) -> tuple[Ring, Signs]:
    """The ring of the parameters that matter, with what is known about them; the ring itself if it takes more."""
    used = set(occurring(x for matrix in rows for row in matrix for x in row))
    for assumption, _ in signs.assumptions:
        used |= {k for k in occurring([assumption]) if ring.generators[k].kind == "parameter"}
    if any(ring.generators[k].kind != "parameter" for k in used):
        return ring, replace(signs, normal=ring.reduce)
    small = ParameterRing(ring, sorted(used))
    assumptions = [
        (small.project(assumption), relation)
        for assumption, relation in signs.assumptions
        if used.issuperset(occurring([assumption]))
    ]
    numbers = {at: signs.numbers[k] for at, k in enumerate(small.indices) if k in signs.numbers}
    return small, Signs(
        small.context, tuple(signs.words[k] for k in small.indices), tuple(assumptions), numbers=numbers
    )


def elimination_of(scene: Scene) -> Elimination:
    """The user's second symbols (alpha = (c - b)/a) in place of the first ones (a, b, c)."""
    ring, images = scene.ring, relations(scene)
    first = [index for index, _ in first_symbols(scene)]
    second = []
    for item in scene.system.notation:
        index = ring.index("parameter", item.name)
        if index not in first:
            second.append((index, ring.substitute(scene.lower(item.value), images)))
    return eliminate(ring, second, first)


def _polynomial(
    scene: Scene, part: Subsystem, elimination: Elimination, signs: Signs
) -> tuple[tuple[Matrix, Matrix, Matrix, Matrix, Matrix], Formula]:
    """The matrices in the user's symbols, times a positive factor that clears denominators and common factors."""
    ring = scene.ring
    eliminated = [
        [[elimination(x) for x in row] for row in m.polynomials] for m in (part.M, part.D, part.G, part.K, part.N)
    ]
    factor = ring.one
    powers: list[tuple[Polynomial, int]] = []
    for x in (x for matrix in eliminated for row in matrix for x in row):
        for bottom, exponent in ring.fraction(ring.reduce(ring.times(x, factor)))[1]:
            powers.append((bottom, exponent))
            factor = ring.reduce(ring.times(factor, ring.power(bottom, exponent)))
    if signs.sign(factor) != "positive":
        factor = _even(ring, signs, factor, powers)
    scaled = [[[ring.fraction(ring.reduce(ring.times(x, factor)))[0] for x in row] for row in m] for m in eliminated]
    common = ring.zero
    for x in (x for matrix in scaled for row in matrix for x in row):
        common = ring.common_factor(common, x)
    if not common.is_zero() and not common.is_constant() and signs.sign(common) == "positive":
        scaled = [[[divmod(x, common)[0] for x in row] for row in matrix] for matrix in scaled]
        factor = ring.ratio(factor, common)
    made = [Matrix.of(ring, matrix) for matrix in scaled]
    return (made[0], made[1], made[2], made[3], made[4]), Formula(ring, factor)


def _even(ring: Ring, signs: Signs, factor: Polynomial, powers: Sequence[tuple[Polynomial, int]]) -> Polynomial:
    """``factor``, the product of the powers, times every one of odd exponent whose sign is open.

    What is left is a product of squares, positive wherever the formulas make sense.
    """
    for k, (bottom, _) in enumerate(powers):
        same = [j for j, (other, _) in enumerate(powers) if other == bottom]
        if same[0] == k and sum(powers[j][1] for j in same) % 2 and signs.sign(bottom) != "positive":
            factor = ring.reduce(ring.times(factor, bottom))
    return factor


def parameter_values(scene: Scene, equilibrium: Equilibrium) -> dict[str, Any] | None:
    """Values of all parameters: given ones, then relations, then what the conditions of problem 4 leave open.

    Rational numbers exactly, irrational ones as enclosures.  None unless all are known that any formula holds.
    """
    with ctx.workprec(PRECISION):
        return _parameter_values(scene, equilibrium)


def _parameter_values(scene: Scene, equilibrium: Equilibrium) -> dict[str, Any] | None:
    values: dict[str, Any] = {}
    constants = {"pi": arb.pi()}
    for parameter in scene.system.parameters:
        if parameter.value is not None:
            value = rational(parameter.value)
            values[parameter.name] = Lowering(Balls(constants), constants)(parameter.value) if value is None else value
    solved = {name: value.polynomial for name, value in equilibrium.solved if name not in values}
    for name, polynomial in (solved | dependent(scene, relations(scene))).items():
        try:
            values[name] = _value_of(scene, polynomial, values)
        except Failure:
            return None
    used = {name for x in expressions(scene.system) for name in names(x)}
    known = all(p.name in values for p in scene.system.parameters if p.name in used)
    finite = all(isinstance(x, Fraction) or x.is_finite() for x in values.values())
    return values if known and finite else None


def _value_of(scene: Scene, x: Polynomial, values: Mapping[str, Any]) -> Any:
    """A formula in parameters, exactly where it is rational, else enclosed.  Raises Failure where one has no value."""
    try:
        return rationals.fraction(at_rationals(scene.ring, values)(x))
    except Failure:
        balls = {"pi": arb.pi()} | {name: arb(_number(value)) for name, value in values.items()}
        return Carrier(scene.ring, Balls(balls), balls)(x)


def _number(value: Any) -> Any:
    """A rational number as it is, to be rounded at the precision in which it is used; an enclosure as it is."""
    return rationals.exact(value) if isinstance(value, Fraction) else value


def ring_numbers(ring: Ring, values: Mapping[str, Any]) -> dict[str, Any]:
    """Values of all names of the ring: those of the parameters, 0 for the others, which do not occur."""
    return dict.fromkeys(ring.names(), fmpq(0)) | {name: _number(value) for name, value in values.items()}


def _motion_at(scene: Scene, equilibrium: Equilibrium, values: Mapping[str, Any] | None) -> Verdict | None:
    """ "undecided", with the reason, where the given values break a condition of problem 4; None where they do not."""
    if values is None:
        return None
    numbers = ring_numbers(scene.ring, values)
    for condition in equilibrium.conditions:
        value = scene.ring.evaluate(condition.polynomial, numbers)
        if not value.contains(0):
            size = float(value.mid())
            return undecided(Because.MOTION_NOT_THERE, condition, f"{size:.6g}")
        if not value.is_zero():
            at = algebraic_point(scene, scene.ring, [[[condition.polynomial]]], values, equilibrium)
            if at is None or at.settled(condition.polynomial) != 0:
                return undecided(Because.MOTION_OPEN, condition)
    return None


def _solved_at(scene: Scene, linear: Linearisation, values: Mapping[str, Any] | None) -> Verdict | None:
    """ "undecided" where the given values are not shown to keep what was divided by when constraints were expanded."""
    if values is None:
        return None
    numbers = ring_numbers(scene.ring, values)
    for assumed in linear.about.assumed:
        if scene.ring.evaluate(assumed.polynomial, numbers).contains(0):
            return undecided(
                Because.NO_EQUATIONS,
                Message(
                    "Other quantities are dependent there: [[assumed]] is not known to differ from 0.", assumed=assumed
                ),
            )
    return None


def _point(
    scene: Scene, ring: Ring, rows: Sequence[Sequence[Sequence[Polynomial]]], values: Mapping[str, Any]
) -> dict[int, Fraction] | None:
    """Exact values of the generators that occur in the matrices; None if one of them is irrational."""
    carry = at_rationals(scene.ring, values)
    used = occurring(x for matrix in rows for row in matrix for x in row)
    try:
        return {index: rationals.fraction(carry(in_declared(scene, ring, index)[1])) for index in used}
    except NOT_THERE:
        return None
