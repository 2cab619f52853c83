"""From a description to what Python's functions work with, and those functions made from requests."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from functools import wraps
from inspect import Parameter, signature
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, ParamSpec, Protocol, TypeAlias, TypeVar, cast, overload

from mbsym.studies.request import PLAIN, Settings, fields_of, wrong
from mbsym.studies.study import Asked, Watch, unwatched

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.expressions.place import Complaints
    from mbsym.expressions.tree import Expression
    from mbsym.model.system import System

P = ParamSpec("P")
R = TypeVar("R")
T = TypeVar("T")

#: A file, or what ``load`` returned.
Source: TypeAlias = "str | Path | Analysis"


class DescriptionError(ValueError):
    """A description with complaints; the message holds all of them, each with file, line and column."""


DescriptionError.__module__ = "mbsym"


def load(path: str | Path, problems: Iterable[int] | None = None) -> Analysis:
    """The analysis of a description file, of all its problems unless some are named.

    Raises DescriptionError with every complaint, OSError never.
    """
    from mbsym.source import load as read_file

    system, complaints, text = read_file(Path(path))
    return _analysis(system, complaints, text, str(path), problems)


def loads(text: str, problems: Iterable[int] | None = None) -> Analysis:
    """The analysis of a description given as text."""
    from mbsym.source import read

    system, complaints = read(text)
    return _analysis(system, complaints, text, "<string>", problems)


def analysis_of(source: Source) -> Analysis:
    return load(source, ()) if isinstance(source, (str, Path)) else source


def moving_system(source: Source) -> System:
    """The system; its inputs, where it has any, at the values of the unperturbed motion.

    Its free functions of time are their laws.  Raises NoLaw where one has none, GivenByMatrices where there are no
    bodies that could move.
    """
    from mbsym.analysis.given import refuse_matrices
    from mbsym.mechanics.variables import settled
    from mbsym.model.substitution import held

    system = settled(analysis_of(source).system)
    refuse_matrices(system, "no motion is integrated or searched for")
    return held(system)


def laws_of(system: System, inputs: Mapping[str, Fraction | float | str] | None) -> dict[str, Expression]:
    """The law of each input that is given one."""
    if not inputs:
        return {}
    from mbsym.source.laws import read_laws

    return read_laws(system, inputs)


def _analysis(
    system: System | None, complaints: Complaints, text: str, name: str, problems: Iterable[int] | None
) -> Analysis:
    from mbsym.source import render
    from mbsym.studies.notebook import Analysis

    if system is not None and (system.constraints or system.linear):
        from mbsym.analysis.soundness import complain as complain_of

        complain_of(system, complaints)
    if system is None or complaints.errors:
        raise DescriptionError("\n".join(render(item, text, name) for item in complaints.sorted()))
    return Analysis(system, problems)


class Public(Protocol, Generic[P, R, T]):
    """Takes a source and a request, or a source and the fields of one; ``derive`` is what commands call."""

    derive: Callable[[Asked, R, Watch], T]

    @overload
    def __call__(self, source: Source, request: R, /) -> T: ...
    @overload
    def __call__(self, source: Source, *arguments: P.args, **named: P.kwargs) -> T: ...


def public(
    request: Callable[P, R], context_of: Callable[[Any, Any], Asked] | None = None
) -> Callable[[Callable[[Asked, R, Watch], T]], Public[P, R, T]]:
    """A decorator: what derives becomes a function of a source and a request, or its fields.

    ``asked(source, request)`` is what it is about (``asked_of``).  It raises ValueError for a request that is out of
    its bounds.
    """

    def decorate(derive: Callable[[Asked, R, Watch], T]) -> Public[P, R, T]:
        @wraps(derive)
        def called(source: Any, *arguments: Any, **named: Any) -> T:
            ready = len(arguments) == 1 and not named and isinstance(arguments[0], request)  # type: ignore[arg-type]
            instance: Any = arguments[0] if ready else request(*arguments, **named)
            said = list(wrong(instance))
            if said:
                raise ValueError("; ".join(said))
            return derive((context_of or asked_of)(source, instance), instance, unwatched)

        taken = (
            parameter.replace(annotation=_plain(str(parameter.annotation)), default=_shown(parameter.default))
            for parameter in signature(request).parameters.values()
        )
        own = Parameter("source", Parameter.POSITIONAL_OR_KEYWORD, annotation="str | Path | Analysis")
        shown = signature(derive).replace(parameters=[own, *taken])
        made: Any = called
        made.__signature__, made.derive = shown, derive
        return cast("Public[P, R, T]", made)

    return decorate


def asked_of(source: Source, request: Any) -> Asked:
    """The system with its inputs held; the motion, too, where the request has values of one."""
    system = moving_system(source)
    settings = [field.kind for field in fields_of(type(request)) if isinstance(field.kind, Settings)]
    if not settings:
        return Asked(system)
    from mbsym.numerics.scenario import scenario
    from mbsym.simulation.request import read_values

    kind = settings[0]
    return Asked(
        system, scenario(system, read_values(system, request.values or {}), kind.state, declared=kind.declared({}))
    )


def _shown(default: Any) -> Any:
    return {} if type(default).__name__ == "_HAS_DEFAULT_FACTORY_CLASS" else default


def _plain(annotation: str) -> str:
    """What stands in ``Annotated[..., kind]``, as it is written."""
    if annotation in PLAIN:
        return PLAIN[annotation]
    inside = annotation.removeprefix("Annotated[")
    depth = 0
    for place, sign in enumerate(inside if inside != annotation else ""):
        depth += (sign in "[(") - (sign in "])")
        if sign == "," and depth == 0:
            return inside[:place].strip()
    return annotation
