"""What follows from measurements at the extremes, in sentences: each from the rows, and from nothing else."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from math import isfinite

from mbsym.expressions.message import Message, enumerated, joined, worded
from mbsym.numerics.borders import BORDER
from mbsym.numerics.extremes.extremes import LISTED, Compensated, Extremes, Row, VerdictRow
from mbsym.numerics.extremes.singular import BOTH, CHART, MODEL, OPEN, Singularities, SingularSet
from mbsym.numerics.extremes.singular_positions import SingularPositions
from mbsym.numerics.kernels.interface import FLOAT32, FLOAT64
from mbsym.numerics.probes import EQUILIBRIUM, RATES, RATIO, SINGULAR
from mbsym.numerics.trade.digits import FEW, FULL

#: Sums are called good where float64 keeps at least so many digits.
GOOD = 10.0

#: A gain of fewer digits is not told.
TOLD = 0.5


def sentences(extremes: Extremes, file: str = "FILE") -> Iterator[str]:
    """Where the model breaks down, in plain words; each follows from the rows.

    ``file`` stands in the commands that are advised.
    """
    if extremes.falling is not None and extremes.falling.joined - extremes.falling.apart >= TOLD:
        yield Message(
            "Gravity and the acceleration of [[frames]] are joined before numbers are put in: with the bodies at rest "
            "float64 keeps [[joined]] digits of the forcing, where term by term it would keep [[apart]].",
            frames=", ".join(extremes.falling.frames),
            joined=f"{extremes.falling.joined:.1f}",
            apart=f"{extremes.falling.apart:.1f}",
        )
    if extremes.positions is not None:
        yield from lost_rank(extremes.positions)
    if extremes.singularities is not None:
        yield from _where(extremes.singularities, file, None if extremes.positions is None else extremes.positive)
    yield from _near(extremes)
    yield from _pairs(extremes)
    yield from _range(extremes, RATES, Message("Rates"))
    yield from _range(extremes, EQUILIBRIUM, Message("States at distances from the unperturbed motion"))
    yield from _ratios(extremes, file)
    if extremes.eigenvalues:
        text = "Eigenvalues of the first approximation at the given values, in proved enclosures: [[roots]]."
        yield Message(text, roots=_roots(extremes))
    yield from _verdicts(extremes)
    yield from _formulas(extremes)


def _onward(sizes: Iterable[float], bad: Iterable[float]) -> Message:
    """``from 1e-05 on`` where everything nearer is bad as well, else the places one by one."""
    places = sorted(set(bad), reverse=True)
    if {size for size in sizes if size <= places[0]} == set(places):
        return Message("from [[size]] on", size=f"{places[0]:.0e}")
    return Message("at [[sizes]]", sizes=", ".join(f"{place:.0e}" for place in places))


def _short(size: float) -> str:
    """``1e-8``, ``1e8``."""
    return f"{size:.0e}".replace("e-0", "e-").replace("e+0", "e").replace("e+", "e")


def _pairs(extremes: Extremes) -> Iterator[str]:
    """Where kernels carry operations in pairs: what that keeps, and what it costs."""
    said: dict[str, list[Compensated]] = {}
    for compensated in extremes.compensated:
        said.setdefault(compensated.subject, []).append(compensated)
    for subject, places in said.items():
        where = Message("At the given values")
        if subject:
            sizes = ", ".join(f"{place.size:.0e}" for place in places)
            where = Message("[[name]] times [[sizes]]", name=subject, sizes=sizes)
        worst = min(places, key=lambda entry: entry.compensation.after)
        yield Message(
            "[[where]]: float64 kernels carry [[operations]] operations of the accelerations in pairs of "
            "numbers and keep "
            "[[after]] digits there, where plain ones keep [[before]]; they take up to [[cost]] times as "
            "many operations.",
            where=where,
            operations=worst.compensation.sensitive,
            after=f"{worst.compensation.after:.1f}",
            before=f"{worst.compensation.before:.1f}",
            cost=f"{max(place.compensation.cost for place in places):.1f}",
        )
    if said:
        least = min(entry.compensation.before for entry in extremes.compensated)
        yield Message(
            "Ensembles (mbsym simulate --vary) are computed with plain kernels: of the accelerations "
            "they keep [[digits]] "
            "digits where these are fewest.",
            digits=f"{least:.1f}",
        )


def lost_rank(positions: SingularPositions) -> Iterator[str]:
    """Where constraints lose their rank, how that is known, and that a search is no proof."""
    yield Message(
        "States are moved onto the constraints; mass matrix and forcing, and where that matrix is singular, "
        "are those of the "
        "tree without them."
    )
    for position in positions.found:
        how = Message("proved by rational arithmetic") if position.proved else Message("to the roundings of float64")
        text = (
            "The constraints lose their rank where [[where]]: [[rank]] of [[usual]] rows are independent "
            "there ([[how]])"
        )
        if positions.moving:
            text = (
                "The constraints lose their rank at t = 0 where [[where]]: [[rank]] of [[usual]] rows "
                "are independent there "
                "([[how]])"
            )
        message = Message(text, where=position.text, rank=position.rank, usual=position.usual, how=how)
        yield (
            Message("[[told]]; others are next to it.", told=message)
            if position.family
            else Message("[[told]].", told=message)
        )
    if positions.found:
        text = "These were found from [[starts]] starts, which is no proof that there are no others."
        if positions.more:
            text = (
                "These were found from [[starts]] starts, more than are listed, which is no proof that "
                "there are no others."
            )
    else:
        text = (
            "No position in which constraints lose their rank was found from [[starts]] starts, which is no proof that "
            "there are none."
        )
        if positions.moving:
            text = (
                "No position in which constraints lose their rank at t = 0 was found from [[starts]] "
                "starts, which is no "
                "proof that there are none."
            )
    yield Message(text, starts=positions.starts)


#: With constraints, what their directions make of a singular matrix of the tree.
_ALLOWED = {
    True: Message("on what the constraints allow it is positive there, where that was looked at (in float64)"),
    False: Message("on what the constraints allow it is singular there, too, where that was looked at (in float64)"),
    None: Message("no state of the constraints was found there"),
}


def _where(singularities: Singularities, file: str, positive: Sequence[bool | None] | None = None) -> Iterator[str]:
    """Where M is singular, which of the two fails there, and whether that is all; with constraints, what they allow."""
    if not singularities.how:
        return
    for number, singular_set in enumerate(singularities.sets):
        why = _why(singular_set, file) if positive is None else _ALLOWED[positive[number]]
        text = "The mass matrix is singular where [[where]]: [[why]]."
        if singular_set.proved:
            text = "The mass matrix is singular where [[where]], whatever else is: [[why]]."
        yield Message(text, where=_set(singular_set), why=why)
    for factor in singularities.undecided:
        yield Message(
            "It is undecided whether the mass matrix is singular where [[factor]] vanishes, and whether that does.",
            factor=factor,
        )
    within = ", ".join(f"|{name}| <= {float(bound):.3g}" for name, bound in singularities.ranges.items())
    if singularities.complete:
        text = "The mass matrix is nowhere singular[[within]]: proved by [[how]]."
        if singularities.sets:
            text = "The mass matrix is nowhere else singular[[within]]: proved by [[how]]."
        bounds = Message(" (for [[ranges]])", ranges=within) if within else ""
        yield Message(text, within=bounds, how=worded(singularities.how))
    elif not singularities.undecided:
        text = "No singular configuration was found, which is no proof; searched were [[how]]."
        if singularities.sets:
            text = "No other singular configuration was found, which is no proof; searched were [[how]]."
        yield Message(text, how=worded(singularities.how))


def _alternatives(parts: Sequence[str]) -> str:
    """``a``, ``a or b``, ``a or b or c``."""
    alternatives = parts[0]
    for part in parts[1:]:
        alternatives = Message("[[first]] or [[second]]", first=alternatives, second=part)
    return alternatives


def _set(singular_set: SingularSet) -> str:
    """``theta = pi/2 or -pi/2``, ``cos(a) + cos(b) = 0``, ``a = 1.57 and b = 3.14``."""
    if singular_set.values:
        values = [value.label for value in singular_set.values]
        return Message("[[name]] = [[values]]", name=singular_set.names[0], values=_alternatives(values))
    points: list[str] = []
    for place in singular_set.places[:LISTED]:
        values = [f"{name} = {float(x):.6g}" for name, x in sorted(place.items())]
        points.append(enumerated(values))
    if singular_set.finite:
        more = len(singular_set.places) - LISTED
        listed = _alternatives(points)
        return Message("[[places]] or at [[more]] more places", places=listed, more=more) if more > 0 else listed
    return Message("[[equation]] = 0 (for instance [[point]])", equation=singular_set.equation, point=points[0])


_WHY = {
    CHART: Message("there the coordinates fail, not the model"),
    MODEL: Message("there the model fails: it may move without moving any mass, in whatever coordinates"),
    BOTH: Message("there the coordinates fail, and the model, too: it may move without moving any mass"),
    OPEN: Message("ranks did not tell whether the coordinates or the model fail there"),
}


def _why(singular_set: SingularSet, file: str) -> Message:
    why = _WHY[singular_set.kind]
    if singular_set.joint:
        return Message(
            "[[why]], because the first and the third turn of [[joint]] are about one axis; other turns "
            "are regular there: "
            "mbsym extremes [[file]] --sequences",
            why=why,
            joint=singular_set.joint,
            file=file,
        )
    text = "[[why]] (found with the other coordinates near the given ones, not proved for all)"
    return why if singular_set.proved else Message(text, why=why)


def _near(extremes: Extremes) -> Iterator[str]:
    """What is lost near singular configurations; ladders of which the same is to be said are named together."""
    said: dict[tuple[Message, ...], list[str]] = {}
    for kind, subject in extremes.ladders:
        if kind == SINGULAR:
            said.setdefault(tuple(_lost(extremes, subject)), []).append(subject)
    for facts, subjects in said.items():
        for fact in facts:
            yield Message("[[subjects]]: [[fact]].", subjects=", ".join(subjects), fact=fact)


def _lost(extremes: Extremes, subject: str) -> Iterator[Message]:
    parts: list[Message] = []
    for quantity in ("accelerations", "Jacobian"):
        rows = [r for r in extremes.of(SINGULAR, subject, quantity) if r.digits.bits]
        for scalar in FULL:
            lost = [r.size for r in rows if r.digits.digits[scalar] < FEW]
            if lost:
                where = _onward((r.size for r in rows), lost)
                text = "[[scalar]] keeps fewer than [[few]] digits of the accelerations [[where]]"
                if quantity == "Jacobian":
                    text = "[[scalar]] keeps fewer than [[few]] digits of the Jacobian [[where]]"
                parts.append(Message(text, scalar=scalar, few=f"{FEW:.0f}", where=where))
    known = [r for r in extremes.of(SINGULAR, subject, "accelerations") if r.digits.bits]
    avoidable = [r for r in known if r.digits.verdict == "formula"]
    if parts and not avoidable:
        parts.append(Message("the question makes that unavoidable in these coordinates, whatever the formula"))
    if not parts and known:
        least = min(r.digits.digits[FLOAT64] for r in known)
        nearest = min(r.size for r in known)
        text = "float64 keeps at least [[least]] digits of the accelerations down to [[nearest]]"
        parts = [Message(text, least=f"{least:.0f}", nearest=f"{nearest:.0e}")]
    if parts:
        yield joined(parts, "; ")
    if avoidable:
        r = max(avoidable, key=lambda row: row.size)
        where = _onward((row.size for row in known), (row.size for row in avoidable))
        yield Message(
            "[[where]] more digits of the accelerations are lost than the question makes unavoidable (condition "
            "[[condition]], but [[digits]] digits at the state as rounded, at [[size]])",
            where=where,
            condition=f"{r.digits.condition:.0e}",
            digits=f"{r.digits.formula:.1f}",
            size=f"{r.size:.0e}",
        )


def _range(extremes: Extremes, kind: str, title: Message) -> Iterator[str]:
    rows = [r for r in extremes.rows if r.kind == kind and r.digits.bits]
    if not rows:
        return
    least = min(rows, key=lambda r: r.digits.digits[FLOAT64])
    single = min(rows, key=lambda r: r.digits.digits[FLOAT32])
    sizes = [r.size for r in rows]
    yield Message(
        "[[title]] from [[low]] to [[high]]: float64 keeps at least [[digits]] digits (worst: "
        "[[quantity]] at [[size]]), "
        "float32 [[single]] ([[quantity32]] at [[size32]]).",
        title=title,
        low=_short(min(sizes)),
        high=_short(max(sizes)),
        digits=f"{least.digits.digits[FLOAT64]:.1f}",
        quantity=Message(least.quantity),
        size=f"{least.size:.0e}",
        single=f"{single.digits.digits[FLOAT32]:.1f}",
        quantity32=Message(single.quantity),
        size32=f"{single.size:.0e}",
    )


def _ratios(extremes: Extremes, file: str) -> Iterator[str]:
    rows = [r for r in extremes.rows if r.kind == RATIO and r.digits.bits]
    poor: dict[str, list[Row]] = {}
    fine: dict[tuple[float, ...], dict[str, float]] = {}
    for row in rows:
        if row.digits.digits[FLOAT64] < GOOD:
            poor.setdefault(row.subject, []).append(row)
    for subject in dict.fromkeys(row.subject for row in rows):
        own = [row for row in rows if row.subject == subject]
        if subject not in poor:
            factors = tuple(sorted({row.size for row in own}))
            fine.setdefault(factors, {})[subject] = min(row.digits.digits[FLOAT64] for row in own)
    for factors, subjects in fine.items():
        listed = ", ".join(f"{factor:.0e}" for factor in factors)
        yield Message(
            "[[names]] times [[factors]]: float64 keeps at least [[digits]] digits of everything that was measured.",
            names=", ".join(subjects),
            factors=listed,
            digits=f"{min(subjects.values()):.1f}",
        )
    for subject, lost in poor.items():
        worst = min(lost, key=lambda r: r.digits.digits[FLOAT64])
        yield Message(
            "[[name]] times [[factor]]: [[digits]] digits of the [[quantity]] are left in float64 (below "
            "[[good]] digits: "
            "[[quantities]]), [[why]].",
            name=subject,
            factor=f"{worst.size:.0e}",
            digits=f"{worst.digits.digits[FLOAT64]:.1f}",
            quantity=_called(worst),
            good=f"{GOOD:.0f}",
            quantities=joined(map(Message, dict.fromkeys(r.quantity for r in lost)), ", "),
            why=_blame(extremes, worst, file),
        )


def _called(row: Row) -> Message:
    """``accelerations``, ``matrix M``."""
    matrix = row.quantity in ("M", "D", "G", "K", "N")
    return Message("matrix [[name]]", name=row.quantity) if matrix else Message(row.quantity)


def _blame(extremes: Extremes, row: Row, file: str) -> Message:
    """What loses the digits, and what to do about it."""
    condition = f"{row.digits.condition:.0e}"
    if row.digits.verdict != "formula":
        text = "the question itself loses them (condition [[condition]]), so that no formula keeps them"
        return Message(text, condition=condition)
    message = Message("lost by the formula (condition [[condition]])", condition=condition)
    value = extremes.values.get(row.subject)
    if value is None:
        return message
    changed = f"--set {row.subject}={value * Fraction(f'{row.size:e}')}"
    if row.quantity == "eigenvalues":
        command = f"mbsym extremes {file} {changed}"
        return Message("[[why]]; exact enclosures: [[command]]", why=message, command=command)
    if row.quantity == "accelerations":
        command = f"mbsym simulate {file} {changed} --time 1 --arithmetic extended"
        return Message("[[why]]; three more: [[command]]", why=message, command=command)
    return message


def _roots(extremes: Extremes) -> Message:
    """``[-0.25 +/- 3e-13] + [3.13 +/- 2e-13]*i``; of a conjugate pair the upper one, with +-."""
    shown = []
    for root in extremes.eigenvalues:
        if bool(root.imag < 0):
            continue
        real = "" if root.real.is_zero() else root.real.str(13)
        sign = "+-" if bool(root.imag > 0) else "+"
        imaginary = "" if root.imag.is_zero() else f"{sign}{root.imag.str(13)}*i"
        shown.append(f"{real} {imaginary}".strip() or "0")
    counts = Counter(shown)
    times = "[[root]] ([[count]] times)"
    listed = [text if count == 1 else Message(times, root=text, count=count) for text, count in counts.items()]
    return _cut(joined(listed[:LISTED], "; "), len(listed) - LISTED)


def _cut(listed: Message, more: int) -> Message:
    """With the number of those that are not listed."""
    return Message("[[listed]]; and [[more]] more", listed=listed, more=more) if more > 0 else listed


def _verdicts(extremes: Extremes) -> Iterator[str]:
    borders = [row for row in extremes.verdicts if row.kind == BORDER]
    subjects = dict.fromkeys(row.subject.rsplit(" from ", 1)[0] for row in borders)
    for subject in subjects:
        own = [row for row in borders if row.subject.startswith(subject + " from ")]
        sides = [[row for row in own if row.subject.endswith(f" from {side}")] for side in ("below", "above")]
        below, above = (_side(rows) for rows in sides)
        text = "[[where]]: a border of the first approximation, [[below]] below and [[above]] above"
        messages = [Message(text, where=subject, below=below, above=above)]
        if all(len({row.judged.exact.word for row in rows}) == 1 for rows in sides):
            least = max(min(row.size for row in rows) for rows in sides)
            text = "[[told]], decided exactly down to a distance of [[least]]"
            messages = [Message(text, told=messages[0], least=f"{least:.0e}")]
        for scalar in FULL:
            wrong = [row.size for row in own if row.judged.wrong(scalar)]
            if wrong:
                text = "[[scalar]] eigenvalues say otherwise [[where]]"
                messages.append(Message(text, scalar=scalar, where=_onward((row.size for row in own), wrong)))
        yield Message("[[told]].", told=joined(messages, "; "))
    others = [row for row in extremes.verdicts if row.kind == RATIO]
    misjudged = [row for row in others if row.judged.wrong(FLOAT64)]
    if misjudged:
        cases = (Message("[[name]] times [[sizes]]", name=r.subject, sizes=f"{r.size:.0e}") for r in misjudged[:LISTED])
        told_cases = _cut(joined(cases, ", "), len(misjudged) - LISTED)
        yield Message("float64 eigenvalues contradict the exact verdict for [[cases]].", cases=told_cases)


def _side(rows: Sequence[VerdictRow]) -> str:
    """The verdict on one side of a border; where it varies, all of it."""
    if not rows:
        return Message("not looked at")
    words = dict.fromkeys(row.judged.exact.word for row in rows)
    if len(words) == 1:
        return Message(rows[0].judged.exact.word)
    parts = []
    for word in words:
        places = [row.size for row in rows if row.judged.exact.word == word]
        parts.append(joined((Message(word), _onward((row.size for row in rows), places))))
    return enumerated(parts)


def _formulas(extremes: Extremes) -> Iterator[str]:
    rows = [
        r
        for r in extremes.rows
        if r.digits.verdict == "formula" and r.kind != SINGULAR and isfinite(r.digits.condition)
    ]
    if rows:
        listed = dict.fromkeys(joined((Message(r.quantity), f"({r.subject})")) for r in rows)
        text = "More is lost than the condition explains, so another formula could keep it: [[quantities]]."
        yield Message(text, quantities=joined(listed, ", "))
    unbounded = (r for r in extremes.rows if not r.digits.bits)
    open_ = dict.fromkeys(joined((Message(r.quantity), f"({r.subject} {r.size:.0e})")) for r in unbounded)
    if open_:
        quantities = _cut(joined(list(open_)[:LISTED], ", "), len(open_) - LISTED)
        text = "Undecided, no tight enclosure within 2048 bits: [[quantities]]."
        yield Message(text, quantities=quantities)
