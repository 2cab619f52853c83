"""The language of reports: messages are looked up by their English text; what is not listed stays English."""

from __future__ import annotations

from enum import StrEnum

from mbsym.expressions.message import Counted, Message, Said, filled
from mbsym.model.system import LANGUAGES
from mbsym.report.messages import messages, plurals


class Language:
    """``name``: a key of ``LANGUAGES``; "" is English."""

    def __init__(self, name: str = "") -> None:
        self.name = name or "en"
        self.babel = LANGUAGES[self.name]
        self._messages = {} if self.name == "en" else messages(self.name)
        self._forms, self._form = ({}, int) if self.name == "en" else plurals(self.name)

    def sentence(self, english: str, context: str = "") -> str:
        """The text of a message with its gaps; English where there is no other."""
        return self._messages.get((context, english)) or self._messages.get(("", english), english)

    def text_of(self, said: Said, context: str = "") -> str:
        """The text of a sentence with its gaps; of numbers of things the form that goes with the number."""
        if isinstance(said, Counted) and said.one in self._forms:
            return f"[[number]] {self._forms[said.one][self._form(said.number)]}"
        return self.sentence(said.text, context)

    def say(self, english: str, context: str = "") -> str:
        """A message, a word of ours as plain text, with what stands in its gaps."""
        if not isinstance(english, Message):
            return self.sentence(str(english), context)
        return filled(self.text_of(english, context), lambda name: self._gap(english.gaps[name]))

    def _gap(self, value: object) -> str:
        """A message and a word of ours in the language; a name, a number, a formula as it is."""
        return self.say(value) if isinstance(value, Message | StrEnum) else str(value)
