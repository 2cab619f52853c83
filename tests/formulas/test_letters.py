"""Formulas in an author's letters: exact, shorter, explained; the same on every surface.

Expected formulas are derived by hand or stand in tests/references; lengths are those of ``size``.
"""

from __future__ import annotations

import random
import re
from pathlib import Path
from typing import Any

import pytest
from conftest import SHIPPED, filed, invoked, parsed
from flint import fmpq

import mbsym
from mbsym.algebra.base import Lowering
from mbsym.algebra.elimination import eliminate
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.analysis.expanding import expansion
from mbsym.formulas import letters as module
from mbsym.formulas.formula import Formula
from mbsym.formulas.letters import Letters, Rewriter, letters_as, rewriter, size
from mbsym.report.letters import in_letters, letters_of
from mbsym.report.words.expansion_words import coefficients

PARAMETERS = ("a", "b", "c", "k", "m", "l", "J")


def ring_of(*coordinates: str) -> Ring:
    return Ring(coordinates, [], PARAMETERS, dict.fromkeys(coordinates, 1), positive=PARAMETERS, spare=24)


def lowered(ring: Ring, text: str) -> Polynomial:
    return ring.reduce(Lowering(ring, module._named(ring))(parsed(text)))


def letters(asked: tuple[str, ...] | None = None, **given: str) -> Letters:
    return Letters(tuple((name, parsed(value)) for name, value in given.items()), asked)


def written(formula: str, asked: tuple[str, ...] | None = None, **given: str) -> tuple[str, set[str]]:
    ring = ring_of("x")
    with letters_as(letters(asked, **given)) as used:
        return str(Formula(ring, lowered(ring, formula))), used


@pytest.mark.parametrize(
    ("formula", "given", "expected"),
    [
        # (m l^2 + J) x'' + k x with I = m l^2 + J, by eliminating J
        ("(m*l**2 + J)*x_ddot + k*x", {"I": "m*l**2 + J"}, "I*x_ddot + k*x"),
        # k/m with w = k/m stands alone; nothing of m or k is left over
        ("k/m*x + k**2/m**2*a", {"w": "k/m"}, "w*(w*a + x)"),
        # two levels: p1 = d/f with d = m l^2, f = J + d
        ("(J + m*l**2)*x_ddot + m*l**2*(c + k)*x", {"d": "m*l**2", "f": "J + d"}, "f*x_ddot + d*(c + k)*x"),
        # a**2 + b**2 = G in even powers only
        ("(a**2 + b**2)**2*c + (a**2 + b**2)*x", {"G": "a**2 + b**2"}, "G*(G*c + x)"),
        # a root of a square: sqrt(m k)/m = w, and no sqrt(w**2)
        ("c*sqrt(m*k)/m + x*sqrt(m*k)/m", {"w": "sqrt(k/m)"}, "w*(x + c)"),
        ("l*sqrt(b**2*k/m)", {"w": "sqrt(k/m)"}, "w*b*l"),
        # a tenth is saved, and nothing is left of c and k
        ("c**2*l**5*J**4*x*(25 - 4*x**2)/(256*k**2)", {"beta": "c/k"}, "beta**2*J**4*l**5*x*(5 - 2*x)*(2*x + 5)/256"),
        # of c and k k is left: all the same it would save a tenth only
        ("c*l**5*J**4*x*(k - 4*x**2)/(256*k)", {"beta": "c/k"}, "c*J**4*l**5*x*(k - 4*x**2)/(256*k)"),
        # a root: s = sqrt(a^2 - 4 b)
        ("c*sqrt(a**2 - 4*b) + k*x*sqrt(a**2 - 4*b)", {"s": "sqrt(a**2 - 4*b)"}, "s*(k*x + c)"),
        # 1 - 4 b/a^2 under a sine is nobody's business; c x stays as it is
        ("c*x", {"s": "sqrt(a**2 - 4*b)", "I": "m*l**2 + J"}, "c*x"),
    ],
)
def test_formulas_are_rewritten_where_that_is_shorter(formula, given, expected):
    assert str(Formula(*_both(expected, given))) == written(formula, **given)[0]


def _both(expected: str, given: dict[str, str]) -> tuple[Ring, Polynomial]:
    """The expected formula over a ring that has the letters, so that it is printed as any other."""
    ring = ring_of("x")
    wide = rewriter(ring, letters(**given)).ring
    return wide, wide.reduce(Lowering(wide, module._named(wide))(parsed(expected)))


def test_letters_that_were_asked_for_take_out_a_symbol_even_where_that_is_longer():
    """k = lam - (a - 1) b put into c k + a b: longer, but asked for."""
    given = {"lam": "(a - 1)*b + k"}
    text, used = written("c*k + a*b", ("lam",), **given)
    assert written("c*k + a*b", **given)[1] == set()
    assert used == {"lam"}
    assert eval(text, {"c": 7, "lam": 5, "a": 3, "b": 2}) == 7 * (5 - 2 * 2) + 3 * 2
    assert written("c*k + a*b", ("lam", "k"), **given)[1] == set()  # what is named beside letters stays


def test_letters_that_were_not_asked_for_are_not_brought_in():
    """f = J + d, d = m l^2: with f alone it is f x, not (J + d) x."""
    given = {"d": "m*l**2", "f": "J + d"}
    assert written("(J + m*l**2)*x", ("f",), **given) == ("f*x", {"f"})
    assert written("m*l**2*x", ("f",), **given)[1] == set()


def test_what_both_sides_of_a_definition_share_is_not_put_to_zero():
    """rho (1 - W) = 1 + B - c/b is  (a + b - 1 - c) (rho (1 + c) - a) = 0, which says nothing of a + b = 1 + c."""
    given = {"B": "(a - 1)/b", "W": "(1 - b + c)*(1 - a + c)/(a*b)", "rho": "(1 + B - c/b)/(1 - W)"}
    text, _ = written("a*x/(b - c - 1)", **given)
    a, b, c, x = (fmpq(n) for n in (3, 7, 2, 5))
    values = {"a": a, "b": b, "c": c, "x": x, "B": (a - 1) / b, "W": (1 - b + c) * (1 - a + c) / (a * b)}
    assert eval(text, {**values, "rho": a / (1 + c)}) == a * x / (b - c - 1)


def test_nor_is_it_when_notation_eliminates_parameters():
    """The same rho in conditions of stability: b is not 1 + c - a, and with rho (1 + c) = a no b is left in it."""
    names = ("a", "b", "c", "rho")
    ring = Ring((), (), names, {}, spare=24)
    place = {name: ring.index("parameter", name) for name in names}
    rho = lowered(ring, "(1 + (a - 1)/b - c/b)/(1 - (1 - b + c)*(1 - a + c)/(a*b))")
    found = eliminate(ring, [(place["rho"], rho)], [place[name] for name in ("b", "a", "c")])
    assert found(lowered(ring, "a*b")) == lowered(ring, "rho*(1 + c)*b")


def test_without_letters_the_formula_is_the_same_object():
    ring = ring_of("x")
    value = lowered(ring, "(m*l**2 + J)*x")
    for nothing in (None, letters(), letters((), I="m*l**2 + J")):
        with letters_as(nothing):
            assert module.lettered(ring, value) == (ring, value)
    assert module.lettered(ring, value)[1] is value


DEFINITIONS = (
    "{0} + {1}*{2}",
    "{0}*{1}**2",
    "{0}/{1}",
    "{0}**2 + {1}**2",
    "({0} - {1})/({2} + {0})",
    "sqrt({0}**2 + {1})",
)


def _random(source: random.Random) -> tuple[dict[str, str], str]:
    """Definitions of two or three letters, later ones by earlier ones, and a formula in which they are put in."""
    given: dict[str, str] = {}
    for name in ("U", "V", "W")[: source.randint(2, 3)]:
        symbols = source.sample([*PARAMETERS, *given], 3)
        given[name] = source.choice(DEFINITIONS).format(*symbols)
    meaning: dict[str, str] = {}
    for name, value in given.items():
        for other, inner in meaning.items():
            value = value.replace(other, f"({inner})")
        meaning[name] = value
    terms = []
    for _ in range(source.randint(2, 4)):
        factors = source.choices([*given, *PARAMETERS, "x", "sin(x)", "x_dot"], k=source.randint(1, 3))
        terms.append("*".join([str(source.choice((1, 2, -3))), *factors]))
    formula = " + ".join(terms).replace("+ -", "- ")
    for name, value in meaning.items():
        formula = formula.replace(name, f"({value})")
    return given, formula


def _differs(ring: Ring, made: Rewriter, polynomial: Polynomial, source: random.Random) -> bool:
    """Whether the rewritten formula has another value than the formula at a random exact point, or in the ring."""
    found = made(polynomial)
    if found is None:
        return False
    if ring.is_zero(made.back(found) - polynomial) is not True:
        return True
    values: dict[str, Any] = {name: fmpq(source.randint(1, 40), 16) for name in ring.names()}
    truth = ring.evaluate(polynomial, values)
    for name, value in made.letters.given:
        values[name] = made.ring.evaluate(Lowering(made.ring, made.named)(value), values)
    values |= {name: 0 for name in made.ring.names() if name not in values}
    return not (made.ring.evaluate(found.polynomial, values) - truth).contains(0)


def _trials(count: int) -> list[bool]:
    source, found = random.Random(7), []
    while len(found) < count:
        given, formula = _random(source)
        ring = ring_of("x")
        try:
            polynomial = lowered(ring, formula)
        except ZeroDivisionError:
            continue
        made = rewriter(ring, letters(tuple(given) if len(found) % 2 else None, **given))
        if made(polynomial) is not None:
            found.append(_differs(ring, made, polynomial, source))
    return found


def test_putting_the_definitions_back_gives_the_ring_s_element():
    assert not any(_trials(40))


def test_an_error_in_a_step_is_caught(monkeypatch):
    right = Rewriter._put

    def wrong(self, polynomial, step, degree):
        value, power = right(self, polynomial, step, degree)
        return (value + step.rest if power else value), power

    monkeypatch.setattr(Rewriter, "_put", wrong)
    assert any(_trials(10))


def _series(source: random.Random) -> str:
    """Of one angle, each harmonic over a denominator of its own in I = m l^2 + J and n = k/m."""
    below = ("(m*l**2 + J + c)", "(m*l**2 + J - a)", "(k/m + b)", "(k/m - a)")
    waves = ("1", "sin(x)", "cos(x)", "sin(x)*cos(x)", "sin(x)**2")
    above = ("(m*l**2 + J)*a", "k**2/m**2*b", "c*k/m", "(m*l**2 + J)**2 + k/m")
    return " + ".join(f"({source.choice(above)})/{source.choice(below)}*{wave}" for wave in source.sample(waves, 3))


def _series_trials(count: int) -> list[bool]:
    source, found = random.Random(11), []
    while len(found) < count:
        ring = ring_of("x")
        polynomial = lowered(ring, _series(source))
        made = rewriter(ring, letters(I="m*l**2 + J", n="k/m"))
        if made(polynomial) is not None:
            found.append(_differs(ring, made, polynomial, source))
    return found


def test_series_of_an_angle_are_written_harmonic_by_harmonic(monkeypatch):
    assert not any(_series_trials(8))
    whole = Rewriter._as_one
    monkeypatch.setattr(Rewriter, "_as_one", lambda self, x: None if (y := whole(self, x)) is None else 2 * y)
    assert any(_series_trials(4))


def test_what_is_written_is_shorter_by_the_length_that_is_documented():
    source = random.Random(3)
    compared = 0
    while compared < 15:
        given, formula = _random(source)
        ring = ring_of("x")
        polynomial = lowered(ring, formula)
        found = rewriter(ring, letters(**given))(polynomial)
        if found is not None:
            compared += 1
            before, after = size(ring, polynomial), size(found.ring, found.polynomial)
            assert after <= before * module.SHORTER


def test_the_slow_flow_of_the_satellite_with_a_damper_is_the_paper_s():
    """tests/references, satellite with a damper, 1.4: term by term, in lambda, G and kappa."""
    analysis = mbsym.load(SHIPPED / "satellite-with-damper-slow.yaml")
    found = {(x.variable, x.rate, x.order): x.formula for x in coefficients(expansion(analysis, 2, {}))}
    with in_letters(analysis.system, None) as used:
        texts = {key: str(value) for key, value in found.items()}
    assert texts["x", False, 1] == "(rho*G + (lam - r)*p)/kappa"
    assert texts["p", True, 0] == "-lam*q"
    assert texts["q", True, 0] == "lam*p"
    assert texts["r", True, 2] == "-(rho*(lam + r)*G + (lam - r)*(3*lam + r)*p)*q/(kappa*s)"
    assert used == {"lam", "G"}
    assert max(map(len, texts.values())) < 165  # 452 in raw parameters


def test_the_third_order_of_that_flow_is_in_the_paper_s_letters_too():
    """Up to 185 terms in parameters; the linear terms are those of number 11 in docs/papers/damper.md."""
    analysis = mbsym.load(SHIPPED / "satellite-with-damper-slow.yaml")
    flow = {x.variable: x.formula for x in coefficients(expansion(analysis, 3, {})) if x.rate and x.order == 3}
    with in_letters(analysis.system, None):
        texts = {key: str(value) for key, value in flow.items()}
    assert "- lam**2*(lam + r)*(lam - r)**2*p - " in texts["q"]
    assert texts["q"].endswith(" - lam*delta*(lam + r)*(lam - r)**2*q)/kappa**2")
    for name in "pq":
        assert not set(re.findall(r"\w+", texts[name])) & {"eta", "s"}
        assert len(texts[name]) < 450, texts[name]  # 2,000 in parameters
    system = analysis.system
    assert not _differs(
        flow["q"].ring, rewriter(flow["q"].ring, letters_of(system)), flow["q"].polynomial, random.Random(5)
    )


def test_what_is_wrong_in_a_claim_is_not_told_in_the_letters_of_the_claim(tmp_path: Path) -> None:
    """2 T = (m l^2 + m k^2) q'^2 = (c + d) q'^2; claimed is c q'^2. "-d/2 = -d/2" would tell nothing."""
    path = filed(
        tmp_path / "pendulum.yaml",
        "mbsym: 1\nname: Pendulum\nparameters: [m, l, k]\nabbreviations: {c: m*l**2, d: m*k**2}\nbodies:\n"
        "  - {name: a, attached to: 0, rotation: {axes: [3], angles: [q]}, mass: m, mass centre: [0, -l, 0],\n"
        "     inertia about: mass centre, inertia: [0, m*k**2, m*k**2]}\n"
        "claims:\n  - {claim: kinetic energy, equals: c*q_dot**2/2}\n",
    )
    words = ["run", str(path), "-v", "--format", "json", "--out", str(tmp_path / "out")]
    printed = invoked(*words, env={"COLUMNS": "200"}).output
    _, _, claims = printed.partition("Claimed minus derived is")
    line = claims.strip().splitlines()[0]
    assert "m k^2" in line
    left, _, right = line.partition(" = ")
    assert left.strip() != right.strip()


@pytest.mark.parametrize(("asked", "held"), [([], "4 p2 (alpha + 1)"), (["--in", "v0,v2"], "v0")])
def test_what_was_found_is_in_letters_that_were_asked_for_alone(asked: list[str], held: str, tmp_path: Path) -> None:
    """The finding stands by itself; labels of conditions are those of problem 6, in whatever letters that is.

    Of a condition that is long the finding has the label alone, and the polynomial whose coefficients these are.
    """
    words = ["run", str(SHIPPED / "satellite.yaml"), "--format", "latex,html", "--out", str(tmp_path / "out"), *asked]
    done = invoked(*words, env={"COLUMNS": "1000"}, code=0)
    finding, _, meanings = done.output.partition("Letters used here")
    assert held in finding
    assert ("v0 = " in meanings) == bool(asked)
    labels = re.compile(r"(?:v\d|discriminant) [<>] 0(?:,| or|$)|(?<=characteristic polynomial) [^(]+", re.MULTILINE)
    assert "v0" not in labels.sub("", finding)
