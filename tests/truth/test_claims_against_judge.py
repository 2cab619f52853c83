"""What is said of claimed conditions, and of wholes, against the exact judge at many points, borders included.

Random systems (several parts, damping, gyroscopic and circulatory forces, zero and repeated roots, by A, with singular
M, with a constraint) in two parameters a and b, random conditions.  At every point of a grid, at the given values too:

* a condition that is held to be necessary does not fail where the judge finds the motion stable: "but for border cases"
  it may where its two sides are equal;
* one that is held to be sufficient does not hold where the judge finds it unstable;
* one that is refuted comes with a point at which the judge says so;
* a whole that is called stable is nowhere unstable, and the other way round.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import product
from typing import Any

import pytest

import mbsym
from mbsym.analysis import Analysis
from mbsym.analysis.judge import Judge
from mbsym.problems.claims import ClaimResult, Outcome
from mbsym.problems.claims.regions import Inequality, Region
from mbsym.problems.stability import problem as stability
from mbsym.problems.stability.verdict import Verdict
from mbsym.problems.stability.words import Word
from mbsym.report.words.claims import claim_line

GRID = [Fraction(k, 2) for k in range(-4, 5)]
RELATIONS: dict[str, Any] = {
    ">": lambda x: x > 0,
    ">=": lambda x: x >= 0,
    "<": lambda x: x < 0,
    "<=": lambda x: x <= 0,
    "!=": lambda x: x != 0,
}
ENTRIES = ("a", "b", "a - b", "a + b", "a*b", "1", "0", "a - 1", "b**2", "2", "(a - b)**2", "-1")
HEAD = "mbsym: 1\nname: random\nparameters: {{a: {sign}, b: {sign}}}\nvalues: {{a: 1, b: 1}}\n"
DRIFT = (Word.STABLE_BUT_CYCLIC, Word.ASYMPTOTIC_BUT_CYCLIC)


def body(source: random.Random, kind: str) -> str:
    """A description without its head: what moves, and which forces act."""
    e = [source.choice(ENTRIES) for _ in range(6)]
    if kind == "by A":
        return f"linear system: {{coordinates: [x, y], A: [[{e[0]}, {e[1]}], [{e[2]}, {e[3]}]]}}\n"
    if kind == "matrices":
        return (
            f"linear system: {{coordinates: [x, y], D: [[{e[0]}, 0], [0, {e[1]}]], G: [[0, {e[2]}], [-({e[2]}), 0]], "
            f"K: [[{e[3]}, {e[4]}], [{e[4]}, {e[5]}]]}}\n"
        )
    if kind == "singular":
        return (
            "bodies:\n  - {name: p, mass: 1, connection point: [x, 0, 0], coordinates: [x]}\n"
            "  - {name: q, attached to: p, mass: 0, connection point: [0, y, 0], coordinates: [y]}\n"
            f"loads:\n  - potential: ({e[0]})*x**2/2 + ({e[1]})*y**2/2 + x*y\nmotion: {{}}\n"
        )
    if kind == "constrained":
        return (
            "bodies:\n  - {name: p, mass: 1, connection point: [x, y, z], coordinates: [x, y, z]}\n"
            "constraints:\n  - relation: z = x\n"
            f"loads:\n  - potential: ({e[0]})*x**2/2 + ({e[1]})*y**2/2 + y**4\nmotion: {{}}\n"
        )
    force = {
        "parts": f"  - damper: {{coordinate: x, coefficient: {source.choice(('a**2', 'b**2', '1', 'a'))}}}\n",
        "gyroscopic": f"  - generalized force: {{x: ({e[3]})*y_dot, y: -({e[3]})*x_dot}}\n",
        "circulatory": f"  - generalized force: {{x: ({e[3]})*y, y: -({e[3]})*x}}\n"
        "  - rayleigh: (x_dot**2 + y_dot**2)/2\n",
        "soft": f"  - generalized force: {{x: ({e[3]})*x_dot - x**2*x_dot}}\n",
        "potential": "",
    }[kind]
    mixed = f" + ({e[2]})*x*y" if kind in ("potential", "gyroscopic") else ""
    quartic = source.choice(("", " + x**4 + y**4", " - x**4"))
    return (
        "bodies:\n  - {name: p, mass: 1, connection point: [x, y, 0], coordinates: [x, y]}\n"
        f"loads:\n  - potential: ({e[0]})*x**2/2 + ({e[1]})*y**2/2{mixed}{quartic}\n{force}motion: {{}}\n"
    )


KINDS = ("by A", "matrices", "singular", "constrained", "parts", "gyroscopic", "circulatory", "soft", "potential")


@dataclass(frozen=True)
class Case:
    """A system with its claims (text, relation, role) and what became of them."""

    analysis: Analysis
    claims: tuple[tuple[str, str, str], ...]

    @cached_property
    def judged(self) -> list[tuple[dict[str, Fraction], Verdict]]:
        """The verdict of the exact judge at the given values, and on the grid where the declared signs allow that."""
        a = self.analysis
        judge = stability.ExactVerdicts(a.parameters_scene, a.balance, a.judgeable, a.equilibrium, a.signs)
        beyond, left = Judge(a).decided, 12  # so many open ones are looked into
        positive = a.system.parameters[0].sign == "positive"
        found = []
        for x, y in [(Fraction(1), Fraction(1)), *product(GRID, GRID)]:
            if positive and (x <= 0 or y <= 0):
                continue
            verdict = judge({"a": x, "b": y})
            if verdict.word.open and (x * y == 0 or x == y) and left:
                left -= 1
                verdict = beyond(verdict, {"a": x, "b": y})
            found.append(({"a": x, "b": y}, verdict))
        return found

    def contradictions(self) -> Iterator[str]:
        whole = self.analysis.stability.verdict.word
        for point, verdict in self.judged:
            if (whole.stable and verdict.word is Word.UNSTABLE) or (whole is Word.UNSTABLE and is_stable(verdict)):
                yield f"the whole is {whole.value}, at {point} it is {verdict.word.value}"
        for (text, relation, role), result in zip(self.claims, self.analysis.claims, strict=True):
            for wrong in self._of_claim(text, relation, role, result):
                yield f"{claim_line(result)}: {wrong}"

    def _of_claim(self, text: str, relation: str, role: str, result: ClaimResult) -> Iterator[str]:
        for point, verdict in self.judged:
            gap = value(text, point)
            holds = RELATIONS[relation](gap)
            if result.holds and role == "sufficient" and holds and verdict.word is Word.UNSTABLE:
                yield f"unstable with it at {point}"
            exempt = result.outcome == Outcome.BORDERS and gap == 0
            if result.holds and role == "necessary" and not holds and not exempt and is_stable(verdict):
                yield f"stable without it at {point}"
        if result.outcome == Outcome.FAILS and result.counterexample is not None:
            at = {name: Fraction(x) for name, x in result.counterexample.at}
            judge = self.analysis.trials
            again = judge._verdict_at(at)
            again = judge._decided_at(again, at) if again.word.open else again
            if RELATIONS[relation](value(text, at)) is not (role == "sufficient"):
                yield f"{at} does not refute it"
            if again.word is not result.counterexample.word:
                yield f"the judge says {again.word.value} at {at}"


def is_stable(verdict: Verdict) -> bool:
    """Solutions x0 + x1 t of what is cyclic at some parameters only are no stable motion."""
    return verdict.stable and verdict.word not in DRIFT


def value(text: str, point: dict[str, Fraction]) -> Fraction:
    return Fraction(eval(text, {"__builtins__": {}}, dict(point)))


def case(source: random.Random, kind: str) -> Case:
    described = HEAD.format(sign=source.choice(("real", "real", "positive"))) + body(source, kind)
    written = []
    for _ in range(4):
        one, other = source.choice(ENTRIES[:5]), source.choice((*ENTRIES[:5], "1", "0"))
        text = source.choice((f"({one}) - ({other})", one, f"({one})*(a - b)**2", f"-({one})"))
        if text in ("(1) - (1)", "(0) - (0)"):
            text = "a"
        written.append((text, source.choice((">", ">", ">=", "!=", "<")), source.choice(("necessary", "sufficient"))))
    lines = "".join(f'  - {{claim: condition, that: "{t} {r} 0", as: {role}}}\n' for t, r, role in written)
    return Case(mbsym.loads(described + "claims:\n" + lines, (6,)), tuple(written))


def cases(kind: str, count: int) -> Iterator[Case]:
    source = random.Random(f"claims against the judge: {kind}")
    for _ in range(count):
        yield case(source, kind)


@pytest.mark.parametrize("kind", KINDS)
def test_no_verdict_contradicts_what_is_said(kind: str) -> None:
    outcomes = []
    for one in cases(kind, 4):
        assert not list(one.contradictions()), one.analysis.system
        outcomes += [result.outcome for result in one.analysis.claims]
    assert len({*outcomes}) > (kind != "singular")  # where M is singular, nothing is decided


def test_a_raised_place_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Conditions that are necessary but for the case of equality, told as necessary."""
    true = Region.without

    def raised(self: Region, wanted: Inequality, bodies: bool = False) -> Verdict:
        return true(self, replace(wanted, relation=">=") if wanted.relation == ">" else wanted, bodies)

    monkeypatch.setattr(Region, "without", raised)
    text = HEAD.format(sign="real") + (
        "bodies:\n  - {name: p, mass: 1, connection point: [x, 0, 0], coordinates: [x]}\n"
        "loads:\n  - potential: (a - b)*x**2/2 + x**4\nmotion: {}\nclaims:\n"
        '  - {claim: condition, that: "a - b > 0", as: necessary}\n'
    )
    found = Case(mbsym.loads(text, (6,)), (("a - b", ">", "necessary"),))
    assert any("stable without it" in wrong for wrong in found.contradictions())


def test_a_lost_part_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is sufficient for one part, told of the whole (and nothing tried that would refute it)."""
    true = Region.__init__

    def losing(self: Region, *arguments: Any, **named: Any) -> None:
        true(self, *arguments, **named)
        self.parts = self.parts[:1]

    monkeypatch.setattr(Region, "__init__", losing)
    monkeypatch.setattr("mbsym.problems.claims.counterexample.VERDICTS", 0)
    text = HEAD.format(sign="real") + (
        "bodies:\n  - {name: p, mass: 1, connection point: [x, y, 0], coordinates: [x, y]}\n"
        "loads:\n  - potential: a*x**2/2 + b*y**2/2\nmotion: {}\nclaims:\n"
        '  - {claim: condition, that: "a > 0", as: sufficient}\n'
    )
    found = Case(mbsym.loads(text, (6,)), (("a", ">", "sufficient"),))
    assert any("unstable with it" in wrong for wrong in found.contradictions())


def test_a_drift_at_a_border_is_told_where_a_claim_is_judged_by_it() -> None:
    """m x'' = -k (x - y), M y'' = k (x - y): for k > 0 only x + y drifts, for k = 0 so does x - y.

    Both are "stable but for a drift of cyclic coordinates": why k >= 0 does not suffice, and k > 0 is needed, is told.
    """
    text = """
mbsym: 1
name: free dumbbell
parameters: {m: positive, M: positive, k: real}
bodies:
  - {name: p, attached to: 0, mass: m, connection point: [x, 0, 0], coordinates: [x]}
  - {name: q, attached to: 0, mass: M, connection point: [y, 0, 0], coordinates: [y]}
loads:
  - potential: k*(x - y)**2/2
motion: {}
values: {m: 1, M: 2, k: 0}
claims:
  - {claim: condition, that: k > 0, as: necessary}
  - {claim: condition, that: k >= 0, as: sufficient}
"""
    needed, enough = mbsym.loads(text).claims
    assert "cyclic there only drift away" in str(needed.remark)
    assert enough.outcome == Outcome.FAILS
    assert enough.counterexample is not None
    assert "cyclic there only" in str(enough.counterexample.shows[-1][1])
