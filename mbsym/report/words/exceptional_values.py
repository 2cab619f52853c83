"""Exceptional values along a parameter (``mbsym nonlinear``) as lines of the terminal and as JSON."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from flint import arb

from mbsym.expressions.message import Message, joined, worded
from mbsym.model.system import System
from mbsym.problems.normal_forms.along import Along, Special
from mbsym.problems.normal_forms.result import Judged, Outcome, Theorem
from mbsym.problems.stability.verdict import Verdict
from mbsym.problems.stability.words import with_theorem
from mbsym.report.documents import nonlinear as doc
from mbsym.report.documents.base import file_of
from mbsym.report.sections.normal_forms import enclosure
from mbsym.report.words.normal_form_words import REASONS, decimal

#: What is zero at an exceptional value.
VANISHING = {
    "trace": "w1^2 + w2^2 = 0",
    "product": "w1 w2 = 0",
    "discriminant": "w1 = w2",
    "determinant": "D4 = 0",
    "1:2": "w1 = 2 w2",
    "1:3": "w1 = 3 w2",
    "root": Message("a root is zero"),
    "pair": Message("two roots have the sum zero"),
}

#: Digits of a value in the terminal.
DIGITS = 20


def lines(interval: Along) -> Iterator[str]:
    """From the lower end to the upper one: what holds between values, and at each of them."""
    if interval.cyclic:
        text = "without the cyclic coordinates [[names]]"
        if interval.hamiltonian:
            text = "without the cyclic coordinates [[names]], their momenta unperturbed"
        yield Message(text, names=", ".join(interval.cyclic))
    ends = [str(interval.low), *(_number(special_value) for special_value in interval.specials), str(interval.high)]
    for k, between in enumerate(interval.between):
        short = [end if "/" in end or len(end) < 9 else f"{float(end):.6g}" for end in ends[k : k + 2]]
        text = "[[name]] from [[low]] to [[high]]: [[verdict]]"
        yield Message(text, name=interval.name, low=short[0], high=short[1], verdict=_said(between.judged))
        if k < len(interval.specials):
            special = interval.specials[k]
            yield joined((f"{interval.name} = {ends[k + 1]}", _told(special)), ": ")
            yield Message(
                "  [[what]]; [[name]] is a root of [[polynomial]]",
                what=joined((worded(VANISHING[key]) for key in special.vanishing), ", "),
                name=interval.name,
                polynomial=_polynomial(special.polynomial, interval.name),
            )
            yield from (joined(("  ", number), "") for number in _numbers(special.judged))
            if special.verdict is not None:
                continue
            if special.judged.outcome is Outcome.UNDECIDED and special.judged.why in REASONS:
                yield joined(("  ", worded(REASONS[special.judged.why])), "")
    yield Message("Between these values each verdict holds throughout (proved); the ends of the interval are left out.")


def _number(special: Special) -> str:
    return str(special.exactly) if special.exactly is not None else special.enclosure.str(DIGITS, radius=False)


def _told(special: Special) -> str:
    if special.verdict is None:
        return _said(special.judged)
    return with_theorem(special.verdict.word, special.verdict.theorems)


def _said(judged: Judged) -> str:
    outcome = worded(judged.outcome.value)
    if judged.theorem is Theorem.NONE:
        return outcome
    return Message("[[told]] ([[hint]])", told=outcome, hint=worded(judged.theorem.value))


def _numbers(judged: Judged) -> Iterator[str]:
    if judged.coefficient is not None and judged.amplitude_of and _is_zero(judged.coefficient):
        yield Message(
            "a pair of imaginary roots of frequency [[frequency]]; whether the growth of the amplitude of [[name]] has "
            "a term of third order is undecided",
            frequency=decimal(judged.frequencies[0]),
            name=judged.amplitude_of,
        )
    elif judged.degree is not None and judged.amplitude_of:
        yield Message(
            "a pair of imaginary roots of frequency [[frequency]], the growth of the amplitude of [[name]] has no term "
            "of third order and begins with [[rate]] times its power [[degree]]",
            frequency=decimal(judged.frequencies[0]),
            name=judged.amplitude_of,
            rate=decimal(judged.coefficient),
            degree=judged.degree,
        )
    elif judged.coefficient is not None and judged.amplitude_of:
        borders = {Outcome.ASYMPTOTIC: Message("a soft border: "), Outcome.UNSTABLE: Message("a hard border: ")}
        yield Message(
            "[[border]]a pair of imaginary roots of frequency [[frequency]], the amplitude of [[name]] grows at the "
            "rate [[rate]] times its cube",
            border=borders.get(judged.outcome, ""),
            frequency=decimal(judged.frequencies[0]),
            name=judged.amplitude_of,
            rate=decimal(judged.coefficient),
        )
    if judged.theorem is Theorem.EQUAL and judged.coefficient is not None:
        yield Message("delta A = [[value]] in Sokolskii's normal form", value=decimal(judged.coefficient))
    if judged.along:
        yield Message(
            "the energy along the direction of the zero root begins with [[rate]] times the power [[degree]] of the "
            "deviation of [[name]]",
            rate=decimal(judged.coefficient),
            degree=judged.degree,
            name=judged.along,
        )
    if judged.sides is not None:
        left, right = map(decimal, judged.sides)
        yield Message("|H4| = [[left]] on the resonance, against [[right]]", left=left, right=right)
    yield from (f"D{order} = {decimal(value)}" for order, value in judged.determinants if not _is_zero(value))


def _is_zero(value: Any) -> bool:
    return bool(value.contains(0)) if isinstance(value, arb) else value == 0


def _polynomial(coefficients: Sequence[int], name: str) -> str:
    """``675*mu**2 - 675*mu + 16``."""
    text = ""
    for power in reversed(range(len(coefficients))):
        c = coefficients[power]
        if c:
            factor = f"{name}**{power}" if power > 1 else name if power else ""
            number = "" if abs(c) == 1 and factor else str(abs(c))
            term = "*".join(x for x in (number, factor) if x)
            text += (" - " if c < 0 else " + ") + term if text else ("-" if c < 0 else "") + term
    return text


def as_text(system: System, interval: Along) -> str:
    """JSON: ``between`` has one entry more than ``values``."""
    return file_of(
        doc.Nonlinear,
        system,
        interval,
        parameter=interval.name,
        low=str(interval.low),
        high=str(interval.high),
        values=[
            doc.ExceptionalValue.from_result(
                special.judged,
                enclosure,
                value=_number(special),
                enclosure=special.enclosure,
                root_of=list(map(str, special.polynomial)),
                vanishing=[VANISHING[key] for key in special.vanishing],
                **_of_problem_6(special.verdict),
            )
            for special in interval.specials
        ],
        between=[doc.Between.from_result(gap.judged, enclosure, sample=str(gap.sample)) for gap in interval.between],
    )


def _of_problem_6(verdict: Verdict | None) -> dict[str, Any]:
    """In place of what terms of higher order leave open."""
    return {} if verdict is None else {"verdict": verdict.word, "theorem": verdict.theorem, "reason": ""}
