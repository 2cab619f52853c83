"""The server as it runs, over a socket of this machine; and the command that starts it."""

from __future__ import annotations

import json
import socket
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
from conftest import filed, invoked

pytest.importorskip("starlette")
pytest.importorskip("uvicorn")
pytest.importorskip("httpx")

import httpx
from serving_editor import PENDULUM

from mbsym.serving.application import Services
from mbsym.serving.jobs import Jobs
from mbsym.serving.server import serving
from mbsym_cli.files import deliver


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    path = filed(tmp_path_factory.mktemp("network") / "pendulum.yaml", PENDULUM)
    with serving(path, Services(path.parent / "reports" / "pendulum", deliver)) as found:
        yield found


def posted(address: str, name: str, patience: float = 60, **body: Any) -> Any:
    origin = address[: address.index("/", 8)]
    return httpx.post(f"{address}api/{name}", json=body, headers={"Origin": origin}, timeout=patience)


def test_the_body_of_a_large_request_is_not_waited_for(address: str) -> None:
    """100 MB are announced and none of them sent: the answer is there all the same, and the connection is closed."""
    place = urlsplit(address)
    head = (
        f"POST {place.path}api/look HTTP/1.1\r\nHost: {place.netloc}\r\nOrigin: http://{place.netloc}\r\n"
        "Content-Type: application/json\r\nContent-Length: 100000000\r\n\r\n"
    )
    with socket.create_connection((place.hostname, place.port), timeout=10) as line:
        line.sendall(head.encode())
        answer = b"".join(iter(lambda: line.recv(65536), b""))
    assert answer.startswith(b"HTTP/1.1 413")


def test_results_come_as_events(address: str) -> None:
    found: list[dict[str, Any]] = []
    with httpx.stream("GET", f"{address}api/events", timeout=60) as stream:
        assert stream.headers["content-type"].startswith("text/event-stream")
        job = None
        for line in stream.iter_lines():
            if job is None:
                job = posted(address, "derive", text=PENDULUM, format="yaml", problems=[1]).json()["job"]
            if line.startswith("data: "):
                found.append(json.loads(line[6:]))
                if found[-1]["kind"] in ("done", "failed", "cancelled"):
                    break
    assert {x["job"] for x in found} == {job}
    assert [x["problem"] for x in found if x["kind"] == "section"] == ["system", "1", "checks", "summary"]
    assert found[-1]["kind"] == "done"


def test_the_file_is_derived_before_the_page_asks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The first derivation of the text as it stands in the file is the one that was begun with the server."""
    asked: list[str] = []
    own = Jobs._attended
    monkeypatch.setattr(
        Jobs, "_attended", lambda self, job, task: (asked.append(task["kind"]), own(self, job, task))[1]
    )
    path = filed(tmp_path / "pendulum.yaml", PENDULUM)
    with serving(path, Services(tmp_path / "reports", deliver)) as address:
        while asked != ["derive"]:
            time.sleep(0.01)
        with httpx.stream("GET", f"{address}api/events", timeout=60) as stream:
            lines = stream.iter_lines()
            next(lines)
            job = posted(address, "derive", text=PENDULUM, format="yaml", page="a tab").json()["job"]
            for line in lines:
                if line.startswith("data: "):
                    event = json.loads(line[6:])
                    assert event["job"] == job
                    if event["kind"] in ("done", "failed", "cancelled"):
                        break
    assert event["kind"] == "done"
    assert asked == ["derive"]


def test_reports_are_written_beside_the_file(address: str) -> None:
    answer = posted(address, "export", text=PENDULUM, format="yaml", to="json", problems=[1]).json()
    (file,) = map(Path, answer["files"])
    assert file.parent.parts[-2:] == ("reports", "pendulum")
    assert json.loads(file.read_text())
    assert posted(address, "export", text=PENDULUM, format="yaml", to="../../x").status_code == 400
    assert posted(address, "export", text="mbsym: 1\n", format="yaml", to="json").status_code == 422


def test_a_picture_of_what_cannot_be_drawn_is_a_complaint(address: str) -> None:
    assert posted(address, "picture", text=PENDULUM, format="yaml").json()["bodies"][0]["name"] == "bob"
    (complaint,) = posted(address, "picture", text="mbsym: 1\nname: a\n", format="yaml").json()["complaints"]
    assert complaint["message"]


def test_a_picture_that_nobody_wants_any_more_keeps_none_waiting(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A page that asks for another picture leaves the first request: its job ends then, not when it is done."""
    told: list[str] = []
    ready = threading.Event()
    heard = Jobs._heard

    def first_never_done(self: Jobs, job: Any, process: Any, task: dict[str, Any]) -> None:
        if task["kind"] != "picture" or ready.is_set():
            heard(self, job, process, task)
            return
        tell = job.tell
        job.tell = lambda event: (told.append(event["kind"]), tell(event))
        ready.set()
        end = time.monotonic() + 60
        while not job.over and time.monotonic() < end:
            time.sleep(0.01)

    monkeypatch.setattr(Jobs, "_heard", first_never_done)
    place = urlsplit(address)
    body = json.dumps({"text": PENDULUM, "format": "yaml"})
    head = (
        f"POST {place.path}api/picture HTTP/1.1\r\nHost: {place.netloc}\r\nOrigin: http://{place.netloc}\r\n"
        f"Content-Type: application/json\r\nContent-Length: {len(body)}\r\n\r\n"
    )
    with socket.create_connection((place.hostname, place.port), timeout=10) as line:
        line.sendall((head + body).encode())
        assert ready.wait(20)
    # Whom the first job keeps waiting waits a minute.
    found = posted(address, "picture", patience=30, text=PENDULUM, format="yaml").json()
    assert found["bodies"][0]["name"] == "bob"
    assert told == ["cancelled"]


@pytest.mark.parametrize("name", ["starlette", "uvicorn"])
def test_without_the_extra_it_is_told_what_to_install(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in [x for x in sys.modules if x.partition(".")[0] == name or x.startswith("mbsym.serving")]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.setitem(sys.modules, name, None)
    done = invoked("edit", "x.yaml", code=2)
    assert "pip install 'mbsym[edit]'" in done.output


@pytest.mark.parametrize(
    ("arguments", "word"),
    [(["nowhere/x.yaml"], "no such folder"), (["."], "a folder"), (["x.yaml", "--port", "99999"], "--port")],
)
def test_what_cannot_be_edited_is_refused(arguments: list[str], word: str, monkeypatch: Any, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    done = invoked("edit", *arguments, code=2)
    assert word in done.output
    assert not list(tmp_path.iterdir())


def test_a_port_that_is_taken_is_told(address: str, monkeypatch: Any, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    done = invoked("edit", "x.yaml", "--no-browser", "--port", urlsplit(address).port, code=2)
    assert "in use" in done.output


def test_who_connects_and_says_nothing_keeps_nobody_out(address: str) -> None:
    """More connections of somebody else than there may be: the page is heard all the same."""
    place = urlsplit(address)
    silent = [socket.create_connection((place.hostname, place.port), timeout=10) for _ in range(96)]
    try:
        assert httpx.get(f"{address}api/digest", timeout=10).status_code == 200
    finally:
        for line in silent:
            line.close()
