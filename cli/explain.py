"""``mbsym explain``: what a problem does and the formula it uses; what may stand in a description."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from difflib import get_close_matches

import click

from mbsym.problems import NUMBERS, ranges
from mbsym.studies.study import Exit
from mbsym_cli.console import among, asked_width, wrapped

TOPICS = {
    "description": "the keys of a description",
    "loads": "the kinds of load and their keys",
    "constraints": "the kinds of constraint and their keys",
    "expressions": "what a formula may hold",
    "abbreviations": "the author's letters, in claims and in results",
    "plain text": "the labels of the description editor's text",
    "claims": "how printed formulas are checked, and the kinds of claim",
}


@click.command("explain")
@click.argument("topic", nargs=-1, shell_complete=among(lambda: [*map(str, NUMBERS), *TOPICS]))
def command(topic: tuple[str, ...]) -> None:
    """Print what problem TOPIC (a number) does and the formula it uses; without TOPIC, the list of problems and topics.

    The topics description, loads, constraints, expressions, abbreviations, plain text and claims tell what may stand
    in a description.  TOPIC may also be a command, a verdict, a theorem, a condition, a key, label or kind of a
    description.

    \b
    Examples:
      mbsym explain 5
      mbsym explain loads
      mbsym explain gyroscopically stabilised only
      mbsym explain Kelvin-Chetaev
      mbsym explain inertia about
    """
    from mbsym.analysis import PROBLEMS

    word = " ".join(topic).removeprefix("problem ")
    if not word:
        width = max(map(len, TOPICS))
        for problem in PROBLEMS.values():
            click.echo(f"{problem.number:<{width}}  {problem.title}")
        for name, meaning in TOPICS.items():
            click.echo(f"{name:<{width}}  {meaning}")
    elif texts := explanations(word) or explanations(_as_known(word)):
        click.echo("\n\n".join(map(_narrowed, texts)))
    else:
        near = _near(word)
        known = f"did you mean {' or '.join(near)}?" if near else f"problems are numbered {ranges()}"
        known += "" if near else f"; topics are {', '.join(TOPICS)}"
        kinds = "no problem, topic, command, verdict, theorem, condition, key, label or kind"
        click.echo(f"nothing is called {word}: {kinds}; {known}", err=True)
        sys.exit(Exit.BAD_INPUT)


def explanations(word: str) -> list[str]:
    """What there is to say of a problem, a topic, or whatever else is called so."""
    from mbsym.analysis import PROBLEMS
    from mbsym.source.topics import meanings

    if word in TOPICS:
        return [_topic(word)]
    problems = [problem for n, problem in PROBLEMS.items() if word in (str(n), problem.title)]
    if problems:
        return [problem.explanation for problem in problems]
    return [*_command(word), *_verdict(word), *_theorem(word), *_condition(word), *_term(word), *meanings(word)]


def _as_known(word: str) -> str:
    """The word as it is written, whatever its capitals, its number and its index; nothing where there is none."""
    bare = re.sub(r"[ _]\d+\b.*", "", word.casefold())  # minor 2 of K
    forms = (word.casefold(), word.casefold().removesuffix("s"), f"{word.casefold()}s", bare)
    return next((known for form in forms for known in known_words() if known.casefold() == form), "")


def _near(word: str) -> list[str]:
    """What is called so elsewhere; names that hold the word, or the one that resembles it."""
    from mbsym.source.keys import MEANT

    if (meant := MEANT.get(word.casefold())) is not None:
        return [meant]
    holding = [entry for entry in known_words() if word.casefold() in entry.casefold().replace("-", " ").split()]
    return holding[:3] or get_close_matches(word, known_words(), 1)


def known_words() -> list[str]:
    """Whatever can be explained, but for the numbers of problems."""
    from mbsym.problems.stability.words import CONDITIONS, THEOREMS, HigherOrder, Word
    from mbsym.source.topics import words
    from mbsym_cli.main import COMMANDS

    terms = [name for names in TERMS for name in names.split(", ")]
    theorems = [*(theorem.name for theorem in THEOREMS), *(order.value for order in HigherOrder if order)]
    return list(
        dict.fromkeys([*TOPICS, *COMMANDS, *(word.value for word in Word), *theorems, *CONDITIONS, *terms, *words()])
    )


def _command(word: str) -> Iterator[str]:
    """The help of a command."""
    from mbsym_cli.main import COMMANDS, main, whole_help

    if word in COMMANDS:
        context = click.Context(main, info_name="mbsym")
        subcommand = main.get_command(context, word)
        assert subcommand is not None
        yield whole_help(subcommand, context, word)


def _verdict(word: str) -> Iterator[str]:
    """What a verdict of problem 6 says."""
    from mbsym.problems.stability.words import MEANINGS

    yield from (f"A verdict of problem 6: {text}." for verdict, text in MEANINGS.items() if verdict.value == word)


def _theorem(word: str) -> Iterator[str]:
    """What a theorem needs and gives, each time it stands in the table of those of problem 6."""
    from mbsym.problems.stability.words import THEOREMS, Fact, Ground, HigherOrder, implied

    named = [theorem for theorem in THEOREMS if theorem.name.casefold() == word.casefold()]
    families = {Fact.LEFT_BUT_TURNED, Fact.LEFT_BUT_STEADY}
    for theorem in named:
        others = (other for other in named if other is not theorem and other.gives is theorem.gives)
        if not any(other.needs <= implied(theorem.needs) for other in others):  # else it is an instance
            needs = "".join(f"\n    {fact.value}" for fact in Fact if fact in theorem.needs)
            if theorem.name == "Routh":  # it is Lagrange-Dirichlet's theorem on what ignoring coordinates leaves
                needs += "\n    cyclic coordinates left out, their momenta kept"
            gives = "instability" if theorem.gives is None else "stability"
            if theorem.gives is Ground.DECAYS:
                gives = "asymptotic stability" + (", to a member of the family" if theorem.needs & families else "")
            yield f"{theorem.name}, problem 6: {gives}, where{needs}"
    if any(order and order.value.casefold() == word.casefold() for order in HigherOrder):
        yield "A theorem of problem 11: mbsym explain 11"


def _condition(word: str) -> Iterator[str]:
    """What a condition of problem 6 is called after."""
    from mbsym.problems.stability.words import CONDITIONS

    if word in CONDITIONS:
        yield f"A condition of problem 6: {CONDITIONS[word]}."


def _narrowed(text: str) -> str:
    """The text in the width that is asked for: paragraphs filled anew, formulas and lists line by line.

    A line goes on the one before if that is as wide as a paragraph's lines are, and both begin at the same place, or
    where the words of an item begin, behind its mark or its name.
    """
    width = asked_width()
    if width is None or max(map(len, text.split("\n"))) <= width:
        return text
    lines: list[str] = []
    wide = False
    for line in text.split("\n"):
        begins = len(line) - len(line.lstrip(" "))
        if (
            wide
            and line.strip()
            and begins == _margin(lines[-1])
            and not line.lstrip().startswith(("* ", "- ", ">>> "))
        ):
            lines[-1] += " " + line.lstrip(" ")
        else:
            lines.append(line)
        wide = len(line) > FULL
    return "\n".join(wrapped(line, width, _margin(line)) for line in lines)


#: Other words of reports, and of what commands print; "a, b" are two words for one thing.
TERMS = {
    "proved": "an identity of exact algebra, or a theorem all of whose hypotheses are shown",
    "verified numerically": "holds at random values, exactly or in enclosures of many digits: almost certain, no proof",
    "measured": "the difference from a better run",
    "estimated": "by a scaling, or by the equation of the difference",
    "undecided": "not known: for want of a theorem, of values of parameters, or of budget",
    "decided exactly": "with the values of the description as rational numbers; nothing is rounded",
    "rigorous enclosure, decided by rigorous enclosures": "in intervals that contain the exact numbers",
    "self-check": "every result is derived a second time, by another route, and compared; see 'mbsym run -v'",
    "degrees of freedom": "coordinates less independent constraints on velocities",
    "cyclic": "a coordinate that L = T + U does not contain; where no other force acts on it, its momentum is constant",
    "force function": "U, minus the potential energy: its derivatives are the forces",
    "generalised energy": "h = sum p q' - L, constant where time does not enter and no other forces act",
    "momentum": "of a coordinate q: p = dT/dq'",
    "lambda, multiplier, reaction": "lambda_k is the multiplier of row k of the constraints, which gives its reaction",
    "holonomic": "a constraint between positions, or one that follows from such",
    "first approximation, linearisation, linearization, linear model": (
        "the linear equations M q'' + (D + G) q' + (K + N) q = 0 about a motion: problem 5"
    ),
    "subsystem": "coordinates whose linear equations contain no others",
    "characteristic polynomial": "det(lambda^2 M + lambda (D + G) + K + N); its roots are the eigenvalues",
    "eigenvalue": "a root lambda of the characteristic polynomial: small motions grow or decay as e^(lambda t)",
    "constant term": "of the characteristic polynomial, det(K + N): a root passes through zero where it vanishes",
    "zero root": "an eigenvalue 0: an equilibrium that is not isolated, a cyclic coordinate, or a border of stability",
    "double root": "two equal eigenvalues: on the imaginary axis flutter may begin there",
    "divergence": "instability by a real positive eigenvalue: away without oscillation",
    "flutter": "instability by a pair of complex eigenvalues: oscillations that grow",
    "signature, degree of instability": "the number of negative eigenvalues of K (Poincare)",
    "gyroscopic forces": "G q' with G skew: they do no work",
    "circulatory forces": "N q with N skew: they have no potential",
    "complete dissipation": "D positive definite: every motion loses energy",
    "Jordan block": "of a multiple root with fewer eigenvectors: solutions have a factor t",
    "relative equilibrium": "constant coordinates, while what is prescribed, and turns steadily, goes on",
    "fold": "over a parameter two equilibria meet, and beyond it there are none",
    "pitchfork": "over a parameter one equilibrium becomes three, or three become one",
    "transcritical, transcritical point": "two branches of equilibria cross",
    "vertical tangent": "a branch of equilibria is steep there, and goes on",
    "isolated point": "one equilibrium at this value of the parameter, and none near it",
    "controllability": "whether the inputs can lead every state to zero (Kalman): problem 8",
    "feedback, control, LQR": "inputs as a linear function of the state: problem 8 ('mbsym run --problems 8')",
    "state space": "x' = A x + B v, y = C x + D v of problem 5: 'state_space' in results.json",
    "inverse dynamics": "the inputs that a motion needs: 'mbsym inverse', and a function in model.c, model.py",
    "friction": "viscous: the load damper, or rayleigh; dry: sign(q') in a generalized force, which a simulation knows",
    "gyrostat, rotor": "a body with a gyrostatic moment, the constant angular momentum of rotors inside it",
    "chaos": "neighbouring motions part exponentially: 'mbsym lyapunov' measures how fast",
    "Lyapunov function": "positive about a motion, and never growing along those near it",
    "base parameters": "the smallest set of sums of inertial parameters that determines all forces: 'mbsym regressor'",
    "member": "one motion of an ensemble ('mbsym simulate --vary')",
    "tolerance": "the error that a method with a variable step allows in each step, relative to the size of the state",
}


def _term(word: str) -> Iterator[str]:
    """Another word of reports."""
    yield from (f"{names}: {meaning}." for names, meaning in TERMS.items() if word in names.split(", "))


#: Lines of paragraphs are longer than this, the last ones apart.
FULL = 95


def _margin(line: str) -> int:
    """Where the words of a line begin: behind the mark of an item, or behind the name and the gap of a table's row."""
    item = re.match(r" *[*-] | {4}\w\S*(?: \S+){,3}  +(?=\S)| *", line)
    assert item is not None
    return item.end()


def _topic(name: str) -> str:
    from mbsym.source import topics

    if name == "claims":
        from mbsym.problems import claims

        return f"{str(claims.__doc__).strip()}\n\n{topics.claim_kinds()}"
    text: str = getattr(topics, name.replace(" ", "_"))()
    return text
