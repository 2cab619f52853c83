"""Who may come in: the page that has the token, from this machine, with requests of a bounded size.

Any page of any site can send requests to 127.0.0.1.  It does not know the token; a name of its own that it has led here
(DNS rebinding) stands in Host; what it sends names it in Origin; and what it could read it may not, as no answer allows
another origin.
"""

from __future__ import annotations

import asyncio
import hmac
import json
from collections.abc import Awaitable, Callable, MutableMapping
from typing import Any

Message = MutableMapping[str, Any]
Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]
Application = Callable[[Scope, Receive, Send], Awaitable[None]]

#: Bytes of a request's body: a description of the longest in JSON.
MOST_BYTES = 2_000_000

#: Seconds within which a body is there: the page is on this machine.
MOST_SECONDS = 30.0

POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' data: blob:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)

HEADERS = (
    (b"content-security-policy", POLICY.encode()),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"x-frame-options", b"DENY"),
    (b"cross-origin-opener-policy", b"same-origin"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"cache-control", b"no-store"),
)


class TooLarge(Exception):
    """The body of a request; raised amid reading it."""


class TooSlow(Exception):
    """The body of a request; raised amid waiting for it."""


class Guard:
    """Wraps an application, which sees paths without the token.

    ``port``: of the address, once it is known; ``names``: what Host may call this machine.
    """

    def __init__(self, inner: Application, token: str, port: int = 0, most: int = MOST_BYTES) -> None:
        self.inner, self.token, self.port, self.most = inner, token, port, most
        self.seconds = MOST_SECONDS

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan":
            await self.inner(scope, receive, send)
            return
        if scope["type"] != "http":
            return  # a WebSocket is closed by not being accepted
        refusal = self._refusal(scope)
        if refusal is not None:
            await _answer(send, *refusal)
            return
        began = False

        async def sending(message: Message) -> None:
            nonlocal began
            if message["type"] == "http.response.start":
                began = True
                message["headers"] = [*message.get("headers", []), *HEADERS]
            await send(message)

        read, end = 0, asyncio.get_running_loop().time() + self.seconds
        whole = False

        async def receiving() -> Message:
            nonlocal read, whole
            if whole:  # it is waited for the page to go
                return await receive()
            try:
                async with asyncio.timeout_at(end):
                    message = await receive()
            except TimeoutError as error:
                raise TooSlow(f"a request is there within {self.seconds:g} s") from error
            whole = not message.get("more_body", False)
            read += len(message.get("body", b""))
            if read > self.most:
                raise TooLarge(f"a request has at most {self.most} bytes")
            return message

        path = str(scope["path"])[1 + len(self.token) :]
        inside = {**scope, "path": path, "raw_path": path.encode()}
        try:
            await self.inner(inside, receiving, sending)
        except TooLarge:
            if not began:
                await _answer(send, 413, "too-large", f"a request has at most {self.most} bytes")
        except TooSlow as error:
            if not began:
                await _answer(send, 408, "too-slow", str(error))

    def _refusal(self, scope: Scope) -> tuple[int, str, str] | None:
        """Why a request is not even read."""
        headers: dict[bytes, list[bytes]] = {}
        for name, value in scope["headers"]:
            headers.setdefault(name.lower(), []).append(value)
        hosts = headers.get(b"host", [])
        allowed = {f"127.0.0.1:{self.port}", f"localhost:{self.port}"}
        host = hosts[0].decode("latin-1").lower() if len(hosts) == 1 else ""
        if host not in allowed:
            return 403, "host", "this server is for pages of this machine"
        first, slash, _ = str(scope["path"])[1:].partition("/")
        if not hmac.compare_digest(first.encode(), self.token.encode()) or not slash:
            return 404, "not-found", "there is nothing here"
        site = headers.get(b"sec-fetch-site", [b"same-origin"])
        if any(x not in (b"same-origin", b"none") for x in site):
            return 403, "origin", "the page of another site asks"
        origins = [x.decode("latin-1").lower() for x in headers.get(b"origin", [])]
        if any(x != f"http://{host}" for x in origins):
            return 403, "origin", "the page of another site asks"
        if scope["method"] == "POST":
            if len(origins) != 1:
                return 403, "origin", "it is not told which page asks"
            kind = headers.get(b"content-type", [b""])[0].split(b";")[0].strip().lower()
            if kind != b"application/json":
                return 415, "content-type", "JSON is wanted"
        elif scope["method"] not in ("GET", "HEAD"):
            return 405, "method", "GET and POST are known"
        for length in headers.get(b"content-length", []):
            if not length.isdigit() or len(length) > 15 or int(length) > self.most:
                return 413, "too-large", f"a request has at most {self.most} bytes"
        return None


async def _answer(send: Send, status: int, code: str, words: str) -> None:
    body = json.dumps({"error": code, "message": words}).encode()
    headers = [(b"content-type", b"application/json"), (b"content-length", str(len(body)).encode())]
    # What rests of the request is not read, so that the connection is of no use any more.
    headers += [*HEADERS, (b"connection", b"close")]
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": body})
