"""Every line of ``tradeoff``, ``--certify`` and ``--ledger``, parsed back: each number and comparison that it tells is
held against the files beside it, and a line of no known kind is a mistake.  (``--accuracy``: ``test_plans_told``.)
"""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import chain, pairwise
from math import floor, inf, log10
from pathlib import Path
from typing import Any

import pytest
from conftest import filed, invoked
from truth.independent.scenes import SCENES as FREE
from truth.test_accuracy_constrained import SCENES as CONSTRAINED
from truth.test_plans_told import sections

import mbsym
from mbsym.report.runs import certificate
from mbsym.studies.simulate import fitting

ROOT = Path(__file__).parents[2]


@dataclass(frozen=True)
class Scene:
    """A description, and for how long it runs."""

    text: str
    time: float


def _scenes() -> Iterator[tuple[str, Scene]]:
    times = {"coulomb": 5.0, "decay": 10.0, "dpchaos": 3.0, "growth": 10.0, "mmg": 1.0, "si": 1.0}
    for name, time in times.items():
        yield name, Scene((ROOT / "tests" / "cases" / "trade" / f"{name}.yaml").read_text(encoding="utf-8"), time)
    texts, short = {scene.name: scene.text for scene in FREE}, {"kepler": 7.0, "furuta": 1.0, "light": 2.0, "top": 0.2}
    for name, time in short.items():
        yield name, Scene(texts[name], time)
    for name, told in CONSTRAINED.items():
        yield f"{name} tied", Scene(told.text, 2.0)


SCENES = dict(_scenes())

UNIT = {"ns": 1e-9, "µs": 1e-6, "ms": 1e-3, "s": 1.0, "min": 60.0, "h": 3600.0, "days": 86400.0}
N = r"[-+.\de]+"
DURATION = rf"({N} (?:{'|'.join(UNIT)}))"


def seconds_of(text: str) -> float:
    number, unit = text.split()
    return float(number) * UNIT[unit]


def as_told(text: str, value: float | None) -> bool:
    """Whether a number with these digits is the value, rounded to nearest; of none that is finite there is none."""
    if value is None:
        return text == "inf"
    digits = text.lstrip("-").split("e")[0].replace(".", "").lstrip("0")
    return abs(float(text) - value) <= 0.5001 * _last(float(text), len(digits or "0"))


def above(text: str, value: float) -> bool:
    """Whether a number with two digits is the value rounded up: nowhere below it, and no more than a digit above."""
    return value * (1 - 2e-15) <= float(text) <= value + 1.0001 * _last(float(text), 2)


def _last(number: float, digits: int) -> float:
    """A unit in the last of so many digits."""
    return 10.0 ** (floor(log10(abs(number))) + 1 - digits) if number else 0.5


@dataclass(frozen=True)
class Told:
    """What a command printed, beneath its first line, and how it ended."""

    lines: list[str]
    code: int

    def matching(self, known: dict[str, Callable[..., None]]) -> dict[str, int]:
        """Every line has the form of one pattern, which holds what it says; how many each has."""
        counts = dict.fromkeys(known, 0)
        for line in self.lines:
            found = next(((key, m) for key in known if (m := re.fullmatch(key, line))), None)
            assert found is not None, f"a line of no known kind: {line!r}"
            counts[found[0]] += 1
            known[found[0]](*found[1].groups())
        return counts


def told(*words: object) -> Told:
    done = invoked(*words)
    lines = [line.strip() for line in done.output.splitlines() if ": note: " not in line]
    return Told([line for line in lines[1:] if line], done.exit_code)


# --- tradeoff ---


class Trade:
    """``tradeoff.json``, and what is to hold of sentences beside it; ``every`` run is told, or those on the front."""

    def __init__(self, file: dict[str, Any], folder: Path, every: bool) -> None:
        self.file, self.folder, self.every, self.shown = file, folder, every, list[dict[str, Any]]()
        self.least, self.known = file["smallest_judged"], file["reference"]["error"]

    def label(self, run: dict[str, Any]) -> str:
        setting = f"h={run['step']:.3g}" if run["tolerance"] is None else f"{run['tolerance']:.0e}"
        return f"{run['method']} {setting}" + ("" if run["arithmetic"] == "float64" else f", {run['arithmetic']}")

    def named(self, label: str) -> dict[str, Any]:
        (run,) = [run for run in self.file["runs"] if self.label(run) == label]
        return run

    def reaching(self, target: float) -> list[dict[str, Any]]:
        runs = self.file["runs"]
        return [run for run in runs if run["error"] is not None and run["error"] + self.known <= target]

    def _beside(self, run: dict[str, Any], faster: list[dict[str, Any]]) -> tuple[bool, bool]:
        """Whether one of them has a smaller error, and whether another one has the same, as far as they are judged."""
        own, *others = (max(x["error"], self.least) for x in (run, *(x for x in faster if x != run)))
        return any(x < own for x in others), own in others

    # lines

    def reference(self, method: str, error: str, time: str, least: str) -> None:
        truth = self.file["reference"]
        assert method == truth["method"]
        assert as_told(error, truth["error"])
        assert as_told(time.split()[0], truth["seconds"] / UNIT[time.split()[1]])
        assert float(least) == self.least >= 100 * truth["error"]

    def row(self, line: str) -> None:
        name, rest = line.split(None, 1)
        scalar = next((word for word in ("float32", "extended") if rest.startswith(word)), "float64")
        setting, error, *cells = re.sub(r"(?<=\d) (?=[µm]?s\b)|(?<=<) ", "_", rest.removeprefix(scalar).strip()).split()
        run = self.named(f"{name} {setting}" + ("" if scalar == "float64" else f", {scalar}"))
        self.shown.append(run)
        if self.every:
            front = cells[-1] == "*"
            assert front is run["front"]
            *cells, evaluations, steps, time, cost = cells[:-1] if front else cells
            assert (int(evaluations), int(steps)) == (run["evaluations"], run["steps"])
            assert as_told(cost, run["cost"])
        else:
            *cells, time = cells
        assert as_told(time.split("_")[0], run["seconds"] / UNIT[time.split("_")[1]])
        assert (error == "fails") is ("trouble" in run)
        if "trouble" in run:
            assert (cells, run["front"]) == ([], False)
            return
        drift, *strayed = cells
        if error.startswith("<"):
            assert float(error[2:]) == self.least >= run["error"]
        else:
            assert as_told(error, run["error"])
            assert run["error"] > self.least
        assert as_told(drift, run["drift"])
        assert ("constraint_drift" in run) is bool(strayed)
        if strayed:
            assert as_told(strayed[0], max(run["constraint_drift"].values()))

    def order(self, method: str, scalar: str, measured: str, nominal: str, halvings: str) -> None:
        (order,) = [x for x in self.file["orders"] if (x["method"], x["arithmetic"]) == (method, scalar)]
        assert as_told(measured, order["measured"])
        assert (int(nominal), int(halvings)) == (order["nominal"], order["halvings"])
        ladder = [x for x in self.file["runs"] if (x["method"], x["arithmetic"]) == (method, scalar) and x["error"]]
        assert 1 < order["halvings"] < len(ladder)
        ratios = [log10(a["error"] / b["error"]) / log10(2) for a, b in pairwise(ladder)]
        assert min(ratios) - 1e-9 <= order["measured"] <= max(ratios) + 1e-9

    def unused(self, methods: str, why: str) -> None:
        assert methods.split(", ") == [left["method"] for left in self.file["not_used"] if left["why"] == why]

    def costs(self, reference: str, runs: str, budget: str) -> None:
        assert as_told(reference, self.file["reference"]["cost"])
        assert as_told(runs, self.file["spent"])
        assert float(budget) == self.file["budget"]
        assert sum(run["cost"] for run in self.file["runs"]) <= self.file["spent"] * (1 + 1e-12)

    def model(self, line: str) -> None:
        (row,) = [row for row in self.file["models"] if line.startswith(f"{row['model']}  ")]
        rest = re.sub(r"\s+", " ", line.removeprefix(row["model"]).strip()).removeprefix(row["neglected"])
        error, operations, time, unit = rest.replace("< ", "<").split()
        assert row["error"] <= 1e-11 if error == "<1e-11" else as_told(error, row["error"])
        assert int(operations) == row["operations"]
        assert as_told(time, row["seconds"] / UNIT[unit])

    # the recommendation

    def advised(self, *words: str) -> None:
        setting, target, error, known, time, more, less = words
        run, goal = self.named(setting), float(target)
        assert goal == self.file["target"] >= self.least
        assert run in self.reaching(goal)
        assert run["seconds"] == min(x["seconds"] for x in self.reaching(goal))
        assert {key: run[key] for key in self.file["recommended"]} == self.file["recommended"]
        if error.startswith("below "):
            assert float(error.removeprefix("below ")) == self.least >= run["error"]
        else:
            assert as_told(error, run["error"])
        assert as_told(known, self.known)
        assert as_told(time.split()[0], run["seconds"] / UNIT[time.split()[1]])
        self.digit(more, goal / 10, run)
        self.digit(less, goal * 10, run)

    def digit(self, said: str, target: float, best: dict[str, Any]) -> None:
        reaching = self.reaching(target * (1 + 1e-12))
        cheapest = min((x["seconds"] for x in reaching), default=inf)
        if said == "cannot be judged by this reference":
            assert target < self.least
        elif said == "is reached by nothing tried here":
            assert not reaching
        elif said in ("costs nothing extra (it is there already)", "saves nothing"):
            assert best in reaching
            assert best["seconds"] == cheapest
        else:
            match = re.fullmatch(rf"costs {DURATION}, ({N}) times as much \((.*)\)", said)
            assert match is not None, said
            other = self.named(match[3])
            assert other in reaching
            assert other["seconds"] == cheapest
            assert as_told(match[1].split()[0], cheapest / UNIT[match[1].split()[1]])
            assert as_told(match[2], cheapest / best["seconds"])

    def missed(self, target: str, setting: str, error: str, time: str) -> None:
        run = self.named(setting)
        assert float(target) == self.file["target"] >= self.least
        assert self.file["recommended"] is None
        assert not self.reaching(float(target))
        assert run["error"] == min(x["error"] for x in self.file["runs"] if x["error"] is not None)
        assert as_told(error, run["error"])
        assert as_told(time.split()[0], run["seconds"] / UNIT[time.split()[1]])

    def beyond(self, known: str, target: str, least: str) -> None:
        assert as_told(known, self.known)
        assert float(target) == self.file["target"] < self.least == float(least)
        assert self.file["recommended"] is None

    def hold(self, lines: Told) -> None:
        """Every line, and that nothing is left out that is to be shown."""
        setting = r"\w[\w-]* [^,;]+?(?:, \w+)?"
        reached = (
            rf"({setting}) reaches ({N}) in the least time measured here: error ((?:below )?{N}) over the whole "
            rf"interval \(the reference is good to ({N})\), in {DURATION}; one digit more (.*), one digit less (.*)\."
        )
        missed = (
            rf"Nothing tried reaches ({N}); the most accurate is ({setting}) with an error of ({N}) in {DURATION}\."
        )
        beyond = (
            rf"The reference itself is known to ({N}) only: an error of ({N}) cannot be judged here; choose a target "
            rf"of at least ({N})\."
        )
        advice = {reached: self.advised, missed: self.missed, beyond: self.beyond}
        known = advice | {
            rf"reference: (.*), estimated error ({N}), {DURATION}; errors below ({N}) are not told apart": (
                self.reference
            ),
            r"method +setting +error +drift .*front" if self.every else r"method .*time": lambda: None,
            r"no other run is as exact as these in as little time \(--all-rows shows every run\):": lambda: None,
            r"([\w-]+(?:, [\w-]+)*): not used: (.*)": self.unused,
            rf"([\w-]+), (\w+): measured order ({N}), nominal (\d+) \(halvings of the step: (\d+)\)": self.order,
            rf"cost: ({N}) for the reference, ({N}) for the runs, of a budget of ({N}); counted work.*": self.costs,
            r"model +what it neglects +error +operations +time": lambda: None,
            **{rf"({re.escape(row['model'])} .*)": self.model for row in self.file["models"]},
            rf"([\w-]+ (?:float32 |extended )? *(?:h=)?{N} +(?:(?:< )?{N}|fails) .*)": self.row,
            r"files in .*": lambda: None,
        }
        counts = lines.matching(known)
        assert sum(counts[key] for key in advice) == 1
        assert sum(line == self.file["sentence"] for line in lines.lines) == 1
        told = [run for run in self.file["runs"] if self.every or run["front"]]
        assert len(self.shown) == len(told)
        assert all(run in self.shown for run in told)
        if not self.every:
            assert self.shown == sorted(self.shown, key=lambda run: -run["error"])
        for run in self.file["runs"]:
            faster = [x for x in self.file["runs"] if x["error"] is not None and x["seconds"] <= run["seconds"]]
            if run["error"] is not None:
                better, alike = self._beside(run, faster)
                assert run["front"] is not better or alike


METHODS = "rk4,dop853,midpoint4"


@pytest.mark.parametrize("target", [1.5e-9])
@pytest.mark.parametrize("name", SCENES)
def test_what_a_trade_says_is_what_it_measured(name: str, target: float, tmp_path: Path) -> None:
    """At a target of two digits, all runs told, and one that the reference cannot judge."""
    path = filed(tmp_path / "scene.yaml", SCENES[name].text)
    for goal, every in ((target, ["--all-rows"]), (1e-15, [])):
        words = ("--time", SCENES[name].time, "--target", goal, "--budget", 0.5, "-m", METHODS, "--out", tmp_path)
        lines = told("tradeoff", path, *words, *every)
        assert lines.code == 0
        lines = Told([line for line in lines.lines if "measured before" not in line], 0)
        file = json.loads((tmp_path / "tradeoff.json").read_text(encoding="utf-8"))
        Trade(file, tmp_path, bool(every)).hold(lines)


#: A number that stands by itself, not in a name, a setting or a unit of measurement.
NUMBERS = re.compile(r"(?<![\w.=-])\d[\d.]*(?:e[-+]\d+)?(?![\w.])")


def altered(line: str) -> Iterator[str]:
    """The line with one number after the other made larger by a third."""
    for match in NUMBERS.finditer(line):
        number = match[0]
        other = str(int(number) * 4 // 3 + 1) if number.isdigit() else f"{4 / 3 * float(number):.1e}"
        yield line[: match.start()] + other + line[match.end() :]


def test_a_number_that_is_changed_anywhere_in_a_trade_is_found(tmp_path: Path) -> None:
    path = filed(tmp_path / "scene.yaml", SCENES["growth"].text)
    words = ("--time", 10, "--target", 1e-9, "--budget", 0.5, "-m", "rk4,dop853", "--all-rows", "--out", tmp_path)
    lines = told("tradeoff", path, *words)
    file = json.loads((tmp_path / "tradeoff.json").read_text(encoding="utf-8"))
    changed = 0
    for place, line in enumerate(lines.lines):
        for other in [] if line.startswith("files") else altered(line):
            changed += 1
            with pytest.raises((AssertionError, ValueError)):
                Trade(file, tmp_path, True).hold(Told([*lines.lines[:place], other, *lines.lines[place + 1 :]], 0))
    assert changed > 50


# --- certify ---


@dataclass(frozen=True)
class Proof:
    """``certificate`` of ``simulation.json``, and the tables."""

    file: dict[str, Any]
    folder: Path

    def table(self, name: str) -> list[dict[str, float]]:
        (path,) = [self.folder / x for x in (f"{name}.csv", f"{name}-partial.csv") if (self.folder / x).is_file()]
        return [{k: float(x) for k, x in row.items()} for row in csv.DictReader(path.read_text().splitlines())]

    def within(self, error: str, rows: str) -> None:
        """The run and the enclosure, row by row: no further apart than is told, less its own radius."""
        enclosed, run = self.table("enclosure"), self.table("trajectory")
        assert above(error, self.file["largest_error"])
        if rows.startswith("all"):
            assert self.file["whole"]
            assert int(rows.split()[1]) == len(run) == len(enclosed) == self.file["rows"]
        else:
            assert not self.file["whole"]
            assert list(map(int, re.findall(r"\d+", rows))) == [len(enclosed), len(run)]
            assert len(enclosed) == self.file["rows"] < len(run)
            assert enclosed[-1]["t"] <= self.file["reached"] < run[len(enclosed)]["t"]
        worst = widest = 0.0
        for name, known in self.file["quantities"].items():
            apart = [abs(a[name] - b[name]) for a, b in zip(enclosed, run, strict=False)]
            radii = [row[f"{name}_radius"] for row in enclosed]
            worst = max(worst, max(apart) / known["scale"])
            both, largest = list(zip(apart, radii, strict=True)), known["largest_error"]
            assert max(gap - radius for gap, radius in both) <= largest * (1 + 1e-9)
            assert max(gap + radius for gap, radius in both) >= largest * (1 - 1e-9)
            widest = max(widest, max(radii) / known["scale"])
        assert worst <= float(error) + widest
        assert widest == pytest.approx(self.file["largest_radius"], rel=1e-9)

    def known(self, known: str, width: str | None, steps: str, bits: str) -> None:
        assert above(known, self.file["known"])
        assert (width is not None) is (self.file["known"] <= self.file["asked"] < self.file["largest_radius"])
        assert width is None or above(width, self.file["largest_radius"])
        assert (int(steps), int(bits)) == (self.file["steps"], self.file["bits"])

    def wider(self, asked: str, why: str | None) -> None:
        assert as_told(asked, self.file["asked"])
        assert self.file["known"] > self.file["asked"]
        assert self.file["narrow"] is False
        assert why is None or self.file["whole"]

    def events(self, count: str, every: str, radius: str) -> None:
        text = (self.folder / "events.csv").read_text().splitlines()
        radii = [row["t_radius"] for row in csv.DictReader(text)]
        proved = [float(x) for x in radii if x]
        assert (int(count), int(every)) == (len(proved), len(radii)) == (self.file["events_proved"], len(radii))
        assert above(radius, max(proved))
        assert max(proved) == self.file["largest_event_radius"]

    def no_events(self) -> None:
        assert self.file["events_proved"] == 0
        assert self.table("events")

    def beyond(self, time: str, why: str) -> None:
        assert not self.file["whole"]
        assert float(time) == pytest.approx(self.file["reached"], rel=1e-5)
        words = {value: key.replace(" ", "_") for key, value in certificate.WHY.items()}
        reason = re.sub(r", \d+ steps took .*", "", why)
        assert words[reason] == self.file["ended"]
        pace = re.fullmatch(rf".*, (\d+) steps took {DURATION}, at this pace all would take {DURATION}", why)
        if pace is not None:
            assert int(pace[1]) == self.file["steps"]
            whole = self.table("trajectory")[-1]["t"] / self.file["reached"]
            assert seconds_of(pace[3]) == pytest.approx(seconds_of(pace[2]) * whole, rel=0.1)

    def hold(self, said: list[str], code: int) -> None:
        which = r"all \d+ rows|the first \d+ of \d+ rows"
        within = rf"the run is within ({N}) of the exact solution at ({which}) \(proved; of each quantity's size\)"
        known = (
            rf"the exact solution is known to ({N})(?: \(({N}) in the digits of a table\))? there: (\d+) steps of "
            r"(\d+) bits"
        )
        events = (
            rf"the exact solution has (\d+) of the run's (\d+) events, each once within ({N}) of its time \(proved\)"
        )
        counts = Told(said, code).matching(
            {
                within: self.within,
                known: self.known,
                rf"that is wider than the ({N}) that was asked for(?:: (.*))?": self.wider,
                events: self.events,
                "of the run's events none is proved to be one of the exact solution": self.no_events,
                rf"nothing is proved beyond t = ({N}): (.*)": self.beyond,
            }
        )
        one, two, wide, _, _, beyond = counts.values()
        assert one == two == (self.file["rows"] > 0)
        assert wide == (not self.file["narrow"])
        assert beyond == (not self.file["whole"])
        assert code == (0 if self.file["whole"] and self.file["narrow"] else 3)


#: Scene, time, width, and what else is asked: of a chaotic motion, of little time, of events.
PROVED: list[tuple[str, float, float, tuple[object, ...]]] = [
    *((name, scene.time / 2, 1e-10, ()) for name, scene in SCENES.items() if name != "coulomb"),
    ("kepler", 7.0, 1e-17, ("--event", "x = 0")),
    ("growth", 10.0, 1e-6, ()),
    ("dpchaos", 20.0, 1e-10, ("--certify-seconds", 1.0)),
]


def certificate_of(name: str, time: float, width: float, more: tuple[object, ...], folder: Path) -> tuple[Any, ...]:
    path = filed(folder / "scene.yaml", SCENES[name].text)
    words = ("--time", time, "--samples", 101, "--format", "csv", "--certify", width, *more, "--out", folder)
    done = invoked("simulate", path, *words)
    file = json.loads((folder / "simulation.json").read_text(encoding="utf-8"))["certificate"]
    return Proof(file, folder), sections(done.output)["certified"], done.exit_code


@pytest.mark.parametrize(("name", "time", "width", "more"), PROVED)
def test_what_a_certificate_says_is_what_is_proved(
    name: str, time: float, width: float, more: tuple[object, ...], tmp_path: Path
) -> None:
    proof, said, code = certificate_of(name, time, width, more, tmp_path)
    proof.hold(said, code)


def test_a_proof_that_would_not_end_ends_at_its_counted_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A chaotic motion, two tries at the same: both come as far, by work and not by seconds, and say how far."""
    monkeypatch.setattr(fitting, "WORK", 2.0)
    found = [certificate_of("dpchaos", 100.0, 1e-10, (), tmp_path) for _ in range(2)]
    for proof, said, code in found:
        proof.hold(said, code)
        assert code == 3
        assert proof.file["ended"] == "too_dear"
        assert 0 < proof.file["reached"] < 100
    assert found[0][0].file["reached"] == found[1][0].file["reached"]


def test_a_number_that_is_changed_anywhere_in_a_certificate_is_found(tmp_path: Path) -> None:
    proof, said, code = certificate_of("kepler", 7.0, 1e-17, ("--event", "x = 0"), tmp_path)
    places = [(place, other) for place, line in enumerate(said) for other in altered(line)]
    assert len(places) > 6
    for place, other in places:
        with pytest.raises((AssertionError, ValueError)):
            proof.hold([*said[:place], other, *said[place + 1 :]], code)


# --- ledger ---

TITLES = {
    "ledger: left out because this scene does not need it": "not needed",
    "ledger: left out; whether this scene needs it depends on the accuracy (--accuracy X --until T)": "open",
    "ledger: left out although this scene needs it at this accuracy": "needed",
}

#: What the first number of a line counts is what its first measure saved.
SAVED = {
    "dead instructions": r"(\d+) operations",
    "parameters only": r"(\d+) subexpressions",
    "symmetry of M": r"(\d+) entries below the diagonal",
    "sparsity of M": r"(\d+) entries of M",
}
#: Each thing that is named saves so much of the first measure.
EACH = {
    "cyclic coordinates": 2,
    "coordinates that rest": 1,
    "plane motion": 1,
    "parameters that drop out": 1,
}
CHANGES = rf"until ({N}) it changes the motion by ({N}) of its size, (no more|more) than the ({N}) that a model may"


@dataclass
class Savings:
    """``ledger`` of ``results.json``, and what was asked of it; ``parameters`` and ``coordinates`` of the system."""

    file: dict[str, Any]
    accuracy: float
    until: float
    parameters: int
    coordinates: frozenset[str]

    def hold(self, output: list[str]) -> None:
        begun = next(k for k, line in enumerate(output) if line.strip() in TITLES)
        left, standing, groups = list(self.file["savings"]), "", list[tuple[str, list[str]]]()
        nothing = False
        for line in output[begun:]:
            text = line.strip()
            if text in TITLES:
                standing = TITLES[text]
            elif re.match(r"  \S", line) and "  " in text:
                groups.append((standing, list(re.split(r"  +", text, maxsplit=1))))
            elif text == "nothing":
                nothing = True
            elif text.startswith("not measured, beyond the budget: "):
                assert text.removeprefix("not measured, beyond the budget: ").split(", ") == self.file["not_measured"]
            elif not text.startswith("results.json") and "(files there" not in text:
                groups[-1][1].append(text)
        assert nothing is not any(one == "not needed" for one, _ in groups)
        for standing, (kind, what, why, *measures) in groups:
            names = ", ".join if kind != "order of gravity" else " ".join
            saving = next(x for x in left if x["kind"] == kind and self.named(what) == self.named(names(x["what"])))
            left.remove(saving)
            assert standing == saving["standing"]
            assert why == f"{saving['why']} ({saving['how']})"
            self.reason(saving)
            self.counted(saving)
            clear = [x for x in saving["measures"] if self.clear(x)]
            assert len(measures) == len(clear)
            for text, measure in zip(measures, clear, strict=True):
                self.measure(text, measure)
        assert not left

    def named(self, text: str) -> list[str]:
        """At most eight names, and how many more there are."""
        names = text.split(", ")
        more = re.fullmatch(r"(.*) and (\d+) more", names[-1])
        if more is not None:
            return [*names[:-1], more[1], f"+{more[2]}"]
        return names if len(names) <= 9 else [*names[:8], f"+{len(names) - 8}"]

    def clear(self, measure: dict[str, Any]) -> bool:
        """Counts that differ; of two times of the same kind only what noise is not."""
        one, two = measure["without"], measure["with"]
        if measure["unit"] != "seconds":
            return bool(one != two)
        return max(one, two) > 2 * min(one, two) and abs(one - two) > 0.1

    def measure(self, text: str, measure: dict[str, Any]) -> None:
        match = re.fullmatch(rf"(.*): ({N}) instead of (more than )?({N})( \(costs more\))?", text)
        assert match is not None, text
        assert match[1] == measure["quantity"]
        for told, value in ((match[2], measure["with"]), (match[4], measure["without"])):
            assert as_told(told, value) if measure["unit"] == "seconds" else int(told) == value
        assert (match[3] is not None) is measure["at_least"]
        assert (match[5] is not None) is (not measure["at_least"] and measure["with"] > measure["without"])

    def reason(self, saving: dict[str, Any]) -> None:
        """An error is held against what is tolerable, and decides; what is proved needs none."""
        error, most = saving["error"], saving["tolerable"]
        match = re.search(CHANGES, saving["why"])
        assert (match is not None) is (error is not None)
        if match is None:
            assert (saving["standing"] == "not needed") is (saving["how"] in ("proved", "verified numerically"))
            return
        assert float(match[1]) == self.until
        assert as_told(match[2], error)
        assert match[3] == ("no more" if error <= most else "more")
        assert float(match[4]) == most <= self.accuracy
        assert saving["standing"] == ("not needed" if error <= most else "needed")
        assert saving["how"] != "proved"

    def counted(self, saving: dict[str, Any]) -> None:
        """Numbers in what is left out, beside those of what that saved."""
        kind, what, first = saving["kind"], saving["what"], saving["measures"][0]
        saved = first["without"] - first["with"]
        assert any(x["without"] > x["with"] for x in saving["measures"] if x["unit"] != "seconds")
        if kind in SAVED:
            match = re.fullmatch(SAVED[kind], what[0])
            assert match is not None
            assert int(match[1]) == saved
        elif kind in EACH:
            assert saved == EACH[kind] * len(what)
        elif kind == "values put in":
            assert what == [f"{self.parameters} parameters"]
        elif kind == "entries that vanish":
            assert what[0] == f"{saved} of {first['without']} entries"
            assert first["without"] == 5 * len(self.coordinates) ** 2
        elif kind == "subsystems":
            parts = [part.strip("{}").split(", ") for part in what]
            assert sorted(chain(*parts)) == sorted(self.coordinates)


def savings(path: Path, folder: Path, accuracy: float, until: float) -> tuple[Savings, list[str]]:
    options = ("--ledger", "--accuracy", accuracy, "--until", until, "--format", "json", "--out", folder, "-v")
    done = invoked("run", path, *options)
    file, system = json.loads((folder / "results.json").read_text(encoding="utf-8"))["ledger"], mbsym.load(path).system
    return Savings(
        file, accuracy, until, len(system.parameter_names), frozenset(system.coordinates)
    ), done.output.splitlines()


SHIPPED = {"satellite": 5.0, "dumbbell": 5.0, "double-pendulum": 5.0}


@pytest.mark.parametrize("name", [*SCENES, *SHIPPED])
def test_what_a_ledger_says_is_what_was_counted(name: str, tmp_path: Path) -> None:
    if name in SHIPPED:
        path, until = ROOT / "systems" / f"{name}.yaml", SHIPPED[name]
    else:
        path, until = filed(tmp_path / "scene.yaml", SCENES[name].text), SCENES[name].time
    found, lines = savings(path, tmp_path / "out", 1e-6, until)
    found.hold(lines)


def test_a_number_that_is_changed_anywhere_in_a_ledger_is_found(tmp_path: Path) -> None:
    found, lines = savings(ROOT / "systems" / "dumbbell.yaml", tmp_path / "out", 1e-6, 5.0)
    begun = next(k for k, line in enumerate(lines) if line.strip() in TITLES)
    places = [(k, x) for k, line in enumerate(lines) if k > begun and "files there" not in line for x in altered(line)]
    assert len(places) > 40
    for place, other in places:
        with pytest.raises((AssertionError, ValueError, StopIteration)):
            found.hold([*lines[:place], other, *lines[place + 1 :]])
