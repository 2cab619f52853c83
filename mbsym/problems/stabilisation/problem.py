"""Problem 8 on a linearised system: everything that is said, subsystem by subsystem."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from itertools import combinations
from math import comb
from typing import Any

from flint import arb, arb_mat, ctx, fmpq, fmpq_mat

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.characteristic import determinant
from mbsym.algebra.evaluate import Carrier, at_rationals
from mbsym.algebra.factors import common_divisor
from mbsym.algebra.failures import NOT_THERE, Failure, TooLargeError, message_of
from mbsym.algebra.matrices import added, dot
from mbsym.algebra.point import Balls
from mbsym.algebra.rationals import ball
from mbsym.algebra.ring import Polynomial
from mbsym.algebra.signs import Signs
from mbsym.expressions.message import Message
from mbsym.formulas.formula import Formula, Matrix
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.states import SEED
from mbsym.model.system import velocity_name
from mbsym.problems.equilibrium import Equilibrium
from mbsym.problems.linearisation import Linearisation
from mbsym.problems.stabilisation import gyroscopic, numbers
from mbsym.problems.stabilisation.gyroscopic import Cleared, Rows, cleared
from mbsym.problems.stabilisation.hautus import MOST_BLOCKS, _open_factors, annihilator, rank_of
from mbsym.problems.stabilisation.numbers import AtValues
from mbsym.problems.stabilisation.result import (
    Control,
    Dissipation,
    EnergyFunction,
    Feedback,
    Gyroscopic,
    Locus,
    Motion,
    Rank,
    Stabilisation,
)
from mbsym.problems.stability.exact import is_positive, observed
from mbsym.problems.stability.requirements import Definite, definiteness

#: Sets of inputs are compared of so many; numbers are looked at in so many coordinates.
MOST_INPUTS, MOST_COORDINATES = 6, 12
#: Damped coordinates whose principal minors are looked at.
MOST_DAMPED = 4
#: The precision of what is enclosed.
BITS = 320
#: Random points at which a rank is taken where formulas are too large.
POINTS = 3

Values = Mapping[str, Any] | None

#: Whether a matrix is positive definite; None is not known.
_PROVED = {Definite.POSITIVE: True, Definite.NOT_POSITIVE: False}


def stabilisation(scene: Scene[Any], linear: Linearisation, signs: Signs, values: Values) -> Stabilisation:
    """Everything that is said; ``values`` are numbers of all parameters, or None."""
    few = len(linear.coordinates) <= MOST_COORDINATES
    there = None if values is None or not few else at_values(scene, linear, values)
    parts = [[linear.coordinates.index(name) for name in part.coordinates] for part in linear.subsystems]
    turning, damping, energies = [], [], []
    pushed: list[str] = []
    model = scene.system.linear
    # x' = A x has no energy, and of nonholonomic systems the matrices say nothing of it.
    for at in () if not linear.about.holonomic or (model is not None and model.of_first_order) else parts:
        names = tuple(linear.coordinates[i] for i in at)
        mass, damped, gyro, stiff, circulatory = (_block(matrix, at) for matrix in linear.matrices)
        if not circulatory.is_zero:
            pushed += names
            continue
        whole = _cleared(scene, (mass, damped, gyro, stiff), signs)
        own = None if there is None else there.only(at)
        regions, free = ((), 0) if whole is None else gyroscopic.regions(whole, whole.matrices[3])
        turning.append(Gyroscopic(names, regions, not gyro.is_zero, not damped.is_zero, free))
        energies.append(_energy(whole, names, damped, own))
        if not damped.is_zero:
            damping.append(_dissipation(whole, names, own, None if there is None else _damping(scene, damped, values)))
    if there is None and values is not None and few and linear.B is not None:
        there = enclosed_at(scene, linear, values)
    control, least, feedback, why = _controlled(scene, linear, signs, parts, there)
    apart = tuple(name for name in linear.about.idle if name not in linear.coordinates)
    return Stabilisation(
        tuple(turning),
        tuple(damping),
        control,
        least,
        feedback,
        why,
        tuple(energies),
        apart,
        not linear.about.holonomic,
        tuple(pushed),
    )


def on_motion(scene: Scene[Any], equilibrium: Equilibrium, values: Mapping[str, Any]) -> bool:
    """Whether the values are those at which the motion exists: exactly."""
    carry = at_rationals(scene.ring, values)
    exact = carry.environment
    try:
        return all(name in exact and carry(formula.polynomial) == exact[name] for name, formula in equilibrium.solved)
    except NOT_THERE:
        return False


def at_values(scene: Scene[Any], linear: Linearisation, values: Mapping[str, Any]) -> AtValues | None:
    """The matrices at rational values; None where a number is irrational, or z' is not determined there."""
    mass, damped, gyro, stiff, circulatory = (_numbers(scene, matrix, values) for matrix in linear.matrices)
    if mass is None or damped is None or gyro is None or stiff is None or circulatory is None:
        return None
    inputs = None if linear.B is None else _numbers(scene, linear.B, values)
    if linear.B is not None and inputs is None:
        return None
    evaluated = AtValues(mass, damped + gyro, stiff + circulatory, inputs)
    try:
        evaluated.state  # noqa: B018
    except ZeroDivisionError:
        return None
    return evaluated


def enclosed_at(scene: Scene[Any], linear: Linearisation, values: Mapping[str, Any]) -> AtValues | None:
    """The same at irrational values, in balls; None where one of them has no value, or z' is not determined there."""
    with ctx.workprec(BITS):
        numbers_of = {name: ball(x) if isinstance(x, Fraction) else x for name, x in values.items()}
        balls = Balls({**numbers_of, "pi": arb.pi()})
        carry = Carrier(scene.ring, balls, {**numbers_of, "pi": arb.pi()})
        try:
            mass, damped, gyro, stiff, circulatory, inputs = (
                arb_mat(*matrix.shape, [carry(x) for row in matrix.polynomials for x in row])
                for matrix in (*linear.matrices, linear.B)
                if matrix is not None
            )
            evaluated = AtValues(mass, damped + gyro, stiff + circulatory, inputs)
            evaluated.state  # noqa: B018
        except (*NOT_THERE, ZeroDivisionError):
            return None
    return evaluated


def _numbers(scene: Scene[Any], matrix: Matrix, values: Mapping[str, Any]) -> Any | None:
    carry = at_rationals(scene.ring, values)
    height, width = matrix.shape
    try:
        return fmpq_mat(height, width, [carry(x) for row in matrix.polynomials for x in row])
    except NOT_THERE:
        return None


def _damping(scene: Scene[Any], damped: Matrix, values: Values) -> Any | None:
    return None if values is None else _numbers(scene, damped, values)


def _block(matrix: Matrix, at: Sequence[int]) -> Matrix:
    rows = matrix.polynomials
    return Matrix.of(matrix[0, 0].ring, [[rows[i][j] for j in at] for i in at])


def _cleared(scene: Scene[Any], matrices: Sequence[Matrix | None], signs: Signs) -> Cleared | None:
    try:
        return cleared(scene.ring, matrices, signs)
    except Failure:
        return None


# --- energy ---


def _energy(whole: Cleared | None, names: tuple[str, ...], damped: Matrix, there: AtValues | None) -> EnergyFunction:
    minors: tuple[Formula, ...] = ()
    definite: bool | None = None
    if whole is not None:
        try:
            verdict = definiteness(whole.matrices[3], whole.known, "K")
            definite = _PROVED.get(verdict.word)
            conditions = [
                requirement.condition
                for requirement in verdict.requirements
                if requirement.condition.kind == "inequality"
            ]
            minors = tuple(whole.formula(condition.polynomial) for condition in conditions)
        except TooLargeError:
            pass
    bundle, positive = None, None
    if there is not None:
        positive = is_positive((there.places + there.places.transpose()) / 2)
        if damped.is_zero and not positive and there.size <= MOST_COORDINATES:
            bundle = numbers.energy_bundle(there)
    return EnergyFunction(names, damped.is_zero, minors, definite, positive, bundle)


# --- dissipation ---


def _dissipation(whole: Cleared | None, names: tuple[str, ...], there: AtValues | None, damped: Any) -> Dissipation:
    pervasive = None if there is None or damped is None else feels_everything(there, damped)
    if whole is None:
        rank = Rank(False, Certainty.UNDECIDED, why_not="the matrices hold roots or functions of parameters")
        return Dissipation(names, None, None, rank, (), pervasive)
    mass, damping, gyro, stiff = whole.matrices
    complete = _PROVED.get(definiteness(damping, whole.known, "D").word)
    if complete:
        return Dissipation(names, True, True, Rank(True, Certainty.PROVED, (), Locus()), (), True if there else None)
    opposite = [[-x for x in row] for row in gyro]  # [P(lambda); D] transposed is [P(-lambda), D] with D instead of B
    try:
        rank = without_drift(rank_of(whole, mass, opposite, stiff, damping, rest=False), whole, gyro, stiff, damping)
    except TooLargeError as error:
        rank = _at_random(whole, mass, opposite, stiff, damping, message_of(error))
    motions = tuple(
        motion
        for factor in rank.factors
        if (motion := _undamped(whole, mass, gyro, stiff, damping, factor)) is not None
    )
    return Dissipation(names, complete, _semidefinite(damping, whole.known), rank, motions, pervasive)


def _semidefinite(damping: Rows, known: Signs) -> bool | None:
    """Whether no principal minor is negative; None where that is not known."""
    damped = [i for i, row in enumerate(damping) if any(x != 0 for x in row)]
    if len(damped) > MOST_DAMPED:
        return None
    minors = (at for size in range(1, len(damped) + 1) for at in combinations(damped, size))
    words = [known.sign(determinant([[damping[i][j] for j in at] for i in at])) for at in minors]
    if "negative" in words:
        return False
    return True if all(word in ("positive", "nonnegative", "zero") for word in words) else None


def feels_everything(there: AtValues, damped: Any) -> bool:
    """Whether D x' = 0 at all times leaves rest only, of M x'' + G x' + K x = 0: exactly."""
    n = there.size
    felt = observed(AtValues(there.mass, there.rates - damped, there.places, None).state, damped)
    unit = [[fmpq(int(j == n + i)) for j in range(2 * n)] for i in range(n)]
    return bool(fmpq_mat(felt).rank() == fmpq_mat(felt + unit).rank())


def _undamped(
    whole: Cleared, mass: Rows, gyro: Rows, stiff: Rows, damping: Rows, factor: Sequence[Formula]
) -> Motion | None:
    """The motion of a factor  c_0 + c_2 lambda^2,  with its shape where that is free of lambda; None for others."""
    if len(factor) != 3 or not factor[1].is_zero:
        return None
    below, above = (whole.ring.project(x.polynomial) for x in (factor[0], factor[2]))
    ring = whole.ring.whole
    square = ring.ratio(factor[0].polynomial, factor[2].polynomial)
    kernel = annihilator(damping, whole.known, len(mass))[1]
    shape: Sequence[Any] | None = None
    if len(kernel) == 1:
        shape = kernel[0]
    elif all(x == 0 for row in gyro for x in row):
        rows = [[k * above - m * below for k, m in zip(*pair, strict=True)] for pair in zip(stiff, mass, strict=True)]
        reduced = [[dot(row, v) for v in kernel] for row in rows]
        weights = _null_vector(reduced)
        if weights is not None:
            shape = [sum((w * v[i] for w, v in zip(weights, kernel, strict=True)), below * 0) for i in range(len(mass))]
    return Motion(Formula(ring, square), None if shape is None else tuple(map(whole.formula, _primitive(shape))))


def _primitive(vector: Sequence[Any]) -> list[Any]:
    common = common_divisor(vector)
    return [divmod(x, common)[0] for x in vector] if common != 0 else list(vector)


def _null_vector(rows: Rows) -> list[Any] | None:
    """y != 0 with R y = 0, of a matrix whose rank is one less than its width; None where it is less, or none is."""
    width = len(rows[0])
    for at in combinations(range(len(rows)), width - 1):
        minors = []
        for column in range(width):
            block = [[rows[i][j] for j in range(width) if j != column] for i in at]
            minors.append(determinant(block) * (-1) ** column)
        if any(x != 0 for x in minors):
            right = all(dot(row, minors) == 0 for row in rows)
            return minors if right else None
    return None


# --- control ---


def _controlled(
    scene: Scene[Any], linear: Linearisation, signs: Signs, parts: Sequence[Sequence[int]], there: AtValues | None
) -> tuple[tuple[Control, ...], tuple[tuple[str, ...], ...], Feedback | None, str]:
    if linear.B is None:
        return (), (), None, "there are no inputs"
    whole = _cleared(scene, (*linear.matrices, linear.B), signs)
    every = list(range(len(linear.coordinates)))
    blocks = [every] if len(parts) == 1 else [every, *map(list, parts)]
    control = tuple(_control(whole, linear, at, there) for at in blocks)
    least = () if whole is None else _least(whole, linear)
    if len(every) > MOST_COORDINATES:
        return (control, least, None, Message("there are more than [[most]] coordinates", most=MOST_COORDINATES))
    if there is None:
        return control, least, None, "the description gives no values of all parameters"
    with ctx.workprec(BITS):
        feedback, why = numbers.feedback(there), ""
        if isinstance(feedback, str):  # parts that no force but an input couples to the others may be within reach
            why = feedback
            within = [at for at in parts if len(parts) > 1 and numbers.is_stabilisable(there.only(at))]
            every = sorted(i for at in within for i in at)
            if not every or len(every) == there.size:
                return control, least, None, why
            there = there.only(every)
            feedback = numbers.feedback(there)
    if isinstance(feedback, str):
        return control, least, None, why
    names = [linear.coordinates[i] for i in every]
    states = (*names, *(velocity_name(names[i]) for i in there.moving))
    return control, least, replace(feedback, states=states, of_part=why), ""


def _control(whole: Cleared | None, linear: Linearisation, at: Sequence[int], there: AtValues | None) -> Control:
    names = tuple(linear.coordinates[i] for i in at)
    if whole is None:
        rank = Rank(False, Certainty.UNDECIDED, why_not="the matrices hold roots or functions of parameters")
    else:
        rank = _ranked(whole, at, range(len(linear.inputs)))
    if there is None:
        return Control(names, linear.inputs, rank)
    own = there.only(at)
    with ctx.workprec(BITS):
        return Control(names, linear.inputs, rank, numbers.is_controllable(own), numbers.is_stabilisable(own))


def _ranked(whole: Cleared, at: Sequence[int], columns: Sequence[int]) -> Rank:
    """Hautus' test of some coordinates with some inputs."""

    def cut(rows: Rows) -> Rows:
        return [[rows[i][j] for j in at] for i in at]

    mass, damped, gyro, stiff, circulatory = (cut(rows) for rows in whole.matrices[:5])
    inputs = [[whole.matrices[5][i][j] for j in columns] for i in at]
    rates, places = added(damped, gyro), added(stiff, circulatory)
    try:
        return rank_of(whole, mass, rates, places, inputs)
    except TooLargeError as error:
        return _at_random(whole, mass, rates, places, inputs, message_of(error))


def _at_random(whole: Cleared, mass: Rows, rates: Rows, places: Rows, inputs: Rows, why: str) -> Rank:
    """Full rank at one point proves it for almost all parameters; a lower one proves nothing."""
    source = random.Random(SEED)
    for _ in range(POINTS if len(mass) <= MOST_COORDINATES else 0):
        point = [fmpq(source.randint(1, 997), source.randint(1, 97)) for _ in whole.ring.generators]

        def at(rows: Rows, point: list[Any] = point) -> Any:
            return fmpq_mat(len(rows), len(rows[0]), [fmpq(x(*point)) for row in rows for x in row])

        there = AtValues(at(mass), at(rates), at(places), at(inputs))
        with suppress(ZeroDivisionError):
            if not numbers.is_controllable(there):
                continue
            return Rank(True, Certainty.PROVED, (), None, why)
    return Rank(False, Certainty.UNDECIDED, why_not=why)


def _least(whole: Cleared, linear: Linearisation) -> tuple[tuple[str, ...], ...]:
    """The smallest sets of inputs that suffice; none where that of smaller ones is open."""
    count = len(linear.inputs)
    if count > MOST_INPUTS:
        return ()
    for size in range(1, count + 1):
        ranks = {
            chosen: _ranked(whole, range(len(linear.coordinates)), chosen)
            for chosen in combinations(range(count), size)
        }
        enough = [chosen for chosen, rank in ranks.items() if rank.full]
        if enough:
            return tuple(tuple(linear.inputs[j] for j in chosen) for chosen in enough)
        if any(rank.certainty is Certainty.UNDECIDED for rank in ranks.values()):
            return ()
    return ()


def without_drift(rank: Rank, whole: Cleared, gyro: Rows, stiff: Rows, damping: Rows) -> Rank:
    """``rank``, found off lambda = 0, with what uniform motions that are not felt change in it.

    Where some are there for all parameters, lambda is a root; else all is said where the minors that exclude them do
    not vanish.  Raises TooLargeError.
    """
    if not rank.full or rank.certainty is not Certainty.PROVED or whole.known.never_zero(determinant(stiff)):
        return rank
    damped = [j for j, row in enumerate(damping) if any(x != 0 for x in row)]
    beside = [[*k, *(d[j] for j in damped)] for k, d in zip(stiff, damping, strict=True)]
    both, unfelt = annihilator(beside, whole.known, len(stiff))
    needed = [both]
    if unfelt:
        held, free = annihilator(stiff, whole.known, len(stiff))
        minor = _minor([[dot(u, [dot(row, v) for row in gyro]) for v in unfelt] for u in free], whole)
        if minor is None:
            drift = (whole.formula(both * 0), whole.formula(both * 0 + 1))
            turned = any(x != 0 for row in gyro for x in row)  # then w is needed, which a lower rank of K may deny
            open_ = _open_factors(held, whole.known) if turned else []
            return Rank(False, Certainty.PROVED, (drift,), Locus((), (), tuple(map(whole.formula, open_))))
        needed.append(minor)
    if rank.locus is None:
        return rank
    locus = rank.locus
    doubtful = {str(x): x for polynomial in needed for x in map(whole.formula, _open_factors(polynomial, whole.known))}
    if all(x == 0 for row in gyro for x in row):  # then what Hautus' test loses at lambda = 0 is a drift
        doubtful = {text: x for text, x in doubtful.items() if text not in map(str, locus.factors)}
    factors = tuple(x for x in locus.factors if str(x) not in doubtful)
    provided = {str(x): x for x in locus.provided} | doubtful
    return Rank(True, rank.certainty, (), Locus(factors, locus.together, tuple(provided.values())), rank.why_not)


def _minor(rows: Rows, whole: Cleared) -> Polynomial | None:
    """A minor of full column rank, one that cannot vanish if there is one; None where all vanish identically."""
    width = len(rows[0])
    if comb(len(rows), width) > MOST_BLOCKS:
        raise TooLargeError("too many minors")
    minors = [determinant([rows[i] for i in at]) for at in combinations(range(len(rows)), width)]
    left = [x for x in minors if x != 0]
    return min(left, key=lambda x: (not whole.known.never_zero(x), len(x))) if left else None
