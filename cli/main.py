"""The ``mbsym`` command: a file here, or a study, a sub-command; this one only lists them.

Sub-commands are imported when they are called, so that ``mbsym --help`` does not wait for the algebra.
"""

from __future__ import annotations

import importlib
import inspect
import os
import sys
from collections.abc import Callable, Sequence
from copy import copy
from itertools import pairwise
from typing import Any, NamedTuple

import click

import mbsym


class Listed(NamedTuple):
    """A command: the module here that defines ``command``, or that of a study; what it does in a line."""

    module: str
    does: str


COMMANDS = {
    "new": Listed("new", "Begin a description: asks, or takes an example."),
    "examples": Listed("examples", "List the systems that come with mbsym, or copy them."),
    "check": Listed("check", "Validate descriptions without deriving anything."),
    "run": Listed("mbsym.studies.run", "Derive the numbered problems and write reports."),
    "batch": Listed("batch.command", "Derive folders of descriptions: in parallel, only what changed."),
    "watch": Listed("watch", "Derive a description again whenever it is saved."),
    "diff": Listed("diff", "Say exactly what changed between results, or descriptions."),
    "show": Listed("mbsym.studies.show", "Print one formula, or the equations of motion."),
    "simulate": Listed("mbsym.studies.simulate", "Integrate the equations of motion and draw figures."),
    "view": Listed("mbsym.studies.view", "Show a system in three dimensions, as one page."),
    "inverse": Listed("mbsym.studies.inverse", "Find the inputs that a given motion needs."),
    "orbit": Listed("mbsym.studies.orbit", "Find a periodic motion near a guess, with its multipliers."),
    "lyapunov": Listed("mbsym.studies.lyapunov", "Measure how fast neighbouring motions part."),
    "floquet": Listed("mbsym.studies.floquet", "Judge stability where coefficients are periodic in time."),
    "regressor": Listed("mbsym.studies.regressor", "Find base parameters of a robot, and their regressor."),
    "tradeoff": Listed("mbsym.studies.tradeoff", "Measure what accuracy of a simulation costs."),
    "extremes": Listed("mbsym.studies.extremes", "Measure how many digits are kept at extreme values."),
    "map": Listed("mbsym.studies.map", "Divide a plane of parameters into regions of one verdict."),
    "groups": Listed("mbsym.studies.groups", "Find the dimensionless groups of a system."),
    "average": Listed("mbsym.studies.average", "Average a system over a fast phase."),
    "expand": Listed("mbsym.studies.expand", "Expand a slow integral manifold in a small parameter."),
    "oscillations": Listed("mbsym.studies.oscillations", "Find periodic motions in powers of a small parameter."),
    "integrals": Listed("mbsym.studies.integrals", "Find all polynomial first integrals, or prove there are none."),
    "symmetries": Listed("mbsym.studies.symmetries", "Find symmetries that coordinates hide, and their integrals."),
    "sweep": Listed("mbsym.studies.sweep", "Measure stability or a number at a million parameter values."),
    "equilibria": Listed("mbsym.studies.equilibria", "List relative equilibria at values, with their stability."),
    "trim": Listed("mbsym.studies.trim", "Find inputs or parameters that hold a described motion."),
    "nonlinear": Listed("mbsym.studies.nonlinear", "List where terms of higher order decide otherwise."),
    "convert": Listed("convert", "Convert YAML, plain text, and robots (URDF, MJCF)."),
    "schema": Listed("schema", "Print a JSON Schema, for editors and scripts."),
    "edit": Listed("edit", "Draw, describe and understand a mechanism in the browser."),
    "lsp": Listed("lsp", "Serve an editor: complaints, completion, hover."),
    "explain": Listed("explain", "Tell what a problem computes, what a description holds."),
}


#: The commands by what a person is about; every one stands in one group.
GROUPS = {
    "Start": ("new", "examples", "check", "edit", "explain"),
    "Derive": ("run", "show", "watch", "batch", "diff"),
    "Motion": ("simulate", "view", "orbit", "inverse", "regressor", "lyapunov"),
    "Stability": ("equilibria", "trim", "map", "sweep", "floquet", "nonlinear"),
    "Integrals, small parameters": ("integrals", "symmetries", "groups", "average", "expand", "oscillations"),
    "Accuracy": ("tradeoff", "extremes"),
    "Files": ("convert", "schema", "lsp"),
}


#: ``--help`` of a command fills no more lines, as far as its options leave room.
SCREEN = 50


#: A block of examples is left with so many lines: its heading, and three of them.
FEWEST = 5


class Helped(click.Context):
    """``--help`` tells as much of a command as a screen holds; ``--help-all`` and ``mbsym explain`` tell all of it."""

    def get_help(self) -> str:
        text = super().get_help()
        own = copy(self.command)
        paragraphs = inspect.cleandoc(own.help or "").split("\n\n")
        at = next(
            (k for k, paragraph in enumerate(paragraphs) if "Example" in paragraph.partition(":")[0]), len(paragraphs)
        )
        prose, examples = paragraphs[:at], "\n\n".join(paragraphs[at:]).splitlines()
        more = f"All that there is to say: mbsym {self.info_name} --help-all"
        while text.count("\n") >= SCREEN and (len(prose) > 1 or len(examples) > FEWEST):
            (prose if len(prose) > 1 else examples).pop()
            own.help = "\n\n".join([*prose, more, "\n".join(examples)])
            text = own.get_help(self)
        rare = [option for option in own.params if option.name in getattr(own, "rare", ())]
        if text.count("\n") >= SCREEN and rare:
            more = f"{len(rare)} further options, and all that there is to say: mbsym {self.info_name} --help-all"
            own.help = "\n\n".join([*prose, more, "\n".join(examples)])
            own.params = [option for option in own.params if option not in rare]
            text = own.get_help(self)
        return text


#: Where a context has the words of its command line.
WORDS = "mbsym.words"


class LazyGroup(click.Group):
    """A group whose commands are imported on demand."""

    def list_commands(self, context: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, context: click.Context, name: str) -> click.Command | None:
        if name not in COMMANDS:
            return None
        command = _command(COMMANDS[name].module)
        command.short_help, command.context_class = COMMANDS[name].does, Helped
        if not any(option.name == "debug" for option in command.params):
            if name == "new" or any(option.name == "out" for option in command.params):
                command.params.append(_force())
            command.params += [_debug(), _help_all()]
        return command

    def format_commands(self, context: click.Context, formatter: click.HelpFormatter) -> None:
        """The commands in their groups, for which none of them is imported."""
        for title, names in GROUPS.items():
            with formatter.section(title):
                formatter.write_dl([(f"{name:<12}", COMMANDS[name].does) for name in names])

    def resolve_command(
        self, context: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """With a hint where the name of a command is misspelt."""
        name = args[0]
        if name not in COMMANDS and not name.startswith("-"):
            from difflib import get_close_matches

            from mbsym.expressions.message import Message
            from mbsym.report.formulas_by_name import named_by

            near, meant = get_close_matches(name, COMMANDS, 1), named_by(name)
            if meant:
                text = "there is no command '[[name]]'; 'mbsym show FILE [[shown]]' prints it"
                context.fail(Message(text, name=name, shown=" ".join(meant)))
            if near:
                context.fail(
                    Message("there is no command '[[name]]'; did you mean '[[near]]'?", name=name, near=near[0])
                )
            known = ", ".join(COMMANDS)
            context.fail(Message("there is no command '[[name]]'; there are [[known]]", name=name, known=known))
        return super().resolve_command(context, args)

    def main(self, *args: Any, **extra: Any) -> Any:
        """In a process of its own the command is also safe from what its streams do."""
        from mbsym.studies.study import Exit
        from mbsym_cli.beside import Beside
        from mbsym_cli.streams import Streams, own_process, stoppable

        if not own_process():
            return super().main(*args, **extra)
        Beside.allowed = True
        streams = Streams()
        with stoppable() as signals:
            try:
                super().main(*args, **extra)
                code: Any = Exit.OK
            except SystemExit as ended:
                code = ended.code
        refused = streams.refused()
        if refused:
            print(f"standard output cannot be written: {refused}", file=sys.stderr)
            code = code or Exit.FAILED
        if signals and code == Exit.INTERRUPTED:
            code = 128 + signals[0]
        sys.exit(code)

    def parse_args(self, context: click.Context, args: list[str]) -> list[str]:
        """The words are kept: they tell in which language to complain about them."""
        context.meta[WORDS] = list(args)
        return super().parse_args(context, args)

    def invoke(self, context: click.Context) -> Any:
        """Ctrl-C, wherever it comes, ends with the code that shells count the signal as; a mistake of ours with 1."""
        from mbsym.studies.study import Exit
        from mbsym_cli.console import Debugging, Force, defect, listening, reason_of, trace

        Debugging.wanted = Force.wanted = False
        words = context.meta[WORDS]
        try:
            with listening() as defects:
                try:
                    return super().invoke(context)
                except SystemExit as ended:
                    if defects.tell() and ended.code in (Exit.OK, None):
                        ended.code = Exit.FAILED
                    raise
        except click.exceptions.NoArgsIsHelpError:
            raise
        except click.UsageError as error:
            from mbsym_cli.usage import Misused

            raise Misused(error, _said_in(words)) from error
        except (click.ClickException, click.exceptions.Exit, click.Abort):
            raise
        except OSError as error:
            print(reason_of(error), file=sys.stderr)
            trace(error)
        except Exception as error:
            defect(error)
        except KeyboardInterrupt:
            print(_said_in(words)("interrupted; what has been written is whole"), file=sys.stderr)
            sys.exit(Exit.INTERRUPTED)
        sys.exit(Exit.FAILED)


def _said_in(words: Sequence[str]) -> Callable[[str], str]:
    """Says messages in the language that a command line asks for, or in that of the descriptions on it."""
    from mbsym.model.system import LANGUAGES
    from mbsym.report.language import Language
    from mbsym_cli.console import speaking

    named = [other for word, other in pairwise(words) if word == "--language"]
    named += [word.partition("=")[2] for word in words if word.startswith("--language=")]
    if named and named[-1] in LANGUAGES:
        return Language(named[-1]).say
    return speaking(*(word for word in words if os.path.isfile(word)))


def _command(module: str) -> click.Command:
    if not module.startswith("mbsym."):
        written: click.Command = importlib.import_module(f"mbsym_cli.{module}").command
        return written
    from mbsym_cli.study import command_of

    return command_of(importlib.import_module(module).STUDY)


def _force() -> click.Option:
    """``--force``, of every command that writes files."""

    def want(context: click.Context, _: click.Parameter, value: bool) -> None:
        from mbsym_cli.console import Force

        Force.wanted = Force.wanted or value

    help_text = "Replace files that mbsym did not write, too."
    return click.Option(["--force"], is_flag=True, expose_value=False, callback=want, help=help_text)


def whole_help(command: click.Command, parent: click.Context | None, name: str | None) -> str:
    """All that there is to say of a command, however long."""
    return command.get_help(click.Context(command, parent, name, max_content_width=100))


def _help_all() -> click.Option:
    def whole(context: click.Context, _: click.Parameter, wanted: bool) -> None:
        if wanted:
            click.echo(whole_help(context.command, context.parent, context.info_name))
            context.exit()

    return click.Option(
        ["--help-all"], is_flag=True, is_eager=True, expose_value=False, callback=whole, help="Show all of it and exit."
    )


def _debug() -> click.Option:
    """``--debug``, before the command or after it."""

    def want(context: click.Context, _: click.Parameter, value: bool) -> None:
        from mbsym_cli.console import Debugging

        Debugging.wanted = Debugging.wanted or value

    return click.Option(
        ["--debug"], is_flag=True, expose_value=False, callback=want, help="Show tracebacks of internal errors."
    )


@click.group(cls=LazyGroup, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(mbsym.__version__, prog_name="mbsym")
@click.option("--debug", is_flag=True, help="Show tracebacks of internal errors.")
def main(debug: bool) -> None:
    """Exact symbolic mechanics of multibody systems from a text description.

    \b
    Example:
      mbsym run systems/satellite.yaml
    """
    from mbsym_cli.console import Debugging

    Debugging.wanted = Debugging.wanted or debug
