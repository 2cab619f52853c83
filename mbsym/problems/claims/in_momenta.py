"""Claims in momenta: p stands for dL/dq', so that what is claimed and what is derived are compared in q and q'.

M is regular, and (q, q') and (q, p) determine each other: two functions of q and p are equal if and only if they are
with p = dL/dq' put in.  So are two functions of s, s' and the momenta beta of the other coordinates.
"""

from __future__ import annotations

from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.ring import Polynomial
from mbsym.expressions.tree import names
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.variables import ring_environment
from mbsym.model.claims import CLAIMS
from mbsym.model.momenta import momentum_names
from mbsym.problems.claims.result import Derived
from mbsym.problems.claims.symbols import Symbols

#: The kinds that are about momenta.
HAMILTONIAN, MOMENTUM, ROUTH, POTENTIAL = IN_MOMENTA = (
    "hamiltonian", "momentum", "routh function", "reduced potential"
)  # fmt: skip


def momenta(derived: Derived) -> dict[str, Polynomial]:
    """dL/dq' by the names of the momenta."""
    kinetic = derived.energy.kinetic_energy.polynomial
    return {p: derived.ring.velocity_derivative(kinetic, q) for q, p in momentum_names(derived.system).items()}


def with_momenta(derived: Derived, scene: Scene, symbols: Symbols) -> None:
    """Lets the claims' symbols know the momenta, where a claim may name them and one does."""
    named = set(momentum_names(derived.system).values())
    if any(CLAIMS[claim.kind].momenta and named & names(claim.equals) for claim in derived.system.claims):
        symbols.in_scene(scene, momenta(derived))


def in_velocities(derived: Derived, kind: str, of: str) -> Polynomial:
    """What is derived, in q and q':  H = p.q' - L,  a momentum,  R or W with beta = dL/dc'."""
    ring = derived.ring
    known = momenta(derived)
    if kind == MOMENTUM:
        return known[momentum_names(derived.system)[of]]
    if kind == HAMILTONIAN:
        velocities = [ring.generator("velocity", name) for name in derived.system.coordinates]
        lagrangian = derived.energy.kinetic_energy.polynomial + derived.energy.force_function.polynomial
        return ring.reduce(ring.dot(list(known.values()), velocities) - lagrangian)
    found = derived.routh
    formula = found.function if kind == ROUTH else found.reduced_potential
    carry = Carrier(formula.ring, ring, ring_environment(derived.system, ring) | known)
    return ring.reduce(carry(formula.polynomial))
