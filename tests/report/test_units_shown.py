"""Units beside results: every (quantity, unit) is held against a table written by hand; without units there is none."""

from __future__ import annotations

import json
import re
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from conftest import filed, invoked
from matplotlib.figure import Figure

import mbsym.report.exports.fmu as fmu_units_module
import mbsym.report.figures.figures as figures_module
import mbsym.report.figures.motion_figure as motion_module
from mbsym.numerics.trade.tradeoff import Tradeoff
from mbsym.report.runs.tradeoff_table import tradeoff_csv
from mbsym.report.schemas import schema
from mbsym.report.unit_text import latex, modelica, pretty

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
    return filed(tmp_path / "cart.yaml", text.replace("SPRING\n", spring))


def bare(text: str = CART) -> str:
    """The same description without units."""
    return re.sub(r"\nunits: .*", "", re.sub(r"unit: [^,]*, ", "", text))


def invoke(*arguments: object) -> str:
    done = invoked(*arguments, code=0)
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
    import mbsym.report.runs.trajectory_csv as module

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


# --- generated code ---

#: Of what exports hold besides parameters and the state; rates of rates by hand.
SECOND = {"der(x)": "mm/s", "der(theta)": "rad/s", "der(x_dot)": "mm/s^2", "der(theta_dot)": "rad/s^2"}


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of all reports and exports of the cart."""
    folder = tmp_path_factory.mktemp("written")
    formats = "python,c,casadi,jax,octave,julia,modelica,fmu2,fmu3,json,latex,html"
    invoke("run", described(folder), "--format", formats, "--out", folder)
    return folder


def test_comments_of_code_tell_the_unit_of_every_parameter_and_of_the_state(written: Path) -> None:
    state = ", ".join(f"{name} [{unit}]" for name, unit in STATE.items())
    wanted = {name: unit for name, unit in PARAMETERS.items() if unit}
    patterns = {
        "model.py": r"^    (\w+): .*?\[(.*)\]$",
        "model.h": r"^    double (\w+?)_?; /\* .*?\[(.*)\] \*/$",
        "model_casadi.py": r'^    "(\w+)",  # .*?\[(.*)\]$',
        "model_jax.py": r'^    "(\w+)",  # .*?\[(.*)\]$',
        "model.m": r"^% Parameter (\w+): .*?\[(.*)\]$",
        "model.jl": r"^    (\w+) = .*, # .*?\[(.*)\]$",
    }
    for name, pattern in patterns.items():
        text = (written / name).read_text(encoding="utf-8")
        assert dict(re.findall(pattern, text, re.MULTILINE)) == wanted, name
        assert f"Units: {state}, energies [{ENERGY}]." in text, name


def test_the_python_module_labels_its_axes(written: Path) -> None:
    scope: dict[str, object] = {"__name__": "model"}
    exec(compile((written / "model.py").read_text(encoding="utf-8"), "model.py", "exec"), scope)
    assert scope["UNITS"] == STATE
    assert scope["with_unit"]("theta_dot") == "theta_dot [rad/s]"  # type: ignore[operator]


def test_modelica_has_units_in_its_own_syntax(written: Path) -> None:
    text = (written / "model.mo").read_text(encoding="utf-8")
    found = dict(re.findall(r'^  (?:parameter )?Real (\w+?)_?(?:\[3\])?\(.*?unit = "(.*?)"\)', text, re.MULTILINE))
    energies = dict.fromkeys(("energy", "generalized_energy"), ENERGY)
    wanted = {k: v for k, v in (STATE | PARAMETERS | energies).items() if k != "t" and v}
    places = dict.fromkeys(("joint1", "joint2", "centre1", "centre2"), "mm")
    assert found == {name: unit.replace("*", ".").replace("^", "") for name, unit in (wanted | places).items()}


def test_modelica_counts_in_seconds_and_so_has_no_units_where_the_description_does_not(tmp_path: Path) -> None:
    text = re.sub(r"/s\b", "/ms", CART).replace("name: Cart", "name: Fast cart")
    invoke("run", described(tmp_path, text), "--format", "modelica", "--out", tmp_path / "out")
    assert "unit" not in (tmp_path / "out" / "model.mo").read_text(encoding="utf-8")


def fmu_units(path: Path) -> tuple[dict[str, str], dict[str, dict[str, float]]]:
    """(unit by variable, attributes of the base unit by unit) of a model description."""
    root = ElementTree.fromstring(zipfile.ZipFile(path).read("modelDescription.xml"))
    units = {}
    for one in root.iter("Unit"):
        base = one.find("BaseUnit")
        assert base is not None
        units[one.attrib["name"]] = {name: float(value) for name, value in base.attrib.items()}
    found = {}
    for one in (*root.iter("ScalarVariable"), *root.iter("Float64")):
        real = one.find("Real") if one.tag == "ScalarVariable" else one
        assert real is not None
        found[one.attrib["name"]] = real.attrib.get("unit", "")
    return found, units


def in_si(unit: str) -> dict[str, float]:
    """The base unit as pint knows it: an independent reading of the unit's name."""
    pint = pytest.importorskip("pint")
    quantity = pint.UnitRegistry().Quantity(1.0, unit)
    names = {"[mass]": ("kg", "kilogram"), "[length]": ("m", "meter"), "[time]": ("s", "second")}
    found = {names[name][0]: float(power) for name, power in quantity.dimensionality.items()}
    base = "*".join(f"{names[name][1]}**({power})" for name, power in quantity.dimensionality.items())
    factor = quantity.to(base).magnitude if found else 1.0
    return found | ({"rad": 1.0} if "rad" in unit else {}) | ({} if abs(factor - 1) < 1e-12 else {"factor": factor})


@pytest.mark.parametrize("version", [2, 3])
def test_an_fmu_has_the_unit_of_every_variable_and_what_it_is_in_si(version: int, written: Path) -> None:
    found, units = fmu_units(written / f"model-fmi{version}.fmu")
    energies = dict.fromkeys(("energy", "generalized_energy"), ENERGY)
    wanted = {name: unit for name, unit in STATE.items() if name != "t"} | {"time": "s"}
    assert found == wanted | PARAMETERS | SECOND | energies
    assert units.keys() == set(found.values()) - {""}
    for unit, base in units.items():
        assert base == pytest.approx(in_si(unit)), unit


def test_a_wrong_size_of_a_unit_in_an_fmu_is_caught(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: a millimetre of a centimetre."""
    monkeypatch.setattr(fmu_units_module, "MULTIPLES", {**fmu_units_module.MULTIPLES, "m": {1e-2: "mm"}})
    invoke("run", described(tmp_path), "--format", "fmu2", "--out", tmp_path / "out")
    units = fmu_units(tmp_path / "out" / "model-fmi2.fmu")[1]
    assert units["s"] == pytest.approx(in_si("s"))
    with pytest.raises(AssertionError):
        assert units["mm"] == pytest.approx(in_si("mm"))


def test_without_units_nothing_that_is_generated_has_any(tmp_path: Path) -> None:
    formats = "python,c,casadi,jax,octave,julia,modelica,fmu2,fmu3,json,latex,html"
    invoke("run", described(tmp_path, bare()), "--format", formats, "--out", tmp_path / "out")
    for path in sorted((tmp_path / "out").iterdir()):
        if path.suffix == ".fmu":
            assert fmu_units(path) == (dict.fromkeys(fmu_units(path)[0], ""), {})
        elif path.is_file():
            text = path.read_text(encoding="utf-8")
            assert not re.search(r"\[(mm|t|s|rad)[]*/^]|Units:|UNITS|unit =|\"unit|mathrm\{mm", text), path.name


# --- reports ---


def in_latex(unit: str) -> str:
    """t*mm^2/s as LaTeX writes it, by hand for the units of this system."""
    return re.sub(r"\^(\d)", r"^{\1}", re.sub(r"[a-z]+", r"\\mathrm{\g<0>}", unit)).replace("*", r"\,")


def test_report_tex_has_the_units_of_coordinates_parameters_limits_and_eigenvalues(written: Path) -> None:
    text = " ".join((written / "report.tex").read_text(encoding="utf-8").split())
    rows = text.partition("Parameters")[2]
    table = dict(re.findall(r"\$(?:\\mathit\{)?(\w+)\}? = [^$]*\$ ?([^&]*?) & positive &", rows))
    for name, unit in PARAMETERS.items():
        assert table[name] == (f"$[{in_latex(unit)}]$" if unit else ""), name
    assert r"$x$ $[\mathrm{mm}]$, $\theta$ $[\mathrm{rad}]$" in text
    assert r"$-500 \leq x \leq 500$ $[\mathrm{mm}]$" in text
    assert re.search(r"Eigenvalues there, in the time \$t\$, of \$x,\\, \\theta\$: .*?\[1/\\mathrm\{s\}\]\$\.", text)


def test_report_html_has_the_units_of_coordinates_parameters_limits_and_eigenvalues(written: Path) -> None:
    text = (written / "report.html").read_text(encoding="utf-8")
    rows = re.findall(r"<td><code>(\w+)</code></td><td><math>.*?</math> ?(.*?)</td><td>positive</td>", text)
    raised = {name: f"[{u}]".replace("^2", "²").replace("*", "·") if u else "" for name, u in PARAMETERS.items()}
    assert dict(rows) == raised
    assert re.search(r"Generalised coordinates: <math.*?</math> \[mm\], <math.*?</math> \[rad\]\.", text)
    assert re.search(r"Limits of the coordinates, which no force keeps: <math.*?</math> \[rad\]", text)
    assert re.search(r"Eigenvalues there, in the time .*?, of .*? \[1/s\]\.</p>", text)


def test_results_json_names_the_units_and_follows_its_schema(written: Path) -> None:
    content = json.loads((written / "results.json").read_text(encoding="utf-8"))
    assert {item["name"]: item.get("unit", "") for item in content["parameters"]} == PARAMETERS
    assert content["units"] == {k: v or "1" for k, v in (STATE | PARAMETERS | {"energy": ENERGY}).items()}
    for name in ("results", "equilibria", "simulation"):
        assert schema(name)["properties"]["units"]
    jsonschema = pytest.importorskip("jsonschema")
    jsonschema.validate(content, schema("results"))


def test_equilibria_are_listed_with_units(tmp_path: Path) -> None:
    path = described(tmp_path)
    assert re.search(r"x \[mm\] +theta \[rad\] +stability", invoke("equilibria", path))
    content = json.loads(invoke("equilibria", path, "--json"))
    assert content["units"] == {k: v or "1" for k, v in (STATE | PARAMETERS).items()}
    assert "[" not in invoke("equilibria", described(tmp_path, bare()))
    assert "units" not in json.loads(invoke("equilibria", path, "--json"))


def test_the_step_of_a_method_is_a_time() -> None:
    found = Tradeoff.__new__(Tradeoff)
    object.__setattr__(found, "rows", ())
    assert tradeoff_csv(found, "ms").splitlines()[0].split(",")[3] == "step [ms]"
    assert tradeoff_csv(found).splitlines()[0].split(",")[3] == "step"


def test_dimensionless_results_have_no_physical_unit(tmp_path: Path) -> None:
    """In dimensionless time and notation the linear equations are numbers; only eigenvalues are in the time t."""
    folder = ROOT / "tests" / "source" / "test_units.py"
    units = re.search(r'SATELLITE = """(.*?)"""', folder.read_text(encoding="utf-8"), re.DOTALL)
    assert units is not None
    path = filed(
        tmp_path / "satellite.yaml", (ROOT / "systems" / "satellite.yaml").read_text(encoding="utf-8") + units[1]
    )
    invoke("run", path, "--format", "latex", "--problems", "4,5,6", "--out", tmp_path / "out")
    text = (tmp_path / "out" / "report.tex").read_text(encoding="utf-8")
    assert r"[\mathrm{kg}\,\mathrm{m}^{2}]" in text
    after = text[text.index("Problem 4. The unperturbed motion") :]
    assert "Eigenvalues" in after
    assert not re.search(r"\[\\mathrm\{(kg|m|s|rad)", after)
    assert len(re.findall(r"\[1/\\mathrm\{s\}\]", after)) == len(re.findall("Eigenvalues there", after))
