"""The Taylor field about the unperturbed motion as a polynomial vector field over the parameters:

    x' = v,      v' = a_1(x, v) + a_2(x, v) + ... + a_N(x, v),

terms of higher order dropped.  Coefficients are rational functions of the parameters, brought over one denominator.
"""

from __future__ import annotations

from flint import Ordering, fmpq_mpoly_ctx

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.polynomial_field import PolynomialField, in_lowest_terms
from mbsym.algebra.tower import MOST_ROOTS, Tower
from mbsym.model.system import velocity_name
from mbsym.problems.normal_forms.dissipative import state_field
from mbsym.problems.normal_forms.exact import occurring_parameters, over_tower
from mbsym.problems.normal_forms.expansion import Expansion


def taylor_field(found: Expansion, order: int = 3) -> PolynomialField:
    """The field in the deviations of the coordinates that are not cyclic, and of all velocities, up to ``order``.

    The Lagrangian is expanded to one order more.

    Variables are named like what deviates: ``theta``, ``theta_dot``.  Raises NoClosedForm where coefficients hold
    square roots or functions of parameters, SingularPoint where det M = 0 on the motion.
    """
    tower = Tower(occurring_parameters(found))
    rows, positions = state_field(over_tower(found, tower, {}), order)
    if tower.squares:
        raise NoClosedForm("coefficients of the Taylor field hold square roots")
    variables = (*positions, *(velocity_name(name) for name in found.coordinates))
    context = fmpq_mpoly_ctx.get([*tower.parameters, *variables], Ordering.degrevlex)
    images = [context.constant(0)] * MOST_ROOTS + [context.gen(k) for k in range(len(tower.parameters))]
    common = context.constant(1)
    entries = []
    for row in rows:
        terms = []
        for key, value in row.coefficients.items():
            product = context.term(exp_vec=(*(0 for _ in tower.parameters), *key))
            top, bottom = (x.compose(*images, ctx=context) for x in (value.top, value.bottom))
            common = common * (bottom / common.gcd(bottom))
            terms.append((product * top, bottom))
        entries.append(terms)
    numerators = [sum((top * (common / bottom) for top, bottom in terms), context.constant(0)) for terms in entries]
    shared, denominator = in_lowest_terms(numerators, common)
    return PolynomialField(context, tower.parameters, variables, tuple(shared), denominator)
