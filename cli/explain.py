"""``mbsym explain``: what a problem does and the formula it uses; what may stand in a description."""

from __future__ import annotations

import sys
from difflib import get_close_matches

import click

from mbsym.problems import NUMBERS, ranges
from mbsym_cli.completion import among
from mbsym_cli.console import BAD_INPUT, asked_width, wrapped

TOPICS = {
    "description": "the keys of a description",
    "loads": "the kinds of load and their keys",
    "constraints": "the kinds of constraint and their keys",
    "expressions": "what a formula may hold",
    "abbreviations": "the author's letters, in claims and in results",
    "claims": "how printed formulas are checked, and the kinds of claim",
}


@click.command("explain")
@click.argument("topic", required=False, shell_complete=among(lambda: [*map(str, NUMBERS), *TOPICS]))
def command(topic: str | None) -> None:
    """Print what problem TOPIC (a number) does and the formula it uses; without TOPIC, the list of problems and topics.

    The topics description, loads, constraints, expressions, abbreviations and claims tell what may stand in a
    description.

    \b
    Examples:
      mbsym explain 5
      mbsym explain loads
    """
    from mbsym.analysis import PROBLEMS

    if topic is None:
        width = max(map(len, TOPICS))
        for problem in PROBLEMS.values():
            click.echo(f"{problem.number:<{width}}  {problem.title}")
        for name, meaning in TOPICS.items():
            click.echo(f"{name:<{width}}  {meaning}")
    elif topic in TOPICS:
        click.echo(_narrowed(_topic(topic)))
    elif topic.isdigit() and int(topic) in PROBLEMS:
        click.echo(_narrowed(PROBLEMS[int(topic)].explanation))
    else:
        near = get_close_matches(topic, TOPICS, 1)
        known = f"did you mean {near[0]}?" if near else f"problems are numbered {ranges()}"
        known += "" if near else f"; topics are {', '.join(TOPICS)}"
        click.echo(f"there is no problem or topic {topic}; {known}", err=True)
        sys.exit(BAD_INPUT)


def _narrowed(text: str) -> str:
    """The text in the width that is asked for: paragraphs filled anew, formulas and lists line by line.

    A line goes on the one before if that is as wide as a paragraph's lines are, and both begin at the same place, or
    behind the mark of an item.
    """
    width = asked_width()
    if width is None or max(map(len, text.split("\n"))) <= width:
        return text
    lines: list[str] = []
    wide = False
    for line in text.split("\n"):
        begins = len(line) - len(line.lstrip(" "))
        if wide and line.strip() and begins == _margin(lines[-1]) and not line.lstrip().startswith(("* ", ">>> ")):
            lines[-1] += " " + line.lstrip(" ")
        else:
            lines.append(line)
        wide = len(line) > FULL
    return "\n".join(wrapped(line, width, _margin(line)) for line in lines)


#: Lines of paragraphs are longer than this, the last ones apart.
FULL = 95


def _margin(line: str) -> int:
    """Where the text of a line begins, behind the mark of an item."""
    bare = line.lstrip(" ")
    return len(line) - len(bare) + (2 if bare.startswith("* ") else 0)


def _topic(name: str) -> str:
    from mbsym.source import topics

    if name == "claims":
        from mbsym.problems import claims

        return f"{str(claims.__doc__).strip()}\n\n{topics.claim_kinds()}"
    found: str = getattr(topics, name)()
    return found
