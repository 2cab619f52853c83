"""Which files a batch takes, where their results go, and what it says of the others."""

from __future__ import annotations

import errno
import json
import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import jsonschema
import pytest
from batches import QUICK, START, batch, cached, files_of, folder_of, needs_posix, outcomes, pendulum, summary
from click.testing import CliRunner

from mbsym.batch.coordinator import Place
from mbsym.batch.summary_json import schema
from mbsym_cli.batch.command import command
from mbsym_cli.batch.folders import chosen, found_in, share
from mbsym_cli.files import Content, deliver


def places(*paths: Path, out: Path = Path("nowhere")) -> dict[str, str]:
    """File -> folder, by the ends of the names."""
    return {place.file: place.folder for place in found_in(paths, out).places}


def test_what_is_taken(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    folder_of(Path("in"), a=pendulum(), deep__er__b=pendulum(), _hidden__c=pendulum())
    Path("in/_hidden").rename("in/.hidden")
    Path("in/.pre-commit-config.yaml").write_text("repos:\n  - repo: local\n")
    Path("in/compose.yml").write_text("services: {}\n")
    Path("in/notes.txt").write_text("mbsym is used here.\n")
    Path("in/readme.md").write_text("mbsym: 1\n")
    Path("in/binary.yaml").write_bytes(b"mbsym: \0")
    Path("in/empty.yaml").write_text("")
    Path("in/folder.yaml").mkdir()
    from mbsym.source import load, to_text

    system = load(Path("in/a.yaml"))[0]
    assert system is not None
    Path("in/a.txt").write_text(to_text(system))
    assert places(Path("in")) == {"in/a.yaml": "a", "in/a.txt": "a.txt", "in/deep/er/b.yaml": "deep/er/b"}
    assert found_in([Path("in")], Path("nowhere")).others == 5


def test_links(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A link round in a circle is not followed; a file is taken once, under its first name."""
    monkeypatch.chdir(tmp_path)
    folder_of(Path("in"), a=pendulum())
    try:
        Path("in/circle").symlink_to(Path("."), target_is_directory=True)
        Path("in/b.yaml").symlink_to("a.yaml")
        Path("in/broken.yaml").symlink_to("nothing")
        Path("in/itself.yaml").symlink_to("itself.yaml")
    except OSError:
        pytest.skip("no links here")
    assert places(Path("in")) == {"in/a.yaml": "a"}
    Path("linked").symlink_to("in", target_is_directory=True)
    assert places(Path("linked")) == {"linked/a.yaml": "a"}
    assert len(places(Path("linked"), Path("in"))) == 1


def test_the_folder_of_results_is_not_looked_into(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    folder_of(Path("in"), a=pendulum(), build__old=pendulum())
    assert places(Path("in"), out=Path("in/build")) == {"in/a.yaml": "a"}
    assert places(Path(), out=Path()) == {"in/a.yaml": "in/a", "in/build/old.yaml": "in/build/old"}


def test_no_two_share_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("one/a.yaml", "one/a.yml", "one/A.yaml", "one/con.yaml", "one/a.yaml.yaml", "two/a.yaml"):
        file = Path(name)
        file.parent.mkdir(exist_ok=True)
        file.write_text(pendulum(), encoding="utf-8")
    found = places(Path("one"), Path("two"), Path("one/a.yaml"))
    assert len(found) == 6
    assert len({folder.casefold() for folder in found.values()}) == 6
    assert found["two/a.yaml"] == "two/a"
    assert found["one/con.yaml"] == "one/_con"
    assert all(not folder.startswith(("/", "..")) for folder in found.values())


def test_a_file_keeps_its_folder_when_others_are_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Else parts of a batch would write over each other's results."""
    monkeypatch.chdir(tmp_path)
    folder_of(Path("in"), a=pendulum(), b=pendulum(), c=pendulum(), d__a=pendulum(), e=pendulum())
    Path("in/a.yml").write_text(pendulum(), encoding="utf-8")
    every = found_in([Path("in")], Path("out")).places
    parts = [share(every, part, 3) for part in (1, 2, 3)]
    assert sorted(place.file for part in parts for place in part) == sorted(place.file for place in every)
    assert [len(part) for part in parts] == [2, 2, 2]
    assert share(every, 7, 9) == []
    assert chosen(every, ["*.yml"]) == [Place("in/a.yml", "a.yml")]
    assert chosen(every, ["d/*"]) == [Place("in/d/a.yaml", "d/a")]
    assert chosen(every, ["b.yaml", "[ce].yaml"]) == [Place(f"in/{name}.yaml", name) for name in "bce"]
    assert chosen(every, ["nothing"]) == []
    assert chosen(every, []) == list(every)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["empty"], "there are no descriptions here (1 other file was passed over)"),
        (["nothing"], "no such file or folder"),
        (["in", "--filter", "x*"], "no description fits --filter x* (descriptions there: 1)"),
        (["in", "--shard", "4/3"], "--shard: error[bad-shard]"),
        (["in", "--jobs", "0"], "--jobs: error[bad-number]"),
        (["in", "--timeout", "soon"], "--timeout: error[bad-number]"),
        (["in", "--timeout", "nan"], "--timeout: error[bad-number]"),
        (["in", "--memory", "-1"], "--memory: error[bad-number]"),
        (["in", "--format", "jsn"], "did you mean 'json'?"),
        (["in", "--problems", "99"], "there is no problem 99"),
        (["in", "--out", "in/a.yaml"], "is no folder"),
    ],
)
def test_what_cannot_be_done_is_said(
    arguments: list[str], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    folder_of(Path("in"), a=pendulum())
    folder_of(Path("empty"), compose="services: {}\n")
    done = CliRunner().invoke(command, arguments)
    assert done.exit_code == 2
    assert said in done.stderr
    assert not Path("build").exists()


def test_parts_of_a_batch_together_give_the_whole(tmp_path: Path) -> None:
    folder_of(tmp_path / "in", a=pendulum(), b=pendulum("B"), sub__c=pendulum("C"))
    for part in ("1/2", "2/2"):
        batch("in", "-o", "parts", *QUICK, "--shard", part, cwd=tmp_path)
    batch("in", "-o", "whole", *QUICK, cwd=tmp_path)
    parts = [summary(tmp_path / "parts", f"summary-{part}-of-2.json") for part in (1, 2)]
    whole = summary(tmp_path / "whole")
    assert [one["shard"] for one in (*parts, whole)] == ["1/2", "2/2", None]
    systems = sorted((row for one in parts for row in one["systems"]), key=lambda row: row["file"])
    assert systems == whole["systems"]
    ours, theirs = (files_of(tmp_path / name) for name in ("parts", "whole"))
    assert ours == theirs
    assert set(theirs) >= {"a/results.json", "sub/c/results.json"}


@needs_posix
@pytest.mark.skipif(hasattr(os, "geteuid") and os.geteuid() == 0, reason="root may read everything")
def test_what_may_not_be_read(tmp_path: Path) -> None:
    folder_of(tmp_path / "in", a=pendulum(), b=pendulum("B"), closed__c=pendulum("C"))
    (tmp_path / "in" / "b.yaml").chmod(0)
    (tmp_path / "in" / "closed").chmod(0)
    try:
        done = batch("in", "-o", "out", *QUICK, cwd=tmp_path, code=2)
    finally:
        (tmp_path / "in" / "closed").chmod(0o755)
    assert outcomes(tmp_path / "out") == {"a": "derived", "b": "description errors", "closed": "description errors"}
    assert "in/closed: error[unreadable]" in done.stderr


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
def test_results_that_cannot_be_written_cost_a_row(tmp_path: Path) -> None:
    """A file lies where a folder should be; a link leads out of the folder of results."""
    folder_of(tmp_path / "in", a=pendulum(), b=pendulum("B"), c=pendulum("C"))
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "a").write_text("a file")
    (tmp_path / "out" / "b").symlink_to(tmp_path)
    done = batch("in", "-o", "out", *QUICK, cwd=tmp_path, code=1)
    assert outcomes(tmp_path / "out") == {"a": "not written", "b": "not written", "c": "derived"}
    assert "leads out of" in done.stdout
    with open("/dev/full", "w") as full:
        ended = subprocess.run([*START, "batch", "in", "-o", "out", *QUICK], cwd=tmp_path, stdout=full, check=False)
    assert ended.returncode == 1
    assert cached(tmp_path / "out")["c"]


@pytest.mark.skipif(sys.platform != "linux", reason="names of any bytes")
@pytest.mark.parametrize("form", ["text", "github", "sarif", "junit", "json"])
def test_a_name_that_is_no_utf8_costs_no_summary(tmp_path: Path, form: str) -> None:
    """Its file is found again by the name in the summary; SARIF has its bytes in the address."""
    (tmp_path / "in").mkdir()
    file = Path(os.fsdecode(bytes(tmp_path / "in") + b"/odd\xff.yaml"))
    file.write_text(pendulum().replace("mass: m", "mass: mm"), encoding="utf-8")
    folder_of(tmp_path / "in", a=pendulum())
    batch("in", "-o", "out", "--output-format", form, *QUICK, cwd=tmp_path, code=2)
    listed = [Path(tmp_path, one["file"]) for one in summary(tmp_path / "out")["systems"]]
    assert listed == [tmp_path / "in" / "a.yaml", file]
    assert file.exists()
    log = json.loads((tmp_path / "out" / "mbsym.sarif").read_bytes())
    place = log["runs"][0]["results"][0]["locations"][0]["physicalLocation"]["artifactLocation"]
    assert place["uri"] == "in/odd%FF.yaml"
    assert ElementTree.parse(tmp_path / "out" / "junit.xml").getroot().get("failures") == "1"


def test_what_an_earlier_batch_said_does_not_speak_for_this_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The disk is full for one file about the batch: the others are written, it is gone, and the exit code tells."""
    monkeypatch.chdir(tmp_path)
    folder_of(Path("in"), a=pendulum())
    assert CliRunner().invoke(command, ["in", "-o", "out", *QUICK]).exit_code == 0
    before = {name: Path("out", name).read_bytes() for name in ("summary.json", "junit.xml", "index.html")}

    def full(folder: Path, files: Mapping[str, Content], *more: Any) -> list[Path]:
        if "junit.xml" in files:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return deliver(folder, files, *more)

    monkeypatch.setattr("mbsym_cli.batch.run.deliver", full)
    folder_of(Path("in"), a=pendulum(), b=pendulum("B"))
    done = CliRunner().invoke(command, ["in", "-o", "out", *QUICK])
    assert done.exit_code == 1
    assert f"{Path('out/junit.xml')} cannot be written: {os.strerror(errno.ENOSPC)}" in done.stderr
    assert "2 systems" in done.stdout
    assert not Path("out/junit.xml").exists()
    assert all(Path("out", name).read_bytes() != before[name] for name in ("summary.json", "index.html"))


def test_the_summary_keeps_to_its_schema(tmp_path: Path) -> None:
    """With everything in it that can be: errors, warnings, claims, no result, a verdict, what was not begun."""
    claims = "claims:\n  - {claim: mass matrix, entry: [theta, theta], equals: 2*m*l**2, place: eq. (1)}\n"
    folder_of(
        tmp_path / "in",
        a=pendulum() + claims,
        b=pendulum().replace("g: positive}", "g: positive, unused: positive}").replace("motion: {theta: 0}\n", ""),
        c=pendulum().replace("mass: m", "mass: mm"),
        d=pendulum("D"),
    )
    checker = jsonschema.Draft202012Validator(schema())
    checker.check_schema(schema())
    arguments = ("in", "-o", "out", "--format", "json,c", "--jobs", "1", "--fail-fast")
    told = batch(*arguments, cwd=tmp_path, code=2).stdout
    assert "4 systems: 2 derived, 1 with errors, 1 skipped, claims refuted: 1; " in told
    found = summary(tmp_path / "out")
    checker.validate(found)
    assert outcomes(tmp_path / "out") == {"a": "derived", "b": "derived", "c": "description errors", "d": "skipped"}
    a, b, c, d = found["systems"]
    assert found["totals"] == {"systems": 4, "outcomes": {"derived": 2, "description errors": 1, "skipped": 1}}
    assert [problem["verdict"] for problem in a["problems"] if problem["number"] == 6] == ["stable"]
    assert [(claim["place"], claim["word"]) for claim in a["claims"]] == [("eq. (1)", "refuted")]
    assert {check["outcome"] for check in a["checks"]} == {"exact"}
    assert [file["name"] for file in a["files"]] == ["model.c", "model.h", "results.json"]
    assert [problem["number"] for problem in b["problems"] if problem["status"] == "none"] == [4, 5, 6]
    assert [(one["severity"], one["code"], one["line"]) for one in b["complaints"]] == [("warning", "unused-name", 3)]
    assert [(one["code"], one["line"], one["column"]) for one in c["complaints"]] == [("unknown-name", 9, 11)]
    assert d["problems"] == []
    broken = [
        {**found, "format": 2},
        {**found, "extra": 1},
        {**found, "systems": [{**a, "outcome": "fine"}]},
        {**found, "systems": [{**a, "files": [{"name": "x", "sha256": "0"}]}]},
        {**found, "systems": [{key: value for key, value in a.items() if key != "checks"}]},
        {**found, "run": {**found["run"], "seconds": "long"}},
    ]
    assert not any(checker.is_valid(one) for one in broken)


def test_files_are_those_of_run(tmp_path: Path) -> None:
    """Byte for byte: a process of its own, or none, makes no difference."""
    folder_of(tmp_path / "in", a=pendulum())
    batch("in", "-o", "out", cwd=tmp_path)
    subprocess.run([*START, "run", "in/a.yaml", "--out", "run", "--quiet"], cwd=tmp_path, check=True)
    ours, theirs = files_of(tmp_path / "out" / "a"), files_of(tmp_path / "run")
    for files in (ours, theirs):
        del files[".mbsym.json"]
    kept = json.loads(ours.pop("outcome.json"))
    assert ours == theirs
    assert {file["name"] for file in kept["row"]["files"]} == set(theirs)


def test_what_a_folder_holds_does_not_become_part_of_the_program(tmp_path: Path) -> None:
    """A module of the name of one of ours lies in the current folder."""
    folder_of(tmp_path / "in", a=pendulum())
    for name in ("json", "flint", "mbsym"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('a stranger')\n")
    start = Path(sys.executable).parent / "mbsym"
    if not start.exists():
        pytest.skip("mbsym is not installed")
    done = subprocess.run([start, "batch", "in", *QUICK], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
