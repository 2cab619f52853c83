"""Studies as tables of arrays, for Python: the cost of accuracy, digits at the extremes, relative equilibria."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from html import escape
from math import inf
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mbsym.expressions.guessing import guess
from mbsym.expressions.tree import Expression
from mbsym.mechanics.rest import given_values, missing_values
from mbsym.numerics.extremes.extremes import Extremes
from mbsym.numerics.extremes.singular import SingularSet
from mbsym.numerics.trade.tradeoff import Study
from mbsym.problems.relative_equilibria.equilibria import Equilibria
from mbsym.studies.described import moving_system

if TYPE_CHECKING:
    from mbsym.analysis import Analysis

#: Rows of a table that a notebook shows.
SHOWN = 30


@dataclass(frozen=True, eq=False, repr=False)
class Table:
    """``columns`` names the ``arrays``, all of one length; text columns hold strings.  ``table["error"]`` is one."""

    columns: tuple[str, ...]
    arrays: tuple[np.ndarray[Any, Any], ...]

    @classmethod
    def of(cls, columns: Sequence[str], rows: Iterable[Sequence[object]]) -> Table:
        listed = [tuple(row) for row in rows]
        transposed = zip(*listed, strict=True) if listed else ((),) * len(columns)
        return cls(tuple(columns), tuple(map(_array, transposed)))

    @classmethod
    def about(cls, items: Iterable[object], columns: Mapping[str, str | Callable[[Any], object]]) -> Table:
        """A row for each item: attributes of it, ``work.steps``, or what functions make of it, by their titles."""
        cells = [attrgetter(column) if isinstance(column, str) else column for column in columns.values()]
        return cls.of(tuple(columns), ([cell(item) for cell in cells] for item in items))

    def __getitem__(self, name: str) -> np.ndarray[Any, Any]:
        """A column.  Raises KeyError for a name that is none, with a guess."""
        if name not in self.columns:
            raise KeyError(f"no column '{name}'{guess(name, self.columns)}")
        return self.arrays[self.columns.index(name)]

    def __len__(self) -> int:
        return len(self.arrays[0]) if self.arrays else 0

    def __iter__(self) -> Iterator[tuple[Any, ...]]:
        """Row by row."""
        return iter(zip(*self.arrays, strict=True))

    def __repr__(self) -> str:
        return f"Table({len(self)} rows: {', '.join(self.columns)})"

    def _repr_html_(self) -> str:
        head = "".join(f"<th>{escape(name)}</th>" for name in self.columns)
        rows = [
            "<tr>" + "".join(f"<td>{escape(_cell(value))}</td>" for value in row) + "</tr>"
            for row, _ in zip(self, range(SHOWN), strict=False)
        ]
        more = f"<caption>{SHOWN} of {len(self)} rows</caption>" if len(self) > SHOWN else ""
        return f"<table>{more}<tr>{head}</tr>{''.join(rows)}</table>"


def _array(values: Sequence[object]) -> np.ndarray[Any, Any]:
    """Text stays text of Python's own."""
    texts = any(isinstance(value, str) for value in values)
    return np.array(values, dtype=object) if texts else np.array(values)


def _cell(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, (float, np.floating)) else str(value)


@dataclass(frozen=True, repr=False)
class TradeoffStudy:
    """What accuracy costs.  ``runs``: one row a method, arithmetic and setting; ``models``: simpler models."""

    runs: Table
    models: Table
    advice: str
    reference_error: float
    study: Study

    @property
    def reference(self) -> str:
        """The two solutions whose difference is ``reference_error``."""
        return self.study.trade.reference.method

    def __repr__(self) -> str:
        return f"TradeoffStudy({self.advice})"

    def _repr_html_(self) -> str:
        return f"<p>{escape(self.advice)}</p>{self.runs._repr_html_()}"


@dataclass(frozen=True, repr=False)
class ExtremesStudy:
    """Digits kept at extremes.  ``digits``: one row a quantity and rung; ``verdicts``: stability at each rung.

    ``singular``: one row a value of a coordinate, or point of a set, at which the mass matrix is singular; ``fails``
    says whether the coordinates do or the model.  ``singular_complete``: it is proved that there are no others.
    """

    digits: Table
    verdicts: Table
    singular: Table
    singular_complete: bool
    sentences: tuple[str, ...]
    left_out: tuple[str, ...]
    study: Extremes

    def __repr__(self) -> str:
        return f"ExtremesStudy({len(self.digits)} measurements, {len(self.verdicts)} verdicts)"

    def _repr_html_(self) -> str:
        bullets = "".join(f"<li>{escape(sentence)}</li>" for sentence in self.sentences)
        return f"<ul>{bullets}</ul>{self.digits._repr_html_()}"


@dataclass(frozen=True, repr=False)
class EquilibriaStudy:
    """Relative equilibria.  ``table``: one row each, coordinates as doubles (nan: arbitrary), verdict, theorem, proof.

    ``complete``: the list is proved to be complete; otherwise ``remarks`` say what was not done.
    """

    table: Table
    complete: bool
    remarks: tuple[str, ...]
    study: Equilibria

    def __repr__(self) -> str:
        return f"EquilibriaStudy({len(self.table)} equilibria, {'complete' if self.complete else 'not complete'})"

    def _repr_html_(self) -> str:
        return self.table._repr_html_()


def tradeoff(
    source: str | Path | Analysis,
    time: float,
    *,
    target: float = 1e-9,
    values: Mapping[str, Fraction | float | str] | None = None,
    budget: float = 60.0,
    methods: Iterable[str] | None = None,
    models: bool = True,
) -> TradeoffStudy:
    """What accuracy costs from 0 to ``time`` on this machine: ``mbsym tradeoff``.

    ``study.runs`` is a table (``study.runs["error"]``, the largest over the whole interval), ``study.advice`` the
    sentence about ``target``; ``study.reference_error`` is that of the reference, ``study.reference`` says what it is.
    ``budget`` is counted work, worth so many seconds on a usual machine: the same runs are measured everywhere, and
    only their seconds are those of this machine.

    Raises DescriptionError, ValueError, ``mbsym.numerics.scenario.Incomplete``; Breakdown where there is no reference
    solution up to ``time``.
    """
    from mbsym.numerics.methods.table import METHODS
    from mbsym.numerics.scenario import scenario
    from mbsym.numerics.trade.tradeoff import advice, studied
    from mbsym.simulation import read_values

    system = moving_system(source)
    names = tuple(METHODS if methods is None else methods)
    for name in names:
        if name not in METHODS:
            raise ValueError(f"there is no method '{name}'{guess(name, METHODS)}")
    motion = scenario(system, read_values(system, values or {}), declared=True)
    study = studied(motion, [METHODS[name] for name in names], time, budget, models)
    drifts: dict[str, Callable[[Any], object]] = {
        "constraint_drift": lambda row: (row.strayed or (inf, inf))[0],
        "constraint_velocity_drift": lambda row: (row.strayed or (inf, inf))[1],
    }
    runs = Table.about(
        study.trade.rows,
        {
            "method": "method.traits.name",
            "arithmetic": "scalar",
            "tolerance": lambda row: _or_nan(row.setting.tolerance),
            "step": lambda row: _or_nan(row.setting.step),
            "error": "error",
            "drift": "drift",
            **(drifts if system.constraints else {}),
            "evaluations": "work.evaluations",
            "steps": "work.steps",
            "seconds": "seconds",
            "front": "front",
        },
    )
    compared = Table.about(study.models, {name: name for name in ("model", "error", "operations", "seconds")})
    return TradeoffStudy(runs, compared, advice(study.trade, target), study.trade.reference.error, study)


def extremes(
    source: str | Path | Analysis, *, values: Mapping[str, Fraction | float | str] | None = None, budget: float = 60.0
) -> ExtremesStudy:
    """How many digits each quantity keeps at the extremes, as far as ``budget`` goes: ``mbsym extremes``.

    ``budget`` is counted work, worth about so many seconds on a usual machine: the same rows come out everywhere.

    Raises DescriptionError, ValueError, ``mbsym.numerics.scenario.Incomplete``.
    """
    from mbsym.mechanics.variables import ring_of
    from mbsym.numerics.extremes.extremes import extremes as measured
    from mbsym.numerics.extremes.extremes_told import sentences
    from mbsym.numerics.kernels.interface import FLOAT32, FLOAT64
    from mbsym.numerics.scenario import scenario
    from mbsym.simulation import read_values

    system = moving_system(source)
    read: dict[str, Expression] = read_values(system, values or {})
    result = measured(scenario(system, read), ring_of(system), read, budget)
    rung = {name: name for name in ("kind", "subject", "size")}
    digits = Table.about(
        result.rows,
        {
            **rung,
            "quantity": "quantity",
            "digits_float64": lambda row: row.digits.digits[FLOAT64],
            "digits_float32": lambda row: row.digits.digits[FLOAT32],
            "condition": "digits.condition",
            "loses": "digits.verdict",
        },
    )
    verdicts = Table.about(
        result.verdicts,
        {
            **rung,
            "verdict": "judged.exact.word.value",
            "theorem": "judged.exact.theorem",
            "float64_wrong": lambda row: row.judged.wrong(FLOAT64),
        },
    )
    where = result.singularities
    singular = Table.of(
        ("where", "fails", "joint", "proved"),
        (
            (
                " and ".join(f"{name} = {_label(singular_set, number, name)}" for name in place),
                singular_set.kind,
                singular_set.joint,
                singular_set.proved,
            )
            for singular_set in (where.sets if where is not None else ())
            for number, place in enumerate(singular_set.places)
        ),
    )
    complete = where is not None and where.complete
    return ExtremesStudy(digits, verdicts, singular, complete, tuple(sentences(result)), result.left_out, result)


def _label(locus: SingularSet, number: int, name: str) -> str:
    """A value of a set's coordinate, exact where it is known."""
    return locus.values[number].label if locus.values else f"{float(locus.places[number][name]):.12g}"


def equilibria(
    source: str | Path | Analysis, *, values: Mapping[str, Fraction | int | str] | None = None, within: float = 10.0
) -> EquilibriaStudy:
    """All relative equilibria at exact values of the parameters, each with its verdict: ``mbsym equilibria``.

        >>> import mbsym
        >>> found = mbsym.equilibria("systems/double-pendulum.yaml")
        >>> found.complete, list(found.table["verdict"])
        (True, ['stable', 'unstable', 'unstable', 'unstable'])

    Raises DescriptionError, ValueError for a parameter without a number, Failure where they cannot be listed.
    """
    from mbsym.analysis.resting import relative_equilibria

    system = moving_system(source)
    exact: dict[str, Fraction] = {}
    for name, value in (values or {}).items():
        if name not in system.parameter_names:
            raise ValueError(f"unknown parameter '{name}'{guess(name, system.parameter_names)}")
        if isinstance(value, float):
            raise ValueError(f"equilibria are exact: write Fraction('{value}') for {name}")
        exact[name] = Fraction(value)
    numbers = given_values(system, exact)
    missing = missing_values(system, numbers)
    if missing:
        raise ValueError(f"no number for {', '.join(missing)}")
    equilibrium_set = relative_equilibria(system, numbers, within)
    rates = {x.name for each in equilibrium_set.equilibria for x in each.values if x.name in system.velocities}
    names = (*system.coordinates, *(name for name in system.velocities if name in rates))

    def row(equilibrium: Any) -> tuple[object, ...]:
        known = {item.name: item.value for item in equilibrium.values}
        coordinates = (float(known.get(name, np.nan)) for name in names)
        verdict = (equilibrium.verdict.word.value, equilibrium.verdict.theorem)
        return (*coordinates, *verdict, equilibrium.proof, equilibrium.coordinates_of)

    table = Table.of((*names, "verdict", "theorem", "proof", "angles_of"), map(row, equilibrium_set.equilibria))
    return EquilibriaStudy(table, equilibrium_set.complete, equilibrium_set.remarks, equilibrium_set)


def _or_nan(value: float | None) -> float:
    return float("nan") if value is None else float(value)
