"""What reports say in other languages, one file each, as translators know them (gettext).

A message is found by its English text.  ``msgctxt`` tells two meanings of one English phrase apart.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path


@cache
def messages(language: str) -> dict[tuple[str, str], str]:
    """(context, English) -> the other language; the context is "" where a phrase has one meaning."""
    import polib

    found = polib.pofile(str(Path(__file__).with_name(f"{language}.po")), encoding="utf-8")
    return {(entry.msgctxt or "", entry.msgid): entry.msgstr for entry in found}
