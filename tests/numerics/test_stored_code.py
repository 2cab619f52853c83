"""Machine code kept on disk: loaded instead of compiled, never trusted where it might be another's, never needed."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Callable
from inspect import unwrap
from pathlib import Path
from typing import Any

import llvmlite.binding
import pytest

from mbsym.numerics.kernels import llvm, stored
from mbsym.numerics.kernels.llvm import Library

TWICE = "define double @f(double %x) { %y = fmul double %x, 2.0\n ret double %y }"
THRICE = TWICE.replace("2.0", "3.0")


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder that kernels are kept in."""
    monkeypatch.setenv("MBSYM_CACHE", str(tmp_path))
    return tmp_path / "kernels"


@pytest.fixture
def compiled(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The texts that are compiled from now on."""
    texts: list[str] = []
    plain = llvmlite.binding.parse_assembly

    def counted(text: str) -> Any:
        if text:
            texts.append(text)
        return plain(text)

    monkeypatch.setattr(llvm.llvm, "parse_assembly", counted)
    return texts


def made(text: str) -> Callable[[float], float]:
    """The function f of a text, made as in a process of its own."""
    library = object.__new__(Library)
    unwrap(Library.__init__)(library, text)
    function = library.function("f", ctypes.c_double, result=ctypes.c_double)

    def called(x: float, library: Library = library) -> float:  # which lives as long
        value: float = function(x)
        return value

    return called


def test_a_text_is_compiled_once_for_all_processes(cache: Path, compiled: list[str]) -> None:
    assert made(TWICE)(1.5) == 3
    assert made(TWICE)(1.5) == 3
    assert made(THRICE)(1.5) == 4.5
    assert compiled == [TWICE, THRICE]
    assert len(list(cache.iterdir())) == 2


def test_what_is_not_whole_or_stands_under_another_name_is_compiled_again(cache: Path, compiled: list[str]) -> None:
    """A bit turned in the code or in its digest, a file cut off, an empty one, the code of another text."""
    made(TWICE)
    (file,) = cache.iterdir()
    whole = file.read_bytes()
    made(THRICE)
    (other,) = (one.read_bytes() for one in cache.iterdir() if one != file)
    turned = bytes([whole[0] ^ 1]) + whole[1:], whole[:-1] + bytes([whole[-1] ^ 1])
    for wrong in (*turned, whole[:100], b"", other):
        file.write_bytes(wrong)
        compiled.clear()
        assert made(TWICE)(1.5) == 3
        assert compiled == [TWICE]
        assert file.read_bytes() == whole


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="no owners")
def test_a_folder_that_others_may_write_to_is_left_alone(
    cache: Path, compiled: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    made(TWICE)
    cache.chmod(0o777)
    assert made(TWICE)(1.5) == 3
    made(THRICE)
    assert compiled == [TWICE, TWICE, THRICE]
    assert len(list(cache.iterdir())) == 1
    cache.chmod(0o700)
    monkeypatch.setattr(os, "getuid", lambda: cache.stat().st_uid + 1)
    made(TWICE)
    assert len(compiled) == 4


def test_no_folder_is_needed(cache: Path, compiled: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """A file in its place, nowhere to write, nothing wanted: compiled each time, and nothing is left behind."""
    cache.write_text("")
    assert made(TWICE)(1.5) == made(TWICE)(1.5) == 3
    monkeypatch.setenv("MBSYM_CACHE", "")
    assert made(TWICE)(1.5) == 3
    monkeypatch.setenv("MBSYM_CACHE", str(cache.parent / "other"))
    monkeypatch.setattr("tempfile.mkstemp", _refused)
    assert made(TWICE)(1.5) == 3
    monkeypatch.delenv("MBSYM_CACHE")
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(Path, "home", _nobody)
    assert made(TWICE)(1.5) == 3
    assert len(compiled) == 5
    assert not any(one.is_file() for one in (cache.parent / "other").rglob("*"))


def _refused(**_: Any) -> Any:
    raise PermissionError("read-only")


def _nobody() -> Path:
    raise RuntimeError("no home")


def test_addresses_of_this_process_are_not_kept(cache: Path) -> None:
    """What reads memory at a fixed place is of no use to another process, which has something else there."""
    number = ctypes.c_double(7)
    address = f"inttoptr (i64 {ctypes.addressof(number)} to ptr)"
    text = f"define double @f(double %x) {{ %y = load double, ptr {address}\n ret double %y }}"
    assert made(text)(0.0) == 7
    assert not cache.exists()


def test_the_oldest_goes_where_room_is_needed(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Files of 42 bytes: three and 10 more are beyond 110, one and 10 more are not beyond half of it."""
    monkeypatch.setattr(stored, "MOST_BYTES", 110)
    for k, key in enumerate("abc"):
        stored.keep(key, b"x" * 10)
        os.utime(cache / key, (k, k))
    stored.keep("d", b"x" * 10)
    assert {one.name for one in cache.iterdir()} == {"c", "d"}
    assert stored.load("d") == b"x" * 10
