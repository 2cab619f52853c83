"""Forces that have a potential which nobody named: dead loads belong to the energy, followers do not."""

from __future__ import annotations

import pytest
import sympy
from conftest import TESTS
from terminal import told

import mbsym
from mbsym.algebra.certainty import Certainty
from mbsym.problems.stability.words import Word

STATEMENTS = TESTS / "cases" / "statements"

RODS = """
mbsym: 1
name: Two rods pulled at their end
parameters: {{F: {F}}}
bodies:
  - {{name: rod, attached to: 0, rotation: {{axes: [3], angles: [a]}}, mass centre: [1, 0, 0], mass: 1}}
  - name: second
    attached to: rod
    connection point: [2, 0, 0]
    rotation: {{axes: [3], angles: [b]}}
    mass centre: [1, 0, 0]
    mass: 1
loads:
  - spring: {{coordinate: a, stiffness: 1}}
  - spring: {{coordinate: b, stiffness: 1}}
  - {load}
motion: {{a: 0, b: 0}}
"""
DEAD = "force: {body: second, point: [2, 0, 0], components: [F, 0, 0], axes: 0}"
FOLLOWER = "force: {body: second, point: [2, 0, 0], components: [F, 0, 0], axes: second}"


def word(text: str) -> Word:
    verdict = mbsym.loads(text).stability.numerical
    assert verdict is not None
    return verdict.word


def test_a_dead_load_is_conservative() -> None:
    """V = (a^2 + b^2)/2 - F (2 cos a + 2 cos(a + b)): K = [[1 + 4 F, 2 F], [2 F, 1 + 2 F]], definite iff
    1 + 6 F + 4 F^2 > 0 and F > -1/4: for F > (sqrt 5 - 3)/4 = -0.19098.
    """
    for force, expected in (("3", Word.STABLE), ("-19/100", Word.STABLE), ("-192/1000", Word.UNSTABLE)):
        assert word(RODS.format(F=force, load=DEAD)) is expected


def test_a_follower_is_not() -> None:
    """At the same small pressure the follower leaves all roots imaginary, and no energy is there to decide."""
    assert word(RODS.format(F="-19/100", load=FOLLOWER)) is Word.CRITICAL


PLANE = """
mbsym: 1
name: Block
parameters: {{c: 1/2}}
bodies:
  - {{name: block, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}}
loads:
  - spring: {{coordinate: x, stiffness: 1}}
  - spring: {{coordinate: y, stiffness: 1}}
  - generalized force: {{{force}}}
motion: {{x: 0, y: 0}}
"""


@pytest.mark.parametrize(
    ("force", "expected"),
    [
        ("x: c*y, y: c*x", Word.STABLE),
        ("x: x**2*y, y: x**3/3", Word.STABLE),
        ("x: x**2*y, y: x**3", Word.CRITICAL),  # dQ_x/dy = x^2, dQ_y/dx = 3 x^2
        ("x: c*y, y: -c*x", Word.UNSTABLE),
        ("x: x_dot**3, y: 0", Word.UNSTABLE),  # x alone: its energy grows
    ],
)
def test_a_generalised_force_is_a_gradient_or_not(force: str, expected: Word) -> None:
    assert word(PLANE.format(force=force)) is expected


def test_one_coordinate_always_has_a_potential_unless_it_knows_velocities_or_the_time() -> None:
    text = """
mbsym: 1
name: Rod under a follower
bodies:
  - {name: rod, attached to: 0, rotation: {axes: [3], angles: [a]}, mass centre: [1, 0, 0], mass: 1}
loads:
  - spring: {coordinate: a, stiffness: 3}
  - force: {body: rod, point: [2, 0, 0], components: [0, -sin(a), 0], axes: rod}
motion: {a: 0}
"""
    assert word(text) is Word.STABLE
    assert word(text.replace("-sin(a)", "sin(a)*a_dot**2")) is Word.CRITICAL


def test_a_force_that_turns_with_a_prescribed_frame_is_left_alone() -> None:
    """The force varies with the time: nothing is conserved, and the first approximation varies or decides nothing."""
    text = """
mbsym: 1
name: Block pulled from a turning frame
parameters: {W: 3}
prescribed: {chi: {rate: W}}
bodies:
  - {name: frame, attached to: 0, rotation: {axes: [3], angles: [chi]}, mass: 0}
  - {name: block, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
loads:
  - spring: {coordinate: x, stiffness: 1}
  - spring: {coordinate: y, stiffness: 1}
  - force: {body: block, point: [0, 0, 0], components: [x**3, 0, 0], axes: frame}
motion: {x: 0, y: 0}
"""
    assert word(text) is Word.CRITICAL


def test_an_evenly_accelerated_frame_has_an_energy_though_the_lagrangian_knows_the_time() -> None:
    """V = -m l (g + a) cos th in the lift; in the car th = -atan(a/g) is below: stable along the apparent vertical."""
    lift = (STATEMENTS / "lift.yaml").read_text(encoding="utf-8")
    for a, upright in (("-5", "unstable"), ("-20", "stable")):
        found = mbsym.loads(lift.replace("a: -20", f"a: {a}")).equilibria
        assert {one.values[0].text: str(one.verdict.word) for one in found.equilibria} == {
            "0": "unstable" if upright == "stable" else "stable",
            "pi": upright,
        }
    assert word(lift.replace("a: -20", "a: -5")) is Word.STABLE
    assert word(lift) is Word.UNSTABLE
    car = mbsym.load(STATEMENTS / "lean.yaml").equilibria
    assert sorted(str(one.verdict.word) for one in car.equilibria) == ["stable", "unstable"]


def test_a_shaken_pivot_has_none() -> None:
    for name in ("kap_hang_resonant", "kap_up_stable"):
        found = mbsym.load(STATEMENTS / f"{name}.yaml").equilibria
        assert {one.verdict.word for one in found.equilibria} == {Word.UNDECIDED}


def test_velocities_and_the_time_forbid_an_energy() -> None:
    """x'' = -x + x'^3 has f(q, 0) with a potential, and no integral; y'' = -x' y' does work, too."""
    assert word(PLANE.format(force="x: x_dot**3, y: 0")) is Word.UNSTABLE
    assert word(PLANE.format(force="x: 0, y: -x_dot*y_dot")) is Word.CRITICAL
    assert word(PLANE.format(force="x: y_dot*x, y: -x_dot*x")) is Word.STABLE, "gyroscopic: no work"


# --- x'' = f(x) has an energy, and problem 7 tells it ---

TRACK = """
mbsym: 1
name: A bead on a track
parameters: {k: positive, a: positive, l: positive}
bodies:
  - {name: p, attached to: 0, mass: 1, connection point: [x, a*x**2/2, 0], coordinates: [x]}
loads:
  - LOAD
motion: {x: 0}
claims:
  - {claim: first integral, equals: "(1 + a**2*x**2)*x_dot**2/2 + V"}
"""


@pytest.mark.parametrize(
    ("force", "potential"),
    [
        ("-k*sin(x)", "-k*cos(x)"),
        ("-k*x + a*x**3", "k*x**2/2 - a*x**4/4"),
        ("-k*x*(1 - l/sqrt(x**2 + a**2))", "k*x**2/2 - k*l*sqrt(x**2 + a**2)"),
        ("k/(l + x)**2 - k/l**2", "k/(l + x) + k*x/l**2"),
        ("-k*x*exp(-x**2)", "-k*exp(-x**2)/2"),
        ("-k*x*sin(x)**2", "k*x**2/4 - k*x*sin(x)*cos(x)/2 + k*sin(x)**2/4"),
    ],
)
def test_a_force_of_one_coordinate_has_an_energy(force: str, potential: str) -> None:
    """m(x) x'' + m'(x) x'^2/2 = Q(x): m(x) x'^2/2 + V(x) with V' = -Q is constant, V by hand."""
    text = TRACK.replace("LOAD", f'generalized force: {{x: "{force}"}}').replace("V", potential)
    found = mbsym.loads(text)
    (integral,) = found.integrals
    assert (integral.name, integral.status) == ("energy with the potential of the forces", "proved")
    assert [result.holds for result in found.claims] == [True]


def test_a_force_on_a_body_counts_as_well() -> None:
    """F = -k x along the axis 1 on the bead: Q_x = -k x, V = k x^2/2; along the axis 2 Q_x = -k x a x."""
    for components, potential in (("[-k*x, 0, 0]", "k*x**2/2"), ("[0, -k*x, 0]", "k*a*x**3/3")):
        load = f"force: {{body: p, point: [0, 0, 0], components: {components}, axes: 0}}"
        found = mbsym.loads(TRACK.replace("LOAD", load).replace("V", potential))
        assert [item.status for item in found.integrals] == ["proved"]
        assert [result.holds for result in found.claims] == [True]


def test_where_the_force_does_work_on_a_way_round_there_is_none() -> None:
    """Forces of velocities; and Q = (y, -x) in the plane, whose work around a circle is not zero."""
    for force in ("-k*x - x_dot", "-k*x + x_dot**2", "-k*x*sin(t)"):
        found = mbsym.loads(TRACK.replace("LOAD", f'generalized force: {{x: "{force}"}}').replace("+ V", ""))
        assert found.integrals == ()
    assert mbsym.loads(PLANE.format(force="x: -y, y: x")).integrals == ()
    (turned,) = mbsym.loads(PLANE.format(force="x: y, y: x")).integrals  # V = -x y
    assert str(turned.formula) == "(x_dot**2 + y_dot**2 + (x - y)**2)/2"


def test_the_energy_is_told_beside_the_theorem_that_stands_on_it() -> None:
    """x'' = c - sin x, c = sin x_0: x'^2/2 - c x - cos x is constant, with the other sign of c x it is not."""
    found = mbsym.load(STATEMENTS / "force-of-one-coordinate.yaml")
    assert found.stability.numerical is not None
    assert found.stability.numerical.theorem == "Lagrange-Dirichlet"
    (integral,) = found.integrals
    assert integral.name == "energy with the potential of the forces"
    assert [result.holds for result in found.claims] == [True, False]


def test_no_closed_form_is_not_called_no_energy() -> None:
    """x'' = -atan x has one, with V = x atan x - log(1 + x^2)/2, which the ring does not hold: nothing denies it."""
    found = mbsym.loads(TRACK.replace("LOAD", 'generalized force: {x: "-k*atan(x)"}').replace("+ V", ""))
    assert found.integrals == ()
    assert found.stability.verdict.theorem == "Lagrange-Dirichlet"
    assert told(found, 7) == ["None in closed form of the kinds that are looked for."]


def test_a_force_with_the_cosine_of_a_square_has_an_energy() -> None:
    """x'' = -x cos(x^2): V = sin(x^2)/2; and x'' = -x cos(x^2 + x), of which no W is a polynomial in x, sin, cos."""
    found = mbsym.loads(TRACK.replace("LOAD", 'generalized force: {x: "-k*x*cos(x**2)"}').replace("+ V", ""))
    assert [item.status for item in found.integrals] == ["proved"]
    found = mbsym.loads(TRACK.replace("LOAD", 'generalized force: {x: "-k*x*cos(x**2 + x)"}').replace("+ V", ""))
    assert found.integrals == ()


MAGNETIC = """
mbsym: 1
name: charge in a field along z
parameters: {m: positive, B: real, k: real}
bodies:
  - {name: p, attached to: 0, connection point: [POINT], mass: m, coordinates: [COORDINATES]}
loads:
  - potential: V
  - generalized force: FORCE
"""


@pytest.mark.parametrize(
    ("potential", "force", "wanted"),
    [
        ("0*x", "{x: B*y_dot, y: -B*x_dot}", {"m*x_dot - B*y", "m*y_dot + B*x", "L"}),
        ("-k*x", "{x: B*y_dot, y: -B*x_dot}", {"m*y_dot + B*x"}),
        ("k*(x**2 + y**2)**2", "{x: B*y_dot, y: -B*x_dot}", {"L"}),
        ("k*x**2", "{x: B*x*y_dot, y: -B*x*x_dot}", {"m*y_dot + B*x**2/2"}),
        ("k*(x**2 + 2*y**2)", "{x: B*y_dot, y: -B*x_dot}", set()),
    ],
)
def test_momenta_in_magnetic_fields(potential: str, force: str, wanted: set[str]) -> None:
    """p_x' = B y': p_x - B y is constant; and so on."""
    text = MAGNETIC.replace("POINT", "x, y, 0").replace("COORDINATES", "x, y")
    found = mbsym.loads(text.replace("V", potential).replace("FORCE", force), (1, 2, 3, 7))
    momenta = [one for one in found.integrals if one.kind == "gyroscopic momentum"]
    assert all(one.status is Certainty.PROVED for one in momenta)
    angular = "m*(x*y_dot - y*x_dot) + B*(x**2 + y**2)/2"
    wanted_formulas = [sympy.sympify(one.replace("L", angular)) for one in wanted]
    formulas = [sympy.sympify(str(one.formula)) for one in momenta]
    assert len(formulas) == len(wanted_formulas)
    for formula in formulas:
        assert any(sympy.simplify(formula / one).is_number for one in wanted_formulas)
    assert found.check("first integrals").outcome == "exact"


def test_a_damped_coordinate_has_one_and_what_is_beside_it_its_energy() -> None:
    """m x'' = -B x' and m y'' = -2 k y: energy is lost, m x' + B x and that of y are constant."""
    text = MAGNETIC.replace("POINT", "x, y, 0").replace("COORDINATES", "x, y").replace("V", "k*y**2")
    found = mbsym.loads(text.replace("FORCE", "{x: -B*x_dot}"), (7,)).integrals
    assert [str(one.formula) for one in found] == ["m*y_dot**2/2 + k*y**2", "m*x_dot + B*x"]


@pytest.mark.parametrize("force", ["{y: q*B*sin(w*x)*x_dot}", "{x: -q*B*sin(w*x)*y_dot, y: q*B*sin(w*x)*x_dot}"])
def test_a_field_that_varies_along_one_axis(force: str) -> None:
    """m y'' = q B sin(w x) x', so that m y' + q B cos(w x)/w is constant, whatever else acts."""
    text = MAGNETIC.replace("POINT", "x, y, 0").replace("COORDINATES", "x, y").replace("V", "0*x")
    text = text.replace("B: real, k: real", "B: real, k: real, q: positive, w: positive").replace("FORCE", force)
    formulas = [str(one.formula) for one in mbsym.loads(text, (7,)).integrals]
    assert "m*y_dot + B*q*cos(w*x)/w" in formulas


PARTS = """
mbsym: 1
name: parts
parameters: {k: positive, c: positive}
bodies:
  - {name: p, attached to: 0, mass: 1, connection point: [x, y, 0], coordinates: [x, y]}
  - {name: q, attached to: 0, mass: 2, connection point: [0, 0, z], coordinates: [z]}
loads:
  - potential: V
  - damper: {coordinate: z, coefficient: c}
"""


@pytest.mark.parametrize(
    ("potential", "damping", "names"),
    [
        ("k*x**2/2 + y**4 + z**2", "c", ["energy of x", "energy of y"]),
        ("k*x**2/2 + x*y + z**2", "c", ["energy of x, y"]),
        ("k*x**2/2 + x*y**2 + x*z**2", "c", []),
        ("k*x**2/2 + y**4 + z**2", "0", ["generalised energy", "energy of x", "energy of y"]),
        ("sqrt(1 + (x + y)**2) + z**2", "0", ["generalised energy", "energy of x, y"]),
        ("x**2 + y**2 + z**2 + x*y + y*z", "0", ["generalised energy"]),
    ],
)
def test_energies_of_parts_that_do_not_know_each_other(potential: str, damping: str, names: list[str]) -> None:
    """Each is constant by itself, and those that follow from the ones before them are left out."""
    text = PARTS.replace("V", potential).replace("coefficient: c", f"coefficient: {damping}")
    found = mbsym.loads(text, (1, 2, 3, 7))
    energies = [one for one in found.integrals if "energy" in one.kind]
    assert [one.name for one in energies] == names
    assert all(one.status is Certainty.PROVED for one in energies)
    check = "verified numerically" if "sqrt" in potential else "exact"
    assert not names or found.check("first integrals").outcome == check


def test_how_many_energies_are_told_does_not_depend_on_the_origin():
    """x'' = -x, y'' = -4 y with y counted from elsewhere: the whole energy is that of x and that of y and a number."""
    for place in ("y", "2*y + 1/3"):
        analysis = mbsym.loads(
            "mbsym: 1\nname: bowl\nbodies:\n"
            f"  - {{name: p, attached to: 0, connection point: [x, '{place}', 0], mass: 1, coordinates: [x, y]}}\n"
            f"loads:\n  - potential: x**2/2 + 2*({place})**2\nmotion: {{}}\n"
        )
        assert len(analysis.integrals) == 2
