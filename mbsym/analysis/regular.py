"""Whether the formulas of a description are regular at rest in the origin of its coordinates, before it is proposed.

A quotient, a root, a logarithm or a power that is no whole positive one has no second derivative where what stands in
it vanishes.  That is looked for with all coordinates and velocities zero and all else generic.
"""

from __future__ import annotations

from collections.abc import Iterator

from flint import arb, ctx, fmpq

from mbsym.algebra.base import Lowering
from mbsym.algebra.failures import Failure
from mbsym.algebra.point import Balls
from mbsym.expressions.tree import Call, Expression, Number, Operation, names, walk
from mbsym.mechanics.variables import expressions
from mbsym.model.system import System

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
