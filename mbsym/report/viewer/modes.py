"""Linear modes about the unperturbed motion: shapes to look at, beside the verdict that is proved.

    (lambda^2 M + lambda (D + G) + K + N) x = 0

Roots are the certified ones of problem 6, in physical time.  Shapes x are computed in floating point: the directions
in which the pencil at the root's midpoint vanishes, coordinates measured by the square roots of their inertias.  A root
of multiplicity m has m of them, or fewer; where fewer, deviations grow like powers of t besides.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import hypot, inf, pi
from typing import Any

import numpy as np

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.roots import Root
from mbsym.analysis import Analysis
from mbsym.expressions.message import Message, joined, worded
from mbsym.mechanics.motion import motion_values
from mbsym.picture.encode import number
from mbsym.problems.linearisation import Linearisation
from mbsym.problems.stability.problem import matrices_at, parameter_values, ring_numbers
from mbsym.problems.stability.verdict import Verdict
from mbsym.problems.stability.words import sentence
from mbsym.report.documents import parts
from mbsym.report.documents.base import plain

#: A singular value of the pencil below this part of its largest belongs to a shape.
NULL = 1e-8

#: Roots nearer to each other than this, as a part of the largest, are one.
SAME = 1e-9


@dataclass(frozen=True)
class Mode:
    """``shape`` holds the complex deviations of the coordinates, the largest 1, those left out 0.

    lambda = ``real`` + i ``imaginary``, ``imaginary`` >= 0; a part that may be 0 in its enclosure is 0.  ``fewer``:
    there are fewer shapes than the root's ``multiplicity``.
    """

    real: float
    imaginary: float
    multiplicity: int
    fewer: bool
    shape: Mapping[str, complex]

    @property
    def frequency(self) -> float:
        """In cycles per unit of time."""
        return self.imaginary / (2 * pi)

    @property
    def damping(self) -> float:
        """-Re lambda/|lambda|; 0 at lambda = 0."""
        size = hypot(self.real, self.imaginary)
        return -self.real / size if size else 0.0


@dataclass(frozen=True)
class Modes:
    """``verdict`` on the motion whose coordinates at t = 0 are ``base``; ``turning`` run on at these rates.

    ``still``: coordinates that follow from constraints between velocities and have no place in a shape; those that
    follow from constraints between positions are left to whoever closes loops.
    """

    base: Mapping[str, float]
    turning: Mapping[str, float]
    verdict: Verdict
    modes: tuple[Mode, ...]
    still: tuple[str, ...] = ()


def modes(analysis: Analysis) -> Modes:
    """The modes at the values of a description.

    Raises Unavailable where problem 6 has no result, NoClosedForm where there are no numbers, or no motion, at them.
    """
    if analysis.system.speeds:
        analysis = analysis.in_coordinates
    stability = analysis.stability
    withdrawn = analysis.broken(type(analysis).stability.stands_on)
    if withdrawn is not None:
        raise NoClosedForm(withdrawn.reason)
    linear, scene = analysis.judgeable, analysis.parameters_scene
    values = parameter_values(scene, analysis.equilibrium)
    if values is None or stability.numerical is None:
        raise NoClosedForm("not all parameters have values, so that no mode has numbers")
    if not stability.spectra:
        reasons = [sentence(reason) for reason in stability.numerical.reasons] or [worded(stability.numerical.word)]
        raise NoClosedForm("at these values there are none: [[why]]", why=joined(reasons, " "))
    listed: list[Mode] = []
    for part in stability.spectra:
        blocks = [_floats(rows) for rows in matrices_at(scene, linear, part.coordinates, values)]
        listed += _modes(part.coordinates, part.roots, blocks)
    ring_values = ring_numbers(scene.ring, values)

    def value(x: Any) -> float:
        return float(scene.ring.evaluate(scene.lower(x), ring_values).mid())

    motion = motion_values(analysis.system)
    rates = {name: value(rate) for name, (_, rate) in motion.items()}
    return Modes(
        base={name: value(start) for name, (start, _) in motion.items()},
        turning={name: rate for name, rate in rates.items() if rate},
        verdict=stability.numerical,
        modes=tuple(sorted(listed, key=lambda x: (x.imaginary == 0, x.imaginary, x.real))),
        still=_still(linear),
    )


def _still(linear: Linearisation) -> tuple[str, ...]:
    return () if linear.about.holonomic else linear.about.dependent_coordinates


def _floats(rows: Sequence[Sequence[Any]]) -> Any:
    return np.array([[float(x.mid()) for x in row] for row in rows], dtype=float)


def _modes(coordinates: Sequence[str], roots: Sequence[Root], blocks: Sequence[Any]) -> Iterator[Mode]:
    """Those of one subsystem, a pair of conjugate roots once."""
    mass, damping, gyroscopic, stiffness, circulatory = blocks
    weights = np.sqrt(np.diag(mass))
    weights = np.where(weights > 0, weights, 1.0)
    for root, multiplicity in _grouped(roots):
        pencil = root * root * mass + root * (damping + gyroscopic) + stiffness + circulatory
        scaled = pencil / np.outer(weights, weights)
        _, sizes, rows = np.linalg.svd(scaled)
        size = _size(root, blocks, weights)
        shapes = [rows[k].conj() / weights for k in range(len(sizes)) if sizes[k] <= NULL * size] or [
            rows[-1].conj() / weights
        ]
        for shape in shapes[:multiplicity] if root.imag else shapes:
            largest = shape[int(np.argmax(np.abs(shape)))]
            yield Mode(
                root.real,
                root.imag,
                multiplicity,
                len(shapes) < multiplicity,
                {name: complex(x / largest) for name, x in zip(coordinates, shape, strict=True)},
            )


def _size(root: complex, blocks: Sequence[Any], weights: Any) -> float:
    """How large the pencil's terms are: beside that a singular value counts as zero."""
    mass, damping, gyroscopic, stiffness, circulatory = (np.abs(x) / np.outer(weights, weights) for x in blocks)
    terms = abs(root) ** 2 * mass + abs(root) * (damping + gyroscopic) + stiffness + circulatory
    return float(np.max(terms)) or inf


def _grouped(roots: Sequence[Root]) -> Iterator[tuple[complex, int]]:
    """Midpoints of the upper half with multiplicities; roots that lie together are one."""
    largest = max((abs(complex(x.ball.mid())) for x in roots), default=0.0)
    groups: list[tuple[complex, int]] = []
    for root in roots:
        parts = (0.0 if part.contains(0) else float(part.mid()) for part in (root.ball.real, root.ball.imag))
        value = complex(*parts)
        if value.imag < 0:
            continue
        for k, (other, count) in enumerate(groups):
            if abs(value - other) <= SAME * largest:
                groups[k] = other, count + root.multiplicity
                break
        else:
            groups.append((value, root.multiplicity))
    yield from groups


def modes_json(found: Modes) -> dict[str, Any]:
    """What a page reads."""
    return {
        "base": {name: number(value) for name, value in found.base.items()},
        "turning": {name: number(value) for name, value in found.turning.items()},
        "verdict": plain(parts.Verdict.from_result(found.verdict)),
        "still": list(found.still),
        "modes": [
            {
                "real": number(x.real),
                "imaginary": number(x.imaginary),
                "frequency": number(x.frequency),
                "damping": number(x.damping),
                "multiplicity": x.multiplicity,
                "fewer": x.fewer,
                "shape": {name: [number(v.real), number(v.imag)] for name, v in x.shape.items()},
            }
            for x in found.modes
        ],
        "sentences": list(_sentences(found)),
    }


def _sentences(found: Modes) -> Iterator[str]:
    word, theorems = found.verdict.word, found.verdict.theorems
    if theorems:
        theorem = joined(map(worded, theorems), ", ")
        yield Message("The motion at these values: [[word]] ([[theorem]]).", word=word, theorem=theorem)
    else:
        yield Message("The motion at these values: [[word]].", word=word)
    yield Message("Roots are enclosed, shapes are floating-point; a part of a root that may be 0 is told as 0.")
    yield Message("A mode that swings is shown large and with constant amplitude, whatever its damping.")
    if found.turning:
        text = "Deviations from a steady motion, which is held still: [[names]] turn in it."
        yield Message(text, names=", ".join(found.turning))
    if found.still:
        yield Message("Not moved, since velocities decide about them: [[names]].", names=", ".join(found.still))
    if any(x.fewer for x in found.modes):
        yield Message("Where a root has fewer shapes than its multiplicity, deviations grow like powers of t besides.")
