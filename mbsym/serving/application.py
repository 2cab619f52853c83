"""The routes of ``mbsym edit``: thin over ``looking``, ``storage`` and ``jobs``; nothing slow on the event loop.

Answers are JSON; one that refuses is {"error": code, "message": words} with a status of 400 or more.
"""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.requests import ClientDisconnect, Request
from starlette.responses import JSONResponse, Response, StreamingResponse
from starlette.routing import Route

from mbsym.algebra.failures import LOG
from mbsym.serving import looking
from mbsym.serving.events import Events, encoded
from mbsym.serving.guard import Guard, TooLarge, TooSlow
from mbsym.serving.jobs import Jobs
from mbsym.serving.looking import Wrong, flag, listed, mapping, text_of, whole
from mbsym.serving.storage import Conflict, Storage, Unreadable, Unwritable
from mbsym.source.examples import example_text, example_titles
from mbsym.source.starter import JOINTS, ONE_AXIS

#: Seconds between two looks whether somebody else wrote the file.
WATCHING = 0.5

#: What a page may ask for by name; of everything else there is nothing.
STATIC = {
    "": ("index.html", "text/html; charset=utf-8"),
    "page.js": ("page.js", "text/javascript; charset=utf-8"),
    "page.css": ("page.css", "text/css; charset=utf-8"),
}

#: Seconds after which a job that nobody listens to is ended.
ABANDONED = 20.0

#: Seconds between two looks whether the page that asked for a picture still wants it.
LEAVING = 0.05

Deliver = Callable[[Path, Mapping[str, str | bytes], str, list[str]], list[Path]]


@dataclass(frozen=True)
class Services:
    """What the server needs of those above it: where reports go, and how a set of files is delivered there."""

    folder: Path
    deliver: Deliver


class Editor:
    """One file, its pages, its jobs."""

    def __init__(self, path: Path, services: Services, token: str, port: int = 0) -> None:
        self.storage, self.services, self.token = Storage(path), services, token
        self.jobs = Jobs(self._tell_from_a_thread)
        self.guard = Guard(self._starlette(), token, port)
        self.told = Events()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._slow = asyncio.Semaphore(1)
        self._known = self._digest_now()
        self._system: Any = None

    # --- life ---------------------------------------------------------------------------------------------------------

    @asynccontextmanager
    async def _living(self, _: Starlette) -> AsyncIterator[None]:
        self._loop = asyncio.get_running_loop()
        tasks = [asyncio.create_task(self._watch()), asyncio.create_task(asyncio.to_thread(self._head_start))]
        try:
            yield
        finally:
            self.told.end()
            await asyncio.to_thread(self.jobs.close)
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)

    def _head_start(self) -> None:
        """Derives the file as it stands while the page is being opened, which will ask for it in these words.

        What the page asks for before that is answered once for nobody: whatever has to be loaded for it then is.
        """
        with suppress(Unreadable):
            content, path = self.storage.read(), self.storage.path
            if content.digest:
                body = {"text": content.text, "format": looking.spelling(content.text, path.name)}
                self.jobs.ahead(self._task("derive", body))
            document = self._file()
            with suppress(Exception):  # whoever asks hears of it
                looking.view(document["text"], self._named(document), self._folder)
        self.jobs.warm()

    async def _watch(self) -> None:
        """Tells when somebody else has written the file; ends jobs that nobody listens to."""
        stamp, alone = self.storage.stamp(), 0.0
        while True:
            await asyncio.sleep(WATCHING)
            alone = 0.0 if self.told.heard else alone + WATCHING
            if ABANDONED <= alone < ABANDONED + WATCHING:
                self.jobs.cancel_all("nobody is there")
            now = self.storage.stamp()
            if now == stamp:
                continue
            stamp = now
            with suppress(Unreadable):
                content = await asyncio.to_thread(self.storage.read)
                if content.digest != self._known:
                    self._known = content.digest
                    self._tell({"kind": "outside", "digest": content.digest, "text": content.text})

    def _digest_now(self) -> str:
        with suppress(Unreadable):
            return self.storage.read().digest
        return ""

    # --- events -------------------------------------------------------------------------------------------------------

    def _tell_from_a_thread(self, event: dict[str, Any]) -> None:
        text = encoded(event)
        if self._loop is not None:
            with suppress(RuntimeError):  # the loop has ended
                self._loop.call_soon_threadsafe(self.told.tell, text)

    def _tell(self, event: dict[str, Any]) -> None:
        self.told.tell(encoded(event))

    async def events(self, request: Request) -> Response:
        """A browser that connects again names the last event it has heard in a header, a page in ``after``."""
        after = request.headers.get("last-event-id") or request.query_params.get("after") or ""
        return StreamingResponse(self.told.listen(after[:100]), media_type="text/event-stream")

    # --- the page and the file ----------------------------------------------------------------------------------------

    async def static(self, request: Request) -> Response:
        asset = STATIC.get(request.path_params.get("name", ""))
        if asset is None:
            return refused(404, "not-found", "there is nothing here")
        try:
            content = await asyncio.to_thread(files("mbsym.serving").joinpath("page", asset[0]).read_bytes)
        except OSError:
            return refused(404, "not-built", "the page is not built: make page")
        return Response(content, media_type=asset[1])

    async def file(self, request: Request) -> Response:
        last = self.told.last  # before the file is read: what becomes of it then is told to who listens from here
        return JSONResponse({**await asyncio.to_thread(self._file), "told": last})

    def _file(self) -> dict[str, Any]:
        import mbsym
        from mbsym.expressions.tree import FUNCTIONS
        from mbsym.model.system import LANGUAGES
        from mbsym.report.targets import FORMATS
        from mbsym.source import json_schema

        content, path = self.storage.read(), self.storage.path
        offered = self.storage.offered()
        text = content.text if content.digest else looking.empty(path.name, path.stem)
        return {
            "name": path.name,
            "path": str(path),
            "format": looking.spelling(text, path.name),
            "text": text,
            "digest": content.digest,
            "new": not content.digest,
            "journal": None if offered is None else {"text": offered.text, "written": offered.written},
            "version": mbsym.__version__,
            "schema": json_schema(),
            "claims": _claims(),
            "functions": list(FUNCTIONS),
            "languages": list(LANGUAGES),
            "formats": [{"name": name, "title": FORMATS[name].title} for name in FORMATS],
            "problems": _problems(),
            "examples": example_titles(),
            "joints": [
                {"name": name, "title": title, "axis": name in ONE_AXIS} for name, (_, _, title) in JOINTS.items()
            ],
        }

    async def digest(self, request: Request) -> Response:
        return JSONResponse({"digest": await asyncio.to_thread(self._digest_now)})

    async def save(self, body: Mapping[str, Any], _: Request) -> Any:
        text, digest, force = text_of(body), text_of(body, "digest"), flag(body, "force")
        try:
            new = await asyncio.to_thread(self.storage.save, text, digest, force)
        except Conflict as conflict:
            return JSONResponse({"digest": conflict.digest, "text": conflict.text}, status_code=409)
        self._known = new
        self._tell({"kind": "outside", "digest": new, "text": text})  # other pages of this file
        return {"digest": new}

    async def journal(self, body: Mapping[str, Any], _: Request) -> Any:
        await asyncio.to_thread(self.storage.keep, text_of(body))
        return {}

    async def begin(self, body: Mapping[str, Any], _: Request) -> Any:
        """A first text: of one body on a ``joint``, of an ``example`` (None: nothing), or as ``pasted``."""
        path = self.storage.path
        if "joint" in body:
            text = await asyncio.to_thread(looking.one_body, path.stem, text_of(body, "joint"))
        elif "pasted" in body:
            text = await asyncio.to_thread(looking.pasted, text_of(body, "pasted"))
        elif body.get("example") is None:
            text = looking.empty(path.name, path.stem)
            return {"text": text, "format": looking.spelling(text, path.name)}
        else:
            name = str(body["example"])
            try:
                text = await asyncio.to_thread(example_text, name)
            except KeyError as error:
                raise Wrong(f"there is no example called {name[:80]!r}") from error
        return {"text": text, "format": looking.spelling(text, "new.yaml")}

    # --- the text -----------------------------------------------------------------------------------------------------

    @property
    def _folder(self) -> Path:
        return self.storage.path.parent

    def _named(self, body: Mapping[str, Any]) -> str:
        """A name whose ending says the spelling where the text does not."""
        return f"{self.storage.path.stem}.{'txt' if body.get('format') == 'text' else 'yaml'}"

    async def look(self, body: Mapping[str, Any], _: Request) -> Any:
        return await asyncio.to_thread(looking.view, text_of(body), self._named(body), self._folder)

    async def change(self, body: Mapping[str, Any], _: Request) -> Any:
        operations = listed(body, "operations", dict)
        return await asyncio.to_thread(looking.changed, text_of(body), self._named(body), operations, self._folder)

    async def complete(self, body: Mapping[str, Any], _: Request) -> Any:
        text, offset, name = text_of(body), whole(body, "offset"), self._named(body)

        def work() -> dict[str, Any]:
            self._system = looking.understood(text, name, self._folder)[0] or self._system
            return looking.completed(text, offset, self._system)

        return await asyncio.to_thread(work)

    async def hover(self, body: Mapping[str, Any], _: Request) -> Any:
        text, offset = text_of(body), whole(body, "offset")
        explanation = await asyncio.to_thread(looking.hovered, text, offset)
        if explanation is not None:
            return explanation
        outcome = await self._result({**self._task("hover", body), "offset": offset})
        return outcome.get("value") if outcome["kind"] == "hover" else None

    async def convert(self, body: Mapping[str, Any], _: Request) -> Any:
        to = text_of(body, "to")
        if to not in ("yaml", "text"):
            raise Wrong("to is yaml or text")
        conversion = await asyncio.to_thread(looking.converted, text_of(body), self._named(body), to, self._folder)
        if "text" not in conversion:
            words = "; ".join(x["message"] for x in conversion["complaints"][:3])
            return JSONResponse({"error": "mistakes", "message": words, **conversion}, status_code=422)
        return conversion

    async def formula(self, body: Mapping[str, Any], _: Request) -> Any:
        return await asyncio.to_thread(looking.typed_formula, text_of(body, "source"))

    async def picture(self, body: Mapping[str, Any], request: Request) -> Any:
        async with self._slow:
            if await request.is_disconnected():
                return {}
            outcome = await self._while_there({**self._task("picture", body), "set": mapping(body, "set")}, request)
        if outcome["kind"] == "picture":
            return outcome["value"]
        return {"complaints": [_whole_complaint(outcome.get("words", ""))]}

    # --- jobs ---------------------------------------------------------------------------------------------------------

    def _task(self, kind: str, body: Mapping[str, Any]) -> dict[str, Any]:
        return {"kind": kind, "text": text_of(body), "name": self._named(body), "folder": str(self._folder)}

    async def _result(self, task: dict[str, Any]) -> dict[str, Any]:
        return await asyncio.to_thread(self.jobs.result, task)

    async def _while_there(self, task: dict[str, Any], request: Request) -> dict[str, Any]:
        """The result of a job that ends with its request: nobody waits behind an answer that nobody wants."""
        names: list[str] = []
        work = asyncio.create_task(asyncio.to_thread(self.jobs.result, task, begun=names.append))
        while not (await asyncio.wait([work], timeout=LEAVING))[0]:
            if names and await request.is_disconnected():
                self.jobs.cancel(names[0])
        return await work

    def _job(self, kind: str) -> Work:
        async def begin(body: Mapping[str, Any], _: Request) -> Any:
            task = self._task(kind, body)
            task |= {name: mapping(body, name) for name in ("set", "x", "y") if name in body}
            settings = [name for name in ("time", "method", "language") if body.get(name) is not None]
            task |= {name: str(body[name])[:100] for name in settings}
            if body.get("problems") is not None:
                task["problems"] = _chosen(listed(body, "problems", int))
            _known_language(task.get("language"))
            page = str(body.get("page") or "")[:100]
            return {"job": await asyncio.to_thread(self.jobs.begin, task, page)}

        return begin

    async def cancel(self, body: Mapping[str, Any], _: Request) -> Any:
        return {"cancelled": await asyncio.to_thread(self.jobs.cancel, text_of(body, "job"))}

    async def export(self, body: Mapping[str, Any], _: Request) -> Any:
        from mbsym.report.targets import FORMATS

        names = [str(body.get("to"))] if isinstance(body.get("to"), str) else listed(body, "to", str)
        unknown = [name for name in names if name not in FORMATS]
        if unknown or not names:
            raise Wrong(f"formats are {', '.join(FORMATS)}")
        task = {**self._task("export", body), "formats": names, "language": str(body.get("language") or "")}
        if body.get("problems") is not None:
            task["problems"] = _chosen(listed(body, "problems", int))
        _known_language(task["language"])
        outcome = await asyncio.to_thread(self.jobs.result, task, "", 600.0)
        if outcome["kind"] != "files":
            return refused(422, "no-report", str(outcome.get("words", "nothing was made")))
        folder, words = self.services.folder, list(outcome["words"])
        try:
            written = await asyncio.to_thread(self.services.deliver, folder, outcome["files"], "run", outcome["gone"])
        except OSError as error:
            return refused(422, "unwritable", error.strerror or str(error))
        return {"files": [str(path) for path in written], "words": words}

    # --- how they are wired -------------------------------------------------------------------------------------------

    def _starlette(self) -> Starlette:
        of_text: tuple[Work, ...] = (self.look, self.change, self.complete, self.hover, self.convert, self.formula)
        of_file: tuple[Work, ...] = (self.picture, self.cancel, self.save, self.journal, self.begin, self.export)
        posts: dict[str, Work] = {work.__name__: work for work in (*of_text, *of_file)}
        posts |= {kind: self._job(kind) for kind in ("derive", "simulate", "equilibria", "modes", "map")}
        routes = [
            Route("/api/file", safely(self.file), methods=["GET"]),
            Route("/api/events", self.events, methods=["GET"]),
            Route("/api/digest", safely(self.digest), methods=["GET"]),
            *(Route(f"/api/{name}", posted(work), methods=["POST"]) for name, work in posts.items()),
            Route("/", safely(self.static), methods=["GET"]),
            Route("/{name}", safely(self.static), methods=["GET"]),
        ]
        return Starlette(routes=routes, lifespan=self._living)


def _chosen(numbers: list[int]) -> list[int]:
    from mbsym.problems import NUMBERS

    if not numbers or any(x not in NUMBERS for x in numbers):
        raise Wrong(f"problems are {', '.join(map(str, NUMBERS))}")
    return sorted(set(numbers))


def _known_language(language: str | None) -> None:
    from mbsym.model.system import LANGUAGES

    if language and language not in LANGUAGES:
        raise Wrong(f"languages are {', '.join(LANGUAGES)}")


@lru_cache
def _claims() -> dict[str, Any]:
    """Kind of claim -> what its ``of`` names ("" if it has none) and its keys, for the page's forms."""
    from mbsym.model.claims import CLAIMS
    from mbsym.source.claims import keys_of

    return {
        word: {"of": kind.of, "keys": [*(key for key, needed in keys_of(kind).items() if needed), "place"]}
        for word, kind in CLAIMS.items()
    }


@lru_cache
def _problems() -> list[dict[str, Any]]:
    from mbsym.analysis import PROBLEMS, USUAL_PROBLEMS

    return [{"number": n, "title": PROBLEMS[n].title, "usual": n in USUAL_PROBLEMS} for n in PROBLEMS]


def _whole_complaint(words: str) -> dict[str, Any]:
    """About the text as a whole."""
    place = {"from": 0, "to": 0, "line": 1, "column": 1}
    return {"severity": "error", "code": "no-picture", "message": words, "hint": None, **place}


#: A route's part that takes an object and answers one.
Work = Callable[[Mapping[str, Any], Request], Awaitable[Any]]

Handler = Callable[[Request], Awaitable[Response]]


def refused(status: int, code: str, words: str, headers: Mapping[str, str] | None = None) -> Response:
    return JSONResponse({"error": code, "message": words}, status, headers)


def posted(work: Work) -> Handler:
    """A route that takes an object and answers one."""

    async def handle(request: Request) -> Response:
        try:
            body = json.loads(await request.body())
        except (ValueError, RecursionError):
            return refused(400, "json", "JSON is wanted")
        if not isinstance(body, dict):
            return refused(400, "json", "an object is wanted")
        answer = await work(body, request)
        return answer if isinstance(answer, Response) else JSONResponse(answer)

    return safely(handle)


def safely(work: Handler) -> Handler:
    """What is foreseen is answered with words."""

    async def handle(request: Request) -> Response:
        try:
            return await work(request)
        except ClientDisconnect:
            return Response(status_code=400)
        except TooLarge as error:
            return refused(413, "too-large", str(error))
        except TooSlow as error:
            return refused(408, "too-slow", str(error), {"connection": "close"})
        except Wrong as error:
            return refused(400, "request", str(error))
        except (Unwritable, Unreadable) as error:
            return refused(422, "unwritable" if isinstance(error, Unwritable) else "unreadable", str(error))
        except Exception as error:  # a defect costs one answer
            LOG.exception("a request failed")
            return refused(500, "internal-error", f"internal error: {type(error).__name__}: {error}")

    return handle
