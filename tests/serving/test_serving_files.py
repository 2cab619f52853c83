"""The file, its journal and the pages that look at it: nothing is lost, and nothing is written over unseen."""

from __future__ import annotations

import errno
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from conftest import filed

pytest.importorskip("starlette")
pytest.importorskip("httpx")

from serving_editor import PENDULUM, TOKEN, edited

from mbsym.serving.storage import Conflict, Storage, Unreadable, Unwritable, digest_of

OTHER = PENDULUM.replace("values: {m: 1", "values: {m: 2")


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return filed(tmp_path / "pendulum.yaml", PENDULUM)


def strays(folder: Path) -> list[str]:
    return [x.name for x in folder.iterdir() if x.name.startswith(".mbsym-part-")]


def test_what_is_saved_is_the_text_byte_for_byte(path: Path) -> None:
    storage = Storage(path)
    for text in ("a\r\nb\r\n", "\ufeffmbsym: 1\n", "tab\there, no end", "\U0001d714 é\n", ""):
        digest = storage.save(text, storage.read().digest)
        assert path.read_bytes() == text.encode()
        assert digest == storage.read().digest == digest_of(text.encode())
    assert not strays(path.parent)


@pytest.mark.skipif(os.name != "posix", reason="modes and links as POSIX has them")
def test_mode_and_link_stay(path: Path, tmp_path: Path) -> None:
    path.chmod(0o640)
    link = tmp_path / "link.yaml"
    link.symlink_to(path.name)
    storage = Storage(link)
    storage.save(OTHER, storage.read().digest)
    assert link.is_symlink()
    assert path.read_text() == OTHER
    assert path.stat().st_mode & 0o777 == 0o640


def test_what_someone_else_wrote_is_not_written_over(path: Path) -> None:
    storage = Storage(path)
    digest = storage.read().digest
    path.write_text(OTHER)
    with pytest.raises(Conflict) as conflict:
        storage.save("mine", digest)
    assert conflict.value.text == OTHER
    assert path.read_text() == OTHER
    storage.save("mine", digest, force=True)
    assert path.read_text() == "mine"


def test_what_was_removed_or_made_meanwhile_is_a_conflict_too(path: Path) -> None:
    storage = Storage(path)
    digest = storage.read().digest
    path.unlink()
    with pytest.raises(Conflict):
        storage.save("mine", digest)
    new = Storage(path.with_name("new.yaml"))
    assert new.read().digest == ""
    new.path.write_text(OTHER)
    with pytest.raises(Conflict):
        new.save("mine", "")


@pytest.mark.parametrize("data", [b"\xff\xfe\0", b"binary\0", b"x" * 3_000_000])
def test_what_is_no_description_is_not_edited(path: Path, data: bytes) -> None:
    path.write_bytes(data)
    with pytest.raises(Unreadable):
        Storage(path).read()


@pytest.mark.parametrize("text", ["\ud800", "a\0b", "x" * 3_000_000])
def test_what_no_file_should_hold_is_refused(path: Path, text: str) -> None:
    storage = Storage(path)
    with pytest.raises(Unwritable):
        storage.save(text, storage.read().digest)
    assert path.read_text() == PENDULUM


_KILLED = """
import os, signal, sys
from pathlib import Path
from mbsym.serving.storage import Storage
storage, point = Storage(Path(sys.argv[1])), sys.argv[2]
digest = storage.read().digest
storage.keep(sys.argv[3])
real = getattr(os, point.split()[-1])
def fatal(*given):
    if point.startswith("after"):
        real(*given)
    os.kill(os.getpid(), signal.SIGKILL)
setattr(os, point.split()[-1], fatal)
storage.save(sys.argv[3], digest)
"""


@pytest.mark.skipif(os.name != "posix", reason="kill -9")
@pytest.mark.parametrize(("point", "saved"), [("fsync", False), ("replace", False), ("after replace", True)])
def test_killed_while_saving_nothing_is_lost(path: Path, point: str, saved: bool) -> None:
    """SIGKILL before the bytes are flushed, before the file is renamed, after it: the old file or the new one, whole;
    what was typed is offered at the next start unless it is in the file."""
    done = subprocess.run([sys.executable, "-c", _KILLED, str(path), point, OTHER], check=False, timeout=60)
    assert done.returncode == -9
    assert path.read_text() == (OTHER if saved else PENDULUM)
    offered = Storage(path).offered()
    if saved:
        assert offered is None
    else:
        assert offered is not None
        assert offered.text == OTHER


def test_the_journal_is_offered_until_something_is_saved(path: Path) -> None:
    with edited(path) as client:
        assert client.file()["journal"] is None
        assert client.post("journal", text=OTHER, digest="").status_code == 200
    with edited(path) as client:  # another session
        offered = client.file()["journal"]
        assert offered["text"] == OTHER
        client.post("journal", text=PENDULUM + "# typed on before the offer was looked at\n", digest="")
    with edited(path) as client:
        assert client.file()["journal"]["text"].endswith("looked at\n")
        before = path.with_name(f".{path.name}.mbsym-journal-before")
        assert json.loads(before.read_text())["text"] == OTHER, "that is there, too"
        saved = client.post("save", text=OTHER, digest=client.file()["digest"])
        assert saved.status_code == 200
        assert client.file()["journal"] is None
    assert [x.name for x in path.parent.iterdir()] == [path.name], "a clean save leaves nothing beside the file"


def test_a_journal_of_what_the_file_holds_is_none(path: Path) -> None:
    storage = Storage(path)
    storage.keep(OTHER)
    storage.keep(PENDULUM)  # undone
    assert not storage.journal_path.exists()


@pytest.mark.parametrize("content", [b"", b"{", b"[1]", b'{"text": 1, "written": 2}', b"\xff", b"[" * 100_000])
def test_half_a_journal_is_none(path: Path, content: bytes) -> None:
    path.with_name(f".{path.name}.mbsym-journal").write_bytes(content)
    assert Storage(path).offered() is None


def test_two_pages_on_one_file(path: Path) -> None:
    """Who saves second is told what the first has saved, instead of writing over it."""
    with edited(path) as client:
        one, other = client.file(), client.file()
        assert client.post("save", text=OTHER, digest=one["digest"]).status_code == 200
        refused = client.post("save", text="mbsym: 1\nname: mine\n", digest=other["digest"])
        assert refused.status_code == 409
        assert refused.json() == {"digest": digest_of(OTHER.encode()), "text": OTHER}
        assert path.read_text() == OTHER


def test_a_change_outside_is_told(path: Path) -> None:
    with edited(path) as client:
        told: list[dict[str, object]] = []
        client.editor._tell = told.append
        path.write_text(OTHER)
        end = time.monotonic() + 10
        while not told and time.monotonic() < end:
            time.sleep(0.05)
        assert told == [{"kind": "outside", "digest": digest_of(OTHER.encode()), "text": OTHER}]
        assert client.http.get(f"/{TOKEN}/api/digest").json()["digest"] == digest_of(OTHER.encode())


def test_a_new_file_begins_with_a_description(tmp_path: Path) -> None:
    for name, format in (("new crane.yaml", "yaml"), ("crane.txt", "text")):
        with edited(tmp_path / name) as client:
            found = client.file()
            assert found["new"]
            assert found["format"] == format
            assert not (tmp_path / name).exists(), "nothing is written before it is saved"
            assert client.post("save", text=found["text"], digest=found["digest"]).status_code == 200
            assert (tmp_path / name).read_text() == found["text"]


def test_on_a_full_disk_the_old_file_and_the_old_journal_stay(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with edited(path) as client:
        assert client.post("journal", text=OTHER).status_code == 200

        def full(handle: int) -> None:
            raise OSError(errno.ENOSPC, "No space left on device")

        monkeypatch.setattr(os, "fsync", full)
        for name in ("save", "journal"):
            answer = client.post(name, text=OTHER + "# more\n", digest=client.file()["digest"])
            assert answer.status_code == 422
            assert "No space left" in answer.json()["message"]
        assert path.read_text() == PENDULUM
        assert client.file()["journal"]["text"] == OTHER
        assert not strays(path.parent)


def test_a_file_that_became_a_folder_is_left_alone(path: Path) -> None:
    with edited(path) as client:
        digest = client.file()["digest"]
        path.unlink()
        path.mkdir()
        for force in (False, True):
            answer = client.post("save", text=OTHER, digest=digest, force=force)
            assert answer.status_code == 422, "with words, and no page is lost for it"
            assert answer.json()["message"]
        assert client.post("journal", text=OTHER).status_code == 200, "what is typed is kept all the same"
        assert client.http.get(f"/{TOKEN}/api/digest").status_code == 200
        assert path.is_dir()
        path.rmdir()
        assert client.post("save", text=OTHER, digest=digest, force=True).status_code == 200
        assert path.read_text() == OTHER
    assert not strays(path.parent)


@pytest.mark.skipif(os.name != "posix", reason="links as POSIX has them")
def test_a_journal_that_is_a_link_leads_to_no_other_file(path: Path, tmp_path: Path) -> None:
    """Somebody laid a link where the journal will stand: what it leads to is neither read nor written."""
    precious = filed(tmp_path / "precious", json.dumps({"text": "secret", "written": "now"}))
    journal = path.with_name(f".{path.name}.mbsym-journal")
    journal.symlink_to(precious)
    with edited(path) as client:
        assert client.file()["journal"] is None
        assert client.post("journal", text=OTHER).status_code == 200
    assert json.loads(precious.read_text())["text"] == "secret"
    assert not journal.is_symlink()


def test_what_killed_saves_left_aside_goes_with_the_next_start_or_save(path: Path) -> None:
    """Of this file only, and not while its writer is at work."""
    killed = """
import os, sys
from pathlib import Path
from mbsym.serving import storage
os.replace = lambda *_: os._exit(9)
one = storage.Storage(Path(sys.argv[1]))
one.save("half", one.read().digest)
"""
    other = path.with_name(".mbsym-part-of-somebody-else")
    other.write_text("at work")

    def kill() -> None:
        assert subprocess.run([sys.executable, "-c", killed, str(path)], check=False).returncode == 9
        assert len(strays(path.parent)) == 2

    kill()
    storage = Storage(path)
    assert strays(path.parent) == [other.name]
    kill()
    storage.save(OTHER, storage.read().digest)
    assert strays(path.parent) == [other.name]
    sleeping = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"])
    try:
        kill()
        (left,) = (x for x in path.parent.iterdir() if x.name in strays(path.parent) and x != other)
        head, _, tail = left.name.removeprefix(".mbsym-part-").split("-", 2)
        running = left.rename(left.with_name(f".mbsym-part-{head}-{sleeping.pid}-{tail}"))
        storage.save(PENDULUM, storage.read().digest)
        assert running.exists()
        os.utime(running, (time.time() - 4000, time.time() - 4000))
        storage.save(OTHER, storage.read().digest)
        assert not running.exists()
    finally:
        sleeping.kill()
        sleeping.wait()
