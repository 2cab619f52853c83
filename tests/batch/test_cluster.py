"""A real scheduler and two workers on the loopback address; one of them is killed on the way."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import pytest
from conftest import invoked

pytestmark = [
    pytest.mark.skipif(find_spec("distributed") is None, reason="needs the extra 'cluster'"),
    pytest.mark.skipif(os.name != "posix", reason="signals"),
]

SYSTEMS = ("simple-pendulum", "double-pendulum", "ziegler", "dumbbell", "spring-pendulum", "cart-pendulum")
MBSYM = [sys.executable, "-m", "mbsym_cli"]


@dataclass
class Here:
    """A scheduler with its workers."""

    folder: Path
    address: str
    workers: list[subprocess.Popen[bytes]]


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Here]:
    file = tmp_path / "scheduler.json"
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "cwd": tmp_path}
    dask = [sys.executable, "-m", "dask"]
    scheduler = [
        *dask,
        "scheduler",
        "--host",
        "127.0.0.1",
        "--port",
        "0",
        "--no-dashboard",
        "--scheduler-file",
        str(file),
    ]
    running = [subprocess.Popen(scheduler, **quiet)]  # type: ignore[call-overload]
    try:
        _until(lambda: file.exists() and bool(file.read_text().strip()))
        address = json.loads(file.read_text())["address"]
        worker = [*dask, "worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard", "--host", "127.0.0.1"]
        running += [subprocess.Popen(worker, **quiet) for _ in range(2)]  # type: ignore[call-overload]
        yield Here(tmp_path, address, running[1:])
    finally:
        for process in running:
            process.kill()
            process.wait()


def _until(holds: object, seconds: float = 120.0) -> None:
    assert callable(holds)
    end = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.05)


def _files(out: Path) -> dict[str, bytes]:
    """Every report, byte for byte."""
    return {
        str(path.relative_to(out)): path.read_bytes()
        for path in out.rglob("*")
        if path.is_file() and path.parent != out and path.name != ".mbsym.json"
    }


def test_a_lost_worker_is_made_up_for_and_results_are_the_same_bytes(cluster: Here) -> None:
    systems, out = cluster.folder / "systems", cluster.folder / "build"
    assert invoked("examples", *SYSTEMS, "--out", systems).exit_code == 0
    words = ["batch", str(systems), "--format", "json,python"]
    command = [*MBSYM, *words, "--out", str(out), "--cluster", cluster.address]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as batch:
        assert batch.stdout is not None
        first = batch.stdout.readline()  # something is finished: both workers have begun
        cluster.workers[0].send_signal(signal.SIGKILL)
        rest = batch.stdout.read()
    assert batch.returncode == 0, first + rest
    here = cluster.folder / "here"
    assert subprocess.run([*MBSYM, *words, "--out", str(here), "--quiet"], check=False).returncode == 0
    assert _files(out) == _files(here)
    assert len({name.split("/")[0] for name in _files(out)}) == len(SYSTEMS)
    one, other = (json.loads((folder / "summary.json").read_text()) for folder in (out, here))
    assert {**one, "run": None} == {**other, "run": None}


def test_a_budget_is_met_at_the_worker_and_nothing_is_left_there(cluster: Here) -> None:
    systems = cluster.folder / "systems"
    invoked("examples", "satellite", "--out", systems)
    words = [
        "batch",
        str(systems),
        "--out",
        str(cluster.folder / "b"),
        "--cluster",
        cluster.address,
        "--timeout",
        "0.2",
    ]
    done = subprocess.run([*MBSYM, *words], capture_output=True, text=True, check=False)
    assert done.returncode == 4, done.stdout + done.stderr
    (system,) = json.loads((cluster.folder / "b" / "summary.json").read_text())["systems"]
    assert system["outcome"] == "timeout"


def test_no_cluster_is_a_complaint_with_what_to_do(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mbsym.batch.cluster.CONNECT", 1.0)
    invoked("examples", "ziegler", "--out", tmp_path / "s")
    words = ["batch", str(tmp_path / "s"), "--out", str(tmp_path / "b"), "--cluster"]
    done = invoked(*words, "tcp://127.0.0.1:9", code=2)
    assert "no scheduler answers at tcp://127.0.0.1:9" in done.stderr
    assert not (tmp_path / "b" / "ziegler").exists()
    sweep = [
        "sweep",
        str(tmp_path / "s" / "ziegler.yaml"),
        "--vary",
        "P=0:1:3",
        "--out",
        str(tmp_path / "w"),
        "--cluster",
    ]
    done = invoked(*sweep, "tcp://127.0.0.1:9", code=2)
    assert "no scheduler answers at tcp://127.0.0.1:9" in done.stderr
    monkeypatch.setitem(sys.modules, "distributed", None)
    done = invoked(*words, "local", code=2)
    assert "pip install 'mbsym[cluster]'" in done.stderr


def test_a_sweep_on_workers_gives_the_bytes_of_one_here(cluster: Here) -> None:
    common = [
        "sweep",
        "systems/ziegler-damped.yaml",
        "--vary",
        "P=0.1:4:20",
        "--vary",
        "b1=0.1:1:10",
        "--format",
        "csv",
        "-q",
    ]
    here, there = cluster.folder / "here", cluster.folder / "there"
    root = str(Path(__file__).parents[2])
    for folder, more in ((here, []), (there, ["--cluster", cluster.address])):
        done = subprocess.run([*MBSYM, *common, "--out", str(folder), *more], cwd=root, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
    assert (here / "sweep.csv").read_bytes() == (there / "sweep.csv").read_bytes()


def test_a_server_of_another_kind_is_no_scheduler(tmp_path: Path) -> None:
    """Eight bytes of what it says, "HTTP/1.1", are 3.5e18 as the number of frames of a message: no lack of memory."""
    invoked("examples", "ziegler", "--out", tmp_path / "s")
    with socket.create_server(("127.0.0.1", 0)) as server:

        def answer() -> None:
            with suppress(OSError):
                while True:
                    connection, _ = server.accept()
                    with connection:
                        connection.sendall(b"HTTP/1.1 400 Bad Request\r\n\r\n" + b"x" * 64)
                        connection.recv(1 << 16)

        threading.Thread(target=answer, daemon=True).start()
        address = f"tcp://127.0.0.1:{server.getsockname()[1]}"
        words = [*MBSYM, "batch", str(tmp_path / "s"), "--out", str(tmp_path / "b"), "--cluster", address]
        done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 2
    assert done.stderr == f"--cluster: what answers at {address} is no Dask scheduler of this version\n"
