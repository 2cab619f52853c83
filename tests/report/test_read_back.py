"""Whatever is printed of problem 6 can be evaluated from what is printed on that surface, and is as true as the value.

Terminal, LaTeX, HTML, JSON and Wolfram are read back (``printed_stability``) and evaluated at random rational points,
each from its own text alone: how it writes the parameters, and which letters it defines.  Behind them stand the exact
polynomials.  ``MBSYM_READ_BACK=300`` reads so many random systems.
"""

from __future__ import annotations

import os
import random
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import printed_stability as printed
import pytest
from conftest import SHIPPED, TESTS, derived, precision
from flint import arb, fmpq
from printed_stability import Part, Read, TwoMeanings, WithVariable, bare, both, truth

import mbsym
from mbsym.algebra.ring import ParameterRing
from mbsym.analysis import Analysis
from mbsym.formulas.latex import latex_names
from mbsym.formulas.mathml import mathml_names
from mbsym.formulas.wolfram import wolfram_names
from mbsym.problems.stability import SubsystemStability
from mbsym.problems.stability.requirements import Requirement
from mbsym.report import conditions
from mbsym.report.conditions import Shown
from mbsym.report.sections import stability
from mbsym.report.targets import TARGETS

MANY = int(os.environ.get("MBSYM_READ_BACK", "16"))
POINTS = 12
STATEMENTS = TESTS / "cases" / "statements"
SURFACES = ("terminal", "latex", "html", "json", "wolfram")


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


def verdict_behind(part: SubsystemStability, holds: Callable[[Requirement], bool | None]) -> str | None:
    """The first case that applies; "?" where a ball does not tell."""
    for case in part.theory.cases:
        found = both(list(map(holds, case.all_of)), list(map(holds, case.any_of)))
        if found is None:
            return "?"
        if found:
            return case.verdict.word.value
    return None


# --- each surface ---------------------------------------------------------------------------------------------------


def _named(written: Mapping[str, str], here: Point) -> dict[str, Any]:
    """Values by symbols; no two names are written alike."""
    found: dict[str, Any] = {}
    for name, symbol in written.items():
        if symbol in found:
            raise TwoMeanings(symbol)
        found[symbol] = here.values[name]
    return found


def read(analysis: Analysis, surface: str) -> tuple[list[Part], Callable[[SubsystemStability], dict[str, str]]]:
    """The parts that a surface prints, and how it writes the names of a part."""
    found = analysis.stability
    if surface == "terminal":
        parts = printed.of_terminal(list(stability.lines(found, analysis)))
        return parts, lambda part: {name: name for name in part.ring.names()}
    text = TARGETS[surface].render(analysis, (4, 6))
    assert isinstance(text, str)
    match surface:
        case "json":
            return printed.of_json(text), lambda part: {name: name for name in part.ring.names()}
        case "latex":
            return printed.of_latex(text), lambda part: {
                name: "".join(str(latex_names(part.ring)[name]).split()) for name in part.ring.names()
            }
        case "html":
            return printed.of_html(text), lambda part: {
                name: printed.mathml_symbol(str(mathml_names(part.ring)[name])) for name in part.ring.names()
            }
    return printed.of_wolfram(text), lambda part: {
        name: printed.wolfram_symbol(wolfram_names(part.ring)[name]) for name in part.ring.names()
    }


def check(analysis: Analysis, surface: str) -> int:
    """Compares what is printed with what stands behind it; how many values and verdicts were compared."""
    parts, written = read(analysis, surface)
    compared = 0
    source = random.Random(analysis.system.name)
    for number, part in enumerate(analysis.stability.subsystems):
        for here in points(analysis, part, source):
            compared += _check_at(parts[number], part, here, _named(written(part), here), surface)
    return compared


def _same(x: Any, y: Any) -> bool:
    return bool(abs(x - y) < arb("1e-30") * (1 + abs(y))) if isinstance(x - y, arb) else x == y


def _check_at(shown: Part, part: SubsystemStability, here: Point, names: Mapping[str, Any], surface: str) -> int:
    compared = 0
    wanted = {r.label: r for r in part.theory.requirements}
    reading = Read(names, shown)
    told: dict[str, list[bool | None]] = {}
    for line in shown.lines:
        value = reading.value(line)
        told.setdefault(bare(line.label), []).append(None if value is None else truth(value, line.relation))
        if value is None or not line.label:
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
    if shown.cases:
        words = verdict_behind(part, here.holds), verdict_behind(part, here.reduced)
        said_word = _verdict(reading, shown)
        assert "?" in (said_word, *words) or said_word in words, f"{surface}: {said_word} by its cases, and is {words}"
        compared += 1
    return compared


def _verdict(reading: Read, shown: Part) -> str | None:
    for case in shown.cases:
        found = reading.case(case)
        if found is None:
            return "?"
        if found:
            return case.word
    return None


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
    return head + _tree(q, matrices)


def _listed(items: Iterable[str]) -> str:
    return f"[{', '.join(items)}]"


def _tree(q: list[str], matrices: Mapping[str, list[list[str]]]) -> str:
    """The same forces on unit masses, one after the other along a line, with quartic springs besides."""

    def form(rows: list[list[str]], of: list[str]) -> str:
        n = range(len(of))
        return " + ".join(f"({rows[i][j]})*{of[i]}*{of[j]}/2" for i in n for j in n if rows[i][j] != "0") or "0"

    rates = [f"{x}_dot" for x in q]
    bodies = "".join(
        f"  - {{name: p{k}, attached to: 0, mass: 1, connection point: [{x}, {k}, 0], coordinates: [{x}]}}\n"
        for k, x in enumerate(q)
    )
    loads = f'  - potential: "{form(matrices["K"], q)} + x0**4"\n'
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
        loads += "  - generalized force: {" + ", ".join(f'{x}: "{s}"' for x, s in zip(q, shares) if s) + "}\n"
    return f"bodies:\n{bodies}loads:\n{loads}motion: {{{', '.join(f'{x}: 0' for x in q)}}}\n"


# --- the law ----------------------------------------------------------------------------------------------------------

FILES = [
    *(SHIPPED / f"{name}.yaml" for name in (
        "satellite", "heavy-top", "double-pendulum", "ziegler", "ziegler-damped", "gyroscopic-pair",
        "triangular-points", "gravity-gradient", "satellite-with-gyroscope", "rolling-disc",
    )),
    *(STATEMENTS / f"{name}.yaml" for name in (
        "bead_on_hoop", "bowl", "earnshaw", "foucault2", "gov_A", "necessary-at-border", "never_hurwitz", "soft",
        "strict_border", "two_parts", "whole_dep",
    )),
]  # fmt: skip


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_files_are_read_back(path: Path) -> None:
    analysis = derived(path)
    with precision(400):
        for surface in SURFACES:
            check(analysis, surface)


@pytest.mark.parametrize("seed", range(MANY))
def test_random_systems_are_read_back(seed: int) -> None:
    analysis = mbsym.loads(random_system(seed))
    for surface in SURFACES:
        check(analysis, surface)
