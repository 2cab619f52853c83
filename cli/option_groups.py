"""Options of a command in groups: each group comes to the command as one value."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar

Command = TypeVar("Command", bound=Callable[..., Any])


def group(argument: str, build: Callable[..., object], *options: Callable[[Any], Any]) -> Callable[[Command], Command]:
    """A decorator that adds ``options`` and hands their values over as ``argument=build(**values)``."""

    def probe() -> None:
        """Tells what click calls the values."""

    for option in options:
        option(probe)
    names = [parameter.name for parameter in probe.__click_params__]  # type: ignore[attr-defined]

    def decorate(command: Command) -> Command:
        @wraps(command)
        def called(*positional: Any, **values: Any) -> Any:
            own = {name: values.pop(name) for name in names}
            return command(*positional, **{argument: build(**own)}, **values)

        decorated: Any = called
        for option in reversed(options):
            decorated = option(decorated)
        return decorated

    return decorate
