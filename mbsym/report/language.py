"""The language of a LaTeX report: its fixed sentences, and the words of verdicts and theorems, in another language.

Sentences stand in English in the templates and are looked up by themselves; ``[[name]]`` in them is filled in
afterwards.  What the kernel of problem 6 explains in sentences of its own, and the words of claims and self-checks that
are not listed, stay English.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

#: What may follow ``--language``, and what it is called.
LANGUAGES = {"en": "English", "ru": "Russian", "es": "Spanish"}

_BABEL = {"en": "", "ru": "russian", "es": "spanish,es-noquoting,es-noshorthands,es-nodecimaldot"}


class Language:
    """``name``: a key of ``LANGUAGES``; "" is English."""

    def __init__(self, name: str = "") -> None:
        self.name = name or "en"
        self.babel = _BABEL[self.name]
        catalogue: Any = None if self.name == "en" else import_module(f"mbsym.report.language_{self.name}")
        self._sentences: dict[str, str] = getattr(catalogue, "SENTENCES", {})
        self._words: dict[str, str] = getattr(catalogue, "WORDS", {})

    def sentence(self, english: str, **values: object) -> str:
        """A sentence of the templates, in TeX, with its values filled in."""
        text = self._sentences.get(english, english)
        for name, value in values.items():
            text = text.replace(f"[[{name}]]", str(value))
        return text

    def say(self, english: str) -> str:
        """A word or a clause of the results, as plain text; English where there is no other."""
        return self._words.get(str(english), str(english))
