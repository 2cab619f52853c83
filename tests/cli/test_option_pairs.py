"""Every pair of options of ``mbsym simulate``: both have their effect, or the two are refused by name.

``APART`` says which do not go together.  All other pairs are covered by runs of many options each, put together
greedily; after each run the effect of every option of it is looked for in what was written and printed.
"""

from __future__ import annotations

import json
import shlex
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import Result
from conftest import filed, invoked
from test_simulate import table

from mbsym.numerics.ensembles.side_by_side import TABLEAUX
from mbsym.numerics.kernels.interface import EXTENDED
from mbsym.numerics.kernels.llvm import available
from mbsym.numerics.methods.table import METHODS
from mbsym.studies.simulate import PAIRS, STUDY
from mbsym.studies.study import Apart, Needed
from mbsym_cli.study import command_of

APART = [one for one in PAIRS if isinstance(one, Apart)]
NEEDED = [one for one in PAIRS if isinstance(one, Needed)]

#: A dumbbell on a circular orbit, in its plane (beta rests), with a wheel (a first integral) and a soft spring.
DUMBBELL = """
mbsym: 1
name: dumbbell with a wheel
parameters: {R: positive, omega0: positive, nu: positive, m: positive, l: positive, J: positive, c: positive}
prescribed: {chi: omega0}
inputs: {u: torque of the wheel}
bodies:
  - {name: frame, attached to: 0, rotation: {axes: [3], angles: [-chi]},
     connection point: [R*sin(chi), R*cos(chi), 0], mass: 0}
  - {name: outer, attached to: frame, rotation: {axes: [3, 1], angles: [alpha, beta]}, mass centre: [0, l, 0], mass: m}
  - {name: inner, attached to: outer, mass centre: [0, -l, 0], mass: m}
  - {name: wheel, attached to: outer, rotation: {axes: [3], angles: [psi]}, mass: m,
     inertia about: joint, inertia: [J, J, 2*J]}
loads:
  - newtonian gravity: {constant: nu, centre: 0, about: frame, order: 2}
  - potential: c*alpha**4
  - generalized force: {psi: u}
relations: {nu: omega0**2*R**3}
motion: {alpha: 0, beta: 0, psi: 0}
values: {R: 50, omega0: 1, m: 1, l: 1, J: 1/10, c: 1/100}
initial: {alpha: 1/5, beta: 0, psi: {position: 0, velocity: 1/10}}
"""

TIME, EARLIER, ROWS = 2.0, 1.0, 11


@dataclass
class Done:
    """What a run of some items left behind."""

    items: frozenset[str]
    result: Result
    folder: Path

    @cached_property
    def told(self) -> dict[str, Any]:
        name = "ensemble.json" if "vary" in self.kinds else "simulation.json"
        return json.loads((self.folder / name).read_text(encoding="utf-8"))

    @cached_property
    def words(self) -> list[str]:
        """The command that repeats a plan; what was asked for stands in it."""
        return shlex.split(self.result.stdout.splitlines()[-1]) if self.result.stdout else []

    @cached_property
    def rows(self) -> dict[str, Any]:
        return table(self.folder / ("ensemble.csv" if "vary" in self.kinds else "trajectory.csv"))

    @cached_property
    def kinds(self) -> set[str]:
        return {ITEMS[name].kind for name in self.items}

    def repeats(self, *words: str) -> bool:
        """Whether a plan hands them on."""
        return all(word in self.words for word in words)


@dataclass(frozen=True)
class Item:
    """An option with a value: its ``words``, the options that they are, items that come with it, its effect."""

    words: tuple[str, ...]
    effect: Callable[[Done], bool]
    needs: tuple[str, ...] = ()

    @property
    def kind(self) -> str:
        return self.words[0].removeprefix("--")

    @property
    def names(self) -> set[str]:
        return {self.words[0], " ".join(self.words[:2])}


def recorded(key: str, value: object, *words: str) -> Callable[[Done], bool]:
    """It stands in simulation.json or ensemble.json, or in the command of a plan."""

    def effect(done: Done) -> bool:
        if "plan" in done.items:
            return done.repeats(*words)
        return done.told[key] == value

    return effect


def written(pattern: str, *words: str) -> Callable[[Done], bool]:
    def effect(done: Done) -> bool:
        if "plan" in done.items:
            return done.repeats(*words)
        return any(done.folder.glob(pattern))

    return effect


def by_method(name: str) -> Callable[[Done], bool]:
    def effect(done: Done) -> bool:
        if "plan" in done.items:
            return done.repeats("--method", name)
        told = done.told["method"]
        return name in (told if isinstance(told, str) else told["name"])

    return effect


def method(name: str) -> Item:
    fixed = METHODS[name].traits.fixed
    return Item(("--method", name), by_method(name), ("step",) if fixed else ())


def samples(done: Done) -> bool:
    if "plan" in done.items:
        return done.repeats("--samples", "41")
    return done.told["time"]["samples"] == 41 + (ROWS if "continue" in done.items else 0)


def every(done: Done) -> bool:
    if "plan" in done.items:
        return done.repeats("--every", "0.04")
    return bool(np.isclose(np.diff(done.rows["t"]), 0.04).any())


def longest(done: Done) -> bool:
    if "plan" in done.items:
        return done.repeats("--max-step", "0.01")
    if "vary" in done.kinds:
        return done.told["steps"] >= 200 * done.told["members"]
    begun = EARLIER if "continue" in done.items else 0.0
    least = (done.told["reached"]["time"] - begun) / 0.01
    return done.told["longest_step"] == 0.01 and done.told["work"]["steps"] >= 0.9 * least


def stopped(done: Done) -> bool:
    return 0 < done.told["reached"]["time"] < TIME and "stopped" in (done.result.stdout or "stopped")


def event(done: Done) -> bool:
    return done.repeats("--event") if "plan" in done.items else (done.folder / "events.csv").exists()


def section(done: Done) -> bool:
    return done.repeats("--section") if "plan" in done.items else (done.folder / "section.csv").exists()


def axes(done: Done) -> bool:
    if "plan" in done.items:
        return done.repeats("psi, psi_dot")
    return "psi_dot" in (done.folder / "section.csv").read_text(encoding="utf-8").splitlines()[0]


def invariants(done: Done) -> bool:
    if "plan" in done.items:
        return done.repeats("--invariants")
    return bool(done.told["invariants"]) or "no first integrals" in done.result.stderr


def whole(done: Done) -> bool:
    return done.repeats("--whole") if "plan" in done.items else done.told["resting"] is None


def model(key: str, value: object, *words: str) -> Callable[[Done], bool]:
    def effect(done: Done) -> bool:
        return done.repeats(*words) if "plan" in done.items else done.told["model"][key] == value

    return effect


def value(done: Done) -> bool:
    if "plan" in done.items:
        return done.repeats("l=3/2")
    if "vary" in done.kinds:
        return True  # an ensemble does not record it; test_members_have_the_values_that_were_set shows it
    return done.told["parameters"]["l"] == 1.5


def planned(done: Done) -> bool:
    return "to repeat:" in done.result.stdout and not (done.folder / "simulation.json").exists()


def accurate(done: Done) -> bool:
    return "plan" in done.items or done.told["plan"]["accuracy"]["everything"] == 1e-3


def estimated(asked: bool) -> Callable[[Done], bool]:
    def effect(done: Done) -> bool:
        if "plan" in done.items:
            return done.repeats("--estimate" if asked else "--no-estimate")
        known = done.told["estimated_error"]
        return (known.get("why") != "not asked for" and "largest" in json.dumps(known)) == asked

    return effect


ITEMS: dict[str, Item] = {
    "set": Item(("--set", "l=3/2"), value),
    "input": Item(("--input", "u=0"), recorded("inputs", {"u": "0"}, "--input", "u=0")),
    "samples": Item(("--samples", "41"), samples),
    "every": Item(("--every", "0.04"), every),
    **{f"method {name}": method(name) for name in METHODS},
    "tolerance": Item(("--tolerance", "1e-7"), recorded("tolerance", 1e-7, "--tolerance", "1e-07")),
    "step": Item(("--step", "0.02"), recorded("step", 0.02, "--step", "0.02")),
    "max-step": Item(("--max-step", "0.01"), longest),
    "extended": Item(("--arithmetic", "extended"), recorded("arithmetic", "extended", "--arithmetic", "extended")),
    "float32": Item(("--arithmetic", "float32"), recorded("arithmetic", "float32", "--arithmetic", "float32")),
    "step-limit": Item(("--step-limit", "90000"), lambda done: "vary" in done.kinds or limited(done)),
    "invariants": Item(("--invariants",), invariants),
    "estimate": Item(("--estimate",), estimated(True)),
    "no-estimate": Item(("--no-estimate",), estimated(False)),
    "whole": Item(("--whole",), whole),
    "accuracy": Item(("--accuracy", "1e-3"), accurate),
    "plan": Item(("--plan",), planned, ("accuracy",)),
    "gravity": Item(("--gravity", "3"), model("gravity", 3, "--gravity", "3")),
    "linear": Item(("--linear",), model("linear", True, "--linear")),
    "without": Item(("--without", "c"), model("without", ["c"], "--without", "c")),
    "vary": Item(("--vary", "alpha=0:1/5:3"), lambda done: done.told["members"] == 3),
    "vary at random": Item(("--vary", "alpha=uniform(0, 1/5)"), lambda done: done.told["members"] == 5, ("members",)),
    "members": Item(("--members", "5"), lambda done: done.told["members"] == 5, ("vary at random",)),
    "seed": Item(("--seed", "3"), lambda done: done.told["seed"] == 3, ("vary at random",)),
    "sampling": Item(("--sampling", "sobol"), lambda done: done.told["sampling"] == "sobol", ("vary at random",)),
    "sensitivity": Item(("--sensitivity", "alpha,l"), written("sensitivity.csv")),
    "certify": Item(("--certify", "1e-6"), lambda done: "certificate" in done.told),
    "certify-seconds": Item(("--certify-seconds", "500"), lambda done: done.told["certificate"]["whole"], ("certify",)),
    "event": Item(("--event", "alpha = 1/10"), event),
    "stop": Item(("--stop", "psi > 1/2"), stopped),
    "section": Item(("--section", "alpha = 1/10 falling"), section),
    "axes": Item(("--axes", "psi, psi_dot"), axes, ("section",)),
    "continue": Item(("--continue", "EARLIER"), lambda done: done.told["continued"]["from"] == EARLIER),
    "format": Item(("--format", "csv,svg"), written("*.svg", "--format", "csv,svg")),
    "bodies": Item(("--bodies",), written("bodies*.csv", "--bodies")),
    "animate": Item(("--animate",), written("animation.html", "--animate")),
    "out": Item(("--out", "FOLDER"), lambda done: done.repeats("--out") if "plan" in done.items else bool(done.told)),
    "quiet": Item(("--quiet",), lambda done: "json" in done.items or not done.result.stdout),
    "json": Item(("--json",), lambda done: json.loads(done.result.stdout) == done.told),
}


def limited(done: Done) -> bool:
    return recorded("step_limit", 90000, "--step-limit", "90000")(done)


#: Of the same kind there is one at a time.
RATHER = {"samples", "step-limit"}


def closure(names: Iterable[str]) -> frozenset[str]:
    """With what they need."""
    found = set(names)
    while True:
        more = {need for name in found for need in ITEMS[name].needs} - found
        if not more:
            return frozenset(found)
        found |= more


def apart(items: frozenset[str]) -> bool:
    """Whether some of them exclude each other: by the table, by being one option twice, or by what values mean."""
    options = {name for item in items for name in ITEMS[item].names}
    if any(one.option in options and one.other in options for one in APART):
        return True
    kinds = [ITEMS[item].kind for item in items]
    if len(kinds) > len(set(kinds)) or {"estimate", "no-estimate"} <= items:
        return True
    return any(True for _ in by_values(items))


def by_values(items: frozenset[str]) -> Iterator[tuple[str, str]]:
    """Pairs of options that the values of one keep apart: what methods can do."""
    name = next((ITEMS[item].words[1] for item in items if ITEMS[item].kind == "method"), "auto")
    fixed = name != "auto" and METHODS[name].traits.fixed
    for other in ("tolerance", "max-step"):
        if other in items and fixed:
            yield f"--{other}", name
    if "step" in items and name != "auto" and not fixed:
        yield "--step", name
    if {"step", "tolerance"} <= items and not fixed:
        yield "--step", "--tolerance"
    if {"step", "max-step"} <= items and not fixed:
        yield "--step", "--method auto"
    for scalar in ("extended", "float32"):
        if scalar in items and name != "auto" and scalar not in METHODS[name].traits.scalars:
            yield "--arithmetic", name
    if {"vary", "vary at random"} & items and name not in ("auto", *TABLEAUX):
        yield "--method", name
    # The midpoint rules go by a Lagrangian of second order in the velocities, which the linearised equations are not.
    if "linear" in items and name.startswith("midpoint"):
        yield "--method", name


def here(name: str) -> bool:
    item = ITEMS[name]
    if item.kind == "method" and METHODS[item.words[1]].traits.name == "taylor":
        pytest.importorskip("heyoka")
    return name != "extended" or available(EXTENDED)


def cover() -> list[frozenset[str]]:
    """Sets of items that go together and hold every pair that does; a quiet plan, of which nothing is seen, is none."""
    names = [name for name in ITEMS if here(name)]
    whole = {name: closure({name}) for name in names}
    pairs = {frozenset(pair) for pair in combinations(names, 2) if not apart(whole[pair[0]] | whole[pair[1]])}
    pairs.discard(frozenset({"plan", "quiet"}))
    friends = {name: {other for pair in pairs if name in pair for other in pair if other != name} for name in names}
    wanted = {name: set(found) for name, found in friends.items()}
    found = []
    while any(wanted.values()):
        # A step comes with the methods that need one.
        first = next(name for name in names if wanted[name] and name != "step")
        items = set(whole[first] | whole[min(wanted[first])])
        while True:
            free = [name for name in names if name not in items | {"step"} and _joins(whole[name], items, friends)]
            gains = {name: len(wanted[name] & items) for name in free}
            best = max(gains, key=lambda name: gains[name], default=None)
            if best is None or not gains[best]:
                break
            items |= whole[best]
        for name in items:
            wanted[name] -= items
        found.append(frozenset(items))
    return found


def _joins(some: frozenset[str], items: set[str], friends: dict[str, set[str]]) -> bool:
    return all(items - {one} <= friends[one] for one in some)


@pytest.fixture(scope="module")
def described(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return filed(tmp_path_factory.mktemp("pairs") / "dumbbell.yaml", DUMBBELL)


def called(*arguments: object, code: int | None = None) -> Result:
    return invoked("simulate", *arguments, code=code)


#: What an earlier run has to have in common with the one that goes on.
COMMON = ("set", "gravity", "linear", "without", "whole")


def words(items: Iterable[str], described: Path, folder: Path, end: float = TIME) -> list[str]:
    found = [str(described), "--time", str(end)]
    for name in sorted(items):
        given = {"EARLIER": str(folder / "earlier" / "simulation.json"), "FOLDER": str(folder / "out")}
        found += [given.get(word, word) for word in ITEMS[name].words]
    if "format" not in items:
        found += ["-f", "csv"]
    return [*found, *([] if "out" in items else ["--out", str(folder / "out")])]


COVER = cover()


@pytest.mark.parametrize("place", range(len(COVER)))
def test_options_that_go_together_have_their_effect(place: int, described: Path, tmp_path: Path) -> None:
    items = COVER[place]
    if "continue" in items:
        before = [*words(items & set(COMMON), described, tmp_path, EARLIER), "--samples", str(ROWS)]
        assert called(*before, "--out", tmp_path / "earlier").exit_code == 0
    result = called(*words(items, described, tmp_path))
    assert result.exit_code in (0, 3), result.output
    assert "internal error" not in result.stderr
    done = Done(items, result, tmp_path / "out")
    without = [name for name in sorted(items) if not ITEMS[name].effect(done)]
    assert not without, (without, sorted(items), result.output)


@pytest.mark.parametrize("one", APART, ids=lambda one: f"{one.option} {one.other}")
def test_options_that_do_not_go_together_are_refused_by_name(one: Apart, described: Path, tmp_path: Path) -> None:
    items = {next(name for name, item in ITEMS.items() if option in item.names) for option in (one.option, one.other)}
    result = called(*words(closure(items), described, tmp_path), code=2)
    assert f"{one.option.split()[0]}: error[conflicting-options]: {one.option} does not go with {one.other}: " in (
        result.stderr
    )
    assert not (tmp_path / "out").exists()


METHOD_ITEMS = {name for name, item in ITEMS.items() if item.kind == "method"}

#: Of two methods the later one counts, which is no matter of pairs; the first of --step or --tolerance is asked for.
VALUES = sorted(
    {
        (one, other, pair)
        for one, other in combinations(ITEMS, 2)
        for pair in by_values(closure((one, other)))
        if "linear" not in (one, other) and not {one, other} <= METHOD_ITEMS
    }
)


@pytest.mark.parametrize("case", VALUES, ids=str)
def test_values_that_do_not_go_together_are_refused_by_name(
    case: tuple[str, str, tuple[str, str]], described: Path, tmp_path: Path
) -> None:
    one, other, named = case
    result = called(*words(closure((one, other)), described, tmp_path), code=2)
    assert all(name in result.stderr for name in named), result.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("one", NEEDED, ids=lambda one: one.option)
def test_an_option_about_another_one_is_not_passed_over(one: Needed, described: Path, tmp_path: Path) -> None:
    name = next(name for name, item in ITEMS.items() if one.option in item.names)
    result = called(*words({name}, described, tmp_path), code=2)
    assert f"{one.option}: error[missing-option]: {one.option} goes with {one.other}" in result.stderr


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("--vary", "alpha=0:1/5:3", "--seed", "3"), "--seed does not go with --vary alpha"),
        (("--vary", "alpha=0:1/5:3", "--sampling", "sobol"), "--sampling does not go with --vary alpha"),
        (("--vary", "alpha=0:1/5:3", "--set", "alpha=1"), "--set alpha does not go with --vary alpha"),
        (("--without", "c", "--set", "c=1"), "--set c does not go with --without c"),
    ],
)
def test_one_name_has_one_value(arguments: tuple[str, ...], told: str, described: Path, tmp_path: Path) -> None:
    result = called(described, "--time", 1, *arguments, "--out", tmp_path / "out", code=2)
    assert told in result.stderr
    assert not (tmp_path / "out").exists()


def test_the_limit_of_steps_is_one_of_members_too(described: Path, tmp_path: Path) -> None:
    result = called(described, "--time", 9, "--vary", "alpha=0:1/5:3", "--step-limit", 3, "--out", tmp_path, code=3)
    assert "members ended early" in result.stderr


def test_members_have_the_values_that_were_set(described: Path, tmp_path: Path) -> None:
    ends = []
    for given in ((), ("--set", "l=3/2")):
        folder = tmp_path / str(len(given))
        assert (
            called(described, "--time", 1, "--vary", "alpha=0:1/5:3", *given, "-f", "csv", "--out", folder).exit_code
            == 0
        )
        ends.append(json.loads((folder / "ensemble.json").read_text(encoding="utf-8"))["final"]["alpha"]["mean"])
    assert ends[0] != ends[1]


def test_a_quiet_plan_says_nothing_but_by_its_exit_code(described: Path, tmp_path: Path) -> None:
    how = ("--time", 1, "--plan", "--quiet", "--out", tmp_path / "out")
    good = called(described, *how, "--accuracy", "1e-3")
    assert (good.exit_code, good.output) == (0, "")
    bad = called(described, *how, "--accuracy", "1e-9", "--method", "rk4", "--step", "0.1", code=3)
    assert bad.stdout == ""
    assert "no plan is shown to reach the accuracy asked for" in " ".join(bad.stderr.split())
    assert not (tmp_path / "out").exists()


def test_every_option_is_there() -> None:
    """A new option has to say what goes with it."""
    known = {option for item in ITEMS.values() for option in item.names} | {"--debug", "--force"}  # from outside
    assert {max(one.opts, key=len) for one in command_of(STUDY).params if one.param_type_name == "option"} - known == {
        "--time",
        "--fixed",  # of descriptions with constraints: tests/constrained/test_constrained_runs.py
        "--variables",  # of descriptions with speeds: tests/cli/test_declared_variables.py
        "--verbose",  # what is printed alone
        "--anew",  # where something was measured before: tests/cli/test_remembered.py
    }
