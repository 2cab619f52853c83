"""A small parameter with powers of its own name says of what: nothing is no answer, in either spelling."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import system_of

from mbsym.source import read

ROOT = Path(__file__).parents[2]
EVERYTHING = (ROOT / "tests" / "everything.yaml").read_text(encoding="utf-8")


@pytest.mark.parametrize("said", ["{delta: {powers: {}}}", "{delta: {powers: []}}", "{delta: {powers: 3}}"])
def test_powers_of_nothing_are_complained_of(said: str) -> None:
    lines = [f"small parameter: {said}" if x.startswith("small parameter") else x for x in EVERYTHING.splitlines()]
    system, complaints = read("\n".join(lines) + "\n", "x.yaml")
    assert system is None
    assert all("powers" in one.message for one in complaints)


def test_editor_text_that_loses_its_powers_is_complained_of() -> None:
    from mbsym.source.text_writer import to_text

    whole = system_of(EVERYTHING, "x.yaml")
    text = to_text(whole)
    assert "powers =" in text
    broken = "\n".join(
        "Small parameter: delta; powers =[ (k, 1)" if x.startswith("Small parameter") else x for x in text.splitlines()
    )
    system, complaints = read(broken, "x.txt")
    assert system is None
    assert list(complaints)
