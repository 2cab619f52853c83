"""Savings that the description itself allows: frames without mass, point masses, axes nobody turns about, gravity."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from flint import arb, ctx

from mbsym.algebra import rationals
from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import Failure
from mbsym.algebra.point import Balls
from mbsym.expressions.message import Message
from mbsym.expressions.tree import ZERO, Expression, names
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.orbit import Orbit, central_inertia, trace
from mbsym.mechanics.programs import forward_dynamics
from mbsym.mechanics.variables import ring_of
from mbsym.model.loads import EXACT, GRAVITY_ORDERS, NewtonianGravity
from mbsym.model.system import Body, Inertia, Rotation, System, Tensor, acceleration_name, rational
from mbsym.model.welded import lumped
from mbsym.numerics.ledger.entry import OPERATIONS, SECONDS, Measure, Saving
from mbsym.numerics.ledger.work import Symbols, Work, changed_bodies, moving_names
from mbsym.numerics.planning.kinds import Kind
from mbsym.numerics.scenario import PRECISION, Scenario


def massless_bodies(work: Work) -> Iterator[Saving]:
    """Frames without mass and inertia, against the same frames with a mass."""
    massless = {body.name for body in work.system.bodies if rational(body.mass) == 0 and body.inertia is None}
    if not massless:
        return
    symbols = Symbols(work.system)

    def heavy(body: Body) -> Body:
        return replace(body, mass=symbols("m")) if body.name in massless else body

    why = Message("structural zero: m = 0 and no inertia, so T, forces and moments of the body are identically 0")
    yield _against(work, Kind.MASSLESS, massless, why, changed_bodies(work.system, heavy, symbols))


def welded_bodies(work: Work) -> Iterator[Saving]:
    """Bodies without a coordinate of their own, lumped into what carries them, against each on a frame of its own."""
    welds = lumped(work.system)
    if not welds:
        return
    work.begin(work.price)
    apart, spent = work.timed(lambda: forward_dynamics(work.system, ring_of(work.system), apart=True))
    every = apart.program.operations(apart.accelerations, work.given)
    measures = (
        Measure("operations of q'' for one state", OPERATIONS, every, work.operations(work.forward.accelerations)),
        Measure("seconds of writing the program of q''", SECONDS, spent, work.cost[1]),
    )
    carriers = ", ".join(dict.fromkeys(welds.values()))
    why = Message(
        "no coordinate moves them against [[carriers]]: m, m c and the tensor add up there, once, by Steiner's theorem",
        carriers=carriers,
    )
    yield Saving(Kind.WELDED, tuple(welds), why, Certainty.PROVED, measures)


def point_masses(work: Work) -> Iterator[Saving]:
    """Bodies with a mass and no tensor, against the same bodies with principal moments about their mass centres."""
    points = {body.name for body in work.system.bodies if rational(body.mass) != 0 and body.inertia is None}
    if not points:
        return
    symbols = Symbols(work.system)

    def extended(body: Body) -> Body:
        if body.name not in points:
            return body
        a, b, c = symbols("J1"), symbols("J2"), symbols("J3")
        tensor: Tensor = ((a, ZERO, ZERO), (ZERO, b, ZERO), (ZERO, ZERO, c))
        return replace(body, inertia=Inertia("mass centre", tensor))

    why = Message("structural zero: the tensor about the mass centre is 0, so is omega.J omega/2 and its moment")
    yield _against(work, Kind.POINTS, points, why, changed_bodies(work.system, extended, symbols))


def unused_axes(work: Work) -> Iterator[Saving]:
    """Joints that turn about fewer than three axes, against joints with constant angles about the others."""
    affected = {body.name for body in work.system.bodies if len(list(body.rotation.turns())) < 3}
    if not affected:
        return
    symbols = Symbols(work.system)

    def turned(body: Body) -> Body:
        if body.name not in affected:
            return body
        turns = list(body.rotation.turns())
        while len(turns) < 3:
            turns.append((turns[-1][0] % 3 + 1 if turns else 1, symbols("x")))
        return replace(body, rotation=Rotation(tuple(x for x, _ in turns), tuple(x for _, x in turns)))

    why = Message("structural: a turn that is not there is the identity matrix, and is never multiplied")
    yield _against(work, Kind.AXES, affected, why, changed_bodies(work.system, turned, symbols))


def constant_rotations(work: Work) -> Iterator[Saving]:
    """Turns by angles that do not move, against the same turns worked out in every state."""
    moving = moving_names(work.system)

    def constant(angle: Expression) -> bool:
        return angle != ZERO and not names(angle) & moving

    affected = [b.name for b in work.system.bodies if any(constant(angle) for _, angle in b.rotation.turns())]
    if not affected:
        return
    symbols = Symbols(work.system)

    def turned(body: Body) -> Body:
        angles = tuple(symbols("x") if constant(angle) else angle for angle in body.rotation.angles)
        return replace(body, rotation=Rotation(body.rotation.axes, angles))

    other = changed_bodies(work.system, turned, symbols)
    why = Message("the angle holds no coordinate and no time: its sine and cosine are worked out once, or are 0 and 1")
    measures = work.right_hand_sides(other, changing=symbols.names)
    yield Saving(Kind.TURNS, tuple(affected), why, Certainty.PROVED, measures)


def gravity_orders(work: Work) -> Iterator[Saving]:
    """Terms of the Newtonian field above the chosen order, against the next order; safe by their size only."""
    for place, load in enumerate(work.system.loads):
        if not isinstance(load, NewtonianGravity) or load.order == EXACT:
            continue
        order = int(load.order)
        following = GRAVITY_ORDERS[GRAVITY_ORDERS.index(order) + 1]
        loads = list(work.system.loads)
        loads[place] = replace(load, order=following)
        measures = work.right_hand_sides(replace(work.system, loads=tuple(loads), claims=()))
        ratio = relative_size(work.numbers, load)
        if ratio is None:
            why, how = (
                Message(
                    "terms above (l/R)^[[order]] are dropped; without numbers for l and R nobody knows if that is safe",
                    order=order,
                ),
                Certainty.UNDECIDED,
            )
        else:
            dropped, kept = ratio ** (order + 1), ratio ** (order - 1)
            why = Message(
                "with the size l of the bodies about O1, l/R = [[ratio]]: the largest term dropped is "
                "about (l/R)^[[order]] = [[dropped]] of nu m/R, [[kept]] of the terms of order 2",
                ratio=f"{ratio:.1e}",
                order=order + 1,
                dropped=f"{dropped:.1e}",
                kept=f"{kept:.1e}",
            )
            how = Certainty.ESTIMATED
        yield Saving(
            Kind.GRAVITY, (Message("terms of the field above order [[order]]", order=order),), why, how, measures
        )


def relative_size(numbers: Scenario | None, load: NewtonianGravity) -> float | None:
    """l/R at t = 0: the greatest distance of a body's mass from O1 (with its radius of gyration) over that of O1."""
    if numbers is None:
        return None
    system = numbers.system
    state = dict(zip((*system.coordinates, *system.velocities), numbers.state, strict=True))
    values = {**numbers.parameters, **state, **{name: initial for name, (initial, _) in numbers.prescribed.items()}}
    with ctx.workprec(PRECISION):
        environment = {name: rationals.ball(x) for name, x in values.items()}
        environment |= {"t": arb(0), "pi": arb.pi()}
        for name in system.coordinates:
            environment[acceleration_name(name)] = arb(0)
        try:
            scene = Scene(system, Balls(environment), environment, ring_of(system))
            orbit = Orbit(load, scene)
            largest = 0.0
            for motion, _, c in orbit.bodies():
                tensor = central_inertia(scene, motion)
                gyration = arb(0) if tensor is None or motion.mass.contains(0) else trace(tensor) / (2 * motion.mass)
                largest = max(largest, float((c[0] ** 2 + c[1] ** 2 + c[2] ** 2).sqrt() + abs(gyration).sqrt()))
            ratio = largest * float(abs(orbit.inverse))
        except Failure:
            return None
    return ratio if 0 < ratio < float("inf") else None


def _against(work: Work, kind: Kind, bodies: set[str], why: Message, other: System) -> Saving:
    """What these bodies save against others in a system."""
    measures = (*work.right_hand_sides(other), *work.kinetic_energies(other))
    listed = tuple(body.name for body in work.system.bodies if body.name in bodies)
    return Saving(kind, listed, why, Certainty.PROVED, measures)
