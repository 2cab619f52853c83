"""The language of reports: sentences of templates, and the words of results, in another language.

Messages are looked up by their English text (``mbsym.report.messages``).  ``[[name]]`` in those of templates is filled
in afterwards.  What results say in sentences of their own is read sentence by sentence, with gaps ``{}`` for names and
numbers; what is not listed stays English.
"""

from __future__ import annotations

import re
from functools import cached_property

from mbsym.report.messages import messages

#: What may follow ``--language``, and what it is called.
LANGUAGES = {"en": "English", "ru": "Russian", "es": "Spanish"}

_BABEL = {"en": "", "ru": "russian", "es": "spanish,es-noquoting,es-noshorthands,es-nodecimaldot"}


class Language:
    """``name``: a key of ``LANGUAGES``; "" is English."""

    def __init__(self, name: str = "") -> None:
        self.name = name or "en"
        self.babel = _BABEL[self.name]
        self._messages = {} if self.name == "en" else messages(self.name)

    @cached_property
    def _explained(self) -> list[tuple[re.Pattern[str], str]]:
        """What is read, and what is said for it: first what has no gaps, then the longest: it leaves least to them."""
        read = [(english, other) for (_, english), other in self._messages.items() if "[[" not in english]
        return [
            (re.compile(_reading(english)), other)
            for english, other in sorted(read, key=lambda item: ("{}" in item[0], -len(item[0])))
        ]

    def sentence(self, english: str, **values: object) -> str:
        """A sentence of the templates, in TeX, with its values filled in."""
        text = self._known(english, "template")
        for name, value in values.items():
            text = text.replace(f"[[{name}]]", str(value))
        return text

    def say(self, english: str, context: str = "") -> str:
        """A word, a clause or the sentences of a result, as plain text; English where there is no other."""
        text = str(english)
        return self._known(text, context) if ("", text) in self._messages else self._read(text)

    def _known(self, english: str, context: str) -> str:
        return self._messages.get((context, english)) or self._messages.get(("", english), english)

    def _read(self, text: str) -> str:
        said: list[str] = []
        while text:
            for pattern, other in self._explained:
                match = pattern.match(text)
                if match is not None:
                    said.append(other.format(*(_Gap(x, self) for x in match.groups())))
                    text = text[match.end() :]
                    break
            else:
                sentence, stop, text = text.partition(". ")
                said.append(sentence + stop.rstrip())
        return " ".join(said)


def _reading(english: str) -> str:
    """The pattern of a phrase, which is all of a text, or of a sentence, which another one may follow."""
    end = "(?: |$)" if english.endswith(".") else "$"
    return "(.+?)".join(map(re.escape, english.split("{}"))) + end


class _Gap:
    """What stands in a gap: as it is, in the other language (``said``), or said item by item (``list``)."""

    def __init__(self, text: str, language: Language) -> None:
        self.text, self.language = text, language

    def __format__(self, how: str) -> str:
        if how == "list":
            return "; ".join(self.language.say(x) for x in re.split(", | and ", self.text))
        return self.language.say(self.text) if how == "said" else self.text
