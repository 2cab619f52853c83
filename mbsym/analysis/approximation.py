"""The first approximation in the pipeline: about which motion it is, and why there may be none."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

from flint import arb, ctx, fmpq

from mbsym.algebra.base import Lowering
from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import NOT_THERE, Failure
from mbsym.algebra.point import Balls
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.analysis.stages import NoResult, Unavailable
from mbsym.expressions.angles import linear_form
from mbsym.expressions.message import Message
from mbsym.expressions.parser import parse_expression
from mbsym.expressions.place import Complaints
from mbsym.expressions.tree import ZERO, Call, Expression, Name, Number, Operation, children, names, number, walk
from mbsym.formulas.formula import Column, Formula, column
from mbsym.mechanics import newton_euler
from mbsym.mechanics.expansion import expansion, felt, given_motion, on_leaf, over_jets, projected
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import is_steady, motion_values, turning
from mbsym.mechanics.rotation_orders import rotation_orders
from mbsym.mechanics.variables import expressions
from mbsym.model.system import MotionEntry, Relation, System
from mbsym.problems import equilibrium
from mbsym.problems.equilibrium import Displacement, Equilibrium
from mbsym.problems.linearisation import Linearisation
from mbsym.problems.reduction import Reduced, by_projection, reduction

if TYPE_CHECKING:
    from mbsym.analysis.pipeline import Analysis
    from mbsym.formulas.formula import Matrix


#: What stands for the description in commands that are advised.
FILE = "FILE"

#: Of so many terms is the value of a coordinate that a hint tells.
SHORT = 6

#: A hint lists so many coordinates; of more it shows one.
MOST_LISTED = 12


def expanded(analysis: Analysis) -> Scene:
    """The system over second-order jets about the unperturbed motion.  Raises Unavailable where none is given."""
    demand_motion(analysis)
    return over_jets(analysis.parameters_scene, given_motion(analysis.parameters_scene), analysis.system, 2)


def reduced(analysis: Analysis) -> Reduced:
    """The system to first order about the unperturbed motion.  Raises Unavailable where none is given."""
    demand_motion(analysis)
    scene, names = analysis.parameters_scene, analysis.system.coordinates
    signs, known = analysis.signs, analysis.ring.adjoined
    first_order = expansion(scene, signs, analysis.system)
    equations = projected(scene, first_order)
    if analysis.ring.adjoined > known:  # the equations brought in numbers, log(2), whose signs are known, too
        analysis.forget(analysis.stage_of("signs"))
    leaf = 0 if len(first_order.coordinates) == len(first_order.speeds) else kept_by_velocities(analysis)
    if leaf:
        there, own = on_leaf(scene, first_order, equations)
        unfelt = len(there.speeds) - len(felt(there, own))
        if not unfelt or unfelt <= _displacements(analysis, [names[i] for i in there.speeds]):
            first_order, equations = there, own
        else:  # coordinates that drop out, and their families, are judged by the roots of the whole
            leaf = 0
    return Reduced(first_order, equations, reduction(scene, first_order, equations, leaf))


def _displacements(analysis: Analysis, speeds: Sequence[str]) -> int:
    """Along how many displacements that the constraints allow no equation changes; ``speeds`` are independent."""
    from mbsym.problems.constrained_balance import ConstrainedBalance

    balance = ConstrainedBalance(analysis.scene, analysis.optional("energy"), analysis.signs, {})
    return len(balance.displacements(speeds).directions)


def kept_by_velocities(analysis: Analysis) -> int:
    """How many relations the velocity constraints keep if all are proved to be integrable, without time; else 0."""
    tied = analysis.optional("constraints")
    known = None if tied is None else tied.integrability
    if known is None or known.rheonomic or known.word != "holonomic" or known.certainty is not Certainty.PROVED:
        return 0
    return int(known.kept)


def residuals(analysis: Analysis) -> Column:
    """-f of every equation of motion on the unperturbed motion, and what constraints demand of it before these."""
    return column(analysis.ring, analysis.reduced.residuals)


def beside(analysis: Analysis, singular: Sequence[Displacement]) -> list[Polynomial]:
    """What the motion demands besides f = 0 where coordinates are singular on it."""
    if not singular:
        return []
    ring, names = analysis.ring, analysis.system.coordinates
    jets = newton_euler.residuals(analysis.expanded)
    slopes = {name: [-jets[name].first.get(j, ring.zero) for j in range(len(names))] for name in names}
    return equilibrium.beside(slopes, singular, ring.zero)


def demand_motion(analysis: Analysis) -> None:
    """Raises Unavailable where the description gives no unperturbed motion; the hint says which one to try."""
    if not analysis.system.motion:
        names = analysis.system.coordinates
        listed = names if len(names) <= MOST_LISTED else names[:1]
        hint = Message("add for example  motion: {[[values]]}", values=", ".join(f"{name}: 0" for name in listed))
        if listed != names:
            hint = Message("[[hint]]; what is left out is 0 at rest", hint=hint)
        if not regular_at_zero(analysis.system):
            hint = Message(
                "say with 'motion:' about which one; at rest with all coordinates 0 the description is singular"
            )
        elif not (rests := _rests_at_zero(analysis)):
            hint = Message("say with 'motion:' about which one")
            if rests is not None:
                hint = Message(
                    "say with 'motion:' about which one; rest with all coordinates 0 is none, or only at special "
                    "values of parameters (mbsym equilibria [[file]] looks for others at given values)",
                    file=FILE,
                )
        reason = "the description gives no unperturbed motion"
        raise Unavailable("motion", NoResult(reason, hint, "no motion", "no-motion"))


def _rests_at_zero(analysis: Analysis) -> bool | None:
    """Whether the description, were this its motion, had it at all values of the parameters; None if that is open."""
    still = MotionEntry(analysis.system.coordinates[0], Number(Fraction(0)), Number(Fraction(0)))
    resting = type(analysis)(replace(analysis.system, motion=(still,)), ())
    try:
        return resting.equilibrium.satisfied
    except (Failure, Unavailable):
        return None


def first_approximation(analysis: Analysis) -> Linearisation:
    """The equations of perturbed motion, time-dependent or not (their ``varying`` says which).

    Raises Unavailable where the motion does not exist or is not steady in these coordinates.
    """
    if analysis.system.linear is not None:
        from mbsym.analysis import given

        return given.first_approximation(analysis)
    if analysis.equilibrium.impossible:
        near = _motion_beside(analysis)
        hint = "" if near is None else Message("with $[[name]] = [[value]]$ it does", name=near[0], value=near[1])
        raise Unavailable("motion", NoResult(analysis.equilibrium.why_not, hint, "no such motion", "impossible-motion"))
    if analysis.equilibrium.unsteady:
        varying = ", ".join(analysis.equilibrium.unsteady)
        reason = Message("on the given motion the equations, in symbols, still vary with [[varying]]", varying=varying)
        hint = steady_order(analysis) or "it is no steady motion in these coordinates, or only at special parameters"
        raise Unavailable("motion", NoResult(reason, hint, "not steady", "not-steady"))
    return by_projection(analysis.parameters_scene, analysis.reduced, analysis.equilibrium)


def _motion_beside(analysis: Analysis) -> tuple[str, Formula] | None:
    """A coordinate that rests, and where it has to for the motion to exist, all others as they are given.

    f_i + df_i/dq_j delta = 0 for all i, one step of Newton's method, which is right where f is linear in q_j; whether
    it is the equations of the motion that is found tell.
    """
    system, ring = analysis.system, analysis.ring
    if system.constraints or system.speeds or system.prescribed:
        return None
    jets, given = newton_euler.residuals(analysis.expanded), motion_values(system)
    for j, name in enumerate(system.coordinates):
        value, rate = given[name]
        slopes = [(jets[x].value, jets[x].first.get(j, ring.zero)) for x in system.coordinates]
        steps = [(f, slope) for f, slope in slopes if not ring.vanishes(f)]
        if rate != ZERO or len(steps) != 1 or ring.vanishes(steps[0][1]):
            continue
        f, slope = steps[0]
        at = ring.reduce(analysis.parameters_scene.lower(value) - ring.times(f, ring.reciprocal(slope)))
        found = Formula(ring, at)
        expression = parse_expression(str(found), Complaints()) if found.terms <= SHORT else None
        if expression is None:
            continue
        motion = (*(x for x in system.motion if x.coordinate != name), MotionEntry(name, expression, ZERO))
        try:
            if type(analysis)(replace(system, motion=motion), ()).equilibrium.satisfied:
                return name, found
        except (Failure, Unavailable):
            continue
    return None


def autonomous(analysis: Analysis) -> Linearisation:
    """The first approximation where its coefficients are constant: the theorems of problem 6 are about it.

    Raises Unavailable where they vary with time.
    """
    linear = analysis.linearisation
    if linear.varying:
        hint = steady_order(analysis)
        if not hint:
            hint = Message("choose coordinates in which the motion is steady, if there are any")
            free = {item.name for item in analysis.system.given}
            if led := sorted(free & {name for entry in linear.varying for name in entry.among}):
                hint = Message(
                    "where laws make [[names]] periodic: mbsym floquet [[file]]", names=", ".join(led), file=FILE
                )
            elif not _drifting(analysis, linear):
                hint = Message("[[hint]]; where it is periodic in time: mbsym floquet [[file]]", hint=hint, file=FILE)
        why = NoResult(linear.time_dependence, hint, "time-dependent", "time-dependent")
        raise Unavailable("autonomous", why)
    return linear


def _drifting(analysis: Analysis, linear: Linearisation) -> bool:
    """Whether coefficients vary with time other than through sines and cosines, so that they are not periodic."""
    return any(
        _unbounded(analysis.ring, entry.value.polynomial, name) for entry in linear.varying for name in entry.among
    )


def judgeable(analysis: Analysis) -> Linearisation:
    """The first approximation where its roots say something about the motion, which problem 6 needs.

    Lyapunov's theorems ask of the terms of higher order that they are small **at all times alike**: with roots to the
    left, x'' + x' + x = x^3 exp(10 t) is unstable.  And in tau = w t with w < 0 what decays grows.  Raises Unavailable
    where time occurs in the nonlinear equations other than under sines and cosines, or w is not known to be positive
    and the spectrum is not symmetric (it is where D = N = 0 or D = G = 0).
    """
    linear = analysis.autonomous
    scale = linear.time_scale
    symmetric = _vanish(linear.D, linear.N) or _vanish(linear.D, linear.G)
    if scale is not None and not symmetric and analysis.signs.sign(scale.polynomial) != "positive":
        reason = Message(
            "the rate of dimensionless time, [[scale]], is not known to be positive: tau may run backwards", scale=scale
        )
        hint = "declare it positive, or leave 'dimensionless time' out"
        raise Unavailable("stability", NoResult(reason, hint, "time may run backwards", "time-scale-sign"))
    growing = _growing(analysis)
    if growing:
        reason = Message(
            "the equations may vary with [[names]] otherwise than by sines and cosines, and terms of higher order are "
            "not known to be small at all times alike; no theorem about the first approximation applies",
            names=", ".join(growing),
        )
        raise Unavailable("stability", NoResult(reason, "", "time-dependent", "time-dependent"))
    return linear


def judgeable_with_zeros(system: System, vanishing: Sequence[str]) -> tuple[str, ...]:
    """Of parameters, those that have to be 0 identically for problem 6 to judge; none where it does, or still does not.

    A relation says so, where a value is but one of many.
    """
    from mbsym.analysis.pipeline import Analysis

    def judged(zeros: Sequence[str]) -> bool:
        held = (*system.relations, *(Relation(name, number(0)) for name in zeros))
        try:
            Analysis(replace(system, relations=held), ()).judgeable  # noqa: B018
        except NOT_THERE:
            return False
        return True

    needed = [*vanishing]
    if judged([]) or not judged(needed):
        return ()
    for name in vanishing:
        if judged([other for other in needed if other != name]):
            needed.remove(name)
    return tuple(needed)


def _vanish(*matrices: Matrix) -> bool:
    return all(x.is_zero() for matrix in matrices for row in matrix.polynomials for x in row)


def _growing(analysis: Analysis) -> tuple[str, ...]:
    """What grows with time and stands in the nonlinear equations outside of sines and cosines.

    The equations are asked for only where a formula of the description holds such a quantity other than in an angle.
    """
    system = analysis.system
    names = (*turning(analysis.parameters_scene), *(item.name for item in system.prescribed), "t")
    rates_declared = True
    if system.constraints:
        from mbsym.mechanics.constraints.rows import said_rows  # most systems have none

        running = analysis.reduced.expansion.base.turning
        rates_declared = running <= {*names}  # the rates of all that runs are the description's
        names = tuple(dict.fromkeys((*names, *sorted(running))))
        held = {name for x in expressions(system.constraints) for name in _outside(x)}
        if held & set(names):
            rows = [y for row in said_rows(analysis.scene) for y in (row.position, row.velocity, *row.partials) if y]
            if not rates_declared or not all(is_steady(analysis.scene, x) for x in rows):
                return tuple(name for name in names if name in held)
    angles = [angle for body in system.bodies for angle in body.rotation.angles]
    plain = [x for body in system.bodies for x in (*body.connection_point, *body.mass_centre)]
    outside = {name for x in (*plain, *expressions(system.loads)) for name in _outside(x)}
    outside |= {name for x in angles if linear_form(x) is None for name in _outside(x)}
    suspects = tuple(name for name in names if name in outside)
    equations = analysis.optional("equations") if suspects else None
    if equations is None:
        return suspects
    entries = [x.polynomial for x in equations.forcing]
    entries += [x for row in equations.mass_matrix.polynomials for x in row]
    if rates_declared and all(is_steady(analysis.scene, x) for x in entries):
        return ()  # they know q - v t alone: deviations do not know the time
    return tuple(name for name in suspects if any(_unbounded(analysis.ring, x, name) for x in entries))


def _outside(expression: Expression) -> set[str]:
    """The names that occur other than in a linear form under a sine or cosine."""
    if isinstance(expression, Name):
        return {expression.name}
    if isinstance(expression, Call) and expression.function in ("sin", "cos") and linear_form(expression.argument):
        return set()
    return {name for child in children(expression) for name in _outside(child)}


def _unbounded(ring: Ring, x: Polynomial, name: str) -> bool:
    """Whether a quantity that grows with time occurs in x, or in what is adjoined to it, but for sines and cosines."""
    held = [ring.generators[k] for k, degree in enumerate(x.degrees()) if degree > 0]
    if any(g.argument is None and g.kind in ("coordinate", "prescribed", "time") and g.name == name for g in held):
        return True
    deeper = [g.argument for g in held if g.argument is not None and g.kind not in ("sine", "cosine")]
    return any(_unbounded(ring, argument, name) for argument in deeper)


def steady_order(analysis: Analysis) -> str:
    """A hint at the rotation sequence in which the first approximation is steady; "" where none is known."""
    if not analysis.suggests:
        return ""
    for other in rotation_orders(analysis.system):
        try:
            type(analysis)(other.system, (), analysis.terms, suggests=False).autonomous  # noqa: B018
        except Failure:
            continue
        axes, angles = ", ".join(map(str, other.axes)), ", ".join(other.angles)
        order = f"rotation: {{axes: [{axes}], angles: [{angles}]}}"
        return Message(
            "with '[[order]]' of body '[[body]]' the coefficients are constant", order=order, body=other.body
        )
    return ""


#: Bits in which generic numbers are told from zero.
BITS = 128


def regular_at_zero(system: System) -> bool:
    """False where a formula of the bodies or loads is singular with all coordinates and velocities zero."""
    moving = {*system.coordinates, *system.velocities}
    suspects = [
        part
        for whole in expressions((system.bodies, system.loads))
        for part in _vanishing(whole)
        if not moving.isdisjoint(names(part))
    ]
    with ctx.workprec(BITS):
        return all(_differs_from_zero(part, moving) for part in suspects)


def _vanishing(expression: Expression) -> Iterator[Expression]:
    """Denominators, radicands, and bases of powers that are not whole positive ones."""
    for node in walk(expression):
        if isinstance(node, Operation) and node.operator == "/":
            yield node.right
        elif isinstance(node, Operation) and node.operator == "**" and not _whole(node.right):
            yield node.left
        elif isinstance(node, Call) and node.function in ("sqrt", "log"):
            yield node.argument


def _whole(exponent: Expression) -> bool:
    return isinstance(exponent, Number) and exponent.value.denominator == 1 and exponent.value >= 0


def _differs_from_zero(part: Expression, moving: set[str]) -> bool:
    values = {"pi": arb.pi()}
    for place, name in enumerate(sorted(names(part) - {"pi"})):
        values[name] = arb(0) if name in moving else arb(fmpq(1_000_003 + 7_919 * place, 999_983))
    try:
        value = Lowering(Balls(values), values)(part)
    except Failure:
        return False
    return bool(value.is_finite()) and not value.contains(0)


def refuse_unsolved(found: Equilibrium) -> None:
    """Raises Unavailable where the motion exists under conditions that no parameters were solved for."""
    if len(found.conditions) > len(found.solved):
        reason = "the motion exists under conditions that were not solved: parameters are not independent then"
        raise Unavailable("conditions", NoResult(reason, "see problem 4", "conditions", "unsolved-conditions"))
