"""Polynomials in lambda**2 as people write them: no factor 1, and brackets about sums only."""

from __future__ import annotations

from collections.abc import Callable, Sequence

_OPENING, _CLOSING = "([{", ")]}"


def in_even_powers(coefficients: Sequence[str], power: Callable[[int], str], times: str) -> str:
    """``m*lambda**4 + (a - b)*lambda**2 - c`` of ``-c, a - b, m``; ``power(2)`` writes lambda**2."""
    parts: list[str] = []
    for k in reversed(range(len(coefficients))):
        text = coefficients[k]
        if text == "0":
            continue
        minus = text.startswith("-") and not (k and _is_sum(text[1:]))
        text = text[1:].lstrip() if minus else text
        if k:
            factor = f"({text})" if _is_sum(text) else text
            text = power(2 * k) if factor == "1" else f"{factor}{times}{power(2 * k)}"
        parts.append((" - " if minus else " + ") + text)
    found = "".join(parts).lstrip()
    return found[2:] if found.startswith("+ ") else found.replace("- ", "-", 1) or "0"


def _is_sum(text: str) -> bool:
    """Whether a plus or minus stands outside of all brackets, the first sign included."""
    depth = 0
    for letter in text:
        depth += (letter in _OPENING) - (letter in _CLOSING)
        if depth == 0 and letter in "+-":
            return True
    return False
