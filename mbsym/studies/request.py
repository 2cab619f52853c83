"""What the fields of a request are: kinds that stand in the annotations of a dataclass.

    time: Annotated[float, Number("T", "Over so long (1000, 200*pi).", short="-t")]

A kind knows how its option is called and what values it takes.  The command line reads texts (``mbsym_cli.requests``),
Python passes values (``wrong``); both have the same bounds.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields
from fractions import Fraction
from math import isfinite
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias, get_args, get_type_hints

from mbsym.expressions.message import Message
from mbsym.model.system import LANGUAGES, ONE_OF_LANGUAGES
from mbsym.problems import NUMBERS, ranges

if TYPE_CHECKING:
    from mbsym.expressions.place import Complaints
    from mbsym.expressions.tree import Expression
    from mbsym.model.system import System
    from mbsym.numerics.ensembles.variation import Variation

#: Errors that can be asked for: nothing here is finer, and nothing coarser says anything about a motion.
LEAST_ERROR, MOST_ERROR = 1e-17, 0.5

#: What Python takes for a parameter, an initial position or an initial velocity: ``Fraction(1, 3)``, ``0.5``,
#: ``"pi/6"``.
Value: TypeAlias = Fraction | float | str


@dataclass(frozen=True)
class Kind:
    """``metavar`` stands for the value in the help of the option, which is called as its field unless it has a name.

    ``usual``: what is taken where the option is left out, in words; without it the default of the field is shown.
    """

    metavar: str | None
    help: str
    short: str = ""
    name: str = ""
    usual: str = ""


@dataclass(frozen=True)
class Number(Kind):
    """A positive number between bounds; ``absent``: what is said, with a hint, where one that has no default is not
    given; ``alone``: what the option means without a number.
    """

    least: float = 0.0
    most: float | None = None
    absent: tuple[str, str] = ("", "")
    alone: str = ""

    def wrong(self, name: str, value: float) -> str:
        if not (isfinite(value) and value > 0):
            return f"{name} must be positive, not {value}"
        if value < self.least or (self.most is not None and value > self.most):
            return f"{name} must be between {self.least:g} and {self.most:g}, not {value}"
        return ""


@dataclass(frozen=True)
class Whole(Kind):
    """A whole number between bounds; ``why`` the lower one, ``shown``: whether the help tells the default."""

    least: int = 1
    most: int = 10**6
    why: str = ""
    shown: bool = True

    def wrong(self, name: str, value: int) -> str:
        if self.least <= value <= self.most:
            return ""
        bound = f"{self.least} at least" if value < self.least else f"{self.most} at most"
        return f"{name} must be {bound}, not {value}"


@dataclass(frozen=True)
class Chosen(Kind):
    """One word or several of a few; ``what`` they are.

    ``choices`` are a function where much would have to be imported to know them.
    """

    choices: tuple[str, ...] | Callable[[], tuple[str, ...]] = ()
    what: str = "choice"

    @property
    def known(self) -> tuple[str, ...]:
        return self.choices() if callable(self.choices) else self.choices

    def _unknown(self, words: Sequence[str]) -> str:
        return f"there is no {self.what} {', '.join(words)}: choose from {', '.join(self.known)}" if words else ""


@dataclass(frozen=True)
class Word(Chosen):
    """One of a few words, small or capital."""

    def wrong(self, name: str, value: str) -> str:
        return self._unknown([value] if value not in self.known else [])


@dataclass(frozen=True)
class Tongue(Word):
    """The language in which everything is said, where it is not that of the description."""


@dataclass(frozen=True)
class Words(Chosen):
    """Some of a few words, separated by commas; ``every`` stands for all of them, or for ``all_of``."""

    every: str = ""
    all_of: tuple[str, ...] = ()

    def wrong(self, name: str, value: Sequence[str]) -> str:
        return self._unknown([word for word in value if word not in (*self.known, self.every)])


@dataclass(frozen=True)
class Text(Kind):
    """Whatever it says; the study looks at it."""


@dataclass(frozen=True)
class Names(Kind):
    """Names, or other texts, one each time the option is given, ``separated`` by commas, or ``positional``; the study
    looks at them.

    ``known`` are those that a system has of ``what``, where the study does not say more of them.
    """

    separated: bool = False
    positional: bool = False
    known: Callable[[System], Sequence[str]] | None = None
    what: str = ""


@dataclass(frozen=True)
class Flag(Kind):
    """Said or not; ``both``: ``--name`` or ``--no-name``."""

    both: bool = False


@dataclass(frozen=True)
class Named(Kind):
    """``NAME=N``, whole numbers of names between bounds; repeatable."""

    least: int = 1
    most: int = 10**6
    example: str = ""

    def wrong(self, name: str, value: Mapping[str, int]) -> str:
        outside = ", ".join(key for key, number in value.items() if not self.least <= number <= self.most)
        return f"{name} must be from {self.least} to {self.most} for {outside}" if outside else ""


@dataclass(frozen=True)
class Settings(Kind):
    """Values by name that replace those of the description: of parameters, initial positions and velocities.

    ``state``: whether an initial state is needed, ``declared``: whether it may be one that declared variables alone
    tell, and ``whole``: whether values are needed, by the texts of the options; ``laws``: the field with those of the
    inputs.
    """

    state: bool = True
    declared: Callable[[Mapping[str, Any]], bool] = lambda texts: False
    laws: str = ""
    whole: Callable[[Mapping[str, Any]], bool] = lambda texts: True


@dataclass(frozen=True)
class Substitutions(Kind):
    """``NAME=VALUE``, values of parameters that are put into the description before anything else is read."""


@dataclass(frozen=True)
class Scale(Kind):
    """``NAME=EXPRESSION,...``: dimensionless variables that the description is put in before anything else is read."""


@dataclass(frozen=True)
class Problems(Kind):
    """Numbered problems, ``1-5`` or ``1,3,6``."""

    def wrong(self, name: str, value: Sequence[int]) -> str:
        unknown = ", ".join(str(number) for number in value if number not in NUMBERS)
        return f"there is no problem {unknown}: problems are numbered {ranges()}" if unknown else ""


@dataclass(frozen=True)
class Parsed(Kind):
    """A text that is read with complaints about places in it."""

    read: Callable[[str, System, Complaints], Any] = lambda text, system, complaints: None


@dataclass(frozen=True)
class Formulas(Kind):
    """``NAME=FORMULA``, of coordinates, smooth in t, the parameters and prescribed motions; repeatable.

    ``laws``: of inputs, in coordinates and velocities, too.
    """

    laws: bool = False


@dataclass(frozen=True)
class Assignments(Kind):
    """Expressions in parameters by name, each as it is written; one that cannot be read is None."""


@dataclass(frozen=True)
class Errors(Kind):
    """``1e-6``, ``theta=1e-6,energy=1e-9``, or both: tolerable errors of all quantities, and of those in ``names``."""

    names: Callable[[System, Mapping[str, Any]], Sequence[str]] = lambda system, texts: ()
    least: float = 0.0
    most: float = 1.0


@dataclass(frozen=True)
class Place(Kind):
    """A file to be read."""


@dataclass(frozen=True)
class ExactSettings(Kind):
    """Rational numbers that are put in for parameters and symbols of the notation, and for ``more`` of a system."""

    more: Callable[[System], Sequence[str]] = lambda system: ()


@dataclass(frozen=True)
class Range(Kind):
    """``NAME=LOW:HIGH``, an interval of a parameter or symbol (``mbsym.maps.axis.Axis``)."""


@dataclass(frozen=True)
class Varied:
    """What varies, and between which numbers each name lies, exact ones where these are asked for."""

    variation: Variation
    ends: tuple[Any, Any]


@dataclass(frozen=True)
class Ranges(Kind):
    """``NAME=0:1:1000``, ``NAME=1 +- 5%``, ``NAME=uniform(0, 1)``, ``NAME=normal(1, 0.05)``; ``most`` of them.

    ``exact``: ends are rational; else they are made of numbers, pi and parameters.
    """

    most: int = 64
    exact: bool = False


@dataclass(frozen=True)
class Quantity:
    """A word, or a formula with what it is of in front."""

    text: str
    formula: Expression | None = None


@dataclass(frozen=True)
class Formula(Kind):
    """A ``Quantity``: one of the ``words``, or a formula in ``names(system, text)``, behind the ``prefix`` or not."""

    words: tuple[str, ...] = ()
    prefix: str = ""
    names: Callable[[System, str], Sequence[str]] = lambda system, text: system.parameter_names


@dataclass(frozen=True)
class Share(Kind):
    """``I/N``: the I-th of N parts."""


#: ``--set`` of studies of one motion, and of exact ones.
Values = Annotated[Mapping[str, Value], Settings("NAME=VALUE", "Replace a value; repeatable.", "-s", "--set")]
Stateless = Annotated[
    Mapping[str, Value], Settings("NAME=VALUE", "Replace a value; repeatable.", "-s", "--set", state=False)
]
Numbers = Annotated[Mapping[str, Fraction], ExactSettings("NAME=VALUE", "Put in a number; repeatable.", "-s", "--set")]
Anew = Annotated[bool, Flag(None, "Measure again what an earlier command has measured.")]

#: The same as signatures show them.
PLAIN = {"Values": "Mapping[str, Fraction | float | str]", "Numbers": "Mapping[str, Fraction]", "Anew": "bool"}


#: The complaint where ``--time`` is needed, and its hint.
HOW_LONG = ("how long to simulate is not said", Message("for example [[example]]", example="--time 60"))


def duration(help: str, usual: str = "") -> Number:
    """``--time``, without which nothing can be simulated."""
    return Number("T", help, "-t", usual=usual, absent=HOW_LONG)


def formats(help: str, choices: tuple[str, ...], usual: str = "") -> Words:
    """``--format``: which files."""
    return Words("LIST", help, "-f", usual=usual, choices=choices, what="format")


def language(what: str, usual: str = "", kind: type[Word] = Word) -> Word:
    """``--language`` of ``what``."""
    return kind("LANGUAGE", f"{what}: {ONE_OF_LANGUAGES}.", usual=usual, choices=tuple(LANGUAGES), what="language")


@dataclass(frozen=True)
class Field:
    """A field of a request: its ``name`` there, its ``kind``, the value it has if it is left out."""

    name: str
    kind: Kind
    default: Any
    required: bool

    @property
    def option(self) -> str:
        return self.kind.name or f"--{self.name.replace('_', '-')}"


def fields_of(request: type) -> tuple[Field, ...]:
    """The fields that have a kind, in their order."""
    hints = get_type_hints(request, include_extras=True)
    request_fields = []
    for field in fields(request):
        kind = next((item for item in get_args(hints[field.name]) if isinstance(item, Kind)), None)
        if kind is not None:
            made = field.default_factory() if field.default_factory is not MISSING else field.default
            required = made is MISSING
            request_fields.append(Field(field.name, kind, None if required else made, required))
    return tuple(request_fields)


def options_typed(request: type, typed: Mapping[str, Any]) -> frozenset[str]:
    """The options with these texts, and ``--option text`` of those that have one."""
    names = {field.name: field.option for field in fields_of(request)}
    options = set()
    for name, text in typed.items():
        option = names.get(name, f"--{name.removeprefix('as_')}")
        options.add(f"--no-{option.removeprefix('--')}" if text is False else option)
        options |= {f"{option} {text.lower()}"} if isinstance(text, str) else set()
    return frozenset(options)


def words_typed(request: type, typed: Mapping[str, Any]) -> tuple[str, ...]:
    """The words of a command line that give these texts again."""
    names = {field.name: field.option for field in fields_of(request)}
    words: list[str] = []
    for name, text in typed.items():
        option = names.get(name, f"--{name}")
        if isinstance(text, bool):
            words.append(option if text else f"--no-{option.removeprefix('--')}")
        else:
            words += [word for value in (text if isinstance(text, tuple) else (text,)) for word in (option, str(value))]
    return tuple(words)


def wrong(request: Any) -> Iterator[str]:
    """What of a request is out of its bounds, a sentence each."""
    for field in fields_of(type(request)):
        value, check = getattr(request, field.name), getattr(field.kind, "wrong", None)
        if value is not None and check is not None and (said := check(field.name, value)):
            yield said
