"""Values given on the command line: ``name=expression``, read like a description and complained about like one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from mbsym.expressions.message import Message
from mbsym.expressions.parser import ascii_safe, names_apart, parse_expression
from mbsym.expressions.place import Complaint, Complaints, Span, in_line
from mbsym.expressions.tree import CONSTANTS, Expression, Name, names, substitute, walk
from mbsym.model.system import velocity_name
from mbsym.source import render_option
from mbsym.source.scope import did_you_mean, listed
from mbsym.studies.study import missing as unfit
from mbsym_cli.options import MAX_LENGTH, Options

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.numerics.scenario import Lack, Scenario


@dataclass(frozen=True)
class Assigned:
    """What ``--set`` says: sound expressions by name, and the text that each name was given, sound or not."""

    values: Mapping[str, Expression]
    texts: Mapping[str, str]

    def complain(self, name: str, code: str, message: str, options: Options, hint: str | None = None) -> None:
        """A complaint about one of them as a whole."""
        options.complain_whole("--set", self.texts[name], code, message, hint)


def assignments(texts: Sequence[str], system: System, options: Options) -> Assigned:
    """Expressions by name; every complaint joins those of ``options``.

    A name is that of a parameter, a coordinate (its initial position) or ``<coordinate>_dot`` (its initial velocity);
    an expression is made of numbers, pi and parameters.
    """
    expressions: dict[str, Expression] = {}
    texts_by_name: dict[str, str] = {}
    for text in texts:
        text = " ".join(text.splitlines())
        complaints = Complaints()
        _read(text, system, complaints, expressions, texts_by_name)
        options.add("--set", text, *complaints.sorted())
    return Assigned(expressions, texts_by_name)


def _read(
    text: str, system: System, wrong: Complaints, expressions: dict[str, Expression], texts_by_name: dict[str, str]
) -> None:
    left, equals, right = text.partition("=")
    name, blanks = left.strip(), len(left) - len(left.lstrip())
    span = Span(1, blanks + 1, max(1, len(name)))
    if not equals or not name or len(text) > MAX_LENGTH:
        shown = Message("[[text]] gives no value", text=ascii_safe(text))
        reason = shown if len(text) <= MAX_LENGTH else "this assignment is too long"
        wrong.error("bad-assignment", reason, None, "write name=value, for example l=3/2")
        return
    known = _check_target(name, span, system, wrong)
    if name in texts_by_name:
        wrong.error("repeated-name", Message("[[name]] is set twice", name=f"'{name}'"), span)
    texts_by_name[name] = text
    place = partial(in_line, offset=len(left) + 1)
    value = parse_expression(right, wrong, place)
    parts = walk(value) if value is not None else names_apart(right, place, wrong.items)
    for node in parts:
        if isinstance(node, Name) and node.name not in (*system.parameter_names, *CONSTANTS) and node.span is not None:
            hint = did_you_mean(node.name, system.parameter_names) or "a value is made of numbers, pi and parameters"
            wrong.error("unknown-name", Message("unknown name [[name]]", name=ascii_safe(node.name)), node.span, hint)
    if known and value is not None and not wrong.errors:
        expressions[name] = value


def given_numbers(
    file: Path,
    system: System,
    settings: Sequence[str],
    options: Options,
    laws: Mapping[str, Expression] | None = None,
    declared: bool = False,
    state: bool = True,
) -> tuple[Scenario | None, Mapping[str, Expression]]:
    """The scenario of a system with the values of ``--set``, and these; every complaint joins those of ``options``.

    ``laws`` are those of its inputs; ``declared``: the run is one in declared variables; ``state``:
    whether it needs an initial state.
    """
    from mbsym.numerics.scenario import Incomplete, scenario

    assigned = assignments(settings, system, options)
    try:
        return scenario(system, assigned.values, state, laws=laws, declared=declared), assigned.values
    except Incomplete as error:
        contradictions(file, error.lack, assigned, options)
        unread = _unread(system, assigned)
        lacking = [shown for shown in error.lack.names if shown.split(" ")[0] not in unread]
        if lacking:
            options.complaints.append(missing(file, lacking, say=options.say, led=bool(system.constraints)))
        return None, assigned.values


def sound_numbers(file: Path, system: System, settings: Sequence[str], options: Options) -> Mapping[str, Expression]:
    """The values of ``--set``; those that contradict each other join the complaints, missing ones do not."""
    from mbsym.numerics.scenario import Incomplete, Lack, scenario

    assigned = assignments(settings, system, options)
    try:
        scenario(system, assigned.values, state=False)
    except Incomplete as error:
        contradictions(file, Lack((), error.lack.contradictions), assigned, options)
    return assigned.values


def with_settings(file: Path, system: System, settings: Sequence[str], options: Options) -> System:
    """The description with the values of ``--set``; every complaint joins those of ``options``."""
    from mbsym.model.system import with_values
    from mbsym.numerics.scenario import Lack, contradictions_of

    assigned = assignments(settings, system, options)
    values = {}
    known = {parameter.name: parameter.value for parameter in system.parameters if parameter.value is not None} | dict(
        assigned.values
    )
    for name, value in assigned.values.items():
        if name not in system.parameter_names:
            assigned.complain(
                name, "misplaced-name", Message("'[[name]]' is no parameter: it has no value here", name=name), options
            )
            continue
        values[name] = value
        for _ in system.parameters:  # those in terms of others, which may be in terms of others
            values[name] = substitute(values[name], {k: v for k, v in known.items() if k != name})
        if unset := sorted(names(values[name])):
            assigned.complain(name, "missing-value", Message("no value for [[names]]", names=", ".join(unset)), options)
    if not options.complaints:
        contradictions(file, Lack((), contradictions_of(system, values)), assigned, options)
    return with_values(system, values)


def in_scale(system: System, text: str, options: Options) -> System | None:
    """The description in the variables of ``--scale``; why there is none joins the complaints of ``options``."""
    from mbsym.algebra.failures import Failure
    from mbsym.source.scaling import read_scaling
    from mbsym.studies.groups import in_scale as described

    text, complaints = " ".join(text.splitlines()), Complaints()
    scaling = read_scaling(text, system, complaints)
    options.add("--scale", text, *complaints.sorted())
    try:
        return None if scaling is None else described(system, scaling)
    except Failure as error:
        message = Message("there is no description in these variables: [[why]]", why=error.reason)
        hint = error.remedy or "'mbsym show --scale' prints equations and integrals in them"
        options.complain("--scale", "no-description", message, hint)
    return None


def contradictions(file: Path, lack: Lack, assigned: Assigned, options: Options) -> None:
    """Values that contradict a sign or a relation, or are none: said of ``--set`` where they come from there."""
    for clash in lack.contradictions:
        if clash.name in assigned.texts:
            assigned.complain(clash.name, clash.code, clash.text, options, clash.hint)
        else:
            options.complain(str(file), clash.code, clash.text, clash.hint)


def _unread(system: System, assigned: Assigned) -> set[str]:
    """Names whose value was refused, and what follows from them through relations: these do not lack one."""
    unread = assigned.texts.keys() - assigned.values.keys()
    for _ in system.relations:
        unread |= {relation.name for relation in system.relations if names(relation.value) & unread}
    return unread


def _settable(system: System) -> list[str]:
    return [*system.parameter_names, *system.coordinates, *system.velocities, *system.variables]


def _check_target(name: str, span: Span, system: System, wrong: Complaints) -> bool:
    if name in _settable(system):
        return True
    for item in system.prescribed:
        if name in (item.name, velocity_name(item.name)):
            from mbsym.expressions.tree import text

            rate = Message("its rate is [[rate]]: set what that is made of", rate=text(item.rate))
            wrong.error(
                "misplaced-name",
                Message("'[[name]]' is a prescribed motion and has no value to set", name=name),
                span,
                rate,
            )
            return False
    if name in (item.name for item in system.notation):
        wrong.error(
            "misplaced-name", Message("'[[name]]' is notation: it follows from the parameters", name=name), span
        )
        return False
    if name in system.input_names:
        message = Message("'mbsym simulate --input [[name]]=...' says what it is along a motion", name=name)
        wrong.error(
            "misplaced-name", Message("'[[name]]' is an input and has no value to set", name=name), span, message
        )
        return False
    hint = did_you_mean(name, _settable(system)) or listed("these have values", _settable(system))
    wrong.error("unknown-name", Message("there is nothing called [[name]] to set", name=ascii_safe(name)), span, hint)
    return False


# What has no value, said once, with how to give it.


def missing(
    file: Path, shown: Sequence[str], what: str = "value", say: Callable[[str], str] = str, led: bool = False
) -> str:
    """The complaint of ``study.missing``, about a file."""
    unfit_names = unfit(shown, what, led)
    return render_option(Complaint(unfit_names.code, unfit_names.message, None, unfit_names.hint), "", str(file), say)
