"""What follows from measurements at the extremes, in sentences: each from the rows, and from nothing else."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from math import isfinite

from mbsym.numerics.borders import BORDER
from mbsym.numerics.extremes.extremes import LISTED, Compensated, Extremes, Row, VerdictRow
from mbsym.numerics.extremes.singular import Singularities, SingularSet
from mbsym.numerics.extremes.singular_kinds import BOTH, CHART, MODEL, OPEN
from mbsym.numerics.extremes.singular_positions import SingularPositions
from mbsym.numerics.kernels.interface import FLOAT32, FLOAT64
from mbsym.numerics.probes import EQUILIBRIUM, RATES, RATIO, SINGULAR
from mbsym.numerics.trade.digits import FEW, FULL

#: Sums are called good where float64 keeps at least so many digits.
GOOD = 10.0

#: A gain of fewer digits is not told.
TOLD = 0.5


def sentences(found: Extremes, file: str = "FILE") -> Iterator[str]:
    """Where the model breaks down, in plain words; each follows from the rows.

    ``file`` stands in the commands that are advised.
    """
    if found.falling is not None and found.falling.joined - found.falling.apart >= TOLD:
        yield (
            f"Gravity and the acceleration of {', '.join(found.falling.frames)} are joined before numbers are put in: "
            f"with the bodies at rest float64 keeps {found.falling.joined:.1f} digits of the forcing, "
            f"where term by term it would keep {found.falling.apart:.1f}."
        )
    if found.positions is not None:
        yield from lost_rank(found.positions)
    if found.singularities is not None:
        yield from _where(found.singularities, file, None if found.positions is None else found.positive)
    yield from _near(found)
    yield from _pairs(found)
    yield from _range(found, RATES, "Rates")
    yield from _range(found, EQUILIBRIUM, "States at distances from the unperturbed motion")
    yield from _ratios(found, file)
    if found.eigenvalues:
        yield f"Eigenvalues of the first approximation at the given values, in proved enclosures: {_roots(found)}."
    yield from _verdicts(found)
    yield from _formulas(found)


def _onward(sizes: Iterable[float], bad: Iterable[float]) -> str:
    """``from 1e-05 on`` where everything nearer is bad as well, else the places one by one."""
    places = sorted(set(bad), reverse=True)
    if {size for size in sizes if size <= places[0]} == set(places):
        return f"from {places[0]:.0e} on"
    return "at " + ", ".join(f"{place:.0e}" for place in places)


def _short(size: float) -> str:
    """``1e-8``, ``1e8``."""
    return f"{size:.0e}".replace("e-0", "e-").replace("e+0", "e").replace("e+", "e")


def _pairs(found: Extremes) -> Iterator[str]:
    """Where kernels carry operations in pairs: what that keeps, and what it costs."""
    said: dict[str, list[Compensated]] = {}
    for one in found.compensated:
        said.setdefault(one.subject, []).append(one)
    for subject, places in said.items():
        where = (
            f"{subject} times {', '.join(f'{one.size:.0e}' for one in places)}" if subject else "At the given values"
        )
        worst = min(places, key=lambda one: one.found.after)
        dearest = max(one.found.cost for one in places)
        yield (
            f"{where}: float64 kernels carry {worst.found.sensitive} operations of the accelerations in pairs of "
            f"numbers and keep {worst.found.after:.1f} digits there, where plain ones keep "
            f"{worst.found.before:.1f}; they take up to {dearest:.1f} times as many operations."
        )
    if said:
        least = min(one.found.before for one in found.compensated)
        yield (
            f"Ensembles (mbsym simulate --vary) are computed with plain kernels: of the accelerations they keep "
            f"{least:.1f} digits where these are fewest."
        )


def lost_rank(found: SingularPositions) -> Iterator[str]:
    """Where constraints lose their rank, how that is known, and that a search is no proof."""
    yield (
        "States are led to the constraints; mass matrix and forcing, and where that matrix is singular, are those of "
        "the tree without them."
    )
    when = " at t = 0" if found.moving else ""
    for one in found.found:
        how = "proved by rational arithmetic" if one.proved else "to the roundings of float64"
        near = "; others are next to it" if one.family else ""
        yield (
            f"The constraints lose their rank{when} where {one.text}: {one.rank} of {one.usual} rows are independent "
            f"there ({how}){near}."
        )
    what = "These were" if found.found else f"No position in which constraints lose their rank{when} was"
    more = ", more than are listed" if found.more else ""
    others = "no others" if found.found else "none"
    yield f"{what} found from {found.starts} starts{more}, which is no proof that there are {others}."


#: With constraints, what their directions make of a singular matrix of the tree.
_ALLOWED = {
    True: "on what the constraints allow it is positive there, where that was looked at (in float64)",
    False: "on what the constraints allow it is singular there, too, where that was looked at (in float64)",
    None: "no state of the constraints was found there",
}


def _where(found: Singularities, file: str, positive: Sequence[bool | None] | None = None) -> Iterator[str]:
    """Where M is singular, which of the two fails there, and whether that is all; with constraints, what they allow."""
    if not found.how:
        return
    for number, one in enumerate(found.sets):
        others = ", whatever else is" if one.proved else ""
        why = _why(one, file) if positive is None else _ALLOWED[positive[number]]
        yield f"The mass matrix is singular where {_set(one)}{others}: {why}."
    for factor in found.undecided:
        yield f"It is undecided whether the mass matrix is singular where {factor} vanishes, and whether that does."
    within = ", ".join(f"|{name}| <= {float(bound):.3g}" for name, bound in found.ranges.items())
    bounds = f" (for {within})" if within else ""
    if found.complete:
        where = "nowhere else" if found.sets else "nowhere"
        yield f"The mass matrix is {where} singular{bounds}: proved by {found.how}."
    elif not found.undecided:
        none = "No other" if found.sets else "No"
        yield f"{none} singular configuration was found, which is no proof; searched were {found.how}."


def _set(one: SingularSet) -> str:
    """``theta = pi/2 or -pi/2``, ``cos(a) + cos(b) = 0``, ``a = 1.57 and b = 3.14``."""
    if one.values:
        return f"{one.names[0]} = {' or '.join(value.label for value in one.values)}"
    points = [
        " and ".join(f"{name} = {float(x):.6g}" for name, x in sorted(place.items())) for place in one.places[:LISTED]
    ]
    if one.finite:
        return " or ".join(points) + (
            f" or at {len(one.places) - LISTED} more places" if len(one.places) > LISTED else ""
        )
    return f"{one.equation} = 0 (for instance {points[0]})"


_WHY = {
    CHART: "there the coordinates fail, not the model",
    MODEL: "there the model fails: it may move without moving any mass, in whatever coordinates",
    BOTH: "there the coordinates fail, and the model, too: it may move without moving any mass",
    OPEN: "ranks did not tell whether the coordinates or the model fail there",
}


def _why(one: SingularSet, file: str) -> str:
    text = _WHY[one.kind]
    if one.joint:
        text += f", because the first and the third turn of {one.joint} are about one axis"
        return f"{text}; other turns are regular there: mbsym extremes {file} --sequences"
    return text if one.proved else f"{text} (found with the other coordinates near the given ones, not proved for all)"


def _near(found: Extremes) -> Iterator[str]:
    """What is lost near singular configurations; ladders of which the same is to be said are named together."""
    said: dict[tuple[str, ...], list[str]] = {}
    for kind, subject in found.ladders:
        if kind == SINGULAR:
            said.setdefault(tuple(_lost(found, subject)), []).append(subject)
    for facts, subjects in said.items():
        for fact in facts:
            yield f"{', '.join(subjects)}: {fact}."


def _lost(found: Extremes, subject: str) -> Iterator[str]:
    parts = []
    for quantity in ("accelerations", "Jacobian"):
        rows = [r for r in found.of(SINGULAR, subject, quantity) if r.found.bits]
        for scalar in FULL:
            lost = [r.size for r in rows if r.found.digits[scalar] < FEW]
            if lost:
                where = _onward((r.size for r in rows), lost)
                parts.append(f"{scalar} keeps fewer than {FEW:.0f} digits of the {quantity} {where}")
    known = [r for r in found.of(SINGULAR, subject, "accelerations") if r.found.bits]
    avoidable = [r for r in known if r.found.verdict == "formula"]
    if parts and not avoidable:
        parts.append("the question makes that unavoidable in these coordinates, whatever the formula")
    if not parts and known:
        least = min(r.found.digits[FLOAT64] for r in known)
        nearest = min(r.size for r in known)
        parts = [f"float64 keeps at least {least:.0f} digits of the accelerations down to {nearest:.0e}"]
    if parts:
        yield "; ".join(parts)
    if avoidable:
        r = max(avoidable, key=lambda row: row.size)
        where = _onward((row.size for row in known), (row.size for row in avoidable))
        yield (
            f"{where} more digits of the accelerations are lost than the question makes unavoidable (condition "
            f"{r.found.condition:.0e}, but {r.found.formula:.1f} digits at the state as rounded, at {r.size:.0e})"
        )


def _range(found: Extremes, kind: str, title: str) -> Iterator[str]:
    rows = [r for r in found.rows if r.kind == kind and r.found.bits]
    if not rows:
        return
    least = min(rows, key=lambda r: r.found.digits[FLOAT64])
    single = min(rows, key=lambda r: r.found.digits[FLOAT32])
    sizes = [r.size for r in rows]
    worst = f"{least.found.digits[FLOAT64]:.1f} digits (worst: {least.quantity} at {least.size:.0e})"
    coarse = f"{single.found.digits[FLOAT32]:.1f} ({single.quantity} at {single.size:.0e})"
    places = f"{title} from {_short(min(sizes))} to {_short(max(sizes))}"
    yield f"{places}: float64 keeps at least {worst}, float32 {coarse}."


def _ratios(found: Extremes, file: str) -> Iterator[str]:
    rows = [r for r in found.rows if r.kind == RATIO and r.found.bits]
    poor: dict[str, list[Row]] = {}
    fine: dict[tuple[float, ...], dict[str, float]] = {}
    for row in rows:
        if row.found.digits[FLOAT64] < GOOD:
            poor.setdefault(row.subject, []).append(row)
    for subject in dict.fromkeys(row.subject for row in rows):
        own = [row for row in rows if row.subject == subject]
        if subject not in poor:
            factors = tuple(sorted({row.size for row in own}))
            fine.setdefault(factors, {})[subject] = min(row.found.digits[FLOAT64] for row in own)
    for factors, subjects in fine.items():
        listed = ", ".join(f"{factor:.0e}" for factor in factors)
        yield (
            f"{', '.join(subjects)} times {listed}: float64 keeps at least {min(subjects.values()):.1f} digits of "
            "everything that was measured."
        )
    for subject, lost in poor.items():
        worst = min(lost, key=lambda r: r.found.digits[FLOAT64])
        names = ", ".join(dict.fromkeys(r.quantity for r in lost))
        yield (
            f"{subject} times {worst.size:.0e}: {worst.found.digits[FLOAT64]:.1f} digits of the {_called(worst)} are "
            f"left in float64 (below {GOOD:.0f} digits: {names}), {_blame(found, worst, file)}."
        )


def _called(row: Row) -> str:
    """``accelerations``, ``matrix M``."""
    return f"matrix {row.quantity}" if row.quantity in ("M", "D", "G", "K", "N") else row.quantity


def _blame(found: Extremes, row: Row, file: str) -> str:
    """What loses the digits, and what to do about it."""
    if row.found.verdict != "formula":
        return f"the question itself loses them (condition {row.found.condition:.0e}), so that no formula keeps them"
    text = f"lost by the formula (condition {row.found.condition:.0e})"
    value = found.values.get(row.subject)
    if value is None:
        return text
    changed = f"--set {row.subject}={value * Fraction(f'{row.size:e}')}"
    if row.quantity == "eigenvalues":
        return f"{text}; exact enclosures: mbsym extremes {file} {changed}"
    if row.quantity == "accelerations":
        return f"{text}; three more: mbsym simulate {file} {changed} --time 1 --arithmetic extended"
    return text


def _roots(found: Extremes) -> str:
    """``[-0.25 +/- 3e-13] + [3.13 +/- 2e-13]*i``; of a conjugate pair the upper one, with +-."""
    shown = []
    for root in found.eigenvalues:
        if bool(root.imag < 0):
            continue
        real = "" if root.real.is_zero() else root.real.str(13)
        sign = "+-" if bool(root.imag > 0) else "+"
        imaginary = "" if root.imag.is_zero() else f"{sign}{root.imag.str(13)}*i"
        shown.append(f"{real} {imaginary}".strip() or "0")
    counts = Counter(shown)
    listed = [text if count == 1 else f"{text} ({count} times)" for text, count in counts.items()]
    return "; ".join(listed[:LISTED]) + (f"; and {len(listed) - LISTED} more" if len(listed) > LISTED else "")


def _verdicts(found: Extremes) -> Iterator[str]:
    borders = [row for row in found.verdicts if row.kind == BORDER]
    subjects = dict.fromkeys(row.subject.rsplit(" from ", 1)[0] for row in borders)
    for subject in subjects:
        own = [row for row in borders if row.subject.startswith(subject + " from ")]
        sides = [[row for row in own if row.subject.endswith(f" from {side}")] for side in ("below", "above")]
        below, above = (_side(rows) for rows in sides)
        text = f"{subject}: a border of the first approximation, {below} below and {above} above"
        if all(len({row.judged.exact.word for row in rows}) == 1 for rows in sides):
            text += (
                f", decided exactly down to a distance of {max(min(row.size for row in rows) for rows in sides):.0e}"
            )
        for scalar in FULL:
            wrong = [row.size for row in own if row.judged.wrong(scalar)]
            if wrong:
                text += f"; {scalar} eigenvalues say otherwise {_onward((row.size for row in own), wrong)}"
        yield text + "."
    others = [row for row in found.verdicts if row.kind == RATIO]
    misjudged = [row for row in others if row.judged.wrong(FLOAT64)]
    if misjudged:
        listed = ", ".join(f"{row.subject} times {row.size:.0e}" for row in misjudged[:LISTED])
        more = f" and {len(misjudged) - LISTED} more" if len(misjudged) > LISTED else ""
        yield f"float64 eigenvalues contradict the exact verdict for {listed}{more}."


def _side(rows: Sequence[VerdictRow]) -> str:
    """The verdict on one side of a border; where it varies, all of it."""
    if not rows:
        return "not looked at"
    words = dict.fromkeys(row.judged.exact.word for row in rows)
    if len(words) == 1:
        return str(rows[0].judged.exact.word)
    parts = []
    for word in words:
        places = [row.size for row in rows if row.judged.exact.word == word]
        parts.append(f"{word} {_onward((row.size for row in rows), places)}")
    return " and ".join(parts)


def _formulas(found: Extremes) -> Iterator[str]:
    rows = [
        r for r in found.rows if r.found.verdict == "formula" and r.kind != SINGULAR and isfinite(r.found.condition)
    ]
    if rows:
        listed = dict.fromkeys(f"{r.quantity} ({r.subject})" for r in rows)
        yield f"More is lost than the condition explains, so another formula could keep it: {', '.join(listed)}."
    open_ = dict.fromkeys(f"{r.quantity} ({r.subject} {r.size:.0e})" for r in found.rows if not r.found.bits)
    if open_:
        undecided = f"Undecided, no tight enclosure within 2048 bits: {', '.join(list(open_)[:LISTED])}"
        yield undecided + (f" and {len(open_) - LISTED} more." if len(open_) > LISTED else ".")
