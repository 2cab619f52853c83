"""Long conditions in the coefficients of the characteristic polynomial, as papers print them."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest
from conftest import SHIPPED, derived, parsed

import mbsym
from mbsym.algebra.base import Lowering
from mbsym.problems.stability.requirements import Requirement
from mbsym.report.coefficients import WRITTEN_OUT, InCoefficients, in_coefficients
from mbsym.report.conditions import statements
from mbsym.report.targets import TARGETS

#: Banshchikov & Vetrov, condition (6).
PAPER = "v4**2*v2**2 - 4*v2**3*v6 - 4*v4**3*v0 + 18*v6*v4*v2*v0 - 27*v0**2*v6**2"


def discriminant() -> tuple[mbsym.Analysis, object, Requirement]:
    analysis = derived(SHIPPED / "satellite.yaml")
    part = next(x for x in analysis.stability.subsystems if len(x.coordinates) == 3)
    return analysis, part, next(r for r in part.theory.requirements if r.label == "discriminant")


def told(found: InCoefficients) -> dict[str, str]:
    return {name: str(value) for name, value in found.letters}


def test_the_satellites_discriminant_is_the_papers() -> None:
    _, part, requirement = discriminant()
    found = in_coefficients(part.ring, requirement)  # type: ignore[attr-defined]
    assert found is not None
    letters = found.formula.ring
    names = {name: letters.generator("parameter", name) for name, _ in found.letters}
    assert Lowering(letters, names)(parsed(PAPER)) == found.formula.polynomial
    # The letters are the coefficients of the characteristic polynomial, which is the paper's (claims of the system).
    characteristic = part.characteristic  # type: ignore[attr-defined]
    assert told(found) == {f"v{k}": str(characteristic[k]) for k in (6, 4, 2, 0)}


def test_only_long_conditions_are_told_so() -> None:
    for path in sorted(SHIPPED.glob("*.yaml")):
        found = derived(path).optional("stability")
        for part in () if found is None else found.subsystems:
            for item in statements(part.ring, part.theory.requirements, True):
                if item.told is not None:
                    assert item.formula is not None
                    assert item.formula.terms > WRITTEN_OUT
                    assert 2 * item.told.formula.terms < item.formula.terms


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
