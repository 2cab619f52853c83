"""What decides on a border hangs on the motion, not on its coordinates: verdicts derived by hand.

A coordinate may be told by a relation in place of a formula, once or twice, by either side, and squares of rates may
be written out; dissipation acts on a minimum of higher order as on any other.
"""

from __future__ import annotations

from fractions import Fraction

import pytest

import mbsym
from mbsym.analysis.judge import Judge
from mbsym.problems.stability.problem import Stability
from mbsym.problems.stability.words import Word, explanation
from mbsym.report.conditions import told_cases

#: Loads of a unit mass at x, and what is true of x = 0.
ON_A_LINE = {
    # x'' + x = x'^3: d(x'^2 + x^2)/dt = 2 x'^4
    "growing": ("potential: X**2/2", "rayleigh: -X_dot**4/4", Word.UNSTABLE),
    # x'' + x' + x^3 = 0: d(x'^2/2 + x^4/4)/dt = -x'^2, and nothing but x = 0 rests
    "quartic": ("potential: X**4/4", "rayleigh: X_dot**2/2", Word.ASYMPTOTIC),
    # x'' + x' = x^3: it has left with x' > 0
    "hilltop": ("potential: -X**4/4", "rayleigh: X_dot**2/2", Word.UNSTABLE),
    # x'' + x' + x^2 = 0: x^3/3 has no minimum
    "cubic": ("potential: X**3/3", "rayleigh: X_dot**2/2", Word.UNSTABLE),
    # x'' + x^5 = 0
    "sextic": ("potential: X**6/6", "rayleigh: 0*X_dot", Word.STABLE),
}
RELATIONS = {
    "x": ("x", ""),
    "s = x": ("x", "constraints: [relation: s = x]"),
    "x by s": ("s", "constraints: [relation: 2*s = 2*x]\ndependent: [x]"),
    "parameter": ("s", "constraints: [relation: m*x = m*s]"),
    "curved": ("x", "constraints: [relation: s = x + x**3]"),
    "twice": ("s", "constraints: [relation: s = x, relation: 2*(s - x) = 0]"),
}


def described(potential: str, rayleigh: str, relation: str, loads: str = "") -> str:
    name, constraints = RELATIONS[relation]
    slide = "  - {name: slide, attached to: 0, connection point: [s, 0, 0], coordinates: [s], mass: 0}\n"
    slide = slide if constraints else ""
    return (
        "mbsym: 1\nname: on a line\nparameters: {m: positive}\nbodies:\n"
        "  - {name: p, mass: m, connection point: [x, 0, 0], coordinates: [x]}\n"
        f"{slide}loads:\n  - {potential.replace('X', name)}\n  - {rayleigh.replace('X', name)}\n{loads}{constraints}\n"
        f"motion: {{x: 0{', s: 0' if constraints else ''}}}\nvalues: {{m: 1}}\n"
    )


def word(text: str) -> Word:
    found = mbsym.loads(text, (4, 5, 6)).stability.numerical
    assert found is not None
    return found.word


@pytest.mark.parametrize("relation", RELATIONS)
@pytest.mark.parametrize("case", ON_A_LINE)
def test_a_relation_in_place_of_a_formula(case: str, relation: str) -> None:
    potential, rayleigh, wanted = ON_A_LINE[case]
    assert word(described(potential, rayleigh, relation)) is wanted


def test_loads_on_a_coordinate_that_follows() -> None:
    """s = x + x^2: spring, damper and force act on s.

    V = s^2/2 - x^2/2 - x^3 = x^4/2; the power is (1 - c) s'^2, lost for c = 2, won for c = 1/2.
    """
    loads = (
        "  - spring: {coordinate: s, stiffness: 1}\n"
        "  - damper: {coordinate: s, coefficient: 2}\n"
        "  - generalized force: {s: s_dot}\n"
    )
    text = described("potential: -x**2/2 - x**3", "rayleigh: 0*x_dot", "s = x", loads)
    text = text.replace("relation: s = x", "relation: s = x + x**2")
    assert word(text) is Word.ASYMPTOTIC
    assert word(text.replace("coefficient: 2", "coefficient: 1/2")) is Word.UNSTABLE


def test_rates_that_grow_with_a_drift_are_no_drift() -> None:
    """Two free coordinates run evenly; s = x + y^2 then runs ever faster, s = x + y evenly."""
    text = """
mbsym: 1
name: free
parameters: {m: positive}
bodies:
  - {name: p, mass: m, connection point: [x, y, 0], coordinates: [x, y]}
  - {name: slide, attached to: 0, connection point: [s, 0, 0], coordinates: [s], mass: 0}
constraints: [relation: s = x + y**2]
motion: {x: 0, y: 0, s: 0}
values: {m: 1}
"""
    assert word(text).open
    assert word(text.replace("y**2", "y")) is Word.STABLE_BUT_CYCLIC


@pytest.mark.parametrize(
    ("point", "potential", "wanted"),
    [
        # u and y know no z: the free particle of a plane in other coordinates, whose T stays; u' = x' + 2 y y' grows
        ("u - y**2, y, z", "k*z**2", Word.STABLE_BUT_CYCLIC),
        ("u - 2*y*z, y, z", "k*z**2", None),  # u' = x' + 2 (y z)', z oscillates and y drifts
        ("u - 2*y, y, z", "k*z**2", Word.STABLE_BUT_CYCLIC),
        ("u - z**2, y, z", "k*z**2", Word.STABLE_BUT_CYCLIC),
    ],
)
def test_rates_that_grow_with_a_drift_are_none_without_constraints_either(
    point: str, potential: str, wanted: Word | None
) -> None:
    text = ON_A_CYLINDER.replace("x, y, z", point, 1).replace("[x, y, z]", "[u, y, z]").replace("V", potential, 1)
    text = text.replace("constraints:\n  - relation: x**2 + y**2 = l**2\n", "").replace("  - LOAD\n", "")
    found = word(text.replace("{x: 0, y: l, z: 0}", "{u: 0, y: 0, z: 0}"))
    assert found.open if wanted is None else found is wanted


def test_the_judge_of_maps_and_sweeps_knows_it() -> None:
    """x'' + (a - b) x + x^3 = 0 beside s = x: stable at a = b, by x^4."""
    text = """
mbsym: 1
name: border
parameters: {a: positive, b: positive}
bodies:
  - {name: p, mass: 1, connection point: [x, 0, 0], coordinates: [x]}
  - {name: slide, attached to: 0, connection point: [s, 0, 0], coordinates: [s], mass: 0}
loads:
  - potential: a*x**2/2 - b*s**2/2 + s**4/4
constraints: [relation: s = x]
motion: {x: 0, s: 0}
"""
    judge = Judge(mbsym.loads(text, (4, 5, 6)))
    values = [{"a": Fraction(a), "b": Fraction(2)} for a in (3, 2, 1)]
    assert [judge(at).word for at in values] == [Word.STABLE, Word.STABLE, Word.UNSTABLE]


@pytest.mark.parametrize("written", ["-x**2*x_dot", "-(x + y)**2*(x_dot + y_dot)"])
def test_friction_that_is_a_square_in_other_coordinates(written: str) -> None:
    """u = x + y or u = x: V = u^2/2 + y^4/4 with friction u^2 u': the energy never grows."""
    u = "x + y" if "y_dot" in written else "x"
    force = f"generalized force: {{x: '{written}'" + (f", y: '{written}'}}" if u != "x" else "}")
    text = f"""
mbsym: 1
name: square
bodies:
  - {{name: p, mass: 1, connection point: ['{u}', y, 0], coordinates: [x, y]}}
  - {{name: q, attached to: 0, mass: 1, connection point: ['{u} + y', 0, 0]}}
loads:
  - potential: ({u})**2/2 + y**4/4
  - {force}
motion: {{x: 0, y: 0}}
"""
    assert word(text) is Word.STABLE
    assert not word(text.replace("'-", "'")).stable


BEAD = """
mbsym: 1
name: bead
parameters: {m: positive, g: positive, k: positive, l: positive}
bodies:
  - {name: bead, attached to: 0, connection point: [x, y, 0], mass: m, coordinates: [x, y]}
loads:
  - uniform gravity: {vector: [0, -g, 0]}
  - spring: {coordinate: x, stiffness: k}
  - LOAD
constraints:
  - TIE
motion: {x: 0, y: l}
values: {m: 1, g: 2, k: 2, l: 1}
"""
TIES = {
    "distance": "distance: {between: [{body: bead, point: [0, 0, 0]}, {body: 0, point: [0, 0, 0]}], length: l}",
    "relation": "relation: x**2 + y**2 = l**2",
    "velocity": "velocity: x*x_dot + y*y_dot = 0",
}
#: On top of the circle 2 y + x^2 = 2 - x^4/4 - x^6/8 - ...: what is added to it, and what is true of x = 0.
ON_TOP = {
    "potential: 0*x": Word.UNSTABLE,
    "potential: x**4": Word.STABLE,
    "potential: x**4/4": Word.UNSTABLE,  # -x^6/8 is left
    "potential: x**4/4 + x**6/8": Word.UNSTABLE,  # -5 x^8/64
    "damper: {coordinate: x, coefficient: 1}": Word.UNSTABLE,
    "potential: x**4\n  - damper: {coordinate: x, coefficient: 1}": Word.ASYMPTOTIC,
    "potential: x**4\n  - rayleigh: -y_dot**2": Word.UNDECIDED,  # what energy is brought in begins with x^2 x'^2
}


@pytest.mark.parametrize("tie", TIES)
@pytest.mark.parametrize("load", ON_TOP)
def test_what_gives_no_coordinate_explicitly(load: str, tie: str) -> None:
    """A velocity constraint keeps x^2 + y^2, which a disturbance may change: it does not come back then."""
    found, wanted = word(BEAD.replace("LOAD", load).replace("TIE", TIES[tie])), ON_TOP[load]
    assert found is (Word.STABLE if tie == "velocity" and wanted is Word.ASYMPTOTIC else wanted)


def test_forces_are_projected_on_every_coordinate_that_is_left() -> None:
    """Q = x (y', -x') is gyroscopic, z = y^2 by whatever tells it: V = 3 y^2/2 - x^4 + ... has no minimum."""
    words = set()
    for relation in ("z = y**2", "(z - y**2)*(2 + z + x) = 0"):
        text = IN_A_PLANE.replace("[x, y, 0]", "[x, y, z]").replace("[x, y]", "[x, y, z]")
        loads = "y**2/2 + z - x**4 - x**2*y**2/2\n  - generalized force: {x: y_dot*x, y: -x_dot*x}\nconstraints:\n"
        text = text.replace("POTENTIAL", f"{loads}  - relation: {relation}").replace("y: 0}", "y: 0, z: 0}")
        words.add(word(text))
    assert words == {Word.UNSTABLE}


ON_A_SPHERE = """
mbsym: 1
name: bead on a sphere
parameters: {m: positive, g: positive, k: positive, c: positive, l: positive}
bodies:
  - {name: bead, attached to: 0, connection point: [x, y, z], mass: m, coordinates: [x, y, z]}
loads:
  - uniform gravity: {vector: [0, 0, -g]}
  - spring: {coordinate: x, stiffness: k}
  - spring: {coordinate: y, stiffness: c}
  - LOAD
constraints:
  - distance: {between: [{body: bead, point: [0, 0, 0]}, {body: 0, point: [0, 0, 0]}], length: l}
motion: {x: 0, y: 0, z: l}
values: {m: 1, g: 2, k: 2, l: 1, c: C}
"""


@pytest.mark.parametrize(
    ("load", "c", "wanted"),
    [
        # V = -(x^2 + y^2)^2/4 + ...
        ("potential: 0*x", "2", Word.UNSTABLE),
        ("potential: x**4", "2", Word.UNSTABLE),
        ("potential: x**4 + y**4", "2", Word.STABLE),  # 3 (x^4 + y^4)/4 - x^2 y^2/2
        ("potential: 2*(x**2 + y**2)**2", "2", Word.STABLE),
        ("potential: (x**2 + y**2)**2/4 + x*y**3", "2", Word.UNSTABLE),
        # y^2/2 - (x^2 + y^2)^2/4
        ("potential: 0*x", "3", Word.UNSTABLE),
        ("potential: x**4", "3", Word.STABLE),
        # y^2/2 + 3 x^2 y/2 + x^4 (1 - 1/4): along y = -3 x^2/2 that is -3 x^4/8; and with 5/4 it is x^4/8
        ("potential: 3*x**2*y/2 + x**4", "3", Word.UNSTABLE),
        ("potential: 3*x**2*y/2 + 3*x**4/2", "3", Word.STABLE),
        # gyroscopic forces may hold what has no minimum
        ("generalized force: {x: 3*y_dot, y: -3*x_dot}", "2", None),
    ],
)
def test_two_coordinates_left(load: str, c: str, wanted: Word | None) -> None:
    found = word(ON_A_SPHERE.replace("LOAD", load).replace("C}", c + "}"))
    assert found.open if wanted is None else found is wanted


@pytest.mark.parametrize(
    ("potential", "wanted"),
    [
        ("(x**2 + y**2)**2", Word.STABLE),
        ("x**4 + y**4 - 3*x**2*y**2", Word.UNSTABLE),
        ("x**4 + y**4 - 2*x**2*y**2", None),
        ("x**3 + y**3", Word.UNSTABLE),
        ("x**6 + y**6", Word.STABLE),
        ("-x**4 - y**4\n  - generalized force: {x: 5*(x + y)*y_dot, y: -5*(x + y)*x_dot}", None),
        # x = 0 and y'' = 4 y^3 is a motion
        ("-x**4 - y**4\n  - generalized force: {x: 5*x*y_dot, y: -5*x*x_dot}", Word.UNSTABLE),
        ("-x**4 - y**4\n  - generalized force: {x: x_dot*y_dot, y: -x_dot**2}", Word.UNSTABLE),
    ],
)
def test_forms_in_two_coordinates(potential: str, wanted: Word | None) -> None:
    text = IN_A_PLANE.replace("POTENTIAL", potential)
    found = word(text)
    assert found.open if wanted is None else found is wanted


IN_A_PLANE = """
mbsym: 1
name: plane
parameters: {m: positive}
bodies:
  - {name: p, attached to: 0, connection point: [x, y, 0], mass: m, coordinates: [x, y]}
loads:
  - potential: POTENTIAL
motion: {x: 0, y: 0}
values: {m: 1}
"""


FIRST_TERM = """
mbsym: 1
name: on a line
parameters: {m: positive, k: positive, b: real, d: positive}
bodies:
  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}
loads:
  - potential: POTENTIAL
  - LOAD
motion: {x: 0}
"""


@pytest.mark.parametrize(
    ("potential", "load", "wanted"),
    [
        ("k*x**4", "", Word.STABLE),
        ("-k*x**4", "", Word.UNSTABLE),
        ("k*x**3", "", Word.UNSTABLE),
        ("k*x**6", "", Word.STABLE),
        ("b*x**3", "", Word.UNDECIDED),
        ("(b - k)*x**4/m", "", {"b - k > 0": Word.STABLE, "k - b > 0": Word.UNSTABLE}),
        # m x'' + 4 k x'^3 + 4 b x^3 = 0: the energy falls on every orbit but the rest, to a minimum of V or from none
        ("b*x**4", "rayleigh: k*x_dot**4", {"b > 0": Word.ASYMPTOTIC, "-b > 0": Word.UNSTABLE}),
        (
            "k*x**4",
            "rayleigh: b*x**2*x_dot**2",
            {"b > 0": Word.ASYMPTOTIC, "-b > 0": Word.UNSTABLE, "b = 0": Word.STABLE},
        ),
        ("k*x**4", "rayleigh: b**2*x**2*x_dot**2", Word.STABLE),
        # m x'' + d x' + V'(x) = 0: x' = -V'(x)/d + ... on the centre manifold
        ("k*x**4", "damper: {coordinate: x, coefficient: d}", Word.ASYMPTOTIC),
        ("k*x**3", "damper: {coordinate: x, coefficient: d}", Word.UNSTABLE),
        ("-k*x**4", "damper: {coordinate: x, coefficient: d}", Word.UNSTABLE),
        ("b*x**4", "damper: {coordinate: x, coefficient: d}", {"b > 0": Word.ASYMPTOTIC, "-b > 0": Word.UNSTABLE}),
    ],
)
def test_the_first_term_in_symbols(potential: str, load: str, wanted: Word | dict[str, Word]) -> None:
    text = FIRST_TERM.replace("POTENTIAL", potential).replace("  - LOAD\n", f"  - {load}\n" if load else "")
    stability = mbsym.loads(text, (4, 5, 6)).stability
    if isinstance(wanted, dict):
        assert stability.verdict.word is Word.DEPENDS
        assert wanted.items() <= cases(stability).items()
        return
    assert stability.verdict.word is wanted
    assert ("give all parameters values" in str(explanation(stability.verdict.reasons))) == wanted.open


def cases(stability: Stability) -> dict[str, Word]:
    """The word of every case, by its first condition."""
    (part,) = stability.subsystems
    return {f"{case.all_of[0].formula} {case.all_of[0].relation} 0": case.word for case in told_cases(part)}


def test_the_first_term_on_a_circle_in_symbols() -> None:
    """V = m g y + m g x^2/(2 l) + k x^4, y = l - x^2/(2 l) - x^4/(8 l^3): stable where 8 l^3 k > m g."""
    text = BEAD.replace("LOAD", "potential: k*x**4").replace("stiffness: k", "stiffness: m*g/l")
    text = text.replace("TIE", TIES["distance"]).replace("values: {m: 1, g: 2, k: 2, l: 1}\n", "")
    told = cases(mbsym.loads(text, (4, 5, 6)).stability)
    assert {"8*k*l**3 - m*g > 0": Word.STABLE, "m*g - 8*k*l**3 > 0": Word.UNSTABLE}.items() <= told.items()


JOINED = """
mbsym: 1
name: joined
parameters: {m: positive, k: positive, c: nonnegative}
bodies:
  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}
  - {name: q, attached to: 0, connection point: [y, 0, 0], mass: 2*m, coordinates: [y]}
  - {name: r, attached to: 0, connection point: [z, 0, 0], mass: m, coordinates: [z]}
loads:
  - potential: k*(x - y)**2 + LAST
  - rayleigh: c*(x_dot - z_dot)**2/2
motion: {x: 0, y: 0, z: 0}
values: {m: 1, k: 1, c: C}
"""


@pytest.mark.parametrize(
    ("last", "c", "wanted"),
    [
        ("(x - z)**4", "0", Word.STABLE_BUT_CYCLIC),
        ("(x - z)**4", "1", Word.STABLE_BUT_CYCLIC),
        ("-(x - z)**4", "0", None),
        ("(x - z)**3", "0", None),
    ],
)
def test_what_is_joined_may_drift_as_a_whole(last: str, c: str, wanted: Word | None) -> None:
    """Nothing holds x + y + z; the spring between x and z is none of first order."""
    found = word(JOINED.replace("LAST", last).replace("C}", c + "}"))
    assert found in (Word.UNSTABLE, Word.UNDECIDED) if wanted is None else found is wanted


ON_A_CYLINDER = """
mbsym: 1
name: on a cylinder
parameters: {m: positive, k: positive, c: positive, l: positive}
bodies:
  - {name: p, attached to: 0, connection point: [x, y, z], mass: m, coordinates: [x, y, z]}
loads:
  - potential: V
  - LOAD
constraints:
  - relation: x**2 + y**2 = l**2
motion: {x: 0, y: l, z: 0}
values: {m: 1, k: 1, c: 2, l: 1}
"""


@pytest.mark.parametrize(
    ("potential", "load", "wanted"),
    [
        ("k*z**2", "rayleigh: 0*x_dot", Word.STABLE_BUT_CYCLIC),
        ("-k*z**2", "rayleigh: 0*x_dot", Word.UNSTABLE),
        ("k*z**2", "rayleigh: c*z_dot**2", Word.ASYMPTOTIC_BUT_CYCLIC),
        ("k*z**2", "rayleigh: c*(x_dot**2 + y_dot**2 + z_dot**2)", Word.ASYMPTOTIC_BUT_CYCLIC),
        # it is driven round wherever z is not 0, and z stays what it was
        ("0*z", "generalized force: {x: -c*y*z, y: c*x*z}", Word.UNDECIDED),
        ("k*x**2", "rayleigh: 0*x_dot", Word.STABLE_BUT_CYCLIC),  # free along z alone
        ("-k*x**2", "rayleigh: 0*x_dot", Word.UNSTABLE),
    ],
)
def test_a_turn_that_changes_nothing_is_a_drift_under_constraints(potential: str, load: str, wanted: Word) -> None:
    assert word(ON_A_CYLINDER.replace("V", potential, 1).replace("LOAD", load)) is wanted


def test_two_masses_on_a_rod_about_a_centre() -> None:
    """x, y of the middle are held by springs of stiffness 4 k; the rod turns as it likes."""
    ends = "{body: p, point: [0, 0, 0]}, {body: q, point: [0, 0, 0]}"
    text = f"""
mbsym: 1
name: dumbbell
parameters: {{m: positive, k: positive, l: positive}}
bodies:
  - {{name: p, attached to: 0, connection point: [x, y, 0], mass: m, coordinates: [x, y]}}
  - {{name: q, attached to: 0, connection point: [u, v, 0], mass: m, coordinates: [u, v]}}
loads:
  - potential: k*(x**2 + y**2 + u**2 + v**2)
constraints:
  - distance: {{between: [{ends}], length: l}}
motion: {{x: l/2, y: 0, u: -l/2, v: 0}}
values: {{m: 1, k: 1, l: 1}}
"""
    assert word(text) is Word.STABLE_BUT_CYCLIC
    across = text.replace("k*(x**2 + y**2 + u**2 + v**2)", "k*(x**2 + 2*y**2 + u**2 + 2*v**2)")
    assert word(across) is Word.STABLE
    assert word(across.replace("+ 2*", "+ ").replace("k*(x**2", "k*(2*x**2").replace("u**2", "2*u**2")) is Word.UNSTABLE


RELATIVE = """
mbsym: 1
name: two on a line
parameters: {m: positive, u: real}
bodies:
  - {name: p, attached to: 0, mass: m, connection point: [x, 0, 0], coordinates: [x]}
  - {name: q, attached to: 0, mass: m, connection point: [y, 0, 0], coordinates: [y]}
loads:
  - potential: POTENTIAL
motion: {x: {rate: 2*u}, y: {rate: u}}
values: {m: 1, u: 1}
"""


@pytest.mark.parametrize(
    ("potential", "wanted"),
    [
        ("(x - 2*y)**4", Word.STABLE_BUT_CYCLIC),
        ("(x - 2*y)**6", Word.STABLE_BUT_CYCLIC),
        ("-(x - 2*y)**4", Word.UNSTABLE),
        ("(x - 2*y)**3", Word.UNSTABLE),
    ],
)
def test_uniform_motion_is_judged_as_rest(potential: str, wanted: Word) -> None:
    """s = x - 2 y: s'' = -5 V'(s)/m at every value of the momentum 2 x' + y'."""
    text = RELATIVE.replace("POTENTIAL", potential)
    assert word(text) is wanted
    assert (
        word(text.replace("{rate: 2*u}", "0").replace("{rate: u}", "0").replace(", u: real", "").replace(", u: 1", ""))
        is wanted
    )


FREE_HOOP = """
mbsym: 1
name: bead on a hoop that turns freely
parameters: {m: positive, R: positive, g: positive, J: positive, w: positive, k: real}
bodies:
  - {name: hoop, attached to: 0, mass: 1, inertia: [J, J, J], inertia about: joint,
     rotation: {axes: [3], angles: [psi]}, coordinates: [psi]}
  - {name: bead, attached to: hoop, mass: m, coordinates: [theta], connection point: [R*sin(theta), 0, -R*cos(theta)]}
loads:
  - uniform gravity: {acceleration: g, direction: [0, 0, -1]}
  - potential: k*theta**4
motion: {psi: {rate: w}, theta: 0}
values: {m: 1, R: 1, g: 4, J: 2, w: 2, k: 0}
"""


@pytest.mark.parametrize(("k", "wanted"), [("0", Word.STABLE_BUT_CYCLIC), ("-2", Word.UNSTABLE)])
def test_a_minimum_of_the_amended_potential_is_one_of_neighbouring_momenta_too(k: str, wanted: Word) -> None:
    """p^2/(2 (J + m R^2 sin^2 x)) - m g R cos x + k x^4 at p = J w, w^2 = g/R: the coefficient of x^4 is

    m g R (1/8 + m R^2/(2 J)) + k = 3/2 + k.
    """
    assert word(FREE_HOOP.replace("k: 0}", f"k: {k}}}")) is wanted
