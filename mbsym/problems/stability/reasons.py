"""Why a verdict is what it is, as codes with data; ``sentences`` puts them into words."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto


class Because(Enum):
    """A code; what stands in brackets are its data.  The order is that in which several are told."""

    # of theorems
    RIGHT_ROOTS = auto()  # (how many)
    RIGHT_ROOT = auto()
    REAL_ROOT = auto()
    RIGHT_BY_TRACE = auto()
    DESTROYED = auto()
    ODD_DEGREE = auto()
    ODD_DEGREE_REMAINS = auto()
    COMPLETE = auto()
    COMPLETE_BUT_CYCLIC = auto()
    LEFT = auto()
    LEFT_BUT_CYCLIC = auto()
    TURNED_DECAYS = auto()
    STEADY_DECAYS = auto()
    OTHER_LEAF = auto()
    FOLLOWS_ONE = auto()
    FOLLOWING = auto()
    MINIMUM = auto()
    MINIMUM_AND_DISSIPATION = auto()
    MINIMUM_BUT_CYCLIC = auto()
    MINIMUM_AND_DISSIPATION_BUT_CYCLIC = auto()
    UNDAMPED_MOTION = auto()  # (coordinates)
    INTEGRALS = auto()  # (which)
    LINEAR_BOUNDED = auto()
    LINEAR_SHIFTED = auto()
    LINEAR_GROWS = auto()
    LINEAR_DRIFTS = auto()
    LINEAR_GYROSCOPIC = auto()
    HIGHER_MINIMUM = auto()  # (order)
    NO_MINIMUM = auto()  # (order)
    NO_FORCES = auto()
    TERMS_OF_HIGHER_ORDER = auto()
    # of what no theorem carries
    GYROSCOPIC_ONLY = auto()
    GYROSCOPIC_ENCLOSED = auto()
    COINCIDENCE = auto()
    NO_ENERGY = auto()
    NO_ENERGY_BUT_CYCLIC = auto()
    IMAGINARY = auto()
    IMAGINARY_SIMPLE = auto()
    ZERO_ROOT = auto()
    IMAGINARY_BESIDES_TURNED = auto()
    IMAGINARY_NONHOLONOMIC = auto()
    UNLIKE_PARTS = auto()
    HIGHER_ORDER = auto()
    # of cyclic coordinates
    COASTING = auto()
    ALIKE = auto()
    VELOCITIES = auto()
    DRIFT = auto()
    DRIFT_AT_GIVEN_MOMENTA = auto()
    ELSEWHERE = auto()
    DISPLACEMENTS = auto()  # (how coordinates move together, each a text)
    OTHER_ANGLES = auto()  # (body, axes, angles)
    PARTLY_CYCLIC = auto()
    CONSTANT_MOMENTA = auto()
    # of what is open
    SEE_CASES = auto()
    BORDERS_APART = auto()
    CONDITIONS_UNWRITTEN = auto()
    BORDER = auto()
    ORDER_DECIDES = auto()  # (order, whatever is positive where it is stable, word there)
    VALUES_DECIDE = auto()
    NEAR_BORDER = auto()
    JORDAN_BLOCK = auto()
    LINEAR_OPEN = auto()
    ZERO_OR_MULTIPLE_BESIDES_TURNED = auto()
    CYCLIC_ZERO_ROOTS = auto()
    NOT_CLOSED = auto()  # (coordinates)
    MORE_ZERO_ROOTS = auto()  # (zero roots, dimensions of the family)
    NOT_ENCLOSED = auto()
    NO_CLOSED_FORM = auto()  # (why)
    ALSO_ELSEWHERE = auto()  # (whatever which coordinates are)
    DIFFERS_ALONG = auto()  # (which coordinates, word, other words)
    NO_EQUATIONS = auto()  # (why)
    MASS_SINGULAR = auto()
    ORDER_LOWER = auto()
    VARIES = auto()  # (with what)
    RANK_LOST = auto()  # (rank there, rank near it)
    NOT_THE_VALUE = auto()  # (of which parameter)
    MOTION_NOT_THERE = auto()  # (condition, value)
    MOTION_OPEN = auto()  # (condition)
    POLE = auto()  # (divisor)


@dataclass(frozen=True)
class Reason:
    """A code with its data."""

    code: Because
    data: tuple[object, ...] = ()

    def __reduce__(self) -> tuple[type[Reason], tuple[Because, tuple[object, ...]]]:
        """Formulas as their text: they belong to the rings of one process."""
        return Reason, (self.code, tuple(x if isinstance(x, int | str) else str(x) for x in self.data))

    def __hash__(self) -> int:
        return hash(self.rank)

    @property
    def rank(self) -> tuple[int, tuple[str, ...]]:
        """Where it stands among other reasons."""
        return self.code.value, tuple(map(str, self.data))
