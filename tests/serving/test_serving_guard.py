"""Attacks on ``mbsym edit``: what is not the page's is not let in, and what is in is bounded."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Iterator
from typing import Any

import pytest
from conftest import filed

pytest.importorskip("starlette")
pytest.importorskip("httpx")

from serving_editor import HOST, PENDULUM, TOKEN, Client, edited

from mbsym.serving.guard import Guard


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    path = filed(tmp_path_factory.mktemp("guard") / "pendulum.yaml", PENDULUM)
    with edited(path) as found:
        yield found


def test_the_page_itself_is_let_in(client: Client) -> None:
    assert client.http.get(f"/{TOKEN}/api/digest").status_code == 200
    assert client.post("look", text=PENDULUM).status_code == 200


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:8000", "127.0.0.1", "127.0.0.1:9", "localhost.evil.example:8000", ""]
)
def test_a_name_led_here_is_refused(client: Client, host: str) -> None:
    """DNS rebinding: the browser believes that the attacker's name is this machine."""
    assert client.http.get(f"/{TOKEN}/api/file", headers={"Host": host}).status_code == 403
    assert client.http.get(f"/{TOKEN}/", headers={"Host": host}).status_code == 403


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "null", "http://127.0.0.1:9", "https://127.0.0.1:8000", "http://localhost:8000"]
)
def test_a_foreign_page_writes_nothing(client: Client, origin: str) -> None:
    answer = client.post("save", {"Origin": origin}, text="stolen", digest="", force=True)
    assert answer.status_code == 403
    assert client.path.read_text() == PENDULUM


def test_what_tells_no_origin_writes_nothing(client: Client) -> None:
    answer = client.http.post(f"/{TOKEN}/api/save", json={"text": "stolen", "digest": "", "force": True})
    assert answer.status_code == 403


def test_another_sites_page_reads_nothing(client: Client) -> None:
    """A picture or a script of another site, whose requests have no Origin."""
    answer = client.http.get(f"/{TOKEN}/page.js", headers={"Sec-Fetch-Site": "cross-site"})
    assert answer.status_code == 403


@pytest.mark.parametrize("path", ["", "x", TOKEN[:-1], TOKEN + "x", TOKEN.swapcase(), "api/file", "%00", "é"])
def test_without_the_token_there_is_nothing(client: Client, path: str) -> None:
    for rest in ("", "/", "/api/file", "/page.js"):
        assert client.http.get(f"/{path}{rest}").status_code == 404


@pytest.mark.parametrize(
    "path",
    [
        "../pendulum.yaml",
        "%2e%2e/pendulum.yaml",
        "..%2fserver.py",
        "server.py",
        "/etc/passwd",
        "page/page.js",
        "page.js/",
    ],
)
def test_no_path_leads_to_other_files(client: Client, path: str) -> None:
    answer = client.http.get(f"http://{HOST}/{TOKEN}/{path}")
    assert answer.status_code in (404, 307)
    assert b"mbsym: 1" not in answer.content


@pytest.mark.parametrize("name", ["../../etc/passwd", "/etc/passwd", "..", "", "satellite.yaml"])
def test_an_example_is_no_path(client: Client, name: str) -> None:
    assert client.post("begin", example=name).status_code == 400


def test_a_request_of_100_megabytes_is_refused_unread(client: Client) -> None:
    taken = 0

    def body() -> Iterator[bytes]:
        nonlocal taken
        for _ in range(100):
            taken += 1
            yield b"x" * 1_000_000

    headers = {"Origin": f"http://{HOST}", "Content-Type": "application/json"}
    answer = client.http.post(f"/{TOKEN}/api/look", content=b"{}", headers={**headers, "Content-Length": "100000000"})
    assert answer.status_code == 413
    answer = client.http.post(f"/{TOKEN}/api/look", content=body(), headers=headers)
    assert answer.status_code == 413, "and one that does not tell its length"


def test_other_methods_and_kinds_are_refused(client: Client) -> None:
    assert client.http.delete(f"/{TOKEN}/api/file").status_code == 405
    answer = client.http.post(
        f"/{TOKEN}/api/save", content=b"text=1", headers={"Origin": f"http://{HOST}", "Content-Type": "text/plain"}
    )
    assert answer.status_code == 415, "what a form can send"


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"{",
        b"[]",
        b"[" * 100_000,
        b'"text"',
        b'{"text": 1}',
        b'{"text": null}',
        b"\xff\xfe",
        b'{"text": "\\ud800"}',
    ],
)
def test_what_is_no_request_is_refused_with_words(client: Client, content: bytes) -> None:
    headers = {"Origin": f"http://{HOST}", "Content-Type": "application/json"}
    answer = client.http.post(f"/{TOKEN}/api/save", content=content, headers=headers)
    assert answer.status_code in (400, 422)
    assert answer.json()["message"]
    assert client.path.read_text() == PENDULUM


@pytest.mark.parametrize("path", ["", "page.js", "api/file", "nothing"])
def test_every_answer_has_the_policy(client: Client, path: str) -> None:
    headers = client.http.get(f"/{TOKEN}/{path}").headers
    policy = headers["content-security-policy"]
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    assert "frame-ancestors 'none'" in policy
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["referrer-policy"] == "no-referrer"
    assert "access-control-allow-origin" not in headers


def test_it_is_bound_to_the_loopback_address_only() -> None:
    from mbsym.serving.server import bound

    with bound(0) as line:
        assert line.getsockname()[0] == "127.0.0.1"
        with pytest.raises(OSError, match="in use"):
            bound(line.getsockname()[1])


def test_markup_in_a_description_stays_text(client: Client) -> None:
    nasty = PENDULUM.replace("name: pendulum", 'name: "<img src=x onerror=alert(1)>"  # <script>alert(2)</script>')
    answer = client.post("look", text=nasty)
    assert answer.headers["content-type"].startswith("application/json")
    found: dict[str, Any] = client.post("formula", source="<script>").json()
    assert "mathml" not in found
    found = client.post("formula", source="m*l**2*sin(x)/2").json()
    assert found["mathml"].startswith("<math>")
    assert "<script" not in found["mathml"]


def test_half_a_request_is_not_waited_for(client: Client) -> None:
    """A body that never ends: the answer says so, and other requests go on meanwhile."""
    scope = {
        "type": "http",
        "method": "POST",
        "path": f"/{TOKEN}/api/look",
        "query_string": b"",
        "headers": [
            (b"host", HOST.encode()),
            (b"origin", f"http://{HOST}".encode()),
            (b"content-type", b"application/json"),
        ],
    }
    heard: list[Any] = []
    sent = iter([{"type": "http.request", "body": b"{", "more_body": True}])

    async def receive() -> Any:
        found = next(sent, None)
        if found is None:
            await asyncio.sleep(60)
        return found

    async def send(message: Any) -> None:
        heard.append(message)

    guard = Guard(client.editor.guard.inner, TOKEN, 8000)
    guard.seconds = 0.05
    thread = threading.Thread(target=lambda: asyncio.run(guard(scope, receive, send)))
    thread.start()
    thread.join(20)
    assert [one["status"] for one in heard if one["type"] == "http.response.start"] == [408]
    assert (b"connection", b"close") in heard[0]["headers"]
