"""Events: told again to a page that was away, and said to be lost where they cannot be; what only a comment changes."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator, Awaitable, Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest
from conftest import SHIPPED

pytest.importorskip("starlette")

from mbsym.serving import events, looking
from mbsym.serving.events import Events, encoded


def heard(work: Callable[[], Awaitable[Any]]) -> Any:
    """In a thread of its own: a browser of other tests may have left a loop that runs in this one."""
    with ThreadPoolExecutor(1) as beside:
        return beside.submit(lambda: asyncio.run(work())).result()  # type: ignore[arg-type]


async def next_of(stream: AsyncIterator[str]) -> tuple[str, dict[str, Any]]:
    """Name and content of the next event."""
    while True:
        lines = (await asyncio.wait_for(anext(stream), 5)).splitlines()
        if lines[0].startswith("id: "):
            return lines[0][4:], json.loads(lines[1][6:])


async def begun(stream: AsyncIterator[str]) -> None:
    assert (await anext(stream)).startswith("retry: ")


def told(number: int) -> str:
    return encoded({"kind": "progress", "words": f"line {number}\nand é"})


def test_who_was_away_hears_what_was_told_meanwhile_once_and_in_order() -> None:
    async def work() -> list[str]:
        found = Events()
        first = found.listen()
        await begun(first)
        for number in (1, 2):
            found.tell(told(number))
        name, content = await next_of(first)
        assert content["words"] == "line 1\nand é"
        await first.aclose()  # type: ignore[attr-defined]
        assert not found.heard
        found.tell(told(3))
        again = found.listen(name)
        await begun(again)
        found.tell(told(4))
        return [(await next_of(again))[1]["words"] for _ in range(3)]

    assert heard(work) == [f"line {number}\nand é" for number in (2, 3, 4)]


def test_nothing_falls_between_the_call_and_the_first_event() -> None:
    async def work() -> str:
        found = Events()
        stream = found.listen()
        found.tell(told(1))  # the answer is on its way, its stream not asked for yet
        await begun(stream)
        return str((await next_of(stream))[1]["words"])

    assert heard(work).startswith("line 1")


@pytest.mark.parametrize(
    "after", ["other-1", "1", "{server}-x", "{server}-9", "{server}--1", "{server}-²", "{server}-1"]
)
def test_what_cannot_be_told_again_is_said_to_be_lost(after: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of another server, not of this one's, not told yet, or no longer kept: of five the last three are."""
    monkeypatch.setattr(events, "MOST_KEPT", 3)

    async def work() -> list[Any]:
        found = Events()
        for number in range(1, 6):
            found.tell(told(number))
        stream = found.listen(after.format(server=found.last.partition("-")[0]))
        await begun(stream)
        name, content = await next_of(stream)
        assert name == found.last  # from here on it is known again
        found.tell(told(6))
        return [content, (await next_of(stream))[1]["words"]]

    assert heard(work) == [{"kind": "lost"}, "line 6\nand é"]


def test_what_is_kept_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(events, "MOST_CHARACTERS", 100)

    async def work() -> Any:
        found = Events()
        name = found.last
        found.tell(encoded({"kind": "motion", "value": "x" * 1000}))
        kept = found.listen(name)  # the last is kept however long it is
        await begun(kept)
        assert (await next_of(kept))[1]["kind"] == "motion"
        found.tell(told(2))
        stream = found.listen(name)
        await begun(stream)
        return (await next_of(stream))[1]

    assert heard(work) == {"kind": "lost"}


# --- what a text says -------------------------------------------------------------------------------------------------


def content(text: str, name: str = "system.yaml") -> str | None:
    found: str | None = looking.view(text, name, None)["content"]
    return found


@pytest.mark.parametrize("name", ["double-pendulum.yaml", "satellite.txt"])
def test_a_comment_says_nothing(name: str) -> None:
    text = (SHIPPED / name).read_text(encoding="utf-8")
    same = [f"# first\n{text}", f"{text}# last\n", text.replace("\n", "\r\n"), text.replace("\n", "   # here\n", 1)]
    assert {content(one, name) for one in same} == {content(text, name)} != {None}


def test_everything_else_does() -> None:
    """Each of these is another system, or a text with mistakes."""
    text = (SHIPPED / "double-pendulum.yaml").read_text(encoding="utf-8")
    assert "# " not in text.partition("name:")[2].partition("\n")[0]
    others = [
        text.replace("first rod", "other rod"),
        text.replace("name: ", "name: 'with # inside' # ", 1),
        text.replace("positive", "nonnegative", 1),
        text.replace("g: 9.81", "g: 9.8"),
        text.replace("mbsym: 1", "mbsym: 1\nmotion : {}", 1),
    ]
    found = [content(one) for one in others]
    assert content(text) not in found
    assert content(text.replace("mass: ", "mass: nobody*", 1)) is None
    assert content(f"{text}: :\n") is None
