"""What is said of a run: conservation and error as words, for the terminal, for ``simulation.json`` and for figures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isfinite
from typing import TYPE_CHECKING, Any

from mbsym.expressions.tree import text
from mbsym.model.quantities import with_unit
from mbsym.numerics.accuracy import Against, ErrorEstimate, Lacking, NoEstimate
from mbsym.numerics.conservation import Conservation, Standing
from mbsym.numerics.methods.interface import Change
from mbsym.report.documents import simulation as doc

if TYPE_CHECKING:
    from mbsym.numerics.scenario import Scenario
    from mbsym.simulation.result import Simulation


def standing_words(found: Conservation) -> str:
    """``conserved (proved)``, ``not conserved``, ``undecided (why)``."""
    if found.standing in (Standing.PROVED, Standing.VERIFIED):
        return f"conserved ({found.standing.value})"
    reason = f" ({found.doubt.value})" if found.doubt is not None else ""
    return found.standing.value + reason


def conservation_line(found: Conservation) -> str:
    """With how far the run keeps it, and what that is a part of: a drift is an error, a change is none.

    What other motions change may rest along this one, as T - U does at the bottom of a hoop that turns.
    """
    if found.standing is Standing.CHANGING and found.change == 0:
        return f"{standing_words(found)} in general; constant along this run"
    what = "drift" if found.standing in (Standing.PROVED, Standing.VERIFIED) else "change"
    far = f"; largest {what} {_measured(found)}" if isfinite(found.change) else ""
    return standing_words(found) + far


def _measured(found: Conservation) -> str:
    """``1e-12 times the largest kinetic energy``."""
    return f"{found.change:.1e} times {found.measure.value}"


def energy_lines(run: Simulation) -> Iterator[tuple[str, str]]:
    """(which, what is said of it): T2 - T0 - U and T - U, which are the same where nothing moves as prescribed."""
    if not run.dynamics.natural:
        yield "generalised, T2 - T0 - U", conservation_line(run.conservation)
    yield "T - U", conservation_line(run.energy_conservation)


def invariant_line(found: Conservation) -> str:
    """``momentum of psi (proved): largest drift 1e-12 times the size of its terms``."""
    if found.standing in (Standing.PROVED, Standing.VERIFIED):
        return f"{found.quantity} ({found.standing.value}): largest drift {_measured(found)}"
    return f"{found.quantity}: {conservation_line(found)}"


def against_words(found: Against) -> str:
    """``dop853, tolerance 1e-12, extended, steps up to 0.005``."""
    setting = found.setting
    how = f"step {setting.step:.3g}" if setting.tolerance is None else f"tolerance {setting.tolerance:.0e}"
    longest = f", steps up to {setting.longest:.3g}" if setting.longest is not None else ""
    return f"{found.method}, {how}, {found.scalar}{longest}"


def error_lines(found: ErrorEstimate | NoEstimate) -> Iterator[str]:
    """The error in words; nothing where none was asked for or the run says itself why it ended."""
    if isinstance(found, NoEstimate):
        if found.why not in (Lacking.NOT_ASKED, Lacking.NOT_WHOLE, Lacking.INTERRUPTED):
            yield f"not estimated: {found.why.value}"
        return
    against = f"of each quantity's size in the whole motion; against {against_words(found.against)}"
    if found.parted is not None:
        yield (
            f"at least {found.largest:.1e}: this run and a better one have parted by t = {found.parted:.4g}, and from "
            f"there on nothing is known of either ({against})"
        )
    elif found.largest <= found.rounding:
        yield f"no more than the rounding of one number, {found.rounding:.1e} ({against})"
    else:
        worst = f", {found.largest:.1e} at worst" if found.largest > 2 * found.final else ""
        yield f"about {found.final:.1e} at the end{worst} ({against})"
    resting = [q for q in found.quantities if q.rests]
    if resting:
        names = ", ".join(q.name for q in resting)
        error = max(q.largest for q in resting)
        floor = min(q.floor for q in resting)
        rest = "rests" if len(resting) == 1 else "rest"
        if error == 0 and floor == 0:
            yield f"{names} {rest}, in this run and in the better one"
        else:
            yield (
                f"{names} {rest} but for rounding, as far as can be told: the {error:.1e} that the run makes of it is "
                f"measured by what the motion could do (sizes below {floor:.1e} on which two runs do not agree)"
            )


#: So many changes of the method are told one by one.
MOST_CHANGES = 6


def change_lines(changes: Sequence[Change], unit: str | None) -> Iterator[str]:
    """Where the run changed its method on the way, and why."""
    for one in changes[:MOST_CHANGES]:
        yield f"from t = {with_unit(f'{one.time:.9g}', unit)} on {one.method} ({one.why})"
    if len(changes) > MOST_CHANGES:
        last = changes[-1]
        yield (
            f"... and {len(changes) - MOST_CHANGES} changes more, the last at t = "
            f"{with_unit(f'{last.time:.9g}', unit)} to {last.method}; all are in simulation.json"
        )


def warnings(conservation: Conservation, error: ErrorEstimate | NoEstimate) -> Iterator[str]:
    """What makes a run doubtful."""
    if conservation.broken:
        yield (
            f"the {conservation.quantity} is conserved, and this run does not keep it: it is too coarse; choose a "
            "smaller --tolerance, or, of a method with steps of one length, a smaller --step"
        )
    if isinstance(error, ErrorEstimate) and error.parted is not None:
        yield (
            f"from t = {error.parted:.4g} on this run and a better one have little in common: the motion is chaotic or "
            "starts at an unstable rest, the run has stepped over something short, or it is too coarse"
        )


def quality(run: Simulation) -> tuple[list[str], list[str], bool]:
    """(warnings, what is said of the error, whether that is to be read first, as warnings are).

    Whoever reads one line of a run that is wrong, or that nobody could judge, shall read that: it stands before what is
    proved of the equations.
    """
    told = list(error_lines(run.error))
    return list(warnings(run.conservation, run.error)), told, isinstance(run.error, NoEstimate)


def conservation_json(found: Conservation) -> dict[str, Any]:
    """``conserved`` is true, false or null; ``how`` says how that is known."""
    return {
        "conserved": found.standing.conserved,
        "how": found.standing,
        "doubt": found.doubt.name.lower() if found.doubt is not None else None,
        "largest_relative_drift": found.change,
        "relative_to": found.scale,
    }


def error_json(found: ErrorEstimate | NoEstimate) -> doc.Estimate | doc.NoEstimate:
    """The estimate with what it was made of, or why there is none."""
    if isinstance(found, NoEstimate):
        return doc.NoEstimate(available=False, why=found.why.name.lower())
    against = found.against
    return doc.Estimate(
        available=True,
        final=found.final,
        largest=found.largest,
        how="better run",
        against=doc.Against(
            method=against.method,
            arithmetic=against.scalar,
            tolerance=against.setting.tolerance,
            step=against.setting.step,
            longest_step=against.setting.longest,
        ),
        lower_bound=found.parted is not None,
        parted=found.parted,
        over=doc.Over(
            from_=0.0,
            to=found.compared.end,
            samples=found.compared.points,
            every_step=found.compared.followed,
        ),
        quantities={
            q.name: doc.QuantityError(
                final=q.final,
                largest=q.largest,
                when=q.when,
                size=q.size,
                scale=q.scale,
                floor=q.floor,
                rests=q.rests,
            )
            for q in found.quantities
        },
    )


def inputs_line(given: Scenario) -> str:
    """``F = sin(3*t); w = 0 (held, as on the unperturbed motion)``: what every input is in a run."""
    left = "" if all(one.asked for one in given.inputs) else " (held, as on the unperturbed motion)"
    return "; ".join(f"{one.name} = {text(one.law)}{'' if one.asked else left}" for one in given.inputs)


def laws_json(given: Scenario) -> dict[str, str]:
    """What every input is in a run, as formulas."""
    return {one.name: text(one.law) for one in given.inputs}
