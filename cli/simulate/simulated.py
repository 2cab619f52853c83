"""What ``mbsym simulate`` does with its options: reads them all, complains of them all, and hands over."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mbsym_cli.assignments import given_numbers
from mbsym_cli.console import BAD_INPUT, FAILED, complain, read_description
from mbsym_cli.files import obstacle
from mbsym_cli.formulas import LAWS, read_formula
from mbsym_cli.options import Options, group
from mbsym_cli.simulate.choice import with_goal
from mbsym_cli.simulate.closing import begun_at, check_constrained
from mbsym_cli.simulate.continuing import going_on
from mbsym_cli.simulate.ensemble import answers, spread
from mbsym_cli.simulate.many import Many, read_many
from mbsym_cli.simulate.options import Group, Output
from mbsym_cli.simulate.request import check_held, read_request
from mbsym_cli.simulate.run import run
from mbsym_cli.simulate.together import carried, complain_of_names, complain_of_pairs, typed_options
from mbsym_cli.simulate.variables import Variables, check_states

if TYPE_CHECKING:
    from mbsym.expressions.tree import Expression
    from mbsym.model.system import System
    from mbsym.numerics.scenario import Scenario
    from mbsym.simulation import Request


def simulated(
    file: Path,
    folder: Path,
    texts: Mapping[str, Any],
    output: Output,
    many: Many,
    further: Mapping[str, Group],
) -> int:
    """The exit code of one command; ``texts`` by the names of the request's fields."""
    settings = texts["values"]
    system = read_description(file, moving="simulate")
    asked = Options()
    context = click.get_current_context()
    typed = typed_options(context)
    complain_of_pairs(typed, asked)
    complain_of_names(settings, {"--vary": many.vary, "--without": context.params["without"]}, asked)
    laws = read_laws(further["driven"], system, asked)
    variables = further["variables"]
    assert isinstance(variables, Variables)
    own = variables.own
    given, overrides = (None, {}) if system is None else given_numbers(file, system, settings, asked, laws, own)
    system = system if given is None else given.system
    seen = variables.seen(system)
    wanted = replace(read_request(system, texts, output.wanted, output.quiet, asked), verbose=output.verbose)
    for part in further.values():
        wanted = replace(wanted, request=part.added(wanted.request, seen, asked))
    wanted = replace(wanted, request=going_on(wanted.request, begun_at(given, wanted.request), typed, asked))
    check_held(wanted.request, system, bool(many.vary or many.sensitivity), asked)
    varied, sensitive = read_many(many, given, wanted, typed, asked)
    wanted = with_goal(further["choosing"], seen, wanted, settings, typed, carried(context), asked)
    check_constrained(system, wanted, asked)
    check_states(seen, wanted, asked)
    if asked.refused(None if system is None else file) or given is None:
        return BAD_INPUT
    reason = obstacle(folder)
    if reason:
        complain(file, f"the results cannot be written: {reason}")
        return FAILED
    if varied is not None:

        def read(more: tuple[str, ...]) -> Scenario | None:
            assert system is not None
            return given_numbers(file, system, (*settings, *more), asked, laws, own)[0]

        return spread(file, folder, given, overrides, varied, wanted, asked, read)
    code = run(file, folder, given, wanted, asked)
    return code if code or not sensitive else answers(file, folder, given, overrides, sensitive, wanted)


# ``--input``: what the inputs of a description are in a simulation; elsewhere they keep their constant values.


@dataclass(frozen=True)
class Laws:
    """As they were typed."""

    laws: tuple[str, ...]

    def added(self, request: Request, system: System | None, asked: Options) -> Request:
        """The request as it is: inputs are part of the system."""
        return request


def read_laws(laws: Group, system: System | None, asked: Options) -> dict[str, Expression]:
    """The expression of every input that is given one; what is wrong joins the complaints of ``asked``."""
    found: dict[str, Expression] = {}
    if system is None or not isinstance(laws, Laws):
        return found
    for text in laws.laws:
        read_formula(text, system, LAWS, found, asked)
    return found


input_options = group(
    "driven",
    Laws,
    click.option(
        "--input", "laws", multiple=True, metavar="NAME=LAW", help='An input of the file: "u=sin(3*t)"; repeatable.'
    ),
)
