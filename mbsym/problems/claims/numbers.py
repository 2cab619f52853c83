"""Claimed numbers at a state: rigorous balls against the digits that were printed."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from flint import arb, ctx, fmpq

from mbsym.algebra.base import Lowering
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import NotRational
from mbsym.algebra.point import Balls
from mbsym.expressions.tree import (
    Expression,
    names,
)
from mbsym.mechanics.oracle import State
from mbsym.mechanics.programs import accelerated
from mbsym.model.claims import Claim
from mbsym.model.system import System, acceleration_name, velocity_name
from mbsym.problems.claims.counterexample import PRECISION, follow, shown
from mbsym.problems.claims.quantities import derived_quantity
from mbsym.problems.claims.result import DIFFERS, DIGITS, NUMERICAL, UNDECIDED, ClaimResult, Derived
from mbsym.problems.claims.signs_under_roots import ROUNDING
from mbsym.problems.claims.symbols import Symbols

#: Working precisions in bits: numbers whose digits cancel are tried again with more of them.
FINER = (PRECISION, 1024, 4096)


def examined_number(derived: Derived, claim: Claim, about: str) -> ClaimResult:
    """The derived value as a ball against the number that was printed, to its digits.

    A ball too wide to tell is computed again in more bits; where the most of them do not tell, nothing is decided.
    """
    for bits in FINER:
        with ctx.workprec(bits):
            result = _at_precision(derived, claim, about, last=bits == FINER[-1])
        if result is not None:
            return result
    return ClaimResult(claim, about, UNDECIDED, remark=f"too many digits cancel, even of {FINER[-1]} bits")


def _at_precision(derived: Derived, claim: Claim, about: str, last: bool) -> ClaimResult | None:
    """The verdict in the working precision, None where balls are too wide for one."""
    state = _state(derived.system, claim)
    symbols = Symbols(derived.system)
    try:
        printed = _number(symbols, state, claim.equals)
        if claim.of_expression is not None:
            value = _value(derived, symbols, state, claim.of_expression)
        else:
            value = Carrier(derived.ring, state.numbers, state.values)(derived_quantity(derived, claim))
    except KeyError as missing:
        raise NotRational(f"no number is given for {missing.args[0]}") from None
    for what, number in (("the value", value), ("the claimed value", printed)):
        if not number.is_finite():
            return ClaimResult(claim, about, UNDECIDED, remark=f"{what} is not finite") if last else None
    result = ClaimResult(claim, about, DIGITS, value=shown(value))
    error = abs(printed - value)
    if not claim.printed:
        if not error.contains(0):
            return replace(result, outcome=DIFFERS)
        # Where the value itself cannot be told from zero, there is nothing that it could be compared with.
        size = 1 + abs(value) if last else value.abs_lower()
        return replace(result, outcome=NUMERICAL) if error.rad() <= ROUNDING * size else None
    digits, unit = _printed(claim.printed)
    tolerance = arb(unit) / 2
    if error < tolerance or ((error - tolerance).contains(0) and error.rad() < ROUNDING * tolerance):
        return replace(result, printed_digits=digits, digits=digits)
    if not error > tolerance:
        return None
    return replace(result, outcome=DIFFERS, printed_digits=digits, digits=_agreeing(error, value, digits))


def _state(system: System, claim: Claim) -> State:
    """Numbers for parameters ('values', relations), and the initial state or the claim's own numbers, else zero."""
    values: dict[str, Any] = {"pi": arb.pi(), "t": arb(0)}
    for name in system.coordinates:
        values |= {name: arb(0), velocity_name(name): arb(0)}
    numbers = Balls(values)
    given = dict(claim.state)

    def lower(expression: Expression) -> Any:
        return Lowering(numbers, values)(expression)

    for parameter in system.parameters:
        chosen = given.get(parameter.name, parameter.value)
        if chosen is not None:
            values[parameter.name] = lower(chosen)
    follow(system, numbers, values)
    for moved in system.prescribed:
        if moved.initial is None or names(moved.initial) <= values.keys():
            start = arb(0) if moved.initial is None else lower(moved.initial)
            values[moved.name] = start
    for state in system.initial if claim.at_initial else ():
        for name, chosen in ((state.coordinate, state.position), (velocity_name(state.coordinate), state.velocity)):
            if chosen is not None and names(chosen) <= values.keys():
                values[name] = lower(chosen)
    for symbol in system.notation:
        if names(symbol.value) <= values.keys():
            values[symbol.name] = lower(symbol.value)
    for name, chosen in given.items():
        values[name] = lower(chosen)
    return State(numbers, values)


def _number(symbols: Symbols, state: State, expression: Expression) -> Any:
    wanted = symbols.occurring([expression])
    return symbols.lowering(state.numbers, state.values, wanted)(symbols.opened(expression))


def _value(derived: Derived, symbols: Symbols, state: State, expression: Expression) -> Any:
    """An expression at the state, its accelerations from the equations of motion."""
    wanted = symbols.occurring([expression])
    if any(acceleration_name(name) in wanted for name in derived.system.coordinates):
        state = accelerated(derived.system, state, derived.programs)
    return _number(symbols, state, expression)


def _printed(number: str) -> tuple[int, fmpq]:
    """Significant digits of a decimal number, and one unit of its last place."""
    mantissa, _, exponent = number.lower().lstrip("+-").partition("e")
    whole, _, decimals = mantissa.partition(".")
    digits = len((whole + decimals).lstrip("0")) or 1
    return digits, fmpq(10) ** (int(exponent or 0) - len(decimals))


def _agreeing(error: Any, value: Any, digits: int) -> int:
    """How many leading digits of the printed number are right, rounding allowed for."""
    if value.contains(0):
        return 0
    leading = (abs(value).mid().log() / arb(10).log()).floor().mid()  # the power of ten of the first digit
    right = 0
    while right < digits and 2 * error < arb(10) ** (leading - right):
        right += 1
    return right
