"""Exactly linear equations are decided by linear theory whole, in all coordinates x = S y.

Truth: the Jordan structure, of which every system here is built.  A block of size 1 with Re lambda <= 0 is bounded, a
larger one on the imaginary axis grows like a power of t (Gantmacher, Theory of Matrices II, XIV.3).
"""

from __future__ import annotations

from fractions import Fraction
from random import Random

import pytest
from plain_vectors import inverse
from terminal import told

import mbsym
from mbsym.problems.stability.words import LINEAR, Because, Word
from mbsym.report.targets import TARGETS

# --- rational matrices, as lists of rows ---


def _times(a, b):
    return [
        [sum((x * y for x, y in zip(row, column, strict=True)), Fraction(0)) for column in zip(*b, strict=True)]
        for row in a
    ]


def _joined(blocks):
    n = sum(map(len, blocks))
    found, at = [[Fraction(0)] * n for _ in range(n)], 0
    for block in blocks:
        for i, row in enumerate(block):
            found[at + i][at : at + len(row)] = map(Fraction, row)
        at += len(block)
    return found


def _regular(source, n):
    """A product of a lower and an upper triangular matrix with units on their diagonals: det = 1."""
    lower = [[Fraction(source.randint(-2, 2)) if j < i else Fraction(int(i == j)) for j in range(n)] for i in range(n)]
    upper = [[Fraction(source.randint(-2, 2)) if j > i else Fraction(int(i == j)) for j in range(n)] for i in range(n)]
    return _times(lower, upper)


def _jordan(real, imaginary, size):
    """The real Jordan block of real +- i imaginary."""
    one = [[real, imaginary], [-imaginary, real]] if imaginary else [[real]]
    step = len(one)
    rows = _joined([one] * size)
    for i in range(len(rows) - step):
        rows[i][i + step] = Fraction(1)
    return rows


# --- x' = A x ---

TEXT = """
mbsym: 1
name: {name}
linear system:
  coordinates: {names}
  {matrices}
"""


def _given(**matrices):
    n = len(next(iter(matrices.values())))
    written = "\n  ".join(f"{key}: {[[str(x) for x in row] for row in rows]}" for key, rows in matrices.items())
    names = [f"x{i + 1}" for i in range(n)]
    return mbsym.loads(TEXT.format(name="known structure", names=names, matrices=written.replace("'", "")))


@pytest.mark.parametrize("seed", range(24))
def test_a_known_jordan_structure_is_what_the_verdict_says(seed):
    source = Random(seed)
    blocks, word = [], Word.ASYMPTOTIC
    while sum(map(len, blocks)) < 4:
        size = source.choice((1, 1, 2))
        real, imaginary = source.choice(((0, 0), (0, 1), (0, 1), (0, 2), (-1, 0), (-1, 2)))
        if source.random() < 0.1:
            real = 1
        blocks.append(_jordan(real, imaginary, size))
        if real > 0 or (real == 0 and size > 1):
            word = Word.UNSTABLE
        elif real == 0 and word is not Word.UNSTABLE:
            word = Word.STABLE
    A = _joined(blocks)
    S = _regular(source, len(A))
    for matrix in (A, _times(_times(inverse(S), A), S)):
        found = _given(A=matrix).stability
        assert found.numerical.word is word, (blocks, found.numerical)
        assert found.verdict.word is word, (blocks, found.verdict)  # without parameters both are the same
        told = found.numerical.explanation + found.verdict.explanation
        assert "higher order" not in told
        assert "nonlinear" not in told


# --- M x'' + C x' + S x = 0 of bodies, and by matrices ---

#: Independent parts C, S with M = 1, by hand.  Roots: lambda^2 = -4; (lambda + 1)^2; wc = 3, wz^2 = 4: lambda^4 + 5
#: lambda^2 + 4; wc^2 = 8 = 2 wz^2 scaled: with C = (0, -2; 2, 0), S = -1: (lambda^2 + 1)^2, one eigenvector each;
#: lambda^2 (lambda^2 + 9), two null vectors; lambda^2; lambda (lambda + 1); x'' + x = 0, y'' + y = x: resonance.
PARTS = {
    "oscillator": ([[0]], [[4]]),
    "damped": ([[2]], [[1]]),
    "trap": ([[0, -3], [3, 0]], [[-2, 0], [0, -2]]),
    "trap at its border": ([[0, -2], [2, 0]], [[-1, 0], [0, -1]]),
    "charge": ([[0, -3], [3, 0]], [[0, 0], [0, 0]]),
    "free": ([[0]], [[0]]),
    "braked": ([[1]], [[0]]),
    "resonance": ([[0, 0], [0, 0]], [[1, 0], [-1, 1]]),
    "inverted": ([[0]], [[-1]]),
}
GROWING = {"trap at its border", "resonance", "inverted"}
OSCILLATING = {"oscillator", "trap", "charge"}
DECAYING = {"damped", "braked"}
SHIFTED = {"free", "braked", "charge"}


def _word_of_bodies(kinds):
    """Of bodies a drift along what nothing depends on is told apart; by matrices x'' = 0 grows like t."""
    if kinds & GROWING:
        return Word.UNSTABLE
    if kinds & OSCILLATING:
        return Word.STABLE_BUT_CYCLIC if "free" in kinds else Word.STABLE
    if kinds & DECAYING:
        return Word.ASYMPTOTIC_BUT_CYCLIC if kinds & SHIFTED else Word.ASYMPTOTIC
    return Word.STABLE_BUT_CYCLIC


def _word_of_matrices(kinds):
    if kinds & GROWING or "free" in kinds:
        return Word.UNSTABLE
    return Word.ASYMPTOTIC if kinds == {"damped"} else Word.STABLE


def _bodies(C, S, T):
    """Unit masses on lines with deviations x = T y and forces -C x' - S x, described in y."""
    n = len(C)
    names, span = [f"y{i + 1}" for i in range(n)], range(n)

    def form(row, of):
        return " + ".join(f"({x})*{name}" for x, name in zip(row, of, strict=True) if x) or "0"

    lines = [
        f"  - {{name: p{i}, attached to: 0, mass: 1, connection point: ['{form(T[i], names)}', 0, 0], "
        f"coordinates: [{names[i]}]}}"
        for i in span
    ]
    transposed = [list(column) for column in zip(*T, strict=True)]
    rates, places = (_times(_times(transposed, [[-x for x in row] for row in m]), T) for m in (C, S))
    forces = [form([*rates[i], *places[i]], [*(f"{name}_dot" for name in names), *names]) for i in span]
    loads = ", ".join(f'{name}: "{force}"' for name, force in zip(names, forces, strict=True))
    return mbsym.loads(
        "mbsym: 1\nname: bodies\nbodies:\n"
        + "\n".join(lines)
        + f"\nloads:\n  - generalized force: {{{loads}}}\nmotion: {{}}\n"
    )


def _turned(source, n):
    """A regular matrix in whose rows the own coordinate occurs."""
    while True:
        T = _regular(source, n)
        if all(T[i][i] for i in range(n)):
            return T


def _choice(seed):
    source = Random(seed)
    kinds = source.sample(sorted(PARTS), source.choice((1, 2, 2)))
    C, S = (_joined([PARTS[kind][k] for kind in kinds]) for k in (0, 1))
    return source, set(kinds), C, S


@pytest.mark.parametrize("seed", range(40))
def test_the_verdict_on_bodies_is_the_same_in_all_linear_coordinates(seed):
    source, kinds, C, S = _choice(seed)
    n = len(C)
    unit = [[Fraction(int(i == j)) for j in range(n)] for i in range(n)]
    for T in (unit, _turned(source, n)):
        found = _bodies(C, S, T).stability
        assert found.numerical.word is _word_of_bodies(kinds), (kinds, T, found.numerical, found.numerical.explanation)
        assert found.verdict.word is _word_of_bodies(kinds), (kinds, T, found.verdict)
        assert "higher order" not in found.numerical.explanation + found.verdict.explanation


@pytest.mark.parametrize("seed", range(40))
def test_matrices_are_decided_by_linear_theory_whole(seed):
    source, kinds, C, S = _choice(seed)
    n = len(C)
    T = _regular(source, n)
    transposed = [list(column) for column in zip(*T, strict=True)]
    M = _times(transposed, T)
    C, S = (_times(_times(transposed, x), T) for x in (C, S))
    found = _given(M=M, C=C, S=S).stability
    assert found.numerical.word is _word_of_matrices(kinds), (kinds, found.numerical)
    assert found.verdict.word is _word_of_matrices(kinds), (kinds, found.verdict)


# --- public systems, with their borders ---

TRAP = """
mbsym: 1
name: Penning trap
parameters: {{wc: {{sign: positive, value: {wc}}}, wz: {{sign: positive, value: {wz}}}}}
bodies:
  - {{name: ion, mass: 1, connection point: [{point}], coordinates: [x, y, z]}}
loads:
  - potential: wz**2*(2*({Z})**2 - ({X})**2 - ({Y})**2)/4
  - generalized force: {{{forces}}}
motion: {{}}
"""

#: Positions X, Y, Z and the Lorentz forces wc (Y', -X', 0) on them, as generalised forces Q = (dX/dq)^T F.
PLAIN = {"X": "x", "Y": "y", "Z": "z", "forces": "x: wc*y_dot, y: -wc*x_dot"}
#: X = x + y, Y = y - z, Z = z + 2 x: Q_x = F_X, Q_y = F_X + F_Y, Q_z = -F_Y, F_X = wc (y' - z'), F_Y = -wc (x' + y').
SKEWED = {
    "X": "x + y",
    "Y": "y - z",
    "Z": "z + 2*x",
    "forces": "x: wc*(y_dot - z_dot), y: wc*(y_dot - z_dot) - wc*(x_dot + y_dot), z: wc*(x_dot + y_dot)",
}


def _trap(axes, wc=3, wz=2):
    return mbsym.loads(TRAP.format(wc=wc, wz=wz, point=f"{axes['X']}, {axes['Y']}, {axes['Z']}", **axes))


@pytest.mark.parametrize("axes", [PLAIN, SKEWED])
@pytest.mark.parametrize(
    ("wc", "wz", "word"),
    [
        # lambda^2 = -s in the plane: s^2 - (wc^2 - wz^2) s + wz^4/4 = 0, disc. wc^2 (wc^2 - 2 wz^2) (Brown & Gabrielse)
        ("3", "2", Word.STABLE),
        ("29/20", "1", Word.STABLE),
        # on the border, at irrational numbers: lambda^2 = -wz^2/2 twice, at lambda = i wz/sqrt(2) the rank of
        # lambda^2 + wc lambda J - wz^2/2 = -wz^2 + i wz^2 J is 1: a Jordan block, in the field of one root exactly
        ("sqrt(2)*2", "2", Word.UNSTABLE),
        ("4*cos(pi/4)", "2", Word.UNSTABLE),
        ("sqrt(6)", "sqrt(3)", Word.UNSTABLE),
        ("sqrt(2)*2 + 10**(-50)", "2", Word.STABLE),
        ("sqrt(2)*2 - 10**(-60)/10**60", "2", Word.UNSTABLE),  # closer than enclosures tell
        ("sqrt(2)*2 + 10**(-60)/10**60", "2", Word.STABLE),
        ("7/5", "1", Word.UNSTABLE),
    ],
)
def test_a_penning_trap_is_stable_within_its_limit(axes, wc, wz, word):
    found = _trap(axes, wc, wz).stability.numerical
    assert found.word is word, found
    assert not found.because(Because.HIGHER_ORDER)


@pytest.mark.parametrize("axes", [PLAIN, SKEWED])
def test_a_penning_trap_at_its_limit_grows_like_t(axes):
    """With wz^2 doubled the limit is wc^2 = 4 wz^2, wc = 2 wz: lambda^2 = -wz^2 twice.

    In the plane lambda^2 + 2 wz lambda J - wz^2 has rank 1 at lambda = i wz: one eigenvector, a Jordan block.
    """
    text = TRAP.format(wc=2, wz=1, point=f"{axes['X']}, {axes['Y']}, {axes['Z']}", **axes)
    text = text.replace("wz**2*(2*", "wz**2*2*(2*")  # wz^2 twice: the limit is wc = 2 wz
    found = mbsym.loads(text).stability.numerical
    assert found.word is Word.UNSTABLE, found
    assert found.because(Because.LINEAR_GROWS)
    above = mbsym.loads(text.replace("value: 2", "value: 2.001")).stability.numerical
    assert above.word is Word.STABLE, above


SADDLE = """
mbsym: 1
name: rotating potential
parameters: {{k1: {{sign: real, value: {k1}}}, k2: {{sign: real, value: {k2}}}, w: {{sign: positive, value: {w}}}}}
prescribed: {{chi: w}}
bodies:
  - {{name: f, attached to: 0, rotation: {{axes: [3], angles: [chi]}}, mass: 0}}
  - {{name: p, attached to: f, mass: 1, connection point: [x, y, 0], coordinates: [x, y]}}
loads:
  - potential: (k1*x**2 + k2*y**2)/2
motion: {{}}
"""


@pytest.mark.parametrize(
    ("k1", "k2", "w", "word"),
    [
        # x'' - 2 w y' + (k1 - w^2) x = 0, y'' + 2 w x' + (k2 - w^2) y = 0 (Thomson & Tait's rotating trough):
        # lambda^4 + (k1 + k2 + 2 w^2) lambda^2 + (k1 - w^2)(k2 - w^2), disc. (k1 - k2)^2 + 8 w^2 (k1 + k2)
        (1, -1, "2", Word.STABLE),  # a saddle: stable iff w^2 > k
        (1, -1, "1/2", Word.UNSTABLE),
        (1, -1, "1", Word.UNSTABLE),  # k1 = w^2: lambda^2 (lambda^2 + 2), K of rank 1: a Jordan block, grows like t
        (4, 1, "3/2", Word.UNSTABLE),  # between the two frequencies: (k1 - w^2)(k2 - w^2) < 0
        (4, 1, "3", Word.STABLE),
        (4, 1, "1", Word.UNSTABLE),  # at a critical speed: K of rank 1, a double zero root
        (4, 4, "2", Word.STABLE),  # Foucault's plane that turns at the frequency: K = 0, lambda^2 (lambda^2 + 16)
        (4, 4, "3", Word.STABLE),  # an oscillator seen from a turning frame: at every rate
        (-1, -1, "1", Word.UNSTABLE),  # 4 w^2 (k1 + k2) < 0: a repeller stays one
    ],
)
def test_a_rotating_potential_is_decided_everywhere(k1, k2, w, word):
    found = mbsym.loads(SADDLE.format(k1=k1, k2=k2, w=w)).stability.numerical
    assert found.word is word, (found, found.explanation)
    assert "higher order" not in found.explanation


def test_what_is_not_linear_in_all_orders_is_not_taken_for_it():
    """A cubic term, friction that jumps, a mass that depends on the position, a coefficient that depends on t."""
    for extra in ("x: -x**3", "x: -sign(x_dot)/100", "x: x*y_dot", "x: -cos(x) + 1"):
        found = mbsym.loads(TRAP.format(wc=3, wz=2, point="x, y, z", **{**PLAIN, "forces": f"{extra}, y: 0"}))
        stage = found.stage(6)
        assert stage.value is None or not found.balance.exactly_linear, extra
    curved = mbsym.loads(TRAP.format(wc=3, wz=2, point="x, y, z + x**2", **PLAIN))
    assert not curved.balance.exactly_linear
    gained = TRAP.replace("wz**2*(", "wz**2*a*x**4 + wz**2*(").replace("parameters: {{", "parameters: {{a: real, ")
    cubic = mbsym.loads(gained.format(wc=3, wz=2, point="x, y, z", **PLAIN) + "values: {a: 0}\n")
    assert not cubic.balance.exactly_linear
    assert cubic.stability.numerical.word is Word.STABLE  # where the coefficient is zero the equations are linear
    cubic = mbsym.loads(gained.format(wc=3, wz=2, point="x, y, z", **PLAIN) + "values: {a: 1}\n")
    assert cubic.stability.numerical.theorems == ("Arnold-Moser", "Lagrange-Dirichlet")  # of x, y; of z by itself


CONSTRAINED = """
mbsym: 1
name: Penning trap as a constraint
parameters: {wc: {sign: positive, value: 3}, wz: {sign: positive, value: 2}}
bodies:
  - {name: ion, attached to: 0, mass: 1, connection point: [x, y, z], coordinates: [x, y, z]}
  - {name: twin, attached to: 0, mass: 0, connection point: [u, 0, 0], coordinates: [u]}
loads:
  - potential: wz**2*(2*z**2 - x**2 - y**2)/4
  - generalized force: {x: wc*y_dot, y: -wc*x_dot}
constraints:
  - relation: u - x - 2*y = 0
motion: {}
"""


def test_linear_constraints_leave_exactly_linear_equations():
    found = mbsym.loads(CONSTRAINED)
    assert found.balance.exactly_linear
    assert found.stability.numerical.word is Word.STABLE, found.stability.numerical


def test_planted_terms_of_higher_order_are_seen(monkeypatch):
    """If the proof were left out, a quartic potential would count as linear."""
    from mbsym.problems import dissipation

    text = TRAP.format(wc=3, wz=2, point="x, y, z", **PLAIN).replace("wz**2*(2", "x**4 + wz**2*(2")
    assert LINEAR not in mbsym.loads(text).stability.numerical.theorems
    monkeypatch.setattr(dissipation, "excess", lambda *_: ())
    assert LINEAR in mbsym.loads(text).stability.numerical.theorems


@pytest.mark.parametrize(
    ("sign", "word"), [("positive", Word.STABLE), ("nonzero", Word.STABLE), ("real", Word.STABLE_BUT_CYCLIC)]
)
def test_a_particle_in_a_magnetic_field_that_may_vanish(sign: str, word: Word) -> None:
    """x'' = g y', y'' = -g x': circles where g != 0 (lambda^2 (lambda^2 + g^2), two null directions); at g = 0 a free
    particle, whose four zero roots have Jordan blocks: lambda^2 does not tell of these."""
    text = f"""
mbsym: 1
name: A particle in a magnetic field
parameters: {{g: {sign}}}
bodies:
  - {{name: p, mass: 1, connection point: [x, y, 0], coordinates: [x, y]}}
loads:
  - generalized force: {{x: g*y_dot, y: -g*x_dot}}
motion: {{}}
values: {{g: 1}}
"""
    assert mbsym.loads(text).stability.verdict.word is word
    assert mbsym.loads(text).stability.numerical.word is Word.STABLE


# --- a drift is counted where matrices are given, and not where coordinates are cyclic: both say so ---

LINE = """
mbsym: 1
name: line
{}
"""
ONLY_DRIFTS = {  # x'' = 0, x'' + x - y = y'' + y - x = 0, x' = v, v' = 0: x = x0 + v t, all else is bounded
    "linear system: {coordinates: [x], K: [[0]]}": True,
    "linear system: {coordinates: [x, y], K: [[1, -1], [-1, 1]]}": True,
    "linear system: {coordinates: [x, v], A: [[0, 1], [0, 0]]}": True,
    # v' = x, u' = v, x' = 0: u grows like t^2; x'' = x besides: like exp t; y'''' = 0 by y'' = x, x'' = 0
    "linear system: {coordinates: [x, v, u], A: [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}": False,
    "linear system: {coordinates: [x, y], K: [[0, 0], [0, -1]]}": False,
    "linear system: {coordinates: [x, y], S: [[0, 1], [0, 0]]}": False,
    # resonance: x'' + x = 0, y'' + y = x grows like t sin t; nothing drifts
    "linear system: {coordinates: [x, y], S: [[1, 0], [-1, 1]]}": False,
}


@pytest.mark.parametrize(("system", "only"), ONLY_DRIFTS.items())
def test_matrices_say_whether_nothing_grows_but_a_drift(system, only) -> None:
    found = mbsym.loads(LINE.format(system)).stability
    assert found.verdict.word is found.numerical.word is Word.UNSTABLE
    assert found.verdict.because(Because.LINEAR_DRIFTS) is found.numerical.because(Because.LINEAR_DRIFTS) is only


def test_one_motion_in_two_descriptions_is_told_alike() -> None:
    """x'' = 0 of a free body and by its matrix: each verdict says what the other is about, on screen as in files."""
    body = "bodies: [{name: p, attached to: 0, mass: 1, connection point: [x, 0, 0], coordinates: [x]}]\nmotion: {x: 0}"
    free = mbsym.loads(LINE.format(body))
    given = mbsym.loads(LINE.format("linear system: {coordinates: [x], K: [[0]]}"))
    assert free.stability.verdict.word is Word.STABLE_BUT_CYCLIC
    assert "with them counted the motion is unstable" in free.stability.verdict.explanation
    assert "but for that drift the motion is stable" in given.stability.verdict.explanation
    for a, words in ((free, "with them counted the motion is unstable"), (given, "but for that drift the motion is")):
        assert words in "\n".join(told(a, 6))
        for target in ("html", "latex"):
            assert words in " ".join(TARGETS[target].render(a, (6,)).split())


def test_a_part_that_drifts_says_nothing_of_a_whole_that_grows_otherwise() -> None:
    found = mbsym.loads(LINE.format("linear system: {coordinates: [x, y], K: [[0, 0], [0, -1]]}")).stability
    assert [p.theory.verdict.because(Because.LINEAR_DRIFTS) for p in found.subsystems] == [True, False]
    assert not found.verdict.because(Because.LINEAR_DRIFTS)


@pytest.mark.parametrize(
    ("v", "damping", "word"),
    [
        ("positive", "", Word.STABLE),
        ("positive", " - c*x_dot", Word.ASYMPTOTIC),
        ("negative", "", Word.STABLE),
        ("real", "", Word.CRITICAL),
    ],
)
def test_dry_friction_is_a_constant_force_while_it_slides(v, damping, word):
    """m x'' + k x = mu m g sign(v) as long as x' != v: there are no terms of higher order near x' = 0."""
    text = f"""
mbsym: 1
name: Block on a belt
parameters: {{m: positive, k: positive, mu: positive, v: {v}, g: positive, c: positive}}
bodies: [{{name: B, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: m}}]
loads: [{{spring: {{coordinate: x, stiffness: k}}}}, {{generalized force: {{x: -mu*m*g*sign(x_dot - v){damping}}}}}]
motion: {{x: {"-" if v == "negative" else ""}mu*m*g/k}}
values: {{m: 1, k: 2, mu: 1/2, v: {-3 if v == "negative" else 3}, g: 10, c: 1}}
"""
    found = mbsym.loads(text).stability
    assert found.verdict.word is word
    if v == "real":  # where v is a number its sign is known
        assert found.numerical.word is Word.STABLE


BODIES = "bodies: [{{name: p, attached to: 0, mass: 1, connection point: [x, y, 0], coordinates: [x, y]}}]\n"
ACTING = {  # what acts, at a = 0, c = 1, and the same with what vanishes left out: the equations are the same
    "{potential: a*x**2/2}": ("", Word.STABLE_BUT_CYCLIC),
    "{potential: a*x**2/2}, {potential: y**2/2}": ("{potential: y**2/2}", Word.STABLE_BUT_CYCLIC),
    "{potential: a*(x - y)**2/2}": ("", Word.STABLE_BUT_CYCLIC),
    "{generalized force: {x: -c*x_dot - a*x, y: -y - c*y_dot}}": (
        "{generalized force: {x: -c*x_dot, y: -y - c*y_dot}}",
        Word.ASYMPTOTIC_BUT_CYCLIC,
    ),
    "{potential: a*x**2/2 - y**2/2}": ("{potential: -y**2/2}", Word.UNSTABLE),
    "{potential: a*x**4 + y**2/2}": ("{potential: y**2/2}", Word.STABLE_BUT_CYCLIC),
}


@pytest.mark.parametrize(("loads", "without", "word"), [(x, *y) for x, y in ACTING.items()])
def test_what_does_not_act_at_the_values_is_as_if_it_were_not_there(loads, without, word) -> None:
    """x'' = -a x at a = 0 is x'' = 0 of a free body: x is cyclic there, whatever it is elsewhere."""
    known = "parameters: {a: real, c: positive}\nmotion: {x: 0, y: 0}\nvalues: {a: 0, c: 1}\n" + BODIES.format()
    acting = mbsym.loads(LINE.format(f"{known}loads: [{loads}]")).stability.numerical
    absent = mbsym.loads(LINE.format(f"{known}loads: [{without}]")).stability.numerical
    assert acting.word is absent.word is word


def test_where_another_momentum_pushes_it_is_more_than_a_drift() -> None:
    """x'' = g y' - a x, y'' = -g x': y' + g x = c is constant, x'' = g c at a = -g^2, so that x grows like t^2."""
    text = LINE.format(f"""parameters: {{a: real, g: real}}
{BODIES.format()}loads: [{{potential: a*x**2/2}}, {{generalized force: {{x: g*y_dot, y: -g*x_dot}}}}]
motion: {{x: 0, y: 0}}
values: {{a: -1, g: 1}}""")
    assert mbsym.loads(text).stability.numerical.word is Word.UNSTABLE


def test_a_drift_at_single_values_does_not_refute_what_is_necessary_elsewhere() -> None:
    """x'' = -a x, with y free or not: a > 0 is what keeps x near, and a >= 0 is not enough for that."""
    for point, moving in (("x, 0, 0", "x"), ("x, y, 0", "x, y")):
        claims = "".join(
            f"  - {{claim: condition, that: a {relation} 0, as: {role}}}\n"
            for relation, role in ((">", "necessary"), (">=", "sufficient"), (">", "sufficient"))
        )
        body = f"bodies: [{{name: p, mass: 1, connection point: [{point}], coordinates: [{moving}]}}]\n"
        text = f"parameters: {{a: real}}\n{body}loads: [{{potential: a*x**2/2}}]\nmotion: {{x: 0}}\nclaims:\n{claims}"
        outcomes = [claim.outcome for claim in mbsym.loads(LINE.format(text)).claims]
        assert outcomes == ["holds exactly", "does not hold", "holds exactly"], moving
