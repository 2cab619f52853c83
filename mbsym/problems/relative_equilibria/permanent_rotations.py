"""Permanent rotations: steady turns of a body about a fixed direction, at every rate that is possible.

Three turns bring the body's axes from those that it hangs on; the first is about a fixed axis, and its angle is cyclic
(gravity along that axis).  With g the unit vector of the axis in the body, the body may keep turning about it at the
rate Omega if and only if the moment in its own axes vanishes,

    a(g) + Omega b(g) + Omega^2 c(g) = 0,       |g| = 1.

For a heavy body with the mass centre r (in the axes of the moments of inertia I):  a = m G (g x r) where gravity pulls
along -g, b = 0, c = I g x g.  The angle is cyclic, so a, b and c are at right angles to g, and with

    a x c = K_ac g,   a x b = K_ab g,   b x c = K_bc g                   on the sphere

K_ac(g) = 0 is necessary if b = 0: Staude's cone, (g x I g) . r = 0 (O. Staude, J. reine angew. Math. 113, 1894), with
Omega^2 from any component of  Omega^2 c = -a.  Where b is not 0 (a gyrostat), K_ac^2 = K_ab K_bc is necessary.

a, b, c follow from the moments at the rates 0, 1, -1; those at 2 and -3 check them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from mbsym.algebra.factors import irreducible_factors
from mbsym.algebra.failures import Failure
from mbsym.expressions.tree import ZERO, number
from mbsym.mechanics.charts import Joint, charts, moment_components
from mbsym.mechanics.rest import Value, at_numbers, rest
from mbsym.model.system import MotionEntry, System
from mbsym.problems.relative_equilibria.oriented import Choice, Cosines

#: The rates at which moments are taken, and those at which the result is checked.
RATES, CHECKED = (0, 1, -1), (2, -3)

Polynomial = fmpq_mpoly
_CONTEXT = fmpq_mpoly_ctx.get(["g1", "g2", "g3"], Ordering.degrevlex)


@dataclass(frozen=True)
class PermanentRotations:
    """The axes and rates at which ``body`` may keep turning about the axis of ``angle``.

    ``constant``, ``linear``, ``quadratic``: multiples of a, b, c in g1, g2, g3, a common one for each component:
    constant + rate linear + rate^2 quadratic = 0  in each component is necessary and sufficient.
    ``axes``: the irreducible factors of the polynomial that has to vanish (K_ac, or K_ac^2 - K_ab K_bc), without those
    on which c vanishes, where axes need a = 0 besides; none where there is no such polynomial, or where it vanishes
    ``everywhere``.
    ``family``: it is proved that these axes are curves of the sphere with real rates: b = 0, every factor changes its
    sign on the sphere, and ``either``.
    ``either``: if b = K_ac = 0 and neither a nor c vanishes at g, then exactly one of g and -g carries a rotation.
    """

    body: str
    angle: str
    axes: tuple[str, ...]
    everywhere: bool
    family: bool
    either: bool
    constant: tuple[str, ...]
    linear: tuple[str, ...]
    quadratic: tuple[str, ...]

    @property
    def components(self) -> list[tuple[str, str, str]]:
        """Constant, linear and quadratic part of each component."""
        return list(zip(self.constant, self.linear, self.quadratic, strict=True))

    @property
    def loaded(self) -> bool:
        """Whether something acts on the body at rest."""
        return any(x != "0" for x in self.constant)

    @property
    def gyrostatic(self) -> bool:
        """Whether something acts that is linear in the rate."""
        return any(x != "0" for x in self.linear)

    @property
    def inertial(self) -> bool:
        """Whether something acts that is quadratic in the rate."""
        return any(x != "0" for x in self.quadratic)


def permanent_rotations(system: System, values: Mapping[str, Value]) -> PermanentRotations | None:
    """The permanent rotations of a single body with three angles at numbers, whatever rates the description gives.

    None where the system is not one: other coordinates, prescribed motions, no cyclic first angle, or moments that are
    no polynomials of degree 3 or less in g and of degree 2 in Omega.  Raises KeyError for a missing value.
    """
    if len(system.coordinates) != 3 or system.prescribed or system.constraints:
        return None
    try:
        still = replace(at_numbers(system, values), motion=())
        chart = charts(rest(still))[0]
        if len(chart.joints) != 1 or not chart.joints[0].first_free or len(chart.joints[0].angles) != 3:
            return None
        joint = replace(chart.joints[0], last_free=False)  # the axes of the body will do, whatever it is free to do
        moments = {rate: _moment(chart.rest.system, joint, rate) for rate in (*RATES, *CHECKED)}
    except Failure:
        return None
    known = {rate: x for rate, x in moments.items() if x is not None}
    if len(known) < len(moments):
        return None
    a = known[0]
    b = tuple((x - y) / 2 for x, y in zip(known[1], known[-1], strict=True))
    c = tuple((x + y) / 2 - z for x, y, z in zip(known[1], known[-1], a, strict=True))
    for rate in CHECKED:
        if any(x + y * rate + z * rate**2 != w for x, y, z, w in zip(a, b, c, known[rate], strict=True)):
            return None
    even = [_homogeneous(x) for x in (*a, *b, *c)]
    whole = [x for x in even if x is not None]
    return _told(joint, whole[:3], whole[3:6], whole[6:]) if len(whole) == len(even) else None


def _moment(still: System, joint: Joint, rate: int) -> tuple[Polynomial, ...] | None:
    """The components in the body's axes as polynomials in g, the same for equal functions on the sphere."""
    turning = MotionEntry(joint.angles[0], ZERO, number(Fraction(rate)))
    steady = rest(replace(still, motion=(turning,) if rate else ()))
    components, _ = moment_components(steady, joint)
    column = joint.axes[0] - 1
    cosines = Cosines(steady, joint, Choice((tuple((k, column) for k in range(3)),)))
    if len(components) != 3 or any(x is None for x in components):
        return None
    # Written in the entries of one column, they do not depend on the angle about it.
    written = cosines.written([x for x in components if x is not None])
    if written is None:
        return None
    result = []
    for pairs in written:
        terms = {}
        for exponents, rest_of in pairs:
            if len(rest_of) != 1 or any(e for m in rest_of for e in m):
                return None
            terms[exponents] = next(iter(rest_of.values()))
        result.append(_CONTEXT.from_dict(terms))
    return tuple(result)


def _homogeneous(x: Polynomial) -> Polynomial | None:
    """The same on the unit sphere, each term of the highest degree; None where odd and even degrees mix."""
    if x.is_zero():
        return x
    top = x.total_degree()
    total = _CONTEXT.constant(0)
    for monomial, coefficient in x.terms():
        missing = top - sum(map(int, monomial))
        if missing % 2:
            return None
        total += _CONTEXT.from_dict({monomial: coefficient}) * _square() ** (missing // 2)
    return total


def _told(
    joint: Joint, a: Sequence[Polynomial], b: Sequence[Polynomial], c: Sequence[Polynomial]
) -> PermanentRotations | None:
    ac, ab, bc = _along(a, c), _along(a, b), _along(b, c)
    if ac is None or ab is None or bc is None:
        return None
    acts = [any(not x.is_zero() for x in part) for part in (a, b, c)]
    axes = ac * ac - _raised(ab * bc, ac * ac) if acts[1] else ac
    both_act = acts[0] and acts[2]
    factors = [] if axes.is_zero() or not both_act else [x for x, _ in irreducible_factors(axes)[1]]
    factors = [x for x in factors if not all(_divides(x, y) for y in c)]
    rows: list[list[str]] = [[], [], []]
    for triple in zip(a, b, c, strict=True):
        common = math.lcm(*(int(k.q) for x in triple for k in x.coeffs()))
        content = math.gcd(*(int((k * common).p) for x in triple for k in x.coeffs())) or 1
        for x, row in zip(triple, rows, strict=True):
            row.append(_text(x * fmpq(common, content)))
    odd_and_even = {(_parity(x), _parity(y)) for x in a for y in c if not x.is_zero() and not y.is_zero()}
    either = not acts[1] and bool(odd_and_even) and all(p != q for p, q in odd_and_even)
    return PermanentRotations(
        joint.body,
        joint.angles[0],
        tuple(map(_text, factors)),
        both_act and axes.is_zero(),
        either and bool(factors) and all(_changes_sign(x) for x in factors),
        either,
        tuple(rows[0]),
        tuple(rows[1]),
        tuple(rows[2]),
    )


def _divides(x: Polynomial, y: Polynomial) -> bool:
    return bool(divmod(y, x)[1].is_zero())


def _raised(x: Polynomial, like: Polynomial) -> Polynomial:
    """x times (g.g)^k, of the degree of ``like`` where that can be had: the same on the sphere."""
    missing = 0 if x.is_zero() or like.is_zero() else int(like.total_degree()) - int(x.total_degree())
    return x * _square() ** (missing // 2) if missing > 0 and missing % 2 == 0 else x


def _changes_sign(x: Polynomial) -> bool:
    """Whether it is positive at a rational point of the unit sphere and negative at another."""
    numbers = [fmpq(k, 3) for k in range(-7, 8)]
    signs = set()
    for p, q in product(numbers, repeat=2):  # stereographic projection
        size = p * p + q * q + 1
        value = x(2 * p / size, 2 * q / size, (size - 2) / size)
        signs |= {value > 0} if value != 0 else set()
    return len(signs) == 2


def _along(x: Sequence[Polynomial], y: Sequence[Polynomial]) -> Polynomial | None:
    """K with  x x y = K g  (g not of length 1: an identity of homogeneous polynomials), or None."""
    polynomial: Polynomial | None = None
    for k, g in enumerate(_CONTEXT.gens()):
        i, j = (k + 1) % 3, (k + 2) % 3
        product = x[i] * y[j] - x[j] * y[i]
        quotient, left = divmod(product, g)
        if not left.is_zero() or (polynomial is not None and quotient != polynomial):
            return None
        polynomial = quotient
    return polynomial


def _text(x: Polynomial) -> str:
    return str(x).replace("^", "**")


def _square() -> Polynomial:
    return sum((g * g for g in _CONTEXT.gens()), _CONTEXT.constant(0))


def _parity(x: Polynomial) -> int:
    return int(x.total_degree()) % 2
