"""``simulation.json`` of ``mbsym simulate``."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import UNSET, Meta, UnsetType

from mbsym.numerics.accuracy import Lacking
from mbsym.numerics.conservation import Doubt, Standing
from mbsym.numerics.events.surfaces import Action, Direction
from mbsym.report.documents.base import ASIDE, SHA256, Format, From, Part, told_apart_by, words


class Variables(Part, frozen=True):
    """of a run in the variables that a description declares: positions and speeds by name, in the order of the state,
    and how far unit vectors and quaternions are from their lengths and right angles at the rows
    """

    positions: Annotated[list[str], "coordinates and components of unit vectors and quaternions"]
    speeds: Annotated[list[str], "declared speeds, and the generalised velocities that are left"]
    norm_drift: Annotated[dict[str, float], "the largest of each column, by the column's name"]


class Moved(Part, frozen=True):
    given: Annotated[float, "as it was given"]
    taken: Annotated[float, "as the run began"]


class Start(Part, frozen=True):
    """how the initial state was made consistent"""

    closest: Annotated[bool, "whether its position is the closest to the one given, by the mass matrix"]
    fixed: Annotated[list[Annotated[str, "a coordinate or velocity"]], "initial values that had to stay"]
    moved: Annotated[dict[str, Moved], "initial values that were changed by more than roundings"]


class Drift(Part, frozen=True):
    """how far the rows shown are off the constraints at most, in parts of the motion's size"""

    positions: Annotated[float | str, "of holonomic rows"]
    velocities: Annotated[float | str, "of all rows"]


class Constraints(Part, frozen=True, kw_only=True):
    """of a system with constraints: its rows, how its initial state was made to satisfy them, how far the run strays
    from them
    """

    rows: Annotated[
        list[Annotated[str, "kind, number in the description, component"]],
        "scalar rows of the constraints, those that follow from others included",
    ]
    left_out: Annotated[
        list[Annotated[str, "kind, number in the description, component"]],
        "rows that follow from others near the start (seen, not proved), and are left out of the equations",
    ]
    free_velocities: Annotated[int, "velocities less independent rows"]
    start: Start
    drift: Drift
    singular: Annotated[
        list[Annotated[float, "a time"]],
        "times of singular positions of the constraints through which the motion was continued",
    ]
    stepped_over: Annotated[list[float], "times near which steps went over singular positions of the constraints"]


class Ended(Part, frozen=True):
    """why and where it ended early"""

    kind: Annotated[str, "what happened"]
    message: Annotated[str, "the same in a sentence"]
    time: Annotated[float | str, "when"]
    state: Annotated[dict[str, float | str] | UnsetType, "coordinates and velocities there"] = UNSET


class TimeSpan(Part, frozen=True):
    """the times that were asked for"""

    from_: Annotated[float, "first time"]
    to: Annotated[float, "last time"]
    samples: Annotated[int, "rows"]


class Reached(Part, frozen=True):
    """how far it got"""

    time: Annotated[float | str, "last time"]
    samples: Annotated[int, "rows"]
    state: Annotated[
        dict[str, Annotated[float | str, "its value"]],
        "the last row's coordinates and velocities to the last bit, as text where they have more digits than float64",
    ]


class Continued(Part, frozen=True):
    """the earlier run whose rows come first, where it was one (--continue)"""

    from_: Annotated[float, "where it ended"]
    samples: Annotated[int, "its rows"]


class MethodUsed(Part, frozen=True):
    """the integration method"""

    name: Annotated[str, "as --method calls it"]
    title: Annotated[str, "its name in words"]
    why: Annotated[str, "why it was chosen, in words"]
    may_change: Annotated[bool, "whether the run changes to an implicit method, or back, where that is quicker"]


class Narrow(Part, frozen=True):
    time: Annotated[float, "where it is"]
    width: Annotated[float, "how long it takes"]
    step: Annotated[float, "the length of the step that passed it"]


class BetweenSteps(Part, frozen=True):
    """what of the rates is not smooth, or narrow, on the way; null where there is no such thing"""

    switches: Annotated[
        list[float],
        "times at which a sign or modulus changed its side, or the motion began or ceased to stay there; a step ends "
        "at each (the first 10000)",
    ]
    narrow: Annotated[list[Narrow], "smooth functions that change within a small part of a step (the first 10000)"]
    unresolved: Annotated[list[float], "times of steps in which changes of side may have been missed"]


class Work(Part, frozen=True):
    """the work that was done"""

    evaluations: Annotated[int, "of the right-hand side"]
    jacobians: Annotated[int, "of its Jacobian"]
    steps: Annotated[int, "steps taken"]
    rejected: Annotated[int, "steps rejected"]


#: How a quantity keeps its value; its name or formula comes before that.
Conserved = Annotated[bool | None, "true, false, or null where it is undecided", From("standing.conserved")]
Known = Annotated[Standing, "how that is known", From("standing")]
Doubted = Annotated[str | None, "why it is undecided", words(Doubt), From("doubt")]
LargestDrift = Annotated[
    float | str,
    "the largest difference from the initial value, over relative_to; text where it is not finite",
    From("change"),
]
RelativeTo = Annotated[
    float | str,
    "what it is relative to: of an energy the largest kinetic energy (its first value where nothing moves, else 1), "
    "of a first integral the largest sum of the sizes of its terms",
    From("scale"),
]


class Energy(Part, frozen=True):
    """the energy T - U"""

    is_: Annotated[Literal["T - U"], "what it is"]
    conserved: Conserved
    how: Known
    doubt: Doubted
    largest_relative_drift: LargestDrift
    relative_to: RelativeTo


class GeneralizedEnergy(Part, frozen=True):
    """the generalised energy, where it is another quantity than the energy"""

    is_: Annotated[Literal["T2 - T0 - U"], "what it is"]
    conserved: Conserved
    how: Known
    doubt: Doubted
    largest_relative_drift: LargestDrift
    relative_to: RelativeTo


class Invariant(Part, frozen=True):
    """a first integral"""

    name: Annotated[str, "its name, in words", From("quantity")]
    conserved: Conserved
    how: Known
    doubt: Doubted
    largest_relative_drift: LargestDrift
    relative_to: RelativeTo


class NoEstimate(Part, frozen=True):
    """none"""

    available: Annotated[Literal[False], "false"]
    why: Annotated[str, words(Lacking), "why there is none"]


class Against(Part, frozen=True):
    """the better run"""

    method: Annotated[str, "its method"]
    arithmetic: Annotated[str, "its arithmetic", From("scalar")]
    tolerance: Annotated[float | str | None, "its tolerance", From("setting.tolerance")]
    step: Annotated[float | str | None, "its step", From("setting.step")]
    longest_step: Annotated[float | str | None, "its longest step", From("setting.longest")]


class Over(Part, frozen=True):
    """the times compared: the whole interval, following the steps of both runs"""

    from_: Annotated[float, "first time"]
    to: Annotated[float, "last time"]
    samples: Annotated[int, "places compared"]
    every_step: Annotated[
        bool, "whether every step of both runs was followed; otherwise the places lie unevenly from some step on"
    ]


class QuantityError(Part, frozen=True, kw_only=True):
    """one quantity"""

    final: Annotated[float | str, "error at the end"]
    largest: Annotated[float | str, "error at worst"]
    when: Annotated[float, "time of the error at worst"]
    size: Annotated[float | str, "its largest value in the whole motion"]
    scale: Annotated[float | str, "what the error is relative to"]
    floor: Annotated[float | str, "a smaller size is rest but for rounding, and does not count as scale"]
    rests: Annotated[bool, "whether it rests"]


class Estimate(Part, frozen=True):
    """an estimate: the difference from a better run, each quantity relative to its scale"""

    available: Annotated[Literal[True], "true"]
    final: Annotated[float | str, "at the end"]
    largest: Annotated[float | str, "at worst"]
    how: Annotated[Literal["better run"], "how it is estimated"]
    against: Against
    parted: Annotated[
        float | None,
        "by when they differ by a tenth of a quantity's scale: no number here is a bound of the error then; null where "
        "they never do",
    ]
    over: Over
    quantities: Annotated[dict[str, QuantityError], "by name"]


class Operations(Part, frozen=True):
    """operations of one right-hand side"""

    whole: Annotated[int, "with them"]
    reduced: Annotated[int, "without them"]


class Resting(Part, frozen=True):
    """coordinates that rest"""

    coordinates: Annotated[list[str], "which"]
    how: Annotated[str, "how that is known"]
    taken_out: Annotated[bool, "whether they were taken out of the integration"]
    operations: Operations | UnsetType = UNSET


class SystemPart(Part, frozen=True):
    """a part"""

    coordinates: Annotated[list[Annotated[str, "name of a coordinate"]], "its coordinates", From("names")]
    method: Annotated[str, "the method that integrates it"]


class Enclosure(Part, frozen=True):
    """one of them"""

    largest_radius: Annotated[float | str, "radius of its enclosure, at worst"]
    largest_error: Annotated[float | str, "distance of the run from the exact solution, at worst"]
    scale: Annotated[float | str, "its largest absolute value at the rows; 1 where that is zero"]


class Certificate(Part, frozen=True):
    """where --certify asked for it: the exact solution of the equations enclosed; all bounds are proved, at the
    enclosed rows
    """

    whole: Annotated[bool, "whether all rows are enclosed"]
    ended: Annotated[
        str | None, words("no_step_proved", "too_wide", "out_of_time", "too_dear", "interrupted"), "why they are not"
    ]
    reached: Annotated[float | str, "the time up to which the solution is enclosed"]
    rows: Annotated[int, "how many rows are enclosed", Meta(ge=0)]
    bits: Annotated[int, "bits of the series"]
    steps: Annotated[int, "steps of the enclosure"]
    largest_radius: Annotated[float | str, "the largest radius as printed, as a part of the quantity's scale"]
    largest_error: Annotated[
        float | str, "the largest distance of the run from the exact solution, as a part of the quantity's scale"
    ]
    events_proved: Annotated[int, "events of the run that the exact solution is proved to have, once each", Meta(ge=0)]
    largest_event_radius: Annotated[
        float | None, "how near to its time each of them is, at worst; null where there is none"
    ]
    quantities: Annotated[dict[str, Enclosure], "coordinates and velocities by name"]
    asked: Annotated[float | UnsetType, "the largest radius that was asked for, as a part of the quantity's scale"] = (
        UNSET
    )
    known: Annotated[
        float | str | UnsetType, "the largest radius before it is rounded to printed digits, as a part of the scale"
    ] = UNSET
    narrow: Annotated[bool | UnsetType, "whether that is as narrow as was asked for, at the enclosed rows"] = UNSET


class WatchedEvent(Part, frozen=True):
    """one condition"""

    name: Annotated[str, "its title, or the condition"]
    condition: Annotated[str, "as it was written"]
    direction: Annotated[
        Direction, "which passages count: the left side grows beyond the right one (rising), falls below it, or both"
    ]
    action: Annotated[Action, "what it does"]
    count: Annotated[int, "how often it was met"]
    first: Annotated[float | None, "when at first"]
    last: Annotated[float | None, "when at last"]
    touches: Annotated[int, "how often both sides met without passing as far as the run can tell: two passages or none"]
    undecided: Annotated[
        bool, "whether both sides were equal, within the error of a step, all along: nothing can be said then"
    ]


class Stopped(Part, frozen=True):
    """the condition of --stop that ended the run, if one did"""

    event: Annotated[str, "its name"]
    time: Annotated[float | str, "when"]
    state: Annotated[dict[str, Annotated[float | str, "its value"]], "coordinates and velocities then"]


class Section(Part, frozen=True):
    """the Poincare section of --section; its points are the rows of section.csv"""

    condition: Annotated[str, "the surface"]
    axes: Annotated[list[Annotated[str, "an expression, perhaps modulo a period"]], "what it is drawn over"]
    count: Annotated[int, "points"]


class Model(Part, frozen=True):
    """what of the mechanics is in the equations"""

    gravity: Annotated[
        int | str | None, "order of Newtonian gravity where it is not that of the description", words(2, 3, 4, "exact")
    ]
    linear: Annotated[bool, "whether they are linearised about the unperturbed motion"]
    without: Annotated[list[str], "parameters taken as zero"]


class Accuracy(Part, frozen=True):
    """tolerable relative errors"""

    everything: Annotated[float | None, "of all coordinates and velocities that are not named"]
    named: Annotated[dict[str, float], "by quantity"]


class Share(Part, frozen=True):
    """a part of the bound"""

    name: Annotated[str, words("model", "integration", "arithmetic"), "of what"]
    error: Annotated[float | str, "relative to the quantity's size"]
    how: Annotated[
        str,
        words("proved", "measured", "estimated", "together"),
        "how it is known; together: contained in the integration's",
    ]


class Bound(Part, frozen=True, kw_only=True):
    """what the error of a quantity is at most"""

    quantity: Annotated[str, "a coordinate, a velocity, or energy"]
    target: Annotated[float | str, "the tolerable error"]
    total: Annotated[float | str, "the sum of the shares"]
    how: Annotated[str, words("proved", "measured", "estimated"), "the weakest way in which a share is known"]
    shares: Annotated[list[Share], "model, integration, arithmetic"]
    proved_at_rows: Annotated[
        float | UnsetType,
        "a proved bound of integration and arithmetic together at the rows, of the quantity's largest value there",
        Meta(ge=0),
    ] = UNSET


class Item(Part, frozen=True):
    """one choice"""

    kind: Annotated[str, "of what kind"]
    what: Annotated[list[str], "what it is about"]
    chosen: Annotated[str, "what was chosen"]
    why: Annotated[str, "why, in words"]
    error: Annotated[float | str | None, "what it adds to the error, if that is told apart"]
    how: Annotated[str, words("proved", "measured", "estimated", "together"), "how that is known"]


class Plan(Part, frozen=True):
    """how the accuracy that was asked for is reached; null where none was"""

    accuracy: Accuracy
    reached: Annotated[bool, "whether every bound is within its target"]
    bounds: Annotated[list[Bound], "the worst quantity, and those that were named", told_apart_by("quantity")]
    items: Annotated[list[Item], "choices"]
    remarks: Annotated[list[str], "what else there is to say"]
    options: Annotated[
        list[str],
        "options of mbsym simulate, beside --set and those of the output, that repeat the run without choosing",
    ]


class MethodChange(Part, frozen=True):
    """one change"""

    time: Annotated[float, "from when on"]
    method: Annotated[str, "the method from there on, as --method calls it"]
    why: Annotated[str, "why, in words"]


class Simulation(Part, frozen=True, kw_only=True):
    """What a trajectory was computed from, how, with what work, and whether it is whole. Infinite numbers are text."""

    format: Format = 1
    system: Annotated[str, "name of the description"]
    description_sha256: Annotated[str, "SHA-256 of the description as 'mbsym convert' writes it in YAML", SHA256]
    status: Annotated[Literal["whole", "partial"], "whether it reached its end"]
    ended: Ended | None
    time: TimeSpan
    reached: Reached
    continued: Continued | None
    method: MethodUsed
    arithmetic: Annotated[str, "float64, float32, extended, ..."]
    tolerance: Annotated[float | str | None, "relative tolerance of one step, if the step is chosen by it"]
    step: Annotated[float | str | None, "step, if it is fixed"]
    longest_step: Annotated[float | UnsetType | None, "no step is longer; null where nothing was asked for"] = UNSET
    between_steps: BetweenSteps | UnsetType | None = UNSET
    step_limit: Annotated[int, "so many steps at most"]
    parameters: Annotated[dict[str, float | str], "values of the parameters"]
    inputs: Annotated[
        dict[str, str] | UnsetType,
        "what the inputs of the description were: formulas by name; only where it has inputs",
    ] = UNSET
    initial: Annotated[dict[str, float | str], "initial coordinates and velocities"]
    work: Work
    files: Annotated[list[str], "files that belong to it"]
    table_sha256: Annotated[
        Annotated[str, SHA256] | None,
        "SHA-256 of trajectory.csv or trajectory-partial.csv, which another run may go on from",
    ]
    versions: Annotated[dict[str, str], "of Python and of the packages that the numbers depend on", ASIDE]
    units: Annotated[
        dict[str, Annotated[str, "its unit"]] | UnsetType,
        "where the description declares units: those of t, coordinates, rates, parameters, prescribed motions, "
        "energies and invariants, by name; 1 for a pure number, nothing where a unit does not follow",
    ] = UNSET
    energy: Energy
    generalized_energy: GeneralizedEnergy | UnsetType = UNSET
    invariants: Annotated[dict[str, Invariant], "first integrals, by their column"]
    estimated_error: Annotated[NoEstimate | Estimate, "the error, or why none is estimated"]
    resting: Resting | None
    events: Annotated[
        list[WatchedEvent] | UnsetType,
        "conditions that were watched for, --event and --stop, in their order; each occurrence is a row of events.csv",
    ] = UNSET
    stopped: Stopped | UnsetType | None = UNSET
    section: Section | UnsetType = UNSET
    parts: Annotated[
        list[SystemPart], "parts that nothing links, each integrated by itself; empty where all are linked"
    ]
    model: Model
    plan: Plan | None
    method_changes: Annotated[
        list[MethodChange] | UnsetType,
        "where the run changed its method on the way, as the motion became stiff or ceased to be; 'method' is the "
        "one that it began with",
    ] = UNSET
    constraints: Constraints | UnsetType = UNSET
    variables: Variables | UnsetType = UNSET
    certificate: Certificate | UnsetType = UNSET
