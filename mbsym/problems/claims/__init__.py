"""Claims: is what somebody printed right?

A claim says "quantity = formula".  The quantity is derived, the formula is read as it was printed, and

    difference = claimed - derived

is decided in the exact ring: the claim holds exactly (the difference is zero), on the relations between parameters,
with the same equations of motion (Lagrangians that differ by dF(q, t)/dt, the kernel of the Euler-Lagrange operator),
or it differs by exactly this.  A difference is split into products of velocities, and where a publication's
abbreviations were declared, those that explain a part are named: a part that *is* an abbreviation, or an abbreviation
that would be right with something added.

What only has to vanish (an equation of motion, a characteristic polynomial) may be multiplied by anything that is not
zero: it holds up to a factor.  Where it does not, it is compared with that multiple of the derived one that agrees with
it in most places, so that the difference is what is wrong:  claimed - factor*derived.  An equation of motion holds on
every motion, too, if it is a combination of the equations (solved for an acceleration, a sum): which one is said
(``equations``).  Of every other quantity a factor is an error, and it differs by the factor.

A first integral I is decided by dI/dt = 0 on the equations of motion; one that fails is told its dI/dt, with q''
replaced by M^-1 f, and a state where this is not zero.  A condition of stability that is to be *necessary* (key 'as')
is proved where the conditions of problem 6 imply it, and the remark says for what it is needed; *sufficient* ones of
one place count together, and are proved where they decide the cases of problem 6.  Without 'as' it is one of the
conditions of problem 6, with its relation, or a necessary one.  It is refuted by parameters at which the motion is
stable without it, or, as sufficient, unstable with it, both exactly; what is neither is undecided.  Where only cases
of equality are open, it holds "but for border cases".  A number at a state is compared by rigorous balls with the
digits that were printed: 1.234 means 1.234 +- 0.0005 (0 means nothing but zero), unless 'tolerance' or 'digits' says
how exact it is meant.  A number of 15 to 17 digits may come from double precision: what the rounding of doubles can
explain, in evaluating this very quantity, is not held against it, and is told.

What is claimed of an expansion in a small parameter is compared coefficient by coefficient with problem 12, in the
symbols of its solution; a difference that another amplitude, other constants or another phase can explain leaves the
claim undecided.

Under roots of squares signs matter: sqrt(r**2) is r for r > 0 only.  What holds only for positive coordinates and
parameters (those whose sign is not declared) is said to hold for these.
"""

from __future__ import annotations

from mbsym.model.claims import CLAIMS, Claim
from mbsym.problems.claims.comparison import examined_formula
from mbsym.problems.claims.conditions import examined_condition
from mbsym.problems.claims.equations import examined_equation
from mbsym.problems.claims.integrals import examined_integral
from mbsym.problems.claims.numbers import examined_number
from mbsym.problems.claims.quantities import derived_quantity, with_momenta
from mbsym.problems.claims.result import (
    ClaimResult,
    Derived,
    Outcome,
    Part,
    in_parameters,
    scene_of_claims,
    title,
    undecided,
)
from mbsym.problems.claims.symbols import Symbols


def examine(derived: Derived, claim: Claim) -> ClaimResult:
    """One claim against what is derived.

    Raises NoClosedForm, NotRational or SingularPoint (and what ``derived`` raises) where it cannot be decided.
    """
    about = title(claim, derived.system)
    if CLAIMS[claim.kind].order:
        from mbsym.problems.claims import oscillations  # few claims are about expansions

        return oscillations.examined(derived, claim, about)
    if claim.kind in ("normal form determinant", "lyapunov coefficient"):
        from mbsym.problems.claims import normal_forms  # few claims are about terms of higher order

        return normal_forms.examined(derived, claim, about)
    if derived.system.constraints:
        from mbsym.problems.claims import constrained  # most systems have no constraints

        return constrained.examined(derived, claim, about)
    if derived.system.speeds and not claim.is_numerical:
        from mbsym.problems.claims import in_speeds  # few systems have speeds of their own

        return in_speeds.examined(derived, claim, about)
    if claim.is_numerical:
        return examined_number(derived, claim, about)
    if claim.right is not None:
        return examined_condition(derived, claim, about)
    symbols = Symbols.of(derived)
    scene = scene_of_claims(derived)
    with_momenta(derived, scene, symbols)
    claimed = symbols.polynomial(scene, claim)
    if claim.kind == "first integral":
        return examined_integral(derived, claim, about, in_parameters(derived, claimed))
    result = examined_formula(derived, claim, about, symbols, claimed, derived_quantity(derived, claim))
    if claim.kind == "equation of motion":
        return examined_equation(derived, result, symbols, claimed)
    return result
