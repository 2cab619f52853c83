"""How a route answers: JSON, and words with a status of 400 or more where it refuses."""

from __future__ import annotations

import json
from collections.abc import Awaitable, Callable, Mapping
from typing import Any

from starlette.requests import ClientDisconnect, Request
from starlette.responses import JSONResponse, Response

from mbsym.algebra.failures import LOG
from mbsym.serving.guard import TooLarge, TooSlow
from mbsym.serving.requests import Wrong
from mbsym.serving.storage import Unreadable, Unwritable

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
        found = await work(body, request)
        return found if isinstance(found, Response) else JSONResponse(found)

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
