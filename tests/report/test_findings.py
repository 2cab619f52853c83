"""Complaints for programs: what a workflow, a code scanner or a script reads is what was complained of."""

from __future__ import annotations

import json
import re
from pathlib import Path
from urllib.parse import unquote

import pytest
from conftest import invoked

from mbsym.report.words.findings import Finding, findings_of, github_annotations, json_lines, sarif
from mbsym.source import read

HOSTILE = Finding("a b/%,:é.yaml", "bad-name", "100 %\r\n::error::not mine", "warning", 3, 5, 4, "write , or : \x1b[2J")
WHOLE = Finding("none.yaml", "unreadable", "the file cannot be read")

UNDECLARED = "mbsym: 1\nname: P\nbodies:\n  - {name: b, rotation: {axes: [3], angles: [phi]}, mass: M}\n"


def unescaped(text: str) -> str:
    return text.replace("%0D", "\r").replace("%0A", "\n").replace("%3A", ":").replace("%2C", ",").replace("%25", "%")


def test_an_annotation_is_one_line_whatever_it_tells() -> None:
    lines = github_annotations([HOSTILE, WHOLE]).splitlines()
    assert len(lines) == 2
    match = re.fullmatch(r"::(error|warning) ([^:]*)::(.*)", lines[0])
    assert match is not None
    assert match[1] == "warning"
    told = {key: unescaped(value) for key, value in (part.split("=") for part in match[2].split(","))}
    assert told == {"file": HOSTILE.path, "line": "3", "col": "5", "endColumn": "8", "title": "bad-name"}
    assert unescaped(match[3]) == HOSTILE.text
    assert lines[1] == "::error file=none.yaml,title=unreadable::the file cannot be read"


def test_a_sarif_log_points_at_the_same_characters() -> None:
    log = json.loads(sarif([HOSTILE, WHOLE], "1.0"))
    assert log["version"] == "2.1.0"
    (run,) = log["runs"]
    rules = [rule["id"] for rule in run["tool"]["driver"]["rules"]]
    for result, finding in zip(run["results"], (HOSTILE, WHOLE), strict=True):
        assert rules[result["ruleIndex"]] == result["ruleId"] == finding.code
        assert result["level"] == finding.severity
        assert result["message"]["text"] == finding.text
        (location,) = result["locations"]
        assert unquote(location["physicalLocation"]["artifactLocation"]["uri"]) == finding.path
    region = run["results"][0]["locations"][0]["physicalLocation"]["region"]
    assert region == {"startLine": 3, "startColumn": 5, "endColumn": 9}  # the end is not included
    assert "region" not in run["results"][1]["locations"][0]["physicalLocation"]


def test_json_lines_hold_every_field() -> None:
    (line,) = json_lines([HOSTILE]).splitlines()
    assert Finding(**json.loads(line)) == HOSTILE


def test_the_place_is_that_of_the_complaint() -> None:
    _, complaints = read(UNDECLARED, "p.yaml")
    (finding,) = findings_of("p.yaml", complaints.sorted())
    line = UNDECLARED.splitlines()[(finding.line or 0) - 1]
    start = (finding.column or 0) - 1
    assert line[start : start + finding.length] == "M"


@pytest.mark.parametrize("output_format", ["github", "sarif", "json"])
def test_check_writes_it_and_nothing_else(tmp_path: Path, output_format: str) -> None:
    good, bad = tmp_path / "good.yaml", tmp_path / "bad.yaml"
    bad.write_text(UNDECLARED, encoding="utf-8")
    good.write_text(UNDECLARED.replace("mass: M", "mass: 1"), encoding="utf-8")
    result = invoked("check", tmp_path, "--output-format", output_format, code=2)
    assert "unknown name 'M'" in result.stdout
    assert "good.yaml" not in result.stdout
    assert result.stderr == ""
    assert invoked("check", good, "--output-format", output_format).exit_code == 0
