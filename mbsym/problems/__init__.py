"""One file, one problem: a pure function from typed inputs to one frozen result."""

from collections.abc import Iterable

#: The numbered problems in their order: the attribute of an analysis that holds the result, and what it is about.
TITLES = {
    "kinematics": "kinematics",
    "energy": "energy and force function",
    "equations": "equations of motion",
    "equilibrium": "equilibrium conditions",
    "linearisation": "linearisation",
    "stability": "stability",
    "integrals": "first integrals",
    "stabilisation": "stabilisation",
    "polynomial_integrals": "polynomial integrals",
    "invariant_sets": "steady motions and invariant manifolds",
    "normal_forms": "terms of higher order",
    "small_parameters": "small parameters",
}
NUMBERS = tuple(range(1, len(TITLES) + 1))


def ranges(numbers: Iterable[int] = NUMBERS, to: str = " to ") -> str:
    """``1 to 8, 11``."""
    groups: list[list[int]] = []
    for number in sorted(numbers):
        if groups and number == groups[-1][-1] + 1:
            groups[-1].append(number)
        else:
            groups.append([number])
    return ", ".join(f"{group[0]}{to}{group[-1]}" if len(group) > 1 else str(group[0]) for group in groups)
