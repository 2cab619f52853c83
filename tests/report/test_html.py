"""``report.html``: its formulas are worth what the exact results are, and a real browser shows it as it is meant."""

from __future__ import annotations

import json
import random
import re
from dataclasses import replace
from fractions import Fraction
from html import unescape
from html.parser import HTMLParser
from pathlib import Path

import pytest
from conftest import SHIPPED, TESTS, browsed, derived, filed, needs_chromium, precision, with_letters
from flint import arb, fmpq
from mathml_reader import Reader, formulas, tokens_of, tree, written

import mbsym
from mbsym.analysis import Analysis
from mbsym.formulas.formula import Formula
from mbsym.report.targets import TARGETS
from tests.report.readers import unreadable

ALL = (1, 2, 3, 4, 5, 6, 7)


def page_of(analysis: Analysis, problems: tuple[int, ...] = ALL) -> str:
    return TARGETS["html"].render(analysis, problems)


def point(analysis: Analysis, seed: int) -> dict[str, Fraction]:
    """A random rational value of every name, velocities by ``x_dot``."""
    source = random.Random(seed)
    values = {name: Fraction(source.randint(20, 90), 64) for name in analysis.ring.names()}
    known = with_letters(analysis.system, values, Fraction)
    return {name: value for name, value in known.items() if name != "Dis"}  # a word, which this reader does not know


def balls(analysis: Analysis, values: dict[str, Fraction]) -> dict[str, arb]:
    """By what stands in a formula."""
    exact = {name: arb(fmpq(value.numerator, value.denominator)) for name, value in values.items()}
    found = {"\u03c0": arb.pi()}
    for name, value in exact.items():
        base, _, dots = name.rpartition("_")
        if name == "t":
            found["t"] = value
        elif dots in ("dot", "ddot") and base:
            found[written(base, "'" if dots == "dot" else "''")] = value
        else:
            found[written(name)] = value
    return found


def exact(analysis: Analysis, formula: Formula, values: dict[str, Fraction]) -> arb:
    known = {name: arb(fmpq(value.numerator, value.denominator)) for name, value in values.items()}
    return formula.ring.evaluate(formula.polynomial, known)


def wanted(analysis: Analysis) -> dict[str, Formula]:
    """Lines that a page has unless they stand in a matrix, by their left-hand sides."""
    found = {f"f_{k}": x for k, x in enumerate(analysis.equations.forcing, start=1)}
    found["U"] = analysis.energy.force_function
    for i, row in enumerate(analysis.equations.mass_matrix, start=1):
        found |= {f"M_{i}{j}": x for j, x in enumerate(row, start=1) if j >= i and not x.is_zero}
    return found


@pytest.mark.parametrize("name", ["satellite", "double-pendulum", "spring-pendulum", "ziegler-damped"])
def test_formulas_are_worth_what_the_exact_results_are(name: str) -> None:
    """Read by a reader that knows nothing of mbsym, at a random rational point, with balls of 200 bits."""
    analysis = derived(SHIPPED / f"{name}.yaml")
    lines = formulas(tree(page_of(analysis, (2, 3))))
    values = point(analysis, 7)
    checked = 0
    with precision(200):
        known = balls(analysis, values)
        for left, formula in wanted(analysis).items():
            tokens = lines.get(left)
            if tokens is not None:
                assert Reader(tokens, known).value().overlaps(exact(analysis, formula, values)), left
                checked += 1
        table = [tokens for left, tokens in lines.items() if left == "M" and tokens[1][0] == "table"]
        for rows in table:
            for row, formulas_of in zip(rows[1][1], analysis.equations.mass_matrix, strict=True):
                for cell, formula in zip(row, formulas_of, strict=True):
                    factor = Reader([rows[0]], known).value() if rows[0][0] == "mn" else 1
                    assert (factor * Reader(cell, known).value()).overlaps(exact(analysis, formula, values))
    assert checked >= len(analysis.system.coordinates) + 1


def told_values(page: str, known: dict[str, arb], number: int = 3) -> dict[str, arb]:
    """What is told through named intermediates, read from top to bottom: each line may use those above it."""
    root = tree(page)
    (problem,) = [section for section in root.iter("section") if section.get("id") == f"problem-{number}"]
    found = dict(known)
    for line in (item for item in problem if item.tag == "div"):
        equations: list[list[tuple[str, object]]] = []
        for part in line.iter("math"):
            tokens = tokens_of(part)
            if not equations or (("mo", "=") in tokens and tokens[0] != ("mo", "=")):  # a line may end in front of "="
                equations.append([])
            equations[-1] += tokens
        for tokens in equations:
            place = tokens.index(("mo", "="))
            name = "".join(str(value) for _, value in tokens[:place])
            found[name] = Reader(tokens[place + 1 :], found).value()
    return found


def test_what_is_told_through_intermediates_is_worth_the_same() -> None:
    """From the first definition to M and f, read as a person would; a slip in a definition is seen below it."""
    analysis = derived(SHIPPED / "satellite.yaml")
    page = page_of(analysis, (3,))
    assert page.count('class="formula told"') > 10
    values = point(analysis, 11)
    # What relations and prescribed motion determine is no free value: nu = omega0^2 R^3 is used from problem 4 on only.
    with precision(200):
        known = balls(analysis, values)
        wanted_of = {
            **{f"f_{k}": x for k, x in enumerate(analysis.equations.forcing, start=1)},
            **{f"M_{i}{i}": analysis.equations.mass_matrix[i - 1, i - 1] for i in range(1, 6)},
        }

        def wrong(text: str) -> list[str]:
            found = told_values(text, known)
            return [name for name, x in wanted_of.items() if not found[name].overlaps(exact(analysis, x, values))]

        assert wrong(page) == []
        energies = told_values(page_of(analysis, (2,)), known, 2)
        assert energies["T"].overlaps(exact(analysis, analysis.energy.kinetic_energy, values))
        assert energies["U"].overlaps(exact(analysis, analysis.energy.force_function, values))
        place = page.index("<mo>\u2212</mo>", page.index("Moment about the connection point that body 2"))
        assert wrong(page[:place] + "<mo>+</mo>" + page[place + len("<mo>\u2212</mo>") :]) != []


def test_a_wrong_sign_exponent_or_name_is_seen() -> None:
    """Each planted into the page: the reader finds another value, or nothing that it can read."""
    analysis = derived(SHIPPED / "satellite.yaml")
    page = page_of(analysis, (2, 3))
    values, source = point(analysis, 3), random.Random(1)
    start = page.index("<details><summary>The same, written out", page.index('id="problem-3"'))
    end = page.index("</section>", start)
    slips = (
        (r"<mo>\+</mo>", "<mo>\u2212</mo>"),
        (r"<mo>\u2212</mo>", "<mo>+</mo>"),
        (r"<mn>2</mn></msup>", "<mn>3</mn></msup>"),
        (r"<mi>sin</mi>", "<mi>cos</mi>"),
        (r"<mi>\u03b4</mi>", "<mi>\u03c3</mi>"),
        (r"<mn>3</mn>", "<mn>4</mn>"),
        ("<mo>\u2062</mo>", "<mo>+</mo>"),
    )

    def sound(text: str) -> bool:
        try:
            lines = formulas(tree(text))
            with precision(200):
                known = balls(analysis, values)
                return all(
                    Reader(lines[left], known).value().overlaps(exact(analysis, formula, values))
                    for left, formula in wanted(analysis).items()
                    if left in lines
                )
        except (AssertionError, KeyError, ValueError):
            return False

    body = page[: page.index("<body>") + 6]
    section = page[start:end]
    assert sound(f"{body}{section}</body></html>")
    for pattern, slip in slips:
        place = source.choice([*re.finditer(pattern, section)])
        changed = section[: place.start()] + slip + section[place.end() :]
        assert not sound(f"{body}{changed}</body></html>"), pattern


def test_every_piece_is_markup_of_ours() -> None:
    """No tag has been escaped by mistake, and the production reader takes the page."""
    for name in ("satellite", "tethered-satellites", "heavy-top", "ziegler-damped", "gyrostat"):
        page = page_of(derived(SHIPPED / f"{name}.yaml"))
        assert "&lt;m" not in page
        assert unreadable("report.html", page) == ""


def test_the_production_reader_refuses_what_is_not_ours() -> None:
    page = page_of(derived(SHIPPED / "simple-pendulum.yaml"), (3,))
    for planted in (
        '<img src="https://example.org/x.png"/>', '<p onclick="x()">a</p>', '<a href="javascript:x()">a</a>',
        '<p style="color:red">a</p>', "<p>never closed", "a & b", "<p>\x07</p>",
    ):  # fmt: skip
        assert unreadable("report.html", page.replace("<main", planted + "<main", 1)) != "", planted


def test_the_same_description_gives_the_same_bytes() -> None:
    pages = {page_of(mbsym.load(SHIPPED / "double-pendulum.yaml")) for _ in range(2)}
    assert len(pages) == 1


class Outline(HTMLParser):
    """Headings in their order, pictures without a text, tables without headings of columns."""

    def __init__(self) -> None:
        super().__init__()
        self.levels: list[int] = []
        self.ids: list[str] = []
        self.targets: list[str] = []
        self.language = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        known = dict(attrs)
        if re.fullmatch(r"h[1-6]", tag):
            self.levels.append(int(tag[1]))
        if tag == "html":
            self.language = known.get("lang") or ""
        if known.get("id"):
            self.ids.append(str(known["id"]))
        self.targets += [str(known[key])[1:] for key in ("href",) if (known.get(key) or "").startswith("#")]


@pytest.mark.parametrize("name", ["satellite", "tethered-satellites"])
def test_the_outline_is_in_order(name: str) -> None:
    """One first heading, none that skips a level, no name twice, every link leads somewhere, a language."""
    found = Outline()
    found.feed(page_of(derived(SHIPPED / f"{name}.yaml")))
    assert found.levels.count(1) == 1
    assert all(after <= before + 1 for before, after in zip(found.levels, found.levels[1:], strict=False))
    assert len(set(found.ids)) == len(found.ids)
    assert set(found.targets) <= set(found.ids)
    assert found.language == "en"


def contrast(first: str, second: str) -> float:
    """The ratio of WCAG 2."""

    def luminance(colour: str) -> float:
        parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
        linear = [x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4 for x in parts]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    high, low = sorted((luminance(first), luminance(second)), reverse=True)
    return (high + 0.05) / (low + 0.05)


def test_words_can_be_read_on_their_grounds() -> None:
    """4.5 to 1 at least, light and dark (WCAG 2, AA)."""
    style = (Path(mbsym.__file__).parent.parent / "templates" / "html" / "page.css").read_text(encoding="utf-8")
    blocks = re.findall(r":root \{([^}]*--paper: #[^}]*)\}", style)
    assert len(blocks) >= 2
    for block in blocks[:2]:
        colours = dict(re.findall(r"--(\w+): (#[0-9a-f]{6});", block))
        for ground in ("paper", "field", "body"):
            for ink in ("ink", "soft", "accent", "good", "bad", "open") if ground != "body" else ("ink",):
                assert contrast(colours[ink], colours[ground]) >= 4.5, (ink, ground)


# --- a browser --------------------------------------------------------------------------------------------------------

ATTACK = "</script><script>document.title='owned'</script><img src=x onerror=\"document.title='owned'\"/>"

HOSTILE = f"""
mbsym: 1
name: {json.dumps(ATTACK)}
description: {json.dumps(ATTACK + "]]>&amp;<!--")}
parameters:
  m: {{sign: positive, value: 1, meaning: {json.dumps(ATTACK)}}}
  g: {{sign: positive, value: 9.81}}
  l: {{sign: positive, value: 1}}
prescribed: {{p: {{rate: g, meaning: {json.dumps(ATTACK)}}}}}
bodies:
  - {{name: cart, attached to: 0, rotation: {{axes: [3], angles: [p]}}, mass: 0}}
  - {{name: bob, attached to: cart, rotation: {{axes: [3], angles: [theta]}}, mass centre: [0, -l, 0], mass: m}}
loads:
  - uniform gravity: {{vector: [0, -g, 0]}}
  - torque: {{body: bob, components: [0, 0, m], axes: cart, reaction on: cart}}
initial: {{theta: 1}}
claims:
  - {{claim: kinetic energy, equals: m*theta_dot, place: {json.dumps(ATTACK)}}}
"""


def hostile() -> Analysis:
    """The reader of descriptions refuses such names of bodies; a system made in Python may have them."""
    system = mbsym.loads(HOSTILE).system
    names = {"cart": "cart " + ATTACK, "bob": ATTACK, "0": "0"}
    bodies = tuple(replace(x, name=names[x.name], attached_to=names[x.attached_to]) for x in system.bodies)
    torque = replace(system.loads[1], body=names["bob"], axes=names["cart"], reaction_on=names["cart"])
    return Analysis(replace(system, bodies=bodies, loads=(system.loads[0], torque)))


@needs_chromium
def test_names_of_a_description_are_inert(tmp_path: Path) -> None:
    analysis = hostile()
    (tmp_path / "report.html").write_text(page_of(analysis), encoding="utf-8")
    found, said = browsed(tmp_path / "report.html")
    assert "owned" not in re.search(r"<title>(.*?)</title>", found)[1].split("&lt;")[0]
    assert found.count("<script") == page_of(analysis).count("<script")
    assert not re.search(r"<img", found)
    assert ATTACK in re.sub(r"&lt;", "<", re.sub(r"&gt;", ">", found)).replace("&quot;", '"')
    assert said == []


@needs_chromium
def test_a_browser_shows_the_satellite(tmp_path: Path) -> None:
    """No complaint on the console; formulas are MathML elements with a size; folds open; the words are those of JSON.

    The page's own policy forbids scripts of a test, so what the browser made of it is read from the DOM.
    """
    analysis = derived(SHIPPED / "satellite.yaml")
    page = page_of(analysis)
    file = filed(tmp_path / "report.html", page)
    dom, said = browsed(file)
    assert said == []
    assert 'id="fold" type="button" data-fold=' in dom  # its script ran: the button is no longer hidden
    assert dom.count("<math>") == page.count("<math>") > 500
    results = json.loads(TARGETS["json"].render(analysis, ALL))["stability"]
    assert re.search(r'id="verdict"[^>]*>([^<]*)<', dom)[1] == results["verdict"]
    assert re.search(r'id="verdict-at-values"[^>]*>([^<]*)<', dom)[1] == results["at_values"]["verdict"]
    # A probe in place of the policy: what is laid out, before and after everything is unfolded.
    probe = """<script>
    const tall = () => [...document.querySelectorAll("details .formula math")].filter((m) =>
      m.namespaceURI.endsWith("MathML") && m.checkVisibility() && m.getBoundingClientRect().height > 5).length;
    const before = tall(); document.getElementById("fold").click(); const open = tall();
    document.getElementById("fold").click(); const shut = tall();
    document.body.dataset.seen = [before, open, shut, document.documentElement.scrollWidth - innerWidth].join();
    </script></body>"""
    file.write_text(re.sub(r"<meta http-equiv[^>]*>", "", page).replace("</body>", probe), encoding="utf-8")
    dom, said = browsed(file, "--window-size=500,900")
    before, opened, shut, beyond = map(int, re.search(r'data-seen="([^"]*)"', dom)[1].split(","))
    assert said == []
    assert before == shut == 0
    assert opened > 200
    assert beyond <= 0  # nothing makes the page wider than a narrow window


@needs_chromium
def test_nothing_but_the_page_itself_is_run(tmp_path: Path) -> None:
    """The policy that stands in the page refuses a script whose hash it does not know."""
    page = page_of(derived(SHIPPED / "simple-pendulum.yaml"), (3,))
    (tmp_path / "report.html").write_text(page.replace("</body>", "<script>document.title='owned'</script></body>"))
    dom, said = browsed(tmp_path / "report.html")
    assert "<title>owned" not in dom
    assert any("Content Security Policy" in line for line in said)


def test_equations_with_multipliers_are_not_told_as_equations_without() -> None:
    """Of a rolling disc in speeds M u' = f + J^T lambda: the equations of the bodies alone are not M u' = f."""
    text = TARGETS["html"].render(derived(SHIPPED / "rolling-disc-speeds.yaml"), (3,))
    said = re.sub(r"\s+", "", unescape(re.sub(r"<[^>]+>", "", text)))
    assert "sortedby" in said
    assert "AsMu\u02d9=f" not in said
    assert "Mu\u02d9=f+JTλandJu\u02d9+γ=0" in said
    free = TARGETS["html"].render(derived(SHIPPED / "clebsch-poisson.yaml"), (3,))
    assert "AsMu\u02d9=f" in re.sub(r"\s+", "", unescape(re.sub(r"<[^>]+>", "", free)))


def test_nothing_is_told_of_independent_velocities_where_there_are_none() -> None:
    """A bead that is driven along its line: the constraint leaves no velocity free."""
    text = TARGETS["html"].render(derived(TESTS / "cases" / "statements" / "driven-bead.yaml"), (3,))
    assert "The constraints determine all velocities: nothing is left to be integrated." in text
    assert "(of )" not in re.sub(r"<[^>]+>", "", text)
    assert "without multipliers" not in text


def test_no_piece_of_an_equation_is_wider_than_the_column_beside_the_picture() -> None:
    """Of a rolling disc: lines end inside of wide brackets, too, and in front of what stands on the right; words have
    room around them, under dots as well."""
    page = page_of(derived(SHIPPED / "rolling-disc.yaml"), (1, 2, 3))
    finding = page[page.index("Equations") : page.index("Self-check")]
    pieces = [re.sub("<[^>]*>|\u2061|\u2062", "", one) for one in re.findall(r"<math>(.*?)</math>", finding)]
    assert len(pieces) > 25
    assert max(map(len, pieces)) <= 36
    assert "=λ1" in pieces
    latex = TARGETS["latex"].render(derived(SHIPPED / "rolling-disc.yaml"), (3,))
    assert r"r\, \dot{\mathit{spin}}" in latex
    assert not re.search(r"[a-z] \\d+ot\{\\mathit", latex)


CARTS = """mbsym: 1
name: Two carts
parameters: {m1: positive, m2: positive, k1: real, k2: real, c: positive, p: real}
bodies:
  - {name: a, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: m1}
  - {name: b, attached to: 0, connection point: [y, 0, 0], coordinates: [y], mass: m2}
loads:
  - generalized force: {x: -k1*x - c*x_dot + p*y_dot + p*y, y: -k2*y - 2*c*y_dot - p*x}
motion: {x: 0, y: 0}
"""


def test_lines_end_within_a_long_condition_and_between_many_coordinates() -> None:
    """What has to stay in front of a link is one piece: a condition of Hurwitz was cut off at the edge of the paper."""
    page = page_of(mbsym.loads(CARTS), (6,))
    held = re.findall(r'<span class="together">(.*?)</span>', page)
    assert len(held) > 2
    assert {piece.count("<math>") for piece in held} == {1}
    coordinates = (
        page_of(derived(SHIPPED / "rolling-disc.yaml"), (1, 2, 3)).partition("Coordinates")[2].partition("</dd>")[0]
    )
    assert coordinates.count("<math>") == 5
