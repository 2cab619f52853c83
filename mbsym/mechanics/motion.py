"""The unperturbed motion and the relations between parameters, as substitutions in the ring.

The motion is q = value + rate t.  A coordinate at rest is replaced by its value everywhere; one that turns at a
constant rate keeps its own generator, and has to drop out (otherwise the motion, or the linearisation about it, is
not steady).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import replace

from mbsym.algebra.factors import occurring
from mbsym.algebra.failures import Failure
from mbsym.algebra.remembered import remembered
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.tree import ZERO, Expression, Name, add, divide, multiply, number, subtract
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.variables import rate_of, time_derivative
from mbsym.model.system import MotionEntry, System


def motion_values(system: System) -> dict[str, tuple[Expression, Expression]]:
    """(value, rate) for every coordinate; zero where the description names none."""
    specified = {entry.coordinate: (entry.value, entry.rate) for entry in system.motion}
    return {name: specified.get(name, (ZERO, ZERO)) for name in system.coordinates}


def motion_derivatives(system: System) -> dict[str, tuple[Expression, Expression]]:
    """(q', q'') of every coordinate on the unperturbed motion: its value may hold free functions of time."""
    derivatives = {}
    for name, (value, rate) in motion_values(system).items():
        speed = time_derivative(value, system)
        derivatives[name] = add(rate, speed), time_derivative(speed, system)
    return derivatives


@remembered  # what is found scene by scene is asked for again and again
def turning(scene: Scene) -> tuple[str, ...]:
    """The coordinates whose unperturbed rate is not zero, relations between parameters used."""
    rates = {name: scene.lower(rate) for name, (_, rate) in motion_values(scene.system).items()}
    if all(rate.is_zero() for rate in rates.values()):
        return ()
    ring, images = scene.ring, relations(scene)
    return tuple(name for name, rate in rates.items() if not ring.substitute(rate, images).is_zero())


def unperturbed(scene: Scene) -> dict[int, Polynomial]:
    """Generator indices and their values on the unperturbed motion (scene over the ring)."""
    ring: Ring = scene.ring
    images: dict[int, Polynomial] = {}
    spinning = turning(scene)
    for system_input in scene.system.inputs:
        images |= _standing(scene, "prescribed", system_input.name, system_input.held)
    derivatives = motion_derivatives(scene.system)
    for name, (value, _) in motion_values(scene.system).items():
        for kind, derivative in zip(("velocity", "acceleration"), derivatives[name], strict=True):
            images[ring.index(kind, name)] = scene.lower(derivative)
        if name in spinning:
            continue
        images |= _standing(scene, "coordinate", name, value)
    return images | carried(scene)


def places(scene: Scene, initial: bool = False) -> list[dict[int, Polynomial]]:
    """``unperturbed`` where a motion is given, and the same of the ``initial`` position, where the ring has them."""
    system, images = scene.system, []
    positions = [(x.coordinate, x.position) for x in system.initial if initial]
    begun = tuple(MotionEntry(name, position, ZERO) for name, position in positions if position is not None)
    for entries in filter(None, (system.motion, begun)):
        with suppress(Failure):
            there = Scene(replace(system, motion=entries), scene.ring, scene.environment, scene.ring, bodies=False)
            images.append(unperturbed(there))
    return images


def vanishing(ring: Ring, x: Polynomial, places: Iterable[Mapping[int, Polynomial]]) -> list[bool]:
    """In which of the ``places`` it is known to be zero."""
    return [ring.is_zero(ring.substitute(x, dict(place))) is True for place in places]


def in_step(ring: Ring, rates: Mapping[str, Polynomial]) -> dict[str, tuple[str, int]]:
    """Angles that turn k times as fast as a slower one, by name: that one, and the whole number k, where k is known.

    Two wheels of one size, two pendulums that turn over together: the angle between them does not vary.
    """
    multiples: dict[str, tuple[str, int]] = {}
    own: list[str] = []
    turning = [(name, rate) for name, rate in rates.items() if name in ring.angles and not rate.is_zero()]
    for name, rate in sorted(turning, key=lambda item: abs(item[1].leading_coefficient())):
        for other in own:
            ratio = rate.leading_coefficient() / rates[other].leading_coefficient()
            if ratio.q == 1 and ring.is_zero(rate - ratio * rates[other]):
                multiples[name] = (other, int(ratio))
                break
        else:
            own.append(name)
    return multiples


def carried(scene: Scene, rates: Mapping[str, Polynomial] | None = None) -> dict[int, Polynomial]:
    """The generators of angles ``in_step`` with another one, q = value + k (q_1 - value_1), and what they are.

    What is prescribed counts among them.  ``rates`` are those of the motion where they are not all given.
    """
    system = scene.system
    values = motion_values(system) | {item.name: (item.initial or ZERO, item.rate) for item in system.of_constant_rate}
    driven, images = [item.name for item in system.of_constant_rate], relations(scene)
    if rates is None:
        return dict(_carried(scene))
    moved = {name: scene.ring.substitute(scene.lower(values[name][1]), images) for name in driven}
    polynomials: dict[int, Polynomial] = {}
    for name, (first, ratio) in in_step(scene.ring, {**moved, **rates}).items():
        way = multiply(number(ratio), subtract(Name(first), values[first][0]))
        with suppress(Failure):  # a part of an angle that the ring does not know
            kind = "prescribed" if name in driven else "coordinate"
            polynomials |= _standing(scene, kind, name, add(values[name][0], way))
    return polynomials


@remembered
def _carried(scene: Scene) -> dict[int, Polynomial]:
    values, images = motion_values(scene.system), relations(scene)
    own = {name: scene.ring.substitute(scene.lower(values[name][1]), images) for name in turning(scene)}
    return carried(scene, own)


def _standing(scene: Scene, kind: str, name: str, value: Expression) -> dict[int, Polynomial]:
    """The generators of a name, its sine and cosine included, and what they are where it has a constant value."""
    ring: Ring = scene.ring
    images: dict[int, Polynomial] = {ring.index(kind, name): scene.lower(value)}
    if name in ring.angles:
        sine, cosine = scene.lower.angle(divide(value, number(ring.angles[name])))
        images |= {ring.index("sine", name): sine, ring.index("cosine", name): cosine}
    return images


def rate_on_motion(scene: Scene, x: Polynomial) -> Polynomial:
    """dx/dt of a quantity on the unperturbed motion: sum of rate dx/d(name) over what runs there, and dx/dt itself.

    What runs are the coordinates that turn steadily, the prescribed quantities and t.  Raises NoClosedForm.
    """
    ring: Ring = scene.ring
    values = motion_values(scene.system)
    running = ((name, scene.lower(values[name][1])) for name in turning(scene) if ring.depends_on(x, name))
    return rate_of(ring, scene.lower, scene.system, x, running)


def relations(scene: Scene) -> dict[int, Polynomial]:
    """Generator indices of dependent parameters, their sines and cosines, and the values in independent ones."""
    return dict(_relations(scene))


@remembered
def _relations(scene: Scene) -> dict[int, Polynomial]:
    ring: Ring = scene.ring
    images: dict[int, Polynomial] = {}
    for relation in scene.system.relations:
        step = {ring.index("parameter", relation.name): scene.lower(relation.value)}
        if relation.name in ring.angles:
            sine, cosine = scene.lower.angle(divide(relation.value, number(ring.angles[relation.name])))
            step |= {ring.index("sine", relation.name): sine, ring.index("cosine", relation.name): cosine}
        step = {k: ring.substitute(image, images) for k, image in step.items()}
        images = {k: ring.substitute(image, step) for k, image in images.items()} | step
    return images


def dependent(scene: Scene, images: Mapping[int, Polynomial]) -> dict[str, Polynomial]:
    """The parameters among the generators of some images, by name."""
    generators = scene.ring.generators
    return {generators[k].name: image for k, image in images.items() if generators[k].kind == "parameter"}


def unperturbed_with(scene: Scene, images: dict[int, Polynomial]) -> dict[int, Polynomial]:
    """``unperturbed`` with further substitutions of parameters, which reach the values of the motion as well.

    A substitution is simultaneous: of rate Omega and Omega = a - b it would leave the Omega of the rate.
    """
    ring: Ring = scene.ring
    return {k: ring.substitute(x, dict(images)) for k, x in unperturbed(scene).items()} | images


def determined(scene: Scene, solved: Iterable[tuple[str, Polynomial]]) -> dict[int, Polynomial]:
    """``relations`` on a motion that exists under conditions: what these were ``solved`` for is put into them, too.

    With d = rho b0 and the condition rho = 0 it is d = 0.
    """
    ring: Ring = scene.ring
    conditions = {ring.index("parameter", name): value for name, value in solved}
    images = {k: ring.substitute(image, dict(conditions)) for k, image in relations(scene).items()}
    return images | conditions


def steadied(scene: Scene, x: Polynomial) -> Polynomial:
    """x on the unperturbed motion, without what runs there if it does not vary: k (q - v t) where q' = v.

    What has no rate on the motion has the value of t = 0 (a prescribed quantity that starts nowhere starts at 0).
    Sines and cosines of angles stay as they are.
    """
    ring: Ring = scene.ring
    running = {*turning(scene), *(item.name for item in scene.system.prescribed), "t"}
    together = carried(scene)
    x = ring.substitute(x, together) if together else x
    varying = unsteady(scene, x)
    turned = {ring.index(kind, name) for name in {*varying} & {*ring.angles} for kind in ("sine", "cosine")}
    if not varying or not running.issuperset(varying) or turned & {*occurring([x])} or not is_steady(scene, x):
        return x
    values = motion_values(scene.system)
    images = {ring.index("time", "t"): ring.zero}
    for name in turning(scene):
        images |= _standing(scene, "coordinate", name, values[name][0])
    for item in scene.system.prescribed:
        images |= _standing(scene, "prescribed", item.name, item.initial or ZERO)
    return ring.substitute(x, images)


def is_steady(scene: Scene, x: Polynomial) -> bool:
    """Whether x does not vary along the unperturbed motion; also of what deviates from it, if it is kept."""
    try:
        return scene.ring.is_zero(rate_on_motion(scene, x)) is True
    except Failure:
        return False


def unsteady(scene: Scene, x: Polynomial) -> tuple[str, ...]:
    """The quantities that still vary with time in x: turning coordinates, prescribed quantities, t.

    Of a free function of time its name is told where x holds a derivative of it.
    """
    functions = {item.name: item.given or item.name for item in scene.system.prescribed}
    moving = [*scene.system.coordinates, *functions, "t"]
    held = (functions.get(name, name) for name in scene.ring.dependencies(x, moving))
    return tuple(dict.fromkeys(held))
