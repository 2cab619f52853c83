"""``mbsym simulate --continue``: a run that goes on is the run in one go, and what cannot be gone on from is said."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import SHIPPED, VAN_DER_POL, filed, invoked
from numerics.test_methods import POLE
from test_simulate import DOUBLE, mbsym, summary, table, written

from mbsym.numerics.kernels.interface import EXTENDED
from mbsym.numerics.kernels.llvm import available

HOW = {
    "dop853": ((), 2e-8),
    "rk45": (("--method", "rk45", "--tolerance", "1e-8"), 1e-5),
    "rk4": (("--method", "rk4", "--step", "0.01"), 1e-12),
    "midpoint4": (("--method", "midpoint4", "--step", "0.01"), 1e-11),
    "lsoda": (("--method", "lsoda", "--tolerance", "1e-8"), 1e-4),
    "extended": (("--arithmetic", "extended"), 1e-11),
}


def part(folder: Path, end: object, *more: object) -> Any:
    return mbsym(DOUBLE, "--time", end, "-f", "csv", "--no-estimate", "--out", folder, *more)


@pytest.mark.parametrize("name", HOW)
def test_two_parts_are_one_run(name: str, tmp_path: Path) -> None:
    """The same table: equal times, and states to rounding with steps of one length, else within the tolerance.

    The way it is integrated is that of the first part, though only there it was asked for.
    """
    how, allowed = HOW[name]
    if name == "extended" and not available(EXTENDED):
        pytest.skip("no extended arithmetic here")
    assert part(tmp_path / "first", 3, "--every", "0.02", *how).exit_code == 0
    kept = table(tmp_path / "first" / "trajectory.csv")
    done = part(tmp_path / "first", 6, "--continue", tmp_path / "first" / "simulation.json")
    assert done.exit_code == 0, done.output
    assert "from t = 3; rows before it: 151" in done.stdout
    assert part(tmp_path / "whole", 6, "--every", "0.02", *how).exit_code == 0
    joined, whole = table(tmp_path / "first" / "trajectory.csv"), table(tmp_path / "whole" / "trajectory.csv")
    assert list(joined) == list(whole)
    assert np.array_equal(joined["t"], whole["t"])
    for column, values in joined.items():
        # The table has float64: energies of extended states are not those of the states in it.
        same = np.allclose(values[:151], kept[column], rtol=1e-15, atol=1e-14 * (name == "extended"))
        assert same or column == "relative_drift"
        assert np.abs(values - whole[column]).max() < allowed
    told, other = summary(tmp_path / "first"), summary(tmp_path / "whole")
    assert told["continued"] == {"from": 3.0, "samples": 151}
    assert other["continued"] is None
    for key in ("method", "arithmetic", "tolerance", "step", "status"):
        assert key == "method" or told[key] == other[key]
    assert told["method"]["name"] == other["method"]["name"]


def test_an_extended_state_is_kept_to_its_last_bit(tmp_path: Path) -> None:
    if not available(EXTENDED):
        pytest.skip("no extended arithmetic here")
    part(tmp_path, 1, "--arithmetic", "extended", "--samples", 3)
    state = summary(tmp_path)["reached"]["state"]
    assert all(isinstance(text, str) for text in state.values())
    exact = [np.longdouble(text) for text in state.values()]
    assert [float(x) for x in exact] == [table(tmp_path / "trajectory.csv")[name][-1] for name in state]
    assert any(x != np.longdouble(float(x)) for x in exact)


def test_a_run_that_was_cut_short_goes_on(tmp_path: Path) -> None:
    """After a step limit, with another method, rows at other times, and twice over."""
    cut = mbsym(DOUBLE, "--time", 20, "--every", "0.1", "--step-limit", 60, "-f", "csv", "--out", tmp_path)
    assert cut.exit_code == 3
    reached = summary(tmp_path)["reached"]
    assert 0 < reached["time"] < 20
    on = part(tmp_path, 10, "--continue", tmp_path / "simulation.json", "--method", "rk45", "--tolerance", "1e-9")
    assert on.exit_code == 0, on.output
    assert written(tmp_path) == {"trajectory.csv", "simulation.json"}
    assert summary(tmp_path)["method"]["name"] == "rk45"
    on = part(tmp_path, 12, "--continue", tmp_path / "simulation.json", "--samples", 4)
    assert on.exit_code == 0, on.output
    times = table(tmp_path / "trajectory.csv")["t"]
    assert np.allclose(times[-5:], [10, 10.5, 11, 11.5, 12], rtol=0, atol=1e-12)
    assert np.all(np.diff(times) > 0)
    part(tmp_path / "whole", 12, "--samples", 2)
    end, truth = table(tmp_path / "trajectory.csv"), table(tmp_path / "whole" / "trajectory.csv")
    assert end["theta1"][-1] == pytest.approx(truth["theta1"][-1], abs=1e-4)


@pytest.fixture(scope="module")
def earlier(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("earlier")
    assert part(folder, 1, "--samples", 11).exit_code == 0
    return folder


def changed(key: str, value: object) -> Callable[[dict[str, Any]], object]:
    def change(content: dict[str, Any]) -> object:
        place, _, inner = key.partition(".")
        if inner:
            content[place][inner] = value
        else:
            content[place] = value
        return content

    return change


STATE = ("theta1", "theta2", "theta1_dot", "theta2_dot")

WRONG: dict[str, tuple[Callable[[dict[str, Any]], object], str]] = {
    "a list": (lambda content: [content], "not a simulation.json of this version"),
    "another format": (changed("format", 2), "not a simulation.json of this version"),
    "another description": (changed("description_sha256", "0" * 64), "its hash differs"),
    "no state": (lambda content: content["reached"].pop("state") and content, "older than --continue: reached.state"),
    "a state of lists": (changed("reached.state", {name: [] for name in STATE}), "damaged"),
    "state of others": (changed("reached.state", {"x": 1.0}), "not that of these coordinates"),
    "no numbers": (
        changed("reached.state", dict.fromkeys(STATE, "x")),
        "no number",
    ),
    "not finite": (changed("reached.time", "inf"), "not finite"),
    "other rows": (changed("reached.samples", 12), "12 rows are wanted"),
    "samples of text": (changed("reached.samples", "11"), "damaged, or older than --continue: reached.samples"),
    "no table": (changed("files", ["histories.svg"]), "wrote no table"),
    "an unknown method": (changed("method.name", "euler"), "no method euler"),
    "an unknown arithmetic": (changed("arithmetic", "decimal"), "no method dop853 in decimal"),
    "ended at a pole": (changed("ended", {"kind": "blow-up", "message": "", "time": 1.0}), "ended with blow-up"),
    "another end": (changed("reached.time", 0.99), "does not end where that run did"),
    "other values": (changed("parameters.m1", 7.0), "m1 was 7.0 and is 1.0"),
    "another start": (changed("initial.theta1", 7.0), "theta1 was 7.0 and is"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_cannot_be_gone_on_from_is_refused(name: str, earlier: Path, tmp_path: Path) -> None:
    change, said = WRONG[name]
    content = change(json.loads((earlier / "simulation.json").read_text(encoding="utf-8")))
    (tmp_path / "simulation.json").write_text(json.dumps(content), encoding="utf-8")
    (tmp_path / "trajectory.csv").write_bytes((earlier / "trajectory.csv").read_bytes())
    done = part(tmp_path / "out", 2, "--continue", tmp_path / "simulation.json")
    assert done.exit_code == 2, done.output
    assert "--continue: error[unfit-run]" in done.stderr
    assert said in done.stderr
    assert "Traceback" not in done.output
    assert not (tmp_path / "out").exists()


def test_damaged_files_are_refused(earlier: Path, tmp_path: Path) -> None:
    """Cut off anywhere, one number changed, no text at all, missing."""
    told, rows = (earlier / "simulation.json").read_bytes(), (earlier / "trajectory.csv").read_bytes()
    middle = rows.index(b"\n") + 3
    for json_file, csv_file in [
        *((told[: len(told) * k // 7], rows) for k in range(7)),
        *((told, rows[: len(rows) * k // 7]) for k in range(7)),
        (b"\xff\xfe\x00" * 10, rows),
        (told, b"\xff\xfe\x00" * 10),
        (told, rows[:-8] + b"9" + rows[-7:]),
        (told, rows[:middle] + b"x" + rows[middle:]),
        (told, None),
    ]:
        (tmp_path / "simulation.json").write_bytes(json_file)
        (tmp_path / "trajectory.csv").unlink(missing_ok=True)
        if csv_file is not None:
            (tmp_path / "trajectory.csv").write_bytes(csv_file)
        done = part(tmp_path / "out", 2, "--continue", tmp_path / "simulation.json")
        assert done.exit_code == 2, done.output
        assert "error[unfit-run]" in done.stderr


def test_a_state_changed_inside_the_table_is_noticed(earlier: Path, tmp_path: Path) -> None:
    """A digit of a state in the middle: times, number of rows and last state are what they were."""
    (tmp_path / "simulation.json").write_bytes((earlier / "simulation.json").read_bytes())
    lines = (earlier / "trajectory.csv").read_text(encoding="utf-8").splitlines(keepends=True)
    cells = lines[5].split(",")
    cells[1] = repr(float(cells[1]) + 1e-3)
    (tmp_path / "trajectory.csv").write_text("".join([*lines[:5], ",".join(cells), *lines[6:]]), encoding="utf-8")
    done = part(tmp_path / "out", 2, "--continue", tmp_path / "simulation.json")
    assert done.exit_code == 2, done.output
    assert "has been changed since that run wrote it" in done.stderr
    (tmp_path / "trajectory.csv").write_bytes((earlier / "trajectory.csv").read_bytes())
    assert part(tmp_path / "out", 2, "--continue", tmp_path / "simulation.json").exit_code == 0


def test_it_goes_on_in_the_model_of_the_earlier_run(tmp_path: Path) -> None:
    """Without gravity is not said again; another model is refused; rows are those of one run of that model."""
    assert part(tmp_path / "first", 1, "--samples", 11, "--without", "g").exit_code == 0
    on = ("--continue", tmp_path / "first" / "simulation.json")
    other = part(tmp_path / "no", 2, *on, "--without", "m1")
    assert other.exit_code == 2
    assert "--without does not go with --continue: that run was one of another model: without g" in other.stderr
    assert part(tmp_path / "second", 2, *on).exit_code == 0
    assert part(tmp_path / "whole", 2, "--samples", 21, "--without", "g").exit_code == 0
    joined, whole = table(tmp_path / "second" / "trajectory.csv"), table(tmp_path / "whole" / "trajectory.csv")
    assert np.abs(joined["theta2"] - whole["theta2"]).max() < 1e-8
    assert summary(tmp_path / "second")["model"]["without"] == ["g"]


def test_events_of_the_earlier_part_are_not_denied(tmp_path: Path) -> None:
    """theta1 passes zero before t = 1 and not again soon: a run that goes on says from when it has watched."""
    watched = ("--event", "theta1 = 0")
    assert part(tmp_path / "first", 1, "--samples", 11, *watched).exit_code == 0
    rows = table(tmp_path / "first" / "trajectory.csv")
    assert np.any(np.diff(np.sign(rows["theta1"])))
    on = ("--continue", tmp_path / "first" / "simulation.json")
    done = part(tmp_path / "second", "101/100", *on, *watched)
    assert done.exit_code == 0, done.output
    assert "never; watched from t = 1 on" in done.stdout


def test_what_the_earlier_method_has_no_use_for_is_refused(tmp_path: Path) -> None:
    assert part(tmp_path / "first", 1, "--samples", 11, "--method", "rk4", "--step", "0.01").exit_code == 0
    on = ("--continue", tmp_path / "first" / "simulation.json")
    done = part(tmp_path / "no", 2, *on, "--tolerance", "1e-6", "--max-step", "0.1", "--arithmetic", "extended")
    assert done.exit_code == 2
    for option in ("--tolerance", "--max-step", "--arithmetic"):
        assert f"{option} does not go with --continue" in done.stderr
    changed = part(tmp_path / "second", 2, *on, "--method", "dop853", "--tolerance", "1e-6")
    assert changed.exit_code == 0
    assert summary(tmp_path / "second")["tolerance"] == 1e-6


def test_everything_wrong_is_said_at_once(earlier: Path, tmp_path: Path) -> None:
    done = part(tmp_path / "out", "1/2", "--continue", earlier / "simulation.json", "--set", "m1=3", "--set", "g=2")
    assert done.exit_code == 2
    assert "that run is at t = 1 already" in done.stderr
    assert "m1 was 1.0 and is 3.0" in done.stderr
    assert "g was" in done.stderr
    other = mbsym(SHIPPED / "heavy-top.yaml", "--time", 2, "--continue", earlier / "simulation.json", "--out", tmp_path)
    assert other.exit_code == 2
    assert "its hash differs" in other.stderr


def test_nothing_goes_on_after_a_pole(tmp_path: Path) -> None:
    path = filed(tmp_path / "pole.yaml", POLE)
    assert mbsym(path, "--time", 2, "-f", "csv", "--out", tmp_path / "out").exit_code == 3
    done = mbsym(path, "--time", 3, "-f", "csv", "--continue", tmp_path / "out" / "simulation.json", "--out", tmp_path)
    assert done.exit_code == 2
    assert "there is nothing to go on from" in done.stderr


def test_a_run_that_ended_stiff_goes_on_by_its_last_method(tmp_path: Path) -> None:
    """On the slow branch x' (1 - x^2) mu = x but for O(1/mu^2): log x - x^2/2 grows by t/mu (Hairer & Wanner II, IV.1).

    An explicit method would take 1e5 steps and more for a unit of time there.
    """
    path = filed(tmp_path / "pol.yaml", VAN_DER_POL)
    limit = ("-f", "csv", "--no-estimate", "--step-limit", "20000", "--out", tmp_path)
    assert mbsym(path, "--time", 10000, "--every", 1000, *limit).exit_code == 0
    first = summary(tmp_path)
    assert first["method"]["may_change"]
    assert first["method_changes"][-1]["method"] == "rodas5p"
    done = mbsym(path, "--time", 30000, "--continue", tmp_path / "simulation.json", *limit)
    assert done.exit_code == 0, done.output
    told = summary(tmp_path)
    assert told["method"]["name"] == "rodas5p"
    assert told["method"]["may_change"]
    rows = table(tmp_path / "trajectory.csv")
    late = rows["t"] >= 9999
    x, t = rows["x"][late], rows["t"][late]
    course = np.log(np.abs(x)) - x**2 / 2
    assert len(t) == 21
    assert np.allclose(course - course[0], (t - t[0]) / 1e5, rtol=0, atol=1e-6)
    told["method_changes"] = [{}]
    (tmp_path / "simulation.json").write_text(json.dumps(told), encoding="utf-8")
    refused = mbsym(path, "--time", 40000, "--continue", tmp_path / "simulation.json", *limit)
    assert refused.exit_code == 2
    assert "method_changes" in refused.output


def test_a_run_is_continued_in_its_own_variables(tmp_path: Path) -> None:
    """In those that are declared, or in coordinates; one cannot go on in the other's."""
    name = SHIPPED / "clebsch-poisson.yaml"
    kinds: dict[str, tuple[str, ...]] = {"declared": (), "coordinates": ("--variables", "coordinates")}
    for kind, options in kinds.items():
        words = ("--time", "1", "--format", "csv", "--no-estimate", "--out", str(tmp_path / kind), *options)
        assert mbsym(name, *words).exit_code == 0
    for kind, options in kinds.items():
        for earlier in kinds:
            file = str(tmp_path / earlier / "simulation.json")
            words = ("--time", "2", "--format", "csv", "--no-estimate", "--out", str(tmp_path / "longer"), *options)
            done = mbsym(name, *words, "--continue", file)
            assert done.exit_code == (0 if earlier == kind else 2), done.output


def test_a_rest_is_continued_as_one(tmp_path: Path) -> None:
    """Upright at pi: what was not integrated is not integrated further, and roundings do not begin to grow."""
    text = (SHIPPED / "simple-pendulum.yaml").read_text(encoding="utf-8")
    (tmp_path / "p.yaml").write_text(text, encoding="utf-8")
    words = ["simulate", tmp_path / "p.yaml", "--set", "theta=pi", "--set", "theta_dot=0", "--format", "csv"]
    invoked(*words, "--time", "20", "--out", tmp_path / "a", code=0)
    invoked(*words, "--time", "60", "--continue", tmp_path / "a" / "simulation.json", "--out", tmp_path / "b", code=0)
    last = (tmp_path / "b" / "trajectory.csv").read_text(encoding="utf-8").splitlines()[-1].split(",")
    assert [float(x) for x in last[:3]] == [60, np.pi, 0]
