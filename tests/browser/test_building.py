"""Systems built in the editor by clicks and keys alone, and every shipped one opened, changed in each view, saved."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import windows
import yaml
from conftest import SHIPPED
from windows import Window, serving

from mbsym.model.system import System
from mbsym.source import read

browser, opened = windows.browser, windows.opened


def system_of(text: str) -> System:
    system, complaints = read(text, "system.yaml")
    assert system is not None, complaints.sorted()
    return system


def yaml_of(text: str) -> dict[str, Any]:
    """The description as plain data, read by another reader of YAML than ours."""
    return dict(yaml.safe_load(text))


def shipped(name: str) -> str:
    return (SHIPPED / f"{name}.yaml").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, Path]]:
    path = tmp_path_factory.mktemp("built") / "system.yaml"
    with serving(path) as address:
        yield address, path


Show = Callable[[str], Window]


@pytest.fixture
def show(address: tuple[str, Path], opened: Callable[..., Window]) -> Show:
    def shown(text: str) -> Window:
        if text:
            address[1].write_bytes(text.encode())
        else:
            address[1].unlink(missing_ok=True)  # a new file
        return opened(*address)

    return shown


SATELLITE = shipped("satellite")
PARAMETERS = {
    "R": ("positive", "50", "radius of the orbit"),
    "omega0": ("positive", "0.5", "orbital angular velocity"),
    "nu": ("positive", "31250", "gravitational parameter of the attracting centre"),
    "M2": ("positive", "10", "mass of the satellite"),
    "m": ("positive", "0.4", "mass of the rod"),
    "m0": ("positive", "0.5", "point mass at the end of the rod"),
    "l": ("positive", "2", "length of the rod"),
    "r": ("nonnegative", "0.6", "distance from O1 to the joint of the rod"),
    "Jx": ("positive", "2.4", "principal moment of inertia of the satellite (roll)"),
    "Jy": ("positive", "1.2", "principal moment of inertia of the satellite (yaw)"),
    "Jz": ("positive", "2.3", "principal moment of inertia of the satellite (pitch)"),
}
#: Figure 3 and section 3 of the paper, body by body: field of the form -> what is typed.
BODIES: dict[str, dict[str, str]] = {
    "orbital frame": {
        "Rotation axis 1": "3",
        "Rotation angle 1": "-chi",
        "Connection point, 1": "R*sin(chi)",
        "Connection point, 2": "R*cos(chi)",
        "Relative velocity, 1": "R*omega0*cos(chi)",
        "Relative velocity, 2": "-R*omega0*sin(chi)",
        "Mass": "0",
    },
    "satellite": {
        "Rotation axis 1": "2",
        "Rotation axis 2": "3",
        "Rotation axis 3": "1",
        "Rotation angle 1": "psi",
        "Rotation angle 2": "theta",
        "Rotation angle 3": "phi",
        "Mass": "M2",
        "Principal moment, 1": "Jx",
        "Principal moment, 2": "Jy",
        "Principal moment, 3": "Jz",
        "Inertia about": "joint",
    },
    "rod": {
        "Rotation axis 1": "3",
        "Rotation axis 2": "1",
        "Rotation angle 1": "delta",
        "Rotation angle 2": "sigma",
        "Connection point, 2": "r",
        "Mass centre, 2": "l/2",
        "Mass": "m",
        "Principal moment, 1": "m*l**2/3",
        "Principal moment, 3": "m*l**2/3",
        "Inertia about": "joint",
    },
    "point mass": {"Connection point, 2": "l", "Mass": "m0"},
}
INITIAL = {
    "psi": ("0.3", "0.1"),
    "theta": ("-0.2", "-0.2"),
    "phi": ("0.25", "0.05"),
    "delta": ("0.4", "0.3"),
    "sigma": ("-0.35", "0.2"),
}


def build_bodies(window: Window) -> None:
    """Each on the one before, by the keys of the graph; then the fields of its form."""
    window.page.locator("#graph [role=treeitem]").first.focus()
    for name, fields in BODIES.items():
        window.body(name).focus() if name in window.bodies else None
        window.press("a")
        window.in_dialog(name, "End")  # no joint yet
        for label, value in fields.items():
            window.field(label, value)
        window.body(name).focus()


def printed(section: str) -> list[tuple[str, str]]:
    """The lines `name: formula` of a section of the satellite's description."""
    lines = yaml_of(SATELLITE)[section]
    return [(str(name), str(value)) for name, value in lines.items()]


def claims_as_fields() -> list[dict[str, str]]:
    """What the paper prints, as its fields: the kind first, since the others depend on it."""
    found = []
    for claim in yaml_of(SATELLITE)["claims"]:
        fields = {"Kind": str(claim.pop("claim"))}
        for key, value in claim.items():
            several = enumerate(value, 1) if isinstance(value, list) else ()
            fields |= {f"{key}, {index}": str(one) for index, one in several} or {key: str(value)}
        found.append(fields)
    return found


def test_the_satellite_is_built_by_clicks_and_keys(show: Show) -> None:
    """From an empty page to Figures 3 and 4, through fields alone: the saved file is `systems/satellite.yaml` as a
    system, and every claim of the paper holds."""
    window = show("")
    window.page.get_by_label("as the text changes").uncheck()  # nothing of what is half built is derived
    window.undrawn()
    window.form_of("System")
    window.field("Name", "Satellite with a gravitational stabilizer")
    window.field("Description", system_of(SATELLITE).description)
    window.field("Dimensionless time", "omega0")
    window.add(
        "Add a parameter to parameters",
        *(
            {"name": name, "sign": sign, "value": value, "meaning": meaning}
            for name, (sign, value, meaning) in PARAMETERS.items()
        ),
    )
    chi = {"name": "chi", "rate": "omega0", "meaning": "angle of the orbital motion"}
    window.add("Add a prescribed motion to prescribed motions", chi)
    build_bodies(window)
    window.form_of("System")
    newton = {"Kind": "newtonian gravity", "constant": "nu", "centre": "0", "about": "orbital frame", "order": "2"}
    window.add("Add a load", newton)
    window.add("Add a relation", {"name": "nu", "equals": "omega0**2*R**3"})
    window.add("Add a coordinate to unperturbed motion", *({"coordinate": name} for name in INITIAL))
    window.add("Add a symbol", *({"name": name, "equals": formula} for name, formula in printed("notation")))
    window.add("Add an assumption", *({"inequality": str(one)} for one in yaml_of(SATELLITE)["assumptions"]))
    window.add(
        "Add a coordinate to initial state",
        *(
            {"coordinate": name, "position": position, "velocity": velocity}
            for name, (position, velocity) in INITIAL.items()
        ),
    )
    window.add(
        "Add an abbreviation", *({"name": name, "equals": formula} for name, formula in printed("abbreviations"))
    )
    window.add("Add a claim", *claims_as_fields())
    assert window.complaints == []
    built = system_of(window.text)
    assert built == system_of(SATELLITE)
    command = [sys.executable, "-m", "mbsym_cli", "run", str(window.path), "--brief"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout
    assert f"{len(built.claims)} held" in done.stdout


def test_the_double_pendulum_is_built_by_the_keyboard_alone(show: Show) -> None:
    """Not one click: panels by F6, bodies by the graph's keys, fields by Tab, the rest as text."""
    window = show("")
    pendulum = shipped("double-pendulum")
    window.page.locator("#graph [role=treeitem]").first.focus()
    for name, fields in {
        "first rod": {"angle-1": "theta1", "axis-1": "3", "mass": "m1", "centre-2": "-l1"},
        "second rod": {"angle-1": "theta2", "axis-1": "3", "point-2": "-l1", "mass": "m2", "centre-2": "-l2"},
    }.items():
        window.press("a")
        window.in_dialog(name, "End")  # no joint yet
        window.press("Enter")
        for _ in range(60):
            at = str(window.page.evaluate("document.activeElement.id")).removeprefix("body-")
            if at in fields:
                window.typed(fields.pop(at))
            if not fields:
                break
            window.press("Tab")
        window.press("Tab")
        window.settled()
        assert not fields
        while not window.page.evaluate("document.activeElement.matches('#graph [role=treeitem]')"):
            window.press("Shift+F6")
        assert window.page.evaluate("document.activeElement.ariaLabel").startswith(name)
    while not window.page.evaluate("document.activeElement.matches('.text-shadow')"):
        window.press("F6")
    window.press("Control+Home", "ArrowDown", "Shift+End")
    window.typed("name: Double pendulum")
    head = pendulum[pendulum.index("description:") : pendulum.index("bodies:")]
    tail = pendulum[pendulum.index("loads:") :]
    window.press("Control+End")
    window.page.keyboard.insert_text(f"\n{head}\n{tail}")
    window.settled()
    assert window.complaints == []
    assert system_of(window.text) == system_of(pendulum)


def outside(before: str, after: str) -> tuple[str, str]:
    """What two texts differ in: the middle of each, between what they begin and end with."""
    first = next(
        (i for i, (a, b) in enumerate(zip(before, after, strict=False)) if a != b), min(len(before), len(after))
    )
    last = 0
    while last < min(len(before), len(after)) - first and before[-1 - last] == after[-1 - last]:
        last += 1
    return before[first : len(before) - last], after[first : len(after) - last]


#: One of each sort: loops, a tree of four bodies, speeds with unit vectors, matrices.
SAMPLE = ["four-bar", "satellite", "gyrostat-poisson", "gyroscopic-pair"]


def test_shipped_systems_are_opened_changed_in_each_view_and_saved(show: Show, address: tuple[str, Path]) -> None:
    """Drawn without complaint; a change in graph, form or text leaves all other bytes; undone, all of them."""
    window = show(shipped(SAMPLE[0]))
    for name in SAMPLE:
        text = shipped(name)
        window.path.write_bytes(text.encode())
        window.open(address[0])
        assert window.complaints == [], name
        names = [body.name for body in system_of(text).bodies]
        assert list(window.bodies) == [] if not names else set(window.bodies) == set(names), name
        if names:
            last = next(one for one in reversed(names) if one not in window.bodies.values())
            window.body(last).click()
            window.press("F2")
            window.in_dialog("renamed body")
            assert "renamed body" in window.bodies, name
            changed = system_of(window.text)
            assert [body.name for body in changed.bodies] == ["renamed body" if one == last else one for one in names]
            window.press("Control+z")
            window.settled()
            assert window.text == text, name
            window.body(last).click()
            window.form_of("Body")
            window.field("Mass", "17/16")
            gone, come = outside(text, window.text)
            assert come in "17/16", (name, gone, come)
            assert "\n" not in gone, (name, gone, come)
            window.page.locator("#do-undo").click()
            window.settled()
            assert window.text == text, name
        window.page.locator(".cm-content").click()
        window.press("Control+End")
        window.page.keyboard.insert_text("# told\n")
        assert window.text == f"{text}# told\n", name


def test_a_cart_with_a_pole_by_keys_alone(show: Show) -> None:
    """From an empty page: two bodies, gravity, a spring, a motion; names that loads bring along are parameters."""
    window = show("")
    page = window.page
    window.press("Tab", "Enter")  # to the structure
    window.press("a")
    window.in_dialog("cart")
    window.press("Control+z")  # a hinge is not what a cart has
    window.settled()
    page.locator("#graph [role=treeitem]").first.focus()
    for name, joint in (("cart", "sl"), ("pole", "hi")):
        window.press("a")
        page.locator("dialog[open]").wait_for()
        window.typed(name)
        window.press("Tab")
        window.typed(joint)
        window.press("Enter")  # in a list, too
        page.locator("dialog").wait_for(state="detached")
        window.settled()
    window.press("l", "Tab")
    window.typed("g")
    window.press("Tab", "Tab")
    window.typed("-1")
    window.press("Enter")
    window.told("g is a parameter now")
    window.press("ArrowUp", "l")
    page.locator("dialog[open]").wait_for()
    window.typed("spr")
    window.press("Tab", "Tab")  # the coordinate is that of the cart
    window.typed("k")
    window.press("Enter")
    window.told("k is a parameter now")
    assert window.complaints == []
    found = yaml_of(window.text)
    assert [one["name"] for one in found["bodies"]] == ["cart", "pole"]
    (coordinate,) = found["bodies"][0]["coordinates"]
    assert found["bodies"][0]["connection point"] == [coordinate, 0, 0]
    gravity, spring = found["loads"]
    assert gravity == {"uniform gravity": {"acceleration": "g", "direction": [0, -1, 0]}}
    assert spring == {"spring": {"coordinate": coordinate, "stiffness": "k"}}
    assert found["parameters"]["k"] == {"sign": "positive", "value": 1}
    window.press("Alt+Shift+Digit4", "Tab", "Tab", "Enter")
    page.get_by_text("No coordinate changes in this motion.").wait_for()


def test_a_four_bar_by_keys_alone_moves(show: Show) -> None:
    """Three links on hinges, the last one led to a point beside the first: closed where they hang, and it swings."""
    window = show("")
    page = window.page
    window.press("Tab", "Enter")  # to the structure
    for name in ("crank", "coupler", "rocker"):
        window.press("a")
        window.in_dialog(name)
    window.press("c")
    page.locator("dialog[open]").wait_for()
    for first, typed in (("coincide, first: point, 1", "a"), ("coincide, second: point, 2", "-d4")):
        while page.evaluate("document.activeElement.ariaLabel") != first:
            window.press("Tab")
        window.typed(typed)
    window.press("Enter")
    window.told("a, d4 are parameters now")
    assert window.complaints == []
    assert yaml_of(window.text)["constraints"] == [
        {"coincide": [{"body": 0, "point": ["a", 0, 0]}, {"body": "rocker", "point": [0, "-d4", 0]}]}
    ]
    window.press("Alt+Shift+Digit4", "Tab", "Tab", "Enter")
    page.get_by_text("drift of the energy").wait_for()
    angles = page.locator("#picture .viewer-slider output").all_text_contents()
    assert len(angles) == 3
    assert all(abs(float(angle)) < 3 for angle in angles)


def test_a_coordinate_that_is_not_there_becomes_no_parameter(show: Show) -> None:
    """Of a spring on 'zz' the stiffness is declared; that there is no such coordinate stays a mistake."""
    window = show(
        "mbsym: 1\nname: bead\nparameters: {m: positive}\nbodies:\n"
        "  - {name: bead, attached to: 0, mass: m, coordinates: [x], connection point: [x, 0, 0]}\n"
    )
    window.form_of("System")
    window.page.get_by_label("Add a load", exact=True).click()
    dialog = window.page.locator("dialog[open]")
    dialog.get_by_label("Kind", exact=True).select_option(label="spring: on a coordinate")
    dialog.get_by_label("coordinate", exact=True).fill("zz")
    dialog.get_by_label("stiffness", exact=True).fill("k")
    dialog.get_by_role("button", name="Add", exact=True).click()
    window.told("k is a parameter now")
    window.settled()
    assert set(yaml_of(window.text)["parameters"]) == {"m", "k"}
    assert any("unknown name 'zz'" in words for words in window.complaints)
