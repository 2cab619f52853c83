"""What is printed of problems 4 to 6 can be evaluated from that surface alone, and is as true as the value behind it.

Terminal, LaTeX, HTML, JSON and Wolfram are read back (``printed_stability``) and evaluated at random rational points,
each from its own text alone: how it writes the parameters, and which letters it defines.  Behind them stand the exact
polynomials.  ``MBSYM_READ_BACK=300`` reads so many random systems.
"""

from __future__ import annotations

import os
import random
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import printed_stability as printed
import pytest
from conftest import SHIPPED, TESTS, derived, precision, with_letters
from flint import arb, fmpq
from printed_stability import Part, Read, TwoMeanings, WithVariable, bare, both, truth
from terminal import told

import mbsym
from mbsym.algebra.ring import ParameterRing, Ring
from mbsym.analysis import Analysis
from mbsym.formulas import latex, mathml
from mbsym.formulas.latex import LatexNames
from mbsym.formulas.mathml import MathNames
from mbsym.formulas.wolfram import wolfram_names
from mbsym.problems.stability.problem import SubsystemStability
from mbsym.problems.stability.requirements import Case, Requirement
from mbsym.problems.stability.words import Word
from mbsym.report import conditions
from mbsym.report.conditions import Shown
from mbsym.report.plain_writer import Line, Writer
from mbsym.report.targets import TARGETS

MANY = int(os.environ.get("MBSYM_READ_BACK", "16"))
POINTS = 12
STATEMENTS = TESTS / "cases" / "statements"
PARTS: dict[str, Callable[[str], list[Part]]] = {
    "terminal": printed.of_terminal,
    "latex": printed.of_latex,
    "html": printed.of_html,
    "json": printed.of_json,
    "wolfram": printed.of_wolfram,
}


# --- what stands behind ---------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Point:
    """A number for every name of a part's ring: rational where the ring holds nothing but parameters."""

    part: SubsystemStability
    values: Mapping[str, Any]

    def __call__(self, polynomial: Any) -> Any:
        ring = self.part.ring
        if isinstance(ring, ParameterRing):
            return polynomial(*(self.values[g.name] for g in ring.generators))
        return ring.evaluate(polynomial, dict(self.values))

    def holds(self, requirement: Requirement) -> bool | None:
        """As it arises."""
        return truth(self(requirement.polynomial), requirement.relation)

    def reduced(self, requirement: Requirement) -> bool | None:
        """Without what is known of its sign: physical conditions, say, that these numbers may not fulfil."""
        condition = requirement.condition
        if condition.kind in ("always", "never", "unwritten") or requirement.by_mass:
            return {"never": False, "unwritten": None}.get(condition.kind, True)
        first = [truth(self(condition.polynomial), requirement.relation)] if condition.kind == "inequality" else []
        return both([*first, *(truth(self(p), "!=") for p in condition.nonzero)], [])


def points(analysis: Analysis, part: SubsystemStability, source: random.Random) -> Iterator[Point]:
    """Small rationals, zero among them, which the declared signs and the kinetic energy admit."""
    signs = {item.name: item.sign for item in analysis.system.parameters}
    for _ in range(POINTS):
        values = {}
        for name in part.ring.names():
            number = fmpq(source.randint(-6, 6), source.randint(1, 3))
            sign = signs.get(name, "real")
            if sign != "real":
                number = (abs(number) or fmpq(1)) * (-1 if sign in ("negative", "nonpositive") else 1)
            values[name] = number if isinstance(part.ring, ParameterRing) else arb(number)
        here = Point(part, values)
        if all(here.holds(r) for r in part.theory.requirements if r.by_mass):
            yield here


def cases_behind(part: SubsystemStability) -> list[Case]:
    """Those that can occur, up to one that always does; nothing is told of one that is not an alternative."""
    found = [case for case in part.theory.cases if not case.never]
    certain = next((k for k, case in enumerate(found) if case.always), len(found))
    return [] if certain == 0 else found[: certain + 1]


# --- each surface ---------------------------------------------------------------------------------------------------


def rendered(analysis: Analysis, surface: str) -> str:
    if surface == "terminal":
        return "\n".join(x for n in (4, 5, 6) for x in (f"Problem {n}.", *told(analysis, n, longest=10**6)))
    text = TARGETS[surface].render(analysis, (4, 5, 6))
    assert isinstance(text, str)
    return text


def exact(value: Fraction) -> fmpq:
    return fmpq(value.numerator, value.denominator)


def written(ring: Ring, surface: str, here: Mapping[str, Any]) -> dict[str, Any]:
    """Values by symbols, as the surface writes the names of a ring; no two of them are written alike."""
    in_latex, in_mathml, in_wolfram = LatexNames.of(ring), MathNames.of(ring), wolfram_names(ring)
    symbol: Callable[[str], str] = {
        "latex": lambda name: "".join(str(in_latex[name]).split()),
        "html": lambda name: printed.mathml_symbol(str(in_mathml[name])),
        "wolfram": lambda name: printed.wolfram_symbol(in_wolfram[name]),
    }.get(surface, lambda name: name)
    found: dict[str, Any] = {}
    for name, value in here.items():
        if surface == "wolfram" and name not in in_wolfram.table:
            continue  # a letter of the description: there formulas are in parameters
        if symbol(name) in found:
            raise TwoMeanings(name)
        found[symbol(name)] = value
    return found


def check(analysis: Analysis, surface: str) -> int:
    """Compares what is printed with what stands behind it; how many values and verdicts were compared."""
    text = rendered(analysis, surface)
    source = random.Random(analysis.system.name)
    compared = _check_equations(analysis, surface, text, source) + _check_matrices(analysis, surface, text, source)
    parts = PARTS[surface](text)
    for number, part in enumerate(analysis.stability.subsystems):
        for here in points(analysis, part, source):
            values = with_letters(analysis.system, dict(here.values), exact)
            compared += _check_at(parts[number], part, here, written(part.ring, surface, values), surface)
    return compared


def _check_equations(analysis: Analysis, surface: str, text: str, source: random.Random) -> int:
    """The conditions of problem 4 are those behind it."""
    behind, ring = analysis.equilibrium.conditions, analysis.ring
    shown = printed.equations(surface, text)
    assert len(shown) == len(behind), surface
    here = {name: arb(fmpq(source.randint(1, 40), 16)) for name in ring.names()} if behind else {}
    here = with_letters(analysis.system, here, exact)
    for formula, value in zip(behind, shown, strict=True):
        wanted = ring.evaluate(formula.polynomial, dict(here))
        assert value is None or _same(value(written(ring, surface, here)), wanted), f"{surface}: {formula}"
    return len(behind)


def _check_matrices(analysis: Analysis, surface: str, text: str, source: random.Random) -> int:
    """The matrices of problem 5, in which what is not written is zero."""
    linear, ring = analysis.linearisation, analysis.ring
    shown = printed.matrices(surface, text)
    here = {name: arb(fmpq(source.randint(1, 40), 16)) for name in ring.names()}
    here = with_letters(analysis.system, here, exact)
    names, compared = written(ring, surface, here), 0
    for letter in "MDGKN":
        told = shown.get(letter, {})
        for i, row in enumerate(getattr(linear, letter), 1):
            for j, entry in enumerate(row, 1):
                value = told.get((i, j)) or (told.get((j, i)) if letter in "MDK" else None)
                wanted = ring.evaluate(entry.polynomial, dict(here))
                said = arb(0) if value is None else arb(value(names))
                assert _same(said, wanted), f"{surface}: {letter}{i}{j} is {said}, not {wanted}"
                compared += value is not None
    return compared


def _same(x: Any, y: Any) -> bool:
    return bool(abs(x - y) < arb("1e-30") * (1 + abs(y))) if isinstance(x - y, arb) else x == y


def _label_of(value: Any, part: SubsystemStability, here: Point, surface: str) -> str:
    """Of the requirement that a formula without a label is."""
    for one in part.theory.requirements:
        if any(_same(value, here(p)) for p in one.polynomials):
            return one.label
    raise AssertionError(f"{surface}: no condition is {value}")


def _check_at(shown: Part, part: SubsystemStability, here: Point, names: Mapping[str, Any], surface: str) -> int:
    compared = 0
    wanted = {r.label: r for r in part.theory.requirements}
    reading = Read(names, shown)
    told: dict[str, list[bool | None]] = {}
    for line in shown.lines:
        value = reading.value(line)
        if not line.label and value is not None and surface != "wolfram":
            line.label = _label_of(value, part, here, surface)
        told.setdefault(bare(line.label), []).append(None if value is None else truth(value, line.relation))
        if value is None or not line.label or line.under or line.alone in reading.letters:
            continue
        exact = [here(p) for p in wanted[bare(line.label)].polynomials]
        assert any(_same(value, x) for x in exact), f"{surface}: {line.label} is {value}, not {exact}"
        compared += 1
    for label, truths in told.items():
        said = both(truths, [])
        if label:
            behind = here.holds(wanted[label]), here.reduced(wanted[label])
        else:  # Wolfram's lists are without labels, and complete
            listed = [r for r in part.theory.requirements if not r.always]
            behind = both(list(map(here.holds, listed)), []), both(list(map(here.reduced, listed)), [])
        assert None in (said, *behind) or said in behind, f"{surface}: {label} is printed {said}, and is {behind}"
        compared += 1
    if shown.polynomial is not None:
        root = fmpq(3, 2) if not any(isinstance(x, arb) for x in here.values.values()) else arb(fmpq(3, 2))
        value = shown.polynomial(WithVariable(names, root))
        zero = part.theory.zero_power
        exact_value = sum((here(x) * root ** (k + zero) for k, x in enumerate(part.theory.polynomial)), root * 0)
        assert _same(value, exact_value), f"{surface}: characteristic polynomial {value}, not {exact_value}"
        compared += 1
        if shown.factors:  # up to a number they make up what is left of it
            ratios = []
            for x in (root, root + 1, root - 3):
                at = WithVariable(names, x)
                product = root * 0 + 1
                for factor, times in shown.factors:
                    product *= factor(WithVariable(names, x)) ** times
                ratios.append((product * x**zero, shown.polynomial(at)))
            (p, q), *others = ratios
            assert all(_same(p * y, q * x) for x, y in others), f"{surface}: factors"
    told_cases = [case for case in shown.cases if surface != "json" or cases_behind(part)]
    if surface in ("terminal", "latex", "html", "json"):
        behind_cases = cases_behind(part)
        listed = iter([*(x.verdict.word.value for x in behind_cases), *([Word.UNDECIDED] * part.theory.uncovered)])
        assert all(x.word in listed for x in told_cases), f"{surface}: the cases stand in another order"
        truths = [reading.case(case) for case in told_cases]
        whole = len(told_cases) == len(behind_cases) + part.theory.uncovered  # then the very case can be compared
        said = first([f"{k * whole} {x.word}" for k, x in enumerate(told_cases)], truths)
        behind = [
            first(
                [f"{k * whole} {x.verdict.word.value}" for k, x in enumerate(behind_cases)],
                [both(list(map(one, real.all_of)), list(map(one, real.any_of))) for real in behind_cases],
            )
            for one in (here.holds, here.reduced)
        ]
        assert "" in (said, *behind) or said in behind, f"{surface}: the cases say {said}, those behind them {behind}"
        compared += len(told_cases)
    return compared


def first(words: Sequence[str], truths: Sequence[bool | None]) -> str:
    """What cases, read in order, say at a point: what one that holds does, or undecided; "" where that is not known."""
    for word, holds in zip(words, truths, strict=True):
        if holds is not False:
            return ("undecided" if word.endswith(" undecided") else word) if holds else ""
    return "undecided"


# --- systems ----------------------------------------------------------------------------------------------------------

NAMES = ("v0", "a1", "lam", "c2", "m_1", "v_2", "k", "v4", "a", "nu", "Lambda", "a_0")


def random_system(seed: int) -> str:
    """A linear system by matrices, or points in a plane with springs, dampers, gyroscopic and circulatory forces."""
    source = random.Random(seed)
    names = source.sample(NAMES, source.choice((2, 2, 3)))
    n = source.choice((1, 2, 2, 2, 3))

    def entry() -> str:
        x, y = source.choice(names), source.choice(names)
        return source.choice((x, x, y, f"{x} - {y}", f"{x} + 1", f"2*{x}", f"{x}*{y}", f"{x}**2", "1", "0", "3/2"))

    def symmetric(full: bool) -> list[list[str]]:
        rows = [["0"] * n for _ in range(n)]
        for i in range(n):
            for j in range(i + 1):
                if i == j or (full and source.random() < 0.6):
                    rows[i][j] = rows[j][i] = entry()
        return rows

    def skew() -> list[list[str]]:
        rows = [["0"] * n for _ in range(n)]
        for i in range(n):
            for j in range(i):
                rows[i][j] = entry()
                rows[j][i] = f"-({rows[i][j]})"
        return rows

    matrices = {"K": symmetric(True)}
    if source.random() < 0.5:
        matrices["D"] = symmetric(source.random() < 0.3)
    if n > 1 and source.random() < 0.6:
        matrices["G"] = skew()
    if n > 1 and source.random() < 0.3:
        matrices["N"] = skew()
    signs = ", ".join(f"{name}: {source.choice(('real', 'real', 'positive'))}" for name in names)
    head = f"mbsym: 1\nname: random {seed}\nparameters: {{{signs}}}\n"
    q = [f"x{i}" for i in range(n)]
    if seed % 3:
        shown = "".join(f"  {name}: {_listed(_listed(row) for row in rows)}\n" for name, rows in matrices.items())
        return f"{head}linear system:\n  coordinates: [{', '.join(q)}]\n{shown}"
    away = f"({names[0]}*{names[1]} - {names[1]}**2)*x0 + " if source.random() < 0.3 else ""
    return head + _tree(q, matrices, away)


def _listed(items: Iterable[str]) -> str:
    return f"[{', '.join(items)}]"


def _tree(q: list[str], matrices: Mapping[str, list[list[str]]], away: str) -> str:
    """The same forces on unit masses, one after the other along a line, with quartic springs besides."""

    def form(rows: list[list[str]], of: list[str]) -> str:
        n = range(len(of))
        return " + ".join(f"({rows[i][j]})*{of[i]}*{of[j]}/2" for i in n for j in n if rows[i][j] != "0") or "0"

    rates = [f"{x}_dot" for x in q]
    bodies = "".join(
        f"  - {{name: p{k}, attached to: 0, mass: 1, connection point: [{x}, {k}, 0], coordinates: [{x}]}}\n"
        for k, x in enumerate(q)
    )
    loads = f'  - potential: "{form(matrices["K"], q)} + {away}x0**4"\n'
    if "D" in matrices:
        loads += f'  - rayleigh: "{form(matrices["D"], rates)}"\n'
    shares = [
        " ".join(
            f"- ({matrices[m][i][j]})*{v[j]}"
            for m, v in (("G", rates), ("N", q))
            if m in matrices
            for j in range(len(q))
            if matrices[m][i][j] not in ("0", "-(0)")
        )
        for i in range(len(q))
    ]
    if any(shares):
        loads += (
            "  - generalized force: {" + ", ".join(f'{x}: "{s}"' for x, s in zip(q, shares, strict=True) if s) + "}\n"
        )
    return f"bodies:\n{bodies}loads:\n{loads}motion: {{{', '.join(f'{x}: 0' for x in q)}}}\n"


# --- the law ----------------------------------------------------------------------------------------------------------

FILES = [
    *(SHIPPED / f"{name}.yaml" for name in (
        "satellite", "heavy-top", "double-pendulum", "ziegler", "ziegler-damped", "gyroscopic-pair",
        "triangular-points", "gravity-gradient", "satellite-with-gyroscope", "rolling-disc", "spherical-pendulum",
        "orbital-gyrostat", "cart-pendulum",
    )),
    *(STATEMENTS / f"{name}.yaml" for name in (
        "bead_on_hoop", "bowl", "earnshaw", "foucault2", "gov_A", "necessary-at-border", "never_hurwitz", "soft",
        "strict_border", "two_parts", "whole_dep", "far", "staude2",
    )),
]  # fmt: skip


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_files_are_read_back(path: Path) -> None:
    analysis = derived(path)
    with precision(400):
        for surface in PARTS:
            check(analysis, surface)


@pytest.mark.parametrize("seed", range(MANY))
def test_random_systems_are_read_back(seed: int) -> None:
    analysis = mbsym.loads(random_system(seed))
    for surface in PARTS:
        check(analysis, surface)


# --- planted lies -----------------------------------------------------------------------------------------------------

#: Three coupled gyroscopic coordinates, the discriminant of which is told in coefficients; v_2 looks like one.
LONG = """
mbsym: 1
name: a discriminant in coefficients
parameters: {v_2: real, k: real, b: real, s: real}
linear system:
  coordinates: [x, y, z]
  G: [[0, -b, 0], [b, 0, -s], [0, s, 0]]
  K: [[4*k, k, s], [k, v_2, 1], [s, 1, b]]
"""


def no_letters(patch: pytest.MonkeyPatch) -> None:
    """The form in coefficients is shown without them."""
    patch.setattr(Shown, "unshown", lambda self, told: ())


def two_meanings(patch: pytest.MonkeyPatch) -> None:
    """Nobody looks whether a letter is a parameter, too."""
    patch.setattr(conditions, "names_in", lambda ring: frozenset())


def lost_factor(patch: pytest.MonkeyPatch) -> None:
    """The first of several factors is not written."""
    joined = latex._joined
    patch.setattr(latex, "_joined", lambda factors: joined(factors[1:] or factors))


def lost_sign(patch: pytest.MonkeyPatch) -> None:
    """Minus is written as plus."""
    mo = mathml.mo
    patch.setattr(mathml, "mo", lambda sign, first=False: mo(sign.replace("\u2212", "+"), first))


def turned(patch: pytest.MonkeyPatch) -> None:
    """> is written as <."""
    line = Writer._line

    def other(self: Writer, *parts: Any, **how: Any) -> Line:
        return Line(tuple((text.replace(">", "<"), style) for text, style in line(self, *parts, **how).parts))

    patch.setattr(Writer, "_line", other)


def turned_reference(patch: pytest.MonkeyPatch) -> None:
    """What refers to a label forgets that the sign has changed."""
    patch.setattr(conditions, "OPPOSITE", {})


LIES = [
    (no_letters, "terminal", NameError),
    (no_letters, "latex", NameError),
    (no_letters, "html", NameError),
    (two_meanings, "latex", TwoMeanings),
    (two_meanings, "html", TwoMeanings),
    (lost_factor, "latex", AssertionError),
    (lost_sign, "html", AssertionError),
    (turned, "terminal", AssertionError),
    (turned_reference, "latex", AssertionError),
    (turned_reference, "html", AssertionError),
    (turned_reference, "json", AssertionError),
]


@pytest.mark.parametrize(("lie", "surface", "caught"), LIES, ids=lambda x: getattr(x, "__name__", x))
def test_planted_lies_are_caught(
    lie: Callable[[pytest.MonkeyPatch], None], surface: str, caught: type[Exception], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert check(mbsym.loads(LONG), surface) > 0
    lie(monkeypatch)
    with pytest.raises(caught):
        check(mbsym.loads(LONG), surface)


@pytest.mark.parametrize("surface", ["latex", "html"])
def test_no_words_speak_of_the_variable_by_another_letter(surface: str) -> None:
    """Where a parameter is called lambda the polynomial is one in mu; words, the same everywhere, name none."""
    text = rendered(mbsym.loads(LONG.replace("v_2", "lam")), surface)
    assert {"latex": r"(\mu)", "html": "<mi>\u03bc</mi>"}[surface] in text
    assert "all squares of roots real, negative and simple" in text
    assert "lambda^" not in text
