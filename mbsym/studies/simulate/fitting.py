"""What does not go together in ``mbsym simulate``, and what the rest leaves to be integrated; the results."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import product
from math import ceil, inf, prod
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

from mbsym import simulation
from mbsym.expressions.message import Message, joined, worded
from mbsym.expressions.rates import without_velocity
from mbsym.expressions.safe import quoted
from mbsym.expressions.tree import names
from mbsym.model.constraints import listed as listed_constraints
from mbsym.numerics.accuracy import Lacking, NoEstimate
from mbsym.simulation import Request as Run
from mbsym.source.scope import closest, did_you_mean, listed
from mbsym.studies.simulate import WORK, Command, Request
from mbsym.studies.study import Asked, NotFit, Unfit, Watch

if TYPE_CHECKING:
    from mbsym.algebra.failures import Failure
    from mbsym.expressions.place import Complaint
    from mbsym.model.system import System
    from mbsym.numerics.ensembles.ensemble import Ensemble
    from mbsym.numerics.ensembles.variation import Variation
    from mbsym.numerics.planning.models import Model
    from mbsym.numerics.planning.plan import Accuracy, Plan
    from mbsym.numerics.planning.planning import Pins
    from mbsym.numerics.scenario import Scenario
    from mbsym.simulation.motions import Sensitivities
    from mbsym.simulation.request import Earlier
    from mbsym.simulation.run import Stage

#: What an option that goes with coordinates only is answered with.
WAY_OUT = "--variables coordinates integrates coordinates and their velocities, angles among them"

#: A first try of a fixed step is the whole time divided by this.
TRIAL_STEPS = 10_000

#: So many motions of a grid are drawn as curves beside each other.
MOST_BESIDE = 6


# --- what is integrated ---


class Reasons(list[Unfit]):
    """Why a request cannot be met."""

    def complain(self, option: str, code: str, message: str, hint: str | None = None) -> None:
        self.append(Unfit(option, code, message, hint))

    def unread(self, option: str, text: str, complaint: Complaint) -> None:
        """Of a place in a text."""
        self.append(Unfit(f"--{option}", complaint.code, complaint.message, complaint.hint, "", text, complaint.span))


@dataclass(frozen=True)
class Settled:
    """What is integrated; if an accuracy is asked for, that and what was settled by hand; what is ``wrong``."""

    request: Run
    goal: tuple[Accuracy, Pins] | None
    wrong: Reasons


def integrated(system: System, variables: str) -> System:
    """The system with what is integrated in the place of coordinates and velocities, where that can be told."""
    from mbsym.algebra.failures import Failure

    try:
        return simulation.integrated_system(system, variables)
    except Failure:
        return system  # said when it is integrated


def basic(request: Request, seen: System, wrong: Reasons | None = None) -> Run:
    """What commands and Python ask alike of the system ``seen``; fields that could not be read are as if left out.

    Raises ValueError for texts that cannot be read, where there are no Reasons that take them.
    """
    conditions = simulation.read_watch(
        seen, _several(request.events), _several(request.stop), request.section, request.axes,
        None if wrong is None else wrong.unread,
    )  # fmt: skip
    return Run(
        time=request.time or 0.0,
        method=request.method or "auto",
        arithmetic=request.arithmetic or "float64",
        step_limit=request.step_limit or 1,
        longest=request.max_step,
        events=conditions,
        variables=request.variables or simulation.request.DECLARED,
        certify_seconds=inf if request.certify_seconds is None else request.certify_seconds,
        **{name: getattr(request, name) for name in ("samples", "every", "tolerance", "step")},
        **{name: getattr(request, name) for name in ("invariants", "estimate", "whole", "certify")},
    )


def _several(texts: str | Iterable[str]) -> tuple[str, ...]:
    return tuple(" ".join(text.splitlines()) for text in ((texts,) if isinstance(texts, str) else texts))


def settled(context: Asked, request: Command) -> Settled:
    """What the options say, held against each other, before anything is compiled."""
    scenario, typed, wrong = context.scenario, context.typed, Reasons()
    system = context.system if scenario is None else scenario.system
    seen = integrated(system, request.variables or simulation.request.DECLARED)
    _check_names(typed, wrong)
    run_request = basic(request, seen, wrong)
    if request.certify_seconds is None:
        run_request = replace(run_request, certify_limit=WORK)
    if "samples" not in typed or "every" not in typed:
        _check_rows(system, request.time, request.every, request.samples, wrong)
    if request.step is not None and request.time is not None and request.step > request.time:
        longer = "[[step]] is longer than the whole time [[time]]"
        times = {"step": f"{request.step:g}", "time": f"{request.time:g}"}
        wrong.complain("--step", "bad-number", Message(longer, **times))
    if request.method is not None:
        _check_method(system, {} if scenario is None else scenario.parameters, run_request, typed, wrong)
    if "variables" in typed and request.variables is not None and not system.speeds:
        hint = "coordinates and their velocities are integrated; leave --variables out"
        wrong.complain("--variables", "idle-option", "the description declares no speeds", hint)
    run_request = replace(run_request, model=_model(request, system, typed, wrong))
    if "fixed" in typed:
        run_request = _fixed(run_request, request.fixed, system, wrong)
    if request.path is not None:
        run_request = _continued(run_request, request.path, seen, wrong)
        run_request = _going_on(run_request, _begun_at(scenario, run_request, seen is not system), typed, wrong)
    _check_held(run_request, system, bool({"vary", "sensitivity"} & set(typed)), wrong)
    if request.vary or "vary" in typed:
        _check_varied(request, run_request, scenario, typed, wrong)
    if "sensitivity" in typed and scenario is not None:
        _sensitive(request.sensitivity, scenario, wrong)
    _check_constrained(system, run_request, wrong)
    _check_states(seen, run_request, wrong)
    if scenario is not None and seen is not system:
        _check_laws(scenario, wrong)
    if request.accuracy is None:
        return Settled(run_request, None, wrong)
    from mbsym.simulation.accurate import read_accuracy, settled_by  # few ask for an accuracy

    pins = settled_by(run_request)
    if "arithmetic" in typed:
        pins = replace(pins, scalar=run_request.arithmetic)
    return Settled(run_request, (read_accuracy(seen, request.accuracy), pins), wrong)


def _check_names(typed: Mapping[str, Any], wrong: Reasons) -> None:
    """Complains of names whose value two options give."""
    names = {text.partition("=")[0].strip() for text in typed.get("values", ())}
    for option in ("vary", "without"):
        for name in dict.fromkeys(text.partition("=")[0].strip() for text in typed.get(option, ())):
            if name in names and name.isidentifier():  # what is no name is complained about where it is read
                words = "--set [[name]] does not go with [[option]] [[name]]: both give its value"
                wrong.complain("--set", "conflicting-options", Message(words, name=name, option=f"--{option}"))


def _model(request: Command, system: System, typed: Mapping[str, Any], wrong: Reasons) -> Model:
    """The model that was settled by hand."""
    from mbsym.numerics.planning.models import Model

    if "gravity" in typed and not system.newtonian_fields:
        wrong.complain("--gravity", "unsuitable-option", "there is no Newtonian gravity in this description")
    if request.linear and not system.motion:
        hint = "the description says with 'motion:' what the equations are linearised about"
        wrong.complain("--linear", "unsuitable-option", "there is no unperturbed motion", hint)
    order = int(request.gravity) if request.gravity is not None and request.gravity.isdigit() else request.gravity
    return Model(order, request.linear, tuple(dict.fromkeys(request.without)))


def _fixed(request: Run, names: Sequence[str], system: System, wrong: Reasons) -> Run:
    """With initial values that stay."""
    if not system.constraints:
        hint = "initial values stay as they are given; leave --fixed out"
        wrong.complain("--fixed", "idle-option", "there are no constraints that initial values would follow", hint)
        return request
    known = (*system.coordinates, *system.velocities)
    for name in names:
        if name not in known:
            way = did_you_mean(name, known) or listed("these can be fixed", known)
            message = Message("there is nothing called [[name]] to be fixed", name=quoted(name))
            wrong.complain("--fixed", "unknown-name", message, way)
    return replace(request, fixed=tuple(name for name in names if name in known))


def _check_varied(
    request: Command, run: Run, scenario: Scenario | None, typed: Mapping[str, Any], wrong: Reasons
) -> None:
    """Complains of what an ensemble does not know, and of what cannot vary."""
    from mbsym.numerics.ensembles.variation import Grid, complaints_of

    _check_members(run, request.formats, wrong)
    variations = variations_of(request)
    if variations and all(isinstance(variation, Grid) for variation in variations):
        for option in (f"--{name}" for name in ("sampling", "seed") if name in typed):
            words = "[[option]] does not go with --vary [[name]]: a grid, of which nothing is drawn"
            drawn = Message(words, option=option, name=variations[0].name)
            wrong.complain(option, "conflicting-options", drawn, "draw it: name=uniform(low, high)")
    unread = request.vary is None or request.seed is None or request.sampling is None
    if scenario is None or unread or ("members" in typed and request.members is None):
        return
    for name, message, hint in complaints_of(scenario.system, variations, request.members):
        wrong.complain(f"--vary {name}", "bad-variation", message, hint or None)


def variations_of(request: Command) -> tuple[Variation, ...]:
    return tuple(varied.variation for varied in request.vary or ())


def _check_rows(system: System, end: float | None, every: float | None, samples: int | None, wrong: Reasons) -> None:
    from mbsym.numerics.columns import most_rows_in_file

    rows, option = samples, "--samples"
    if every is not None:
        rows, option = None if end is None else int(min(ceil(end / every), 10**18)) + 1, "--every"
    most = most_rows_in_file(system)
    if rows is not None and rows > most:
        hint = Message("at most [[most]] for this system; use --every with a longer interval, or --samples", most=most)
        wrong.complain(option, "too-large", Message("[[rows]] rows are too many", rows=rows), hint)


def _check_held(request: Run, system: System, many: bool, wrong: Reasons) -> None:
    """Complains about rows that have to be in memory together, and do not fit: the others go to a file."""
    from mbsym.numerics.columns import most_rows

    why = {
        "--certify": request.certify is not None,
        "--continue": request.earlier is not None,
        "--vary, --sensitivity": many,
    }
    needing = [option for option, there in why.items() if there]
    rows = request.rows if request.earlier is None else request.samples
    tied = bool(system.constraints)  # their drift is measured by the whole motion
    if not (needing or tied) or rows is None or rows <= most_rows(system):
        return
    hint = Message("at most [[most]] for this system", most=most_rows(system))
    if needing and not tied:
        words = "at most [[most]] for this system, or leave out [[options]]"
        hint = Message(words, most=most_rows(system), options=", ".join(needing))
    option = "--every" if request.every is not None else "--samples"
    message = Message("[[rows]] rows are too many to be held in memory, as they have to be here", rows=rows)
    wrong.complain(option, "too-large", message, hint)


def _check_method(
    system: System, values: Mapping[str, Fraction], request: Run, typed: Mapping[str, Any], wrong: Reasons
) -> None:
    """Whether the method goes with arithmetic, step or tolerance, and loads; before anything is compiled."""
    from mbsym.numerics.methods.symplectic import unsuited
    from mbsym.numerics.methods.table import METHODS

    name = request.method
    has_step, has_tolerance = "step" in typed, "tolerance" in typed
    method = METHODS.get(name)
    if has_step and has_tolerance and not (method is not None and method.traits.fixed):
        hint = "a method takes one or the other"
        wrong.complain("--step", "conflicting-options", "--step and --tolerance exclude each other", hint)
    fixed = ", ".join(key for key, other in METHODS.items() if other.traits.fixed)
    if name == "auto":
        if has_step and not has_tolerance:
            words = "--step goes with a method of fixed step, for example --method rk4 (also [[others]])"
            hint = Message(words, others=fixed)
            wrong.complain("--step", "conflicting-options", "--method auto chooses its steps by a tolerance", hint)
        return
    traits = METHODS[name].traits
    if request.arithmetic not in traits.scalars:
        able = ", ".join(key for key, other in METHODS.items() if request.arithmetic in other.traits.scalars)
        message = Message("[[method]] does not compute in [[arithmetic]]", method=name, arithmetic=request.arithmetic)
        wrong.complain(
            "--arithmetic",
            "conflicting-options",
            message,
            Message("these do: [[names]]", names=able) if able else "no method does",
        )
    if traits.fixed and has_tolerance:
        hint = "give a --step in its place, or take a method that chooses its steps, for example --method dop853"
        if has_step:
            hint = "leave it out, or take a method that chooses its steps, for example --method dop853"
        message = Message("[[method]] takes steps of one length, no tolerance", method=name)
        wrong.complain("--tolerance", "conflicting-options", message, hint)
    elif traits.fixed and not has_step:
        many = f"--step {request.time / TRIAL_STEPS:.2g}" if request.time else "--step H"
        hint = Message(
            "for example [[step]], a [[steps]]th of the time; then halve it until the results no longer change",
            step=many, steps=TRIAL_STEPS,
        )  # fmt: skip
        message = Message("[[method]] takes steps of one length, and there is no --step", method=name)
        wrong.complain("--method", "missing-option", message, hint)
    if traits.fixed and "max_step" in typed:
        example = f"{request.longest or 0.01:g}"
        hint = Message("give a shorter --step in its place, for example --step [[step]]", step=example)
        message = Message("[[method]] takes steps of one length", method=name)
        wrong.complain("--max-step", "conflicting-options", message, hint)
    if not traits.fixed and has_step and not has_tolerance:
        hint = Message("leave --step out, give a --tolerance, or take a method of fixed step: [[names]]", names=fixed)
        message = Message("[[method]] chooses its steps by a --tolerance", method=name)
        wrong.complain("--step", "conflicting-options", message, hint)
    reason = unsuited(system, values) if traits.conservative else None
    if reason is not None:
        reason = joined((name, reason), ": ")
        wrong.complain("--method", "unsuitable-method", reason, "for any system: --method auto, dop853 or rk4")


def _check_members(request: Run, formats: Sequence[str], wrong: Reasons) -> None:
    from mbsym.numerics.ensembles.side_by_side import TABLEAUX

    if request.method != "auto" and request.method not in TABLEAUX:
        message = Message("members do not run side by side with [[method]]", method=request.method)
        wrong.complain(
            "--method", "unsuitable-method", message, Message("choose from [[names]]", names=", ".join(TABLEAUX))
        )
    for kind in formats:
        if kind not in ("csv", "svg", "png", "pdf"):
            message = Message("there is no [[format]] of an ensemble", format=kind)
            wrong.complain(
                "--format", "conflicting-options", message, Message("choose from [[names]]", names="csv, svg, png, pdf")
            )


def _check_constrained(system: System, request: Run, wrong: Reasons) -> None:
    """Complains about every option that does not know constraints yet."""
    if not system.constraints:
        return
    from mbsym.numerics.methods.table import LED, METHODS

    constraints = listed_constraints(system.constraints)
    if request.method in METHODS and request.method not in LED:
        hint = Message("these do: [[names]]", names=", ".join(("auto", *LED)))
        message = Message(
            "[[method]] does not keep to constraints ([[which]])", method=request.method, which=constraints
        )
        wrong.complain("--method", "unsuitable-method", message, hint)


def _check_states(system: System, request: Run, wrong: Reasons) -> None:
    """Complains about every option that goes with coordinates only, where a run has other variables."""
    from mbsym.model.states import InStates

    if not isinstance(system, InStates):
        return
    from mbsym.numerics.methods.table import LED, METHODS

    if request.method not in METHODS or request.method in LED or system.constraints:  # of these it has been told
        return
    these = Message("these do: [[names]]", names=", ".join(("auto", *LED)))
    if METHODS[request.method].traits.conservative:
        words = "[[method]] integrates coordinates and their velocities only, and this system has speeds"
        hint = joined((these, worded(WAY_OUT)), "; ")
        wrong.complain("--method", "unsuitable-method", Message(words, method=request.method), hint)
    elif any(body.orientation for body in system.bodies):
        text = "[[method]] does not keep quaternions and unit vectors at their lengths"
        wrong.complain("--method", "unsuitable-method", Message(text, method=request.method), these)


def _check_laws(scenario: Scenario, wrong: Reasons) -> None:
    """Complains of angles in laws of inputs that are no variables of a run, unit vectors or quaternions are."""
    replaced = {name for body in scenario.system.bodies if body.orientation for name in body.own_angles}
    for driven in scenario.inputs:
        for name in sorted({without_velocity(name) for name in names(driven.law)} & replaced):
            text = "the angle '[[name]]' in the law of [[input]] is no variable of this run"
            message = Message(text, name=name, input=driven.name)
            wrong.complain("--input", "variables", message, joined(("write it in speeds", worded(WAY_OUT)), "; "))


def _sensitive(named: tuple[str, ...], scenario: Scenario, wrong: Reasons) -> None:
    """Complains of what the motion cannot be differentiated by."""
    if not named:
        wrong.complain(
            "--sensitivity",
            "missing-option",
            "there is no name in it",
            Message("for example [[example]]", example="theta,m1"),
        )
    system = scenario.system
    known = (*system.parameter_names, *system.coordinates, *system.velocities, *system.variables)
    following = {relation.name for relation in system.relations}
    for name in named:
        if name not in known:
            close = closest(name, known)
            hint = Message("there are [[names]]", names=", ".join(known))
            if close:
                hint = Message("did you mean '[[other]]'?", other=close)
            message = Message("there is nothing called '[[name]]' here", name=name)
            wrong.complain("--sensitivity", "unknown-name", message, hint)
        elif name in following:
            message = Message("[[name]] follows from other parameters", name=name)
            wrong.complain("--sensitivity", "bad-variation", message, "name those of which its relation is made")
    if _jumps(scenario):
        jumps = "the rates hold sign, abs or step, and derivatives of the motion would miss what their switches do"
        way = "compare runs: --vary with two or three values close together"
        wrong.complain("--sensitivity", "not-smooth", jumps, way)


def _jumps(scenario: Scenario) -> bool:
    """Whether the rates have switches; False where there are no rates, which is told later."""
    from mbsym.algebra.failures import Failure
    from mbsym.numerics.dynamics import Dynamics

    try:
        return bool(Dynamics(scenario).switches.outputs)
    except Failure:
        return False


def _continued(request: Run, path: Path, system: System, wrong: Reasons) -> Run:
    from mbsym.report.runs.earlier_run import Unfit as UnfitRun
    from mbsym.report.runs.earlier_run import read_earlier

    try:
        earlier = read_earlier(path, system)
    except UnfitRun as error:
        wrong.complain("--continue", "unfit-run", error.reason, "take the simulation.json of a run of this FILE")
        return request
    if 0 < request.time <= earlier.time:
        there = f"{earlier.time:.9g}"
        hint = Message("--time is counted from the start: take one beyond [[time]]", time=there)
        message = Message("that run is at t = [[time]] already", time=there)
        wrong.complain("--time", "conflicting-options", message, hint)
    return replace(request, earlier=earlier)


def _begun_at(scenario: Scenario | None, request: Run, declared: bool) -> Scenario | None:
    """With the initial state that a run takes; what was given where there is an answer to that question only later."""
    if scenario is None or request.earlier is None or not (scenario.system.constraints or declared):
        return scenario
    from mbsym.algebra.failures import Failure
    from mbsym.numerics.closing import begun
    from mbsym.numerics.tangent import on_tangent

    try:
        start = begun(scenario, request.fixed, declared).scenario
        return on_tangent(start, request.fixed) if request.earlier.model.linear else start
    except Failure:
        return scenario


def _going_on(request: Run, scenario: Scenario | None, typed: Mapping[str, Any], wrong: Reasons) -> Run:
    """The request, integrated as the earlier run was but for what was ``typed``; what does not fit is complained about.

    The model and the arithmetic stay: rows of two models, or of a state that was rounded on the way, are no run.
    """
    from mbsym.numerics.methods.table import METHODS

    earlier = request.earlier
    if earlier is None:
        return request
    if request.model != earlier.model:
        for option in (f"--{name}" for name in sorted({"gravity", "linear", "without"} & set(typed))):
            message = Message("[[option]] does not go with --continue: that run was one as described", option=option)
            if earlier.model.label != "as described":
                words = "[[option]] does not go with --continue: that run was one of another model: [[model]]"
                message = Message(words, option=option, model=worded(earlier.model.label))
            wrong.complain(option, "conflicting-options", message, "leave it out: the model of that run is taken")
    request = replace(request, model=earlier.model, arithmetic=earlier.arithmetic)
    if request.method == "auto":
        request = _as_before(request, earlier, typed, wrong)
    elif earlier.arithmetic not in METHODS[request.method].traits.scalars:
        words = "--method [[method]] does not go with --continue: that run was one in [[arithmetic]]"
        message = Message(words, method=request.method, arithmetic=earlier.arithmetic)
        able = ", ".join(name for name, method in METHODS.items() if earlier.arithmetic in method.traits.scalars)
        wrong.complain(
            "--method", "conflicting-options", message, Message("these compute in it: [[names]]", names=able)
        )
    _check_values(request, scenario, wrong)
    return request


def _as_before(request: Run, earlier: Earlier, typed: Mapping[str, Any], wrong: Reasons) -> Run:
    """With the method of the earlier run, its tolerance unless one was typed, or its step."""
    if earlier.step is not None:
        for option in (option for option in ("--max-step", "--tolerance") if option[2:].replace("-", "_") in typed):
            words = "[[option]] does not go with --continue: that run took steps of one length by [[method]]"
            message = Message(words, option=option, method=earlier.method)
            wrong.complain(option, "conflicting-options", message, "--method dop853 chooses its steps")
    tolerance = None if earlier.step is not None else request.tolerance or earlier.tolerance
    return replace(request, method=earlier.method, tolerance=tolerance, step=earlier.step)


def _check_values(request: Run, scenario: Scenario | None, wrong: Reasons) -> None:
    """Complains about values that are not those of the run that is gone on from."""
    from mbsym.report.runs.earlier_run import changed

    if request.earlier is None or scenario is None:
        return
    different = list(changed(request.earlier, scenario))
    if different:
        message = Message("that run had other values: [[values]]", values=joined(different, "; "))
        wrong.complain("--continue", "unfit-run", message, "repeat the --set of that run, or leave out --continue")


# --- what is found ---


@dataclass(frozen=True)
class Motion:
    """One motion, with its derivatives by some names where these are asked for, or what broke them off.

    ``before``: its plan, or its error estimate, was measured by an earlier command.
    """

    run: simulation.Simulation
    derivatives: Sensitivities | None = None
    stopped: Failure | KeyboardInterrupt | None = None
    before: bool = False


@dataclass(frozen=True)
class Planned:
    """What an accuracy chooses and the request that repeats its run; ``before``: an earlier command measured it."""

    plan: Plan
    request: Run
    before: bool = False


#: What varies, with its values.
Member: TypeAlias = tuple[tuple[str, float], ...]


@dataclass(frozen=True)
class Many:
    """An ensemble; the runs of its members where these are few, by what varies."""

    ensemble: Ensemble
    few: Mapping[Member, simulation.Simulation] = field(default_factory=dict)


Result: TypeAlias = Motion | Planned | Many


def derived(context: Asked, request: Command, watch: Watch) -> Result:
    """Raises NotFit for what is seen only when equations are put into code, Breakdown where nothing can be planned."""
    from mbsym.algebra.failures import message_of
    from mbsym.numerics.enclosure.field import NotAnalytic
    from mbsym.numerics.ensembles.variation import Unvaried
    from mbsym.numerics.methods.interface import Unusable

    try:
        return _derived(context, request, watch)
    except simulation.NoEvent as error:
        message = Message("[[name]] has no value: [[why]]", name=quoted(error.text), why=error.reason)
        reasons = [Unfit(f"--{error.option}", "no-value", message)]
    except Unusable as error:
        hint = "--method auto chooses one that can"
        reasons = [Unfit("--method", "unsuitable-method", message_of(error), hint)]
    except NotAnalytic as error:
        message = Message("[[what]] in the equations has no power series", what=str(error))
        hint = "leave --certify out: enclosures go through power series"
        if error.rows:
            told = (
                "[[rows]]: this follows from other constraints; which are used is chosen on the way, by no power series"
            )
            message = Message(told, rows="; ".join(error.rows))
            hint = "write constraints of which none follows from others:  relation: a = b  for a second 'coincide'"
        reasons = [Unfit("--certify", "not-analytic", message, hint)]
    except Unvaried as error:
        reasons = [Unfit(f"--vary {name}", "bad-variation", text, hint or None) for name, text, hint in error.reasons]
    raise NotFit(reasons)


def _derived(context: Asked, request: Command, watch: Watch) -> Result:
    from mbsym.algebra.failures import Failure

    scenario, settling, recall = context.motion, settled(context, request), _Recalling(context, request.anew)
    run_request = settling.request
    if settling.goal is not None and request.plan:
        from mbsym.simulation.accurate import plan_for

        watch(PLANNING)
        plan = plan_for(scenario, run_request, *settling.goal, recall=recall)
        return Planned(*plan, recall.before)
    if request.vary:
        return _many(context, request, run_request, watch)
    at, stage = _watched(run_request.time, watch)
    stored = replace(run_request, store=context.store())
    if settling.goal is not None:
        from mbsym.simulation.accurate import simulate_accurately

        run = simulate_accurately(scenario, stored, *settling.goal, at, stage, recall=recall)
    else:
        run = simulation.simulate(scenario, stored, at, stage, recall)
    result = Motion(run, before=recall.before)
    if request.sensitivity and run.whole:
        from mbsym.simulation.motions import sensitivities

        watch("how it answers to changes")
        try:
            values = simulation.read_values(scenario.system, request.values)
            result = replace(result, derivatives=sensitivities(scenario, run_request, request.sensitivity, values))
        except (Failure, KeyboardInterrupt) as error:  # what was integrated is written all the same
            result = replace(result, stopped=error)
    watch("drawing")
    return result


T = TypeVar("T")


class _Recalling:
    """Plans and error estimates by what earlier commands measured; ``before``: whether any was there."""

    def __init__(self, context: Asked, anew: bool) -> None:
        self._context, self._anew, self.before = context, anew, False

    def __call__(self, what: str, scenario: Scenario, request: Run, how: object, measure: Callable[[], T]) -> T:
        if request.earlier is not None:
            return measure()
        asked = replace(request, store=None), how
        found, before = self._context.measured(what, scenario, asked, measure, self._anew, _sound)
        self.before |= before
        return found


def _sound(found: object) -> bool:
    return not (isinstance(found, NoEstimate) and found.why is Lacking.INTERRUPTED)


PLANNING = "choosing model, method and tolerance"


def _watched(time: float, watch: Watch) -> tuple[Callable[[float], None], Stage]:
    """(the bar, words about what goes before and after)."""
    from mbsym.simulation import CERTIFYING, COMPILING, ESTIMATING, INTEGRATING, run

    words = {
        run.PLANNING: PLANNING,
        COMPILING: "compiling",
        INTEGRATING: "",
        ESTIMATING: "the same more finely, to see how good it is",
        CERTIFYING: "enclosing the exact solution",
    }
    doing = [""]

    @contextmanager
    def stage(what: str) -> Iterator[None]:
        doing.append(words[what])
        watch(doing[-1])
        yield
        doing.pop()

    return lambda t: watch(doing[-1], t, time), stage


def _many(context: Asked, request: Command, run: Run, watch: Watch) -> Many:
    """Curves of a few members are runs of their own; none where one of these has no scenario."""
    from mbsym.expressions.tree import number
    from mbsym.numerics.scenario import Incomplete, scenario
    from mbsym.simulation.ensembles import Spread, simulate_many

    nominal, variations = context.motion, variations_of(request)
    spread = Spread(run, variations, request.members, request.seed, request.sampling)
    values = simulation.read_values(nominal.system, request.values)
    ensemble = simulate_many(nominal, spread, values, watch=lambda t: watch("", t, run.time))
    few: dict[Member, simulation.Simulation] = {}
    drawn = set(request.formats) - {"csv"} and not ensemble.interrupted
    for member in _few(variations) if drawn else ():
        name = ", ".join(f"{name} = {value:.6g}" for name, value in member)
        own = {name: number(Fraction(str(value))) for name, value in member}
        try:
            begun = scenario(
                nominal.system, {**values, **own}, declared=request.variables == simulation.request.DECLARED
            )
        except Incomplete:
            return Many(ensemble)
        few[member] = simulation.simulate(
            begun,
            replace(run, estimate=False),
            lambda t, name=name: watch(name, t, run.time),  # type: ignore[misc]
        )
    watch("drawing")
    return Many(ensemble, few)


def _few(variations: Sequence[Variation]) -> tuple[Member, ...]:
    """The members by what varies, where they are grids of no more than can be drawn beside each other."""
    from mbsym.numerics.ensembles.variation import Grid

    grids = [variation for variation in variations if isinstance(variation, Grid)]
    if len(grids) < len(variations) or prod(grid.count for grid in grids) > MOST_BESIDE:
        return ()
    return tuple(product(*([(grid.name, float(value)) for value in grid.values] for grid in grids)))
