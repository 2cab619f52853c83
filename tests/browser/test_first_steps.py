"""What somebody meets who opens the editor for the first time: names that nobody knows, a file that is taken away."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import windows
import yaml
from windows import Window, serving

from mbsym.analysis import Analysis
from mbsym.source import read

browser, opened = windows.browser, windows.opened
CART = """mbsym: 1
name: Cart
bodies:
  - name: cart
    attached to: 0
    mass: 0
  - name: pole
    attached to: cart
    rotation: {axes: [3, 0, 0], angles: [theta, 0, 0]}
    mass centre: [0, 1, 0]
    mass: 1
"""


def test_unknown_names_are_settled_where_they_stand_and_a_deleted_file_is_written_again(
    tmp_path: Path, opened: Callable[..., Window]
) -> None:
    path = tmp_path / "cart.yaml"
    path.write_text(CART, encoding="utf-8")
    with serving(path) as address:
        window = opened(address, path)
        window.undrawn()
        form = window.page.locator("#form")
        window.body("cart").click()
        options = form.get_by_label("Previous body", exact=True).locator("option").all_text_contents()
        assert options == ["fixed axes (0)"]  # not what hangs on it
        window.field("Connection point, 1", "x")
        assert "unknown name 'x'" in window.page.locator("#said").inner_text()
        form.get_by_role("button", name="x is a coordinate", exact=True).click()
        window.told("x is a coordinate now")
        assert window.complaints == []
        # Where it stood the focus is, and nothing says any more that it is unknown.
        assert window.page.evaluate("document.activeElement.ariaLabel") == "Connection point, 1"
        assert form.locator(".wrong").count() == 0
        window.page.set_viewport_size({"width": 1280, "height": 690})
        mass = form.get_by_label("Mass", exact=True)
        mass.evaluate("e => e.scrollIntoView({ block: 'end' })")
        mass.fill("M*2")
        mass.press("Enter")
        # Seen, too, where the field is the last one that the panel shows.
        seen = "e => new Promise(r => new IntersectionObserver(([x]) => r(x.intersectionRatio)).observe(e))"
        assert form.get_by_text("unknown name 'M'").evaluate(seen) == 1
        assert form.get_by_role("button", name="M is a coordinate").count() == 0
        # Pressed twice, as many people do: the second time there is nothing left to do, and nothing is said against it.
        form.get_by_role("button", name="M is a parameter", exact=True).dblclick()
        window.told("M is a parameter now")
        assert window.page.locator("#said").inner_text() == "M is a parameter now"
        # With a number it can be simulated at once; only what is a mass itself is known to be positive.
        assert yaml.safe_load(window.text)["parameters"]["M"] == {"sign": "real", "value": 1}
        window.form_of("System")
        form.get_by_label("Add a load", exact=True).click()
        dialog = window.page.locator("dialog[open]")
        dialog.get_by_label("Kind").select_option("spring: between points")
        dialog.get_by_label("stiffness", exact=True).fill("M")
        dialog.get_by_role("button", name="Add", exact=True).click()
        dialog.get_by_text("length is not filled in").wait_for()  # not found out by a complaint afterwards
        window.press("Escape")
        assert yaml.safe_load(window.text)["bodies"][0]["coordinates"] == ["x"]

        path.unlink()
        window.page.locator(".banner.outside").filter(has_text="was deleted").wait_for()
        assert window.page.locator("#saved").inner_text() == "not saved"
        window.page.get_by_role("button", name="Save it again", exact=True).click()
        window.told("saved")
        assert yaml.safe_load(path.read_bytes())["parameters"] == {"M": {"sign": "real", "value": 1}}


def test_an_empty_page_offers_three_ways_to_begin_and_nothing_red(
    tmp_path: Path, opened: Callable[..., Window]
) -> None:
    path = tmp_path / "new.yaml"
    with serving(path) as address:
        window = opened(address, path)
        cards = window.page.locator("#picture .beginnings")
        assert cards.locator("h3").all_text_contents() == ["From a joint", "From an example", "From a text"]
        assert "mistake" not in window.page.locator("body").inner_text()
        cards.get_by_role("button", name="hinge").click()
        window.told("one body on a hinge joint is here")
        assert window.complaints == []
        assert set(window.bodies) == {"body"}
        assert yaml.safe_load(window.text)["parameters"]["m1"]["sign"] == "positive"
        assert cards.count() == 0
        window.page.get_by_role("button", name="Undo", exact=True).click()
        cards.wait_for()
        window.settled()
        cards.locator("textarea").fill("no description")
        cards.get_by_role("button", name="Take it").click()
        window.page.locator("#said").filter(has_text="it begins neither with").wait_for()
        robot = '<robot name="arm"><link name="base"/><link name="arm"><inertial><mass value="1"/><inertia ixx="1" '
        robot += 'iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="j" type="continuous">'
        robot += '<parent link="base"/><child link="arm"/><axis xyz="0 0 1"/></joint></robot>'
        cards.locator("textarea").fill(robot)
        cards.get_by_role("button", name="Take it").click()
        window.told("what was pasted is here")
        assert window.complaints == []
        assert "arm" in window.bodies


def test_an_empty_list_of_bodies_beside_other_mistakes_is_one(tmp_path: Path, opened: Callable[..., Window]) -> None:
    path = tmp_path / "wrong.yaml"
    path.write_text("mbsym: 1\nname: wrong\nbodies: []\nparameter: {m: positive}\n", encoding="utf-8")
    with serving(path) as address:
        window = opened(address, path)
        assert any("there are no bodies" in words for words in window.complaints)


def test_a_cart_with_a_pole_and_a_spring_is_built_by_clicks(tmp_path: Path, opened: Callable[..., Window]) -> None:
    """From an empty page: a slider, a hinge on it, a spring; the equations are those of the book, and it moves.

    (m1 + m2) x'' + m2 l2 (q'' cos q - q'^2 sin q) + k x = 0, (m2 l2^2 + J23) q'' + m2 l2 (x'' cos q + g sin q) = 0.
    """
    path = tmp_path / "cart.yaml"
    with serving(path) as address:
        window = opened(address, path)
        page = window.page
        page.get_by_role("button").filter(has_text="slider").click()
        window.told("one body on a slider joint is here")
        page.get_by_role("button", name="Add body", exact=True).click()
        window.in_dialog("pole")
        window.form_of("System")
        page.locator("#form").get_by_label("Add a load", exact=True).click()
        dialog = page.locator("dialog[open]")
        dialog.get_by_label("Kind", exact=True).select_option(label="spring: on a coordinate")
        dialog.get_by_label("coordinate", exact=True).fill("x11")
        dialog.get_by_label("stiffness", exact=True).fill("k")
        dialog.get_by_role("button", name="Add", exact=True).click()
        window.told("k is a parameter now")  # what a spring brings along is declared with it
        assert window.complaints == []
        page.get_by_role("button", name="Simulate", exact=True).click()
        page.get_by_role("button", name="Pause", exact=True).wait_for()
        system, _ = read(window.text, "cart.yaml")
    assert system is not None
    assert {one.name: one.sign for one in system.parameters}["k"] == "positive"
    equations = Analysis(system).equations
    assert equations is not None
    mass, force = equations.mass_matrix, equations.forcing
    assert [str(mass[i, j]) for i, j in ((0, 0), (0, 1), (1, 1))] == ["m1 + m2", "m2*l2*cos(q21)", "m2*l2**2 + J23"]
    assert str(force[1]) == "-g*m2*l2*sin(q21)"
    assert "k*x11" in str(force[0])


TWO = """mbsym: 1
name: Two
parameters: {g: positive}
bodies:
  - {name: first, attached to: 0, mass: 1, connection point: [x, 0, 0], coordinates: [x]}
  - {name: second, attached to: 0, mass: 2, connection point: [xi, 0, 0], coordinates: []}
loads:
  - force: {body: first, point: [0, 0, 0], components: [0, g, 0], axes: 0}
"""


def test_what_is_pressed_stays_while_the_server_answers(tmp_path: Path, opened: Callable[..., Window]) -> None:
    """On a slow machine: a formula that is drawn late wipes no complaint, a look that comes while a badge is held down
    takes no click away, and a remedy is about the body that it stands at though bodies before it are gone."""
    path = tmp_path / "two.yaml"
    path.write_text(TWO, encoding="utf-8")
    with serving(path) as address:
        window = opened(address, path)
        page = window.page
        held: list[Any] = []

        def hold(pattern: str) -> None:
            """Answers are kept back until `let_go`; once each, so that what is asked again goes through."""
            page.route(pattern, lambda one: held.append(one), times=1)

        def let_go() -> None:
            while held:
                held.pop().continue_()

        window.body("second").click()
        hold("**/api/formula")
        mass = page.locator("#form").get_by_label("Mass", exact=True)
        mass.fill("2*zeta")
        mass.press("Enter")
        remedy = page.get_by_role("button", name="zeta is a parameter", exact=True)
        remedy.wait_for()
        with page.expect_response("**/api/formula"):
            let_go()
        page.wait_for_timeout(100)
        assert remedy.is_visible()
        window.press("Control+z")
        window.settled()

        hold("**/api/look")
        page.locator(".cm-content").focus()
        window.press("Control+End")
        window.typed("# a longer text")
        page.locator("#graph .badge.load").first.hover()
        page.mouse.down()
        let_go()
        window.settled()
        page.mouse.up()
        window.until("getSelection().toString().includes('components')")

        window.body("second").click()
        without_first = TWO.replace(TWO[TWO.index("  - {name: first") : TWO.index("  - {name: second")], "")
        window.write(without_first.partition("loads:")[0])
        page.get_by_role("button", name="xi is a coordinate", exact=True).click()
        window.told("xi is a coordinate now")
        assert yaml.safe_load(window.text)["bodies"][0]["coordinates"] == ["xi"]
