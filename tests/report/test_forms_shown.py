"""``mbsym run --form``: Routh's and Hamilton's forms in every file, and numbers of model.py by both."""

from __future__ import annotations

import json
from html import unescape
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from conftest import SHIPPED, compiled_latex, invoked, needs_pdflatex
from jsonschema import Draft202012Validator

import mbsym
from mbsym.report.canonical import forms_of, with_names
from mbsym.report.code.python_module import render as module_text
from mbsym.report.schemas import schema
from mbsym.report.targets import TARGETS

#: Ignored coordinates; dissipation and inertia that couples; prescribed motion; speeds of their own.
SYSTEMS = ("heavy-top", "satellite-with-damper", "satellite-with-damper-driven", "clebsch-poisson")


@pytest.fixture(scope="module")
def reports(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What a user gets of the heavy top."""
    folder = tmp_path_factory.mktemp("forms")
    command = ["run", str(SHIPPED / "heavy-top.yaml"), "--form", "hamilton,routh", "--out", str(folder), "-v"]
    found = invoked(*command, code=0)
    assert "L does not contain phi, on which no other force acts: the momenta beta = (p_phi)" in found.output
    assert "W = p_phi^2/(2 C) + m l g cos(alpha) cos(beta)" in found.output
    for check in ("Routh's equations", "canonical equations", "Poisson brackets"):
        assert f"{check} | " in found.output
    return folder


def test_every_file_has_them(reports: Path) -> None:
    found = {name: (reports / name).read_text() for name in ("report.tex", "report.html", "report.wl", "model.py")}
    assert "\\subsection*{Routh's form}" in found["report.tex"]
    assert "They are in involution" in found["report.tex"]
    assert "<h3>Hamilton's form</h3>" in unescape(found["report.html"])
    for name in ("hamiltonian = ", "canonicalEquations = ", "routhEquations = ", "poissonBrackets = "):
        assert f"\n{name}" in found["report.wl"]
    for name in ("hamiltonian", "canonical_rhs", "canonical_state", "reduced_rhs", "reduced_potential"):
        assert f"\ndef {name}(" in found["model.py"]
    assert "Hamilton" in (reports / "fragments" / "equations.tex").read_text()


def test_results_follow_the_schema(reports: Path) -> None:
    found = json.loads((reports / "results.json").read_text())
    assert [x.message for x in Draft202012Validator(schema("results")).iter_errors(found)] == []
    assert found["routh"]["reduced_potential"] == "p_phi**2/(2*C) + m*l*g*cos(alpha)*cos(beta)"
    assert found["hamilton"]["momenta"] == ["p_alpha", "p_beta", "p_phi"]
    assert found["brackets"]["in_involution"] is True
    del found["routh"]["function"]
    assert list(Draft202012Validator(schema("results")).iter_errors(found))


@needs_pdflatex
def test_the_report_compiles(reports: Path, tmp_path: Path) -> None:
    log = compiled_latex((reports / "report.tex").read_text(), tmp_path)
    assert "Overfull" not in log


def test_what_has_no_form_says_why_in_every_file(tmp_path: Path) -> None:
    command = ["run", str(SHIPPED / "cart-pole.yaml"), "--form", "routh", "--out", str(tmp_path), "-p", "3"]
    found = invoked(*command)
    reason = "cyclic are p, but other forces act on them, or depend on them"
    assert found.exit_code == 0
    assert f"Routh's form  no result: {reason}" in found.output
    for name in ("report.tex", "report.html", "report.wl", "model.py"):
        assert reason in " ".join((tmp_path / name).read_text().split()), name
    failure = json.loads((tmp_path / "results.json").read_text())["unavailable"]["routh"]
    assert (failure["code"], failure["reason"]) == ("nothing-ignored", reason)


def test_an_unknown_form_is_complained_about(tmp_path: Path) -> None:
    command = ["run", str(SHIPPED / "heavy-top.yaml"), "--form", "hamiltom", "--out", str(tmp_path / "none")]
    found = invoked(*command, code=2)
    assert "there is no form 'hamiltom'" in found.output
    assert "did you mean 'hamilton'?" in found.output
    assert not (tmp_path / "none").exists()


def module_of(name: str) -> ModuleType:
    analysis = mbsym.load(SHIPPED / f"{name}.yaml", (3,))
    analysis.forms = ("routh", "hamilton")
    module = ModuleType(name.replace("-", "_"))
    exec(compile(module_text(analysis, (3,)), name, "exec"), module.__dict__)
    return module


@pytest.mark.parametrize("name", SYSTEMS)
def test_numbers_agree_with_lagranges_equations(name: str) -> None:
    """y' is dy/dx x' + dy/dt (central differences); on the level of beta s'' and c' are those of the whole system."""
    module, chance = module_of(name), np.random.default_rng(7)
    p = {key: 1.3 if value is None else value for key, value in module.complete().items()}
    n = len(module.COORDINATES)
    several, time, step = chance.uniform(0.2, 1.0, (2 * n, 5)), 0.7, 1e-6
    y = module.canonical_state(several, p, time)
    wanted = module.generalized_energy(several[:n], several[n:], p, time)
    assert module.hamiltonian(y, p, time) == pytest.approx(wanted, rel=1e-11, abs=1e-9)
    rates = module.rhs(time, several, p)
    there, back = (module.canonical_state(several + sign * step * rates, p, time + sign * step) for sign in (1.0, -1.0))
    along = (there - back) / (2 * step)
    assert module.canonical_rhs(time, y, p) == pytest.approx(along, abs=1e-7 * np.abs(along).max())
    x, whole = several[:, 0], rates[:, 0]
    reduced, constants = module.reduced_state(x, p, time)
    found = module.reduced_rhs(time, reduced, constants, p)
    kept = [module.COORDINATES.index(name) for name in module.LEFT]
    gone = [n + module.COORDINATES.index(name) for name in module.IGNORED]
    scale = np.abs(whole).max()
    assert found == pytest.approx(np.concatenate([x[n:][kept], whole[n:][kept]]), abs=1e-10 * scale)
    assert module.ignored_rates(time, reduced, constants, p) == pytest.approx(x[gone], rel=1e-9)
    assert np.isfinite(module.reduced_potential(reduced[: len(kept)], constants, p, time))


@pytest.mark.parametrize(
    ("name", "state"),
    [
        ("cartesian-pendulum", (0.6, -0.8, 0.8 * 0.7, 0.6 * 0.7)),
        ("chaplygin-sleigh", (0.1, 0.2, 0.3, 0.7, 0.7 * np.tan(0.3), 0.4)),
    ],
)
def test_numbers_agree_on_the_constraints(name: str, state: tuple[float, ...]) -> None:
    """y' is dy/dx x' (central differences) in the velocities that the constraints leave."""
    module, time, step = module_of(name), 0.7, 1e-6
    p = {key: 1.3 if value is None else value for key, value in module.complete().items()}
    x = np.array(state)
    y, rates = module.canonical_state(x, p, time), module.rhs(time, x, p)
    there, back = (module.canonical_state(x + sign * step * rates, p, time) for sign in (1.0, -1.0))
    along = (there - back) / (2 * step)
    assert len(y) == len(module.CANONICAL_POSITIONS) + len(module.MOMENTA) < len(x)
    assert module.canonical_rhs(time, y, p) == pytest.approx(along, abs=1e-7 * np.abs(along).max())
    n = len(x) // 2
    wanted = module.generalized_energy(x[:n], x[n:], p, time)
    assert module.hamiltonian(y, p, time) == pytest.approx(wanted, rel=1e-11, abs=1e-9)


@needs_pdflatex
def test_long_denominators_are_written_once_and_stay_on_the_page(tmp_path: Path) -> None:
    """The determinant of the ignored coordinates' inertia is wider than any line."""
    analysis = mbsym.load(SHIPPED / "satellite-with-damper.yaml", (3,))
    analysis.forms = ("routh", "hamilton")
    text = TARGETS["latex"].render(analysis, (3,))
    assert isinstance(text, str)
    assert text.count("\\Delta_{1} = ") == 1
    assert "\\frac{1}{\\Delta_{1}}" in text or "{\\Delta_{1}" in text.split("\\Delta_{1} = ")[1]
    assert "Overfull" not in compiled_latex(text, tmp_path)


def test_names_of_denominators_stand_for_them() -> None:
    """With Delta put back every formula is the one that was derived; names of the two forms differ."""
    analysis = mbsym.load(SHIPPED / "satellite-with-damper.yaml", (3,))
    analysis.forms = ("routh", "hamilton")
    forms = forms_of(analysis, (3,))
    found = with_names(forms, analysis.system)
    letters = [str(letter) for letter, _ in (*found.routh, *found.hamilton)]
    assert len(letters) == len(set(letters)) > 1
    for told, whole, named in (
        (found.forms.routh.reduced_potential, forms.routh.reduced_potential, found.routh),
        (found.forms.hamilton.hamiltonian, forms.hamilton.hamiltonian, found.hamilton),
    ):
        ring = whole.ring
        back = {ring.index("parameter", str(letter)): value.polynomial for letter, value in named}
        inverse = {
            k: ring.reciprocal(value.polynomial)
            for letter, value in named
            for k, g in enumerate(ring.generators[: ring.spare])
            if g.kind == "reciprocal" and g.argument == letter.polynomial
        }
        assert told.polynomial != whole.polynomial
        assert ring.is_zero(ring.substitute(ring.substitute(told.polynomial, inverse), back) - whole.polynomial) is True
