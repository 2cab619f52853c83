"""One verdict, one word, in every output; "energy" is T - U everywhere, and T2 - T0 - U the generalised energy."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from conftest import OWN, SHIPPED, derived, invoked
from terminal import told

import mbsym
from mbsym.analysis import Analysis
from mbsym.problems.stability.words import Word
from mbsym.report.targets import TARGETS

SYSTEMS = sorted([*SHIPPED.glob("*.yaml"), *OWN.glob("*.yaml")])

#: Words that would say something of stability without being a verdict's own.
FOREIGN = re.compile(
    r"cyclic drift\)|up to rotation|critical \(first|with respect to the other variables|marginally|neutrally|instable"
)


def verdict_words(found: Any) -> Iterator[str]:
    """Every verdict in a JSON document."""
    if isinstance(found, dict):
        for key, value in found.items():
            if key == "verdict" and isinstance(value, str):
                yield value
            yield from verdict_words(value)
    elif isinstance(found, list):
        for item in found:
            yield from verdict_words(item)


def said(analysis: Analysis) -> dict[str, str]:
    """What each output says of stability, as plain text in one line."""
    texts = {name: TARGETS[name].render(analysis, (6,)) for name in ("latex", "html", "wolfram", "json")}
    texts["terminal"] = " ".join(told(analysis, 6))
    return {name: re.sub(r"\s+", " ", text) for name, text in texts.items()}


def words_of(analysis: Analysis) -> tuple[Word, ...]:
    """The whole system's verdict, and that at the values."""
    found = analysis.stability
    return (found.verdict.word, *(() if found.numerical is None else (found.numerical.word,)))


def faults(analysis: Analysis) -> list[str]:
    """Outputs that do not say a verdict in its own word, or say one in another."""
    texts = said(analysis)
    wrong = [f"{name}: {match[0]}" for name, text in texts.items() if (match := FOREIGN.search(text))]
    whole, *numerical = words_of(analysis)
    for name, text in texts.items():
        expected = [whole, *numerical] if name != "wolfram" else [whole]
        wrong += [
            f"{name} lacks {word}" for word in expected if not re.search(rf"(?<!\w){re.escape(word)}(?!\w)", text)
        ]
    in_json = set(verdict_words(json.loads(texts["json"])))
    return wrong + [f"json: {word}" for word in in_json - set(Word)]


@pytest.mark.parametrize("path", SYSTEMS, ids=lambda path: path.stem)
def test_every_output_says_a_verdict_in_one_word(path: Path) -> None:
    analysis = derived(path)
    if analysis.stage(6).failure is None:
        assert faults(analysis) == []


@pytest.mark.parametrize("place", ["terminal", "json", "latex", "html", "wolfram"])
def test_another_word_in_one_output_is_caught(place: str, monkeypatch: pytest.MonkeyPatch) -> None:
    analysis = derived(SHIPPED / "heavy-top.yaml")
    right = said(analysis)
    word = words_of(analysis)[-1 if place != "wolfram" else 0]
    assert word in right[place]
    monkeypatch.setattr(
        f"{__name__}.said", lambda _: right | {place: right[place].replace(word, "stable (cyclic drift)")}
    )
    assert faults(analysis)


def test_tables_and_files_have_the_same_words(tmp_path: Path) -> None:
    file = SHIPPED / "cart-pendulum.yaml"
    table = invoked("equilibria", file).output
    listed = json.loads(invoked("equilibria", file, "--json").output)
    words = {one["stability"]["verdict"] for one in listed["equilibria"]}
    assert words <= set(Word)
    assert len(words) > 1
    for word in words:
        assert word in re.sub(r"\s+", " ", table)
    assert words == set(mbsym.equilibria(file).table["verdict"])


def test_a_word_fits_into_a_line_and_is_no_other_one() -> None:
    assert all(len(word) <= 66 for word in Word)
    assert len({word.casefold() for word in Word}) == len(Word)


def test_energy_is_one_thing_in_every_output(tmp_path: Path) -> None:
    """The satellite's orbit is prescribed: T - U changes, T2 - T0 - U does not, and no output mixes them up."""
    file = SHIPPED / "satellite.yaml"
    done = invoked("simulate", file, "--time", "1", "--out", tmp_path, "--invariants", code=0)
    text = re.sub(r"\s+", " ", done.output)
    assert " T2 - T0 - U: conserved (proved)" in text
    assert " T - U: not conserved" in text
    content = json.loads((tmp_path / "simulation.json").read_text(encoding="utf-8"))
    assert (content["energy"]["is"], content["energy"]["conserved"]) == ("T - U", False)
    assert (content["generalized_energy"]["is"], content["generalized_energy"]["conserved"]) == ("T2 - T0 - U", True)
    header = (tmp_path / "trajectory.csv").read_text(encoding="utf-8").splitlines()[0].split(",")
    assert {"energy", "generalized_energy"} <= set(header)
    (integral,) = derived(file).integrals
    assert (integral.kind, integral.name) == ("generalised energy", "generalised energy")
