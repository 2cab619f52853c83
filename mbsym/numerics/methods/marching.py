"""Machine code that steps: ``march`` of a tableau, with steps of one length or with steps chosen by an error estimate.

    i64 @march(x, carry, old, k, clock, count, sizes)

makes steps until clock[UNTIL] is reached or passed; it returns REACHED, PAUSED (after count[LEFT] attempted steps) or
STOPPED (the step has become too small, or a value is no longer finite).  ``old`` is the state before the last step,
``k`` its stages, and then the slopes at its end, where they are known; by ``sizes`` errors of steps that are chosen are
measured (``magnitudes``).
"""

from __future__ import annotations

from fractions import Fraction
from math import log

import numpy as np

from mbsym.numerics.kernels.elimination import factorise, solve
from mbsym.numerics.kernels.llvm import Scalar
from mbsym.numerics.kernels.writer import INTEGER, POINTER, Function, Value
from mbsym.numerics.methods.tableaux import (
    Clock,
    Count,
    Reply,
    Rosenbrock,
    Stages,
    Tableau,
    add_compensated,
    clock_dtype,
)

#: Newton's steps to the constraints after every step: the first leaves the square of what the second has to do.
LED_BACK = 2

#: How much a step may grow or shrink at once, and the safety factor of the controller.  With 3/4 instead of the usual
#: 0.9 hardly a step is rejected: over nine systems and tolerances from 1e-5 to 1e-11 dop853 needs 13 % fewer
#: evaluations to equal error (3 to 21 % by the system), rk45 some 5 %.
GROWTH, SHRINKAGE, SAFETY = 6.0, 0.2, 0.75

#: The exponent of the integral part, by the order of the method.
INTEGRAL = {5: Fraction(4, 100), 8: Fraction(3, 100)}

ARGUMENTS = ("x", "carry", "old", "k", "clock", "count", "sizes")


def fixed_text(tableau: Tableau, size: int, scalar: Scalar, constrained: bool = False) -> str:
    """Steps of the length clock[STEP]: step number j begins at clock[BASE] + j h, so that no roundings add up.

    The increments of a step are kept behind the slopes in ``k``.  Where it is ``constrained``, every step ends on the
    constraints.
    """
    f = Function("march", [(name, POINTER) for name in ARGUMENTS])
    s = Stages(f, size, scalar)
    x, k, clock, count, old = f["x"], f["k"], f["clock"], f["count"], f["old"]
    stages = len(tableau.stages)
    moved = s.slope(k, stages + 1)
    total = f.slot(s.kind)
    step, base = f.load(s.clock, clock, Clock.STEP), f.load(s.clock, clock, Clock.BASE)
    h = step.converted(s.kind)
    again = f.here()
    time = f.load(s.clock, clock, Clock.TIME)
    _leave_when_due(f, s, time)
    if constrained:
        _stop_before_singular(f)
    known, unknown, first = (f.label() for _ in range(3))
    f.branch(f.load(INTEGER, count, Count.FRESH).compare("!=", 0), known, unknown)
    f.place(known)
    s.copy(s.slope(k, stages), s.slope(k, 0))
    f.store(0, INTEGER, count, Count.FRESH)
    f.jump(first)
    f.place(unknown)
    s.state_argument(x)
    s.evaluate(time, s.slope(k, 0))
    f.add(1, INTEGER, count, Count.EVALUATIONS)
    f.jump(first)
    f.place(first)
    for place, row in enumerate(tableau.stages[1:], 1):
        s.stage(x, k, row, place, time, step)
    f.add(stages - 1, INTEGER, count, Count.EVALUATIONS)
    f.store(0, s.kind, total)
    for i in f.each(size):
        change = h * s.combination(k, tableau.weights, i)
        f.store(change, s.kind, moved, i)
        f.store(f.load(s.kind, x, i), s.kind, old, i)
        new = add_compensated(f, s.kind, x, f["carry"], i, change)
        f.add(new - new, s.kind, total)
    f.leave_if(f.load(s.kind, total).compare("<=", 0), Reply.STOPPED, unless=True)
    number = f.load(INTEGER, count, Count.NUMBER) + 1
    f.store(number, INTEGER, count, Count.NUMBER)
    f.store(time, s.clock, clock, Clock.START)
    f.store(step, s.clock, clock, Clock.LAST)
    f.store(base + number.converted(s.clock) * step, s.clock, clock, Clock.TIME)
    if constrained:
        near = _led_back(f, s, moved)
    f.add(1, INTEGER, count, Count.STEPS)
    if constrained:
        _note(f, near)
    f.jump(again)
    return f.text()


def _leave_when_due(f: Function, s: Stages, time: Value) -> None:
    """Returns where the time has come, or as many steps as are allowed have been tried."""
    f.leave_if(time.compare(">=", f.load(s.clock, f["clock"], Clock.UNTIL)), Reply.REACHED)
    left = f.load(INTEGER, f["count"], Count.LEFT)
    f.leave_if(left.compare("<=", 0), Reply.PAUSED)
    f.store(left - 1, INTEGER, f["count"], Count.LEFT)


def _led_back(f: Function, s: Stages, moved: Value | None = None) -> Value:
    """The state is led to the constraints at the time of the clock by ``correct``; what sums carry stays with them.

    Where the increments of the step are kept, they are led with it.  Says whether that is too near to a singular
    position.
    """
    change = f.slot(s.kind, s.size + 1)
    for _ in range(LED_BACK):
        s.state_argument(f["x"])
        f.store(f.load(s.clock, f["clock"], Clock.TIME).converted(s.kind), s.kind, s.argument)
        f.do("correct", s.argument, change)
        for i in f.each(s.size):
            part = f.load(s.kind, change, i)
            add_compensated(f, s.kind, f["x"], f["carry"], i, part)
            if moved is not None:
                f.add(part, s.kind, moved, i)
    return f.load(s.kind, change, s.size).compare(">", 1)


def _note(f: Function, near: Value) -> None:
    """No step begins where this one ends, if that is too near to a singular position."""
    f.store(near.choose(f.number(1, INTEGER), f.number(0, INTEGER)), INTEGER, f["count"], Count.SINGULARLY)


def _stop_before_singular(f: Function) -> None:
    """Ends the run before a singular position of the constraints."""
    f.leave_if(f.load(INTEGER, f["count"], Count.SINGULARLY).compare("!=", 0), Reply.STOPPED)


def adaptive_text(tableau: Tableau | Rosenbrock, size: int, scalar: Scalar, constrained: bool = False) -> str:
    """Steps by the error estimate, with the controller of Hairer, Norsett & Wanner.

    Where it is ``constrained``, every step that is accepted ends on the constraints, and the next one begins with the
    slope there.
    """
    explicit = isinstance(tableau, Tableau)
    at_the_end = isinstance(tableau, Tableau) and tableau.first_same_as_last
    f = Function("march", [(name, POINTER) for name in ARGUMENTS])
    s = Stages(f, size, scalar)
    x, k, clock, count = f["x"], f["k"], f["clock"], f["count"]
    stages = len(tableau.stages)
    candidate, unchanged = f.slot(s.kind, size), f.slot(s.kind, size)
    relative = f.load(s.clock, clock, Clock.RELATIVE).converted(s.kind)
    absolute = f.load(s.clock, clock, Clock.ABSOLUTE).converted(s.kind)

    good, bad = f.label(), f.label()
    again = f.here()
    time = f.load(s.clock, clock, Clock.TIME)
    _leave_when_due(f, s, time)
    if constrained:
        _stop_before_singular(f)
    step = f.load(s.clock, clock, Clock.STEP)
    least = time.absolute() * (4 * Fraction(float(np.finfo(clock_dtype(s.clock)).eps)))
    large = step.compare(">", least) & step.compare(">", Fraction(1, 10**200))
    f.leave_if(large, Reply.STOPPED, unless=True)
    # The last slope of an accepted step is the first of the next; it is copied late because dense output needs both.
    if explicit:
        with f.when(f.load(INTEGER, count, Count.FRESH).compare("!=", 0)):
            s.copy(s.slope(k, stages), s.slope(k, 0))
            f.store(0, INTEGER, count, Count.FRESH)
    if isinstance(tableau, Tableau):
        for place, row in enumerate(tableau.stages[1:], 1):
            s.stage(x, k, row, place, time, step)
        evaluations, weight = stages - 1 + at_the_end, step
    else:
        _linear_stages(f, s, tableau, time, step)
        evaluations, weight = stages, f.number(1, s.clock)
    h = weight.converted(s.kind)
    for i in f.each(size):
        change = h * s.combination(k, tableau.weights, i)
        f.store(change, s.kind, unchanged, i)
        f.store(f.load(s.kind, x, i) + change, s.kind, candidate, i)
    if at_the_end:
        s.state_argument(candidate)
        s.evaluate(time + step, s.slope(k, stages))
    error = estimated(f, s, tableau, x, candidate, k, weight, relative, absolute)
    f.add(evaluations, INTEGER, count, Count.EVALUATIONS)
    f.branch(error.compare("<=", 1), good, bad)

    f.place(bad)
    shrink, usable = shrinkage(f, tableau, error)
    f.store(step * shrink.converted(s.clock), s.clock, clock, Clock.STEP)
    f.add(1, INTEGER, count, Count.REJECTED)
    f.store(usable.choose(f.number(0, INTEGER), f.number(1, INTEGER)), INTEGER, count, Count.INFINITE)
    f.store(1, INTEGER, count, Count.CAREFUL)
    f.jump(again)

    f.place(good)
    for i in f.each(size):
        f.store(f.load(s.kind, x, i), s.kind, f["old"], i)
        new = add_compensated(f, s.kind, x, f["carry"], i, f.load(s.kind, unchanged, i)).absolute()
        largest = f.load(s.kind, f["sizes"], i)
        f.store(largest.compare("<", new).choose(new, largest), s.kind, f["sizes"], i)
    f.store(time, s.clock, clock, Clock.START)
    f.store(step, s.clock, clock, Clock.LAST)
    add_compensated(f, s.clock, clock, f.at(s.clock, clock, Clock.TIME_CARRY), Clock.TIME, step)
    if constrained:
        near = _led_back(f, s)
    if explicit and (constrained or not at_the_end):
        s.state_argument(x)
        s.evaluate(f.load(s.clock, clock, Clock.TIME), s.slope(k, stages))
        f.add(1, INTEGER, count, Count.EVALUATIONS)
    f.store(1, INTEGER, count, Count.FRESH)
    f.store(0, INTEGER, count, Count.INFINITE)
    f.add(1, INTEGER, count, Count.STEPS)
    careful = f.load(INTEGER, count, Count.CAREFUL).compare("!=", 0)
    factor, size_of_error = growth(f, tableau, error, f.load(s.clock, clock, Clock.PREVIOUS).converted(f.real), careful)
    grown, longest = step * factor.converted(s.clock), f.load(s.clock, clock, Clock.LONGEST)
    f.store(grown.compare("<", longest).choose(grown, longest), s.clock, clock, Clock.STEP)
    f.store(size_of_error.converted(s.clock), s.clock, clock, Clock.PREVIOUS)
    f.store(0, INTEGER, count, Count.CAREFUL)
    if constrained:
        _note(f, near)
    f.jump(again)
    return f.text()


def _linear_stages(f: Function, s: Stages, tableau: Rosenbrock, time: Value, step: Value) -> None:
    """The u_i of a step in the rows of ``k``, and f at its begin behind them; the matrix is factorised once.

    They are no numbers where a derivative is not finite: 1/inf = 0 would make a step of it in which nothing moves.
    """
    x, k, size = f["x"], f["k"], s.size
    slopes = f.slot(s.kind, size + size * size)
    matrix, exchanged = f.slot(s.kind, size * size), f.slot(INTEGER, size)
    inverse, h = (1 / step).converted(s.kind), step.converted(s.kind)
    begin = s.slope(k, tableau.begin)
    s.state_argument(x)
    s.evaluate(time, begin)
    f.do("slopes", s.argument, slopes)
    f.add(1, INTEGER, f["count"], Count.JACOBIANS)
    nothing = f.slot(s.kind)
    f.store(0, s.kind, nothing)
    for i in f.each(size):
        by_time = f.load(s.kind, slopes, i)
        f.add(by_time - by_time, s.kind, nothing)
    with f.repeat(size * size) as entry:
        slope = f.load(s.kind, slopes, entry + size)
        f.add(slope - slope, s.kind, nothing)
        f.store(0 - slope, s.kind, matrix, entry)
    with f.repeat(size) as row:
        place = row * (size + 1)
        f.add(inverse / tableau.gamma, s.kind, matrix, place)
    factorise(f, s.kind, matrix, size, exchanged)
    for number, (stage, coupling) in enumerate(zip(tableau.stages, tableau.coupling, strict=True)):
        own = s.slope(k, number)
        if number:
            for i in f.each(size):
                f.store(f.load(s.kind, x, i) + s.combination(k, stage, i), s.kind, s.argument, i + 1)
            s.evaluate(time + step * tableau.times[number], own)
        else:
            s.copy(begin, own)
        for i in f.each(size):
            total = (
                f.load(s.kind, own, i)
                + f.load(s.kind, nothing)
                + h * tableau.slopes[number] * f.load(s.kind, slopes, i)
            )
            if number:
                total = total + inverse * s.combination(k, coupling, i)
            f.store(total, s.kind, own, i)
        solve(f, s.kind, matrix, own, size, exchanged)


def estimated(
    f: Function,
    s: Stages,
    tableau: Tableau | Rosenbrock,
    x: Value,
    new: Value,
    k: Value,
    step: Value,
    relative: Value,
    absolute: Value,
) -> Value:
    """The estimated error of a step, 1 where it is just tolerable.

    One estimate e:  h |e|;  two, as in DOP853:  h e5^2 / sqrt(e5^2 + e3^2/100)  (root mean squares, e_i in units of
    ``absolute`` L_i + ``relative`` |x_i|, the L_i being the sizes).  ``step`` is h, or 1 where estimates are those of a
    whole step.
    """
    totals = [f.slot(f.real) for _ in tableau.errors]
    for total in totals:
        f.store(0, f.real, total)
    for i in f.each(size := s.size):
        before, after = f.load(s.kind, x, i).absolute(), f.load(s.kind, new, i).absolute()
        scale = absolute * f.load(s.kind, f["sizes"], i) + relative * before.compare("<", after).choose(after, before)
        inverse = 1 / scale
        for total, row in zip(totals, tableau.errors, strict=True):
            value = (s.combination(k, row, i) * inverse).converted(f.real)
            f.add(value * value, f.real, total)
    squares = [f.load(f.real, total) for total in totals]
    h = step.converted(f.real).absolute()
    if len(squares) == 1:
        return h * f.call("sqrt", f.real, squares[0] / size)
    bottom = (squares[0] + squares[1] * Fraction(1, 100)) * size
    nothing = bottom.compare("<=", 0)
    root = f.call("sqrt", f.real, nothing.choose(f.number(1, f.real), bottom))
    return h * squares[0] / root


def shrinkage(f: Function, tableau: Tableau | Rosenbrock, error: Value) -> tuple[Value, Value]:
    """What a rejected step is multiplied by, and whether its error is a usable number."""
    usable = error.compare("<", Fraction(10) ** 30)
    power = f.call("exp", f.real, f.call("log", f.real, error) * Fraction(-1, tableau.order)) * Fraction(SAFETY)
    shrink = power.compare(">", Fraction(SHRINKAGE)).choose(power, f.number(Fraction(SHRINKAGE), f.real))
    return usable.choose(shrink, f.number(Fraction(1, 10), f.real)), usable


def growth(
    f: Function, tableau: Tableau | Rosenbrock, error: Value, before: Value, careful: Value
) -> tuple[Value, Value]:
    """min(6, max(1/5, 3/4 err^-a before^b)) with a = 1/q - 3b/4, and log err, which is ``before`` the next time.

    No growth right after a rejected step (``careful``).
    """
    integral = INTEGRAL[tableau.order]
    alpha = Fraction(1, tableau.order) - integral * Fraction(3, 4)
    floor = f.number(Fraction(1, 10**10), f.real)
    size = f.call("log", f.real, error.compare(">", floor).choose(error, floor))
    factor = f.call("exp", f.real, before * integral - size * alpha) * Fraction(SAFETY)
    limit = careful.choose(f.number(1, f.real), f.number(Fraction(GROWTH), f.real))
    factor = factor.compare("<", limit).choose(factor, limit)
    least, lower = f.number(Fraction(SHRINKAGE), f.real), f.number(Fraction(log(1e-4)), f.real)
    factor = factor.compare(">", least).choose(factor, least)
    return factor, size.compare(">", lower).choose(size, lower)
