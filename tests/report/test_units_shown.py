"""Units beside results: every (quantity, unit) is held against a table written by hand; without units there is none."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from matplotlib.figure import Figure

import mbsym.report.figures as figures_module
import mbsym.report.motion_figure as motion_module
from mbsym.report.unit_text import latex, modelica, pretty
from mbsym_cli.main import main

ROOT = Path(__file__).parents[2]

#: A pendulum on a cart: tonnes, millimetres, seconds, so that nothing that assumes SI passes.
CART = """
mbsym: 1
name: Cart and pendulum
parameters:
  M: {unit: t, sign: positive, meaning: mass of the cart}
  m: {unit: t, sign: positive, meaning: mass of the bob}
  l: {unit: mm, sign: positive}
  g: {unit: mm/s^2, sign: positive}
  k: {unit: t/s^2, sign: positive, meaning: 'stiffness, "of the spring"'}
  c: {unit: t*mm^2/s, sign: positive}
  eps: {unit: '1', sign: positive}
bodies:
  - {name: cart, attached to: 0, connection point: [x, 0, 0], mass: M, coordinates: [x]}
  - name: bob
    attached to: cart
    rotation: {axes: [3], angles: [theta]}
    mass centre: [0, -l, 0]
    mass: m*eps
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
SPRING
units: {x: mm, theta: rad}
limits: {theta: [-pi/2, pi/2], x: [-500, 500]}
motion: {x: 0, theta: 0}
values: {M: 0.002, m: 0.001, l: 500, g: 9810, k: 0.04, c: 1, eps: 1}
initial: {x: 10, theta: 0.4}
"""
SPRING = "  - spring: {coordinate: x, stiffness: k}\n  - damper: {coordinate: theta, coefficient: c}\n"

#: By hand: an energy is mass times length^2 over time^2, here t*mm^2/s^2 (a thousandth of a joule); a momentum of x is
#: mass times length over time.
ENERGY = "t*mm^2/s^2"
STATE = {"t": "s", "x": "mm", "theta": "rad", "x_dot": "mm/s", "theta_dot": "rad/s"}
PARAMETERS = {"M": "t", "m": "t", "l": "mm", "g": "mm/s^2", "k": "t/s^2", "c": "t*mm^2/s", "eps": ""}
BODY = {
    "position": "mm",
    "velocity": "mm/s",
    "acceleration": "mm/s^2",
    "angular_velocity": "rad/s",
    "kinetic_energy": ENERGY,
}


def described(tmp_path: Path, text: str = CART, spring: str = SPRING) -> Path:
    """A file with the description; every line about units is left out where ``text`` says so."""
    path = tmp_path / "cart.yaml"
    path.write_text(text.replace("SPRING\n", spring), encoding="utf-8")
    return path


def bare(text: str = CART) -> str:
    """The same description without units."""
    return re.sub(r"\nunits: .*", "", re.sub(r"unit: [^,]*, ", "", text))


def invoke(*arguments: object) -> str:
    done = CliRunner().invoke(main, [str(x) for x in arguments])
    assert done.exit_code == 0, done.output
    return done.output


def header(path: Path) -> dict[str, str]:
    """(name, unit) of the columns; the file is read as pandas and Excel read it: a comma ends a name."""
    names = path.read_text(encoding="utf-8").splitlines()[0].split(",")
    found = [re.fullmatch(r"(.*?)(?: \[(.*)\])?", name) for name in names]
    return {one[1]: one[2] or "" for one in found if one}


# --- simulations ---


@pytest.fixture(scope="module")
def free(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a simulation of the cart without spring and damper: momentum of x and energy are conserved."""
    folder = tmp_path_factory.mktemp("free")
    path = described(folder, spring="")
    options = ("--time", "1", "--samples", "30", "--no-estimate", "--invariants", "--bodies", "--format", "csv,svg")
    (folder / "said").write_text(invoke("simulate", path, *options, "--out", folder), encoding="utf-8")
    return folder


def test_columns_of_a_trajectory_have_their_units(free: Path) -> None:
    kept = {"energy": ENERGY, "relative_drift": "", "momentum_x": "t*mm/s"}
    assert header(free / "trajectory.csv") == STATE | kept


def test_columns_of_bodies_have_their_units(free: Path) -> None:
    found = header(free / "bodies.csv")
    wanted = {"t": "s", "kinetic_energy": ENERGY, "force_function": ENERGY, "energy": ENERGY}
    for body in ("cart", "bob"):
        for what, unit in BODY.items():
            names = [what] if what == "kinetic_energy" else [f"{what}_{axis}" for axis in (1, 2, 3)]
            wanted |= {f"{body}.{name}": unit for name in names}
    assert found == wanted


def test_numbers_below_a_header_with_units_read_as_before(free: Path) -> None:
    table = np.genfromtxt(free / "trajectory.csv", delimiter=",", skip_header=1)
    assert table.shape == (30, len(header(free / "trajectory.csv")))
    assert np.all(np.isfinite(table))
    assert table[0, 1] == 10.0


def test_the_json_of_a_simulation_names_the_unit_of_everything(free: Path) -> None:
    content = json.loads((free / "simulation.json").read_text(encoding="utf-8"))
    wanted = STATE | {name: unit or "1" for name, unit in PARAMETERS.items()}
    assert content["units"] == wanted | {"energy": ENERGY, "momentum_x": "t*mm/s"}


def test_the_terminal_tells_the_time_with_its_unit(free: Path) -> None:
    assert re.search(r"time +0 to 1 s, 30 samples", (free / "said").read_text(encoding="utf-8"))


def drawn(monkeypatch: pytest.MonkeyPatch, path: Path, folder: Path) -> set[str]:
    """All texts that stand at axes of the figures of a simulation."""
    found: set[str] = set()

    def saved(stem: str, figure: Figure, formats: object) -> dict[str, bytes]:
        for axis in figure.axes:
            found.update({axis.get_xlabel(), axis.get_ylabel(), axis.get_title(), axis.get_title("left")})
        found.update(figure._suptitle.get_text().splitlines() if figure._suptitle else ())
        return {}

    monkeypatch.setattr(figures_module, "saved", saved)

    def pictures(drawings: dict[str, object], formats: object) -> dict[str, bytes]:
        for stem, draw in drawings.items():
            saved(stem, draw(), formats)  # type: ignore[operator]
        return {}

    monkeypatch.setattr(motion_module, "pictures", pictures)
    invoke("simulate", path, "--time", "1", "--samples", "30", "--no-estimate", "--format", "svg", "--out", folder)
    return found


def test_axes_of_figures_have_their_units(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found = drawn(monkeypatch, described(tmp_path), tmp_path / "out")
    assert {
        "$t$ [s]",
        "$t$\n[s]",
        "$x$\n[mm]",
        "$x$ [mm]",
        r"$\theta$" + "\n[rad]",
        r"$\theta$ [rad]",
        r"$\dot{x}$" + "\n[mm/s]",
        r"$\dot{\theta}$" + "\n[rad/s]",
        "$h$\n[t·mm²/s²]",  # the damper takes energy away
        "axis 1 [mm]",
        "axis 2 [mm]",
        "places of the mass centres [mm]",
        "t = 0 to 1 s, a snapshot every 0.1 s",
    } <= found
    marks = {text for text in found if "[" in text}
    assert all(re.search(r"\[(s|mm|rad|mm/s|rad/s|t·mm²/s²)\]$", text) for text in marks), marks


def test_without_units_no_axis_and_no_header_changes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = described(tmp_path, bare())
    found = drawn(monkeypatch, path, tmp_path / "out")
    assert {"$t$", "$x$", r"$\theta$", r"$\dot{x}$", "axis 1", "places of the mass centres"} <= found
    assert not [text for text in found if "[" in text or "mm" in text]
    invoke("simulate", path, "--time", "1", "--samples", "9", "--bodies", "--format", "csv", "--out", tmp_path / "o")
    assert "[" not in (tmp_path / "o" / "trajectory.csv").read_text(encoding="utf-8")
    assert "[" not in (tmp_path / "o" / "bodies.csv").read_text(encoding="utf-8")
    assert "units" not in json.loads((tmp_path / "o" / "simulation.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", ["theta", "theta_dot", "energy"])
def test_a_wrong_unit_in_a_header_is_caught(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: the unit of a rate without its time, of an angle as of a length, of an energy as of a force."""
    import mbsym.report.trajectory_csv as module

    right = module.column_units
    wrong = {"theta": "mm", "theta_dot": "rad", "energy": "t*mm/s^2"}
    monkeypatch.setattr(module, "column_units", lambda *found: right(*found) | {name: wrong[name]})
    path = described(tmp_path)
    invoke("simulate", path, "--time", "1", "--samples", "9", "--format", "csv", "--out", tmp_path / "out")
    with pytest.raises(AssertionError):
        assert header(tmp_path / "out" / "trajectory.csv") == {**STATE, "energy": ENERGY, "relative_drift": ""}


# --- how units are written ---


@pytest.mark.parametrize(
    ("unit", "screen", "tex", "model"),
    [
        ("kg*m^2/s^2", "kg·m²/s²", r"\mathrm{kg}\,\mathrm{m}^{2}/\mathrm{s}^{2}", "kg.m2/s2"),
        ("kg/(m*s^2)", "kg/(m·s²)", r"\mathrm{kg}/(\mathrm{m}\,\mathrm{s}^{2})", "kg/(m.s2)"),
        ("1/s", "1/s", r"1/\mathrm{s}", "1/s"),
        ("rad", "rad", r"\mathrm{rad}", "rad"),
        ("m^(1/2)", "m^(1/2)", r"\mathrm{m}^{1/2}", ""),
        ("1/day", "1/day", r"1/\mathrm{day}", "1/d"),
        ("", "", "", ""),
        (None, None, "", ""),
    ],
)
def test_units_are_written_for_each_target(unit: str | None, screen: str | None, tex: str, model: str) -> None:
    assert pretty(unit) == screen
    assert latex(unit) == tex
    assert modelica(unit) == model


def test_a_unit_as_somebody_wrote_it_is_raised_too() -> None:
    assert pretty("N * m * s**2") == "N·m·s²"
    assert latex("N * m * s**-2") == r"\mathrm{N}\,\mathrm{m}\,\mathrm{s}^{-2}"
