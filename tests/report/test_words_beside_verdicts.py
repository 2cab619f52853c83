"""Words that stand beside a verdict and say what it is about: headings, what is new, why there is nothing.

Derived by hand.  Jeffcott's rotor has no zero root (k > 0); Chaplygin's sleigh has them, as its speed is free.  Of a
Penning trap, z'' + i wc z' - wz^2 z/2 = 0, equality in wc > wz is no border case: there the motion is unstable.  Of a
wheel that drags on a free shaft, B (a'' + b'') = -c b', so that B (a' + b') + c b is constant.  A mass dragged at speed
v by a spring through a resisting medium stays behind by c v/k: it cannot move where the spring has no tension.
"""

from __future__ import annotations

import pickle
from fractions import Fraction
from pathlib import Path

import pytest
from conftest import SHIPPED, STATEMENTS, filed, invoked
from terminal import told

import mbsym
from mbsym.algebra.failures import Failure
from mbsym.analysis.expanding import expansion
from mbsym.problems.stability.words import Because, Reason
from mbsym.report.content import Display, Phrase, Subheading
from mbsym.report.plain_writer import Writer
from mbsym.report.results import results
from mbsym.report.sections import equilibrium, stability
from mbsym.report.targets import TARGETS

SYSTEMS = Path(__file__).parents[2] / "systems"

SLEIGH = """
mbsym: 1
name: sleigh
parameters: {m: positive, J: positive, a: real, u: real}
bodies:
  - name: sleigh
    connection point: [x, y, 0]
    rotation: {axes: [3], angles: [f]}
    mass centre: [a, 0, 0]
    mass: m
    inertia about: mass centre
    inertia: [J, J, J]
    coordinates: [x, y, f]
constraints:
  - velocity: -x_dot*sin(f) + y_dot*cos(f) = 0
motion: {x: {value: 0, rate: u}, y: 0, f: 0}
"""
DRAGGED = """
mbsym: 1
name: dragged
parameters: {m: positive, k: positive, c: positive, v: positive}
prescribed: {s: v}
bodies:
  - {name: b, mass: m, connection point: [x, 0, 0], coordinates: [x]}
loads:
  - potential: k*(x - s)**2/2
  - rayleigh: c*x_dot**2/2
motion: {x: {value: 0, rate: v}}
"""
OBLIQUE = """
mbsym: 1
name: a valley
parameters: {c: positive}
bodies:
  - {name: P, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
loads:
  - potential: (x - 2*y)**4
  - damper: {coordinate: x, coefficient: c}
  - damper: {coordinate: y, coefficient: c}
"""

WHEEL = """
mbsym: 1
name: wheel
parameters: {A: positive, B: positive, c: positive}
bodies:
  - {name: shaft, rotation: {axes: [3], angles: [a]}, mass: 0, inertia about: joint, inertia: [A, A, A]}
  - name: wheel
    attached to: shaft
    rotation: {axes: [3], angles: [b]}
    mass: 0
    inertia about: joint
    inertia: [B, B, B]
loads:
  - damper: {coordinate: b, coefficient: c}
motion: {}
"""
TURNED = """
mbsym: 1
name: turned
parameters: {m: positive, k: real, w: positive}
prescribed: {chi: {rate: w}}
bodies:
  - {name: table, attached to: 0, rotation: {axes: [3], angles: [chi]}, mass: 0}
  - {name: p, attached to: table, connection point: [x, y, 0], mass: m, coordinates: [x, y]}
loads:
  - potential: k*(x**2 + y**2)/2
motion: {}
"""


def headings(analysis: mbsym.Analysis) -> list[str]:
    return [line for line in told(analysis, 6) if line.startswith("Conditions (")]


def test_zero_roots_are_spoken_of_where_there_are_any() -> None:
    (rotor,) = headings(mbsym.load(STATEMENTS / "jeffcott.yaml"))
    assert "zero" not in rotor
    assert "all roots to the left" in rotor
    (sleigh,) = headings(mbsym.loads(SLEIGH))
    assert "all roots but the zero ones" in sleigh


def test_a_heading_does_not_call_necessary_what_its_line_does_not() -> None:
    analysis = mbsym.loads(TURNED)
    (heading,) = headings(analysis)
    assert any("(necessary: with equality" in line for line in told(analysis, 6))
    assert "necessary" not in heading


def test_what_problem_7_lists_is_not_told_to_be_no_function_of_it() -> None:
    lines = " ".join(told(mbsym.loads(WHEEL), 9))
    assert "an integral that is known (momentum of b with the impulse of forces)" in lines
    assert "no function of those of problem 7" not in lines


def test_what_only_a_symmetry_gives_is_a_further_integral() -> None:
    """V = (x - 2 y)^4 is the same along (2, 1), which is no axis: 2 x' + y' + c (2 x + y) = const."""
    lines = " ".join(told(mbsym.loads(OBLIQUE), 9))
    assert "a further integral, no function of those known without it (proved)" in lines
    assert "2 x' + y' + c (2 x + y) = const" in lines


@pytest.mark.parametrize("stage", ["stabilisation", "normal_forms"])
def test_of_a_motion_that_cannot_be_nothing_else_is_said(stage: str) -> None:
    with pytest.raises(Failure, match="the given motion does not exist: -c\\*v = 0 is impossible"):
        getattr(mbsym.loads(DRAGGED), stage)


PULLED = """
mbsym: 1
name: pulled
parameters: {mu: positive, g: positive}
small parameter: mu
bodies:
  - {name: p, mass: mu, connection point: [x, 0, 0], coordinates: [x]SPEEDS}
loads:
  - generalized force: {x: "g - x_dot"}
motion: {x: 0}
"""


def test_why_a_motion_cannot_be_is_one_sentence() -> None:
    """x = 0 would need g = 0, of first order in speeds and beside an expansion in the small mass, too."""
    why = "the given motion does not exist: g = 0 is impossible"
    with pytest.raises(Failure, match=why):
        mbsym.loads(PULLED.replace("SPEEDS", ", speeds: {u: x_dot}")).first_order  # noqa: B018
    assert str(expansion(mbsym.loads(PULLED.replace("SPEEDS", "")), 1).missing) == why
    possible = PULLED.replace("SPEEDS", "").replace("motion: {x: 0}", "motion: {x: {value: 0, rate: g}}")
    assert "does not exist" not in str(expansion(mbsym.loads(possible), 1).missing)


PRESSED = """
mbsym: 1
name: pressed
parameters: {k: real, c: positive}
ASSUMED
bodies:
  - {name: p, mass: 1, connection point: [x, 0, 0], coordinates: [x]}
loads:
  - potential: k*x**2/2
  - rayleigh: c*x_dot**2/2
motion: {x: 0}
"""


@pytest.mark.parametrize(("assumed", "times"), [("assumptions: [k <= 0]", 1), ("assumptions: [k < 0]", 0)])
def test_what_is_asked_of_all_is_no_alternative_as_well(assumed: str, times: int) -> None:
    """x'' + c x' + k x = 0 with k <= 0 is unstable where k != 0, which is one condition."""
    lines = told(mbsym.loads(PRESSED.replace("ASSUMED", assumed)), 6)
    assert sum("k != 0" in line for line in lines) == times


SPRING = """
mbsym: 1
name: Spring pendulum
parameters: {m: positive, k: positive, L: positive, g: positive}
bodies: [{name: bob, attached to: 0, mass: m, coordinates: [r, theta],
          connection point: [r*sin(theta), -r*cos(theta), 0]}]
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
  - spring: {coordinate: r, stiffness: k, rest: L}
"""


@pytest.mark.parametrize(
    ("motion", "hint"),
    [
        ("theta: 0, r: L", "with r = m*g/k + L it does"),  # k (r - L) = m g
        ("theta: pi, r: L", "with r = L - m*g/k it does"),
        ("theta: 0", "with r = m*g/k + L it does"),
        ("theta: pi/2, r: L", ""),  # no length of the spring holds it there
        ("theta: 1, r: L", ""),
    ],
)
def test_a_motion_that_cannot_be_is_told_with_one_beside_it_that_is(motion: str, hint: str) -> None:
    analysis = mbsym.loads(f"{SPRING}motion: {{{motion}}}\n")
    failure = analysis.stage(5).failure
    assert failure is not None
    assert failure.hint.replace("$", "") == hint
    # Why is told by the first problem that has no result, and only there.
    both, last = results(analysis, (5, 6)), results(analysis, (6,))
    reason = str(failure.reason)
    assert [reason in str([*known.missing(k)]) for known, k in ((both, 5), (both, 6), (last, 6))] == [True, False, True]


def test_formulas_in_reasons_are_set_as_formulas() -> None:
    """-c*v is Python's; a report multiplies without a sign, and a reason that crosses processes keeps its English."""
    analysis = mbsym.loads(DRAGGED)
    assert "$-c v = 0$" in " ".join(TARGETS["latex"].render(analysis, (4, 5)).split())
    assert "-c*v" not in TARGETS["html"].render(analysis, (4, 5))
    with pytest.raises(Failure) as caught:
        analysis.stabilisation  # noqa: B018
    again = pickle.loads(pickle.dumps(caught.value.reason))
    assert again == caught.value.reason
    reason = Reason(Because.POLE, (analysis.equilibrium.conditions[0],))
    assert pickle.loads(pickle.dumps(reason)).data == ("-c*v",)
    assert hash(reason) == hash(pickle.loads(pickle.dumps(reason)))


FREE = """
mbsym: 1
name: free
parameters: {m: positive, k: positive}
bodies:
  - {name: p, mass: m, connection point: [x, 0, 0], coordinates: [x]}
  - {name: q, attached to: p, mass: m, connection point: [z, 0, 0], coordinates: [z]}
loads:
  - potential: k*z**2/2
motion: {x: {value: 0, rate: 1}}
values: {m: 1, k: 1}
"""
HOOP = """
mbsym: 1
name: hoop
parameters: {l: positive, g: positive, w: positive}
prescribed: {psi: w}
bodies:
  - {name: hoop, rotation: {axes: [3], angles: [psi]}, mass: 0}
  - {name: bead, attached to: hoop, connection point: [l*sin(th), 0, -l*cos(th)], mass: 1, coordinates: [th]}
loads:
  - uniform gravity: {vector: [0, 0, -g]}
motion: {th: 0}
"""


@pytest.mark.parametrize(
    ("text", "command", "told", "untold"),
    [
        (FREE, "equilibria", "x moves at the rate 1", "turns"),  # a length
        (HOOP, "average", "psi occurs in no equation of motion", "moves nothing"),  # the hoop turns with it
    ],
)
def test_what_moves_is_said_to_move(tmp_path: Path, text: str, command: str, told: str, untold: str) -> None:
    (tmp_path / "file.yaml").write_text(text, encoding="utf-8")
    result = invoked(command, tmp_path / "file.yaml")
    assert told in result.output + result.stderr
    assert untold not in result.output + result.stderr


@pytest.mark.parametrize(
    ("command", "reason"),
    [
        (["map", "--x", "l=1:2"], "no map: the first approximation is time-dependent"),
        (["nonlinear", "--vary", "l=1:2"], "no values listed: the first approximation is time-dependent"),
        (["sweep", "--vary", "l=1:2:3"], "for these equations: the first approximation is time-dependent"),
    ],
)
def test_no_name_of_a_stage_stands_before_a_reason(tmp_path: Path, command: list[str], reason: str) -> None:
    """ "judgeable: the first approximation ..." was told of a shaken pendulum."""
    name, *options = command
    out = [] if name == "nonlinear" else ["--out", str(tmp_path)]
    done = invoked(name, SYSTEMS / "shaken-pendulum.yaml", *options, *out)
    assert reason in " ".join(done.output.split())


def test_a_pendulum_is_not_called_free_of_applied_forces(tmp_path: Path) -> None:
    """Gravity is an applied force: "of systems without applied forces ... this one has 1" was told of a pendulum."""
    path = filed(
        tmp_path / "pendulum.yaml",
        """
mbsym: 1
name: Pendulum
parameters: {l: positive, g: positive}
bodies: [{name: bob, attached to: 0, rotation: {axes: [3], angles: [x]}, mass centre: [0, -l, 0], mass: 1}]
loads: [uniform gravity: {acceleration: g, direction: [0, -1, 0]}]
motion: {x: 0}
values: {l: 1, g: 9}
""",
    )
    done = invoked("nonlinear", path, "--vary", "l=1:2")
    assert "no values listed: of systems whose energy is conserved" in " ".join(done.output.split())


FALLING = """
mbsym: 1
name: falling
parameters: {m: positive, c: positive, g: positive}
bodies:
  - {name: p, mass: m, connection point: [0, 0, z], coordinates: [z]}
loads:
  - uniform gravity: {vector: [0, 0, -g]}
  - damper: {coordinate: z, coefficient: c}
motion: {z: {value: 0, rate: -m*g/c}}
values: {m: 1, c: 2, g: 3}
"""


def test_what_stops_again_does_not_drift_away() -> None:
    """m z'' + c z' = -m g: the disturbance of z' dies out like exp(-c t/m), and z ends m/c times that elsewhere.  On
    the shaft with the dragging wheel A a' + B (a' + b') is constant: disturbed, a' stays different, and a drifts."""
    falling, wheel = mbsym.loads(FALLING).stability, mbsym.loads(WHEEL).stability
    for verdict in (falling.verdict, falling.numerical):
        assert verdict is not None
        assert verdict.because(Because.ELSEWHERE)
        assert not verdict.because(Because.DRIFT)
    assert wheel.verdict.because(Because.DRIFT_AT_GIVEN_MOMENTA)
    assert not wheel.verdict.because(Because.ELSEWHERE)
    beside = mbsym.loads(
        FALLING.replace(
            "loads:", "  - {name: q, attached to: 0, mass: m, connection point: [x, 0, 0], coordinates: [x]}\nloads:"
        )
    ).stability.verdict
    assert beside.because(Because.DRIFT_AT_GIVEN_MOMENTA)  # of x
    assert not beside.because(Because.ELSEWHERE)


JORDAN = """
mbsym: 1
name: Jordan
parameters: {e: real, b: real}
linear system:
  coordinates: [u, v, q]
  A: [[0, e, 0], [0, 0, 0], [0, 0, b]]
values: {e: 0, b: -1}
claims:
  - {claim: condition, that: b <= 0, as: necessary}
  - {claim: condition, that: e != 0, as: necessary}
"""


def test_matrices_of_first_order_are_no_constraints_and_have_no_stiffness() -> None:
    """x' = A x: unstable where e != 0 or b > 0, else stable, e = 0 included: that this is a border does not mean that
    the equations, which are all there is, say nothing there; and e != 0, which is not necessary, is 'any condition'."""
    found = mbsym.loads(JORDAN)
    first, second = found.stability.subsystems
    assert first.theory.kind == second.theory.kind == "of first order"
    assert [case.all_of[0].label for case in first.theory.cases] == ["minor of order 1 of A"]
    assert "the first approximation says nothing" not in found.stability.verdict.explanation
    assert not any("any condition would be necessary, and it" in one.remark for one in found.claims)


def test_the_motion_is_that_of_all_coordinates() -> None:
    (display,) = [
        block for block in equilibrium.content(results(mbsym.loads(FREE), (4,))) if isinstance(block, Display)
    ]
    assert [line.text for line in Writer().block(display)] == ["  x = t, z = 0"]


PUMPED = """
mbsym: 1
name: pumped
parameters: {m: positive, k: positive}
inputs: {u: {meaning: force}}
bodies:
  - {name: p, mass: m, connection point: [x, 0, 0], coordinates: [x]}
loads:
  - generalized force: {x: LOAD}
motion: {}
claims:
  - {claim: first integral, equals: m*x_dot**2 + k*x**2}
"""


def test_a_verdict_on_inputs_at_their_values_is_not_one_at_all_constant_values() -> None:
    """m x'' = -k u x is stable for constant u > 0 and unstable for u < 0: what is said is said at u = 0."""
    told = "".join(map(str, results(mbsym.loads(PUMPED.replace("LOAD", "-k*u*x")), (4, 6)).presumed))
    assert "at constant values" not in told
    assert "keep their values on the unperturbed motion" in told


def test_the_state_that_refutes_an_integral_names_the_input() -> None:
    """d/dt (m x'^2 + k x^2) = 2 x' u."""
    (claim,) = mbsym.loads(PUMPED.replace("LOAD", "u - k*x")).claims
    assert claim.counterexample is not None
    at = {name: Fraction(value) for name, value in claim.counterexample.at}
    assert 2 * at["x_dot"] * at["u"] == Fraction(dict(claim.counterexample.shows)["dI/dt"])


def test_what_refutes_a_condition_is_set_as_mathematics() -> None:
    """A spring of k - 2 c is stable without k - 3 c > 0: at 2 c < k < 3 c the difference is negative, and a formula."""
    text = PUMPED.replace("LOAD", "-(k - 2*c)*x").replace("k: positive}", "k: positive, c: positive}")
    text = text.partition("claims:")[0] + 'claims:\n  - {claim: condition, that: "k - 3*c > 0"}\n'
    analysis = mbsym.loads(text)
    (claim,) = analysis.claims
    assert claim.counterexample is not None
    at = {name: Fraction(value) for name, value in claim.counterexample.at}
    assert 2 * at["c"] < at["k"] <= 3 * at["c"]
    assert "$k - 3 c = " in TARGETS["latex"].render(analysis, (6,))


TWO = """
mbsym: 1
name: two
parameters: {c: positive, k: positive, B: real}
bodies:
  - {name: p, mass: 1, connection point: [x, y, 0], coordinates: [x, y]}
loads:
  - LOAD
motion: {}
"""


def headings_of(text: str) -> list[str]:
    blocks = stability.content(results(mbsym.loads(text), (6,)))
    return [Writer().inline(Phrase(x.parts)) for x in blocks if isinstance(x, Subheading)]


def test_what_loses_energy_by_terms_of_higher_order_is_not_called_conservative() -> None:
    """x'' + c x'^3 + k x = 0 loses energy at the rate c x'^4."""
    oscillators = TWO.replace("LOAD", "potential: k*(x**2 + y**2)/2")
    assert all("(conservative)" in x for x in headings_of(oscillators))
    given = "mbsym: 1\nname: given\nparameters: {g: real}\nlinear system: {coordinates: [x, y], G: [[0, g], [-g, 0]]}\n"
    assert headings_of(given) == ["x, y (gyroscopic conservative)"]  # there are no other terms
    lossy = oscillators.replace("motion", "  - rayleigh: c*x_dot**4/4\nmotion")
    assert all("in first approximation conservative" in x for x in headings_of(lossy))


def test_where_everything_is_cyclic_there_is_no_stiffness_to_be_positive() -> None:
    """x'' = B y', y'' = -B x': K = 0, and x'^2 + y'^2 is constant."""
    found = mbsym.loads(TWO.replace("LOAD", "generalized force: {x: B*y_dot, y: -B*x_dot}"))
    assert "K > 0" not in found.stability.verdict.explanation
    assert "the kinetic energy of a disturbance does not grow" in found.stability.verdict.explanation
    told = [
        Writer().inline(note)
        for block in stability.content(results(found, (6,)))
        if isinstance(block, Display)
        for note in block.notes
    ]
    assert not any("leaves the rest open" in note for note in told)  # B = 0 is covered, too


DRAGGED_PAIR = """
mbsym: 1
name: pair
parameters: {m: positive, k: positive, c: nonnegative}
bodies:
  - {name: a, mass: m, connection point: [x, 0, 0], coordinates: [x]}
  - {name: b, attached to: 0, mass: m, connection point: [y, 0, 0], coordinates: [y]}
loads:
  - potential: k*(x - y)**2/2
  - damper: {coordinate: x, coefficient: c}
motion: {}
claims:
  - {claim: condition, that: c > 0, as: necessary}
"""


def test_with_a_zero_root_nothing_is_necessary_for_all_roots_to_the_left() -> None:
    """m^2 l^4 + m c l^3 + 2 m k l^2 + k c l has a zero root whatever c is."""
    (claim,) = mbsym.loads(DRAGGED_PAIR).claims
    assert "exponential" not in claim.remark
    assert "for all roots but the zero ones to lie to the left" in claim.remark


def test_zero_roots_are_not_said_to_be_negative() -> None:
    """l^4 + B^2 l^2: in lambda^2 one root is zero; of x'' + k x = 0 none is."""
    field = mbsym.loads(TWO.replace("LOAD", "generalized force: {x: B*y_dot, y: -B*x_dot}")).stability.subsystems[0]
    assert "but the zero ones" in field.theory.wanted
    free = mbsym.loads(TWO.replace("LOAD", "potential: k*(x**2 + y**2)/2")).stability.subsystems[0]
    assert "zero" not in free.theory.wanted


def test_a_heavy_top_that_is_judged_in_other_angles_is_conservative() -> None:
    """Of A = B the first approximation is steady in these angles, of A != B in others, where it is judged: the energy
    is constant in both."""
    top = """
mbsym: 1
name: top
parameters: {A: positive, B: positive, C: positive, P: positive, n: positive}
bodies:
  - {name: top, mass: 0, rotation: {axes: [1, 2, 3], angles: [a, b, c]}, inertia about: joint, inertia: [A, B, C]}
loads:
  - potential: P*cos(a)*cos(b)
motion: {c: {value: 0, rate: n}}
"""
    for text in (top, top.replace("[A, B, C]", "[A, A, C]")):
        assert not any("in first approximation" in heading for heading in headings_of(text))


def test_a_root_that_is_counted_is_not_said_again() -> None:
    """Of one root it was said that it is there, and how many there are, at the satellite's values."""
    verdict = mbsym.load(SHIPPED / "satellite.yaml").stability.numerical
    assert verdict is not None
    assert verdict.explanation.count("positive real part") == 1
