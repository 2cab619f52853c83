"""Runs the server: on the loopback address only, until somebody stops it."""

from __future__ import annotations

import asyncio
import os
import secrets
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic, sleep

import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol

from mbsym.serving.application import Editor, Services

#: What the address holds besides: nobody guesses so many bytes.
TOKEN_BYTES = 32

LOOPBACK = "127.0.0.1"


#: So many connections at once; where half as many are there, those that ask nothing make room.
MOST_CONNECTIONS = 64


class Connection(H11Protocol):
    """Whoever connects and says nothing keeps nobody out."""

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        super().connection_made(transport)
        if len(self.connections) > MOST_CONNECTIONS // 2:
            silent = [other for other in self.connections if isinstance(other, Connection) and other.cycle is None]
            for other in silent:
                if other is not self and other.transport is not None:
                    other.transport.close()


class Server(uvicorn.Server):
    """Streams of events end when the server is asked to."""

    def __init__(self, config: uvicorn.Config, editor: Editor) -> None:
        super().__init__(config)
        self.editor = editor

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        self.editor.told.end()
        await asyncio.sleep(0)
        await super().shutdown(sockets)


def bound(port: int) -> socket.socket:
    """A socket that listens at the loopback address; a free port for 0.  Raises OSError where the port is taken."""
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    try:
        # Else a port is "in use" for a minute after its server ended; on Windows the option would let two in.
        if os.name == "posix":
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind((LOOPBACK, port))
        listener.listen(128)  # only this takes the port from others that ask for the same option
    except BaseException:
        listener.close()
        raise
    listener.set_inheritable(False)
    return listener


def _server(path: Path, services: Services, line: socket.socket) -> tuple[Server, str]:
    port = line.getsockname()[1]
    editor = Editor(path, services, secrets.token_urlsafe(TOKEN_BYTES), port)
    config = uvicorn.Config(
        editor.guard,
        lifespan="on",
        http=Connection,
        ws="none",
        access_log=False,
        log_level="error",
        proxy_headers=False,
        server_header=False,
        date_header=False,
        h11_max_incomplete_event_size=65_536,
        limit_concurrency=MOST_CONNECTIONS,
        timeout_keep_alive=60,
        timeout_graceful_shutdown=5,
    )
    return Server(config, editor), f"http://{LOOPBACK}:{port}/{editor.token}/"


def serve(path: Path, services: Services, port: int, ready: Callable[[str], None]) -> None:
    """Serves a file until Ctrl-C; ``ready`` gets the address.  Raises OSError where the port is taken."""
    with bound(port) as line:
        server, address = _server(path, services, line)
        ready(address)
        server.run(sockets=[line])


@contextmanager
def serving(path: Path, services: Services, port: int = 0) -> Iterator[str]:
    """The address of a server in a thread, which ends with the context."""
    with bound(port) as line:
        server, address = _server(path, services, line)
        server.install_signal_handlers = lambda: None  # type: ignore[attr-defined]
        thread = threading.Thread(target=server.run, kwargs={"sockets": [line]}, daemon=True)
        thread.start()
        end = monotonic() + 30
        while not server.started and thread.is_alive() and monotonic() < end:
            sleep(0.01)
        try:
            yield address
        finally:
            server.should_exit = True
            thread.join(15)
