"""The options of a study's command, made from its request, and the request read from their texts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mbsym.expressions.message import Message
from mbsym.expressions.parser import ascii_safe
from mbsym.studies.request import (
    Assignments,
    ExactSettings,
    Field,
    Flag,
    Formula,
    Formulas,
    Named,
    Names,
    Number,
    Place,
    Quantity,
    Range,
    Ranges,
    Settings,
    Share,
    Whole,
    Word,
    Words,
    fields_of,
)
from mbsym_cli.options import Options

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.numerics.scenario import Scenario


def option_of(field: Field) -> click.Option:
    """The option of one field; its value is text, which is read with all the others."""
    kind = field.kind
    names = [name for name in (field.option, kind.short) if name]
    needed = field.required and isinstance(kind, Number)
    beside = f"  [{f'default: {kind.usual}' if kind.usual else 'required'}]" if kind.usual or needed else ""
    told = kind.help + beside or None
    if isinstance(kind, Flag):
        if kind.both:
            words = f"{field.option}/--no-{field.option.removeprefix('--')}"
            shown = field.default is not None
            return click.Option([words, field.name], default=field.default, show_default=shown, help=told)
        return click.Option([*names, field.name], is_flag=True, help=told)
    if isinstance(kind, Place):
        return click.Option([*names, field.name], metavar=kind.metavar, type=click.Path(path_type=Path), help=told)
    repeated = isinstance(kind, (Settings, ExactSettings, Assignments, Named, Names, Formulas, Ranges))
    usual = None if repeated or field.default in (None, ()) else _text(field.default)
    return click.Option(
        [*names, field.name], metavar=kind.metavar, multiple=repeated, default=usual,
        show_default=usual is not None and not kind.usual and getattr(kind, "shown", True), help=told,
    )  # fmt: skip


def read_some(request: type, names: Sequence[str], texts: Mapping[str, Any], options: Options) -> dict[str, Any]:
    """The values of some fields that do not ask for a system."""
    by_name = {field.name: field for field in fields_of(request)}
    return {name: _read(by_name[name], texts[name], None, options) for name in names}


def _text(default: Any) -> str:
    if isinstance(default, tuple):
        return ",".join(default)
    if isinstance(default, Quantity):
        return default.text
    return f"{default:g}".replace("e-0", "e-") if isinstance(default, float) else str(default)


def read_fields(
    file: Path, system: System | None, request: type, texts: Mapping[str, Any], options: Options
) -> tuple[dict[str, Any], Scenario | None]:
    """The values of all fields, None for what cannot be read, which joins the complaints; the motion, if it is one."""
    values: dict[str, Any] = {}
    given: Scenario | None = None
    for field in sorted(fields_of(request), key=lambda one: not isinstance(one.kind, Settings)):
        if isinstance(field.kind, Settings):
            given, values[field.name] = _motion(file, system, texts[field.name], field.kind, texts, options)
        else:
            values[field.name] = _read(field, texts[field.name], system, options, given)
    return values, given


def _motion(
    file: Path,
    system: System | None,
    settings: tuple[str, ...],
    kind: Settings,
    texts: Mapping[str, Any],
    options: Options,
) -> tuple[Scenario | None, Mapping[str, Any]]:
    if system is None:
        return None, {}
    from mbsym_cli.assignments import given_numbers, sound_numbers

    if not kind.whole(texts):
        return None, sound_numbers(file, system, settings, options)
    return given_numbers(file, system, settings, options, declared=kind.declared, state=kind.state)


def _read(field: Field, given: Any, system: System | None, options: Options, motion: Scenario | None = None) -> Any:
    match field.kind:
        case Number() as kind:
            if given is None and field.required:
                options.complain(field.option, "missing-option", *kind.absent)
            return options.number(field.option, given, kind.least, kind.most)
        case Whole() as kind:
            return options.whole(field.option, given, kind.least, kind.most, kind.why)
        case Word() as kind:
            return None if given is None else options.word(field.option, given, kind.choices, kind.what)
        case Words() as kind:
            return options.words(field.option, given, kind.known, kind.what, kind.every) if given is not None else ()
        case Range():
            from mbsym_cli.variations import read_axis

            wanted = system is not None and (field.required or given is not None)
            return read_axis(given, field.option, system, options) if wanted else None
        case ExactSettings() if system is not None:
            from mbsym_cli.variations import read_settings

            return read_settings(given, system, options, field.kind.more(system))
        case ExactSettings():
            return {}
        case Named() as kind:
            return _whole_numbers(field.option, kind, given, options)
        case Assignments() if system is not None:
            from mbsym_cli.assignments import assignments

            assigned = assignments(given, system, options)
            return dict.fromkeys(assigned.texts) | dict(assigned.values)
        case Assignments():
            return {}
        case Ranges() as kind:
            from mbsym_cli.variations import read_variations

            return read_variations(field.option, given, kind, system, motion, options)
        case Formula() as kind:
            from mbsym_cli.formulas import read_quantity

            return read_quantity(field.option, given.strip(), kind, system, options)
        case Share() if given is not None:
            return _share(field.option, given, options)
        case Formulas():
            from mbsym_cli.formulas import MOTIONS, read_formula

            found: dict[str, Any] = {}
            for text in given if system is not None else ():
                read_formula(text, system, MOTIONS, found, options)
            return dict.fromkeys(text.partition("=")[0].strip() for text in given) | found
        case _:
            return given


def _share(option: str, text: str, options: Options) -> tuple[int, int] | None:
    first, slash, last = (part.strip() for part in text.partition("/"))
    if not slash:
        told = Message("[[text]] is no share", text=ascii_safe(text[:40]))
        options.complain(option, "bad-number", told, Message("for example [[example]]", example=f"{option} 3/16"))
        return None
    of = options.whole(option, last, 1, 10**6)
    number = options.whole(option, first, 1, of or 10**6)
    return None if of is None or number is None else (number, of)


def _whole_numbers(option: str, kind: Named, texts: tuple[str, ...], options: Options) -> dict[str, int]:
    """``NAME=N``, each name once."""
    found: dict[str, int] = {}
    for text in texts:
        name, equals, right = (part.strip() for part in text.partition("="))
        if not equals or not name:
            told = Message("[[text]] is no [[form]]", text=ascii_safe(text[:80]), form=kind.metavar)
            hint = Message("for example [[example]]", example=f"{option} {kind.example}")
            options.complain(option, "bad-assignment", told, hint)
            continue
        if name in found:
            options.complain(option, "repeated-name", Message("[[name]] is given twice", name=ascii_safe(name)))
        value = options.whole(option, right, kind.least, kind.most)
        found[name] = kind.least if value is None else value
    return found
