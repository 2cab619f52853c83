"""What a batch says to CI systems and to people: every outcome, hostile texts, and the formats' own rules."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

from conftest import invoked

from mbsym.batch.index_page import index_page
from mbsym.batch.junit import junit
from mbsym.batch.outcome import CheckRow, ClaimRow, ComplaintRow, FileRow, Outcome, ProblemRow, Row, Summary, findings
from mbsym.report.language import Language

HOSTILE = "</script><script>alert(1)</script> ]]> \x1b[2J \x00 & \" '\n::error::x"

#: JUnit as Jenkins reads it: element -> attributes (with ! where required), and what may stand inside.
JUNIT = {
    "testsuites": ("name time tests failures errors disabled", "testsuite"),
    "testsuite": (
        "name! tests! failures errors time disabled skipped timestamp hostname id package",
        "properties testcase system-out system-err",
    ),
    "properties": ("", "property"),
    "property": ("name! value!", ""),
    "testcase": ("name! classname time status assertions", "skipped error failure system-out system-err"),
    "skipped": ("type message", ""),
    "error": ("type message", ""),
    "failure": ("type message", ""),
}


def row(outcome: Outcome, **more: object) -> Row:
    return Row(f"systems/{outcome.value}.yaml", outcome.value, outcome, **more)  # type: ignore[arg-type]


FULL = row(
    Outcome.SELF_CHECK,
    name=HOSTILE,
    problems=(
        ProblemRow(1, "kinematics", "kinematics", "derived"),
        ProblemRow(3, "equations", "equations", "none", "too-large", HOSTILE, "raise --terms"),
        ProblemRow(5, "linearisation", "linearisation", "none", "internal-error", "a defect", defect=True),
        ProblemRow(6, "stability", "stability", "derived", verdict="stable", verdict_at_values="unstable"),
    ),
    claims=(
        ClaimRow("eq. (1)", "kinetic energy", "held", "holds exactly"),
        ClaimRow("eq. (2)", HOSTILE, "refuted", "differs by x**2", ("x**2",)),
        ClaimRow("eq. (3)", "condition", "undecided", "neither proved nor refuted"),
    ),
    checks=(CheckRow("energy", "T", "U", "exact"), CheckRow("linearisation", "a", "b", "FAILED", "entry 1,2")),
    complaints=(ComplaintRow("warning", "unused-name", HOSTILE, 3, 4, 2, "leave it out"),),
    files=(FileRow("report.html", "0" * 64), FileRow("results.json", "1" * 64)),
    seconds=1.5,
)
ERRORS = row(Outcome.ERRORS, complaints=(ComplaintRow("error", "unknown-name", "unknown name 'x'", 7, 2, 1, "y?"),))


def summary(*rows: Row) -> Summary:
    return Summary(rows, "1.0", "abc", None, ("json",), 60000, seconds=2.0)


EVERY = summary(
    FULL,
    ERRORS,
    *(row(one, message=f"what {one} says") for one in Outcome if one not in (FULL.outcome, ERRORS.outcome)),
)


def kinds(text: str, file: str) -> dict[str, str]:
    """Case -> what stands in it ("" where it holds), of one suite."""
    root = ElementTree.fromstring(text)
    (suite,) = [suite for suite in root if suite.get("name") == file]
    return {case.get("name", ""): next((inner.tag for inner in case), "") for case in suite if case.tag == "testcase"}


def keeps_to_junit(element: ElementTree.Element) -> None:
    attributes, inside = JUNIT[element.tag]
    known = {name.rstrip("!") for name in attributes.split()}
    required = {name.rstrip("!") for name in attributes.split() if name.endswith("!")}
    assert required <= set(element.attrib) <= known
    for child in element:
        assert child.tag in inside.split()
        keeps_to_junit(child)


def test_junit_keeps_to_its_schema_and_counts_right() -> None:
    root = ElementTree.fromstring(junit(EVERY))
    keeps_to_junit(root)
    for tag, attribute in (("failure", "failures"), ("error", "errors"), ("skipped", "skipped")):
        for suite in root:
            assert int(suite.get(attribute, "0")) == len(suite.findall(f"testcase/{tag}"))
        if attribute != "skipped":
            assert int(root.get(attribute, "0")) == len(root.findall(f".//{tag}"))
    assert int(root.get("tests", "0")) == len(root.findall(".//testcase"))


def test_what_failed_is_told_from_what_has_no_answer() -> None:
    found = kinds(junit(EVERY), FULL.file)
    assert found["problem 1: kinematics"] == ""
    assert found["problem 3: equations"] == "skipped"
    assert found["problem 5: linearisation"] == "error"
    assert found["self-check: energy"] == ""
    assert found["self-check: linearisation"] == "failure"
    assert found["claim 1: eq. (1): kinetic energy"] == ""
    assert [kind for name, kind in found.items() if name.startswith("claim 2")] == ["skipped"]
    assert kinds(junit(EVERY), ERRORS.file) == {"description": "failure"}
    for outcome in (Outcome.CRASHED, Outcome.TIMEOUT, Outcome.MEMORY, Outcome.NOT_WRITTEN, Outcome.INCOMPLETE):
        assert kinds(junit(EVERY), f"systems/{outcome.value}.yaml")["derivation"] == "error"
    assert kinds(junit(EVERY), "systems/skipped.yaml")["derivation"] == "skipped"


def test_claims_fail_only_where_they_have_to_hold() -> None:
    strict = replace(FULL, outcome=Outcome.CLAIMS, checks=())
    found = kinds(junit(summary(strict)), strict.file)
    assert [found[name] for name in sorted(found) if name.startswith("claim")] == ["", "failure", "failure"]
    levels = {finding.code: finding.severity for finding in findings(summary(strict))}
    assert levels["claim-refuted"] == "error"
    levels = {finding.code: finding.severity for finding in findings(summary(replace(FULL, checks=())))}
    assert levels["claim-refuted"] == "warning"


def test_an_outcome_that_is_the_word_itself_is_said_once() -> None:
    claims = (ClaimRow("", "a", "undecided", "undecided: no motion"), ClaimRow("", "b", "refuted", "does not hold"))
    text = junit(summary(row(Outcome.DERIVED, claims=claims)))
    assert re.findall(r'<skipped message="([^"]*)"', text) == ["undecided: no motion", "refuted: does not hold"]


def test_findings_have_the_places_of_the_complaints() -> None:
    found = findings(EVERY)
    (unknown,) = [finding for finding in found if finding.code == "unknown-name"]
    assert (unknown.path, unknown.line, unknown.column, unknown.severity) == (ERRORS.file, 7, 2, "error")
    codes = {finding.code for finding in found}
    assert {"self-check-failed", "crashed", "timeout", "out-of-memory", "not-written"} <= codes
    undecided = [finding for finding in found if "neither proved nor refuted" in finding.message]
    assert not undecided


class _Page(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.links: list[str] = []
        self.words: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.links += [value or "" for name, value in attrs if name == "href"]

    def handle_data(self, data: str) -> None:
        self.words.append(data)


def test_the_page_shows_everything_and_runs_nothing() -> None:
    text = index_page(EVERY, "summary.json", Language())
    page = _Page()
    page.feed(text)
    assert "script" not in page.tags
    assert "\x1b" not in text
    assert page.links == ["summary.json", "self-check%20failed/report.html", "self-check%20failed/results.json"]
    shown = " ".join(page.words)
    for word in ("SELF-CHECK FAILED: linearisation", "at the values: unstable", "unknown name 'x' (y?)", "alert(1)"):
        assert word in shown
    assert all(f"what {one} says" in shown for one in Outcome if one not in (FULL.outcome, ERRORS.outcome))


def test_the_command_writes_them(tmp_path: Path) -> None:
    systems, out = tmp_path / "systems", tmp_path / "build"
    systems.mkdir()
    invoked("examples", "simple-pendulum", "--out", systems)
    (systems / "wrong.yaml").write_text("mbsym: 1\nname: x\nbodies: []\n", encoding="utf-8")
    words = [
        "batch",
        str(systems),
        "--out",
        str(out),
        "--format",
        "json",
        "--problems",
        "1,6",
        "--output-format",
        "github",
    ]
    done = invoked(*words, code=2)
    assert all(re.match("::(error|warning) file=", line) for line in done.stdout.splitlines())
    assert "there are no bodies" in done.stdout
    suites = ElementTree.parse(out / "junit.xml").getroot()
    keeps_to_junit(suites)
    assert {suite.get("name", "").rpartition("/")[2] for suite in suites} == {"simple-pendulum.yaml", "wrong.yaml"}
    (run,) = json.loads((out / "mbsym.sarif").read_text(encoding="utf-8"))["runs"]
    assert {result["ruleId"] for result in run["results"]} == {"no-bodies"}
    page = _Page()
    page.feed((out / "index.html").read_text(encoding="utf-8"))
    assert all((out / link).exists() for link in page.links)
    again = invoked(*words[:-1], "junit")
    keeps_to_junit(ElementTree.fromstring(again.stdout))
