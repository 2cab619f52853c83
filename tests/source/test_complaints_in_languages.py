"""Complaints about descriptions in the language that the description names; for programs they stay English."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from mbsym.expressions.message import Message
from mbsym.report.language import Language
from mbsym.source import read
from mbsym.source.text_lines import language_of
from mbsym_cli.main import main

WRONG = """mbsym: 1
name: Wrong
{language}bodies:
  - {{name: a, attached to: 0, connection point: [x, 0], mass: m, coordinates: [x]}}
  - {{name: b, attached to: 0, mass: m, colour: red}}
loads:
  - spring: {{coordinate: xx, stiffness: 1}}
"""
#: By hand: what is said of the connection point, of the key that there is not, at the end.
SAID = {
    "": (
        "wrong-shape]: a connection point has three components, not 2", "hint: components along the axes 1, 2, 3",
        "unknown-key]: unknown key 'colour' in body 2", "errors; nothing was written.",
    ),
    "ru": (
        "wrong-shape]: точка соединения: составляющих три, а не 2", "совет: составляющие по осям 1, 2, 3",
        "unknown-key]: тело 2: неизвестный ключ 'colour'", "ничего не записано.",
    ),
    "es": (
        "wrong-shape]: un punto de conexión tiene tres componentes, no 2", "sugerencia: componentes según los ejes",
        "unknown-key]: clave desconocida 'colour' en cuerpo 2", "no se escribió nada.",
    ),
}  # fmt: skip
CORPUS = sorted((Path(__file__).parents[1] / "invalid").iterdir())


def described(language: str, folder: Path) -> Path:
    file = folder / "wrong.yaml"
    file.write_text(WRONG.format(language=f"language: {language}\n" if language else ""), encoding="utf-8")
    return file


@pytest.mark.parametrize("language", SAID)
def test_complaints_are_said_in_the_language_of_the_description(language: str, tmp_path: Path) -> None:
    """What finds them, code and place, is the same in each; English where the description says nothing."""
    done = CliRunner().invoke(main, ["check", str(described(language, tmp_path))])
    assert done.exit_code == 2
    for part in SAID[language]:
        assert part in done.stderr
    assert "wrong.yaml:" in done.stderr


def test_programs_read_english(tmp_path: Path) -> None:
    written = [
        CliRunner().invoke(main, ["check", "--output-format", "json", str(described(language, tmp_path))]).stdout
        for language in SAID
    ]
    told = [[(one["code"], one["message"], one["hint"]) for one in map(json.loads, x.splitlines())] for x in written]
    assert told[0] == told[1] == told[2]
    assert ("unknown-key", "unknown key 'colour' in body 2") in {(code, text) for code, text, _ in told[0]}


@pytest.mark.parametrize(
    ("text", "language"),
    [
        ("mbsym: 1\nlanguage: ru\n", "ru"), ("mbsym: 1\n'language': \"es\"\nbodies: [", "es"),
        ("Language: ru\nName: x\n", "ru"), ("mbsym: 1\nlanguage: de\n", ""), ("mbsym: 1\nx:\n  language: ru\n", ""),
    ],
)  # fmt: skip
def test_the_language_is_read_from_what_is_wrong_too(text: str, language: str) -> None:
    assert language_of(text) == language


def test_complaints_of_all_wrong_descriptions_are_translated() -> None:
    """Whatever the corpus complains about has other words in Russian; names and hints may keep theirs."""
    english = set()
    for path in CORPUS:
        text = path.read_text(encoding="utf-8", errors="replace")
        for one in read(text, path.name)[1]:
            said = Language("ru").say(one.message)
            template = one.message.text if isinstance(one.message, Message) else one.message
            if said == one.message:
                english.add(template)
    assert not english
