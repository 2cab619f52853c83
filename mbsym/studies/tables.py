"""Studies as tables of arrays, for Python: the cost of accuracy, digits at the extremes, relative equilibria."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from html import escape
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mbsym.expressions.guessing import guess
from mbsym.expressions.tree import Expression
from mbsym.mechanics.rest import given_values, missing_values
from mbsym.model.system import System
from mbsym.numerics.extremes.extremes import Extremes
from mbsym.numerics.extremes.singular import SingularSet
from mbsym.numerics.trade.tradeoff import Study
from mbsym.problems.relative_equilibria.equilibria import WITHIN, Equilibria
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


def _tradeoff(
    system: System,
    time: float,
    values: Mapping[str, Fraction | float | str],
    target: float,
    budget: float,
    methods: Sequence[str] | None,
    models: bool,
) -> TradeoffStudy:
    """See ``mbsym.tradeoff``."""
    from mbsym.numerics.methods.table import METHODS
    from mbsym.numerics.scenario import scenario
    from mbsym.numerics.trade.tradeoff import advice, studied
    from mbsym.simulation import read_values

    names = tuple(METHODS) if methods is None else tuple(methods)
    for name in names:
        if name not in METHODS:
            raise ValueError(f"there is no method '{name}'{guess(name, METHODS)}")
    motion = scenario(system, read_values(system, values), declared=True)
    study = studied(motion, [METHODS[name] for name in names], time, budget, models)
    drift_columns = ("constraint_drift", "constraint_velocity_drift") if system.constraints else ()
    runs = Table.of(
        (
            "method",
            "arithmetic",
            "tolerance",
            "step",
            "error",
            "drift",
            *drift_columns,
            "evaluations",
            "steps",
            "seconds",
            "front",
        ),
        (
            (
                row.method.traits.name,
                row.scalar,
                _or_nan(row.setting.tolerance),
                _or_nan(row.setting.step),
                row.error,
                row.drift,
                *((row.strayed or (inf, inf)) if drift_columns else ()),
                row.work.evaluations,
                row.work.steps,
                row.seconds,
                row.front,
            )
            for row in study.trade.rows
        ),
    )
    compared = Table.of(
        ("model", "error", "operations", "seconds"),
        ((row.model, row.error, row.operations, row.seconds) for row in study.models),
    )
    return TradeoffStudy(runs, compared, advice(study.trade, target), study.trade.reference.error, study)


def _extremes(system: System, values: Mapping[str, Fraction | float | str], budget: float) -> ExtremesStudy:
    """See ``mbsym.extremes``."""
    from mbsym.mechanics.variables import ring_of
    from mbsym.numerics.extremes.extremes import extremes as measured
    from mbsym.numerics.extremes.extremes_told import sentences
    from mbsym.numerics.kernels.interface import FLOAT32, FLOAT64
    from mbsym.numerics.scenario import scenario
    from mbsym.simulation import read_values

    read: dict[str, Expression] = read_values(system, values)
    result = measured(scenario(system, read), ring_of(system), read, budget)
    digits = Table.of(
        ("kind", "subject", "size", "quantity", "digits_float64", "digits_float32", "condition", "loses"),
        (
            (
                row.kind,
                row.subject,
                row.size,
                row.quantity,
                row.digits.digits[FLOAT64],
                row.digits.digits[FLOAT32],
                row.digits.condition,
                row.digits.verdict,
            )
            for row in result.rows
        ),
    )
    verdicts = Table.of(
        ("kind", "subject", "size", "verdict", "theorem", "float64_wrong"),
        (
            (x.kind, x.subject, x.size, x.judged.exact.word.value, x.judged.exact.theorem, x.judged.wrong(FLOAT64))
            for x in result.verdicts
        ),
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


def _equilibria(system: System, values: Mapping[str, Fraction | int | str], within: float) -> EquilibriaStudy:
    """See ``mbsym.equilibria``."""
    from mbsym.analysis.resting import relative_equilibria

    exact: dict[str, Fraction] = {}
    for name, value in values.items():
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
    names = system.coordinates

    def row(equilibrium: Any) -> tuple[object, ...]:
        known = {item.name: item.value for item in equilibrium.values}
        coordinates = (float(known.get(name, np.nan)) for name in names)
        return (
            *coordinates,
            equilibrium.verdict.word.value,
            equilibrium.verdict.theorem,
            equilibrium.proof,
            equilibrium.coordinates_of,
        )

    table = Table.of((*names, "verdict", "theorem", "proof", "angles_of"), map(row, equilibrium_set.equilibria))
    return EquilibriaStudy(table, equilibrium_set.complete, equilibrium_set.remarks, equilibrium_set)


def _or_nan(value: float | None) -> float:
    return float("nan") if value is None else float(value)


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
    names = None if methods is None else tuple(methods)
    return _tradeoff(moving_system(source), time, values or {}, target, budget, names, models)


def extremes(
    source: str | Path | Analysis, *, values: Mapping[str, Fraction | float | str] | None = None, budget: float = 60.0
) -> ExtremesStudy:
    """How many digits each quantity keeps at the extremes, as far as ``budget`` goes: ``mbsym extremes``.

    ``budget`` is counted work, worth about so many seconds on a usual machine: the same rows come out everywhere.

    Raises DescriptionError, ValueError, ``mbsym.numerics.scenario.Incomplete``.
    """
    return _extremes(moving_system(source), values or {}, budget)


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
    return _equilibria(moving_system(source), values or {}, within)


__all__ = ["WITHIN", "EquilibriaStudy", "ExtremesStudy", "Table", "TradeoffStudy", "equilibria", "extremes", "tradeoff"]
