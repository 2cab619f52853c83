"""Systems given by their matrices: what is read, from text and from files, and what is complained about and where."""

from __future__ import annotations

import io
from fractions import Fraction as F
from pathlib import Path

import numpy as np
import pytest
from conftest import filed, system_of

import mbsym
from mbsym.expressions.tree import Number
from mbsym.source import load, read, to_text, to_yaml
from mbsym.source.matrix_file import MOST_BYTES

HEAD = "mbsym: 1\nname: Pair\nparameters: {k: positive, c: positive, m: negative, w: real}\nlinear system:\n"
MARKET = "%%MatrixMarket matrix coordinate real symmetric\n% of a reduction\n2 2 3\n1 1 2.5\n2 1 -1e-1\n2 2 4\n"


def described(matrices: str) -> str:
    lines = "".join(f"  {line}\n" for line in matrices.splitlines())
    return f"{HEAD}  coordinates: [x, y]\n{lines}"


def in_folder(folder: Path, matrices: str, **files: str | bytes) -> Path:
    for name, content in files.items():
        (folder / name.replace("_", ".")).write_bytes(content.encode() if isinstance(content, str) else content)
    return filed(folder / "pair.yaml", described(matrices))


def saved(array: object) -> bytes:
    stream = io.BytesIO()
    np.save(stream, array)
    return stream.getvalue()


def numbers(path: Path, key: str) -> list[list[F]]:
    system = system_of(path)
    assert system.linear is not None
    found = system.linear.matrix(key)
    assert found is not None
    return [[x.value for x in row if isinstance(x, Number)] for row in found.rows]


def complaint(path: Path) -> tuple[str, str | None]:
    system, complaints, _ = load(path)
    assert system is None
    (one,) = complaints
    assert one.span is not None
    assert one.span.line == 6
    return one.message, one.hint


def test_both_spellings_come_back() -> None:
    text = described("M: [[2, 0], [0, 1]]\nC: [[c, w], [0, 0]]\nK: [[k, -1/2], [-1/2, 3*k]]\nB: [[1], [k]]")
    system = system_of(text.replace("linear system", "inputs: [u]\nlinear system"))
    assert read(to_yaml(system))[0] == system
    assert read(to_text(system))[0] == system


def test_a_matrix_market_file_holds_exact_decimals(tmp_path: Path) -> None:
    path = in_folder(tmp_path, "K: {file: K.mtx}", K_mtx=MARKET)
    assert numbers(path, "K") == [[F(5, 2), F(-1, 10)], [F(-1, 10), F(4)]]
    system = system_of(path)
    again, _ = read(to_yaml(system), "again.yaml", tmp_path)  # by its name and digest
    assert again == system
    assert read(to_text(system), "again.txt", tmp_path)[0] == system
    in_folder(tmp_path, "K: {file: K.mtx}", K_mtx=MARKET.replace("2.5", "2.25"))
    assert read(to_yaml(system), "again.yaml", tmp_path)[0] is None


def test_an_array_of_market_is_listed_by_columns(tmp_path: Path) -> None:
    general = "%%MatrixMarket matrix array integer general\n2 2\n1\n2\n3\n4\n"
    assert numbers(in_folder(tmp_path, "S: {file: S.mtx}", S_mtx=general), "S") == [[1, 3], [2, 4]]
    skew = "%%MatrixMarket matrix array real skew-symmetric\n2 2\n0.7\n"
    assert numbers(in_folder(tmp_path, "G: {file: G.mtx}", G_mtx=skew), "G") == [[0, F(-7, 10)], [F(7, 10), 0]]


def test_numpy_numbers_are_dyadic(tmp_path: Path) -> None:
    path = in_folder(tmp_path, "S: {file: S.npy}", S_npy=saved(np.asfortranarray([[0.1, 2.0], [3.0, -0.5]])))
    assert numbers(path, "S") == [[F(0.1), 2], [3, F(-1, 2)]]
    assert numbers(path, "S")[0][0] != F(1, 10)
    path = in_folder(tmp_path, "S: {file: S.npy}", S_npy=saved(np.array([[1, 2], [3, 4]], dtype=">i2")))
    assert numbers(path, "S") == [[1, 2], [3, 4]]


def _announcing(shape: str) -> bytes:
    """A header of a large array, and no array."""
    head = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}".ljust(117) + "\n"
    return b"\x93NUMPY\x01\x00" + len(head).to_bytes(2, "little") + head.encode()


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("K.mtx", MARKET.replace("2 1 -1e-1", "3 1 0"), "K.mtx:5: there is no entry 3, 1 in a matrix of 2 x 2"),
        ("K.mtx", MARKET.replace("2 1 -1e-1", "1 1 0"), "K.mtx:5: the entry 1, 1 is given twice"),
        ("K.mtx", MARKET.replace("4\n", "4,5\n"), "K.mtx:6: '4,5' is no number"),
        ("K.mtx", MARKET.replace("2 2 3", "2 2 4"), "K.mtx holds 3 entries, and 4 are announced"),
        ("K.mtx", MARKET.replace("2 2 3", "200 200 3"), "K.mtx holds a matrix of 200 x 200"),
        ("K.mtx", MARKET.replace("real", "complex"), "K.mtx:1: 'complex' is not read"),
        ("K.mtx", "1 2\n3 4\n", "K.mtx:1: no MatrixMarket header"),
        ("K.mtx", "", "K.mtx:1: no MatrixMarket header"),
        ("K.mtx", b"\xff\xfe", "K.mtx is no UTF-8 text"),
        ("K.mtx", b"%" * (MOST_BYTES + 1), f"K.mtx has more than {MOST_BYTES} bytes"),
        ("K.npy", saved(np.eye(3)), "K.npy holds a matrix of 3 x 3, and K is 2 x 2 here"),
        ("K.npy", saved(np.array([[1.0, np.nan], [0, 1]])), "K.npy: the entry 1, 2 is nan, no number"),
        ("K.npy", saved(np.array([1.0, 2.0])), "K.npy holds an array of 1 dimensions, and a matrix has 2"),
        ("K.npy", saved(np.eye(2) * 1j), "K.npy holds complex128"),
        ("K.npy", b"no array", "K.npy is no NumPy file"),
        ("K.npy", _announcing("(99999999, 99999999)"), "K.npy holds a matrix of 99999999 x 99999999"),
        ("K.npy", _announcing("(20, 20)"), "K.npy is not as long as its header says"),
        ("K.csv", "1, 2", "K.csv is no file of a matrix"),
        ("../K.mtx", "", "a file of a matrix stands beside the description"),
        ("missing.mtx", "", "there is no file missing.mtx beside the description"),
    ],
)
def test_complaints_about_files(tmp_path: Path, name: str, content: str | bytes, message: str) -> None:
    there = {} if "missing" in name or ".." in name else {name.replace(".", "_"): content}
    found, _ = complaint(in_folder(tmp_path, f"K: {{file: {name}}}", **there))
    assert message in found


@pytest.mark.parametrize(
    ("matrices", "message"),
    [
        ("K: [[k, w], [c, k]]", "K is not symmetric: entry 1, 2 is not entry 2, 1"),
        ("D: [[c, 1], [2, c]]", "D is not symmetric: entry 1, 2 is not entry 2, 1"),
        ("G: [[0, w], [w, 0]]", "G is not skew: entry 1, 2 is not entry 2, 1 with the other sign"),
        ("N: [[w, 0], [0, 0]]", "N is not skew: entry 1, 1 is not 0"),
        ("M: [[1, w], [0, 1]]\nK: [[k, 0], [0, k]]", "M is not symmetric: entry 1, 2 is not entry 2, 1"),
        ("M: [[1, 2], [2, 1]]\nK: [[k, 0], [0, k]]", "its leading minor of order 2 is -3"),
        ("M: [[m, w], [w, 1]]\nK: [[k, 0], [0, k]]", "its leading minor of order 1 is negative"),
        ("M: [[k, k], [k, k]]\nK: [[k, 0], [0, k]]", "its leading minor of order 2 is zero"),
    ],
)
def test_what_only_algebra_can_tell(tmp_path: Path, matrices: str, message: str) -> None:
    with pytest.raises(mbsym.DescriptionError) as raised:
        mbsym.load(in_folder(tmp_path, matrices))
    assert message in str(raised.value)
    assert "pair.yaml:6:" in str(raised.value)


def test_what_is_symmetric_by_algebra_is_no_mistake(tmp_path: Path) -> None:
    analysis = mbsym.load(
        in_folder(tmp_path, "K: [[k, 2/sqrt(2)], [sqrt(2), (k**2 - 1)/(k + 1)]]\nN: [[k - k, 1], [-1, 0]]")
    )
    assert str(analysis.linearisation.N) == "[[0, 1], [-1, 0]]"
