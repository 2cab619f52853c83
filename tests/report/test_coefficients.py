"""Long conditions in the coefficients of the characteristic polynomial, as papers print them."""

from __future__ import annotations

import json
import random
import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from fractions import Fraction

import pytest
import terminal
from conftest import SHIPPED, derived, parsed, with_letters

import mbsym
from mbsym.algebra.base import Lowering
from mbsym.formulas.formula import Formula
from mbsym.problems.stability.problem import SubsystemStability
from mbsym.problems.stability.requirements import Requirement
from mbsym.report.conditions import WRITTEN_OUT, InCoefficients, Shown, in_coefficients, statements
from mbsym.report.targets import TARGETS

#: Banshchikov & Vetrov, condition (6).
PAPER = "v4**2*v2**2 - 4*v2**3*v6 - 4*v4**3*v0 + 18*v6*v4*v2*v0 - 27*v0**2*v6**2"


def discriminant() -> tuple[mbsym.Analysis, object, Requirement]:
    analysis = derived(SHIPPED / "satellite.yaml")
    part = next(x for x in analysis.stability.subsystems if len(x.coordinates) == 3)
    return analysis, part, next(r for r in part.theory.requirements if r.label == "discriminant")


def told(found: InCoefficients) -> dict[str, str]:
    return {str(letter): str(value) for letter, value in found.letters}


def test_the_satellites_discriminant_is_the_papers() -> None:
    _, part, requirement = discriminant()
    found = in_coefficients(part.ring, requirement)  # type: ignore[attr-defined]
    assert found is not None
    letters = found.formula.ring
    names = {name: letters.generator("parameter", name) for name in found.names}
    assert Lowering(letters, names)(parsed(PAPER)) == found.formula.polynomial
    # The letters are the coefficients of the characteristic polynomial, which is the paper's (claims of the system).
    characteristic = part.characteristic  # type: ignore[attr-defined]
    assert told(found) == {f"v{k}": str(characteristic[k]) for k in (6, 4, 2, 0)}


def test_only_long_conditions_are_told_so() -> None:
    for path in sorted(SHIPPED.glob("*.yaml")):
        found = derived(path).optional("stability")
        for part in () if found is None else found.subsystems:
            for item in statements(part.ring, part.theory.requirements, True):
                if item.in_coefficients is not None:
                    assert item.formula is not None
                    assert item.formula.terms > WRITTEN_OUT
                    assert 2 * item.in_coefficients.formula.terms < item.formula.terms


def test_a_form_that_is_not_the_condition_is_not_shown() -> None:
    _, part, requirement = discriminant()
    ring = part.ring  # type: ignore[attr-defined]
    v0, *rest = requirement.coefficients
    for wrong in ((-v0, *rest), (v0 * 2, *rest), (rest[0], v0, *rest[1:])):
        assert in_coefficients(ring, replace(requirement, coefficients=wrong)) is None
    # Where squares were split off, the form says more than the statement.
    split = replace(requirement.condition, nonzero=(v0,))
    assert in_coefficients(ring, replace(requirement, condition=split)) is None


@pytest.mark.parametrize("target", ["latex", "html", "json"])
def test_reports_show_it_with_its_length(target: str) -> None:
    analysis, _, _ = discriminant()
    text = TARGETS[target].render(analysis, (4, 5, 6))
    if target == "json":
        parts = json.loads(text)["results"]["stability"]["subsystems"] if "results" in json.loads(text) else None
        listed = [x for part in (parts or json.loads(text)["stability"]["subsystems"]) for x in part["conditions"]]
        (form,) = [x["in_coefficients"] for x in listed if "in_coefficients" in x]
        assert set(form["coefficients"]) == {"v6", "v4", "v2", "v0"}
        assert "27*v6**2*v0**2" in form["formula"]
        assert next(x for x in listed if x["label"] == "discriminant")["formula"].count("gamma") > 100  # in full
        return
    assert "written out 376 terms, of degree 12; in full in results.json" in text
    assert ("27 v_{6}^{2} v_{0}^{2}" if target == "latex" else "27") in text


#: Three coupled gyroscopic coordinates, with parameters that are called as coefficients are.
NAMED = """
mbsym: 1
name: parameters that look like coefficients
parameters: {v0: real, v2: real, k: real, b: real, s: real}
linear system:
  coordinates: [x, y, z]
  G: [[0, -b, 0], [b, 0, -s], [0, s, 0]]
  K: [[v0, k, s], [k, v2, 1], [s, 1, b]]
"""
#: alpha, gamma, p1, p2 at which the satellite flutters: v0 is positive as it was printed, the discriminant is not.
FLUTTER = {"alpha": Fraction(-1, 2), "gamma": Fraction(1, 2), "p1": Fraction(2, 5), "p2": Fraction(1, 5)}


def printed(text: str) -> dict[str, tuple[str, str]]:
    """The conditions of a terminal by their labels: formula and relation, which letters have not."""
    return {
        match[1]: (terminal.python(match[2]), match[3] or "")
        for line in text.splitlines()
        if (match := re.fullmatch(r"\s+([\w ,]+)(?:: | = )([^<>!]*?)(?: (>|<|>=|!=) 0(?: \(.*\))?)?", line))
    }


@pytest.mark.parametrize("text", [(SHIPPED / "satellite.yaml").read_text(encoding="utf-8"), NAMED])
def test_letters_mean_on_the_terminal_what_stands_beside_them_there(text: str) -> None:
    """Each formula is evaluated from the terminal's text alone, letters by what stands there under their names."""
    analysis = mbsym.loads(text)
    for part in analysis.stability.subsystems:
        own = list(_block(terminal.told(analysis, 6, longest=10**6), part.coordinates))
        shown = printed("\n".join(own))
        names = sorted(p.name for p in analysis.system.parameters)
        truth = dict(_true_conditions(part))
        assert shown
        source = random.Random(1)
        for _ in range(50):
            numbers = {name: Fraction(source.choice((-9, -5, -1, 2, 3, 7)), source.randint(1, 4)) for name in names}
            try:
                point = with_letters(analysis.system, numbers, Fraction)
            except ZeroDivisionError:
                continue
            letters = {label: eval(formula, {}, dict(point)) for label, (formula, _) in shown.items() if label in OWN}
            for label, (formula, relation) in shown.items():
                if not relation:
                    continue
                # A letter that is a parameter's name is the parameter: nobody can read it otherwise.
                value = eval(formula, {}, {**letters, **point})
                exact = truth[label.removeprefix("condition ")](point)
                assert (value > 0, value < 0) == (exact > 0, exact < 0) or relation == "!=", label


OWN = ("v0", "v2", "v4", "v6", "a0", "a2", "a4", "a6")


def _block(lines: Iterable[str], coordinates: tuple[str, ...]) -> Iterator[str]:
    """The conditions of one subsystem, with the letters in them."""
    own = listed = False
    for line in lines:
        if line.startswith("  "):
            if own and listed:
                yield line
        elif re.fullmatch(r"(Subsystem \d+: )?[\w, ]+ \(.*\)", line):
            own = f"{', '.join(coordinates)} (" in line
        else:
            listed = line.startswith("Conditions (") or (listed and line == "with:")


def _true_conditions(part: SubsystemStability) -> Iterator[tuple[str, Callable[[dict[str, Fraction]], Fraction]]]:
    """Each requirement's own polynomial as a function of the parameters."""
    for requirement in part.theory.requirements:
        formula = str(Formula(part.ring, requirement.polynomial))
        yield requirement.label, lambda point, formula=formula: eval(formula, {}, dict(point))


def test_the_point_at_which_the_satellite_flutters_is_told_by_what_is_printed(monkeypatch: pytest.MonkeyPatch) -> None:
    """D = -16.1 there by the paper's formula (6), typed here; the flagship's terminal once made it positive."""
    alpha, gamma, p1, p2 = FLUTTER.values()
    values = {
        "v6": (1 + gamma * alpha) * p1 - (alpha + 1) * p2,
        "v4": 3 * (1 + alpha * gamma) + (alpha + 1) * (p1 * (alpha + 3 * gamma + 2) - (alpha + 8) * p2),
        "v2": (1 + 3 * gamma + alpha * (alpha + 2 * gamma + 3)) * (3 + p1)
        + 4 * alpha * p1 * (gamma + alpha)
        - 8 * p2 * (alpha + 1) * (alpha + 2),
        "v0": 4 * alpha * ((alpha + gamma) * (3 + p1) - 4 * (alpha + 1) * p2),
    }
    assert eval(PAPER, {}, values) < -16
    analysis, part, requirement = discriminant()
    found = in_coefficients(part.ring, requirement)  # type: ignore[attr-defined]
    assert found is not None
    # It is shown once, as the coefficient that the discriminant holds: 4 alpha (...), not alpha (...); the paper's v0.
    text = TARGETS["latex"].render(analysis, (6,))
    assert r"\colon\quad v_{0} > 0" not in text  # the letter alone: v_0 > 0, as the paper has it
    assert r"v_{0} &> 0" in text or r"v_{0} > 0" in text
    assert r"v_{0} = 4 \alpha" in text
    monkeypatch.setattr(analysis, "letters", ())
    assert r"v_{0} \colon\quad 4 \alpha" in TARGETS["latex"].render(analysis, (6,))
    shown = printed("\n".join(_block(terminal.told(analysis, 6), ("psi", "phi", "sigma"))))
    assert eval(shown["v0"][0], {}, dict(FLUTTER)) == values["v0"]


def test_a_dropped_letter_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: the terminal shows the form whether or not its letters stand there."""
    monkeypatch.setattr(Shown, "unshown", lambda self, told: ())
    with pytest.raises(NameError):
        test_letters_mean_on_the_terminal_what_stands_beside_them_there(NAMED)
