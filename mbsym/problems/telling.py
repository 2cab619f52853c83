"""Kinematics, energies and equations of motion told through named intermediates, in the order of the recursion.

The program of ``mbsym.mechanics.body_equations`` is carried into a ring in which direction cosines, components of
angular velocities, composite inertias and so on are generators of their own.  Their names never look like a name of the
system, in any target.  What is told is compared with the equations as they were derived before (``agrees``).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import ctx

from mbsym.algebra.base import Scalar
from mbsym.algebra.failures import TooLargeError
from mbsym.algebra.program import Node, Program
from mbsym.algebra.ring import Ring
from mbsym.expressions.message import Message
from mbsym.formulas.formula import Column, Formula, Matrix
from mbsym.formulas.latex import latex_symbol
from mbsym.formulas.names import free_name
from mbsym.formulas.told import Told, tell
from mbsym.formulas.wolfram import wolfram_name
from mbsym.mechanics.body_equations import BodyEquations, body_equations
from mbsym.mechanics.energy import kinetic_energy
from mbsym.mechanics.intermediates import Meaning, Quantity
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.kinds import force_function
from mbsym.mechanics.newton_euler import residuals
from mbsym.mechanics.oracle import State
from mbsym.mechanics.states import FINE, enclosed_states
from mbsym.mechanics.variables import ring_environment, ring_of
from mbsym.model.system import System, acceleration_name
from mbsym.problems.checks import STATES, agreement

#: Where such a name would look like one of the system's, these letters are tried.
SPARE = ("b", "d", "g", "h", "k", "p", "x", "B", "C", "E", "P", "Q", "W", "X", "Y", "Z", "eta", "xi", "zeta")

#: Working precision of the comparison, in bits.
PRECISION = 256


@dataclass(frozen=True)
class ToldKinematics:
    """One body's absolute angular velocity and the velocities of O_k and C_k, in its own axes."""

    angular_velocity: Column
    velocity_origin: Column
    velocity_mass_centre: Column


@dataclass(frozen=True)
class ToldSystem:
    """``told`` holds every definition; the formulas are the results of problems 1 to 3 in terms of them."""

    told: Told[Meaning]
    kinematics: Mapping[str, ToldKinematics]
    kinetic_energy: Formula
    force_function: Formula
    mass_matrix: Matrix
    forcing: Column


#: A system of more operations has definitions for pages (about one in seven operations is one), and takes seconds:
#: a hand of 16 joints has 2200, a humanoid of 50 coordinates 19000.
MOST_OPERATIONS = 5_000

#: Some of what is derived is not needed: of fifty systems the half at most, but for two that are told in a line.
MOST_DERIVED = 10 * MOST_OPERATIONS


class _Limited(Program):
    """A program whose making is given up where it is too long to be told."""

    def _node(self, operation: str, operands: tuple[int, ...] = (), payload: str | Fraction | None = None) -> Node:
        if len(self.instructions) > MOST_DERIVED:
            raise _too_many(MOST_DERIVED)
        return super()._node(operation, operands, payload)


def _too_many(most: int) -> TooLargeError:
    text = "more than [[most]] operations, too many to be told through intermediates"
    return TooLargeError(text, most=most)


def told_system(system: System, ring: Ring, terms: int) -> ToldSystem:
    """The results told through named intermediates; ``ring`` is the system's.

    Raises NoClosedForm and SingularPoint, TooLargeError where nobody would read so many definitions, and Untold where
    they are not what the general recursion gives.
    """
    equations = body_equations(system, ring, _Limited())
    outputs = _outputs(equations)
    if len(equations.program.live(outputs)) > MOST_OPERATIONS:
        raise _too_many(MOST_OPERATIONS)
    numbers = {body.name: k for k, body in enumerate(system.bodies, start=1)}
    proposed = _names(ring, equations, numbers)
    cosines = {name for k, name in proposed.items() if equations.meanings[k].quantity is Quantity.DIRECTION_COSINE}

    def ring_with(moving: Sequence[str], fixed: Sequence[str]) -> Ring:
        made = ring_of(system, terms, moving=moving, fixed=fixed)
        made.leading = frozenset(made.index("prescribed", name) for name in moving if name not in cosines)
        return made

    listing = tell(
        equations.program,
        outputs,
        {k: (name, equations.meanings[k]) for k, name in proposed.items()},
        frozenset((*system.parameter_names, "pi")),
        ring_with,
        lambda made: ring_environment(system, made),
        _stem(Quantity.COMMON, _Taken(ring), [str(k) for k in range(1, 500)]),
    )
    sorted_out = _sorted_out(system, listing, equations)
    wrong = disagreement(sorted_out, system, ring)
    if wrong:
        raise Untold(wrong)
    return sorted_out


class Untold(Exception):
    """What is told through intermediates is not what was derived: a mistake of the program."""


def _outputs(equations: BodyEquations) -> list[Node]:
    vectors = [x for motion in equations.motions.values() for v in motion for x in v]
    entries = [x for row in equations.mass_matrix for x in row]
    return [*vectors, *entries, *equations.forcing, equations.kinetic_energy, equations.force_function]


def _sorted_out(system: System, listing: Told[Meaning], equations: BodyEquations) -> ToldSystem:
    """The formulas in their places: the order is that of ``_outputs``."""
    pending = iter(listing.formulas)

    def take(count: int) -> tuple[Formula, ...]:
        return tuple(next(pending) for _ in range(count))

    n = len(system.coordinates)
    kinematics = {name: ToldKinematics(take(3), take(3), take(3)) for name in equations.motions}
    matrix = Matrix(tuple(take(n) for _ in range(n)))
    forcing = take(n)
    kinetic, force = take(2)
    return ToldSystem(listing, kinematics, kinetic, force, matrix, forcing)


# --- names ---


class _Taken:
    """How the names of a system look, in every target."""

    def __init__(self, ring: Ring) -> None:
        plain = ("coordinate", "prescribed", "parameter")
        names = ["t", *(g.name for g in ring.generators if g.kind in plain)]
        self.looks = {look for name in names for look in _looks(name)}

    def __contains__(self, name: str) -> bool:
        return not self.looks.isdisjoint(_looks(name))


def _looks(name: str) -> tuple[str, ...]:
    return name, str(latex_symbol(name)), wolfram_name(name)


def _stem(quantity: Quantity, taken: _Taken, indices: Iterable[str], used: Sequence[str] = ()) -> str:
    """The first letter under which none of the names looks like one of the system's."""
    indices = list(indices)
    for stem in (quantity.stem, *SPARE):
        if stem not in used and not any(stem + index in taken for index in indices):
            return stem
    return free_name(quantity.stem + "_", {"_".join((stem, "")) for stem in used})


def _names(ring: Ring, equations: BodyEquations, numbers: Mapping[str, int]) -> dict[int, str]:
    """A name for every noted node."""
    taken = _Taken(ring)
    by_quantity: dict[Quantity, list[int]] = {}
    for number, meaning in equations.meanings.items():
        by_quantity.setdefault(meaning.quantity, []).append(number)
    names: dict[int, str] = {}
    used: list[str] = [quantity.stem for quantity in Quantity if quantity in by_quantity]
    for quantity, nodes in by_quantity.items():
        indices = {k: _indices(equations.meanings[k], numbers) for k in nodes}
        others = [stem for stem in used if stem != quantity.stem]
        stem = _stem(quantity, taken, indices.values(), others)
        used.append(stem)
        names |= {k: stem + index for k, index in indices.items()}
    return names


def _indices(meaning: Meaning, numbers: Mapping[str, int]) -> str:
    """``2_13``: body 2, row 1, column 3; ``2_delta_1``: of a unit acceleration of delta; of loads their number."""
    whose = numbers.get(meaning.body, 0)
    parts = [str(whose) if whose else f"_{meaning.load}"]
    if meaning.load > 1 and whose:
        parts.append(str(meaning.load))
    if meaning.coordinate:
        parts.append(meaning.coordinate)
    if meaning.place:
        parts.append("".join(map(str, meaning.place)))
    return "_".join(parts)


# --- the same as without intermediates? ---


def disagreement(checked_system: ToldSystem, system: System, ring: Ring) -> str:
    """What differs at a random exact state from the general recursion, which knows of no intermediates; else "".

    One state of fine numbers is enough, unless its enclosures are too wide to tell; where they always are, that counts
    as no difference.
    """
    with ctx.workprec(PRECISION):
        for state in enclosed_states(system, ring, STATES, FINE):
            wrong = _disagreement_at(checked_system, system, ring, state)
            if wrong is not None:
                return wrong
    return ""


def _disagreement_at(checked_system: ToldSystem, system: System, ring: Ring, state: State) -> str | None:
    """What differs, "" if nothing does, None where that cannot be told of everything."""
    scene = Scene(system, state.numbers, state.values, ring)
    expected: list[tuple[str, Scalar]] = [("T", kinetic_energy(scene)), ("U", force_function(scene))]
    formulas = [checked_system.kinetic_energy, checked_system.force_function]
    for name, motion in scene.motions.items():
        own = checked_system.kinematics[name]
        formulas += [*own.angular_velocity, *own.velocity_origin, *own.velocity_mass_centre]
        vectors = (motion.angular_velocity, motion.velocity_origin, motion.velocity_mass_centre)
        for what, v in zip(("omega", "V_O", "V_C"), vectors, strict=True):
            expected += [(Message("[[what]] of [[name]]", what=what, name=name), x) for x in v]
    needed = residuals(scene)
    n = len(system.coordinates)
    formulas += [x for row in checked_system.mass_matrix for x in row] + [*checked_system.forcing]
    values = checked_system.told.values(formulas, state.numbers, state.values)
    equations = values[len(expected) :]
    values = values[: len(expected)]
    for i, name in enumerate(system.coordinates):
        total = -equations[n * n + i]
        for j, other in enumerate(system.coordinates):
            total = total + equations[n * i + j] * state.values[acceleration_name(other)]
        values.append(total)
        expected.append((Message("the equation of [[name]]", name=name), needed[name]))
    undecided = False
    for (what, derived), value in zip(expected, values, strict=True):
        agree = agreement(derived, value)
        if agree is False:
            return Message("[[what]], told through intermediates, differs", what=what)
        undecided = undecided or agree is None
    return None if undecided else ""
