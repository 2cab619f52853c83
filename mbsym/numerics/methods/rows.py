"""Machine code for dense output: the terms of the last step, and rows of states at as many times as are asked for.

With s the fraction of a step of length h,

    x(s) = x + s (F0 + (1 - s) (F1 + s (F2 + (1 - s) (F3 + ...)))),
    F0 = x_new - x,   F1 = h f_old - F0,   F2 = 2 F0 - h (f_old + f_new).

Further terms are those of the tableau; where it has none (steps of one length) they fit q, q' and q'' at both ends,

    q:   F3 = h^2 q''_old / 2 + F1 - F2,   F4 = h^2 q''_new / 2 + F1 + 2 F2 - F3,
    q':  F3 = 30 ((q_new - q)/h - q'_old - F0/2 - F1/6 - F2/12),                        so that q' = dq/dt,

with an error of order h^6 in q and h^5 in q'.  Where the states are no pairs of q and q', there are no further terms:
the cubic that fits x and x' at both ends, with an error of order h^4.
"""

from __future__ import annotations

from fractions import Fraction

from mbsym.numerics.kernels.llvm import Scalar
from mbsym.numerics.kernels.writer import INTEGER, POINTER, Function, Value
from mbsym.numerics.methods.marching import ARGUMENTS
from mbsym.numerics.methods.tableaux import (
    EVALUATIONS,
    FRESH,
    LAST,
    PREPARED,
    REACHED,
    REPLY,
    SLACK,
    START,
    STEPS,
    TIME,
    UNTIL,
    Stages,
    Tableau,
)


def terms_of(tableau: Tableau) -> int:
    """How many terms F there are."""
    return 3 + (len(tableau.dense) or 2)


def dense_text(tableau: Tableau, size: int, scalar: Scalar, pairs: bool = True) -> str:
    """``@prepare``, ``@rows`` and ``@fill``; see there.  ``pairs``: the states are (q, q')."""
    prepare = _prepare_text if tableau.errors else _prepare_fixed_text if pairs else _prepare_cubic_text
    return prepare(tableau, size, scalar) + _rows_text(terms_of(tableau), size, scalar) + _fill_text(scalar)


def _prepare_text(tableau: Tableau, size: int, scalar: Scalar) -> str:
    """``i64 @prepare(x, old, k, terms, clock, count)``: the terms F of the last step."""
    f = Function("prepare", [(name, POINTER) for name in ("x", "old", "k", "terms", "clock", "count")])
    s = Stages(f, size, scalar, apart=True)  # once a step at most: not worth compiling over and over
    k, stages = f["k"], len(tableau.stages)
    time, step = f.load(s.clock, f["clock"], START), f.load(s.clock, f["clock"], LAST)
    for place, row in enumerate(tableau.extra):
        s.stage(f["old"], k, row, stages + 1 + place, time, step)
    h = step.converted(s.kind)
    for i in f.each(size):
        change = f.load(s.kind, f["x"], i) - f.load(s.kind, f["old"], i)
        first, last = h * f.load(s.kind, k, i), h * f.load(s.kind, k, i + stages * size)
        terms = [change, first - change, 2 * change - (first + last)]
        terms += [h * s.combination(k, row, i) for row in tableau.dense]
        _keep(f, s, terms, i)
    _count(f, len(tableau.extra))
    f.leave(0)
    return f.text()


def _prepare_fixed_text(tableau: Tableau, size: int, scalar: Scalar) -> str:
    """The same for steps of one length; the slopes at the end, found here, begin the next step."""
    f = Function("prepare", [(name, POINTER) for name in ("x", "old", "k", "terms", "clock", "count")])
    s = Stages(f, size, scalar, apart=True)
    k, stages, half = f["k"], len(tableau.stages), size // 2
    step = f.load(s.clock, f["clock"], LAST)
    s.state_argument(f["x"])
    s.evaluate(f.load(s.clock, f["clock"], TIME), s.slope(k, stages))
    f.store(1, INTEGER, f["count"], FRESH)
    h = step.converted(s.kind)
    for i in f.each(half):
        place, speed = i, i + half

        def slopes(row: Value | int) -> tuple[Value, Value, Value]:
            begin, end = h * f.load(s.kind, k, row), h * f.load(s.kind, k, row + stages * size)
            return f.load(s.kind, k, row + (stages + 1) * size), begin, end

        change, begin, end = slopes(place)
        faster, pushed, pushed_last = slopes(speed)
        first, second = begin - change, 2 * change - (begin + end)
        third = h * pushed * Fraction(1, 2) + first - second
        fourth = h * pushed_last * Fraction(1, 2) + first + 2 * second - third
        _keep(f, s, [change, first, second, third, fourth], place)
        first, second = pushed - faster, 2 * faster - (pushed + pushed_last)
        missing = change / h - f.load(s.kind, f["old"], speed) - faster * Fraction(1, 2)
        third = 30 * (missing - first * Fraction(1, 6) - second * Fraction(1, 12))
        _keep(f, s, [faster, first, second, third, f.number(0, s.kind)], speed)
    _count(f, 1)
    f.leave(0)
    return f.text()


def _prepare_cubic_text(tableau: Tableau, size: int, scalar: Scalar) -> str:
    """The same for states that are no pairs."""
    f = Function("prepare", [(name, POINTER) for name in ("x", "old", "k", "terms", "clock", "count")])
    s = Stages(f, size, scalar, apart=True)
    k, stages = f["k"], len(tableau.stages)
    step = f.load(s.clock, f["clock"], LAST)
    s.state_argument(f["x"])
    s.evaluate(f.load(s.clock, f["clock"], TIME), s.slope(k, stages))
    f.store(1, INTEGER, f["count"], FRESH)
    h = step.converted(s.kind)
    for i in f.each(size):
        begin, end = h * f.load(s.kind, k, i), h * f.load(s.kind, k, i + stages * size)
        change = f.load(s.kind, k, i + (stages + 1) * size)
        nothing = f.number(0, s.kind)
        _keep(f, s, [change, begin - change, 2 * change - (begin + end), nothing, nothing], i)
    _count(f, 1)
    f.leave(0)
    return f.text()


def _keep(f: Function, s: Stages, terms: list[Value], i: Value | int) -> None:
    for place, term in enumerate(terms):
        f.store(term, s.kind, f["terms"], i + place * s.size)


def _count(f: Function, evaluations: int) -> None:
    f.store(f.load(INTEGER, f["count"], EVALUATIONS) + evaluations, INTEGER, f["count"], EVALUATIONS)
    f.store(f.load(INTEGER, f["count"], STEPS), INTEGER, f["count"], PREPARED)


def _rows_text(terms: int, size: int, scalar: Scalar) -> str:
    """``i64 @rows(x, old, terms, clock, times, out, first, last, stride)``: states at times[first:last] of one step.

    Component i of the state at times[r] goes to out[i stride + r].
    """
    pointers = [(name, POINTER) for name in ("x", "old", "terms", "clock", "times", "out")]
    f = Function("rows", [*pointers, *((name, INTEGER) for name in ("first", "last", "stride"))])
    s = Stages(f, size, scalar)
    kind, clock = s.kind, s.clock
    start, length, end = (f.load(clock, f["clock"], place) for place in (START, LAST, TIME))
    inverse = 1 / length
    with f.repeat(size) as i:
        begin, arrived = f.load(kind, f["old"], i), f.load(kind, f["x"], i)
        known = [f.load(kind, f["terms"], i + place * size) for place in range(terms)]
        row = f.at(kind, f["out"], i * f["stride"])
        with f.repeat(f["last"], f["first"]) as r:
            time = f.load(clock, f["times"], r)
            share = ((time - start) * inverse).converted(kind)
            rest = 1 - share
            total: Value | None = None
            for place in reversed(range(terms)):
                total = known[place] if total is None else known[place] + total
                total = total * (share if place % 2 == 0 else rest)
            assert total is not None
            f.store(time.compare("==", end).choose(arrived, begin + total), kind, row, r)
    f.leave(0)
    return f.text()


def _fill_text(scalar: Scalar) -> str:
    """``i64 @fill(x, carry, old, k, clock, count, terms, times, out, first, last, stride)``: rows, and steps for them.

    Returns the number of the first row that is not filled; where that is not ``last``, count[REPLY] says why.
    """
    pointers = [(name, POINTER) for name in (*ARGUMENTS, "terms", "times", "out")]
    f = Function("fill", [*pointers, *((name, INTEGER) for name in ("first", "last", "stride"))])
    clock = Stages(f, 0, scalar).clock
    times, count, last = f["times"], f["count"], f["last"]
    row, end = f.slot(INTEGER), f.slot(INTEGER)
    f.store(f["first"], INTEGER, row)
    slack = f.load(clock, f["clock"], SLACK)
    again, over, go, reached, stopped, found = (f.label() for _ in range(6))
    f.jump(again)
    f.place(again)
    now = f.load(INTEGER, row)
    f.branch(now.compare(">=", last), over, go)
    f.place(over)
    f.leave(last)
    f.place(go)
    f.store(f.load(clock, times, now) - slack, clock, f["clock"], UNTIL)
    reply = f.call("march", INTEGER, *(f[name] for name in ARGUMENTS))
    f.branch(reply.compare("==", REACHED), reached, stopped)
    f.place(stopped)
    f.store(reply, INTEGER, count, REPLY)
    f.leave(now)
    f.place(reached)
    with f.when(f.load(INTEGER, count, PREPARED).compare("!=", f.load(INTEGER, count, STEPS))):
        prepared = ("x", "old", "k", "terms", "clock", "count")
        f.call("prepare", INTEGER, *(f[name] for name in prepared))
    f.store(now + 1, INTEGER, end)
    more, one_more, check = f.label(), f.label(), f.label()
    f.jump(check)
    f.place(check)
    upto = f.load(INTEGER, end)
    f.branch(upto.compare("<", last), more, found)
    f.place(more)
    within = (f.load(clock, times, upto) - slack).compare("<=", f.load(clock, f["clock"], TIME))
    f.branch(within, one_more, found)
    f.place(one_more)
    f.store(upto + 1, INTEGER, end)
    f.jump(check)
    f.place(found)
    arguments = [f[name] for name in ("x", "old", "terms", "clock", "times", "out")]
    f.call("rows", INTEGER, *arguments, now, f.load(INTEGER, end), f["stride"])
    f.store(f.load(INTEGER, end), INTEGER, row)
    f.jump(again)
    return f.text()
