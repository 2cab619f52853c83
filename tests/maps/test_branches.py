"""``mbsym equilibria --vary``: normal forms of bifurcations, pendulums, the orbital gyrostat; values known by hand."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from fractions import Fraction
from functools import cache
from math import cos, pi
from pathlib import Path
from typing import Any

import pytest
from conftest import SHIPPED, filed, invoked
from flint import fmpq
from jsonschema import Draft202012Validator

import mbsym
import mbsym.maps.branches as module
from mbsym.algebra.plane.numbers import enclosure
from mbsym.maps.branches import branches
from mbsym.maps.branches_events import Event, Named
from mbsym.maps.branches_result import Branches, Doubt
from mbsym.maps.section import Axis
from mbsym.mechanics.rest import given_values
from mbsym.report.maps.words import remark_words
from mbsym.report.messages import messages
from mbsym.report.schemas import schema
from mbsym.studies.equilibria.branches import rows
from tests.report.readers import read_latex

#: A point of mass 1 with x'' = f(x, p), and perhaps y'' = g.
BALL = """mbsym: 1
name: ball
parameters:
  p: {{sign: real, meaning: parameter}}
bodies:
  - name: ball
    attached to: 0
    connection point: [x, {second}, 0]
    coordinates: [{names}]
    mass: 1
loads:
  - generalized force: {{{forces}}}
"""

#: theta from the downward vertical, in a plane that turns with the rate Omega; tilt: gravity has a part across.
HOOP = """mbsym: 1
name: hoop
parameters: {{m: {{sign: positive}}, l: {{sign: positive}}, g: {{sign: positive}}, Omega: {{sign: real}}}}
prescribed: {{chi: Omega}}
bodies:
  - {{name: frame, attached to: 0, rotation: {{axes: [3], angles: [chi]}}, mass: 0}}
  - {{name: rod, attached to: frame, rotation: {{axes: [1], angles: [theta]}}, mass centre: [0, 0, -l], mass: m}}
loads:
  - uniform gravity: {{vector: [0, 0, -g]}}
  - generalized force: {{theta: {torque}}}
values: {{m: 1, l: 2, g: 8}}
"""


def ball(folder: Path, f: str, g: str = "") -> Path:
    forces = f'x: "{f}"' + (f', y: "{g}"' if g else "")
    return filed(folder / "ball.yaml", BALL.format(second="y" if g else "0", names="x, y" if g else "x", forces=forces))


def found(path: Path, name: str, low: str, high: str, **given: str) -> Branches:
    system = mbsym.load(path, ()).system
    values = given_values(system, {key: Fraction(x) for key, x in given.items()})
    return branches(system, Axis(name, Fraction(low), Fraction(high)), values)


def told(one: Branches) -> list[tuple[float, tuple[Event, ...]]]:
    happening = [x for x in one.criticals if one.happens(x)]
    return [(round(float(enclosure(x.sample).mid()), 9), one.critical(x).events) for x in happening]


def counts(one: Branches) -> list[tuple[int, int]]:
    return [(x.counted.count, x.counted.stable) for x, _ in one.spans() if x.counted is not None]


#: f, where something happens in -1 <= p <= 1, what, and (equilibria, stable) from left to right.
NORMAL_FORMS = {
    "p - x**2": ([(0.0, (Event.FOLD,))], [(0, 0), (2, 1)]),
    "p*x - x**2": ([(0.0, (Event.TRANSCRITICAL,))], [(2, 1), (2, 1)]),
    "p*x - x**3": ([(0.0, (Event.PITCHFORK,))], [(1, 1), (3, 2)]),
    "p*x + x**3": ([(0.0, (Event.PITCHFORK,))], [(3, 1), (1, 0)]),
    "p - x**3": ([(0.0, (Event.STEEP,))], [(1, 1), (1, 1)]),
    "x**2 + p**2": ([(0.0, (Event.ISOLATED,))], [(0, 0), (0, 0)]),
    "p - x**4": ([(0.0, (Event.DEGENERATE,))], [(0, 0), (2, 1)]),
    # 4 p^3 = 27/100: the discriminant of p x - x^3 + 1/10
    "p*x - x**3 + 1/10": ([(round((27 / 400) ** (1 / 3), 9), (Event.FOLD,))], [(1, 1), (3, 2)]),
    # x = 1/p and x = +-1/sqrt(p) come from infinity
    "p*x - 1": ([(0.0, ())], [(1, 1), (1, 0)]),
    "p*x**2 - 1": ([(0.0, ())], [(0, 0), (2, 1)]),
    # every x is an equilibrium at p = 0
    "p*x": ([(0.0, (Event.CONTINUUM,))], [(1, 1), (1, 0)]),
    # a damper whose coefficient changes its sign
    "-x - p*x_dot": ([(0.0, ())], [(1, 0), (1, 1)]),
}


@pytest.mark.parametrize("f", NORMAL_FORMS)
def test_normal_forms_are_named_and_counted(f: str, tmp_path: Path) -> None:
    there = found(ball(tmp_path, f), "p", "-1", "1")
    assert (told(there), counts(there)) == NORMAL_FORMS[f]
    assert there.proved
    assert all(there.critical(one).balance is not False for one in there.criticals)


def test_two_unfoldings_at_once_are_not_named(tmp_path: Path) -> None:
    there = found(ball(tmp_path, "p*x - x**3", "p*y - y**3"), "p", "-1", "1")
    assert told(there) == [(0.0, (Event.DEGENERATE,))]
    assert counts(there) == [(1, 1), (9, 4)]


def test_circulatory_forces_make_flutter_without_a_bifurcation(tmp_path: Path) -> None:
    # s^4 + 3 s^2 + 2 + p^2 has double roots at p = +-1/2
    there = found(ball(tmp_path, "-x - p*y", "p*x - 2*y"), "p", "-1", "1")
    assert told(there) == [(-0.5, ()), (0.5, ())]
    assert counts(there) == [(1, 0), (1, 1), (1, 0)]  # exactly linear: simple pairs between, and nothing is open
    assert not any(x.word.open for x in map(there.verdict, there.pieces))


@pytest.mark.parametrize(
    ("f", "g", "happens", "counted"),
    [
        # the imaginary roots of x are those of y only where its damper changes sign
        ("-x", "-y - y**3 - p*y_dot", [(0.0, ())], [(1, 0), (1, 1)]),
        # s^2 (s^2 + 1 + p) at y = 0: unstable below p = -1, where no equilibrium is singular
        ("-y_dot", "x_dot - p*y - y**3", [(-1.0, ()), (0.0, (Event.PITCHFORK,))], [(3, 2), (3, 3), (1, 1)]),
        # nothing resists x but the damper
        ("-p*x_dot", "-y", [(0.0, ())], [(1, 0), (1, 1)]),
    ],
)
def test_changes_of_stability_where_no_equilibrium_is_singular(
    f: str, g: str, happens: list[Any], counted: list[tuple[int, int]], tmp_path: Path
) -> None:
    there = found(ball(tmp_path, f, g), "p", "-3", "1")
    assert (told(there), counts(there)) == (happens, counted)


def test_friction_of_higher_order_that_may_drive_proves_nothing_along_a_branch(tmp_path: Path) -> None:
    """x'' = -x - p x'^3: stable for p >= 0, unstable for p < 0."""
    there = found(ball(tmp_path, "-x - p*x_dot**3"), "p", "-1", "2")
    assert not any(piece.throughout for piece in there.pieces)


def test_a_double_root_over_the_whole_interval_is_no_proof(tmp_path: Path) -> None:
    there = found(ball(tmp_path, "x**2*(x - p)"), "p", "-1", "1")
    assert not there.proved
    assert [one.doubt for one in there.remarks] == [Doubt.THROUGHOUT]
    assert not any(piece.throughout for piece in there.pieces)


def test_a_parameter_in_an_angle_is_told_and_no_set_of_singular_equilibria(tmp_path: Path) -> None:
    """x^2 = sin p - 1/2 folds at p = pi/6 alone, which is not solved; trying finds it to a thousandth of [-1, 1]."""
    there = found(ball(tmp_path, "sin(p) - 1/2 - x**2"), "p", "-1", "1")
    assert not there.proved
    assert counts(there) == [(0, 0), (2, 1)]
    ((at, _),) = told(there)
    assert at == pytest.approx(pi / 6, abs=2 / 1000)
    assert [x[1] for x in rows(there)] == ["0, not proved", "not counted", "2, not proved"]
    (remark,) = there.remarks
    assert remark.doubt is Doubt.UNFINISHED
    assert "root or a function" in remark.about


def test_a_rotating_pendulum_splits_at_the_rate_that_gravity_allows(tmp_path: Path) -> None:
    path = filed(tmp_path / "hoop.yaml", HOOP.format(torque="0"))
    there = found(path, "Omega", "0", "5")  # Omega^2 = g/l = 4
    assert told(there) == [(2.0, (Event.PITCHFORK,))]
    assert there.criticals[0].sample == fmpq(2)
    assert counts(there) == [(2, 1), (4, 2)]
    assert all(piece.throughout for piece in there.pieces)
    # cos(theta) = g/(l Omega^2) on the branches that split off, at all points that are drawn
    inclined = [x for x in there.pieces if x.interval == 1 and abs(x.values[0][0]) not in (0.0, pytest.approx(3.14159))]
    tilted = [x for x in inclined if abs(x.values[-1][0]) < 3]
    assert len(tilted) == 2
    for piece in tilted:
        for p, (theta,) in zip(piece.parameter, piece.values, strict=True):
            assert cos(theta) == pytest.approx(4 / p**2, abs=1e-9)


def test_an_imperfect_pitchfork_is_a_fold(tmp_path: Path) -> None:
    path = filed(tmp_path / "hoop.yaml", HOOP.format(torque="m*l*g*cos(theta)/10"))
    # w sin t cos t - sin t + a cos t = 0, w = Omega^2/4, a = 1/10: w = 1/cos t - a/sin t is extreme where tan^3 t = -a,
    # and w = (1 + a^(2/3))^(3/2) there
    expected = 2 * (1 + 10 ** (-2 / 3)) ** 0.75
    there = found(path, "Omega", "0", "5")
    assert told(there) == [(pytest.approx(expected, abs=1e-8), (Event.FOLD,))]
    assert counts(there) == [(2, 1), (4, 2)]


def test_a_torque_beyond_that_of_gravity_leaves_no_equilibrium(tmp_path: Path) -> None:
    path = tmp_path / "torque.yaml"
    text = HOOP.format(torque="Q").replace("Omega: {sign: real}", "Omega: {sign: real}, Q: {sign: real}")
    path.write_text(text.replace("g: 8}", "g: 8, Omega: 0}"))
    there = found(path, "Q", "-20", "20")  # m g l = 16
    assert told(there) == [(-16.0, (Event.FOLD,)), (16.0, (Event.FOLD,))]
    assert counts(there) == [(0, 0), (2, 1), (0, 0)]


def test_what_comes_out_of_singular_coordinates_is_no_event_with_a_name() -> None:
    # the conical pendulum leaves the vertical, where its azimuth is singular, at l Omega^2 = g
    conical = found(SHIPPED / "spherical-pendulum.yaml", "Omega", "1", "5")
    assert [x.sample.polynomial.coeffs() for x in conical.criticals] == [[-981, 0, 100]]
    assert [
        (conical.critical(x).balance, conical.critical(x).events, conical.leaves(x)) for x in conical.criticals
    ] == [(None, (), True)]
    assert counts(conical) == [(0, 0), (1, 1)]  # at -theta and half a turn of the azimuth the bob is where it was
    # the spring stands upright with the length l0 - m g/k, which is positive for k > m g/l0 = 9.81
    upright = found(SHIPPED / "spring-pendulum.yaml", "k", "1", "20")
    assert [x.sample for x in upright.criticals if upright.happens(x)] == [fmpq(981, 100)]
    assert counts(upright) == [(1, 1), (2, 1)]


@cache
def gyrostat() -> Branches:
    return found(SHIPPED / "orbital-gyrostat.yaml", "h", "0", "10")


def test_the_gyrostat_with_its_rotor_along_the_normal_of_the_orbit() -> None:
    """A, B, C = 4, 5, 3: h = B - A, B - C, 4(B - A), 4(B - C); Sarychev & Mirer: 24, 20, 16, 12 and 8 equilibria."""
    there = gyrostat()
    two = (Event.PITCHFORK, Event.PITCHFORK)
    splitting = [one for one in told(there) if one[1] and one[1] != (Event.CONTINUUM,)]
    assert splitting == [(1.0, two), (2.0, two), (4.0, two), (8.0, two)]
    numbers = dict.fromkeys(count for count, _ in counts(there))
    assert list(numbers) == [24, 20, 16, 12, 8]
    assert there.proved
    # With n the normal and e the radius in body axes: 3 e2 e3 = n3 (n2 + h/2), 3 e1 e2 = n1 (n2 + h), 3 e1 e3 = n1 n3.
    # If none of them vanishes, P = n1^2/(n2 + h/2) and Q = n3^2/(n2 + h) give P + Q = -n2 by n.e = 0, P + 2 Q = 2/h by
    # n.n = 1, and e.e = 1 becomes h^2 = 8: n2 is left open.
    assert [x.sample.polynomial.coeffs() for x in there.criticals if there.critical(x).continuum] == [[-8, 0, 1]]


# --- planted mistakes -------------------------------------------------------------------------------------------------


def test_an_event_of_the_wrong_name_contradicts_the_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "named", lambda point: Named(Event.FOLD, 0, 2))
    there = found(ball(tmp_path, "p*x - x**3"), "p", "-1", "1")
    assert [there.critical(one).balance for one in there.criticals] == [False]
    assert [one.doubt for one in there.remarks] == [Doubt.MISMATCH]
    done = invoked(
        "equilibria", tmp_path / "ball.yaml", "--vary", "p=-1:1", "--format", "json", "--out", tmp_path / "o"
    )
    assert done.exit_code == 1
    assert "fold" not in done.stdout


def test_a_lost_equilibrium_contradicts_the_events(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = module.equilibria

    def lost(*words: Any, **more: Any) -> Any:
        given = whole(*words, **more)
        return replace(given, equilibria=given.equilibria[:1])

    monkeypatch.setattr(module, "equilibria", lost)
    there = found(ball(tmp_path, "p*x - x**3"), "p", "-1", "1")
    assert Doubt.MISMATCH in [one.doubt for one in there.remarks]


# --- the command ------------------------------------------------------------------------------------------------------


def test_files_are_written_and_follow_their_schema(tmp_path: Path) -> None:
    path = filed(tmp_path / "hoop.yaml", HOOP.format(torque="m*l*g*cos(theta)/10"))
    invoked("equilibria", path, "--vary", "Omega=0:5", "--out", tmp_path / "out", "--language", "ru", code=0)
    data = json.loads((tmp_path / "out" / "branches.json").read_text())
    assert list(Draft202012Validator(schema("branches")).iter_errors(data)) == []
    assert [x["events"] for x in data["critical_values"]] == [["fold"]]
    assert [(x["count"], x["stable"]) for x in data["intervals"]] == [(2, 1), (4, 2)]
    text = (tmp_path / "out" / "branches.tex").read_text()
    assert "складка" in text
    assert "mbsym equilibria" in text
    for kind in ("svg", "pdf", "png"):
        assert (tmp_path / "out" / f"branches.{kind}").stat().st_size > 3000


def test_the_formulas_of_the_text_are_latex(tmp_path: Path) -> None:
    done = invoked("equilibria", ball(tmp_path, "p*x - x**3"), "--vary", "p=-1:1", "--format", "tex", "-o", tmp_path)
    assert done.exit_code == 0
    read_latex("fragments/branches.tex", (tmp_path / "branches.tex").read_text())


@pytest.mark.parametrize(
    ("words", "codes"),
    [
        (["--vary", "h=1:0"], ["empty-interval"]),
        (["--vary", "nothing=0:1"], ["unknown-name"]),
        (["--vary", "h"], ["bad-interval"]),
        (["--vary", "h2=0:1"], ["given-by-relation"]),
        (["--vary", "A=-1:1"], ["against-sign"]),
        (
            ["--vary", "h=0:1", "--set", "h=1", "--format", "doc", "--language", "xx"],
            ["unknown-format", "unknown-language", "repeated-name"],
        ),
        (["--vary", "h=0:1", "--json"], ["with-vary"]),
        (["--format", "json"], ["needs-vary"]),
    ],
)
def test_what_is_wrong_is_told_at_once_and_nothing_written(words: list[str], codes: list[str], tmp_path: Path) -> None:
    given = words if words[0] == "--format" else [*words, "--out", str(tmp_path / "out")]
    done = invoked("equilibria", SHIPPED / "orbital-gyrostat.yaml", *given, code=2)
    assert all(code in done.output for code in codes), done.output
    assert not (tmp_path / "out").exists()


def test_numbers_that_are_missing_are_all_named(tmp_path: Path) -> None:
    path = filed(tmp_path / "hoop.yaml", HOOP.format(torque="0").replace("values: {m: 1, l: 2, g: 8}\n", ""))
    done = invoked("equilibria", path, "--vary", "Omega=0:1", "--out", tmp_path / "out", code=2)
    assert "m, l, g" in done.output
    assert "Omega" not in done.output.split("hint")[0]


@pytest.mark.parametrize(("f", "why"), [("p - exp(x)", "exp"), ("x - sqrt(p)", "stands in a root")])
def test_what_is_no_polynomial_is_refused_with_the_reason(f: str, why: str, tmp_path: Path) -> None:
    done = invoked("equilibria", ball(tmp_path, f), "--vary", "p=1:2", "--out", tmp_path / "out", code=1)
    assert why in done.output
    assert not (tmp_path / "out").exists()


def test_what_is_left_when_interrupted_is_kept(tmp_path: Path) -> None:
    system = mbsym.load(ball(tmp_path, "p*x - x**3"), ()).system

    def watch(what: str, done: int, whole: int) -> None:
        if what == "samples" and done == 1:
            raise KeyboardInterrupt

    there = branches(system, Axis("p", Fraction(-1), Fraction(1)), {}, watch=watch)
    assert there.interrupted
    assert not there.proved
    assert len(there.intervals) == 1


def test_every_word_has_its_translation() -> None:
    for language in ("ru", "es"):
        assert {("", event.told) for event in {*Event} - {Event.REGULAR}} <= messages(language).keys()
    told = schema("branches")["properties"]
    assert told["remarks"]["items"]["properties"]["doubt"]["enum"] == [one.value for one in Doubt]
    meeting = told["critical_values"]["items"]["properties"]["equilibria"]["items"]["properties"]
    assert meeting["event"]["enum"] == [one.value for one in Event]
    assert all(remark_words(module.Remark(doubt, "")) for doubt in Doubt)


def test_what_nothing_decides_is_not_counted_as_unstable(tmp_path: Path) -> None:
    """x'' = -2 x + P y - c x', y'' = -3 y - P x - c y', with cubic springs: the damping is the same in both, so that
    with c > 0 the roots are to the left where P^2 < 1/4 + 5 c^2/2 (Routh), and without damping two pairs are
    imaginary for P < 1/2, which no theorem here decides.  "0 stable" was told there, as beyond, where it is unstable.
    """
    text = """
mbsym: 1
name: Circulatory
parameters: {P: real, c: nonnegative}
bodies:
  - {name: p, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
loads:
  - generalized force: {x: "-2*x + P*y - c*x_dot - x**3", y: "-3*y - P*x - c*y_dot - y**3"}
motion: {x: 0, y: 0}
values: {P: 1/4, c: 0}
"""
    path = filed(tmp_path / "circulatory.yaml", text)
    done = invoked("equilibria", path, "--vary", "P=0:1", "--out", tmp_path / "out")
    told = [re.split(r"  +", line.strip())[1:3] for line in done.output.splitlines() if " .. " in line]
    assert told == [["1", "0, 1 undecided"], ["1", "0"]]
    caption = (tmp_path / "out" / "branches.tex").read_text()
    assert caption.count("undecided 1") == 1
