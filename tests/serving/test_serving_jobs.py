"""Jobs: results section by section from a process of its own, cancelled, begun again, bounded, and mortal."""

from __future__ import annotations

import os
import queue
import signal
import sys
import time
from collections.abc import Iterator
from typing import Any

import pytest
from serving_editor import PENDULUM
from test_self_check import plant
from test_withdrawn import ACCELERATION, LIFT

from mbsym.report.targets import FORMATS
from mbsym.serving import worker
from mbsym.serving.jobs import Jobs
from mbsym.serving.worker import perform

ENDS = ("done", "failed", "cancelled")


class Told:
    """The events of one set of jobs, by job."""

    def __init__(self) -> None:
        self.queue: queue.Queue[dict[str, Any]] = queue.Queue()
        self.jobs = Jobs(self.queue.put)

    def until_over(self, *names: str) -> dict[str, list[dict[str, Any]]]:
        found: dict[str, list[dict[str, Any]]] = {name: [] for name in names}
        while not all(events and events[-1]["kind"] in ENDS for events in found.values()):
            event = self.queue.get(timeout=60)
            if event["job"] in found:
                found[event["job"]].append(event)
        return found


@pytest.fixture(scope="module")
def told() -> Iterator[Told]:
    found = Told()
    found.jobs.warm()
    yield found
    found.jobs.close()


def task(kind: str, text: str = PENDULUM, **more: Any) -> dict[str, Any]:
    return {"kind": kind, "text": text, "name": "pendulum.yaml", **more}


def of(kind: str, **more: Any) -> list[dict[str, Any]]:
    return list(perform(task(kind, **more)))


def test_sections_come_one_by_one_in_their_order(told: Told) -> None:
    name = told.jobs.begin(task("derive"))
    events = told.until_over(name)[name]
    assert events[0]["kind"] == "plan"
    sections = [x for x in events if x["kind"] == "section"]
    assert [x["problem"] for x in sections] == ["system", "1", "2", "3", "4", "5", "6", "7", "checks", "summary"]
    assert all(x["state"] == "derived" for x in sections)
    (stability,) = [x for x in sections if x["problem"] == "6"]
    assert "stable" in stability["html"]
    assert events[-1]["kind"] == "done"


def test_what_was_begun_ahead_is_told_whole_to_who_asks_for_the_same() -> None:
    found = Told()
    try:
        found.jobs.ahead(task("derive"))
        while not (found.jobs._ahead and found.jobs._ahead[1].over):
            time.sleep(0.01)
        assert found.queue.empty()  # nobody has asked
        name = found.jobs.begin(task("derive"), "a tab")
        events = found.until_over(name)[name]
        again = found.jobs.begin(task("derive"), "a tab")
        later = found.until_over(again)[again]
    finally:
        found.jobs.close()
    told = [[(x["kind"], x.get("problem")) for x in these if x["kind"] != "progress"] for these in (events, later)]
    assert again != name
    assert told[0] == told[1]
    assert [x["html"] for x in events if x.get("problem") == "6"] == [
        x["html"] for x in later if x.get("problem") == "6"
    ]


@pytest.mark.parametrize("ended", [False, True])
def test_what_was_begun_ahead_of_another_text_or_has_ended_early_is_nobodys(ended: bool) -> None:
    found = Told()
    try:
        found.jobs.ahead(task("derive", PENDULUM + "\n# another\n" * (not ended)))
        assert found.jobs._ahead
        first = found.jobs._ahead[1]
        if ended:
            found.jobs.cancel_all("nobody is there")
        name = found.jobs.begin(task("derive"), "a tab")
        events = found.until_over(name)[name]
        assert name != first.name
        assert events[-1]["kind"] == "done"
        while not first.over:
            time.sleep(0.01)
        assert found.queue.empty()  # not a word of the other
    finally:
        found.jobs.close()


def test_a_job_is_cancelled_by_the_next_of_its_page_only(told: Told) -> None:
    first = told.jobs.begin(task("derive"), "one tab")
    other = told.jobs.begin(task("derive", problems=[1]), "another tab")
    again = told.jobs.begin(task("derive", problems=[1]), "one tab")
    events = told.until_over(first, other, again)
    assert [events[x][-1]["kind"] for x in (first, other, again)] == ["cancelled", "done", "done"]
    assert events[first][-1]["words"] == "begun again"


def test_a_cancelled_job_says_nothing_more(told: Told) -> None:
    name = told.jobs.begin(task("derive"))
    assert told.jobs.cancel(name)
    assert told.until_over(name)[name][-1]["kind"] == "cancelled"
    assert not told.jobs.cancel("1000")


@pytest.mark.skipif(sys.platform != "linux", reason="kills a process of the job")
def test_a_process_that_dies_costs_its_job_only(told: Told) -> None:
    name = told.jobs.begin(task("simulate", time="100000", method="rk4"))
    running = told.jobs._running[name]
    while running.process is None:
        time.sleep(0.005)
    os.kill(running.process.process.pid, signal.SIGSEGV)
    last = told.until_over(name)[name][-1]
    assert last["kind"] == "failed"
    assert "SIGSEGV" in last["words"]
    after = told.jobs.result(task("picture"))
    assert after["kind"] == "picture"


def test_time_is_bounded(told: Told) -> None:
    bounded = Jobs(told.queue.put, seconds=0.01)
    try:
        name = bounded.begin(task("derive"))
        last = told.until_over(name)[name][-1]
        assert (last["kind"], last["words"]) == ("failed", "stopped after 0.01 s")
    finally:
        bounded.close()


def test_a_description_with_mistakes_is_refused_with_words() -> None:
    (only,) = of("derive", text=PENDULUM.replace("mass: m", "mass: mm"))
    assert only["kind"] == "failed"
    assert "mm" in only["words"]


def test_what_has_no_result_is_refused_in_its_section() -> None:
    """A motion that no parameter values allow: sin(1) = 0 never holds, and nothing is said of stability."""
    sections = [x for x in of("derive", text=PENDULUM.replace("motion: {x: 0}", "motion: {x: 1}")) if "html" in x]
    (stability,) = [x for x in sections if x["problem"] == "6"]
    assert stability["state"] == "refused"
    assert "No result" in stability["html"]


def test_what_a_section_says_is_the_reports() -> None:
    (files,) = of("export", formats=["html", "json"], problems=[1, 6])
    whole = files["files"]["report.html"]
    assert set(files["files"]) == {FORMATS["html"].filename, FORMATS["json"].filename}
    sections = {x["problem"]: x["html"] for x in of("derive", problems=[1, 6]) if x["kind"] == "section"}
    assert '<strong class="good">' in sections["6"]
    assert '<strong class="good">' in whole


@pytest.mark.parametrize(
    ("given", "word"), [({"m": "-1"}, "declared positive"), ({"n": "1"}, "no parameter"), ({"m": "1/0"}, "rational")]
)
def test_values_that_a_description_does_not_allow_are_refused(given: dict[str, str], word: str) -> None:
    (only,) = of("modes", set=given)
    assert only["kind"] == "failed"
    assert word in only["words"]


def test_modes_take_the_values_that_are_set() -> None:
    """omega^2 = g/l, by hand: 2 at g = 8, l = 2."""
    (found,) = of("modes", set={"g": "8", "l": "2"})
    assert found["value"]["modes"][0]["imaginary"] == pytest.approx(2.0)


@pytest.mark.parametrize("until", ["0", "-1", "nan", "1e999", "x", "1/0"])
def test_a_time_that_is_none_is_refused(until: str) -> None:
    assert of("simulate", time=until)[-1]["kind"] == "failed"


def test_a_map_is_a_picture() -> None:
    found = of("map", x={"name": "g", "low": "1", "high": "2"}, set={"m": "1", "l": "1"})[-1]
    assert found["kind"] == "map", found
    assert found["image"].startswith("data:image/png;base64,")
    assert of("map", x={"name": "g", "low": "2", "high": "1"})[-1]["kind"] == "failed"


def test_a_verdict_is_never_shown_whose_check_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not even for the moment before the checks come: the falling lift with a mistake planted in its equations."""
    plant(monkeypatch, ACCELERATION)
    sections = [x for x in of("derive", text=LIFT.read_text(encoding="utf-8")) if x["kind"] == "section"]
    told = [x for x in sections if x["problem"] in ("6", "summary")]
    assert {x["state"] for x in told if x["problem"] == "6"} == {"refused"}
    assert all("withdrawn" in x["html"] for x in told)
    assert not any(word in x["html"] for x in told for word in ('class="good"', 'id="verdict', "Kelvin"))
    (checks,) = [x for x in sections if x["problem"] == "checks"]
    assert 'class="bad"' in checks["html"]


def test_what_fills_a_page_by_and_by_lets_the_picture_go_first(monkeypatch: pytest.MonkeyPatch) -> None:
    stepped: list[int] = []
    monkeypatch.setattr(os, "nice", stepped.append, raising=False)
    for kind in ("picture", "simulate", "hover", "derive", "export", "map"):
        worker._step_back({"kind": kind})
    assert len(stepped) == 3
    assert min(stepped) > 0


@pytest.mark.parametrize(
    ("axes", "words"),
    [
        ({"x": {"low": "1", "high": "2"}}, "no parameter called"),
        ({"x": {"name": "m", "high": "2"}}, "rational numbers"),
        ({"x": {"name": "m", "low": "2", "high": "1"}}, "is empty"),
        ({"x": {"name": "m", "low": "1", "high": "2"}, "y": {"name": "m", "low": "1", "high": "2"}}, "both axes"),
        ({}, "an axis or two"),
    ],
)
def test_a_map_with_wrong_axes_is_refused_in_words(axes: dict[str, Any], words: str) -> None:
    """What a page may send: a missing key is no defect of the server."""
    (*_, last) = of("map", **axes)
    assert last["kind"] == "failed"
    assert words in last["words"]


def test_the_environment_is_left_as_it_was(monkeypatch: pytest.MonkeyPatch) -> None:
    """Processes may be started by several threads at once; none takes the other's setting for what was there before."""
    from concurrent.futures import ThreadPoolExecutor

    from mbsym.serving.jobs import _single_threaded

    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)

    def briefly(k: int) -> None:
        with _single_threaded():
            assert os.environ["OMP_NUM_THREADS"] == "1"
            time.sleep(0.002 * (k % 3))

    with ThreadPoolExecutor(8) as pool:
        list(pool.map(briefly, range(40)))
    assert "OMP_NUM_THREADS" not in os.environ
