"""What the condition of a symmetry is made of: momenta and positions, and their rates by the equations of motion."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.speeds import SpeedForm
from mbsym.problems import integrals
from mbsym.problems.energy import Energy
from mbsym.problems.equations import Equations, convective_rate
from mbsym.problems.in_speeds.speed_integrals import Field
from mbsym.problems.in_speeds.speeds import SpeedEquations
from mbsym.problems.vector_field import put_in

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


def in_coordinates(scene: Scene, energy: Energy, equations: Equations, images: Images) -> Blocks:
    """The blocks of a system in generalised coordinates."""
    ring, names = scene.ring, scene.system.coordinates
    momenta = [ring.velocity_derivative(energy.kinetic_energy.polynomial, name) for name in names]
    rates = [
        ring.reduce(convective_rate(scene, ring, p) + f.polynomial)
        for p, f in zip(momenta, equations.forcing, strict=True)
    ]
    speeds = [ring.generator("velocity", name) for name in names]
    lagrangian = energy.kinetic_energy.polynomial + energy.force_function.polynomial
    whole = ring.reduce(ring.dot(momenta, speeds) - lagrangian)
    power = convective_rate(scene, ring, whole) + ring.dot(speeds, [f.polynomial for f in equations.forcing])

    def keeps(x: Polynomial) -> Certainty | None:
        rate = integrals.rate_on_motion(scene, equations, x)
        if rate is not None:
            zero = ring.is_zero(put_in(ring, rate[0], images))
            return None if zero is False else Certainty.PROVED if zero else Certainty.UNDECIDED
        if images:
            return Certainty.UNDECIDED
        return Certainty.VERIFIED if integrals.is_conserved(scene, equations, x) else None

    return _with(
        ring,
        images,
        (names, momenta, rates),
        [(ring.generator("coordinate", name), ring.generator("velocity", name)) for name in names],
        (whole, ring.reduce(power)),
        plain=ring.reduce,
        state=(
            *(lambda x, name=name: ring.derivative(x, name) for name in names),
            *(lambda x, name=name: ring.velocity_derivative(x, name) for name in names),
        ),
        norms=(),
        vanishes=ring.is_zero,
        keeps=keeps,
        in_speeds=False,
    )


def in_speeds(form: SpeedForm, energy: Energy, equations: SpeedEquations, images: Images) -> Blocks:
    """The blocks of a system in speeds, unit vectors and quaternions."""
    ring = form.ring
    kinetic, force = energy.kinetic_energy.polynomial, energy.force_function.polynomial
    momenta = [ring.derivative(kinetic, u.name) for u in form.speeds]
    forcing = [f.polynomial for f in equations.forcing]
    rates = [ring.reduce(form.drift(p) + f) for p, f in zip(momenta, forcing, strict=True)]
    own = [ring.context.gen(u.index) - at_rest for u, at_rest in zip(form.speeds, form.drifts, strict=True)]
    whole = ring.reduce(sum((ring.times(p, u) for p, u in zip(momenta, own, strict=True)), ring.zero) - kinetic - force)
    work = sum((ring.times(u, f) for u, f in zip(own, forcing, strict=True)), ring.zero)
    field = Field(form, equations)

    def keeps(x: Polynomial) -> Certainty | None:
        zero = form.vanishes(put_in(ring, field.rate(x), images))
        return None if zero is False else Certainty.PROVED if zero else Certainty.UNDECIDED

    replaced = [name for body in form.by_vectors for name in body.own_angles]
    by_quaternion = [body.orientation[0].components for body in form.by_quaternion]
    named = [
        *form.coordinates,
        *replaced,
        *(name for one in by_quaternion for name in one),
        *(u.name for u in form.speeds),
    ]
    return _with(
        ring,
        images,
        ([u.name for u in form.speeds], momenta, rates),
        [(ring.context.gen(s.index), form.rates[s.name]) for s in form.positions],
        (whole, ring.reduce(form.drift(whole) + work)),
        plain=lambda x: ring.reduce(form.in_angles(x)),
        state=tuple(lambda x, name=name: ring.derivative(x, name) for name in named),
        norms=tuple(by_quaternion),
        vanishes=form.vanishes,
        keeps=keeps,
        in_speeds=True,
    )


def _with(
    ring: Ring,
    images: Images,
    directions: tuple[Sequence[str], Sequence[Polynomial], Sequence[Polynomial]],
    positions: Sequence[tuple[Polynomial, Polynomial]],
    energy: tuple[Polynomial, Polynomial],
    **others: Any,
) -> Blocks:
    names, momenta, rates = directions

    def put(listed: Sequence[Polynomial]) -> tuple[Polynomial, ...]:
        return tuple(put_in(ring, x, images) for x in listed)

    whole, power = put(energy)
    return Blocks(
        ring,
        tuple(names),
        put(momenta),
        put(rates),
        put([s for s, _ in positions]),
        put([v for _, v in positions]),
        whole,
        power,
        images,
        **others,
    )
