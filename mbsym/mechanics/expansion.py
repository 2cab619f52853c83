"""A system near its unperturbed motion, to first order; what constraints make dependent is not solved for.

With the rows f(q, t) = 0 and J q' + j = 0 and deviations x, nu, alpha of q, q', q'' from the motion (n each),

    0 = f + f_x x,      0 = g + g_x x + J nu,      0 = h + h_x x + h_nu nu + J alpha,

where h = d(J q' + j)/dt and J = J_0 + J_x x.  Each line is brought to echelon form on the motion: it gives the
dependent deviations as linear functions of the independent ones, x = P y, and the basis of the null space of J,

    Y = Y_0 + Y_x x,    Y_0 = (1, W),    J_0 Y_x + J_x Y_0 = 0,

although no equation of the constraints is ever solved (the pitch of a bicycle is a root of a quartic, its expansion
is 0 + 0 roll + 0 steer + ...).  Velocities of the motion that the description leaves out follow from the constraints
where they are dependent (the wheel at the front turns, and the place on the ground changes, as the one at the rear
rolls), and so do accelerations.

Which quantities are dependent: those that the description names (``dependent``), else those whose motion it leaves
out, else the later ones; always such that no pivot of the elimination can vanish, if there is such a choice.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import cast

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.jet import Jet, Jets
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.signs import Signs
from mbsym.expressions.tree import KINKED, Call, Expression, Negative, Number, Operation, reached, walk
from mbsym.mechanics.constraints.rows import Row as ConstraintRow
from mbsym.mechanics.constraints.rows import constraint_rows
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import carried, motion_derivatives, motion_values, relations
from mbsym.mechanics.newton_euler import residuals
from mbsym.mechanics.variables import expressions
from mbsym.model.system import System, acceleration_name, velocity_name

#: A linear form in deviations: polynomials by the number of the deviation.
Form = dict[int, Polynomial]

#: Longer polynomials are left as they are.
MOST_FACTORED = 200

#: How often the rates of a motion are completed before it is given up: each time one more coordinate turns.
MOST_ROUNDS = 64


@dataclass(frozen=True)
class Base:
    """The unperturbed motion: where coordinates rest, who turns, and all rates and accelerations (n each).

    ``related`` are the generators that others determine on it, and their values: parameters, angles that turn in step.
    """

    values: tuple[Polynomial, ...]
    turning: frozenset[str]
    rates: tuple[Polynomial, ...]
    accelerations: tuple[Polynomial, ...]
    related: Mapping[int, Polynomial]


@dataclass(frozen=True)
class Expansion:
    """``scene`` is the system over jets; deviations x_i, nu_i, alpha_i are numbered i, n + i, 2n + i.

    ``coordinates`` and ``speeds`` are the places of the independent ones.  ``positions[i]`` is x_i in the independent
    x; ``velocities[i]`` nu_i and ``accelerations[i]`` alpha_i in the independent x, nu and alpha; ``null_space[i][k]``
    is entry (i, k) of Y_0 and ``slopes[i][k]`` of Y_x, a form in the independent x.  ``conditions`` have to vanish if
    there is to be such a motion; ``assumed`` are polynomials that must not vanish; ``lost`` says whether J has a lower
    rank on the motion than nearby, where nothing of this means anything.
    """

    scene: Scene
    base: Base
    coordinates: tuple[int, ...]
    speeds: tuple[int, ...]
    positions: tuple[Form, ...]
    velocities: tuple[Form, ...]
    accelerations: tuple[Form, ...]
    null_space: tuple[tuple[Polynomial, ...], ...]
    slopes: tuple[tuple[Form, ...], ...]
    conditions: tuple[Polynomial, ...]
    assumed: tuple[Polynomial, ...]
    lost: bool


def expansion(scene: Scene, signs: Signs, whole: System | None = None) -> Expansion:
    """The expansion about the motion that the description gives (``scene`` over the ring, bodies not needed).

    With ``whole``, the system whose inputs ``scene`` holds at their values, these deviate, too.  Raises NoClosedForm or
    SingularPoint.
    """
    base = _completed(scene, signs)
    jets = over_jets(scene, base, whole, order=1 if _is_smooth(scene.system) else 2)
    rows = constraint_rows(jets)
    n = len(scene.system.coordinates)
    ring = scene.ring
    held = echelon(ring, signs, _positions(scene, rows, base), _preferred(scene))
    moved = echelon(ring, signs, _velocities(scene, rows, base), [*held.pivots, *_preferred(scene)])
    coordinates = tuple(i for i in range(n) if i not in held.pivots)
    speeds = tuple(i for i in range(n) if i not in moved.pivots)

    positions: list[Form] = [{i: ring.one} for i in range(n)]
    for pivot, row in held.pivots.items():
        positions[pivot] = {i: -x for i in coordinates if (x := row.get(i)) is not None}
    velocities: list[Form] = [{n + i: ring.one} for i in range(n)]
    for pivot, row in moved.pivots.items():
        own = {n + k: -x for k in speeds if (x := row.get(k)) is not None}
        velocities[pivot] = _sum(scene, own, _negative(_substituted(scene, row, "g", range(n), positions)))
    accelerations: list[Form] = [{2 * n + i: ring.one} for i in range(n)]
    for pivot, row in moved.pivots.items():
        own = {2 * n + k: -x for k in speeds if (x := row.get(k)) is not None}
        by_place = _substituted(scene, row, "h", range(n), positions)
        by_speed = _substituted(scene, row, "h", range(n, 2 * n), [*([{}] * n), *velocities])
        accelerations[pivot] = _sum(scene, own, _negative(_sum(scene, by_place, by_speed)))

    null_space = [[ring.one if i == k else ring.zero for k in speeds] for i in range(n)]
    for pivot, row in moved.pivots.items():
        entries: list[Polynomial] = [row.get(k, ring.zero) for k in speeds]
        null_space[pivot] = [-x for x in entries]
    slopes: list[tuple[Form, ...]] = [tuple({} for _ in speeds) for _ in range(n)]
    for pivot, row in moved.pivots.items():
        slopes[pivot] = tuple(_negative(_bent(scene, row, k, null_space, positions)) for k in range(len(speeds)))
    lost = any(_bent(scene, row, k, null_space, positions) for row in moved.rest for k in range(len(speeds)))

    conditions = [row["f"] for row in (*held.pivots.values(), *held.rest) if "f" in row]
    conditions += [row[key] for row in (*moved.pivots.values(), *moved.rest) for key in ("g", "h") if key in row]
    return Expansion(
        scene=jets,
        base=base,
        coordinates=coordinates,
        speeds=speeds,
        positions=tuple(positions),
        velocities=tuple(velocities),
        accelerations=tuple(accelerations),
        null_space=tuple(map(tuple, null_space)),
        slopes=tuple(slopes),
        conditions=tuple(conditions),
        assumed=_factors(ring, signs, (*held.assumed, *moved.assumed)),
        lost=lost,
    )


def _is_whole(exponent: Expression) -> bool:
    x = exponent.operand if isinstance(exponent, Negative) else exponent
    return isinstance(x, Number) and x.value.denominator == 1


def _is_smooth(system: System) -> bool:
    """Whether no root, kink or jump occurs: jets of first order do not tell sqrt(x^2 + y^2) from 0."""
    return not any(
        (isinstance(x, Call) and (x.table is not None or x.function in ("sqrt", *KINKED)))
        or (isinstance(x, Operation) and x.operator == "**" and not _is_whole(x.right))
        for expression in expressions(system)
        for x in walk(expression)
    )


@dataclass(frozen=True)
class OnManifold:
    """A system near a rest, in deviations y of independent ``coordinates``: ``scene`` over jets in y and y' (m + k).

    ``places`` are all n coordinates as jets in y.
    """

    scene: Scene
    coordinates: tuple[str, ...]
    places: tuple[Jet, ...]

    def slope(self, i: int, k: int) -> Jet:
        """dq_i/dy_k."""
        jets = cast("Jets", self.scene.algebra)
        return jets.derivative(self.places[i], k)


def on_manifold(scene: Scene, signs: Signs, found: Expansion, order: int) -> OnManifold:
    """The manifold q(y) of the motions near a rest that the constraints leave, to any order.

    Along every ray s y from the rest J(q) dq/ds = 0, whether the rows are those of f(q) = 0 or integrable ones: with
    Euler's E = sum_k y_k d/dy_k, which multiplies terms of degree k by k, J(q) E q = 0 gives the dependent terms degree
    by degree.  Rows hold no time, and have the rank on the rest that they have near it.  Raises NoClosedForm where the
    rows contradict one another.
    """
    ring, base = scene.ring, found.base
    names, size = scene.system.coordinates, range(len(found.speeds))
    places = [
        Jet(base.values[i], {(k,): x for k, x in zip(size, line, strict=True) if not x.is_zero()})
        for i, line in enumerate(found.null_space)
    ]
    for degree in range(2, order + 1):
        here = _along_places(scene, base, places, len(size), degree)
        rows = constraint_rows(here)
        jets = cast("Jets", here.algebra)
        lines: list[Row] = [{i: on_base(scene, base, x.value) for i, x in enumerate(row.partials)} for row in rows]
        for line, row in zip(lines, rows, strict=True):
            parts = (jets.times(x, jets.eulerian(place)) for x, place in zip(row.partials, places, strict=True))
            residual = sum(parts, jets.zero).degree(degree)
            line |= {key: on_base(scene, base, x) for key, x in residual.items()}
        solved = echelon(ring, signs, lines, [i for i in range(len(names)) if i not in found.speeds])
        if any(solved.rest):
            raise NoClosedForm("the constraints contradict one another near the motion")
        for i, line in solved.pivots.items():
            share = ring.number(Fraction(-1, degree))
            terms = {key: ring.times(x, share) for key, x in line.items() if isinstance(key, tuple)}
            places[i] = places[i] + Jet(ring.zero, *({},) * (degree - 1), terms)
    return OnManifold(
        _along_places(scene, base, places, len(size), order), tuple(names[i] for i in found.speeds), tuple(places)
    )


def _along_places(scene: Scene, base: Base, places: Sequence[Jet], size: int, order: int) -> Scene:
    """The system over jets of ``order`` in y and y': q = q(y), q' = sum_k dq/dy_k y'_k."""
    ring, system = scene.ring, scene.system
    names = system.coordinates
    at_rest = {name: value for name, (value, _) in motion_values(system).items()}
    lowered = dict(scene.environment) | dict(zip(names, base.values, strict=True))
    jets = Jets(ring, at_rest, dict(zip(names, places, strict=True)), lowered, order)
    environment = {name: Jet(value) for name, value in scene.environment.items()}
    speeds = [jets.deviation(size + k, ring.zero) for k in range(size)]
    for name, place in zip(names, places, strict=True):
        slopes = (jets.derivative(place, k) for k in range(size))
        environment[name] = place
        environment[velocity_name(name)] = sum(map(jets.times, slopes, speeds), jets.zero)
        environment[acceleration_name(name)] = jets.zero
    return Scene(system, jets, environment, ring)


def _factors(ring: Ring, signs: Signs, assumed: Iterable[Polynomial]) -> tuple[Polynomial, ...]:
    """What of these may vanish: their factors, each once."""
    factors: list[Polynomial] = []
    for x in assumed:
        numerator, _ = ring.fraction(x)  # what the denominator holds has been divided by before
        parts = signs.nonzero_condition(numerator).nonzero if len(numerator) <= MOST_FACTORED else (x,)
        factors += [part for part in parts if part not in factors]
    return tuple(factors)


def over_jets(scene: Scene, base: Base, whole: System | None = None, order: int = 1) -> Scene[Jet]:
    """The system over jets of ``order`` about a motion; deviations x_i, nu_i, alpha_i are i, n + i, 2n + i.

    That of input k of the ``whole`` is 3n + k.
    """
    ring, system = scene.ring, whole or scene.system
    names, values = system.coordinates, motion_values(system)
    n = len(names)
    at_rest = {name: values[name][0] for name in names if name not in base.turning}
    held = {system_input.name: scene.lower(system_input.held) for system_input in system.inputs}
    lowered = dict(scene.environment) | {name: scene.lower(value) for name, value in at_rest.items()} | held
    numbers = {name: i for i, name in enumerate(names)} | {name: 3 * n + k for k, name in enumerate(held)}
    jets = Jets(
        ring,
        at_rest | {system_input.name: system_input.held for system_input in system.inputs},
        numbers,
        lowered,
        order,
    )
    environment = {name: Jet(value) for name, value in scene.environment.items()}
    for i, name in enumerate(names):
        environment[name] = jets.deviation(i, base.values[i])
        environment[velocity_name(name)] = jets.deviation(n + i, base.rates[i])
        environment[acceleration_name(name)] = jets.deviation(2 * n + i, base.accelerations[i])
    for name, value in held.items():
        environment[name] = jets.deviation(numbers[name], value)
    return Scene(system, jets, environment, ring)


def given_motion(scene: Scene) -> Base:
    """The motion as the description gives it (``scene`` over the ring)."""
    derivatives, names = motion_derivatives(scene.system), scene.system.coordinates
    rates, accelerations = (tuple(scene.lower(derivatives[name][k]) for name in names) for k in (0, 1))
    return _turning(scene, Base((), frozenset(), rates, accelerations, {}), _moved(scene, rates))


def _moved(scene: Scene, rates: Iterable[Polynomial]) -> frozenset[str]:
    """The coordinates with these rates that turn steadily: those that no function of time leads, relations used."""
    values, derivatives, images = motion_values(scene.system), motion_derivatives(scene.system), relations(scene)
    return frozenset(
        name
        for name, rate in zip(scene.system.coordinates, rates, strict=True)
        if derivatives[name][0] == values[name][1] and not scene.ring.substitute(rate, images).is_zero()
    )


def _turning(scene: Scene, base: Base, names: Iterable[str]) -> Base:
    """The same motion, in which these turn besides: their places are their own names."""
    values, turning = motion_values(scene.system), base.turning | {*names}
    places = (
        scene.environment[name] if name in turning else scene.lower(values[name][0])
        for name in scene.system.coordinates
    )
    return replace(base, values=tuple(places), turning=turning)


def _completed(scene: Scene, signs: Signs) -> Base:
    """The motion with the rates and accelerations that follow from the constraints where none are given."""
    specified = {entry.coordinate for entry in scene.system.motion}
    open_ones = [i for i, name in enumerate(scene.system.coordinates) if name not in specified]
    still = given_motion(scene)
    still = replace(still, related=_related(scene, still.rates))
    for _ in range(MOST_ROUNDS):
        moving = replace(still, rates=_followed(scene, signs, still, still.rates, open_ones, "g"))
        turning = _moved(scene, moving.rates)
        related = _related(scene, moving.rates)
        if turning <= still.turning and related == still.related:
            return replace(moving, accelerations=_followed(scene, signs, moving, still.accelerations, open_ones, "h"))
        still = _turning(scene, replace(still, related=related), turning)
    raise NoClosedForm("the rates of the motion do not follow from the constraints")


def _followed(
    scene: Scene, signs: Signs, base: Base, values: Sequence[Polynomial], open_ones: Sequence[int], key: str
) -> tuple[Polynomial, ...]:
    """Rates ("g") or accelerations ("h") with the ``open_ones`` changed so that the rows hold, as far as they can."""
    rows = constraint_rows(over_jets(scene, base))
    reduced = echelon(scene.ring, signs, _velocities(scene, rows, base), _preferred(scene))
    polynomials = list(values)
    for i in open_ones:
        if i in reduced.pivots and key in reduced.pivots[i]:
            polynomials[i] = scene.ring.reduce(polynomials[i] - reduced.pivots[i][key])
    return tuple(polynomials)


def _preferred(scene: Scene) -> list[int]:
    """The places of the coordinates in the order in which they would rather be dependent."""
    system = scene.system
    specified = {entry.coordinate for entry in system.motion}
    names = list(system.coordinates)
    order = [*system.dependent, *(name for name in names if name not in specified), *reversed(names)]
    return [names.index(name) for name in dict.fromkeys(order)]


def _positions(scene: Scene, rows: Sequence[ConstraintRow], base: Base) -> list[Row]:
    """f and f_x of the holonomic rows; the columns are "f" and the places of the coordinates."""
    n = len(scene.system.coordinates)
    positions: list[Row] = []
    for row in rows:
        if row.position is not None:
            line: Row = {"f": row.position.value}
            line.update(_first(row.position, range(n)))
            positions.append({key: on_base(scene, base, x) for key, x in line.items()})
    return positions


def _velocities(scene: Scene, rows: Sequence[ConstraintRow], base: Base) -> list[Row]:
    """J under the places of the coordinates; "g", "h" on the motion, ("g", i), ("h", i) by deviations, ("J", i, m)."""
    n = len(scene.system.coordinates)
    velocities: list[Row] = []
    for row in rows:
        line: Row = {"g": row.velocity.value, "h": row.acceleration.value}
        line |= {("g", i): x for i, x in _first(row.velocity, range(n)).items()}
        line |= {("h", i): x for i, x in _first(row.acceleration, range(2 * n)).items()}
        for i, partial in enumerate(row.partials):
            line[i] = partial.value
            line |= {("J", i, m): x for m, x in _first(partial, range(n)).items()}
        velocities.append({key: on_base(scene, base, x) for key, x in line.items()})
    return velocities


def _first(x: Jet, places: range) -> Row:
    return {i: value for i, value in x.first.items() if i in places}


def _related(scene: Scene, rates: Sequence[Polynomial]) -> dict[int, Polynomial]:
    """The relations between parameters, and between angles that turn in step."""
    images = relations(scene)
    by_name = dict(zip(scene.system.coordinates, (scene.ring.substitute(x, images) for x in rates), strict=True))
    return images | carried(scene, by_name)


def on_base(scene: Scene, base: Base, x: Polynomial) -> Polynomial:
    """x with what others determine on the motion."""
    return scene.ring.substitute(x, dict(base.related)) if base.related else x


def _substituted(scene: Scene, row: Row, key: str, places: range, forms: Sequence[Form]) -> Form:
    """sum of row[key, i] times forms[i]."""
    return combined(scene, ((row[key, i], forms[i]) for i in places if (key, i) in row))


def _bent(
    scene: Scene, row: Row, k: int, null_space: Sequence[Sequence[Polynomial]], positions: Sequence[Form]
) -> Form:
    """Entry k of (J_x Y_0) in one row."""
    ring = scene.ring
    by_place: Form = {}
    for key, x in row.items():
        if isinstance(key, tuple) and key[0] == "J" and not null_space[key[1]][k].is_zero():
            by_place[key[2]] = by_place.get(key[2], ring.zero) + ring.times(x, null_space[key[1]][k])
    return combined(scene, ((x, positions[m]) for m, x in by_place.items()))


def combined(scene: Scene, terms: Iterable[tuple[Polynomial, Form]]) -> Form:
    """The sum of factor times form, zeros left out."""
    ring = scene.ring
    total: Form = {}
    for factor, form in terms:
        for i, x in form.items():
            total[i] = total.get(i, ring.zero) + ring.times(factor, x)
    return {i: r for i, x in total.items() if not (r := ring.reduce(x)).is_zero()}


def _sum(scene: Scene, first: Form, second: Form) -> Form:
    return combined(scene, ((scene.ring.one, first), (scene.ring.one, second)))


def _negative(form: Form) -> Form:
    return {i: -x for i, x in form.items()}


# Rows of linear equations in the ring, brought to reduced echelon form with pivots that are chosen with care.
#
# A row is a mapping from labels of columns to polynomials, absent ones are zero; only some columns may hold pivots, and
# what is done to them is done to the whole row.


Column = Hashable
Row = dict[Column, Polynomial]


@dataclass(frozen=True)
class Echelon:
    """``pivots``: the reduced rows by their pivots, whose coefficient is 1; ``rest``: rows without any.

    ``assumed`` are the polynomials by which was divided although they may vanish at some values of the parameters:
    what is found holds where none of them does.
    """

    pivots: Mapping[int, Row]
    rest: tuple[Row, ...]
    assumed: tuple[Polynomial, ...]


def echelon(ring: Ring, signs: Signs, rows: Sequence[Mapping[Column, Polynomial]], columns: Sequence[int]) -> Echelon:
    """Reduced echelon form with pivots in ``columns``, the first ones preferred.

    In the first column that has an entry left, an entry that is a number is taken, else one that cannot vanish, else
    a later column that has such a one; only where there is none anywhere is divided by what might vanish.  Raises
    NoClosedForm.
    """
    pending = [{key: r for key, x in row.items() if not (r := ring.reduce(x)).is_zero()} for row in rows]
    pivots: dict[int, Row] = {}
    assumed: list[Polynomial] = []
    while True:
        best = _best(ring, signs, pending, columns)
        if best is None:
            return Echelon(pivots, tuple(pending), tuple(assumed))
        rank, column, chosen = best
        row = pending.pop(chosen)
        pivot = row[column]
        if rank == _OPEN:
            assumed.append(pivot)
        inverse = ring.reciprocal(pivot)
        row = {key: ring.reduce(ring.times(x, inverse)) for key, x in row.items()} | {column: ring.one}
        pending = [_without(ring, other, column, row) for other in pending]
        pivots = {key: _without(ring, other, column, row) for key, other in pivots.items()} | {column: row}


_NUMBER, _SURE, _OPEN = range(3)


def _best(ring: Ring, signs: Signs, rows: Sequence[Row], columns: Sequence[int]) -> tuple[int, int, int] | None:
    """(how sure, column, number of the row) of the next pivot."""
    open_one = None
    for column in columns:
        entries = [(number, row[column]) for number, row in enumerate(rows) if column in row]
        for number, x in entries:
            if x.is_constant():
                return _NUMBER, column, number
        for number, x in sorted(entries, key=lambda entry: len(entry[1])):
            numerator, _ = ring.fraction(x)  # what the denominator holds has been divided by before
            if numerator.is_constant() or signs.never_zero(numerator):
                return _SURE, column, number
            open_one = open_one or (_OPEN, column, number)
    return open_one


def _without(ring: Ring, row: Row, column: Column, pivot: Row) -> Row:
    """The row less its entry in a column times the pivot's row."""
    factor = row.get(column)
    if factor is None:
        return row
    left = dict(row)
    for key, x in pivot.items():
        value = ring.reduce(left.get(key, ring.zero) - ring.times(factor, x))
        if value.is_zero():
            left.pop(key, None)
        else:
            left[key] = value
    return left


# The equations, projected on the motions that the constraints allow, to first order.
#
# With the residuals r = M q'' - f of the open tree over jets (their constant part r_0 is what the constraint forces
# supply on the motion) and Y,
#
#     Y^T r = Y_0^T r_0 + (Y_0^T r_x + Y_x^T r_0) x + Y_0^T r_nu nu + Y_0^T r_alpha alpha
#
# is linear in the independent deviations once the dependent ones are put in: with speeds eta,
#
#     A eta' + B eta + C x = gains u,    A = Y_0^T M Y_0,    x' = S eta + T x,
#
# u the deviations of inputs.
#
# The term Y_x^T r_0 is the one that is forgotten where only f and J_0 are linearised.


Rows = tuple[tuple[Polynomial, ...], ...]


@dataclass(frozen=True)
class Projected:
    """``constant`` is Y_0^T r_0, one entry a speed; A and B square in the speeds, C by the independent coordinates.

    ``gains`` has a column for each input.  ``S`` and ``T`` have a row for each independent coordinate.
    """

    constant: tuple[Polynomial, ...]
    A: Rows
    B: Rows
    C: Rows
    gains: Rows
    S: Rows
    T: Rows


def projected(scene: Scene, found: Expansion) -> Projected:
    """The projected equations; ``scene`` is the one over the ring.  Raises NoClosedForm."""
    ring, n = scene.ring, len(scene.system.coordinates)
    needed: Sequence[Jet] = [
        Jet(on_base(scene, found.base, x.value), {key: on_base(scene, found.base, y) for key, y in x.degree(1).items()})
        for x in residuals(found.scene).values()
    ]
    inputs = [3 * n + k for k in range(len(found.scene.system.input_names))]
    deviations = (*found.positions, *found.velocities, *found.accelerations, *({i: ring.one} for i in inputs))
    own = [combined(scene, ((x, deviations[i]) for i, x in jet.first.items())) for jet in needed]
    constant, forms = [], []
    for k in range(len(found.speeds)):
        column = [found.null_space[i][k] for i in range(n)]
        constant.append(ring.dot(column, [jet.value for jet in needed]))
        parts: list[tuple[Polynomial, Form]] = list(zip(column, own, strict=True))
        parts += [(needed[i].value, found.slopes[i][k]) for i in range(n)]
        forms.append(combined(scene, parts))
    rates = [found.velocities[i] for i in found.coordinates]
    places = list(found.coordinates)
    speeds = [n + k for k in found.speeds]
    return Projected(
        constant=tuple(constant),
        A=_cut(scene, forms, [2 * n + k for k in found.speeds]),
        B=_cut(scene, forms, speeds),
        C=_cut(scene, forms, places),
        gains=tuple(tuple(-x for x in row) for row in _cut(scene, forms, inputs)),
        S=_cut(scene, rates, speeds),
        T=_cut(scene, rates, places),
    )


def on_leaf(scene: Scene, found: Expansion, equations: Projected) -> tuple[Expansion, Projected]:
    """The same where velocity constraints are integrable: on the leaf F(q) = F(q_0) of the unperturbed motion.

    Frobenius: dF = mu J dq with a regular matrix mu, so that deviations on the leaf are those with  J_0 x = 0,
    x = Y_0 x_s  with the coordinates x_s of the independent speeds;  x_s' = eta, and  A x_s'' + B x_s' + C Y_0 x_s  are
    Lagrange's equations of the leaf to first order.
    """
    ring = scene.ring
    rows = [found.null_space[i] for i in found.coordinates]
    columns = list(zip(*rows, strict=True))
    position = tuple(tuple(ring.dot(line, column) for column in columns) for line in equations.C)
    size = range(len(found.speeds))
    unit = tuple(tuple(ring.one if i == k else ring.zero for k in size) for i in size)
    still = tuple((ring.zero,) * len(size) for _ in size)
    forms = tuple(
        {i: x for i, x in zip(found.speeds, line, strict=True) if not x.is_zero()} for line in found.null_space
    )
    return replace(found, coordinates=found.speeds, positions=forms), replace(equations, C=position, S=unit, T=still)


def felt(found: Expansion, equations: Projected) -> tuple[int, ...]:
    """The independent coordinates on which the equations of the speeds depend, directly or through others.

    And those whose rates depend on themselves, directly or through others (the angle of a light trailer behind its
    car): they have roots of their own.  All others (a place on the ground, the angle of a wheel) follow by quadratures
    and drop out.
    """
    rows = {j: {m for m, x in enumerate(row) if not x.is_zero()} for j, row in enumerate(equations.T)}
    pending = {j for row in equations.C for j, x in enumerate(row) if not x.is_zero()}
    pending |= {j for j in rows if j in reached(rows, rows[j])}
    return tuple(sorted(reached(rows, pending)))


def _cut(scene: Scene, forms: Sequence[Form], columns: Sequence[int]) -> Rows:
    return tuple(tuple(form.get(j, scene.ring.zero) for j in columns) for form in forms)
