"""What reports say in other languages, one file each, as translators know them (gettext).

A message is found by its English text.  ``msgctxt`` tells two meanings of one English phrase apart.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from gettext import c2py
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from polib import POFile


@cache
def messages(language: str) -> dict[tuple[str, str], str]:
    """(context, English) -> the other language; the context is "" where a phrase has one meaning."""
    return {
        (entry.msgctxt or "", entry.msgid): entry.msgstr for entry in _catalogue(language) if not entry.msgid_plural
    }


@cache
def plurals(language: str) -> tuple[dict[str, tuple[str, ...]], Callable[[int], int]]:
    """The forms of what is counted by its English singular, and which of them goes with a number."""
    catalogue = _catalogue(language)
    rule = catalogue.metadata["Plural-Forms"].partition("plural=")[2].rstrip("; ")
    forms = {
        entry.msgid: tuple(form for _, form in sorted(entry.msgstr_plural.items()))
        for entry in catalogue
        if entry.msgid_plural
    }
    return forms, c2py(rule)


@cache
def _catalogue(language: str) -> POFile:
    import polib

    return polib.pofile(str(Path(__file__).with_name(f"{language}.po")), encoding="utf-8")
