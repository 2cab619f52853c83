"""A map in the terminal: its verdicts with their theorems, and what part of the plane each has."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from flint import fmpq
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from mbsym.expressions.counting import counted
from mbsym.maps.boundaries import Origin
from mbsym.maps.result import LineMap, Of, PlaneMap, Standing, Stratum
from mbsym.maps.soft_borders import Onset
from mbsym.model.system import System
from mbsym.report.maps.words import STANDINGS, condition_words, row_words, signature_words, telling
from mbsym_cli.console import console, printable


def show_map(
    file: Path, system: System, found: PlaneMap | LineMap, folder: Path, names: Sequence[str], seconds: float
) -> None:
    """Prints a row for each verdict, then what there is to know besides."""
    out = console()
    out.print(Text.assemble((system.name, "bold"), (f"  {printable(file)}, {seconds:.2f} s", "dim")))
    out.print(_table(found))
    for line in remarks(found):
        out.print(Text(f"  {line}"))
    out.print(Text.assemble("  files in ", (printable(folder), "bold"), ": ", ", ".join(names)))


def _table(found: PlaneMap | LineMap) -> Table:
    rows: dict[tuple[str, str], tuple[set[int], float]] = {}
    for stratum, place, (area, _) in zip(found.regions, found.together, found.areas, strict=True):
        parts, total = rows.setdefault(_row(found, stratum), (set(), 0.0))
        rows[_row(found, stratum)] = parts | {place}, total + area
    whole = found.whole
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="bold cyan")
    table.add_column("verdict" if found.of is Of.STABILITY else "signature of K", overflow="fold")
    table.add_column("theorem", style="dim", overflow="fold")
    line = isinstance(found, LineMap)
    table.add_column("intervals" if line else "regions", justify="right")
    table.add_column("length" if line else "area", justify="right")
    table.add_column("of the whole", justify="right")
    for (verdict, theorem), (parts, area) in sorted(rows.items(), key=lambda item: -item[1][1]):
        share = 100 * area / whole
        table.add_row(escape(verdict), escape(theorem), str(len(parts)), f"{area:.4g}", f"{share:.2f} %")
    return table


def _row(found: PlaneMap | LineMap, stratum: Stratum) -> tuple[str, str]:
    judged = stratum.judged
    if judged is None:
        return STANDINGS[stratum.standing], ""
    if found.of is Of.SIGNATURE:
        return signature_words(judged), ""
    return row_words(judged), judged.verdict.theorem


def remarks(found: PlaneMap | LineMap) -> list[str]:
    """Sentences on what the table does not show."""
    if isinstance(found, LineMap):
        told = [
            f"at {_exactly(there.number)}: {_why(found, one)}"
            for one, there in zip(found.corners, found.line.zeros, strict=True)
            if found.changes(one)
        ]
    else:
        told = [
            f"{counted(len(found.regions), 'region')}, {counted(len(found.arcs), 'arc')} and "
            f"{counted(len(found.corners), 'corner')} in map.json, each with an exact point"
            + (", also of curves at which no verdict changes" if len({*found.together}) < len(found.regions) else "")
        ]
    kept = (Origin.SIGN, Origin.ASSUMPTION, Origin.INERTIA)
    if all(one.origin in kept for conditions in found.boundaries.conditions for one in conditions):
        told.append("no condition of stability depends on the axes")
    if not any(one.judged is not None for one in found.regions):
        told.append("no verdict anywhere: map.json says at every point what is not kept there")
    vanishing = dict.fromkeys(condition_words(one, found.section) for one in found.boundaries.vanishing)
    told += [f"an equality everywhere: {words}" for words in vanishing]
    if found.admissibility.left_out:
        listed = ", ".join(found.admissibility.left_out)
        told.append(f"not expressible in the axes, so not looked at: {listed}")
    large = sum(one.standing is Standing.TOO_LARGE for one in found.strata)
    if large:
        told.append(f"no verdict at {counted(large, 'exact point')} between regions: too large to be decided")
    told += borders(found)
    if found.check is not None and found.check.holds:
        arcs = f" and {counted(found.check.arcs, 'arc')}" if found.check.arcs else ""
        by_balls = f"at {found.check.enclosed} of them eigenvalues in balls confirm the counts"
        if not found.check.enclosed:
            by_balls = "eigenvalues in balls exclude none of the counts, and decide none"
        told.append(f"check: {counted(found.check.points, 'more point')} in regions{arcs} agree; {by_balls}")
    return told


#: What a border is called; the reason behind the last one is in map.json.
ONSETS = {
    Onset.SOFT: "soft: asymptotically stable at the border, small oscillations arise beyond",
    Onset.HARD: "hard: unstable at the border already",
    Onset.OPEN: "open: terms of third order do not decide, or are not at hand",
    Onset.NEITHER: (
        "neither soft nor hard: roots are to the right on both sides or on none, one side is not judged, or the "
        "equations are exactly linear"
    ),
}


def borders_of_slices(planes: Iterable[PlaneMap]) -> Iterator[str]:
    """The same of all slices, counted; map.json has each arc."""
    arcs = [one for plane in planes for one in plane.arcs if one.soft is not None]
    for onset, words in ONSETS.items():
        alike = sum(_onset(one) is onset for one in arcs)
        if alike:
            yield f"imaginary pair, {counted(alike, 'arc')} of slices: {words}"
    changing = sum(_onset(one) is None for one in arcs)
    if changing:
        yield f"imaginary pair, {counted(changing, 'arc')} of slices: soft in parts, hard in others"


def borders(found: PlaneMap | LineMap) -> Iterator[str]:
    """Where a pair of roots is imaginary and the others are to the left: how stability is lost."""
    line = isinstance(found, LineMap)
    strata = [one for one in (found.corners if line else found.arcs) if one.soft is not None]
    for onset, words in ONSETS.items():
        alike = [one for one in strata if _onset(one) is onset]
        if alike:
            places = [_place(found, one) for one in alike]
            yield f"imaginary pair, {', '.join(places)}: {words}"
    for one in strata:
        stretches = one.soft.stretches or () if one.soft is not None else ()
        if len(stretches) > 1:
            name = found.section.axes[stretches[0].axis].name
            parts = [f"{x.onset} for {name} from {float_of(x.start):.6g} to {float_of(x.end):.6g}" for x in stretches]
            yield f"imaginary pair, {_place(found, one)}: {'; '.join(parts)}"


def _onset(one: Stratum) -> Onset | None:
    """That of the whole place; None where it is different along an arc."""
    if one.soft is None or len(one.soft.stretches or ()) > 1:
        return None
    return one.soft.onset


def _place(found: PlaneMap | LineMap, one: Stratum) -> str:
    if isinstance(found, LineMap):
        return f"at {float_of(found.line.zeros[one.number].number):.10g}"
    partial = one.soft is not None and one.soft.stretches is None
    return f"arc {one.number}" + (" (at its point in map.json)" if partial else "")


def float_of(x: Any) -> float:
    """A rational or algebraic number in floats."""
    return float(x.p) / float(x.q) if isinstance(x, fmpq) else float(x)


def _exactly(x: Any) -> str:
    """A rational number, or the first digits of an algebraic one."""
    return str(x) if isinstance(x, fmpq) else f"{float(x):.10g} ({_degree(x)})"


def _degree(x: Any) -> str:
    return f"exactly: a root of a polynomial of degree {int(x.polynomial.degree())}, in map.json"


def _why(found: LineMap, one: Stratum) -> str:
    """The condition that is an equality there, and what is said of the point."""
    of = [found.boundaries.conditions[k] for k in found.line.zeros[one.number].factors]
    words = "; ".join(dict.fromkeys(condition_words(telling(x), found.section) for x in of))
    border = one.judged.border if one.judged is not None else None
    return words + (f": {border}" if border is not None else "")
