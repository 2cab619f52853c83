"""``ensemble.json`` of ``mbsym simulate --vary``, ``sweep.json`` of ``mbsym sweep``."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import UNSET, Meta, UnsetType

from mbsym.report.documents.base import ASIDE, From, Hashed, Part, told_apart_by, words


class Varied(Part, frozen=True):
    """a parameter or an initial value"""

    name: Annotated[str, "its name"]
    kind: Annotated[str, words("grid", "normal", "uniform"), "a grid or a distribution"]
    from_: Annotated[float | UnsetType, "first value"] = UNSET
    to: Annotated[float | UnsetType, "last value"] = UNSET
    count: Annotated[int | UnsetType, "values of a grid"] = UNSET
    mean: Annotated[float | UnsetType, "of a normal distribution"] = UNSET
    deviation: Annotated[float | UnsetType, "standard deviation of a normal distribution"] = UNSET


class Time(Part, frozen=True):
    """the times of the statistics"""

    from_: Annotated[float, "first time"]
    to: Annotated[float, "last time reached"]
    samples: Annotated[int, "how many times"]


class Ended(Part, frozen=True):
    """one of them"""

    member: Annotated[int, "its number, from 0"]
    kind: Annotated[str, "what happened"]
    time: Annotated[float, "about when"]
    values: Annotated[dict[str, Annotated[float, "value"]], "what varied, by name"]


class Final(Part, frozen=True):
    """spread of a quantity over the members that reached the end; null where there are none"""

    mean: Annotated[float | None, "arithmetic mean"]
    std: Annotated[float | None, "standard deviation of a sample"]
    min: Annotated[float | None, "least value"]
    max: Annotated[float | None, "greatest value"]
    quantiles: Annotated[dict[str, Annotated[float | None, "value"]], "quantiles by their chance"]


class Compared(Part, frozen=True):
    """some members integrated more finely"""

    members: Annotated[list[Annotated[int, "number"]], "their numbers"]
    largest: Annotated[
        float | None, "largest difference, relative to a quantity's size; null where there was nothing to compare"
    ]


class Ensemble(Hashed, frozen=True, kw_only=True):
    """Many motions of one system: what varied, who ended early, how the members are spread at the end."""

    status: Annotated[Literal["whole", "partial"], "whether it was interrupted"]
    inputs: Annotated[
        dict[str, str] | UnsetType,
        "what the inputs of the description were: formulas by name; only where it has inputs",
    ] = UNSET
    members: Annotated[int, "how many members there are, those that ended early included"]
    varied: Annotated[list[Varied], "what varies", told_apart_by("name")]
    seed: Annotated[int | None, "of what is drawn at random; null for grids"]
    sampling: Annotated[str, words("grid", "random", "sobol"), "how members were chosen"]
    time: Time
    method: Annotated[str, "integration method"]
    tolerance: Annotated[float | None, "error of one step", From("setting.tolerance")]
    step: Annotated[float | None, "length of a step", From("setting.step")]
    ended: Annotated[list[Ended], "members that ended early", told_apart_by("member")]
    final: Annotated[dict[str, Final], "the spread of every coordinate and velocity at the last time, by name"]
    compared: Compared
    steps: Annotated[int, "steps of all members, rejected ones included", ASIDE]
    files: Annotated[list[Annotated[str, "name"]], "files that belong to it"]


class Swept(Part, frozen=True):
    """a grid (low, high, count) or a distribution (uniform: ends; normal: mean and standard deviation)"""

    name: Annotated[str, "parameter, or symbol of the notation"]
    kind: Annotated[str, words("grid", "uniform", "normal"), "how its values are taken"]
    low: Annotated[float | UnsetType, "first value of a grid"] = UNSET
    high: Annotated[float | UnsetType, "last value of a grid"] = UNSET
    count: Annotated[int | UnsetType, "number of values of a grid"] = UNSET
    first: Annotated[float | UnsetType, "lower end, or mean"] = UNSET
    second: Annotated[float | UnsetType, "upper end, or standard deviation"] = UNSET


class Column(Part, frozen=True):
    """one of them"""

    name: Annotated[str, "as in the first line of the table"]
    meaning: Annotated[str, "what is in it"]


class Interval(Part, frozen=True):
    """its ends"""

    low: Annotated[float, "lower end"]
    high: Annotated[float, "upper end"]
    confidence: Annotated[float, "with which it holds"]


class Share(Part, frozen=True):
    """a share of the points"""

    word: Annotated[str, "the verdict, or why there is none"]
    count: Annotated[int, "points"]
    total: Annotated[int, "of so many"]
    interval: Annotated[
        Interval | None, "Clopper and Pearson's interval of the probability, for points drawn at random; else null"
    ]


class Range(Part, frozen=True):
    """of one column"""

    column: Annotated[str, "its name"]
    least: Annotated[float | None, "least number; null where there is none"]
    mean: Annotated[float | None, "mean; null where there is none"]
    greatest: Annotated[float | None, "greatest number; null where there is none"]
    missing: Annotated[int, "points without a number"]


class Dependence(Part, frozen=True):
    """of one name"""

    name: Annotated[str, "what varies"]
    value: Annotated[float, "distance or correlation"]


class Sweep(Hashed, frozen=True, kw_only=True):
    """What a sweep says on the whole; its points are in sweep.csv or sweep.parquet."""

    measure: Annotated[str, "what is measured: stability, eigenvalues, damping, frequency, or a formula"]
    points: Annotated[int, "how many points there are", Meta(ge=2)]
    table: Annotated[str, "name of the file of points; empty where none was asked for"]
    varied: Annotated[list[Swept], "what varies, in the order of the table's columns", told_apart_by("name")]
    sampling: Annotated[str | None, words("random", "sobol"), "how points are drawn; null for a grid"]
    seed: Annotated[int | None, "of what is drawn; null for a grid"]
    settings: Annotated[
        dict[str, Annotated[str, "a rational number"]], "numbers put in besides those of the description"
    ]
    columns: Annotated[list[Column], "columns of the table after those of what varies", told_apart_by("name")]
    shares: Annotated[
        list[Share], "how many points have which verdict; empty where no verdict is measured", told_apart_by("word")
    ]
    stable: Annotated[
        Share | None,
        "points whose motion is proved to be stable, be it but for drift or rotation; null where no verdict is "
        "measured",
    ]
    singly: Annotated[
        int | None, "points near borders that were judged by themselves; null where no verdict is measured"
    ]
    ranges: Annotated[list[Range], "least, mean and greatest number of each column of numbers", told_apart_by("column")]
    dependence: Annotated[
        list[Dependence],
        "how much the first column depends on what varies, strongest first: of a verdict the distance of Kolmogorov "
        "and Smirnov between stable points and unstable ones (0 to 1), of numbers the rank correlation (-1 to 1)",
        told_apart_by("name"),
    ]
    left_out: Annotated[
        list[Annotated[str, "in words"]], "what parameters have to keep but could not be expressed in what varies"
    ]
