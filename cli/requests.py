"""The options of a study's command, made from its request, and the request read from their texts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mbsym.expressions.message import Message, worded
from mbsym.expressions.parser import ascii_safe
from mbsym.expressions.place import Complaints
from mbsym.expressions.tree import ZERO
from mbsym.studies.request import (
    Assignments,
    Errors,
    ExactSettings,
    Field,
    Flag,
    Formula,
    Formulas,
    Named,
    Names,
    Number,
    Parsed,
    Place,
    Problems,
    Quantity,
    Range,
    Ranges,
    Scale,
    Settings,
    Share,
    Substitutions,
    Whole,
    Word,
    Words,
    fields_of,
)
from mbsym_cli.options import Options

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.numerics.scenario import Scenario


def option_of(field: Field) -> click.Parameter:
    """The option of one field; its value is text, which is read with all the others."""
    kind = field.kind
    if isinstance(kind, Names) and kind.positional:
        return click.Argument([field.name], nargs=-1, metavar=kind.metavar)
    names = [name for name in (field.option, kind.short) if name]
    needed = field.required and isinstance(kind, Number)
    beside = f"  [{f'default: {kind.usual}' if kind.usual else 'required'}]" if kind.usual or needed else ""
    help_text = kind.help + beside or None
    if isinstance(kind, Flag):
        if kind.both:
            words = f"{field.option}/--no-{field.option.removeprefix('--')}"
            shown = field.default is not None
            return click.Option([words, field.name], default=field.default, show_default=shown, help=help_text)
        return click.Option([*names, field.name], is_flag=True, help=help_text)
    if isinstance(kind, Place):
        return click.Option([*names, field.name], metavar=kind.metavar, type=click.Path(path_type=Path), help=help_text)
    repeated = isinstance(kind, (Settings, ExactSettings, Assignments, Named, Names, Formulas, Ranges, Substitutions))
    repeated = repeated and not getattr(kind, "separated", False)
    usual = None if repeated or field.default in (None, (), "") else _text(field.default)
    if isinstance(kind, Number) and kind.alone:
        alone = {"is_flag": False, "flag_value": kind.alone}
        return click.Option([*names, field.name], metavar=kind.metavar, help=help_text, **alone)  # type: ignore[arg-type]
    return click.Option(
        [*names, field.name], metavar=kind.metavar, multiple=repeated, default=usual,
        show_default=usual is not None and not kind.usual and getattr(kind, "shown", True), help=help_text,
    )  # fmt: skip


def _text(default: Any) -> str:
    if isinstance(default, tuple):
        return ",".join(default)
    if isinstance(default, Quantity):
        return default.text
    return f"{default:g}".replace("e-0", "e-") if isinstance(default, float) else str(default)


def read_fields(
    file: Path, system: System | None, request: type, texts: Mapping[str, Any], options: Options
) -> tuple[dict[str, Any], Scenario | None, System | None]:
    """(the values of the fields that have ``texts``, the motion if it is one, the system with what is put into it).

    What cannot be read is None, and joins the complaints.
    """
    values: dict[str, Any] = {}
    scenario: Scenario | None = None
    fields = [field for field in fields_of(request) if field.name in texts]
    for field in (field for field in fields if isinstance(field.kind, Substitutions)):
        if system is not None and texts[field.name]:
            from mbsym_cli.assignments import with_settings

            system = with_settings(file, system, texts[field.name], options)
    for field in (field for field in fields if isinstance(field.kind, Scale)):
        if system is not None and texts[field.name] is not None and not options.complaints:
            from mbsym_cli.assignments import in_scale

            system = in_scale(system, texts[field.name], options)
    laws = {field.kind.laws for field in fields if isinstance(field.kind, Settings)}
    # Values are read when the laws of inputs are known, the others when the motion is.
    first = [field for field in fields if field.name in laws] + [x for x in fields if isinstance(x.kind, Settings)]
    for field in (*first, *(field for field in fields if field not in first)):
        if isinstance(field.kind, Settings):
            # A law that was complained about is as good as any: nothing is computed.
            known = {name: ZERO if law is None else law for name, law in values.get(field.kind.laws, {}).items()}
            scenario, values[field.name] = _motion(file, system, texts[field.name], field.kind, texts, known, options)
        else:
            values[field.name] = _read(field, texts[field.name], system, texts, options, scenario)
    return values, scenario, system


def _motion(
    file: Path,
    system: System | None,
    settings: tuple[str, ...],
    kind: Settings,
    texts: Mapping[str, Any],
    laws: Mapping[str, Any],
    options: Options,
) -> tuple[Scenario | None, Mapping[str, Any]]:
    if system is None:
        return None, {}
    from mbsym_cli.assignments import given_numbers, sound_numbers

    if not kind.whole(texts):
        return None, sound_numbers(file, system, settings, options)
    return given_numbers(file, system, settings, options, laws, kind.declared(texts), kind.state)


def _read(
    field: Field, typed: Any, system: System | None, texts: Mapping[str, Any], options: Options, motion: Scenario | None
) -> Any:
    match field.kind:
        case Number() as kind:
            if typed is None and field.required:
                options.complain(field.option, "missing-option", *kind.absent)
            return options.number(field.option, typed, kind.least, kind.most)
        case Whole() as kind:
            return options.whole(field.option, typed, kind.least, kind.most, kind.why)
        case Word() as kind:
            word = typed if typed is None or typed in kind.known else typed.lower()
            return None if word is None else options.word(field.option, word, kind.known, kind.what)
        case Words() as kind:
            return (
                options.words(field.option, typed, kind.known, kind.what, kind.every, kind.all_of or None)
                if typed is not None
                else ()
            )
        case Problems():
            return None if typed is None else options.problems(typed)
        case Substitutions():
            return dict.fromkeys(text.partition("=")[0].strip() for text in typed)
        case Parsed() as kind:
            return None if typed is None or system is None else _parsed(field.option, kind, typed, system, options)
        case Range():
            from mbsym_cli.variations import read_axis

            required = system is not None and (field.required or typed is not None)
            return read_axis(typed, field.option, system, options) if required else None
        case ExactSettings() if system is not None:
            from mbsym_cli.variations import read_settings

            return read_settings(typed, system, options, field.kind.more(system))
        case ExactSettings():
            return {}
        case Named() as kind:
            return _whole_numbers(field.option, kind, typed, options)
        case Assignments() if system is not None:
            from mbsym_cli.assignments import assignments

            assigned = assignments(typed, system, options)
            return dict.fromkeys(assigned.texts) | dict(assigned.values)
        case Assignments():
            return {}
        case Names() as kind:
            return _names(field.option, kind, typed, system, options)
        case Errors() as kind:
            known = () if system is None else kind.names(system, texts)
            return None if typed is None else _errors(field.option, kind, typed, known, options)
        case Ranges() as kind:
            from mbsym_cli.variations import read_variations

            if not typed and not field.required:
                return ()
            return read_variations(field.option, typed, kind, system, motion, options)
        case Formula() as kind:
            from mbsym_cli.formulas import read_quantity

            return read_quantity(field.option, typed.strip(), kind, system, options)
        case Share() if typed is not None:
            return _share(field.option, typed, options)
        case Formulas():
            from mbsym_cli.formulas import LAWS, MOTIONS, read_formula

            formulas: dict[str, Any] = {}
            for text in typed if system is not None else ():
                read_formula(text, system, LAWS if field.kind.laws else MOTIONS, formulas, options)
            return dict.fromkeys(text.partition("=")[0].strip() for text in typed) | formulas
        case _:
            return typed


def _names(option: str, kind: Names, typed: Any, system: System | None, options: Options) -> tuple[str, ...]:
    """As they are written; separated by commas, each once."""
    names: tuple[str, ...] = typed or ()
    if kind.separated:
        names = tuple(dict.fromkeys(part.strip() for part in (typed or "").split(",") if part.strip()))
    if kind.known is not None and system is not None:
        names = tuple(name for name in names if options.word(option, name, kind.known(system), kind.what) is not None)
    return names


def _parsed(option: str, kind: Parsed, text: str, system: System, options: Options) -> Any:
    text, complaints = " ".join(text.splitlines()), Complaints()
    value = kind.read(text, system, complaints)
    options.add(option, text, *complaints.sorted())
    return value


def _errors(option: str, kind: Errors, text: str, known: Sequence[str], options: Options) -> dict[str, float] | None:
    """Errors by name, "" for everything; where no names are ``known`` any goes."""
    errors: dict[str, float] = {}
    before = len(options.complaints)
    for part in text.split(","):
        left, equals, right = (piece.strip() for piece in part.partition("="))
        error = options.number(option, right if equals else left, kind.least, kind.most)
        name = left if equals else ""
        if name in errors:
            twice = Message("two errors are given for [[name]]", name=name or worded("everything"))
            options.complain(option, "conflicting-options", twice)
        elif not equals or not known or options.word(option, name, known, "quantity") is not None:
            errors[name] = error or kind.least
    return None if len(options.complaints) > before else errors


def _share(option: str, text: str, options: Options) -> tuple[int, int] | None:
    first, slash, last = (part.strip() for part in text.partition("/"))
    if not slash:
        message = Message("[[text]] is no share", text=ascii_safe(text[:40]))
        options.complain(option, "bad-number", message, Message("for example [[example]]", example=f"{option} 3/16"))
        return None
    of = options.whole(option, last, 1, 10**6)
    number = options.whole(option, first, 1, of or 10**6)
    return None if of is None or number is None else (number, of)


def _whole_numbers(option: str, kind: Named, texts: tuple[str, ...], options: Options) -> dict[str, int]:
    """``NAME=N``, each name once."""
    whole_numbers: dict[str, int] = {}
    for text in texts:
        name, equals, right = (part.strip() for part in text.partition("="))
        if not equals or not name:
            message = Message("[[text]] is no [[form]]", text=ascii_safe(text[:80]), form=kind.metavar)
            hint = Message("for example [[example]]", example=f"{option} {kind.example}")
            options.complain(option, "bad-assignment", message, hint)
            continue
        if name in whole_numbers:
            options.complain(option, "repeated-name", Message("[[name]] is given twice", name=ascii_safe(name)))
        value = options.whole(option, right, kind.least, kind.most)
        whole_numbers[name] = kind.least if value is None else value
    return whole_numbers
