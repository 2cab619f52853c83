"""Symbols for names, a source, a language; what is no plain symbol is complained about, in its place."""

from __future__ import annotations

import pytest

import mbsym
from mbsym.source import read
from mbsym.source.text_writer import to_text
from mbsym.source.yaml_writer import to_yaml
from tests.conftest import SHIPPED

PENDULUM = (SHIPPED / "double-pendulum.yaml").read_text()


def described(symbols: str) -> str:
    return f"{PENDULUM}\nsource: 'A & B; \"C\": 1 # 2'\nlanguage: es\nlatex: {symbols}\n"


def test_both_spellings_keep_them() -> None:
    system, complaints = read(described(r"{m1: 'm_{C1}', theta1: '\hat{\vartheta}_1', g: '\mathrm{g}'}"))
    assert not complaints.items
    assert [(one.name, one.latex) for one in system.symbols] == [
        ("m1", "m_{C1}"),
        ("theta1", r"\hat{\vartheta}_1"),
        ("g", r"\mathrm{g}"),
    ]
    assert (system.source, system.language) == ('A & B; "C": 1 # 2', "es")
    for writer in (to_yaml, to_text):
        assert read(writer(system)) == (system, complaints)


def test_formulas_are_written_with_them() -> None:
    analysis = mbsym.loads(described(r"{m1: 'm_{C1}', theta1: '\hat{\vartheta}_1'}"))
    written = analysis.energy.A2[0, 0].latex() + analysis.kinematics.bodies[0].angular_velocity[2].latex()
    assert "m_{C1}" in written
    assert r"\dot{\hat{\vartheta}}_{1}" in written
    assert "m_{1}" not in written


def test_no_two_names_look_alike() -> None:
    analysis = mbsym.loads(described("{m1: 'm_{2}'}"))
    assert r"\mathtt{m2}" in analysis.energy.A2[0, 0].latex()
    assert [item.code for item in read(described("{m1: a, m2: a}"))[1].items] == ["repeated-symbol"]


#: The symbol, and how many characters into it the complaint points.
WRONG = [
    (r"\pi", 0),  # the number
    (r"\input{x}", 0), ("a^2", 1), ("{x}", 0), (r"\hat x", 0), ("d_", 2), ("d_{", 2), ("x y", 1), (r"\hat{}", 4),
    ("a_b_c", 3), ("$x$", 0), (r"\mathrm{a b}", 9), ("%", 0), ("é", 0), ("\\\\", 0), ("a_{b_c}", 4), ("a}", 1),
    (r"a_{\input x}", 3), (r"\hat{xy}", 6), (r"\def\x{1}", 0), ("a_{}", 2), (r"\mathrm{x}^^5c", 10), ("#1", 0),
    ("~", 0), (r"x\\y", 1), (r"\csname x", 0), ("a_{" + "b" * 80 + "}", 0),
]  # fmt: skip


@pytest.mark.parametrize(("symbol", "place"), WRONG)
def test_nothing_else_gets_through(symbol: str, place: int) -> None:
    text = described(f"{{m1: '{symbol}'}}")
    system, complaints = read(text)
    assert system is None
    (complaint,) = complaints.items
    assert (complaint.code, bool(complaint.hint)) == ("bad-symbol", True)
    line = text.split("\n")[complaint.span.line - 1]
    assert complaint.span.column - 1 == line.index(symbol) + place


def test_unknown_names_and_languages() -> None:
    _, complaints = read(described("{mm1: a}").replace("language: es", "language: de"))
    assert sorted(item.code for item in complaints.items) == ["bad-word", "unknown-name"]


def test_a_user_says_in_which_order_subsystems_are_told() -> None:
    text = (SHIPPED / "satellite.yaml").read_text()
    plain = mbsym.loads(text, (5,)).linearisation
    assert [part.coordinates for part in plain.subsystems] == [("psi", "phi", "sigma"), ("theta", "delta")]
    system, complaints = read(text + "\norder: [delta, phi]\n")
    assert not complaints.items
    assert read(to_yaml(system))[0] == system
    assert read(to_text(system))[0] == system
    told = mbsym.loads(text + "\norder: [delta, phi]\n", (5, 6))
    found = told.linearisation.subsystems
    assert [part.coordinates for part in found] == [("delta", "theta"), ("phi", "psi", "sigma")]
    # Turned around, the matrices are the same: the pair (theta, delta) of the paper.
    before, after = plain.subsystems[1].K, found[0].K
    assert all(str(after[i, j]) == str(before[1 - i, 1 - j]) for i in (0, 1) for j in (0, 1))
    assert str(before[0, 0]) != str(before[1, 1])
    _, complaints = read(text + "\norder: [delta, delta, l]\n")
    assert sorted(item.code for item in complaints.items) == ["misplaced-name", "repeated-key"]
