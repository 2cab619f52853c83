"""Kernels: every back end against rigorous balls at exactly the same inputs, within a bound that is proved, not tuned.

A running error bound of a program in an arithmetic of p bits is the radius r of its value in p-bit balls: every ball
operation adds what rounding to nearest can add.  Library functions may err by one unit in the last place, twice that,
and a fused operation rounds once instead of twice; so |kernel - true| <= 2 r must hold.
"""

from __future__ import annotations

import copy
import ctypes
import json
import random
import shutil
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import OWN, SHIPPED
from flint import arb, ctx, fmpq
from hypothesis import HealthCheck, assume, given
from hypothesis import strategies as st
from properties import settings
from random_systems import systems

import mbsym
from mbsym.algebra.failures import NoClosedForm, SingularPoint
from mbsym.algebra.point import Rationals
from mbsym.algebra.program import Program
from mbsym.expressions.tree import number
from mbsym.mechanics.programs import forward_dynamics
from mbsym.model.system import System
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels import arrays, llvm, sine_cosine
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT32, FLOAT64, Code
from mbsym.numerics.kernels.precise import enclosures, precise
from mbsym.numerics.scenario import Scenario, scenario
from mbsym.report.code.c_source import RESERVED, proposed
from mbsym.report.code.identifiers import prefix_of
from mbsym.report.targets import TARGETS

BITS = {FLOAT32: 24, FLOAT64: 53, EXTENDED: 64}
TYPES = {FLOAT32: np.float32, FLOAT64: np.float64, EXTENDED: np.longdouble}
SCALARS = [pytest.param(name, marks=pytest.mark.skipif(not llvm.available(name), reason="no x87")) for name in BITS]
PATHS = [
    SHIPPED / "double-pendulum.yaml",
    SHIPPED / "spatial-arm.yaml",
    SHIPPED / "satellite.yaml",
    SHIPPED / "heavy-top.yaml",
    SHIPPED / "spring-pendulum.yaml",
    OWN / "pleiades.yaml",
    OWN / "restricted-three-bodies.yaml",
]


def dynamics_at(system: System, source: random.Random | None = None) -> Dynamics:
    """The system with its own numbers, or with random ones for whatever it leaves open."""
    generator = source or random.Random(1)
    values = {p.name: number(Fraction(generator.randint(1, 16), 8)) for p in system.parameters if p.value is None}
    return Dynamics(scenario(system, values, state=False))


def states(code: Code, source: random.Random, count: int, dtype: Any) -> Any:
    return np.array([[source.uniform(-1.5, 1.5) for _ in range(count)] for _ in code.inputs], dtype)


def exact(value: Any) -> Fraction:
    return Fraction(*(int(part) for part in value.as_integer_ratio()))


def outside(
    code: Code, inputs: Sequence[Any], results: Sequence[Any], bits: int, judge: Code | None = None
) -> list[int]:
    """The outputs that lie farther from the truth than the bound allows; ``judge`` knows the truth."""
    truth = enclosures(judge or code, inputs, 400)
    rough = enclosures(judge or code, inputs, bits)
    wrong = []
    with ctx.workprec(400):
        for place, (value, middle, ball) in enumerate(zip(results, truth, rough, strict=True)):
            if not ball.is_finite():
                continue
            if not np.isfinite(value):
                wrong.append(place)
                continue
            fraction = exact(value)
            distance = abs(arb(fmpq(fraction.numerator, fraction.denominator)) - middle)
            if not distance <= 2 * arb(ball.rad()) + middle.rad():
                wrong.append(place)
    return wrong


def assert_within(code: Code, kernel: Any, scalar: str, source: random.Random, count: int = 3) -> None:
    inputs = states(code, source, count, TYPES[scalar])
    results = kernel(inputs)
    assert results.dtype == TYPES[scalar]
    for k in range(count):
        assert not outside(code, inputs[:, k], results[:, k], BITS[scalar])
        alone = kernel(inputs[:, k])
        assert alone.shape == (len(code.outputs),)
        assert not outside(code, inputs[:, k], alone, BITS[scalar])


# --- the bound, for every back end ---


@pytest.mark.parametrize("scalar", SCALARS)
@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
def test_machine_code_is_within_twice_the_running_error_bound(path: Path, scalar: str) -> None:
    dynamics = dynamics_at(mbsym.load(path).system)
    codes = {"rhs": dynamics.right_hand_side, "energy": dynamics.relative_energy}
    for name, kernel in llvm.kernels(codes, scalar).items():
        assert_within(codes[name], kernel, scalar, random.Random(path.stem))


@pytest.mark.parametrize("scalar", SCALARS)
def test_numpy_source_is_within_the_same_bound(scalar: str) -> None:
    for name in ("double-pendulum", "spatial-arm", "satellite"):
        code = dynamics_at(mbsym.load(SHIPPED / f"{name}.yaml").system).right_hand_side
        assert_within(code, arrays.kernel(code, scalar), scalar, random.Random(name))


def test_numpy_source_stands_alone() -> None:
    code = dynamics_at(mbsym.load(SHIPPED / "double-pendulum.yaml").system).right_hand_side
    scope: dict[str, Any] = {"np": np}
    exec(arrays.source(code), scope)
    inputs = states(code, random.Random(3), 1, np.float64)[:, 0]
    assert not outside(code, inputs, np.array(scope["f"](*inputs)), 53)


@pytest.mark.parametrize("name", ["mass_matrix", "forcing", "jacobian", "pivots", "momenta", "momentum_rates"])
def test_every_code_of_a_scenario_is_within_the_bound(name: str) -> None:
    dynamics = dynamics_at(mbsym.load(SHIPPED / "spatial-arm.yaml").system)
    code: Code = getattr(dynamics, name)
    assert_within(code, llvm.kernel(code), FLOAT64, random.Random(name))


@given(description=systems(most=3, most_coordinates=4, solid=True), seed=st.integers(0, 2**32))
@settings(max_examples=20, suppress_health_check=list(HealthCheck))
def test_random_systems_are_within_the_bound(description: dict[str, Any], seed: int) -> None:
    source = random.Random(seed)
    system = mbsym.loads(json.dumps(description)).system
    try:
        code = dynamics_at(system, source).right_hand_side
    except (SingularPoint, NoClosedForm):
        assume(False)
    for kernel in (llvm.kernel(code), arrays.kernel(code)):
        assert_within(code, kernel, FLOAT64, source, 2)


def test_exact_rational_evaluation_agrees() -> None:
    """Without angles everything is a rational number at every float."""
    code = dynamics_at(mbsym.load(OWN / "mass-spring-damper-chain.yaml").system).right_hand_side
    kernels = [llvm.kernel(code, scalar) for scalar in (FLOAT64, EXTENDED) if llvm.available(scalar)]
    inputs = states(code, random.Random(5), 1, np.float64)[:, 0]
    rational = {name: fmpq(*value.as_integer_ratio()) for name, value in zip(code.inputs, inputs, strict=True)}
    truth = code.program.evaluate(code.outputs, rational, Rationals({}, {}))
    balls = enclosures(code, inputs, 53)
    for kernel in (*kernels, arrays.kernel(code)):
        for value, wanted, ball in zip(kernel(inputs), truth, balls, strict=True):
            difference = abs(exact(value) - Fraction(int(wanted.p), int(wanted.q)))
            assert difference <= 2 * Fraction(float(ball.rad()) * 1.001)


# --- planted errors ---


def changed(code: Code, number_: int, operation: str | None, payload: Fraction | None) -> Code:
    """The code with one instruction changed."""
    program: Program = copy.copy(code.program)
    program.instructions = list(program.instructions)
    old = program.instructions[number_]
    if operation is not None:
        program.instructions[number_] = old._replace(operation=operation)
    else:
        program.instructions[number_] = old._replace(payload=payload)
    return Code(program, code.inputs, code.outputs)


def test_a_changed_instruction_is_caught() -> None:
    code = dynamics_at(mbsym.load(SHIPPED / "spatial-arm.yaml").system).right_hand_side
    source = random.Random(7)
    inputs = states(code, source, 4, np.float64)
    others = {"add": "subtract", "subtract": "add", "multiply": "add", "sin": "cos", "cos": "sin"}
    live = [k for k in code.program.live(code.outputs) if code.program.instructions[k].operation in others]
    for place in source.sample(live, 6):
        wrong = changed(code, place, others[code.program.instructions[place].operation], None)
        results = llvm.kernel(wrong)(inputs)
        assert any(outside(wrong, inputs[:, k], results[:, k], 53, judge=code) for k in range(4)), place


def test_a_constant_off_by_a_few_roundings_is_caught() -> None:
    """The bound is tight enough to see a relative error of 1e-13 in a constant."""
    code = dynamics_at(mbsym.load(SHIPPED / "double-pendulum.yaml").system).right_hand_side
    inputs = states(code, random.Random(8), 3, np.float64)
    for place in code.program.live(code.outputs):
        payload = code.program.instructions[place].payload
        if isinstance(payload, Fraction) and payload not in (0, 1):
            wrong = changed(code, place, None, payload * (1 + Fraction(1, 10**13)))
            results = llvm.kernel(wrong)(inputs)
            assert any(outside(wrong, inputs[:, k], results[:, k], 53, judge=code) for k in range(3))


# --- constants ---


@pytest.mark.parametrize("scalar", SCALARS)
def test_constants_are_correctly_rounded(scalar: str) -> None:
    source = random.Random(11)
    values = [Fraction(source.randint(-(10**12), 10**12), source.randint(1, 10**9)) for _ in range(60)]
    values += [Fraction(1, 3) * Fraction(2) ** k for k in (-140, -126, -60, 60, 126)]
    # Half-way between two numbers of 24, 53 and 64 bits, and just beyond: double rounding would show.
    for bits in BITS.values():
        middle = Fraction(2**bits + 1, 2**bits)
        values += [middle, middle + Fraction(1, 2**200), middle - Fraction(1, 2**200)]
    program = Program()
    code = Code(program, (), tuple(program.number(value) for value in values))
    results = llvm.kernel(code, scalar)(np.empty(0, TYPES[scalar]))
    for value, found in zip(values, results, strict=True):
        up, down = np.nextafter(found, TYPES[scalar](np.inf)), np.nextafter(found, TYPES[scalar](-np.inf))
        distance = abs(exact(found) - value)
        assert all(distance <= abs(exact(other) - value) for other in (up, down)), (value, found)


@pytest.mark.parametrize("scalar", SCALARS)
def test_constants_beyond_the_range_are_refused(scalar: str) -> None:
    largest = {FLOAT32: 130, FLOAT64: 1030, EXTENDED: 17000}[scalar]
    with pytest.raises(NoClosedForm):
        llvm.constant(Fraction(2) ** largest, llvm.SCALARS[scalar].type)


def test_tiny_extended_constants_lose_digits_but_not_their_size() -> None:
    if not llvm.available(EXTENDED):
        pytest.skip("no x87")
    value = Fraction(3, 2) * Fraction(2) ** -16400
    text = llvm.constant(value, "x86_fp80")
    significand = int(text[7:], 16)
    assert text.startswith("0xK0000")
    assert Fraction(significand) * Fraction(2) ** (-16382 - 63) == value


# --- many states at once ---

WIDE_SCALARS = [FLOAT64, FLOAT32]


@pytest.mark.parametrize("scalar", WIDE_SCALARS)
@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
def test_states_side_by_side_give_the_same_numbers_within_the_bound(path: Path, scalar: str) -> None:
    dynamics = dynamics_at(mbsym.load(path).system)
    codes = {"rhs": dynamics.right_hand_side, "energy": dynamics.relative_energy}
    wide, lanes = llvm.kernels(codes, scalar, wide=True), llvm.lanes_of(scalar)
    for name, kernel in llvm.kernels(codes, scalar).items():
        for count in (1, lanes - 1, lanes, 2 * lanes + 1, 37):
            inputs = states(codes[name], random.Random(count), count, TYPES[scalar])
            together = wide[name](inputs)
            assert np.array_equal(together, kernel(inputs))
            assert np.array_equal(together[:, -1], kernel(inputs[:, -1]))
        assert not outside(codes[name], inputs[:, 5], together[:, 5], BITS[scalar])


def every_function() -> Code:
    """Outputs with every function, quotients, fused sums of all signs, and sines of sines."""
    program = Program()
    x, y = program.input("x"), program.input("y")
    own = [
        program.function(name, x * x + y * y) for name in ("sqrt", "exp", "log", "atan", "sinh", "cosh", "tanh", "tan")
    ]
    a, b = program.function("sin", x), program.function("cos", x * y)
    nested = [program.function("cos", a + b * y), program.function("sin", program.function("sin", b) * a)]
    sums = [x * y + a, x * y - a, a - x * b, a * b - x * a, a * y + b * b, program.divide(a, y) - x * b]
    return Code(program, ("x", "y"), (*own, a, b, *nested, *sums, x, program.number(3)))


@pytest.mark.parametrize("scalar", SCALARS)
def test_every_function_is_within_the_bound(scalar: str, monkeypatch: pytest.MonkeyPatch) -> None:
    code = every_function()
    for long, part in ((4_000, 500), (3, 4)):
        monkeypatch.setattr(llvm, "LONG", long)
        monkeypatch.setattr(llvm, "PART", part)
        inputs = states(code, random.Random(9), 11, TYPES[scalar])
        results = llvm.kernels({"f": code}, scalar, wide=True)["f"](inputs)
        assert np.array_equal(results, llvm.kernel(code, scalar)(inputs))
        for k in range(0, 11, 3):
            assert not outside(code, inputs[:, k], results[:, k], BITS[scalar])


def test_code_for_many_states_is_compiled_when_it_pays(monkeypatch: pytest.MonkeyPatch) -> None:
    code = dynamics_at(mbsym.load(SHIPPED / "double-pendulum.yaml").system).right_hand_side
    inputs = states(code, random.Random(1), 40, np.float64)
    made = []
    compile_it = llvm.compiled_wide
    monkeypatch.setattr(llvm, "WIDE", 100)
    monkeypatch.setattr(llvm, "compiled_wide", lambda *given: made.append(given) or compile_it(*given))
    kernel = llvm.kernel(code)
    before = [kernel(inputs) for _ in range(2)]
    assert not made
    after = [kernel(inputs) for _ in range(3)]
    assert len(made) == (llvm.lanes_of(FLOAT64) > 1)
    assert all(np.array_equal(one, before[0]) for one in (*before, *after))


def test_long_programs_are_split_for_many_states_too(monkeypatch: pytest.MonkeyPatch) -> None:
    code = dynamics_at(mbsym.load(SHIPPED / "satellite.yaml").system).right_hand_side
    inputs = states(code, random.Random(2), 9, np.float64)
    whole = llvm.kernel(code)(inputs)
    monkeypatch.setattr(llvm, "LONG", 10)
    monkeypatch.setattr(llvm, "PART", 13)
    text = llvm.wide_text("f", code, llvm.SCALARS[FLOAT64], 4)
    assert text.count("define internal void @f.wide.") > 5
    assert np.array_equal(llvm.kernels({"f": code}, wide=True)["f"](inputs), whole)


# --- sine and cosine ---


def sines_and_cosines(lanes: int) -> Callable[[Any], tuple[Any, Any]]:
    """sine_cosine.N over an array whose length is a multiple of N."""
    kind = sine_cosine.vector(lanes, "double")
    text = f"""
declare double @sin(double) #1
declare double @cos(double) #1
{sine_cosine.declarations(lanes)}{sine_cosine.text(lanes)}
define void @run(ptr %in, ptr %sines, ptr %cosines, i64 %m) #0 {{
entry:
  br label %loop
loop:
  %k = phi i64 [0, %entry], [%next, %loop]
  %p = getelementptr double, ptr %in, i64 %k
  %x = load {kind}, ptr %p, align 8
  %both = call {{ {kind}, {kind} }} @{sine_cosine.name(lanes)}({kind} %x)
  %a = extractvalue {{ {kind}, {kind} }} %both, 0
  %b = extractvalue {{ {kind}, {kind} }} %both, 1
  %pa = getelementptr double, ptr %sines, i64 %k
  %pb = getelementptr double, ptr %cosines, i64 %k
  store {kind} %a, ptr %pa, align 8
  store {kind} %b, ptr %pb, align 8
  %next = add i64 %k, {lanes}
  %more = icmp slt i64 %next, %m
  br i1 %more, label %loop, label %done
done:
  ret void
}}
"""
    library = llvm.Library(text + llvm.ATTRIBUTES)
    function = library.function("run", *[ctypes.c_void_p] * 3, ctypes.c_int64)

    def run(x: Any) -> tuple[Any, Any]:
        assert library is not None
        x = np.ascontiguousarray(x, float)
        sines, cosines = np.empty_like(x), np.empty_like(x)
        function(x.ctypes.data, sines.ctypes.data, cosines.ctypes.data, len(x))
        return sines, cosines

    return run


def angles() -> Any:
    """Random ones of every size, multiples of pi/2 and their neighbours, and the smallest numbers."""
    source = random.Random(12)
    found = [source.uniform(-size, size) for size in (0.8, 4, 50, 1e3, 1e5) for _ in range(300)]
    found += [source.choice((-1, 1)) * 10 ** source.uniform(-320, 0) for _ in range(200)]
    with ctx.workprec(200):
        for count in (*range(200), *(source.randrange(63_600) for _ in range(300))):
            nearest = float((arb.pi() / 2 * count).mid())
            found += [nearest, -float(np.nextafter(nearest, np.inf)), float(np.nextafter(nearest, -np.inf))]
    found += [0.0, -0.0, 5e-324, -5e-324, 2.2e-308, sine_cosine.LARGEST_ANGLE, -sine_cosine.LARGEST_ANGLE]
    return np.array(found[: len(found) // 8 * 8])


def most_units(x: Any, results: tuple[Any, Any]) -> float:
    """The largest error of sines and cosines in units of the last place."""
    worst = 0.0
    with ctx.workprec(300):
        for angle, sine, cosine in zip(x, *results, strict=True):
            for true, found in ((arb(angle).sin(), sine), (arb(angle).cos(), cosine)):
                unit = float(np.spacing(abs(float(true))))
                worst = max(worst, float(abs(arb(found) - true) / arb(unit)))
    return worst


@pytest.mark.parametrize("lanes", [1, 2, 4, 8])
def test_sines_and_cosines_err_by_less_than_a_unit(lanes: int) -> None:
    x = angles()
    assert most_units(x, sines_and_cosines(lanes)(x)) < 0.8


@pytest.mark.parametrize(("table", "place"), [("_SINE", 4), ("_COSINE", 4), ("_PI", None)])
def test_a_wrong_constant_of_the_sine_is_caught(table: str, place: int | None, monkeypatch: pytest.MonkeyPatch) -> None:
    """A coefficient wrong in its fifth digit; pi wrong in the 30th, which shows beside its multiples."""
    values = getattr(sine_cosine, table)
    if place is None:
        monkeypatch.setattr(sine_cosine, table, values + Fraction(1, 10**30))
    else:
        changed_one = values[place] * (1 + 1e-5)
        monkeypatch.setattr(sine_cosine, table, (*values[:place], changed_one, *values[place + 1 :]))
    x = angles()
    assert most_units(x, sines_and_cosines(4)(x)) > 1


def test_angles_beyond_the_range_do_not_change_their_neighbours() -> None:
    run = sines_and_cosines(4)
    usual = np.array([0.3, -1e5, 17.25, -2.5])
    sines, cosines = run(usual)
    for other in (1.5e5, -1e22, 1e300, np.inf, -np.inf, np.nan):
        for place in range(4):
            x = usual.copy()
            x[place] = other
            found = run(x)
            keep = np.arange(4) != place
            assert np.array_equal(found[0][keep], sines[keep])
            assert np.array_equal(found[1][keep], cosines[keep])
            if np.isfinite(other):
                assert most_units(x[place : place + 1], (found[0][place : place + 1], found[1][place : place + 1])) < 1
            else:
                assert np.isnan(found[0][place])
                assert np.isnan(found[1][place])


def test_the_sine_of_minus_nothing_is_minus_nothing() -> None:
    sines, cosines = sines_and_cosines(2)([0.0, -0.0])
    assert list(np.signbit(sines)) == [False, True]
    assert list(sines) == [0, 0]
    assert list(cosines) == [1, 1]


# --- shapes, long programs ---


def test_shapes_are_checked() -> None:
    code = dynamics_at(mbsym.load(SHIPPED / "simple-pendulum.yaml").system).right_hand_side
    for kernel in (llvm.kernel(code), arrays.kernel(code)):
        with pytest.raises(ValueError, match="expected 3 rows"):
            kernel(np.zeros(4))
        with pytest.raises(ValueError, match="expected 3 rows"):
            kernel(np.zeros((3, 2, 2)))
        assert kernel(np.zeros((3, 0))).shape == (2, 0)


def test_long_programs_are_split_without_a_difference(monkeypatch: pytest.MonkeyPatch) -> None:
    code = dynamics_at(mbsym.load(SHIPPED / "satellite.yaml").system).right_hand_side
    inputs = states(code, random.Random(2), 3, np.float64)
    monkeypatch.setattr(llvm, "LONG", 10)
    monkeypatch.setattr(llvm, "PART", 13)
    text = llvm.function_text("f", code, llvm.SCALARS[FLOAT64])
    assert text.count("define internal void @f.") > 5
    results = llvm.kernel(code)(inputs)
    for k in range(3):
        assert not outside(code, inputs[:, k], results[:, k], 53)


def test_machine_code_outlives_what_it_was_made_from() -> None:
    kernel = llvm.kernel(dynamics_at(mbsym.load(SHIPPED / "simple-pendulum.yaml").system).right_hand_side)
    assert np.all(np.isfinite(kernel(np.ones((3, 50)))))


def test_any_precision_agrees_with_balls() -> None:
    code = dynamics_at(mbsym.load(SHIPPED / "spatial-arm.yaml").system).right_hand_side
    inputs = states(code, random.Random(4), 1, np.float64)[:, 0]
    with ctx.workprec(300):
        values = precise(code, 300)([arb(float(x)) for x in inputs])
        for mine, other in zip(values, enclosures(code, inputs, 300), strict=True):
            assert mine.overlaps(other)
            assert mine.rad() < 1e-60


# --- C ---

COMPILER = shutil.which("cc")


class Compiled:
    """A shared library: ``mass_matrix`` is its function of that name after the prefix of the system."""

    def __init__(self, path: Path, prefix: str) -> None:
        self.library, self.prefix = ctypes.CDLL(str(path)), prefix

    def __getattr__(self, name: str) -> Any:
        return getattr(self.library, f"{self.prefix}_{name}")


def compiled(analysis: Any, folder: Path) -> Compiled:
    target = TARGETS["c"]
    for part in (target, *target.companions):
        (folder / part.filename).write_text(part.render(analysis, ()), encoding="utf-8")
    library = folder / "model.so"
    options = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O1", "-shared", "-fPIC"]
    assert COMPILER is not None
    done = subprocess.run(
        [COMPILER, *options, "-o", str(library), str(folder / "model.c"), "-lm"], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return Compiled(library, prefix_of(analysis.system.name))


def call(function: Any, t: float, arguments: Sequence[Any], parameters: Any, count: int) -> Any:
    out = np.full(count, np.nan)
    pointers = [array.ctypes.data_as(ctypes.c_void_p) for array in (*arguments, parameters, out)]
    function(ctypes.c_double(t), *pointers)
    return out


@pytest.mark.skipif(COMPILER is None, reason="no C compiler")
@pytest.mark.parametrize(
    "path", [*PATHS[:4], OWN / "rotating-shaft.yaml", OWN / "restricted-three-bodies.yaml"], ids=lambda path: path.stem
)
def test_c_source_is_within_the_bound(path: Path, tmp_path: Path) -> None:
    """All functions of model.c at random parameters and states, against the same programs in balls."""
    analysis = mbsym.load(path)
    system, source = analysis.system, random.Random(path.stem)
    library = compiled(analysis, tmp_path)
    n, names = len(system.coordinates), system.parameter_names
    values = np.array([source.uniform(0.5, 2) for _ in names] or [0.0])
    x = np.array([source.uniform(-1.5, 1.5) for _ in range(2 * n)])
    q, qd, t = x[:n].copy(), x[n:].copy(), source.uniform(0, 1)

    known = dict(zip(names, (Fraction(value) for value in values), strict=False))
    free = replace(system, relations=())  # the functions of model.c do not use relations
    fixed = scenario(free, {name: number(value) for name, value in known.items()}, state=False)
    solved = forward_dynamics(system, analysis.ring)
    programs = analysis.programs
    inputs = ["t", *system.coordinates, *system.velocities, *names, *fixed.prescribed, "pi"]
    moving = [_prescribed_ball(fixed, name, t) for name in fixed.prescribed]

    def truth(program: Program, outputs: Sequence[Any], bits: int) -> list[Any]:
        with ctx.workprec(bits):
            point = [t, *x, *known.values(), *(value() for value in moving), arb.pi()]
            return enclosures(Code(program, tuple(inputs), tuple(outputs)), point, bits)

    def check(program: Program, outputs: Sequence[Any], results: Sequence[float]) -> None:
        assert len(outputs) == len(results)
        fine, rough = truth(program, outputs, 400), truth(program, outputs, 53)
        for value, middle, ball in zip(results, fine, rough, strict=True):
            assert ball.is_finite()
            assert abs(arb(float(value)) - middle) <= 2 * arb(ball.rad()) + arb(2) ** -1000

    check(programs.program, sum(programs.mass_matrix, ()), call(library.mass_matrix, t, [q], values, n * n))
    check(programs.program, programs.forcing, call(library.forcing, t, [q, qd], values, n))
    check(solved.program, solved.accelerations, call(library.accelerations, t, [q, qd], values, n))
    slope = call(library.right_hand_side, t, [x], values, 2 * n)
    assert list(slope[:n]) == list(qd)
    check(solved.program, solved.accelerations, slope[n:])
    library.energy.restype = ctypes.c_double
    pointers = [array.ctypes.data_as(ctypes.c_void_p) for array in (q, qd, values)]
    check(programs.program, [programs.energy], [library.energy(ctypes.c_double(t), *pointers)])

    jacobian = call(library.jacobian, t, [x], values, 4 * n * n).reshape(2 * n, 2 * n)
    assert np.array_equal(jacobian[:n], np.hstack((np.zeros((n, n)), np.eye(n))))
    for j in range(2 * n):  # central differences of the same function
        step = np.zeros(2 * n)
        step[j] = 1e-5
        ends = [call(library.right_hand_side, t, [x + s * step], values, 2 * n) for s in (1, -1)]
        difference = (ends[0] - ends[1]) / 2e-5
        assert np.allclose(jacobian[:, j], difference, rtol=1e-6, atol=1e-6 * max(1, np.abs(jacobian).max()))


def _prescribed_ball(fixed: Scenario, name: str, t: float) -> Any:
    """initial + rate*t at the working precision of the time of the call."""

    def value() -> arb:
        initial, rate = fixed.prescribed[name]
        a, b = (arb(fmpq(x.numerator, x.denominator)) for x in (initial, rate))
        return a + b * arb(t)

    return value


NASTY = """
mbsym: 1
name: "Evil */ name ??/ \\\\"
parameters: {int: 1, register: 2, y0: 3, NULL: 4, M_PI: 5, s1: 6, q: 7, p: 8, J: real, sin_theta: 2, exp2: 1}
values: {J: sqrt(3)*pi}
bodies:
  - name: rod
    attached to: 0
    rotation: {axes: [3], angles: [theta]}
    mass centre: [int, register*sin_theta, s1]
    mass: y0 + exp2
  - name: second
    attached to: rod
    rotation: {axes: [1], angles: [x]}
    connection point: [q, p, J]
    mass centre: [NULL, M_PI, 0]
    mass: 1
"""


@pytest.mark.skipif(COMPILER is None, reason="no C compiler")
def test_names_that_c_reserves_compile(tmp_path: Path) -> None:
    library = compiled(mbsym.loads(NASTY), tmp_path)
    defaults = (ctypes.c_double * 11).in_dll(library.library, f"{library.prefix}_defaults")
    assert list(defaults) == [1, 2, 3, 4, 5, 6, 7, 8, pytest.approx(3**0.5 * np.pi, rel=1e-15), 2, 1]
    names = (ctypes.c_char_p * 11).in_dll(library.library, f"{library.prefix}_parameter_names")
    assert [name.decode() for name in names][:3] == ["int", "register", "y0"]


def test_proposed_names_are_identifiers() -> None:
    for name in (*RESERVED, "_x", "2a", "theta'", "größe", "a b"):
        assert proposed(name).isidentifier()
        assert proposed(name).isascii()
        assert proposed(name) not in RESERVED


def test_the_source_says_why_there_is_no_code() -> None:
    text = """
mbsym: 1
name: Strange
parameters: {m: positive, l: positive}
bodies:
  - name: rod
    attached to: 0
    rotation: {axes: [3], angles: [theta]}
    mass centre: [l, 0, 0]
    mass: m**(1/3)
"""
    analysis = mbsym.loads(text)
    target = TARGETS["c"]
    for part in (target, *target.companions):
        written = part.render(analysis, ())
        assert "There is no code for the equations of motion: the power 1/3" in written
        assert "_mass_matrix" not in written
