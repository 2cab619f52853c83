"""A command line that cannot be read: what is wrong with it, in the language of the descriptions on it."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import IO, Any

import click
from click.exceptions import BadOptionUsage, MissingParameter, NoSuchOption

from mbsym.expressions.message import Message


class Misused(click.UsageError):
    """The error of click with its words as messages, which ``say`` says."""

    def __init__(self, error: click.UsageError, say: Callable[[str], str]) -> None:
        super().__init__(_words(error), error.ctx)
        self.say = say

    def show(self, file: IO[Any] | None = None) -> None:
        lines = [self.say(Message("Error: [[message]]", message=self.message))]
        if self.ctx is not None:
            context, command = self.ctx, self.ctx.command
            formatter = context.make_formatter()
            pieces = " ".join(command.collect_usage_pieces(context))
            formatter.write_usage(context.command_path, pieces, self.say("Usage:") + " ")
            hint = Message("Try '[[command]]' for help.", command=f"{context.command_path} --help")
            lines = [formatter.getvalue() + self.say(hint), "", *lines]
        click.echo("\n".join(lines), file, err=True)


def _words(error: click.UsageError) -> str:
    """What is wrong, by the kind of the error."""
    match error:
        case NoSuchOption(option_name=option, possibilities=near):
            if near:
                return Message("there is no option [[option]]; did you mean [[near]]?", option=option, near=near[0])
            return Message("there is no option [[option]]", option=option)
        case BadOptionUsage(option_name=option):
            needed = "requires" in error.message
            return Message("[[option]] needs a value" if needed else "[[option]] takes no value", option=option)
        case MissingParameter(param=click.Parameter() as missing):
            return Message("[[name]] is missing", name=_name(missing, error))
        case click.BadParameter(param=click.Parameter(type=click.Choice(choices=words)) as chosen):
            return Message("[[name]] is one of [[words]]", name=_name(chosen, error), words=", ".join(words))
        case click.BadParameter(param=click.Parameter() as wrong):
            return Message("[[name]]: [[message]]", name=_name(wrong, error), message=error.message)
    if extra := re.search(r"extra arguments? \((.+)\)", error.message):
        return _superfluous(extra[1], error)
    return error.message


def _name(parameter: click.Parameter, error: click.UsageError) -> str:
    """An option, or the word that stands for an argument in the usage."""
    if isinstance(parameter, click.Option) or error.ctx is None:
        return max(parameter.opts, key=len)
    return parameter.make_metavar(error.ctx)


def _superfluous(words: str, error: click.UsageError) -> Message:
    """With the option by which the first word would be understood, where that is anybody's guess."""
    word = words.split()[0]
    options = {name for x in (error.ctx.command.params if error.ctx is not None else ()) for name in x.opts}
    fitting = {
        f"--set {word}": "=" in word,
        f"--time {word}": re.fullmatch(r"[\d.]+(e\d+)?", word) is not None,
        f"--x {word}=0:1": word.isidentifier(),
        f"--out {word}": True,
    }
    meant = next((text for text, fits in fitting.items() if fits and text.split()[0] in options), "")
    if not meant:
        return Message("unexpected: [[words]]", words=words)
    return Message("unexpected: [[words]]; did you mean '[[meant]]'?", words=words, meant=meant)
