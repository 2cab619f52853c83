"""Hamilton's and Routh's forms against textbooks, and against Lagrange's equations as identities of the ring."""

import pytest
from conftest import SHIPPED, derived

from mbsym.algebra.base import Lowering
from mbsym.analysis import Unavailable
from mbsym.expressions.parser import parse_expression
from mbsym.expressions.place import Complaints, Span
from mbsym.formulas.formula import Formula
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.variables import ring_environment
from mbsym.problems import energy, equations

SMALL = ("spherical-pendulum", "heavy-top", "double-pendulum", "spring-pendulum", "shaken-pendulum", "cart-pendulum")
CYCLIC = ("spherical-pendulum", "heavy-top", "clebsch", "gyrostat")


def in_the_same_ring(analysis, result):
    """Lagrange's equations in the ring of a result, which has momenta besides."""
    ring = result.ring
    scene = Scene(analysis.system, ring, ring_environment(analysis.system, ring), ring)
    energies = energy.energy(scene)
    return ring, scene, energies, equations.equations(scene, energies)


def formula(ring, text):
    """A formula of a result's ring, in declared names and those of momenta."""
    kinds = ("coordinate", "parameter", "prescribed")
    names = {g.name: ring.generator(g.kind, g.name) for g in ring.generators if g.kind in kinds}
    names |= {f"{g.name}_dot": ring.generator("velocity", g.name) for g in ring.generators if g.kind == "velocity"}
    tree = parse_expression(text, Complaints(), lambda _start, _end: Span(1, 1))
    return Formula(ring, Lowering(ring, names)(tree))


def test_the_spherical_pendulum_of_landau_and_lifshitz():
    """Mechanics, section 14, problem 1: the effective potential M_z^2/(2 m l^2 sin^2 theta) - m g l cos theta."""
    analysis = derived(SHIPPED / "spherical-pendulum.yaml")
    found, left = analysis.hamilton, analysis.routh
    potential = "p_psi**2/(2*m*l**2*sin(theta)**2) - m*g*l*cos(theta)"
    whole = formula(found.hamiltonian.ring, f"p_theta**2/(2*m*l**2) + {potential}")
    assert found.hamiltonian == whole
    assert (left.ignored, left.coordinates) == (("psi",), ("theta",))
    assert left.function == formula(left.function.ring, f"m*l**2*theta_dot**2/2 - ({potential})")
    force = "p_psi**2*cos(theta)/(m*l**2*sin(theta)**3) - m*g*l*sin(theta)"
    assert list(left.forcing) == [formula(left.function.ring, force)]
    assert list(left.ignored_rates) == [formula(left.function.ring, "p_psi/(m*l**2*sin(theta)**2)")]


def test_a_damper_acts_on_the_momentum():
    """p' = -dH/dq - b q' with q' = p/(J + m l^2), by hand."""
    found = derived(SHIPPED / "simple-pendulum.yaml").hamilton
    rate = formula(found.hamiltonian.ring, "-m*g*l*sin(theta) - b*p_theta/(J + m*l**2)")
    assert list(found.rates) == [rate]


@pytest.mark.parametrize("name", SMALL)
def test_canonical_equations_are_lagranges(name):
    """With p = dL/dq' put in:  dH/dp is q', and -dH/dq + Q is dL/dq + Q."""
    analysis = derived(SHIPPED / f"{name}.yaml")
    found = analysis.hamilton
    ring, _, energies, closed = in_the_same_ring(analysis, found.hamiltonian)
    names = analysis.system.coordinates
    put = {
        ring.index("prescribed", p): x.polynomial
        for p, x in zip(found.momenta, found.momenta_in_velocities, strict=True)
    }
    lagrangian = energies.kinetic_energy.polynomial + energies.force_function.polynomial
    for i, coordinate in enumerate(names):
        velocity = ring.substitute(found.velocities[i].polynomial, put)
        assert ring.is_zero(velocity - ring.generator("velocity", coordinate)) is True
        rate = ring.substitute(found.rates[i].polynomial, put)
        wanted = ring.derivative(lagrangian, coordinate) + closed.generalized_force[i].polynomial
        assert ring.is_zero(rate - wanted) is True
    energy_of_jacobi = ring.substitute(found.hamiltonian.polynomial, put)
    quadratic = energies.kinetic_energy.polynomial - energies.A0.polynomial
    linear = sum(
        (a.polynomial * ring.generator("velocity", n) for a, n in zip(energies.A1, names, strict=True)), ring.zero
    )
    jacobi = quadratic - linear - energies.A0.polynomial - energies.force_function.polynomial
    assert ring.is_zero(energy_of_jacobi - jacobi) is True


@pytest.mark.parametrize("name", CYCLIC)
def test_rouths_equations_are_lagranges_without_the_ignored_accelerations(name):
    """With beta = p_c put in:  M_R s'' - f_R = E_s - M_sc M_cc^-1 E_c."""
    analysis = derived(SHIPPED / f"{name}.yaml")
    found = analysis.routh
    ring, scene, _, closed = in_the_same_ring(analysis, found.function)
    names = list(analysis.system.coordinates)
    assert len(found.ignored) == 1
    c = names.index(found.ignored[0])
    mass, rows = closed.mass_matrix.polynomials, closed.equalities(names)
    momentum = energy.energy(scene).kinetic_energy.polynomial
    put = {ring.index("parameter", found.momenta[0]): ring.velocity_derivative(momentum, found.ignored[0])}
    for i, name_of in enumerate(found.coordinates):
        s = names.index(name_of)
        left = -found.forcing[i].polynomial
        for j, other in enumerate(found.coordinates):
            left = left + found.mass_matrix[i, j].polynomial * ring.generator("acceleration", other)
        left = ring.substitute(ring.reduce(left), put)
        right = ring.times(mass[c][c], rows[s].polynomial) - ring.times(mass[s][c], rows[c].polynomial)
        assert ring.is_zero(ring.times(mass[c][c], left) - right) is True


def test_what_has_none_says_why():
    with pytest.raises(Unavailable, match="no coordinate is cyclic"):
        derived(SHIPPED / "double-pendulum.yaml").routh  # noqa: B018


def test_systems_in_speeds_have_routhians_in_coordinates():
    found = derived(SHIPPED / "clebsch-poisson.yaml").routh
    assert found.ignored == ("c",)
