"""Hostile descriptions: whatever a reader accepts ends in results or in a reason, within bounds, never in a crash.

Every case is derived, checked and written in all formats by a process of its own, with a limit on its memory and on
its time.  The limits are far above what is needed; they only turn a hang into a failure.
"""

from __future__ import annotations

import json
from fractions import Fraction

import pytest
import warm
from flint import fmpz

import mbsym
from mbsym.algebra.base import Lowering
from mbsym.algebra.failures import NoClosedForm, NotRational
from mbsym.algebra.point import Rationals
from mbsym.algebra.program import Program
from mbsym.algebra.ring import MOST_MULTIPLE, Ring
from mbsym.expressions.angles import LinearForm
from mbsym.expressions.tree import Derivation, Name, add, differentiate, divide, multiply, number

SECONDS, BYTES = 40, 4_000_000_000

#: Derives everything of the description on standard input and tells why there is no result, where there is none.
SCRIPT = """
import json, sys
from mbsym import loads
from mbsym.analysis import Analysis, Unavailable
from mbsym.report.targets import TARGETS
analysis = Analysis(loads(sys.stdin.read()).system, terms=int(sys.argv[1]))
told = {}
for n in range(1, 8):
    failure = analysis.stage(n).failure
    told[str(n)] = failure and failure.reason
try:
    told["failed"] = [check.name for check in analysis.checks if check.failed]
except Unavailable as missing:
    told["checks"] = str(missing)
for target in TARGETS.values():
    target.render(analysis, analysis.problems)
print(json.dumps(told))
"""


def derived(description: str, terms: int = 60_000) -> dict[str, str | None]:
    """The reasons for missing results, by problem number."""
    done = warm.run([terms], code=SCRIPT, given=description, timeout=SECONDS, memory=BYTES)
    assert done.returncode == 0, done.stderr[-2000:]
    told: dict[str, str | None] = json.loads(done.stdout)
    return told


# --- descriptions -----------------------------------------------------------------------------------------------------


def pendulum(
    angle: str = "theta", load: str = "", motion: str = "0", names: str = "", mass: str = "m", more: str = ""
) -> str:
    """A body that turns about a fixed axis; ``names`` are further positive parameters."""
    extra = "".join(f", {name}: positive" for name in names.split())
    return f"""mbsym: 1
name: hostile
parameters: {{m: positive, l: positive, g: positive, J: positive, k: real{extra}}}
bodies:
  - name: rod
    attached to: 0
    rotation: {{axes: [3], angles: ["{angle}"]}}
    mass centre: [0, -l, 0]
    mass: {mass}
    inertia about: mass centre
    inertia: [J, J, J]
    coordinates: [theta]
loads:
  - uniform gravity: {{vector: [0, -g, 0]}}
{f"  - {load}" if load else ""}
motion: {{theta: {motion}}}
{more}
"""


def particle(potential: str, n: int = 1, motion: str = "0", mass: str = "m", more: str = "") -> str:
    """Point masses in n Cartesian coordinates x0, x1, ... with a potential."""
    bodies = []
    for j in range(0, n, 3):
        own = [f"x{i}" for i in range(j, min(j + 3, n))]
        point = ", ".join([*own, "0", "0"][:3])
        hung = f"b{j - 3}" if j else "0"
        bodies.append(
            f"  - {{name: b{j}, attached to: {hung}, connection point: [{point}], mass: {mass}, "
            f"coordinates: [{', '.join(own)}]}}"
        )
    motions = ", ".join(f"x{i}: {motion}" for i in range(n))
    return "\n".join(
        [
            "mbsym: 1\nname: hostile\nparameters: {m: positive, k: positive, g: positive}\nbodies:",
            *bodies,
            f'loads:\n  - potential: "{potential}"\nmotion: {{{motions}}}\n{more}\n',
        ]
    )


def total(n: int) -> str:
    return "(" + " + ".join(f"x{i}" for i in range(n)) + ")"


def nested(function: str, times: int) -> str:
    inner = "x0"
    for _ in range(times):
        inner = f"{function}(2 + {inner})"
    return inner


def point_of_one_joint(radius: str) -> str:
    """One body whose joint has six coordinates and a long formula for a component of its connection point."""
    return f"""mbsym: 1
name: joint
parameters: {{m: positive, J: positive}}
bodies:
  - name: hub
    attached to: 0
    rotation: {{axes: [1, 2, 3], angles: [a, b, c]}}
    connection point: ["{radius}", y, z]
    mass: m
    inertia about: mass centre
    inertia: [J, J, J]
    coordinates: [x, y, z, a, b, c]
motion: {{x: 0, y: 0, z: 0, a: 0, b: 0, c: 0}}
"""


def star(arms: int) -> str:
    """A free body with arms: its momenta are conserved, and no simple multiplier proves the angular one."""
    bodies = "".join(
        f"  - {{name: c{i}, attached to: hub, rotation: {{axes: [{i % 3 + 1}], angles: [q{i}]}}, "
        f"connection point: [0, l, {i}], mass: m, inertia about: mass centre, inertia: [J, J, J]}}\n"
        for i in range(arms)
    )
    return point_of_one_joint("x").replace("J: positive", "J: positive, l: positive").replace("motion:", bodies + "# ")


CHAIN = " ".join(f"a{i}" for i in range(61))
TALL = "sin(" * 45 + "x" + "".join(f"*y) + {'zabcx'[i % 5]}" for i in range(45))
WIDE = "/".join(f"({'xyzabc'[i % 6]} + {i + 1})" for i in range(70))
DIGITS = "9" * 60
WORDS = [
    "np",
    "E",
    "I",
    "pi1",
    "Sin",
    "N",
    "D",
    "C",
    "O",
    "S",
    "Pi",
    "Null",
    "math",
    "rhs",
    "forcing",
    "energy",
    "state",
    "qd",
    "p",
    "q",
    "x",
    "x0",
    "M",
    "f",
    "dict",
    "beta",
    "zeta",
    "Gamma",
    "w",
    "tau",
    "e",
    "i",
    "j",
    "inf",
    "nan",
    "omega_0",
    "omega0",
    "omega_00",
    "theta1",
    "theta_1",
    "theta_1_1",
    "theta11",
]

CASES = {
    # angles
    "a million times an angle": pendulum("1000000*theta"),
    "1e50 times an angle": pendulum("1e50*theta"),
    "1e-30 times an angle": pendulum("theta/1e30 + theta"),
    "parts of an angle": pendulum("theta/97 + theta/89"),
    "many parts": pendulum(load="potential: k*(" + " + ".join(f"cos(theta/{p})" for p in (2, 3, 5, 7, 11, 13)) + ")"),
    "a part of pi": pendulum("theta + pi/97"),
    "motion at pi/7": pendulum(motion="pi/7"),
    "motion at one radian": pendulum(motion="1"),
    "motion at sqrt(2) a": pendulum(motion="sqrt(2)*a", names="a"),
    "motion at 1000 a": pendulum(motion="1000*a", names="a"),
    "motion with a rate": pendulum(motion="{value: 0, rate: k}"),
    # chains of definitions
    "squares of squares": pendulum(
        names=CHAIN, mass="a0", more="relations: {" + ", ".join(f"a{i}: a{i + 1}*a{i + 1}" for i in range(60)) + "}"
    ),
    "sums of squares": pendulum(
        names=CHAIN, mass="a0", more="relations: {" + ", ".join(f"a{i}: a{i + 1}**2 + k" for i in range(60)) + "}"
    ),
    "notation of squares": pendulum(
        more="notation:\n  s0: k**2\n" + "\n".join(f"  s{i}: s{i - 1}**2" for i in range(1, 60))
    ),
    "notation of powers": pendulum(more="notation: {u: (m + k)**64, v: (u + k)**64, w: (v + k)**64}"),
    "powers of relations": pendulum(names="a b c", mass="a", more="relations: {a: (b + k)**60, b: (c + l)**60}"),
    "long notation": pendulum(more="notation:\n" + "\n".join(f"  s{i}: m*{i + 1} + {i}*k" for i in range(150))),
    "notation that divides": pendulum(more="notation: {u: m/k, v: k/u, w: u/v - 1/(u*v), z: 1/(u - m/k)}"),
    "relation makes a denominator zero": pendulum(
        load="potential: theta**2/(k - l)", more="relations: {k: l}\nvalues: {m: 1, l: 1, g: 1, J: 1}"
    ),
    "relation makes the mass zero": pendulum(names="a", mass="a", more="relations: {a: 0}"),
    # polynomials
    "a high power": particle(f"{total(6)}**60", 6),
    "a high power of few": particle(f"({total(3)} + k)**64", 3),
    "powers in many coordinates": particle(
        " + ".join("*".join(f"x{(i + j) % 6}**{i * j % 40 + 1}" for j in range(6)) for i in range(20)), 6
    ),
    "a negative power": particle(f"1/({total(6)} + k)**40", 6),
    "a long denominator": particle(f"1/({total(6)}**20 + x0**7 + k)", 6),
    "a long root": particle(f"sqrt({total(6)}**6 + x0**7 + k)", 6),
    "half powers": particle("(1 + x0 + x1)**(63/2)*(2 + x0**2)**(-61/2)", 2),
    "denominators in denominators": particle("1/(1 + x0 + 1/(1 + x1 + 1/(1 + x0**2 + 1/(x0 + x1 + 1/(2 + x1)))))", 2),
    "long numbers": particle(f"(({DIGITS}*x0 + 1)**40)**3"),
    "long mass": particle("x0**2", mass=f"m*({DIGITS}**40)**3"),
    "long and short numbers": particle("1e-60*x0**2 + 1e59*x0"),
    "long root of a number": particle(f"sqrt((10**50 + 151)*({DIGITS} + 88)*3)*x0**2"),
    "200 parameters": pendulum(
        names=" ".join(f"p{i}" for i in range(200)),
        load="potential: ("
        + " + ".join("(" + " + ".join(f"p{10 * i + j}" for j in range(10)) + ")" for i in range(20))
        + ")**6*theta**2",
    ),
    # functions
    "nested roots": particle(nested("sqrt", 12)),
    "nested exponentials": particle(nested("exp", 20)),
    "nested tangents": particle(nested("tan", 20)),
    "nested hyperbolic tangents": particle(nested("tanh", 40)),
    "many exponentials": particle(" + ".join(f"exp({i}*x0 + x1)" for i in range(1, 70)), 2),
    "many angles": particle(" + ".join(f"sin({i}*x0*x1 + x1)" for i in range(1, 70)), 2),
    "a third power": particle("(x0 + k)**(1/3)"),
    "far from the real line": particle("sqrt(x0 - 1000) + log(x0 - 1000) + x0**2", motion="2000"),
    "an exponential tower": particle("exp(exp(exp(5*x0))) + x0**2"),
    # singular points
    "logarithm of zero": particle("log(x0)"),
    "division by zero": particle("1/sin(x0)"),
    "root of zero": particle("sqrt(x0) + sqrt(x0**2)"),
    "tangent of a right angle": particle("tan(x0)", motion="pi/2"),
    "spring of no length": pendulum(
        load="spring: {between: [{body: rod, point: [0, 0, 0]}, {body: 0, point: [0, 0, 0]}], stiffness: k, length: l}"
    ),
    "gravity at its centre": pendulum(load="newtonian gravity: {constant: k, centre: 0, about: rod}"),
    # assumptions
    "long assumptions": pendulum(
        names="a b c", more="assumptions: ['(a + b + c + k + l + g)**40 > 1', '1/(k - l)**60 > 0']"
    ),
    "assumptions about functions": pendulum(
        more="assumptions: ['sin(k) > 0', 'sqrt(k) > 1', 'log(k) > 0', 'sin(1) > 0', 'sin(k*k) > 0']"
    ),
    # nothing
    "no mass": pendulum(mass="0").replace("inertia: [J, J, J]", "inertia: [0, 0, 0]"),
    "no inertia in a coordinate": particle("x0**2", 2, mass="0"),
    "time scale zero": pendulum(more='dimensionless time: "k - k"'),
    "time scale to a high power": pendulum(more="dimensionless time: (k + l + m + g)**30"),
    # size
    "a tall formula": point_of_one_joint(TALL),
    "a wide formula": point_of_one_joint(WIDE),
    "forty arms on a free body": star(40),
    "140 divisions": particle("/".join(["(x0 + 1)"] * 140)),
    # names
    "names that mean something elsewhere": pendulum(
        names=" ".join(WORDS),
        load="potential: " + " + ".join(WORDS),
        more="values: {m: 1, " + ", ".join(f"{word}: {i + 1}" for i, word in enumerate(WORDS)) + "}",
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_a_hostile_description_ends_in_results_or_reasons(name: str) -> None:
    told = derived(CASES[name])
    assert all(told[str(n)] != "" for n in range(1, 8))


@pytest.mark.parametrize("number", ["sqrt(-1)", "log(-1)", "sqrt(-x0**2 - 1)"])
def test_a_number_that_is_none_is_refused_at_its_place(number: str) -> None:
    with pytest.raises(mbsym.DescriptionError, match=r"7:17: error\[no-number\]"):
        mbsym.loads(particle(f"{number}*x0**2"))


@pytest.mark.parametrize("terms", [1, 50])
def test_a_small_budget_gives_reasons(terms: int) -> None:
    """Chains outgrow 50 terms at once; their first approximation need not."""
    bodies = "\n".join(
        f"  - {{name: c{i}, attached to: {f'c{i - 1}' if i else '0'}, "
        f"rotation: {{axes: [{i % 3 + 1}], angles: [q{i}]}}, "
        "mass centre: [0, l, 0], connection point: [0, l, 0], mass: m}"
        for i in range(6)
    )
    motion = ", ".join(f"q{i}: 0" for i in range(6))
    told = derived(
        f"mbsym: 1\nname: chain\nparameters: {{m: positive, l: positive}}\nbodies:\n{bodies}\nmotion: {{{motion}}}\n",
        terms,
    )
    assert f"budget of {terms}" in str(told["3"])


# --- the bounds themselves --------------------------------------------------------------------------------------------


def ring_of_three(terms: int = 60_000) -> Ring:
    return Ring(["x", "y", "z"], [], ["a"], {"x": 1}, spare=4, terms=terms)


def test_multiples_of_an_angle_are_bounded() -> None:
    ring = ring_of_three()
    sine, cosine = ring.sin_cos(LinearForm((("x", MOST_MULTIPLE),)))
    assert ring.reduce(sine**2 + cosine**2) == ring.one
    for n in (MOST_MULTIPLE + 1, 10**60):
        with pytest.raises(NoClosedForm, match="times an angle"):
            ring.sin_cos(LinearForm((("x", n),)))
        with pytest.raises(NotRational):
            Rationals({"x": 1}, {"x": 1}).sin_cos(LinearForm((("x", n),)))


def test_products_are_refused_before_they_are_formed() -> None:
    ring = ring_of_three(10**9)
    x, y, z = (ring.generator("coordinate", name) for name in "xyz")
    long = (x + y + z + 1) ** 33
    with pytest.raises(NoClosedForm, match="a product of"):
        ring.times(long, long)


def test_substitutions_are_refused_before_they_are_made() -> None:
    ring = ring_of_three()
    x, y, z = (ring.generator("coordinate", name) for name in "xyz")
    index = ring.index("coordinate", "x")
    with pytest.raises(NoClosedForm, match="substitution"):
        ring.substitute(x**60, {index: (y + z + 1) ** 30})
    with pytest.raises(NoClosedForm, match="degree"):
        ring.substitute(x**60, {index: y**60})
    assert ring.substitute(x**6, {index: y + 1}) == (y + 1) ** 6


def test_powers_of_relations_are_reduced_step_by_step(monkeypatch: pytest.MonkeyPatch) -> None:
    """The way for long expansions gives the normal form of a division at one stroke."""
    ring = ring_of_three()
    x, y = ring.generator("coordinate", "x"), ring.generator("coordinate", "y")
    inverse = ring.reciprocal(x + y + 1)
    power = inverse**6 * x**6
    leading, relation = ring._relations[0]
    short = divmod(power, relation)[1]
    monkeypatch.setattr("mbsym.algebra.ring.SMALL", 0)
    assert ring._remainder(power, power.degrees(), leading, relation) == short


def test_long_integers_under_roots_are_not_factored() -> None:
    ring = ring_of_three()
    first, second = fmpz(2) ** 127 - 1, fmpz(2) ** 89 - 1
    with pytest.raises(NoClosedForm, match="cannot be factored"):
        ring.square_root(ring.number(int(first * second)))
    assert ring.square_root(ring.number(int(first * first))) == ring.number(int(first))


def test_work_is_counted() -> None:
    ring = ring_of_three()
    ring.work = ring.work_budget
    with pytest.raises(NoClosedForm, match="steps"):
        ring.reduce(ring.generator("coordinate", "x"))


def test_common_factors_and_quotients() -> None:
    ring = ring_of_three()
    x, y = ring.generator("coordinate", "x"), ring.generator("coordinate", "y")
    assert ring.common_factor(x * y, x**2) == x
    assert ring.common_factor(ring.zero, x) == x
    assert ring.quotient(x**2 - y**2, x - y) == x + y
    assert ring.quotient(x**2 - y, x - y) is None
    assert ring.quotient(ring.zero, x) == ring.zero


def test_programs_hold_numbers_that_floating_point_can_hold() -> None:
    program = Program()
    with pytest.raises(NoClosedForm, match="digits"):
        program.number(10**400)


def test_deep_expressions_are_lowered_without_recursion() -> None:
    expression = Name("x")
    for i in range(5_000):
        expression = add(multiply(expression, Name("a")), number(i))
    assert Lowering(Rationals({}, {}), {"x": 1, "a": 1})(expression) == 1 + sum(range(5_000))


def test_derivatives_of_shared_parts_are_the_derivatives() -> None:
    x = Name("x")
    expression = divide(multiply(add(x, number(1)), x), add(multiply(x, x), Name("y")))
    for name in ("x", "y", "u"):
        remembering = Derivation({name: number(1)})
        once = remembering(expression)
        assert remembering(expression) is once
        assert differentiate(expression, name) == once
        at = {"x": 3, "y": 5, "u": 7}  # d/dx x (x + 1)/(x^2 + y) = ((2 x + 1)(x^2 + y) - 2 x^2 (x + 1))/(x^2 + y)^2
        known = {"x": Fraction(7 * 14 - 2 * 9 * 4, 14**2), "y": Fraction(-12, 14**2), "u": Fraction(0)}
        value = Lowering(Rationals({}, {}), {key: Rationals({}, {}).number(x) for key, x in at.items()})(once)
        assert Fraction(int(value.p), int(value.q)) == known[name]


@pytest.mark.parametrize("assumptions", ["[k > 0, k < 0, m < 0]", "['0 > 1']"])
def test_assumptions_that_nothing_keeps_are_refused(assumptions: str) -> None:
    with pytest.raises(mbsym.DescriptionError, match="contradictory-assumptions"):
        mbsym.loads(pendulum(more=f"assumptions: {assumptions}"))
