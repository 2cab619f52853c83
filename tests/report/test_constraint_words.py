"""What is said of constraints is said in Russian and Spanish, too; an undecided matter is never called decided."""

from __future__ import annotations

import ast
from dataclasses import replace
from pathlib import Path

import pytest

import mbsym
from mbsym.algebra.certainty import Certainty
from mbsym.problems.constraints.result import Integrability
from mbsym.report.language import Language
from mbsym.report.plain_writer import Writer
from mbsym.report.words import constraint_words, description
from mbsym.report.words.constraint_words import sentences

DISC = Path(__file__).parents[2] / "systems" / "rolling-disc.yaml"


def said() -> set[str]:
    """Every sentence in the sources of the two modules."""
    found = set()
    for module in (constraint_words, description):
        tree = ast.parse(Path(str(module.__file__)).read_text(encoding="utf-8"))
        inner = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}  # docstrings
        for node in ast.walk(tree):
            if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in inner:
                found |= {node.value} if node.value.endswith(".") and " " in node.value else set()
    return found


@pytest.mark.parametrize("name", ["ru", "es"])
def test_every_sentence_has_another(name: str) -> None:
    language = Language(name)
    assert len(said()) > 14
    for english in said():
        assert language.sentence(english) != english, english
    for word in ("coincide", "parallel", "distance", "relation", "rolling", "velocity", "component"):
        assert language.say(word) != word, word


def test_the_word_for_integrability_falls_with_what_is_known() -> None:
    found, say = mbsym.load(DISC, (1, 2, 3)).constraints, Writer().said
    told = " ".join(map(say, sentences(found)))
    assert "The system is nonholonomic (proved)" in told
    open_ = replace(found, integrability=Integrability((), None, 2, Certainty.UNDECIDED, rheonomic=False))
    told = " ".join(map(say, sentences(open_)))
    assert "undecided" in told
    assert "nonholonomic" not in told
    assert "proved" not in told.replace("by itself (proved)", "")
    seen = replace(found, integrability=Integrability((3, 3), 2, 2, Certainty.VERIFIED, rheonomic=False))
    told = " ".join(map(say, sentences(seen)))
    assert "holonomic" in told
    assert "verified numerically" in told
