"""One formula of a system by its name, for the screen or for another program (``mbsym show``)."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from typing import TYPE_CHECKING, Any, cast

from mbsym.algebra.factors import content, irreducible_factors, rational_ratio
from mbsym.algebra.failures import Failure, NoClosedForm
from mbsym.algebra.matrices import added, components, cramer, determinant
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message, joined, worded
from mbsym.expressions.rates import ENDINGS, acceleration_name, without_velocity
from mbsym.formulas.formula import Column, Formula, Matrix, column
from mbsym.formulas.latex import latex_symbol
from mbsym.formulas.wolfram import wolfram_name
from mbsym.mechanics.energy import body_energy
from mbsym.model.loads import Load, NewtonianGravity, UniformGravity
from mbsym.model.system import INERTIAL, System
from mbsym.problems.constraints.motion import dependent_velocities
from mbsym.problems.stability.enclosed import RootNumbers, numbers
from mbsym.problems.stability.words import Word
from mbsym.report.conditions import (
    HELD,
    CaseStatement,
    Shown,
    Statement,
    as_stood,
    is_letter,
    statements,
    stood_by_name,
    told_cases,
)
from mbsym.report.content import Number, Symbol
from mbsym.report.sections.equations import balances, is_short
from mbsym.report.sections.stability import label_of

if TYPE_CHECKING:
    from mbsym.algebra.signs import Signs
    from mbsym.analysis import Analysis
    from mbsym.analysis.reducing import Reduced
    from mbsym.analysis.scaled import Formulas
    from mbsym.problems.in_speeds import SpeedEquations
    from mbsym.problems.stability.problem import SubsystemStability
    from mbsym.problems.stability.verdict import Verdict

#: The languages in which a formula is written; the first is for people.
LANGUAGES = ("text", "latex", "wolfram", "python")

#: Wider matrices and columns are written entry by entry for people.
WIDEST = 80

#: Shorter words do not begin longer ones for a reason.
SHORTEST = 3

#: Accelerations of more coordinates that the mass matrix couples are left to programs: their formulas fill pages.
MOST_SOLVED = 4


@dataclass(frozen=True)
class InPowers:
    """``factor`` times a polynomial in lambda: its coefficients, from the constant one on."""

    factor: Formula
    coefficients: tuple[Formula, ...]


@dataclass(frozen=True)
class Determinant:
    """The determinant of these rows."""

    rows: tuple[tuple[InPowers, ...], ...]


@dataclass(frozen=True)
class InSmall:
    """A sum of coefficients times powers of a small parameter."""

    terms: tuple[tuple[Formula, Formula], ...]


Value = Formula | Matrix | Column | Determinant | InSmall | tuple[RootNumbers, ...] | str


@dataclass(frozen=True)
class Line:
    """``name = value``, or ``value relation 0`` where it has no name; ``remark`` says in words what it is of.

    The name is a letter of ours, or a formula of one letter that moves.  ``right`` stands in place of 0: the sum of
    coefficients times multipliers, by their names.  A value in words is a remark in other languages.
    """

    name: str | Formula
    value: Value
    relation: str = "="
    remark: str = ""
    right: tuple[tuple[Formula, str], ...] = ()


def _lagrangian(analysis: Analysis) -> Iterator[Line]:
    yield Line("L", analysis.energy.kinetic_energy + analysis.energy.force_function)


def _equations(analysis: Analysis) -> Iterator[Line]:
    """M q'' - f = 0; under constraints M q'' - f = J^T lambda, and the constraints."""
    if analysis.system.linear is not None:
        yield from (Line("", x) for x in analysis.linearisation.equalities)
        return
    equations = analysis.equations
    for x, forces in balances(equations, analysis.system):
        yield Line("", x, right=tuple((factor, f"lambda{k}") for factor, k in forces))
    if equations.in_speeds:
        own = cast("SpeedEquations", equations)
        yield from (Line(Formula(x.ring, x.ring.generator("velocity", name)), x) for name, x in own.kinematic)
    if equations.constraints.names:
        yield from _constraints(analysis)


def _coriolis(analysis: Analysis) -> Iterator[Line]:
    """c, what inertia needs at q'' = 0; C(q, q') q' where nothing moves as prescribed."""
    forcing = _with_loads(analysis, ()).equations.forcing
    yield Line("coriolis", tuple(-x for x in forcing))


def _gravity(analysis: Analysis) -> Iterator[Line]:
    """g = -dU/dq, in speeds -d(U')/du, U of the fields of gravity alone."""
    fields = tuple(load for load in analysis.system.loads if isinstance(load, UniformGravity | NewtonianGravity))
    within = _with_loads(analysis, fields)
    ring, potential, form = within.ring, within.energy.force_function.polynomial, within.form
    if analysis.system.speeds:
        rate = ring.reduce(
            ring.dot([ring.derivative(potential, name) for name in form.rates], list(form.rates.values()))
        )
        slopes = [rate.derivative(u.index) for u in form.speeds]
    else:
        slopes = [ring.derivative(potential, name) for name in analysis.system.coordinates]
    yield Line("gravity", column(ring, [ring.reduce(-x) for x in slopes]))


def _with_loads(analysis: Analysis, loads: tuple[Load, ...]) -> Analysis:
    if analysis.system.linear is not None:
        raise NoClosedForm("a system that is given by its matrices has no bodies")
    return type(analysis)(replace(analysis.system, loads=loads), terms=analysis.terms)


def _constraints(analysis: Analysis) -> Iterator[Line]:
    """The constraints in velocities, row by row."""
    tied = analysis.equations.constraints
    if not tied.names:
        raise NoClosedForm("the system has no constraints")
    for name, value in zip(tied.names, tied.velocity, strict=True):
        text = "constraint [[number]] ([[kind]])"
        gaps = {"number": name.constraint + 1, "kind": name.kind}
        if name.component:
            text = "constraint [[number]] ([[kind]], component [[component]])"
            gaps["component"] = name.component
        yield Line("", value, remark=Message(text, **gaps))


def accelerations(analysis: Analysis) -> Column:
    """q'' = M^-1 f by Cramer's rule; under constraints q'' = Y u' + a0 of the equations without multipliers.

    There dependent velocities are expressed by the independent u.  Raises NoClosedForm where these equations have none,
    and for more than ``MOST_SOLVED`` rows.
    """
    short, solved = analysis.equations.embedded, analysis.equations.constraints.solved
    if short is None or solved is None:
        raise NoClosedForm(
            "without multipliers the equations are longer than the budget of terms (--terms); 'equations' has them "
            "with multipliers, and model.py computes accelerations"
        )
    ring = analysis.ring
    rows = [[x.polynomial for x in row] for row in short.mass_matrix]
    blocks = components(len(rows), lambda i, j: not (ring.vanishes(rows[i][j]) and ring.vanishes(rows[j][i])))
    count = max(map(len, blocks), default=0)
    if count > MOST_SOLVED:
        text = "accelerations of so many coordinates ([[count]]) fill pages; model.py computes them"
        raise NoClosedForm(text, count=count)
    rates = [ring.zero] * len(rows)
    for block in blocks:
        own = [[rows[i][j] for j in block] for i in block]
        inverse = ring.reciprocal(determinant(ring, own))
        for i, top in zip(block, cramer(ring, own, [short.forcing[i].polynomial for i in block]), strict=True):
            rates[i] = ring.reduce(ring.times(top, inverse))
    images = dependent_velocities(analysis.form, solved)
    shifts = [ring.reduce(ring.substitute(x.polynomial, images)) for x in solved.acceleration_shift]
    lines = zip(solved.transformation.polynomials, shifts, strict=True)
    return column(ring, [ring.reduce(ring.dot(line, rates) + shift) for line, shift in lines])


def _accelerations(analysis: Analysis) -> Iterator[Line]:
    found, tied = accelerations(analysis), analysis.equations.constraints
    remark = ""
    if tied.names:
        text = "without multipliers, dependent velocities expressed by the independent ones: [[names]]"
        remark = Message(text, names=", ".join(tied.free) or "-")
    for rate, x in zip(_rates(analysis), found, strict=True):
        yield Line(_moving(x.ring, rate), x, remark=remark)
        remark = ""
    if tied.solved is not None and not tied.solved.regular_everywhere:
        yield Line("", tied.solved.regular_where, "!=", Message("regular where"))


def _rates(analysis: Analysis) -> tuple[str, ...]:
    """The accelerations by name, in the order of the rows."""
    speeds = getattr(analysis.equations, "speed_rates", ())
    return tuple(speeds or map(acceleration_name, analysis.system.coordinates))


def _moving(ring: Ring, rate: str) -> Formula:
    """The rate that goes by a name: ``theta_ddot``, ``p_dot``."""
    kind, end = next((kind, end) for kind, end in reversed(ENDINGS.items()) if rate.endswith(end))
    return Formula(ring, ring.generator(kind, rate.removesuffix(end)))


def _motion(analysis: Analysis) -> Iterator[Line]:
    rest = analysis.equilibrium
    if rest.satisfied:
        yield Line("", Message("the unperturbed motion satisfies the equations of motion identically"))
    yield from (Line("", x, "!=" if rest.impossible else "=") for x in rest.impossible or rest.conditions)


def _matrix(name: str) -> Callable[[Analysis], Iterator[Line]]:
    def lines(analysis: Analysis) -> Iterator[Line]:
        value = getattr(analysis.linearisation, name)
        if value is None:
            raise NoClosedForm("the system has no inputs")
        inputs = ", ".join(analysis.system.input_names)
        text = "M q'' + (D + G) q' + (K + N) q = B v of v = ([[inputs]])"
        yield Line(name, value, remark=Message(text, inputs=inputs) if name == "B" else "")

    return lines


def _state_space(analysis: Analysis) -> Iterator[Line]:
    """A of x' = A x; with inputs v or outputs y also B, C, D of x' = A x + B v, y = C x + D v, all deviations.

    In speeds and positions where there is such a form, else in coordinates and velocities.
    """
    state = analysis.optional("first_order") if analysis.system.speeds else None
    if state is not None:
        yield Line("A", state.A, remark=Message("x' = A x of x = ([[states]])", states=", ".join(state.names)))
        return
    form = analysis.state_space
    yield Line("A", form.A, remark=Message("x' = A x of x = ([[states]])", states=", ".join(form.states)))
    if form.inputs:
        yield Line("B", form.B, remark=Message("x' = A x + B v of v = ([[inputs]])", inputs=", ".join(form.inputs)))
    if form.outputs:
        yield Line("C", form.C, remark=Message("C x + D v are ([[outputs]])", outputs=", ".join(form.outputs)))
    if form.inputs and form.outputs:
        yield Line("D", form.D)


def beside_state_space(names: Sequence[str], system: System) -> list[str]:
    """The names to print: beside A, B, C and D are those of its x' = A x + B v, y = C x + D v, and told with it."""
    with_it = {"B": bool(system.inputs), "C": bool(system.outputs), "D": bool(system.inputs and system.outputs)}
    return [x for x in names if "A" not in names or system.speeds or not with_it.get(x)]


def _characteristic(analysis: Analysis) -> Iterator[Line]:
    for part in analysis.stability.subsystems:
        text = "of [[names]]: coefficients of the powers of lambda, from the constant one on"
        yield Line("", tuple(part.characteristic), "", Message(text, names=", ".join(part.coordinates)))


def _determinants(analysis: Analysis) -> Iterator[Line]:
    """|lambda^2 M + lambda (D + G) + K + N|, its rows freed of factors that are positive."""
    for k, part in enumerate(analysis.stability.subsystems, start=1):
        if part.system is None or part.known is None:
            raise NoClosedForm("the characteristic polynomials of this system come from no matrices")
        matrices = part.system
        powers = (added(matrices.K, matrices.N), added(matrices.D, matrices.G), matrices.M)
        rows = (_freed(part.ring, part.known, zip(*(m[i] for m in powers), strict=True)) for i in range(matrices.size))
        entries = tuple(tuple(_in_factors(part, entry) for entry in row) for row in rows)
        remark = Message("of [[names]], up to a positive factor", names=", ".join(matrices.names))
        yield Line(f"Lambda{k}", Determinant(entries), remark=remark)


def _in_factors(part: SubsystemStability, entry: Sequence[Polynomial]) -> InPowers:
    """A polynomial in lambda, with what all its coefficients have in common taken out."""
    there = [x for x in entry if not x.is_zero()]
    common = part.ring.one if len(there) < 2 else reduce(lambda x, y: x.gcd(y), there)
    common = common if len(there) < 2 or content(there[-1]) > 0 else -common
    shared = [part.ring.quotient(x, common) for x in entry]
    whole = part.factor.ring
    first, *rest = (Formula(whole, part.in_whole(cast("Polynomial", x))) for x in (common, *shared))
    return InPowers(first, tuple(rest))


def _freed(ring: Ring, known: Signs, row: Iterable[tuple[Polynomial, ...]]) -> list[list[Polynomial]]:
    """A row of the determinant without those of its common factors that are known to be positive."""
    entries = [list(entry) for entry in row]
    there = [x for entry in entries for x in entry if not x.is_zero()]
    if not there:
        return entries
    for factor, exponent in irreducible_factors(reduce(lambda x, y: x.gcd(y), there))[1]:
        sign = known.sign(factor)
        if sign in {"positive", "negative"}:
            divisor = (factor if sign == "positive" else -factor) ** exponent
            entries = [[cast("Polynomial", ring.quotient(x, divisor)) for x in entry] for entry in entries]
    number = reduce(lambda x, y: x.gcd(y), (content(x) for entry in entries for x in entry if not x.is_zero()))
    return [[x / abs(number) for x in entry] for entry in entries]


def _conditions(analysis: Analysis) -> Iterator[Line]:
    """What verdicts presume; of each subsystem its verdict, or its cases; then the conditions that these name."""
    if analysis.system.inputs:
        yield Line("", HELD)
    own, stability = analysis.equilibrium.conditions, analysis.stability
    further = (x for x in stability.presumed if all(rational_ratio(x.polynomial, y.polynomial) is None for y in own))
    for x in (*own, *further):
        yield Line("", x, remark=Message("provided that"))
    if len(stability.subsystems) > 1 and stability.verdict.word is not Word.DEPENDS:
        yield Line("", _verdict(stability.verdict), "", Message("the whole system"))
    for part in stability.subsystems:
        of, verdict, told = ", ".join(part.coordinates), part.theory.verdict, told_cases(part)
        items = list(statements(part.ring, part.theory.requirements))
        listed = [item.whole for item in items if item.formula is not None]
        lines = [] if told and verdict.word in (Word.DEPENDS, Word.UNDECIDED) else [Line("", _verdict(verdict))]
        seen: list[_Stood] = []
        for k, case in enumerate(told):
            lines += _of_case(case, bool(k), listed, seen)
        yield from (replace(line, remark=line.remark if k else of) for k, line in enumerate(lines))
        if not (told or verdict.word.stable or verdict.word is Word.UNSTABLE):
            text = "conditions: [[wanted]]"
            if not items:
                text = "conditions: [[wanted]]; none was found"
            if not items and part.theory.requirements:
                text = "conditions: [[wanted]]; none is left that might fail"
            yield Line("", Message(text, wanted=worded(part.theory.wanted)))
            yield from _required(items, of)
        named = [name for _, name in seen if isinstance(name, str)]
        yield from _required([item for item in items if item.label in named or item.whole in named], of)


#: A polynomial of a condition, and as what it stood: in full, or by its name.
_Stood = tuple[Formula, Formula | str]


def _verdict(of: Verdict | CaseStatement) -> Message:
    theorems = (" (", joined(map(worded, of.theorems), ", "), ")") if of.theorems else ()
    return joined((worded(of.word.value), *theorems), "")


def _of_case(case: CaseStatement, further: bool, listed: Sequence[str], seen: list[_Stood]) -> Iterator[Line]:
    """A case, its conditions in full; a long one that is ``listed`` by its name there."""
    verdict = joined((Message("otherwise"), _verdict(case))) if further else _verdict(case)
    if case.otherwise:
        yield Line("", verdict)
        return
    yield Line("", joined((verdict, ", ", case.if_, ":"), ""))
    long = not all(item.formula and is_short(item.formula) for item in (*case.all_of, *case.any_of))
    yield from (_of_condition(item, long, listed, seen) for item in case.all_of)
    if case.all_of and case.any_of:
        yield Line("", joined((case.and_, ":"), ""))
    yield from (_of_condition(item, long, listed, seen) for item in case.any_of)


def _of_condition(item: Statement, long: bool, listed: Sequence[str], seen: list[_Stood]) -> Line:
    if item.formula is None:
        return Line("", item.never or item.note, item.relation, worded(item.label))
    letter = is_letter(-item.formula if item.opposite else item.formula, item.bare)
    hard = not is_short(item.formula) or (long and isinstance(label_of(item.bare), Symbol))
    if hard and not letter and item.whole in listed:
        stood, relation = stood_by_name(item, item.bare, seen)
    else:
        stood, relation = as_stood(item, seen)
    return Line("", joined((worded(stood), relation, "0")) if isinstance(stood, str) else stood, relation)


def _required(items: Iterable[Statement], of: str) -> Iterator[Line]:
    """Statements, with what each is needed for; of a long one first the letters that it is told in."""
    shown = Shown()
    for item in items:
        formula: Any = item.formula or item.never or item.note
        if item.in_coefficients is not None:
            formula, letters = item.in_coefficients.formula, shown.unshown(item.in_coefficients)
            yield from (Line(letter, value) for letter, value in letters if not is_letter(value, str(letter)))
        yield Line("", formula, item.relation, _remark(item, of))
        shown.show(item)


def _remark(item: Statement, of: str) -> str:
    label = Message("[[label]] of [[names]]", label=worded(item.label), names=of)
    return joined(filter(None, (label, item.note or item.remark)), ", ")


def _eigenvalues(analysis: Analysis) -> Iterator[Line]:
    if not analysis.stability.spectra:
        raise NoClosedForm("the description does not give all values")
    for part in analysis.stability.spectra:
        yield Line("", tuple(numbers(part)), "", Message("of [[names]]", names=", ".join(part.coordinates)))


def _integrals(analysis: Analysis) -> Iterator[Line]:
    for x in analysis.integrals:
        yield Line("", x.formula, "= const", joined((worded(x.name), " (", worded(x.status), ")"), ""))


#: What may be asked for, and what it is.
NAMES: Mapping[str, tuple[str, Callable[[Analysis], Iterator[Line]]]] = {
    "equations": ("the equations of motion, M q'' - f = 0", _equations),
    "accelerations": ("the equations solved for q''", _accelerations),
    "T": ("the kinetic energy", lambda x: iter([Line("T", x.energy.kinetic_energy)])),
    "U": ("the force function, minus the potential energy", lambda x: iter([Line("U", x.energy.force_function)])),
    "L": ("the Lagrangian, T + U", _lagrangian),
    "M": ("the mass matrix", lambda x: iter([Line("M", x.equations.mass_matrix)])),
    "f": ("the right-hand sides of M q'' = f", lambda x: iter([Line("f", x.equations.forcing)])),
    "coriolis": ("c of M q'' + c + g = forces: what inertia needs at q'' = 0", _coriolis),
    "gravity": ("g of these, -dU/dq of the fields of gravity", _gravity),
    "constraints": ("the constraints in velocities", _constraints),
    "motion": ("when the unperturbed motion satisfies the equations", _motion),
    "M0": ("the mass matrix of the first approximation", _matrix("M")),
    "D": ("its dissipative matrix, of damping", _matrix("D")),
    "G": ("its gyroscopic matrix", _matrix("G")),
    "K": ("its potential matrix, of stiffness", _matrix("K")),
    "N": ("its circulatory matrix", _matrix("N")),
    "B": ("its matrix of inputs", _matrix("B")),
    "A": ("its state space, the linear model x' = A x + B v: Jacobian matrix A", _state_space),
    "characteristic": ("the characteristic polynomials", _characteristic),
    "determinants": ("whose zeros are the roots lambda, in the description's notation", _determinants),
    "conditions": ("the conditions of stability", _conditions),
    "eigenvalues": ("the eigenvalues at the given values", _eigenvalues),
    "integrals": ("the first integrals", _integrals),
}


def _carrier(name: str) -> str:
    return Message("inertial axes") if name == INERTIAL else Message("the axes of [[body]]", body=name)


def _of_body(analysis: Analysis, name: str) -> Iterator[Line]:
    body = next(x for x in analysis.kinematics.bodies if x.name == name)
    scene = analysis.scene
    motion = next(x for x in scene.motions.values() if x.body.name == name)
    place = [scene.ring.reduce(x) for x in scene.position(scene.zero(name), INERTIAL)]
    cosines = Message("direction cosines of [[body]] in [[axes]]", body=name, axes=_carrier(body.attached_to))
    yield Line("R", body.rotation, remark=cosines)
    yield Line("r_O", column(scene.ring, place), remark=Message("place of its connection point, in inertial axes"))
    yield Line("omega", body.angular_velocity, remark=Message("its angular velocity, in its axes"))
    yield Line("V_O", body.velocity_origin, remark=Message("velocity of its connection point, in its axes"))
    if body.velocity_mass_centre != body.velocity_origin:
        yield Line("V_C", body.velocity_mass_centre, remark=Message("velocity of its mass centre, in its axes"))
    energy = body_energy(scene, motion)
    if motion.gyrostatic_moment is not None:
        energy += motion.gyrostatic_moment.dot(motion.angular_velocity)
    if not (own := scene.ring.reduce(energy)).is_zero():  # of a massless frame there is none
        yield Line("T", Formula(scene.ring, own), remark=Message("its part of the kinetic energy"))


def _of_equation(analysis: Analysis, name: str) -> Iterator[Line]:
    """The equation of one coordinate, or speed: what stands before accelerations, and the rest."""
    equations, names = analysis.equations, _of_rows(analysis)
    at, ring = names.index(name), equations.forcing[0].ring
    moving = [_moving(ring, rate) for rate in _rates(analysis)]
    first = sum((x * rate for x, rate in zip(equations.mass_matrix.rows[at], moving, strict=True)), moving[0] * 0)
    rest = equations.equalities(names)[at] - first
    others = Message("its other terms; the sum is zero")
    if equations.constraints.names:
        others = Message("its other terms; the sum is zero but for the forces of constraints")
    yield Line("", first, "", Message("the terms with accelerations in the equation of [[name]]", name=name))
    yield Line("", rest, "", others)


def _of_rows(analysis: Analysis) -> tuple[str, ...]:
    """What the rows of the equations of motion are named after, in their order: in speeds these and coordinates."""
    system = analysis.system
    if system.linear is not None:
        return ()
    if not system.speeds:
        return system.coordinates
    try:
        rows = cast("SpeedEquations", analysis.equations).speeds
    except Failure:  # which is said of the equations
        rows = tuple(speed.name for speed in system.speeds)
    return tuple(name if name in system.variables else without_velocity(name) for name in rows)


def known_names(analysis: Analysis) -> list[str]:
    """Everything that may be asked for.  Derives the equations of a system in speeds."""
    return list(dict.fromkeys((*given_names(analysis), *_of_rows(analysis))))


def given_names(analysis: Analysis) -> tuple[str, ...]:
    """What may be asked for before anything is derived."""
    return (*NAMES, *(body.name for body in analysis.system.bodies))


def named_by(words: str) -> tuple[str, ...]:
    """Of ``NAMES`` those whose meaning has all these words, or words that begin as they do: stiffness-matrix is K."""
    wanted = re.findall(r"[^\W\d_]{3,}", words.casefold())
    return tuple(
        name
        for name, (meaning, _) in NAMES.items()
        if wanted and all(any(_alike(x, y) for y in re.findall(r"\w+", f"{name} {meaning}".casefold())) for x in wanted)
    )


def _alike(word: str, other: str) -> bool:
    """Whether they are forms of one word: linearise and linear."""
    return min(len(word), len(other)) > SHORTEST and (word.startswith(other) or other.startswith(word))


def lines(analysis: Analysis, name: str) -> Iterator[Line]:
    """The formulas that go by a name.  Raises KeyError where nothing has it, Failure where there is no result."""
    if name in NAMES:
        return NAMES[name][1](analysis)
    if name in given_names(analysis):
        return _of_body(analysis, name)
    if name not in _of_rows(analysis):
        raise KeyError(name)
    return _of_equation(analysis, name)


def carried_lines(formulas: Formulas, name: str) -> Iterator[Line]:
    """The same in the new variables of ``formulas``.  Raises Failure for what is no formula of one row."""
    if name not in CARRIED:
        text = "no description has these variables, in which there are only [[names]]"
        raise NoClosedForm(text, names=", ".join(CARRIED))
    for line in lines(formulas.analysis, name):
        if not isinstance(line.value, Formula):
            continue
        if isinstance(line.name, Formula):
            yield replace(line, name=formulas.moving(line.name), value=formulas.rate(line.name, line.value))
        elif line.relation and not line.name:
            free = "const" in line.relation
            value = formulas.formula(line.value) if line.right else formulas.row(line.value, free)
            yield replace(line, value=value, right=tuple((formulas.formula(x), to) for x, to in line.right))
        else:
            yield replace(line, value=formulas.formula(line.value))


def reduced_lines(reduced: Reduced) -> Iterator[Line]:
    """Step by step what is put in; then the equations and integrals that are left, by powers of eps, and the check."""
    flow, first = reduced.reduction.flow, reduced.reduction.steps[0]
    remainder = "" if reduced.request.known is None else f"O({reduced.request.small}^{reduced.request.known})"
    for k, step in enumerate(reduced.reduction.steps[1:], start=1):
        yield Line("", joined((f"{k}.", worded(step.how.value))))
        yield from (Line(reduced.variable(place), InSmall(reduced.terms(x))) for place, x in step.images.items())
    head = Message("equations of motion, without [[rest]]", rest=remainder) if remainder else "equations of motion"
    yield Line("", worded(head))
    for place, x in flow.rates.items():
        rate = reduced.rate(place)
        if rate is not None and flow.velocities.get(place) not in flow.rates:
            yield Line(rate, InSmall(reduced.terms(x)))
    for x in flow.integrals:
        yield Line("", InSmall(reduced.terms(x)), "=" if flow.fixed else "= const", Message("integral"))
    text = "each step satisfies the original equations[[but]]: checked at random exact states"
    if reduced.reduction.steps == (first,):
        text = "they satisfy the original equations[[but]]: checked at random exact states"
    yield Line("", Message(text, but=Message(" but for [[rest]]", rest=remainder) if remainder else ""))


#: What can be told in variables that no description has.
CARRIED = ("equations", "T", "U", "L", "integrals")


def written(line: Line, language: str, say: Callable[[str], str] = str) -> str:
    """A line in one of ``LANGUAGES``, its words as ``say`` says them."""
    if isinstance(line.value, str):
        return say(line.value) if language == "text" else remarked(say(line.value), language)
    value = _in_small(line.value, language) if isinstance(line.value, InSmall) else _WRITERS[language](line.value)
    if line.name:
        wide = len(f"{line.name} = ") + max(map(len, value.splitlines())) > WIDEST
        if language == "text" and wide and (entries := list(_entry_by_entry(str(line.name), line.value))):
            return "\n".join(entries)
        name = _WRITERS[language](line.name) if isinstance(line.name, Formula) else _LETTERS[language](line.name)
        return f"{name} = " + value.replace("\n", "\n" + " " * (len(name) + 3))
    if not line.relation:
        return value
    named = [(x, _LETTERS[language](multiplier)) for x, multiplier in line.right]
    right = _sum(named, language) if named else "" if "const" in line.relation else "0"
    return " ".join(filter(None, (value, _RELATIONS[language].get(line.relation, line.relation), right)))


def remarked(words: str, language: str) -> str:
    """A remark of a language."""
    return {"latex": f"% {words}", "wolfram": f"(* {words} *)"}.get(language, f"# {words}")


def _sum(terms: Sequence[tuple[Formula, str]], language: str) -> str:
    """The sum of coefficients times multipliers, or powers, that are written already; "" is 1."""
    times = {"latex": "\\, ", "text": " "}.get(language, "*")
    summands = []
    for coefficient, name in terms:
        value = _WRITERS[language](coefficient)
        factor = f"({value})" if _is_sum(value) else value
        summands.append(value if not name else {"1": name, "-1": f"-{name}"}.get(value, f"{factor}{times}{name}"))
    return " + ".join(summands).replace("+ -", "- ")


#: How a power of lambda is written; Python has a word of that name.
_POWERS: Mapping[str, str] = {
    "text": "lambda^{}", "latex": "\\lambda^{{{}}}", "wolfram": "lambda^{}", "python": "lam**{}",
}  # fmt: skip


def _in_powers(value: InPowers, language: str) -> str:
    """From the highest power on."""
    powers = {0: "", 1: _POWERS[language].split("^")[0].split("**")[0]}
    terms = [(x, powers.get(k, _POWERS[language].format(k))) for k, x in enumerate(value.coefficients) if not x.is_zero]
    in_powers = _sum(terms[::-1], language) or "0"
    if str(value.factor) == "1":
        return in_powers
    return _sum([(value.factor, f"({in_powers})" if _is_sum(in_powers) else in_powers)], language)


def _in_small(value: InSmall, language: str) -> str:
    """From the lowest power on, each before its coefficient."""
    times = {"latex": "\\, ", "text": " "}.get(language, "*")
    summands = []
    for coefficient, power in value.terms:
        name, own = _WRITERS[language](power), _WRITERS[language](coefficient)
        minus = "-" * (own.startswith("-") and not _is_sum(own) and name != "1")
        own = own.removeprefix(minus)
        factor = f"({own})" if _is_sum(own) or own[:1].isdigit() else own
        summands.append(own if name == "1" else minus + (name if own == "1" else f"{name}{times}{factor}"))
    return " + ".join(summands).replace("+ -", "- ") or "0"


def _is_sum(text: str) -> bool:
    """Whether a formula is a sum, outside of all brackets."""
    depth = 0
    for k, letter in enumerate(text):
        depth += (letter in "([{") - (letter in ")]}")
        if depth == 0 and text[k : k + 3] in (" + ", " - "):
            return True
    return False


def _entries(value: Matrix | Determinant, language: str) -> list[list[str]]:
    """Row by row."""
    if isinstance(value, Matrix):
        return [[_WRITERS[language](x) for x in row] for row in value]
    return [[_in_powers(x, language) for x in row] for row in value.rows]


def _entry_by_entry(name: str, value: Value) -> Iterator[str]:
    """Of a matrix what is not zero, of a column all: each in a line of its own; what is symmetric only once."""
    if isinstance(value, Matrix) and value.shape != (1, 1):
        symmetric = value.rows == tuple(zip(*value.rows, strict=True))
        for i, row in enumerate(value, start=1):
            for j, entry in enumerate(row, start=1):
                if not (entry.is_zero or (symmetric and j < i)):
                    mirrored = f" = {name}[{j},{i}]" if symmetric and i != j else ""
                    yield f"{name}[{i},{j}]{mirrored} = {entry.readable()}"
    elif isinstance(value, tuple) and len(value) > 1 and all(isinstance(x, Formula) for x in value):
        yield from (f"{name}[{i}] = {_text(cast(Formula, x))}" for i, x in enumerate(value, start=1))


def _text(value: Value) -> str:
    if isinstance(value, Determinant) or (isinstance(value, Matrix) and value.shape != (1, 1)):
        left, right = "||" if isinstance(value, Determinant) else "[]"
        rows = _entries(value, "text")
        widths = [max(map(len, texts)) for texts in zip(*rows, strict=True)]
        return "\n".join(f"{left} {'   '.join(map(str.ljust, row, widths))} {right}" for row in rows)
    return _plain(value, Formula.readable, root_text, "({})")


def root_text(root: RootNumbers) -> str:
    """``-0.1 +- 2.3i``, as often as it occurs."""
    real = f"{root.real:.6g}"
    text = real if not root.imaginary else f"+-{root.imaginary:.6g}i"
    if root.imaginary and root.real:
        text = f"{real} +- {root.imaginary:.6g}i"
    return ", ".join([text] * root.multiplicity)


def _latex(value: Value) -> str:
    if isinstance(value, Determinant):
        body = " \\\\ ".join(map(" & ".join, _entries(value, "latex")))
        return f"\\begin{{vmatrix}} {body} \\end{{vmatrix}}"
    if isinstance(value, Matrix) and value.shape != (1, 1):
        return value.latex()
    return _plain(
        value, Formula.latex, lambda x: _both(x, "\\,\\mathrm{i}", lambda text: Number(text).tex), "({})", ",\\; "
    )


def _wolfram(value: Value) -> str:
    if isinstance(value, Matrix | Determinant):
        rows = "{" + ", ".join("{" + ", ".join(row) + "}" for row in _entries(value, "wolfram")) + "}"
        return f"Det[{rows}]" if isinstance(value, Determinant) else rows
    return _plain(value, Formula.wolfram, lambda x: _both(x, "*I", _decimal), "{{{}}}")


def _decimal(text: str) -> str:
    return re.sub(r"e([-+]?\d+)", lambda match: f"*^{int(match[1])}", text)


def _python(value: Value) -> str:
    if isinstance(value, Matrix):
        return str(value)
    if isinstance(value, Determinant):
        return "det([" + ", ".join(f"[{', '.join(row)}]" for row in _entries(value, "python")) + "])"
    return _plain(value, str, lambda x: _both(x, "j"), "({},)")


def _plain(
    value: Value, formula: Callable[[Formula], str], root: Callable[[RootNumbers], str], listed: str, comma: str = ", "
) -> str:
    """A formula, also the only one of a matrix, or several values side by side."""
    assert not isinstance(value, str | Determinant | InSmall)
    if isinstance(value, Matrix):
        value = value[0, 0]
    if isinstance(value, Formula):
        return formula(value)
    return listed.format(comma.join(root(x) if isinstance(x, RootNumbers) else formula(x) for x in value))


def _both(root: RootNumbers, unit: str, number: Callable[[str], str] = str) -> str:
    """A root and its conjugate, as often as they occur; ``number`` writes a decimal."""
    real, imaginary = (number(f"{x:.6g}") for x in (root.real, root.imaginary))
    both = [f"{real} + {imaginary}{unit}", f"{real} - {imaginary}{unit}"] if root.imaginary else [real]
    return ", ".join(both * root.multiplicity)


_WRITERS: Mapping[str, Callable[[Value], str]] = {
    "text": _text,
    "latex": _latex,
    "wolfram": _wolfram,
    "python": _python,
}

#: How a letter of ours is written.
_LETTERS: Mapping[str, Callable[[str], str]] = {
    "text": str,
    "latex": lambda letter: str(latex_symbol(letter)),
    "wolfram": wolfram_name,
    "python": str,
}

_RELATIONS: Mapping[str, Mapping[str, str]] = {
    "text": {},
    "latex": {"!=": r"\neq", ">=": r"\geq", "<=": r"\leq", "= const": r"= \mathrm{const}"},
    "wolfram": {"=": "==", "= const": "== const"},
    "python": {"=": "==", "= const": "== const"},
}
