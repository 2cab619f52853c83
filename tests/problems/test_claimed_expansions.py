"""Claims about expansions in a small parameter: textbooks, derivations by hand, wrong coefficients, other symbols."""

from __future__ import annotations

import pytest
from conftest import SHIPPED

import mbsym
from mbsym.problems.claims import Outcome
from mbsym.source import to_text, to_yaml

OSCILLATOR = """mbsym: 1
name: An oscillator
parameters: {{m: positive, w: positive, k: real, eps: positive, c: positive}}
{relations}
small parameter: eps
bodies:
  - {{name: mass, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}}
loads:
{loads}
abbreviations: {{a: amplitude, three: 3*phase, unit: m}}
claims:
{claims}
"""
DUFFING = ("potential: m*w**2*x**2/2 + eps*m*k*x**4/4",)


def judged(claims, loads=DUFFING, relations=""):
    text = OSCILLATOR.format(
        loads="".join(f"  - {one}\n" for one in loads),
        claims="".join(f"  - {{claim: {one}}}\n" for one in claims),
        relations=relations,
    )
    analysis = mbsym.loads(text)
    found = analysis.claims
    assert not analysis.defects
    return [one.outcome for one in found], found


def test_duffing_with_its_initial_displacement():
    """x_1 = k a^3 (cos 3T - cos T)/(32 w^2), w - 3 k a^2/(8 w) ...: A. Nayfeh, Perturbation Methods, with a = x(0);
    m cancels, and abbreviations stand for the amplitude and an angle."""
    outcomes, found = judged(
        (
            "oscillation, of: x, order: 0, equals: a*cos(phase)",
            "oscillation, of: x, order: 1, equals: unit*k*a**3*(cos(three) - cos(phase))/(32*m*w**2)",
            "oscillation frequency, order: 0, equals: w",
            "oscillation frequency, order: 1, equals: 3*k*a**2/(8*w)",
            "oscillation frequency, order: 2, equals: -21*k**2*a**4/(256*w**3)",
            "oscillation, of: x_dot, order: 0, equals: w*a*cos(phase + pi/2)",
            # x' = w_0 x_1' + w_1 x_0' by the phase, by hand
            "oscillation, of: x_dot, order: 1, equals: -k*a**3*(3*sin(three) - sin(phase))/(32*w) "
            "- 3*k*a**3*sin(phase)/(8*w)",
            # the energy m x'^2/2 + m w^2 x^2/2 at eps = 0
            "oscillation, of: m*x_dot**2/2 + m*w**2*x**2/2, order: 0, equals: m*w**2*a**2/2",
        )
    )
    assert outcomes == [Outcome.EXACT] * 8
    assert found[0].title == "oscillation of x, order 0"
    assert found[2].title == "oscillation frequency, order 0"


def test_wrong_coefficients_are_refuted():
    """No choice of amplitude or phase makes them right: cos 3T in x_1, the frequency of first order, a factor."""
    outcomes, found = judged(
        (
            "oscillation, of: x, order: 1, equals: k*a**3*(cos(three) - cos(phase))/(31*w**2)",
            "oscillation, of: x, order: 1, equals: k*a**3*(cos(three)/31 - cos(phase)/32)/w**2",
            "oscillation frequency, order: 1, equals: 3*k*a**2/(7*w)",
            "oscillation frequency, order: 1, equals: 3*k*a**2/(8*w) + w",
            "oscillation, of: x, order: 0, equals: 2*a*cos(phase)",
            "oscillation, of: x, order: 1, equals: k*a**3*(cos(2*phase) - cos(phase))/(32*w**2)",
            "oscillation frequency, order: 0, equals: c",
        )
    )
    assert outcomes == [
        Outcome.SCALED,
        Outcome.DIFFERS,
        Outcome.SCALED,
        Outcome.DIFFERS,
        Outcome.SCALED,
        Outcome.DIFFERS,
        Outcome.DIFFERS,
    ]
    assert str(found[0].factor) == "32/31"
    assert found[1].remark == "in what stands before cos(3*phase)"
    assert str(found[3].difference) == "w"


def test_another_amplitude_or_phase_is_no_error():
    """Nayfeh's own: a the amplitude of the first harmonic, x_1 = k a^3 cos(3T)/(32 w^2), -15/256 in the second order;
    sines for cosines; any beginning of T."""
    outcomes, found = judged(
        (
            "oscillation, of: x, order: 1, equals: k*a**3*cos(three)/(32*w**2)",
            "oscillation frequency, order: 2, equals: -15*k**2*a**4/(256*w**3)",
            "oscillation, of: x, order: 0, equals: a*sin(phase)",
            "oscillation, of: x, order: 0, equals: a*(3*cos(phase) + 4*sin(phase))/5",
            "oscillation, of: x, order: 1, equals: -k*a**3*sin(three)/(32*w**2)",
        )
    )
    assert outcomes == [Outcome.UNDECIDED] * 5
    assert all("another amplitude" in one.remark for one in found)


def test_an_amplitude_that_is_determined():
    """Van der Pol: x_0 = 2 cos T, x_1 = -sin(3T)/4 with the phase of x, omega = 1 - eps^2/16."""
    loads = ("potential: m*x**2/2", "generalized force: {x: eps*m*(1 - x**2)*x_dot}")
    outcomes, _ = judged(
        (
            "oscillation, of: x, order: 0, equals: 2*cos(phase)",
            "oscillation, of: x, order: 0, equals: a*cos(phase)",
            "oscillation, of: x, order: 1, equals: -sin(three)/4",
            "oscillation, of: x, order: 1, equals: -sin(three)/3",
            "oscillation frequency, order: 2, equals: -1/16",
            "oscillation frequency, order: 2, equals: -1/15",
        ),
        loads,
    )
    assert outcomes == [
        Outcome.EXACT,
        Outcome.EXACT,
        Outcome.EXACT,
        Outcome.SCALED,
        Outcome.EXACT,
        Outcome.SCALED,
    ]


def test_relations_between_parameters_are_used():
    outcomes, _ = judged(
        ("oscillation frequency, order: 1, equals: 3*c*a**2/8", "oscillation frequency, order: 1, equals: c*a**2/8"),
        relations="relations: {k: c*w}",
    )
    assert outcomes == [Outcome.EXACT, Outcome.SCALED]


@pytest.mark.parametrize(
    ("claim", "reason"),
    [
        ("oscillation, of: 1/x, order: 0, equals: a", "changes with the phase"),
        ("oscillation, of: x, order: 0, equals: a*cos(k*phase)", "no multiple of the phase"),
        ("oscillation, of: x, order: 0, equals: a*exp(k)", "exp in the coefficient"),
        ("oscillation, of: x, order: 0, equals: phase*a", "outside of sin and cos"),
        ("oscillation, of: x, order: 0, equals: a/cos(phase)", "division by what changes with the phase"),
        ("oscillation, of: x, order: 0, equals: a/((w + k)**2 - w**2 - 2*w*k - k**2)", "divides by zero"),
        ("oscillation, of: x, order: 0, equals: x_0*cos(phase)", "no constant of the solution"),
        ("oscillation, of: x, order: 0, equals: a*cos(61*phase)", "harmonic beyond"),
        ("oscillation, of: x, order: 0, equals: (a*cos(phase))**25", "no whole or half number"),
    ],
)
def test_what_cannot_be_compared_is_undecided(claim, reason):
    (outcome,), (found,) = judged((claim,))
    assert outcome == Outcome.UNDECIDED
    assert reason in found.remark


def test_roots_are_told_from_zero_or_not_at_all():
    """sqrt(2) sqrt(3) - sqrt(6) is 0 with one choice of the roots only."""
    outcomes, found = judged(
        (
            "oscillation frequency, order: 0, equals: w + sqrt(2)*sqrt(3) - sqrt(6)",
            "oscillation frequency, order: 0, equals: w + sqrt(2)",
        )
    )
    assert outcomes == [Outcome.UNDECIDED, Outcome.DIFFERS]
    assert "square roots" in found[0].remark


def test_without_a_periodic_solution_nothing_is_judged():
    loads = (*DUFFING, "generalized force: {x: -c*x_dot}")
    (outcome,), (found,) = judged(("oscillation, of: x, order: 0, equals: a*cos(phase)",), loads)
    assert outcome == Outcome.UNDECIDED
    assert "no pair of imaginary roots" in found.remark


LIGHT = """
mbsym: 1
name: A light body on a heavy one
parameters: {m: positive, M: positive, c: positive, k: positive, a: positive, b: positive}
relations: {k: b*c}
small parameter: m
bodies:
  - {name: heavy, attached to: 0, coordinates: [y], connection point: [y, 0, 0], mass: M, speeds: {v: y_dot}}
  - {name: light, attached to: 0, coordinates: [x], connection point: [x, 0, 0], mass: m, speeds: {u: x_dot}}
loads:
  - force function: -k*(x - y)**2/2 - a*y**2/2
  - damper: {coordinate: x, coefficient: c}
motion: {x: 0, y: 0}
claims:
"""


def test_slow_manifolds():
    """m u' = -c u - k (x - y): u_0 = -(k/c)(x - y), u_1 = -u_0'/c = (k/c^2)(u_0 - v); x' = u."""
    right = (
        "of: u, order: 0, equals: -k*(x - y)/c",
        "of: u, order: 0, equals: b*(y - x)",
        "of: u, order: 1, equals: -k**2*(x - y)/c**3 - k*v/c**2",
        "of: x, order: 1, equals: -k**2*(x - y)/c**3 - k*v/c**2",
        "of: v, order: 0, equals: -(a*y + k*(y - x))/M",
    )
    wrong = ("of: u, order: 1, equals: -k**2*(x - y)/c**3 + k*v/c**2", "of: u, order: 2, equals: 0")
    text = LIGHT + "".join(f"  - {{claim: slow manifold, {one}}}\n" for one in (*right, *wrong))
    assert [one.outcome for one in mbsym.loads(text).claims] == [Outcome.EXACT] * 5 + [Outcome.DIFFERS] * 2


def test_written_and_read_again():
    text = LIGHT + "  - {claim: slow manifold, of: u, order: 0, equals: b*(y - x)}\n"
    system = mbsym.loads(text).system
    assert mbsym.loads(to_yaml(system)).system == system == mbsym.loads(to_text(system)).system
    assert system.claims[0].order == 0
    text = OSCILLATOR.format(
        relations="",
        loads="  - potential: m*w**2*x**2/2\n",
        claims="  - {claim: oscillation, of: x**2, order: 3, equals: a*cos(three), place: eq. (1)}\n",
    ).replace("m*w**2*x**2/2", "m*w**2*x**2/2 + eps*k*x**4")
    system = mbsym.loads(text).system
    assert mbsym.loads(to_yaml(system)).system == system == mbsym.loads(to_text(system)).system


THREE_BODIES = (SHIPPED / "three-bodies.yaml").read_text(encoding="utf-8")


def of_three_bodies(*formulas):
    claims = "".join(f"  - {{claim: normal form determinant, equals: {one}}}\n" for one in formulas)
    analysis = mbsym.loads(THREE_BODIES + claims)
    found = analysis.claims[1:]
    assert not analysis.defects
    return found


def test_deprits_determinant():
    """D_4 vanishes where 644 w^2 - 541 w + 36 does, w = w1^2 w2^2 = 27 mu (1 - mu)/4; 1 - 4 w and 4 - 25 w do not.

    A. Deprit & A. Deprit-Bartholome (1967).  In other polynomials mu_c is another one, of which two points tell; what
    vanishes where there are no two frequencies, as 1 - 4 mu, is no error.
    """
    w = "(27*mu*(1 - mu)/4)"
    right = (f"(644*{w}**2 - 541*{w} + 36)/((1 - 4*{w})*(4 - 25*{w}))", f"644*{w}**2 - 541*{w} + 36")
    wrong = (f"645*{w}**2 - 541*{w} + 36", f"644*{w}**2 - 542*{w} + 36", "1", "0")
    other = (f"(644*{w}**2 - 541*{w} + 36)*(1 + mu)", f"(644*{w}**2 - 541*{w} + 36)*(1 - 4*mu)")
    found = of_three_bodies(*right, *wrong, *other)
    assert [one.outcome for one in found] == [Outcome.FACTOR] * 2 + [Outcome.DIFFERS] * 4 + [Outcome.UNDECIDED] * 2
    assert str(found[0].factor) == "16*a**2*m/n**2"
    assert "mu = 1/100" in found[2].remark
    assert "normalisation" in found[6].remark


ONE_PAIR = """mbsym: 1
name: One pair of imaginary roots
parameters: {w: positive, b: real}
bodies:
  - {name: mass, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - potential: w**2*x**2/2
  - generalized force: {x: -x_dot**3}
motion: {x: 0}
claims:
"""


def test_the_first_lyapunov_coefficient():
    """x'' + x'^3 + w^2 x = 0: a = -3 w^2/8 (J. Guckenheimer & P. Holmes, (3.4.11)).  Its sign is what counts."""
    formulas = {
        "-3*w**2/8": Outcome.EXACT,
        "-3*w**2": Outcome.FACTOR,
        "-1": Outcome.FACTOR,
        "3*w**2/8": Outcome.DIFFERS,
        "w**2 - 2": Outcome.DIFFERS,
        "-b": Outcome.DIFFERS,
        "-(1 + b**2)": Outcome.UNDECIDED,
        "-w**2 - w": Outcome.UNDECIDED,
    }
    claims = "".join(f"  - {{claim: lyapunov coefficient, equals: {one}}}\n" for one in formulas)
    analysis = mbsym.loads(ONE_PAIR + claims + "  - {claim: normal form determinant, equals: 1}\n")
    found = analysis.claims
    assert not analysis.defects
    assert [one.outcome for one in found] == [*formulas.values(), Outcome.UNDECIDED]
    assert "opposite" in found[3].remark
    assert "another case" in found[8].remark


def test_a_root_of_a_square_is_not_what_was_squared():
    """sqrt(k^2) is |k|, and the frequency grows with k, whatever its sign."""
    outcomes, _ = judged(
        (
            "oscillation frequency, order: 1, equals: 3*sqrt(k**2)*a**2/(8*w)",
            "oscillation frequency, order: 1, equals: 3*sqrt(k**2*c)*a**2/(8*w*sqrt(c))",
            "oscillation frequency, order: 1, equals: 3*k*sqrt(c**2)*a**2/(8*w*c)",
            "oscillation frequency, order: 1, equals: 3*k*sqrt(w**2*c)*a**2/(8*w**2*c**(1/2))",
        )
    )
    assert outcomes == [Outcome.UNDECIDED, Outcome.UNDECIDED, Outcome.EXACT, Outcome.EXACT]


FALL = """mbsym: 1
name: a light ball
parameters: {{m: positive, c: positive, g: positive, h: positive, eps: positive}}
bodies: [{{name: ball, attached to: 0, connection point: [0, 0, -z], mass: eps*m, coordinates: [z]{speeds}}}]
loads: [{{generalized force: {{z: m*g - c*(1 + z/h)*{rate}**2}}}}]
small parameter: eps
claims:
{claims}
"""


@pytest.mark.parametrize(
    ("of", "speeds", "rate"), [("z", "", "z_dot"), ("v", ", speeds: {v: z_dot}", "v")], ids=["coordinates", "speeds"]
)
def test_a_slow_manifold_with_a_square_root_is_compared(of, speeds, rate):
    """v0 = sqrt(m g/(c d)), v1 = m^2 g/(4 c^2 h d^3 v0), d = 1 + z/h, by hand; the rate of z without speeds."""
    formulas = (
        (0, "sqrt(m*g/(c*(1 + z/h)))"),
        (0, "sqrt(m*g*h/(c*(h + z)))"),
        (0, "-sqrt(m*g/(c*(1 + z/h)))"),
        (1, "m**2*g/(4*c**2*h*(1 + z/h)**3*sqrt(m*g/(c*(1 + z/h))))"),
        (1, "m**2*g/(4*c**2*h*(1 + z/h)**2*sqrt(m*g/(c*(1 + z/h))))"),
    )
    claims = "".join(f"  - {{claim: slow manifold, of: {of}, order: {n}, equals: {x}}}\n" for n, x in formulas)
    analysis = mbsym.loads(FALL.format(speeds=speeds, rate=rate, claims=claims))
    outcomes = [one.outcome for one in analysis.claims]
    assert not analysis.defects
    holds = (Outcome.EXACT, Outcome.NUMERICAL)
    assert [x in holds for x in outcomes] == [True, True, False, True, False]
    assert outcomes[2] == outcomes[4] == Outcome.DIFFERS
