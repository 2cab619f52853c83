"""The other languages: each message has its translation with the same gaps, and is one that is said."""

from __future__ import annotations

import ast
import re
from itertools import pairwise
from pathlib import Path

import mbsym_templates
import polib
import pytest

import mbsym
import mbsym_cli
from mbsym.problems.stability.requirements import Place
from mbsym.report.language import LANGUAGES
from mbsym.report.messages import messages

OTHERS = [name for name in LANGUAGES if name != "en"]
FOLDER = Path(mbsym.__file__).parent


@pytest.mark.parametrize("name", OTHERS)
def test_a_catalogue_is_whole(name: str) -> None:
    """What msgfmt --check looks at, and the gaps: [[name]] of templates, {} of what results say, by numbers."""
    entries = polib.pofile(str(FOLDER / "report" / "messages" / f"{name}.po"))
    assert len({(x.msgctxt, x.msgid) for x in entries}) == len(entries), "each message once"
    for entry in entries:
        assert entry.msgstr, f"not translated: {entry.msgid}"
        assert not entry.fuzzy, entry.msgid
        assert not entry.obsolete, entry.msgid
        gaps = [set(re.findall(r"\[\[\w+\]\]", text)) for text in (entry.msgid, entry.msgstr)]
        assert gaps[0] == gaps[1], entry.msgid
        assert entry.msgstr.count("$") % 2 == 0, entry.msgid
        if "[[" not in entry.msgid:
            used = {int(x) for x in re.findall(r"\{(\d+)(?::\w+)?\}", entry.msgstr)}
            assert used <= set(range(entry.msgid.count("{}"))), entry.msgid


def test_all_languages_have_the_same_messages() -> None:
    known = {name: set(messages(name)) for name in OTHERS}
    for name in OTHERS:
        assert known[name] == known[OTHERS[0]], known[name] ^ known[OTHERS[0]]


class _Texts(ast.NodeVisitor):
    """All strings of a module; those with values have {} for each."""

    def __init__(self) -> None:
        self.found: set[str] = set()

    def visit_Constant(self, node: ast.Constant) -> None:
        if isinstance(node.value, str):
            self.found.add(node.value)

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        parts = [x.value if isinstance(x, ast.Constant) else "{}" for x in node.values]
        self.found.add("".join(map(str, parts)))
        for part in node.values:
            self.visit(part)


def said() -> str:
    """Whatever stands in a string of the package, of a command or in a template."""
    texts = _Texts()
    for path in (*FOLDER.rglob("*.py"), *Path(next(iter(mbsym_cli.__path__))).rglob("*.py")):
        texts.visit(ast.parse(path.read_text(encoding="utf-8")))
    templates = Path(next(iter(mbsym_templates.__path__)))
    for path in templates.rglob("*.j2"):
        for match in re.finditer(r'"(?:[^"\\\n]|\\.)*"', path.read_text(encoding="utf-8")):
            texts.found.add(ast.literal_eval(match[0]))
    return "\n".join(texts.found)


def fragments(english: str) -> set[str]:
    """Neighbouring words, of a short phrase each word: sentences that are put together are found by these."""
    parts = [re.findall(r"[\w'-]+", part) for part in re.split(r"\{\}|\[\[\w+\]\]|[,:;().]", english.lower())]
    if sum(map(len, parts)) < 6:
        return {word for part in parts for word in part}
    return {f"{a} {b}" for part in parts for a, b in pairwise(part)}


def test_no_message_is_left_of_what_is_said_no_longer() -> None:
    source = said().lower()
    assert "this sentence stands nowhere" not in source
    known = [english for _, english in messages(OTHERS[0]) if english.lower() not in source]
    stale = {english: lost for english in known if (lost := {x for x in fragments(english) if x not in source})}
    assert not stale


@pytest.mark.parametrize("name", OTHERS)
def test_every_place_of_a_condition_is_said(name: str) -> None:
    """Problem 12 says it beside each condition of an averaged motion: two of them stood in English there."""
    known = messages(name)
    assert not [place for place in Place if place is not Place.SUFFICIENT and ("", place.value) not in known]
