"""``ensemble.json`` of ``mbsym simulate --vary``."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import UNSET, UnsetType

from mbsym.report.documents.base import ASIDE, Hashed, Part, told_apart_by, words


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
    tolerance: Annotated[float | None, "error of one step"]
    step: Annotated[float | None, "length of a step"]
    ended: Annotated[list[Ended], "members that ended early", told_apart_by("member")]
    final: Annotated[dict[str, Final], "the spread of every coordinate and velocity at the last time, by name"]
    compared: Compared
    steps: Annotated[int, "steps of all members, rejected ones included", ASIDE]
    files: Annotated[list[Annotated[str, "name"]], "files that belong to it"]
