"""The options of ``mbsym simulate``, in the order of its help, and which of them go together.

Those that Python has, too, are fields of a request.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from mbsym.expressions.message import Message, worded
from mbsym.studies.request import fields_of
from mbsym.studies.simulate import Request
from mbsym_cli.console import OutPath
from mbsym_cli.options import Options
from mbsym_cli.requests import option_of

#: ``--certify`` without a number; the narrowest and the widest that can be asked for.
USUAL_WIDTH, NARROWEST, WIDEST = "1e-10", 1e-100, 1e-3

#: What a proof may cost where no seconds are given: counted work, worth about so many seconds.
WORK = 600.0

#: Words of ``--gravity``.
ORDERS = ("2", "3", "4", "exact")


def _option(name: str, help: str = "", metavar: str | None = None, **further: Any) -> click.Option:
    return click.Option(name.split(), help=help or None, metavar=metavar, **further)


def _flag(name: str, help: str) -> click.Option:
    return _option(name, help, is_flag=True)


def _fields(*names: str) -> Iterator[click.Option]:
    by_name = {field.name: field for field in fields_of(Request)}
    return (option_of(by_name[name]) for name in names)


OPTIONS: tuple[click.Option, ...] = (
    *_fields("time", "values", "samples", "every"),
    _option("--input laws", 'An input of the file: "u=sin(3*t)"; repeatable.', "NAME=LAW", multiple=True),
    *_fields("method", "tolerance", "step", "max_step", "arithmetic", "step_limit", "invariants", "estimate", "whole"),
    _option(
        "--accuracy",
        "Tolerable relative error over the whole time (1e-6; theta=1e-6,energy=1e-9): model, method, "
        "tolerance and arithmetic are chosen for it.",
        "X",
    ),
    _flag("--plan", "Print what --accuracy chooses and its bound; run nothing."),
    _option(
        "--gravity",
        "Order of Newtonian gravity.  [default: as described; chosen by --accuracy]",
        f"[{'|'.join(ORDERS)}]",
    ),
    _flag("--linear", "Integrate the equations linearised about the unperturbed motion."),
    _option("--without", "Take a parameter as zero; repeatable.", "NAME", multiple=True),
    _option(
        "--vary",
        "Many motions at once: theta=0:pi/2:1000 (a grid), theta=normal(0.3, 0.01), m=uniform(1, 2); repeatable.",
        "NAME=RANGE",
        multiple=True,
    ),
    _option("--members", "How many members to draw at random, for example --members 1000.", "N"),
    _option("--seed", "Of what is drawn at random.", "N", default="1", show_default=True),
    _option("--sampling", metavar="[random|sobol]", default="random", show_default=True),
    _option(
        "--sensitivity", "Derivatives of the motion by initial values and parameters: --sensitivity theta,m1.", "NAMES"
    ),
    _option(
        "--certify width",
        "Prove where the exact solution is, to this part of each size, and how far the run is from it.  "
        f"[default: {USUAL_WIDTH}]",
        "[WIDTH]",
        is_flag=False,
        flag_value=USUAL_WIDTH,
    ),
    _option(
        "--certify-seconds",
        "How long the proof may take; ends early where a tenth of it shows that ten times as much would not do.  "
        f"[default: counted work, worth about {WORK:g} s]",
        "S",
    ),
    _option("--event events", 'Record when: "theta = 0 rising"; repeatable.', "CONDITION", multiple=True),
    _option("--stop stops", 'End the run when: "r < 1/10"; repeatable.', "CONDITION", multiple=True),
    _option("--section", 'Poincare section: "t = 0 mod 2*pi/Omega", "q1 = 0 rising".', "CONDITION"),
    _option("--axes", 'Of the section: "q2, q2_dot".  [default: the first free coordinate]', "X,Y"),
    _option(
        "--continue path",
        "Go on from where an earlier run of FILE ended, up to T; its rows come first.",
        "simulation.json",
        type=click.Path(path_type=Path),
    ),
    _option("--fixed", "Initial values that stay while the others are fitted to the constraints.", "NAMES"),
    _option(
        "--variables",
        "Of a description with speeds: integrate these, and unit vectors or quaternions in place of angles, or "
        "coordinates and their velocities.  [default: declared]",
        "[declared|coordinates]",
    ),
    _option("--format -f formats", default="csv,svg,png", show_default=True),
    _flag("--bodies", "What each body does, in bodies.csv; the same as format bodies-csv."),
    _flag("--animate", "animation.html and animation.gif; the same as formats html,gif."),
    _flag("--json as_json", "Print JSON, that of simulation.json or ensemble.json, instead of a summary."),
    _option("--out -o", "Folder.  [default: reports/NAME]", type=OutPath(path_type=Path, file_okay=False)),
    _flag("--quiet -q", "Print only what went wrong."),
    _flag("--verbose -v", "Tell how it was done, too: method, setting, work, what rests."),
)


# Which options of ``mbsym simulate`` go together: declared here, and nowhere else.


COMMANDLINE = ParameterSource.COMMANDLINE

#: What a plan hands on to the command that runs it.
CARRIED = ("laws", "variables", "fixed", "formats", "bodies", "animate", "out", "estimate", "certify_seconds")


@dataclass(frozen=True)
class Apart:
    """Two options that do not go together, and why; one may have its value, ``--method midpoint``."""

    option: str
    other: str
    why: str
    hint: str | None = None

    @property
    def message(self) -> Message:
        words = "[[option]] does not go with [[other]]: [[why]]"
        return Message(words, option=self.option, other=self.other, why=worded(self.why))


@dataclass(frozen=True)
class Needed:
    """An option that says something of another one only."""

    option: str
    other: str
    hint: str


def _apart(options: Collection[str], others: Collection[str], why: str, hint: str | None = None) -> Iterator[Apart]:
    for option, other in product(options, others):
        yield Apart(option, other, why, hint)


#: Midpoint rules are written for the system's own coordinates.
MIDPOINTS = ("--method midpoint", "--method midpoint4", "--method midpoint6")

MODEL = ("--gravity", "--linear", "--without")

APART: tuple[Apart, ...] = (
    *_apart(("--every",), ("--samples",), "they exclude each other"),
    *_apart(("--sensitivity",), ("--vary",), "they exclude each other, one is about one motion, the other about many"),
    *_apart(
        ("--accuracy", "--plan", *MODEL),
        ("--vary", "--sensitivity"),
        "models and accuracies are chosen for one motion by itself",
    ),
    *_apart(("--event", "--stop", "--section", "--axes"), ("--vary",), "members are not watched"),
    *_apart(("--certify",), ("--vary",), "one motion is enclosed, not many"),
    *_apart(("--invariants",), ("--vary",), "first integrals are not followed for every member"),
    *_apart(("--whole",), ("--vary",), "members are integrated whole in any case, with welded bodies lumped"),
    *_apart(("--estimate", "--no-estimate"), ("--vary",), "some members are always integrated more finely"),
    *_apart(("--bodies", "--animate"), ("--vary",), "there are no bodies of an ensemble to be shown"),
    *_apart(("--continue",), ("--vary",), "an earlier run is one motion"),
    *_apart(("--arithmetic float32", "--arithmetic extended"), ("--vary",), "members are computed in float64"),
    *_apart(
        ("--arithmetic float32", "--arithmetic extended"), ("--sensitivity",), "derivatives are computed in float64"
    ),
    *_apart(
        ("--sensitivity",),
        MIDPOINTS,
        "midpoint rules are those of a system with a potential, and the variational equations have none",
        "take --method dop853, rk4 or radau",
    ),
    *_apart(
        ("--sensitivity",), ("--stop",), "derivatives at the moment at which a condition holds are other derivatives"
    ),
    *_apart(("--sensitivity",), ("--continue",), "derivatives by the state at t = 0 want the motion from there on"),
    *_apart(("--plan",), ("--stop",), "a plan is for the whole --time", "take the --time at which it stops"),
    *_apart(("--json",), ("--plan",), "a plan is told in words, and as the command that repeats it"),
    *_apart(("--plan",), ("--certify",), "a plan runs nothing of which anything could be proved"),
    *_apart(
        ("--accuracy",),
        ("--continue",),
        "its bound is one from t = 0 on, and how wrong the earlier run was is not known",
        "run it from t = 0, or leave --accuracy out: the earlier method and tolerance are taken",
    ),
    *_apart(("--arithmetic",), ("--continue",), "the arithmetic is that of the earlier run"),
)

NEEDED: tuple[Needed, ...] = (
    Needed("--members", "--vary", "write name=normal(0.3, 0.01) or name=uniform(0, 1)"),
    Needed("--seed", "--vary", "write name=normal(0.3, 0.01) or name=uniform(0, 1)"),
    Needed("--sampling", "--vary", "write name=normal(0.3, 0.01) or name=uniform(0, 1)"),
    Needed("--certify-seconds", "--certify", "for example --certify 1e-10"),
    Needed("--axes", "--section", 'for example --section "q1 = 0 rising"'),
    Needed("--plan", "--accuracy", "for example --accuracy 1e-6"),
)


def typed_options(context: click.Context) -> frozenset[str]:
    """The options on the command line, and ``--option value`` of those that have a text."""
    found: set[str] = set()
    for parameter in context.command.params:
        name = parameter.name
        if isinstance(parameter, click.Option) and name and context.get_parameter_source(name) is COMMANDLINE:
            found |= _names(parameter, context.params.get(name))
    return frozenset(found)


def carried(context: click.Context) -> tuple[str, ...]:
    """What was typed of what is written and estimated, as words of the command that repeats a run."""
    found: list[str] = []
    for parameter in context.command.params:
        if parameter.name not in CARRIED or context.get_parameter_source(parameter.name) is not COMMANDLINE:
            continue
        value, name = context.params.get(parameter.name), max(parameter.opts, key=len)
        if isinstance(value, tuple):
            found += [word for one in value for word in (name, str(one))]
        elif isinstance(value, bool):
            found.append(name if value else parameter.secondary_opts[0])
        else:
            found += [name, str(value)]
    return tuple(found)


def _names(option: click.Option, value: Any) -> set[str]:
    long = max(option.opts, key=len)
    if option.secondary_opts and value is False:
        return set(option.secondary_opts)
    return {long, f"{long} {value.lower()}"} if isinstance(value, str) else {long}


def complain_of_pairs(typed: Collection[str], asked: Options) -> None:
    """Complains of every two options that do not go together, and of those that lack the one they are about."""
    for one in APART:
        if one.option in typed and one.other in typed:
            asked.complain(one.option.split()[0], "conflicting-options", one.message, one.hint)
    for need in NEEDED:
        if need.option in typed and need.other not in typed:
            asked.complain(
                need.option,
                "missing-option",
                Message("[[option]] goes with [[other]]", option=need.option, other=need.other),
                need.hint,
            )


def complain_of_names(settings: Collection[str], others: Mapping[str, Collection[str]], asked: Options) -> None:
    """Complains of names whose value two options give; ``others``: of --vary, --without, what they were given."""
    given = {text.partition("=")[0].strip() for text in settings}
    for option, texts in others.items():
        for name in dict.fromkeys(text.partition("=")[0].strip() for text in texts):
            if name in given and name.isidentifier():  # what is no name is complained about where it is read
                words = "--set [[name]] does not go with [[option]] [[name]]: both give its value"
                message = Message(words, name=name, option=option)
                asked.complain("--set", "conflicting-options", message)
