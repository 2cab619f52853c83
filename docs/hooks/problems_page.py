"""What ``mbsym explain`` tells of problems, for the page on them, and of verdicts, for that on theory."""

from __future__ import annotations

from in_markdown import escaped, fenced, table

from mbsym.analysis import PROBLEMS
from mbsym.problems.stability.words import MEANINGS, Word


def tail() -> str:
    """Of each problem what its module begins with, in Markdown."""
    parts = ["## What each does\n\nAs `mbsym explain N` prints it.\n"]
    parts += [
        f"### {problem.number}. {problem.title}\n\n{fenced(problem.explanation)}" for problem in PROBLEMS.values()
    ]
    return "\n".join(parts)


def verdicts() -> str:
    """The words of verdicts and their meanings, a table in Markdown."""
    return table(("word", "what it says"), [(word.value, escaped(MEANINGS[word])) for word in Word])
