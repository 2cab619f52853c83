"""Which options of ``mbsym simulate`` go together: declared here, and nowhere else.

A pair that is not in ``APART`` works, and both of its options have their effect; ``tests/cli/test_option_pairs.py``
runs every pair.  What depends on values besides (a method without an arithmetic, --step and a method that chooses its
steps) is complained about where those are read.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any

import click
from click.core import ParameterSource

from mbsym_cli.options import Options

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
    def message(self) -> str:
        return f"{self.option} does not go with {self.other}: {self.why}"


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
            asked.complain(need.option, "missing-option", f"{need.option} goes with {need.other}", need.hint)


def complain_of_names(settings: Collection[str], others: Mapping[str, Collection[str]], asked: Options) -> None:
    """Complains of names whose value two options give; ``others``: of --vary, --without, what they were given."""
    given = {text.partition("=")[0].strip() for text in settings}
    for option, texts in others.items():
        for name in dict.fromkeys(text.partition("=")[0].strip() for text in texts):
            if name in given and name.isidentifier():  # what is no name is complained about where it is read
                message = f"--set {name} does not go with {option} {name}: both give its value"
                asked.complain("--set", "conflicting-options", message)
