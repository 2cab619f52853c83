"""Sets of files: whole or not at all, whatever happens; nothing of the user's own is lost."""

from __future__ import annotations

import errno
import hashlib
import json
import os
import random
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import filed, invoked

from mbsym_cli import files
from mbsym_cli.files import MANIFEST, deliver, delivered, folder_for, obstacle, safe_name

PENDULUM = Path(__file__).parents[2] / "systems" / "simple-pendulum.yaml"
NAMES = ("model.c", "model.h", "report.tex")

pytestmark = pytest.mark.skipif(os.name != "posix", reason="kills and limits")


def contents(mark: str, size: int = 1) -> dict[str, str | bytes]:
    return {name: f"{name} of {mark}\n" * size for name in NAMES}


def marks(folder: Path) -> set[str]:
    """Of which sets the files in a folder are."""
    return {(folder / name).read_text().split()[2] for name in NAMES if (folder / name).exists()}


def hidden(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir() if path.name.startswith(".mbsym") and path.name != MANIFEST)


def verified(folder: Path) -> bool:
    """Whether the manifest, read by nothing of ours, describes the files."""
    listed = json.loads((folder / MANIFEST).read_text())
    return all(
        hashlib.sha256((folder / name).read_bytes()).hexdigest() == digest
        for one in listed["sets"]
        for name, digest in one["files"].items()
    )


def in_a_child(work: Callable[[], None]) -> int:
    """Runs in a forked process that has no chance to tidy up; how it ended."""
    child = os.fork()
    if child == 0:
        try:
            work()
        except BaseException:
            os._exit(2)
        os._exit(0)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def test_a_set_and_its_manifest(tmp_path: Path) -> None:
    paths = deliver(tmp_path / "new", contents("one"), "run")
    assert [path.name for path in paths] == list(NAMES)
    assert marks(tmp_path / "new") == {"one"}
    assert verified(tmp_path / "new")
    assert not hidden(tmp_path / "new")
    assert set(delivered(tmp_path / "new", "run")) == set(NAMES)


@pytest.mark.parametrize("at", range(40))
def test_a_kill_at_any_step_never_mixes_two_sets(at: int, tmp_path: Path) -> None:
    """The process ends at its n-th touch of the file system, for every n."""
    (tmp_path / "own.txt").write_text("the user's own")
    deliver(tmp_path, contents("old") | {"earlier.csv": "old"}, "run")

    def work() -> None:
        left = at

        def dying(function: Callable[..., object]) -> Callable[..., object]:
            def call(*arguments: object, **named: object) -> object:
                nonlocal left
                if left == 0:
                    os.kill(os.getpid(), signal.SIGKILL)
                left -= 1
                return function(*arguments, **named)

            return call

        for name in ("rename", "replace", "unlink", "remove", "rmdir", "mkdir", "fsync", "open", "chmod"):
            setattr(os, name, dying(getattr(os, name)))
        deliver(tmp_path, contents("new"), "run")

    ended = in_a_child(work)
    assert ended in (0, -signal.SIGKILL)
    assert len(marks(tmp_path)) <= 1
    if ended:
        mended = deliver(tmp_path, {"other.json": "{}"}, "simulate")
        assert mended[0].read_text() == "{}"
    assert marks(tmp_path) in ({"old"}, {"new"})
    assert all((tmp_path / name).exists() for name in NAMES)
    assert (tmp_path / "earlier.csv").exists() == (marks(tmp_path) == {"old"})
    assert verified(tmp_path)
    assert not hidden(tmp_path)
    assert (tmp_path / "own.txt").read_text() == "the user's own"


def test_the_steps_of_the_kills_reach_the_end(tmp_path: Path) -> None:
    """Forty touches are more than a delivery makes, so that the test above has seen them all."""
    touched = 0
    deliver(tmp_path, contents("old"), "run")

    def counting(event: str, _: tuple[object, ...]) -> None:
        nonlocal touched
        if on and event in ("open", "os.rename", "os.remove", "os.rmdir", "os.mkdir", "os.chmod"):
            touched += 1

    on = True
    sys.addaudithook(counting)
    deliver(tmp_path, contents("new"), "run")
    on = False
    assert 10 < touched < 40


DELIVERING = """
import sys
from pathlib import Path
from mbsym_cli.files import deliver
for n in range(10**6):
    mark = f"{sys.argv[1]}{n}"
    deliver(Path("."), {name: f"{name} of {mark}\\n" * 2000 for name in ("model.c", "model.h", "report.tex")}, "run")
    if n == 0:
        print("under way", flush=True)
"""


def writer(folder: Path, mark: str) -> subprocess.Popen[str]:
    child = subprocess.Popen(
        [sys.executable, "-c", DELIVERING, mark], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert child.stdout is not None
    assert child.stdout.readline() == "under way\n"
    return child


def test_kills_at_random_moments_never_mix_two_sets(tmp_path: Path) -> None:
    chance = random.Random(9)
    for turn in range(8):
        child = writer(tmp_path, f"turn-{turn}-")
        time.sleep(chance.random() * 0.1)
        child.kill()
        child.communicate()
        assert len(marks(tmp_path)) <= 1
    deliver(tmp_path, {"other.json": "{}"}, "simulate")
    assert len(marks(tmp_path)) == 1
    assert all((tmp_path / name).exists() for name in NAMES)
    assert verified(tmp_path)
    assert not hidden(tmp_path)


def test_two_writers_at_once_never_mix_their_sets(tmp_path: Path) -> None:
    children = [writer(tmp_path, "a"), writer(tmp_path, "b")]
    seen: set[str] = set()
    deadline = time.monotonic() + 30
    while len(seen) < 20 or len({mark[0] for mark in seen}) < 2:
        assert time.monotonic() < deadline
        with files.alone(tmp_path):
            found = marks(tmp_path)
            assert len(found) == 1
            assert verified(tmp_path)
            seen |= found
        time.sleep(0.005)
    for child in children:
        assert child.poll() is None
        child.kill()
        child.communicate()
    assert {mark[0] for mark in seen} == {"a", "b"}


def test_a_full_disk_leaves_the_old_set(tmp_path: Path) -> None:
    deliver(tmp_path, contents("old"), "run")

    def work() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, 10_000))
        try:
            deliver(tmp_path, contents("new") | {"z.csv": "x" * 20_000}, "run")
        except OSError as error:
            os._exit(17 if error.errno == errno.EFBIG else 1)

    assert in_a_child(work) == 17
    assert marks(tmp_path) == {"old"}
    assert verified(tmp_path)
    assert not hidden(tmp_path)


def test_no_space_at_any_file_leaves_the_old_set(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    deliver(tmp_path, contents("old"), "run")
    for refused in range(len(NAMES) + 1):  # the last one is the manifest
        left = refused

        def fsync(handle: int) -> None:
            nonlocal left
            if left == 0:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            left -= 1

        with monkeypatch.context() as patched:
            patched.setattr(os, "fsync", fsync)
            with pytest.raises(OSError, match="No space left"):
                deliver(tmp_path, contents("new"), "run")
        assert marks(tmp_path) == {"old"}
        assert not hidden(tmp_path)


def test_a_folder_that_was_made_for_nothing_goes_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, "full")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="full"):
        deliver(tmp_path / "made", contents("new"), "run")
    assert not (tmp_path / "made").exists()


def test_interrupted_after_the_commit_it_is_completed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    deliver(tmp_path, contents("old"), "run")
    honest, count = os.replace, 0

    def replace(old: object, new: object) -> None:
        nonlocal count
        count += 1
        if count == 2:
            raise KeyboardInterrupt
        honest(old, new)  # type: ignore[arg-type]

    monkeypatch.setattr(os, "replace", replace)
    with pytest.raises(KeyboardInterrupt):
        deliver(tmp_path, contents("new"), "run")
    assert marks(tmp_path) == {"new"}
    assert verified(tmp_path)
    assert not hidden(tmp_path)


def test_only_own_and_unchanged_files_are_removed(tmp_path: Path) -> None:
    (tmp_path / "histories-9.svg").write_text("drawn by the user")
    deliver(tmp_path, {"a.csv": "1", "b.csv": "2", "c.csv": "3"}, "simulate")
    deliver(tmp_path, contents("run"), "run")
    (tmp_path / "b.csv").write_text("edited by the user")
    deliver(tmp_path, {"c.csv": "4"}, "simulate")
    left = {path.name for path in tmp_path.iterdir()}
    assert left == {"histories-9.svg", "b.csv", "c.csv", MANIFEST, *NAMES}
    assert (tmp_path / "b.csv").read_text() == "edited by the user"
    assert delivered(tmp_path, "simulate").keys() == {"c.csv"}


def test_a_set_may_keep_and_name_what_goes(tmp_path: Path) -> None:
    deliver(tmp_path, contents("one"), "run")
    deliver(tmp_path, {"results.json": "{}"}, "run", gone=("report.tex",))
    assert {path.name for path in tmp_path.iterdir()} == {"model.c", "model.h", "results.json", MANIFEST}
    assert verified(tmp_path)


@pytest.mark.parametrize("manifest", ["", "[1", "[]", '{"sets": 3}', '{"sets": [{"command": "run", "files": 3}]}'])
def test_a_manifest_that_cannot_be_read_is_none(manifest: str, tmp_path: Path) -> None:
    (tmp_path / MANIFEST).write_text(manifest)
    (tmp_path / "kept.csv").write_text("kept")
    deliver(tmp_path, contents("new"), "run")
    assert (tmp_path / "kept.csv").exists()
    assert verified(tmp_path)


def test_a_manifest_cannot_name_files_elsewhere(tmp_path: Path) -> None:
    victim = filed(tmp_path / "victim", "mine")
    digest = hashlib.sha256(b"mine").hexdigest()
    out = tmp_path / "out"
    out.mkdir()
    (out / "link").symlink_to(victim)
    listed = dict.fromkeys(("../victim", str(victim), "link", "..", ".", ""), digest)
    (out / MANIFEST).write_text(json.dumps({"sets": [{"command": "run", "files": listed}]}))
    deliver(out, contents("new"), "run")
    assert victim.read_text() == "mine"


def test_links_are_replaced_not_followed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    victim = filed(tmp_path / "victim", "mine")
    out = tmp_path / "out"
    out.mkdir()
    (out / "model.c").symlink_to(victim)
    with pytest.raises(FileExistsError):  # it is none of ours
        deliver(out, contents("new"), "run")
    monkeypatch.setattr(files.Force, "wanted", True)
    deliver(out, contents("new"), "run")
    assert victim.read_text() == "mine"
    assert not (out / "model.c").is_symlink()


def test_a_folder_in_the_place_of_a_file(tmp_path: Path) -> None:
    deliver(tmp_path, {"model.h": "old"}, "run")
    (tmp_path / "model.c").mkdir()
    with pytest.raises(IsADirectoryError):
        deliver(tmp_path, contents("new"), "run")
    assert (tmp_path / "model.h").read_text() == "old"
    assert not hidden(tmp_path)


def test_strays_of_single_files_go_when_they_are_old(tmp_path: Path) -> None:
    for name, age in ((".mbsym-part-old", 1e5), (".mbsym-part-new", 0.0)):
        (tmp_path / name).write_text("half")
        os.utime(tmp_path / name, (time.time() - age, time.time() - age))
    files.write_whole(tmp_path / "own.txt", "whole")
    assert {path.name for path in tmp_path.iterdir()} == {".mbsym-part-new", "own.txt"}


@pytest.mark.parametrize(
    ("file", "folder"),
    [
        ("satellite.yaml", "satellite"),
        ("satellite.v2.yaml", "satellite.v2"),
        ("...yaml", "unnamed"),
        ("..yaml", "unnamed"),
        ("a/../..yaml", "unnamed"),
        ("... .yaml", "unnamed"),
        (".yaml", ".yaml"),
        ("trailing. .yaml", "trailing"),
        ("con.yaml", "_con"),
        ("LPT1.first.yaml", "_LPT1.first"),
        ("console.yaml", "console"),
        ("a\nb\x1b[2J.yaml", "a_b_[2J"),
        ("a\\..\\b.yaml", "a_.._b"),
        (".mbsym-ready.yaml", "_.mbsym-ready"),
        ("Träger.yaml", "Träger"),
    ],
)
def test_a_description_never_names_another_folder(file: str, folder: str) -> None:
    assert folder_for(Path(file), None) == Path("reports") / folder
    assert folder_for(Path(file), Path("elsewhere")) == Path("elsewhere")


def test_long_names_are_cut_and_told_apart() -> None:
    first, second = safe_name("ä" * 124), safe_name("ä" * 123 + "ö")
    assert first != second
    assert len(first.encode()) < 220


def test_a_link_out_of_the_reports_is_an_obstacle(tmp_path: Path) -> None:
    (tmp_path / "reports").mkdir()
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "reports" / "a").symlink_to(tmp_path / "elsewhere")
    (tmp_path / "reports" / "loop").symlink_to(tmp_path / "reports" / "loop")
    base = tmp_path / "reports"
    assert "leads out of" in obstacle(base / "a", base)
    assert obstacle(base / "loop", base)
    assert not obstacle(base / "a")
    assert not obstacle(base / "b", base)


NAMES_OF_FILES = [
    "...yaml",
    "..yaml",
    ".yaml",
    "con.yaml",
    "trail. .yaml",
    "a\\..\\b.yaml",
    "ok.yaml",
    "OK.yml",
    "ä.yaml",
]


def test_whatever_a_description_is_called_its_reports_stay_where_they_belong(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    work = tmp_path / "a" / "b"
    work.mkdir(parents=True)
    monkeypatch.chdir(work)
    for name in NAMES_OF_FILES:
        (work / name).write_text(PENDULUM.read_text(encoding="utf-8"), encoding="utf-8")
    for out in ([], ["--out", "elsewhere"]):
        invoked("run", *NAMES_OF_FILES, "-f", "json", "-p", "1", "-q", *out, code=0)
        base = work / (out[1] if out else "reports")
        folders = [path for path in base.iterdir() if path.is_dir()]
        assert len(folders) == len(NAMES_OF_FILES)
        assert all((folder / "results.json").exists() for folder in folders)
    for name in NAMES_OF_FILES[:3]:
        invoked("simulate", name, "-s", "theta=1", "-t", "0.1", "-f", "csv", "--no-estimate", "-q", code=0)
    written = {path for path in tmp_path.rglob("*") if path.suffix in (".json", ".csv")}
    assert all(path.is_relative_to(work / "reports") or path.is_relative_to(work / "elsewhere") for path in written)
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


@pytest.mark.parametrize("command", [["run", "-f", "json"], ["simulate", "-s", "theta=1", "-t", "0.1"]])
def test_a_planted_link_is_not_followed(command: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    victim = tmp_path / "victim"
    victim.mkdir()
    (tmp_path / "reports").mkdir()
    (tmp_path / "reports" / "simple-pendulum").symlink_to(victim)
    done = invoked(*command, PENDULUM, code=1)
    assert "is a link that leads out of reports" in done.stderr
    assert not list(victim.iterdir())


# --- one folder inside ---


def test_a_set_with_a_folder_inside_is_delivered_whole(tmp_path):
    deliver(tmp_path, {"a.tex": "1", "parts/b.tex": "2", "parts/c.tex": "3"}, "run")
    assert (tmp_path / "parts" / "b.tex").read_text() == "2"
    assert {name for _, found in files.read_manifest(tmp_path) for name in found} == {
        "a.tex",
        "parts/b.tex",
        "parts/c.tex",
    }
    (tmp_path / "parts" / "own.tex").write_text("mine")
    deliver(tmp_path, {"a.tex": "4"}, "run")
    assert [path.name for path in (tmp_path / "parts").iterdir()] == ["own.tex"]
    (tmp_path / "parts" / "own.tex").unlink()
    deliver(tmp_path, {"parts/b.tex": "5"}, "run")
    deliver(tmp_path, {"a.tex": "6"}, "run")
    assert not (tmp_path / "parts").exists()


def test_a_folder_inside_is_no_way_out(tmp_path):
    outside = tmp_path / "outside"
    outside.mkdir()
    out = tmp_path / "out"
    out.mkdir()
    (out / "parts").symlink_to(outside)
    with pytest.raises(NotADirectoryError):
        deliver(out, {"a.tex": "1", "parts/b.tex": "2"}, "run")
    assert not list(outside.iterdir())
    assert not (out / "a.tex").exists()
    for name in ("../a", "a/../../b", "a/b/c", "/a", "a//b", ".mbsym/a"):
        with pytest.raises(ValueError, match="names of files"):
            deliver(out, {name: "1"}, "run")
