"""Series of periodic solutions as an author tells them: in variables of his own, common denominators named once."""

from __future__ import annotations

import json
from fractions import Fraction
from math import factorial
from pathlib import Path

import pytest
from conftest import SHIPPED, filed, invoked, system_of

from mbsym.algebra.base import Lowering
from mbsym.analysis import Analysis, oscillating
from mbsym.analysis.oscillating import Oscillating, in_variables
from mbsym.expressions.parser import parse_expression
from mbsym.expressions.place import Complaints, Span
from mbsym.expressions.tree import ONE, names, substitute
from mbsym.model.system import rational
from mbsym.source.scaling import read_scaling

#: (4) of the paper on gyrostat-fast.yaml without the powers of eps, which stand before the coefficients.
GYROSTAT = (
    "p=r_0*p1,q=r_0*q1,r=r_0*r1,gamma1=gamma3_0*h1,gamma2=gamma3_0*h2,gamma3=gamma3_0*h3,t=tau/r_0,A=a*C,B=b*C,x0=L*x,"
    "y0=L*y,z0=L*z,g=C*r_0**2/(M*L*gamma3_0),R=3*g*gamma3_0**2/(k*r_0**2),lx=y1*C*r_0,lz=nz*C*r_0"
)
DUFFING = """
mbsym: 1
name: Duffing
parameters: {m: {sign: positive}, k: {sign: positive}, c: {sign: positive}}
small parameter: {eps: {powers: {c: 1}}}
bodies:
  - {name: mass, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}
loads:
  - potential: k*x**2/2 + c*x**4/4
"""
PENDULUM = """
mbsym: 1
name: Pendulum
parameters: {m: {sign: positive}, l: {sign: positive}, g: {sign: positive}}
bodies:
  - {name: rod, attached to: 0, rotation: {axes: [3], angles: [theta]}, mass: 0}
  - {name: bob, attached to: rod, connection point: [0, -l, 0], mass: m}
loads: [{uniform gravity: {acceleration: g, direction: [0, -1, 0]}}]
motion: {theta: 0}
"""


def told(text: str, order: int, scale: str) -> tuple[Oscillating, Oscillating]:
    """The solution, and the same in other variables."""
    system = system_of(text)
    found = oscillating.oscillating(Analysis(system), order)
    scaling = read_scaling(scale, system, Complaints())
    assert scaling is not None
    return found, in_variables(found, system, scaling)


@pytest.fixture(scope="module")
def gyrostat() -> tuple[Oscillating, Oscillating]:
    return told((SHIPPED / "gyrostat-fast.yaml").read_text(), 2, GYROSTAT)


#: The right solution in the place of (41), by hand and with sympy (references: gyrostat, 2.2), in the paper's symbols.
LETTERS = {
    "M3": "amplitude",
    "P0": "y1/(1 - a + nz)",
    "A1": "(1 - b)/a",
    "B1": "(a - 1)/b",
    "C1": "b - a",
    "X": "a/(1 - b + nz)",
    "Omega2": "(1 - b + nz)*(1 - a + nz)/(a*b)",
    "lam": "x*(1 - b + nz)/(a*b*Omega2)",
    "lam1": "(z*(A1/b - 1/a) + k*(A1 + A1*B1) + (z/b + k*B1)*nz/a)/(1 - Omega2)",
    "lam2": "lam1 + z/a - k*A1",
}
RIGHT = {
    ("p1", 0): "P0",
    ("p1", 1): "lam + lam1*M3*cos(phase)",
    ("q1", 1): "X*(y/a + lam2*M3*sin(phase))",
    ("r1", 0): "1",
    ("r1", 2): "-M3*(x*(1 - cos(phase)) + y*sin(phase)) - k*M3**2*C1*(1 - cos(2*phase))/4",
    ("h1", 0): "M3*cos(phase)",
    ("h1", 1): "P0*(1 - cos(phase))",
    ("h2", 0): "-M3*sin(phase)",
    ("h2", 1): "P0*sin(phase)",
    ("h3", 0): "1",
    ("h3", 1): "P0*M3*(1 - cos(phase))",
}
FREQUENCY = {0: "0", 1: "-(k*M3**2*C1 + 4*M3*x + 2*lam1 - 2*X*lam2 - 2*P0**2)/4"}


def test_the_solution_of_the_fast_gyrostat_in_the_papers_letters(gyrostat: tuple[Oscillating, Oscillating]) -> None:
    found = gyrostat[1]
    ring = found.ring
    known = {g.name: ring.generator("parameter", g.name) for g in ring.generators if g.kind == "parameter"}
    known["phase"] = ring.generator("prescribed", "phase")

    def lowered(text: str) -> object:
        tree = parse_expression(text, Complaints(), lambda start, end: Span(1, start + 1, end - start))
        assert tree is not None
        return Lowering(ring, known)(tree)

    for name, text in LETTERS.items():
        known[name] = lowered(text)
    for (name, order), text in RIGHT.items():
        series = found.oscillation.series[found.oscillation.names.index(name)]
        assert ring.is_zero(ring.reduce(found.wave(series[order]).polynomial - lowered(text))), (name, order)
    for order, text in FREQUENCY.items():
        value = found.formula(found.oscillation.corrections[order]).polynomial
        assert ring.is_zero(ring.reduce(value - lowered(text))), order
    assert str(found.formula(found.oscillation.frequency)) == "1"


def test_letters_for_denominators_change_nothing(gyrostat: tuple[Oscillating, Oscillating]) -> None:
    """With D1, D2, ... put in again each coefficient is what it was; all the common ones have a letter."""
    for found in gyrostat:
        tower, ring = found.oscillation.tower, found.told_ring
        assert [name for _, name in found.denominators] == ["D1", "D2", "D3", "D4", "D5"]
        environment = {
            g.name: found.ring.generator("parameter", g.name)
            for g in ring.generators
            if g.kind == "parameter" and found.ring.has("parameter", g.name)
        }
        environment["phase"] = found.ring.generator("prescribed", "phase")
        one = tower.context.constant(1)
        environment |= {name: found.formula(tower.made(x, one)).polynomial for x, name in found.denominators}
        for series in found.oscillation.series:
            for wave in series:
                short, whole = found.shortest(wave), found.wave(wave)
                tree = parse_expression(str(short), Complaints(), lambda start, end: Span(1, start + 1, end - start))
                assert tree is not None
                again = Lowering(found.ring, environment)(tree)
                assert found.ring.is_zero(found.ring.reduce(again - whole.polynomial))
                assert len(short.text()) <= len(whole.text())


def elliptic(order: int) -> list[Fraction]:
    """2 K(m)/pi = sum ((2n)!/(4^n n!^2))^2 m^n."""
    return [Fraction(factorial(2 * n), 4**n * factorial(n) ** 2) ** 2 for n in range(order + 1)]


def times(a: list[Fraction], b: list[Fraction], order: int) -> list[Fraction]:
    return [sum((a[i] * b[n - i] for i in range(n + 1)), Fraction(0)) for n in range(order + 1)]


def powers(x: list[Fraction], coefficients: list[Fraction], order: int) -> list[Fraction]:
    """sum_n c_n x^n of a series x without a constant term."""
    total, power = [Fraction(0)] * (order + 1), [Fraction(1)] + [Fraction(0)] * order
    for c in coefficients:
        total = [a + c * b for a, b in zip(total, power, strict=True)]
        power = times(power, x, order)
    return total


def reciprocal(x: list[Fraction], order: int) -> list[Fraction]:
    rest = [Fraction(0), *(-c for c in x[1:])]
    return powers(rest, [Fraction(1)] * (order + 1), order)


def root(order: int) -> list[Fraction]:
    """sqrt(1 + x)."""
    found = [Fraction(1)]
    for n in range(order):
        found.append(found[-1] * (Fraction(1, 2) - n) / (n + 1))
    return found


def corrections(found: Oscillating) -> list[str]:
    return [str(found.formula(x)) for x in found.oscillation.corrections]


def test_duffings_frequency_to_the_order_six() -> None:
    """x'' + x + e x^3 = 0, x(0) = A, e A^2 = s: the energy gives T = 4 K(m)/sqrt(1 + s), m = s/(2 (1 + s)), so that
    omega = sqrt(1 + s)/(2 K(m)/pi) = 1 + 3 s/8 - 21 s^2/256 + 81 s^3/2048 - ..."""
    n = 6
    modulus = [Fraction(0), *(Fraction((-1) ** k, 2) for k in range(n))]
    exact = times(root(n), reciprocal(powers(modulus, elliptic(n), n), n), n)
    assert exact[1:4] == [Fraction(3, 8), Fraction(-21, 256), Fraction(81, 2048)]
    _, found = told(DUFFING, n, "t=tau/w,k=m*w**2,x=X*x1,c=m*w**2*q/X**2")
    assert list(map(value, corrections(found))) == exact[1:]


def value(text: str) -> Fraction:
    """The number of a monomial: its letters are 1."""
    tree = parse_expression(text, Complaints(), lambda start, end: Span(1, start + 1, end - start))
    assert tree is not None
    found = rational(substitute(tree, dict.fromkeys(names(tree), ONE)))
    assert found is not None
    return found


def test_the_pendulums_period_to_the_order_eight() -> None:
    """T/T0 = 2 K(sin^2(A/2))/pi = 1 + A^2/16 + 11 A^4/3072 + 173 A^6/737280 + 22931 A^8/1321205760."""
    n = 4
    sine = [Fraction(0), *(Fraction((-1) ** (k + 1), 2 * factorial(2 * k)) for k in range(1, n + 1))]  # in A^2
    period = powers(sine, elliptic(n), n)
    assert period[1:] == [Fraction(1, 16), Fraction(11, 3072), Fraction(173, 737280), Fraction(22931, 1321205760)]
    _, found = told(PENDULUM, 8, "t=tau/w,g=l*w**2")
    series = corrections(found)
    assert series[0::2] == ["0"] * 4
    assert [Fraction(1), *map(value, series[1::2])] == reciprocal(period, n)
    assert str(found.formula(found.oscillation.frequency)) == "1"


def test_the_command_tells_them(tmp_path: Path) -> None:
    path = filed(tmp_path / "duffing.yaml", DUFFING)
    scale = "t=tau/w,k=m*w**2,x=X*x1,c=m*w**2*q/X**2"
    done = invoked("oscillations", path, "--scale", scale, code=0)
    assert "x1(1) = -q amplitude^3 sin(phase)^2 cos(phase)/8" in done.output
    data = json.loads(invoked("oscillations", path, "--scale", scale, "--json").output)
    assert data["corrections"] == ["3*q*amplitude**2/8", "-21*q**2*amplitude**4/256"]
    wrong = invoked("oscillations", path, "--scale", "x=eps*X*x1", code=2)
    assert "eps is the small parameter" in wrong.output


def test_common_denominators_stand_once_in_the_text() -> None:
    words = ["oscillations", str(SHIPPED / "gyrostat-fast.yaml"), "--order", "1"]
    done = invoked(*words, "--in", "none")
    assert "p(0) = -lx r_0/D1\n" in done.output
    assert "D1 = r_0 (A - C) - lz\n" in done.output


def test_the_authors_letters_come_before_denominators_of_ours() -> None:
    """(41) of the paper: what is shorter in them has no D1, and no D is explained that does not stand there."""
    words = ["oscillations", str(SHIPPED / "gyrostat-fast.yaml"), "--order", "1"]
    done = invoked(*words).output
    assert "p(0) = P0 r_0\n" in done
    assert "gamma2(1) = P0 gamma3_0 sin(phase)\n" in done
    assert "p(1) = r_0 (M3 lam1 cos(phase) + lam)\n" in done  # as in the claim (41)
    series = done.partition("Secular terms")[0]
    series, _, explained = series.partition("  with:")
    for name in ("D1", "D2", "D3"):
        assert (name in series) == (f"{name} = " in explained)
