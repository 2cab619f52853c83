"""One file, one problem: a pure function from typed inputs to one frozen result."""

from collections.abc import Iterable

#: The numbers under which ``mbsym.analysis`` lists them; here for those who only have to know what may be asked for.
NUMBERS = tuple(range(1, 13))


def ranges(numbers: Iterable[int] = NUMBERS) -> str:
    """``1 to 8, 11``."""
    groups: list[list[int]] = []
    for number in sorted(numbers):
        if groups and number == groups[-1][-1] + 1:
            groups[-1].append(number)
        else:
            groups.append([number])
    return ", ".join(f"{group[0]} to {group[-1]}" if len(group) > 1 else str(group[0]) for group in groups)
