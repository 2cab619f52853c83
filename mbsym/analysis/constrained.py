"""Equations and integrals in the pipeline, with constraints or without; what constraints are, and their second routes.

The modules that know how are imported when a system has constraints; most have none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.rationals import fraction
from mbsym.expressions.tree import (
    ZERO,
    Call,
    Expression,
    Name,
    add,
    divide,
    is_number,
    multiply,
    negative,
    number,
    power,
    sign_by_structure,
    subtract,
)
from mbsym.model.constraints import Relation, is_holonomic
from mbsym.model.substitution import told_by, without_explicit_relations
from mbsym.model.system import Prescribed
from mbsym.problems import equations, perturbation
from mbsym.problems.checks import Check
from mbsym.problems.constraints.result import Constraints
from mbsym.problems.equations import Equations

if TYPE_CHECKING:
    from mbsym.algebra.ring import Polynomial, Ring
    from mbsym.analysis.pipeline import Analysis
    from mbsym.mechanics.constraints.programs import ConstrainedPrograms
    from mbsym.mechanics.states import Oracles
    from mbsym.model.system import System
    from mbsym.problems.integrals import Integral
    from mbsym.problems.reactions import Reaction

#: The checks of what only constrained systems have.
CHECKS = ("constraints", "constrained motion")

#: The check of what joints transmit, with constraints or without.
REACTIONS = "reactions"


def in_free_coordinates(system: System) -> System:
    """The same motions in the coordinates that explicit relations leave, with the constraints that are left.

    None are where nothing else is tied.  Speeds of its own keep a system as it is.
    """
    if system.speeds or not any(isinstance(constraint, Relation) for constraint in system.constraints):
        return system
    from mbsym.mechanics.constraints.rows import said_rows
    from mbsym.mechanics.kinematics import over_ring
    from mbsym.mechanics.variables import ring_of

    free = without_explicit_relations(system)
    if len(free.constraints) == len(system.constraints):  # nothing is put in
        return free
    tied = free.constraints and said_rows(over_ring(free, ring_of(free)))
    return free if tied else replace(free, constraints=())  # rows that say 0 = 0 followed from what is put in


def on_a_plane(analysis: Analysis) -> System | None:
    """The motions near a rest q_0 in fewer coordinates, where they stay on a plane; None where that is not shown.

    Holonomic rows f(q) = 0 of constant rank at q_0 leave a manifold.  It is the plane  J(q_0) (q - q_0) = 0  where f
    vanishes on that plane: in a parallelogram, say, q_2 - q_2(0) = -(q_1 - q_1(0)).  J(q_0) has to have a kernel of
    numbers.
    """
    from mbsym.algebra.kernel import kernel
    from mbsym.mechanics.constraints.rows import said_rows
    from mbsym.mechanics.kinematics import over_ring
    from mbsym.mechanics.motion import motion_values, relations, unperturbed_with
    from mbsym.mechanics.variables import ring_of

    system, ring = analysis.system, analysis.ring
    if system.speeds or not system.constraints or not all(map(is_holonomic, system.constraints)):
        return None
    for x in (x.polynomial for x in analysis.reduced.about.assumed):
        constant = not any(ring.generators[k].name in system.parameter_names for k in ring.held([x]))
        if not ((constant and ring.is_zero(x) is False) or analysis.signs.never_zero(x)):
            return None
    place = unperturbed_with(analysis.scene, relations(analysis.scene))
    rows = said_rows(analysis.scene)
    found = kernel(ring, *([ring.reduce(ring.substitute(x, place)) for x in row.partials] for row in rows))
    rational = all(x.is_constant() for vector in found for x in vector.values())
    if not (found and rational and len(found) == len(analysis.reduced.about.about)):
        return None
    names, start, plane = system.coordinates, motion_values(system), system
    free = {max(vector): {k: fraction(x.leading_coefficient()) for k, x in vector.items()} for vector in found}
    for i in (k for k in range(len(names)) if k not in free):
        value = start[names[i]][0]
        for k, vector in free.items():
            share = number(vector.get(i, Fraction(0)) / vector[k])
            value = add(value, multiply(share, subtract(Name(names[k]), start[names[k]][0])))
        plane = told_by(plane, names[i], value)
    return None if said_rows(over_ring(plane, ring_of(plane))) else replace(plane, constraints=())


def with_runs_prescribed(system: System) -> System:
    """The same motions where constraints  sum c_i q_i' = w != 0  of constant c, w are put in, each of one row.

    One of these coordinates is  q_s = q_s(0) - sum c_i (q_i - q_i(0))/c_s + P,  P prescribed with the rate w/c_s.
    """
    from mbsym.mechanics.constraints.rows import joined_rows, said_rows
    from mbsym.mechanics.kinematics import over_ring
    from mbsym.mechanics.motion import motion_values
    from mbsym.mechanics.variables import ring_of

    ring = ring_of(system)
    signs = {parameter.name: parameter.sign for parameter in system.parameters}
    rows = joined_rows(ring, said_rows(over_ring(system, ring)))
    for k, constraint in enumerate(system.constraints):
        own = [row for row in rows if row.name.constraint == k]
        if len(own) != 1:
            continue
        slopes = [x for slope in own[0].partials if (x := in_parameters(ring, slope)) is not None]
        shift = in_parameters(ring, ring.at_rest(own[0].velocity))
        if shift is None or is_number(shift, 0) or len(slopes) < len(system.coordinates):
            continue
        by_name = {name: x for name, x in zip(system.coordinates, slopes, strict=True) if not is_number(x, 0)}
        name = next((x for x in reversed(by_name) if sign_by_structure(by_name[x], signs) is not None), None)
        if name is None:
            continue
        start, run = motion_values(system), f"{name}{_RUN}"
        value = add(start[name][0], Name(run))
        for other, x in by_name.items():
            if other != name:
                moved = subtract(Name(other), start[other][0])
                value = subtract(value, multiply(divide(x, by_name[name]), moved))
        prescribed = (*system.prescribed, Prescribed(run, negative(divide(shift, by_name[name]))))
        others = tuple(x for x in system.constraints if x is not constraint)
        return with_runs_prescribed(told_by(replace(system, constraints=others, prescribed=prescribed), name, value))
    return system


#: How names of what is prescribed end that takes the place of a coordinate; no description can use these.
_RUN = "_dot_run"


def in_parameters(ring: Ring, x: Polynomial) -> Expression | None:
    """A polynomial in parameters, and in square roots of such, as an expression; None of others."""
    total: Expression = ZERO
    for exponents, c in x.to_dict().items():
        term: Expression = number(Fraction(int(c.p), int(c.q)))
        for g, exponent in zip(ring.generators, exponents, strict=True):
            if not exponent:
                continue
            inside = in_parameters(ring, g.argument) if g.kind == "root" else None
            if inside is None and g.kind != "parameter":
                return None
            base = Name(g.name) if inside is None else Call("sqrt", inside)
            term = multiply(term, power(base, number(int(exponent))))
        total = add(total, term)
    return total


def constraints_of(analysis: Analysis) -> Constraints:
    """The rows, their ranks and what they leave free."""
    system, form = analysis.system, analysis.form
    if not system.constraints:
        names = tuple(u.name for u in form.speeds) if system.speeds else system.coordinates
        return Constraints.none(analysis.ring, names, in_speeds=bool(system.speeds))
    from mbsym.problems.constraints.analysis import constraints, constraints_in_speeds

    if not system.speeds:
        return constraints(analysis.scene)
    return constraints_in_speeds(form, analysis.scene, analysis.tied_in_coordinates, analysis.tied_programs)


def constraints_in_coordinates(analysis: Analysis) -> Constraints:
    """The same in generalised velocities, where speeds are declared: ranks and integrability are found there."""
    from mbsym.mechanics.kinematics import over_ring
    from mbsym.problems.constraints.analysis import constraints

    plain = analysis.system.without_speeds
    return constraints(over_ring(plain, analysis.ring))


def equations_of(analysis: Analysis) -> Equations:
    """Lagrange's equations or, in speeds, Kane's.

    With constraints these are the equations of the open tree, and beside them those without multipliers if they are not
    too long.
    """
    tied = analysis.constraints
    if analysis.system.speeds:
        from mbsym.problems import in_speeds

        rows = [*tied.velocity, *(f for f in tied.position if f is not None)]
        tree: Equations = in_speeds.equations(analysis.form, analysis.scene, [x.polynomial for x in rows])
    else:
        tree = equations.equations(analysis.scene, analysis.energy)
    if not tied.names:
        return tree
    from mbsym.problems.constraints.motion import embedded_equations

    try:
        embedded = embedded_equations(analysis.form, tree, tied)
    except NoClosedForm:
        embedded = None
    return replace(tree, constraints=tied, embedded=embedded)


def programs_of(analysis: Analysis) -> ConstrainedPrograms:
    """M, f and the rows as straight-line code, in coordinates."""
    from mbsym.mechanics.constraints.programs import ConstrainedPrograms, constrained_programs

    if not analysis.system.constraints:
        return ConstrainedPrograms(analysis.programs, (), (), (), (), ())
    tied = analysis.tied_in_coordinates if analysis.system.speeds else analysis.constraints
    components = [(name.constraint, name.component) for name in tied.names]
    return constrained_programs(analysis.system.without_speeds, analysis.ring, components)


def rows_check(analysis: Analysis) -> Check | None:
    """The rows against places in inertial axes."""
    constraints = analysis.optional("constraints")
    if constraints is None or not constraints.names:
        return None
    from mbsym.problems.constraints.checks import check_rows

    return check_rows(analysis.form, constraints, analysis.tied_programs)


def motion_check(analysis: Analysis) -> Check | None:
    """The embedded equations against d'Alembert's principle on the constraint manifold."""
    closed = analysis.optional("equations") if analysis.system.constraints else None
    if closed is None or closed.embedded is None:
        return None
    from mbsym.problems.constraints.checks import check_embedded

    return check_embedded(analysis.form, closed.constraints, closed.embedded, analysis.tied_programs)


def integrals_of(analysis: Analysis) -> tuple[Integral, ...]:
    """What the motion keeps, with constraints or in speeds."""
    from mbsym.problems.constraints.integrals import integrals

    return integrals(analysis.form, analysis.scene, analysis.energy, analysis.equations, analysis.tied_programs)


def integrals_check(analysis: Analysis, integrals: Sequence[Integral], truth: Oracles | None = None) -> Check:
    """Their rates along the motion: at states of ``truth``, or such that keep the constraints."""
    if not analysis.system.constraints:
        return perturbation.check_integrals(truth or analysis.oracles, analysis.programs, integrals)
    from mbsym.problems.constraints.checks import check_integrals

    return check_integrals(analysis.form, integrals, analysis.constraints, analysis.tied_programs)


def reactions_of(analysis: Analysis) -> tuple[Reaction, ...]:
    """Forces and moments in the joints that the description names; none where it names none."""
    if not analysis.system.reactions:
        return ()
    from mbsym.problems.reactions import reactions

    return reactions(analysis.scene, analysis.constraints, analysis.tied_programs)


def reactions_check(analysis: Analysis) -> Check | None:
    """Against what the released joints would have to be held with."""
    reactions = analysis.optional("reactions") if analysis.system.reactions else None
    if not reactions:
        return None
    from mbsym.problems.reactions import check_reactions

    return check_reactions(analysis.oracles, reactions, analysis.constraints, analysis.tied_programs)
