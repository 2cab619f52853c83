"""The site as a browser gets it: built strictly from the repository, whole, and without anything from elsewhere."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from html.parser import HTMLParser
from importlib.util import find_spec
from pathlib import Path

import click
import pytest
from pages import ROOT, pages

import mbsym
from mbsym.analysis import PROBLEMS
from mbsym.problems.stability.words import MEANINGS, THEOREMS, Word
from mbsym.report.schemas import names, schema
from mbsym.source import keys
from mbsym_cli.main import COMMANDS, main

pytestmark = pytest.mark.skipif(find_spec("material") is None, reason="no mkdocs-material: pip install '.[docs]'")


def build(folder: Path, site: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--config-file", str(folder / "mkdocs.yml")]
    environment = {**os.environ, "NO_MKDOCS_2_WARNING": "1", "http_proxy": "http://127.0.0.1:9"}
    environment |= {"https_proxy": environment["http_proxy"], "PYTHONPATH": str(ROOT)}
    words = [*command, "--site-dir", str(site)]
    return subprocess.run(words, env=environment, capture_output=True, text=True, timeout=120, check=False)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    done = build(ROOT, folder)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


class Page(HTMLParser):
    """The text of a page, its headings, what it loads, and its tags."""

    def __init__(self, file: Path) -> None:
        super().__init__()
        self.words: list[str] = []
        self.loaded: list[str] = []
        self.tags: list[str] = []
        self.feed(file.read_text(encoding="utf-8"))
        self.text = " ".join(" ".join(self.words).split())

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        found = dict(attrs)
        if tag in {"script", "img", "iframe"} or (tag == "link" and found.get("rel") != "canonical"):
            self.loaded += [value for value in (found.get("src"), found.get("href")) if value]

    def handle_data(self, data: str) -> None:
        self.words.append(data)


def test_every_page_is_in_the_site_and_loads_nothing_from_elsewhere(site: Path) -> None:
    for name in [*pages(), "reference/description.md", "reference/commands.md", "reference/python.md"]:
        page = Page(site / name.replace(".md", ".html"))
        assert page.loaded
        assert [address for address in page.loaded if "//" in address] == []
    assert not (site / "hooks").exists()


def test_formulas_are_mathml(site: Path) -> None:
    """As many as the page has, none left as TeX or marked as wrong."""
    source = (ROOT / "docs" / "theory.md").read_text(encoding="utf-8")
    displayed = re.findall(r"\$\$.*?\$\$", source, re.DOTALL)
    rest = re.sub(r"\$\$.*?\$\$", "", source, flags=re.DOTALL)
    page = Page(site / "theory.html")
    assert page.tags.count("math") == len(displayed) + len(re.findall(r"\$[^$]+\$", rest)) > 50
    assert "merror" not in page.tags
    assert not re.search(r"\\[a-z]{2,}|\$", page.text)


def test_every_verdict_and_theorem_is_told(site: Path) -> None:
    text = Page(site / "theory.html").text
    assert [word for word in Word if f"{word} {MEANINGS[word]}" not in text] == []
    assert [theorem.name for theorem in THEOREMS if theorem.name not in text] == []


def test_what_each_problem_does_is_told(site: Path) -> None:
    text = Page(site / "reference" / "problems.html").text
    assert [n for n, problem in PROBLEMS.items() if " ".join(problem.explanation.split()) not in text] == []


def test_every_key_of_a_description_is_on_its_page(site: Path) -> None:
    text = Page(site / "reference" / "description.html").text
    tables = [keys.SYSTEM, keys.PARAMETER, keys.BODY, keys.SHAPE, keys.CLAIM]
    tables += [kind.keys for kind in keys.LOADS.values()]
    for name, key in [pair for table in tables for pair in table.items()]:
        assert name in text
        assert key.meaning.split(",")[0].split(":")[0] in text
    assert keys.SYSTEM["latex"].meaning in text, "braces, backslashes and quotes as they are"


def test_every_command_and_option_is_on_its_page(site: Path) -> None:
    text = Page(site / "reference" / "commands.html").text
    context = click.Context(main)
    for name in COMMANDS:
        assert f"mbsym {name}" in text
        for option in main.get_command(context, name).params:
            assert not isinstance(option, click.Option) or all(spelling in text for spelling in option.opts)


def test_everything_public_is_on_the_page_on_python(site: Path) -> None:
    text = Page(site / "reference" / "python.html").text
    assert all(f"mbsym.{name}" in text for name in mbsym.__all__)
    # From the README's example: what its lines use.
    for name in ("linearisation", "subsystems", "cyclic", "mass_matrix", "to_sympy", "coordinates", "conservation"):
        assert name in text


def test_every_property_of_a_json_file_is_on_its_page(site: Path) -> None:
    text = Page(site / "reference" / "json.html").text
    for name in names():
        assert (site / "reference" / f"{name}.schema.json").exists()
        for member, found in schema(name)["properties"].items():
            assert member in text
            assert found.get("description", "") in text


def test_a_broken_link_is_found(tmp_path: Path) -> None:
    shutil.copy(ROOT / "mkdocs.yml", tmp_path)
    shutil.copytree(ROOT / "docs", tmp_path / "docs")
    page = tmp_path / "docs" / "index.md"
    page.write_text(page.read_text(encoding="utf-8") + "\n[nowhere](theory.md#no-such-place)\n", encoding="utf-8")
    done = build(tmp_path, tmp_path / "site")
    assert done.returncode != 0
    assert "no-such-place" in done.stderr
