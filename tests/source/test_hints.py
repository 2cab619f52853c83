"""Hints are advice that works: a wrong description, mended by doing literally what the hint says, is right."""

from __future__ import annotations

import re

import pytest

from mbsym.expressions.place import Complaint
from mbsym.source import read

#: A sound description; each case replaces one line of it by a wrong one.
SOUND = {
    "mbsym": "mbsym: 1",
    "name": "name: Two links",
    "parameters": "parameters: {m: positive, l: positive, J: positive, k: positive, c: positive, g: positive}",
    "prescribed": "prescribed: {chi: {rate: 2}}",
    "bodies": "bodies:",
    "upper": "  - name: upper",
    "attached": "    attached to: 0",
    "rotation": "    rotation: {axes: [3, 1], angles: [theta, psi]}",
    "centre": "    mass centre: [0, -l, 0]",
    "mass": "    mass: m",
    "about": "    inertia about: mass centre",
    "inertia": "    inertia: [J, J, J]",
    "coordinates": "    coordinates: [theta, psi]",
    "lower": "  - name: lower",
    "on": "    attached to: upper",
    "point": "    connection point: [x*cos(chi), -2*l, x*sin(chi)]",
    "lower mass": "    mass: m",
    "lower coordinates": "    coordinates: [x]",
    "loads": "loads:",
    "gravity": "  - uniform gravity: {vector: [0, -g, 0]}",
    "spring": "  - spring: {coordinate: x, stiffness: k}",
    "damper": "  - damper: {coordinate: x, coefficient: c}",
    "force": "  - generalized force: {theta: -c*theta_dot}",
    "motion": "motion: {theta: 0, psi: 0, x: 0}",
    "values": "values: {m: 1, l: 2, J: 30, k: 4, c: 5, g: 9.81}",
    "initial": "initial: {theta: pi/6}",
}

#: (line of the sound description, what stands there instead)
WRONG = [
    ("inertia", "    inertia: diag(J, J, J)"),
    ("inertia", "    inertia: (J, J, J)"),
    ("inertia", "    inertia: J, 2*J, 2*J"),
    ("inertia", "    inertia: J"),
    ("inertia", "    inertia: [J, J]"),
    ("inertia", "    inertia: [3, 1, 1]"),
    ("inertia", "    inertia: [[2, 1.2, 0], [1.2, 2, 0], [0, 0, 1]]"),
    ("inertia", "    inertia: {tensr: [J, J, J]}"),
    ("about", "    inertia about: mass"),
    ("about", "    inertia about: joints"),
    ("about", ""),
    ("mass", "    mass: 2 m"),
    ("mass", "    mass: 2m"),
    ("mass", "    mass: 0,5"),
    ("mass", "    mass: 2 kg"),
    ("mass", "    mass: m·l"),
    ("mass", "    mass: m(1 + l)"),
    ("mass", "    mass: mm"),
    ("mass", "    mass: 1_000"),
    ("mass", ""),
    ("mass", "    mas: m"),
    ("centre", "    mass centre: (0, -l, 0)"),
    ("centre", "    mass centre: vector(0, -l, 0)"),
    ("centre", "    mass centre: 0, -l, 0"),
    ("centre", "    mass centre: [0, -l]"),
    ("centre", "    mass centre: [0 -l, 0]"),
    ("centre", "    mass center of gravity: [0, -l, 0]"),
    ("rotation", "    rotation: {axes: [z, x], angles: [theta, psi]}"),
    ("rotation", "    rotation: {axes: [3, 1], angles: [thetta, psi]}"),
    ("rotation", "    rotation: {axis: [3, 1], angles: [theta, psi]}"),
    ("rotation", "    rotation: {axes: [3, 1], angles: [theta psi]}"),
    ("rotation", "    rotation: {axes: [3, 1], angles: [θ, psi]}"),
    ("rotation", "    rotation: {axes: [3, 1, 2], angles: [theta, psi, 30 deg]}"),
    ("rotation", "    rotation: {axes: [3, 1, 2], angles: [theta, psi, phi]}"),
    ("coordinates", "    coordinates: theta, psi"),
    ("coordinates", "    coordinates: (theta, psi)"),
    ("coordinates", "    coordinates: [theta]"),
    ("coordinates", "    coordinates: theta"),
    ("on", "    attached to: uper"),
    ("on", ""),
    ("point", "    connection point: [x*cosine(chi), -2*l, x*sin(chi)]"),
    ("point", "    connection point: [x*cs(chi), -2*l, x*sin(chi)]"),
    ("point", "    connection point: [x*cos chi, -2*l, x*sin(chi)]"),
    ("point", "    connection point: [x*cos(chi), -2*L, x*sin(chi)]"),
    ("point", "    connection point: [x, -2*l, y]"),
    ("lower mass", "    mass: m\n    relative velocity: [x_dot, 0, 0]"),
    ("gravity", "  - uniform gravity: [0, -g, 0]"),
    ("gravity", "  - uniform gravity: 9.81"),
    ("gravity", "  - uniform gravity: g"),
    ("gravity", "  - uniform gravty: {vector: [0, -g, 0]}"),
    ("gravity", "  - constant gravity: {vector: [0, -g, 0]}"),
    ("gravity", "  - uniform gravity: {acceleration: g, direction: [0, -2, 0]}"),
    ("spring", "  - spring: {coordinate: x, stifness: k}"),
    ("spring", "  - torsion spring: {coordinate: x, stiffness: k}"),
    ("damper", "  - dashpot: {coordinate: x, coefficient: c}"),
    ("damper", "  - damper: {coordinate: x, coeff: c}"),
    ("damper", "  - damper: {coordinate: X, coefficient: c}"),
    ("force", "  - generalized force: {thet: -c*theta_dot}"),
    ("force", "  - generalized force: {theta: -c*thetadot}"),
    ("force", "  - generalized force: {theta: c*sqrt theta}"),
    ("force", "  - generalized force: {theta: c*ln(2)}"),
    ("force", "  - generalised forces: {theta: -c*theta_dot}"),
    ("motion", "motion:"),
    ("motion", "motion: {theta: 0, psy: 0}"),
    ("values", "values: {m: 1, M: 3}"),
    ("values", "values:"),
    ("initial", "initial: {tehta: 1}"),
    ("parameters", "parameters: {m: positiv, l: positive, J: positive, k: positive, c: positive, g: positive}"),
    ("parameters", "parameters: {m: {signe: positive}, l: real, J: positive, k: positive, c: real, g: positive}"),
    ("parameters", "parameters: {m: 1,  l: positive, J: positive, k: positive, g: positive}"),
    ("mbsym", ""),
]


#: Here the moments are too small about the joint (3 < 1*2^2), and all right about the mass centre.
JOINT = ("values: {m: 1, l: 2, J: 3, k: 4, c: 5, g: 9.81}", "    inertia about: joint")


def described(key: str = "", wrong: str = "") -> str:
    lines = [wrong if name == key else line for name, line in SOUND.items()]
    return "\n".join(line for line in lines if line) + "\n"


def followed(text: str, complaint: Complaint) -> str:
    """The text after doing what the hint says, in the place of the complaint, as someone without any idea would."""
    hint, span, lines = complaint.hint or "", complaint.span, text.split("\n")
    declared = re.search(r"declare it under 'parameters'", hint)
    if span is None:
        raise AssertionError(f"a complaint without a place: {complaint}")
    line = lines[span.line - 1]
    before, after = line[: span.column - 1], line[span.column - 1 + span.length :]
    code = complaint.code

    def replaced(new: str) -> str:
        blank = " " if before.endswith(":") else ""
        lines[span.line - 1] = before + blank + new + after
        return "\n".join(lines)

    if meant := re.match(r"did you mean '([^']+)'(?: or '[^']+')?\?", hint):
        return replaced(meant.group(1))
    if listed := re.search(r"(add|write) '(coordinates: \[[^\]]*\])' (?:to|in) this body", hint):
        number = span.line - 1
        while not lines[number].startswith("  - "):
            number -= 1
        if listed.group(1) == "write":
            own = next(k for k in range(number, len(lines)) if lines[k].startswith("    coordinates"))
            lines[own] = "    " + listed.group(2)
        else:
            lines.insert(number + 1, "    " + listed.group(2))
        return "\n".join(lines)
    if hint.startswith("no units beside numbers: write numbers only") and "kg" in complaint.message:
        lines[span.line - 1] = re.sub(r"(\d+) kg", r"\1", line)
        return "\n".join(lines)
    if factor := re.match(r"write (\w+)\*\(\.\.\.\) for a product", hint):
        lines[span.line - 1] = line.replace(f"{factor.group(1)}(", f"{factor.group(1)}*(")
        return "\n".join(lines)
    if product := re.search(r"(?:write|for a product write) (\S+)\*(\S+)(?: for a product)?$", hint):
        first, second = map(re.escape, product.groups())
        mended = re.sub(rf"{first}\s*{second}", product.group().split(" ")[1 if hint.startswith("write") else 4], line)
        lines[span.line - 1] = mended
        return "\n".join(lines)
    if angle := re.search(r"write (\d+)\*pi/180", hint):
        lines[span.line - 1] = re.sub(rf"{angle.group(1)}\s*\w+", f"{angle.group(1)}*pi/180", line, count=1)
        return "\n".join(lines)
    if digits := re.match(r"digits stand together: write (\d+)", hint):
        lines[span.line - 1] = re.sub(r"\d+_\d+", digits.group(1), line)
        return "\n".join(lines)
    if decimal := re.match(r"numbers have a decimal point: write (\S+)", hint):
        lines[span.line - 1] = re.sub(r"\d+,\d+", decimal.group(1), line)
        return "\n".join(lines)
    if comma := re.match(r"is a comma missing: (.+)\?", hint):
        first, second = (part.strip() for part in comma.group(1).split(",", 1))
        lines[span.line - 1] = re.sub(rf"{re.escape(first)}\s+{re.escape(second)}", comma.group(1), line)
        return "\n".join(lines)
    if example := re.search(r"for example (\[.*\])", hint):
        return replaced(example.group(1))
    if derivative := re.match(r"the derivative is (.+)", hint):
        return replaced(derivative.group(1))
    if hint.startswith("leave the key out"):
        del lines[span.line - 1]
        return "\n".join(lines)
    if begin := re.match(r"begin the file with '([^']+)'", hint):
        return begin.group(1) + "\n" + text
    if beside := re.match(r"'(inertia about: joint)'", hint):
        lines.insert(span.line, "    " + beside.group(1))
        return "\n".join(lines)
    if code == "missing-key" and (key := re.match(r"write (\w+: \S+)", hint)):
        lines.insert(span.line, "    " + key.group(1))
        return "\n".join(lines)
    if hint.startswith("an earlier body, or 0"):
        lines.insert(span.line, "    attached to: 0")
        return "\n".join(lines)
    if velocity := re.match(r"a velocity is written (\w+)", hint):
        lines[span.line - 1] = line.replace("theta'", velocity.group(1))
        return "\n".join(lines)
    if hint == "for components of any length use 'vector'":
        lines[span.line - 1] = "  - uniform gravity: {vector: [0, -2, 0]}"
        return "\n".join(lines)
    if "inertia about: mass centre" in hint:
        return text.replace("inertia about: joint", "inertia about: mass centre")
    if power := re.match(r"write (\S+) for a (?:power|product)", hint):
        return replaced(power.group(1))
    if call := re.match(r"write (\w+)\((\w+)\)$", hint):
        lines[span.line - 1] = line.replace(f"{call.group(1)} {call.group(2)}", f"{call.group(1)}({call.group(2)})")
        return "\n".join(lines)
    if number := re.match(r"write (\d): the axes", hint):
        return replaced(number.group(1))
    if tensor := re.search(r"write (\{tensor: .*, accept: true\})", hint):
        return replaced(tensor.group(1))
    if letters := re.search(r"names are Latin letters, digits and _: write (\w+)$", hint):
        return replaced(letters.group(1))
    if plain := re.match(r"write (\[.*\]|\{.*?\}|\w+)", hint):
        return replaced(plain.group(1))
    if one := re.match(r"(?:write a number or )?one of: ([^,]+)", hint):
        return replaced(one.group(1))
    if declared:
        name = re.match(r"unknown name '(\w+)'", complaint.message)
        assert name is not None
        return text.replace("parameters: {", f"parameters: {{{name.group(1)}: positive, ", 1)
    if keys := re.match(r"the keys are: ([^,]+)", hint):
        raise AssertionError(f"{complaint.message}: a guess is wanted instead of all keys ({keys.group(1)}, ...)")
    raise AssertionError(f"nobody can follow this hint: {complaint.code}: {complaint.message} | {hint}")


def test_the_sound_description_is_sound():
    system, complaints = read(described())
    assert system is not None
    assert not complaints.items


def test_the_hint_to_the_mass_centre_is_followed():
    text = described("values", JOINT[0]).replace("    inertia about: mass centre", JOINT[1])
    (refused,) = read(text)[1].errors
    assert refused.code == "bad-inertia"
    assert read(followed(text, refused))[0] is not None


@pytest.mark.parametrize(("written", "meant"), [("1.5708", "pi/2"), ("-2.35619", "-3*pi/4"), ("1.047197551", "pi/3")])
def test_a_rounded_angle_becomes_exact(written: str, meant: str) -> None:
    text = described("rotation", f"    rotation: {{axes: [3, 1, 2], angles: [theta, psi, {written}]}}")
    system, complaints = read(text)
    (told,) = complaints.items
    assert system is not None
    assert told.code == "rounded-angle"
    assert f"write {meant}:" in (told.hint or "")
    assert told.span is not None
    lines = text.split("\n")
    line = lines[told.span.line - 1]
    assert line[told.span.column - 1 :][: told.span.length] == written
    lines[told.span.line - 1] = line.replace(written, meant)
    assert not read("\n".join(lines))[1].items


@pytest.mark.parametrize(("key", "wrong"), WRONG, ids=[f"{key}: {wrong.strip()[:60]}" for key, wrong in WRONG])
def test_following_the_hints_leads_to_a_valid_description(key: str, wrong: str) -> None:
    """The first hint is followed, the file is read again, and so on: each step takes an error away and adds none."""
    text = described(key, wrong)
    system, complaints = read(text)
    assert system is None
    for _ in range(4):
        errors = [one for one in complaints.sorted() if one.severity == "error"]
        if not errors:
            break
        hinted = [one for one in errors if one.hint]
        assert hinted, [one.message for one in errors]
        text = followed(text, hinted[0])
        system, complaints = read(text)
        assert len(complaints.errors) < len(errors), (text, [one.message for one in complaints.errors])
    assert system is not None, [one.message for one in complaints.errors]


def test_a_generalized_force_written_as_other_loads_are() -> None:
    """``{coordinate: theta, equals: Q}`` is one mistake; the hint says what stands there instead."""
    _, complaints = read(described("force", "  - generalized force: {coordinate: theta, equals: -c*theta_dot}"))
    (only,) = complaints
    assert (only.code, only.hint) == (
        "unknown-key",
        "the key is the coordinate itself: write theta: and then the force",
    )
    system, complaints = read(described("force", "  - generalized force: {theta: -c*theta_dot}"))
    assert system is not None
    assert not list(complaints)


@pytest.mark.parametrize("kind", ["torque", "force"])
@pytest.mark.parametrize("key", ["torque", "moment", "components", "value"])
def test_a_torque_on_a_coordinate_is_one_mistake(kind: str, key: str) -> None:
    _, complaints = read(described("force", f"  - {kind}: {{coordinate: theta, {key}: -c*theta_dot}}"))
    (only,) = complaints
    assert (only.code, only.hint) == ("unknown-key", f"write '-{SOUND['force'].partition('-')[2]}'")


def test_what_else_is_wrong_with_a_torque_is_told() -> None:
    _, complaints = read(described("force", "  - torque: {coordinate: y, body: lower, components: [0, 0, c]}"))
    assert {one.code for one in complaints} == {"unknown-key", "missing-key"}
