"""The shipped systems, the two spellings, files that cannot be read, and texts that wish us ill."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml
from conftest import system_of
from hypothesis import HealthCheck, given
from hypothesis import strategies as st
from properties import settings

from mbsym.expressions.place import Complaint, Span
from mbsym.expressions.safe import safe
from mbsym.expressions.tree import text as written
from mbsym.model.loads import CoordinateSpring, PointForce, UniformGravity
from mbsym.model.system import Inertia, System, rational
from mbsym.source import json_schema, load, read, render, to_text, to_yaml
from mbsym.source.document import MAX_COMPLAINTS, MAX_OF_A_KIND
from mbsym.source.placed import MAX_TEXT
from mbsym.source.scope import slip_of

SYSTEMS = sorted((Path(__file__).parents[2] / "systems").glob("*.yaml"))
EVERYTHING = Path(__file__).parents[1] / "everything.yaml"
GOOD = [*SYSTEMS, EVERYTHING]


def good(text: str, filename: str = "x.yaml") -> System:
    return system_of(text, filename)


def loaded(path: Path) -> System:
    return good(path.read_text(encoding="utf-8"), path.name)


@pytest.mark.parametrize("path", GOOD, ids=lambda path: path.stem)
def test_a_good_file_is_read_without_complaint(path: Path) -> None:
    system, complaints, text = load(path)
    assert system is not None
    assert not complaints
    assert text.startswith("# ")


@pytest.mark.parametrize("path", GOOD, ids=lambda path: path.stem)
def test_both_spellings_lose_nothing(path: Path) -> None:
    system = loaded(path)
    assert good(to_yaml(system)) == system
    assert good(to_text(system), "x.txt") == system
    assert good(to_text(system), "<string>") == system
    assert to_yaml(good(to_text(good(to_yaml(system))), "x.txt")) == to_yaml(system)
    assert to_text(good(to_yaml(system))) == to_text(system)


@pytest.mark.parametrize(
    "words", ["α 1", '"ω₀"; γ', "a (b", "null", "~", "Ω meaning β", "m² − 1", "value = 2", "[α", "#1", "a=b"]
)
def test_words_and_names_of_files_are_kept_letter_by_letter(words: str, tmp_path: Path) -> None:
    """Greek letters are names in the editor's text, an open bracket hides what follows, null is no text in YAML."""
    file = words.replace('"', "'") + ".csv"
    (tmp_path / file).write_text("0, 1\n1, 2\n", encoding="utf-8")
    described = {
        "mbsym": 1, "name": words, "description": words, "source": words,
        "parameters": {"m": {"sign": "positive", "meaning": words, "value": 2}},
        "inputs": {"F": {"meaning": words}},
        "tables": {"f": {"file": file}},
        "bodies": [{"name": "null", "mass": "m", "connection point": ["x", 0, 0], "coordinates": ["x"]}],
        "loads": [{"generalized force": {"x": "F + f(t)"}}],
        "claims": [{"claim": "momentum", "of": "x", "equals": "m*x_dot", "place": words}],
    }  # fmt: skip
    system, complaints = read(json.dumps(described), "x.yaml", tmp_path)
    assert system is not None, list(complaints)
    assert (system.name, system.claims[0].place, system.parameters[0].meaning) == (words, words, words)
    assert read(to_yaml(system), "x.yaml", tmp_path)[0] == system
    assert read(to_text(system), "x.txt", tmp_path)[0] == system


class AsEditorsRead(yaml.SafeLoader):
    """YAML 1.2, as editors with schemas have it: only true and false are words for truth, ``on`` is a text."""


AsEditorsRead.yaml_implicit_resolvers = {
    first: [(tag, pattern) for tag, pattern in found if first in "tTfF" or tag != "tag:yaml.org,2002:bool"]
    for first, found in yaml.SafeLoader.yaml_implicit_resolvers.items()
}


@pytest.mark.parametrize("path", GOOD, ids=lambda path: path.stem)
@pytest.mark.parametrize("rewritten", [False, True])
def test_the_schema_accepts_good_files(path: Path, rewritten: bool) -> None:
    text = to_yaml(loaded(path)) if rewritten else path.read_text(encoding="utf-8")
    jsonschema.Draft202012Validator(json_schema()).validate(yaml.load(text, AsEditorsRead))


@pytest.mark.parametrize("blank", ["", "  "])
@pytest.mark.parametrize(
    "place",
    ["name", "description", "source", "label", "parameters m unit", "parameters m meaning", "latex m", "values m",
     "bodies 0 name", "bodies 0 mass", "bodies 0 attached to", "tables f file", "claims 0 of", "claims 0 place"],
)  # fmt: skip
def test_the_schema_refuses_a_blank_text_as_the_reader_does(place: str, blank: str) -> None:
    described: dict[str, Any] = {
        "mbsym": 1, "name": "p", "parameters": {"m": {"sign": "positive"}}, "motion": {"x": 0}, "values": {"m": 1},
        "bodies": [{"name": "b", "mass": "m", "connection point": ["x", 0, 0], "coordinates": ["x"]}],
        "claims": [{"claim": "momentum", "of": "x", "equals": "m*x_dot"}], "latex": {},
        "tables": {"f": {"columns": [1, 2]}} if place.startswith("tables") else {},
    }  # fmt: skip
    first, *keys = place.split(" ", 2)
    path, holder = [first, *keys], described
    for key in path[:-1]:
        holder = holder[int(key) if key.isdecimal() else key]
    holder[path[-1]] = blank
    system, complaints = read(json.dumps(described), "x.yaml")
    assert system is None
    assert "missing-value" in {one.code for one in complaints}
    schema = jsonschema.Draft202012Validator(json_schema())
    guilty = [[str(part) for part in one.absolute_path] for one in schema.iter_errors(described)]
    assert any(whole and path[: len(whole)] == whole for whole in guilty), guilty


def test_the_schema_is_a_schema_and_refuses_unknown_keys() -> None:
    jsonschema.Draft202012Validator.check_schema(json_schema())
    bad = {"mbsym": 1, "name": "x", "bodies": [{"name": "a", "mas": 1}]}
    assert list(jsonschema.Draft202012Validator(json_schema()).iter_errors(bad))


def test_the_editor_text_of_the_satellite_is_the_same_system() -> None:
    system, complaints, _ = load(Path(__file__).parents[2] / "systems" / "satellite.txt")
    assert not complaints
    assert system == loaded(SYSTEMS[0].parent / "satellite.yaml")


def test_the_satellite_is_the_one_of_the_paper() -> None:
    system = loaded(SYSTEMS[0].parent / "satellite.yaml")
    assert system.coordinates == ("psi", "theta", "phi", "delta", "sigma")
    assert [body.rotation.axes for body in system.bodies] == [(3,), (2, 3, 1), (3, 1), ()]
    assert system.path("point mass") == ("0", "orbital frame", "satellite", "rod", "point mass")
    assert {one.name: one.sign for one in system.parameters}["r"] == "nonnegative"
    assert [one.name for one in system.notation] == ["a", "b", "c", "d", "f", "alpha", "gamma", "p1", "p2"]
    assert not any("gamma > 0" in f"{written(one.left)} {one.relation} 0" for one in system.assumptions)


def test_figure_3_in_other_clothes() -> None:
    """Labels in any case, other brackets, rows without commas, American and British spelling, bodies by number."""
    text = """MECHANICAL SYSTEM = one body # a comment
number of bodies = 1
parameters
  Jx = 1
  Jy = 2
  Jz = 3 ; meaning = "the third; # moment"
body description ( 1 )
  name = body
  previous body number = 0
  body mass: 2
  radius vector of mass centre: {0, 0, 0}
  inertia about: mass centre
  tensor of inertia
"""
    text = text.replace("tensor of inertia\n", "tensor of inertia:\n    Jx 0 0\n    (0, Jy, 0)\n    0, 0, Jz\n")
    text += "  numbers of rotation axes: {2, 3, 1}\n  rotation angles: (psi, theta, phi)\n"
    system = good(text, "figure3.txt")
    assert system.coordinates == ("psi", "theta", "phi")
    assert system.parameters[2].meaning == "the third; # moment"
    inertia = system.bodies[0].inertia
    assert isinstance(inertia, Inertia)
    assert [written(inertia.tensor[index][index]) for index in range(3)] == ["Jx", "Jy", "Jz"]


def test_scalars_are_what_stands_in_the_file() -> None:
    """No 1:30 = 90, no octal, no booleans; numbers are exact."""
    text = "mbsym: 1\nname: no\nparameters: {y: 1e-3, n: 0o7}\nbodies:\n  - {name: on, attached to: 0, mass: 010}\n"
    system, complaints = read(text, "x.yaml")
    assert system is None
    assert [item.code for item in complaints] == ["bad-word", "no-coordinates"]
    text = text.replace("mass: 010", "mass: 010, rotation: {axes: [3], angles: [x]}, mass centre: [y, n, 0]")
    system = good(text.replace("0o7", "0.10"))
    assert system.name == "no"
    assert [rational(one.value) for one in system.parameters] == [Fraction(1, 1000), Fraction(1, 10)]
    assert rational(system.bodies[0].mass) == 10


@pytest.mark.parametrize("path", GOOD, ids=lambda path: path.stem)
def test_the_content_decides_about_the_spelling(path: Path) -> None:
    system = loaded(path)
    assert good(to_yaml(system), "x.txt") == system
    assert good(to_text(system), "x.yaml") == system


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("thetta", "theta"),
        ("tehta", "theta"),
        ("psii", None),
        ("phii", "phi"),
        ("theta2", None),
        ("thetaB", None),
        ("theta", None),
        ("Phi", None),
        ("gama", "gamma"),
        ("beta", None),
    ],
)
def test_slips_of_the_pen_are_no_labels(name: str, meant: str | None) -> None:
    assert slip_of(name, ["theta", "theta1", "thetaA", "phi", "gamma", "omega0"]) == meant


def test_defaults_and_short_forms() -> None:
    text = """mbsym: 1
name: short
parameters: [k, g, P]
bodies:
  - {name: a, mass: 1, rotation: {axes: [3, 0, 0], angles: [-x, 0, 0]}}
loads:
  - spring: {coordinate: x, stiffness: k}
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
  - force: {body: a, point: [0, 0, 0], components: [-P, 0, 0], axes: a}
assumptions: ["-1 < k < 1"]
"""
    system = good(text)
    body, (spring, gravity, force) = system.bodies[0], system.loads
    assert body.attached_to == "0"
    assert body.coordinates == ("x",)
    assert body.rotation.axes == (3,)
    assert isinstance(spring, CoordinateSpring)
    assert rational(spring.rest) == 0
    assert isinstance(gravity, UniformGravity)
    assert written(gravity.acceleration[1]) == "-g"
    assert isinstance(force, PointForce)
    assert force.axes == "a"
    assert [(written(one.left), one.relation, written(one.right)) for one in system.assumptions] == [
        ("-1", "<", "k"),
        ("k", "<", "1"),
    ]


# --- files and texts that cannot be read -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("content", "code"),
    [
        (b"", "empty"),
        (b"\n\n# only a comment\n", "empty"),
        (b"\x00\x01\x02", "unreadable"),
        (b"mbsym: 1\nname: \xff\xfe\n", "not-utf8"),
        (b"a: 1\n" * 1_000_000, "too-large"),
        (b"a" * (MAX_TEXT + 1), "too-large"),
        (b"\x1b[2J", "control-character"),
    ],
)
def test_files_that_are_no_text(tmp_path: Path, content: bytes, code: str) -> None:
    for name in ("x.yaml", "x.txt", "x"):
        path = tmp_path / name
        path.write_bytes(content)
        system, complaints, _ = load(path)
        assert system is None
        assert [item.code for item in complaints] == [code]


@pytest.mark.parametrize(
    ("content", "line", "column"),
    [
        (b"mbsym: 1\nname: \xc3\xa9\xff\n", 2, 8),
        ("mbsym: 1".encode("utf-16-le"), 1, 2),
        (b"mbsym: 1\nname: a\0b", 2, 8),
    ],
)
def test_what_is_no_utf8_has_its_place_and_a_way_out(tmp_path: Path, content: bytes, line: int, column: int) -> None:
    path = tmp_path / "x.yaml"
    path.write_bytes(content)
    _, (complaint,), text = load(path)
    assert complaint.span is not None
    assert (complaint.span.line, complaint.span.column) == (line, column)
    assert complaint.hint == "save it as UTF-8"
    assert render(complaint, text, "x.yaml").startswith(f"x.yaml:{line}:{column}: error")


def test_files_that_are_not_there(tmp_path: Path) -> None:
    for path in (tmp_path / "absent.yaml", tmp_path, Path("a\0b")):
        system, complaints, text = load(path)
        assert (system, text) == (None, "")
        assert [item.code for item in complaints] == ["unreadable"]


HOSTILE = {
    "nested lists": "[" * 90 + "]" * 90,
    "open brackets": "[" * 100_000,
    "nested dashes": "- " * 100_000,
    "nested mappings": "".join(" " * depth + "a:\n" for depth in range(500)),
    "nested questions": "? " * 50_000,
    "laughs": "a: &a [x, x]\n"
    + "".join(f"{c}: &{c} [*{p}, *{p}]\n" for p, c in zip("abcdefgh", "bcdefghi", strict=True)),
    "keys": "".join(f"key{number}: 1\n" for number in range(20_000)),
    "parameters": "mbsym: 1\nparameters:\n" + "".join(f"  p{number}: x\n" for number in range(20_000)),
    "unknown names": "mbsym: 1\nname: x\nbodies:\n" + "- {name: a, mass: nobody}\n" * 5_000,
    "surrogate": "mbsym: 1\nname: \ud800\n",
    "one long line": "name: " + "x" * 200_000,
    "python tag": "!!python/object/apply:os.system ['true']",
    "text": "Mechanical system: x\n" + "Parameters\n" * 20_000,
    "text bodies": "Mechanical system: x\n" + "".join(f"Body description ({n})\n" for n in range(9_000)),
    "text brackets": "Mechanical system: x\nBody description (1)\n  Rotation angles: " + "(" * 100_000,
    "text quotes": 'Mechanical system: "' + '\\"' * 50_000,
    "byte order mark and old line ends": "\ufeffmbsym: 1\rname: x\r",
}


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_texts_end_in_complaints(name: str) -> None:
    for filename in ("x.yaml", "x.txt", "<string>"):
        system, complaints = read(HOSTILE[name], filename)
        assert system is None
        assert complaints.errors
        assert len(complaints.items) <= 201
        assert all(len(render(item, HOSTILE[name], filename)) < 5_000 for item in complaints)


def _sum(names: list[str]) -> str:
    while len(names) > 1:
        names = [f"({first}*{second})" for first, second in zip(names[::2], names[1::2], strict=False)]
    return names[0]


def test_good_but_monstrous_files_are_read_in_bounded_time() -> None:
    """Chains of relations that double their size at each step, and long vectors with their derivatives."""
    chain = "".join(f"  a{n}: a{n + 1}*sqrt(a{n + 1})\n" for n in range(400))
    names = "".join(f"  a{n}: real\n" for n in range(401))
    moved = _sum(["cos(x)", "a1"] * 256)
    text = f"mbsym: 1\nname: x\nparameters:\n{names}relations:\n{chain}values: {{a400: 2}}\nbodies:\n"
    for number in range(4):
        rotation = f"{{axes: [3], angles: [{'0' if number else 'x'}]}}"
        text += f"- {{name: b{number}, attached to: 0, mass: a0, rotation: {rotation},"
        text += f" connection point: [{moved}, {moved}, 0], relative velocity: [{moved}, 0, 0]}}\n"
    system, complaints = read(text, "x.yaml")
    assert system is not None, "a difference that cannot be evaluated (the numbers overflow) is not judged"
    system, complaints = read(
        text.replace("a0*sqrt(a1)", "a1").replace("*sqrt(", "+(").replace("{a400: 2}", "{}"), "x.yaml"
    )
    assert system is None
    assert [item.code for item in complaints] == ["relative-velocity"] * 8


def test_too_many_complaints_are_cut_off() -> None:
    text = "mbsym: 1\nname: x\nbodies:\n" + "- {name: a, mass: nobody}\n" * 90 + "loads:\n" + "- x\n" * 90
    _, complaints = read(text, "x.yaml")
    assert complaints.items[-1].code == "too-many"


TOKENS = [*"[]{}:#\n\t\"'0(),é", "- ", "&a ", "*a", "!!x ", "---\n", "**"]


@cache
def examples() -> list[str]:
    """The good files in both spellings."""
    return [path.read_text(encoding="utf-8") for path in GOOD] + [to_text(loaded(path)) for path in GOOD]


@st.composite
def mutated(draw: st.DrawFn) -> str:
    """A good file with characters, tokens or lines deleted, doubled, exchanged or put in."""
    text = draw(st.sampled_from(examples()))
    for _ in range(draw(st.integers(1, 3))):
        start = draw(st.integers(0, max(0, len(text) - 1)))
        length = draw(st.sampled_from([0, 1, 1, 5, 30]))
        piece = text[start : start + length]
        token = draw(st.sampled_from([*TOKENS, piece, piece + piece, "", draw(st.text(max_size=3))]))
        if draw(st.booleans()):
            text = text[:start] + token + text[start + length :]
        else:
            lines = text.split("\n")
            index = draw(st.integers(0, len(lines) - 1))
            lines[index : index + 1] = draw(st.sampled_from([[], [lines[index]] * 2, [token], [lines[index][2:]]]))
            text = "\n".join(lines)
    return text


@settings(max_examples=250, suppress_health_check=[HealthCheck.too_slow])
@given(mutated(), st.sampled_from(["x.yaml", "x.txt", "<string>"]))
def test_mutations_give_a_system_or_complaints(text: str, filename: str) -> None:
    system, complaints = read(text, filename)
    assert (system is None) == bool(complaints.errors)
    lines = len(text.replace("\r\n", "\n").replace("\r", "\n").split("\n"))
    for item in complaints:
        assert item.span is None or 1 <= item.span.line <= lines
        assert all(line.isprintable() for line in render(item, text, filename).split("\n"))
    if system is not None:
        assert good(to_yaml(system)) == system
        assert good(to_text(system), "x.txt") == system


@settings(max_examples=100)
@given(st.one_of(st.text(max_size=200), st.binary(max_size=200).map(lambda data: data.decode("latin-1"))))
def test_noise_gives_complaints(text: str) -> None:
    for filename in ("x.yaml", "x.txt", "<string>"):
        system, complaints = read(text, filename)
        assert system is None
        assert complaints.errors


# --- rendering -------------------------------------------------------------------------------------------------------


def test_a_complaint_is_rendered_with_its_line() -> None:
    complaint = Complaint("unknown-name", "unknown name 'thetta'", Span(2, 15, 6), "did you mean 'theta'?")
    assert render(complaint, "a\n angles: [psi, thetta]\n", "s.yaml").split("\n") == [
        "s.yaml:2:15: error[unknown-name]: unknown name 'thetta'",
        "   2 |  angles: [psi, thetta]",
        "     |               ^^^^^^",
        "  hint: did you mean 'theta'?",
    ]


def test_rendering_escapes_and_cuts() -> None:
    rendered = render(Complaint("x", "bad \x1b[2J", Span(1, 5_001, 3)), "\x1b" * 5_000 + "abc" + "y" * 5_000, "f\n")
    assert "\x1b" not in rendered
    assert "abc" in rendered
    assert max(map(len, rendered.split("\n"))) < 140
    assert render(Complaint("x", "gone", Span(99, 1)), "one line", "f") == "f:99:1: error[x]: gone"


def test_reading_is_light() -> None:
    """Nothing heavy is imported for reading a file, and a file cannot make us import anything."""
    program = (
        "import sys, mbsym.source; "
        "print([m for m in ('sympy', 'flint', 'numpy', 'scipy', 'jinja2', 'click', 'rich') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_complaints_of_a_kind_are_counted() -> None:
    bodies = "".join(f"- {{name: b{k}, attached to: 0, mass: nobody{k}}}\n" for k in range(100))
    _, complaints = read("mbsym: 1\nname: x\nbodies:\n" + bodies, "x.yaml")
    kinds = [item.code for item in complaints.items]
    assert kinds.count("unknown-name") == MAX_OF_A_KIND
    assert complaints.items[-1].message == f"and {100 - MAX_OF_A_KIND} more of the kind unknown-name"


def test_too_many_bodies_are_one_complaint() -> None:
    """What follows from it, 400 unknown bodies and coordinates, is not said."""
    bodies = "".join(
        f"- {{name: b{k}, attached to: {f'b{k - 1}' if k else 0}, mass: 1, rotation: {{axes: [3], angles: [q{k}]}}}}\n"
        for k in range(400)
    )
    _, complaints = read("mbsym: 1\nname: x\nbodies:\n" + bodies + "motion: {q1: 0, q399: 0}\n", "x.yaml")
    (only,) = complaints.items
    assert only.code == "too-large"
    assert "not 400" in only.message
    assert only.span is not None


@pytest.mark.parametrize(
    "value", ["'" + "@;" * 9_990 + "'", "'" + "é " * 9_000 + "'", "(" * 9_000, "'" + "a b " * 4_000 + "'", "1/" * 9_000]
)
def test_hostile_values_are_refused_in_a_moment(value: str) -> None:
    began = time.process_time()
    system, complaints = read(
        f"mbsym: 1\nname: x\nparameters:\n  p0: {value}\n  p1: 1\nvalues: {{p1: {value}}}\n", "x.yaml"
    )
    assert system is None
    assert len(complaints.items) <= MAX_COMPLAINTS
    assert time.process_time() - began < 2


def test_what_is_shown_moves_no_cursor() -> None:
    assert safe("a\x1b]0;t\x07\u202eb\u200b\x9b\ud800é") == "a\\x1b]0;t\\x07\\u202eb\\u200b\\x9b\\ud800é"
    assert safe("a\tb\nc") == "a b c"
    for name in ("\x1b[31m.yaml", "a\nb.yaml", "x\u2066.yaml"):
        complaint = Complaint("code", "\x1b message", Span(1, 1), "\u202e hint")
        shown = render(complaint, "\x1b line", name)
        assert all(line.isprintable() for line in shown.split("\n"))
        assert shown.count("\n") == 3


@pytest.mark.parametrize(
    ("load", "path", "said"),
    [
        ({"uniform gravity": {"acceleraton": "g"}}, ["loads", 0, "uniform gravity"], "'acceleraton' was unexpected"),
        ({"sprng": {"coordinate": "x"}}, ["loads", 0], "'sprng' was unexpected"),
        ({"spring": {"stiffness": []}}, ["loads", 0, "spring", "stiffness"], "is not of type"),
        ({"damper": {"coordinate": "x"}, "spring": {"coordinate": "x"}}, ["loads", 0], "too many properties"),
    ],
)
def test_a_mistake_in_a_load_is_told_where_it_is(load: object, path: list[object], said: str) -> None:
    """As an editor shows it: at the guilty key, not as a list of all kinds of load."""
    described = {"mbsym": 1, "name": "x", "bodies": [{"name": "b", "mass": 1}], "loads": [load]}
    errors = list(jsonschema.Draft202012Validator(json_schema()).iter_errors(described))
    told = [(list(error.absolute_path), error.message) for error in errors]
    assert any(where == path and said in message for where, message in told), told
    assert not any("any of the given schemas" in message for _, message in told)


def test_the_schema_knows_what_is_new() -> None:
    text = EVERYTHING.read_text(encoding="utf-8")
    described = yaml.safe_load(text)
    described["bodies"][-1] |= {"inertia": {"tensor": [1, 1, 1], "accept": True}, "inertia about": "joint"}
    ends = [{"body": "0", "point": [0, 0, 0]}, {"body": described["bodies"][-1]["name"], "point": [1, 0, 0]}]
    described["loads"] = [{"isotropic damper": {"between": ends, "coefficient": 1}}]
    described["motion"] = {}
    jsonschema.validate(described, json_schema())
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({**described, "loads": [{"isotropic damper": {"coefficient": 1}}]}, json_schema())


def test_an_empty_motion_is_the_rest_of_all_at_zero() -> None:
    text = (
        "mbsym: 1\nname: x\nbodies:\n- {name: a, attached to: 0, mass: 1, rotation: {axes: [3, 1], angles: [p, q]}}\n"
    )
    assert good(text).motion == ()
    rest = good(text + "motion: {}\n")
    assert [(entry.coordinate, rational(entry.value), rational(entry.rate)) for entry in rest.motion] == [
        ("p", 0, 0),
        ("q", 0, 0),
    ]
    assert good(to_text(rest), "x.txt") == rest == good(to_yaml(rest))


def test_what_is_for_people_may_be_any_plain_scalar() -> None:
    """An editor complains about nothing that is read: a name 2024, a body called true, a meaning 1.5."""
    text = """mbsym: 1
name: 2024
source: 1.5
parameters: {m: {sign: positive, meaning: 7}}
bodies: [{name: true, attached to: 0, mass: m, connection point: [x, 0, 0], coordinates: [x]}]
"""
    assert good(text).name == "2024"
    jsonschema.validate(yaml.safe_load(text), json_schema())
