"""The language of reports: sentences of templates, and the words of results, in another language.

Messages are looked up by their English text (``mbsym.report.messages``), and what stands in their gaps ``[[name]]`` is
filled in afterwards; what is not listed stays English.
"""

from __future__ import annotations

from enum import Enum

from mbsym.expressions.message import Counted, Message, filled
from mbsym.report.messages import messages, plurals

#: What may follow ``--language``, and what it is called.
LANGUAGES = {"en": "English", "ru": "Russian", "es": "Spanish"}

_BABEL = {"en": "", "ru": "russian", "es": "spanish,es-noquoting,es-noshorthands,es-nodecimaldot"}


class Language:
    """``name``: a key of ``LANGUAGES``; "" is English."""

    def __init__(self, name: str = "") -> None:
        self.name = name or "en"
        self.babel = _BABEL[self.name]
        self._messages = {} if self.name == "en" else messages(self.name)
        self._forms, self._form = ({}, int) if self.name == "en" else plurals(self.name)

    def sentence(self, english: str, **values: object) -> str:
        """A sentence of the templates, in TeX, with its values filled in."""
        text = self._known(english, "template")
        for name, value in values.items():
            text = text.replace(f"[[{name}]]", str(value))
        return text

    def say(self, english: str, context: str = "") -> str:
        """A word, a clause or the sentences of a result, as plain text; English where there is no other."""
        if isinstance(english, Counted) and english.one in self._forms:
            return f"{english.number} {self._forms[english.one][self._form(english.number)]}"
        if not isinstance(english, Message):
            return self._known(str(english), context)
        return filled(self._known(english.text, context), lambda name: self._gap(english.gaps[name]))

    def _gap(self, value: str) -> str:
        """A message and a word of ours in the language; a name, a number, a formula as it is."""
        return self.say(value) if isinstance(value, Message | Enum) else value

    def _known(self, english: str, context: str) -> str:
        return self._messages.get((context, english)) or self._messages.get(("", english), english)
