"""``NAME=RANGE``: grids, tolerances and draws of what varies, of sweeps and of ensembles."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING, Any, TypeAlias

from mbsym.expressions.message import Message
from mbsym.expressions.parser import ascii_safe, parse_expression
from mbsym.expressions.place import Complaints, Span
from mbsym.model.system import rational
from mbsym.studies.request import Ranges, Varied
from mbsym_cli.options import MAX_LENGTH, Options

if TYPE_CHECKING:
    from mbsym.maps.section import Axis
    from mbsym.model.system import System
    from mbsym.numerics.scenario import Scenario


#: Reads a number for an option, exact or not: (text, option); None where that is none.
Read: TypeAlias = Callable[[str, str], Any]

_DRAW = re.compile(r"\s*(normal|uniform)\s*\((.*)\)\s*", re.DOTALL)
_TOLERANCE = re.compile(r"(?P<middle>.*?)\s*\+-\s*(?P<size>[^%]+?)\s*(?P<percent>%?)\s*", re.DOTALL)
_HINT = "write name=0:1:1000, name=1 +- 5%, name=uniform(0, 1) or name=normal(1, 0.05)"


def read_variations(
    option: str, texts: Sequence[str], kind: Ranges, system: System | None, motion: Scenario | None, options: Options
) -> tuple[Varied, ...] | None:
    """What varies; None where it cannot be read, or nothing does, which joins the complaints."""
    if not texts:
        options.complain(option, "missing-option", "what varies is not said", _HINT)
    if len(texts) > kind.most:
        options.complain(option, "too-large", Message("at most [[most]] names vary at once", most=kind.most))
    if not 0 < len(texts) <= kind.most:
        return None
    exact = partial(read_rational, options=options)
    read: Read = exact if kind.exact else partial(_number, motion=motion, options=options)
    varieds = [_varied(" ".join(text.splitlines()), option, read, system, options) for text in texts]
    known = tuple(varied for varied in varieds if varied is not None)
    return known if len(known) == len(varieds) else None


def _varied(text: str, option: str, read: Read, system: System | None, options: Options) -> Varied | None:
    from mbsym.numerics.ensembles.variation import Draw, Grid

    name, equals, right = (part.strip() for part in text.partition("="))
    if not equals or not name or not right or len(text) > MAX_LENGTH:
        options.complain(
            option, "bad-variation", Message("[[text]]: this says no range", text=ascii_safe(text[:80])), _HINT
        )
        return None
    option = f"{option} {name if name.isidentifier() else ascii_safe(name)}"
    tolerance, draw = _TOLERANCE.fullmatch(right), _DRAW.fullmatch(right)
    if tolerance is not None:
        about = _about(name, tolerance, option, read, system, options)
        return None if about is None else Varied(Draw(name, "uniform", float(about[0]), float(about[1])), about)
    parts = [part.strip() for part in (draw[2].split(",") if draw else right.split(":"))]
    if len(parts) != (2 if draw else 3):
        options.complain(option, "bad-variation", "this is no range", _HINT)
        return None
    first, second = (read(part, option) for part in parts[:2])
    count = 0 if draw else options.whole(option, parts[2], 2, 10**12)
    if first is None or second is None or count is None:
        return None
    if draw is None:
        return Varied(Grid(name, float(first), float(second), count), (min(first, second), max(first, second)))
    reach = (first, second) if draw[1] == "uniform" else (first - 8 * second, first + 8 * second)
    return Varied(Draw(name, draw[1], float(first), float(second)), reach)


def _about(
    name: str, tolerance: re.Match[str], option: str, read: Read, system: System | None, options: Options
) -> tuple[Any, Any] | None:
    """The ends of ``m = 1 +- 5%``; without a number in front, about the value of the description."""
    size = read(tolerance["size"], option)
    if tolerance["middle"]:
        middle = read(tolerance["middle"], option)
    else:
        parameters = () if system is None else system.parameters
        expression = next((parameter.value for parameter in parameters if parameter.name == name), None)
        middle = None if expression is None else rational(expression)
        if middle is None:
            shown = ascii_safe(name)
            message = Message("[[name]] has no rational number in the description to vary about", name=shown)
            hint = Message("write [[example]]", example=f"{shown}=1 +- 5%")
            options.complain(option, "missing-value", message, hint)
    if middle is None or size is None:
        return None
    reach = abs(middle) * size / 100 if tolerance["percent"] else size
    if reach <= 0:
        options.complain(option, "bad-variation", "the tolerance must be positive", _HINT)
        return None
    return middle - reach, middle + reach


def _number(text: str, option: str, motion: Scenario | None, options: Options) -> float | None:
    """A number made of numbers, pi and parameters, of either sign."""
    from mbsym.algebra.failures import Failure, message_of
    from mbsym.expressions.tree import names
    from mbsym.numerics.scenario import exact

    complaints, whole = Complaints(), Span(1, 1, max(1, len(text)))
    value = parse_expression(text, complaints)
    known = dict(motion.parameters) if motion is not None else {}
    evaluated = None
    if value is not None and not complaints.errors:
        unknown = sorted(names(value) - {*known, "pi"})
        if unknown and motion is not None:
            complaints.error(
                "unknown-name", Message("unknown name [[name]]", name=unknown[0]), whole, "numbers, pi and parameters"
            )
        elif not unknown:
            try:
                evaluated = float(exact(value, known))
            except Failure as reason:
                complaints.error("bad-number", Message("it has no value: [[why]]", why=message_of(reason)), whole)
    options.add(option, text, *complaints.sorted())
    return evaluated


# Options that name parameters of a section: ``--set p1=2/5``, ranges of axes, and what is wrong with them.
#
# A name is that of a parameter or of a symbol of the notation; a number is rational, ``2/5`` or ``0.4``.


def read_settings(
    texts: Sequence[str], system: System, options: Options, more: Sequence[str] = ()
) -> dict[str, Fraction]:
    """``--set name=number``, each name once, also of ``more``; every complaint joins those of ``options``."""
    from mbsym.maps.section import usable

    values: dict[str, Fraction] = {}
    names = (*usable(system), *more)
    for text in texts:
        name, equals, right = (part.strip() for part in " ".join(text.splitlines()).partition("="))
        if not equals or not name or len(text) > MAX_LENGTH:
            message = Message("[[text]] gives no value", text=ascii_safe(text[:80]))
            options.complain("--set", "bad-assignment", message, "write name=number, for example p1=2/5")
            continue
        value = read_rational(right, f"--set {name if name.isidentifier() else ascii_safe(name)}", options)
        known(name, "--set", names, options)
        if name in values:
            options.complain("--set", "repeated-name", Message("[[name]] is set twice", name=ascii_safe(name)))
        if value is not None:
            values[name] = value
    return values


def _interval(option: str, system: System, name: str = "") -> str:
    """An example of an interval: of the parameter that is meant, else of the first one."""
    from mbsym.maps.section import usable

    meant = name if name in usable(system) else next(iter(system.parameter_names), "p")
    return f"{option} {meant}=0:1"


def read_axis(text: str | None, option: str, system: System, options: Options) -> Axis | None:
    """``name=low:high`` with low < high; every complaint joins those of ``options``."""
    from mbsym.maps.section import Axis, usable

    if text is None:
        hint = Message("for example [[example]]", example=_interval(option, system))
        options.complain(option, "missing-option", "a parameter and its interval are wanted", hint)
        return None
    name, equals, interval = (part.strip() for part in " ".join(text.splitlines()).partition("="))
    low, colon, high = interval.partition(":")
    if not equals or not colon or not name or ":" in high or len(text) > MAX_LENGTH:
        message = Message("[[text]] gives no interval", text=ascii_safe(text[:80]))
        hint = Message("write name=low:high, for example [[example]]", example=_interval(option, system, name))
        options.complain(option, "bad-interval", message, hint)
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
        message = Message("the interval from [[low]] to [[high]] is empty", low=str(start), high=str(stop))
        hint = Message("it goes upwards: low:high with low < high, [[example]]", example=f"{stop}:{start}")
        options.complain(option, "empty-interval", message, hint)
        return None
    return Axis(name, start, stop) if exists else None


def known(name: str, option: str, names: Sequence[str], options: Options) -> bool:
    """Whether a name is one of ``names``; if it is not, that is one of the complaints."""
    if name in names:
        return True
    from difflib import get_close_matches

    shown, near = ascii_safe(name), get_close_matches(name, names, 1)
    message = Message("there is no parameter called [[name]]; there are [[names]]", name=shown, names=", ".join(names))
    if near or not names:
        message = Message("there is no parameter called [[name]]", name=shown)
    if near:
        message = Message("there is no parameter called [[name]]: did you mean '[[other]]'?", name=shown, other=near[0])
    options.complain(option, "unknown-name", message)
    return False


def read_rational(text: str, option: str, options: Options) -> Fraction | None:
    """A rational number, of either sign."""
    text = " ".join(text.splitlines())
    complaints = Complaints()
    value = None
    if len(text) > MAX_LENGTH:
        complaints.error("bad-number", "this number is too long")
    else:
        parsed = parse_expression(text, complaints)
        if parsed is not None and not complaints.errors:
            value = rational(parsed)
            if value is None:
                hint = "write it as a fraction or a decimal, 2/5 or 0.4: what is found is exact"
                complaints.error("bad-number", "a rational number is wanted", Span(1, 1, max(1, len(text))), hint)
    options.add(option, text, *complaints.sorted())
    return value
