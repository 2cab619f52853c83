"""One simulation for ``mbsym simulate``: run, written, summed up; what goes wrong becomes a line and an exit code."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import click

from mbsym.expressions.message import Message
from mbsym.expressions.safe import quoted as ascii_safe
from mbsym.report.language import Language
from mbsym.studies.study import Exit, Refusal
from mbsym_cli.assignments import given_numbers
from mbsym_cli.console import (
    BAD_INPUT,
    BROKEN_DOWN,
    FAILED,
    INTERRUPTED,
    OK,
    complain,
    printable,
    progress,
    read_description,
    reason_of,
    status,
)
from mbsym_cli.files import folder_for, prevented, room_beside
from mbsym_cli.formulas import LAWS, read_formula
from mbsym_cli.options import Options
from mbsym_cli.simulate.files import write_files
from mbsym_cli.simulate.further import begun_at, declared, going_on, integrated, with_further
from mbsym_cli.simulate.many import read_many
from mbsym_cli.simulate.options import carried, complain_of_names, complain_of_pairs, typed_options
from mbsym_cli.simulate.request import Asked, check_constrained, check_held, check_states, read_request, with_goal
from mbsym_cli.simulate.summary import (
    InterruptedPlanning,
    broken,
    only_planned,
    planning,
    print_repeat,
    print_summary,
    simulated_to,
)

if TYPE_CHECKING:
    from mbsym.algebra.failures import Failure
    from mbsym.expressions.tree import Expression
    from mbsym.numerics.methods.interface import Breakdown
    from mbsym.numerics.scenario import Scenario
    from mbsym.simulation import Simulation


def run(file: Path, folder: Path, given: Scenario, wanted: Asked, options: Options) -> int:
    """The exit code; ``options`` takes the complaint of a method that does not apply here."""
    from mbsym.algebra.failures import Failure, message_of
    from mbsym.numerics.enclosure.field import NotAnalytic
    from mbsym.numerics.methods.interface import Breakdown, Unusable
    from mbsym.simulation import NoEvent, simulate
    from mbsym.studies.closing import not_closed

    say = Language(given.system.language).say
    try:
        if wanted.goal is not None and wanted.goal.only_plan:
            return only_planned(file, given, wanted)
        with room_beside(folder) as store:
            request = replace(wanted.request, store=store)
            with _watching(file, wanted) as (watch, stage):
                if wanted.goal is not None:
                    found = simulated_to(wanted.goal, given, request, watch, stage)
                else:
                    found = simulate(given, request, watch, stage)
            return _delivered(file, folder, found, wanted)
    except InterruptedPlanning:
        complain(file, say(Message("interrupted while the run was being planned; nothing was run or written")))
        return INTERRUPTED
    except NoEvent as error:
        told = Message("[[name]] has no value: [[why]]", name=ascii_safe(error.text), why=error.reason)
        options.complain(f"--{error.option}", "no-value", told)
        options.refused(file)
        return BAD_INPUT
    except Unusable as error:
        options.complain("--method", "unsuitable-method", message_of(error), "--method auto chooses one that can")
        options.refused(file)
        return BAD_INPUT
    except NotAnalytic as error:
        hint = "leave --certify out: enclosures go through power series"
        options.complain(
            "--certify", "not-analytic", Message("[[what]] in the equations has no power series", what=str(error)), hint
        )
        options.refused(file)
        return BAD_INPUT
    except (Breakdown, Failure) as error:
        refusal = not_closed(error, given.system) or _refusal(error, say)
        for text in (refusal.text, *refusal.more):
            complain(file, text)
        return refusal.code
    except OSError as error:
        complain(file, Message("the results cannot be written: [[why]]", why=reason_of(error)))
    except MemoryError:
        complain(file, "out of memory; ask for fewer --samples")
    return FAILED


def _refusal(error: Breakdown | Failure, say: Callable[[str], str]) -> Refusal:
    """Of a run that cannot be begun."""
    from mbsym.algebra.failures import Failure, SingularPoint
    from mbsym.numerics.closing import NothingMoves

    nothing = say(Message("nothing was written."))
    if not isinstance(error, Failure):
        text = Message("the motion does not come to the end, so nothing can be planned: [[why]]", why=error.told)
        return Refusal(f"error[no-plan]: {say(text)}", Exit.BROKEN_DOWN, (nothing,))
    if isinstance(error, SingularPoint):
        text = Message("singular at these values: [[why]]", why=error.reason)
        return Refusal(f"error[singular]: {say(text)}", Exit.BROKEN_DOWN, (nothing,))
    if isinstance(error, NothingMoves):
        hint = say(Message("hint: [[hint]]", hint=error.remedy))
        return Refusal(f"error[{error.code}]: {say(error.reason)}", Exit.BROKEN_DOWN, (f"  {hint}", nothing))
    text = Message("there is no program for these equations: [[why]]", why=error.reason)
    return Refusal(f"error[no-program]: {say(text)}", Exit.FAILED, (nothing,))


def _delivered(file: Path, folder: Path, found: Simulation, asked: Asked) -> int:
    if found.no_invariants:
        text = Message("no first integrals: [[why]]", why=found.no_invariants)
        print(Language(found.system.language).say(text), file=sys.stderr)
    paths = write_files(folder, found, asked)
    if asked.as_json:
        click.echo((folder / "simulation.json").read_text(encoding="utf-8"), nl=False)
    if not asked.quiet:
        print_summary(file, found, paths, asked.verbose)
        if asked.goal is not None:
            print_repeat(file, found.system, asked.goal, found.request)
    return _code(file, found, paths)


def _code(file: Path, found: Simulation, paths: list[Path]) -> int:
    from mbsym.numerics.accuracy import Lacking, NoEstimate
    from mbsym.numerics.enclosure.enclose import INTERRUPTED as CERTIFICATE_INTERRUPTED

    if found.ended is not None:
        print(broken(file, found.ended, found.trajectory, paths), file=sys.stderr)
        return BROKEN_DOWN
    stopped = isinstance(found.error, NoEstimate) and found.error.why is Lacking.INTERRUPTED
    if found.trajectory.interrupted or stopped:
        text = Message("interrupted")
        if found.trajectory.interrupted:
            kept, where = f"{found.times[-1]:.9g}", printable(paths[0].parent)
            text = Message("interrupted; kept up to t = [[time]] in [[folder]]", time=kept, folder=where)
        complain(file, Language(found.system.language).say(text))
        return INTERRUPTED
    proof = found.certificate
    if proof is not None and not (proof.whole and proof.narrow):
        return INTERRUPTED if CERTIFICATE_INTERRUPTED in (proof.ended, proof.enclosure.cut) else BROKEN_DOWN
    return OK if found.plan is None or found.plan.reached else BROKEN_DOWN


Watch: TypeAlias = Callable[[float], None]
Stage: TypeAlias = Callable[[str], AbstractContextManager[object]]


@contextmanager
def _watching(file: Path, asked: Asked) -> Iterator[tuple[Watch, Stage]]:
    """A bar while it integrates, a spinner before and after."""
    from mbsym.simulation import CERTIFYING, COMPILING, ESTIMATING, INTEGRATING
    from mbsym.simulation.run import PLANNING

    said = {
        COMPILING: "compiling",
        ESTIMATING: "the same more finely, to see how good it is",
    }
    with_bar = {INTEGRATING: file.name, CERTIFYING: f"{file.name}: enclosing the exact solution"}
    bars: list[Watch] = []

    @contextmanager
    def stage(what: str) -> Iterator[None]:
        if what == PLANNING:
            with planning(asked, file):
                yield
            return
        if what not in with_bar:
            with status(asked.quiet, f"{file.name}: {said[what]}"):
                yield
            return
        with progress(asked.quiet, with_bar[what], asked.request.time) as bar:
            bars.append(bar)
            yield

    yield (lambda t: bars[-1](t)), stage


def simulated(file: Path, texts: Mapping[str, Any]) -> int:
    """The exit code: all options are read and complained about together, before anything is compiled."""
    folder, settings = folder_for(file, texts["out"]), texts["values"]
    system = read_description(file, moving="simulate")
    asked, context = Options(), click.get_current_context()
    asked.say = Language("" if system is None else system.language).say
    typed = typed_options(context)
    complain_of_pairs(typed, asked)
    complain_of_names(settings, {"--vary": texts["vary"], "--without": texts["without"]}, asked)
    laws: dict[str, Expression] = {}
    for text in texts["laws"] if system is not None else ():
        read_formula(text, system, LAWS, laws, asked)
    own = declared(texts)
    given, overrides = (None, {}) if system is None else given_numbers(file, system, settings, asked, laws, own)
    system = system if given is None else given.system
    seen = integrated(system, texts)
    wanted = read_request(system, texts, asked)
    request = with_further(wanted.request, texts, seen, asked)
    wanted = replace(wanted, request=going_on(request, begun_at(given, request), typed, asked))
    check_held(wanted.request, system, bool(texts["vary"] or texts["sensitivity"]), asked)
    varied, sensitive = read_many(texts, given, wanted, typed, asked)
    wanted = with_goal(texts, seen, wanted, typed, carried(context), asked)
    check_constrained(system, wanted, asked)
    check_states(seen, wanted, asked)
    code = prevented(file, folder, system is not None, asked)
    if code or given is None:
        return code or BAD_INPUT
    if varied is not None:

        def read(more: tuple[str, ...]) -> Scenario | None:
            return given_numbers(file, given.system, (*settings, *more), asked, laws, own)[0]

        from mbsym_cli.simulate.ensemble import spread  # few ask for many motions

        return spread(file, folder, given, overrides, varied, wanted, asked, read)
    code = run(file, folder, given, wanted, asked)
    if code or not sensitive:
        return code
    from mbsym_cli.simulate.ensemble import answers  # nor for sensitivities

    return answers(file, folder, given, overrides, sensitive, wanted)
