"""The graph, the text and the file in a real browser: three views of one document, one history."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import windows
import yaml
from conftest import SHIPPED
from windows import Window, serving

from mbsym.source import read

browser, opened = windows.browser, windows.opened
PENDULUM = (SHIPPED / "double-pendulum.yaml").read_text(encoding="utf-8")
SATELLITE = (SHIPPED / "satellite.yaml").read_text(encoding="utf-8")


class Server:
    """One server for the module: each test puts its own text into the one file before it opens the page."""

    def __init__(self, address: str, path: Path) -> None:
        self.address, self.path = address, path


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    path = tmp_path_factory.mktemp("edited") / "system.yaml"
    path.write_text(PENDULUM, encoding="utf-8")
    with serving(path) as address:
        yield Server(address, path)


Show = Callable[..., Window]


@pytest.fixture
def show(server: Server, opened: Callable[..., Window]) -> Show:
    def shown(text: str, **settings: object) -> Window:
        server.path.write_bytes(text.encode())
        return opened(server.address, server.path, **settings)

    return shown


def test_the_graph_says_what_hangs_on_what(show: Show) -> None:
    window = show(SATELLITE)
    assert window.bodies == {
        "orbital frame": "fixed axes (0)",
        "satellite": "orbital frame",
        "rod": "satellite",
        "point mass": "rod",
    }
    assert window.complaints == []


def test_a_body_is_added_renamed_duplicated_reattached_and_deleted_by_keys(show: Show) -> None:
    """And undone, step by step, to the bytes from which it began."""
    window = show(PENDULUM)
    window.body("second rod").click()
    window.press("a")
    window.in_dialog("bob")
    assert window.bodies["bob"] == "second rod"
    window.press("F2")
    window.in_dialog("weight")
    assert window.bodies["weight"] == "second rod"
    window.press("x", "ArrowUp", "ArrowUp", "v")
    window.told("hangs on")
    assert window.bodies["weight"] == "first rod"
    window.press("d")
    window.told("duplicated")
    assert len(window.bodies) == 4
    window.press("Delete")
    window.in_dialog()
    window.settled()
    assert set(window.bodies) == {"first rod", "second rod", "weight"}
    system, _ = read(window.text, "system.yaml")
    assert system is not None
    assert [body.name for body in system.bodies] == ["first rod", "second rod", "weight"]
    for _ in range(5):
        window.press("Control+z")
        window.settled()
    assert window.text == PENDULUM
    for _ in range(5):
        window.press("Control+Shift+z")
        window.settled()
    assert set(window.bodies) == {"first rod", "second rod", "weight"}


def test_a_branch_is_dragged_to_another_body(show: Show) -> None:
    window = show(SATELLITE)
    window.body("point mass").drag_to(window.body("satellite"))
    window.told("hangs on")
    assert window.bodies["point mass"] == "satellite"
    changed = SATELLITE.replace("attached to: rod", "attached to: satellite")
    assert window.text == changed
    # What hangs on a body cannot carry it.
    window.body("satellite").drag_to(window.body("rod"))
    assert window.text == changed


def test_duplicating_says_what_goes_along_and_what_does_not(show: Show) -> None:
    window = show(SATELLITE)
    window.body("rod").click()
    window.press("d")
    dialog = window.page.locator("dialog[open]")
    said = dialog.inner_text()
    assert "2 bodies: rod, point mass" in said
    assert "Copied with it: motion: delta, sigma" in said
    assert "Copied with it: initial: delta, sigma" in said
    assert "Not copied: claims" in said
    window.press("Escape")
    dialog.wait_for(state="detached")
    assert window.text == SATELLITE
    window.press("d")
    window.in_dialog()
    assert window.bodies["point mass 2"] == "rod 2"
    system, complaints = read(window.text, "system.yaml")
    assert system is not None, complaints.sorted()
    assert {"delta2", "sigma2"} <= set(system.coordinates)
    window.press("Control+z")
    window.settled()
    assert window.text == SATELLITE


def test_deleting_lists_what_goes(show: Show) -> None:
    window = show((SHIPPED / "four-bar.yaml").read_text(encoding="utf-8"))
    window.body("coupler").click()
    window.press("Delete")
    window.page.locator("dialog[open]").wait_for()
    said = window.page.locator("dialog[open]").inner_text()
    assert "2 bodies: coupler, rocker" in said
    assert "Constraints on them" in said
    window.press("Escape")
    assert len(window.bodies) == 3
    window = show(SATELLITE)
    window.body("satellite").click()
    window.press("Delete")
    window.page.locator("dialog[open]").wait_for()
    said = window.page.locator("dialog[open]").inner_text()
    assert "3 bodies: satellite, rod, point mass" in said
    assert "Claims: 1 (direction cosine), 2 (direction cosine)" in said  # of the satellite
    window.press("Escape")
    assert window.text == SATELLITE


def test_complaints_stand_in_place_and_lead_there(show: Show) -> None:
    window = show(PENDULUM.replace("mass: m1", "mass: m7"))
    (complaint,) = window.complaints
    assert "m7" in complaint
    window.page.locator(".complaint").click()
    window.typed("m1")
    assert window.complaints == []
    assert window.text == PENDULUM


def test_complaints_follow_each_key(show: Show) -> None:
    """How long they take is measured by tests/bench/window_bench.py."""
    window = show(SATELLITE)
    window.page.locator(".cm-content").focus()
    window.press("Control+End")
    for key in "xyz":
        window.typed(key)
        window.settled()
        assert window.complaints != [], key
    for _ in "xyz":
        window.press("Backspace")
    window.settled()
    assert window.complaints == []


MARKUP = "<img src=x onerror=alert(1)><script>alert(2)</script>"


def test_markup_in_a_description_stays_text(show: Show) -> None:
    """In names, meanings and complaints; nothing of it becomes an element, nothing runs."""
    text = PENDULUM.replace("second rod", f"'{MARKUP}'").replace("mass at the tip", f"'{MARKUP}'")
    text = text.replace("mass: m2", "mass: m2*<b>nobody</b>")
    window = show(text)
    window.page.on("dialog", lambda dialog: (window.troubles.append(dialog.message), dialog.dismiss()))
    window.body(MARKUP).click()
    assert window.complaints != []
    for element in ("img", "script:not([src='page.js'])", "b"):
        assert window.page.locator(element).count() == 0, element
    window.press("Delete")
    assert MARKUP in window.page.locator("dialog[open]").inner_text()
    window.press("Escape")


def test_two_windows_on_one_file_lose_nothing(show: Show, server: Server, opened: Callable[..., Window]) -> None:
    one = show(PENDULUM)
    other = opened(server.address, server.path)
    one.body("first rod").click()
    one.press("F2")
    one.in_dialog("upper rod")
    other.body("second rod").click()
    other.press("F2")
    other.in_dialog("lower rod")
    one.save()
    theirs = server.path.read_text(encoding="utf-8")
    assert "upper rod" in theirs
    # The other window learns of it, and keeps its own text until somebody decides.
    other.page.locator(".banner.outside").wait_for()
    assert "lower rod" in other.bodies
    assert server.path.read_text(encoding="utf-8") == theirs
    other.page.get_by_role("button", name="Load it").click()
    other.settled()
    assert set(other.bodies) == {"upper rod", "second rod"}
    other.press("Control+z")
    other.settled()
    assert "lower rod" in other.bodies


def test_saving_over_what_somebody_else_wrote_asks(show: Show, server: Server) -> None:
    """Also when the page has told of the change and nobody has decided anything."""
    window = show(PENDULUM)
    window.body("first rod").click()
    window.press("F2")
    window.in_dialog("upper rod")
    theirs = f"{PENDULUM}# theirs\n"
    server.path.write_text(theirs, encoding="utf-8")
    window.page.locator(".banner.outside").wait_for()
    window.press("Control+s")
    dialog = window.page.locator("dialog[open]")
    dialog.wait_for()
    assert "# theirs" in dialog.inner_text()
    window.press("Escape")
    assert server.path.read_text(encoding="utf-8") == theirs
    window.page.get_by_role("button", name="Keep this text").click()
    window.save()
    assert "upper rod" in server.path.read_text(encoding="utf-8")


def test_tabs_on_a_tablet_and_colours(show: Show) -> None:
    window = show(PENDULUM, color_scheme="dark")
    page = window.page
    page.set_viewport_size({"width": 820, "height": 1180})
    page.get_by_role("tab", name="Body and system").click()
    assert page.locator("#form").is_visible()
    assert not page.locator("#graph").is_visible()
    page.get_by_role("tab", name="Structure").click()
    window.body("first rod").click()
    back = "getComputedStyle(document.body).backgroundColor"
    dark = page.evaluate(back)
    page.locator("#theme").select_option("light")
    assert page.evaluate(back) == "rgb(255, 255, 255)" != dark
    page.locator("#theme").select_option("system")
    assert page.evaluate(back) == dark


#: Everything that can be operated says what it is: computed by the browser as for a screen reader.
NAMELESS = """() => {
  const found = [];
  for (const element of document.querySelectorAll('button, input, select, textarea, a, [tabindex], [role]')) {
    if (element.closest('[hidden]') || element.offsetParent === null || element.tagName === 'OPTION') continue;
    const label = element.getAttribute('aria-label') || element.labels?.[0]?.textContent
      || document.getElementById(element.getAttribute('aria-labelledby') ?? '')?.textContent || element.textContent;
    const named = ['status', 'alert', 'presentation', 'none', 'tablist'];
    if (!named.includes(element.getAttribute('role')) && !label?.trim()) found.push(element.outerHTML.slice(0, 120));
  }
  const ids = [...document.querySelectorAll('[id]')].map(e => e.id);
  return found.concat(ids.filter((id, index) => ids.indexOf(id) !== index).map(id => `twice: ${id}`));
}"""


def test_everything_has_a_name_and_can_be_reached_by_keys(show: Show) -> None:
    window = show(PENDULUM)
    window.body("first rod").click()
    assert window.page.evaluate(NAMELESS) == []
    # Tab goes through the page and out of every panel, the text included.
    window.page.locator("#do-new").focus()
    reached = set()
    for _ in range(150):
        window.press("Tab")
        place = "document.activeElement.closest('section, header, footer')?.id || document.activeElement.tagName"
        reached.add(window.page.evaluate(place))
        if reached >= {"graph", "form", "text", "results"}:
            break
    assert reached >= {"graph", "text"}
    focused = []
    for _ in range(5):
        window.press("F6")
        focused.append(window.page.evaluate("document.activeElement.closest('section').id"))
    assert set(focused) == {"graph", "form", "text", "picture", "results"}
    window.press("F1")
    assert "Structure" in window.page.locator("dialog[open]").inner_text()
    window.press("Escape")


def test_a_chain_of_fifty_is_usable(show: Show) -> None:
    """Every body is there and can be reached (how quickly: tests/bench/window_bench.py)."""
    bodies = [
        {
            "name": f"link {i}",
            "attached to": f"link {i - 1}" if i > 1 else 0,
            "rotation": {"axes": [3], "angles": [f"q{i}"]},
            "mass": 1,
            "connection point": [0, -1 if i > 1 else 0, 0],
            "mass centre": [0, -1, 0],
        }
        for i in range(1, 51)
    ]
    description = {"mbsym": 1, "name": "Chain", "bodies": bodies}
    window = show(yaml.safe_dump(description, sort_keys=False))
    assert len(window.bodies) == 50
    window.page.locator("#graph [role=treeitem]").first.focus()
    for _ in range(50):
        window.press("ArrowDown")
    assert window.page.evaluate("document.activeElement.ariaLabel").startswith("link 50,")
    assert window.page.evaluate("document.activeElement.getBoundingClientRect().bottom") < 720


#: Principal moments about the mass centre for m = 60, l = 2, r = 3, h = 4, edges 1, 2, 3, worked out by hand: a rod
#: m l^2/12, a disc m r^2/4 and m r^2/2, a cylinder m (3 r^2 + h^2)/12, a box m (b^2 + c^2)/12, a sphere 2 m r^2/5, a
#: shell 2 m r^2/3; along which axis of the body its own lies.
SOLIDS = [
    ("thin rod", 2, (20, 0, 20)),
    ("thin disc", 3, (135, 135, 270)),
    ("cylinder", 1, (270, 215, 215)),
    ("box", None, (65, 50, 25)),
    ("sphere", None, (216, 216, 216)),
    ("thin spherical shell", None, (360, 360, 360)),
]


def test_moments_of_inertia_of_solids_are_those_of_the_tables(show: Show) -> None:
    window = show(PENDULUM)
    window.body("first rod").click()
    for name, axis, expected in SOLIDS:
        window.page.get_by_role("button", name="Inertia of a rod, disc, box, sphere or shell").click()
        dialog = window.page.locator("dialog[open]")
        dialog.get_by_label("Shape").select_option(label=name)
        if axis is not None:
            dialog.get_by_label("Its own axis lies along").select_option(label=f"axis {axis}")
        window.in_dialog_take()
        body = yaml.safe_load(window.text)["bodies"][0]
        assert body["inertia about"] == "mass centre"
        numbers = {"m1": 60, "l": 2, "r": 3, "h": 4, "a": 1, "b": 2, "c": 3}
        values = [eval(str(moment), {}, numbers) for moment in body["inertia"]]
        assert values == pytest.approx(expected), name


def test_a_motion_asked_for_before_events_are_heard_is_shown(show: Show, server: Server) -> None:
    """A job tells of itself by events: one that is begun before the page hears them would never be shown."""
    window = show(PENDULUM)

    def late(route: Any) -> None:
        window.page.wait_for_timeout(1500)
        route.continue_()

    window.page.route("**/api/events*", late)
    window.open(server.address)
    window.page.get_by_role("button", name="Simulate").click()
    window.page.get_by_label("Time", exact=True).wait_for()


def test_the_other_spelling_is_converted_to_pasted_and_undone(show: Show) -> None:
    window = show(PENDULUM)
    spelling = window.page.locator("#format")
    window.page.locator("#do-convert").click()
    window.told("converted")
    assert spelling.text_content() == "editor text"
    assert set(window.bodies) == {"first rod", "second rod"}
    assert window.complaints == []
    window.press("Control+z")
    window.settled()
    assert spelling.text_content() == "YAML"
    assert window.text == PENDULUM
    window.write((SHIPPED / "satellite.txt").read_text(encoding="utf-8"))
    assert spelling.text_content() == "editor text"
    assert window.complaints == []
    assert "rod" in window.bodies


def test_a_file_with_other_line_ends_keeps_them(show: Show) -> None:
    text = PENDULUM.replace("\n", "\r\n")
    window = show(text)
    window.body("first rod").click()
    window.press("F2")
    window.in_dialog("upper rod")
    assert window.text == text.replace("name: first rod", "name: upper rod").replace("to: first rod", "to: upper rod")


def test_a_body_is_asked_for_its_joint_and_axis(show: Show) -> None:
    """A slider along the second axis on a hinge: their coordinates, masses and moments are there, and are positive."""
    window = show("mbsym: 1\nname: Two\nbodies: []\n")
    window.page.locator("#graph [role=treeitem]").first.focus()
    window.press("a")
    window.in_dialog("arm")
    window.body("arm").focus()
    window.press("a")
    dialog = window.page.locator("dialog[open]")
    dialog.wait_for()
    assert dialog.get_by_label("Joint").input_value() == "hinge"
    dialog.get_by_label("Joint").select_option("ball")
    assert dialog.get_by_label("Axis").is_disabled()
    dialog.get_by_label("Joint").select_option("slider")
    dialog.get_by_label("Axis").select_option("2")
    window.in_dialog_take()
    system, _ = read(window.text, "system.yaml")
    assert system is not None
    assert system.coordinates == ("q11", "x22")
    assert window.bodies == {"arm": "fixed axes (0)", "body 2": "arm"}
    assert {one.sign for one in system.parameters} == {"positive"}
