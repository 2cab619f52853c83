"""What shows the outputs of a change: nothing that differs is lost, what was measured is no difference."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from outputs import differences, documented, files, jobs


def test_seconds_are_masked_and_sentences_are_not(tmp_path: Path) -> None:
    for name, seconds in (("first", "0.42"), ("second", "1.7")):
        folder = tmp_path / name
        folder.mkdir()
        (folder / "terminal.txt").write_text(f"stable (Routh)\nderived in {seconds} s\n", encoding="utf-8")
        (folder / "results.json").write_text(f'{{"seconds": {seconds}}}\n', encoding="utf-8")
        (folder / "figure.png").write_bytes(b"\x89PNG\xff")
    first, second = files(tmp_path / "first"), files(tmp_path / "second")
    assert not list(differences(first, second))
    (tmp_path / "second" / "terminal.txt").write_text("unstable\nderived in 1.7 s\n", encoding="utf-8")
    (tmp_path / "second" / "figure.png").write_bytes(b"\x89PNG\xfe")
    (tmp_path / "second" / "model.py").write_text("x = 1\n", encoding="utf-8")
    lines = list(differences(first, files(tmp_path / "second")))
    assert lines[0] == "differs: figure.png"
    assert lines[1] == "new: model.py"
    assert "-stable (Routh)" in lines
    assert "+unstable" in lines


def test_every_description_and_every_documented_command_is_run() -> None:
    every = jobs("")
    words = {job.words[:2] for job in every}
    assert ("run", "systems/satellite.yaml") in words
    assert {job.place.rsplit("/", 1)[1] for job in every if "satellite.yaml" in job.place} == {"all", "ru", "es"}
    assert all(tuple(command) in {job.words for job in every} for command in documented())
