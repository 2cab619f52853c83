"""What tests of the server share: an editor behind a client without a network."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

TOKEN = "Token_of-these_tests"
HOST = "127.0.0.1:8000"

PENDULUM = """\
mbsym: 1
name: pendulum
parameters: {m: positive, l: positive, g: positive}
bodies:
  - {name: bob, attached to: 0, rotation: {axes: [3], angles: [x]}, mass centre: [0, -l, 0], mass: m,
     inertia about: mass centre, inertia: [0, 0, 0]}
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
motion: {x: 0}
values: {m: 1, l: 1, g: 10}
initial: {x: 1/2}
"""


class Client:
    """``editor``, and the page's way to speak to it."""

    def __init__(self, editor: Any, http: Any, path: Path) -> None:
        self.editor, self.http, self.path = editor, http, path

    def post(self, name: str, headers: Mapping[str, str] | None = None, /, **body: Any) -> Any:
        return self.http.post(
            f"/{TOKEN}/api/{name}", json=body, headers={"Origin": f"http://{HOST}", **(headers or {})}
        )

    def file(self) -> dict[str, Any]:
        found: dict[str, Any] = self.http.get(f"/{TOKEN}/api/file").json()
        return found


@contextmanager
def edited(path: Path, deliver: Any = None) -> Iterator[Client]:
    """The editor of a file; no process is started before a job is begun."""
    from starlette.testclient import TestClient

    from mbsym.serving.application import Editor, Services

    editor = Editor(path, Services(path.parent / "reports" / path.stem, deliver), TOKEN, 8000)
    editor.jobs.warm = lambda: None  # type: ignore[method-assign]
    editor.jobs.ahead = lambda task: None  # type: ignore[method-assign]
    with TestClient(editor.guard, base_url=f"http://{HOST}", raise_server_exceptions=False) as http:
        yield Client(editor, http, path)
