"""Trim: which values of inputs or parameters make the described motion one that satisfies the equations.

The residuals of problem 4 on the motion, under constraints those of the constraints and the projected equations, are

    r = R x + s = 0,        R and s without x

for unknowns x that enter linearly: forces, torques, preloads, masses.  R is brought to echelon form; what is left of s
in rows without a pivot is a condition on the motion itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.signs import ANY, SIGN_SETS, SIGN_WORDS, Signs
from mbsym.formulas.formula import Formula, Shown
from mbsym.mechanics.expansion import Row, echelon
from mbsym.mechanics.kinematics import Scene
from mbsym.model.assumptions import RELATION_OF_SIGN
from mbsym.problems.equilibrium import equilibrium, essential


@dataclass(frozen=True, repr=False)
class Trim(Shown):
    """``solved``: unknowns in terms of the ``free`` ones, which may have any value.

    So where none of ``assumed`` vanishes, all ``conditions`` do, and parameters have the signs that they are declared
    with: ``signed``, (name, value, relation to 0), where that does not go without saying.  ``impossible`` are those of
    all these that never hold.
    """

    solved: tuple[tuple[str, Formula], ...]
    free: tuple[str, ...]
    assumed: tuple[Formula, ...]
    conditions: tuple[Formula, ...]
    signed: tuple[tuple[str, Formula, str], ...]
    impossible: tuple[Formula, ...]


def trim(
    scene: Scene, residuals: Sequence[Polynomial], unknowns: Sequence[str], signs: Signs, assumed: Sequence[Polynomial]
) -> Trim:
    """The unknowns, parameters by their names, from the residuals of problem 4 on the motion.

    ``assumed`` were divided by where these were made.  Raises NoClosedForm where an unknown does not enter linearly.
    """
    ring = scene.ring
    with_unknowns = [x for x in residuals if _within(ring, x, unknowns)]
    posture = equilibrium(
        scene, [x for x in residuals if not any(x == y for y in with_unknowns)], signs, on_motion=True
    )
    images = posture.determined(scene)
    reduced = echelon(
        ring, signs, [_row(ring, ring.substitute(x, images), unknowns) for x in with_unknowns], range(len(unknowns))
    )
    left = [x for row in reduced.rest if (x := essential(scene, row.get(_REST, ring.zero), signs)) is not None]
    never = [x for x in left if x.is_constant() or signs.never_zero(x)]
    solved, signed = [], list[tuple[str, Formula, str]]()
    for k, row in sorted(reduced.pivots.items()):
        value = ring.zero - row.get(_REST, ring.zero)
        for j, name in enumerate(unknowns):
            if j != k and j in row:
                value = value - ring.times(row[j], ring.generator("parameter", name))
        value = ring.reduce(value)
        solved.append((unknowns[k], Formula(ring, _cleared(ring, value))))
        declared, known = (SIGN_SETS.get(signs.sign(x), ANY) for x in (ring.generator("parameter", unknowns[k]), value))
        if not known <= declared:
            signed.append((*solved[-1], RELATION_OF_SIGN[SIGN_WORDS[declared]]))
            never += [value] if not known & declared else []
    divided = [ring.substitute(x, images) for x in (*assumed, *reduced.assumed)]
    divided = [x for y in divided if (x := essential(scene, y, signs)) is not None and not x.is_constant()]
    return Trim(
        tuple(solved),
        tuple(name for k, name in enumerate(unknowns) if k not in reduced.pivots),
        tuple(Formula(ring, x) for k, x in enumerate(divided) if x not in divided[:k] and not signs.never_zero(x)),
        (*posture.conditions, *(Formula(ring, x) for x in left)),
        tuple(signed),
        (*posture.impossible, *(Formula(ring, x) for x in never)),
    )


#: The column of what no unknown is a factor of.
_REST = -1


def _row(ring: Ring, x: Polynomial, unknowns: Sequence[str]) -> Row:
    places = [ring.index("parameter", name) for name in unknowns]
    row: Row = {j: x.derivative(k) for j, k in enumerate(places)}
    row[_REST] = x - sum((ring.times(row[j], ring.context.gen(k)) for j, k in enumerate(places)), ring.zero)
    for part in row.values():
        if names := _within(ring, part, unknowns):
            raise NoClosedForm("[[names]]: not linear in the equations", names=", ".join(names))
    return row


def _within(ring: Ring, x: Polynomial, names: Sequence[str]) -> list[str]:
    """Which parameters occur, be it under sine and cosine, roots and reciprocals."""
    held = (ring.generators[k] for k in ring.held([x]))
    parameters = {g.name for g in held if g.kind in ("parameter", "sine", "cosine")}
    return [name for name in names if name in parameters]


def _cleared(ring: Ring, x: Polynomial) -> Polynomial:
    """x with reciprocals of sums of reciprocals as plain fractions."""
    top, bottoms = ring.fraction(x)
    bottom = ring.one
    for factor, exponent in bottoms:
        above, below = ring.fraction(factor)
        bottom = ring.times(bottom, ring.power(above, exponent))
        for divisor, times in below:
            top = ring.times(top, ring.power(divisor, times * exponent))
    if not bottoms:
        return x
    return ring.ratio(ring.reduce(top), ring.reduce(bottom))
