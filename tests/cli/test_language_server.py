"""The language server as an editor meets it: a process, JSON-RPC on its standard streams."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import pytest

from mbsym.source.examples import example_text

pytest.importorskip("pygls", reason="needs the extra 'lsp'")
URI = "file:///tmp/pendulum.yaml"


@dataclass
class Editor:
    """A minimal client."""

    process: subprocess.Popen[bytes]
    number: int = 0
    notes: list[dict[str, Any]] = field(default_factory=list)

    def send(self, method: str, **parameters: Any) -> None:
        self._write({"jsonrpc": "2.0", "method": method, "params": parameters})

    def ask(self, method: str, **parameters: Any) -> Any:
        self.number += 1
        self._write({"jsonrpc": "2.0", "id": self.number, "method": method, "params": parameters})
        while True:
            message = self.read()
            if message.get("id") == self.number and "method" not in message:
                assert "error" not in message, message
                return message["result"]
            self.notes.append(message)

    def complaints(self) -> list[dict[str, Any]]:
        """The next published ones."""
        while True:
            message = self.notes.pop(0) if self.notes else self.read()
            if message.get("method") == "textDocument/publishDiagnostics":
                found: list[dict[str, Any]] = message["params"]["diagnostics"]
                return found

    def _write(self, message: dict[str, Any]) -> None:
        assert self.process.stdin is not None
        body = json.dumps(message).encode()
        self.process.stdin.write(f"Content-Length: {len(body)}\r\n\r\n".encode() + body)
        self.process.stdin.flush()

    def read(self) -> dict[str, Any]:
        assert self.process.stdout is not None
        length = 0
        while line := self.process.stdout.readline().strip():
            name, _, value = line.decode().partition(":")
            length = int(value) if name.lower() == "content-length" else length
        message: dict[str, Any] = json.loads(self.process.stdout.read(length))
        return message


@pytest.fixture
def editor() -> Iterator[Editor]:
    command = [sys.executable, "-m", "mbsym_cli", "lsp"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as process:
        try:
            made = Editor(process)
            made.ask("initialize", processId=None, rootUri=None, capabilities={})
            made.send("initialized")
            yield made
            made.ask("shutdown")
            made.send("exit")
            assert process.wait(20) == 0
        finally:
            process.kill()


def test_an_editor_is_served(editor: Editor) -> None:
    text = example_text("simple-pendulum")
    document = {"uri": URI, "languageId": "yaml", "version": 1, "text": text}
    editor.send("textDocument/didOpen", textDocument=document)
    assert editor.complaints() == []

    line = next(k for k, one in enumerate(text.split("\n")) if "angles: [theta]" in one)
    column = text.split("\n")[line].index("theta")
    there = {"textDocument": {"uri": URI}, "position": {"line": line, "character": column + 1}}
    assert "a coordinate of pendulum" in editor.ask("textDocument/hover", **there)["contents"]["value"]

    wrong = text.replace("name: Simple pendulum", "name: 𝒮imple 𝒫endulum # 𝒳").replace("[theta]", "[thetta]")
    change = [{"text": wrong}]
    editor.send("textDocument/didChange", textDocument={"uri": URI, "version": 2}, contentChanges=change)
    found = editor.complaints()
    assert {one["code"] for one in found} >= {"unknown-name"}
    place = wrong.split("\n")
    for one in found:
        start, end = one["range"]["start"], one["range"]["end"]
        piece = (
            place[start["line"]].encode("utf-16-le")[2 * start["character"] : 2 * end["character"]].decode("utf-16-le")
        )
        assert piece in one["message"] or one["severity"] == 2, one

    end = {"line": len(place) - 1, "character": 0}
    listed = editor.ask("textDocument/completion", textDocument={"uri": URI}, position=end)
    labels = {one["label"] for one in listed}
    assert "claims" in labels
    assert "bodies" not in labels  # it is there already
    masses = next(k for k, one in enumerate(place) if one.strip().startswith("mass: "))
    position = {"line": masses, "character": len(place[masses])}
    listed = editor.ask("textDocument/completion", textDocument={"uri": URI}, position=position)
    assert {"m", "l", "sin"} <= {one["label"] for one in listed}


def test_other_yaml_is_left_alone(editor: Editor) -> None:
    document = {"uri": URI, "languageId": "yaml", "version": 1, "text": "services:\n  web: {image: x}\n"}
    editor.send("textDocument/didOpen", textDocument=document)
    assert editor.complaints() == []


@pytest.mark.parametrize(("line", "character"), [(10**6, 0), (0, 10**6), (10**6, 10**6), (2**31 - 1, 2**31 - 1)])
def test_a_position_out_of_range_is_the_nearest_one(editor: Editor, line: int, character: int) -> None:
    """Protocol 3.17, Position: "if the character value is greater than the line length it defaults back to the line
    length"; of lines it says nothing, and the end of the text is nearest.  A change out of range is taken, too."""
    text = example_text("simple-pendulum")
    document = {"uri": URI, "languageId": "yaml", "version": 1, "text": text}
    editor.send("textDocument/didOpen", textDocument=document)
    there = {"textDocument": {"uri": URI}, "position": {"line": line, "character": character}}
    editor.ask("textDocument/hover", **there)
    assert isinstance(editor.ask("textDocument/completion", **there), list)
    place = {"line": max(line, 0), "character": max(character, 0)}
    change = [{"range": {"start": place, "end": place}, "text": "\n# more"}]
    editor.send("textDocument/didChange", textDocument={"uri": URI, "version": 2}, contentChanges=change)
    assert isinstance(editor.ask("textDocument/completion", **there), list)
