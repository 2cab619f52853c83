"""The options that repeat a run say everything that the request says: read again they are the same request."""

from __future__ import annotations

import shlex

import mbsym
from mbsym.report.runs.plan_words import repeating_command, repeating_options
from mbsym.simulation import Request
from mbsym.simulation.watching import Watch, read_watch

PENDULUM = """
mbsym: 1
name: p
bodies:
  - {name: rod, attached to: 0, rotation: {axes: [2], angles: [a]}, coordinates: [a], mass center: [0, 0, -1], mass: 1}
loads:
  - uniform gravity: {vector: [0, 0, -9.81]}
initial: {a: 1}
"""


def _values(options: list[str], name: str) -> list[str]:
    return [options[place + 1] for place, word in enumerate(options) if word == name]


def test_events_stops_and_sections_are_read_back_as_they_were() -> None:
    system = mbsym.loads(PENDULUM).system
    watch = read_watch(
        system,
        events=("top: a = 0 rising", "a_dot > 1/2"),
        stops=("a < -1/2",),
        section="a = 0 mod 2*pi rising",
        axes="a mod 2*pi, a_dot",
    )
    options = repeating_options(Request(10.0, method="dop853", tolerance=1e-8, events=watch))
    again = read_watch(
        system,
        _values(options, "--event"),
        _values(options, "--stop"),
        _values(options, "--section")[0],
        _values(options, "--axes")[0],
    )
    assert again == watch
    assert again != Watch()
    words = shlex.split(repeating_command("my file.yaml", ["a=pi/3"], Request(10.0, events=watch)))
    assert words[:5] == ["mbsym", "simulate", "my file.yaml", "--set", "a=pi/3"]
    assert _values(words, "--event")[0] == "top: a = 0 rising"


def test_what_is_proved_counted_and_shown_besides_is_asked_for_again() -> None:
    request = Request(1.0, method="dop853", tolerance=1e-8, certify=1e-12, invariants=True, step_limit=500)
    options = repeating_options(request)
    assert _values(options, "--certify") == ["1e-12"]
    assert _values(options, "--step-limit") == ["500"]
    assert "--invariants" in options
    plain = repeating_options(Request(1.0, method="dop853", tolerance=1e-8))
    assert not {"--certify", "--step-limit", "--invariants", "--event"} & set(plain)
