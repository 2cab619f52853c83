"""The truth suite, extremes: borders of stability that are told, against conditions solved by hand."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import pytest
from truth.statements import ASYMPTOTIC, UNSTABLE

import mbsym
from mbsym.mechanics.variables import ring_of
from mbsym.numerics.extremes.extremes import extremes
from mbsym.numerics.extremes.extremes_told import sentences
from mbsym.numerics.scenario import scenario

SENTENCE = re.compile(r"(\w+) -> ([-+.\de]+): a border of the first approximation, ([a-z ]+) below and ([a-z ]+) above")


@dataclass(frozen=True)
class Region:
    """A description, its values, whether the motion is asymptotically stable there (else it is unstable), and the
    parameters that have a border.
    """

    text: str
    values: Mapping[str, float]
    stable: Callable[[Mapping[str, float]], bool]
    bordered: frozenset[str]

    def nature(self, name: str, value: float) -> str:
        return ASYMPTOTIC if self.stable({**self.values, name: value}) else UNSTABLE


HELD = Region(  # x'' + c x' + (k - g) x = 0
    """
mbsym: 1
name: held
parameters: {k: positive, g: positive, c: real}
bodies:
  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - potential: (k - g)*x**2/2
  - rayleigh: c*x_dot**2/2
motion: {x: 0}
values: {k: 3, g: 2, c: 1}
initial: {x: 0.1}
""",
    {"k": 3.0, "g": 2.0, "c": 1.0},
    lambda p: p["k"] > p["g"] and p["c"] > 0,
    frozenset("kg"),
)
FOLLOWED = Region(  # z'' + d z' + (k + i n) z = 0 with z = x + i y: all roots to the left iff d > 0 and k d^2 > n^2
    """
mbsym: 1
name: followed
parameters: {k: positive, d: positive, n: positive}
bodies:
  - {name: p, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
loads:
  - potential: k*(x**2 + y**2)/2
  - rayleigh: d*(x_dot**2 + y_dot**2)/2
  - generalized force: {x: n*y, y: -n*x}
motion: {x: 0, y: 0}
values: {k: 1, d: 1, n: 1/2}
initial: {x: 0.1, y: 0.2}
""",
    {"k": 1.0, "d": 1.0, "n": 0.5},
    lambda p: p["d"] > 0 and p["k"] * p["d"] ** 2 > p["n"] ** 2,
    frozenset("kdn"),
)


def false_border(region: Region, name: str, value: float, below: str, above: str) -> list[str]:
    """What is wrong with the sentence: beside the value, a thousandth of it away, both words must be true."""
    near = 1e-3 * abs(value) or 1e-3
    sides = ((value - near, below), (value + near, above))
    return [f"{name} = {at} is {region.nature(name, at)}" for at, word in sides if word != region.nature(name, at)]


@pytest.mark.parametrize("region", [HELD, FOLLOWED], ids=["held", "followed"])
def test_every_border_that_is_told_is_one(region: Region) -> None:
    system = mbsym.loads(region.text).system
    told = " ".join(sentences(extremes(scenario(system), ring_of(system), {}, budget=20.0)))
    found = [(name, float(value), below, above) for name, value, below, above in SENTENCE.findall(told)]
    assert {name for name, *_ in found} >= region.bordered
    for name, value, below, above in found:
        assert below != above
        assert false_border(region, name, value, below, above) == []
        # Planted lies: the words exchanged, the value off by one part in a hundred.
        assert false_border(region, name, value, above, below)
        assert false_border(region, name, value * 1.01 + 0.01, below, above)
