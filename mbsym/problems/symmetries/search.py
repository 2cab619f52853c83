"""The kernel of the condition of a symmetry: bounded at exact states modulo a prime, then solved in symbols."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import lcm, prod
from random import Random
from typing import Any

from flint import fmpq, fmpq_mat, nmod_mat

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import NOT_THERE, Failure, Limit, NoClosedForm
from mbsym.algebra.kernel import coefficients, independent, kernel
from mbsym.algebra.point import Rationals
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message
from mbsym.formulas.formula import Formula
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.oracle import State
from mbsym.mechanics.speeds import SpeedForm
from mbsym.mechanics.states import rational_states
from mbsym.model.system import System
from mbsym.problems import integrals
from mbsym.problems.constraints.integrals import AlongMotion
from mbsym.problems.energy import Energy
from mbsym.problems.equations import Equations
from mbsym.problems.integrals import Integral
from mbsym.problems.polynomial_integrals.modular import PRIMES, null_space
from mbsym.problems.polynomial_integrals.result import FUNCTION
from mbsym.problems.vector_field import put_in

# Symmetries and their integrals, as values.


#: The name of an integral that depends on those of problem 7 and of the list before it, at an exact random state.
DEPENDENT = "function of those before it"


@dataclass(frozen=True)
class Symmetry:
    """A field and its integral.

    ``directions``: (name of the coordinate or speed, xi_r) where that is not zero.  ``time``: tau, ``gauge``: Gamma.
    ``name``: the integral of problem 7 of which it is a multiple; FUNCTION of these; DEPENDENT; "" for others.
    ``sure``: how that is known (proved: by the rank of gradients at an exact state).
    ``substituted``: how dI/dt = 0 came out on the second route (proved: an identity; verified: at exact states).
    """

    directions: tuple[tuple[str, Formula], ...]
    time: Formula
    gauge: Formula
    integral: Formula
    name: str
    certainty: Certainty
    substituted: Certainty

    @property
    def is_new(self) -> bool:
        """Whether it is proved that problem 7 does not know it, as a function."""
        return not self.name and self.certainty is Certainty.PROVED


@dataclass(frozen=True)
class Symmetries:
    """A basis of the ``symmetries``; ``complete``: it is proved that every other is a combination of them.

    ``unknowns``: so many constants were free.  ``in_speeds``: directions are declared speeds.
    ``symbols``: some parameters have no numbers, and what is said holds for almost all their values.
    ``compared``: that is known by coefficients of independent functions, not by ranks at states.
    """

    symmetries: tuple[Symmetry, ...]
    complete: bool
    unknowns: int
    in_speeds: bool
    symbols: bool
    compared: bool = False

    @property
    def new(self) -> tuple[Symmetry, ...]:
        """Those that problem 7 does not list, nor functions of what it lists."""
        return tuple(symmetry for symmetry in self.symmetries if symmetry.is_new)


Images = Mapping[int, Polynomial]


@dataclass(frozen=True)
class Blocks:
    """Of the directions r: ``names``, momenta p_r, their ``rates`` R_r; of the positions j: s_j and s'_j.

    R_r holds no accelerations: dp_r/dt less the equation of motion r.  ``energy`` is H, ``power`` its rate, both as
    ``integrals`` of problem 7 are written.  ``images`` take the place of parameters, in the blocks already.
    ``plain``: x in independent variables, unit vectors in terms of angles; ``state``: these variables, by the function
    that gives the derivative with respect to each.  ``norms`` vanish on all states.  ``keeps``: the second route.
    """

    ring: Ring
    names: tuple[str, ...]
    momenta: tuple[Polynomial, ...]
    rates: tuple[Polynomial, ...]
    positions: tuple[Polynomial, ...]
    changes: tuple[Polynomial, ...]
    energy: Polynomial
    power: Polynomial
    images: Images
    plain: Callable[[Polynomial], Polynomial]
    state: tuple[Callable[[Polynomial], Polynomial], ...]
    norms: tuple[tuple[str, ...], ...]
    vanishes: Callable[[Polynomial], bool | None]
    keeps: Callable[[Polynomial], Certainty | None]
    in_speeds: bool


def blocks(form: SpeedForm, scene: Scene, energy: Energy, equations: Equations, images: Images) -> Blocks:
    """The blocks of a system in its speeds (q', where it declares none), positions, unit vectors and quaternions."""
    ring, declared = form.ring, bool(form.system.speeds)
    kinetic, force = energy.kinetic_energy.polynomial, energy.force_function.polynomial
    momenta = [ring.derivative(kinetic, u.name) for u in form.speeds]
    forcing = [f.polynomial for f in equations.forcing]
    own = [ring.context.gen(u.index) - at_rest for u, at_rest in zip(form.speeds, form.drifts, strict=True)]
    whole = ring.reduce(ring.dot(momenta, own) - kinetic - force)
    motion = AlongMotion(form, equations)

    def keeps(x: Polynomial) -> Certainty | None:
        rate = (motion.rate(x),) if declared else integrals.rate_on_motion(scene, equations, x)
        if rate is not None:
            zero = form.vanishes(put_in(ring, rate[0], images))
            return None if zero is False else Certainty.PROVED if zero else Certainty.UNDECIDED
        if images:
            return Certainty.UNDECIDED
        return Certainty.VERIFIED if integrals.is_conserved(scene, equations, x) else None

    replaced = [name for body in form.by_vectors for name in body.own_angles]
    norms = tuple(body.orientation[0].components for body in form.by_quaternion)
    variables = [
        *form.coordinates,
        *replaced,
        *(name for components in norms for name in components),
        *(u.name for u in form.speeds),
    ]

    def put(listed: Iterable[Polynomial]) -> tuple[Polynomial, ...]:
        return tuple(put_in(ring, x, images) for x in listed)

    return Blocks(
        ring,
        names=tuple(u.name for u in form.speeds) if declared else form.coordinates,
        momenta=put(momenta),
        rates=put(ring.reduce(form.drift(p) + f) for p, f in zip(momenta, forcing, strict=True)),
        positions=put(ring.context.gen(s.index) for s in form.positions),
        changes=put(form.rates[s.name] for s in form.positions),
        energy=put_in(ring, whole, images),
        power=put_in(ring, ring.reduce(form.drift(whole) + ring.dot(own, forcing)), images),
        images=images,
        plain=lambda x: ring.reduce(form.in_angles(x)),
        state=tuple(partial(ring.derivative, name=name) for name in variables),
        norms=norms,
        vanishes=form.vanishes,
        keeps=keeps,
        in_speeds=declared,
    )


#: Constants that are free, and states that are tried in vain.
MOST_UNKNOWNS, SPARE = 400, 12


@dataclass(frozen=True)
class Unknown:
    """A constant: of Gamma (``direction`` None), of xi_r, or tau (``time``); ``factors``: places of positions."""

    factors: tuple[int, ...]
    direction: int | None
    time: bool = False


def symmetries(system: System, blocks: Blocks, known: Sequence[Integral] | None) -> Symmetries:
    """A basis of the symmetries with fields of degree one in the positions (Gamma: two), free of the time.

    ``known``: problem 7, None where that has no result.

    Raises NoClosedForm where there are too many unknowns, or coefficients outgrow their bounds.
    """
    unknowns = _unknowns(blocks)
    if len(unknowns) > MOST_UNKNOWNS:
        message = Message(
            "a field of degree one has [[count]] constants, more than [[most]]", count=len(unknowns), most=MOST_UNKNOWNS
        )
        raise NoClosedForm(message, limit=Limit.WORK)
    bound = _bound(system, blocks, unknowns)
    able, most = (list(range(len(unknowns))), -1) if bound is None else bound
    columns = [_condition(blocks, unknowns[k]) for k in able]
    vectors = kernel(blocks.ring, columns) if able else []
    compared = bound is None and independent(blocks.ring, columns)
    most = len(vectors) if compared else most
    candidates = []
    right = len(vectors)
    for vector in vectors:
        made = _symmetry(blocks, unknowns, {able[k]: c for k, c in vector.items()})
        if made is None:
            right -= 1
        else:
            candidates.append(made)
    judged = _told_apart(system, blocks, candidates, known)
    bound_by_images = {blocks.ring.generators[k].name for k in blocks.images}
    symbols = any(name not in bound_by_images for name in system.parameter_names)
    return Symmetries(tuple(judged), right == most, len(unknowns), blocks.in_speeds, symbols, compared)


def _unknowns(blocks: Blocks) -> list[Unknown]:
    """Those of Gamma first: pivots of the elimination, so that fields are what is free."""
    positions, directions = range(len(blocks.positions)), range(len(blocks.names))
    unknowns = [Unknown((j, k), None) for j in positions for k in positions if j <= k]
    unknowns += [Unknown((j,), None) for j in positions]
    unknowns += [Unknown((j,), r) for r in directions for j in positions]
    unknowns += [Unknown((), r) for r in directions]
    return [*unknowns, Unknown((), None, True)]


def _condition(blocks: Blocks, unknown: Unknown) -> Polynomial:
    """What a constant is multiplied by, in independent variables."""
    ring, s, changes = blocks.ring, blocks.positions, blocks.changes
    if unknown.time:
        return blocks.plain(blocks.power)
    if unknown.direction is None:
        if len(unknown.factors) == 1:
            return blocks.plain(-changes[unknown.factors[0]])
        j, k = unknown.factors
        return blocks.plain(-ring.times(s[j], changes[k]) - ring.times(s[k], changes[j]))
    rate = blocks.rates[unknown.direction]
    if not unknown.factors:
        return blocks.plain(rate)
    (j,) = unknown.factors
    return blocks.plain(ring.times(s[j], rate) + ring.times(changes[j], blocks.momenta[unknown.direction]))


# --- how many there can be ---


def _bound(system: System, blocks: Blocks, unknowns: Sequence[Unknown]) -> tuple[list[int], int] | None:
    """The unknowns that occur in the kernel at random numbers, modulo a prime, and its dimension: at most as large for
    symbols.  None where states are not rational.
    """
    rows = []
    try:
        plain = _Plain(blocks)
        for carry in _states(system, blocks, len(unknowns) + SPARE):
            rows.append(_row(carry, plain, unknowns))
            if len(rows) == len(unknowns) + SPARE // 2:
                break
    except NOT_THERE:
        return None
    if len(rows) < len(unknowns):
        return None
    basis = null_space(nmod_mat(rows, PRIMES[0]))
    return sorted({k for vector in basis for k, c in enumerate(vector) if c}), len(basis)


def _states(system: System, blocks: Blocks, count: int) -> Any:
    """Carriers at random exact states with the same parameters, angles among them too; quaternions of norm 1."""
    source, same, turns = Random("symmetries"), None, None
    fixed = {*system.parameter_names}
    for state in rational_states(system, blocks.ring, count):
        assert isinstance(state.numbers, Rationals)
        same = same or {name: x for name, x in state.values.items() if name in fixed}
        turns = turns or {name: x for name, x in state.numbers.basic.items() if name in fixed}
        state.numbers.basic |= turns
        values = {**state.values, **same, **_norms(blocks, source)}
        exponentials = _exponentials(blocks.ring, source)
        yield Carrier(blocks.ring, state.numbers, State(state.numbers, values).values, exponentials)


def _exponentials(ring: Ring, source: Random) -> dict[int, fmpq]:
    """Values of exp(a): a product of powers, one for each monomial of a, drawn at random.

    With positions and parameters beside they fulfil what all states do, and nothing else: exponentials of such
    monomials are algebraically independent (J. Ax, Ann. of Math. 93 (1971), 252).
    """
    exponentials = [(k, g.argument) for k, g in enumerate(ring.generators) if g.kind == "function" and g.name == "exp"]
    exponentials = [(k, a) for k, a in exponentials if all(map(partial(_moves, ring), a.monoms()))]
    common = lcm(*(int(c.q) for _, a in exponentials for c in a.coeffs()))
    bases = {m: fmpq(source.randint(2, 99), source.randint(2, 99)) for _, a in exponentials for m in a.monoms()}
    return {k: prod((bases[m] ** int(c * common) for m, c in a.terms()), start=fmpq(1)) for k, a in exponentials}


def _moves(ring: Ring, monomial: Sequence[int]) -> bool:
    """Whether it is made of positions and parameters, and of a position at least."""
    kinds = {g.kind for g, power in zip(ring.generators, monomial, strict=True) if power}
    return "coordinate" in kinds and kinds <= {"coordinate", "parameter"}


def _norms(blocks: Blocks, source: Random) -> dict[str, fmpq]:
    norms: dict[str, fmpq] = {}
    for names in blocks.norms:
        plane = [fmpq(source.randint(-99, 99), source.randint(1, 99)) for _ in names[1:]]
        square = sum((x * x for x in plane), fmpq(0))
        values = [(1 - square) / (1 + square), *(2 * x / (1 + square) for x in plane)]
        norms |= dict(zip(names, values, strict=True))
    return norms


class _Plain:
    """The blocks in independent variables."""

    def __init__(self, blocks: Blocks) -> None:
        def moved(listed: Sequence[Polynomial]) -> list[Polynomial]:
            return [blocks.plain(x) for x in listed]

        self.momenta, self.rates = moved(blocks.momenta), moved(blocks.rates)
        self.positions, self.changes = moved(blocks.positions), moved(blocks.changes)
        (self.power,) = moved([blocks.power])


def _row(carry: Carrier, blocks: _Plain, unknowns: Sequence[Unknown]) -> list[int]:
    """What every constant is multiplied by at a state."""

    def at(listed: Sequence[Polynomial]) -> list[int]:
        return [_residue(carry(x)) for x in listed]

    prime = PRIMES[0]
    p, rates = at(blocks.momenta), at(blocks.rates)
    s, changes = at(blocks.positions), at(blocks.changes)
    (power,) = at([blocks.power])
    entries = []
    for unknown in unknowns:
        if unknown.time:
            value = power
        elif unknown.direction is None:
            j, *rest = unknown.factors
            value = -s[j] * changes[rest[0]] - s[rest[0]] * changes[j] if rest else -changes[j]
        elif unknown.factors:
            (j,) = unknown.factors
            value = s[j] * rates[unknown.direction] + changes[j] * p[unknown.direction]
        else:
            value = rates[unknown.direction]
        entries.append(value % prime)
    return entries


def _residue(x: fmpq) -> int:
    return int(x.p) * pow(int(x.q), -1, PRIMES[0]) % PRIMES[0]


# --- what they are ---


def _symmetry(blocks: Blocks, unknowns: Sequence[Unknown], vector: dict[int, Polynomial]) -> Symmetry | None:
    """The field of a vector of the kernel; None where the condition or the second route refutes it."""
    ring = blocks.ring
    left, time, gauge = ring.zero, ring.zero, ring.zero
    field = [ring.zero for _ in blocks.names]
    for k, c in vector.items():
        unknown = unknowns[k]
        left = left + ring.times(c, _condition(blocks, unknown))
        if unknown.time:
            time = c
            continue
        term = c
        for j in unknown.factors:
            term = ring.times(term, blocks.positions[j])
        if unknown.direction is None:
            gauge = gauge + term
        else:
            field[unknown.direction] = field[unknown.direction] + term
    whole = ring.times(time, blocks.energy) - gauge
    for xi, p in zip(field, blocks.momenta, strict=True):
        whole = whole + ring.times(xi, p)
    whole = ring.reduce(whole)
    if ring.is_zero(blocks.plain(ring.reduce(left))) is not True:
        return None
    second = blocks.keeps(whole)
    if second is None:
        return None
    directions = tuple((name, Formula(ring, xi)) for name, xi in zip(blocks.names, field, strict=True) if xi != 0)
    shift, gained = Formula(ring, ring.reduce(time)), Formula(ring, ring.reduce(gauge))
    return Symmetry(directions, shift, gained, Formula(ring, whole), "", Certainty.UNDECIDED, second)


def _told_apart(
    system: System, blocks: Blocks, candidates: Sequence[Symmetry], known: Sequence[Integral] | None
) -> list[Symmetry]:
    """Without those whose integral is a constant; which are known, and how that is."""
    listed = [
        (integral.name, put_in(blocks.ring, integral.formula.polynomial, blocks.images)) for integral in known or ()
    ]
    of_known, of_all = Gradients(system, blocks), Gradients(system, blocks)
    for _, x in listed:
        of_known.add(x)
        of_all.add(x)
    moving = [
        replace(candidate, name=_multiple(blocks, candidate.integral.polynomial, listed))
        for candidate in candidates
        if not _constant(blocks, candidate.integral.polynomial)
    ]
    judged = []
    for symmetry in sorted(moving, key=lambda moved: (not moved.name, moved.integral.terms)):
        x = symmetry.integral.polynomial
        if symmetry.name:
            judged.append(replace(symmetry, certainty=Certainty.PROVED))
        elif known is None or (grown := of_all.add(x)) is None:
            judged.append(symmetry)
        elif grown:
            judged.append(replace(symmetry, certainty=Certainty.PROVED))
        else:
            name = FUNCTION if of_known.grows(x) is False else DEPENDENT
            judged.append(replace(symmetry, name=name, certainty=Certainty.VERIFIED))
    return judged


class Gradients:
    """Gradients at one exact state, and their rank; after what has no value there nothing is known any more."""

    def __init__(self, system: System, blocks: Blocks) -> None:
        self.blocks = blocks
        self.rows: list[list[fmpq]] | None = []
        try:
            *_, self.carry = _states(system, blocks, 2)
            for names in blocks.norms:
                norm = blocks.ring.zero
                for name in names:
                    e = blocks.ring.generator("coordinate", name)
                    norm = norm + e * e
                self.rows.append(self._at(norm))
        except NOT_THERE:
            self.rows = None

    def _at(self, x: Polynomial) -> list[fmpq]:
        return [self.carry(slope(x)) for slope in self.blocks.state]

    def grows(self, x: Polynomial) -> bool | None:
        """Whether x is independent of those before it; None where that is not known."""
        row = self._row(x)
        return None if row is None or self.rows is None else self._rank(row) > len(self.rows)

    def add(self, x: Polynomial) -> bool | None:
        """The same, and x is one of them from now on."""
        row = self._row(x)
        if row is None or self.rows is None:
            self.rows = None
            return None
        grown = self._rank(row) > len(self.rows)
        if grown:
            self.rows.append(row)
        return grown

    def _row(self, x: Polynomial) -> list[fmpq] | None:
        try:
            return self._at(self.blocks.plain(x))
        except (Failure, *NOT_THERE):
            return None

    def _rank(self, row: list[fmpq]) -> int:
        return int(fmpq_mat([*(self.rows or []), row]).rank())


def _constant(blocks: Blocks, x: Polynomial) -> bool:
    """Whether it does not depend on the state, as the norm of a quaternion does not."""
    plain = blocks.plain(x)
    return all(blocks.ring.is_zero(slope(plain)) is True for slope in blocks.state)


def _multiple(blocks: Blocks, x: Polynomial, known: Sequence[tuple[str, Polynomial]]) -> str:
    """The name of the first integral of which x is a multiple, up to a constant of parameters."""
    mine = _by_state(blocks.ring, blocks.plain(x))
    for name, other in known:
        theirs = _by_state(blocks.ring, blocks.plain(other))
        if mine and mine.keys() == theirs.keys():
            first = next(iter(mine))
            a, b = mine[first], theirs[first]
            if all(blocks.ring.times(c, b) == blocks.ring.times(theirs[key], a) for key, c in mine.items()):
                return name
    return ""


def _by_state(ring: Ring, x: Polynomial) -> dict[tuple[int, ...], Polynomial]:
    """The coefficients of what depends on the state, polynomials in parameters."""
    return {key: c for key, c in coefficients(ring, x).items() if any(key)}
