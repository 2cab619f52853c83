"""Rests and steady motions that textbooks decide by an energy, by rests near by, or on a carrier that runs evenly."""

from __future__ import annotations

import math

import pytest

import mbsym
from mbsym.analysis.resting import relative_equilibria
from mbsym.mechanics.rest import given_values
from mbsym.problems.stability.words import Because, Word


def word(text: str) -> Word:
    found = mbsym.loads(text, (4, 5, 6)).stability.numerical
    assert found is not None
    return found.word


SKATE = """
mbsym: 1
name: skate
parameters: {k: real, c: real, d: real}
bodies:
  - {name: p, mass: 1, connection point: [x, y, 0], rotation: {axes: [3], angles: [th]}, inertia about: joint,
     inertia: [0, 0, 1], coordinates: [x, y, th]}
loads: [potential: V, rayleigh: d*(x_dot**2 + y_dot**2 + th_dot**2)/2]
constraints: [velocity: x_dot*sin(th) - y_dot*cos(th) = 0]
motion: {x: 0, y: Y, th: 0}
values: {k: 1, c: 4, d: D}
"""
WELL, HELD = "k*(x**2 + y**2)/2", "k*(x**2 + y**2)/2 + c*th**2/2"


@pytest.mark.parametrize(
    ("potential", "place", "damping", "wanted"),
    [
        # E = T + V has a strict minimum, and the edge does no work (Neimark & Fufaev, chapter V)
        (HELD, "0", "0", Word.STABLE),
        # Roots of l^2 + d l + 1 and l^2 + d l + 4; x = th = 0 are rests for every y: one zero root
        (HELD, "0", "1", Word.ASYMPTOTIC_BUT_STEADY),
        (HELD, "1", "1/2", Word.ASYMPTOTIC_BUT_STEADY),
        # th'' = 0, and x^2 + y^2 stays small
        (WELL, "0", "0", Word.STABLE_BUT_CYCLIC),
        # x cos(th) + y sin(th) = 0 are rests: two dimensions, a curved manifold; l^2 + l + 1, l + 1
        (WELL, "1", "1", Word.ASYMPTOTIC_BUT_STEADY),
        ("-k*x**2/2 + c*th**2/2 + y**2", "0", "1", Word.UNSTABLE),
    ],
)
def test_a_skate_in_a_well(potential: str, place: str, damping: str, wanted: Word) -> None:
    text = SKATE.replace("V,", f"{potential},").replace("Y", place).replace("D}", f"{damping}}}")
    assert word(text) is wanted


def test_a_skate_that_looks_along_the_other_axis() -> None:
    """The velocity that depends on the others is another one there."""
    text = SKATE.replace("V,", HELD.replace("th**2", "(th - pi/2)**2") + ",").replace("D}", "1/2}")
    assert word(text.replace("{x: 0, y: Y, th: 0}", "{x: -1, y: 0, th: pi/2}")) is Word.ASYMPTOTIC_BUT_STEADY


@pytest.mark.parametrize(("potential", "place"), [("k*(x**2 - y**2)/2 + c*th**2/2", "0"), (HELD, "1")])
def test_an_energy_without_minimum_proves_nothing(potential: str, place: str) -> None:
    """Across the edge V falls, or is not stationary: the edge holds the skate there."""
    text = SKATE.replace("V,", f"{potential},").replace("Y", place).replace("D}", "0}")
    assert word(text).open


@pytest.mark.parametrize(
    ("potential", "wanted"),
    [
        (HELD, Word.STABLE),
        (WELL, Word.STABLE_BUT_CYCLIC),
        ("-k*x**2/2 + c*th**2/2", Word.UNSTABLE),
        # It rests across the slope, where it could not without its edge; turned by a little it slides away.
        ("k*y", Word.UNDECIDED),
    ],
)
def test_what_is_said_of_a_skate_for_all_parameters(potential: str, wanted: Word) -> None:
    text = SKATE.replace("V,", f"{potential},").replace("Y", "0").replace("d*(", "0*(").replace(", d: real", "")
    text = text.replace("k: real, c: real", "k: positive, c: positive").replace("values: {k: 1, c: 4, d: D}\n", "")
    found = mbsym.loads(text, (4, 5, 6)).stability
    assert found.verdict.word is wanted
    assert found.numerical is None or found.numerical.word is wanted


def test_values_say_more_than_what_holds_for_all_parameters() -> None:
    text = SKATE.replace("V,", f"{HELD},").replace("Y", "0").replace("D}", "1}")
    text = text.replace("k: real, c: real, d: real", "k: positive, c: positive, d: nonnegative")
    found = mbsym.loads(text, (4, 5, 6)).stability
    assert found.numerical is not None
    assert (found.verdict.word, found.numerical.word) == (Word.STABLE, Word.ASYMPTOTIC_BUT_STEADY)


@pytest.mark.parametrize("more", ["", ", velocity: th_dot = 0", ", velocity: th_dot = x_dot"])
def test_what_constraints_hold_does_not_drift(more: str) -> None:
    """Without them th drifts in the well; th' = 0 holds it, and so does th' = x', for th moves with x then."""
    text = SKATE.replace("V,", f"{WELL},").replace("Y", "0").replace("D}", "0}")
    found = word(text.replace("cos(th) = 0]", f"cos(th) = 0{more}]"))
    assert found is Word.STABLE_BUT_CYCLIC if not more else found in (Word.STABLE, Word.CRITICAL, Word.UNDECIDED)


TIED = """
mbsym: 1
name: tied
bodies:
  - {name: p, mass: 1, connection point: [x, y, z], coordinates: [x, y, z]}
loads: [potential: V, FORCE]
constraints: [velocity: ROW]
motion: {x: 0, y: 0, z: 0}
"""
MAGNETIC = "generalized force: {x: 3*y_dot, y: -3*x_dot}"


@pytest.mark.parametrize(
    ("potential", "force", "row", "drifts"),
    [
        # At z = e, y = 0 it rests, and near that y""" + 8 y' = 24 e y: y grows, and z' = y x' with it
        ("4*z**2 - y**2/2", MAGNETIC, "z_dot = y*x_dot", False),
        # z is a cosine, y = x^2/2 + int z dx stays small with T + y^2/2, and so does x
        ("(y**2 + z**2)/2", "rayleigh: 0*x_dot", "y_dot = (x + z)*x_dot", False),
        # (1, 1, 0) is allowed wherever it is: x' + y' is constant
        ("z**2/2", "rayleigh: 0*x_dot", "x_dot = y_dot + y*z*z_dot", True),
        # x = e t, y = z = 0 is a motion for every e, though elsewhere the row turns
        ("(y**2 + z**2)/2", "rayleigh: 0*x_dot", "z_dot = y*x_dot", True),
    ],
)
def test_reactions_change_momenta_and_bend_what_drifts(potential: str, force: str, row: str, drifts: bool) -> None:
    found = word(TIED.replace("V,", f"{potential},").replace("FORCE", force).replace("ROW", row))
    assert found is Word.STABLE_BUT_CYCLIC if drifts else found.open


def test_what_turns_is_held_though_not_at_first() -> None:
    """(0, 1, 0) at x = 1 is allowed; turned by an angle a the point has z = -a^2/2 + ..., and V = a^4/4."""
    text = TIED.replace("V, FORCE", "(x**2 + y**2 - 1)**2 + z**2").replace("x: 0", "x: 1")
    assert word(text.replace("ROW", "z_dot = (1 + y*z)*x_dot")) in (Word.STABLE, Word.CRITICAL, Word.UNDECIDED)


@pytest.mark.parametrize(
    ("row", "wanted"),
    [
        # y'' = -y': y tends to another place, and x runs there, however near that is
        ("x_dot = y", None),
        ("x_dot = y**2", None),
        ("x_dot = y**2 + y*z_dot", None),
        ("x_dot = x**3", None),  # no other x is a rest
        ("x_dot = y*z", Word.ASYMPTOTIC_BUT_STEADY),  # z decays: x and y end where they do
    ],
)
def test_where_a_constraint_makes_it_run_nothing_rests(row: str, wanted: Word | None) -> None:
    text = TIED.replace("V,", "z**2*(1 + x**2)/2,").replace("FORCE", "rayleigh: (y_dot**2 + z_dot**2)/2")
    found = word(text.replace("ROW", row))
    assert found.open or found is Word.UNSTABLE if wanted is None else found is wanted


@pytest.mark.parametrize(
    ("potential", "row", "motion", "wanted"),
    [
        # y'' = -y: the integral of y is bounded, and so is x
        ("(x**2 + y**2 + z**2)/2", "x_dot = y", "x: 0", (Word.STABLE,)),
        ("(y**2 + z**2)/2", "2*x_dot = 3", "x: {rate: 3/2}", (Word.STABLE,)),
        # z'' = -z, y'' = 0: y = v t, and x' = v t is no velocity that stays near its own
        ("z**2/2", "x_dot = y", "x: 0", (Word.UNDECIDED, Word.UNSTABLE)),
    ],
)
def test_what_a_constraint_makes_run_drifts_where_its_rate_has_a_mean(
    potential: str, row: str, motion: str, wanted: tuple[Word, ...]
) -> None:
    text = TIED.replace("V, FORCE", potential).replace("ROW", row).replace("x: 0", motion)
    assert word(text) in wanted


def test_what_comes_to_rest_elsewhere_leaves_what_runs_with_it_running() -> None:
    """y'' = -y', x' = y: x' does not tend to 0 again."""
    text = TIED.replace("V, FORCE", "z**2/2, rayleigh: (y_dot**2 + z_dot**2)/2").replace("ROW", "x_dot = y")
    assert word(text) is Word.STABLE_BUT_CYCLIC


VALLEY = """
mbsym: 1
name: valley
bodies:
  - {name: p, mass: 1, connection point: [POINT, 0], coordinates: [x, y]}
loads: [potential: V, FORCE]
motion: {x: X, y: 0}
"""
NO_FORCE, DAMPED = "rayleigh: 0*x_dot", "rayleigh: (x_dot**2 + y_dot**2)/2"


@pytest.mark.parametrize(
    ("point", "potential", "place", "force", "wanted"),
    [
        # Slow motions follow the parabola (Rubin & Ungar): y = e, T = 3/e leads to y = 1.5, however small e is
        ("x, y", "(x - y**2)**2", "0", NO_FORCE, Word.UNSTABLE),
        ("x + y**2, y", "x**2", "0", NO_FORCE, Word.UNSTABLE),
        ("y + x, y - x", "(y + x - (y - x)**2)**2", "0", NO_FORCE, Word.UNSTABLE),
        ("x, y", "(x - y**2)**2", "0", DAMPED, Word.ASYMPTOTIC_BUT_STEADY),
        ("x, y", "(x**2 + 2*y**2 - 1)**2", "1", NO_FORCE, Word.UNSTABLE),
        ("x, y", "(x**2 + y**2 - 1)**2", "1", NO_FORCE, Word.STABLE_BUT_CYCLIC),
        ("x, y", "(x - y**2)**2 + y**4", "0", NO_FORCE, Word.STABLE),
        ("x, y", "-(x - y**2)**2", "0", NO_FORCE, Word.UNSTABLE),
    ],
)
def test_a_valley_of_rests(point: str, potential: str, place: str, force: str, wanted: Word) -> None:
    text = VALLEY.replace("POINT", point).replace("V,", f"{potential},").replace("FORCE", force)
    assert word(text.replace("X", place)) is wanted


def test_gyroscopic_forces_may_hold_what_moves_along_a_valley() -> None:
    force = "generalized force: {x: 3*y_dot, y: -3*x_dot}"
    text = VALLEY.replace("POINT", "x, y").replace("V,", "(x - y**2)**2,").replace("FORCE", force)
    assert word(text.replace("X", "0")).open


SHAFT = """
mbsym: 1
name: bob on a shaft
parameters: {W: positive, g: positive}
bodies:
  - {name: shaft, attached to: 0, mass: 0, rotation: {axes: [3], angles: [p]}, inertia about: joint,
     inertia: [0, 0, 1], coordinates: [p]}
  - {name: bob, attached to: shaft, mass: 1, rotation: {axes: [1], angles: [th]}, mass centre: [0, 0, -1],
     coordinates: [th]}
loads: [uniform gravity: {vector: [0, 0, -g]}]
RUN
values: {W: 2, g: G}
"""
RUNS = {
    "prescribed": "motion: {th: 0}",
    "relation": "constraints: [relation: p = W*t]\nmotion: {p: {rate: W}, th: 0}",
    "velocity": "constraints: [velocity: 3*p_dot = 3*W]\nmotion: {p: {rate: W}, th: 0}",
}


@pytest.mark.parametrize("run", RUNS)
@pytest.mark.parametrize(
    # th'' + sin(th) (g - W^2 cos(th)) = 0: Jacobi's integral; at g = W^2 V = W^2 th^4/8 + ...
    ("gravity", "wanted"),
    [("5", Word.STABLE), ("4", Word.STABLE), ("3", Word.UNSTABLE)],
)
def test_a_shaft_that_runs_evenly(run: str, gravity: str, wanted: Word) -> None:
    text = SHAFT.replace("RUN", RUNS[run]).replace("G}", f"{gravity}}}")
    if run == "prescribed":
        text = text.replace(", coordinates: [p]", "").replace(
            "inertia: [0, 0, 1], coordinates: [p]", "inertia: [0, 0, 1]"
        )
        text = text.replace("bodies:", "prescribed: {p: {rate: W}}\nbodies:", 1)
    assert word(text) is wanted


HOOP = """
mbsym: 1
name: cylinder in a hoop that turns
parameters: {R: positive, r: positive, g: positive, W: real}
prescribed: {chi: {rate: W}}
bodies:
  - {name: hoop, attached to: 0, mass: 0, rotation: {axes: [3], angles: [chi]}}
  - {name: arm, attached to: 0, mass: 0, rotation: {axes: [3], angles: [p]}, coordinates: [p]}
  - {name: cyl, attached to: arm, mass: 1, connection point: [CENTRE], rotation: {axes: [3], angles: [th]},
     inertia about: joint, inertia: [0, 0, r**2/2], coordinates: [th]}
loads: [uniform gravity: {vector: [GRAVITY]}]
constraints: [rolling: {body: cyl, point: [CONTACT], on: hoop}]
motion: {p: 0, th: {rate: W*(R + r)/r}}
values: {R: 2, r: 1, g: 9.81, W: 3}
"""
DOWN = ("0, -R, 0", "0, -g, 0", "r*sin(-th), -r*cos(th), 0")
LEFT = ("-R, 0, 0", "-g, 0, 0", "-r*cos(th), r*sin(th), 0")


@pytest.mark.parametrize(("centre", "gravity", "contact"), [DOWN, LEFT])
def test_a_wheel_whose_rows_vanish_one_after_another(centre: str, gravity: str, contact: str) -> None:
    """3 R p'' + 2 g sin(p) = 0 whatever W; along fixed axes the rows are -g sin(p) and g cos(p), g that of the contact.

    So p = 0 and p = pi are the steady motions, and no position is singular.
    """
    text = HOOP.replace("CENTRE", centre).replace("GRAVITY", gravity).replace("CONTACT", contact)
    assert word(text) is Word.STABLE
    analysis = mbsym.loads(text, (3,))
    (redundant,) = analysis.constraints.redundant
    assert len(redundant.from_rows) == 1
    listed = relative_equilibria(analysis.system, given_values(analysis.system, {}))
    assert [x.verdict.word for x in listed.equilibria] == [Word.STABLE, Word.UNSTABLE]
    assert listed.complete
    assert not listed.remarks


SPRING = "spring: {between: [{body: p, point: [0, 0, 0]}, {body: 0, point: [END, 0, 0]}], stiffness: k, length: l}"


@pytest.mark.parametrize("slack", ["0", "1/10"])
def test_a_mass_between_two_springs_without_tension(slack: str) -> None:
    """V = k x^2 + k (y^2 + z^2)^2/(4 l^2) + ...; where the springs are longer than that they push aside."""
    text = f"""
mbsym: 1
name: between two springs
parameters: {{l: positive, k: positive}}
bodies:
  - {{name: p, mass: 1, connection point: [x, y, z], coordinates: [x, y, z]}}
loads: [{SPRING.replace("END", f"l - {slack}")}, {SPRING.replace("END", f"{slack} - l")}]
motion: {{x: 0, y: 0, z: 0}}
values: {{l: 3, k: 2}}
"""
    assert word(text) is (Word.STABLE if slack == "0" else Word.UNSTABLE)


@pytest.mark.parametrize(
    ("potential", "force", "wanted"),
    [
        # Along y = 0 all is at rest, and x = x' t
        ("x**2*y**2", NO_FORCE, Word.UNSTABLE),
        ("x**2*y**2 + y**4", NO_FORCE, Word.UNSTABLE),
        ("x**2*y**2 + y**4 + x**4", NO_FORCE, Word.STABLE),
        # y = 0, x'' = 4 x^3: it leaves, though y is held by friction
        ("x**2*y**2 - x**4 + y**2", "damper: {coordinate: y, coefficient: 1}", Word.UNSTABLE),
        # What comes to rest elsewhere along y = 0 need not leave
        ("x**2*y**2", DAMPED, None),
    ],
)
def test_one_coordinate_moves_while_the_other_rests(potential: str, force: str, wanted: Word | None) -> None:
    text = VALLEY.replace("POINT", "x, y").replace("V,", f"{potential},").replace("FORCE", force).replace("X", "0")
    found = word(text)
    assert found.open if wanted is None else found is wanted


@pytest.mark.parametrize(
    ("loads", "wanted"),
    [
        ("potential: abs(x)**3", Word.STABLE),
        ("potential: 2*abs(3*x)**3 - x**3", Word.STABLE),  # 53 x^3 and 55 |x|^3
        ("potential: abs(x)**3/2 - x**3", Word.UNSTABLE),  # -x^3/2 for x > 0
        ("potential: x**4 - abs(x)**3", Word.UNSTABLE),
        ("potential: x**3 + abs(x)**3", Word.UNDECIDED),  # every x < 0 is a rest
        ("potential: abs(x)**3, damper: {coordinate: x, coefficient: 1}", Word.ASYMPTOTIC),
        ("potential: abs(x)**3, generalized force: {x: abs(x)*x_dot}", Word.UNDECIDED),
    ],
)
def test_a_potential_with_another_first_term_on_either_side(loads: str, wanted: Word) -> None:
    text = "mbsym: 1\nname: kink\nbodies:\n  - {name: p, mass: 1, connection point: [x, 0, 0], coordinates: [x]}\n"
    assert word(f"{text}loads: [{loads}]\nmotion: {{x: 0}}\n") is wanted


def test_parts_are_told_by_reasons_of_their_own() -> None:
    """K is that of x alone: of y it is 0, and |y|^3 makes the minimum."""
    text = VALLEY.replace("POINT", "x, y").replace("V, FORCE", "abs(y)**3 + x**2/2").replace("X", "0")
    found = mbsym.loads(text, (4, 5, 6)).stability.numerical
    assert found is not None
    assert {(reason.code, reason.data) for reason in found.reasons} == {
        (Because.HIGHER_MINIMUM, (3,)),
        (Because.APART, ("y",)),
    }


OPEN_VALLEY = """
mbsym: 1
name: valley
parameters: {}
bodies: [{name: p, mass: 1, connection point: [x, y, z], coordinates: [x, y, z]}]
loads: [potential: V, rayleigh: d*(x_dot**2 + y_dot**2 + z_dot**2)/2]
motion: {}
"""


@pytest.mark.parametrize(
    ("potential", "damping", "wanted"),
    [
        # x = -sqrt(2), any y: V'' across is 16 (1 + y^2), so that it moves evenly along y
        ("(x**2 - 2)**2*(1 + y**2) + z**2", "0", Word.UNSTABLE),
        # l^2 + l + 16 (1 + y^2), l^2 + l + 2, l (l + 1): one zero root along one dimension of rests
        ("(x**2 - 2)**2*(1 + y**2) + z**2", "1", Word.ASYMPTOTIC_BUT_STEADY),
        # ... l^2 + l - 2
        ("(x**2 - 2)**2*(1 + y**2) - z**2", "1", Word.UNSTABLE),
        # a circle of rests, alike by a symmetry
        ("(x**2 + y**2 - 2)**2 + z**2", "0", Word.STABLE_BUT_CYCLIC),
        ("(x**2 + y**2 - 2)**2 + z**2", "1", Word.ASYMPTOTIC_BUT_CYCLIC),
        # the same at a sum of square roots: (x - 1)^2 = 2
        ("((x - 1)**2 - 2)**2*(1 + y**2) + z**2", "1", Word.ASYMPTOTIC_BUT_STEADY),
        # of fields of a higher degree nothing is known: x^3 = 2
        ("(x**3 - 2)**2*(1 + y**2) + z**2", "1", Word.UNDECIDED),
    ],
)
def test_members_of_families_at_square_roots(potential: str, damping: str, wanted: Word) -> None:
    text = OPEN_VALLEY.replace("V,", f"{potential},").replace("d*", f"{damping}*")
    system = mbsym.loads(text).system
    (family,) = relative_equilibria(system, given_values(system, {})).families
    assert any(not x.exact for x in family.sample)
    assert family.verdict.word is wanted


def test_a_family_within_another_is_not_told_again() -> None:
    """grad V = 2 F (3 x^2, 2 y, 2 z), F = x^3 + y^2 + z^2 - 2, vanishes on F = 0 and at 0: x = F = 0 lies in F = 0."""
    text = OPEN_VALLEY.replace("V,", "(x**3 + y**2 + z**2 - 2)**2,").replace("d*", "0*")
    system = mbsym.loads(text).system
    found = relative_equilibria(system, given_values(system, {}))
    assert [family.dimension for family in found.families] == [2]
    assert len(found.equilibria) == 1
    # F = x (y^2 + z^2 - 1): the plane and the cylinder are two, and their circle is in both
    crossed = mbsym.loads(OPEN_VALLEY.replace("V,", "x**2*(y**2 + z**2 - 1)**2,").replace("d*", "0*")).system
    assert [family.dimension for family in relative_equilibria(crossed, given_values(crossed, {})).families] == [2, 2]


ROLY_POLY = """
mbsym: 1
name: roly-poly
parameters: {a: A}
bodies:
  - {name: centre, attached to: 0, connection point: [x, y, 1], coordinates: [x, y], mass: 0}
  - {name: ball, attached to: centre, rotation: TURN, mass: 2, mass centre: [0, 0, -a], inertia about: mass centre,
     inertia: [1/5, 1/4, 3/10]}
loads: [uniform gravity: {vector: [0, 0, -10]}]
constraints: [rolling: {body: ball, point: [0, 0, -1], axes: centre, on: ground}]
motion: {x: 0, y: 0, al: 0, be: 0, ga: 0}
"""
VERTICAL_FIRST = "{axes: [3, 1, 2], angles: [ga, al, be]}"


@pytest.mark.parametrize(
    ("turn", "height", "more", "wanted"),
    [
        # T + m g a (1 - cos) bounds the tilt; turning evenly about the vertical it stays where it is
        (VERTICAL_FIRST, "1/10", "", [Word.STABLE_BUT_CYCLIC]),
        ("{axes: [1, 2, 3], angles: [al, be, ga]}", "1/10", "", [Word.STABLE_BUT_CYCLIC]),
        ("{axes: [2, 1, 3], angles: [be, al, ga]}", "1/10", "", [Word.STABLE_BUT_CYCLIC]),
        (VERTICAL_FIRST, "-1/10", "", [Word.UNSTABLE]),
        # It must not turn about the vertical (rubber): that it drifts is not shown
        (
            VERTICAL_FIRST,
            "1/10",
            ", velocity: ga_dot + be_dot*sin(al) = 0",
            [Word.STABLE, Word.CRITICAL, Word.UNDECIDED],
        ),
        (VERTICAL_FIRST, "1/10", ", velocity: ga_dot = x_dot", [Word.STABLE, Word.CRITICAL, Word.UNDECIDED]),
    ],
)
def test_a_roly_poly_stands_up_in_any_angles(turn: str, height: str, more: str, wanted: list[Word]) -> None:
    text = ROLY_POLY.replace("TURN", turn).replace("A}", f"{{sign: real, value: {height}}}}}")
    assert word(text.replace("ground}]", f"ground}}{more}]")) in wanted


def test_rests_of_a_roly_poly_are_listed_with_these_verdicts() -> None:
    """al and be are 0 or pi, the others any: upright where both are the same.

    Turned about the vertical, (pi, pi) is (0, 0), and (0, pi) is (pi, 0).
    """
    system = mbsym.loads(
        ROLY_POLY.replace("TURN", VERTICAL_FIRST).replace("A}", "{sign: real, value: 1/10}}"), ()
    ).system
    listed = relative_equilibria(system, given_values(system, {}))
    words = {tuple(x.value for x in one.values): one.verdict.word for one in listed.equilibria}
    assert len(words) == 2
    for (al, be), found in words.items():
        assert found is (Word.STABLE_BUT_CYCLIC if al == be else Word.UNSTABLE)


def test_where_angles_are_singular_a_rolling_ball_need_not_rest() -> None:
    """V = -cos(al) cos(be) has no place of rest on its side, though its slopes by al and be vanish at pi/2, pi/2."""
    text = ROLY_POLY.replace("TURN", VERTICAL_FIRST).replace("A}", "0}")
    text = text.replace("uniform gravity: {vector: [0, 0, -10]}", "potential: -cos(al)*cos(be)")
    system = mbsym.loads(text, ()).system
    listed = relative_equilibria(system, given_values(system, {}))
    assert len(listed.equilibria) == len(listed.singular) == 4
    assert {abs(x.value) for one in listed.singular for x in one.values} == {math.pi / 2}
