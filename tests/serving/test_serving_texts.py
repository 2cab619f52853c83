"""What a text means, told to a page: places in UTF-16, complaints, completion, formulas, both spellings."""

from __future__ import annotations

import pytest
from serving_editor import PENDULUM

from mbsym.expressions.place import Span
from mbsym.serving import looking
from mbsym.serving.looking import Offsets
from mbsym.source import read


@pytest.mark.parametrize("text", ["", "abc", "é\n\U0001d714b\r\nc", "\U0001d714\U0001d714\n\U0001d714"])
def test_places_are_counted_as_javascript_does(text: str) -> None:
    places = Offsets(text)
    for k in range(len(text) + 1):
        units = len(text[:k].encode("utf-16-le")) // 2
        assert places.units(k) == units
        assert places.characters(units) == k


def test_amid_a_pair_is_before_it() -> None:
    assert Offsets("a\U0001d714b").characters(2) == 1
    assert Offsets("a\U0001d714b").in_units([{"from": 2, "to": 3, "line": 2}]) == [{"from": 3, "to": 4, "line": 2}]
    assert Offsets("\U0001d714\r\nabc").of_span(Span(2, 2, 1)) == (5, 6)


def test_a_complaint_stands_under_the_wrong_word() -> None:
    text = PENDULUM.replace("name: pendulum", 'name: "\U0001d714"').replace("mass: m", "mass: mm")
    view = looking.view(text, "pendulum.yaml", None)
    (complaint,) = [x for x in view["complaints"] if x["severity"] == "error"]
    units = text.encode("utf-16-le")
    assert units[2 * complaint["from"] : 2 * complaint["to"]].decode("utf-16-le") == "mm"
    assert complaint["hint"] or complaint["message"]


def test_a_text_without_mistakes_has_its_bodies() -> None:
    view = looking.view(PENDULUM, "pendulum.yaml", None)
    assert [(body["name"], body["parent"]) for body in view["bodies"]] == [("bob", None)]
    assert not view["complaints"]


def test_completion_replaces_the_word_that_is_typed() -> None:
    text = PENDULUM.replace("mass: m,", "mass: m")
    system = read(PENDULUM)[0]
    offset = text.index("mass: m") + len("mass: m")
    found = looking.completed(text, offset, system)
    assert text[found["from"] : offset] == "m"
    assert {"m", "l", "g", "sin"} <= {x["label"] for x in found["items"]}


@pytest.mark.parametrize("to", ["text", "yaml"])
def test_converted_it_is_the_same_system(to: str) -> None:
    other = looking.converted(PENDULUM, "pendulum.yaml", to, None)["text"]
    assert looking.spelling(other, "a") == to
    assert read(other)[0] == read(PENDULUM)[0]
    assert looking.converted(PENDULUM + "motion: 1\n", "pendulum.yaml", to, None)["complaints"]


@pytest.mark.parametrize("source", ["", "m*", "__import__('os')", "(" * 10_000, "9**9**9**9", "<b>"])
def test_what_is_no_formula_is_complained_about(source: str) -> None:
    assert "mathml" not in looking.typed_formula(source)


def test_a_formula_as_it_is_typed() -> None:
    assert looking.typed_formula("l/2")["mathml"].startswith("<math><mfrac>")
    complaint = looking.typed_formula("m*(")["complaint"]
    assert complaint["severity"] == "error"
    assert 0 <= complaint["from"] <= complaint["to"]
    assert "<script" not in str(looking.typed_formula("<script>"))
