"""Polynomials of a claim in other forms: in declared parameters, on the relations, by products of velocities."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from mbsym.algebra.ring import Polynomial, Ring
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import relations
from mbsym.model.claims import Claim
from mbsym.problems.claims.result import Derived
from mbsym.problems.knowledge import definition_in_parameters

#: What is told of an unperturbed motion, by how the kinds of claim begin.
_OF_THE_MOTION = ("linear", "subsystem", "state", "characteristic", "condition", "normal form", "lyapunov")

_MOTION = ("velocity", "acceleration")


def scene_of_claims(derived: Derived) -> Scene[Any]:
    """Where claims and their abbreviations are lowered: over parameters, and with the inputs where there are some."""
    return derived.scene if derived.system.inputs else derived.parameters_scene


def in_parameters(derived: Derived, x: Polynomial) -> Polynomial:
    """The description's own symbols replaced by what they stand for."""
    ring, scene = derived.ring, derived.parameters_scene
    degrees = x.degrees()
    images = {}
    for item in derived.system.notation:
        index = ring.index("parameter", item.name)
        if degrees[index] > 0:
            images[index] = definition_in_parameters(scene, item.name)
    return ring.substitute(x, images) if images else ring.reduce(x)


def on_relations(derived: Derived, claim: Claim, x: Polynomial) -> Polynomial:
    """Relations between parameters used; for the linear problem also the conditions under which the motion exists."""
    ring = derived.ring
    if claim.kind.startswith(_OF_THE_MOTION):
        images = derived.equilibrium.determined(derived.parameters_scene)
    else:
        images = relations(derived.parameters_scene)
    return ring.substitute(x, images) if images else x


def is_moving(derived: Derived, x: Polynomial) -> bool:
    """Whether x depends on the state or the time."""
    ring = derived.ring
    degrees = x.degrees()
    if any(degrees[k] > 0 for k, g in enumerate(ring.generators) if g.kind in _MOTION):
        return True
    prescribed = (*(item.name for item in derived.system.prescribed), *derived.system.input_names)
    return bool(ring.dependencies(x, [*derived.system.coordinates, *derived.system.velocities, *prescribed, "t"]))


def by_motion(ring: Ring, x: Polynomial) -> Iterator[tuple[tuple[int, ...], Polynomial]]:
    """Exponents of velocities and accelerations (those of all others are zero), and what stands before them."""
    yield from split_off(ring, x, {k for k, g in enumerate(ring.generators) if g.kind not in _MOTION})


def by_place(ring: Ring, claim: Claim, x: Polynomial) -> Iterator[tuple[tuple[int, ...], Polynomial]]:
    """x by products of velocities and accelerations; a characteristic polynomial by powers of its variable."""
    if not claim.variable:
        return by_motion(ring, x)
    time = ring.index("time", "t")
    return split_off(ring, x, set(range(len(ring.generators))) - {time})


def split_off(ring: Ring, x: Polynomial, constant: set[int]) -> Iterator[tuple[tuple[int, ...], Polynomial]]:
    """x as a polynomial in the other generators: their exponents, and the coefficients in the constant ones."""
    found: dict[tuple[int, ...], dict[tuple[int, ...], Any]] = {}
    for monomial, coefficient in x.terms():
        exponents = [int(e) for e in monomial]
        key = tuple(0 if k in constant else e for k, e in enumerate(exponents))
        rest = tuple(e if k in constant else 0 for k, e in enumerate(exponents))
        found.setdefault(key, {})[rest] = coefficient
    for key, terms in found.items():
        yield key, ring.context.from_dict(terms)
