"""What a claim is about, derived: a polynomial of the ring for every kind of claim that is a formula."""

from __future__ import annotations

from collections.abc import Sequence

from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.tree import ZERO, names
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.variables import ring_environment
from mbsym.model.claims import CLAIMS, SUMS, Claim
from mbsym.model.momenta import momentum_names
from mbsym.model.system import INERTIAL
from mbsym.problems.claims.equations import Dynamics
from mbsym.problems.claims.result import Derived, by_motion
from mbsym.problems.claims.symbols import Symbols


def derived_quantity(derived: Derived, claim: Claim) -> Polynomial:
    """What is claimed, derived; over the ring."""
    ring, kind = derived.ring, claim.kind
    if is_of_first_approximation(claim):
        return of_first_approximation(derived, claim)
    rows = [k - 1 for k in claim.entry]
    if kind in SUMS:
        return _sum(derived, kind)
    if kind == "coefficient":
        whole = _sum(derived, claim.of) if claim.of in SUMS else _equation(derived, claim.of)
        return _coefficient(ring, whole, derived.parameters_scene.lower(claim.at or ZERO))
    if kind == "mass matrix":
        return derived.energy.A2[rows[0], rows[1]].polynomial
    if kind == "equation of motion":
        return _equation(derived, claim.of)
    if kind == "acceleration":
        top, bottom = Dynamics.of(derived).solved(derived.system.coordinates.index(claim.of))
        return ring.ratio(top, bottom)
    if kind in IN_MOMENTA:
        return in_velocities(derived, kind, claim.of)
    if kind == "linear matrix B":
        if derived.linearisation.B is None:
            raise NoClosedForm("there is no B")
        return derived.linearisation.B[rows[0], rows[1]].polynomial
    if kind.startswith("state matrix"):
        return getattr(derived.state_space, kind[-1])[rows[0], rows[1]].polynomial
    if kind in ("position", "velocity"):
        return _in_inertial_axes(derived.scene, kind, claim.of)[rows[0]]
    body = derived.kinematics.body(claim.of)
    if kind == "direction cosine":
        return body.rotation[rows[0], rows[1]].polynomial
    spin = body.angular_velocity if kind == "angular velocity" else body.relative_angular_velocity
    return spin[rows[0]].polynomial


def is_of_first_approximation(claim: Claim) -> bool:
    """Whether it is about what is told in coordinates, of systems in speeds, too."""
    return claim.kind.startswith(("linear matrix", "subsystem matrix", "characteristic")) and claim.kind[-1] != "B"


def of_first_approximation(derived: Derived, claim: Claim) -> Polynomial:
    """A characteristic polynomial, or an entry of a matrix whose rows may be only some of the coordinates.

    Raises NoClosedForm for a coordinate that has no row there.
    """
    if claim.kind == "characteristic polynomial":
        there = [name for part in derived.stability.subsystems for name in part.coordinates]
        _need(there, [claim.of] if claim.of else [])
        return _characteristic(derived, claim.of)
    names = [derived.system.claimable[k - 1] for k in claim.entry]
    if claim.kind.startswith("subsystem"):
        _need([name for part in derived.linearisation.subsystems for name in part.coordinates], names)
        (part,) = (subsystem for subsystem in derived.linearisation.subsystems if names[0] in subsystem.coordinates)
        if names[1] not in part.coordinates:
            return derived.ring.zero
        matrix, there = getattr(part, claim.kind[-1]), list(part.coordinates)
    else:
        matrix, there = getattr(derived.linearisation, claim.kind[-1]), list(derived.linearisation.coordinates)
        _need(there, names)
    polynomial: Polynomial = matrix[there.index(names[0]), there.index(names[1])].polynomial
    return polynomial


def _need(there: Sequence[str], names: Sequence[str]) -> None:
    for name in names:
        if name not in there:
            raise NoClosedForm(
                "[[name]] is not among the coordinates of the first approximation ([[names]])",
                name=name,
                names=", ".join(there),
            )


def _sum(derived: Derived, kind: str) -> Polynomial:
    kinetic, force = derived.energy.kinetic_energy.polynomial, derived.energy.force_function.polynomial
    return {
        "kinetic energy": kinetic,
        "force function": force,
        "potential energy": -force,
        "lagrangian": derived.ring.reduce(kinetic + force),
    }[kind]


def _equation(derived: Derived, coordinate: str) -> Polynomial:
    """E_i = (M q'' - f)_i."""
    names = derived.system.coordinates
    return derived.equations.equality(names.index(coordinate), names).polynomial


def _characteristic(derived: Derived, coordinate: str) -> Polynomial:
    """Lambda of one subsystem, or of all of them multiplied; the time stands for lambda."""
    ring = derived.ring
    total = ring.one
    for part in derived.stability.subsystems:
        if not coordinate or coordinate in part.coordinates:
            powers = enumerate(part.characteristic)
            sum_ = ring.zero
            for power, coefficient in powers:
                sum_ = sum_ + coefficient.polynomial * ring.generator("time", "t") ** power
            total = ring.times(total, sum_)
    return ring.reduce(total)


def _in_inertial_axes(scene: Scene, kind: str, body: str) -> tuple[Polynomial, Polynomial, Polynomial]:
    """Radius vector or velocity of the mass centre."""
    motion = scene.motions[body]
    if kind == "position":
        vector = scene.position(motion.mass_centre, INERTIAL)
    else:
        vector = scene.to_axes(motion.velocity_mass_centre, INERTIAL)
    return (scene.ring.reduce(vector[0]), scene.ring.reduce(vector[1]), scene.ring.reduce(vector[2]))


def _coefficient(ring: Ring, x: Polynomial, product: Polynomial) -> Polynomial:
    """What stands before exactly this product of velocities and accelerations."""
    target_exponents = tuple(int(e) for e in product.monomial(0))
    for exponents, coefficient in by_motion(ring, x):
        if exponents == target_exponents:
            return coefficient
    return ring.zero


# Claims in momenta: p stands for dL/dq', so that what is claimed and what is derived are compared in q and q'.
#
# M is regular, and (q, q') and (q, p) determine each other: two functions of q and p are equal if and only if they are
# with p = dL/dq' put in.  So are two functions of s, s' and the momenta beta of the other coordinates.


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
    routh = derived.routh
    formula = routh.function if kind == ROUTH else routh.reduced_potential
    carry = Carrier(formula.ring, ring, ring_environment(derived.system, ring) | known)
    return ring.reduce(carry(formula.polynomial))
