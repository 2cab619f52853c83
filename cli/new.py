"""``mbsym new``: a commented description that runs.

No study: there is no description yet.
"""

from __future__ import annotations

import shlex
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mbsym.expressions.message import Message
from mbsym.model.system import LANGUAGES, ONE_OF_LANGUAGES
from mbsym.report.language import Language
from mbsym.source.examples import example_names
from mbsym.studies.study import Exit
from mbsym_cli.console import among, complain, printable
from mbsym_cli.options import Options

if TYPE_CHECKING:
    from mbsym.source.starter import NewBody


@click.command("new")
@click.argument("name")
@click.option(
    "--like",
    metavar="EXAMPLE",
    shell_complete=among(example_names),
    help="Begin with one of the shipped systems instead of questions.",
)
@click.option("--language", metavar="NAME", help=f"Of its reports, and of the questions: {ONE_OF_LANGUAGES}.")
def command(name: str, like: str | None, language: str | None) -> None:
    """Write NAME.yaml, a commented description that runs as it is.

    Asks for the bodies and their joints; with --like, or where nobody can answer, it takes a shipped system
    (that of this name, if there is one).  A file
    that is there already is not replaced without --force.

    \b
    Examples:
      mbsym new crane
      mbsym new my-pendulum --like pendulum
    """
    from mbsym.source.examples import example_in, example_like
    from mbsym_cli.files import write_whole

    options = Options()
    tongue = "" if language is None else options.word("--language", language, tuple(LANGUAGES), "language") or ""
    say = options.say = Language(tongue).say
    path = Path(name if name.endswith((".yaml", ".yml")) else f"{name}.yaml")
    if not path.stem.strip() or path.is_dir():
        options.complain("NAME", "bad-name", Message("no file can be called [[name]]", name=printable(name)))
    else:
        options.unwritten("NAME", path)
    if like is None and not _answers():
        like = example_in(path.stem)
    example = None if like is None else example_like(like)
    if like is not None and example is None:
        options.word("--like", like, example_names(), "example")
    if options.refused():
        sys.exit(Exit.BAD_INPUT)
    title = path.stem.replace("-", " ").replace("_", " ").capitalize()
    text = _interview(title, say) if example is None else _renamed(example, title)
    text = in_language(text, tongue)
    try:
        write_whole(path, text)
    except OSError as error:
        complain(path, Message("cannot be written: [[why]]", why=error.strerror), say)
        sys.exit(Exit.FAILED)
    shown = printable(path)
    quoted = shlex.quote(shown)
    begun = Message("[[file]], begun with the example [[name]]", file=shown, name=example)
    click.echo(shown if example is None else say(begun))
    next_steps = (
        ("run", Message("derives it")),
        ("watch", Message("derives it whenever you save")),
        ("edit", Message("draws it in the browser")),
    )
    for name, what in next_steps:
        click.echo(f"  mbsym {name} {quoted}{' ' * (5 - len(name))}  {say(what)}")


def _answers() -> bool:
    """Whether somebody sits at the terminal."""
    return sys.stdin is not None and sys.stdin.isatty()


def _renamed(example: str, title: str) -> str:
    """The description of a shipped system under a new name, with its comments."""
    from mbsym.source.examples import example_text
    from mbsym.source.yaml_writer import scalar_text

    lines = example_text(example).split("\n")
    index = next(k for k, line in enumerate(lines) if line.startswith("name:"))
    lines[index] = f"name: {scalar_text(title)}"
    return "\n".join([f"# Begun with the example {example} of mbsym.", *lines])


def in_language(text: str, language: str) -> str:
    """A description whose reports are in that language, which stands behind its name; as it is for none."""
    others = [line for line in text.split("\n") if not (language and line.startswith("language:"))]
    index = next(k for k, line in enumerate(others) if line.startswith("name:")) + 1
    return "\n".join([*others[:index], *([f"language: {language}"] if language else []), *others[index:]])


def _interview(title: str, say: Callable[[str], str]) -> str:
    """A description from the answers to a few questions."""
    from mbsym.source.starter import JOINTS, starter

    title = click.prompt(say(Message("What is the system called")), default=title)
    count = click.prompt(say(Message("How many bodies")), type=click.IntRange(1, 20), default=1)
    click.echo(say(Message("Joints:")))
    for joint, (_, _, description) in JOINTS.items():
        click.echo(f"    {joint:<7} {say(description)}")
    bodies: list[NewBody] = []
    for number in range(1, count + 1):
        bodies.append(_body(number, bodies, say))
    return starter(title, bodies, click.confirm(say(Message("Does gravity act")), default=True))


def _body(number: int, earlier: list[NewBody], say: Callable[[str], str]) -> NewBody:
    from mbsym.source.starter import JOINTS, NewBody

    known = {body.name for body in earlier}
    while True:
        name = click.prompt(say(Message("Body [[number]]: its name", number=number)), default=f"body {number}")
        reason = _why_no_body(name, known)
        if reason is None:
            break
        click.echo(f"  {say(reason)}", err=True)
    carrier = None
    if earlier:
        choice = click.Choice(["0", *(body.name for body in earlier)])
        answer = click.prompt(f"  {say(Message('attached to (0: the ground)'))}", type=choice, default=earlier[-1].name)
        carrier = None if answer == "0" else answer
    by = f"  {say(Message('by a joint'))}"
    return NewBody(name, carrier, click.prompt(by, type=click.Choice(list(JOINTS)), default="hinge"))


def _why_no_body(name: str, known: set[str]) -> str | None:
    from mbsym.source.bodies import is_body_name

    if name in known:
        return Message("another body is called so")
    form = Message("letters, digits, blanks and . / _ -, beginning with a letter")
    return None if is_body_name(name) else form
