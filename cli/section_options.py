"""Options that name parameters of a section: ``--set p1=2/5``, ranges of axes, and what is wrong with them.

A name is that of a parameter or of a symbol of the notation; a number is rational, ``2/5`` or ``0.4``.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from mbsym.expressions.guessing import guess
from mbsym.expressions.parser import ascii_safe, parse_expression
from mbsym.expressions.place import Complaints, Span
from mbsym.model.system import rational
from mbsym.source import render_option
from mbsym.studies.section import unfit_section
from mbsym_cli.options import MAX_LENGTH, Options

if TYPE_CHECKING:
    from mbsym.maps.given import Complaint
    from mbsym.maps.section import Axis
    from mbsym.model.system import System


def read_settings(
    texts: Sequence[str], system: System, options: Options, more: Sequence[str] = ()
) -> dict[str, Fraction]:
    """``--set name=number``, each name once, also of ``more``; every complaint joins those of ``options``."""
    from mbsym.maps.section import usable

    found: dict[str, Fraction] = {}
    names = (*usable(system), *more)
    for text in texts:
        name, equals, right = (part.strip() for part in " ".join(text.splitlines()).partition("="))
        if not equals or not name or len(text) > MAX_LENGTH:
            told = f"{ascii_safe(text[:80])} gives no value"
            options.complain("--set", "bad-assignment", told, "write name=number, for example p1=2/5")
            continue
        value = read_rational(right, f"--set {name if name.isidentifier() else ascii_safe(name)}", options)
        known(name, "--set", names, options)
        if name in found:
            options.complain("--set", "repeated-name", f"{ascii_safe(name)} is set twice")
        if value is not None:
            found[name] = value
    return found


def read_axis(text: str | None, option: str, system: System, options: Options) -> Axis | None:
    """``name=low:high`` with low < high; every complaint joins those of ``options``."""
    from mbsym.maps.section import Axis, usable

    if text is None:
        hint = f"for example {option} {next(iter(system.parameter_names), 'p')}=0:1"
        options.complain(option, "missing-option", "a parameter and its interval are wanted", hint)
        return None
    name, equals, interval = (part.strip() for part in " ".join(text.splitlines()).partition("="))
    low, colon, high = interval.partition(":")
    if not equals or not colon or not name or ":" in high or len(text) > MAX_LENGTH:
        told = f"{ascii_safe(text[:80])} gives no interval"
        options.complain(option, "bad-interval", told, f"write name=low:high, for example {option} alpha=-1:1")
        return None
    exists = known(name, option, usable(system), options)
    ends = [
        read_rational(part, f"{option} {name if name.isidentifier() else ascii_safe(name)}", options)
        for part in (low, high)
    ]
    start, stop = ends
    if start is None or stop is None:
        return None
    if start >= stop:
        told = f"the interval from {start} to {stop} is empty"
        options.complain(option, "empty-interval", told, f"it goes upwards: low:high with low < high, {stop}:{start}")
        return None
    return Axis(name, start, stop) if exists else None


def known(name: str, option: str, names: Sequence[str], options: Options) -> bool:
    """Whether a name is one of ``names``; if it is not, that is one of the complaints."""
    if name in names:
        return True
    told = f"there is no parameter called {ascii_safe(name)}{guess(name, names)}"
    options.complain(option, "unknown-name", told)
    return False


def read_rational(text: str, option: str, options: Options) -> Fraction | None:
    """A rational number, of either sign."""
    text = " ".join(text.splitlines())
    complaints = Complaints()
    value = None
    if len(text) > MAX_LENGTH:
        complaints.error("bad-number", "this number is too long")
    else:
        parsed = parse_expression(text, complaints, lambda start, end: Span(1, start + 1, max(1, end - start)))
        if parsed is not None and not complaints.errors:
            value = rational(parsed)
            if value is None:
                hint = "write it as a fraction or a decimal, 2/5 or 0.4: what is found is exact"
                complaints.error("bad-number", "a rational number is wanted", Span(1, 1, max(1, len(text))), hint)
    options.complaints += [render_option(one, text, option) for one in complaints.sorted()]
    return value


def complain_unfit(wrong: Sequence[Complaint], axis_option: str, options: Options) -> None:
    """Why a section cannot be made: everything at once, each with what to do."""
    for one in unfit_section(wrong, axis_option):
        options.complain(one.option, one.code, one.message, one.hint)
