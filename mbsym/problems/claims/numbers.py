"""Claimed numbers at a state: rigorous balls against the digits that were printed."""

from __future__ import annotations

import random
from dataclasses import replace
from typing import Any

from flint import arb, ctx, fmpq

from mbsym.algebra.base import Lowering
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import NOT_THERE, NotRational
from mbsym.algebra.point import Balls
from mbsym.expressions.message import Message
from mbsym.expressions.tree import Expression, Name, names, text
from mbsym.mechanics.oracle import State
from mbsym.mechanics.programs import accelerated
from mbsym.mechanics.states import SEED
from mbsym.model.claims import Claim
from mbsym.model.system import System, acceleration_name, velocity_name
from mbsym.problems.claims.comparison import ROUNDING
from mbsym.problems.claims.counterexample import DIGITS_SHOWN, PRECISION, follow, shown
from mbsym.problems.claims.quantities import derived_quantity
from mbsym.problems.claims.result import ClaimResult, Derived, Outcome
from mbsym.problems.claims.symbols import Symbols

#: The value is shown to so many digits more than the claim has.
MORE_DIGITS = 2
#: Decimal digits in which doubles are printed, and the bits of their mantissas.
DIGITS_OF_DOUBLES, BITS_OF_DOUBLES = range(15, 18), 53
UNIT_OF_DOUBLES = fmpq(1, 2 ** (BITS_OF_DOUBLES - 1))
#: Computations that are rounded in different ways, and how many times their largest error another way may have.
ROUNDED_WAYS, OTHER_WAYS = 8, 2
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
    return ClaimResult(
        claim, about, Outcome.UNDECIDED, remark=Message("too many digits cancel, even of [[most]] bits", most=FINER[-1])
    )


def _at_precision(derived: Derived, claim: Claim, about: str, last: bool) -> ClaimResult | None:
    """The verdict in the working precision, None where balls are too wide for one."""
    try:
        printed, value = _both(derived, claim)
    except KeyError as missing:
        raise NotRational("no number is given for [[name]]", name=missing.args[0]) from None
    for what, number in ((Message("the value"), value), (Message("the claimed value"), printed)):
        if not number.is_finite():
            return (
                ClaimResult(claim, about, Outcome.UNDECIDED, remark=Message("[[what]] is not finite", what=what))
                if last
                else None
            )
    digits, unit = _printed(claim.printed) if claim.printed else (0, fmpq(0))
    result = ClaimResult(claim, about, Outcome.DIGITS, value=shown(value, max(DIGITS_SHOWN, digits + MORE_DIGITS)))
    error = abs(printed - value)
    if claim.tolerance is not None or claim.digits:
        return _within(claim, result, printed, error)
    if not unit:  # an expression, or a bare zero
        if not error.contains(0):
            return replace(result, outcome=Outcome.DIFFERS)
        # Where the value itself cannot be told from zero, there is nothing that it could be compared with.
        size = 1 + abs(value) if last else value.abs_lower()
        if error.rad() > ROUNDING * size:
            return None
        return (
            replace(result, printed_digits=1, digits=1) if claim.printed else replace(result, outcome=Outcome.NUMERICAL)
        )
    tolerance = arb(unit) / 2
    if _is_below(error, tolerance):
        return replace(result, printed_digits=digits, digits=digits)
    if not error > tolerance:
        return None
    right = _agreeing(error, value, digits)
    if digits in DIGITS_OF_DOUBLES and error < _rounding_of_doubles(derived, claim, value):
        claim_result = replace(result, outcome=Outcome.DOUBLES)
        return claim_result if value.contains(0) else replace(claim_result, printed_digits=digits, digits=right)
    return replace(result, outcome=Outcome.DIFFERS, printed_digits=digits, digits=right)


def _both(derived: Derived, claim: Claim) -> tuple[Any, Any]:
    """The claimed and the derived number as balls of the working precision.  Raises KeyError where a number lacks."""
    state = _state(derived.system, claim)
    printed = _number(Symbols.of(derived), _with_speeds(derived, state), claim.equals)
    return printed, _derived_number(derived, claim, state)


def _derived_number(derived: Derived, claim: Claim, state: State) -> Any:
    """The derived quantity at the state."""
    state = _with_speeds(derived, state)
    if claim.of_expression is not None:
        return _value(derived, Symbols.of(derived), state, claim.of_expression)
    if claim.kind == "acceleration":
        return _value(derived, Symbols.of(derived), state, Name(rate_of(derived.system, claim.of)))
    return Carrier(derived.ring, state.numbers, state.values)(derived_quantity(derived, claim))


def rate_of(system: System, name: str) -> str:
    """The name of the acceleration of a coordinate, or of the rate of a speed."""
    return acceleration_name(name) if name in system.coordinates else velocity_name(name)


def _with_speeds(derived: Derived, state: State) -> State:
    """The state with speeds, unit vectors and their derivatives, where the system has such variables."""
    if not derived.system.speeds:
        return state
    from mbsym.mechanics.oracle import Oracle
    from mbsym.mechanics.speed_states import completed  # few systems have speeds of their own

    return completed(Oracle(derived.system, _accelerated(derived, state)))


def _within(claim: Claim, result: ClaimResult, printed: Any, error: Any) -> ClaimResult | None:
    """The verdict where the claim says how exact it is meant."""
    if claim.tolerance is not None:
        tolerance, words = Lowering(Balls({}), {"pi": arb.pi()})(claim.tolerance), text(claim.tolerance)
    elif printed.contains(0):
        return replace(
            result, outcome=Outcome.UNDECIDED, remark="a claimed zero has no significant digits: give a tolerance"
        )
    else:
        first = (abs(printed).mid().log() / arb(10).log()).floor().mid()
        tolerance = arb(10) ** (first - claim.digits + 1) / 2
        words = Message("1 digit") if claim.digits == 1 else Message("[[count]] digits", count=claim.digits)
    if _is_below(error, tolerance):
        return replace(result, outcome=Outcome.TOLERANCE, remark=words)
    return (
        replace(result, outcome=Outcome.DIFFERS, remark=Message("by more than [[words]]", words=words))
        if error > tolerance
        else None
    )


def _is_below(error: Any, tolerance: Any) -> bool:
    """Whether an error is within a tolerance, or just as large."""
    return bool(error < tolerance or ((error - tolerance).contains(0) and error.rad() < ROUNDING * tolerance))


def _rounding_of_doubles(derived: Derived, claim: Claim, value: Any) -> Any:
    """What the rounding of doubles can explain of an error.

    The quantity is computed in 53 bits from inputs that are changed by half a unit in their last place, at random (the
    same ones every time), and several times the largest error found is allowed, and a unit in the last place of the
    value: who computed the number may have taken another way.  What is zero has no digits; there the unit is that of
    the largest number at the state.

    Source: the stochastic arithmetic of Vignes (CESTAC).
    """
    source, worst, largest = random.Random(SEED), arb(0), arb(0)
    for _ in range(ROUNDED_WAYS):
        with ctx.workprec(BITS_OF_DOUBLES):
            state = _state(derived.system, claim)
            changed = {}
            for name, number in state.values.items():
                largest = max(largest, arb(abs(number).mid()), key=float)
                changed[name] = number * (1 + UNIT_OF_DOUBLES * fmpq(source.randint(-8, 8), 16))
            try:
                recomputed = _derived_number(derived, claim, State(Balls(changed), changed)).mid()
            except NOT_THERE:
                return arb(0)
        worst = max(worst, abs(arb(recomputed) - value).upper(), key=float)
    unit = largest if value.contains(0) else abs(value)
    return OTHER_WAYS * worst + unit * UNIT_OF_DOUBLES


def _state(system: System, claim: Claim) -> State:
    """Numbers for parameters ('values', relations), and the initial state or the claim's own numbers, else zero."""
    values: dict[str, Any] = {"pi": arb.pi(), "t": arb(0)}
    for name in system.coordinates:
        values |= {name: arb(0), velocity_name(name): arb(0)}
    numbers = Balls(values)
    expressions = dict(claim.state)

    def lower(expression: Expression) -> Any:
        return Lowering(numbers, values)(expression)

    for parameter in system.parameters:
        chosen = expressions.get(parameter.name, parameter.value)
        if chosen is not None:
            values[parameter.name] = lower(chosen)
    follow(system, numbers, values)
    for moved in system.prescribed:
        if moved.initial is None or names(moved.initial) <= values.keys():
            start = arb(0) if moved.initial is None else lower(moved.initial)
            values[moved.name] = start
    if claim.at_initial and system.start:
        raise NotRational("the initial state is given in declared variables: give the claim a state in coordinates")
    for state in system.initial if claim.at_initial else ():
        for name, chosen in ((state.coordinate, state.position), (velocity_name(state.coordinate), state.velocity)):
            if chosen is not None and names(chosen) <= values.keys():
                values[name] = lower(chosen)
    for symbol in system.notation:
        if names(symbol.value) <= values.keys():
            values[symbol.name] = lower(symbol.value)
    for name, chosen in expressions.items():
        values[name] = lower(chosen)
    return State(numbers, values)


def _number(symbols: Symbols, state: State, expression: Expression) -> Any:
    occurring = symbols.occurring([expression])
    return symbols.lowering(state.numbers, state.values, occurring)(symbols.opened(expression))


def _value(derived: Derived, symbols: Symbols, state: State, expression: Expression) -> Any:
    """An expression at the state, its accelerations from the equations of motion."""
    occurring = symbols.occurring([expression])
    if any(acceleration_name(name) in occurring for name in derived.system.coordinates):
        state = _accelerated(derived, state)
    return _number(symbols, state, expression)


def _accelerated(derived: Derived, state: State) -> State:
    if not derived.system.constraints:
        return accelerated(derived.system, state, derived.programs)
    from mbsym.problems.claims.constrained import accelerated_at  # most systems have no constraints

    return accelerated_at(derived.system.without_speeds, derived.ring, derived.equations.constraints, state)


def _printed(number: str) -> tuple[int, fmpq]:
    """Significant digits of a decimal number, and one unit of its last place (none of a bare zero)."""
    mantissa, _, exponent = number.lower().lstrip("+-").partition("e")
    whole, _, decimals = mantissa.partition(".")
    figures = (whole + decimals).lstrip("0")
    if not figures and not decimals:
        return 1, fmpq(0)
    return len(figures) or 1, fmpq(10) ** (int(exponent or 0) - len(decimals))


def _agreeing(error: Any, value: Any, digits: int) -> int:
    """How many leading digits of the printed number are right, rounding allowed for."""
    if value.contains(0):
        return 0
    leading = (abs(value).mid().log() / arb(10).log()).floor().mid()  # the power of ten of the first digit
    right = 0
    while right < digits and 2 * error < arb(10) ** (leading - right):
        right += 1
    return right
