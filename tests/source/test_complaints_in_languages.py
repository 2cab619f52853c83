"""Complaints about descriptions in the language that the description names; for programs they stay English."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from conftest import filed, invoked

from mbsym.expressions.message import Message
from mbsym.report.language import Language
from mbsym.source import read
from mbsym.source.text_lines import language_of

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
        "unknown-key]: unknown key 'colour' in body 2", "errors: 5",
    ),
    "ru": (
        "wrong-shape]: точка соединения: составляющих три, а не 2", "совет: составляющие по осям 1, 2, 3",
        "unknown-key]: тело 2: неизвестный ключ 'colour'", "ошибок: 5",
    ),
    "es": (
        "wrong-shape]: un punto de conexión tiene tres componentes, no 2", "sugerencia: componentes según los ejes",
        "unknown-key]: clave desconocida 'colour' en cuerpo 2", "errores: 5",
    ),
}  # fmt: skip
CORPUS = sorted((Path(__file__).parents[1] / "invalid").iterdir())


def described(language: str, folder: Path) -> Path:
    return filed(folder / "wrong.yaml", WRONG.format(language=f"language: {language}\n" if language else ""))


@pytest.mark.parametrize("language", SAID)
def test_complaints_are_said_in_the_language_of_the_description(language: str, tmp_path: Path) -> None:
    """What finds them, code and place, is the same in each; English where the description says nothing."""
    done = invoked("check", described(language, tmp_path), code=2)
    for part in SAID[language]:
        assert part in done.stderr
    assert "wrong.yaml:" in done.stderr


def test_programs_read_english(tmp_path: Path) -> None:
    written = [invoked("check", "--output-format", "json", described(language, tmp_path)).stdout for language in SAID]
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


#: By hand: a wrong command line, and what is said of it.
OPTIONS = {
    "map --x Omga=0:1": ("нет параметра по имени 'Omga'", "ningún parámetro llamado 'Omga'"),
    "map --x k=2:1": ("интервал от 2 до 1 пуст", "el intervalo de 2 a 1 está vacío"),
    "map --x k": ("'k' не задаёт интервала", "'k' no da ningún intervalo"),
    "map --x k=1:2 --y k=1:2 -s m=1": ("взято для двух осей", "está tomado para dos ejes"),
    "map --x k=1:2 -s k=1": ("и интервал, и число", "tiene un intervalo y un número"),
    "equilibria": ("нет числа для m, k", "no hay número para m, k"),
    "run -s W=1": ("нечего задавать по имени 'W'", "no hay nada llamado 'W' a lo que dar un valor"),
    "run -s k=1 -s k=2": ("'k' задано дважды", "'k' está dado dos veces"),
    "show W": ("здесь ничто не называется 'W'", "aquí nada se llama 'W'"),
}


@pytest.mark.parametrize("words", OPTIONS)
def test_complaints_about_options_are_said_in_it_too(words: str, tmp_path: Path) -> None:
    """All of their lines, but for the names of options and what a command shows of itself."""
    body = "{name: a, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}"
    text = f"mbsym: 1\nname: Spring\nparameters: {{m: positive, k: positive}}\nbodies: [{body}]\n"
    text += "loads: [{spring: {coordinate: x, stiffness: k}}]\nmotion: {x: 0}\n"
    command, *options = words.split(" ")
    for language, said in zip(("ru", "es"), OPTIONS[words], strict=True):
        file = filed(tmp_path / f"{language}.yaml", f"{text}language: {language}\n")
        done = invoked(command, file, *options, env={"COLUMNS": "200"}, code=2)
        assert said in done.stderr
        assert {"ru": "ничего не записано.", "es": "no se escribió nada."}[language] in done.stderr
        assert not [x for x in (" is ", "nothing was", "no value", "hint", "there") if x in done.stderr], done.stderr
