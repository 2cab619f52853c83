"""Self-check: every run compares its results with an independent route, exactly where numbers can be exact.

* The closed equations (Lagrange, in the ring) and the straight-line program (Newton-Euler, in body axes) are each
  compared with d'Alembert's principle in inertial axes (``mbsym.mechanics.oracle``) at rational states.
* Problem 1's rotations and velocities are compared with the same placement of the bodies.
* Differentiated equations are compared with those expanded while they are built, as polynomials.

``exact`` means equality of rational numbers (or polynomials) without tolerance; ``verified numerically`` means
overlapping balls of at least 200 bits, where roots or exponentials make exact numbers impossible.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any, cast

from flint import arb, arb_mat, ctx, fmpq_mat

from mbsym.algebra.base import Scalar
from mbsym.algebra.certainty import Certainty
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import NotRational, SingularPoint, message_of
from mbsym.algebra.ring import Ring
from mbsym.algebra.splitting import vanishes_with
from mbsym.expressions.message import Counted, Message, joined, worded
from mbsym.formulas.formula import Formula
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.newton_euler import residuals
from mbsym.mechanics.oracle import Oracle
from mbsym.mechanics.programs import Programs
from mbsym.mechanics.speed_states import all_slopes
from mbsym.mechanics.states import SEED, Oracles
from mbsym.model.system import INERTIAL, System, acceleration_name, velocity_name
from mbsym.problems.energy import Energy
from mbsym.problems.equations import Equations
from mbsym.problems.kinematics import BodyKinematics, Kinematics
from mbsym.problems.linearisation import Linearisation

if TYPE_CHECKING:
    from mbsym.algebra.program import Node
    from mbsym.mechanics.speed_programs import SpeedProgram
    from mbsym.mechanics.speeds import SpeedForm
    from mbsym.problems.in_speeds import SpeedEquations

EXACT, NUMERICAL, UNDECIDED, FAILED = "exact", Certainty.VERIFIED, Certainty.UNDECIDED, "FAILED"
#: Of the mass matrix: no route is wrong, the described system is degenerate.
SINGULAR = "singular"

#: How many states; each is enough to catch a slip with probability close to one.
STATES = 3
#: Terms of formulas that one check evaluates in all its states: where formulas are long there are fewer states, and
#: where even one is too much the longest formulas are left out.  Both are said in the check's detail.
MOST_EVALUATED = 600_000
#: Bodies times coordinates from which on one state has to do: every partial velocity is formed there.
MOST_DISPLACED = 1_000
#: Working precision of the balls, in bits.
PRECISION = 256


@dataclass(frozen=True)
class Check:
    """``first`` and ``second`` name the routes; ``outcome``: exact, verified numerically, undecided, singular, FAILED.

    ``states``: at how many states they agree, where they are compared at states.
    """

    name: str
    first: str
    second: str
    outcome: str
    detail: str = ""
    states: int | None = None

    def __post_init__(self) -> None:
        if self.failed and not self.detail:
            object.__setattr__(self, "detail", Message("the two routes differ"))
        for part in ("name", "first", "second", "detail"):
            object.__setattr__(self, part, worded(getattr(self, part)))

    @property
    def failed(self) -> bool:
        return self.outcome == FAILED

    @property
    def singular(self) -> bool:
        return self.outcome == SINGULAR


#: A label for the complaint, and two values that must be equal.
Pair = tuple[str, Scalar, Scalar]
#: Computes such pairs at an oracle's state.
Pairs = Callable[[Oracle], list[Pair]]


def oracles(system: System, ring: Ring) -> Oracles:
    """The oracles that all checks of one system share; some states more than needed, in case some are singular."""
    return Oracles(system, ring, 4 * STATES)


@dataclass(frozen=True)
class Extent:
    """What a check can afford: ``chosen`` parts (bodies, equations), at so many ``states``; ``remark`` says it."""

    chosen: tuple[str, ...]
    states: int
    remark: str = ""


def extent(lengths: Mapping[str, int], what: str, fixed: int = 0) -> Extent:
    """As many states as MOST_EVALUATED allows, at least one; then the parts of the fewest terms, at least one.

    ``lengths`` are the terms that each part takes, ``fixed`` those that are evaluated in any case.
    """
    total = fixed + sum(lengths.values())
    if total <= MOST_EVALUATED:
        return Extent(tuple(lengths), max(1, min(STATES, MOST_EVALUATED // max(1, total))))
    chosen: list[str] = []
    for name in sorted(lengths, key=lambda name: lengths[name]):
        fixed += lengths[name]
        if chosen and fixed > MOST_EVALUATED:
            break
        chosen.append(name)
    remark = (
        Message("[[count]] of [[all]] [[what]], the others are longer", count=len(chosen), all=len(lengths), what=what)
        if len(chosen) < len(lengths)
        else ""
    )
    return Extent(tuple(name for name in lengths if name in chosen), 1, remark)


def compare(
    truth: Oracles, name: str, routes: tuple[str, str], pairs: Pairs, states: int = STATES, remark: str = ""
) -> Check:
    """Compares two routes at rational states, or with balls where the values are irrational.

    ``remark`` says what was left out, if anything was.
    """
    check = _compared(truth, name, routes, pairs, states)
    if not remark or check.outcome not in (EXACT, NUMERICAL):
        return check
    return replace(check, detail=joined((check.detail, remark), "; "))


def _compared(truth: Oracles, name: str, routes: tuple[str, str], pairs: Pairs, states: int) -> Check:
    try:
        outcome, detail, done = _compare(truth.rational, pairs, states)
        return Check(name, *routes, outcome, detail, done)
    except NotRational:
        pass
    with ctx.workprec(PRECISION):
        outcome, detail, done = _compare(truth.balls, pairs, states)
    return Check(name, *routes, NUMERICAL if outcome == EXACT else outcome, detail, done)


def _compare(truth: Sequence[Oracle], pairs: Pairs, required: int) -> tuple[str, str, int]:
    done = 0
    for oracle in truth:
        try:
            compared = pairs(oracle)
        except ZeroDivisionError:
            continue
        outcome, detail = _verdict(compared)
        if outcome == FAILED:
            return outcome, detail, done
        done += outcome == EXACT
        if done == required:
            return EXACT, Counted(done, "state"), done
    return (
        UNDECIDED,
        Message("only [[done]] of [[wanted]] states without a singularity were found", done=done, wanted=required),
        done,
    )


class NoMotionThere(Exception):
    """The state that was drawn keeps no constraints: about it there is nothing to be linearised."""


def decide(name: str, routes: tuple[str, str], exact: bool, pairs: Callable[[bool], list[Pair]]) -> Check:
    """Compares pairs at one state: of rational numbers if ``exact`` and possible, else of balls (argument True)."""
    try:
        if exact:
            try:
                outcome, detail = _verdict(pairs(False))
                return Check(name, *routes, outcome, detail or "random parameters")
            except NotRational:
                pass
        with ctx.workprec(PRECISION):
            outcome, detail = _verdict(pairs(True))
        return Check(name, *routes, NUMERICAL if outcome == EXACT else outcome, detail or "random parameters")
    except NoMotionThere:
        detail = Message("the condition of problem 4 does not hold at random parameters")
        return Check(name, *routes, UNDECIDED, detail)
    except ZeroDivisionError as reason:
        return Check(name, *routes, UNDECIDED, Message("singular: [[why]]", why=message_of(reason)))


def _verdict(compared: Sequence[Pair]) -> tuple[str, str]:
    agreements = [(label, first, second, agreement(first, second)) for label, first, second in compared]
    for label, first, second, agree in agreements:
        if agree is False:
            return FAILED, Message(
                "[[label]] differs: [[first]] against [[second]]",
                label=label,
                first=_short(first),
                second=_short(second),
            )
    return (UNDECIDED, "enclosures too wide") if any(agree is None for *_, agree in agreements) else (EXACT, "")


def agreement(first: Scalar, second: Scalar) -> bool | None:
    """Equal, different, or (balls too wide to tell) None."""
    if not isinstance(first, arb) and not isinstance(second, arb):
        return bool(first == second)
    difference = first - second
    if not difference.is_finite():
        return None
    if not difference.contains(0):
        return False
    size = 1 + abs(arb(first).mid())
    return True if difference.rad() < size * arb(2) ** -60 else None


def _short(x: Scalar) -> str:
    text = str(x)
    return text if len(text) <= 60 else text[:57] + "..."


D_ALEMBERT = Message("d'Alembert's principle in inertial axes")


def check_equations(truth: Oracles, equations: Equations) -> Check:
    """The closed equations, Lagrange's or Kane's with the kinematic ones, against d'Alembert's principle."""
    speeds, own = _speeds(truth.system), cast("SpeedEquations", equations)
    if equations.in_speeds:
        speeds = dict(zip(own.speeds, own.speed_rates, strict=True))
    rows = dict(zip(speeds, zip(equations.mass_matrix, equations.forcing, strict=True), strict=True))
    chosen = extent({u: sum(x.terms for x in (*row, f)) for u, (row, f) in rows.items()}, Message("equations"))

    def pairs(oracle: Oracle) -> list[Pair]:
        carry = Carrier(truth.ring, oracle.state.numbers, oracle.state.values)
        mass = {u: [carry(x.polynomial) for x in rows[u][0]] for u in chosen.chosen}
        errors = _errors(oracle, speeds, mass, {u: carry(rows[u][1].polynomial) for u in chosen.chosen})
        if not equations.in_speeds:
            return _against(oracle, speeds, errors, {})
        rates = {name: carry(x.polynomial) for name, x in zip(own.positions, own.rates, strict=True)}
        balance = {
            u: carry(a.polynomial) - carry(b.polynomial)
            for u, a, b in zip(speeds, own.needed, own.supplied, strict=True)
        }
        standing: list[Pair] = [
            (Message("equation [[name]] as it stands", name=u), balance[u], error) for u, error in errors.items()
        ]
        return standing + _against(oracle, speeds, errors, rates)

    routes = ("Kane, closed form" if equations.in_speeds else "Lagrange, closed form", D_ALEMBERT)
    return compare(truth, "equations of motion", routes, pairs, chosen.states, chosen.remark)


def check_program(truth: Oracles, programs: Programs, form: SpeedForm | None = None) -> Check:
    """The straight-line program, and the general recursion it is a leaner form of, against d'Alembert's principle.

    And the program in the speeds of ``form``.
    """
    names, speeds = truth.system.coordinates, _speeds(truth.system)

    def pairs(oracle: Oracle) -> list[Pair]:
        state = oracle.state
        recursion = residuals(Scene(truth.system, state.numbers, state.values, truth.ring))
        (energy,) = programs.program.evaluate([programs.energy], state.values, state.numbers)
        compared: list[Pair] = [(Message("energy"), energy, oracle.energy_of_motion - oracle.force_function)]
        for name in names:
            label = Message("equation [[name]] of the general recursion", name=name)
            compared.append((label, recursion[name], oracle.residuals[name]))
        return [*compared, *_coded(truth, oracle, programs, speeds, {})]

    states = 1 if len(names) * len(truth.system.bodies) > MOST_DISPLACED else STATES
    routes = ("Newton-Euler recursion in body axes", D_ALEMBERT)
    checked = compare(truth, "straight-line program", routes, pairs, states)
    if form is None or checked.failed:
        return checked
    from mbsym.mechanics.speed_programs import speed_program  # few systems have speeds of their own

    code, own = speed_program(form), {u.name: u.rate_name for u in form.speeds}
    rates = dict(zip((x.name for x in form.positions), code.rates, strict=True))
    routes = ("Kane in body axes, straight-line", D_ALEMBERT)
    in_speeds = compare(truth, "straight-line program", routes, lambda oracle: _coded(truth, oracle, code, own, rates))
    return in_speeds if in_speeds.failed else checked


# With  E_r = (M u' - f)_r  and the oracle's residual e_i of every coordinate, at the same state,
#
#     e_i = sum_r E_r du_r/dq'_i,
#
# du/dq' from the spins of the placed bodies (of u = q' it is 1); the kinematic equations s' = g(s, u) are compared with
# the rates at that state.


def _speeds(system: System) -> dict[str, str]:
    """Generalised velocities, and what their rates are called."""
    return {velocity_name(name): acceleration_name(name) for name in system.coordinates}


def _coded(
    truth: Oracles,
    oracle: Oracle,
    code: Programs | SpeedProgram,
    speeds: Mapping[str, str],
    rates: Mapping[str, Node],
) -> list[Pair]:
    """M, f and s' of a program, compared."""
    n, masses = len(speeds), truth.masses(oracle, code)
    values = code.program.evaluate([*code.forcing, *rates.values()], oracle.state.values, oracle.state.numbers)
    mass = {u: masses[r * n : (r + 1) * n] for r, u in enumerate(speeds)}
    errors = _errors(oracle, speeds, mass, dict(zip(speeds, values[:n], strict=True)))
    return _against(oracle, speeds, errors, dict(zip(rates, values[n:], strict=True)))


def _errors(
    oracle: Oracle, speeds: Mapping[str, str], mass: Mapping[str, Sequence[Any]], forcing: Mapping[str, Any]
) -> dict[str, Any]:
    """(M u' - f)_r at the state, by the speeds of the rows that there are."""
    errors = {}
    for u, row in mass.items():
        errors[u] = -forcing[u]
        for entry, rate in zip(row, speeds.values(), strict=True):
            errors[u] = errors[u] + entry * oracle.state.values[rate]
    return errors


def _against(
    oracle: Oracle, speeds: Mapping[str, str], errors: Mapping[str, Any], rates: Mapping[str, Any]
) -> list[Pair]:
    """e_i against sum_r E_r du_r/dq'_i where all E_r that it takes are there, and s' against the rates at the state."""
    state, columns = oracle.state, dict(zip(speeds, all_slopes(oracle, [*speeds]), strict=True))
    compared: list[Pair] = []
    for i, name in enumerate(oracle.system.coordinates):
        slopes = {u: column[i] for u, column in columns.items() if not state.numbers.vanishes(column[i])}
        if slopes.keys() <= errors.keys():
            total = sum((errors[u] * slope for u, slope in slopes.items()), state.numbers.zero)
            compared.append((Message("equation [[name]]", name=name), total, oracle.residuals[name]))
    return compared + [(f"{name}'", rate, state.values[velocity_name(name)]) for name, rate in rates.items()]


def check_mass_matrix(truth: Oracles, programs: Programs) -> Check:
    """det M is not zero: every coordinate, and every combination of them, carries inertia."""
    names = truth.system.coordinates
    n = len(names)

    def regular(oracle: Oracle) -> bool | None:
        """None where enclosures are too wide to tell."""
        values = truth.masses(oracle, programs)
        if any(isinstance(value, arb) for value in values):
            return None if arb_mat(n, n, [arb(value) for value in values]).det().contains(0) else True
        return bool(fmpq_mat(n, n, values).rank() == n)

    routes = ("rank of M", "number of coordinates")
    deficient = False
    with ctx.workprec(PRECISION + 32 * n):  # a determinant in balls loses some bits with every row
        for states in (truth.rational, truth.balls):
            for oracle in states:
                with suppress(SingularPoint, NotRational):
                    full_rank = regular(oracle)
                    if full_rank:
                        return Check("mass matrix", *routes, EXACT, "regular")
                    deficient = deficient or full_rank is False
    if not deficient and not any(all(programs.program.vanishes(x) for x in row) for row in programs.mass_matrix):
        return Check("mass matrix", *routes, UNDECIDED, "enclosures too wide to tell whether M is regular")
    idle = [name for i, name in enumerate(names) if all(programs.program.vanishes(x) for x in programs.mass_matrix[i])]
    which = ", ".join(idle) if idle else Message("some combination of [[names]]", names=", ".join(names))
    return Check(
        "mass matrix",
        *routes,
        SINGULAR,
        Message("[[which]] carries no inertia: no equation determines its acceleration", which=which),
    )


def check_kinematics(truth: Oracles, kinematics: Kinematics) -> Check:
    """Direction cosines, angular velocities and velocities against the placement of the bodies in inertial axes."""
    chosen = extent({body.name: _terms(body) for body in kinematics.bodies}, Message("bodies"))

    def pairs(oracle: Oracle) -> list[Pair]:
        state = oracle.state
        carry = Carrier(truth.ring, state.numbers, state.values)
        place = oracle.moving
        compared: list[Pair] = []
        for body in truth.system.bodies:
            if body.name not in chosen.chosen:
                continue
            own = kinematics.body(body.name)
            axes = [[x.a for x in row] for row in place.axes[body.name]]
            parent = [[x.a for x in row] for row in place.axes[body.attached_to]]
            for i in range(3):
                for j in range(3):
                    cosine = sum((axes[k][i] * parent[k][j] for k in range(3)), state.numbers.zero)
                    compared.append(
                        (Message("R of [[body]]", body=body.name), carry(own.rotation[i, j].polynomial), cosine)
                    )
            spin = place.spin(body.name)[0]
            relative = spin
            if body.attached_to != INERTIAL:
                relative = [a - b for a, b in zip(spin, place.spin(body.attached_to)[0], strict=True)]
            origin = [x.b for x in place.origin[body.name]]
            centre = [x.b for x in place.mass_centre(body)]
            for label, ours, world in (
                (Message("relative angular velocity"), own.relative_angular_velocity, relative),
                (Message("angular velocity"), own.angular_velocity, spin),
                (Message("velocity of the origin"), own.velocity_origin, origin),
                (Message("velocity of the mass centre"), own.velocity_mass_centre, centre),
            ):
                for i in range(3):
                    turned = sum((axes[k][i] * world[k] for k in range(3)), state.numbers.zero)
                    compared.append(
                        (
                            Message("[[label]] of [[body]]", label=label, body=body.name),
                            carry(ours[i].polynomial),
                            turned,
                        )
                    )
        return compared

    routes = ("recursion in body axes", "placement in inertial axes")
    return compare(truth, "kinematics", routes, pairs, chosen.states, chosen.remark)


def _terms(body: BodyKinematics) -> int:
    """The length of everything that problem 1 says of a body."""
    vectors = (body.relative_angular_velocity, body.angular_velocity, body.velocity_origin, body.velocity_mass_centre)
    return body.rotation.terms + sum(x.terms for vector in vectors for x in vector)


def check_energy(truth: Oracles, energy: Energy, names: Sequence[str]) -> Check:
    """T, its parts A2, A1, A0 by powers of velocities of these names, and U against sums over bodies."""
    length = energy.kinetic_energy.terms + energy.A2.terms + energy.A0.terms + energy.force_function.terms
    chosen = extent({"energy": length}, Message("formulas"))

    def pairs(oracle: Oracle) -> list[Pair]:
        state = oracle.state
        carry = Carrier(truth.ring, state.numbers, state.values)
        speeds = [state.values[name] for name in names]
        parts = carry(energy.A0.polynomial)
        for i, speed in enumerate(speeds):
            parts = parts + carry(energy.A1[i].polynomial) * speed
            for j, other in enumerate(speeds):
                half = state.numbers.number(Fraction(1, 2))
                parts = parts + half * carry(energy.A2[i, j].polynomial) * speed * other
        return [
            (Message("kinetic energy"), carry(energy.kinetic_energy.polynomial), oracle.kinetic_energy),
            ("A2, A1, A0", parts, oracle.kinetic_energy),
            (Message("force function"), carry(energy.force_function.polynomial), oracle.force_function),
        ]

    return compare(truth, "energy", ("recursion in body axes", "sums in inertial axes"), pairs, chosen.states)


def check_linearisation(ring: Ring, first: Linearisation, second: Linearisation) -> Check:
    """All five matrices by both routes, as polynomials; as balls where the ring cannot decide."""
    outcomes = {
        name: how_equal(ring, a.polynomials, b.polynomials)
        for name, a, b in zip("MDGKN", first.matrices, second.matrices, strict=True)
    }
    if first.B is not None and second.B is not None:
        outcomes["B"] = how_equal(ring, first.B.polynomials, second.B.polynomials)
    wrong = [name for name, outcome in outcomes.items() if outcome == FAILED]
    outcome = _worst(outcomes.values())
    detail = Message("differs in [[wrong]]", wrong=", ".join(wrong)) if wrong else HOW_EQUAL[outcome]
    return Check("linearisation", first.route, second.route, outcome, detail)


def check_residuals(ring: Ring, first: Sequence[Formula], second: Sequence[Formula]) -> Check:
    """The motion substituted into the nonlinear equations, and into the recursion."""
    rows = ([x.polynomial for x in first], [x.polynomial for x in second])
    outcome = how_equal(ring, [rows[0]], [rows[1]])
    return Check(
        "equilibrium",
        "motion substituted into the closed equations",
        "Newton-Euler recursion on the motion",
        outcome,
        "the residuals differ" if outcome == FAILED else HOW_EQUAL[outcome],
    )


def check_identities(
    ring: Ring, name: str, routes: tuple[str, str], entries: Mapping[str, Any], conditions: Sequence[Any] = ()
) -> Check:
    """Every entry (label -> polynomial) is zero: identically, or where the ``conditions`` of problem 4 hold."""
    open_entries, needed = [], False
    for label, x in entries.items():
        zero = ring.is_zero(x)
        if not zero and conditions:
            zero, needed = vanishes_with(ring, x, conditions), True
        if zero is False:
            return Check(
                name,
                *routes,
                FAILED,
                Message(
                    "[[label]] differs by [[difference]]",
                    label=label,
                    difference=_short(ring.fraction(ring.reduce(x))[0]),
                ),
            )
        if zero is None:
            open_entries.append(label)
    if open_entries:
        return Check(
            name, *routes, UNDECIDED, Message("open whether they agree in [[names]]", names=joined(open_entries, ", "))
        )
    return Check(name, *routes, EXACT, WHERE_IT_EXISTS if needed else HOW_EQUAL[EXACT])


WHERE_IT_EXISTS = "identical polynomials where the conditions of problem 4 hold"

HOW_EQUAL = {
    EXACT: "identical polynomials",
    NUMERICAL: "equal at random parameters",
    UNDECIDED: "roots that are not real at random parameters",
}


def _worst(outcomes: Iterable[str]) -> str:
    return max(outcomes, key=(EXACT, NUMERICAL, UNDECIDED, FAILED).index, default=EXACT)


def how_equal(ring: Ring, a: Sequence[Sequence[Any]], b: Sequence[Sequence[Any]]) -> str:
    """How far a = b is certain, entry by entry."""
    pairs = [(x, y) for row, other in zip(a, b, strict=True) for x, y in zip(row, other, strict=True)]
    return _worst(_vanishing(ring, x - y) for x, y in pairs)


def _vanishing(ring: Ring, x: Any) -> str:
    """How far x = 0 is certain: behind roots the ring may not know, and has then found no ball without zero in it."""
    zero = ring.is_zero(x)
    if zero is not None:
        return EXACT if zero else FAILED
    source, agreements = random.Random(SEED), 0
    with ctx.workprec(PRECISION):
        for _ in range(4 * STATES):
            value = ring.evaluate(x, {name: arb(source.randint(1, 99)) / 64 for name in ring.names()})
            agree = agreement(value, arb(0))
            if agree is False:
                return FAILED
            agreements += agree is True
    return NUMERICAL if agreements else UNDECIDED
