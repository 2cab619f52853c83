"""Folders as arguments: descriptions are taken, the other files of a project are not."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest
from conftest import invoked

DESCRIPTION = """
mbsym: 1
name: Oscillator
bodies:
  - {name: cart, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - spring: {coordinate: x, stiffness: 1}
"""

#: What stands beside descriptions in a repository.
OTHERS = {
    "docker-compose.yaml": 'version: "3"\nservices:\n  web: {image: python}\n',
    ".pre-commit-config.yaml": "repos:\n  - repo: https://example.org/mbsym\n    hooks: [{id: mbsym}]\n",
    "mkdocs.yml": "site_name: mbsym\nnav:\n  - mbsym: index.md\n",
    "notes.txt": "mbsym is run every night.\n",
    "empty.yaml": "",
    "broken.yaml": "\tservices: [",
}


def filled(folder: Path) -> Path:
    for name, text in OTHERS.items():
        (folder / name).write_text(text, encoding="utf-8")
    return folder


@pytest.mark.parametrize("command", ["check", "run"])
def test_other_files_of_a_project_are_passed_over(command: str, tmp_path: Path) -> None:
    folder = filled(tmp_path)
    (folder / "oscillator.yaml").write_text(DESCRIPTION, encoding="utf-8")
    os.mkfifo(folder / "pipe.yaml")
    (folder / "loop.yaml").symlink_to("loop.yaml")
    out = ("--brief", "--out", tmp_path / "out") if command == "run" else ()
    done = invoked(command, folder, *out, code=0)
    assert "oscillator.yaml" in done.stdout
    assert not [name for name in [*OTHERS, "pipe.yaml", "loop.yaml"] if name in done.output]


@pytest.mark.parametrize("command", ["check", "run"])
def test_a_folder_of_other_files_alone_is_complained_about(command: str, tmp_path: Path) -> None:
    done = invoked(command, filled(tmp_path), code=2)
    assert f"there are no descriptions here ({len(OTHERS)} other files were passed over)" in done.stderr


@pytest.mark.parametrize(
    ("name", "complaint"),
    [
        ("docker-compose.yaml", "error[unknown-key]: a description has none of the keys 'version', 'services'"),
        (".pre-commit-config.yaml", "error[missing-key]: a description has no 'mbsym'"),
    ],
)
def test_another_file_that_is_named_is_read_as_a_description(name: str, complaint: str, tmp_path: Path) -> None:
    done = invoked("check", filled(tmp_path) / name, code=2)
    assert complaint in done.stderr


def test_a_broken_description_in_a_folder_is_not_passed_over(tmp_path: Path) -> None:
    (tmp_path / "good.yaml").write_text(DESCRIPTION, encoding="utf-8")
    (tmp_path / "bad.yaml").write_text(DESCRIPTION.replace("coordinates: [x]}", "coordinates: [x]"), encoding="utf-8")
    done = invoked("check", tmp_path, code=2)
    assert "bad.yaml" in done.stderr
    assert "good.yaml: ok" in done.stdout
    assert " ".join(done.stdout.split()).endswith(f"2 descriptions: 1 ok, not ok: {tmp_path / 'bad.yaml'}")
    assert "descriptions" not in invoked("check", tmp_path / "good.yaml", code=0).stdout
    # What never writes does not say that it has not; of many that are wrong some are named.
    assert "nothing was written" not in done.stderr
    for k in range(8):
        (tmp_path / f"worse{k}.yaml").write_text("mbsym: 1\n", encoding="utf-8")
    last = " ".join(invoked("check", tmp_path, code=2).stdout.split()).rpartition("not ok: ")[2]
    assert last.count(".yaml") == 5
    assert last.endswith("worse3.yaml and 4 more")


@pytest.mark.parametrize(
    ("first", "hint"),
    [
        ("", "begin the file with 'mbsym: 1'"),
        ("mbsm: 1", "did you mean 'mbsym'?"),
        ("version: 1", "begin the file with 'mbsym: 1'"),
    ],
)
def test_a_description_without_its_first_line_is_not_passed_over(first: str, hint: str, tmp_path: Path) -> None:
    """In a folder of descriptions a misspelt key must not end as a check that found nothing."""
    (tmp_path / "good.yaml").write_text(DESCRIPTION, encoding="utf-8")
    (tmp_path / "lost.yaml").write_text(DESCRIPTION.replace("mbsym: 1", first), encoding="utf-8")
    done = invoked("check", tmp_path, code=2)
    assert hint in done.stderr
    assert "good.yaml: ok" in done.stdout


def test_skip_others_passes_over_no_file_that_cannot_be_read(tmp_path: Path) -> None:
    others = filled(tmp_path)
    assert invoked("check", "--skip-others", others / "docker-compose.yaml").exit_code == 0
    done = invoked("check", "--skip-others", tmp_path / "misspelled.yaml", code=2)
    assert "misspelled.yaml: error[unreadable]" in done.stderr
    log = invoked("check", "--skip-others", "--output-format", "sarif", others / "docker-compose.yaml")
    assert json.loads(log.stdout)["runs"][0]["results"] == []
