"""The motion does not know our coordinates: random systems, each described in several ways, are judged alike.

Carts on a line, pendulums on them (hanging or upright), springs, dampers and potentials between them, at rest.  What
is tried: linear changes of all coordinates, bodies in another order, parameters in other units, a coordinate told by a
constraint instead, with choices of ``dependent``.  Held against each other are the verdicts in symbols and at values,
the characteristic polynomials, and the exact verdicts at random parameters: the conditions as sets.

``MBSYM_INVARIANCE=1000`` tries more.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from fractions import Fraction
from random import Random

import pytest
from plain_vectors import inverse

import mbsym
from mbsym.analysis import Analysis
from mbsym.problems.stability.problem import ExactVerdicts

MANY = int(os.environ.get("MBSYM_INVARIANCE", "30"))
#: Random parameters at which the conditions are compared.
POINTS = 4

Row = tuple[int, ...]


@dataclass(frozen=True)
class Sketch:
    """Carts at u_0, u_1, ...; pendulums at angles u_k on some of them; loads in terms of u.

    ``change``: u = change q; ``order`` in which the bodies of the carts stand; ``units``: stiffnesses are k = units k'.
    """

    carts: int
    pendulums: tuple[tuple[int, bool], ...]  # (cart, upright)
    springs: tuple[tuple[str, Row], ...]  # (form, row): k*(row.u)**2/2 and the like
    dampers: tuple[Row, ...]
    change: tuple[Row, ...]
    order: tuple[int, ...]
    units: int = 1

    @property
    def size(self) -> int:
        return self.carts + len(self.pendulums)


def sketched(chance: Random) -> Sketch:
    carts = chance.randint(1, 3)
    pendulums = tuple((chance.randrange(carts), chance.random() < 0.3) for _ in range(chance.randint(0, 2)))
    size = carts + len(pendulums)

    def row(free: bool) -> Row:
        """Mostly a difference of carts: so that all may move on together."""
        found = [0] * size
        if carts > 1 and (free or chance.random() < 0.7):
            i, j = chance.sample(range(carts), 2)
            found[i], found[j] = 1, -1
        else:
            found[chance.randrange(size)] = 1
        return tuple(found)

    pinned = chance.random() < 0.3
    rows = [row(not pinned) for _ in range(chance.randint(0, carts))]
    periodic, others = "{k}*(1 - cos({x}))", ("{k}*({x})**2/2", "{k}*({x})**2/2 + {k}*({x})**4")
    springs = tuple((periodic if any(x[carts:]) else chance.choice((periodic, *others)), x) for x in rows)
    dampers = tuple(row(chance.random() < 0.5) for _ in range(chance.choice((0, 0, 1, 1, 2))))
    unit = tuple(tuple(int(i == j) for j in range(size)) for i in range(size))
    return Sketch(carts, pendulums, springs, dampers, unit, tuple(range(carts)))


def changed(one: Sketch, chance: Random) -> Sketch:
    """With an integer matrix of determinant 1."""
    rows = [list(row) for row in one.change]
    for _ in range(2 * one.size if one.size > 1 else 0):
        i, j = chance.sample(range(one.size), 2)
        sign = chance.choice((1, -1))
        rows[i] = [a + sign * b for a, b in zip(rows[i], rows[j], strict=True)]
    return replace(one, change=tuple(map(tuple, rows)))


def linear(row: Row, change: tuple[Row, ...], ending: str = "") -> str:
    """row . u, or its rate, in the coordinates q."""
    size = len(change)
    numbers = [sum(row[i] * change[i][j] for i in range(size)) for j in range(size)]
    return " + ".join(f"({x})*q{j}{ending}" for j, x in enumerate(numbers) if x) or "0"


def described(one: Sketch, extra: str = "") -> str:
    """The description; coordinates belong to the first body that knows them."""
    size = one.size
    units = [tuple(int(i == j) for j in range(size)) for i in range(size)]
    free = [f"q{j}" for j in range(size)]
    bodies = []

    def owned(text: str) -> str:
        own = [name for name in free if name in text]
        for name in own:
            free.remove(name)
        return ", ".join(own)

    for i in one.order:
        place = linear(units[i], one.change)
        bodies.append(
            f"- {{name: c{i}, attached to: 0, connection point: ['{place}', 0, 0], "
            f"coordinates: [{owned(place)}], mass: m{i}}}"
        )
    for k, (cart, _) in enumerate(one.pendulums):
        angle = linear(units[one.carts + k], one.change)
        bodies.append(
            f"- {{name: p{k}, attached to: c{cart}, rotation: {{axes: [3], angles: ['{angle}']}}, "
            f"coordinates: [{owned(angle)}], mass: m{one.carts + k}, mass centre: [0, -l, 0]}}"
        )
    loads = ["- uniform gravity: {vector: [0, -g, 0]}"] if one.pendulums else []
    for k, (form, row) in enumerate(one.springs):
        loads.append("- potential: " + form.format(k=f"{one.units}*k{k}", x=linear(row, one.change)))
    for k, row in enumerate(one.dampers):
        loads.append(f"- rayleigh: d{k}*({linear(row, one.change, '_dot')})**2/2")
    named = [f"m{i}" for i in range(size)] + ["l", "g"]
    named += [f"k{k}" for k in range(len(one.springs))] + [f"d{k}" for k in range(len(one.dampers))]
    parameters = ", ".join(f"{name}: {{positive: true, value: {value(name, one)}}}" for name in named)
    back = inverse(one.change)
    upright = [one.carts + k for k, (_, up) in enumerate(one.pendulums) if up]
    turns = [sum(back[j][i] for i in upright) for j in range(size)]
    motion = ", ".join(f"q{j}: {x}*pi" for j, x in enumerate(turns) if x)
    return "\n".join(
        (
            *("mbsym: 1", "name: Carts and pendulums", f"parameters: {{{parameters}}}", "bodies:"),
            *(f"  {x}" for x in bodies),
            *(["loads:", *(f"  {x}" for x in loads)] if loads else []),
            *(extra.splitlines() if extra else ()),
            f"motion: {{{motion}}}",
        )
    )


def value(name: str, one: Sketch) -> Fraction:
    """A number for a parameter; stiffnesses in other units are smaller numbers."""
    number = Fraction(1 + sum(map(ord, name)) % 7, 2 + sum(map(ord, name)) % 3)
    return number / one.units if name[0] == "k" else number


def polynomial(found: Analysis, values: dict[str, Fraction]) -> list[Fraction]:
    """The characteristic polynomial of the whole at values, the highest coefficient 1."""
    whole = [Fraction(1)]
    for part in found.stability.subsystems:
        own = [Fraction(str(x.subs(values))) for x in part.characteristic]
        whole = [
            sum((whole[k] * own[n - k] for k in range(len(whole)) if 0 <= n - k < len(own)), Fraction(0))
            for n in range(len(whole) + len(own) - 1)
        ]
    return [x / whole[-1] for x in whole]


def judged(found: Analysis, values: dict[str, Fraction]) -> tuple[object, ...]:
    """What must not depend on the description: word, word at values, polynomial there."""
    numerical = found.stability.numerical
    assert numerical is not None
    return found.stability.verdict.word, numerical.word, polynomial(found, values)


def exact(found: Analysis) -> ExactVerdicts:
    return ExactVerdicts(found.parameters_scene, found.balance, found.judgeable, found.equilibrium, found.signs)


def compared(first: Sketch, second: Sketch, extra: str, chance: Random) -> None:
    left, right = mbsym.loads(described(first), (4, 5, 6)), mbsym.loads(described(second, extra), (4, 5, 6))
    names = [parameter.name for parameter in left.system.parameters]
    scale = {name: second.units if name[0] == "k" else 1 for name in names}
    at = {name: value(name, first) for name in names}
    assert judged(left, at) == judged(right, {name: x / scale[name] for name, x in at.items()})
    one, other = exact(left), exact(right)
    for _ in range(POINTS):
        at = {name: Fraction(chance.randint(1, 30), chance.randint(1, 9)) for name in names}
        there = {name: x / scale[name] for name, x in at.items()}
        assert one(at).word is other(there).word


@pytest.mark.parametrize("seed", range(MANY))
def test_a_linear_change_of_coordinates_changes_nothing(seed: int) -> None:
    chance = Random(seed)
    first = sketched(chance)
    compared(first, changed(first, chance), "", chance)


@pytest.mark.parametrize("seed", range(1000, 1000 + MANY // 5))
def test_the_order_of_bodies_and_units_change_nothing(seed: int) -> None:
    chance = Random(seed)
    first = sketched(chance)
    order = list(first.order)
    chance.shuffle(order)
    compared(first, replace(first, order=tuple(order), units=chance.choice((2, 9))), "", chance)


@pytest.mark.parametrize("seed", range(2000, 2000 + MANY // 3))
def test_a_constraint_instead_of_a_coordinate_changes_nothing(seed: int) -> None:
    """The last coordinate, r, is told by q_(n-1) = r + (a sum of others): whichever of the two depends on the other."""
    chance = Random(seed)
    first = changed(sketched(chance), chance)
    last, others = first.size - 1, range(first.size - 1)
    weights = [chance.randint(-1, 1) for _ in others]
    relation = " + ".join([f"q{last}", *(f"({w})*q{j}" for j, w in enumerate(weights) if w)])
    light = "  - {name: slide, attached to: 0, connection point: [0, r, 0], coordinates: [r], mass: 0}"
    left = mbsym.loads(described(first), (4, 5, 6))
    words = {left.stability.numerical and left.stability.numerical.word}
    at = {parameter.name: value(parameter.name, first) for parameter in left.system.parameters}
    wanted = polynomial(left, at)
    for dependent in ("r", f"q{last}"):
        text = described(first, f"constraints: [relation: r = {relation}]\ndependent: [{dependent}]")
        text = (
            text.replace("loads:", f"{light}\nloads:", 1)
            if "\nloads:" in text
            else text.replace("constraints:", f"{light}\nconstraints:", 1)
        )
        motion = text.rsplit("motion: {", 1)[1].rstrip("}\n")
        turns = {
            entry.split(":")[0].strip(): Fraction(entry.split(":")[1].split("*")[0])
            for entry in motion.split(",")
            if entry
        }
        place = turns.get(f"q{last}", 0) + sum(w * turns.get(f"q{j}", 0) for j, w in enumerate(weights))
        given = [entry.strip() for entry in motion.split(",") if entry] + ([f"r: {place}*pi"] if place else [])
        right = mbsym.loads(text.rsplit("motion:", 1)[0] + f"motion: {{{', '.join(given)}}}", (4, 5, 6))
        assert right.stability.numerical is not None
        words.add(right.stability.numerical.word)
        assert polynomial(right, at) == wanted
    assert len(words) == 1
