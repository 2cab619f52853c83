"""Processes that begin with everything loaded: each is forked from one that has imported mbsym and done nothing else.

A call is a process of its own, with streams, folder, limits and exit code as ``python -c`` has them; only what every
interpreter would import again, for most of a second, is there already.  Shells start them by the name ``mbsym`` where
``script`` has put it.  Tests whose subject is how a process begins or ends start an interpreter instead.
"""

from __future__ import annotations

import atexit
import gc
import importlib
import json
import os
import pkgutil
import resource
import select
import signal
import socket
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from conftest import filed

#: What the script ``mbsym`` does.
COMMAND = "import sys; from mbsym_cli.process import command; sys.argv[0] = 'mbsym'; command()"

#: Imported beside mbsym's own modules: what those import when they are first used.
USED = ("jinja2", "matplotlib.figure", "matplotlib.backends.backend_agg", "matplotlib.backends.backend_svg", "llvmlite")

#: They are processes of other kinds, or need what may not be installed.
NOT_LOADED = ("mbsym.serving", "mbsym_cli.__main__")

#: What a shell starts: it hands its streams, words, folder and environment on, and ends as the process ends.
SCRIPT = """#!{python} -SE
import json, os, socket, sys
server = socket.socket(socket.AF_UNIX)
server.connect({address!r})
socket.send_fds(server, [b"s"], [0, 1, 2])
asked = {{"arguments": ["mbsym", *sys.argv[1:]], "cwd": os.getcwd(), "environment": dict(os.environ)}}
server.sendall(json.dumps(asked).encode())
server.shutdown(socket.SHUT_WR)
ended = int(server.recv(8) or b"1")
os.kill(os.getpid(), -ended) if ended < 0 else sys.exit(ended)
"""

_SERVERS: list[subprocess.Popen[str]] = []


def run(
    words: Sequence[object] = (),
    *,
    code: str = COMMAND,
    cwd: Path | None = None,
    given: str = "",
    timeout: float = 300,
    memory: int | None = None,
    processor: int | None = None,
) -> subprocess.CompletedProcess[str]:
    """What ``code`` does in such a process with these words after its name, ``given`` on its standard input, at most
    bytes of ``memory`` and seconds of ``processor``; raises subprocess.TimeoutExpired as ``subprocess.run`` does."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "in").write_text(given, encoding="utf-8")
        arguments = ["-c", *map(str, words)]
        asked = {
            "code": code, "arguments": arguments, "cwd": str(cwd or Path.cwd()), "folder": folder,
            "seconds": timeout, "limits": [[resource.RLIMIT_AS, memory], [resource.RLIMIT_CPU, processor]],
            "environment": dict(os.environ),
        }  # fmt: skip
        server = _server()
        assert server.stdin is not None
        assert server.stdout is not None
        server.stdin.write(json.dumps(asked) + "\n")
        server.stdin.flush()
        ended = json.loads(server.stdout.readline())
        out, err = ((Path(folder) / name).read_text(encoding="utf-8") for name in ("out", "err"))
    if ended is None:
        raise subprocess.TimeoutExpired(arguments, timeout, out, err)
    return subprocess.CompletedProcess(arguments, ended, out, err)


def script(folder: Path) -> None:
    """Puts ``mbsym`` into a folder for programs."""
    address = _address(_server().pid)
    while not address.exists():  # it is loading
        time.sleep(0.01)
    file = filed(folder / "mbsym", SCRIPT.format(python=sys.executable, address=str(address)))
    file.chmod(0o755)


def _address(server: int) -> Path:
    """Where a server listens; short, as a socket's name has to be."""
    return Path(tempfile.gettempdir()) / f"mbsym-warm-{server}"


def _server() -> subprocess.Popen[str]:
    """One for all tests of this process, which ends with it."""
    if not _SERVERS:
        command = [sys.executable, __file__]
        _SERVERS.append(subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True))
        atexit.register(_SERVERS[0].communicate)  # the end of its input ends it
    return _SERVERS[0]


# --- in the process that others are forked from -----------------------------------------------------------------------


def _load() -> None:
    for name in ("mbsym", "mbsym_cli"):
        package = importlib.import_module(name)
        for found in pkgutil.walk_packages(package.__path__, f"{name}.", onerror=lambda _: None):
            if not found.name.startswith(NOT_LOADED):
                importlib.import_module(found.name)
    for name in USED:
        importlib.import_module(name)


def _serve() -> None:
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    _load()
    gc.collect()
    gc.freeze()
    address, listener = _address(os.getpid()), socket.socket(socket.AF_UNIX)
    listener.bind(str(address))
    listener.listen()
    running: list[int] = []
    try:
        while True:
            if listener in select.select([sys.stdin, listener], [], [])[0]:
                running = [process for process in running if os.waitpid(process, os.WNOHANG) == (0, 0)]
                running.append(_begin_script(listener.accept()[0]))
            elif line := sys.stdin.readline():
                asked = json.loads(line)
                child = os.fork()
                if not child:
                    _become(asked, _streams(asked["folder"]))
                print(json.dumps(_awaited(child, asked["seconds"])), file=answers, flush=True)
            else:
                break
    finally:
        address.unlink()


def _begin_script(client: socket.socket) -> int:
    """A process that starts what a shell has asked for and says how it ended; others can begin meanwhile."""
    if waiting := os.fork():
        client.close()
        return waiting
    _, streams, _, _ = socket.recv_fds(client, 1, 3)
    with client.makefile("r", encoding="utf-8") as told:
        asked = {"code": COMMAND, "limits": [], **json.loads(told.read())}
    child = os.fork()
    if not child:
        client.close()
        _become(asked, streams)
    client.sendall(str(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])).encode())
    os._exit(0)


def _awaited(child: int, seconds: float) -> int | None:
    """Its exit code, that of a signal below zero; None where it had to be ended."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        found, status = os.waitpid(child, os.WNOHANG)
        if found:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.005)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return None


def _streams(folder: str) -> list[int]:
    ways = {"in": os.O_RDONLY, "out": os.O_WRONLY, "err": os.O_WRONLY}
    return [os.open(os.path.join(folder, name), way | os.O_CREAT) for name, way in ways.items()]


def _become(asked: dict[str, Any], streams: list[int]) -> None:
    """The process that was asked for; never returns."""
    code = 1
    try:
        for number, stream in enumerate(streams):
            os.dup2(stream, number)
            os.close(stream)
        sys.stdin = os.fdopen(0, encoding="utf-8")
        os.environ.clear()
        os.environ.update(asked["environment"])
        os.chdir(asked["cwd"])
        sys.path[0] = ""
        sys.argv = asked["arguments"]
        for limit, most in asked["limits"]:
            if most:
                resource.setrlimit(limit, (most, most))
        exec(compile(asked["code"], "<string>", "exec"), {"__name__": "__main__"})
        code = 0
    except SystemExit as ended:
        code = ended.code if isinstance(ended.code, int) else int(ended.code is not None)
        if isinstance(ended.code, str):
            print(ended.code, file=sys.stderr)
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code & 0xFF)


if __name__ == "__main__":
    _serve()
