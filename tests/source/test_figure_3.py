"""The paper's own form, as printed: no body names, tensors about O_k, parameters declared by their use."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from conftest import system_of

from mbsym.expressions.tree import text
from mbsym.source.document import load, read
from mbsym.source.labels import BODY, HEADER, SECTIONS
from mbsym_cli.explain import explanations

ROOT = Path(__file__).parents[2]
FORM = ROOT / "tests" / "published" / "figure-3.txt"


def test_the_form_is_the_system_of_the_paper() -> None:
    form, complaints, _ = load(FORM)
    paper, _, _ = load(ROOT / "systems" / "satellite.yaml")
    assert form is not None
    assert paper is not None
    assert [one.code for one in complaints.items] == ["declared-by-use"]
    assert [body.name for body in form.bodies] == ["Body 1", "Body 2", "Body 3", "Body 4"]
    assert {one.name for one in form.parameters} == {one.name for one in paper.parameters}
    assert {one.sign for one in form.parameters} == {"real"}
    numbers = {body.name: str(number) for number, body in enumerate(paper.bodies, start=1)}
    for ours, theirs in zip(form.bodies, paper.bodies, strict=True):
        attached = numbers.get(theirs.attached_to, theirs.attached_to)
        assert ours.attached_to in (attached, f"Body {attached}")
        for field in ("rotation", "connection_point", "mass_centre", "mass", "coordinates"):
            assert str(getattr(ours, field)) == str(getattr(theirs, field)), (ours.name, field)
        assert (ours.inertia is None) == (theirs.inertia is None)
        if ours.inertia is not None and theirs.inertia is not None:
            assert str(replace(ours.inertia, span=None)) == str(replace(theirs.inertia, span=None))


def test_the_warning_lists_what_was_declared_by_use() -> None:
    _, complaints, _ = load(FORM)
    (warning,) = complaints.items
    assert warning.severity == "warning"
    for name in ("omega0", "R", "M2", "Jx", "Jy", "Jz", "m", "r", "l", "m0", "nu"):
        assert name in warning.message.replace(",", " ").split()


@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        (
            "\nPrescribed motions",
            "\nParameters\n  R = positive\nPrescribed motions",
            "unknown-name",
        ),  # then all are wanted
        ("(0, l/2, 0)", "(0, l/2*thetta, 0)", "unknown-name"),  # a slip for a coordinate is no parameter
        ("Previous body number\n1", "Previous body number\nBody mass", "missing-value"),  # a label is no value
        ("| 0 | Jy | 0 |", "| 0 | Jy |", "wrong-shape"),
        ("Body mass\nM2", "Body mas\nM2", "unknown-key"),
    ],
)
def test_what_is_wrong_in_the_form_is_still_found(old: str, new: str, code: str) -> None:
    text = FORM.read_text(encoding="utf-8")
    assert old in text
    system, complaints = read(text.replace(old, new, 1), "form.txt")
    assert system is None
    assert code in {one.code for one in complaints.items if one.severity == "error"}


def test_yaml_declares_its_parameters() -> None:
    body = "{name: bob, attached to: 0, rotation: {axes: [3], angles: [phi]}, mass: m}"
    text = f"mbsym: 1\nname: P\nbodies:\n  - {body}\n"
    system, complaints = read(text, "p.yaml")
    assert system is None
    assert [one.code for one in complaints.items] == ["unknown-name"]


BY_HAND = """
Mechanical system: Pendulum in a carriage
Number of bodies 1

Prescribed motions
  χ = ω₀

Body description (1)
  Previous body number\t0
  Body mass M2
  Radius vector of connection point\t(0 l/2 0)
  Radius vector of mass center (0 -l 0)
  Numbers of rotation axes\t{3 0 0}
  Rotation angles {ψ - χ, 0, 0}
  Tensor of inertia
    Jx\t0\t0
    0\tJy\t0
    0\t0\tJz
  Generalized coordinates {ψ}
"""


def test_it_is_read_as_people_fill_it_in() -> None:
    """Greek letters, no colons, vectors with spaces: the same as in the letters of descriptions."""
    found, complaints = read(BY_HAND, "form.txt")
    assert [one.code for one in complaints.items] == ["declared-by-use"]
    assert found is not None
    latin = BY_HAND.replace("χ", "chi").replace("ω₀", "omega0").replace("ψ", "psi")
    for words in ("0 l/2 0", "0 -l 0", "3 0 0"):
        latin = latin.replace(words, ", ".join(words.split()))
    plain = system_of(latin, "form.txt")
    assert str(replace(found.bodies[0], span=None)) == str(replace(plain.bodies[0], span=None))
    assert found.coordinates == ("psi",)
    assert found.parameter_names == plain.parameter_names
    assert {"omega0", "M2", "l", "Jx"} <= {*found.parameter_names}
    assert [text(x) for x in found.bodies[0].connection_point] == ["0", "l/2", "0"]
    assert [text(x) for x in found.bodies[0].rotation.angles] == ["psi - chi"]


#: As the printed form has it: fields without brackets, and fields that nobody fills in.
WITHOUT_BRACKETS = BY_HAND.translate({ord(x): None for x in "(){}"}).replace(
    "Body description 1", "Body description (1)"
)


@pytest.mark.parametrize("commas", [False, True])
def test_brackets_may_be_left_out(commas: bool) -> None:
    """A vector, axes, angles, one coordinate or several; the tensor has none anyway."""
    written = WITHOUT_BRACKETS
    for words in ("0 l/2 0", "0 -l 0", "3 0 0") if commas else ():
        written = written.replace(words, ", ".join(words.split()))
    written = written.replace("ψ - χ, 0, 0", "ψ-χ 0 0") if not commas else written
    found, complaints = read(written, "form.txt")
    plain, _ = read(BY_HAND, "form.txt")
    assert [one.code for one in complaints.items] == ["declared-by-use"]
    assert found is not None
    assert plain is not None
    assert str(replace(found.bodies[0], span=None)) == str(replace(plain.bodies[0], span=None))
    assert found.coordinates == ("psi",)


def test_an_empty_field_is_one_that_is_left_out() -> None:
    """Zeros, no turn; two coordinates are two words."""
    form = """Mechanical system: P
Body description (1)
Previous body number 0
Body mass m
Radius vector of mass center
Numbers of rotation axes
Rotation angles
Radius vector of connection point x y 0
Generalized coordinates x y
"""
    moving = system_of(form, "form.txt")
    assert moving.coordinates == ("x", "y")
    assert [text(x) for x in moving.bodies[0].mass_centre] == ["0", "0", "0"]
    assert not moving.bodies[0].rotation.angles


def test_a_slip_is_one_complaint_at_its_place_and_speaks_of_labels() -> None:
    """In the column of the file, whatever the letters before it are called."""
    wrong = BY_HAND.replace("{ψ - χ, 0, 0}", "{ψ - χ, thetta(ψ), 0}").replace("Body mass M2\n", "\n")
    found, complaints = read(wrong.replace("Numbers of rotation", "Number of rotation"), "form.txt")
    assert found is None
    errors = [(one.code, one.message) for one in complaints.items if one.severity == "error"]
    assert ("missing-key", "body 'Body 1' has no 'body mass'") in errors
    assert ("unknown-key", "unknown label 'Number of rotation axes' in Body description (1)") in errors
    (slip,) = [one for one in complaints.items if "thetta" in one.message]
    line = wrong.split("\n")[slip.span.line - 1] if slip.span else ""
    assert slip.span is not None
    assert line[slip.span.column - 1 :].startswith("thetta")
    assert len(errors) == 3


def test_it_is_read_as_printed_signs_have_it() -> None:
    """Minus, dots of products, lowered and raised digits, as they are copied from a page."""
    printed = (
        BY_HAND.replace("(0 l/2 0)", "(0, 3·l²/l\u2081, 0)")
        .replace("(0 -l 0)", "(0 \u2212l 0)")
        .replace("M2", "M\u2082")
    )
    system = system_of(printed, "form.txt")
    (body,) = system.bodies
    assert [text(x) for x in body.connection_point] == ["0", "3*l**2/l1", "0"]
    assert [text(x) for x in body.mass_centre] == ["0", "-l", "0"]
    assert text(body.mass) == "M2"


def test_what_is_a_mass_or_in_a_mass_centre_is_no_forgotten_coordinate() -> None:
    """Body without a list of coordinates: l stands in its mass centre and is a parameter, R is asked for."""
    form = BY_HAND.replace("  Generalized coordinates {ψ}\n", "").replace("{ψ - χ", "{ψ")
    system, complaints = read(form, "form.txt")
    assert system is not None, [item.message for item in complaints.items]
    assert "l" in system.parameter_names
    assert system.coordinates == ("psi",)
    _, complaints = read(form.replace("(0 l/2 0)", "(0 R 0)"), "form.txt")
    (error,) = [item for item in complaints.items if item.severity == "error"]
    assert "R" in error.message
    assert error.hint is not None
    assert "'Generalized coordinates: psi, R'" in error.hint


def test_a_product_that_is_written_together_is_asked_about() -> None:
    _, complaints = read(BY_HAND.replace("Jx\t", "M2l**2\t"), "form.txt")
    (warning,) = complaints.items
    assert warning.hint is not None
    assert "M2*l" in warning.hint
    _, complaints = read(BY_HAND, "form.txt")
    assert "product" not in str(complaints.items[0].hint)


def test_explain_knows_the_labels() -> None:
    known = explanations("plain text")[0].casefold()
    for label in (*HEADER, *SECTIONS, *BODY):
        assert label in known or label == "number of bodies"
        assert explanations(label) or label == "number of bodies", label
    assert explanations("vector of relative linear velocity") == explanations("relative velocity")
