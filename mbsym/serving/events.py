"""What the server tells its pages by itself: numbered, kept for a while, told again to a page that was away.

A page that connects again names the last event that it has heard.  What came after that is told first; where that is no
longer known, or was told by another server, it hears {"kind": "lost"} and asks again for whatever it waits for.
"""

from __future__ import annotations

import asyncio
import json
import secrets
from collections import deque
from collections.abc import AsyncIterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

#: A page that does not take its events is let go; it connects again.
MOST_WAITING = 1_000

#: So many events, with so many characters together, are kept for those who were away.
MOST_KEPT, MOST_CHARACTERS = 1_000, 8_000_000

#: Seconds between two signs of life to a page.
ALIVE = 15.0

Event = dict[str, Any]
Queue = asyncio.Queue["SentEvent | None"]


@dataclass(frozen=True)
class SentEvent:
    """An event as it is sent; ``number`` counts from 1."""

    number: int
    text: str


def encoded(event: Event) -> str:
    """JSON; of a long motion it takes a while: not for an event loop."""
    return json.dumps(event, ensure_ascii=False, separators=(",", ":"))


class Events:
    """To be used on one event loop."""

    def __init__(self) -> None:
        self._server = secrets.token_hex(4)
        self._count = 0
        self._kept: deque[SentEvent] = deque()
        self._size = 0
        self._pages: set[Queue] = set()

    @property
    def heard(self) -> bool:
        """Whether a page listens."""
        return bool(self._pages)

    @property
    def last(self) -> str:
        """The name of the last event so far: who listens from here on misses nothing that comes."""
        return self._name(self._count)

    def _name(self, number: int) -> str:
        return f"{self._server}-{number}"

    def tell(self, text: str) -> None:
        """To every page, now or when it connects again."""
        self._count += 1
        sent_event = SentEvent(self._count, text)
        self._kept.append(sent_event)
        self._size += len(text)
        while len(self._kept) > MOST_KEPT or (self._size > MOST_CHARACTERS and len(self._kept) > 1):
            self._size -= len(self._kept.popleft().text)
        for page in self._pages.copy():
            try:
                page.put_nowait(sent_event)
            except asyncio.QueueFull:
                self._pages.discard(page)

    def end(self) -> None:
        """Streams end, so that a server can."""
        for page in self._pages:
            with suppress(asyncio.QueueFull):
                page.put_nowait(None)

    def listen(self, after: str = "") -> AsyncIterator[str]:
        """Server-sent events from the time of this call on, or from after the one of this name."""
        return self._stream(*self._missed(after))

    def _missed(self, after: str) -> tuple[int, bool]:
        """After which number, and whether others were lost before."""
        if not after:
            return self._count, False
        server, _, number = after.rpartition("-")
        if server == self._server and number.isascii() and number.isdigit() and len(number) < 16:
            first = self._kept[0].number if self._kept else self._count + 1
            if first - 1 <= int(number) <= self._count:
                return int(number), False
        return self._count, True

    async def _stream(self, after: int, lost: bool) -> AsyncIterator[str]:
        queue: Queue = asyncio.Queue(MOST_WAITING)
        self._pages.add(queue)
        missed = [event for event in self._kept if event.number > after]
        try:
            yield "retry: 1000\n\n"
            if lost:
                yield self._lines(SentEvent(after, encoded({"kind": "lost"})))
            for sent_event in missed:
                yield self._lines(sent_event)
            while queue in self._pages:
                try:
                    now = await asyncio.wait_for(queue.get(), ALIVE)
                except TimeoutError:
                    yield ": alive\n\n"
                    continue
                if now is None:
                    return
                yield self._lines(now)
        finally:
            self._pages.discard(queue)

    def _lines(self, event: SentEvent) -> str:
        return f"id: {self._name(event.number)}\ndata: {event.text}\n\n"
