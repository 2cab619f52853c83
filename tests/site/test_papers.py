"""The tables of docs/papers: whole, counted, and their verdicts on prints those of derivations made without mbsym.

That the pages' commands print what stands there is tested with all pages (test_pages.py).
"""

from __future__ import annotations

import re
from collections import Counter

import pytest
from conftest import reference
from pages import DOCS, blocks

TRUTH = reference("papers")
PAGES = list(TRUTH["print"])
ROW = re.compile(r"^\| (\d+) \|(.*)\|$", re.MULTILINE)
SAID = ("yes", "partly", "no")


def text_of(page: str) -> str:
    return (DOCS / "papers" / f"{page}.md").read_text(encoding="utf-8")


def rows(page: str) -> list[list[str]]:
    """Number, result, what it says, the sections that show it, what mbsym gives, whether the print holds."""
    return [[match[1], *(cell.strip() for cell in match[2].split("|"))] for match in ROW.finditer(text_of(page))]


@pytest.mark.parametrize("page", PAGES)
def test_what_is_said_of_each_print_is_so(page: str) -> None:
    wanted = {number: word for word, numbers in TRUTH["print"][page].items() for number in numbers}
    found = {int(row[0]): row[-1] for row in rows(page)}
    assert list(found) == sorted(wanted) == list(range(1, len(wanted) + 1))
    assert [number for number, cell in found.items() if not cell.startswith(wanted[number])] == []


@pytest.mark.parametrize("page", PAGES)
def test_every_result_names_the_section_that_shows_it(page: str) -> None:
    sections = set(re.findall(r"^## ([A-Z])\. ", text_of(page), re.MULTILINE))
    for number, *_, shown, said, _ in rows(page):
        letters = set(filter(None, shown.split(", ")))
        assert letters <= sections, number
        assert said.split(":")[0].split(",")[0] in SAID, number
        assert letters or said.startswith("no"), f"{number}: shown by nothing"


@pytest.mark.parametrize("page", PAGES)
def test_claims_end_as_derivations_without_mbsym_say(page: str) -> None:
    """Of every place that a table of claims on the page names, whether it is refuted."""
    outcomes = {}
    for block in blocks(text_of(page)):
        told = re.sub(r"\n {6,}", " ", block.text)
        for line in told.splitlines():
            cells = line.strip().split(" | ")
            if len(cells) == 3 and cells[0] != "place" and not cells[2].startswith(("second route", "exact:")):
                outcomes.setdefault(cells[0], set()).add(cells[2].startswith(("differs", "does not hold")))
    outcomes = {place: found for place, found in outcomes.items() if place != "result"}
    assert {place for place, found in outcomes.items() if True in found} == set(TRUTH["refuted"][page])
    assert all(len(found) == 1 for found in outcomes.values())


def test_the_first_page_counts_them() -> None:
    lines = (DOCS / "papers" / "index.md").read_text(encoding="utf-8")
    for page in PAGES:
        said = Counter(row[-2].split(":")[0].split(",")[0] for row in rows(page))
        wrong = sum(row[-1].startswith("wrong") for row in rows(page))
        (line,) = re.findall(rf"^\| \[.*\]\({page}\.md\) \|(.*)\|$", lines, re.MULTILINE)
        counts = [sum(said.values()), *(said[word] for word in SAID), wrong]
        assert [int(cell) for cell in line.split("|")] == counts, page


def test_the_tether_moves_as_a_certified_trajectory_says() -> None:
    """Seven decimals of the six coordinates every 10 s; references/tethered-satellites.json has 28 digits."""
    (block,) = [one for one in blocks(text_of("tether")) if re.search(r"^60 ", one.text, re.MULTILINE)]
    found = {
        int(line.split()[0]): line.split()[1:] for line in block.text.splitlines() if re.match(r" ?\d+ +[0-9.]", line)
    }
    truth = reference("tethered-satellites")["trajectories"]["table1"]["states"]
    assert list(found) == list(range(0, 61, 10))
    for state in truth:
        order = ("x_A", "y_A", "theta1", "alpha1", "theta2", "alpha2")
        wanted = [state["q"][name] for name in order]
        assert found[int(state["t"])] == [f"{float(x):.7f}" for x in wanted]
